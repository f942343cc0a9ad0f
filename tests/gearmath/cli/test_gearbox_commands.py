"""``gearmath gearbox``: results as text and JSON, bad input in one sentence with status 2."""

import json
import re
from fractions import Fraction
from pathlib import Path

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


def test_plan_of_a_helical_gear_says_how_to_set_and_check_it(capsys):
    arguments = ("gearbox", "plan", "hobbing_helical.toml", "--teeth", "30", "--helix", "20", "--hob", "m1")
    status, out, _ = gearmath(capsys, *arguments)
    assert status == 0
    assert "lead 275.5621 mm" in out  # field reference: 275.562
    assert "18.854 deg clockwise" in out  # 20° less the lead angle asin(1/50) = 1.146°, hob and gear of one hand
    status, out, _ = gearmath(capsys, *arguments, "--hand", "left", "--json")
    job = json.loads(out)
    assert (job["helix"]["hand"], job["helix"]["cut"]) == ("left", "climb")
    assert job["feed_numerator"] > 0 > -job["helix"]["error_bound_steps"] >= -0.01
    assert job["blanks"][0]["swivel"]["swivel"] == pytest.approx(21.14599, abs=1e-5)
    assert job["blanks"][0]["blank_diameter"] == pytest.approx(33.92533, abs=1e-5)  # 30/cos 20° + 2


def test_plan_of_a_shifted_gear_gives_the_published_span(capsys, tmp_path):
    """m = 3, z = 24, x = 0.4: 32.8266 mm over 4 teeth."""
    path = tmp_path / "machine.toml"
    path.write_text(bundled("hobbing_metric.toml").read_text("utf-8").replace("module = 1.5", "module = 3.0"), "utf-8")
    status, out, _ = gearmath(
        capsys, "gearbox", "plan", str(path), "--teeth", "24", "--hob", "m3", "--shift", "0.4", "--pin", "5.5"
    )
    assert status == 0
    assert "32.8266 mm" in out
    assert "over 4 teeth" in out
    assert "of 5.5 mm" in out


@pytest.mark.parametrize(
    ("job", "said"),
    [
        (("hobbing_helical.toml", "--teeth", "30", "--hob", "m1", "--helix", "20.12"), ""),
        (("hobbing_helical.toml", "--teeth", "30", "--hob", "m1", "--helix", "20.123"), "0.01 deg, 20.12"),
        (("hobbing_default.toml", "--teeth", "30", "--hob", "m1", "--helix", "20", "--feed", "0.25"), ""),
        (("hobbing_default.toml", "--teeth", "30", "--hob", "m1", "--helix", "20", "--feed", "0.255"), "0.01 mm, 0.2"),
        (("lathe_example.toml", "--pitch", "1.255mm"), ""),
        (("lathe_example.toml", "--pitch", "1.251mm"), "0.005 mm"),
        (("lathe_example.toml", "--pitch", "11.5tpi"), ""),
        (("lathe_example.toml", "--pitch", "11.4tpi"), "0.25 threads"),
        (("lathe_example.toml", "--pitch", "1.5m"), ""),
        (("lathe_example.toml", "--pitch", "16dp"), ""),
    ],
)
def test_plan_says_what_the_knob_cannot_be_turned_to(capsys, job, said):
    """GM_TPI_DETENT, GM_PITCH_DETENT, GM_HELIX_DETENT and GM_FEED_DETENT of gm_edit.c."""
    _, out, _ = gearmath(capsys, "gearbox", "plan", *job)
    assert ("not on the display" in out) == bool(said)
    assert said in out


def test_plan_says_when_the_firmware_would_refuse(capsys):
    _, out, _ = gearmath(capsys, "gearbox", "plan", "hobbing_plewes.toml", "--teeth", "4", "--hob", "m1")
    # 40 kHz / 4000 steps a turn, less 1 %; said before any figure
    assert out.splitlines()[1].startswith(
        "  REFUSED by the firmware as the machine file is: with limits.hob_rpm above 594"
    )


