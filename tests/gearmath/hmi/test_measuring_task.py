"""The measuring run of the server against the simulated control, without a browser."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from gearmath.control import sinumerik
from gearmath.control.interface import RunStart, Touch
from gearmath.control.store import MeasurementStore
from gearmath.control.store_summary import summaries
from gearmath.errors import InputError
from gearmath.hmi import measuring_task
from gearmath.hmi.alarm_book import AlarmBook
from gearmath.hmi.link import ControlLink
from gearmath.hmi.measuring_task import MeasuringTask, RunState
from gearmath.hmi.probe_check import ProbeCheck
from gearmath.hmi.programs_work import probing_programs
from gearmath.hmi.runs_work import checked_points, close_run, unfinished_runs
from gearmath.hmi.state import SERVER_ENDED, Shared
from gearmath.specs.toml import bundled
from tests.gearmath.control.live.conftest import _live, live, ten  # noqa: F401
from tests.gearmath.hmi.built import Built, build  # noqa: F401

RIGHTS = (sinumerik.READ_STATE, sinumerik.WRITE_STATE, sinumerik.READ_ALARMS, sinumerik.READ_FILES)
FILES = {"set.toml": "nasa_tp3096_12x36.toml", "machine.toml": "vertical_5axis.toml", "calibration.toml": "probe.toml"}


def _wait(condition: Callable[[], Any], seconds: float = 30.0) -> None:
    until = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < until, "waited in vain"
        time.sleep(0.02)


@pytest.fixture
def link(live: Any) -> Iterator[ControlLink]:  # noqa: F811
    found = ControlLink("control", lambda: live.connect(*RIGHTS), AlarmBook())
    found.open()
    yield found
    found.close()


@pytest.fixture
def stored(ten: RunStart, tmp_path: Path) -> Path:  # noqa: F811
    """A store with a complete run of the ten touches; its program waits before it moves to its first one."""
    text = ten.program_text.replace(b'T="PROBE"', b"G4 F0.5\n" * 6 + b'T="PROBE"')
    files = {name: bundled(file).read_bytes() for name, file in FILES.items()}
    start = RunStart(ten.control, ten.program, text, ten.columns, ten.points, files, {"set.toml": "mine.toml"})
    with MeasurementStore.open(tmp_path / "runs.db") as store:
        _touched(store, start, 10).finish("complete")
    return tmp_path / "runs.db"


def _touched(store: MeasurementStore, start: RunStart, touches: int) -> Any:
    run = store.begin_run(start)
    for point in list(start.points)[:touches]:
        run.commit_touch(point, Touch(1, float(point), 0.0, 0.0, 0.0, 0.0, 1.0))
    return run


def test_chosen_points_are_touched_again_by_program_and_files_of_their_run(
    live: Any,  # noqa: F811
    link: ControlLink,
    stored: Path,
) -> None:
    """The first of them is not the first of the program. Neither the folder nor what is chosen now has a say."""
    with MeasurementStore.open(stored) as store:
        old = store.run(1).start
    live.load(old.program_text.decode())
    task = MeasuringTask(link, stored)
    _wait(lambda: link.view.connected)
    task.start_again(1, "9")
    _wait(lambda: task.state in (RunState.READY, RunState.ENDED))
    assert task.state is RunState.READY, task.reason
    live.nc.start()
    _wait(lambda: not task.is_going_on)
    assert task.state is RunState.COMPLETE, task.reason
    with MeasurementStore.open(stored) as store:
        run = store.run(2)
        assert list(run.touches()) == [9]
        assert run.start.refers_to == 1
        assert run.start.files == old.files
        assert run.start.settings["set.toml"] == "mine.toml"


def test_a_server_that_is_ended_says_so_in_the_store(live: Any, link: ControlLink, stored: Path) -> None:  # noqa: F811
    with MeasurementStore.open(stored) as store:
        live.load(store.run(1).start.program_text.decode())
    shared = Shared(stored, link=link)
    shared.measuring = MeasuringTask(link, stored)
    _wait(lambda: link.view.connected)
    shared.measuring.start_again(1, "9")
    _wait(lambda: shared.measuring.state is RunState.READY)
    shared.close()
    with MeasurementStore.open(stored) as store:
        assert summaries(store)[-1].state == SERVER_ENDED


def test_the_server_sees_the_probe_checked_whatever_page_is_open(live: Any, link: ControlLink) -> None:  # noqa: F811
    _wait(lambda: link.check.state == "ask")
    live.nc.probe_deflected = True
    _wait(lambda: link.check.state == "deflected")
    live.nc.probe_deflected = False
    _wait(lambda: link.check.is_done)
    link.check.begin()
    live.load("G4 F60\nG4 F60\n" * 1000 + "M30\n")
    live.nc.start()
    _wait(lambda: link.view.status and link.view.status.channel == "active")
    for deflected in (False, True, False):
        live.nc.probe_deflected = deflected
        _wait(lambda wanted=deflected: link.view.probe is wanted)
    assert link.check.state == "ask", "what a program touches is no hand"


def test_a_check_counts_for_one_run(live: Any, link: ControlLink, stored: Path) -> None:  # noqa: F811
    with MeasurementStore.open(stored) as store:
        live.load(store.run(1).start.program_text.decode())
    task, link.check = MeasuringTask(link, stored), ProbeCheck()
    for signal in (False, True, False):
        link.check.look(signal)
    task.start_again(1, "9")
    _wait(lambda: task.state is RunState.READY)
    assert link.check.state == "ask"
    task.stop()
    _wait(lambda: not task.is_going_on)


def test_what_was_not_touched_or_was_closed_is_not_to_be_resumed(stored: Path) -> None:
    with MeasurementStore.open(stored) as store:
        start = store.run(1).start
        for touches in (0, 4, 3):
            _touched(store, start, touches).finish("reset")
    assert [(one.run, one.kept) for one in unfinished_runs(stored)] == [(4, 3), (3, 4)]
    for note in ("", "  "):
        with pytest.raises(InputError, match="note: is missing: say why"):
            close_run(stored, 3, note)
    with pytest.raises(InputError, match="run 1 is complete"):
        close_run(stored, 1, "done")
    close_run(stored, 3, " stylus was loose ")
    assert [one.run for one in unfinished_runs(stored)] == [4]
    with MeasurementStore.open(stored) as store:
        assert [one.closed for one in summaries(store)] == ["", "", "stylus was loose", ""]
        assert len(store.run(3).touches()) == 4
        store.resume_run(3)  # by the command it may still be gone on with
    assert [one.run for one in unfinished_runs(stored)] == [4, 3]


@pytest.mark.parametrize("points", ["abc", "0", "11", "20-17", "3;4", "<b>", "3,", "1-11"])
def test_points_are_refused_in_words_of_a_page(stored: Path, points: str) -> None:
    with pytest.raises(InputError, match=r"^points .*must be") as error:
        checked_points(stored, 1, points)
    assert "--" not in str(error.value)
    checked_points(stored, 1, "3, 9-10")


def test_a_hold_is_no_part_of_the_time_that_is_left(
    live: Any,  # noqa: F811
    link: ControlLink,
    stored: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Two seconds a touch, four of ten are kept: twelve seconds, were the hold a minute or a lost line an hour."""
    at = [0.0]
    monkeypatch.setattr(measuring_task.time, "monotonic", lambda: at[0])
    monkeypatch.setattr(MeasuringTask, "state", RunState.RUNNING)
    monkeypatch.setattr(MeasuringTask, "total", 10)
    task, touches = MeasuringTask(link, stored), dict.fromkeys(range(1, 5))
    monkeypatch.setattr(MeasuringTask, "touches", touches)
    for point in touches:
        at[0] += 2.0
        task._heard(1)
        if point == 2:
            task.hold()
            assert task._holds(point)
            at[0] += 60.0
            assert task._holds(point)
            task.go_on()
        if point == 3:
            task._lost()
            at[0] += 3600.0
            task.go_on()
    assert task.remaining == pytest.approx(12.0)


