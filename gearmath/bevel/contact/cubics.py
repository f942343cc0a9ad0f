"""Cubics between contacts that follow each other, of which rotation, x and dx/dφ_1 are known."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from gearmath.bevel.contact.system import TouchPoint


def nodes_of(touches: Sequence[TouchPoint]) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    return (
        np.array([touch.rotation for touch in touches]),
        np.stack([touch.x for touch in touches]),
        np.stack([touch.tangent for touch in touches]),
    )


def cubic(nodes: tuple[np.ndarray, np.ndarray, np.ndarray], rotations: np.ndarray) -> np.ndarray:
    """x (n,7) at rotations (n,) by Hermite's cubics between nodes in the order of their rotation; of one, its line."""
    at, x, slope = nodes
    if len(at) == 1:
        return x + (rotations - at)[:, None] * slope
    k = np.clip(np.searchsorted(at, rotations), 1, len(at) - 1)
    h = (at[k] - at[k - 1])[:, None]
    return _hermite((rotations - at[k - 1])[:, None] / h, h, (x[k - 1], slope[k - 1]), (x[k], slope[k]))


def cubic_of_two(one: TouchPoint, other: TouchPoint, rotation: float) -> np.ndarray:
    """x (7,) at a rotation by Hermite's cubic through two contacts, in either order."""
    h = other.rotation - one.rotation
    return _hermite((rotation - one.rotation) / h, h, (one.x, one.tangent), (other.x, other.tangent))


def _hermite(t: Any, h: Any, one: tuple[np.ndarray, np.ndarray], other: tuple[np.ndarray, np.ndarray]) -> np.ndarray:
    """The cubic at the part ``t`` of the way ``h`` from one value and slope to another."""
    rest = 1 - t
    found: np.ndarray = (
        (1 + 2 * t) * rest**2 * one[0] + t**2 * (3 - 2 * t) * other[0] + h * t * rest * (rest * one[1] - t * other[1])
    )
    return found
