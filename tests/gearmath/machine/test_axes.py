"""The two machines put the cutter into the same pose: 10^4 random settings with tilt, and singular poses refused."""

from __future__ import annotations

import numpy as np
import pytest

from derivations import notation
from derivations.axes import cradle_tool_pose
from gearmath.bevel.kernels import kernel
from gearmath.errors import InputError
from gearmath.lowering import lower
from gearmath.machine.path import axis_positions

N = 10_000


@pytest.fixture(scope="module")
def poses(witness):
    """Settings of the whole domain and cradle rotations with |V_c × V_p| >= 0.05, and a height of the blade tips."""
    generator = np.random.default_rng(7)
    low, high = np.array([component.domain for component in notation.settings.components]).T
    settings = generator.uniform(low, high, (2 * N, 12))
    theta = generator.uniform(-1, 1, 2 * N)
    B = witness.vertical_axes(settings, theta, 0.0)[:, 4]
    regular = np.cos(B) >= 0.05
    assert regular.sum() >= N
    return settings[regular][:N], theta[regular][:N], generator.uniform(100, 400, N)


def angle_between(a, b):
    """Robust for nearly parallel unit vectors, where acos of the scalar product has no digits left."""
    return 2 * np.arctan2(np.linalg.norm(a - b, axis=-1), np.linalg.norm(a + b, axis=-1))


def test_both_machines_put_the_cutter_into_the_same_pose(poses):
    settings, theta, height = poses
    (axes,) = kernel("axis_transform")(settings, theta, height)
    centre, axis = kernel("tool_pose")(axes, height)
    expected_centre, expected_axis = lower(cradle_tool_pose())(settings, theta)
    assert np.linalg.norm(centre - expected_centre, axis=1).max() <= 1e-11  # mm
    assert angle_between(axis, expected_axis).max() <= 1e-12  # rad


def test_axes_and_pose_are_those_of_the_conventions(poses, witness):
    """Against vectors in plain NumPy: axis positions, cutter in the work, and back from the positions."""
    settings, theta, height = poses
    (axes,) = kernel("axis_transform")(settings, theta, height)
    expected = witness.vertical_axes(settings, theta, 0.0) + height[:, None] * [0, 0, 1, 0, 0]
    off = axes - expected
    off[:, 3] = (off[:, 3] + np.pi) % (2 * np.pi) - np.pi
    assert np.abs(off[:, :3]).max() <= 1e-11
    assert np.abs(off[:, 3:]).max() <= 1e-12
    for centre, axis in (kernel("tool_pose")(axes, height), witness.vertical_pose(axes, height)):
        cradle_centre, cradle_axis = witness.pose(settings, theta)
        assert np.linalg.norm(centre - cradle_centre, axis=1).max() <= 1e-11
        assert angle_between(axis, cradle_axis).max() <= 1e-12


def test_cutter_axis_parallel_to_the_work_axis_is_refused_by_its_cradle_angle(gear_set):
    """At root angle 67.6833° a tilt of 22.3167° towards +i, which is swivel 90° - q, makes V_c parallel to V_p."""
    flank = gear_set.gear.concave
    parallel = flank.model_copy(update={"cutter_tilt": 90 - 67.6833, "cutter_swivel": 90 - flank.cradle_angle})
    with pytest.raises(InputError, match=r"at cradle angle 0\.000 deg the cutter axis is parallel .*0\.05"):
        axis_positions(parallel, np.radians([-30.0, 0.0, 30.0]), 500.0)
    away = axis_positions(parallel, np.radians([-30.0, -15.0]), 500.0)
    assert np.isfinite(away).all()


def test_the_limit_of_the_singular_pose_is_where_it_is_said_to_be(gear_set):
    """Without tilt the angle between the axes is 90° - Γ, so that |V_c × V_p| = cos Γ: 0.05 at 87.134°."""
    upright = gear_set.gear.concave.model_copy(update={"cutter_tilt": 0.0})
    axis_positions(upright.model_copy(update={"machine_root_angle": 87.13}), np.zeros(1), 500.0)
    with pytest.raises(InputError, match="parallel"):
        axis_positions(upright.model_copy(update={"machine_root_angle": 87.14}), np.zeros(1), 500.0)


def test_positions_of_a_are_continuous_over_many_turns(gear_set):
    theta = np.linspace(-3, 3, 400)
    axes = axis_positions(gear_set.pinion.concave, theta, 500.0)
    np.testing.assert_allclose(np.diff(axes[:, 3]), -3.242698504951 * np.diff(theta), atol=1e-12)  # -R_a θ, no tilt
