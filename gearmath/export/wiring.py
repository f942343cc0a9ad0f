"""The wiring diagram of one machine as SVG: what hangs on which pin of the board, drawn with schemdraw.

The text is the same on every machine: no date, no font metrics of the system. Units of the drawing are those of
schemdraw; x runs to the right, y upwards, and the signals of one group share their heights from left to right.
"""

from __future__ import annotations

from schemdraw import Drawing, elements

from gearmath.export.contactor import contactor
from gearmath.export.diagram import TEXT, TITLE, Point, box, ground, line, pin_down, small, supply, text, titled
from gearmath.export.netlist import LOGIC, PLUS, WINDINGS, motor_cables, netlist, straight
from gearmath.export.wiring_supply import regulator
from gearmath.specs.hobbing import HobbingMachine

#: Left and right edge of what stands in one column.
_SENSOR = (0.0, 3.0)
_DECODER = (5.0, 8.0)
_SHIFTER = (9.6, 11.6)
_BOARD = (13.6, 18.6)
_DRIVER = (27.6, 32.6)


def wiring_svg(machine: HobbingMachine) -> str:
    """SVG text. The machine's name is its title, which a browser shows on hovering."""
    drawing = Drawing(canvas="svg", show=False)
    drawing.config(fontsize=TEXT, font="sans-serif", lw=1.4, bgcolor="white", margin=0.4)
    left = _inputs(drawing, machine)
    right = _outputs(drawing, machine)
    bottom = min(left, right)
    box(drawing, _BOARD, 1.0, bottom, machine.hardware.title)
    small(drawing, (_BOARD[1] - 0.5, 0.7), "U1")
    contactor(drawing, machine, bottom - 4.6)
    regulator(drawing, machine)
    supply(drawing, (_BOARD[0] + 1.5, 1.0), "+5 V", "Vin")
    ground(drawing, (_BOARD[0] + 1.5, bottom), "GND")
    return titled(drawing.get_imagedata("svg").decode("utf-8"), machine.name)


# --- the left side: what the board reads ------------------------------------------------------------------------------
def _inputs(drawing: Drawing, machine: HobbingMachine) -> float:
    """Draws the inputs from y = 0 downwards; returns the height of the lower end."""
    pins = machine.pins
    title = "spindle encoder" if machine.profile == "lathe" else "hob encoder"
    y = _encoder(drawing, machine, 0.0, title, (pins.index, pins.encoder_step, pins.encoder_dir))
    if machine.feed is not None:
        y = _encoder(drawing, machine, y, "feed encoder", (None, pins.feed_step, pins.feed_dir))
    y = _knob(drawing, machine, y)
    if pins.estop is not None:
        _to_pin(drawing, (_SENSOR[1], y), pins.estop)
        drawing.add(elements.Line().at((1.5, y)).to((1.5, y - 0.3)))
        drawing.add(elements.Line().at((1.5, y)).to((_SENSOR[1] - 1.0, y)))
        drawing.add(elements.Switch(nc=True).at((_SENSOR[1] - 1.0, y)).to((_SENSOR[1] + 1.0, y)))
        ground(drawing, (1.5, y - 0.3), "")
        text(drawing, (0.0, y + 0.7), "S2: emergency stop, second contact 21-22, normally closed", align="left")
        y -= 1.8
    return y + 0.4


def _encoder(drawing: Drawing, machine: HobbingMachine, y: float, title: str, pins: tuple[int | None, ...]) -> float:
    """An encoder with its decoder; ``pins`` are those of index, pulse or A, direction or B."""
    index, first, second = pins
    rows = {
        name: (y - drop, pin)
        for name, drop, pin in (("Z", 0, index), ("A", 1.6, first), ("B", 2.6, second))
        if pin is not None
    }
    top = 0.7 if index is not None else -0.9
    box(drawing, _SENSOR, y + top, y - 3.7, "")
    text(drawing, (sum(_SENSOR) / 2, y - 3.3), title)
    small(drawing, (0.4, y + top - 0.35), "B2" if title.startswith("feed") else "B1")
    supply(drawing, (1.0, y + top), "+5 V")
    ground(drawing, (1.0, y - 3.7), "")
    for name, (height, pin) in rows.items():
        assert pin is not None
        text(drawing, (_SENSOR[1] - 0.2, height), name, align="right")
        if name == "Z" or not machine.encoder.has_ls7184:
            _to_pin(drawing, (_SENSOR[1], height), pin, machine)
            continue
        line(drawing, (_SENSOR[1], height), (_DECODER[0], height))
        _to_pin(drawing, (_DECODER[1], height), pin, machine)
    if machine.encoder.has_ls7184:
        _decoder(drawing, machine, y, "RB2" if title.startswith("feed") else "RB1")
        return y - 7.0
    return y - 5.4


