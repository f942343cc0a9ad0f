"""What mill says of a program that a machine must not run: a right program bent in one place, and what must be seen."""

from __future__ import annotations

import re

import numpy as np
import pytest

from gearmath.bevel.tooth import SHARP_EDGE, tooth_space
from gearmath.errors import InputError
from gearmath.machine.control.executor import execute
from gearmath.machine.control.state import Setup
from gearmath.machine.judging.cut import metal_left
from gearmath.machine.judging.feed import crawling
from gearmath.machine.judging.program import faults_of
from gearmath.machine.judging.stated import Stated
from gearmath.machine.milling.run import runs_of
from gearmath.machine.planning.cut_plan import CuttingJob
from gearmath.machine.writing.cutting import cutting_program
from gearmath.specs.bevel_set import load_bevel_set
from gearmath.specs.toml import bundled


@pytest.fixture(scope="module")
def text(gear_set, vertical):
    """Two neighbouring spaces of the gear, coarse."""
    return cutting_program(gear_set, "gear", vertical, "CUT", CuttingJob((0, 1), 5e-3))


@pytest.fixture(scope="module")
def space(gear_set):
    return tooth_space(gear_set.gear, 7)


@pytest.fixture
def judged(gear_set, vertical, space):
    """The sentences that a text earns."""

    def judge(text, machine=vertical):
        path = execute(text, "CUT", Setup.of(machine))
        runs = runs_of(path, gear_set.gear, machine, None, space, SHARP_EDGE)
        return [str(fault) for fault in faults_of(text, path, runs, gear_set.gear, machine)]

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
    assert judged(cutting_program(gear_set, "gear", exact, "CUT", CuttingJob((0, 1), 5e-3)), exact) == []
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
        (r"S120\.000 M3", "S220.000 M3", r"line \d+ cuts at another speed than the 120 rpm that the program states"),
        (r"F200\.000", "F900.000", r"line \d+ moves the cutter at 900 mm/min past the tooth, the program states 300"),
        (r"^N\d+ G0 SUPA Z900\.00000\n(?=N\d+ D1)", "", r"line \d+ moves before Z has gone up to 599\.\d mm"),
        (r"SUPA Z900\.00000", "SUPA Z400.00000", r"line \d+ moves before Z has gone up to 599\.\d mm"),
        (r"(SECTION_1:[\s\S]*?)CTOL=0\.000050", r"\1CTOL=0.500000", r"line \d+ cuts with CTOL=0.5"),
        (r"(SECTION_1:[\s\S]*?)G642 CTOL=\S* OTOL=\S*", r"\1G64", r"line \d+ cuts with G64, the machine file has G642"),
        (r"^; spaces: 0,1\n", "", r"space 2 is not cut with GEAR, 34 of 36 are not"),
        (r"F200\.000", "F20000.000", r"line \d+ needs 20000 mm/min of Z: .* allows 15000 mm/min"),
        (r"(G93 G1 .*) F(\d+)\.", r"\1 F99\2.", r"line \d+ needs \d+ (mm|degrees)/(min|s2) of [XYAB]"),
        (
            r"^N\d+ G0 SUPA Z900\.00000\n([\s\S]*?)N\d+ G0 SUPA Z900\.00000\n(?=N\d+ T=)",
            r"\1",
            r"line \d+ changes the tool before Z has gone up to 599\.\d mm",
        ),
        (r"^N\d+ M8\n", "", r"line \d+ cuts without coolant \(M8\)"),
        (r"(G93 G1 .*\n)(N\d+ G93 G1)", r"\1G4 F0.5\n\2", r"line \d+ lets the cutter stand in the cut"),
        (r"(G93 G1 .*\n)(N\d+ G93 G1)", r"\1M0\n\2", r"line \d+ lets the cutter stand in the cut"),
        (r"(G93 G1 .*\n)(N\d+ G93 G1)", r"\1M5\nS120 M3\n\2", r"line \d+ lets the cutter stand in the cut"),
        (r"(G93 G1 .*\n)(N\d+ G94 G0)", r"\1M0\n\2", r"line \d+ lets the cutter stand in the cut"),
        (
            r"^(; tool GEAR, concave: point radius) \d+",
            r"\1 99",
            r"line \d+ says 'concave: point radius 99\..*have 'conc",
        ),
        (r"C_t 150", "C_t 155", r"line \d+ says 'C_t 155 the length of the tool', the files .* have 'C_t 150 the"),
        (
            r"36 teeth, right",
            "36 teeth, left",
            r"line \d+ says 'left hand', the files of set and machine have 'right hand'",
        ),
        (r"outside diameter \d", "outside diameter 7", r"line \d+ says 'blank: outside diameter 7"),
        (r"cutter turns M3", "cutter turns M4", r"line \d+ says 'cutter turns M4"),
        (
            r"R90<=2\) AND \(\(R91==0\) OR \(R91>=2",
            "R90<=2) AND ((R91==0) OR (R91>=1",
            r"with R90=2 R91=2 does not make section 2 of the whole run, and that alone",
        ),
        (r"R90<=2\) AND", "R90<=1) AND", r"with R90=2 R91=2 is refused: .* motion without a tool"),
        (r"^N\d+ M0\n", "", r"with R90=1 moves before it has waited at M0 for the operator"),
        (r"\(R91>2\)", "(R91>9)", r"moves with R90=0 R91=3, which choose nothing that it has"),
        (
            r"(SECTION_1:\n)",
            r"\1IF $AA_IM[X]>50\nG4 F1\nENDIF\n",
            r"line \d+ goes on in one way or another by \$AA_IM\[X\]",
        ),
        (r"(SECTION_1:\n)", r"\1IF R104==1\nG4 F1\nENDIF\n", None),
        (r"(SECTION_1:\n)", r"\1IF R104==1\nM5\nENDIF\n", r"line \d+ goes on in one way or another by R104"),
        (r"(SECTION_1:\n)", r"\1UL=$P_TOOLL[1]\nIF UL>0\nG4 F1\nENDIF\n", r"column 1: the variable UL is not defined"),
        (r"(SECTION_1:\n)", r"\1R7=R102\nIF R7>0\nM9\nENDIF\n", r"line \d+ goes on in one way or another by R102"),
        (r"(SECTION_1:\n)", r"\1WHILE R102<0\nG4 F1\nENDWHILE\n", r"line \d+ repeats by R102, which is not known here"),
    ],
)
def test_what_a_machine_must_not_do_is_said(text, judged, pattern, wrong, sentence):
    try:
        said = judged(bent(text, pattern, wrong))
    except InputError as error:
        said = [str(error)]
    assert said == [] if sentence is None else any(re.search(sentence, one) for one in said), said


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
    wide = vertical.model_copy(
        update={
            "fixture": vertical.fixture.model_copy(update={"shank_radius": 50.0, "shank_length": 1.0, "radius": 300.0})
        }
    )
    assert any("into the fixture" in one for one in judged(text, wide))


