"""What shops write is read as what it means, or refused with what to write; the limits of the control are known."""

from __future__ import annotations

import contextlib
import re
from pathlib import Path

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from gearmath.errors import InputError
from gearmath.machine.control.executor import execute, run_program
from gearmath.machine.control.expression import FUNCTIONS, Constant, NcVariable, Operation
from gearmath.machine.control.reader import read_program
from gearmath.machine.control.refused import refused_words
from gearmath.machine.control.text import decoded, program_text, skip_blocks
from gearmath.machine.control.values import evaluate
from gearmath.machine.control.vocabulary import GROUP_OF_CODE
from gearmath.machine.planning.cut_plan import CuttingJob
from gearmath.machine.writing.cutting import cutting_program
from gearmath.specs.milling_machine import load_milling_machine
from gearmath.specs.toml import bundled


def refused(text):
    with pytest.raises(InputError) as caught:
        read_program(text, "P")
    return str(caught.value)


def meaning(part):
    """A statement, a word or a node without the place where it stands."""
    if isinstance(part, Operation):
        return part.name, *map(meaning, part.operands)
    if isinstance(part, NcVariable):
        return part.name, part.axis, *map(meaning, part.index)
    if isinstance(part, Constant):
        return part.value
    if hasattr(part, "way"):
        # of an address the number says all, of a code its text
        return part.way, meaning(part.value), part.text if part.text in GROUP_OF_CODE else ""
    if isinstance(part, dict):
        return {key: meaning(word) for key, word in part.items()}
    if isinstance(part, tuple):
        return tuple(meaning(one) for one in part)
    if hasattr(part, "__dataclass_fields__"):
        kept = [field for field in part.__dataclass_fields__ if field not in ("line", "column")]
        return type(part).__name__, *(meaning(getattr(part, field)) for field in kept)
    return part


def said(text):
    return meaning(read_program(text, "P").body)


@pytest.mark.parametrize(
    ("shop", "plain"),
    [
        ("g1 x1 a=dc(r1)", "G1 X1 A=DC(R1)"),
        ("if r1==1\nstopre\nendif", "IF R1==1\nSTOPRE\nENDIF"),
        ("def real ua, Ub=1.5", "DEF REAL UA,UB=1.5"),
        ("F200.", "F200"),
        ("X5. Y.5 Z-.5", "X5 Y0.5 Z-0.5"),
        ("X+1 Y=+1", "X1 Y=1"),
        ("X 10 Y -2", "X10 Y-2"),
        ("X=5 Y = 6", "X5 Y6"),
        ("G0X5Y3M8", "G0 X5 Y3 M8"),
        ("N10G1X5", "N10 G1 X5"),
        ("M03 G01", "M3 G1"),
        ("X1.5EX-3 Y1EX2", "X0.0015 Y100"),
        ("R1=2EX+2", "R1=200"),
        ("R1 = R2 + 3 R3=4", "R1=R2+3 R3=4"),
        ("X=R1 -5 Y=2 * R3", "X=R1-5 Y=2*R3"),
        (":100 G0 X1", "N100 G0 X1"),
        ("/N50 G0 X1", "N50 G0 X1"),
        ("/3 N50G0 X1", "N50 G0 X1"),
        ("SPACE_1: G0 X1", "G0 X1"),
        ("N10 SPACE_1: G0 X1", "N10 G0 X1"),
        ("SPACE_1:\n\n \t\nG0", "G0"),
        ("%_N_CUT_MPF\n;$PATH=/_N_WKS_DIR/_N_A_WPD\nG0", "G0"),
        ("proc cut\nG0", "G0"),
        ("EXTERN UPROBE(REAL, INT)\nG0", "G0"),
        ("G0\tX1  \t", "G0 X1"),
        ("FGROUP( X , Y)", "FGROUP(X,Y)"),
        ('T = "A"D1', 'T="A" D1'),
        ("TRANS x1.5 Z=r1", "TRANS X1.5 Z=R1"),
        ("fgref[a] = 57.3 R1=$aa_mm[x]", "FGREF[A]=57.3 R1=$AA_MM[X]"),
        ("R1=(r2==1)  xor  not (r3<2)", "R1=(R2==1) XOR NOT (R3<2)"),
    ],
)
def test_what_shops_write_means_what_the_plain_form_means(shop, plain):
    assert said(shop) == said(plain)


def test_texts_and_comments_keep_their_letters():
    program = read_program('msg("Zähne; größer") ; Für Müller', "P")
    assert program.body[0].arguments == (Constant("Zähne; größer"),)
    assert program.comments == {1: "Für Müller"}
    assert read_program('t="Ab_1" d1', "P").body[0].words["T"].text == "Ab_1"


