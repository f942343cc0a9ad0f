"""The set-up sheet: what it says is what the program and its files say, on paper and on a telephone."""

from __future__ import annotations

import json
import re
import subprocess
from dataclasses import replace
from html import escape, unescape
from pathlib import Path

import pytest

from gearmath.machine.control.executor import execute
from gearmath.machine.control.state import Setup
from gearmath.machine.judging.timing import timing
from gearmath.machine.planning.cut_plan import PLUNGE_FEED, CuttingJob, cutting_plan
from gearmath.machine.planning.setup_facts import R_D, SetupFacts
from gearmath.machine.writing.cutting import program_of
from gearmath.setup_sheet import setup_sheet
from gearmath.specs.bevel_set import design_sha256, settings_sha256
from gearmath.specs.toml import bundled

DOCS = Path(__file__).parents[3] / "docs"
ODD = "<b>Kegelräder</b> & 12×36"

#: In a frame of 420 px: width of the page, height and place of every word of a drawing, and words over each other.
MEASURE = """
addEventListener('load', () => {
  const frame = document.querySelector('iframe'), page = frame.contentDocument;
  const over = [], sizes = [], ends = [];
  for (const drawing of page.querySelectorAll('svg')) {
    const words = [...drawing.querySelectorAll('text')], boxes = words.map(word => word.getBoundingClientRect());
    const frame_of = drawing.getBoundingClientRect();
    words.forEach((word, k) => {
      sizes.push(parseFloat(frame.contentWindow.getComputedStyle(word).fontSize) * word.getScreenCTM().a);
      ends.push(boxes[k].left - frame_of.left, frame_of.right - boxes[k].right, frame_of.bottom - boxes[k].bottom);
      for (let j = 0; j < k; j++) {
        const a = boxes[j], b = boxes[k];
        const wide = Math.min(a.right, b.right) - Math.max(a.left, b.left);
        if (wide > 3 && Math.min(a.bottom, b.bottom) - Math.max(a.top, b.top) > 3)
          over.push(words[j].textContent + ' | ' + word.textContent);
      }
    });
  }
  document.title = JSON.stringify({width: page.documentElement.scrollWidth, over: over,
    smallest: Math.min(...sizes), inside: Math.min(...ends)});
});
"""


@pytest.fixture(scope="module")
def facts(gear_set, vertical):
    """The NASA pinion, three spaces that are not neighbours, with a title that is no plain text."""
    odd = gear_set.model_copy(update={"title": ODD})
    return SetupFacts.of(cutting_plan(odd, "pinion", vertical, CuttingJob((0, 1, 5), tolerance=1e-3)), PLUNGE_FEED)


@pytest.fixture(scope="module")
def text(facts):
    return program_of(facts.plan, "PINION")


@pytest.fixture(scope="module")
def sheet(facts, text):
    plan = facts.plan
    return setup_sheet(facts, "PINION.MPF", timing(execute(text, "PINION.MPF", Setup.of(plan.machine)), plan.machine))


def cells(sheet):
    """The cells of every row of the tables, by the first of them."""
    rows = re.findall(r"<tr>(.*?)</tr>", sheet, re.DOTALL)
    found = [[unescape(cell) for cell in re.findall(r"<t[dh][^>]*>(.*?)</t[dh]>", row)] for row in rows]
    return {row[0]: row[1:] for row in found}


def test_sentence_for_r_d_is_the_one_of_the_page_of_machine_files(sheet):
    page = (DOCS / "machine_files.md").read_text("utf-8").replace("`", "")
    assert R_D.removeprefix("R_d is the ") in page
    assert R_D in sheet


def test_text_of_the_files_is_escaped_on_the_page_and_plain_in_the_program(sheet, text):
    assert escape(ODD) in sheet
    assert ODD not in sheet
    assert "; set: <b>Kegelr?der</b> & 12?36\n" in text


def test_head_of_the_program_says_in_short_what_the_sheet_says(text):
    head = [line for line in text.splitlines() if line.startswith("; ")]
    assert max(map(len, head)) < 250
    words = "\n".join(head)
    for part in (
        "tool PINION_CONCAVE, concave: point radius 75.3268 mm, pressure angle 18.0457 deg, edge radius not stated",
        "cutter turns M3: clockwise, seen along the spindle towards the work",
        "blank: outside diameter 69.595 mm, face angle 22.3167 deg",
        "chip, concave: plunge 1.667 mm, chip 0.516 mm a turn, blades not stated",
        "note: concave, convex: no blade_count",
        "unconfirmed: no program of this version has run on metal",
    ):
        assert part in words


def test_sections_of_the_sheet_are_those_of_the_program(sheet, text):
    """Spaces 0 and 1 follow each other, space 5 stands alone; the program announces the same numbers."""
    found = cells(sheet)
    assert found["1 to 2"][:2] == ["PINION_CONCAVE", "space 0 concave to space 1 concave"]
    assert found["3"][:2] == ["PINION_CONCAVE", "space 5 concave"]
    assert found["6"][:2] == ["PINION_CONVEX", "space 5 convex"]
    assert 'MSG("section 3 of 6: space 5 concave")' in text
    assert 'MSG("section 6 of 6: space 5 convex")' in text


