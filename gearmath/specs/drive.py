"""What turns and what counts: encoders, and the step motor's drive with its exact reductions."""

from __future__ import annotations

import math
from fractions import Fraction
from typing import Literal

from pydantic import Field, model_validator

from derivations import notation
from gearmath.specs.ratio import Pitch, Pulses, Rational
from gearmath.specs.toml import Spec


class Encoder(Spec):
    """Encoder on the hob (the spindle of a lathe), and how many of its quadrature edges the decoder counts.

    ``hardware`` is the board's own quadrature counter, ``interrupts`` its pins in software; both count all four edges.
    ``hysteresis`` is the play, in counts, that keeps a trembling hob from stepping.
    """

    lines: int = Field(ge=1, le=1_000_000)
    belt: Rational = Fraction(1)
    """Turns of the encoder per turn of the hob (the spindle), where pulleys drive it. Its index is then one per turn of
    its own shaft."""
    invert: bool = False
    """Whether the counts go down as the hob turns forward: instead of exchanging its channels."""
    index_active: Literal["high", "low"] = "high"
    """Level of the index pulse at the board's pin."""
    decoder: Literal["ls7184_x1", "ls7184_x2", "ls7184_x4", "hardware", "interrupts"]
    counter: Literal["interrupts", "hardware"] | None = None
    """What counts the pulses of an LS7184: interrupts unless given, or the board's counter of pulse and direction."""
    hysteresis: int = Field(default=0, ge=0, le=int(notation.hysteresis.domain[1]))

    @property
    def edges_per_line(self) -> int:
        """1, 2 or 4."""
        return int(self.decoder[-1]) if self.has_ls7184 else 4

    @property
    def has_ls7184(self) -> bool:
        """Whether pulse and direction come from that chip, not channels A and B from the encoder."""
        return self.decoder.startswith("ls7184")

    @property
    def wants_counter(self) -> bool:
        """Whether a counter of the board is asked for."""
        return self.decoder == "hardware" or self.counter == "hardware"

    @model_validator(mode="after")
    def _one_counter(self) -> Encoder:
        if self.counter is not None and not self.has_ls7184:
            raise ValueError(f"counter = {self.counter!r}: has no meaning with decoder = {self.decoder!r}")
        return self

    @property
    def counts_per_shaft(self) -> int:
        """Counts per turn of the encoder's own shaft."""
        return self.lines * self.edges_per_line


#: Largest numerator and denominator of the steps per turn, in lowest terms: products with them stay within 63 bits.
LARGEST_STEPS = (2**30, 1_000_000)


class Drive(Spec):
    """Motor with its belt: pulses a motor turn, then an exact reduction. The steps per turn may be any fraction.

    A step motor has full steps and microsteps; a servo has ``pulses``, the command pulses per turn of its motor, which
    are its encoder's counts over its electronic gearing, such as "131072/10".
    """

    full_steps: int | None = Field(default=None, ge=1, le=10_000)
    microsteps: int | None = Field(default=None, ge=1, le=1_024)
    pulses: Pulses | None = None
    belt: Rational
    backlash: float = Field(default=0.0, ge=0.0, le=5.0)
    """Play between motor and table [degrees] or carriage [mm], taken up by dividing, a return and a restart."""

    @property
    def backlash_steps(self) -> int:
        """That play in motor steps, rounded up."""
        return math.ceil(Fraction(str(self.backlash)) * self.steps_per_turn / self._turn)

    @property
    def _turn(self) -> Fraction:
        """A turn of the table [degrees], or of the lead screw [mm]."""
        return Fraction(360)

    @property
    def pulses_per_turn(self) -> Fraction:
        """Steps per turn of the motor."""
        return Fraction((self.full_steps or 0) * (self.microsteps or 0)) if self.pulses is None else self.pulses

    @property
    def steps_per_turn(self) -> Fraction:
        return self.pulses_per_turn * self.belt

    def _words(self) -> str:
        motor = (
            f"{self.full_steps} full steps x {self.microsteps} microsteps"
            if self.pulses is None
            else (f"{self.pulses} pulses")
        )
        return f"{motor} x belt {self.belt}"

    @model_validator(mode="after")
    def _one_motor(self) -> Drive:
        given = [self.full_steps is not None, self.microsteps is not None]
        if all(given) == (self.pulses is not None) or any(given) != all(given):
            values = (("full_steps", self.full_steps), ("microsteps", self.microsteps), ("pulses", self.pulses))
            said = ", ".join(f"{key} = {value}" for key, value in values if value is not None) or "none is given"
            raise ValueError(
                f"a step motor needs full_steps and microsteps, a servo needs pulses, and neither the other's: {said}"
            )
        return self

    @model_validator(mode="after")
    def _fits(self) -> Drive:
        steps, most = self.steps_per_turn, int(notation.motor_steps.domain[1])
        if not 1 <= steps <= most:
            raise ValueError(f"{self._words()} = {steps} steps per turn, which must lie between 1 and {most}")
        if steps.numerator > LARGEST_STEPS[0] or steps.denominator > LARGEST_STEPS[1]:
            raise ValueError(
                f"{self._words()} = {steps} steps per turn: the numerator must not exceed {LARGEST_STEPS[0]}, the "
                f"denominator {LARGEST_STEPS[1]}"
            )
        return self


class Table(Drive):
    """Step motor of the work table, with belt and worm."""

    worm: Rational

    @property
    def steps_per_turn(self) -> Fraction:
        return self.pulses_per_turn * self.belt * self.worm

    def _words(self) -> str:
        return f"{super()._words()} x worm {self.worm}"


class LeadScrew(Drive):
    """Step motor of a lathe's lead screw, and the pitch of that screw [mm], from text in mm or tpi."""

    pitch: Pitch

    @property
    def _turn(self) -> Fraction:
        return self.pitch


class Feed(Spec):
    """Encoder of the axial feed, for helical gears: exact counts per mm after its decoder.

    ``counts_up`` says in which cut they go up while the hob turns forward: in climb hobbing the teeth of the hob move
    against its feed.
    """

    counts_per_mm: Rational
    counts_up: Literal["climb", "conventional"]
