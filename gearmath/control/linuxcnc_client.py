"""A LinuxCNC on this computer as a control: status, messages, files and the handshake, through its own Python modules.

Its modules belong to the Python of the system, so that a small process of that Python stands between
(``linuxcnc_bridge.py``). It selects and starts nothing: the operator does, at the screen of LinuxCNC. The numbers of
the handshake are analog outputs of the program; what the host answers are signals of HAL, named as in the example that
``gearmath nc probe --configuration`` writes. Errors are taken from the channel from which the screen takes them too:
each is heard by one of them only.
"""

from __future__ import annotations

import asyncio
import json
import time
from collections.abc import AsyncGenerator, Mapping, Sequence
from configparser import ConfigParser
from configparser import Error as IniError
from contextlib import suppress
from pathlib import Path
from typing import Any, Self

from gearmath.control.interface import Alarm, ChannelState, ConnectionLost, Handshake, Status, Touch
from gearmath.errors import ComputationError, InputError
from gearmath.files import read_bytes, read_text, write_bytes
from gearmath.machine.writing.linuxcnc.probe_words import NUMBER, OFFERED, POINTS_OF_A_RUN, VALUES

#: The Python that LinuxCNC is installed for.
PYTHON = ("/usr/bin/python3",)
#: Signals of HAL: what this host says to the program.
ACKNOWLEDGED, FIRST, LAST, WAITING = "gearmath-acknowledged", "gearmath-first", "gearmath-last", "gearmath-host"
#: How long an answer of the process beside LinuxCNC may take. [s]
_PATIENCE = 5.0
_MODES = "jog", "MDA", "automatic"
_SEVERITY = 1000


