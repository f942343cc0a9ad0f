"""The comment at the head of every generated file: meaning, units, domains, source, versions, operations.

No date and no path: the text is the same on every machine, and a changed operation count shows in a diff.
"""

from __future__ import annotations

import math
import textwrap
from collections import Counter
from collections.abc import Callable, Iterable, Iterator

import casadi as ca
import sympy

from derivations.quantity import Quantity
from gearmath.engine.kernel import Kernel
from gearmath.version import __version__

_WIDTH = 110
#: name of every operation of a CasADi graph by its number; OP_MUL is "mul".
OPERATIONS = {
    value: name.removeprefix("OP_").lower() for name, value in sorted(vars(ca).items()) if name.startswith("OP_")
}
_NO_WORK = {"input", "output", "const", "parameter"}


def versions() -> str:
    """The programs that wrote the text."""
    return f"gearmath {__version__}, casadi {ca.CasadiMeta.version()}, sympy {sympy.__version__}"


def plain(text: str) -> str:
    """Free text made harmless for a C comment: one line, no end or start of a comment, no splice, no trigraph."""
    line = " ".join("".join(letter if letter.isprintable() else " " for letter in text).split())
    line = line.replace("\\", "/")
    for pair, apart in (("*/", "* /"), ("/*", "/ *"), ("??", "? ?")):
        while pair in line:
            line = line.replace(pair, apart)
    return line


def comment(paragraphs: Iterable[str]) -> str:
    """A C comment of wrapped lines; what follows the first line of a paragraph is indented under it."""
    lines: list[str] = []
    for paragraph in paragraphs:
        body = paragraph.lstrip(" ")
        indent = " " * (len(paragraph) - len(body))
        lines += textwrap.wrap(
            plain(body),
            _WIDTH,
            initial_indent=indent,
            subsequent_indent=indent + "    ",
            break_long_words=False,
            break_on_hyphens=False,
        ) or [""]
    return "/*\n" + "".join(f" * {line}".rstrip() + "\n" for line in lines) + " */\n"


#: The least and the greatest number that the C takes for an input.
Taken = Callable[[Quantity], tuple[float, float]]


def kernel_comment(kernel: Kernel, memory: str, function: ca.Function | None = None, taken: Taken | None = None) -> str:
    """The head of a kernel's header file; ``memory`` is the sentence about its work memory.

    ``function`` is what its C computes, where that is more than the kernel itself; ``taken`` what it takes beyond the
    ranges.
    """
    return comment(_paragraphs(kernel, memory, function or kernel.function, taken))


def _paragraphs(kernel: Kernel, memory: str, function: ca.Function, taken: Taken | None) -> Iterator[str]:
    yield f"gm_{kernel.name}: generated, do not edit."
    yield ""
    yield kernel.description
    yield ""
    for direction, quantities in (("in", kernel.inputs), ("out", kernel.outputs)):
        for quantity in quantities:
            yield from _argument(direction, quantity, taken if direction == "in" else None)
    yield ""
    for requirement in kernel.requires:
        yield f"requires: {requirement}"
    if kernel.source:
        yield f"source: {kernel.source}"
    yield operations(function)
    yield memory
    yield f"written by {versions()}"


def _argument(direction: str, quantity: Quantity, taken: Taken | None) -> Iterator[str]:
    extent = "".join(f"[{length}]" for length in quantity.shape)
    by_rows = ", row by row" if len(quantity.shape) > 1 else ""
    own = "" if quantity.components else _domain(quantity, taken)
    yield f"{direction} {quantity.name}{extent} [{quantity.unit}]{own}: {quantity.description}{by_rows}"
    for k, component in enumerate(quantity.components):
        yield f"    [{k}] {component.name} [{component.unit}]{_domain(component, taken)}: {component.description}"


def _domain(quantity: Quantity, taken: Taken | None) -> str:
    if quantity.values:
        return f" one of {', '.join(map(str, quantity.values))}"
    low, high = quantity.domain
    if math.isinf(low) and math.isinf(high):
        return ""
    beyond = ""
    if taken is not None and (ends := taken(quantity)) != (low, high):
        beyond = f" (taken: {_number(ends[0])} ... {_number(ends[1])})"
    return f" {_number(low)} ... {_number(high)}{beyond}"


def _number(value: float) -> str:
    return str(value) if isinstance(value, int) else f"{value:.12g}"


def operations(function: ca.Function) -> str:
    """How many operations one call executes, and of which kind: a budget that a golden copy keeps."""
    unknown = "ops: not counted, the number depends on an iteration"
    try:
        flat = function.expand()
    except RuntimeError:
        return unknown
    names = (OPERATIONS[flat.instruction_id(k)] for k in range(flat.n_instructions()))
    counts = Counter(name for name in names if name not in _NO_WORK)
    if "call" in counts:
        return unknown
    kinds = ", ".join(f"{name} {count}" for name, count in sorted(counts.items()))
    return f"ops: {counts.total()} ({kinds})"
