"""Tensor B-splines through points at given parameters: the form that STEP knows, exact where patches meet.

The poles along a border depend on the points of that border alone, so that two patches through the same border points
at the same parameters have one border curve.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

#: Degree of a patch, less where it has too few points for it.
DEGREE = 5


@dataclass(frozen=True)
class Patch:
    """Poles (n,m,3) [mm] and clamped knots with their repetitions, along rows (u) and columns (v)."""

    poles: np.ndarray
    u_knots: np.ndarray
    v_knots: np.ndarray

    @property
    def degrees(self) -> tuple[int, int]:
        n, m = self.poles.shape[:2]
        return len(self.u_knots) - n - 1, len(self.v_knots) - m - 1

    def at(self, u: np.ndarray, v: np.ndarray) -> np.ndarray:
        """Points (k,3) at parameters (k,) between 0 and 1."""
        along, across = self.degrees
        rows, columns = basis(u, self.u_knots, along), basis(v, self.v_knots, across)
        return np.einsum("ki,kj,ijc->kc", rows, columns, self.poles)

    def moved(self, matrix: np.ndarray, shift: np.ndarray) -> Patch:
        """The patch turned by a matrix (3,3) and then shifted (3,)."""
        return Patch(self.poles @ matrix.T + shift, self.u_knots, self.v_knots)


def through(points: np.ndarray, degree: int = DEGREE) -> Patch:
    """The patch through points (n,m,3) that stand at even parameters both ways."""
    n, m = points.shape[:2]
    u_knots, rows = _interpolation(n, degree)
    v_knots, columns = _interpolation(m, degree)
    half = np.linalg.solve(rows, points.reshape(n, -1)).reshape(points.shape)
    poles = np.linalg.solve(columns, half.transpose(1, 0, 2).reshape(m, -1)).reshape(m, n, 3).transpose(1, 0, 2)
    return Patch(poles, u_knots, v_knots)


def _interpolation(count: int, degree: int) -> tuple[np.ndarray, np.ndarray]:
    """Knots by averaging, and the matrix from poles to points (count, count), at even parameters."""
    degree = min(degree, count - 1)
    at = np.linspace(0.0, 1.0, count)
    inner = [at[k + 1 : k + 1 + degree].mean() for k in range(count - degree - 1)]
    knots = np.concatenate([np.zeros(degree + 1), inner, np.ones(degree + 1)])
    return knots, basis(at, knots, degree)


def basis(x: np.ndarray, knots: np.ndarray, degree: int) -> np.ndarray:
    """The B-splines (k,n) of a clamped knot vector at x (k,), by the recursion of Cox and de Boor."""
    last = len(knots) - degree - 2
    span = np.clip(np.searchsorted(knots, x, side="right") - 1, degree, last)
    found = np.zeros((len(x), len(knots) - 1))
    found[np.arange(len(x)), span] = 1.0
    for d in range(1, degree + 1):
        low, high = knots[: -d - 1], knots[d + 1 :]
        rise, fall = knots[d:-1] - low, high - knots[1:-d]
        up = np.divide(x[:, None] - low, rise, out=np.zeros((len(x), len(low))), where=rise > 0)
        down = np.divide(high - x[:, None], fall, out=np.zeros((len(x), len(low))), where=fall > 0)
        found = up * found[:, :-1] + down * found[:, 1:]
    return found
