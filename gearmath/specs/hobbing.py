"""The machine file of an electronic gearbox: a hobbing machine, or a lathe with its lead screw.

What the machine cannot do is refused here, when its file is read: a speed that board, decoder or driver cannot carry,
a ramp that never ends, numbers beyond the kernels, pins that overlap.
"""

from __future__ import annotations

import math
import re
from fractions import Fraction
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, AliasChoices, Field, model_validator

from derivations import notation
from gearmath.shown import Shown, Shows
from gearmath.specs.board import BOARDS, Board, BoardName, Display, Pins
from gearmath.specs.counters import (
    DEFAULT_PINS,
    LS7184_FILTER,
    Counter,
    counter,
    filter_setting,
    pins_in_words,
)
from gearmath.specs.cutting_errors import CuttingErrors
from gearmath.specs.drive import Encoder, Feed, LeadScrew, Table
from gearmath.specs.drivers import Driver
from gearmath.specs.hob import Hob
from gearmath.specs.motion_limits import check_motion
from gearmath.specs.ratio import EXACT_INCH
from gearmath.specs.toml import Spec, find, load

__all__ = ["Hob", "HobbingMachine", "load_hobbing_machine"]

#: The display has two digits for the number of a hob.
MOST_HOBS = 99
#: An LS7184 ignores A and B during its output pulse of 10 us, so that faster edges are lost.
LS7184_EDGE_RATE = 100_000
#: Largest denominator of the rule in 32 bits; gearmath.gearbox.proof shows that it is tight.
NARROW = int(notation.steps_denominator.domain[1])
#: Largest numerator of the counts per turn of the hob.
MOST_TURN_COUNTS = 16_000_000
#: Threads per inch that the firmware takes, in steps of 1/100.
FINEST_TPI = 1000

Hand = Literal["right", "left"]


def _plain(name: str) -> str:
    if not re.fullmatch(r"[A-Za-z0-9](?:[A-Za-z0-9 .,:;+()_/#=-]*[A-Za-z0-9.)])?", name):
        raise ValueError("must be of plain letters, digits, spaces and .,:;+-()_/#= because it enters C")
    return name


class Limits(Spec):
    """What the machine can do: speed of hob or spindle [1/min], rates [steps/s], acceleration [steps/s^2]."""

    hob_rpm: float = Field(ge=1.0, le=20_000.0, validation_alias=AliasChoices("hob_rpm", "spindle_rpm"))
    step_rate_hz: float = Field(ge=10.0, le=1e6)
    move_rate_hz: float | None = Field(default=None, ge=10.0, le=1e6)
    """Of a jog or an index move; 2000, or the step rate where that is less, if not given."""
    acceleration_hz_per_s: float = Field(ge=1.0, le=1e7)
    run_up_s: float | None = Field(default=None, ge=0.0, le=600.0)
    """Time of the hob from rest to hob_rpm, or from there to rest, whichever is shorter; plans are checked with it."""
    lag_steps: int = Field(ge=1, le=30_000)
    """Steps that may wait before the gearbox trips."""

    @model_validator(mode="before")
    @classmethod
    def _one_speed(cls, data: Any) -> Any:
        if isinstance(data, dict):
            given = [f"{key} = {data[key]}" for key in ("hob_rpm", "spindle_rpm") if key in data]
            if len(given) > 1:
                raise ValueError(f"{' and '.join(given)}: are one limit, use one of them")
            if not given:
                raise ValueError("hob_rpm is missing, which of a lathe is called spindle_rpm")
        return data


