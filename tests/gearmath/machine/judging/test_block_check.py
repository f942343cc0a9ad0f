"""A wrong digit in a program: every digit of every axis word of every cutting block of whole programs, all values.

What a mutation does is found by what has to be found anew: the real reader and the real control run the changed block
and the next one from the state before it, and only these two are milled again.
"""

from __future__ import annotations

import copy
import re
from dataclasses import replace

import numpy as np
import pytest

from gearmath.bevel.flank import blank_grid
from gearmath.bevel.tooth import SHARP_EDGE, tooth_space
from gearmath.errors import InputError
from gearmath.machine.control.blocks import ControlState
from gearmath.machine.control.executor import execute
from gearmath.machine.control.reader import read_program
from gearmath.machine.control.tree import Block, Branch
from gearmath.machine.judging.block_check import watch
from gearmath.machine.judging.collision import rapid_approaches
from gearmath.machine.judging.cut import beside_limit, beside_the_path, distances_aside, off_the_path
from gearmath.machine.judging.stated import Stated, stated_tolerance
from gearmath.machine.judging.watched_lines import watched_flanks
from gearmath.machine.milling.mill import expose
from gearmath.machine.milling.removal import entry_along_block
from gearmath.machine.milling.run import runs_of
from gearmath.machine.planning.blocks import roll_nodes
from gearmath.machine.planning.cut_plan import CuttingJob
from gearmath.machine.planning.path import Cut, flank_points
from gearmath.machine.planning.rounding import control_share
from gearmath.machine.writing.cutting import cutting_program
from gearmath.specs.bevel_set import load_bevel_set
from gearmath.specs.toml import bundled

TOLERANCE = 1e-4
SAMPLES = np.linspace(0.0, 1.0, 9)
#: Lines this many blocks away on either side are looked at.
NEAR = 2.5


def number(node, column):
    return node.value


def snapshot(control):
    """The control as it stands, to go on from twice."""
    kept = copy.copy(control)
    kept.modal, kept.position, kept.shift = dict(control.modal), dict(control.position), dict(control.shift)
    return kept


def mutations(line):
    """The line with one digit of one axis word changed, for every digit and every other value of it."""
    for word in re.finditer(r"(?:[XYZB]|A=DC\()(-?[0-9.]+)", line):
        for at in range(word.start(1), word.end(1)):
            for digit in "0123456789" if line[at].isdecimal() else "":
                if digit != line[at]:
                    yield line[:at] + digit + line[at + 1 :]


def rigid_moves(witness, before, after, point, normal, height):
    """How far the tool, as a rigid body, takes points (p,3) along their normals: (m,p), from one pose to others (m,5).

    By the machine of the witness: the cutter's centre moves, and its axis turns the short way.
    """
    (c0, k0), (c1, k1) = witness.vertical_pose(before, height), witness.vertical_pose(after, height)
    turn = np.cross(np.broadcast_to(k0, k1.shape), k1)
    arm = point[None] - c0
    moved = (c1 - c0)[:, None] + np.cross(turn[:, None], arm)
    return np.einsum("mpk,pk->mp", moved, normal)


