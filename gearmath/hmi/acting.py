"""What an operator may do: a button that cannot act says why, and a question stands before what is written."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any, Protocol
from weakref import WeakKeyDictionary

from nicegui import Client, ui

from gearmath.errors import ComputationError, InputError
from gearmath.hmi.messages import Text
from gearmath.hmi.state import Shared
from gearmath.hmi.widgets import LOOK, Message, button, note, row, say

#: The question that is open on each page.
_ASKED: WeakKeyDictionary[Client, ui.dialog] = WeakKeyDictionary()


class _Add(Protocol):
    def __call__(
        self,
        missing: Callable[[], str | None],
        label: str,
        pressed: Callable[[], object],
        icon: str = "",
        primary: bool = False,
    ) -> None: ...


@contextmanager
def buttons() -> Iterator[_Add]:
    """Buttons in a row, each pressed only while nothing is ``missing``; what is, stands beside them once.

    What is missing is None where the page says it elsewhere, such as beside the bar of what is under way.
    """
    made: list[tuple[ui.button, Callable[[], str | None]]] = []

    def look() -> None:
        found = [(one, missing()) for one, missing in made]
        for one, why in found:
            one.enabled = why == ""
        said.text = " ".join(dict.fromkeys(why for _, why in found if why))
        said.visible = bool(said.text)

    def add(
        missing: Callable[[], str | None],
        label: str,
        pressed: Callable[[], object],
        icon: str = "",
        primary: bool = False,
    ) -> None:
        def press() -> None:
            if missing() == "":
                pressed()
            look()  # at once: the second of two quick clicks finds what the first has left

        one = button(label, press, icon, primary)
        made.append((one, missing))

    with row():
        yield add
        said = note("")
        for one, _ in made:
            one.props["aria-describedby"] = f"c{said.id}"
    look()
    ui.timer(LOOK, look)


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
