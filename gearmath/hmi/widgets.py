"""What every page is made of. Nothing here computes; texts from elsewhere are shown as text, never as HTML."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from typing import Any
from weakref import WeakKeyDictionary

from nicegui import Client, ui

from gearmath.errors import ComputationError, InputError
from gearmath.hmi.messages import Text
from gearmath.hmi.work import BROKEN, Work

#: How often a page looks at the state of the server. [s]
LOOK = 0.25
#: Kinds of a message, each with its icon.
_ICONS = {"info": "info", "good": "check_circle", "warning": "warning", "error": "error"}


#: The sentence that stays over each page.
_SAID: WeakKeyDictionary[Client, ui.notification] = WeakKeyDictionary()


class Refusal(InputError):
    """A refusal in words of the operator's language."""


@contextmanager
def panel(title: str, wide: bool = False) -> Iterator[ui.element]:
    """A part of a page under its title; ``wide`` takes the whole width."""
    with ui.element("section").classes("gm-panel gm-wide" if wide else "gm-panel") as section:
        section.props["aria-label"] = title
        heading(title)
        yield section


def heading(title: str) -> None:
    """The title of a part."""
    with ui.element("h2").classes("gm-heading"):
        ui.label(title).classes("gm-inline")


@contextmanager
def fields() -> Iterator[ui.element]:
    """Fields beside each other, as far as there is room."""
    with ui.element("div").classes("gm-fields") as element:
        yield element


@contextmanager
def row() -> Iterator[ui.element]:
    """Things side by side, as far as there is room."""
    with ui.element("div").classes("gm-row") as element:
        yield element


def note(words: str) -> ui.label:
    """A sentence beside the matter."""
    return ui.label(words).classes("gm-note")


class Message:
    """A sentence with a kind (info, good, warning, error); hidden while it is empty. Readers of the screen hear it."""

    def __init__(self, words: str = "", kind: str = "info") -> None:
        with ui.element("div").classes("gm-message").props('role="status" aria-live="polite"') as self._box:
            self._icon = ui.icon(_ICONS[kind]).props('aria-hidden="true"')
            self._label = ui.label(words)
        self.show(words, kind)

    def show(self, words: str, kind: str = "info") -> None:
        """Say something else; an empty text hides the message."""
        self._label.text = words
        self._icon.name = _ICONS[kind]
        self._box.classes(add=f"gm-{kind}", remove=" ".join(f"gm-{one}" for one in _ICONS if one != kind))
        self._box.visible = bool(words)


def fact(label: str, value: str = "", unit: str = "") -> ui.label:
    """A name, its value and unit in a line of facts; returns the label of the value."""
    with ui.element("div").classes("gm-fact"):
        ui.label(label).classes("gm-name")
        with ui.element("div").classes("gm-amount"):  # they stay together where the name leaves them no room
            found = ui.label(value).classes("gm-value")
            if unit:
                ui.label(unit).classes("gm-unit")
    return found


def word(label: str, value: str, hint: str) -> ui.input:
    """A name or other short text."""
    found = ui.input(label, value=value).classes("gm-number")
    found.props('outlined dense hide-bottom-space autocomplete="off" maxlength="40"')
    if hint:
        found.props["hint"] = hint
    return found


def choice(label: str, options: Sequence[str] | dict[Any, str], value: Any, changed: Callable[[Any], object]) -> Any:
    """One of several, by keyboard or touch. What ``changed`` refuses is not chosen: the one before stays."""
    given = list(options) if not isinstance(options, dict) else options
    held = [value]

    def change(chosen: Any) -> None:
        if chosen == held[0]:
            return
        try:
            changed(chosen)
        except (InputError, ComputationError) as error:
            say_error(error)
            found.value = held[0]
        else:
            held[0] = chosen

    found = ui.select(given, label=label, value=value, on_change=lambda event: change(event.value))
    return found.classes("gm-choice").props("outlined dense options-dense")


def words_of(error: Exception) -> str:
    """Why something failed, framed where it is in another language than the page."""
    is_foreign = ui.context.client.page.language == "de" and not isinstance(error, Refusal)
    return Text("de").quoted(error) if is_foreign else str(error)


