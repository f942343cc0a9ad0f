"""Parts and nets of every machine: each pin once, every chip powered, and all that the machine file wires."""

from __future__ import annotations

import itertools
import re
from xml.etree import ElementTree

import pytest

from gearmath.export.netlist import GROUND, LOGIC, PLUS, netlist
from gearmath.export.wiring import wiring_svg
from gearmath.specs.drive import Feed
from gearmath.specs.hobbing import HobbingMachine, load_hobbing_machine
from gearmath.specs.toml import bundled

MACHINES = (
    "hobbing_plewes",
    "hobbing_default",
    "hobbing_minimum",
    "hobbing_metric",
    "hobbing_helical",
    "lathe_example",
)
#: Supply pins by the data sheets: LM7805 1 in, 2 ground, 3 out; LS7184N 2, 3; 74LVC245 20, 10.
POWER = {
    "U1": {(PLUS, "Vin"), (GROUND, "GND")},
    "U2": {("supply", "1 IN"), (GROUND, "2 GND"), (PLUS, "3 OUT")},
    "U3": {(PLUS, "2 VDD"), (GROUND, "3 VSS")},
    "U4": {(PLUS, "2 VDD"), (GROUND, "3 VSS")},
    "U5": {(LOGIC, "20 VCC"), (GROUND, "10 GND"), (GROUND, "19 OE"), (LOGIC, "1 DIR")},
    "H1": {(PLUS, "VCC"), (GROUND, "GND")},
    "U6": {(LOGIC, "LV"), (PLUS, "HV"), (GROUND, "GND")},
    "B1": {(PLUS, "+5 V"), (GROUND, "0 V")},
    "B2": {(PLUS, "+5 V"), (GROUND, "0 V")},
}


def machines() -> list[HobbingMachine]:
    found = [load_hobbing_machine(bundled(f"{name}.toml")) for name in MACHINES]
    base = found[0]
    for board, decoder, output, wired in itertools.product(
        ("teensy32", "teensy41"),
        ("ls7184_x1", "ls7184_x2", "ls7184_x4", "interrupts"),
        ("open_collector", "direct"),
        (False, True),
    ):
        more = {
            "index": 9,
            "feed_step": 10,
            "feed_dir": 11,
            "enable": 12,
            "estop": 14,
            "healthy": 15,
            "alarm": 16,
            "reset": 17,
        }
        none = dict.fromkeys(more)
        found.append(
            base.model_copy(
                update={
                    "board": board,
                    "encoder": base.encoder.model_copy(update={"decoder": decoder}),
                    "driver": base.driver.model_copy(update={"output": output}),
                    "pins": base.pins.model_copy(update=more if wired else none),
                    "feed": Feed(counts_per_mm=200, counts_up="climb") if wired else None,
                }
            )
        )
    return found


@pytest.mark.parametrize("machine", machines(), ids=lambda machine: machine.name[:20])
def test_every_net_is_sound(machine: HobbingMachine) -> None:
    found = netlist(machine)
    ends = [end for net in found.nets.values() for end in net]
    assert len(ends) == len(set(ends)), "a pin stands in two nets"
    assert {part for part, _ in ends} == set(found.parts)
    assert all(len(net) > 1 for name, net in found.nets.items() if name != "supply")
    # every pin of the machine file, and no other one of the board
    board = [pin for part, pin in ends if part == "U1"]
    supplies = {"Vin", "GND"} | ({"3.3V"} if not machine.hardware.five_volt_tolerant else set())
    assert sorted(board) == sorted({str(number) for _, number in machine.pins.used()} | supplies)
    # every chip has its supply, and 100 nF beside it
    for chip, wanted in POWER.items():
        if chip in found.parts:
            assert wanted <= {(name, pin) for name, net in found.nets.items() for part, pin in net if part == chip}
            if chip in ("U2", "U3", "U4", "U5"):  # U6 is a board of its own
                assert f"CB{chip[1:]}" in found.parts
    # no pin of a board that takes 3.3 V meets one that has 5 V
    if not machine.hardware.five_volt_tolerant:
        for net in found.nets.values():
            parts = {part for part, _ in net}
            five_volts = {"B1", "B2", "U3", "U4", "H1"}
            assert not ("U1" in parts and parts & five_volts) or net in (found.nets[PLUS], found.nets[GROUND])