class LinuxCncControl:
    """One connection; see :class:`gearmath.control.interface.Control`."""

    rights: frozenset[str] = frozenset()
    """LinuxCNC knows no users."""

    def __init__(self, ini: Path, process: asyncio.subprocess.Process) -> None:
        self.name, self._ini, self._process = f"LinuxCNC, {ini.name}", ini, process
        self._alarms: list[Alarm] = []
        self._turn = asyncio.Lock()

    @classmethod
    async def connect(cls, ini: Path, python: Sequence[str] = PYTHON) -> Self:
        """To the LinuxCNC that was started with this INI file. ``python`` is the command of the system's Python.

        Raises InputError for a file that is missing, ConnectionLost where no LinuxCNC runs.
        """
        read_text(ini)
        bridge = Path(__file__).with_name("linuxcnc_bridge.py")
        pipe = asyncio.subprocess.PIPE
        try:
            process = await asyncio.create_subprocess_exec(
                *python, str(bridge), str(ini.resolve()), stdin=pipe, stdout=pipe, stderr=pipe
            )
        except OSError as error:
            raise InputError(f"{python[0]}: cannot be run: {error.strerror}: is LinuxCNC installed?") from error
        one = cls(ini, process)
        try:
            await one._answer()
        except ConnectionLost:
            await one.close()
            raise ConnectionLost(f"{one.name}: no LinuxCNC runs here with this file") from None
        return one

    async def status(self) -> Status:
        now = await self._now()
        channel = ChannelState.RESET if now["interpreter"] == now["idle"] else ChannelState.ACTIVE
        if now["paused"]:
            channel = ChannelState.INTERRUPTED
        modes = dict(zip(now["modes"], _MODES, strict=True))
        selected = Path(now["file"]).name if now["file"] else ""
        mode = modes.get(now["mode"], "unknown")
        return Status(channel, mode, selected, now["message"], tuple(float(value) for value in now["position"]))

    async def alarms(self) -> list[Alarm]:
        """The errors since the connection was made: LinuxCNC does not say when one is over."""
        await self._now()
        return list(self._alarms)

    async def read_parameters(self, numbers: Sequence[int]) -> list[float]:
        raise ComputationError(f"{self.name}: LinuxCNC has no R parameters, and shows those of its programs to none")

    async def write_parameters(self, values: Mapping[int, float]) -> None:
        raise ComputationError(f"{self.name}: LinuxCNC has no R parameters, and lets none set those of its programs")

    async def put(self, name: str, content: bytes, replace: bool = False) -> None:
        """Write a program into the folder of LinuxCNC's programs. Refused while it runs, and for the one selected."""
        status, target = await self.status(), self._folder() / name
        if status.channel is not ChannelState.RESET:
            raise ComputationError(f"{self.name}: {name} is not written: the channel is {status.channel}")
        if status.selected == name:
            raise ComputationError(f"{self.name}: {name} is not written: it is selected")
        if target.exists() and not replace:
            raise ComputationError(f"{self.name}: {name} is there already: --replace writes over it")
        write_bytes(target, content)

    async def get(self, name: str) -> bytes:
        """A program, or a result file, which lies in the folder of the INI file."""
        places = [self._folder() / name, self._ini.parent / name]
        found = next((place for place in places if place.is_file()), None)
        if found is None:
            raise ComputationError(f"{self.name}: there is no {name}")
        return read_bytes(found)

    async def watch(self, interval: float) -> AsyncGenerator[tuple[float, tuple[float, ...]], None]:
        while True:
            yield time.monotonic(), (await self.status()).position
            await asyncio.sleep(interval)

    def watch_parameters(
        self, numbers: Sequence[int], interval: float
    ) -> AsyncGenerator[tuple[float, tuple[float, ...]], None]:
        raise ComputationError(f"{self.name}: LinuxCNC has no R parameters, and shows those of its programs to none")

    async def probe_deflected(self) -> bool | None:
        return bool((await self._now())["probe"])

    async def handshake(self) -> Handshake:
        return _handshake(await self._now())

    async def touch(self, number: int) -> Touch:
        now = await self._now()
        return Touch(number, *(float(now["out"][output]) for output in VALUES))

    async def acknowledge(self, point: int) -> None:
        now = _handshake(await self._now())
        if now.offered != point:
            raise ComputationError(f"{self.name}: point {now.offered} is offered, not {point}: nothing is acknowledged")
        await self._ask(do="set", signal=ACKNOWLEDGED, value=now.number * POINTS_OF_A_RUN + point)

    async def prepare(self, first: int, last: int) -> None:
        for signal, value in ((FIRST, first), (LAST, last), (WAITING, 1)):
            await self._ask(do="set", signal=signal, value=value)

    async def finished(self) -> None:
        for signal in (WAITING, FIRST, LAST):
            await self._ask(do="set", signal=signal, value=0)

    async def close(self) -> None:
        if self._process.returncode is None:
            if self._process.stdin is not None:
                self._process.stdin.close()
            with suppress(asyncio.TimeoutError):
                await asyncio.wait_for(self._process.wait(), _PATIENCE)
                return
            self._process.kill()
            await self._process.wait()

    def _folder(self) -> Path:
        """Where LinuxCNC looks for programs."""
        ini = ConfigParser(strict=False, interpolation=None, allow_no_value=True)
        try:
            ini.read_string(read_text(self._ini))
        except IniError as error:
            raise InputError(f"{self._ini}: cannot be read: {str(error).splitlines()[0]}") from error
        prefix = ini.get("DISPLAY", "PROGRAM_PREFIX", fallback=".") or "."
        return self._ini.parent / Path(prefix).expanduser()

    async def _now(self) -> dict[str, Any]:
        """How the control stands; errors are kept."""
        now = await self._ask(do="status")
        for text in now["errors"]:
            number = str(len(self._alarms) + 1)
            at = time.strftime("%Y-%m-%dT%H:%M:%S")
            plain = "".join(letter if letter.isprintable() else " " for letter in text)[:300]
            self._alarms.append(Alarm(f"{at} {number}", number, plain, _SEVERITY, True, at))
        return now

    async def _ask(self, **asked: object) -> dict[str, Any]:
        async with self._turn:
            try:
                assert self._process.stdin is not None
                self._process.stdin.write(json.dumps(asked).encode() + b"\n")
                await self._process.stdin.drain()
            except (OSError, ConnectionError) as error:
                raise ConnectionLost(f"{self.name}: LinuxCNC does not answer") from error
            answer = await self._answer()
        if "refused" in answer:
            raise ConnectionLost(f"{self.name}: {answer['refused'] or 'LinuxCNC does not answer'}")
        return answer

    async def _answer(self) -> dict[str, Any]:
        assert self._process.stdout is not None
        try:
            while True:
                line = await asyncio.wait_for(self._process.stdout.readline(), _PATIENCE)
                if not line:
                    raise ConnectionLost(f"{self.name}: LinuxCNC does not answer")
                with suppress(ValueError):  # its modules print words of their own
                    answer = json.loads(line)
                    if isinstance(answer, dict):
                        return answer
        except TimeoutError:
            raise ConnectionLost(f"{self.name}: LinuxCNC does not answer within {_PATIENCE:g} s") from None


def _handshake(now: Mapping[str, Any]) -> Handshake:
    offered, number, answered = (round(float(one)) for one in (now["out"][OFFERED], now["out"][NUMBER], now["in"]))
    acknowledged = answered - number * POINTS_OF_A_RUN
    return Handshake(offered, number, acknowledged if 0 <= acknowledged < POINTS_OF_A_RUN else 0, now["host"])
