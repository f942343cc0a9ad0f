"""Machine-checked proofs of the step rules, for all inputs at once, from the very graphs that are exported.

The instructions of the CasADi function are walked into z3 integer terms, one term an instruction.

``gearbox_step``, 0 < N ≤ D ≤ limit, 0 ≤ a < D, d = ±1: the remainder stays in 0 ≤ a' < D; a' + s D = a + d N; s is
-1, 0 or +1 and never against the edge; no instruction leaves the integers of C; and, from the first two,
|p - N e/D| ≤ 1/2 for every history that starts at a = floor(D/2).

``gearbox_edge``, any q of its domain, 0 ≤ N' < D ≤ limit, in 32 or 64 bits: the same with the ratio q + N'/D. An edge
of whatever axis keeps p D + a - Σ N_j e_j, so |p - Σ N_j e_j/D| ≤ 1/2 for every history of the edges of all axes.

``encoder_hysteresis``, 0 ≤ x ≤ H: the play stays in 0 ≤ x' ≤ H, no count is made or lost, what passes is 0 or the edge.

``counter_motion``, any reading c and motion -M/2 ≤ m < M/2: the result is m, however often the counter ran over. So the
sum of the results is the true count, for every history of readings that are less than M/2 counts apart.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import casadi as ca

from derivations.notation import base_step, hysteresis
from gearmath.errors import ComputationError

#: Largest D by the width of the integers: a + N must fit. That these are tight is shown by a test.
WIDEST = {32: 2**30, 64: 2**62}


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


def prove_step_rule(function: ca.Function, limit: int = WIDEST[32]) -> tuple[str, ...]:
    """Prove the five claims of this module for a step rule; returns what was proved, one line a claim.

    ``function`` has the arguments and results of ``gearbox_step``. Raises ComputationError with the claim that fails
    and the inputs that break it.
    """
    import z3

    names = ("remainder", "edge", "steps_numerator", "steps_denominator")
    a, d, N, D = (z3.Int(name) for name in names)
    graph = walk(function, dict(zip(names, (a, d, N, D), strict=True)))
    step, following = graph.outputs["step"], graph.outputs["next_remainder"]
    claims = [
        *_within(z3, graph, 32),
        ("the new remainder is again in 0 <= a' < D", z3.And(following >= 0, following < D)),
        ("a' + s D = a + d N", following + step * D == a + d * N),
        ("the step is -1, 0 or +1", z3.And(step >= -1, step <= 1)),
        ("the step is never against the edge", step * d >= 0),
    ]
    proved = _prove_for_both_edges(z3, d, claims, [N > 0, N <= D, limit >= D, a >= 0, a < D])
    what = "|p - N e/D| <= 1/2 for every history from a_0 = floor(D/2)"
    _prove_half_a_step(z3, what)
    return (*proved, what)


def prove_edge_rule(function: ca.Function, bits: int = 32, limit: int | None = None) -> tuple[str, ...]:
    """Prove the claims of this module for ``gearbox_edge`` in ``bits`` = 32 or 64, D up to ``limit``.

    Returns what was proved, one line a claim. Raises ComputationError with the claim that fails and the inputs that
    break it.
    """
    import z3

    names = ("remainder", "edge", "increment", "base_step", "steps_denominator")
    a, d, N, q, D = (z3.Int(name) for name in names)
    graph = walk(function, dict(zip(names, (a, d, N, q, D), strict=True)))
    steps, following = graph.outputs["edge_steps"], graph.outputs["next_remainder"]
    low, high = (int(bound) for bound in base_step.domain)
    claims = [
        *_within(z3, graph, bits),
        ("the new remainder is again in 0 <= a' < D", z3.And(following >= 0, following < D)),
        ("a' + (steps) D = a + d (q D + N')", following + (steps - d * q) * D == a + d * N),
        ("the steps are d q, or one more or less", z3.And(steps - d * q >= -1, steps - d * q <= 1)),
        ("the step beyond d q is never against the edge", (steps - d * q) * d >= 0),
    ]
    widest = WIDEST[bits] if limit is None else limit
    proved = _prove_for_both_edges(z3, d, claims, [N >= 0, N < D, widest >= D, a >= 0, a < D, q >= low, q <= high])
    p, total, first = z3.Ints("position total start")  # total = Σ N_j e_j, of all axes, N_j = q_j D + N_j'
    s, b = z3.Ints("steps following")
    what = "an edge of any axis keeps p D + a - N_1 e_1 - N_2 e_2 - ..."
    conserved = (p + s) * D + b - (total + d * (q * D + N)) == first
    _prove(z3, what, conserved, [p * D + a - total == first, b + s * D == a + d * (q * D + N)])
    half = "|p - (N_1 e_1 + N_2 e_2 + ...)/D| <= 1/2 for every history from a_0 = floor(D/2)"
    _prove_half_a_step(z3, half)
    return (*proved, what, half)


def prove_hysteresis(function: ca.Function, limit: int = int(hysteresis.domain[1])) -> tuple[str, ...]:
    """Prove the claims of this module for ``encoder_hysteresis`` with H up to ``limit``, as the others do."""
    import z3

    names = ("play", "edge", "hysteresis")
    x, d, H = (z3.Int(name) for name in names)
    graph = walk(function, dict(zip(names, (x, d, H), strict=True)))
    passed, following = graph.outputs["passed_edge"], graph.outputs["next_play"]
    claims = [
        *_within(z3, graph, 32),
        ("the play stays in 0 <= x' <= H", z3.And(following >= 0, following <= H)),
        ("x' + d' = x + d", following + passed == x + d),
        ("what passes is nothing, or the edge", z3.Or(passed == 0, passed == d)),
        ("an edge passes exactly where the play is used up", (passed == 0) == z3.And(x + d >= 0, x + d <= H)),
    ]
    return _prove_for_both_edges(z3, d, claims, [x >= 0, x <= H, limit >= H])


def prove_counter(function: ca.Function, reach: int = 2**15) -> tuple[str, ...]:
    """Prove the claims of this module for ``counter_motion`` and motions -reach <= m < reach, as the others do."""
    import z3

    M = 2**16
    c, now, m, k, total = z3.Ints("count_before count_now motion wraps total")
    graph = walk(function, {"count_before": c, "count_now": now})
    counted = graph.outputs["counted"]
    given = [c >= 0, c < M, now == c + m - k * M, now >= 0, now < M, m >= -reach, m < reach]
    claims = [
        *_within(z3, graph, 32),
        ("what is counted is the motion", counted == m),
        ("the sum goes on as the true count", total + counted == total + m),
    ]
    for what, claim in claims:
        _prove(z3, what, claim, given)
    return tuple(what for what, _ in claims)


def _within(z3: Any, graph: Walk, bits: int) -> list[tuple[str, Any]]:
    """No instruction overflows."""
    low, high = -(2 ** (bits - 1)), 2 ** (bits - 1) - 1
    return [(f"{what} stays within {bits} bits", z3.And(value >= low, value <= high)) for what, value in graph.values]


def _prove_for_both_edges(z3: Any, edge: Any, claims: list[tuple[str, Any]], assumptions: list[Any]) -> tuple[str, ...]:
    for what, claim in claims:
        for sign in (1, -1):  # a product by a known sign is linear, which z3 decides at once
            given = (edge, z3.IntVal(sign))
            _prove(z3, what, z3.substitute(claim, given), [*assumptions, edge == sign])
    return tuple(what for what, _ in claims)


def _prove_half_a_step(z3: Any, what: str) -> None:
    """p D - N e = a_0 - a is kept, so the error is |a_0 - a|/D."""
    a, start, D = z3.Ints("remainder start steps_denominator")
    ranges = [D > 0, 2 * start <= D, 2 * start + 1 >= D, a >= 0, a < D]
    _prove(z3, what, z3.And(2 * (start - a) <= D, 2 * (a - start) <= D), ranges)


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
