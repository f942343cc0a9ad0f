"""Compensation: which settings the machine behaved as if it had, and the settings that make up for it.

The deviation that settings x leave at a nominal point, along its outward normal n, is found on the exact surface:

    t(x) = (R(u, β, θ; x) - P)·n   with   e1·(R - P) = e2·(R - P) = 0,  f(u, β, θ; x) = 0

for tangents e1, e2 of the nominal flank, and its gradient by the implicit function theorem. A bounded
Levenberg-Marquardt iteration makes t(x) equal to what was measured; the correction takes the difference back.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import casadi as ca
import numpy as np

from derivations import notation
from gearmath.bevel.kernels import kernel
from gearmath.bevel.newton import FlankPoints, contact_guess, newton_step, residual_size
from gearmath.errors import ComputationError
from gearmath.lowering import Kernel
from gearmath.specs.bevel_set import SETTINGS

#: How far a setting may be changed, mm or rad: beyond this something else is wrong with the machine.
BOUNDS = {
    "radial_distance": 1.0, "cradle_angle": 0.02, "blank_offset": 1.0, "sliding_base": 1.0,
    "machine_center_to_crossing_point": 1.0, "machine_root_angle": 0.01, "ratio_of_roll": 0.02,
}  # fmt: skip
#: The settings that are corrected: those of the machine, without tilt; cradle angle stands also for work rotation.
FREE = tuple(BOUNDS)

_NEWTON_STEPS = 6
_LINE_TOLERANCE = 1e-9
_STEP_LIMITS = (1.0, 0.05, 0.05)
_MOST_ITERATIONS = 60
#: Converged when a step changes the predicted deviation by less than this. [mm]
_SMALL_STEP = 1e-9


@cache
def flank_on_line() -> Kernel:
    """Kernel: where the flank of other settings crosses a line, and the gradient of that distance by the settings."""
    w = ca.SX.sym("contact", 3)
    quantities = (notation.settings, notation.side, notation.line_point, notation.line_direction)
    x, side, point, normal = (ca.SX.sym(quantity.name, max(quantity.size, 1)) for quantity in quantities)
    surface, _ = kernel("flank_family").function(w[0], w[1], w[2], x, side)
    off = surface - point
    e1 = ca.vertcat(normal[1], -normal[0], 0) / ca.sqrt(normal[0] ** 2 + normal[1] ** 2)
    e2 = ca.cross(normal, e1)
    meshing = kernel("meshing").function(w[0], w[1], w[2], x, side) / x[0]
    residual = ca.vertcat(ca.dot(e1, off), ca.dot(e2, off), meshing)
    given = [x, side, point, normal]
    step = ca.Function("line_newton_step", [w, *given], [newton_step(residual, w, _STEP_LIMITS)])
    distance = ca.dot(normal, off)
    # dt/dx = t_x - t_w (h_w)^-1 h_x with h the residual: solve the transposed 3x3 system for the multipliers
    multipliers = ca.solve(ca.jacobian(residual, w).T, ca.jacobian(distance, w).T)
    gradient = ca.jacobian(distance, x).T - ca.jacobian(residual, x).T @ multipliers
    final = ca.Function("line_at", [w, *given], [distance, gradient, ca.norm_2(residual)])
    guess, *arguments = (ca.MX.sym(name, size) for name, size in (("w", 3), ("x", 12), ("s", 1), ("p", 3), ("n", 3)))
    solution = guess
    for _ in range(_NEWTON_STEPS):
        solution = step(solution, *arguments)
    function = ca.Function(
        "flank_on_line", [guess, *arguments], [solution, *final(solution, *arguments)],
        ["contact_guess", *(quantity.name for quantity in quantities)],
        ["contact", "deviation", "sensitivity", "residual_size"],
    )  # fmt: skip
    return Kernel(
        function,
        "Deviation at a nominal point of the flank that other settings cut, with its gradient by the settings.",
        (contact_guess, *quantities),
        (notation.contact, notation.deviation, notation.sensitivity, residual_size),
        "(3.1), (4.2) on a line; implicit function theorem",
    )


@dataclass(frozen=True)
class FlankTarget:
    """One measured flank: nominal settings (12,), side, nominal points, measured deviations (n,) [mm]."""

    settings: np.ndarray
    side: int
    nominal: FlankPoints
    deviation: np.ndarray


@dataclass(frozen=True)
class Identification:
    """Setting errors (12,) that explain the measurement; RMS of deviation before and of what they leave [mm]."""

    errors: np.ndarray
    rms_before: float
    rms_after: float
    iterations: int
    singular_values: np.ndarray


def predicted(target: FlankTarget, settings: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Deviation (n,) [mm] that ``settings`` leave at the nominal points, and its gradient (n,12).

    Raises ComputationError if the surface does not cross the normal of one of the points.
    """
    nominal = target.nominal
    _, deviation, gradient, residual = flank_on_line()(
        nominal.contact, settings, target.side, nominal.point, nominal.normal
    )
    failed = ~(residual <= _LINE_TOLERANCE)
    if failed.any():
        raise ComputationError(
            f"the flank of the changed settings does not cross the normal of point {int(np.argmax(failed))}"
        )
    return deviation, gradient


def identify(targets: list[FlankTarget], free: tuple[str, ...] = FREE) -> Identification:
    """The setting errors, common to all targets, whose exact flanks fit the measured deviations best.

    Levenberg-Marquardt in variables scaled by BOUNDS, and kept within them; a step is taken only if it makes the fit
    better on the re-solved surface.
    """
    index = np.array([SETTINGS.index(name) for name in free])
    scale = np.array([BOUNDS[name] for name in free])
    measured = np.concatenate([target.deviation for target in targets])

    def fit(v: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        errors = np.zeros(len(SETTINGS))
        errors[index] = v * scale
        parts = [predicted(target, target.settings + errors) for target in targets]
        jacobian = np.concatenate([gradient[:, index] for _, gradient in parts]) * scale
        return np.concatenate([deviation for deviation, _ in parts]) - measured, jacobian

    v, damping, iterations = np.zeros(len(free)), 1e-6, 0
    residual, jacobian = fit(v)
    singular_values = np.linalg.svd(jacobian, compute_uv=False)
    while iterations < _MOST_ITERATIONS:
        iterations += 1
        normal_matrix = jacobian.T @ jacobian
        ridge = damping * np.trace(normal_matrix) / len(v) * np.eye(len(v))
        step = np.clip(v - np.linalg.solve(normal_matrix + ridge, jacobian.T @ residual), -1, 1) - v
        tried, tried_jacobian = fit(v + step)
        if tried @ tried < residual @ residual:
            change = np.abs(jacobian @ step).max()
            v, residual, jacobian, damping = v + step, tried, tried_jacobian, damping / 10
            if change < _SMALL_STEP:
                break
        else:
            damping *= 10
            if damping > 1e6 or np.abs(jacobian @ step).max() < _SMALL_STEP:
                break
    errors = np.zeros(len(SETTINGS))
    errors[index] = v * scale
    rms_before, rms_after = (float(np.sqrt(np.mean(values**2))) for values in (measured, residual))
    return Identification(errors, rms_before, rms_after, iterations, singular_values)
