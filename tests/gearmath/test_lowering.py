"""Lowered functions against SymPy with 50 digits, on samples of their domains; and what lowering refuses."""

from __future__ import annotations

import math
import random
from collections.abc import Callable, Iterator

import mpmath
import numpy as np
import pytest
import sympy as sp

import derivations
from derivations.expression import Expression, Quantity
from gearmath.engine.kernel import Kernel
from gearmath.errors import InputError
from gearmath.lowering import RULES, LoweringError, lower

DIGITS = 50
SAMPLES = 100
TOLERANCE = 1e-12  # of the value, or of the scale that its quantity declares

each_expression = pytest.mark.parametrize("expression", derivations.index(), indirect=True)
#: floor jumps: just below a whole number its double may be one more, see the two tests of the gearbox below
WITH_FLOOR = ("nearest_position", "floor_position", "gearbox_start")


@pytest.fixture
def expression(request: pytest.FixtureRequest) -> Expression:
    """Derived when its test runs: a process that runs other tests derives none."""
    return derivations.derive(request.param)


Point = list[list[float]]  # for every input its elements: exactly the same doubles for SymPy and for CasADi


def inside(element: Quantity, rng: random.Random) -> float:
    if element.values:
        return rng.choice(element.values)
    low, high = element.domain
    return rng.randint(int(low), int(high)) if element.kind == "int" else rng.uniform(low, high)


def corner(element: Quantity, rng: random.Random) -> float:
    return rng.choice(element.values or element.domain)


def exactly(expression: Expression, values: list[sp.Basic]) -> Callable[[Point], list]:
    """SymPy's own value of ``values`` in 50 digits, as a function of a point."""
    symbols = [symbol for quantity in expression.inputs for symbol in quantity.symbols]
    function = sp.lambdify(symbols, values, "mpmath", cse=True)  # SymPy's own, and ten times as fast

    def evaluate(point: Point) -> list:
        with mpmath.workdps(DIGITS):
            return function(*(mpmath.mpf(number) for numbers in point for number in numbers))

    return evaluate


def points(expression: Expression, draw: Callable, count: int, seed: str) -> list[Point]:
    """Points of the domain at which ``requires`` holds, by rejection; fewer than ``count`` if they are rare."""
    rng = random.Random(seed)
    allowed = exactly(expression, list(expression.requires))
    found = []
    for _ in range(500 * count):
        point = [[draw(element, rng) for element in quantity.elements] for quantity in expression.inputs]
        if all(value > 0 for value in allowed(point)):
            found.append(point)
            if len(found) == count:
                break
    return found


def lowered(kernel: Kernel, some: list[Point]) -> np.ndarray:
    """Every output element (column) at every point (row), in one call of the kernel."""
    arguments = [
        np.array([point[k] for point in some], dtype=float).reshape(len(some), *quantity.shape)
        for k, quantity in enumerate(kernel.inputs)
    ]
    return np.hstack([output.reshape(len(some), -1) for output in kernel(*arguments)])


def failures(expression: Expression, some: list[Point]) -> Iterator[str]:
    evaluate = exactly(expression, [value for _, value in expression.scalars()])
    for point, row in zip(some, lowered(lower(expression), some), strict=True):
        for (element, _), number, exact in zip(expression.scalars(), row, evaluate(point), strict=True):
            error, limit = abs(mpmath.mpf(float(number)) - exact), TOLERANCE * max(abs(exact), element.scale)
            if not error <= limit:
                yield f"{element.name} = {number!r}, error {float(error):.2e} > {float(limit):.2e} at {point}"


@each_expression
def test_every_input_has_a_finite_domain(expression: Expression) -> None:
    elements = [element for quantity in expression.inputs for element in quantity.elements]
    assert [e.name for e in elements if not e.values and not all(map(math.isfinite, e.domain))] == []


@each_expression
def test_lowered_function_equals_sympy_in_50_digits_within_its_domain(expression: Expression) -> None:
    some = points(expression, inside, SAMPLES, expression.name)
    assert len(some) == SAMPLES
    assert list(failures(expression, some)) == []


@pytest.mark.parametrize("expression", [name for name in derivations.index() if name not in WITH_FLOOR], indirect=True)
def test_lowered_function_equals_sympy_in_50_digits_in_corners_of_its_domain(expression: Expression) -> None:
    some = points(expression, corner, 20, expression.name + ", corners")
    assert some
    assert list(failures(expression, some)) == []


