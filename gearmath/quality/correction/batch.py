"""The same identification for many measurements of the same points: in blocks of draws, or as one Kernel to be mapped.

Both solve the problem of :func:`gearmath.bevel.identify.compensation.identify` on the exact surface, for studies of
noise.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np

from derivations import Quantity
from gearmath.bevel.identify.bounded_step import FLOOR, compensation_step
from gearmath.bevel.identify.deviation_surface import surface_map
from gearmath.bevel.identify.flank_target import FlankTarget, located
from gearmath.bevel.identify.least_squares import enough, next_damping
from gearmath.bevel.identify.on_line import flank_on_line
from gearmath.bevel.identify.problem import Problem
from gearmath.bevel.identify.variables import FREE, variables_of
from gearmath.engine.kernel import Kernel
from gearmath.errors import ComputationError
from gearmath.specs.bevel_set import SETTINGS

#: Draws that are solved together: what the arrays of one block hold stays in the cache.
_BLOCK = 200
_MOST_ITERATIONS = 40
#: Steps of the Kernel: undamped steps from a start close by need three.
_STEPS = 4


@dataclass(frozen=True)
class Draws:
    """What was identified from each of d measurements: values (d,p) [mm, rad], what they leave (d,m) [mm], and whether
    each converged (d,)."""

    values: np.ndarray
    residual: np.ndarray
    converged: np.ndarray


def identify_many(
    targets: Sequence[FlankTarget],
    deviations: np.ndarray,
    free: Sequence[str] = FREE,
    *,
    objective: str = "points",
    weights: np.ndarray | None = None,
    start: np.ndarray | None = None,
    noise: float = 0.0,
) -> Draws:
    """The errors that explain each of many measurements ``deviations`` (d,m) [mm] of the points of some targets.

    ``start`` (p,) [mm, rad] is where all of them begin, by default at no error; the rest is as in ``identify``. The
    root line is not held. A draw that does not converge is marked.
    """
    variables = variables_of(free, len(targets))
    problem = Problem(targets, variables, None, None, noise)
    weighting = surface_map(targets, weights) if objective == "surface" else None
    first = np.zeros(len(variables)) if start is None else start / problem.scale
    blocks = [
        _solve_block(problem, weighting, deviations[k : k + _BLOCK], first) for k in range(0, len(deviations), _BLOCK)
    ]
    return Draws(*(np.concatenate([getattr(b, name) for b in blocks]) for name in ("values", "residual", "converged")))


def _solve_block(problem: Problem, weighting: np.ndarray | None, deviations: np.ndarray, first: np.ndarray) -> Draws:
    """Levenberg-Marquardt of all draws of a block at once, each with its own damping."""
    d, p = len(deviations), len(first)
    step, low, high = compensation_step(p), -np.ones(p), np.ones(p)
    v, damping = np.tile(first, (d, 1)), np.full(d, FLOOR)
    residual, jacobian, found = _residuals(problem, v, deviations)
    if not found.all():
        raise ComputationError("the flank at the start does not cross the normals of all points")
    open_, converged = np.arange(d), np.zeros(d, dtype=bool)
    for _ in range(_MOST_ITERATIONS):
        r, J = _weighted(problem, weighting, v[open_], residual[open_], jacobian[open_])
        A, g, cost = np.einsum("dmp,dmq->dpq", J, J), np.einsum("dmp,dm->dp", J, r), np.sum(r**2, axis=1)
        _, possible = step(A, g, v[open_], low, high, np.full(len(open_), FLOOR))
        done = enough(possible, cost, r.shape[1])
        converged[open_[done]] = True
        going = ~done
        open_, A, g, cost = open_[going], A[going], g[going], cost[going]
        if not len(open_):
            break
        change, promised = step(A, g, v[open_], low, high, damping[open_])
        there = np.clip(v[open_] + change, low, high)
        tried, slopes, found = _residuals(problem, np.nan_to_num(there), deviations[open_])
        r, _ = _weighted(problem, weighting, there, tried, slopes)
        gained = np.where(found & np.isfinite(change).all(axis=1), cost - np.sum(r**2, axis=1), -np.inf)
        damping[open_] = [next_damping(*one) for one in zip(damping[open_], gained, promised, strict=True)]
        better = gained > 0
        at = open_[better]
        v[at], residual[at], jacobian[at] = there[better], tried[better], slopes[better]
    return Draws(v * problem.scale, residual, converged)


def _weighted(
    problem: Problem, weighting: np.ndarray | None, v: np.ndarray, residual: np.ndarray, jacobian: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """What is minimised (d,c) and its Jacobian (d,c,p): the coefficients, if asked for, and the changes as noise."""
    if weighting is not None:
        residual, jacobian = residual @ weighting.T, np.einsum("cm,dmp->dcp", weighting, jacobian)
    if not problem.noise:
        return residual, jacobian
    rows = np.broadcast_to(problem.noise * np.eye(v.shape[1]), (len(v), v.shape[1], v.shape[1]))
    return np.concatenate([residual, problem.noise * v], axis=1), np.concatenate([jacobian, rows], axis=1)


def _residuals(problem: Problem, v: np.ndarray, deviations: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Residuals (d,m), Jacobians (d,m,p), and which draws (d,) were found at all their points, for variables (d,p)."""
    d, parts, slopes = len(v), [], []
    found = np.ones(d, dtype=bool)
    for k, target in enumerate(problem.targets):
        n = len(target.nominal.point)
        vectors = np.repeat(target.vector + problem.change(v, k), n, axis=0)
        deviation, gradient, failed = located(target.repeated(d), vectors, problem.moving, problem.bending)
        parts.append(deviation.reshape(d, n))
        slopes.append(problem.columns(gradient, k).reshape(d, n, -1))
        found &= ~failed.reshape(d, n).any(axis=1)
    return np.concatenate(parts, axis=1) - deviations, np.concatenate(slopes, axis=1), found


