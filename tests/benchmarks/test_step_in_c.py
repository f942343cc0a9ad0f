"""One bounded Levenberg-Marquardt step of twelve settings: exported C, VM, scipy, and numpy without bounds."""

from __future__ import annotations

import timeit
from collections.abc import Callable

import numpy as np
import pytest
from scipy.optimize import lsq_linear

from gearmath.bevel.identify.bounded_step import compensation_step
from gearmath.export.host import compile_kernel
from gearmath.specs.bevel_set import SETTINGS

N, P = 300, len(SETTINGS)
DAMPING = 1e-3


@pytest.mark.benchmark(group="one step of twelve settings")
def test_one_step_in_c_against_vm_scipy_and_numpy(benchmark, by_vm: Callable, host_compiler: tuple) -> None:
    generator = np.random.default_rng(5)
    jacobians = generator.normal(size=(N, 90, P)) * 0.05
    residuals = generator.normal(size=(N, 90)) * 0.02
    normal = np.einsum("nki,nkj->nij", jacobians, jacobians)
    gradient = np.einsum("nki,nk->ni", jacobians, residuals)
    v, low, high = np.zeros((N, P)), np.full((N, P), -0.3), np.full((N, P), 0.3)
    compiled, interpreted = compile_kernel(compensation_step(P)), by_vm(compensation_step(P))
    arguments = (normal, gradient, v, low, high, np.full(N, DAMPING))
    steps, _ = benchmark(compiled, *arguments)

    mean = np.einsum("nii->n", normal) / P

    def scipys() -> np.ndarray:
        damped = [np.vstack([jacobians[k], np.sqrt(DAMPING * mean[k]) * np.eye(P)]) for k in range(N)]
        right = [np.append(-residuals[k], np.zeros(P)) for k in range(N)]
        return np.array([lsq_linear(A, b, (low[0], high[0]), "bvls").x for A, b in zip(damped, right, strict=True)])

    def numpys() -> np.ndarray:
        damped = normal + (DAMPING * mean)[:, None, None] * np.eye(P)
        return np.linalg.solve(damped, -gradient[..., None])[..., 0]

    np.testing.assert_allclose(steps, scipys(), atol=1e-6)
    best = [
        min(timeit.repeat(run, number=1, repeat=5)) / N
        for run in (lambda: compiled(*arguments), lambda: interpreted(*arguments), scipys, numpys)
    ]
    for who, seconds in zip(("vm", "scipy", "numpy"), best[1:], strict=True):
        benchmark.extra_info[f"ratio_to_{who}"] = round(seconds / best[0], 1)
    print(
        f"\none step of {P} settings: {best[0] * 1e6:.1f} us in C; VM {best[1] * 1e6:.1f}, scipy {best[2] * 1e6:.0f}, "
        f"numpy without bounds {best[3] * 1e6:.1f} us"
    )
