"""The area in which a field on a grid is below a level: triangles cut where the field, linear in each, meets it.

Unlike a count of grid points, area and center change smoothly with the field, so that they have derivatives.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

#: Keeps a division by zero away where a triangle has one value at all corners.
_LEAST = 1e-300


@dataclass(frozen=True)
class MarkedArea:
    """Part of the whole area that is marked, its extent along x, and its center (2,), NaN where there is none."""

    share: float
    length: float
    center: np.ndarray


def marked_area(x: np.ndarray, y: np.ndarray, field: np.ndarray, level: float) -> MarkedArea:
    """Where ``field`` (rows, columns) is at or below a level, over points x, y; NaN of the field is not marked."""
    corners, whole = _triangles(x, y, field - level)
    pieces = _marked_pieces(corners)
    area = _area(pieces)
    total = float(area.sum())
    if not total > 0:
        return MarkedArea(0.0, 0.0, np.full(2, np.nan))
    center = (area[:, None] * pieces.mean(axis=1)[:, :2]).sum(axis=0) / total
    across = pieces[area > 0][..., 0]
    return MarkedArea(total / whole, float(np.ptp(across)), center)


def _triangles(x: np.ndarray, y: np.ndarray, value: np.ndarray) -> tuple[np.ndarray, float]:
    """Both halves of every cell as corners (n,3,3) of x, y, value, where each has a value; and the whole area."""
    points = np.stack([x, y, value], axis=-1)
    a, b, c, d = points[:-1, :-1], points[:-1, 1:], points[1:, 1:], points[1:, :-1]
    every = np.concatenate([np.stack(three, axis=2).reshape(-1, 3, 3) for three in ((a, b, c), (a, c, d))])
    return every[np.isfinite(every).all(axis=(1, 2))], float(_area(every).sum())


def _marked_pieces(corners: np.ndarray) -> np.ndarray:
    """The parts of triangles (n,3,3) where the value is not positive, as triangles (m,3,3)."""
    order = np.argsort(corners[..., 2], axis=1)
    low, middle, high = np.moveaxis(np.take_along_axis(corners, order[..., None], axis=1), 1, 0)
    below = (corners[..., 2] <= 0).sum(axis=1)
    whole = corners[below == 3]
    one, two = below == 1, below == 2
    tip = np.stack([low[one], _cut(low[one], middle[one]), _cut(low[one], high[one])], axis=1)
    left, right = _cut(low[two], high[two]), _cut(middle[two], high[two])
    halves = np.stack([low[two], middle[two], left], axis=1), np.stack([middle[two], right, left], axis=1)
    return np.concatenate([whole, tip, *halves])


def _cut(low: np.ndarray, high: np.ndarray) -> np.ndarray:
    """Where the value is zero between points (n,3)."""
    part = -low[:, 2:] / np.maximum(high[:, 2:] - low[:, 2:], _LEAST)
    return low + part * (high - low)


def _area(corners: np.ndarray) -> np.ndarray:
    one, other = corners[:, 1, :2] - corners[:, 0, :2], corners[:, 2, :2] - corners[:, 0, :2]
    return np.abs(one[:, 0] * other[:, 1] - one[:, 1] * other[:, 0]) / 2
