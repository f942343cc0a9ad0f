"""Work that slips while the grid of a tooth is measured: a step in the order of measuring, inside one flank.

The deviations of a flank are smooth over its points; a slip moves all that are touched after it by the same amount.
Every place for a step is tried on top of a smooth surface, the cubic one (6.3) and one of fourth degree. A step is
found, of a motion along the normals or about the work axis, where it is beyond its uncertainty and the points are far
more likely with it than with a surface of fourth degree, any profile along the rows, and one point that missed, so that
neither form nor dirt is taken for it. Points of tooth 0 that were touched again count too: those touched before the
slip have changed at the end by its size more than those touched after it. A step between two rows is the same as form
along the profile, one inside the first or last row the same as a burr: only points touched again tell these.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import product
from typing import Any

import numpy as np

from gearmath.kernels import kernel
from gearmath.quality.evaluation.drift import measured_twice
from gearmath.quality.evaluation.pitch import reference_point
from gearmath.quality.evaluation.topography import grid_shape, local_coordinates
from gearmath.specs.bevel_set import FLANKS
from gearmath.specs.flank_csv import FlankFile

#: Points beside one a row that tell a step from a surface, and points that there must be on either side of it.
_LEAST_POINTS, _LEAST_SIDE = 25, 3
#: A step counts from this size [mm], and from so many of its standard uncertainties.
_LEAST, _SIGNIFICANT = 3e-3, 5.0
#: Part of the square of a step that no cubic surface takes up; with less of it the points do not tell the step.
_FELT = 0.02
#: What is left of the points is never taken for less than this. [mm]
_FLOOR = 1e-4
#: Logarithm of the ratio of likelihoods from which a step counts as told, 50 to 1.
_TOLD = 4.0
#: Points touched again confirm a step that they show to this part of its size.
_AGREES = 0.4


@dataclass(frozen=True)
class Slip:
    """A slip by ``size`` [mm], along the normals or an arc about the work axis, before a point was touched.

    ``row`` is that of this point in the file. ``before`` and ``after`` are the last point before the slip and the
    first after it: flank, tooth, row and column of the grid. ``uncertainty`` [mm] is that of the size, standard.
    """

    row: int
    size: float
    uncertainty: float
    before: tuple[str, int, int, int]
    after: tuple[str, int, int, int]

    @property
    def where(self) -> str:
        flank, tooth, row, col = self.before
        if self.after[0] != flank:
            return f"after the {flank} and before the {self.after[0]} flank of tooth {tooth} was measured"
        return (
            f"on the {flank} flank of tooth {tooth}, between row {row}, col {col} and row {self.after[2]}, "
            f"col {self.after[3]}"
        )

    def as_dict(self) -> dict[str, Any]:
        """For people and programs: µm."""
        keys = ("flank", "tooth", "row", "col")
        return {
            "size_um": self.size * 1000,
            "u_um": self.uncertainty * 1000,
            "before": dict(zip(keys, self.before, strict=True)),
            "after": dict(zip(keys, self.after, strict=True)),
        }


def find_slip(file: FlankFile, teeth: int) -> Slip | None:
    """The most significant slip on the grid of a flank; None where there is none. Rows stand in measuring order."""
    first, again = measured_twice(file, teeth)
    found = [_on_grid(file, here, along, upward, first, again) for here, along, upward in _grids(file, teeth)]
    return max(
        (slip for slip in found if slip is not None), key=lambda slip: abs(slip.size) / slip.uncertainty, default=None
    )


def slip_between(file: FlankFile, before: int, after: int, size: float, uncertainty: float) -> Slip:
    """A slip between two rows of a file."""
    return Slip(after, size, uncertainty, _place(file, before), _place(file, after))


def _place(file: FlankFile, k: int) -> tuple[str, int, int, int]:
    return str(file.flank[k]), int(file.tooth[k]), int(file.row[k]), int(file.col[k])


def _grids(file: FlankFile, teeth: int) -> Iterator[tuple[np.ndarray, np.ndarray, np.ndarray]]:
    """Rows of every grid that have a reading, in the order of measuring, and their local coordinates [mm]."""
    rows, columns = grid_shape(file)
    for flank in FLANKS:
        for tooth in np.unique(file.tooth[(file.flank == flank) & (file.tooth < teeth)]):
            here = np.flatnonzero((file.flank == flank) & (file.tooth == tooth))
            if len(here) != rows * columns or min(rows, columns) < 4:
                continue
            order = np.lexsort((file.col[here], file.row[here]))
            grid = file.point[here[order]].reshape(rows, columns, 3)
            along, upward = np.empty(len(here)), np.empty(len(here))
            along[order], upward[order] = (each.ravel() for each in local_coordinates(grid, reference_point(file)))
            known = np.isfinite(file.deviation[here])
            if known.sum() >= _LEAST_POINTS + rows:
                yield here[known], along[known], upward[known]


def _on_grid(
    file: FlankFile, here: np.ndarray, along: np.ndarray, upward: np.ndarray, first: np.ndarray, again: np.ndarray
) -> Slip | None:
    """The slip that the points ``here`` of one flank tell, with the points of it that were touched again."""
    pairs = np.isin(first, here)
    first, again = first[pairs], again[pairs]
    n, m = len(here), len(first)
    change = file.deviation[again] - file.deviation[first]
    values = np.concatenate([file.deviation[here], change * math.sqrt(0.5)])  # as sure as one point
    starts = np.arange(_LEAST_SIDE, n - _LEAST_SIDE + 1)
    steps = np.zeros((n + m, len(starts)))
    steps[:n] = np.arange(n)[:, None] >= starts
    steps[n:] = first[:, None] < here[starts]
    weight = np.concatenate([np.ones(n), np.full(m, math.sqrt(0.5))])

    cubic, quartic = _surfaces(along, upward)
    by_row = (file.row[here][:, None] == np.unique(file.row[here])).astype(float)
    smooth = _without_step(values, _basis(np.hstack([quartic, by_row]), first))
    (_, lever) = kernel("flank_turning")(1.0, file.point, file.normal)
    found = None
    for surface, turning in product((cubic, quartic), (np.ones(len(file)), 1 / lever)):
        shape = weight * turning[np.concatenate([here, first])]
        k, size, u, variance = _likeliest(values, steps * shape[:, None], _basis(surface, first))
        evidence = (n + m) / 2 * math.log(smooth / variance) - math.log(2 * len(starts))
        if abs(size) <= max(_LEAST, _SIGNIFICANT * u) or evidence <= _TOLD:
            continue
        if not _confirmed(change / turning[first], first < here[starts[k]], file.row[here], starts[k], size, u):
            continue
        slip = slip_between(file, int(here[starts[k] - 1]), int(here[starts[k]]), size, u)
        found = slip if found is None or slip.uncertainty < found.uncertainty else found
    return found


def _likeliest(values: np.ndarray, steps: np.ndarray, basis: np.ndarray) -> tuple[int, float, float, float]:
    """The step on a surface (n,p) that leaves least of values (n,): its number, size, uncertainty, variance left."""
    left, felt = values - basis @ (basis.T @ values), steps - basis @ (basis.T @ steps)
    square = np.sum(felt**2, axis=0)
    told = square > _FELT * np.sum(steps**2, axis=0)
    size = np.where(told, (felt.T @ left) / np.where(told, square, 1.0), 0.0)
    rest = left @ left - size**2 * square
    k = int(np.argmin(rest))
    variance = max(float(rest[k]), 0.0) / (len(values) - basis.shape[1] - 1) + _FLOOR**2
    return k, float(size[k]), math.sqrt(variance / max(square[k], _FELT)), variance


def _confirmed(change: np.ndarray, early: np.ndarray, row: np.ndarray, start: int, size: float, u: float) -> bool:
    """Whether the points touched again confirm a step, or none of them tells and it is no relief or burr of one edge.

    ``change`` (m,) [mm] of the points touched again, ``early`` those touched before the step; ``row`` (n,) of the grid.
    """
    if early.any() and not early.all():
        seen = float(np.median(change[early]) - np.median(change[~early]))
        return abs(seen - size) <= max(_SIGNIFICANT * u, _AGREES * abs(size))
    return len(np.unique(row[:start])) > 1 and len(np.unique(row[start:])) > 1


def _without_step(values: np.ndarray, basis: np.ndarray) -> float:
    """Variance of what a surface (n,p) leaves of values (n,) where one of them, the one that helps most, is a miss."""
    left = values - basis @ (basis.T @ values)
    free = np.maximum(1 - np.sum(basis**2, axis=1), _FELT)
    rest = float(left @ left - np.max(left**2 / free))
    return max(rest, 0.0) / (len(values) - basis.shape[1] - 1) + _FLOOR**2


def _surfaces(along: np.ndarray, upward: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Monomials of the surfaces of third (n,10) and of fourth degree (n,15)."""
    x, y = along / np.abs(along).max(), upward / np.abs(upward).max()
    _, cubic = kernel("deviation_surface")(x, y, np.zeros(10))
    fourth = np.stack([x ** (4 - power) * y**power for power in range(5)], axis=1)
    return cubic, np.hstack([cubic, fourth])


def _basis(surface: np.ndarray, first: np.ndarray) -> np.ndarray:
    """Orthonormal columns of a surface (n,p), and of what points touched again may have changed by without a slip.

    That is a motion since then, and a drift for as long as it is since each was touched: ``first`` (m,) are their rows.
    """
    n, p = surface.shape
    columns = np.zeros((n + len(first), p + 2))
    columns[:n, :p] = surface
    columns[n:, p] = 1.0
    columns[n:, p + 1] = first - np.mean(first) if len(first) else 0.0
    columns /= np.maximum(np.linalg.norm(columns, axis=0), 1e-12)
    basis, size, _ = np.linalg.svd(columns, full_matrices=False)
    return basis[:, size > 1e-9 * size[0]]
