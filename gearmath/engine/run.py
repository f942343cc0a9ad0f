"""One decision: which machine code a CasADi function runs as, for so many points.

A function starts in CasADi's virtual machine. Where it is worth it, its vector form (:mod:`gearmath.engine.vector_c`)
is looked up in the cache, and compiled once the virtual machine has spent about as long as that takes. Both give the
same bits, so that nothing but time depends on the decision, nor on the number of threads.
"""

from __future__ import annotations

import ctypes
import os
import sys
import tempfile
import threading
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import cache, lru_cache
from itertools import pairwise
from pathlib import Path

import casadi as ca
import numpy as np

from gearmath.engine import cache as kept
from gearmath.engine import vector_c as vector_module
from gearmath.engine.compiler import SUFFIX, compile_library, find_compiler, identity, load
from gearmath.engine.vector_c import LANES, NoVectorForm, vector_c
from gearmath.errors import ComputationError

#: ``native``: this code never leaves this computer. Contraction would change the bits.
FLAGS = ("-std=gnu99", "-O2", "-march=native", "-ffp-contract=off", "-fPIC", "-shared", "-w")
#: Operations (of one function, over all its points so far) from which the cache is asked: some ms of virtual machine.
_ASK = 2e5
#: Operations from which it is compiled: about a second of virtual machine, which is what compiling takes.
_COMPILE = 5e7
#: Operations of a function that does not tell them, such as a map.
_UNKNOWN = 10_000
#: Points of one call of the virtual machine: mapped, it copies what they share for each of them.
_BLOCK = 20_000
#: Operations of a batch from which it is spread over threads.
_SPREAD = 2e6


