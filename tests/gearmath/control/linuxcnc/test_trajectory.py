"""The time that the model says a roll takes, and the time that LinuxCNC's own controller takes for it."""

from __future__ import annotations

import re
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import pytest

from gearmath.machine.judging.look_ahead import RoundedCorners
from gearmath.machine.judging.parabolic import follow_parabolic
from gearmath.machine.planning.cut_plan import CuttingJob, cutting_plan
from gearmath.specs.bevel_set import load_bevel_set
from gearmath.specs.milling_machine import UNITS_PER_INTERNAL, load_milling_machine
from gearmath.specs.toml import bundled
from tests.gearmath.control.linuxcnc.samples import farthest

if TYPE_CHECKING:
    from conftest import Start

#: Tolerance of the blocks [mm] and feed at the tooth [mm/min] of the rows of the table, and the tolerance of G64 [mm],
#: 0 for G61, as rolls one behind the other. The last two are not in the table.
ROLLS = (
    (1e-4, 300.0, 1e-4),
    (1e-4, 3000.0, 1e-4),
    (1e-3, 300.0, 1e-3),
    (1e-3, 3000.0, 1e-3),
    (1e-4, 3000.0, 1e-3),
    (1e-4, 3000.0, 0.0),
)
PAGE = Path(__file__).parents[4] / "docs" / "programs.md"


def table() -> list[tuple[float, ...]]:
    """Tolerance [mm], feed, and the last three columns of G1: times of LinuxCNC and of its model, path error."""
    found, tolerance = [], 0.0
    for line in PAGE.read_text("utf-8").splitlines():
        row = [cell.strip() for cell in line.strip("|").split("|")]
        if len(row) == 11 and row[2] == "G1":
            tolerance = float(re.match(r"[\d.]+", row[0])[0]) / 1000
            found.append((tolerance, *(float(row[k]) for k in (1, 8, 9, 10))))
    return found


@pytest.mark.slow
def test_the_model_takes_as_long_for_a_roll_as_linuxcnc_does_and_the_table_has_both(live: Start) -> None:
    machine, bevel_set = (
        load_milling_machine(bundled("vertical_5axis.toml")),
        load_bevel_set(bundled("nasa_tp3096_12x36.toml")),
    )
    lines = ["G21 G90 G17 G40 G94 F100", "G61"]
    expected, first, ends, rounded = [], [], [], []
    for blocks, feed, tolerance in ROLLS:
        roll = cutting_plan(bevel_set, "pinion", machine, CuttingJob((0,), blocks, feed)).passes[0]
        at = roll.axes * UNITS_PER_INTERNAL
        ends.append(np.round(at, 6))
        words = [" ".join(f"{axis}{value:.6f}" for axis, value in zip("XYZAB", row, strict=True)) for row in at]
        lines += ["G61", f"G0 {words[0]}", f"G64 P{tolerance:.6f}" if tolerance else "G61", "G93"]
        first.append(len(lines) + 1)
        lines += [f"G1 {word} F{60.0 / seconds:.6f}" for word, seconds in zip(words[1:], roll.seconds, strict=True)]
        lines += ["G94 F100"]
        run = follow_parabolic(roll.axes, roll.seconds, machine.limits(5), RoundedCorners(tolerance, tolerance))
        expected.append(float(run.seconds.sum()))
        rounded.append(1e3 * float(run.rounded.max(initial=0.0)))
    control = live("ROLLS", "\n".join([*lines, "M2"]) + "\n", machine, {})
    control.start()
    ended = control.wait("ended", 240)
    control.leave()
    assert ended["heard"] == []
    rows = np.loadtxt(control.folder / "samples.txt")
    taken, apart = [], []
    for (begin, end), blocks in zip(pairwise([*first, len(lines) + 1]), ends, strict=True):
        here = np.isin(rows[:, 6].astype(int), range(begin, end - 4 if end <= len(lines) else end))
        moving = np.append(False, np.abs(np.diff(rows[:, 1:6], axis=0)).any(axis=1)) & here
        taken.append(1e-3 * np.ptp(np.flatnonzero(moving)))
        apart.append(1e3 * farthest(rows[moving, 1:6][1:], blocks))  # the first way is the last of the approach
    print(list(zip(ROLLS, taken, expected, apart, strict=True)))
    for seconds, measured in zip(expected, taken, strict=True):
        assert seconds == pytest.approx(measured, rel=0.05)
    rows_of_table = table()
    assert [row[:2] for row in rows_of_table] == [roll[:2] for roll in ROLLS[:4]]
    for (*_, in_linuxcnc, in_model, off), *measured in zip(rows_of_table, taken, expected, apart, strict=False):
        assert [in_linuxcnc, in_model, off] == pytest.approx(measured, rel=0.02)
    # the corner before the last block is left by 1.37 P: twice the acceleration behind it
    assert rounded[:-1] == pytest.approx(apart[:-1], rel=0.03)
    assert apart[-1] < 0.01  # exact stop: nothing but the digits of the samples
