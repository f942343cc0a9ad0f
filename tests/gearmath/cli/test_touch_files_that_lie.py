"""Raw touches that lie: each is read rightly, or refused in one sentence, or said not to be whole.

Runs that were aborted, second runs of a few touches, files that are cut off, numbers as a control prints them.
"""

from __future__ import annotations

import json
import math
import re

import numpy as np
import pytest

from gearmath.machine.measuring.artefacts import Artefacts
from gearmath.machine.measuring.probe_run import run_touches
from gearmath.machine.planning.targets import probe_targets
from gearmath.machine.writing.calibrating import calibration_program
from gearmath.quality.evaluation.completeness import missing_touches
from gearmath.specs.calibration import load_calibration
from gearmath.specs.flank_csv import read_flank_csv
from gearmath.specs.toml import bundled
from gearmath.specs.touch_csv import COLUMNS, read_touch_csv

SET = "nasa_tp3096_12x36.toml"
PROBE = load_calibration(bundled("probe.toml"))


def cell(column, value, line):
    """One cell of one line, counted from 0, as another one."""

    def change(text):
        lines = text.split("\n")
        cells = lines[line].split(",")
        cells[column] = value
        return "\n".join([*lines[:line], ",".join(cells), *lines[line + 1 :]])

    return change


@pytest.fixture(scope="module")
def raw(gear_set, vertical):
    """A run of touches on the nominal pinion, as the probing program writes it: the positions of its targets."""
    targets = probe_targets(gear_set.pinion, vertical, PROBE)
    lines = [",".join(COLUMNS)]
    for k in range(len(targets)):
        *linear, A, B = targets.touch[k]
        axes = [*(f"{value:.9f}" for value in linear), f"{math.degrees(A) % 360:.9f}", f"{math.degrees(B):.9f}"]
        place = [targets.flank[k], *(str(getattr(targets, name)[k]) for name in ("tooth", "row", "col"))]
        lines.append(",".join(["1", str(k + 1), "pinion", *place, *axes, "1"]))
    return "\n".join(lines) + "\n"


@pytest.fixture(scope="module")
def calibration_raw(vertical):
    """As programs without a plan write it."""
    text = run_touches(calibration_program(vertical, PROBE, "CAL"), "CAL.MPF", Artefacts(vertical, PROBE))
    plan, _, rest = text.partition("\n")
    assert plan == "# planned: 35 touches"  # 6 in the ring, 4 on its face, 25 on the sphere
    return rest


def second_run(text, count):
    """The file with a second run after the first one, of so many touches."""
    head, *rows = text.splitlines()
    return "\n".join([head, *rows, head, *("2" + row[1:] for row in rows[:count])]) + "\n"


