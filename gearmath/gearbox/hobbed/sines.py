"""Errors that are sums of sines (30.17)."""

from __future__ import annotations

import math
from collections.abc import Iterable

import numpy as np

from gearmath.gearbox.kernels import kernel
from gearmath.specs.cutting_errors import LengthHarmonic, RatioHarmonic, TableHarmonic

ARCSEC = math.pi / 648_000
UM = 1e-3
PERCENT = 1e-2


def harmonics(
    series: Iterable[TableHarmonic | LengthHarmonic | RatioHarmonic], turn: np.ndarray, unit: float
) -> np.ndarray:
    """The sum of sines (30.17) at turns [rad], amplitudes in ``unit``."""
    total = np.zeros(turn.size)
    for each in series:
        (amplitude,) = (value for key, value in each if key.startswith("amplitude"))
        total += kernel("harmonic")(turn.ravel(), amplitude * unit, each.order, each.rad("phase"))[0]
    return total.reshape(turn.shape)
