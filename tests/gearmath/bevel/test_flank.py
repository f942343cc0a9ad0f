"""The solver: points against brute force on the cradle machine, normals against its own surface, refusals."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gearmath.bevel.flank import Grid, blank_grid, solve_flank, solve_places
from gearmath.bevel.method import actual_cut, nominal_cut
from gearmath.errors import InputError
from gearmath.specs.bevel_set import FLANKS, MEMBERS, SETTINGS, SIDES

each_flank = pytest.mark.parametrize(("member", "flank"), [(m, f) for m in MEMBERS for f in FLANKS])


@pytest.fixture
def solved(gear_set, member, flank):
    spec = gear_set.member(member)
    return solve_flank(spec, flank, blank_grid(spec))


def in_cone_coordinates(blank, axial, radial):
    """Distance from the apex along the pitch cone, and height above it."""
    delta = np.radians(blank.pitch_angle)
    return axial * np.cos(delta) + radial * np.sin(delta), radial * np.cos(delta) - axial * np.sin(delta)


def lines_of_depth(blank, along):
    """Height of the lower limit of the working depth, and of the tip, above the pitch cone."""
    from_mean = along - blank.mean_cone_distance
    tip = blank.mean_addendum + from_mean * np.tan(np.radians(blank.face_angle - blank.pitch_angle))
    root = -blank.mean_dedendum - from_mean * np.tan(np.radians(blank.pitch_angle - blank.root_angle))
    return root + blank.clearance, tip


@pytest.mark.parametrize("member", MEMBERS)
def test_grid_runs_from_root_to_tip_and_from_toe_to_heel_within_its_margins(gear_set, member):
    blank = gear_set.member(member).blank
    grid = blank_grid(gear_set.member(member))
    assert grid.shape == (5, 9)
    along, height = in_cone_coordinates(blank, grid.axial, grid.radial)
    toe = blank.mean_cone_distance - blank.face_width / 2
    np.testing.assert_allclose(along, np.tile(toe + blank.face_width * np.linspace(0.1, 0.9, 9), (5, 1)), atol=1e-10)
    low, high = lines_of_depth(blank, along)
    np.testing.assert_allclose((height - low) / (high - low), np.tile(np.linspace(0.1, 0.9, 5), (9, 1)).T, atol=1e-10)
    assert along[2, 4] == pytest.approx(blank.mean_cone_distance, abs=1e-10)  # the reference point


def test_grid_without_margins_reaches_the_four_corners(gear_set):
    blank = gear_set.gear.blank
    grid = blank_grid(gear_set.gear, 2, 2, 0.0)
    along, height = in_cone_coordinates(blank, grid.axial, grid.radial)
    np.testing.assert_allclose(along[0], [81.0514 - 12.7, 81.0514 + 12.7], atol=1e-10)
    low, high = lines_of_depth(blank, along[0])
    np.testing.assert_allclose(height, [low, high], atol=1e-10)


@each_flank
def test_cutter_touches_every_point_and_takes_nothing_more_away(gear_set, member, flank, solved, witness):
    """Brute force: over all poses of the cradle, the cone comes to the point along its normal, and no further."""
    settings = gear_set.member(member).flank(flank).vector
    u, beta, theta = solved.contact.T
    np.testing.assert_allclose(witness.surface(u, beta, theta, settings, SIDES[flank]), solved.point, atol=1e-10)
    left, at = witness.left_by_cradle(settings, SIDES[flank], solved.point, solved.normal, theta + 0.01)
    assert np.abs(left).max() < 1e-9  # mm
    np.testing.assert_allclose(at, theta, atol=1e-5)


def test_cutter_touches_every_point_with_tilt_swivel_and_every_offset(gear_set, witness):
    tilted = gear_set.pinion.concave.model_copy(
        update={"cutter_tilt": 2.5, "cutter_swivel": -35.0, "machine_root_angle": 15.2, "work_rotation_offset": 11.0}
    )
    grid = blank_grid(gear_set.pinion)
    points, residual = solve_places(tilted.vector, 1, grid.axial.ravel(), grid.radial.ravel())
    assert residual.max() < 1e-9
    left, _ = witness.left_by_cradle(tilted.vector, 1, points.point, points.normal, points.contact[:, 2] + 0.01)
    assert np.abs(left).max() < 1e-9


@each_flank
def test_points_lie_at_their_places(gear_set, member, flank, solved):
    grid = blank_grid(gear_set.member(member))
    np.testing.assert_allclose(solved.point[:, 2], grid.axial.ravel(), rtol=0, atol=1e-9)
    np.testing.assert_allclose(np.hypot(*solved.point[:, :2].T), grid.radial.ravel(), rtol=0, atol=1e-9)


@each_flank
def test_normals_are_those_of_the_surface_that_the_solver_gives(gear_set, member, flank, solved):
    """Central differences between neighbours, 1 µm away along z and along the radius."""
    settings, side, step = gear_set.member(member).flank(flank).vector, SIDES[flank], 1e-3
    axial, radial = solved.point[:, 2], np.hypot(*solved.point[:, :2].T)

    def at(dz, dr):
        points, residual = solve_places(settings, side, axial + dz, radial + dr, solved.contact)
        assert residual.max() < 1e-9
        return points.point

    tangents = (at(step, 0) - at(-step, 0)) / (2 * step), (at(0, step) - at(0, -step)) / (2 * step)
    normal = np.cross(*tangents)
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    normal *= np.sign(np.sum(normal * solved.normal, axis=1, keepdims=True))
    np.testing.assert_allclose(np.linalg.norm(solved.normal, axis=1), 1, rtol=0, atol=1e-14)
    np.testing.assert_allclose(solved.normal, normal, rtol=0, atol=1e-7)


@pytest.mark.parametrize("member", MEMBERS)
def test_normals_point_out_of_the_metal_into_space_0_between_concave_and_convex(gear_set, member):
    """At one place on the blank, each flank looks across the space at the other, less than a pitch away."""
    spec = gear_set.member(member)
    concave, convex = (solve_flank(spec, flank, blank_grid(spec)) for flank in FLANKS)
    around = np.stack([-concave.point[:, 1], concave.point[:, 0], 0 * concave.point[:, 0]], axis=1)
    polar = [np.arctan2(points.point[:, 1], points.point[:, 0]) for points in (concave, convex)]
    across = (polar[1] - polar[0] + np.pi) % (2 * np.pi) - np.pi
    towards_convex = np.sign(np.sum(concave.normal * around, axis=1))
    assert (towards_convex == np.sign(across)).all()
    assert (np.sign(np.sum(convex.normal * around, axis=1)) == -np.sign(across)).all()
    assert (np.abs(across) < 2 * np.pi / spec.teeth).all()


@pytest.mark.parametrize(("member", "turn"), [("gear", 1), ("pinion", -1)])
def test_trace_of_a_right_hand_tooth_turns_forward_from_toe_to_heel(gear_set, member, turn):
    """The gear is right hand, the pinion left hand."""
    spec = gear_set.member(member)
    assert spec.hand == ("right" if turn > 0 else "left")
    for flank in FLANKS:
        points = solve_flank(spec, flank, blank_grid(spec)).point.reshape(5, 9, 3)
        polar = np.unwrap(np.arctan2(points[..., 1], points[..., 0]), axis=1)
        assert (turn * np.diff(polar, axis=1) > 0).all()


@each_flank
def test_settings_of_the_other_hand_give_the_mirror_image(gear_set, member, flank, solved):
    mirrored = gear_set.member(member).flank(flank).vector.copy()
    for name in ("cradle_angle", "blank_offset", "work_rotation_offset"):
        mirrored[SETTINGS.index(name)] *= -1
    grid = blank_grid(gear_set.member(member))
    points, residual = solve_places(mirrored, SIDES[flank], grid.axial.ravel(), grid.radial.ravel())
    assert residual.max() < 1e-9
    np.testing.assert_allclose(points.point, solved.point * [1, -1, 1], rtol=0, atol=1e-9)
    np.testing.assert_allclose(points.normal, solved.normal * [1, -1, 1], rtol=0, atol=1e-11)


def test_point_beyond_a_short_blade_is_refused_by_member_flank_row_and_column(gear_set, altered):
    """The gear is about 7 mm deep at the heel: a blade of 5 mm does not reach from root to tip."""
    short = altered(gear_set, "gear", "concave", blade_profile_height=5.0).gear
    whole = solve_flank(gear_set.gear, "concave", blank_grid(gear_set.gear))
    first = int(np.argmax(whole.contact[:, 0] > 5.0))
    place = f"gear concave flank, row {first // 9}, column {first % 9}: "
    with pytest.raises(InputError, match=place + r".*above the blade.* 5\.\d{4} mm"):
        solve_flank(short, "concave", blank_grid(short))


@pytest.mark.parametrize(
    ("row", "column", "deeper", "words"),
    [
        (0, 7, -3.0, "below the blade tip|no solution"),  # mm towards the axis: beneath the root
        (0, 2, 40.0, "no solution|above the blade"),
        (4, 8, -60.0, "no solution|below the blade tip"),
    ],
)
@each_flank
def test_place_off_the_flank_is_refused_by_member_flank_row_and_column(
    gear_set, member, flank, row, column, deeper, words
):
    spec = gear_set.member(member)
    grid, delta = blank_grid(spec), np.radians(spec.blank.pitch_angle)
    axial, radial = grid.axial.copy(), grid.radial.copy()
    axial[row, column] -= deeper * np.sin(delta)
    radial[row, column] += deeper * np.cos(delta)
    with pytest.raises(InputError, match=f"^{member} {flank} flank, row {row}, column {column}: .*({words})"):
        solve_flank(spec, flank, Grid(axial, radial))


def test_place_beneath_the_root_lies_below_the_blade_tip(gear_set):
    grid = blank_grid(gear_set.gear)
    with pytest.raises(InputError, match=r"row 0, column 0: .* below the blade tip"):
        solve_flank(gear_set.gear, "convex", Grid(grid.axial + 2.5, grid.radial - 1.0))


def test_place_that_is_no_number_is_refused(gear_set):
    grid = blank_grid(gear_set.pinion)
    axial = grid.axial.copy()
    axial[1, 1] = np.nan
    with pytest.raises(InputError, match=r"pinion convex flank, row 1, column 1: .*no solution"):
        solve_flank(gear_set.pinion, "convex", Grid(axial, grid.radial))


@given(st.floats(-60, 60), st.floats(-60, 60), st.sampled_from(MEMBERS), st.sampled_from(FLANKS))
def test_no_point_is_returned_that_is_not_in_mesh_at_its_place_and_on_the_blade(
    gear_set, witness, axial_shift, radial_shift, member, flank
):
    """Places up to 60 mm beside the flank: a refusal, or a point whose family stands still along the normal."""
    spec = gear_set.member(member)
    grid = blank_grid(spec)
    axial, radial = grid.axial[2:3, 4:5] + axial_shift, grid.radial[2:3, 4:5] + radial_shift
    try:
        points = solve_flank(spec, flank, Grid(axial, radial))
    except InputError as error:
        assert f"{member} {flank} flank, row 0, column 0: " in str(error)  # noqa: PT017
        return
    x, side, step = spec.flank(flank).vector, SIDES[flank], 1e-4
    u, beta, theta = points.contact[0]
    assert -1e-6 <= u <= spec.flank(flank).blade_profile_height + 1e-6
    np.testing.assert_allclose(points.point[0, 2], axial[0, 0], atol=1e-8)
    np.testing.assert_allclose(np.hypot(*points.point[0, :2]), abs(radial[0, 0]), atol=1e-8)
    moved = witness.surface(u, beta, theta + step, x, side) - witness.surface(u, beta, theta - step, x, side)
    assert abs(moved @ points.normal[0]) / (2 * step) < 1e-3  # mm/rad, of about 1000 where nothing is in mesh


def test_corrected_flank_has_the_cut_of_its_design_and_that_of_its_settings(gear_set, altered, nominal_settings):
    before = gear_set.pinion.concave
    values = {"radial_distance": before.radial_distance + 0.05, "blade_point_radius": before.blade_point_radius + 0.1}
    pinion = altered(gear_set, "pinion", "concave", nominal_settings(before), **values).pinion
    wanted, really = nominal_cut(pinion, "concave"), actual_cut(pinion, "concave")
    assert wanted.sections == nominal_cut(gear_set.pinion, "concave").sections
    np.testing.assert_array_equal(wanted.how.settings, before.vector)
    np.testing.assert_array_equal(really.how.settings, pinion.concave.vector)
    assert really.main.point_radius == wanted.main.point_radius + 0.1
    assert nominal_cut(gear_set.gear, "convex").is_plain
    assert not nominal_cut(gear_set.gear.model_copy(update={"generation": "formate"}), "convex").is_plain
