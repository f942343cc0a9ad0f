"""``gearmath design``: its JSON and text, the set that it writes, and what it refuses."""

from __future__ import annotations

import json
import re

import pytest

from gearmath.bevel.design.accepted import accepted
from gearmath.bevel.pair import load_pair
from gearmath.front.sets import GearSet
from gearmath.specs.design import DesignData
from gearmath.specs.toml import bundled, parse
from tests.gearmath.bevel.design.family import mixed

DATA = """
title = "12 x 36"
pinion_teeth = 12
wheel_teeth = 36
outer_transverse_module = 4.96
face_width = 25.4
{more}

[cutter]
cutter_radius = {cutter}
"""


@pytest.fixture
def written(tmp_path):
    """A file of design data with more keys at the top, another cutter, and text at its end."""

    def write(more: str = "", cutter: str = "76.2", end: str = ""):
        path = tmp_path / "design.toml"
        path.write_text(DATA.format(more=more, cutter=cutter) + end, "utf-8")
        return path

    return write


def test_set_that_is_written_is_a_pair_with_the_figures_of_the_json(command, tmp_path):
    target = tmp_path / "set.toml"
    status, out, err = command("design", "design_7x43.toml", "-o", target, "--json")
    assert (status, err) == (0, "")
    found = json.loads(out)
    pair = load_pair(target)
    assert (pair.member("pinion").teeth, pair.member("gear").teeth) == (7, 43)
    status, out, _ = command("contact", target, "--json")
    contact = json.loads(out)
    for side in ("drive", "coast"):
        assert contact[side]["outcome"] == found[side]["outcome"] == "interior contact"
        assert contact[side]["peak_to_peak_arcsec"] == pytest.approx(found[side]["peak_to_peak_arcsec"], abs=1e-3)


def test_what_was_changed_where_the_file_leaves_it_out_is_said(command, tmp_path):
    """A 7 x 30 pair that runs on edges with the path that is taken where none is asked for."""
    path = tmp_path / "design.toml"
    path.write_text(
        'title = "7 x 30"\npinion_teeth = 7\nwheel_teeth = 30\nouter_transverse_module = 2.985\nface_width = 13.795\n'
        "mean_spiral_angle = 36.49\n[cutter]\ncutter_radius = 35.12\n",
        "utf-8",
    )
    status, out, err = command("design", path, "-o", tmp_path / "set.toml")
    assert (status, err) == (0, "")
    assert "changed for it: drive.path_angle = 35, coast.path_angle = 145" in out


def test_7x43_pair_is_what_the_data_ask_for(command, tmp_path):
    """No undercut (the set is a pair), top land, backlash, parabola within 5 %, path within the flank, rounded."""
    status, out, _ = command("design", "design_7x43.toml", "-o", tmp_path / "set.toml", "--json")
    assert status == 0
    found = json.loads(out)
    for land in found["top_land_mm"].values():
        assert min(land.values()) >= 0.2 * found["mean_normal_module_mm"]
    assert found["backlash_mm"]["found"] == pytest.approx(found["backlash_mm"]["asked"], abs=0.001)
    for side in ("drive", "coast"):
        second = found[side]["second_derivative"]
        assert second["found"] == pytest.approx(second["asked"], rel=0.05)
        assert None not in found[side]["lag_half_a_pitch_from_vertex_arcsec"]


def test_text_says_what_was_asked_and_found(command, written, tmp_path):
    status, out, _ = command("design", written(), "-o", tmp_path / "set.toml", "--plot", tmp_path / "contact.png")
    assert status == 0
    assert "asked 50.00 degrees" in out
    assert (tmp_path / "contact.png").stat().st_size > 10_000


