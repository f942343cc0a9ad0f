"""Step motor drivers: the four times a driver asks for, by name or in nanoseconds, and the levels it takes."""

from __future__ import annotations

import math
from dataclasses import astuple, dataclass
from typing import Literal

from pydantic import Field, model_validator

from gearmath.specs.toml import Spec

Level = Literal["high", "low"]
#: What enables a driver: no current through the opto-coupler of its ENABLE input (current switches the motor off), or a
#: low level at a logic input. An input that is left open enables either.
EnableInput = Literal["dark", "low"]


@dataclass(frozen=True)
class StepTiming:
    """Shortest times of a driver [ns]: step pulse, pause after it, DIR before the pulse and after it.

    ``confirmed`` says that a publication of the maker or of LinuxCNC states these figures; the others are cautious.
    ``enable`` says what the ENABLE input does, ``enable_confirmed`` that the maker's manual was seen to say so. A drive
    of a ``closed_loop`` has the motor's own encoder plugged into it.
    """

    step_high: int
    step_low: int
    dir_setup: int
    dir_hold: int
    confirmed: bool = True
    enable: EnableInput | None = None
    enable_confirmed: bool = False
    closed_loop: bool = False

    def ticks(self, tick_ns: int, jitter_ns: int) -> tuple[int, int, int, int]:
        """The four times in whole ticks of the step timer, rounded up, at least one each.

        A tick may come late by ``jitter_ns``, which shortens what it should have begun; the cautious figures of
        unconfirmed drivers hold this already.
        """
        late = jitter_ns if self.confirmed else 0
        return tuple(max(1, math.ceil((time + late) / tick_ns)) for time in astuple(self)[:4])  # type: ignore[return-value]

    def highest_rate(self, tick_ns: int, jitter_ns: int) -> int:
        """Steps per second at most: a pulse and a pause, each in whole ticks."""
        high, low, _, _ = self.ticks(tick_ns, jitter_ns)
        return 1_000_000_000 // ((high + low) * tick_ns)


#: Closed-loop drives: the family's usual 2.5 us and 5 us with a reserve, since revisions differ.
_CLOSED_LOOP = StepTiming(5000, 5000, 10_000, 10_000, confirmed=False, enable="dark", closed_loop=True)
#: Times published in LinuxCNC's tables of step timing and stepconf, unless marked. ENABLE: Leadshine's manuals say that
#: an input pulled low (NPN wiring) disables, and to leave it open otherwise; the chips' data sheets have a low enable.
DRIVERS = {
    "gecko201": StepTiming(500, 4000, 1000, 20_000),
    "gecko210": StepTiming(500, 4000, 1000, 20_000),
    "gecko212": StepTiming(500, 4000, 1000, 20_000),
    "gecko202": StepTiming(500, 4500, 1000, 20_000),
    "gecko201x": StepTiming(500, 3000, 1000, 20_000),
    "gecko203v": StepTiming(1000, 2000, 200, 200),
    # 1000, 2000, 200, 200 before LinuxCNC's issue #577: too short for the 3.3 V of a Teensy
    "gecko_g540": StepTiming(5000, 5000, 10_000, 10_000),
    "m542": StepTiming(1500, 1500, 5000, 8000, enable="dark", enable_confirmed=True),
    "dm556": StepTiming(2500, 2500, 5000, 10_000, enable="dark", enable_confirmed=True),
    "dm422": StepTiming(7500, 7500, 5000, 20_000, enable="dark", enable_confirmed=True),
    # a newer drive, of which revisions differ, too
    "dm542": StepTiming(5000, 5000, 10_000, 10_000, confirmed=False, enable="dark", enable_confirmed=True),
    "cl57t": _CLOSED_LOOP,
    "cl86t": _CLOSED_LOOP,
    "hbs57": _CLOSED_LOOP,
    "hbs86h": _CLOSED_LOOP,
    "dm860t": StepTiming(5000, 5000, 5000, 5000, enable="dark"),
    "a4988": StepTiming(1000, 1000, 200, 200, enable="low", enable_confirmed=True),
    "drv8825": StepTiming(1900, 1900, 650, 650, enable="low", enable_confirmed=True),
    "xylotex_8s3": StepTiming(2000, 1000, 200, 200),
    "keling_4030": StepTiming(5000, 5000, 20_000, 20_000),
    "sherline": StepTiming(22_000, 22_000, 100_000, 100_000),
    "tb6560": StepTiming(150_000, 150_000, 150_000, 150_000),
    "tmc2208": StepTiming(100, 100, 20, 20, enable="low", enable_confirmed=True),
    "tmc2209": StepTiming(100, 100, 20, 20, enable="low", enable_confirmed=True),
    # 3 us and more are in use, one board needed 30 us
    "tb6600": StepTiming(10_000, 10_000, 10_000, 10_000, confirmed=False, enable="dark"),
    "unsure": StepTiming(10_000, 10_000, 10_000, 10_000, confirmed=False),
}


