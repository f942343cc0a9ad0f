"""The blocks of probing programs: guarded approach, touch with result check, result file, and the host's handshake."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

import numpy as np

from gearmath.errors import InputError
from gearmath.machine import start, words
from gearmath.machine.clear_space import Room
from gearmath.machine.words import Positions
from gearmath.specs.milling_machine import AXES, MillingMachine
from gearmath.specs.touch_csv import COLUMNS, PLANNED

#: Alarms of these programs.
DEFLECTED, NOTHING_TOUCHED, TOUCHED_TOO_EARLY, NOT_WRITTEN = 65000, 65001, 65002, 65003
_RESULT = "_T"
_TOOL = "PROBE"
_STILL = "A=IC(0) B=IC(0)"


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

    def start(self, plan: str, columns: Sequence[str] = COLUMNS, room: Room | None = None) -> Iterator[str]:
        """Head: Z home, the probe is fetched and held, the run is numbered, the result file gets its plan and columns.

        Under the ``room`` of a work the probe must not stand.
        """
        machine = self.machine
        yield "DEF INT UERR"
        yield from start.head(machine)
        yield from start.checks(machine)
        if room is not None:
            yield from start.enough_height(machine, room, self.probe_length, machine.cutter_head.spindle_radius)
        yield "M5 M9"
        yield from start.retract(machine)
        yield from start.fetch(machine, _TOOL, self.probe_length)
        yield "SPOS=0"
        yield "R102=R102+1 R101=0 R103=0"
        yield "STOPRE"
        yield "IF $A_PROBE[1]<>0"
        yield from start.stop("the probe is deflected before its first touch", DEFLECTED)
        yield from self.write(f'"# {PLANNED}: {plan}"')
        yield from self.write(f'"{",".join(columns)}"')

    def end(self) -> Iterator[str]:
        """Z home, end."""
        yield from start.end(self.machine)

    def write(self, text: str) -> Iterator[str]:
        """One line of the result file."""
        yield f'WRITE(UERR,"{self.result_file}",{text})'
        yield "IF UERR<>0"
        yield from start.stop("the result file cannot be written", NOT_WRITTEN)

    def guarded(self, z: str, feed: float, level: float) -> Iterator[str]:
        """Down into the space; who touches something there is lost, and goes back up."""
        yield f"MEAS=1 G1 X=IC(0) Y=IC(0) {z} {_STILL} F{feed:.3f}"
        yield "STOPRE"
        yield "IF $AC_MEA[1]<>0"
        yield f"G0 {self.length('Z', level)}"
        yield from start.stop("touched something on the way in", TOUCHED_TOO_EARLY)

    def touch(
        self, end: str, back: str, feed: float, retract_feed: float, level: float, up: bool = True
    ) -> Iterator[str]:
        """The touch: positions into R200 to R204, result into R205; away, and up if so; alarm if there is none.

        Positions count from the zero of the machine file, as its work offset has it.
        """
        zero = self.machine.work_offset_values
        from_zero = [f"{-value:+.5f}" if value else "" for value in zero]
        yield f"MEAS=1 G1 {end} {_STILL} F{feed:.3f}"
        yield "STOPRE"
        yield " ".join(f"R{200 + k}=$AA_MM[{axis}]{from_zero[k]}" for k, axis in enumerate(AXES)) + " R205=$AC_MEA[1]"
        yield f"G1 {back} F{retract_feed:.3f}"
        if up:
            yield f"G0 {self.length('Z', level)}"
        yield "IF R205==0"
        if not up:
            yield f"G0 {self.length('Z', level)}"
        yield from start.stop("touched nothing", NOTHING_TOUCHED)

    def hand_over(self, place: str) -> Iterator[str]:
        """Offer the point, called ``place``: to the result file, and to a host if there is one."""
        yield "R101=R101+1"
        values = '<<","<<'.join(f"R{k}" for k in range(200, 206))
        yield from self.write(f'R102<<","<<R101<<",{place},"<<{values}')
        yield "IF R104==1"
        yield "WHILE R103<>R101"
        yield "G4 F0.05"
        yield "STOPRE"
        yield "ENDWHILE"
        yield "ENDIF"
