"""The supply in the wiring diagram: regulator, capacitors across the chips, level shifters."""

from __future__ import annotations

from schemdraw import Drawing, elements

from gearmath.export.diagram import TEXT, Point, box, ground, line, small, supply, text
from gearmath.export.netlist import GROUND, netlist
from gearmath.specs.hobbing import HobbingMachine


def regulator(drawing: Drawing, machine: HobbingMachine) -> None:
    """Regulator with its capacitors, above everything else."""
    y = 5.2
    box(drawing, (0.0, 2.2), y + 0.7, y - 0.8, "G1 9 V")
    small(drawing, (2.45, y + 0.25), "+")
    ground(drawing, (1.1, y - 0.8), "", "-")
    line(drawing, (2.2, y), (2.8, y))
    drawing.add(elements.Fuse().at((2.8, y)).to((4.2, y)))
    small(drawing, (3.5, y + 0.65), "F2")
    line(drawing, (4.2, y), (7.0, y))
    _capacitor(drawing, (4.8, y), "C1")
    box(drawing, (7.0, 9.6), y + 0.7, y - 0.8, "U2 LM7805")
    small(drawing, (6.75, y + 0.25), "1")
    small(drawing, (9.85, y + 0.25), "3")
    ground(drawing, (8.3, y - 0.8), "", "2")
    line(drawing, (9.6, y), (12.0, y))
    _capacitor(drawing, (10.4, y), "C2")
    supply(drawing, (12.0, y), "+5 V")
    _bypasses(drawing, machine, y + 4.2)
    if not machine.hardware.five_volt_tolerant:
        _shifters(drawing, machine, y)


def _bypasses(drawing: Drawing, machine: HobbingMachine, y: float) -> None:
    """The capacitors across the supply pins of the chips, in a row."""
    text(drawing, (0.0, y + 1.2), "Across the supply pins of each chip, as near as possible:", align="left")
    found = netlist(machine)
    for k, name in enumerate(part for part in found.parts if part.startswith("CB")):
        (plus,) = (net for net, ends in found.nets.items() if (name, "1") in ends)
        x = 1.0 + 4.2 * k
        drawing.add(elements.Vdd().at((x, y)).label(plus, fontsize=TEXT))
        drawing.add(elements.Capacitor().at((x, y)).to((x, y - 1.4)))
        text(drawing, (x + 0.4, y - 0.7), f"{name} 100 nF, U{name[2:]}", align="left")
        ground(drawing, (x, y - 1.4), "")


def _shifters(drawing: Drawing, machine: HobbingMachine, y: float) -> None:
    """Supplies of the level shifters; their channels stand in the lines."""
    left, low = 14.0, y - 1.2
    box(drawing, (left, left + 3.4), y + 0.7, low, "U5 74LVC245", at=y - 0.3)
    supply(drawing, (left + 0.7, y + 0.7), "+3.3 V", "VCC", "20")
    supply(drawing, (left + 2.6, y + 0.7), "+3.3 V", "DIR", "1")
    ground(drawing, (left + 0.7, low), "GND", "10")
    ground(drawing, (left + 2.6, low), "OE", "19")
    unused = sorted(pin.split(" ")[1] for part, pin in netlist(machine).nets[GROUND] if part == "U5" and " A" in pin)
    if unused:
        small(drawing, (left + 1.7, y - 2.5), f"{', '.join(unused)}: to 0 V")
    left += 5.4
    box(drawing, (left, left + 3.4), y + 0.7, low, "U6 BSS138", at=y - 0.3)
    supply(drawing, (left + 0.7, y + 0.7), "+3.3 V", "LV")
    supply(drawing, (left + 2.6, y + 0.7), "+5 V", "HV")
    ground(drawing, (left + 1.7, low), "GND")
    text(drawing, (left + 4.2, y + 0.35), "+3.3 V is the 3.3 V pin of the board.", align="left")
    text(drawing, (left + 4.2, y - 0.25), f"No pin of the {machine.hardware.title} may ever see 5 V.", align="left")


def _capacitor(drawing: Drawing, top: Point, name: str) -> None:
    drawing.add(elements.Dot().at(top))
    drawing.add(elements.Capacitor(polar=True).at(top).to((top[0], top[1] - 1.6)))
    text(drawing, (top[0] + 0.35, top[1] - 1.15), f"{name} 10 uF", align="left")
    ground(drawing, (top[0], top[1] - 1.6), "")
