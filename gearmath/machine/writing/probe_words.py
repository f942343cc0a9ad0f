"""The blocks of probing programs: guarded approach, touch with result check, result file, and the host's handshake."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from gearmath.errors import InputError
from gearmath.machine.planning.clear_space import Room
from gearmath.machine.planning.targets import POSITIONING_FEED
from gearmath.machine.writing import start, words
from gearmath.machine.writing.chosen import FIRST, LAST, asked, if_chosen
from gearmath.machine.writing.words import Positions
from gearmath.specs.milling_machine import AXES, MillingMachine
from gearmath.specs.touch_csv import COLUMNS, HELD, PLANNED

#: Alarms of these programs.
DEFLECTED, NOTHING_TOUCHED, TOUCHED_TOO_EARLY, NOT_WRITTEN, FILE_SIZE = 65000, 65001, 65002, 65003, 65004
_RESULT = "_T"
_TOOL = "PROBE"
STILL = "A=IC(0) B=IC(0)"
#: First and last part of a program that this run makes.
FROM, TO = "UFROM", "UTO"
#: Touches up to the end of each section.
_ENDS = "UENDS"
#: Characters of the longest line of a touch, with nine decimals in every position; lines of heads, and of one part
#: that is touched again.
_LONGEST_LINE, _HEADS = 125, 10
#: What DELETE reports where there was nothing to delete [unconfirmed].
_NO_SUCH_FILE = 3


@dataclass(frozen=True)
class ProbingPlan:
    """What a whole run makes: how many ``touches``, in words, and the ``parts`` that R90 and R91 choose from.

    A part has ``each`` touches, or ``ends`` says how many there are up to the end of each part.
    """

    touches: int
    said: str
    parts: int
    part: str = "point"
    each: int = 1
    ends: tuple[int, ...] = ()

    @staticmethod
    def of_sections(counts: Sequence[int]) -> ProbingPlan:
        """The plan of a calibration, whose sections have so many touches."""
        ends = tuple(itertools.accumulate(counts))
        return ProbingPlan(ends[-1], f"{ends[-1]} touches", len(counts), "section", ends=ends)


class Blocks:
    """Writes the blocks of one program, without their numbers."""

    def __init__(self, name: str, machine: MillingMachine, length: float) -> None:
        self.name, self.machine, self.probe_length = name, machine, length
        self.positions = Positions.of(machine, length)
        if len(name + _RESULT) > words.MAX_NAME_CHARACTERS:
            most = words.MAX_NAME_CHARACTERS - len(_RESULT)
            raise InputError(
                f"program name {name!r}: has {len(name)} characters, {most} are allowed: the result file adds {_RESULT}"
            )
        words.check_name(name)
        self.place = ""
        """What messages of a stop begin with, as an expression: the point that is touched."""

    @property
    def result_file(self) -> str:
        """The name of the file into which the program writes its touches."""
        return self.name + _RESULT

    def text(self, header: Sequence[str], body: Iterable[str]) -> str:
        """The program, its blocks numbered, with a header of comments."""
        return words.numbered([words.comment(self.name, words.plain(text)) for text in (self.name, *header)], body)

    def axes(self, position: np.ndarray) -> tuple[str, ...]:
        """The words of one position X Y Z A B (5,) in mm and rad."""
        return self.positions.words(position[None])[0]

    def length(self, axis: str, value: float) -> str:
        """The word of one linear axis [mm]."""
        return self.positions.z(value) if axis == "Z" else self.positions.word(axis, value)

    def number(self, value: float) -> str:
        """A number in an expression; a negative one in brackets."""
        text = f"{value:.5f}"
        return f"({text})" if value < 0 else text

    def variable(self, number: int) -> str:
        """A number that the program keeps."""
        return f"R{number}"

    def kept(self, values: Sequence[tuple[int, str]]) -> str:
        """The block that keeps numbers or expressions."""
        return " ".join(f"{self.variable(number)}={value}" for number, value in values)

    def measured(self, axis: str) -> str:
        """Where the last touch met, as an expression."""
        return self.variable(200 + AXES.index(axis))

    def middle(self, one: int, other: int) -> str:
        """The mean of two kept numbers, as an expression."""
        return f"({self.variable(one)}+{self.variable(other)})/2"

    def at(self, axis: str, number: int, off: str = "") -> str:
        """The word of an axis at a kept number, and so much ``off`` it: an expression that begins with its sign."""
        return f"{axis}={self.variable(number)}{off}"

    def start(self, plan: ProbingPlan, columns: Sequence[str] = COLUMNS, room: Room | None = None) -> Iterator[str]:
        """Head: Z home, the probe is fetched and held, the run is numbered, the result file gets its plan and columns.

        A run from the first part on opens the file anew; one that goes on with a later part adds to it, and says which
        touches it makes. Under the ``room`` of a work the probe must not stand.
        """
        machine = self.machine
        yield f"DEF INT UERR,{FROM},{TO}" + (f",{_ENDS}[{plan.parts + 1}]" if plan.ends else "")
        yield from start.head(machine)
        yield "FGROUP(X,Y,Z,A,B)"
        yield f"FGREF[A]={start.ONE_MM_A_DEGREE} FGREF[B]={start.ONE_MM_A_DEGREE}"
        yield from start.checks(machine)
        yield from self._file_size(plan)
        if room is not None:
            yield from start.enough_height(machine, room, self.probe_length, machine.cutter_head.spindle_radius)
        yield from asked(plan.parts, plan.part)
        yield f"{FROM}=1 {TO}={plan.parts}"
        for number, end in enumerate(plan.ends, 1):
            yield f"{_ENDS}[{number}]={end}"
        for chosen, bound in ((FIRST, FROM), (LAST, TO)):
            yield f"IF {chosen}>0"
            yield f"{bound}={chosen}"
            yield "ENDIF"
        yield "M5 M9"
        yield from start.retract(machine)
        yield from start.fetch(machine, _TOOL, self.probe_length)
        yield "SPOS=0"
        yield "R102=R102+1 R101=0 R103=0"
        yield from self.ready(None)
        yield f"IF {FROM}==1"
        yield f'DELETE(UERR,"{self.result_file}")'
        yield f"IF (UERR<>0) AND (UERR<>{_NO_SUCH_FILE})"
        yield from start.stop("the result file of the last run cannot be deleted", NOT_WRITTEN)
        yield "ENDIF"
        yield from self.write(f'"# {PLANNED}: {plan.said}"')
        yield f"IF ({FROM}>1) OR ({TO}<{plan.parts})"
        before, last = f"({FROM}-1)*{plan.each}", f"({TO}*{plan.each})"
        if plan.ends:
            before, last = f"{_ENDS}[{FROM}-1]", f"{_ENDS}[{TO}]"
        yield f"R101={before}"
        yield from self.write(f'"# {HELD}: "<<(R101+1)<<" to "<<{last}')
        yield "ENDIF"
        yield from self.write(f'"{",".join(columns)}"')

    def _file_size(self, plan: ProbingPlan) -> Iterator[str]:
        """Stops where the control would not take all that is written. Raises InputError where the machine file says so.

        A run that goes on adds a plan and a column line, and perhaps touches of one part that are there already.
        """
        needed = math.ceil((plan.touches + _HEADS) * _LONGEST_LINE / 1000)
        most = self.machine.control.result_file_kB
        if most is not None and needed > most:
            raise InputError(
                f"{self.name}: {plan.touches} touches need {needed} kB in the result file: {self.machine.name} has "
                f"[control] result_file_kB = {most}"
            )
        yield f"IF $MN_LEN_PROTOCOL_FILE<{needed}"
        yield from start.stop(f"MN_LEN_PROTOCOL_FILE is less than {needed}: the result file would be full", FILE_SIZE)

    def section(self, plan: ProbingPlan, number: int, what: str, body: Iterable[str]) -> Iterator[str]:
        """One section of a calibration by itself: label, message, modal head, and what it does, from the home of Z."""
        yield f"; section {number}: {what}"
        yield f"SECTION_{number}:"
        yield if_chosen(number, number)
        yield f'MSG("section {number} of {plan.parts}: {what}")'
        yield start.modal(self.machine)
        yield f"R101={_ENDS}[{number - 1}]"
        yield from self.ready(None)
        yield from body
        yield "ENDIF"

    def end(self) -> Iterator[str]:
        """All parts again next time, Z home, end."""
        yield f"{FIRST}=0 {LAST}=0"
        yield from start.end(self.machine)

    def write(self, text: str) -> Iterator[str]:
        """One line of the result file."""
        yield f'WRITE(UERR,"{self.result_file}",{text})'
        yield "IF UERR<>0"
        yield from start.stop("the result file cannot be written", NOT_WRITTEN)

    def ready(self, level: float | None) -> Iterator[str]:
        """Stops where the probe is deflected before it is moved; in a space, Z goes up to the ``level`` first."""
        yield "STOPRE"
        yield "IF $A_PROBE[1]<>0"
        if level is not None:
            yield f"G0 {self.length('Z', level)}"
        yield from self._stop("the probe is deflected before it is moved", DEFLECTED)

    def aside(self, to: str) -> Iterator[str]:
        """Sideways over the work, to words of X Y A B; what is touched there stops the program where it is."""
        x, y, a, b = to.split(" ")
        yield from self._guarded(f"{x} {y} Z=IC(0) {a} {b}", POSITIONING_FEED, "on the way to a point", None)

    def to_point(self, xy: str, a: str, before: str, b: str) -> Iterator[str]:
        """Sideways to where a touch begins; by way of A ``before`` it where A comes from one side only."""
        if self.machine.one_sided:
            yield from self.aside(f"{xy} {before} {b}")
            yield from self.aside(f"X=IC(0) Y=IC(0) {a} B=IC(0)")
        else:
            yield from self.aside(f"{xy} {a} {b}")

    def lowered(self, z: str) -> Iterator[str]:
        """Down from the home of Z to the height of sideways motion."""
        yield from self._guarded(f"X=IC(0) Y=IC(0) {z} {STILL}", POSITIONING_FEED, "on the way down from home", None)

    def guarded(self, z: str, feed: float, level: float) -> Iterator[str]:
        """Down into the space; who touches something there is lost, and goes back up."""
        yield from self._guarded(f"X=IC(0) Y=IC(0) {z} {STILL}", feed, "on the way in", level)

    def _guarded(self, to: str, feed: float, where: str, level: float | None) -> Iterator[str]:
        yield from self.ready(level)
        yield f"MEAS=1 G1 {to} F{feed:.3f}"
        yield "STOPRE"
        yield "IF $AC_MEA[1]<>0"
        if level is not None:
            yield f"G0 {self.length('Z', level)}"
        yield from self._stop(f"touched something {where}", TOUCHED_TOO_EARLY)

    def _stop(self, why: str, alarm: int) -> Iterator[str]:
        yield from start.stop(why, alarm, self.place)

    def touch(
        self, end: str, back: str, feed: float, retract_feed: float, level: float, up: bool = True
    ) -> Iterator[str]:
        """The touch: positions into R200 to R204, result into R205; away, and up if so; alarm if there is none.

        Positions count from the zero of the machine file, as its work offset has it.
        """
        zero = self.machine.work_offset_values
        from_zero = [f"{-value:+.5f}" if value else "" for value in zero]
        yield from self.ready(level)
        yield f"MEAS=1 G1 {end} {STILL} F{feed:.3f}"
        yield "STOPRE"
        yield " ".join(f"R{200 + k}=$AA_MM[{axis}]{from_zero[k]}" for k, axis in enumerate(AXES)) + " R205=$AC_MEA[1]"
        yield f"G1 {back} F{retract_feed:.3f}"
        if up:
            yield f"G0 {self.length('Z', level)}"
        yield "IF R205==0"
        if not up:
            yield f"G0 {self.length('Z', level)}"
        yield from self._stop("touched nothing", NOTHING_TOUCHED)

    def hand_over(self, place: str) -> Iterator[str]:
        """Offer the point, called ``place``: to the result file, and to a host if there is one."""
        yield "R101=R101+1"
        yield from self.record(place)
        yield from self.wait()

    def record(self, place: str) -> Iterator[str]:
        """The line of the touch in the result file."""
        values = '<<","<<'.join(f"R{k}" for k in range(200, 206))
        yield from self.write(f'R102<<","<<R101<<",{place},"<<{values}')

    def wait(self) -> Iterator[str]:
        """For a host, if there is one, to take the touch."""
        yield "IF R104==1"
        yield "WHILE R103<>R101"
        yield "G4 F0.05"
        yield "STOPRE"
        yield "ENDWHILE"
        yield "ENDIF"
