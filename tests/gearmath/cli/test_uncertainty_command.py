"""``gearmath uncertainty``: its table and JSON, where it takes the uncertainties of points from, and refusals."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest

from gearmath.bevel.flank import blank_grid, solve_flank
from gearmath.bevel.identify.flank_target import predicted
from gearmath.bevel.nominal_file import nominal_flank
from gearmath.quality.correction.member import correct
from gearmath.quality.correction.target import target_of
from gearmath.quality.evaluation.member import evaluate_member
from gearmath.quality.uncertainty.covariance import independent
from gearmath.quality.uncertainty.judged import judged_by_measured
from gearmath.quality.uncertainty.settings import noise_of
from gearmath.specs.bevel_set import FLANKS, SETTINGS, load_bevel_set
from gearmath.specs.flank_csv import join, read_flank_csv, write_flank_csv
from gearmath.specs.toml import bundled

SET = "nasa_tp3096_12x36.toml"


@pytest.fixture(scope="module")
def measured(tmp_path_factory, gear_set, shop):
    """A pinion cut with wrong settings, with uneven pitch: the grid of tooth 0, the reference point of the others."""
    spec, rng = gear_set.pinion, np.random.default_rng(1)
    grid, files = blank_grid(spec), []
    for flank in FLANKS:
        target = target_of(spec, flank, solve_flank(spec, flank, grid))
        form, _ = predicted(target, target.settings + shop.setting_errors("pinion"))
        for tooth in range(12):
            file = nominal_flank(spec, flank, grid, tooth=tooth)
            deviation = form + 2e-3 * rng.standard_normal() + 0.3e-3 * rng.standard_normal(45)
            file = replace(file, point=file.point + deviation[:, None] * file.normal, deviation=deviation)
            files.append(file if tooth == 0 else file.pick((file.row == 2) & (file.col == 4)))
    path = tmp_path_factory.mktemp("measured") / "m.csv"
    write_flank_csv(path, join(files))
    return path


def arguments(path, *more):
    return ("uncertainty", path, "--set", SET, "--member", "pinion", "--draws", 1000, *more)


def values(command, path, *more):
    status, out, err = command(*arguments(path, "--json", *more))
    assert (status, err) == (0, "")
    return json.loads(out)


def test_table_and_json_have_the_same_figures(command, measured):
    status, out, err = command(*arguments(measured))
    assert (status, err) == (0, "")
    *lines, remark = out.splitlines()
    assert remark.startswith("convex flank: tooth 0 is indexed by an arc of")
    first, head, *rows, concave, convex = lines
    source = "measurement.toml: Probing on a vertical machining centre"
    assumed = "(assumed: the file has no u_um; give --sigma-um or --model)"
    assert first == f"standard uncertainties from {source} {assumed}; 1000 draws"
    assert head.split() == ["flank", "figure", "value", "u", "from", "to", "unit", "method"]
    found = values(command, measured)
    figures = found["figures"]
    settings = sum(figure["unit"] in ("mm", "deg", "1") for figure in figures)
    assert 2 <= settings < 2 * 7  # the few that are corrected
    assert len(rows) == len(figures) == 2 + 1 + 2 * (6 + 10 + 1 + 12 + 2) + 2 + settings
    assert found["remarks"] == [remark]
    for line, flank in ((concave, "concave"), (convex, "convex")):
        assert line.startswith(f"{flank} flank: errors of measurement will leave ")
        assert float(line.split()[7]) == pytest.approx(found["caused_rms_um"][flank], abs=6e-4)
        assert float(line.split()[-2]) == pytest.approx(found["expected_u_um"][flank], abs=6e-4)
    for row, figure in zip(rows, figures, strict=True):
        cells = row.split(maxsplit=7)
        assert cells[:2] == [figure["flank"], figure["figure"]]
        assert [float(cell) for cell in cells[2:6]] == pytest.approx(
            [figure[name] for name in ("value", "u", "from", "to")], abs=6e-5
        )
        assert cells[6] == figure["unit"]
        assert cells[7] == figure["method"]
        assert figure["from"] <= figure["value"] <= figure["to"]


def test_corrected_settings_are_those_that_compensate_writes(command, measured, tmp_path):
    """At the same noise, which also damps what is hardly seen; figures are twice as unsure with twice the noise."""
    sharp, blunt = (
        {(one["flank"], one["figure"]): one for one in values(command, measured, "--sigma-um", sigma)["figures"]}
        for sigma in (0.3, 0.6)
    )
    names = [key for key, one in sharp.items() if one["unit"] in ("mm", "deg", "1")]
    assert 2 <= len(names) < 14  # the few that are corrected
    spec = load_bevel_set(bundled(SET)).pinion
    file = read_flank_csv(measured)
    found = evaluate_member(file, spec)
    judged = independent(np.full(len(file), 0.3e-3)).carried(judged_by_measured(file, spec, found))
    noise = noise_of(spec, found.file, judged)
    correction = correct(spec, found.file, few=True, noise=noise)
    for flank, name in names:
        vector = correction.settings[flank][SETTINGS.index(name)]
        value = np.degrees(vector) if sharp[flank, name]["unit"] == "deg" else vector
        u = sharp[flank, name]["u"]
        assert u > 0
        # weak directions carry the rounding of the processor some thousand times larger: a thousandth of u is none
        assert sharp[flank, name]["value"] == pytest.approx(value, abs=1e-3 * u)
    assert blunt["concave", "mean"]["u"] == pytest.approx(2 * sharp["concave", "mean"]["u"], rel=1e-9)


def test_half_a_measurement_says_why_there_are_no_settings(command, measured, tmp_path):
    file = read_flank_csv(measured)
    few = tmp_path / "few.csv"
    write_flank_csv(few, file.pick(file.flank == "concave"))
    found = values(command, few)
    assert {one["flank"] for one in found["figures"]} == {"concave"}
    assert found["caused_rms_um"] == {}
    assert found["remarks"] == [
        "not whole: convex flank: not measured at all",
        "no corrected settings: convex flank: 0 points were measured, the grid 5x9 needs them",
    ]


def test_uncertainty_of_points_comes_from_option_then_file_then_model(command, measured, tmp_path):
    """Mean of 45 points: u / sqrt(45) where they have nothing in common, and more with the model."""
    file = read_flank_csv(measured)
    stated = tmp_path / "stated.csv"
    write_flank_csv(stated, replace(file, uncertainty=np.full(len(file), 0.9e-3)))

    def mean(path, *more):
        found = values(command, path, "--no-register", "--no-rotation", *more)
        return found["source"], next(one["u"] for one in found["figures"] if one["figure"] == "mean")

    assert mean(stated) == ("u_um of the file", pytest.approx(0.9 / 45**0.5, rel=1e-9))
    assert mean(stated, "--sigma-um", 0.3) == ("0.3 um at every point", pytest.approx(0.3 / 45**0.5, rel=1e-9))
    source, u = mean(stated, "--model", "measurement.toml")
    assert source.startswith("measurement.toml")
    assert u > 0.3  # what the touches of a flank have in common, 0.3 um and more, no number of points takes away


def test_evaluation_shows_uncertainties_where_the_points_have_them(command, measured, tmp_path):
    arguments = ("evaluate", measured, "--set", SET, "--no-register", "--no-rotation")
    silent = json.loads(command(*arguments, "--json")[1])
    assert "uncertainty" not in silent
    assert "uncertainties" not in command(*arguments)[1]
    known = json.loads(command(*arguments, "--json", "--sigma-um", 0.45)[1])
    assert {key: value for key, value in known.items() if key != "uncertainty"} == silent
    mean = next(one for one in known["uncertainty"] if one["figure"] == "mean")
    assert mean["u"] == pytest.approx(0.45 / 45**0.5, rel=1e-9)
    assert mean["to"] - mean["value"] == pytest.approx(1.959964 * mean["u"], rel=1e-6)
    file = tmp_path / "stated.csv"
    points = read_flank_csv(measured)
    write_flank_csv(file, replace(points, uncertainty=np.full(len(points), 0.45e-3)))
    status, out, err = command("evaluate", file, "--set", SET)
    assert (status, err) == (0, "")
    lines = [line.split() for line in out.splitlines()]
    table = [line for line in lines if line[:2] == ["concave", "mean"]]
    assert [len(line) for line in table] == [5]
    assert any(line[:2] == ["both", "F_r"] for line in lines)


def test_compensation_shows_uncertainties_where_the_points_have_them(command, measured, tmp_path):
    arguments = ("compensate", SET, "--member", "pinion", "--measured", measured, "-o", tmp_path / "new.toml")
    assert "u" not in json.loads(command(*arguments, "--json")[1])
    known = json.loads(command(*arguments, "--json", "--sigma-um", 0.5)[1])
    whole = {(one["flank"], one["figure"]): one["u"] for one in values(command, measured, "--sigma-um", 0.5)["figures"]}
    for flank, settings in known["u"].items():
        assert 1 <= len(settings) < 7
        for name, u in settings.items():
            assert u == pytest.approx(whole[flank, name], rel=1e-3)  # an uncertainty has two or three digits
    known = json.loads(command(*arguments, "--json", "--sigma-um", 0.5, "--no-register", "--no-rotation")[1])
    for flank in FLANKS:
        # of 45 variances, what settings take up and what they leave make the whole, but for what damping does to both
        assert known["caused_rms_um"][flank] ** 2 + known["expected_u_um"][flank] ** 2 == pytest.approx(0.25, rel=0.05)
    status, out, _ = command(*arguments, "--noise", 0.5, "--verbose")
    assert status == 0
    head = next(line.split() for line in out.splitlines() if line.startswith("flank "))
    assert head == ["flank", "setting", "old", "new", "u", "unit"]
    assert "errors of measurement will leave" in out


def test_settings_that_are_not_determined_are_corrected_without_uncertainty(command, tmp_path, measured):
    """Cradle and work rotation do the same; almost no noise lets both move."""
    out = command(
        "compensate",
        SET,
        "--member",
        "pinion",
        "--measured",
        measured,
        "-o",
        tmp_path / "new.toml",
        "--json",
        "--settings",
        "cradle_angle,work_rotation_offset",
        "--sigma-um",
        1e-6,
    )[1]
    found = json.loads(out)
    assert "u" not in found
    assert "do not determine the settings" in found["no_uncertainties"]
    assert (tmp_path / "new.toml").exists()


def test_draws_do_not_depend_on_the_workers_and_go_on_from_their_file(command, measured, tmp_path):
    results = tmp_path / "r.npz"
    one, two = (values(command, measured, "--workers", n, "--sigma-um", 0.5) for n in (1, 2))
    assert one == two == values(command, measured, "--sigma-um", 0.5, "--resume", results)
    more = values(command, measured, "--sigma-um", 0.5, "--draws", 3000, "--resume", results)
    assert more == values(command, measured, "--sigma-um", 0.5, "--draws", 3000)
    assert more != one


def test_draws_of_a_cluster_are_the_same(command, measured):
    distributed = pytest.importorskip("distributed", reason="needs the extra 'cluster'")
    with distributed.LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster:
        there = values(command, measured, "--cluster", cluster.scheduler_address, "--workers", 2)
    assert there == values(command, measured)


def test_picture_is_a_png_and_its_path_is_printed(command, measured, tmp_path):
    status, out, _ = command(*arguments(measured, "--plot", tmp_path / "u.png"))
    assert (status, out.splitlines()[0]) == (0, f"picture: {tmp_path / 'u.png'}")
    assert (tmp_path / "u.png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize(
    ("more", "sentence"),
    [
        (("--sigma-um", 0), r"sigma-um"),
        (("--sigma-um", "nan"), r"sigma-um"),
        (("--sigma-um", 1, "--model", "measurement.toml"), r"only one can say how well"),
        (("--model", "absent.toml"), r"absent\.toml: cannot be read"),
        (("--model", "probe.toml"), r"probe\.toml: .*(missing|known)"),
        (("--draws", 10), r"draws"),
        (("--workers", 0), r"workers"),
    ],
)
def test_bad_options_are_refused_in_one_line(refused, measured, more, sentence):
    refused(sentence, *arguments(measured, *more))


def test_results_of_another_study_are_refused_by_their_name(command, refused, measured, tmp_path):
    results = tmp_path / "r.npz"
    values(command, measured, "--resume", results)
    refused(r"^gearmath: \S*r\.npz: study = .* another study", *arguments(measured, "--resume", results, "--seed", 1))
    results.write_text("1,2,3\n")
    refused(r"^gearmath: \S*r\.npz: is no results file of a study", *arguments(measured, "--resume", results))
    refused(r"cannot be written", *arguments(measured, "--resume", tmp_path / "absent" / "r.npz"))


def test_measurement_of_the_other_member_is_refused(refused, measured):
    refused(
        r"m\.csv: member = 'pinion' in the measured file: must be 'gear'",
        "uncertainty",
        measured,
        "--set",
        SET,
        "--member",
        "gear",
    )


def test_cluster_that_is_no_address_is_one_line(command, measured):
    pytest.importorskip("distributed", reason="needs the extra 'cluster'")
    status, out, err = command(*arguments(measured, "--cluster", "nowhere"))
    assert (status, out) == (1, "")
    assert err.startswith("gearmath: --cluster = nowhere: no scheduler answers: ")
    assert err.count("\n") == 1
