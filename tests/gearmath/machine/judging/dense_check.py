"""Whether a program does harm, told by dense steps: no code of ``gearmath mill`` takes part.

It reads the words of a program by itself, moves the cutter by the machine of the witness, and asks whether points a
tolerance under the flanks are cut, and whether points a tolerance above them are left.
"""

from __future__ import annotations

import itertools
import re
from dataclasses import dataclass, field, replace

import numpy as np

from gearmath.bevel.flank import blank_grid
from gearmath.machine.planning.path import Cut, flank_points
from gearmath.specs.bevel_set import SIDES, load_bevel_set
from gearmath.specs.milling_machine import load_milling_machine
from gearmath.specs.toml import bundled

MACHINE = load_milling_machine(bundled("vertical_5axis.toml"))
TOLERANCE, RPM, FEED, PLUNGE = 1e-4, 120.0, 300.0, 200.0
#: Poses of a block by which metal is taken away, and those where it seems to stay: between nine poses of a long
#: block 0.03 um were seen to stay.
POSES, FINE_POSES = 9, 65

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
        for key in ("X", "Y", "Z", "A", "A=DC(", "B"):
            if words.get(key):
                value = float(words[key])
                if key == "A=DC(" and "A" in self.now:
                    value += 360.0 * round((self.now["A"] - value) / 360.0)
                self.now[key[0]], moved = value, True
        if not moved or len(self.now) < 5:
            return None
        at = tuple(self.now[axis] if axis in "XYZ" else np.radians(self.now[axis]) for axis in "XYZAB")
        way = np.linalg.norm([self.now[a] - before.get(a, self.now[a]) for a in "XYZ"])
        seconds = 0.0 if self.rapid else 60.0 / self.feed if self.inverse else 60.0 * way / self.feed
        return Row(self.rapid, at, float(seconds), self.spindle, number, self.tool)


@dataclass
class NgcWords(Words):
    """The same for LinuxCNC, where A counts on and tools are numbers, which the head names.

    Of its conditions ``o1 if [..]`` only those hold that ask for a part of the program.
    """

    names: dict = field(default_factory=dict)

    def read(self, line, number):
        if named := re.match(r"; tool T(\d+): (\w+)", line):
            self.names[named[1]] = named[2]
        if line.startswith(("(", "#")):
            return None
        if line.startswith("o"):
            if " if " in line:
                self.skipping += bool(self.skipping or not re.search(r" if \[\[#3090 LE ", line))
            elif "endif" in line:
                self.skipping = max(self.skipping - 1, 0)
            return None
        if selected := re.match(r"T(\d+)", line):
            self.tool = self.names.get(selected[1], line)
        inverse = self.inverse
        row = super().read(line, number)
        if self.inverse != inverse and not re.search(r"F[0-9]", line):
            self.feed = 0.0
        return row


def rows_of(lines, states=None, words=Words):
    """The motion of a program by its words alone; ``states`` gets what is in force before every line."""
    words, rows = words(), []
    for number, line in enumerate(lines, start=1):
        if states is not None:
            states.append(replace(words, now=dict(words.now)))
        row = words.read(line, number)
        rows += [row] if row is not None else []
    return rows


@dataclass(frozen=True)
class Blade:
    """One cone of a cutter, outer (1) or inner (-1): point radius, tangent of the pressure angle, and edge radius."""

    side: int
    radius: float
    slope: float
    edge: float

    @property
    def straight(self):
        """How far above the tip its straight part begins, and how far along the cone that is from its end."""
        tangent = self.edge * (np.hypot(1.0, self.slope) - self.slope)
        return tangent / np.hypot(1.0, self.slope), tangent

    def reach(self, height):
        """Radii that it reaches at heights over the tip."""
        found = self.radius + self.side * self.slope * height
        low = height < self.straight[0]
        if low.any():
            arc = np.sqrt(np.maximum(self.edge**2 - (self.edge - height[low]) ** 2, 0.0))
            found[low] = self.radius - self.side * (self.straight[1] - arc)
        return found


