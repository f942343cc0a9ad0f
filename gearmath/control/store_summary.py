"""A run in one line: when, who, what, how far, and how it stands. Nothing of its touches and files is read."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from gearmath.control.parts import stretches_of
from gearmath.control.store import MeasurementStore
from gearmath.control.store_run import CLOSED, COMPLETE, StoredRun
from gearmath.control.store_touches import first_of

#: What a run is called that has ended in no way: it is measured now, or its computer was switched off.
OPEN = "open"

_SUMMARY = """
    SELECT run, begun, operator, host, control, program, gearmath, refers_to,
        (SELECT member FROM planned WHERE planned.run = run.run LIMIT 1),
        (SELECT count(*) FROM planned WHERE planned.run = run.run),
        (SELECT count(*) FROM touch WHERE touch.run = run.run),
        (SELECT max(taken) FROM touch WHERE touch.run = run.run),
        (SELECT count(*) FROM alarm WHERE alarm.run = run.run AND active),
        (SELECT outcome FROM ending WHERE ending.run = run.run AND at >= (
            SELECT max(at) FROM session WHERE session.run = run.run) ORDER BY number DESC LIMIT 1)
    FROM run {where} ORDER BY run
"""


@dataclass(frozen=True)
class RunSummary:
    """How one run stands. Times are UTC; ``state`` is complete, open, closed with a note, or why it ended before."""

    run: int
    begun: str
    operator: str
    host: str
    control: str
    program: str
    gearmath: str
    refers_to: int | None
    member: str | None
    points: int
    touches: int
    last_touch: str | None
    alarms: int
    state: str

    @property
    def is_complete(self) -> bool:
        return self.state == COMPLETE

    @property
    def closed(self) -> str:
        """The note with which it was closed; empty where it was not."""
        return self.state.removeprefix(CLOSED) if self.state.startswith(CLOSED) else ""


def summaries(store: MeasurementStore) -> list[RunSummary]:
    """All runs of a store, the oldest first."""
    return [_summary(row) for row in store.execute(_SUMMARY.format(where=""))]


def summary(run: StoredRun) -> RunSummary:
    """One run of a store."""
    (row,) = run.store.execute(_SUMMARY.format(where="WHERE run = ?"), run.id)
    return _summary(row)


def _summary(row: tuple) -> RunSummary:
    values: list[Any] = list(row)
    values[-1] = values[-1] or OPEN
    return RunSummary(*values)


def parts(run: StoredRun, points: list[int]) -> list[tuple[int, int]]:
    """First and last part of the program (R90, R91) of each stretch of ``points``, as one NC start can make it."""
    start = first_of(run).start
    return stretches_of(start.points, start.program_text.decode("utf-8", "replace"), points)
