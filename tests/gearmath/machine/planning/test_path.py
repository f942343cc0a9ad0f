"""The way of the cutter: which tool cuts what, from where to where it rolls, and how finely it is divided."""

from __future__ import annotations

import numpy as np
import pytest

from gearmath.bevel.flank import blank_grid, solve_places
from gearmath.errors import InputError
from gearmath.machine.planning.path import Cut, axis_positions, roll_range, whole_flank, within_travel
from gearmath.specs.bevel_set import MEMBERS, SIDES

HEIGHT = 500.0
each_cut = pytest.mark.parametrize(("member", "number"), [("pinion", 0), ("pinion", 1), ("gear", 0)])


def the_cut(gear_set, member, number):
    return Cut.of(gear_set.member(member))[number]


def test_fixed_settings_have_a_tool_for_each_flank_and_a_completing_cut_has_one_for_both(gear_set):
    assert [(cut.tool, cut.flanks) for cut in Cut.of(gear_set.pinion)] == [
        ("PINION_CONCAVE", ("concave",)),
        ("PINION_CONVEX", ("convex",)),
    ]
    assert [(cut.tool, cut.flanks) for cut in Cut.of(gear_set.gear)] == [("GEAR", ("concave", "convex"))]


@each_cut
def test_roll_reaches_past_the_contact_of_every_point_of_the_flank(gear_set, member, number):
    """On a grid finer than the one that the range is made from, tip, root, toe and heel included."""
    spec, cut = gear_set.member(member), the_cut(gear_set, member, number)
    start, end = roll_range(spec, cut)
    grid = blank_grid(spec, 21, 41, 0.0)
    for flank in cut.flanks:
        points, _ = solve_places(spec.flank(flank).vector, SIDES[flank], grid.axial.ravel(), grid.radial.ravel())
        assert start < points.contact[:, 2].min() - np.radians(1.5)
        assert end > points.contact[:, 2].max() + np.radians(1.5)


@pytest.mark.parametrize("member", MEMBERS)
def test_whole_flank_reaches_from_the_lower_limit_to_the_tip(gear_set, member):
    spec = gear_set.member(member)
    for cut in Cut.of(spec):
        for flank in cut.flanks:
            points = whole_flank(spec, flank)
            grid = blank_grid(spec, 2, 2, 0.0)
            assert points.point[:, 2].min() == pytest.approx(grid.axial.min(), abs=1e-8)
            assert points.point[:, 2].max() == pytest.approx(grid.axial.max(), abs=1e-8)


def test_axis_positions_are_those_of_the_conventions(gear_set, witness):
    theta = np.linspace(-0.3, 0.3, 7)
    axes = axis_positions(gear_set.gear.concave, theta, HEIGHT)
    expected = witness.vertical_axes(gear_set.gear.concave.vector, theta, HEIGHT)
    expected[:, 3] = np.unwrap(expected[:, 3])
    np.testing.assert_allclose(axes, expected, rtol=0, atol=1e-11)


def counting(vertical, low, high):
    """The machine with an axis A that counts from ``low`` to ``high`` degrees."""
    A = vertical.axes.A.model_copy(update={"modulo": False, "travel": (low, high)})
    return vertical.model_copy(update={"axes": vertical.axes.model_copy(update={"A": A})})


def test_a_counting_axis_starts_in_the_turn_that_keeps_it_within_travel(gear_set, vertical):
    theta = np.linspace(-0.2, 0.2, 9)
    axes = axis_positions(gear_set.gear.concave, theta, HEIGHT)
    assert (np.degrees(axes[:, 3]) < 100).all()
    moved = within_travel(axes, theta, counting(vertical, 500.0, 1000.0), "gear")
    turns = (moved[:, 3] - axes[:, 3]) / (2 * np.pi)
    np.testing.assert_allclose(turns, np.ceil((500 - np.degrees(axes[:, 3].min())) / 360), atol=1e-12)
    np.testing.assert_array_equal(moved[:, [0, 1, 2, 4]], axes[:, [0, 1, 2, 4]])
    with pytest.raises(InputError, match=r"^gear: axis A = .* degrees at cradle angle .* deg: .* travels 0 to 5 degr"):
        within_travel(axes, theta, counting(vertical, 0.0, 5.0), "gear")


def test_out_of_travel_is_refused_with_the_cradle_angle_where_it_happens(gear_set, vertical):
    """X rises with the cradle here: the first rotation beyond the limit is named."""
    theta = np.radians([-10.0, -5.0, 0.0, 5.0])
    axes = axis_positions(gear_set.gear.concave, theta, HEIGHT)
    short = vertical.axes.X.model_copy(update={"travel": (-400.0, float(axes[1:3, 0].mean()))})
    machine = vertical.model_copy(update={"axes": vertical.axes.model_copy(update={"X": short})})
    assert (np.diff(axes[:, 0]) > 0).all()
    with pytest.raises(InputError, match=rf"^gear: axis X = {axes[2, 0]:.5f} mm at cradle angle 0\.000 deg: "):
        within_travel(axes, theta, machine, "gear")
