"""Axis transforms per second: the compiled C against the formulas of the conventions in batched NumPy.

The NumPy twin is typed from the conventions on purpose: it is the independent witness, and it stays in this file.
"""

from __future__ import annotations

import timeit

import numpy as np
import pytest

from derivations import axes, notation
from gearmath.export.host import compile_kernel
from gearmath.lowering import lower

N = 20_000


def numpy_axes(settings: np.ndarray, theta: np.ndarray, pivot_height: float) -> np.ndarray:
    """X, Y, Z, A, B (n,5): V_c, V_p, V_ls and the frame i_s, j_s, k_s, by vectors."""
    S, q, i, j, E_m, X_b, X_p, root, R_a, offset = settings.T[:10]
    zero, ones = np.zeros_like(S), np.ones_like(S)
    turned = q + theta + j
    V_c = np.stack([np.sin(i) * np.sin(turned), -np.sin(i) * np.cos(turned), np.cos(i)], axis=1)
    V_p = np.stack([np.cos(root), zero, np.sin(root)], axis=1)
    machine_j = np.stack([zero, ones, zero], axis=1)
    V_ls = V_p * X_p[:, None] + np.stack([S * np.cos(q + theta), E_m + S * np.sin(q + theta), -X_b], axis=1)
    across = np.cross(V_c, V_p)
    j_s = across / np.linalg.norm(across, axis=1, keepdims=True)
    i_s = np.cross(j_s, V_c)
    phi = np.arccos(np.einsum("nk,nk->n", V_c, V_p))
    dA = np.arctan2(np.einsum("nk,nk->n", V_c, machine_j), np.einsum("nk,nk->n", V_c, np.cross(V_p, machine_j)))
    X, Y, Z = (np.einsum("nk,nk->n", V_ls, axis) for axis in (-i_s, j_s, -V_c))
    return np.stack([X, Y, Z + pivot_height, -(offset + R_a * theta) - dA, np.pi / 2 - phi], axis=1)


@pytest.fixture(scope="module")
def poses() -> tuple[np.ndarray, np.ndarray, float]:
    generator = np.random.default_rng(4)
    low, high = np.array([component.domain for component in notation.settings.components]).T
    low[7], high[7] = 0.3, 1.2  # root angle: keeps the cutter axis away from the work axis
    return generator.uniform(low, high, (N, 12)), generator.uniform(-1.0, 1.0, N), 250.0


@pytest.mark.benchmark(group="axis transform")
def test_axis_transforms_per_second_in_c_against_numpy(benchmark, poses, host_compiler) -> None:
    compiled = compile_kernel(lower(axes.axis_transform()))
    (ours,) = benchmark(compiled, *poses, np.zeros(3))
    np.testing.assert_allclose(ours, numpy_axes(*poses), atol=1e-8)  # mm and rad
    in_c, in_numpy = (
        min(timeit.repeat(lambda run=run, more=more: run(*poses, *more), number=1, repeat=7))
        for run, more in ((compiled, (np.zeros(3),)), (numpy_axes, ()))
    )
    benchmark.extra_info["transforms_per_second_c"] = round(N / in_c)
    benchmark.extra_info["transforms_per_second_numpy"] = round(N / in_numpy)
    benchmark.extra_info["ratio"] = round(in_numpy / in_c, 1)
    print(f"\naxis transforms: {N / in_c:.3g} per s in C, {N / in_numpy:.3g} in NumPy, ratio {in_numpy / in_c:.1f}")
