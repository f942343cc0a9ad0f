"""Vectors for the self-test of the C library: inputs in the domain, and what CasADi's functions make of them.

A vector is taken only where a change of the inputs in the twelfth digit changes no output in the tenth, so that another
C library, whose sine differs in the last bit, is not mistaken for an error.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
import sympy as sp

from gearmath.engine.kernel import Kernel
from gearmath.errors import ComputationError
from gearmath.export.header import versions

#: Vectors of each function.
COUNT = 12
#: What a self-test lets an output deviate by, as part of it, or of 1 where it is less.
TOLERANCE = 1e-9
_CHANGE, _MOVED = 1e-12, 1e-10
_DRAWN, _MOST_DRAWS = 200, 50


def sample(kernel: Kernel, count: int, generator: np.random.Generator) -> list[np.ndarray]:
    """One array (count, *shape) for each input: within domains and values, requirements above zero."""
    symbols = {s.name: s for quantity in kernel.inputs for s in quantity.symbols}
    relations = [sp.sympify(requirement, locals=symbols) for requirement in kernel.requires]
    tests = [sp.lambdify(list(symbols.values()), relation, "numpy") for relation in relations]
    elements = [element for quantity in kernel.inputs for element in quantity.elements]
    kept = np.empty((0, len(elements)))
    while len(kept) < count:
        drawn = np.column_stack(
            [
                generator.choice(np.array(element.values, dtype=float), count)
                if element.values
                else generator.uniform(*element.domain, count)
                for element in elements
            ]
        )
        fits = np.ones(count, dtype=bool)
        for test in tests:
            fits &= test(*drawn.T)
        kept = np.vstack([kept, drawn[fits]])
    parts = np.split(kept[:count], np.cumsum([quantity.size for quantity in kernel.inputs])[:-1], axis=1)
    return [part.reshape(count, *quantity.shape) for part, quantity in zip(parts, kernel.inputs, strict=True)]


def vectors(kernel: Kernel) -> tuple[list[np.ndarray], list[np.ndarray]]:
    """Inputs and outputs (COUNT, size) of one function. Raises ComputationError where too few points are smooth."""
    generator = np.random.default_rng(17)
    kept: list[list[np.ndarray]] = [[] for _ in (*kernel.inputs, *kernel.outputs)]
    for _ in range(_MOST_DRAWS):
        drawn = sample(kernel, _DRAWN, generator)
        moved = [
            values if quantity.elements[0].values else values * (1 + _CHANGE * generator.uniform(-1, 1, values.shape))
            for values, quantity in zip(drawn, kernel.inputs, strict=True)
        ]
        smooth = np.ones(_DRAWN, dtype=bool)
        found = kernel(*drawn)
        for one, other in zip(found, kernel(*moved), strict=True):
            off = np.abs(one - other) <= _MOVED * np.maximum(np.abs(one), 1.0)  # False for NaN
            smooth &= off.reshape(_DRAWN, -1).all(axis=1)
        for place, values in zip(kept, (*drawn, *found), strict=True):
            place.extend(values[smooth].reshape(int(smooth.sum()), -1))
        if len(kept[0]) >= COUNT:
            arrays = [np.array(place[:COUNT]) for place in kept]
            return arrays[: len(drawn)], arrays[len(drawn) :]
    raise ComputationError(f"{kernel.name}: no {COUNT} points of its domain are smooth enough for a self-test")


def selftest_vectors(kernels: Sequence[Kernel]) -> str:
    """The text of ``selftest_vectors.h``."""
    parts = [
        f"/* selftest_vectors.h: generated, do not edit. {versions()} */",
        f"#define GM_TEST_TOLERANCE {TOLERANCE}",
    ]
    parts += ["\n".join(_function(kernel)) for kernel in kernels]
    calls = "\n".join(f"  test_{kernel.name}();" for kernel in kernels)
    return "\n\n".join((*parts, f"static void run_vectors(void)\n{{\n{calls}\n}}\n"))


def _function(kernel: Kernel) -> Iterator[str]:
    name, (given, expected) = f"gm_{kernel.name}", vectors(kernel)
    yield f"static void test_{kernel.name}(void)\n{{"
    for quantity, values in zip(kernel.inputs, given, strict=True):
        yield _array(f"static double {quantity.name}", values)
    for quantity, values in zip(kernel.outputs, expected, strict=True):
        yield _array(f"static const double {quantity.name}_expected", values)
    for quantity in kernel.outputs:
        yield f"  double {quantity.name}[{COUNT * quantity.size}], {quantity.name}_one[{quantity.size}];"
    yield "  int64_t first_bad;\n  int k;"
    inputs = ", ".join(f"{quantity.name}, {quantity.size}" for quantity in kernel.inputs)
    outputs = ", ".join(quantity.name for quantity in kernel.outputs)
    batch = f"{name}_batch({COUNT}, {inputs}, {outputs}, &first_bad)"
    yield f'  expect("{name}_batch", {batch}, GM_OK);'
    yield f'  if (first_bad != -1) failed("{name}_batch", "names a bad point where there is none");'
    for quantity in kernel.outputs:
        yield (
            f'  compare("{name}", {quantity.name}, {quantity.name}_expected, {COUNT * quantity.size}, '
            "GM_TEST_TOLERANCE);"
        )
    yield f"  for (k = 0; k < {COUNT}; ++k) {{"
    one = [
        f"{quantity.name} + k * {quantity.size}" if quantity.shape else f"{quantity.name}[k]"
        for quantity in kernel.inputs
    ]
    ones = [f"{quantity.name}_one" for quantity in kernel.outputs]
    yield f'    expect("{name}", {name}({", ".join((*one, *ones))}), GM_OK);'
    for quantity in kernel.outputs:
        yield (
            f"    if (memcmp({quantity.name}_one, {quantity.name} + k * {quantity.size}, sizeof {quantity.name}_one))\n"
            f'      failed("{name}", "one point and a batch differ");'
        )
    yield "  }"
    bad, size = kernel.inputs[0].name, kernel.inputs[0].size
    yield f"  {bad}[3 * {size}] = NAN;"
    yield f'  expect("{name}_batch", {batch}, GM_E_DOMAIN);'
    yield f'  if (first_bad != 3) failed("{name}_batch", "does not name the bad point");'
    for quantity in kernel.outputs:
        yield f'  refused("{name}_batch", {quantity.name} + 3 * {quantity.size}, {quantity.size});'
    yield f'  expect("{name}_batch", {batch.replace(f"_batch({COUNT}, ", "_batch(-1, ")}, GM_E_SIZE);'
    yield f'  expect("{name}_batch", {batch.replace(f"{bad}, {size}", f"0, {size}", 1)}, GM_E_NULL);'
    yield "}"


def _array(declaration: str, values: np.ndarray) -> str:
    numbers = [repr(float(value)) for value in values.ravel()]
    lines = [", ".join(numbers[k : k + 5]) for k in range(0, len(numbers), 5)]
    return f"  {declaration}[{values.size}] = {{\n    " + ",\n    ".join(lines) + "};"
