"""The reader: words and structure of hand-typed text, what it refuses, and the way from writer to reader and back."""

from __future__ import annotations

import contextlib
import re
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from gearmath.errors import InputError
from gearmath.machine.control.executor import execute, run_program
from gearmath.machine.control.expression import Constant, NcVariable, Operation
from gearmath.machine.control.reader import read_program
from gearmath.machine.control.tree import Block, Branch, Command, Definition, Loop, Word
from gearmath.machine.planning.clear_space import Room
from gearmath.machine.planning.cut_plan import CuttingJob
from gearmath.machine.planning.pattern import Targets
from gearmath.machine.planning.targets import APPROACH_FEED, MEASURING_FEED
from gearmath.machine.writing.cutting import cutting_program
from gearmath.machine.writing.probing import probing_program, write_touches
from gearmath.machine.writing.program import Pass, write_program
from gearmath.specs.bevel_set import load_bevel_set
from gearmath.specs.calibration import load_calibration
from gearmath.specs.milling_machine import load_milling_machine
from gearmath.specs.toml import bundled

MACHINE = load_milling_machine(bundled("vertical_5axis.toml"))
PROBE = load_calibration(bundled("probe.toml"))


def body(text):
    return read_program(text, "P.MPF").body


def refused(text):
    with pytest.raises(InputError) as caught:
        read_program(text, "P.MPF")
    return str(caught.value)


def test_blocks_keep_line_column_and_value():
    (block,) = body("\n\tN7  G1 X-2.5 A=DC(90) B=IC(-R1);c")
    assert (block.line, block.assignments) == (2, ())
    assert {key: (word.text, word.column, word.way) for key, word in block.words.items()} == {
        "N": ("N7", 2, ""),
        "motion": ("G1", 6, ""),
        "X": ("X-2.5", 9, ""),
        "A": ("A=DC(90)", 15, "DC"),
        "B": ("B=IC(-R1)", 24, "IC"),
    }
    assert block.words["X"].value == Constant(-2.5)
    assert block.words["B"].value == Operation("negative", (NcVariable("R", (Constant(1.0),), 30),), 29)


def test_every_kind_of_statement_becomes_its_own_node():
    text = "\n".join(
        [
            "DEF INT UERR",
            "DEF REAL UX=1.5, UARR[4,2]",
            "R1=2 R[R1+1]=UX*3 UARR[1,0]=4",
            "FOR R2=0 TO 3",
            "IF R2==1",
            'MSG("a;b")',
            "ELSE",
            "STOPRE",
            "ENDIF",
            "ENDFOR",
            "WHILE (R1<5) AND NOT (R2==0)",
            "R1=R1+1",
            "ENDWHILE",
            "TRANS X1.5 Z=R1",
            "FGROUP(X,Y,A)",
            "SETAL(65001)",
            'WRITE(UERR,"FILE","text "<<R1)',
        ]
    )
    kinds = [type(statement) for statement in body(text)]
    assert kinds == [Definition, Definition, Block, Loop, Loop, Command, Command, Command, Command]
    loop = body(text)[3]
    (branch,) = loop.body
    assert isinstance(branch, Branch)
    assert [[type(part) for part in side] for side in (branch.then, branch.otherwise)] == [[Command], [Command]]
    assert branch.then[0].arguments == (Constant("a;b"),)
    assert [target.target.name for target in body(text)[2].assignments] == ["R", "R", "UARR"]


def test_comments_are_kept_by_line():
    program = read_program('; head\nG1 X1 ; here\nMSG("no ; comment")\n\n;', "P")
    assert program.comments == {1: "head", 2: "here", 5: ""}
    assert program.lines == 5


@pytest.mark.parametrize(
    "word",
    ["Xnan", "Xinf", "X", "G54.1", "M30.0", "/", "N1.5", "X--1", "U1", "X1.2.3", "X.", "G1_", "X1,5", "M3)"],
)
def test_unknown_words_are_refused_with_line_and_column(word):
    message = refused(f"G17\nG1 {word} F1")
    assert re.match(r"P\.MPF, line 2, column [4-8]: the word '.*' is not understood", message), message
    assert len(message) < 130