def test_plan_says_where_there_is_no_gear_or_an_undercut_one_and_what_cannot_be_measured(capsys):
    """m = 1: 2.25 mm of depth in a blank of 1.5 mm radius; 3 teeth are undercut, and no span or pins measure them."""
    main(["gearbox", "plan", "hobbing_default.toml", "--teeth", "1", "--hob", "m1"])
    said = capsys.readouterr().out
    assert "no gear: the depth of cut, 2.2500 mm, reaches the axis of a blank of 1.5000 mm radius" in said
    assert "chord" not in said
    main(["gearbox", "plan", "hobbing_default.toml", "--teeth", "3", "--hob", "m1"])
    said = capsys.readouterr().out
    assert "below 17.1 teeth; a profile shift of 0.825 modules or more" in said
    assert "span           none" in said
    assert "over pins      none" in said


@pytest.mark.parametrize(("teeth", "pins"), [(4, "none"), (6, "8.1600 mm"), (8, "10.1783 mm")])
def test_measurement_over_pins_of_an_undercut_gear_is_that_of_a_generated_profile(capsys, teeth, pins):
    """By a profile generated elsewhere with the basic rack A: 6 and 8 teeth keep the formula, 4 do not."""
    main(["gearbox", "plan", "hobbing_default.toml", "--teeth", str(teeth), "--hob", "m1"])
    assert re.search(rf"over pins\s+{pins}", capsys.readouterr().out)


def test_plan_of_a_thread(capsys):
    status, out, _ = gearmath(capsys, "gearbox", "plan", "lathe_example.toml", "--pitch", "11.5tpi", "--hand", "left")
    assert status == 0
    assert "left-hand thread of 2.2087 mm (11.5 tpi)" in out
    status, out, _ = gearmath(capsys, "gearbox", "plan", "lathe_example.toml", "--pitch", "1.27mm", "--json")
    job = json.loads(out)
    assert (job["pitch_exact"], job["lead"]) == ("127/100", 1.27)
    assert Fraction(job["steps_numerator"], job["steps_denominator"]) * 4000 / 4800 == Fraction(2, 5)  # 20 on 8 tpi


@pytest.mark.parametrize(
    "job",
    [
        ("hobbing_helical.toml", "--teeth", "31", "--helix", "15", "--hob", "m1.5"),
        ("hobbing_plewes.toml", "--teeth", "2"),
        ("hobbing_plewes.toml", "--teeth", "31", "--helix", "15", "--hob", "m1", "--feed", "0.25"),
        ("lathe_example.toml", "--pitch", "4.5mm", "--hand", "left"),
    ],
)
def test_simulate_holds_for_every_kind_of_job(capsys, job):
    arguments = ("gearbox", "simulate", *job, "--pattern", "reversals", "--edges", "200000", "--json")
    status, out, _ = gearmath(capsys, *arguments)
    result = json.loads(out)
    assert status == 0
    assert Fraction(result["worst_error_exact"]) <= Fraction(1, 2)


