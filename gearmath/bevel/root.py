"""The root of a space: where the corners of the blades leave it, and how wide it is at toe, mean point and heel.

Widths are square to the root and between sharp corners, where a blade point width is measured. A slot width, that of
AGMA 929, is the point width of a cutter that would leave such a root with both its blades: a generated root is narrower
than the cutter, as the cutter rolls on the pitch cone, which is farther from the axis.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache

import numpy as np

from gearmath.bevel.generation import Generation, Section, SurfacePoints, solve_curve
from gearmath.kernels import kernel
from gearmath.remembered import remembered
from gearmath.specs.bevel_set import SIDES, Blank, Flank, Member

#: The tip plane of the cutter as a blade: nearly square to its axis, so that it shows where the root is deepest.
FLAT_BLADE = math.radians(89.9)
#: Radius of a round that stands for a corner [mm].
CORNER = 1e-3
#: Places of a trace over the face width; a slot ends askew, so that it is as wide as its end shows only beyond it.
ACROSS = np.linspace(-0.25, 1.25, 13)
#: Those of them at the ends and in the middle of the face width, and what they are called.
ENDS = (2, 6, 10)
PLACES = ("toe", "mean point", "heel")
_FINE = 241
#: Cutters tried for a slot: what the root takes of the width changes little with it.
_TRIALS = 2


@dataclass(frozen=True)
class Widths:
    """Widths [mm] at toe, mean point and heel, and the least and most of all places of the face width."""

    toe: float
    mean: float
    heel: float
    least: float
    most: float

    @staticmethod
    def of(width: np.ndarray) -> Widths:
        """Of widths at places that are spread evenly over the face width, both ends among them."""
        toe, mean, heel, least, most = width[0], width[len(width) // 2], width[-1], width.min(), width.max()
        return Widths(float(toe), float(mean), float(heel), float(least), float(most))

    @property
    def narrow_place(self) -> str:
        """Where of the three it is narrowest."""
        return PLACES[int(np.argmin((self.toe, self.mean, self.heel)))]

    @property
    def wide_place(self) -> str:
        """Where of the three it is widest."""
        return PLACES[int(np.argmax((self.toe, self.mean, self.heel)))]


def mean_place(member: Member) -> tuple[np.ndarray, np.ndarray]:
    """Where the mean point of the pitch cone lies: (z_w,), (r_w,)."""
    blank = member.blank
    working = blank.mean_addendum + blank.mean_dedendum - blank.clearance
    up = (blank.mean_dedendum - blank.clearance) / working
    axial, radial = kernel("flank_place")(blank.vector, np.array([0.5]), np.array([up]))
    return axial, radial


def root_trace(member: Member, flank: str, how: Generation, start: np.ndarray, narrower: float = 0.0) -> SurfacePoints:
    """Points (13,) that the corner of the blade leaves, at the places ``ACROSS``; those not found have not converged.

    ``start`` (1,3) is the contact at the mean point. With ``narrower`` [mm], a point so far along the tip from there.
    """
    blank = member.blank
    distance, _ = _heights(blank)
    section, u = tip_plane(member.flank(flank), SIDES[flank], narrower)
    ends = np.full(len(ACROSS), u)
    begin = np.column_stack([ends, np.repeat(start[:, 1:], len(ACROSS), axis=0)])
    return solve_curve(how, section, ends, _along(blank), distance, begin)


def tip_plane(spec: Flank, side: int, narrower: float = 0.0) -> tuple[Section, float]:
    """The tip plane of a blade as a section that is square to the cutter's axis, and its u where the corner is; with
    ``narrower`` [mm] so far from it.

    Where the blade's plane is radial, or is left at its point radius, a straight one; else the lowest point of a
    vanishing round, as the blade's plane is turned about the point radius (17.2) and that must stay.
    """
    nominal = spec.nominal
    radial = not (narrower and spec.blade_offset_angle)
    if spec.blade_tip_height == 0 and radial:
        return Section(0.0, 1.0, nominal.blade_point_radius - side * narrower, FLAT_BLADE), 0.0
    radius = tip_radius(spec, side) - side * narrower
    point = (radius, spec.blade_tip_height + CORNER, CORNER)
    return Section(0.0, math.pi / 2, nominal.blade_point_radius, nominal.alpha, point), math.pi / 2


def tip_radius(spec: Flank, side: int) -> float:
    """Radius of a blade at its tip [mm]."""
    nominal = spec.nominal
    (radius,) = kernel("blade_tip")(nominal.blade_point_radius, nominal.alpha, spec.blade_tip_height, side)
    return float(radius)


def above_root(member: Member, point: np.ndarray) -> np.ndarray:
    """Heights (13,) [mm] of the points of a trace over the root of the blank."""
    _, root = _heights(member.blank)
    along, up = _along(member.blank)
    return np.stack([point[:, 2], np.hypot(point[:, 0], point[:, 1])], axis=1) @ (-up, along) - root


def root_widths(member: Member, concave: np.ndarray, convex: np.ndarray) -> Widths:
    """Widths of the root between two traces (13,3), NaN where a point of them is not there."""
    return Widths.of(_across(member.blank, concave, convex))


def slot_widths(
    member: Member, flank: str, how: Generation, start: np.ndarray, own: np.ndarray, other: np.ndarray
) -> Widths:
    """Point widths of a cutter that at the settings of a flank with the trace ``own`` would leave the trace ``other``.

    Where both corners of a cutter are cut at the same settings, that is its point width. Traces (13,3) as above.
    """
    real = _across(member.blank, own, other)
    width = real
    for _ in range(_TRIALS):
        tried = float(width[len(width) // 2])
        found = root_trace(_with_point_radius(member, flank, tried), flank, how, start)
        left = _across(member.blank, own, np.where(found.converged[:, None], found.point, np.nan))
        width = tried * real / left
    return Widths.of(width)


def _with_point_radius(member: Member, flank: str, width: float) -> Member:
    """The member with the other corner of a cutter of a point width [mm] in the place of a flank's own: it turns about
    a point radius of its own (17.2)."""
    nominal = member.flank(flank).nominal
    settings = {
        "blade_point_radius": nominal.blade_point_radius - SIDES[flank] * width,
        "blade_pressure_angle": nominal.blade_pressure_angle,
    }
    return member.model_copy(update={flank: member.flank(flank).model_copy(update={"design": None, **settings})})


def cone_distances(blank: Blank) -> tuple[tuple[float, float], np.ndarray]:
    """Direction of the pitch cone in the axial plane, and the cone distances (13,) [mm] of the places ``ACROSS``."""
    return _along(blank), _heights(blank)[0]


def root_height(blank: Blank) -> np.ndarray:
    """Heights (13,) [mm] of the root of the blank over the pitch cone, at the places ``ACROSS``."""
    return _heights(blank)[1]


def _across(blank: Blank, one: np.ndarray, other: np.ndarray) -> np.ndarray:
    """Widths (25,) between two traces (13,3), toe to heel: from points of one to the nearest of the other, counted at
    the cone distance of the middle between both."""
    along = np.array(_along(blank))
    one, other = _fine(one), _fine(other)
    start, step = other[:-1], np.diff(other, axis=0)
    # of the segments the nearest is one beside the nearest point
    point = (np.einsum("kj,kj->k", other, other) - 2 * one @ other.T).argmin(axis=1)
    beside = np.clip(np.stack([point - 1, point], axis=1), 0, len(step) - 1)
    share = np.einsum("ikj,ikj->ik", one[:, None] - start[beside], step[beside])
    share /= np.einsum("kj,kj->k", step, step)[beside]
    foot = start[beside] + np.clip(share, 0.0, 1.0)[..., None] * step[beside]
    apart = np.linalg.norm(one[:, None] - foot, axis=2)
    row, chosen = np.arange(len(one)), apart.argmin(axis=1)
    nearest, share, foot, apart = (part[row, chosen] for part in (beside, share, foot, apart))
    inside = ~(((share < 0) & (nearest == 0)) | ((share > 1) & (nearest == len(step) - 1)))
    middle = (one + foot)[inside] / 2
    place = np.stack([middle[:, 2], np.hypot(middle[:, 0], middle[:, 1])], axis=1) @ along
    order = np.argsort(place)
    distance, _ = _heights(blank)
    wanted = np.linspace(distance[ENDS[0]], distance[ENDS[-1]], 25)
    return np.interp(wanted, place[order], apart[inside][order])


def _along(blank: Blank) -> tuple[float, float]:
    """Direction of the pitch cone in the axial plane."""
    delta = blank.delta
    return math.cos(delta), math.sin(delta)


@remembered(64)
def _heights(blank: Blank) -> tuple[np.ndarray, np.ndarray]:
    """Cone distances (13,) of the places of a trace, and how high the root of the blank lies there [mm]."""
    along, up = _along(blank)
    lower = np.stack(kernel("flank_place")(blank.vector, ACROSS, np.zeros(len(ACROSS))), axis=1)
    return lower @ (along, up), lower @ (-up, along) - blank.clearance


def _fine(trace: np.ndarray) -> np.ndarray:
    """Many points of a trace between those that are there, by the polynomial through them."""
    found = np.isfinite(trace).all(axis=1)
    return _interpolation(found.tobytes()) @ trace[found]


@cache  # a trace nearly always has all its points
def _interpolation(found: bytes) -> np.ndarray:
    """Matrix (241,n) of the polynomial through the n points of a trace that are there, at many points between them."""
    at = ACROSS[np.frombuffer(found, bool)] - 0.5
    degree = min(len(at) - 1, 8)
    return np.vander(np.linspace(at[0], at[-1], _FINE), degree + 1) @ np.polyfit(at, np.eye(len(at)), degree)
