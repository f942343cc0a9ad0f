"""Touch files: what the control writes is read, and what is no run of touches is refused."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gearmath.errors import InputError
from gearmath.specs.calibration import load_calibration
from gearmath.specs.toml import bundled
from gearmath.specs.touch_csv import CALIBRATION_COLUMNS, COLUMNS, read_calibration_csv, read_touch_csv

HEAD = "run,point,member,flank,tooth,row,col,X,Y,Z,A,B,triggered"
ROWS = [
    "1,1,gear,concave,0,2,4,-80.5,1.25,551.125,90,45,1",
    "1,2,gear,convex,0,2,4,-80.5,1.25,551.125,350.5,45,1",
    "1,3,gear,concave,1,2,4,-1,2,3,4,5,1",
]


def read(tmp_path, *lines, run=None):
    file = tmp_path / "raw.csv"
    file.write_text("\n".join(lines) + "\n")
    return read_touch_csv(file, run)


def test_columns_are_those_of_the_contract(tmp_path):
    assert ",".join(COLUMNS) == HEAD
    touches = read(tmp_path, HEAD, *ROWS)
    assert (touches.run, touches.member, len(touches)) == (1, "gear", 3)
    assert touches.flank.tolist() == ["concave", "convex", "concave"]
    assert touches.tooth.tolist() == [0, 0, 1]
    assert (touches.row.tolist(), touches.col.tolist()) == ([2, 2, 2], [4, 4, 4])
    np.testing.assert_allclose(touches.axes[0], [-80.5, 1.25, 551.125, np.pi / 2, np.pi / 4], rtol=1e-15)


def test_numbers_as_the_control_may_write_them_and_points_from_zero(tmp_path):
    """A REAL without decimals, with six of them, with blanks; comments and empty lines are not touches."""
    touches = read(tmp_path, "# made by hand", "1.0,0.000000, gear ,convex,3.000000,2,4,1,2,3,4,5,1.000000", "")
    assert (touches.run, touches.tooth.tolist()) == (1, [3])


def test_the_last_run_is_taken_unless_another_is_asked_for(tmp_path):
    lines = [HEAD, *ROWS, HEAD, *(row.replace("1,", "4,", 1).replace("gear", "pinion") for row in ROWS[:2])]
    assert (read(tmp_path, *lines).run, read(tmp_path, *lines).member) == (4, "pinion")
    assert len(read(tmp_path, *lines, run=1)) == 3
    with pytest.raises(InputError, match=r"raw\.csv: holds no run 2, but 1, 4"):
        read(tmp_path, *lines, run=2)


@pytest.mark.parametrize(
    ("lines", "sentence"),
    [
        ([], r"holds no touch; the column line reads run,point,member"),
        ([HEAD], r"holds no touch"),
        (["1,1,gear,concave"], r"line 1: has 4 columns, must have 13"),
        ([ROWS[0].replace("gear", "wheel")], r"line 1: member = 'wheel': must be pinion or gear"),
        ([ROWS[0].replace("concave", "left")], r"line 1: flank = 'left': must be concave or convex"),
        ([ROWS[0].replace("-80.5", "x")], r"line 1: X = 'x': must be a finite number"),
        ([ROWS[0].replace("-80.5", "nan")], r"line 1: X = 'nan': must be a finite number"),
        ([ROWS[0].replace("-80.5", "1e9")], r"line 1: X = 1e9: must be at most 100000 in size"),
        ([ROWS[0].replace(",0,2,4", ",0,2.5,4")], r"line 1: row = 2\.5: must be a whole number from 0"),
        ([ROWS[0].replace(",0,2,4", ",-1,2,4")], r"line 1: tooth = -1: must be a whole number from 0"),
        ([ROWS[0][:-1] + "0"], r"run 1: triggered = 0 in all of its 1 touch: it met no flank"),
        ([ROWS[0], ROWS[2]], r"line 2: point = 3: must be 2, without a gap"),
        ([ROWS[1]], r"line 1: run 1 begins with point = 2: must be 0 or 1"),
        ([*ROWS[:2], ROWS[0].replace("1,1", "1,3", 1)], r"line 3: the point of line 1 is there twice; touches of one"),
        ([ROWS[0], ROWS[1].replace("gear", "pinion")], r"line 2: member = pinion: run 1 began with the gear: one run"),
    ],
)
def test_what_is_no_run_of_touches_is_refused(tmp_path, lines, sentence):
    with pytest.raises(InputError, match=rf"raw\.csv.*{sentence}"):
        read(tmp_path, *lines)


def test_touches_of_one_point_follow_each_other(tmp_path):
    """As --repeat has them; and tooth z is a tooth like others here."""
    again = [ROWS[0].replace("1,1", f"1,{k}", 1) for k in (1, 2, 3)]
    last = ROWS[0].replace("1,1", "1,4", 1).replace("concave,0", "concave,36")
    assert read(tmp_path, *again, last).tooth.tolist() == [0, 0, 0, 36]


def test_missing_file_is_one_sentence(tmp_path):
    with pytest.raises(InputError, match="no_such"):
        read_touch_csv(tmp_path / "no_such.csv")


@given(st.text(), st.lists(st.sampled_from([*ROWS, HEAD, "1,", ",", '"', "#", "1e5,"]), max_size=5))
def test_no_text_crashes_the_reading(tmp_path_factory, text, rows):
    file = tmp_path_factory.mktemp("touch") / "raw.csv"
    file.write_text(text + "\n".join(rows), encoding="utf-8", errors="replace")
    for reader in (read_touch_csv, read_calibration_csv):
        try:
            assert np.isfinite(reader(file).axes).all()
        except InputError:
            continue


def test_calibration_touches_have_their_own_columns(tmp_path):
    file = tmp_path / "c.csv"
    file.write_text(",".join(CALIBRATION_COLUMNS) + "\n1,1,ring_x_low,1,2,3,0,0,1\n1,2,sphere,4,5,6,0,0,1\n")
    touches = read_calibration_csv(file)
    assert touches.target.tolist() == ["ring_x_low", "sphere"]
    np.testing.assert_allclose(touches.axes[:, :3], [[1, 2, 3], [4, 5, 6]])
    file.write_text("1,1,cube,1,2,3,0,0,1\n")
    with pytest.raises(InputError, match="target = 'cube': must be ring_x_low or"):
        read_calibration_csv(file)


@pytest.mark.parametrize(
    ("old", "new", "sentence"),
    [
        ("tip_radius = 0.75", "tip_radius = 0.0", "tip_radius = 0.0: "),
        ("tip_radius = 0.75", "tip_radius = 0.4", "stylus_radius 0.5 must be less than tip_radius 0.4"),
        ("offset = [0.0, 0.0, 0.0]", "offset = [0.0, 6.0, 0.0]", "offset must lie between -5 and 5 mm"),
        ("offset = [0.0, 0.0, 0.0]", "offset = [0.0, nan, 0.0]", "must be a finite number"),
        ("stylus_length = 30.0", "stylus_length = 200.0", "stylus_length 200.0 must be less than length 200.0"),
        ("length = 200.0", "", "length: the key is missing"),
        ("overtravel = 0.5", "overtravels = 0.5", "overtravels: no such key; did you mean overtravel?"),
        ("diameter = 30.0", "diameter = 400.0", "ring.diameter = 400.0"),
        ("stem_diameter = 6.0", "stem_diameter = 15.0", "stem_diameter 15.0 must be at most 0.6 of diameter 20.0"),
        ("height = 25.0", "height = -1.0", "ring.face.height = -1.0"),
        ("height = 25.0", "height = 10.0", "Z 400.0 of center must be below the face, 395.0"),
    ],
)
def test_calibration_that_cannot_be_is_refused_with_key_value_and_limit(tmp_path, old, new, sentence):
    text = bundled("probe.toml").read_text()
    assert old in text
    file = tmp_path / "probe.toml"
    file.write_text(text.replace(old, new, 1))
    with pytest.raises(InputError) as caught:
        load_calibration(file)
    assert sentence in str(caught.value)
    assert str(file) in str(caught.value)
