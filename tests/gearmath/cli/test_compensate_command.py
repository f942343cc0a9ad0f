"""``gearmath compensate`` with its options, and ``gearmath stock``, on measurements of every cutting method."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from datetime import UTC, datetime, timedelta

import numpy as np
import pytest

from gearmath.bevel.flank import blank_grid, solve_flank
from gearmath.bevel.identify.flank_target import predicted
from gearmath.bevel.identify.variables import NAMES, whole
from gearmath.bevel.method import cut_generation_of
from gearmath.bevel.nominal_file import flank_header
from gearmath.quality.correction.target import target_of
from gearmath.specs.bevel_set import FLANKS, design_sha256, load_bevel_set, settings_sha256
from gearmath.specs.flank_csv import flank_file, join, read_flank_csv, write_flank_csv
from gearmath.specs.toml import bundled

ERRORS = {"radial_distance": 0.03, "sliding_base": 0.01, "machine_root_angle": 2e-4}
UNIVERSAL, HOBBED = "crown_gear_universal_14x39.toml", "crown_gear_hobbed_14x39.toml"
STEEP = "spiral_7x43.toml"


def left_by(member, flank, **errors):
    """Deviations of a flank whose machine is off by ``errors``, by names of settings and motions (dots as __)."""
    target = target_of(member, flank, solve_flank(member, flank, blank_grid(member)))
    change = np.zeros(83)
    for key, value in errors.items():
        change[NAMES.index(key.replace("__", "."))] = value
    return target, predicted(target, target.vector + change)[0]


@pytest.fixture
def measured(tmp_path):
    """``measured(set_name, name, **errors)``: the file of a member, one tooth, no noise."""

    def make(source, name, extra=None, **errors):
        member = load_bevel_set(source).member(name)
        files = []
        for flank in FLANKS:
            target, deviation = left_by(member, flank, **errors)
            row, col = (index.ravel() for index in np.indices((5, 9)))
            if extra is not None:
                deviation = deviation + extra(row, col)
            point = target.nominal.point + deviation[:, None] * target.nominal.normal
            header = flank_header(member, (5, 9))
            files.append(flank_file(header, name, flank, 0, row, col, point, target.nominal.normal, deviation))
        path = tmp_path / f"{name}.csv"
        write_flank_csv(path, join(files))
        return path

    return make


def worst_after(path, name, **errors):
    """Largest deviation of the flanks that a corrected set cuts on the machine with those errors.

    But for a rotation of the work common to both: how the work stood was left open.
    """
    member = load_bevel_set(path).member(name)
    targets, deviations = zip(*(left_by(member, flank, **errors) for flank in FLANKS), strict=True)
    deviation = np.concatenate(deviations)
    column = np.concatenate([predicted(t, t.vector)[1][:, NAMES.index("work_rotation_offset")] for t in targets])
    return np.abs(deviation - column * (column @ deviation) / (column @ column)).max()


@pytest.mark.parametrize("name", ["pinion", "gear"])
@pytest.mark.parametrize("source", ["spiral_7x43.toml", "crown_gear_formate_14x39.toml", UNIVERSAL, HOBBED])
def test_corrected_set_cuts_the_nominal_flank_on_the_machine_that_errs(command, measured, tmp_path, source, name):
    csv, new = measured(bundled(source), name, **ERRORS), tmp_path / "new.toml"
    status, out, err = command("compensate", source, "--member", name, "--measured", csv, "-o", new)
    assert (status, err) == (0, "")
    lines = out.splitlines()
    lines = lines[[line[:4] for line in lines].index("RMS:") :]  # what the measurement looks like besides comes first
    assert re.match(
        r"RMS: concave 0\.[01]\d um expected to remain of \d+\.\d\d um \(\w+ [+-]0\.\d{4} (mm|deg)", lines[0]
    )
    assert "no limit binds" in lines[1]
    assert worst_after(bundled(source), name, **ERRORS) > 5e-3
    assert worst_after(new, name, **ERRORS) < 4e-4  # the few lose 0.1 um in the RMS, what a probe resolves
    pair, old = load_bevel_set(new), load_bevel_set(bundled(source))
    assert design_sha256(pair.member(name)) == design_sha256(old.member(name))
    assert settings_sha256(pair.member(name)) != settings_sha256(old.member(name))


def test_hobbed_member_measured_with_its_pitch_is_corrected_without_index_corrections(command, measured, tmp_path):
    """A set with index corrections of a hobbed member is refused: its spaces are cut together."""
    csv, new = measured(bundled(HOBBED), "pinion", **ERRORS), tmp_path / "new.toml"
    tooth_0 = read_flank_csv(csv)
    reference = tooth_0.pick((tooth_0.row == 2) & (tooth_0.col == 4))
    teeth = [tooth_0]
    for tooth in range(1, 14):
        angle = 2 * np.pi * tooth / 14
        turn = np.array([[np.cos(angle), np.sin(angle), 0], [-np.sin(angle), np.cos(angle), 0], [0, 0, 1]])
        pitch = 0.002 * np.sin(angle) * np.where(reference.flank == "concave", -1.0, 1.0)  # both flanks the same way
        moved = (reference.point + pitch[:, None] * reference.normal) @ turn
        place = {"tooth": 0 * reference.tooth + tooth, "point": moved, "normal": reference.normal @ turn}
        teeth.append(replace(reference, deviation=reference.deviation + pitch, **place))
    write_flank_csv(csv, join(teeth))
    assert json.loads(command("evaluate", csv, "--set", HOBBED, "--json")[1])["flanks"]["concave"]["F_p_um"] > 3
    base = ("compensate", HOBBED, "--measured", csv, "-o", new)
    status, out, err = command(*base)
    assert (status, err) == (0, "")
    assert "no index corrections: face hobbing indexes without end, and no space can be turned by itself" in out
    assert out.splitlines()[-1] == f"{new}: written"
    assert load_bevel_set(new).pinion.index_correction == ()
    assert worst_after(new, "pinion", **ERRORS) < 4e-4
    assert json.loads(command(*base, "--json")[1])["index_correction_deg"] == []


def test_corrected_set_says_what_it_was_corrected_from_and_when(command, measured, tmp_path):
    """And points of it are said to be nominal ones."""
    before, target = datetime.now(UTC), tmp_path / "corrected.toml"
    file = measured(bundled(STEEP), "pinion", radial_distance=0.03)
    assert command("compensate", STEEP, "--measured", file, "-o", target)[0] == 0
    head = target.read_text("utf-8").splitlines()[0]
    found = re.match(
        rf"# Corrected settings of the pinion, from pinion\.csv and {STEEP}, (\S+ \S+) UTC, gearmath "
        r"\S+; nominal ones: under design\.$",
        head,
    )
    when = datetime.strptime(found[1], "%Y-%m-%d %H:%M").replace(tzinfo=UTC)
    assert before - timedelta(minutes=1) <= when <= datetime.now(UTC)
    points = ("points", target, "--member", "pinion", "--flank", "convex", "-o", tmp_path / "points.txt")
    assert "the nominal flank, by the settings under 'design'" in command("export", *points)[1]
    assert "nominal" not in command("export", "points", STEEP, *points[2:])[1]


def test_tables_are_shown_when_asked_and_standard_settings_leave_nothing(command, measured, tmp_path):
    source, new = "spiral_7x43.toml", tmp_path / "new.toml"
    csv = measured(bundled(source), "pinion", **ERRORS)
    base = ("compensate", source, "--member", "pinion", "--measured", csv, "-o", new, "--settings", "standard")
    short, full = command(*base)[1], command(*base, "--verbose")[1]
    assert full.startswith("\n".join(short.splitlines()[:2]))
    for table in (
        "by a linear estimate without bounds",
        "singular values [um]:",
        "together move the flank by only",
        "root line",
    ):
        assert table in full
        assert table not in short
    assert worst_after(new, "pinion", **ERRORS) < 2e-5


def test_motions_are_corrected_when_asked_and_kept_in_the_file(command, measured, tmp_path):
    errors = {"work_rotation_offset__2": 2e-3, "sliding_base__1": 0.1}
    csv = measured(bundled(UNIVERSAL), "pinion", **errors)
    rest, moving = tmp_path / "rest.toml", tmp_path / "moving.toml"
    # the work of these files stands as it was cut: with its rotation left open, a motion of it could be a rotation too
    base = ("compensate", UNIVERSAL, "--member", "pinion", "--no-rotation", "--settings", "standard", "--measured", csv)
    assert command(*base, "-o", rest)[0] == 0
    values = json.loads(command(*base, "--higher-order", "-o", moving, "--json")[1])
    assert worst_after(moving, "pinion", **errors) < 0.5 * worst_after(rest, "pinion", **errors)
    assert worst_after(moving, "pinion", **errors) < 1e-4  # what errors and changes do together, to second order
    changed = {change["setting"]: change for change in values["changes"] if change["flank"] == "concave"}
    assert changed["work_rotation_offset.2"]["unit"] == "deg/rad^2"
    assert changed["sliding_base.1"]["unit"] == "mm/rad"
    old, new = (load_bevel_set(path).pinion for path in (bundled(UNIVERSAL), moving))
    assert new.concave.nominal_motion == old.concave.motion
    assert new.concave.motion.modified_roll == old.concave.motion.modified_roll
    assert design_sha256(new) == design_sha256(old)
    how = cut_generation_of(new, "concave")
    np.testing.assert_allclose(
        whole(how.settings, how.motion)[NAMES.index("sliding_base.1")],
        cut_generation_of(old, "concave").motion[5, 0]
        + changed["sliding_base.1"]["new"]
        - old.concave.motion.sliding_base[0],
        atol=1e-9,
    )
    # a second round starts from the corrected file and its own design
    again = measured(moving, "pinion", **errors)
    status, out, err = command(
        "compensate",
        moving,
        "--member",
        "pinion",
        "--measured",
        again,
        "--no-rotation",
        "--higher-order",
        "--settings",
        "standard",
        "-o",
        tmp_path / "2.toml",
    )
    assert (status, err) == (0, ""), out
    assert worst_after(tmp_path / "2.toml", "pinion", **errors) < 1e-4


def test_few_or_named_settings_are_changed_and_no_others(command, measured, tmp_path):
    csv = measured(bundled(HOBBED), "gear", **ERRORS)
    base = ("compensate", HOBBED, "--member", "gear", "--measured", csv, "-o", tmp_path / "new.toml", "--json")
    few = json.loads(command(*base, "--settings", "few")[1])
    assert len(few["fits"][0]["settings"]) < 7
    assert {change["setting"] for change in few["changes"]} <= set(few["fits"][0]["settings"])
    named = json.loads(command(*base, "--settings", "sliding_base, radial_distance")[1])
    assert {change["setting"] for change in named["changes"]} == {"sliding_base", "radial_distance"}
    every = json.loads(command(*base, "--settings", "all")[1])
    assert len(every["fits"][0]["settings"]) == 10
    # without tilt the swivel only turns the blades about the cutter's axis, which in face hobbing indexes the work
    assert {"cutter_swivel", "work_rotation_offset"} in [set(pair[:2]) for pair in every["fits"][0]["alike"]]
    surface = json.loads(command(*base, "--objective", "surface")[1])
    assert surface["fits"][0]["remaining_rms_um"] < 0.05


def test_curvature_of_a_blade_is_corrected_when_named_and_kept_in_the_file(command, measured, tmp_path):
    """A blade that was ground with a radius of 5 m: the next one gets as much the other way; straight is wanted."""
    source, errors = "nasa_tp3096_12x36.toml", {"blade_spheric_radius": 2e-4}
    csv, new = measured(bundled(source), "pinion", **errors), tmp_path / "new.toml"
    base = ("compensate", source, "--member", "pinion", "--measured", csv, "-o", new, "--json")
    values = json.loads(command(*base, "--settings", "blade_spheric_radius")[1])
    assert {change["setting"] for change in values["changes"]} == {"blade_spheric_radius"}
    for flank in FLANKS:
        spec = load_bevel_set(new).pinion.flank(flank)
        assert spec.blade_spheric_radius == pytest.approx(-5000, rel=2e-3)  # the opposite of 2 um, to second order
        assert spec.nominal_spheric_radius is None
    assert worst_after(bundled(source), "pinion", **errors) > 2e-3
    assert worst_after(new, "pinion", **errors) < 1e-5
    old, now = load_bevel_set(bundled(source)).pinion, load_bevel_set(new).pinion
    assert design_sha256(now) == design_sha256(old)
    assert settings_sha256(now) != settings_sha256(old)


def test_errors_of_the_gear_are_corrected_on_the_pinion(command, measured, tmp_path):
    source = "nasa_tp3096_12x36.toml"
    gear, pinion = measured(bundled(source), "gear", **ERRORS), measured(bundled(source), "pinion")
    base = ("compensate", source, "--member", "pinion", "--measured", pinion, "-o", tmp_path / "new.toml", "--json")
    assert max(json.loads(command(*base)[1])["fits"][0]["rms_um"], 0) < 1e-3
    values = json.loads(command(*base, "--from-mate", gear)[1])
    for fit in values["fits"]:
        assert fit["rms_um"] > 3
        assert fit["remaining_rms_um"] < 0.1 * fit["rms_um"]


def test_teeth_are_left_thicker_when_asked(command, measured, tmp_path):
    source, csv = "nasa_tp3096_12x36.toml", measured(bundled("nasa_tp3096_12x36.toml"), "gear")
    base = ("compensate", source, "--member", "gear", "--measured", csv, "-o", tmp_path / "new.toml", "--json")
    values = json.loads(command(*base, "--thickness", "30", "--thickness-by", "sliding_base")[1])
    moved = {change["setting"]: change["new"] - change["old"] for change in values["changes"]}
    assert moved["sliding_base"] > 0.03
    status, _, err = command(*base, "--thickness", "30")
    assert status == 2
    assert "thickness can only come from the sliding_base" in err


def test_point_that_missed_is_left_out_and_said(command, measured, tmp_path):
    def missed(row, col):
        return np.where((row == 1) & (col == 6), 0.3, 0.0)

    csv = measured(bundled(HOBBED), "pinion", missed, **ERRORS)
    arguments = ("compensate", HOBBED, "--member", "pinion", "--measured", csv, "-o", tmp_path / "new.toml")
    status, out, _ = command(*arguments)
    assert status == 0
    assert "concave flank, tooth 0, row 1, col 6" in out
    assert "1 point of the grid was left out" in out
    assert worst_after(tmp_path / "new.toml", "pinion", **ERRORS) < 1e-4


@pytest.mark.parametrize(
    ("options", "sentence"),
    [
        (("--settings", "radius"), r"pinion\.csv: setting = 'radius': must be one of radial_distance"),
        (("--settings", "sliding_base,sliding_base"), "is named twice"),
        (("--root-limit", "0"), "root-limit"),
        (("--objective", "lines"), "objective"),
        (("--from-mate", "absent.csv"), r"absent\.csv: cannot be read"),
    ],
)
def test_bad_options_are_one_line(refused, measured, tmp_path, options, sentence):
    csv = measured(bundled(UNIVERSAL), "pinion")
    target = tmp_path / "new.toml"
    refused(sentence, "compensate", UNIVERSAL, "--member", "pinion", "--measured", csv, "-o", target, *options)
    assert not target.exists()


def test_stock_of_a_blank_is_shared_or_refused(command, refused, measured):
    source = "nasa_tp3096_12x36.toml"
    csv = measured(bundled(source), "gear", lambda row, col: np.full(len(row), 0.1), work_rotation_offset=5e-4)
    values = json.loads(command("stock", csv, "--set", source, "--member", "gear", "--json")[1])
    assert values["least_um"]["concave"] == pytest.approx(values["least_um"]["convex"], abs=1e-6)
    assert min(values["least_um"].values()) > min(values["least_before_um"].values()) + 5
    # φ_0 turns the work back: the blank that it has turned by -φ_0 is turned on by it
    assert np.radians(values["turn_deg"]) == pytest.approx(5e-4, rel=0.02)
    status, out, _ = command("stock", csv, "--set", source, "--member", "gear", "--advance")
    assert status == 0
    assert "turn the work by" in out
    assert "advance it by" in out
    status, _, err = command("stock", csv, "--set", source, "--member", "gear", "--least", "500")
    assert status == 1
    assert "does not clean up" in err
    refused("member = 'gear'", "stock", csv, "--set", source, "--member", "pinion")
