"""Kernels compiled and called on this computer: the same C that is shipped, at full speed from NumPy."""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cache, cached_property, lru_cache

import numpy as np

from gearmath.engine.compiler import compile_library
from gearmath.engine.kernel import Kernel
from gearmath.errors import InputError
from gearmath.export.c import contract_files, double_kernel, integer_kernel
from gearmath.kernels import kernel


@dataclass(frozen=True)
class CompiledKernel:
    """A Kernel as machine code, called like the Kernel itself; the loop over the points runs in C."""

    kernel: Kernel
    library: ctypes.CDLL = field(repr=False)

    @property
    def name(self) -> str:
        return self.kernel.name

    def __call__(self, *arguments: np.typing.ArrayLike) -> tuple[np.ndarray, ...]:
        """Evaluate at one or many points: shapes and broadcasting as in :meth:`gearmath.lowering.Kernel.__call__`.

        Raises InputError naming the first point outside the domain, or without a result.
        """
        arrays = [np.asarray(argument, dtype=float, order="C") for argument in arguments]
        if len(arrays) != len(self._inputs):
            names = ", ".join(name for name, _, _ in self._inputs)
            raise TypeError(f"{self.name}: the arguments are {names}; {len(arrays)} given")
        n, is_many = 1, False
        for array, (_, shape, _) in zip(arrays, self._inputs, strict=True):
            if array.ndim > len(shape):
                n, is_many = (max(n, len(array)) if is_many else len(array)), True
        values: list[int] = [n]
        for array, (name, shape, size) in zip(arrays, self._inputs, strict=True):
            many = array.ndim > len(shape)
            if array.shape != ((n, *shape) if many else shape):
                raise ValueError(f"{self.name}: {name} has shape {array.shape}, expected {shape}")
            values += (array.ctypes.data, size if many else 0)
        outputs = [np.empty((n, *quantity.shape)) for quantity in self.kernel.outputs]
        first_bad = ctypes.c_int64()
        status = self._batch(*values, *(output.ctypes.data for output in outputs), ctypes.byref(first_bad))
        if status:
            where = f" at point {first_bad.value}" if is_many else ""
            raise InputError(f"{self.name}{where}: {self.library.gm_error_text(status).decode()}")
        return tuple(output if is_many else output[0] for output in outputs)

    @cached_property
    def _inputs(self) -> tuple[tuple[str, tuple[int, ...], int], ...]:
        """Name, shape and size of every input."""
        return tuple((quantity.name, tuple(quantity.shape), quantity.size) for quantity in self.kernel.inputs)

    @cached_property
    def _batch(self) -> Callable[..., object]:
        """The loop in C: how many points, every input with its stride, the outputs, where the first bad point goes."""
        self.library.gm_error_text.restype = ctypes.c_char_p
        function = getattr(self.library, f"gm_{self.name}_batch")
        function.argtypes = [
            ctypes.c_int64,
            *[ctypes.c_void_p, ctypes.c_int64] * len(self._inputs),
            *[ctypes.c_void_p] * (len(self.kernel.outputs) + 1),
        ]
        return function


def compile_kernel(kernel: Kernel) -> CompiledKernel:
    """The kernel compiled for this computer, once per process for the same C.

    Raises ComputationError where there is no compiler, ExportError where the Kernel cannot become C.
    """
    if id(kernel) not in _COMPILED:
        _COMPILED[id(kernel)] = CompiledKernel(
            kernel, _library(tuple((contract_files() | double_kernel(kernel).files).items()))
        )
    return _COMPILED[id(kernel)]


#: By the identity of the kernel, which a compiled one holds.
_COMPILED: dict[int, CompiledKernel] = {}


@lru_cache(maxsize=64)
def _library(files: tuple[tuple[str, str], ...]) -> ctypes.CDLL:
    return compile_library(dict(files))


def _pointer(array: np.ndarray) -> ctypes.c_void_p:
    return ctypes.c_void_p(array.__array_interface__["data"][0])


#: Feeds recorded encoder edges to the step rule of the firmware; the remainder is kept as the interrupt keeps it.
_RUN_EDGES = """\
#include "gm_gearbox_step.h"

void gm_run_edges(
    long n, const int8_t *edges, int32_t numerator, int32_t denominator, int32_t *remainder, int8_t *steps)
{
  long k;
  int32_t step;
  for (k = 0; k < n; ++k) {
    gm_gearbox_step(*remainder, edges[k], numerator, denominator, &step, remainder);
    steps[k] = (int8_t)step;
  }
}
"""


