"""Statements of a program in the order in which they act: variables, logic, messages and files around its blocks."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import NamedTuple

import numpy as np

from gearmath.errors import counted
from gearmath.machine.control.blocks import ControlState, PathRow
from gearmath.machine.control.expression import AXES, NcVariable, Node, Value, refuse
from gearmath.machine.control.state import Deflected, Follower
from gearmath.machine.control.tree import Block, Branch, Command, Definition, Loop, Statement
from gearmath.machine.control.values import evaluate, indices, number

#: What a host does while the program waits: it sees the R parameters, and returns those that it writes.
Host = Callable[[Mapping[int, float]], Mapping[int, float]]

_LAST_PARAMETER = 999
#: What $AA_IM shows where the program is run from an unknown position: clear of everything.
_UP_AND_AWAY = 1e5
_ALARMS = (65000, 69999)
#: What WRITE and DELETE report [unconfirmed].
_NO_SUCH_FILE, _FILE_FULL = 3.0, 10.0
_KILOBYTE = 1000
#: R parameters that operator and host set before a program, or that it counts on from run to run.
HANDED_IN = frozenset((90, 91, 101, 102, 103, 104))


class Moment(NamedTuple):
    """Where a program stands, for who watches it run; the tables are those of the program, and go on changing."""

    line: int
    parameters: Mapping[int, float]
    messages: list[str]
    files: Mapping[str, list[str]]
    row: PathRow | None
    """The motion that has been made, at the end of its block; None before a statement."""


#: Hears of every statement before it acts, and of every motion; what it raises ends the program.
Watch = Callable[[Moment], object]


class Halt(NamedTuple):
    """A dwell, a wait for the axes, a spindle that is switched off or a stop, and how many rows of the path, and moves
    before the position was known, lie before it."""

    line: int
    stop: bool
    rows: int
    blind: int
    seconds: float = 0.0
    """Of a dwell."""


class Stopped(Exception):
    """The program ended before the end of its text: M30 in a branch or in a loop."""


class StatementRunner:
    """Statements in the order in which they act."""

    def __init__(
        self,
        control: ControlState,
        host: Host | None,
        parameters: dict[int, float],
        step_limit: int,
        deflected: Deflected,
        moved: Follower,
        watch: Watch | None,
    ) -> None:
        self.unset: dict[int, int] = {}
        self.ran: set[int] = set()
        self.control, self.host, self.parameters, self.steps_left = control, host, parameters, step_limit
        self.deflected, self.moved, self.watch = deflected, moved, watch
        self.variables: dict[tuple[str, tuple[int, ...]], float] = {}
        self.integer: dict[str, bool] = {}
        self.rows: list[PathRow] = []
        self.files: dict[str, list[str]] = {}
        self._sizes: dict[str, int] = {}
        self.messages: list[str] = []
        self.halts: list[Halt] = []
        self.taken: set[int] = set()
        self.said: list[str] = []
        self.alarm: tuple[int, int] | None = None
        self._pending: dict[int, float] = {}
        self._limit, self._latched = step_limit, -1

    def holds(self, files: Mapping[str, str]) -> None:
        """The files that are there before the program begins."""
        self.files = {file: content.splitlines() for file, content in files.items()}
        self._sizes = {file: len(content) for file, content in files.items()}

    def all(self, body: tuple[Statement, ...]) -> None:
        for statement in body:
            self._step(statement.line)
            self._watched(statement.line)
            self.ran.add(statement.line)
            if isinstance(statement, Block):
                self._block(statement)
            elif isinstance(statement, Command):
                self._command(statement)
            elif isinstance(statement, Branch):
                truth = self._truth(statement.condition, statement.line, statement.column)
                self._inner(statement.then if truth else statement.otherwise)
            elif isinstance(statement, Loop):
                self._loop(statement)
            else:
                self._define(statement)

    def read(self, variable: NcVariable, index: tuple[int, ...], line: int) -> Value:
        """The value of a variable, for :func:`evaluate`."""
        name, column = variable.name, variable.column
        if name == "R":
            if index[0] > _LAST_PARAMETER:
                refuse(self.control.name, line, column, f"R{index[0]}: R parameters go from 0 to {_LAST_PARAMETER}")
            if index[0] not in self.parameters and index[0] not in HANDED_IN:
                self.unset.setdefault(index[0], line)
            return self.parameters.get(index[0], 0.0)
        if name.startswith("$"):
            return self._system(variable, line)
        if (name, index) not in self.variables:
            self._unknown(variable, index, line)
        return self.variables[name, index]

    def _unknown(self, variable: NcVariable, index: tuple[int, ...], line: int) -> None:
        where = f"[{','.join(map(str, index))}]" if index else ""
        refuse(self.control.name, line, variable.column, f"the variable {variable.name}{where} is not defined")

    def _system(self, variable: NcVariable, line: int) -> Value:
        latch, name, control = self.control.latch, variable.name, self.control
        setup = control.setup
        if name == "$A_PROBE":
            return float(bool(self.rows) and self.deflected(internal(self.rows[-1].position)))
        if name == "$AA_IM":
            if setup.position is None:
                return _UP_AND_AWAY
            return control.position[variable.axis] + setup.zero[AXES.index(variable.axis)]
        tables: dict[str, Callable[[], Value]] = {
            "$P_ACTFRAME": lambda: control.frame_part(*variable.axis.split(",")),
            "$P_TOOLL": lambda: control.length,
            "$P_TOOLNO": lambda: 0.0 if control.fetched is None else 1.0,
            "$TC_TP2": lambda: control.fetched or "",
            "$MN_SCALING_SYSTEM_IS_METRIC": lambda: float(setup.metric),
            "$MN_INT_INCR_PER_MM": lambda: setup.increments[0],
            "$MN_INT_INCR_PER_DEG": lambda: setup.increments[1],
            "$MN_LEN_PROTOCOL_FILE": lambda: setup.result_file_kB,
        }
        if name in tables:
            return tables[name]()
        if latch is None or not latch.synchronised:
            refuse(self.control.name, line, variable.column, f"{name} without a MEAS block and STOPRE before it")
        if name == "$AC_MEA":
            return float(latch.triggered)
        self.taken.add(self._latched)
        values = latch.machine if name == "$AA_MM" else latch.work
        if variable.axis not in values:
            what = f"{name}[{variable.axis}]: {variable.axis} was not in the MEAS block, so that it was not latched"
            refuse(self.control.name, line, variable.column, what)
        return values[variable.axis]

    def _step(self, line: int) -> None:
        self.steps_left -= 1
        if self.steps_left < 0:
            refuse(self.control.name, line, 1, f"the program is not at its end after {self._limit} steps")

    def _number(self, node: Node, line: int, column: int) -> float:
        return number(node, self, self.control.name, line, column)

    def _truth(self, node: Node, line: int, column: int) -> bool:
        value = evaluate(node, self, self.control.name, line)
        if not isinstance(value, bool):
            refuse(self.control.name, line, column, "a condition is needed here, such as R1==2")
        return value

    def _inner(self, body: tuple[Statement, ...]) -> None:
        """A body within a structure; M30 in it ends the program."""
        self.all(body)
        if self.control.ended:
            raise Stopped

    def _watched(self, line: int, row: PathRow | None = None) -> None:
        if self.watch is not None:
            self.watch(Moment(line, self.parameters, self.messages, self.files, row))

    def _block(self, block: Block) -> None:
        for target, value in block.assignments:
            self._assign(target, self._number(value, block.line, target.column), block.line)
        turning = self.control.spindle_on
        row = self.control.run(block, lambda node, column: self._number(node, block.line, column))
        for part in row.parts() if row is not None else ():
            self.rows.append(part)
            self.said.append(self.messages[-1] if self.messages else "")
            if part.measuring:
                self._latched = len(self.rows) - 1
            self.moved(internal(part.position))
            self._watched(block.line, part)
        for key in ("dwell", "program stop"):
            if key in block.words:
                self.halts.append(self._halt(block, key))
        if turning and not self.control.spindle_on:
            self.halts.append(Halt(block.line, False, len(self.rows), len(self.control.blind)))
        if "dwell" in block.words and self.host is not None:
            self._pending.update(self.host(dict(self.parameters)))

    def _assign(self, target: NcVariable, value: float, line: int) -> None:
        index = indices(target, self, self.control.name, line)
        if target.name == "R":
            self.parameters.setdefault(index[0], value)  # to be written, not read
        self.read(target, index, line)
        if target.name == "R":
            self.parameters[index[0]] = value
        else:
            self.variables[target.name, index] = _whole(value) if self.integer[target.name] else value

    def _loop(self, loop: Loop) -> None:
        if loop.counter is None or loop.first is None or loop.last is None:
            while loop.condition is not None and self._truth(loop.condition, loop.line, loop.column):
                self._step(loop.line)
                self._inner(loop.body)
            return
        count = self._number(loop.first, loop.line, loop.column)
        self._assign(loop.counter, count, loop.line)
        while count <= self._number(loop.last, loop.line, loop.column):
            self._step(loop.line)
            self._inner(loop.body)
            count = self._number(loop.counter, loop.line, loop.column) + 1.0
            self._assign(loop.counter, count, loop.line)

    def _define(self, definition: Definition) -> None:
        if self.rows:
            refuse(self.control.name, definition.line, definition.column, "DEF after the first motion")
        for name, sizes, node in definition.variables:
            if name in self.integer:
                refuse(self.control.name, definition.line, definition.column, f"{name} is defined twice")
            value = self._number(node, definition.line, definition.column)
            self.integer[name] = definition.integer
            for index in np.ndindex(*sizes):
                self.variables[name, index] = _whole(value) if definition.integer else value

    def _halt(self, block: Block, key: str) -> Halt:
        seconds = 0.0
        if key == "dwell":
            seconds = self._number(block.words["F"].value, block.line, block.words["F"].column)
        return Halt(block.line, key != "dwell", len(self.rows), len(self.control.blind), seconds)

    def _command(self, command: Command) -> None:
        control, line, column = self.control, command.line, command.column
        if command.name == "STOPRE":
            self.halts.append(Halt(line, False, len(self.rows), len(control.blind)))
            if control.latch is not None:
                control.latch.synchronised = True
            self.parameters.update(self._pending)
            self._pending = {}
        elif command.name == "TRANS":
            if any(axis not in "XYZ" for axis, _ in command.words):
                refuse(control.name, line, column, "TRANS of a rotary axis is not understood")
            control.modal["frames"] = "TRANS"
            control.shift = {axis: self._number(node, line, column) for axis, node in command.words}
        elif command.name == "FGROUP":
            control.modal["path axes"] = "FGROUP"
            control.feed_axes = "".join(axis for axis, _ in command.words)
        elif command.name in ("SPCON", "SPCOF"):
            self._arguments(command, 0)
        else:
            self._say(command)

    def _arguments(self, command: Command, *counts: int) -> list[Value]:
        if len(command.arguments) not in counts:
            what = f"{command.name} with {counted(len(command.arguments), 'argument')} is not understood"
            refuse(self.control.name, command.line, command.column, what)
        return [evaluate(node, self, self.control.name, command.line) for node in command.arguments]

    def _say(self, command: Command) -> None:
        """MSG, SETAL, DELETE and WRITE."""
        name, line, column = self.control.name, command.line, command.column
        if command.name == "MSG":
            self.messages += [str(value) for value in self._arguments(command, 0, 1)]
            return
        if command.name == "SETAL":
            (alarm,) = self._arguments(command, 1)
            if not (isinstance(alarm, float) and alarm == int(alarm) and _ALARMS[0] <= alarm <= _ALARMS[1]):
                refuse(name, line, column, f"SETAL({alarm}): alarms of users go from {_ALARMS[0]} to {_ALARMS[1]}")
            self.alarm = self.alarm or (int(alarm), line)
            return
        self._file(command)

    def _file(self, command: Command) -> None:
        """WRITE adds a line to a file, DELETE removes one; both report into a variable."""
        name, line, column = self.control.name, command.line, command.column
        _, file, *texts = self._arguments(command, 2 if command.name == "DELETE" else 3)
        error = command.arguments[0]
        if not (isinstance(error, NcVariable) and self.integer.get(error.name)):
            refuse(name, line, column, f"the first argument of {command.name} must be a variable of DEF INT")
        if not (isinstance(file, str) and all(isinstance(text, str) for text in texts)):
            refuse(name, line, column, f"{command.name} takes the name of a file{' and a text' if texts else ''}")
        if command.name == "DELETE":
            self._assign(error, 0.0 if self.files.pop(file, None) is not None else _NO_SUCH_FILE, line)
            self._sizes.pop(file, None)
            return
        (text,) = map(str, texts)
        size = self._sizes.get(file, 0) + len(text) + 1
        if size > _KILOBYTE * self.control.setup.result_file_kB:
            self._assign(error, _FILE_FULL, line)
            return
        self._assign(error, 0.0, line)
        self._sizes[file] = size
        self.files.setdefault(file, []).append(text)


def _whole(value: float) -> float:
    """A number as a variable of DEF INT keeps it: halves go up."""
    return float(math.floor(value + 0.5))


def internal(position: tuple[float, ...]) -> np.ndarray:
    """A position X Y Z A B in mm and rad."""
    return np.array([*position[:3], *map(math.radians, position[3:])])