@pytest.mark.slow
def test_hobbed_block_beside_its_path_is_seen_in_every_axis(vertical):
    """By hand: 0.06 mm or degrees in the middle of the roll, where 20 um are stated; A and C count together."""
    bevel_set = load_bevel_set(bundled("crown_gear_hobbed_14x39.toml"))
    spec = bevel_set.gear
    text = cutting_program(bevel_set, "gear", vertical, "CUT", CuttingJob(range(39), 2e-2))

    def said(text):
        path = execute(text, "CUT", Setup.of(vertical))
        runs = runs_of(path, spec, vertical, None)
        return [str(one) for one in faults_of(text, path, runs, spec, vertical)]

    assert said(text) == []
    lines = text.split("\n")
    k = [j for j, line in enumerate(lines) if " G93 " in line][350]
    for axis in "XYZABC":
        word = re.search(rf"{axis}(?:=DC\()?(-?[\d.]+)", lines[k])
        wrong = lines[k].replace(word[0], word[0].replace(word[1], f"{float(word[1]) + 0.06:.6f}"))
        found = said("\n".join([*lines[:k], wrong, *lines[k + 1 :]]))
        assert any(one.startswith(f"line {k + 1} ends 0.") for one in found), (axis, found)


def test_stock_gouge_and_missing_metal_are_said_without_a_report(gear_set, vertical, text, space, host_compiler):
    """A program that states no tolerance is judged by 1 um, one that leaves stock by its stock."""
    spec = gear_set.gear

    def left(text):
        runs = runs_of(execute(text, "CUT", Setup.of(vertical)), spec, vertical, None, space, SHARP_EDGE)
        found = metal_left(runs, spec, vertical, Stated.of(text), space)
        return [str(one) for one in found.faults]

    assert left(text) == []
    unsaid = bent(text, r"^; flank tolerance: .*\n", "")
    assert any(re.search(r"leaves .* um, no tolerance is stated, allowed are 1 um", one) for one in left(unsaid))
    stock = cutting_program(gear_set, "gear", vertical, "CUT", CuttingJob((0,), 5e-3, finishing_stock=0.1))
    assert left(stock) == []
    said = left(stock.replace("; finish: stock 0.1 mm", "; finish: stock 0 mm"))
    assert any(re.search(r"leaves \+[12]\d\d\.\d* um, the program states 5 um", one) for one in said), said
    deeper = re.sub(r"(G1 .*)Z500\.00000", r"\1Z499.90000", text)
    said = left(deeper)
    assert any(re.search(r"gouges the (root|\w+ \w+) of space 0: -1\d\d", one) for one in said), said


