"""One full compensation against scipy on the same compiled surface, and against the route a user would write by hand.

All three explain the same 90 deviations of 50 um by the same nine settings, to the same residual. By hand means: a
residual in NumPy around one fsolve per point, through CasADi from Python, and finite differences of it.
"""

from __future__ import annotations

import time
import timeit

import casadi as ca
import numpy as np
import pytest
from scipy.optimize import fsolve, least_squares

from gearmath.bevel.flank import blank_grid, solve_flank
from gearmath.bevel.identify.compensation import identify, with_deviations
from gearmath.bevel.identify.identification import spread
from gearmath.bevel.identify.on_line import flank_on_line
from gearmath.bevel.identify.problem import Problem
from gearmath.bevel.identify.variables import FREE, variables_of
from gearmath.export.host import compile_kernel
from gearmath.kernels import kernel
from gearmath.quality.correction.target import target_of
from gearmath.specs.bevel_set import FLANKS, SETTINGS, load_bevel_set
from gearmath.specs.toml import bundled

NINE = (*FREE, "cutter_tilt", "work_rotation_offset")
#: RMS that all three reach. [mm]
REACHED = 1e-7


def problem(rows: int = 5, columns: int = 9) -> tuple[list, tuple]:
    """Targets of both flanks of the gear with errors of 50 um, and the variables."""
    gear = load_bevel_set(bundled("nasa_tp3096_12x36.toml")).gear
    grid = blank_grid(gear, rows, columns)
    targets = [target_of(gear, flank, solve_flank(gear, flank, grid)) for flank in FLANKS]
    variables = variables_of(NINE, 2)
    errors = np.random.default_rng(0).uniform(-1, 1, len(NINE)) * [variable.bound for variable in variables]
    errors *= 0.01
    clean = Problem(targets, variables, None, None)
    for _ in range(3):
        left, _ = clean.deviations(errors / clean.scale)
        errors *= 0.05 / np.abs(left).max()
    return with_deviations(targets, left), variables


def by_scipy(targets: list, variables: tuple) -> np.ndarray:
    """Finite differences of the compiled surface, trust region reflective."""
    scale = np.array([variable.bound for variable in variables])
    measured = np.concatenate([target.deviation for target in targets])
    compiled = compile_kernel(flank_on_line())

    def residual(v: np.ndarray) -> np.ndarray:
        parts = []
        for target in targets:
            settings = target.settings.copy()
            settings[[variable.index for variable in variables]] += v * scale
            at = target.nominal
            parts.append(compiled(at.contact, settings, target.how.side, at.point, at.normal)[1])
        return np.concatenate(parts) - measured

    bounds = (-np.ones(len(scale)), np.ones(len(scale)))
    return least_squares(residual, np.zeros(len(scale)), bounds=bounds, xtol=1e-15, ftol=1e-15, gtol=1e-15).fun


def by_hand(targets: list, variables: tuple) -> tuple[np.ndarray, int]:
    """One fsolve per point for u, β, θ and the distance on the normal; Gauss-Newton with finite differences."""
    w, x, side, p, n = (ca.SX.sym(name, size) for name, size in zip("wxspn", (4, 12, 1, 3, 3), strict=True))
    point, _ = kernel("flank_family").function(w[0], w[1], w[2], x, side)
    meshing = kernel("meshing").function(w[0], w[1], w[2], x, side)
    function = ca.Function("f", [w, x, side, p, n], [ca.vertcat(point - p - w[3] * n, meshing / x[0])])
    scale = np.array([variable.bound for variable in variables])

    def residual(v: np.ndarray) -> np.ndarray:
        values = []
        for k, target in enumerate(targets):
            settings = target.settings + spread(variables, v * scale, k)[: len(SETTINGS)]
            for contact, point, normal, measured in zip(*vars(target.nominal).values(), target.deviation, strict=True):
                given = (settings, target.how.side, point, normal)
                start = np.append(contact, 0.0)
                found = fsolve(lambda w, g=given: np.asarray(function(w, *g)).ravel(), start, xtol=1e-13)
                values.append(found[3] - measured)
        return np.array(values)

    v, h, calls = np.zeros(len(scale)), 1e-5, 1
    left = residual(v)
    while np.sqrt(np.mean(left**2)) > REACHED and calls < 200:
        steps = h * np.eye(len(v))
        jacobian = np.stack([(residual(v + step) - left) / h for step in steps], axis=1)
        v = v - np.linalg.lstsq(jacobian, left, rcond=1e-8)[0]
        left, calls = residual(v), calls + len(v) + 1
    return left, calls


