"""``gearmath evaluate`` and ``gearmath compensate``, and the whole loop from verb to verb."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest

from gearmath.quality.evaluation.pitch import evaluate_pitch
from gearmath.specs.bevel_set import load_bevel_set
from gearmath.specs.flank_csv import read_flank_csv, write_flank_csv
from gearmath.specs.toml import bundled

SET = "nasa_tp3096_12x36.toml"


@pytest.fixture(scope="module")
def measured(tmp_path_factory, mill, gear_set, shop):
    """The pinion from the simulated shop, all teeth, as a file."""
    path = tmp_path_factory.mktemp("measured") / "m.csv"
    write_flank_csv(path, mill(gear_set, "pinion", range(12), shop))
    return path


@pytest.mark.parametrize("member", ["pinion", "gear"])
def test_the_loop_from_verb_to_verb(command, tmp_path, member):
    """nc cut, mill with errors, evaluate, compensate, and the same again with the corrected set."""
    source, figures = SET, []
    for cycle in (1, 2):
        program, csv, new = (
            tmp_path / f"{name}_{cycle}{end}"
            for name, end in (("PART", ".MPF"), ("measured", ".csv"), ("corrected", ".toml"))
        )
        assert command("nc", "cut", source, "--member", member, "-o", program)[::2] == (0, "")
        assert command(
            "mill", source, "--member", member, "--program", program, "--errors", "simulated_shop.toml", "-o", csv
        )[::2] == (0, "")
        turned = ["--no-rotation"] if cycle == 1 else []  # what a machine finds of the part as it stands on it
        status, out, _ = command("evaluate", csv, "--set", source, "--json", *turned)
        assert status == 0
        figures.append(json.loads(out)["flanks"])
        assert command("compensate", source, "--member", member, "--measured", csv, "-o", new)[::2] == (0, "")
        source = new
    first, second = (
        [max(abs(flank[name]) for flank in figure.values()) for name in ("max_deviation_um", "F_p_um")]
        for figure in figures
    )
    assert 20 < first[0] < 32
    assert second[0] < 3  # two deviations of 0.5 µm noise more than the best fit
    assert second[1] < first[1] / 2
    load_bevel_set(source)


def test_evaluation_prints_a_table_and_json_with_the_same_figures(command, measured):
    status, out, err = command("evaluate", measured, "--set", SET)
    assert (status, err) == (0, "")
    lines = out.splitlines()
    first = next(k for k, line in enumerate(lines) if line.startswith("flank"))
    assert all(line.startswith("withheld: grade of F_r") for line in lines[:first] if line)
    head, *rows = [line.split() for line in lines[first : first + 3]]
    assert head == ["flank", "max_deviation_um", "rms_um", "cubic_surface_residual_um", "F_p_um", "max_f_pt_um"]
    values = json.loads(command("evaluate", measured, "--set", SET, "--json")[1])
    assert values["member"] == "pinion"
    for row in rows:
        flank = values["flanks"][row[0]]
        assert [float(cell) for cell in row[1:]] == pytest.approx([flank[name] for name in head[1:]], abs=6e-4)
        assert len(flank["surface_coefficients"]) == 10
    assert {row[0] for row in rows} == {"concave", "convex"}
    assert f"runout F_r {values['runout']['F_r_um']:.2f} ± {values['runout']['u_F_r_um']:.2f} um, normal to" in out
    seat = values["registration"]  # three u are not reached: it stays in
    assert seat["taken_out"] is False
    size, u = seat["eccentricity_um"], seat["u_eccentricity_um"]
    assert f"clamping not taken out: eccentricity {size:.2f} um (u = {u:.2f} um)" in out
    turn = values["rotation"]
    assert turn["angle_arcsec"] == pytest.approx(turn["angle_deg"] * 3600, rel=1e-12)
    assert turn["arc_um"] == pytest.approx(np.radians(turn["angle_deg"]) * turn["radius_mm"] * 1000, rel=1e-12)
    assert f"rotation common to both flanks taken out: {turn['angle_deg']:+.6f} deg = " in out
    left_in = json.loads(command("evaluate", measured, "--set", SET, "--no-rotation", "--json")[1])
    assert left_in["rotation"] is None
    assert left_in["thickness"]["arc_deviation_um"] == pytest.approx(values["thickness"]["arc_deviation_um"], abs=0.01)
    assert left_in["flanks"]["convex"]["F_p_um"] == pytest.approx(values["flanks"]["convex"]["F_p_um"], abs=0.01)
    assert "grades: f_pt " in out
    assert "no conformity claimed" in out
    assert "no conformity claimed" in values["tolerance"]["remark"]


def test_figures_are_those_of_the_points_in_the_file(command, measured):
    """Largest deviation and RMS worked from the text of the CSV alone."""
    rows = [line.split(",") for line in measured.read_text().splitlines() if line.startswith("pinion,")]
    arguments = ("evaluate", measured, "--set", SET, "--no-register", "--no-rotation", "--json")
    values = json.loads(command(*arguments)[1])["flanks"]
    for flank in ("concave", "convex"):
        here = np.array([float(row[11]) for row in rows if row[1] == flank and row[2] == "0"])
        assert len(here) == 45
        assert abs(values[flank]["max_deviation_um"]) == pytest.approx(np.abs(here).max(), abs=1e-6)
        assert values[flank]["rms_um"] == pytest.approx(np.sqrt(np.mean(here**2)), abs=1e-6)


def unplanned(path):
    """The lines of a file without the one that says how many points were planned, for other points than these."""
    return [line for line in path.read_text("utf-8").splitlines() if not line.startswith("# planned")]


def test_miss_and_tooth_0_measured_again_come_through_the_file(command, measured, tmp_path):
    """The text of the CSV: a point of the grid 0.3 mm off along its normal, and tooth 0 once more, 2 um higher."""
    lines, changed_rows = unplanned(measured), []
    for line in lines:
        cells = line.split(",")
        if line.startswith(("pinion,concave,0,1,3,", "pinion,concave,0,2,4,", "pinion,convex,0,2,4,")):
            off = 0.3 if cells[3] == "1" else 0.002
            moved = [f"{float(cells[5 + k]) + off * float(cells[8 + k]):.9f}" for k in range(3)]
            other = [*cells[:5], *moved, *cells[8:11], f"{float(cells[11]) + 1000 * off:.6f}", cells[12]]
            if cells[3] == "1":
                lines[lines.index(line)] = ",".join(other)
            else:
                changed_rows.append(",".join([*other[:2], "12", *other[3:]]))
    path = tmp_path / "again.csv"
    path.write_text("\n".join([*lines, *changed_rows]) + "\n", "utf-8")
    values = json.loads(command("evaluate", path, "--set", SET, "--json")[1])
    clean = json.loads(command("evaluate", measured, "--set", SET, "--json")[1])
    assert values["drift_um"] == {flank: pytest.approx(2, abs=1e-5) for flank in ("concave", "convex")}
    (miss,) = (remark for remark in values["remarks"] if "left out" in remark)
    assert miss.startswith("concave flank, tooth 0, row 1, col 3: +")
    for flank in ("concave", "convex"):
        assert values["flanks"][flank]["max_f_pt_um"] == pytest.approx(clean["flanks"][flank]["max_f_pt_um"], abs=0.5)
    assert values["flanks"]["concave"]["left_out"] == 1
    out = command("evaluate", path, "--set", SET, "--no-register")[1]
    assert "concave flank: tooth 0 measured again at the end: +2.00 um, taken out evenly" in out
    assert "clamping" not in out


@pytest.mark.parametrize(("shift", "said"), [(0.0, False), (0.02, True)])
def test_axial_position_is_spoken_of_where_the_noise_does_not_explain_it(command, measured, tmp_path, shift, said):
    """0.5 um of noise on a perfect pinion say nothing of the axis; 20 um along it do, n_z of them at every point."""
    file = read_flank_csv(measured)
    nominal = file.point - file.deviation[:, None] * file.normal
    noise = np.random.default_rng(10).normal(0, 0.5e-3, len(file.deviation))
    deviation = noise + shift * file.normal[:, 2]
    path = tmp_path / "axial.csv"
    write_flank_csv(path, replace(file, deviation=deviation, point=nominal + deviation[:, None] * file.normal))
    status, out, err = command("evaluate", path, "--set", SET)
    assert (status, err) == (0, "")
    assert ("axial position not corrected" in out) == said


def test_pitch_alone_is_evaluated(command, measured, tmp_path):
    """What ``nc probe --topography none`` leads to: the reference point of every tooth, in figures and as text."""
    lines = unplanned(measured)
    path = tmp_path / "pitch.csv"
    path.write_text("\n".join(x for x in lines if not x.startswith("pinion") or ",2,4," in x) + "\n", "utf-8")
    values = json.loads(command("evaluate", path, "--set", SET, "--json")[1])["flanks"]["concave"]
    assert "rms_um" not in values
    status, out, err = command("evaluate", path, "--set", SET)
    assert (status, err) == (0, "")
    assert "first and second order" not in out
    assert f"{values['F_p_um']:.3f}" in out


def test_picture_is_a_png_and_its_path_is_printed_beside_json(command, measured, tmp_path):
    target = tmp_path / "t.png"
    status, out, err = command("evaluate", measured, "--set", SET, "--json", "--plot", target)
    assert (status, err) == (0, f"picture: {target}\n")
    assert json.loads(out)["member"] == "pinion"
    assert (tmp_path / "t.png").read_bytes().startswith(b"\x89PNG")


def test_compensation_says_what_it_changed_and_writes_it(command, measured, tmp_path):
    target = tmp_path / "new.toml"
    arguments = ("compensate", SET, "--member", "pinion", "--measured", measured, "-o", target)
    values = json.loads(command(*arguments, "--json")[1])
    new = load_bevel_set(target).pinion
    assert values["changes"]
    for change in values["changes"]:
        assert getattr(new.flank(change["flank"]), change["setting"]) == pytest.approx(change["new"], abs=1e-8)
        assert change["unit"] == {"ratio_of_roll": "1"}.get(
            change["setting"], "deg" if change["setting"].endswith("angle") else "mm"
        )
    np.testing.assert_allclose(new.index_correction, values["index_correction_deg"], rtol=0, atol=1e-7)
    status, out, _ = command(*arguments)
    assert status == 0
    assert all(change["setting"] in out for change in values["changes"])
    assert "expected to remain" in out
    assert "with index corrections for every tooth" in out


def test_index_correction_takes_back_the_pitch_that_was_measured(command, measured, tmp_path):
    """By hand from the file: the mean turning of both flanks, with the other sign, counted from the other teeth.

    The settings put right where teeth 1 to 11 stand, not tooth 0, which was measured in full.
    """
    target = tmp_path / "new.toml"
    command("compensate", SET, "--member", "pinion", "--measured", measured, "--no-register", "-o", target)
    file = read_flank_csv(measured)
    turning = np.mean([evaluate_pitch(file, 12, flank).turning for flank in ("concave", "convex")], axis=0)
    wanted = -np.degrees(turning - turning[1:].mean())
    np.testing.assert_allclose(load_bevel_set(target).pinion.index_correction, wanted, rtol=0, atol=1e-7)


def test_a_point_that_missed_is_left_out_of_the_correction_in_words(command, measured, tmp_path):
    """0.3 mm at one point of the grid changes the corrected settings by far less than what it would pull them by."""
    text = measured.read_text("utf-8")
    line = next(x for x in text.splitlines() if x.startswith("pinion,concave,0,1,3,"))
    cells = line.split(",")
    moved = [f"{float(cells[5 + k]) + 0.3 * float(cells[8 + k]):.9f}" for k in range(3)]
    other = ",".join([*cells[:5], *moved, *cells[8:11], f"{float(cells[11]) + 300:.6f}", cells[12]])
    path, clean, dirty = (tmp_path / name for name in ("miss.csv", "clean.toml", "dirty.toml"))
    path.write_text(text.replace(line, other), "utf-8")
    assert command("compensate", SET, "--member", "pinion", "--measured", measured, "-o", clean)[0] == 0
    out = command("compensate", SET, "--member", "pinion", "--measured", path, "-o", dirty)[1]
    assert "concave flank, tooth 0, row 1, col 3: +" in out
    one, two = (load_bevel_set(target).pinion.concave.radial_distance for target in (clean, dirty))
    assert one == pytest.approx(two, abs=0.05)


def changed(measured, tmp_path, old: str, new: str, count: int = 1):
    text = measured.read_text("utf-8")
    assert old in text
    path = tmp_path / "bad.csv"
    path.write_text(text.replace(old, new, count), "utf-8")
    return path


@pytest.mark.parametrize(
    ("old", "new", "sentence"),
    [
        ("# unit: mm", "# unit: inch", "unit = 'inch': must be mm"),
        ("# grid: 5x9", "# grid: five", "grid = 'five': must read like 5x9"),
        ("# margins: 0.1,0.1", "# margins: much", "margins = 'much': must"),
        ("# reference_point: 2,4", "# reference_point: 9,9", "reference_point = 9,9: must lie in the grid 5x9"),
        ("# member_teeth: 12", "# member_teeth: 13", "member_teeth = 13: the pinion of the set has 12"),
        ("# settings_sha256: ", "# settings_sha256: 0", "settings_sha256 = 0.*other nominal settings"),
        ("pinion,concave,0,0,0,", "pinion,concave,0,0,0,nan", "line 13: x = 'nan.*': must be a finite number"),
        ("pinion,concave,0,0,0,", "pinion,concave,0,0,0,1", "beside the nominal normal|length"),
        ("pinion,concave,5,", "pinion,concave,4,", "tooth 4, row 2, col 4 is there twice"),
    ],
)
def test_bad_measurement_is_one_line_with_its_file_and_writes_nothing(refused, measured, tmp_path, old, new, sentence):
    path = changed(measured, tmp_path, old, new)
    refused(
        r"^gearmath: .*bad\.csv.*(" + sentence + ")",
        "compensate",
        SET,
        "--member",
        "pinion",
        "--measured",
        path,
        "-o",
        tmp_path / "new.toml",
    )
    assert [entry.name for entry in tmp_path.iterdir()] == ["bad.csv"]


@pytest.mark.parametrize(
    ("name", "content", "sentence"),
    [
        ("absent.csv", None, "cannot be read: No such file"),
        ("noise.csv", b"\x89PNG\r\n", "is no text file"),
        ("empty.csv", b"", "is no flank file"),
        ("long.csv", b"x" * 200_000, "is no flank file"),
    ],
)
@pytest.mark.parametrize("verb", ["evaluate", "compensate"])
def test_unreadable_measurement_is_one_line_with_its_file(refused, tmp_path, verb, name, content, sentence):
    path = tmp_path / name
    if content is not None:
        path.write_bytes(content)
    target = tmp_path / "out.png"
    arguments = {
        "evaluate": ("evaluate", path, "--set", SET, "--plot", target),
        "compensate": ("compensate", SET, "--member", "pinion", "--measured", path, "-o", target),
    }[verb]
    refused(rf"{name}.*{sentence}", *arguments)
    assert not target.exists()


def test_measurement_of_the_other_member_is_refused(refused, measured, tmp_path):
    refused(
        r"m\.csv: member = 'pinion' in the measured file: must be 'gear'",
        "compensate",
        SET,
        "--member",
        "gear",
        "--measured",
        measured,
        "-o",
        tmp_path / "new.toml",
    )
    assert list(tmp_path.iterdir()) == []


def test_measurement_of_another_set_is_refused(refused, measured, tmp_path):
    other = tmp_path / "other.toml"
    text = bundled(SET).read_text("utf-8").replace("radial_distance = 74.874171554126", "radial_distance = 74.9")
    other.write_text(text, "utf-8")
    refused(r"m\.csv: settings_sha256 = ", "evaluate", measured, "--set", other)
    refused(
        r"m\.csv: settings_sha256 = ",
        "compensate",
        other,
        "--member",
        "pinion",
        "--measured",
        measured,
        "-o",
        tmp_path / "new.toml",
    )
    assert [entry.name for entry in tmp_path.iterdir()] == ["other.toml"]


def test_nominal_file_is_refused(command, refused, tmp_path):
    path = tmp_path / "nominal.csv"
    assert command("flank", SET, "--member", "pinion", "--flank", "concave", "-o", path)[0] == 0
    refused(r"nominal\.csv: .*nominal file", "evaluate", path, "--set", SET)
    refused(
        r"nominal\.csv: .*nominal file",
        "compensate",
        SET,
        "--member",
        "pinion",
        "--measured",
        path,
        "-o",
        tmp_path / "new.toml",
    )
    assert not (tmp_path / "new.toml").exists()


def test_target_that_cannot_be_written_leaves_nothing_behind(refused, measured, tmp_path):
    target = tmp_path / "absent" / "new.toml"
    refused("cannot be written", "compensate", SET, "--member", "pinion", "--measured", measured, "-o", target)
    refused("cannot be written", "evaluate", measured, "--set", SET, "--plot", tmp_path / "absent" / "t.png")
    assert list(tmp_path.iterdir()) == []
