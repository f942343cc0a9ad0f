"""The lowered step rule against exact whole numbers: its promise holds after any history."""

from math import floor

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from derivations.gearbox import gearbox_start
from gearmath.lowering import lower

LIMIT = 2**30


@st.composite
def jobs(draw):
    """N/D with 0 < N <= D <= 2^30, sizes of every order."""
    denominator = draw(st.one_of(st.integers(1, 300), st.integers(1, LIMIT)))
    return draw(st.integers(1, denominator)), denominator


@settings(max_examples=60)
@given(job=jobs(), history=st.lists(st.tuples(st.sampled_from((1, -1)), st.integers(1, 40)), max_size=8))
def test_position_is_the_nearest_step_after_any_history(step_kernel, job, history):
    """p = floor((2 N e + D)/(2 D)), (7.3), from a_0 = floor(D/2), in the whole numbers of Python."""
    numerator, denominator = job
    remainder, encoder, position = denominator // 2, 0, 0
    for direction, run in history:
        for _ in range(run):
            step, following = step_kernel(remainder, direction, numerator, denominator)
            remainder, encoder, position = int(following), encoder + direction, position + int(step)
            assert position == (2 * numerator * encoder + denominator) // (2 * denominator)
            assert (
                2 * abs(position * denominator - numerator * encoder) <= denominator
            )  # half a step, whatever came before


@pytest.mark.parametrize("denominator", [1, 2, 3, 96, 2**30 - 1, 2**30])
def test_start_is_half_of_the_denominator(denominator):
    (start,) = lower(gearbox_start())(denominator)
    assert int(start) == floor(denominator / 2)


def test_every_state_of_small_ratios(step_kernel):
    """All (a, d, N, D) with D <= 12: the step of floor division, and the remainder that belongs to it."""
    states = [(a, d, N, D) for D in range(1, 13) for N in range(1, D + 1) for a in range(D) for d in (1, -1)]
    step, following = step_kernel(*np.array(states, dtype=float).T)
    for (a, d, N, D), s, remainder in zip(states, step, following, strict=True):
        assert (int(s), int(remainder)) == divmod(a + d * N, D)
