"""The vector form of every expression, and of the root finders, against CasADi's virtual machine: the same bits."""

from __future__ import annotations

import ctypes
import random

import casadi as ca
import numpy as np
import pytest

import derivations
from gearmath.bevel.flank import flank_point
from gearmath.bevel.generation_kernels import generation_point, generation_sense
from gearmath.engine.compiler import compile_library
from gearmath.engine.kernel import Kernel
from gearmath.engine.run import FLAGS
from gearmath.engine.vector_c import LANES, NoVectorForm, vector_c
from gearmath.kernels import kernel

POINTS = 2 * LANES + 1  # the last vector is not full

COMPOSED = {
    "flank_point": flank_point,
    "straight_generation_point": lambda: generation_point(False),
    "generation_sense": lambda: generation_sense(True),
}


def compiled(function: ca.Function, many: tuple[bool, ...]) -> ctypes.CDLL:
    return compile_library({"kernel.c": vector_c(function, many)}, (*FLAGS, "-O1"))


def run(library: ctypes.CDLL, function: ca.Function, arguments: list[np.ndarray], n: int) -> list[np.ndarray]:
    outputs = [np.full((n, function.numel_out(k)), np.pi) for k in range(function.n_out())]
    pointers = [(ctypes.c_void_p * len(arrays))(*(a.ctypes.data for a in arrays)) for arrays in (arguments, outputs)]
    library.run(ctypes.c_longlong(n), *pointers)
    return outputs


def drawn(made: Kernel, many: tuple[bool, ...], rng: random.Random) -> list[np.ndarray]:
    """Arguments inside of their domains, element by element in CasADi's order, NaN and zeros among them."""

    def value(quantity: derivations.Quantity) -> float:
        if quantity.values:
            return rng.choice(quantity.values)
        low, high = (
            bound if np.isfinite(bound) else sign * 50.0 for bound, sign in zip(quantity.domain, (-1, 1), strict=True)
        )
        return rng.choice([0.0, -0.0, float("nan")]) if rng.random() < 0.03 else rng.uniform(low, high)

    arrays = []
    for quantity, is_many in zip(made.inputs, many, strict=True):
        rows = [[value(element) for element in quantity.elements] for _ in range(POINTS if is_many else 1)]
        arrays.append(np.array(rows, dtype=float))
    return arrays


@pytest.mark.parametrize("name", [*derivations.index(), *COMPOSED])
def test_gives_the_bits_of_the_virtual_machine(name: str, host_compiler: tuple[str, ...]) -> None:
    made, rng = COMPOSED[name]() if name in COMPOSED else kernel(name), random.Random(name)
    many = tuple(rng.random() < 0.6 for _ in made.inputs)
    many = many if any(many) else (True, *many[1:])
    arguments = drawn(made, many, rng)
    outputs = run(compiled(made.function, many), made.function, arguments, POINTS)
    for k in range(POINTS):
        point = [
            array[k if is_many else 0].reshape(made.function.size_in(i), order="F")
            for i, (array, is_many) in enumerate(zip(arguments, many, strict=True))
        ]
        expected = made.function.call([ca.DM(argument) for argument in point])
        for output, one in zip(outputs, expected, strict=True):
            np.testing.assert_array_equal(output[k], np.asarray(ca.DM(one)).ravel(order="F"))


def test_functions_of_the_same_name_are_not_taken_for_one(host_compiler: tuple[str, ...]) -> None:
    x, y = ca.SX.sym("x"), ca.MX.sym("y")
    double, square = ca.Function("step", [x], [2 * x]), ca.Function("step", [x], [x * x])
    both = ca.Function("both", [y], [square(double(y))])
    (output,) = run(compiled(both, (True,)), both, [np.array([[3.0], [4.0]])], 2)
    assert output.ravel().tolist() == [36.0, 64.0]


def test_what_scalars_cannot_do_has_no_vector_form() -> None:
    A = ca.MX.sym("A", 3, 3)
    with pytest.raises(NoVectorForm):
        vector_c(ca.Function("inverse", [A], [ca.inv(A, "qr")]), (True,))


def test_choices_take_zeros_of_both_signs_infinities_and_nan_as_the_virtual_machine_does(
    host_compiler: tuple[str, ...],
) -> None:
    """Bit by bit: masks instead of branches, in every pair of such numbers."""
    x, z = ca.SX.sym("x"), ca.SX.sym("z")
    outputs = [
        ca.fmin(x, z),
        ca.fmax(x, z),
        ca.fabs(x),
        ca.sign(x),
        ca.sqrt(ca.fabs(x)),
        ca.if_else(x, z, 0),
        x < z,
        x <= z,
        ca.eq(x, z),
        ca.ne(x, z),
        ca.logic_not(x),
        ca.logic_and(x, z),
        ca.logic_or(x, z),
        ca.if_else(x < z, x, z),
    ]
    function = ca.Function("choices", [x, z], outputs)
    values = [0.0, -0.0, 1.0, -2.5, 5e-324, float("inf"), float("-inf"), float("nan")]
    pairs = np.array([(one, other) for one in values for other in values])
    found = run(compiled(function, (True, True)), function, [pairs[:, :1].copy(), pairs[:, 1:].copy()], len(pairs))
    for k, output in enumerate(found):
        expected = np.array([float(function(*pair)[k]) for pair in pairs])
        same = output.ravel().view(np.int64) == expected.view(np.int64)
        assert (same | (np.isnan(output.ravel()) & np.isnan(expected))).all(), outputs[k]
