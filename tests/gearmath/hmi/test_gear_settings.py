"""Settings as fields: the limits are those that a file is refused by, and a change is judged as a pair."""

from __future__ import annotations

import json
import re
import tomllib
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import gearmath as gm
from gearmath.errors import InputError
from gearmath.hmi.catalog import files_of
from gearmath.hmi.desk import Desk, draft
from gearmath.hmi.flank_view import flat_figures, space_figure, view_of_settings
from gearmath.hmi.gear_settings import save_edited, setting_fields, setting_limits, with_edits
from gearmath.hmi.judged_runs import JudgedRuns
from gearmath.specs.bevel_set import SETTINGS, BevelSet
from gearmath.specs.toml import bundled, parse

SET = "nasa_tp3096_12x36.toml"
NAMES = {"concave": "concave", "convex": "convex"}


@pytest.fixture(scope="module")
def pinion() -> gm.Member:
    return gm.load_set(SET).pinion


@pytest.mark.parametrize("key", SETTINGS)
def test_limits_beside_a_field_are_those_that_a_file_is_refused_by(key: str) -> None:
    text = bundled(SET).read_text("utf-8")
    before, section, table = text.partition("[pinion.concave]")
    limits = setting_limits(key)
    for limit, beyond in ((limits.low, -1.0), (limits.high, 1.0)):
        changed, count = re.subn(rf"(?m)^{key} *=.*$", f"{key} = {limit + beyond}", table, count=1)
        assert count == 1
        with pytest.raises(InputError, match=rf"pinion\.concave\.{key} = .*must be .* {limit:g}\b"):
            parse(before + section + changed, BevelSet, "set.toml")


def test_a_fixed_setting_member_has_a_field_for_each_flank_and_a_completing_one_shares_those_of_the_machine() -> None:
    fields = {one.place: one for one in setting_fields(gm.load_set(SET).pinion)}
    assert len(fields) == 24
    assert (fields[("convex",), "blade_point_radius"].unit, fields[("convex",), "cradle_angle"].unit) == ("mm", "°")
    shared = {one.place: one for one in setting_fields(gm.load_set("spiral_7x43.toml").gear)}
    assert len(shared) == 14
    assert shared[("concave", "convex"), "radial_distance"].value == 94.522


def test_an_edit_changes_the_flanks_as_the_front_door_does(pinion: gm.Member) -> None:
    value = pinion.spec.concave.radial_distance + 0.05
    edited = with_edits(pinion, {(("concave",), "radial_distance"): value})
    expected = pinion.with_settings(concave={"radial_distance": 0.05})
    np.testing.assert_allclose(edited.deviations().deviation, expected.deviations().deviation, atol=1e-9)


def test_what_a_field_shows_of_a_value_is_no_change(pinion: gm.Member) -> None:
    shown = {one.place: float(f"{one.value:.6f}") for one in setting_fields(pinion)}
    assert with_edits(pinion, shown) is pinion


def test_an_edit_that_makes_no_pair_is_refused_with_its_sentence_and_the_others_count(tmp_path: Path) -> None:
    good, bad = (("concave",), "blank_offset"), (("convex",), "cutter_tilt")
    typed = {bad: 44.0, good: 3.95}
    found = draft(bundled(SET), "pinion", typed, JudgedRuns(tmp_path / "runs.db"), None)
    assert found.accepted == {good: 3.95}
    assert list(found.refused) == [bad]
    assert "pinion" in found.refused[bad]
    assert found.edited.spec.concave.blank_offset == 3.95


def test_a_saved_set_keeps_comments_and_the_nominal_settings_and_the_old_file(tmp_path: Path) -> None:
    source = tmp_path / "set.toml"
    source.write_bytes(bundled(SET).read_bytes())
    member = gm.load_set(source).pinion
    edited = with_edits(member, {(("concave",), "sliding_base"): 0.31})
    save_edited(source, tmp_path / "new.toml", member, edited)
    assert source.read_bytes() == bundled(SET).read_bytes()
    text = (tmp_path / "new.toml").read_text("utf-8")
    comments = {line for line in source.read_text("utf-8").splitlines() if line.startswith("#")}
    assert comments <= set(text.splitlines())
    values = tomllib.loads(text)["pinion"]
    assert values["concave"]["sliding_base"] == 0.31
    assert (
        values["concave"]["design"]["sliding_base"]
        == tomllib.loads(source.read_text())["pinion"]["concave"]["sliding_base"]
    )
    assert "design" not in values["convex"]


