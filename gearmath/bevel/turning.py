"""Points and directions of a member turned about its axis: from one tooth to another."""

from __future__ import annotations

import math
from typing import TypeVar

import numpy as np

Angle = TypeVar("Angle", float, np.ndarray)


def turned(vector: np.ndarray, angle: float | np.ndarray) -> np.ndarray:
    """Vectors (...,3) in frame w turned about z_w by one angle, or each by its own (...,) [rad]."""
    c, s = np.cos(angle), np.sin(angle)
    x, y, z = np.moveaxis(vector, -1, 0)
    return np.stack([c * x - s * y, s * x + c * y, z], axis=-1)


def half_turn(angle: Angle) -> Angle:
    """Angles [rad] within half a turn: -π to below π."""
    return (angle + math.pi) % (2 * math.pi) - math.pi
