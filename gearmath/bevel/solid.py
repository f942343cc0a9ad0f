"""A whole member as a closed surface of triangles: all teeth, the end faces, and the inside of the rim.

Every column of the tooth space (a line of constant cone distance, turned about z_w) becomes a closed polygon around the
member; polygons are joined along the face, and at toe and heel down to a rim inside the root.
"""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np

from gearmath.bevel.tooth import ToothSpace
from gearmath.bevel.turning import half_turn, turned
from gearmath.files import write_bytes
from gearmath.specs.bevel_set import Member

_ROOT_POINTS = 3
_TIP_POINTS = 5
#: Thickness of the rim below the root at its deepest, in whole depths at the heel.
_RIM = 1.0


def space_triangles(space: ToothSpace) -> np.ndarray:
    """The surface of one tooth space, open at its ends: triangles (n,3,3) seen from inside the space."""
    profile = _space_profile(space)
    return _skin(profile, closed=False)


def member_triangles(member: Member, space: ToothSpace) -> np.ndarray:
    """A whole member: closed, every triangle (n,3,3) counter-clockwise seen from outside."""
    ring = _ring(space, member.teeth)
    inner = rim(member, ring)
    surface = _skin(ring, closed=True)
    toe, heel = (_skin(np.stack([inner[k], ring[k]]), closed=True) for k in (0, -1))
    inside = _skin(inner, closed=True)  # column by column: the teeth wind around the axis, and so do the polygons
    return np.concatenate([surface, toe, heel[:, ::-1], inside[:, ::-1]])


def volume(triangles: np.ndarray) -> float:
    """Volume [mm³] that closed outward triangles (n,3,3) enclose, by the divergence theorem."""
    a, b, c = triangles.transpose(1, 0, 2)
    return float(np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6)


def write_stl(path: Path, triangles: np.ndarray, title: str) -> None:
    """Binary STL of triangles (n,3,3) [mm], written in one step."""
    edges = triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]
    normal = np.cross(*edges)
    length = np.linalg.norm(normal, axis=1, keepdims=True)
    record = np.zeros(len(triangles), dtype=[("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
    record["normal"] = np.divide(normal, length, out=np.zeros_like(normal), where=length > 0)
    record["corners"] = triangles
    # a header that begins with "solid" would be read as a text file
    header = f"gearmath {title}".encode("ascii", "replace")[:80].ljust(80)
    write_bytes(path, header + np.uint32(len(triangles)).tobytes() + record.tobytes())


def _space_profile(space: ToothSpace) -> np.ndarray:
    """Points (columns, n, 3) across space 0, in the order of their angle: down one flank, up the other."""
    low, high = (surface.point.transpose(1, 0, 2) for surface in space.ordered)
    fractions = np.linspace(0, 1, _ROOT_POINTS + 2)[1:-1]
    root = between(low[:, -1], high[:, -1], fractions)
    return np.concatenate([low, root, high[:, ::-1]], axis=1)


def _ring(space: ToothSpace, teeth: int) -> np.ndarray:
    """Closed polygons (columns, n, 3) around the member, in the order of their angle."""
    profile = _space_profile(space)
    following = turned(profile[:, 0], space.pitch)
    land = between(profile[:, -1], following, np.linspace(0, 1, _TIP_POINTS + 2)[1:-1])
    tooth = np.concatenate([profile, land], axis=1)
    return np.concatenate([turned(tooth, k * space.pitch) for k in range(teeth)], axis=1)


def between(first: np.ndarray, last: np.ndarray, fractions: np.ndarray) -> np.ndarray:
    """Points (columns, n, 3) between two (columns, 3), by angle, radius and height about z_w."""
    a, b = (_cylindrical(points) for points in (first, last))
    turn = half_turn(b[:, 0] - a[:, 0])
    angle = a[:, 0, None] + turn[:, None] * fractions
    radius, z = (a[:, k, None] + (b[:, k] - a[:, k])[:, None] * fractions for k in (1, 2))
    return np.stack([radius * np.cos(angle), radius * np.sin(angle), z], axis=2)


def rim(member: Member, ring: np.ndarray) -> np.ndarray:
    """Points like those of ``ring`` (..., 3), at their angles, on the cone inside the root that bounds the solid."""
    blank, delta = member.blank, member.blank.delta
    lowest = -blank.mean_dedendum - _RIM * (blank.mean_addendum + blank.mean_dedendum)
    angle, radius, z = np.moveaxis(_cylindrical(ring), -1, 0)
    height = radius * math.cos(delta) - z * math.sin(delta)
    z_rim, r_rim = z + (height - lowest) * math.sin(delta), radius - (height - lowest) * math.cos(delta)
    return np.stack([r_rim * np.cos(angle), r_rim * np.sin(angle), z_rim], axis=-1)


def _skin(rows: np.ndarray, closed: bool) -> np.ndarray:
    """Triangles between consecutive rows (m, n, 3) of points; ``closed`` joins the last point of a row to the first."""
    if closed:
        rows = np.concatenate([rows, rows[:, :1]], axis=1)
    a, b, c, d = rows[:-1, :-1], rows[:-1, 1:], rows[1:, 1:], rows[1:, :-1]
    return np.concatenate([np.stack([a, b, c], axis=2), np.stack([a, c, d], axis=2)], axis=1).reshape(-1, 3, 3)


def _cylindrical(points: np.ndarray) -> np.ndarray:
    """Angle, radius and z of points (..., 3)."""
    return np.stack(
        [np.arctan2(points[..., 1], points[..., 0]), np.hypot(points[..., 0], points[..., 1]), points[..., 2]], axis=-1
    )
