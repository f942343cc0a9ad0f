"""The control as the server sees it: watched all the time, in a thread with a loop of its own.

No page and no long computation keeps the handshake of a measuring run waiting, and none of them owns a session.
Watching only reads; what is written is in :mod:`gearmath.hmi.measuring_task` and :meth:`ControlLink.send`.
"""

from __future__ import annotations

import asyncio
import threading
import time
from collections.abc import Coroutine
from concurrent.futures import Future
from contextlib import suppress
from dataclasses import dataclass
from typing import Any, TypeVar

from gearmath.control.delivery import deliver
from gearmath.control.interface import ChannelState, Control, Status
from gearmath.control.measuring import Connect, Patience, connected
from gearmath.errors import ComputationError, InputError
from gearmath.hmi.alarm_book import AlarmBook
from gearmath.hmi.probe_check import ProbeCheck

#: Times [s]: between two looks at the state, between two looks at alarms and probe, and between attempts to connect.
LOOK, NEWS = 0.2, 0.5
_FIRST_RETRY, _LAST_RETRY = 0.2, 5.0
#: A session over an encrypted line takes seconds where control or server are busy: it is not given up before.
PATIENCE = Patience(first=20.0)
#: A value that is older [s] is called stale.
STALE = 1.5
#: How long an answer of the control may take [s]: the server computes as well, and a slow answer is no lost line, which
#: would hold a measuring run. Values are stale, and nothing is acknowledged, long before.
ANSWER = 10.0
_Answer = TypeVar("_Answer")


@dataclass(frozen=True)
class View:
    """The control at the moment of the last answer. ``at`` is None while there was none."""

    at: float | None = None
    status: Status | None = None
    probe: bool | None = None
    connected: bool = False
    problem: str = ""
    """Why there is no connection, in one sentence of the client."""

    @property
    def age(self) -> float | None:
        """How old it is [s]."""
        return None if self.at is None else time.monotonic() - self.at

    @property
    def is_stale(self) -> bool:
        """Whether the values may be others by now."""
        return not self.connected or self.age is None or self.age > STALE


class ControlLink:
    """``name`` is what the control is called; ``connect`` gives a new session each time."""

    def __init__(self, name: str, connect: Connect, book: AlarmBook) -> None:
        self.name, self.connect, self.book = name, connect, book
        self.view = View()
        self.check = ProbeCheck()
        """Whether the probe was seen to work, while no program ran."""
        self._loop = asyncio.new_event_loop()
        self._thread = threading.Thread(target=self._loop.run_forever, name="control", daemon=True)
        self._watch: Future[None] | None = None

    def open(self) -> None:
        """Begin to watch."""
        self._thread.start()
        self._watch = self.submit(self._watching())

    def close(self) -> None:
        """Give the session back; a second time there is none."""
        if not self._thread.is_alive():
            return
        if self._watch is not None:
            self._watch.cancel()
        with suppress(Exception):
            self.submit(self._rest()).result(5.0)
        self._loop.call_soon_threadsafe(self._loop.stop)
        self._thread.join(5.0)

    def submit(self, work: Coroutine[Any, Any, _Answer]) -> Future[_Answer]:
        """Run something in the loop of the control."""
        return asyncio.run_coroutine_threadsafe(work, self._loop)

    async def send(self, name: str, content: bytes, replace: bool) -> None:
        """Write a program to the control and read it back, in a session of its own. In this loop only."""
        control = await connected(self.connect, PATIENCE.first, PATIENCE)
        try:
            await deliver(control, name, content, replace)
        finally:
            await _leave(control)

    async def _watching(self) -> None:
        pause = _FIRST_RETRY
        while True:
            begin = time.monotonic()
            control: Control | None = None
            try:
                control = await self.connect()
                await self._look(control)
            except (ComputationError, InputError, OSError) as error:
                last = self.view
                self.view = View(last.at, last.status, last.probe, False, str(error))
                self.check.look(None)
            finally:
                if control is not None:
                    await _leave(control)
            pause = _FIRST_RETRY if time.monotonic() - begin > _LAST_RETRY else min(2 * pause, _LAST_RETRY)
            await asyncio.sleep(pause)

    async def _look(self, control: Control) -> None:
        news, probe = -NEWS, None
        while True:
            status = await control.status()
            if time.monotonic() - news >= NEWS:
                news = time.monotonic()
                self.book.hear(await control.alarms())
            probe = await control.probe_deflected()
            self.view = View(time.monotonic(), status, probe, True)
            if status.channel is ChannelState.RESET:  # what touches else is no hand
                self.check.look(probe)
            await asyncio.sleep(LOOK)

    async def _rest(self) -> None:
        """What is still to be ended in this loop."""
        others = [task for task in asyncio.all_tasks() if task is not asyncio.current_task()]
        for task in others:
            task.cancel()
        await asyncio.gather(*others, return_exceptions=True)


async def _leave(control: Control) -> None:
    with suppress(ComputationError, InputError, OSError):
        await control.close()
