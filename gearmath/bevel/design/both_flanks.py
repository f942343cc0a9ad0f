"""A pinion whose flanks are cut at once: path, parabola and place of both sides from one machine (27.6).

One machine gives both flanks exactly the points of contact with their normals, and the parabolas. All that is left of
its settings brings the gaps of both whole flanks nearest to the wanted ones, the root near that of the blank: path and
ellipse are met as nearly as the machine can, and stated.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace

import numpy as np

from gearmath.bevel.design import both_system as system
from gearmath.bevel.design.both_system import NAMES, SIZES, FlankPoint, index
from gearmath.bevel.design.local_settings import FIRST, MOVING
from gearmath.bevel.design.local_settings import NAMES as OF_FLANK
from gearmath.bevel.design.rolling import Meeting
from gearmath.bevel.generation import Generation
from gearmath.bevel.identify.flank_target import FlankTarget, locate
from gearmath.bevel.identify.least_squares import minimize
from gearmath.bevel.identify.variables import NAMES as WHOLE
from gearmath.bevel.newton import FlankPoints
from gearmath.specs.bevel_set import SETTINGS

#: Newton steps of the conditions, and to what they are met. [mm]
_STEPS, _TOLERANCE = 25, 1e-9
#: Parts of the way from the crown gear to the wanted points.
_PARTS = 6
#: A coordinate of the settings counts so much in the RMS for each of its sizes [mm], that among flanks alike the one is
#: found which changes least; and beyond its bound so much more.
_RIDGE, _BEYOND = 1e-4, 0.02
#: What the root counts of how far it is off, and beyond the room that it has.
_NEAR_ROOT, _OFF_ROOT = 0.005, 0.1
#: What a parabola counts of how far it is off half a pitch from its vertex, before it is held.
_PARABOLA = 10.0
#: Coordinates go no farther, in sizes.
_FARTHEST = 60.0


@dataclass(frozen=True)
class Side:
    """What is wanted of one flank: how it is cut, the point, and the gap (n,) [mm] at conjugate places (n,)."""

    flank: str
    how: Generation
    wanted: FlankPoint
    meeting: Meeting
    gap: np.ndarray

    def among(self, kept: np.ndarray) -> Side:
        """The same with some of the places."""
        meeting = Meeting(*(array[kept] for array in vars(self.meeting).values()))
        return replace(self, meeting=meeting, gap=self.gap[kept])


@dataclass(frozen=True)
class BothFlanks:
    """The problem: both sides, the ``cone`` (3,) and the depths (2,) of the root, which of ``NAMES`` are free, and the
    bounds (35,2) of all. ``reach`` [mm] is the length over which angles count, ``weigh`` how much a second derivative
    [rad/rad²] counts as a length [mm]. The root may lie off by ``room`` [mm]."""

    sides: tuple[Side, Side]
    cone: np.ndarray
    depth: np.ndarray
    free: tuple[str, ...]
    bounds: np.ndarray
    reach: float
    weigh: float
    room: float
    parabolas_held: bool = True

    @property
    def index(self) -> list[int]:
        return [NAMES.index(name) for name in self.free]

    def conditions(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """How far points, root and, where asked, parabolas are off [mm], and the derivatives by ``NAMES``."""
        off, rates = [], []
        for side in self.sides:
            found = system.at_point(side.how, side.flank, x, side.wanted)
            scale = np.array([1, 1, 1, self.reach, self.reach, 1])
            off.append(found.off * scale)
            rates.append(found.rates[:6] * scale[:, None])
            if self.parabolas_held:
                off.append(np.array([self.weigh * (found.parabola - side.wanted.parabola)]))
                rates.append(self.weigh * found.rates[6:7])
            root, by_root = system.at_root(side.how, side.flank, x, self.cone)
            off.append(root[:4])
            rates.append(by_root[:4])
        return np.concatenate(off), np.vstack(rates)

    def root(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """What the depths of the root count in the fit (8,) [mm], and the derivatives."""
        off, rates = [], []
        for side in self.sides:
            found, by_x = system.at_root(side.how, side.flank, x, self.cone)
            deep = found[4:] - self.depth
            beyond = np.sign(deep) * np.maximum(np.abs(deep) - self.room, 0)
            off += [_NEAR_ROOT * deep, _OFF_ROOT * beyond]
            rates += [_NEAR_ROOT * by_x[4:], _OFF_ROOT * (beyond != 0)[:, None] * by_x[4:]]
        return np.concatenate(off), np.vstack(rates)

    def parabolas(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """What parabolas count in the fit (2,) [mm] where they are not held, and the derivatives."""
        if self.parabolas_held:
            return np.zeros(0), np.zeros((0, len(NAMES)))
        found = [system.at_point(side.how, side.flank, x, side.wanted) for side in self.sides]
        weight = _PARABOLA * self.weigh
        off = [weight * (one.parabola - side.wanted.parabola) for one, side in zip(found, self.sides, strict=True)]
        return np.array(off), weight * np.vstack([one.rates[6] for one in found])

    def met(self, x: np.ndarray, held: np.ndarray, values: np.ndarray) -> Met | None:
        """The vector near ``x`` that meets the conditions, at ``values`` (p,) of the coordinates ``held`` (p,f)."""
        x, where, sizes = x.copy(), self.index, SIZES[self.index]
        origin = x[where].copy()
        for _ in range(_STEPS):
            off, rates = self.conditions(x)
            if not (np.isfinite(off).all() and np.isfinite(rates).all()):
                return None
            along = held @ ((x[where] - origin) / sizes) - values
            matrix = np.vstack([rates[:, where] * sizes, held])
            if np.abs(off).max() < _TOLERANCE and np.abs(along).max(initial=0.0) < _TOLERANCE:
                moved = _solved(matrix, np.vstack([np.zeros((len(off), len(held))), np.eye(len(held))]))
                return Met(x, moved * sizes[:, None])
            step = _solved(matrix, -np.concatenate([off, along]))
            x[where] += sizes * step / max(1.0, float(np.abs(step).max()) / 5)
        return None


def _solved(matrix: np.ndarray, right: np.ndarray) -> np.ndarray:
    """What solves a linear system, or comes nearest to it: with as many unknowns as equations, many times faster."""
    if matrix.shape[0] == matrix.shape[1]:
        with suppress(np.linalg.LinAlgError):
            return np.linalg.solve(matrix, right)
    return np.linalg.lstsq(matrix, right)[0]


@dataclass(frozen=True)
class Met:
    """A vector (35,) that meets the conditions, and how its free settings (f,p) move with the coordinates."""

    x: np.ndarray
    rates: np.ndarray


@dataclass(frozen=True)
class FittedBoth:
    """The vector found, by flank the gap less the wanted one (n,) [mm], and the bounds that were reached."""

    x: np.ndarray
    off: dict[str, np.ndarray]
    active: tuple[str, ...]


def local(problem: BothFlanks, x: np.ndarray) -> np.ndarray | None:
    """From the crown gear's settings to those of the wanted points and, where they are held, parabolas; None where the
    way ends."""
    begin = [system.at_point(side.how, side.flank, x, side.wanted).off for side in problem.sides]
    none = np.zeros((0, len(problem.free)))
    for part in np.linspace(0, 1, _PARTS + 1)[1:]:
        sides = []
        for side, off in zip(problem.sides, begin, strict=True):
            rest = (1 - part) * off
            normal = side.wanted.normal + side.wanted.basis @ rest[3:5]
            sides.append(replace(side, wanted=_leaning(side.wanted, rest[:3], normal)))
        there = replace(problem, sides=(sides[0], sides[1]))
        found = there.met(x, none, np.zeros(0))
        if found is None:
            return None
        x = found.x
    return x


def nearest(problem: BothFlanks, x: np.ndarray) -> np.ndarray:
    """The vector nearest to ``x`` that meets the conditions, or where Newton's method fails ``x`` itself."""
    found = problem.met(x, np.zeros((0, len(problem.free))), np.zeros(0))
    return x if found is None else found.x