@pytest.mark.parametrize("expression", WITH_FLOOR, indirect=True)
def test_only_what_jumps_is_left_out_in_the_corners(expression: Expression) -> None:
    assert any(sp.sympify(value).has(sp.floor) for _, value in expression.scalars())


@each_expression
def test_samples_take_every_branch(expression: Expression) -> None:
    branches = {p for _, value in expression.scalars() for p in sp.sympify(value).atoms(sp.Piecewise)}
    some = points(expression, inside, SAMPLES, expression.name)
    for piecewise in branches:
        cases = [(number, condition) for number, (_, condition) in enumerate(piecewise.args)]
        which = exactly(expression, [sp.Piecewise(*cases)])
        assert {int(which(point)[0]) for point in some} == set(range(len(cases))), piecewise


@each_expression
def test_names_units_and_descriptions_survive(expression: Expression) -> None:
    kernel = lower(expression)
    assert kernel.name == expression.name == kernel.function.name()
    assert kernel.description == expression.description
    assert kernel.source == expression.source
    assert len(kernel.requires) == len(expression.requires)
    assert kernel.inputs == expression.inputs
    assert kernel.outputs == tuple(quantity for quantity, _ in expression.outputs)
    assert kernel.function.name_in() == [quantity.name for quantity in expression.inputs]
    for k, quantity in enumerate(kernel.inputs):
        assert kernel.function.size_in(k) == (*quantity.shape, 1, 1)[:2]
    for k, quantity in enumerate(kernel.outputs):
        assert kernel.function.size_out(k) == (*quantity.shape, 1, 1)[:2]


# --- the two rules of the gearbox that jump ---------------------------------------------------------------------


def position(name: str) -> tuple[Kernel, Expression]:
    expression = derivations.derive(name)
    return lower(expression), expression


def just_below_a_step(N: int, D: int, turns: int) -> int:
    """The count e for which N e / D + 1/2 lies only 1/(2 D) below a whole number; D odd, N and D coprime."""
    return pow(N, -1, D) * (D - 1) // 2 % D + turns * D


def test_nearest_step_is_exact_beside_its_jumps_while_a_double_holds_the_numerator() -> None:
    kernel, _ = position("nearest_position")
    rng = random.Random(7)
    tried = 0
    while tried < 1000:
        D, N = rng.randrange(3, 2**20, 2), rng.randrange(1, 2**20)
        if math.gcd(N, D) == 1:
            e = just_below_a_step(N, D, rng.randint(-(2**10), 2**10))
            assert abs(2 * N * e + D) < 2**53
            assert (2 * N * e + D) % (2 * D) == 2 * D - 1
            assert float(kernel(e, N, D)[0]) == (2 * N * e + D) // (2 * D)
            tried += 1


def test_nearest_step_in_doubles_is_off_beyond_its_requirement() -> None:
    """Why ``requires`` is there, and why the firmware has (7.5) in integers instead."""
    kernel, expression = position("nearest_position")
    N, D = 2**30 - 3, 2**30 - 1
    e = just_below_a_step(N, D, 1)
    assert all(value <= 0 for value in exactly(expression, list(expression.requires))([[e], [N], [D]]))
    assert float(kernel(e, N, D)[0]) == (2 * N * e + D) // (2 * D) + 1


def test_floating_rule_of_the_source_text_loses_its_step_just_below_a_whole_number() -> None:
    """Why the firmware counts in integers: the double 0.1 lies above 1/10, so one count is not quite 10 steps."""
    kernel, expression = position("floor_position")
    e, R = (quantity.symbol for quantity in expression.inputs)
    assert expression["floor_position"].subs({e: 1, R: sp.Rational(0.1)}) == 9
    assert float(kernel(1, 0.1)[0]) == 10


# --- rules ------------------------------------------------------------------------------------------------------

X, Y = (Quantity(name, "a test quantity", "1", name, (0.1, 0.9)) for name in "xy")
RESULT = Quantity("result", "a test quantity", "1", "z")
x, y = X.symbol, Y.symbol


def of_two(value: sp.Basic) -> Expression:
    return Expression("of_two", "A function of two numbers.", (X, Y), ((RESULT, value),))


def truth(condition: sp.Basic) -> sp.Piecewise:
    return sp.Piecewise((1, condition), (0, True))


