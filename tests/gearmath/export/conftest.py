"""Seeded samples of the domain of a kernel's Expression, and the comparison bit for bit."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest
import sympy as sp

import derivations
from derivations.expression import Quantity
from gearmath.export.cnc import cnc_kernels


@pytest.fixture(scope="session")
def samples() -> Callable[..., tuple[np.ndarray, ...]]:
    """``samples(name, n)``: n seeded points of the domain of the Expression called ``name``."""
    return _samples


@pytest.fixture(scope="session")
def same_bits() -> Callable[[np.ndarray, np.ndarray], bool]:
    """Whether two arrays of doubles are the same bit for bit, any NaN counting as the same."""
    return _same_bits


def _samples(name: str, n: int, seed: int = 1) -> tuple[np.ndarray, ...]:
    """One array (n, *shape) for each input, within domains, values and the ``requires`` of an Expression."""
    (source,) = [e for e in derivations.expressions() if e.name == name] or [k for k in cnc_kernels() if k.name == name]
    generator = np.random.default_rng(seed)
    symbols = [symbol for quantity in source.inputs for symbol in quantity.symbols]
    tests = [sp.lambdify(symbols, sp.sympify(requirement), "numpy") for requirement in source.requires]
    kept = np.empty((0, len(symbols)))
    while len(kept) < n:
        elements = [element for quantity in source.inputs for element in quantity.elements]
        drawn = np.column_stack([_draw(element, n, generator) for element in elements])
        fits = np.ones(n, dtype=bool)
        for test in tests:
            fits &= test(*drawn.T) > 0
        kept = np.vstack([kept, drawn[fits]])
    splits = np.cumsum([quantity.size for quantity in source.inputs])[:-1]
    columns = np.split(kept[:n], splits, axis=1)
    return tuple(column.reshape(n, *q.shape) for column, q in zip(columns, source.inputs, strict=True))


def _draw(element: Quantity, n: int, generator: np.random.Generator) -> np.ndarray:
    if element.values:
        return generator.choice(np.array(element.values, dtype=float), n)
    low, high = element.domain
    assert math.isfinite(low), f"{element.name} has no domain to sample"
    assert math.isfinite(high), f"{element.name} has no domain to sample"
    return generator.uniform(low, high, n)


def _same_bits(first: np.ndarray, second: np.ndarray) -> bool:
    both_nan = np.isnan(first) & np.isnan(second)
    return first.shape == second.shape and bool(((first.view(np.uint64) == second.view(np.uint64)) | both_nan).all())
