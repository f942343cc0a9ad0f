"""Cutting programs for LinuxCNC, run by LinuxCNC's own interpreter."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pytest

from gearmath.machine.control.executor import execute
from gearmath.machine.control.state import Setup
from gearmath.machine.planning.cut_plan import CuttingJob, CuttingPlan, cutting_plan
from gearmath.machine.writing import cutting
from gearmath.machine.writing.linuxcnc.cutting import program_of, tools_of
from gearmath.specs.bevel_set import load_bevel_set
from gearmath.specs.milling_machine import MillingMachine, load_milling_machine
from gearmath.specs.toml import bundled

if TYPE_CHECKING:
    from conftest import Interpreter

INCH = 25.4
#: The interpreter counts in inches: a position in mm goes through two roundings of doubles.
ROUNDING = 1e-9
SETS = [
    (gear_set, name)
    for gear_set in (
        "nasa_tp3096_12x36",
        "spiral_7x43",
        "crown_gear_formate_14x39",
        "crown_gear_hobbed_14x39",
        "crown_gear_universal_14x39",
    )
    for name in ("pinion", "gear")
]


@pytest.fixture(scope="module")
def machine() -> MillingMachine:
    return load_milling_machine(bundled("vertical_5axis.toml"))


def plan_of(gear_set: str, name: str, machine: MillingMachine) -> CuttingPlan:
    bevel_set = load_bevel_set(bundled(f"{gear_set}.toml"))
    member = bevel_set.member(name)
    spaces = range(member.teeth) if member.process == "face_hobbing" else (0, 1, member.teeth - 1)
    tolerance = 0.001 if member.process == "face_hobbing" else CuttingJob.tolerance
    return cutting_plan(bevel_set, name, machine, CuttingJob(spaces, tolerance))


@pytest.mark.parametrize(("gear_set", "name"), SETS)
def test_the_interpreter_of_linuxcnc_reads_the_positions_and_times_that_our_reader_reads(
    gear_set: str, name: str, machine: MillingMachine, interpreted: Interpreter
) -> None:
    plan = plan_of(gear_set, name, machine)
    ours = execute(cutting.program_of(plan, "CUT"), "CUT", Setup.of(machine))
    text = program_of(plan, "CUT")
    theirs = interpreted(text, dict(tools_of(plan).values()))
    assert theirs.error == ""
    read = execute(text, "CUT", Setup.of(machine))  # by our reader of this dialect, which knows where A has turned to
    known = np.searchsorted(theirs.line, read.line)
    np.testing.assert_array_equal(theirs.line[known], read.line)
    np.testing.assert_allclose(theirs.position[known, :3], read.axes[:, :3], rtol=0, atol=ROUNDING)
    np.testing.assert_allclose(theirs.position[known, 3:5], np.degrees(read.axes[:, 3:]), rtol=0, atol=ROUNDING)
    # at home our reader does not know where the axes stand after a tool change
    here, there = theirs.position[:, 2] != machine.home, ours.axes[:, 2] != machine.home
    rapid, position = np.array(theirs.kind)[here] == "rapid", theirs.position[here]
    np.testing.assert_array_equal(rapid, ours.rapid[there])
    np.testing.assert_allclose(position[:, :3], ours.axes[there, :3], rtol=0, atol=ROUNDING)
    turned = position[:, 3:5] - np.degrees(ours.axes[there, 3:])
    np.testing.assert_allclose(turned[:, 0], 360 * np.round(turned[:, 0] / 360), rtol=0, atol=ROUNDING)
    np.testing.assert_allclose(turned[:, 1], 0, rtol=0, atol=ROUNDING)
    if plan.member.process == "face_hobbing":
        known = np.isfinite(ours.cutter[there])
        assert known.any()
        turned = position[known, 5] - np.degrees(ours.cutter[there][known])
        np.testing.assert_allclose(turned, 360 * np.round(turned / 360), rtol=0, atol=ROUNDING)
    # inverse time: the interpreter makes of F the speed of X Y Z along the block [inch/min]
    way = np.linalg.norm(np.diff(position[:, :3], axis=0), axis=1)
    timed = ours.seconds[there][1:] > 0.0
    speed = theirs.feed[here][1:][timed] * INCH / 60
    np.testing.assert_allclose(speed, way[timed] / ours.seconds[there][1:][timed], rtol=1e-6)
