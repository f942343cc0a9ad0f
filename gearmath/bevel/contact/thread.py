"""A contact followed through its kinds: predictor and corrector in the rotation of the pinion, from border to border.

The gear stands where the pinion stops it: sense · φ_2 is the largest over all points of both flanks. That is an
optimum within borders, followed as its parameter φ_1 moves: where the contact comes to a border, the border becomes
active (edge contact begins); where an active border is no longer pressed on, it is given up (the contact moves inside).
A thread ends where no neighbor goes on: both members have left each other, or the contact turns back.
"""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from gearmath.bevel.contact.cubics import cubic, cubic_of_two, nodes_of
from gearmath.bevel.contact.surface import BORDERS, ROOT, edges_of, on_fillet
from gearmath.bevel.contact.system import System, TouchPoint

#: Step of the pinion [rad]: the usual one, and the one below which a contact counts as lost.
_STEP, _LEAST_STEP = 0.05, 1e-5
#: Largest change of u [mm] and of β, θ [rad] of either flank from one position to the next.
_MOVES = np.array([3.0, 0.1, 0.15] * 2)
#: Corrector steps of an accepted position.
_CORRECTIONS = 6
#: Margins [mm, or rad/mm] above this are positive.
_SLACK = -1e-9
#: Margin [mm, or rad/mm] at which a border counts as reached.
_CLOSE = 1e-10
_SECANTS = 40
#: Size of a value that counts as zero: of a slope [1], or of a product of lengths by an angle [mm²/rad].
_ZERO = 1e-10
_PARTS = 24


#: Kinds of contact, from what is wanted to what must not be.
KINDS = ("interior", "edge", "corner", "fillet")


