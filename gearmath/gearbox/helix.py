"""The ratio of a job: steps per count of hob and feed, as whole numbers over one denominator.

The hob's term is exact. The lead of a helix is irrational: the term of the feed is rounded, so that over a travel of
500 mm the table is never more than 1/100 step away from the true helix. The firmware does the same in integers.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from fractions import Fraction

from gearmath.errors import InputError
from gearmath.gearbox.kernels import evaluate, exactly, precise
from gearmath.specs.helix import SIGNS, Helix
from gearmath.specs.hobbing import HobbingMachine

#: Travel [mm] over which the error of the rounded term stays within 1/PART step; GM_HELIX_... of the firmware.
TRAVEL, PART = 500, 100
STEEPEST = 60.0  # degrees


@dataclass(frozen=True)
class JobRatio:
    """p = (N_hob e_hob + N_feed e_feed) / D, rounded to the nearest whole step; numerators carry their signs."""

    denominator: int
    numerators: tuple[int, int]

    @property
    def base(self) -> tuple[int, int]:
        """q of (7.8): whole steps that every edge of the axis gives, rounded down."""
        hob, feed = self.numerators
        return hob // self.denominator, feed // self.denominator

    @property
    def increment(self) -> tuple[int, int]:
        """N' of (7.8): the rest, 0 <= N' < D."""
        hob, feed = self.numerators
        return hob % self.denominator, feed % self.denominator

    @property
    def first_remainder(self) -> int:
        """a_0 of (7.4)."""
        return int(evaluate("gearbox_start", self.denominator)[0])

    @property
    def steps_per_edge(self) -> int:
        """The most steps that one edge can give."""
        return max(-(-abs(numerator) // self.denominator) for numerator in self.numerators)


def one_term(ratio: Fraction, turn: int = 1) -> JobRatio:
    """A job that the hob (or the spindle) alone leads.

    ``turn`` is the denominator of the counts per turn of the hob: times it, a whole turn is a whole number of 1/D.
    """
    return JobRatio(ratio.denominator * turn, (ratio.numerator * turn, 0))


def two_terms(hob: Fraction, feed: Fraction, feed_counts: Fraction, turn: int = 1) -> JobRatio:
    """The least multiple of the hob's denominator that keeps the bound of this module, and the feed rounded to it.

    ``feed`` is κ_z to many digits, ``feed_counts`` are the counts per mm, ``turn`` is that of :func:`one_term`.
    """
    counts = math.ceil(TRAVEL * PART * feed_counts)
    least = hob.denominator * turn
    denominator = least * (counts // 2 // least + 1)
    size = math.floor(abs(feed) * denominator + Fraction(1, 2))
    return JobRatio(denominator, (int(hob * denominator), size if feed > 0 else -size))


def simplest(value: Fraction, needed: int) -> Fraction:
    """The fraction of the least denominator within 1/``needed`` of ``value`` > 1/``needed``, as the firmware takes it.

    Continued fractions of both ends of that interval, as long as they agree. Their ends have nothing to do with the
    value, unlike the convergents of the value itself: a value that is nearly rational has two that are next to each
    other, and its last digit would decide which one is met first.
    """
    low, high = value - Fraction(1, needed), value + Fraction(1, needed)
    before, now = (0, 1), (1, 0)
    while True:
        whole = math.ceil(low)
        last = whole <= high
        digit = whole if last else math.floor(low)
        before, now = now, (digit * now[0] + before[0], digit * now[1] + before[1])
        if last:
            return Fraction(*now)
        low, high = 1 / (high - digit), 1 / (low - digit)


@dataclass(frozen=True)
class Rounding:
    """What rounding an irrational ratio costs [steps] over TRAVEL: the bound that is promised, and what it is."""

    bound: float
    error: float


def helical_ratio(
    machine: HobbingMachine, teeth: int, starts: int, module: float, helix: Helix
) -> tuple[JobRatio, Rounding]:
    """The ratio of a helical gear, and what its rounding costs.

    Raises InputError where the angle is none, or where a feed must be given or must not.
    """
    if not 0.0 < helix.angle <= STEEPEST:
        raise InputError(
            f"helix = {helix.angle:g}: must be more than 0 and at most {STEEPEST:g} degrees; --hand says which way"
        )
    if machine.feed is None:
        return _fed(machine, teeth, starts, module, helix)
    if helix.feed is not None:
        raise InputError(f"feed = {float(helix.feed):g}: {machine.name} has an encoder on the feed, leave it out")
    hob = hob_ratio(machine, teeth, starts)
    counts_up = 1 if machine.feed_climbs else -1
    counts = float(machine.feed_counts)
    exact = precise("feed_ratio", counts_up, helix.sign, teeth, module, helix.beta, float(machine.motor_steps), counts)
    ratio = two_terms(hob, exact, machine.feed_counts, machine.encoder_counts.denominator)
    (bound,) = evaluate("feed_error", counts, TRAVEL, ratio.denominator)
    rounded = Fraction(ratio.numerators[1], ratio.denominator)
    return ratio, Rounding(bound, float(abs(exact - rounded) * machine.feed_counts * TRAVEL))


def hob_ratio(machine: HobbingMachine, teeth: int, starts: int) -> Fraction:
    """κ_h, motor steps per count of the hob, exactly; negative for a left-hand hob."""
    train = (SIGNS[machine.hob_hand], teeth, starts, machine.encoder_counts, machine.motor_steps)
    return exactly("hob_ratio", *train)


def _fed(machine: HobbingMachine, teeth: int, starts: int, module: float, helix: Helix) -> tuple[JobRatio, Rounding]:
    """A helix without an encoder on the feed: one term, right for one feed and one direction of it."""
    if helix.feed is None:
        raise InputError(
            f"helix = {helix.angle:g}: {machine.name} has no encoder on the feed, so the feed per turn of the table "
            "must be given and kept"
        )
    if not Fraction(1, 1000) <= helix.feed < 10:
        raise InputError(f"feed = {float(helix.feed):g}: must lie between 0.001 and 10 mm per turn of the table")
    exact = precise(
        "fed_ratio",
        SIGNS[machine.hob_hand],
        helix.sign,
        SIGNS[helix.cut],
        teeth,
        starts,
        module,
        helix.beta,
        float(helix.feed),
        float(machine.encoder_counts),
        float(machine.motor_steps),
    )
    counts = Fraction(TRAVEL * teeth * machine.encoder_counts) / helix.feed
    found = simplest(abs(exact), math.ceil(2 * PART * counts))
    rounding = Rounding(1 / (2 * PART * starts), float(abs(abs(exact) - found) * counts / starts))
    return one_term(found if exact > 0 else -found, machine.encoder_counts.denominator), rounding
