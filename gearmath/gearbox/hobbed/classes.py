"""Flank tolerance classes of ISO 1328-1:2013 for the figures of a virtual gear; formulas [unconfirmed]."""

from __future__ import annotations

import math
from dataclasses import dataclass

from gearmath.gearbox.hobbed.inspection import Inspection
from gearmath.gearbox.hobbed.job import HobbingJob
from gearmath.gearbox.kernels import evaluate

#: Figures in the order of the outputs of (31.1) to (31.4).
FIGURES = ("f_pt", "F_p", "F_r", "f_H_alpha", "f_f_alpha", "F_alpha", "f_H_beta", "f_f_beta", "F_beta")
FINEST, COARSEST = 1, 11
#: What the standard covers: module, reference diameter, face width [mm], teeth, helix angle [degrees].
COVERED = {
    "module": (0.5, 70.0, " mm"),
    "reference diameter": (5.0, 15_000.0, " mm"),
    "face width": (4.0, 1200.0, " mm"),
    "number of teeth": (5, 1000, ""),
    "helix angle": (0, 45, " degrees"),
}
NOT_CONFIRMED = "tolerances of ISO 1328-1:2013 [unconfirmed]: as other programs have them, no printed example was found"


@dataclass(frozen=True)
class FigureClass:
    """One figure [µm], the finest class that allows it, None where none does, and that class's tolerance [µm]."""

    figure: str
    value_um: float
    accuracy_class: int | None
    tolerance_um: float | None


def outside(job: HobbingJob) -> str | None:
    """Why the standard does not cover a gear, or None."""
    gear = job.gear
    values = (gear.module, job.reference_diameter, job.face_width, gear.teeth, math.degrees(gear.beta))
    for (what, (low, high, unit)), value in zip(COVERED.items(), values, strict=True):
        if not low <= value <= high:
            return f"{what} {value:g} is outside {low:g} to {high:g}{unit}, which ISO 1328-1 covers"
    return None


def tolerances(job: HobbingJob, accuracy_class: int) -> dict[str, float]:
    """What a class allows [µm], by figure; to the formulas, not rounded."""
    values = evaluate("cylindrical_tolerances", accuracy_class, job.gear.module, job.reference_diameter, job.face_width)
    return dict(zip(FIGURES, values, strict=True))


def classes(job: HobbingJob, found: Inspection) -> tuple[FigureClass, ...]:
    """Every figure with its class; without one where the standard does not cover the gear."""
    covered = outside(job) is None
    allowed = {each: tolerances(job, each) for each in range(FINEST, COARSEST + 1)} if covered else {}
    rows = []
    for figure, value in found.figures.items():
        size = abs(value) * 1000
        reached = next((each for each, limits in allowed.items() if size <= limits[figure]), None)
        limit = None if reached is None else allowed[reached][figure]
        rows.append(FigureClass(figure, value * 1000, reached, limit))
    return tuple(rows)


def overall(rows: tuple[FigureClass, ...]) -> int | None:
    """The coarsest class of all figures, None where one has none."""
    each = [row.accuracy_class if row.accuracy_class is not None else math.inf for row in rows]
    worst = max(each, default=math.inf)
    return None if math.isinf(worst) else int(worst)
