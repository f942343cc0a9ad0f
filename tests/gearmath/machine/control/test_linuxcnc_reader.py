"""The reader of programs for LinuxCNC: what it understands, what it refuses, and that a spoiled program is refused."""

from __future__ import annotations

import re
from collections.abc import Callable

import numpy as np
import pytest

from gearmath.errors import InputError
from gearmath.machine.control.executor import MachinePath, execute, run_program
from gearmath.machine.control.state import Setup
from gearmath.machine.judging.program import faults_of
from gearmath.machine.milling.run import runs_of
from gearmath.machine.planning.cut_plan import CuttingJob, cutting_plan
from gearmath.machine.writing.linuxcnc.cutting import program_of
from gearmath.specs.bevel_set import BevelSet, load_bevel_set
from gearmath.specs.milling_machine import MillingMachine, load_milling_machine
from gearmath.specs.toml import bundled

HEAD = "; control: LinuxCNC\n; tool T3: CUTTER\nG17 G21 G40 G49 G54 G61 G80 G90 G92.2 G94 G97\n"
START = HEAD + "T3 M6\nG43\nG53 G0 Z500\nG0 X0 Y0 A0 B0\n"


@pytest.fixture(scope="module")
def machine() -> MillingMachine:
    return load_milling_machine(bundled("vertical_5axis.toml"))


@pytest.fixture(scope="module")
def pair() -> BevelSet:
    return load_bevel_set(bundled("nasa_tp3096_12x36.toml"))


@pytest.fixture(scope="module")
def text(pair: BevelSet, machine: MillingMachine) -> str:
    return program_of(cutting_plan(pair, "gear", machine, CuttingJob((0, 1), 0.001)), "CUT")


def path_of(body: str) -> MachinePath:
    return execute(f"{START}{body}\nM2\n", "P", Setup(work_offset="G54"))


@pytest.mark.parametrize(
    ("expression", "value"),
    [
        ("[1+2*3]", 7.0),
        ("[2*3+1]", 7.0),
        ("[7-2-1]", 4.0),
        ("[2**3*2]", 16.0),
        ("[8/2/2]", 2.0),
        ("[[1+2]*3]", 9.0),
        ("ABS[-4.5]", 4.5),
        ("ROUND[2.5]", 3.0),
        ("FIX[-2.5]", -3.0),
        ("FUP[2.1]", 3.0),
        ("[7 MOD 4]", 3.0),
        ("[1 LT 2]", 1.0),
        ("[1 GE 2]", 0.0),
        ("[1 LT 2 AND 3 LT 4]", 1.0),
        ("[[1 EQ 2] OR [3 NE 3]]", 0.0),
        ("SQRT[16]", 4.0),
        ("SIN[30]", 0.5),
        ("-.5", -0.5),
        ("+1.5", 1.5),
    ],
)
def test_expressions_have_the_values_of_the_language(expression: str, value: float) -> None:
    assert path_of(f"G0 X{expression}").axes[-1, 0] == pytest.approx(value, abs=1e-12)


@pytest.mark.parametrize(
    ("body", "place"),
    [
        ("#100=3\nG0 X#100", 3.0),
        ("#<way>=4\nG0 X#<way>", 4.0),
        ("#100=1\n#100=[#100+1] G0 X#100", 1.0),  # an assignment acts when its line is over
        ("o1 if [1 EQ 2]\nG0 X1\no1 else\nG0 X2\no1 endif", 2.0),
        ("#100=0\no1 while [#100 LT 5]\n#100=[#100+1]\no1 endwhile\nG0 X#100", 5.0),
        ("o<far> sub\nG0 X#1\no<far> endsub\no<far> call [6]", 6.0),
        ("g 0 x 1 . 5 (a comment) ; another", 1.5),
        ("N10 G0 X7 (MSG, on the way)", 7.0),
        ("o1 if [EXISTS[#<nothing>]]\nG0 X1\no1 endif\nG0 X8", 8.0),
    ],
)
def test_lines_act_in_the_order_of_the_language(body: str, place: float) -> None:
    assert path_of(body).axes[-1, 0] == place


def test_times_are_those_of_feed_and_inverse_time() -> None:
    path = path_of("G1 X3 Y4 F60\nG93 G1 X4 F120\nG94 F90\nG1 A30")
    assert path.seconds[-3:].tolist() == pytest.approx([5.0, 0.5, 20.0])
    assert [halt.seconds for halt in path_of("G4 P2.5").halts] == [2.5]


