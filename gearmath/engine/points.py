"""A CasADi function without the meaning of a Kernel, run by the engine at one or many points."""

from __future__ import annotations

import casadi as ca
import numpy as np

from gearmath.engine.run import runner


class Points:
    """A dense function of column vectors, as code calls it that solves equations: arrays in, arrays out.

    ``shared`` names the arguments that all points of a call share. Kernels are called as they are; this is for what is
    composed of them with derivatives, and of numbers of one gear set.
    """

    def __init__(self, function: ca.Function, shared: tuple[int, ...] = ()) -> None:
        self.function = function
        self._many = tuple(k not in shared for k in range(function.n_in()))
        self._shapes = [function.size_out(k) for k in range(function.n_out())]
        self._run = runner(function, self._many)

    def __call__(self, *arguments: np.ndarray) -> list[np.ndarray]:
        """Outputs (n, rows, columns) at arguments (n, size), or (size,) of what is shared."""
        n = max(len(argument) for argument, many in zip(arguments, self._many, strict=True) if many)
        found = self._run(
            [
                np.ascontiguousarray(argument if many else argument[None], dtype=float)
                for argument, many in zip(arguments, self._many, strict=True)
            ],
            n,
        )
        # in memory column by column
        return [
            flat.reshape(n, columns, rows).swapaxes(1, 2)
            for flat, (rows, columns) in zip(found, self._shapes, strict=True)
        ]

    def at(self, *arguments: np.typing.ArrayLike) -> list[np.ndarray]:
        """Outputs (rows, columns) at one point."""
        flats = [np.array(argument, dtype=float).reshape(1, -1) for argument in arguments]
        found = self._run(flats, 1)
        return [flat.reshape(columns, rows).T for flat, (rows, columns) in zip(found, self._shapes, strict=True)]
