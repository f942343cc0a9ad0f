"""One run of a measurement store: its touches, alarms, results and how it ended."""

from __future__ import annotations

import math
from collections.abc import Mapping
from datetime import UTC, datetime
from typing import TYPE_CHECKING, Any

from gearmath.control.interface import Alarm, RunStart, Touch
from gearmath.errors import ComputationError, InputError
from gearmath.shown import Shown, Shows
from gearmath.version import __version__

if TYPE_CHECKING:
    from gearmath.control.store import MeasurementStore

COMPLETE = "complete"
#: What the outcome of a run begins with that nobody will go on with; a note says why.
CLOSED = "closed: "
#: Characters of a note at most.
NOTE = 500


class StoredRun(Shown):
    """One run of a store: ``id`` is its number, ``start`` what it was begun with."""

    def __init__(self, store: MeasurementStore, run: int, start: RunStart) -> None:
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
                self.id,
                point,
                int(touch.number),
                *touch[1:6],
                int(touch.triggered),
                now(),
            )

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

    def close(self, note: str) -> None:
        """Keep that nobody will go on with the run, and why. What was touched stays.

        Raises InputError for a note that is missing or too long, and for a run that is complete.
        """
        if self.is_complete:
            raise InputError(f"{self.store.path}: run {self.id} is complete: there is nothing to close")
        self.finish(f"{CLOSED}{noted(note)}")

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
                self.id,
                self.next_number("result"),
                now(),
                __version__,
                kind,
                content,
            )

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

    def _shown(self) -> tuple[str, list[Shows]]:
        points = len(self.start.points)
        return f"run {self.id} of {self.start.program}", [("control", self.start.control, ""), ("points", points, "")]


def noted(note: str) -> str:
    """A note as it is kept. Raises InputError for one that is missing or too long."""
    plain = note.strip()
    if not plain:
        raise InputError("note: is missing: say why")
    if len(plain) > NOTE:
        raise InputError(f"note: has {len(plain)} characters, must have at most {NOTE}")
    return plain


def now() -> str:
    """The time in UTC, to the millisecond."""
    return datetime.now(UTC).isoformat(timespec="milliseconds").replace("+00:00", "Z")