@pytest.mark.parametrize(
    ("text", "where", "sentence"),
    [
        ("IF R1==1", "line 1, column 1", "the text ends within the IF of line 1"),
        ("WHILE R1==1\nIF R2==1\nENDWHILE", "line 3, column 1", "ENDWHILE without its WHILE"),
        ("ENDIF", "line 1, column 1", "ENDIF without its IF"),
        ("IF R1==1\nELSE\nELSE\nENDIF", "line 3, column 1", "ELSE without its IF"),
        ("N5 IF R1==1 G1", "line 1, column 13", "'G1' after IF: nothing else may stand in its block"),
        ("STOPRE G1", "line 1, column 8", "'G1' after STOPRE: nothing else may stand in its block"),
        ("\n".join(["IF R1==1"] * 9), "line 9, column 1", "IF is nested more than 8 deep"),
        ("R1=" + "(" * 30 + "1" + ")" * 30, "line 1, column 25", "an expression is nested more than 20 deep"),
        ("R1=1+", "line 1, column 6", "'the end of the line' is no number, variable or function"),
        ("R1=SIN(1,2)", "line 1, column 4", "SIN takes 1 number, not 2"),
        ("R1=(1", "line 1, column 6", "')' is missing"),
        ("R1=$AA_IW[X]", "line 1, column 4", "the system variable '$AA_IW' is not understood"),
        ("R1=$AA_IM[C]", "line 1, column 11", "$AA_IM of 'C]' is not understood"),
        ("R1=$P_ACTFRAME[A,RT]", "line 1, column 16", "$P_ACTFRAME of 'A,RT]' is not understood"),
        ("R1=$P_TOOLL[2]", "line 1, column 13", "$P_TOOLL of '2]' is not understood"),
        ("R1=$AA_MM[C]", "line 1, column 11", "$AA_MM of 'C]' is not understood"),
        ("IF R1==1 AND R2==2\nENDIF", "line 1, column 16", "'==2' after IF: nothing else may stand in its block"),
        ("DEF BOOL UX", "line 1, column 5", "DEF knows INT and REAL only"),
        ("DEF INT U", "line 1, column 9", "the name of a variable is missing; it begins with two letters"),
        ("DEF INT UX[2000]", "line 1, column 9", "the size of a field must be a whole number from 1 to 1000"),
        ("FOR R1=1 3", "line 1, column 10", "'TO' is missing"),
        ("FGROUP(X,Q)", "line 1, column 8", "FGROUP takes axes with commas between them"),
        ("X=POP(1)", "line 1, column 3", "POP is no function that is understood"),
        (
            "X=PO()",
            "line 1, column 1",
            "'X=PO()' has 0 values: it takes the end point and up to 4 coefficients, a2 to a5",
        ),
        (
            "PO[X]=(1,2,3,4)",
            "line 1, column 1",
            "'PO[X]=(1,2,3,4)' has 4 values: it takes the end point and up to 2 coefficients, a2 to a3",
        ),
        ("PO[X]=(1,2", "line 1, column 11", "')' is missing"),
        ("PO[Q]=(1,2)", "line 1, column 1", "the word 'PO[Q]=(1,2)' is not understood"),
        ("X1 PO[X]=(1,2)", "line 1, column 4", "PO[X]=(1,2) is a second value for X in one block"),
        ("PO[X]=(1,2)Y1", "line 1, column 12", "'Y1' is not understood: a blank may be missing before it"),
        ("A=PO(DC(1))", "line 1, column 6", "DC is no function that is understood"),
        ("TRANS X=IC(1)", "line 1, column 7", "TRANS takes axes with a number, not X=IC(1)"),
        ("G1 X1 Y1 X1", "line 1, column 10", "X1 is a second value for X in one block"),
        ("G0 G1 X1", "line 1, column 4", "G1 is a second value for motion in one block"),
        ("G1 N10 X1", "line 1, column 4", "the block number N10 must be the first word"),
    ],
)
def test_refusals_name_line_column_and_reason(text, where, sentence):
    assert refused(text) == f"P.MPF, {where}: {sentence}"


def blocks_of(body):
    """All blocks, those in branches too."""
    for part in body:
        if isinstance(part, Block):
            yield part
        elif isinstance(part, Branch):
            yield from blocks_of(part.then)


