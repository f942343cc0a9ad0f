"""Machine-checked proof of the step rule, for all inputs at once, from the very graph that is exported.

The instructions of the CasADi function are walked into z3 integer terms, one term an instruction. Proved for
0 < N ≤ D ≤ limit, 0 ≤ a < D and d = ±1: the remainder stays in 0 ≤ a' < D; a' + s D = a + d N; s is -1, 0 or +1 and
never against the edge; no instruction leaves the 32-bit range; and, from the first two, |p - N e/D| ≤ 1/2 for every
history that starts at a = floor(D/2).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import casadi as ca

from gearmath.errors import ComputationError
from gearmath.gearbox.train import WIDEST

INT32 = (-(2**31), 2**31 - 1)


@dataclass(frozen=True)
class Walk:
    """A function as z3 terms: its outputs by name, and every intermediate value with the name of its operation."""

    outputs: dict[str, Any]
    values: tuple[tuple[str, Any], ...]


def walk(function: ca.Function, inputs: dict[str, Any]) -> Walk:
    """The instructions of an SX function of scalars as z3 integer terms.

    Raises ComputationError naming an operation that has no meaning in whole numbers.
    """
    import z3

    rules = _rules(z3)
    work: dict[int, Any] = {}
    outputs: dict[str, Any] = {}
    values: list[tuple[str, Any]] = []
    for k in range(function.n_instructions()):
        operation = function.instruction_id(k)
        source, target = function.instruction_input(k), function.instruction_output(k)
        if operation == ca.OP_OUTPUT:
            outputs[function.name_out(target[0])] = work[source[0]]
            continue
        if operation == ca.OP_INPUT:
            name, value = "input", inputs[function.name_in(source[0])]
        elif operation == ca.OP_CONST:
            name, value = "constant", z3.IntVal(_whole(function.instruction_constant(k), function.name()))
        elif operation in rules:
            name, rule = rules[operation]
            value = rule(*(work[index] for index in source))
        else:
            raise ComputationError(
                f"{function.name()}: operation {operation} of instruction {k} has no whole-number meaning"
            )
        work[target[0]] = value
        values.append((f"{name} (instruction {k})", value))
    return Walk(outputs, tuple(values))


def prove_step_rule(function: ca.Function, limit: int = WIDEST) -> tuple[str, ...]:
    """Prove the five claims of this module for a step rule; returns what was proved, one line a claim.

    ``function`` has the arguments and results of ``gearbox_step``. Raises ComputationError with the claim that fails
    and the inputs that break it.
    """
    import z3

    names = ("remainder", "edge", "steps_numerator", "steps_denominator")
    a, d, N, D = (z3.Int(name) for name in names)
    graph = walk(function, dict(zip(names, (a, d, N, D), strict=True)))
    step, following = graph.outputs["step"], graph.outputs["next_remainder"]
    claims: list[tuple[str, Any]] = [
        (f"{what} stays within 32 bits", z3.And(value >= INT32[0], value <= INT32[1])) for what, value in graph.values
    ]
    claims += [
        ("the new remainder is again in 0 <= a' < D", z3.And(following >= 0, following < D)),
        ("a' + s D = a + d N", following + step * D == a + d * N),
        ("the step is -1, 0 or +1", z3.And(step >= -1, step <= 1)),
        ("the step is never against the edge", step * d >= 0),
    ]
    proved = []
    for what, claim in claims:
        for edge in (1, -1):  # a product by a known sign is linear, which z3 decides at once
            _prove(z3, what, claim, [d == edge, N > 0, N <= D, limit >= D, a >= 0, a < D])
        proved.append(what)
    start = z3.Int("start")  # p D - N e = a_0 - a is conserved, so the error is |a_0 - a|/D
    ranges = [D > 0, 2 * start <= D, 2 * start + 1 >= D, a >= 0, a < D]
    what = "|p - N e/D| <= 1/2 for every history from a_0 = floor(D/2)"
    _prove(z3, what, z3.And(2 * (start - a) <= D, 2 * (a - start) <= D), ranges)
    return (*proved, what)


def _prove(z3: Any, what: str, claim: Any, assumptions: list[Any]) -> None:
    solver = z3.Solver()
    solver.set("timeout", 20_000)  # ms; each claim takes milliseconds
    solver.add(*assumptions, z3.Not(claim))
    result = solver.check()
    if result == z3.sat:
        model = solver.model()
        case = ", ".join(sorted(f"{variable.name()} = {model[variable]}" for variable in model.decls()))
        raise ComputationError(f"not true: {what}; for {case}")
    if result != z3.unsat:
        raise ComputationError(f"not decided: {what}: {solver.reason_unknown()}")


def _whole(value: float, name: str) -> int:
    if value != int(value):
        raise ComputationError(f"{name}: the constant {value} is no whole number")
    return int(value)


def _rules(z3: Any) -> dict[int, tuple[str, Callable[..., Any]]]:
    """CasADi operation -> its name and its meaning in whole numbers; truth values are 0 and 1, as in C."""

    def truth(condition: Any) -> Any:
        return z3.If(condition, 1, 0)

    return {
        ca.OP_ASSIGN: ("assignment", lambda x: x),
        ca.OP_ADD: ("sum", lambda x, y: x + y),
        ca.OP_SUB: ("difference", lambda x, y: x - y),
        ca.OP_MUL: ("product", lambda x, y: x * y),
        ca.OP_NEG: ("negation", lambda x: -x),
        ca.OP_SQ: ("square", lambda x: x * x),
        ca.OP_LT: ("comparison", lambda x, y: truth(x < y)),
        ca.OP_LE: ("comparison", lambda x, y: truth(x <= y)),
        ca.OP_EQ: ("comparison", lambda x, y: truth(x == y)),
        ca.OP_NE: ("comparison", lambda x, y: truth(x != y)),
        ca.OP_NOT: ("not", lambda x: truth(x == 0)),
        ca.OP_AND: ("and", lambda x, y: truth(z3.And(x != 0, y != 0))),
        ca.OP_OR: ("or", lambda x, y: truth(z3.Or(x != 0, y != 0))),
        ca.OP_IF_ELSE_ZERO: ("choice", lambda x, y: z3.If(x != 0, y, 0)),
        ca.OP_SIGN: ("sign", lambda x: truth(x > 0) - truth(x < 0)),
    }