def test_simulate_draws_the_errors_over_time(capsys, tmp_path):
    path = tmp_path / "errors.png"
    arguments = ("hobbing_plewes.toml", "--teeth", "6", "--pattern", "forward", "--edges", "50000", "--plot", str(path))
    status, out, _ = gearmath(capsys, "gearbox", "simulate", *arguments, "--start", str(2**26))
    assert (status, out.splitlines()[0]) == (0, f"picture: {path}")
    assert path.read_bytes()[:8] == b"\x89PNG\r\n\x1a\n"


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
        (("plan", "hobbing_plewes.toml", "--teeth", "-7"), ("teeth = -7", "between 1 and 999")),
        (("plan", "hobbing_plewes.toml", "--teeth", "12", "--rpm", "900"), ("900", "800.0 rpm", "limits.hob_rpm")),
        (("plan", "hobbing_plewes.toml", "--teeth", "10", "--pitch", "2mm"), ("hobbing machine", "--teeth")),
        (("plan", "lathe_example.toml", "--teeth", "10"), ("lathe", "--pitch")),
        (("plan", "lathe_example.toml", "--pitch", "2inch"), ("2inch", "23/2tpi")),
        (("plan", "lathe_example.toml", "--pitch", "2mm", "--helix", "3"), ("--helix", "thread")),
        (("plan", "lathe_example.toml", "--pitch", "2mm", "--starts", "0"), ("starts = 0", "between 1 and 10")),
        (("plan", "lathe_example.toml", "--pitch", "2mm", "--rpm", "0"), ("rpm = 0", "positive")),
        (("plan", "hobbing_plewes.toml", "--teeth", "10", "--hand", "left"), ("--hand", "--helix")),
        (("plan", "hobbing_plewes.toml", "--teeth", "10", "--helix", "9", "--feed", "x"), ("feed = 'x'", "mm")),
        (("plan", "hobbing_plewes.toml", "--teeth", "10", "--helix", "9", "--hob", "m1"), ("helix = 9", "encoder")),
        (("plan", "hobbing_plewes.toml", "--teeth", "10", "--hob", "m2"), ("m2", "m1")),
        (
            ("plan", "hobbing_plewes.toml", "--teeth", "24", "--rpm", "nan"),
            ("rpm = nan", "limits.hob_rpm = 800"),
        ),
        (("plan", "hobbing_plewes.toml", "--teeth", "24", "--run-up", "-1"), ("run_up = -1", "between 0 and 600 s")),
        (("plan", "hobbing_plewes.toml", "--teeth", "24", "--run-up", "nan"), ("run_up = nan", "between 0 and 600 s")),
        (
            ("plan", "hobbing_plewes.toml", "--teeth", "24", "--hob", "m1", "--pin", "1e9"),
            ("pin = 1e+09", "24 teeth", "1.68 mm"),
        ),
        (("plan", "", "--teeth", "24"), ("must be named", "empty")),
        (
            ("simulate", "hobbing_plewes.toml", "--teeth", "9", "--pattern", "forward", "--edges", "9" * 23),
            ("edges = 999", "between 1 and 1000000000000"),
        ),
        (
            (
                "simulate",
                "lathe_example.toml",
                "--pitch",
                "1mm",
                "--pattern",
                "dither",
                "--edges=9",
                "--start",
                "9" * 20,
            ),
            ("start = 999", "between 0 and 4611686018427387904"),
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


PLEWES = bundled("hobbing_plewes.toml").read_text("utf-8")


@pytest.mark.parametrize("verb", ["plan", "teensy"])
@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ('name = "unsure"', 'name = "tb6560"', ("limits.step_rate_hz = 40000", "tb6560", "at most 3225")),
        ("[pins]", "[pins]\nindex = 13", ("pins.index = 13", "already that of step_out")),
        ('name = "unsure"', 'name = "nema"', ("driver.name = 'nema'", "known are gecko201")),
        ('decoder = "ls7184_x4"\n', "", ("encoder.decoder", "missing")),
        ('Machinist 15-4"', 'Machinist \\"15-4\\""', ("name = ", "plain letters")),
        ("lines = 1024", "lines = 10001", ("encoder.lines = 10001", "at most 10000 lines")),
        ("hob_rpm = 800.0", "hob_rpm = 1500.0", ("limits.hob_rpm = 1500", "at most 1464 rpm")),
    ],
)
def test_bad_machine_file_is_one_sentence_and_status_2_and_nothing_is_written(capsys, tmp_path, verb, old, new, words):
    assert old in PLEWES
    path = tmp_path / "machine.toml"
    path.write_text(PLEWES.replace(old, new, 1), "utf-8")
    commands = {
        "plan": ("gearbox", "plan", str(path), "--teeth", "10"),
        "teensy": ("export", "teensy", str(path), "-o", str(tmp_path / "out")),
    }
    status, out, err = gearmath(capsys, *commands[verb])
    assert (status, out) == (2, "")
    assert err.startswith(f"gearmath: {path}: ")
    assert err.count("\n") == 1
    for word in words:
        assert word in err
    assert sorted(Path(tmp_path).iterdir()) == [path]


def test_ratio_that_the_backlog_cannot_carry_is_one_sentence_and_status_2(capsys, tmp_path):
    path = tmp_path / "machine.toml"
    path.write_text(PLEWES.replace("lines = 1024", "lines = 200").replace("lag_steps = 100", "lag_steps = 2"), "utf-8")
    status, out, err = gearmath(capsys, "gearbox", "plan", str(path), "--teeth", "9")
    assert (status, out) == (2, "")
    assert "20/9 motor steps per encoder count" in err
    assert err.strip().endswith("the nearest tooth count that can be cut is 10")
