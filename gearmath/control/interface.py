"""What any machine control offers, and what a measurement store keeps: the rest of the package knows nothing else.

Node names, the transport of the handshake and the way of files belong to one implementation; the OPC UA client is the
first one.
"""

from __future__ import annotations

from collections.abc import AsyncGenerator, Mapping, Sequence
from dataclasses import dataclass, field
from enum import StrEnum
from typing import NamedTuple, Protocol

from gearmath.errors import ComputationError

#: Axes of a machine, in the order of every position here, mm and degrees.
AXES = ("X", "Y", "Z", "A", "B")


class ConnectionLost(ComputationError):
    """The control does not answer any more: what was asked may or may not have been done."""


class NoSession(ConnectionLost):
    """The control has no session, or no subscription, left: those that were lost go after its session time-out."""


class ChannelState(StrEnum):
    """What the channel of a control does, in words that no control uses for something else."""

    RESET = "reset"
    ACTIVE = "active"
    INTERRUPTED = "interrupted"
    UNKNOWN = "unknown"


@dataclass(frozen=True)
class Status:
    """How a control stands at one moment."""

    channel: ChannelState
    mode: str
    """jog, MDA, automatic or unknown."""
    selected: str
    """The main program that is selected, as the control names it; empty where there is none."""
    message: str
    """What the running program shows by MSG."""
    position: tuple[float, ...]
    """X Y Z A B in machine coordinates, mm and degrees."""


@dataclass(frozen=True)
class Alarm:
    """One alarm of a control; the same ``key`` is the same alarm."""

    key: str
    number: str
    text: str
    severity: int
    active: bool
    time: str = ""


class Handshake(NamedTuple):
    """The numbers of the handshake: point that the program offers, its run, point that was acknowledged, and whether
    the program waits for a host at all."""

    offered: int
    number: int
    acknowledged: int
    waits: bool


class Touch(NamedTuple):
    """One touch as the control gives it: run of the control (R102), X Y Z A B at the trigger in mm and degrees, and
    whether it triggered (1.0 or 0.0)."""

    number: int
    X: float
    Y: float
    Z: float
    A: float
    B: float
    triggered: float


class Control(Protocol):
    """Data, alarms, files and measuring of one control. Every call raises ConnectionLost where there is no answer, and
    ComputationError in one sentence where the control refuses."""

    name: str
    """Where it is, for sentences and for the store; holds no password."""

    async def status(self) -> Status: ...

    async def alarms(self) -> list[Alarm]:
        """The alarms that are active now, each once."""
        ...

    async def read_parameters(self, numbers: Sequence[int]) -> list[float]:
        """R parameters by number."""
        ...

    async def write_parameters(self, values: Mapping[int, float]) -> None:
        """Set R parameters. Refused for those of the handshake, which only :meth:`acknowledge` writes."""
        ...

    async def put(self, name: str, content: bytes, replace: bool = False) -> None:
        """Write a program. Refused while the channel is active, and for the selected program."""
        ...

    async def get(self, name: str) -> bytes:
        """A program or result file."""
        ...

    def watch(self, interval: float) -> AsyncGenerator[tuple[float, tuple[float, ...]], None]:
        """Time [s] and position X Y Z A B, at every ``interval`` [s]."""
        ...

    def watch_parameters(
        self, numbers: Sequence[int], interval: float
    ) -> AsyncGenerator[tuple[float, tuple[float, ...]], None]:
        """Time [s] and R parameters, at every ``interval`` [s]."""
        ...

    async def probe_deflected(self) -> bool | None:
        """Whether the probe signals a touch now; None where the control does not tell."""
        ...

    async def handshake(self) -> Handshake: ...

    async def touch(self, number: int) -> Touch:
        """What the program offers now, in run ``number``."""
        ...

    async def acknowledge(self, point: int) -> None:
        """Let the program go on to the next point: the only write that releases motion."""
        ...

    async def prepare(self, first: int, last: int) -> None:
        """Before the operator starts: the program is to make these of its parts (0, 0: all), and to wait for a host."""
        ...

    async def finished(self) -> None:
        """After the last touch: a program that is started later does not wait for a host."""
        ...

    async def close(self) -> None: ...


@dataclass(frozen=True)
class RunStart:
    """What a run is stored with, as it was when the run began."""

    control: str
    """Name of the control."""
    program: str
    """Name of the program on the control."""
    program_text: bytes
    columns: tuple[str, ...]
    """Columns of the touch file: ``run, point``, the cells of ``points``, ``X, Y, Z, A, B, triggered``."""
    points: Mapping[int, tuple[str, ...]]
    """The points that the run makes, in order, with the cells that say where each is (member, flank, tooth, row,
    col; target in a calibration program)."""
    files: Mapping[str, bytes] = field(default_factory=dict)
    """Set, machine and calibration file as they were, by a short name such as ``set.toml``."""
    settings: Mapping[str, str] = field(default_factory=dict)
    operator: str = ""
    refers_to: int | None = None
    """The stored run of which chosen points are probed again."""


class Run(Protocol):
    """One stored run. A point is kept once; nothing of a run is ever changed or removed."""

    id: int
    start: RunStart

    def commit_touch(self, point: int, values: Touch) -> None:
        """Keep a touch: durable on return. Raises InputError for a point that is not of the run or is there already."""
        ...

    def touches(self) -> Mapping[int, Touch]:
        """What is kept, by point."""
        ...

    def missing(self) -> list[int]:
        """The points that are not kept yet, in order."""
        ...

    def add_alarm(self, alarm: Alarm) -> None: ...

    def finish(self, outcome: str) -> None:
        """The run is over: ``complete``, or in words why it is not. A run that is not complete may be resumed."""
        ...


class Store(Protocol):
    """Where runs are kept. ``Store.open(path)`` of the implementation gives one."""

    def begin_run(self, start: RunStart) -> Run: ...

    def resume_run(self, run: int) -> Run:
        """A run that is there already, with its touches. Raises InputError where there is none, or it is complete."""
        ...
