"""The set-up sheet of a calibration program: what it says of ring and spheres is what the program does with them."""

from __future__ import annotations

import json
import math
import re
import subprocess
from html import escape, unescape
from xml.etree import ElementTree

import numpy as np
import pytest

from gearmath.machine.control.executor import run_program
from gearmath.machine.control.state import Setup
from gearmath.machine.measuring.artefacts import Artefacts
from gearmath.machine.writing.axis_cycle import axis_program
from gearmath.machine.writing.calibrating import calibration_program
from gearmath.setup_sheet import calibration_sheet
from gearmath.setup_sheet.artefact_drawing import plan_drawing, section_drawing, work_sphere_drawing
from gearmath.specs.calibration import load_calibration
from gearmath.specs.toml import bundled
from tests.gearmath.setup_sheet.test_drawings import parsed
from tests.gearmath.setup_sheet.test_setup_sheet import MEASURE, cells

PROBE = load_calibration(bundled("probe.toml"))
CYCLES = {"tip": calibration_program, "axes": axis_program}


def changed(**keys):
    return PROBE.model_copy(update=keys)


RING = PROBE.ring
#: Which of the artefacts a calibration file has, and where, beside the bundled one.
OTHERS = {
    "bundled": PROBE,
    "ring alone": changed(sphere=None),
    "ring without face": changed(sphere=None, ring=RING.model_copy(update={"face": None})),
    "sphere alone": changed(ring=None),
    "side by side": changed(sphere=PROBE.sphere.model_copy(update={"center": (-190.0, -150.0, 380.0)})),
    "about the axis": changed(sphere=PROBE.sphere.model_copy(update={"center": (100.0, 50.0, 300.0)})),
}


@pytest.mark.parametrize("cycle", CYCLES)
def test_sheet_is_written_beside_the_program_and_has_its_touches(command, tmp_path, cycle):
    page = tmp_path / "sheet.html"
    options = ("nc", "calibrate", "--cycle", cycle, "-o", tmp_path / "TOUCH.MPF", "--sheet", page)
    status, out, err = command(*options)
    assert (status, err) == (0, "")
    assert f"{page}: set-up sheet, prints on A4" in out
    html = page.read_text("utf-8")
    assert cells(html)["touches"][0] == re.search(r"(\d+) touches", out)[1]
    assert cells(html)["length of the probe"][0] == "200"
    assert "gearmath calibrate TOUCH_T" in html
    assert "<script" not in html
    before = unescape(html[: html.index("<svg")])
    for words in ("run on metal", "deletes the result file", "within 0.5 mm"):
        assert words in before


@pytest.mark.parametrize("cycle", CYCLES)
def test_sections_are_those_that_the_program_announces(vertical, cycle):
    """Also their touches: every touch of a section is a line that the program writes there."""
    text = CYCLES[cycle](vertical, PROBE, "TOUCH")
    found = cells(calibration_sheet(vertical, PROBE, cycle == "axes", "TOUCH.MPF"))
    parts = re.split(r'MSG\("section (\d+) of (\d+): ([^"]*)"\)', text)
    assert len(parts) > 4
    for number, last, what, body in zip(*(iter(parts[1:]),) * 4, strict=True):
        assert found[number][:2] == [what, str(body.count("R102<<"))]
        assert (str(int(last) + 1) in found) is False


def test_ring_and_sphere_stand_where_the_calibration_file_has_them(vertical):
    """By hand for the bundled probe: 400 - 350 - 200 = -150 mm; over the ring its center, 400, and 30 of the stylus."""
    found = cells(calibration_sheet(vertical, PROBE, False, "TIP.MPF"))
    assert found["center of the ring, X Y Z"] == ["-250, -150, 400"]
    assert found["center of the sphere, X Y Z"] == ["-250, 150, 400"]
    assert found["touches in the bore: Z, and above the B axis"] == ["400, -150"]
    assert found["seat of the ring: Z, and above the B axis"] == ["385, -165"]
    assert found["Z of the ways over ring and sphere"] == ["430"]
    assert "Z430.00000" in calibration_program(vertical, PROBE, "TIP")


def test_work_sphere_stands_where_a_hand_calculation_has_it(vertical):
    """At B = 0 the axis is level, toe towards X+: 60 mm behind the apex is X -60, 80 mm up is Z 350 + 200 + 80.

    B lowers the back: at 90 degrees the axis leads down, and what was up lies at X -80.
    """
    found = cells(calibration_sheet(vertical, PROBE, True, "AXES.MPF"))
    assert found["2"][2:] == ["-60.000", "0.000", "630.000"]
    assert found["8"][2:] == ["-80.000", "0.000", "490.000"]
    half = math.sqrt(0.5)
    assert [float(value) for value in found["5"][2:]] == pytest.approx(
        [-(60 + 80) * half, 0.0, 550 + (80 - 60) * half], abs=5.1e-4
    )
    assert f"Z{float(found['Z from which A and B turn'][0]):.5f}" in axis_program(vertical, PROBE, "AXES")


def test_program_does_not_say_that_it_looks_for_a_work(vertical):
    """Under a work the tip cannot be told to be: the program has none, and no check of it."""
    html = unescape(calibration_sheet(vertical, PROBE, False, "TIP.MPF"))
    assert "under the work" not in html
    assert "under the work" not in calibration_program(vertical, PROBE, "TIP")