@pytest.mark.slow
@pytest.mark.parametrize(("member", "index"), [("pinion", 0), ("pinion", 1), ("gear", 0)])
def test_every_wrong_digit_is_refused_or_seen(gear_set, vertical, witness, host_compiler, member, index):
    """Demanded: the tool moves by more than 1 um along a normal where it touches the flank at the end of the block.

    The contacts are 80 x 321 points over the whole flank, those within a tenth of a block of the node. Seen: a line
    that ``gearmath mill`` watches is left outside of the 0.1 um that the program states, or, where the blocks before
    and after it cut the flank clean, the block ends farther beside its path than ``mill`` lets it.
    """
    spec, height = gear_set.member(member), vertical.pivot_height
    cut = Cut.of(spec)[index]
    text = cutting_program(gear_set, member, vertical, "CUT", CuttingJob((0,), TOLERANCE))
    path = execute(text, "CUT")
    runs = runs_of(path, spec, vertical, None, tooth_space(spec, 7))
    run = runs[index]
    rounding = control_share(spec, vertical).rounding
    theta = roll_nodes(spec, cut, TOLERANCE, height, rounding=rounding)
    lines, limit = text.split("\n"), beside_limit(vertical, Stated.of(text))
    cutting = [k for k in run.line.tolist() if " G93 " in lines[k - 1]]
    nodes = np.vstack([run.axes[run.line == k] for k in [cutting[0] - 1, *cutting]])
    assert len(nodes) == len(theta)

    flanks = [one for one in watched_flanks(spec, runs, vertical) if one.flank in cut.flanks]
    point, normal, start, at = (
        np.concatenate([getattr(one, part) for one in flanks]) for part in ("point", "normal", "start", "theta")
    )
    contacts = [flank_points(spec, flank, blank_grid(spec, 80, 321, 0.0)) for flank in cut.flanks]
    touch = np.concatenate([one.contact[:, 2] for one in contacts])
    touched, outward = (np.concatenate([getattr(one, part) for one in contacts]) for part in ("point", "normal"))

    entry, body = entry_along_block(True), run.cutter.bodies[0]

    def left(first, last, which):
        """What blocks (b,5) to (b,5) leave on lines (w,): (b, w), the smallest of some samples."""
        b, w = len(first), len(which)
        k, j, s = (part.ravel() for part in np.meshgrid(np.arange(b), which, SAMPLES, indexing="ij"))
        (found,) = entry(
            first[k],
            last[k],
            s,
            height,
            vertical.pivot,
            0.0,
            point[j],
            normal[j],
            start[j],
            body.annulus,
            body.outer.vector,
            body.inner.vector,
        )
        return found.reshape(b, w, len(SAMPLES)).min(axis=2)

    program = read_program(text, "CUT")
    control, states = ControlState("CUT"), {}
    for block in blocks_of(program.body):
        if block.line in cutting:
            states[block.line] = snapshot(control), block
        control.run(block, number)
    demanded = refused = cleaned = 0
    unseen = []
    for n, line in enumerate(cutting, start=1):
        following = states[cutting[n]][1] if n < len(cutting) else None
        axes, texts = [], []
        for changed in mutations(lines[line - 1]):
            try:
                (block,) = read_program(changed, "CUT").body
                state = snapshot(states[line][0])
                row = state.run(block, number)
                after = state.run(following, number) if following is not None else None
            except InputError:
                refused += 1
                continue
            end = nodes[n + 1] * [1, 1, 1, 180 / np.pi, 180 / np.pi] if after is None and following else None
            axes.append((row.position, after.position if after is not None else row.position if end is None else end))
            texts.append(changed)
        poses = np.array(axes)
        poses[..., 3:] = np.radians(poses[..., 3:])
        width = np.minimum(theta[n] - theta[n - 1], theta[min(n + 1, len(theta) - 1)] - theta[n] or np.inf)
        here = np.abs(touch - theta[n]) < 0.1 * width
        if not here.any():
            continue
        moved = np.abs(rigid_moves(witness, nodes[n], poses[:, 0], touched[here], outward[here], height)).max(axis=1)
        wanted = moved > 1e-3
        demanded += int(wanted.sum())
        span = np.median(np.diff(theta))
        which = np.flatnonzero(np.abs(at - theta[n]) < NEAR * span)
        others = [k for k in range(1, len(nodes)) if k not in (n, n + 1) and abs(k - n) < 6]
        rest = left(nodes[[k - 1 for k in others]], nodes[others], which).min(axis=0)
        before = np.broadcast_to(nodes[n - 1], poses[:, 0].shape)
        again = left(before, poses[:, 0], which)
        if following is not None:
            again = np.minimum(again, left(poses[:, 0], poses[:, 1], which))
        deviation = np.abs(np.minimum(rest, again)).max(axis=1)
        rest = np.flatnonzero(wanted & ~(deviation > TOLERANCE))
        cleaned += len(rest)
        far = aside(run, int(np.flatnonzero(run.line == line)[0]), poses[rest, 0], spec, vertical)
        unseen += [texts[k] for k, aside_by in zip(rest, far, strict=True) if aside_by <= limit]
        if n % 40 == 20:
            check_in_full(gear_set, spec, vertical, text, line, texts, deviation, wanted)
    print(f"\n{cut.tool}: {demanded} demanded, {refused} refused, {cleaned} not in metal, {len(unseen)} unseen")
    assert demanded > 10_000
    assert refused > 100
    assert unseen == []


def aside(run, row, poses, spec, machine):
    """How far beside its path ``mill`` takes a block to end that ends at ``poses`` (m,5), in the place of a row."""
    rows, off = off_the_path(run, spec, machine)
    middle = np.median(off[1:-1, 2])  # between plunge and last block
    again = np.full(len(poses), row)
    tried = replace(run, axes=poses, cutting=run.cutting[again], space=run.space[again], line=run.line[again])
    rolls = rows[1] <= row < rows[-1]
    _, off = off_the_path(tried, spec, machine)
    return distances_aside(off, np.full(len(poses), middle if rolls else np.nan))


