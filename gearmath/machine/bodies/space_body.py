"""The tooth space as a body to stay clear of: flanks, fillets, root and the lands beside it, as points with normals."""

from __future__ import annotations

import math

import numpy as np

from gearmath.bevel.tooth import SpaceFlank, ToothSpace, tooth_space
from gearmath.bevel.turning import turned
from gearmath.specs.bevel_set import Member

_COLUMNS = 33
#: Points across the root, and across each land.
_ACROSS = 7
_CHUNK = 300_000


class SpaceBody:
    """Space 0 of a member between its two neighbouring teeth, points (n,3) and outward normals (n,3).

    Distances are to the tangent plane of the nearest point, or to the point itself beyond the edge of the surface:
    good to some 5 µm on flanks of usual curvature, which is what a check for collisions needs.
    """

    def __init__(self, member: Member) -> None:
        space = tooth_space(member, _COLUMNS)
        low, high = space.ordered
        gamma_f, gamma_a = member.blank.delta_f, member.blank.delta_a
        parts = [_flank(low), _flank(high), _bridge(low.point[-1], high.point[-1], gamma_f)]
        parts.append(_bridge(turned(high.point[0], -space.pitch), low.point[0], gamma_a))
        parts.append(_bridge(high.point[0], turned(low.point[0], space.pitch), gamma_a))
        self.point = np.concatenate([point for point, _ in parts])
        self.normal = np.concatenate([normal for _, normal in parts])
        self.pitch = space.pitch
        self.teeth = member.teeth
        self._cone = member.blank.delta
        self._distance, self._middle = self._middle_line(space)
        self._spacing = 0.75 * float(np.linalg.norm(np.diff(low.point[0], axis=0), axis=1).max())

    def _middle_line(self, space: ToothSpace) -> tuple[np.ndarray, np.ndarray]:
        """Azimuth of the middle of the space over the cone distance, at half depth."""
        row = len(space.concave.section) // 3
        low = space.ordered[0].point[row]
        azimuth = np.unwrap(np.arctan2(low[:, 1], low[:, 0])) + space.width(row) / 2
        return self._cone_distance(low), azimuth

    def _cone_distance(self, point: np.ndarray) -> np.ndarray:
        radial = np.hypot(point[..., 0], point[..., 1])
        return point[..., 2] * math.cos(self._cone) + radial * math.sin(self._cone)

    def tooth_of(self, point: np.ndarray) -> int:
        """The number of the space in which a point (3,) of the work lies."""
        return int(self.spaces_of(point[None])[0])

    def spaces_of(self, point: np.ndarray) -> np.ndarray:
        """The numbers (n,) of the spaces in which points (n,3) of the work lie."""
        middle = np.interp(self._cone_distance(point), self._distance, self._middle)
        azimuth = np.arctan2(point[:, 1], point[:, 0])
        return np.round((azimuth - middle) / self.pitch).astype(int) % self.teeth

    def clearance(self, point: np.ndarray) -> np.ndarray:
        """Distance (m,) [mm] of points (m,3) near space 0 from its surface, negative in the metal."""
        result = np.empty(len(point))
        rows = max(1, _CHUNK // (3 * len(self.point)))
        squares, twice = (self.point**2).sum(axis=1), 2 * self.point.T
        for begin in range(0, len(point), rows):
            part = point[begin : begin + rows]
            product = part @ twice
            nearest = np.argmin(np.subtract(squares, product, out=product), axis=1)
            off = part - self.point[nearest]
            along = (off * self.normal[nearest]).sum(axis=1)
            distance = np.linalg.norm(off, axis=1)
            beside = np.sqrt(np.maximum(distance**2 - along**2, 0.0))
            result[begin : begin + rows] = np.where(beside < self._spacing, along, distance)
        return result


def _flank(surface: SpaceFlank) -> tuple[np.ndarray, np.ndarray]:
    return surface.point.reshape(-1, 3), surface.normal.reshape(-1, 3)


def _bridge(first: np.ndarray, last: np.ndarray, cone: float) -> tuple[np.ndarray, np.ndarray]:
    """Points between two lines (columns,3), with the normals of a cone."""
    share = np.linspace(0.0, 1.0, _ACROSS)[1:-1, None, None]
    point = ((1 - share) * first + share * last).reshape(-1, 3)
    radial = np.hypot(point[:, 0], point[:, 1])[:, None]
    normal = np.concatenate([math.cos(cone) * point[:, :2] / radial, np.full((len(point), 1), -math.sin(cone))], axis=1)
    return point, normal
