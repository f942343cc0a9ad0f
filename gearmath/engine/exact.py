"""A lowered expression at rational numbers, exactly, by its own operations: SymPy need not be loaded for it."""

from __future__ import annotations

import operator
from collections.abc import Callable
from fractions import Fraction

import casadi as ca

from gearmath.engine.kernel import Kernel

#: What leaves a number rational, by the operations of CasADi.
_RATIONAL: dict[int, Callable[..., Fraction]] = {
    ca.OP_ADD: operator.add,
    ca.OP_SUB: operator.sub,
    ca.OP_MUL: operator.mul,
    ca.OP_DIV: operator.truediv,
    ca.OP_NEG: operator.neg,
    ca.OP_SQ: lambda value: value * value,
    ca.OP_TWICE: lambda value: 2 * value,
    ca.OP_INV: lambda value: 1 / value,
}


def exact(kernel: Kernel, *arguments: Fraction | int) -> tuple[Fraction, ...]:
    """Every output at one point of rational numbers; all inputs and outputs scalars.

    Raises TypeError if the function is not rational, or holds a constant that is no whole number: a third is none in
    double precision.
    """
    function, work = kernel.function, {}
    results: dict[int, Fraction] = {}
    for k in range(function.n_instructions()):
        kind, given, to = function.instruction_id(k), function.instruction_input(k), function.instruction_output(k)
        if kind == ca.OP_INPUT:
            work[to[0]] = Fraction(arguments[given[0]])
        elif kind == ca.OP_OUTPUT:
            results[to[0]] = work[given[0]]
        elif kind == ca.OP_CONST and float(function.instruction_constant(k)).is_integer():
            work[to[0]] = Fraction(function.instruction_constant(k))
        elif kind in _RATIONAL:
            work[to[0]] = _RATIONAL[kind](*(work[one] for one in given))
        else:
            raise TypeError(f"{kernel.name} is not rational in its inputs")
    return tuple(results[k] for k in range(function.n_out()))
