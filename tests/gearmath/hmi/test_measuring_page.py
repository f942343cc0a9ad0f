"""The measuring run from the page, and what operators complain about in other programs; judged by the control's log."""

from __future__ import annotations

import re
import time
from collections.abc import Callable, Iterator
from typing import Any

import pytest

from gearmath.control.interface import Touch
from gearmath.control.simulated.nc import NcAlarm
from gearmath.control.store import MeasurementStore
from tests.gearmath.control.live.conftest import Live
from tests.gearmath.hmi.conftest import PATIENCE, Operator, Served

#: So fast runs the machine up to the touch at which a test does something: half a second a touch.
SLOW = 0.4
#: So fast while it does: hours a touch. However long a page takes, the machine is on the way to its next point.
STANDS = 1e-5


@pytest.fixture
def machine(live: Live, page: Served) -> Iterator[Live]:
    """The machine with the program of ten touches selected; the run of a test is over at its end."""
    live.load()
    yield live
    if live.nc.channel:
        live.nc.reset()


def _check_probe(one: Operator, live: Live) -> None:
    """The operator deflects the stylus, and lets it go."""
    new = one.panel("New run")
    one.sees("Deflect the stylus by hand", new)
    live.nc.probe_deflected = True
    one.sees("let the stylus go", new)
    live.nc.probe_deflected = False
    one.sees("is free again", new)


def _record(one: Operator, live: Live) -> None:
    """Up to the moment at which the program may be started."""
    _check_probe(one, live)
    one.choose("Probing program", Live.NAME)
    one.press("Start recording")
    one.press("Yes, do it")
    one.sees("Ready: start TEN.MPF at the machine")


def _run(page: Served, number: int = -1) -> tuple[list[int], dict[int, Touch], str]:
    """Points, touches and end of a run of the store, by default the last one."""
    with MeasurementStore.open(page.folder / "runs.db", create=False) as store:
        run = store.runs()[number]
        return list(run.start.points), dict(run.touches()), (run.endings() or [{"outcome": "open"}])[-1]["outcome"]


def _runs_until(machine: Live, begin: int, touches: int) -> None:
    """Let the program run until so many touches are acknowledged; the machine then stands before the next one."""
    machine.nc.speed = SLOW
    if not machine.nc.channel:
        machine.nc.start()
    _wait(lambda: len(machine.since(begin, "acknowledged")) >= touches)
    machine.nc.speed = STANDS


def _hold(one: Operator, machine: Live) -> int:
    """Hold before the next point, and give the point at which the program waits."""
    one.press("Hold")
    one.sees("Hold is asked for")
    machine.nc.speed = 0.0
    held = one.sees(re.compile("Held: the program waits at point"))
    return int(re.search(r"point (\d+)", held.inner_text())[1])  # type: ignore[index]


def _wait(condition: Callable[[], Any], seconds: float = PATIENCE / 1000) -> None:
    until = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < until, "waited in vain"
        time.sleep(0.02)


def test_a_run_is_recorded_point_for_point_as_the_control_offered_it(
    machine: Live, page: Served, operator: Callable[..., Operator]
) -> None:
    one, begin = operator(page, "measure"), len(machine.nc.log)
    _record(one, machine)
    machine.nc.start()
    one.sees("Complete: all touches are in the store")
    one.sees("10 of 10 points")
    one.picture("measure_complete")
    points, touches, end = _run(page)
    assert points == list(range(1, 11))
    assert end == "complete"
    assert [entry.point for entry in machine.since(begin, "acknowledged")] == points
    for entry in machine.since(begin, "offered"):
        assert tuple(touches[entry.point])[1:] == entry.values
    shown = one.panel("Latest touches").get_by_role("row")
    first = shown.nth(1).inner_text().split("\t")
    assert first[0].strip() == "10"
    assert first[1].strip() == "Pinion concave, tooth 10, row 2, column 4"
    assert float(first[2]) == pytest.approx(touches[10].X, abs=6e-5)
    heads = shown.nth(0).inner_text()
    assert all(f"{axis} / mm" in heads for axis in "XYZ")
    assert all(f"{axis} / °" in heads for axis in "AB")


