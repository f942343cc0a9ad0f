"""Axis transforms per second: the compiled C against the formulas of the conventions in batched NumPy, and the VM.

The NumPy twin is typed from the conventions on purpose: it is the independent witness, and it stays in this file.

Where 10^7 positions a second of a core are met, and where they are not: along a roll, whose settings all points share,
yes (1.5e7). For points that have nothing in common, no (8.2e6): the four sines with their cosines and the two
arctangents of a point take 76 ns of the 122 ns in glibc 2.36, and they must be glibc's, for the results are bit for bit
those of CasADi. All else in vectors, measured with the same bits: 9.3e6 (two lanes, -O2), 9.4e6 (two, -O3), 9.6e6
(four, AVX, without errno). Vector sines (libmvec, or a polynomial) would be faster, and others in their last digits.
"""

from __future__ import annotations

import time
import timeit

import numpy as np
import pytest

from derivations import notation
from gearmath.export.host import compile_kernel
from gearmath.kernels import kernel

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
    # tilt and root angle: keep the cutter axis away from the work axis, where the C refuses the pose
    low[2], high[2], low[7], high[7] = -0.2, 0.2, 0.3, 1.2
    return generator.uniform(low, high, (N, 12)), generator.uniform(-1.0, 1.0, N), 250.0


@pytest.mark.benchmark(group="axis transform")
def test_axis_transforms_per_second_in_c_against_numpy(benchmark, poses, host_compiler) -> None:
    compiled = compile_kernel(kernel("axis_transform"))
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


@pytest.mark.benchmark(group="axis transform")
def test_positions_along_a_roll_in_c_against_vm_and_numpy(benchmark, poses, by_vm, host_compiler) -> None:
    """As a post-processor asks: settings shared, what depends on them computed once, one cradle rotation a point."""
    settings, height = poses[0][0], poses[2]
    theta = np.linspace(-0.5, 0.5, 10 * N)
    compiled, interpreted = compile_kernel(kernel("axis_transform")), by_vm(kernel("axis_transform"))
    (ours,) = benchmark(compiled, settings, theta, height, np.zeros(3))
    repeated = np.broadcast_to(settings, (len(theta), 12))
    np.testing.assert_allclose(ours, numpy_axes(repeated, theta, height), atol=1e-8)  # mm and rad
    seconds = [
        min(timeit.repeat(run, timer=time.process_time, number=1, repeat=7))
        for run in (
            lambda: compiled(settings, theta, height, np.zeros(3)),
            lambda: interpreted(settings, theta, height, np.zeros(3)),
            lambda: numpy_axes(repeated, theta, height),
        )
    ]
    in_c, in_vm, in_numpy = (len(theta) / one for one in seconds)
    benchmark.extra_info["positions_per_second"] = round(in_c)
    print(
        f"\npositions along a roll, per second of a core: {in_c:.3g} in C, {in_vm:.3g} in the VM, {in_numpy:.3g} in "
        f"NumPy; ratios {in_c / in_vm:.1f} and {in_c / in_numpy:.1f}"
    )
