"""Measuring runs with the handshake: whatever happens to line or machine, no touch is lost, doubled or replayed.

The log of the simulated control says what was offered with which values, and what was acknowledged.
"""

from __future__ import annotations

import asyncio
import contextlib
import os
import random
from collections.abc import Awaitable, Callable, Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from asyncua import ua

from gearmath.control import sinumerik
from gearmath.control.interface import RunStart, Touch
from gearmath.control.measuring import Measuring, Patience
from gearmath.control.run_start import begun, resumed
from gearmath.control.simulated.nc import NcAlarm
from gearmath.control.store import MeasurementStore, StoredRun
from gearmath.errors import ComputationError, InputError

RIGHTS = (sinumerik.READ_STATE, sinumerik.WRITE_STATE, sinumerik.READ_ALARMS, sinumerik.READ_FILES)
QUICK = Patience(state=0.1, last_retry=0.3, settle=0.05, first=60.0, give_up=60.0)
#: All 100 take three minutes, nearly all of it waiting: GEARMATH_DISCONNECTS=100.
SEEDS = range(int(os.environ.get("GEARMATH_DISCONNECTS", "12")))
Trouble = Callable[[], Awaitable[object]]


@pytest.fixture
def store(tmp_path: Path) -> Iterator[MeasurementStore]:
    with MeasurementStore.open(tmp_path / "runs.db") as found:
        yield found


async def _nothing() -> None: ...


async def _measure(
    live: Any,
    run: StoredRun,
    trouble: Trouble = _nothing,
    stretches: Sequence[tuple[int, int]] = (),
    start: bool = True,
    seconds: float = 4.0,
) -> Measuring:
    """A run from the operator's start to its end, with trouble from the moment at which the host is ready."""
    told: asyncio.Queue[str] = asyncio.Queue()
    one = Measuring(
        lambda: live.connect(*RIGHTS, seconds=seconds),
        run,
        QUICK,
        say=lambda sentence: told.put_nowait(sentence) if "start it" in sentence else None,
    )

    async def operator() -> None:
        while start:
            await told.get()
            live.nc.start()

    others = [asyncio.create_task(operator()), asyncio.create_task(trouble())]  # type: ignore[arg-type]
    try:
        await asyncio.wait_for(one.to_the_end(*stretches), 120)
    finally:
        for task in others:
            task.cancel()
        await asyncio.gather(*others, return_exceptions=True)
    return one


def _check(live: Any, begin: int, run: StoredRun) -> None:
    """Every touch is there as it was offered, and each was acknowledged once."""
    offered, acknowledged = (live.since(begin, what) for what in ("offered", "acknowledged"))
    points = list(run.start.points)
    assert [one.point for one in acknowledged] == points
    assert {one.point: one.values for one in offered} == {point: tuple(t)[1:] for point, t in run.touches().items()}
    assert [one.point for one in offered] == points
    kept = [t.X for t in run.touches().values()]
    assert kept == pytest.approx([3.25 * (k - 0.1) for k in points], abs=3.26)


def test_every_touch_is_kept_as_the_control_offered_it_and_acknowledged_once(
    live: Any, ten: RunStart, store: MeasurementStore
) -> None:
    live.load()
    begin, run = len(live.nc.log), store.begin_run(ten)
    asyncio.run(_measure(live, run))
    _check(live, begin, run)
    assert run.is_complete
    # what the program itself wrote into its file on the control is the same
    live.nc.wait(10)
    lines = live.nc.files["Part Program/TEN_T.MPF"].decode().splitlines()
    own = [float(line.split(",")[7]) for line in lines if line[:1].isdigit()]
    assert [touch.X for touch in run.touches().values()] == pytest.approx(own, abs=1e-8)


