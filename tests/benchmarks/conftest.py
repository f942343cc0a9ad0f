"""What benchmarks share: a kernel run by CasADi's virtual machine, which is where the engine would not leave it."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from gearmath.engine.kernel import Kernel
from gearmath.engine.run import KernelRunner


@pytest.fixture(scope="session")
def timed(request: pytest.FixtureRequest) -> bool:
    """Whether the run asks for times; else the benchmarks only have to work, with little of everything."""
    return not (request.config.getoption("benchmark_disable") or hasattr(request.config, "workerinput"))


@pytest.fixture(scope="session")
def by_vm() -> Callable[[Kernel], Callable[..., list[np.ndarray]]]:
    """Kernel to a function of arrays, one point a row; what has no such axis is the same for all points."""

    def interpreted(kernel: Kernel) -> Callable[..., list[np.ndarray]]:
        def run(*arguments: np.typing.ArrayLike) -> list[np.ndarray]:
            arrays = [np.asarray(argument, dtype=float) for argument in arguments]
            many = tuple(a.ndim > len(q.shape) for a, q in zip(arrays, kernel.inputs, strict=True))
            n = max(len(array) for array, is_many in zip(arrays, many, strict=True) if is_many)
            flats = [
                np.ascontiguousarray(a.swapaxes(-1, -2) if len(q.shape) == 2 else a).reshape(
                    n if is_many else 1, q.size
                )
                for a, q, is_many in zip(arrays, kernel.inputs, many, strict=True)
            ]
            found = KernelRunner(kernel.function, many).interpreted(flats, n)
            return [a if q.shape else a.reshape(n) for a, q in zip(found, kernel.outputs, strict=True)]

        return run

    return interpreted
