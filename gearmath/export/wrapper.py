"""The typed C function around a body in whole numbers, and what any such function is written with."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from derivations.quantity import Quantity
from gearmath.engine.kernel import Kernel

_WORDS = """\
    auto break case char const continue default do double else enum extern float for goto if inline int long
    register restrict return short signed sizeof static struct switch typedef union unsigned void volatile while bool
    true false class delete new private protected public template this throw try catch namespace operator virtual
    friend using and or not xor NAN INFINITY n k arg res iw w status now shared margin table bad
    first_bad asm typeof linux unix errno NULL EOF V"""
_LIBRARY = "status check lane version nan inside finite error_text abi_version double_literals"
#: Names that a quantity cannot have: words of C and C++, macros, and the variables of the functions below.
RESERVED = frozenset(_WORDS.split())
#: What a name of a quantity cannot begin with: what the library and CasADi define begins so.
PREFIXES = ("gm_", "GM_", "casadi_")
#: Names that a kernel cannot have: with gm_ before them they are files and functions of the library.
TAKEN = frozenset(_LIBRARY.split())


@dataclass(frozen=True)
class Sizes:
    """How many elements the work arrays of a CasADi function have."""

    arg: int
    res: int
    iw: int
    w: int


def declaration(kernel: Kernel, real: str) -> str:
    """``void gm_<name>(...)`` without the semicolon."""
    inputs = [f"const {real} {q.name}[{q.size}]" if q.shape else f"{real} {q.name}" for q in kernel.inputs]
    outputs = [f"{real} {q.name}[{q.size}]" if q.shape else f"{real} *{q.name}" for q in kernel.outputs]
    return wrapped(f"void gm_{kernel.name}", [*inputs, *outputs])


def definition(kernel: Kernel, real: str, entry: str, sizes: Sizes) -> str:
    """The typed function: hands pointers to the body, and turns matrices from rows to the columns of CasADi."""
    lines = [f"  const {real} *arg[{sizes.arg}];", f"  {real} *res[{sizes.res}];"]
    lines += [
        f"  {kind} {name}[{size}];" for kind, name, size in (("int", "iw", sizes.iw), (real, "w", sizes.w)) if size
    ]
    lines += [f"  {real} {q.name}_columns[{q.size}];" for q in (*kernel.inputs, *kernel.outputs) if len(q.shape) > 1]
    for k, quantity in enumerate(kernel.inputs):
        lines += [f"  {quantity.name}_columns[{c}] = {quantity.name}[{r}];" for c, r in transposed(quantity)]
        lines.append(f"  arg[{k}] = {columns(quantity, '&')};")
    lines += [f"  res[{k}] = {columns(quantity, '')};" for k, quantity in enumerate(kernel.outputs)]
    call = f"{entry}(arg, res, {'iw' if sizes.iw else '0'}, {'w' if sizes.w else '0'}, 0)"
    lines.append(f"  (void){call};")
    for quantity in kernel.outputs:
        lines += [f"  {quantity.name}[{r}] = {quantity.name}_columns[{c}];" for c, r in transposed(quantity)]
    return "\n".join((declaration(kernel, real), "{", *lines, "}\n"))


def wrapped(start: str, arguments: list[str]) -> str:
    """Start and arguments on one line, or one argument a line."""
    line = f"{start}({', '.join(arguments)})"
    if len(line) <= 110:
        return line
    indent = " " * (len(start) - len(start.lstrip()) + 4)
    return f"{start}(\n" + ",\n".join(f"{indent}{argument}" for argument in arguments) + ")"


def columns(quantity: Quantity, address: str) -> str:
    """What the body is handed for a quantity."""
    if len(quantity.shape) > 1:
        return f"{quantity.name}_columns"
    return quantity.name if quantity.shape else f"{address}{quantity.name}"


def transposed(quantity: Quantity) -> Iterator[tuple[int, int]]:
    """Places of each element of a matrix: in columns, in rows. Nothing for scalars and vectors."""
    if len(quantity.shape) > 1:
        rows, columns = quantity.shape
        yield from ((column * rows + row, row * columns + column) for row in range(rows) for column in range(columns))