def _decoder(drawing: Drawing, machine: HobbingMachine, y: float, bias: str) -> None:
    """LS7184N between the heights of the rows A and B at y - 1.6 and y - 2.6."""
    left, right = _DECODER
    box(drawing, _DECODER, y - 0.9, y - 4.2, "LS7184N", at=y - 3.3)
    for height, number, name, output, symbol in ((y - 1.6, 4, "A", 8, "CLK"), (y - 2.6, 5, "B", 7, "UP/DN")):
        text(drawing, (left + 0.2, height), name, align="left")
        text(drawing, (right - 0.2, height), symbol, align="right")
        small(drawing, (left - 0.25, height + 0.25), str(number))
        small(drawing, (right + 0.25, height + 0.25), str(output))
    supply(drawing, (left + 1.5, y - 0.9), "+5 V", "VDD", "2")
    small(drawing, (left + 2.6, y - 1.25), "U4" if bias == "RB2" else "U3")
    bottom = y - 4.2
    ground(drawing, (left + 0.5, bottom), "VSS", "3")
    pin_down(drawing, (left + 1.5, bottom), "RBIAS", "1")
    drawing.add(elements.Resistor().at((left + 1.5, bottom)).to((left + 1.5, bottom - 1.4)))
    text(drawing, (left + 1.8, bottom - 0.95), bias, align="left")
    ground(drawing, (left + 1.5, bottom - 1.4), "")
    pin_down(drawing, (left + 2.5, bottom), "MODE", "6")
    mode = (left + 2.5, bottom - 0.5)
    line(drawing, (left + 2.5, bottom), mode)
    if machine.encoder.edges_per_line == 1:
        ground(drawing, mode, "")
        text(drawing, (mode[0] + 0.4, mode[1] - 0.1), "x1: to ground", align="left")
    elif machine.encoder.edges_per_line == 2:
        line(drawing, mode, (right + 0.6, mode[1]))
        supply(drawing, (right + 0.6, mode[1]), "+5 V")
        text(drawing, (right + 0.9, mode[1]), "x2: to +5 V", align="left")
    else:
        text(drawing, (mode[0] + 0.45, mode[1] - 0.05), "x4: left open", align="left")


def _knob(drawing: Drawing, machine: HobbingMachine, y: float) -> float:
    box(drawing, _SENSOR, y + 0.7, y - 2.7, "")
    text(drawing, (1.0, y - 0.8), "knob", size=TITLE)
    small(drawing, (0.4, y + 0.35), "S1")
    rows = (("A", machine.pins.knob_a), ("B", machine.pins.knob_b), ("button", machine.pins.button))
    for k, (name, pin) in enumerate(rows):
        text(drawing, (_SENSOR[1] - 0.2, y - 0.8 * k), name, align="right")
        _to_pin(drawing, (_SENSOR[1], y - 0.8 * k), pin)
    ground(drawing, (1.0, y - 2.7), "commons")
    return y - 5.2


def _to_pin(drawing: Drawing, start: Point, pin: int, machine: HobbingMachine | None = None) -> None:
    """From the left to a pin of the board, through a level shifter where 5 V would destroy it."""
    height = start[1]
    if machine is not None and not machine.hardware.five_volt_tolerant:
        line(drawing, start, (_SHIFTER[0], height))
        _shift(drawing, height, "74LVC245")
        k = _channel(machine, pin)
        small(drawing, (_SHIFTER[0] - 0.45, height + 0.28), f"{2 + k} A{k + 1}")
        small(drawing, (_SHIFTER[1] + 0.45, height + 0.28), f"{18 - k} B{k + 1}")
        start = (_SHIFTER[1], height)
    line(drawing, start, (_BOARD[0], height))
    text(drawing, (_BOARD[0] + 0.2, height), f"pin {pin}", align="left")


def _channel(machine: HobbingMachine, pin: int) -> int:
    """Which channel of the 74LVC245 leads to a pin of the board: that of the netlist."""
    nets = netlist(machine).nets.values()
    (end,) = (end for net in nets if ("U1", str(pin)) in net for end in net if end[0] == "U5")
    return int(end[1].split(" B")[1]) - 1


def _shift(drawing: Drawing, height: float, chip: str, edges: Point = _SHIFTER) -> None:
    drawing.add(
        elements.Rect(corner1=(edges[0], height + 0.32), corner2=(edges[1], height - 0.32), fill="#eef3fa")
        .at((0, 0))
        .theta(0)
    )
    small(drawing, ((edges[0] + edges[1]) / 2, height), chip)


