"""What the control's own data decide about a program: increments, path mode, acceleration, the time a spindle needs."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Annotated, Literal

import numpy as np
from pydantic import AfterValidator, Field, model_validator

from gearmath.errors import InputError
from gearmath.specs.toml import Spec


def _power_of_ten(value: int) -> int:
    if 10 ** round(math.log10(value)) != value:
        raise ValueError("must be a power of ten, such as 1000")
    return value


def _known_kind(value: str) -> str:
    if value not in CONTROLS:
        *others, last = (repr(kind) for kind in CONTROLS)
        raise ValueError(f"must be {', '.join(others)} or {last}")
    return value


@dataclass(frozen=True)
class Control:
    """What all that reads and writes must know of a control: its name, and how a program for it is known and read."""

    name: str
    """As ``--control`` and ``[control] kind`` have it."""
    mark: str = ""
    """What only programs of this control have in them."""
    as_read: Callable[[str], str] | None = None
    """A program in words of a known control, line for line; None where the reader knows this one."""


#: The controls that programs are written for, by name: the one table of them. ``machine.judging.dialects`` puts the
#: records in their places by which programs of these two are written; a dialect that is registered comes behind them.
CONTROLS: dict[str, Control] = {name: Control(name) for name in ("sinumerik", "linuxcnc")}
#: Name of the probe as a tool, and its number where a file does not give it one.
PROBE, PROBE_NUMBER = "PROBE", 99
_Increments = Annotated[int, Field(ge=100, le=1_000_000), AfterValidator(_power_of_ten)]


class ControlSettings(Spec):
    """The table ``[control]``; what is left out has the value that a new control has, or a safe one.

    Positions are written in whole increments, since the control rounds to them whatever is written.
    """

    kind: Annotated[str, AfterValidator(_known_kind)] | None = None
    """Which control the machine has; left out, programs are for a SINUMERIK unless --control says otherwise."""
    tool_numbers: dict[str, Annotated[int, Field(ge=1, le=99_999, strict=True)]] = Field(default={})
    """LinuxCNC: numbers of tools by their names; others are counted from 1, the probe has 99."""
    increments_per_mm: _Increments = 1000
    """MD10200 $MN_INT_INCR_PER_MM."""
    increments_per_degree: _Increments = 1000
    """MD10210 $MN_INT_INCR_PER_DEG."""
    path_mode: Literal["G60", "G642"] = "G642"
    """Exact stop at every block, or continuous within the two tolerances below."""
    contour_tolerance_um: float = Field(default=0.05, ge=0.01, le=100)
    """CTOL: how far G642 may take X Y Z off the programmed path."""
    orientation_tolerance_arcsec: float = Field(default=0.1, ge=0.01, le=100)
    """OTOL: how far it may take A and B off."""
    polynomial_values: int = Field(default=15, ge=1, le=1000)
    """End points and coefficients that a block may have: a cubic of five axes has 15, a quintic 25."""
    jerk: Literal["BRISK", "SOFT"] = "SOFT"
    feed_forward: bool = True
    spindle_start_seconds: float = Field(default=3.0, ge=0.0, le=60.0)
    """How long the program waits after M3 or M4, so that the cutter is at speed before it meets metal."""

    result_file_kB: int | None = Field(default=None, ge=1, le=1_000_000)
    """MD11420 $MN_LEN_PROTOCOL_FILE: how long a file may be into which a program writes; left out, only the control
    knows, and programs ask it before they move."""

    @model_validator(mode="after")
    def _a_number_each(self) -> ControlSettings:
        numbers = {PROBE: PROBE_NUMBER} | self.tool_numbers
        if len(set(numbers.values())) < len(numbers):
            if PROBE not in self.tool_numbers and PROBE_NUMBER in self.tool_numbers.values():
                raise ValueError(f"tool_numbers: {PROBE_NUMBER} is that of the probe, unless {PROBE} is given another")
            raise ValueError("tool_numbers must give every tool a number of its own")
        return self

    def dialect(self, asked: str | None) -> str:
        """The control that a program is for: ``asked`` by the user, or the one of the machine.

        Raises InputError where they are not the same.
        """
        if asked and self.kind and asked != self.kind:
            raise InputError(f"--control {asked}: the machine has [control] kind = {self.kind!r}")
        return asked or self.kind or "sinumerik"

    @property
    def decimals(self) -> tuple[int, int]:
        """Decimals of a position in mm and in degrees."""
        return round(math.log10(self.increments_per_mm)), round(math.log10(self.increments_per_degree))

    @property
    def half_increments(self) -> np.ndarray:
        """What rounding may do to X Y Z A B (5,), mm and rad."""
        return np.array([0.5 / self.increments_per_mm] * 3 + [math.radians(0.5 / self.increments_per_degree)] * 2)

    @property
    def path_tolerance(self) -> tuple[float, float]:
        """How far the path mode may leave the programmed path: in X Y Z together [mm], in A and in B [rad]."""
        if self.path_mode == "G60":
            return 0.0, 0.0
        return self.contour_tolerance_um / 1000, math.radians(self.orientation_tolerance_arcsec / 3600)

    @property
    def words(self) -> tuple[str, ...]:
        """The words of the head: path mode, tolerances, acceleration, feed forward."""
        degrees = self.orientation_tolerance_arcsec / 3600
        within = f" CTOL={self.contour_tolerance_um / 1000:.6f} OTOL={degrees:.7f}" if self.path_mode == "G642" else ""
        return self.path_mode + within, self.jerk, "FFWON" if self.feed_forward else "FFWOF"