def test_74lvc245_passes_from_the_side_of_5_volts_to_that_of_the_board() -> None:
    """Data sheet: A1 ... A8 are the pins 2 to 9, B1 ... B8 the pins 18 to 11; with DIR high data go from A to B."""
    found = netlist(load_hobbing_machine(bundled("hobbing_helical.toml")))
    passed = {}
    for net in found.nets.values():
        pins = [pin for part, pin in net if part == "U5"]
        if len(net) == 2 and len(pins) == 1:
            number, name = pins[0].split()
            passed.setdefault(name[1], {})[name[0]] = (int(number), next(end for end in net if end[0] != "U5"))
    assert len(passed) == 5
    for channel, ends in passed.items():
        assert (ends["A"][0], ends["B"][0]) == (int(channel) + 1, 19 - int(channel))
        assert (ends["A"][1][0] in ("B1", "U3", "U4"), ends["B"][1][0]) == (True, "U1")


# --- the diagram, read back from its lines --------------------------------------------------------------------------
SVG = "{http://www.w3.org/2000/svg}"
Point = tuple[float, float]


def _points(text: str) -> list[Point]:
    return [(float(x), float(y)) for x, y in re.findall(r"(-?[\d.]+),(-?[\d.]+)", text)]


class Diagram:
    """Straight lines, boxes and words of a wiring diagram, in its own pixels."""

    def __init__(self, svg: str) -> None:
        root = ElementTree.fromstring(svg)
        self.wires: list[tuple[Point, Point]] = []
        self.boxes: list[tuple[float, float, float, float]] = []
        self.grounds: list[Point] = []
        for path in root.iter(f"{SVG}path"):
            lines = [_points(line) for line in path.attrib["d"].split("M") if line.strip()]
            first = lines[0]
            if len(first) < 2:  # an arc
                continue
            xs, ys = zip(*first, strict=True)
            if len(first) == 5 and first[0] == first[-1]:
                self.boxes.append((min(xs), min(ys), max(xs), max(ys)))
            elif len(lines) == 3:  # three bars
                self.grounds.append(first[0])
            elif max(xs) - min(xs) < 0.5 or max(ys) - min(ys) < 0.5:
                self.wires.append((first[0], first[-1]))
        self.words = [
            (" ".join("".join(text.itertext()).split()), float(text.attrib["x"]), float(text.attrib["y"]))
            for text in root.iter(f"{SVG}text")
        ]

    def nets(self) -> list[set[Point]]:
        """Ends of wires that are joined: the same point, or one on the way of another wire."""
        found: list[set[Point]] = []
        for wire in self.wires:
            joined = [
                net
                for net in found
                if any(self._meets(wire, point) for point in net)
                or any(self._meets(other, point) for point in wire for other in self.wires if set(other) <= net)
            ]
            found = [net for net in found if net not in joined] + [set(wire).union(*joined)]
        return found

    @staticmethod
    def _meets(wire: tuple[Point, Point], point: Point) -> bool:
        (x1, y1), (x2, y2) = wire
        inside = (
            min(x1, x2) - 0.5 <= point[0] <= max(x1, x2) + 0.5 and min(y1, y2) - 0.5 <= point[1] <= max(y1, y2) + 0.5
        )
        return inside and (abs(x1 - x2) < 0.5 or abs(y1 - y2) < 0.5)

    def box_of(self, word: str) -> tuple[float, float, float, float]:
        (_, x, y) = next(entry for entry in self.words if entry[0] == word)
        return min(
            (box for box in self.boxes if box[0] < x < box[2] and box[1] < y < box[3]),
            key=lambda box: box[2] - box[0],
        )

    def on_side(self, box: tuple[float, float, float, float], side: str) -> list[Point]:
        left, top, right, bottom = box
        edge = {"left": left, "right": right, "top": top, "bottom": bottom}[side]
        axis, other = (0, 1) if side in ("left", "right") else (1, 0)
        low, high = (top, bottom) if axis == 0 else (left, right)
        ends = {point for wire in self.wires for point in wire} | set(self.grounds)
        return sorted(p for p in ends if abs(p[axis] - edge) < 0.5 and low < p[other] < high)


