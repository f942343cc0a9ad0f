"""How a control stands: its tables before a program starts, and what is in force while it runs."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import NamedTuple, NoReturn

import numpy as np

from gearmath.machine.control.expression import AXES, CUTTER_AXIS, Node, refuse
from gearmath.machine.control.polynomial import INTERVAL
from gearmath.machine.control.tree import Block, Word
from gearmath.machine.control.vocabulary import GROUP_OF_CODE
from gearmath.specs.milling_machine import MillingMachine
from gearmath.specs.ratio import RADIAN

#: Moves the probe from one position of X Y Z A B to another, (5,) mm and rad: where it triggers, or None.
Probe = Callable[[np.ndarray, np.ndarray], np.ndarray | None]
#: Whether the probe is deflected at a position of X Y Z A B, (5,) mm and rad.
Deflected = Callable[[np.ndarray], bool]
#: Hears of every position of X Y Z A B, (5,) mm and rad, to which the axes move.
Follower = Callable[[np.ndarray], object]
#: The tool that is a probe, by the name that probing programs give it.
PROBE_TOOL = "PROBE"
Number = Callable[[Node, int], float]

_GROUPS = frozenset(GROUP_OF_CODE.values())
#: Axis words are put in force by the motion.
_MOVED = frozenset(AXES + CUTTER_AXIS)
_VALUED = ("F", "S", "D", "SPOS", "ADIS", "ADISPOS", "MEAS", "CTOL", "OTOL", "PL")
#: Radius [mm] at which one degree is one millimetre: what F means for a rotary axis of FGROUP.
DEGREE_IS_MM = RADIAN


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
            values,
            values,
            machine.tool_length if tip else 0.0,
            probe_length if tip else 0.0,
            work_offset=machine.work_offset,
            increments=(machine.control.increments_per_mm, machine.control.increments_per_degree),
            result_file_kB=machine.control.result_file_kB or Setup.result_file_kB,
        )

    def length(self, tool: str | None) -> float:
        """Length 1 of a tool in the table [mm]."""
        if tool is None:
            return 0.0
        return self.probe_length if tool == PROBE_TOOL else self.tool_length


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
class State:
    """What is in force while the program runs, and where the axes stand."""

    name: str
    probe: Probe | None = None
    setup: Setup = Setup()
    modal: dict[str, str] = field(default_factory=dict)
    position: dict[str, float] = field(default_factory=dict)
    shift: dict[str, float] = field(default_factory=dict)
    feed: float | None = None
    feed_axes: str = ""
    feed_radius: dict[str, float] = field(default_factory=lambda: dict.fromkeys("ABC", DEGREE_IS_MM))
    counting: dict[str, bool] = field(default_factory=dict)
    turns: dict[str, float] = field(default_factory=dict)
    """By how much the position of an axis is more than the number that DC, ACP or ACN last gave it: whole turns."""
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
    changes: list[tuple[int, float | None]] = field(default_factory=list)
    """Lines of tool changes, and the Z at which the axes stood."""
    path_modes: dict[tuple[str, float, float], int] = field(default_factory=dict)
    """Path modes in which feed blocks run, with CTOL and OTOL, and the line of the first."""
    dynamics: dict[tuple[str, str], int] = field(default_factory=dict)
    """The same for acceleration and feed forward."""

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

    def frame(self, axis: str) -> float:
        """What all frames together add to a programmed position of an axis, in machine coordinates."""
        return self.setup.offset[AXES.index(axis)] + self.shift.get(axis, 0.0)

    def frame_part(self, axis: str, part: str) -> float:
        """One part of all frames together: TR shift, RT rotation, MI mirroring, SC scale."""
        if part == "TR":
            return self.frame(axis)
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

    def _refuse(self, block: Block, key: str, what: str) -> NoReturn:
        refuse(self.name, block.line, block.words[key].column, what)

    def _switch(self, key: str, word: Word, block: Block, number: Number) -> None:
        """Put one word in force."""
        if key in _MOVED:
            return
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
        elif key == "PL" and not INTERVAL[0] <= value <= INTERVAL[1]:
            self._refuse(block, key, f"{word.text}: must lie between {INTERVAL[0]:g} and {INTERVAL[1]:.4f}")
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
        self.changes.append((block.line, self.position.get("Z")))
        self.tool, self.fetched = self.selected, self.setup.spindle_tool(self.selected)
        self.modal.pop("spindle", None)
        self._stand(self.setup.changed_at)
