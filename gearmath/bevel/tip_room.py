"""How far the tip of a hobbing blade may reach across the space: up to the fillet of the other blade, from toe to heel.

Where a tip ends, its corner sweeps a wall of its own as the cutter rolls. It leans over beyond the place where the tip
is deepest, and stands elsewhere across the space in every section of the face width. It must stay off the surface that
the other blade cuts; what stays between the walls of both tips, where these do not meet, is a ridge.
"""

from __future__ import annotations

import math
from dataclasses import replace
from functools import lru_cache

import numpy as np

from gearmath.bevel.generation import Section, solve_curve
from gearmath.bevel.method import nominal_cut
from gearmath.bevel.root import (
    ACROSS,
    CORNER,
    ENDS,
    above_root,
    cone_distances,
    mean_place,
    root_height,
    root_trace,
    tip_radius,
)
from gearmath.bevel.tooth import flank_surface, space_widths
from gearmath.bevel.turning import half_turn
from gearmath.specs.bevel_set import FLANKS, SIDES, Member

#: Normals of the corner at the end of a tip [rad], from along the cutter's axis to nearly square to it.
_NORMALS = math.pi / 2 - math.radians(75) * np.linspace(0.0, 1.0, 18) ** 1.3
#: Rows of the other flank that the wall is compared with.
_ROWS = (("main", 9), ("toprem", 5), ("edge", 9))
#: A tip that is deeper than the fillet beside it leaves the metal square below the end of that fillet so deep. [mm]
_BELOW = 0.5
#: Most of the widest slot that a tip may take; how often the length is halved in search of its room.
_MOST, _HALVED = 0.9, 12
#: A tip reaches beyond the middle of the widest slot by this part of it, and leaves this part of its room free.
_OVERLAP, _FREE = 0.03, 0.02


@lru_cache(maxsize=64)
def tip_lengths(member: Member) -> dict[str, float]:
    """Lengths [mm] of the tips from the corners of their blades, by flank: beyond the middle of the widest slot, where
    the fillet of the other blade leaves room for it; where one has none, the other takes over as much as it may."""
    _, slots = space_widths(member)
    most = {flank: (1 - _FREE) * tip_room(member, flank)[0] for flank in FLANKS}
    lengths = {}
    for flank, other in zip(FLANKS, reversed(FLANKS), strict=True):
        half = (0.5 + _OVERLAP) * slots[flank].most
        lengths[flank] = min(most[flank], half + max(half - most[other], 0.0))
    return lengths


@lru_cache(maxsize=64)
def tip_room(member: Member, flank: str) -> tuple[float, int]:
    """The greatest length [mm] with which the tip of a blade stays off the surface that the other one cuts, and the
    place of 0 (toe) to 8 (heel) at which it would touch it first."""
    other = FLANKS[1 - FLANKS.index(flank)]
    inside = slice(ENDS[0], ENDS[-1] + 1)
    surface = flank_surface(member, other, ENDS[-1] - ENDS[0] + 1, _ROWS)
    point = np.concatenate([surface.point, surface.point[-1:] - _BELOW * surface.normal[-1:]])
    beside = np.arctan2(point[..., 1], point[..., 0])
    around, (along, up) = np.hypot(point[..., 0], point[..., 1]), cone_distances(member.blank)[0]
    height = along * around - up * point[..., 2] - root_height(member.blank)[inside]
    own = corner_wall(member, flank, 0.0)[0][0, inside]
    sense = np.sign(half_turn(beside[-2] - own))
    low, high, first = 0.0, _MOST * space_widths(member)[1][flank].most, 0
    for _ in range(_HALVED):
        middle = (low + high) / 2
        gaps = _gaps(member, flank, middle, sense * beside, height, sense)
        if gaps.min() > 0:
            low = middle
        else:
            high, first = middle, int(gaps.argmin())
    return low, first


def _gaps(
    member: Member, flank: str, length: float, beside: np.ndarray, height: np.ndarray, sense: np.ndarray
) -> np.ndarray:
    """Least angles (9,) [rad] between the wall that the end of a tip leaves and the other flank, whose angles about the
    axis, times ``sense`` (9,), and heights over the root are given (rows,9)."""
    walls, tops = (part[:, ENDS[0] : ENDS[-1] + 1] for part in corner_wall(member, flank, length))
    found = []
    for k, (wall, top) in enumerate(zip(walls.T, tops.T, strict=True)):
        there = np.isfinite(wall)
        order, other = np.argsort(top[there]), np.argsort(height[:, k])
        at = np.concatenate([top[there], height[:, k]])  # lines between points come nearest at one of these
        at = at[(at >= top[there].min()) & (at <= min(top[there].max(), height[:, k].max()))]
        reached = np.interp(at, top[there][order], sense[k] * wall[there][order])
        found.append(half_turn(np.interp(at, height[other, k], beside[other, k]) - reached).min())
    return np.array(found)


def corner_wall(member: Member, flank: str, length: float) -> tuple[np.ndarray, np.ndarray]:
    """Angles about the axis [rad] and heights over the root [mm] (rows,13) of what the end of a tip of a length leaves,
    its lowest point first, at the places ``ACROSS``; NaN where it leaves nothing."""
    spec, side, by = member.flank(flank), SIDES[flank], nominal_cut(member, flank)
    near = root_trace(member, flank, by.how, by.at(*mean_place(member)).contact, length).contact
    end = tip_radius(spec, side) - side * (length - CORNER)
    arc = (end, spec.blade_tip_height + CORNER, CORNER)
    corner = Section(0.0, math.pi / 2, spec.nominal.blade_point_radius, spec.nominal.alpha, arc)
    direction, distance = cone_distances(member.blank)
    angles, heights = [], []
    for normal in _NORMALS:
        near = np.column_stack([np.full(len(ACROSS), normal), near[:, 1:]])
        found = solve_curve(replace(by.how, side=-side), corner, near[:, 0], direction, distance, near)
        near = np.where(found.converged[:, None], found.contact, near)
        point = np.where(found.converged[:, None], found.point, np.nan)
        angles.append(np.arctan2(point[:, 1], point[:, 0]))
        heights.append(above_root(member, point))
    return np.array(angles), np.array(heights)
