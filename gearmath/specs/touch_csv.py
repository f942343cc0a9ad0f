"""Touch files: what the machine stood at when the probe triggered, in machine coordinates, mm and degrees."""

from __future__ import annotations

import re
from collections import Counter
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from gearmath.errors import InputError, counted
from gearmath.files import read_text
from gearmath.specs.bevel_set import FLANKS, MEMBERS
from gearmath.specs.file_kinds import TOUCHES, told
from gearmath.specs.lines import Line, comments, read_lines

COLUMNS = ("run", "point", "member", "flank", "tooth", "row", "col", "X", "Y", "Z", "A", "B", "triggered")
#: Columns of the touches on ring, its face, the spheres on table and work, and what is touched.
CALIBRATION_COLUMNS = ("run", "point", "target", "X", "Y", "Z", "A", "B", "triggered")
RING = ("ring_x_low", "ring_x_high", "ring_y_low", "ring_y_high")
RING_FACE, SPHERE, WORK_SPHERE = "ring_face", "sphere", "work_sphere"
_NAMES = {"member": MEMBERS, "flank": FLANKS, "target": (*RING, RING_FACE, SPHERE, WORK_SPHERE)}
#: Key of the header comment before the columns of a run: the touches that its program makes.
PLANNED = "planned"
#: Key of the one after it, where a run makes some of them only: their numbers.
HELD = "points"
_PLAN = re.compile(r"(\d{1,8}) touches\b.*", re.ASCII)
_HELD = re.compile(r"(\d{1,8}) to (\d{1,8})", re.ASCII)
_WHOLE = ("run", "point", "tooth", "row", "col", "triggered")
#: No axis of a machine is longer [mm], or turned further [degrees]; nothing counts further.
_LARGEST, _LARGEST_COUNT = 1e5, 10_000_000


@dataclass(frozen=True)
class Touches:
    """The touches of one run on one member: index arrays (n,), axis positions X Y Z A B (n,5) in mm and rad.

    Touches of one point follow each other. Tooth z is tooth 0, touched again at the end. ``triggered`` (n,) is False
    where the probe touched nothing on its whole way. ``planned`` is how many touches the program makes, None where the
    file does not say it; ``joined`` says which touches are of which run.
    """

    run: int
    member: str
    flank: np.ndarray
    tooth: np.ndarray
    row: np.ndarray
    col: np.ndarray
    axes: np.ndarray
    triggered: np.ndarray
    planned: int | None = None
    joined: str = ""

    def __len__(self) -> int:
        return len(self.tooth)

    def pick(self, keep: np.ndarray) -> Touches:
        """The touches that an index array or a mask keeps."""
        names = ("flank", "tooth", "row", "col", "axes", "triggered")
        return replace(self, **{name: getattr(self, name)[keep] for name in names})

    def name_of(self, k: int) -> str:
        """Where touch k is, in words."""
        return f"{self.flank[k]} flank, tooth {self.tooth[k]}, row {self.row[k]}, col {self.col[k]}"


@dataclass(frozen=True)
class CalibrationTouches:
    """The touches of one run on ring and sphere: what was touched (n,), positions X Y Z A B (n,5) in mm and rad."""

    run: int
    target: np.ndarray
    axes: np.ndarray
    planned: int | None = None
    joined: str = ""


def read_touch_csv(path: Path, run: int | None = None) -> Touches:
    """The touches of one run, by default the last one of the file.

    A program that was continued adds the run to the same file, with its own column line; where the last run says that
    it makes a part of the touches only, the rest is taken of the runs before it of the same plan. Raises InputError
    naming file, line, column, value and limit: for a point that is missing or twice there, and for a run that touched
    nothing, too.
    """
    wanted, records, planned, joined = _whole(path, COLUMNS, run)
    if not any(record["triggered"] for record in records):
        raise InputError(
            f"{path}: run {wanted}: triggered = 0 in all of its {counted(len(records), 'touch')}: it met no flank"
        )
    return _collected(wanted, records, planned, joined)


def read_calibration_csv(path: Path, run: int | None = None) -> CalibrationTouches:
    """The touches on ring and sphere of one run, by default the last one. Raises InputError as for touches.

    A touch that met nothing is refused, too: ring and sphere stand where the file of the probe says.
    """
    wanted, records, planned, joined = _whole(path, CALIBRATION_COLUMNS, run)
    missed = next((record for record in records if not record["triggered"]), None)
    if missed is not None:
        raise missed["line"].refuse("triggered = 0: must be 1: the probe touched nothing")
    targets = np.array([record["target"] for record in records])
    return CalibrationTouches(wanted, targets, _axes(records), planned, joined)


