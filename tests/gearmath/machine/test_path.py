"""The way of the cutter: which tool cuts what, from where to where it rolls, and how finely it is divided."""

from __future__ import annotations

import numpy as np
import pytest

from gearmath.bevel.flank import blank_grid, solve_places
from gearmath.errors import InputError
from gearmath.machine.path import Cut, axis_positions, chord_error, roll_nodes, roll_range, whole_flank
from gearmath.specs.bevel_set import MEMBERS, SIDES

HEIGHT = 500.0
each_cut = pytest.mark.parametrize(("member", "number"), [("pinion", 0), ("pinion", 1), ("gear", 0)])


def the_cut(gear_set, member, number):
    return Cut.of(gear_set.member(member), member)[number]


def test_fixed_settings_have_a_tool_for_each_flank_and_a_completing_cut_has_one_for_both(gear_set):
    assert [(cut.tool, cut.flanks) for cut in Cut.of(gear_set.pinion, "pinion")] == [
        ("PINION_CONCAVE", ("concave",)),
        ("PINION_CONVEX", ("convex",)),
    ]
    assert [(cut.tool, cut.flanks) for cut in Cut.of(gear_set.gear, "gear")] == [("GEAR", ("concave", "convex"))]


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


@each_cut
def test_nodes_rise_in_equal_steps_over_the_whole_roll(gear_set, member, number):
    spec, cut = gear_set.member(member), the_cut(gear_set, member, number)
    nodes = roll_nodes(spec, cut, 1e-4, HEIGHT)
    assert (nodes[0], nodes[-1]) == roll_range(spec, cut)
    steps = np.diff(nodes)
    assert (steps > 0).all()
    np.testing.assert_allclose(steps, steps.mean(), rtol=1e-9)


@each_cut
def test_a_hundredth_of_the_tolerance_takes_ten_times_the_blocks(gear_set, member, number):
    spec, cut = gear_set.member(member), the_cut(gear_set, member, number)
    coarse, fine = (len(roll_nodes(spec, cut, tolerance, HEIGHT)) - 1 for tolerance in (1e-2, 1e-4))
    assert fine == pytest.approx(10 * coarse, abs=10)


@each_cut
def test_chord_error_is_that_of_the_cone_halfway_between_two_poses(gear_set, member, number, witness):
    """Against the witness: the cone at the mean of the axis positions of both ends of the block, two degrees wide."""
    spec, cut, width = gear_set.member(member), the_cut(gear_set, member, number), np.radians(2.0)
    for flank in cut.flanks:
        settings, points = spec.flank(flank), whole_flank(spec, flank)
        ends = [
            witness.vertical_axes(settings.vector, points.contact[:, 2] + half, HEIGHT)
            for half in (-width / 2, width / 2)
        ]
        ends[1][:, 3] += 2 * np.pi * np.round((ends[0][:, 3] - ends[1][:, 3]) / (2 * np.pi))
        pose = witness.vertical_pose((ends[0] + ends[1]) / 2, HEIGHT)
        left = witness.entry(*pose, *settings.vector[10:], SIDES[flank], points.point, points.normal)
        error = chord_error(settings, SIDES[flank], points, width, HEIGHT)
        below_tip = points.contact[:, 0] < 0.2  # there the tip cuts, at another angle
        np.testing.assert_allclose(error[~below_tip], left[~below_tip], rtol=0, atol=1e-9)
        assert np.abs(error).max() > 1e-3  # a block of two degrees is seen on the flank


@pytest.mark.parametrize("tolerance", [0.0, -1e-4, 9e-7, 0.2, float("nan"), float("inf")])
def test_tolerance_out_of_range_is_refused_with_the_limits(gear_set, tolerance):
    cut = the_cut(gear_set, "gear", 0)
    with pytest.raises(InputError, match=r"^tolerance = .* um: must lie between 0.001 and 100 um$"):
        roll_nodes(gear_set.gear, cut, tolerance, HEIGHT)


@pytest.mark.parametrize("member", MEMBERS)
def test_whole_flank_reaches_from_the_lower_limit_to_the_tip(gear_set, member):
    spec = gear_set.member(member)
    for cut in Cut.of(spec, member):
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