def test_places_on_the_table_are_to_scale():
    dimensions, places, words = parsed(plan_drawing(PROBE))
    for name, x, y in (("ring", -250.0, -150.0), ("sphere", -250.0, 150.0)):
        np.testing.assert_allclose(places[name] - places["zero"], (x, -y), atol=0.05)  # pixels count downwards
        assert np.ptp(dimensions[f"{name} X"][:, 0]) == pytest.approx(250.0, abs=0.05)
        assert np.ptp(dimensions[f"{name} Y"][:, 1]) == pytest.approx(150.0, abs=0.05)
    assert {"X -250, Y -150", "X -250, Y 150"} <= set(words)
    dimensions, _, words = parsed(section_drawing(PROBE))
    assert np.ptp(dimensions["bore"][:, 0]) == pytest.approx(30.0, abs=0.05)
    assert {"Z 385 seat", "Z 410 face", "Z 400 in the bore"} <= set(words)


def test_work_sphere_is_drawn_at_every_b(vertical):
    _, places, _ = parsed(work_sphere_drawing(vertical, PROBE, PROBE.work_sphere))
    for b, x, height in ((0, -60.0, 80.0), (90, -80.0, -60.0)):
        np.testing.assert_allclose(places[f"sphere at B {b}"] - places["B axis"], (x, -height), atol=0.05)


def test_machine_that_swivels_less_has_no_position_beyond_its_travel(vertical):
    less = vertical.axes.B.model_copy(update={"travel": (-10.0, 30.0)})
    machine = vertical.model_copy(update={"axes": vertical.axes.model_copy(update={"B": less})})
    _, places, _ = parsed(work_sphere_drawing(machine, PROBE, PROBE.work_sphere))
    assert sorted(places) == ["B axis", "sphere at B 0", "sphere at B 30"]


@pytest.mark.parametrize("name", OTHERS)
def test_what_the_calibration_file_lacks_is_not_on_the_sheet(vertical, name):
    probe = OTHERS[name]
    html = calibration_sheet(vertical, probe, False, "TIP.MPF")
    found = cells(html)
    assert ("diameter of the bore" in found) is (probe.ring is not None)
    assert ("diameter of the sphere" in found) is (probe.sphere is not None)
    assert ("The sphere is touched" in html) is (probe.sphere is not None)
    assert ("The ring is touched" in html) is (probe.ring is not None)
    assert ("width of the wall" in found) is (probe.ring is not None and probe.ring.face is not None)
    for svg in (plan_drawing(probe), section_drawing(probe)):
        width, height = (float(size) for size in re.search(r'viewBox="0 0 ([\d.]+) ([\d.]+)"', svg).groups())
        for text in ElementTree.fromstring(svg).iter("{http://www.w3.org/2000/svg}text"):
            assert 0 <= float(text.attrib["x"]) <= width
            assert float(text.attrib["font-size"]) <= float(text.attrib["y"]) <= height


def test_sheets_fit_a_telephone_and_no_word_of_a_drawing_is_over_another(browser, vertical, tmp_path):
    pages = [calibration_sheet(vertical, probe, False, "TIP.MPF") for probe in OTHERS.values()]
    for number, sheet in enumerate([*pages, calibration_sheet(vertical, PROBE, True, "AXES.MPF")]):
        frame = f'<iframe style="width: 420px; height: 4000px; border: 0" srcdoc="{escape(sheet)}"></iframe>'
        (tmp_path / "frame.html").write_text(f"<!doctype html><body>{frame}<script>{MEASURE}</script>", "utf-8")
        options = ["--window-size=800,4000", "--virtual-time-budget=5000", "--dump-dom"]
        shown = subprocess.run(
            [*browser, *options, f"file://{tmp_path}/frame.html"],
            check=True,
            capture_output=True,
            timeout=120,
            text=True,
        ).stdout
        found = json.loads(unescape(re.search(r"<title>(.*?)</title>", shown)[1]))
        assert (number, found["over"]) == (number, [])
        assert found["width"] <= 420
        assert found["smallest"] >= 12.0
        assert found["inside"] >= 0.0


@pytest.mark.parametrize("way", [(1.0, 0.0, 0.0), (0.0, -1.0, 0.0), (0.0, 0.0, -1.0)])
def test_ring_and_sphere_are_found_within_the_distance_of_the_sheet_and_not_beyond(vertical, way):
    """The sheet says within 0.5 mm: the program runs with everything 0.45 mm aside, and stops with 0.6 mm."""
    text = calibration_program(vertical, PROBE, "TIP")
    for distance, alarm in ((0.45, None), (0.6, 65001)):
        there = {}
        for name in ("ring", "sphere"):
            one = getattr(PROBE, name)
            moved = tuple(at + distance * share for at, share in zip(one.center, way, strict=True))
            there[name] = one.model_copy(update={"center": moved})
        face = RING.face.model_copy(update={"seat": RING.face.seat + distance * way[2]})
        there["ring"] = there["ring"].model_copy(update={"face": face})
        probe = Artefacts(vertical, changed(**there))
        run = run_program(text, "TIP", probe, setup=Setup.of(vertical, PROBE.length))
        assert (run.alarm and run.alarm[0]) == alarm, (distance, run.messages[-2:])
