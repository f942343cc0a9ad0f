"""``gearmath gearbox cut``: figures, classes and what is to blame, as text, JSON, chart and points; refusals."""

from __future__ import annotations

import csv
import json
import re
from pathlib import Path

import numpy as np
import pytest

from gearmath.cli import main
from gearmath.specs.toml import bundled

ERRORS = """
[errors]
worm = [{ amplitude_arcsec = 90.0 }]
blank_eccentricity_um = 8.0
"""


def gearmath(capsys: pytest.CaptureFixture[str], *arguments: str) -> tuple[int, str, str]:
    status = 0
    try:
        main(arguments)
    except SystemExit as stop:
        status = int(stop.code or 0)
    said = capsys.readouterr()
    return status, said.out, said.err


def with_errors(folder: Path, text: str = ERRORS) -> Path:
    path = folder / "machine.toml"
    path.write_text(bundled("hobbing_metric.toml").read_text("utf-8") + text, "utf-8")
    return path


def test_cut_prints_figures_with_classes_and_names_the_largest_source(capsys, tmp_path):
    path = with_errors(tmp_path)
    status, out, err = gearmath(capsys, "gearbox", "cut", str(path), "--teeth", "24", "--hob", "m1", "--width", "8")
    assert (status, err) == (0, "")
    assert "module 1 mm" in out
    assert "assumed: the file has no diameter" in out
    assert "[unconfirmed]" in out
    lines = out[out.index("to blame") :].splitlines()
    assert lines[2].startswith("worm, once a turn of it")
    assert "change first: the worm" in out


def test_cut_in_json_has_every_figure_in_um_with_its_class_and_both_rules(capsys):
    arguments = (
        "--teeth",
        "12",
        "--hob",
        "m1",
        "--shift",
        "0.4",
        "--width",
        "5",
        "--seconds",
        "3600",
        "--compare",
        "float",
    )
    status, out, _ = gearmath(capsys, "gearbox", "cut", "hobbing_helical.toml", *arguments, "--json")
    found = json.loads(out)
    assert status == 0
    assert [gear["rule"] for gear in found["gears"]] == ["exact", "float"]
    exact, floating = ({row["figure"]: row for row in gear["figures"]} for gear in found["gears"])
    assert list(exact) == ["f_pt", "F_p", "F_r", "f_H_alpha", "f_f_alpha", "F_alpha", "f_H_beta", "f_f_beta", "F_beta"]
    assert floating["F_p"]["value_um"] > 2 * exact["F_p"]["value_um"]
    for row in exact.values():
        assert abs(row["value_um"]) <= row["tolerance_um"]
    assert found["gears"][0]["accuracy_class"] == max(row["accuracy_class"] for row in exact.values())
    shares = np.array(
        [[one[f"{kind}_percent"] for kind in ("profile", "helix", "pitch")] for one in found["contributions"]]
    )
    assert shares.sum(axis=0) == pytest.approx(100.0)


@pytest.mark.parametrize("suffix", ["png", "svg", "html"])
def test_cut_draws_the_chart_of_an_inspection(capsys, tmp_path, suffix):
    chart = tmp_path / f"chart.{suffix}"
    arguments = ("--teeth", "20", "--hob", "m1", "--width", "5", "--feed", "1", "--plot", str(chart))
    status, out, _ = gearmath(capsys, "gearbox", "cut", "hobbing_default.toml", *arguments)
    assert status == 0
    assert f"chart: {chart}" in out
    content = chart.read_bytes()
    if suffix == "png":
        assert content.startswith(b"\x89PNG")
    else:
        for words in (b"profile, left flank", b"helix, right flank", b"pitch, left flank", b"runout"):
            assert words in content
    if suffix == "html":  # columns of the tables stay columns
        heads = re.findall(r"<thead><tr>(.*?)</tr></thead>", content.decode("utf-8"))
        assert [re.findall(r">([^<]+)</th>", head) for head in heads] == [
            ["figure", "exact / um", "class"],
            ["source", "profile", "helix", "pitch"],
        ]


