"""Drift during a measurement: tooth 0 touched again at the end tells it, and takes it out of all points.

Every point is touched in a space that is turned to the same place of the machine, so that a drift of the machine is one
vector v in the axes of the space: radial, around, and along the work axis. It adds v·n for every touch since the first,
n the normal in those axes. Two points touched again, one on each flank, tell two of its components; the third, along
the tooth, which they do not feel, is taken as zero: of all vectors that explain them v is the shortest. What it does at
other points is known but for its size, and a registration leaves that free.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from gearmath.kernels import kernel
from gearmath.specs.bevel_set import FLANKS
from gearmath.specs.flank_csv import FlankFile

#: A direction is told by normals that feel it at least this much, against the one that they feel most.
_FELT = 0.1


@dataclass(frozen=True)
class MeasuredDrift:
    """Drift seen by one flank: ``closure`` [mm], deviation of tooth 0 at the end less that at the start, as the mean of
    ``points`` that were touched twice; ``motion`` (3,) [mm], what the machine moved from the first row to the last, in
    the axes of a space.
    """

    flank: str
    closure: float
    motion: np.ndarray
    points: int


def evenly(file: FlankFile) -> np.ndarray:
    """The course (n,) of a drift that is even over the rows, which stand in the order of measuring: from 0 to 1."""
    return np.linspace(0.0, 1.0, len(file))


def without_drift(
    file: FlankFile, teeth: int, course: np.ndarray | None = None
) -> tuple[FlankFile, dict[str, MeasuredDrift]]:
    """The file without tooth 0 measured again and without what that shows, and the drift of each flank.

    ``course`` (n,) is how far the motion has come at each row, even over all of them if not given: one clock for both
    flanks, or it would change the thickness of the teeth. A flank without such points stays as it is.
    """
    pairs = {flank: _twice(file, teeth, flank) for flank in FLANKS}
    seen = [flank for flank in FLANKS if len(pairs[flank][0])]
    if not seen:
        return file.pick(file.tooth < teeth), {}
    first, again = (np.concatenate([pairs[flank][k] for flank in seen]) for k in (0, 1))
    course = evenly(file) if course is None else course
    motion, normal = _motion(file, first, again, course)
    deviation, drifts = file.deviation.copy(), {}
    for flank in seen:
        here, (start, end) = file.flank == flank, pairs[flank]
        deviation[here] -= course[here] * (normal[here] @ motion)
        closure = float(np.mean(file.deviation[end] - file.deviation[start]))
        drifts[flank] = MeasuredDrift(flank, closure, motion, len(start))
    moved = np.nan_to_num(deviation - file.deviation)[:, None] * file.normal
    return replace(file, deviation=deviation, point=file.point + moved).pick(file.tooth < teeth), drifts


def measured_twice(file: FlankFile, teeth: int) -> tuple[np.ndarray, np.ndarray]:
    """Rows of the points of tooth 0 that were touched again, and the rows of the second touches, of both flanks."""
    pairs = [_twice(file, teeth, flank) for flank in FLANKS]
    first, again = (np.concatenate([pair[k] for pair in pairs]) for k in (0, 1))
    return first, again


def moved_by(file: FlankFile, first: np.ndarray, again: np.ndarray, course: np.ndarray) -> np.ndarray:
    """What the motion that points touched twice show makes of the deviation of every row (n,) [mm], on its course."""
    motion, normal = _motion(file, first, again, course)
    return course * (normal @ motion)


def _motion(file: FlankFile, first: np.ndarray, again: np.ndarray, course: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The whole motion (3,) [mm] in the axes of a space, and the normals (n,3) in them."""
    normal = in_space(file)
    change = file.deviation[again] - file.deviation[first]
    motion, *_ = np.linalg.lstsq((course[again] - course[first])[:, None] * normal[first], change, rcond=_FELT)
    return motion, normal


def untold_drift(file: FlankFile, teeth: int, course: np.ndarray) -> np.ndarray:
    """Columns (n,q): what drift that is not felt at the points touched again does to the deviations, but for its size.

    Rows are those that ``without_drift`` keeps; q is 0 where nothing was touched again, or where that tells all of it.
    """
    keep = file.tooth < teeth
    first = np.concatenate([_twice(file, teeth, flank)[0] for flank in FLANKS])
    if not len(first):
        return np.empty((int(keep.sum()), 0))
    normal = in_space(file)
    _, sizes, directions = np.linalg.svd(normal[first])
    told = int((sizes > _FELT * sizes[0]).sum())
    return (course[:, None] * (normal @ directions[told:].T))[keep]


def _twice(file: FlankFile, teeth: int, flank: str) -> tuple[np.ndarray, np.ndarray]:
    """Rows of the points of tooth 0 that were touched again, and the rows of the second touches."""
    known = (file.flank == flank) & np.isfinite(file.deviation)
    places = {(file.row[k], file.col[k]): k for k in np.flatnonzero(known & (file.tooth == 0))}
    again = [k for k in np.flatnonzero(known & (file.tooth == teeth)) if (file.row[k], file.col[k]) in places]
    first = [places[file.row[k], file.col[k]] for k in again]
    return np.array(first, dtype=int), np.array(again, dtype=int)


def in_space(file: FlankFile) -> np.ndarray:
    """Normals (n,3) in the axes of the space as it stands at the touch: middle of the space, across, along the work.

    The middle is that between the two flanks; where the other flank was not touched at the same place, it is as far
    from the point as at the nearest row of the same flank where it was.
    """
    keys = list(zip(file.tooth.tolist(), file.row.tolist(), file.col.tolist(), strict=True))
    at = {(flank, *key): k for k, (flank, key) in enumerate(zip(file.flank.tolist(), keys, strict=True))}
    other = dict(zip(FLANKS, FLANKS[::-1], strict=True))
    opposite = np.array([at.get((other[flank], *key), -1) for flank, key in zip(file.flank, keys, strict=True)])
    point = file.point - np.nan_to_num(file.deviation)[:, None] * file.normal
    azimuth = np.arctan2(point[:, 1], point[:, 0])
    both = opposite >= 0
    middle = azimuth.copy()
    (middle[both],) = kernel("space_azimuth")(point[both], point[opposite[both]])
    for flank in FLANKS:
        there, lonely = np.flatnonzero(both & (file.flank == flank)), (file.flank == flank) & ~both
        if len(there) and lonely.any():
            nearest = there[np.argmin(np.abs(np.flatnonzero(lonely)[:, None] - there), axis=1)]
            middle[lonely] = azimuth[lonely] + middle[nearest] - azimuth[nearest]
    c, s = np.cos(middle), np.sin(middle)
    x, y, z = file.normal.T
    return np.stack([c * x + s * y, c * y - s * x, z], axis=1)
