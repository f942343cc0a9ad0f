"""Programs: written, milled virtually, read, and sent to the control."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import Future
from pathlib import Path
from typing import Any, TypeVar

from nicegui import ui

from gearmath.errors import ComputationError, InputError
from gearmath.hmi import blocks, programs_work, widgets
from gearmath.hmi.messages import Text
from gearmath.hmi.programs_work import MilledProgram, WrittenProgram
from gearmath.hmi.state import Choice, Shared
from gearmath.hmi.words import control_name, duration
from gearmath.hmi.work import Progress, Work
from gearmath.machine.measuring.checked import ProbingChoice
from gearmath.machine.planning.cut_plan import CuttingJob
from gearmath.specs.measurement import MOST_TOUCHES

#: What the fields ask for: a cutting job, or what is probed.
Asked = TypeVar("Asked", CuttingJob, ProbingChoice)

#: The computations of this page.
_CUT, _PROBE, _MILL, _SEND = "programs.cut", "programs.probe", "programs.mill", "programs.send"


def build(shared: Shared, text: Text) -> None:
    """The content of the page."""
    _cutting(shared, text)
    _probing(shared, text)
    _written(shared, text)


def _head(shared: Shared, text: Text, name: str) -> ui.input:
    """What the program is for, and the field of its name."""
    choice = shared.choice
    values = {"gear_set": choice.gear_set, "member": blocks.member_name(text, choice.member), "machine": choice.machine}
    widgets.note(text("programs.chosen", **values))
    return widgets.word(text("programs.name"), name, text("programs.name_hint"))


def _cutting(shared: Shared, text: Text) -> None:
    work = shared.works[_CUT]
    with widgets.panel(text("programs.cut")):
        name = _head(shared, text, f"CUT_{shared.choice.member.upper()}")
        with widgets.fields():
            fields = {
                "feed": widgets.NumberField(text, text("programs.feed"), 300.0, "mm/min", 1.0, 5000.0),
                "spindle_rpm": widgets.NumberField(text, text("programs.rpm"), 120.0, "1/min", 1.0, 20000.0),
                "tolerance": widgets.NumberField(text, text("programs.tolerance"), 0.1, "µm", 0.01, 100.0),
                "roughing_stock": widgets.NumberField(text, text("programs.roughing"), 0.0, "mm", 0.0, 5.0),
                "finishing_stock": widgets.NumberField(text, text("programs.finishing"), 0.0, "mm", 0.0, 5.0),
            }
        dry = ui.checkbox(text("programs.dry_run"))

        def job() -> CuttingJob:
            values = widgets.numbers(fields)
            return CuttingJob(
                tolerance=values["tolerance"] / 1000,
                feed=values["feed"],
                spindle_rpm=values["spindle_rpm"],
                roughing_stock=values["roughing_stock"],
                finishing_stock=values["finishing_stock"],
                dry_run=bool(dry.value),
            )

        write = _start(shared, text, work, name, job, programs_work.write_cutting)
        widgets.button(text("programs.generate_cut"), write, "description", primary=True)
        _outcome(text, work)


def _probing(shared: Shared, text: Text) -> None:
    work = shared.works[_PROBE]
    with widgets.panel(text("programs.probe")):
        name = _head(shared, text, f"PROBE_{shared.choice.member.upper()}")
        with widgets.fields():
            teeth = widgets.NumberField(text, text("programs.topography"), 1, "", 0, 200, digits=0)
            repeat = widgets.NumberField(text, text("programs.repeat"), 1, "", 1, MOST_TOUCHES, digits=0)
        pitch = ui.checkbox(text("programs.pitch"), value=True)
        around = ui.checkbox(text("programs.registration"), value=True)

        def chosen() -> ProbingChoice:
            values = widgets.numbers({"teeth": teeth, "repeat": repeat})
            return ProbingChoice(
                tuple(range(int(values["teeth"]))), bool(pitch.value), bool(around.value), int(values["repeat"])
            )

        write = _start(shared, text, work, name, chosen, programs_work.write_probing)
        widgets.button(text("programs.generate_probe"), write, "my_location", primary=True)
        _outcome(text, work)


def _start(
    shared: Shared,
    text: Text,
    work: Work,
    name: ui.input,
    asked: Callable[[], Asked],
    write: Callable[[Path, Choice, str, Asked, Progress], WrittenProgram],
) -> Callable[[], None]:
    """What a button does: it reads the fields, and starts to write the program that they ask for."""

    def start() -> None:
        wanted, what, choice = name.value or "", asked(), shared.choice
        work.start(
            text("programs.writing", name=wanted),
            lambda progress: write(shared.folder, choice, wanted, what, progress),
        )

    return start


def _outcome(text: Text, work: Work) -> None:
    """Progress and verdict of a program that is written."""
    said = widgets.Message()

    def ended() -> None:
        found = work.result
        if not isinstance(found, WrittenProgram):
            said.show("")
            return
        values: dict[str, Any] = {"name": found.file.name, "blocks": found.blocks}
        if found.touches is None:
            values["time"] = duration(text, found.seconds or 0.0)
            said.show(text("programs.written_cut", **values), "good")
        else:
            values |= {"touches": found.touches, "clearance": text.quoted(found.verdict)}
            said.show(text("programs.written_probe", **values), "good")

    widgets.progress(text, work, ended)


def _written(shared: Shared, text: Text) -> None:
    chosen: dict[str, str] = {"name": ""}
    with widgets.panel(text("programs.list"), wide=True):
        none = widgets.note(text("programs.none"))
        columns = [("name", "file"), ("size", "size"), ("written", "date")]
        listed = widgets.table([(name, text(f"programs.{title}")) for name, title in columns], [], key="name")
        names = widgets.choice(text("programs.file"), [], None, lambda name: pick(name or ""))
        with widgets.row():
            widgets.button(text("programs.mill"), lambda: mill(), "precision_manufacturing")
            replace = ui.checkbox(text("programs.replace"))
            send = widgets.button(text("programs.send"), lambda: ask_to_send(), "upload")
        _milled(text, shared)
        _sent(text, shared)
        heading = widgets.note("")
        with ui.element("pre").classes("gm-code").props('tabindex="0"') as code:
            content = ui.label("").classes("gm-inline")
        code.visible = False
    if shared.link is None:
        send.enabled = False
        send.tooltip(text("programs.no_control"))

    def pick(name: str) -> None:
        chosen["name"] = name
        code.visible = bool(name)
        if not name:
            return
        try:
            lines, count = programs_work.preview(shared.folder, name)
        except InputError as error:
            widgets.say_error(error)
            return
        code.props["aria-label"] = text("programs.preview", name=name)
        content.text = lines
        more = (
            text("programs.more_lines", shown=programs_work.SHOWN, lines=count) if count > programs_work.SHOWN else ""
        )
        heading.text = f"{text('programs.preview', name=name)}. {more}"

    def needed() -> str:
        if not chosen["name"]:
            raise widgets.Refusal(text("measure.program_needed"))
        return chosen["name"]

    def mill() -> None:
        name, choice = needed(), shared.choice
        shared.works[_MILL].start(
            text("programs.milling", name=name),
            lambda progress: programs_work.mill(shared.folder, choice, name, None, progress),
        )

    def ask_to_send() -> None:
        name = needed()
        assert shared.link is not None
        size = f"{len(programs_work.read(shared.folder, name)) / 1000:z.0f}"
        question = text("programs.send_question", name=name, size=size, control=control_name(text, shared))
        over = bool(replace.value)
        widgets.ask(shared, text, question, lambda: _send(shared, text, name, over))

    def look() -> None:
        found = programs_work.programs(shared.folder)
        rows = [{"name": one.name, "size": round(one.size / 1000, 1), "written": one.written} for one in found]
        if listed.rows != rows:
            listed.rows = rows
            names.set_options([one.name for one in found], value=chosen["name"] or None)
        none.visible, listed.visible = not rows, bool(rows)

    look()
    ui.timer(4 * widgets.LOOK, look)


def _send(shared: Shared, text: Text, name: str, replace: bool) -> None:
    link = shared.link
    assert link is not None
    content = programs_work.read(shared.folder, name)

    def wait(progress: Progress) -> tuple[str, int]:
        sending: Future[None] = link.submit(link.send(name, content, replace))
        sending.result(120.0)
        return name, len(content)

    shared.works[_SEND].start(
        text("programs.sending", name=name, control=control_name(text, shared)), _plain(wait, link.name)
    )


def _plain(wait: Callable[[Progress], tuple[str, int]], control: str) -> Callable[[Progress], tuple[str, int]]:
    def work(progress: Progress) -> tuple[str, int]:
        try:
            return wait(progress)
        except TimeoutError as error:
            raise ComputationError(f"{control}: no answer for two minutes: look there what it has") from error

    return work


def _sent(text: Text, shared: Shared) -> None:
    """The control's answer."""
    work, said = shared.works[_SEND], widgets.Message()

    def ended() -> None:
        if work.result is None or shared.link is None:
            said.show("")
            return
        name, size = work.result
        said.show(text("programs.sent", control=control_name(text, shared), name=name, size=size), "good")

    widgets.progress(text, work, ended)


def _milled(text: Text, shared: Shared) -> None:
    """What milling found."""
    work, said = shared.works[_MILL], widgets.Message()

    def ended() -> None:
        found = work.result
        if not isinstance(found, MilledProgram):
            said.show("")
            return
        words = text("programs.milled", name=found.name, um=f"{1000 * found.largest:z.3f}")
        if found.faults:
            words += " " + text("programs.faults", faults="; ".join(map(text.quoted, found.faults)))
        said.show(words, "error" if found.faults else "good")

    widgets.progress(text, work, ended)
