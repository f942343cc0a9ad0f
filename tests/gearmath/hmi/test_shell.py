"""The shell: every page in both languages, both looks and both sizes, by keyboard, and readable for everybody."""

from __future__ import annotations

import os
import re
import signal
from collections.abc import Callable
from pathlib import Path

import pytest
from playwright.sync_api import WebSocketRoute, expect

from gearmath.hmi.messages import Text, messages
from gearmath.hmi.shell import PAGES
from tests.gearmath.hmi.conftest import Operator, Served


@pytest.fixture(scope="module")
def served(serve: Callable[..., Served]) -> Served:
    return serve()


#: Words that begin on one line and go on in the next.
_CUT = """() => { const cut = [], texts = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
  while (texts.nextNode()) for (const word of texts.currentNode.data.matchAll(/[\\p{L}\\p{N}]+/gu)) {
    const range = document.createRange();
    range.setStart(texts.currentNode, word.index);
    range.setEnd(texts.currentNode, word.index + word[0].length);
    if (new Set([...range.getClientRects()].map(box => Math.round(box.top))).size > 1) cut.push(word[0]);
  }
  return cut; }"""
#: What cannot be done with an empty store, by page and button, and the sentence that stands beside it.
_MISSING = {
    "correct": dict.fromkeys(("correct.compute", "correct.accept", "correct.reject"), "blocks.no_run"),
    "history": {"history.show_trend": "history.too_few_for_trend"},
}
LOOKS = [("en", False, (1280, 800)), ("de", True, (800, 1280))]


@pytest.mark.parametrize(("language", "dark", "size"), LOOKS, ids=["english", "german"])
def test_every_page_shows_itself_without_serious_violation_of_accessibility(
    served: Served, operator: Callable[..., Operator], language: str, dark: bool, size: tuple[int, int]
) -> None:
    one = operator(served, language=language, dark=dark, size=size)
    text = Text(language)
    for name in PAGES:
        one.page.get_by_role("link", name=text(f"{name}.title"), exact=True).click()
        one.page.wait_for_url(f"**/{name}")
        one.page.get_by_role("heading", level=1, name=text(f"{name}.title")).wait_for()
        one.is_heard()
        one.picture(f"{name}_{language}_{'dark' if dark else 'light'}_{size[0]}x{size[1]}")
        assert one.page.evaluate("document.documentElement.lang")[:2] == language
        assert one.axe() == [], name
        wide = one.page.evaluate("document.documentElement.scrollWidth")
        assert wide <= size[0], f"{name}: {wide} px wide on {size[0]} px"
        small = one.page.evaluate(
            """() => [...document.querySelectorAll('button, a, input, .q-checkbox, .q-field__control')]
              .filter(e => e.getClientRects().length && !e.closest('.q-field__control, .q-checkbox') ||
                      e.matches('.q-field__control'))
              .filter(e => e.getClientRects().length)
              .map(e => [e.getBoundingClientRect(), e.outerHTML.slice(0, 80)])
              .filter(([box]) => box.height < 43.5 || box.width < 43.5).map(([box, html]) => html)"""
        )
        assert small == [], name
        assert one.page.evaluate(_CUT) == [], name
        for label, why in _MISSING.get(name, {}).items():  # the store is empty
            button = one.page.get_by_role("button", name=text(label), exact=True)
            expect(button).to_be_disabled()
            said = one.page.locator(f"#{button.get_attribute('aria-describedby')}")
            expect(said).to_have_text(text(why))


def test_the_address_that_is_shown_lets_the_browser_in(served: Served, operator: Callable[..., Operator]) -> None:
    one = operator(served)
    one.context.clear_cookies()
    one.forgiven = ("403", "404")
    one.page.goto(f"{served.base}/machine")
    one.sees("Refused: no token: open the address that 'gearmath hmi' showed when it started.")
    one.page.goto(served.address)
    one.page.wait_for_url("**/machine")
    one.page.get_by_role("heading", level=1, name="Machine").wait_for()
    one.page.goto(f"{served.base}/nothing")
    one.sees("There is no page at this address.")
    assert one.axe() == []
    one.page.get_by_role("link", name="To the page Machine").click()
    one.page.wait_for_url("**/machine")


