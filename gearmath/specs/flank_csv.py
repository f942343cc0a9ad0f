"""Flank files, nominal and measured: one line a point, in mm of the work frame, deviations in µm in the file."""

from __future__ import annotations

import csv
import io
import math
import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from gearmath.errors import InputError
from gearmath.files import read_text, write_text
from gearmath.specs.bevel_set import FLANKS, MEMBERS
from gearmath.specs.file_kinds import told
from gearmath.specs.lines import Line, read_lines
from gearmath.specs.margins import OWN, PATTERN

COLUMNS = ("member", "flank", "tooth", "row", "col", "x", "y", "z", "nx", "ny", "nz", "deviation_um", "u_um")
#: Header keys of the contract that every file carries, in this order.
HEADER = (
    "member",
    "member_teeth",
    "frame",
    "unit",
    "grid",
    "margins",
    "reference_point",
    "phase_zeroed",
    "tip_radius_mm",
    "settings_sha256",
)

#: ``phase_zeroed`` of a file without the rotation of the work that both flanks had in common. Elsewhere it is false, or
#: true where the deviation at the reference point of each flank was set to zero by turning, so that thickness is lost.
COMMON = "common"

#: Header key that a file may have: how many points its program plans, so that a file that was cut off is told.
PLANNED = "planned"
_PLAN = re.compile(r"([1-9]\d{0,7}) points?\b.*", re.ASCII)

#: What these header values must look like: pattern, and the words that say it.
_HEADER_VALUES = {
    "frame": (r"w", "must be w, the work frame"),
    "unit": (r"mm", "must be mm"),
    "member_teeth": (r"[1-9]\d{0,2}", "must be a whole number from 1 to 999"),
    "grid": (r"([2-9]|[1-9]\d{1,5})x([2-9]|[1-9]\d{1,5})", "must read like 5x9, two or more each way"),
    "margins": (rf"{PATTERN}|{OWN}", "must read like 0.1,0.1, or root,tip,toe,heel, each less than 0.5, or own"),
    "reference_point": (r"\d{1,6},\d{1,6}", "must read like 2,4"),
    "phase_zeroed": (
        rf"(?i:false|true|{COMMON})",
        f"must be false, {COMMON} (both flanks turned alike) or true (each)",
    ),
    "member": ("|".join(MEMBERS), f"must be {' or '.join(MEMBERS)}"),
    "tip_radius_mm": (r"\d(\.\d{1,12})?|\de-\d\d", "must be a number from 0 to less than 10"),
    "settings_sha256": (r"[0-9a-fA-F]{1,999}", "must be hexadecimal digits"),
}
#: Header values of two numbers, between which there may be blanks.
_PAIRS = ("grid", "margins", "reference_point")
#: Points of a grid; so many are solved in seconds.
MOST_POINTS = 10_000
#: No index is larger, no point farther from the apex [mm], no deviation larger [µm],
#: and no machine that measures so badly [µm].
_LARGEST_INDEX, _LARGEST, _LARGEST_UM, _LARGEST_U_UM = 1_000_000, 1e4, 1e4, 100.0


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

    def with_noise(self, noise: np.ndarray, sigma: float) -> FlankFile:
        """As a probe says it: off by ``noise`` (n,) [mm] along the normals, of standard uncertainty ``sigma``."""
        return replace(
            self,
            point=self.point + noise[:, None] * self.normal,
            deviation=self.deviation + noise,
            uncertainty=np.full(len(self), sigma),
        )

    @property
    def planned(self) -> int | None:
        """How many points its program plans, None where the header does not say it."""
        match = _PLAN.fullmatch(self.header.get(PLANNED, ""))
        return None if match is None else int(match[1])

    def __len__(self) -> int:
        return len(self.tooth)


_ARRAYS = ("flank", "tooth", "row", "col", "point", "normal", "deviation", "uncertainty")
#: By array: the kinds of NumPy that it may be of, and the shape of a point.
_KINDS = {name: ("U" if name == "flank" else "iu" if name in ("tooth", "row", "col") else "f") for name in _ARRAYS}
_EACH = {"point": (3,), "normal": (3,)}


def check_made(file: FlankFile) -> None:
    """Raise InputError for what no file could hold: arrays that do not fit each other, header lines left out."""
    missing = [key for key in HEADER if not isinstance(file.header.get(key), str)]
    if missing:
        raise InputError(f"file: header: {missing[0]} is missing, or no text")
    count = len(file)
    for name, kinds in _KINDS.items():
        array, shape = getattr(file, name), (count, *_EACH.get(name, ()))
        if not isinstance(array, np.ndarray) or array.shape != shape or array.dtype.kind not in kinds:
            what = {"U": "texts", "iu": "whole numbers", "f": "numbers"}[kinds]
            raise InputError(f"file: {name}: must be an array {shape} of {what}, for as many points as it has teeth")
    others = sorted(set(file.flank.tolist()) - set(FLANKS))
    if others:
        raise InputError(f"file: flank = {others[0]!r}: must be {' or '.join(FLANKS)}")


def join(files: Sequence[FlankFile]) -> FlankFile:
    """The points of several files of one member as one, with the header of the first."""
    arrays = (np.concatenate([getattr(file, name) for file in files]) for name in _ARRAYS)
    return FlankFile(files[0].header, files[0].member, *arrays)


def flank_file(
    header: dict[str, str],
    member: str,
    flank: str,
    tooth: int,
    row: np.ndarray,
    col: np.ndarray,
    point: np.ndarray,
    normal: np.ndarray,
    deviation: np.ndarray | None = None,
) -> FlankFile:
    """A file of n points of one flank of one tooth; a nominal one where ``deviation`` is None."""
    n, silent = len(point), np.full(len(point), np.nan)
    return FlankFile(
        header,
        member,
        np.full(n, flank),
        np.full(n, tooth),
        row,
        col,
        point,
        normal,
        silent if deviation is None else deviation,
        silent,
    )


