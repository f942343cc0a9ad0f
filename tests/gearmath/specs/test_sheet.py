"""Sheets as people hold them: inches, degrees with minutes and seconds, cradle by work, counted from a crossing point.

The sheet of NASA CR-191009 is written here as it is printed, and must be the bundled set in mm and decimals.
"""

from __future__ import annotations

import math
import re
import tomllib

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gearmath.bevel.flank import blank_grid, solve_flank
from gearmath.errors import InputError
from gearmath.specs.bevel_set import FLANKS, MEMBERS, SETTINGS, BevelSet, design_sha256, load_bevel_set
from gearmath.specs.set_text import save_corrected, set_text
from gearmath.specs.sheet import angle_text, degrees
from gearmath.specs.toml import bundled, parse

SET = bundled("nasa_tp3096_12x36.toml")
TEXT = SET.read_text("utf-8")

#: r, q, psi, s, m_cw, E_m, X_b, X_p of NASA CR-191009 in inch and degrees, angles in degrees, minutes and seconds.
SHEET = """
unit = "inch"  # as printed
title = "NASA 12 x 36"
source = "NASA CR-191009"
shaft_angle = 90

[pinion]
teeth = 12
hand = "left"
cutting = "fixed_setting"

[pinion.blank]
pitch_angle = "18 25 59.99988"
face_angle = "22°19'0.00012\\""
root_angle = "16:51:59.999904"
mean_cone_distance = 3.191
face_width = 1.0
mean_addendum = 0.17992380978039
mean_dedendum = 0.08727483327889
clearance = 0.03

[pinion.concave]
radial_distance = 2.94780202969
cradle_angle = "-63 56 31.3096686"
cutter_tilt = 0.0
cutter_swivel = 0.0
blank_offset = 0.154575896
sliding_base = 0.01167273202961
machine_center_to_crossing_point = 0.04023061648378
machine_root_angle = "16 51 59.999904"
ratio_of_roll_cradle_per_work = 0.30838512709  # cradle by work
work_rotation_offset = 0
blade_point_radius = 2.96562137806
blade_pressure_angle = "18 2 44.4111072"
blade_profile_height = 0.5

[pinion.convex]
radial_distance = 2.80104946
cradle_angle = "-53° 55' 33.58036812\\""
cutter_tilt = 0.0
cutter_swivel = 0.0
blank_offset = -0.17426159493
sliding_base = -0.01570932214457
machine_center_to_crossing_point = -0.05414291297142
machine_root_angle = "16 51 59.999904"
ratio_of_roll_cradle_per_work = 0.3220428536
work_rotation_offset = "30°"
blade_point_radius = 3.071306157
blade_pressure_angle = "24 20.24543124"
blade_profile_height = 0.5
"""


def gear_of_the_bundled_set() -> str:
    """The gear's tables in inch, by hand: division by 25.4 of what is in mm."""
    table = tomllib.loads(TEXT)["gear"]
    lines = ["[gear]", "teeth = 36", 'hand = "right"', 'cutting = "completing"']
    ones = ("angle", "tilt", "swivel", "ratio", "rotation")
    for name in ("blank", *FLANKS):
        lines.append(f"[gear.{name}]")
        for key, value in table[name].items():
            lines.append(f"{key} = {value if any(one in key for one in ones) else value / 25.4!r}")
    return "\n".join(lines) + "\n"


@pytest.fixture(scope="module")
def sheet() -> str:
    return SHEET + gear_of_the_bundled_set()


def written(text: str, tmp_path, name: str = "sheet.toml"):
    path = tmp_path / name
    path.write_text(text, "utf-8")
    return path


def test_printed_sheet_in_inches_is_the_bundled_set(sheet, gear_set):
    ours = parse(sheet, BevelSet, "sheet.toml")
    assert ours.unit == "mm"
    for member in MEMBERS:
        one, other = ours.member(member), gear_set.member(member)
        np.testing.assert_allclose(one.blank.vector, other.blank.vector, rtol=0, atol=2e-11)
        for flank in FLANKS:
            np.testing.assert_allclose(one.flank(flank).vector, other.flank(flank).vector, rtol=0, atol=2e-11)
    assert ours.pinion.concave.blade_profile_height == 12.7


