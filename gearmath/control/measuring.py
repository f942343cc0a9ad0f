"""A measuring run with the numbered handshake: every touch is kept before the program is let go on.

The program offers point R101 of run R102 and waits; the host keeps what R200 to R205 hold and then writes
R103 = R101. That write is the only one that releases motion. After any loss the numbers are read anew before it is
decided whether to write: nothing is replayed.
"""

from __future__ import annotations

import asyncio
import time
from collections.abc import Awaitable, Callable
from contextlib import suppress
from dataclasses import dataclass

from gearmath.control.interface import (
    Alarm,
    ChannelState,
    ConnectionLost,
    Control,
    Handshake,
    NoSession,
    Run,
    RunStart,
    Status,
)
from gearmath.control.parts import base_of, last_in_a_row
from gearmath.errors import ComputationError, InputError, counted

Connect = Callable[[], Awaitable[Control]]
Say = Callable[[str], object]


@dataclass(frozen=True)
class Patience:
    """Times [s]: between looks at the handshake, and at channel and alarms; between attempts to connect, growing; until
    the first connection, and later ones, are given up; until the numbers of a new run are all its own, and until the
    alarm that ended a program has come."""

    look: float = 0.005
    state: float = 0.5
    first_retry: float = 0.1
    last_retry: float = 5.0
    first: float = 5.0
    give_up: float = 600.0
    settle: float = 0.1
    news: float = 0.3


class _Stopped(ComputationError):
    """The run is over before it is complete."""


