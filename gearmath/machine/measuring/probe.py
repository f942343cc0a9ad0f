"""A simulated probing machine: moves the tip of a probe against a member until it touches.

What the probe comes near on its way is :mod:`gearmath.machine.measuring.collision_check`'s.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from gearmath.bevel.flank import Grid, nominal_points
from gearmath.bevel.turning import turned
from gearmath.kernels import kernel
from gearmath.machine.bodies.probe_tip import probe_height
from gearmath.machine.bodies.space_body import SpaceBody
from gearmath.machine.milling.axis_errors import mounted
from gearmath.specs.bevel_set import FLANKS, Member
from gearmath.specs.calibration import Calibration
from gearmath.specs.milling_machine import MillingMachine
from gearmath.specs.simulated_machine import Mounting

#: Steps in which the way of the tip is looked over before the touch is computed, and how near is near. [mm]
_STEP, _NEAR = 0.1, 0.15
#: What a tip may dig in anywhere but on a flank before it counts as a touch: the body is no better than this. [mm]
BODY_ERROR = 0.02
_ROUNDS, _CONVERGED = 60, 1e-10
#: A and B stand still within this [rad]; where they turn, the way is looked over in steps of mm and rad.
_STILL, _TURNING_STEP, _TURN = 1e-9, 0.5, math.radians(0.5)

#: Metal left on a flank of a tooth at a place (z_w, r_w) [mm].
Stock = Callable[[str, int, np.ndarray], float]


class ProbeMachine:
    """The machine with a member on its table and a probe in its spindle: what :func:`run_program` takes as a probe.

    ``stock`` is the metal that flank and tooth have too much, at least ``lowest``; its slope turns the normal of a
    flank, which is left out: at 2 um per mm it would move a touch by some nm. ``seat`` is its clamping on the
    work axis. ``touches`` keeps the centres of the tip in the member.
    """

    def __init__(
        self,
        member: Member,
        machine: MillingMachine,
        calibration: Calibration,
        stock: Stock = lambda flank, tooth, place: 0.0,
        lowest: float = 0.0,
        seat: Mounting | None = None,
    ) -> None:
        self.member, self.calibration, self.stock = member, calibration, stock
        self._deepest = BODY_ERROR - min(lowest, 0.0)
        here, axes = mounted(np.zeros((3, 3)), np.eye(3), seat or Mounting())
        self._moved, self._tilted = here[0], axes
        self.body = SpaceBody(member)
        self.touches: list[np.ndarray] = []
        self._height, self._pivot = probe_height(machine, calibration), machine.pivot

    def __call__(self, start: np.ndarray, end: np.ndarray) -> np.ndarray | None:
        """Where the probe triggers between two positions X Y Z A B (5,); None if nowhere."""
        if np.abs(end - start)[3:].max() > _STILL:
            return self._met(start, end)
        first, last = self._in_member(np.stack([start, end]))
        tooth = self.body.tooth_of(last)
        first, last = (turned(point, -tooth * self.body.pitch) for point in (first, last))
        share = np.linspace(0.0, 1.0, 2 + int(np.linalg.norm(last - first) / _STEP))
        away = self.body.clearance(first + share[:, None] * (last - first)) - self.calibration.tip_radius
        near = np.flatnonzero(away < _NEAR)
        if not len(near):
            return None
        found = [self._share(flank, tooth, first, last, share[near[0]]) for flank in FLANKS]
        dug = np.flatnonzero(away < -self._deepest)
        touched = min((*(part for part in found if part is not None), *share[dug[:1]]), default=None)
        if touched is None:
            return None
        self.touches.append(turned(first + touched * (last - first), tooth * self.body.pitch))
        return start + touched * (end - start)

    def _met(self, start: np.ndarray, end: np.ndarray) -> np.ndarray | None:
        """Where the tip meets the body on a way on which A or B turns, to a step of that way."""
        way = end - start
        steps = 2 + int(max(np.linalg.norm(way[:3]) / _TURNING_STEP, np.abs(way[3:]).max() / _TURN))
        poses = start + np.linspace(0.0, 1.0, steps)[:, None] * way
        tips = self._in_member(poses)
        tips = turned(tips, -self.body.spaces_of(tips) * self.body.pitch)
        met = np.flatnonzero(self.body.clearance(tips) - self.calibration.tip_radius < -self._deepest)
        return poses[met[0]] if len(met) else None

    def _in_member(self, axes: np.ndarray) -> np.ndarray:
        """Centre of the tip (n,3) in the member: its axes are the rows of _tilted, in the frame that turns with A."""
        tip, _ = self._tip(axes)
        return (tip - self._moved) @ self._tilted.T

    def _tip(self, axes: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Centre of the tip and direction of the stylus (n,3) in the work."""
        tip, stylus = kernel("probe_tip")(axes, self._height, self.calibration.tip_offset, self._pivot)
        return tip, stylus

    def _share(self, flank: str, tooth: int, first: np.ndarray, last: np.ndarray, share: float) -> float | None:
        """Part of the way at which the tip touches a flank of space 0; None if it does not on this way.

        The line meets the plane that lies one tip radius above the tangent plane; the place below gives the next one.
        """
        way = last - first
        foot = first + share * way
        for _ in range(_ROUNDS):
            place = np.array([foot[2], np.hypot(foot[0], foot[1])])
            radius = self.calibration.tip_radius + self.stock(flank, tooth, place)
            points, residual = nominal_points(self.member, flank, Grid(place[None, :1], place[None, 1:]))
            point, normal = points.point[0], points.normal[0]
            approach = float(way @ normal)
            if not (residual[0] < _CONVERGED * 100 and approach < 0.0):
                return None
            before, share = share, float((point - first) @ normal + radius) / approach
            foot = first + share * way - radius * normal
            if abs(share - before) * -approach < _CONVERGED and np.linalg.norm(foot - point) < 1e-7:
                return share if 0.0 <= share <= 1.0 else None
        return None
