"""Blocks of POLY as the control drives them: polynomials of a parameter, followed at a constant speed of the path.

    x(u) = a_0 + c_1 u + a_2 (u PL)^2 + a_3 (u PL)^3 + ..,   0 <= u <= 1

a_0 is the last end point; the first coefficient is not written: the control finds it from the end point. Axes without a
polynomial move linearly. What is done with the path, milling, judging, timing, is done with straight parts of it, so
short that they leave it by no more than ``CHORD``.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np

#: How far the straight parts of a block may be from its polynomials, degrees at 100 mm from their axis. [mm]
CHORD = 5e-6
_FROM_AXIS = math.radians(1.0) * 100.0
#: No block is followed in more parts.
_MOST = 5000
#: Coefficients from a_2 on that a block may have for an axis: in PO[X]=(..), and in X=PO(..).
CUBIC, QUINTIC = 2, 4
#: The parameter at the end of a block.
INTERVAL = (0.0001, 99999.9999)


def polynomials(
    before: Sequence[float], after: Sequence[float], coefficients: Mapping[int, Sequence[float]], interval: float
) -> np.ndarray:
    """Coefficients (k,6) of the powers 0 to 5 of u for k axes in mm and degrees, from both ends and what is written.

    ``coefficients`` are a_2 and so on by the number of the axis, and ``interval`` is PL.
    """
    first, last = np.array(before), np.array(after)
    powers = np.zeros((len(first), 6))
    powers[:, 0] = first
    for axis, written in coefficients.items():
        powers[axis, 2 : 2 + len(written)] = np.array(written) * interval ** np.arange(2, 2 + len(written))
    powers[:, 1] = last - first - powers[:, 2:].sum(axis=1)
    return powers


def followed(powers: np.ndarray, weights: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Positions (n,k) at the ends of the straight parts of a block, and their lengths (n,) as F counts them.

    ``weights`` (k,) make a length of the path out of the ways of the axes: 0 for those that F does not count.
    """
    bend = np.array([0.0, 0.0, 2.0, 6.0, 12.0, 20.0]) * powers
    at = np.linspace(0.0, 1.0, 21)[:, None] ** np.arange(4)
    scale = np.where(np.arange(len(powers)) < 3, 1.0, _FROM_AXIS)
    sharpest = float(np.linalg.norm((at @ bend[:, 2:].T) * scale, axis=1).max())
    parts = min(max(2, math.ceil(math.sqrt(sharpest / (8.0 * CHORD)))), _MOST)
    u = np.linspace(0.0, 1.0, parts + 1)
    where = u[:, None] ** np.arange(6) @ powers.T
    length = np.linalg.norm(np.diff(where, axis=0) * weights, axis=1)
    return where[1:], length if length.any() else np.full(parts, 1e-9)