def test_every_length_and_no_other_number_is_taken_as_inches():
    """Of every key of the models: what is 1 in the file is 25.4 mm, 1 degree, or 1."""
    lengths = {
        "mean_cone_distance",
        "face_width",
        "mean_addendum",
        "mean_dedendum",
        "clearance",
        "radial_distance",
        "blank_offset",
        "sliding_base",
        "machine_center_to_crossing_point",
        "blade_point_radius",
        "blade_profile_height",
        "blade_edge_radius",
        "blade_tip_height",
        "blade_point_width",
        "blade_spheric_radius",
        "blade_reference_height",
        "toprem_height",
        "pitch_apex_beyond_crossing_point",
    }
    from gearmath.specs.bevel_set import Blank, Flank, Member, Motion

    for model in (BevelSet, Member, Blank, Flank, Motion):
        for key in model.model_fields:
            one = model.plain({key: 1.0}, 25.4, ())[key]
            assert one == (25.4 if key in lengths else 1.0), key
    assert Motion.plain({"sliding_base": [1.0, 2.0], "cradle_angle": [1.0]}, 25.4, ()) == {
        "sliding_base": [25.4, 50.8],
        "cradle_angle": [1.0],
    }


@pytest.mark.parametrize(
    ("old", "new", "sentence"),
    [
        (
            "radial_distance = 2.94780202969",
            "radial_distance = 74.87",
            "pinion.concave.radial_distance = 74.87: must be at most 39.3701",
        ),
        ("face_width = 1.0", "face_width = 25.4", "pinion.blank.face_width = 25.4: must be at most 11.811"),
        (
            "face_width = 1.0",
            "face_width = 3.3",
            "pinion.blank: face_width 3.3 must be less than mean_cone_distance 3.191",
        ),
        ("face_width = 1.0", "face_width = nan", "pinion.blank.face_width = nan: must be a finite number"),
        ("face_width = 1.0", 'face_width = "1 in"', "pinion.blank.face_width = '1 in': must be a number"),
        (
            "radial_distance = 2.80104946",
            "motion.sliding_base = [0.1, 50.0]\nradial_distance = 2.80104946",
            "pinion.convex.motion.sliding_base #2 = 50.0: must be at most 39.3701",
        ),
        (
            "blade_point_radius = 2.96562137806",
            "blade_point_radius = 15.0",
            "pinion: concave: no real contact, .*, or blade_point_radius = 15 between -0.4516 and 6.834",
        ),
        (
            "blade_profile_height = 0.5",
            "blade_profile_height = 0.5\nblade_spheric_radius = 0.7",
            "pinion.concave.blade_spheric_radius = 0.7: must be at least 1.0 in size",
        ),
        ('unit = "inch"', 'unit = "cm"', "unit = 'cm': must be 'mm' or 'inch'"),
        ('unit = "inch"', "unit = 25.4", "unit = 25.4: must be 'mm' or 'inch'"),
        ('unit = "inch"', 'unit = ["mm"]', r"unit = \['mm'\]: must be 'mm' or 'inch'"),
        (
            'cradle_angle = "-63 56 31.3096686"',
            'cradle_angle = "-63 75 31.3"',
            "pinion.concave.cradle_angle = '-63 75 31.3': minutes must be below 60",
        ),
        (
            'cradle_angle = "-63 56 31.3096686"',
            'cradle_angle = "-63 56 60"',
            "pinion.concave.cradle_angle = '-63 56 60': seconds must be below 60",
        ),
        (
            'cradle_angle = "-63 56 31.3096686"',
            'cradle_angle = "-63.5 56"',
            "pinion.concave.cradle_angle = '-63.5 56': only the last of degrees, minutes and seconds may have decimals",
        ),
        (
            'cradle_angle = "-63 56 31.3096686"',
            'cradle_angle = "N63"',
            "pinion.concave.cradle_angle = 'N63': must be a number, or degrees, minutes and seconds such as "
            "'63 56 31.3'",
        ),
        (
            'cradle_angle = "-63 56 31.3096686"',
            'cradle_angle = "200 0 0"',
            "pinion.concave.cradle_angle = '200 0 0': must be at most 180",
        ),
        (
            "ratio_of_roll_cradle_per_work = 0.30838512709",
            "ratio_of_roll_cradle_per_work = 30.8",
            "pinion.concave.ratio_of_roll_cradle_per_work = 30.8: must be at least 0.02 and less than 10",
        ),
        (
            "ratio_of_roll_cradle_per_work = 0.30838512709",
            "ratio_of_roll_cradle_per_work = 0",
            "pinion.concave.ratio_of_roll_cradle_per_work = 0: must be at least 0.02 and less than 10",
        ),
        (
            "ratio_of_roll_cradle_per_work = 0.30838512709",
            "ratio_of_roll_cradle_per_work = nan",
            "pinion.concave.ratio_of_roll_cradle_per_work = nan: must be at least 0.02 and less than 10",
        ),
        (
            "ratio_of_roll_cradle_per_work = 0.30838512709",
            "ratio_of_roll = 3.24\nratio_of_roll_cradle_per_work = 0.30838512709",
            "pinion.concave.ratio_of_roll_cradle_per_work = 0.30838512709: ratio_of_roll is given too: only one "
            "of them",
        ),
    ],
)
def test_fault_is_refused_as_the_file_has_it_with_the_limit_in_its_unit(sheet, old, new, sentence):
    assert old in sheet
    with pytest.raises(InputError, match=r"^sheet\.toml: " + sentence):
        parse(sheet.replace(old, new, 1), BevelSet, "sheet.toml")


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("63 56 31.3", 63 + 56 / 60 + 31.3 / 3600),
        ("63°56'31.3\"", 63 + 56 / 60 + 31.3 / 3600),
        ("63° 56′ 31.3″", 63 + 56 / 60 + 31.3 / 3600),
        ("63:56:31.3", 63 + 56 / 60 + 31.3 / 3600),
        ("+63 56", 63 + 56 / 60),
        ("63 56.5'", 63 + 56.5 / 60),
        ("63.25°", 63.25),
        ("-0 12 30", -12.5 / 60),
        ("-0°12'30\"", -12.5 / 60),
        ("- 1 0 0", -1.0),
        (" 0 0 0.5 ", 0.5 / 3600),
    ],
)
def test_angle_in_degrees_minutes_and_seconds(text, value):
    assert degrees(text) == pytest.approx(value, abs=1e-13)