def run_edges(edges: np.ndarray, numerator: int, denominator: int, remainder: int) -> tuple[np.ndarray, int]:
    """The steps (n,) int8 that the compiled ``gm_gearbox_step`` delivers for edges (n,) of ±1, and the last remainder.

    Raises InputError where edges or numbers lie outside the domain of the step rule.
    """
    values = np.asarray(edges)
    if values.ndim != 1 or not np.isin(values, (-1, 1)).all():
        raise InputError("edges: must be a list of +1 and -1")
    if not 0 < numerator <= denominator <= 2**30:
        raise InputError(f"ratio {numerator}/{denominator}: N/D must satisfy 0 < N <= D <= 2^30")
    if not 0 <= remainder < denominator:
        raise InputError(f"remainder = {remainder}: must satisfy 0 <= remainder < {denominator}")
    contiguous = np.ascontiguousarray(values, dtype=np.int8)
    steps = np.empty(len(contiguous), dtype=np.int8)
    state = ctypes.c_int32(remainder)
    _step_library().gm_run_edges(
        ctypes.c_long(len(steps)),
        _pointer(contiguous),
        ctypes.c_int32(numerator),
        ctypes.c_int32(denominator),
        ctypes.byref(state),
        _pointer(steps),
    )
    return steps, state.value


@cache
def _step_library() -> ctypes.CDLL:
    return compile_library(integer_kernel(kernel("gearbox_step")).files | {"gm_run_edges.c": _RUN_EDGES})


#: The same for the general rule in 64 bits, edges of two axes in the order in which they come.
_RUN_AXES = """\
#include "gm_gearbox_edge.h"

void gm_run_axes(
    long n, const int8_t *axes, const int8_t *edges, const int64_t *base, const int64_t *increment,
    int64_t denominator, int64_t *remainder, int8_t *steps)
{
  long k;
  int64_t step;
  for (k = 0; k < n; ++k) {
    gm_gearbox_edge(*remainder, edges[k], increment[axes[k]], base[axes[k]], denominator, &step, remainder);
    steps[k] = (int8_t)step;
  }
}
"""


def run_axes(
    axes: np.ndarray,
    edges: np.ndarray,
    base: tuple[int, int],
    increment: tuple[int, int],
    denominator: int,
    remainder: int,
) -> tuple[np.ndarray, int]:
    """The steps (n,) int8 that the compiled ``gm_gearbox_edge`` delivers in 64 bits, and the last remainder.

    Edges (n,) of ±1 come on ``axes`` (n,), 0 hob and 1 feed; the ratio of axis j is base[j] + increment[j]/denominator.
    Raises InputError where edges or numbers lie outside the domain of the rule.
    """
    values, places = np.asarray(edges), np.asarray(axes)
    if values.ndim != 1 or not np.isin(values, (-1, 1)).all():
        raise InputError("edges: must be a list of +1 and -1")
    if places.shape != values.shape or not np.isin(places, (0, 1)).all():
        raise InputError("axes: must be 0 or 1 for every edge")
    if not 0 < denominator <= 2**62 or not all(0 <= rest < denominator for rest in (*increment, remainder)):
        raise InputError(f"{increment}/{denominator} from {remainder}: must satisfy 0 <= N', a < D <= 2^62")
    if max(map(abs, base)) > 64:
        raise InputError(f"base = {base}: at most 64 whole steps an edge")
    place, edge = (np.ascontiguousarray(array, dtype=np.int8) for array in (places, values))
    steps = np.empty(len(edge), dtype=np.int8)
    pair = ctypes.c_int64 * 2
    state = ctypes.c_int64(remainder)
    _axes_library().gm_run_axes(
        ctypes.c_long(len(steps)),
        _pointer(place),
        _pointer(edge),
        pair(*base),
        pair(*increment),
        ctypes.c_int64(denominator),
        ctypes.byref(state),
        _pointer(steps),
    )
    return steps, state.value


@cache
def _axes_library() -> ctypes.CDLL:
    return compile_library(integer_kernel(kernel("gearbox_edge"), bits=64).files | {"gm_run_axes.c": _RUN_AXES})
