"""Kernel to C: CasADi writes the body, this module the typed function around it and the header that explains it.

A double kernel ``name`` becomes ``gm_<name>(...)`` and ``gm_<name>_batch(n, ...)``, which keep the contract of
``library/gm_status.h``; an integer kernel only the first, without a status. Scalars go in by value, vectors and
matrices as arrays (matrices row by row); every output is written through a pointer and must not overlap an input.
Nothing is allocated, nothing is kept between calls.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from importlib import resources

import casadi as ca

from gearmath.engine.kernel import Kernel
from gearmath.errors import ComputationError
from gearmath.export import contract, wrapper
from gearmath.export.header import OPERATIONS, kernel_comment
from gearmath.version import __version__

#: What means the same in C with integers as in exact arithmetic. Everything else is double in C, or truncates.
INTEGER_OPERATIONS = frozenset(
    ("add", "sub", "mul", "neg", "sq", "lt", "le", "eq", "ne", "not", "and", "or", "if_else_zero", "sign")
)
_LITERAL = re.compile(r"=(-?\d+)\.;")


class ExportError(ComputationError):
    """A Kernel that cannot become C of the wanted kind."""


@dataclass(frozen=True)
class CKernel:
    """The C of one Kernel: the text of ``<name>.h`` and ``<name>.c``; an inline kernel has only the header."""

    name: str
    header: str
    source: str

    @property
    def files(self) -> dict[str, str]:
        """File name to text."""
        source = {f"{self.name}.c": self.source} if self.source else {}
        return {f"{self.name}.h": self.header, **source}


@dataclass(frozen=True)
class _Body:
    """CasADi's C without its interface: the text, the entry function, and the sizes of arg, res, iw and w."""

    text: str
    entry: str
    sizes: wrapper.Sizes


_SHARED = ("gm_status.h", "gm_status.c", "gm_check.h", "gm_lane.h")


def contract_files() -> dict[str, str]:
    """What the C of every double kernel includes: the contract, the checks, and the sentences of the status."""
    folder = resources.files("gearmath") / "export" / "library"
    files = {name: (folder / name).read_text("utf-8") for name in _SHARED}
    return files | {"gm_version.h": f'/* generated, do not edit. */\n#define GM_VERSION "{__version__}"\n'}


def double_kernel(kernel: Kernel) -> CKernel:
    """C in double precision, bit-equal to the Kernel where the compiler does not contract operations.

    Raises ExportError if a name cannot stand in C, or naming the part that CasADi cannot write as C.
    """
    _check_names(kernel)
    function = _dense(contract.with_margins(kernel))
    body = _generate(function, f"gm_{kernel.name}", {"casadi_real": "double", "include_math": True})
    typed = contract.definitions(kernel, function, body.entry, body.sizes)
    memory = "work memory: none"
    if body.sizes.w + body.sizes.iw:
        memory = f"work memory: {body.sizes.w} doubles and {body.sizes.iw} integers, on the stack"
    includes = '#include "gm_status.h"\n', '#include "gm_check.h"\n'
    return _assemble(kernel, memory, includes, contract.declarations(kernel), body, typed, function)


def integer_kernel(kernel: Kernel, bits: int = 32, inline: bool = False) -> CKernel:
    """C in whole numbers of 32 or 64 bits, without any floating operation or constant.

    ``inline``: all of it in the header, so that an interrupt has no call and no arguments in memory to pay for.
    Raises ExportError naming the first operation, constant or quantity that is not exact in integers.
    """
    _check_names(kernel)
    for quantity in (*kernel.inputs, *kernel.outputs):
        if any(element.kind != "int" for element in quantity.elements):
            raise ExportError(f"{kernel.name}: {quantity.name} is no whole number and cannot be an int{bits}_t")
    function = _dense(kernel.function).expand()
    _check_integer(function, bits)
    real = f"int{bits}_t"
    body = _generate(function, f"gm_{kernel.name}", {"casadi_real": real, "include_math": False})
    exact = _Body(_LITERAL.sub(r"=\1;", body.text), body.entry, body.sizes)
    declaration = f"{wrapper.declaration(kernel, real)};\n"
    typed = wrapper.definition(kernel, real, body.entry, body.sizes)
    memory, includes = f"work memory: none; {real} only", ("#include <stdint.h>\n", "")
    if inline:
        # names of the preprocessor last to the end of what includes the header: the next kernel has the same ones
        names = re.findall(r"^#define (\w+)", exact.text, flags=re.MULTILINE)
        forgotten = "".join(f"#undef {name}\n" for name in names)
        text = exact.text.replace("\nstatic int casadi_f", "\nstatic inline int casadi_f")
        everything = f"{text}\nstatic inline {typed}\n{forgotten}"
        with_body = _assemble(kernel, memory, includes, everything, exact, "")
        return CKernel(with_body.name, with_body.header, "")
    return _assemble(kernel, memory, includes, declaration, exact, typed)


