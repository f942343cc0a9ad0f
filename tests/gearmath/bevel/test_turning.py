"""A quarter of a turn, worked by hand; one angle for all or one for each; grids of points as well."""

from __future__ import annotations

import math

import numpy as np

from gearmath.bevel.turning import turned

POINTS = np.array([[2.0, 0.0, 5.0], [0.0, 3.0, -1.0], [1.0, 1.0, 0.0]])


def test_a_quarter_of_a_turn_takes_x_to_y_and_keeps_z():
    expected = [[0.0, 2.0, 5.0], [-3.0, 0.0, -1.0], [-1.0, 1.0, 0.0]]
    np.testing.assert_allclose(turned(POINTS, math.pi / 2), expected, rtol=0, atol=1e-15)


def test_every_point_may_have_its_own_angle():
    angles = np.array([math.pi / 2, -math.pi / 2, math.pi])
    expected = [[0.0, 2.0, 5.0], [3.0, 0.0, -1.0], [-1.0, -1.0, 0.0]]
    np.testing.assert_allclose(turned(POINTS, angles), expected, rtol=0, atol=1e-15)


def test_a_grid_of_points_keeps_its_shape():
    grid = POINTS.reshape(1, 3, 3).repeat(2, axis=0)
    np.testing.assert_array_equal(turned(grid, 0.3), [turned(POINTS, 0.3)] * 2)
