"""Runs of the measurement store as the page lists them."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

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
    """Those that are not complete, the newest first."""
    return [
        UnfinishedRun(one.run, one.program, one.begun, one.touches, one.points, "" if one.state == OPEN else one.state)
        for one in reversed(_runs(store))
        if not one.is_complete
    ]


def complete_runs(store: Path) -> dict[int, str]:
    """The programs of those that are complete, by number, the newest first."""
    return {one.run: one.program for one in reversed(_runs(store)) if one.is_complete}


def _runs(store: Path) -> list[RunSummary]:
    if not store.exists():
        return []
    with MeasurementStore.open(store, create=False) as found:
        return summaries(found)
