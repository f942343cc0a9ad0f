"""``gearmath contact``: its JSON by name and sign, text, picture, and what it refuses."""

from __future__ import annotations

import json
import math

import pytest

from gearmath.specs.toml import bundled

SET = "nasa_tp3096_12x36.toml"


@pytest.fixture(scope="module")
def nasa():
    """The JSON of the NASA pair, run once."""
    import contextlib
    import io

    from gearmath import cli

    out = io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.suppress(SystemExit):
        cli.main(["contact", SET, "--json"])
    return json.loads(out.getvalue())


def test_json_has_the_names_of_both_sides(nasa):
    assert set(nasa) == {"drive", "coast"}
    for side in nasa.values():
        assert {"outcome", "contact_ratio", "at_mean", "path", "peak_to_peak_arcsec", "v_h_mm"} <= set(side)
        assert {"pinion_rotation_deg", "second_derivative", "semi_axes_mm", "path_angle_deg"} <= set(side["at_mean"])
        assert list(side["v_h_mm"]) == ["toe", "mean", "heel"]
        for row in side["path"]:
            assert list(row) == [
                "pinion_rotation_deg",
                "kind",
                "transmission_error_arcsec",
                "gear_cone_distance_mm",
                "gear_height_mm",
                "gear_follows_arcsec",
                "second_derivative",
                "semi_axes_mm",
                "path_angle_deg",
            ]
            assert (row["semi_axes_mm"] is None) == (row["kind"] != "interior")


def test_whole_steps_are_whole_numbers_of_degrees(nasa):
    # of 1 degree, which is no whole number of radians
    assert {float(at) for at in range(-45, 46)} <= {row["pinion_rotation_deg"] for row in nasa["drive"]["path"]}


def test_positions_are_whole_steps_and_changes_of_kind(nasa):
    for side in nasa.values():
        rows = side["path"]
        at = [row["pinion_rotation_deg"] for row in rows]
        assert at == sorted(at)
        whole = [round(a) for a in at if abs(a - round(a)) < 1e-9]
        assert whole == list(range(-45, 46))
        between = [k for k, a in enumerate(at) if abs(a - round(a)) >= 1e-9]
        # a kind changes at a row between whole steps, and nowhere else
        assert all(rows[k - 1]["kind"] != rows[k + 1]["kind"] for k in between)
        changes = [k for k in range(1, len(rows)) if rows[k]["kind"] != rows[k - 1]["kind"]]
        assert all(any(abs(k - other) <= 1 for other in between) for k in changes)


def test_error_is_zero_at_rotation_zero_and_places_lie_on_the_flank(nasa):
    for side in nasa.values():
        (zero,) = [row for row in side["path"] if row["pinion_rotation_deg"] == 0]
        assert abs(zero["transmission_error_arcsec"]) < 1e-8
        for row in side["path"]:
            assert 68.3513 < row["gear_cone_distance_mm"] < 93.7515
            assert -5.6 < row["gear_height_mm"] < 1.9


def test_nasa_pair_is_said_to_lead_at_both_ends_and_to_run_on_edges(nasa, command):
    assert [side["outcome"] for side in nasa.values()] == ["reversed parabola"] * 2
    assert all("edge" in side["leading_kinds"] for side in nasa.values())
    status, out, err = command("contact", SET, "--step", 5)
    assert (status, err) == (0, "")
    assert out.startswith("drive: pinion concave with gear convex: reversed parabola, running on edge contact in turn")
    assert "coast: pinion convex with gear concave" in out


