"""Bounded, scaled Levenberg-Marquardt with a trust region: one step as a Kernel, and the iteration that judges steps.

The variables are scaled by their bounds, so that a change is as large as the part of its bound that it takes. A step
solves, by passes that fix what has reached its bound,

    (JᵀJ + λ μ I) s = -Jᵀr,   lower <= v + s <= upper,   μ the mean of the diagonal of JᵀJ

λ is the trust region: it falls where the exact residual follows the prediction, and grows where it does not, or where
there is no residual at all. It never falls below a floor, so that a direction whose singular value is less than 1e-6
of the largest is left alone: among solutions that fit alike, the one that changes least.
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
#: The first step trusts the model this far; a step that is refused makes λ at least so large, and until then λ falls
#: fast; afterwards, in a curved valley, slowly.
_FIRST, _REFUSED, _FAST, _SLOW = 1e-9, 1e-7, 100, 4
_LARGEST = 1e8
_MOST_ITERATIONS = 120
#: A step that keeps less of its promise says that the valley is curved. The trial that tells how lies so far ahead, and
#: the answer to it is believed where it is at most so many times as large as the step.
_KEPT, _AHEAD, _BELIEVED = 0.75, 0.1, 1.5
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


def enough(possible: np.ndarray, cost: np.ndarray, residuals: int, matters: float = 0.0) -> np.ndarray:
    """Whether the gradient is as good as zero: what an undamped step could still gain of the sum of squares is noise.

    In the metric of the Jacobian, so that weak directions count by what they do to the residuals.
    """
    least = residuals * _STILL**2 + _STILL_PART**2 * cost + _ROUNDING * np.sqrt(cost)
    return np.abs(possible) <= np.maximum(least, matters)


def next_damping(damping: float, gained: float, promised: np.typing.ArrayLike) -> float:
    """The trust region after a step: wider where the promise was kept, narrower where it was not, or nothing gained."""
    if gained <= 0:
        return max(8 * damping, _REFUSED)
    kept = gained / float(np.asarray(promised))
    if kept > 0.75:
        return max(damping / (_FAST if damping <= _FIRST else _SLOW), FLOOR)
    return 4 * damping if kept < 0.25 else damping


@dataclass(frozen=True)
class Minimum:
    """Scaled variables (p,), residual (m,) and Jacobian (m,p) there, steps tried, and whether it converged."""

    variables: np.ndarray
    residual: np.ndarray
    jacobian: np.ndarray
    iterations: int
    converged: bool

    @property
    def cost(self) -> float:
        """The sum of squares that is left."""
        return float(self.residual @ self.residual)


def minimize(
    fit: Fit, lower: np.ndarray, upper: np.ndarray, step: Callable | None = None, matters: float = 0.0,
    start: np.ndarray | None = None, most: int = _MOST_ITERATIONS,
) -> Minimum:  # fmt: skip
    """The variables within their bounds at which the residuals of ``fit`` are least, from ``start`` or zero on.

    ``fit`` returns residuals (m,) and their Jacobian (m,p), or None where the surface cannot be found; it must succeed
    at the start. ``step`` is the Kernel of the step, compiled or not. A step is taken only if the exact residual falls,
    and none is sought that makes the sum of squares fall by no more than ``matters``. Once a step has not kept its
    promise, the valley is curved, and every step is bent along it; there are at most ``most`` steps. It has converged
    where the linear model has nothing to gain, where ``_STALLED`` steps one after the other gained next to nothing, or
    where less than ``_NOTHING`` is left.
    """
    step = step or compensation_step(len(lower))
    v = np.zeros(len(lower)) if start is None else start
    damping, iterations, curved, idle = _FIRST, 0, False, 0
    found = fit(v)
    if found is None:
        raise ValueError("there is no residual at the start")
    residual, jacobian = found
    while iterations < most:
        cost, matrix, gradient = residual @ residual, jacobian.T @ jacobian, jacobian.T @ residual
        _, possible = step(matrix, gradient, v, lower, upper, FLOOR)
        if enough(possible, cost, len(residual), matters) or idle >= _STALLED:
            return Minimum(v, residual, jacobian, iterations, True)
        iterations += 1
        change, promised = step(matrix, gradient, v, lower, upper, damping)
        if curved and np.isfinite(change).all():
            change = change + _bend(fit, step, v, change, residual, jacobian, matrix, lower, upper, damping)
        there = np.clip(v + change, lower, upper)
        tried = fit(there) if np.isfinite(change).all() else None
        gained = -np.inf if tried is None else cost - tried[0] @ tried[0]
        curved = curved or bool(gained < _KEPT * promised)
        damping = next_damping(damping, gained, promised)
        if tried is not None and gained > 0:
            v, (residual, jacobian) = there, tried
            idle = idle + 1 if gained < _IDLE * cost else 0
        elif damping > _LARGEST:
            break
    return Minimum(v, residual, jacobian, iterations, bool(residual @ residual <= len(residual) * _NOTHING**2))


def _bend(
    fit: Fit, step: Callable, v: np.ndarray, change: np.ndarray, residual: np.ndarray, jacobian: np.ndarray,
    matrix: np.ndarray, lower: np.ndarray, upper: np.ndarray, damping: float,
) -> np.ndarray:  # fmt: skip
    """What follows the second derivative of the residuals along a step: its answer to half of it, the geodesic's.

    The second derivative is from a trial a tenth of the way; an answer as large as the step itself is not believed.
    """
    ahead = fit(np.clip(v + _AHEAD * change, lower, upper))
    if ahead is None:
        return np.zeros_like(change)
    half = ((ahead[0] - residual) / _AHEAD - jacobian @ change) / _AHEAD
    answer, _ = step(matrix, jacobian.T @ half, np.clip(v + change, lower, upper), lower, upper, damping)
    size = np.linalg.norm(answer)
    return answer if size < _BELIEVED * np.linalg.norm(change) else np.zeros_like(change)
