"""Virtual milling with single blades: what the edges of a face hobbing cutter leave on lines when all six axes move.

A line is cut where an edge crosses it. The blades that come near it are found from the executed path alone: seen from
the tool, the line's point is passed by a blade whenever C, counted in blade groups, passes the point's azimuth. From
each of these passes Newton's steps lead to the crossing of line and edge; the smallest distance of all is what is left.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from gearmath.bevel.turning import half_turn
from gearmath.kernels import kernel
from gearmath.machine.bodies.blades import Blades, Edge, crossing
from gearmath.machine.bodies.profiles import seen_from_axes
from gearmath.machine.milling.removal import Removal

#: Between two nodes neither A nor C turns further than this. [rad]
_NODE_STEP = 0.5
#: Edges are followed where they pass the line's point within the length of the line behind it, and this. [mm]
_WINDOW = 1.0
#: A crossing may lie outside of its block by this part of it, off the end of its edge by this [mm or rad], and leaves
#: no more than this between edge and line. [mm]
_BLOCK_SLACK, _EDGE_SLACK, _RESIDUAL = 1e-9, 1e-7, 1e-7
#: How often a crossing that lies beyond the end of its block is looked for in the next one.
_BLOCKS_ON = 2
#: Lines whose nodes are looked at together; points of one call of a kernel.
_LINES, _CHUNK = 16, 20_000

_Computed = Callable[..., tuple[np.ndarray, ...]]


@dataclass(frozen=True)
class _Path:
    """Blocks as pairs of ends (b,6), which row of the path each of them ends at, and where the nodes are."""

    first: np.ndarray
    last: np.ndarray
    row: np.ndarray
    block: np.ndarray
    fraction: np.ndarray

    @staticmethod
    def of(axes: np.ndarray, cutter: np.ndarray, cutting: np.ndarray) -> _Path:
        row = np.flatnonzero(cutting[1:]) + 1
        every = np.column_stack([axes, cutter])
        first, last = every[row - 1], every[row]
        parts = np.maximum(np.ceil(np.abs(last - first)[:, 3::2].max(axis=1) / _NODE_STEP).astype(int), 1)
        block = np.repeat(np.arange(len(row)), parts + 1)
        within = np.arange(len(block)) - np.repeat(np.cumsum(parts + 1) - (parts + 1), parts + 1)
        return _Path(first, last, row, block, within / np.repeat(parts, parts + 1))

    @property
    def nodes(self) -> np.ndarray:
        """Positions (n,6); the end of a block and the start of the next are two nodes."""
        first, last = self.first[self.block], self.last[self.block]
        return first + self.fraction[:, None] * (last - first)


@dataclass(frozen=True)
class _Passes:
    """Blades that pass lines: line, block, fraction, place of the line's point, and angle of the blade's group."""

    line: np.ndarray
    block: np.ndarray
    fraction: np.ndarray
    radius: np.ndarray
    height: np.ndarray
    group_angle: np.ndarray

    def at(self, chosen: np.ndarray) -> _Passes:
        return _Passes(*(getattr(self, name)[chosen] for name in _Passes.__dataclass_fields__))


def removal_by_blades(
    axes: np.ndarray,
    cutter: np.ndarray,
    cutting: np.ndarray,
    blades: Blades,
    machine: tuple,
    point: np.ndarray,
    normal: np.ndarray,
    start: np.ndarray,
    progress: Callable[[int], object] = lambda _: None,
) -> Removal:
    """What the blades leave of lines along ``normal`` (m,3) through ``point`` (m,3), and the blocks that cut deepest.

    ``axes`` (n,5) and ``cutter`` (n,) are the ends of n blocks, ``cutting`` (n,) is False where block k does not cut;
    ``machine`` is pivot height and offset. What crosses a line before its ``start`` (m,) [mm] belongs to another space.
    """
    path = _Path.of(axes, cutter, cutting)
    best, block = np.full(len(point), np.inf), np.full(len(point), -1)
    starts = np.broadcast_to(np.asarray(start, dtype=float), (len(point),))
    nodes, seen = path.nodes, kernel("seen_from_blades")
    poses = kernel("tool_pose")(nodes[:, :5], *machine)
    crosses = {is_arc: crossing(is_arc) for is_arc in {edge.is_arc for edge in blades.edges}}
    for begin in range(0, len(point), _LINES):
        rows = np.arange(begin, min(begin + _LINES, len(point)))
        reach = _WINDOW - float(starts[rows].min())
        given_passes = {
            phase: _passes(path, nodes, poses, point[rows], blades, phase, machine, reach, seen)
            for phase in {edge.phase for edge in blades.edges}
        }
        for edge in blades.edges:
            passes = given_passes[edge.phase]
            _, radius, height = edge.middle
            near = np.hypot(passes.radius - radius, passes.height - height) < reach + edge.half_length
            here = passes.at(near)
            given = (point[rows][here.line], normal[rows][here.line])
            distance, at = _crossings(path, here, edge, machine, given, crosses[edge.is_arc])
            distance = np.where(distance >= starts[rows][here.line], distance, np.inf)
            order = np.argsort(-distance, kind="stable")  # the smallest of a line is written last
            deeper = order[distance[order] < best[rows][here.line[order]]]
            best[rows[here.line[deeper]]], block[rows[here.line[deeper]]] = distance[deeper], at[deeper]
        progress(len(rows))
    met = np.isfinite(best)
    return Removal(np.where(met, best, np.nan), np.where(met, block, -1))


def _passes(
    path: _Path,
    nodes: np.ndarray,
    poses: tuple[np.ndarray, ...],
    point: np.ndarray,
    blades: Blades,
    phase: float,
    machine: tuple,
    reach: float,
    seen: _Computed,
) -> _Passes:
    """All passes of the blades at a ``phase`` [rad] of the groups within ``reach`` [mm] of any edge of the path."""
    line, node = np.nonzero(_near(poses, point, blades, reach) & (np.diff(path.block) == 0))
    before, after = (_in_chunks(seen, len(node), nodes[node + k, :5], point[line], *machine) for k in (0, 1))
    pitch = 2 * math.pi / blades.groups
    off = nodes[node, 5] + phase - before[2]
    turned = half_turn(after[2] - before[2])
    change = nodes[node + 1, 5] - nodes[node, 5] - turned
    low, count = np.minimum(off, off + change) / pitch, np.abs(change) / pitch
    found = []
    for k in range(int(np.ceil(count.max(initial=0.0))) + 1):
        number = np.floor(low) + 1 + k
        chosen = np.flatnonzero(number <= low + count)
        j, part = node[chosen], (number[chosen] * pitch - off[chosen]) / change[chosen]

        def between(a: np.ndarray, b: np.ndarray, part: np.ndarray = part) -> np.ndarray:
            return a + part * (b - a)

        found.append(
            _Passes(
                line[chosen],
                path.block[j],
                between(path.fraction[j], path.fraction[j + 1]),
                between(before[1][chosen], after[1][chosen]),
                between(before[0][chosen], after[0][chosen]),
                phase - number[chosen] * pitch,
            )
        )
    return _Passes(*(np.concatenate([getattr(one, f) for one in found]) for f in _Passes.__dataclass_fields__))


def _near(poses: tuple[np.ndarray, ...], point: np.ndarray, blades: Blades, reach: float) -> np.ndarray:
    """Whether points (m,3) come near an edge, whatever its direction, between two nodes: (m,n-1)."""
    center, axis = poses
    along, radius = (part.T for part in seen_from_axes(point, center, axis))
    height = -along
    way = np.hypot(np.diff(radius, axis=1), np.diff(height, axis=1))
    near = np.zeros(way.shape, dtype=bool)
    for edge in blades.edges:
        _, middle_radius, middle_height = edge.middle
        away = np.hypot(radius - middle_radius, height - middle_height)
        near |= np.minimum(away[:, :-1], away[:, 1:]) - way / 2 < reach + edge.half_length
    return near


def _crossings(
    path: _Path, passes: _Passes, edge: Edge, machine: tuple, line: tuple[np.ndarray, np.ndarray], crosses: _Computed
) -> tuple[np.ndarray, np.ndarray]:
    """Distance (p,) [mm] at which an edge crosses the line of each pass, infinite where it does not, and the row."""
    block = passes.block.copy()
    guess = np.column_stack([edge.parameter(passes.radius, passes.height), passes.fraction, np.zeros(len(block))])
    distance = np.full(len(block), np.inf)
    open_ = np.arange(len(block))
    for _ in range(1 + _BLOCKS_ON):
        if not len(open_):
            break
        k = block[open_]
        first, last = path.first[k], path.last[k]
        angle = passes.group_angle[open_]
        found, rest = _in_chunks(
            crosses,
            len(open_),
            guess[open_],
            first[:, :5],
            last[:, :5],
            first[:, 5] + angle,
            last[:, 5] + angle,
            *machine,
            *edge.arguments,
            line[0][open_],
            line[1][open_],
        )
        u, s, t = found.T
        there = (rest < _RESIDUAL) & (u > edge.lower - _EDGE_SLACK) & (u < edge.upper + _EDGE_SLACK)
        within = there & (s >= -_BLOCK_SLACK) & (s <= 1 + _BLOCK_SLACK)
        distance[open_[within]] = t[within]
        onward = np.where(s > 1, 1, -1)
        follows = (k + onward >= 0) & (k + onward < len(path.row))
        follows &= path.row[np.clip(k + onward, 0, len(path.row) - 1)] == path.row[k] + onward
        again = there & ~within & follows
        open_ = open_[again]
        block[open_] += onward[again]
        guess[open_] = np.column_stack([u[again], np.where(onward[again] > 0, 0.0, 1.0), t[again]])
    return distance, path.row[block]


def _in_chunks(run: _Computed, count: int, *arguments: object) -> tuple:
    """A kernel for many points, so many at a time."""
    parts = []
    for begin in range(0, max(count, 1), _CHUNK):
        piece = slice(begin, begin + _CHUNK)
        parts.append(run(*(a[piece] if isinstance(a, np.ndarray) and len(a) == count else a for a in arguments)))
    return tuple(np.concatenate(columns) for columns in zip(*parts, strict=True))
