"""A right program, and what ``gearmath mill`` says of it where a few of its lines are others: without running the rest.

The real reader and control run a changed block and the next ones from the state before it until all in force is as it
was, and the checks of ``mill`` see these blocks among their neighbors. A number in a block that rolls on to another
one is put into the rows of the right program at once. Tests show that either is as in the whole.
"""

from __future__ import annotations

import copy
import re
from dataclasses import dataclass, replace
from functools import cached_property
from typing import ClassVar

import numpy as np

from gearmath.bevel.tooth import SHARP_EDGE, tooth_space
from gearmath.bevel.turning import turned
from gearmath.errors import InputError
from gearmath.machine.bodies.profiles import obstacles
from gearmath.machine.control import values as nc_values
from gearmath.machine.control.blocks import ControlState
from gearmath.machine.control.executor import MachinePath, execute
from gearmath.machine.control.reader import read_program
from gearmath.machine.control.state import Setup
from gearmath.machine.control.tree import Block, Branch, Command
from gearmath.machine.judging.alike import alike
from gearmath.machine.judging.collision import collisions, rapid_approaches, standing_retracts
from gearmath.machine.judging.cut import beside_limit, beside_the_path, distances_aside, metal_left, off_the_path
from gearmath.machine.judging.feed import feed_limits, feeds
from gearmath.machine.judging.motion import speeds, spindle, travel
from gearmath.machine.judging.program import faults_of
from gearmath.machine.judging.stated import Stated
from gearmath.machine.judging.watched_lines import height_on_blade, watched_flanks
from gearmath.machine.milling.mill import expose
from gearmath.machine.milling.removal import entry_along_block
from gearmath.machine.milling.run import runs_of
from gearmath.machine.milling.surfaces import DEFAULT_TOLERANCE as REPORTED
from gearmath.machine.milling.surfaces import generated_root, nominal_surfaces
from gearmath.machine.planning.cut_plan import CuttingJob
from gearmath.machine.writing.cutting import cutting_program
from gearmath.specs.bevel_set import load_bevel_set
from gearmath.specs.milling_machine import load_milling_machine
from gearmath.specs.toml import bundled

MACHINE = load_milling_machine(bundled("vertical_5axis.toml"))
#: So many blocks behind a wrong one all is as it was, or the whole program must tell.
REACH = 16
KEYS = ("axes", "rapid", "tool", "line", "seconds", "rpm", "measuring")
#: A block that rolls, and how many rows before and behind it its neighbors are.
ROLL = re.compile(r"N\d+ G93 G1 X(\S+) Y(\S+) Z(\S+) A=DC\((\S+)\) B(\S+) F(\S+)")
BEFORE, BEHIND = 3, 6
#: Poses of a block at which lines are looked at.
SHARES = np.linspace(0.0, 1.0, 17)


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


@dataclass(frozen=True)
class Lines:
    """Lines along normals of one surface of a space: whether only its ``own`` passes count, how deep and how high they
    may end [mm], and the blocks that end them in the right program."""

    space: int
    own: bool
    point: np.ndarray
    normal: np.ndarray
    start: np.ndarray
    deep: float
    high: np.ndarray
    block: np.ndarray


