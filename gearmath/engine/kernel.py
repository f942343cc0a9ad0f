"""A :class:`casadi.Function` with the meaning of its arguments."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca
import numpy as np

from derivations.quantity import Quantity
from gearmath.engine.run import runner
from gearmath.errors import CallError, InputError
from gearmath.shown import Shown, Shows


@dataclass(frozen=True, repr=False)
class Kernel(Shown):
    """A :class:`casadi.Function` with the meaning of its arguments: what ``export`` ships and others compose.

    Inputs and outputs of ``function`` have the names and shapes of ``inputs`` and ``outputs``, in this order.
    """

    function: ca.Function
    description: str
    inputs: tuple[Quantity, ...]
    outputs: tuple[Quantity, ...]
    source: str = ""
    requires: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        if not isinstance(self.function, ca.Function):
            raise InputError(
                f"function = {self.function!r}: must be a CasADi function; kernel(name) and lower make kernels"
            )
        for key in ("inputs", "outputs"):
            if not all(isinstance(one, Quantity) for one in getattr(self, key) or ()):
                raise InputError(f"{self.name}: {key}: must be a tuple of Quantity")
        for kind, quantities, names in (
            ("input", self.inputs, self.function.name_in()),
            ("output", self.outputs, self.function.name_out()),
        ):
            if [quantity.name for quantity in quantities] != names:
                raise InputError(
                    f"{self.name}: {kind}s {names} of the function do not carry the names of its quantities"
                )

    def __hash__(self) -> int:
        """By its name: kernels are looked up wherever they are run, and hardly two of them share it."""
        return hash(self.name)

    @property
    def name(self) -> str:
        return self.function.name()

    def __call__(self, *arguments: np.typing.ArrayLike) -> tuple[np.ndarray, ...]:
        """Evaluate at one or many points, in one mapped call.

        Each argument has the shape of its quantity, or that shape with one axis of n points in front; what has no
        such axis is the same for all points. Outputs have the axis in front if any argument has it. Arguments may be
        left out at the end where their quantities have a default.
        """
        try:
            arrays = [_numbers(argument) for argument in arguments]
        except (TypeError, ValueError, OverflowError) as error:
            names = ", ".join(quantity.name for quantity in self.inputs)
            raise InputError(f"{self.name}: {error}; its arguments are arrays of numbers: {names}") from None
        left_out = self.inputs[len(arrays) :]
        if all(quantity.default is not None for quantity in left_out):
            arrays += [np.full(quantity.shape, quantity.default, dtype=float) for quantity in left_out]
        if len(arrays) != len(self.inputs):
            names = ", ".join(quantity.name for quantity in self.inputs)
            raise CallError(f"{self.name}: the arguments are {names}; {len(arrays)} given")
        many = [array.ndim > len(quantity.shape) for array, quantity in zip(arrays, self.inputs, strict=True)]
        is_batch = any(many)
        n = max((len(array) for array, is_many in zip(arrays, many, strict=True) if is_many), default=1)
        flats = []
        for array, is_many, quantity in zip(arrays, many, self.inputs, strict=True):
            if array.shape != (*((n,) if is_many else ()), *quantity.shape):
                raise InputError(f"{self.name}: {quantity.name} has shape {array.shape}, expected {quantity.shape}")
            flats.append(_by_columns(array, n if is_many else 1, quantity))
        if not any(many):
            many[:] = [True] * len(many)
        results = runner(self.function, tuple(many))(flats, n) if n else [np.empty((0, q.size)) for q in self.outputs]
        outputs = []
        for result, quantity in zip(results, self.outputs, strict=True):
            rows = _by_rows(result, quantity)
            outputs.append(rows if is_batch else rows[0])
        return tuple(outputs)

    def expand(self) -> Kernel:
        """The same kernel as one flat graph of scalar operations."""
        return Kernel(self.function.expand(), self.description, self.inputs, self.outputs, self.source, self.requires)

    def _shown(self) -> tuple[str, list[Shows]]:
        given, made = (", ".join(map(_with_unit, some)) for some in (self.inputs, self.outputs))
        return self.name, [("of", given, ""), ("gives", made, ""), ("meaning", self.description, "")]


def _with_unit(quantity: Quantity) -> str:
    """A quantity by its name, and its unit where it has one of its own: elements of a vector may have several."""
    return quantity.name if quantity.unit in ("1", "mixed") else f"{quantity.name} [{quantity.unit}]"


def _numbers(argument: np.typing.ArrayLike) -> np.ndarray:
    """An argument as an array of doubles. Raises TypeError or ValueError where it holds what is no number."""
    array = np.asarray(argument)
    kind = array.dtype.kind
    if kind in "UScMm" or (kind == "O" and any(one is None for one in array.flat)):
        raise TypeError(f"{argument!r} is no number")  # NumPy would read text, make NaN of None, and take the real part
    return np.asarray(array, dtype=float)


def _by_columns(array: np.ndarray, n: int, quantity: Quantity) -> np.ndarray:
    """Elements (n, size) of a quantity at n points as CasADi has them, column by column."""
    if len(quantity.shape) == 2:
        array = array.reshape(n, *quantity.shape).transpose(0, 2, 1)
    return np.ascontiguousarray(array).reshape(n, quantity.size)


def _by_rows(array: np.ndarray, quantity: Quantity) -> np.ndarray:
    if len(quantity.shape) == 2:
        height, width = quantity.shape
        return np.ascontiguousarray(array.reshape(-1, width, height).transpose(0, 2, 1))
    return array.reshape(-1, *quantity.shape)