def test_cut_writes_points_that_lie_on_the_involute(capsys, tmp_path):
    """Of a spur gear of 24 teeth, m 1: the distance of each normal from the axis is the base radius 12 cos 20°."""
    path = tmp_path / "points.csv"
    arguments = ("--teeth", "24", "--hob", "m1", "--width", "5", "--feed", "1", "--csv", str(path))
    assert gearmath(capsys, "gearbox", "cut", "hobbing_default.toml", *arguments)[0] == 0
    rows = list(csv.DictReader(line for line in path.read_text("utf-8").splitlines() if not line.startswith("#")))
    assert {(row["trace"], row["flank"], row["tooth"]) for row in rows} >= {
        ("profile", "left", "6"),
        ("helix", "right", "18"),
    }
    for row in rows[::50]:
        x, y, nx, ny = (float(row[key]) for key in ("x", "y", "nx", "ny"))
        assert abs(x * ny - y * nx) == pytest.approx(12 * np.cos(np.radians(20)), abs=1e-5)
        assert x * nx + y * ny == pytest.approx(float(row["roll_length"]), abs=1e-5)


def test_cut_writes_the_gear_as_a_closed_stl(capsys, tmp_path):
    """12 teeth, x = 0.4, 5 mm wide: every edge is that of two facets, and the whole is as large as such a gear."""
    path = tmp_path / "gear.stl"
    arguments = ("--teeth", "12", "--hob", "m1", "--shift", "0.4", "--width", "5", "--feed", "1", "--stl", str(path))
    assert gearmath(capsys, "gearbox", "cut", "hobbing_default.toml", *arguments)[0] == 0
    record = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
    corners = np.frombuffer(path.read_bytes()[84:], record)["corners"]
    edges = {
        (a.tobytes(), b.tobytes()) for facet in corners for a, b in zip(facet, np.roll(facet, -1, axis=0), strict=True)
    }
    assert len(edges) == 3 * len(corners)
    assert all((b, a) in edges for a, b in edges)
    points = corners.reshape(-1, 3)
    assert np.hypot(points[:, 0], points[:, 1]).max() == pytest.approx(7.4, abs=0.01)  # r + m (1 + x)
    assert (points[:, 2].min(), points[:, 2].max()) == pytest.approx((0.0, 5.0), abs=0.01)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("hobbing_default.toml",), "give --teeth"),
        (("hobbing_default.toml", "--teeth", "24", "--pitch", "2mm"), "--pitch has no meaning for a gear"),
        (("hobbing_default.toml", "--teeth", "24", "--length", "50"), "--length has no meaning for a gear"),
        (("lathe_example.toml",), "give --pitch"),
        (("lathe_example.toml", "--pitch", "2mm", "--helix", "3"), "--helix has no meaning for a thread"),
        (("lathe_example.toml", "--pitch", "2mm", "--width", "7"), "--width has no meaning for a thread"),
        (("lathe_example.toml", "--pitch", "2mm", "--feed", "0.5"), "--feed has no meaning for a thread"),
        (("lathe_example.toml", "--pitch", "2mm", "--csv", "points.csv"), "--csv has no meaning for a thread"),
        (("lathe_example.toml", "--pitch", "2mm", "--starts", "0"), "starts = 0"),
        (("lathe_example.toml", "--pitch", "2mm", "--hob-shift", "3"), "--hob-shift has no meaning for a thread"),
        (("hobbing_default.toml", "--teeth", "24", "--hob-shift", "nan"), "--hob-shift = nan"),
        (("hobbing_helical.toml", "--teeth", "24", "--helix", "-20"), "--hand says which way"),
        (("hobbing_default.toml", "--teeth", "24", "--csv", "a.out", "--stl", "./a.out"), "--csv is written there"),
        (("hobbing_default.toml", "--teeth", "24", "--feed", "nan"), "--feed = nan"),
        (("hobbing_default.toml", "--teeth", "24", "--hob", "m7"), "hob = 'm7'"),
        (("hobbing_default.toml", "--teeth", "24", "--hand", "left"), "--hand has no meaning without --helix"),
        (("hobbing_default.toml", "--teeth", "24", "--plot", "chart.pdf"), "must end in .png, .svg or .html"),
        (("hobbing_default.toml", "--teeth", "24", "--rpm", "9000"), "rpm = 9000"),
        (
            ("hobbing_helical.toml", "--teeth", "24", "--helix", "20", "--rule", "float", "--hob", "m1"),
            "the floating rule of the source text knows no encoder on the feed",
        ),
    ],
)
def test_what_cannot_be_cut_is_refused_in_one_sentence(capsys, arguments, words):
    status, out, err = gearmath(capsys, "gearbox", "cut", *arguments)
    assert (status, out) == (2, "")
    assert words in err
    assert len(err.strip().splitlines()) == 1