def test_program_with_index_corrections_is_judged_by_the_places_that_they_ask_for(gear_set, vertical, host_compiler):
    """As compensate writes them; the program of the set without them is a gouge for the set that has them."""
    wanted = tuple(0.004 * (k % 3 - 1) for k in range(gear_set.gear.teeth))  # up to 0.004 degrees, about 9 um
    spec = gear_set.gear.model_copy(update={"index_correction": wanted})
    corrected = gear_set.model_copy(update={"gear": spec})
    space = tooth_space(spec, 7)

    def left(text):
        runs = runs_of(execute(text, "CUT", Setup.of(vertical)), spec, vertical, None, space, SHARP_EDGE)
        return [str(one) for one in metal_left(runs, spec, vertical, Stated.of(text), space).faults]

    job = CuttingJob((0, 2), 1e-3)
    assert left(cutting_program(corrected, "gear", vertical, "CUT", job)) == []
    assert left(cutting_program(gear_set, "gear", vertical, "CUT", job)) != []


@pytest.mark.parametrize(
    ("check", "said"),
    [
        (r"IF \$MN_SCALING.*\n(.*\n)*?.*ENDIF\n", "basic system is inch"),
        (r"IF \$MN_INT_INCR_PER_MM.*\n(.*\n)*?.*ENDIF\n", "fewer increments per mm"),
        (r"IF .*\$P_ACTFRAME\[X,TR\].*\n(.*\n)*?.*ENDIF\n", "G54 is 0.01 off in X"),
        (r"IF .*\$P_ACTFRAME\[X,RT\].*\n(.*\n)*?.*ENDIF\n", "a frame turns"),
        (r"IF \$TC_TP2.*\n(.*\n)*?.*ENDIF\n", "another tool is in the spindle"),
        (r"IF ABS\(\$P_TOOLL.*\n(.*\n)*?.*ENDIF\n", "length 1 of the tool in the table is wrong"),
    ],
)
def test_check_of_the_control_that_is_taken_out_is_missed(text, judged, check, said):
    plain = re.sub(r"(?m)^N\d+ ", "", text)
    assert judged(plain) == []
    (fault,) = judged(re.sub(check, "", plain))
    assert fault.startswith("does not stop before it cuts where")
    assert said in fault


def test_parameter_that_another_program_left_is_named(text, judged):
    (fault,) = judged(bent(text, r"^(N\d+ )TRANS$", r"\1TRANS X=R50"))
    assert re.match(r"line \d+ reads R50 before it sets it", fault)
    assert judged(bent(text, r"^(N\d+ )TRANS$", r"R50=0\n\1TRANS X=R50")) == []


def test_comments_that_say_nothing_wrong_are_no_faults(text, judged):
    """Words of the shop, statements that were taken out, and others put in."""
    changed = text.replace("; clamping", "; our mandrel 7, clamping").replace("; pitch apex", ";pitch   apex")
    changed = re.sub(r"(?m)^; (chip|note|unconfirmed|set).*\n", "", changed) + "; last changed by the night shift\n"
    assert judged(re.sub(r"(?m)^; tool .*\n", "", changed)) == []


