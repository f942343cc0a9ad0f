"""Touch files: what the machine stood at when the probe triggered, in machine coordinates, mm and degrees."""

from __future__ import annotations

import csv
import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from gearmath.errors import InputError
from gearmath.files import read_text
from gearmath.specs.bevel_set import FLANKS, MEMBERS

COLUMNS = ("run", "point", "member", "flank", "tooth", "row", "col", "X", "Y", "Z", "A", "B", "triggered")
#: Columns of the touches on ring, its face, the spheres on table and work, and what is touched.
CALIBRATION_COLUMNS = ("run", "point", "target", "X", "Y", "Z", "A", "B", "triggered")
RING = ("ring_x_low", "ring_x_high", "ring_y_low", "ring_y_high")
RING_FACE, SPHERE, WORK_SPHERE = "ring_face", "sphere", "work_sphere"
_NAMES = {"member": MEMBERS, "flank": FLANKS, "target": (*RING, RING_FACE, SPHERE, WORK_SPHERE)}
_WHOLE = ("run", "point", "tooth", "row", "col", "triggered")
#: No axis of a machine is longer [mm], or turned further [degrees].
_LARGEST = 1e5


@dataclass(frozen=True)
class Touches:
    """The touches of one run on one member: index arrays (n,), axis positions X Y Z A B (n,5) in mm and rad.

    Touches of one point follow each other. Tooth z is tooth 0, touched again at the end.
    """

    run: int
    member: str
    flank: np.ndarray
    tooth: np.ndarray
    row: np.ndarray
    col: np.ndarray
    axes: np.ndarray

    def __len__(self) -> int:
        return len(self.tooth)


@dataclass(frozen=True)
class CalibrationTouches:
    """The touches of one run on ring and sphere: what was touched (n,), positions X Y Z A B (n,5) in mm and rad."""

    run: int
    target: np.ndarray
    axes: np.ndarray


def read_touch_csv(path: Path, run: int | None = None) -> Touches:
    """The touches of one run, by default the last one of the file.

    The control adds every run to the same file, each with its own column line. Raises InputError naming file, line,
    column, value and limit: for a point that is missing, twice there or did not trigger, too.
    """
    return _collected(path, *_records(path, COLUMNS, run))


def read_calibration_csv(path: Path, run: int | None = None) -> CalibrationTouches:
    """The touches on ring and sphere of one run, by default the last one. Raises InputError as for touches."""
    wanted, records = _records(path, CALIBRATION_COLUMNS, run)
    _check_points(path, wanted, records)
    return CalibrationTouches(wanted, np.array([record["target"] for record in records]), _axes(records))


def _records(path: Path, columns: tuple[str, ...], run: int | None) -> tuple[int, list[dict]]:
    """Number and records of a run."""
    records = [
        _record(path, number, line, columns)
        for number, line in enumerate(read_text(path).splitlines(), 1)
        if line.strip() and not line.startswith("#") and _cells(path, number, line) != list(columns)
    ]
    if not records:
        raise InputError(f"{path}: holds no touch; the column line reads {','.join(columns)}")
    runs = sorted({int(record["run"]) for record in records})
    wanted = runs[-1] if run is None else run
    if wanted not in runs:
        raise InputError(f"{path}: holds no run {wanted}, but {', '.join(map(str, runs))}")
    return wanted, [record for record in records if record["run"] == wanted]


def _cells(path: Path, number: int, line: str) -> list[str]:
    try:
        return [cell.strip() for cell in next(csv.reader([line]))]
    except (csv.Error, StopIteration) as error:
        raise InputError(f"{path}, line {number}: is no CSV: {error}") from error


def _record(path: Path, number: int, line: str, columns: tuple[str, ...]) -> dict:
    cells = _cells(path, number, line)
    if len(cells) != len(columns):
        raise InputError(f"{path}, line {number}: has {len(cells)} columns, must have {len(columns)}")
    record: dict = {"line": number}
    for name, cell in zip(columns, cells, strict=True):
        if name in _NAMES:
            if cell not in _NAMES[name]:
                raise InputError(f"{path}, line {number}: {name} = {cell!r}: must be {' or '.join(_NAMES[name])}")
            record[name] = cell
        else:
            record[name] = _number(path, number, name, cell)
    return record


def _number(path: Path, line: int, name: str, cell: str) -> float:
    try:
        value = float(cell)
    except ValueError as error:
        raise InputError(f"{path}, line {line}: {name} = {cell!r}: must be a number") from error
    if not (math.isfinite(value) and abs(value) <= _LARGEST):
        raise InputError(f"{path}, line {line}: {name} = {cell}: must be at most {_LARGEST:g} in size")
    if name in _WHOLE and (value != int(value) or value < 0):
        raise InputError(f"{path}, line {line}: {name} = {cell}: must be a whole number from 0")
    return value


def _collected(path: Path, run: int, records: list[dict]) -> Touches:
    members = sorted({record["member"] for record in records})
    if len(members) > 1:
        raise InputError(f"{path}, run {run}: one run measures one member, this one {' and '.join(members)}")
    _check_points(path, run, records)
    seen: dict[tuple, int] = {}
    before: tuple = ()
    for record in records:
        place = tuple(record[name] for name in ("flank", "tooth", "row", "col"))
        if place in seen and place != before:
            raise InputError(
                f"{path}, line {record['line']}: the point of line {seen[place]} is there twice; touches of one point "
                "must follow each other"
            )
        seen[place], before = record["line"], place
    tooth, row, col = (np.array([int(record[name]) for record in records]) for name in ("tooth", "row", "col"))
    return Touches(run, members[0], np.array([record["flank"] for record in records]), tooth, row, col, _axes(records))


def _check_points(path: Path, run: int, records: list[dict]) -> None:
    """Points count up without a gap, and every one triggered."""
    first = int(records[0]["point"])
    if first > 1:
        raise InputError(f"{path}, run {run}: begins with point {first}: points count from 0 or 1")
    for count, record in enumerate(records, start=first):
        line = record["line"]
        if record["point"] != count:
            raise InputError(f"{path}, line {line}: point = {record['point']:g}: must be {count}, without a gap")
        if record["triggered"] != 1:
            raise InputError(f"{path}, line {line}: triggered = {record['triggered']:g}: the probe touched nothing")


def _axes(records: list[dict]) -> np.ndarray:
    axes = np.array([[record[name] for name in ("X", "Y", "Z", "A", "B")] for record in records])
    axes[:, 3:] = np.radians(axes[:, 3:])
    return axes
