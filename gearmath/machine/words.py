"""Words of NC programs as all writers print them: positions, feeds, comments, names, block numbers.

Millimetres with five decimals, degrees with six.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Sequence

import numpy as np

from gearmath.errors import InputError
from gearmath.specs.milling_machine import CUTTER_AXIS, UNITS_PER_INTERNAL

#: A block may be no longer than this, comment and line end included.
MAX_BLOCK_CHARACTERS = 250
MAX_NAME_CHARACTERS = 24
_MM_DECIMALS, _DEG_DECIMALS, _FEED_DIGITS = 5, 6, 9
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


def printed(axes: np.ndarray, modulo: bool) -> np.ndarray:
    """Positions as they stand in the text: (n, 5) mm and degrees, rounded, a modulo A in 0 <= A < 360, no -0."""
    values = axes * UNITS_PER_INTERNAL
    values[:, :3] = np.round(values[:, :3], _MM_DECIMALS)
    values[:, 3] = np.round(values[:, 3] % 360.0 if modulo else values[:, 3], _DEG_DECIMALS)
    if modulo:
        values[:, 3] %= 360.0
    values[:, 4] = np.round(values[:, 4], _DEG_DECIMALS)
    return values + 0.0


def cutter_positions(angle: np.ndarray, modulo: bool) -> np.ndarray:
    """Positions of C as they stand in the text: (n,) degrees, rounded, a modulo C in 0 <= C < 360, no -0."""
    values = angle * UNITS_PER_INTERNAL[-1]
    values = np.round(values % 360.0 if modulo else values, _DEG_DECIMALS)
    return (values % 360.0 if modulo else values) + 0.0


def cutter_word(value: float, modulo: bool) -> str:
    """A position of C in degrees as a word."""
    text = f"{value:.{_DEG_DECIMALS}f}"
    return f"{CUTTER_AXIS}=DC({text})" if modulo else f"{CUTTER_AXIS}{text}"


def axis_words(point: np.ndarray, modulo: bool) -> tuple[str, str, str, str, str]:
    x, y, z, a, b = point.tolist()
    mm, deg = _MM_DECIMALS, _DEG_DECIMALS
    turned = f"A=DC({a:.{deg}f})" if modulo else f"A{a:.{deg}f}"
    return f"X{x:.{mm}f}", f"Y{y:.{mm}f}", f"Z{z:.{mm}f}", turned, f"B{b:.{deg}f}"


def fixed(value: float) -> str:
    """A length in mm, without negative zero."""
    return f"{round(value, _MM_DECIMALS) + 0.0:.{_MM_DECIMALS}f}"


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
