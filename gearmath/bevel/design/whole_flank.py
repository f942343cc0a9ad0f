"""The pinion's whole flank by least squares, its point, normal and curvature at the mean point held (27.5).

What is left free moves the flank beyond the second order only: the square system gives the other settings to each
choice, so that a fit cannot trade what was asked for at the mean point against the rest of the flank.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from gearmath.bevel.design import local_settings as local
from gearmath.bevel.design.local_settings import MOVING, NAMES, Local, Wanted
from gearmath.bevel.design.rolling import Meeting
from gearmath.bevel.generation import Generation
from gearmath.bevel.newton import FlankPoints
from gearmath.quality.flank_target import FlankTarget, locate
from gearmath.quality.least_squares import minimize
from gearmath.quality.variables import NAMES as WHOLE
from gearmath.specs.bevel_set import SETTINGS

#: Places of NAMES in the whole vector (83,) of a flank.
_INDEX = [WHOLE.index(name) for name in (*SETTINGS, *(f"{name}.{power}" for name, power in MOVING.values()))]


@dataclass(frozen=True)
class Fitted:
    """The settings found, the ease-off less what was wanted at the gear's grid (n,) [mm], and the bounds reached."""

    local: Local
    off: np.ndarray
    active: tuple[str, ...]

    @property
    def rms(self) -> float:
        return float(np.sqrt(np.mean(self.off**2)))


@dataclass
class WholeFlank:
    """The problem of one flank: conjugate places (n,) of the gear's grid, and the gap (n,) [mm] wanted there."""

    how: Generation
    wanted: Wanted
    meeting: Meeting
    gap: np.ndarray
    free: Sequence[str]
    extra: tuple[str, ...]
    bounds: np.ndarray
    contact: np.ndarray = field(default_factory=lambda: np.zeros((0, 3)))

    def at(self, start: Local, values: np.ndarray) -> tuple[Local, np.ndarray, np.ndarray] | None:
        """Settings with the extra ones at ``values``, what is off (n,) and its derivatives by them (n,p)."""
        x = start.x.copy()
        where = [NAMES.index(name) for name in self.extra]
        x[where] = values
        found = local.solve(self.how, x, self.wanted, self.free)
        if found is None:
            return None
        how = local.generation(self.how, found)
        points = FlankPoints(self.contact, self.meeting.point, self.meeting.normal)
        target = FlankTarget(how, points, np.zeros(len(self.gap)))
        crossing = locate(target, target.vector, moving=True)
        if crossing.failed.any():
            return None
        index = [NAMES.index(name) for name in self.free]
        moved = np.zeros((len(NAMES), len(self.extra)))
        moved[where] = np.eye(len(where))
        if where:
            moved[index] = -np.linalg.solve(found.rates[:, index], found.rates[:, where])
        self.contact = crossing.contact
        return found, -crossing.deviation - self.gap, -crossing.gradient[:, _INDEX] @ moved[local.FIRST :]


def fit(problem: WholeFlank, start: Local) -> Fitted | None:
    """The extra settings within their bounds (p,2) that bring the ease-off nearest to what is wanted."""
    where = [NAMES.index(name) for name in problem.extra]
    begin = start.x[where]
    state = {"at": start}
    low, high = problem.bounds[:, 0] - begin, problem.bounds[:, 1] - begin
    scale = np.maximum(np.abs(low), np.abs(high))

    def residuals(v: np.ndarray) -> tuple[np.ndarray, np.ndarray] | None:
        found = problem.at(state["at"], begin + v * scale)
        if found is None:
            return None
        return found[1], found[2] * scale

    first = problem.at(start, begin)
    if first is None:
        return None
    if not where:
        return Fitted(first[0], first[1], ())
    minimum = minimize(residuals, low / scale, high / scale)
    found = problem.at(start, begin + minimum.variables * scale)
    if found is None:
        return None
    active = tuple(
        name for name, v, a, b in zip(problem.extra, minimum.variables, low / scale, high / scale, strict=True)
        if min(v - a, b - v) < 1e-6
    )  # fmt: skip
    return Fitted(found[0], found[1], active)
