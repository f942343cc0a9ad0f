"""SymPy to CasADi: an :class:`~derivations.expression.Expression` becomes a :class:`Kernel`.

The only module that knows both. A rule table is walked after common-subexpression elimination; what has no rule is
refused by name, never guessed.
"""

from __future__ import annotations

import functools
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import casadi as ca
import numpy as np
import sympy as sp
from sympy.core.relational import Relational

from derivations.expression import Expression, Quantity


class LoweringError(TypeError):
    """An expression uses something CasADi has no exact counterpart for."""


@dataclass(frozen=True)
class Kernel:
    """A :class:`casadi.Function` with the meaning of its arguments: what ``export`` ships and others compose.

    Inputs and outputs of ``function`` have the names and shapes of ``inputs`` and ``outputs``, in this order.
    """

    function: ca.Function
    description: str
    inputs: tuple[Quantity, ...]
    outputs: tuple[Quantity, ...]
    source: str = ""
    requires: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        for kind, quantities, names in (
            ("input", self.inputs, self.function.name_in()),
            ("output", self.outputs, self.function.name_out()),
        ):
            if [quantity.name for quantity in quantities] != names:
                raise ValueError(
                    f"{self.name}: {kind}s {names} of the function do not carry the names of its quantities"
                )

    def __hash__(self) -> int:
        """By its name: kernels are looked up wherever they are run, and hardly two of them share it."""
        return hash(self.name)

    @property
    def name(self) -> str:
        return self.function.name()

    def __call__(self, *arguments: np.typing.ArrayLike) -> tuple[np.ndarray, ...]:
        """Evaluate at one or many points, in one mapped call.

        Each argument has the shape of its quantity, or that shape with one axis of n points in front; what has no
        such axis is the same for all points. Outputs have the axis in front if any argument has it. Arguments may be
        left out at the end where their quantities have a default.
        """
        arrays = [np.asarray(argument, dtype=float) for argument in arguments]
        left_out = self.inputs[len(arrays) :]
        if all(quantity.default is not None for quantity in left_out):
            arrays += [np.full(quantity.shape, quantity.default, dtype=float) for quantity in left_out]
        if len(arrays) != len(self.inputs):
            raise TypeError(f"{self.name} takes {len(self.inputs)} arguments, {len(arrays)} were given")
        many = [array.ndim > len(quantity.shape) for array, quantity in zip(arrays, self.inputs, strict=True)]
        n = max((len(array) for array, is_many in zip(arrays, many, strict=True) if is_many), default=1)
        columns = []
        for array, is_many, quantity in zip(arrays, many, self.inputs, strict=True):
            if array.shape != (*((n,) if is_many else ()), *quantity.shape):
                raise ValueError(f"{self.name}: {quantity.name} has shape {array.shape}, expected {quantity.shape}")
            flat = np.broadcast_to(array.reshape(n if is_many else 1, quantity.size), (n, quantity.size))
            columns.append(_as_columns(flat, quantity))
        results = _mapped(self.function, n).call(columns) if n else [np.empty((q.size, 0)) for q in self.outputs]
        outputs = []
        for result, quantity in zip(results, self.outputs, strict=True):
            rows = _as_rows(np.asarray(result), quantity, n)
            outputs.append(rows if any(many) else rows[0])
        return tuple(outputs)

    def expand(self) -> Kernel:
        """The same kernel as one flat graph of scalar operations."""
        return Kernel(self.function.expand(), self.description, self.inputs, self.outputs, self.source, self.requires)


def _as_columns(rows: np.ndarray, quantity: Quantity) -> np.ndarray:
    if len(quantity.shape) < 2:
        return np.ascontiguousarray(rows.T)
    height, width = quantity.shape
    return rows.reshape(-1, height, width).transpose(1, 0, 2).reshape(height, len(rows) * width)


def _as_rows(columns: np.ndarray, quantity: Quantity, n: int) -> np.ndarray:
    if len(quantity.shape) < 2:
        return np.ascontiguousarray(columns.T).reshape(n, *quantity.shape)
    return np.stack(np.hsplit(columns, n)) if n else np.empty((0, *quantity.shape))


@functools.lru_cache(maxsize=64)
def _mapped(function: ca.Function, n: int) -> ca.Function:
    return function.map(n) if n > 1 else function


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
        expression.name, arguments, results,
        [quantity.name for quantity in expression.inputs], [quantity.name for quantity, _ in expression.outputs],
    )  # fmt: skip
    return Kernel(
        function, expression.description, expression.inputs, tuple(quantity for quantity, _ in expression.outputs),
        expression.source, tuple(f"{requirement} > 0" for requirement in expression.requires),
    )  # fmt: skip


def _walk(node: sp.Basic, values: Mapping[sp.Basic, ca.SX], name: str) -> ca.SX:
    if node in values:
        return values[node]
    if isinstance(node, sp.Number | sp.NumberSymbol) and node.is_finite:
        return ca.SX(int(node)) if node.is_Integer else ca.SX(float(node))
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
        raise LoweringError(f"{name}: no CasADi rule for {type(node).__name__} in {node}")
    return rule(*(_walk(argument, values, name) for argument in node.args))


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
