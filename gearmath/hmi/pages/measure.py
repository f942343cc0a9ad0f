"""Measure: the run of the server, its points as they arrive, hold and go on; new, unfinished and repeated runs."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

from nicegui import ui

from gearmath.hmi import acting, blocks, programs_work, widgets
from gearmath.hmi.link import ControlLink
from gearmath.hmi.measuring_task import MeasuringTask, RunState
from gearmath.hmi.messages import Text
from gearmath.hmi.probe_check import ProbeCheck
from gearmath.hmi.runs_work import UnfinishedRun, complete_runs, unfinished_runs
from gearmath.hmi.state import Shared
from gearmath.hmi.words import control_name, duration, run_state
from gearmath.specs.bevel_set import MEMBERS

#: Touches that are shown, the newest first.
_SHOWN = 12
#: What a program that probes a member says of the place of a point.
_OF_MEMBER = ("member", "flank", "tooth", "row", "col")


def build(shared: Shared, text: Text) -> None:
    """The content of the page."""
    if shared.link is None or shared.measuring is None:
        with widgets.panel(text("measure.run")):
            widgets.Message(text("measure.no_control"), "warning")
        return
    _going_on(shared, text, shared.measuring)
    check = _new(shared, text, shared.link, shared.measuring)
    _unfinished(shared, text, shared.measuring)
    _again(shared, text, shared.measuring, check)
    _touches(text, shared.measuring)


def _going_on(shared: Shared, text: Text, task: MeasuringTask) -> None:
    with widgets.panel(text("measure.run"), wide=True):
        title = widgets.note("")
        said = widgets.Message()
        bar = ui.linear_progress(0.0, show_value=False)
        bar.props["aria-label"] = text("measure.run")
        count = ui.label("").classes("gm-value gm-left")
        with widgets.row():
            hold = widgets.button(text("measure.hold"), task.hold, "pause", primary=True)
            go_on = widgets.button(
                text("measure.go_on"),
                lambda: acting.ask(shared, text, text("measure.go_on_question"), task.go_on),
                "play_arrow",
            )
            end = widgets.button(
                text("measure.end"),
                lambda: acting.ask(shared, text, text("measure.end_question"), task.stop),
                "stop",
            )
        details = widgets.note("")

    def look() -> None:
        words, kind = run_state(text, task)
        said.show(words, kind)
        run, state = task.run, task.state
        title.text = text("measure.run_number", run=run.id, program=run.start.program) if run is not None else ""
        kept, total = len(task.touches), task.total
        bar.visible = bool(total)
        bar.value = round(kept / total, 4) if total else 0.0
        words = text("measure.points", kept=kept, total=total) if total else ""
        if task.remaining is not None:
            words += f", {text('measure.remaining', time=duration(text, task.remaining))}"
        count.text = words
        waits = state in (RunState.HOLDING, RunState.HELD, RunState.LOST)
        hold.enabled, go_on.enabled = task.is_going_on and not waits, waits
        end.enabled = task.is_going_on
        last = list(task.sentences)[-3:]
        details.text = f"{text('measure.details')}: {' · '.join(map(text.quoted, last))}" if last else ""

    acting.watch(text, look)


def _touches(text: Text, task: MeasuringTask) -> None:
    axes = [(axis, f"{axis} / {'°' if axis in 'AB' else 'mm'}") for axis in "XYZAB"]
    columns = [("id", text("measure.point")), ("place", text("measure.place")), *axes]
    with widgets.panel(text("measure.touches"), wide=True):
        rows = widgets.table([*columns, ("triggered", text("measure.triggered"))], [])

    def look() -> None:
        found: list[dict[str, Any]] = []
        run = task.run
        for point, touch in list(task.touches.items())[-_SHOWN:]:
            place = run.start.points.get(point, ()) if run is not None else ()
            hit = text("machine.yes") if touch.triggered else text("measure.missed")
            position = {axis: f"{getattr(touch, axis):z.4f}" for axis in "XYZAB"}
            found.append({"id": point, "place": _place(text, place), **position, "triggered": hit})
        found.reverse()
        if rows.rows != found:
            rows.rows = found

    acting.watch(text, look)


def _place(text: Text, cells: tuple[str, ...]) -> str:
    """Where a point is: member, flank, tooth, row and column; of a calibration program the cells of its file."""
    if len(cells) != len(_OF_MEMBER) or cells[0] not in MEMBERS:
        return " ".join(cells)
    values = dict(zip(_OF_MEMBER, cells, strict=True))
    flank = blocks.flank_names(text)[values.pop("flank")]
    return text("measure.place_of", **{**values, "member": blocks.member_name(text, cells[0]), "flank": flank})


def _why_not(shared: Shared, text: Text, missing: str) -> str:
    """Why no run can begin: one goes on, what is ``missing``, or there is no connection; empty where it can."""
    assert shared.link is not None
    assert shared.measuring is not None
    if shared.measuring.is_going_on:
        return text("measure.goes_on")
    if missing or shared.link.view.connected:
        return missing
    return text("measure.not_connected", control=control_name(text, shared))


def _new(shared: Shared, text: Text, link: ControlLink, task: MeasuringTask) -> Callable[[], None]:
    """Returns what raises InputError while the probe is not checked."""
    chosen = {"name": ""}
    check = ProbeCheck()

    def missing() -> str:
        return _why_not(shared, text, "" if names.options else text("measure.no_program"))

    with widgets.panel(text("measure.new")):
        names = widgets.choice(text("measure.program"), [], None, lambda name: chosen.update(name=name or ""))
        widgets.heading(text("measure.check"))
        said = widgets.Message()
        by_hand = ui.checkbox(text("measure.check_by_hand"))
        with acting.buttons() as button:
            button(missing, text("measure.start"), lambda: ask_to_start(), "fiber_manual_record", primary=True)

    def checked() -> None:
        if not (check.is_done or by_hand.value):
            raise widgets.Refusal(text("measure.check_needed"))

    def ask_to_start() -> None:
        if not (name := chosen["name"]):
            raise widgets.Refusal(text("measure.program_needed"))
        checked()
        choice = shared.choice
        values = {"program": name, "control": control_name(text, shared), "gear_set": choice.gear_set}
        acting.ask(
            shared,
            text,
            text("measure.start_question", **values),
            lambda: task.start(shared.folder / name, choice),
        )

    def look() -> None:
        found = [one.name for one in programs_work.programs(shared.folder)]
        if names.options != found:
            names.set_options(found, value=chosen["name"] if chosen["name"] in found else None)
        check.look(None if link.view.is_stale else link.view.probe)
        by_hand.visible = check.state == "unknown"
        said.show(text(f"measure.check_{check.state}"), "good" if check.is_done else "info")

    acting.watch(text, look)
    return checked


def _unfinished(shared: Shared, text: Text, task: MeasuringTask) -> None:
    with widgets.panel(text("measure.unfinished")):
        none = widgets.note(text("measure.none_unfinished"))
        place = ui.element("div").classes("gm-follow")
    shown: list[list[UnfinishedRun] | None] = [None]

    def missing() -> str:
        return _why_not(shared, text, "")

    def ask_to_resume(one: UnfinishedRun) -> None:
        values = {"run": one.run, "program": one.program, "kept": one.kept, "total": one.total}
        acting.ask(shared, text, text("measure.resume_question", **values), lambda: task.resume(one.run))

    def look() -> None:
        own = task.run.id if task.is_going_on and task.run is not None else None
        found = [one for one in unfinished_runs(shared.store) if one.run != own][:10]
        none.visible = not found
        if shown[0] != found:
            shown[0] = found
            draw(found)

    def draw(found: list[UnfinishedRun]) -> None:
        place.clear()
        with place, acting.buttons() as button, ui.element("div").classes("gm-list"):
            for one in found:
                widgets.note(
                    f"{text('measure.run_number', run=one.run, program=one.program)}, "
                    f"{text('measure.points', kept=one.kept, total=one.total)}, "
                    f"{text('measure.begun')} {one.begun[:16].replace('T', ' ')} UTC. "
                    f"{text('measure.why')}: {text.quoted(one.why) or text('measure.open')}"
                )
                button(missing, text("measure.resume", run=one.run), partial(ask_to_resume, one), "replay")

    acting.watch(text, look, 4 * widgets.LOOK)


def _again(shared: Shared, text: Text, task: MeasuringTask, checked: Callable[[], None]) -> None:
    chosen: dict[str, int | None] = {"run": None}

    def missing() -> str:
        return _why_not(shared, text, "" if runs.options else text("measure.no_complete"))

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
        checked()
        program = complete_runs(shared.store)[run]
        choice = shared.choice
        acting.ask(
            shared,
            text,
            text("measure.again_question", points=wanted, run=run),
            lambda: task.start(shared.folder / program, choice, wanted, run),
        )

    def look() -> None:
        found = {run: f"{run}: {program}" for run, program in complete_runs(shared.store).items()}
        if runs.options != found:
            runs.set_options(found, value=chosen["run"] if chosen["run"] in found else None)

    acting.watch(text, look, 4 * widgets.LOOK)
