"""Whole programs with one thing wrong in them: each is refused, or seen, or shown to be harmless; none is left unseen.

What ``gearmath mill`` says is asked block by block: the real reader and control run a changed block and the next ones
from the state before it until all in force is as it was, and the checks of ``mill`` see these blocks among their
neighbors, as a test shows just as in the whole; whatever passes is given to ``mill`` whole if it does harm. What does
harm is said by the dense check below, which shares no code with ``mill``: it reads the words by itself, moves the
cutter by the machine of the witness, and asks in dense steps whether points a tolerance under the flanks are cut, and
whether points a tolerance above them are left.
"""

from __future__ import annotations

import copy
import itertools
import re
from collections import Counter
from dataclasses import dataclass, field, replace
from types import SimpleNamespace

import numpy as np
import pytest

from gearmath.bevel.flank import blank_grid
from gearmath.bevel.tooth import SHARP_EDGE, tooth_space
from gearmath.errors import InputError
from gearmath.machine.bodies.profiles import obstacles
from gearmath.machine.control import values as nc_values
from gearmath.machine.control.blocks import ControlState
from gearmath.machine.control.executor import MachinePath, execute
from gearmath.machine.control.reader import read_program
from gearmath.machine.control.state import Setup
from gearmath.machine.control.tree import Block, Branch, Command
from gearmath.machine.judging.collision import collisions, rapid_approaches
from gearmath.machine.judging.cut import beside_the_path, metal_left
from gearmath.machine.judging.motion import feeds, speeds, spindle, travel
from gearmath.machine.judging.program import faults_of
from gearmath.machine.judging.stated import Stated
from gearmath.machine.milling.run import runs_of
from gearmath.machine.planning.cut_plan import CuttingJob
from gearmath.machine.planning.path import Cut, flank_points
from gearmath.machine.writing.cutting import cutting_program
from gearmath.specs.bevel_set import SIDES, load_bevel_set
from gearmath.specs.milling_machine import load_milling_machine
from gearmath.specs.toml import bundled

MACHINE = load_milling_machine(bundled("vertical_5axis.toml"))
SETS = ("nasa_tp3096_12x36", "spiral_7x43", "crown_gear_universal_14x39", "crown_gear_formate_14x39")
CASES = [(name, member) for name in SETS for member in ("pinion", "gear")]
TOLERANCE, RPM, FEED, PLUNGE = 1e-4, 120.0, 300.0, 200.0
#: Spaces of the programs in CI, and mutants of each of them: blocks, wrong digits in each of them, and everything else.
SPACES = (0, 1)
BLOCKS, PER_BLOCK, OTHERS = 95, 30, 40
#: So many blocks behind a wrong one all is as it was, or the whole program must tell.
REACH = 16


# ---------------------------------------------------------------------------------------------- the dense check
WORD = re.compile(r"(?<![A-Z\[])(T=\"\w+\"|[A-Z]+(?:\[[A-Z]\])?=?(?:DC\()?)(-?[0-9.]*)")


@dataclass(frozen=True)
class Row:
    """A motion block as it is written: mm and rad, A counted on the short way."""

    rapid: bool
    at: tuple[float, ...]
    seconds: float
    spindle: float
    line: int
    tool: str


@dataclass
class Words:
    """What is in force while the words of a program are read."""

    now: dict = field(default_factory=dict)
    rapid: bool = True
    inverse: bool = False
    feed: float = 0.0
    speed: float = 0.0
    spindle: float = 0.0
    tool: str = ""
    skipping: int = 0

    def read(self, line, number):
        """Let one line act; its row where it moves. Checks of the control are taken as passed."""
        if line.startswith(";") or "MSG(" in line:
            return None
        if re.search(r"\bIF\b", line):
            self.skipping += bool(self.skipping or not re.search(r"IF \(R90<=", line))
            return None
        if "ENDIF" in line:
            self.skipping = max(self.skipping - 1, 0)
            return None
        if self.skipping:
            return None
        before, found = dict(self.now), WORD.findall(line)
        words, codes = dict(found), {f"{a}{b}" for a, b in found}
        self.tool = next((a[3:-1] for a, _ in found if a.startswith("T=")), self.tool)
        self.rapid = (self.rapid or "G0" in codes) and "G1" not in codes
        self.inverse = (self.inverse or "G93" in codes) and "G94" not in codes
        if "G4" in codes:
            return None
        self.feed, self.speed = float(words.get("F") or self.feed), float(words.get("S") or self.speed)
        if codes & {"M3", "M4", "M5"}:
            self.spindle = 0.0 if "M5" in codes else self.speed if "M3" in codes else -self.speed
        if "M6" in codes:
            self.now, self.spindle = {}, 0.0
        moved = False
        for key in ("X", "Y", "Z", "A=DC(", "B"):
            if words.get(key):
                value = float(words[key])
                if key[0] == "A" and "A" in self.now:
                    value += 360.0 * round((self.now["A"] - value) / 360.0)
                self.now[key[0]], moved = value, True
        if not moved or len(self.now) < 5:
            return None
        at = tuple(self.now[axis] if axis in "XYZ" else np.radians(self.now[axis]) for axis in "XYZAB")
        way = np.linalg.norm([self.now[a] - before.get(a, self.now[a]) for a in "XYZ"])
        seconds = 0.0 if self.rapid else 60.0 / self.feed if self.inverse else 60.0 * way / self.feed
        return Row(self.rapid, at, float(seconds), self.spindle, number, self.tool)


