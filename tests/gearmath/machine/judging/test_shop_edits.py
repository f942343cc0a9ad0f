"""What a hand changes in a program at the machine, in both dialects: refused or reported, or it does no harm."""

from __future__ import annotations

import re

import pytest

from gearmath.bevel.tooth import SHARP_EDGE, tooth_space
from gearmath.errors import InputError
from gearmath.machine.control.executor import execute
from gearmath.machine.control.state import Setup
from gearmath.machine.judging.program import faults_of
from gearmath.machine.milling.run import runs_of
from gearmath.machine.planning.cut_plan import CuttingJob, cutting_plan
from gearmath.machine.writing.cutting import cutting_program
from gearmath.machine.writing.linuxcnc.cutting import program_of as linuxcnc_program
from gearmath.specs.bevel_set import load_bevel_set
from gearmath.specs.milling_machine import load_milling_machine
from gearmath.specs.toml import bundled

MACHINE = load_milling_machine(bundled("vertical_5axis.toml"))
NASA, FORMATE = "nasa_tp3096_12x36", "crown_gear_formate_14x39"


@pytest.fixture(scope="module")
def programs():
    """Two spaces of a gear, coarse: SINUMERIK, LinuxCNC, and Formate; with the gear, and a space of it."""
    found = {}
    for key, name in (("sinumerik", NASA), ("linuxcnc", NASA), ("formate", FORMATE)):
        bevel_set, job = load_bevel_set(bundled(f"{name}.toml")), CuttingJob((0, 1), 5e-3)
        if key == "linuxcnc":
            text = linuxcnc_program(cutting_plan(bevel_set, "gear", MACHINE, job), "CUT")
        else:
            text = cutting_program(bevel_set, "gear", MACHINE, "CUT", job)
        found[key] = text, bevel_set.gear, tooth_space(bevel_set.gear, 7)
    return found


def said_of(program, pattern=None, wrong="", count=1):
    """The sentences that a program earns with the first match of a pattern replaced."""
    text, spec, space = program
    if pattern is not None:
        text, found = re.subn(pattern, wrong, text, count=count, flags=re.MULTILINE)
        assert found, pattern
    try:
        path = execute(text, "CUT", Setup.of(MACHINE))
        runs = runs_of(path, spec, MACHINE, None, space, SHARP_EDGE)
        return [str(one) for one in faults_of(text, path, runs, spec, MACHINE)]
    except InputError as error:
        return [str(error)]


ROLL = r"(G93 G1 .*\n)(N\d+ G93 G1 )"
UNRUN = r"line \d+ is not run where all parts are"
SINUMERIK = [
    (ROLL, r"\1/\2", r"line \d+ is left out where block skip is on"),
    (r"^(N\d+ G94 G0 Z540)", r"/\1", r"line \d+ is left out where block skip is on"),
    (r"^(N\d+ M0)", r"/\1", r"line \d+ is left out where block skip is on"),
    (r"^(N\d+ SETAL)", r"/\1", r"line \d+ is left out where block skip is on"),
    (ROLL, r"\1STOPRE\n\2", r"line \d+ lets the cutter stand in the cut"),
    (r"SECTION_2:", "SECTION_1:", r"the label SECTION_1 stands in line \d+ already"),
    (r"FGROUP\(X,Y,Z\)", "FGROUP(X)", "G94 with no axis of FGROUP moving"),
    (
        r"^N\d+ G94 G0 Z540.*\n(N\d+ ENDIF\nN\d+ R90=0)",
        r"\1",
        r"line \d+ draws the cutter out of the cut with the spindle not",
    ),
    (
        r"^N\d+ G94 G0 Z540.*\n(N\d+ ENDIF\nN\d+ R90=0[\s\S]*)N\d+ G0 SUPA Z900.*\n",
        r"\1",
        r"line \d+ is the last motion of its tool and leaves it \d",
    ),
    (r"^(N\d+ ENDIF\n; section 2)", r"ELSE\nG0 Z480\n\1", UNRUN),
    (r"^(N\d+ SECTION_2:)", r"IF (R90==1) AND (R91==2)\nG0 Z480\nENDIF\n\1", UNRUN),
    (r"^(N\d+ S120)", r"IF R90==2\nS3000 M3\nENDIF\n\1", UNRUN),
    (r"^(N\d+ SETAL\(65013)", r"G0 SUPA Z400\n\1", UNRUN),
    (r"^(N\d+ SETAL\(65013)", r"S3000 M3\n\1", UNRUN),
    (
        r"^(N\d+ G94 G0 Z540.*)$",
        r"IF R90==0\n\1\nENDIF",
        "with R90=1 R91=1 does not make section 1 of the whole run",
    ),
    (r"AA_IM\[Z\]<599\.789", "AA_IM[Z]<0.789", "does not stop before it cuts where the tool stands lower than Z 599.8"),
    (r"^N\d+ IF \(\(\$AA_IM.*\n(.*\n)*?.*ENDIF\n", "", "does not stop before it cuts where the tool stands lower"),
]
LINUXCNC = [
    (r"^G43\nS120", "G43 H2\nS120", "H2 is not understood here"),
    (r" Q0$", " Q0.1", r"line \d+ cuts with CTOL=0\.1"),
    (r"^G4 P3\.0", "G4", "G4 without a time P"),
    (r"^(G1 X.*\n)(G1 X)", r"\1%\n\2", "% ends the program"),
    (r"^(G1 X.*\n)(G1 X)", r"\1M5\nM3 S120\n\2", r"line \d+ lets the cutter stand in the cut"),
    (r"^(G1 X.*\n)(G1 X)", r"\1M66 P1 L0\n\2", r"line \d+ lets the cutter stand in the cut"),
    (r"^(G1 X.*\n)(G1 X)", r"\1M68 E0 Q1\n\2", r"line \d+ lets the cutter stand in the cut"),
    (r"^(G1 X.*\n)(G1 X)", r"\1/\2", "is not understood"),
    (r"^(G1 X.*)$", r"\1 U5", "U5 is not understood here"),
    (r"^(G1 X.*) F\S+$", r"\1", "F is missing: every G93 block needs its own"),
    (r"^o114 if", "o113 if", "begins for the second time|ends nothing|is not ended"),
    (r"^o113 endif", "o113 else\nG0 Z480\no113 endif", UNRUN),
    (r"^o114 endif", "o114 else\nG0 Z480\no114 endif", UNRUN),
    (r"^G0 Z540\.00000\n(o114 endif)", r"\1", r"line \d+ draws the cutter out of the cut with the spindle not"),
]


