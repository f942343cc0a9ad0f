"""Measured files that lie: each is read rightly, or refused in one sentence, or said not to be whole.

Every lie is told to every verb that reads its kind of file. None may hang, show a traceback or write a file.
"""

from __future__ import annotations

import json
import math
import re
from dataclasses import replace

import numpy as np
import pytest

from gearmath.bevel.flank import blank_grid
from gearmath.bevel.nominal_file import nominal_flank
from gearmath.machine.writing.probing import probing_program
from gearmath.specs.bevel_set import FLANKS
from gearmath.specs.calibration import load_calibration
from gearmath.specs.flank_csv import join, read_flank_csv, write_flank_csv
from gearmath.specs.milling_machine import load_milling_machine
from gearmath.specs.toml import bundled

SET = "nasa_tp3096_12x36.toml"


@pytest.fixture(scope="module")
def honest(gear_set):
    """The text of a measured pinion: grid of tooth 0, reference points of the others, smooth form, uneven pitch."""
    member, files = gear_set.pinion, []
    for flank in FLANKS:
        for tooth in range(12):
            one = nominal_flank(member, flank, blank_grid(member), tooth=tooth)
            up, along = one.row / 2 - 1, one.col / 4 - 1
            found = 1e-3 * (4.0 * up + 3.0 * up * along - 5.0 * along**2 + 2.0 * math.sin(tooth) + 30.0)
            one = replace(one, deviation=found, point=one.point + found[:, None] * one.normal)
            files.append(one if tooth == 0 else one.pick((one.row == 2) & (one.col == 4)))
    return join(files)


@pytest.fixture(scope="module")
def text(honest, tmp_path_factory):
    path = tmp_path_factory.mktemp("honest") / "m.csv"
    write_flank_csv(path, honest)
    return path.read_text("utf-8")


@pytest.fixture(scope="module")
def program(gear_set, tmp_path_factory):
    """A probing program of the pinion, as ``probe`` runs it."""
    machine, probe = load_milling_machine(bundled("vertical_5axis.toml")), load_calibration(bundled("probe.toml"))
    path = tmp_path_factory.mktemp("program") / "PROBE.MPF"
    path.write_text(probing_program(gear_set, "pinion", machine, probe, "PROBE", topography=()))
    return path


def verbs(file, program, folder):
    """Every way in which a flank file comes into a command."""
    out, member = ("-o", folder / "written"), ("--member", "pinion")
    return {
        "evaluate": ("evaluate", file, "--set", SET),
        "compensate": ("compensate", SET, *member, "--measured", file, *out),
        "report": ("report", file, "--set", SET, *out),
        "uncertainty": ("uncertainty", file, "--set", SET, *member),
        "stock": ("stock", file, "--set", SET, *member),
        "probe": ("probe", program, "--set", SET, *member, "--measured", file, *out),
    }


def header(key, value):
    return lambda text: re.sub(rf"# {key}: .*", f"# {key}: {value}", text)


def cell(column, value, line=20):
    """One cell of one line, counted from 0, as another one."""

    def change(text):
        lines = text.split("\n")
        cells = lines[line].split(",")
        cells[column] = value(cells[column]) if callable(value) else value
        return "\n".join([*lines[:line], ",".join(cells), *lines[line + 1 :]])

    return change


def column(k, change):
    """All cells of one column through a function of their numbers."""

    def of_all(text):
        lines = text.split("\n")
        for n, line in enumerate(lines):
            if line.startswith("pinion,"):
                cells = line.split(",")
                cells[k] = f"{change(float(cells[k])):.12f}"
                lines[n] = ",".join(cells)
        return "\n".join(lines)

    return of_all


def flipped(text):
    for k in (8, 9, 10):
        text = column(k, lambda value: -value)(text)
    return text


