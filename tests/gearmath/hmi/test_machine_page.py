"""The page Machine: what the control shows, how old it is, and how soon it is there."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator

import pytest

from tests.gearmath.control.live.conftest import Live
from tests.gearmath.hmi.conftest import Operator, Served


@pytest.fixture
def machine(live: Live) -> Iterator[Live]:
    yield live
    live.nc.position = [0.0] * 5
    live.nc.message = ""


def test_it_shows_what_the_control_shows_each_number_with_its_unit(
    machine: Live, page: Served, operator: Callable[..., Operator]
) -> None:
    machine.load()
    machine.nc.message = "point <b>7</b>"
    one = operator(page, "machine")
    one.sees("connected", one.panel("Control"))
    machine.nc.position = [1.25, -2.5, 100.0626, 350.5, 45.0]
    for value in ("1.250", "-2.500", "100.063", "350.500", "45.000"):
        one.sees(value, one.panel("Axis positions"))
    rows = one.panel("Axis positions").locator(".gm-fact").all_inner_texts()
    assert [row.split("\n")[-1] for row in rows] == ["mm", "mm", "mm", "°", "°"]
    for words in ("automatic", "reset", "TEN.MPF", "point <b>7</b>", "free"):
        one.sees(words, one.panel("Control"))


def test_values_are_marked_as_old_with_their_age_when_the_control_is_silent(
    machine: Live, page: Served, operator: Callable[..., Operator]
) -> None:
    one = operator(page, "machine")
    one.sees("connected", one.panel("Control"))
    machine.soon(machine.control.line.refuse)
    one.sees("no connection for 2 s")
    one.sees("The values are", one.panel("Axis positions"))
    one.page.locator(".gm-positions.gm-stale").wait_for()
    one.picture("machine_stale")

    async def again() -> None:
        await machine.control.line.start()

    machine.call(again())
    one.sees("connected", one.panel("Control"))
    one.page.locator(".gm-positions.gm-stale").wait_for(state="detached")


def test_the_first_live_value_is_there_within_seconds_and_twenty_pages_are_served(
    machine: Live, page: Served, operator: Callable[..., Operator]
) -> None:
    machine.nc.position = [1.5, 0.0, 0.0, 0.0, 0.0]
    first = operator(page, "machine")
    first.sees("1.500")
    with page.timed("first live value", 2.0):
        first.page.reload()
        first.sees("1.500")
    pages = [first.page] + [first.context.new_page() for _ in range(19)]
    for one in pages[1:]:
        one.goto(f"{page.base}/machine", wait_until="commit")
    for one in pages:
        one.get_by_text("1.500").first.wait_for()
    machine.nc.position = [2.5, 0.0, 0.0, 0.0, 0.0]
    begin = time.monotonic()
    for one in pages:
        one.get_by_text("2.500").first.wait_for()
    print(f"twenty pages show a new value after {time.monotonic() - begin:.2f} s")
