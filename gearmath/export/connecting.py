"""The README's list of connections, and which way round every part goes in."""

from __future__ import annotations

from collections.abc import Iterator

from gearmath.export.markdown import bullets, paragraph, table
from gearmath.export.netlist import GROUND, LOGIC, PLUS, Netlist, netlist
from gearmath.specs.hobbing import HobbingMachine

#: Pins that are pads on the underside of the board.
_UNDERSIDE = {"teensy32": range(24, 34), "teensy40": range(24, 40), "teensy41": range(42, 55)}


def connections(machine: HobbingMachine) -> Iterator[str]:
    """Every net as a row, to tick off while soldering, and the places of the pins."""
    found = netlist(machine)
    yield "### Every connection"
    yield ""
    yield from paragraph(
        "One row is one net: join all that stands in it, and nothing else. `U2 1 IN` is pin 1 of U2, which its data "
        "sheet calls IN; the numbers of U1 are those printed on the board. Tick the rows off, then check every row and "
        "its neighbors with a meter before power comes on."
    )
    order = [name for name in found.nets if name not in (PLUS, LOGIC, GROUND)]
    rows = [
        (name, ", ".join(f"{part} {pin}" for part, pin in found.nets[name]))
        for name in (*order, PLUS, LOGIC, GROUND)
        if name in found.nets
    ]
    yield from table(("net", "joins"), rows)
    yield "### Which way round"
    yield ""
    yield from bullets(_ways(machine, found))


def _ways(machine: HobbingMachine, found: Netlist) -> Iterator[str]:
    """Which end of a part is which, where it matters and a newcomer cannot see it."""
    if any("DIP" in part.what for part in found.parts.values()):
        yield (
            "Chips: seen from above with the notch up, pin 1 is the upper left one; the numbers go down the left side "
            "and up the right one."
        )
    yield "U2: its print towards you, legs down, they are 1 IN, 2 GND, 3 OUT from left to right."
    yield "G1: a meter shows which of its wires is +; a round plug has + inside, as a rule."
    yield "Electrolytic capacitors: the stripe is on the side of -, the longer leg is +. 100 nF and resistors: any way."
    if "D1" in found.parts:
        yield "Diodes: the ring is the cathode."
    if "T1" in found.parts:
        yield (
            "T: a 2N2222 in a plastic case of the TO-92 kind is made with two orders of its legs (E B C and C B E): "
            "look into the data sheet of yours."
        )
    yield (
        "S1: of the three legs in a row the middle one is C, the outer ones are A and B; the two on the other side, "
        "those of the button, are D and E. Contacts need no resistor: the pull-ups are in U1."
    )
    yield from _display(machine)
    yield (
        "Encoders: by the label. Those of the E6B2 kind have brown for +5 V, blue for 0 V, black for A, white for B, "
        "orange for Z. A and B exchanged, it counts backwards, which the encoder test finds."
    )
    servo = machine.drive.pulses is not None
    yield (
        "A2: many makes say PUL for STEP and ENA for ENABLE. A switch for the voltage of these inputs, where there is "
        "one, stands at 5 V."
        + (
            ""
            if servo
            else " M1: between the two wires of a winding a meter shows some ohms; which winding is A, and which of "
            "its ends is +, does not matter, since the direction is set later. A motor of 6 wires: the two ends of "
            "each winding, the taps in their middle open, each taped by itself, at 0.7 of the current for half a "
            "winding. Of 8 wires: two halves of a winding in parallel, by the drawing of the motor, for speed."
        )
    )
    if machine.driver.timing.closed_loop and not servo:
        yield (
            "M1 is followed by A2 itself, through the encoder cable between the two: nothing of it goes to the board. "
            "The windings of such a motor do have their places, by the drawing of A2."
        )
    if machine.pins.alarm is not None:
        yield (
            "A2 ALARM: the two ends of its alarm output, an opto-coupler, ALM + and - in most manuals; where it has a "
            "common with others, that is -. What it does in an alarm, close or open, says the manual: "
            f"`alarm_active` is {machine.driver.alarm_active!r} here, which is "
            f"{'closed' if machine.driver.alarm_active == 'low' else 'open'} in an alarm."
        )


def _display(machine: HobbingMachine) -> Iterator[str]:
    address = f"0x{machine.display.i2c_address:02X}"
    if machine.display.kind == "adafruit292":
        yield (
            "H1: solder the backpack to the 16 pins of the LCD. It says 5V, GND, DAT for SDA and CLK for SCL. All its "
            f"address jumpers open make 0x20; this machine has {address}."
        )
    else:
        yield (
            "H1: solder the backpack to the 16 pins of the LCD, if it is not there yet. All its bridges A0, A1, A2 "
            "open make 0x27 with a PCF8574, 0x3F with a PCF8574A (it is printed on the chip); this machine has "
            f"{address}."
        )


def underside(machine: HobbingMachine) -> Iterator[str]:
    """Which pins of the machine are pads on the underside of the board."""
    pads = [f"{number} (`{name}`)" for name, number in machine.pins.used() if number in _UNDERSIDE[machine.board]]
    if pads:
        yield from paragraph(
            f"Pads on the underside of a {machine.hardware.title}, to be soldered before it goes into its socket: "
            f"{', '.join(pads)}."
        )
