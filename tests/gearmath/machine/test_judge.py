"""What mill says of a program that a machine must not run: a right program bent in one place, and what must be seen."""

from __future__ import annotations

import re

import numpy as np
import pytest

from gearmath.bevel.tooth import SHARP_EDGE, tooth_space
from gearmath.errors import InputError
from gearmath.machine.control import Setup
from gearmath.machine.cutting import Job, cutting_program
from gearmath.machine.executor import execute
from gearmath.machine.judge import faults_of
from gearmath.machine.run import runs_of


@pytest.fixture(scope="module")
def text(gear_set, vertical):
    """Two neighbouring spaces of the gear, coarse."""
    return cutting_program(gear_set, "gear", vertical, "CUT", Job((0, 1), 5e-3))


@pytest.fixture(scope="module")
def space(gear_set):
    return tooth_space(gear_set.gear, "gear", 7)


@pytest.fixture
def judged(gear_set, vertical, space):
    """The sentences that a text earns."""

    def judge(text, machine=vertical):
        path = execute(text, "CUT", Setup.of(machine))
        runs = runs_of(path, gear_set.gear, "gear", machine, None, space, SHARP_EDGE)
        return [str(fault) for fault in faults_of(text, path, runs, gear_set.gear, "gear", machine)]

    return judge


def bent(text, pattern, wrong, count=1):
    """The text with the first match of a pattern replaced; it has to be there."""
    changed, found = re.subn(pattern, wrong, text, count=count, flags=re.MULTILINE)
    assert found
    return changed


def line_of(text, pattern):
    return text[: re.search(pattern, text, re.MULTILINE).start()].count("\n") + 1


def test_right_program_has_no_faults(text, judged):
    assert judged(text) == []


def test_exact_stop_needs_no_tolerance_of_the_path_and_g642_does(gear_set, vertical, text, judged):
    exact = vertical.model_copy(update={"control": vertical.control.model_copy(update={"path_mode": "G60"})})
    assert judged(cutting_program(gear_set, "gear", exact, "CUT", Job((0, 1), 5e-3)), exact) == []
    assert "the program moves before it states CTOL" in judged(text.replace("CTOL=0.000050 ", ""))


@pytest.mark.parametrize(
    ("pattern", "wrong", "sentence"),
    [
        (r"S120\.000 M3", "S120.000 M4", r"line \d+ cuts with the spindle turning backwards: .* cuts with M3"),
        (r"S120\.000 M3", "S9120.000 M3", r"line \d+ cuts at a speed outside of 20 to 3000 rpm"),
        (r"S120\.000 M3", "S12.000 M3", r"line \d+ cuts at a speed outside of 20 to 3000 rpm"),
        (r"^N\d+ TRAFOOF\n", "", "the program moves before it states TRAFOOF"),
        (r"^N\d+ COMPOF\n", "", "the program moves before it states COMPOF"),
        (r"^N\d+ TRANS\n", "", "the program moves before it states TRANS"),
        (r" SOFT FFWON", "", "states SOFT or BRISK, FFWON or FFWOF"),
        (r"^; spaces: 0,1$", "; spaces: 0,1,2", "space 2 is not cut with GEAR, 1 of 3 are not"),
        (r"^; spaces: 0,1$", "; spaces: 0", "space 1 is cut with GEAR, and should not be"),
        (r"F200\.000", "F20000.000", r"line \d+ needs 20000 mm/min of Z: .* allows 15000 mm/min"),
        (r"(G93 G1 .*) F(\d+)\.", r"\1 F99\2.", r"line \d+ needs \d+ (mm|degrees)/(min|s2) of [XYAB]"),
    ],
)
def test_what_a_machine_must_not_do_is_said(text, judged, pattern, wrong, sentence):
    said = judged(bent(text, pattern, wrong))
    assert any(re.search(sentence, one) for one in said), said


def test_another_work_offset_is_refused(text, judged):
    with pytest.raises(InputError, match="G55 is active, the machine file counts from G54"):
        judged(text.replace("G54", "G55"))


def test_position_out_of_travel_is_said_of_rapid_blocks_too(text, judged):
    said = judged(bent(text, r"G0 Z540\.00000", "G0 Z940.00000"))
    assert any("moves Z to 940.000 mm" in one and "travels -100 to 900 mm" in one for one in said), said


def test_indexing_through_the_teeth_is_seen_at_every_height(text, judged, gear_set, vertical):
    """The retract after space 0 is left lower and lower: from where the blades come near the face cone on, it is said.

    By hand: the tip plane is that of the root line, and the face cone's highest point over it is at the heel, where the
    tooth is deepest, if the tool is over it; so the whole depth there, and the clearance of 3 mm, bound the height.
    """
    blank = gear_set.gear.blank
    half = blank.face_width / 2
    growth = np.tan(np.radians(blank.face_angle - blank.root_angle))
    depth = blank.mean_addendum + blank.mean_dedendum + half * growth
    bottom = 500.0
    for height in np.arange(-0.5, depth + 12.0, 1.0):
        retract = f"G94 G0 Z{bottom + height:.5f}"
        said = judged(
            bent(bent(text, r"G94 G0 Z540\.00000", retract), r"(SECTION_2:[\s\S]*?)G0 Z540\.00000", r"\1G0 Z540.00000")
        )
        rapid = [one for one in said if "moves in rapid" in one]
        if height < depth - 2.0:
            assert rapid, height
        if height > depth + 3.5:
            assert not rapid, (height, rapid)


@pytest.mark.parametrize("axis", ["X", "Y", "A", "B"])
def test_feed_block_beside_the_path_is_seen_with_its_line(text, judged, axis):
    """In the middle of the roll, by 0.5 mm or 0.5 degrees."""
    lines = text.split("\n")
    rows = [k for k, line in enumerate(lines) if " G93 G1 " in line]
    k = rows[len(rows) // 4]
    word = re.search(rf"{axis}(?:=DC\()?(-?[\d.]+)", lines[k])
    value = float(word[1]) + 0.5
    changed = abs(value) % 360 if axis == "A" else value
    lines[k] = lines[k].replace(word[0], word[0].replace(word[1], f"{changed:.6f}"))
    said = judged("\n".join(lines))
    assert any(re.match(rf"line {k + 1} ends 0\.[3-9]\d* mm beside|line {k + 1} ends", one) for one in said), said


def test_fixture_in_the_way_is_said_with_the_line(text, judged, vertical):
    wide = vertical.model_copy(update={"fixture": vertical.fixture.model_copy(
        update={"shank_radius": 50.0, "shank_length": 1.0, "radius": 300.0})})  # fmt: skip
    assert any("into the fixture" in one for one in judged(text, wide))
