"""Polynomial programs of face hobbed members: read from their text by words typed here, cut blade by blade."""

import math
import re
from functools import lru_cache

import numpy as np
import pytest

from gearmath.bevel.tooth import SHARP_EDGE
from gearmath.errors import InputError
from gearmath.machine.control.executor import execute
from gearmath.machine.control.state import Setup
from gearmath.machine.judging.motion import motion_faults
from gearmath.machine.judging.program import faults_of, metal_faults
from gearmath.machine.judging.stated import Stated
from gearmath.machine.judging.trajectory import trajectory
from gearmath.machine.milling.mill import mill_member
from gearmath.machine.milling.run import runs_of
from gearmath.machine.planning.cut_plan import CuttingJob, cutting_plan
from gearmath.machine.planning.path import six_axes, spindle_phase
from gearmath.machine.writing.cutting import cutting_program
from gearmath.specs.bevel_set import load_bevel_set
from gearmath.specs.milling_machine import load_milling_machine
from gearmath.specs.toml import bundled
from tests.gearmath.machine.milling.flank_borders import left_at_borders
from tests.gearmath.machine.writing.polynomial_text import along_blocks, written_again, written_in

MODULO = load_milling_machine(bundled("vertical_5axis.toml"))
COUNTING = load_milling_machine(bundled("vertical_5axis_counting.toml"))
HOBBED = load_bevel_set(bundled("crown_gear_hobbed_14x39.toml"))
MEMBERS = ("pinion", "gear")
#: Five decimals of mm and six of degrees, with the two more that coefficients have; a degree as so many mm at the work.
IN_MM = np.array([1.0, 1.0, 1.0, *[math.radians(1.0) * 100.0] * 3])


def counting(values=18, **axis):
    """The bundled machine whose A and C count on, with blocks of so many values."""
    axes = {name: getattr(COUNTING.axes, name).model_copy(update=axis) for name in "AC"}
    control = COUNTING.control.model_copy(update={"polynomial_values": values})
    return COUNTING.model_copy(update={"axes": COUNTING.axes.model_copy(update=axes), "control": control})


MACHINES = {3: counting(), 5: counting(30)}


def job(member, tolerance=1e-4, **more):
    return CuttingJob(range(HOBBED.member(member).teeth), tolerance, blocks="poly", **more)


@lru_cache
def text_of(member, tolerance=1e-4, degree=3):
    return cutting_program(HOBBED, member, MACHINES[degree], "HOB", job(member, tolerance))


def roll_of(text):
    """Where the only roll of a text starts, degrees, and for every block behind it the values of PO and the time."""
    now, blocks = {}, []
    for line in text.splitlines():
        if "G93 POLY " in line:
            blocks.append((written_in(line), 60.0 / float(re.search(r" F([0-9.]+)", line)[1])))
        elif line.startswith("N") and not blocks:
            now |= {axis: float(value) for axis, value in re.findall(r" ([XYZABC])(-?[0-9.]+)", line)}
    return np.array([now[axis] for axis in "XYZABC"]), blocks


def judged(text, member, machine):
    """What ``mill`` says of a text: sentences, or the one that refuses it."""
    spec = HOBBED.member(member)
    try:
        path = execute(text, "HOB", Setup.of(machine))
        runs = runs_of(path, spec, machine, None, None, SHARP_EDGE)
        found = [str(one) for one in faults_of(text, path, runs, spec, machine)]
        return found + [str(one) for one in metal_faults(text, path, runs, spec, machine, None).faults]
    except InputError as error:
        return [str(error)]


@pytest.mark.parametrize("member", MEMBERS)
def test_six_cubic_blocks_are_enough_for_a_roll_and_twelve_for_a_fifth_of_the_tolerance(member):
    """Decimals of A, B and C take 0.013 um, so that 0.02 um is about the least that can be asked for."""
    for tolerance, degree, most in ((1e-4, 3, 6), (2e-5, 3, 12), (1e-4, 5, 2)):
        _, (down, *blocks) = roll_of(text_of(member, tolerance, degree))
        assert max(len(values) for values in down[0].values()) == 1  # straight
        assert 1 <= len(blocks) <= most


