"""A power cut at any moment, and a process that is killed: every touch that was acknowledged is there.

The store runs on a file system of our own (a VFS of apsw) that notes every write and every sync in their order. What a
disk holds after a power cut is made from these notes: all that was synced before, and of what was not, nothing or any
part of it in any order. The store itself then opens it, with the SQLite of Python.
"""

from __future__ import annotations

import os
import random
import signal
import sqlite3
import subprocess
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

import apsw
import pytest

from gearmath.control.interface import RunStart, Touch
from gearmath.control.store import MeasurementStore
from gearmath.control.store_schema import SETTINGS, prepare

POINTS, CUTS = 60, 50
SECTOR = 512
Start = Callable[..., RunStart]
Touched = Callable[[int], Touch]


@dataclass
class Notes:
    """What happened on the disk: (file, what, position, bytes), and how many touches were acknowledged before it."""

    events: list[tuple[str, str, int, bytes]] = field(default_factory=list)
    acknowledged_before: list[int] = field(default_factory=list)
    acknowledged: int = 0

    def add(self, name: str, what: str, position: int = 0, content: bytes = b"") -> None:
        self.events.append((Path(name).name, what, position, content))
        self.acknowledged_before.append(self.acknowledged)


class NotingFile(apsw.VFSFile):
    def __init__(self, notes: Notes, base: str, filename: apsw.URIFilename | str | None, flags: list[int]) -> None:
        super().__init__(base, filename, flags)
        self.notes = notes
        self.path = filename.filename() if isinstance(filename, apsw.URIFilename) else str(filename)

    def xWrite(self, content: bytes, position: int) -> None:
        super().xWrite(content, position)
        self.notes.add(self.path, "write", position, bytes(content))

    def xTruncate(self, size: int) -> None:
        super().xTruncate(size)
        self.notes.add(self.path, "truncate", size)

    def xSync(self, flags: int) -> None:
        super().xSync(flags)
        self.notes.add(self.path, "sync")


class NotingVFS(apsw.VFS):
    def __init__(self, notes: Notes) -> None:
        super().__init__("noting", "")
        self.notes = notes

    def xOpen(self, name: apsw.URIFilename | str | None, flags: list[int]) -> NotingFile:
        return NotingFile(self.notes, "", name, flags)

    def xDelete(self, name: str, sync: bool) -> None:
        super().xDelete(name, sync)
        self.notes.add(name, "delete")


def disk_after(events: list[tuple[str, str, int, bytes]], kept: random.Random | None) -> dict[str, bytes]:
    """The files after a power cut behind ``events``: without what was not synced, or with sectors of it as drawn."""
    synced: dict[str, bytearray] = {}
    now: dict[str, bytearray] = {}
    unsynced: dict[str, list[tuple[str, int, bytes]]] = {}
    for name, what, position, content in events:
        if what == "delete":
            for files in (synced, now, unsynced):
                files.pop(name, None)  # type: ignore[attr-defined]
        elif what == "sync":
            synced[name] = bytearray(now.get(name, b""))
            unsynced[name] = []
        else:
            apply(now.setdefault(name, bytearray()), what, position, content)
            unsynced.setdefault(name, []).append((what, position, content))
    left = {name: bytearray(synced.get(name, b"")) for name in now}
    if kept is not None:
        for name, changes in unsynced.items():
            for what, position, content in changes:
                for begin in range(0, max(len(content), 1), SECTOR):
                    if kept.random() < 0.5:
                        apply(left[name], what, position + begin, content[begin : begin + SECTOR])
    return {name: bytes(content) for name, content in left.items()}


def apply(file: bytearray, what: str, position: int, content: bytes) -> None:
    if what == "truncate":
        del file[position:]
        return
    file.extend(bytes(max(0, position - len(file))))
    file[position : position + len(content)] = content