def moved(problem: BothFlanks, x: np.ndarray, held: Sequence[str], values: Sequence[float]) -> np.ndarray | None:
    """The vector with settings that are not free brought to values step by step; None where the way ends."""
    places = [NAMES.index(name) for name in held]
    none, begin = np.zeros((0, len(problem.free))), x[places]
    for part in np.linspace(0, 1, _PARTS + 1)[1:]:
        x = x.copy()
        x[places] = begin + part * (np.asarray(values) - begin)
        found = problem.met(x, none, np.zeros(0))
        if found is None:
            return None
        x = found.x
    return x


def _leaning(wanted: FlankPoint, moved: np.ndarray, normal: np.ndarray) -> FlankPoint:
    """The wanted point moved (3,), its basis turned so that it is square to a ``normal`` nearby."""
    n = normal / np.linalg.norm(normal)
    first = wanted.basis[:, 0] - n * (n @ wanted.basis[:, 0])
    first /= np.linalg.norm(first)
    second = np.cross(n, first)
    second *= np.sign(second @ wanted.basis[:, 1])
    return replace(wanted, point=wanted.point + moved, normal=n, basis=np.column_stack([first, second]))


def whole(problem: BothFlanks, x: np.ndarray, contacts: Sequence[np.ndarray]) -> FittedBoth | None:
    """The settings from those near, ``x``, whose gaps come nearest to the wanted ones; ``contacts`` (n,3) by side.

    None where a place is not cut.
    """

    def gaps(x: np.ndarray, near: Sequence[np.ndarray]) -> Gaps | None:
        off, rates, found = [], [], []
        for k, side in enumerate(problem.sides):
            how = system.generation(side.how, side.flank, x)
            points = FlankPoints(near[k], side.meeting.point, side.meeting.normal)
            target = FlankTarget(how, points, np.zeros(len(side.gap)))
            crossing = locate(target, target.vector, moving=True)
            if crossing.failed.any():
                return None
            found.append(crossing.contact)
            by_x = np.zeros((len(side.gap), len(NAMES)))
            by_x[:, system.settings_index(side.flank)] = -crossing.gradient[:, : len(SETTINGS)]
            for name, (setting, power) in MOVING.items():
                by_x[:, index(name)] = -crossing.gradient[:, WHOLE.index(f"{setting}.{power}")]
            weight = 1 / math.sqrt(len(side.gap))
            off.append(weight * (-crossing.deviation - side.gap))
            rates.append(weight * by_x)
        for more, by_x in (problem.root(x), problem.parabolas(x)):
            off.append(more)
            rates.append(by_x)
        return Gaps(np.concatenate(off), np.vstack(rates), tuple(found))

    best = _least(problem, x, gaps, contacts)
    if best is None:
        return None
    found, left = best
    count = [len(side.gap) for side in problem.sides]
    parts = np.split(left.off[: sum(count)], [count[0]])
    off = {side.flank: part * math.sqrt(n) for side, part, n in zip(problem.sides, parts, count, strict=True)}
    low, high = problem.bounds.T
    beyond = ((found < low) | (found > high)) & np.isin(np.arange(len(NAMES)), problem.index)
    return FittedBoth(found, off, tuple(name for name, is_so in zip(NAMES, beyond, strict=True) if is_so))


