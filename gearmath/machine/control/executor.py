"""Runs NC programs as the control would: the path they command, the probe they move, the files they write."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from gearmath.machine.control.blocks import ControlState
from gearmath.machine.control.expression import AXES, refuse
from gearmath.machine.control.linuxcnc_runner import LinuxCncRunner
from gearmath.machine.control.reader import read_program
from gearmath.machine.control.runner import Halt, Host, StatementRunner, Stopped, Watch
from gearmath.machine.control.state import Blind, Deflected, Follower, Probe, Setup
from gearmath.machine.control.text import is_for_linuxcnc
from gearmath.machine.control.tree import ParsedProgram
from gearmath.shown import Shown, Shows

#: Blocks and turns of loops that a program may run through.
STEP_LIMIT = 1_000_000
_KEPT: dict[str, ParsedProgram] = {}


@dataclass(frozen=True, repr=False)
class MachinePath(Shown):
    """What a program commands, one row for each motion block that ends at a known position of all five axes.

    A block of POLY has many rows: it is followed in straight parts, so short that they are it within ``CHORD``.
    """

    axes: np.ndarray
    """Positions X Y Z A B at the ends of the blocks, (n, 5) mm and rad; A counted on as the control turns it."""
    rapid: np.ndarray
    """Whether the block is a G0 block, (n,). The first row, and the first after a tool change, is always one."""
    tool: np.ndarray
    """Index into ``tools``, (n,)."""
    tools: tuple[str, ...]
    line: np.ndarray
    """Line number in the text, from 1, (n,)."""
    seconds: np.ndarray
    """Duration, (n,) s; 0 for a rapid block, whose speed is the machine's and not the program's."""
    rpm: np.ndarray
    """Speed of the spindle, (n,) turns per minute: negative with M4, 0 where it stands or is an axis."""
    measuring: np.ndarray = field(default_factory=lambda: np.zeros(0, dtype=bool))
    """Whether the block is a MEAS block, which ends where the probe triggers, (n,)."""
    cutter: np.ndarray = field(default_factory=lambda: np.zeros(0))
    """Position of the cutter's axis C at the ends, (n,) rad, counted on; NaN while the spindle is no axis."""
    unstated: tuple[str, ...] = ()
    """What the program leaves as it was when its first motion begins, in words of the program."""
    blind: tuple[Blind, ...] = ()
    """Motion while the position of an axis is unknown: at the start, and after a tool change."""
    changes: tuple[tuple[int, float | None], ...] = ()
    """Lines of tool changes, and the Z [mm] at which the axes stood, None where it is not known."""
    path_modes: dict[tuple[str, float, float], int] = field(default_factory=dict)
    """Path mode, CTOL [mm] and OTOL [degrees] of feed blocks, with the line of the first."""
    dynamics: dict[tuple[str, str], int] = field(default_factory=dict)
    """Acceleration and feed forward of feed blocks, with the line of the first."""
    coolant: np.ndarray = field(default_factory=lambda: np.zeros(0, dtype=bool))
    """Whether coolant is on, (n,)."""
    halts: tuple[Halt, ...] = ()
    """Where the axes wait: dwells and stops."""
    inner: np.ndarray = field(default_factory=lambda: np.zeros(0, dtype=bool))
    """Whether the row ends within a block of POLY, (n,)."""
    unset: dict[int, int] = field(default_factory=dict)
    """R parameters that are read before the program sets them, with the line: they keep what another program left."""
    ran: frozenset[int] = frozenset()
    """Lines whose statements have acted."""

    @property
    def spindle_on(self) -> np.ndarray:
        """Whether the spindle turns, (n,)."""
        return self.rpm != 0.0

    def _shown(self) -> tuple[str, list[Shows]]:
        feed, rapid = float(self.seconds.sum()), int(self.rapid.sum())
        return "path of a program", [("rows", len(self.axes), ""), ("rapid", rapid, ""), ("feed", feed, "s")]


@dataclass(frozen=True)
class ProgramRun:
    """All that a program did: its path, the texts of its files, its messages, the R parameters at its end."""

    path: MachinePath
    files: dict[str, str]
    messages: tuple[str, ...]
    parameters: dict[int, float]
    alarm: tuple[int, int] | None
    """Number and line of the first alarm that the program set, or None."""
    said: tuple[str, ...] = ()
    """What the control showed during each row of the path, empty before the first message."""
    taken: tuple[int, ...] = ()
    """Rows of the MEAS blocks whose positions the program read."""


