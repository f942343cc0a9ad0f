"""Where a program goes on: its text, run on the machine model from R90 to R91, makes the points that are missing."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from gearmath.control.interface import RunStart, Touch
from gearmath.control.store import MeasurementStore
from gearmath.control.store_summary import parts
from gearmath.machine.control.executor import run_program
from gearmath.machine.control.state import Probe, Setup
from gearmath.machine.measuring.artefacts import Artefacts
from gearmath.machine.measuring.collision_check import enough_steps, is_touch
from gearmath.machine.writing.axis_cycle import axis_program
from gearmath.machine.writing.calibrating import calibration_program
from gearmath.machine.writing.probing import probing_program
from gearmath.specs.bevel_set import BevelSet
from gearmath.specs.calibration import load_calibration
from gearmath.specs.milling_machine import MillingMachine
from gearmath.specs.toml import bundled
from gearmath.specs.touch_csv import CALIBRATION_COLUMNS, COLUMNS

KINDS = ["member, each point three times", "ring and sphere", "sphere on the work side"]


def touched(text: str, probe: Probe, setup: Setup, first: int = 0, last: int = 0) -> list[list[str]]:
    """The touches that a program writes when R90 and R91 say which parts it makes."""
    done = run_program(
        text, "PROBE.MPF", probe, parameters={90: first, 91: last}, step_limit=enough_steps(text), setup=setup
    )
    (written,) = done.files.values()
    return [line.split(",") for line in written.splitlines() if line[:1].isdigit()]


def _at_its_end(start: np.ndarray, end: np.ndarray) -> np.ndarray | None:
    """A probe that triggers where a touch ends."""
    return end if is_touch(start, end) else None


@pytest.mark.parametrize("kind", KINDS)
def test_a_run_goes_on_with_the_part_of_its_first_missing_point(
    tmp_path: Path, gear_set: BevelSet, vertical: MillingMachine, kind: str
) -> None:
    known = load_calibration(bundled("probe.toml"))
    setup = Setup.of(vertical, known.length)
    probe: Probe = Artefacts(vertical, known)
    if kind == KINDS[0]:
        text = probing_program(gear_set, "pinion", vertical, known, "PROBE", topography=(), repeat=3)
        probe = _at_its_end
    else:
        text = (calibration_program if kind == KINDS[1] else axis_program)(vertical, known, "PROBE")
    columns = COLUMNS if kind == KINDS[0] else CALIBRATION_COLUMNS
    points = {int(row[1]): tuple(row[2:-6]) for row in touched(text, probe, setup)}
    for kept in (len(points) // 3, len(points) - 1):
        with MeasurementStore.open(tmp_path / f"{kept}.db") as store:
            run = store.begin_run(RunStart("sim", "PROBE.MPF", text.encode(), columns, points))
            for point in list(points)[:kept]:
                run.commit_touch(point, Touch(1, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0))
            missing = run.missing()
            ((first, last),) = parts(run, missing)
        made = [int(row[1]) for row in touched(text, probe, setup, first, last)]
        assert made[-len(missing) :] == missing
        # a part later would leave out the first one
        if first < last:
            assert missing[0] not in [int(row[1]) for row in touched(text, probe, setup, first + 1, last)]