def test_displacement_of_the_pinion_moves_the_contact_as_its_sensitivity_says(nasa, command):
    by = 1e-3
    status, out, _ = command("contact", SET, "--h", by, "--json")
    assert status == 0
    for name, side in json.loads(out).items():
        before = {row["pinion_rotation_deg"]: row for row in nasa[name]["path"] if row["kind"] == "interior"}
        per_mm = nasa[name]["at_mean"]["sensitivity"]["h_per_mm"]["gear_cone_distance_mm"]
        at = float(round(nasa[name]["at_mean"]["pinion_rotation_deg"]))
        at = min(before, key=lambda a: abs(a - at))
        (after,) = [row for row in side["path"] if row["pinion_rotation_deg"] == at]
        moved = (after["gear_cone_distance_mm"] - before[at]["gear_cone_distance_mm"]) / by
        assert moved == pytest.approx(per_mm, rel=0.1)


def test_picture_is_written(command, tmp_path):
    target = tmp_path / "contact.png"
    status, out, err = command("contact", SET, "--step", 15, "--tolerance", "--plot", target)
    assert "none: reversed parabola as it stands" in out
    assert "pattern as it stands reaches" in out
    assert (status, err) == (0, "")
    assert str(target) in out
    assert target.read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize(
    ("sentence", "arguments"),
    [
        (r"--step 0: must lie between 0\.01 and 15 degrees", ["--step", 0]),
        (r"--step nan: must lie between", ["--step", "nan"]),
        (r"--v 51: must lie between -50 and 50 mm", ["--v", 51]),
        (r"--h nan: must lie between", ["--h", "nan"]),
        (r"--j -inf: must lie between", ["--j", "-inf"]),
        (r"--shaft 20: must lie between -10 and 10 degrees", ["--shaft", 20]),
    ],
)
def test_options_out_of_range_are_refused(refused, sentence, arguments):
    refused(sentence, "contact", SET, *arguments)


def test_offset_beyond_contact_is_refused_with_its_limit(refused):
    refused(
        rf"{SET}: --v 40: the flanks of the drive side lose contact; it may go to about 2\d\.\d mm$",
        "contact",
        SET,
        "--v",
        40,
    )


def test_displacement_that_binds_is_named_among_others(refused):
    refused(
        r"--v 40: .*it may go to about .* mm with the other displacements as given",
        "contact",
        SET,
        "--v",
        40,
        "--h",
        0.1,
    )


def test_set_of_one_member_is_refused(refused, tmp_path):
    text = bundled(SET).read_text("utf-8")
    alone = tmp_path / "pinion.toml"
    alone.write_text(text[: text.index("[gear]")], "utf-8")
    refused(r"pinion\.toml: has no gear, only a pinion", "contact", alone)


def test_line_contact_prints_without_figures_of_a_point(command, tmp_path, uniform_set):
    target = tmp_path / "uniform.toml"
    target.write_text(uniform_set, "utf-8")
    status, out, err = command("contact", target, "--json")
    assert (status, err) == (0, "")
    for side in json.loads(out).values():
        assert side["outcome"] == "line contact"
        assert side["at_mean"] is None
        assert side["peak_to_peak_arcsec"] < 1e-5
        assert side["contact_ratio"] > 1
    status, out, err = command("contact", target)
    assert (status, err) == (0, "")
    assert "line contact" in out


