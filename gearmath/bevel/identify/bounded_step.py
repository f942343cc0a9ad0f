"""One step of bounded, scaled least squares: as a Kernel for C and for many at once, and for one problem at a time.

The step solves, by passes that fix what has reached its bound,

    (JᵀJ + λ μ I) s = -Jᵀr,   lower <= v + s <= upper,   μ the mean of the diagonal of JᵀJ

The Kernel makes as many passes as there are variables, which is always enough; ``bounded_step`` stops after the first
that meets no bound, which is mostly the second.
"""

from __future__ import annotations

from functools import cache

import casadi as ca
import numpy as np

from derivations import Quantity
from gearmath.engine.kernel import Kernel

#: Least damping, against the mean of the diagonal of JᵀJ: the square of the singular value that still counts.
FLOOR = 1e-13
#: Stands for infinity in the way to a bound.
_FAR = 1e30
#: Keeps the damping of a matrix of zeros from being zero.
_TINY = 1e-300


def _quantity(name: str, description: str, latex: str, domain: tuple[float, float], *shape: int) -> Quantity:
    return Quantity(name, description, "mixed", latex, domain, shape=shape)


@cache
def bounded_pass(p: int) -> Kernel:
    """Kernel: towards the least squares of p scaled variables as far as the first bound, which then holds.

    Nothing on the way is worse than where it starts.
    """
    matrix, right, low, high = (ca.SX.sym(name, p, width) for name, width in zip("Aglh", (p, 1, 1, 1), strict=True))
    step, fixed = ca.SX.sym("step", p), ca.SX.sym("fixed", p)
    keep = 1 - fixed
    masked = matrix * (keep @ keep.T) + ca.diag(fixed)
    # what is fixed has its place, and pulls at the others through the matrix
    way = _solve(masked, keep * (right - matrix @ (fixed * step)) + fixed * step) - step
    room = ca.if_else(way > 0, high - step, ca.if_else(way < 0, low - step, _FAR))
    ratio = ca.fmax(0, room / ca.if_else(way == 0, 1, way))
    part = ca.fmin(1, ca.mmin(ratio))
    there = ca.fmin(ca.fmax(step + part * way, low), high)
    held = ca.logic_or(fixed, ca.logic_and(ratio <= part, part < 1))
    quantities = (
        _quantity("normal_matrix", "transposed Jacobian times Jacobian, scaled and damped", "A", (-1e4, 1e4), p, p),
        _quantity("descent", "less transposed Jacobian times residuals, scaled", "-g", (-1e4, 1e4), p),
        _quantity("lowest", "least change of the scaled variables", r"\mathbf{s}_-", (-2.0, 2.0), p),
        _quantity("highest", "greatest change of the scaled variables", r"\mathbf{s}_+", (-2.0, 2.0), p),
        _quantity("step", "change of the scaled variables so far", r"\mathbf{s}", (-2.0, 2.0), p),
        _quantity("fixed", "1 where a bound holds the variable", "f", (0.0, 1.0), p),
    )
    outputs = (
        _quantity("next_step", "change of the scaled variables after the pass", r"\mathbf{s}'", (-2.0, 2.0), p),
        _quantity("next_fixed", "1 where a bound holds the variable after the pass", "f'", (0.0, 1.0), p),
        Quantity("part", "how much of the way was gone: 1 where no bound was met", "1", "t", (0.0, 1.0)),
    )
    function = ca.Function(
        "bounded_pass",
        [matrix, right, low, high, step, fixed],
        [there, held, part],
        [quantity.name for quantity in quantities],
        [quantity.name for quantity in outputs],
    )
    return Kernel(function, "One pass of a bounded least-squares step.", quantities, outputs, "primal active set")


@cache
def compensation_step(p: int) -> Kernel:
    """Kernel: one damped least-squares step of p scaled variables within their bounds, and what it promises.

    ``promised`` is what the linear model says that the sum of squared residuals falls by.
    """
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
    damped = A + damping * (ca.trace(A) / p + _TINY) * ca.MX.eye(p)
    low, high = lower - v, upper - v
    fixed = ca.logic_or(ca.logic_and(low >= 0, g >= 0), ca.logic_and(high <= 0, g <= 0))
    step = ca.fmin(ca.fmax(0, low), high)
    for _ in range(p):
        step, fixed, _ = bounded_pass(p).function(damped, -g, low, high, step, fixed)
    function = ca.Function(
        "compensation_step",
        [A, g, v, lower, upper, damping],
        [step, -(2 * ca.dot(g, step) + ca.bilin(A, step, step))],
        [quantity.name for quantity in quantities],
        ["step", "promised"],
    )
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


def bounded_step(
    A: np.ndarray, g: np.ndarray, v: np.ndarray, lower: np.ndarray, upper: np.ndarray, damping: float
) -> tuple[np.ndarray, float]:
    """What ``compensation_step`` returns, of one problem: the step (p,), and the fall of the sum of squares."""
    p = len(g)
    damped = A + damping * (np.trace(A) / p + _TINY) * np.eye(p)
    low, high = lower - v, upper - v
    fixed = ((low >= 0) & (g >= 0) | (high <= 0) & (g <= 0)).astype(float)
    step = np.clip(0.0, low, high)
    for _ in range(p):
        step, fixed, part = bounded_pass(p)(damped, -g, low, high, step, fixed)
        if part >= 1:
            break
    return step, -(2 * float(g @ step) + float(step @ A @ step))
