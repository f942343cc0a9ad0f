"""The circuit that holds the power of the spindle, in the wiring diagram: fuse, emergency stop, relay, latch."""

from __future__ import annotations

from schemdraw import Drawing, elements

from gearmath.export.diagram import box, line, small, text
from gearmath.specs.hobbing import HobbingMachine

_STEP, _CONTACT = 3.0, 1.6


def contactor(drawing: Drawing, machine: HobbingMachine, y: float) -> float:
    """Draws the chain from left to right below ``y``; returns the height of its lower end."""
    text(drawing, (0.0, y + 1.6), "Power of the spindle: control circuit of its contactor KM1", align="left")
    links = [("F1", "1 A", True)]
    if machine.pins.estop is not None:
        links.append(("S2 11-12", "emergency stop", True))
    links.append(("S3", "stop", True))
    if machine.pins.healthy is not None:
        links.append(("K1 COM-NO", "relay of the board", False))
    small(drawing, (0.0, y + 0.45), "L")
    x = 0.3
    line(drawing, (0.0, y), (x, y))
    for k, (name, what, closed) in enumerate(links):
        end = x + _CONTACT
        drawing.add(elements.Fuse().at((x, y)).to((end, y)) if k == 0 else _contact(closed).at((x, y)).to((end, y)))
        small(drawing, ((x + end) / 2, y + 0.85), name)
        small(drawing, ((x + end) / 2, y - 0.75), what)
        line(drawing, (end, y), (end + _STEP - _CONTACT, y))
        x = end + _STEP - _CONTACT
    latch, after = y - 1.9, x + 2.4
    drawing.add(elements.Button().at((x + 0.4, y)).to((x + 2.0, y)))
    line(drawing, (x, y), (x + 0.4, y))
    line(drawing, (x + 2.0, y), (after, y))
    small(drawing, (x + 1.2, y + 0.95), "S4 start")
    line(drawing, (x, y), (x, latch))
    line(drawing, (x, latch), (x + 0.4, latch))
    drawing.add(_contact(closed=False).at((x + 0.4, latch)).to((x + 2.0, latch)))
    line(drawing, (x + 2.0, latch), (after, latch))
    line(drawing, (after, latch), (after, y))
    small(drawing, (x + 1.2, latch + 0.85), "KM1 13-14: latch")
    drawing.add(elements.Dot().at((x, y)))
    drawing.add(elements.Dot().at((after, y)))
    line(drawing, (after, y), (after + 1.2, y))
    box(drawing, (after + 1.2, after + 4.0), y + 0.6, y - 0.6, "KM1 A1-A2")
    line(drawing, (after + 4.0, y), (after + 5.2, y))
    small(drawing, (after + 5.2, y + 0.45), "N")
    return latch - 0.8


def _contact(closed: bool) -> elements.Element2Term:
    return elements.Switch(nc=closed)
