"""Where a search for the settings of given flanks starts: the crown gear that has their mean points.

Point, normal and curvature there are read from a smooth surface through the points; spiral angle, pressure angles,
thickness and the radius of the cutter follow from them, and the settings in closed form (14.2 to 14.5).
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Literal

import numpy as np

from gearmath.bevel.crown_gear import CrownTooth, Method, crown_gear_member
from gearmath.bevel.design.reverse_points import GivenFlank
from gearmath.bevel.generation import Generation
from gearmath.bevel.method import nominal_cut
from gearmath.bevel.turning import turned
from gearmath.errors import ComputationError, InputError
from gearmath.kernels import kernel
from gearmath.specs.bevel_set import FLANKS, SETTINGS, Blank, Member

#: Blade height over the whole depth at the heel: the contact climbs a blade further than the tooth is deep.
_BLADE_RESERVE = 1.8
#: Terms x^i y^j of the surface through the points: all up to the fourth degree; and the points that it needs.
_TERMS = [(i, k - i) for k in range(5) for i in range(k + 1)]
_LEAST_POINTS = 20
#: Steps to the place where that surface crosses the mean point.
_STEPS = 3
#: The curvature along the tooth gives the cutter's radius within these limits. [mm]
_RADIUS = 5.0, 500.0
#: Spiral angles below this one tell no hand. [rad]
_ZEROL = math.radians(2.0)
_OFFSET = SETTINGS.index("work_rotation_offset")


@dataclass(frozen=True)
class KnownMember:
    """What is known of a member besides its flanks: its blank, and how it is to be cut (mm, degrees).

    ``hand`` is None where the points have to tell it, ``cutter_radius``, the mean one of the cutter, where their
    curvature has to. ``edges`` are the edge radii of its blades by flank, which no point of a flank tells; ``unlike``
    is the key of a blade that is not straight, and of its value. ``thickness`` [mm] is the transverse arc of the tooth
    at the mean point, None where the file does not tell it.
    """

    teeth: int
    blank: Blank
    hand: Literal["left", "right"] | None = None
    cutting: Literal["fixed_setting", "completing"] = "fixed_setting"
    generation: Literal["generated", "formate"] = "generated"
    blade_groups: int | None = None
    cutter_radius: float | None = None
    edges: Mapping[str, float] = field(default_factory=dict)
    unlike: tuple[str, float] | None = None
    thickness: float | None = None


@dataclass(frozen=True)
class MeanPoint:
    """A flank at its mean point: point (3,) [mm], outward normal (3,), shape operator (2,2) [1/mm], angles (4,).

    The shape operator is that in two tangents, the first along the tooth, positive where the flank is hollow; the
    angles [rad] are those of (8.4).
    """

    point: np.ndarray
    normal: np.ndarray
    curvature: np.ndarray
    angles: np.ndarray

    def turned(self, angle: float) -> MeanPoint:
        """The mean point of a flank that is turned about z_w [rad]."""
        angles = self.angles.copy()
        angles[3] += angle
        point, normal = (turned(one[None], angle)[0] for one in (self.point, self.normal))
        return replace(self, point=point, normal=normal, angles=angles)


def smooth(x: np.ndarray, y: np.ndarray, values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The polynomial of the fourth degree in x, y (n,) nearest to values (n,): its coefficients, and what it leaves."""
    columns = np.stack([x**i * y**j for i, j in _TERMS], axis=1)
    found = np.linalg.lstsq(columns, values)[0]
    return found, values - columns @ found


def noise(given: GivenFlank, deviation: np.ndarray, otherwise: float) -> float:
    """The scatter [mm] of deviations (n,) from settings nearby about a smooth surface; NaN is no deviation.

    Where hardly more than that surface needs is left of the points, ``otherwise``.
    """
    there = np.isfinite(deviation)
    freedom = int(there.sum()) - len(_TERMS)
    if freedom < _LEAST_POINTS - len(_TERMS):
        return otherwise
    x, y = (2 * (one - one.min()) / np.ptp(one) - 1 for one in (given.along, given.up))
    _, left = smooth(x[there], y[there], deviation[there])
    return float(np.sqrt(left @ left / freedom))


def mean_point(given: GivenFlank, blank: Blank) -> MeanPoint:
    """Point, normal and curvature of a flank near the mean point of the blank, by a smooth surface.

    The surface is a polynomial of the fourth degree in the tangent plane. Raises InputError for too few points.
    """
    if len(given.point) < _LEAST_POINTS:
        raise InputError(f"{len(given.point)} points do not tell the flank, there must be at least {_LEAST_POINTS}")
    delta, axial = blank.delta, given.point[:, 2]
    radial = np.hypot(given.point[:, 0], given.point[:, 1])
    wanted = blank.mean_cone_distance * np.array([math.cos(delta), math.sin(delta)])
    nearest = int(np.argmin(np.hypot(axial - wanted[0], radial - wanted[1])))
    origin, normal = given.point[nearest], given.normal[nearest]
    for _ in range(_STEPS):
        along = np.array([*(origin[:2] / np.hypot(*origin[:2]) * math.sin(delta)), math.cos(delta)])
        first = along - normal * (normal @ along)
        first /= np.linalg.norm(first)
        basis = np.column_stack([first, np.cross(normal, first)])
        apart = given.point - origin
        size = float(np.abs(apart @ basis).max())
        x, y = (apart @ basis).T / size
        values, _ = smooth(x, y, apart @ normal)
        height = dict(zip(_TERMS, values.tolist(), strict=True))
        origin = origin + height[0, 0] * normal
        normal = normal - basis @ np.array([height[1, 0], height[0, 1]]) / size
        normal /= np.linalg.norm(normal)
    mixed = height[1, 1] / size**2
    shape = np.array([[2 * height[2, 0] / size**2, mixed], [mixed, 2 * height[0, 2] / size**2]])
    angles = np.array([float(one[0]) for one in kernel("flank_angles")(delta, origin[None], normal[None])])
    return MeanPoint(origin, normal, shape, angles)


