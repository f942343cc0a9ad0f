"""A probing or calibration program run on the machine model: the touches that it writes, as the control would."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from gearmath.errors import ComputationError, InputError
from gearmath.machine.control.executor import AS_WRITTEN, MachinePath, ProgramRun, run_program
from gearmath.machine.control.state import Probe, Setup
from gearmath.machine.measuring.artefacts import Artefacts
from gearmath.machine.measuring.collision_check import enough_steps, is_touch
from gearmath.machine.measuring.probe_errors import ErringProbe
from gearmath.specs.calibration import Calibration
from gearmath.specs.milling_machine import MillingMachine
from gearmath.specs.simulated_machine import SimulatedMachine
from gearmath.specs.touch_csv import CALIBRATION_COLUMNS, COLUMNS

#: A probe that has triggered is free again where the axes have gone back by this. [mm]
_BACK = 1e-3
#: R102 counts the runs of a program.
_RUN_PARAMETER = 102


def writes_touches(text: str) -> bool:
    """Whether a program is one that probes: it writes touches."""
    return ",".join(COLUMNS) in text or touches_artefacts(text)


def touches_artefacts(text: str) -> bool:
    """Whether a program writes touches on ring and spheres, and not on a member."""
    return ",".join(CALIBRATION_COLUMNS) in text


def touch_count(text: str, program: str, setup: Setup = AS_WRITTEN) -> int:
    """How many touches a probing program makes, where every one of them triggers."""
    count = 0

    def trigger(start: np.ndarray, end: np.ndarray) -> np.ndarray | None:
        nonlocal count
        met = _latest(start, end)
        count += met is not None
        return met

    run_program(text, program, trigger, step_limit=enough_steps(text), setup=setup)
    return count


def probing_path(text: str, program: str, machine: MillingMachine, calibration: Calibration) -> MachinePath:
    """The path of a program that probes: on ring and spheres as they are, on a member every touch as late as it may be.

    Nothing is waited for: there is no host. Raises InputError for a text that cannot be run, ComputationError where it
    sets an alarm.
    """
    there = Artefacts(machine, calibration) if touches_artefacts(text) else _latest
    setup = Setup.of(machine, calibration.length)
    done = run_program(text, program, there, step_limit=enough_steps(text), setup=setup)
    check_ended(done, program)
    return done.path


def _latest(start: np.ndarray, end: np.ndarray) -> np.ndarray | None:
    """A probe that triggers at the very end of a touch."""
    return end if is_touch(start, end) else None


def run_touches(
    text: str,
    program: str,
    probe: Probe,
    shop: SimulatedMachine | None = None,
    touches: int | None = None,
    run: int = 1,
    progress: Callable[[int], object] = lambda blocks: None,
    setup: Setup = AS_WRITTEN,
) -> str:
    """What a program writes into its file of touches, moving ``probe``, with the errors of a shop.

    ``touches`` is how many the run has, over which the work drifts evenly; ``run`` is the number that the program
    gives to its run, and each has its own noise. ``progress`` hears of every MEAS block. Raises InputError with line
    and column for a text that cannot be run or that writes no touches, ComputationError where it sets an alarm.
    """
    erring = None if shop is None else ErringProbe(probe, shop, touches, run)
    contact: tuple[np.ndarray, np.ndarray] | None = None

    def moved(start: np.ndarray, end: np.ndarray) -> np.ndarray | None:
        nonlocal contact
        progress(1)
        met = probe(start, end) if erring is None else erring(start, end)
        contact = None if met is None else (met, end - start)
        return met

    def follow(position: np.ndarray) -> None:
        """The axes have moved: a probe that has triggered is free again once they have gone back."""
        nonlocal contact
        if contact is not None:
            met, way = contact
            if float((position - met) @ way) < -_BACK * float(np.linalg.norm(way)):
                contact = None
        if erring is not None:
            erring.follow(position)

    done = run_program(
        text,
        program,
        moved,
        parameters={_RUN_PARAMETER: run - 1},
        step_limit=enough_steps(text),
        setup=setup,
        deflected=lambda position: contact is not None,
        moved=follow,
    )
    check_ended(done, program)
    written = [lines for lines in done.files.values() if _touches(lines)]
    if len(written) != 1:
        raise InputError(f"{program}: writes {len(written)} files of touches, must write one: is it a probing program?")
    return written[0]


def check_ended(done: ProgramRun, program: str) -> None:
    """Raise ComputationError where a run has ended with an alarm."""
    if done.alarm is not None:
        number, line = done.alarm
        why = f" ({done.messages[-1]})" if done.messages else ""
        raise ComputationError(
            f"{program}, line {line}: the run ends with alarm {number}{why}, after "
            f"{sum(len(_touches(lines)) for lines in done.files.values())} touches; nothing is written"
        )


def _touches(text: str) -> list[str]:
    """The touches in the text of a file; none where its first line is not the column line of touches."""
    head, *lines = [line for line in text.splitlines() if not line.startswith("#")] or [""]
    return lines if head in (",".join(COLUMNS), ",".join(CALIBRATION_COLUMNS)) else []
