"""Programs that were written: listed, read, milled virtually, and sent to the control."""

from __future__ import annotations

import time
from collections.abc import Callable
from concurrent.futures import Future

from nicegui import ui

from gearmath.errors import ComputationError, InputError
from gearmath.hmi import acting, programs_work, widgets
from gearmath.hmi.messages import Text
from gearmath.hmi.programs_work import MilledProgram
from gearmath.hmi.state import Shared
from gearmath.hmi.words import control_name
from gearmath.hmi.work import Progress

#: The computations of this part.
_MILL, _SEND = "programs.mill", "programs.send"
#: How long an answer of the control is waited for, and how long before somebody may cancel. [s]
_ANSWER, _STEP = 120.0, 0.2


def show(shared: Shared, text: Text) -> None:
    """The list, and what may be done with the program that is chosen of it."""
    chosen: dict[str, str] = {"name": ""}

    def no_milling() -> str | None:
        if not chosen["name"]:
            return text("programs.choose") if names.options else None  # that there is none is said above
        return None if shared.works[_MILL].running else ""

    def no_sending() -> str | None:
        if why := _no_control(shared, text):
            return why
        return "" if chosen["name"] and not shared.works[_SEND].running else None

    with widgets.panel(text("programs.list"), wide=True):
        none = widgets.note(text("programs.none"))
        columns = [("name", "file"), ("size", "size"), ("written", "date")]
        listed = widgets.table([(name, text(f"programs.{title}")) for name, title in columns], [], key="name")
        names = widgets.choice(text("programs.file"), [], None, lambda name: pick(name or ""))
        with acting.buttons() as button:
            button(no_milling, text("programs.mill"), lambda: _mill(shared, chosen["name"]), "precision_manufacturing")
            replace = ui.checkbox(text("programs.replace"))
            button(no_sending, text("programs.send"), lambda: ask_to_send(), "upload")
        _milled(text, shared, lambda: chosen["name"])
        _sent(text, shared)
        heading = widgets.note("")
        with ui.element("pre").classes("gm-code").props('tabindex="0"') as code:
            content = ui.label("").classes("gm-inline")
        code.visible = False

    def pick(name: str) -> None:
        chosen["name"] = name
        code.visible, heading.text = False, ""
        if not name:
            return
        try:
            lines, count = programs_work.preview(shared.folder, name)
        except InputError as error:
            widgets.say_error(error)
            return
        code.visible = True
        code.props["aria-label"] = text("programs.preview", name=name)
        content.text = lines
        more = (
            text("programs.more_lines", shown=programs_work.SHOWN, lines=count) if count > programs_work.SHOWN else ""
        )
        heading.text = f"{text('programs.preview', name=name)}. {more}"

    def ask_to_send() -> None:
        name, over = chosen["name"], bool(replace.value)
        size = f"{len(programs_work.read(shared.folder, name)) / 1000:z.0f}"
        question = text("programs.send_question", name=name, size=size, control=control_name(text, shared))
        acting.ask(shared, text, question, lambda: _send(shared, name, over))

    def look() -> None:
        found = programs_work.programs(shared.folder)
        rows = [{"name": one.name, "size": round(one.size / 1000, 1), "written": one.written} for one in found]
        if listed.rows != rows:
            listed.rows = rows
            left = [one.name for one in found]
            names.set_options(left, value=chosen["name"] if chosen["name"] in left else None)
        none.visible, listed.visible = not rows, bool(rows)

    acting.watch(text, look, 4 * widgets.LOOK)


def _no_control(shared: Shared, text: Text) -> str:
    """Why nothing can be sent; empty where it can."""
    if shared.link is None:
        return text("programs.no_control")
    return "" if shared.link.view.connected else text("programs.not_connected", control=control_name(text, shared))


def _mill(shared: Shared, name: str) -> None:
    choice = shared.choice
    shared.works[_MILL].start(
        name,
        lambda progress: programs_work.mill(shared.folder, choice, name, None, progress),
        (choice, name, programs_work.stamp(shared.folder, name)),
    )


def _milled(text: Text, shared: Shared, chosen: Callable[[], str]) -> None:
    """What milling found."""
    work, said = shared.works[_MILL], widgets.Message()

    def is_current() -> bool:
        name = chosen() or work.name
        return work.asked == (shared.choice, name, programs_work.stamp(shared.folder, name))

    def ended() -> None:
        found = work.result
        if not isinstance(found, MilledProgram):
            said.show("")
            return
        words = text("programs.milled", name=found.name, um=f"{1000 * found.largest:z.3f}")
        if found.faults:
            words += " " + text("programs.faults", faults="; ".join(map(text.quoted, found.faults)))
        if is_current():
            said.show(words, "error" if found.faults else "good")
        else:
            said.show(text("shell.outdated", words=words))

    widgets.progress(text, work, lambda: text("programs.milling", name=work.name), ended, is_current)


def _send(shared: Shared, name: str, replace: bool) -> None:
    link = shared.link
    assert link is not None
    content, at = programs_work.read(shared.folder, name), programs_work.stamp(shared.folder, name)

    def wait(progress: Progress) -> tuple[str, int]:
        sending: Future[None] = link.submit(link.send(name, content, replace))
        until = time.monotonic() + _ANSWER
        try:
            while not sending.done():
                if progress.cancelled:
                    raise ComputationError(f"{link.name}: sending was cancelled: look there what it has")
                if time.monotonic() > until:
                    raise ComputationError(f"{link.name}: no answer for two minutes: look there what it has")
                time.sleep(_STEP)
            sending.result()
        finally:
            sending.cancel()
        return name, len(content)

    shared.works[_SEND].start(name, wait, at)


def _sent(text: Text, shared: Shared) -> None:
    """The control's answer."""
    work, said = shared.works[_SEND], widgets.Message()

    def is_current() -> bool:
        return work.asked == programs_work.stamp(shared.folder, work.name)

    def ended() -> None:
        if work.result is None or shared.link is None:
            said.show("")
            return
        name, size = work.result
        words = text("programs.sent", control=control_name(text, shared), name=name, size=size)
        if is_current():
            said.show(words, "good")
        else:
            said.show(text("shell.outdated", words=words))

    def what() -> str:
        return text("programs.sending", name=work.name, control=control_name(text, shared))

    widgets.progress(text, work, what, ended, is_current)