def test_the_page_offers_probing_programs_only_and_counts_teeth_from_zero(
    build: Callable[..., Built],  # noqa: F811
    stored: Path,
) -> None:
    (stored.parent / "CUT.MPF").write_text("; CUT\nM30\n", "utf-8")
    (stored.parent / "PROBE.MPF").write_text('N10 WRITE(UERR,"P_T","# planned: 2 touches, 1 tooth")\n', "utf-8")
    assert probing_programs(stored.parent) == ["PROBE.MPF"]
    link = ControlLink("control", None, AlarmBook())  # type: ignore[arg-type]
    shared = Shared(stored, link=link)
    shared.measuring = MeasuringTask(link, stored)
    with MeasurementStore.open(stored) as store:
        start = store.run(1).start
        points = {1: ("pinion", "concave", "0", "4", "8"), 2: ("pinion", "concave", "12", "4", "8")}
        again = RunStart(start.control, start.program, start.program_text, start.columns, points, start.files)
        shared.measuring.run = _touched(store, again, 2)
        shared.measuring._measuring = measuring_task.Measuring(None, shared.measuring.run)  # type: ignore[arg-type]
        page = build(shared, "measure")
    assert page.select("Probing program").options == ["PROBE.MPF"]
    (table,) = [one for one in page.client.elements.values() if hasattr(one, "rows")]
    assert [row["place"] for row in table.rows] == [
        "Pinion concave, tooth 0 (again at the end), row 4, column 8",
        "Pinion concave, tooth 0, row 4, column 8",
    ]
