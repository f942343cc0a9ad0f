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

#: Moments at which the way of a rising or falling speed is known, between which it counts as even.
_KNOTS = 8
#: A way shorter than this is none: far less than an increment. [mm]
NO_WAY = 1e-9
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
    moves = length > NO_WAY
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
    bound = at_ends.copy()
    speed = _passes(bound, length, gain)
    if delay == 0.0:
        return _phases(speed, length, highest, gain)[0].sum(axis=1), speed
    for _ in range(_SMOOTHED):
        smooth = _mean_over(speed, length, highest, gain, delay)
        over = smooth > at_ends * (1 + 1e-3)
        over[[0, -1]] = False
        if not over.any():
            break
        bound = np.where(over, bound * np.maximum(at_ends / np.maximum(smooth, _LEAST), 0.5), bound)
        speed = _passes(bound, length, gain)
    seconds = _phases(speed, length, highest, gain)[0].sum(axis=1)
    stands = at_ends == 0.0
    later = delay / 2 * (stands[:-1].astype(float) + stands[1:])
    return seconds + later, np.minimum(_mean_over(speed, length, highest, gain, delay), at_ends)


def _passes(bound: np.ndarray, length: np.ndarray, gain: np.ndarray) -> np.ndarray:
    """Speeds at the ends of the parts: forwards as they may rise, backwards as they may fall."""
    values, gained = (bound**2).tolist(), (2.0 * gain * length).tolist()
    for k, more in enumerate(gained):
        if values[k] + more < values[k + 1]:
            values[k + 1] = values[k] + more
    for k in range(len(gained) - 1, -1, -1):
        if values[k + 1] + gained[k] < values[k]:
            values[k] = values[k + 1] + gained[k]
    return np.sqrt(np.array(values))


def _phases(
    speed: np.ndarray, length: np.ndarray, highest: np.ndarray, gain: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Seconds (n,3) of rising, running evenly and falling in each part, and the speed (n,) between."""
    first, last = speed[:-1], speed[1:]
    peak = np.minimum(highest, np.sqrt(gain * length + (first**2 + last**2) / 2))
    peak = np.maximum(peak, np.maximum(first, last))
    even = np.maximum(length - (2 * peak**2 - first**2 - last**2) / (2 * gain), 0.0)
    return np.column_stack([(peak - first) / gain, even / np.maximum(peak, _LEAST), (peak - last) / gain]), peak


def _mean_over(
    speed: np.ndarray, length: np.ndarray, highest: np.ndarray, gain: np.ndarray, delay: float
) -> np.ndarray:
    """The speed at the ends of the parts as its mean over ``delay`` around them; still before and after the run."""
    seconds, peak = _phases(speed, length, highest, gain)
    begins = np.column_stack([speed[:-1], peak, peak])
    rates = np.column_stack([gain, np.zeros_like(gain), -gain])
    share = np.arange(_KNOTS) / _KNOTS
    within = seconds[..., None] * share
    way = begins[..., None] * within + rates[..., None] * within**2 / 2
    whole = begins * seconds + rates * seconds**2 / 2
    starts = np.concatenate([[0.0], np.cumsum(seconds.ravel())])
    places = np.concatenate([[0.0], np.cumsum(whole.ravel())])
    time = np.append((starts[:-1].reshape(seconds.shape)[..., None] + within).ravel(), starts[-1])
    place = np.append((places[:-1].reshape(seconds.shape)[..., None] + way).ravel(), places[-1])
    at = starts[::3]
    return (np.interp(at + delay / 2, time, place) - np.interp(at - delay / 2, time, place)) / delay
