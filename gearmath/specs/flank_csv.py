"""Flank files, nominal and measured: one line a point, in mm of the work frame, deviations in µm in the file."""

from __future__ import annotations

import csv
import io
import math
import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from gearmath.errors import InputError
from gearmath.files import read_text, write_text
from gearmath.specs.bevel_set import FLANKS, MEMBERS
from gearmath.specs.margins import LISTED, PATTERN

COLUMNS = ("member", "flank", "tooth", "row", "col", "x", "y", "z", "nx", "ny", "nz", "deviation_um", "u_um")
#: Header keys of the contract that every file carries, in this order.
HEADER = (
    "member", "member_teeth", "frame", "unit", "grid", "margins", "reference_point", "phase_zeroed", "tip_radius_mm",
    "settings_sha256",
)  # fmt: skip

#: What these header values must look like: pattern, and the words that say it.
_HEADER_VALUES = {
    "frame": (r"w", "must be w, the work frame"),
    "unit": (r"mm", "must be mm"),
    "member_teeth": (r"[1-9]\d{0,2}", "must be a whole number from 1 to 999"),
    "grid": (r"([2-9]|[1-9]\d{1,5})x([2-9]|[1-9]\d{1,5})", "must read like 5x9, two or more each way"),
    "margins": (rf"{PATTERN}|{LISTED}", "must read like 0.1,0.1, or root,tip,toe,heel, each less than 0.5"),
    "reference_point": (r"\d{1,6},\d{1,6}", "must read like 2,4"),
}


@dataclass(frozen=True)
class FlankFile:
    """The points of one member: index arrays (n,), points and outward normals (n,3), deviations and u (n,) [mm].

    ``deviation`` and ``uncertainty`` are NaN where the file is silent. Points stand in the order of measuring; those
    of tooth = number of teeth are points of tooth 0 measured again.
    """

    header: dict[str, str]
    member: str
    flank: np.ndarray
    tooth: np.ndarray
    row: np.ndarray
    col: np.ndarray
    point: np.ndarray
    normal: np.ndarray
    deviation: np.ndarray
    uncertainty: np.ndarray

    def select(self, flank: str, tooth: int | None = None) -> FlankFile:
        """The points of one flank, of one tooth if given."""
        keep = self.flank == flank
        if tooth is not None:
            keep &= self.tooth == tooth
        return self.pick(keep)

    def pick(self, keep: np.ndarray) -> FlankFile:
        """The points that an index array or a mask keeps."""
        return FlankFile(self.header, self.member, *(getattr(self, name)[keep] for name in _ARRAYS))

    def __len__(self) -> int:
        return len(self.tooth)


_ARRAYS = ("flank", "tooth", "row", "col", "point", "normal", "deviation", "uncertainty")


def join(files: Sequence[FlankFile]) -> FlankFile:
    """The points of several files of one member as one, with the header of the first."""
    arrays = (np.concatenate([getattr(file, name) for file in files]) for name in _ARRAYS)
    return FlankFile(files[0].header, files[0].member, *arrays)


def flank_file(
    header: dict[str, str], member: str, flank: str, tooth: int, row: np.ndarray, col: np.ndarray,
    point: np.ndarray, normal: np.ndarray, deviation: np.ndarray | None = None,
) -> FlankFile:  # fmt: skip
    """A file of n points of one flank of one tooth; a nominal one where ``deviation`` is None."""
    n, silent = len(point), np.full(len(point), np.nan)
    return FlankFile(
        header, member, np.full(n, flank), np.full(n, tooth), row, col, point, normal,
        silent if deviation is None else deviation, silent,
    )  # fmt: skip


def write_flank_csv(path: Path, file: FlankFile) -> None:
    """Write a flank file in one step."""
    stream = io.StringIO()
    for key in HEADER:
        stream.write(f"# {key}: {file.header[key]}\n")
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerow(COLUMNS)
    for k in range(len(file)):
        # 1e-9 mm and 1e-12 in the normals: below anything that a machine or a double of this size can tell
        numbers = [f"{value:.9f}" for value in file.point[k]] + [f"{value:.12f}" for value in file.normal[k]]
        measured = [_um(file.deviation[k]), _um(file.uncertainty[k])]
        writer.writerow([file.member, file.flank[k], file.tooth[k], file.row[k], file.col[k], *numbers, *measured])
    write_text(path, stream.getvalue())


