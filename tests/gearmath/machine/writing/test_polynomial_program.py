"""Programs of polynomial blocks: read from their text by words typed here, run by the cone of the witness."""

import math
import re
from collections import Counter
from dataclasses import replace
from functools import lru_cache

import numpy as np
import pytest

from gearmath.bevel.flank import blank_grid
from gearmath.bevel.tooth import SHARP_EDGE, tooth_space
from gearmath.errors import InputError
from gearmath.machine.control.executor import execute
from gearmath.machine.control.polynomial import CHORD
from gearmath.machine.control.state import Setup
from gearmath.machine.judging.cut import as_cut, beside_the_path, metal_left
from gearmath.machine.judging.motion import motion_faults
from gearmath.machine.judging.program import faults_of
from gearmath.machine.judging.stated import Stated
from gearmath.machine.milling.run import runs_of
from gearmath.machine.planning.cut_plan import CuttingJob, cutting_plan
from gearmath.machine.planning.path import axis_positions, flank_points
from gearmath.machine.writing.cutting import cutting_program
from gearmath.specs.bevel_set import SIDES, load_bevel_set
from gearmath.specs.milling_machine import load_milling_machine
from gearmath.specs.toml import bundled
from tests.gearmath.machine.writing.polynomial_text import WORD, along_blocks, written_again, written_in

MACHINE = load_milling_machine(bundled("vertical_5axis.toml"))
QUINTIC = MACHINE.model_copy(update={"control": MACHINE.control.model_copy(update={"polynomial_values": 25})})
MACHINES = {3: MACHINE, 5: QUINTIC}
SETS = ("nasa_tp3096_12x36", "spiral_7x43", "crown_gear_universal_14x39")
ROLLING = [(name, member) for name in SETS for member in ("pinion", "gear")]


@lru_cache
def text_of(name, member, tolerance=1e-4, degree=3):
    return made(name, member, MACHINES[degree], CuttingJob((0,), tolerance, blocks="poly"))


def made(name, member, machine, job):
    return cutting_program(load_bevel_set(bundled(f"{name}.toml")), member, machine, "POLY_CUT", job)


def rolls(text):
    """Each roll of a text: its start X Y Z A B, and for every block the values of PO by axis, and its time.

    POLY and G93 stay in force; where POLY is not, only the ends of PO count.
    """
    found, now, inverse, bent = [], {}, False, False
    for line in text.splitlines():
        if line.startswith(";"):
            continue
        words = set(line.split())
        inverse = (inverse or "G93" in words) and "G94" not in words
        bent = (bent or "POLY" in words) and not words & {"G0", "G1"}
        if WORD.search(line):
            written = written_in(line)
            written = written if bent else {axis: values[:1] for axis, values in written.items()}
            feed, (start, blocks) = float(re.search(r" F([0-9.]+)", line)[1]), found[-1]
            way = 1.0 if inverse else way_of_last(start, [*blocks, (written, 0.0)])
            blocks.append((written, 60.0 * way / feed))
            continue
        for axis, value in re.findall(r"\b([XYZAB])(?:=DC\()?(-?[0-9.]+)", line):
            now[axis] = float(value)
        if "G94 G1 Z" in line:
            found.append((np.array([now[axis] for axis in "XYZAB"]), []))
    return [(start, blocks) for start, blocks in found if blocks]


def way_of_last(start, blocks):
    """How long [mm] the last block of a roll is, to a feed in mm/min: a degree counts as 1 mm."""
    way = positions_of(start, blocks, np.linspace(0.0, 1.0, 201))[-201:] * [1, 1, 1, 180 / math.pi, 180 / math.pi]
    return float(np.linalg.norm(np.diff(way, axis=0), axis=1).sum())


def positions_of(start, blocks, u):
    """Positions (n,5) in mm and rad along the blocks of a roll, at parameters u (k,) of each: x0 + a1 u + a2 u^2 .."""
    return np.concatenate(along_blocks(start, blocks, u)) * np.array([1, 1, 1, math.pi / 180, math.pi / 180])


