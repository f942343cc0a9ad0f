"""What an operator may do: a button that cannot act says why, and a question stands before what is written."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any
from weakref import WeakKeyDictionary

from nicegui import Client, ui

from gearmath.errors import ComputationError, InputError
from gearmath.hmi.messages import Text
from gearmath.hmi.state import Shared
from gearmath.hmi.widgets import LOOK, Message, button, row, say

#: The question that is open on each page.
_ASKED: WeakKeyDictionary[Client, ui.dialog] = WeakKeyDictionary()


def allow(why: str, reason: ui.label, *buttons: ui.button) -> None:
    """Let buttons be pressed where nothing speaks against it; else ``reason`` beside them says what does."""
    for one in buttons:
        one.enabled = not why
    reason.text, reason.visible = why, bool(why)


def watch(text: Text, look: Callable[[], object], seconds: float = LOOK) -> None:
    """Look now and again at what the server holds; why it cannot be looked at stands there until it can."""
    failed = Message()

    def guarded() -> None:
        try:
            look()
            failed.show("")
        except (InputError, ComputationError) as error:
            failed.show(text.quoted(error), "error")

    guarded()
    ui.timer(seconds, guarded)


def ask(shared: Shared, text: Text, question: str, answered: Callable[[], Any]) -> None:
    """Ask before something is written to the control. The answer counts once, and not after a minute."""
    ticket = shared.tickets.draw()

    def yes() -> None:
        confirm.enabled = False  # the second click of a double one is none
        dialog.close()
        if not shared.tickets.take(ticket):
            say(text("shell.expired"), "warning")
            return
        answered()

    with ui.dialog() as dialog, ui.card().classes("gm-dialog"):
        ui.label(question).classes("gm-question")
        with row():
            confirm = button(text("shell.confirm"), yes, primary=True)
            button(text("shell.cancel"), dialog.close)
    dialog.on("hide", dialog.delete)
    before = _ASKED.get(ui.context.client)
    if before is not None and not before.is_deleted:  # a double click asks once
        before.delete()
    _ASKED[ui.context.client] = dialog
    dialog.open()
