"""Parts and nets of every machine: each pin once, every chip powered, and all that the machine file wires."""

from __future__ import annotations

import itertools

import pytest

from gearmath.export.netlist import GROUND, LOGIC, PLUS, netlist
from gearmath.specs.drive import Feed
from gearmath.specs.hobbing import HobbingMachine, load_hobbing_machine
from gearmath.specs.toml import bundled

MACHINES = ("hobbing_plewes", "hobbing_minimum", "hobbing_metric", "hobbing_helical", "lathe_example")
#: Supply pins by the data sheets: LM7805 1 in, 2 ground, 3 out; LS7184N 2, 3; 74LVC245 20, 10.
POWER = {
    "U1": {(PLUS, "Vin"), (GROUND, "GND")}, "U2": {("supply", "1 IN"), (GROUND, "2 GND"), (PLUS, "3 OUT")},
    "U3": {(PLUS, "2 VDD"), (GROUND, "3 VSS")}, "U4": {(PLUS, "2 VDD"), (GROUND, "3 VSS")},
    "U5": {(LOGIC, "20 VCC"), (GROUND, "10 GND"), (GROUND, "19 OE"), (LOGIC, "1 DIR")},
    "H1": {(PLUS, "VCC"), (GROUND, "GND")}, "A1": {(LOGIC, "LV"), (PLUS, "HV"), (GROUND, "GND")},
    "B1": {(PLUS, "+5 V"), (GROUND, "0 V")}, "B2": {(PLUS, "+5 V"), (GROUND, "0 V")},
}  # fmt: skip


def machines() -> list[HobbingMachine]:
    found = [load_hobbing_machine(bundled(f"{name}.toml")) for name in MACHINES]
    base = found[0]
    for board, decoder, output, wired in itertools.product(
        ("teensy32", "teensy41"), ("ls7184_x1", "ls7184_x2", "ls7184_x4", "interrupts"), ("open_collector", "direct"),
        (False, True),
    ):  # fmt: skip
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
            if chip[0] == "U" and chip != "U1":
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
