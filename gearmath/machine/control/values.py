"""Values of the expressions of NC programs: numbers, texts and truth values, as the control computes them."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Protocol

from gearmath.machine.control.expression import FUNCTIONS, LARGEST, Constant, NcVariable, Node, Operation, Value, refuse
from gearmath.machine.control.text import LONGEST_TEXT

_EQUAL = 1e-12


class NcVariables(Protocol):
    """Where the values of variables come from."""

    def read(self, variable: NcVariable, index: tuple[int, ...], line: int) -> Value: ...


def evaluate(node: Node, variables: NcVariables, name: str, line: int) -> Value:
    """The value of an expression. Raises InputError where an operand is of the wrong kind or there is no result."""
    # a long sum is deep on its left only: down there in a loop, for Python has a limit of its own
    waiting: list[Operation] = []
    while isinstance(node, Operation):
        waiting.append(node)
        node = node.operands[0]
    if isinstance(node, Constant):
        value = node.value
    else:
        value = variables.read(node, indices(node, variables, name, line), line)
    while waiting:
        operation = waiting.pop()
        others = [evaluate(operand, variables, name, line) for operand in operation.operands[1:]]
        value = _result(operation, [value, *others], name, line)
    return value


def _result(node: Operation, operands: list[Value], name: str, line: int) -> Value:
    kinds = {_kind(operand) for operand in operands}
    wanted = _WANTED.get(node.name, {"number"})
    if not (kinds <= wanted and (len(kinds) == 1 or node.name == "<<")):
        refuse(name, line, node.column, f"{node.name} is applied to {' and '.join(sorted(kinds))}")
    try:
        result = _apply(node.name, operands)
    except (ValueError, ZeroDivisionError, OverflowError):
        refuse(name, line, node.column, f"{node.name} has no result for {', '.join(map(str, operands))}")
    if isinstance(result, float) and not abs(result) <= LARGEST:
        refuse(name, line, node.column, f"{node.name} gives {result:g}: a number may be at most {LARGEST:.0f} in size")
    if isinstance(result, str) and len(result) > LONGEST_TEXT:
        what = f"the text has {len(result)} characters; the control holds at most {LONGEST_TEXT}"
        refuse(name, line, node.column, what)
    return result


def indices(variable: NcVariable, variables: NcVariables, name: str, line: int) -> tuple[int, ...]:
    """Whole numbers in the brackets of a variable."""
    values = [number(index, variables, name, line, variable.column) for index in variable.index]
    for value in values:
        if value != int(value) or value < 0:
            refuse(name, line, variable.column, f"{variable.name}[{value:g}]: the index must be a whole number from 0")
    return tuple(int(value) for value in values)


def number(node: Node, variables: NcVariables, name: str, line: int, column: int) -> float:
    """The value of an expression that must be a number."""
    if isinstance(node, Constant) and isinstance(node.value, float):
        return node.value
    value = evaluate(node, variables, name, line)
    if isinstance(value, str | bool):
        refuse(name, line, column, f"a number is needed here, not a {_kind(value)}")
    return float(value)


_TRUTH = {"truth value"}
_WANTED: Mapping[str, set[str]] = {
    "AND": _TRUTH,
    "OR": _TRUTH,
    "XOR": _TRUTH,
    "NOT": _TRUTH,
    "<<": {"number", "text"},
    "==": {"number", "text", "truth value"},
    "<>": {"number", "text", "truth value"},
}


def _kind(value: Value) -> str:
    if isinstance(value, bool):
        return "truth value"
    return "text" if isinstance(value, str) else "number"


def _apply(name: str, operands: list) -> Value:
    if name in FUNCTIONS:
        return float(FUNCTIONS[name][1](*operands))
    return _OPERATORS[name](*operands)


def _same(a: Value, b: Value) -> bool:
    return math.isclose(a, b, rel_tol=_EQUAL) if isinstance(a, float) and isinstance(b, float) else a == b


def _written(value: Value) -> str:
    """A number as the control writes it into a text: no more decimals than it needs, and no exponent."""
    if isinstance(value, str):
        return value
    text = f"{value:.9f}".rstrip("0").rstrip(".")
    return "0" if text == "-0" else text


_OPERATORS: Mapping[str, Callable[..., Value]] = {
    "negative": lambda a: -a,
    "NOT": lambda a: not a,
    "*": lambda a, b: a * b,
    "/": lambda a, b: a / b,
    "DIV": lambda a, b: float(math.trunc(a / b)),
    "MOD": math.fmod,
    "+": lambda a, b: a + b,
    "-": lambda a, b: a - b,
    "AND": lambda a, b: a and b,
    "XOR": lambda a, b: a != b,
    "OR": lambda a, b: a or b,
    "<<": lambda a, b: _written(a) + _written(b),
    "==": _same,
    "<>": lambda a, b: not _same(a, b),
    "<": lambda a, b: a < b and not _same(a, b),
    ">": lambda a, b: a > b and not _same(a, b),
    "<=": lambda a, b: a < b or _same(a, b),
    ">=": lambda a, b: a > b or _same(a, b),
}
