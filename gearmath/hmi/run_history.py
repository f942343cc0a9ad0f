"""Stored runs in their order: how each stands, what was decided, two compared, and the trend of figures over all."""

from __future__ import annotations

import json
from collections import defaultdict
from dataclasses import dataclass

from gearmath.control.store_compare import Comparison, compare
from gearmath.control.store_evaluation import EvaluatedRun
from gearmath.control.store_summary import RunSummary
from gearmath.errors import InputError
from gearmath.hmi.correcting import DECISION
from gearmath.hmi.judged_runs import JudgedRuns, Progress

#: A trend is over so many runs at most, the last ones.
MOST = 12


@dataclass(frozen=True)
class Decided:
    """What was decided on a correction, accepted or rejected, with its note and the files that were written."""

    decision: str
    note: str
    files: tuple[str, ...]


@dataclass(frozen=True)
class PastRun:
    """How a run stands, and all that was decided on its corrections, the last one at the end."""

    summary: RunSummary
    decided: tuple[Decided, ...]


def past_runs(runs: JudgedRuns) -> list[PastRun]:
    """All runs, the newest first; none where there is no store yet."""
    found = runs.summaries()
    if not found:
        return []
    with runs.opened() as store:
        rows = store.execute("SELECT run, content FROM result WHERE kind = ? ORDER BY run, number", DECISION)
    decided: dict[int, list[Decided]] = defaultdict(list)
    for run, content in rows:
        one = json.loads(content)
        decided[run].append(
            Decided(one["decision"], one["note"], tuple(file["name"] for file in one["files"].values()))
        )
    return [PastRun(summary, tuple(decided[summary.run])) for summary in reversed(found)]


def comparison(runs: JudgedRuns, numbers: tuple[int, ...], progress: Progress = lambda _: None) -> Comparison:
    """Runs of one member side by side, in the order of their numbers.

    Raises InputError for less than two, for runs of different members, and for one that cannot be evaluated.
    """
    wanted = sorted(set(numbers))
    if len(wanted) < 2:
        raise InputError(f"runs {', '.join(map(str, numbers))}: must be two different runs")
    return compare([runs.evaluated(number, progress) for number in wanted])


def trend(runs: JudgedRuns, like: int, progress: Progress = lambda _: None) -> tuple[Comparison, list[str]]:
    """The figures over the last whole runs of the member of run ``like``, and why runs were left out.

    Raises InputError where there are less than two of them.
    """
    model = runs.evaluated(like, progress)
    found: list[EvaluatedRun] = []
    left_out: list[str] = []
    for summary in reversed(runs.whole()):
        if len(found) == MOST:
            break
        try:
            one = runs.evaluated(summary.run, progress)
        except InputError as error:
            left_out.append(str(error))
            continue
        if (one.name, one.member.teeth) == (model.name, model.member.teeth):
            found.append(one)
    if len(found) < 2:
        raise InputError(f"run {like}: a trend needs two runs of the {model.name}, and there is one")
    return compare(found[::-1]), left_out
