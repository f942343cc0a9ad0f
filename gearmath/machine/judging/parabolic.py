"""How fast LinuxCNC runs along straight blocks with rotary axes: parabolic blending, which looks one block ahead.

A block of length l should run at v, and its axes allow a; half of that, where two blocks run at once. Each block must
be able to stop at its end: it reaches no more than v_r = min(v, sqrt(a l)). Where it slows down below the speed of the
blend, the next one begins, and both add up, until the first stands. A blend takes no longer than the shorter block
lasts, nor than the slower start: t = min(l/v_r of both, max v_r/a of both), so that it begins at min(v_r, a t), and no
faster than 2 sqrt(a P/cos θ), where P is the tolerance of G64, and 2 θ the angle between both blocks in X Y Z.

The block before a stop starts with all of its acceleration, not half of it. So the corner before it is left farther
than P: with a share s of the blend gone, (1 - s)^2 of the way to the corner is left, and 2 s^2 of it is done behind it.
Both are alike, and the path the farthest off, at s = sqrt(2) - 1; at a corner of two equal halves it is at s = 1/2.
"""

from __future__ import annotations

import math

import numpy as np

from gearmath.machine.judging.look_ahead import NO_WAY, FollowedRun, RoundedCorners, path_length
from gearmath.specs.milling_machine import AxisLimits

#: Cosines of θ from which on the tolerance counts.
_STRAIGHT = 1e-6
#: How much farther the corner before a last block is left than one of two equal halves.
_BEFORE_STOP = (2.0 - math.sqrt(2.0)) ** 2 / 0.25


def follow_parabolic(where: np.ndarray, asked: np.ndarray, limits: AxisLimits, corners: RoundedCorners) -> FollowedRun:
    """Run along positions (n+1,k) [mm, rad], whose blocks should take ``asked`` (n,) s; standstill at both ends."""
    steps = np.diff(where, axis=0)
    length, by_turning = np.linalg.norm(steps[:, :3], axis=1), np.linalg.norm(steps[:, 3:] * limits.scale[3:], axis=1)
    length = np.where(length > NO_WAY, length, by_turning)
    index = np.flatnonzero(length > NO_WAY)
    count = max(len(steps) - 1, 0)
    result = FollowedRun(np.zeros(len(steps)), np.zeros(len(steps) + 1), np.zeros(count), np.zeros(count))
    if not len(index):
        return result
    steps, length = steps[index], length[index]
    along = steps / length[:, None]
    with np.errstate(divide="ignore"):
        wanted = np.minimum(length / np.maximum(asked[index], 1e-9), (limits.max_speed / np.abs(along)).min(axis=1))
        gain = (limits.max_acceleration / np.abs(along)).min(axis=1)
    if not corners.stops and len(index) > 1:
        gain = gain / 2
    reached = np.minimum(wanted, np.sqrt(gain * length))
    first, last = _blends(along, length, gain, reached, corners)
    starts, speed = _starts(length, gain, wanted, first, last)
    result.seconds[index] = np.diff(starts)
    # as the path is measured elsewhere, with the ways of A and B in it
    result.speed[1:][index] = np.append(speed, 0.0) * path_length(steps, limits) / length
    if len(index) > 1:
        change = np.abs(np.diff(along, axis=0))
        time = speed / gain[:-1]
        way = speed * time / 8
        way[-1] *= _BEFORE_STOP
        result.rounded[index[:-1]] = np.linalg.norm(change[:, :3], axis=1) * way
        result.turned[index[:-1]] = change[:, 3:].max(axis=1) * way
    return result


def _blends(
    along: np.ndarray, length: np.ndarray, gain: np.ndarray, reached: np.ndarray, corners: RoundedCorners
) -> tuple[np.ndarray, np.ndarray]:
    """Speeds (n-1,) of the first block as a blend begins, and of the next one as it ends."""
    if corners.stops:
        return np.zeros(len(length) - 1), np.zeros(len(length) - 1)
    lasts, start = length / reached, reached / gain
    time = np.minimum(np.minimum(lasts[:-1], lasts[1:]), np.maximum(start[:-1], start[1:]))
    first, last = np.minimum(reached[:-1], time * gain[:-1]), np.minimum(reached[1:], time * gain[1:])
    unit = along[:, :3] / np.maximum(np.linalg.norm(along[:, :3], axis=1), 1e-12)[:, None]
    cosine = np.cos(np.arccos(np.clip(-np.einsum("nk,nk->n", unit[:-1], unit[1:]), -1.0, 1.0)) / 2)
    with np.errstate(divide="ignore"):
        within = 2.0 * np.sqrt(gain[:-1] * corners.linear / cosine)
    within = np.where(cosine > _STRAIGHT, within, np.inf)
    return np.minimum(first, within), np.minimum(last, within)


def _starts(
    length: np.ndarray, gain: np.ndarray, wanted: np.ndarray, first: np.ndarray, last: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """When each block begins (n+1,), the last one when all stands, and the speeds (n-1,) at which blends begin."""
    starts, now, entered, blending = [0.0], 0.0, 0.0, 0.0
    speeds = []
    for k, (way, a, v) in enumerate(zip(length.tolist(), gain.tolist(), wanted.tolist(), strict=True)):
        left = max(way - entered * blending / 2, 0.0)
        peak = min(v, math.sqrt(a * left + entered**2 / 2))
        cruise = max(left - (peak**2 - entered**2) / (2 * a) - peak**2 / (2 * a), 0.0)
        leaves = min(float(first[k]), peak) if k < len(first) else 0.0
        now = now + blending + max(peak - entered, 0.0) / a + cruise / max(peak, 1e-12) + (peak - leaves) / a
        if k < len(first):
            speeds.append(leaves)
            entered = float(last[k]) * (leaves / float(first[k]) if first[k] else 0.0)
            blending = leaves / a
        starts.append(now)
    return np.array(starts), np.array(speeds)
