"""Virtual milling: what a cutter leaves on the lines along the normals of a surface when the machine runs a path.

At every pose the cutter, a body of revolution, takes a part of each line away. From its start behind the surface on,
what is left of a line ends where the first such part begins: the smallest of these distances over the whole path is
the deviation, positive where metal is left on, negative for a gouge. All poses of a path are asked for the sharp cones
that hold the cutter; the blocks in which the smallest distance can lie are then divided, with the true cutter.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache

import casadi as ca
import numpy as np

from derivations import Quantity, notation
from gearmath.engine.kernel import Kernel
from gearmath.kernels import kernel
from gearmath.machine.bodies.cutter import Body, Cutter, one_blade

#: Blocks are looked into where a node comes this close to the smallest distance found at any node. [mm]
_CANDIDATE_WINDOW = 5e-3
#: Blocks beside a node that is lower than its neighbours are looked into up to this far above the smallest. [mm]
_DIP_WINDOW = 1.0
#: Distances beyond this are no contact but another place of the member. [mm]
REACH = 20.0
_NEWTON_STEPS = 7
#: A point this little outside of the cutter counts as on it. [mm]
_ON_CUTTER = 1e-7
#: Blocks are divided so often, or until what lies between their samples is this little lower. [mm]
_SAMPLES, _DIVISIONS, _SETTLED = 9, 8, 1e-9
#: Lines whose candidates are divided together.
_LINES = 64


_base = Quantity("base", "height of the body's tip plane above that of the cutter", "mm", "h_0", (0.0, 10.0))
_annulus = Quantity(
    "annulus", "point radius and slope of the outer cone, then of the inner one", "mixed", r"\mathbf{w}", shape=(4,)
)


@dataclass(frozen=True)
class Blade:
    """The swept cone that cuts one flank: point radius [mm], pressure angle [rad], side +1 outer or -1 inner."""

    point_radius: float
    pressure_angle: float
    side: int

    @property
    def cutter(self) -> Cutter:
        """The cutter that is this cone alone."""
        return one_blade(self.point_radius, self.pressure_angle, self.side)


@dataclass(frozen=True)
class Removal:
    """What is left of each line (m,) [mm], NaN where nothing was taken away, and the block (m,) that did it, or -1."""

    distance: np.ndarray
    block: np.ndarray

    def joined(self, other: Removal, offset: int) -> Removal:
        """With what another tool takes away, whose blocks count from ``offset``."""
        first, second = (np.nan_to_num(part.distance, nan=np.inf) for part in (self, other))
        later = second < first
        distance = np.where(later, second, first)
        block = np.where(later, other.block + offset, self.block)
        return Removal(np.where(np.isfinite(distance), distance, np.nan), block)


@cache
def annulus_entry() -> Kernel:
    """Kernel: where a line is first taken away by the sharp annulus at one pose."""
    pose = (notation.cutter_center_w, notation.cutter_axis_w, notation.line_point, notation.line_direction)
    quantities = (*pose, notation.line_start, _annulus)
    *line, start, w = (ca.SX.sym(q.name, max(q.size, 1)) for q in quantities)
    outer, hole = (kernel("line_in_cone").function(*line, w[k], w[k + 1], side) for k, side in ((0, 1), (2, -1)))
    distance = ca.cse(kernel("first_removed").function(start, *outer, *hole))
    function = ca.Function(
        "annulus_entry", [*line, start, w], [distance], [q.name for q in quantities], ["line_distance"]
    )
    return Kernel(
        function,
        "Where a line, from its start on, is first taken away by an annular cutter at one pose.",
        quantities,
        (notation.line_distance,),
        "(16.3) of both cones and the tip plane, (16.4)",
    )


@cache
def entry_along_block(sharp: bool) -> Kernel:
    """Kernel: the same at a fraction of a block, for the true cutter unless ``sharp``: Newton's steps on (16.5)."""
    first, last = (
        Quantity(name, text, "mixed", name, shape=(5,), components=notation.axes.components)
        for name, text in (("axes_first", "axis positions at the start of the block"), ("axes_last", "at its end"))
    )
    fraction = Quantity("fraction", "0 at the start of the block, 1 at its end", "1", "s", (0.0, 1.0))
    machine = kernel("tool_pose").inputs[1:]
    quantities = (
        first,
        last,
        fraction,
        *machine,
        _base,
        notation.line_point,
        notation.line_direction,
        notation.line_start,
        _annulus,
        notation.outer_blade,
        notation.inner_blade,
    )
    symbols = [ca.SX.sym(q.name, max(q.size, 1)) for q in quantities]
    a, b, s = symbols[:3]
    base, point, direction, start, annulus, outer, inner = symbols[-7:]
    center, axis = kernel("tool_pose").function(a + s * (b - a), *symbols[3:-7])
    pose = (center - base * axis, axis, point, direction)
    t = annulus_entry().function(*pose, start, annulus)
    if not sharp:
        t = _onto_cutter(t, *pose, outer, inner)
    function = ca.Function("entry_along_block", symbols, [ca.cse(t)], [q.name for q in quantities], ["line_distance"])
    return Kernel(
        function,
        "Where a line is first taken away at a fraction of a straight block.",
        quantities,
        (notation.line_distance,),
        "annulus_entry, then Newton on (16.5)",
    )


