"""Face hobbing on six axes: plunge and one slow generating roll, cutter and work turning in their ratio all the while.

All tooth spaces are cut in the one roll. Each is visited once in a turn of the work, so that the flank keeps scallops
(17.4); the roll takes as many turns as their height allows, beside what straight blocks and printed decimals take.
X Y Z B depend on the cradle rotation alone, A and C on it and, linearly, on the turn: blocks are straight in both.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from gearmath.errors import InputError
from gearmath.kernels import kernel
from gearmath.machine.planning.blocks import ROUNDING, check_tolerance
from gearmath.machine.planning.feeds import paced_seconds
from gearmath.machine.planning.path import Cut, axis_positions, roll_range, six_axes
from gearmath.machine.planning.visits import roll_in_a_turn
from gearmath.specs.bevel_set import Flank, Member
from gearmath.specs.milling_machine import AxisLimits, MillingMachine

#: No block turns A or C further than this: DC goes the short way.
_MOST_TURN = math.radians(170.0)
#: Part of the tolerance that straight blocks may take; the decimals take ROUNDING, the scallops the rest.
_CHORD_SHARE = 0.1
#: What six decimals of C may do at the blade. [mm]
C_ROUNDING = math.radians(0.5e-6) * 250.0
#: With less, decimals and chords leave nothing for the scallops. [mm]
LEAST_TOLERANCE = 1.5e-5
#: Most that the cutter goes down, and past the tooth, in a turn of the work: a blade cuts each space once. [mm]
_PLUNGE_PER_TURN, _ROLL_PER_TURN = 0.2, 3.0
#: No roll takes more turns of the work than this.
_MOST_TURNS = 20_000
#: Turns of the work at the bottom, where nothing rolls.
_FORMATE_TURNS = 1.25


@dataclass(frozen=True)
class HobbingPass:
    """Positions X Y Z A B C (n,6) at the block ends, their cradle rotations (n,) and times (n-1,) s.

    ``bends`` (n-1,6,k) are a_2 and so on of the blocks where they are polynomials.
    """

    axes: np.ndarray
    theta: np.ndarray
    seconds: np.ndarray
    bends: np.ndarray | None = None


@dataclass(frozen=True)
class Drive:
    """How cutter and work turn: the sense of C, and the turn of the work for one of the cutter."""

    sense: int
    index_ratio: float

    @staticmethod
    def of(member: Member, machine: MillingMachine) -> Drive:
        """M3 turns clockwise as seen along the spindle towards the work: right-handed about the tool axis, as C."""
        return Drive(1 if machine.cutter_direction == "M3" else -1, index_ratio(member))

    def seconds_per_turn(self, limits: AxisLimits, rpm: float) -> float:
        """Shortest time [s] of a turn of the work, at a speed of the cutter that A and C can follow."""
        speed = min(2 * math.pi * rpm / 60, limits.max_speed[5], limits.max_speed[3] / abs(self.index_ratio))
        return 2 * math.pi / abs(self.index_ratio) / speed

    def beta(self, turns: np.ndarray) -> np.ndarray:
        """Cutter angle after turns of the work (17.3)."""
        return self.sense * 2 * math.pi * turns / abs(self.index_ratio)


def index_ratio(member: Member) -> float:
    """The turn of the work for one of the cutter."""
    return member.indexing_sign * (member.blade_groups or 1) / member.teeth


@dataclass(frozen=True)
class HobbingMotion:
    """One cut: straight down from ``lift`` [mm] above the start, through the roll, to a standstill.

    ``start`` and ``end`` are cradle rotations [rad]; ``down`` and ``turns`` are turns of the work in plunge and roll,
    each ``per_turn`` [s] long; ``chord`` [mm] is how far blocks may leave the exact path.
    """

    drive: Drive
    start: float
    end: float
    down: float
    turns: float
    per_turn: float
    lift: float
    chord: float


def hobbing_motion(
    member: Member,
    cut: Cut,
    machine: MillingMachine,
    tolerance: float,
    feed: float,
    rpm: float,
    lift: float,
    plunge_feed: float,
    tooth: np.ndarray,
) -> HobbingMotion:
    """How far and how fast the whole cut goes.

    ``feed`` [mm/min] is the highest speed of the roll past ``tooth`` (3,), a place of the work as the indexing has
    turned it when the blade meets it; ``rpm`` is the speed of the cutter; both give way to the axes. Raises InputError
    for a machine without C, and for tolerance, feed or speed out of range.
    """
    _check(member.name, machine, tolerance, feed, rpm)
    drive, spec, limits = Drive.of(member, machine), member.flank(cut.flanks[0]), machine.limits(6)
    pivot, per_turn = (machine.pivot_height, machine.pivot), drive.seconds_per_turn(limits, rpm)
    start, end, turns = _roll(member, cut, drive, (1 - _CHORD_SHARE) * tolerance - ROUNDING - C_ROUNDING)
    if end > start:
        way = _way_past(spec, np.linspace(start, end, 200), tooth, pivot)
        turns = max(turns, way / min(feed * per_turn / 60.0, _ROLL_PER_TURN))
    if turns > _MOST_TURNS:
        raise InputError(
            f"{member.name}: feed = {feed} mm/min: asks for {turns:.0f} turns of the work in the roll, {_MOST_TURNS} "
            "at most"
        )
    down = lift / min(plunge_feed * per_turn / 60.0, _PLUNGE_PER_TURN)
    return HobbingMotion(drive, start, end, down, turns, per_turn, lift, _CHORD_SHARE * tolerance)


def straight_hobbing(spec: Flank, motion: HobbingMotion, machine: MillingMachine) -> HobbingPass:
    """The cut by straight blocks."""
    drive, start, end, down, turns = motion.drive, motion.start, motion.end, motion.down, motion.turns
    pivot, limits, parts = (machine.pivot_height, machine.pivot), machine.limits(6), _parts(drive, machine)
    plunge = np.linspace(0.0, 1.0, max(2, math.ceil(down * parts)) + 1)
    roll = _roll_parts(spec, start, end, max(2, math.ceil(turns * parts)), motion.chord, pivot)
    turned = np.concatenate([down * plunge, down + turns * roll[1:]])
    theta = np.concatenate([np.full(len(plunge), start), start + (end - start) * roll[1:]])
    axes = six_axes(spec, theta, drive.beta(turned), drive.index_ratio, *pivot)
    axes[: len(plunge), 2] += motion.lift * (1.0 - plunge)
    seconds = paced_seconds(
        np.diff(axes, axis=0), np.diff(turned) * motion.per_turn, limits.max_speed, limits.max_acceleration
    )
    return HobbingPass(axes, theta, seconds)


def _roll_parts(
    spec: Flank, start: float, end: float, count: int, chord: float, pivot: tuple[float, np.ndarray]
) -> np.ndarray:
    """Parts of the roll (n+1,), from 0 to 1, where blocks end: ``count`` or more, for chords [mm] as small as that."""
    while end > start and _chord(spec, np.linspace(start, end, count + 1), pivot) > chord:
        count *= 2
    return np.linspace(0.0, 1.0, count + 1)


def _check(name: str, machine: MillingMachine, tolerance: float, feed: float, rpm: float) -> None:
    if machine.axes.C is None:
        raise InputError(
            f"{name}: is face hobbed, which turns the cutter as the sixth axis C: {machine.name} has no [axes.C]"
        )
    for what, value, unit in (("feed", feed, "mm/min"), ("spindle speed", rpm, "rpm")):
        if not (math.isfinite(value) and value > 0):
            raise InputError(f"{name}: {what} = {value} {unit}: must be greater than 0")
    check_tolerance(tolerance, ROUNDING + C_ROUNDING, LEAST_TOLERANCE)


def _roll(member: Member, cut: Cut, drive: Drive, scallop: float) -> tuple[float, float, float]:
    """Cradle rotations of start and end, a turn's roll beyond what generates the flanks; turns of the work."""
    if member.generation == "formate":
        return 0.0, 0.0, _FORMATE_TURNS
    step = roll_in_a_turn(member, drive.index_ratio, drive.sense, scallop)
    low, high = roll_range(member, cut)
    low, high = low - step, high + step
    return low, high, (high - low) / step