@dataclass
class Dense:
    """What a right program does, and whether another one that differs in a few blocks does harm."""

    name: str
    member: str
    witness: object
    lines: list[str]
    words: type[Words] = Words
    points: dict = field(default_factory=dict)
    above: dict = field(default_factory=dict)
    under: dict = field(default_factory=dict)
    passes: dict = field(default_factory=dict)
    clear: dict = field(default_factory=dict)
    taken_by: dict = field(default_factory=dict)

    def __post_init__(self):
        self.states = []
        self.rows = rows_of(self.lines, self.states, self.words)
        self.place = {row.line: k for k, row in enumerate(self.rows)}
        spec = load_bevel_set(bundled(f"{self.name}.toml")).member(self.member)
        self.spec, self.height = spec, MACHINE.gauge_line_height + MACHINE.tool_length
        self.axes = np.array([row.at for row in self.rows])
        for cut in Cut.of(spec):
            found = [flank_points(spec, flank, blank_grid(spec, 8, 160, 0.0)) for flank in cut.flanks]
            self.points[cut.tool] = (
                np.concatenate([one.point for one in found]),
                np.concatenate([one.normal for one in found]),
            )
            # what lies beyond the ends of the blades is no flank: the edge alone comes there, in narrow scallops
            straight = {flank: self.blade(flank).straight[1] for flank in cut.flanks}
            reached = np.concatenate(
                [one.contact[:, 0] >= straight[flank] for flank, one in zip(cut.flanks, found, strict=True)]
            )
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

    def blade(self, flank):
        spec = self.spec.flank(flank)
        slope = float(np.tan(np.radians(spec.blade_pressure_angle)))
        return Blade(SIDES[flank], spec.blade_point_radius, slope, spec.blade_edge_radius or 0.0)

    def blades(self, tool):
        """Outer and inner cone; of one flank only, a narrow one."""
        cut = next(cut for cut in Cut.of(self.spec) if cut.tool == tool)
        given = {SIDES[flank]: self.blade(flank) for flank in cut.flanks}
        if len(given) == 1:
            ((side, own),) = given.items()
            given[-side] = Blade(-side, own.radius - side * 0.1, own.slope, 0.0)
        return given[1], given[-1]

    def inside(self, poses, tool, points, up=0.0):
        """Whether points (p,3) are within the annulus of the blades at poses (m,5): (m,p)."""
        centre, axis = self.witness.vertical_pose(poses, self.height)
        height = (centre * axis).sum(axis=1)[:, None] - axis @ points.T
        found = height > up
        pose, point = np.nonzero(found)
        height, away = height[pose, point], points[point] - centre[pose]
        radius = np.sqrt(np.maximum(np.einsum("nk,nk->n", away, away) - height**2, 0.0))
        outer, inner = self.blades(tool)
        found[pose, point] = (radius < outer.reach(height)) & (radius > inner.reach(height))
        return found

    def gaps(self, poses, tool, points):
        """How far points (p,3) are out of the cones of the blades at poses (m,5), in height or radius; negative inside
        (m,p). What is out of them is out of the blades, whose edges are rounded within them."""
        centre, axis = self.witness.vertical_pose(poses, self.height)
        height = (centre * axis).sum(axis=1)[:, None] - axis @ points.T
        # squares of 1e4 mm2 lose 1e-12 mm2: nothing at the blades, which are far from the axis
        square = (points**2).sum(axis=1) - 2 * centre @ points.T + (centre**2).sum(axis=1)[:, None] - height**2
        radius = np.sqrt(np.maximum(square, 0.0))
        outer, inner = self.blades(tool)
        out = radius - outer.radius - outer.slope * height, inner.radius - inner.slope * height - radius
        return np.maximum(-height, np.maximum(*out))

    def comes(self, tool, off):
        """By how much :meth:`gaps` change, at most, where the ends of blocks go ``off`` (m,5).

        A pose moves a point, as the cutter sees it, by no more than X Y Z and its distance from the axes times A and B.
        """
        off, slope = np.abs(off).max(axis=0), max(blade.slope for blade in self.blades(tool))
        away = float(np.linalg.norm(self.under[tool], axis=1).max())
        return (off[:3].sum() + off[3:].sum() * away) * (1.0 + slope)

    def within_reach(self, ends, tool, turn, right):
        """The points under the flanks that the blades can get to in a block, in place of the one to row ``right``."""
        points = self.under[tool]
        if right is None:
            middle = ends.mean(axis=0)
            return points[self.gaps(middle[None] - turn, tool, points)[0] <= self.comes(tool, ends - middle)]
        return self.reachable(right, tool, turn, ends - self.axes[right - 1 : right + 1])

    def reachable(self, right, tool, turn, off):
        """The same for a block whose ends are ``off`` (m,5) those of the block to row ``right``."""
        points, own = self.under[tool], self.axes[right - 1 : right + 1]
        if right not in self.clear:
            shares = np.linspace(0, 1, 33)[:, None]
            found = self.gaps(own[0] + shares * (own[1] - own[0]) - turn, tool, points)
            self.clear[right] = found.min(axis=0) - self.comes(tool, np.diff(own, axis=0)) / 64
        return points[self.clear[right] <= self.comes(tool, off)]

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
        rows = rows_of(text.split("\n"), words=self.words)
        same = [replace(row, line=0) for row in rows]
        right = [replace(row, line=0) for row in self.rows]
        first = next(
            (k for k, (a, b) in enumerate(zip(same, right, strict=False)) if a != b), min(len(same), len(right))
        )
        last = 0
        while last < min(len(same), len(right)) - first and same[-1 - last] == right[-1 - last]:
            last += 1
        return self.harm(rows[first : len(rows) - last], first, len(right) - last, machine)

    def harms_of_ends(self, changed):
        """The harm of changes of one line that move the end of a feed block, or its time, and nothing behind the next
        one, by their numbers: what :meth:`harm_of` says, all of a line at once. Others are left out."""
        moved = {}
        for mutant, (line, new) in enumerate(changed):
            k = self.place.get(line, 0)
            if len(new) == 1 and 1 < k < len(self.rows) - 2 and self.rows[k + 1].line == line + 1:
                words = replace(self.states[line - 1], now=dict(self.states[line - 1].now))
                row = words.read(new[0], line)
                again = words.read(self.lines[line], line + 1)
                if row is not None and words == self.states[line + 1] and again.at == self.rows[k + 1].at:
                    moved.setdefault(k, []).append((mutant, row, again))
        found = {}
        for k, some in moved.items():
            before, right, after = self.rows[k - 1 : k + 2]
            alike = [
                one
                for one in some
                if not (one[1].rapid or one[2].rapid)
                and one[1].tool == before.tool == after.tool
                and one[2] == after
                and self.space_of(one[1]) == self.space_of(right)
                and one[1].spindle == right.spindle
            ]
            if alike:
                harms = self.harm_of_ends(k, [row for _, row, _ in alike])
                found |= {mutant: harm for (mutant, _, _), harm in zip(alike, harms, strict=True)}
        return found

    def harm_of_ends(self, k, new):
        """The harm of each of ``new`` in the place of row ``k``."""
        a, right, c, d = (self.rows[k + off] for off in (-1, 0, 1, 2))
        found = [
            self.limits(chain, [(p, q) for p, q in itertools.pairwise(chain) if p.tool == q.tool])
            for chain in ([a, row, c, d] for row in new)
        ]
        tool, space = right.tool, self.space_of(right)
        turn, ends = self.turn_of(space), np.array([row.at for row in new])
        point, _ = self.points[tool]
        middle = point[len(point) // 4]
        standing = (ends == np.array(right.at)).all(axis=1)
        seen = self.seen((ends - turn).T, middle).T
        gouged, ways = np.zeros(len(new), bool), []
        for part, (fixed, times, one) in enumerate(
            ((a, np.array([row.seconds for row in new]), k), (c, np.full(len(new), c.seconds), k + 1))
        ):
            way = np.linalg.norm(seen - self.seen(np.array(fixed.at) - turn, middle), axis=1)
            plunge = ~np.delete(ends - np.array(fixed.at), 2, axis=1).any(axis=1)
            fast = (times > 0) & (way > np.where(plunge, max(FEED, PLUNGE), FEED) * 1.1 * times / 60.0)
            found = [was or ("feed" if now else None) for was, now in zip(found, fast, strict=True)]
            ways.append(way)
            asked = np.flatnonzero(~standing & np.array([one is None for one in found]))
            if not len(asked):
                continue
            start = np.tile(np.array(fixed.at), (len(asked), 1))
            pair = (start, ends[asked]) if part == 0 else (ends[asked], start)
            off = np.concatenate([pair[0] - self.axes[one - 1], pair[1] - self.axes[one]])
            some = self.reachable(one, tool, turn, off)
            if not len(some):
                continue
            steps = int(np.clip(way[asked].max() / 0.04, 9, 400))
            count = min(len(asked), 1 + len(asked) * steps * len(some) // 1_000_000)
            for few in np.array_split(np.arange(len(asked)), count):
                first, last = (one[few, None] for one in pair)
                poses = first + np.linspace(0, 1, steps)[:, None] * (last - first) - turn
                met = self.inside(poses.reshape(-1, 5), tool, some).reshape(len(few), -1).any(axis=1)
                gouged[asked[few[met]]] = True
        found = [was or ("gouge" if now else None) for was, now in zip(found, gouged, strict=True)]
        asked = np.flatnonzero(~standing & np.array([one is None for one in found]))
        left = self.opened(k, k + 2)
        for p, q in ((c, d),) if not d.rapid and d.tool == tool else ():
            left = left[~self.taken(p.at, q.at, tool, space, left)] if len(left) else left
        if len(left) and len(asked):
            points, shares = self.above[tool][left], np.linspace(0, 1, POSES)[:, None]
            away = np.zeros((len(asked), len(left)), bool)
            for first, last in ((np.array(a.at), ends[asked, None]), (ends[asked, None], np.array(c.at))):
                poses = first + shares * (last - first) - turn
                away |= self.inside(poses.reshape(-1, 5), tool, points).reshape(len(asked), POSES, -1).any(axis=1)
            for at, j in enumerate(asked):
                stays = left[~away[at]]
                if len(stays) and len(self.stays([(a, new[j]), (new[j], c), (c, d)], k, k + 2, stays)):
                    found[j] = "uncut"
        return found

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
            if self.gouges(ends, tool, turn, there, int(np.clip(way / 0.04, 9, 400))):
                return "gouge"
        return None if standing else self.left(new, first, behind)

    def gouges(self, ends, tool, turn, right, steps):
        """Whether a block with ``ends`` (2,5), in the place of the one to row ``right``, cuts under the flanks."""
        some = self.within_reach(ends, tool, turn, right)
        poses = ends[0] + np.linspace(0, 1, steps)[:, None] * (ends[1] - ends[0]) - turn
        return bool(len(some)) and bool(self.inside(poses, tool, some).any())

    def gouging(self, steps=FINE_POSES):
        """The lines of the right program whose blocks cut under the flanks: none, or this check takes harmless changes
        for harm."""
        for right, (a, b) in enumerate(itertools.pairwise(self.rows), start=1):
            if not b.rapid and a.tool == b.tool:
                ends, turn = self.axes[right - 1 : right + 1], self.turn_of(self.space_of(b))
                if self.gouges(ends, b.tool, turn, right, steps):
                    yield b.line

    def left(self, new, first, behind):
        """Whether metal stays that the blocks from ``first`` to ``behind`` took away: 8 blocks around are looked at."""
        left = self.opened(first, behind)
        return "uncut" if len(left) and len(self.stays(new, first, behind, left)) else None

    def stays(self, new, first, behind, left):
        """Which of the points ``left`` stay with blocks ``new`` from ``first`` to ``behind``: in fine steps, if any."""
        right = next(self.rows[k] for k in range(max(first, 1), len(self.rows)) if not self.rows[k].rapid)
        tool, space = right.tool, self.space_of(right)
        blocks = [(a, b) for a, b in new if not b.rapid and b.tool == tool]
        around = [(self.rows[k - 1], self.rows[k]) for k in self.around(first, behind, tool, space)]
        for some, count in ((blocks, POSES), (blocks + around, FINE_POSES)):
            for a, b in some:
                if len(left):
                    left = left[~self.taken(a.at, b.at, tool, space, left, count)]
        return left

    def around(self, first, behind, tool, space):
        """Eight rows before and behind that the same tool cuts in the same space."""
        for k in itertools.chain(range(behind + 1, behind + 9), range(first - 1, first - 9, -1)):
            row = self.rows[k] if 0 < k < len(self.rows) else None
            if row is not None and not row.rapid and row.tool == tool and self.space_of(row) == space:
                yield k

    def opened(self, first, behind):
        """The points above the flanks that only the right blocks from ``first`` to ``behind`` take away."""
        old = [k for k in range(first, min(behind + 1, len(self.rows))) if k and not self.rows[k].rapid]
        if not old:
            return np.zeros(0, int)
        tool, space = self.rows[old[0]].tool, self.space_of(self.rows[old[0]])
        left = np.flatnonzero(np.any([self.cuts(k, space) for k in old], axis=0))
        for k in self.around(first, behind, tool, space):
            left = left[~self.cuts(k, space)[left]]
        return left

    def cuts(self, k, space):
        """Which points above the flanks of a space the right program takes away on its way to row ``k``."""
        if (k, space) not in self.taken_by:
            self.taken_by[k, space] = self.taken(self.axes[k - 1], self.axes[k], self.rows[k].tool, space, slice(None))
        return self.taken_by[k, space]

    def taken(self, a, b, tool, space, some, count=POSES):
        """Which of ``some`` points above the flanks of a space a block takes away, by so many poses of it."""
        a, b = np.array(a), np.array(b)
        poses = a + np.linspace(0, 1, count)[:, None] * (b - a) - self.turn_of(space)
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