def planned_touches(program: str) -> int:
    """How many touches the text of a probing or calibration program plans, 0 where it does not say it."""
    plan = re.search(rf"# {PLANNED}: (\d+) touches", program)
    return int(plan[1]) if plan else 0


def run_lengths(path: Path) -> dict[int, int]:
    """How many touches every run of a file has, on a member or on artefacts. Raises InputError as for touches."""
    _, lines = read_lines(path)
    columns = CALIBRATION_COLUMNS if lines and len(lines[0].cells) == len(CALIBRATION_COLUMNS) else COLUMNS
    return dict(sorted(Counter(record["run"] for record in _all(path, columns)).items()))


def check_whole(path: Path, wanted: int | None, found: Touches | CalibrationTouches, missing: tuple[str, ...]) -> None:
    """Raise InputError where the last run, with those that it continues, is not whole and no run was ``wanted``."""
    if wanted is not None:
        return
    run, lengths = found.run, run_lengths(path)
    longest = max(lengths, key=lambda number: lengths[number])
    if not missing and not found.joined and lengths[run] < lengths[longest]:  # runs of one file are runs of one program
        missing = (f"it has {counted(lengths[run], 'touch')}, run {longest} has {lengths[longest]}",)
    if missing:
        choice = f"--run {run} takes it as it is" + (f", --run {longest} another one" if longest != run else "")
        more = f" (and {counted(len(missing) - 1, 'further reason')})" if len(missing) > 1 else ""
        more += f" ({found.joined})" if found.joined else ""
        raise InputError(f"{path}: run {run}, the last one, is not whole: {missing[0]}{more}; {choice}")


def _records(path: Path, columns: tuple[str, ...], run: int | None) -> tuple[int, list[dict]]:
    """Number and records of a run; the last one must not be followed by one that was begun and has no touch."""
    records = _all(path, columns)
    last = read_lines(path)[1][-1]
    if run is None and last.cells == columns:
        raise last.refuse(
            f"a further run begins here and has no touch; --run {records[-1]['run']} takes the one before"
        )
    runs = sorted({record["run"] for record in records})
    wanted = runs[-1] if run is None else run
    if wanted not in runs:
        raise InputError(f"{path}: holds no run {wanted}, but {', '.join(map(str, runs))}")
    return wanted, [record for record in records if record["run"] == wanted]


def _whole(path: Path, columns: tuple[str, ...], run: int | None) -> tuple[int, list[dict], int | None, str]:
    """A run, its records, how many touches its program plans, and what of them is of which run."""
    wanted, records = _records(path, columns, run)
    number, plan = _comment(path, PLANNED, records)
    first, last = _held(path, records)
    _check_points(records, first)
    planned = None
    if number is not None:
        if (match := _PLAN.fullmatch(plan)) is None:
            raise InputError(f"{path}, line {number}: {PLANNED} = {plan!r}: must begin like '122 touches'")
        planned = int(match[1])
    if first is None or last is None:
        return wanted, records, planned, ""
    if run is not None:
        return wanted, records, planned, f"touches {first} to {records[-1]['point']} of {planned} only"
    found = {record["point"]: record for record in records}
    others = {record["run"] for record in _all(path, columns)} - {wanted}
    for other in sorted(others, reverse=True):
        _, earlier = _records(path, columns, other)
        if earlier[0]["line"].number > records[0]["line"].number or _comment(path, PLANNED, earlier)[1] != plan:
            continue
        begin, _ = _held(path, earlier)
        _check_points(earlier, begin)
        for record in earlier:
            found.setdefault(record["point"], record)
        if begin in (None, 1):
            break  # a run from the first point on: nothing before it belongs to it
    records = [found[point] for point in sorted(found)]
    return wanted, records, planned, _parts(records, planned)


def _parts(records: list[dict], planned: int | None) -> str:
    """In words, which touches are of which run."""
    parts: list[list[int]] = []
    for record in records:
        if parts and parts[-1][0] == record["run"] and parts[-1][2] + 1 == record["point"]:
            parts[-1][2] = record["point"]
        else:
            parts.append([record["run"], record["point"], record["point"]])
    words = (f"touches {first} to {last} of run {run}" for run, first, last in parts)
    return f"joined of {planned}: {', '.join(words)}"


