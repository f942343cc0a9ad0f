"""The two machines put the cutter into the same pose: 10^5 random settings with tilt, and singular poses refused."""

from __future__ import annotations

import numpy as np
import pytest

from derivations import notation
from derivations.axes import cradle_tool_pose
from derivations.single_blades import cradle_tool_frame, tool_frame
from gearmath.errors import InputError
from gearmath.kernels import kernel
from gearmath.lowering import lower
from gearmath.machine.planning.path import axis_positions
from gearmath.specs.bevel_set import Motion

N = 100_000


@pytest.fixture(scope="module")
def poses(witness, vertical):
    """Settings of the whole domain, cradle rotations, blade tip heights and pivot offsets, within travel.

    All with |V_c × V_p| >= 0.05. Last come the positions of the witness: those of the conventions, shifted by the
    offset in the axes of the work at A = 0, which the swivel turns.
    """
    generator = np.random.default_rng(7)
    low, high = np.array([component.domain for component in notation.settings.components]).T
    many = 3 * N
    settings = generator.uniform(low, high, (many, 12))
    theta, height = generator.uniform(-1, 1, many), generator.uniform(100, 600, many)
    offset = generator.uniform(-80, 80, (many, 3))
    axes = witness.vertical_axes(settings, theta, 0.0)
    B = axes[:, 4]
    axes[:, 2] += height
    axes[:, 0] += -np.sin(B) * offset[:, 0] - np.cos(B) * offset[:, 2]
    axes[:, 1] += offset[:, 1]
    axes[:, 2] += np.cos(B) * offset[:, 0] - np.sin(B) * offset[:, 2]
    low, high = vertical.travel.T
    usable = (np.cos(B) >= 0.05) & ((axes >= low) & (axes <= high)).all(axis=1)
    assert usable.sum() >= N
    return tuple(array[usable][:N] for array in (settings, theta, height, offset, axes))


def angle_between(a, b):
    """Robust for nearly parallel unit vectors, where acos of the scalar product has no digits left."""
    return 2 * np.arctan2(np.linalg.norm(a - b, axis=-1), np.linalg.norm(a + b, axis=-1))


def test_both_machines_put_the_cutter_into_the_same_pose(poses):
    """Forward after inverse against the cradle machine: 1e-11 mm, 1e-12 rad, pivot offsets included."""
    settings, theta, height, offset, _ = poses
    (axes,) = kernel("axis_transform")(settings, theta, height, offset)
    centre, axis = kernel("tool_pose")(axes, height, offset)
    expected_centre, expected_axis = lower(cradle_tool_pose())(settings, theta)
    assert np.linalg.norm(centre - expected_centre, axis=1).max() <= 1e-11  # mm
    assert angle_between(axis, expected_axis).max() <= 1e-12  # rad


def test_axes_and_pose_are_those_of_the_conventions(poses, witness):
    """Against vectors in plain NumPy: axis positions, and the cutter in the work from positions without offset."""
    settings, theta, height, offset, expected = poses
    (axes,) = kernel("axis_transform")(settings, theta, height, offset)
    off = axes - expected
    off[:, 3] = (off[:, 3] + np.pi) % (2 * np.pi) - np.pi
    assert np.abs(off[:, :3]).max() <= 1e-11
    assert np.abs(off[:, 3:]).max() <= 1e-12
    (plain,) = kernel("axis_transform")(settings, theta, height)
    for centre, axis in (kernel("tool_pose")(plain, height), witness.vertical_pose(plain, height)):
        cradle_centre, cradle_axis = witness.pose(settings, theta)
        assert np.linalg.norm(centre - cradle_centre, axis=1).max() <= 1e-11
        assert angle_between(axis, cradle_axis).max() <= 1e-12


def test_the_other_branch_is_the_same_pose_with_b_beyond_a_right_angle(poses, witness):
    """(-X, -Y, Z, A + 180°, 180° - B), by the witness; the transform never gives it."""
    settings, theta, height, _, _ = poses
    (axes,) = kernel("axis_transform")(settings, theta, height)
    X, Y, Z, A, B = axes.T
    other = np.column_stack([-X, -Y, Z, A + np.pi, np.pi - B])
    for one, two in zip(witness.vertical_pose(axes, height), witness.vertical_pose(other, height), strict=True):
        np.testing.assert_allclose(one, two, rtol=0, atol=1e-11)
    assert (np.abs(B) < np.pi / 2).all()


