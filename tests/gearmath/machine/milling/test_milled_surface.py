"""The metal of a whole member out of a flank file: polynomials come back, and teeth without a grid are turned."""

from __future__ import annotations

import math

import numpy as np
import pytest

from gearmath.bevel.flank import blank_grid
from gearmath.bevel.nominal_file import nominal_flank
from gearmath.errors import InputError
from gearmath.machine.control.executor import run_program
from gearmath.machine.measuring.probe import ProbeMachine
from gearmath.machine.milling.milled_surface import MilledSurface
from gearmath.machine.planning.targets import landmarks
from gearmath.machine.writing.probing import probing_program
from gearmath.quality.evaluation.touches import measured_member
from gearmath.specs.bevel_set import FLANKS
from gearmath.specs.calibration import load_calibration
from gearmath.specs.flank_csv import flank_file, join
from gearmath.specs.milling_machine import load_milling_machine
from gearmath.specs.toml import bundled
from gearmath.specs.touch_csv import read_touch_csv

MACHINE = load_milling_machine(bundled("vertical_5axis.toml"))
PROBE = load_calibration(bundled("probe.toml"))
#: Turn of every space of the pinion [rad], none in space 0; and the form of its flanks, in parts of the grid [mm].
TURN = np.append(0.0, np.random.default_rng(5).normal(0.0, 3e-4, 11))


def form(flank, up, along):
    """A cubic that no rotation makes, up to 40 um: up and along from -1 to 1."""
    sign = 1.0 if flank == "concave" else -1.0
    return 1e-3 * (sign * 12.0 * up**2 + 15.0 * up * along - 8.0 * along**2 + 5.0 * along**3 - 4.0)


def of_form(member, flank, tooth, keep, shape=(5, 9)):
    """Points of one flank of one tooth: the form, and the turn of the space by its lever, written out here."""
    one = nominal_flank(member, flank, blank_grid(member, *shape), tooth=tooth)
    lever = one.point[:, 0] * one.normal[:, 1] - one.point[:, 1] * one.normal[:, 0]
    up, along = 2 * one.row / (shape[0] - 1) - 1, 2 * one.col / (shape[1] - 1) - 1
    found = form(flank, up, along) + TURN[tooth] * lever
    return flank_file(
        one.header,
        "pinion",
        flank,
        tooth,
        one.row[keep],
        one.col[keep],
        (one.point + found[:, None] * one.normal)[keep],
        one.normal[keep],
        found[keep],
    )


def whole(member, shape=(5, 9)):
    """As ``mill`` writes: tooth 0 in full, the reference point of all others."""
    row, col = (index.ravel() for index in np.indices(shape))
    middle = landmarks(row, col, shape, corners=False)
    return join([of_form(member, flank, k, middle | (k == 0), shape) for flank in FLANKS for k in range(12)])


def test_probing_a_milled_member_finds_its_form_and_its_pitch(gear_set, tmp_path):
    """Grid of tooth 0, corners of teeth 3 and 7 that the file does not have, tooth 0 again: all within 10 nm."""
    member = gear_set.pinion
    metal = MilledSurface(whole(member), member, "m.csv")
    text = probing_program(gear_set, "pinion", MACHINE, PROBE, "PP", around=(3, 7))
    done = run_program(text, "P.MPF", ProbeMachine(member, MACHINE, PROBE, metal, metal.lowest))
    assert done.alarm is None
    (tmp_path / "raw.csv").write_text(done.files["PP_T"])
    seen = measured_member(read_touch_csv(tmp_path / "raw.csv"), member, MACHINE, PROBE)
    assert len(seen) == 2 * (45 + 11 + 2 * 4 + 5)
    assert np.ptp(seen.deviation) > 0.05  # more than the body of the probe machine is good to
    for flank in FLANKS:
        for tooth in range(13):
            here, all_ = seen.select(flank, tooth), np.ones(45, dtype=bool)
            expected = of_form(member, flank, tooth % 12, all_).deviation[here.row * 9 + here.col]
            # 2 nm of the slope that is left out, and what a turn of 1e-3 does beyond its first order
            np.testing.assert_allclose(here.deviation, expected, rtol=0, atol=1e-5)


@pytest.mark.parametrize("shape", [(5, 9), (9, 13), (7, 5)])
def test_cubic_form_comes_back_between_the_points_of_every_grid(gear_set, shape):
    """Cubic splines with their ends free have a cubic exactly; the reference point of another grid is another one."""
    member = gear_set.pinion
    metal = MilledSurface(whole(member, shape), member, "m.csv")
    fine = blank_grid(member, 17, 25)
    for flank in FLANKS:
        for row, col in ((0, 0), (3, 7), (8, 12), (13, 1), (16, 24)):
            place = np.array([fine.axial[row, col], fine.radial[row, col]])
            assert metal(flank, 0, place) == pytest.approx(form(flank, row / 8 - 1, col / 12 - 1), abs=1e-9)


def test_points_of_a_tooth_that_is_not_in_full_come_back(gear_set):
    """Reference point and corners of tooth 5, the corners 7 um off the form: they are kept, not averaged."""
    member = gear_set.pinion
    row, col = (index.ravel() for index in np.indices((5, 9)))
    marked = landmarks(row, col, (5, 9), corners=True)
    file = whole(member)
    own = of_form(member, "convex", 5, marked)
    off = 0.007 * ((own.row == 4) & (own.col == 0))
    moved = flank_file(
        own.header,
        "pinion",
        "convex",
        5,
        own.row,
        own.col,
        own.point + off[:, None] * own.normal,
        own.normal,
        own.deviation + off,
    )
    metal = MilledSurface(join([file.pick((file.tooth != 5) | (file.flank != "convex")), moved]), member, "m")
    grid = blank_grid(member)
    for k in range(len(moved)):
        place = np.array([grid.axial[moved.row[k], moved.col[k]], grid.radial[moved.row[k], moved.col[k]]])
        assert metal("convex", 5, place) == pytest.approx(moved.deviation[k], abs=1e-9)


def test_tooth_that_the_file_does_not_have_is_named(gear_set):
    member = gear_set.pinion
    file = whole(member)
    metal = MilledSurface(file.pick(file.tooth != 4), member, "m.csv")
    with pytest.raises(InputError, match=r"m\.csv: holds no deviation on the convex flank of tooth 4"):
        metal("convex", 4, np.array([60.0, 20.0]))
    assert math.isclose(metal.lowest, file.deviation[file.tooth != 4].min())
