"""The words of LinuxCNC: numbers, comments, parameters, conditions, and what every program begins and ends with.

A counts on: it is no WRAPPED_ROTARY axis, which would turn almost a full turn wherever its value falls. Blocks have
neither numbers nor modulo words. What the program can ask the control it compares with the machine file; it does so
only where the program moves a machine (``#<_task>`` is 1), and not where a preview draws it.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field, replace

from gearmath.machine.planning.clear_space import Room
from gearmath.machine.writing import words
from gearmath.machine.writing.words import Positions
from gearmath.specs.milling_machine import AXES, MillingMachine

#: Parameters that choose the parts of a program, from 1; 0 for all. They are the R90 and R91 of the other dialect.
FIRST, LAST = "#3090", "#3091"
#: What a zero offset, and a tool length in the table that should be as the machine file has it, may differ by. [mm]
_SAME, _SAME_LENGTH = 0.0005, 1.0
_OFFSETS = {"G54": 5221, "G55": 5241, "G56": 5261, "G57": 5281}
_TASK = "#<_task> EQ 1"


@dataclass
class Dialect:
    """Writes the words of one program for one machine; counts the numbers of its O-words."""

    name: str
    machine: MillingMachine
    length: float
    """Gauge line to the tip of the tool or probe [mm]."""
    positions: Positions = field(init=False)
    _conditions: int = 0

    def __post_init__(self) -> None:
        words.check_name(self.name)
        self.positions = replace(Positions.of(self.machine, self.length), modulo=False, turning_cutter=False)

    def text(self, header: Iterable[str], body: Iterable[str]) -> str:
        """The program with a header of comments."""
        lines = [words.comment(self.name, words.plain(text)) for text in (self.name, *header)]
        return "\n".join([*lines, *body]) + "\n"

    def when(self, condition: str, body: Iterable[str], otherwise: Iterable[str] = ()) -> Iterator[str]:
        """A condition with what is done where it holds, and where it does not."""
        self._conditions += 1
        number = 100 + self._conditions
        yield f"o{number} if [{condition}]"
        yield from body
        rest = list(otherwise)
        if rest:
            yield f"o{number} else"
            yield from rest
        yield f"o{number} endif"

    def moving(self, condition: str, body: Iterable[str]) -> Iterator[str]:
        """The same, but only where the program moves a machine."""
        yield from self.when(f"[{_TASK}] AND [{condition}]", body)

    def stop(self, why: str) -> Iterator[str]:
        """The end of the program with a message: spindle off, nothing moves any more. Parameters are shown by value."""
        yield f"(ABORT, {why})"

    @property
    def path_mode(self) -> str:
        """Exact path, or continuous within the tolerance; Q0: no blocks are merged."""
        control = self.machine.control
        if control.path_mode == "G60":
            return "G61"
        return f"G64 P{control.path_tolerance[0]:.6f} Q0"

    def modal(self) -> str:
        """The block that states plane, compensation, dimensions, feed, units and work offset."""
        return f"G17 G40 G90 G94 G21 {self.machine.work_offset}"

    def head(self) -> Iterator[str]:
        """Every modal state that acts on the path, none inherited: canned cycles, G92 and tool length off."""
        yield self.modal()
        yield "G80 G92.2"
        yield "G97"
        yield "G49"
        yield self.path_mode

    def checks(self) -> Iterator[str]:
        """Zero offset and rotation as the machine file has them, and A without wrapping."""
        first = _OFFSETS[self.machine.work_offset]
        values = list(zip(AXES, self.machine.work_offset_values, strict=True))
        differs = " OR ".join(f"[ABS[#{first + k}{-value:+.5f}] GT {_SAME}]" for k, (_, value) in enumerate(values))
        wanted = " ".join(f"{axis}{value:g}" for axis, value in values)
        offset = self.machine.work_offset
        yield from self.moving(differs, self.stop(f"{offset} must be {wanted}"))
        yield from self.moving(f"#{first + 9} NE 0", self.stop(f"{offset} must not turn"))
        for axis in "AB":
            wrapped = f"#<_ini[AXIS_{axis}]WRAPPED_ROTARY>"
            turns = self.when(f"{wrapped} NE 0", self.stop(f"AXIS_{axis} must not be WRAPPED_ROTARY"))
            yield from self.moving(f"EXISTS[{wrapped}]", turns)

    def enough_height(self, room: Room, radius: float) -> Iterator[str]:
        """Stops where the tool may stand under the work: its tip below the top of it, and not in front of or beside it.

        The tool in the spindle is as long as the tool table says, or as the one that is meant, if that is longer.
        """
        level = self.machine.gauge_line_height + room.top
        yield "G43"
        low = f"[[#5422 LT {level:.3f}] OR [[#5422 + #5403] LT {level + self.length:.3f}]]"
        near = f"[#5420 LT {room.front + radius:.3f}] AND [ABS[#5421] LT {room.half + radius:.3f}]"
        why = f"Z is below {level + self.length:.0f}: raise Z by hand, the tool may be under the work"
        yield from self.moving(f"{low} AND {near}", self.stop(why))
        yield "G49"

    def asked(self, count: int, part: str) -> Iterator[str]:
        """Stops for parts that there are not; waits for the operator where not all of the ``count`` are to be run."""
        wrong = (
            f"[{FIRST} LT 0] OR [{LAST} LT 0] OR [{FIRST} GT {count}] OR [{LAST} GT {count}] OR "
            f"[[{LAST} GT 0] AND [{FIRST} GT {LAST}]]"
        )
        yield from self.when(wrong, self.stop(f"parameters 3090 and 3091: first and last {part}: 1 to {count}, or 0"))
        chosen = f"[{FIRST} GT 0] OR [{LAST} GT 0]"
        said = f"(DEBUG, only {part}s {FIRST} to {LAST} of {count}, 0 for open: resume goes on)"
        yield from self.moving(chosen, (said, "M0"))

    def if_chosen(self, first: int, last: int, body: Iterable[str]) -> Iterator[str]:
        """What is done where one of the parts from ``first`` to ``last`` is to be run."""
        yield from self.when(f"[{FIRST} LE {last}] AND [[{LAST} EQ 0] OR [{LAST} GE {first}]]", body)

    def retract(self) -> Iterator[str]:
        """Z up to its home in machine coordinates: no offset, no tool length."""
        yield "G49"
        home = self.machine.home + self.machine.work_offset_values[2]
        yield f"G53 G0 {replace(self.positions, length=0.0).word('Z', home)}"

    def fetch(self, tool: str, number: int) -> Iterator[str]:
        """Tool change, and the tool that is in the spindle then compared with the one that is meant."""
        yield f"T{number} M6"
        yield from self.moving(f"#5400 NE {number}", self.stop(f"the tool in the spindle is not T{number}, {tool}"))
        tip = self.machine.z_reference == "tip"
        wanted, near = (self.length, _SAME_LENGTH) if tip else (0.0, _SAME)
        yield "G43"
        why = f"Z of T{number}, {tool}, in the tool table must be {wanted:g}"
        yield from self.moving(f"ABS[#5403{-wanted:+.5f}] GT {near}", self.stop(why))
        yield from self.retract()
        yield "G43"

    def end(self) -> Iterator[str]:
        """All parts again next time, spindle and coolant off, Z home, end."""
        yield f"{FIRST}=0 {LAST}=0"
        yield "M5 M9"
        yield from self.retract()
        yield "M2"


def block_count(text: str) -> int:
    """How many blocks a program has: lines that are no comments, and not the % of a tape."""
    return sum(not line.startswith((";", "(", "%")) for line in text.splitlines())


def message(text: str) -> str:
    """A message to the operator; brackets would end it."""
    return f"(MSG, {words.plain(text).translate(str.maketrans('()', '[]'))})"