@dataclass(frozen=True)
class Segment:
    """Contacts (at least one) of one kind in the order of the rotation, from end to end."""

    touches: tuple[TouchPoint, ...]

    @cached_property
    def nodes(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Rotations (n,), x (n,7) and dx/dφ_1 (n,7) of the contacts."""
        return nodes_of(self.touches)

    def between(self, rotations: np.ndarray) -> np.ndarray:
        """x (n,7) at rotations (n,) by Hermite's cubics between the contacts."""
        return cubic(self.nodes, rotations)

    @cached_property
    def rotations(self) -> list[float]:
        return [touch.rotation for touch in self.touches]

    @property
    def active(self) -> tuple[int, ...]:
        return self.touches[0].active

    @property
    def kind(self) -> str:
        """``interior``, ``edge`` (an edge and the mate's flank, or two edges), ``corner``, or ``fillet``: an edge and
        the mate's fillet."""
        return kind_of(self.active)

    @property
    def ends(self) -> tuple[float, float]:
        return self.touches[0].rotation, self.touches[-1].rotation

    def at(self, system: System, rotation: float, assembly: np.ndarray) -> TouchPoint | None:
        """The contact at a rotation between the ends."""
        for touch in (self.touches[0], self.touches[-1]):
            if rotation == touch.rotation:
                return touch
        if len(self.touches) == 1:
            return None
        k = min(max(bisect_left(self.rotations, rotation), 1), len(self.touches) - 1)
        guess = cubic_of_two(self.touches[k - 1], self.touches[k], rotation)
        return system.solve(guess, rotation, self.active, assembly)


def kind_of(active: tuple[int, ...]) -> str:
    """The kind of a contact at these borders."""
    edges = edges_of(active)
    if len(edges) < len(active):
        return "fillet"
    if not active:
        return "interior"
    return "corner" if len(active) > 1 and len({border // len(BORDERS) for border in active}) == 1 else "edge"


@dataclass(frozen=True)
class Thread:
    """Segments in the order of the rotation, each beginning where the one before ends."""

    segments: tuple[Segment, ...]
    assembly: np.ndarray

    @property
    def ends(self) -> tuple[float, float]:
        return self.segments[0].ends[0], self.segments[-1].ends[1]

    def at(self, system: System, rotation: float) -> TouchPoint | None:
        """The contact at a rotation, None beyond the ends of the thread."""
        for segment in self.segments:
            low, high = segment.ends
            if low <= rotation <= high:
                return segment.at(system, rotation, self.assembly)
        return None

    def sample(self, system: System, rotations: np.ndarray) -> tuple[np.ndarray, list[str]]:
        """Contacts x (n,7) at rotations (n,) in one go, and their kinds; NaN and "" beyond the ends."""
        x, kinds = np.full((len(rotations), 7), np.nan), [""] * len(rotations)
        for segment in self.segments:
            low, high = segment.ends
            here = np.flatnonzero((rotations >= low) & (rotations <= high))
            if not len(here):
                continue
            x[here] = system.solve_many(
                segment.between(rotations[here]), rotations[here], segment.active, self.assembly
            )
            for k in here:
                kinds[k] = segment.kind
        return x, kinds

    def errors(self, system: System, rotations: np.ndarray) -> np.ndarray:
        """φ_2 + i φ_1 (n,) [rad] at rotations (n,) by cubics between the positions followed; NaN beyond the ends."""
        found = np.full(len(rotations), np.nan)
        for segment in self.segments:
            low, high = segment.ends
            here = (rotations >= low) & (rotations <= high)
            if here.any():
                found[here] = segment.between(rotations[here])[:, 6]
        return found + system.ratio * rotations


def follow(system: System, start: TouchPoint, assembly: np.ndarray, low: float, high: float) -> Thread:
    """The thread through a contact, within rotations from ``low`` to ``high``."""
    forward = _parts(system, start, assembly, high)
    backward = _parts(system, start, assembly, low)
    joined = (*reversed(backward[0]), *forward[0][1:])
    before = [Segment(tuple(reversed(part))) for part in reversed(backward[1:])]
    return Thread((*before, Segment(joined), *(Segment(tuple(part)) for part in forward[1:])), assembly)


def _parts(system: System, start: TouchPoint, assembly: np.ndarray, limit: float) -> list[list[TouchPoint]]:
    """Contacts in one direction, a list for each kind; the first begins with ``start``."""
    parts = [_run(system, start, assembly, limit)]
    while len(parts) < _PARTS and (following := _next(system, parts[-1][-1], assembly, limit)) is not None:
        run = _run(system, following, assembly, limit)
        if len(run) < 2:
            break
        parts.append(run)
    return parts


def _run(system: System, start: TouchPoint, assembly: np.ndarray, limit: float) -> list[TouchPoint]:
    """Contacts of one kind from ``start`` to the limit, or to where a margin becomes zero or the contact turns back."""
    touches, step = [start], _STEP
    way = 1.0 if limit > start.rotation else -1.0
    while abs(limit - touches[-1].rotation) > 0.0:
        last = touches[-1]
        ahead = way * min(step, abs(limit - last.rotation))
        following = _corrected(system, touches, last.rotation + ahead, assembly)
        if following is None or (np.abs(following.x[:6] - last.x[:6]) > _MOVES).any():
            step /= 2
            if step < _LEAST_STEP:
                break
            continue
        if following.orientation != start.orientation:
            break
        if (following.margins < _SLACK).any():
            touches.append(_border(system, last, following, assembly))
            break
        touches.append(following)
        step = min(2 * step, _STEP)
    return touches


def _corrected(
    system: System, before: Sequence[TouchPoint], rotation: float, assembly: np.ndarray
) -> TouchPoint | None:
    """The contact at a rotation, from the cubic through the last two positions, or from the tangent of one."""
    last = before[-1]
    if len(before) > 1:
        guess = cubic_of_two(before[-2], last, rotation)
    else:
        guess = last.x + (rotation - last.rotation) * last.tangent
    return system.solve(guess, rotation, last.active, assembly, _CORRECTIONS)


def _border(system: System, inside: TouchPoint, outside: TouchPoint, assembly: np.ndarray) -> TouchPoint:
    """The contact between two where the first margin is zero: in one go, else by the Illinois rule from inside."""
    parts = _crossings(inside, outside)
    which, part = int(np.argmin(parts)), float(parts.min())
    fewer = tuple(border for border in inside.active if border != which)
    guess = inside.x + part * (outside.x - inside.x)
    at = inside.rotation + part * (outside.rotation - inside.rotation)
    if (found := system.event(guess, at, fewer, which, assembly)) is not None:
        x, at = found
        if min(inside.rotation, outside.rotation) <= at <= max(inside.rotation, outside.rotation):
            touch = system.solve(x, at, inside.active, assembly)
            if touch is not None and (touch.margins >= -_CLOSE).all() and np.abs(touch.x - x).max() < _CLOSE:
                return touch
    return _border_slowly(system, inside, outside, which, assembly)


def _border_slowly(
    system: System, inside: TouchPoint, outside: TouchPoint, which: int, assembly: np.ndarray
) -> TouchPoint:
    low, high, kept = inside, outside, 0
    one, other = float(inside.margins[which]), float(outside.margins[which])
    for _ in range(_SECANTS):
        if abs(high.rotation - low.rotation) < 1e-13 or 0 <= one < _CLOSE:
            break
        rotation = low.rotation + (high.rotation - low.rotation) * one / (one - other)
        middle = system.solve(cubic_of_two(low, high, rotation), rotation, inside.active, assembly)
        if middle is None:
            break
        value = float(middle.margins[which])
        if value >= 0:
            low, one, other, kept = middle, value, other / 2 if kept == 1 else other, 1
        else:
            high, other, one, kept = middle, value, one / 2 if kept == -1 else one, -1
    return low


def _crossings(inside: TouchPoint, outside: TouchPoint) -> np.ndarray:
    """The part of the way (8,) at which each margin is zero, infinite where it is not."""
    one, other = inside.margins, outside.margins
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(other < _SLACK, np.maximum(one, 0.0) / (np.maximum(one, 0.0) - other), np.inf)


def _next(system: System, end: TouchPoint, assembly: np.ndarray, limit: float) -> TouchPoint | None:
    """The contact of another kind that goes on where one ends: a border more, a border less, or one for another."""
    way = 1.0 if limit > end.rotation else -1.0
    if not abs(limit - end.rotation) > 0.0:
        return None
    margins, edges = end.margins, edges_of(end.active)
    which = int(np.argmin(margins / np.where(np.isin(np.arange(len(margins)), edges), 1e-4, 1.0)))
    roots = tuple(border for border in end.active if border not in edges)
    if which in end.active:
        candidates = [tuple(border for border in end.active if border != which)]
    elif which % len(BORDERS) == ROOT:
        candidates = [(*end.active, which)]
    elif len(edges) < 2:
        candidates = [(*end.active, which), (*roots, which)]
    else:
        candidates = [(*roots, border, which) for border in edges]
    for active in (tuple(sorted(one)) for one in candidates):
        # a flank does not fit into the narrower fillet of its mate: only an edge does
        if any(on_fillet(active)) and not edges_of(active):
            continue
        start = system.solve(end.x, end.rotation, active, assembly)
        if start is None:
            continue
        probe = _corrected(system, [start], start.rotation + way * 1e-6, assembly)
        if probe is not None and (probe.margins >= _SLACK).all():
            return start
    return None


def zero(
    at: Callable[[float], TouchPoint | None], value: Callable[[TouchPoint], float], low: float, high: float
) -> TouchPoint | None:
    """The contact between two rotations where a value is zero, by the Illinois rule; None where it keeps its sign."""
    first, second = at(low), at(high)
    if first is None or second is None:
        return None
    one, other = value(first), value(second)
    if one == 0 or other == 0:
        return first if one == 0 else second
    if one * other > 0:
        return None
    found, kept = first, 0
    for _ in range(_SECANTS):
        rotation = low + (high - low) * one / (one - other)
        middle = at(rotation)
        if middle is None:
            return None
        found, here = middle, value(middle)
        if abs(here) < _ZERO or abs(high - low) < 1e-12 or abs(rotation - low) < 1e-13 or abs(high - rotation) < 1e-13:
            break
        # the end that stays twice counts half
        if here * one > 0:
            low, one, other, kept = rotation, here, other / 2 if kept == 1 else other, 1
        else:
            high, other, one, kept = rotation, here, one / 2 if kept == -1 else one, -1
    return found
