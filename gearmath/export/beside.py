"""What a machine takes beside the parts of its circuit: contactor, sockets, heat sink, what all is soldered on."""

from __future__ import annotations

import re
from collections.abc import Iterator
from fractions import Fraction

from gearmath.export.netlist import Netlist
from gearmath.specs.hobbing import HobbingMachine

#: Junction of an LM7805, 25 below the most that it stands, and room [degrees C]; thermal resistance [K/W]: to air
#: without a heat sink, to the case with its pad.
_HOT, ROOM, _BARE, _PAD = 100.0, 40.0, 65.0, 6.0
#: What it stands without a heat sink [W].
BARE_WATTS = (_HOT - ROOM) / _BARE
#: Voltage of the supply that the parts list asks for.
_SUPPLY = 9.0
#: Pins on either side of a board.
_ROWS = {"teensy32": 14, "teensy40": 14, "teensy41": 24}


def beside(machine: HobbingMachine, found: Netlist) -> Iterator[tuple[str, str, str]]:
    """Part, what to buy, what for. What nobody states in the machine file is to be taken from a data sheet."""
    leading, driven = ("spindle", "lead screw") if machine.profile == "lathe" else ("hob", "table")
    reduction = machine.motor_steps / machine.drive.pulses_per_turn
    yield "KM1", "contactor with an auxiliary contact 13-14, coil for the control circuit", "power of the spindle"
    yield "F1", "fuse 1 A, with holder", "control circuit of KM1"
    yield "S3, S4", "push buttons: stop, normally closed, red; start, normally open, green", "control circuit of KM1"
    yield "-", "switch in the feed of G2, if it has none of its own", "power of the motor, by itself"
    yield "XU1", f"2 socket strips of {_ROWS[machine.board]} pins, 2.54 mm", "U1, which is flashed out of them"
    for name, pins in socketed(found):
        yield f"X{name}", f"socket DIP-{pins}", name
    if (sink := heat_sink(found.current, _SUPPLY)) is not None:
        yield "HS2", f"heat sink for TO-220 of at most {sink} K/W, with pad and screw", "U2"
    pull_ups = sum(name.startswith(("encoder_", "index", "feed_")) for name, _ in machine.pins.used())
    yield (
        "-",
        f"{pull_ups} resistors 1 kOhm, where the encoder has open collectors, such as an E6B2-CWZ6C",
        "from each channel to +5 V: see Outputs of encoders",
    )
    yield "-", f"coupling or toothed belt without play or slip; {_turns(machine.encoder.belt, 'B1', leading)}", "B1"
    yield "-", f"what drives the {driven}: {_turns(reduction, 'M1', driven)}", "M1"
    yield "-", "strip board, 100 x 160 mm, or a printed one; screw terminals of 5.08 mm", "all but A2, B, S, H, G and M"
    yield "-", "wire: 0.14 to 0.25 mm2 for signals, 0.5 mm2 for supplies and 0 V; resistors of 1/4 W", "the circuit"
    yield "-", "cabinet of metal, cable glands, shielded twisted cables for encoder and motor", "all of it"


def _turns(ratio: Fraction, one: str, other: str) -> str:
    """How often one shaft turns for the other, in words."""
    if ratio == 1:
        return f"{one} turns once for a turn of the {other}"
    if ratio.denominator == 1:
        return f"{one} turns {ratio} times for a turn of the {other}"
    return f"{one} turns {ratio.numerator} times for {ratio.denominator} turns of the {other}"


def heat_sink(current: int, volts: float) -> int | None:
    """The largest thermal resistance [K/W] of a heat sink on U2 for so many mA at a supply, or None where none is
    needed, or none is enough."""
    watts = (volts - 5.0) * current / 1000
    return int((_HOT - ROOM) / watts - _PAD) if watts > BARE_WATTS and (_HOT - ROOM) / watts > _PAD else None


def socketed(found: Netlist) -> Iterator[tuple[str, str]]:
    """Chips that go into sockets, and their pins."""
    for part in found.parts.values():
        if match := re.search(r"\bDIP-(\d+)", part.what):
            yield part.name, match[1]
