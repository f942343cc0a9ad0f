"""Backlash of a pair at the mean point, by turning the flanks of the pinion apart."""

from __future__ import annotations

import math

import numpy as np

from gearmath.bevel.method import nominal_cut
from gearmath.bevel.tooth import mean_backlash, mean_pitch_radius
from gearmath.specs.bevel_set import FLANKS, SIDES, Member
from gearmath.specs.design import Shop
from gearmath.specs.shop_steps import to_step
from gearmath.specs.toml import checked

#: A completing pinion: trials, what may be missing at the end, and the change that shows the rate [mm].
_TRIALS, _ENOUGH, _PROBE = 4, 2e-4, 0.01


def with_backlash(pinion: Member, gear: Member, backlash: float, like: Member, step: float = 0.0) -> Member:
    """The pinion with its flanks turned about the work axis until the pair has a transverse backlash [mm].

    That is the pitch less both tooth thicknesses at the mean point of the pitch cones. The space stays where it is in
    ``like``, a pinion with about the same one. ``step`` [degree] is that of the work rotation offset.
    """
    turns = {flank: math.degrees(_azimuth(like, flank) - _azimuth(pinion, flank)) for flank in FLANKS}
    placed = _turned(pinion, turns)
    missing = backlash - mean_backlash(placed, gear)
    half = math.degrees(missing / (2 * mean_pitch_radius(pinion)))
    hand = -1 if pinion.hand == "right" else 1
    # a wider space: each flank away from the middle of it
    return _turned(placed, {flank: hand * SIDES[flank] * half for flank in FLANKS}, step)


def completing_backlash(pinion: Member, gear: Member, backlash: float, shop: Shop) -> Member:
    """The pinion, cut completing, with a transverse backlash [mm] by the point radii of its two blades.

    Where these come in steps, by the sliding base: a cut that is deeper is wider.
    """
    widen = _deeper if shop.blade_radius_step else _wider
    step = shop.length_step if shop.blade_radius_step else 0.0
    total, found = 0.0, pinion
    for _ in range(_TRIALS):
        missing = backlash - mean_backlash(found, gear)
        if abs(missing) < _ENOUGH:
            break
        per = (mean_backlash(widen(found, _PROBE), gear) - mean_backlash(found, gear)) / _PROBE
        total = to_step(total + missing / per, step)
        found = widen(pinion, total)
    return found


def _wider(member: Member, by: float) -> Member:
    values = member.model_dump()
    for flank in FLANKS:
        values[flank]["blade_point_radius"] += SIDES[flank] * by
    return checked(values, Member, "pinion").named("pinion")


def _deeper(member: Member, by: float) -> Member:
    values = member.model_dump()
    for flank in FLANKS:
        values[flank]["sliding_base"] -= by
    return checked(values, Member, "pinion").named("pinion")


def _turned(member: Member, turns: dict[str, float], step: float = 0.0) -> Member:
    """The member with work rotation offsets, in steps, that turn its flanks by angles [degree] about z_w."""
    values = member.model_dump()
    for flank, turn in turns.items():
        offset = values[flank]["work_rotation_offset"] - turn
        values[flank]["work_rotation_offset"] = math.remainder(to_step(offset, step), 360.0)
    return checked(values, Member, "pinion").named("pinion")


def _azimuth(member: Member, flank: str) -> float:
    """Angle about z_w [rad] of a flank at the mean point of the pitch cone."""
    delta, mean = member.blank.delta, member.blank.mean_cone_distance
    place = np.array([mean * math.cos(delta)]), np.array([mean * math.sin(delta)])
    (point,) = nominal_cut(member, flank).at(*place).point
    return math.atan2(point[1], point[0])
