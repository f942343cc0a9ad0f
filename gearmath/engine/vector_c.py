"""CasADi functions to C that runs many points at once, for this computer only; what is exported is ``export``'s.

Structure of arrays: a value of a point is a vector of ``LANES`` doubles, one lane a point. What depends only on
arguments that all points share is computed once before the loop. The operations and their order are CasADi's, without
contraction, and the functions of one lane are those of the C library: every result is bit for bit that of the virtual
machine. (With the vector sine and cosine of glibc points of a flank come 1.5 to 2 times as fast, but up to 30 units in
the last place beside the scalar kernel.)
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import casadi as ca

#: Points of one vector: four doubles fill a register of AVX2, and are two of SSE2 or NEON.
LANES = 4

_OPERATIONS = {getattr(ca, name): name[3:].lower() for name in dir(ca) if name.startswith("OP_")}
_INFIX = {"add": "+", "sub": "-", "mul": "*", "div": "/"}
_COMPARISONS = {"lt": "<", "le": "<=", "eq": "==", "ne": "!="}
#: Operations of a function that is written as one: more take compilers minutes.
_LARGEST = 20_000
#: Functions of the C library, lane by lane; floor, fabs and sqrt are exact, so that they may be anything.
_LIBRARY = (
    "sin",
    "cos",
    "tan",
    "asin",
    "acos",
    "atan",
    "sinh",
    "cosh",
    "tanh",
    "exp",
    "log",
    "sqrt",
    "fabs",
    "floor",
    "ceil",
    "log1p",
    "expm1",
)
_LIBRARY_2 = ("atan2", "pow", "fmod", "fmin", "fmax")

_HEAD = """\
#define _GNU_SOURCE
#include <math.h>
#include <string.h>
#define LANES {lanes}
typedef double V __attribute__((vector_size(8 * LANES)));
typedef long long I __attribute__((vector_size(8 * LANES)));
#define EACH for (int l = 0; l < LANES; l++)
#define LIBRARY(name) static inline V v_##name(V x) {{ V y; EACH y[l] = name(x[l]); return y; }}
#define LIBRARY_2(name) static inline V v_##name(V x, V z) {{ V y; EACH y[l] = name(x[l], z[l]); return y; }}
#define SCALAR(name, expression) static inline double s_##name(double x) {{ return expression; }}
#define COMPARE(name, sign) \\
    static inline V v_##name(V x, V z) {{ return (V)((I)(x sign z) & (I)v_all(1.)); }} \\
    static inline double s_##name(double x, double z) {{ return x sign z; }}
