"""Edge radii of hobbing blades: the largest that leaves both tips room to cover the root from toe to heel."""

from __future__ import annotations

import math

from gearmath.bevel.design.start import TENTH
from gearmath.bevel.ridge import ridge_of_tips
from gearmath.specs.bevel_set import FLANKS, Member

#: Highest ridge that the tips may leave in the root, in parts of the clearance; and one that costs the mate nothing.
HIGHEST_RIDGE, _LOW = 0.5, 0.1
#: Tenths below which an edge leaves scallops of a micrometre in its fillet: only where the ridge would be too high.
_SHARP = 2


def with_edge(member: Member, radius: float) -> Member:
    """The member with an edge radius [mm] on the blades of both flanks."""
    edged = {flank: member.flank(flank).model_copy(update={"blade_edge_radius": radius}) for flank in FLANKS}
    return member.model_copy(update=edged)


def with_room_for_tips(member: Member) -> Member:
    """A hobbed member with the largest edge radius, in tenths of a millimetre and not above its own, with which its
    tips leave next to no ridge in the root, or else a sharper one with which the ridge is accepted."""
    best, lowest = member, math.inf
    for tenths in range(round(member.concave.blade_edge_radius / TENTH), 0, -1):
        tried = with_edge(member, tenths * TENTH)
        height = ridge_of_tips(tried)
        if height <= lowest:
            best, lowest = tried, height
        if lowest <= (_LOW if tenths > _SHARP else HIGHEST_RIDGE) * member.blank.clearance:
            break
    return best
