"""The bounded least-squares solver against scipy's, where bounds cut into directions that the residuals barely show."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import lsq_linear

from gearmath.bevel.identify.least_squares import FLOOR, compensation_step, minimize


def problem(seed):
    """45 residuals of 7 variables, singular values from 10 to 6e-5: those of a pinion flank with a ripple."""
    random = np.random.default_rng(seed)
    u, _, vt = np.linalg.svd(random.normal(size=(45, 7)), full_matrices=False)
    slope = 10 * (u * 10.0 ** -np.linspace(0, 5.2, 7)) @ vt
    return slope, slope @ (random.normal(size=7) * 0.7e-3) + 2e-3 * random.normal(size=45)


@pytest.mark.parametrize("seed", range(20))
def test_bounded_minimum_is_that_of_scipy(seed):
    slope, aim = problem(seed)
    found = minimize(lambda v: (slope @ v - aim, slope), -np.ones(7), np.ones(7))
    expected = lsq_linear(slope, aim, (-1, 1), tol=1e-15, max_iter=1000)
    assert found.converged
    assert (np.abs(found.variables) <= 1).all()
    assert (np.abs(found.variables) == 1).any()
    assert found.residual @ found.residual / 2 == pytest.approx(expected.cost, rel=1e-10)


def test_one_undamped_step_reaches_the_bounded_minimum_of_a_linear_problem():
    """From the middle: every pass runs as far as the first bound, so that nothing on the way is worse."""
    for seed in range(20):
        slope, aim = problem(seed)
        given = (slope.T @ slope, -slope.T @ aim, np.zeros(7), -np.ones(7), np.ones(7))
        step, promised = compensation_step(7)(*given, FLOOR)
        expected = lsq_linear(slope, aim, (-1, 1), tol=1e-15, max_iter=1000)
        left = slope @ step - aim
        assert promised == pytest.approx(aim @ aim - left @ left, rel=1e-9)
        # no bound is let go within a step: the next one does that
        assert expected.cost <= left @ left / 2 * (1 + 1e-9)
        assert left @ left / 2 <= 1.05 * expected.cost