@pytest.mark.parametrize(
    "text", ["", "-", "1 2 3 4", "1 -2", "1,5 2", "63°°", "1e2 3", "12h", "6356'", "nan°", "1 2 x"]
)
def test_text_that_is_no_angle_is_refused(text):
    with pytest.raises(ValueError, match="must be a number, or degrees, minutes and seconds"):
        degrees(text)


@given(st.floats(-180, 180), st.sampled_from(["1 2 3", "1°2'3\"", "1:2:3"]))
def test_angle_survives_its_text(value, like):
    """To half a millionth of a second; reading refuses 60 minutes and 60 seconds, so that none is written."""
    assert degrees(angle_text(value, like)) == pytest.approx(value, abs=1.5e-10)


@pytest.mark.parametrize(("value", "text"), [(-0.5, "-0 30 00"), (59.99999999999, "60 00 00"), (1 / 3600, "0 00 01")])
def test_angle_text_carries_into_minutes_and_degrees(value, text):
    assert angle_text(value, "1 2 3") == text


def test_number_between_quotes_is_no_angle(sheet):
    with pytest.raises(InputError, match=r"shaft_angle = '90': must be a number"):
        parse(sheet.replace("shaft_angle = 90", 'shaft_angle = "90"'), BevelSet, "sheet.toml")


@pytest.fixture
def new_settings(gear_set) -> dict[str, np.ndarray]:
    settings = {flank: gear_set.pinion.flank(flank).vector.copy() for flank in FLANKS}
    settings["convex"] = parse(SHEET, BevelSet, "sheet").member("pinion").convex.vector
    for k, name in enumerate(SETTINGS):
        settings["concave"][k] += 0.001 * (k + 1) if name != "cutter_tilt" else 0.0
    return settings


