"""Fits that single wrong values do not pull: Tukey's weights, from least absolute values and from many samples."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

#: A value is off where it lies farther from the fit than this many standard deviations of the others.
SIGMAS = 6.0
#: Standard deviation of normal noise over the median of its size.
_MAD = 1.4826
_STEPS, _TUKEY, _SMALL = 30, 4.685, 1e-6
#: Samples from which the fit is started.
_STARTS = 20


def off_the_fit(columns: np.ndarray, values: np.ndarray, least: float) -> np.ndarray:
    """How far values (n,) deviate from what their columns (n,p) make of most of them.

    Of the fits that several starts lead to, the one with the least of Tukey's loss, all at one scale: the median of
    the distances from the fit of least absolute values, or what ``least`` is ``SIGMAS`` of.
    """
    n, p = columns.shape
    fit = _Fit(columns, values, (columns[:, :, None] * columns[:, None, :]).reshape(n, p * p))
    absolute = np.zeros((1, n))
    for _ in range(_STEPS):
        absolute = fit.off(1 / np.maximum(np.abs(absolute), _SMALL))
    scale = max(_MAD * float(np.median(np.abs(absolute))), least / SIGMAS)
    rng = np.random.default_rng(0)  # the same starts in every run
    samples = rng.permuted(np.tile(np.arange(n), (_STARTS, 1)), axis=1) < 2 * p
    off = np.vstack([absolute, fit.off(samples.astype(float))])
    for _ in range(_STEPS):
        size = np.maximum(scale, _MAD * np.median(np.abs(off), axis=1, keepdims=True))
        off = fit.off(_tukey(off / size))
    loss = np.sum(1 - _tukey(off / scale) ** 1.5, axis=1)
    return off[np.argmin(loss)]


@dataclass(frozen=True)
class _Fit:
    """Columns (n,p), values (n,), and the products (n,p²) of the columns of each value: they are half of the work."""

    columns: np.ndarray
    values: np.ndarray
    products: np.ndarray

    def off(self, weight: np.ndarray) -> np.ndarray:
        """Distances (s,n) of the values from the weighted fits of s weights (s,n)."""
        p = self.columns.shape[1]
        normal = (weight @ self.products).reshape(len(weight), p, p)
        ridge = 1e-12 * np.trace(normal, axis1=1, axis2=2)[:, None, None] * np.eye(p)
        right = (weight * self.values) @ self.columns
        return self.values - np.linalg.solve(normal + ridge, right[..., None])[..., 0] @ self.columns.T


def _tukey(ratio: np.ndarray) -> np.ndarray:
    """Tukey's weights of distances in standard deviations."""
    return np.clip(1 - (ratio / _TUKEY) ** 2, 0, None) ** 2


def limit_of(off: np.ndarray, least: float) -> float:
    """How far off a value must be, told by the median of the distances (n,) of all, and at least ``least``."""
    return max(least, SIGMAS * _MAD * float(np.median(np.abs(off))))
