"""The simulated machine on real programs: what an error-free program leaves, and what it says of a wrong one."""

from __future__ import annotations

import math

import numpy as np
import pytest

from gearmath.bevel.flank import blank_grid, solve_flank
from gearmath.errors import InputError
from gearmath.kernels import kernel
from gearmath.machine.control.executor import execute
from gearmath.machine.milling.mill import mill_member
from gearmath.machine.writing.cutting import cutting_program
from gearmath.specs.bevel_set import FLANKS, MEMBERS, SETTINGS, SIDES, design_sha256


@pytest.mark.parametrize("member", MEMBERS)
def test_error_free_program_leaves_at_most_a_tenth_of_a_micrometre_on_every_flank(gear_set, mill, member):
    """Default tolerance, all spaces, read from the text: 45 points of space 0, the reference point of all others."""
    spec = gear_set.member(member)
    file = mill(gear_set, member, range(spec.teeth))
    assert np.abs(file.deviation).max() <= 1e-4  # mm
    for flank in FLANKS:
        assert len(file.select(flank, 0)) == 45
        assert sorted(set(file.select(flank).tooth.tolist())) == list(range(spec.teeth))
        assert all(len(file.select(flank, tooth)) == 1 for tooth in range(1, spec.teeth))
    assert file.header["settings_sha256"] == design_sha256(spec)


@pytest.mark.parametrize("member", MEMBERS)
def test_touched_points_lie_at_their_deviation_along_the_nominal_normal_of_their_tooth(gear_set, mill, member):
    spec = gear_set.member(member)
    file = mill(gear_set, member, (3, 1))
    assert len(file.select("concave", 3)) == 45  # the first space cut is the one with the whole grid
    here, there = file.select("convex", 3), file.select("convex", 1)
    middle = (here.row == 2) & (here.col == 4)
    turn = -2 * 2 * math.pi / spec.teeth
    c, s = math.cos(turn), math.sin(turn)
    about = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    nominal = here.point[middle] - here.deviation[middle, None] * here.normal[middle]
    np.testing.assert_allclose(
        there.point, nominal @ about.T + there.deviation[:, None] * there.normal, rtol=0, atol=1e-12
    )
    np.testing.assert_allclose(there.normal, here.normal[middle] @ about.T, rtol=0, atol=1e-12)


def test_deviation_by_straight_blocks_grows_with_the_tolerance_and_keeps_within_it(gear_set, mill):
    tolerances = np.array([1e-3, 4e-3, 1.6e-2])
    worst = np.array([np.abs(mill(gear_set, "gear", (0,), tolerance=t).deviation).max() for t in tolerances])
    assert (worst <= tolerances).all()
    assert (worst >= 0.4 * tolerances).all()
    np.testing.assert_allclose(worst[1:] / worst[:-1], 4, rtol=0.25)


@pytest.mark.parametrize("member", MEMBERS)
@pytest.mark.parametrize("flank", FLANKS)
def test_cutter_ten_micrometres_too_large_shifts_the_whole_cone_along_its_normal(
    gear_set, program, vertical, altered, nominal_settings, member, flank
):
    """By hand: the cone moves by Δr cos α along the normal, into the metal by the outer blade, out of it by the inner.

    The derivation says the same: its sensitivity of the deviation to the point radius.
    """
    spec = gear_set.member(member).flank(flank)
    larger = altered(
        gear_set, member, flank, design=nominal_settings(spec), blade_point_radius=spec.blade_point_radius + 0.01
    )
    path = program(gear_set, member)
    file = mill_member(path, larger.member(member), vertical).select(flank)
    by_hand = -SIDES[flank] * 0.01 * math.cos(math.radians(spec.blade_pressure_angle))
    np.testing.assert_allclose(file.deviation, by_hand, rtol=0, atol=1.5e-4)  # straight blocks 1e-4, second order
    nominal = solve_flank(gear_set.member(member), flank, blank_grid(gear_set.member(member)))
    (sensitivity,) = kernel("setting_sensitivity")(*nominal.contact.T, spec.vector, SIDES[flank])
    predicted = 0.01 * sensitivity[:, SETTINGS.index("blade_point_radius")]
    np.testing.assert_allclose(file.deviation, predicted, rtol=0, atol=1.5e-4)


def test_program_with_the_tool_of_the_other_member_is_refused(gear_set, program, vertical):
    path = program(gear_set, "gear")
    with pytest.raises(InputError, match=r'T="GEAR"; the pinion is cut with PINION_CONCAVE and PINION_CONVEX$'):
        mill_member(path, gear_set.pinion, vertical)


def test_program_that_leaves_a_flank_out_is_refused(gear_set, vertical):
    text = cutting_program(gear_set, "pinion", vertical, "PINION")
    first_tool = text[: text.index('T="PINION_CONVEX"')]
    before = first_tool[: first_tool.rindex(" IF (R90")]  # the tool is changed where its sections are wanted
    shortened = before[: before.rindex("\n")] + "\nM30\n"
    with pytest.raises(InputError, match=r"^the program does not cut the convex flank of the pinion$"):
        mill_member(execute(shortened, "P.MPF"), gear_set.pinion, vertical)
    with pytest.raises(InputError, match=r"^the program does not cut the concave flank of the gear$"):
        mill_member(execute("M30\n", "P.MPF"), gear_set.gear, vertical)


def test_half_a_roll_leaves_metal_on_the_end_of_the_tooth_that_it_does_not_reach(gear_set, vertical):
    lines = cutting_program(gear_set, "gear", vertical, "GEAR").split("\n")
    rolls = [k for k, line in enumerate(lines) if " G93 " in line]
    kept = [line for k, line in enumerate(lines) if k not in rolls[len(rolls) // 2 :]]
    file = mill_member(execute("\n".join(kept), "P.MPF"), gear_set.gear, vertical)
    for flank in FLANKS:
        deviation = file.select(flank).deviation.reshape(5, 9)
        assert deviation[:, 0].max() > 0.1
        assert np.abs(deviation[:, 8]).max() <= 1e-4  # the heel was cut before


def test_cutter_lifted_out_of_the_space_leaves_it_uncut(gear_set, vertical):
    text = cutting_program(gear_set, "gear", vertical, "GEAR")
    path = execute(text, "P.MPF")
    path.axes[:, 2] += 30.0
    with pytest.raises(InputError, match=r"^the program leaves the concave flank of space 0 uncut at row 0, col 0$"):
        mill_member(path, gear_set.gear, vertical)


def test_progress_counts_both_flanks_of_every_space(gear_set, program, vertical):
    counts = []
    mill_member(program(gear_set, "gear", (0, 5)), gear_set.gear, vertical, progress=counts.append)
    assert sum(counts) == 4


def test_probe_noise_is_seeded_has_its_size_and_moves_the_touched_points(gear_set, program, vertical, shop):
    probe_only = shop.model_copy(update={"pinion": type(shop.pinion)(), "work_axis": type(shop.work_axis)()})
    path = program(gear_set, "pinion", range(12))
    true = mill_member(path, gear_set.pinion, vertical)
    seen, again = (mill_member(path, gear_set.pinion, vertical, probe_only) for _ in range(2))
    np.testing.assert_array_equal(seen.deviation, again.deviation)
    noise = seen.deviation - true.deviation
    assert np.std(noise) == pytest.approx(5e-4, rel=0.25)  # 112 points of sigma 0.5 µm
    np.testing.assert_allclose(seen.point, true.point + noise[:, None] * true.normal, rtol=0, atol=1e-12)
    np.testing.assert_array_equal(seen.uncertainty, 5e-4)
