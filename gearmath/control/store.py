"""The measurement store: runs of a probe in one SQLite file, a touch on the disk before the control hears of it.

Nothing of a run is ever changed or removed; the tables refuse it. ``MeasurementStore`` and ``StoredRun`` are what
the protocols ``Store`` and ``Run`` in :mod:`gearmath.control.interface` ask for.
"""

from __future__ import annotations

import getpass
import hashlib
import os
import socket
import sqlite3
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from gearmath.arguments.call import checked_call
from gearmath.arguments.kinds import Anything, Content, Record
from gearmath.control.interface import RunStart
from gearmath.control.store_place import check_local
from gearmath.control.store_run import StoredRun, now
from gearmath.control.store_schema import prepare
from gearmath.errors import ComputationError, InputError
from gearmath.shown import Shown, Shows
from gearmath.version import __version__

#: Columns of the touch file before and after the cells that say where a point is, and these cells.
_BEFORE, _AFTER = ("run", "point"), ("X", "Y", "Z", "A", "B", "triggered")
PLACES = (("member", "flank", "tooth", "row", "col"), ("target",))
#: How long [s] one process waits for another one that writes.
_PATIENCE = 10.0


class MeasurementStore(Shown):
    """A store that is open, by a connection that :func:`prepare` has set."""

    def __init__(self, connection: Any, path: Path) -> None:
        self.connection, self.path = connection, path
        self._one_at_a_time = threading.Lock()

    @staticmethod
    @checked_call
    def open(path: str | Path, create: bool = True) -> MeasurementStore:
        """Open a store, by default made where there is none.

        Raises InputError for a file that is no store, for a store of a newer version, a network share, a place that
        cannot be written, and, unless ``create``, for a file that is not there.
        """
        path = Path(path)
        if not os.path.exists(path) and not create:
            raise InputError(f"{path}: there is no such measurement store")
        if not os.path.isdir(path.parent):
            raise InputError(f"{path}: cannot be opened: there is no folder {path.parent}")
        check_local(path)
        is_new = not os.path.exists(path)
        connection = None
        try:
            # absolute: ":memory:" is a file, too
            connection = sqlite3.connect(
                path.absolute(), timeout=_PATIENCE, isolation_level=None, check_same_thread=False
            )
            prepare(connection, path)
        except sqlite3.Error as error:
            if connection is not None:
                connection.close()
            raise InputError(f"{path}: cannot be opened as a measurement store: {error}") from error
        except InputError:
            if connection is not None:
                connection.close()
            raise
        if is_new:
            _sync_folder(path.parent)
        return MeasurementStore(connection, path)

    def close(self) -> None:
        self.connection.close()

    def __enter__(self) -> MeasurementStore:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    @checked_call(start=Record("gearmath.control.interface", "RunStart", "a RunStart"))
    def begin_run(self, start: RunStart) -> StoredRun:
        """A new run, with all that it begins with. Raises InputError where that cannot be a run."""
        rows = _planned(start)
        with self.transaction("the run cannot be begun"):
            if start.refers_to is not None:
                self._check_again(start, self.run(start.refers_to).start)
            run = self.execute("SELECT coalesce(max(run), 0) + 1 FROM run")[0][0]
            begun = (now(), start.operator or _operator(), socket.gethostname(), __version__)
            self.execute(
                "INSERT INTO run VALUES (?, ?, ?, ?, ?, ?, ?, ?)",
                run,
                start.control,
                start.program,
                *begun,
                start.refers_to,
            )
            self.execute("INSERT INTO session VALUES (?, 1, ?, ?, ?, ?)", run, *begun)
            self._keep_file(run, "program", start.program, start.program_text)
            for name, content in start.files.items():
                self._keep_file(run, "file", name, content)
            for name, value in start.settings.items():
                self.execute("INSERT INTO setting VALUES (?, ?, ?)", run, name, value)
            for row in rows:
                self.execute("INSERT INTO planned VALUES (?, ?, ?, ?, ?, ?, ?, ?)", run, *row)
        return StoredRun(self, run, start)

    @checked_call
    def resume_run(self, run: int) -> StoredRun:
        """A run that is there and not complete, to go on with. Raises InputError where there is none such."""
        found = self.run(run)
        with self.transaction(f"run {run} cannot be resumed"):
            if found.is_complete:
                raise InputError(f"{self.path}: run {run} is complete: there is nothing to resume")
            values = (now(), _operator(), socket.gethostname(), __version__)
            self.execute("INSERT INTO session VALUES (?, ?, ?, ?, ?, ?)", run, found.next_number("session"), *values)
        return found

    @checked_call
    def run(self, run: int) -> StoredRun:
        """A run as it is kept, to be read. Raises InputError where there is none."""
        self._check(run)
        ((control, program, operator, refers_to),) = self.execute(
            "SELECT control, program, operator, refers_to FROM run WHERE run = ?", run
        )
        files = {(role, name): content for role, name, content, _ in self.files(run)}
        rows = self.execute(
            'SELECT point, member, flank, tooth, "row", col, target FROM planned WHERE run = ? ORDER BY point', run
        )
        place = PLACES[0] if not rows or rows[0][6] is None else PLACES[1]
        points = {row[0]: tuple(str(cell) for cell in row[1:] if cell is not None) for row in rows}
        settings = dict(self.execute("SELECT name, value FROM setting WHERE run = ? ORDER BY name", run))
        start = RunStart(
            control,
            program,
            files[("program", program)],
            (*_BEFORE, *place, *_AFTER),
            points,
            {name: content for (role, name), content in files.items() if role == "file"},
            settings,
            operator,
            refers_to,
        )
        return StoredRun(self, run, start)

    def runs(self) -> list[StoredRun]:
        """All runs, the oldest first."""
        return [self.run(run) for (run,) in self.execute("SELECT run FROM run ORDER BY run")]

    @checked_call
    def files(self, run: int) -> list[tuple[str, str, bytes, str]]:
        """Role (program, file), name, content and SHA-256 of what a run was begun with."""
        return self.execute(
            "SELECT role, name, content, sha256 FROM run_file JOIN file USING (sha256) WHERE run = ? "
            "ORDER BY role DESC, name",
            run,
        )

    @checked_call(sql=Content(), values=Anything())
    def execute(self, sql: str, *values: Any) -> list[tuple]:
        """Run one statement with its values and give all rows. Raises ComputationError where SQLite refuses."""
        try:
            return self.connection.execute(sql, values).fetchall()
        except sqlite3.Error as error:
            raise ComputationError(f"{self.path}: {error}") from error

    @checked_call(failed=Content())
    @contextmanager
    def transaction(self, failed: str) -> Iterator[None]:
        """All or nothing, on the disk at the end. ``failed`` is what is said where SQLite, or the disk, refuses."""
        with self._one_at_a_time:
            try:
                self.execute("BEGIN IMMEDIATE")
                yield
                self.execute("COMMIT")
            except BaseException as error:
                if self.connection.in_transaction:
                    self.execute("ROLLBACK")
                if isinstance(error.__cause__, sqlite3.Error):
                    raise ComputationError(f"{self.path}: {failed}: {error.__cause__}") from error
                raise

    def _check(self, run: int) -> None:
        if not self.execute("SELECT 1 FROM run WHERE run = ?", run):
            runs = self.execute("SELECT min(run), max(run) FROM run")[0]
            known = "it has none" if runs[0] is None else f"it has {runs[0]} to {runs[1]}"
            raise InputError(f"{self.path}: there is no run {run}: {known}")

    def _check_again(self, start: RunStart, old: RunStart) -> None:
        """Raise InputError unless every point of a run is one of the run that it refers to."""
        for point, place in start.points.items():
            if old.points.get(point) != place:
                raise InputError(
                    f"{self.path}: point {point} ({','.join(place)}) is no point of run {start.refers_to}, whose "
                    "points are to be probed again"
                )

    def _keep_file(self, run: int, role: str, name: str, content: bytes) -> None:
        sha256 = hashlib.sha256(content).hexdigest()
        self.execute("INSERT OR IGNORE INTO file VALUES (?, ?)", sha256, content)
        self.execute("INSERT INTO run_file VALUES (?, ?, ?, ?)", run, role, name, sha256)

    def _shown(self) -> tuple[str, list[Shows]]:
        return "measurement store", [("file", self.path.name, "")]


