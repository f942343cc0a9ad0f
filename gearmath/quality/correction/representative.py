"""The tooth from which settings are corrected: one that is measured in full, and whose form is that of the others."""

from __future__ import annotations

import numpy as np

from gearmath.quality.evaluation.robust import limit_of
from gearmath.specs.flank_csv import FlankFile

#: Teeth that tell which of them is unlike the others.
_LEAST_TEETH = 3
#: A form is unlike that of the others from this RMS on. [mm]
_LEAST_OFF = 0.005


def representative_tooth(file: FlankFile, flank: str) -> int:
    """The first of the teeth of a flank that have most points, but for those whose form is unlike the median's."""
    teeth, off = _forms(file, flank)
    alike = off <= limit_of(off, _LEAST_OFF) if len(teeth) >= _LEAST_TEETH else np.ones(len(teeth), dtype=bool)
    return int(teeth[np.argmax(alike)])


def passed_over(file: FlankFile, flank: str) -> str | None:
    """What to say where the first tooth measured in full is not the one that settings are corrected from."""
    teeth, off = _forms(file, flank)
    tooth = representative_tooth(file, flank)
    if tooth == teeth[0]:
        return None
    return (
        f"{flank} flank: the form of tooth {teeth[0]} deviates by {off[0] * 1000:.1f} um (RMS) from the median of "
        f"{len(teeth)} teeth; the settings are corrected from tooth {tooth}"
    )


def _forms(file: FlankFile, flank: str) -> tuple[np.ndarray, np.ndarray]:
    """The teeth (k,) that have most points, and how far the form of each is off their median (k,) [mm], in RMS.

    The form is the deviations less their mean.
    """
    points = file.select(flank)
    numbers, counts = np.unique(points.tooth, return_counts=True)
    teeth = numbers[counts == counts.max()]
    if len(teeth) < _LEAST_TEETH or counts.max() == 1:
        return teeth, np.zeros(len(teeth))
    width = int(points.col.max()) + 1
    forms = np.full((len(teeth), int(points.row.max() + 1) * width), np.nan)
    for form, tooth in zip(forms, teeth, strict=True):
        one = points.pick(points.tooth == tooth)
        form[one.row * width + one.col] = one.deviation
    known = np.isfinite(forms).all(axis=0)
    if not known.any():
        return teeth, np.zeros(len(teeth))
    forms = forms[:, known] - forms[:, known].mean(axis=1, keepdims=True)
    return teeth, np.sqrt(np.mean((forms - np.median(forms, axis=0)) ** 2, axis=1))
