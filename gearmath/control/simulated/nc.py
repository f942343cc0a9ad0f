"""The NC of the simulated control: R parameters, one channel that runs programs, alarms, files, and a log."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import NamedTuple, Protocol

from gearmath.control import sinumerik
from gearmath.control.interface import AXES
from gearmath.control.sinumerik import PROGRAM_ABORTED, PROGRAM_RUNNING
from gearmath.errors import InputError
from gearmath.machine.control.blocks import PathRow
from gearmath.machine.control.executor import ProgramRun, run_program
from gearmath.machine.control.runner import Moment
from gearmath.machine.control.state import Deflected, Follower, Probe, Setup
from gearmath.machine.control.text import decoded

_OFFERED, _NUMBER, _ACKNOWLEDGED = 101, 102, 103
_TOUCH = range(200, 206)
#: R parameters of the control.
PARAMETERS = 1000
#: The position is moved on so often while a block takes its time. [s]
_SLICE = 0.02
_DWELL = 0.05
_RESET, _ACTIVE, _INTERRUPTED = 0, 1, 2
_JOG, _AUTOMATIC = 0, 2
_STEPS = 20_000_000


@dataclass(frozen=True)
class NcJob:
    """What one program meets on the machine."""

    probe: Probe | None = None
    setup: Setup = field(default_factory=Setup)
    deflected: Deflected = lambda position: False
    moved: Follower = lambda position: None
    done: Callable[[ProgramRun], object] = lambda run: None
    """Hears of the program when it has come to its end."""


class NcMachine(Protocol):
    """The machine behind the control."""

    def job(self, text: str, name: str, number: int) -> NcJob:
        """What a program meets, in run ``number``. Raises InputError where it cannot be run."""
        ...


class Logged(NamedTuple):
    """One thing that happened, at a time [s] of :func:`time.perf_counter`."""

    at: float
    what: str
    number: int
    point: int
    values: tuple[float, ...] = ()


@dataclass(frozen=True)
class NcAlarm:
    """An alarm as the control shows it; severities are 1, 500 and 1000."""

    number: str
    text: str
    severity: int = 1000


class _Reset(Exception):
    """RESET in mid-run."""


class Nc:
    """One channel. Programs run in a thread of their own; ``speed`` 1 is real time, 0 as fast as it is computed.

    Only the operator selects, starts and resets: :meth:`select`, :meth:`start`, :meth:`reset`.
    """

    def __init__(self, machine: NcMachine, speed: float = 1.0) -> None:
        self.machine, self.speed = machine, speed
        self.parameters: dict[int, float] = {}
        self.position = [0.0] * len(AXES)
        self.files: dict[str, bytes] = {}
        """By ``folder/NAME.MPF``."""
        self.selected, self.message, self.line = "", "", 0
        self.channel, self.program_state, self.mode = _RESET, 0, _JOG
        self.probe_deflected = False
        """Whether somebody deflects the stylus by hand."""
        self.alarms: dict[str, NcAlarm] = {}
        self.log: list[Logged] = []
        self.on_alarm: Callable[[str, NcAlarm, bool], object] = lambda key, alarm, active: None
        self._written: dict[int, float] = {}
        self._news = threading.Condition()
        self._thread: threading.Thread | None = None
        self._resetting = False
        self._before: tuple[float, ...] | None = None
        self._count = 0

    # what the operator does

    def select(self, path: str) -> None:
        """Select a program of ``files``, with the channel in reset."""
        name = path.rsplit("/", 1)[-1]
        self._refuse_busy(f"{name}: cannot be selected")
        if path not in self.files:
            raise InputError(f"{name}: cannot be selected: there is no such program on the control")
        self.selected, self.mode = path, _AUTOMATIC

    def start(self) -> None:
        """Start the selected program."""
        self._refuse_busy("the program cannot be started")
        if sinumerik.EMERGENCY_STOP in self._numbers():
            raise InputError("the program cannot be started: after an emergency stop RESET comes first")
        if not self.selected:
            raise InputError("the program cannot be started: none is selected")
        name = self.selected.rsplit("/", 1)[-1]
        self._resetting, self.channel, self.program_state, self.message = False, _ACTIVE, PROGRAM_RUNNING, ""
        text = decoded(self.files[self.selected], name)
        self._thread = threading.Thread(target=self._run, args=(text, name), name=f"nc {name}", daemon=True)
        self._thread.start()

    def reset(self) -> None:
        """RESET: the program is over, alarms go away."""
        with self._news:
            self._resetting = True
            self._news.notify_all()
        self.wait()
        for key in list(self.alarms):
            self._clear(key)

    def emergency_stop(self) -> None:
        """The button: alarm 3000, once, and the channel is interrupted until RESET."""
        if self.channel == _ACTIVE:
            self.channel = _INTERRUPTED
        if sinumerik.EMERGENCY_STOP not in self._numbers():
            self.raise_alarm(NcAlarm(sinumerik.EMERGENCY_STOP, "Emergency stop"))

    def wait(self, seconds: float | None = None) -> None:
        """Until the program is over."""
        if self._thread is not None:
            self._thread.join(seconds)

    def raise_alarm(self, alarm: NcAlarm) -> None:
        """An alarm comes up; it stays until RESET."""
        self._count += 1
        key = f"{alarm.number}-{self._count}"
        self.alarms[key] = alarm
        self.on_alarm(key, alarm, True)

    # what a client does

    def write(self, values: Mapping[int, float]) -> None:
        """R parameters from outside; a running program sees them at its next dwell."""
        with self._news:
            for number, value in values.items():
                self.parameters[number] = value
                if number == _ACKNOWLEDGED and self.channel != _RESET:
                    self._say("acknowledged", int(value))
            if self.channel != _RESET:
                self._written.update(values)
            self._news.notify_all()

    # what the program does

    def _refuse_busy(self, what: str) -> None:
        """Say which program keeps the channel from anything else, and what ends it."""
        name = self.selected.rsplit("/", 1)[-1]
        if self.channel == _ACTIVE:
            raise InputError(f"{what}: {name} runs")
        if self.channel == _INTERRUPTED:
            raise InputError(f"{what}: {name} is interrupted, and RESET comes first")

    def _numbers(self) -> set[str]:
        return {alarm.number for alarm in self.alarms.values()}

    def _say(self, what: str, point: int, values: tuple[float, ...] = ()) -> None:
        self.log.append(Logged(time.perf_counter(), what, int(self.parameters.get(_NUMBER, 0)), point, values))

    def _clear(self, key: str) -> None:
        self.on_alarm(key, self.alarms.pop(key), False)

    def _run(self, text: str, name: str) -> None:
        self._before, self._seen = None, dict(self.parameters)
        outcome = PROGRAM_ABORTED
        try:
            number = int(self.parameters.get(_NUMBER, 0)) + 1
            job = self.machine.job(text, name, number)
            # what lies there already, by the bare names that WRITE and DELETE use
            there = {
                path.rsplit("/", 1)[-1].removesuffix(".MPF"): content.decode("latin-1")
                for path, content in self.files.items()
                if path.startswith(self._folder) and path != self.selected
            }
            run = run_program(
                text,
                name,
                job.probe,
                self._host,
                self.parameters,
                step_limit=_STEPS,
                setup=job.setup,
                files=there,
                deflected=job.deflected,
                moved=job.moved,
                watch=self._watch,
            )
            self.parameters.update(run.parameters)
            self._keep(run.files)
            if run.alarm is not None:
                self.message = run.messages[-1] if run.messages else ""
                self.raise_alarm(NcAlarm(str(run.alarm[0]), self.message or "alarm of the program"))
            else:
                job.done(run)
                outcome, self.message = 0, ""
        except _Reset:
            self._say("reset", int(self.parameters.get(_OFFERED, 0)))
            self.message = ""
        except InputError as error:
            self.raise_alarm(NcAlarm("12550", str(error)))
        except Exception as error:
            self.raise_alarm(NcAlarm("1000", f"simulated machine: {type(error).__name__}: {error}"))
        finally:
            with self._news:
                self._written.clear()
                self.channel, self.program_state = _RESET, outcome

    _folder = f"{sinumerik.FOLDERS['MPF'].text}/"

    def _keep(self, files: Mapping[str, str]) -> None:
        """The files that a program wrote."""
        for stem, text in files.items():
            self.files[self._folder + sinumerik.WRITTEN_FILE(stem=stem)] = text.encode("latin-1")

    def _watch(self, moment: Moment) -> None:
        self.line = moment.line
        if self._resetting:
            self._keep({name: "".join(f"{line}\n" for line in lines) for name, lines in moment.files.items()})
            raise _Reset
        if moment.row is not None:
            self._travel(moment.row)
            return
        if moment.messages:
            self.message = moment.messages[-1]
        self._mirror(moment.parameters)
        self._held()

    def _mirror(self, parameters: Mapping[int, float]) -> None:
        """What the program has changed since the last look."""
        for number, value in parameters.items():
            if self._seen.get(number) == value:
                continue
            self._seen[number] = value
            with self._news:
                self.parameters[number] = value
                if number == _NUMBER:
                    self._written.pop(_ACKNOWLEDGED, None)
            if number == _OFFERED and value > 0.0:
                self._say("offered", int(value), tuple(parameters.get(k, 0.0) for k in _TOUCH))

    def _travel(self, row: PathRow) -> None:
        """The way of one block, in its time; another speed counts at once, as that of an override switch does."""
        start = self._before or row.position
        self._before = row.position
        share, at = 0.0, time.monotonic()
        while share < 1.0 and row.seconds > 0.0 and self.speed > 0.0 and not self._resetting:
            seconds = row.seconds / self.speed
            self.position = [a + share * (b - a) for a, b in zip(start, row.position, strict=True)]
            time.sleep(min(_SLICE, (1.0 - share) * seconds))
            before, at = at, time.monotonic()
            share += (at - before) / seconds
            self._held()
        self.position = list(row.position)

    def _held(self) -> None:
        """Nothing moves after an emergency stop, until RESET."""
        with self._news:
            while self.channel == _INTERRUPTED and not self._resetting:
                self._news.wait(_SLICE)

    def _host(self, parameters: Mapping[int, float]) -> Mapping[int, float]:
        """A dwell: what was written from outside in the meantime."""
        self._mirror(parameters)
        with self._news:
            if not self._written and not self._resetting:
                self._news.wait(_DWELL)
            written, self._written = self._written, {}
        return written
