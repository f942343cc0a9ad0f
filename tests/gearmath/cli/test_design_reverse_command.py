"""``gearmath design --reverse``: its JSON and text, the set that it writes, and what it refuses."""

from __future__ import annotations

import json
import tomllib
from dataclasses import replace

import numpy as np
import pytest
import tomlkit

from gearmath.bevel.flank import blank_grid
from gearmath.bevel.nominal_file import nominal_flank
from gearmath.bevel.pair import load_pair
from gearmath.specs.bevel_set import FLANKS, load_bevel_set
from gearmath.specs.flank_csv import join, read_flank_csv, write_flank_csv
from gearmath.specs.toml import bundled


@pytest.fixture
def points(tmp_path):
    """The points of the 7x43 pinion with half a micrometre of noise, as a flank CSV."""
    member = load_bevel_set(bundled("spiral_7x43.toml")).member("pinion")
    file = join([nominal_flank(member, flank, blank_grid(member)) for flank in FLANKS])
    path = tmp_path / "points.csv"
    write_flank_csv(path, file.with_noise(np.random.default_rng(5).normal(0.0, 5e-4, len(file)), 5e-4))
    return path


@pytest.mark.parametrize("data", ["design_7x43.toml", "spiral_7x43.toml"])
def test_set_of_the_settings_found_is_a_member_with_the_figures_of_the_json(command, points, tmp_path, data):
    """From design data and from a set, whose settings do not count, alike."""
    target = tmp_path / "set.toml"
    status, out, err = command("design", "--reverse", points, data, "-o", target, "--json")
    assert (status, err) == (0, "")
    found = json.loads(out)
    assert found["member"] == "pinion"
    with_mate = data == "spiral_7x43.toml"
    assert list(load_pair(target).members) == ["pinion", "gear"][: 1 + with_mate]
    assert found["notes"] == ["the gear is that of the file of the blank"] * with_mate
    assert found["tooth_thickness_mm"]["found"] == pytest.approx(found["tooth_thickness_mm"]["blank"], abs=0.15)
    if with_mate:
        assert load_pair(target).gear == load_pair(bundled(data)).gear
    for flank in FLANKS:
        figures = found[flank]
        assert figures["points"] == 45
        assert figures["rms_um"] < 0.6 < 50 < figures["rms_before_um"]
        assert figures["scatter_um"] == pytest.approx(0.5, rel=0.4)
        assert abs(figures["largest"]["deviation_um"]) >= figures["rms_um"]


def test_text_says_what_was_fitted_and_what_is_left(command, points, tmp_path):
    status, out, _ = command("design", "--reverse", points, "spiral_7x43.toml", "-o", tmp_path / "set.toml")
    assert status == 0
    assert "concave flank, 45 points: all but the scatter of its points is reproduced" in out
    assert "work_rotation_offset.2" in out
    assert "bounds reached" not in out  # none held anything back


def test_points_that_are_larger_than_the_blank_and_a_gear_that_is_no_mate_are_said(command, tmp_path):
    """Points larger by a hundredth, away from the apex: a flank of its own; and a gear cut by a millimetre too wide."""
    member = load_bevel_set(bundled("spiral_7x43.toml")).member("pinion")
    file = join([nominal_flank(member, flank, blank_grid(member)) for flank in FLANKS])
    path, given, target = tmp_path / "points.csv", tmp_path / "given.toml", tmp_path / "set.toml"
    write_flank_csv(path, replace(file, point=1.01 * file.point))
    values = tomllib.loads(bundled("spiral_7x43.toml").read_text("utf-8"))
    values["gear"]["concave"]["blade_point_radius"] += 1.0
    given.write_text(tomlkit.dumps(values), "utf-8")
    status, out, _ = command("design", "--reverse", path, given, "-o", target, "--json")
    assert status == 0
    found = json.loads(out)
    middle = found["middle_cone_distance_mm"]
    along = np.linalg.norm(1.01 * file.point, axis=1)
    assert middle["points"] == pytest.approx((along.min() + along.max()) / 2, abs=1e-6)
    assert middle["blank"] == member.blank.mean_cone_distance
    said, *others = found["notes"]
    assert "nearer to the heel than the mean point of the blank: unless they are of this part" in said
    assert others[-1].startswith("the gear of the file of the blank is left out, it is no mate of this pinion: ")
    assert list(load_pair(target).members) == ["pinion"]


def test_points_of_another_machine_laid_on_another_set_give_the_flank_that_they_are_of(command, tmp_path):
    """The designed 7x43 pinion as plain text, on the crown gear's set, 72 um RMS off: the way of a foreign flank."""
    texts, options = [], []
    for flank in FLANKS:
        member = load_bevel_set(bundled("spiral_7x43.toml")).member("pinion")
        points = nominal_flank(member, flank, blank_grid(member))
        texts.append(tmp_path / f"{flank}.txt")
        np.savetxt(texts[-1], np.hstack([points.point, points.normal]), "%.9f")
        options += ["--flank", flank]
    laid, target = tmp_path / "laid.csv", tmp_path / "set.toml"
    setting = ("--set", "spiral_7x43.toml", "--member", "pinion", "--phase", "kept")
    assert command("points", *texts, *setting, *options, "-o", laid)[0] == 0
    status, out, _ = command("design", "--reverse", laid, "design_7x43.toml", "-o", target, "--json")
    assert status == 0
    assert max(json.loads(out)[flank]["rms_um"] for flank in FLANKS) < 0.1
    # evaluated on the set found, the same texts deviate by nothing
    again = tmp_path / "again.csv"
    setting = ("--set", target, "--member", "pinion", "--phase", "kept")
    assert command("points", *texts, *setting, *options, "-o", again)[0] == 0
    assert np.abs(read_flank_csv(again).deviation).max() < 1e-4


def test_points_of_one_flank_are_refused_and_nothing_is_written(command, points, tmp_path):
    lines = points.read_text("utf-8").splitlines(keepends=True)
    points.write_text("".join(line for line in lines if ",convex," not in line), "utf-8")
    target = tmp_path / "set.toml"
    status, _, err = command("design", "--reverse", points, "spiral_7x43.toml", "-o", target)
    assert status == 2
    assert err == f"gearmath: {points}: holds no point of the convex flank, both flanks are needed\n"
    assert not target.exists()


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("nasa_tp3096_12x36.toml",), "member_teeth = 7: the pinion of the blank has 12"),
        (("spiral_7x43.toml", "--from", "spiral_7x43.toml"), "--from and --reverse: only one of them may be given"),
        (("vertical_5axis.toml",), "vertical_5axis.toml: "),
    ],
)
def test_wrong_data_are_refused_in_one_sentence(command, points, tmp_path, arguments, words):
    status, _, err = command("design", "--reverse", points, *arguments, "-o", tmp_path / "set.toml")
    assert status == 2
    assert words in err
    assert err.count("\n") == 1


def test_summary_sheet_of_the_settings_found_is_written_beside_the_set(command, points, tmp_path):
    sheet, again = tmp_path / "sheet.html", tmp_path / "again.html"
    arguments = ("design", "--reverse", points, "spiral_7x43.toml", "-o", tmp_path / "set.toml", "--sheet", sheet)
    status, out, _ = command(*arguments)
    assert status == 0
    assert f"{sheet}: summary sheet, prints on A4" in out
    assert command("export", "summary", tmp_path / "set.toml", "-o", again)[0] == 0
    assert sheet.read_text("utf-8") == again.read_text("utf-8")  # of the same settings, by their digest too
