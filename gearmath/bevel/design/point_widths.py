"""Point widths of fixed-setting cutters whose far side would cut into the flank that the other cutter makes.

Both flanks have settings of their own, so the far side of a cutter does not run along the other flank. A point that is
chosen for the slot alone, as ``bevel.ridge`` does, may be some tenths of a millimetre too wide towards toe and heel.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from gearmath.bevel.check_blade import tip_taken
from gearmath.bevel.generation import solve_section
from gearmath.bevel.method import blade_sections, generation_of
from gearmath.bevel.ridge import edge_taken, opposite, other_side, point_width
from gearmath.bevel.tooth import ToothSpace, sharp_edged, tooth_space
from gearmath.bevel.turning import half_turn
from gearmath.errors import InputError
from gearmath.specs.bevel_set import FLANKS, SIDES, Member

#: The far side stays off the other flank by so much [mm]; widths are taken down to this step [mm].
_OFF, _STEP = 0.01, 0.01
#: The distance grows by half to all of what the point is narrower by: each trial takes a little more than is missing.
_MORE, _TRIALS = 1.1, 10
#: What a far side cuts is worth a word from here on [mm].
_GOUGE = 1e-3
#: Where the flank is flatter than this across the space it is the bottom of the fillet, which the tips share.
_FLAT = 0.2


def with_point_widths(member: Member, name: str) -> Member:
    """A member that is cut flank by flank, with point widths stated where those chosen for the slots are too wide.

    Raises InputError where no width is narrow enough.
    """
    try:
        space = tooth_space(member, name)
    except InputError:
        return member  # no tooth, of which the verdict says why
    found = {}
    for flank in FLANKS:
        widest = point_width(member, flank, space.slots[flank])
        width = _narrow_enough(member, flank, space, widest)
        if width is None:
            least = _least_width(member, flank)
            raise InputError(
                f"{name} {flank} flank: the far side of a cutter with a point width of {least:.3g} mm, the least "
                f"that its edges leave, cuts {1000 * (_OFF - room(member, flank, space, least)):.0f} um into the "
                f"{opposite(flank)} flank, which must be at most 0; smaller blade_edge_radius, another "
                "thickness_factor or cutting = 'completing' is needed"
            )
        if width < widest:
            found[flank] = member.flank(flank).model_copy(update={"blade_point_width": width})
    return member.model_copy(update=found)


def far_sides_note(member: Member, space: ToothSpace) -> str:
    """What to say of cutters for one flank whose far side cuts into the other one; empty where none does."""
    if member.cutting != "fixed_setting":
        return ""
    said = []
    for flank in FLANKS:
        width = point_width(member, flank, space.slots[flank])
        left = room(member, flank, space, width)
        if left >= -_GOUGE:
            continue
        enough = _narrow_enough(member, flank, space, width)
        chosen = "" if member.flank(flank).blade_point_width is not None else ", chosen for the slot,"
        said.append(
            f"the far side of the {flank} flank's cutter of {width:.3f} mm point width{chosen} cuts {-1000 * left:.0f} "
            f"um into the {opposite(flank)} flank: blade_point_width must be "
            + (f"at most {enough:.2f} mm" if enough is not None else "less than its edges leave")
        )
    return "; ".join(said)


def _narrow_enough(member: Member, flank: str, space: ToothSpace, width: float) -> float | None:
    """The point width [mm], or the next narrower one whose far side stays off the other flank; None where none does."""
    least = _least_width(member, flank)
    for _ in range(_TRIALS):
        missing = _OFF - room(member, flank, space, width)
        if missing <= 0:
            break
        width = math.floor((width - _MORE * missing) / _STEP) * _STEP
        if not width > least:
            return None
    return width


def _least_width(member: Member, flank: str) -> float:
    """The point width [mm] that the rounded edges of both sides of a cutter take."""
    return edge_taken(member, flank) + tip_taken(member.flank(flank), SIDES[flank])


def room(member: Member, flank: str, space: ToothSpace, width: float) -> float:
    """The least distance [mm] of the other flank from what the far side of a cutter of that point width sweeps, square
    to the flank; negative where it cuts into it."""
    surfaces = {surface.flank: surface for surface in (space.concave, space.convex)}
    other = opposite(flank)
    point, normal, own = (
        one.reshape(-1, 3) for one in (surfaces[other].point, surfaces[other].normal, surfaces[flank].point)
    )
    around, beside = np.hypot(point[:, 0], point[:, 1]), np.arctan2(point[:, 1], point[:, 0])
    sense = np.sign(np.median(half_turn(beside - np.arctan2(own[:, 1], own[:, 0]))))
    across = np.abs(normal[:, 1] * point[:, 0] - normal[:, 0] * point[:, 1])
    how = replace(generation_of(member, flank), side=SIDES[other])
    sections = blade_sections(sharp_edged(other_side(member, flank, width)), SIDES[other])
    least = math.inf
    for part in ("main", "edge"):
        section = sections[part]
        swept = solve_section(how, section, point[:, 2], around)
        there = swept.converged & (section.lower <= swept.contact[:, 0]) & (swept.contact[:, 0] <= section.upper)
        there &= across > _FLAT * around
        if there.any():
            at = np.arctan2(swept.point[there, 1], swept.point[there, 0])
            least = min(least, float(np.min(sense * half_turn(beside[there] - at) * across[there])))
    return least