def but_for_the_room(text):
    """The text without the line that says where the tool must not stand at the start: the reader knows no member."""
    return [line for line in text.split("\n") if "$AA_IM[Z]" not in line and "raise Z by hand" not in line]


ROOM = Room(0.0, 0.0, 0.0)


def written_again(text):
    """What the writer makes of what the reader understood: positions, times, names and comments, in its own words."""
    program, path = read_program(text, "P.MPF"), execute(text, "P.MPF")
    blocks = {block.line: block.words for block in blocks_of(program.body)}
    header = [comment for line, comment in program.comments.items() if line < program.body[0].line]
    begins = np.flatnonzero(~path.rapid & np.roll(path.rapid, 1))
    passes = []
    turning = np.isfinite(path.cutter).any()
    axes = np.column_stack([path.axes, path.cutter]) if turning else path.axes
    for begin in begins:
        end = begin + int(np.argmax(path.rapid[begin:]))
        line = path.line[begin]
        label, _, tooth = program.comments[max(k for k in program.comments if k < line)].rpartition(", tooth ")
        label = label.partition(": ")[2]
        dwell = blocks[line + end - begin].get("dwell") and blocks[line + end - begin]["F"].value.value
        passes.append(
            Pass(
                path.tools[path.tool[begin]],
                label,
                int(tooth),
                axes[begin:end],
                path.seconds[begin + 1 : end],
                dwell or 0.0,
            )
        )
    highest = max(one.axes[:, 2].max() for one in passes)
    speeds = {words["S"].value.value for words in blocks.values() if "S" in words}
    assert len(speeds) == (0 if turning else 1)  # the cutter's axis has no S
    rpm = max(speeds, default=100.0)
    return write_program(
        header[0],
        header[1:],
        passes,
        FASTER,
        rpm,
        path.axes[begins[0] - 1, 2] - highest,
        ROOM,
        0.0,
        blocks[path.line[begins[0]]]["F"].value.value,
        any(words.get("coolant", NO).text == "M8" for words in blocks.values()),
    )


#: Speeds that the rounding of the text cannot pass.
FASTER = MACHINE.model_copy(
    update={
        "axes": MACHINE.axes.model_copy(
            update={
                axis: getattr(MACHINE.axes, axis).model_copy(update={"max_speed_per_min": 1e6, "max_acceleration": 1e9})
                for axis in "XYZABC"
            }
        )
    }
)
NO = Word("", Constant(0.0), 0)


@pytest.mark.parametrize("member", ["pinion", "gear"])
@pytest.mark.parametrize("options", [{}, {"roughing_stock": 0.3, "finishing_stock": 0.1}, {"dry_run": True}])
def test_writer_reader_writer_gives_the_same_text(gear_set, member, options):
    text = cutting_program(gear_set, member, MACHINE, "CUT", CuttingJob((0, 7), 1e-3, **options))
    assert but_for_the_room(written_again(text)) == but_for_the_room(text)


@pytest.mark.parametrize("options", [{}, {"roughing_stock": 0.3, "finishing_stock": 0.1}, {"dry_run": True}])
def test_writer_reader_writer_gives_the_same_text_on_six_axes(options):
    hobbed = load_bevel_set(bundled("crown_gear_hobbed_14x39.toml"))
    text = cutting_program(hobbed, "pinion", MACHINE, "CUT", CuttingJob(range(14), 5e-3, **options))
    assert " C=DC(" in text
    assert but_for_the_room(written_again(text)) == but_for_the_room(text)


