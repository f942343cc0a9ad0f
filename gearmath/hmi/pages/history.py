"""Page history: all runs and how they stand, two of them compared, and the trend of figures over the runs."""

from __future__ import annotations

from collections.abc import Callable, Hashable
from typing import Any

from nicegui import ui

from gearmath.control.store_compare import Comparison
from gearmath.control.store_picture import figure_title, runs_figure, trend_figure
from gearmath.hmi import acting, blocks, widgets
from gearmath.hmi.drawing import drawn
from gearmath.hmi.judged_runs import JudgedRuns
from gearmath.hmi.messages import Text
from gearmath.hmi.run_history import PastRun, comparison, past_runs, trend
from gearmath.hmi.state import Shared
from gearmath.hmi.work import Progress

#: A comparison, its picture, and sentences on what was left out.
_Drawn = tuple[Comparison, str, list[str]]


def build(shared: Shared, text: Text) -> None:
    """The content of the page."""
    desk = shared.desk
    with widgets.panel(text("history.runs"), wide=True):
        blocks.follow(
            lambda: (desk.decisions, tuple((one.run, one.touches, one.state) for one in desk.runs.summaries())),
            lambda: _list(text, past_runs(desk.runs)),
        )
    with widgets.panel(text("history.comparison"), wide=True):
        _comparison(shared, text)
    with widgets.panel(text("history.trend"), wide=True):
        _trend(shared, text)


def _list(text: Text, runs: list[PastRun]) -> None:
    if not runs:
        widgets.note(text("history.no_run"))
        return
    rows = []
    for one in runs:
        run = one.summary
        known = text.has(f"history.{run.state}")
        state = [text(f"history.{run.state}") if known else text.quoted(run.state)]
        state += [] if run.refers_to is None else [text("history.again", run=run.refers_to)]
        decided = [text(f"history.{one.decision}")] if one.decision else []
        rows.append(
            [
                str(run.run),
                run.begun[:16].replace("T", " "),
                blocks.member_name(text, run.member),
                run.program,
                run.operator,
                f"{run.touches} / {run.points}",
                str(run.alarms),
                ", ".join(state),
                ", ".join(part for part in (*decided, one.note, *one.files) if part),
            ]
        )
    keys = ("run", "begun", "member", "program", "operator", "touches", "alarms", "state", "decision")
    blocks.plain_table("", [text(f"history.{key}") for key in keys], rows, numbers=len(keys))


def _comparison(shared: Shared, text: Text) -> None:
    """Two runs of one member: figures with their change, what was not the same, and both in one picture."""
    desk = shared.desk

    def other(run: str) -> None:
        desk.compared = int(run)

    def choices() -> None:
        runs = {str(one.run): blocks.run_name(text, one) for one in reversed(desk.runs.of_members())}
        widgets.choice(text("history.with"), runs, str(_other(shared)), other)

    def key() -> Hashable:
        pair = (desk.shown_run(), _other(shared))
        return None if None in pair or pair[0] == pair[1] else pair

    def compute() -> Callable[[Progress], _Drawn]:
        pair: Any = (desk.shown_run(), _other(shared))
        return lambda progress: _compared(desk.runs, pair, progress)

    def compared() -> None:
        if len(desk.runs.of_members()) < 2:
            widgets.note(text("history.too_few"))
            return
        with widgets.row():
            blocks.run_choice(shared, text)
            blocks.follow(lambda: (_other(shared), len(desk.runs.of_members())), choices)
        blocks.kept(
            text,
            desk.of("history.comparison"),
            key,
            text("history.comparing"),
            compute,
            lambda found: _compare(text, *found),
            text("history.choose_two"),
        )

    blocks.follow(lambda: len(desk.runs.of_members()) < 2, compared)


def _compare(text: Text, found: Comparison, svg: str, _: list[str]) -> None:
    names = blocks.flank_names(text)
    for sentence in found.differs:
        widgets.note(text.quoted(sentence))
    rows = []
    for row in found.figures:
        cells = [
            "–" if value is None else f"{value:z.2f}" for value in (*row.values, row.change, row.change_uncertainty)
        ]
        verdict = {None: "history.not_known", True: "history.changed", False: "history.noise"}[row.beyond_noise]
        rows.append([f"{blocks.figure_name(text, row.name)}, {names[row.flank]}", *cells, text(verdict)])
    first, last = (text("history.of_run", run=one.run.id) for one in found.runs)
    head = [text("history.figure"), *(f"{word} / µm" for word in (first, last, text("history.change"), "u"))]
    blocks.plain_table(text("history.figures"), [*head, text("history.verdict")], rows)
    blocks.chart(text, svg, text("history.comparison"), across=True)


def _trend(shared: Shared, text: Text) -> None:
    """Every figure over the last runs of the member of the run that is shown, when somebody asks."""
    desk = shared.desk

    def now() -> Hashable:
        return desk.shown_run(), tuple(one.run for one in desk.runs.of_members())

    def missing() -> str:
        runs = {one.run: one.member for one in desk.runs.of_members()}
        alike = [run for run, member in runs.items() if member == runs.get(desk.shown_run() or 0)]
        return "" if len(alike) > 1 else text("history.too_few_for_trend")

    def key() -> Hashable:
        return now() if desk.wanted.get("trend") == now() else None

    def begin() -> None:
        desk.wanted["trend"] = now()

    def compute() -> Callable[[Progress], _Drawn]:
        run: Any = desk.shown_run()
        return lambda progress: _drawn_trend(desk.runs, run, progress)

    with acting.buttons() as button:
        button(missing, text("history.show_trend"), begin, "show_chart", primary=True)
    blocks.kept(
        text,
        desk.of("history.trend"),
        key,
        text("history.comparing"),
        compute,
        lambda found: _show_trend(text, *found),
    )


def _show_trend(text: Text, found: Comparison, svg: str, left_out: list[str]) -> None:
    for sentence in left_out:
        widgets.Message(text.quoted(sentence), "warning")
    widgets.note(text("history.bars"))
    with ui.element("div").classes("gm-follow"):
        blocks.chart(text, svg, text("history.trend"), names=words_of_trend(text, found))
    names, runs = blocks.flank_names(text), [one.run.id for one in found.runs]
    rows = [
        [
            f"{blocks.figure_name(text, row.name)}, {names[row.flank]}",
            *("–" if v is None else f"{v:z.2f}" for v in row.values),
        ]
        for row in found.figures
    ]
    head = [f"{text('history.figure')} / µm", *(text("history.of_run", run=run) for run in runs)]
    blocks.plain_table(text("history.figures"), head, rows)


def words_of_trend(text: Text, found: Comparison) -> dict[str, str]:
    """What the figures over the charts of a trend are called on the page."""
    return {figure_title(row.name): blocks.figure_name(text, row.name) for row in found.figures}


def _other(shared: Shared) -> int | None:
    """The run to compare with: the one chosen, or else the one before the run that is shown."""
    desk, shown = shared.desk, shared.desk.shown_run()
    if desk.compared is not None:
        return desk.compared
    others = [one.run for one in desk.runs.of_members() if one.run != shown]
    return max((run for run in others if shown is not None and run < shown), default=others[-1] if others else None)


def _compared(runs: JudgedRuns, pair: tuple[int, int], progress: Progress) -> _Drawn:
    found = comparison(runs, pair, progress)
    return found, drawn(lambda: runs_figure(found)), []


def _drawn_trend(runs: JudgedRuns, run: int, progress: Progress) -> _Drawn:
    found, left_out = trend(runs, run, progress)
    return found, drawn(lambda: trend_figure(found)), left_out