def noted_run(folder: Path, start: RunStart, touch: Touched, settings: tuple[str, ...] = SETTINGS) -> Notes:
    """A whole run on the noting file system; it is checkpointed in the middle, as a long run is."""
    folder.mkdir()
    notes = Notes()
    vfs = NotingVFS(notes)
    connection = apsw.Connection(str(folder / "runs.db"), vfs="noting")
    connection.execute("PRAGMA locking_mode = EXCLUSIVE")  # a VFS of apsw has no shared memory
    prepare(connection, folder / "runs.db", settings)
    store = MeasurementStore(connection, folder / "runs.db")
    run = store.begin_run(start)
    connection.execute("PRAGMA wal_autocheckpoint = 20")
    for point in start.points:
        run.commit_touch(point, touch(point))
        notes.acknowledged = point
    connection.close()
    vfs.unregister()
    return notes


def lost(notes: Notes, cut: int, kept: random.Random | None, folder: Path, touch: Touched) -> int:
    """How many acknowledged touches a power cut behind so many events loses. What is left must be a sound store."""
    folder.mkdir()
    for name, content in disk_after(notes.events[:cut], kept).items():
        (folder / name).write_bytes(content)
    acknowledged = notes.acknowledged_before[cut]
    with MeasurementStore.open(folder / "runs.db") as store:
        assert store.execute("PRAGMA integrity_check") == [("ok",)]
        runs = store.runs()
        touches = runs[0].touches() if runs else {}
        assert touches == {point: touch(point) for point in touches}
        assert list(touches) == list(range(1, len(touches) + 1))
        if runs:
            resumed = store.resume_run(runs[0].id)
            assert resumed.missing() == list(range(len(touches) + 1, POINTS + 1))
            if resumed.missing():
                resumed.commit_touch(resumed.missing()[0], touch(resumed.missing()[0]))
    return max(0, acknowledged - len(touches))


@pytest.mark.parametrize("partly", [False, True], ids=["nothing unsynced is left", "a part of it is left"])
def test_a_power_cut_at_any_moment_loses_no_acknowledged_touch(
    tmp_path: Path, start: Start, touch: Touched, partly: bool
) -> None:
    notes = noted_run(tmp_path / "disk", start(POINTS), touch)
    assert sum(what == "sync" for _, what, *_ in notes.events) >= POINTS
    assert any(name == "runs.db" for name, *_ in notes.events), "the run was never checkpointed"
    draw = random.Random(14)
    for cut in draw.sample(range(len(notes.events)), CUTS):
        kept = random.Random(cut) if partly else None
        assert lost(notes, cut, kept, tmp_path / f"cut {cut}", touch) == 0, cut


def test_without_a_sync_at_every_commit_the_same_test_fails(tmp_path: Path, start: Start, touch: Touched) -> None:
    settings = tuple(setting.replace("synchronous = FULL", "synchronous = NORMAL") for setting in SETTINGS)
    assert settings != SETTINGS
    notes = noted_run(tmp_path / "disk", start(POINTS), touch, settings)
    draw = random.Random(14)
    losses = [
        lost(notes, cut, None, tmp_path / f"cut {cut}", touch) for cut in draw.sample(range(len(notes.events)), CUTS)
    ]
    assert sum(loss > 0 for loss in losses) > CUTS / 2


