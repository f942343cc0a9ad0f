"""Plain text of points from another measuring machine: ``x y z`` or ``x y z i j k`` a row, in the usual layouts.

Read are blanks, tabs, commas or semicolons between the columns; decimal points or decimal commas; exponents with E or
D; header lines, comments and blank lines; units behind and axis letters before a number; point numbers and texts before
the coordinates; a line of column names, which then decides; UTF-8, UTF-16 and Latin-1. Other columns are left aside,
and that is said. A row that has not the numbers of the others is refused: it may have been cut in half.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from gearmath.errors import InputError, counted
from gearmath.specs.sheet import UNITS

#: More points than any flank is measured at, and a larger coordinate than any machine has. [in the file's unit]
MOST_POINTS, _LARGEST = 5000, 1e5

_NUMBER = re.compile(
    r"(?:(?:[XYZIJKUVW]|N[XYZ])\s*[=:]?\s*)?([+-]?(?:\d+\.?\d*|\.\d+)(?:[DEde][Xx]?[+-]?\d{1,3})?|[+-]?(?:nan|inf)\w*)"
    r'\s*(?:mm|inch|in|")?',
    re.IGNORECASE | re.ASCII,
)
_COMMENT, _TRAILING = re.compile(r"#|!|%|//|\$|'"), re.compile(r"\s+(?:#|!|//).*")
_BRACKETS = str.maketrans("()[]{}<>", " " * 8)
#: Columns of fixed width leave no blank before a sign.
_GLUED = re.compile(r"(\.\d+)(?=[+-]\d*\.\d)")
_DECIMAL_COMMA = re.compile(r"[A-Za-z]*=?[+-]?\d+,\d+([DEde][+-]?\d+)?")
_AXES = "xyz"
_ACTUAL = r"(?:act|actual|ist|meas|measured|mess|m)"
_COORDINATE = re.compile(rf"([xyz])[ _.-]*{_ACTUAL}?|{_ACTUAL}[ _.-]+([xyz])")
_MEASURED = re.compile(rf"([xyz])[ _.-]*{_ACTUAL}|{_ACTUAL}[ _.-]+([xyz])")
_NORMAL = re.compile(r"(?:n|norm|normal|v|vec)[ _.-]*([xyz])|([ijk])|([uvw])")
#: A line of text that says how many points follow.
_ANNOUNCED = re.compile(
    r"\W*(?:.*\W)?(?:points|punkte|pts|point count)\W*[=:]\s*(\d+)\W*|\W*(\d+)\s+(?:points|punkte)\W*", re.IGNORECASE
)
#: What a line of text says of its points, where it says one thing only.
_STATED = {
    "flank": re.compile(r"\b(concave|convex)\b", re.IGNORECASE),
    "unit": re.compile(r"\bunits?\b\W*(mm|millimet\w+|inch|inches|in)\b|\[(mm|inch|in)\]", re.IGNORECASE),
    "member": re.compile(r"\bmember\b\W*(pinion|gear)\b", re.IGNORECASE),
    "tooth": re.compile(r"\btooth\b\s*(?:no\b|nr\b|number\b)?\W*(\d{1,3})\b(?!\s*teeth)", re.IGNORECASE),
}
#: Digits of the last number of a row behind its decimal mark.
_DECIMALS = re.compile(r"[.,](\d*)\D*$", re.ASCII)
#: Rounding of normals, and how near to each other two sets of points of one file would be. [file's unit]
_UNIT_LENGTH, _NEAR = 0.01, 5.0


@dataclass(frozen=True)
class PointText:
    """Points (n,3) [mm] in the axes of the file, normals (n,3) or None, line numbers (n,), and what was left aside.

    ``stated`` is what its lines of text say of ``flank``, ``unit``, ``member`` and ``tooth``, with the line.
    """

    path: Path
    point: np.ndarray
    normal: np.ndarray | None
    line: np.ndarray
    remarks: tuple[str, ...]
    stated: dict[str, tuple[str, int]]


def read_point_text(path: Path, unit: str = "mm") -> PointText:
    """The points of a text. Raises InputError naming file, line, value and what is wrong with it."""
    text = _text(path).replace("\N{MINUS SIGN}", "-").replace("\xa0", " ").replace("\x1a", "")
    lines = [_TRAILING.sub("", line.strip()) for line in text.splitlines()]
    split, decimal_comma = _separator(lines)
    cells = {number: _cells(line, split, decimal_comma) for number, line in enumerate(lines, 1) if line}
    rows, names, remarks = _rows(path, lines, cells, split)
    _check_last(path, lines, list(rows))
    values = np.array([_finite(path, number, cells[number], columns) for number, columns in rows.items()])
    texts = sum(cell is None for cell in cells[next(iter(rows))])
    point, normal, left = _columns(path, values, names)
    remarks += [f"columns that are not used: {left + texts}"] if left + texts else []
    same = _first_of_same(point)
    if not same.all():
        remarks.append(f"{counted(int((~same).sum()), 'point')} given twice, counted once")
        point, normal = point[same], None if normal is None else normal[same]
    stated = _stated(lines[: next(iter(rows)) - 1])
    return PointText(path, point * UNITS[unit], normal, np.array(list(rows))[same], tuple(remarks), stated)


def _stated(above: Sequence[str]) -> dict[str, tuple[str, int]]:
    """What the lines above the rows say, where all of them say the same."""
    found = {}
    for key, pattern in _STATED.items():
        said: dict[str, int] = {}
        for number, line in enumerate(above, 1):
            for groups in pattern.findall(line):
                word = "".join(groups).lower()
                said.setdefault({"i": "inch", "m": "mm"}[word[0]] if key == "unit" else word, number)
        if len(said) == 1:
            found[key] = next(iter(said.items()))
    return found


def _check_last(path: Path, lines: Sequence[str], rows: Sequence[int]) -> None:
    """Raise InputError where the last number of a file lacks digits that all others have."""
    digits = [match[1] if (match := _DECIMALS.search(lines[number - 1])) else "" for number in rows]
    usual = {len(each) for each in digits[:-1]}
    if len(digits) > 3 and len(usual) == 1 and len(digits[-1]) < min(usual):  # fewer rows have no usual number
        raise InputError(
            f"{path}, line {rows[-1]}: its last number has {len(digits[-1])} decimals, those above have "
            f"{usual.pop()}: the file is cut off there"
        )


def _text(path: Path) -> str:
    try:
        content = path.read_bytes()
    except OSError as error:
        raise InputError(f"{path}: cannot be read: {error.strerror}") from error
    if content[:2] in (b"\xff\xfe", b"\xfe\xff"):
        encoding = "utf-16"
    elif b"\0" in content:
        raise InputError(f"{path}: is no text file: byte {content.index(0)} is zero")
    else:
        encoding = "utf-8-sig"
    try:
        return content.decode(encoding)
    except UnicodeDecodeError:
        return content.decode("latin-1")  # header lines of older programs; numbers are the same in all of them


def _separator(lines: Sequence[str]) -> tuple[str, bool]:
    """What stands between the columns, as a pattern, and whether commas are decimal."""
    rows = [line for line in lines if len(re.findall(r"\d+", line)) >= 3 and not re.search(r"[A-Za-z]{4}", line)]
    if any(";" in row for row in rows):
        split = ";"
    elif any("\t" in row for row in rows):
        split = "\t"
    else:
        split = ""
    points, commas = (sum(bool(re.search(rf"\d{mark}\d", row)) for row in rows) for mark in (r"\.", ","))
    if split:
        return rf"\s*{split}\s*", commas > points
    if not any("," in row for row in rows):
        return r"\s+", False
    # blanks alone between the columns: 1,5 2,5 3,5
    three = sum(sum(bool(_DECIMAL_COMMA.fullmatch(cell)) for cell in row.split()) >= 3 for row in rows)
    decimal = points < commas and three > len(rows) / 2
    return (r"\s+", True) if decimal else (r"\s*,\s*", False)


def _cells(line: str, split: str, decimal_comma: bool) -> list[float | None]:
    """The cells of a line: a number, or None for any other text."""
    if _COMMENT.match(line):
        return []
    found: list[float | None] = []
    for cell in re.split(split, _GLUED.sub(r"\1 ", line.translate(_BRACKETS)).strip(' "')):
        whole = _number(cell, decimal_comma)
        parts = [
            _number(part, decimal_comma) for part in re.split(r"[\s,;]+" if not decimal_comma else r"[\s;]+", cell)
        ]
        found += parts if whole is None and any(part is not None for part in parts) else [whole]
    return found


def _number(cell: str, decimal_comma: bool) -> float | None:
    text = cell.strip().strip('"')
    match = _NUMBER.fullmatch(text.replace(",", ".") if decimal_comma else text)
    if match is None:
        return None
    if re.match(r"[+-]?(nan|inf)", match[1], re.IGNORECASE):
        return np.nan
    return float(re.sub(r"[DEde][Xx]?", "e", match[1]))


def _rows(
    path: Path, lines: Sequence[str], cells: dict[int, list[float | None]], split: str
) -> tuple[dict[int, tuple[int, ...]], dict[int, str], list[str]]:
    """Line numbers of the rows with the columns of their numbers, the names above them by column, and remarks."""
    shape = {number: tuple(k for k, cell in enumerate(row) if cell is not None) for number, row in cells.items()}
    counts = Counter(columns for columns in shape.values() if len(columns) >= 3)
    if not counts:
        raise InputError(f"{path}: holds no row of three numbers, x y z")
    columns = max(counts, key=lambda one: counts[one])
    rows = {number: one for number, one in shape.items() if one == columns}
    remarks = []
    whole = {number: all(float(cells[number][k] or 0.0).is_integer() for k in columns) for number in rows}
    for number in list(rows):  # counts of points, rows and columns may look like a row of coordinates
        if not whole[number] or all(whole.values()):
            break
        del rows[number]
        remarks.append(f"line {number} is taken for a header: it holds whole numbers only")
    first = next(iter(rows))
    for number, one in shape.items():
        begins_with_text = not re.match(r"[-+.\d]", lines[number - 1])
        if number < first:  # above the rows a line of a few numbers may be a header, a line of three decimals is a row
            if not (len(one) >= 3 and re.fullmatch(r"([-+.,;\s\d]*\d\.\d[-+.,;\s\d]*)", lines[number - 1])):
                continue
        elif one == columns or (begins_with_text and len(one) < 3):
            continue
        rest = f"the rows {'below' if number < first else 'above'} have"
        what = f"{counted(len(one), 'number')}, {rest} {len(columns)}"
        if len(one) == len(columns):
            what = f"its numbers in columns {_list(one)}, {rest} them in {_list(columns)}"
        raise InputError(f"{path}, line {number}: has {what}: {lines[number - 1][:40]!r}")
    for line in lines[: first - 1]:
        announced = _ANNOUNCED.fullmatch(line)
        if announced and len(rows) < int(announced[1] or announced[2]):
            raise InputError(
                f"{path}: holds {counted(len(rows), 'point')}, and says {line.strip()[:60]!r}: is it whole?"
            )
    if len(rows) > MOST_POINTS:
        raise InputError(f"{path}: holds {len(rows)} points, the limit is {MOST_POINTS}")
    return rows, _names(lines[: first - 1], split, columns, len(cells[first])), remarks


def _list(columns: tuple[int, ...]) -> str:
    return ", ".join(str(column + 1) for column in columns)


def _names(above: Sequence[str], split: str, columns: tuple[int, ...], width: int) -> dict[int, str]:
    """Names of the columns of numbers (0 ...), out of the last line above the rows that has one for every cell."""
    for line in reversed(above):
        text = re.sub(r"\[.*?\]|\(.*?\)", "", line.lstrip("#!%$'/ ")).strip()
        found = [re.sub(r"[ _](mm|inch|in)$", "", name.strip(' "').lower()) for name in re.split(split, text)]
        if len(found) == width and set(_AXES) <= {_of(_COORDINATE, name) for name in found}:
            return {k: found[column] for k, column in enumerate(columns)}
    return {}


def _of(pattern: re.Pattern[str], name: str) -> str | None:
    match = pattern.fullmatch(name)
    return next((group for group in match.groups() if group), None) if match else None


def _finite(path: Path, number: int, row: list[float | None], columns: tuple[int, ...]) -> list[float]:
    values = [float(row[k]) for k in columns]  # type: ignore[arg-type]
    for value in values:
        if not abs(value) <= _LARGEST:
            raise InputError(f"{path}, line {number}: {value:g}: must be a number, at most {_LARGEST:g} in size")
    return values


def _columns(path: Path, values: np.ndarray, names: dict[int, str]) -> tuple[np.ndarray, np.ndarray | None, int]:
    """Points, normals, and how many columns of numbers are neither."""
    at, normal_at = _named(names) if names else _placed(path, values)
    left = values.shape[1] - 3 - (0 if normal_at is None else 3)
    if normal_at is None:
        return values[:, at], None, left
    normal = values[:, normal_at]
    length = np.linalg.norm(normal, axis=1)
    if not (np.abs(length - 1) < _UNIT_LENGTH).all():
        worst = float(length[np.argmax(np.abs(length - 1))])
        raise InputError(f"{path}: a normal has length {worst:.4f}: must be 1")
    return values[:, at], normal / length[:, None], left


def _named(names: dict[int, str]) -> tuple[list[int], list[int] | None]:
    def find(pattern: re.Pattern[str]) -> dict[str, int]:
        return {axis: k for k, name in reversed(names.items()) if (axis := _of(pattern, name))}

    points = find(_COORDINATE) | find(_MEASURED)
    normals = find(_NORMAL)
    for axes in (_AXES, "ijk", "uvw"):
        if set(axes) <= set(normals):
            return [points[axis] for axis in _AXES], [normals[axis] for axis in axes]
    return [points[axis] for axis in _AXES], None


def _placed(path: Path, values: np.ndarray) -> tuple[list[int], list[int] | None]:
    """Columns without names: numbers of points first, then x y z, then perhaps normals, or the other way round."""
    count, first = values.shape[1], 0
    while count - first > 3 and (values[:, first] == np.round(values[:, first])).all():
        first += 1
    at = list(range(first, first + 3))
    if count - first < 6:
        return at, None
    following = list(range(first + 3, first + 6))
    unit, unit_after = (
        bool((np.abs(np.linalg.norm(values[:, each], axis=1) - 1) < _UNIT_LENGTH).all()) for each in (at, following)
    )
    if unit_after:
        return at, following
    if unit:
        return following, at
    length = np.linalg.norm(values[:, following], axis=1)
    usual = float(np.median(length))
    if len(values) > 3 and usual > 0 and (np.abs(length / usual - 1) < _UNIT_LENGTH).all():
        raise InputError(
            f"{path}: the normals in columns {first + 4} to {first + 6} have length {usual:.4g}: must be 1"
        )
    if (np.abs(values[:, at] - values[:, following]) < _NEAR).all():
        raise InputError(
            f"{path}: columns {first + 4} to {first + 6} look like points too, nominal or measured: name the measured "
            "ones x y z in a line above the rows"
        )
    return at, None


def _first_of_same(point: np.ndarray) -> np.ndarray:
    _, first = np.unique(point, axis=0, return_index=True)
    keep = np.zeros(len(point), dtype=bool)
    keep[first] = True
    return keep