def test_the_figure_in_space_is_json_and_lifts_each_point_by_its_deviation(pinion: gm.Member) -> None:
    edited = with_edits(pinion, {(("concave",), "machine_root_angle"): pinion.spec.concave.machine_root_angle + 0.02})
    measured = edited.deviations((9, 17))
    view = view_of_settings(edited)
    figure = space_figure(view, "pinion", NAMES, dark=True)
    assert json.loads(json.dumps(figure, allow_nan=False))["layout"]["uirevision"] == "pinion"
    surface, net = figure["data"][:2]
    lifted = np.stack([np.array(surface[key], dtype=float) for key in "xyz"], axis=-1).reshape(9, 17, 3)
    lines = np.stack([np.array([np.nan if v is None else v for v in net[key]]) for key in "xyz"], axis=-1)
    rows, columns = lifted.shape[:2]
    nominal = lines[: rows * (columns + 1)].reshape(rows, columns + 1, 3)[:, :columns]
    away = np.linalg.norm(lifted - nominal, axis=-1) * 1000 / view.times
    deviation = measured.file.select("concave").deviation.reshape(rows, columns) * 1000
    np.testing.assert_allclose(away, np.abs(deviation), atol=0.02)
    for shown in ("intensity", "customdata"):
        np.testing.assert_allclose(np.array(surface[shown], dtype=float), deviation.ravel(), atol=1e-4)


def test_the_flank_in_space_is_whole_and_has_a_hole_where_a_point_is_missing(pinion: gm.Member) -> None:
    view = view_of_settings(pinion)
    concave = view.flanks["concave"]
    missing = concave.deviation.copy()
    missing[4, 8] = np.nan
    holed = replace(view, flanks={**view.flanks, "concave": replace(concave, deviation=missing)})
    areas = []
    for one in (view, holed):
        surface = space_figure(one, "pinion", NAMES, dark=False)["data"][0]
        at = np.stack([np.array(surface[key]) for key in "xyz"], axis=-1)
        corners = [at[surface[key]] for key in "ijk"]
        normals = np.cross(corners[1] - corners[0], corners[2] - corners[0])
        assert (normals @ normals.sum(axis=0) > 0).all()  # all seen from the same side
        areas.append((np.linalg.norm(normals, axis=1) / 2).sum())
    # by the parallelogram of the diagonals of each mesh of the net
    net = concave.point
    across = np.cross(net[1:, 1:] - net[:-1, :-1], net[1:, :-1] - net[:-1, 1:])
    mesh = np.linalg.norm(across, axis=-1) / 2
    np.testing.assert_allclose(areas[0], mesh.sum(), rtol=1e-3)
    triangles = 6  # of the 8 in the four meshes around a point, two do not touch it
    assert (areas[0] - areas[1]) / mesh[3:5, 7:9].sum() == pytest.approx(triangles / 8, abs=0.02)


def test_the_flat_picture_has_both_flanks_at_one_scale(pinion: gm.Member) -> None:
    figures = flat_figures(view_of_settings(pinion))
    assert list(figures) == ["concave", "convex"]


def test_files_to_choose_are_of_their_kind_and_those_of_the_folder_come_first(tmp_path: Path) -> None:
    (tmp_path / "own.toml").write_bytes(bundled(SET).read_bytes())
    (tmp_path / "broken.toml").write_text("[", "utf-8")
    (tmp_path / ".hidden.toml").write_bytes(bundled(SET).read_bytes())
    sets = files_of("gear_set", tmp_path)
    assert next(iter(sets.items())) == (str(tmp_path / "own.toml"), "own.toml")
    assert SET in sets
    for other in ("design_7x43.toml", "vertical_5axis.toml", "probe.toml", "hobbing_plewes.toml"):
        assert other not in sets
    assert list(files_of("machine", tmp_path)) == ["vertical_5axis.toml", "vertical_5axis_counting.toml"]
    assert list(files_of("calibration", tmp_path)) == ["probe.toml"]
    assert {"hobbing_plewes.toml", "lathe_example.toml"} <= files_of("hobber", tmp_path).keys()


def test_without_a_store_there_is_no_run(tmp_path: Path) -> None:
    assert Desk(JudgedRuns(tmp_path / "runs.db")).shown_run() is None
