"""The gear's flank as the pinion meets it at the constant ratio: places, curvatures and speeds."""

from __future__ import annotations

import math
from dataclasses import dataclass

import casadi as ca
import numpy as np

from gearmath.bevel.contact.surface import ContactSurface
from gearmath.bevel.turning import turned
from gearmath.kernels import kernel

_TRUE = np.zeros(4)


@dataclass(frozen=True)
class Meeting:
    """Where points of the gear (n,) meet the pinion: in the pinion's work frame, with the pinion's outward normal.

    ``rotation`` of the pinion [rad] from the first of ``at``; ``lever`` of the normal about the gear's axis [mm].
    """

    point: np.ndarray
    normal: np.ndarray
    rotation: np.ndarray
    lever: np.ndarray


@dataclass(frozen=True)
class Roll:
    """What is at the point where contact is wanted, in the pinion's frame at its rotation zero (chapter 26).

    ``point`` and ``normal`` (3,) of the pinion, outward; ``basis`` (3,2) of (26.7); ``gear_curvature`` (2,2) with the
    normal out of the gear; ``vector`` (2,), ``acceleration``, ``lever`` and ``sliding`` (2,) of (26.2). ``turn`` is the
    gear's rotation, ``axial`` (2,2) how cone distance and height on the gear change along the basis.
    """

    point: np.ndarray
    normal: np.ndarray
    basis: np.ndarray
    gear_curvature: np.ndarray
    vector: np.ndarray
    acceleration: float
    lever: float
    sliding: np.ndarray
    turn: float
    axial: np.ndarray


@dataclass(frozen=True, eq=False)
class GearFlank:
    """The gear's flank in a pair. ``shaft_angle`` [rad], ``offset`` [mm]; ``pinion_beyond`` t_z of the pinion [mm]."""

    surface: ContactSurface
    shaft_angle: float
    ratio: float
    pinion_pitch_angle: float
    pinion_mean: float
    pinion_beyond: float = 0.0
    offset: float = 0.0

    @property
    def _pair(self) -> tuple[float, float, np.ndarray]:
        return self.shaft_angle, self.offset, _TRUE

    @property
    def _apex(self) -> np.ndarray:
        return np.array([0.0, 0.0, self.pinion_beyond])

    def turns(self, point: np.ndarray, normal: np.ndarray) -> np.ndarray:
        """Rotations (n,) of the gear at which its points meet the pinion near the common pitch line, NaN for none."""
        beyond, delta = self.surface.apex_beyond, self.pinion_pitch_angle
        center = self.pinion_mean * np.array([math.sin(delta), 0.0, math.cos(delta)])
        found, away = [], []
        for side in (1, -1):
            (turn,) = kernel("meeting")(point, normal, beyond, *self._pair, self.ratio, side)
            placed, _ = kernel("gear_in_pair")(point, normal, turn, beyond, *self._pair)
            found.append(turn)
            away.append(np.nan_to_num(np.linalg.norm(placed - center, axis=1), nan=np.inf))
        return np.where(away[0] <= away[1], found[0], found[1])

    def meeting(self, axial: np.ndarray, radial: np.ndarray, zero: float) -> Meeting:
        """Where the gear's points at places (n,) [mm] meet the pinion; ``zero`` is the gear's rotation at φ_1 = 0."""
        own = self.surface.solve(axial, radial)
        turn = self.turns(own.point, own.normal)
        point, normal = kernel("gear_in_pair")(own.point, own.normal, turn, self.surface.apex_beyond, *self._pair)
        lever, _ = kernel("transmission")(point, normal, *self._pair)
        rotation = -(turn - zero) / self.ratio
        point = turned(point, -rotation) + self._apex
        return Meeting(point, -turned(normal, -rotation), rotation, lever)

    def roll(self, axial: float, radial: float) -> Roll:
        """What local synthesis needs at a place z_w, r_w [mm] of the gear's flank."""
        own = self.surface.solve(np.array([axial]), np.array([radial]))
        (turn,) = self.turns(own.point, own.normal)
        point, normal, basis, curvature, vector, beta, lever, sliding, on_blank = (
            np.asarray(one) for one in self._rolling(own.contact[0], turn)
        )
        at = point.ravel() + self._apex
        return Roll(
            at,
            -normal.ravel(),
            basis,
            curvature,
            vector.ravel(),
            float(beta[0, 0]),
            float(lever[0, 0]),
            sliding.ravel(),
            float(turn),
            on_blank,
        )

    @property
    def _rolling(self) -> ca.Function:
        """w, φ_2 -> point, outward normal of the gear, basis, K_2, w, β_c, lever, sliding in the frame of the pair; how
        cone distance and height on the gear change along the basis."""
        w, turn = ca.SX.sym("w", 3), ca.SX.sym("turn")
        own, own_normal, condition, _ = self.surface.function(w)
        root = self.surface.blank.delta_f
        basis = kernel("root_basis").function(own, own_normal, root)
        beyond = self.surface.apex_beyond
        place = kernel("gear_in_pair").function
        point, normal = place(own, own_normal, turn, beyond, *self._pair)
        T = ca.horzcat(*(place(own, basis[:, k], turn, beyond, *self._pair)[1] for k in range(2)))
        rates = ca.jacobian(point, w), ca.jacobian(normal, w), ca.jacobian(condition, w).T
        K = kernel("flank_curvature").function(*rates, T)
        vector, beta, sliding = kernel("roll_at_contact").function(point, normal, T, K, *self._pair)
        lever, _ = kernel("transmission").function(point, normal, *self._pair)
        moved = ca.inv(ca.vertcat(basis.T @ ca.jacobian(own, w), ca.jacobian(condition, w)))[:, :2]
        along, deep = kernel("root_place").function(own, self.surface.pitch_angle)
        axial = ca.jacobian(ca.vertcat(along, -deep), w) @ moved
        outputs = [point, normal, T, K, vector, beta, lever, sliding, axial]
        return ca.Function("rolling", [w, turn], ca.cse([ca.densify(one) for one in outputs]))