def read_flank_csv(path: Path) -> FlankFile:
    """Read a flank file. Raises InputError naming file, line, column, value and limit."""
    header: dict[str, str] = {}
    rows: list[list[str]] = []
    for number, line in enumerate(read_text(path).splitlines(), 1):
        if line.startswith("#"):
            key, _, value = line[1:].partition(":")
            header[key.strip()] = value.strip()
        elif line.strip():
            rows.append([str(number), *_cells(path, number, line)])
    if not rows or tuple(rows[0][1:]) != COLUMNS:
        raise InputError(f"{path}: is no flank file: the column line must read {','.join(COLUMNS)}")
    missing = [key for key in HEADER if key not in header]
    if missing:
        raise InputError(f"{path}: the header line '# {missing[0]}: ...' is missing")
    _check_header(path, header)
    records = [_record(path, row) for row in rows[1:]]
    if not records:
        raise InputError(f"{path}: holds no point")
    return _collect(path, header, records)


def _check_header(path: Path, header: dict[str, str]) -> None:
    for key, (pattern, words) in _HEADER_VALUES.items():
        if not re.fullmatch(pattern, header[key], re.ASCII):
            raise InputError(f"{path}: {key} = {header[key]!r}: {words}")
    row, col = (int(part) for part in header["reference_point"].split(","))
    rows, columns = (int(part) for part in header["grid"].split("x"))
    if not (row < rows and col < columns):
        raise InputError(f"{path}: reference_point = {row},{col}: must lie in the grid {rows}x{columns}")


def _cells(path: Path, number: int, line: str) -> list[str]:
    try:
        return next(csv.reader([line]))
    except csv.Error as error:
        raise InputError(f"{path}, line {number}: is no CSV: {error}") from error


def _collect(path: Path, header: dict[str, str], records: list[tuple]) -> FlankFile:
    members = {record[0] for record in records}
    if len(members) > 1 or header["member"] not in members:
        raise InputError(f"{path}: one file holds one member, this one {sorted(members | {header['member']})}")
    _check_places(path, header, records)
    fields = list(zip(*records, strict=True))
    numbers = np.array(fields[5:], dtype=float).T
    flank, tooth, row, col = (np.array(fields[k]) for k in (1, 2, 3, 4))
    deviation, uncertainty = numbers[:, 6] / 1000, numbers[:, 7] / 1000
    return FlankFile(
        header, records[0][0], flank, tooth, row, col, numbers[:, :3], numbers[:, 3:6], deviation, uncertainty
    )


def _check_places(path: Path, header: dict[str, str], records: list[tuple]) -> None:
    """Every point once, within the header's counts; tooth = member_teeth is tooth 0 measured again, and only that."""
    rows, columns = (int(part) for part in header["grid"].split("x"))
    limits = {"tooth": int(header["member_teeth"]), "row": rows, "col": columns}
    first = {(record[1], *record[3:5]) for record in records if record[2] == 0}
    seen: set[tuple] = set()
    for record in records:
        for (name, limit), value in zip(limits.items(), record[2:5], strict=True):
            again = name == "tooth" and value == limit
            if value >= limit and not (again and (record[1], *record[3:5]) in first):
                only = f", and {limit} for a point of tooth 0 measured again" if again else ""
                raise InputError(f"{path}: {name} = {value}: the header allows 0 to {limit - 1}{only}")
        if record[1:5] in seen:
            place = f"flank {record[1]}, tooth {record[2]}, row {record[3]}, col {record[4]}"
            raise InputError(f"{path}: the point {place} is there twice")
        seen.add(record[1:5])


def _record(path: Path, row: list[str]) -> tuple:
    line, cells = row[0], row[1:]
    if len(cells) != len(COLUMNS):
        raise InputError(f"{path}, line {line}: has {len(cells)} columns, must have {len(COLUMNS)}")
    for name, allowed, cell in (("member", MEMBERS, cells[0]), ("flank", FLANKS, cells[1])):
        if cell not in allowed:
            raise InputError(f"{path}, line {line}: {name} = {cell!r}: must be {' or '.join(allowed)}")
    try:
        indices = [int(cell) for cell in cells[2:5]]
        numbers = [float(cell) for cell in cells[5:11]]
        measured = [float(cell) if cell else math.nan for cell in cells[11:]]
    except ValueError as error:
        raise InputError(f"{path}, line {line}: {error}") from error
    given = [value for value, cell in zip(measured, cells[11:], strict=True) if cell]
    if not all(math.isfinite(value) for value in (*numbers, *given)):
        raise InputError(f"{path}, line {line}: every number must be finite")
    if min(indices) < 0:
        raise InputError(f"{path}, line {line}: tooth, row and col count from 0, not {min(indices)}")
    if abs(math.hypot(*numbers[3:6]) - 1) > 1e-6:
        raise InputError(f"{path}, line {line}: nx, ny, nz have length {math.hypot(*numbers[3:6]):.7f}, must be 1")
    return (cells[0], cells[1], *indices, *numbers, *measured)


def _um(value: float) -> str:
    return "" if math.isnan(value) else f"{value * 1000:.6f}"