# --- the right side: what the board drives ----------------------------------------------------------------------------
def _outputs(drawing: Drawing, machine: HobbingMachine) -> float:
    """Draws driver, fail-safe relay and display from the top downwards; returns the height of the lower end."""
    pins = machine.pins
    signals = [("STEP", pins.step_out), ("DIR", pins.dir_out)]
    if pins.enable is not None:
        signals.append(("ENABLE", pins.enable))
    opened = machine.driver.output == "open_collector"
    pitch = 3.0 if opened else 1.2
    top = 0.0
    for k, (name, pin) in enumerate(signals):
        _drive(drawing, top - pitch * k, name, pin, f"T{k + 1}" if opened else "")
    last = top - pitch * (len(signals) - 1)
    others = straight(machine)
    for name, pin in others:
        last -= 1.2 if last < top - pitch * (len(signals) - 1) else 2.2
        _drive(drawing, last, f"{name} +", pin, "")
    last = min(last, _motor(drawing, machine))
    box(drawing, _DRIVER, top + 1.9, last - 0.9, "step motor driver", at=top + 1.5)
    small(drawing, (_DRIVER[0] + 0.4, top + 1.5), "A2")
    if opened:
        supply(drawing, (_DRIVER[1] - 1.2, top + 1.9), "+5 V to all + inputs")
    if others or not opened:
        ends = ["common"] * (not opened) + [f"{name} -" for name, _ in others]
        text(drawing, (_DRIVER[0] + 0.2, last - 0.6), ", ".join(ends), align="left")
        ground(drawing, (_DRIVER[0] + 0.7, last - 0.9), "")
    y = last - 3.4
    if pins.healthy is not None:
        _pump(drawing, y, pins.healthy, f"T{len(signals) + 1}")
        box(drawing, _DRIVER, y + 1.2, y - 0.9, "relay K1", at=y - 0.1)
        small(drawing, ((_DRIVER[0] + _DRIVER[1]) / 2, y - 0.6), "D3 1N4148 across its coil")
        supply(drawing, (_DRIVER[1] - 0.7, y + 1.2), "+5 V")
        y -= 5.2
    return _display(drawing, machine, y)


def _drive(drawing: Drawing, y: float, name: str, pin: int, transistor: str) -> None:
    """One output: through an open-collector transistor, or straight where there is none."""
    text(drawing, (_BOARD[1] - 0.2, y), f"pin {pin}", align="right")
    if not transistor:
        line(drawing, (_BOARD[1], y), (_DRIVER[0], y))
        text(drawing, (_DRIVER[0] + 0.2, y), name, align="left")
        return
    drawing.add(
        elements.Resistor().at((_BOARD[1], y)).to((_BOARD[1] + 2.6, y)).label(f"R{transistor[1:]}  1 k", fontsize=TEXT)
    )
    bjt = drawing.add(elements.BjtNpn(circle=True).at((_BOARD[1] + 2.6, y)).anchor("base"))
    text(drawing, (bjt.center[0] + 1.3, y), f"{transistor}  2N2222", align="left")
    ground(drawing, bjt.emitter, "")
    height = bjt.collector[1]
    line(drawing, bjt.collector, (_BOARD[1] + 5.0, height))
    if name:
        drawing.add(elements.Resistor().at((_BOARD[1] + 5.0, height)).to((_BOARD[1] + 7.4, height)))
        small(drawing, (_BOARD[1] + 6.2, height + 0.55), f"RL{transistor[1:]}, optional: see README")
    line(drawing, (_BOARD[1] + (7.4 if name else 5.0), height), (_DRIVER[0], height))
    text(drawing, (_DRIVER[0] + 0.2, height), f"{name} -" if name else "coil", align="left")


def _motor(drawing: Drawing, machine: HobbingMachine) -> float:
    """Motor and supply to the right of the driver; returns the height of the lowest wire."""
    edge, near, far = _DRIVER[1], _DRIVER[1] + 3.4, _DRIVER[1] + 6.4
    ends = motor_cables(machine)
    for k, end in enumerate(ends):
        height = (1.1 if len(ends) > len(WINDINGS) else 0.9) - 0.6 * k
        text(drawing, (edge - 0.2, height), end, align="right")
        line(drawing, (edge, height), (near, height))
    box(drawing, (near, far), 1.4, -1.4, "motor M1")
    for k, end in enumerate(("power +", "power -")):
        height = -2.4 - 1.2 * k
        text(drawing, (edge - 0.2, height), end, align="right")
        line(drawing, (edge, height), (edge + 0.8, height))
        if k == 0:
            drawing.add(elements.Fuse().at((edge + 0.8, height)).to((edge + 2.4, height)))
            small(drawing, (edge + 1.6, height + 0.65), "F3")
            line(drawing, (edge + 2.4, height), (near, height))
        else:
            line(drawing, (edge + 0.8, height), (near, height))
        small(drawing, (near + 0.3, height), end[-1])
    box(drawing, (near, far), -1.8, -4.2, "supply G2")
    return -3.6