def test_without_a_probe_check_no_run_begins(machine: Live, page: Served, operator: Callable[..., Operator]) -> None:
    one, begin = operator(page, "measure"), len(machine.nc.log)
    one.choose("Probing program", Live.NAME)
    one.press("Start recording")
    one.sees("The probe must be checked first.")
    assert machine.nc.log[begin:] == []
    assert machine.nc.parameters.get(104, 0.0) == 0.0


def test_hold_is_answered_after_a_reconnect_and_nothing_moves_until_go_on(
    machine: Live, page: Served, operator: Callable[..., Operator]
) -> None:
    one, begin = operator(page, "measure"), len(machine.nc.log)
    _record(one, machine)
    _runs_until(machine, begin, 2)
    machine.soon(machine.control.line.cut)
    one.sees("The connection was lost: nothing is acknowledged until you press Go on")
    machine.nc.speed = 0.0
    one.sees(re.compile("The connection was lost: .* Held: the program waits at point"))
    waiting = len(machine.since(begin, "acknowledged"))
    one.page.wait_for_timeout(1000)
    assert len(machine.since(begin, "acknowledged")) == waiting
    machine.nc.speed = SLOW
    one.press("Go on")
    one.press("Yes, do it")
    _runs_until(machine, begin, waiting + 1)
    point = _hold(one, machine)
    one.page.wait_for_timeout(500)
    assert machine.since(begin, "acknowledged")[-1].point == point - 1
    one.picture("measure_held")
    one.press("Go on")
    one.press("Yes, do it")
    one.sees("Complete: all touches are in the store")
    assert [entry.point for entry in machine.since(begin, "acknowledged")] == list(range(1, 11))


def test_pages_come_and_go_reload_and_sleep_without_a_word_to_the_control(
    machine: Live, page: Served, operator: Callable[..., Operator]
) -> None:
    one, other = operator(page, "measure"), operator(page, "measure", language="de", dark=True, size=(800, 1280))
    begin = len(machine.nc.log)
    _record(one, machine)
    _runs_until(machine, begin, 2)
    point = _hold(one, machine)
    before = machine.nc.log[begin:], dict(machine.nc.parameters)
    # two pages show the same
    other.sees(f"Gehalten: das Programm wartet an Punkt {point}")
    other.picture("measure_held_de_dark_800x1280")
    # reload in mid-run; the browser sleeps and wakes; the network of the tablet goes and comes
    one.page.reload()
    one.sees(f"Held: the program waits at point {point}")
    one.forgiven = other.forgiven = ("ERR_INTERNET_DISCONNECTED", "WebSocket connection", "Failed to fetch")
    one.context.set_offline(True)
    one.sees("No connection to the server", one.page.locator(".gm-lost"))
    assert one.page.locator(".gm-main").evaluate("e => e.inert")
    one.context.set_offline(False)
    one.sees(f"Held: the program waits at point {point}")
    # all pages are closed; the run is still there, and held
    one.page.close()
    other.page.close()
    time.sleep(1.0)
    assert (machine.nc.log[begin:], dict(machine.nc.parameters)) == before
    again = operator(page, "measure")
    again.sees(f"Held: the program waits at point {point}")
    assert (machine.nc.log[begin:], dict(machine.nc.parameters)) == before
    # a run that pages left goes on without any
    again.press("Go on")
    again.press("Yes, do it")
    again.page.close()
    _wait(lambda: _run(page)[2] == "complete")
    assert [entry.point for entry in machine.since(begin, "acknowledged")] == list(range(1, 11))