@dataclass
class Whole:
    """A right program, and what all that judges it needs."""

    name: str
    member: str
    spaces: tuple[int, ...]
    roll: ClassVar[re.Pattern] = ROLL

    def __post_init__(self):
        bevel_set = load_bevel_set(bundled(f"{self.name}.toml"))
        self.spec = bevel_set.member(self.member)
        self.text = self.written(bevel_set, CuttingJob(self.spaces or range(self.spec.teeth)))
        self.lines = self.text.split("\n")
        self.space = tooth_space(self.spec, 7)
        self.stated = Stated.of(self.text)
        self.path = execute(self.text, "CUT", Setup.of(MACHINE))
        self._run_right()

    def written(self, bevel_set, job):
        """The text of the right program."""
        return cutting_program(bevel_set, self.member, MACHINE, "CUT", job)

    def with_lines(self, line, new):
        return "\n".join([*self.lines[: line - 1], *new, *self.lines[line:]])

    def faults(self, text, everything=False):
        """What mill says of a whole text: a list of sentences, or what refuses it."""
        try:
            path = execute(text, "CUT", Setup.of(MACHINE))
            runs = runs_of(path, self.spec, MACHINE, None, self.space, SHARP_EDGE)
            found = [str(one) for one in faults_of(text, path, runs, self.spec, MACHINE)]
            if everything and not found:
                found = self.metal(runs)
        except InputError as error:
            return [str(error)]
        return found

    def metal(self, runs):
        """What mill says of the metal that runs of a tool leave."""
        left = metal_left(runs, self.spec, MACHINE, self.stated, self.space)
        return [str(one) for one in left.faults]

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

    def changed(self, line, new):
        """Rows that lines ``new`` make in the place of one, the right rows first to last that they replace, and whether
        all is then as it was; None where they cannot be judged by themselves.

        Raises InputError where the control refuses them.
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
        # where Z must stand at a tool change the whole program tells, what a plunge ends with, and of labels
        alone = not any(
            {"frame suppression", "tool change", "dwell"} & set(one.words) for one in (self.blocks[k], *made)
        )
        alone &= ":" not in self.lines[line - 1]
        joined, first, last = alone and standing(control) == self.standing[at], self.behind[k], self.behind[at]
        tools = {self.path.tools.index(row.tool) for row in rows} or set(self.path.tool[first:last].tolist())
        if len(tools) > 1:
            return None
        own = {
            "axes": np.array([[*row.position[:3], *np.radians(row.position[3:])] for row in rows]).reshape(-1, 5),
            "rapid": np.array([row.rapid for row in rows], bool),
            "tool": np.full(len(rows), min(tools, default=0)),
            "line": np.full(len(rows), line),
            "seconds": np.array([row.seconds for row in rows]),
            "rpm": np.array([row.rpm for row in rows]),
            "measuring": np.array([row.measuring for row in rows], bool),
        }
        return own, first, last, joined

    def near(self, line, new):
        """The rows of a change with those around, ``line`` 1 where the change tells; whether all is then as it was.

        None where they cannot be judged by themselves. Raises InputError where the control refuses them.
        """
        made = self.changed(line, new)
        if made is None:
            return None
        own, first, last, joined = made
        count = len(own["line"])
        if not (count or last > first):
            return {}, joined
        tool = int(own["tool"][0]) if count else int(self.path.tool[first])
        before = [r for r in range(max(first - BEFORE, 0), first) if self.path.tool[r] == tool]
        after = [r for r in range(last, last + 4) if joined and r < len(self.path.tool) and self.path.tool[r] == tool]
        part = {
            key: np.concatenate([getattr(self.path, key)[before], new, getattr(self.path, key)[after]])
            for key, new in own.items()
        }
        if not before:  # the way to the first row is not part of the program
            part = {key: np.concatenate([values[:1], values]) for key, values in part.items()}
        start = max(len(before), 1)
        part["line"] = np.zeros(len(part["rapid"]), int)
        part["line"][max(start - 1, 1) : start + count + 1] = 1
        part["tool"] = np.full(len(part["rapid"]), tool)
        part["rapid"][0] = True
        return part, joined

    def alone(self, changed):
        """What the checks of blocks say of changes, each a line and the lines in its place: their numbers from 0.

        Those that are refused or seen, and those that only the whole program tells.
        """
        found = self.beside(changed)
        at_once, parts = self.at_once(changed, [mutant for mutant in range(len(changed)) if mutant not in found])
        rest = [mutant for mutant in range(len(changed)) if mutant not in found and mutant not in at_once]
        refused, open_, others = self.by_control(changed, rest)
        found |= refused | self.seen([*parts, *others])
        return found, open_ - found

    def by_control(self, changed, some):
        """Changes among ``some`` that reader or control refuse, those that only the whole program tells, and the rows
        of those that can be judged among their neighbors."""
        refused, open_, parts = set(), set(), []
        for mutant in some:
            try:
                made = self.near(*changed[mutant])
            except InputError:
                refused.add(mutant)
                continue
            if made is None or not made[1]:
                open_.add(mutant)
            if made is not None and made[0]:
                parts.append(made[0] | {"mutant": np.full(len(made[0]["line"]), mutant)})
        return refused, open_, parts

    def seen(self, parts):
        """Numbers of the changes that a check of blocks sees."""
        found = set()
        if parts:
            rows = {key: np.concatenate([part[key] for part in parts]) for key in (*KEYS, "mutant")}
            for tool, name in enumerate(self.path.tools):
                here = rows["tool"] == tool
                if here.any():
                    found |= self._seen({key: values[here] for key, values in rows.items()}, name)
        return found

    def numbers(self, changed, some):
        """Changes among ``some`` of numbers in one block that rolls on to another: which (m,), its rows (m,), and X Y Z
        A B F (m,6), mm and rad, A counted on.

        What the control would refuse, or where A would turn the other way, is left to it.
        """
        found, lines, numbers = [], [], []
        for mutant in some:
            line, new = changed[mutant]
            words = self.roll.fullmatch(new[0]) if len(new) == 1 and line in self.rolls else None
            if words is not None:
                found.append(mutant)
                lines.append(self.rolls[line])
                numbers.append(words.groups())
        if not found:
            return np.zeros(0, int), np.zeros(0, int), np.zeros((0, 6))
        found, at, values = np.array(found), np.array(lines), np.array(numbers, float)
        values[:, 3:5] = np.radians(values[:, 3:5])
        fit = self.turn(values, at)
        return found[fit], at[fit], values[fit]

    def turn(self, values, at):
        """Count A of :meth:`numbers` on from the rows before ``at``; which (m,) need not be left to the control."""
        turn, right = 2 * np.pi, self.path.axes
        turns = (right[at - 1, 3] - values[:, 3]) / turn
        angle = values[:, 3] + turn * np.round(turns)
        back = (angle - right[at + 1, 3]) / turn
        fit = (values[:, 5] > 0.0) & (values[:, 3] >= 0.0) & (values[:, 3] < turn - 1e-9)
        fit &= (np.abs(back) < 0.499) & (np.abs(np.abs(turns - np.floor(turns)) - 0.5) > 1e-3)
        values[:, 3] = angle
        return fit

    def beside(self, changed):
        """Changes, by number, of blocks that roll, whose end :func:`beside_the_path` sees, by the changed end alone.

        The cradle rotation depends on X and Y: where these are right it is known, and what is off is moved by as much.
        """
        found, at, values = self.numbers(changed, range(len(changed)))
        moved = values[:, :5] - self.path.axes[at]
        scale = np.array([1.0, 1.0, 1.0, *[self.spec.blank.mean_cone_distance + self.spec.blank.face_width / 2] * 2])
        off = self.off[at] + moved * scale
        slid = np.flatnonzero(moved[:, :2].any(axis=1))
        for tool, run in enumerate(self.runs):
            own = slid[self.path.tool[at[slid]] == tool]
            if len(own):
                there = at[own] - int((self.path.tool < tool).sum())
                ends = replace(
                    run,
                    axes=values[own, :5],
                    cutting=np.full(len(own), True),
                    space=run.space[there],
                    line=run.line[there],
                )
                _, off[own] = off_the_path(ends, self.spec, MACHINE)
        limit = beside_limit(MACHINE, self.stated)
        return set(found[distances_aside(off, self.middle[at]) > limit].tolist())

    @cached_property
    def runs(self):
        return runs_of(self.path, self.spec, MACHINE, None, self.space, SHARP_EDGE)

    @cached_property
    def off(self):
        """How far the rows of the right program are off the path; NaN where they do not cut."""
        off, begin = np.full((len(self.path.line), 5), np.nan), 0
        for run in self.runs:
            rows, own = off_the_path(run, self.spec, MACHINE)
            off[begin + rows] = own
            begin += len(run.axes)
        return off

    @cached_property
    def middle(self):
        """The median height above the path of every row's pass where it rolls on; one wrong row leaves it as it is."""
        rapid, number = self.path.rapid, np.cumsum(self.path.rapid)
        rolls = np.append(False, np.diff(self.path.axes[:, :2], axis=0).any(axis=1)) & ~rapid
        inner = rolls & ~np.append(rapid[1:], True) & ~np.append(True, rapid[:-1])
        middle = np.full(len(rapid), np.nan)
        for one in np.unique(number[inner]):
            own = inner & (number == one)
            middle[own] = np.median(self.off[own, 2])
        return middle

    def at_once(self, changed, some):
        """Changes of :meth:`numbers`, and their rows as :meth:`near` has them."""
        found, at, values = self.numbers(changed, some)
        if not len(found):
            return set(), []
        right = self.path.axes
        around = at[:, None] + np.arange(-BEFORE, BEHIND)
        rows = np.clip(around, 0, len(right) - 1)
        there = (around == rows) & (self.path.tool[rows] == self.path.tool[at][:, None])
        part = {key: getattr(self.path, key)[rows] for key in KEYS}
        part["axes"][:, BEFORE] = values[:, :5]
        part["seconds"][:, BEFORE] = 60.0 / values[:, 5]
        first = np.argmax(there, axis=1)
        told = np.arange(-BEFORE, BEHIND)
        part["line"] = ((told >= -1) & (told <= 2) & (np.arange(BEFORE + BEHIND) > first[:, None])).astype(int)
        part["rapid"][np.arange(len(at)), first] = True
        part["mutant"] = np.repeat(found[:, None], BEFORE + BEHIND, axis=1)
        return set(found.tolist()), [{key: values[there] for key, values in part.items()}]

    def _seen(self, rows, tool):
        """Numbers of the changes of one tool that a check of blocks sees."""
        told = np.where(rows["line"] > 0, rows["mutant"] + 1, 0)

        def together(some):
            path = MachinePath(
                tools=(tool,),
                cutter=np.full(int(some.sum()), np.nan),
                **(
                    {key: rows[key][some] for key in KEYS}
                    | {"tool": np.zeros(int(some.sum()), int), "line": told[some]}
                ),
            )
            return path, runs_of(path, self.spec, MACHINE, None, self.space, SHARP_EDGE)

        path, runs = together(np.full(len(told), True))
        found = [
            *spindle(path, MACHINE, self.stated),
            *travel(path, MACHINE),
            *speeds(path, MACHINE),
            *feeds(path, runs, self.spec, MACHINE, self.stated),
            *feed_limits(path, runs, self.spec, MACHINE),
            *beside_the_path(runs, self.spec, MACHINE, self.stated),
        ]
        seen = {one.line - 1 for one in found if one.line}
        begins = np.append(True, np.diff(rows["mutant"]) != 0)
        moving = rows["mutant"][rows["rapid"] & (told > 0) & ~begins]
        near = np.isin(rows["mutant"], np.setdiff1d(moving, list(seen)))
        if near.any():
            path, runs = together(near)
            both = (
                *collisions(path, runs, self.spec, MACHINE, *obstacles(MACHINE)),
                *rapid_approaches(runs, self.spec, MACHINE),
                *standing_retracts(path, runs, self.spec, MACHINE),
            )
            seen |= {line - 1 for one in both for line in one.lines if line}
        return seen

    @cached_property
    def rolls(self):
        """The row of every block, by line, that rolls on to another one."""
        rolling = [self.roll.fullmatch(self.lines[line - 1]) is not None for line in self.path.line]
        tool, line = self.path.tool, self.path.line
        return {
            int(line[k]): k
            for k in range(1, len(line) - 1)
            if rolling[k] and rolling[k + 1] and tool[k - 1] == tool[k] == tool[k + 1] and line[k + 1] == line[k] + 1
        }

    # ------------------------------------------------------------------------------ what a change leaves of the metal
    @cached_property
    def watched(self):
        """Lines that :func:`metal_left` asks, space by space, with what they may deviate by and the rows that cut them.

        Those on the flanks are asked of the passes through their own space, those on all of the surfaces of every pass.
        """
        runs = self.runs
        assert self.stated.stock == 0.0
        tolerance = self.stated.tolerance
        *surfaces, root = nominal_surfaces(self.spec, self.space)
        surfaces.append(generated_root(root, self.spec, self.space))
        found = []
        for space in self.spaces:
            for one in watched_flanks(self.spec, runs, MACHINE):
                whole = height_on_blade(one, self.spec, runs, MACHINE) >= 0.0
                found.append((one, space, True, tolerance, np.where(whole, tolerance, np.inf)))
            for one in surfaces:
                least = tolerance + REPORTED
                found.append((one, space, False, least, np.full(len(one.point), least)))
        lines = []
        for one, space, own, deep, high in found:
            angle = 2 * np.pi * space / self.spec.teeth
            given = turned(one.point, angle), turned(one.normal, angle), one.start
            left = expose(self.only(runs, space) if own else runs, MACHINE, None, *given)
            lines.append(Lines(space, own, *given, deep, high, left.block))
        return lines

    def only(self, runs, space):
        """The passes through one space."""
        return [replace(run, cutting=run.cutting & (run.space == space)) for run in runs]

    def spoils(self, line, new):
        """Whether a change leaves a part that :func:`metal_left` refuses by a twentieth of the tolerance or more.

        False says nothing. What is cut too deep is looked for by the changed blocks alone, what is left by all of them
        where the right ones of their place have cut.
        """
        made = self.changed(line, new)
        if made is None or not made[3] or not len(made[0]["line"]):
            return False
        own, first, last, _ = made
        both = {
            key: np.concatenate([getattr(self.path, key)[:first], own[key], getattr(self.path, key)[last:]])
            for key in KEYS
        }
        path = MachinePath(tools=self.path.tools, cutter=np.full(len(both["line"]), np.nan), **both)
        runs = runs_of(path, self.spec, MACHINE, None, self.space, SHARP_EDGE)
        tool = int(own["tool"][0])
        before = int((self.path.tool[:first] == tool).sum())
        (run,) = (run for run in runs if run.cut.tool == self.path.tools[tool])
        blocks = np.arange(max(before, 1), min(before + len(own["line"]) + 1, len(run.axes)))
        blocks = blocks[run.cutting[blocks]]
        offset = int((self.path.tool < tool).sum()) + before
        replaced = np.arange(offset, offset + last - first + 1)
        exposed = alike(runs, self.spec, MACHINE)
        for lines in self.watched:
            if lines.space not in exposed:
                continue
            deep = [k for k in blocks if not lines.own or run.space[k] == lines.space]
            if deep and self.deepest(run, np.array(deep), lines) < -1.05 * lines.deep:
                return True
            some = np.isin(lines.block, replaced) & np.isfinite(lines.high)
            if some.any():
                asked = self.only(runs, lines.space) if lines.own else runs
                left = expose(asked, MACHINE, None, lines.point[some], lines.normal[some], lines.start[some])
                if not (left.distance <= 1.05 * lines.high[some]).all():
                    return True
        return False

    def deepest(self, run, blocks, lines):
        """The least [mm] that some blocks leave of lines, by the poses of ``SHARES``."""
        least = np.inf
        for body in run.cutter.bodies:
            blades = body.annulus, body.outer.vector, body.inner.vector
            k, row, share = (one.ravel() for one in np.meshgrid(blocks, np.arange(len(lines.start)), SHARES))
            given = lines.point[row], lines.normal[row], lines.start[row]
            pose = run.axes[k - 1], run.axes[k], share, MACHINE.pivot_height, MACHINE.pivot, body.base
            (found,) = entry_along_block(body.sharp)(*pose, *given, *blades)
            least = min(least, float(found.min()))
        return least
