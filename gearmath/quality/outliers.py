"""Points that are not of the flank: a probe that missed, dirt, a burr. Flagged in words and left out, never fitted.

Where a tooth has a grid, its deviations are fitted by a surface of third degree that does not follow single points:
iteratively reweighted least squares with Tukey's weights, from least absolute values and from many samples. Where teeth
have single points, the same place of all teeth is fitted by its mean and first harmonic in the same way.
A point is left out where it stands off by more than six standard deviations of the others, told by the median of their
distances, and by more than a least size: uneven flanks and uneven pitch are what is measured, and must not be flagged.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from gearmath.bevel.kernels import kernel
from gearmath.errors import InputError
from gearmath.quality.topography import grid_shape, local_coordinates
from gearmath.specs.bevel_set import FLANKS
from gearmath.specs.flank_csv import FlankFile

#: How far a point must stand off: in standard deviations of the others, and at least, on a grid, tooth to tooth. [mm]
SIGMAS, LEAST_ON_GRID, LEAST_BETWEEN_TEETH = 6.0, 0.02, 0.05
#: Points that a surface of third degree, and teeth that a harmonic needs to tell one point from the others.
_LEAST_POINTS, _LEAST_TEETH = 20, 6
#: Where more than this part of the points stands off, it is not single points that are wrong.
_MOST = 0.2
#: Standard deviation of normal noise over the median of its size.
_MAD = 1.4826
_STEPS, _TUKEY, _SMALL = 30, 4.685, 1e-6
#: Samples from which the fit is started.
_STARTS = 20


@dataclass(frozen=True)
class Outliers:
    """Which rows (n,) of a file are left out, and a sentence for each."""

    mask: np.ndarray
    reasons: tuple[str, ...]

    def without(self, file: FlankFile) -> FlankFile:
        """The file with these points silent, and back at their nominal places."""
        back = np.where(self.mask, file.deviation, 0.0)[:, None] * file.normal
        return replace(file, deviation=np.where(self.mask, np.nan, file.deviation), point=file.point - back)


def flag_outliers(along: np.ndarray, upward: np.ndarray, deviation: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Which of n deviations [mm] at places of the local system [mm] to leave out, and how far each stands off [mm].

    NaN is neither fitted nor flagged. Raises InputError where a fifth or more of the points would have to be left out.
    """
    known = np.isfinite(deviation)
    flags, off = np.zeros(len(deviation), dtype=bool), np.full(len(deviation), np.nan)
    if known.sum() < _LEAST_POINTS:
        return flags, off
    _, monomials = kernel("deviation_surface")(along[known], upward[known], np.zeros(10))
    scaled = monomials / np.abs(monomials).max(axis=0)
    off[known] = _off(scaled, deviation[known], LEAST_ON_GRID)
    flags[known] = _flagged(off[known], LEAST_ON_GRID)
    return flags, off


def find_outliers(file: FlankFile, teeth: int) -> Outliers:
    """The points of a measured file to leave out. Raises InputError where too many stand off to be single points."""
    mask, looked_at, reasons = np.zeros(len(file), dtype=bool), np.zeros(len(file), dtype=bool), []
    for groups, what in (
        (_on_grids(file), "the smooth surface through the others"),
        (_between_teeth(file, teeth, looked_at), "the same place of the other teeth"),
    ):
        for rows, flags, off in groups:
            for k in np.flatnonzero(flags & ~looked_at[rows]):
                at = rows[k]
                mask[at] = True
                reasons.append(
                    f"{file.flank[at]} flank, tooth {file.tooth[at]}, row {file.row[at]}, col {file.col[at]}: "
                    f"{file.deviation[at] * 1000:+.1f} um stands {abs(off[k]) * 1000:.1f} um off {what}; left out"
                )
            looked_at[rows] = True
    return Outliers(mask, tuple(reasons))


_Group = tuple[np.ndarray, np.ndarray, np.ndarray]


