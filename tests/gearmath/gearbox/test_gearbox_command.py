"""``gearmath gearbox``: results as text and JSON, bad input in one sentence with status 2."""

import json
from fractions import Fraction

import pytest

from gearmath.cli import main
from gearmath.specs.toml import bundled


def gearmath(capsys, *arguments: str) -> tuple[int, str, str]:
    status = 0
    try:
        main(arguments)
    except SystemExit as stop:
        status = int(stop.code or 0)
    said = capsys.readouterr()
    return status, said.out, said.err


def test_plan_prints_the_job(capsys):
    status, out, err = gearmath(capsys, "gearbox", "plan", "hobbing_plewes.toml", "--teeth", "30", "--hob", "32dp")
    assert (status, err) == (0, "")
    assert "R = 192/25 = 7.68 " in out  # 30 x 4096 / 16000
    assert "1.0000 in" in out  # (30 + 2)/32
    assert "0.0703 in" in out  # 2.25/32
    assert "36dp" not in out


def test_plan_in_json_keeps_the_names_of_the_file(capsys, tmp_path):
    path = tmp_path / "my machine.toml"
    path.write_text(bundled("hobbing_metric.toml").read_text("utf-8"), "utf-8")
    arguments = ("gearbox", "plan", str(path), "--teeth", "20", "--starts", "2", "--rpm", "600", "--json")
    status, out, _ = gearmath(capsys, *arguments)
    job = json.loads(out)
    assert status == 0
    assert (job["teeth"], job["hob_starts"], job["rpm"]) == (20, 2, 600.0)
    assert Fraction(job["steps_numerator"], job["steps_denominator"]) == Fraction(2 * 16000, 20 * 4096)
    assert job["edge_rate_hz"] == 40960.0
    assert len(job["blanks"]) == 11


def test_simulate_reports_both_rules(capsys):
    arguments = (
        "gearbox",
        "simulate",
        "hobbing_plewes.toml",
        "--teeth",
        "25",
        "--pattern",
        "dither",
        "--edges",
        "100000",
    )
    status, out, _ = gearmath(capsys, *arguments)
    assert status == 0
    assert "exactly 5/32; the table ends at step 0" in out  # one edge away from rest is 4000/25600 step
    assert "the table ends at step -3125" in out
    status, out, _ = gearmath(capsys, *arguments, "--json")
    result = json.loads(out)
    assert (result["worst_error_exact"], result["position"], result["float_position"]) == ("5/32", 0, -3125)


def test_long_simulation_shows_its_progress(capsys, monkeypatch):
    monkeypatch.setattr("gearmath.cli.gearbox.LONG_RUN", 1000)
    monkeypatch.setattr("sys.stderr.isatty", lambda: True, raising=False)
    arguments = (
        "gearbox",
        "simulate",
        "hobbing_plewes.toml",
        "--teeth",
        "10",
        "--pattern",
        "forward",
        "--edges",
        "5000",
    )
    status, out, err = gearmath(capsys, *arguments)
    assert status == 0
    assert "worst error" in out
    assert "100%" in err


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("plan", "nowhere.toml", "--teeth", "10"), ("nowhere.toml", "hobbing_plewes.toml")),
        (("plan", "folder/nowhere.toml", "--teeth", "10"), ("folder/nowhere.toml", "cannot be read")),
        (("plan", "nasa_tp3096_12x36.toml", "--teeth", "10"), ("nasa_tp3096_12x36.toml", ":")),
        (("plan", "hobbing_plewes.toml", "--teeth", "0"), ("teeth = 0", "between 1 and 999")),
        (("plan", "hobbing_plewes.toml", "--teeth", "ten"), ("--teeth", "ten")),
        (("plan", "hobbing_plewes.toml"), ("--teeth",)),
        (("plan", "hobbing_plewes.toml", "--teeth", "10", "--hob", "m2"), ("m2", "m1")),
        (
            ("simulate", "hobbing_plewes.toml", "--teeth", "2", "--pattern", "forward", "--edges", "9"),
            ("125/64", "is 4"),
        ),
        (("simulate", "hobbing_plewes.toml", "--teeth", "10", "--pattern", "forward", "--edges", "0"), ("--edges",)),
        (
            ("simulate", "hobbing_plewes.toml", "--teeth", "10", "--pattern", "back", "--edges", "9"),
            ("back", "reversals"),
        ),
    ],
)
def test_bad_input_is_one_sentence_and_status_2(capsys, arguments, words):
    status, out, err = gearmath(capsys, "gearbox", *arguments)
    assert (status, out) == (2, "")
    assert err.startswith("gearmath: ")
    assert err.count("\n") == 1
    for word in words:
        assert word in err
