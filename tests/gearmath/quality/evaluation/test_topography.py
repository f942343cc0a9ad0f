"""Topography: a surface of known coefficients is found again, and the figures are those of a hand calculation."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gearmath.bevel.nominal_file import flank_header
from gearmath.errors import InputError
from gearmath.quality.evaluation.topography import (
    ORDERS,
    evaluate_topography,
    grid_shape,
    local_coordinates,
    mean_topography,
    orders,
    orders_matrix,
)
from gearmath.specs.flank_csv import flank_file

coefficient = st.floats(-1e-3, 1e-3)


def cubic(c, X, Y):
    """The surface of the source text, term by term."""
    return (
        c[0]
        + c[1] * X
        + c[2] * Y
        + c[3] * X**2
        + c[4] * X * Y
        + c[5] * Y**2
        + c[6] * X**3
        + c[7] * X**2 * Y
        + c[8] * X * Y**2
        + c[9] * Y**3
    )


@pytest.mark.parametrize("index", range(10))
def test_each_coefficient_is_found_in_its_place(plane, index):
    wanted = np.eye(10)[index] * 1e-3
    topography = evaluate_topography(plane(lambda X, Y: cubic(wanted, X, Y)), "concave")
    np.testing.assert_allclose(topography.coefficients, wanted, rtol=0, atol=1e-13)
    np.testing.assert_allclose(topography.residual, 0, atol=1e-13)


def test_every_cubic_surface_is_found_again(plane):
    @given(st.lists(coefficient, min_size=10, max_size=10))
    def check(wanted):
        topography = evaluate_topography(plane(lambda X, Y: cubic(wanted, X, Y)), "concave")
        np.testing.assert_allclose(topography.coefficients, wanted, rtol=0, atol=1e-12)

    check()


def test_what_is_no_cubic_stays_in_the_residual_and_the_fit_is_the_nearest(plane):
    """X⁴ is orthogonal to nothing: what remains must be orthogonal to every monomial up to degree three."""
    topography = evaluate_topography(plane(lambda X, Y: 1e-6 * X**4), "concave")
    assert np.abs(topography.residual).max() > 1e-4
    X, Y = (np.indices((5, 9)) - [[[2]], [[4]]])[::-1] * [[[2.5]], [[1.25]]]
    for power in range(4):
        for k in range(power + 1):
            assert np.sum(topography.residual * X ** (power - k) * Y**k) == pytest.approx(0, abs=1e-9)


def test_rows_run_up_and_columns_along_whatever_the_order_of_the_file(plane):
    topography = evaluate_topography(plane(lambda X, Y: X + 100 * Y), "concave")
    assert topography.deviation.shape == (5, 9)
    np.testing.assert_allclose(np.diff(topography.deviation, axis=1), 2.5, atol=1e-12)
    np.testing.assert_allclose(np.diff(topography.deviation, axis=0), 125, atol=1e-11)


def test_extreme_keeps_its_sign_and_rms_is_that_of_all_points(plane):
    topography = evaluate_topography(plane(lambda X, Y: np.where((X == 0) & (Y == 0), -0.03, 0.01)), "concave")
    assert topography.extreme == -0.03
    assert topography.rms == pytest.approx(np.sqrt((44 * 0.01**2 + 0.03**2) / 45), rel=1e-14)


def test_small_grid_gets_a_plane_only(plane):
    topography = evaluate_topography(plane(lambda X, Y: 0.002 + 0.001 * X - 0.003 * Y, 3, 3), "concave")
    np.testing.assert_allclose(topography.coefficients, [0.002, 0.001, -0.003, *[0] * 7], rtol=0, atol=1e-14)


def test_local_coordinates_lie_in_the_tangent_of_a_real_flank(gear_set):
    """The reference point is the origin; its row runs along X, its column up Y; lengths are those of the flank."""
    from gearmath.bevel.flank import blank_grid, solve_flank

    points = solve_flank(gear_set.gear, "concave", blank_grid(gear_set.gear))
    grid = points.point.reshape(5, 9, 3)
    along, up = local_coordinates(grid, (2, 4))
    assert (along[2, 4], up[2, 4]) == (0, 0)
    assert (np.diff(along, axis=1) > 0).all()
    assert (np.diff(up, axis=0) > 0).all()
    # face width 25.4 mm, less margins, at a spiral angle of about 35°: 0.8 * 25.4 / cos 35° = 24.8 mm
    assert along[2, -1] - along[2, 0] == pytest.approx(24.8, abs=0.6)


def test_incomplete_grid_is_refused(plane):
    file = plane(lambda X, Y: 0 * X)
    few = flank_file(
        file.header,
        "pinion",
        "concave",
        0,
        file.row[:-1],
        file.col[:-1],
        file.point[:-1],
        file.normal[:-1],
        file.deviation[:-1],
    )
    with pytest.raises(InputError, match=r"^concave flank, tooth 0: 44 points, the grid 5x9 needs 45$"):
        evaluate_topography(few, "concave")
    with pytest.raises(InputError, match=r"^convex flank, tooth 0: 0 points"):
        evaluate_topography(file, "convex")


def test_nominal_file_is_refused(plane):
    file = plane(lambda X, Y: np.nan * X)
    with pytest.raises(InputError, match="is it a nominal file"):
        evaluate_topography(file, "concave")


@pytest.mark.parametrize("text", ["", "5", "5x", "5x9x2", "five"])
def test_grid_that_is_no_grid_is_refused(plane, text):
    file = plane(lambda X, Y: 0 * X)
    with pytest.raises(InputError, match=r"^grid = .*: must read like 5x9$"):
        grid_shape(replace(file, header=file.header | {"grid": text}))


def test_header_of_a_member_names_its_grid(gear_set):

    header = flank_header(gear_set.pinion, (7, 11), 0.05)
    assert (header["grid"], header["reference_point"], header["margins"]) == ("7x11", "3,5", "0.05,0.05")


def test_orders_of_a_quadratic_surface_by_hand(plane):
    """20 mm long and 5 mm high: slopes of 0.5 and -2 µm/mm, curvatures and twist are rises and heights.

    Spiral 0.5·20 = 10 and pressure -2·5 = -10 µm; crownings 0.04·10² = 4 and 0.8·2.5² = 5 µm; twist 0.1·20·5 = 10 µm.
    The mean of X² over nine columns 2.5 mm apart is 41.667, that of Y² over five rows 3.125: 7 - 1.667 - 2.5 µm.
    """
    um = 1e-3
    surface = plane(lambda X, Y: um * (7 + 0.5 * X - 2 * Y - 0.04 * X**2 + 0.1 * X * Y - 0.8 * Y**2))
    found = orders(evaluate_topography(surface, "concave"))
    assert (found.length, found.height) == (pytest.approx(20), pytest.approx(5))
    wanted = {
        "spiral_angle_deviation": 10,
        "pressure_angle_deviation": -10,
        "length_crowning": 4,
        "profile_crowning": 5,
        "twist": 10,
        "mean": 7 - 0.04 * 2.5**2 * 60 / 9 - 0.8 * 1.25**2 * 10 / 5,
    }
    for name, value in wanted.items():
        assert getattr(found, name) == pytest.approx(value * um, abs=1e-12), name
    assert found.residual == pytest.approx(0, abs=1e-12)
    assert found.spiral_angle == pytest.approx(0.5 * um)
    assert found.pressure_angle == pytest.approx(-2 * um)
    assert found.as_dict()["twist_um"] == pytest.approx(10)


@pytest.mark.parametrize(("rows", "columns"), [(5, 9), (11, 21), (4, 6)])
def test_slopes_are_those_over_the_area_whatever_the_reference_point_and_the_grid(plane, rows, columns):
    """A parabola has its mean slope in the middle of the area, also where the reference point lies beside it."""
    topography = evaluate_topography(plane(lambda X, Y: 1e-5 * X**2 + 0 * Y, rows, columns), "concave")
    length = 2.5 * (columns - 1)
    middle = 2.5 * ((columns - 1) / 2 - columns // 2)
    assert orders(topography).spiral_angle_deviation == pytest.approx(2e-5 * middle * length, abs=1e-12)
    assert orders(topography).length_crowning == pytest.approx(-1e-5 * length**2 / 4, abs=1e-12)


def test_orders_of_any_deviations_are_those_of_their_regressions(plane):
    """On an even grid centered at the reference point, each figure is a sum by itself.

    The slope along X is ΣXδ/ΣX²; a twist ΣXYδ/ΣX²Y²; a curvature is the slope of δ on X² less its mean, because the
    even polynomials 1, X² - mean, Y² - mean are orthogonal there. Rises are over 20 and 5 mm.
    """
    values = np.random.default_rng(3).normal(0, 0.01, 45)
    X, Y = (np.indices((5, 9))[k].ravel() for k in (1, 0))
    X, Y = 2.5 * (X - 4), 1.25 * (Y - 2)

    def slope(term):
        return term @ values / (term @ term)

    wanted = {
        "mean": values.sum() / 45,
        "spiral_angle_deviation": 20 * slope(X),
        "pressure_angle_deviation": 5 * slope(Y),
        "length_crowning": -(10**2) * slope(X**2 - np.mean(X**2)),
        "twist": 20 * 5 * slope(X * Y),
        "profile_crowning": -(2.5**2) * slope(Y**2 - np.mean(Y**2)),
    }
    topography = evaluate_topography(plane(lambda x, y: values), "concave")
    found = orders(topography)
    for name, value in wanted.items():
        assert getattr(found, name) == pytest.approx(value, abs=1e-15), name
    matrix = orders_matrix(topography.along.ravel(), topography.upward.ravel())
    np.testing.assert_allclose(matrix @ values, [wanted[name] for name in ORDERS], rtol=0, atol=1e-15)


def test_two_rows_have_no_second_order(plane):
    flat = orders(evaluate_topography(plane(lambda X, Y: 1e-3 * X + 2e-3 * Y, 2, 9), "concave"))
    assert flat.pressure_angle == pytest.approx(2e-3)
    assert (flat.length_crowning, flat.twist, flat.profile_crowning) == (0, 0, 0)


def test_points_without_deviation_are_left_out_of_every_figure(plane):
    def surface(X, Y):
        return np.where((X == 10) & (Y == 2.5), np.nan, 1e-3 * X + 2e-3 * Y)

    topography = evaluate_topography(plane(surface), "concave")
    assert topography.left_out == 1
    assert topography.extreme == pytest.approx(-15e-3)  # toe and root: heel and tip is left out
    np.testing.assert_allclose(topography.coefficients[:3], [0, 1e-3, 2e-3], atol=1e-12)
    assert orders(topography).pressure_angle == pytest.approx(2e-3)
    half = plane(lambda X, Y: np.where(X < 0, np.nan, 0.01))
    with pytest.raises(InputError, match=r"25 of 45 points have a deviation; is it a nominal file\?$"):
        evaluate_topography(half, "concave")


def test_mean_of_teeth_is_the_mean_of_every_point_that_is_there(plane):
    first = evaluate_topography(plane(lambda X, Y: 0.004 + 0 * X), "concave")
    second = evaluate_topography(plane(lambda X, Y: np.where(X == 10, np.nan, 0.008)), "concave")
    mean = mean_topography([first, second])
    np.testing.assert_allclose(mean.deviation, np.tile([0.006] * 8 + [0.004], (5, 1)))