def test_language_and_look_are_chosen_by_keyboard_and_stay(served: Served, operator: Callable[..., Operator]) -> None:
    one = operator(served)
    one.key("Deutsch", "Enter")
    one.page.get_by_role("heading", level=1, name="Maschine").wait_for()
    one.key("Dunkel", "Space")
    one.page.locator("body.body--dark").wait_for()
    one.go("gear")
    one.page.get_by_role("heading", level=1, name="Radsatz").wait_for()
    one.page.locator("body.body--dark").wait_for()


def test_what_is_pressed_before_the_server_hears_it_waits_and_the_cursor_comes_back(
    served: Served, operator: Callable[..., Operator]
) -> None:
    """The websocket is kept back as long as the test wants: a press on the picture of the page goes nowhere, and is no
    surprise later. In a silence of the server the cursor is away, and after it where it was."""
    one = operator(served, "gearbox")
    kept: list[WebSocketRoute] = []
    one.page.route_web_socket(re.compile("_nicegui_ws"), lambda route: kept.append(route))
    one.page.reload()
    one.page.locator(".gm-main").wait_for()
    field = one.page.get_by_label("Teeth", exact=True)
    while not kept:  # the browser asks for the websocket
        one.page.wait_for_timeout(50)
    for part in (".gm-head", ".gm-nav", ".gm-main"):
        assert one.page.locator(part).evaluate("e => e.inert"), part
    field.focus()
    assert one.page.evaluate("document.activeElement === document.body")
    kept[0].connect_to_server()
    one.is_heard()
    field.fill("4")
    os.kill(served.pid, signal.SIGSTOP)
    try:
        one.sees("No connection to the server", one.page.locator(".gm-lost"))
        assert one.page.evaluate("document.activeElement === document.body")
    finally:
        os.kill(served.pid, signal.SIGCONT)
    one.is_heard()
    expect(field).to_be_focused()
    one.page.keyboard.press("7")
    assert field.input_value() == "47"


def test_pages_are_reached_by_keyboard_alone(served: Served, operator: Callable[..., Operator]) -> None:
    one = operator(served)
    for _ in range(40):
        one.page.keyboard.press("Tab")
        if one.page.evaluate("document.activeElement.getAttribute('href')") == "/programs":
            break
    one.page.keyboard.press("Enter")
    one.page.wait_for_url("**/programs")


def test_the_ini_file_of_a_linuxcnc_is_taken_as_a_control(
    serve: Callable[..., Served], operator: Callable[..., Operator], tmp_path: Path
) -> None:
    """None runs here, so the page says that; a program for it is listed."""
    ini = tmp_path / "mill.ini"
    ini.write_text("[DISPLAY]\nDISPLAY = axis\n")
    served = serve("--control", str(ini))
    (served.folder / "PROBE.ngc").write_text("M2\n")
    one = operator(served, "machine")
    one.sees(re.compile("mill.ini: no LinuxCNC runs here|is LinuxCNC installed"), one.panel("Control"))
    german = operator(served, "machine", language="de")
    german.sees(re.compile("hier läuft kein LinuxCNC|ist LinuxCNC installiert"), german.panel("Steuerung"))
    one.go("programs").sees("PROBE.ngc")


def test_every_message_is_there_in_both_languages_with_the_same_values() -> None:
    for page, found in messages().items():
        for name, words in found.items():
            assert set(words) == {"en", "de"}, (page, name)
            values = [set(re.findall(r"\{(\w*)\}", words[language])) for language in ("en", "de")]
            assert values[0] == values[1], (page, name)
            assert all(word.strip() for word in words.values()), (page, name)
