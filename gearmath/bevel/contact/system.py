"""The equations of contact of one pair of flanks as CasADi functions, and their solution by Newton's method.

Unknown x = ((u, β, θ) of the pinion, (u, β, θ) of the gear, φ_2), rotations counted from the position in which both
mean points of the pitch cones stand on the pitch line. What touches what is told by the *active* borders: none, the
flanks; one, the edge there and the mate's flank; two, a corner, or two edges that cross.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import casadi as ca
import numpy as np

from gearmath.bevel.contact.surface import BORDERS, ContactSurface, edges_of, on_fillet
from gearmath.bevel.turning import half_turn
from gearmath.engine.points import Points
from gearmath.errors import ComputationError
from gearmath.kernels import kernel

#: Residual [mm] of a contact that counts, and Newton steps to get there.
TOLERANCE = 1e-11
_STEPS = 8
#: Largest change in one step: of u [mm], β, θ, φ_2 [rad].
_LIMITS = np.array([3.0, 0.2, 0.2, 3.0, 0.2, 0.2, 0.2])
_SIDES = 2
#: Borders of both members: the pinion's, then the gear's.
COUNT = _SIDES * len(BORDERS)


@dataclass(frozen=True)
class Assembly:
    """V, H, J [mm] and the growth of the shaft angle [rad], with the signs of chapter 25."""

    V: float = 0.0
    H: float = 0.0
    J: float = 0.0
    shaft: float = 0.0

    @property
    def vector(self) -> np.ndarray:
        return np.array([self.V, self.H, self.J, self.shaft])


@dataclass(frozen=True)
class TouchPoint:
    """A contact: rotation of the pinion [rad], x (7,), active borders, dx/dφ_1 (7,), and what keeps it valid.

    ``distance`` (8,) [mm] from all borders, ``pressure`` of the active ones: positive where the edge is pressed on.
    ``orientation`` is the sign of the determinant of the equations.
    """

    rotation: float
    x: np.ndarray
    active: tuple[int, ...]
    tangent: np.ndarray
    distance: np.ndarray
    pressure: np.ndarray
    orientation: float

    @property
    def margins(self) -> np.ndarray:
        """(8,): distance from the other borders, pressure at the active ones; valid where none is negative."""
        values = self.distance.copy()
        values[list(edges_of(self.active))] = self.pressure
        return values


@dataclass(frozen=True, eq=False)
class System:
    """A pair of flanks in its frame. ``shaft_angle`` [rad], ``offset`` [mm]."""

    pinion: ContactSurface
    gear: ContactSurface
    shaft_angle: float
    offset: float = 0.0
    #: Rotations at which the mean points stand on the pitch line, counted from the frames of the work.
    phase: tuple[float, float] = field(default=(0.0, 0.0))

    @property
    def ratio(self) -> float:
        return self.pinion.teeth / self.gear.teeth

    @property
    def pitch(self) -> float:
        """Rotation of the pinion from tooth to tooth [rad]."""
        return 2 * math.pi / self.pinion.teeth

    def placed(self, side: int, point: ca.SX, vector: ca.SX, turn: ca.SX, assembly: ca.SX) -> Any:
        """A point of a flank and a direction at it, turned into the frame of the pair (25.1, 25.2)."""
        beyond = (self.pinion, self.gear)[side].apex_beyond
        if side == 0:
            return kernel("pinion_in_pair").function(point, vector, turn + self.phase[0], beyond, assembly)
        return kernel("gear_in_pair").function(
            point, vector, turn + self.phase[1], beyond, self.shaft_angle, self.offset, assembly
        )

    @cached_property
    def equations(self) -> Points:
        """x, φ_1, assembly -> every condition (23,) and its derivatives by x and φ_1 (23,8), flank on flank.

        In this order: common point (3), f of both (2), alignment (2), tangency of the edges (8), their distance (8).
        """
        return self._equations((False, False))

    def conditions(self, active: tuple[int, ...]) -> Points | None:
        """The same at active borders, on a fillet where a root is among them; None without such a fillet."""
        zones = on_fillet(active)
        if not any(zones):
            return self.equations
        if zones not in self._below:
            surfaces = (self.pinion, self.gear)
            lacks = any(below and one.fillet is None for one, below in zip(surfaces, zones, strict=True))
            self._below[zones] = None if lacks else self._equations(zones)
        return self._below[zones]

    @cached_property
    def _below(self) -> dict[tuple[bool, ...], Points | None]:
        return {}

    def _equations(self, zones: tuple[bool, ...]) -> Points:
        x, rotation, assembly = ca.SX.sym("x", 7), ca.SX.sym("rotation"), ca.SX.sym("assembly", 4)
        points, normals, conditions, distances, edges = [], [], [], [], []
        for side, surface in enumerate((self.pinion, self.gear)):
            w, turn = x[3 * side : 3 * side + 3], (rotation, x[6])[side]
            function, limits = surface.part(zones[side])
            point, normal, condition, *_ = function(w)
            conditions.append(condition)
            for border in surface.borders:
                _, edge = kernel("flank_border").function(w[0], point, normal, ca.DM(border))
                edges.append((side, self.placed(side, point, edge, turn, assembly)[1]))
            distances.append(limits(w))
            point, normal = self.placed(side, point, normal, turn, assembly)
            points.append(point)
            normals.append(normal)
        touching = [kernel("tangency").function(edge, normals[1 - side]) for side, edge in edges]
        aligned = kernel("alignment").function(points[1], normals[1], normals[0])
        every = ca.vertcat(points[0] - points[1], *conditions, aligned, *touching, *distances)
        outputs = ca.cse([every, ca.densify(ca.jacobian(every, ca.vertcat(x, rotation)))])
        return Points(ca.Function("contact", [x, rotation, assembly], outputs), shared=(2,))

    def solve(
        self, x: np.ndarray, rotation: float, active: tuple[int, ...], assembly: np.ndarray, steps: int = _STEPS
    ) -> TouchPoint | None:
        """The contact near ``x`` at a rotation of the pinion, None where Newton's method does not get there."""
        rows, equations = _rows(active), self.conditions(active)
        if equations is None:
            return None
        for _ in range(steps):
            every, by_all = equations.at(x, rotation, assembly)
            r, J = every[rows, 0], by_all[rows]
            if not np.isfinite(J).all():
                return None
            try:
                inverse = np.linalg.inv(J[:, :7])
            except np.linalg.LinAlgError:
                return None
            if np.abs(r).max() < TOLERANCE:
                return self._touch(x, rotation, active, J, inverse, every[_BORDERS, 0])
            step = -(inverse @ r)
            x = x + step / max(1.0, float((np.abs(step) / _LIMITS).max()))
        return None

    def event(
        self, x: np.ndarray, rotation: float, active: tuple[int, ...], border: int, assembly: np.ndarray
    ) -> tuple[np.ndarray, float] | None:
        """The contact at ``active`` borders that comes to one more border: x (7,) and the rotation of the pinion."""
        rows, y = [*_rows(active), 7 + COUNT + border], np.append(x, rotation)
        equations = self.conditions(active)
        if equations is None:
            return None
        for _ in range(_STEPS):
            every, by_all = equations.at(y[:7], y[7], assembly)
            r, J = every[rows, 0], by_all[rows]
            if not np.isfinite(J).all():
                return None
            if np.abs(r).max() < TOLERANCE:
                return y[:7], float(y[7])
            try:
                step = np.linalg.solve(J, -r)
            except np.linalg.LinAlgError:
                return None
            y = y + step / max(1.0, float((np.abs(step[:7]) / _LIMITS).max()))
        return None

    def _touch(
        self,
        x: np.ndarray,
        rotation: float,
        active: tuple[int, ...],
        J: np.ndarray,
        inverse: np.ndarray,
        distance: np.ndarray,
    ) -> TouchPoint:
        # within the borders φ_2 is largest: its derivatives by the last conditions, the distances of the active ones
        pressure = -self.sense * inverse[6, 7 - len(edges_of(active)) :]
        tangent = -(inverse @ J[:, 7])
        return TouchPoint(rotation, x, active, tangent, distance, pressure, float(np.linalg.slogdet(inverse)[0]))

    def solve_many(
        self, x: np.ndarray, rotation: np.ndarray, active: tuple[int, ...], assembly: np.ndarray
    ) -> np.ndarray:
        """Contacts (n,7) near ``x`` (n,7) at rotations (n,) in one go, NaN where Newton's method does not get there."""
        rows, n, found = _rows(active), len(x), x.copy()
        equations = self.conditions(active)
        if equations is None:
            return np.full_like(x, np.nan)
        done = np.zeros(n, dtype=bool)
        for _ in range(_STEPS):
            r, J = equations(found, rotation[:, None], assembly)
            r, J = r[:, rows, 0], J[:, rows, :7]
            done = np.abs(r).max(axis=1) < TOLERANCE
            good = np.isfinite(J).all(axis=(1, 2)) & (np.abs(np.linalg.det(np.nan_to_num(J))) > 0)
            if (done | ~good).all():
                break
            step = np.zeros_like(found)
            step[good] = np.linalg.solve(J[good], -r[good][..., None])[..., 0]
            found += step / np.maximum(1.0, (np.abs(step) / _LIMITS).max(axis=1))[:, None]
        found[~done] = np.nan
        return found

    @cached_property
    def sense(self) -> float:
        """+1 where the pinion pushes the gear to larger φ_2: contact is the largest of sense · φ_2."""
        flank = self.gear.at(self.gear.blank.mean_cone_distance)
        point, normal = kernel("gear_in_pair")(
            flank.point[0],
            flank.normal[0],
            self.phase[1],
            self.gear.apex_beyond,
            self.shaft_angle,
            self.offset,
            np.zeros(4),
        )
        lever, _ = kernel("transmission")(point, normal, self.shaft_angle, self.offset, np.zeros(4))
        return -math.copysign(1.0, float(lever))

    def transmission_error(self, touch: TouchPoint) -> float:
        """φ_2 + i φ_1 [rad] of a contact, not yet less its value at rotation zero."""
        return float(touch.x[6] + self.ratio * touch.rotation)

    @cached_property
    def _gear_place(self) -> Points:
        """x -> cone distance and depth on the gear, and their derivatives."""
        x = ca.SX.sym("x", 7)
        point, *_ = self.gear.function(x[3:6])
        place = ca.vertcat(*kernel("root_place").function(point, self.gear.pitch_angle))
        return Points(ca.Function("gear_place", [x], ca.cse([place, ca.densify(ca.jacobian(place, x))])))

    def gear_place(self, x: np.ndarray) -> tuple[float, float]:
        """Cone distance and height above the pitch cone of the gear [mm], of a contact ``x`` (7,)."""
        (distance, depth), _ = self._gear_place.at(x)
        return float(distance[0]), -float(depth[0])

    def gear_places(self, x: np.ndarray) -> np.ndarray:
        """Cone distances and heights (n,2) on the gear [mm] of contacts ``x`` (n,7)."""
        return self._gear_place(x)[0][:, :, 0] * [1.0, -1.0]

    def place_rates(self, x: np.ndarray) -> np.ndarray:
        """How both change with ``x`` (2,7)."""
        along, deep = self._gear_place.at(x)[1]
        return np.stack([along, -deep])


def pair_system(pinion: ContactSurface, gear: ContactSurface, shaft_angle: float, offset: float = 0.0) -> System:
    """The pair of two flanks, with rotation zero where both mean points stand on the pitch line.

    Raises ComputationError where a flank has no point there.
    """
    phase = []
    for name, surface, azimuth in (("pinion", pinion, 0.0), ("gear", gear, math.pi)):
        point = surface.at(surface.blank.mean_cone_distance).point[0]
        if not np.isfinite(point).all():
            raise ComputationError(f"{name}: its flank has no point at the mean point of the pitch cone")
        phase.append(half_turn(azimuth - math.atan2(point[1], point[0])))
    return System(pinion, gear, shaft_angle, offset, (phase[0], phase[1]))


_BORDERS = slice(7 + COUNT, 7 + 2 * COUNT)


def _rows(active: tuple[int, ...]) -> list[int]:
    """Which conditions hold: common point and f, with the alignment, an edge with its tangency, or two borders."""
    edges = edges_of(active)
    on_them = [7 + COUNT + border for border in edges]
    return [*range(5), *{0: [5, 6], 1: [7 + border for border in edges] + on_them, 2: on_them}[len(edges)]]