def test_corrected_sheet_stays_a_sheet_with_its_comments(sheet, new_settings, tmp_path):
    source = written(sheet, tmp_path)
    motion = np.zeros((10, 7))
    motion[0, 0], motion[1, 1], motion[8, 0] = 2.54, math.radians(0.5), 0.25
    save_corrected(source, tmp_path / "new.toml", "pinion", new_settings, None, {"concave": motion})
    text = (tmp_path / "new.toml").read_text("utf-8")
    assert "# as printed" in text
    assert "# cradle by work" in text
    raw, new = tomllib.loads(text), load_bevel_set(tmp_path / "new.toml")
    for flank in FLANKS:
        np.testing.assert_allclose(new.pinion.flank(flank).vector, new_settings[flank], rtol=0, atol=1e-8)
    assert design_sha256(new.pinion) == design_sha256(load_bevel_set(source).pinion)
    concave = raw["pinion"]["concave"]
    assert raw["unit"] == "inch"
    assert "ratio_of_roll" not in concave
    assert concave["ratio_of_roll_cradle_per_work"] == pytest.approx(1 / new_settings["concave"][8], abs=1e-11)
    assert concave["radial_distance"] == pytest.approx(new_settings["concave"][0] / 25.4, abs=1e-11)
    assert re.fullmatch(r"-63 49 [\d.]+", concave["cradle_angle"])
    assert raw["pinion"]["convex"]["cradle_angle"] == "-53° 55' 33.58036812\""  # not corrected
    assert "# cradle by work" in text.partition("[pinion.concave.design]")[0]
    assert concave["design"] == {
        key: value for key, value in tomllib.loads(sheet)["pinion"]["concave"].items() if key != "blade_profile_height"
    } | {"motion": {}}
    assert concave["motion"] == {"radial_distance": [0.1], "cradle_angle": [0.0, 0.5], "ratio_of_roll": [0.25]}
    assert new.pinion.concave.motion.radial_distance == pytest.approx((2.54,))
    assert raw["gear"] == tomllib.loads(sheet)["gear"]


def test_corrected_sheet_is_corrected_again_with_the_first_design(sheet, new_settings, tmp_path):
    source = written(sheet, tmp_path)
    save_corrected(source, tmp_path / "one.toml", "pinion", new_settings)
    twice = {flank: vector + 1e-4 for flank, vector in new_settings.items()}
    save_corrected(tmp_path / "one.toml", tmp_path / "two.toml", "pinion", twice)
    first, two = load_bevel_set(source), load_bevel_set(tmp_path / "two.toml")
    for flank in FLANKS:
        np.testing.assert_array_equal(two.pinion.flank(flank).nominal.vector, first.pinion.flank(flank).vector)
        np.testing.assert_allclose(two.pinion.flank(flank).vector, twice[flank], rtol=0, atol=1e-8)


BEYOND = 1.5


def beyond_the_crossing_point(text: str, sign: float = -1.0) -> str:
    """The bundled set with pitch apexes that lie 1.5 mm beyond, its settings counted from the crossing point."""

    def counted(match: re.Match) -> str:
        return f"machine_center_to_crossing_point = {float(match[1]) + sign * BEYOND!r}"

    text = re.sub(r"(?m)^machine_center_to_crossing_point = (\S+)", counted, text)
    return re.sub(r"(clearance = \S+)", rf"\1\npitch_apex_beyond_crossing_point = {BEYOND}", text)


def test_settings_from_the_crossing_point_cut_the_flank_that_those_from_the_apex_cut(gear_set):
    """An apex 1.5 mm beyond lies 1.5 mm nearer to the machine centre: the work stands advanced by that."""
    ours = parse(beyond_the_crossing_point(TEXT), BevelSet, "sheet.toml")
    for member in MEMBERS:
        for flank in FLANKS:
            np.testing.assert_allclose(
                ours.member(member).flank(flank).vector, gear_set.member(member).flank(flank).vector, rtol=0, atol=1e-12
            )
        assert ours.member(member).blank.pitch_apex_beyond_crossing_point == BEYOND
    grid = blank_grid(ours.gear, 3, 3)
    expected = solve_flank(gear_set.gear, "concave", blank_grid(gear_set.gear, 3, 3))
    np.testing.assert_allclose(solve_flank(ours.gear, "concave", grid).point, expected.point, atol=1e-9)


