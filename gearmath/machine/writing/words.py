"""Words of NC programs as all writers print them: positions, feeds, comments, names, block numbers.

Positions have as many decimals as the control has increments, since it rounds to these whatever is written.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from gearmath.errors import InputError
from gearmath.specs.milling_machine import AXES, CUTTER_AXIS, UNITS_PER_INTERNAL, MillingMachine

#: A block may be no longer than this, comment and line end included.
MAX_BLOCK_CHARACTERS = 250
#: A control that takes more values in a block than a cubic of five axes has reads blocks up to this length.
MAX_LONG_CHARACTERS, MOST_SHORT_VALUES = 512, 15
MAX_NAME_CHARACTERS = 24
#: Decimals that coefficients have beyond those of positions: rounding them is nothing beside rounding the end points.
_MORE_DIGITS = 2
_FEED_DIGITS = 9
_PROGRAM_NAME = re.compile(r"(?:[A-Za-z]{2}|_[A-Za-z])[A-Za-z0-9_]*")
_RESERVED_NAME = re.compile(r"CON|PRN|AUX|NUL|(?:COM|LPT)[1-9]", re.IGNORECASE)


def numbered(head: Sequence[str], body: Iterable[str]) -> str:
    """The text of a program: head and body, a number before every block, none before a comment."""
    lines, number = list(head), 0
    for line in body:
        if not line.startswith(";"):
            number += 10
            line = f"N{number} {line}"
        lines.append(line)
    return "\n".join(lines) + "\n"


def block_count(text: str) -> int:
    """How many blocks a program has: lines with a number, without comments."""
    return sum(line.startswith("N") for line in text.splitlines())


@dataclass(frozen=True)
class Positions:
    """How positions stand in the text of programs for one machine, with one tool.

    ``length`` [mm] is what the tool table adds to Z while D1 is active: the programmed Z is less by it.
    """

    modulo: bool
    turning_cutter: bool
    mm: int
    degrees: int
    length: float = 0.0

    @staticmethod
    def of(machine: MillingMachine, tool_length: float) -> Positions:
        """For a tool whose tip is ``tool_length`` mm from the gauge line."""
        cutter = machine.axes.C
        length = tool_length if machine.z_reference == "tip" else 0.0
        return Positions(machine.axes.A.modulo, cutter is not None and cutter.modulo, *machine.control.decimals, length)

    def printed(self, axes: np.ndarray) -> np.ndarray:
        """Positions X Y Z A B (n, 5) as they stand there: mm and degrees, rounded, a modulo A below 360, no -0."""
        values = axes * UNITS_PER_INTERNAL
        values[:, 2] -= self.length
        values[:, :3] = np.round(values[:, :3], self.mm)
        values[:, 3] = self._turn(values[:, 3], self.modulo)
        values[:, 4] = np.round(values[:, 4], self.degrees)
        return values + 0.0

    def words(self, axes: np.ndarray) -> list[tuple[str, ...]]:
        """The words of positions X Y Z A B (n, 5) in mm and rad."""
        return [
            (
                self._mm("X", x),
                self._mm("Y", y),
                self._mm("Z", z),
                self._turned("A", a, self.modulo),
                f"B{b:.{self.degrees}f}",
            )
            for x, y, z, a, b in self.printed(axes).tolist()
        ]

    def polynomial_words(self, axes: np.ndarray, bends: np.ndarray) -> list[tuple[str, ...]]:
        """The words PO of blocks between positions (n, k) with coefficients ``bends`` (n-1, k, m), in mm and rad.

        A modulo A counts on from what its DC word says at the first position [unconfirmed]. With C there are six axes.
        """
        scale = np.append(UNITS_PER_INTERNAL, UNITS_PER_INTERNAL[-1])[: axes.shape[1]]
        values = axes * scale
        values[:, 2] -= self.length
        values[:, 3] -= 360.0 * round((values[0, 3] - self.printed(axes[:1, :5])[0, 3]) / 360.0)
        given = bends * scale[:, None]
        places = [self.mm] * 3 + [self.degrees] * 3
        return [
            tuple(
                self._polynomial(axis, end, own, digits)
                for axis, end, own, digits in zip(AXES + CUTTER_AXIS, ends, block, places, strict=False)
            )
            for ends, block in zip(values[1:].tolist(), given.tolist(), strict=True)
        ]

    def _polynomial(self, axis: str, end: float, coefficients: list[float], digits: int) -> str:
        """End point and coefficients of one axis: cubic as PO[X]=(..), of a higher degree in the form X=PO(..).

        Coefficients at the end that are zero are left out.
        """
        more = digits + _MORE_DIGITS
        rounded = [round(a, more) + 0.0 for a in coefficients]
        while rounded and rounded[-1] == 0.0:
            rounded.pop()
        texts = [f"{round(end, digits) + 0.0:.{digits}f}", *(f"{a:.{more}f}" for a in rounded)]
        return f"PO[{axis}]=({','.join(texts)})" if len(coefficients) == 2 else f"{axis}=PO({','.join(texts)})"

    def cutter_words(self, angle: np.ndarray) -> list[str]:
        """The words of positions of C (n,) rad."""
        values = self._turn(angle * UNITS_PER_INTERNAL[-1], self.turning_cutter) + 0.0
        return [self._turned(CUTTER_AXIS, value, self.turning_cutter) for value in values.tolist()]

    def z(self, value: float) -> str:
        """The word of a Z in mm."""
        return self.word("Z", value - self.length)

    def word(self, axis: str, value: float) -> str:
        """The word of a linear axis as the control sees it [mm]."""
        return self._mm(axis, round(value, self.mm) + 0.0)

    def _mm(self, axis: str, value: float) -> str:
        return f"{axis}{value:.{self.mm}f}"

    def _turn(self, values: np.ndarray, modulo: bool) -> np.ndarray:
        values = np.round(values % 360.0 if modulo else values, self.degrees)
        return values % 360.0 if modulo else values

    def _turned(self, axis: str, value: float, modulo: bool) -> str:
        text = f"{value:.{self.degrees}f}"
        return f"{axis}=DC({text})" if modulo else f"{axis}{text}"


def feed_number(value: float) -> str:
    """F with nine significant digits in fixed form: one part in 1e9 of the block's time."""
    decimals = max(1, _FEED_DIGITS - 1 - math.floor(math.log10(value)))
    return f"{value:.{decimals}f}"