class Measuring:
    """One attempt to bring a stored run to its end."""

    def __init__(
        self,
        connect: Connect,
        run: Run,
        patience: Patience | None = None,
        progress: Callable[[int], object] = lambda touches: None,
        say: Say = lambda sentence: None,
        holds: Callable[[int], bool] = lambda point: False,
        lost: Callable[[], object] = lambda: None,
    ) -> None:
        """``holds`` is asked before each point is acknowledged: while it says yes, the program waits there. ``lost``
        hears of each loss of the connection, before anything is done about it."""
        self._connect, self._run, self._progress, self._say = connect, run, progress, say
        self._holds, self._lost = holds, lost
        self._patience = patience or Patience()
        self._number: int | None = None
        self._baseline: int | None = None
        self.kept = dict(run.touches())
        """What is kept, by point."""
        self._missing = run.missing()
        self._alarms: dict[str, Alarm] = {}
        self._odd: Handshake | None = None
        self._last = 0
        """The last point of the stretch that the program makes now."""
        self._base = 0
        """R101 of the start that this host has prepared, until its first touch: no point that is offered."""
        self.interruption = "interrupted by the operator of the host"
        """Why it ends where this task is cancelled."""
        self.reconnected = 0
        self.is_ready = False
        """Whether the program may be started, or goes on already."""

    @property
    def is_started(self) -> bool:
        """Whether the program goes on, so far as is known."""
        return self._number is not None

    async def to_the_end(self, *stretches: tuple[int, int]) -> None:
        """Prepare, wait until the operator starts the program, and keep every touch; for points that do not follow each
        other once for each of the ``stretches``, R90 and R91 of each (none: the whole program).

        Raises ComputationError in one sentence where the run stops before it is complete; it may be resumed.
        """
        try:
            for parts in stretches or ((0, 0),):
                await self._stretch(parts)
        except asyncio.CancelledError:
            self._run.finish(self.interruption)
            raise
        except InputError as error:
            self._run.finish(str(error))
            raise
        except ComputationError as error:
            self._run.finish(str(error))
            kept = len(self._run.start.points) - len(self._missing)
            raise ComputationError(
                f"{error}; {kept} of {len(self._run.start.points)} touches are kept in run {self._run.id}: "
                f"go on with --resume {self._run.id}"
            ) from error
        self._run.finish("complete")

    async def _stretch(self, parts: tuple[int, int]) -> None:
        """One start of the program."""
        follows, self._number, self._baseline, self.is_ready = self.is_ready, None, None, False
        self._base = 0
        self._last = last_in_a_row(self._run.start.points, self._missing)
        control, ready = await self._again(self._patience.first), False
        try:
            while True:
                try:
                    if not ready:
                        if follows and self._baseline is None:
                            await self._ended(control)
                        await self._prepare(control, parts)
                        ready = self.is_ready = True
                    await self._follow(control)
                    with suppress(ComputationError):
                        await control.finished()
                    return
                except ConnectionLost as error:
                    self._lost()
                    self._say(f"{error}; connecting again")
                    await _leave(control)
                    if isinstance(error, NoSession):
                        await asyncio.sleep(self._patience.last_retry)
                    control = await self._again(self._patience.give_up)
                    self.reconnected += 1
        finally:
            if ready:
                await _release(control)
            await _leave(control)

    async def _again(self, seconds: float) -> Control:
        return await connected(self._connect, seconds, self._patience)

    async def _ended(self, control: Control) -> None:
        """Until the program of the stretch before has ended: after its last touch it still moves away."""
        while (await control.status()).channel is not ChannelState.RESET:
            await self._hear(control)
            await asyncio.sleep(self._patience.state)

    async def _prepare(self, control: Control, parts: tuple[int, int]) -> None:
        """The selected program must be the run's own; a channel in reset is told what to make."""
        start = self._run.start
        status = await _selected(control, start)
        for alarm in await control.alarms():
            self._alarms[alarm.key] = alarm
        handshake = await control.handshake()
        if status.channel is ChannelState.RESET:
            self._baseline = handshake.number
            text = start.program_text.decode("utf-8", "replace")
            self._base = base_of(start.points, text, self._missing) if parts[0] > 1 and self._missing else 0
            await control.prepare(*parts)
            touches = sum(point <= self._last for point in self._missing)
            more = len(self._missing) - touches
            later = f", {more} in later starts" if more else ""
            self._say(
                f"{control.name}: ready for {start.program}, {counted(touches, 'touch')}{later}: "
                "start it on the control"
            )
        elif self._baseline is not None:
            pass  # started while the connection was lost
        elif not self._resumed(handshake):
            raise _started(control, status)
        else:
            self._number = handshake.number

    @property
    def _is_open(self) -> bool:
        """Whether a point of this stretch is missing."""
        return bool(self._missing) and self._missing[0] <= self._last

    def _resumed(self, handshake: Handshake) -> bool:
        """Whether the program that runs waits for this run to go on."""
        if not (self.kept and handshake.waits and self._missing):
            return False
        kept = self.kept.get(handshake.offered)
        if kept is not None:
            return kept.number == handshake.number
        return handshake.offered == self._missing[0] and any(t.number == handshake.number for t in self.kept.values())

    async def _follow(self, control: Control) -> None:
        """Until the last touch is acknowledged."""
        looked = -self._patience.state
        while True:
            if time.monotonic() - looked >= self._patience.state:
                looked = time.monotonic()
                if await self._look_around(control):
                    return
            handshake = await control.handshake()
            if self._number is None:
                await self._join(handshake)
            elif handshake.number != self._number:
                if not self._is_open:
                    return
                raise _Stopped(
                    f"{control.name}: the control is in run {handshake.number}, this one was run {self._number}: the "
                    "program was started anew"
                )
            elif await self._served(control, handshake):
                return
            await asyncio.sleep(self._patience.look)

    async def _join(self, handshake: Handshake) -> None:
        """The operator has started the program when R102 has counted on."""
        if self._baseline is not None and handshake.number != self._baseline:
            # R101 to R103 are set in one block, and read one after the other
            await asyncio.sleep(self._patience.settle)
            self._number = handshake.number

    async def _served(self, control: Control, handshake: Handshake) -> bool:
        """Keep and acknowledge what is offered; True when nothing more is to come."""
        point = handshake.offered
        if not self._is_open and handshake.acknowledged == point == self._last:
            return True
        if not self._offers(handshake):
            return not self._is_open and point == self._last
        if not handshake.waits:
            raise _Stopped(f"{control.name}: the program does not wait for a host: R104 must be 1 before it is started")
        if point not in self.kept and not (self._is_open and point == self._missing[0]):
            # once may be a look in the middle of a change
            if self._odd != handshake:
                self._odd = handshake
                await asyncio.sleep(self._patience.settle)
                return False
            first = self._missing[0] if self._is_open else "none"
            raise _Stopped(f"{control.name}: point {point} is offered, the first one that is missing is {first}")
        touch = await control.touch(handshake.number)
        if point in self.kept:
            kept = self.kept[point]
            if kept.number == touch.number and kept != touch:
                raise _Stopped(f"{control.name}: point {point} is offered with other values than those that are kept")
        else:
            self._run.commit_touch(point, touch)
            self.kept[point] = touch
            self._missing.pop(0)
            self._progress(1)
        if self._holds(point):
            # what is kept already is acknowledged at a later look
            await asyncio.sleep(self._patience.settle)
            return False
        await control.acknowledge(point)
        return not self._is_open and point == self._last

    def _offers(self, handshake: Handshake) -> bool:
        """Whether the program offers a point that is not acknowledged."""
        point = handshake.offered
        on_its_way = point == 0 or (point == self._base and handshake.acknowledged == 0)
        return point != handshake.acknowledged and not on_its_way

    async def _look_around(self, control: Control) -> bool:
        """Alarms, and whether the program still runs; True when it has ended and nothing is missing."""
        status = await control.status()
        await self._hear(control)
        if self._number is not None and status.channel is ChannelState.RESET:
            if not self._is_open:
                return True
            handshake = await control.handshake()
            await asyncio.sleep(self._patience.news)
            await self._hear(control)
            if handshake.number == self._number and not self._offers(handshake):
                raise _Stopped(f"{control.name}: the program ended before point {self._missing[0]}{self._because()}")
            if handshake.number == self._number:
                raise _Stopped(f"{control.name}: the control was reset at point {handshake.offered}{self._because()}")
        return False

    async def _hear(self, control: Control) -> None:
        """Keep alarms that are new."""
        for alarm in await control.alarms():
            if alarm.key not in self._alarms:
                self._alarms[alarm.key] = alarm
                self._run.add_alarm(alarm)
                self._say(f"{control.name}: alarm {alarm.number}: {alarm.text}")

    def _because(self) -> str:
        """The alarms of this run, in words."""
        return "".join(f" (alarm {alarm.number}: {alarm.text})" for alarm in list(self._alarms.values())[-2:])


