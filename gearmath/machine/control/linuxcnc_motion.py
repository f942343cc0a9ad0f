"""What the words of a line for LinuxCNC do: modal codes, tool, spindle, motion and probing."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from gearmath.machine.control.blocks import PathRow
from gearmath.machine.control.expression import AXES, CUTTER_AXIS, refuse
from gearmath.machine.control.linuxcnc_lines import NgcLine
from gearmath.machine.control.runner import Halt
from gearmath.machine.control.state import PROBE_TOOL, Blind, Deflected, Follower, Probe, Setup

#: The alarm that stands for ABORT, which has no number.
ABORTED = 1
UP_AND_AWAY = 1e9
OFFSETS = {"G54": 5221, "G55": 5241, "G56": 5261, "G57": 5281}
#: Number of a tool that no program means.
ANOTHER_TOOL = 99_998
_ALL = AXES + CUTTER_AXIS
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
    **dict.fromkeys(OFFSETS, "work offset (G54)"),
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
#: Letters beside axes, F, S and T, and the codes that take them.
_LETTERS = {"P": {"G4", "G64", "M66"}, "Q": {"G64", "M66", "M68"}, "L": {"M66"}, "E": {"M66", "M68"}}


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

    def __post_init__(self) -> None:
        self.stand(self.setup.position)

    def stand(self, position: tuple[float, ...] | None) -> None:
        """The axes at machine coordinates, or wherever they are."""
        self.position.clear()
        if position is not None:
            self.position |= {a: p - z for a, p, z in zip(AXES, position, self.setup.zero, strict=True)}


class LinuxCncMotion:
    """A control that acts on words, one line after the other."""

    def __init__(self, name: str, setup: Setup, probe: Probe | None, deflected: Deflected, moved: Follower) -> None:
        self.name, self.probe, self.deflected, self.moved = name, probe, deflected, moved
        self.control = LinuxCncState(setup)
        self.parameters: dict[int, float] = {}
        self.tools: dict[int, str] = {}
        self.rows: list[PathRow] = []
        self.halts: list[Halt] = []
        self.said: list[str] = []
        self.messages: list[str] = []
        self.alarm: tuple[int, int] | None = None
        self._latched = -1

    def _shown(self, axis: str) -> float:
        """The position of an axis in coordinates of the program."""
        if axis not in self.control.position:
            return UP_AND_AWAY
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

    def _act(self, line: NgcLine, codes: list[str], words: dict[str, float]) -> None:
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
        self._check_letters(line, codes, words)
        if "F" in words:
            state.feed = words["F"]
        if "S" in words:
            state.speed = words["S"]
        if "T" in words:
            state.selected = int(words["T"])
        if "G64" in codes:
            # Q is how far blocks that are nearly in line are made one; without it, P
            state.within = max(words.get("P", math.inf), words.get("Q", 0.0))
        self._machine(line, codes)
        if "M66" in codes:
            self.parameters[5399] = 0.0
        if {"M66", "M68"} & set(codes):  # both wait until the axes stand
            self._halt(line, False)
        if "G4" in codes:
            self._halt(line, False, words.get("P", 0.0))
        elif any(axis in words for axis in _ALL):
            self._move(line, words, "G53" in codes)
        if "M0" in codes:
            self._halt(line, True)
        state.ended = state.ended or bool({"M2", "M30"} & set(codes))

    def _check_letters(self, line: NgcLine, codes: list[str], words: dict[str, float]) -> None:
        """Refuse what LinuxCNC would refuse on its way, and letters that mean something else to another machine."""
        for letter in words:
            if letter not in {*_ALL, *"FST"} and not _LETTERS.get(letter, set()) & set(codes):
                refuse(self.name, line.number, 1, f"{letter}{words[letter]:g} is not understood here")
        if "G4" in codes and "P" not in words:
            refuse(self.name, line.number, 1, "G4 without a time P")
        for code, what in (("G4", "a time"), ("G64", "a tolerance")):
            if code in codes and words.get("P", 0.0) < 0:
                refuse(self.name, line.number, 1, f"{code} P{words['P']:g}: {what} is not below 0")
        timed = self.control.modal.get("feed mode (G93 or G94)") == "G93" and self.control.modal.get("motion") == "G1"
        if timed and "F" not in words and any(axis in words for axis in _ALL):
            refuse(self.name, line.number, 1, "F is missing: every G93 block needs its own")

    def _machine(self, line: NgcLine, codes: list[str]) -> None:
        """Spindle, coolant, tool change."""
        state = self.control
        for code, sense in (("M3", 1), ("M4", -1), ("M5", 0)):
            if code in codes:
                if state.sense and not sense:
                    self._halt(line, False)
                state.sense = sense
                state.position.pop(CUTTER_AXIS, None)
        if "M8" in codes or "M9" in codes:
            state.coolant = "M8" in codes
        if "M6" in codes:
            if state.sense:
                refuse(self.name, line.number, 1, "M6 with the spindle on")
            state.changes.append((line.number, state.position.get("Z")))
            meant = self.tools.get(state.selected, "")
            state.fetched = state.selected if state.setup.spindle_tool(meant) == meant else ANOTHER_TOOL
            state.stand(state.setup.changed_at)

    def _halt(self, line: NgcLine, stop: bool, seconds: float = 0.0) -> None:
        self.halts.append(Halt(line.number, stop, len(self.rows), len(self.control.blind), seconds))

    def _move(self, line: NgcLine, words: dict[str, float], machine: bool) -> None:
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

    def _seconds(self, line: NgcLine, before: Mapping[str, float]) -> float:
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

    def _probe(self, line: NgcLine, before: Mapping[str, float], towards: bool) -> None:
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
