"""The way of the cutter through one tooth space: roll range, axis positions, and how finely to divide them.

G1 moves all axes linearly from node to node. Between two nodes the cutter leaves the exact path; what counts is what
that does to the flank, measured along the tooth normal.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from derivations.axes import SINGULAR_SINE
from gearmath.bevel.flank import FlankPoints, blank_grid, solve_places
from gearmath.bevel.kernels import kernel
from gearmath.errors import InputError
from gearmath.specs.bevel_set import FLANKS, SIDES, Flank, Member

#: How far the flank may deviate from nominal because of straight blocks. [mm]
DEFAULT_TOLERANCE = 1e-4
#: Part of the tolerance that chords may use; the rest is for the printed decimals.
_CHORD_SHARE = 0.8
#: The roll begins and ends this far outside the contact of the whole flank. [rad]
_OVERRUN = math.radians(2.0)
#: Step of the cradle with which the chord error is probed. [rad]
_PROBE = math.radians(1.0)


@dataclass(frozen=True)
class Cut:
    """One pass of one tool: the flanks it finishes, with the settings of each."""

    tool: str
    flanks: tuple[str, ...]

    @staticmethod
    def of(member: Member, name: str) -> tuple[Cut, ...]:
        """The passes that cut a space: one for a completing cutter, one a flank for fixed settings."""
        if member.cutting == "completing":
            return (Cut(name.upper(), FLANKS),)
        return tuple(Cut(f"{name}_{flank}".upper(), (flank,)) for flank in FLANKS)


def whole_flank(member: Member, flank: str) -> FlankPoints:
    """Points over the whole face and working depth, without the solver's refusal of points off the blade."""
    grid = blank_grid(member, 7, 13, 0.0)
    points, _ = solve_places(member.flank(flank).vector, SIDES[flank], grid.axial.ravel(), grid.radial.ravel())
    return points


def roll_range(member: Member, cut: Cut) -> tuple[float, float]:
    """Cradle rotations [rad] between which the cutter generates all of the flanks of a pass."""
    theta = np.concatenate([whole_flank(member, flank).contact[:, 2] for flank in cut.flanks])
    return float(theta.min()) - _OVERRUN, float(theta.max()) + _OVERRUN


def axis_positions(flank: Flank, theta: np.ndarray, pivot_height: float) -> np.ndarray:
    """X, Y, Z, A, B (n,5) [mm, rad] at cradle rotations (n,), A continuous.

    Raises InputError naming the cradle angle at which the cutter axis is (nearly) parallel to the work axis.
    """
    settings = flank.vector
    sine = np.sin(np.pi / 2 - (axes := kernel("axis_transform")(settings, theta, pivot_height)[0])[:, 4])
    singular = ~(np.abs(sine) >= float(SINGULAR_SINE))
    if singular.any():
        at = math.degrees(theta[int(np.argmax(singular))])
        raise InputError(
            f"at cradle angle {at:.3f} deg the cutter axis is parallel to the work axis within "
            f"|V_c x V_p| = {float(SINGULAR_SINE)}: the work axis A has no position there"
        )
    axes[:, 3] = np.unwrap(axes[:, 3])
    return axes


def chord_error(flank: Flank, side: int, points: FlankPoints, width: float, pivot_height: float) -> np.ndarray:
    """Deviation (n,) [mm] at flank points if a block of ``width`` [rad] has its middle at their cradle rotation."""
    theta = points.contact[:, 2]
    first, last = (axis_positions(flank, theta + half, pivot_height) for half in (-width / 2, width / 2))
    last[:, 3] += 2 * math.pi * np.round((first[:, 3] - last[:, 3]) / (2 * math.pi))
    (distance,) = kernel("line_entry")(
        (first + last) / 2, pivot_height, points.point, points.normal, flank.blade_point_radius,
        math.radians(flank.blade_pressure_angle), side,
    )  # fmt: skip
    return distance


def roll_nodes(member: Member, cut: Cut, tolerance: float, pivot_height: float) -> np.ndarray:
    """Cradle rotations (n,) [rad] of the block ends: equal blocks, just short enough for the tolerance.

    The chord error grows with the square of the block, which gives the number of blocks from one probe.
    """
    if not 1e-6 <= tolerance <= 0.1:
        raise InputError(f"tolerance = {tolerance * 1000:g} um: must lie between 0.001 and 100 um")
    start, end = roll_range(member, cut)
    worst = max(
        float(
            np.abs(
                chord_error(member.flank(flank), SIDES[flank], whole_flank(member, flank), _PROBE, pivot_height)
            ).max()
        )
        for flank in cut.flanks
    )
    width = _PROBE * math.sqrt(_CHORD_SHARE * tolerance / worst)
    return np.linspace(start, end, 1 + math.ceil((end - start) / width))
