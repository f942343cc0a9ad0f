"""What the two members of a set are to each other, as figures: backlash, angles at the mean point, ease-off.

They are those that the check of a set limits (``check_mates``, ``check_ease_off``).
"""

from __future__ import annotations

import math
from typing import Any

from gearmath.bevel.blank import evaluate
from gearmath.bevel.check_blank import transverse_module
from gearmath.bevel.check_ease_off import ease_off_parts
from gearmath.bevel.check_flank import cut_flank
from gearmath.bevel.ease_off import Parts, hollow, is_least_inside
from gearmath.bevel.method import nominal_cut
from gearmath.bevel.tooth import mean_backlash
from gearmath.specs.bevel_set import FLANKS, MEMBERS, BevelSet

#: The kind of ``notation.backlash_kind`` that is transverse, at the mean point.
_MEAN_TRANSVERSE = 3


def ease_off_of(pair: BevelSet) -> dict[str, Parts] | None:
    """The parts of the ease-off by the pinion's flank, None without a pair. Raises Misfit where flanks do not meet."""
    if pair.pinion is None or pair.gear is None:
        return None
    return ease_off_parts(pair.pinion, pair.gear, pair.rad("shaft_angle"))


def pair_figures(pair: BevelSet, found: dict[str, Parts] | None) -> dict[str, Any] | None:
    """Backlash [mm] at the mean point, and by the pinion's flank what it and its mate differ by, None without a pair.

    Angles [degree] are pinion less gear, both counted as the pinion's. The ease-off [um] is positive where there is a
    gap, ``found`` are its parts, those at the edges of the gear's grid. Raises Misfit where the flanks are none.
    """
    if pair.pinion is None or pair.gear is None or found is None:
        return None
    cut = {
        name: {flank: cut_flank(member, flank, nominal_cut(member, flank)) for flank in FLANKS}
        for name, member in pair.members.items()
    }
    transverse = mean_backlash(pair.pinion, pair.gear)
    figures: dict[str, Any] = {
        "mean_transverse_backlash_mm": transverse,
        "mean_normal_backlash_mm": _normal(pair, cut["gear"], transverse),
    }
    for flank, mating in zip(FLANKS, reversed(FLANKS), strict=True):
        own, mate = cut[MEMBERS[0]][flank], cut[MEMBERS[1]][mating]
        parts = {
            "slope": "slope",
            "profile_slope": "profile_slope",
            "crowning": "crowning",
            "bias": "twist",
            "profile_crowning": "profile_crowning",
            "rest": "rest",
        }
        figures[flank] = {
            "pressure_angle_difference_deg": math.degrees(own.pressure_angle - mate.pressure_angle),
            "spiral_angle_difference_deg": math.degrees(own.spiral_angle + mate.spiral_angle),
            "ease_off_um": {name: 1000 * getattr(found[flank], part) for name, part in parts.items()}
            | {"hollow": 1000 * hollow(found[flank])},
            "least_gap_inside": is_least_inside(found[flank]),
        }
    return figures


def edge_note(found: dict[str, Parts] | None) -> str:
    """What to say of a pair with such an ease-off that the check takes, and that runs on edges of its teeth.

    A slip that is too small to be refused shows so, a digit of a ratio of roll; so do sets that never were designed.
    """
    said = [_edge(flank, one) for flank, one in (found or {}).items() if not is_least_inside(one)]
    if not said:
        return ""
    return (
        f"the pair runs on edges of its teeth ({'; '.join(said)}): where it was designed otherwise, a figure of the "
        "set is wrong; 'gearmath contact' shows its path"
    )


def _edge(flank: str, found: Parts) -> str:
    """The slopes and crownings by which the least gap of a flank lies beyond an edge."""
    slope, crowning, profile_slope, profile_crowning = (
        1000 * value for value in (found.slope, found.crowning, found.profile_slope, found.profile_crowning)
    )
    return (
        f"pinion {flank}: ease-off with a slope of {slope:+.1f} um and crowning of {crowning:+.1f} um along the tooth,"
        f" {profile_slope:+.1f} and {profile_crowning:+.1f} um from root to tip"
    )


def _normal(pair: BevelSet, gear: dict[str, Any], transverse: float) -> float:
    """The backlash along the normal of the flanks (13.1)."""
    assert pair.gear is not None
    spiral = sum(abs(flank.spiral_angle) for flank in gear.values()) / len(gear)
    mean = {"cone_distance": pair.gear.blank.mean_cone_distance, "spiral_angle": spiral}
    values = {
        "mean_normal_module": transverse_module(pair.gear) * math.cos(spiral),
        "profile_shift_coefficient": 0.0,
        "thickness_modification": 0.0,
        "pressure_angle_drive": gear["convex"].pressure_angle,
        "pressure_angle_coast": gear["concave"].pressure_angle,
        "backlash": transverse,
        "backlash_kind": _MEAN_TRANSVERSE,
        "mean_cone_distance": mean["cone_distance"],
        "mean_spiral_angle": spiral,
    }
    return evaluate("tooth_thickness", values | mean)["mean_normal_backlash"]
