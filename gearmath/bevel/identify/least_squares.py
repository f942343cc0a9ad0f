"""Bounded, scaled Levenberg-Marquardt with a trust region: the iteration that judges steps.

The variables are scaled by their bounds, so that a change is as large as the part of its bound that it takes. The step
is that of :mod:`gearmath.bevel.identify.bounded_step`, with the damping λ.

λ is the trust region: it falls where the exact residual follows the prediction, and grows where it does not, or where
there is no residual at all. A step along a curved valley leaves its floor: where it does not keep its promise, it is
first led back by steps so damped that the directions which the residuals show move alone, and judged then. λ never
falls below a floor, so that a direction whose singular value is less than 1e-6 of the largest is left alone: among
solutions that fit alike, the one that changes least.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from gearmath.bevel.identify.bounded_step import FLOOR, bounded_step

#: The first step trusts the model this far. Until a step has not kept its promise λ falls fast, afterwards at most by
#: the slow factor; where nothing is gained it grows.
_FIRST, _FAST, _SLOW, _REFUSED = 1e-9, 100, 3, 8
_LARGEST = 1e8
_MOST_ITERATIONS = 120
#: A step that keeps less of its promise says that the valley is curved: at most so many steps lead it back to the
#: floor, each damped so many times more, a further one only if the one before left less than this part.
_KEPT, _BACK, _STIFFER, _FALLS = 0.75, 2, 100.0, 0.25
#: So many steps one after the other that gain next to nothing each: less than this in the RMS [mm], which no probe
#: shows; but never less than the first part of the RMS, nor more than the second. More is not worth larger changes.
_STALLED, _UNSEEN, _IDLE_PARTS = 3, 2.5e-6, (5e-4, 1.5e-3)
#: Converged: an undamped step would change the residual by less than this in the RMS, and less than this part. [mm]
_STILL, _STILL_PART = 1e-10, 1e-7
#: Where a fit stops for another reason, so little in the RMS is nothing that is left. [mm]
_NOTHING = 1e-5
#: To this the residuals are known, rounding of coordinates: what falls of their squares must be more. [mm]
_ROUNDING = 1e-13

Fit = Callable[[np.ndarray], tuple[np.ndarray, np.ndarray] | None]


def enough(possible: np.ndarray | float, cost: np.ndarray | float, residuals: int, matters: float = 0.0) -> np.ndarray:
    """Whether the gradient is as good as zero: what an undamped step could still gain of the sum of squares is noise.

    In the metric of the Jacobian, so that weak directions count by what they do to the residuals.
    """
    least = residuals * _STILL**2 + _STILL_PART**2 * cost + _ROUNDING * np.sqrt(cost)
    return np.abs(possible) <= np.maximum(least, matters)


def next_damping(damping: float, gained: float, promised: np.typing.ArrayLike, curved: bool = False) -> float:
    """The trust region after a step: wider the better it kept its promise, narrower where nothing was gained."""
    if gained <= 0:
        return _REFUSED * damping
    kept = gained / float(np.asarray(promised))
    if kept > _KEPT and damping <= _FIRST and not curved:
        return max(damping / _FAST, FLOOR)
    # Nielsen's rule: smooth, 1 where half of the promise was kept, 2 where none was
    return max(damping * max(1 / _SLOW, 1 - (2 * min(kept, 1.0) - 1) ** 3), FLOOR)


@dataclass(frozen=True)
class Place:
    """Scaled variables (p,), and residual (m,) and Jacobian (m,p) there."""

    variables: np.ndarray
    residual: np.ndarray
    jacobian: np.ndarray

    @cached_property
    def cost(self) -> float:
        """The sum of squares that is left."""
        return float(self.residual @ self.residual)


@dataclass(frozen=True)
class Minimum(Place):
    """The place where a fit ended, the steps tried, and whether it converged."""

    iterations: int
    converged: bool


def minimize(fit: Fit, lower: np.ndarray, upper: np.ndarray, matters: float = 0.0) -> Minimum:
    """The variables within their bounds at which the residuals of ``fit`` are least, found from zero on.

    ``fit`` returns residuals (m,) and their Jacobian (m,p), or None where the surface cannot be found; it must succeed
    at the start. A step is taken only if the exact residual falls, and none is sought that makes the sum of squares
    fall by no more than ``matters``; there are at most ``_MOST_ITERATIONS`` steps. It has converged where the linear
    model has nothing to gain, where ``_STALLED`` steps one after the other gained next to nothing, or where less than
    ``_NOTHING`` is left.
    """
    damping, iterations, curved, idle = _FIRST, 0, False, 0
    at = _place(fit, np.zeros(len(lower)), lower, upper)
    if at is None:
        raise ValueError("there is no residual at the start")
    while iterations < _MOST_ITERATIONS:
        normal = at.jacobian.T @ at.jacobian, at.jacobian.T @ at.residual
        change, promised = bounded_step(*normal, at.variables, lower, upper, damping)
        if idle >= _STALLED or _nothing_to_gain(at, normal, lower, upper, promised, matters):
            return Minimum(at.variables, at.residual, at.jacobian, iterations, True)
        iterations += 1
        wanted = at.cost - _KEPT * promised
        there = _followed(fit, at.variables + change, wanted, lower, upper, damping)
        gained = -np.inf if there is None else at.cost - there.cost
        curved = curved or bool(gained < _KEPT * promised)
        damping = next_damping(damping, gained, promised, curved)
        if there is not None and gained > 0:
            idle = idle + 1 if _is_idle(at, there) else 0
            at = there
        elif damping > _LARGEST:
            break
    converged = at.cost <= len(at.residual) * _NOTHING**2
    return Minimum(at.variables, at.residual, at.jacobian, iterations, converged)


def _nothing_to_gain(
    at: Place,
    normal: tuple[np.ndarray, np.ndarray],
    lower: np.ndarray,
    upper: np.ndarray,
    promised: float,
    matters: float,
) -> bool:
    """Whether an undamped step promises nothing; it promises more than the damped one, which is looked at first."""
    if not enough(promised, at.cost, len(at.residual), matters):
        return False
    _, possible = bounded_step(*normal, at.variables, lower, upper, FLOOR)
    return bool(enough(possible, at.cost, len(at.residual), matters))


def _is_idle(before: Place, after: Place) -> bool:
    """Whether a step gained next to nothing."""
    first, second = (float(np.sqrt(place.cost / len(place.residual))) for place in (before, after))
    least, most = (part * first for part in _IDLE_PARTS)
    return first - second < min(max(_UNSEEN, least), most)


def _followed(
    fit: Fit, there: np.ndarray, wanted: float, lower: np.ndarray, upper: np.ndarray, damping: float
) -> Place | None:
    """Where a step leads to, led back to the floor of its valley where more is left than ``wanted``."""
    found = _place(fit, there, lower, upper)
    for _ in range(_BACK):
        if found is None or found.cost <= wanted:
            break
        normal = found.jacobian.T @ found.jacobian, found.jacobian.T @ found.residual
        back, _ = bounded_step(*normal, found.variables, lower, upper, _STIFFER * damping)
        nearer = _place(fit, found.variables + back, lower, upper)
        if nearer is None or nearer.cost >= found.cost:
            break
        still_falls = nearer.cost <= _FALLS * found.cost
        found = nearer
        if not still_falls:
            break
    return found


def _place(fit: Fit, v: np.ndarray, lower: np.ndarray, upper: np.ndarray) -> Place | None:
    """The residuals at variables, no farther than their bounds; None where there are none."""
    v = np.clip(v, lower, upper)
    found = fit(v) if np.isfinite(v).all() else None
    return None if found is None else Place(v, *found)
