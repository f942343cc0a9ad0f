"""A named quantity: what it is, in which unit, of which shape, and where it is valid.

SymPy is imported only where a symbol is asked for: what runs kept kernels needs quantities, and no SymPy.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from numbers import Real
from typing import TYPE_CHECKING, Any, Literal

from derivations.errors import InputError

if TYPE_CHECKING:
    import sympy as sp


def _is_number(value: Any) -> bool:
    if not isinstance(value, Real) or isinstance(value, bool):
        return False
    try:
        return not math.isnan(value)
    except OverflowError:  # a whole number of hundreds of digits
        return False


def _is_count(value: Any) -> bool:
    return isinstance(value, int) and not isinstance(value, bool) and value >= 1


def _are(values: Any, fit: Callable[[Any], bool]) -> bool:
    return isinstance(values, tuple) and all(map(fit, values))


IDENTIFIER = re.compile(r"[A-Za-z][A-Za-z0-9_]*\Z")


@dataclass(frozen=True, repr=False)
class Quantity:
    """One named quantity: what it is, in which unit, of which shape, and where it is valid.

    ``domain`` bounds each element; ``values``, where given, lists the only values allowed (a sign, a truth value).
    ``scale`` is the size against which an error of an *output* is judged. A vector of unlike elements names them
    in ``components``; then unit, domain and LaTeX are those of the components. ``default`` is the value of every
    element where a call leaves out this quantity and all that follow it.
    """

    name: str
    description: str
    unit: str
    latex: str
    domain: tuple[float, float] = (-math.inf, math.inf)
    shape: tuple[int, ...] = ()
    kind: Literal["real", "int"] = "real"
    values: tuple[int, ...] = ()
    scale: float = 1.0
    components: tuple[Quantity, ...] = ()
    default: float | None = None

    def __post_init__(self) -> None:
        if not isinstance(self.name, str) or not IDENTIFIER.match(self.name):
            raise InputError(f"quantity name {self.name!r} is no C identifier")
        for key, fits, words in self._checks():
            if not fits:
                raise InputError(f"{self.name}: {key} = {getattr(self, key)!r}: {words}")
        if self.components and self.shape != (len(self.components),):
            raise InputError(f"{self.name}: shape {self.shape} does not fit {len(self.components)} components")
        if not self.description or not self.unit:
            raise InputError(f"{self.name}: a quantity needs a description and a unit ('1' where it has none)")

    def __repr__(self) -> str:
        return f"<Quantity: {self.name} [{self.unit}], {self.description}>"

    def _checks(self) -> Iterator[tuple[str, bool, str]]:
        """Of each key, whether its value can be, and what it must be."""
        for key in ("description", "unit", "latex"):
            yield key, isinstance(getattr(self, key), str), "must be text"
        yield "latex", self.latex != "", "must not be empty"
        ordered = _are(self.domain, _is_number) and len(self.domain) == 2 and self.domain[0] < self.domain[1]
        yield "domain", ordered, "must be a tuple of the least and the greatest value, which is more"
        fits = _are(self.shape, _is_count) and len(self.shape) <= 2
        yield "shape", fits, "must be a tuple of at most two whole numbers, at least 1"
        yield "kind", self.kind in ("real", "int"), "must be 'real' or 'int'"
        yield "values", _are(self.values, _is_number), "must be a tuple of numbers"
        yield "scale", _is_number(self.scale) and 0 < self.scale < math.inf, "must be a finite number, greater than 0"
        yield "components", _are(self.components, lambda one: isinstance(one, Quantity)), "must be a tuple of Quantity"
        yield (
            "default",
            self.default is None or (_is_number(self.default) and abs(self.default) < math.inf),
            "must be a finite number",
        )

    @property
    def size(self) -> int:
        return math.prod(self.shape)

    @property
    def elements(self) -> tuple[Quantity, ...]:
        """The scalar quantities this one consists of, itself if it is a scalar; matrices row by row."""
        if self.components:
            return self.components
        if not self.shape:
            return (self,)
        indices = [""]
        for extent in self.shape:
            indices = [f"{index}_{k}" for index in indices for k in range(extent)]
        return tuple(
            Quantity(
                self.name + index,
                self.description,
                self.unit,
                f"{self.latex}_{{{index[1:].replace('_', '')}}}",
                self.domain,
                kind=self.kind,
                values=self.values,
                scale=self.scale,
            )
            for index in indices
        )

    @property
    def symbols(self) -> tuple[sp.Symbol, ...]:
        """One SymPy symbol for every element, real (or integer) by assumption."""
        import sympy as sp

        kind = {"integer": True} if self.kind == "int" else {"real": True}
        return tuple(sp.Symbol(element.name, **kind) for element in self.elements)

    @property
    def symbol(self) -> sp.Symbol | sp.ImmutableDenseMatrix:
        """The symbol of a scalar, the matrix of symbols of a vector or matrix."""
        import sympy as sp

        if not self.shape:
            return self.symbols[0]
        rows, columns = (*self.shape, 1)[:2]
        return sp.ImmutableDenseMatrix(rows, columns, self.symbols)
