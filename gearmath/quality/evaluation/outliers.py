"""Points that are not of the flank: a probe that missed, dirt, a burr. Said in words and left out, never fitted.

A single point off its neighbors is an outlier. Where a tooth has a grid, its deviations are fitted by a surface of
third degree that single points do not pull; neighbors that are off together are form, or a burr, and kept. A point
that is off a surface of fourth degree by less is said and kept, but for the reference point: it zeroes and indexes its
tooth, and is left out. Elsewhere a place that many teeth have is fitted by its mean and first harmonic over the teeth,
and the points of each tooth are compared with each other (module ``tooth_shifts``). A point counts as off where its
distance exceeds six standard deviations of the others, told by the median of their distances, and a least size: uneven
flanks and uneven pitch are what is measured, and must not be flagged. A point of tooth 0 that was touched again is
compared with the others that were.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from gearmath.errors import InputError
from gearmath.kernels import kernel
from gearmath.quality.evaluation.drift import measured_twice
from gearmath.quality.evaluation.pitch import reference_point
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
#: A point of a grid is noticed from here on, where it is off by six standard deviations of the others. [mm]
_LEAST_NOTICED = 0.004
#: So many points tell the fifteen terms of a surface of fourth degree and their noise; more than so many are no single
#: points.
_LEAST_TO_NOTICE, _MOST_NOTICED = 30, 2
#: Points touched again that tell one of them from the others, and how far off it must be at least. [mm]
_LEAST_PAIRS, _LEAST_AGAIN = 5, 0.006
_FOURTH_DEGREE = [5 * i + j for i in range(5) for j in range(5 - i)]


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


def noticed(across: np.ndarray, up: np.ndarray, deviation: np.ndarray, row: np.ndarray, col: np.ndarray) -> np.ndarray:
    """How far n points of a grid are off the surface of fourth degree through the others [mm]; zero where they are not.

    ``across`` and ``up`` are their places from -1 to 1, ``row`` and ``col`` their numbers; NaN deviations [mm] are left
    out. An outlier is told by the noise of the others, but so little may be form: one or two points alone are noticed.
    """
    found, known = np.zeros(len(deviation)), np.isfinite(deviation)
    if known.sum() < _LEAST_TO_NOTICE:
        return found
    surface = np.polynomial.polynomial.polyvander2d(across[known], up[known], (4, 4))[:, _FOURTH_DEGREE]
    off = off_the_fit(surface, deviation[known], _LEAST_NOTICED)
    leverage = np.sum(np.linalg.qr(surface)[0] ** 2, axis=1)  # the others tell a corner less well than the middle
    limit = np.maximum(_LEAST_NOTICED, limit_of(off, 0.0) / np.sqrt(1 - leverage))
    alone = _alone(np.abs(off) > limit, off, row[known], col[known])
    if alone.sum() <= _MOST_NOTICED:
        found[np.flatnonzero(known)[alone]] = off[alone]
    return found


def _alone(flags: np.ndarray, off: np.ndarray, row: np.ndarray, col: np.ndarray) -> np.ndarray:
    """The flagged points (n,) beside which none is off to the same side by a third: neighbors together are form."""
    near = (np.abs(row[:, None] - row) <= 1) & (np.abs(col[:, None] - col) <= 1) & ~np.eye(len(row), dtype=bool)
    alike = near & (off[:, None] * off > 0) & (np.abs(off) > np.abs(off[:, None]) / 3)
    return flags & ~alike.any(axis=1)


def find_outliers(file: FlankFile, teeth: int) -> Outliers:
    """The points of a measured file to leave out; where too many are off to be single points, all are kept."""
    mask, on_grid = np.zeros(len(file), dtype=bool), np.zeros(len(file), dtype=bool)
    reasons, kept = [], []
    less = np.zeros(len(file))
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
        if not together:
            clean = np.where(mask[rows], np.nan, file.deviation[rows])
            less[rows] = noticed(_unit(along), _unit(upward), clean, file.row[rows], file.col[rows])
    for k in np.flatnonzero(less).tolist():
        mask[k] = missed = _is_reference(file, k) and not _again(file, less, k)
        what = f"is {abs(less[k]) * 1000:.1f} um off the surface of fourth degree through the others"
        if missed:
            reasons.append(f"{_place(file, k)} {what}, and the tooth would be zeroed and indexed by it; left out")
        else:
            kept.append(f"{_place(file, k)} {what}; kept")
    shifts = tooth_shifts(replace(file, deviation=np.where(mask, np.nan, file.deviation)), teeth, ~on_grid)
    reasons += _words(file, shifts)
    mask[list(shifts.misses) + list(shifts.doubtful)] = True
    for first, again, change in _unlike_again(file, teeth, mask):
        mask[[first, again]] = True
        reasons.append(f"{_place(file, first)} differs by {change * 1000:+.1f} um where it was touched again; left out")
    return Outliers(mask, tuple(reasons), (*kept, *shifts.kept))


def _unlike_again(file: FlankFile, teeth: int, mask: np.ndarray) -> Iterator[tuple[int, int, float]]:
    """Rows of points of tooth 0 whose second touch differs otherwise than those of the others, and by how much [mm]."""
    first, again = measured_twice(file, teeth)
    keep = ~(mask[first] | mask[again]) if len(first) else np.empty(0, dtype=bool)
    first, again = first[keep], again[keep]
    if len(first) < _LEAST_PAIRS:
        return
    (_, lever) = kernel("flank_turning")(1.0, file.point[first], file.normal[first])
    change = (file.deviation[again] - file.deviation[first]) * lever
    off = change - np.median(change)
    for k in np.flatnonzero(np.abs(off) > limit_of(off, _LEAST_AGAIN)).tolist():
        yield int(first[k]), int(again[k]), float(file.deviation[again[k]] - file.deviation[first[k]])


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


def _unit(place: np.ndarray) -> np.ndarray:
    """Places (n,) from -1 to 1."""
    return 2 * (place - place.min()) / np.ptp(place) - 1


def _is_reference(file: FlankFile, at: int) -> bool:
    return (int(file.row[at]), int(file.col[at])) == reference_point(file)


def _again(file: FlankFile, off: np.ndarray, at: int) -> bool:
    """Whether another tooth has the same place of the flank off alike: that is form."""
    alike = (file.flank == file.flank[at]) & (file.row == file.row[at]) & (file.col == file.col[at])
    return bool(np.sum(alike & (off * off[at] > 0)) > 1)


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
