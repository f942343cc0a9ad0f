"""Every bundled set, cut from the text of its program without errors: one space, or in face hobbing all of them."""

from __future__ import annotations

import numpy as np
import pytest

from gearmath.machine.cutting import Job, cutting_program
from gearmath.machine.executor import execute
from gearmath.machine.mill import mill_member
from gearmath.specs.bevel_set import FLANKS, MEMBERS, load_bevel_set
from gearmath.specs.milling_machine import MillingMachine
from gearmath.specs.toml import bundled

SETS = (
    "nasa_tp3096_12x36", "crown_gear_7x43", "crown_gear_formate_14x39", "crown_gear_universal_14x39",
    "crown_gear_hobbed_14x39",
)  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize("name", MEMBERS)
@pytest.mark.parametrize("gear_set", SETS)
def test_program_of_a_tenth_of_a_micrometre_keeps_it(gear_set: str, name: str, vertical: MillingMachine) -> None:
    bevel_set = load_bevel_set(bundled(f"{gear_set}.toml"))
    member = bevel_set.member(name)
    spaces = range(member.teeth if member.process == "face_hobbing" else 1)
    text = cutting_program(bevel_set, name, vertical, "EVERY_SET", Job(spaces, tolerance=1e-4))
    measured = mill_member(execute(text, "EVERY_SET.MPF"), member, name, vertical)
    for flank in FLANKS:
        deviation = measured.select(flank).deviation
        assert len(deviation) == 45 + len(spaces) - 1
        assert np.abs(deviation).max() <= 1e-4  # mm