def test_an_answer_that_is_sent_twice_or_late_does_nothing(
    machine: Live, page: Served, operator: Callable[..., Operator]
) -> None:
    one = operator(page, "measure")
    begin = len(machine.nc.log)
    _record(one, machine)
    # the frames of the browser are recorded and sent again, as a browser does that finds its network
    one.page.evaluate(
        """() => { window.sent = []; const emit = window.socket.emit.bind(window.socket);
          window.socket.emit = (...words) => { window.sent.push(words); return emit(...words); }; }"""
    )
    _runs_until(machine, begin, 1)
    _hold(one, machine)
    machine.nc.speed = SLOW
    one.press("Go on")
    one.press("Yes, do it")
    _runs_until(machine, begin, 3)
    _hold(one, machine)
    waiting = len(machine.since(begin, "acknowledged"))
    one.page.evaluate("() => { for (const words of window.sent.slice()) window.socket.emit(...words); }")
    one.page.wait_for_timeout(1000)
    assert len(machine.since(begin, "acknowledged")) == waiting
    machine.nc.reset()
    one.sees("Ended before it was complete")


def test_a_partial_run_is_kept_and_resumed_on_request_after_the_server_was_killed(
    machine: Live, page: Served, operator: Callable[..., Operator]
) -> None:
    one, begin = operator(page, "measure"), len(machine.nc.log)
    _record(one, machine)
    _runs_until(machine, begin, 3)
    one.forgiven = ("ERR_CONNECTION_REFUSED", "WebSocket connection", "Failed to fetch", "ERR_EMPTY_RESPONSE")
    one.page.close()
    page.stop(kill=True)
    waiting = len(machine.since(begin, "acknowledged"))
    points, touches, end = _run(page)
    assert end == "open"
    assert waiting <= len(touches) <= waiting + 1
    page.start()
    again = operator(page, "measure")
    runs = len(_runs(page))
    resume = again.page.get_by_role("button", name=f"Resume run {runs}", exact=True)
    resume.wait_for()
    again.page.wait_for_timeout(1000)
    assert len(machine.since(begin, "acknowledged")) == waiting
    machine.nc.speed = 0.0
    resume.click()
    again.press("Yes, do it")
    again.sees("Complete: all touches are in the store")
    assert [entry.point for entry in machine.since(begin, "acknowledged")] == points
    assert len(_runs(page)) == runs


def test_after_an_emergency_stop_the_touches_are_kept_and_the_alarm_stays_until_it_was_seen(
    machine: Live, page: Served, operator: Callable[..., Operator]
) -> None:
    one, begin = operator(page, "measure"), len(machine.nc.log)
    _record(one, machine)
    _runs_until(machine, begin, 2)
    machine.soon(machine.nc.emergency_stop)
    one.sees("Unseen alarms: 1")
    one.sees("The program is interrupted: look at the machine", one.panel("Run"))  # and no time that remains
    machine.nc.reset()
    one.sees("Ended before it was complete; what was touched is kept")
    _, touches, end = _run(page)
    assert len(touches) >= 2
    assert "Emergency stop" in end
    # gone at the control, still on every page, also after a reload and a restart of the server
    one.go("machine")
    row = one.panel("Alarms").get_by_role("row").nth(1)
    row.get_by_text("3000").wait_for()
    one.sees("Emergency stop", one.panel("Alarms"))
    one.forgiven = ("ERR_CONNECTION_REFUSED", "WebSocket connection", "Failed to fetch", "ERR_EMPTY_RESPONSE")
    one.page.close()
    page.stop()
    page.start()
    again = operator(page, "machine")
    again.sees("Unseen alarms: 1")
    again.sees("Emergency stop", again.panel("Alarms"))
    again.picture("machine_alarm")
    again.press("I have seen these alarms")
    again.sees("No unseen alarms")
    again.sees("No alarm is active, none is unseen.")


