"""A simulated control in a thread of its own, with a program of ten touches; what happens on it is in its own log."""

from __future__ import annotations

import asyncio
import threading
from collections.abc import Callable, Coroutine, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import pytest

from gearmath.control.interface import RunStart
from gearmath.control.opcua import OpcUaControl
from gearmath.control.plan import planned
from gearmath.control.simulated.access import Access, Account
from gearmath.control.simulated.identity import prepared
from gearmath.control.simulated.nc import Logged, Nc, NcJob
from gearmath.control.simulated.server import Appearance, SimulatedControl
from gearmath.machine.control.state import Setup
from gearmath.specs.control_connection import ControlConnection, load_control_connection

PASSWORD = "not-in-any-file"
#: Ten touches along X, each with its own value, and the handshake of our probing programs.
TEN = """DEF INT UERR,UP,UFROM,UTO
R102=R102+1 R101=0 R103=0
UFROM=1 UTO=10
IF R90>0
UFROM=R90
ENDIF
IF R91>0
UTO=R91
ENDIF
R101=UFROM-1
WRITE(UERR,"TEN_T","# planned: 10 touches")
WRITE(UERR,"TEN_T","run,point,member,flank,tooth,row,col,X,Y,Z,A,B,triggered")
G17 G40 G90 G94 G710 G54 G60
T="PROBE" D1
M6
SPOS=0
G0 X0 Y0 Z100 A=DC(0) B0
FOR UP=UFROM TO UTO
MSG("point "<<UP)
MEAS=1 G1 X=UP*3.25 Y=IC(0) Z=IC(0) A=IC(0) B=IC(0) F1000
STOPRE
R200=$AA_MM[X] R201=$AA_MM[Y] R202=$AA_MM[Z] R203=$AA_MM[A] R204=$AA_MM[B] R205=$AC_MEA[1]
R101=R101+1
WRITE(UERR,"TEN_T",R102<<","<<R101<<",pinion,concave,"<<UP<<",2,4,"<<R200<<","<<R201<<","<<R202<<",0,0,"<<R205)
IF R104==1
WHILE R103<>R101
G4 F0.05
STOPRE
ENDWHILE
ENDIF
IF R105==UP
SETAL(65001)
M30
ENDIF
ENDFOR
M30
"""
NAME, PATH = "TEN.MPF", "Part Program/TEN.MPF"


class Air:
    """A machine whose probe triggers at nine tenths of every way."""

    def job(self, text: str, name: str, number: int) -> NcJob:
        return NcJob(probe=lambda start, end: start + 0.9 * (end - start))


@dataclass
class Live:
    """The simulated control, and what a test does to it from outside."""

    control: SimulatedControl
    loop: asyncio.AbstractEventLoop
    folder: Path
    rights: frozenset[str] = field(default=Account().rights)
    TEN = TEN
    NAME, PATH, PASSWORD = NAME, PATH, PASSWORD

    @property
    def nc(self) -> Nc:
        return self.control.nc

    @property
    def connection(self) -> ControlConnection:
        """As the file of the simulated control has it."""
        known = load_control_connection(self.folder / "control.toml")
        return known.model_copy(update={"url": self.control.url})

    def call(self, work: Coroutine[Any, Any, Any]) -> Any:
        """Run something where the control runs."""
        return asyncio.run_coroutine_threadsafe(work, self.loop).result(30)

    def soon(self, work: Callable[[], object]) -> None:
        """Do something where the control runs."""
        self.loop.call_soon_threadsafe(work)

    async def connect(self, *needed: str, seconds: float = 4.0, **changes: Any) -> OpcUaControl:
        """A session of this test."""
        known = self.connection.model_copy(update=changes)
        return await OpcUaControl.connect(known, PASSWORD, needed, seconds)

    def fresh(self) -> None:
        """As it was at the beginning, but for the log and the number of the run."""
        if self.nc.channel:
            self.nc.reset()
        for key in list(self.nc.alarms):
            self.nc._clear(key)
        number = self.nc.parameters.get(102, 0.0)
        self.nc.parameters.clear()
        self.nc.parameters[102] = number
        self.nc.files.clear()
        self.nc.selected, self.nc.speed = "", 0.0
        self.control.access.accounts["operator"].rights = self.rights
        self.control.access.operate = True
        self.control.clock_off *= 0

        async def line() -> None:
            self.control.fill_sessions(0)
            self.control.answer_slowly(0.0)
            self.control.line.cut()

        self.call(line())

    def load(self, text: str = TEN) -> None:
        """The program of ten touches, selected."""
        self.nc.files[PATH] = text.encode()
        self.nc.select(PATH)

    def since(self, begin: int, what: str) -> list[Logged]:
        """What the log says since its entry ``begin``."""
        return [one for one in self.nc.log[begin:] if one.what == what]


@pytest.fixture(scope="session")
def _live(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Live]:
    folder = tmp_path_factory.mktemp("control")
    loop = asyncio.new_event_loop()
    thread = threading.Thread(target=loop.run_forever, daemon=True)
    thread.start()

    async def begin() -> SimulatedControl:
        identity = await prepared(folder, "opc.tcp://127.0.0.1:4840")
        access = Access({"operator": Account(PASSWORD)})
        return await SimulatedControl(Nc(Air(), 0.0), access, identity, Appearance(("old",))).__aenter__()

    control = asyncio.run_coroutine_threadsafe(begin(), loop).result(60)
    yield Live(control, loop, folder)
    assert control.inner.budget.most <= 1000.0, "more samples a second than the control allows"
    asyncio.run_coroutine_threadsafe(control.__aexit__(), loop).result(30)
    loop.call_soon_threadsafe(loop.stop)
    thread.join(10)
    loop.close()


@pytest.fixture
def live(_live: Live) -> Iterator[Live]:
    _live.fresh()
    yield _live
    _live.fresh()


@pytest.fixture(scope="session")
def ten() -> RunStart:
    """A run of the ten touches."""
    plan = planned(TEN, NAME, Setup())
    return RunStart("simulated control", NAME, TEN.encode(), plan.columns, plan.points)
