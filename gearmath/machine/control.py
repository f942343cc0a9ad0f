"""What is in force while an NC program runs, and what one block of it moves."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import NamedTuple, NoReturn

import numpy as np

from gearmath.machine.nc_expression import AXES, CUTTER_AXIS, Node, refuse
from gearmath.machine.nc_tree import Block, Word
from gearmath.machine.reader import GROUP_OF_CODE

#: Moves the probe from one position of X Y Z A B to another, (5,) mm and rad: where it triggers, or None.
Probe = Callable[[np.ndarray, np.ndarray], np.ndarray | None]
Number = Callable[[Node, int], float]

_GROUPS = frozenset(GROUP_OF_CODE.values())
#: Without these the meaning of an axis word depends on how the control happens to stand.
_NEEDED_FOR_MOTION = {
    "plane": "G17",
    "radius compensation": "G40",
    "work offset": "G54",
    "dimensioning": "G90",
    "units": "G710",
}
#: Whether these act before or after the motion of their block is a setting of the machine.
_NOT_WITH_MOTION = (
    "spindle", "SPOS", "tool change", "coolant", "program stop", "program end", "T", "D", "S", "compressor", "dwell",
)  # fmt: skip
_ALL = AXES + CUTTER_AXIS
#: What may turn without end.
_TURNING = "A" + CUTTER_AXIS
_HALF_RESOLUTION_DEG = 5e-7
_LARGEST_COORDINATE = 1e6
#: Radius [mm] at which one degree is one millimetre: what F means for a rotary axis of FGROUP.
_DEGREE_IS_MM = 180.0 / math.pi


class Row(NamedTuple):
    """One motion block that ends at a known position of five axes, and of C or NaN; degrees, A and C counted on."""

    position: tuple[float, ...]
    rapid: bool
    tool: str
    line: int
    seconds: float
    spindle_on: bool
    measuring: bool
    cutter: float


@dataclass
class Latch:
    """What a MEAS block left behind: machine and work positions by axis, and whether the probe triggered."""

    machine: dict[str, float]
    work: dict[str, float]
    triggered: bool
    synchronised: bool = False


@dataclass
class Control:
    """What is in force while the program runs."""

    name: str
    probe: Probe | None = None
    modal: dict[str, str] = field(default_factory=dict)
    position: dict[str, float] = field(default_factory=dict)
    shift: dict[str, float] = field(default_factory=dict)
    feed: float | None = None
    feed_axes: str = ""
    feed_radius: dict[str, float] = field(default_factory=lambda: {"A": _DEGREE_IS_MM, "B": _DEGREE_IS_MM})
    counting: dict[str, bool] = field(default_factory=dict)
    speed_known: bool = False
    selected: str | None = None
    tool: str | None = None
    edge: bool = False
    ended: bool = False
    latch: Latch | None = None

    @property
    def spindle_on(self) -> bool:
        return self.modal.get("spindle") in ("M3", "M4")

    def run(self, block: Block, number: Number) -> Row | None:
        """Let one block act; the row of the path if it moves to a position that is known."""
        words = block.words
        if self.ended:
            refuse(self.name, block.line, 1, "there is a block after M30")
        if "feed mode" in words and words["feed mode"].text != self.modal.get("feed mode"):
            self.feed = None  # the number meant something else
        if "T" in words:
            self.selected, self.edge = words["T"].text, False
        for key, word in words.items():
            self._switch(key, word, block, number)
        if "tool change" in words:
            self._change_tool(block)
        if "spindle" in words and self.spindle_on and not self.speed_known:
            self._refuse(block, "spindle", f"{words['spindle'].text} without a spindle speed S")
        if self.modal.get("compressor") == "COMPCAD" and self.modal.get("feed mode") == "G93":
            self._refuse(
                block,
                "compressor" if "compressor" in words else "feed mode",
                "COMPCAD and G93 at once: a block made of several would take the time of the last one",
            )
        self.ended = "program end" in words
        if any(axis in words for axis in _ALL):
            return self._move(block, number)
        if "MEAS" in words or "frame suppression" in words:
            key = "MEAS" if "MEAS" in words else "frame suppression"
            self._refuse(block, key, f"{words[key].text} without axis words")
        return None

    def _refuse(self, block: Block, key: str, what: str) -> NoReturn:
        refuse(self.name, block.line, block.words[key].column, what)

    def _switch(self, key: str, word: Word, block: Block, number: Number) -> None:
        """Put one word in force."""
        value = number(word.value, word.column) if key in ("F", "S", "D", "SPOS", "ADIS", "ADISPOS", "MEAS") else 0.0
        if key in ("F", "S") and value <= 0.0:
            self._refuse(block, key, f"{word.text}: must be greater than 0")
        if key == "F":
            self.feed = self.feed if "dwell" in block.words else value
        elif key == "S":
            self.speed_known = True
        elif key == "D":
            if value != 1.0:
                self._refuse(block, key, f"{word.text}: only the cutting edge D1 is understood")
            self.edge = True
        elif key == "SPOS":
            self.modal["spindle"] = "SPOS"
            self.position.pop(CUTTER_AXIS, None)
        elif key == "MEAS" and value != 1.0:
            self._refuse(block, key, f"{word.text}: only MEAS=1, the rising edge of probe 1, is understood")
        elif key == "dwell" and "F" not in block.words:
            self._refuse(block, key, "G4 without a time F")
        elif key.startswith("FGREF"):
            self.feed_radius[key[-1]] = number(word.value, word.column)
        elif key == "work offset" and self.modal.get(key, word.text) != word.text:
            self._refuse(block, key, f"{word.text} after {self.modal[key]}: one work offset is understood")
        elif key in _GROUPS:
            self.modal[key] = word.text
            if key == "spindle":
                self.position.pop(CUTTER_AXIS, None)

    def _change_tool(self, block: Block) -> None:
        """M6 fetches the selected tool and leaves the axes wherever the change takes place."""
        if self.selected is None:
            self._refuse(block, "tool change", "M6 without a tool: T is missing")
        if self.spindle_on:
            self._refuse(block, "tool change", "M6 with the spindle on")
        self.tool = self.selected
        self.modal.pop("spindle", None)
        self.position.clear()

    def _move(self, block: Block, number: Number) -> Row | None:
        """The motion of one block; None while the position of an axis is still unknown."""
        name, line, words = self.name, block.line, block.words
        column = min(words[axis].column for axis in _ALL if axis in words)
        for key in _NOT_WITH_MOTION:
            if key in words:
                self._refuse(block, key, f"{words[key].text} and axis words in one block")
        for group, example in _NEEDED_FOR_MOTION.items():
            if group not in self.modal:
                refuse(name, line, column, f"motion before the {group} is stated ({example})")
        if self.tool is None or self.tool != self.selected or not self.edge:
            refuse(name, line, column, 'motion without a tool: T="..." D1 and M6 must come first')
        if "motion" not in self.modal:
            refuse(name, line, column, "axis words without G0 or G1")
        if CUTTER_AXIS in words and self.modal.get("spindle") != "SPOS":
            self._refuse(block, CUTTER_AXIS, f"{words[CUTTER_AXIS].text}: C is an axis only after SPOS")
        before, rapid = dict(self.position), self.modal["motion"] == "G0"
        for axis in _ALL:
            if axis in words:
                self.position[axis] = self._target(axis, block, number(words[axis].value, words[axis].column), rapid)
        seconds = 0.0 if rapid else self._cutting_seconds(block, before, column, number)
        if "MEAS" in words:
            self._measure(block, before)
        if any(axis not in self.position for axis in AXES):
            return None
        position, cutter = tuple(self.position[axis] for axis in AXES), self.position.get(CUTTER_AXIS, math.nan)
        return Row(position, rapid, self.tool, line, seconds, self.spindle_on, "MEAS" in words, cutter)

    def _target(self, axis: str, block: Block, value: float, rapid: bool) -> float:
        """Where an axis word takes its axis, in machine coordinates, A counted on."""
        word, now = block.words[axis], self.position.get(axis)
        if word.way == "IC":
            if now is None:
                self._refuse(block, axis, f"{word.text} from an unknown position")
            target = now + value
        elif word.way in ("", "AC"):
            if axis in _TURNING:
                self._count(block, axis, True)
            target = value + (0.0 if "frame suppression" in block.words else self.shift.get(axis, 0.0))
        else:
            return self._turned(axis, block, value, now, rapid)
        if not abs(target) <= _LARGEST_COORDINATE:
            self._refuse(block, axis, f"{word.text} leads to {target:g}: no axis is that long")
        return target

    def _turned(self, axis: str, block: Block, value: float, now: float | None, rapid: bool) -> float:
        """The position to which DC, ACP or ACN turn a modulo axis."""
        word = block.words[axis]
        if axis not in _TURNING:
            self._refuse(block, axis, f"{word.text}: only A and C turn without end")
        self._count(block, axis, False)
        if not 0.0 <= value < 360.0:
            self._refuse(block, axis, f"{word.text} is out of range: {word.way} takes 0 to less than 360 degrees")
        if now is None:
            return value
        turns = (now - value) / 360.0
        if word.way == "DC":
            if abs(abs(turns - math.floor(turns)) - 0.5) < _HALF_RESOLUTION_DEG / 360.0 and not rapid:
                self._refuse(block, axis, f"{axis} turns by exactly 180 degrees: DC leaves the direction open")
            return value + 360.0 * round(turns)
        near = _HALF_RESOLUTION_DEG / 360.0
        return value + 360.0 * (math.ceil(turns - near) if word.way == "ACP" else math.floor(turns + near))

    def _count(self, block: Block, axis: str, counting: bool) -> None:
        """A is either counted on or taken modulo 360 degrees, and so is C; a program that does both means two axes."""
        if self.counting.setdefault(axis, counting) is not counting:
            text = block.words[axis].text
            self._refuse(block, axis, f"{text}: {axis} is counted on in one block and modulo in another")

    def _cutting_seconds(self, block: Block, before: dict[str, float], column: int, number: Number) -> float:
        """Duration of a G1 block [s]: 60/F with G93, length of the path / F with G94."""
        name, line = self.name, block.line
        if self.modal.get("spindle", "M5") == "M5":
            refuse(name, line, column, "cutting move with the spindle off")
        needed = _ALL if CUTTER_AXIS in block.words else AXES
        unknown = [axis for axis in needed if axis not in before]
        if unknown:
            refuse(name, line, column, f"cutting move from an unknown position of {' '.join(unknown)}")
        mode = self.modal.get("feed mode")
        if mode is None:
            refuse(name, line, column, "cutting move before G93 or G94")
        if mode == "G93":
            if "F" not in block.words:
                refuse(name, line, column, "F is missing: every G93 block needs its own")
            return 60.0 / number(block.words["F"].value, block.words["F"].column)
        if self.feed is None:
            refuse(name, line, column, "cutting move without a feed F")
        steps = {axis: self.position[axis] - before[axis] for axis in AXES}
        if self.position.get(CUTTER_AXIS) != before.get(CUTTER_AXIS):
            refuse(name, line, column, "G94 with C turning: write such a block with G93")
        for axis in "AB":
            # what F means then depends on FGROUP
            if steps[axis] and axis not in self.feed_axes:
                refuse(name, line, column, f"G94 with {axis} turning: write such a block with G93, or FGROUP before it")
            steps[axis] *= self.feed_radius[axis] / _DEGREE_IS_MM
        length = math.hypot(*(steps[axis] for axis in AXES if axis in (self.feed_axes or AXES)))
        return 60.0 * length / self.feed

    def _measure(self, block: Block, before: dict[str, float]) -> None:
        """Move the probe; where it triggers, the axes stop, and those of the block are latched."""
        if self.modal["motion"] != "G1" or any(axis not in before for axis in AXES):
            self._refuse(block, "MEAS", "MEAS=1 needs G1, and a known position to start from")
        if self.modal["spindle"] != "SPOS":
            self._refuse(block, "MEAS", "MEAS=1 needs a spindle that is held by SPOS")
        if self.probe is None:
            self._refuse(block, "MEAS", "MEAS=1: there is no probe that could touch anything")
        start, end = (np.array([where[axis] for axis in AXES]) for where in (before, self.position))
        start[3:], end[3:] = np.radians(start[3:]), np.radians(end[3:])
        touched = self.probe(start, end)
        if touched is not None:
            stopped = [*touched[:3].tolist(), *np.degrees(touched[3:]).tolist()]
            self.position |= dict(zip(AXES, stopped, strict=True))
        machine = {axis: self.position[axis] for axis in AXES if axis in block.words}
        if "A" in machine and not self.counting.get("A"):
            machine["A"] %= 360.0
        work = {axis: value - self.shift.get(axis, 0.0) for axis, value in machine.items()}
        self.latch = Latch(machine, work, touched is not None)
