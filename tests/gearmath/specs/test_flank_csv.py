"""Flank files: what is written is read again, and a file that cannot be right is refused by line, key and limit."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gearmath.errors import InputError
from gearmath.specs.flank_csv import COLUMNS, HEADER, FlankFile, flank_file, join, read_flank_csv, write_flank_csv

TEXT = """\
# member: gear
# member_teeth: 36
# frame: w
# unit: mm
# grid: 5x9
# margins: 0.1,0.1
# reference_point: 2,4
# phase_zeroed: false
# tip_radius_mm: 0
# settings_sha256: 00ff
member,flank,tooth,row,col,x,y,z,nx,ny,nz,deviation_um,u_um
gear,concave,0,0,0,76.5,-3.25,25.125,0.6,-0.8,0,12.5,0.5
gear,convex,35,4,8,76.5,3.25,25.125,0.6,0.8,0,,
"""


def read(tmp_path, text, name="m.csv") -> FlankFile:
    (tmp_path / name).write_bytes(text if isinstance(text, bytes) else text.encode())
    return read_flank_csv(tmp_path / name)


def test_file_of_the_contract_is_read(tmp_path):
    file = read(tmp_path, TEXT)
    assert (file.member, len(file)) == ("gear", 2)
    assert tuple(file.header) == HEADER
    assert (file.flank.tolist(), file.tooth.tolist()) == (["concave", "convex"], [0, 35])
    assert (file.row.tolist(), file.col.tolist()) == ([0, 4], [0, 8])
    np.testing.assert_array_equal(file.point, [[76.5, -3.25, 25.125], [76.5, 3.25, 25.125]])
    np.testing.assert_array_equal(file.normal, [[0.6, -0.8, 0], [0.6, 0.8, 0]])
    np.testing.assert_array_equal(file.deviation, [0.0125, np.nan])  # µm in the file, mm inside
    np.testing.assert_array_equal(file.uncertainty, [0.0005, np.nan])


def test_tooth_of_the_number_of_teeth_is_tooth_0_measured_again_and_nothing_else(tmp_path):
    again = "gear,concave,36,0,0,76.5,-3.25,25.125,0.6,-0.8,0,13.5,0.5\n"
    file = read(tmp_path, TEXT + again)
    assert file.tooth.tolist() == [0, 35, 36]
    write_flank_csv(tmp_path / "b.csv", file)
    np.testing.assert_array_equal(read_flank_csv(tmp_path / "b.csv").tooth, file.tooth)
    for other in (again.replace("concave", "convex"), again.replace("36,0,0", "36,0,1")):
        with pytest.raises(InputError, match=r"tooth = 36: the header allows 0 to 35, and 36 for a point of tooth 0 m"):
            read(tmp_path, TEXT + other)
    with pytest.raises(InputError, match=r"tooth = 37: the header allows 0 to 35$"):
        read(tmp_path, TEXT + again.replace("36", "37"))


def test_files_of_the_contract_are_written_as_they_were_read(tmp_path):
    write_flank_csv(tmp_path / "again.csv", read(tmp_path, TEXT))
    lines = (tmp_path / "again.csv").read_text("utf-8").splitlines()
    assert lines[: len(HEADER)] == TEXT.splitlines()[: len(HEADER)]
    assert lines[len(HEADER)] == ",".join(COLUMNS)
    assert lines[-1] == (
        "gear,convex,35,4,8,76.500000000,3.250000000,25.125000000,0.600000000000,0.800000000000,0.000000000000,,"
    )


def test_other_header_comments_survive_reading_and_writing(tmp_path):
    told = "# operator: K. Maier: early shift\n# part_number: 4711-B\n"
    file = read(tmp_path, TEXT.replace("# frame", told + "# frame"))
    write_flank_csv(tmp_path / "again.csv", file)
    text = (tmp_path / "again.csv").read_text()
    assert text.index("# settings_sha256: 00ff\n" + told) > 0
    assert read_flank_csv(tmp_path / "again.csv").header == file.header


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        (TEXT + TEXT, r"line 24: the column line is there twice: is this more than one file\?$"),
        (TEXT.replace("12.5,0.5", "12.5,5000"), r"line 12: u_um = 5000: must be from 0 to 100$"),
    ],
)
def test_files_put_together_and_absurd_uncertainties_are_refused(tmp_path, text, sentence):
    with pytest.raises(InputError, match=sentence):
        read(tmp_path, text)


def test_windows_line_ends_blank_lines_and_foreign_header_keys_are_read(tmp_path):
    text = "# operator: somebody\n\n" + TEXT.replace("\n", "\r\n")
    np.testing.assert_array_equal(read(tmp_path, text).point, read(tmp_path, TEXT).point)


number = st.floats(-1e3, 1e3)


@given(
    st.lists(
        st.tuples(st.tuples(number, number, number), st.floats(-3, 3), st.floats(-0.5, 0.5)), min_size=1, max_size=9
    ),
    st.booleans(),
)
def test_round_trip_keeps_every_number_to_the_printed_digits(tmp_path_factory, rows, nominal):
    folder = tmp_path_factory.mktemp("trip")
    base = read(folder, TEXT)
    n = len(rows)
    normal = np.array([[np.cos(angle), np.sin(angle), 0] for _, angle, _ in rows])
    deviation = None if nominal else np.array([value for *_, value in rows])
    file = flank_file(
        base.header,
        "gear",
        "convex",
        7,
        np.zeros(n, int),
        np.arange(n),
        np.array([p for p, *_ in rows]),
        normal,
        deviation,
    )
    write_flank_csv(folder / "a.csv", file)
    back = read_flank_csv(folder / "a.csv")
    np.testing.assert_allclose(back.point, file.point, rtol=0, atol=5.1e-10)
    np.testing.assert_allclose(back.normal, file.normal, rtol=0, atol=5.1e-13)
    np.testing.assert_allclose(back.deviation, file.deviation, rtol=0, atol=5.1e-10)
    for name in ("flank", "tooth", "row", "col"):
        np.testing.assert_array_equal(getattr(back, name), getattr(file, name))
    write_flank_csv(folder / "b.csv", back)
    assert (folder / "b.csv").read_bytes() == (folder / "a.csv").read_bytes()


def test_joined_files_keep_all_points_and_select_finds_them_again(tmp_path):
    file = read(tmp_path, TEXT)
    parts = [file.select("concave"), file.select("convex", 35)]
    assert [len(part) for part in parts] == [1, 1]
    np.testing.assert_array_equal(join(parts).point, file.point)
    assert len(file.select("convex", 0)) == 0


def test_write_into_a_folder_that_is_not_there_is_refused_and_leaves_nothing(tmp_path):
    file = read(tmp_path, TEXT)
    with pytest.raises(InputError, match=r"absent.*m\.csv: cannot be written"):
        write_flank_csv(tmp_path / "absent" / "m.csv", file)
    assert [path.name for path in tmp_path.iterdir()] == ["m.csv"]


CONCAVE = "gear,concave,0,0,0,76.5,-3.25,25.125,0.6,-0.8,0,12.5,0.5"


@pytest.mark.parametrize(
    ("old", "new", "sentence"),
    [
        ("member,flank,tooth", "member,flank,teeth", r": is no flank file: the column line must read member,flank,"),
        ("# unit: mm\n", "", r": the header line '# unit: \.\.\.' is missing"),
        ("# settings_sha256: 00ff\n", "", r": the header line '# settings_sha256: \.\.\.' is missing"),
        ("unit: mm", "unit: inch", r": unit = 'inch': must be mm"),
        ("frame: w", "frame: machine", r": frame = 'machine': must be w"),
        ("teeth: 36", "teeth: many", r": member_teeth = 'many': must be a whole number"),
        ("teeth: 36", "teeth: 0", r": member_teeth = '0': must be"),
        ("grid: 5x9", "grid: 5", r": grid = '5': must read like 5x9"),
        ("grid: 5x9", "grid: -5x-9", r": grid = '-5x-9': must read like 5x9"),
        ("grid: 5x9", "grid: 1x9", r": grid = '1x9': must read like 5x9"),
        ("grid: 5x9", "grid: 4x9", r", line 13: row = 4: the header allows 0 to 3"),
        ("grid: 5x9", "grid: 5x8", r", line 13: col = 8: the header allows 0 to 7"),
        ("teeth: 36", "teeth: 35", r", line 13: tooth = 35: the header allows 0 to 34"),
        ("margins: 0.1,0.1", "margins: wide", r": margins = 'wide': must read like 0\.1,0\.1"),
        ("margins: 0.1,0.1", "margins: nan,0.1", r": margins = 'nan,0\.1': must"),
        ("margins: 0.1,0.1", "margins: 0.5,0.1", r": margins = '0\.5,0\.1': must"),
        ("reference_point: 2,4", "reference_point: 2", r": reference_point = '2': must read like 2,4"),
        ("reference_point: 2,4", "reference_point: 5,4", r": reference_point = 5,4: must lie in the grid 5x9"),
        ("0.6,-0.8,0,12.5,0.5", "0.6,-0.8,0,12.5", r", line 12: has 12 columns, must have 13"),
        ("gear,concave", "wheel,concave", r", line 12: member = 'wheel': must be pinion or gear"),
        ("gear,concave", "pinion,concave", r", line 12: member = pinion: the header says member: gear; one file"),
        ("member: gear", "member: pinion", r", line 12: member = gear: the header says member: pinion; one file"),
        ("gear,convex", "gear,coast", r", line 13: flank = 'coast': must be concave or convex"),
        ("concave,0,0,0", "concave,0,0,a", r", line 12: col = 'a': must be a finite number"),
        ("concave,0,0,0", "concave,0,0,1.5", r", line 12: col = 1\.5: must be a whole number from 0"),
        ("concave,0,0,0", "concave,-1,0,0", r", line 12: tooth = -1: must be a whole number from 0"),
        ("76.5,-3.25", "7,6.5,-3.25", r", line 12: has 14 columns"),
        ("76.5,-3.25", "nan,-3.25", r", line 12: x = 'nan': must be a finite number"),
        ("76.5,-3.25", "inf,-3.25", r", line 12: x = 'inf': must be a finite number"),
        ("76.5,-3.25", ",-3.25", r", line 12: x = '': must be a finite number"),
        ("12.5,0.5", "nan,0.5", r", line 12: deviation_um = 'nan': must be a finite number"),
        ("0.6,-0.8,0,12.5", "0.6,-0.8,0.1,12.5", r", line 12: nx, ny, nz have length 1\.0049876, must be 1"),
        (
            "12.5,0.5\n",
            f"12.5,0.5\n{CONCAVE}\n",
            r", line 13: the point flank concave, tooth 0, row 0, col 0 is there twice, in line 12 too",
        ),
    ],
)
def test_fault_is_refused_by_file_line_key_and_value(tmp_path, old, new, sentence):
    assert old in TEXT
    with pytest.raises(InputError, match=r"m\.csv" + sentence):
        read(tmp_path, TEXT.replace(old, new, 1))


@pytest.mark.parametrize(
    ("content", "sentence"),
    [
        (b"", "is no flank file"),
        (TEXT[: TEXT.index("gear,concave")].encode(), "holds no point"),
        (b"\xff\xfe\x00", "is no text file: byte 0 is not UTF-8"),
        (b"a" * 200_000, "is no flank file"),
        (b"\x00", "is no text file: it holds a zero byte"),
        (b'"unfinished', "no flank file"),
        (b"<?xml version='1.0'?>", "no flank file"),
    ],
)
def test_unreadable_file_is_refused_by_name(tmp_path, content, sentence):
    with pytest.raises(InputError, match=f"m\\.csv.*{sentence}"):
        read(tmp_path, content)


def test_file_that_is_not_there_is_refused_by_name(tmp_path):
    with pytest.raises(InputError, match=r"m\.csv: cannot be read"):
        read_flank_csv(tmp_path / "m.csv")


@given(st.text(max_size=80), st.integers(0, len(TEXT) - 1), st.integers(0, 40))
def test_no_mutation_of_a_file_brings_anything_but_a_refusal(tmp_path_factory, inserted, place, removed):
    folder = tmp_path_factory.getbasetemp()
    try:
        file = read(folder, TEXT[:place] + inserted + TEXT[place + removed :], "mutated.csv")
    except (InputError, UnicodeEncodeError):
        return
    assert np.isfinite(file.point).all()
    assert np.abs(np.linalg.norm(file.normal, axis=1) - 1).max() < 2e-6


def test_silent_deviations_stay_silent(tmp_path):
    file = read(tmp_path, TEXT)
    write_flank_csv(tmp_path / "n.csv", replace(file, deviation=np.array([np.nan, 0.0])))
    lines = (tmp_path / "n.csv").read_text().splitlines()[-2:]
    assert lines[0].endswith(",,0.500000")
    assert lines[1].endswith(",0.000000,")