ONE_OF_EACH_RULE = {
    sp.Add: x + y + sp.Rational(1, 3),
    sp.Mul: -2 * x * y / 3,
    sp.sin: sp.sin(x),
    sp.cos: sp.cos(x),
    sp.tan: sp.tan(x),
    sp.asin: sp.asin(x),
    sp.acos: sp.acos(x),
    sp.atan: sp.atan(x),
    sp.atan2: sp.atan2(x - y, y - sp.Rational(1, 2)),
    sp.exp: sp.exp(x),
    sp.log: sp.log(x),
    sp.Abs: sp.Abs(x - y),
    sp.sign: sp.sign(x - y),
    sp.floor: sp.floor(9 * x),
    sp.Max: sp.Max(x, y, sp.Rational(1, 2)),
    sp.Min: sp.Min(x, y, sp.Rational(1, 2)),
    sp.StrictGreaterThan: truth(x > y),
    sp.GreaterThan: truth(x >= y),
    sp.StrictLessThan: truth(x < y),
    sp.LessThan: truth(x <= y),
    sp.Equality: truth(sp.Eq(x, y)),
    sp.Unequality: truth(sp.Ne(x, y)),
    sp.And: truth((x > y) & (x > sp.Rational(1, 2))),
    sp.Or: truth((x > y) | (x > sp.Rational(1, 2))),
    sp.Not: truth(sp.Not((x > y) & (x > sp.Rational(1, 2)), evaluate=False)),
}


def test_every_rule_of_the_table_is_tried() -> None:
    assert set(ONE_OF_EACH_RULE) == set(RULES)


@pytest.mark.parametrize(
    "value",
    [
        *ONE_OF_EACH_RULE.values(),
        sp.sqrt(x),
        1 / sp.sqrt(x),
        x**3,
        x**-2,
        x ** sp.Rational(3, 2),
        x**y,
        x / (y * (1 + x)),
        -x,
        sp.pi * x + sp.E,
        sp.Piecewise((x, x > y), (y, x > y / 2), (x * y, True)),
        sp.Float("0.1", 30) * x,
        sp.Piecewise((x, sp.Eq(x, y)), (y + 1, True)),
    ],
    ids=str,
)
def test_rule_equals_sympy(value: sp.Basic) -> None:
    expression = of_two(value)
    some: list[Point] = [*points(expression, inside, 50, "rule"), [[0.5], [0.5]]]
    assert list(failures(expression, some)) == []


@pytest.mark.parametrize(
    "value",
    [sp.sinc(x), sp.gamma(x), sp.ceiling(x), sp.Mod(x, 2), sp.Heaviside(x), sp.sinh(x), sp.cot(x), sp.besselj(0, x)],
    ids=str,
)
def test_operation_without_a_rule_is_refused_by_name(value: sp.Expr) -> None:
    with pytest.raises(
        LoweringError, match=f"of_two: no CasADi rule for {type(value).__name__} in .*write it in .*Max"
    ):
        lower(of_two(1 + 2 * value))


@pytest.mark.parametrize("value", [sp.nan, sp.zoo, sp.oo, -sp.oo, sp.I])
def test_what_is_no_real_number_is_refused(value: sp.Expr) -> None:
    with pytest.raises(LoweringError, match="no CasADi rule"):
        lower(of_two(value))


@pytest.mark.parametrize("value", [sp.Integer(10) ** 400, sp.Float("1e5000"), sp.Rational(1, 10**400)])
def test_a_number_that_no_double_holds_is_refused(value: sp.Expr) -> None:
    with pytest.raises(LoweringError, match=r"of_two: the number 1\.0*E[+-]\d+ lies beyond"):
        lower(of_two(value * x))


@pytest.mark.parametrize("value", [None, "x", [x]])
def test_what_is_no_expression_is_refused(value: object) -> None:
    with pytest.raises(InputError, match="must be pairs of a Quantity and its expression"):
        of_two(value)  # type: ignore[arg-type]


def test_a_symbol_of_the_name_of_an_input_that_is_not_its_own_is_named() -> None:
    with pytest.raises(InputError, match="of_two uses another symbol called x than that of its input"):
        of_two(sp.Symbol("x"))


def test_a_quantity_of_three_extents_is_refused() -> None:
    with pytest.raises(InputError, match=r"shape = \(2, 2, 2\): must be a tuple of at most two"):
        Quantity("x", "a block", "1", "x", shape=(2, 2, 2))


def test_piecewise_with_a_gap_is_refused() -> None:
    with pytest.raises(LoweringError, match="without a last case"):
        lower(of_two(sp.Piecewise((x, x > y))))