def compensation_kernel(
    targets: Sequence[FlankTarget], free: Sequence[str] = FREE, noise: float = 0.0, steps: int = _STEPS
) -> Kernel:
    """Kernel: measured deviations (m,) and start values (p,) in; identified errors and what they leave out.

    A fixed number of undamped steps on the exact surface within the bounds, so that it can be mapped, on threads too,
    compiled and differentiated. Meant for measurements close to the start: what is left says whether it was enough.
    ``noise`` [mm] as in ``identify``; settings only, no motions.
    """
    variables = variables_of(free, len(targets))
    if any(variable.index >= len(SETTINGS) for variable in variables):
        raise ValueError("compensation_kernel: free settings only, no coefficients of a motion")
    problem = Problem(targets, variables, None, None)
    m, p = len(problem.measured), len(variables)
    quantities = (
        Quantity(
            "measured",
            "measured deviations of all targets, one after the other",
            "mm",
            r"\boldsymbol\delta",
            shape=(m,),
        ),
        Quantity("start", "errors to start from", "mixed", r"\mathbf{e}_0", shape=(p,)),
    )
    measured, start = (ca.MX.sym(quantity.name, quantity.size) for quantity in quantities)
    v, ones = start / problem.scale, ca.DM.ones(p)
    for _ in range(steps):
        residual, jacobian = _residual_graph(problem, v, measured)
        change, _ = compensation_step(p).function(
            jacobian.T @ jacobian + noise**2 * ca.DM.eye(p), jacobian.T @ residual + noise**2 * v, v, -ones, ones, FLOOR
        )
        v = ca.fmin(ca.fmax(v + change, -ones), ones)
    residual, _ = _residual_graph(problem, v, measured)
    outputs = (
        Quantity("identified", "errors that explain the measurement", "mixed", r"\mathbf{e}", shape=(p,)),
        Quantity("remaining", "predicted less measured deviations", "mm", r"\mathbf{r}", shape=(m,)),
    )
    function = ca.Function(
        "compensation",
        [measured, start],
        [v * problem.scale, residual],
        [quantity.name for quantity in quantities],
        [quantity.name for quantity in outputs],
    )
    return Kernel(
        function,
        f"Errors of {p} settings that explain the deviations at {m} points, in {steps} steps.",
        quantities,
        outputs,
        "compensation_step on flank_on_line",
    )


def _residual_graph(problem: Problem, v: ca.MX, measured: ca.MX) -> tuple[ca.MX, ca.MX]:
    """Residuals (m,) and Jacobian (m,p) as a graph of the scaled variables."""
    residuals, jacobians = [], []
    for k, target in enumerate(problem.targets):
        nominal, n = target.nominal, len(target.nominal.point)
        scale = np.zeros((len(SETTINGS), len(problem.variables)))
        for column, variable in enumerate(problem.variables):
            if variable.target in (None, k):
                scale[variable.index, column] = problem.scale[column]
        settings = target.settings + ca.mtimes(ca.DM(scale), v)
        given: list[Any] = [settings, *map(_shared, target.given(target.vector, target.kind)[1:])]
        repeated = [ca.repmat(value, 1, n) for value in given]
        points = (nominal.contact.T, *repeated, nominal.point.T, nominal.normal.T)
        _, deviation, gradient, _ = flank_on_line(target.kind).function.map(n)(*points)
        residuals.append(deviation.T)
        jacobians.append(ca.mtimes(gradient[: len(SETTINGS), :].T, ca.DM(scale)))
    return ca.vertcat(*residuals) - measured, ca.vertcat(*jacobians)


def _shared(value: np.ndarray | float) -> ca.DM:
    return ca.DM(np.asarray(value, dtype=float))