def probed_again(text, name, teeth, repeat=1):
    """What the writer makes of what control and reader understood of a probing program: its end points and heights.

    The probe of this machine triggers where the touches end, and on no way to a point: sideways, and down.
    """
    calls = []

    def probe(start, end):
        calls.append(None)
        return end if (len(calls) - 2) % (2 + repeat) >= 2 and len(calls) > 1 else None

    program, done = read_program(text, "P.MPF"), run_program(text, "P.MPF", probe)
    path, head = done.path, min(statement.line for statement in program.body)
    header = [comment for line, comment in program.comments.items() if line < head]
    called = [line.split(",") for line in done.files[f"{header[0]}_T"].splitlines()[2:]]
    flank, tooth, row, col = (np.array(column) for column in list(zip(*called, strict=True))[3:7])
    measuring = np.flatnonzero(path.measuring)[1:]  # the first one leads down from the home of Z
    ways = measuring.reshape(-1, 2 + repeat)
    start, end = path.axes[ways[:, 1]], path.axes[ways[:, 2]]
    for last in ways.T[2:]:
        np.testing.assert_allclose(path.axes[last], end, rtol=0, atol=1e-12)
        np.testing.assert_allclose(path.axes[last + 1], start, rtol=0, atol=1e-12)
    ways_mm = np.linalg.norm(np.diff(path.axes[:, :3], axis=0), axis=1)[measuring - 1]
    feed = (60 * ways_mm / path.seconds[measuring]).reshape(ways.shape)
    np.testing.assert_allclose(feed[:, 1], APPROACH_FEED, rtol=1e-9)
    np.testing.assert_allclose(feed[:, 2:], MEASURING_FEED, rtol=1e-9)
    (level,) = set(path.axes[ways[:, 0], 2].tolist())
    assert path.axes[0, 2] == path.axes[-1, 2] == MACHINE.home
    once = slice(None, None, repeat)
    targets = Targets(
        flank[once], tooth[once].astype(int), row[once].astype(int), col[once].astype(int), start, end, end
    )
    return write_touches(header[0], header[1:], targets, name, teeth, MACHINE, PROBE, level, ROOM, repeat)


def apart_from_angles(text):
    """A text without the angles of its table, and these: they have more decimals than the control tells of."""
    angle = re.compile(r"(UWAY\[\d+,6\]=)(-?\d+\.\d{8})")
    return angle.sub(r"\1", text), np.array([float(found[2]) for found in angle.finditer(text)])


@pytest.mark.parametrize(
    ("member", "options"),
    [("pinion", {}), ("gear", {"topography": (3,), "around": (0, 9)}), ("pinion", {"topography": (), "repeat": 3})],
)
def test_writer_reader_writer_gives_the_same_text_for_probing(gear_set, member, options):
    text = probing_program(gear_set, member, MACHINE, PROBE, "PROBE", **options)
    again = probed_again(text, member, gear_set.member(member).teeth, options.get("repeat", 1))
    (first, angles), (second, found) = (apart_from_angles("\n".join(but_for_the_room(one))) for one in (text, again))
    assert second == first
    assert len(angles) in (90, 2)
    np.testing.assert_allclose(found, angles, rtol=0, atol=1.1 * 0.5e-6)  # half an increment of A


@settings(max_examples=50)
@given(st.integers(0, 2**32 - 1), st.integers(2, 6), st.sampled_from([0.0, 0.5, 12.25]))
def test_writer_reader_writer_gives_the_same_text_for_any_pass(seed, count, dwell):
    generator = np.random.default_rng(seed)
    start = generator.uniform([-300, -300, 0, -9, 0], [300, 300, 400, 9, 1.5])
    axes = start + np.cumsum(generator.normal(0, 0.2, (count, 5)), axis=0) * [1, 1, 1, 0.5, 0.2]
    one = Pass("TOOL_1", "any, pass", 3, axes, generator.uniform(0.5, 50, count - 1), dwell)
    text = write_program("ANY", ["made up"], [one, replace(one, tooth=4)], FASTER, 80.0, 20.0, ROOM, 0.0)
    assert written_again(text) == text


def read_or_refuse(text):
    """Nothing but InputError may come out of the reader."""
    with contextlib.suppress(InputError):
        read_program(text, "P.MPF")


@given(st.text())
def test_no_text_crashes_the_reader(text):
    read_or_refuse(text)


WORDS = (
    "IF ELSE ENDIF WHILE ENDWHILE FOR ENDFOR TO DEF INT REAL UX R1 R[ ] ( ) , = == <> << < > + - * / DIV MOD AND OR "
    "NOT SIN( ATAN2( $AA_MM[ $AC_MEA[1] $A_PROBE[1] X Y1 A=DC( B=IC( 0.5 1 9999999999 STOPRE MSG( SETAL( WRITE( TRANS "
    'C2 C=DC( FGROUP( FGREF[A]= MEAS=1 SPOS=0 G1 G93 F1 M30 N10 "text" " ; . \t \r $ _A'
)
PIECES = st.sampled_from(WORDS.split(" "))


