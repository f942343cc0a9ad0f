"""Whether a program stops where the control is not set up as it counts on: tried with every state that it should see.

A program of the machine file's compares units, increments, offsets, frames and tool with the control before it moves.
Whoever takes such a check out of it, or widens it, leaves a program that runs with a wrong tool or a wrong zero.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from gearmath.errors import InputError
from gearmath.machine.control.executor import run_program
from gearmath.machine.control.state import Setup
from gearmath.machine.control.text import is_for_linuxcnc
from gearmath.machine.judging.faults import Fault
from gearmath.specs.milling_machine import AXES, MillingMachine

#: Motions that a program may make before it has looked at its tool: Z up, to the tool change, and up again.
_FEW = 8
#: An offset and a length that are wrong by so little must be seen. [mm, degree]
_OFF = 0.01
#: So far under the height from which on a tool clears the work a start must be refused. [mm]
_UNDER = 1.0


class _Moving(Exception):
    """The program goes on to move."""


def start_faults(
    text: str,
    machine: MillingMachine,
    probe_length: float = 0.0,
    file_kB: float = 0.0,
    clear: float | None = None,
) -> Iterator[Fault]:
    """One fault with all states of the control that the program does not stop for; none where it sees them all.

    ``probe_length`` [mm] is that of the probe that a program moves, ``file_kB`` what its result file takes; from the Z
    ``clear`` [mm] on the tool is above the work.
    """
    asks_units = not is_for_linuxcnc(text)  # LinuxCNC tells a program nothing of units, and has no frames
    states = [*_wrong(machine, probe_length, asks_units)]
    if file_kB and asks_units:
        right = Setup.of(machine, probe_length)
        states.append(("the control allows no result file that is long enough", replace(right, result_file_kB=file_kB)))
    if clear is not None:
        where = np.array(machine.work_offset_values) + np.array([0.0, 0.0, clear - _UNDER, 0.0, 0.0])
        low = replace(Setup.of(machine, probe_length), position=tuple(where.tolist()))
        states.append((f"the tool stands lower than Z {clear:.1f} and may be under the work", low))
    unseen = [what for what, setup in states if not _stops(text, setup)]
    if unseen:
        yield Fault(f"does not stop before it cuts where {'; or where '.join(unseen)}")


def _stops(text: str, setup: Setup) -> bool:
    """Whether a program ends with an alarm before it does more than to get its tool."""
    left = _FEW

    def moved(_: np.ndarray) -> None:
        nonlocal left
        left -= 1
        if left < 0:
            raise _Moving

    def touches(start: np.ndarray, end: np.ndarray) -> None:
        raise _Moving  # an alarm that follows would be of the touch

    try:
        return run_program(text, "the program", touches, setup=setup, moved=moved).alarm is not None
    except _Moving:
        return False
    except InputError:  # the model does not run on: neither would the control
        return True


def _wrong(machine: MillingMachine, probe_length: float, asks_units: bool) -> Iterator[tuple[str, Setup]]:
    """A right control with one thing wrong."""
    right = Setup.of(machine, probe_length)
    for k, axis in enumerate(AXES):
        offset = list(right.offset)
        offset[k] += _OFF
        yield f"{machine.work_offset} is {_OFF:g} off in {axis}", replace(right, offset=tuple(offset))
    yield "a frame turns", replace(right, turned=(0.0, 0.0, 1.0))
    if asks_units:
        yield "a frame mirrors", replace(right, mirrored=(1.0, 0.0, 0.0))
        yield "a frame scales", replace(right, scaled=(1.0, 1.001, 1.0))
        yield "the control's basic system is inch", replace(right, metric=False)
        control = machine.control
        per_mm, per_degree = control.increments_per_mm, control.increments_per_degree
        yield "the control has fewer increments per mm", replace(right, increments=(per_mm / 10, 1e9))
        yield "the control has fewer increments per degree", replace(right, increments=(1e9, per_degree / 10))
    yield "another tool is in the spindle", replace(right, spindle_tool=lambda wanted: f"NOT_{wanted}")
    off = 2.0 if machine.z_reference == "tip" else _OFF
    wrong = replace(right, tool_length=right.tool_length + off, probe_length=right.probe_length + off)
    yield "length 1 of the tool in the table is wrong", wrong
