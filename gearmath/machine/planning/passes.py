"""One pass of one tool, as positions and times: what is planned here is written there."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np


@dataclass(frozen=True)
class Pass:
    """One tool roll through one tooth space, or in face hobbing through all: plunge, cut along ``axes``, retract."""

    tool: str
    label: str
    tooth: int
    axes: np.ndarray
    """Positions X Y Z A B at the block ends, (n, 5) mm and rad, or with C (n, 6); A and C count on, not modulo."""
    seconds: np.ndarray
    """Duration of each block, (n-1,) s."""
    dwell: float = 0.0
    """Time that the cutter turns at the last position, s."""
    theta: np.ndarray = field(default_factory=lambda: np.zeros(0))
    """Cradle rotation at each position, (n,) rad; where it stands still the cutter plunges. Empty where not known."""
    bends: np.ndarray | None = None
    """Where blocks are polynomials: a_2, a_3 .. of X Y Z A B in each, by a parameter from 0 to 1, (n-1, 5, k)."""


def tooth_angles(teeth: int, correction: Sequence[float] = ()) -> np.ndarray:
    """Angle (z,) [rad] of each tooth space about z_w, from its number and never summed; ``correction`` in degrees."""
    return 2 * math.pi * np.arange(teeth) / teeth + np.radians(correction if len(correction) else np.zeros(teeth))