@pytest.mark.parametrize(("member", "degree"), [("pinion", 3), ("gear", 3), ("pinion", 5)])
def test_the_text_cuts_all_spaces_within_its_tolerance_and_mill_has_nothing_to_say(member, degree):
    text, machine = text_of(member, degree=degree), MACHINES[degree]
    stated = float(re.search(r"flank tolerance: ([0-9.]+) um", text)[1]) / 1000
    assert stated == pytest.approx(1e-4)
    path = execute(text, "HOB", Setup.of(machine))
    left = mill_member(path, HOBBED.member(member), machine)
    assert np.abs(left.deviation).max() <= stated
    assert 0.7 * stated <= left_at_borders(path, HOBBED.member(member), machine).max() <= stated
    assert judged(text, member, machine) == []


@pytest.mark.parametrize("member", MEMBERS)
def test_work_and_cutter_turn_in_their_ratio_all_along_the_text(member):
    """Blade groups over teeth, typed here: A and C less what the roll does to them stand still, through all turns."""
    spec = HOBBED.member(member)
    start, blocks = roll_of(text_of(member))
    where = along_blocks(start, blocks, np.linspace(0.0, 1.0, 33))[1:]  # behind the plunge
    plan = cutting_plan(HOBBED, member, MACHINES[3], job(member))
    nodes = plan.passes[0].theta[1:]
    theta = (nodes[:-1, None] + np.linspace(0.0, 1.0, 33) * np.diff(nodes)[:, None]).ravel()
    flank = spec.flank("concave")
    rolled = six_axes(flank, theta, np.zeros(len(theta)), 0.0, MACHINES[3].pivot_height, MACHINES[3].pivot)
    beta = where[..., 5].ravel() - np.degrees(spindle_phase(flank, theta))
    work = where[..., 3].ravel() - np.degrees(rolled[:, 3])
    ratio = spec.indexing_sign * spec.blade_groups / spec.teeth
    off = work + ratio * beta
    assert np.abs(beta[-1] - beta[0]) > 50 * 360.0
    assert np.ptp(off) < 1e-4  # degrees: 0.2 um at 100 mm, over many turns


@pytest.mark.parametrize(("member", "degree"), [("pinion", 3), ("gear", 5)])
def test_without_its_word_poly_the_control_drives_straight_and_mill_sees_it(member, degree):
    machine, text = MACHINES[degree], text_of(member, degree=degree)
    straight = text.replace("G93 POLY ", "G93 G1 ")
    assert not execute(straight, "HOB", Setup.of(machine)).inner.any()
    assert judged(straight, member, machine) != []
    parts = text.split("G93 POLY ")
    for k in range(2, len(parts)):  # the block after the plunge, which is straight, and the others: one by one
        changed = "G93 POLY ".join(parts[:k]) + "G93 G1 " + "G93 POLY ".join(parts[k:])
        assert judged(changed, member, machine) != []


@pytest.mark.parametrize("degree", [3, 5])
def test_what_is_read_is_written_again_byte_for_byte(degree):
    text, machine = text_of("gear", degree=degree), MACHINES[degree]
    found = list(written_again(text, "HOB", machine, 6, degree))
    assert len(found) == text.count("G93 POLY ") > 1
    for words, line in found:
        assert words in line


@pytest.mark.slow
def test_wrong_digits_that_move_the_tool_are_seen_and_those_that_do_not_pass():
    """Digits of a block, a seeded choice and the last ones of its coefficients; harm is how far the axes move."""
    member, machine = "gear", MACHINES[3]
    text = text_of(member)
    lines, u = text.splitlines(), np.linspace(0.0, 1.0, 65)
    start, blocks = roll_of(text)
    right = along_blocks(start, blocks, u)
    at = [k for k, line in enumerate(lines) if "G93 POLY " in line][2]
    rng = np.random.default_rng(17)
    digits = [m.start() for m in re.finditer(r"[0-9]", lines[at]) if m.start() > lines[at].index("POLY")]
    last = [m.end() - 2 for m in re.finditer(r",-?[0-9.]+\)", lines[at])]
    places, seen, passed = [*rng.permutation(digits)[:20], *last], 0, 0
    for place in places:
        digit = str((int(lines[at][place]) + rng.integers(1, 10)) % 10)
        changed = lines[at][:place] + digit + lines[at][place + 1 :]
        mutant = "\n".join([*lines[:at], changed, *lines[at + 1 :]]) + "\n"
        _, other = roll_of(mutant)
        moved = float(np.abs((along_blocks(start, other, u) - right) * IN_MM).max())
        faster = max(was / now for (_, was), (_, now) in zip(blocks, other, strict=True))
        verdict = judged(mutant, member, machine)
        if moved > 0.02 or faster > 1.05:
            assert verdict != [], changed
            seen += 1
        elif moved < 2e-6 and faster < 1.005:
            assert verdict == [], changed
            passed += 1
    print(f"\nhobbed {member}: {seen} seen, {passed} harmless, {len(places) - seen - passed} between")
    assert seen > 8
    assert passed >= len(last) > 1