def comment(name: str, text: str) -> str:
    """One comment line. Raises InputError for what would end the line, or for characters the control may not show."""
    bad = next((character for character in text if not " " <= character <= "~"), None)
    if bad is not None:
        raise InputError(f"{name}: comment {text!r}: the character {bad!r} is not printable ASCII")
    line = f"; {text}"
    if len(line) + 1 > MAX_BLOCK_CHARACTERS:
        raise InputError(
            f"{name}: comment {text[:40]!r}...: {len(line) + 1} characters, {MAX_BLOCK_CHARACTERS} allowed"
        )
    return line


def check_target(target: Path) -> None:
    """Refuse a file whose name gives a program none that the control takes. Raises InputError naming the option -o."""
    try:
        check_name(target.stem)
    except InputError as error:
        raise InputError(f"-o {target}: {error}") from error


def check_name(name: str) -> None:
    if len(name) > MAX_NAME_CHARACTERS:
        raise InputError(f"program name {name!r}: has {len(name)} characters, {MAX_NAME_CHARACTERS} are allowed")
    if not _PROGRAM_NAME.fullmatch(name):
        raise InputError(
            f"program name {name!r}: must be letters, digits and _, and begin with two letters or with _ and a letter"
        )
    if _RESERVED_NAME.fullmatch(name):
        raise InputError(f"program name {name!r}: is a reserved name of the operating system")


def plain(text: str) -> str:
    """Free text as it may stand in an NC comment: printable ASCII, other characters as '?'."""
    return "".join(character if " " <= character <= "~" else "?" for character in text)
