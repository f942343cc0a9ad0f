"""What turns and what counts: encoders, and the step motor's drive with its exact reductions."""

from __future__ import annotations

from fractions import Fraction
from typing import Literal

from pydantic import Field, model_validator

from derivations import notation
from gearmath.specs.ratio import Pitch, Rational
from gearmath.specs.toml import Spec


class Encoder(Spec):
    """Encoder on the hob (the spindle of a lathe), and how many of its quadrature edges the decoder counts.

    ``hardware`` is the board's own quadrature, which counts all four. ``hysteresis`` is the play, in counts, that keeps
    a trembling hob from stepping.
    """

    lines: int = Field(ge=1, le=1_000_000)
    decoder: Literal["ls7184_x1", "ls7184_x2", "ls7184_x4", "hardware"]
    hysteresis: int = Field(default=0, ge=0, le=int(notation.hysteresis.domain[1]))

    @property
    def edges_per_line(self) -> int:
        """1, 2 or 4."""
        return 4 if self.decoder == "hardware" else int(self.decoder[-1])


class Drive(Spec):
    """Step motor with its belt: full steps and microsteps a motor turn, then an exact reduction."""

    full_steps: int = Field(ge=1, le=10_000)
    microsteps: int = Field(ge=1, le=1_024)
    belt: Rational

    @property
    def steps_per_turn(self) -> Fraction:
        return self.full_steps * self.microsteps * self.belt

    def _words(self) -> str:
        return f"{self.full_steps} full steps x {self.microsteps} microsteps x belt {self.belt}"

    @model_validator(mode="after")
    def _whole(self) -> Drive:
        steps, most = self.steps_per_turn, int(notation.motor_steps.domain[1])
        if steps.denominator != 1:
            raise ValueError(f"{self._words()} = {steps} steps per turn, which must be a whole number")
        if steps > most:
            raise ValueError(f"{self._words()} = {steps} steps per turn, which must not exceed {most}")
        return self


class Table(Drive):
    """Step motor of the work table, with belt and worm."""

    worm: Rational

    @property
    def steps_per_turn(self) -> Fraction:
        return self.full_steps * self.microsteps * self.belt * self.worm

    def _words(self) -> str:
        return f"{super()._words()} x worm {self.worm}"


class LeadScrew(Drive):
    """Step motor of a lathe's lead screw, and the pitch of that screw [mm], from text in mm or tpi."""

    pitch: Pitch


class Feed(Spec):
    """Encoder of the axial feed, for helical gears: exact counts per mm after its decoder.

    ``counts_up`` says in which cut they go up while the hob turns forward: in climb hobbing the teeth of the hob move
    against its feed.
    """

    counts_per_mm: Rational
    counts_up: Literal["climb", "conventional"]
