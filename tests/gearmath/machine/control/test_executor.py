"""The executor: what a program does, from text typed here by hand, and refusals with line and column."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from gearmath.errors import InputError
from gearmath.machine.control.executor import execute, run_program

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
    text = "\n".join(
        [
            "; a comment ; another",
            "N10 G17 G40 G90 G710 G94 G54 ; set up",
            'N20 T="A_1" D1',
            "M6",
            "S80.5 M3",
            "M8",
            "G0 Z100",
            "G00 X-1.5 Y2 A=DC(90) B-45",
            "G94 G1 Z50 F100",
            "M5 M9",
            'T="B" D1',
            "M6",
            "S20 M4",
            "",
            "G0 X1 Y1 Z1 A=DC(0) B0",
            "M30",
            " ; end",
        ]
    )
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
        (
            ["G94 G1 A=DC(1) F1"],
            "line 6, column 8",
            "G94 with A turning: write such a block with G93, or FGROUP before it",
        ),
        (["G94 G1 B1 F1"], "line 6, column 8", "G94 with B turning: write such a block with G93, or FGROUP before it"),
        (["A=DC(360)"], "line 6, column 1", "A=DC(360) is out of range: DC takes 0 to less than 360 degrees"),
        (["A=DC(-0.1)"], "line 6, column 1", "A=DC(-0.1) is out of range: DC takes 0 to less than 360 degrees"),
        (["G93 G1 A=DC(180) F1"], "line 6, column 8", "A turns by exactly 180 degrees: DC leaves the direction open"),
        (["G0 X1 M5"], "line 6, column 7", "M5 and axis words in one block"),
        (["M6"], "line 6, column 1", "M6 with the spindle on"),
        (['T="B" D1', "G0 X1"], "line 7, column 4", 'motion without a tool: T="..." D1 and M6 must come first'),
        (["M5", "M6", "M3", "G93 G1 X1 F1"], "line 9, column 8", "cutting move from an unknown position of X Y Z A B"),
        (["G55"], "line 6, column 1", "G55 after G54: one work offset is understood"),
        (["D2"], "line 6, column 1", "D2: only the cutting edge D1, and D0 for none, are understood"),
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
    [
        *" ".join(HEAD).split(),
        "G93",
        "G94",
        "G1",
        "G0",
        "X1.5",
        "Y-2",
        "A=DC(359)",
        "A=DC(179)",
        "B1",
        "F1",
        "F0",
        "C=DC(181)",
        "C9",
        "SPOS=0",
        "M5",
        "M6",
        "M30",
        "N1",
        ";",
        '"',
        "-",
        ".",
        "9" * 9,
        "\r",
        "G55",
        "D0",
        "S0",
    ]
)


@given(st.lists(st.tuples(PIECES, st.sampled_from([" ", "\n", "", "\t"])), max_size=30))
def test_no_row_of_words_crashes_the_reader(pieces):
    run_or_refuse(program("".join(piece + gap for piece, gap in pieces)))


WHOLE = program("G94 G1 Z-1 F200", "G93 G1 X1.50000 Y2 Z3 A=DC(359.999999) B0.5 F12.5", "G94 G0 Z100 F200", "M5 M9")


@settings(max_examples=300)
@given(st.integers(0, len(WHOLE) - 1), st.integers(0, 3), st.text(st.characters(codec="utf-8"), max_size=3))
def test_no_mutation_of_a_program_crashes_the_reader(place, removed, inserted):
    run_or_refuse(WHOLE[:place] + inserted + WHOLE[place + removed :])


PROBE_HEAD = [HEAD[0] + " G94", 'T="PROBE" D1', "M6", "SPOS=0", "G0 X0 Y0 Z0 A=DC(350) B0"]


def probing(*lines, probe=None, **options):
    return run_program(program(*lines, head=PROBE_HEAD), "P.MPF", probe, **options)


def test_logic_and_arithmetic_as_on_the_control():
    """Degrees; AND binds closer than ==; DIV truncates; FOR runs to its end value; INT rounds."""
    done = run_program(
        "\n".join(
            [
                "DEF INT UN=2.5, UF[3]",
                "DEF REAL UX=1.5",
                "R1=SIN(30)+2*3-(7 DIV 2) R2=ATAN2(1,-1) R3=(7 MOD 4) R4=-(2+1)/2 R[4+1]=UN*UX",
                "IF (R1==3.5) AND NOT (R3<>3)",
                "R6=1",
                "ELSE",
                "R6=2",
                "ENDIF",
                "FOR R7=1 TO 3",
                "R8=R8+R7 UF[R7-1]=R7*10",
                "ENDFOR",
                "R9=UF[2]",
                "WHILE R10*R10<50",
                "R10=R10+1",
                "ENDWHILE",
                'MSG("R10 is "<<R10<<" now "<<-0.5)',
                "M30",
            ]
        ),
        "P.MPF",
    )
    expected = {1: 3.5, 2: 135, 3: 3, 4: -1.5, 5: 4.5, 6: 1, 7: 4, 8: 6, 9: 30, 10: 8}
    assert done.parameters == pytest.approx(expected, abs=1e-14)
    assert done.messages == ("R10 is 8 now -0.5",)


def test_axis_words_take_expressions_increments_and_the_translation():
    done = run(
        "R1=90 R2=12",
        "TRANS X100 Z=R2",
        "G0 X1 Y=IC(5)",
        "X=AC(2) Z-1",
        "A=DC(R2*360/R1) SUPA X3",
        "TRANS",
        "X4 B=-R2/2",
    )
    np.testing.assert_allclose(done.axes[1:, :3], [[101, 5, 0], [102, 5, 11], [3, 5, 11], [4, 5, 11]])
    np.testing.assert_allclose(np.degrees(done.axes[-1, 3:]), [48, -6])


def test_acp_and_acn_turn_their_way_and_a_counting_axis_counts():
    path = run("G0 A=DC(350)", "A=ACP(10)", "A=ACN(350)", "A=ACP(340)", "A=ACN(340)", "A=IC(30)")
    np.testing.assert_allclose(np.degrees(path.axes[1:, 3]), [-10, 10, -10, 340, 340, 370])
    counting = run("G93 G1 A400 F1", "A=AC(-400) F1", head=[*HEAD[:4], "G0 X0 Y0 Z0 A0 B0"])
    np.testing.assert_allclose(np.degrees(counting.axes[:, 3]), [0, 400, -400])


def test_feed_group_tells_what_f_means_for_a_rotary_axis():
    """FGREF 57.296 mm: a degree is a millimetre; a radius of 100 mm: 90 degrees are 157.08 mm."""
    path = run(
        "FGROUP(X,Y,Z,A)",
        "FGREF[A]=100",
        "G94 G1 A=DC(90) F1000",
        "FGROUP(X,A)",
        "FGREF[A]=57.295779513082",
        "X40 A=DC(120) F600",
    )
    np.testing.assert_allclose(path.seconds[1:], [60 * np.pi * 50 / 1000, 5.0], rtol=1e-12)


def test_probe_stops_where_it_triggers_and_only_what_is_named_is_latched():
    seen = []

    def probe(start, end):
        seen.append((start, end))
        return start + 0.25 * (end - start)

    done = probing(
        "TRANS X5",
        "FGROUP(X,Y,Z,A,B)",
        "MEAS=1 G1 X15 Y=IC(0) A=IC(8) F100",
        "STOPRE",
        "R1=$AA_MM[X] R2=$AA_MW[X] R3=$AA_MM[A] R4=$AC_MEA[1] R5=$A_PROBE[1]",
        probe=probe,
    )
    assert [done.parameters[k] for k in range(1, 6)] == pytest.approx([5, 0, 352, 1, 0])
    np.testing.assert_allclose(seen[0][1] - seen[0][0], [20, 0, 0, np.radians(8), 0], atol=1e-12)
    assert done.path.measuring.tolist() == [False, True]
    assert done.path.axes[-1, 0] == 5.0


def test_probe_that_meets_nothing_goes_to_the_end_and_says_so():
    done = probing(
        "MEAS=1 G1 X20 F100",
        "STOPRE",
        "IF $AC_MEA[1]==0",
        "SETAL(65001)",
        "M30",
        "ENDIF",
        "R1=1",
        probe=lambda start, end: None,
    )
    assert done.alarm == (65001, 9)
    assert 1 not in done.parameters
    assert done.path.axes[-1, 0] == 20


def test_what_a_host_writes_is_seen_after_stopre_only():
    wait = ["R101=1", "WHILE R103<>R101", "G4 F0.05", "STOPRE", "ENDWHILE"]
    answers = iter([{}, {}, {103: 1.0}])
    assert run_program(program(*wait), "P", host=lambda parameters: next(answers)).parameters[103] == 1
    with pytest.raises(InputError, match="is not at its end after 1000 steps"):
        run_program(program(*wait[:3], "ENDWHILE"), "P", host=lambda parameters: {103: 1.0}, step_limit=1000)


def test_a_watcher_hears_every_statement_before_it_acts_and_every_motion_and_can_end_the_program():
    text = program("R1=1", "G94 G1 X3 Y4 F300", "R1=2", "R1=3")
    heard = []

    def watch(moment):
        heard.append((moment.line, moment.parameters.get(1), None if moment.row is None else moment.row.seconds))
        if moment.parameters.get(1) == 2.0:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        run_program(text, "P.MPF", watch=watch)
    assert heard[-5:] == [(6, None, None), (7, 1.0, None), (7, 1.0, 1.0), (8, 1.0, None), (9, 2.0, None)]


def test_files_are_written_line_by_line():
    done = run_program('DEF INT UE\nR1=1.25\nWRITE(UE,"F_1","a;"<<R1)\nWRITE(UE,"F_1","b")\nM30', "P")
    assert done.files == {"F_1": "a;1.25\nb\n"}


@pytest.mark.parametrize(
    ("lines", "where", "sentence"),
    [
        (["WHILE 1==1", "ENDWHILE"], "line 6, column 1", "the program is not at its end after 1000000 steps"),
        (["R1=1/0"], "line 6, column 5", "/ has no result for 1.0, 0.0"),
        (["R1=SQRT(-1)"], "line 6, column 4", "SQRT has no result for -1.0"),
        (["R1=99999999*10"], "line 6, column 12", "* gives 1e+09: a number may be at most 99999999 in size"),
        (["R1=R2 AND R3"], "line 6, column 7", "AND is applied to number"),
        (["IF R1 AND R2", "ENDIF"], "line 6, column 7", "AND is applied to number"),
        (["IF R1", "ENDIF"], "line 6, column 1", "a condition is needed here, such as R1==2"),
        (['R1="a"'], "line 6, column 1", "a number is needed here, not a text"),
        (["R1000=1"], "line 6, column 1", "R1000: R parameters go from 0 to 999"),
        (["R[0.5]=1"], "line 6, column 1", "R[0.5]: the index must be a whole number from 0"),
        (["R1=UX"], "line 6, column 4", "the variable UX is not defined"),
        (["DEF INT UX"], "line 6, column 1", "DEF after the first motion"),
        (["R1=$AA_MM[X]"], "line 6, column 4", "$AA_MM without a MEAS block and STOPRE before it"),
        (["G94 MEAS=1 G1 X1 F1"], "line 6, column 5", "MEAS=1 needs a spindle that is held by SPOS"),
        (["MEAS=1"], "line 6, column 1", "MEAS=1 without axis words"),
        (["MEAS=2 G1 X1"], "line 6, column 1", "MEAS=2: only MEAS=1, the rising edge of probe 1, is understood"),
        (
            ["G93 COMPCAD"],
            "line 6, column 5",
            "COMPCAD and G93 at once: a block made of several would take the time of the last one",
        ),
        (["A12.5"], "line 6, column 1", "A12.5: A is counted on in one block and modulo in another"),
        (["B=DC(5)"], "line 6, column 1", "B=DC(5): only A and C turn without end"),
        (["X=1000*1001"], "line 6, column 1", "X=1000*1001 leads to 1.001e+06: no axis is that long"),
        (["TRANS A5"], "line 6, column 1", "TRANS of a rotary axis is not understood"),
        (["SETAL(1)"], "line 6, column 1", "SETAL(1.0): alarms of users go from 65000 to 69999"),
        (["SETAL(65000)"], "line 6, column 1", "the program sets alarm 65000"),
        (['WRITE(R1,"F","t")'], "line 6, column 1", "the first argument of WRITE must be a variable of DEF INT"),
        (["G4"], "line 6, column 1", "G4 without a time F"),
    ],
)
def test_refusals_of_logic_and_probing(lines, where, sentence):
    assert refused(program(*lines)) == f"P.MPF, {where}: {sentence}"


def test_measured_positions_need_stopre_and_their_axis():
    touch = ["MEAS=1 G1 X1 F1"]
    for lines, sentence in (
        ([*touch, "R1=$AA_MM[X]"], r"line 7, column 4: \$AA_MM without a MEAS block and STOPRE before it"),
        ([*touch, "STOPRE", "R1=$AA_MM[Y]"], r"line 8, column 4: \$AA_MM\[Y\]: Y was not in the MEAS block"),
    ):
        with pytest.raises(InputError, match=sentence):
            probing(*lines, probe=lambda start, end: end)
    with pytest.raises(InputError, match="there is no probe that could touch anything"):
        probing(*touch)