def _assemble(
    kernel: Kernel,
    memory: str,
    includes: tuple[str, str],
    declarations: str,
    body: _Body,
    typed: str,
    function: ca.Function | None = None,
) -> CKernel:
    """``includes`` of the header, and more of the source."""
    name = f"gm_{kernel.name}"
    guard = f"{name.upper()}_H"
    taken = contract.taken if function else None  # what is in whole numbers does not look at its inputs
    header = (
        f"{kernel_comment(kernel, memory, function, taken)}#ifndef {guard}\n#define {guard}\n\n{includes[0]}\n"
        f'#ifdef __cplusplus\nextern "C" {{\n#endif\n\n{declarations}\n#ifdef __cplusplus\n}}\n#endif\n\n#endif\n'
    )
    source = f'/* {name}: generated, do not edit. */\n#include "{name}.h"\n{includes[1]}\n{body.text}\n{typed}'
    return CKernel(name, header, source)


def _check_names(kernel: Kernel) -> None:
    if kernel.name.lower() in wrapper.TAKEN:
        raise ExportError(f"{kernel.name}: gm_{kernel.name} is part of the library, rename the kernel")
    for quantity in (*kernel.inputs, *kernel.outputs):
        if quantity.name in wrapper.RESERVED or quantity.name.startswith(wrapper.PREFIXES):
            raise ExportError(f"{kernel.name}: the name {quantity.name} is taken in C, rename the quantity")


def _check_integer(function: ca.Function, bits: int) -> None:
    for k in range(function.n_instructions()):
        operation = OPERATIONS[function.instruction_id(k)]
        if operation == "const":
            value = function.instruction_constant(k)
            # a double holds whole numbers exactly up to 2^53 only
            if not value.is_integer() or abs(value) >= 2.0 ** min(bits - 1, 53):
                raise ExportError(f"{function.name()}: the constant {value!r} is no whole number of {bits} bits")
        elif operation not in INTEGER_OPERATIONS | {"input", "output"}:
            allowed = ", ".join(sorted(name.upper() for name in INTEGER_OPERATIONS))
            raise ExportError(
                f"{function.name()}: {operation.upper()} is not exact in integer C; allowed are {allowed}"
            )


def _dense(function: ca.Function) -> ca.Function:
    """The function with dense arguments: CasADi's C leaves structural zeros out of its arrays."""
    counts = (function.n_in(), function.n_out())
    sparsities = [function.sparsity_in(k) for k in range(counts[0])] + [
        function.sparsity_out(k) for k in range(counts[1])
    ]
    if all(sparsity.is_dense() for sparsity in sparsities):
        return function
    arguments = [ca.MX.sym(function.name_in(k), *function.size_in(k)) for k in range(counts[0])]
    results = [ca.densify(result) for result in function.call(arguments)]
    dense = ca.Function(function.name(), arguments, results, function.name_in(), function.name_out())
    return dense.expand() if function.is_a("SXFunction") else dense


def _generate(function: ca.Function, prefix: str, options: dict) -> _Body:
    """CasADi's text between its own preamble and its interface, which are both left out."""
    generator = ca.CodeGenerator(prefix, {"prefix": prefix, "with_export": False, "casadi_int": "int", **options})
    generator.add(function)
    text = generator.dump()
    try:
        _, text = text.split("/* Add prefix to internal symbols */\n")
        text, interface = text.split(f"\nint {function.name()}(const casadi_real** arg", 1)
        before, rest = text.split("/* Configuration this file was compiled with */\n")
        after = rest.split("_casadi_real_size(void) { return (int) sizeof(casadi_real); }\n", 1)[1]
        entry = re.search(r"return (casadi_f\d+)\(arg, res, iw, w, mem\);", interface)[1]  # type: ignore[index]
        sizes = wrapper.Sizes(
            *(
                int(re.search(rf"\*sz_{what} = (\d+);", interface)[1])  # type: ignore[index]
                for what in ("arg", "res", "iw", "w")
            )
        )
    except (ValueError, IndexError, TypeError) as error:
        raise ExportError(
            f"{function.name()}: the C of CasADi {ca.CasadiMeta.version()} has an unknown form"
        ) from error
    if refusal := re.search(r"#error (.*)", text):
        raise ExportError(f"{function.name()}: {refusal[1]}")
    return _Body(_preamble(prefix, options) + _used(before, after) + _POP, entry, sizes)


_PUSH = """\
#if defined(__GNUC__)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-parameter"
#pragma GCC diagnostic ignored "-Wunused-function"
#endif
"""
_POP = """
#if defined(__GNUC__)
#pragma GCC diagnostic pop
#endif
"""


def _preamble(prefix: str, options: dict) -> str:
    include = "#include <math.h>\n\n" if options["include_math"] else ""
    return (
        f"{include}{_PUSH}\n#define casadi_real {options['casadi_real']}\n#define casadi_int int\n"
        f"#define CASADI_PREFIX(ID) {prefix}_ ## ID\n"
    )


def _used(before: str, after: str) -> str:
    """Names, helpers (made static) and functions, without the sparsity patterns that only the interface used."""
    before = re.sub(r"^(?=(?:casadi_real|casadi_int|int|void) casadi_\w+\()", "static ", before, flags=re.MULTILINE)
    for pattern in re.findall(r"^static const casadi_int (casadi_s\d+)\[", after, flags=re.MULTILINE):
        if len(re.findall(rf"\b{pattern}\b", after)) == 1:
            after = re.sub(rf"^static const casadi_int {pattern}\[[^;]*;\n", "", after, flags=re.MULTILINE)
            before = before.replace(f"#define {pattern} CASADI_PREFIX({pattern.removeprefix('casadi_')})\n", "")
    return f"{before.rstrip()}\n\n{after.strip()}\n"
