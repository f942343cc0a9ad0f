"""Whether two rows or columns of a flank stand in each other's place: exchanged back, the flank is smooth."""

from __future__ import annotations

import itertools
from collections.abc import Iterator

import numpy as np

from gearmath.quality.evaluation.registration import stated_noise
from gearmath.quality.evaluation.topography import Topography
from gearmath.specs.flank_csv import FlankFile

#: Degrees of the smooth surface: in all, and from root to tip.
_DEGREE, _UPWARD = 4, 2
#: What a flank scatters by must be more than this [mm], and so many times the stated uncertainty of its points; with
#: two lines exchanged back it must be less than this part of it.
_LEAST, _FAR, _SMOOTHER = 1e-3, 3.0, 0.25
#: Points beyond those that the surface needs.
_SPARE = 10


def exchanged_lines(raw: FlankFile, topography: Topography) -> Iterator[str]:
    """A sentence on the two rows or columns of a flank that look exchanged in a file, before a point was left out."""
    points = raw.select(topography.flank, topography.tooth)
    deviation = np.full(topography.deviation.shape, np.nan)
    deviation[points.row, points.col] = points.deviation
    known = np.isfinite(deviation)
    x, y = (each / np.abs(each).max() for each in (topography.along, topography.upward))
    columns = np.stack([x**i * y**j for j in range(_UPWARD + 1) for i in range(_DEGREE - j + 1)], axis=-1)
    if known.sum() < columns.shape[-1] + _SPARE:
        return
    before = _scatter(columns, deviation)
    if not before > max(_LEAST, _FAR * np.nan_to_num(stated_noise(raw))):
        return
    best: tuple[float, str] = (before, "")
    for axis, word in enumerate(("rows", "columns")):
        for one, two in itertools.combinations(range(known.shape[axis]), 2):
            order = np.arange(known.shape[axis])
            order[[one, two]] = two, one
            after = _scatter(columns, np.take(deviation, order, axis=axis))
            best = min(best, (after, f"{word} {one} and {two}"))
    if best[0] < _SMOOTHER * before:
        yield (
            f"{best[1]} of the {topography.flank} flank, tooth {topography.tooth}, look exchanged: its points scatter "
            f"by {before * 1000:.1f} um about a smooth flank, and by {best[0] * 1000:.1f} um with them exchanged back"
        )


def _scatter(columns: np.ndarray, deviation: np.ndarray) -> float:
    """What the smooth surface leaves of deviations (rows, columns), for each spare point [mm]."""
    known = np.isfinite(deviation)
    left = deviation[known] - columns[known] @ np.linalg.lstsq(columns[known], deviation[known], rcond=None)[0]
    return float(np.sqrt(left @ left / (known.sum() - columns.shape[-1])))
