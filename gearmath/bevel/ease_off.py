"""Ease-off of a pair: the pinion's flank against the one that is conjugate to the gear's (chapter 24).

Each point of the gear's grid is carried to the place where it meets the pinion at the constant ratio (20.5, 20.6); the
pinion's flank is solved there, beyond the ends of its blade where need be, and the gap between both is E (24.2).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from gearmath.bevel.flank import Grid, nominal_points
from gearmath.bevel.method import nominal_cut
from gearmath.bevel.turning import half_turn
from gearmath.kernels import kernel
from gearmath.specs.bevel_set import FLANKS, Member


@dataclass(frozen=True)
class ConjugatePlaces:
    """Where points (n,) of a member meet its mate: z and r on the mate [mm], and how far its member has turned [rad].

    NaN where a point never meets the mate.
    """

    axial: np.ndarray
    radial: np.ndarray
    turn: np.ndarray


def conjugate_places(
    member: Member, mate: Member, shaft_angle: float, point: np.ndarray, normal: np.ndarray
) -> ConjugatePlaces:
    """Where points (n,3) of a member with normals (n,3) meet its mate (20.5, 20.6); ``shaft_angle`` in rad.

    Of the two places that (20.5) has for each point, that nearer to the middle of the mate's blank.
    """
    beyond, mate_beyond = (one.blank.pitch_apex_beyond_crossing_point for one in (member, mate))
    point = point - [0.0, 0.0, beyond]  # from the crossing point, which the members share
    given = (point, normal, shaft_angle, mate.teeth / member.teeth)
    found = np.stack([np.stack(kernel("conjugate_place")(*given, side)) for side in (1, -1)])
    found[:, 1] += mate_beyond
    delta, mean = mate.blank.delta, mate.blank.mean_cone_distance
    center = mean * np.array([math.cos(delta), math.sin(delta)])
    away = np.hypot(found[:, 1] - center[0], found[:, 2] - center[1])
    branch = np.where(np.isfinite(away), away, np.inf).argmin(axis=0)
    turn, axial, radial = np.take_along_axis(found, branch[None, None, :], axis=0)[0]
    return ConjugatePlaces(axial, radial, turn)


def ease_off(pinion: Member, gear: Member, shaft_angle: float, flank: str, grid: Grid) -> np.ndarray:
    """The ease-off (rows, columns) [mm] of a flank of the pinion, at the points of a ``grid`` of the gear's flank.

    Positive = gap; zero at the middle of the grid, as the rotation of the pinion is left open. NaN where a point of the
    gear does not meet the pinion, or meets it where its settings cut nothing. ``shaft_angle`` in rad.
    """
    mating, _ = nominal_points(gear, FLANKS[1 - FLANKS.index(flank)], grid)
    at = conjugate_places(gear, pinion, shaft_angle, mating.point, mating.normal)
    meets = np.isfinite(at.axial) & np.isfinite(at.radial)
    E = np.full(len(meets), np.nan)
    if not meets.any():
        return E.reshape(grid.shape)
    own = nominal_cut(pinion, flank).at(at.axial[meets], at.radial[meets])
    ratio = pinion.teeth / gear.teeth
    from_crossing = mating.point[meets] - [0.0, 0.0, gear.blank.pitch_apex_beyond_crossing_point]
    (azimuth,) = kernel("conjugate_azimuth")(from_crossing, at.turn[meets], shaft_angle, ratio)
    turn = half_turn(azimuth - np.arctan2(own.point[:, 1], own.point[:, 0]))
    turn = half_turn(turn - turn[len(turn) // 2])
    (gap,) = kernel("ease_off")(own.point, own.normal, turn)
    E[meets] = np.where(own.converged, gap, np.nan)
    return E.reshape(grid.shape)


@dataclass(frozen=True)
class Parts:
    """Ease-off as E = slope x + profile_slope y + crowning x² + twist x y + profile_crowning y² + constant + rest.

    x runs from -1 at toe to 1 at heel, y from -1 at root to 1 at tip of the gear's grid. ``rest`` is its largest size.
    """

    slope: float
    profile_slope: float
    crowning: float
    twist: float
    profile_crowning: float
    rest: float


def parts(E: np.ndarray) -> Parts:
    """The parts of an ease-off (rows, columns), by least squares, in its unit."""
    y, x = np.meshgrid(*(np.linspace(-1, 1, count) for count in E.shape), indexing="ij")
    terms = np.stack([x, y, x * x, x * y, y * y, np.ones_like(x)], axis=-1).reshape(-1, 6)
    found, *_ = np.linalg.lstsq(terms, E.ravel(), rcond=None)
    slope, profile, crowning, twist, across = (float(part) for part in found[:5])
    return Parts(slope, profile, crowning, twist, across, float(np.abs(terms @ found - E.ravel()).max()))


def hollow(found: Parts) -> float:
    """How far the second order of an ease-off falls below its middle anywhere on the grid, in its unit.

    The least of crowning x² + twist x y + profile_crowning y² on the square lies in its middle, or on an edge.
    """

    def edge(along: float, across: float) -> float:
        """Least of along t² + twist t + across for t from -1 to 1."""
        t = min(max(-found.twist / (2 * along), -1.0), 1.0) if along > 0 else -np.copysign(1.0, found.twist)
        return float(along * t * t + found.twist * t + across)

    least = min(edge(found.crowning, found.profile_crowning), edge(found.profile_crowning, found.crowning), 0.0)
    return -least


def is_least_inside(found: Parts) -> bool:
    """Whether the second order of an ease-off has its least gap on the grid, and not beyond one of its edges.

    Where it has not, the flanks run on that edge: whichever place of the path of contact comes first there carries.
    """
    determinant = 4 * found.crowning * found.profile_crowning - found.twist**2
    if not (found.crowning > 0 and determinant > 0):
        return False
    along = found.twist * found.profile_slope - 2 * found.profile_crowning * found.slope
    up = found.twist * found.slope - 2 * found.crowning * found.profile_slope
    return max(abs(along), abs(up)) <= determinant