def _onto_cutter(t: ca.SX, center: ca.SX, axis: ca.SX, point: ca.SX, direction: ca.SX, *blades: ca.SX) -> ca.SX:
    """From the sharp cones on to the true cutter; NOWHERE where the line passes it by."""
    place = ca.SX.sym("line_place")
    arguments = [ca.SX.sym(f"a{k}", value.numel()) for k, value in enumerate((center, axis, point, direction, *blades))]
    height, radius = kernel("place_in_cutter").function(*arguments[:4], place)
    excess = kernel("cutter_excess").function(height, radius, *arguments[4:])
    slope = ca.jacobian(excess, place)
    nowhere = float(notation.NOWHERE)
    onward = ca.if_else(slope < 0, place - excess / slope, nowhere)
    step = ca.Function("step", [place, *arguments], [ca.if_else(excess > _ON_CUTTER / 10, onward, place)])
    outside = ca.Function("outside", [place, *arguments], [excess])
    given = (center, axis, point, direction, *blades)
    for _ in range(_NEWTON_STEPS):
        t = ca.if_else(t < nowhere, step(t, *given), nowhere)
    return ca.if_else(outside(t, *given) <= _ON_CUTTER, t, nowhere)


def removal(
    axes: np.ndarray,
    cutting: np.ndarray,
    cutter: Cutter,
    machine: tuple,
    point: np.ndarray,
    normal: np.ndarray,
    start: np.ndarray | float = -REACH,
    progress: Callable[[int], object] = lambda _: None,
) -> Removal:
    """What a path leaves of lines along ``normal`` (m,3) through ``point`` (m,3), and which blocks it is left by.

    ``axes`` (n,5) are the ends of n blocks, ``cutting`` (n,) is False where block k, from end k-1 to end k, does not
    cut. ``machine`` are the further arguments of the kernel tool_pose. Lines begin at ``start`` [mm], which is what
    they keep at least: a gouge that deep, or deeper, has this value. ``progress`` gets the number of lines done.
    """
    ends = np.flatnonzero(cutting[1:]) + 1
    best, block = np.full(len(point), np.nan), np.full(len(point), -1)
    starts = np.broadcast_to(np.asarray(start, dtype=float), (len(point),))
    if len(ends):
        used = np.union1d(ends - 1, ends)
        where = np.zeros(len(axes), dtype=int)
        where[used] = np.arange(len(used))
        poses = kernel("tool_pose")(axes[used], *machine)
        for begin in range(0, len(point), _LINES):
            rows = np.arange(begin, min(begin + _LINES, len(point)))
            lines = (point[rows], normal[rows], starts[rows])
            for body in cutter.bodies:
                found, at = _of_body(axes, ends, where[ends], poses, body, machine, lines)
                closer = found < np.nan_to_num(best[rows], nan=np.inf)
                best[rows], block[rows] = np.where(closer, found, best[rows]), np.where(closer, at, block[rows])
            progress(len(rows))
    far = ~(best < REACH)
    best[far], block[far] = np.nan, -1
    return Removal(best, block)


