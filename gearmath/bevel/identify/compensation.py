"""Compensation: which settings of a machine explain measured deviations, or leave wanted ones.

A bounded Levenberg-Marquardt iteration makes t(x) of :mod:`gearmath.bevel.identify.flank_target` equal to the
deviations of the targets, on the exact surface.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from gearmath.bevel.identify.deviation_surface import surface_map
from gearmath.bevel.identify.flank_target import FlankTarget, located
from gearmath.bevel.identify.identification import Identification
from gearmath.bevel.identify.least_squares import minimize
from gearmath.bevel.identify.problem import Problem
from gearmath.bevel.identify.variables import FREE, Bounds, variables_of

#: With noise, what improves the sum of squares by less than this part of its square is no improvement.
_MATTERS = 1e-6


def identify(
    targets: Sequence[FlankTarget],
    free: Sequence[str] = FREE,
    *,
    objective: str = "points",
    weights: np.ndarray | None = None,
    root_limit: float | None = None,
    noise: float = 0.0,
    bounds: Bounds = "machine",
) -> Identification:
    """The errors, common to all targets, whose exact flanks fit the measured deviations best.

    ``objective`` is "points", or "surface" for the coefficients of the cubic deviation surfaces (6.3) with ``weights``
    (10,). Where targets have a root line, it sinks or rises by at most ``root_limit`` [mm]. ``noise`` [mm] is the
    standard deviation of a measured deviation: with it, a change by a whole bound counts as one deviation of that size,
    so that directions which the flanks show less than the noise are hardly moved. Without noise, only those are left
    alone that the flanks do not show at all (singular value below 1e-6 of the largest).

    ``bounds`` "design" are for a target of tens of micrometres that settings are to be chosen for; "machine" those of
    errors of a machine.

    Bounded Levenberg-Marquardt in variables scaled by their bounds; a step is taken only if it makes the fit better on
    the re-solved surface.
    """
    variables = variables_of(free, [target.vector for target in targets], bounds)
    weighting = surface_map(targets, weights) if objective == "surface" else None
    problem = Problem(targets, variables, weighting, root_limit, noise)
    lower, upper = problem.bounds
    p = len(variables)
    found = minimize(problem, lower, upper, _MATTERS * noise**2)
    v, slack = found.variables[:p], found.variables[p:]
    residual, jacobian = problem.deviations(v)  # type: ignore[misc]
    rms_before, rms_after = (float(np.sqrt(np.mean(values**2))) for values in (problem.measured, residual))
    held = [
        variable.label
        for variable, part, low, high in zip(variables, v, lower[:p], upper[:p], strict=True)
        if not low < part < high
    ]
    held += ["root line"] * bool((np.abs(slack) >= 1).any())
    return Identification(
        variables,
        v * problem.scale,
        rms_before,
        rms_after,
        found.iterations,
        found.converged,
        jacobian,
        residual,
        weighting,
        tuple(held),
        noise,
    )


def nothing_identified(targets: Sequence[FlankTarget]) -> Identification:
    """What was identified where no setting is free: the flanks are as they were set."""
    measured = np.concatenate([target.deviation for target in targets])
    left = np.concatenate([located(target, target.vector, moving=False)[0] for target in targets]) - measured
    before, after = (float(np.sqrt(np.mean(values**2))) for values in (measured, left))
    return Identification((), np.zeros(0), before, after, 0, True, np.zeros((len(measured), 0)), left)


def with_deviations(targets: Sequence[FlankTarget], deviations: np.ndarray) -> list[FlankTarget]:
    """The targets with other deviations (m,), one target after the other."""
    ends = np.cumsum([len(target.deviation) for target in targets])
    pieces = np.split(deviations, ends[:-1])
    return [replace(target, deviation=piece) for target, piece in zip(targets, pieces, strict=True)]
