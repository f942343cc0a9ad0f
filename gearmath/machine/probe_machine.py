"""A simulated probing machine: moves the tip of a probe against a member until it touches, and watches the stylus."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from gearmath.bevel.flank import Grid, nominal_points
from gearmath.bevel.kernels import kernel
from gearmath.bevel.turning import turned
from gearmath.machine.collision import work_profiles
from gearmath.machine.executor import MachinePath
from gearmath.machine.probe_space import SpaceBody
from gearmath.machine.probing import probe_height
from gearmath.machine.simulation import mounted
from gearmath.specs.bevel_set import FLANKS, Member
from gearmath.specs.calibration import Calibration
from gearmath.specs.milling_machine import MillingMachine
from gearmath.specs.simulated_machine import Fixture, Mounting

#: Steps in which the way of the tip is looked over before the touch is computed, and how near is near. [mm]
_STEP, _NEAR = 0.1, 0.15
#: What a tip may dig in anywhere but on a flank before it counts as a touch: the body is no better than this. [mm]
BODY_ERROR = 0.02
_ROUNDS, _CONVERGED = 60, 1e-10
#: Distance of the points at which the stylus is watched. [mm]
_STYLUS_STEP = 1.0
#: Steps along a block in which hub, shank and fixture are looked for. [mm]
_WORK_STEP = 2.0

#: Metal left on a flank of a tooth at a place (z_w, r_w) [mm].
Stock = Callable[[str, int, np.ndarray], float]


@dataclass(frozen=True)
class Clearances:
    """Least distances [mm] of a path: of the tip on its way, of the tip at its touches, of the stylus."""

    tip: float
    touching: float
    stylus: float


class ProbeMachine:
    """The machine with a member on its table and a probe in its spindle: what :func:`run_program` takes as a probe.

    ``stock`` is the metal that flank and tooth have too much, at least ``lowest``; its slope turns the normal of a
    flank, which is left out: at 2 um per mm it would move a touch by some nm. ``seat`` says how the member sits on the
    work axis. ``touches`` keeps the centres of the tip in the member.
    """

    def __init__(
        self, member: Member, name: str, machine: MillingMachine, calibration: Calibration,
        stock: Stock = lambda flank, tooth, place: 0.0, lowest: float = 0.0, seat: Mounting | None = None,
    ) -> None:  # fmt: skip
        self.member, self.calibration, self.stock = member, calibration, stock
        self._deepest = BODY_ERROR - min(lowest, 0.0)
        here, axes = mounted(np.zeros((3, 3)), np.eye(3), seat or Mounting())
        self._moved, self._tilted = here[0], axes
        self.body = SpaceBody(member, name)
        self.touches: list[np.ndarray] = []
        self._height, self._pivot = probe_height(machine, calibration), machine.pivot

    def __call__(self, start: np.ndarray, end: np.ndarray) -> np.ndarray | None:
        """Where the probe triggers between two positions X Y Z A B (5,), A and B standing still; None if nowhere."""
        (first, last), _ = self._tip(np.stack([start, end]))
        # the member's axes are the rows of _tilted, in the frame that turns with A
        first, last = (self._tilted @ (point - self._moved) for point in (first, last))
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

    def clearances(self, path: MachinePath) -> Clearances:
        """How near tip and stylus come to the member on a path; every block is looked over in steps."""
        tips, stems, touching = [], [], []
        for k in range(1, len(path.axes)):
            count = 2 + int(np.linalg.norm(path.axes[k, :3] - path.axes[k - 1, :3]) / (4 * _STEP))
            share = np.linspace(0.0, 1.0, count)[:, None]
            tip, stylus = self._tip(path.axes[k - 1] + share * (path.axes[k] - path.axes[k - 1]))
            turn = -self.body.tooth_of(tip[-1]) * self.body.pitch
            tip, stylus = turned(tip, turn), turned(stylus, turn)
            away = self.body.clearance(tip) - self.calibration.tip_radius
            touches = bool(path.measuring[k]) or bool(path.measuring[k - 1])
            touching.append(away[[0, -1]].min() if touches else math.inf)
            tips.append(away[1:-1].min() if touches and count > 2 else away.min() if not touches else math.inf)
            heights = np.arange(_STYLUS_STEP, self.calibration.stylus_length, _STYLUS_STEP)
            stem = (tip[::4, None] + heights[:, None] * stylus[::4, None]).reshape(-1, 3)
            stems.append(self.body.clearance(stem).min() - self.calibration.stylus_radius)
        return Clearances(float(min(tips)), float(min(touching)), float(min(stems)))

    def work_clearance(self, path: MachinePath, fixture: Fixture, spindle_radius: float) -> float:
        """How near [mm] tip, stylus and spindle nose come to hub, shank and fixture, which are round about the work.

        The spindle is a cylinder of ``spindle_radius`` from the gauge line up, the stylus one down to the tip.
        """
        profiles = work_profiles(self.member, fixture)
        corners = [profiles[name] for name in ("hub", "shank", "fixture")]
        first, last = (np.concatenate([part[ends] for part in corners]) for ends in (slice(0, -1), slice(1, None)))
        heights = np.arange(0.0, self.calibration.stylus_length, _STYLUS_STEP)
        nearest = math.inf
        for k in range(1, len(path.axes)):
            count = 2 + int(np.linalg.norm(path.axes[k, :3] - path.axes[k - 1, :3]) / _WORK_STEP)
            share = np.linspace(0.0, 1.0, count)[:, None]
            tip, stylus = self._tip(path.axes[k - 1] + share * (path.axes[k] - path.axes[k - 1]))
            nose = tip + self.calibration.length * stylus
            stem = (tip[:, None] + heights[:, None] * stylus[:, None]).reshape(-1, 3)
            for body, radius in ((tip, self.calibration.tip_radius), (stem, self.calibration.stylus_radius),
                                 (nose, spindle_radius)):  # fmt: skip
                place = np.column_stack([body[:, 2], np.hypot(body[:, 0], body[:, 1])])
                nearest = min(nearest, float(to_segments(place, first, last).min()) - radius)
        return nearest


def to_segments(place: np.ndarray, first: np.ndarray, last: np.ndarray) -> np.ndarray:
    """Distances (n,m) of points (n,2) from straight lines between ends (m,2)."""
    way = last - first
    length = np.maximum((way**2).sum(axis=1), 1e-12)
    share = np.clip(((place[:, None] - first) * way).sum(axis=2) / length, 0.0, 1.0)
    return np.linalg.norm(place[:, None] - first - share[..., None] * way, axis=2)
