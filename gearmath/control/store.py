"""The measurement store: runs of a probe in one SQLite file, a touch on the disk before the control hears of it.

Nothing of a run is ever changed or removed; the tables refuse it. ``Store`` and ``Run`` are what the protocols of the
same name in :mod:`gearmath.control.interface` ask for.
"""

from __future__ import annotations

import getpass
import hashlib
import math
import os
import socket
import sqlite3
import sys
import threading
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from gearmath.control.interface import Alarm, RunStart, Touch
from gearmath.control.store_place import check_local
from gearmath.control.store_schema import prepare
from gearmath.errors import ComputationError, InputError
from gearmath.version import __version__

#: Columns of the touch file before and after the cells that say where a point is, and these cells.
_BEFORE, _AFTER = ("run", "point"), ("X", "Y", "Z", "A", "B", "triggered")
PLACES = (("member", "flank", "tooth", "row", "col"), ("target",))
COMPLETE = "complete"
#: How long [s] one process waits for another one that writes.
_PATIENCE = 10.0


class Store:
    """A store that is open, by a connection that :func:`prepare` has set."""

    def __init__(self, connection: Any, path: Path) -> None:
        self.connection, self.path = connection, path
        self._one_at_a_time = threading.Lock()

    @staticmethod
    def open(path: Path, create: bool = True) -> Store:
        """Open a store, by default made where there is none.

        Raises InputError for a file that is no store, for a store of a newer version, a network share, a place that
        cannot be written, and, unless ``create``, for a file that is not there.
        """
        path = Path(path)
        if not path.exists() and not create:
            raise InputError(f"{path}: there is no such measurement store")
        if not path.parent.is_dir():
            raise InputError(f"{path}: cannot be opened: there is no folder {path.parent}")
        check_local(path)
        is_new = not path.exists()
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
        return Store(connection, path)

    def close(self) -> None:
        self.connection.close()

    def __enter__(self) -> Store:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def begin_run(self, start: RunStart) -> Run:
        """A new run, with all that it begins with. Raises InputError where that cannot be a run."""
        rows = _planned(start)
        with self.transaction("the run cannot be begun"):
            if start.refers_to is not None:
                self._check_again(start, self.run(start.refers_to).start)
            run = self.execute("SELECT coalesce(max(run), 0) + 1 FROM run")[0][0]
            begun = (now(), start.operator or _operator(), socket.gethostname(), __version__)
            self.execute(
                "INSERT INTO run VALUES (?, ?, ?, ?, ?, ?, ?, ?)",
                run, start.control, start.program, *begun, start.refers_to,
            )  # fmt: skip
            self.execute("INSERT INTO session VALUES (?, 1, ?, ?, ?, ?)", run, *begun)
            self._keep_file(run, "program", start.program, start.program_text)
            for name, content in start.files.items():
                self._keep_file(run, "file", name, content)
            for name, value in start.settings.items():
                self.execute("INSERT INTO setting VALUES (?, ?, ?)", run, name, value)
            for row in rows:
                self.execute("INSERT INTO planned VALUES (?, ?, ?, ?, ?, ?, ?, ?)", run, *row)
        return Run(self, run, start)

    def resume_run(self, run: int) -> Run:
        """A run that is there and not complete, to go on with. Raises InputError where there is none such."""
        found = self.run(run)
        with self.transaction(f"run {run} cannot be resumed"):
            if found.is_complete:
                raise InputError(f"{self.path}: run {run} is complete: there is nothing to resume")
            values = (now(), _operator(), socket.gethostname(), __version__)
            self.execute("INSERT INTO session VALUES (?, ?, ?, ?, ?, ?)", run, found.next_number("session"), *values)
        return found

    def run(self, run: int) -> Run:
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
            control, program, files[("program", program)], (*_BEFORE, *place, *_AFTER), points,
            {name: content for (role, name), content in files.items() if role == "file"}, settings, operator, refers_to,
        )  # fmt: skip
        return Run(self, run, start)

    def runs(self) -> list[Run]:
        """All runs, the oldest first."""
        return [self.run(run) for (run,) in self.execute("SELECT run FROM run ORDER BY run")]

    def files(self, run: int) -> list[tuple[str, str, bytes, str]]:
        """Role (program, file), name, content and SHA-256 of what a run was begun with."""
        return self.execute(
            "SELECT role, name, content, sha256 FROM run_file JOIN file USING (sha256) WHERE run = ? "
            "ORDER BY role DESC, name",
            run,
        )

    def execute(self, sql: str, *values: Any) -> list[tuple]:
        """Run one statement with its values and give all rows. Raises ComputationError where SQLite refuses."""
        try:
            return self.connection.execute(sql, values).fetchall()
        except sqlite3.Error as error:
            raise ComputationError(f"{self.path}: {error}") from error

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


