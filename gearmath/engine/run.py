"""One decision: which machine code a CasADi function runs as, for so many points.

A function starts in CasADi's virtual machine. Where it is worth it, its vector form (:mod:`gearmath.engine.vector_c`)
is looked up in the cache, and compiled once the virtual machine has spent about as long as that takes. Both give the
same bits, so that nothing but time depends on the decision, nor on the number of threads.
"""

from __future__ import annotations

import ctypes
import os
import re
import shutil
import sys
import tempfile
import threading
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import cache, lru_cache
from itertools import pairwise
from pathlib import Path
from typing import Any

import casadi as ca
import numpy as np

from gearmath.engine import cache as kept
from gearmath.engine import vector_c as vector_module
from gearmath.engine.compiler import SUFFIX, build, find_compiler, identity, load
from gearmath.engine.vector_c import LANES, NoVectorForm, vector_c
from gearmath.errors import ComputationError

#: ``native``: this code never leaves this computer. Contraction would change the bits.
#: Nobody asks for errno, and the square root of a vector is one instruction without it.
FLAGS = ("-std=gnu99", "-O2", "-march=native", "-ffp-contract=off", "-fno-math-errno", "-fPIC", "-shared", "-w")
#: Operations (of one function, over all its points so far) from which the cache is asked: some ms of virtual machine.
_ASK = 2e5
#: Operations from which it is compiled: about a second of virtual machine, which is what compiling a function of
#: ``_LARGE`` operations takes; small ones take this part of it. In the virtual machine a point costs as much as some
#: operations more.
_COMPILE, _LARGE, _LEAST_PART, _POINT_COST = 5e7, 4000, 0.2, 30
#: Operations of a function that does not tell them, such as a map.
_UNKNOWN = 10_000
#: Points of one call of the virtual machine: mapped, it copies what they share for each of them.
_BLOCK = 20_000
#: Points of a smaller call run in blocks of this size over memory that is kept: to map and convert takes longer.
_SMALL, _FEW = 512, 16
#: Operations of a batch from which it is spread over threads.
_SPREAD = 2e6
_ONE = ctypes.c_longlong(1)
#: What GEARMATH_THREADS may be.
_COUNT = re.compile(r"[1-9][0-9]{0,3}", re.ASCII)


