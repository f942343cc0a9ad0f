"""The metal at the places of a measurement: as that of the virtual milling, which exposes all to all passes."""

from __future__ import annotations

import numpy as np
import pytest

from gearmath.errors import InputError
from gearmath.machine.milling.metal import metal
from gearmath.machine.milling.mill import mill_member
from gearmath.specs.bevel_set import FLANKS, load_bevel_set
from gearmath.specs.simulated_machine import AxisErrors, Probe, load_simulated_machine
from gearmath.specs.toml import bundled

SET = load_bevel_set(bundled("spiral_7x43.toml"))
#: Errors of settings and index; without the ball screw, which would divide the blocks into many.
SHOP = load_simulated_machine(bundled("source_experiment.toml")).model_copy(
    update={"probe": Probe(), "axes": AxisErrors()}
)


@pytest.mark.slow
def test_metal_is_what_the_milling_leaves_at_the_same_points(program, vertical):
    path = program(SET, "pinion", range(7))
    found = metal(path, SET.pinion, vertical, SHOP, whole=(0,), around=(2, 4))
    milled = mill_member(path, SET.pinion, vertical, SHOP)
    assert len(found) == 2 * (45 + 2 * 5 + 4)
    for flank in FLANKS:
        for tooth in range(7):
            mine, theirs = found.select(flank, tooth), milled.select(flank, tooth)
            same = (mine.row == 2) & (mine.col == 4) if tooth else np.full(45, True)
            np.testing.assert_allclose(mine.deviation[same], theirs.deviation, rtol=0, atol=1e-12)
            np.testing.assert_allclose(mine.point[same], theirs.point, rtol=0, atol=1e-11)
        corners = found.select(flank, 2)
        places = list(zip(corners.row.tolist(), corners.col.tolist(), strict=True))
        assert places == [(0, 0), (0, 8), (2, 4), (4, 0), (4, 8)]
        # apart from its index error, a tooth is as the first one is
        first = found.select(flank, 0)
        shape = [first.deviation[(first.row == row) & (first.col == col)][0] for row, col in places]
        assert np.abs(np.diff(corners.deviation) - np.diff(shape)).max() < 1e-3
    with pytest.raises(InputError, match=r"the program leaves the con(cave|vex) flank of space \d uncut at row"):
        metal(program(SET, "pinion", (0,)), SET.pinion, vertical)