@pytest.mark.parametrize(
    ("more", "cutter", "end", "sentence"),
    [
        ("hypoid_offset = 20.0", "76.2", "", r"hypoid_offset = 20: must be 0"),
        ("", "20.0", "", r"cutter\.cutter_radius = 20: .* must be at least \d"),
        ("", "80.0\nradii = [63.5, 76.2]", "", r"cutter_radius 80 is not on the list of radii: 63\.5, 76\.2"),
        ("", "76.2", "[drive]\npath_angle = 16.0\npattern_length = 0.1\n", r"drive: pattern_length = 0\.1: .*above"),
        (
            "",
            "76.2",
            "[coast]\npath_angle = 50.0\n",
            r"coast: edge contact.* after it.*a larger path_angle \(now 50",
        ),
        ("", "76.2", "[coast]\npath_angle = 5.0\n", r"coast\.path_angle = 5.*at least 15"),
        ("pressure_angle_drive = 0.349", "76.2", "", r"at least 10; angles are in degrees, and 0\.349 rad are 20$"),
        ("shaft_angle = 1.5708", "76.2", "", r"shaft_angle = 1\.5708: must be at least 20; .* rad are 90$"),
        ("mean_spiral_angle = 0.6109", "50.0", "", r"0\.6109 is in degrees, and 0\.6109 rad would be 35$"),
        ("face_widht = 3", "76.2", "", r"face_widht"),
        ("", "76.2", "[pinion]\nblade_edge_radius = 5.0\n", r"pinion\.blade_edge_radius = 5: .* it must be at most \d"),
        ("", "76.2", "[gear]\nblade_edge_radius = 5.0\n", r"gear\.blade_edge_radius = 5: .* it must be at most \d"),
        ("", "76.2", "[gear]\nblade_edge_radius = 1e-9\n", r"blade_edge_radius = 1e-09: must be 0, .* at least 0\.001"),
        ("", "76.2", "[pinion]\ncutter_tilt = -30.0\n", r"pinion\.cutter_tilt = -30: .*must be at least 3"),
        ("", "500.0", "", r"cutter\.cutter_radius = 500: .*must be at most 500"),
        ("", "76.2", "[drive]\npattern_length = 0.1\n", r"drive: .*pattern_length = 0\.1: .* must be at least 70%"),
        (
            "",
            '76.2\nprocess = "face_hobbing"\nblade_groups = 9',
            "",
            r"pinion\.cutting = 'fixed_setting': with face_hobbing it must be 'completing'",
        ),
        (
            "",
            "76.2",
            '[pinion]\ncutting = "completing"\ncutter_tilt = 3.0\n',
            r"pinion.*: cutter_tilt belongs to cutting",
        ),
    ],
)
def test_what_cannot_be_is_refused_with_what_binds(refused, written, tmp_path, more, cutter, end, sentence):
    target = tmp_path / "set.toml"
    refused(rf"design\.toml.*(?:{sentence})", "design", written(more, cutter, end), "-o", target)
    assert not target.exists()


@pytest.mark.parametrize(
    ("of_set", "other", "sentence"),
    [
        ("spiral_7x43.toml", None, "pinion_teeth = 12: must be 7"),
        ("nasa_tp3096_12x36.toml", ("wheel_teeth = 36", "wheel_teeth = 37"), "wheel_teeth = 37: must be 36"),
        ("nasa_tp3096_12x36.toml", ("face_width = 25.4", "face_width = 20"), "face_width of 20 mm: must be 25.4 mm"),
        (
            "nasa_tp3096_12x36.toml",
            ("[cutter]", '[gear]\ngeneration = "formate"\n[cutter]'),
            "gear.generation = 'formate': must be 'generated'",
        ),
        (
            "nasa_tp3096_12x36.toml",
            ("[cutter]", '[pinion]\ncutting = "completing"\n[cutter]\nprocess = "face_hobbing"\nblade_groups = 11'),
            "cutter.process = 'face_hobbing': must be 'face_milling'",
        ),
        # 2 x 93.75 mm x sin(71.565 degrees)/36; the cutter is of 6 inches
        ("nasa_tp3096_12x36.toml", ("4.96", "4.90"), "outer_transverse_module of 4.9 mm: must be 4.94"),
        ("nasa_tp3096_12x36.toml", ("4.96", "4.941\nshaft_angle = 80"), "shaft_angle = 80: must be 90"),
        (
            "nasa_tp3096_12x36.toml",
            ("4.96", "4.941\nmean_spiral_angle = 30"),
            "mean_spiral_angle = 30 degrees: must be 34.9",
        ),
        (
            "nasa_tp3096_12x36.toml",
            ("4.96", "4.941\npressure_angle_drive = 25"),
            "pressure_angle_drive = 25 degrees: must",
        ),
        ("nasa_tp3096_12x36.toml", ("4.96", "4.941"), "cutter.cutter_radius of 57.15 mm: must be 76.2"),
    ],
)
def test_gear_of_another_pair_is_refused(refused, written, tmp_path, of_set, other, sentence):
    """What the file says of the pair and the set has otherwise would be left out without a word."""
    path = written()
    if other:
        path.write_text(path.read_text("utf-8").replace(*other), "utf-8")
    if "cutter_radius" in sentence:
        path.write_text(path.read_text("utf-8").replace("= 76.2", "= 57.15"), "utf-8")
    refused(re.escape(sentence), "design", path, "--from", of_set, "-o", tmp_path / "s")


