"""Chapter 28. Polynomial blocks of a control, from positions and derivatives at their ends.

A block moves each axis as a polynomial of a parameter p, from the last end point a_0 at p = 0 to x_e at p = L:

    x(p) = a_0 + a_1 p + a_2 p² + a_3 p³ + ..,   a_1 = (x_e - a_0 - a_2 L² - a_3 L³ - ..)/L   (28.1)

x_e, a_2, a_3 .. are written; the control finds a_1. With d = x_e - a_0 and slopes v_0, v_1 at both ends, the cubic is

    a_2 = (3 d - (2 v_0 + v_1) L)/L²,   a_3 = ((v_0 + v_1) L - 2 d)/L³                          (28.2)

and with the second derivatives w_0, w_1 as well the quintic is

    a_2 = w_0/2,   a_3 = (20 d - (12 v_0 + 8 v_1) L - (3 w_0 - w_1) L²)/(2 L³),
    a_4 = (-30 d + (16 v_0 + 14 v_1) L + (3 w_0 - 2 w_1) L²)/(2 L⁴),
    a_5 = (12 d - 6 (v_0 + v_1) L - (w_0 - w_1) L²)/(2 L⁵)                                      (28.3)

A control runs along the path at the speed that F asks for. What it counts as a length are the ways of all axes, each by
its weight: 1 of a mm, the radius r_F of FGREF of a turn by 1 rad. Along the path

    ds/dp = √(ẋ² + ẏ² + ż² + (r_A ȧ)² + (r_B ḃ)²),   dx/ds = ẋ/(ds/dp)                         (28.4)

so that d/ds = (d/dp)/(ds/dp), once, twice and three times, gives the speed of an axis at unit speed of the path, its
acceleration at the square of it, and its jerk at the cube.
"""

from __future__ import annotations

from functools import cache

import sympy as sp

from derivations import notation as q
from derivations.expression import Expression
from derivations.proof import is_zero


def _d() -> sp.Expr:
    return q.block_end.symbol - q.block_start.symbol


@cache
def cubic_block() -> Expression:
    """(28.2) as an Expression."""
    L, v_0, v_1 = q.block_interval.symbol, q.slope_start.symbol, q.slope_end.symbol
    return Expression(
        "cubic_block",
        "Coefficients a_2, a_3 of the cubic block of one axis from positions and slopes at its ends (28.2).",
        (q.block_start, q.block_end, q.slope_start, q.slope_end, q.block_interval),
        (
            (
                q.cubic_coefficients,
                sp.Matrix([(3 * _d() - (2 * v_0 + v_1) * L) / L**2, ((v_0 + v_1) * L - 2 * _d()) / L**3]),
            ),
        ),
        source="cubic Hermite interpolation, in the form of PO of SINUMERIK",
    )


@cache
def quintic_block() -> Expression:
    """(28.3) as an Expression."""
    L, v_0, v_1 = q.block_interval.symbol, q.slope_start.symbol, q.slope_end.symbol
    w_0, w_1 = q.bend_start.symbol, q.bend_end.symbol
    coefficients = sp.Matrix(
        [
            w_0 / 2,
            (20 * _d() - (12 * v_0 + 8 * v_1) * L - (3 * w_0 - w_1) * L**2) / (2 * L**3),
            (-30 * _d() + (16 * v_0 + 14 * v_1) * L + (3 * w_0 - 2 * w_1) * L**2) / (2 * L**4),
            (12 * _d() - 6 * (v_0 + v_1) * L - (w_0 - w_1) * L**2) / (2 * L**5),
        ]
    )
    return Expression(
        "quintic_block",
        "Coefficients a_2 to a_5 of the quintic block of one axis from positions, slopes and bends at its ends (28.3).",
        (q.block_start, q.block_end, q.slope_start, q.slope_end, q.bend_start, q.bend_end, q.block_interval),
        ((q.quintic_coefficients, coefficients),),
        source="quintic Hermite interpolation, in the form of PO of SINUMERIK",
    )


