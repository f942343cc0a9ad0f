"""Block times: by hand where one thing alone limits them, and every limit kept on random and on real paths."""

from __future__ import annotations

import numpy as np
import pytest

from gearmath.errors import InputError
from gearmath.machine.planning.feeds import block_seconds
from gearmath.machine.planning.path import Cut, axis_positions, roll_range

TOOTH = np.array([30.0, -10.0, 80.0])


def quick(vertical, speed=1e9, acceleration=1e12):
    """The machine with the same, very high limits on all axes."""
    update = {"max_speed_per_min": speed, "max_acceleration": acceleration}
    axes = {name: getattr(vertical.axes, name).model_copy(update=update) for name in "XYZAB"}
    return vertical.model_copy(update={"axes": vertical.axes.model_copy(update=axes)})


def speeds_and_changes(axes, seconds):
    """Speed in each block, and change of speed at each node over the mean of the times on both sides."""
    speeds = np.diff(axes, axis=0) / seconds[:, None]
    padded = np.vstack([np.zeros(5), speeds, np.zeros(5)])
    times = np.concatenate([[0.0], seconds, [0.0]])
    return np.abs(speeds), np.abs(np.diff(padded, axis=0)) / ((times[1:] + times[:-1]) / 2)[:, None]


def test_feed_is_the_speed_past_the_tooth_and_not_that_of_the_axes(vertical):
    """Limit case without limits. A turns 0.2 rad: the tooth moves on a circle of radius √(30² + 10²) about z_w."""
    machine = quick(vertical)
    straight = np.array([[0, 0, 0, 0, 0], [3, 4, 0, 0, 0], [3, 4, 12, 0, 0.0]])
    np.testing.assert_allclose(block_seconds(straight, machine, 300.0, TOOTH), [1.0, 2.4], rtol=1e-4)
    turning = np.array([[0, 0, 0, 0, 0.3], [0, 0, 0, 0.1, 0.3], [0, 0, 0, 0.2, 0.3]])
    chord = 2 * np.hypot(30, 10) * np.sin(0.05)
    np.testing.assert_allclose(block_seconds(turning, machine, 60.0, TOOTH), [chord, chord], rtol=1e-4)


def test_cutter_that_goes_with_the_tooth_is_limited_by_the_axes_alone(vertical):
    """X, Y and Z follow a point on z_w that B turns: nothing passes the tooth, so that the feed is no limit."""
    B, tooth = np.radians([0.0, 10.0, 20.0]), np.array([0.0, 0.0, 80.0])
    axes = np.column_stack([-80 * np.cos(B), 0 * B, -80 * np.sin(B), 0 * B, B])
    machine = quick(vertical, speed=600.0)  # mm/min, degrees/min
    seconds = block_seconds(axes, machine, 1e-3, tooth)
    chords = np.abs(np.diff(axes, axis=0))
    longest = np.maximum(chords[:, [0, 2]].max(axis=1) / 10.0, np.degrees(chords[:, 4]) / 10.0)
    np.testing.assert_allclose(seconds, longest, rtol=1e-4)


def test_one_block_from_standstill_to_standstill_takes_what_accelerating_and_braking_take(vertical):
    """100 mm at no more than 1000 mm/s2, of which half is for this: 2 √(100 / 500) s."""
    axes = np.array([[0, 0, 0, 0, 0], [100, 0, 0, 0, 0.0]])
    (seconds,) = block_seconds(axes, quick(vertical, acceleration=1000.0), 1e9, TOOTH)
    assert seconds == pytest.approx(2 * np.sqrt(100 / 500), rel=1e-9)


@pytest.mark.parametrize("feed", [100.0, 3000.0, 1e6])
def test_no_axis_exceeds_its_speed_or_acceleration(vertical, feed):
    generator = np.random.default_rng(11)
    for points in (2, 3, 40):
        axes = np.cumsum(generator.normal(0, [2.0, 2.0, 1.0, 0.05, 0.02], (points, 5)), axis=0)
        speeds, changes = speeds_and_changes(axes, block_seconds(axes, vertical, feed, TOOTH))
        assert (speeds <= vertical.max_speed * (1 + 1e-9)).all()
        assert (changes <= vertical.max_acceleration * (1 + 1e-9)).all()


@pytest.mark.parametrize("member", ["pinion", "gear"])
def test_a_slow_roll_keeps_its_feed_and_a_fast_one_is_near_its_limits(gear_set, vertical, member):
    """Slow: acceleration costs next to nothing. Fast: some axis uses at least a third of what it has, everywhere."""
    spec = gear_set.member(member)
    cut = Cut.of(spec)[0]
    axes = axis_positions(spec.flank(cut.flanks[0]), np.linspace(*roll_range(spec, cut), 100), vertical.pivot_height)
    free = block_seconds(axes, quick(vertical), 60.0, TOOTH)
    slow = block_seconds(axes, vertical, 60.0, TOOTH)
    assert slow.sum() == pytest.approx(free.sum(), rel=5e-3)
    np.testing.assert_allclose(slow[5:-5], free[5:-5], rtol=1e-9)
    speeds, changes = speeds_and_changes(axes, block_seconds(axes, vertical, 1e6, TOOTH))
    used = np.maximum((changes[1:] / vertical.max_acceleration).max(axis=1), (speeds / vertical.max_speed).max(axis=1))
    assert used.min() > 1 / 3
    assert used.max() <= 1 + 1e-9


@pytest.mark.parametrize("feed", [0.0, -1.0, float("nan"), float("inf")])
def test_a_feed_that_is_none_is_refused(vertical, feed):
    with pytest.raises(InputError, match=r"feed = .* mm/min: must be greater than 0"):
        block_seconds(np.zeros((2, 5)), vertical, feed, TOOTH)
