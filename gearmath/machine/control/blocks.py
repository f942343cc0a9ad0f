"""What one block of an NC program moves, with all that is in force."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from gearmath.machine.control.expression import AXES, CUTTER_AXIS, refuse
from gearmath.machine.control.polynomial import followed, polynomials
from gearmath.machine.control.state import DEGREE_IS_MM, Blind, Latch, Number, State
from gearmath.machine.control.tree import Block

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
    "spindle",
    "SPOS",
    "tool change",
    "coolant",
    "program stop",
    "program end",
    "T",
    "D",
    "S",
    "compressor",
    "dwell",
)
#: What a program must say before its first motion, or else it depends on what ran before.
STATED = {
    "stop mode": "path mode (G60 or G642)",
    "acceleration": "SOFT or BRISK",
    "feed forward": "FFWON or FFWOF",
    "transformation": "TRAFOOF",
    "compressor": "COMPOF",
    "diameter programming": "DIAMOF",
    "frames": "TRANS",
    "path axes": "FGROUP",
    "OVR": "OVR",
    "OVRRAP": "OVRRAP",
    **{f"ACC {axis}": f"ACC[{axis}]" for axis in AXES},
}
#: And what with a path mode that rounds corners.
WITHIN = {"CTOL": "CTOL", "OTOL": "OTOL"}
_ALL = AXES + CUTTER_AXIS
#: What may turn without end.
_TURNING = "A" + CUTTER_AXIS
_HALF_RESOLUTION_DEG = 5e-7
#: Through which PO of a modulo axis may count on [unconfirmed].
_TURN = 360.0
_LARGEST_COORDINATE = 1e6


class PathRow(NamedTuple):
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
    coolant: bool
    inner: bool = False
    """Whether the row ends within a block of POLY."""
    way: tuple[tuple[float, ...], ...] = ()
    """Of a block of POLY: the ends of the straight parts in which it is followed, degrees, the last one left out;
    with a sixth value where C is an axis."""
    shares: tuple[float, ...] = ()
    """And the part of the time that each of them takes."""

    def parts(self) -> Iterator[PathRow]:
        """The rows in which a block is followed: itself, where it is straight."""
        whole = self._replace(way=(), shares=())
        for position, share in zip(self.way, self.shares, strict=False):
            cutter = position[len(AXES)] if len(position) > len(AXES) else self.cutter
            yield whole._replace(
                position=position[: len(AXES)], cutter=cutter, seconds=share * self.seconds, inner=True
            )
        yield whole._replace(seconds=self.shares[-1] * self.seconds) if self.shares else whole


class ControlState(State):
    """A control that runs blocks, one after the other."""

    def run(self, block: Block, number: Number) -> PathRow | None:
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

    def _move(self, block: Block, number: Number) -> PathRow | None:
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
        way, lengths = self._curve(block, before, number)
        seconds = 0.0 if rapid else self._cutting_seconds(block, before, column, number, lengths)
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
        return PathRow(
            position,
            rapid,
            self.tool or "",
            line,
            seconds,
            self.rpm,
            "MEAS" in words,
            cutter,
            self.modal.get("coolant") == "M8",
            way=tuple(map(tuple, way[:-1].tolist())),
            shares=tuple((lengths / lengths.sum()).tolist()),
        )

    def _curve(self, block: Block, before: dict[str, float], number: Number) -> tuple[np.ndarray, np.ndarray]:
        """Ends (n,5), or (n,6) with C, of the straight parts of a block of polynomials, and the length (n,) of each.

        Without POLY the control drives straight to the end points, and says nothing.
        """
        words = {axis: block.words[axis] for axis in _ALL if axis in block.words}
        bent = {axis: word for axis, word in words.items() if word.coefficients}
        if self.modal["motion"] != "POLY" or not bent:
            return np.empty((0, len(AXES))), np.empty(0)
        if unknown := [axis for axis in _ALL if axis not in before and (axis in AXES or axis in words)]:
            self._refuse(block, next(iter(bent)), f"POLY from an unknown position of {' '.join(unknown)}")
        for axis, word in words.items():
            if axis not in self.feed_axes and (word.coefficients or self.position[axis] != before.get(axis)):
                what = f"{word.text} while FGROUP leaves {axis} out: what it follows depends on UPATH or SPATH"
                self._refuse(block, axis, what)
        for axis, word in words.items():
            if self.counting.get(axis) is False and abs(self.position[axis] - before[axis]) >= _TURN:
                what = f"{word.text} turns {axis} by {self.position[axis] - before[axis]:.0f} degrees"
                self._refuse(block, axis, f"{what}: whether PO of a modulo axis takes it there is not known")
        moved = _ALL if CUTTER_AXIS in before else AXES
        coefficients = {
            moved.index(axis): [number(node, word.column) for node in word.coefficients] for axis, word in bent.items()
        }
        interval = number(block.words["PL"].value, block.words["PL"].column) if "PL" in block.words else 1.0
        ends = [[where[axis] for axis in moved] for where in (before, self.position)]
        weights = [float(axis in self.feed_axes) for axis in "XYZ"]
        weights += [self.feed_radius[axis] / DEGREE_IS_MM * (axis in self.feed_axes) for axis in moved[3:]]
        return followed(polynomials(ends[0], ends[1], coefficients, interval), np.array(weights))

    def _target(self, axis: str, block: Block, value: float, rapid: bool) -> float:
        """Where an axis word takes its axis, in machine coordinates, A counted on."""
        word, now = block.words[axis], self.position.get(axis)
        if word.way == "IC":
            if now is None:
                self._refuse(block, axis, f"{word.text} from an unknown position")
            target = now + value
        elif word.way in ("", "AC", "PO"):
            if axis in _TURNING and word.way != "PO":
                self._count(block, axis, True)
            # a polynomial of a modulo axis counts on from where DC has put it [unconfirmed]
            turned = self.turns.get(axis, 0.0) if word.way == "PO" else 0.0
            target = value + turned + self._from_zero(axis, "frame suppression" in block.words)
        else:
            turned = self._turned(axis, block, value, now, rapid)
            self.turns = self.turns | {axis: 360.0 * round((turned - value) / 360.0)}
            return turned + self._from_zero(axis, False)
        if not abs(target) <= _LARGEST_COORDINATE:
            self._refuse(block, axis, f"{word.text} leads to {target:g}: no axis is that long")
        return target

    def _from_zero(self, axis: str, suppressed: bool) -> float:
        """What is added to a programmed position of an axis: frames, and for Z the length of the tool."""
        if axis not in AXES:
            return 0.0
        zero = self.setup.zero[AXES.index(axis)]
        length = self.length if axis == "Z" else 0.0
        return length - zero + (0.0 if suppressed else self.frame(axis))

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

    def _cutting_seconds(
        self, block: Block, before: dict[str, float], column: int, number: Number, lengths: np.ndarray
    ) -> float:
        """Duration of a feed block [s]: 60/F with G93, length of the path / F with G94; ``lengths`` are of a curve."""
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
            steps[axis] *= self.feed_radius[axis] / DEGREE_IS_MM
        length = math.hypot(*(steps[axis] for axis in AXES if axis in (self.feed_axes or AXES)))
        if not length and any(steps.values()):
            refuse(name, line, column, "G94 with no axis of FGROUP moving: what F means then is not known")
        return 60.0 * (float(lengths.sum()) if len(lengths) else length) / self.feed

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
        added = {axis: self.frame(axis) + (self.length if axis == "Z" else 0.0) for axis in machine}
        work = {axis: value - added[axis] for axis, value in machine.items()}
        self.latch = Latch(machine, work, touched is not None)