@pytest.mark.parametrize(
    ("pattern", "wanted"),
    [
        (r"^N\d+ (?=G93)", ""),  # no block numbers
        (r"G93 G1 X(\S+) Y(\S+)", r"G93 G1 Y\2 X\1"),
        (r"\bG1\b", "G01"),
        (r"A=DC\((\S+)\)", r"A = DC( \1 )"),
        (r"^(N\d+ STOPRE)$", r"\1\nSTOPRE"),
        (r"^(N\d+ M8)$", r"\1\nM8"),
        (r"^(N\d+ M8)$", r"\1\nG4 F2"),
        (r"^(N\d+ G94 G0 Z\S+ F\S+)$", r"\1\nM0"),  # the cutter is out of the work
        (r"^(N\d+ G94 G0 Z\S+ F\S+)$", r"\1\nG4 F1"),
        (r"^(N\d+ G94 G0 Z\S+ F\S+)$", r'\1\nMSG("space done")'),
        (r"^(N\d+ TRAFOOF)$", r"R7=3\n\1"),
        (r"^(N\d+ TRAFOOF)$", r"\1\nTRAFOOF"),
        (r"SECTION_1:", "ERSTE_LUECKE:"),
        (r"F200\.000", "F150."),
        (r"^(N\d+ G93 G1 .*) F(\d\d+\.\d+)$", r"\1 F9.9"),  # slower, all of them
        (r"^; flank tolerance: 5 um", "; flank tolerance: 9 um"),
        (r"^; R90", ";r90"),
        (r"MSG\(", "msg("),
        (r"^(N\d+ M30)$", "\n; the end\n\\1"),
        (r"IF \(R90<=1\) AND", "IF (1>=R90) AND"),
    ],
)
def test_what_does_no_harm_is_no_fault(text, judged, pattern, wanted):
    assert judged(bent(text, pattern, wanted, count=0)) == []


def test_dynamics_are_those_of_the_machine_file(text, judged):
    assert any("cuts with FFWOF, the machine file has FFWON" in one for one in judged(text.replace("FFWON", "FFWOF")))
    assert any("cuts with BRISK, the machine file has SOFT" in one for one in judged(text.replace("SOFT", "BRISK")))


@pytest.fixture
def crawl(vertical):
    """The sentences that a text for a member of a set earns for blocks that take long."""

    def judge(text, spec):
        path = execute(text, "CUT", Setup.of(vertical))
        space = None if spec.process == "face_hobbing" else tooth_space(spec, 7)
        return crawling(path, runs_of(path, spec, vertical, None, space), spec, vertical, Stated.of(text))

    return judge


def test_blocks_that_crawl_are_named_with_their_time_and_what_the_program_states(gear_set, vertical, text, crawl):
    """A hundredth of F in the middle of a roll, a fiftieth in all of it; F of G93 read in mm/min in a plunge."""
    assert crawl(text, gear_set.gear) == []
    lines = text.split("\n")
    rolls = [k for k, line in enumerate(lines) if " G93 G1 X" in line]
    k = rolls[len(rolls) // 3]
    value = float(re.search(r" F([0-9.]+)", lines[k])[1]) / 100
    slow = "\n".join([*lines[:k], re.sub(r" F[0-9.]+", f" F{value:.6f}", lines[k]), *lines[k + 1 :]])
    minutes, speed = 1 / value, 3.0  # F of G93 is one over minutes; 300 mm/min are stated
    said = rf"a block crawls: line {k + 1}, {minutes:.1f} min at {speed:.2g} mm/min, the program states 300 mm/min: "
    assert re.match(said, crawl(slow, gear_set.gear)[0])
    every = re.sub(r"(G93 G1 X.* F)([0-9.]+)", lambda found: f"{found[1]}{float(found[2]) / 50:.6f}", text)
    assert re.match(r"\d+ blocks crawl, the longest is line ", crawl(every, gear_set.gear)[0])
    formate = load_bevel_set(bundled("crown_gear_formate_14x39.toml"))
    down = cutting_program(formate, "gear", vertical, "CUT", CuttingJob((0,)))
    without = crawl(bent(down, r"G93 (G1 .*)", r"\1"), formate.gear)
    assert re.search(r"at 15 mm/min, the program states 200 mm/min: look at its F and G93", without[0])
    nothing_stated = re.sub(r"^; feed.*\n", "", slow, flags=re.MULTILINE)
    assert re.search(r"at 3 mm/min, most blocks have 300 mm/min", crawl(nothing_stated, gear_set.gear)[0])


def test_hobbing_crawls_where_its_cutter_hardly_turns_and_not_where_the_tolerance_wants_a_slow_roll(vertical, crawl):
    bevel_set = load_bevel_set(bundled("crown_gear_hobbed_14x39.toml"))
    text = cutting_program(bevel_set, "pinion", vertical, "CUT", CuttingJob(range(14), 5e-3))
    assert crawl(text, bevel_set.pinion) == []
    lines = text.split("\n")
    k = [k for k, line in enumerate(lines) if " G93 G1 " in line][40]
    slow = "\n".join([*lines[:k], re.sub(r" F[0-9.]+", " F0.05", lines[k]), *lines[k + 1 :]])
    (said,) = crawl(slow, bevel_set.pinion)
    assert re.match(
        rf"a block crawls: line {k + 1}, 20.0 min at 0\.\d+ rpm of C, the program states 120 rpm of C", said
    )
