"""The wiring diagram: well-formed, the same everywhere, and complete."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from xml.etree import ElementTree

import pytest

from gearmath.export.netlist import netlist
from gearmath.export.wiring import wiring_svg
from gearmath.specs.hobbing import HobbingMachine, load_hobbing_machine
from gearmath.specs.toml import bundled

MACHINES = ("hobbing_plewes", "hobbing_metric", "hobbing_helical", "lathe_example")


def machine(name: str) -> HobbingMachine:
    return load_hobbing_machine(bundled(f"{name}.toml"))


def words(svg: str) -> list[str]:
    """The text of the drawing, a label an entry."""
    root = ElementTree.fromstring(svg)
    labels = (" ".join("".join(text.itertext()).split()) for text in root.iter("{http://www.w3.org/2000/svg}text"))
    return [label for label in labels if label]


@pytest.mark.parametrize("name", MACHINES)
def test_every_wired_pin_stands_in_the_drawing_once(name: str) -> None:
    given = machine(name)
    drawn = [int(word.removeprefix("pin ")) for word in words(wiring_svg(given)) if word.startswith("pin ")]
    assert sorted(drawn) == sorted(number for _, number in given.pins.used())


def test_text_stays_within_the_picture() -> None:
    root = ElementTree.fromstring(wiring_svg(machine("hobbing_helical")))
    left, top, width, height = (float(number) for number in root.attrib["viewBox"].split())
    for text in root.iter("{http://www.w3.org/2000/svg}text"):
        x, y = float(text.attrib["x"]), float(text.attrib["y"])
        assert left < x < left + width
        assert top < y < top + height


@pytest.mark.parametrize("decoder", ["ls7184_x1", "ls7184_x2", "ls7184_x4", "hardware"])
def test_mode_jumper_is_that_of_the_multiplier(decoder: str) -> None:
    base = machine("hobbing_plewes")
    drawn = words(wiring_svg(base.model_copy(update={"encoder": base.encoder.model_copy(update={"decoder": decoder})})))
    # LS7184N data sheet: MODE = 0 is x1, 1 is x2, floating x4
    modes = {"ls7184_x1": ["x1: to ground"], "ls7184_x2": ["x2: to +5 V"], "ls7184_x4": ["x4: left open"]}
    assert [word for word in drawn if re.match(r"x[124]:", word)] == modes.get(decoder, [])
    assert ("LS7184N" in drawn) == (decoder != "hardware")


def test_level_shifters_stand_where_five_volts_would_meet_a_pin_of_a_teensy_4() -> None:
    assert not {"74LVC245", "BSS138"} & set(words(wiring_svg(machine("hobbing_plewes"))))  # Teensy 3.2 takes 5 V
    drawn = words(wiring_svg(machine("hobbing_helical")))
    assert drawn.count("74LVC245") == 5  # index, two encoders of two signals
    assert drawn.count("BSS138") == 2


def test_transistors_stand_where_the_output_is_an_open_collector() -> None:
    base = machine("hobbing_plewes")
    drawn = words(wiring_svg(base))
    assert [word for word in drawn if "2N2222" in word] == ["T1 2N2222", "T2 2N2222"]
    assert {"C1 10 uF", "C2 10 uF", "U2 LM7805"} <= set(drawn)
    direct = base.model_copy(update={"driver": base.driver.model_copy(update={"output": "direct"})})
    assert not any("2N2222" in word for word in words(wiring_svg(direct)))


@pytest.mark.parametrize("name", ["</title><script>", "a & b < c", 'quote " and \\', "tab\tnew\nline\x00", "$x^2$"])
def test_name_of_the_machine_cannot_break_the_xml(name: str) -> None:
    svg = wiring_svg(machine("hobbing_plewes").model_copy(update={"name": name}))
    title = ElementTree.fromstring(svg).find("{http://www.w3.org/2000/svg}title")
    assert title is not None
    assert title.text == "Wiring: " + "".join(letter if letter.isprintable() else " " for letter in name)
    assert "<script" not in svg


def test_drawing_is_the_same_in_every_process_and_carries_no_date_and_no_path() -> None:
    program = (
        "import hashlib; from gearmath.export.wiring import wiring_svg; from gearmath.specs.toml import bundled;"
        "from gearmath.specs.hobbing import load_hobbing_machine;"
        "svg = wiring_svg(load_hobbing_machine(bundled('hobbing_helical.toml')));"
        "print(hashlib.sha256(svg.encode()).hexdigest())"
    )
    hashes = {
        subprocess.run(
            [sys.executable, "-c", program],
            env=os.environ | {"PYTHONHASHSEED": seed},
            capture_output=True,
            text=True,
            check=True,
        ).stdout
        for seed in ("1", "2")
    }
    assert len(hashes) == 1
    svg = wiring_svg(machine("hobbing_helical"))
    assert not re.search(r"20\d\d-|/home|/tmp|/work|\d\.\d{3}", svg)


@pytest.mark.parametrize("name", [*MACHINES, "hobbing_default", "hobbing_minimum"])
def test_every_part_of_the_list_stands_in_the_drawing_with_its_value(name: str) -> None:
    """By its name, resistors and capacitors with their value too: who solders by the drawing needs no other list."""
    given = machine(name)
    drawn = words(wiring_svg(given))
    for part in netlist(given).parts.values():
        labels = [word for word in drawn if re.search(rf"\b{part.name}\b", word)]
        if part.name == "U1":  # the board has its title beside
            assert given.hardware.title in drawn
        assert labels, part.name
        value = re.match(r"([\d.]+) (kOhm|uF|nF)", part.what)
        if value:
            assert any(f"{value[1]} {value[2].removesuffix('Ohm')}" in label for label in labels), part.name
