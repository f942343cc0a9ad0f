"""What a derivation hands over: named SymPy inputs to named SymPy outputs, with units, domains and sentences."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from fractions import Fraction
from functools import cache, cached_property
from numbers import Real
from typing import Any

import mpmath
import sympy as sp
from sympy.printing.latex import LatexPrinter

from derivations.errors import InputError
from derivations.quantity import IDENTIFIER, Quantity


class _SharedLatex(LatexPrinter):
    """SymPy's LaTeX, where each term that stands in many places is printed once: a twentieth of the time."""

    def __init__(self, settings: dict[str, Any]) -> None:
        super().__init__(settings)
        self._printed: dict[tuple, str] = {}

    def _print(self, expr: Any, **how: Any) -> str:
        if not isinstance(expr, sp.Basic):
            return super()._print(expr, **how)
        key = (expr, *sorted(how.items()))
        if key not in self._printed:
            self._printed[key] = super()._print(expr, **how)
        return self._printed[key]


def _listed(value: Any) -> tuple | list:
    """A list or tuple as it is; what is none, as one that is not what it should be."""
    return value if isinstance(value, tuple | list) else (None,)


@dataclass(frozen=True, repr=False)
class Expression:
    """Named inputs to named outputs: what a chapter returns and :mod:`gearmath.lowering` takes.

    ``outputs`` pairs each output quantity with its SymPy expression. ``requires`` lists expressions of the inputs
    that must be positive besides the domains (a distance from a singular pose, a discriminant).

    Raises InputError if an output uses a symbol that is no input, or if shapes disagree.
    """

    name: str
    description: str
    inputs: tuple[Quantity, ...]
    outputs: tuple[tuple[Quantity, sp.Basic | sp.MatrixBase], ...]
    requires: tuple[sp.Expr, ...] = ()
    source: str = ""

    def __post_init__(self) -> None:
        if not isinstance(self.name, str) or not IDENTIFIER.match(self.name):
            raise InputError(f"expression name {self.name!r} is no C identifier")
        for key, fits, words in self._checks():
            if not fits:
                raise InputError(f"{self.name}: {key} = {getattr(self, key)!r}: {words}")
        names = [quantity.name for quantity in (*self.inputs, *(quantity for quantity, _ in self.outputs))]
        if len(set(names)) != len(names):
            raise InputError(f"{self.name}: a name appears twice among {names}")
        given = {symbol for quantity in self.inputs for symbol in quantity.symbols}
        for quantity, value in self.outputs:
            if len(self.elements_of(value)) != quantity.size:
                raise InputError(f"{self.name}: {quantity.name} has shape {quantity.shape}, its expression has not")
        used = set().union(
            *(sp.sympify(value).free_symbols for value in (*(v for _, v in self.outputs), *self.requires))
        )
        known = set(map(str, given))
        alike = sorted(known & set(map(str, used - given)))
        if alike:
            raise InputError(
                f"{self.name} uses another symbol called {alike[0]} than that of its input, which is known to be "
                f"real or whole: take the symbol of the quantity, {alike[0]}.symbol"
            )
        if used - given:
            raise InputError(
                f"{self.name} uses {sorted(map(str, used - given))}, which are not among its inputs "
                f"{sorted(known)}: add them to the inputs, or substitute them"
            )

    def __repr__(self) -> str:
        given, made = (", ".join(one.name for one in some) for some in (self.inputs, dict(self.outputs)))
        return f"<Expression: {self.name}, of {given}, gives {made}: {self.description}>"

    def _checks(self) -> Iterator[tuple[str, bool, str]]:
        """Of each field, whether its value can be, and what it must be."""
        yield "description", isinstance(self.description, str) and bool(self.description), "must be text"
        yield "source", isinstance(self.source, str), "must be text"
        yield "inputs", all(isinstance(one, Quantity) for one in _listed(self.inputs)), "must be a tuple of Quantity"
        kinds = (sp.Basic, sp.MatrixBase, Real)
        pairs = all(
            len(_listed(one)) == 2 and isinstance(one[0], Quantity) and isinstance(one[1], kinds)
            for one in _listed(self.outputs)
        )
        yield "outputs", pairs, "must be pairs of a Quantity and its expression, a Matrix where it has a shape"
        yield "requires", all(isinstance(one, sp.Basic) for one in _listed(self.requires)), "must be SymPy expressions"

    @staticmethod
    def elements_of(value: sp.Basic | sp.MatrixBase) -> tuple[sp.Expr, ...]:
        """The scalar expressions of an output, matrices row by row."""
        return tuple(value) if isinstance(value, sp.MatrixBase) else (value,)

    def scalars(self) -> Iterator[tuple[Quantity, sp.Expr]]:
        """Every scalar output element with its expression."""
        for quantity, value in self.outputs:
            yield from zip(quantity.elements, self.elements_of(value), strict=True)

    def __getitem__(self, name: str) -> sp.Basic | sp.MatrixBase:
        """The SymPy expression of the output called ``name``."""
        for quantity, value in self.outputs:
            if quantity.name == name:
                return value
        raise KeyError(f"{self.name} has no output {name!r}; it has {[quantity.name for quantity, _ in self.outputs]}")

    def evaluate(self, *arguments: float | Iterable[float], digits: int = 50) -> list[mpmath.mpf]:
        """Every scalar output at one point, in ``digits`` digits: the truth that faster evaluations are compared with.

        Arguments are numbers or flat sequences of numbers, in the order of the inputs.
        """
        flat: list[float] = []
        for argument in arguments:
            flat.extend(argument if isinstance(argument, Iterable) else (argument,))
        wanted = sum(quantity.size for quantity in self.inputs)
        if len(flat) != wanted:
            raise InputError(f"{self.name}: takes {wanted} numbers, {len(flat)} were given")
        with mpmath.workdps(digits):
            return self.function(*(mpmath.mpf(float(value)) for value in flat))

    @cached_property
    def function(self) -> Callable[..., list[mpmath.mpf]]:
        """Every scalar output of the elements of the inputs, in the working precision of mpmath."""
        symbols = [symbol for quantity in self.inputs for symbol in quantity.symbols]
        return sp.lambdify(symbols, [value for _, value in self.scalars()], "mpmath", cse=True)

    def exact(self, *arguments: Fraction | int) -> tuple[Fraction, ...]:
        """Every output at one point of rational numbers, exactly; all inputs and outputs scalars.

        Raises TypeError if an output is no rational function of the inputs.
        """
        values = self._rational()(*map(Fraction, arguments))
        if not all(isinstance(value, Fraction | int) for value in values):
            raise TypeError(f"{self.name} is not rational in its inputs")
        return tuple(map(Fraction, values))

    @cache  # noqa: B019 - expressions are made once, and live as long as the program
    def _rational(self) -> Callable[..., list[Fraction]]:
        symbols = [symbol for quantity in self.inputs for symbol in quantity.symbols]
        return sp.lambdify(symbols, [value for _, value in self.scalars()], "math")

    def latex(self, name: str) -> str:
        """The equation of one output as LaTeX, with the LaTeX names of the quantities."""
        names = {
            symbol: element.latex
            for quantity in self.inputs
            for symbol, element in zip(quantity.symbols, quantity.elements, strict=True)
        }
        names_there = [quantity.name for quantity, _ in self.outputs]
        if name not in names_there:
            raise InputError(f"{self.name}: name = {name!r}: must be an output, of {', '.join(names_there)}")
        output = self.outputs[names_there.index(name)][0]
        return f"{output.latex} = {_SharedLatex({'symbol_names': names}).doprint(self[name])}"
