"""What the digits of a measured file tell: values that are all the same, and how coarsely they were rounded."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from gearmath.specs.flank_csv import FlankFile
from gearmath.specs.ratio import INCH

#: Steps to which files are rounded, the coarsest first, a hundredth to a ten-thousandth of an inch among them. [mm]
STEPS = (0.1, 0.01 * INCH, 0.05, 0.001 * INCH, 0.02, 0.01, 0.005, 0.0001 * INCH, 0.002)
#: Multiples of a step to this part of it, and to the last digit of a file [mm].
_ON_STEP, _DIGIT = 1e-5, 2e-9
#: No measurement is so near to the nominal flank; points that were printed to five decimals are. [mm]
_NOMINAL = 1e-5
#: So many values other than zero, and different ones, tell a step.
_LEAST_VALUES, _LEAST_DIFFERENT = 10, 3


def resolution(values: np.ndarray) -> float:
    """The coarsest of ``STEPS`` [mm] that all finite values [mm] are multiples of; 0 where none is."""
    known = values[np.isfinite(values) & (np.abs(values) > _DIGIT)]
    if len(known) < _LEAST_VALUES or len(np.unique(known)) < _LEAST_DIFFERENT:
        return 0.0
    for step in STEPS:
        steps = np.round(known / step)
        on_step = (np.abs(known - step * steps) <= max(_ON_STEP * step, _DIGIT)).all()
        if on_step and np.count_nonzero(steps) >= _LEAST_VALUES:
            return step
    return 0.0


def file_resolution(file: FlankFile) -> float:
    """The step [mm] to which deviations or coordinates of a file are rounded, the coarser; 0 where it is finer."""
    return max(resolution(file.deviation), resolution(file.point.ravel()))


def rounded_words(step: float) -> str:
    """What is to be said of values that are rounded to a step [mm]."""
    u = step / math.sqrt(12)
    return f"rounded to {step * 1000:g} um: no point is known better than {u * 1000:.1f} um, standard uncertainty"


def no_measurement(file: FlankFile) -> str | None:
    """Why a file is no measurement: all its deviations are the same to the last digit; None where they differ."""
    known = file.deviation[np.isfinite(file.deviation)]
    if len(known) < _LEAST_VALUES:
        return None
    if np.abs(known).max() <= _NOMINAL:
        least = "0" if np.abs(known).max() <= _DIGIT else f"within {_NOMINAL * 1000:g} um of 0"
        return f"all {len(known)} deviations are {least}, which no measurement gives: is it a copy of the nominal file?"
    if np.ptp(known) > _DIGIT:
        return None
    return f"all {len(known)} deviations are {known[0] * 1000:.3f} um to the last digit, which no measurement gives"


def said_of_digits(file: FlankFile) -> Iterator[str]:
    """Sentences on the digits of a file."""
    if why := no_measurement(file):
        yield why
    elif step := file_resolution(file):
        of = "deviations" if resolution(file.deviation) == step else "x, y, z"
        yield f"{of} of the file are {rounded_words(step)}"