def rows_of(lines, states=None):
    """The motion of a program by its words alone; ``states`` gets what is in force before every line."""
    words, rows = Words(), []
    for number, line in enumerate(lines, start=1):
        if states is not None:
            states.append(replace(words, now=dict(words.now)))
        row = words.read(line, number)
        rows += [row] if row is not None else []
    return rows


@dataclass
class Dense:
    """What a right program does, and whether another one that differs in a few blocks does harm."""

    name: str
    member: str
    witness: object
    lines: list[str]
    points: dict = field(default_factory=dict)
    above: dict = field(default_factory=dict)
    under: dict = field(default_factory=dict)
    passes: dict = field(default_factory=dict)
    clear: dict = field(default_factory=dict)
    taken_by: dict = field(default_factory=dict)

    def __post_init__(self):
        self.states = []
        self.rows = rows_of(self.lines, self.states)
        self.place = {row.line: k for k, row in enumerate(self.rows)}
        spec = load_bevel_set(bundled(f"{self.name}.toml")).member(self.member)
        self.spec, self.height = spec, MACHINE.gauge_line_height + MACHINE.tool_length
        self.axes = np.array([row.at for row in self.rows])
        for cut in Cut.of(spec, self.member):
            found = [flank_points(spec, flank, blank_grid(spec, 8, 160, 0.0)) for flank in cut.flanks]
            self.points[cut.tool] = (
                np.concatenate([one.point for one in found]),
                np.concatenate([one.normal for one in found]),
            )
            # what lies beyond the ends of the blades is no flank: the sharp tip alone comes there, in narrow scallops
            reached = np.concatenate([one.contact[:, 0] >= 0.0 for one in found])
            point, normal = self.points[cut.tool]
            self.above[cut.tool] = (point + 1.1 * TOLERANCE * normal)[reached]
        for tool, (point, normal) in self.points.items():  # of the space and of both of its neighbors
            p, pitch = point - 1.1 * TOLERANCE * normal, 2 * np.pi / spec.teeth
            turns = [(np.cos(off * pitch), np.sin(off * pitch)) for off in (0, -1, 1)]
            self.under[tool] = np.concatenate(
                [np.stack([c * p[:, 0] - s * p[:, 1], s * p[:, 0] + c * p[:, 1], p[:, 2]], axis=1) for c, s in turns]
            )
        blank, delta = spec.blank, np.radians(spec.blank.pitch_angle)
        ends = blank.mean_cone_distance + np.array([-0.5, 0.5]) * blank.face_width
        up = blank.mean_addendum + (ends - blank.mean_cone_distance) * np.tan(np.radians(blank.face_angle) - delta)
        share, turn = np.linspace(0, 1, 25), np.linspace(0, 2 * np.pi, 240, endpoint=False)
        z, r = (
            np.interp(share, [0, 1], part)
            for part in (ends * np.cos(delta) - up * np.sin(delta), ends * np.sin(delta) + up * np.cos(delta))
        )
        self.face = np.stack([np.outer(r, np.cos(turn)), np.outer(r, np.sin(turn)), np.outer(z, turn * 0 + 1)], -1)
        self.face = self.face.reshape(-1, 3)

    def blades(self, tool):
        """Outer and inner cone: point radius and tangent of the pressure angle; of one flank only, a narrow one."""
        cut = next(cut for cut in Cut.of(self.spec, self.member) if cut.tool == tool)
        sides = {SIDES[flank]: self.spec.flank(flank) for flank in cut.flanks}
        given = {
            side: (one.blade_point_radius, np.tan(np.radians(one.blade_pressure_angle))) for side, one in sides.items()
        }
        if len(given) == 1:
            ((side, (radius, slope)),) = given.items()
            given[-side] = radius - side * 0.1, slope
        return given[1], given[-1]

    def inside(self, poses, tool, points, up=0.0):
        """Whether points (p,3) are within the annulus of the blades at poses (m,5): (m,p)."""
        centre, axis = self.witness.vertical_pose(poses, self.height)
        height = (centre * axis).sum(axis=1)[:, None] - axis @ points.T
        found = height > up
        pose, point = np.nonzero(found)
        height, away = height[pose, point], points[point] - centre[pose]
        radius = np.sqrt(np.maximum(np.einsum("nk,nk->n", away, away) - height**2, 0.0))
        (r, slope), (hole, inner) = self.blades(tool)
        found[pose, point] = (radius < r + slope * height) & (radius > hole - inner * height)
        return found

    def gaps(self, poses, tool, points):
        """How far points (p,3) are out of the blades at poses (m,5), in height or radius; negative inside (m,p)."""
        centre, axis = self.witness.vertical_pose(poses, self.height)
        height = (centre * axis).sum(axis=1)[:, None] - axis @ points.T
        # squares of 1e4 mm2 lose 1e-12 mm2: nothing at the blades, which are far from the axis
        square = (points**2).sum(axis=1) - 2 * centre @ points.T + (centre**2).sum(axis=1)[:, None] - height**2
        radius = np.sqrt(np.maximum(square, 0.0))
        (r, slope), (hole, inner) = self.blades(tool)
        return np.maximum(-height, np.maximum(radius - r - slope * height, hole - inner * height - radius))

    def comes(self, tool, off):
        """By how much :meth:`gaps` change, at most, where the ends of blocks go ``off`` (m,5).

        A pose moves a point, as the cutter sees it, by no more than X Y Z and its distance from the axes times A and B.
        """
        off, ((_, slope), (_, inner)) = np.abs(off).max(axis=0), self.blades(tool)
        away = float(np.linalg.norm(self.under[tool], axis=1).max())
        return (off[:3].sum() + off[3:].sum() * away) * (1.0 + max(slope, inner))

    def within_reach(self, ends, tool, turn, right):
        """The points under the flanks that the blades can get to in a block, in place of the one to row ``right``."""
        points = self.under[tool]
        if right is None:
            middle = ends.mean(axis=0)
            return points[self.gaps(middle[None] - turn, tool, points)[0] <= self.comes(tool, ends - middle)]
        own = self.axes[right - 1 : right + 1]
        if right not in self.clear:
            shares = np.linspace(0, 1, 33)[:, None]
            found = self.gaps(own[0] + shares * (own[1] - own[0]) - turn, tool, points)
            self.clear[right] = found.min(axis=0) - self.comes(tool, np.diff(own, axis=0)) / 64
        return points[self.clear[right] <= self.comes(tool, ends - own)]

    def harm(self, rows, first, behind, machine=True):
        """The harm done by ``rows`` in the place of the right ones from ``first`` up to ``behind``, or None: to the
        part alone unless ``machine``."""
        chain = [*self.rows[max(first - 1, 0) : first], *rows, *self.rows[behind : behind + 1]]
        blocks = [(a, b) for a, b in itertools.pairwise(chain) if a.tool == b.tool]
        return (machine and self.limits(chain, blocks)) or self.metal(chain, blocks, first, behind, machine)

    def harm_of(self, line, new, machine=True):
        """The same for lines ``new`` in the place of one, from 1: read on until all in force is right again."""
        words = replace(self.states[line - 1], now=dict(self.states[line - 1].now))
        rows = [row for text in new if (row := words.read(text, line)) is not None]
        for after in range(line, min(line + 12, len(self.lines))):
            if words == self.states[after]:
                first, behind = np.searchsorted([row.line for row in self.rows], [line, after + 1]).tolist()
                return self.harm(rows, first, behind, machine) if rows or behind > first else None
            rows += [row] if (row := words.read(self.lines[after], after + 1)) is not None else []
        return self.harm_of_text("\n".join([*self.lines[: line - 1], *new, *self.lines[line:]]), machine)

    def harm_of_text(self, text, machine=True):
        """The same for a whole text: what differs from the right one."""
        rows = rows_of(text.split("\n"))
        same = [replace(row, line=0) for row in rows]
        right = [replace(row, line=0) for row in self.rows]
        first = next(
            (k for k, (a, b) in enumerate(zip(same, right, strict=False)) if a != b), min(len(same), len(right))
        )
        last = 0
        while last < min(len(same), len(right)) - first and same[-1 - last] == right[-1 - last]:
            last += 1
        return self.harm(rows[first : len(rows) - last], first, len(right) - last, machine)

    def limits(self, chain, blocks):
        low, high = MACHINE.travel.T
        speed, rate = MACHINE.max_speed * 1.002, MACHINE.max_acceleration * 1.002
        for row in chain:
            if (np.array(row.at) < low - 1e-5).any() or (np.array(row.at) > high + 1e-5).any():
                return "travel"
            if not row.rapid and abs(row.spindle - RPM) > 0.05 * RPM:
                return "spindle"
        last = None
        for a, b in blocks:
            if b.rapid or b.seconds == 0.0:
                last = None
                continue
            v = (np.array(b.at) - a.at) / b.seconds
            if (np.abs(v) > speed).any():
                return "speed"
            if last is not None and (np.abs(v - last[0]) > rate * (b.seconds + last[1]) / 2).any():
                return "acceleration"
            last = v, b.seconds
        return None

    def metal(self, chain, blocks, first, behind, machine):
        after = self.rows[max(first - 1, 0) : behind + 1]
        standing = [(row.at, row.rapid) for row in chain] == [(row.at, row.rapid) for row in after]
        one_for_one = [row.tool for row in chain] == [row.tool for row in after]
        right = {id(row): max(first - 1, 0) + k for k, row in enumerate(chain)} if one_for_one else {}
        new = blocks
        for a, b in new:
            tool = b.tool
            point, _ = self.points[tool]
            ends = np.array([a.at, b.at])
            lift = ends[:, 2].min() - self.axes[:, 2].min()
            if b.rapid:
                straight_up = ends[1, 2] >= ends[0, 2] and not np.delete(ends[1] - ends[0], 2).any() and not a.rapid
                steps = 2 + int(np.abs(ends[1] - ends[0])[:3].max() / 0.5 + np.abs(ends[1] - ends[0])[4] * 200)
                if not straight_up and lift < 40.0:
                    way = ends[0] + np.linspace(0, 1, steps)[:, None] * (ends[1] - ends[0])
                    if any(self.inside(part, tool, self.face).any() for part in np.array_split(way, 1 + steps // 8)):
                        return "rapid in the work"
                continue
            space = self.space_of(b)
            turn = self.turn_of(space)
            middle = point[len(point) // 4]
            seen = [self.seen(end - turn, middle) for end in ends]
            way = np.linalg.norm(seen[1] - seen[0])
            plunge = not np.delete(ends[1] - ends[0], 2).any()
            if machine and b.seconds and way / b.seconds * 60.0 > (FEED if not plunge else max(FEED, PLUNGE)) * 1.1:
                return "feed"
            if standing:
                continue
            there = right.get(id(b))
            if there is not None and self.space_of(self.rows[there]) != space:
                there = None
            some = self.within_reach(ends, tool, turn, there)
            steps = int(np.clip(way / 0.04, 9, 400))
            poses = ends[0] + np.linspace(0, 1, steps)[:, None] * (ends[1] - ends[0]) - turn
            if len(some) and self.inside(poses, tool, some).any():
                return "gouge"
        return None if standing else self.left(new, first, behind)

    def left(self, new, first, behind):
        """Whether metal stays that the blocks from ``first`` to ``behind`` took away: 8 blocks around are looked at."""
        old = [k for k in range(first, min(behind + 1, len(self.rows))) if k and not self.rows[k].rapid]
        if not old:
            return None
        tool, space = self.rows[old[0]].tool, self.space_of(self.rows[old[0]])
        left = np.flatnonzero(np.any([self.cuts(k, space) for k in old], axis=0))
        for k in itertools.chain(range(behind + 1, behind + 9), range(first - 1, first - 9, -1)):
            if not 0 < k < len(self.rows) or self.rows[k].rapid or self.rows[k].tool != tool:
                continue
            if self.space_of(self.rows[k]) == space:
                left = left[~self.cuts(k, space)[left]]
        for a, b in new:
            if len(left) and not b.rapid and b.tool == tool:
                left = left[~self.taken(a.at, b.at, tool, space, left)]
        return "uncut" if len(left) else None

    def cuts(self, k, space):
        """Which points above the flanks of a space the right program takes away on its way to row ``k``."""
        if (k, space) not in self.taken_by:
            self.taken_by[k, space] = self.taken(self.axes[k - 1], self.axes[k], self.rows[k].tool, space, slice(None))
        return self.taken_by[k, space]

    def taken(self, a, b, tool, space, some):
        """Which of ``some`` points above the flanks of a space a block takes away, by nine poses of it."""
        a, b = np.array(a), np.array(b)
        poses = a + np.linspace(0, 1, 9)[:, None] * (b - a) - self.turn_of(space)
        return self.inside(poses, tool, self.above[tool][some]).any(axis=0)

    def turn_of(self, space):
        """What the positions of a space are beside those of space 0."""
        return np.array([0, 0, 0, 2 * np.pi * space / self.spec.teeth, 0])

    def seen(self, at, point):
        """A point of the work from the cutter centre, in the axes of the machine."""
        x, y, z, a, b = at
        c, s = np.cos(-a), np.sin(-a)
        px, py, pz = c * point[0] - s * point[1], s * point[0] + c * point[1], point[2]
        return np.array([-np.sin(b) * px - np.cos(b) * pz - x, py - y, np.cos(b) * px - np.sin(b) * pz - z])

    def space_of(self, row):
        """The space in which a row cuts: by the A of the right rows of the tool, nearest in X and Y."""
        own = self.own(row.tool)
        k = int(np.abs(own[:, :2] - np.array(row.at[:2])).sum(axis=1).argmin())
        return round((row.at[3] - own[k, 3]) * self.spec.teeth / (2 * np.pi)) % self.spec.teeth

    def own(self, tool):
        """The positions of the first pass of a tool."""
        if tool not in self.passes:
            self.passes[tool] = self._first_pass(tool)
        return self.passes[tool]

    def _first_pass(self, tool):
        numbers = [k for k, row in enumerate(self.rows) if row.tool == tool and not row.rapid]
        end = next((j for j, (a, b) in enumerate(itertools.pairwise(numbers)) if b > a + 1), len(numbers) - 1)
        return self.axes[numbers[: end + 1]]


# -------------------------------------------------------------------------- what gearmath mill says, block by block
def number(node, column):
    return nc_values.number(node, None, "CUT", 0, column)


def snapshot(control):
    """The control as it stands, to go on from twice."""
    kept = copy.copy(control)
    for part in ("modal", "position", "shift", "feed_radius", "counting", "within", "path_modes"):
        setattr(kept, part, dict(getattr(control, part)))
    kept.blind, kept.changes = list(control.blind), list(control.changes)
    return kept


def standing(control):
    """All that is in force in the control, to compare: but for the lines in which path modes were first met."""
    own = {key: value for key, value in vars(control).items() if key not in ("name", "probe", "setup")}
    return own | {"path_modes": set(control.path_modes)}


def acting(body):
    """What acts where nothing stops the program, sections included: no branch that ends or halts it."""
    for part in body:
        if isinstance(part, Block | Command):
            yield part
        elif isinstance(part, Branch):
            inside = list(acting(part.then))
            blocks = [one for one in inside if isinstance(one, Block)]
            if not any({"program end", "program stop"} & set(block.words) for block in blocks):
                yield from inside


def digits(line):
    """The line with one digit or the sign of one axis, S or F word changed, in every way, with what it is."""
    for word in re.finditer(r"(?:(?<=\s)[XYZBSF]|[AC]=DC\()(-?)([0-9.]+)", line):
        kind = "F" if word[0][0] == "F" else "S" if word[0][0] == "S" else "axis"
        for at in range(word.start(2), word.end(2)):
            for digit in "0123456789" if line[at].isdecimal() else "":
                if digit != line[at]:
                    yield f"{kind} digit", line[:at] + digit + line[at + 1 :]
        if kind == "axis":
            yield "sign", line[: word.start(1)] + ("" if word[1] else "-") + line[word.start(2) :]


@dataclass
class Whole:
    """A right program, and what all that judges it needs."""

    name: str
    member: str
    spaces: tuple[int, ...]

    def __post_init__(self):
        bevel_set = load_bevel_set(bundled(f"{self.name}.toml"))
        self.spec = bevel_set.member(self.member)
        self.text = cutting_program(
            bevel_set, self.member, MACHINE, "CUT", CuttingJob(self.spaces or range(self.spec.teeth))
        )
        self.lines = self.text.split("\n")
        self.space = tooth_space(self.spec, self.member, 7)
        self.stated = Stated.of(self.text)
        self.path = execute(self.text, "CUT", Setup.of(MACHINE))
        self._run_right()

    def with_lines(self, line, new):
        return "\n".join([*self.lines[: line - 1], *new, *self.lines[line:]])

    def faults(self, text, everything=False):
        """What mill says of a whole text: a list of sentences, or what refuses it."""
        try:
            path = execute(text, "CUT", Setup.of(MACHINE))
            runs = runs_of(path, self.spec, self.member, MACHINE, None, self.space, SHARP_EDGE)
            found = [str(one) for one in faults_of(text, path, runs, self.spec, self.member, MACHINE)]
            if everything and not found:
                left = metal_left(runs, self.spec, self.member, MACHINE, self.stated, self.space)
                found = [str(one) for one in left.faults]
        except InputError as error:
            return [str(error)]
        return found

    def _run_right(self):
        """What is in force before every block, and how many rows lie behind."""
        control, self.blocks, self.before, self.behind, rows = (
            ControlState("CUT", setup=Setup.of(MACHINE)),
            [],
            [],
            [],
            0,
        )
        for part in acting(read_program(self.text, "CUT").body):
            if isinstance(part, Command):
                if part.name == "FGROUP":
                    control.modal["path axes"], control.feed_axes = "FGROUP", "".join(axis for axis, _ in part.words)
                elif part.name == "TRANS":
                    assert part.words == ()
                    control.modal["frames"] = "TRANS"
                continue
            self.blocks.append(part)
            self.before.append(snapshot(control))
            self.behind.append(rows)
            rows += control.run(part, number) is not None
        self.before.append(snapshot(control))
        self.behind.append(rows)
        assert rows == len(self.path.line)
        self.standing = [standing(one) for one in self.before]
        self.place = {block.line: k for k, block in enumerate(self.blocks)}

    def near(self, line, new):
        """The rows that lines ``new`` make in the place of one, with those around; whether all is then as it was.

        None where they cannot be judged by themselves. Raises InputError where the control refuses them.
        """
        k = self.place.get(line)
        made = [block for text in new for block in read_program(text, "CUT").body]
        if k is None or not all(isinstance(block, Block) for block in made):
            return None
        control, at = snapshot(self.before[k]), k + 1
        rows = [control.run(replace(block, line=line), number) for block in made]
        while standing(control) != self.standing[at] and at < min(k + REACH, len(self.blocks)):
            rows.append(control.run(self.blocks[at], number))
            at += 1
        rows = [row for row in rows if row is not None]
        # where Z must stand at a tool change the whole program tells
        alone = not any({"frame suppression", "tool change"} & set(one.words) for one in (self.blocks[k], *made))
        joined, first, last = alone and standing(control) == self.standing[at], self.behind[k], self.behind[at]
        tools = {self.path.tools.index(row.tool) for row in rows} or set(self.path.tool[first:last].tolist())
        if len(tools) > 1 or not (rows or last > first):
            return None if len(tools) > 1 else ({}, joined)
        (tool,) = tools
        before = [r for r in range(max(first - 3, 0), first) if self.path.tool[r] == tool]
        after = [r for r in range(last, last + 4) if joined and r < len(self.path.tool) and self.path.tool[r] == tool]
        own = {
            "axes": np.array([[*row.position[:3], *np.radians(row.position[3:])] for row in rows]).reshape(-1, 5),
            "rapid": np.array([row.rapid for row in rows], bool),
            "seconds": np.array([row.seconds for row in rows]),
            "rpm": np.array([row.rpm for row in rows]),
            "measuring": np.array([row.measuring for row in rows], bool),
        }
        part = {
            key: np.concatenate([getattr(self.path, key)[before], new, getattr(self.path, key)[after]])
            for key, new in own.items()
        }
        if not before:  # the way to the first row is not part of the program
            part = {key: np.concatenate([values[:1], values]) for key, values in part.items()}
        start = max(len(before), 1)
        part["line"] = np.zeros(len(part["rapid"]), int)
        part["line"][max(start - 1, 1) : start + len(rows) + 1] = 1
        part["tool"] = np.full(len(part["rapid"]), tool)
        part["rapid"][0] = True
        return part, joined

    def alone(self, changed):
        """What the checks of blocks say of changes, each a line and the lines in its place: their numbers from 0.

        Those that are refused or seen, and those that only the whole program tells.
        """
        found, open_, parts = set(), set(), [[] for _ in self.path.tools]
        for mutant, (line, new) in enumerate(changed):
            try:
                made = self.near(line, new)
            except InputError:
                found.add(mutant)
                continue
            if made is None or not made[1]:
                open_.add(mutant)
            if made is not None and made[0]:
                part = made[0] | {"line": made[0]["line"] * (mutant + 1)}
                parts[int(part["tool"][0])].append(part)
        for tool, own in enumerate(parts):
            found |= self._seen(own, self.path.tools[tool]) if own else set()
        return found, open_ - found

    def _seen(self, parts, tool):
        def together(some):
            joined = {key: np.concatenate([part[key] for part in some]) for key in KEYS}
            path = MachinePath(
                tools=(tool,), cutter=np.full(len(joined["line"]), np.nan), **(joined | {"tool": joined["tool"] * 0})
            )
            return path, runs_of(path, self.spec, self.member, MACHINE, None, self.space, SHARP_EDGE)

        path, runs = together(parts)
        found = [
            *spindle(path, MACHINE, self.stated),
            *travel(path, MACHINE),
            *speeds(path, MACHINE),
            *feeds(path, runs, self.spec, MACHINE, self.stated),
            *beside_the_path(runs, self.spec, MACHINE, self.stated),
        ]
        seen = {one.line for one in found}
        near = [
            part for part in parts if part["line"].max() not in seen and part["rapid"][1:][part["line"][1:] > 0].any()
        ]
        if near:
            path, runs = together(near)
            both = (
                *collisions(path, runs, self.spec, MACHINE, *obstacles(MACHINE)),
                *rapid_approaches(runs, self.spec, MACHINE),
            )
            seen |= {line for one in both for line in one.lines}
        return {line - 1 for line in seen if line > 0}


MOTION = re.compile(r"[XYZ][-0-9]")
KEYS = ("axes", "rapid", "tool", "line", "seconds", "rpm", "measuring")


def others(whole):
    """Whole texts with one block wrong otherwise: kind, line from 1, and the lines in its place."""
    for k, line in enumerate(whole.lines):
        if not line.startswith("N"):
            continue
        yield "removed block", k + 1, []
        yield "doubled block", k + 1, [line, line]
        if "MSG(" in line:
            continue
        for right, wrong, kind in (
            ("G0", "G1", "G0 for G1"),
            ("G1", "G0", "G1 for G0"),
            ("M3", "M4", "M3 for M4"),
            ("G54", "G55", "G54 for G55"),
        ):
            if re.search(rf"\b{right}\b", line):
                yield kind, k + 1, [re.sub(rf"\b{right}\b", wrong, line)]
        if not MOTION.search(line) and re.search(r"[SF][0-9]", line):
            for kind, wrong in digits(line):
                yield kind, k + 1, [wrong]
        if " G93 " not in line and "MSG(" not in line and "IF" not in line:
            words = line.split()
            for j in range(1, len(words)):
                yield "removed word", k + 1, [" ".join(words[:j] + words[j + 1 :])]


def wrong_digits(whole, blocks, per_block, random):
    """Digits and signs of motion blocks: kind, line and the lines in its place."""
    chosen = [line for line in whole.path.line.tolist() if MOTION.search(whole.lines[line - 1])]
    if blocks < len(chosen):
        chosen = np.sort(random.choice(chosen, blocks, replace=False)).tolist()
    for line in chosen:
        found = list(digits(whole.lines[line - 1]))
        some = range(len(found)) if per_block >= len(found) else random.choice(len(found), per_block, replace=False)
        yield from ((found[j][0], line, [found[j][1]]) for j in some)


def sample_of(found, count, random):
    found = list(found)
    return [found[j] for j in np.sort(random.choice(len(found), min(count, len(found)), replace=False))]


def trial(whole, dense, changed):
    """How many changes of each kind are refused or seen, and how many harmless; and those that nobody sees."""
    count, unseen = Counter(), []
    seen, open_ = whole.alone([(line, new) for _, line, new in changed])
    for mutant, (kind, line, new) in enumerate(changed):
        text = whole.with_lines(line, new)
        if mutant in seen or (mutant in open_ and whole.faults(text)):
            count[kind, "seen"] += 1
        elif (harm := dense.harm_of(line, new)) is None:
            count[kind, "harmless"] += 1
        elif whole.faults(text, everything=True):
            count[kind, "seen"] += 1
        else:
            unseen.append((kind, harm, f"line {line}: {whole.lines[line - 1]} -> {' | '.join(new)}"))
    return count, unseen


@pytest.fixture(scope="module", params=CASES, ids=["-".join(case) for case in CASES])
def case(request, witness):
    """A right program of a bundled member, what judges it, and the dense check."""
    whole = Whole(*request.param, SPACES)
    dense = Dense(*request.param, witness, whole.lines)
    assert [row.line for row in dense.rows] == whole.path.line.tolist()
    np.testing.assert_allclose(dense.axes, whole.path.axes, atol=1e-9)
    return whole, dense


@pytest.mark.slow
def test_no_wrong_word_of_a_whole_program_is_left_unseen(case):
    whole, dense = case
    random = np.random.default_rng(CASES.index((whole.name, whole.member)))
    changed = [*wrong_digits(whole, BLOCKS, PER_BLOCK, random), *sample_of(others(whole), OTHERS, random)]
    count, unseen = trial(whole, dense, changed)
    kinds = sorted({kind for kind, _ in count})
    print(f"\n{whole.name} {whole.member}, {len(changed)} mutants, {len(unseen)} unseen; refused or seen + harmless:")
    print("; ".join(f"{kind} {count[kind, 'seen']} + {count[kind, 'harmless']}" for kind in kinds))
    assert unseen == []
    assert sum(count[kind, "seen"] for kind in kinds) > 100


def moved(whole, dense, line, new):
    """How far [mm] the end of a cutting block goes from where it belongs, at the back of the teeth; 0 for others."""
    right = dense.rows[np.searchsorted([row.line for row in dense.rows], line)]
    words = replace(dense.states[line - 1], now=dict(dense.states[line - 1].now))
    wrong = words.read(new[0], line)
    if right.line != line or right.rapid or wrong is None:
        return 0.0
    reach = whole.spec.blank.mean_cone_distance + whole.spec.blank.face_width / 2
    return float(np.abs((np.array(wrong.at) - right.at) * [1, 1, 1, reach, reach]).max())


@pytest.mark.slow
def test_dense_check_is_not_blind_to_what_mill_sees(case):
    """Of blocks that are moved by more than twice the tolerance, most gouge or leave metal, whatever the machine says.

    The others slide along the flank, or end where the cutter is out of the metal: in the plunge, and in the 2 degrees
    by which the roll goes beyond the flank at both ends, a tenth to a quarter of it.
    """
    whole, dense = case
    random = np.random.default_rng(100)
    changed = [
        (line, new)
        for kind, line, new in wrong_digits(whole, 30, 4, random)
        if kind in ("axis digit", "sign") and moved(whole, dense, line, new) > 2 * TOLERANCE
    ]
    seen, _ = whole.alone(changed)
    harm = [dense.harm_of(*changed[mutant], machine=False) is not None for mutant in sorted(seen)]
    print(f"\n{whole.name} {whole.member}: {len(changed)} moved, {len(seen)} seen, {sum(harm)} of them spoil the part")
    assert len(harm) > (40 if whole.spec.generation == "generated" else 3)  # Formate: two blocks a space cut
    assert sum(harm) > 0.7 * len(harm)


@pytest.mark.slow
def test_blocks_judged_among_their_neighbors_are_judged_as_in_the_whole_program(case):
    whole, _ = case
    random = np.random.default_rng(200)
    changed = [*wrong_digits(whole, 20, 1, random), *sample_of(others(whole), 7, random)]
    seen, open_ = whole.alone([(line, new) for _, line, new in changed])
    told = [mutant for mutant in range(len(changed)) if mutant not in open_]
    assert len(told) > 15
    # what shows only where a part of the program is run alone is none of the blocks'
    said = {mutant: whole.faults(whole.with_lines(*changed[mutant][1:])) for mutant in told}
    as_a_whole = {k: [fault for fault in some if "with R90=" not in fault] for k, some in said.items()}
    assert [mutant for mutant, some in as_a_whole.items() if some] == sorted(seen)


def hobbed_path(text, spec, member):
    """The path of a hobbing program, (n,6) and the time of every block; None if mill refuses it or sees something."""
    try:
        path = execute(text, "CUT", Setup.of(MACHINE))
        runs = runs_of(path, spec, member, MACHINE, None, None, SHARP_EDGE)
        if faults_of(text, path, runs, spec, member, MACHINE):
            return None
    except InputError:
        return None
    return np.column_stack([path.axes, path.cutter]), path.seconds


@pytest.mark.slow
@pytest.mark.parametrize("member", ["pinion", "gear"])
def test_what_passes_of_wrong_hobbing_programs_is_the_right_path_within_the_tolerance(member):
    """Harmless is here: the same positions within 1.5 times the tolerance, and no block faster. In the plunge, at one
    place of X Y B, Z may stand anywhere above its end: what it takes away too early is taken away later.

    No dense check follows the blades of face hobbing one by one; what mill says of the metal is not asked.
    """
    bevel_set, tolerance = load_bevel_set(bundled("crown_gear_hobbed_14x39.toml")), 5e-4
    spec = bevel_set.member(member)
    text = cutting_program(bevel_set, member, MACHINE, "CUT", CuttingJob(range(spec.teeth), tolerance=tolerance))
    right, seconds = hobbed_path(text, spec, member)
    assert np.nan_to_num(np.diff(right, axis=0)).any(axis=1).all()
    cuts = seconds > 0
    fastest = np.nanmax(np.abs(np.diff(right[:, 5]))[cuts[1:]] / seconds[cuts])
    reach = spec.blank.mean_cone_distance + spec.blank.face_width / 2
    whole = SimpleNamespace(lines=text.split("\n"), path=execute(text, "CUT", Setup.of(MACHINE)))
    random = np.random.default_rng(300)
    changed = [*wrong_digits(whole, 20, 1, random), *sample_of(others(whole), 14, random)]
    passed = 0
    for kind, line, new in changed:
        found = hobbed_path("\n".join([*whole.lines[: line - 1], *new, *whole.lines[line:]]), spec, member)
        if found is None:
            continue
        passed += 1
        axes, times = found
        moves = np.append(True, np.nan_to_num(np.diff(axes, axis=0)).any(axis=1))
        axes, times = axes[moves], times[moves]
        assert len(axes) == len(right), (kind, whole.lines[line - 1], new)
        off = axes - right
        off[:, 3::2] = (off[:, 3::2] + np.pi) % (2 * np.pi) - np.pi
        plunges = np.append(False, ~np.diff(right[:, :2], axis=0).any(axis=1))
        off[plunges, 2] = np.minimum(axes[plunges, 2] - right[plunges, 2].min(), 0.0)
        off *= [1, 1, 1, reach, reach, spec.flank("concave").blade_point_radius]
        assert np.nanmax(np.abs(off)) < 1.5 * tolerance, (kind, whole.lines[line - 1], new)
        cuts = times > 0
        rate = np.abs(np.diff(axes[:, 5]))[cuts[1:]] / times[cuts]
        assert np.nanmax(rate) < 1.02 * fastest, (kind, whole.lines[line - 1], new)
    print(f"\nhobbed {member}: {len(changed)} mutants, {passed} harmless")
    assert passed < 0.6 * len(changed)
