"""``gearmath blank`` on the published sample: table, JSON and the part of a set, and one line on bad input."""

from __future__ import annotations

import json
import math
import re

import pytest

from gearmath.specs.bevel_set import BevelSet, Blank
from gearmath.specs.toml import bundled, parse

SAMPLE = "blank_iso23509_sample1.toml"

#: Name, symbol, unit and printed values of ISO 23509:2016, annex F.2, of pinion and wheel.
ANNEX = [
    ("teeth", "z", "", 14, 39),
    ("pitch angle", "δ", "degree", 19.747, 70.253),
    ("face angle", "δ_a", "degree", 26.240, 72.387),
    ("root angle", "δ_f", "degree", 17.613, 63.760),
    ("addendum angle", "θ_a", "degree", 6.493, 2.134),
    ("mean addendum", "h_am", "mm", 4.836, 1.591),
    ("mean dedendum", "h_fm", "mm", 2.394, 5.639),
    ("outer whole depth", "h_e", "mm", 9.149, 9.149),
    ("outer pitch diameter", "d_e", "mm", 63.5, 176.893),
    ("outer tip diameter", "d_ae", "mm", 75.324, 178.288),
    ("crossing point to crown", "t_xo", "mm", 86.324, 29.808),
    ("mean normal thickness", "s_mn", "mm", 6.465, 3.511),
    ("mean chordal addendum", "h_amc", "mm", 4.955, 1.592),
]
#: The same of the pair; spiral angles and the last two with the digits of AGMA 929-B22, annex C.
PAIR = [
    ("shaft angle", "Σ", "degree", 90),
    ("mean cone distance", "R_m", "mm", 81.273),
    ("outer transverse module", "m_et", "mm", 4.536),
    ("mean normal module", "m_mn", "mm", 3.213),
    ("outer spiral angle", "β_e", "degree", 36.84579),
    ("inner spiral angle", "β_i", "degree", 33.94556),
    ("mean whole depth", "h_m", "mm", 7.230),
    ("normal pitch", "p_n", "mm", 10.09492),
    ("involute cone distance", "R_x", "mm", 148.586),
]


@pytest.fixture
def printed(command) -> list[list[str]]:
    """The lines of the table, cell by cell."""
    status, out, err = command("blank", SAMPLE)
    assert (status, err) == (0, "")
    assert out.startswith("ISO 23509 sample 1, 14 x 39, face milled\n")
    return [re.split(r"\s{2,}", line.strip()) for line in out.splitlines()]


@pytest.mark.parametrize(("name", "symbol", "unit", "pinion", "wheel"), ANNEX)
def test_table_has_the_printed_figures_of_both_members(printed, name, symbol, unit, pinion, wheel):
    (cells,) = [line for line in printed if line[0] == name and line[1] == symbol]
    assert [cell for cell in cells[2:] if not re.match(r"[-\d]", cell)] == [unit] * bool(unit)
    assert [float(cell) for cell in cells[-2:]] == pytest.approx([pinion, wheel], rel=2e-3)


@pytest.mark.parametrize(("name", "symbol", "unit", "value"), PAIR)
def test_table_has_the_printed_figures_of_the_pair(printed, name, symbol, unit, value):
    (cells,) = [line for line in printed if line[0] == name and len(line) == 4]
    assert cells[1:3] == [symbol, unit]
    assert float(cells[3]) == pytest.approx(value, rel=2e-4)


def test_table_is_no_wider_than_a_terminal_and_columns_stand_in_line(command):
    lines = command("blank", SAMPLE)[1].splitlines()
    assert max(map(len, lines)) <= 80
    ends = {len(line) for line in lines[lines.index("") :] if re.search(r"\d$", line)}
    assert len(ends) == 2  # one for each table: numbers to the right


def test_json_says_the_same_by_name_in_mm_and_degrees(command):
    status, out, _ = command("blank", SAMPLE, "--json")
    found = json.loads(out)
    assert (status, found["process"], found["units"]) == (0, "face_milling", "mm, degree")
    for name, _, _, pinion, wheel in ANNEX:
        key = name.replace(" ", "_")
        assert (found["pinion"][key], found["wheel"][key]) == pytest.approx((pinion, wheel), rel=2e-3)
    for name, _, _, value in PAIR:
        assert found["pair"][name.replace(" ", "_")] == pytest.approx(value, rel=2e-4)
    for member in ("pinion", "wheel"):
        assert [len(found[member][key]) for key in ("slot_width", "normal_thickness", "top_land")] == [3, 3, 3]
    # what the slots leave of the normal pitch at the mean point, at the pitch line
    thickness = [found[member]["normal_thickness"][1] for member in ("pinion", "wheel")]
    assert sum(thickness) == pytest.approx(10.09492 - found["pair"]["mean_normal_backlash"], abs=0.01)