def test_offset_and_home_of_the_sheet_are_those_of_the_program(sheet, text):
    found = cells(sheet)
    assert found["G54 in machine coordinates"][0] == "X0 Y0 Z0 A0 B0"
    assert 'MSG("G54 with all frames must be X0 Y0 Z0 A0 B0")' in text
    assert found["home of Z"][0] == "900"
    assert "G0 SUPA Z900.00000" in text
    assert found["gauge line above the B axis there"][0] == "550"


def test_what_the_files_do_not_say_is_said_before_the_first_drawing(sheet):
    before = unescape(sheet[: sheet.index("<svg")])
    for words in ("no blade_count", "no blade_edge_radius", "no blade_point_width", "run on metal"):
        assert words in before


def test_blades_that_are_stated_divide_the_chip_and_leave_the_digest_alone(facts):
    member = facts.plan.member
    flanks = {flank: member.flank(flank).model_copy(update={"blade_count": 1}) for flank in ("concave", "convex")}
    fly = member.model_copy(update=flanks)
    known = SetupFacts.of(replace(facts.plan, member=fly), PLUNGE_FEED)
    assert not any("blade_count" in words for words in known.not_stated)
    for one, other in zip(known.chips, facts.chips, strict=True):
        assert (one.blades, other.blades) == (1, None)  # a fly cutter has one blade
        assert one.plunge == other.plunge
    assert settings_sha256(fly) == settings_sha256(member)
    assert design_sha256(fly) == design_sha256(member)


def test_sheet_is_written_beside_the_program(command, tmp_path):
    target, page = tmp_path / "GEAR.MPF", tmp_path / "sheet.html"
    status, out, err = command(
        "nc", "cut", "nasa_tp3096_12x36.toml", "--member", "gear", "--spaces", "0", "-o", target, "--sheet", page
    )
    assert (status, err) == (0, "")
    assert f"{page}: set-up sheet, prints on A4" in out
    html = page.read_text("utf-8")
    assert "GEAR.MPF" in html
    assert "<script" not in html


def test_probing_has_a_sheet_with_the_length_of_its_probe_in_place_of_a_cutter(command, tmp_path):
    """The bundled probe: 200 mm long; at the home of Z, 900, its tip is 900 - 350 - 200 = 350 mm above the B axis."""
    page = tmp_path / "probe.html"
    status, out, err = command(
        "nc",
        "probe",
        "nasa_tp3096_12x36.toml",
        "--member",
        "pinion",
        "--topography",
        "none",
        "-o",
        tmp_path / "PROBE.MPF",
        "--sheet",
        page,
    )
    assert (status, err) == (0, "")
    assert f"{page}: set-up sheet, prints on A4" in out
    found = cells(page.read_text("utf-8"))
    assert found["length of the probe"][0] == "200"
    assert found["center of the tip above the B axis there"][0] == "350"
    assert found["touches"][0] == re.search(r"(\d+) touches", out)[1]


def test_blade_count_of_a_hobbed_flank_is_refused_by_its_key(refused, tmp_path):
    text = bundled("crown_gear_hobbed_14x39.toml").read_text("utf-8")
    wrong = tmp_path / "wrong.toml"
    wrong.write_text(text.replace("blade_profile_height", "blade_count = 4\nblade_profile_height", 1), "utf-8")
    refused(
        r"pinion.*concave\.blade_count = 4: belongs to face_milling",
        "nc",
        "cut",
        wrong,
        "--member",
        "pinion",
        "-o",
        tmp_path / "PINION.MPF",
    )


def test_sheet_fits_a_telephone_and_no_word_of_a_drawing_is_over_another(browser, sheet, tmp_path):
    frame = f'<iframe style="width: 420px; height: 4000px; border: 0" srcdoc="{escape(sheet)}"></iframe>'
    (tmp_path / "frame.html").write_text(f"<!doctype html><body>{frame}<script>{MEASURE}</script>", "utf-8")
    options = ["--window-size=800,4000", "--virtual-time-budget=5000", "--dump-dom", f"file://{tmp_path}/frame.html"]
    dom = subprocess.run([*browser, *options], check=True, capture_output=True, timeout=120, text=True).stdout
    found = json.loads(unescape(re.search(r"<title>(.*?)</title>", dom)[1]))
    assert found["width"] <= 420
    assert found["over"] == []
    assert found["smallest"] >= 12.0
    assert found["inside"] >= 0.0


def test_sheet_prints_on_three_pages_of_a4_at_most(browser, sheet, tmp_path):
    (tmp_path / "sheet.html").write_text(sheet, "utf-8")
    options = ["--no-pdf-header-footer", f"--print-to-pdf={tmp_path / 'sheet.pdf'}", f"file://{tmp_path}/sheet.html"]
    subprocess.run([*browser, *options], check=True, capture_output=True, timeout=120)
    boxes = re.findall(rb"/MediaBox \[([^\]]*)\]", (tmp_path / "sheet.pdf").read_bytes())
    assert 2 <= len(boxes) <= 3
    for box in boxes:
        assert [float(number) for number in box.split()] == pytest.approx([0, 0, 595.3, 841.9], abs=1.0)