@given(st.lists(st.tuples(PIECES, st.sampled_from(["", " ", "\n"])), max_size=40))
def test_no_row_of_words_crashes_the_reader(pieces):
    read_or_refuse("".join(piece + gap for piece, gap in pieces))


@pytest.fixture(scope="module")
def probing_text(gear_set):
    probe = load_calibration(bundled("probe.toml"))
    return probing_program(gear_set, "pinion", MACHINE, probe, "PROBE", topography=())


@settings(max_examples=200, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.data())
def test_no_mutation_of_a_program_crashes_the_reader(probing_text, data):
    place = data.draw(st.integers(0, len(probing_text) - 1))
    inserted = data.draw(st.text(st.characters(codec="utf-8"), max_size=3))
    read_or_refuse(probing_text[:place] + inserted + probing_text[place + data.draw(st.integers(0, 3)) :])


NUMBER = re.compile(r"-?[0-9]+(?:\.[0-9]+)?")
STEPS = 2_000


@pytest.fixture(scope="module")
def cutting_texts(gear_set):
    """A face milled program, a face hobbed one on six axes, of a head and its last blocks, and a probing one."""
    hobbed = load_bevel_set(bundled("crown_gear_hobbed_14x39.toml"))
    long = cutting_program(hobbed, "pinion", MACHINE, "CUT", CuttingJob(range(14), 2e-2)).splitlines(keepends=True)
    head = next(k for k, line in enumerate(long) if " G93 " in line)
    probe = load_calibration(bundled("probe.toml"))
    return [
        cutting_program(gear_set, "pinion", MACHINE, "CUT", CuttingJob((0,), 2e-2)),
        "".join(long[:head] + long[-20:]),
        probing_program(gear_set, "pinion", MACHINE, probe, "PROBE", topography=()),
    ]


def changed(text, kind, share, other, count, put):
    """The text with one change at a ``share`` of its length: bytes, a number or lines of it, or all that follows."""
    if kind == "bytes":
        place = int(share * len(text))
        return text[:place] + put + text[place + count :]
    if kind == "number":
        found = list(NUMBER.finditer(text)) or [re.match("", text)]
        begin, end = found[int(share * len(found))].span()
        return text[:begin] + put + text[end:]
    if kind == "truncated":
        return text[: int(share * len(text))]
    lines = text.splitlines(keepends=True) or [""]
    one, two = (int(part * len(lines)) for part in (share, other))
    if kind == "joined":
        lines[one] = lines[one].rstrip("\n") + " "
    elif kind == "exchanged":
        lines[one], lines[two] = lines[two], lines[one]
    else:
        lines[one : one + 1] = [lines[one], lines[two]][: max(count, 0)]
    return "".join(lines)


SHARES = st.floats(0.0, 1.0, exclude_max=True)
PUT = st.sampled_from(["0", "-0.0", "-1", "1e9", "9" * 20, "0.000000001", "360", "R1", "1/0"]) | st.text(max_size=2)
CHANGES = st.tuples(
    st.sampled_from(["bytes", "number", "truncated", "joined", "exchanged", "lines"]),
    SHARES,
    SHARES,
    st.integers(0, 2),
    PUT,
)


@settings(max_examples=300, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.integers(0, 2), st.lists(CHANGES, min_size=1, max_size=3))
def test_no_mutation_of_a_real_program_crashes_the_control(cutting_texts, which, changes):
    """Up to three changes of bytes, lines or numbers, then the whole of it executed: refused, or a finite path."""
    text = cutting_texts[which]
    for change in changes:
        text = changed(text, *change)
    with contextlib.suppress(InputError):
        path = run_program(text, "P.MPF", lambda start, end: end, step_limit=STEPS).path
        assert np.isfinite(path.axes).all()
        assert np.isfinite(path.seconds).all()


@pytest.mark.parametrize("which", [0, 1])
def test_a_real_program_cut_off_before_its_end_is_refused(cutting_texts, which):
    text = cutting_texts[which]
    run_program(text, "P.MPF", step_limit=STEPS)
    for length in range(0, text.rindex("M30"), 37):
        with pytest.raises(InputError, match=r"^P\.MPF, line \d+, column \d+: "):
            run_program(text[:length], "P.MPF", step_limit=STEPS)
