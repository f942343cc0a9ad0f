"""One pass of one tool, as positions and times: what is planned here is written there."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from gearmath.specs.ratio import RADIAN

#: Straight parts that stand for a polynomial where its ends do not tell enough.
_PARTS = 64


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
    """Where blocks are polynomials: a_2, a_3 .. of each axis, by a parameter from 0 to 1, (n-1, 5 or 6, k)."""

    @property
    def values_of_a_block(self) -> int:
        """End points, and coefficients where blocks are polynomials, that one block has."""
        return self.axes.shape[1] * (1 if self.bends is None else self.bends.shape[2] + 1)

    def in_straight_parts(self) -> Pass:
        """The same with every polynomial as many straight blocks; itself where it has none.

        A polynomial is followed at a constant speed of the path, a degree counted as a mm.
        """
        if self.bends is None:
            return self
        u = np.linspace(0.0, 1.0, _PARTS + 1)
        higher = u[:, None] ** np.arange(2, 2 + self.bends.shape[2])
        ends = np.diff(self.axes, axis=0) - self.bends.sum(axis=2)
        where = self.axes[:-1, None] + u[:, None] * ends[:, None] + np.einsum("uk,nak->nua", higher, self.bends)
        weights = np.where(np.arange(where.shape[2]) < 3, 1.0, RADIAN)
        steps = np.linalg.norm(np.diff(where, axis=1) * weights, axis=2)
        seconds = steps / steps.sum(axis=1, keepdims=True) * self.seconds[:, None]
        theta = self.theta[:-1, None] + u[1:] * np.diff(self.theta)[:, None]
        return replace(
            self,
            axes=np.vstack([self.axes[:1], where[:, 1:].reshape(-1, self.axes.shape[1])]),
            seconds=seconds.ravel(),
            theta=np.append(self.theta[:1], theta.ravel()),
            bends=None,
        )


def tooth_angles(teeth: int, correction: Sequence[float] | np.ndarray = ()) -> np.ndarray:
    """Angle (z,) [rad] of each tooth space about z_w, from its number and never summed; ``correction`` (z,) or none."""
    return 2 * math.pi * np.arange(teeth) / teeth + (correction if len(correction) else np.zeros(teeth))