def hand_of(known: KnownMember, means: dict[str, MeanPoint]) -> Literal["left", "right"]:
    """The hand that the flanks have. Raises InputError where another one is stated, or where they tell none."""
    spiral = float(np.mean([mean.angles[1] for mean in means.values()]))
    if abs(spiral) < _ZEROL:
        if known.hand is None:
            raise InputError(
                f"the spiral angle of {math.degrees(spiral):.3g} degrees tells no hand, so that it must be stated"
            )
        return known.hand
    told: Literal["left", "right"] = "right" if spiral > 0 else "left"
    if known.hand not in (None, told):
        raise InputError(f"hand = {known.hand!r}: the points are those of a {told} hand member")
    return told


def space_turn(means: dict[str, MeanPoint], teeth: int) -> float:
    """The angle [rad] from the concave flank across the space to the convex one, from 0 to one pitch.

    Raises InputError where the outward normals do not face each other.
    """
    across = [float(np.sign(means[flank].angles[2])) for flank in FLANKS]
    if across[0] == across[1]:
        raise InputError(
            "the outward normals of both flanks point the same way around the axis, so they bound no space"
        )
    return across[0] * (means["convex"].angles[3] - means["concave"].angles[3]) % (2 * math.pi / teeth)


def cutter_radius(known: KnownMember, given: dict[str, GivenFlank], means: dict[str, MeanPoint]) -> float:
    """The radius [mm] of the cutter with which the crown gear's flanks are curved along the tooth as the given ones.

    It starts from a cone that is curved like them, cos α over the curvature, and follows what its flanks lack.
    """
    low, high = _RADIUS
    wanted = [abs(means[flank].curvature[0, 0]) / math.cos(means[flank].angles[0]) for flank in FLANKS]
    radius = float(np.clip(1 / max(float(np.mean(wanted)), 1 / high), low, high))
    for _ in range(_STEPS):
        try:
            hows = placed(crown_gear_start(known, means, radius), means)
            cut = {flank: given[flank].cut_by(how) for flank, how in hows.items()}
            found = [mean_point(one, known.blank).curvature[0, 0] for one in cut.values()]
        except (InputError, ComputationError):
            return radius
        radius *= float(np.mean(np.abs(found)) / np.mean([abs(mean.curvature[0, 0]) for mean in means.values()]))
        radius = min(max(radius, low), high)
    return radius


def crown_gear_start(known: KnownMember, means: dict[str, MeanPoint], radius: float) -> Member:
    """The crown gear's member with the angles and the thickness of the flanks, cut by a cutter of a radius [mm].

    Raises InputError where such a cutter does not reach the flanks.
    """
    blank = known.blank
    spiral = float(np.mean([abs(mean.angles[1]) for mean in means.values()]))
    across = space_turn(means, known.teeth) * blank.mean_cone_distance * math.sin(blank.delta)
    depth = (blank.mean_addendum + blank.mean_dedendum) * (1 + blank.face_width / blank.mean_cone_distance / 2)
    tooth = CrownTooth(
        known.teeth,
        hand_of(known, means),
        blank,
        spiral,
        {flank: abs(float(mean.angles[0])) for flank, mean in means.items()},
        radius,
        across * math.cos(spiral),
        math.ceil(_BLADE_RESERVE * depth),
        known.blade_groups,
    )
    return crown_gear_member(tooth, Method(known.cutting, known.generation))


def placed(member: Member, means: dict[str, MeanPoint]) -> dict[str, Generation]:
    """How both flanks are cut, the work turned so that they pass the mean points; a completing cut turns both alike.

    Raises ComputationError where the settings do not cut a mean point.
    """
    hows, turns = {}, {}
    for flank in FLANKS:
        by, point = nominal_cut(member, flank), means[flank].point
        hows[flank] = by.how
        at = by.at(point[2:], np.array([math.hypot(point[0], point[1])]))
        if not at.converged.all():
            raise ComputationError(f"{flank} flank: the crown gear's settings do not cut the mean point")
        turns[flank] = math.atan2(point[1], point[0]) - math.atan2(at.point[0, 1], at.point[0, 0])
    if member.cutting == "completing":
        concave, convex = (turns[flank] for flank in FLANKS)
        turns = dict.fromkeys(FLANKS, concave + math.remainder(convex - concave, 2 * math.pi) / 2)
    return {flank: _turned(how, turns[flank]) for flank, how in hows.items()}


def _turned(how: Generation, turn: float) -> Generation:
    settings = how.settings.copy()
    settings[_OFFSET] = math.remainder(settings[_OFFSET] - turn, 2 * math.pi)
    return replace(how, settings=settings)
