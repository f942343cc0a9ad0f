"""A program rounded as the control rounds it: the flanks deviate by no more than its header says, and not much less."""

from __future__ import annotations

import re

import numpy as np
import pytest

from gearmath.machine.control.executor import execute
from gearmath.machine.control.state import Setup
from gearmath.machine.milling.mill import mill_member
from gearmath.machine.planning.cut_plan import CuttingJob
from gearmath.machine.writing.cutting import cutting_program
from gearmath.specs.control import ControlSettings

#: Of the program that is rounded: its own decimals do not count.
FINE = ControlSettings(increments_per_mm=1_000_000, increments_per_degree=1_000_000)


def rounded(text, step):
    """The program as a control with increments of ``step`` runs it: every axis word of every block rounded."""
    decimals = len(f"{step:f}".rstrip("0").split(".")[1])

    def word(found):
        return f"{found[1]}{round(float(found[2]) / step) * step:.{decimals}f}"

    return "\n".join(
        line if line.startswith(";") else re.sub(r"((?<= )[XYZB]|A=DC\()(-?\d+\.\d+)", word, line)
        for line in text.split("\n")
    )


@pytest.mark.parametrize(
    ("increments", "least", "most"), [(1000, 1.2, 1.75), (10_000, 0.12, 0.175), (100_000, 0.012, 0.0175)]
)
def test_rounding_takes_from_a_third_to_all_of_what_the_header_states(gear_set, vertical, increments, least, most):
    """``least`` and ``most`` [um] bound it by hand: half an increment of mm and of degrees in all axes."""
    spec = gear_set.gear
    coarse = vertical.model_copy(
        update={
            "control": vertical.control.model_copy(
                update={"increments_per_mm": increments, "increments_per_degree": increments}
            )
        }
    )
    fine = vertical.model_copy(update={"control": FINE})
    head = cutting_program(gear_set, "gear", coarse, "CUT", CuttingJob((0,), 5e-3))
    stated = float(re.search(r"increments per mm and .*: up to ([0-9.]+) um", head)[1])
    assert least <= stated <= most
    text = cutting_program(gear_set, "gear", fine, "CUT", CuttingJob((0,), 1e-4))
    left = [
        mill_member(execute(program, "CUT", Setup.of(fine)), spec, fine).deviation * 1000
        for program in (text, rounded(text, 1.0 / increments))
    ]
    measured = float(np.abs(left[1] - left[0]).max())  # point by point, so that what straight blocks leave is no part
    print(f"{increments} per mm: {measured:.4f} um measured at {len(left[0])} points, {stated:.4f} um stated")
    assert stated / 3 <= measured <= stated
