"""Points that are not of the flank: a probe that missed, dirt, a burr. Said in words and left out, never fitted.

A single point off its neighbors is an outlier. Where a tooth has a grid, its deviations are fitted by a surface of
third degree that single points do not pull; neighbors that are off together are form, or a burr, and kept. Elsewhere a
place that many teeth have is fitted by its mean and first harmonic over the teeth, and the points of each tooth are
compared with each other (module ``tooth_shifts``). A point counts as off where its distance exceeds six standard
deviations of the others, told by the median of their distances, and a least size: uneven flanks and uneven pitch are
what is measured, and must not be flagged.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from gearmath.errors import InputError
from gearmath.kernels import kernel
from gearmath.quality.evaluation.robust import limit_of, off_the_fit
from gearmath.quality.evaluation.tooth_shifts import Shifts, tooth_shifts
from gearmath.quality.evaluation.topography import grid_shape, local_coordinates
from gearmath.specs.bevel_set import FLANKS
from gearmath.specs.flank_csv import FlankFile

#: How far off a point of a grid must be at least. [mm]
LEAST_ON_GRID = 0.02
#: Points that a surface of third degree needs to tell one point from the others.
_LEAST_POINTS = 20
#: Where more than this part of the points is off, it is not single points that are wrong.
_MOST = 0.2
#: So many neighbors that are off to the same side are form.
_FORM = 3


@dataclass(frozen=True)
class Outliers:
    """Which rows (n,) of a file are left out, with a sentence for each, and sentences on what was kept."""

    mask: np.ndarray
    reasons: tuple[str, ...]
    kept: tuple[str, ...] = ()

    def without(self, file: FlankFile) -> FlankFile:
        """The file with these points silent, and back at their nominal places."""
        back = np.where(self.mask, file.deviation, 0.0)[:, None] * file.normal
        return replace(file, deviation=np.where(self.mask, np.nan, file.deviation), point=file.point - back)


def flag_outliers(along: np.ndarray, upward: np.ndarray, deviation: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Which of n deviations [mm] at places of the local system [mm] to leave out, and how far off each is [mm].

    NaN is neither fitted nor flagged. Raises InputError where a fifth or more of the points would have to be left out.
    """
    known = np.isfinite(deviation)
    flags, off = np.zeros(len(deviation), dtype=bool), np.full(len(deviation), np.nan)
    if known.sum() < _LEAST_POINTS:
        return flags, off
    _, monomials = kernel("deviation_surface")(along[known], upward[known], np.zeros(10))
    scaled = monomials / np.abs(monomials).max(axis=0)
    off[known] = off_the_fit(scaled, deviation[known], LEAST_ON_GRID)
    flags[known] = np.abs(off[known]) > limit_of(off[known], LEAST_ON_GRID)
    if flags.sum() > max(1, _MOST * known.sum()):
        raise InputError(
            f"{int(flags.sum())} of {int(known.sum())} points are off the others: no single points are wrong"
        )
    return flags, off


def find_outliers(file: FlankFile, teeth: int) -> Outliers:
    """The points of a measured file to leave out; where too many are off to be single points, all are kept."""
    mask, on_grid = np.zeros(len(file), dtype=bool), np.zeros(len(file), dtype=bool)
    reasons, kept = [], []
    for rows, along, upward in _grids(file):
        on_grid[rows] = True
        try:
            flags, off = flag_outliers(along, upward, file.deviation[rows])
        except InputError as error:
            kept.append(f"{file.flank[rows[0]]} flank, tooth {file.tooth[rows[0]]}: {error}; kept")
            continue
        together = _together(flags, off, grid_shape(file)[1])
        for group in together:
            points = " ".join(f"{file.row[k]},{file.col[k]}" for k in rows[group])
            what = f"{len(group)} neighboring points are off the others alike, which no misses are"
            kept.append(f"{file.flank[rows[0]]} flank, tooth {file.tooth[rows[0]]}: {what}; kept (row,col {points})")
        for k in sorted(set(np.flatnonzero(flags).tolist()).difference(*together)):
            mask[rows[k]] = True
            what = f"is {abs(off[k]) * 1000:.1f} um off the smooth surface through the others; left out"
            reasons.append(f"{_place(file, rows[k])} {what}")
    shifts = tooth_shifts(replace(file, deviation=np.where(mask, np.nan, file.deviation)), teeth, ~on_grid)
    reasons += _words(file, shifts)
    mask[list(shifts.misses) + list(shifts.doubtful)] = True
    return Outliers(mask, tuple(reasons), (*kept, *shifts.kept))


def _together(flags: np.ndarray, off: np.ndarray, columns: int) -> list[list[int]]:
    """The flagged points (n,) of a grid that lie together, three or more, off to the same side: form, or a burr."""
    left, groups = set(np.flatnonzero(flags).tolist()), []
    while left:
        group = [left.pop()]
        for k in group:  # grows as neighbors are found
            near = [j for j in left if abs(j // columns - k // columns) <= 1 and abs(j % columns - k % columns) <= 1]
            alike = [j for j in near if off[j] * off[k] > 0]
            left.difference_update(alike)
            group += alike
        groups.append(sorted(group))
    return [group for group in groups if len(group) >= _FORM]


def _words(file: FlankFile, shifts: Shifts) -> Iterator[str]:
    for k, off in shifts.misses.items():
        yield f"{_place(file, k)} is an arc of {off * 1000:.1f} um off the other points of its tooth; left out"
    for k, off in shifts.doubtful.items():
        yield (
            f"{_place(file, k)} is an arc of {off * 1000:.1f} um off the same place of the other teeth, and no other "
            "point of the tooth confirms it: dirt, or an error of this flank; left out, measure it again"
        )


def _place(file: FlankFile, at: int) -> str:
    """Where a point is, and its deviation."""
    place = f"{file.flank[at]} flank, tooth {file.tooth[at]}, row {file.row[at]}, col {file.col[at]}"
    return f"{place}: {file.deviation[at] * 1000:+.1f} um"


def _grids(file: FlankFile) -> Iterator[tuple[np.ndarray, np.ndarray, np.ndarray]]:
    """Rows of every flank of every tooth that has a grid, and their places of the local system [mm]."""
    rows, columns = grid_shape(file)
    for flank in FLANKS:
        for tooth in np.unique(file.tooth[file.flank == flank]):
            (here,) = np.nonzero((file.flank == flank) & (file.tooth == tooth))
            if len(here) < _LEAST_POINTS or len(here) != rows * columns:
                continue
            here = here[np.lexsort((file.col[here], file.row[here]))]
            middle = (rows // 2, columns // 2)
            along, upward = local_coordinates(file.point[here].reshape(rows, columns, 3), middle)
            yield here, along.ravel(), upward.ravel()
