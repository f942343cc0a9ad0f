"""Exact rational numbers from a lowered expression, beside SymPy's own of the same expression."""

from __future__ import annotations

from fractions import Fraction

import pytest

import derivations
from gearmath.engine.exact import exact
from gearmath.kernels import kernel


@pytest.mark.parametrize(
    ("name", "arguments"),
    [
        ("hob_ratio", (-1, 17, 2, Fraction(40_000, 7), Fraction(51_200 * 127, 120))),
        ("lead_screw_ratio", (1, 3, Fraction(254, 80), Fraction(4096, 3), 1600, Fraction(127, 40))),
    ],
)
def test_a_lowered_expression_is_exact_at_rational_numbers(name: str, arguments: tuple[Fraction | int, ...]) -> None:
    assert exact(kernel(name), *arguments) == derivations.derive(name).exact(*arguments)


def test_what_is_not_rational_is_refused() -> None:
    with pytest.raises(TypeError, match="feed_ratio is not rational"):
        exact(kernel("feed_ratio"), 1, 1, 17, 1, Fraction(1, 3), 400, 4096)
