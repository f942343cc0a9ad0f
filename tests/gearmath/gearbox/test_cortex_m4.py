"""The generated C of the step rule, compiled for a Cortex-M4 and run there: never a wrong step."""

from fractions import Fraction

import numpy as np
import pytest

from gearmath.gearbox.simulation import pattern, worst_error

RATIOS = [
    (125, 192),
    (25, 64),
    (1, 1),
    (1, 2**30),
    (2**30 - 1, 2**30),
    (2**30, 2**30),
    (355, 1130),
    (16000, 999 * 4096),
]


def exact_positions(encoder: np.ndarray, numerator: int, denominator: int) -> np.ndarray:
    """floor((2 N e + D)/(2 D)) in whole numbers of Python, (7.3)."""
    return np.array([(2 * numerator * e + denominator) // (2 * denominator) for e in encoder.tolist()])


def test_million_random_edges_give_no_wrong_step(cortex_m4):
    numerator, denominator = 125, 192  # 16000 steps, 4096 counts, 6 teeth: the densest steps of the source text
    edges = (1 - 2 * np.random.default_rng(7).integers(0, 2, 10**6)).astype(np.int8)
    steps, _ = cortex_m4(edges, numerator, denominator, denominator // 2)
    wanted = exact_positions(np.cumsum(edges, dtype=np.int64), numerator, denominator)
    assert np.count_nonzero(np.cumsum(steps, dtype=np.int64) != wanted) == 0
    assert worst_error(edges, steps, numerator, denominator) <= Fraction(1, 2)


@pytest.mark.parametrize(("numerator", "denominator"), RATIOS)
def test_extreme_ratios_and_reversals_give_no_wrong_step(cortex_m4, numerator, denominator):
    (edges,) = pattern("reversals", 50_000, seed=numerator)
    steps, remainder = cortex_m4(edges, numerator, denominator, denominator // 2)
    encoder = np.cumsum(edges, dtype=np.int64)
    assert np.array_equal(np.cumsum(steps, dtype=np.int64), exact_positions(encoder, numerator, denominator))
    position, count = int(steps.sum(dtype=np.int64)), int(encoder[-1])
    assert remainder == denominator // 2 + numerator * count - denominator * position
