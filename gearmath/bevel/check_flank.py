"""What the settings of a flank cut, in a few points: the mean point, the tips and roots at toe, mean and heel."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from gearmath.bevel.check_blank import transverse_module
from gearmath.bevel.flank import Grid, blank_grid, solve_flank
from gearmath.bevel.generation import BladeCut, Generation, Section, solve_section
from gearmath.bevel.method import nominal_cut
from gearmath.bevel.misfit import Misfit
from gearmath.bevel.newton import FlankPoints
from gearmath.bevel.root import ENDS, PLACES, above_root, mean_place, root_trace
from gearmath.bevel.tooth import space_widths
from gearmath.bevel.turning import half_turn
from gearmath.errors import InputError
from gearmath.kernels import kernel
from gearmath.specs.bevel_set import Member

#: Pressure angles of a flank at the mean point, and the steepest spiral angle. [degree]
_PRESSURE, _STEEPEST = (5.0, 40.0), 55.0
#: Spiral angles below this one tell no hand: that of a Zerol gear is told by its heel. [degree]
_ZEROL = 2.0
#: The root may lie off that of the blank by these parts of the clearance, at toe, mean point and heel; where settings
#: are corrected, so far that the tip of the mate stays clear of it.
ROOT, _CORRECTED_ROOT = (0.75, 0.25, 0.75), (1.0, 1.0, 1.0)
#: The mean point is cut near the middle of the roll: largest cradle rotation from where cradle_angle puts it. [degree]
OFF_CENTER = 15.0
_BLADE_SLACK = 1e-7
#: What motions of the settings may change of the form of a flank, over the transverse module.
_MOTION = 0.1


@dataclass(frozen=True)
class CutFlank:
    """A flank of space 0 (mm, rad): signed pressure and spiral angle at the mean point (8.4), the direction about z_w
    of the mean point and of the tips (3,), and ``across``, +1 where the space lies towards larger angles. ``root``
    (13,3) are the points that the tip of the blade leaves, from before the toe to beyond the heel, ``contact``
    (1,3) is that at the mean point, ``by`` what it is cut by."""

    pressure_angle: float
    spiral_angle: float
    azimuth: float
    across: int
    tip_azimuth: np.ndarray
    root: np.ndarray
    contact: np.ndarray
    by: BladeCut


def cut_flank(member: Member, flank: str, by: BladeCut, corrected: bool = False) -> CutFlank:
    """The flank that is cut like this. Raises Misfit where it cannot be the flank that the blank describes.

    The root of ``corrected`` settings may lie farther from that of the blank.
    """
    mean = by.at(*mean_place(member))
    if not mean.converged.all():
        raise Misfit.of(member.name, flank, "the equation of meshing has no solution at the mean point")
    delta = member.blank.delta
    found = (float(value[0]) for value in kernel("flank_angles")(delta, mean.point, mean.normal))
    pressure, spiral, across, azimuth = found
    _check_angles(member.name, flank, pressure, spiral)
    swing = math.degrees(float(mean.contact[0, 2]))
    if not abs(swing) <= OFF_CENTER:
        raise Misfit.of(
            member.name,
            flank,
            f"the mean point is cut with the cradle turned by {swing:+.4g} degrees from its cradle_angle, which must "
            f"be at most {OFF_CENTER:g}",
        )
    root = _root(member, flank, by.how, mean.contact, np.array(_CORRECTED_ROOT if corrected else ROOT))
    axial, radial = kernel("flank_place")(member.blank.vector, np.array([0.0, 0.5, 1.0]), np.ones(3))
    tips = by.at(axial, radial)
    _check_tips(
        member.name, flank, by.main, tips.contact[:, 0], tips.converged, member.flank(flank).blade_profile_height
    )
    tip_azimuth = np.arctan2(tips.point[:, 1], tips.point[:, 0])
    _check_hand(member, flank, spiral, tip_azimuth)
    return CutFlank(pressure, spiral, azimuth, 1 if across > 0 else -1, tip_azimuth, root, mean.contact, by)


def check_grid(member: Member, flank: str) -> None:
    """Refuse a flank that is not there on the whole of the standard grid. Raises Misfit."""
    grid = blank_grid(member)
    try:
        points = solve_flank(member, flank, grid)
    except InputError as error:
        raise Misfit.of(member.name, flank, str(error).removeprefix(f"{member.name} {flank} flank, ")) from error
    by = nominal_cut(member, flank)
    if by.how.motion.any():
        _check_motion(member, flank, by, grid, points)


def _check_motion(member: Member, flank: str, by: BladeCut, grid: Grid, points: FlankPoints) -> None:
    """A motion changes the form of the flank that the settings cut at rest, and not what flank it is."""
    resting = replace(by.how, motion=np.zeros_like(by.how.motion))
    rest = solve_section(resting, by.main, grid.axial.ravel(), grid.radial.ravel(), points.contact)
    delta = member.blank.delta
    _, _, across, azimuth = kernel("flank_angles")(delta, points.point, points.normal)
    _, _, _, before = kernel("flank_angles")(delta, rest.point, rest.normal)
    turn = half_turn(azimuth - before)
    change = (turn * grid.radial.ravel() * across)[rest.converged]
    limit = _MOTION * transverse_module(member)
    if not np.ptp(change) <= limit:
        raise InputError(
            f"{member.name}.{flank}.motion: it changes the form of the flank by {np.ptp(change):.3g} mm from end to "
            f"end against settings at rest, which must be at most {limit:.3g} mm, {_MOTION:g} of the module"
        )


def _check_angles(name: str, flank: str, pressure: float, spiral: float) -> None:
    low, high = _PRESSURE
    if not low <= math.degrees(pressure) <= high:
        raise Misfit.of(
            name,
            flank,
            f"its pressure angle at the mean point is {math.degrees(pressure):.4g} degrees, which must lie between "
            f"{low:g} and {high:g}",
        )
    if not abs(math.degrees(spiral)) <= _STEEPEST:
        raise Misfit.of(
            name,
            flank,
            f"its spiral angle at the mean point is {math.degrees(spiral):.4g} degrees, which must be at most "
            f"{_STEEPEST:g}",
        )


def _check_hand(member: Member, flank: str, spiral: float, tip_azimuth: np.ndarray) -> None:
    """The trace of a right-hand member turns towards larger angles from toe to heel, that of a Zerol at the heel."""
    hand = 1 if member.hand == "right" else -1
    told = spiral
    if abs(spiral) < math.radians(_ZEROL):
        told = math.remainder(float(tip_azimuth[2] - tip_azimuth[1]), 2 * math.pi)
    if told * hand > 0:
        return
    other = "left" if hand == 1 else "right"
    raise Misfit.of(
        member.name,
        flank,
        f"hand = {member.hand!r} is stated, but its spiral angle at the mean point is {math.degrees(spiral):+.4g} "
        f"degrees, which is {other} hand",
    )


def _root(member: Member, flank: str, how: Generation, mean: np.ndarray, share: np.ndarray) -> np.ndarray:
    """Points (13,3) that the tip of the blade leaves: they have to lie on the root of the blank, to a ``share`` (3,) of
    the clearance at toe, mean point and heel. NaN beyond the ends where there is none."""
    clearance, found = member.blank.clearance, root_trace(member, flank, how, mean)
    reached = found.converged[ENDS[0] : ENDS[-1] + 1]
    if not reached.all():
        k = round(int(np.argmax(~reached)) / (len(reached) - 1) * (len(PLACES) - 1))
        raise Misfit.of(member.name, flank, f"the tip of the blade does not reach the root at the {PLACES[k]}")
    # the tip plane of a tilted cutter leans across the space: it lies on the root in the middle
    middle = found
    if member.cutting == "completing" and member.flank(flank).nominal.cutter_tilt:
        half = space_widths(member)[0].mean / 2
        middle = root_trace(member, flank, how, mean, half)
    off = above_root(member, middle.point)[list(ENDS)]
    beyond = ~(np.abs(off) <= share * clearance)
    if beyond.any():
        k = int(np.argmax(np.abs(off) / share))
        raise Misfit.of(
            member.name,
            flank,
            f"the tip of the blade leaves the root {abs(off[k]):.3g} mm {'above' if off[k] > 0 else 'below'} that of "
            f"the blank at the {PLACES[k]}, which must be at most {share[k] * clearance:.3g} mm, "
            f"{share[k]:g} of the clearance",
        )
    return np.where(found.converged[:, None], found.point, np.nan)


def _check_tips(name: str, flank: str, section: Section, u: np.ndarray, converged: np.ndarray, height: float) -> None:
    """The blade reaches up to the tip of the tooth, toe to heel."""
    if not converged.all():
        k = int(np.argmax(~converged))
        raise Misfit.of(
            name, flank, f"the equation of meshing has no solution at the tip of the tooth at the {PLACES[k]}"
        )
    short, long = u < section.lower - _BLADE_SLACK, u > section.upper + _BLADE_SLACK
    above = short if section.tip_is_upper else long
    below = long if section.tip_is_upper else short
    if above.any():
        k = int(np.argmax(above))
        needed = f": it must be at least {u.max():.4g} mm" if section.arc is None else ""
        raise InputError(
            f"{name} {flank} flank: blade_profile_height = {height:g} does not reach the tip of the tooth at the "
            f"{PLACES[k]}{needed}"
        )
    if below.any():
        k = int(np.argmax(below))
        raise Misfit.of(
            name, flank, f"the tip of the tooth at the {PLACES[k]} lies below the main section of the blade"
        )