@pytest.mark.parametrize("name", MACHINES)
def test_every_pin_of_the_board_has_one_wire_of_its_own_in_the_diagram(name: str) -> None:
    machine = load_hobbing_machine(bundled(f"{name}.toml"))
    diagram = Diagram(wiring_svg(machine))
    nets, board = diagram.nets(), diagram.box_of(machine.hardware.title)
    ends = [*diagram.on_side(board, "left"), *diagram.on_side(board, "right")]
    labels = {int(word.removeprefix("pin ")): y for word, _, y in diagram.words if word.startswith("pin ")}
    straight = [pin for _, pin in machine.pins.used()]
    meeting: dict[int, Point] = {}
    for pin in straight:
        near = [end for end in ends if abs(end[1] - labels[pin]) < 8]
        side = [end for end in near if _is_left(diagram, board, pin) == (abs(end[0] - board[0]) < 1)]
        if side:  # what begins with a resistor or a capacitor has no straight wire at the board
            (meeting[pin],) = side
    resistors = {machine.pins.step_out, machine.pins.dir_out} | {machine.pins.healthy} - {None}
    assert set(meeting) == set(straight) - resistors
    of_pin = {pin: next(k for k, net in enumerate(nets) if end in net) for pin, end in meeting.items()}
    assert len(set(of_pin.values())) == len(of_pin), "two pins of the board are joined"


def _is_left(diagram: Diagram, board: tuple[float, float, float, float], pin: int) -> bool:
    (x,) = (x for word, x, _ in diagram.words if word == f"pin {pin}")
    return x < (board[0] + board[2]) / 2


@pytest.mark.parametrize("name", MACHINES)
def test_every_chip_of_the_diagram_is_powered(name: str) -> None:
    """On top of its box a wire that ends under a supply, below it one that ends in a ground: three bars."""
    machine = load_hobbing_machine(bundled(f"{name}.toml"))
    diagram = Diagram(wiring_svg(machine))
    chips = ["display 4 x 20"] + ["LS7184N"] * machine.encoder.has_ls7184
    chips += ["U5 74LVC245", "U6 BSS138"] * (not machine.hardware.five_volt_tolerant)
    supplies = [(x, y) for word, x, y in diagram.words if word.startswith("+")]
    for chip in chips:
        box = diagram.box_of(chip)
        tops, bottoms = diagram.on_side(box, "top"), diagram.on_side(box, "bottom")
        assert tops, chip
        assert set(bottoms) & set(diagram.grounds), chip
        for x, y in tops:
            assert any(abs(x - sx) < 12 and 0 < y - sy < 60 for sx, sy in supplies), chip


def test_closed_loop_drive_has_the_encoder_of_its_motor_and_both_ends_of_its_alarm() -> None:
    base = load_hobbing_machine(bundled("hobbing_default.toml"))
    driver, pins = base.driver.model_copy(update={"name": "cl57t"}), base.pins.model_copy(update={"alarm": 24})
    found = netlist(base.model_copy(update={"driver": driver, "pins": pins}))
    assert found.nets["motor encoder"] == [("A2", "encoder"), ("M1", "encoder")]
    assert found.parts["M1"].what.startswith("closed-loop step motor, 200 full steps a turn, with the encoder")
    assert found.nets["alarm"] == [("A2", "ALARM +"), ("U1", "24")]
    assert ("A2", "ALARM -") in found.nets[GROUND]
    assert "motor encoder" not in netlist(base).nets
