"""Measure: the run of the server, its points as they arrive, hold and go on; new, unfinished and repeated runs."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from nicegui import ui

from gearmath.control.run_start import SET
from gearmath.hmi import acting, blocks, programs_work, widgets
from gearmath.hmi.link import ControlLink
from gearmath.hmi.measuring_task import MeasuringTask, RunState
from gearmath.hmi.messages import Text
from gearmath.hmi.old_runs import OldRuns, why_not
from gearmath.hmi.runs_work import teeth_of
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
    runs = OldRuns(shared, text, shared.measuring)
    runs.unfinished()
    runs.again(check)
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
            teeth = teeth_of(run.start.files.get(SET, b""), place[0]) if run is not None and place else 0
            hit = text("machine.yes") if touch.triggered else text("measure.missed")
            position = {axis: f"{getattr(touch, axis):z.4f}" for axis in "XYZAB"}
            found.append({"id": point, "place": _place(text, place, teeth), **position, "triggered": hit})
        found.reverse()
        if rows.rows != found:
            rows.rows = found

    acting.watch(text, look)


def _place(text: Text, cells: tuple[str, ...], teeth: int) -> str:
    """Where a point is: member, flank, tooth, row and column, all from 0; of a calibration program the cells of its
    file. Tooth z is tooth 0, touched again at the end."""
    if len(cells) != len(_OF_MEMBER) or cells[0] not in MEMBERS:
        return " ".join(cells)
    values = dict(zip(_OF_MEMBER, cells, strict=True))
    flank = blocks.flank_names(text)[values.pop("flank")]
    if teeth and values["tooth"] == str(teeth):
        values["tooth"] = text("measure.tooth_again")
    return text("measure.place_of", **{**values, "member": blocks.member_name(text, cells[0]), "flank": flank})


def _new(shared: Shared, text: Text, link: ControlLink, task: MeasuringTask) -> Callable[[], None]:
    """Returns what raises InputError while the probe is not checked."""
    chosen = {"name": ""}

    def missing() -> str:
        return why_not(shared, text, "" if names.options else text("measure.no_program"))

    with widgets.panel(text("measure.new")):
        names = widgets.choice(text("measure.program"), [], None, lambda name: chosen.update(name=name or ""))
        widgets.heading(text("measure.check"))
        said = widgets.Message()
        by_hand = ui.checkbox(text("measure.check_by_hand"))
        with acting.buttons() as button:
            button(missing, text("measure.start"), lambda: ask_to_start(), "fiber_manual_record", primary=True)

    def checked() -> None:
        if not (link.check.is_done or (by_hand.visible and by_hand.value)):
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
        found = programs_work.probing_programs(shared.folder)
        if names.options != found:
            names.set_options(found, value=chosen["name"] if chosen["name"] in found else None)
        check = link.check
        by_hand.visible = check.state == "unknown"
        said.show(text(f"measure.check_{check.state}"), "good" if check.is_done else "info")

    acting.watch(text, look)
    return checked
