"""CasADi functions called over buffers, one by one and in blocks, without conversion of arguments."""

from __future__ import annotations

from typing import Any

import casadi as ca
import numpy as np


class Fast:
    """A CasADi function called over buffers: for single calls, where the conversion of arguments would cost most."""

    def __init__(self, function: ca.Function) -> None:
        self.function = function
        self._buffer: Any
        self._buffer, self._run = function.buffer()
        self._inputs = [np.zeros(function.size_in(k), order="F") for k in range(function.n_in())]
        self._outputs = [np.zeros(function.size_out(k), order="F") for k in range(function.n_out())]
        for k, array in enumerate(self._inputs):
            self._buffer.set_arg(k, _memory(array))
        for k, array in enumerate(self._outputs):
            self._buffer.set_res(k, _memory(array))

    def __call__(self, *arguments: np.typing.ArrayLike) -> list[np.ndarray]:
        """The outputs as arrays of two axes."""
        for array, argument in zip(self._inputs, arguments, strict=True):
            array[...] = np.reshape(argument, array.shape)
        self._run()
        return [array.copy() for array in self._outputs]


class Mapped:
    """A CasADi function of dense outputs for many points, a block of one size at a time: to map it takes a while."""

    def __init__(self, function: ca.Function, shared: tuple[int, ...] = (), block: int = 16) -> None:
        self._block, self._shared = block, shared
        self._shapes = [function.size_out(k) for k in range(function.n_out())]
        self._run = Fast(function.map(f"{function.name()}s", "serial", block, list(shared), []))

    def __call__(self, *arguments: np.ndarray) -> list[np.ndarray]:
        """Outputs (n, rows, columns) at points (n, size) each, but for what all points share."""
        n = max(len(argument) for k, argument in enumerate(arguments) if k not in self._shared)
        parts = []
        for first in range(0, n, self._block):
            index = np.minimum(np.arange(first, first + self._block), n - 1)
            given = [one if k in self._shared else one[index].reshape(self._block, -1).T
                     for k, one in enumerate(arguments)]  # fmt: skip
            found = self._run(*given)
            parts.append(
                [array.reshape(rows, self._block, columns, order="A" if columns == 1 else "C").swapaxes(0, 1)
                 for array, (rows, columns) in zip(found, self._shapes, strict=True)]
            )  # fmt: skip
        return [np.concatenate(arrays)[:n] for arrays in zip(*parts, strict=True)]


def _memory(array: np.ndarray) -> memoryview:
    """The memory of an array, as CasADi takes it: columns one after the other."""
    flat: Any = array.ravel(order="K")
    return memoryview(flat)