@pytest.mark.parametrize(
    ("body", "why"),
    [
        ("G2 X1 I1", "G2 is not understood"),
        ("G1 X1", "G1 without F"),
        ("G0 X1 X2", "X is there twice"),
        ("G0 X[1+]", "a number is expected"),
        ("G0 X[1", "] is missing"),
        ("G0 X#<nothing>", "has no value"),
        ("G0 X#9999", "there is no parameter #9999"),
        ("o1 if [1]\nG0 X1", "is not ended"),
        ("o1 endif", "ends nothing"),
        ("o<far> call", "there is no subroutine"),
        ("(never closed", "a comment is not closed"),
        ("G0 X=1", "a number is expected"),
        ("G38.3 Z1 F1", "probing without the tool PROBE"),
        ("G55\nG0 X1", "G55 is active"),
        ("G64 P-0.01", "G64 P-0.01: a tolerance is not below 0"),
        ("G4 P-1", "G4 P-1: a time is not below 0"),
        ("G0 X1 " + " " * 260, "characters"),
    ],
)
def test_what_is_not_understood_is_refused_with_its_line(body: str, why: str) -> None:
    with pytest.raises(InputError, match=re.escape(why)) as refused:
        path_of(body)
    assert "P, line " in str(refused.value)


def test_a_loop_without_an_end_is_refused() -> None:
    with pytest.raises(InputError, match="more than 1000 steps: does it end"):
        run_program(f"{START}o1 while [1]\no1 endwhile\nM2\n", "P", step_limit=1000)


def test_an_abort_is_the_alarm_of_a_program() -> None:
    with pytest.raises(InputError, match="sets alarm 1: no use"):
        path_of("(ABORT, no use)\nG0 X1")


def judged(text: str, pair: BevelSet, machine: MillingMachine) -> str:
    path = execute(text, "CUT", Setup.of(machine))
    runs = runs_of(path, pair.member("gear"), machine, None)
    return "; ".join(map(str, faults_of(text, path, runs, pair.member("gear"), machine)))


def test_a_right_program_has_no_faults(text: str, pair: BevelSet, machine: MillingMachine) -> None:
    assert judged(text, pair, machine) == ""


def without(pattern: str) -> Callable[[str], str]:
    """Takes a condition with its ABORT out of a program."""

    def take(text: str) -> str:
        out = re.sub(rf"^o(\d+) if .*\n\(ABORT, {pattern}.*\n(?:o\1 endif\n)", "", text, count=1, flags=re.MULTILINE)
        assert out != text
        return out

    return take


@pytest.mark.parametrize(
    ("spoil", "why"),
    [
        (without("G54 must be"), "G54 is 0.01 off in X"),
        (without("G54 must not turn"), "a frame turns"),
        (without("the tool in the spindle"), "another tool is in the spindle"),
        (without("Z of T1"), "length 1 of the tool in the table is wrong"),
        (lambda text: text.replace("\nM0\n", "\n"), "before it has waited at M0"),
        (lambda text: text.replace("G61 ", "").replace("G64 P0.000050 Q0", "G64"), "the machine file allows"),
        (lambda text: text.replace("G64 P0.000050 Q0\n", ""), "path mode (G61 or G64)"),
        (lambda text: text.replace("G53 G0 Z900.00000\n", ""), "moves before Z has gone up"),
        (lambda text: text.replace("S120.000 M3", "S120.000 M4"), "turning backwards"),
        (lambda text: text.replace("S120.000 M3", "S400.000 M3"), "at another speed"),
        (lambda text: text.replace("M8\n", ""), "without coolant"),
        (lambda text: re.sub(r"^(G1 X.* F)", r"\g<1>9", text, flags=re.MULTILINE), "states 300 mm/min"),
        (lambda text: re.sub(r"(G1 X\S+ Y\S+ Z)500\.00000( A)", r"\g<1>499.00000\2", text, count=1), "line"),
    ],
)
def test_a_spoiled_program_is_refused(
    spoil: Callable[[str], str], why: str, text: str, pair: BevelSet, machine: MillingMachine
) -> None:
    other = spoil(text)
    assert other != text
    try:
        found = judged(other, pair, machine)
    except InputError as error:
        found = str(error)
    assert why in found


def test_a_part_that_is_run_alone_is_that_part(text: str, machine: MillingMachine) -> None:
    whole = execute(text, "CUT", Setup.of(machine))
    part = run_program(text, "CUT", parameters={90: 2.0, 91: 2.0}, setup=Setup.of(machine)).path
    cut = part.axes[~part.rapid]
    np.testing.assert_array_equal(cut, whole.axes[~whole.rapid][-len(cut) :])