def test_what_the_tool_sees_keeps_distances_and_has_its_own_centre_at_zero(poses):
    _, _, height, offset, axes = poses
    centre, _ = kernel("tool_pose")(axes, height, offset)
    (zero,) = kernel("seen_from_tool")(axes, centre, height, offset)
    (away,) = kernel("seen_from_tool")(axes, centre + np.array([3.0, -4.0, 12.0]), height, offset)
    np.testing.assert_allclose(zero, 0, atol=1e-11)
    np.testing.assert_allclose(np.linalg.norm(away, axis=1), 13.0, rtol=0, atol=1e-11)


def test_sixth_axis_gives_the_whole_pose_of_the_cutter(poses, witness):
    """A blade at cutter angle β stands, by X Y Z A B and C = β + ψ, where the cradle machine has it: 1e-10 mm.

    C is right-handed about the downward tool axis, from -X towards Y: i_s and j_s in the axes of the machine.
    """
    settings, theta, height, _, _ = poses
    beta, u = np.random.default_rng(3).uniform(-np.pi, np.pi, N), 2.0
    (axes,) = kernel("axis_transform")(settings, theta, height)
    (psi,) = kernel("cutter_phase")(settings, theta)
    C, radius = beta + psi, settings[:, 10] + u * np.tan(settings[:, 11])
    blade = axes[:, :3] + np.column_stack([-radius * np.cos(C), radius * np.sin(C), np.full(N, u)])
    moved = np.column_stack([blade[:, 0], blade[:, 1], blade[:, 2], axes[:, 3:]])
    point, _ = witness.vertical_pose(moved, height)
    expected = witness.surface(u, beta, theta, settings, 1)
    assert np.linalg.norm(point - expected, axis=1).max() <= 1e-10


def test_six_axes_give_the_whole_pose_of_the_cradle_machine_with_indexing(poses):
    """Centre, axis and turned reference of the cutter in the work: 1e-11 mm, 1e-12 rad, pivot offsets included."""
    settings, theta, height, offset, _ = poses
    generator = np.random.default_rng(17)
    beta, ratio = generator.uniform(-np.pi, np.pi, N), generator.uniform(-0.8, 0.8, N)
    (axes,) = kernel("axis_transform")(settings, theta, height, offset)
    axes[:, 3] -= ratio * beta
    (psi,) = kernel("cutter_phase")(settings, theta)
    pose = lower(tool_frame())(axes, beta + psi, height, offset)
    expected = lower(cradle_tool_frame())(settings, theta, beta, ratio)
    assert np.linalg.norm(pose[0] - expected[0], axis=1).max() <= 1e-11  # mm
    for direction, wanted in zip(pose[1:], expected[1:], strict=True):
        assert angle_between(direction, wanted).max() <= 1e-12  # rad


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


def test_settings_that_move_with_the_cradle_stand_where_they_are_at_that_rotation(gear_set):
    """Against settings typed in anew for every cradle rotation, their polynomials written out."""
    base = gear_set.pinion.concave
    motion = Motion(sliding_base=(2.0, -1.5), cutter_tilt=(1.0,), modified_roll=(0.02, -0.03))
    moving = base.model_copy(update={"motion": motion, "cutter_swivel": 30.0})
    theta = np.linspace(-0.2, 0.25, 7)
    axes = axis_positions(moving, theta, 500.0)
    for t, row in zip(theta, axes, strict=True):
        roll = base.ratio_of_roll * (t - 0.02 / 2 * t**2 + 0.03 / 6 * t**3)  # 2C, 6D
        still = base.model_copy(
            update={
                "sliding_base": base.sliding_base + 2.0 * t - 1.5 * t**2,
                "cutter_tilt": 1.0 * t,
                "cutter_swivel": 30.0,
                "work_rotation_offset": base.work_rotation_offset + np.degrees(roll - base.ratio_of_roll * t),
            }
        )
        (expected,) = axis_positions(still, np.array([t]), 500.0)
        np.testing.assert_allclose(row[[0, 1, 2, 4]], expected[[0, 1, 2, 4]], rtol=0, atol=1e-11)
        assert abs(np.remainder(row[3] - expected[3] + np.pi, 2 * np.pi) - np.pi) < 1e-12


def test_positions_of_a_are_continuous_over_many_turns(gear_set):
    theta = np.linspace(-3, 3, 400)
    axes = axis_positions(gear_set.pinion.concave, theta, 500.0)
    np.testing.assert_allclose(np.diff(axes[:, 3]), -3.2426985355495 * np.diff(theta), atol=1e-12)  # -R_a θ, no tilt
