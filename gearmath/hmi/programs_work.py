"""Programs of the chosen member: written, milled virtually, listed and read, without anything of a page."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from datetime import datetime
from functools import lru_cache
from itertools import islice
from pathlib import Path

from gearmath.arguments.known import MOST_TOUCHES
from gearmath.errors import InputError
from gearmath.files import read_bytes
from gearmath.front.machines import load_machine, load_probe, load_shop
from gearmath.front.probing import probing
from gearmath.front.programs import Program, cutting
from gearmath.front.sets import load_set
from gearmath.hmi.catalog import changed_at
from gearmath.hmi.correcting import free_file
from gearmath.hmi.numbers import Limits
from gearmath.hmi.state import Choice
from gearmath.hmi.work import Progress
from gearmath.machine.control.file_names import control_name
from gearmath.machine.control.text import decoded, readable
from gearmath.machine.judging.dialects import known, named
from gearmath.machine.judging.timing import timing
from gearmath.machine.measuring.checked import ProbingChoice
from gearmath.machine.planning.cut_plan import (
    MOST_STOCK,
    CuttingJob,
    feed_limits,
    spindle_limits,
    tolerance_limits,
)
from gearmath.machine.planning.limits import check_spindle_speed
from gearmath.machine.writing.words import check_name
from gearmath.specs.bevel_set import FLANKS, Member
from gearmath.specs.milling_machine import MillingMachine
from gearmath.specs.touch_csv import planned_touches

#: Lines of a program that the page shows from its beginning.
SHOWN = 2000


@dataclass(frozen=True)
class WrittenProgram:
    """A program that was written: its file, blocks, time [s] without tool changes, and the verdict in words."""

    file: Path
    blocks: int
    seconds: float | None
    touches: int | None
    verdict: str


@dataclass(frozen=True)
class MilledProgram:
    """What a cutting program leaves of the metal: largest deviation [mm] from the nominal flanks on a right machine and
    on that of a shop. ``is_changed`` says whether the set itself is other than nominal."""

    name: str
    largest: float
    largest_of_shop: float | None
    faults: list[str] = field(default_factory=list)
    is_changed: bool = False


@dataclass(frozen=True)
class ListedProgram:
    """A program of the folder."""

    name: str
    size: int
    written: str


def write_cutting(folder: Path, choice: Choice, name: str, job: CuttingJob, progress: Progress) -> WrittenProgram:
    """Write the cutting program ``name`` of all spaces, for the control of the machine file; ``job`` says the rest.

    It is run before it is written: it keeps the limits of the machine, and collides with nothing. Raises InputError,
    ComputationError.
    """
    machine, member = load_machine(choice.machine), load_set(choice.gear_set).member(choice.member)
    file = _new_file(folder, name, machine.spec)
    check_spindle_speed(file.stem, machine.spec, job.spindle_rpm)
    whole = replace(job, spaces=range(member.teeth))
    made = cutting(member, machine, file.stem, whole, file=file.name, begin=progress.begin)
    times = timing(made.path, machine.spec)
    _save(made.save, file)
    return WrittenProgram(file, made.blocks, times.feed_seconds + times.rapid_seconds, None, "")


def write_probing(folder: Path, choice: Choice, name: str, chosen: ProbingChoice, progress: Progress) -> WrittenProgram:
    """Write the probing program ``name``, for the control of the machine file.

    It is run before it is written: the probe stays clear of everything.
    """
    machine, member = load_machine(choice.machine), load_set(choice.gear_set).member(choice.member)
    file = _new_file(folder, name, machine.spec)
    what = chosen.topography, chosen.pitch, chosen.registration, chosen.repeat
    probe = load_probe(choice.calibration)
    made = probing(member, machine, probe, file.stem, *what, file=file.name, begin=progress.begin)
    _save(made.save, file)
    return WrittenProgram(file, made.blocks, None, made.touches, made.clearance)


def mill(folder: Path, choice: Choice, name: str, shop: str | None, progress: Progress) -> MilledProgram:
    """Mill a cutting program of the folder: on a machine without errors, and on that of the file ``shop``."""
    text = readable(decoded(read(folder, name), name))
    if planned_touches(text):
        raise InputError(f"{name}: is a probing program: only a cutting program can be milled")
    member = load_set(choice.gear_set).member(choice.member)
    program = Program(member, load_machine(choice.machine), name, text)
    progress.total = 2 * member.teeth * (1 if shop is None else 2)
    largest = float(abs(program.mill(None, progress).deviation).max())
    of_shop = None if shop is None else float(abs(program.mill(load_shop(shop), progress).deviation).max())
    return MilledProgram(name, largest, of_shop, program.faults(), _is_changed(member.spec))


def _is_changed(member: Member) -> bool:
    """Whether a member is cut otherwise than its nominal flanks were."""
    flanks = [member.flank(name) for name in FLANKS]
    now = [(one.vector.tolist(), one.motion, one.blade_spheric_radius) for one in flanks]
    return now != [(one.nominal.vector.tolist(), one.nominal_motion, one.nominal_spheric_radius) for one in flanks]


def limits(choice: Choice, dry_run: bool) -> dict[str, Limits]:
    """What the fields of both programs may hold for the chosen member and machine, by their keys; tolerance in µm.

    Raises InputError where a file is refused.
    """
    files = choice.gear_set, choice.machine
    return _limits(*files, choice.member, dry_run, *map(changed_at, files))


@lru_cache(maxsize=8)
def _limits(gear_set: str, machine: str, name: str, dry_run: bool, *changed: int) -> dict[str, Limits]:
    """The same of files as they were ``changed`` last [ns]: pages ask all the time, and to check a pair takes long."""
    member, on = load_set(gear_set).member(name).spec, load_machine(machine).spec
    low, high = spindle_limits(member, on, dry_run)
    finest, coarsest = tolerance_limits(member)
    stock = Limits(0.0, MOST_STOCK)
    return {
        "feed": Limits(*feed_limits(on, dry_run)),
        "spindle_rpm": Limits(low, math.floor(100 * high) / 100),  # what a field shows of it keeps it
        "tolerance": Limits(round(1000 * finest, 9), round(1000 * coarsest, 9)),
        "roughing_stock": stock,
        "finishing_stock": stock,
        "teeth": Limits(0, member.teeth),
        "repeat": Limits(1, MOST_TOUCHES),
    }


def programs(folder: Path) -> list[ListedProgram]:
    """The programs of a folder whose names a control takes, the newest first. Raises InputError."""
    found = []
    suffixes = {".SPF", *(one.suffix for one in known())}
    try:
        paths = [one for one in folder.iterdir() if one.suffix in suffixes]
    except OSError as error:
        raise InputError(f"{folder.name}: cannot be read: {error.strerror}") from error
    for path in paths:
        try:
            _kept_name(path.name)
            status = path.stat()
        except (InputError, OSError):
            continue
        found.append((status.st_mtime, path.name, status.st_size))
    return [
        ListedProgram(name, size, datetime.fromtimestamp(at).isoformat(" ", "seconds"))
        for at, name, size in sorted(found, reverse=True)
    ]


def probing_programs(folder: Path) -> list[str]:
    """Those that offer touches to a host, the newest first. Raises InputError."""
    return [one.name for one in programs(folder) if _touches(folder, one.name, stamp(folder, one.name))]


@lru_cache(maxsize=500)
def _touches(folder: Path, name: str, written: int) -> int:
    """How many touches a program plans, as it was ``written`` [ns]: pages ask all the time."""
    try:
        return planned_touches(decoded(read(folder, name), name))
    except InputError:
        return 0


def read(folder: Path, name: str) -> bytes:
    """A program of the folder. Raises InputError for a name that a control does not take, or leads elsewhere."""
    return read_bytes(folder / _kept_name(name))


def stamp(folder: Path, name: str) -> int:
    """When a program was written [ns], 0 for one that is gone: what was found of it holds while that is the same."""
    try:
        return (folder / name).stat().st_mtime_ns
    except OSError:
        return 0


def preview(folder: Path, name: str) -> tuple[str, int]:
    """The first lines of a program as text, and how many it has."""
    lines = decoded(read(folder, name), name).splitlines()
    return "\n".join(islice(lines, SHOWN)), len(lines)


def _kept_name(name: str) -> str:
    """The name as its control keeps it, which its ending tells. Raises InputError."""
    by_suffix = (one.file_name for one in known() if name.endswith(one.suffix))
    return next(by_suffix, control_name)(name)


def free_name(folder: Path, choice: Choice, name: str) -> tuple[str, str]:
    """The file that a program of this name would be written over, empty where there is none; and the name, or with the
    first number behind it that is free. Raises InputError for a name that is refused."""
    file = _file(folder, name, load_machine(choice.machine).spec)
    free = free_file(folder, file.stem, file.suffix)
    return ("" if free == file else file.name), free.stem


def _new_file(folder: Path, name: str, machine: MillingMachine) -> Path:
    """The file of a program that is not there yet. Raises InputError where it is."""
    file = _file(folder, name, machine)
    if file.exists():
        free = free_file(folder, file.stem, file.suffix)
        raise InputError(f"{file.name}: is there already, and is not written over: {free.name} is free")
    return file


def _save(save: Callable[[Path], object], file: Path) -> None:
    """Write a program. Raises InputError where somebody has written one of its name in the meantime."""
    if file.exists():
        raise InputError(f"{file.name}: was written by another one in the meantime, and is not written over")
    save(file)


def _file(folder: Path, name: str, machine: MillingMachine) -> Path:
    """The file of a program for a machine; a name that its control or the writer refuses is an InputError."""
    dialect, stem = named(machine.control.dialect(None)), name.strip().upper()
    for one in known():
        stem = stem.removesuffix(one.suffix.upper())
    check_name(stem)
    return folder / dialect.file_name(f"{stem}{dialect.suffix}")
