"""A run in one line: when, who, what, how far, and how it stands. Nothing of its touches and files is read."""

from __future__ import annotations

import re
from dataclasses import dataclass
from itertools import groupby
from typing import Any

from gearmath.control.store import MeasurementStore
from gearmath.control.store_run import COMPLETE, StoredRun
from gearmath.control.store_touches import first_of

#: What a run is called that has ended in no way: it is measured now, or its computer was switched off.
OPEN = "open"
#: Touches up to the end of each section, in the text of a calibration program.
_SECTION_ENDS = re.compile(r"^(?:N\d+ )?UENDS\[\d+\]=(\d+)\s*$", re.MULTILINE)

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
    """How one run stands. Times are UTC; ``state`` is complete, open, or why the run ended before."""

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
    """First and last part of the program (R90, R91) of each stretch of ``points``, as one NC start can make it.

    A part is a point with all its touches, and a section in a calibration.
    """
    part_of = _part_of(run)
    wanted = sorted({part_of[point] for point in points})
    stretches = [list(each) for _, each in groupby(enumerate(wanted), lambda numbered: numbered[1] - numbered[0])]
    return [(stretch[0][1], stretch[-1][1]) for stretch in stretches]


def _part_of(run: StoredRun) -> dict[int, int]:
    """The part of the program in which each point of the whole plan is touched."""
    start = first_of(run).start
    places, text = start.points, start.program_text.decode("utf-8", "replace")
    ends = [int(end) for end in _SECTION_ENDS.findall(text)]
    if ends:
        return {point: 1 + sum(end < point for end in ends) for point in places}
    found, part, before = {}, 0, None
    for point, place in places.items():
        part += place != before
        found[point], before = part, place
    return found