TOUCHES_REFUSED = {
    "empty": (lambda text: "", "holds no touch"),
    "column line only": (lambda text: text.split("\n")[0] + "\n", "holds no touch"),
    "binary": (lambda text: b"\xfe\xed\xfa\xce" * 9, "is no text file"),
    "five touches": (lambda text: "\n".join(text.split("\n")[:6]) + "\n", r"run 1, the last one, is not whole"),
    "second run of five touches": (
        lambda text: second_run(text, 5),
        r"run 2, the last one, is not whole: .*; --run 2 takes it as it is, --run 1",
    ),
    "second run without its last third": (
        lambda text: second_run(text, text.count("\n") * 2 // 3),
        r"run 2, the last one, is n",
    ),
    "second run that looks whole": (
        lambda text: second_run(text, 90 if "concave" in text else 10),
        r"is not whole: it has (90|10) touches, run 1 has (122|35); --run 2 takes it as it is, --run 1 another one",
    ),
    "cut in half": (lambda text: "\n".join(text.split("\n")[: text.count("\n") // 2]) + "\n", "is not whole"),
    "last touch missing": (lambda text: "\n".join(text.split("\n")[:-2]) + "\n", "is not whole"),
    "cut within the last line": (lambda text: text[:-7], r"line \d+: .*(cut off|columns)"),
    "further run that was aborted before its first touch": (
        lambda text: text + text.split("\n")[0] + "\n",
        r"line \d+: a further run begins here and has no touch; --run 1 takes the one before",
    ),
    "plan without a number": (
        lambda text: "# planned: all\n" + text,
        r"line 1: planned = 'all': must begin like '122 t",
    ),
    "gap in the points": (
        lambda text: "\n".join(text.split("\n")[:8] + text.split("\n")[9:]),
        r"line 9: point = 9: must be 8",
    ),
    "same run again": (lambda text: text + text, r"point = 1: must be \d+, without a gap: run 1 is there twice"),
    "nothing triggered": (
        lambda text: text.replace(",1\n", ",0\n"),
        r"(line 2: triggered = 0: must be 1|run 1: triggered = 0 in all of its 122 touches)",
    ),
    "triggered twice": (lambda text: text.replace(",1\n", ",2\n", 4), r"line 2: triggered = 2: must be 1"),
    "decimal commas": (
        lambda text: text.replace(".", ","),
        r"line 2: has \d+ columns, .*; numbers have a decimal point",
    ),
    "semicolons": (lambda text: text.replace(",", ";"), r"line 1: has 1 column, .*; columns stand between commas"),
    "X nan": (cell(7, "nan", line=3), r"line 4: (X|B) = 'nan': must be a finite number"),
    "run without end": (lambda text: text.replace("\n1,", "\n1e30,"), r"run = 1e30: must be a whole number from 0"),
    "point negative": (cell(1, "-3", line=3), r"line 4: point = -3: must be a whole number from 0"),
}


@pytest.mark.parametrize("kind", ["touches", "calibrate"])
@pytest.mark.parametrize("name", TOUCHES_REFUSED)
def test_raw_touches_that_lie_are_refused(command, raw, calibration_raw, tmp_path, kind, name):
    change, sentence = TOUCHES_REFUSED[name]
    text = raw if kind == "touches" else calibration_raw
    content = change(text)
    path = tmp_path / "raw.csv"
    path.write_bytes(content if isinstance(content, bytes) else content.encode("utf-8"))
    extra = ("--set", SET) if kind == "touches" else ()
    status, out, err = command(kind, path, *extra, "-o", tmp_path / "out")
    assert (status, out, err.count("\n")) == (2, "", 1), err
    assert re.search(r"raw\.csv.*" + sentence, err), err
    assert [entry.name for entry in tmp_path.iterdir()] == ["raw.csv"]


@pytest.mark.parametrize(
    ("column_", "value", "sentence"),
    [
        (4, "13", "tooth = 13: the pinion and its grid 5x9 end at 12"),
        (5, "99999999", "row = 99999999: must be a whole number from 0 to 10000000"),
        (6, "9", "col = 9: the pinion and its grid 5x9 end at 8"),
        (4, "7", r"tooth 7, row 0, col 0: A stands \+150\.0000 degrees from where the program searches"),
        (9, "600.0", r"tooth 0, row 0, col 0: the touch lies .* mm from the line along which it was searched"),
        (2, "gear", "member = pinion: run 1 began with the gear"),
    ],
)
def test_touch_of_another_place_is_refused(command, raw, tmp_path, column_, value, sentence):
    """Asked for by its number, so that the run is not refused as one that is not whole."""
    path = tmp_path / "raw.csv"
    path.write_text(cell(column_, value, line=1)(raw))
    status, out, err = command("touches", path, "--set", SET, "--run", 1, "-o", tmp_path / "out")
    assert (status, out) == (2, "")
    assert re.search(r"raw\.csv.*" + sentence, err), err


def test_run_that_is_not_whole_is_taken_where_it_is_asked_for_and_said_not_to_be(
    command, raw, calibration_raw, tmp_path
):
    path, out = tmp_path / "raw.csv", tmp_path / "out.csv"
    path.write_text(second_run(raw, 60))
    status, said, _ = command("touches", path, "--set", SET, "--run", 2, "-o", out)
    assert status == 0
    assert "run 2 is not whole: convex flank, tooth 0: 15 of 45 points of the grid were measured" in said
    assert "not whole" not in command("touches", path, "--set", SET, "--run", 1, "-o", out)[1]
    path.write_text(second_run(calibration_raw, 30))
    status, said, _ = command("calibrate", path, "--run", 2, "-o", tmp_path / "tip.toml")
    assert status == 0
    assert "run 2 is not whole: sphere was touched 20 of 25 times" in said


def test_run_that_was_aborted_anywhere_is_never_whole(raw, gear_set, tmp_path):
    """After every single touch but the last one; with the grid alone, only after both flanks are done."""
    lines = raw.splitlines()
    path = tmp_path / "raw.csv"
    for count in range(2, len(lines)):
        path.write_text("\n".join(lines[:count]) + "\n")
        missing = missing_touches(read_touch_csv(path), 12, (5, 9))
        assert bool(missing) == (count - 1 != 90), count  # the whole grid of one tooth is a measurement, too
    path.write_text(raw)
    assert missing_touches(read_touch_csv(path), 12, (5, 9)) == ()


def test_run_that_was_aborted_anywhere_has_fewer_touches_than_planned(command, raw, tmp_path):
    """After the grid of tooth 0, too, which without the plan is a whole measurement: then it is said."""
    path, out = tmp_path / "raw.csv", tmp_path / "m.csv"
    head, *rows = raw.splitlines()
    plan = "# planned: 122 touches, 13 teeth, concave and convex"
    aborted = "\n".join([head, *rows[:90]]) + "\n"
    path.write_text(f"{plan}\n{aborted}")
    status, _, err = command("touches", path, "--set", SET, "-o", out)
    assert (status, out.exists()) == (2, False)
    assert "run 1, the last one, is not whole: it has 90 touches, its program makes 122; --run 1 takes it" in err
    status, said, _ = command("touches", path, "--set", SET, "--run", 1, "-o", out)
    assert status == 0
    assert "run 1 is not whole: it has 90 touches, its program makes 122" in said
    path.write_text(aborted)
    status, _, err = command("touches", path, "--set", SET, "-o", out)
    assert status == 0
    assert "does not say how many touches were planned: taken for a whole run of the grid of 1 tooth, no pitch" in err
    path.write_text(f"{plan}\n{raw}")
    assert command("touches", path, "--set", SET, "-o", out)[::2] == (0, "")


def test_each_run_of_a_file_has_its_own_plan(raw, tmp_path):
    path = tmp_path / "raw.csv"
    head, *rows = raw.splitlines()
    second = [head, *("2" + row[1:] for row in rows[:90])]
    path.write_text("\n".join(["# planned: 122 touches", head, *rows, "# planned: 90 touches", *second]) + "\n")
    assert [read_touch_csv(path, run).planned for run in (1, 2)] == [122, 90]
    path.write_text("\n".join(["# planned: 122 touches", head, *rows, *second]) + "\n")
    assert [read_touch_csv(path, run).planned for run in (1, 2)] == [122, None]


def test_kinds_of_touches_are_not_taken_for_each_other(command, raw, calibration_raw, tmp_path):
    path = tmp_path / "raw.csv"
    path.write_text(calibration_raw)
    assert (
        "raw.csv, line 1: the touches are on ring and spheres"
        in command("touches", path, "--set", SET, "-o", tmp_path / "o")[2]
    )
    path.write_text(raw)
    assert "raw.csv, line 1: the touches are on a member" in command("calibrate", path, "-o", tmp_path / "o")[2]


def test_touches_in_the_numbers_of_a_control_are_read_as_they_are(command, raw, tmp_path):
    """1.5EX-05, +1.0, .5, a byte order mark, CRLF and blanks: the same measured file comes out."""
    path, out = tmp_path / "raw.csv", tmp_path / "m.csv"
    path.write_text(raw)
    assert command("touches", path, "--set", SET, "-o", out)[0] == 0
    expected = out.read_text()

    def dressed(match):
        value = float(match[0])
        mantissa, exponent = f"{value:+.17e}".split("e")
        return f"{mantissa}EX{int(exponent):+03d}"

    lines = raw.split("\n")
    changed = [lines[0], *(re.sub(r"-?\d+\.\d+", dressed, line).replace(",", " , ") for line in lines[1:])]
    path.write_bytes(b"\xef\xbb\xbf" + "\r\n".join(changed).encode())
    assert command("touches", path, "--set", SET, "-o", out)[0] == 0
    assert out.read_text() == expected


def shifted(text, keep=lambda cells: True, **off):
    """The touches that ``keep`` takes, with the axes moved."""
    lines = text.splitlines()
    for n, line in enumerate(lines):
        cells = line.split(",")
        if cells[0] == "1" and keep(cells):
            for axis, value in off.items():
                k = COLUMNS.index(axis)
                cells[k] = f"{float(cells[k]) + value:.9f}"
            lines[n] = ",".join(cells)
    return "\n".join(lines) + "\n"


#: Name: what was wrong with the set-up, and the sentence.
SET_UPS = {
    "tool length": (
        {"Z": 1.0},
        r"all touches lie \+1\.000 mm in Z from the planned lines, .*work offset or tool length",
    ),
    "tool length twice": ({"Z": -150.0}, r"all touches lie -150\.000 mm in Z from the planned lines"),
    "offset of Y": (
        {"Y": -0.4},
        r"all touches lie -0\.400 mm in Y from the planned lines, .*: work offset, or another",
    ),
    "offset of X and Z": ({"X": 2.0, "Z": 0.7}, r"all touches lie \+2\.000 mm in X and \+0\.700 mm in Z"),
    "offset of A": ({"A": 30.0}, r"all touches stand \+30\.0000 degrees in A"),
    "offset of B": ({"B": 0.1}, r"all touches stand \+0\.1000 degrees in B"),
}


@pytest.mark.parametrize("name", SET_UPS)
def test_wrong_offset_or_tool_length_is_named_with_its_axis_and_size(command, raw, tmp_path, name):
    off, sentence = SET_UPS[name]
    path = tmp_path / "raw.csv"
    path.write_text(shifted(raw, **off))
    status, out, err = command("touches", path, "--set", SET, "-o", tmp_path / "out.csv")
    assert (status, out, err.count("\n")) == (2, "", 1), err
    assert re.search(r"raw\.csv: " + sentence, err), err
    assert not (tmp_path / "out.csv").exists()


def test_single_touch_beside_its_line_is_named(command, raw, tmp_path):
    """Z is nearly square to the search."""
    path, out = tmp_path / "raw.csv", tmp_path / "out.csv"
    path.write_text(shifted(raw, lambda cells: cells[3:7] == ["convex", "5", "2", "4"], Z=1.0))
    status, _, err = command("touches", path, "--set", SET, "-o", out)
    assert (status, out.exists()) == (2, False)
    assert re.search(
        r"convex flank, tooth 5, row 2, col 4: the touch lies \d\.\d+ mm from the line along which", err
    ), err
    path.write_text(shifted(raw, lambda cells: cells[3:7] == ["convex", "5", "2", "4"], A=7.0))
    assert (
        "tooth 5, row 2, col 4: A stands +7.0000 degrees from where"
        in command("touches", path, "--set", SET, "-o", out)[2]
    )


def test_metal_along_the_search_is_measured_and_a_small_common_offset_is_said(
    command, raw, gear_set, vertical, tmp_path
):
    """Stock of 0.4 mm on every flank is along the lines; the tip may have been calibrated anew by 0.05 mm."""
    path, out = tmp_path / "raw.csv", tmp_path / "out.csv"
    targets = probe_targets(gear_set.pinion, vertical, PROBE)
    way = targets.start[:, :3] - targets.touch[:, :3]
    way *= 0.4 / np.linalg.norm(way, axis=1)[:, None]
    lines = raw.splitlines()
    for k, one in enumerate(way):
        cells = lines[k + 1].split(",")
        cells[7:10] = [f"{float(cells[7 + i]) + one[i]:.9f}" for i in range(3)]
        lines[k + 1] = ",".join(cells)
    path.write_text("\n".join(lines) + "\n")
    status, said, err = command("touches", path, "--set", SET, "-o", out)
    assert (status, "planned lines" in err) == (0, False)
    assert "largest deviation 400.0" in said
    path.write_text(shifted(raw, Z=0.05))
    status, _, err = command("touches", path, "--set", SET, "-o", out)
    assert status == 0
    assert "raw.csv: all touches lie +0.050 mm in Z from the planned lines: work offset or tool length" in err


@pytest.mark.parametrize("size", [0.006, 0.015, 0.05])
@pytest.mark.parametrize("axis", ["Y", "Z"])
def test_offset_that_evaluate_refuses_is_said_by_both_in_the_same_words(command, raw, tmp_path, axis, size):
    """Said from 4 um on; up to 10 um beside their normals points are taken, and beyond evaluate names the set-up."""
    path, out = tmp_path / "raw.csv", tmp_path / "m.csv"
    path.write_text(shifted(raw, **{axis: size}))
    status, _, err = command("touches", path, "--set", SET, "-o", out)
    cause = "work offset" + " or tool length" * (axis == "Z") + ", or another --machine or --calibration"
    assert status == 0
    assert f"raw.csv: all touches lie +{size:.3f} mm in {axis} from the planned lines: {cause}" in err
    refused = "evaluate takes points up to 0.01 mm beside their normals only" in err
    status, _, err = command("evaluate", out, "--set", SET)
    assert refused == (size > 0.01) == (status == 2)
    if refused:
        assert "nearly all points are, by" in err
        assert "work offset or tool length, or another --machine or --calibration than that of the program" in err


def test_touches_turned_alike_are_said(command, raw, tmp_path):
    path = tmp_path / "raw.csv"
    path.write_text(shifted(raw, A=0.03))
    _, _, err = command("touches", path, "--set", SET, "-o", tmp_path / "m.csv")
    assert "all touches stand +0.0300 degrees in A from the planned positions: a work offset, or" in err


@pytest.mark.parametrize(
    ("axis", "by", "verb"), [("X", 0.02, r"lie \+0\.0(19|20) mm"), ("B", 0.005, r"stand \+0\.0050 degrees")]
)
def test_offset_of_a_part_of_the_touches_is_not_said_of_all(command, raw, tmp_path, axis, by, verb):
    path = tmp_path / "raw.csv"
    lines, moved = raw.splitlines(), shifted(raw, **{axis: by}).splitlines()
    k = 45 * len(lines) // 100
    path.write_text("\n".join(lines[:k] + moved[k:]) + "\n")
    _, _, err = command("touches", path, "--set", SET, "-o", tmp_path / "m.csv")
    count = len(lines) - 1
    assert re.search(rf"raw\.csv: {count - k + 1} of {count} touches {verb} in {axis} from the planned", err)
    assert "all touches" not in err
    assert "it changed while they were measured" in err


def test_touch_that_met_nothing_is_one_missing_point_and_costs_only_what_needs_it(command, raw, tmp_path):
    """The reference point of tooth 5 on one flank, and one point of a grid: named, all other figures stand."""
    path, out = tmp_path / "raw.csv", tmp_path / "m.csv"
    lines = raw.splitlines()
    missed = {
        "concave,0,1,3,": "concave flank, tooth 0, row 1, col 3",
        "convex,5,2,4,": "convex flank, tooth 5, row 2, col 4",
    }
    scatter = np.random.default_rng(5).normal(0.0, 3e-4, len(lines))  # mm: exact touches would be no measurement
    for n, line in enumerate(lines[1:], start=1):
        cells = line.split(",")
        cells[7] = f"{float(cells[7]) + scatter[n]:.9f}"
        met = "0" if any(f"pinion,{place}" in line for place in missed) else "1"
        lines[n] = ",".join([*cells[:-1], met])
    path.write_text("# planned: 122 touches, 13 teeth, concave and convex\n" + "\n".join(lines) + "\n")
    status, said, err = command("touches", path, "--set", SET, "-o", out)
    assert (status, err) == (0, "")
    assert [line for line in said.splitlines() if "touched nothing" in line] == [
        f"{words}: triggered = 0: the probe touched nothing; the point is left out" for words in missed.values()
    ]
    assert out.read_text().count("\npinion,") == 122
    assert "# planned: 122 points\n" in out.read_text()
    values = json.loads(command("evaluate", out, "--set", SET, "--json")[1])
    for words in missed.values():
        assert any(line.startswith(words) for line in values["left_out"]), values["left_out"]
    flanks = values["flanks"]
    assert flanks["concave"]["max_deviation_um"] is None
    assert flanks["concave"]["F_p_um"] is not None
    assert flanks["convex"]["F_p_um"] is None
    assert flanks["convex"]["max_deviation_um"] is not None
    assert values["tolerance"]["grade"] is None
    assert set(values["tolerance"]["grades_of_flanks"]) == {"concave"}


def test_repeated_touch_that_met_nothing_once_leaves_the_mean_of_the_others(command, raw, tmp_path):
    """Every point twice, the second time 2 um higher along X; of one point only the first touch counts."""
    path, out, clean = tmp_path / "raw.csv", tmp_path / "m.csv", tmp_path / "clean.csv"
    head, *rows = raw.splitlines()
    twice = [row for row in rows for _ in range(2)]
    twice = [",".join([row.split(",")[0], str(k + 1), *row.split(",")[2:]]) for k, row in enumerate(twice)]
    twice[9] = twice[9][:-1] + "0"
    path.write_text("\n".join([head, *twice]) + "\n")
    status, said, _ = command("touches", path, "--set", SET, "-o", out)
    assert status == 0
    assert "concave flank, tooth 0, row 0, col 4: triggered = 0: the probe touched nothing, 1 of 2 times\n" in said
    path.write_text(raw)
    command("touches", path, "--set", SET, "-o", clean)
    found, wanted = read_flank_csv(out), read_flank_csv(clean)
    np.testing.assert_allclose(found.point, wanted.point, rtol=0, atol=2e-9)
    np.testing.assert_allclose(found.deviation, wanted.deviation, rtol=0, atol=2e-9)
