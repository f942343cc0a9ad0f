"""The microcontroller board of an electronic gearbox: its pins, its step timer, its display."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

from pydantic import Field, model_validator

from gearmath.specs.toml import Spec


@dataclass(frozen=True)
class Board:
    """What matters of a board: highest pin, period of the step timer, edges per second.

    ``jitter_ns`` is how much a tick may be late for each other interrupt of its priority that has just begun.
    """

    title: str
    highest_pin: int
    tick_ns: int
    jitter_ns: int
    highest_edge_rate: int
    five_volt_tolerant: bool


#: 100 kHz leaves a Teensy 3.2 (72 MHz, no cache of note) 720 cycles an edge; a Teensy 4 has 600 MHz. The interrupts of
#: edge and index take at most 105 and 120 instructions, which are given 180 cycles and 300; a test counts them.
BOARDS = {
    "teensy32": Board("Teensy 3.2", 33, 5000, 2500, 100_000, five_volt_tolerant=True),
    "teensy40": Board("Teensy 4.0", 39, 2000, 500, 400_000, five_volt_tolerant=False),
    "teensy41": Board("Teensy 4.1", 54, 2000, 500, 400_000, five_volt_tolerant=False),
}
BoardName = Literal["teensy32", "teensy40", "teensy41"]

#: Default I2C address of each display's backpack, and the addresses its jumpers can set.
DISPLAYS = {
    "adafruit292": (0x20, (range(0x20, 0x28),)),  # MCP23008
    "pcf8574": (0x27, (range(0x20, 0x28), range(0x38, 0x40))),  # PCF8574, PCF8574A
}


class Pins(Spec):
    """Digital pins. Those of the source text unless given; what is not wired is left out.

    With an LS7184 the encoder pins take its pulse and its direction, otherwise the channels A and B. Only some pins
    reach a counter of the board; ``gearmath.specs.counters`` knows them, and the encoder's where none are given.
    """

    knob_a: int = Field(default=2, ge=0)
    knob_b: int = Field(default=3, ge=0)
    button: int = Field(default=4, ge=0)
    encoder_step: int = Field(default=6, ge=0)
    encoder_dir: int = Field(default=7, ge=0)
    dir_out: int = Field(default=8, ge=0)
    step_out: int = Field(default=13, ge=0)
    sda: Literal[18] = 18
    scl: Literal[19] = 19
    index: int | None = Field(default=None, ge=0)
    """One pulse a turn of the hob."""
    feed_step: int | None = Field(default=None, ge=0)
    feed_dir: int | None = Field(default=None, ge=0)
    enable: int | None = Field(default=None, ge=0)
    """Output that enables the driver."""
    estop: int | None = Field(default=None, ge=0)
    """Input of a normally closed emergency stop to ground: open means stop."""
    alarm: int | None = Field(default=None, ge=0)
    """Input of the driver's alarm output; driver.alarm_active is its level."""
    reset: int | None = Field(default=None, ge=0)
    """Output that is high for 0.2 s to reset the driver after its alarm."""
    healthy: int | None = Field(default=None, ge=0)
    """Output that is a square wave while all is well, for a stage that holds the hob's contactor."""

    def used(self) -> Iterator[tuple[str, int]]:
        """Name and number of every pin that is wired."""
        for name in type(self).model_fields:
            number = getattr(self, name)
            if number is not None:
                yield name, number

    @model_validator(mode="after")
    def _different(self) -> Pins:
        taken: dict[int, str] = {}
        for name, number in self.used():
            if number in taken:
                raise ValueError(f"{name} = {number}: the pin is already that of {taken[number]}")
            taken[number] = name
        return self

    def check(self, name: str, board: Board) -> None:
        """Raises ValueError where a pin is none of the board's."""
        for key, number in self.used():
            if number > board.highest_pin:
                raise ValueError(f"pins.{key} = {number}: board {name} has the pins 0 to {board.highest_pin}")


class Display(Spec):
    """The 4x20 character display, by the chip on its I2C backpack."""

    kind: Literal["adafruit292", "pcf8574"] = "adafruit292"
    address: int | None = None

    @model_validator(mode="after")
    def _settable(self) -> Display:
        ranges = DISPLAYS[self.kind][1]
        if self.address is not None and not any(self.address in addresses for addresses in ranges):
            allowed = " or ".join(f"0x{addresses[0]:02X} to 0x{addresses[-1]:02X}" for addresses in ranges)
            raise ValueError(f"address = 0x{self.address:02X}: the jumpers of {self.kind} set {allowed}")
        return self

    @property
    def i2c_address(self) -> int:
        """The address, that of a new backpack if none is given."""
        return DISPLAYS[self.kind][0] if self.address is None else self.address
