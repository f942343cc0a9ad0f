"""Functions of columns that the engine runs at one or many points, beside CasADi called point by point."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor

import casadi as ca
import numpy as np
import pytest

from gearmath.engine.points import Points

RNG = np.random.default_rng(3)


@pytest.fixture(scope="module")
def function() -> ca.Function:
    x, c = ca.SX.sym("x", 3), ca.SX.sym("c", 2)
    value = ca.vertcat(ca.sin(x[0]) * c[0] + x[1] ** 2, ca.atan2(x[2], c[1]))
    return ca.Function("two_outputs", [x, c], [value, ca.densify(ca.jacobian(value, x))])


@pytest.mark.parametrize("n", [1, 2, 16, 17, 33, 600])
def test_points_give_the_bits_of_single_calls(function: ca.Function, n: int) -> None:
    x, c = RNG.normal(size=(n, 3)), RNG.normal(size=2)
    value, rates = Points(function, shared=(1,))(x, c)
    assert value.shape == (n, 2, 1)
    assert rates.shape == (n, 2, 3)
    for k in range(n):
        single = function(x[k], c)
        assert (value[k] == np.asarray(single[0])).all()
        assert (rates[k] == np.asarray(single[1])).all()


def test_one_point_gives_arrays_of_two_axes(function: ca.Function) -> None:
    x, c = RNG.normal(size=3), RNG.normal(size=2)
    for found, single in zip(Points(function, shared=(1,)).at(x, c), function(x, c), strict=True):
        assert (found == np.asarray(single)).all()


def test_results_of_a_call_are_not_changed_by_the_next(function: ca.Function) -> None:
    points, c = Points(function, shared=(1,)), np.ones(2)
    first = points.at(np.zeros(3), c)[0]
    kept = first.copy()
    points.at(np.ones(3), c)
    assert (first == kept).all()


def test_threads_do_not_share_memory(function: ca.Function) -> None:
    points, c = Points(function, shared=(1,)), np.ones(2)
    x = RNG.normal(size=(400, 3))
    expected = [np.asarray(function(one, c)[0]) for one in x]
    with ThreadPoolExecutor(4) as pool:
        found = list(pool.map(lambda one: points.at(one, c)[0], x))
    assert all((one == other).all() for one, other in zip(found, expected, strict=True))