def test_truth_value_becomes_the_comparison_itself() -> None:
    """The firmware's integer kernel must contain no branch that CasADi would print in doubles."""
    operations = lower(of_two(truth(x >= y))).function
    names = {operations.instruction_id(k) for k in range(operations.n_instructions())}
    with_branch = lower(of_two(sp.Piecewise((2, x >= y), (3, True)))).function
    assert operations.n_instructions() < with_branch.n_instructions()
    assert len(names) == 3  # read an input, compare, write the output


# --- calling a kernel -------------------------------------------------------------------------------------------

ROW = Quantity("row", "three numbers", "1", "v", (-1.0, 1.0), shape=(3,))
GRID = Quantity("grid", "two rows of three", "1", "G", (-1.0, 1.0), shape=(2, 3))
FACTOR = Quantity("factor", "a number", "1", "f", (-1.0, 1.0))
SCALED = Quantity("scaled", "the grid times a number", "1", "S", shape=(2, 3))
PRODUCT = Quantity("product", "the grid times the row", "1", "p", shape=(2,))


@pytest.fixture(scope="module")
def shaped() -> Kernel:
    G = GRID.symbol
    outputs = ((SCALED, FACTOR.symbol * G), (PRODUCT, G * ROW.symbol))
    return lower(Expression("shaped", "A matrix times a number and a vector.", (GRID, ROW, FACTOR), outputs))


def test_vectors_and_matrices_keep_their_order(shaped: Kernel) -> None:
    grid, row = np.arange(6.0).reshape(2, 3), np.array([1.0, 10.0, 100.0])
    scaled, product = shaped(grid, row, 2.0)
    np.testing.assert_array_equal(scaled, 2 * grid)
    np.testing.assert_array_equal(product, grid @ row)


def test_one_call_of_many_points_equals_many_calls(shaped: Kernel) -> None:
    rng = np.random.default_rng(3)
    grids, rows, factor = rng.normal(size=(7, 2, 3)), rng.normal(size=(7, 3)), 0.3
    together = shaped(grids, rows, factor)  # the factor is the same for all points
    for k in range(7):
        for many, single in zip(together, shaped(grids[k], rows[k], factor), strict=True):
            np.testing.assert_array_equal(many[k], single)


def test_no_points_give_no_values(shaped: Kernel) -> None:
    scaled, product = shaped(np.empty((0, 2, 3)), np.empty((0, 3)), 1.0)
    assert scaled.shape == (0, 2, 3)
    assert product.shape == (0, 2)


@pytest.mark.parametrize(
    ("arguments", "error", "message"),
    [
        (([[1, 2, 3]] * 2, [1, 2, 3]), TypeError, "shaped: the arguments are grid, row, factor; 2 given"),
        (([[1, 2, 3]] * 3, [1, 2, 3], 1), ValueError, r"grid has shape \(3, 3\), expected \(2, 3\)"),
        (([[1, 2, 3]] * 2, [1, 2], 1), ValueError, r"row has shape \(2,\), expected \(3,\)"),
        (([[1, 2, 3]] * 2, [[1, 2, 3]] * 4, [1, 2, 3]), ValueError, r"factor has shape \(3,\)"),
        (([[1, 2, 3]] * 2, [1, 2, 3], "1"), ValueError, "shaped: '1' is no number"),
        (([[1, 2, 3]] * 2, [1, None, 3], 1), ValueError, r"shaped: \[1, None, 3\] is no number"),
        (([[1, 2, 3]] * 2, [1, 2, 3], np.array([1j])), ValueError, r"shaped: array\(\[0\.\+1\.j\]\) is no number"),
        (([[1, 2, 3]] * 2, [1, 2, 3], 10**400), ValueError, "shaped: .*too large"),
    ],
)
def test_wrong_shape_is_refused_by_name(shaped: Kernel, arguments: tuple, error: type[Exception], message: str) -> None:
    with pytest.raises(error, match=message):
        shaped(*arguments)


def test_expanded_kernel_is_the_same_function_with_the_same_meaning(shaped: Kernel) -> None:
    flat = shaped.expand()
    grid, row = np.arange(6.0).reshape(2, 3), np.array([0.1, 0.2, 0.3])
    for one, other in zip(shaped(grid, row, 0.7), flat(grid, row, 0.7), strict=True):
        np.testing.assert_array_equal(one, other)
    assert (flat.inputs, flat.outputs, flat.description) == (shaped.inputs, shaped.outputs, shaped.description)
