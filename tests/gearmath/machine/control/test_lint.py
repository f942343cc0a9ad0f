"""Every kind of generated program against the rules of the control, typed here from its manual and shared with nobody.

Names, comments, block length, numbers with a leading digit and a fixed number of decimals, no plus sign, no exponent,
DC for modulo axes alone, no compressor with inverse-time feed, F in every G93 block, M30 at the end.
"""

from __future__ import annotations

import re

import pytest

from gearmath.machine.planning.cut_plan import CuttingJob
from gearmath.machine.writing.calibrating import calibration_program
from gearmath.machine.writing.cutting import cutting_program
from gearmath.machine.writing.probing import probing_program
from gearmath.specs.bevel_set import load_bevel_set
from gearmath.specs.calibration import load_calibration
from gearmath.specs.control import ControlSettings
from gearmath.specs.milling_machine import load_milling_machine
from gearmath.specs.toml import bundled

MACHINE = load_milling_machine(bundled("vertical_5axis.toml"))
PROBE = load_calibration(bundled("probe.toml"))
COUNTING = MACHINE.model_copy(
    update={
        "axes": MACHINE.axes.model_copy(
            update={"A": MACHINE.axes.A.model_copy(update={"modulo": False, "travel": (-360.0, 720.0)})}
        )
    }
)
CONTROLLED = MACHINE.model_copy(
    update={
        "control": ControlSettings(
            path_mode="G60",
            jerk="BRISK",
            feed_forward=False,
            increments_per_mm=100_000,
            increments_per_degree=1_000_000,
        )
    }
)
NASA, FORMATE, UNIVERSAL, HOBBED = (
    load_bevel_set(bundled(f"{name}.toml"))
    for name in (
        "nasa_tp3096_12x36",
        "crown_gear_formate_14x39",
        "crown_gear_universal_14x39",
        "crown_gear_hobbed_14x39",
    )
)
PROGRAMS = {
    "generated": (MACHINE, lambda m: cutting_program(NASA, "pinion", m, "LINTED", CuttingJob((0, 7)))),
    "completing": (CONTROLLED, lambda m: cutting_program(NASA, "gear", m, "LINTED", CuttingJob((0, 35)))),
    "formate": (MACHINE, lambda m: cutting_program(FORMATE, "gear", m, "LINTED", CuttingJob((0, 20)))),
    "universal": (MACHINE, lambda m: cutting_program(UNIVERSAL, "pinion", m, "LINTED", CuttingJob((3,), 1e-3))),
    "roughing": (MACHINE, lambda m: cutting_program(NASA, "gear", m, "LINTED", CuttingJob((1,), roughing_stock=0.3))),
    "dry run": (MACHINE, lambda m: cutting_program(NASA, "gear", m, "LINTED", CuttingJob((1,), dry_run=True))),
    "counting": (COUNTING, lambda m: cutting_program(NASA, "pinion", m, "LINTED", CuttingJob((0, 7)))),
    "hobbed": (MACHINE, lambda m: cutting_program(HOBBED, "gear", m, "LINTED", CuttingJob(range(39), 1e-3))),
    "probing": (MACHINE, lambda m: probing_program(NASA, "gear", m, PROBE, "LINTED")),
    "probing, counting": (COUNTING, lambda m: probing_program(HOBBED, "pinion", m, PROBE, "LINTED", topography=())),
    "calibration": (MACHINE, lambda m: calibration_program(m, PROBE, "LINTED")),
}

#: Decimals of every address that takes a decimal number.
DECIMALS = {"X": 5, "Y": 5, "Z": 5, "A": 6, "B": 6, "C": 6}
NAME = re.compile(r"(?:[A-Z]{2}|_[A-Z])[A-Z0-9_]{0,22}")


@pytest.mark.parametrize("kind", PROGRAMS)
def test_program_keeps_the_rules_of_the_control(kind):
    machine, write = PROGRAMS[kind]
    text = write(machine)
    faults = lint(text, modulo=machine.axes.A.modulo)
    assert faults == []


