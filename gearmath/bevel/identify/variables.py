"""What a correction may change: settings and coefficients of their motion, each with its bound, by name.

A coefficient of θ^j of a machine setting is called ``radial_distance.j``. The whole of a flank is one vector (83,):
the 12 settings, then the motion (10,7) row by row, then the curvature of the blade, one over its spheric radius.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np

from derivations import notation
from gearmath.errors import InputError
from gearmath.specs.bevel_set import MACHINE_SETTINGS, SETTINGS, Member

#: How far a setting may be changed, mm or rad, and the curvature of a blade, 1/mm: beyond this something else is wrong
#: with the machine.
BOUNDS = {
    "radial_distance": 1.0,
    "cradle_angle": 0.02,
    "cutter_tilt": 0.02,
    "cutter_swivel": 0.2,
    "blank_offset": 1.0,
    "sliding_base": 1.0,
    "machine_center_to_crossing_point": 1.0,
    "machine_root_angle": 0.01,
    "ratio_of_roll": 0.02,
    "work_rotation_offset": 0.02,
    "blade_point_radius": 1.0,
    "blade_pressure_angle": 0.01,
    "blade_spheric_radius": 0.001,
}
#: The settings that are corrected: those of the machine, without tilt; cradle angle stands also for work rotation.
FREE = (
    "radial_distance",
    "cradle_angle",
    "blank_offset",
    "sliding_base",
    "machine_center_to_crossing_point",
    "machine_root_angle",
    "ratio_of_roll",
)
#: The motions that are corrected besides, when asked: modified roll of second and third order, and helical motion.
HIGHER_ORDER = ("work_rotation_offset.2", "work_rotation_offset.3", "sliding_base.1")
#: A coefficient of θ^j may move the machine as far as the setting may be off, where the cradle has turned by this.
_ROLL = 0.5

#: What bounds a fit: "machine" for errors of a machine, ``BOUNDS``; "design" for settings that are still to be chosen.
Bounds = Literal["machine", "design"]
BOUND_NAMES: tuple[Bounds, ...] = get_args(Bounds)
#: Least and largest part of the setting itself, in a design.
_DESIGN_PART = {"radial_distance": (0.7, 1.3), "ratio_of_roll": (0.7, 1.4), "blade_point_radius": (0.66, 1.33)}
#: Most that a setting may be changed in a design, mm, rad and 1/mm.
_DESIGN_CHANGE = {
    "cradle_angle": math.radians(60),
    "cutter_tilt": math.radians(8),
    "cutter_swivel": math.radians(70),
    "blank_offset": 5.0,
    "sliding_base": 5.0,
    "machine_center_to_crossing_point": 5.0,
    "machine_root_angle": math.radians(1),
    "work_rotation_offset": math.radians(60),
    "blade_spheric_radius": 0.005,
}
#: Least and largest pressure angle of a design [rad].
_DESIGN_ANGLE = math.radians(5), math.radians(30)
#: Largest 2C, 6D and 24E of a design: the coefficient of θ^j of the work rotation is that times R_a/j! (10.7).
_DESIGN_ROLL = {2: 0.1, 3: 5.0, 4: 50.0}

_POWERS = notation.motion.shape[1]
#: The names of the whole vector (83,) of a flank; the spheric radius stands there as the curvature, one over it.
NAMES = (
    *SETTINGS,
    *(f"{name}.{power}" for name in MACHINE_SETTINGS for power in range(1, _POWERS + 1)),
    "blade_spheric_radius",
)
SIZE = len(NAMES)


@dataclass(frozen=True)
class Variable:
    """One column of a fit: a name, and the target it belongs to, or None where all targets share it.

    ``limits`` are the least and the largest change, mm or rad (per rad^j); by default as ``BOUNDS`` has it.
    """

    name: str
    target: int | None = None
    limits: tuple[float, float] | None = None

    @property
    def index(self) -> int:
        """Its place in the whole vector (82,) of a flank."""
        return NAMES.index(self.name)

    @property
    def bound(self) -> float:
        """How far it may be changed to either side at most, mm or rad (per rad^j)."""
        if self.limits is not None:
            return max(-self.limits[0], self.limits[1])
        name, _, power = self.name.partition(".")
        return BOUNDS[name] / _ROLL ** int(power or 0)

    @property
    def range(self) -> tuple[float, float]:
        """Least and largest change, in parts of the bound."""
        low, high = self.limits or (-self.bound, self.bound)
        return low / self.bound, high / self.bound

    @property
    def label(self) -> str:
        """The name, with the number of its target where it does not belong to all."""
        return self.name if self.target is None else f"{self.name}[{self.target}]"


def variables_of(
    names: Sequence[str], vectors: int | Sequence[np.ndarray], bounds: Bounds = "machine"
) -> tuple[Variable, ...]:
    """The columns of a fit: machine settings are shared, every target has its own blade.

    ``vectors`` are the whole vectors (83,) of the targets, or for the bounds of a machine how many there are. Raises
    InputError naming a name that is no setting and no coefficient of a motion, or that is there twice.
    """
    found: list[Variable] = []
    targets = vectors if isinstance(vectors, int) else len(vectors)
    for name in names:
        if name not in NAMES:
            raise InputError(
                f"setting = {name!r}: must be one of {', '.join((*SETTINGS, NAMES[-1]))}, or a coefficient of a motion "
                f"like {HIGHER_ORDER[0]} (name.1 to name.{_POWERS})"
            )
        if any(variable.name == name for variable in found):
            raise InputError(f"setting = {name!r}: is named twice")
        own = name.startswith("blade_") and targets > 1
        for k in range(targets) if own else (None,):
            limits = None
            if bounds == "design" and not isinstance(vectors, int):
                limits = _design_limits(name, vectors[k or 0])
            found.append(Variable(name, k, limits))
    if not found:
        raise InputError("settings: at least one must be free")
    return tuple(found)


def _design_limits(name: str, vector: np.ndarray) -> tuple[float, float] | None:
    """Least and largest change of a setting of a design, from its value; None where only ``BOUNDS`` says it."""
    value, (setting, _, power) = float(vector[NAMES.index(name)]), name.partition(".")
    if power:
        if setting != "work_rotation_offset" or int(power) not in _DESIGN_ROLL:
            return None
        most = _DESIGN_ROLL[int(power)] * float(vector[NAMES.index("ratio_of_roll")]) / math.factorial(int(power))
        return -most, most
    if name in _DESIGN_PART:
        low, high = _DESIGN_PART[name]
        return (low - 1) * value, (high - 1) * value
    if name == "blade_pressure_angle":
        low, high = _DESIGN_ANGLE
        return min(low - value, 0.0), max(high - value, 0.0)
    return -_DESIGN_CHANGE[name], _DESIGN_CHANGE[name]


def reading(name: str) -> tuple[float, str]:
    """The factor that makes of a setting, or of a coefficient of its motion, what people read, and the unit of that."""
    if name == "blade_spheric_radius":
        return 1.0, "1/mm"
    setting, _, power = name.partition(".")
    (unit,) = (component.unit for component in notation.settings.components if component.name == setting)
    per = "" if not power else "/rad" if power == "1" else f"/rad^{power}"
    if unit == "1" and not per:
        unit = ""  # a ratio has none
    return (math.degrees(1), f"deg{per}") if unit == "rad" else (1.0, f"{unit}{per}")


def free_settings(member: Member, higher_order: bool = False) -> tuple[str, ...]:
    """The settings that are corrected where none are named.

    A Formate flank does not roll: the work rotation takes the place of the ratio of roll, and nothing moves.
    """
    if member.generation == "formate":
        return tuple("work_rotation_offset" if name == "ratio_of_roll" else name for name in FREE)
    return FREE + (HIGHER_ORDER if higher_order else ())


def whole(settings: np.ndarray, motion: np.ndarray, curvature: float = 0.0) -> np.ndarray:
    """Settings (12,), motion (10,7) and curvature of the blade [1/mm] as the whole vector (83,) of a flank."""
    return np.concatenate([settings, motion.ravel(), [curvature]])


def parts(vector: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Settings (...,12) and motion (...,10,7) of whole vectors (...,83)."""
    settings, motion = vector[..., : len(SETTINGS)], vector[..., len(SETTINGS) : -1]
    return settings, motion.reshape(*motion.shape[:-1], *notation.motion.shape)
