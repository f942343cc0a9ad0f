"""SymPy to CasADi: an :class:`~derivations.expression.Expression` becomes a :class:`Kernel`.

The only module that knows both. A rule table is walked after common-subexpression elimination; what has no rule is
refused by name, never guessed.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Callable, Mapping, Sequence

import casadi as ca
import sympy as sp
from sympy.core.function import Application
from sympy.core.relational import Relational

from derivations.expression import Expression
from gearmath.arguments.call import checked_call
from gearmath.engine.kernel import Kernel
from gearmath.errors import ComputationError


class LoweringError(ComputationError, TypeError):
    """An expression uses something CasADi has no exact counterpart for."""


def _fold(operation: Callable) -> Callable:
    return lambda *arguments: functools.reduce(operation, arguments)


RULES: Mapping[type, Callable] = {
    sp.Add: _fold(lambda a, b: a + b),
    sp.Mul: _fold(lambda a, b: a * b),
    sp.sin: ca.sin,
    sp.cos: ca.cos,
    sp.tan: ca.tan,
    sp.asin: ca.asin,
    sp.acos: ca.acos,
    sp.atan: ca.atan,
    sp.atan2: ca.atan2,
    sp.exp: ca.exp,
    sp.log: ca.log,
    sp.Abs: ca.fabs,
    sp.sign: ca.sign,
    sp.floor: ca.floor,
    sp.Max: _fold(ca.fmax),
    sp.Min: _fold(ca.fmin),
    sp.StrictGreaterThan: lambda a, b: a > b,
    sp.GreaterThan: lambda a, b: a >= b,
    sp.StrictLessThan: lambda a, b: a < b,
    sp.LessThan: lambda a, b: a <= b,
    sp.Equality: lambda a, b: a == b,
    sp.Unequality: lambda a, b: a != b,
    sp.And: _fold(ca.logic_and),
    sp.Or: _fold(ca.logic_or),
    sp.Not: ca.logic_not,
}


@checked_call
def lower(expression: Expression) -> Kernel:
    """The CasADi function of an expression, with the same names, shapes, units and description.

    Raises LoweringError naming the operation that has no rule.
    """
    values: dict[sp.Basic, ca.SX] = {}
    arguments = []
    for quantity in expression.inputs:
        argument = ca.SX.sym(quantity.name, *quantity.shape) if quantity.shape else ca.SX.sym(quantity.name)
        arguments.append(argument)
        rows, columns = (*quantity.shape, 1, 1)[:2]
        elements = [argument[r, c] for r in range(rows) for c in range(columns)]
        values.update(zip(quantity.symbols, elements, strict=True))
    scalars = [sp.sympify(value) for _, value in expression.scalars()]
    definitions, reduced = sp.cse(scalars, order="none")
    for symbol, definition in definitions:
        values[symbol] = _walk(definition, values, expression.name)
    lowered = iter([_walk(value, values, expression.name) for value in reduced])
    results = []
    for quantity, _ in expression.outputs:
        elements = [next(lowered) for _ in range(quantity.size)]
        rows, columns = (*quantity.shape, 1, 1)[:2]
        results.append(ca.vertcat(*(ca.horzcat(*elements[r * columns : (r + 1) * columns]) for r in range(rows))))
    function = ca.Function(
        expression.name,
        arguments,
        results,
        [quantity.name for quantity in expression.inputs],
        [quantity.name for quantity, _ in expression.outputs],
    )
    return Kernel(
        function,
        expression.description,
        expression.inputs,
        tuple(quantity for quantity, _ in expression.outputs),
        expression.source,
        tuple(f"{requirement} > 0" for requirement in expression.requires),
    )


def _walk(node: sp.Basic, values: Mapping[sp.Basic, ca.SX], name: str) -> ca.SX:
    if node in values:
        return values[node]
    if isinstance(node, sp.Number | sp.NumberSymbol) and node.is_finite:
        return _number(node, name)
    if isinstance(node, sp.logic.boolalg.BooleanAtom):
        return ca.SX(1 if node else 0)
    if isinstance(node, sp.Piecewise):
        return _piecewise(node.args, values, name)
    if isinstance(node, sp.Pow):
        return _pow(node, values, name)
    if isinstance(node, sp.Mul):
        return _mul(node, values, name)
    rule = RULES.get(type(node))
    if rule is None:
        known = sorted(one.__name__ for one in RULES if issubclass(one, Application) and issubclass(one, sp.Expr))
        raise LoweringError(
            f"{name}: no CasADi rule for {type(node).__name__} in {node}: write it in powers, Piecewise, "
            f"{', '.join(known)}"
        )
    return rule(*(_walk(argument, values, name) for argument in node.args))


def _number(node: sp.Basic, name: str) -> ca.SX:
    value = float(node)  # type: ignore[arg-type]
    if not math.isfinite(value) or (value == 0 and not node.is_zero):
        raise LoweringError(f"{name}: the number {sp.N(node, 6)} lies beyond those of double precision")
    return ca.SX(value)


def _pow(node: sp.Pow, values: Mapping[sp.Basic, ca.SX], name: str) -> ca.SX:
    base = _walk(node.base, values, name)
    if node.exp == sp.Rational(1, 2):
        return ca.sqrt(base)
    if node.exp == -sp.Rational(1, 2):
        return 1 / ca.sqrt(base)
    if node.exp == -1:
        return 1 / base
    return base ** _walk(node.exp, values, name)


def _mul(node: sp.Mul, values: Mapping[sp.Basic, ca.SX], name: str) -> ca.SX:
    """A product as numerator over denominator: one division, and a sign costs no multiplication."""
    above: list[ca.SX] = []
    below: list[ca.SX] = []
    sign = 1
    for factor in node.args:
        if factor is sp.S.NegativeOne:
            sign = -sign
        elif isinstance(factor, sp.Pow) and factor not in values and factor.exp.could_extract_minus_sign():
            below.append(_walk(1 / factor, values, name))
        else:
            above.append(_walk(factor, values, name))
    product: ca.SX = functools.reduce(lambda a, b: a * b, above) if above else ca.SX(1)
    for divisor in below:
        product = product / divisor
    return -product if sign < 0 else product


def _piecewise(pieces: Sequence, values: Mapping[sp.Basic, ca.SX], name: str) -> ca.SX:
    """Nested if_else; a truth value, Piecewise((1, c), (0, True)), is the comparison itself."""
    if len(pieces) == 2 and [piece.expr for piece in pieces] == [1, 0] and pieces[1].cond == sp.true:
        return _walk(pieces[0].cond, values, name)
    if pieces[-1].cond != sp.true:
        raise LoweringError(f"{name}: a Piecewise without a last case for everything else: {pieces[-1].cond}")
    result = _walk(pieces[-1].expr, values, name)
    for value, condition in reversed(pieces[:-1]):
        if not isinstance(condition, Relational | sp.logic.boolalg.BooleanFunction | sp.Symbol):
            raise LoweringError(f"{name}: no CasADi rule for the condition {condition}")
        result = ca.if_else(_walk(condition, values, name), _walk(value, values, name), result)
    return result