def test_cutter_nearest_to_the_mean_cone_distance_is_chosen_from_the_list(command, written, tmp_path):
    path = written(cutter="0")
    path.write_text(path.read_text("utf-8").replace("cutter_radius = 0", "radii = [63.5, 76.2, 114.3]"), "utf-8")
    status, out, _ = command("design", path, "-o", tmp_path / "set.toml", "--json")
    assert status == 0
    assert json.loads(out)["cutter_radius_mm"] == 76.2  # mean cone distance 81.4


def test_factors_that_nobody_has_chosen_are_those_of_the_standards_sample():
    """ISO 23509:2016, table F.2: 14 x 39 has 0.24737 and 0.0915 printed."""
    text = bundled("blank_iso23509_sample1.toml").read_text("utf-8")
    head = text.split("[data_type_2]")[0].split("[taper]")[0].replace('process = "face_milling"', "")
    data = parse(head, DesignData, "sample").blank_data(114.3).data_type_2
    assert data.mean_addendum_factor == pytest.approx(0.24737, abs=5e-6)
    assert data.thickness_factor == pytest.approx(0.0915, abs=5e-5)


def test_bundled_7x43_set_is_the_one_that_its_design_data_give(command, tmp_path):
    """The file of the set in every figure; rounding of shop steps hides what processors differ in."""
    target = tmp_path / "set.toml"
    assert command("design", "design_7x43.toml", "-o", target)[0] == 0
    one, other = (load_pair(path).model_dump() for path in (target, bundled("spiral_7x43.toml")))
    for name in ("pinion", "gear"):
        for flank in ("concave", "convex"):
            made, kept = one[name].pop(flank), other[name].pop(flank)
            motion, same = made.pop("motion")["modified_roll"], kept.pop("motion")["modified_roll"]
            assert motion == pytest.approx(same, abs=1e-6)
            assert made == kept
    assert one == other


@pytest.mark.slow
def test_program_cuts_the_7x43_pinion_within_a_tenth_of_a_micrometer(command, tmp_path):
    program = tmp_path / "PINION.MPF"
    assert command("nc", "cut", "spiral_7x43.toml", "--member", "pinion", "-o", program)[0] == 0
    given = ("mill", "spiral_7x43.toml", "--member", "pinion", "--program", program, "-o", tmp_path / "milled.csv")
    status, out, err = command(*given)
    assert status == 0, err
    assert "7 of 7 spaces within 0.1 um" in out


def test_far_side_of_a_cutter_for_one_flank_stays_off_the_other_one(command, refused, tmp_path):
    """10 x 33: the widest point that passes the slot cuts 0.2 mm into the other flank, as programs are judged."""
    pair = accepted(mixed(39))[0].pair
    assert pair.pinion.convex.blade_point_width is None
    path, program = tmp_path / "set.toml", tmp_path / "PINION.MPF"
    GearSet(pair).save(path)
    cut = ("nc", "cut", path, "--member", "pinion", "--spaces", "0", "-o", program)
    assert command(*cut)[0] == 0
    lines = path.read_text("utf-8").splitlines()
    path.write_text("\n".join(line for line in lines if not line.startswith("blade_point_width")), "utf-8")
    program.unlink()
    refused("gouges the convex flank of space 0", *cut)
