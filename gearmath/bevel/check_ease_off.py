"""Whether the flanks of a pair are mates over the whole flank: their ease-off, part by part.

A pair of flanks that touch must have a gap all around, or they touch at their ends instead: the second order of the
ease-off may not fall below zero anywhere on the grid. That tells a set that was made for another method, a Formate gear
cut by rolling or a motion left out, as what rolling does to a flank is its curvature. Every pair of generated members
of the crown gear keeps this within 0.0015 of the module, the published one of NASA CR-191009 too.

What is left of the parts is limited by themselves, taken together from both flanks: their mean, and half their
difference. The limits are at least twice what the bundled sets have. They also hold for the generated pairs of the
crown gear, ratio 1 to 8 and spiral angle to 45 degrees, and leave room for designs of 0.25 mm at a corner at module 5.
"""

from __future__ import annotations

import numpy as np

from gearmath.bevel.check_blank import transverse_module
from gearmath.bevel.ease_off import Parts, ease_off, hollow, parts
from gearmath.bevel.flank import blank_grid
from gearmath.bevel.misfit import Misfit
from gearmath.specs.bevel_set import FLANKS, Member

#: Part, +1 for the mean of both flanks or -1 for half their difference (concave less convex), what it is, and limits:
#: ease-off at the edge of the grid over the transverse module, both in mm.
_LIMITS: tuple[tuple[str, int, str, float, float], ...] = (
    ("slope", -1, "slope along the tooth, a spiral angle that is not that of the mate,", -0.0125, 0.0125),
    ("slope", 1, "slope along the tooth, a space that does not taper as the mating tooth,", -0.150, 0.150),
    ("profile_slope", 1, "slope from root to tip, a pressure angle that is not that of the mate,", -0.014, 0.014),
    ("profile_slope", -1, "difference of slope from root to tip between the flanks", -0.014, 0.014),
    ("crowning", 1, "lengthwise crowning", -0.010, 0.060),
    ("crowning", -1, "difference of lengthwise crowning between the flanks", -0.010, 0.010),
    ("twist", 1, "bias", -0.012, 0.012),
    ("twist", -1, "difference of bias between the flanks", -0.020, 0.020),
    ("profile_crowning", 1, "profile crowning", -0.010, 0.024),
    ("profile_crowning", -1, "difference of profile crowning between the flanks", -0.010, 0.010),
)
#: What no part of second degree describes may be this much of the module.
_REST = 0.010
#: How far the second order of a flank's ease-off may fall below zero on its grid, over the module: of the bundled sets
#: at most 0.0012, that of NASA CR-191009.
_HOLLOW = 0.003


def check_ease_off(pinion: Member, gear: Member, shaft_angle: float, share: float = 1.0) -> None:
    """Refuse mates whose flanks do not fit each other from toe to heel and from root to tip. Raises Misfit.

    ``shaft_angle`` in rad; ``share`` is the part of the limits that may be used.
    """
    where = [(name, flank) for name in ("pinion", "gear") for flank in FLANKS]
    module, found = transverse_module(gear), ease_off_parts(pinion, gear, shaft_angle)
    excess = [
        (max(value / high, value / low), value, low, high, what)
        for part, sign, what, low, high in _LIMITS
        for value in [(getattr(found[FLANKS[0]], part) + sign * getattr(found[FLANKS[1]], part)) / 2 / module]
    ]
    excess += [
        (one.rest / module / _REST, one.rest / module, 0.0, _REST, f"waviness of the {flank} flank")
        for flank, one in found.items()
    ]
    size, value, low, high, what = max(excess)
    depth = {flank: hollow(one) / module for flank, one in found.items()}
    deepest = max(FLANKS, key=lambda flank: depth[flank])
    if not depth[deepest] <= share * _HOLLOW and depth[deepest] / _HOLLOW >= size:
        mating = FLANKS[1 - FLANKS.index(deepest)]
        raise Misfit(
            f"pinion {deepest} flank and gear {mating} flank do not fit along the flanks: where they touch in the "
            f"middle they would cut {depth[deepest] * module:.3g} mm into each other at the ends of the grid, which "
            f"must be at most {_HOLLOW * module:.3g} mm, {_HOLLOW:g} of the module: crowning "
            f"{found[deepest].crowning:+.3g}, bias {found[deepest].twist:+.3g}, profile crowning "
            f"{found[deepest].profile_crowning:+.3g} mm, as of a mate that is cut by another method or motion",
            ("pinion", deepest),
            ("gear", mating),
        )
    if not size <= share:
        raise Misfit(
            f"pinion and gear do not fit along the flanks: the ease-off has a {what} of {value * module:.3g} mm at the "
            f"edges of the grid, which must lie between {low * module:.3g} and {high * module:.3g} mm, {low:g} and "
            f"{high:g} of the module",
            *where,
        )


def ease_off_parts(pinion: Member, gear: Member, shaft_angle: float) -> dict[str, Parts]:
    """The parts of the ease-off by the pinion's flank. Raises Misfit where a flank does not meet its mate."""
    grid, found = blank_grid(gear), {}
    for flank in FLANKS:
        E = ease_off(pinion, gear, shaft_angle, flank, grid)
        if not np.isfinite(E).all():
            row, column = divmod(int(np.argmax(~np.isfinite(E))), grid.shape[1])
            mating = FLANKS[1 - FLANKS.index(flank)]
            raise Misfit(
                f"pinion {flank} flank: it does not meet the mating {mating} flank of the gear at row {row}, column "
                f"{column} of its grid",
                ("pinion", flank),
                ("gear", mating),
            )
        found[flank] = parts(E)
    return found
