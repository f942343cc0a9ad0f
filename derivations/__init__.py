"""What is true, and why: one chapter a file, SymPy only, equations numbered, each with its ``prove_*`` functions."""

from __future__ import annotations

import importlib
import importlib.resources
import re
from collections.abc import Callable, Iterator, Mapping
from functools import cache
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from derivations.quantity import Quantity

if TYPE_CHECKING:
    from derivations.expression import Expression

CHAPTERS = (
    "frames",
    "cutter",
    "cradle",
    "flank",
    "meshing",
    "axes",
    "deviation",
    "gearbox",
    "blank",
    "hobbing",
    "check_dimensions",
    "generation",
    "iso23509",
    "lengthwise",
    "tooth_width",
    "crown_gear",
    "sweep",
    "probing",
    "registration",
    "spacing",
    "compensation",
    "ease_off",
    "touch_errors",
    "single_blades",
    "axis_calibration",
    "tip_calibration",
    "contact",
    "local_synthesis",
    "design",
    "polynomial_blocks",
    "chip",
    "virtual_hobbing",
    "cylindrical_tolerance",
)

#: An expression of a chapter, as its source says it.
_EXPRESSION = re.compile(r"^def ([a-z]\w*)\(\) -> Expression:", re.MULTILINE)

__all__ = ["CHAPTERS", "Expression", "Quantity", "derive", "expressions", "index", "proofs"]


@cache
def index() -> Mapping[str, str]:
    """Name of every Expression, in reading order, to its chapter: read from the sources, nothing is derived.

    An Expression is what a chapter's function without arguments returns, ``def name() -> Expression:``.
    """
    return MappingProxyType({name: chapter for chapter in CHAPTERS for name in _EXPRESSION.findall(source(chapter))})


def source(chapter: str) -> str:
    """The text of a chapter."""
    return importlib.resources.files(__name__).joinpath(f"{chapter}.py").read_text("utf-8")


def derive(name: str) -> Expression:
    """The Expression of this name, derived. Raises KeyError."""
    return getattr(importlib.import_module(f"{__name__}.{index()[name]}"), name)()


def expressions() -> Iterator[Expression]:
    """Every Expression of every chapter, derived on demand."""
    return map(derive, index())


def proofs() -> Iterator[Callable[[], None]]:
    """Every ``prove_*`` function of every chapter."""
    for chapter in CHAPTERS:
        module = importlib.import_module(f"derivations.{chapter}")
        yield from (getattr(module, name) for name in sorted(vars(module)) if name.startswith("prove_"))


def __getattr__(name: str) -> Any:
    """``Expression`` on first use: it loads SymPy."""
    if name == "Expression":
        from derivations.expression import Expression

        return Expression
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