class Driver(Spec):
    """Driver of the step motor: its times by name or all four in nanoseconds, and the levels at its own inputs.

    ``output`` is what stands between board and driver; an open-collector transistor inverts every level. A driver with
    opto-couplers fed from +5 V is active where its input is pulled low.
    """

    name: str | None = None
    step_high_ns: int | None = Field(default=None, ge=0, le=1_000_000)
    step_low_ns: int | None = Field(default=None, ge=0, le=1_000_000)
    dir_setup_ns: int | None = Field(default=None, ge=0, le=1_000_000)
    dir_hold_ns: int | None = Field(default=None, ge=0, le=1_000_000)
    output: Literal["open_collector", "direct"]
    step_active: Level
    dir_active: Level = "low"
    enable_active: Level | None = None
    """Level at the driver's own input that enables it; only for a driver whose row does not say it."""
    invert_direction: bool = False
    alarm_active: Level = "low"
    """Level at the board's pin while the driver has an alarm; an open wire reads high."""

    @model_validator(mode="after")
    def _one_timing(self) -> Driver:
        times = self._times
        if self.name is None and None in times.values():
            missing = ", ".join(key for key, time in times.items() if time is None)
            raise ValueError(
                f"name is missing; without the name of a driver all of its times must be given, {missing} too"
            )
        if self.name is not None:
            if self.name not in DRIVERS:
                raise ValueError(
                    f"name = {self.name!r}: no such driver is known; known are {', '.join(DRIVERS)}; "
                    f"any other is given by {', '.join(times)}"
                )
            given = [key for key, time in times.items() if time is not None]
            if given:
                raise ValueError(
                    f"name = {self.name!r} and {given[0]} = {times[given[0]]} both state times, use one of them"
                )
        return self

    @model_validator(mode="after")
    def _never_held_off(self) -> Driver:
        known = self._row_enables
        if self.enable_active is not None and known is not None and self.enable_active != known:
            raise ValueError(
                f"enable_active = {self.enable_active!r}: this level switches a {self.name} off with output = "
                f"{self.output!r}, which is enabled by {known!r}; leave enable_active out"
            )
        return self

    @property
    def _row_enables(self) -> Level | None:
        """The enabling level at the driver's input, where its row says so."""
        kind = self.timing.enable
        if kind != "dark":
            return kind
        # a transistor can only pull down, so that a low input is the one with current
        current = "low" if self.output == "open_collector" else self.step_active
        return "high" if current == "low" else "low"

    @property
    def enables(self) -> Level | None:
        """Level at the driver's input that enables it; None where neither its row nor the file says it."""
        return self._row_enables or self.enable_active

    @property
    def _times(self) -> dict[str, int | None]:
        keys = ("step_high_ns", "step_low_ns", "dir_setup_ns", "dir_hold_ns")
        return {key: getattr(self, key) for key in keys}

    @property
    def timing(self) -> StepTiming:
        """The four times [ns]."""
        if self.name is not None:
            return DRIVERS[self.name]
        step_high, step_low, dir_setup, dir_hold = (time or 0 for time in self._times.values())
        return StepTiming(step_high, step_low, dir_setup, dir_hold)

    def pin_active_low(self, level: Level) -> bool:
        """Whether the pin of the board is low where the driver's input has its active ``level``."""
        return (level == "low") != (self.output == "open_collector")
