"""Lowered expressions of the gearbox and hobbing chapters, each once, on first use."""

from __future__ import annotations

from fractions import Fraction
from typing import TYPE_CHECKING

import derivations
from gearmath.engine.exact import exact
from gearmath.kernels import kernel

if TYPE_CHECKING:
    from derivations.expression import Expression


def expression(name: str) -> Expression:
    """One expression, by its name."""
    return derivations.derive(name)


def evaluate(name: str, *arguments: float) -> tuple[float, ...]:
    """Its outputs at one point, in double precision."""
    return tuple(float(output) for output in kernel(name)(*arguments))


def exactly(name: str, *arguments: Fraction | int) -> Fraction:
    """Its only output at one point of rational numbers, exactly."""
    (value,) = exact(kernel(name), *arguments)
    return value


def precise(name: str, *arguments: float) -> Fraction:
    """Its only output at one point, to 50 digits, as a fraction."""
    (value,) = expression(name).evaluate(*arguments)
    sign, mantissa, exponent, _ = value._mpf_
    return (-1) ** sign * int(mantissa) * Fraction(2) ** exponent