def test_lint_finds_what_it_looks_for():
    """One fault each in a good program: it has to be found, and nothing else."""
    good = PROGRAMS["generated"][1](MACHINE)
    cut = next(line for line in good.split("\n") if " G93 " in line)
    x = re.search(r"X(-?\d+)\.(\d+)", cut)[0]
    for wrong in (
        cut.replace(x, "X+1.00000"),
        cut.replace(x, "X.50000"),
        cut.replace(x, "X1.0000"),
        cut.replace(x, "X1E5"),
        cut.replace("A=DC(", "A=AC("),
        re.sub(r" F\S+", "", cut),
        cut + " COMPCAD",
        cut + " (comment)",
        cut + " " * 250,
        cut.replace(" G1 ", " G2 "),
        cut.lower(),
        re.sub(r"A=DC\(\d+", "A=DC(361", cut),
    ):
        assert len(lint(good.replace(cut, wrong), modulo=True)) >= 1, wrong
    assert lint(good.replace("M30\n", ""), modulo=True)
    assert lint(good.replace("; LINTED", "; 1BAD"), modulo=True)


def lint(text, modulo):
    """Sentences of what is wrong, with their lines."""
    faults = []
    lines = text.split("\n")
    if not NAME.fullmatch(lines[0].removeprefix("; ")):
        faults.append(f"the first comment {lines[0]!r} is no program name")
    if not re.fullmatch(r"N\d+ M30", lines[-2]) or lines[-1] != "":
        faults.append("the last block is not M30")
    expected, compressor = 10, False
    for number, line in enumerate(lines[:-1], 1):
        found = list(_line_faults(line, modulo))
        if not line.startswith(";"):
            if not line.startswith(f"N{expected} "):
                found.append(f"the block number is not N{expected}")
            expected += 10
        compressor = (compressor or "COMPCAD" in line) and "COMPOF" not in line
        if compressor and " G93" in line:
            found.append("G93 under COMPCAD")
        faults += [f"line {number}: {fault}" for fault in found]
    return faults


def _line_faults(line, modulo):
    if len(line) + 1 > 250:
        yield "longer than 250 characters"
    if not all(" " <= character <= "~" for character in line):
        yield "not printable ASCII"
    if line.startswith(";"):
        return
    code = re.sub(r'"[^"]*"', '""', line)
    if code != code.upper():
        yield "small letters outside of texts"
    code = re.sub(r"\bU[A-Z]+\b", "R1", code)  # a variable of the user may stand in an expression
    if re.search(r"\+\d+\.\d", re.sub(r"[A-Z0-9\])]\+", "", code)) or re.search(r"[=A-Z(]\+\d", code):
        yield "a plus sign before a number"
    if re.search(r"(?<![0-9])\.\d|\d\.(?!\d)", code):
        yield "no digit before or after a decimal point"
    if re.search(r"\d[eE][-+]?\d", code) or "EX" in code:
        yield "an exponent"
    if re.search(r"-0\.0+(?!\d)", code):
        yield "minus zero"
    if re.search(r"\([^()]*[A-Z]{3,}[^()]*\)", code) and not re.search(r"MSG|WRITE|DELETE|SETAL|SPCO|IF", code):
        yield "a comment in parentheses"
    if re.search(r"SUPA|IF|ACC\[", code):
        code = re.sub(r"\[[^]]*\]", "[]", code)
    for axis, digits in re.findall(r"(?<![A-Z_$\[])([XYZABC])(?:=(?:DC|AC)\()?-?\d+(\.\d+)?(?![0-9])", code):
        if len(digits) - 1 != DECIMALS[axis]:
            yield f"{axis} without its {DECIMALS[axis]} decimals"
    words = code.split()
    codes = {word for word in words if re.fullmatch(r"[GM]\d+", word)}
    known = {
        "G0",
        "G1",
        "G4",
        "G17",
        "G40",
        "G54",
        "G64",
        "G642",
        "G90",
        "G93",
        "G94",
        "G710",
        "M3",
        "M4",
        "M5",
        "M6",
        "M8",
        "M9",
        "M30",
        "M0",
        "G60",
    }
    yield from (f"{word} is not of the dialect" for word in sorted(codes - known))
    if "G93" in codes and not any(re.fullmatch(r"F\d+\.\d+", word) for word in words):
        yield "G93 without F"
    for way, angle in re.findall(r" A=?(DC|AC|IC)?\(?(-?\d+\.\d+)", code):
        if modulo != (way == "DC"):
            yield "DC belongs to a modulo axis, and to it alone"
        if way == "DC" and not 0 <= float(angle) < 360:
            yield "DC takes 0 to less than 360 degrees"