def _on_grids(file: FlankFile) -> Iterator[_Group]:
    """Rows, flags and distances of every flank of every tooth that has a grid."""
    rows, columns = grid_shape(file)
    for flank in FLANKS:
        for tooth in np.unique(file.tooth[file.flank == flank]):
            (here,) = np.nonzero((file.flank == flank) & (file.tooth == tooth))
            if len(here) < _LEAST_POINTS or len(here) != rows * columns:
                continue
            here = here[np.lexsort((file.col[here], file.row[here]))]
            middle = (rows // 2, columns // 2)
            along, upward = local_coordinates(file.point[here].reshape(rows, columns, 3), middle)
            try:
                flags, off = flag_outliers(along.ravel(), upward.ravel(), file.deviation[here])
            except InputError as error:
                raise InputError(f"{flank} flank, tooth {tooth}: {error}") from error
            yield here, flags, off


def _between_teeth(file: FlankFile, teeth: int, looked_at: np.ndarray) -> Iterator[_Group]:
    """Rows, flags and distances of every place of the grid that many teeth have, some of them not looked at yet."""
    for flank in FLANKS:
        of_flank = file.flank == flank
        for row, col in sorted(set(zip(file.row[of_flank], file.col[of_flank], strict=True))):
            (here,) = np.nonzero(of_flank & (file.row == row) & (file.col == col) & np.isfinite(file.deviation))
            if len(here) < _LEAST_TEETH or looked_at[here].all():
                continue
            turn = 2 * np.pi * file.tooth[here] / teeth
            columns = np.stack([np.ones(len(here)), np.cos(turn), np.sin(turn)], axis=1)
            off = _off(columns, file.deviation[here], LEAST_BETWEEN_TEETH)
            try:
                flags = _flagged(off, LEAST_BETWEEN_TEETH)
            except InputError as error:
                raise InputError(f"{flank} flank, row {row}, col {col} of all teeth: {error}") from error
            yield here, flags, off


def _off(columns: np.ndarray, values: np.ndarray, least: float) -> np.ndarray:
    """How far values (n,) stand off what their columns (n,p) make of most of them.

    Of the fits that several starts lead to, the one with the least of Tukey's loss, all at one scale: the median of
    the distances from the fit of least absolute values, or what ``least`` is ``SIGMAS`` of.
    """
    n, p = columns.shape
    absolute = np.zeros((1, n))
    for _ in range(_STEPS):
        absolute = _off_weighted(columns, values, 1 / np.maximum(np.abs(absolute), _SMALL))
    scale = max(_MAD * float(np.median(np.abs(absolute))), least / SIGMAS)
    rng = np.random.default_rng(0)  # the same starts in every run
    samples = rng.permuted(np.tile(np.arange(n), (_STARTS, 1)), axis=1) < 2 * p
    off = np.vstack([absolute, _off_weighted(columns, values, samples.astype(float))])
    for _ in range(_STEPS):
        size = np.maximum(scale, _MAD * np.median(np.abs(off), axis=1, keepdims=True))
        off = _off_weighted(columns, values, _tukey(off / size))
    loss = np.sum(1 - _tukey(off / scale) ** 1.5, axis=1)
    return off[np.argmin(loss)]


def _off_weighted(columns: np.ndarray, values: np.ndarray, weight: np.ndarray) -> np.ndarray:
    """Distances (s,n) of values (n,) from the weighted fits of s weights (s,n)."""
    p = columns.shape[1]
    products = (columns[:, :, None] * columns[:, None, :]).reshape(len(columns), p * p)
    normal = (weight @ products).reshape(len(weight), p, p)
    ridge = 1e-12 * np.trace(normal, axis1=1, axis2=2)[:, None, None] * np.eye(p)
    right = (weight * values) @ columns
    return values - np.linalg.solve(normal + ridge, right[..., None])[..., 0] @ columns.T


def _tukey(ratio: np.ndarray) -> np.ndarray:
    """Tukey's weights of distances in standard deviations."""
    return np.clip(1 - (ratio / _TUKEY) ** 2, 0, None) ** 2


def _flagged(off: np.ndarray, least: float) -> np.ndarray:
    """Raises InputError where they are too many."""
    flags = np.abs(off) > max(least, SIGMAS * _MAD * float(np.median(np.abs(off))))
    if flags.sum() > max(1, _MOST * len(off)):
        raise InputError(f"{int(flags.sum())} of {len(off)} points stand off the others: no single points are wrong")
    return flags
