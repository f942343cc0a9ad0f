"""Drift during a measurement: tooth 0 touched again at the end tells it, and takes it out of all points."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from gearmath.specs.bevel_set import FLANKS
from gearmath.specs.flank_csv import FlankFile


@dataclass(frozen=True)
class Drift:
    """Drift of one flank: ``closure`` [mm], deviation of tooth 0 at the end less that at the start, as the mean of
    ``points`` that were touched twice; ``rate`` [mm] for every row of the file.
    """

    flank: str
    closure: float
    rate: float
    points: int


def without_drift(file: FlankFile, teeth: int) -> tuple[FlankFile, dict[str, Drift]]:
    """The file without tooth 0 measured again and without what that shows, and the drift of each flank.

    The drift of a flank's deviations is taken as even over the rows, which stand in the order of measuring, and as
    none at the points of tooth 0 that were touched again. A flank without such points stays as it is.
    """
    deviation, drifts = file.deviation.copy(), {}
    rows = np.arange(len(file), dtype=float)
    for flank in FLANKS:
        here = file.flank == flank
        first, again = _twice(file, teeth, here)
        if not len(first):
            continue
        change, apart = file.deviation[again] - file.deviation[first], rows[again] - rows[first]
        rate = float(change @ apart / (apart @ apart))
        deviation[here] -= rate * (rows[here] - rows[first].mean())
        drifts[flank] = Drift(flank, float(change.mean()), rate, len(first))
    moved = replace(file, deviation=deviation, point=file.point + _taken(deviation, file)[:, None] * file.normal)
    return moved.pick(file.tooth < teeth), drifts


def _twice(file: FlankFile, teeth: int, here: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Rows of the points of tooth 0 that were touched again, and the rows of the second touches."""
    known = here & np.isfinite(file.deviation)
    places = {(file.row[k], file.col[k]): k for k in np.flatnonzero(known & (file.tooth == 0))}
    again = [k for k in np.flatnonzero(known & (file.tooth == teeth)) if (file.row[k], file.col[k]) in places]
    first = [places[file.row[k], file.col[k]] for k in again]
    return np.array(first, dtype=int), np.array(again, dtype=int)


def _taken(deviation: np.ndarray, file: FlankFile) -> np.ndarray:
    return np.nan_to_num(deviation - file.deviation)