def judged(text, name, member, machine=MACHINE):
    """What ``mill`` says of a text: sentences, or the one that refuses it."""
    spec = load_bevel_set(bundled(f"{name}.toml")).member(member)
    space = tooth_space(spec, 7)
    try:
        path = execute(text, "CUT", Setup.of(machine))
        runs = runs_of(path, spec, machine, None, space, SHARP_EDGE)
        found = [str(one) for one in faults_of(text, path, runs, spec, machine)]
        left = metal_left(runs, as_cut(spec, space), machine, Stated.of(text), space)
    except InputError as error:
        return [str(error)]
    return found + [str(one) for one in left.faults]


@pytest.mark.parametrize(("name", "member"), ROLLING)
def test_six_cubic_blocks_are_enough_for_a_roll_and_twelve_for_a_tenth(name, member):
    for tolerance, most in ((1e-4, 6), (1e-5, 12)):
        for _, blocks in rolls(text_of(name, member, tolerance)):
            assert 1 <= len(blocks) <= most


@pytest.mark.parametrize(("name", "member", "degree"), [(*ROLLING[0], 3), (*ROLLING[5], 3), (*ROLLING[4], 5)])
def test_the_text_cuts_the_flanks_within_its_tolerance(name, member, degree, witness):
    """The smallest distance of entry along normals over all poses of the text, by cone and machine of the witness."""
    text = text_of(name, member, degree=degree)
    spec, height = load_bevel_set(bundled(f"{name}.toml")).member(member), MACHINE.pivot_height
    stated = float(re.search(r"flank tolerance: ([0-9.]+) um", text)[1]) / 1000
    flanks = ["concave", "convex"] if spec.cutting != "completing" else [("concave", "convex")]
    passes = rolls(text)
    assert len(passes) == len(flanks)
    for (start, blocks), cut in zip(passes, flanks, strict=True):
        axes = positions_of(start, blocks, np.linspace(0, 1, 1500))
        pose = witness.vertical_pose(axes, height)
        for flank in [cut] if isinstance(cut, str) else cut:
            one, points = spec.flank(flank), flank_points(spec, flank, blank_grid(spec, 5, 17, 0.05))
            cone = one.blade_point_radius, math.radians(one.blade_pressure_angle), SIDES[flank]
            flat = points.contact[:, 0] > 0.1  # below is the fillet, which the edge of the blade cuts
            t = witness.entry(*pose, *cone, points.point[flat, None], points.normal[flat, None])
            left = t.min(axis=1)
            assert np.abs(left).max() <= stated + 2e-6  # mm: poses so far apart leave as much


def test_every_axis_is_a_function_of_one_parameter_that_the_reader_follows():
    """The rows of the reader lie on the polynomials of the text, their chords nowhere off by more than it says."""
    text = text_of(*ROLLING[5])
    path = execute(text, "CUT", Setup.of(MACHINE))
    (start, blocks) = rolls(text)[0]
    curve = np.flatnonzero(path.inner)
    first, last = curve[0], curve[-1] + 1
    rows = path.axes[first - 1 : last + 1]
    dense = positions_of(start, blocks, np.linspace(0, 1, 4001))
    dense[:, 3] += 2 * np.pi * np.round((rows[0, 3] - dense[0, 3]) / (2 * np.pi))
    scale = np.array([1.0, 1.0, 1.0, 100.0, 100.0])  # mm at 100 mm from an axis
    progress = np.r_[0.0, np.cumsum(np.linalg.norm(np.diff(rows * scale, axis=0), axis=1))]
    own = np.r_[0.0, np.cumsum(np.linalg.norm(np.diff(dense * scale, axis=0), axis=1))]
    own *= progress[-1] / own[-1]
    for axis in range(5):
        off = np.interp(own, progress, rows[:, axis]) - dense[:, axis]
        assert np.abs(off * scale[axis]).max() < 5 * CHORD
    assert path.seconds[first : last + 1].sum() == pytest.approx(sum(seconds for _, seconds in blocks), rel=1e-9)