async def check_ready(connect: Connect, start: RunStart, patience: Patience | None = None) -> None:
    """Raise ComputationError where a new run could not begin: nothing is kept of one that never did.

    The selected program must be that of the run, and the channel in reset.
    """
    patience = patience or Patience()
    control = await connected(connect, patience.first, patience)
    try:
        status = await _selected(control, start)
        if status.channel is not ChannelState.RESET:
            raise _started(control, status)
    finally:
        await _leave(control)


async def connected(connect: Connect, seconds: float, patience: Patience) -> Control:
    """A new connection, with growing breaks."""
    begin, pause = time.monotonic(), patience.first_retry
    while True:
        try:
            return await connect()
        except ConnectionLost as error:
            if time.monotonic() - begin > seconds:
                raise _Stopped(f"{error}, after {seconds:.0f} s of trying") from error
            await asyncio.sleep(pause)
            pause = min(2 * pause, patience.last_retry)


async def _selected(control: Control, start: RunStart) -> Status:
    """The state of a control whose selected program is that of the run, byte for byte."""
    status = await control.status()
    if status.selected != start.program:
        selected = f"{status.selected} is selected" if status.selected else "no program is selected"
        raise _Stopped(f"{control.name}: {selected}, must be {start.program}: select it at the machine")
    if await control.get(start.program) != start.program_text:
        raise _Stopped(f"{control.name}: {start.program} on the control is not the program of this run")
    return status


def _started(control: Control, status: Status) -> _Stopped:
    return _Stopped(f"{control.name}: the channel is {status.channel}: measuring begins before the program is started")


async def _release(control: Control) -> None:
    """A program that is started later does not wait for a host that has gone. One that runs goes on waiting for it."""
    with suppress(ComputationError, InputError, OSError):
        if (await control.status()).channel is ChannelState.RESET:
            await control.finished()


async def _leave(control: Control) -> None:
    with suppress(ComputationError, InputError, OSError):
        await control.close()
