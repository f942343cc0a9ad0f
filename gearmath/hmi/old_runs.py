"""Runs of the store on the page Measure: those that are not complete, and chosen points touched again."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

from nicegui import ui

from gearmath.control.store_run import NOTE
from gearmath.hmi import acting, widgets
from gearmath.hmi.measuring_task import MeasuringTask
from gearmath.hmi.messages import Text
from gearmath.hmi.runs_work import UnfinishedRun, checked_points, close_run, complete_runs, unfinished_runs
from gearmath.hmi.state import Shared
from gearmath.hmi.words import control_name


def why_not(shared: Shared, text: Text, missing: str) -> str:
    """Why no run can begin: one goes on, what is ``missing``, or there is no connection; empty where it can."""
    assert shared.link is not None
    assert shared.measuring is not None
    if shared.measuring.is_going_on:
        return text("measure.goes_on")
    if missing or shared.link.view.connected:
        return missing
    return text("measure.not_connected", control=control_name(text, shared))


class OldRuns:
    """The two parts, as one browser sees them."""

    def __init__(self, shared: Shared, text: Text, task: MeasuringTask) -> None:
        self.shared, self.text, self.task = shared, text, task
        self.note: ui.input | None = None

    def unfinished(self) -> None:
        """Runs that can be resumed, or closed with a note."""
        text = self.text
        with widgets.panel(text("measure.unfinished")):
            none = widgets.note(text("measure.none_unfinished"))
            place = ui.element("div").classes("gm-follow")
            self.note = ui.input(text("measure.close_note")).classes("gm-text").props("outlined dense")
            self.note.props["maxlength"] = NOTE
        shown: list[list[UnfinishedRun] | None] = [None]

        def look() -> None:
            task = self.task
            own = task.run.id if task.is_going_on and task.run is not None else None
            found = [one for one in unfinished_runs(self.shared.store) if one.run != own][:10]
            none.visible = not found
            if self.note is not None:
                self.note.visible = bool(found)
            if shown[0] != found:
                shown[0] = found
                place.clear()
                with place:
                    self._draw(found)

        acting.watch(text, look, 4 * widgets.LOOK)

    def _draw(self, found: list[UnfinishedRun]) -> None:
        text = self.text
        with acting.buttons() as button, ui.element("div").classes("gm-list"):
            for one in found:
                widgets.note(
                    f"{text('measure.run_number', run=one.run, program=one.program)}, "
                    f"{text('measure.points', kept=one.kept, total=one.total)}, "
                    f"{text('measure.begun')} {one.begun[:16].replace('T', ' ')} UTC. "
                    f"{text('measure.why')}: {text.quoted(one.why) or text('measure.open')}"
                )
                resume, close = text("measure.resume", run=one.run), text("measure.close", run=one.run)
                button(lambda: why_not(self.shared, text, ""), resume, partial(self._ask_to_resume, one), "replay")
                button(str, close, partial(self._ask_to_close, one), "done_all")

    def _ask_to_resume(self, one: UnfinishedRun) -> None:
        values = {"run": one.run, "program": one.program, "kept": one.kept, "total": one.total}
        question = self.text("measure.resume_question", **values)
        acting.ask(self.shared, self.text, question, lambda: self.task.resume(one.run))

    def _ask_to_close(self, one: UnfinishedRun) -> None:
        text, field = self.text, self.note
        note = ((field.value if field is not None else None) or "").strip()
        if not note:
            raise widgets.Refusal(text("measure.close_needs_note"))

        def close() -> None:
            if self.task.is_going_on and self.task.run is not None and self.task.run.id == one.run:
                raise widgets.Refusal(text("measure.goes_on"))
            close_run(self.shared.store, one.run, note)
            if field is not None:
                field.value = ""

        question = text("measure.close_question", run=one.run, kept=one.kept, total=one.total, note=note)
        acting.ask(self.shared, text, question, close)

    def again(self, checked: Callable[[], None]) -> None:
        """Chosen points of a complete run, as a run of their own; ``checked`` raises while the probe is not."""
        shared, text = self.shared, self.text
        chosen: dict[str, int | None] = {"run": None}

        def missing() -> str:
            return why_not(shared, text, "" if runs.options else text("measure.no_complete"))

        with widgets.panel(text("measure.again")):
            runs = widgets.choice(text("measure.again_run"), {}, None, lambda run: chosen.update(run=run))
            points = widgets.word(text("measure.again_points"), "", "")
            with acting.buttons() as button:
                button(missing, text("measure.again_start"), lambda: ask_again(), "replay")

        def ask_again() -> None:
            run, wanted = chosen["run"], (points.value or "").strip()
            if run is None:
                raise widgets.Refusal(text("measure.run_needed"))
            if not wanted:
                raise widgets.Refusal(text("measure.points_needed"))
            checked_points(shared.store, run, wanted)
            checked()
            question = text("measure.again_question", points=wanted, run=run)
            acting.ask(shared, text, question, lambda: self.task.start_again(run, wanted))

        def look() -> None:
            found = {run: f"{run}: {program}" for run, program in complete_runs(shared.store).items()}
            if runs.options != found:
                runs.set_options(found, value=chosen["run"] if chosen["run"] in found else None)

        acting.watch(text, look, 4 * widgets.LOOK)