@pytest.mark.parametrize("degree", [3, 5])
def test_what_is_read_is_written_again_byte_for_byte(degree):
    text = text_of(*ROLLING[4], degree=degree)
    found = list(written_again(text, "CUT", MACHINE, 5, degree))
    assert len(found) == text.count("G93 POLY ")
    for words, line in found:
        assert words in line


@pytest.mark.parametrize("degree", [3, 5])
def test_without_its_word_poly_the_control_drives_straight_and_mill_sees_it(degree):
    name, member = ROLLING[0]
    text = text_of(name, member, degree=degree)
    assert judged(text, name, member, MACHINES[degree]) == []
    straight = text.replace("G93 POLY ", "G93 G1 ")
    path = execute(straight, "CUT", Setup.of(MACHINES[degree]))
    assert not path.inner.any()
    assert any("leaves" in sentence for sentence in judged(straight, name, member, MACHINES[degree]))


def test_a_tenth_of_the_tolerance_is_kept_and_passes():
    name, member = ROLLING[0]
    assert judged(text_of(name, member, 1e-5), name, member) == []


def test_one_block_without_its_word_is_seen_too():
    name, member = ROLLING[0]
    text = text_of(name, member)
    for k in (0, text.count("G93 POLY ") - 1):
        parts = text.split("G93 POLY ")
        changed = "G93 POLY ".join(parts[: k + 1]) + "G93 G1 " + "G93 POLY ".join(parts[k + 1 :])
        assert judged(changed, name, member) != []


@pytest.mark.slow
def test_wrong_digits_that_move_the_tool_are_seen_and_those_that_do_not_pass():
    """The first and last digits of the numbers of a block, changed."""
    name, member = ROLLING[0]
    text = text_of(name, member)
    lines = text.splitlines()
    at = next(k for k, line in enumerate(lines) if "G93 POLY " in line)
    (start, blocks) = rolls(text)[0]
    u, scale = np.linspace(0, 1, 101), np.array([1.0, 1.0, 1.0, 60.0, 60.0])
    right = positions_of(start, blocks, u)
    numbers = list(re.finditer(r"(?<=[(,F])-?([0-9]+)\.[0-9]+", lines[at]))
    leading = [one.start(1) for one in numbers if one.start() > 16][::2]  # X, a3 of X, a2 of Y, Z, B
    last = [m.start() - 1 for m in re.finditer(r"\)", lines[at])][:2]  # of coefficients of X and Y
    rng = np.random.default_rng(17)
    seen, passed = 0, 0
    for place in [*leading, *last]:
        digit = str((int(lines[at][place]) + rng.integers(1, 9)) % 10)
        changed = lines[at][:place] + digit + lines[at][place + 1 :]
        mutant = "\n".join([*lines[:at], changed, *lines[at + 1 :]]) + "\n"
        (_, other) = rolls(mutant)[0]
        moved = float(np.abs((positions_of(start, other, u) - right) * scale).max())
        slower = abs(other[0][1] / blocks[0][1] - 1.0)
        verdict = judged(mutant, name, member)
        if moved > 0.01 or (other[0][1] < blocks[0][1] and slower > 0.05):
            assert verdict != [], changed
            seen += 1
        elif moved < 2e-6 and slower < 0.005:
            assert verdict == [], changed
            passed += 1
    assert (seen, passed) == (len(leading), len(last))


