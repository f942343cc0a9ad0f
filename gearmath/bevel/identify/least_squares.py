"""Bounded, scaled Levenberg-Marquardt with a trust region: one step as a Kernel, and the iteration that judges steps.

The variables are scaled by their bounds, so that a change is as large as the part of its bound that it takes. A step
solves, by passes that fix what has reached its bound,

    (JᵀJ + λ μ I) s = -Jᵀr,   lower <= v + s <= upper,   μ the mean of the diagonal of JᵀJ

λ is the trust region: it falls where the exact residual follows the prediction, and grows where it does not, or where
there is no residual at all. A step along a curved valley leaves its floor: where it does not keep its promise, it is
first led back by steps so damped that the directions which the residuals show move alone, and judged then. λ never
falls below a floor, so that a direction whose singular value is less than 1e-6 of the largest is left alone: among
solutions that fit alike, the one that changes least.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache

import casadi as ca
import numpy as np

from derivations import Quantity
from gearmath.engine.kernel import Kernel

#: Least damping, against the mean of the diagonal of JᵀJ: the square of the singular value that still counts.
FLOOR = 1e-13
#: Stands for infinity in the way to a bound.
_FAR = 1e30
#: The first step trusts the model this far. Until a step has not kept its promise λ falls fast, afterwards at most by
#: the slow factor; where nothing is gained it grows.
_FIRST, _FAST, _SLOW, _REFUSED = 1e-9, 100, 3, 8
_LARGEST = 1e8
_MOST_ITERATIONS = 120
#: A step that keeps less of its promise says that the valley is curved: at most so many steps lead it back to the
#: floor, each damped so many times more, a further one only if the one before left less than this part.
_KEPT, _BACK, _STIFFER, _FALLS = 0.75, 2, 100.0, 0.25
#: So many steps one after the other that gain less than this part of the sum of squares each: nothing more to gain.
_STALLED, _IDLE = 3, 1e-3
#: Converged: an undamped step would change the residual by less than this in the RMS, and less than this part. [mm]
_STILL, _STILL_PART = 1e-10, 1e-7
#: Where a fit stops for another reason, so little in the RMS is nothing that is left. [mm]
_NOTHING = 1e-5
#: To this the residuals are known, rounding of coordinates: what falls of their squares must be more. [mm]
_ROUNDING = 1e-13

Fit = Callable[[np.ndarray], tuple[np.ndarray, np.ndarray] | None]


def _quantity(name: str, description: str, latex: str, domain: tuple[float, float], *shape: int) -> Quantity:
    return Quantity(name, description, "mixed", latex, domain, shape=shape)


@cache
def compensation_step(p: int) -> Kernel:
    """Kernel: one damped least-squares step of p scaled variables within their bounds, and what it promises.

    ``promised`` is what the linear model says that the sum of squared residuals falls by.
    """
    matrix, fixed = ca.SX.sym("matrix", p, p), ca.SX.sym("fixed", p)
    right, place = ca.SX.sym("right", p), ca.SX.sym("place", p)
    keep = 1 - fixed
    masked = matrix * (keep @ keep.T) + ca.diag(fixed)
    # what is fixed has its place, and pulls at the others through the matrix
    solved = _solve(masked, keep * (right - matrix @ (fixed * place)) + fixed * place)
    solve = ca.Function("solve", [matrix, fixed, right, place], [solved])
    quantities = (
        _quantity(
            "normal_matrix", "transposed Jacobian times Jacobian of the residuals, scaled", "J^TJ", (-1e4, 1e4), p, p
        ),
        _quantity("gradient", "transposed Jacobian times residuals, scaled", "J^Tr", (-1e4, 1e4), p),
        _quantity("variables", "scaled variables now", r"\mathbf{v}", (-1.0, 1.0), p),
        _quantity(
            "lower",
            "least scaled variables; as the greatest where a variable is not free",
            r"\mathbf{v}_-",
            (-1.0, 1.0),
            p,
        ),
        _quantity("upper", "greatest scaled variables", r"\mathbf{v}_+", (-1.0, 1.0), p),
        Quantity("damping", "damping against the mean of the diagonal", "1", r"\lambda", (0.0, 1e9)),
    )
    A, g, v, lower, upper, damping = (ca.MX.sym(q.name, *(q.shape or (1,))) for q in quantities)
    damped = A + damping * (ca.trace(A) / p + 1e-300) * ca.MX.eye(p)
    low, high = lower - v, upper - v
    fixed_now = ca.logic_or(ca.logic_and(low >= 0, g >= 0), ca.logic_and(high <= 0, g <= 0))
    step = ca.fmin(ca.fmax(0, low), high)
    for _ in range(p):
        # towards the solution as far as the first bound, which then holds; nothing on the way is worse
        way = solve(damped, fixed_now, -g, step) - step
        room = ca.if_else(way > 0, high - step, ca.if_else(way < 0, low - step, _FAR))
        ratio = ca.fmax(0, room / ca.if_else(way == 0, 1, way))
        part = ca.fmin(1, ca.mmin(ratio))
        step = ca.fmin(ca.fmax(step + part * way, low), high)
        fixed_now = ca.logic_or(fixed_now, ca.logic_and(ratio <= part, part < 1))
    function = ca.Function(
        "compensation_step", [A, g, v, lower, upper, damping],
        [step, -(2 * ca.dot(g, step) + ca.bilin(A, step, step))],
        [quantity.name for quantity in quantities], ["step", "promised"],
    )  # fmt: skip
    return Kernel(
        function,
        f"One bounded Levenberg-Marquardt step of {p} scaled settings, and the fall of the sum of squares it promises.",
        quantities,
        (
            _quantity("step", "change of the scaled variables", r"\mathbf{s}", (-2.0, 2.0), p),
            Quantity("promised", "fall of the sum of squares by the linear model", "mm2", "p"),
        ),
        "Levenberg-Marquardt in scaled variables, primal active set of bounds",
    )


def _solve(matrix: ca.SX, right: ca.SX) -> ca.SX:
    """The solution (p,) of a symmetric definite system by factors L D Lᵀ, without pivots and roots."""
    p = right.shape[0]
    L, D = ca.SX.eye(p), ca.SX.zeros(p)
    for k in range(p):
        scaled = [L[k, j] * D[j] for j in range(k)]
        D[k] = matrix[k, k] - sum((scaled[j] * L[k, j] for j in range(k)), ca.SX(0))
        for i in range(k + 1, p):
            L[i, k] = (matrix[i, k] - sum((scaled[j] * L[i, j] for j in range(k)), ca.SX(0))) / D[k]
    x = [right[k] for k in range(p)]
    for k in range(p):
        x[k] = x[k] - sum((L[k, j] * x[j] for j in range(k)), ca.SX(0))
    x = [x[k] / D[k] for k in range(p)]
    for k in reversed(range(p)):
        x[k] = x[k] - sum((L[j, k] * x[j] for j in range(k + 1, p)), ca.SX(0))
    return ca.vertcat(*x)


def enough(possible: np.ndarray, cost: np.ndarray | float, residuals: int, matters: float = 0.0) -> np.ndarray:
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

    @property
    def cost(self) -> float:
        """The sum of squares that is left."""
        return float(self.residual @ self.residual)


@dataclass(frozen=True)
class Minimum(Place):
    """The place where a fit ended, the steps tried, and whether it converged."""

    iterations: int
    converged: bool


def minimize(
    fit: Fit, lower: np.ndarray, upper: np.ndarray, step: Callable | None = None, matters: float = 0.0
) -> Minimum:
    """The variables within their bounds at which the residuals of ``fit`` are least, found from zero on.

    ``fit`` returns residuals (m,) and their Jacobian (m,p), or None where the surface cannot be found; it must succeed
    at the start. ``step`` is the Kernel of the step, compiled or not. A step is taken only if the exact residual falls,
    and none is sought that makes the sum of squares fall by no more than ``matters``; there are at most
    ``_MOST_ITERATIONS`` steps. It has converged where the linear model has nothing to gain, where ``_STALLED`` steps
    one after the other gained next to nothing, or where less than ``_NOTHING`` is left.
    """
    step = step or compensation_step(len(lower))
    damping, iterations, curved, idle = _FIRST, 0, False, 0
    at = _place(fit, np.zeros(len(lower)), lower, upper)
    if at is None:
        raise ValueError("there is no residual at the start")
    while iterations < _MOST_ITERATIONS:
        normal = at.jacobian.T @ at.jacobian, at.jacobian.T @ at.residual
        _, possible = step(*normal, at.variables, lower, upper, FLOOR)
        if enough(possible, at.cost, len(at.residual), matters) or idle >= _STALLED:
            return Minimum(**vars(at), iterations=iterations, converged=True)
        iterations += 1
        change, promised = step(*normal, at.variables, lower, upper, damping)
        wanted = at.cost - _KEPT * float(promised)
        there = _followed(fit, step, at.variables + change, wanted, lower, upper, damping)
        gained = -np.inf if there is None else at.cost - there.cost
        curved = curved or bool(gained < _KEPT * promised)
        damping = next_damping(damping, gained, promised, curved)
        if there is not None and gained > 0:
            idle = idle + 1 if gained < _IDLE * at.cost else 0
            at = there
        elif damping > _LARGEST:
            break
    converged = at.cost <= len(at.residual) * _NOTHING**2
    return Minimum(**vars(at), iterations=iterations, converged=converged)


def _followed(
    fit: Fit, step: Callable, there: np.ndarray, wanted: float, lower: np.ndarray, upper: np.ndarray, damping: float
) -> Place | None:
    """Where a step leads to, led back to the floor of its valley where more is left than ``wanted``."""
    found = _place(fit, there, lower, upper)
    for _ in range(_BACK):
        if found is None or found.cost <= wanted:
            break
        normal = found.jacobian.T @ found.jacobian, found.jacobian.T @ found.residual
        back, _ = step(*normal, found.variables, lower, upper, _STIFFER * damping)
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
