"""One tooth space cut by the realtime controller of LinuxCNC, milled from what it commands every millisecond."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
import pytest

from gearmath.machine.control.executor import MachinePath, execute
from gearmath.machine.control.state import Setup
from gearmath.machine.milling.mill import mill_member
from gearmath.machine.planning.cut_plan import cutting_plan
from gearmath.machine.planning.rounding import path_share
from gearmath.machine.writing import cutting
from gearmath.machine.writing.linuxcnc.cutting import LEFT_BY, path_share_of, program_of, tools_of, turned_at_corners
from gearmath.specs.bevel_set import load_bevel_set
from gearmath.specs.milling_machine import MillingMachine, load_milling_machine
from gearmath.specs.toml import bundled
from tests.gearmath.control.linuxcnc.samples import farthest

if TYPE_CHECKING:
    from conftest import Start

#: halsampler prints six decimals: half of the last one in X Y Z, and in A at 100 mm from the axis. [mm]
PRINTED = 0.5e-6 * np.sqrt(3) + 100.0 * np.radians(0.5e-6)


def sampled(rows: np.ndarray, lines: range, commanded: MachinePath) -> MachinePath:
    """The positions in these lines of a program as a path of many short blocks, with its first block before them."""
    cut = rows[np.isin(rows[:, 6].astype(int), lines)]
    axes = np.vstack([commanded.axes[:1], np.column_stack([cut[:, 1:4], np.radians(cut[:, 4:6])])])
    n = len(axes)
    return replace(
        commanded,
        axes=axes,
        rapid=np.arange(n) == 0,
        tool=np.zeros(n, dtype=int),
        line=np.append(0, cut[:, 6]).astype(int),
        seconds=np.append(0.0, np.full(n - 1, 1e-3)),
        rpm=np.full(n, 120.0),
        measuring=np.zeros(n, dtype=bool),
        inner=np.zeros(n, dtype=bool),
        cutter=np.full(n, np.nan),
        coolant=np.ones(n, dtype=bool),
    )


@pytest.mark.slow
def test_the_flanks_are_within_the_tolerance_of_the_path_mode(live: Start) -> None:
    machine: MillingMachine = load_milling_machine(bundled("vertical_5axis.toml"))
    bevel_set = load_bevel_set(bundled("nasa_tp3096_12x36.toml"))
    gear = bevel_set.member("gear")
    plan = cutting_plan(bevel_set, "gear", machine)
    text = program_of(plan, "SPACE")
    control = live("SPACE", text, machine, tools_of(plan))
    control.start()
    ended = control.wait("ended", 600)
    control.leave()
    assert ended["heard"] == ["section 1 of 1: space 0 concave and convex"]

    rows = np.loadtxt(control.folder / "samples.txt")
    assert (np.diff(rows[:, 0]) == 1).all()  # no servo cycle is missing
    blocks = text.splitlines()
    cut = [k for k, line in enumerate(blocks, 1) if line.startswith("G1 X")]
    commanded = execute(cutting.program_of(plan, "SPACE"), "SPACE", Setup.of(machine))
    here = sampled(rows, range(cut[0], cut[-1] + 1), commanded)
    assert len(here.axes) > 1000 * plan.seconds

    linear, _ = machine.control.path_tolerance
    allowed = path_share(gear, machine, linear, turned_at_corners(plan.passes, linear))
    left = mill_member(here, gear, machine).deviation
    meant = mill_member(commanded, gear, machine).deviation
    assert np.abs(left - meant).max() < allowed + PRINTED
    assert np.abs(left).max() < plan.job.tolerance + allowed + PRINTED
    # the header states what corners that are left farther than P would do
    assert path_share_of(plan) == pytest.approx(LEFT_BY * allowed)
    ends = np.array([[float(word[1:]) for word in blocks[k - 1].split()[1:6]] for k in cut])
    of_roll = np.isin(rows[:, 6].astype(int), cut[2:])
    assert linear < farthest(rows[of_roll, 1:6], ends) < LEFT_BY * linear