CALL = "calls of other programs are not read: write their blocks here"
NAME = "two letters, or _ and a letter, then letters, digits and _"
LONG_BLOCK = "the block has 514 characters with comment and line end; the control reads at most 512"
LONG_NAME = f"the program name {'U' * 25} has 25 characters; the control allows 24"
JUMP = "jumps are not read: write IF, WHILE or FOR"


@pytest.mark.parametrize(
    ("text", "column", "sentence"),
    [
        ("X1.5E-3", 2, "'1.5E-3' is not understood: an exponent is written 1.5EX-3"),
        ("R1=2*1e5", 6, "'1E5' is not understood: an exponent is written 1EX5"),
        ("SPOS(90)", 1, "SPOS is read as SPOS=90 only: write that"),
        ("SPOS[1]=90", 1, "SPOS is read as SPOS=90 only: write that"),
        ("N10 GOTOF END", 5, f"GOTOF is not understood: {JUMP}"),
        ("if r1==1 gotob again", 10, f"GOTOB is not understood: {JUMP}"),
        ("G02 X1 CR=5", 1, "G2 is not understood: arcs are not read: write G1 blocks"),
        ("G91", 1, "G91 is not understood: the program is read with G90 only: write X=IC(...)"),
        ("G0 G71", 4, "G71 is not understood: the program is read in mm only: write G710"),
        ("CYCLE832(0.01)", 1, f"'CYCLE832' is not understood: {CALL}"),
        ("L100", 1, f"'L100' is not understood: {CALL}"),
        ("S1=300", 1, "'S1=' is not understood: S with a number before = means another axis or spindle"),
        ("M2=3", 1, "'M2=' is not understood: M with a number before = means another axis or spindle"),
        ("X1=10", 1, "'X1=' is not understood: X with a number before = means another axis or spindle"),
        ("T1", 1, 'T is not understood: write the tool by its name, T="NAME", of 1 to 31 letters, digits and _'),
        ("O1234", 1, "O is not understood: the name of a program is the name of its file"),
        ("(comment)", 1, "( is not understood: a comment begins with ;"),
        ("#1=2", 1, "# is not understood: a variable is written R1"),
        ("%", 1, "a line with % is read only as %_N_NAME_MPF or %_N_NAME_SPF, the first line of an archive"),
        ("X5 %", 4, "% is not understood: % stands in the first line only, as %_N_NAME_MPF"),
        ("A=DC(90)B=5", 9, "'B=5' is not understood: a blank may be missing before it"),
        ("/IF R1==1", 2, "/ before IF: the program would mean something else with it skipped"),
        ("PROC CUT(REAL UX)", 9, "'(REAL' after PROC: only a name is read, for a program without parameters"),
        ("DEF REAL a, b", 10, "the name of a variable is missing; it begins with two letters"),
        ("DEF INT STOPRE", 9, "STOPRE is a word of the language, and no name of a variable"),
        ("IF: G0", 1, "IF is a word of the language, and no label"),
        ("DEF BOOL UA", 5, "DEF knows INT and REAL only"),
        ("Xä", 2, r"the character '\xe4' may stand in comments and texts only"),
        ("X١", 2, r"the character '\u0661' may stand in comments and texts only"),
        ("X1\xa0Y2", 3, r"the character '\xa0' may stand in comments and texts only"),
        ('MSG("ä") ü', 10, r"the character '\xfc' may stand in comments and texts only"),
        ('MSG("end ; no comment', 5, "the text that begins here has no closing quotation mark"),
        ("X1\x1a", 3, "the control character 0x1a is no part of a program"),
        ("X1 ; a\0b", 7, "the control character 0x00 is no part of a program"),
        ("G0 X1\rG0 X2\r", 6, "the line ends with CR alone: save the program with LF or CR LF at line ends"),
        # limits: length, value and limit are named
        ("X1;" + "c" * 510, 512, LONG_BLOCK),
        ('MSG("' + "t" * 201 + '")', 5, "the text has 201 characters; the control holds at most 200"),
        ('MSG("' + "t" * 125 + '")', 1, "the text of MSG has 125 characters; the control shows 124"),
        ("DEF INT " + "U" * 32, 9, f"the name {'U' * 32!r} has 32 characters; the control allows 31"),
        ("U" * 32 + ": G0", 1, f"the name {'U' * 32!r} has 32 characters; the control allows 31"),
        ("R1=" + "U" * 32, 4, f"the name {'U' * 32!r} has 32 characters; the control allows 31"),
        ("EXTERN " + "U" * 25, 8, LONG_NAME),
        ("%_N_" + "U" * 25 + "_MPF", 5, LONG_NAME),
        ('WRITE(UE,"' + "U" * 25 + '","t")', 11, f"'{'U' * 25}' is no name of a file: 1 to 24 letters, digits and _"),
        ("EXTERN A1", 8, f"'A1' is no program name: {NAME}"),
        ('WRITE(UE,"A B","t")', 11, "'A B' is no name of a file: 1 to 24 letters, digits and _"),
        ("N100000000 X1", 1, "the block number 'N100000000' is too large; the control takes 99999999"),
        ("X100000000", 2, "the number '100000000' is too large; the control takes at most 99999999"),
        ("X1EX8", 2, "the number '1EX8' is too large; the control takes at most 99999999"),
        ("R1=0.123456789", 4, "the number '0.123456789' has 9 decimals; the most here is 8"),
        ("DEF REAL UA[200,200]", 10, "the field UA has more than 10000 values"),
        ("R1=" + "(" * 21 + "1" + ")" * 21, 25, "an expression is nested more than 20 deep"),
    ],
)
def test_what_is_not_read_is_refused_with_column_and_reason(text, column, sentence):
    assert refused(f"{text}\nM30") == f"P, line 1, column {column}: {sentence}"


