"""``gearmath nc cut`` and ``gearmath mill``: from a set to a program, from the program to measured flanks."""

from __future__ import annotations

import json
import re
import tomllib

import numpy as np
import pytest
import tomlkit

from gearmath.machine.control.executor import execute
from gearmath.machine.writing.cutting import cutting_program
from gearmath.specs.flank_csv import read_flank_csv
from gearmath.specs.toml import bundled

SET = "nasa_tp3096_12x36.toml"
CUT = ("nc", "cut", SET, "--member", "pinion")


@pytest.fixture(scope="module")
def pinion_program(tmp_path_factory, gear_set, vertical):
    """The program of one space of the pinion, as a file."""
    path = tmp_path_factory.mktemp("program") / "PINION.MPF"
    path.write_text(cutting_program(gear_set, "pinion", vertical, "PINION"), "utf-8")
    return path


def test_program_is_called_like_its_file_and_runs_on_the_reader(command, tmp_path):
    target = tmp_path / "PINION_A.MPF"
    status, out, err = command(*CUT, "--spaces", "0,3,3", "-o", target)
    assert (status, err) == (0, "")
    assert "2 of 12 spaces" in out
    text = target.read_text("ascii")
    assert text.startswith("; PINION_A\n")
    assert text.endswith("M30\n")
    assert execute(text, "P.MPF").tools == ("PINION_CONCAVE", "PINION_CONVEX")


def test_tolerance_feed_and_speed_reach_the_program(command, tmp_path):
    for name, options in (("FINE", ()), ("COARSE", ("--tolerance-um", "5", "--feed", "150", "--rpm", "90"))):
        assert command(*CUT, "--spaces", "0", *options, "-o", tmp_path / f"{name}.MPF")[0] == 0
    fine, coarse = ((tmp_path / f"{name}.MPF").read_text("ascii") for name in ("FINE", "COARSE"))
    assert fine.count("G93") > 4 * coarse.count("G93")
    assert "S90.000 M3" in coarse
    times = []
    for text in (fine, coarse):
        path = execute(text, "P.MPF")
        times.append(path.seconds[~path.rapid & ~np.roll(path.rapid, 1)].sum())  # without plunging
    assert times[1] / times[0] == pytest.approx(2, rel=0.01)  # half the default feed of 300 mm/min


@pytest.mark.parametrize("member", ["pinion", "gear"])
@pytest.mark.parametrize("name", ["spiral_7x43", "crown_gear_formate_14x39", "crown_gear_hobbed_14x39"])
def test_program_with_roughing_and_finishing_stock_passes_its_own_check_and_that_of_mill(
    command, tmp_path, name, member
):
    stocks = ("--roughing-stock", "0.3", "--finishing-stock", "0.1", "--tolerance-um", "1")
    spaces = () if "hobbed" in name else ("--spaces", "0,3")
    cut = ("nc", "cut", f"{name}.toml", "--member", member, *stocks, *spaces, "-o", tmp_path / "STOCK.MPF")
    assert command(*cut)[0] == 0
    mill = ("mill", f"{name}.toml", "--member", member, "--program", tmp_path / "STOCK.MPF", "-o", tmp_path / "m.csv")
    status, out, err = command(*mill)
    assert (status, err) == (0, "")
    assert "passed" in out
    left = read_flank_csv(tmp_path / "m.csv").deviation
    assert left.min() == pytest.approx(0.1, abs=0.001)  # the flatter blade leaves the stock, a steeper one more


def test_program_that_gouges_the_opposite_flank_is_not_written(refused, tmp_path):
    values = tomllib.loads(bundled("crown_gear_universal_14x39.toml").read_text("utf-8"))
    del values["gear"]  # which would tell that they are no mates
    values["pinion"]["concave"]["motion"]["sliding_base"][0] *= -1
    (tmp_path / "set.toml").write_text(tomlkit.dumps(values), "utf-8")
    target = tmp_path / "GOUGES.MPF"
    cut = ("nc", "cut", tmp_path / "set.toml", "--member", "pinion", "--tolerance-um", "5", "-o", target)
    refused("gouges the convex flank of space 0: -163.* um, the limit is -6 um: the program is not written", *cut)
    assert not target.exists()


def test_milling_without_errors_leaves_at_most_a_tenth_of_a_micrometre(command, tmp_path, pinion_program):
    status, out, err = command("mill", SET, "--member", "pinion", "--program", pinion_program, "-o", tmp_path / "m.csv")
    assert (status, err) == (0, "")
    file = read_flank_csv(tmp_path / "m.csv")
    assert np.abs(file.deviation).max() <= 1e-4
    assert len(file) == 90
    assert "90 points, largest deviation 0.0" in out


