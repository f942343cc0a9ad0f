"""How far a pair may be displaced until its pattern reaches an edge of either member: V and H, in both senses."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from gearmath.bevel.contact.local import MARKING
from gearmath.bevel.contact.mesh import Mesh, mesh
from gearmath.bevel.contact.pattern import gaps
from gearmath.bevel.contact.places import ON, Places, on_border, places
from gearmath.bevel.contact.surface import BORDERS
from gearmath.bevel.contact.system import Assembly

#: The edges of a pair, and which of the eight distances of a place tells each.
EDGES = {
    f"{member} {border}": len(BORDERS) * side + k
    for side, member in enumerate(("pinion", "gear"))
    for k, border in enumerate(BORDERS)
    if border != "root"
}
#: Displacement [mm] with which the search begins, and beyond which it ends.
_FIRST, MOST = 0.02, 5.0
_ROWS, _COLUMNS = 41, 41
#: How often ``tolerance`` tells its progress.
SEARCHES = 4
_TRIALS, _CLOSE = 30, 1e-4

#: A clearance [mm] and the edge that has it.
Beyond = tuple[float, str]


@dataclass(frozen=True)
class Limit:
    """A displacement [mm] and the edge that the pattern reaches there; None where it reaches none within ``MOST``.

    ``edge`` is "contact lost" where no pair of teeth meets any more before.
    """

    value: float
    edge: str | None


@dataclass(frozen=True)
class Tolerance:
    """By displacement ("V", "H") the limits to the negative and to the positive side, from the assembly as it is.

    ``reached`` are the edges that the pattern reaches without any displacement: they are no limits.
    """

    reached: tuple[str, ...]
    limits: dict[str, tuple[Limit, Limit]]


def clearances(run: Mesh, thickness: float = MARKING) -> dict[str, float]:
    """By edge the least gap on it less the marking ``thickness`` [mm]: not positive where the pattern reaches it.

    Infinite for an edge that does not bound the flank on which both members have a point.
    """
    found = places(run.system, run.assembly, _ROWS, _COLUMNS)
    gap = gaps(run, found)
    return {
        edge: -thickness if which in run.leads.borders else _least(found, gap, which) - thickness
        for edge, which in EDGES.items()
    }


def _least(found: Places, gap: np.ndarray, which: int) -> float:
    """The least gap along a border, from where another border crosses it to where the next does."""
    order = found.cone_distance if BORDERS[which % len(BORDERS)] == "tip" else found.height
    line = on_border(found, which, gap[..., None], order[..., None])
    line = line[np.argsort(line[:, -1], kind="stable")]
    gap, room = line[:, -2], np.delete(line[:, :-2], which, axis=1).min(axis=1, initial=math.inf)
    inside = room > -ON
    ends = inside[:-1] != inside[1:]
    part = (room[:-1] / np.where(ends, room[:-1] - room[1:], 1.0))[ends]
    at_ends = gap[:-1][ends] + np.clip(part, 0.0, 1.0) * np.diff(gap)[ends]
    return float(np.concatenate([gap[inside], at_ends]).min(initial=math.inf))


def tolerance(
    run: Mesh, thickness: float = MARKING, progress: Callable[[int], object] = lambda _: None
) -> Tolerance | None:
    """How far V and H may change until the pattern reaches one more edge; None for flanks that touch along lines."""
    if run.is_line or run.leads.peak_to_peak is None:
        return None
    here = clearances(run, thickness)
    reached = tuple(edge for edge, clear in here.items() if clear <= 0)
    given = Assembly(*run.assembly)

    def beyond(name: str, change: float) -> Beyond:
        """The least clearance of the other edges, and which edge has it."""
        moved = mesh(run.system, replace(given, **{name: getattr(given, name) + change}))
        if moved.leads.peak_to_peak is None:
            return -math.inf, "contact lost"
        left = {edge: clear for edge, clear in clearances(moved, thickness).items() if edge not in reached}
        edge = min(left, key=lambda one: left[one])
        return left[edge], edge

    least = min((clear for edge, clear in here.items() if edge not in reached), default=math.inf)
    limits = {}
    for name in ("V", "H"):
        both = []
        for sign in (-1.0, 1.0):
            both.append(_search(partial(beyond, name), least, sign))
            progress(1)
        limits[name] = (both[0], both[1])
    return Tolerance(reached, limits)


def _search(beyond: Callable[[float], Beyond], least: float, sign: float) -> Limit:
    """The first displacement found at which a clearance is zero: outwards until one is negative, then by halves."""
    low, inside, size = 0.0, least, _FIRST
    while True:
        outside, edge = beyond(sign * size)
        if outside <= 0:
            break
        if size >= MOST:
            return Limit(sign * MOST, None)
        slope = (inside - outside) / (size - low) if math.isfinite(inside) else 0.0
        ahead = outside / slope if slope > 0 else size
        low, inside, size = size, outside, min(size + min(1.3 * ahead + _CLOSE, 2 * size), MOST)
    high, kept = size, 0
    for _ in range(_TRIALS):
        if high - low < _CLOSE:
            break
        part = inside / (inside - outside) if math.isfinite(outside) and math.isfinite(inside) else 0.5
        middle = low + (high - low) * min(max(part, 0.02), 0.98)
        value, name = beyond(sign * middle)
        # the end that stays twice counts half
        if value > 0:
            low, inside, outside, kept = middle, value, outside / 2 if kept == 1 else outside, 1
        else:
            high, outside, edge, inside, kept = middle, value, name, inside / 2 if kept == -1 else inside, -1
    return Limit(sign * (low + high) / 2, edge)