def test_fragment_loads_as_the_blanks_of_a_set(command, tmp_path):
    target = tmp_path / "blanks.toml"
    status, out, _ = command("blank", SAMPLE, "--fragment", "-o", target)
    assert (status, out) == (0, f"{target}: written\n")
    text = target.read_text("utf-8")
    assert command("blank", SAMPLE, "--fragment")[1] == text
    sections = {name: text[text.index(f"[{name}.blank]") :].split("\n\n")[0] for name in ("pinion", "gear")}
    for name, angles in (("pinion", (19.747, 26.240, 17.613)), ("gear", (70.253, 72.387, 63.760))):
        made = parse(sections[name].split("\n", 1)[1], Blank, "blank")
        assert (made.pitch_angle, made.face_angle, made.root_angle) == pytest.approx(angles, abs=5e-4)
        assert made.mean_cone_distance == pytest.approx(81.273, abs=5e-4)
    # in the place of the blanks of a set of those teeth
    whole = bundled("crown_gear_universal_14x39.toml").read_text("utf-8")
    for name, section in sections.items():
        begin = whole.index(f"[{name}.blank]")
        whole = whole[:begin] + section + "\n" + whole[whole.index("\n[", begin) :]
    assert parse(whole, BevelSet, "set").member("gear").blank.pitch_angle == pytest.approx(70.253, abs=5e-4)


def test_sheet_in_inches_is_the_same_blank(command, tmp_path):
    """The pair of the sample was designed in inches: 25.4 mm of face, 4.5 in of cutter radius."""
    text = bundled(SAMPLE).read_text("utf-8")
    for old, new in (
        ("wheel_outer_pitch_diameter = 176.893", "wheel_outer_pitch_diameter = 6.964291338582677"),
        ("face_width = 25.4", "face_width = 1.0"),
        ("cutter_radius = 114.3", "cutter_radius = 4.5"),
        ("outer_normal = 0.127", "outer_normal = 0.005"),
        ("mean_spiral_angle = 35.0", 'mean_spiral_angle = "35 0 0"'),
        ("shaft_angle = 90.0", 'unit = "inch"\nshaft_angle = 90.0'),
    ):
        assert old in text
        text = text.replace(old, new, 1)
    own = tmp_path / "inch.toml"
    own.write_text(text, "utf-8")
    inch, mm = (json.loads(command("blank", path, "--json")[1]) for path in (own, SAMPLE))
    for owner in ("pair", "pinion", "wheel"):
        for key, value in mm[owner].items():
            assert inch[owner][key] == pytest.approx(value, rel=1e-9), key


def test_hobbed_pair_has_its_cutter_and_no_cone_distance_of_milling(command, tmp_path):
    text = bundled(SAMPLE).read_text("utf-8").replace('"face_milling"', '"face_hobbing"\nblade_groups = 13')
    begin, end = text.index("[taper]"), text.index("[data_type_2]")
    own = tmp_path / "hobbed.toml"
    own.write_text(text[:begin] + '[taper]\nkind = "uniform"\n\n' + text[end:], "utf-8")
    found = json.loads(command("blank", own, "--json")[1])
    pair = found["pair"]
    # ISO 23509: sin nu = z_0 m_mn / (2 r_c0), as the blades of one group follow each other by a tooth
    assert math.sin(math.radians(pair["cutter_lead_angle"])) == pytest.approx(
        13 * pair["mean_normal_module"] / (2 * 114.3), rel=1e-9
    )
    assert "involute_cone_distance" not in pair
    assert command("blank", own)[0] == 0


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (("blank", "absent.toml"), r"absent\.toml: cannot be read: there is no such file; bundled are"),
        (("blank", "nasa_tp3096_12x36.toml"), r"nasa_tp3096_12x36\.toml: .*(the key is missing|no such key)"),
        (("blank", SAMPLE, "--json", "--fragment"), "--json and --fragment: only one of them"),
        (("blank",), "Missing argument 'FILE.toml'"),
    ],
)
def test_bad_input_is_one_line(refused, arguments, sentence):
    refused(sentence, *arguments)


def test_impossible_blank_is_refused_by_file_key_value_and_limit(refused, tmp_path):
    own = tmp_path / "own.toml"
    own.write_text(bundled(SAMPLE).read_text("utf-8").replace("face_width = 25.4", "face_width = 60"), "utf-8")
    refused(r"own\.toml: face_width = 60: must be at most 0\.35 of the outer cone distance, 32\.89 mm", "blank", own)
    assert [path.name for path in tmp_path.iterdir()] == ["own.toml"]