def test_a_touch_is_on_the_disk_before_it_is_acknowledged(
    live: Any, ten: RunStart, store: MeasurementStore, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A disk that takes the fourth touch no more: the program waits at it, and nobody has let it go on."""
    live.load()
    begin, run = len(live.nc.log), store.begin_run(ten)
    keep = run.commit_touch

    def full(point: int, values: Any) -> None:
        if point == 4:
            raise ComputationError("disk full")
        keep(point, values)

    monkeypatch.setattr(run, "commit_touch", full)
    with pytest.raises(ComputationError, match="disk full; 3 of 10 touches are kept in run 1"):
        asyncio.run(_measure(live, run))
    assert [one.point for one in live.since(begin, "acknowledged")] == [1, 2, 3]
    assert live.nc.parameters[103] == 3.0
    assert live.nc.channel == 1


@pytest.mark.slow
@pytest.mark.parametrize("seed", SEEDS)
def test_no_random_disconnect_loses_doubles_or_replays_a_touch(
    live: Any, ten: RunStart, store: MeasurementStore, seed: int
) -> None:
    """TCP cut, server down, slow answers, a line that is dead without a word: at random moments, two of them a run."""
    chance = random.Random(seed)
    live.load()
    begin, run = len(live.nc.log), store.begin_run(ten)

    async def trouble() -> None:
        while live.nc.parameters.get(104) != 1.0:
            await asyncio.sleep(0.002)
        for _ in range(2):
            await asyncio.sleep(chance.uniform(0.0, 0.3))
            kind = chance.choice(["cut", "dead", "slow", "restart"])
            if kind == "cut":
                live.soon(live.control.line.cut)
            elif kind == "dead":
                live.soon(live.control.line.die)
            elif kind == "restart":
                await asyncio.to_thread(live.call, live.control.restart(0.1))
            else:
                live.control.answer_slowly(chance.uniform(0.01, 0.2))
                await asyncio.sleep(0.3)
                live.control.answer_slowly(0.0)

    asyncio.run(_measure(live, run, trouble, seconds=1.5))
    _check(live, begin, run)


def test_scattered_points_are_touched_by_one_start_for_each_stretch(
    live: Any, ten: RunStart, store: MeasurementStore, tmp_path: Path
) -> None:
    """Points 2, 5, 6 and 9 as a run of their own: three starts, no other point, and the line is cut between two."""
    (tmp_path / live.NAME).write_text(live.TEN, "utf-8")
    files = "vertical_5axis.toml", "probe.toml"
    start, stretches = begun("control", tmp_path / live.NAME, "nasa_tp3096_12x36.toml", *files, points="2,5-6,9")
    assert stretches == [(2, 2), (5, 6), (9, 9)]
    live.load()
    begin, run = len(live.nc.log), store.begin_run(replace(start, refers_to=store.begin_run(ten).id))

    async def trouble() -> None:
        while live.nc.parameters.get(103) != 6.0:
            await asyncio.sleep(0.002)
        live.soon(live.control.line.cut)

    asyncio.run(_measure(live, run, trouble, stretches))
    assert run.is_complete
    assert list(run.start.points) == [2, 5, 6, 9]
    assert [one.point for one in live.since(begin, "acknowledged")] == [2, 5, 6, 9]
    # a part begins with R101 = R90 - 1, which the log has too
    offered = {one.point: one for one in live.since(begin, "offered") if one.point in run.start.points}
    assert {point: one.values for point, one in offered.items()} == {
        point: tuple(touch)[1:] for point, touch in run.touches().items()
    }
    assert [one.number - offered[2].number for one in offered.values()] == [0, 1, 1, 2]


@pytest.mark.parametrize("points", ["1", "10", "3,9-10", "1,4", "7-9"])
def test_a_program_on_its_way_to_its_first_touch_offers_nothing(
    live: Any, ten: RunStart, store: MeasurementStore, tmp_path: Path, points: str
) -> None:
    """R101 is the point before the part then, for as long as the machine moves there: a run that began looks at it."""
    text = live.TEN.replace('T="PROBE"', "G4 F0.5\n" * 6 + 'T="PROBE"')
    (tmp_path / live.NAME).write_text(text, "utf-8")
    files = "vertical_5axis.toml", "probe.toml"
    start, stretches = begun("control", tmp_path / live.NAME, "nasa_tp3096_12x36.toml", *files, points=points)
    live.load(text)
    begin, run = len(live.nc.log), store.begin_run(replace(start, refers_to=store.begin_run(ten).id))
    asyncio.run(_measure(live, run, stretches=stretches))
    assert run.is_complete
    assert [one.point for one in live.since(begin, "acknowledged")] == list(run.start.points)
    assert list(run.touches()) == list(start.points)


@pytest.mark.parametrize("missing", [1, 2, 10])
def test_a_resumed_run_acknowledges_no_point_that_was_not_offered(
    live: Any, ten: RunStart, store: MeasurementStore, missing: int
) -> None:
    """The point before the first one that is missing is kept, and R101 shows it until that one is touched."""
    text = live.TEN.replace('T="PROBE"', "G4 F0.5\n" * 6 + 'T="PROBE"')
    live.load(text)
    run = store.begin_run(replace(ten, program_text=text.encode()))
    for point in range(1, missing):
        run.commit_touch(point, Touch(1, float(point), 0.0, 0.0, 0.0, 0.0, 1.0))
    begin = len(live.nc.log)
    again = _resume(live, store, run)
    assert again.is_complete
    assert [one.point for one in live.since(begin, "acknowledged")] == list(range(missing, 11))


@pytest.mark.parametrize("points", ["11", "0", "6-5", "1,,2", "3;4", "1-11", ""])
def test_points_that_the_program_does_not_have_are_refused(live: Any, tmp_path: Path, points: str) -> None:
    (tmp_path / live.NAME).write_text(live.TEN, "utf-8")
    files = "vertical_5axis.toml", "probe.toml"
    with pytest.raises(InputError, match="--points"):
        begun("control", tmp_path / live.NAME, "nasa_tp3096_12x36.toml", *files, points=points)


async def _at(live: Any, point: int) -> None:
    """Until the program offers a point."""
    while not (live.nc.channel and live.nc.parameters.get(101) == point):
        await asyncio.sleep(0.002)


def _resume(live: Any, store: MeasurementStore, run: StoredRun) -> StoredRun:
    """The operator starts the program again, with what is missing."""
    again = store.resume_run(run.id)
    asyncio.run(_measure(live, again, stretches=resumed(again)))
    return again


@pytest.mark.parametrize("what", ["reset", "alarm of the program", "emergency stop"])
def test_what_ends_the_program_is_one_sentence_and_the_run_goes_on_later(
    live: Any, ten: RunStart, store: MeasurementStore, what: str
) -> None:
    live.load()
    run = store.begin_run(ten)

    async def trouble() -> None:
        if what == "alarm of the program":
            live.nc.parameters[105] = 6.0
            return
        await _at(live, 6)
        if what == "emergency stop":
            live.nc.emergency_stop()
            await asyncio.sleep(0.5)
        await asyncio.to_thread(live.nc.reset)

    # slow enough that the trouble comes before the end
    live.control.answer_slowly(0.03)
    said = {
        "reset": "reset at point|ended before point",
        "alarm of the program": "alarm 65001",
        "emergency stop": "alarm 3000: Emergency stop",
    }[what]
    with pytest.raises(ComputationError, match=said) as error:
        asyncio.run(_measure(live, run, trouble))
    assert "\n" not in str(error.value)
    assert f"go on with --resume {run.id}" in str(error.value)
    assert live.nc.parameters[104] == 0.0  # started without a host, the program would wait for it forever
    live.control.answer_slowly(0.0)
    if what != "reset":
        assert run.alarms()
    kept = len(run.touches())
    assert 5 <= kept <= 8
    live.nc.reset()
    live.nc.parameters[105] = 0.0
    again = _resume(live, store, run)
    assert again.is_complete
    assert len({touch.number for touch in again.touches().values()}) == 2
    assert [t.X for t in again.touches().values()] == pytest.approx(_alone(live, ten, store, kept), abs=1e-12)


def _alone(live: Any, ten: RunStart, store: MeasurementStore, kept: int) -> list[float]:
    """What an undisturbed run measures: each way begins where the last touch was, or at 0 after a new start."""
    values, at = [], 0.0
    for point in range(1, 11):
        at = 0.0 if point == kept + 1 else at
        at += 0.9 * (3.25 * point - at)
        values.append(at)
    return values


def test_a_host_that_died_finds_the_program_waiting_and_goes_on(
    live: Any, ten: RunStart, store: MeasurementStore
) -> None:
    """The host is gone in mid-run; the program waits at its point, and nobody has started it anew."""
    live.load()
    begin, run = len(live.nc.log), store.begin_run(ten)

    async def dies() -> None:
        task = asyncio.create_task(_measure(live, run))
        await _at(live, 4)
        task.cancel()
        await asyncio.gather(task, return_exceptions=True)

    live.control.answer_slowly(0.03)
    asyncio.run(dies())
    live.control.answer_slowly(0.0)
    again = store.resume_run(run.id)
    assert live.nc.channel == 1
    assert live.nc.parameters[104] == 1.0
    asyncio.run(_measure(live, again, start=False))
    _check(live, begin, again)


@pytest.mark.parametrize("what", ["none", "other name", "other text", "active", "no host"])
def test_a_run_does_not_begin_with_another_program_or_in_mid_run(
    live: Any, ten: RunStart, store: MeasurementStore, what: str
) -> None:
    said = {
        "none": "no program is selected",
        "other name": r"OTHER\.MPF is selected, must be TEN\.MPF",
        "other text": "is not the program of this run",
        "active": "before the program is started",
        "no host": "before the program is started",
    }[what]
    live.load(live.TEN + "; changed\n" if what == "other text" else live.TEN)
    if what == "none":
        live.nc.selected = ""
    if what == "other name":
        live.nc.files["Part Program/OTHER.MPF"] = live.TEN.encode()
        live.nc.select("Part Program/OTHER.MPF")
    if what in ("active", "no host"):
        live.nc.parameters[104] = 1.0
        live.nc.start()
    begin, run = len(live.nc.log), store.begin_run(ten)
    with pytest.raises(ComputationError, match=said):
        asyncio.run(_measure(live, run, start=False))
    assert not live.since(begin, "acknowledged")


def test_a_program_that_is_replaced_between_two_halves_of_a_run_is_noticed(
    live: Any, ten: RunStart, store: MeasurementStore
) -> None:
    live.load()
    run = store.begin_run(ten)
    live.nc.parameters[105] = 3.0
    with pytest.raises(ComputationError, match="alarm 65001"):
        asyncio.run(_measure(live, run))
    live.nc.reset()
    live.nc.files[live.PATH] = live.TEN.replace("3.25", "3.3").encode()
    with pytest.raises(ComputationError, match="is not the program of this run"):
        _resume(live, store, run)


def test_a_second_start_in_mid_run_is_not_taken_for_the_same_run(
    live: Any, ten: RunStart, store: MeasurementStore
) -> None:
    live.load()
    begin, run = len(live.nc.log), store.begin_run(ten)

    async def trouble() -> None:
        await _at(live, 5)
        live.control.answer_slowly(0.2)
        await asyncio.to_thread(live.nc.reset)
        live.nc.start()
        live.control.answer_slowly(0.0)

    live.control.answer_slowly(0.03)
    with pytest.raises(ComputationError, match=r"started anew|reset at point|ended before point"):
        asyncio.run(_measure(live, run, trouble))
    first = live.since(begin, "offered")[0].number
    assert all(one.number == first for one in live.since(begin, "acknowledged"))


def test_alarms_in_mid_run_are_kept_once_and_do_not_end_a_run_that_goes_on(
    live: Any, ten: RunStart, store: MeasurementStore
) -> None:
    live.load()
    begin, run = len(live.nc.log), store.begin_run(ten)

    async def trouble() -> None:
        await _at(live, 3)
        live.nc.raise_alarm(NcAlarm("700016", "lubrication low", 500))

    live.control.answer_slowly(0.03)
    asyncio.run(_measure(live, run, trouble))
    _check(live, begin, run)
    assert [alarm.number for alarm in run.alarms()] == ["700016"]


def test_a_run_waits_for_a_control_whose_sessions_or_subscriptions_others_keep(
    live: Any, ten: RunStart, store: MeasurementStore
) -> None:
    """Left-over subscriptions of lost sessions, and then a full session table, each for a while."""
    live.load()
    begin, run = len(live.nc.log), store.begin_run(ten)

    async def work() -> None:
        other = await live.connect()
        kept = []
        with contextlib.suppress(ua.uaerrors.BadTooManySubscriptions):  # some of lost sessions may be there still
            for _ in range(10):
                kept.append(await other._client.create_subscription(100, None))
        task = asyncio.create_task(_measure(live, run))
        await asyncio.sleep(1.0)
        assert not live.nc.channel
        for one in kept:
            await one.delete()
        await other.close()
        await _at(live, 5)
        live.control.fill_sessions()
        live.soon(live.control.line.cut)
        await asyncio.sleep(1.0)
        live.control.fill_sessions(0)
        await task

    asyncio.run(work())
    _check(live, begin, run)


def test_no_password_is_in_store_or_sentences(live: Any, ten: RunStart, store: MeasurementStore, caplog: Any) -> None:
    live.load()
    caplog.set_level("DEBUG", "gearmath")
    run = store.begin_run(ten)
    asyncio.run(_measure(live, run))
    content = b"".join(path.read_bytes() for path in store.path.parent.iterdir())
    assert live.PASSWORD.encode() not in content
    assert live.PASSWORD not in caplog.text
