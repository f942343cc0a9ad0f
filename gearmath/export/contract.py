"""The typed C functions around a body in double precision: what they promise is in ``library/gm_status.h``.

Each returns a status; refuses pointers that are null, numbers outside the domain, and points where a requirement does
not hold; and leaves NaN in every output of a point that it refuses. A batch does so point by point, and names the
first bad one.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import casadi as ca
import sympy as sp

import derivations
from derivations.expression import Expression, Quantity
from gearmath.engine.kernel import Kernel
from gearmath.engine.vector_c import split_c
from gearmath.export.wrapper import Sizes, columns, transposed, wrapped
from gearmath.kernels import kernel as chapter_kernel

#: An input may be outside its range by this part of the larger end: a unit vector has components of 1 + 2e-16.
_SLACK = 1e-9
#: The range of a header is the one that is tested; numbers are taken up to this many times beyond it.
_BEYOND = 10.0


def with_margins(kernel: Kernel) -> ca.Function:
    """The function of a kernel with one more output, the least of its requirements, which must be above zero.

    What both need is computed once: those of a chapter are lowered together. A kernel without requirements keeps its
    function.
    """
    if not kernel.requires:
        return kernel.function
    from gearmath.lowering import lower  # loads SymPy

    margin = Quantity("margin", "least of the requirements", "1", "m")
    if kernel.name in derivations.index() and kernel is chapter_kernel(kernel.name):
        whole = derivations.derive(kernel.name)
        outputs = (*whole.outputs, (margin, sp.Min(*whole.requires)))
        return lower(Expression(kernel.name, kernel.description, kernel.inputs, outputs)).function
    symbols = {s.name: s for quantity in kernel.inputs for s in quantity.symbols}
    relations = [sp.sympify(requirement, locals=symbols) for requirement in kernel.requires]
    least = sp.Min(*(relation.lhs - relation.rhs for relation in relations))  # each reads "... > 0"
    required = lower(Expression(f"{kernel.name}_margin", "Requirement.", kernel.inputs, ((margin, least),))).function
    arguments = [ca.SX.sym(q.name, *kernel.function.size_in(k)) for k, q in enumerate(kernel.inputs)]
    results = ca.cse([*kernel.function.call(arguments), *required.call(arguments)])
    names = [quantity.name for quantity in kernel.inputs], [*(q.name for q in kernel.outputs), margin.name]
    return ca.Function(kernel.name, arguments, results, *names)


#: Kernels whose batches mostly follow a roll: what does not depend on the cradle rotation is computed once for all.
_ALONG_A_ROLL = frozenset({"axis_transform"})


def declarations(kernel: Kernel) -> str:
    """``int gm_<name>(...)`` and ``int gm_<name>_batch(...)``."""
    return f"GM_API {_declaration(kernel)};\n\nGM_API {_batch_declaration(kernel)};\n"


def definitions(kernel: Kernel, function: ca.Function, entry: str, sizes: Sizes) -> str:
    """Both functions, and what they share. ``function`` is that of ``with_margins``, ``entry`` its name in C."""
    may_fail = not function.is_a("SXFunction")
    roll = _roll(kernel, function) if kernel.name in _ALONG_A_ROLL else ""
    point = _point(kernel, entry, sizes, may_fail)
    return "\n".join((_domains(kernel), point, roll, _single(kernel), _batch(kernel, bool(roll))))


def _declaration(kernel: Kernel) -> str:
    inputs = [f"const double {q.name}[{q.size}]" if q.shape else f"double {q.name}" for q in kernel.inputs]
    outputs = [f"double {q.name}[{q.size}]" if q.shape else f"double *{q.name}" for q in kernel.outputs]
    return wrapped(f"int gm_{kernel.name}", [*inputs, *outputs])


def _batch_declaration(kernel: Kernel) -> str:
    inputs = [f"const double *{q.name}, int64_t {q.name}_stride" for q in kernel.inputs]
    outputs = [f"double *{q.name}" for q in kernel.outputs]
    return wrapped(f"int gm_{kernel.name}_batch", ["int64_t n", *inputs, *outputs, "int64_t *first_bad"])


def _domains(kernel: Kernel) -> str:
    """Whether each input is in its domain."""
    lines: list[str] = []
    for q in kernel.inputs:
        name = f"gm_{kernel.name}_{q.name}"
        lines.append(f"static int {name}_inside(const double *x)\n{{")
        if q.elements[0].values:
            assert q.size == 1
            either = " || ".join(f"x[0] == {float(value)!r}" for value in q.values)
            lines.append(f"  return {either};\n}}")
            continue
        for end, bound in enumerate(("low", "high")):
            numbers = ", ".join(f"{_ends(element)[end]!r}" for element in q.elements).replace("inf", "HUGE_VAL")
            lines.append(f"  static const double {bound}[{q.size}] = {{{_folded(numbers)}}};")
        lines.append(f"  return gm_inside(x, {q.size}, low, high);\n}}")
    return "\n".join(lines) + "\n"


def _folded(numbers: str) -> str:
    return numbers if len(numbers) < 80 else "\n    " + numbers.replace(", ", ",\n    ")


def taken(element: Quantity) -> tuple[float, float]:
    """The least and the greatest number that is taken for an input.

    Sizes, rolls and directions may be far beyond what is tested. Components of unit vectors may not, and angles that
    are never zero, or a little below it at most, go to a right one: beyond, they are of another unit.
    """
    low, high = map(float, element.domain)
    if element.unit == "1" and (low, high) == (-1.0, 1.0):
        return low, high
    low = low / _BEYOND if low > 0 else low * _BEYOND
    high = high * _BEYOND if high > 0 else high / _BEYOND
    right, (first, last) = math.pi / 2, map(float, element.domain)
    acute = element.unit == "rad" and first != 0 and 2 * abs(first) < last and (first > 0 or last < right)
    return (max(low, -right), min(high, right)) if acute else (low, high)


def _ends(element: Quantity) -> tuple[float, float]:
    low, high = taken(element)
    slack = _SLACK * max(abs(low), abs(high))
    return (low - slack, high + slack) if slack < float("inf") else (low, high)


def _point(kernel: Kernel, entry: str, sizes: Sizes, may_fail: bool) -> str:
    """One point whose inputs are in their domains: hands pointers to the body, and looks at what comes out."""
    lines = [f"  const double *arg[{sizes.arg}];", f"  double *res[{sizes.res}];"]
    lines += [
        f"  {kind} {name}[{size}];" for kind, name, size in (("int", "iw", sizes.iw), ("double", "w", sizes.w)) if size
    ]
    lines += ["  double margin;"] * bool(kernel.requires)
    lines += [f"  double {q.name}_columns[{q.size}];" for q in (*kernel.inputs, *kernel.outputs) if len(q.shape) > 1]
    for k, quantity in enumerate(kernel.inputs):
        lines += [f"  {quantity.name}_columns[{c}] = {quantity.name}[{r}];" for c, r in transposed(quantity)]
        lines.append(f"  arg[{k}] = {columns(quantity, '')};")
    lines += [f"  res[{k}] = {columns(quantity, '')};" for k, quantity in enumerate(kernel.outputs)]
    if kernel.requires:
        lines.append(f"  res[{len(kernel.outputs)}] = &margin;")
    call = f"{entry}(arg, res, {'iw' if sizes.iw else '0'}, {'w' if sizes.w else '0'}, 0)"
    lines.append(f"  if ({call} != 0) return GM_E_NO_RESULT;" if may_fail else f"  (void){call};")
    if kernel.requires:
        lines.append("  if (!(margin > 0.0)) return GM_E_REQUIRES;")
    for quantity in kernel.outputs:
        lines += [f"  {quantity.name}[{r}] = {quantity.name}_columns[{c}];" for c, r in transposed(quantity)]
    finite = " && ".join(f"gm_finite({q.name}, {q.size})" for q in kernel.outputs)
    lines.append(f"  return {finite} ? GM_OK : GM_E_NO_RESULT;")
    arguments = [f"const double *{q.name}" for q in kernel.inputs] + [f"double *{q.name}" for q in kernel.outputs]
    head = wrapped(f"static int gm_{kernel.name}_point", arguments)
    return "\n".join((head, "{", *lines, "}\n"))


def _roll(kernel: Kernel, function: ca.Function) -> str:
    """The points of a batch that differ in theta only; the same operations as one by one, and so the same bits."""
    name = f"gm_{kernel.name}_roll"
    size, text = split_c(function, [q.name == "theta" for q in kernel.inputs], f"{name}_point")
    shared = [q.name for q in kernel.inputs if q.name != "theta"]
    (output,) = kernel.outputs
    arguments = ["int64_t n", *(f"const double *{q}" for q in shared), "const double *theta, int64_t theta_stride"]
    head = wrapped(f"static int {name}", [*arguments, f"double *{output.name}", "int64_t *first_bad"])
    lines = [
        f"  double table[{size}], margin;",
        "  int status = GM_OK;",
        "  int64_t k;",
        f"  {name}_point_shared({', '.join(shared)}, table);",
        "  for (k = 0; k < n; ++k) {",
        f"    double *now = {output.name} + k * {output.size};",
        "    int bad = GM_E_DOMAIN;",
        f"    if (gm_{kernel.name}_theta_inside(theta + k * theta_stride)) {{",
        f"      {name}_point(theta + k * theta_stride, table, now, &margin);",
        f"      bad = !(margin > 0.0) ? GM_E_REQUIRES : gm_finite(now, {output.size}) ? GM_OK : GM_E_NO_RESULT;",
        "    }",
        "    if (bad != GM_OK) {",
        f"      gm_nan(now, {output.size});",
        "      if (status == GM_OK) {",
        "        status = bad;",
        "        if (first_bad) *first_bad = k;",
        "      }",
        "    }",
        "  }",
        "  return status;",
    ]
    return "\n".join((f'#include "gm_lane.h"\n{text}', head, "{", *lines, "}\n"))


def _single(kernel: Kernel) -> str:
    pointers = [q.name for q in (*kernel.inputs, *kernel.outputs) if q.shape or q in kernel.outputs]
    inside = [f"gm_{kernel.name}_{q.name}_inside({_address(q)})" for q in kernel.inputs]
    call = wrapped(
        f"    status = gm_{kernel.name}_point", [*map(_address, kernel.inputs), *(q.name for q in kernel.outputs)]
    )
    lines = [
        "  int status = GM_E_DOMAIN;",
        f"  if ({_any(f'!{name}' for name in pointers)}) return GM_E_NULL;",
        "  if (" + "\n      && ".join(inside) + ") {",
        f"{call};",
        "  }",
        "  if (status != GM_OK) {",
        *(f"    gm_nan({q.name}, {q.size});" for q in kernel.outputs),
        "  }",
        "  return status;",
    ]
    return "\n".join((_declaration(kernel), "{", *lines, "}\n"))


def _batch(kernel: Kernel, has_roll: bool) -> str:
    """The loop over n points: what all points share is looked at once."""
    inputs, outputs = kernel.inputs, kernel.outputs
    pointers = [q.name for q in (*inputs, *outputs)]
    at_inputs = [f"{q.name} + k * {q.name}_stride" for q in inputs]
    at_outputs = [f"{q.name} + k{f' * {q.size}' if q.size > 1 else ''}" for q in outputs]
    shared = [f"({q.name}_stride != 0 || gm_{kernel.name}_{q.name}_inside({q.name}))" for q in inputs]
    own = [
        f"({q.name}_stride == 0 || gm_{kernel.name}_{q.name}_inside({at}))"
        for q, at in zip(inputs, at_inputs, strict=True)
    ]
    call = wrapped(f"      now = gm_{kernel.name}_point", [*at_inputs, *at_outputs])
    lines = [
        "  int status = GM_OK, shared;",
        "  int64_t k;",
        "  if (first_bad) *first_bad = -1;",
        f"  if (n < 0 || {_any(f'{q.name}_stride < 0' for q in inputs)}) return GM_E_SIZE;",
        "  if (n == 0) return GM_OK;",
        f"  if ({_any(f'!{name}' for name in pointers)}) return GM_E_NULL;",
        "  shared = " + "\n      && ".join(shared) + ";",
        *(_along_a_roll(kernel) if has_roll else ()),
        "  for (k = 0; k < n; ++k) {",
        "    int now = GM_E_DOMAIN;",
        "    if (shared\n        && " + "\n        && ".join(own) + ") {",
        f"{call};",
        "    }",
        "    if (now != GM_OK) {",
        *(f"      gm_nan({at}, {q.size});" for q, at in zip(outputs, at_outputs, strict=True)),
        "      if (status == GM_OK) {",
        "        status = now;",
        "        if (first_bad) *first_bad = k;",
        "      }",
        "    }",
        "  }",
        "  return status;",
    ]
    return "\n".join((_batch_declaration(kernel), "{", *lines, "}\n"))


def _along_a_roll(kernel: Kernel) -> Iterator[str]:
    shared = [q.name for q in kernel.inputs if q.name != "theta"]
    yield f"  if (shared && {' && '.join(f'{name}_stride == 0' for name in shared)}) {{"
    arguments = ["n", *shared, "theta, theta_stride", *(q.name for q in kernel.outputs), "first_bad"]
    yield f"{wrapped(f'    return gm_{kernel.name}_roll', arguments)};"
    yield "  }"


def _any(conditions: Iterator[str]) -> str:
    return " || ".join(conditions)


def _address(quantity: Quantity) -> str:
    return quantity.name if quantity.shape else f"&{quantity.name}"