class Runner:
    """Runs one function for one pattern of arguments that differ from point to point; see the module."""

    def __init__(self, function: ca.Function, many: tuple[bool, ...]) -> None:
        self._function, self._many = function, many
        self._sizes_in = [function.numel_in(k) for k in range(function.n_in())]
        self._sizes_out = [function.numel_out(k) for k in range(function.n_out())]
        self._dense = all(function.sparsity_in(k).is_dense() for k in range(function.n_in())) and all(
            function.sparsity_out(k).is_dense() for k in range(function.n_out())
        )
        self._operations = _operations(function)
        self._spent = 0.0  # operations in the virtual machine; infinite where it is all there is
        self._compiled: ctypes.CDLL | None = None
        self._name: str | None = None  # of the library in the cache
        self._lock = threading.Lock()

    def __call__(self, arguments: Sequence[np.ndarray], n: int) -> list[np.ndarray]:
        """Outputs (n, size), elements column by column, of arguments (n, size) where many, else (1, size)."""
        work = self._operations * n
        if self._compiled is None and self._spent < np.inf:
            self._consider(work)
        if self._compiled is None:
            return self.interpreted(arguments, n)
        outputs = [np.empty((n, size)) for size in self._sizes_out]
        parts = min(_threads(), int(work / _SPREAD) + 1)
        edges = [LANES * (n * k // parts // LANES) for k in range(parts)] + [n]
        pieces = [(low, high) for low, high in pairwise(edges) if high > low]
        if len(pieces) < 2:
            self._run(arguments, outputs, 0, n)
        else:
            list(_pool().map(lambda piece: self._run(arguments, outputs, *piece), pieces))
        return outputs

    def _run(self, arguments: Sequence[np.ndarray], outputs: list[np.ndarray], low: int, high: int) -> None:
        given = [
            _address(array) + low * array.strides[0] * is_many
            for array, is_many in zip(arguments, self._many, strict=True)
        ]
        results = [_address(array) + low * array.strides[0] for array in outputs]
        pointers = [(ctypes.c_void_p * len(addresses))(*addresses) for addresses in (given, results)]
        self._compiled.run(ctypes.c_longlong(high - low), *pointers)  # type: ignore[union-attr]

    def interpreted(self, arguments: Sequence[np.ndarray], n: int) -> list[np.ndarray]:
        """The same by CasADi's virtual machine, whatever is compiled."""
        if n > _BLOCK:
            parts = []
            for low in range(0, n, _BLOCK):
                given = [a[low : low + _BLOCK] if many else a for a, many in zip(arguments, self._many, strict=True)]
                parts.append(self.interpreted(given, min(_BLOCK, n - low)))
            return [np.concatenate(arrays) for arrays in zip(*parts, strict=True)]
        if n == 1 and self._dense:
            return self._interpreted_once(arguments)
        columns = []
        for k, (array, size) in enumerate(zip(arguments, self._sizes_in, strict=True)):
            flat = np.broadcast_to(array, (n, size))
            height, width = self._function.size_in(k)
            # in memory a point is a run of columns: (width, height) a point, whose transpose CasADi wants side by side
            columns.append(
                np.ascontiguousarray(flat.reshape(n, width, height).transpose(2, 0, 1).reshape(height, n * width))
            )
        results = _mapped(self._function, n).call(columns) if n else [np.empty((s, 0)) for s in self._sizes_out]
        outputs = []
        for k, (result, size) in enumerate(zip(results, self._sizes_out, strict=True)):
            height, width = self._function.size_out(k)
            array = np.asarray(result).reshape(height, n, width)
            outputs.append(np.ascontiguousarray(array.transpose(1, 2, 0)).reshape(n, size))
        return outputs

    def _interpreted_once(self, arguments: Sequence[np.ndarray]) -> list[np.ndarray]:
        """One point by the virtual machine, on the arrays as they lie: converting them may cost more."""
        given = [np.ascontiguousarray(array).reshape(-1) for array in arguments]
        outputs = [np.zeros((1, size)) for size in self._sizes_out]
        buffer, evaluate = self._function.buffer()  # one of its own for every call: threads share the function
        for k, array in enumerate(given):
            buffer.set_arg(k, array.data)  # type: ignore[call-arg]  # its stub has not what it takes
        for k, result in enumerate(outputs):
            buffer.set_res(k, result.reshape(-1).data)  # type: ignore[call-arg]
        evaluate()
        if buffer.ret():
            raise RuntimeError(f"{self._function.name()} could not be evaluated")
        return outputs

    def _consider(self, work: float) -> None:
        """Whether to go on in the virtual machine, to load what was compiled before, or to compile."""
        with self._lock:
            self._spent += work
            if self._compiled is not None or self._spent < _ASK:
                return
            if not _can_compile():
                self._spent = np.inf
                return
            if self._name is None:
                self._name = _name(self._function, self._many)
                self._compiled = _looked_up(self._name)
            if self._compiled is None and self._spent >= _COMPILE:
                self._compiled, self._spent = _compiled(self._name, self._function, self._many), np.inf


@lru_cache(maxsize=1024)
def runner(function: ca.Function, many: tuple[bool, ...]) -> Runner:
    """The Runner of a function for a pattern of arguments."""
    return Runner(function, many)


def _address(array: np.ndarray) -> int:
    """Where the elements lie; asked here for every argument of every call, and ``array.ctypes`` takes its time."""
    return array.__array_interface__["data"][0]


def _operations(function: ca.Function) -> int:
    """About how many operations a point takes."""
    if not function.is_a("SXFunction") and not function.is_a("MXFunction"):
        return _UNKNOWN
    total = 0
    for k in range(function.n_instructions()):
        called = None
        if not function.is_a("SXFunction") and function.instruction_id(k) == ca.OP_CALL:
            called = function.instruction_MX(k).which_function()
        total += 1 if called is None or called.is_null() else _operations(called)
    return total


@lru_cache(maxsize=64)
def _mapped(function: ca.Function, n: int) -> ca.Function:
    return function.map(n) if n > 1 else function


def _name(function: ca.Function, many: tuple[bool, ...]) -> str:
    """Of a library: all that its machine code depends on."""
    writer = Path(vector_module.__file__).read_bytes()
    return f"kernel-{kept.key(function.serialize(), repr(many), writer, ' '.join(FLAGS), identity())}{SUFFIX}"


def _looked_up(name: str) -> ctypes.CDLL | None:
    """The library that was compiled before, if it was."""
    data = kept.read(name)
    if data is None:
        return None
    # loaded from a copy of what was checked, so that nobody can exchange it in between
    folder = Path(tempfile.mkdtemp(prefix="gearmath-"))
    library = folder / f"libkernels{SUFFIX}"
    library.write_bytes(data)
    try:
        return load(library)
    except OSError:
        return None


def _compiled(name: str, function: ca.Function, many: tuple[bool, ...]) -> ctypes.CDLL | None:
    """The library compiled now and kept; None where the function has no vector form, or the compiler fails."""
    try:
        library = compile_library({"kernel.c": vector_c(function, many)}, FLAGS)
    except (NoVectorForm, ComputationError):
        return None
    kept.write(name, Path(library._name).read_bytes())
    return library


@cache
def _can_compile() -> bool:
    """Whether there is a compiler; where there is none, it is said once."""
    try:
        find_compiler()
    except ComputationError as error:
        print(f"gearmath: {error}; until then kernels run in CasADi's virtual machine, slower", file=sys.stderr)
        return False
    return True


@cache
def _threads() -> int:
    """GEARMATH_THREADS, or as many as there are processors."""
    chosen = os.environ.get("GEARMATH_THREADS", "")
    return (
        max(1, int(chosen))
        if chosen.isdigit()
        else len(os.sched_getaffinity(0))
        if hasattr(os, "sched_getaffinity")
        else os.cpu_count() or 1
    )


@cache
def _pool() -> ThreadPoolExecutor:
    return ThreadPoolExecutor(_threads())