def test_the_longest_block_text_and_name_are_read():
    read_program("X1;" + "c" * 508, "P")  # with its line end 512 characters
    read_program('WRITE(UE,"' + "U" * 24 + '","' + "t" * 200 + '")', "P")
    read_program('MSG("' + "t" * 124 + '")', "P")
    read_program("DEF INT " + "U" * 31, "P")
    read_program("N99999999 X99999999 R1=0.12345678", "P")


@pytest.mark.parametrize("end", ["M30", "M2", "M02", "M17", "RET", "ret", "IF 1==1\nRET\nENDIF"])
def test_every_end_of_a_program_ends_it(end):
    done = run_program(f'MSG("before")\n{end}\n', "P")
    assert done.messages == ("before",)


def test_a_text_put_together_is_no_longer_than_the_control_holds():
    head = f'DEF INT UE\nWRITE(UE,"OUT","{"t" * 198}"<<R1'
    assert len(run_program(f'{head}<<"1")\nM30', "P").files["OUT"]) == 201  # with its line end
    with pytest.raises(
        InputError, match=r"line 2, column .*: the text has 201 characters; the control holds at most 200"
    ):
        run_program(f'{head}<<"12")\nM30', "P")


def test_a_long_sum_is_computed_or_refused_by_its_length():
    assert run_program("R1=" + "+".join(["1"] * 254) + "\nM30", "P").parameters[1] == 254
    assert "the block has 993 characters" in refused("R1=" + "+".join(["1"] * 495))


def test_the_depth_of_a_sum_does_not_matter():
    node = Constant(0.0)
    for _ in range(5000):
        node = Operation("+", (node, Constant(1.0)), 1)
    assert evaluate(node, None, "P", 1) == 5000


NUMBERS = st.integers(0, 99).map(str) | st.sampled_from(["0.5", "2.25", "1."])
SIGNS = st.sampled_from(["+", "-", "*", " + ", " - ", "* "])


def compound(one):
    return st.tuples(one, SIGNS, one).map("".join) | one.map("({})".format)


@given(st.recursive(NUMBERS, compound, max_leaves=12))
def test_arithmetic_is_that_of_python(text):
    expected = eval(text)
    if abs(expected) > 1e6 or text.count("(") > 19:
        return  # near the limits of size and depth
    with contextlib.suppress(InputError):  # a part of it may pass them
        assert run_program(f"R1={text}\nM30", "P").parameters[1] == pytest.approx(expected, rel=1e-12, abs=1e-9)


def as_a_shop_writes(text):
    """Small letters, no blanks between plain words, CR LF, a byte order mark and the header of an archive."""
    lines = []
    for line in text.splitlines():
        code, sign, comment = line.partition(";")
        if '"' not in code:
            # beside a longer word with an equals sign the blank stays: both would be read as one name
            joined = code if re.search(r"[A-Z][A-Z0-9\]]+=", code) else re.sub(r"(?<=[0-9]) +(?=[A-Z])", "", code)
            code = joined.lower()
        lines.append(code + sign + comment)
    return "\ufeff" + "\r\n".join(["%_N_CUT_MPF", ";$PATH=/_N_MPF_DIR", *lines, ""])