def test_milling_with_errors_shows_them(command, tmp_path, pinion_program):
    arguments = ("mill", SET, "--member", "pinion", "--program", pinion_program, "--errors", "simulated_shop.toml")
    assert command(*arguments, "-o", tmp_path / "m.csv")[0] == 0
    file = read_flank_csv(tmp_path / "m.csv")
    assert 0.018 < np.abs(file.deviation).max() < 0.032
    np.testing.assert_allclose(file.uncertainty, 5e-4)
    assert command(*arguments, "-o", tmp_path / "again.csv")[0] == 0
    assert (tmp_path / "again.csv").read_bytes() == (tmp_path / "m.csv").read_bytes()


@pytest.mark.parametrize(
    ("options", "sentence"),
    [
        (("--spaces", "12"), "--spaces 12: must be all, or numbers from 0 to 11"),
        (("--spaces", "0;1"), "--spaces 0;1: must"),
        (("--spaces", ""), "--spaces : must"),
        (("--spaces", "-1"), "--spaces -1: must"),
        (("--tolerance-um", "0"), "tolerance = 0 um: must lie between 0.01 and 100 um"),
        (("--tolerance-um", "nan"), "tolerance = nan um: must lie"),
        (("--feed", "-3"), r"feed = -3.0 mm/min: must be greater than 0"),
        (("--feed", "nan"), r"feed = nan mm/min: must"),
        (("--rpm", "1"), "spindle speed = 1.0 rpm: .* 20 to 3000 rpm"),
        (("--machine", "absent.toml"), r"absent\.toml: cannot be read"),
        (("--machine", "nasa_tp3096_12x36.toml"), r"nasa_tp3096_12x36\.toml: \w+.*: no such key"),
    ],
)
def test_bad_cut_is_one_line_and_writes_nothing(refused, tmp_path, options, sentence):
    refused(sentence, *CUT, *options, "-o", tmp_path / "PART.MPF")
    assert list(tmp_path.iterdir()) == []


def test_travel_beyond_the_machine_is_one_line_with_axis_value_and_limit(refused, tmp_path):
    text = bundled("vertical_5axis.toml").read_text("utf-8")
    machine = tmp_path / "small.toml"
    machine.write_text(text.replace("travel = [-400.0, 400.0]", "travel = [-40.0, 40.0]"), "utf-8")
    target = tmp_path / "out" / "PART.MPF"
    target.parent.mkdir()
    sentence = r"axis [XY] = -?\d+\.\d{5} mm at cradle angle .* deg: .* travels -40 to 40 mm"
    refused(sentence, *CUT, "--machine", machine, "-o", target)
    assert list(target.parent.iterdir()) == []


