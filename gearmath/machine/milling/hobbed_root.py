"""The root that the tips of single blades leave: those of outer and inner blades, each over its half of the space."""

from __future__ import annotations

import numpy as np

from gearmath.bevel.generation import solve_curve
from gearmath.bevel.method import nominal_cut
from gearmath.bevel.ridge import ridge_of_tips
from gearmath.bevel.root import cone_distances, mean_place, root_height, tip_plane, tip_radius
from gearmath.bevel.tip_room import corner_wall, tip_lengths
from gearmath.bevel.turning import half_turn
from gearmath.machine.bodies.blades import blades_of
from gearmath.specs.bevel_set import FLANKS, SIDES, Member

#: Places along a tip; steps along a normal, each of which leaves some hundredths.
_ALONG, _STEPS = 9, 3
#: A place of the root is beside the end of a tip within this part of its length.
_STEP = 0.08


def root_of_tips(member: Member, point: np.ndarray, normal: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Points (n,3) of a root in space 0 moved along their normals to where the deeper of both tips leaves it, and which
    (n,) of them are no step of it.

    The root has a step where a tip ends, up the wall that the corner of the tip sweeps. Points that no tip passes stay,
    and are a ridge where these walls meet.
    """
    along = np.array(cone_distances(member.blank)[0])
    for _ in range(_STEPS):
        radius = np.hypot(point[:, 0], point[:, 1])
        outwards = np.einsum("nk,nk->n", normal[:, :2], point[:, :2]) / radius
        rising = np.stack([normal[:, 2], outwards], axis=1) @ (-along[1], along[0])
        place = np.stack([point[:, 2], radius], axis=1)
        distance, azimuth = place @ along, np.arctan2(point[:, 1], point[:, 0])
        level = place @ (-along[1], along[0])
        (one, steep), (other, steep_too) = (_left_by(member, flank, distance, azimuth, level) for flank in FLANKS)
        height = np.fmin(one, other)
        missing = (height - level) / rising
        point = point + np.where(np.isfinite(missing), missing, 0.0)[:, None] * normal
    on_ridge = np.isnan(height) & np.isfinite(ridge_of_tips(member))
    return point, ~(steep | steep_too | on_ridge)


def _left_by(
    member: Member, flank: str, distance: np.ndarray, azimuth: np.ndarray, level: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Heights (n,) [mm] above the pitch cone that the tip of one kind of blade leaves at cone distances and azimuths
    (n,), NaN beside it; and which points (n,) at heights ``level`` lie at its end, or between that and the wall there.
    """
    spec, side, by = member.flank(flank), SIDES[flank], nominal_cut(member, flank)
    (tip,) = (edge for edge in blades_of(member).edges if (edge.flank, edge.part) == (flank, "tip"))
    (direction, _), count = cone_distances(member.blank), len(distance)
    near = np.repeat(by.at(*mean_place(member)).contact, count, axis=0)
    found = []
    for u in np.linspace(tip.lower, tip.upper, _ALONG):
        section, end = tip_plane(spec, side, side * (tip_radius(spec, side) - tip.shape[0]) + u)
        near[:, 0] = end
        row = solve_curve(by.how, section, near[:, 0], direction, distance, near)
        found.append(np.where(row.converged[:, None], row.point, np.nan))
        near = np.where(row.converged[:, None], row.contact, near)
    x, y, z = np.moveaxis(np.stack(found), 2, 0)
    across = half_turn(np.arctan2(y, x) - azimuth)
    up = -direction[1] * z + direction[0] * np.hypot(x, y)
    height = np.full(count, np.nan)
    for k in range(count):
        order = np.argsort(across[:, k])
        if np.isfinite(across[:, k]).all():
            height[k] = np.interp(0.0, across[order, k], up[order, k], left=np.nan, right=np.nan)
    length = across[-1] - across[0]
    wall = half_turn(_wall(member, flank, distance, level) - azimuth - across[-1]) / length
    past = -across[-1] / length
    return height, (past > -_STEP) & (past < _STEP + np.maximum(wall, 0.0))


def _wall(member: Member, flank: str, distance: np.ndarray, level: np.ndarray) -> np.ndarray:
    """Angles (n,) [rad] about the axis of what the end of a tip leaves at cone distances and heights (n,)."""
    angles, heights = corner_wall(member, flank, tip_lengths(member)[flank])
    heights = heights + root_height(member.blank)
    at, found = cone_distances(member.blank)[1], np.empty(len(distance))
    for k, (one, high) in enumerate(zip(distance, level, strict=True)):
        angle, up = (np.array([np.interp(one, at, row) for row in rows]) for rows in (angles, heights))
        there = np.isfinite(angle)
        order = np.argsort(up[there])
        found[k] = np.interp(high, up[there][order], angle[there][order])
    return found
