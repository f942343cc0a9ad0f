"""Block times: a feed at the tooth, held back wherever an axis would be too fast or would have to accelerate too hard.

The blocks at full feed set a clock; the speed at which that clock may run is found at every node. What the path itself
asks of an axis there, by its bends, takes at most half of the acceleration; a forward and a backward pass spend the
other half on getting faster and slower, from standstill to standstill.
"""

from __future__ import annotations

import math

import numpy as np

from gearmath.errors import InputError
from gearmath.kernels import kernel
from gearmath.specs.milling_machine import MillingMachine

#: No block is shorter than this; F has more digits than a control keeps beyond. [s]
SHORTEST = 1e-4


def check_feed(feed_mm_min: float) -> None:
    """Raises InputError for a feed that is not positive."""
    if not (math.isfinite(feed_mm_min) and feed_mm_min > 0):
        raise InputError(f"feed = {feed_mm_min} mm/min: must be greater than 0, and finite")


def block_seconds(axes: np.ndarray, machine: MillingMachine, feed_mm_min: float, tooth: np.ndarray) -> np.ndarray:
    """Duration of the blocks between positions (n,5) of the axes: (n-1,) s.

    ``tooth`` (3,) is the point of the work, in frame w, past which the cutter moves with ``feed_mm_min`` (5.6), or
    slower where an axis reaches its highest speed or acceleration. The blocks begin and end at a standstill. Raises
    InputError for a feed that is not positive.
    """
    check_feed(feed_mm_min)
    (seen,) = kernel("seen_from_tool")(axes, tooth, machine.pivot_height, machine.pivot)
    steps = np.diff(axes, axis=0)
    at_feed = np.linalg.norm(np.diff(seen, axis=0), axis=1) * 60.0 / feed_mm_min
    return paced_seconds(steps, at_feed, machine.max_speed, machine.max_acceleration)


def paced_seconds(
    steps: np.ndarray, at_least: np.ndarray, max_speed: np.ndarray, max_acceleration: np.ndarray
) -> np.ndarray:
    """Duration (n,) [s] of blocks of these steps (n,k): not less than ``at_least`` (n,), and within the limits (k,)."""
    clock = np.maximum(np.maximum(at_least, (np.abs(steps) / max_speed).max(axis=1)), SHORTEST)
    seconds = clock * _slower(steps / clock[:, None], clock, max_acceleration)
    excess = (np.abs(accelerations(steps, seconds)) / max_acceleration).max()
    return seconds * math.sqrt(max(1.0, excess))


def accelerations(steps: np.ndarray, seconds: np.ndarray) -> np.ndarray:
    """Change of speed over time (n,k) between blocks of these steps (n-1,k), a standstill before and after."""
    still = np.zeros((1, steps.shape[1]))
    speeds = np.vstack([still, steps / seconds[:, None], still])
    times = np.concatenate([[0.0], seconds, [0.0]])
    return np.diff(speeds, axis=0) / ((times[1:] + times[:-1]) / 2)[:, None]


def _slower(speeds: np.ndarray, clock: np.ndarray, limit: np.ndarray) -> np.ndarray:
    """By what each block takes longer than its clock time (n-1,), for its speeds (n-1,k) by the clock."""
    n = len(clock)
    bends = np.abs(np.diff(speeds, axis=0)) / ((clock[1:] + clock[:-1]) / 2)[:, None]
    with np.errstate(divide="ignore"):
        bound = np.minimum(1.0, (limit / (2 * bends)).min(axis=1)) if n > 1 else np.empty(0)
        gain = 2 * clock * (limit / (2 * np.abs(speeds))).min(axis=1)
    squared = np.concatenate([[0.0], bound, [0.0]])
    for k in range(n):
        squared[k + 1] = min(squared[k + 1], squared[k] + gain[k])
    for k in reversed(range(n)):
        squared[k] = min(squared[k], squared[k + 1] + gain[k])
    first, last = squared[:-1], squared[1:]
    if n == 1:  # faster in its first part, slower in its last, both the same
        top = np.minimum(1.0, gain / 2)
        return 4.0 * np.sqrt(top) / gain + (1.0 - 2.0 * top / gain) / np.sqrt(top)
    # up to the faster end as soon as the acceleration allows, and on at that rate
    top, low = np.maximum(first, last), np.minimum(first, last)
    return 2.0 * (np.sqrt(top) - np.sqrt(low)) / gain + (1.0 - (top - low) / gain) / np.sqrt(top)
