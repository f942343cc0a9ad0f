"""Virtual milling: cutter-line intersections per second on one core, and a cost linear in blocks and in points."""

from __future__ import annotations

import time
import timeit

import numpy as np
import pytest

from gearmath.machine.bodies.cutter import Body, Cutter, CutterProfile
from gearmath.machine.milling.removal import REACH, annulus_entry, removal

POSES, LINES = 3000, 40
HEIGHT = 500.0
CUTTER = Cutter((Body(0.0, CutterProfile(77.0, 0.38), CutterProfile(75.4, 0.38), 12.0),), 12.0)


def lines(n: int) -> tuple[np.ndarray, np.ndarray]:
    generator = np.random.default_rng(3)
    point = generator.uniform([74.0, -2.0, -6.0], [79.0, 2.0, 1.0], (n, 3))
    direction = generator.normal(size=(n, 3))
    return point, direction / np.linalg.norm(direction, axis=1, keepdims=True)


def path(blocks: int) -> tuple[np.ndarray, np.ndarray]:
    """Positions about a plunge, the cutter's axis nearly along z_w."""
    s = np.linspace(-1, 1, blocks + 1)
    axes = np.column_stack([20 * s, 10 * s, HEIGHT + 5 * s**2, 0.2 * s, np.pi / 2 + 0 * s])
    return axes, np.r_[False, np.ones(blocks, bool)]


@pytest.mark.benchmark(group="virtual milling")
def test_cutter_line_intersections_per_second_and_core(benchmark, by_vm, host_compiler) -> None:
    """Goal: 2e7 as the engine runs it, on one core; CasADi's virtual machine beside it."""
    point, direction = lines(LINES)
    generator = np.random.default_rng(7)
    center = generator.normal(scale=0.5, size=(POSES, 3))
    axis = np.tile([0.0, 0.0, 1.0], (POSES, 1))
    compiled, interpreted = annulus_entry(), by_vm(annulus_entry())
    given = (center, axis), CUTTER.bodies[0].annulus

    def run(entry):
        return [entry(*given[0], p, d, -2.0, given[1])[0] for p, d in zip(point, direction, strict=True)]

    np.testing.assert_array_equal(benchmark(run, compiled), run(interpreted))
    rates = [
        POSES * LINES / min(timeit.repeat(lambda entry=entry: run(entry), number=1, repeat=5))
        for entry in (compiled, interpreted)
    ]
    benchmark.extra_info["intersections_per_second_c"], benchmark.extra_info["in_casadi"] = map(round, rates)
    print(f"\ncutter against line: {rates[0]:.3g} per s and core in C, {rates[1]:.3g} in CasADi (goal 2e7)")
    assert rates[0] > 1e6  # a busy machine may be slower than the goal


def seconds(blocks: int, points: int, repeat: int = 2) -> float:
    axes, cutting = path(blocks)
    point, direction = lines(points)
    best = np.inf
    for _ in range(repeat):
        begin = time.process_time()
        removal(axes, cutting, CUTTER, (HEIGHT, np.zeros(3)), point, direction, -REACH / 10)
        best = min(best, time.process_time() - begin)
    return best


@pytest.mark.benchmark(group="virtual milling")
def test_cost_is_linear_in_blocks_and_in_points(benchmark, host_compiler) -> None:
    """Twice the blocks or the points cost at most two and a half times as much."""
    small = benchmark.pedantic(seconds, (2000, 64), rounds=1)
    assert seconds(4000, 64) < 2.5 * small
    assert seconds(2000, 128) < 2.5 * small
