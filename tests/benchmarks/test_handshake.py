"""A touch over an encrypted session: from its offer to its acknowledgement, beside one read of the same session."""

from __future__ import annotations

import asyncio
import statistics
from collections.abc import Callable
from typing import Any

import pytest

from gearmath.control import sinumerik
from gearmath.control.interface import RunStart
from gearmath.control.measuring import Measuring
from gearmath.control.plan import planned
from gearmath.control.store import MeasurementStore
from gearmath.machine.control.state import Setup
from tests.gearmath.control.live.conftest import Live, _live, live  # noqa: F401

RIGHTS = (sinumerik.READ_STATE, sinumerik.WRITE_STATE, sinumerik.READ_ALARMS, sinumerik.READ_FILES)


@pytest.mark.benchmark(group="a touch from offered to acknowledged")
def test_handshake(benchmark: Callable, live: Any, tmp_path: Any, timed: bool) -> None:  # noqa: F811
    """A run of many touches on a machine that takes no time, and median and worst by the log of the control."""
    many = 200 if timed else 5
    text = Live.TEN.replace("UTO=10", f"UTO={many}").replace("X=UP*3.25", "X=UP*0.325")
    plan = planned(text, Live.NAME, Setup())
    with MeasurementStore.open(tmp_path / "runs.db") as store:

        def measure() -> None:
            live.load(text)
            run = store.begin_run(RunStart("bench", Live.NAME, text.encode(), plan.columns, plan.points))

            def say(sentence: str) -> None:
                if "start it" in sentence:
                    live.nc.start()

            asyncio.run(Measuring(lambda: live.connect(*RIGHTS), run, say=say).to_the_end())

        benchmark.pedantic(measure, rounds=1)
    offered, acknowledged = (live.since(0, what)[-many:] for what in ("offered", "acknowledged"))
    assert [one.point for one in acknowledged] == list(range(1, many + 1))
    waits = [1000 * (b.at - a.at) for a, b in zip(offered, acknowledged, strict=True)]
    if timed:
        middle = statistics.median(waits)
        print(f"\noffered to acknowledged, {many} touches: median {middle:.1f} ms, worst {max(waits):.1f} ms")


@pytest.mark.benchmark(group="a touch from offered to acknowledged")
def test_read(benchmark: Callable, live: Any, timed: bool) -> None:  # noqa: F811
    """The same number of reads of the handshake's parameters, one after the other."""

    async def read() -> None:
        control = await live.connect(*RIGHTS)
        for _ in range(200 if timed else 5):
            await control.handshake()
        await control.close()

    benchmark.pedantic(lambda: asyncio.run(read()), rounds=1)