#: Tables without offsets and tool lengths.
AS_WRITTEN = Setup()


def execute(text: str, name: str, setup: Setup = AS_WRITTEN) -> MachinePath:
    """The path of a program. Raises InputError with ``name``, line and column for what it must not do."""
    done = run_program(text, name, setup=setup)
    if done.alarm is not None:
        why = f": {done.messages[-1]}" if done.messages else ""
        refuse(name, done.alarm[1], 1, f"the program sets alarm {done.alarm[0]}{why}")
    return done.path


def parsed(text: str, name: str) -> ParsedProgram:
    """The statements of a text, as ``read_program`` reads them.

    A program is often run several times, from other states of the control: the last one is kept.
    """
    if text not in _KEPT:
        program = read_program(text, name)
        _KEPT.clear()
        _KEPT[text] = program
    return _KEPT[text]


def run_program(
    text: str,
    name: str,
    probe: Probe | None = None,
    host: Host | None = None,
    parameters: Mapping[int, float] | None = None,
    step_limit: int = STEP_LIMIT,
    setup: Setup = AS_WRITTEN,
    files: Mapping[str, str] | None = None,
    deflected: Deflected = lambda position: False,
    moved: Follower = lambda position: None,
    watch: Watch | None = None,
) -> ProgramRun:
    """Run a program as the control would, with a ``probe`` for its MEAS blocks and a ``host`` that answers.

    ``parameters`` are the R parameters at the start; others are 0. ``setup`` is how the control stands, ``files`` are
    the texts of those that WRITE adds to. ``deflected`` says what $A_PROBE shows; ``moved`` hears of every motion, and
    ``watch`` of every statement too.
    Raises InputError with ``name``, line and column for what a program must not do, and for one that takes more than
    ``step_limit`` steps.
    """
    if is_for_linuxcnc(text):
        return _on_linuxcnc(
            LinuxCncRunner(name, setup, probe, parameters or {}, step_limit, deflected, moved), text, files or {}
        )
    program = parsed(text, name)
    runner = StatementRunner(
        ControlState(name, probe, setup), host, dict(parameters or {}), step_limit, deflected, moved, watch
    )
    runner.holds(files or {})
    try:
        runner.all(program.body)
    except Stopped:
        pass
    else:
        if not runner.control.ended:
            refuse(name, program.lines, 1, "the text ends without M30: the program is not complete")
    return _done(runner)


def _on_linuxcnc(runner: LinuxCncRunner, text: str, files: Mapping[str, str]) -> ProgramRun:
    runner.files = {file: content.splitlines() for file, content in files.items()}
    runner.run(text)
    return _done(runner)


def _done(runner: StatementRunner | LinuxCncRunner) -> ProgramRun:
    return ProgramRun(
        _path(runner),
        {file: "".join(f"{line}\n" for line in lines) for file, lines in runner.files.items()},
        tuple(runner.messages),
        runner.parameters,
        runner.alarm,
        tuple(runner.said),
        tuple(sorted(runner.taken)),
    )


def _path(runner: StatementRunner | LinuxCncRunner) -> MachinePath:
    """The rows as arrays, in mm and rad."""
    rows, control = runner.rows, runner.control
    positions = np.array([row.position for row in rows]).reshape(-1, len(AXES))
    positions[:, 3:] = np.radians(positions[:, 3:])
    tools = tuple(dict.fromkeys(row.tool for row in rows))
    return MachinePath(
        axes=positions,
        rapid=np.array([row.rapid for row in rows], dtype=bool),
        tool=np.array([tools.index(row.tool) for row in rows], dtype=int),
        tools=tools,
        line=np.array([row.line for row in rows], dtype=int),
        seconds=np.array([row.seconds for row in rows]),
        rpm=np.array([row.rpm for row in rows]),
        measuring=np.array([row.measuring for row in rows], dtype=bool),
        cutter=np.radians(np.array([row.cutter for row in rows])),
        unstated=control.unstated or (),
        blind=tuple(control.blind),
        changes=tuple(control.changes),
        path_modes=dict(control.path_modes),
        dynamics=dict(control.dynamics),
        coolant=np.array([row.coolant for row in rows], dtype=bool),
        halts=tuple(runner.halts),
        inner=np.array([row.inner for row in rows], dtype=bool),
        unset=runner.unset,
        ran=frozenset(runner.ran),
    )