@dataclass(frozen=True)
class Gaps:
    """What is off (m,) [mm], its derivatives (m,35), and where by side the flank is cut (n,3)."""

    off: np.ndarray
    rates: np.ndarray
    contacts: tuple[np.ndarray, ...]


def _least(
    problem: BothFlanks,
    x: np.ndarray,
    gaps: Callable[[np.ndarray, Sequence[np.ndarray]], Gaps | None],
    contacts: Sequence[np.ndarray],
) -> tuple[np.ndarray, Gaps] | None:
    """The vector near ``x`` that meets the conditions and makes the gaps least, and these gaps.

    The fit moves along the directions in which the conditions do not change at the start; to each place on them the
    rest follows by Newton's method.
    """
    where, sizes = problem.index, SIZES[problem.index]
    start = problem.met(x, np.zeros((0, len(where))), np.zeros(0))
    first = None if start is None else gaps(start.x, contacts)
    if start is None or first is None:
        return None
    _, rates = problem.conditions(start.x)
    held = np.linalg.svd(rates[:, where] * sizes)[2][len(rates) :]
    low, high = problem.bounds[where].T
    known = [(np.zeros(len(held)), start.x, first)]

    def known_near(values: np.ndarray) -> tuple[np.ndarray, np.ndarray, Gaps]:
        return min(known, key=lambda one: float(np.linalg.norm(one[0] - values)))

    def at(v: np.ndarray) -> tuple[np.ndarray, np.ndarray] | None:
        values = v * _FARTHEST
        from_, near, there = known_near(values)
        found = problem.met(near, held, values - from_)
        left = None if found is None else gaps(found.x, there.contacts)
        if found is None or left is None or not np.isfinite(left.off).all():
            return None
        known.append((values, found.x, left))
        y, moved = found.x[where], found.rates
        beyond = (np.maximum(y - high, 0) - np.maximum(low - y, 0)) / sizes
        over = (beyond != 0)[:, None] * moved / sizes[:, None]
        off = np.concatenate([left.off, _RIDGE * (y - x[where]) / sizes, _BEYOND * beyond])
        by_v = np.vstack([left.rates[:, where] @ moved, _RIDGE * moved / sizes[:, None], _BEYOND * over])
        return off, by_v * _FARTHEST

    ones = np.ones(len(held))
    values = minimize(at, -ones, ones).variables * _FARTHEST
    _, found, left = known_near(values)
    return found, left


def of_flank(x: np.ndarray, flank: str) -> np.ndarray:
    """The vector of one flank, ``local_settings.NAMES``, out of that of both."""
    found = np.zeros(len(OF_FLANK))
    found[:2] = x[[index("u", flank), index("beta", flank)]]
    found[FIRST : FIRST + len(SETTINGS)] = x[system.settings_index(flank)]
    for name in MOVING:
        found[OF_FLANK.index(name)] = x[index(name)]
    return found