def test_feeds_keep_speed_acceleration_and_jerk_of_every_axis():
    """By differences of the polynomials of the text, followed at a constant speed of the path."""
    slow = {"A": 900.0, "B": 900.0}
    axes = MACHINE.axes.model_copy(
        update={
            axis: getattr(MACHINE.axes, axis).model_copy(
                update={"max_acceleration": 60.0, "max_jerk": 300.0} | ({"max_speed_per_min": slow.get(axis, 4000.0)})
            )
            for axis in "XYZAB"
        }
    )
    machine = MACHINE.model_copy(update={"axes": axes, "max_feed_per_min": None})
    text = made(*ROLLING[5], machine, CuttingJob((0,), feed=20000.0, blocks="poly"))
    per_internal = np.array([1, 1, 1, 180 / math.pi, 180 / math.pi])
    used = []
    for start, blocks in rolls(text):
        here = start
        for block in blocks:
            fine = positions_of(here, [block], np.linspace(0, 1, 4001)) * per_internal  # 1 degree counts as 1 mm
            along = np.r_[0.0, np.cumsum(np.linalg.norm(np.diff(fine, axis=0), axis=1))]
            time = along / along[-1] * block[1]
            even = np.linspace(0, time[-1], 401)
            step = even[1]
            at = np.stack([np.interp(even, time, column) for column in fine.T], axis=1)
            at = np.stack([np.polynomial.Polynomial.fit(even, column, 9)(even) for column in at.T], axis=1)
            rates = [np.abs(np.diff(at, k, axis=0)).max(axis=0) / step**k for k in (1, 2, 3)]
            limits = [np.array([machine_axis.max_speed_per_min / 60 for machine_axis in vars_of(axes)]), 60.0, 300.0]
            used.append([float((rate / limit).max()) for rate, limit in zip(rates, limits, strict=True)])
            here = np.array([block[0][axis][0] for axis in "XYZAB"])
    used = np.array(used)
    assert (used <= 1.01).all()
    assert (used.max(axis=1) > 0.9).all()  # every block reaches one of them


def vars_of(axes):
    return [getattr(axes, axis) for axis in "XYZAB"]


def test_formate_has_no_roll_and_stays_as_it_is():
    plain = CuttingJob((0,))
    formate = load_bevel_set(bundled("crown_gear_formate_14x39.toml"))
    one, other = (
        cutting_program(formate, "gear", MACHINE, "CUT", job) for job in (plain, replace(plain, blocks="poly"))
    )
    assert one == other


def test_what_cannot_be_is_refused_in_a_sentence():
    bevel_set, few = load_bevel_set(bundled("nasa_tp3096_12x36.toml")), {"polynomial_values": 14}
    machine = MACHINE.model_copy(update={"control": MACHINE.control.model_copy(update=few)})
    job = CuttingJob((0,), blocks="poly")
    with pytest.raises(InputError, match=r"^control\.polynomial_values = 14 of .*: cubic blocks of 5 axes have 15"):
        cutting_plan(bevel_set, "pinion", machine, job)


def test_an_axis_that_fgroup_leaves_out_is_refused():
    text = text_of(*ROLLING[0])
    with pytest.raises(InputError, match=r"A=?.* while FGROUP leaves A out: what it follows depends on UPATH or SPATH"):
        execute(text.replace("FGROUP(X,Y,Z,A,B)", "FGROUP(X,Y,Z)"), "CUT", Setup.of(MACHINE))


@pytest.mark.parametrize("degree", [3, 5])
def test_a_pass_in_straight_parts_is_the_exact_path_at_every_cradle_angle(degree):
    """Chip loads are taken from these: the way past the blades within a block is that of the exact path."""
    bevel_set = load_bevel_set(bundled("crown_gear_universal_14x39.toml"))
    plan = cutting_plan(bevel_set, "pinion", MACHINES[degree], CuttingJob((0,), blocks="poly"))
    for one in plan.passes:
        fine, spec = one.in_straight_parts(), plan.member.flank(one.tool.partition("_")[2].lower())
        exact = axis_positions(spec, fine.theta, MACHINE.pivot_height, MACHINE.pivot)
        off = fine.axes - exact
        off[:, 3] -= 2 * math.pi * np.round(off[:, 3] / (2 * math.pi))
        assert np.abs(off).max() < 2e-3  # mm and rad: the flank, along its normal, keeps 1e-4
        assert fine.seconds.sum() == pytest.approx(one.seconds.sum())


