"""How fast a control with look-ahead runs along a path: speed, acceleration, jerk of the axes, tolerance of corners.

The path is a row of straight parts. Its length counts a degree as a mm; the speed v along it is sought at the ends of
all parts. With the unit vectors u of the axes along the parts, a corner asks the axes for a change v (u' - u). It is
rounded by constant acceleration within the time T: T = max v |u' - u|/a, more with a jerk j, and the rounding is off
the corner by v |u' - u| T/8. So the tolerance bounds v at a corner, and so do both of its parts, which must be long
enough for half of T each. Within a block of POLY there are no corners; there the bend of the path asks for
acceleration and jerk. Between these bounds the speed rises and falls as the slowest axis allows; with a jerk it is
smoothed over the time that the acceleration takes to come up, as a filter of the set points does it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from gearmath.specs.milling_machine import AxisLimits

#: Parts in which each straight part is followed, so that speed may rise and fall within it.
_PARTS = 16
#: Slower than this the path stands still; it is nothing beside any feed. [mm/s]
_LEAST = 1e-6
#: Times that the bounds at corners are lowered by what smoothing adds to them.
_SMOOTHED = 6


@dataclass(frozen=True)
class RoundedCorners:
    """What the path mode allows at corners: of X Y Z together [mm], of each rotary axis [rad]; 0 is an exact stop."""

    linear: float
    turning: float

    @property
    def stops(self) -> bool:
        """Whether every block ends at a standstill."""
        return self.linear == 0.0


@dataclass(frozen=True)
class FollowedRun:
    """A run from standstill to standstill: seconds of each of its parts (n,), speed (n+1,) at their ends [mm/s].

    ``rounded`` and ``turned`` (n-1,) are how far X Y Z [mm] and the rotary axes [rad] leave the corners.
    """

    seconds: np.ndarray
    speed: np.ndarray
    rounded: np.ndarray
    turned: np.ndarray


def follow(
    where: np.ndarray, asked: np.ndarray, curved: np.ndarray, limits: AxisLimits, corners: RoundedCorners
) -> FollowedRun:
    """Run along positions (n+1,k) [mm, rad], whose parts should take ``asked`` (n,) s; standstill at both ends.

    ``curved`` (n-1,) says which inner positions lie within a block of POLY. Parts without a way take no time.
    """
    steps = np.diff(where, axis=0)
    length = path_length(steps, limits)
    moves = length > 0.0
    seconds, speed = np.zeros(len(steps)), np.zeros(len(steps) + 1)
    rounded, turned = np.zeros(max(len(steps) - 1, 0)), np.zeros(max(len(steps) - 1, 0))
    if not moves.any():
        return FollowedRun(seconds, speed, rounded, turned)
    index = np.flatnonzero(moves)
    steps, length = steps[moves], length[moves]
    along = steps / length[:, None]
    inner = curved[index[:-1]] if len(index) > 1 else np.zeros(0, dtype=bool)
    with np.errstate(divide="ignore"):
        highest = np.minimum(length / np.maximum(asked[moves], 1e-9), (limits.max_speed / np.abs(along)).min(axis=1))
        gain = (limits.max_acceleration / np.abs(along)).min(axis=1)
        rise = (limits.max_jerk / np.abs(along)).min(axis=1)
    bound = _corner_speeds(along, length, inner, limits, corners)
    delay = float((gain / rise).max())
    at_ends = np.concatenate([[0.0], np.minimum(bound, np.minimum(highest[1:], highest[:-1])), [0.0]])
    taken, reached = _timed(at_ends, length, highest, gain, delay)
    seconds[index] = taken
    speed[1:][index] = reached[1:]
    if len(index) > 1:
        off, turn = _rounding(along, reached[1:-1], inner, limits)
        rounded[index[:-1]], turned[index[:-1]] = off, turn
    return FollowedRun(seconds, speed, rounded, turned)


def path_length(steps: np.ndarray, limits: AxisLimits) -> np.ndarray:
    """Lengths (n,) of ways (n,k) of the axes: a degree counts as a mm."""
    return np.linalg.norm(steps * limits.scale, axis=1)


def _change_time(change: np.ndarray, limits: AxisLimits) -> np.ndarray:
    """Time (n,) in which axes change their speeds by so much (n,k), from and to a constant speed."""
    by_acceleration = change / limits.max_acceleration
    to_full = limits.max_acceleration / limits.max_jerk
    short = np.sqrt(change / limits.max_jerk) * 2
    return np.where(by_acceleration >= to_full, by_acceleration + to_full, short).max(axis=1)


def _corner_speeds(
    along: np.ndarray, length: np.ndarray, inner: np.ndarray, limits: AxisLimits, corners: RoundedCorners
) -> np.ndarray:
    """Highest speeds (n-1,) at the ends between parts: 0 where the path mode asks for an exact stop."""
    change = np.abs(np.diff(along, axis=0))
    shorter = np.minimum(length[1:], length[:-1])
    apart = (length[1:] + length[:-1]) / 2
    with np.errstate(divide="ignore", invalid="ignore"):
        # within a block of POLY: v² times the curvature is an acceleration, v³ times its change a jerk
        bent = change / apart[:, None]
        smooth = np.sqrt((limits.max_acceleration / bent).min(axis=1))
        third = np.abs(np.diff(np.diff(along, axis=0) / apart[:, None], axis=0)) / length[1:-1, None]
        jerk = np.cbrt((limits.max_jerk / third).min(axis=1))
    known = inner[1:] & inner[:-1]
    jerk = np.where(known, jerk, np.inf)
    smooth = np.minimum(smooth, np.minimum(np.append(jerk, np.inf), np.insert(jerk, 0, np.inf)))
    if corners.stops:
        return np.where(inner, smooth, 0.0)
    sharp = _by_bisection(change, shorter, limits, corners)
    return np.where(inner, smooth, sharp)


def _by_bisection(change: np.ndarray, shorter: np.ndarray, limits: AxisLimits, corners: RoundedCorners) -> np.ndarray:
    """Highest speeds (n,) at corners with changes (n,k) of the unit vectors, beside parts that are ``shorter`` (n,)."""
    low, high = np.full(len(change), _LEAST), np.full(len(change), 1e6)
    linear = np.linalg.norm(change[:, :3], axis=1)
    turning = change[:, 3:].max(axis=1)
    for _ in range(60):
        middle = np.sqrt(low * high)
        time = _change_time(change * middle[:, None], limits)
        fits = (linear * middle * time / 8 <= corners.linear) & (turning * middle * time / 8 <= corners.turning)
        fits &= time * middle <= shorter
        low, high = np.where(fits, middle, low), np.where(fits, high, middle)
    return np.where(change.any(axis=1), low, np.inf)


def _rounding(
    along: np.ndarray, speed: np.ndarray, inner: np.ndarray, limits: AxisLimits
) -> tuple[np.ndarray, np.ndarray]:
    """How far X Y Z [mm] and rotary axes [rad] leave corners (n,) at these speeds; 0 within a block of POLY."""
    change = np.abs(np.diff(along, axis=0)) * speed[:, None]
    time = np.where(inner, 0.0, _change_time(change, limits))
    return np.linalg.norm(change[:, :3], axis=1) * time / 8, change[:, 3:].max(axis=1) * time / 8


def _timed(
    at_ends: np.ndarray, length: np.ndarray, highest: np.ndarray, gain: np.ndarray, delay: float
) -> tuple[np.ndarray, np.ndarray]:
    """Seconds (n,) of parts and speeds (n+1,) at their ends that keep the bounds ``at_ends`` (n+1,).

    ``delay`` [s] is the time in which the acceleration comes up: the speed is its mean over that time, and a stop takes
    so much longer. What smoothing adds to the speed at a corner is taken off its bound before.
    """
    cells = np.repeat(length / _PARTS, _PARTS)
    corner = np.arange(len(length) + 1) * _PARTS
    bound = at_ends.copy()
    for _ in range(_SMOOTHED if delay > 0.0 else 1):
        speed = _passes(bound, cells, highest, gain)
        seconds = _seconds(speed, cells, gain)
        if delay == 0.0:
            break
        smooth = _mean_over(speed, seconds, delay)
        over = smooth[corner] > at_ends * (1 + 1e-3)
        over[[0, -1]] = False
        if not over.any():
            break
        bound = np.where(over, bound * np.maximum(at_ends / np.maximum(smooth[corner], _LEAST), 0.5), bound)
    reached = speed[corner] if delay == 0.0 else np.minimum(_mean_over(speed, seconds, delay)[corner], at_ends)
    each = seconds.reshape(-1, _PARTS).sum(axis=1)
    stops = (at_ends[:-1] == 0.0) | (at_ends[1:] == 0.0)
    each = each + delay / 2 * ((at_ends[:-1] == 0.0).astype(float) + (at_ends[1:] == 0.0)) * stops
    return each, reached


def _passes(bound: np.ndarray, cells: np.ndarray, highest: np.ndarray, gain: np.ndarray) -> np.ndarray:
    """Speeds at the ends of the cells: forwards as they may rise, backwards as they may fall."""
    squared = np.repeat(highest, _PARTS) ** 2
    squared = np.append(squared, squared[-1])
    squared[1:-1] = np.minimum(squared[1:-1], squared[:-2])
    corner = np.arange(len(bound)) * _PARTS
    squared[corner] = np.minimum(squared[corner], bound**2)
    gained = (2.0 * np.repeat(gain, _PARTS) * cells).tolist()
    values = squared.tolist()
    for k, more in enumerate(gained):
        if values[k] + more < values[k + 1]:
            values[k + 1] = values[k] + more
    for k in range(len(gained) - 1, -1, -1):
        if values[k + 1] + gained[k] < values[k]:
            values[k] = values[k + 1] + gained[k]
    return np.sqrt(np.array(values))


def _seconds(speed: np.ndarray, cells: np.ndarray, gain: np.ndarray) -> np.ndarray:
    """Time (n,) in each cell, its speed changing evenly; a cell from standstill to standstill rises and falls."""
    mean = (speed[1:] + speed[:-1]) / 2
    alone = 2.0 * np.sqrt(cells / np.repeat(gain, _PARTS))
    return np.where(mean > _LEAST, cells / np.maximum(mean, _LEAST), alone)


def _mean_over(speed: np.ndarray, seconds: np.ndarray, delay: float) -> np.ndarray:
    """The speed at the ends of the cells as its mean over ``delay`` around them; still before and after the run."""
    time = np.concatenate([[0.0], np.cumsum(seconds)])
    way = np.concatenate([[0.0], np.cumsum(seconds * (speed[1:] + speed[:-1]) / 2)])
    return (np.interp(time + delay / 2, time, way) - np.interp(time - delay / 2, time, way)) / delay
