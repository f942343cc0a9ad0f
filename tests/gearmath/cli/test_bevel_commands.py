"""``gearmath flank``: the file it writes, and one line and status 2 on bad input, with nothing half-written."""

from __future__ import annotations

import numpy as np
import pytest

from gearmath.specs.flank_csv import read_flank_csv
from gearmath.specs.toml import bundled

SET = "nasa_tp3096_12x36.toml"


@pytest.mark.parametrize(("member", "side"), [("pinion", "concave"), ("gear", "convex")])
def test_nominal_flank_is_written_as_the_contract_says(command, tmp_path, member, side):
    target = tmp_path / "f.csv"
    status, out, err = command("flank", SET, "--member", member, "--flank", side, "-o", target)
    assert (status, err) == (0, "")
    assert "45 points" in out
    file = read_flank_csv(target)
    assert (file.member, set(file.flank)) == (member, {side})
    assert {key: file.header[key] for key in ("frame", "unit", "grid", "margins", "reference_point")} == {
        "frame": "w",
        "unit": "mm",
        "grid": "5x9",
        "margins": "0.1,0.1",
        "reference_point": "2,4",
    }
    assert np.isnan(file.deviation).all()
    # the reference point lies on the mean cone distance, within half the working depth of the pitch cone
    here = (file.row == 2) & (file.col == 4)
    along = np.linalg.norm(file.point[here])
    assert along == pytest.approx(81.05, abs=0.1)


def test_grid_and_margin_are_those_asked_for(command, tmp_path):
    target = tmp_path / "f.csv"
    arguments = ("flank", SET, "--member", "gear", "--flank", "concave", "-o", target)
    assert command(*arguments, "--grid", "3x4", "--margin", "0.25")[0] == 0
    file = read_flank_csv(target)
    assert (len(file), file.header["grid"], file.header["margins"]) == (12, "3x4", "0.25,0.25")
    cone = np.linalg.norm(file.point, axis=1)
    assert np.ptp(cone) == pytest.approx(0.5 * 25.4, rel=0.02)  # half the face width is left


def test_every_side_may_have_a_margin_of_its_own(command, tmp_path):
    target = tmp_path / "f.csv"
    arguments = ("flank", SET, "--member", "gear", "--flank", "concave", "-o", target, "--grid", "3x4")
    assert command(*arguments, "--margin", "0.2", "--margin-toe", "0", "--margin-tip", "0.05")[0] == 0
    file = read_flank_csv(target)
    assert file.header["margins"] == "0.2,0.05,0,0.2"
    cone = np.linalg.norm(file.point, axis=1)
    assert np.ptp(cone) == pytest.approx(0.8 * 25.4, rel=0.02)
    assert command(*arguments, "--margin-root", "0.2", "--margin-tip", "0.2")[0] == 0
    assert read_flank_csv(target).header["margins"] == "0.2,0.1"


def test_points_stand_at_the_places_of_a_list(command, tmp_path):
    target, places = tmp_path / "f.csv", tmp_path / "places.csv"
    arguments = ("flank", SET, "--member", "gear", "--flank", "concave", "-o", target)
    assert command(*arguments, "--grid", "2x3", "--margin", "0.2")[0] == 0
    grid = read_flank_csv(target)
    place = np.stack([grid.point[:, 2], np.hypot(grid.point[:, 0], grid.point[:, 1])], axis=1)
    places.write_text("z_w,r_w\n" + "".join(f"{z:.9f},{r:.9f}\n" for z, r in place), "utf-8")
    assert command(*arguments, "--places", places, "--grid", "2x3")[0] == 0
    file = read_flank_csv(target)
    assert (file.header["grid"], file.header["margins"]) == ("2x3", "own")
    np.testing.assert_allclose(file.point, grid.point, atol=1e-8)
    status, out, _ = command(*arguments, "--places", places)
    assert (status, "6 points" in out) == (0, True)
    assert "# grid: 6x1\n" in target.read_text("utf-8")


def test_set_may_be_a_file_of_ones_own(command, tmp_path):
    own = tmp_path / "own.toml"
    own.write_text(bundled(SET).read_text("utf-8"), "utf-8")
    assert command("flank", own, "--member", "gear", "--flank", "convex", "-o", tmp_path / "f.csv")[0] == 0


