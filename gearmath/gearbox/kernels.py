"""Lowered expressions of the gearbox and hobbing chapters, each once, on first use."""

from __future__ import annotations

from fractions import Fraction
from functools import cache

from derivations import check_dimensions, gearbox, hobbing
from derivations.expression import Expression
from gearmath.lowering import Kernel, lower


def expression(name: str) -> Expression:
    """One expression of these chapters, by its name."""
    for chapter in (gearbox, hobbing, check_dimensions):
        if hasattr(chapter, name):
            return getattr(chapter, name)()
    raise KeyError(f"no chapter of the gearbox has an expression {name!r}")


@cache
def kernel(name: str) -> Kernel:
    """The same, lowered."""
    return lower(expression(name))


def evaluate(name: str, *arguments: float) -> tuple[float, ...]:
    """Its outputs at one point, in double precision."""
    return tuple(float(output) for output in kernel(name)(*arguments))


def precise(name: str, *arguments: float) -> Fraction:
    """Its only output at one point, to 50 digits, as a fraction."""
    (value,) = expression(name).evaluate(*arguments)
    sign, mantissa, exponent, _ = value._mpf_
    return (-1) ** sign * int(mantissa) * Fraction(2) ** exponent