def _way_past(spec: Flank, theta: np.ndarray, tooth: np.ndarray, pivot: tuple[float, np.ndarray]) -> float:
    """How far [mm] the roll moves the cutter past the tooth, without the indexing while it rolls."""
    (seen,) = kernel("seen_from_tool")(axis_positions(spec, theta, *pivot), tooth, *pivot)
    return float(np.linalg.norm(np.diff(seen, axis=0), axis=1).sum())


def _parts(drive: Drive, machine: MillingMachine) -> float:
    """Blocks in a turn of the work: so many that a modulo axis goes less than half a turn in one of them."""
    turns = []
    if machine.axes.A.modulo:
        turns.append(2 * math.pi)
    if machine.axes.C is not None and machine.axes.C.modulo:
        turns.append(2 * math.pi / abs(drive.index_ratio))
    return max([turn / _MOST_TURN for turn in turns], default=1.0)


def _chord(spec: Flank, theta: np.ndarray, pivot: tuple[float, np.ndarray]) -> float:
    """How far [mm] straight blocks leave the exact path at most."""
    middle = (theta[1:] + theta[:-1]) / 2
    every = np.sort(np.concatenate([theta, middle]))
    path = six_axes(spec, every, np.zeros(len(every)), 0.0, *pivot)
    return off_the_roll(spec, path[1:-1:2] - (path[:-2:2] + path[2::2]) / 2)


def off_the_roll(spec: Flank, apart: np.ndarray) -> float:
    """What differences (n,6) of positions are at most [mm]: positions, and angles at the reach of the cutter."""
    off, reach = np.abs(apart), np.linalg.norm(spec.vector[[0, 10]])
    return float((np.linalg.norm(off[:, :3], axis=1) + reach * off[:, 3:].sum(axis=1)).max())