@pytest.mark.slow
def test_a_whole_program_as_a_shop_writes_it_moves_the_same(gear_set, tmp_path):
    machine = load_milling_machine(bundled("vertical_5axis.toml"))
    text = cutting_program(gear_set, "pinion", machine, "CUT", CuttingJob((0, 5), 1e-2))
    path = tmp_path / "CUT.MPF"
    path.write_bytes(as_a_shop_writes(text).encode())
    plain, shop = execute(text, "P"), execute(program_text(path), "P")
    np.testing.assert_array_equal(plain.axes, shop.axes)
    np.testing.assert_array_equal(plain.seconds, shop.seconds)
    np.testing.assert_array_equal(plain.line + 2, shop.line)


def test_files_are_decoded_as_shops_save_them(tmp_path):
    path = tmp_path / "P.MPF"
    for content, text in [
        ("X1 ; größe\r\n".encode("cp1252"), "X1 ; größe\n"),
        ("X1 ; größe\n".encode(), "X1 ; größe\n"),
        (b"\xef\xbb\xbfX1\n", "X1\n"),
        (b"X1 ; \x81\n", "X1 ; \ufffd\n"),  # no character of Windows-1252
    ]:
        path.write_bytes(content)
        assert program_text(path) == text
    for content, sentence in [
        ("X1".encode("utf-16"), "is UTF-16: the control reads one byte a character, save the program as UTF-8"),
        (b"X1\rX2\r", "line 1, column 3: the line ends with CR alone"),
        (b"X1\nX\0", "line 2, column 2: the control character 0x00 is no part of a program"),
    ]:
        path.write_bytes(content)
        with pytest.raises(InputError, match=sentence):
            program_text(path)


def test_blocks_that_may_be_skipped_are_counted():
    assert skip_blocks('G0 X1 /\n/N10 X2\n /2 X3\n;/\nMSG("/")') == 2


@settings(max_examples=300)
@given(st.binary(max_size=200))
@example(b"\xff\xfe\0")
@example(b"G1 X" + b"9" * 100_000)
@example(b'"' * 1001)
@example(b"R1=" + b"(" * 100_000)
@example(b"R1=" + b"-" * 500)
@example(b"R1=" + b"NOT " * 120)
@example(b"R1=" + b"R[" * 250)
@example(b"R1=" + b"SIN(" * 120)
@example(b"R1=1" + b"==1" * 160)
@example(b"\n" * 100_000 + b"\r")
def test_no_bytes_crash_the_reader(content):
    with contextlib.suppress(InputError):
        run_program(decoded(content, "P"), "P", step_limit=1000)


SHOP = st.sampled_from(
    [
        "g1",
        "G0",
        "x",
        "X1",
        "y.5",
        "1.",
        "ex-3",
        "E5",
        "+",
        "-",
        "/",
        "/2",
        ":",
        ":10",
        "n10",
        "N",
        "ua",
        "DEF REAL ",
        "UA",
        "=",
        "==",
        "(",
        ")",
        "[",
        "]",
        '"',
        '"ä"',
        ";",
        "ä",
        "\r\n",
        "\n",
        "\t",
        " ",
        "PROC A_",
        "EXTERN AB",
        "MARK:",
        "%_N_A_MPF",
        "ret",
        "M17",
        "IF ",
        "R1",
        "ENDIF",
        "while ",
        "endwhile",
        "to",
        "FOR R1=1 TO 3\n",
        "endfor",
        "msg(",
        "write(",
        "spos",
        "<<",
        "not ",
        "div ",
        "SIN(",
        "dc(",
        "goto",
        "L5",
        "m2=3",
        "T=",
        "d1",
        "9" * 9,
        "0.123456789012",
        "U" * 31,
    ]
)


@settings(max_examples=500)
@given(st.lists(SHOP, max_size=25).map("".join))
def test_no_row_of_shop_words_crashes_the_reader(text):
    with contextlib.suppress(InputError):
        run_program(text, "P", step_limit=1000)


def test_a_million_lines_are_read_to_the_last_one():
    assert refused("; nothing\n" * 999_999 + "G0 X1 Q") == "P, line 1000000, column 7: the word 'Q' is not understood"


PAGE = (Path(__file__).parents[4] / "docs" / "nc_dialect.md").read_text("utf-8")


def test_the_page_names_every_word_that_is_read_or_refused():
    words = set(re.findall(r"[A-Z][A-Z0-9_]*|[#%(]", " ".join(re.findall(r"`([^`]+)`", PAGE))))
    assert set(GROUP_OF_CODE) | set(refused_words()) | set(FUNCTIONS) <= words
