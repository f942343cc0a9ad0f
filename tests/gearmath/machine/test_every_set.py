"""Every bundled set that has programs, cut in one space from the text of its program on a machine without errors."""

from __future__ import annotations

import numpy as np
import pytest

from gearmath.machine.cutting import Job, cutting_program
from gearmath.machine.executor import execute
from gearmath.machine.mill import mill_member
from gearmath.specs.bevel_set import FLANKS, MEMBERS, load_bevel_set
from gearmath.specs.milling_machine import MillingMachine
from gearmath.specs.toml import bundled

SETS = ("nasa_tp3096_12x36", "crown_gear_7x43", "crown_gear_formate_14x39", "crown_gear_universal_14x39")


@pytest.mark.slow
@pytest.mark.parametrize("name", MEMBERS)
@pytest.mark.parametrize("gear_set", SETS)
def test_program_of_a_tenth_of_a_micrometre_keeps_it(gear_set: str, name: str, vertical: MillingMachine) -> None:
    bevel_set = load_bevel_set(bundled(f"{gear_set}.toml"))
    text = cutting_program(bevel_set, name, vertical, "EVERY_SET", Job(tolerance=1e-4))
    measured = mill_member(execute(text, "EVERY_SET.MPF"), bevel_set.member(name), name, vertical)
    for flank in FLANKS:
        deviation = measured.select(flank).deviation
        assert len(deviation) == 45
        assert np.abs(deviation).max() <= 1e-4  # mm
