"""The blocks of probing programs: guarded approach, touch with result check, result file, and the host's handshake."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

import numpy as np

from gearmath.errors import InputError
from gearmath.machine import words
from gearmath.specs.touch_csv import COLUMNS, PLANNED

#: Alarms of these programs.
DEFLECTED, NOTHING_TOUCHED, TOUCHED_TOO_EARLY, NOT_WRITTEN = 65000, 65001, 65002, 65003
_RESULT = "_T"
_TOOL = "PROBE"
_STILL = "A=IC(0) B=IC(0)"


class Blocks:
    """Writes the blocks of one program, without their numbers."""

    def __init__(self, name: str, modulo: bool) -> None:
        self.name, self.modulo = name, modulo
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
        return words.axis_words(words.printed(position[None], self.modulo)[0], self.modulo)

    def length(self, axis: str, value: float) -> str:
        """The word of one linear axis."""
        return f"{axis}{words.fixed(value)}"

    def start(self, work_offset: str, plan: str, columns: Sequence[str] = COLUMNS) -> Iterator[str]:
        """Head: the probe is fetched, the run is numbered, the result file gets its plan and its column line."""
        yield "DEF INT UERR"
        yield f"G17 G40 G90 G710 G94 {work_offset}"
        yield f'T="{_TOOL}" D1'
        yield "M6"
        yield "SPOS=0"
        yield "R102=R102+1 R101=0 R103=0"
        yield "STOPRE"
        yield "IF $A_PROBE[1]<>0"
        yield from self._stop("the probe is deflected before its first touch", DEFLECTED)
        yield from self.write(f'"# {PLANNED}: {plan}"')
        yield from self.write(f'"{",".join(columns)}"')

    def write(self, text: str) -> Iterator[str]:
        """One line of the result file."""
        yield f'WRITE(UERR,"{self.result_file}",{text})'
        yield "IF UERR<>0"
        yield from self._stop("the result file cannot be written", NOT_WRITTEN)

    def guarded(self, z: str, feed: float, level: float) -> Iterator[str]:
        """Down into the space; who touches something there is lost, and goes back up."""
        yield f"MEAS=1 G1 X=IC(0) Y=IC(0) {z} {_STILL} F{feed:.3f}"
        yield "STOPRE"
        yield "IF $AC_MEA[1]<>0"
        yield f"G0 {self.length('Z', level)}"
        yield from self._stop("touched something on the way in", TOUCHED_TOO_EARLY)

    def touch(
        self, end: str, back: str, feed: float, retract_feed: float, level: float, up: bool = True
    ) -> Iterator[str]:
        """The touch: positions into R200 to R204, result into R205; away, and up if so; alarm if there is none."""
        yield f"MEAS=1 G1 {end} {_STILL} F{feed:.3f}"
        yield "STOPRE"
        yield "R200=$AA_MM[X] R201=$AA_MM[Y] R202=$AA_MM[Z] R203=$AA_MM[A] R204=$AA_MM[B] R205=$AC_MEA[1]"
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
        values = '<<","<<'.join(f"R{k}" for k in range(200, 206))
        yield from self.write(f'R102<<","<<R101<<",{place},"<<{values}')
        yield "IF R104==1"
        yield "WHILE R103<>R101"
        yield "G4 F0.05"
        yield "STOPRE"
        yield "ENDWHILE"
        yield "ENDIF"

    def _stop(self, why: str, alarm: int) -> Iterator[str]:
        """The end of the program within an IF. How the control reacts to SETAL is a setting: M30 stops it for sure."""
        yield f'MSG("{why}")'
        yield f"SETAL({alarm})"
        yield "M30"
        yield "ENDIF"
