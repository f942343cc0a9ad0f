"""What stands around every page: navigation, language, look, and the banner of a lost connection."""

from __future__ import annotations

from collections.abc import Callable
from importlib import resources

from nicegui import ui
from starlette.requests import Request

from gearmath.errors import ComputationError, InputError
from gearmath.hmi import widgets
from gearmath.hmi.messages import LANGUAGES, Text
from gearmath.hmi.state import Shared
from gearmath.hmi.visitor import LANGUAGE, LOOK, is_dark, language_of
from gearmath.hmi.words import connection, run_strip

#: The pages in the order of the work: name (of the module, the address and the table of messages), Material icon.
PAGES = {
    "machine": "precision_manufacturing",
    "gear": "settings",
    "programs": "description",
    "measure": "my_location",
    "result": "insights",
    "correct": "tune",
    "history": "history",
    "gearbox": "sync_alt",
}
#: How often the server lets the browser know that it is there. [s]
_BEAT = 1.0


def show(shared: Shared, name: str, build: Callable[[Shared, Text], None], request: Request) -> None:
    """One whole page."""
    text = Text(language_of(request))
    ui.add_head_html(f"<style>{_file('style.css')}</style>")
    ui.add_body_html(f"<script>{_file('page.js')}</script>")
    ui.page_title(f"{text(f'{name}.title')} · {text('shell.product')}")
    ui.query("body").classes("gm-body")
    ui.colors(primary="#0b6478")
    # inert until page.js finds that the server hears: what is pressed before would be lost
    with ui.element("header").classes("gm-head").props("inert"):
        ui.label(text("shell.product")).classes("gm-product")
        with ui.element("h1").classes("gm-title"):
            ui.label(text(f"{name}.title")).classes("gm-inline")
        _strip(shared, text)
        _switch(text, text("shell.language"), LANGUAGE, LANGUAGES, text.language)
        looks = {"light": text("shell.light"), "dark": text("shell.dark")}
        _switch(text, text("shell.look"), LOOK, looks, "dark" if is_dark(request) else "light")
    with ui.element("nav").classes("gm-nav").props("inert") as nav:
        nav.props["aria-label"] = text("shell.pages")
        for page, icon in PAGES.items():
            with ui.element("a").classes("gm-link") as link:
                link.props["href"] = f"/{page}"
                if page == name:
                    link.props["aria-current"] = "page"
                ui.icon(icon).props('aria-hidden="true"')
                ui.label(text(f"{page}.title"))
    lost = ui.element("div").classes("gm-lost").props('role="alert" id="gm-lost"')
    with lost:
        ui.label(text("shell.server_lost"))
    beat = ui.label("0").classes("gm-beat").props('aria-hidden="true"')
    ui.timer(_BEAT, lambda: beat.set_text(str(int(beat.text) + 1)))
    with ui.element("div").classes("gm-main").props("inert"):
        try:
            build(shared, text)
        except (InputError, ComputationError) as error:
            widgets.Message(text.quoted(error), "error")
        with ui.element("footer").classes("gm-wide"):
            widgets.note(text("shell.foreign"))


def _strip(shared: Shared, text: Text) -> None:
    """Control, run and alarms in a few words, on every page; each leads where there is more."""
    with ui.element("div").classes("gm-strip").props('role="status"'):
        signs = {page: _sign(page) for page in ("machine", "measure", "alarms")}

    def look() -> None:
        words, kind = connection(text, shared.link)
        signs["machine"](words if shared.link is not None else text("machine.strip_control"), kind)
        signs["measure"](run_strip(text, shared.measuring), "info")
        count = shared.book.unseen()
        words = text("machine.strip_alarms", n=count) if count else text("machine.strip_no_alarms")
        signs["alarms"](words, "error" if count else "info")

    look()
    ui.timer(2 * widgets.LOOK, look)


def _sign(page: str) -> Callable[[str, str], None]:
    with ui.element("a").classes("gm-sign") as sign:
        sign.props["href"] = "/measure" if page == "measure" else "/machine"
        label = ui.label().classes("gm-inline")

    def show(words: str, kind: str) -> None:
        label.text = words
        others = " ".join(f"gm-{one}" for one in ("info", "good", "warning", "error") if one != kind)
        sign.classes(add=f"gm-{kind}", remove=others)

    return show


def _switch(text: Text, label: str, cookie: str, options: dict[str, str], value: str) -> None:
    """Buttons of which one is on; the choice is kept in a cookie of this browser."""
    with ui.element("div").classes("gm-switch").props('role="group"') as group:
        group.props["aria-label"] = label
        for key, word in options.items():
            on = "true" if key == value else "false"
            one = ui.element("button").classes("gm-option").props(f'type="button" aria-pressed="{on}"')
            one.on("click", js_handler=f"() => gearmathChoose('{cookie}', '{key}')")
            with one:
                ui.label(word).classes("gm-inline")


def _file(name: str) -> str:
    return resources.files("gearmath.hmi").joinpath("static", name).read_text("utf-8")
