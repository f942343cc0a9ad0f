"""The root that the tips of single blades leave: those of outer and inner blades, each over its half of the space."""

from __future__ import annotations

import numpy as np

from gearmath.bevel.generation import solve_curve, solve_section
from gearmath.bevel.method import blade_sections, generation_of
from gearmath.bevel.root import cone_distances, mean_place, tip_plane, tip_radius
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

    Points that no tip passes stay. The root has a step where a tip ends, whose corner sweeps a little beyond it.
    """
    along = np.array(cone_distances(member.blank)[0])
    for _ in range(_STEPS):
        radius = np.hypot(point[:, 0], point[:, 1])
        outwards = np.einsum("nk,nk->n", normal[:, :2], point[:, :2]) / radius
        rising = np.stack([normal[:, 2], outwards], axis=1) @ (-along[1], along[0])
        place = np.stack([point[:, 2], radius], axis=1)
        distance, azimuth = place @ along, np.arctan2(point[:, 1], point[:, 0])
        (one, away), (other, away_too) = (_left_by(member, flank, distance, azimuth) for flank in FLANKS)
        height = np.fmin(one, other)
        missing = (height - place @ (-along[1], along[0])) / rising
        point = point + np.where(np.isfinite(missing), missing, 0.0)[:, None] * normal
    return point, ~(np.fmin(away, away_too) <= _STEP)


def _left_by(member: Member, flank: str, distance: np.ndarray, azimuth: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Heights (n,) [mm] above the pitch cone that the tip of one kind of blade leaves at cone distances and azimuths
    (n,), NaN beside it; and how far (n,) each lies from its end, in parts of its length."""
    spec, side, how = member.flank(flank), SIDES[flank], generation_of(member, flank)
    (tip,) = (edge for edge in blades_of(member).edges if (edge.flank, edge.part) == (flank, "tip"))
    (direction, _), count = cone_distances(member.blank), len(distance)
    main = blade_sections(spec, side)["main"]
    near = np.repeat(solve_section(how, main, *mean_place(member)).contact, count, axis=0)
    found = []
    for u in np.linspace(tip.lower, tip.upper, _ALONG):
        section, end = tip_plane(spec, side, side * (tip_radius(spec, side) - tip.shape[0]) + u)
        near[:, 0] = end
        row = solve_curve(how, section, near[:, 0], direction, distance, near)
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
    return height, np.abs(across[-1]) / np.abs(across[-1] - across[0])
