"""What chapters hand over: quantities of the one notation, in words, units and LaTeX, by SymPy alone."""

from __future__ import annotations

import ast
import importlib
import re
import subprocess
import sys
from pathlib import Path

import pytest
import sympy as sp

import derivations
from derivations import notation
from derivations.expression import Expression, Quantity

NOTATION = {name: value for name, value in vars(notation).items() if isinstance(value, Quantity)}

each_expression = pytest.mark.parametrize("expression", derivations.index(), indirect=True)


@pytest.fixture
def expression(request: pytest.FixtureRequest) -> Expression:
    """Derived when its test runs: a process that runs other tests derives none."""
    return derivations.derive(request.param)


def quantities(expression: Expression) -> list[Quantity]:
    return [*expression.inputs, *(quantity for quantity, _ in expression.outputs)]


@each_expression
def test_quantities_come_from_the_notation(expression: Expression) -> None:
    assert [quantity.name for quantity in quantities(expression) if NOTATION.get(quantity.name) is not quantity] == []


@each_expression
def test_description_is_a_sentence_with_its_equation_and_a_source(expression: Expression) -> None:
    assert re.search(r"\(\d+\.\d+.*\)", expression.description), "the number of the equation is missing"
    assert expression.description.endswith(".") or "; " in expression.description
    assert expression.source


@each_expression
def test_latex_writes_every_output_in_the_signs_of_the_notation(expression: Expression) -> None:
    for quantity, _ in expression.outputs:
        latex = expression.latex(quantity.name)
        assert latex.startswith(quantity.latex + " = ")
        assert latex.count("{") == latex.count("}")
        assert latex.count(r"\left") == latex.count(r"\right")
        raw = [element.name for given in expression.inputs for element in given.elements if "_" in element.name]
        assert [name for name in raw if name in latex and name not in quantity.latex] == []


@pytest.mark.parametrize("name", ["cutter_surface", "flank_family", "nearest_position"])
def test_latex_is_that_of_sympy(name: str) -> None:
    """Terms that stand in many places are printed once; the text is the same."""
    expression = derivations.derive(name)
    signs = {s: e.latex for q in expression.inputs for s, e in zip(q.symbols, q.elements, strict=True)}
    for quantity, value in expression.outputs:
        assert expression.latex(quantity.name) == f"{quantity.latex} = {sp.latex(value, symbol_names=signs)}"


@pytest.mark.parametrize("name", NOTATION)
def test_quantity_is_called_as_in_the_notation_and_has_words_and_a_unit(name: str) -> None:
    quantity = NOTATION[name]
    assert quantity.name == name
    assert len(quantity.description.split()) > 1 or quantity.components
    assert quantity.unit
    assert quantity.latex
    assert quantity.scale > 0
    for element in quantity.elements:
        low, high = element.domain
        assert low < high
        assert all(low <= value <= high for value in element.values)


def test_names_are_unique_across_the_notation() -> None:
    scalars = [e.name for quantity in NOTATION.values() if not quantity.components for e in quantity.elements]
    vectors = [quantity.name for quantity in NOTATION.values() if quantity.shape]
    names = [*scalars, *vectors]
    assert sorted(names) == sorted(set(names))


def test_no_name_of_the_notation_is_given_twice() -> None:
    lines = ast.parse(Path(notation.__file__).read_text("utf-8")).body
    given = [target.id for line in lines if isinstance(line, ast.Assign) for target in line.targets]  # type: ignore[attr-defined]
    assert [name for name in set(given) if given.count(name) > 1] == []


def test_every_expression_of_every_chapter_is_listed() -> None:
    made = set()
    for chapter in derivations.CHAPTERS:
        module = importlib.import_module(f"derivations.{chapter}")
        cached = [value for value in vars(module).values() if hasattr(value, "cache_info")]
        made |= {make().name for make in cached if make.__module__ == module.__name__}
    assert made <= {expression.name for expression in derivations.expressions()}
    names = [expression.name for expression in derivations.expressions()]
    assert sorted(names) == sorted(set(names))


def test_every_chapter_has_a_number_of_its_own() -> None:
    heads = {
        chapter: re.match(r'"""Chapter (\d+(?:, continued)?)', derivations.source(chapter))
        for chapter in derivations.CHAPTERS
    }
    numbers = {chapter: head[1] for chapter, head in heads.items() if head}
    assert numbers.keys() >= set(derivations.CHAPTERS) - {"frames"}
    assert len(set(numbers.values())) == len(numbers)


def test_a_symbol_that_is_no_input_is_named_beside_the_inputs() -> None:
    x, y, z = (Quantity(name, "a test quantity", "1", name) for name in "xyz")
    with pytest.raises(ValueError, match=r"stray uses \['y'\], .* inputs \['x'\]"):
        Expression("stray", "Uses y.", (x,), ((z, x.symbol + y.symbol),))


def test_a_requirement_on_what_is_no_input_is_refused() -> None:
    x, y, z = (Quantity(name, "a test quantity", "1", name) for name in "xyz")
    with pytest.raises(ValueError, match=r"\['y'\]"):
        Expression("stray", "Requires y.", (x,), ((z, x.symbol),), requires=(y.symbol,))


def test_a_symbol_called_as_an_input_that_is_not_its_own_is_told_apart() -> None:
    x, z = (Quantity(name, "one", "mm", name) for name in "xz")
    with pytest.raises(ValueError, match=r"another symbol called x than that of its input.*, x\.symbol$"):
        Expression("stray", "Uses a symbol of its own.", (x,), ((z, sp.Symbol("x") + 1),))


def test_shapes_that_disagree_and_names_that_c_would_refuse_are_refused() -> None:
    x = Quantity("x", "a test quantity", "1", "x")
    pair = Quantity("pair", "two of them", "1", "p", shape=(2,))
    with pytest.raises(ValueError, match=r"pair has shape \(2,\)"):
        Expression("short", "Gives one.", (x,), ((pair, sp.Matrix([x.symbol])),))
    with pytest.raises(ValueError, match="appears twice"):
        Expression("twice", "Gives x.", (x,), ((x, x.symbol),))
    with pytest.raises(ValueError, match="no C identifier"):
        Expression("two words", "Gives two.", (x,), ((pair, sp.Matrix([x.symbol, 1])),))
    with pytest.raises(ValueError, match="needs a description and a unit"):
        Quantity("y", "", "1", "y")


def test_derivations_need_neither_casadi_nor_numpy() -> None:
    code = (
        "import sys, derivations; list(derivations.expressions())\n"
        "for proof in derivations.proofs(): pass\n"
        "print(*(name for name in ('casadi', 'numpy', 'scipy', 'matplotlib', 'gearmath') if name in sys.modules))"
    )
    root = Path(derivations.__file__).parents[1]
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=root)
    assert run.stdout.split() == []
