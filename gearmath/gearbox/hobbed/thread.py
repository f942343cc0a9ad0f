"""A thread or worm that a lathe with an electronic lead screw cuts: how far its pitch is off over its length."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from gearmath.errors import InputError
from gearmath.gearbox.hobbed.drive import Rule, rounding
from gearmath.gearbox.hobbed.job import TURN
from gearmath.gearbox.hobbed.sines import ARCSEC, UM, harmonics
from gearmath.gearbox.job import ThreadPlan
from gearmath.gearbox.simulation import FloatRule
from gearmath.specs.hobbing import HobbingMachine

#: Points a turn of the spindle at least, and in all at most.
PER_TURN, MOST_POINTS = 64, 400_000


@dataclass(frozen=True)
class ThreadTrace:
    """Where the carriage is too far (n,) [mm] at places along the thread (n,) [mm], cut by one rule."""

    rule: Rule
    place: np.ndarray
    deviation: np.ndarray
    lead: float

    @property
    def total(self) -> float:
        """Range of the deviations over the whole length [mm]."""
        return float(np.ptp(self.deviation))

    @property
    def single_lead(self) -> float:
        """The largest deviation of one lead from what it should be [mm]."""
        ahead = np.interp(self.place + self.lead, self.place, self.deviation)
        inside = self.place + self.lead <= self.place[-1]
        return float(np.abs(ahead - self.deviation)[inside].max(initial=0.0))

    @property
    def drift(self) -> float:
        """How much the mean line rises over the length [mm]."""
        fit = np.polyfit(self.place, self.deviation, 1)
        return float(fit[0] * (self.place[-1] - self.place[0]))


def cut_thread(
    machine: HobbingMachine, planned: ThreadPlan, length: float, rule: Rule = "exact", seconds: float = 0.0
) -> ThreadTrace:
    """Cut a thread of ``length`` [mm], after ``seconds`` of running; the errors are those of the machine file.

    ``worm`` and ``wheel`` of the section [errors] have no meaning on a lathe; ``feed`` is its lead screw.
    Raises InputError where the thread is shorter than one lead.
    """
    lead = float(planned.lead)
    if length < lead:
        raise InputError(f"length = {length:g}: must be at least one lead of {lead:g} mm")
    turns = length / lead
    # an odd number of points, so that they do not fall on the counts of the encoder in step with them
    points = int(min(MOST_POINTS, max(2001, math.ceil(PER_TURN * turns)))) | 1
    spindle = np.linspace(0.0, turns * TURN, points)
    errors, belt = machine.errors, float(machine.encoder.belt)
    per_turn = float(machine.encoder_counts)
    real = spindle / TURN * per_turn + math.floor(planned.rpm / 60 * seconds) * per_turn
    seen = harmonics(errors.encoder, spindle * belt, ARCSEC) / belt / TURN * per_turn
    counts = np.floor(real + seen)
    ratio = planned.ratio
    steps = np.zeros_like(spindle)
    if rule != "ideal":
        steps = ratio.numerators[0] / ratio.denominator * (counts - real)
        steps += (
            _floating(ratio.numerators[0], ratio.denominator, counts)
            if rule == "float"
            else rounding(ratio, counts, np.zeros_like(counts))
        )
    sign = 1 if ratio.numerators[0] > 0 else -1
    place = spindle / TURN * lead
    screw = TURN * place / float(machine.lead_screw_pitch)
    moved = sign * steps * float(machine.lead_screw_pitch / machine.motor_steps)
    return ThreadTrace(rule, place, moved + harmonics(errors.feed, screw, UM), lead)


def _floating(numerator: int, denominator: int, counts: np.ndarray) -> np.ndarray:
    """Steps of the floating rule beyond N e/D."""
    whole = counts.astype(np.int64)
    return FloatRule(numerator, denominator).positions(whole) - whole * (numerator / denominator)