def test_wrong_digit_is_named_with_its_line(command, tmp_path, pinion_program):
    """Z of one block 10 um too high: more than the 0.1 um that the program states, and off its way."""
    lines = pinion_program.read_text("ascii").split("\n")
    cuts = [k for k, line in enumerate(lines) if " G93 " in line]
    k = cuts[len(cuts) // 4]
    z = next(word for word in lines[k].split() if word[0] == "Z")
    lines[k] = lines[k].replace(z, f"Z{float(z[1:]) + 0.01:.5f}")
    wrong = tmp_path / "WRONG.MPF"
    wrong.write_text("\n".join(lines), "ascii")
    milling = ("mill", SET, "--member", "pinion", "-o", tmp_path / "m.csv", "--program")
    status, out, err = command(*milling, pinion_program)
    assert (status, err) == (0, "")
    assert "every block checked on " in out
    assert out.splitlines()[-1].startswith(f"{pinion_program}: passed: 1 of 12 spaces within 0.1 um, nothing collides")
    status, out, err = command(*milling, wrong)
    assert status == 1
    assert err.startswith(f"gearmath: {wrong}: line ")
    assert "the program states 0.1 um" in err
    assert f"line {k + 1} ends 0.010000 mm beside the path" in err
    assert err.endswith(": refused\n")
    assert (tmp_path / "m.csv").exists()  # what the metal looks like is written all the same


def test_metal_of_a_wrong_machine_is_not_judged_by_the_tolerance_of_the_program(command, tmp_path, pinion_program):
    status, out, err = command(
        "mill",
        SET,
        "--member",
        "pinion",
        "--program",
        pinion_program,
        "--errors",
        "simulated_shop.toml",
        "-o",
        tmp_path / "m.csv",
    )
    assert (status, err) == (0, "")
    assert (
        out.splitlines()[-1]
        == "the flanks are not compared with a tolerance: the machine has the errors of simulated_shop.toml"
    )


def test_blocks_are_counted_without_comments(command, tmp_path):
    target = tmp_path / "PINION_A.MPF"
    _, out, _ = command(*CUT, "--spaces", "0", "-o", target)
    numbers = [int(line[1:].split()[0]) for line in target.read_text("ascii").splitlines() if not line.startswith(";")]
    assert out.endswith(f"1 of 12 spaces, {len(numbers)} blocks\n")
    assert numbers[-1] == 10 * len(numbers)


@pytest.mark.parametrize("word", ["UPROG", "CALL", "L100"])
def test_subprograms_are_refused_with_line_and_column(refused, tmp_path, pinion_program, word):
    program = tmp_path / "SUB.MPF"
    program.write_text(pinion_program.read_text("ascii").replace("M30", word), "ascii")
    refused(
        rf"SUB\.MPF, line \d+, column \d+: .*{word}'? is not understood",
        "mill",
        SET,
        "--member",
        "pinion",
        "--program",
        program,
        "-o",
        tmp_path / "m.csv",
    )
    assert not (tmp_path / "m.csv").exists()


@pytest.mark.parametrize("name", ["1ST.MPF", "P-1.MPF", "A_PROGRAM_NAME_THAT_IS_TOO_LONG.MPF", "COM1.MPF"])
def test_file_name_that_is_no_program_name_is_refused(refused, tmp_path, name):
    refused(f"-o {tmp_path / name}: program name ", *CUT, "-o", tmp_path / name)
    assert list(tmp_path.iterdir()) == []


def test_a_text_without_motion_is_told_before_a_member_is_asked_for(refused, tmp_path):
    (tmp_path / "EMPTY.MPF").write_text("; X1 Y2\nN10 M30\n", "ascii")
    told = r"EMPTY\.MPF: moves no axis, so that it is no cutting program"
    refused(told, "mill", SET, "--program", tmp_path / "EMPTY.MPF", "-o", tmp_path / "m.csv")


def test_bad_milling_is_one_line_and_writes_nothing(refused, tmp_path, pinion_program):
    target = tmp_path / "out" / "m.csv"
    target.parent.mkdir()
    text = pinion_program.read_text("ascii")
    programs = {
        "line 1, column 1: a line with % is read only as %_N_NAME_MPF": "%\n" + text,
        "the text ends within the IF of line": text[: len(text) // 2].rsplit("\n", 1)[0],
        r"the program does not cut the concave flank of the pinion": "M30\n",
        r'cuts with T="HOB"; the pinion is cut with PINION_CONCAVE and PINION_CONVEX': text.replace(
            "PINION_CONCAVE", "HOB"
        ),
    }
    for number, (sentence, content) in enumerate(programs.items()):
        path = tmp_path / f"P{number}.MPF"
        path.write_text(content)
        refused(rf"P{number}\.MPF.*{sentence}", "mill", SET, "--member", "pinion", "--program", path, "-o", target)
    good = ("mill", SET, "--member", "pinion", "-o", target, "--program")
    refused(r"absent\.MPF: cannot be read", *good, tmp_path / "absent.MPF")
    refused(r"PINION\.MPF.*the gear is cut with GEAR", *good[:3], "gear", *good[4:], pinion_program)
    refused(r"errors\.toml: cannot be read", *good, pinion_program, "--errors", "errors.toml")
    refused(r"vertical_5axis\.toml: ", *good, pinion_program, "--errors", "vertical_5axis.toml")
    broken = tmp_path / "PINION.MPF"
    broken.write_bytes(b"\xff" + text.encode())
    refused(r"PINION\.MPF, line 1, column 1: the character '.xff' may stand in comments and texts only", *good, broken)
    assert list(target.parent.iterdir()) == []


@pytest.mark.slow
def test_measured_member_is_evaluated_as_its_clamping_says(command, refused, tmp_path):
    """nc cut, mill --measured, evaluate: 15 um and 10 um per 100 mm come back."""
    gear_set, program, target = "spiral_7x43.toml", tmp_path / "PINION.MPF", tmp_path / "M.csv"
    assert command("nc", "cut", gear_set, "--member", "pinion", "-o", program)[0] == 0
    milling = ["mill", gear_set, "--member", "pinion", "--program", program, "--measured", "-o", target]
    refused("--measured needs --errors", *milling)
    status, out, err = command(*milling, "--errors", "source_experiment.toml")
    assert status == 0, err
    assert "160 points" in out  # 90, five on each flank of six teeth, five again on each flank of tooth 0
    status, out, err = command("evaluate", target, "--set", gear_set, "--json")
    assert status == 0, err
    seat = json.loads(out)["registration"]
    assert seat["eccentricity_um"] == pytest.approx(15.0, abs=4 * seat["u_eccentricity_um"])
    assert seat["tilt_um_per_100mm"] == pytest.approx(10.0, abs=4 * seat["u_tilt_um_per_100mm"])


def test_program_off_the_path_of_the_settings_is_a_failure_of_status_1(command, tmp_path, pinion_program):
    """Run with setting errors, whose roll position is sought on the path of the set: 5 mm beside it in X."""
    moved = tmp_path / "PINION.MPF"
    text = pinion_program.read_text("utf-8")
    moved.write_text(re.sub(r"\bX(-?[\d.]+)", lambda word: f"X{float(word[1]) + 5:.4f}", text), "utf-8")
    status, out, err = command(
        "mill",
        SET,
        "--member",
        "pinion",
        "--program",
        moved,
        "--errors",
        "simulated_shop.toml",
        "-o",
        tmp_path / "m.csv",
    )
    assert (status, out) == (1, "")
    assert "off the path of the settings" in err
    assert not (tmp_path / "m.csv").exists()