def remaining(
    axes: np.ndarray,
    cutting: np.ndarray,
    blade: Blade | Cutter,
    pivot_height: float,
    point: np.ndarray,
    normal: np.ndarray,
    progress: Callable[[int], object] = lambda _: None,
) -> np.ndarray:
    """Distance (m,) [mm] of :func:`removal` on a machine without pivot offset."""
    cutter = blade.cutter if isinstance(blade, Blade) else blade
    return removal(axes, cutting, cutter, (pivot_height,), point, normal, progress=progress).distance


_Lines = tuple[np.ndarray, np.ndarray, np.ndarray]


def _of_body(
    axes: np.ndarray,
    ends: np.ndarray,
    place: np.ndarray,
    poses: tuple[np.ndarray, ...],
    body: Body,
    machine: tuple,
    lines: _Lines,
) -> tuple[np.ndarray, np.ndarray]:
    """Smallest distance (m,) of one body on some lines and the block it is in."""
    center, axis = poses
    entry, annulus = annulus_entry(), body.annulus
    raised = center - body.base * axis
    at_nodes = np.stack([entry(raised, axis, p, d, t, annulus)[0] for p, d, t in zip(*lines, strict=True)])
    first, last = at_nodes[:, place - 1], at_nodes[:, place]
    lower = np.minimum(first, last)
    best = lower.min(axis=1, keepdims=True)
    slack = 0.0 if body.sharp else 0.5 * max(body.outer.edge_radius, body.inner.edge_radius)
    floor = np.maximum(best, lines[2][:, None])
    near = lower < np.maximum(floor, 0.0) + _CANDIDATE_WINDOW + slack
    line, k = np.nonzero((near | _beside_dips(lower, floor + _DIP_WINDOW + slack)) & (best < REACH))
    return _divide(axes, ends[k], line, body, machine, lines)


def _beside_dips(lower: np.ndarray, limit: np.ndarray) -> np.ndarray:
    """Blocks (m,b) that are no higher than their neighbours: a contact shorter than a block lies beside its node."""
    padded = np.pad(lower, ((0, 0), (1, 1)), constant_values=np.inf)
    return (lower <= padded[:, :-2]) & (lower <= padded[:, 2:]) & (lower < limit)


def _divide(
    axes: np.ndarray,
    block: np.ndarray,
    line: np.ndarray,
    body: Body,
    machine: tuple,
    lines: _Lines,
) -> tuple[np.ndarray, np.ndarray]:
    """Smallest distance within candidate blocks: sampled, and again around the smallest sample.

    A candidate is given up when what its samples differ by cannot bring it below the smallest distance of its line, or
    is nothing.
    """
    entry = entry_along_block(body.sharp)
    count = len(lines[0])
    best, at = np.full(count, np.inf), np.full(count, -1)
    low, width = np.zeros(len(block)), np.ones(len(block))
    blades = (body.annulus, body.outer.vector, body.inner.vector)
    for _ in range(_DIVISIONS):
        if not len(block):
            break
        s = low[:, None] + width[:, None] * np.linspace(0.0, 1.0, _SAMPLES)
        many = np.repeat(np.arange(len(block)), _SAMPLES)
        begin, end = axes[block - 1][many], axes[block][many]
        given = [part[line][many] for part in lines]
        pivot = machine if len(machine) == len(kernel("tool_pose").inputs) - 1 else (*machine, np.zeros(3))
        (t,) = entry(begin, end, s.ravel(), *pivot, body.base, *given, *blades)
        t = t.reshape(s.shape)
        k = t.argmin(axis=1)
        smallest = t[np.arange(len(t)), k]
        order = np.argsort(-smallest, kind="stable")  # the smallest of a line is written last
        closer = order[smallest[order] < best[line[order]]]
        best[line[closer]], at[line[closer]] = smallest[closer], block[closer]
        sides = np.stack([t[np.arange(len(t)), np.clip(k + off, 0, _SAMPLES - 1)] for off in (-1, 1)])
        lower = sides.max(axis=0) - smallest  # by so much at most does it come lower between its samples
        keep = (smallest - lower <= best[line]) & (smallest < REACH) & (lower > _SETTLED)
        left, right = (s[np.arange(len(s)), np.clip(k + off, 0, _SAMPLES - 1)] for off in (-1, 1))
        block, line, low, width = block[keep], line[keep], left[keep], (right - left)[keep]
    return best, at