def _planned(start: RunStart) -> list[tuple]:
    """Point, member, flank, tooth, row, col and target of every point. Raises InputError for other columns."""
    place = start.columns[len(_BEFORE) : -len(_AFTER)]
    if place not in PLACES or start.columns != (*_BEFORE, *place, *_AFTER):
        raise InputError(f"{start.program}: columns {','.join(start.columns)}: are not those of touches")
    if not start.points:
        raise InputError(f"{start.program}: has no point to touch")
    rows = []
    for point, cells in start.points.items():
        if len(cells) != len(place):
            raise InputError(f"{start.program}, point {point}: {','.join(cells)}: must be {','.join(place)}")
        try:
            rows.append(
                (point, *cells[:2], *map(int, cells[2:]), None)
                if len(place) > 1
                else (point, None, None, None, None, None, cells[0])
            )
        except ValueError as error:
            raise InputError(f"{start.program}, point {point}: {','.join(cells)}: must be whole numbers") from error
    return rows


def _operator() -> str:
    """Who is logged in, as far as the system says it."""
    try:
        return getpass.getuser()
    except (OSError, KeyError, ImportError):  # nobody that the system knows
        return ""


def _sync_folder(folder: Path) -> None:
    """That the new file is in its folder must be on the disk, too. Windows has no call for it, and needs none."""
    if sys.platform != "win32":
        handle = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(handle)
        finally:
            os.close(handle)
