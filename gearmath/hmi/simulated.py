"""A simulated control inside the server, to learn on: what the operator does at the machine is on the page."""

from __future__ import annotations

import asyncio
import secrets
from contextlib import suppress
from pathlib import Path

from gearmath.control.interface import Control
from gearmath.control.opcua import OpcUaControl
from gearmath.control.simulated.access import Access, Account
from gearmath.control.simulated.identity import prepared
from gearmath.control.simulated.nc import Nc, NcAlarm
from gearmath.control.simulated.server import SimulatedControl
from gearmath.control.simulated.workshop import Workshop
from gearmath.control.sinumerik import FOLDERS
from gearmath.errors import InputError
from gearmath.hmi.link import ANSWER
from gearmath.hmi.state import Choice
from gearmath.specs.calibration import load_calibration
from gearmath.specs.control_connection import load_control_connection
from gearmath.specs.milling_machine import load_milling_machine
from gearmath.specs.simulated_machine import load_simulated_machine
from gearmath.specs.toml import find

NAME = "simulated control"
#: How many times faster than a machine.
_SPEED = 20.0


class SimulatedMachine:
    """The control and its operator. It is reached over OPC UA, as a real one is."""

    def __init__(self, folder: Path, choice: Choice, errors: str = "simulated_shop.toml") -> None:
        self._folder = folder
        self._workshop = Workshop(
            load_milling_machine(find(choice.machine)),
            load_calibration(find(choice.calibration)),
            load_simulated_machine(find(errors)),
        )
        self.nc = Nc(self._workshop, _SPEED)
        self._password = secrets.token_urlsafe(12)
        self._control: SimulatedControl | None = None
        self._starting = asyncio.Lock()

    async def connect(self) -> Control:
        """A session; the control is switched on for the first one."""
        async with self._starting:
            if self._control is None:
                identity = await prepared(self._folder, "opc.tcp://127.0.0.1:4840")
                access = Access({"operator": Account(self._password)})
                self._control = await SimulatedControl(self.nc, access, identity).__aenter__()
        known = load_control_connection(self._folder / "control.toml")
        here = known.model_copy(update={"url": self._control.url, "name": NAME})
        return await OpcUaControl.connect(here, self._password, seconds=ANSWER)

    def programs(self) -> list[str]:
        """The programs on the control."""
        return sorted(path.rsplit("/", 1)[-1] for path in self.nc.files)

    # what the operator does at the machine

    def select(self, name: str, gear_set: str) -> None:
        """Select a program; ``gear_set`` is what the machine is told of the work. Raises InputError."""
        self._workshop.load(find(gear_set))
        self.nc.select(f"{FOLDERS[name.rsplit('.', 1)[-1]].text}/{name}")

    def start(self) -> None:
        """NC start. Raises InputError where the machine does not."""
        self.nc.start()

    async def reset(self) -> None:
        """RESET."""
        await asyncio.to_thread(self.nc.reset)

    def emergency_stop(self) -> None:
        """The button."""
        self.nc.emergency_stop()

    def raise_alarm(self, number: str, text: str) -> None:
        """An alarm of the machine."""
        self.nc.raise_alarm(NcAlarm(number, text))

    def touch_probe(self) -> None:
        """Deflect the stylus by hand, and let it go by the next call."""
        self.nc.probe_deflected = not self.nc.probe_deflected

    async def cut_line(self) -> None:
        """The network fails for a moment. In the loop of the control only."""
        if self._control is None:
            raise InputError(f"{NAME}: is not switched on yet")
        self._control.line.cut()

    async def close(self) -> None:
        """Switch it off. In the loop of the control only."""
        if self._control is not None:
            with suppress(Exception):
                await self._control.__aexit__()
