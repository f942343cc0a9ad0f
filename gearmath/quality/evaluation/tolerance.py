"""Tolerances of pitch and runout in the manner of ISO 17485:2006, as others quote it: unconfirmed, no conformity.

The formulas (19.6) were not checked against the standard. Grades are given only within the scope that is known of it.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any

import numpy as np

from gearmath.bevel.flank import Grid, nominal_points
from gearmath.bevel.newton import TOLERANCE
from gearmath.errors import ComputationError, InputError
from gearmath.kernels import kernel
from gearmath.specs.bevel_set import FLANKS, Member

GRADES = range(2, 12)
#: Scope of the standard: teeth, mean normal module [mm], tolerance diameter [mm].
SCOPE = {"teeth": (5, 400), "mean_normal_module": (1.0, 50.0), "tolerance_diameter": (5.0, 2500.0)}
CAVEAT = "ISO 17485 formulas unconfirmed: no conformity claimed"


@dataclass(frozen=True)
class GearData:
    """What tolerances depend on: teeth, mean normal module and tolerance diameter [mm], mean spiral angle [rad]."""

    teeth: int
    mean_normal_module: float
    tolerance_diameter: float
    mean_spiral_angle: float

    @property
    def outside(self) -> str | None:
        """What is outside of the scope, as a sentence; None where nothing is."""
        for name, (low, high) in SCOPE.items():
            value = getattr(self, name)
            if not low <= value <= high:
                return f"{name} = {value:g}: the formulas hold from {low:g} to {high:g}"
        return None


@dataclass(frozen=True)
class Tolerances:
    """Tolerances [µm] of single pitch, cumulative pitch and runout: by the formulas, and rounded."""

    grade: int
    exact: dict[str, float]

    @property
    def rounded(self) -> dict[str, float]:
        return {name: rounded(value) for name, value in self.exact.items()}


Grades = dict[str, int | None]


@dataclass(frozen=True)
class Verdict:
    """Measured figures [µm] and the grade of each; None where even the coarsest is exceeded. ``grade`` is the worst.

    ``withheld`` says of each figure without a grade why it has none; then there is no ``grade`` of the whole either.
    ``flanks`` has the grades of the figures of each flank that are known.
    """

    data: GearData
    measured: dict[str, float]
    grades: Grades
    remark: str
    withheld: dict[str, str]
    flanks: dict[str, Grades]

    @property
    def grade(self) -> int | None:
        found = list(self.grades.values())
        if self.withheld or not found or None in found:
            return None
        return max(found)  # type: ignore[type-var]

    def as_dict(self) -> dict[str, Any]:
        """For programs; a grade is None where the coarsest is exceeded, and where ``withheld`` says why."""
        return {
            "grade": self.grade,
            "grades": self.grades | dict.fromkeys(self.withheld),
            "withheld": self.withheld,
            "beyond_coarsest": [key for key, grade in self.grades.items() if grade is None],
            "grades_of_flanks": self.flanks,
            "mean_normal_module": self.data.mean_normal_module,
            "tolerance_diameter": self.data.tolerance_diameter,
            "remark": self.remark,
        }


def iso17485(mean_normal_module: float, tolerance_diameter: float, grade: int) -> Tolerances:
    """Tolerances of one grade. Raises InputError outside of grades 2 to 11."""
    if grade not in GRADES:
        raise InputError(f"grade = {grade}: must be {GRADES[0]} to {GRADES[-1]}")
    values = kernel("spacing_tolerances")(mean_normal_module, tolerance_diameter, grade)
    return Tolerances(grade, dict(zip(("f_pt", "F_p", "F_r"), map(float, values), strict=True)))


def rounded(value: float) -> float:
    """A tolerance [µm] as tables print it: above 10 whole, from 5 to 10 to halves, below 5 to tenths."""
    step = 1.0 if value > 10 else 0.5 if value >= 5 else 0.1
    return round(math.floor(value / step + 0.5) * step, 1)


def gear_data(member: Member) -> GearData:
    """Teeth, module and tolerance diameter of a member; the spiral angle is the mean of both flanks at the mean point.

    Raises ComputationError where a flank does not reach the mean point.
    """
    blank = member.blank
    delta, distance = blank.delta, blank.mean_cone_distance
    place = Grid(np.array([distance * math.cos(delta)]), np.array([distance * math.sin(delta)]))
    angles, modules = [], []
    for flank in FLANKS:
        points, residual = nominal_points(member, flank, place)
        if not residual[0] <= TOLERANCE:
            raise ComputationError(f"{member.name} {flank} flank: it does not reach the mean point")
        angle, module = kernel("mean_module")(delta, distance, member.teeth, points.point[0], points.normal[0])
        angles.append(float(angle))
        modules.append(float(module))
    (diameter,) = kernel("tolerance_diameter")(blank.vector)
    return GearData(member.teeth, float(np.mean(modules)), float(diameter), float(np.mean(angles)))


def judge(
    member: Member,
    measured: dict[str, float],
    withheld: Mapping[str, str] = MappingProxyType({}),
    flanks: Mapping[str, dict[str, float]] = MappingProxyType({}),
) -> Verdict:
    """The grades of measured ``f_pt``, ``F_p``, ``F_r`` [mm]: of each the finest whose rounded tolerance holds it.

    ``withheld`` are those that are not known, and why; ``flanks`` those of one flank alone. Outside of the scope there
    are no grades, and the remark says why.
    """
    data = gear_data(member)
    values = {key: value * 1000 for key, value in measured.items()}
    if data.outside is not None:
        return Verdict(data, values, {}, f"no grade: {data.outside}", dict(withheld), {})
    of_flanks = {flank: _grades(data, one) for flank, one in flanks.items()}
    return Verdict(data, values, _grades(data, measured), CAVEAT, dict(withheld), of_flanks)


def _grades(data: GearData, measured: dict[str, float]) -> Grades:
    """The finest grade of each measured figure [mm]; None where none is coarse enough."""
    return {key: finest_grade(data, key, value * 1000) for key, value in measured.items()}


def finest_grade(data: GearData, name: str, value: float) -> int | None:
    """The finest grade whose rounded tolerance of ``f_pt``, ``F_p`` or ``F_r`` holds a value [µm]; None beyond 11."""
    allowed = (iso17485(data.mean_normal_module, data.tolerance_diameter, grade) for grade in GRADES)
    return next((each.grade for each in allowed if abs(value) <= each.rounded[name]), None)