class KernelRunner:
    """Runs one function for one pattern of arguments that differ from point to point; see the module."""

    def __init__(self, function: ca.Function, many: tuple[bool, ...]) -> None:
        self._function, self._many = function, many
        self._sizes_in = [function.numel_in(k) for k in range(function.n_in())]
        self._sizes_out = [function.numel_out(k) for k in range(function.n_out())]
        self._operations = _operations(function)
        self._is_dense = all(
            sparsity.is_dense()
            for sparsity in (
                *(function.sparsity_in(k) for k in range(function.n_in())),
                *(function.sparsity_out(k) for k in range(function.n_out())),
            )
        )
        self._blocks: dict[int, list[_Block]] = {1: [], _FEW: []}  # those that no thread runs just now
        self._points: list[_Point] = []  # for compiled code, as well
        self._spent = 0.0  # operations in the virtual machine; infinite where it is all there is
        self._compiled: ctypes.CDLL | None = None
        self._name: str | None = None  # of the library in the cache
        self._lock = threading.Lock()

    def __call__(self, arguments: Sequence[np.ndarray], n: int) -> list[np.ndarray]:
        """Outputs (n, size), elements column by column, of arguments (n, size) where many, else (1, size)."""
        work = self._operations * n
        if self._compiled is None and self._spent < np.inf:
            self._consider(work + _POINT_COST * n)
        if self._compiled is None:
            return self.interpreted(arguments, n)
        if n == 1:
            return self._at_one(arguments)
        outputs = [np.empty((n, size)) for size in self._sizes_out]
        parts = min(_threads(), int(work / _SPREAD) + 1)
        edges = [LANES * (n * k // parts // LANES) for k in range(parts)] + [n]
        pieces = [(low, high) for low, high in pairwise(edges) if high > low]
        if len(pieces) < 2:
            self._run(arguments, outputs, 0, n)
        else:
            list(_pool().map(lambda piece: self._run(arguments, outputs, *piece), pieces))
        return outputs

    def _at_one(self, arguments: Sequence[np.ndarray]) -> list[np.ndarray]:
        """One point, over memory that stays: to tell compiled code where new arrays are takes longer than it runs."""
        try:
            point = self._points.pop()
        except IndexError:
            point = _Point(self._sizes_in, self._sizes_out)
        outputs = point.run(self._compiled, arguments)
        self._points.append(point)
        return outputs

    def _run(self, arguments: Sequence[np.ndarray], outputs: list[np.ndarray], low: int, high: int) -> None:
        given = [array[low:high] if is_many else array for array, is_many in zip(arguments, self._many, strict=True)]
        results = [array[low:high] for array in outputs]
        self._compiled.run(ctypes.c_longlong(high - low), _pointers(given), _pointers(results))  # type: ignore[union-attr]

    def interpreted(self, arguments: Sequence[np.ndarray], n: int) -> list[np.ndarray]:
        """The same by CasADi's virtual machine, whatever is compiled."""
        if 0 < n <= _SMALL and self._is_dense:
            return self._in_blocks(arguments, n)
        if n > _BLOCK:
            parts = []
            for low in range(0, n, _BLOCK):
                given = [a[low : low + _BLOCK] if many else a for a, many in zip(arguments, self._many, strict=True)]
                parts.append(self.interpreted(given, min(_BLOCK, n - low)))
            return [np.concatenate(arrays) for arrays in zip(*parts, strict=True)]
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

    def _in_blocks(self, arguments: Sequence[np.ndarray], n: int) -> list[np.ndarray]:
        """Blocks of a few points, and what is left point by point."""
        outputs = [np.empty((n, count)) for count in self._sizes_out]
        low = 0
        for size in (_FEW, 1):
            if n - low < size:
                continue
            free = self._blocks[size]
            try:
                block = free.pop()
            except IndexError:
                block = _Block(_mapped(self._function, size), size)
            while n - low >= size:
                block.run(arguments, outputs, low, size)
                low += size
            free.append(block)
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
            part = min(1.0, _LEAST_PART + self._operations / _LARGE)
            if self._compiled is None and self._spent >= _COMPILE * part:
                self._compiled, self._spent = _compiled(self._name, self._function, self._many), np.inf


class _Point:
    """Memory of one point for compiled code, and where it is."""

    def __init__(self, sizes_in: Sequence[int], sizes_out: Sequence[int]) -> None:
        self._inputs, self._outputs = ([np.zeros((1, size)) for size in sizes] for sizes in (sizes_in, sizes_out))
        self._pointers = _pointers(self._inputs), _pointers(self._outputs)

    def run(self, library: Any, arguments: Sequence[np.ndarray]) -> list[np.ndarray]:
        for array, argument in zip(self._inputs, arguments, strict=True):
            array[:] = argument
        library.run(_ONE, *self._pointers)
        return [array.copy() for array in self._outputs]


class _Block:
    """A function mapped to a few points, which reads and writes memory that stays where it is."""

    def __init__(self, function: ca.Function, size: int) -> None:
        self._buffer: Any
        self._buffer, self._evaluate = function.buffer()
        self._inputs = [np.zeros((size, function.numel_in(k) // size)) for k in range(function.n_in())]
        self._outputs = [np.zeros((size, function.numel_out(k) // size)) for k in range(function.n_out())]
        for arrays, give in ((self._inputs, self._buffer.set_arg), (self._outputs, self._buffer.set_res)):
            for k, array in enumerate(arrays):
                memory: Any = array.reshape(-1)
                give(k, memoryview(memory))

    def run(self, arguments: Sequence[np.ndarray], outputs: Sequence[np.ndarray], low: int, size: int) -> None:
        """The points from ``low`` on, as many as the block has; an argument of one point is that of all."""
        for array, argument in zip(self._inputs, arguments, strict=True):
            array[:] = argument[low : low + size] if len(argument) > 1 else argument
        self._evaluate()
        for array, output in zip(self._outputs, outputs, strict=True):
            output[low : low + size] = array


def _pointers(arrays: Sequence[np.ndarray]) -> Any:
    # the interface of the array is a third of the time of `array.ctypes`, which counts where points are few
    return (ctypes.c_void_p * len(arrays))(*[array.__array_interface__["data"][0] for array in arrays])


@lru_cache(maxsize=1024)
def runner(function: ca.Function, many: tuple[bool, ...]) -> KernelRunner:
    """The Runner of a function for a pattern of arguments."""
    return KernelRunner(function, many)


def _operations(function: ca.Function) -> int:
    """About how many operations a point takes."""
    if function.is_a("SXFunction"):
        return function.n_instructions()
    if not function.is_a("MXFunction"):
        return _UNKNOWN
    total = 0
    for k in range(function.n_instructions()):
        called = None
        if function.instruction_id(k) == ca.OP_CALL:
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
    try:
        return None if data is None else _loaded(data)
    except OSError:
        return None


def _loaded(data: bytes) -> ctypes.CDLL:
    """A library from a copy of what was read, or compiled, so that nobody can exchange it in between."""
    folder = Path(tempfile.mkdtemp(prefix="gearmath-"))
    try:
        library = folder / f"libkernels{SUFFIX}"
        library.write_bytes(data)
        return load(library)
    except BaseException:  # a full disk, one from which nothing may be run, or no library at all
        shutil.rmtree(folder, ignore_errors=True)
        raise


def _compiled(name: str, function: ca.Function, many: tuple[bool, ...]) -> ctypes.CDLL | None:
    """The library compiled now and kept; None where the function has no vector form.

    None also where the compiler fails, or what it makes cannot be loaded: that is said once, and not kept.
    """
    try:
        with tempfile.TemporaryDirectory(prefix="gearmath-") as folder:
            data = build({"kernel.c": vector_c(function, many)}, Path(folder), FLAGS).read_bytes()
        made = _loaded(data)
    except NoVectorForm:
        return None
    except ComputationError as error:
        _say_slower(str(error))
        return None
    except OSError:
        _say_slower(
            f"what the C compiler {find_compiler()[0]} makes cannot be loaded from the folder for temporary files: the "
            "disk is full, nothing may be run from it, or it is no library"
        )
        return None
    kept.write(name, data)
    return made


@cache
def _can_compile() -> bool:
    """Whether there is a compiler; where there is none, it is said once."""
    try:
        find_compiler()
    except ComputationError as error:
        _say_slower(str(error))
        return False
    return True


@cache
def _say_slower(why: str) -> None:
    """Say why kernels are not compiled, each reason once."""
    print(f"gearmath: {why}; until then kernels run in CasADi's virtual machine, slower", file=sys.stderr)


@cache
def _threads() -> int:
    """GEARMATH_THREADS, or as many as there are processors; what is no such number is said once."""
    chosen = os.environ.get("GEARMATH_THREADS", "")
    if _COUNT.fullmatch(chosen):
        return int(chosen)
    if chosen:
        print(
            f"gearmath: GEARMATH_THREADS = {chosen!r}: must be a whole number from 1 to 9999; all processors are used",
            file=sys.stderr,
        )
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


@cache
def _pool() -> ThreadPoolExecutor:
    return ThreadPoolExecutor(_threads())


if hasattr(os, "register_at_fork"):
    # a forked process has none of the threads, and would wait for them for ever
    os.register_at_fork(after_in_child=_pool.cache_clear)
