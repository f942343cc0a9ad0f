"""Every chapter of ``derivations`` as a page: its text, its expressions typeset, its quantities, its proofs."""

from __future__ import annotations

import importlib
import inspect
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType

import sympy as sp

import derivations

#: Characters of LaTeX of one equation; what is longer is written with shorthands.
_LONGEST = 600
#: Shorthands of one expression; what needs more is not typeset.
_MOST_SHORTHANDS = 40
#: Operations that are not worth a shorthand, such as the sine of an angle.
_SHORT = 2


def write_chapters(folder: Path) -> None:
    """Write ``index.md`` and one page a chapter."""
    folder.mkdir(exist_ok=True)
    names = derivations.index()
    titles = {}
    for chapter in derivations.CHAPTERS:
        module = importlib.import_module(f"derivations.{chapter}")
        text, titles[chapter] = _page(module, [name for name, where in names.items() if where == chapter])
        _write(folder / f"{chapter}.md", text)
    entries = "\n".join(derivations.CHAPTERS)
    lead = (
        "Each quantity is derived once, in SymPy, and every program, every picture and every line of C comes from that "
        "expression. Each chapter is a file of `derivations/`; what follows is read from it: the text, the expressions "
        "typeset, their quantities with units and domains, and the proofs that the tests run."
    )
    _write(folder / "index.md", f"# The mathematics\n\n{lead}\n\n```{{toctree}}\n:maxdepth: 1\n\n{entries}\n```\n")


def _write(path: Path, text: str) -> None:
    if not path.is_file() or path.read_text("utf-8") != text:
        path.write_text(text, "utf-8")


def _page(module: ModuleType, names: list[str]) -> tuple[str, str]:
    first, _, rest = (module.__doc__ or "").partition("\n")
    title = first.rstrip(".").split(": ")[0]
    lines = [
        f"# {title}",
        "",
        "```{code-block} text",
        ":class: chapter",
        "",
        first,
        *rest.rstrip().split("\n"),
        "```",
        "",
    ]
    for name in names:
        lines += _expression(derivations.derive(name))
    proofs = [getattr(module, name) for name in sorted(vars(module)) if name.startswith("prove_")]
    if proofs:
        lines += ["## Proofs", "", "| proof | what it shows |", "|---|---|"]
        lines += [f"| `{proof.__name__}` | {_cell(inspect.getdoc(proof) or '')} |" for proof in proofs]
    return "\n".join(lines) + "\n", title


def _expression(one: derivations.Expression) -> Iterator[str]:
    yield from (f"## {one.name}", "", one.description, "")
    if one.source:
        yield from (f"*Source: {one.source}*", "")
    yield from _equations(one)
    yield from ("| quantity | | unit | domain | |", "|---|---|---|---|---|")
    for kind, quantities in (("in", one.inputs), ("out", tuple(quantity for quantity, _ in one.outputs))):
        for quantity in quantities:
            shape = "×".join(map(str, quantity.shape))
            domain = ", ".join(map(str, quantity.values)) or _interval(quantity.domain)
            name = f"`{quantity.name}`" + (f" ({shape})" if shape else "")
            latex, text = _inline(quantity.latex), _cell(quantity.description)
            yield f"| {kind} {name} | ${latex}$ | {quantity.unit} | {domain} | {text} |"
    yield ""


def _interval(domain: tuple[float, float]) -> str:
    low, high = domain
    return "" if low == -float("inf") and high == float("inf") else f"{low:.4g} to {high:.4g}"


def _inline(latex: str) -> str:
    return latex.replace("|", "\\vert ")


def _cell(text: str) -> str:
    return " ".join(text.split()).replace("|", "\\|")


def _equations(one: derivations.Expression) -> Iterator[str]:
    """Every output as an equation; where it is long, with shorthands k_0, k_1, ... before."""
    names = {
        symbol: element.latex
        for quantity in one.inputs
        for symbol, element in zip(quantity.symbols, quantity.elements, strict=True)
    }
    scalars = [(quantity, sp.sympify(value)) for quantity, value in one.scalars()]
    texts = [(quantity.latex, sp.latex(value, symbol_names=names)) for quantity, value in scalars]
    if all(len(text) <= _LONGEST for _, text in texts):
        for left, text in texts:
            yield from _displayed(f"{left} = {text}")
        return
    shorthands = sp.numbered_symbols("k_")
    definitions, reduced = sp.cse([value for _, value in scalars], symbols=shorthands, order="none")
    short = {symbol: value for symbol, value in definitions if value.count_ops() <= _SHORT}
    definitions = [(symbol, _without(value, short)) for symbol, value in definitions if symbol not in short]
    numbered = dict(zip((symbol for symbol, _ in definitions), sp.numbered_symbols("k_"), strict=False))
    definitions = [(numbered[symbol], value.xreplace(numbered)) for symbol, value in definitions]
    reduced = [_without(value, short).xreplace(numbered) for value in reduced]
    if len(definitions) > _MOST_SHORTHANDS:
        count = sum(int(value.count_ops()) for _, value in scalars)
        yield from (f"*{count} operations: written out it would fill pages; the text above has it in vectors.*", "")
        return
    for symbol, value in definitions:
        yield from _displayed(f"{sp.latex(symbol)} = {sp.latex(value, symbol_names=names)}")
    for (quantity, _), value in zip(scalars, reduced, strict=True):
        yield from _displayed(f"{quantity.latex} = {sp.latex(value, symbol_names=names)}")


def _without(value: sp.Basic, short: dict[sp.Basic, sp.Basic]) -> sp.Basic:
    """An expression with shorthands of little written out, those in their definitions too."""
    while value.free_symbols & short.keys():
        value = value.xreplace(short)
    return value


def _displayed(latex: str) -> Iterator[str]:
    yield from ("$$", latex, "$$", "")
