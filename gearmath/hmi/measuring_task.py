"""The measuring run of the server: pages show it and ask for hold and go on; closing all of them stops nothing."""

from __future__ import annotations

import asyncio
import time
from collections import deque
from collections.abc import Coroutine, Mapping
from concurrent.futures import Future
from enum import StrEnum
from pathlib import Path
from typing import Any

from gearmath.control.interface import ChannelState, Touch
from gearmath.control.measuring import Measuring, check_ready
from gearmath.control.run_start import begun, resumed
from gearmath.control.store import MeasurementStore
from gearmath.control.store_run import StoredRun
from gearmath.errors import ComputationError, InputError
from gearmath.hmi.link import PATIENCE, ControlLink
from gearmath.hmi.state import Choice


class RunState(StrEnum):
    """How the run stands, in words that have a message each."""

    NONE = "none"
    PREPARING = "preparing"
    READY = "ready"
    RUNNING = "running"
    INTERRUPTED = "interrupted"
    HOLDING = "holding"
    HELD = "held"
    LOST = "lost"
    COMPLETE = "complete"
    ENDED = "ended"


class MeasuringTask:
    """One run at a time, in the loop of the control."""

    def __init__(self, link: ControlLink, store: Path) -> None:
        self._link, self._store = link, store
        self._measuring: Measuring | None = None
        self._future: Future[None] | None = None
        self._times: deque[tuple[float, int]] = deque(maxlen=50)
        self._hold = False
        self._end = RunState.NONE
        self.was_lost = False
        """Whether the connection was lost, and nobody has asked to go on since."""
        self.run: StoredRun | None = None
        self.held_at: int | None = None
        """The point at which the program waits because of a hold; None while it does not."""
        self.sentences: deque[str] = deque(maxlen=50)
        """What was said, the last one at the end."""
        self.reason = ""
        """Why the run ended before it was complete; empty where the operator ended it."""
        self.count = 0
        """Counts the runs that have ended."""

    # what pages ask for

    def start(self, program: Path, choice: Choice, points: str | None = None, again_of: int | None = None) -> None:
        """A new run of a program that lies on the control. Raises InputError where one goes on."""
        self._begin(self._new(program, choice, points, again_of))

    def resume(self, run: int) -> None:
        """Go on with a run of the store. Raises InputError where one goes on."""
        self._begin(self._old(run))

    def hold(self) -> None:
        """Acknowledge nothing any more: the program waits at its next point. Never moves anything."""
        self._hold = True

    def go_on(self) -> None:
        """Acknowledge again."""
        self._hold = self.was_lost = False
        self.held_at = None

    def stop(self) -> None:
        """End the run here; what is kept stays, and it may be resumed. Never moves anything."""
        if self._future is not None:
            self._future.cancel()

    # what pages show

    @property
    def is_going_on(self) -> bool:
        """Whether there is a run that has not ended."""
        return self._future is not None and not self._future.done()

    @property
    def state(self) -> RunState:
        """How it stands."""
        if not self.is_going_on:
            return self._end
        if self._measuring is None or not self._measuring.is_ready:
            return RunState.LOST if self.was_lost else RunState.PREPARING
        if self.held_at is not None:
            return RunState.HELD
        if self.was_lost:
            return RunState.LOST
        if self._hold:
            return RunState.HOLDING
        if not self._measuring.is_started:
            return RunState.READY
        status = self._link.view.status
        stands = status is not None and status.channel is ChannelState.INTERRUPTED
        return RunState.INTERRUPTED if stands else RunState.RUNNING

    @property
    def touches(self) -> Mapping[int, Touch]:
        """What is kept of the run, by point."""
        return {} if self._measuring is None else self._measuring.kept

    @property
    def total(self) -> int:
        """How many points the run has."""
        return 0 if self.run is None else len(self.run.start.points)

    @property
    def remaining(self) -> float | None:
        """About how long it still takes [s], by the last touches; None where that is not known."""
        times = list(self._times)
        if len(times) < 3 or self.state is not RunState.RUNNING:
            return None
        (before, first), (after, last) = times[0], times[-1]
        return (self.total - len(self.touches)) * (after - before) / max(1, last - first)

    # in the loop of the control

    def _begin(self, work: Coroutine[Any, Any, None]) -> None:
        if self.is_going_on:
            work.close()
            raise InputError("a measuring run goes on already: end it first")
        self._measuring, self.run, self.held_at = None, None, None
        self._hold = self.was_lost = False
        self._end, self.reason = RunState.NONE, ""
        self._times.clear()
        self.sentences.clear()
        self._future = self._link.submit(self._whole(work))

    async def _whole(self, work: Coroutine[Any, Any, None]) -> None:
        self._end = RunState.ENDED
        try:
            await work
            self._end = RunState.COMPLETE
        except (InputError, ComputationError) as error:
            # the cause is the sentence without the words for a command line
            self.reason = str(error.__cause__ if isinstance(error.__cause__, ComputationError) else error)
        finally:
            self.count += 1

    async def _new(self, program: Path, choice: Choice, points: str | None, again_of: int | None) -> None:
        start, stretches = await asyncio.to_thread(
            begun, self._link.name, program, choice.gear_set, choice.machine, choice.calibration, points, again_of
        )
        await check_ready(self._link.connect, start, PATIENCE)
        with MeasurementStore.open(self._store) as store:
            await self._measure(store.begin_run(start), stretches)

    async def _old(self, number: int) -> None:
        with MeasurementStore.open(self._store) as store:
            run = store.resume_run(number)
            await self._measure(run, await asyncio.to_thread(resumed, run))

    async def _measure(self, run: StoredRun, stretches: list[tuple[int, int]]) -> None:
        self.run = run
        self._measuring = Measuring(
            self._link.connect,
            run,
            PATIENCE,
            progress=self._heard,
            say=self.sentences.append,
            holds=self._holds,
            lost=self._lost,
        )
        await self._measuring.to_the_end(*stretches)

    def _heard(self, touches: int) -> None:
        before = self._times[-1][1] if self._times else 0
        self._times.append((time.monotonic(), before + touches))

    def _holds(self, point: int) -> bool:
        if self._hold:
            self.held_at = point
        return self._hold

    def _lost(self) -> None:
        """After a loss nothing is acknowledged until somebody asks for it."""
        self._hold = self.was_lost = True
