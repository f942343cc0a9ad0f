"""The pinion's whole flank by least squares, its point, normal and curvature at the mean point held (27.5).

What is left free moves the flank beyond the second order only: the square system gives the other settings to each
choice, so that a fit cannot trade what was asked for at the mean point against the rest of the flank.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from gearmath.bevel.design import local_settings as local
from gearmath.bevel.design.designed_flank import FlankFit
from gearmath.bevel.design.local_settings import MOVING, NAMES, LocalSystem, WantedPoint
from gearmath.bevel.design.rolling import Meeting
from gearmath.bevel.generation import Generation
from gearmath.bevel.identify.flank_target import FlankTarget, locate
from gearmath.bevel.identify.least_squares import minimize
from gearmath.bevel.identify.variables import NAMES as WHOLE
from gearmath.bevel.newton import FlankPoints
from gearmath.specs.bevel_set import SETTINGS

#: Places of NAMES in the whole vector (83,) of a flank.
_INDEX = [WHOLE.index(name) for name in (*SETTINGS, *(f"{name}.{power}" for name, power in MOVING.values()))]

#: Room to a bound, in parts of it, that counts as none.
_AT_BOUND = 1e-6


@dataclass(frozen=True)
class Fitted(FlankFit):
    """How well the flank fits at the gear's grid, and the settings found."""

    local: LocalSystem


@dataclass(frozen=True)
class Tried:
    """A choice of the extra settings: the others that belong to it, where its flank crosses, and what is off there.

    ``contact`` (n,3); ``off`` (n,) [mm] and its derivatives (n,p) by the extra settings.
    """

    values: np.ndarray
    local: LocalSystem
    contact: np.ndarray
    off: np.ndarray
    rates: np.ndarray


@dataclass(frozen=True)
class WholeFlank:
    """The problem of one flank: conjugate places (n,) of the gear's grid, and the gap (n,) [mm] wanted there.

    ``free`` settings follow from the mean point for each choice of the ``extra`` ones within ``bounds`` (p,2).
    """

    how: Generation
    wanted: WantedPoint
    meeting: Meeting
    gap: np.ndarray
    free: Sequence[str]
    extra: tuple[str, ...]
    bounds: np.ndarray

    def tried(self, near: LocalSystem, contact: np.ndarray, values: np.ndarray) -> Tried | None:
        """The extra settings at ``values``, from a solution nearby; None where there is none, or a place is not cut."""
        x = near.x.copy()
        where = [NAMES.index(name) for name in self.extra]
        x[where] = values
        found = local.solve(self.how, x, self.wanted, self.free)
        if found is None:
            return None
        points = FlankPoints(contact, self.meeting.point, self.meeting.normal)
        target = FlankTarget(local.generation(self.how, found), points, np.zeros(len(self.gap)))
        crossing = locate(target, target.vector, moving=True)
        if crossing.failed.any():
            return None
        index = [NAMES.index(name) for name in self.free]
        moved = np.zeros((len(NAMES), len(self.extra)))
        moved[where] = np.eye(len(where))
        if where:
            moved[index] = -np.linalg.solve(found.rates[:, index], found.rates[:, where])
        rates = -crossing.gradient[:, _INDEX] @ moved[local.FIRST : -1]
        return Tried(values, found, crossing.contact, -crossing.deviation - self.gap, rates)


def fit(problem: WholeFlank, start: LocalSystem, contact: np.ndarray) -> Fitted | None:
    """The extra settings within their bounds that bring the ease-off nearest to what is wanted, by least squares.

    ``contact`` (n,3) is where the flank of ``start`` is cut. None where a place of the gear is not cut there.
    """
    begin = np.clip(start.x[[NAMES.index(name) for name in problem.extra]], *problem.bounds.T)
    first = problem.tried(start, contact, begin)
    if first is None:
        return None
    if not problem.extra:
        return Fitted(first.off, (), first.local)
    low, high = problem.bounds[:, 0] - begin, problem.bounds[:, 1] - begin
    scale, known = np.maximum(np.abs(low), np.abs(high)), [first]

    def residuals(v: np.ndarray) -> tuple[np.ndarray, np.ndarray] | None:
        values = begin + v * scale
        near = min(known, key=lambda one: float(np.linalg.norm((one.values - values) / scale)))
        found = problem.tried(near.local, near.contact, values)
        if found is None:
            return None
        known.append(found)
        return found.off, found.rates * scale

    v = minimize(residuals, low / scale, high / scale).variables
    best = min(known, key=lambda one: float(np.linalg.norm((one.values - begin) / scale - v)))
    room = np.minimum(v - low / scale, high / scale - v)
    active = tuple(name for name, left in zip(problem.extra, room, strict=True) if left < _AT_BOUND)
    return Fitted(best.off, active, best.local)
