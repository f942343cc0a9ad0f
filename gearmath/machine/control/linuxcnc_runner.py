"""Runs programs for LinuxCNC as its interpreter would, on a machine that is set up as the machine file says.

``#<_task>`` is 1: a program checks the control as it does where it moves a machine. What it asks of positions before
its first motion is answered with axes that are up and away. ABORT is the alarm of a program. There is no host.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from gearmath.machine.control.blocks import PathRow
from gearmath.machine.control.expression import AXES, CUTTER_AXIS, refuse
from gearmath.machine.control.linuxcnc_expression import Cursor
from gearmath.machine.control.linuxcnc_lines import Line, lines_of, partners
from gearmath.machine.control.runner import Halt
from gearmath.machine.control.state import PROBE_TOOL, Blind, Deflected, Follower, Probe, Setup

#: The alarm that stands for ABORT, which has no number.
ABORTED = 1
_UP_AND_AWAY = 1e9
#: R parameters that are handed in, and what they are here: the first and the last part that is run.
_SAME = {90: 3090, 91: 3091}
#: Number of a tool that no program means.
_ANOTHER = 99_998
_WORD = re.compile(r"[A-Z]")
_ALL = AXES + CUTTER_AXIS
_TOOL = re.compile(r"^; tool T(\d+): ([A-Za-z0-9_]+)", re.MULTILINE)
_OFFSETS = {"G54": 5221, "G55": 5241, "G56": 5261, "G57": 5281}
#: Codes by what they decide; the last one of each is in force.
_GROUPS = {
    "G0": "motion",
    "G1": "motion",
    "G38.3": "motion",
    "G38.5": "motion",
    "G17": "plane (G17)",
    "G21": "units (G21)",
    "G40": "radius compensation (G40)",
    "G43": "tool length (G43 or G49)",
    "G49": "tool length (G43 or G49)",
    **dict.fromkeys(_OFFSETS, "work offset (G54)"),
    "G61": "path mode (G61 or G64)",
    "G64": "path mode (G61 or G64)",
    "G80": "canned cycle (G80)",
    "G90": "distance mode (G90)",
    "G92.2": "G92.2",
    "G93": "feed mode (G93 or G94)",
    "G94": "feed mode (G93 or G94)",
    "G97": "spindle mode (G97)",
}
_ONCE = ("G4", "G53")
_STOPS = {"M0", "M2", "M30"}
_OTHERS = {"M3", "M4", "M5", "M6", "M8", "M9", "M66", "M68"}
_FORMAT = re.compile(r"%(d|\.\d+f)#(<[^>]+>|\d+)|#(<[^>]+>|\d+)")


@dataclass
class LinuxCncState:
    """What is in force and how the axes stand: mm and degrees, counted from the zero of the machine file."""

    setup: Setup
    modal: dict[str, str] = field(default_factory=dict)
    position: dict[str, float] = field(default_factory=dict)
    feed: float | None = None
    speed: float = 0.0
    sense: int = 0
    coolant: bool = False
    within: float = 0.0
    selected: int = 0
    fetched: int = 0
    ended: bool = False
    unstated: tuple[str, ...] | None = None
    blind: list[Blind] = field(default_factory=list)
    changes: list[tuple[int, float | None]] = field(default_factory=list)
    path_modes: dict[tuple[str, float, float], int] = field(default_factory=dict)
    dynamics: dict[tuple[str, str], int] = field(default_factory=dict)


class LinuxCncRunner:
    """Lines in the order in which they act; what it has at the end is what the runner of the other dialect has."""

    def __init__(
        self,
        name: str,
        setup: Setup,
        probe: Probe | None,
        parameters: Mapping[int, float],
        step_limit: int,
        deflected: Deflected,
        moved: Follower,
    ) -> None:
        self.name, self.probe, self.steps_left = name, probe, step_limit
        self.deflected, self.moved = deflected, moved
        self.control = LinuxCncState(setup)
        self.parameters = {_SAME.get(number, number): value for number, value in parameters.items()}
        self.named: dict[str, float] = {}
        self.local: list[dict[int, float]] = [{}]
        self.tools: dict[int, str] = {}
        self.rows: list[PathRow] = []
        self.halts: list[Halt] = []
        self.said: list[str] = []
        self.messages: list[str] = []
        self.files: dict[str, list[str]] = {}
        self.taken: set[int] = set()
        self.unset: dict[int, int] = {}
        self.alarm: tuple[int, int] | None = None
        self._log: str | None = None
        self._steps, self._latched = step_limit, -1

    def run(self, text: str) -> None:
        """The whole program, from its first line to M2."""
        self.tools = {int(number): tool for number, tool in _TOOL.findall(text)}
        self.lines = lines_of(text, self.name)
        self.ends = partners(self.lines, self.name)
        self.subs = {line.label: place for place, line in enumerate(self.lines) if line.flow == "SUB"}
        self._from(0, len(self.lines))
        if not self.control.ended:
            refuse(self.name, len(text.splitlines()), 1, "the text ends without M2: the program is not complete")

    def _from(self, place: int, end: int) -> None:
        """Lines from one place to another."""
        while place < end and not self.control.ended:
            line = self.lines[place]
            self.steps_left -= 1
            if self.steps_left < 0:
                refuse(self.name, line.number, 1, f"the program takes more than {self._steps} steps: does it end?")
            if line.flow:
                place = self._flow(place, line)
                continue
            self._says(line)
            if not self.control.ended:
                self._block(line)
            place += 1

    def _flow(self, place: int, line: Line) -> int:
        """Where an O-word leads."""
        if line.flow in ("IF", "WHILE"):
            holds = self._cursor(line).value() != 0.0
            return place + 1 if holds else self.ends[place] + 1
        if line.flow in ("ELSE", "SUB"):
            return self.ends[place] + 1
        if line.flow == "ENDWHILE":
            return self.ends[place]
        if line.flow == "CALL":
            begin = self.subs.get(line.label)
            if begin is None:
                refuse(self.name, line.number, 1, f"there is no subroutine O{line.label}")
            cursor = self._cursor(line)
            values: dict[int, float] = {}
            while not cursor.ended:
                values[len(values) + 1] = cursor.value()
            self.local.append(values)
            if len(self.local) > 10:
                refuse(self.name, line.number, 1, "subroutines are called more than 10 deep")
            self._from(begin + 1, self.ends[begin])
            self.local.pop()
        return place + 1

    def _cursor(self, line: Line) -> Cursor:
        return Cursor(line.code, self.name, line.number, lambda number: self._numbered(number, line), self._named)

    def _numbered(self, number: int, line: Line) -> float:
        """The value of a parameter: of the control, of the subroutine, or of the program."""
        state, setup = self.control, self.control.setup
        if number <= 30:
            return self.local[-1].get(number, 0.0)
        for code, first in _OFFSETS.items():
            if first <= number < first + 20 and (setup.work_offset in (None, code)):
                at = number - first
                return setup.offset[at] if at < 5 else setup.turned[2] if at == 9 else 0.0
        if 5061 <= number < 5061 + len(AXES) and self._latched >= 0:
            self.taken.add(self._latched)
        if number == 5400:
            return float(state.fetched)
        if number == 5403:
            return self._length()
        if 5420 <= number < 5420 + len(AXES):
            return self._shown(AXES[number - 5420])
        if number >= 5000 and number not in self.parameters:
            return 0.0
        if number not in self.parameters and not 3090 <= number <= 3110:
            self.unset.setdefault(number, line.number)
        return self.parameters.get(number, 0.0)

    def _named(self, name: str) -> float | None:
        return 1.0 if name == "_TASK" else self.named.get(name)

    def _shown(self, axis: str) -> float:
        """The position of an axis in coordinates of the program."""
        if axis not in self.control.position:
            return _UP_AND_AWAY
        return self.control.position[axis] - self._from_zero(axis, False)

    def _length(self) -> float:
        """The tool length that is in force."""
        state = self.control
        if state.modal.get(_GROUPS["G43"]) != "G43" or state.fetched == 0:
            return 0.0
        return state.setup.length(self._tool())

    def _tool(self) -> str:
        number = self.control.fetched
        return self.tools.get(number, f"T{number}")

    def _from_zero(self, axis: str, machine: bool) -> float:
        """What is added to a programmed position of an axis; with G53 it counts from the machine's own zero."""
        if axis not in AXES:
            return 0.0
        k, setup = AXES.index(axis), self.control.setup
        length = self._length() if axis == "Z" and not machine else 0.0
        return length - setup.zero[k] + (0.0 if machine else setup.offset[k])

    def _says(self, line: Line) -> None:
        """What the comments of a line do."""
        for what, text in line.said:
            shown = _FORMAT.sub(lambda found: self._formatted(found, line), text).strip()
            if what in ("LOGOPEN", "LOGAPPEND"):
                self._log = shown
                self.files[shown] = [] if what == "LOGOPEN" else self.files.get(shown, [])
            elif what == "LOG":
                if self._log is None:
                    refuse(self.name, line.number, 1, "LOG without LOGOPEN")
                self.files[self._log].append(shown)
            elif what == "LOGCLOSE":
                self._log = None
            else:
                self.messages.append(shown)
            if what == "ABORT":
                self.alarm = ABORTED, line.number
                self.control.ended = True

    def _formatted(self, found: re.Match[str], line: Line) -> str:
        name = found[2] or found[3]
        value = self._named(name[1:-1].upper()) if name.startswith("<") else self._numbered(int(name), line)
        form = found[1] or ".6f"
        return f"{round(value or 0.0)}" if form == "d" else f"{value or 0.0:{form}}"

    def _block(self, line: Line) -> None:
        """Assignments, then words; assignments act when the line is over."""
        cursor = self._cursor(line)
        set_: dict[int | str, float] = {}
        words: dict[str, float] = {}
        codes: list[str] = []
        while not cursor.ended:
            if cursor.text.startswith("#", cursor.at):
                key = self._assigned(cursor)
                set_[key] = cursor.value()
                continue
            found = cursor.match(_WORD)
            if found is None:
                cursor.refuse(f"{cursor.text[cursor.at : cursor.at + 10]!r} is not understood")
                raise AssertionError
            value = cursor.value()
            if found[0] in "GM":
                codes.append(f"{found[0]}{value:g}")
            elif found[0] != "N":
                if found[0] in words:
                    cursor.refuse(f"{found[0]} is there twice")
                words[found[0]] = value
        self._act(line, codes, words)
        for key, value in set_.items():
            if isinstance(key, str):
                self.named[key] = value
            elif key <= 30:
                self.local[-1][key] = value
            else:
                self.parameters[key] = value

    def _assigned(self, cursor: Cursor) -> int | str:
        """The parameter that a line sets, behind it the sign of equality."""
        key: int | str
        if cursor.text.startswith("#<", cursor.at):
            end = cursor.text.find(">", cursor.at)
            key, cursor.at = cursor.text[cursor.at + 2 : end], end + 1
        else:
            key = cursor.index()
        if not cursor.text.startswith("=", cursor.at):
            cursor.refuse("= is expected")
        cursor.at += 1
        return key

    def _act(self, line: Line, codes: list[str], words: dict[str, float]) -> None:
        """The words of one line, in the order in which LinuxCNC acts."""
        state = self.control
        for code in codes:
            if code not in _GROUPS and code not in _ONCE and code not in _STOPS | _OTHERS:
                refuse(self.name, line.number, 1, f"{code} is not understood")
            if code in _GROUPS:
                group = _GROUPS[code]
                if group == "feed mode (G93 or G94)" and state.modal.get(group) != code:
                    state.feed = None
                state.modal[group] = code
        if "F" in words:
            state.feed = words["F"]
        if "S" in words:
            state.speed = words["S"]
        if "T" in words:
            state.selected = int(words["T"])
        if "G64" in codes:
            state.within = words.get("P", math.inf)
        self._machine(line, codes)
        if "M66" in codes:
            self.parameters[5399] = 0.0
        if "G4" in codes:
            self._halt(line, False)
        elif any(axis in words for axis in _ALL):
            self._move(line, words, "G53" in codes)
        if "M0" in codes:
            self._halt(line, True)
        state.ended = state.ended or bool({"M2", "M30"} & set(codes))

    def _machine(self, line: Line, codes: list[str]) -> None:
        """Spindle, coolant, tool change."""
        state = self.control
        for code, sense in (("M3", 1), ("M4", -1), ("M5", 0)):
            if code in codes:
                state.sense = sense
                state.position.pop(CUTTER_AXIS, None)
        if "M8" in codes or "M9" in codes:
            state.coolant = "M8" in codes
        if "M6" in codes:
            if state.sense:
                refuse(self.name, line.number, 1, "M6 with the spindle on")
            state.changes.append((line.number, state.position.get("Z")))
            meant = self.tools.get(state.selected, "")
            state.fetched = state.selected if state.setup.spindle_tool(meant) == meant else _ANOTHER
            state.position.clear()

    def _halt(self, line: Line, stop: bool) -> None:
        self.halts.append(Halt(line.number, stop, len(self.rows), len(self.control.blind)))

    def _move(self, line: Line, words: dict[str, float], machine: bool) -> None:
        """One motion; nothing is kept of it while the position of an axis is unknown."""
        state = self.control
        motion = state.modal.get("motion")
        if motion is None:
            refuse(self.name, line.number, 1, "axis words without G0, G1 or G38.3")
        if state.unstated is None:
            groups = dict.fromkeys(_GROUPS.values())
            state.unstated = tuple(group for group in groups if group not in state.modal)
        wanted, offset = state.setup.work_offset, state.modal.get("work offset (G54)")
        if wanted not in (None, offset):
            refuse(self.name, line.number, 1, f"{offset} is active, the machine file counts from {wanted}")
        before, rapid = dict(state.position), motion == "G0"
        alone = [axis for axis in _ALL if axis in words] == ["Z"]
        for axis in _ALL:
            if axis in words:
                state.position[axis] = words[axis] + self._from_zero(axis, machine)
        if any(axis not in before for axis in AXES):
            raised = machine and rapid and alone and self._length() == 0.0
            state.blind.append(Blind(line.number, raised, state.position.get("Z")))
        seconds = 0.0 if rapid else self._seconds(line, before)
        if motion.startswith("G38"):
            self._probe(line, before, motion == "G38.3")
        if not rapid:
            mode = state.modal.get("path mode (G61 or G64)")
            known = ("G60", 0.0, 0.0) if mode == "G61" else ("G642", state.within, 0.0)
            state.path_modes.setdefault(known, line.number)
        if any(axis not in state.position for axis in AXES) or state.fetched == 0:
            return
        position = tuple(state.position[axis] for axis in AXES)
        if state.sense and CUTTER_AXIS in words:
            refuse(self.name, line.number, 1, "C is an axis only while the spindle stands (M5)")
        rpm, cutter = state.sense * state.speed, state.position.get(CUTTER_AXIS, math.nan)
        row = PathRow(
            position, rapid, self._tool(), line.number, seconds, rpm, motion == "G38.3", cutter, state.coolant
        )
        self.rows.append(row)
        self.said.append(self.messages[-1] if self.messages else "")
        self.moved(_internal(position))

    def _seconds(self, line: Line, before: Mapping[str, float]) -> float:
        """How long a feed block takes: by its time, or by X Y Z, and where these stand by the axes that turn."""
        state = self.control
        if state.feed is None or state.feed <= 0.0:
            refuse(self.name, line.number, 1, "G1 without F")
        if state.modal.get("feed mode (G93 or G94)") == "G93":
            return 60.0 / state.feed
        step = {axis: state.position[axis] - before.get(axis, state.position[axis]) for axis in state.position}
        way = math.hypot(*(step.get(axis, 0.0) for axis in "XYZ")) or math.hypot(
            *(step.get(axis, 0.0) for axis in "ABC")
        )
        return 60.0 * way / state.feed

    def _probe(self, line: Line, before: Mapping[str, float], towards: bool) -> None:
        """G38.3 ends where the probe triggers, and G38.5, which begins at a surface, where it is commanded to."""
        state = self.control
        if state.fetched == 0 or self._tool() != PROBE_TOOL:
            refuse(self.name, line.number, 1, f"probing without the tool {PROBE_TOOL}")
        if any(axis not in before for axis in AXES):
            refuse(self.name, line.number, 1, "probing from an unknown position")
        start, end = (np.array([place[axis] for axis in AXES]) for place in (before, state.position))
        if towards and self.deflected(_internal(start)):
            self.messages.append("the probe is deflected before it is moved")
            self.alarm, state.ended = (ABORTED, line.number), True
            state.position = dict(before)
            return
        met = self.probe(_internal(start), _internal(end)) if self.probe is not None and towards else None
        if met is not None:
            state.position |= dict(zip(AXES, _external(met).tolist(), strict=True))
        self.parameters[5070] = float(met is not None)
        self.parameters |= {5061 + k: self._shown(axis) for k, axis in enumerate(AXES)}
        self._latched = len(self.rows) if towards else -1


def _internal(position: np.ndarray | tuple[float, ...]) -> np.ndarray:
    values = np.array(position, dtype=float)
    values[3:] = np.radians(values[3:])
    return values


def _external(position: np.ndarray) -> np.ndarray:
    values = np.array(position, dtype=float)
    values[3:] = np.degrees(values[3:])
    return values
