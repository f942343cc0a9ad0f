"""Face hobbing programs of cutters with few and with many blade groups, of both hands, milled from their text."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from gearmath.machine.control.executor import execute
from gearmath.machine.milling.mill import mill_member
from gearmath.machine.planning.cut_plan import CuttingJob
from gearmath.machine.writing.cutting import cutting_program
from gearmath.specs.bevel_set import MEMBERS, BevelSet
from gearmath.specs.milling_machine import MillingMachine
from tests.gearmath.machine.milling.flank_borders import left_at_borders

TOLERANCE = 5e-4  # mm


@pytest.mark.parametrize("name", MEMBERS)
@pytest.mark.parametrize(("groups", "radius", "hand"), [(5, 88.0, "right"), (17, 105.0, "left")])
def test_flanks_of_all_spaces_keep_the_tolerance(
    pair: Callable[..., BevelSet], vertical: MillingMachine, groups: int, radius: float, hand: str, name: str
) -> None:
    gear_set = pair(blade_groups=groups, cutter_radius=radius, hand=hand)
    member = gear_set.member(name)
    text = cutting_program(gear_set, name, vertical, "HOB", CuttingJob(range(member.teeth), TOLERANCE))
    path = execute(text, "HOB.MPF")
    deviation = mill_member(path, member, vertical).deviation
    assert len(deviation) == 2 * (45 + member.teeth - 1)
    assert np.abs(deviation).max() <= TOLERANCE
    assert 0.7 * TOLERANCE <= left_at_borders(path, member, vertical).max() <= TOLERANCE
