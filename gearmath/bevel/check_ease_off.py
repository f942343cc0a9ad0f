"""Whether the flanks of a pair are mates over the whole flank: their ease-off, part by part.

A crown gear cuts no conjugate pair: a cut of both flanks at once takes from one what it gives to the other, and a
design adds crowning and bias. So the parts of the ease-off of both flanks are taken together: their mean, and half
their difference, each with its limit. The limits are twice what the bundled sets have. They also hold for the pairs of
the crown gear of every cutting method, ratio 1 to 8 and spiral angle to 45 degrees, and leave room for designs of
0.25 mm at a corner at module 5.
"""

from __future__ import annotations

import numpy as np

from gearmath.bevel.check_blank import transverse_module
from gearmath.bevel.ease_off import Parts, ease_off, parts
from gearmath.bevel.flank import blank_grid
from gearmath.bevel.misfit import Misfit
from gearmath.specs.bevel_set import FLANKS, Member

#: Part, +1 for the mean of both flanks or -1 for half their difference (concave less convex), what it is, and limits:
#: ease-off at the edge of the grid over the transverse module, both in mm.
_LIMITS: tuple[tuple[str, int, str, float, float], ...] = (
    ("slope", -1, "slope along the tooth, a spiral angle that is not that of the mate,", -0.016, 0.016),
    ("slope", 1, "slope along the tooth, a space that does not taper as the mating tooth,", -0.150, 0.150),
    ("profile_slope", 1, "slope from root to tip, a pressure angle that is not that of the mate,", -0.014, 0.014),
    ("profile_slope", -1, "difference of slope from root to tip between the flanks", -0.110, 0.110),
    ("crowning", 1, "lengthwise crowning", -0.035, 0.060),
    ("crowning", -1, "difference of lengthwise crowning between the flanks", -0.016, 0.016),
    ("twist", 1, "bias", -0.012, 0.012),
    ("twist", -1, "difference of bias between the flanks", -0.070, 0.070),
    ("profile_crowning", 1, "profile crowning", -0.024, 0.024),
    ("profile_crowning", -1, "difference of profile crowning between the flanks", -0.014, 0.014),
)
#: What no part of second degree describes may be this much of the module.
_REST = 0.015


def check_ease_off(pinion: Member, gear: Member, shaft_angle: float, share: float = 1.0) -> None:
    """Refuse mates whose flanks do not fit each other from toe to heel and from root to tip. Raises Misfit.

    ``share`` is the part of the limits that may be used.
    """
    where = [(name, flank) for name in ("pinion", "gear") for flank in FLANKS]
    grid, module = blank_grid(gear), transverse_module(gear)
    found: list[Parts] = []
    for flank in FLANKS:
        E = ease_off(pinion, gear, shaft_angle, flank, grid)
        if not np.isfinite(E).all():
            row, column = divmod(int(np.argmax(~np.isfinite(E))), grid.shape[1])
            mating = FLANKS[1 - FLANKS.index(flank)]
            raise Misfit(
                f"pinion {flank} flank: it does not meet the mating {mating} flank of the gear at row {row}, column "
                f"{column} of its grid",
                ("pinion", flank), ("gear", mating),
            )  # fmt: skip
        found.append(parts(E))
    excess = [
        (max(value / high, value / low), value, low, high, what)
        for part, sign, what, low, high in _LIMITS
        for value in [(getattr(found[0], part) + sign * getattr(found[1], part)) / 2 / module]
    ]
    excess += [
        (one.rest / module / _REST, one.rest / module, 0.0, _REST, f"waviness of the {flank} flank")
        for flank, one in zip(FLANKS, found, strict=True)
    ]
    size, value, low, high, what = max(excess)
    if not size <= share:
        raise Misfit(
            f"pinion and gear do not fit along the flanks: the ease-off has a {what} of {value * module:.3g} mm at the "
            f"edges of the grid, which must lie between {low * module:.3g} and {high * module:.3g} mm, {low:g} and "
            f"{high:g} of the module",
            *where,
        )  # fmt: skip
