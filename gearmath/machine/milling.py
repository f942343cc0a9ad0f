"""Virtual milling: what the cutter leaves on the flanks when the machine runs a path.

For each nominal flank point the line along its outward normal is followed. At every pose the blade's swept cone, which
ends at the tip plane, takes away all of the line beyond some distance; what is left in the end is the smallest of
these distances over the whole path: the deviation, positive where metal is left on.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache

import casadi as ca
import numpy as np

from derivations import Quantity, notation
from gearmath.bevel.kernels import kernel
from gearmath.lowering import Kernel

#: Blocks are looked into where a node comes this close to the smallest distance found at any node. [mm]
_CANDIDATE_WINDOW = 5e-3
#: Distances beyond this are no contact but another place of the member. [mm]
_REACH = 20.0
_REFINEMENTS = 4
_CHUNK = 200_000


@dataclass(frozen=True)
class Blade:
    """The swept cone that cuts one flank: point radius [mm], pressure angle [rad], side +1 outer or -1 inner."""

    point_radius: float
    pressure_angle: float
    side: int


@cache
def entry_along_block() -> Kernel:
    """Kernel: distance of entry at a fraction of a block, with its first and second derivative along the block."""
    first, last = (
        Quantity(name, text, "mixed", name, shape=(5,), components=notation.axes.components)
        for name, text in (("axes_first", "axis positions at the start of the block"), ("axes_last", "at its end"))
    )
    fraction = Quantity("fraction", "0 at the start of the block, 1 at its end", "1", "s", (0.0, 1.0))
    slope = Quantity("slope", "derivative of the distance by the fraction", "mm", "t'")
    curvature = Quantity("curvature", "second derivative of the distance by the fraction", "mm", "t''")
    rest = kernel("line_entry").inputs[1:]
    a, b, s, *others = (ca.SX.sym(q.name, max(q.size, 1)) for q in (first, last, fraction, *rest))
    distance = kernel("line_entry").function(a + s * (b - a), *others)
    second, gradient = ca.hessian(distance, s)
    function = ca.Function(
        "entry_along_block", [a, b, s, *others], [distance, gradient, second],
        ["axes_first", "axes_last", "fraction", *(q.name for q in rest)], ["line_distance", "slope", "curvature"],
    )  # fmt: skip
    return Kernel(
        function, "Entry of a line into the swept blade along a straight block.", (first, last, fraction, *rest),
        (notation.line_distance, slope, curvature), "line_entry (6.4) along a G1 block",
    )  # fmt: skip


def remaining(
    axes: np.ndarray, cutting: np.ndarray, blade: Blade, pivot_height: float, point: np.ndarray, normal: np.ndarray,
    progress: Callable[[int], object] = lambda _: None,
) -> np.ndarray:  # fmt: skip
    """Distance (m,) [mm] along the outward normals at which metal remains after the whole path.

    ``axes`` (n,5) are the ends of n blocks, ``cutting`` (n,) is False where block k, from end k-1 to end k, is not
    in cutting feed with this blade. ``progress`` is called with the number of lines done.
    NaN where the blade never comes near.
    """
    ends = np.flatnonzero(cutting[1:]) + 1
    result = np.full(len(point), np.nan)
    if not len(ends):
        return result
    lines = max(1, _CHUNK // (len(ends) + 1))
    for begin in range(0, len(point), lines):
        part = slice(begin, begin + lines)
        result[part] = _remaining_part(axes, ends, blade, pivot_height, point[part], normal[part])
        progress(len(result[part]))
    return result


def _remaining_part(
    axes: np.ndarray, ends: np.ndarray, blade: Blade, pivot_height: float, point: np.ndarray, normal: np.ndarray
) -> np.ndarray:
    m = len(point)
    used = np.union1d(ends - 1, ends)
    nodes = np.full((m, len(axes)), np.inf)
    line, node = (index.ravel() for index in np.meshgrid(np.arange(m), used, indexing="ij"))
    cone = (blade.point_radius, blade.pressure_angle, blade.side)
    (at_nodes,) = kernel("line_entry")(axes[node], pivot_height, point[line], normal[line], *cone)
    nodes[line, node] = at_nodes
    best = nodes[:, used].min(axis=1)
    window = np.maximum(best, 0) + _CANDIDATE_WINDOW
    lower = np.minimum(nodes[:, ends - 1], nodes[:, ends])
    line, block = np.nonzero((lower < window[:, None]) & (best < _REACH)[:, None])
    block = ends[block]
    inside = _smallest_within(axes[block - 1], axes[block], point[line], normal[line], pivot_height, cone)
    np.minimum.at(best, line, inside)
    best[best >= _REACH] = np.nan
    return best


def _smallest_within(
    first: np.ndarray, last: np.ndarray, point: np.ndarray, normal: np.ndarray, pivot_height: float, cone: tuple
) -> np.ndarray:
    """Smallest distance found inside each block: Newton on the slope from the middle, every value tried counts."""
    if not len(first):
        return np.empty(0)
    smallest = np.full(len(first), np.inf)
    s = np.full(len(first), 0.5)
    for _ in range(_REFINEMENTS):
        distance, slope, curvature = entry_along_block()(first, last, s, pivot_height, point, normal, *cone)
        smallest = np.minimum(smallest, distance)
        curved = np.where(curvature > 0, curvature, math.inf)
        s = np.clip(s - np.where(np.isfinite(slope / curved), slope / curved, 0.0), 0.0, 1.0)
    return smallest
