"""What is in force while an NC program runs, and what one block of it moves."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import NamedTuple, NoReturn

import numpy as np

from gearmath.machine.control.expression import AXES, CUTTER_AXIS, Node, refuse
from gearmath.machine.control.reader import GROUP_OF_CODE
from gearmath.machine.control.tree import Block, Word
from gearmath.specs.milling_machine import MillingMachine

#: Moves the probe from one position of X Y Z A B to another, (5,) mm and rad: where it triggers, or None.
Probe = Callable[[np.ndarray, np.ndarray], np.ndarray | None]
#: Whether the probe is deflected at a position of X Y Z A B, (5,) mm and rad.
Deflected = Callable[[np.ndarray], bool]
#: Hears of every position of X Y Z A B, (5,) mm and rad, to which the axes move.
Follower = Callable[[np.ndarray], object]
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
#: What a program must say before its first motion, or else it depends on what ran before.
STATED = {
    "stop mode": "path mode (G60 or G642)", "acceleration": "SOFT or BRISK", "feed forward": "FFWON or FFWOF",
    "transformation": "TRAFOOF", "compressor": "COMPOF", "diameter programming": "DIAMOF", "frames": "TRANS",
    "path axes": "FGROUP", "OVR": "OVR", "OVRRAP": "OVRRAP",
    **{f"ACC {axis}": f"ACC[{axis}]" for axis in AXES},
}  # fmt: skip
#: And what with a path mode that rounds corners.
WITHIN = {"CTOL": "CTOL", "OTOL": "OTOL"}
_VALUED = ("F", "S", "D", "SPOS", "ADIS", "ADISPOS", "MEAS", "CTOL", "OTOL")
_ALL = AXES + CUTTER_AXIS
#: The tool that is a probe, by the name that probing programs give it.
PROBE_TOOL = "PROBE"
#: What may turn without end.
_TURNING = "A" + CUTTER_AXIS
_HALF_RESOLUTION_DEG = 5e-7
_LARGEST_COORDINATE = 1e6
#: Radius [mm] at which one degree is one millimetre: what F means for a rotary axis of FGROUP.
_DEGREE_IS_MM = 180.0 / math.pi


@dataclass(frozen=True)
class Setup:
    """How the control stands before a program starts: what its tables hold, and where the axes are.

    ``zero`` are the machine coordinates of the point that positions here count from, ``offset`` what the work offset
    and all frames hold, X Y Z A B in mm and degrees: on a control that is set up right they are the same. Lengths are
    those of the tool table [mm]. ``position`` are the axes where they are known, by machine coordinates, and
    ``tool`` is what is in the spindle.
    """

    zero: tuple[float, ...] = (0.0,) * 5
    offset: tuple[float, ...] = (0.0,) * 5
    tool_length: float = 0.0
    probe_length: float = 0.0
    turned: tuple[float, float, float] = (0.0,) * 3
    mirrored: tuple[float, float, float] = (0.0,) * 3
    scaled: tuple[float, float, float] = (1.0,) * 3
    """What all frames together do beside shifting, about and along X Y Z."""
    work_offset: str | None = None
    """The one that the machine file counts from, if it matters."""
    metric: bool = True
    increments: tuple[float, float] = (1e9, 1e9)
    result_file_kB: float = 1e6
    """What a file of WRITE may hold, MD11420 $MN_LEN_PROTOCOL_FILE."""
    position: tuple[float, ...] | None = None
    tool: str | None = None
    changed_at: tuple[float, ...] | None = None
    """Where the axes stand after a tool change, if that is known."""
    spindle_tool: Callable[[str], str] = lambda wanted: wanted
    """What is in the spindle after a tool change."""

    @staticmethod
    def of(machine: MillingMachine, probe_length: float = 0.0) -> Setup:
        """The tables as the machine file wants them."""
        tip = machine.z_reference == "tip"
        values = machine.work_offset_values
        return Setup(
            values, values, machine.tool_length if tip else 0.0, probe_length if tip else 0.0,
            work_offset=machine.work_offset, result_file_kB=machine.control.result_file_kB or Setup.result_file_kB,
        )  # fmt: skip

    def length(self, tool: str | None) -> float:
        """Length 1 of a tool in the table [mm]."""
        if tool is None:
            return 0.0
        return self.probe_length if tool == PROBE_TOOL else self.tool_length


class Row(NamedTuple):
    """One motion block that ends at a known position of five axes, and of C or NaN; degrees, A and C counted on.

    ``rpm`` is the speed of the spindle, negative with M4, 0 where it stands or is an axis.
    """

    position: tuple[float, ...]
    rapid: bool
    tool: str
    line: int
    seconds: float
    rpm: float
    measuring: bool
    cutter: float


class Blind(NamedTuple):
    """A motion block while the position of an axis was unknown: whether Z alone went, with all offsets off, and the Z
    after it."""

    line: int
    raised: bool
    z: float | None


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
    setup: Setup = Setup()
    modal: dict[str, str] = field(default_factory=dict)
    position: dict[str, float] = field(default_factory=dict)
    shift: dict[str, float] = field(default_factory=dict)
    feed: float | None = None
    feed_axes: str = ""
    feed_radius: dict[str, float] = field(default_factory=lambda: {"A": _DEGREE_IS_MM, "B": _DEGREE_IS_MM})
    counting: dict[str, bool] = field(default_factory=dict)
    speed: float | None = None
    unstated: tuple[str, ...] | None = None
    """What had not been said of ``STATED`` when the axes first moved."""
    selected: str | None = None
    tool: str | None = None
    edge: bool = False
    fetched: str | None = None
    """What is in the spindle; ``tool`` is what the program asked for."""
    ended: bool = False
    latch: Latch | None = None
    within: dict[str, float] = field(default_factory=dict)
    """CTOL and OTOL, mm and degrees."""
    blind: list[Blind] = field(default_factory=list)
    path_modes: dict[tuple[str, float, float], int] = field(default_factory=dict)
    dynamics: dict[tuple[str, str], int] = field(default_factory=dict)
    """Path modes in which feed blocks run, with CTOL and OTOL, and the line of the first."""

    def __post_init__(self) -> None:
        self.tool = self.fetched = self.setup.tool
        self._stand(self.setup.position)

    def _stand(self, position: tuple[float, ...] | None) -> None:
        """The axes at machine coordinates, or wherever they are."""
        self.position.clear()
        if position is not None:
            self.position |= {a: p - z for a, p, z in zip(AXES, position, self.setup.zero, strict=True)}

    @property
    def length(self) -> float:
        """What the tool table adds to Z now [mm]."""
        return self.setup.length(self.tool) if self.edge else 0.0

    @property
    def frame(self) -> dict[str, float]:
        """What all frames together add to a programmed position of each axis, by machine coordinates."""
        return {axis: by + self.shift.get(axis, 0.0) for axis, by in zip(AXES, self.setup.offset, strict=True)}

    def frame_part(self, axis: str, part: str) -> float:
        """One part of all frames together: TR shift, RT rotation, MI mirroring, SC scale."""
        if part == "TR":
            return self.frame[axis]
        values = {"RT": self.setup.turned, "MI": self.setup.mirrored, "SC": self.setup.scaled}[part]
        return values["XYZ".index(axis)]

    @property
    def spindle_on(self) -> bool:
        return self.modal.get("spindle") in ("M3", "M4")

    @property
    def rpm(self) -> float:
        """Speed of the spindle, negative with M4."""
        if not self.spindle_on or self.speed is None:
            return 0.0
        return self.speed if self.modal["spindle"] == "M3" else -self.speed

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
        if "spindle" in words and self.spindle_on and self.speed is None:
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
        value = number(word.value, word.column) if key in _VALUED else 0.0
        if key in ("F", "S") and value <= 0.0:
            self._refuse(block, key, f"{word.text}: must be greater than 0")
        if key == "F":
            self.feed = self.feed if "dwell" in block.words else value
        elif key == "S":
            self.speed = value
        elif key == "D":
            if value not in (0.0, 1.0):
                self._refuse(block, key, f"{word.text}: only the cutting edge D1, and D0 for none, are understood")
            self.edge = value == 1.0
        elif key == "SPOS":
            self.modal["spindle"] = "SPOS"
            self.position.pop(CUTTER_AXIS, None)
        elif key == "MEAS" and value != 1.0:
            self._refuse(block, key, f"{word.text}: only MEAS=1, the rising edge of probe 1, is understood")
        elif key == "dwell" and "F" not in block.words:
            self._refuse(block, key, "G4 without a time F")
        elif key in ("OVR", "OVRRAP") or key.startswith("ACC "):
            if number(word.value, word.column) != 100.0:
                self._refuse(block, key, f"{word.text}: only 100 percent is understood")
            self.modal[key] = word.text
        elif key in ("CTOL", "OTOL"):
            if value <= 0.0:
                self._refuse(block, key, f"{word.text}: must be greater than 0")
            self.modal[key] = word.text
            self.within[key] = value
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
        self.tool, self.fetched = self.selected, self.setup.spindle_tool(self.selected)
        self.modal.pop("spindle", None)
        self._stand(self.setup.changed_at)

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
        raised = "frame suppression" in words and not self.edge and [a for a in _ALL if a in words] == ["Z"]
        if not raised and (self.tool is None or self.tool != self.selected or not self.edge):
            refuse(name, line, column, 'motion without a tool: T="..." D1 and M6 must come first')
        if "motion" not in self.modal:
            refuse(name, line, column, "axis words without G0 or G1")
        if self.setup.work_offset not in (None, self.modal["work offset"]):
            what = f"{self.modal['work offset']} is active, the machine file counts from {self.setup.work_offset}"
            refuse(name, line, column, what)
        if self.unstated is None:
            stated = STATED | (WITHIN if self.modal.get("stop mode") == "G642" else {})
            self.unstated = tuple(words for group, words in stated.items() if group not in self.modal)
        if CUTTER_AXIS in words and self.modal.get("spindle") != "SPOS":
            self._refuse(block, CUTTER_AXIS, f"{words[CUTTER_AXIS].text}: C is an axis only after SPOS")
        before, rapid = dict(self.position), self.modal["motion"] == "G0"
        for axis in _ALL:
            if axis in words:
                self.position[axis] = self._target(axis, block, number(words[axis].value, words[axis].column), rapid)
        seconds = 0.0 if rapid else self._cutting_seconds(block, before, column, number)
        if "MEAS" in words:
            self._measure(block, before)
        if any(axis not in before for axis in AXES):
            self.blind.append(Blind(line, raised and rapid, self.position.get("Z")))
        if not rapid:
            mode = self.modal.get("stop mode", ""), self.within.get("CTOL", 0.0), self.within.get("OTOL", 0.0)
            self.path_modes.setdefault(mode, line)
            self.dynamics.setdefault((self.modal.get("acceleration", ""), self.modal.get("feed forward", "")), line)
        if any(axis not in self.position for axis in AXES):
            return None
        if self.tool is None:
            return None
        position, cutter = tuple(self.position[axis] for axis in AXES), self.position.get(CUTTER_AXIS, math.nan)
        return Row(position, rapid, self.tool or "", line, seconds, self.rpm, "MEAS" in words, cutter)

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
            target = value + self._from_zero(axis, "frame suppression" in block.words)
        else:
            return self._turned(axis, block, value, now, rapid) + self._from_zero(axis, False)
        if not abs(target) <= _LARGEST_COORDINATE:
            self._refuse(block, axis, f"{word.text} leads to {target:g}: no axis is that long")
        return target

    def _from_zero(self, axis: str, suppressed: bool) -> float:
        """What is added to a programmed position of an axis: frames, and for Z the length of the tool."""
        if axis not in AXES:
            return 0.0
        zero = self.setup.zero[AXES.index(axis)]
        length = self.length if axis == "Z" else 0.0
        return length - zero + (0.0 if suppressed else self.frame[axis])

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
        zero = dict(zip(AXES, self.setup.zero, strict=True))
        machine = {axis: self.position[axis] + zero[axis] for axis in AXES if axis in block.words}
        if "A" in machine and not self.counting.get("A"):
            machine["A"] %= 360.0
        frame = self.frame | {"Z": self.frame["Z"] + self.length}
        work = {axis: value - frame[axis] for axis, value in machine.items()}
        self.latch = Latch(machine, work, touched is not None)