def test_one_alarm_is_shown_once_and_a_flood_does_not_fill_the_page(
    machine: Live, page: Served, operator: Callable[..., Operator]
) -> None:
    one = operator(page, "machine")
    one.sees("connected")
    text = "<img src=x onerror=alert(1)> tool </script> broken"
    machine.soon(lambda: machine.nc.raise_alarm(NcAlarm("65001", text)))
    one.sees(text, one.panel("Alarms"))
    machine.soon(machine.control.line.cut)
    one.page.wait_for_timeout(2000)
    assert one.panel("Alarms").get_by_text("65001").count() == 1
    machine.soon(lambda: [machine.nc.raise_alarm(NcAlarm("1", f"flood {k}")) for k in range(1200)])
    one.sees("flood 998")
    assert one.panel("Alarms").get_by_role("row").count() <= 101
    machine.nc.reset()
    one.press("I have seen these alarms")


def test_chosen_points_are_touched_again_as_a_run_that_refers_to_the_old_one(
    machine: Live, page: Served, operator: Callable[..., Operator]
) -> None:
    one = operator(page, "measure")
    _record(one, machine)
    machine.nc.start()
    one.sees("Complete: all touches are in the store")
    old = len(_runs(page))
    one.choose("Run", f"{old}: TEN.MPF")
    one.fill("Points, such as 3,17-20", "2,4-6")
    begin = len(machine.nc.log)
    one.press("Record these points again")
    one.press("Yes, do it")
    one.sees("Ready: start TEN.MPF at the machine")
    machine.nc.start()
    one.sees("1 of 4 points")
    one.sees("Ready: start TEN.MPF at the machine")
    machine.nc.start()
    one.sees("Complete: all touches are in the store")
    one.sees("4 of 4 points")
    assert [entry.point for entry in machine.since(begin, "acknowledged")] == [2, 4, 5, 6]
    with MeasurementStore.open(page.folder / "runs.db", create=False) as store:
        run = store.runs()[-1]
        assert run.start.refers_to == old
        assert list(run.touches()) == [2, 4, 5, 6]


def test_a_run_is_recorded_held_and_ended_by_keyboard_alone(
    machine: Live, page: Served, operator: Callable[..., Operator]
) -> None:
    """Tab, arrows, Enter and Space from the first picture of the page to the end of the run."""
    one, begin = operator(page, "measure"), len(machine.nc.log)
    _check_probe(one, machine)
    one.choose_by_keys("Probing program", Live.NAME)
    for label in ("Start recording", "Yes, do it"):
        one.strike(label, "Enter")
    one.sees("Ready: start TEN.MPF at the machine")
    machine.nc.speed = STANDS  # the way to the button is long
    machine.nc.start()
    one.strike("Hold", "Space")
    one.sees("Hold is asked for")
    machine.nc.speed = 0.0
    one.sees(re.compile("Held: the program waits at point"))
    for label in ("Go on", "Yes, do it"):
        one.strike(label, "Enter")
    one.sees("Complete: all touches are in the store")
    assert [entry.point for entry in machine.since(begin, "acknowledged")] == list(range(1, 11))


def test_ending_a_run_moves_nothing_and_keeps_what_there_is(
    machine: Live, page: Served, operator: Callable[..., Operator]
) -> None:
    one, begin = operator(page, "measure"), len(machine.nc.log)
    _record(one, machine)
    _runs_until(machine, begin, 2)
    one.press("End the run")
    one.press("Yes, do it")
    one.sees("ended by the operator of this page")
    waiting = len(machine.since(begin, "acknowledged"))
    machine.nc.speed = 0.0  # the program goes on to its next point, and waits there
    _wait(lambda: len(machine.since(begin, "offered")) > waiting)
    position = list(machine.nc.position)
    time.sleep(0.5)
    assert list(machine.nc.position) == position
    assert len(machine.since(begin, "acknowledged")) == waiting
    assert len(_run(page)[1]) >= waiting


def _runs(page: Served) -> list[Any]:
    with MeasurementStore.open(page.folder / "runs.db", create=False) as store:
        return store.runs()
