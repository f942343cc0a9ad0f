"""Lines of measured files: numbers as people, measuring machines and controls print them; cut off ends are found."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from gearmath.errors import InputError, counted
from gearmath.files import read_text

#: Decimals with or without a digit before the point, a plus sign, and the exponent of a control: 1.5EX-05.
_NUMBER = re.compile(r"([+-]?(?:\d+\.?\d*|\.\d+))(?:[eE][xX]?([+-]?\d{1,4}))?", re.ASCII)
#: Bytes of the largest measured file, some 100 000 points; more cells than this of a line are not taken apart.
_LARGEST, _MOST_CELLS = 20_000_000, 50
_DECIMAL_COMMA = re.compile(r"[+-]?\d+,\d+", re.ASCII)


@dataclass(frozen=True)
class Line:
    """One line of a file that is neither empty nor a comment, in cells without blanks around them."""

    path: Path
    number: int
    cells: tuple[str, ...]

    def refuse(self, what: str) -> InputError:
        """The error that names file and line."""
        return InputError(f"{self.path}, line {self.number}: {what}")

    def real(self, key: str, cell: str, least: float = -math.inf, most: float = math.inf) -> float:
        """A finite number within limits. Raises InputError naming file, line, key, value and limit."""
        match = _NUMBER.fullmatch(cell)
        value = float(match[1] + (f"e{match[2]}" if match[2] else "")) if match else math.nan
        if not math.isfinite(value):
            comma = ", with a decimal point and not a comma" if _DECIMAL_COMMA.fullmatch(cell) else ""
            raise self.refuse(f"{key} = {cell!r}: must be a finite number{comma}")
        if not least <= value <= most:
            limit = f"from {least:g} to {most:g}" if least != -most else f"at most {most:g} in size"
            raise self.refuse(f"{key} = {cell}: must be {limit}")
        return value

    def whole(self, key: str, cell: str, most: int) -> int:
        """A whole number from 0, perhaps printed with decimals. Raises InputError as :meth:`real` does."""
        value = self.real(key, cell)
        if value != int(value) or not 0 <= value <= most:
            raise self.refuse(f"{key} = {cell}: must be a whole number from 0 to {most}")
        return int(value)

    def one_of(self, key: str, cell: str, names: tuple[str, ...]) -> str:
        """One of some names. Raises InputError as :meth:`real` does."""
        if cell not in names:
            raise self.refuse(f"{key} = {cell!r}: must be {' or '.join(names)}")
        return cell

    def counted(self, columns: int) -> None:
        """Raise InputError where the line has more or fewer cells, with the likeliest cause."""
        if len(self.cells) == columns:
            return
        why = ""
        if any(mark in cell for cell in self.cells for mark in ";\t"):
            why = "; columns stand between commas, and numbers have a decimal point"
        elif len(self.cells) > columns:
            why = "; numbers have a decimal point and not a comma"
        raise self.refuse(f"has {counted(len(self.cells), 'column')}, must have {columns}{why}")


def read_lines(path: Path, keys: tuple[str, ...] = ()) -> tuple[dict[str, str], list[Line]]:
    """Header comments ``# key: value``, and the lines of a file.

    Raises InputError for one of the ``keys`` that is there twice with two values, and for a last line that is cut off:
    it has no line end, and it is shorter than the line before it.
    """
    text = read_text(path, _LARGEST)
    header: dict[str, str] = {}
    at: dict[str, int] = {}
    for number, key, value in _comments(text):
        if key in keys and header.get(key, value) != value:
            raise InputError(f"{path}, line {number}: {key} = {value!r}: line {at[key]} says {header[key]!r}")
        header.setdefault(key, value)
        at.setdefault(key, number)
    lines = [
        Line(path, number, tuple(_cells(line)))
        for number, line in enumerate(text.split("\n"), 1)
        if line.strip() and not line.startswith("#")
    ]
    _check_end(text, lines)
    return header, lines


def comments(path: Path, wanted: str) -> dict[int, str]:
    """The values of a header key that every run of a file has anew, by line number."""
    return {number: value for number, key, value in _comments(read_text(path, _LARGEST)) if key == wanted}


def _comments(text: str) -> Iterator[tuple[int, str, str]]:
    """Line number, key and value of the header comments."""
    for number, line in enumerate(text.split("\n"), 1):
        if line.startswith("#"):
            key, colon, value = (part.strip() for part in line[1:].partition(":"))
            if colon:
                yield number, key, value


def _cells(line: str) -> Iterator[str]:
    """The cells of a line; a measured file has neither commas nor line ends within one."""
    for cell in line.split(",", _MOST_CELLS):
        cell = cell.strip()
        yield cell[1:-1].strip() if len(cell) > 1 and cell[0] == cell[-1] == '"' else cell


def _check_end(text: str, lines: list[Line]) -> None:
    if text.endswith("\n") or len(lines) < 2:
        return
    last, before = lines[-1], lines[-2]
    if len(last.cells) < len(before.cells) or len(last.cells[-1]) < len(before.cells[-1]):
        raise last.refuse("has no line end and is shorter than the line before it: the file is cut off there")
