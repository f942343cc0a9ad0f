"""What a probing or calibration program will offer, found by running its text: every point, and where it is."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from gearmath.control.linuxcnc_plan import touches_of
from gearmath.control.parts import stretches_of
from gearmath.errors import InputError
from gearmath.machine.control.executor import run_program
from gearmath.machine.control.state import Probe, Setup
from gearmath.machine.control.text import is_for_linuxcnc
from gearmath.machine.measuring.collision_check import enough_steps, is_touch
from gearmath.specs.touch_csv import CALIBRATION_COLUMNS, COLUMNS

_FIRST, _LAST = 90, 91
#: R90 and R91 of a whole program.
WHOLE = (0, 0)
_POSITION = ("X", "Y", "Z", "A", "B", "triggered")


@dataclass(frozen=True)
class RunPlan:
    """The touches of a program: columns of its file, and for each point the cells that say where it is."""

    columns: tuple[str, ...]
    points: dict[int, tuple[str, ...]]


def triggers(start: np.ndarray, end: np.ndarray) -> np.ndarray | None:
    """A probe that triggers at the end of every touch."""
    return end if is_touch(start, end) else None


def planned(text: str, program: str, setup: Setup, first: int = 0, last: int = 0, probe: Probe = triggers) -> RunPlan:
    """The plan of the parts from R90 = ``first`` to R91 = ``last`` (0, 0: all).

    A calibration program works out later ways from its first touches: it needs the artefacts as ``probe``. Raises
    InputError for a text that cannot be run, that makes no touches, or that refuses these parts.
    """
    if is_for_linuxcnc(text):
        return RunPlan(*touches_of(text, program, first, last))
    run = run_program(
        text,
        program,
        probe,
        parameters={_FIRST: float(first), _LAST: float(last)},
        step_limit=enough_steps(text),
        setup=setup,
    )
    if run.alarm is not None:
        why = f": {run.messages[-1]}" if run.messages else ""
        raise InputError(f"{program}, line {run.alarm[1]}: the program sets alarm {run.alarm[0]}{why}")
    for content in run.files.values():
        lines = [line.split(",") for line in content.splitlines() if line and not line.startswith("#")]
        if lines and tuple(lines[0]) in (COLUMNS, CALIBRATION_COLUMNS):
            columns = tuple(lines[0])
            points = {int(cells[1]): tuple(cells[2 : -len(_POSITION)]) for cells in lines[1:]}
            if points:
                return RunPlan(columns, points)
    raise InputError(f"{program}: offers no touches to a host: is it a program of 'nc probe' or 'nc calibrate'?")


def choosing(
    text: str, program: str, setup: Setup, plan: RunPlan, wanted: list[int], probe: Probe = triggers
) -> tuple[RunPlan, list[tuple[int, int]]]:
    """Of the whole ``plan`` the points that are wanted and as few others as the program can, and R90 and R91 of each
    start of it."""
    if list(plan.points) != wanted:
        stretches = stretches_of(plan.points, text, wanted)
        made: dict[int, tuple[str, ...]] = {}
        for low, high in stretches:
            made |= planned(text, program, setup, low, high, probe).points
        if set(wanted) <= made.keys():
            return RunPlan(plan.columns, made), stretches
    return plan, [WHOLE]