#: Name: what is done to the text of a good file, and the sentence that refuses it.
REFUSED = {
    "empty file": (lambda text: "", "is no flank file"),
    "nothing but the header": (lambda text: text[: text.index("pinion,")], "holds no point"),
    "binary": (lambda text: b"\x00\x01\x02\xff" * 100, "is no text file"),
    "zero bytes at the end": (lambda text: text + "\0" * 512, "is no text file: it holds a zero byte"),
    "UTF-16": (lambda text: text.encode("utf-16"), "is no text file: byte 0 is not UTF-8"),
    "columns in another order": (
        lambda text: text.replace("x,y,z,nx", "y,x,z,nx"),
        "the column line must read member,",
    ),
    "cut within the last line": (lambda text: text[:-30], r"line 123: .*(cut off|columns)"),
    "cut within the last number": (lambda text: text[:-5], r"line 123: .*(cut off|columns)"),
    "decimal commas": (
        lambda text: text.replace(".", ","),
        r"(margins|line 12: has \d+ columns, must have 13; numbers)",
    ),
    "decimal commas in the points": (
        lambda text: re.sub(r"(?<=\d)\.(?=\d{9})", ",", text),
        r"line 12: has \d+ columns, must have 13; numbers have a",
    ),
    "one quoted decimal comma": (cell(5, '"1,5"'), r"line 21: has 14 columns, must have 13"),
    "semicolons": (
        lambda text: text.replace("inion,", "inion;").replace("ave,", "ave;"),
        "line 12: has 11 columns.*; col",
    ),
    "unit inch": (header("unit", "inch"), "unit = 'inch': must be mm"),
    "frame of the machine": (header("frame", "m"), "frame = 'm': must be w"),
    "grid without end": (
        header("grid", "99999x99999"),
        "grid = 99999x99999: has 9999800001 points, the limit is 10000",
    ),
    "grid of seven digits": (header("grid", "5x9999999"), "grid = '5x9999999': must read like 5x9"),
    "other grid": (header("grid", "7x9"), "(measured point lies|0 to 6)"),
    "margins nan": (header("margins", "nan,nan"), "margins = 'nan,nan': must"),
    "margins unlike": (header("margins", "0.1,0.2"), "(measured point lies|is not on the flank|no solution)"),
    "reference point elsewhere": (header("reference_point", "7,4"), "reference_point = 7,4: must lie in the grid 5x9"),
    "tip radius nan": (
        header("tip_radius_mm", "nan"),
        "tip_radius_mm = 'nan': must be a number from 0 to less than 10",
    ),
    "tip radius negative": (header("tip_radius_mm", "-1"), "tip_radius_mm = '-1': must be a number from 0"),
    "phase perhaps": (header("phase_zeroed", "perhaps"), "phase_zeroed = 'perhaps': must be false, common .* or true"),
    "member of neither kind": (header("member", "wheel"), "member = 'wheel': must be pinion or gear"),
    "other number of teeth": (header("member_teeth", "13"), "member_teeth = 13: the pinion of the set has 12"),
    "settings of another set": (header("settings_sha256", "ab" * 32), "settings_sha256 = abab.*other nominal settings"),
    "key twice": (
        lambda text: text.replace("# unit", "# tip_radius_mm: 0.5\n# unit"),
        r"line 10: tip_radius_mm = '0': line 4 says '0.5'",
    ),
    "key missing": (
        lambda text: text.replace("# phase_zeroed: false\n", ""),
        "header line '# phase_zeroed: ...' is missing",
    ),
    "u negative": (cell(12, "-1"), r"line 21: u_um = -1: must be from 0 to"),
    "u nan": (cell(12, "nan"), r"line 21: u_um = 'nan': must be a finite number"),
    "u without end": (cell(12, "1e300"), r"line 21: u_um = 1e300: must be from 0 to 100"),
    "deviation inf": (cell(11, "inf"), r"line 21: deviation_um = 'inf': must be a finite number"),
    "deviation overflows": (cell(11, "1e999"), r"line 21: deviation_um = '1e999': must be a finite number"),
    "digits of another script": (cell(5, "４５.0"), r"line 21: x = '４５.0': must be a finite number"),
    "underscore in a number": (cell(5, "4_5.0"), r"line 21: x = '4_5.0': must be a finite number"),
    "row negative": (cell(3, "-1"), r"line 21: row = -1: must be a whole number from 0"),
    "tooth huge": (cell(2, "9" * 400), r"line 21: tooth = .*: must be"),
    "col huge": (cell(4, "99999"), r"line 21: col = 99999: the header allows 0 to 8"),
    "tooth with a fraction": (cell(2, "0.5"), r"line 21: tooth = 0.5: must be a whole number"),
    "point twice": (
        lambda text: text + text.split("\n")[-2] + "\n",
        r"line 124: the point flank convex, tooth 11.*line 123",
    ),
    "row and col of a neighbor": (cell(4, "6", line=18), r"line 19: the point .* is there twice, in line 18 too"),
    "normals flipped": (
        flipped,
        "nx, ny, nz = .*: must be the outward normal.*112 of 112 normals point into the metal",
    ),
    "one normal flipped": (
        lambda text: cell(10, lambda v: str(-float(v)))(
            cell(9, lambda v: str(-float(v)))(cell(8, lambda v: str(-float(v)))(text))
        ),
        "1 of 112 normals point into the metal",
    ),
    "normal too long": (cell(8, "1.5"), r"line 21: nx, ny, nz have length"),
    "deviations of the other sign": (
        column(11, lambda value: -value),
        r"deviation_um = .*x, y, z lie .* um out of the",
    ),
    "deviations in mm": (column(11, lambda value: value / 1000), r"deviation_um = .*both must agree within 1 um"),
    "deviations moved by 2 um": (column(11, lambda value: value + 2), r"deviation_um = .*both must agree within 1 um"),
    "coordinates in inches": (
        lambda text: column(7, lambda v: v / 25.4)(column(6, lambda v: v / 25.4)(column(5, lambda v: v / 25.4)(text))),
        "the numbers are inches",
    ),
    "y of the other hand": (column(6, lambda value: -value), "the file is of the other hand"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_lie_is_refused_by_every_verb_in_one_sentence(command, text, program, tmp_path, name):
    """Status 2, the file by its name, and nothing written."""
    change, sentence = REFUSED[name]
    content = change(text)
    assert content != text
    path = tmp_path / "m.csv"
    path.write_bytes(content if isinstance(content, bytes) else content.encode("utf-8"))
    for verb, arguments in verbs(path, program, tmp_path).items():
        status, out, err = command(*arguments)
        assert (status, out, err.count("\n")) == (2, "", 1), (verb, out, err)
        assert re.search(r"m\.csv.*" + sentence, err), (verb, err)
    assert sorted(entry.name for entry in tmp_path.iterdir()) == ["m.csv"]


def test_directory_and_absent_file_are_refused_by_every_verb(command, program, tmp_path):
    for path, sentence in (
        (tmp_path, "cannot be read: is a folder, name a file"),
        (tmp_path / "no.csv", "cannot be read: No such"),
    ):
        for verb, arguments in verbs(path, program, tmp_path).items():
            status, out, err = command(*arguments)
            assert (status, out) == (2, ""), verb
            assert sentence in err


def test_file_that_never_ends_is_refused(command, tmp_path):
    path = tmp_path / "big.csv"
    with path.open("wb") as stream:
        stream.truncate(21_000_000)
    assert "is larger than 20 MB, which is the limit" in command("evaluate", path, "--set", SET)[2]


#: Name: what is done to the text; it must be read as the good file is.
READ = {
    "byte order mark": lambda text: b"\xef\xbb\xbf" + text.encode(),
    "line ends of Windows": lambda text: text.replace("\n", "\r\n").encode(),
    "line ends of old machines": lambda text: text.replace("\n", "\r").encode(),
    "blanks and empty lines": lambda text: (
        text.replace(",", " ,  ").replace("\n", "  \n\n").replace("# grid", "  \n# grid").encode()
    ),
    "no line end at the end": lambda text: text[:-1].encode(),
    "cells in quotes": lambda text: re.sub(r"(?<=,)(\d+\.\d+)(?=,)", r'"\1"', text).encode(),
    "plus signs": lambda text: re.sub(r"(?<=,)(\d+\.\d{6,})", r"+\1", text).encode(),
    "no digit before the point": lambda text: re.sub(r"(?<=[,-])0\.", ".", text).replace("0.1,.1", "0.1,0.1").encode(),
    "exponents": lambda text: re.sub(
        r"(?<=,)(-?)(\d)(\d+)\.(\d{9})", lambda m: f"{m[1]}{m[2]}.{m[3]}{m[4]}E+0{len(m[3])}", text
    ).encode(),
    "exponents of the control": lambda text: re.sub(
        r"(?<=,)(-?)(\d)(\d+)\.(\d{9})", lambda m: f"{m[1]}{m[2]}.{m[3]}{m[4]}EX0{len(m[3])}", text
    ).encode(),
    "counts with decimals": lambda text: re.sub(r"ave,(\d+),(\d),(\d),", r"ave,\1.000,\2.0,\3.,", text).encode(),
    "order of the header": lambda text: "\n".join(sorted(text.split("\n")[:10]) + text.split("\n")[10:]).encode(),
    "comments of somebody": lambda text: ("# measured: Monday\n# measured: again\n# 12:30\n# 12:45\n" + text).encode(),
    "a key twice with one value": lambda text: text.replace("# unit: mm", "# unit: mm\n# unit: mm").encode(),
}


@pytest.fixture(scope="module")
def judged(text, tmp_path_factory):
    """What a good file is read as: the arrays of the reader."""
    path = tmp_path_factory.mktemp("good") / "m.csv"
    path.write_text(text, "utf-8")
    return read_flank_csv(path)


@pytest.mark.parametrize("name", READ)
def test_same_numbers_in_another_dress_are_read_as_they_are(text, judged, tmp_path, name):
    content = READ[name](text)
    assert content != text.encode()
    (tmp_path / "m.csv").write_bytes(content)
    found = read_flank_csv(tmp_path / "m.csv")
    for key in ("flank", "tooth", "row", "col"):
        np.testing.assert_array_equal(getattr(found, key), getattr(judged, key))
    for key in ("point", "normal", "deviation", "uncertainty"):
        np.testing.assert_allclose(getattr(found, key), getattr(judged, key), rtol=1e-14, atol=0)


def rows_of(text, keep):
    return "\n".join(line for line in text.split("\n") if not line.startswith("pinion,") or keep(line.split(",")))


#: Name: which rows are left, and what is said of them.
NOT_WHOLE = {
    "convex reference points end at tooth 5": (
        lambda row: row[1] == "concave" or int(row[2]) < 6,
        "convex flank: 6 of 12 teeth were not measured at the reference point, the first of them is tooth 6",
    ),
    "nothing of the convex flank": (lambda row: row[1] == "concave", "convex flank: not measured at all"),
    "no tooth but one on the convex flank": (
        lambda row: row[1] == "concave" or row[2] == "0",
        "convex flank: 11 of 12 teeth were not measured",
    ),
    "tooth 3 of neither flank": (lambda row: row[2] != "3", "concave flank: 1 of 12 teeth were not measured"),
}


@pytest.mark.parametrize("name", NOT_WHOLE)
def test_file_that_is_not_whole_is_said_not_to_be_and_gets_no_grade(command, text, program, tmp_path, name):
    keep, sentence = NOT_WHOLE[name]
    path = tmp_path / "m.csv"
    path.write_text(rows_of(text, keep), "utf-8")
    status, out, err = command("evaluate", path, "--set", SET, "--json")
    assert (status, err) == (0, "")
    values = json.loads(out)
    # each flank may have grades of its own, the gear has none
    tolerance = values["tolerance"]
    assert tolerance is None or (tolerance["grade"] is None and set(tolerance["withheld"]) == {"f_pt", "F_p", "F_r"})
    assert any("not whole" in remark and sentence in remark for remark in values["remarks"]), values["remarks"]
    for verb, arguments in verbs(path, program, tmp_path).items():
        if verb in ("compensate", "stock"):
            status, out, err = command(*arguments)
            assert (status == 2 and "m.csv" in err) or sentence in out, (verb, status, out, err)


def test_file_cut_in_half_is_refused_or_said_not_to_be_whole_by_every_verb(command, text, tmp_path):
    """At every eighth line: the grid of a flank is not there, or not whole, or pitch is not."""
    lines = text.split("\n")
    path = tmp_path / "m.csv"
    for count in range(12, len(lines) - 1, 8):
        path.write_text("\n".join(lines[:count]) + "\n", "utf-8")
        status, out, err = command("evaluate", path, "--set", SET)
        assert status in (0, 2), (count, err)
        assert "not whole" in out if status == 0 else "m.csv" in err, count
        assert "grades: " not in out


def test_file_without_uncertainties_shows_none_of_nothing(command, text, tmp_path):
    """Exact deviations and no u_um: no '± 0.00', and a line that none is known."""
    path = tmp_path / "m.csv"
    path.write_text(text, "utf-8")
    out = command("evaluate", path, "--set", SET)[1]
    assert "± 0.00" not in out
    assert "the file has no u_um, and --sigma-um is not given: " in out
    assert "the file has no u_um" not in command("evaluate", path, "--set", SET, "--sigma-um", "0.5")[1]


def planned(count):
    return lambda text: text.replace("# grid", f"# planned: {count} points\n# grid", 1)


def test_file_that_holds_fewer_points_than_planned_has_no_maximum_and_no_grade(command, text, tmp_path):
    """Cut after the grids and pitch of one flank, or of one point only: said first, by every verb that judges."""
    path = tmp_path / "m.csv"
    whole = planned(112)(text)
    path.write_text(whole, "utf-8")
    assert "planned" not in command("evaluate", path, "--set", SET)[1]
    lines = whole.splitlines()
    for gone in (1, 11, 56):
        path.write_text("\n".join(lines[:-gone]) + "\n", "utf-8")
        said = f"the file holds {112 - gone} of 112 points that were planned"
        status, out, err = command("evaluate", path, "--set", SET, "--json")
        assert (status, err) == (0, "")
        values = json.loads(out)
        assert values["left_out"][0].startswith("not whole: ") or f"not whole: {said}" in values["left_out"]
        for flank in values["flanks"].values():
            assert flank.get("max_deviation_um") is None
            assert flank.get("F_p_um") is None
            assert said in flank["withheld"].values()
        assert values["tolerance"] is None or values["tolerance"]["grade"] is None
        assert values["tolerance"] is None or values["tolerance"]["grades_of_flanks"] == {}
        assert f"not whole: {said}" in command("uncertainty", path, "--set", SET, "--draws", 1000)[1]
        status, out, err = command("compensate", SET, "--measured", path, "-o", tmp_path / "out.toml")
        assert said in out or status == 2
    path.write_text(planned(100)(text), "utf-8")
    assert "m.csv: planned = 100 points: it holds 112" in command("evaluate", path, "--set", SET)[2]
    path.write_text(planned("many")(text), "utf-8")
    assert "m.csv: planned = 'many points': must begin like" in command("evaluate", path, "--set", SET)[2]