def blocks_of(body):
    """The blocks that act where nothing stops the program, sections included: no branch that ends or halts it."""
    for part in body:
        if isinstance(part, Block):
            yield part
        elif isinstance(part, Branch):
            inside = list(blocks_of(part.then))
            if not any({"program end", "program stop"} & set(block.words) for block in inside):
                yield from inside


def check_in_full(gear_set, spec, vertical, text, line, texts, deviation, wanted):
    """The first demanded mutation of a block through reader, executor and the watch of ``gearmath mill``: the same."""
    lines = text.split("\n")
    k = int(np.flatnonzero(wanted)[len(texts) // 3 % wanted.sum()])
    lines[line - 1] = texts[k]
    path = execute("\n".join(lines), "CUT")
    runs = runs_of(path, spec, vertical, None, tooth_space(spec, 7), SHARP_EDGE)
    found = watch(runs, spec, vertical, None)
    beside = [fault.line for fault in beside_the_path(runs, spec, vertical, Stated.of(text))]
    assert abs(found.worst[0]) > TOLERANCE or line in beside, texts[k]
    if deviation[k] < 5e-3:
        assert abs(found.worst[0]) >= deviation[k] - 3e-6  # mm: the samples, and blades that are not quite sharp


@pytest.mark.parametrize("member", ["pinion", "gear"])
def test_right_program_leaves_no_more_than_it_states_and_stays_on_its_path(gear_set, vertical, host_compiler, member):
    spec = gear_set.member(member)
    text = cutting_program(gear_set, member, vertical, "CUT", CuttingJob((0, 2)))
    assert stated_tolerance(text) == TOLERANCE
    runs = runs_of(execute(text, "CUT"), spec, vertical, None, tooth_space(spec, 7), SHARP_EDGE)
    found = watch(runs, spec, vertical, None)
    assert found.uncut == 0
    assert -TOLERANCE <= found.lowest <= found.highest <= TOLERANCE
    assert found.lines > 2 * text.count("G93") / 2
    for run in runs:
        _, off = off_the_path(run, spec, vertical)
        # five printed decimals of X Y Z; A and B have six of a degree, and A goes with the cradle that X and Y say
        one, reach = spec.flank(run.cut.flanks[0]), spec.blank.mean_cone_distance + spec.blank.face_width / 2
        cradle = 0.5e-5 * np.sqrt(2) / one.radial_distance
        most = 1.5e-5 + one.ratio_of_roll * cradle * reach + 2 * np.radians(0.5e-6) * reach
        assert most < 5e-5
        assert distances_aside(off, np.full(len(off), np.nan)).max() < most


@pytest.mark.parametrize(("axis", "off"), [(2, 2e-3), (2, -2e-3), (3, 2e-5), (4, -2e-5)])
def test_block_that_ends_beside_its_path_is_named_with_what_it_is_off_by(gear_set, vertical, host_compiler, axis, off):
    """By hand: Z by 2 um, either way, or A or B by 20 urad at the heel."""
    spec, reach = gear_set.gear, gear_set.gear.blank.mean_cone_distance + gear_set.gear.blank.face_width / 2
    text = cutting_program(gear_set, "gear", vertical, "CUT", CuttingJob((0,)))
    (run,) = runs_of(execute(text, "CUT"), spec, vertical, None, tooth_space(spec, 7), SHARP_EDGE)
    axes, row = run.axes.copy(), len(run.axes) // 2
    axes[row, axis] += off
    (fault,) = beside_the_path([replace(run, axes=axes)], spec, vertical, Stated.of(text))
    assert fault.line == run.line[row]
    said = float(re.search(r"ends ([0-9.]+) mm beside the path", fault.what)[1])
    assert said == pytest.approx(abs(off) * (reach if axis > 2 else 1.0), abs=2e-5)


def test_no_corner_of_the_flank_is_left_out(gear_set, vertical, host_compiler):
    """A 0.2 arcsec off in one block after another gouges at the foot, at the toe, in between: a fine grid, which shares
    no line with the watch, finds nowhere a deeper place by more than a twentieth of the tolerance."""
    spec = gear_set.gear
    path = execute(cutting_program(gear_set, "gear", vertical, "CUT", CuttingJob((0,))), "CUT")
    (run,) = runs_of(path, spec, vertical, None, tooth_space(spec, 7), SHARP_EDGE)
    points = [flank_points(spec, flank, blank_grid(spec, 6, 161, 0.0)) for flank in ("concave", "convex")]
    kept = [one.contact[:, 0] >= 0.0 for one in points]  # below the blade's end there is no flank
    point = np.concatenate([one.point[k] for one, k in zip(points, kept, strict=True)])
    normal = np.concatenate([one.normal[k] for one, k in zip(points, kept, strict=True)])
    seen = []
    for row in np.flatnonzero(run.cutting)[3:-3:5]:
        axes = run.axes.copy()
        axes[row, 3] -= 1e-6
        runs = [replace(run, axes=axes)]
        fine = expose(runs, vertical, None, point, normal, np.full(len(point), -1.0))
        seen.append((watch(runs, spec, vertical).lowest, float(fine.distance.min())))
    lowest, deepest = np.array(seen).T
    assert len(seen) > 12
    assert (deepest < -1.05 * TOLERANCE).sum() > 3
    assert (lowest < deepest + 0.05 * TOLERANCE).all(), lowest - deepest


@pytest.mark.slow
def test_peak_that_a_wrong_end_leaves_between_two_blocks_is_not_missed(vertical, host_compiler):
    """Y off by 0.05 um, as one wrong digit, adds to what the straight blocks leave beside their middles: where a fine
    row along the tip or half way up finds metal, which shares no line with the watch, the watch finds it to 3 %."""
    bevel_set = load_bevel_set(bundled("crown_gear_universal_14x39.toml"))
    spec = bevel_set.pinion
    path = execute(cutting_program(bevel_set, "pinion", vertical, "CUT", CuttingJob((0,))), "CUT")
    runs = runs_of(path, spec, vertical, None, tooth_space(spec, 7), SHARP_EDGE)
    tip = flank_points(spec, "convex", blank_grid(spec, 3, 1601, 0.0))
    place = next(k for k, run in enumerate(runs) if "convex" in run.cut.flanks)
    run, rows = runs[place], slice(len(tip.point) // 3, None)  # the foot is left out
    given = tip.point[rows], tip.normal[rows], np.full(len(tip.point[rows]), -0.5)
    cuts, ratio = np.flatnonzero(run.cutting), []
    for row in cuts[len(cuts) // 4 : -len(cuts) // 4 : max(len(cuts) // 12, 1)]:
        axes = run.axes.copy()
        axes[row, 1] += 5e-5
        wrong = replace(run, axes=axes)
        fine = float(expose([wrong], vertical, None, *given).distance.max())
        ratio.append(watch([*runs[:place], wrong, *runs[place + 1 :]], spec, vertical).highest / fine)
    print(np.round(ratio, 3))
    assert len(ratio) > 4
    assert min(ratio) > 0.97


@pytest.mark.parametrize(
    ("right", "wrong"),
    [
        ("G94 G0 Z540.00000", "G94 G0 Z440.00000"),  # the retract of space 0 goes down
        ("G0 Z540.00000\n", "G0 Z500.00000\n"),  # the way to space 1 begins within the metal
        ("G94 G1 Z500.00000", "G94 G1 Z400.00000"),  # the plunge into space 1 is too deep
        ("G0 X-52.28712 Y50.42840", "G0 X-52.28712 Y50.40840"),  # and stands aside
        ("G0 X-52.28712 Y50.42840", "G0 X-52.08712 Y50.42840"),
        ("A=DC(26.060021)", "A=DC(26.160021)"),
        ("B67.683333\n", "B67.083333\n"),
    ],
)
def test_wrong_digit_of_approach_plunge_or_retract_is_seen(gear_set, vertical, host_compiler, right, wrong):
    """On the way from space 0 to space 1; rapid blocks through the metal too. More than 1 um is cut, or said."""
    spec = gear_set.gear
    text = cutting_program(gear_set, "gear", vertical, "CUT", CuttingJob((0, 1)))
    begin = text.index("G94 G0 Z")
    head, rest = text[:begin], text[begin:]
    assert right in rest
    path = execute(head + rest.replace(right, wrong, 1), "CUT")
    runs = runs_of(path, spec, vertical, None, tooth_space(spec, 7), SHARP_EDGE)
    beside = [*beside_the_path(runs, spec, vertical, Stated.of(text))]
    assert watch(runs, spec, vertical, None).lowest < -1e-3 or beside or rapid_approaches(runs, spec, vertical)


def test_program_that_leaves_stock_promises_nothing(gear_set, vertical):
    assert stated_tolerance(cutting_program(gear_set, "gear", vertical, "CUT", CuttingJob(finishing_stock=0.1))) is None
    assert stated_tolerance("M30") is None