def test_a_power_cut_while_an_old_store_is_brought_up_to_date_loses_nothing(tmp_path: Path, touch: Touched) -> None:
    folder = tmp_path / "disk"
    folder.mkdir()
    with sqlite3.connect(folder / "runs.db") as old:
        old.executescript((Path(__file__).parent / "data" / "store_version_1.sql").read_text("utf-8"))
    kept = old.execute("SELECT * FROM touch").fetchall()
    old.close()
    notes = Notes()
    notes.add("runs.db", "write", 0, (folder / "runs.db").read_bytes())
    notes.add("runs.db", "sync")
    vfs = NotingVFS(notes)
    connection = apsw.Connection(str(folder / "runs.db"), vfs="noting")
    connection.execute("PRAGMA locking_mode = EXCLUSIVE")
    prepare(connection, folder / "runs.db")
    connection.close()
    vfs.unregister()
    versions = set()
    for cut in range(2, len(notes.events) + 1):
        after = tmp_path / f"cut {cut}"
        after.mkdir()
        for name, content in disk_after(notes.events[:cut], random.Random(cut)).items():
            (after / name).write_bytes(content)
        with sqlite3.connect(after / "runs.db") as found:
            versions |= set(found.execute("PRAGMA user_version"))
        found.close()
        with MeasurementStore.open(after / "runs.db") as store:
            assert store.execute("SELECT * FROM touch") == kept
            assert store.execute("PRAGMA integrity_check") == [("ok",)]
            assert store.resume_run(2).missing() == [4, 5, 6, 7, 8]
    assert versions == {(1,), (2,)}


#: For each line that it reads: a process of its own that measures on, or anew, so many touches, says each one that is
#: committed, and then waits; or to the end.
MEASURE = """
import os, signal, sys
from pathlib import Path
from gearmath.control.interface import RunStart, Touch
from gearmath.control.store import MeasurementStore

def measure(most):
    columns = ("run", "point", "target", "X", "Y", "Z", "A", "B", "triggered")
    points = {k: ("sphere",) for k in range(1, int(sys.argv[2]) + 1)}
    store = MeasurementStore.open(Path(sys.argv[1]))
    run = store.resume_run(1) if store.runs() else store.begin_run(RunStart("sim", "CAL.MPF", b"M30", columns, points))
    for count, point in enumerate(run.missing()):
        if count == most:
            signal.pause()
        run.commit_touch(point, Touch(1, point / 3, -point / 7, 150.0, 12.0, 45.0, 1.0))
        os.write(1, b"touch %d\\n" % point)
    run.finish("complete")

for line in sys.stdin:
    process = os.fork()
    if process == 0:
        measure(int(line))
        os._exit(0)
    os.write(1, b"process %d\\n" % process)
    os.write(1, b"end %d\\n" % os.waitpid(process, 0)[1])
"""


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no kill -9")
def test_a_run_that_is_killed_at_50_moments_ends_with_the_same_result(tmp_path: Path) -> None:
    """Every fifth kill comes while the store is opened, the others while touches are committed."""
    most, path = 32, tmp_path / "runs.db"
    points = most * CUTS
    draw, acknowledged = random.Random(14), set()
    command = [sys.executable, "-c", MEASURE, str(path), str(points)]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as server:
        assert server.stdin is not None
        assert server.stdout is not None
        for attempt in range(CUTS + 1):
            print(most if attempt < CUTS else points, file=server.stdin, flush=True)
            lines = iter(server.stdout.readline, "")
            said = dict.fromkeys(("process", "end"), -1)
            killed = attempt == CUTS
            kill_after = draw.randrange(1, 24) if attempt % 5 else 0
            for what, number in (line.split() for line in lines):
                if what == "touch":
                    acknowledged.add(int(number))
                else:
                    said[what] = int(number)
                if what == "end":
                    break
                kill_after -= what == "touch"
                if not killed and kill_after <= 0 and said["process"] > 0:
                    time.sleep(draw.uniform(0.0, 0.004))
                    os.kill(said["process"], signal.SIGKILL)
                    killed = True
            assert said["end"] == (signal.SIGKILL if attempt < CUTS else 0)
            if acknowledged:
                with MeasurementStore.open(path) as store:
                    assert acknowledged <= set(store.run(1).touches())
        server.stdin.close()
    with MeasurementStore.open(path) as store:
        run = store.run(1)
        assert run.is_complete
        assert run.touches() == {k: Touch(1, k / 3, -k / 7, 150.0, 12.0, 45.0, 1.0) for k in range(1, points + 1)}
        assert store.execute("SELECT count(*) FROM session")[0][0] > CUTS / 2