HOB = """
[[hobs]]
module = 1.0
depth_rule = "2.25m"
diameter = 50.0
length = 40.0
tip_radius = 0.25
protuberance = 0.05
topping = true
gash_lead = 2000.0
"""


def with_hob(folder: Path, given: str = "", instead: str = "") -> Path:
    """The metric machine with one hob, that of HOB, changed."""
    text = bundled("hobbing_metric.toml").read_text("utf-8")
    assert given in HOB
    path = folder / "machine.toml"
    path.write_text(text[: text.index("[[hobs]]")] + HOB.replace(given, instead), "utf-8")
    return path


def test_cut_with_everything_that_a_hob_may_have_says_so_in_json_and_text(capsys, tmp_path):
    path = with_hob(tmp_path)
    arguments = ("--teeth", "24", "--width", "3", "--feed", "1", "--rule", "ideal", "--hob-shift", "5")
    status, out, _ = gearmath(capsys, "gearbox", "cut", str(path), *arguments, "--json")
    assert status == 0
    found = json.loads(out)
    hob = found["hob"]
    assert (hob["protuberance"], hob["topping"], hob["gash_lead"], hob["shift"]) == (0.05, True, 2000.0, 5.0)
    low, high = hob["shift_range"]
    assert high - low == pytest.approx(40.0 - found["generating_length"])
    tip = next(each for each in found["gears"][0]["thickness"] if each["what"] == "tip radius")
    assert 13.0 < tip["mean"] < 13.01


@pytest.mark.parametrize(
    ("given", "instead", "words"),
    [
        ("protuberance = 0.05", "protuberance = 0.001", "protuberance = 0.001: must be at least 0.0038 modules"),
        ("protuberance = 0.05", "protuberance = -1.0", "hobs #1.protuberance = -1.0: must be at least 0"),
        ("protuberance = 0.05", "protuberance_angle = 9.0", "protuberance_angle has no meaning without protuberance"),
        ("gash_lead = 2000.0", "gash_lead = 20.0", "gash_lead = 20: must be at least 5 diameters, 250 mm"),
        ("gash_lead = 2000.0", "gash_lead = nan", "hobs #1.gash_lead = nan"),
        ("gash_lead = 2000.0", "protuberance_angle = 19.0", "protuberance_angle = 19: must be at most 18 degrees"),
        ("topping = true", "topping = 1", "hobs #1.topping = 1: must be true or false"),
    ],
)
def test_hob_that_cannot_be_is_refused_by_file_and_key(capsys, tmp_path, given, instead, words):
    path = with_hob(tmp_path, given, instead)
    status, out, err = gearmath(capsys, "gearbox", "cut", str(path), "--teeth", "24")
    assert (status, out) == (2, "")
    assert "machine.toml: hobs #1" in err
    assert words in err
    assert len(err.strip().splitlines()) == 1


@pytest.mark.parametrize(
    ("section", "words"),
    [
        ("[errors]\nworm = [{ amplitude_arcsec = -1.0 }]\n", ("machine.toml", "amplitude_arcsec", "-1")),
        ("[errors]\nwrom = []\n", ("machine.toml", "wrom")),
        ("[errors]\nhob_starts_um = [0.0, 5.0]\n", ("hob_starts_um has 2 values", "1 start")),
        ("[errors]\nblank_eccentricity_um = nan\n", ("machine.toml", "blank_eccentricity_um")),
    ],
)
def test_errors_that_cannot_be_are_refused_by_file_and_key(capsys, tmp_path, section, words):
    path = with_errors(tmp_path, "\n" + section)
    status, _, err = gearmath(capsys, "gearbox", "cut", str(path), "--teeth", "24", "--hob", "m1")
    assert status == 2
    assert len(err.strip().splitlines()) == 1
    for word in words:
        assert word in err