FLANK = ("flank", "{set}", "--member", "gear", "--flank", "concave", "-o", "{target}")


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        ((*FLANK, "--grid", "5by9"), "--grid 5by9: must read like 5x9"),
        ((*FLANK, "--grid", "0x9"), "--grid 0x9: must"),
        ((*FLANK, "--grid", "1000001x2"), "--grid 1000001x2: must .* at most 1000000 points"),
        (
            (*FLANK, "--margin", "0.5"),
            "--margin 0.5: must be at least 0 and less than 0.5, or the grid leaves",
        ),
        ((*FLANK, "--margin", "-0.1"), "--margin -0.1: must"),
        ((*FLANK, "--margin", "nan"), "--margin nan: must"),
        ((*FLANK, "--margin-heel", "0.5"), "--margin-heel 0.5: must be at least 0 and less than 0.5"),
        ((*FLANK, "--margin-root", "nan"), "--margin-root nan: must"),
        ((*FLANK, "--places", "absent.csv"), r"^gearmath: absent\.csv: cannot be read"),
        ((*FLANK, "--places", "absent.csv", "--margin-tip", "0.1"), r"--margin-tip 0\.1: listed places .* no margins"),
        ((*FLANK, "--margin", "wide"), "'wide' is not a valid float"),
        (("flank", "absent.toml", *FLANK[2:]), r"absent\.toml: cannot be read: there is no such file; bundled are"),
        (("flank", "{set}", "--member", "wheel", *FLANK[4:]), "'wheel' is not one of 'pinion', 'gear'"),
        (("flank", "{set}", "--member", "gear", "--flank", "left", *FLANK[6:]), "'left' is not one of"),
        (FLANK[:-2], "Missing option '-o'"),
        ((*FLANK[:-1], "{folder}/absent/f.csv"), r"f\.csv: cannot be written: there is no folder .*absent"),
        ((*FLANK[:-1], "{folder}"), "is a directory"),
        (FLANK[:2] + FLANK[4:], "--member is missing: the set has both"),
    ],
)
def test_bad_arguments_are_one_line_and_write_nothing(refused, tmp_path, arguments, sentence):
    names = {"set": SET, "target": tmp_path / "f.csv", "folder": tmp_path}
    refused(sentence, *(argument.format(**names) for argument in arguments))
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("old", "new", "sentence"),
    [
        (
            "blade_pressure_angle = 22.0",
            "blade_pressure_angle = 95.0",
            r"blade_pressure_angle = 95\.0: must be at most 45",
        ),
        ("blade_pressure_angle = 22.0", "blade_pressure_angle = nan", r"blade_pressure_angle = nan: must be a finite"),
        ("blade_pressure_angle = 22.0\n", "", r"blade_pressure_angle: the key is missing"),
        ("blade_pressure_angle = 22.0", "blade_pressure_angle = 22.0\ncolor = 1", r"color = 1: no such key is known"),
        ("shaft_angle = 90.0", "shaft_angle = 90.0.0", r"is no TOML: "),
    ],
)
def test_bad_set_is_one_line_with_file_key_value_and_limit(refused, tmp_path, old, new, sentence):
    text = bundled(SET).read_text("utf-8")
    assert old in text
    bad = tmp_path / "bad.toml"
    bad.write_text(text.replace(old, new, 1), "utf-8")
    refused(
        r"^gearmath: .*bad\.toml: .*" + sentence,
        "flank",
        bad,
        "--member",
        "gear",
        "--flank",
        "concave",
        "-o",
        tmp_path / "f.csv",
    )
    assert [path.name for path in tmp_path.iterdir()] == ["bad.toml"]


def test_blade_that_does_not_reach_the_tip_is_bad_input_and_leaves_an_old_file_alone(command, tmp_path):
    short = tmp_path / "short.toml"
    short.write_text(bundled(SET).read_text("utf-8").replace("profile_height = 12.0", "profile_height = 3.0"), "utf-8")
    target = tmp_path / "f.csv"
    target.write_text("mine")
    status, out, err = command("flank", short, "--member", "gear", "--flank", "concave", "-o", target)
    assert (status, out) == (2, "")
    assert "short.toml: pinion concave flank: blade_profile_height = 3 does not reach the tip of the tooth" in err
    assert err.count("\n") == 1
    assert target.read_text() == "mine"