def _comment(path: Path, key: str, records: list[dict]) -> tuple[int | None, str]:
    """Line and value of the last comment with a key before the first touch of a run and after the run before it."""
    values = comments(path, key)
    first = records[0]["line"].number
    others = [line.number for line in read_lines(path)[1] if line.number < first and line.cells[0].isdigit()]
    number = max((number for number in values if max(others, default=0) < number < first), default=None)
    return (None, "") if number is None else (number, values[number])


def _held(path: Path, records: list[dict]) -> tuple[int | None, int | None]:
    """The first and the last touch that a run makes, where it says that these are not all."""
    number, text = _comment(path, HELD, records)
    if number is None:
        return None, None
    match = _HELD.fullmatch(text)
    if match is None or not 1 <= int(match[1]) <= int(match[2]):
        raise InputError(f"{path}, line {number}: {HELD} = {text!r}: must be like '40 to 122'")
    return int(match[1]), int(match[2])


def _all(path: Path, columns: tuple[str, ...]) -> list[dict]:
    """The records of a file."""
    _, lines = read_lines(path)
    other, what = (COLUMNS, "a member") if columns == CALIBRATION_COLUMNS else (CALIBRATION_COLUMNS, "ring and spheres")
    for line in lines:
        if line.cells == other:
            raise line.refuse(f"the touches are on {what}: the columns must be {','.join(columns)}")
    begun = lines and lines[0].cells in (COLUMNS, CALIBRATION_COLUMNS)
    if instead := "" if begun else told(read_text(path), TOUCHES):
        raise InputError(f"{path}: holds no touch{instead}")
    records = [_record(line, columns) for line in lines if line.cells != columns]
    if not records:
        raise InputError(f"{path}: holds no touch; the column line reads {','.join(columns)}")
    return records


def _record(line: Line, columns: tuple[str, ...]) -> dict:
    line.counted(len(columns))
    record: dict = {"line": line}
    for name, cell in zip(columns, line.cells, strict=True):
        if name in _NAMES:
            record[name] = line.one_of(name, cell, _NAMES[name])
        elif name in _WHOLE:
            record[name] = line.whole(name, cell, _LARGEST_COUNT)
        else:
            record[name] = line.real(name, cell, -_LARGEST, _LARGEST)
    return record


def _collected(run: int, records: list[dict], planned: int | None, joined: str) -> Touches:
    member = records[0]["member"]
    seen: dict[tuple, int] = {}
    before: tuple = ()
    for record in records:
        line = record["line"]
        if record["member"] != member:
            raise line.refuse(f"member = {record['member']}: run {run} began with the {member}: one run, one member")
        place = tuple(record[name] for name in ("flank", "tooth", "row", "col"))
        if place in seen and place != before:
            raise line.refuse(
                f"the point of line {seen[place]} is there twice; touches of one point must follow each other"
            )
        seen[place], before = line.number, place
    tooth, row, col = (np.array([record[name] for record in records]) for name in ("tooth", "row", "col"))
    flank = np.array([record["flank"] for record in records])
    triggered = np.array([record["triggered"] == 1 for record in records])
    return Touches(run, member, flank, tooth, row, col, _axes(records), triggered, planned, joined)


def _check_points(records: list[dict], held: int | None) -> None:
    """Points count up without a gap, from 0 or 1 or the first that is ``held``, and each triggered or did not."""
    first = records[0]["point"]
    if held is not None and first != held:
        raise records[0]["line"].refuse(f"run {records[0]['run']} begins with point = {first}: must be {held}")
    if held is None and first > 1:
        raise records[0]["line"].refuse(f"run {records[0]['run']} begins with point = {first}: must be 0 or 1")
    for count, record in enumerate(records, start=first):
        line = record["line"]
        if record["point"] != count:
            again = f": run {record['run']} is there twice" if record["point"] == first else ""
            raise line.refuse(f"point = {record['point']}: must be {count}, without a gap{again}")
        if record["triggered"] > 1:
            raise line.refuse(f"triggered = {record['triggered']}: must be 1, or 0 where the probe touched nothing")


def _axes(records: list[dict]) -> np.ndarray:
    axes = np.array([[record[name] for name in ("X", "Y", "Z", "A", "B")] for record in records])
    axes[:, 3:] = np.radians(axes[:, 3:])
    return axes