def _pump(drawing: Drawing, y: float, pin: int, transistor: str) -> None:
    """Charge pump and transistor of the fail-safe relay: direct current of the pin, high or low, does not pass C3."""
    wave, node, store = _BOARD[1] + 1.6, _BOARD[1] + 2.9, _BOARD[1] + 4.3
    text(drawing, (_BOARD[1] - 0.2, y), f"pin {pin}", align="right")
    drawing.add(elements.Resistor().at((_BOARD[1], y)).to((wave, y)))
    small(drawing, (_BOARD[1] + 0.8, y + 0.65), "RC3 100")
    drawing.add(elements.Capacitor().at((wave, y)).to((node, y)))
    small(drawing, (wave - 0.1, y - 0.75), "C3 2.2 uF")
    drawing.add(elements.Diode().at((node, y - 1.5)).to((node, y)))
    small(drawing, (node - 1.05, y - 1.6), "D1 1N5819")
    ground(drawing, (node, y - 1.5), "")
    drawing.add(elements.Diode().at((node, y)).to((store, y)))
    small(drawing, (node + 0.8, y + 1.0), "D2 1N5819")
    drawing.add(elements.Capacitor(polar=True).at((store, y)).to((store, y - 1.5)))
    small(drawing, (store + 0.9, y - 1.0), "C4 10 uF")
    ground(drawing, (store, y - 1.5), "")
    base = store + 1.6
    drawing.add(elements.Resistor().at((store, y)).to((base, y)))
    small(drawing, (store + 0.9, y + 0.65), f"R{transistor[1:]} 1 k")
    bjt = drawing.add(elements.BjtNpn(circle=True).at((base, y)).anchor("base"))
    small(drawing, (bjt.center[0] + 1.5, y - 0.6), f"{transistor} 2N2222")
    ground(drawing, bjt.emitter, "")
    line(drawing, bjt.collector, (_DRIVER[0], bjt.collector[1]))
    text(drawing, (_DRIVER[0] + 0.2, bjt.collector[1]), "coil", align="left")


def _display(drawing: Drawing, machine: HobbingMachine, y: float) -> float:
    name = {"adafruit292": "Adafruit 292", "pcf8574": "PCF8574"}[machine.display.kind]
    box(drawing, _DRIVER, y + 0.7, y - 2.3, "display 4 x 20", at=y - 1.4)
    small(drawing, ((_DRIVER[0] + _DRIVER[1]) / 2, y - 1.9), f"{name}, address 0x{machine.display.i2c_address:02X}")
    small(drawing, (_DRIVER[0] + 0.4, y + 0.35), "H1")
    supply(drawing, (_DRIVER[1] - 0.7, y + 0.7), "+5 V")
    ground(drawing, (_DRIVER[1] - 0.7, y - 2.3), "")
    for k, (signal, pin) in enumerate((("SDA", machine.pins.sda), ("SCL", machine.pins.scl))):
        height = y - 0.8 * k
        text(drawing, (_BOARD[1] - 0.2, height), f"pin {pin}", align="right")
        text(drawing, (_DRIVER[0] + 0.2, height), signal, align="left")
        _pull_up(drawing, (_BOARD[1] + 2.2 + 0.7 * k, height), y + 0.5, f"RP{k + 1}", machine)
        if machine.hardware.five_volt_tolerant:
            line(drawing, (_BOARD[1], height), (_DRIVER[0], height))
            continue
        edges = (_BOARD[1] + 3.6, _BOARD[1] + 6.0)
        line(drawing, (_BOARD[1], height), (edges[0], height))
        _shift(drawing, height, "BSS138", edges)
        line(drawing, (edges[1], height), (_DRIVER[0], height))
    return y - 2.3


def _pull_up(drawing: Drawing, foot: Point, above: float, name: str, machine: HobbingMachine) -> None:
    """A resistor from a line to the supply of the board's pins, its body from ``above`` on."""
    line(drawing, foot, (foot[0], above))
    drawing.add(elements.Dot().at(foot))
    drawing.add(elements.Resistor().at((foot[0], above)).to((foot[0], above + 1.3)))
    drawing.add(elements.Vdd().at((foot[0], above + 1.3)))
    side = 1.0 if name.endswith("2") else -1.0
    volts = PLUS if machine.hardware.five_volt_tolerant else LOGIC
    small(drawing, (foot[0] + 0.55 * side, above + 1.6), volts)
    small(drawing, (foot[0] + side, above + 0.6), f"{name} 4.7 k")
