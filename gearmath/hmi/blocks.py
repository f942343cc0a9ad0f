"""Parts that pages of the gear side share: what follows the state of the server, facts, charts, runs to choose."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterable, Mapping, Sequence
from functools import partial
from typing import Any

from nicegui import ui

from gearmath.errors import ComputationError, InputError
from gearmath.hmi import widgets
from gearmath.hmi.desk import Kept
from gearmath.hmi.drawing import translated
from gearmath.hmi.messages import Text, messages
from gearmath.hmi.number_field import NumberField
from gearmath.hmi.state import Shared
from gearmath.hmi.work import Progress


def follow(key: Callable[[], Hashable], draw: Callable[[], object]) -> None:
    """Draw now, and anew whenever the key is another, whoever changed it; or say why that cannot be."""
    place = ui.element("div").classes("gm-follow")
    seen: list[Hashable] = []

    def look() -> None:
        made = draw
        try:
            now = key()
        except (InputError, ComputationError) as error:
            now, made = str(error), partial(_refused, error)
        if seen and seen[0] == now:
            return
        seen[:] = [now]
        place.clear()
        with place:
            try:
                made()
            except (InputError, ComputationError) as error:
                _refused(error)

    look()
    ui.timer(widgets.LOOK, look)


def _refused(error: Exception) -> None:
    widgets.Message(widgets.words_of(error), "error")


def refused(text: Text, fields: Iterable[NumberField], said: str = "blocks.refused") -> str:
    """The sentence ``said`` with the names of the fields that hold what is refused; nothing where none does."""
    names = "; ".join(one.label for one in fields if one.is_refused)
    return text(said, fields=names) if names else ""


def marked(why: Callable[[], str]) -> None:
    """Why what is shown here is not what is asked for, as long as that is so."""
    follow(why, lambda: widgets.Message(why(), "warning"))


def kept(
    text: Text,
    found: Kept,
    key: Callable[[], Hashable],
    name: str,
    compute: Callable[[], Callable[[Progress], Any]],
    draw: Callable[[Any], object],
    empty: str = "",
    outdated: Callable[[], str] = str,
) -> None:
    """What is computed for a key, as soon as it is there; the progress until then, or why there is nothing.

    ``name`` says what is computed; ``compute`` gives the computation for the key of now; a key of None has none, and
    ``empty`` is said. While ``outdated`` says that something else is typed than what was computed, that is said and
    nothing is shown.
    """

    def state() -> tuple[Hashable, bool, int, str]:
        now = key()
        return now, now is not None and found.look(now, compute()), found.work.count, outdated()

    def show() -> None:
        now, ended, _, why = state()
        if why:
            widgets.Message(why, "warning")
        elif now is None:
            if empty:
                widgets.note(empty)
        elif not ended:
            widgets.progress(text, found.work, lambda: name)
        elif found.work.error:
            widgets.Message(text.quoted(found.work.error), "error")
        elif found.work.result is None:
            widgets.note(text("blocks.cancelled"))
            widgets.button(text("blocks.again"), found.forget)
        else:
            draw(found.work.result)

    follow(state, show)


def facts(rows: Iterable[tuple[str, str, str]]) -> None:
    """Name, value, unit of each, one below the other."""
    for label, value, unit in rows:
        widgets.fact(label, value, unit)


def chart(text: Text, svg: str, label: str, across: bool = False, names: Mapping[str, str] | None = None) -> None:
    """A drawing of the package under its label, its words in the language of the page, on white.

    One of many parts is moved ``across`` where the screen is narrow, and stays legible. ``names`` are further words.
    """
    with ui.element("figure").classes("gm-chart gm-across" if across else "gm-chart"):
        with ui.element("figcaption"):
            ui.label(label).classes("gm-inline gm-note")
        widgets.picture(translated(svg, words_of_charts(text) | dict(names or {})), label).classes("gm-paper")


def words_of_charts(text: Text) -> dict[str, str]:
    """What the words in drawings are in the language of the page."""
    if text.language == "en":
        return {}
    return {word["en"]: word[text.language] for word in messages()["charts"].values()}


def plain_table(caption: str, head: Sequence[str], rows: Iterable[Sequence[str]], numbers: int = 1) -> None:
    """A table of texts under its caption; columns from ``numbers`` on stand to the right."""
    with ui.element("table").classes("gm-plain"):
        if caption:
            with ui.element("caption"):
                ui.label(caption).classes("gm-inline")
        with ui.element("thead"), ui.element("tr"):
            for k, word in enumerate(head):
                _cell("th", word, k >= numbers)
        with ui.element("tbody"):
            for row in rows:
                with ui.element("tr"):
                    for k, cell in enumerate(row):
                        _cell("td", cell, k >= numbers)


def _cell(tag: str, words: str, right: bool) -> None:
    with ui.element(tag).classes("gm-right" if right else "gm-left"):
        ui.label(words).classes("gm-inline")


def run_choice(shared: Shared, text: Text, empty: str = "") -> None:
    """The run that the pages show, of those that can be judged; the newest first. ``empty`` is said of none."""
    desk = shared.desk

    def draw() -> None:
        runs = desk.runs.of_members()
        if not runs:
            if empty:  # else the buttons that need one say so
                widgets.note(empty)
            return
        names = {str(one.run): run_name(text, one) for one in reversed(runs)}
        shown = str(desk.shown_run())

        def choose(run: str) -> None:
            desk.run = int(run)

        found = widgets.choice(text("blocks.run"), names, shown if shown in names else next(iter(names)), choose)
        found.classes("gm-long")

    follow(lambda: (desk.shown_run(), tuple(one.run for one in desk.runs.of_members())), draw)


def run_name(text: Text, one: Any) -> str:
    """A run in a list: number, member, program and when (UTC)."""
    return f"{one.run}: {member_name(text, one.member)}, {one.program}, {one.begun[:16].replace('T', ' ')} UTC"


def member_name(text: Text, name: str | None) -> str:
    """Pinion or gear in the language of the page."""
    return text(f"blocks.{name}") if name in ("pinion", "gear") else text("blocks.artefact")


def flank_names(text: Text) -> dict[str, str]:
    """The flanks in the language of the page, and both of them."""
    return {name: text(f"blocks.{name}") for name in ("concave", "convex", "both")}


def figure_name(text: Text, name: str) -> str:
    """A figure of a measurement in the language of the page."""
    plain = name.removesuffix("_um")
    return text(f"result.{plain}") if text.has(f"result.{plain}") else plain.replace("_", " ")


def setting_name(text: Text, name: str) -> str:
    """A setting, a coefficient of its motion or the root line, as the page calls it."""
    plain, dot, power = name.replace(" ", "_").partition(".")
    return f"{text(f'gear.{plain}')}{dot}{power}" if text.has(f"gear.{plain}") else name.replace("_", " ")


def has_webgl(then: Callable[[bool], object]) -> None:
    """Tell whether this browser can draw in space; one that is too busy to say so is taken to be able to."""

    async def ask() -> None:
        try:
            found = await ui.run_javascript(
                "!!document.createElement('canvas').getContext('webgl2') || "
                "!!document.createElement('canvas').getContext('webgl')",
                timeout=5.0,
            )
        except TimeoutError:
            found = True
        then(bool(found))

    ui.timer(0.05, ask, once=True)