@pytest.mark.parametrize(("pattern", "wrong", "sentence"), SINUMERIK)
def test_edit_of_a_program_for_a_sinumerik_is_seen(programs, pattern, wrong, sentence):
    said = said_of(programs["sinumerik"], pattern, wrong)
    assert any(re.search(sentence, one) for one in said), said


@pytest.mark.parametrize(("pattern", "wrong", "sentence"), LINUXCNC)
def test_edit_of_a_program_for_linuxcnc_is_seen(programs, pattern, wrong, sentence):
    said = said_of(programs["linuxcnc"], pattern, wrong)
    assert any(re.search(sentence, one) for one in said), said


def test_label_of_linuxcnc_that_is_there_twice_is_refused(programs):
    text, *rest = programs["linuxcnc"]
    assert "begins for the second time" in said_of((text.replace("o114", "o113"), *rest))[0]


def test_formate_plunge_ends_with_a_turn_of_the_cutter(programs):
    """By hand: 300 mm/min at 120 rpm are 2.5 mm a turn, of which the flatter flank, at 15.9 degrees, keeps 0.69 mm."""
    dwell = r"^(N\d+ )G4 F0\.75\S*$"
    assert said_of(programs["formate"]) == []
    assert said_of(programs["formate"], dwell, r"\1G4 F0.5") == []
    (fault,) = said_of(programs["formate"], dwell, r"\1G4 F0.05")
    assert re.search(
        r"leaves the end of its plunge after 0\.10 turns of the cutter: the flanks keep up to 6[12]\d um", fault
    )
    (fault,) = said_of(programs["formate"], dwell, r"\1STOPRE")
    assert re.search(r"after 0\.00 turns of the cutter: the flanks keep up to 6[789]\d um", fault)


@pytest.mark.parametrize(
    ("dialect", "pattern", "wanted"),
    [
        ("sinumerik", r"^(N\d+ MSG)", r"/\1"),
        ("sinumerik", r"^(N\d+ SECTION_2:)", r"/M0\n\1"),
        ("sinumerik", r"^(N\d+ SECTION_2:)", r"/G4 F1\n\1"),
        ("sinumerik", r"^(N\d+ SECTION_2:)", r"STOPRE\n\1"),
        ("sinumerik", r"^N\d+ G0 SUPA Z900\.00000\n(N\d+ M30\n)(?![\s\S]*M30)", r"\1"),  # it has been drawn out before
        ("linuxcnc", r"^(o114 if)", r"M66 P1 L0\n\1"),
        ("linuxcnc", r"\A", "%\n"),
        ("linuxcnc", r"\Z", "%\n"),
        ("linuxcnc", r" Q0$", " Q0.00001"),
    ],
)
def test_edit_that_does_no_harm_is_no_fault(programs, dialect, pattern, wanted):
    assert said_of(programs[dialect], pattern, wanted) == []