@pytest.fixture
def uniform_set() -> str:
    """A pair of uniform depth, both members cut by the two sides of one crown gear's teeth."""
    lines = ['title = "uniform depth"', 'source = "here"', "shaft_angle = 90.0"]
    spiral, alpha, radius, cone, depth = math.radians(35), math.radians(20), 100.0, 80.0, 2.6
    x, y = cone - radius * math.sin(spiral), radius * math.cos(spiral)
    # of both flanks of each member, by so much about its axis that a space is half a pitch wide at the pitch cone
    for name, teeth, sign in (("pinion", 14, -1), ("gear", 39, 1)):
        delta = math.atan2(teeth, 53 - teeth)
        angle = math.degrees(delta)
        lines += [
            f"[{name}]",
            f"teeth = {teeth}",
            f'hand = "{"right" if sign > 0 else "left"}"',
            'cutting = "fixed_setting"',
            f"[{name}.blank]",
            f"pitch_angle = {angle!r}",
            f"face_angle = {angle!r}",
            f"root_angle = {angle!r}",
            f"mean_cone_distance = {cone}",
            "face_width = 20.0",
            "mean_addendum = 2.1",
            f"mean_dedendum = {depth}",
            "clearance = 0.5",
        ]
        for flank, side in (("concave", 1), ("convex", -1)):
            quarter = side * sign * 90.0 / teeth
            lines += [
                f"[{name}.{flank}]",
                f"radial_distance = {math.hypot(x, y)!r}",
                f"cradle_angle = {sign * math.degrees(math.atan2(y, x))!r}",
                "cutter_tilt = 0.0",
                "cutter_swivel = 0.0",
                "blank_offset = 0.0",
                f"sliding_base = {-depth}",
                "machine_center_to_crossing_point = 0.0",
                f"machine_root_angle = {angle!r}",
                f"ratio_of_roll = {1 / math.sin(delta)!r}",
                f"work_rotation_offset = {quarter!r}",
                f"blade_point_radius = {radius - side * depth * math.tan(alpha)!r}",
                "blade_pressure_angle = 20.0",
                "blade_profile_height = 17.0",
            ]
    return "\n".join(lines) + "\n"


@pytest.fixture(scope="module")
def measured(tmp_path_factory):
    """Measured files of both members, off by 3 µm, each point known to 0.5 µm."""
    from dataclasses import replace

    import numpy as np

    import gearmath as gm

    files, folder = {}, tmp_path_factory.mktemp("measured")
    for name, change in (("pinion", {"radial_distance": 0.03}), ("gear", {"machine_root_angle": 0.01})):
        member = gm.load_set(SET).member(name).with_settings(concave=change, convex=change)
        off = member.deviations()
        file = replace(off.file, uncertainty=np.full(len(off.file), 0.0005))
        files[name] = replace(off, file=file).to_csv(folder / f"{name}.csv")
    return files


def test_measured_flanks_move_the_contact_and_have_uncertainties(nasa, command, measured):
    status, out, err = command(
        "contact",
        SET,
        "--step",
        15,
        "--json",
        "--measured-pinion",
        measured["pinion"],
        "--measured-gear",
        measured["gear"],
    )
    assert (status, err) == (0, "")
    for name, side in json.loads(out).items():
        assert set(side["measured"]) == {"pinion", "gear"}
        assert all(0.5 < one["rms_um"] < 20 for one in side["measured"].values())
        assert all(0 < value < 10 for value in side["uncertainty"].values())
        assert side["peak_to_peak_arcsec"] != nasa[name]["peak_to_peak_arcsec"]


def test_flanks_without_stated_uncertainty_have_none_and_nominal_ones_change_nothing(nasa, command, tmp_path):
    import gearmath as gm

    nominal = gm.load_set(SET).pinion.deviations().to_csv(tmp_path / "nominal.csv")
    status, out, err = command("contact", SET, "--json", "--measured-pinion", nominal)
    assert (status, err) == (0, "")
    for name, side in json.loads(out).items():
        assert side["uncertainty"] is None
        assert list(side["measured"]) == ["pinion"]
        assert side["peak_to_peak_arcsec"] == pytest.approx(nasa[name]["peak_to_peak_arcsec"], abs=1e-3)


def test_measurement_of_the_other_member_is_refused(refused, measured):
    refused(
        r"pinion\.csv: member = pinion: the measurement of the gear is wanted",
        "contact",
        SET,
        "--measured-gear",
        measured["pinion"],
    )


def test_measurement_without_a_whole_tooth_is_refused(refused, measured, tmp_path):
    lines = measured["pinion"].read_text("utf-8").splitlines()
    few = [line for line in lines if not line.startswith("pinion,") or ",2,4," in line[:24]]
    short = tmp_path / "short.csv"
    short.write_text("\n".join(few) + "\n", "utf-8")
    refused(r"short\.csv: ", "contact", SET, "--measured-pinion", short)