def test_corrected_set_and_text_count_from_the_crossing_point_again(gear_set, new_settings, tmp_path):
    source = written(beyond_the_crossing_point(TEXT), tmp_path)
    save_corrected(source, tmp_path / "new.toml", "pinion", new_settings)
    new, raw = load_bevel_set(tmp_path / "new.toml"), tomllib.loads((tmp_path / "new.toml").read_text("utf-8"))
    for flank in FLANKS:
        k = SETTINGS.index("machine_center_to_crossing_point")
        np.testing.assert_allclose(new.pinion.flank(flank).vector, new_settings[flank], rtol=0, atol=1e-9)
        np.testing.assert_allclose(
            new.pinion.flank(flank).nominal.vector, gear_set.pinion.flank(flank).vector, rtol=0, atol=1e-12
        )
        assert raw["pinion"][flank][SETTINGS[k]] == pytest.approx(new_settings[flank][k] - BEYOND, abs=1e-9)
    again = parse(set_text(new), BevelSet, "text")
    for flank in FLANKS:
        np.testing.assert_allclose(again.pinion.flank(flank).vector, new_settings[flank], rtol=0, atol=2e-9)
        np.testing.assert_allclose(
            again.pinion.flank(flank).nominal.vector, new.pinion.flank(flank).nominal.vector, rtol=0, atol=2e-9
        )


def test_model_of_a_loaded_set_is_that_set_again(sheet):
    """A loaded set is in mm, from the apex: nothing is converted twice."""
    ours = parse(beyond_the_crossing_point(sheet), BevelSet, "sheet.toml")
    assert BevelSet.model_validate(ours.model_dump()) == ours


ODD = [
    "1" + "0" * 400,
    "-1" + "0" * 400,
    "true",
    '"x"',
    '""',
    '" "',
    "[]",
    "{}",
    "[1]",
    '["1 2 3"]',
    "nan",
    "-inf",
    "0",
    '"1 2 3"',
    '"1 2 3 4"',
    f'"1{" " * 5000}2"',
    "1979-05-27",
    "1e308",
    "{a = 1}",
    '"\\u0661 2"',
]


def outcome(text: str) -> str | BevelSet:
    """The set, or the sentence that refuses it. Anything else is a fault of the program."""
    try:
        return parse(text, BevelSet, "sheet.toml")
    except InputError as error:
        return str(error)


@pytest.mark.parametrize("odd", ODD, ids=lambda odd: odd[:12])
def test_odd_value_of_any_key_is_refused_in_one_sentence_or_taken(odd):
    """Numbers beyond a double, other types, long texts, dates; for one member and one of its flanks."""
    lines = beyond_the_crossing_point(SHEET).splitlines()
    for k, line in enumerate(lines[: lines.index("[pinion.convex]")]):
        if re.match(r"\w+ = ", line):
            key = line.partition(" = ")[0]
            found = outcome("\n".join([*lines[:k], f"{key} = {odd}", *lines[k + 1 :]]))
            if isinstance(found, BevelSet):
                vectors = [member.flank(flank).vector for member in found.members.values() for flank in FLANKS]
                assert np.isfinite(vectors).all()
            else:
                assert re.fullmatch(r"sheet\.toml: [^\n]+", found)


def test_misspelt_ratio_by_cradle_is_named_with_the_key_that_is_meant():
    text = bundled("nasa_tp3096_12x36.toml").read_text("utf-8")
    text = text.replace("\nratio_of_roll =", "\nratio_of_roll_cradle_per_wrk =", 1)
    meant = r"pinion\.concave\.ratio_of_roll_cradle_per_wrk: no such key; did you mean ratio_of_roll_cradle_per_work\?"
    with pytest.raises(InputError, match=meant):
        parse(text, BevelSet, "s.toml")