def write_flank_csv(path: Path, file: FlankFile) -> None:
    """Write a flank file in one step, other header comments such as the operator after those of the contract."""
    stream = io.StringIO()
    for key in (*HEADER, *(other for other in file.header if other not in HEADER)):
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
    """Read a flank file. Raises InputError naming file, line, key, value and limit."""
    header, lines = read_lines(path, (*HEADER, PLANNED))
    if not lines or lines[0].cells != COLUMNS:
        raise InputError(
            f"{path}: is no flank file: the column line must read {','.join(COLUMNS)}{told(read_text(path))}"
        )
    missing = [key for key in HEADER if key not in header]
    if missing:
        raise InputError(f"{path}: the header line '# {missing[0]}: ...' is missing")
    _check_header(path, header)
    records = [_record(line, header) for line in lines[1:]]
    if not records:
        raise InputError(f"{path}: holds no point")
    _check_plan(path, header, len(records))
    return _collect(header, records)


def _check_header(path: Path, header: dict[str, str]) -> None:
    for key in _PAIRS:
        header[key] = header[key].replace(" ", "")
    for key, (pattern, words) in _HEADER_VALUES.items():
        if not re.fullmatch(pattern, header[key], re.ASCII):
            raise InputError(f"{path}: {key} = {header[key]!r}: {words}")
    row, col = (int(part) for part in header["reference_point"].split(","))
    rows, columns = (int(part) for part in header["grid"].split("x"))
    if rows * columns > MOST_POINTS:
        raise InputError(f"{path}: grid = {rows}x{columns}: has {rows * columns} points, the limit is {MOST_POINTS}")
    if not (row < rows and col < columns):
        raise InputError(f"{path}: reference_point = {row},{col}: must lie in the grid {rows}x{columns}")


def _check_plan(path: Path, header: dict[str, str], count: int) -> None:
    if PLANNED not in header:
        return
    match = _PLAN.fullmatch(header[PLANNED])
    if match is None:
        raise InputError(f"{path}: {PLANNED} = {header[PLANNED]!r}: must begin like '112 points'")
    if count > int(match[1]):
        raise InputError(f"{path}: {PLANNED} = {header[PLANNED]}: it holds {count}; is this more than one measurement?")


def _record(line: Line, header: dict[str, str]) -> tuple[Line, tuple]:
    line.counted(len(COLUMNS))
    if line.cells == COLUMNS:
        raise line.refuse("the column line is there twice: is this more than one file?")
    cells = dict(zip(COLUMNS, line.cells, strict=True))
    member = line.one_of("member", cells["member"], MEMBERS)
    if member != header["member"]:
        raise line.refuse(f"member = {member}: the header says member: {header['member']}; one file holds one member")
    names = (line.one_of("flank", cells["flank"], FLANKS),)
    places = tuple(line.whole(key, cells[key], _LARGEST_INDEX) for key in ("tooth", "row", "col"))
    point = tuple(line.real(key, cells[key], -_LARGEST, _LARGEST) for key in ("x", "y", "z"))
    normal = tuple(line.real(key, cells[key]) for key in ("nx", "ny", "nz"))
    if abs(math.hypot(*normal) - 1) > 1e-6:
        raise line.refuse(f"nx, ny, nz have length {math.hypot(*normal):.7f}, must be 1")
    deviation = _or_silent(line, "deviation_um", cells, -_LARGEST_UM, _LARGEST_UM)
    uncertainty = _or_silent(line, "u_um", cells, 0.0, _LARGEST_U_UM)
    return line, (*names, *places, *point, *normal, deviation, uncertainty)


def _or_silent(line: Line, key: str, cells: dict[str, str], least: float, most: float) -> float:
    """A number in µm, NaN where the cell is empty."""
    return line.real(key, cells[key], least, most) if cells[key] else math.nan


def _collect(header: dict[str, str], records: list[tuple[Line, tuple]]) -> FlankFile:
    _check_places(header, records)
    fields = list(zip(*(values for _, values in records), strict=True))
    numbers = np.array(fields[4:], dtype=float).T
    flank, tooth, row, col = (np.array(fields[k]) for k in range(4))
    deviation, uncertainty = numbers[:, 6] / 1000, numbers[:, 7] / 1000
    return FlankFile(
        header, header["member"], flank, tooth, row, col, numbers[:, :3], numbers[:, 3:6], deviation, uncertainty
    )


def _check_places(header: dict[str, str], records: list[tuple[Line, tuple]]) -> None:
    """Every point once, within the header's counts; tooth = member_teeth is tooth 0 measured again, and only that."""
    rows, columns = (int(part) for part in header["grid"].split("x"))
    limits = {"tooth": int(header["member_teeth"]), "row": rows, "col": columns}
    first = {(values[0], *values[2:4]) for _, values in records if values[1] == 0}
    seen: dict[tuple, int] = {}
    for line, values in records:
        for (name, limit), value in zip(limits.items(), values[1:4], strict=True):
            again = name == "tooth" and value == limit
            if value >= limit and not (again and (values[0], *values[2:4]) in first):
                only = f", and {limit} for a point of tooth 0 measured again" if again else ""
                raise line.refuse(f"{name} = {value}: the header allows 0 to {limit - 1}{only}")
        if values[:4] in seen:
            place = f"flank {values[0]}, tooth {values[1]}, row {values[2]}, col {values[3]}"
            raise line.refuse(f"the point {place} is there twice, in line {seen[values[:4]]} too")
        seen[values[:4]] = line.number


def _um(value: float) -> str:
    return "" if math.isnan(value) else f"{value * 1000:.6f}"