def test_feeds_keep_speed_acceleration_and_jerk_of_all_axes():
    """By differences of the polynomials of the text, followed at the constant speed of the path that the time means."""
    limits = {"max_speed_per_min": 3000.0, "max_acceleration": 40.0, "max_jerk": 100.0}
    machine = counting(**limits)
    text = cutting_program(HOBBED, "gear", machine, "HOB", job("gear", 1e-3))
    start, blocks = roll_of(text)
    fine = along_blocks(start, blocks, np.linspace(0.0, 1.0, 2001))
    used = []
    for axes, (_, seconds) in zip(fine, blocks, strict=True):
        path = np.r_[0.0, np.cumsum(np.linalg.norm(np.diff(axes, axis=0), axis=1))]  # a degree counts as a mm
        even = np.interp(np.linspace(0.0, path[-1], 201), path, np.arange(len(axes)))
        turning = np.stack([np.interp(even, np.arange(len(axes)), axes[:, k]) for k in (3, 5)], axis=1)
        used.append(np.abs(np.diff(turning, axis=0)).max(axis=0) / (seconds / 200))
    used = np.array(used)
    assert (used <= 3000.0 / 60 * 1.001).all()
    assert used.max() > 0.97 * 3000.0 / 60
    path = execute(text, "HOB", Setup.of(machine))
    runs = runs_of(path, HOBBED.member("gear"), machine, None)
    assert not [*motion_faults(path, runs, HOBBED.member("gear"), machine, Stated.of(text))]
    done = trajectory(path, machine)
    assert done.polynomial_blocks == len(blocks) - 1
    assert done.feed_seconds == pytest.approx(sum(seconds for _, seconds in blocks), rel=0.05)


@pytest.mark.parametrize(("modulo", "values"), [("A", 18), ("C", 18), ("AC", 18), ("", 17)])
def test_a_machine_that_may_not_take_it_is_refused_with_the_keys_to_change(modulo, values):
    machine = counting(values)
    if modulo:
        axes = machine.axes.model_copy(update={axis: getattr(MODULO.axes, axis) for axis in modulo})
        machine = machine.model_copy(update={"axes": axes})
        turning, keys = " and ".join(modulo), " and ".join(rf"axes\.{axis}" for axis in modulo)
        wanted = (
            rf"block of face hobbing turns {turning} through .* modulo = false and travel in {keys}; vertical_5axis_c"
        )
    else:
        wanted = r"^control\.polynomial_values = 17 of .*: cubic blocks of 6 axes have 18 values"
    with pytest.raises(InputError, match=wanted):
        cutting_plan(HOBBED, "gear", machine, job("gear"))


def test_reader_does_not_guess_what_a_modulo_axis_makes_of_turns_in_po():
    head = 'G17 G40 G90 G710 G94 G54\nT="GEAR" D1\nM6\nSPOS=0\nFGROUP(X,Y,Z,A,B,C)\nG0 X0 Y0 Z0 A=DC(0) B0 C=DC(10)\n'
    for word, taken in (("PO[A]=(359.9,1)", True), ("PO[A]=(360,1)", False), ("PO[C]=(3700,1)", False)):
        text = f"{head}G93 POLY {word} F1\nM30\n"
        if taken:
            assert np.degrees(execute(text, "P").axes[-1, 3]) == pytest.approx(359.9)
            continue
        with pytest.raises(InputError, match=r"line 7, column 10: .*: whether PO of a modulo axis takes it there is"):
            execute(text, "P")


def test_c_must_stand_in_fgroup():
    text = text_of("gear").replace("FGROUP(X,Y,Z,A,B,C)", "FGROUP(X,Y,Z,A,B)")
    with pytest.raises(InputError, match=r"PO\[C\]=.* while FGROUP leaves C out: what it follows depends on"):
        execute(text, "HOB", Setup.of(MACHINES[3]))