class HobbingMachine(Shown, Spec):
    """A hobbing machine, or a lathe, with an electronic gearbox. Names as in the generated ``gm_machine.h``."""

    name: Annotated[str, AfterValidator(_plain)] = Field(min_length=1, max_length=60)
    profile: Literal["hobbing", "lathe"] = "hobbing"
    board: BoardName
    hob_starts: int = Field(default=1, ge=1, le=int(notation.hob_starts.domain[1]))
    hob_hand: Hand = "right"
    encoder: Encoder
    table: Table | None = None
    lead_screw: LeadScrew | None = None
    feed: Feed | None = None
    driver: Driver
    pins: Pins = Pins()
    display: Display = Display()
    limits: Limits
    hobs: tuple[Hob, ...] = Field(default=(), strict=False)
    errors: CuttingErrors = CuttingErrors()
    """What is wrong with the machine: for virtual cutting only, the firmware does not know it."""

    @model_validator(mode="before")
    @classmethod
    def _pins_of_the_counter(cls, data: Any) -> Any:
        """Where a counter is asked for and no pins of the encoder are given, those of the board's counter."""
        try:
            encoder, pins, (first, second) = data["encoder"], data.get("pins", {}), DEFAULT_PINS[data["board"]]
            wanted = encoder["decoder"] == "hardware" or encoder.get("counter") == "hardware"
            if wanted and not {"encoder_step", "encoder_dir"} & set(pins):
                return {**data, "pins": {**pins, "encoder_step": first, "encoder_dir": second}}
        except (AttributeError, KeyError, TypeError):
            pass  # what is wrong with it is said where the section is read
        return data

    @model_validator(mode="after")
    def _fits_together(self) -> HobbingMachine:
        self._check_profile()
        self._check_hobs()
        self._check_pins()
        self._check_edges()
        check_motion(self)
        return self

    def _check_profile(self) -> None:
        needed, other = ("lead_screw", "table") if self.profile == "lathe" else ("table", "lead_screw")
        if getattr(self, needed) is None:
            raise ValueError(f"{needed}: the section [{needed}] is missing, profile = {self.profile!r} needs it")
        unfit = [other] + ["feed", "hobs"] * (self.profile == "lathe")
        for key in unfit:
            if getattr(self, key):
                raise ValueError(f"{key}: [{key}] has no meaning with profile = {self.profile!r}, take it out")
        if self.profile == "lathe" and (self.hob_starts, self.hob_hand) != (1, "right"):
            key, value = ("hob_starts", self.hob_starts) if self.hob_starts != 1 else ("hob_hand", repr(self.hob_hand))
            raise ValueError(f"{key} = {value}: has no meaning with profile = 'lathe', take it out")

    def _check_hobs(self) -> None:
        names = [hob.name for hob in self.hobs]
        if self.profile == "hobbing" and not names:
            raise ValueError("hobs: the list is empty, at least one [[hobs]] must be there")
        if len(names) > MOST_HOBS:
            raise ValueError(f"hobs: the list has {len(names)}, at most {MOST_HOBS} have a number on the display")
        for place, name in enumerate(names, 1):
            if name in names[: place - 1]:
                raise ValueError(f"hobs #{place}: hob {name} stands in the list more than once, take it out")

    def _check_pins(self) -> None:
        self.pins.check(self.board, self.hardware)
        if self.pins.enable is not None and self.driver.enables is None:
            raise ValueError(
                f"pins.enable = {self.pins.enable}: it is not known which level enables this driver; leave the pin out "
                "and the driver's ENABLE open, or write driver.enable_active from its manual"
            )
        for key in ("feed_step", "feed_dir"):
            pin = getattr(self.pins, key)
            if pin is None and self.feed is not None:
                raise ValueError(
                    f"pins.{key}: the key is missing; [feed] needs a pin from 0 to {self.hardware.highest_pin}"
                )
            if pin is not None and self.feed is None:
                raise ValueError(
                    f"pins.{key} = {pin}: has no meaning without [feed]; take the pin out, or write [feed]"
                )

        if self.pins.reset is not None and self.pins.alarm is None:
            raise ValueError(
                f"pins.reset = {self.pins.reset}: has no meaning without pins.alarm; take it out, or give both"
            )
        if self.encoder.wants_counter:
            self._check_counters()

    def _check_counters(self) -> None:
        instead = "leave counter out" if self.encoder.has_ls7184 else 'write decoder = "interrupts"'
        pins = self.pins
        used: list[int] = []
        for name, reached in (("encoder", self.hob_counter), ("feed", self.feed_counter)):
            if name == "feed" and self.feed is None:
                continue
            first, second = (getattr(pins, f"{name}_{end}") for end in ("step", "dir"))
            if reached is None:
                raise ValueError(
                    f"pins.{name}_step = {first} and pins.{name}_dir = {second}: no counter of a {self.hardware.title} "
                    f"reaches these pins in this order; it takes {pins_in_words(self.board)}; or {instead}"
                )
            if self.board == "teensy32" and reached.unit in used:
                raise ValueError(f"pins.feed_step = {first}: its counter FTM{reached.unit} is that of the hob already")
            shared = set(reached.crossbar) & set(used)
            if self.board != "teensy32" and shared:
                raise ValueError(f"pins.feed_step = {first} and pins.feed_dir = {second}: 0 and 5 share one input")
            used += [reached.unit] if self.board == "teensy32" else list(reached.crossbar)

    def _check_edges(self) -> None:
        most = int(notation.encoder_counts.domain[1])
        if self.encoder_counts > most or self.encoder_counts.numerator > MOST_TURN_COUNTS:
            raise ValueError(
                f"encoder.lines = {self.encoder.lines} with {self.encoder.decoder} and belt {self.encoder.belt} are "
                f"{self.encoder_counts} counts a turn: the kernels take {most}, and {MOST_TURN_COUNTS} as numerator; "
                f"use at most {int(most / self.encoder.belt) // self.encoder.edges_per_line} lines"
            )
        carried = self.edge_rate_limit
        what = f"board {self.board}" if carried == self.hardware.highest_edge_rate else "the LS7184"
        if self.max_edge_rate > carried:
            raise ValueError(
                f"{self.speed_key} = {self.limits.hob_rpm:g}: with {self.encoder_counts} counts a turn are "
                f"{self.max_edge_rate} edges/s: {what} carries {carried}, which is at most "
                f"{int(carried * 60 / self.encoder_counts)} rpm"
            )

    # --- the train ------------------------------------------------------------------------------------------------
    @property
    def drive(self) -> Table | LeadScrew:
        """What the motor drives: the table of a hobbing machine, the lead screw of a lathe."""
        drive = self.lead_screw if self.profile == "lathe" else self.table
        assert drive is not None  # _check_profile
        return drive

    @property
    def speed_key(self) -> str:
        """The key of the highest speed, as the file has it."""
        return "limits.spindle_rpm" if self.profile == "lathe" else "limits.hob_rpm"

    @property
    def encoder_counts(self) -> Fraction:
        """Encoder counts per turn of the hob (the spindle), after the decoder, exactly."""
        return self.encoder.counts_per_shaft * self.encoder.belt

    @property
    def motor_steps(self) -> Fraction:
        """Motor steps per turn of the work table (the lead screw), exactly."""
        return self.drive.steps_per_turn

    @property
    def lead_screw_pitch(self) -> Fraction:
        """Pitch of a lathe's lead screw [mm], exactly."""
        assert self.lead_screw is not None
        return self.lead_screw.pitch

    @property
    def feed_counts(self) -> Fraction:
        """Counts per mm of the feed encoder, exactly; 0 without one."""
        return self.feed.counts_per_mm if self.feed is not None else Fraction(0)

    @property
    def feed_climbs(self) -> bool:
        """Whether the counts of the feed encoder go up in climb hobbing."""
        return self.feed is not None and self.feed.counts_up == "climb"

    @property
    def wide(self) -> bool:
        """Whether some job of this machine needs 64 bits: two axes, or a denominator beyond the 32-bit rule."""
        if self.profile == "hobbing":
            counts = self.encoder_counts
            widest = int(notation.teeth.domain[1]) * counts.numerator * self.motor_steps.denominator
            return self.feed is not None or widest * counts.denominator > NARROW
        per_mm = self.motor_steps / (self.lead_screw_pitch * self.encoder_counts)
        metric = (per_mm / 1000).denominator  # every pitch in 1/1000 mm
        inch = (per_mm * EXACT_INCH * 100).denominator * FINEST_TPI * 100  # every number of threads in 1/100 per inch
        return max(metric, inch) * self.encoder_counts.denominator > NARROW

    # --- board, driver and limits in the units of the firmware ------------------------------------------------------
    @property
    def hardware(self) -> Board:
        """The board's own figures."""
        return BOARDS[self.board]

    @property
    def hob_counter(self) -> Counter | None:
        """The board's counter of the hob encoder, None where interrupts count it."""
        pins = (self.pins.encoder_step, self.pins.encoder_dir)
        return counter(self.board, pins, feed=False) if self.encoder.wants_counter else None

    @property
    def feed_counter(self) -> Counter | None:
        """The board's counter of the feed encoder."""
        first, second = self.pins.feed_step, self.pins.feed_dir
        if self.feed is None or first is None or second is None or not self.encoder.wants_counter:
            return None
        return counter(self.board, (first, second), feed=True)

    def counter_filter(self, edge_rate: float) -> tuple[int, float]:
        """Register value and time [ns] of a counter's filter that passes every edge at ``edge_rate`` per second.

        Real edges come at half their mean distance and more; a quarter of it is ignored. The LS7184's pulse is short.
        """
        return filter_setting(self.board, LS7184_FILTER if self.encoder.has_ls7184 else 1e9 / (4 * edge_rate))

    @property
    def tick_ns(self) -> int:
        """Period of the step timer."""
        return self.hardware.tick_ns

    @property
    def jitter_ns(self) -> int:
        """How much a tick may be late: hob edge, feed edge and index in one moment, each before it."""
        return self.hardware.jitter_ns * (1 + (self.feed is not None) + (self.pins.index is not None))

    @property
    def timing_ticks(self) -> tuple[int, int, int, int]:
        """Step high, step low, DIR set-up and DIR hold, in ticks of the step timer."""
        return self.driver.timing.ticks(self.tick_ns, self.jitter_ns)

    @property
    def step_active_low(self) -> bool:
        """Level of the board's pin during a step."""
        return self.driver.pin_active_low(self.driver.step_active)

    @property
    def dir_active_low(self) -> bool:
        """Level of the board's pin for DIR forward."""
        return self.driver.pin_active_low(self.driver.dir_active)

    @property
    def enable_active_low(self) -> bool:
        """Level of the board's pin that enables the driver."""
        return self.pins.enable is not None and self.driver.pin_active_low(self.driver.enables or "low")

    @property
    def max_edge_rate(self) -> int:
        """Encoder edges per second at the highest speed, rounded up."""
        return math.ceil(self.limits.hob_rpm / 60.0 * float(self.encoder_counts))

    @property
    def edge_rate_limit(self) -> int:
        """Encoder edges per second that board and decoder carry."""
        board = self.hardware.highest_edge_rate
        return min(board, LS7184_EDGE_RATE) if self.encoder.has_ls7184 else board

    @property
    def max_step_rate(self) -> int:
        """Motor steps per second while following."""
        return int(self.limits.step_rate_hz)

    @property
    def move_max_rate(self) -> int:
        """Motor steps per second of a jog or an index move."""
        limits = self.limits
        return int(min(2000.0, limits.step_rate_hz) if limits.move_rate_hz is None else limits.move_rate_hz)

    def _shown(self) -> tuple[str, list[Shows]]:
        figures: list[Shows] = [
            ("kind", self.profile, ""),
            ("board", self.board, ""),
            ("encoder lines", self.encoder.lines, ""),
        ]
        return self.name, [*figures, ("hobs", tuple(hob.name for hob in self.hobs), "")]


def load_hobbing_machine(path: Path) -> HobbingMachine:
    """Read a machine file. Raises InputError with file, key, value and limit in one sentence."""
    return load(path, HobbingMachine)


def find_hobbing_machine(name: str) -> HobbingMachine:
    """A machine file by its path, or by the name of a bundled one. Raises InputError."""
    return load_hobbing_machine(find(name))