@pytest.mark.benchmark(group="compensation")
def test_one_compensation_against_scipy_and_by_hand(benchmark, host_compiler) -> None:
    targets, variables = problem()
    found = benchmark(identify, targets, NINE)
    assert found.converged
    assert found.rms_after <= REACHED
    ours = min(timeit.repeat(lambda: identify(targets, NINE), number=5, repeat=5)) / 5
    theirs = min(timeit.repeat(lambda: by_scipy(targets, variables), number=1, repeat=3))
    assert np.sqrt(np.mean(by_scipy(targets, variables) ** 2)) <= REACHED
    begin = time.perf_counter()
    left, calls = by_hand(targets, variables)
    hand = time.perf_counter() - begin
    assert np.sqrt(np.mean(left**2)) <= REACHED
    dense = {}
    for rows, columns in ((5, 9), (10, 18), (20, 36), (40, 72)):
        many, _ = problem(rows, columns)
        dense[rows * columns] = min(timeit.repeat(lambda many=many: identify(many, NINE), number=1, repeat=3))
    benchmark.extra_info.update(ratio_to_scipy=round(theirs / ours, 1), ratio_to_hand=round(hand / ours))
    print(
        f"\ncompensation: {ours * 1e3:.2f} ms in {found.iterations} steps; scipy {theirs * 1e3:.1f} ms, by hand "
        f"{hand:.2f} s in {calls} residuals; ratios {theirs / ours:.1f} and {hand / ours:.0f}; per point "
        + ", ".join(f"{seconds / count / 2 * 1e6:.1f} us of {count}" for count, seconds in dense.items())
    )


@pytest.mark.benchmark(group="compensation")
def test_a_design_target_against_scipy(benchmark, host_compiler) -> None:
    """An ease-off of 75 um on a pinion flank by twelve settings, root within 25 um; scipy from one start."""
    pinion = load_bevel_set(bundled("nasa_tp3096_12x36.toml")).pinion
    y, x = (index.ravel() * 2.0 / (n - 1) - 1 for index, n in zip(np.indices((5, 9)), (5, 9), strict=True))
    target = target_of(pinion, "convex", solve_flank(pinion, "convex", blank_grid(pinion)))
    (target,) = with_deviations([target], -0.075 * (0.4 * x**2 + 0.25 * y**2 + 0.35 * x * y))
    names = (
        *FREE,
        "cutter_tilt",
        "cutter_swivel",
        "blade_point_radius",
        "blade_pressure_angle",
        "blade_spheric_radius",
    )
    found = benchmark(identify, [target], names, root_limit=0.025, bounds="design")
    assert found.rms_after <= 2.2e-3
    problem = Problem([target], found.variables, None, 0.025)
    low, high = problem.bounds

    def there(v: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        nowhere = np.full(47, 1.0), np.zeros((47, len(v)))  # no surface: too large, and flat
        return problem(v) or nowhere

    def theirs() -> np.ndarray:
        return least_squares(
            lambda v: there(v)[0],
            np.zeros(len(low)),
            lambda v: there(v)[1],
            bounds=(low, high),
            x_scale="jac",
            max_nfev=200,
        ).fun

    ours = min(timeit.repeat(lambda: identify([target], names, root_limit=0.025, bounds="design"), number=1, repeat=10))
    begin = time.perf_counter()
    left = np.sqrt(np.mean(theirs()[:45] ** 2))
    scipy = time.perf_counter() - begin
    benchmark.extra_info.update(ratio_to_scipy=round(scipy / ours, 1), rms_um=round(found.rms_after * 1e3, 3))
    print(
        f"\ndesign target: {ours * 1e3:.0f} ms, {found.iterations} steps, {found.rms_after * 1e3:.2f} um left of "
        f"{found.rms_before * 1e3:.1f} um; scipy {scipy * 1e3:.0f} ms, {left * 1e3:.2f} um; ratio {scipy / ours:.1f}"
    )
