"""Every cutting method against brute force: the moving blade edge comes to each point, and takes nothing more away."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from gearmath.bevel.flank import blank_grid, nominal_points, solve_flank
from gearmath.bevel.generation import solve_section
from gearmath.bevel.method import blade_sections, generation_of
from gearmath.kernels import kernel
from gearmath.specs.bevel_set import FLANKS, SIDES

METHODS = (
    "face mill, generated",
    "modified roll",
    "tilt",
    "helical motion",
    "universal motion",
    "face hob, generated",
    "face hob, universal motion",
    "Formate mill",
    "Formate hob",
)
FORMATE = ("Formate mill", "Formate hob")

each_method = pytest.mark.parametrize("method", METHODS)
each_flank = pytest.mark.parametrize("flank", FLANKS)


def solve(member, flank):
    """The 45 points of a flank by the general solver."""
    grid, section = blank_grid(member), blade_sections(member.flank(flank), SIDES[flank])["main"]
    return solve_section(generation_of(member, flank), section, grid.axial.ravel(), grid.radial.ravel())


@pytest.mark.parametrize("hand", ["as listed", "other hand"])
@each_flank
@each_method
def test_blade_edge_touches_every_point_and_takes_nothing_more_away(methods, moved_edge, method, flank, hand):
    """Along the normal of each of the 45 points, over cutter angle and cradle angle: what is left ends at the point.

    The search starts beside the solution: 0.2 mm along the blade, and off its cutter and cradle angle.
    """
    member = methods[method] if hand == "as listed" else moved_edge.mirrored(methods[method])
    points = solve_flank(member, flank, blank_grid(member))
    theta, beside = points.contact[:, 2], points.contact[:, :2] + [0.2, 0.013]
    blade = moved_edge.blade_of(member, flank)
    if method in FORMATE:
        left, crosses = moved_edge.on_lines(blade, points.point, points.normal, np.zeros(45), beside)
        assert crosses.all()
    else:
        left, at = moved_edge.left_on_lines(blade, points.point, points.normal, theta + 0.00317, beside, 0.02)
        np.testing.assert_allclose(at, theta, rtol=0, atol=2e-5)
    assert np.abs(left).max() < 1e-6  # mm


@each_flank
@each_method
def test_settings_of_the_other_hand_give_the_mirror_image(methods, moved_edge, method, flank):
    """Cradle, offset, work angle and blade offset change sign, the swivel goes to 180°, odd and even coefficients."""
    points, other = solve(methods[method], flank), solve(moved_edge.mirrored(methods[method]), flank)
    assert points.converged.all()
    assert other.converged.all()
    np.testing.assert_allclose(other.point, points.point * [1, -1, 1], rtol=0, atol=1e-8)
    np.testing.assert_allclose(other.normal, points.normal * [1, -1, 1], rtol=0, atol=1e-9)


@each_flank
@each_method
def test_normal_is_square_to_the_surface_that_the_edge_sweeps(methods, moved_edge, method, flank):
    """Central differences along the edge and along its path, by the witness."""
    points, blade, h = solve(methods[method], flank), moved_edge.blade_of(methods[method], flank), 1e-4
    u, beta, theta = points.contact.T
    for tangent in (
        blade.at(u + h, beta, theta) - blade.at(u - h, beta, theta),
        blade.at(u, beta + h, theta) - blade.at(u, beta - h, theta),
    ):
        unit = tangent / np.linalg.norm(tangent, axis=1, keepdims=True)
        assert np.abs(np.sum(unit * points.normal, axis=1)).max() < 1e-7


@pytest.mark.parametrize("method", [name for name in METHODS if "motion" in name or name == "modified roll"])
def test_motion_moves_the_flank_by_far_more_than_the_tolerance(methods, method):
    """Otherwise the trials of the motions above would show nothing."""
    member = methods[method]
    how, section = generation_of(member, "concave"), blade_sections(member.concave, 1)["main"]
    grid = blank_grid(member)
    still = replace(how, motion=np.zeros((10, 7)))
    rest = solve_section(still, section, grid.axial.ravel(), grid.radial.ravel())
    apart = np.linalg.norm(solve(member, "concave").point - rest.point, axis=1)
    assert apart.max() > 0.005  # mm


@each_flank
def test_hobbing_without_indexing_and_universal_motion_of_degree_0_are_face_milling(methods, flank):
    """Limit case: the general solver with everything set to zero, against the solver of the spine."""
    member = methods["tilt"]
    hobbed = replace(generation_of(member, flank), index_ratio=0.0, motion=np.zeros((10, 7)), blade_offset_angle=0.0)
    grid, section = blank_grid(member), blade_sections(member.flank(flank), SIDES[flank])["main"]
    points = solve_section(hobbed, section, grid.axial.ravel(), grid.radial.ravel())
    milled, _ = nominal_points(member, flank, grid)
    np.testing.assert_allclose(points.point, milled.point, rtol=0, atol=1e-9)
    np.testing.assert_allclose(points.normal, milled.normal, rtol=0, atol=1e-9)


@each_flank
def test_indexing_that_tends_to_zero_tends_to_face_milling(methods, flank):
    """The difference falls in proportion: by 10 from one indexing to the next."""
    member = methods["face mill, generated"]
    grid, section = blank_grid(member), blade_sections(member.flank(flank), SIDES[flank])["main"]
    how, milled = generation_of(member, flank), solve(member, flank)
    apart = []
    for index_ratio in (1e-3, 1e-4):
        points = solve_section(replace(how, index_ratio=index_ratio), section, grid.axial.ravel(), grid.radial.ravel())
        apart.append(np.linalg.norm(points.point - milled.point, axis=1).max())
    assert 1e-3 < apart[1] < 0.5  # mm
    assert apart[0] / apart[1] == pytest.approx(10, rel=0.02)


@each_flank
def test_formate_is_the_roll_frozen(methods, flank):
    """Every point is a point of the cutter at cradle angle zero, taken into the work by the family of face milling."""
    member = methods["Formate mill"]
    points = solve(member, flank)
    u, beta, theta = points.contact.T
    assert np.abs(theta).max() < 1e-12
    on_cutter, _ = kernel("flank_family")(u, beta, 0 * theta, member.flank(flank).vector, SIDES[flank])
    np.testing.assert_allclose(points.point, on_cutter, rtol=0, atol=1e-10)
