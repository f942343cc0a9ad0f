"""The reader: what a program commands, from text typed here by hand, and refusals with line and column."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from gearmath.errors import InputError
from gearmath.machine.reader import execute, read_program

HEAD = ["G17 G40 G90 G710 G54", 'T="CUTTER" D1', "M6", "S80 M3", "G0 X0 Y0 Z0 A=DC(0) B0"]


def program(*lines, head=HEAD, end=("M30",)):
    return "\n".join([*head, *lines, *end])


def run(*lines, **parts):
    return execute(program(*lines, **parts), "P.MPF")


def refused(text):
    with pytest.raises(InputError) as caught:
        execute(text, "P.MPF")
    return str(caught.value)


def test_published_example_of_inverse_time_feed():
    """N10 G93 G01 X100 F2 takes 0.5 min [SINUMERIK Fundamentals 11/2006, p. 274]."""
    path = run("N10 G93 G01 X100 F2")
    assert path.axes[-1].tolist() == [100, 0, 0, 0, 0]
    assert path.seconds.tolist() == [0.0, 30.0]


def test_feed_per_minute_counts_along_the_path():
    path = run("G94 G1 X3 Y4 F300", "Z-10", "G0 X0")
    assert path.seconds.tolist() == [0.0, 1.0, 2.0, 0.0]
    assert path.rapid.tolist() == [True, False, False, True]


@pytest.mark.parametrize(
    ("angles", "unwrapped"),
    [
        ([359, 1], [359, 361]),
        ([1, 359], [1, -1]),
        ([90, 200, 350, 100], [90, 200, 350, 460]),
        ([0, 179, 358, 177, 356], [0, 179, 358, 537, 716]),
        ([0, 181], [0, -179]),
    ],
)
def test_dc_takes_the_short_way(angles, unwrapped):
    path = run(*(f"G93 G1 A=DC({angle}) F1" for angle in angles), head=[*HEAD[:4], f"G0 X0 Y0 Z0 A=DC({angles[0]}) B0"])
    np.testing.assert_allclose(path.axes[1:, 3], np.radians(unwrapped), rtol=0, atol=1e-14)


def test_whole_turns_add_no_rounding_error():
    """36000 steps of 0.1 degrees are ten turns, to the last bit of the last position."""
    path = run(*(f"G93 G1 A=DC({k // 10 % 360}.{k % 10}) F1" for k in range(1, 36001)))
    assert path.axes[-1, 3] == np.radians(3600.0)


def test_units_lines_tools_and_modal_words():
    text = "\n".join([
        "; a comment ; another",
        "N10 G17 G40 G90 G710 G94 G54 ; set up",
        'N20 T="A_1" D1', "M6", "S80.5 M3", "M8",
        "G0 Z100",
        "G00 X-1.5 Y2 A=DC(90) B-45",
        "G94 G1 Z50 F100",
        "M5 M9",
        'T="B" D1', "M6", "S20 M4", "",
        "G0 X1 Y1 Z1 A=DC(0) B0",
        "M30", " ; end",
    ])  # fmt: skip
    path = execute(text, "P.MPF")
    expected = [[-1.5, 2, 100, np.pi / 2, -np.pi / 4], [-1.5, 2, 50, np.pi / 2, -np.pi / 4], [1, 1, 1, 0, 0]]
    np.testing.assert_allclose(path.axes, expected, rtol=1e-15)
    assert path.line.tolist() == [8, 9, 15]
    assert path.tools == ("A_1", "B")
    assert path.tool.tolist() == [0, 0, 1]
    assert path.seconds.tolist() == [0.0, 30.0, 0.0]
    assert path.spindle_on.all()


def test_crlf_reads_as_lf():
    text = program("G93 G1 X1 F2")
    assert (execute(text.replace("\n", "\r\n"), "P").axes == execute(text, "P").axes).all()


def test_blocks_keep_line_column_and_value():
    (block,) = read_program("\n\tN7  G1 X-2.5;c", "P.MPF")
    assert block.line == 2
    assert {key: (word.value, word.column) for key, word in block.words.items()} == {
        "N": (7.0, 2),
        "motion": (0.0, 6),
        "X": (-2.5, 9),
    }


@pytest.mark.parametrize(
    "word",
    ["X+1", "X.5", "X1.", "X1E5", "X1e5", "X1.5EX-3", "Xnan", "Xinf", "X1e999", "X", "X=1", "A12.5", "A=AC(1)",
     "A=DC()", "A=DC( 1)", "A=DC(1", "C1", "G2", "G91", "G95", "G53", "G54.1", "M0", "M17", "M30.0", "COMPCAD", "R1=2",
     "x1", "g1", "T1", 'T=""', "(comment)", "O1234", "#1", "%", "/", "N1.5", "X1Y2", "X١", "G９", "X--1", "X0x10",
     "X" + "9" * 400, 'T="A', "X1\x0b", "\x00"],
)  # fmt: skip
def test_unknown_words_are_refused_with_line_and_column(word):
    message = refused(program(f"G1 {word} F1"))
    assert message.startswith("P.MPF, line 6, column 4: the word ")
    assert message.endswith("is not understood")
    assert len(message) < 120


@pytest.mark.parametrize(
    ("lines", "where", "sentence"),
    [
        (["G93 G1 X1 Y1 X1 F1"], "line 6, column 14", "X1 is a second value for X in one block"),
        (["G0 G1 X1"], "line 6, column 4", "G1 is a second value for motion in one block"),
        (["G1 N10 X1"], "line 6, column 4", "the block number N10 must be the first word"),
        (["G93 G1 X1"], "line 6, column 8", "F is missing: every G93 block needs its own"),
        (["G93 G1 X1 F1", "X2"], "line 7, column 1", "F is missing: every G93 block needs its own"),
        (["G94 F100", "G93 G1 X1 F1", "G94 X2"], "line 8, column 5", "cutting move without a feed F"),
        (["G1 X1 F1"], "line 6, column 4", "cutting move before G93 or G94"),
        (["G93 G1 X1 F0"], "line 6, column 11", "F0: must be greater than 0"),
        (["M3 S0"], "line 6, column 4", "S0: must be greater than 0"),
        (["M5", "G93 G1 X1 F1"], "line 7, column 8", "cutting move with the spindle off"),
        (["G94 G1 A=DC(1) F1"], "line 6, column 8", "G94 with A turning: write such a block with G93"),
        (["G94 G1 B1 F1"], "line 6, column 8", "G94 with B turning: write such a block with G93"),
        (["A=DC(360)"], "line 6, column 1", "A=DC(360) is out of range: DC takes 0 to less than 360 degrees"),
        (["A=DC(-0.1)"], "line 6, column 1", "A=DC(-0.1) is out of range: DC takes 0 to less than 360 degrees"),
        (["G93 G1 A=DC(180) F1"], "line 6, column 1", "A turns by exactly 180 degrees: DC leaves the direction open"),
        (["G0 X1 M5"], "line 6, column 7", "M5 and axis words in one block"),
        (["M6"], "line 6, column 1", "M6 with the spindle on"),
        (['T="B" D1', "G0 X1"], "line 7, column 4", 'motion without a tool: T="..." D1 and M6 must come first'),
        (["M5", "M6", "M3", "G93 G1 X1 F1"], "line 9, column 8", "cutting move from an unknown position of X Y Z A B"),
        (["G55"], "line 6, column 1", "G55 after G54: one work offset is understood"),
        (["D2"], "line 6, column 1", "D2: only the cutting edge D1 is understood"),
        (["M30", "G0 X1"], "line 7, column 1", "there is a block after M30"),
    ],
)
def test_refusals_name_line_column_and_reason(lines, where, sentence):
    assert refused(program(*lines)) == f"P.MPF, {where}: {sentence}"


@pytest.mark.parametrize(
    ("head", "where", "sentence"),
    [
        (HEAD[:1] + HEAD[4:], "line 2, column 4", 'motion without a tool: T="..." D1 and M6 must come first'),
        (HEAD[:2] + HEAD[4:], "line 3, column 4", 'motion without a tool: T="..." D1 and M6 must come first'),
        ([*HEAD[:1], "M6"], "line 2, column 1", "M6 without a tool: T is missing"),
        ([*HEAD[:3], "M3"], "line 4, column 1", "M3 without a spindle speed S"),
        (HEAD[1:], "line 4, column 4", "motion before the plane is stated (G17)"),
        (["G17 G40 G710 G54", *HEAD[1:]], "line 5, column 4", "motion before the dimensioning is stated (G90)"),
        ([*HEAD[:4], "X0"], "line 5, column 1", "axis words without G0 or G1"),
    ],
)
def test_refusals_of_an_incomplete_start(head, where, sentence):
    assert refused(program(head=head)) == f"P.MPF, {where}: {sentence}"


def test_truncated_program_is_refused_wherever_it_was_cut():
    text = program("G93 G1 X1 F2", "G93 G1 X2.25 A=DC(1.5) F2")
    for length in range(len(text)):
        with pytest.raises(InputError):
            execute(text[:length], "P.MPF")
    assert refused(text[:-4]) == "P.MPF, line 7, column 1: the text ends without M30: the program is not complete"


def test_a_program_without_motion_has_an_empty_path():
    assert execute("M30", "P.MPF").axes.shape == (0, 5)


def run_or_refuse(text):
    """Nothing but InputError may come out, and every path must be finite."""
    try:
        path = execute(text, "P.MPF")
    except InputError:
        return
    assert np.isfinite(path.axes).all()
    assert np.isfinite(path.seconds).all()


@given(st.text())
def test_no_text_crashes_the_reader(text):
    run_or_refuse(text)


PIECES = st.sampled_from(
    [*" ".join(HEAD).split(), "G93", "G94", "G1", "G0", "X1.5", "Y-2", "A=DC(359)", "A=DC(179)", "B1", "F1", "F0",
     "M5", "M6", "M30", "N1", ";", '"', "-", ".", "9" * 9, "\r", "G55", "D0", "S0"]
)  # fmt: skip


@given(st.lists(st.tuples(PIECES, st.sampled_from([" ", "\n", "", "\t"])), max_size=30))
def test_no_row_of_words_crashes_the_reader(pieces):
    run_or_refuse(program("".join(piece + gap for piece, gap in pieces)))


WHOLE = program("G94 G1 Z-1 F200", "G93 G1 X1.50000 Y2 Z3 A=DC(359.999999) B0.5 F12.5", "G94 G0 Z100 F200", "M5 M9")


@settings(max_examples=300)
@given(st.integers(0, len(WHOLE) - 1), st.integers(0, 3), st.text(st.characters(codec="utf-8"), max_size=3))
def test_no_mutation_of_a_program_crashes_the_reader(place, removed, inserted):
    run_or_refuse(WHOLE[:place] + inserted + WHOLE[place + removed :])