# ------------------------------------------------------------------------------- programs with one thing wrong in them
#: Mutants of every program, and how far apart the poses of a block are. [mm]
SAMPLED, APART = 45, 0.06


def mutants(lines):
    """Polynomial blocks with one thing wrong, in every way: kind, line from 0, and the lines in its place."""
    for k, line in enumerate(lines):
        if "G93 POLY " not in line:
            continue
        yield "removed block", k, []
        yield "doubled block", k, [line, line]
        words = line.split(" ")
        for j in range(1, len(words)):
            yield "removed word", k, [" ".join(words[:j] + words[j + 1 :])]
        for one in re.finditer(r",-?[0-9.]+(?=\))", line):
            yield "removed coefficient", k, [line[: one.start()] + line[one.end() :]]
        for one in re.finditer(r"(?<=[=(,F])(-?)([0-9.]+)", line[line.index("POLY") :]):
            start, kind = (
                one.start() + line.index("POLY"),
                "F" if line[one.start() + line.index("POLY") - 1] == "F" else "PO",
            )
            if kind == "PO":
                yield "sign", k, [line[:start] + ("" if one[1] else "-") + line[start + len(one[1]) :]]
            for at in range(start + len(one[1]), start + len(one[0])):
                for digit in "0123456789" if line[at].isdecimal() else "":
                    if digit != line[at]:
                        yield f"{kind} digit", k, [line[:at] + digit + line[at + 1 :]]


