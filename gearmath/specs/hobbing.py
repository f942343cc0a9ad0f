"""The hobbing machine's file: encoder on the hob, stepper on the work table, hobs and limits.

Lengths of diametral-pitch hobs are converted here: P teeth per inch of diameter is the module 25.4/P mm.
"""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path
from typing import Annotated, Literal

from pydantic import BeforeValidator, Field, InstanceOf, model_validator

from gearmath.specs.toml import Spec, load

INCH = 25.4  # mm

#: depth rule -> (whole depth in modules, depth added in mm). P rules are for hobs in diametral pitch, m for module.
DEPTH_RULES = {
    "2.25/P": (2.25, 0.0),
    "2.157/P": (2.157, 0.0),
    "2.2/P+0.002in": (2.2, 0.002 * INCH),
    "2.25m": (2.25, 0.0),
}


def _rational(value: object) -> Fraction:
    """A whole number, or text like "5/2". A decimal number is refused: 0.1 is no exact ratio in binary."""
    if isinstance(value, bool) or not isinstance(value, int | str):
        raise ValueError('must be a whole number, or a fraction in quotes such as "5/2"')
    try:
        ratio = Fraction(value)
    except (ValueError, ZeroDivisionError):
        raise ValueError('must be a whole number, or a fraction in quotes such as "5/2"') from None
    if not Fraction(1, 1000) <= ratio <= 10_000:
        raise ValueError("must lie between 1/1000 and 10000")
    return ratio


Rational = Annotated[InstanceOf[Fraction], BeforeValidator(_rational)]


class Encoder(Spec):
    """Encoder on the hob, and how many of its quadrature edges the decoder counts (LS7184N: x1, x2 or x4)."""

    lines: int = Field(ge=1, le=1_000_000)
    decoder: Literal[1, 2, 4]


class Table(Spec):
    """Stepper on the work table: steps per motor turn, then the belt and the worm as exact reductions."""

    full_steps: int = Field(ge=1, le=10_000)
    microsteps: int = Field(ge=1, le=1_024)
    belt: Rational
    worm: Rational

    @property
    def steps_per_turn(self) -> Fraction:
        return self.full_steps * self.microsteps * self.belt * self.worm

    @model_validator(mode="after")
    def _whole(self) -> Table:
        steps = self.steps_per_turn
        if steps.denominator != 1:
            raise ValueError(
                f"{self.full_steps} full steps x {self.microsteps} microsteps x belt {self.belt} x worm {self.worm} "
                f"= {steps} steps per table turn, which must be a whole number"
            )
        return self


class Hob(Spec):
    """One hob: its diametral pitch [1/in] or its module [mm], and the rule for the whole depth of its teeth."""

    diametral_pitch: float | None = Field(default=None, ge=1.0, le=254.0)
    module: float | None = Field(default=None, ge=0.1, le=25.0)
    depth_rule: Literal["2.25/P", "2.157/P", "2.2/P+0.002in", "2.25m"]

    @model_validator(mode="after")
    def _one_size(self) -> Hob:
        if (self.diametral_pitch is None) == (self.module is None):
            raise ValueError("a hob needs exactly one of diametral_pitch and module")
        if self.depth_rule.endswith("m") != (self.module is not None):
            fitting = [rule for rule in DEPTH_RULES if rule.endswith("m") != self.depth_rule.endswith("m")]
            raise ValueError(f"depth_rule {self.depth_rule!r} does not fit this hob, use one of {', '.join(fitting)}")
        return self

    @property
    def name(self) -> str:
        """What people call it: 32dp, or m0.5."""
        return f"{self.diametral_pitch:g}dp" if self.diametral_pitch is not None else f"m{self.module:g}"

    @property
    def module_mm(self) -> float:
        """Module [mm]."""
        return INCH / self.diametral_pitch if self.diametral_pitch is not None else float(self.module or 0.0)

    @property
    def depth_terms(self) -> tuple[float, float]:
        """Whole depth in modules, and the depth added to it [mm]."""
        return DEPTH_RULES[self.depth_rule]


class Limits(Spec):
    """What the machine can do: hob speed [1/min] and motor step rate [Hz]."""

    hob_rpm: float = Field(gt=0.0, le=20_000.0)
    step_rate_hz: float = Field(gt=0.0, le=1e6)


class HobbingMachine(Spec):
    """A hobbing machine with an electronic gearbox."""

    name: str = Field(min_length=1, max_length=60)
    hob_starts: int = Field(ge=1, le=10)
    encoder: Encoder
    table: Table
    limits: Limits
    hobs: tuple[Hob, ...] = Field(strict=False, min_length=1)

    @model_validator(mode="after")
    def _different_hobs(self) -> HobbingMachine:
        names = [hob.name for hob in self.hobs]
        for name in names:
            if names.count(name) > 1:
                raise ValueError(f"hob {name} stands in the list of hobs more than once")
        return self

    @property
    def encoder_counts(self) -> int:
        """Encoder counts per turn of the hob, after the decoder."""
        return self.encoder.lines * self.encoder.decoder

    @property
    def motor_steps(self) -> int:
        """Motor steps per turn of the work table."""
        return int(self.table.steps_per_turn)


def load_hobbing_machine(path: Path) -> HobbingMachine:
    """Read a hobbing machine's TOML file. Raises InputError with file, key, value and limit in one sentence."""
    return load(path, HobbingMachine)