@cache
def path_rate() -> Expression:
    """ds/dp of (28.4) as an Expression."""
    slopes, r_A, r_B = q.axis_slopes.symbol, q.feed_radius_A.symbol, q.feed_radius_B.symbol
    weights = (1, 1, 1, r_A, r_B)
    squared = sum((weight * slope) ** 2 for weight, slope in zip(weights, slopes, strict=True))
    return Expression(
        "path_rate",
        "Length of the path, as F counts it, per unit of the parameter (28.4).",
        (q.axis_slopes, q.feed_radius_A, q.feed_radius_B),
        ((q.path_rate, sp.sqrt(squared)),),
        source="path feed of five axes with FGROUP and FGREF",
    )


def _polynomial(coefficients: sp.MatrixBase, p: sp.Expr) -> sp.Expr:
    """x(p) of (28.1)."""
    L = q.block_interval.symbol
    a_1 = (_d() - sum(a * L**k for k, a in enumerate(coefficients, 2))) / L
    return q.block_start.symbol + a_1 * p + sum(a * p**k for k, a in enumerate(coefficients, 2))


def prove_blocks_have_the_positions_slopes_and_bends_that_they_were_made_from() -> None:
    """(28.1-28.3) What is written gives back, by differentiation, all that was asked at both ends."""
    p, L = sp.symbols("p"), q.block_interval.symbol
    cubic = _polynomial(cubic_block()["cubic_coefficients"], p)
    quintic = _polynomial(quintic_block()["quintic_coefficients"], p)
    ends = ((0, q.block_start, q.slope_start, q.bend_start), (L, q.block_end, q.slope_end, q.bend_end))
    for at, position, slope, bend in ends:
        for curve in (cubic, quintic):
            assert is_zero(curve.subs(p, at) - position.symbol)
            assert is_zero(sp.diff(curve, p).subs(p, at) - slope.symbol)
        assert is_zero(sp.diff(quintic, p, 2).subs(p, at) - bend.symbol)


def prove_a_polynomial_of_the_degree_of_the_block_comes_back_as_it_was() -> None:
    """(28.2, 28.3) Coefficients of any cubic, and of any quintic, out of its own values at 0 and L."""
    L, t = q.block_interval.symbol, sp.Symbol("t")
    given = sp.symbols("b_0:6")
    for expression, degree in ((cubic_block(), 3), (quintic_block(), 5)):
        (name,) = (quantity.name for quantity, _ in expression.outputs)
        curve = sum(b * t**k for k, b in enumerate(given[: degree + 1]))
        values = {}
        ends = ((0, q.block_start, q.slope_start, q.bend_start), (L, q.block_end, q.slope_end, q.bend_end))
        for at, position, slope, bend in ends:
            for quantity, order in ((position, 0), (slope, 1), (bend, 2)):
                values[quantity.symbol] = sp.diff(curve, t, order).subs(t, at)
        for found, b in zip(expression[name], given[2:], strict=False):
            assert is_zero(found.subs(values, simultaneous=True) - b)


def prove_path_of_one_axis_alone_is_its_way() -> None:
    """(28.4) Limit case: where one axis moves, the path is its way, and 1 degree is 1 mm with r_F = 180/π."""
    for k, axis in enumerate(q.axis_slopes.symbols):
        only = {other: 0 for other in q.axis_slopes.symbols if other != axis}
        radius = sp.Rational(1) if k < 3 else (q.feed_radius_A, q.feed_radius_B)[k - 3].symbol
        assert is_zero(path_rate()["path_rate"].subs(only) ** 2 - (radius * axis) ** 2)
    degree = {q.axis_slopes.symbols[3]: sp.pi / 180, q.feed_radius_A.symbol: 180 / sp.pi}
    others = {axis: 0 for k, axis in enumerate(q.axis_slopes.symbols) if k != 3}
    assert path_rate()["path_rate"].subs(others | degree) == 1