def say_error(error: Exception) -> None:
    """Say over the page why something failed."""
    say(words_of(error), "error")


def button(label: str, pressed: Callable[[], Any], icon: str = "", primary: bool = False) -> ui.button:
    """A button whose refusals are shown as a sentence."""

    def guarded() -> None:
        _hush()
        try:
            pressed()
        except (InputError, ComputationError) as error:
            say_error(error)
        except Exception:  # it goes on to the log of the server
            say_error(ComputationError(BROKEN))
            raise

    found = ui.button(label, on_click=guarded, icon=icon or None, color=None)
    return found.props("no-caps unelevated" if primary else "no-caps outline").classes(
        "gm-button gm-primary" if primary else "gm-button"
    )


def say(words: str, kind: str = "info") -> None:
    """A sentence over the page: it goes by itself, but where something failed only when it is closed, or when a button
    is pressed again."""
    types: dict[str, Any] = {"info": "info", "good": "positive", "warning": "warning", "error": "negative"}
    stays = kind in ("warning", "error")
    _hush()
    found = ui.notification(
        words,
        type=types[kind],
        position="bottom",
        timeout=None if stays else 4.0,
        close_button="OK" if stays else False,
    )
    if stays:
        _SAID[ui.context.client] = found


def _hush() -> None:
    """Take away what was said on this page and stays: it is about something that was pressed before."""
    before = _SAID.pop(ui.context.client, None)
    if before is not None:
        before.dismiss()


def table(columns: Sequence[tuple[str, str]], rows: Sequence[dict[str, Any]], key: str = "id") -> ui.table:
    """Rows under columns (name and title, with the unit); numbers to the right. Set ``.rows`` to change it."""
    number = {name for name, _ in columns if rows and isinstance(rows[0].get(name), int | float)}
    heads = [
        {"name": name, "label": title, "field": name, "align": "right" if name in number else "left"}
        for name, title in columns
    ]
    found = ui.table(columns=heads, rows=list(rows), row_key=key, pagination={"rowsPerPage": 0})
    return found.props('dense flat hide-pagination separator="horizontal"').classes("gm-table")


def progress(
    text: Text,
    work: Work,
    what: Callable[[], str],
    ended: Callable[[], object] = lambda: None,
    is_current: Callable[[], bool] = lambda: True,
) -> None:
    """The bar of a long computation, while it runs; ``ended`` is called when one has, and when the page is opened.

    ``what`` says in the language of the page what runs: who has begun it may read another one. Where the outcome is
    not ``is_current``, the reason of a failure goes, and ``ended`` is called anew: the fields have changed since.
    """
    with ui.element("div").classes("gm-progress") as box:
        words = ui.label()
        bar = ui.linear_progress(0.0, show_value=False).props("instant-feedback")
        bar.props["aria-label"] = text("shell.progress")
        stop = button(text("shell.cancel"), work.cancel)
    failed = Message()
    seen: list[tuple[int, bool] | None] = [None]

    def look() -> None:
        box.visible = work.running
        if work.running:
            failed.show("")
            said = text("shell.running", what=what(), seconds=f"{work.seconds:.0f}")
            if work.remaining is not None:
                said += f", {text('shell.remaining', seconds=f'{work.remaining:.0f}')}"
            words.text = said
            bar.props.update({"indeterminate": work.share is None})
            bar.value = round(work.share or 0.0, 3)
            stop.enabled = not work.progress.cancelled
            return
        now = work.count, is_current()
        if seen[0] != now:
            seen[0] = now
            failed.show(text.quoted(work.error or "") if now[1] else "", "error")
            ended()

    look()
    ui.timer(LOOK, look)


def figure(content: dict[str, Any], label: str) -> ui.plotly:
    """A plotly figure as a dict: needs WebGL where it is in space. ``label`` is for readers of the screen."""
    found = ui.plotly(content).classes("gm-figure")
    found.props["role"] = "figure"
    found.props["aria-label"] = label
    return found


def picture(svg: str, label: str) -> ui.html:
    """An SVG of our own making."""
    found = ui.html(svg, sanitize=False).classes("gm-picture")
    found.props["role"] = "img"
    found.props["aria-label"] = label
    return found