class RightProgram:
    """What a right program of one space leaves, and what harm another one does, by the cone and the machine of the
    witness."""

    def __init__(self, name, member, degree, witness):
        self.text, self.witness = text_of(name, member, degree=degree), witness
        self.spec = load_bevel_set(bundled(f"{name}.toml")).member(member)
        self.limit = 1.1 * float(re.search(r"flank tolerance: ([0-9.]+) um", self.text)[1]) / 1000
        self.known = {}
        self.cuts = ["concave", "convex"] if self.spec.cutting != "completing" else [("concave", "convex")]
        flanks = [(cut,) if isinstance(cut, str) else cut for cut in self.cuts]
        self.points = {flank: self._points(flank) for some in flanks for flank in some}
        self.flanks = flanks
        assert self.harm(self.text) is None

    def _points(self, flank):
        points = flank_points(self.spec, flank, blank_grid(self.spec, 5, 17, 0.05))
        flat = points.contact[:, 0] > 0.1  # below is the fillet, which the edge of the blade cuts
        return points.point[flat, None], points.normal[flat, None]

    def harm(self, text):
        """What is wrong with a text, or None; what cannot be read is wrong."""
        try:
            # a block that is there twice goes out and back to its end: what that cuts is asked like the rest
            for (start, blocks), flanks in zip(rolls(text), self.flanks, strict=True):
                every = self.poses(start, blocks)
                for axes, (_, seconds) in zip(every, blocks, strict=True):
                    if found := self.too_fast(axes, seconds):
                        return found
                for flank in flanks:
                    left = np.min([self.left(flank, axes) for axes in every], axis=0)
                    if not np.abs(left).max() <= self.limit:
                        return f"{flank} {left.min():.6f} to {left.max():.6f}"
        except (KeyError, ValueError, IndexError, TypeError, ZeroDivisionError) as error:
            return f"unreadable: {error!r}"
        return None

    def poses(self, start, blocks):
        """Positions along every block of a roll: poses far apart leave scallops of their own."""
        ends = positions_of(start, blocks, np.linspace(0.0, 1.0, 50)).reshape(len(blocks), 50, 5)
        ways = np.linalg.norm(np.diff(ends[..., :3], axis=1), axis=2).sum(axis=1)
        counts = np.clip(ways / APART, 20, 3000).astype(int)
        return [
            positions_of(start, blocks[: k + 1], np.linspace(0.0, 1.0, count))[-count:]
            for k, count in enumerate(counts)
        ]

    def too_fast(self, axes, seconds):
        """Axes over their limits, and the cutter past the middle of the tooth, on average over a block."""
        way = np.abs(np.diff(axes, axis=0)).sum(axis=0)
        if (way / seconds > 1.1 * MACHINE.max_speed).any():
            return "speed"
        middle = next(iter(self.points.values()))[0]
        x, y, z = middle[len(middle) // 2, 0]
        a, b = axes[:, 3], axes[:, 4]
        px, py = np.cos(a) * x + np.sin(a) * y, np.cos(a) * y - np.sin(a) * x
        seen = np.stack([-np.sin(b) * px - np.cos(b) * z, py, np.cos(b) * px - np.sin(b) * z], axis=1) - axes[:, :3]
        feed = 60.0 * np.linalg.norm(np.diff(seen, axis=0), axis=1).sum() / seconds
        return "feed" if feed > 1.1 * 300.0 else None

    def left(self, flank, axes):
        """What the poses of one block leave on lines of a flank; those of right blocks are kept."""
        key = flank, axes.tobytes()
        if key not in self.known:
            one = self.spec.flank(flank)
            cone = one.blade_point_radius, math.radians(one.blade_pressure_angle), SIDES[flank]
            pose = self.witness.vertical_pose(axes, MACHINE.pivot_height)
            self.known[key] = self.witness.entry(*pose, *cone, *self.points[flank]).min(axis=1)
        return self.known[key]


@pytest.mark.slow
@pytest.mark.parametrize(("name", "member", "degree"), [(*ROLLING[1], 3), (*ROLLING[4], 5)])
def test_no_wrong_word_of_a_polynomial_program_is_left_unseen(name, member, degree, witness):
    right, random = RightProgram(name, member, degree, witness), np.random.default_rng(17)
    lines = right.text.split("\n")
    found = list(mutants(lines))
    chosen = [found[k] for k in np.sort(random.choice(len(found), SAMPLED, replace=False))]
    count, unseen = polynomial_trial(right, lines, chosen, name, member, MACHINES[degree])
    kinds = sorted({kind for kind, _ in count})
    print(
        f"\n{name} {member}: {len(chosen)} of {len(found)} mutants, {len(unseen)} unseen; refused or seen + harmless:"
    )
    print("; ".join(f"{kind} {count[kind, 'seen']} + {count[kind, 'harmless']}" for kind in kinds))
    assert unseen == []
    assert sum(count[kind, "seen"] for kind in kinds) > SAMPLED / 3


def polynomial_trial(right, lines, chosen, name, member, machine):
    """How many mutants are refused or seen and how many do no harm, by kind, and those that nobody sees."""
    count, unseen = Counter(), []
    for kind, k, new in chosen:
        text = "\n".join([*lines[:k], *new, *lines[k + 1 :]])
        if (harm := right.harm(text)) is None:
            count[kind, "harmless"] += 1
        elif seen(text, name, member, machine):
            count[kind, "seen"] += 1
        else:
            unseen.append((kind, harm, lines[k], *new))
    return count, unseen


def seen(text, name, member, machine):
    """Whether mill refuses a text, by its cheapest checks first."""
    spec = load_bevel_set(bundled(f"{name}.toml")).member(member)
    try:
        path = execute(text, "CUT", Setup.of(machine))
        runs = runs_of(path, spec, machine, None, tooth_space(spec, 7), SHARP_EDGE)
        stated = Stated.of(text)
        first = [*motion_faults(path, runs, spec, machine, stated), *beside_the_path(runs, spec, machine, stated)]
    except InputError:
        return True
    return bool(first) or bool(judged(text, name, member, machine))
