"""Runs of the measurement store as the page lists them."""

from __future__ import annotations

import tomllib
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

from gearmath.control.parts import chosen_points
from gearmath.control.store import MeasurementStore
from gearmath.control.store_summary import OPEN, RunSummary, summaries


@dataclass(frozen=True)
class UnfinishedRun:
    """A run that can be resumed; ``why`` is empty where nothing says how it ended."""

    run: int
    program: str
    begun: str
    kept: int
    total: int
    why: str


def unfinished_runs(store: Path) -> list[UnfinishedRun]:
    """Those that are not complete, the newest first; of which nothing was touched, or that were closed, are none."""
    return [
        UnfinishedRun(one.run, one.program, one.begun, one.touches, one.points, "" if one.state == OPEN else one.state)
        for one in reversed(_runs(store))
        if one.touches and not one.is_complete and not one.closed
    ]


def close_run(store: Path, run: int, note: str) -> None:
    """Keep that nobody will go on with a run. Raises InputError for a note that is missing, and for a complete run."""
    with MeasurementStore.open(store, create=False) as found:
        found.run(run).close(note)


def checked_points(store: Path, run: int, points: str) -> None:
    """Raises InputError where points, such as ``3,17-20``, are none of a run."""
    with MeasurementStore.open(store, create=False) as found:
        chosen_points("points", points, found.run(run).start.points)


@lru_cache(maxsize=4)
def teeth_of(gear_set: bytes, member: str) -> int:
    """Teeth of a member, by the set as it is stored with a run; 0 where that does not say it."""
    try:
        return int(tomllib.loads(gear_set.decode("utf-8"))[member]["teeth"])
    except (ValueError, LookupError, TypeError):
        return 0


def complete_runs(store: Path) -> dict[int, str]:
    """The programs of those that are complete, by number, the newest first."""
    return {one.run: one.program for one in reversed(_runs(store)) if one.is_complete}


def _runs(store: Path) -> list[RunSummary]:
    if not store.exists():
        return []
    with MeasurementStore.open(store, create=False) as found:
        return summaries(found)