#ifdef __GLIBC__ /* its sincos gives the bits of its sin and cos in less time than both */
#define SINE_AND_COSINE(x, s, c) sincos(x, &s, &c)
#else
#define SINE_AND_COSINE(x, s, c) (s = sin(x), c = cos(x))
#endif
static inline void v_sincos(V x, V *s, V *c)
{{
    EACH {{ double a, b; SINE_AND_COSINE(x[l], a, b); (*s)[l] = a; (*c)[l] = b; }}
}}
static inline V v_all(double x) {{ V y; EACH y[l] = x; return y; }}
static inline double sign_of(double x) {{ return x < 0 ? -1. : x > 0 ? 1. : x; }}
static inline double not_of(double x) {{ return !x; }}
static inline double and_of(double x, double z) {{ return x && z; }}
static inline double or_of(double x, double z) {{ return x || z; }}
static inline double if_else_zero(double x, double z) {{ return x ? z : 0; }}
/* the same of all lanes at once, without a branch: masks of ones and zeros, as comparisons make them */
#define TRUE_OF(x) ((I)((x) != v_all(0.)))
#define EITHER(mask, x, z) ((V)(((mask) & (I)(x)) | (~(mask) & (I)(z))))
static inline V v_not_of(V x) {{ return (V)(~TRUE_OF(x) & (I)v_all(1.)); }}
static inline V v_and_of(V x, V z) {{ return (V)(TRUE_OF(x) & TRUE_OF(z) & (I)v_all(1.)); }}
static inline V v_or_of(V x, V z) {{ return (V)((TRUE_OF(x) | TRUE_OF(z)) & (I)v_all(1.)); }}
static inline V v_if_else_zero(V x, V z) {{ return (V)(TRUE_OF(x) & (I)z); }}
static inline V v_fabs(V x) {{ return (V)((I)x & ~(I)v_all(-0.)); }}
static inline V v_sign_of(V x)
{{
    return EITHER((I)(x < v_all(0.)), v_all(-1.), EITHER((I)(x > v_all(0.)), v_all(1.), x));
}}
#if defined(__x86_64__) && defined(__GLIBC__) /* of two zeros its fmin and fmax take the first */
static inline V v_fmin(V x, V z) {{ return EITHER((I)(x <= z) | (I)(z != z), x, z); }}
static inline V v_fmax(V x, V z) {{ return EITHER((I)(x >= z) | (I)(z != z), x, z); }}
#else
LIBRARY_2(fmin)
LIBRARY_2(fmax)
#endif
"""


class NoVectorForm(Exception):
    """The function has an operation without a vector form: the virtual machine runs it."""


@dataclass(frozen=True)
class _Part:
    """One function of scalars in C: what is the same for all points, ``shared``, and what is not."""

    name: str
    shared_values: int
    text: str


def vector_c(function: ca.Function, many: Sequence[bool]) -> str:
    """C of ``run(n, in, out)`` for n points, arguments with ``many`` being different from point to point.

    ``in`` has an array for each input, ``out`` one for each output, in CasADi's order of elements (column by column),
    point after point. Raises NoVectorForm.
    """
    for k in range(function.n_in()):
        _require_dense(function.sparsity_in(k))
    for k in range(function.n_out()):
        _require_dense(function.sparsity_out(k))
    body = _Body(tuple(many))
    for step in _steps(function):
        body.add(step)
    inputs = [function.numel_in(k) for k in range(function.n_in())]
    outputs = [function.numel_out(k) for k in range(function.n_out())]
    return "\n".join(
        (
            _HEAD.format(lanes=LANES),
            *(f"LIBRARY({name})" for name in _LIBRARY if name != "fabs"),
            *(f"LIBRARY_2({name})" for name in _LIBRARY_2 if name not in ("fmin", "fmax")),
            *(f"COMPARE({name}, {sign})" for name, sign in _COMPARISONS.items()),
            *(part.text for part in body.parts.values()),
            _loop(inputs, outputs, many, body.before, body.lines),
        )
    )


@dataclass(frozen=True)
class _Step:
    """A step of the outermost function: input or output number ``port``, or a call of a function of scalars."""

    inputs: list[int]
    outputs: list[int]
    port: int = -1
    function: ca.Function | None = None


@dataclass(frozen=True)
class _Place:
    """Where a value is in C, and whether all points share it."""

    text: str
    shared: bool


class _Body:
    """The lines that run for every vector of points, those that run once before, and the functions they call."""

    def __init__(self, many: tuple[bool, ...]) -> None:
        self.before: list[str] = []
        self.lines: list[str] = []
        self.parts: dict[tuple[int, tuple[bool, ...]], _Part] = {}
        self._many = many
        self._places: dict[int, _Place] = {}  # of the work vector of the outermost function
        self._tables: dict[tuple[str, str], str] = {}

    def add(self, step: _Step) -> None:
        if step.function is not None:
            self._call(step, step.function)
        elif step.outputs:
            is_many = self._many[step.port]
            self._places[step.outputs[0]] = _Place(f"{'v' if is_many else 's'}{step.port}", not is_many)
        else:
            place = self._places[step.inputs[0]]
            value = f"v_all({place.text}[k])" if place.shared else f"{place.text}[k]"
            count = f"(int)(sizeof o{step.port} / sizeof(V))"
            self.lines.append(f"for (int k = 0; k < {count}; k++) o{step.port}[k] = {value};")

    def _call(self, step: _Step, function: ca.Function) -> None:
        given = [self._places[w] for w in step.inputs]
        pattern = tuple(not place.shared for place in given)
        key = (hash(function), pattern)  # by the function itself: names may repeat
        if key not in self.parts:
            self.parts[key] = _part(function, pattern, f"f{len(self.parts)}")
        part = self.parts[key]
        shared = [place.text for place in given if place.shared]
        table = self._tables.get((part.name, str(shared)))
        if table is None:
            table = self._tables[part.name, str(shared)] = f"t{len(self._tables)}"
            self.before.append(f"double {table}[{max(part.shared_values, 1)}];")
            self.before.append(f"{part.name}_shared({', '.join((*shared, table))});")
        results = [f"c{len(self.lines)}_{k}" for k in range(function.n_out())]
        self.lines += [f"V {name}[{function.numel_out(k)}];" for k, name in enumerate(results)]
        arguments = [place.text for place in given if not place.shared]
        self.lines.append(f"{part.name}({', '.join((*arguments, table, *results))});")
        for w, name in zip(step.outputs, results, strict=True):
            if w >= 0:
                self._places[w] = _Place(name, False)


def _loop(sizes_in: list[int], sizes_out: list[int], many: Sequence[bool], before: list[str], lines: list[str]) -> str:
    """The entry: LANES points at a time; the last vector is filled up with its last point."""
    text = ["void run(long long n, const double *const *in, double *const *out)", "{"]
    text += [f"    const double *s{k} = in[{k}];" for k in range(len(sizes_in)) if not many[k]]
    text += [f"    {line}" for line in before]
    text += [
        "    for (long long p = 0; p < n; p += LANES) {",
        "        const int here = n - p < LANES ? (int)(n - p) : LANES;",
    ]
    for k, size in enumerate(sizes_in):
        if many[k]:
            text += [
                f"        V v{k}[{max(size, 1)}];",
                f"        EACH {{ const double *at = in[{k}] + (p + (l < here ? l : here - 1)) * {size};",
                f"            for (int k = 0; k < {size}; k++) v{k}[k][l] = at[k]; }}",
            ]
    text += [f"        V o{k}[{max(size, 1)}];" for k, size in enumerate(sizes_out)]
    text += [f"        {line}" for line in lines]
    for k, size in enumerate(sizes_out):
        text.append(
            f"        for (int l = 0; l < here; l++) for (int k = 0; k < {size}; k++) "
            f"out[{k}][(p + l) * {size} + k] = o{k}[k][l];"
        )
    return "\n".join((*text, "    }", "}", ""))


def _steps(function: ca.Function) -> list[_Step]:
    """The steps of a function that only calls others; of any other, one call of it as scalars."""
    if function.is_a("SXFunction"):
        return _as_one(function)
    found = []
    for k in range(function.n_instructions()):
        kind = _OPERATIONS[function.instruction_id(k)]
        inputs, outputs = list(function.instruction_input(k)), list(function.instruction_output(k))
        called = function.instruction_MX(k).which_function() if kind == "call" else None
        if called is not None and called.is_a("SXFunction"):
            found.append(_Step(inputs, outputs, function=called))
        elif kind == "input":
            found.append(_Step([], outputs[:1], port=inputs[0]))
        elif kind == "output":
            found.append(_Step(inputs[:1], [], port=outputs[0]))
        else:
            return _as_one(_expanded(function))
    return found


def _expanded(function: ca.Function) -> ca.Function:
    try:
        expanded = function.expand()
    except RuntimeError as error:  # CasADi's word for an operation that scalars do not have
        raise NoVectorForm(function.name()) from error
    if expanded.n_instructions() > _LARGEST:
        raise NoVectorForm(f"{function.name()}: {expanded.n_instructions()} operations")
    return expanded


def _as_one(function: ca.Function) -> list[_Step]:
    n, m = function.n_in(), function.n_out()
    return [
        *(_Step([], [k], port=k) for k in range(n)),
        _Step(list(range(n)), list(range(n, n + m)), function=function),
        *(_Step([n + k], [], port=k) for k in range(m)),
    ]


def split_c(function: ca.Function, many: Sequence[bool], name: str) -> tuple[int, str]:
    """A function of scalars, what all points share computed apart: how many values that is, and the C of both parts.

    ``<name>_shared(x.., t)`` fills a table t from the arguments that are shared, ``<name>(x.., t, y..)`` takes the
    others and the table. V is the type of a value of a point, v_sqrt and the like what works on it.
    Raises NoVectorForm.
    """
    part = _part(_expanded(function), tuple(many), name)
    return part.shared_values, part.text


def _require_dense(sparsity: ca.Sparsity) -> None:
    if not sparsity.is_dense():
        raise NoVectorForm("an argument with structural zeros")


def _part(function: ca.Function, many: tuple[bool, ...], name: str) -> _Part:
    """A function of scalars: ``<name>_shared`` fills a table, ``<name>`` reads it for every vector of points."""
    shared_lines: list[str] = []
    lines: list[str] = []
    at: dict[int, tuple[str, bool]] = {}  # of the work vector: its name in C, and whether it is shared
    in_table: dict[str, int] = {}
    known: dict[str, tuple[str, bool]] = {}  # what was computed once is not computed again
    count = 0

    def as_vector(place: tuple[str, bool]) -> str:
        text, shared = place
        if not shared:
            return text
        if text not in in_table:
            in_table[text] = len(in_table)
            shared_lines.append(f"t[{in_table[text]}] = {text};")
        return f"t[{in_table[text]}]"

    for k in range(function.n_instructions()):
        kind = _OPERATIONS[function.instruction_id(k)]
        inputs, outputs = function.instruction_input(k), function.instruction_output(k)
        if kind == "input":
            which, element = inputs
            text = f"x{which}[{element}]"
            count += 1
            if many[which]:
                lines.append(f"const V a{count} = {text};")
            else:
                shared_lines.append(f"const double b{count} = {text};")
            at[outputs[0]] = (f"a{count}" if many[which] else f"b{count}", not many[which])
            continue
        if kind == "output":
            which, element = outputs
            place = at[inputs[0]]
            lines.append(f"y{which}[{element}] = {f'v_all({as_vector(place)})' if place[1] else place[0]};")
            continue
        count += 1
        if kind == "const":
            shared_lines.append(f"const double b{count} = {_literal(function.instruction_constant(k))};")
            at[outputs[0]] = (f"b{count}", True)
            continue
        places = [at[w] for w in inputs]
        value = f"{kind}({', '.join(text for text, _ in places)})"
        if value in known:
            pass
        elif all(shared for _, shared in places):
            shared_lines.append(f"const double b{count} = {_scalar(kind, [text for text, _ in places])};")
            known[value] = (f"b{count}", True)
        elif kind in ("sin", "cos"):
            angle = places[0][0]
            lines.append(f"V a{count}, a{count}_c; v_sincos({angle}, &a{count}, &a{count}_c);")
            known[f"sin({angle})"], known[f"cos({angle})"] = (f"a{count}", False), (f"a{count}_c", False)
        else:
            texts = [as_vector(place) for place in places]
            lines.append(f"const V a{count} = {_vector(kind, texts, [shared for _, shared in places])};")
            known[value] = (f"a{count}", False)
        at[outputs[0]] = known[value]
    xs = [f"const {'V' if is_many else 'double'} *x{k}" for k, is_many in enumerate(many)]
    ys = [f"V *y{k}" for k in range(function.n_out())]
    shared_head = ", ".join([x for x, is_many in zip(xs, many, strict=True) if not is_many] + ["double *restrict t"])
    head = ", ".join([x for x, is_many in zip(xs, many, strict=True) if is_many] + ["const double *restrict t"] + ys)
    text = "\n".join(
        (
            f"static void {name}_shared({shared_head})",
            "{",
            *(f"    {line}" for line in shared_lines),
            "}",
            f"static void {name}({head})",
            "{",
            *(f"    {line}" for line in lines),
            "}",
        )
    )
    return _Part(name, len(in_table), text)


def _literal(value: float) -> str:
    if value != value:
        return "NAN"
    if value in (float("inf"), float("-inf")):
        return "INFINITY" if value > 0 else "-INFINITY"
    return f"({value!r})" if "." in repr(value) or "e" in repr(value) else f"({value!r}.0)"


_CALLED = {
    "sign": "sign_of",
    "not": "not_of",
    "and": "and_of",
    "or": "or_of",
    "if_else_zero": "if_else_zero",
    "constpow": "pow",
    **{name: name for name in (*_LIBRARY, *_LIBRARY_2)},
}


def _scalar(kind: str, x: list[str]) -> str:
    if kind in _INFIX:
        return f"{x[0]} {_INFIX[kind]} {x[1]}"
    if kind in _COMPARISONS:
        return f"s_{kind}({x[0]}, {x[1]})"
    return _either(kind, x) or f"{_called(kind)}({', '.join(x)})"


def _vector(kind: str, x: list[str], shared: list[bool]) -> str:
    if kind in _INFIX:
        return f"{x[0]} {_INFIX[kind]} {x[1]}"
    whole = [f"v_all({text})" if is_shared else text for text, is_shared in zip(x, shared, strict=True)]
    if kind in _COMPARISONS:
        return f"v_{kind}({', '.join(whole)})"
    return _either(kind, x) or f"v_{_called(kind)}({', '.join(whole)})"


def _either(kind: str, x: list[str]) -> str:
    """What is written alike for scalars and vectors."""
    return {
        "neg": f"-{x[0]}",
        "sq": f"{x[0]} * {x[0]}",
        "twice": f"2. * {x[0]}",
        "inv": f"1. / {x[0]}",
        "assign": x[0],
    }.get(kind, "")


def _called(kind: str) -> str:
    if kind not in _CALLED:
        raise NoVectorForm(kind)
    return _CALLED[kind]