class Run:
    """One run of a store: ``id`` is its number, ``start`` what it was begun with."""

    def __init__(self, store: Store, run: int, start: RunStart) -> None:
        self.store, self.id, self.start = store, run, start

    def commit_touch(self, point: int, values: Touch) -> None:
        """Keep a touch; on return it is on the disk, and may be acknowledged.

        Raises InputError for a point that the run does not have or that is kept already, for values that are no
        numbers, and for a run that is complete; ComputationError where the disk does not take it.
        """
        touch = Touch(*values)
        if not all(math.isfinite(value) for value in touch) or touch.triggered not in (0, 1):
            raise InputError(f"{self._name(point)}: {', '.join(map(str, touch))}: is no touch")
        with self.store.transaction(f"{self._name(point)} cannot be kept"):
            if not self._rows("SELECT 1 FROM planned WHERE run = ? AND point = ?", point):
                raise InputError(f"{self._name(point)}: is no point of this run, which has {len(self.start.points)}")
            if self._rows("SELECT 1 FROM touch WHERE run = ? AND point = ?", point):
                raise InputError(f"{self._name(point)}: is kept already")
            if self.is_complete:
                raise InputError(f"{self._name(point)}: the run is complete")
            self.store.execute(
                "INSERT INTO touch VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?)",
                self.id, point, int(touch.number), *touch[1:6], int(touch.triggered), now(),
            )  # fmt: skip

    def touches(self) -> Mapping[int, Touch]:
        """What is kept, by point."""
        rows = self._rows(
            "SELECT point, control_run, X, Y, Z, A, B, CAST (triggered AS REAL) FROM touch WHERE run = ? ORDER BY point"
        )
        return {row[0]: Touch._make(row[1:]) for row in rows}

    def missing(self) -> list[int]:
        """The points that are not kept yet, in order."""
        rows = self._rows(
            "SELECT point FROM planned LEFT JOIN touch USING (run, point) "
            "WHERE run = ? AND taken IS NULL ORDER BY point"
        )
        return [point for (point,) in rows]

    def add_alarm(self, alarm: Alarm) -> None:
        """Keep an alarm, or that it is gone, with the time when this computer heard of it."""
        with self.store.transaction(f"run {self.id}: alarm {alarm.number} cannot be kept"):
            values = (alarm.key, alarm.number, alarm.text, alarm.severity, int(alarm.active), alarm.time)
            self.store.execute(
                "INSERT INTO alarm VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?)",
                self.id,
                self.next_number("alarm"),
                now(),
                *values,
            )

    def alarms(self) -> list[Alarm]:
        """The alarms in their order."""
        rows = self._rows("SELECT key, alarm, text, severity, active, time FROM alarm WHERE run = ? ORDER BY number")
        return [Alarm(key, alarm, text, severity, bool(on), time) for key, alarm, text, severity, on, time in rows]

    def finish(self, outcome: str) -> None:
        """The run is over: ``complete``, or in words why it is not; then it may be resumed.

        Raises ComputationError for a run that is called complete and has points without a touch.
        """
        with self.store.transaction(f"run {self.id}: its end cannot be kept"):
            missing = self.missing()
            if outcome == COMPLETE and missing:
                raise ComputationError(
                    f"{self.store.path}: run {self.id}: {len(missing)} of {len(self.start.points)} points have no "
                    f"touch, the first is {missing[0]}: it is not complete"
                )
            self.store.execute(
                "INSERT INTO ending VALUES (?, ?, ?, ?)", self.id, self.next_number("ending"), now(), outcome
            )

    def sessions(self) -> list[dict[str, str]]:
        """Who began the run and who went on with it, and when."""
        rows = self._rows("SELECT at, operator, host, gearmath FROM session WHERE run = ? ORDER BY number")
        return [dict(zip(("at", "operator", "host", "gearmath"), row, strict=True)) for row in rows]

    def endings(self) -> list[dict[str, str]]:
        """How and when the run ended, each time."""
        rows = self._rows("SELECT at, outcome FROM ending WHERE run = ? ORDER BY number")
        return [dict(zip(("at", "outcome"), row, strict=True)) for row in rows]

    def add_result(self, kind: str, content: bytes) -> None:
        """Keep what was made of the run, such as its evaluation; of one kind the last one counts."""
        with self.store.transaction(f"run {self.id}: the result {kind} cannot be kept"):
            self.store.execute(
                "INSERT INTO result VALUES (?, ?, ?, ?, ?, ?)",
                self.id, self.next_number("result"), now(), __version__, kind, content,
            )  # fmt: skip

    def results(self) -> dict[str, bytes]:
        """The last result of each kind."""
        return dict(self._rows("SELECT kind, content FROM result WHERE run = ? ORDER BY number"))

    @property
    def is_complete(self) -> bool:
        return bool(self._rows("SELECT 1 FROM ending WHERE run = ? AND outcome = ?", COMPLETE))

    def next_number(self, table: str) -> int:
        """The number of a further row; ``table`` is a name of this module, no input."""
        return self._rows(f"SELECT coalesce(max(number), 0) + 1 FROM {table} WHERE run = ?")[0][0]

    def _rows(self, sql: str, *values: Any) -> list[tuple]:
        return self.store.execute(sql, self.id, *values)

    def _name(self, point: int) -> str:
        return f"{self.store.path}: run {self.id}, point {point}"


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
            rows.append((point, *cells[:2], *map(int, cells[2:]), None) if len(place) > 1 else
                        (point, None, None, None, None, None, cells[0]))  # fmt: skip
        except ValueError as error:
            raise InputError(f"{start.program}, point {point}: {','.join(cells)}: must be whole numbers") from error
    return rows


def now() -> str:
    """The time in UTC, to the millisecond."""
    return datetime.now(UTC).isoformat(timespec="milliseconds").replace("+00:00", "Z")


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
