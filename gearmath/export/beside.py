"""What a machine takes beside the parts of its circuit: motor, supplies, fuses, contactor, sockets."""

from __future__ import annotations

import re
from collections.abc import Iterator

from gearmath.export.netlist import Netlist
from gearmath.specs.hobbing import HobbingMachine

#: Fuses 5 x 20 mm, slow [mA], and how much more than the largest current one must carry.
_FUSES, _SPARE = (315, 400, 500, 630, 800, 1000, 1250, 1600), 1.25
#: Pins on either side of a board.
_ROWS = {"teensy32": 14, "teensy40": 14, "teensy41": 24}


def beside(machine: HobbingMachine, found: Netlist) -> Iterator[tuple[str, str, str]]:
    """Part, what to buy, what for. What nobody states in the machine file is to be taken from a data sheet."""
    drive = machine.lead_screw if machine.table is None else machine.table
    assert drive is not None
    kind = f"step motor, {drive.full_steps} full steps a turn" if drive.pulses is None else "servo motor with its drive"
    yield "M1", f"{kind}; torque and current: by the machine, and within the driver", "turns what the gearbox drives"
    yield "G1", f"supply, 9 V DC, {supply_amperes(found.current):.1f} A or more", "the circuit, by U2"
    fuse = next(one for one in _FUSES if one >= _SPARE * found.current)
    yield "F2", f"fuse {fuse} mA slow, 5 x 20 mm, with holder", "between + of G1 and U2"
    yield "G2", "supply of the motor: voltage and current by the data sheets of driver and motor", "A2 alone"
    yield "F3", "fuse as the data sheet of the driver asks for, with holder", "between + of G2 and A2"
    yield "KM1", "contactor with an auxiliary contact 13-14, coil for the control circuit", "power of the spindle"
    yield "F1", "fuse 1 A, with holder", "control circuit of KM1"
    yield "S3, S4", "push buttons: stop, normally closed, red; start, normally open, green", "control circuit of KM1"
    yield "XU1", f"2 socket strips of {_ROWS[machine.board]} pins, 2.54 mm", "U1, which is flashed out of them"
    for name, pins in _chips(found):
        yield f"X{name}", f"socket DIP-{pins}", name


def supply_amperes(current: int) -> float:
    """Current [A] of the supply for parts that take so many mA: half more, in tenths."""
    return -(-current * 15 // 1000) / 10


def _chips(found: Netlist) -> Iterator[tuple[str, str]]:
    for part in found.parts.values():
        if match := re.search(r"\bDIP-(\d+)", part.what):
            yield part.name, match[1]
