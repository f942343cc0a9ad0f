"""Whether the spaces of a member can be where its index corrections put them: the mate's teeth must fit into them."""

from __future__ import annotations

import math

import numpy as np

from gearmath.bevel.check_blank import transverse_module
from gearmath.bevel.check_mates import BACKLASH
from gearmath.bevel.tooth import mean_pitch_radius
from gearmath.errors import InputError
from gearmath.specs.bevel_set import Member

#: So many teeth of a spiral bevel gear are in mesh at once, at most.
_IN_MESH = 3
#: A pair with little or no backlash may be corrected too: by the least that is usual, over the module.
_LEAST = 0.02


def check_index(member: Member, backlash: float | None) -> None:
    """Refuse index corrections that move spaces apart by more than the backlash [mm] of the pair, transverse.

    Teeth of the mate that are in mesh at once stand evenly. They enter spaces that are wider by the backlash alone, so
    that these may differ by no more; None is a member without its mate, with the largest backlash that a set may have.
    """
    if not any(member.index_correction):
        return
    module = transverse_module(member)
    usual = BACKLASH[1] if backlash is None else _LEAST
    limit = max(backlash or 0.0, usual * module)
    moved = mean_pitch_radius(member) * member.rad("index_correction")
    beside = np.stack([np.roll(moved, -k) for k in range(min(_IN_MESH, len(moved)))])
    apart = np.ptp(beside, axis=0)
    first = int(np.argmax(apart))
    if apart[first] <= limit:
        return
    last = (first + len(beside) - 1) % member.teeth
    what = "the largest backlash of a set" if backlash is None else "the backlash of the pair"
    if backlash is not None and limit > backlash:
        what = f"{_LEAST:g} of the module, as the pair has a backlash of {backlash:.3g} mm"
    raise InputError(
        f"{member.name}.index_correction: the spaces {first} to {last} stand up to {apart[first]:.3g} mm apart from "
        f"where even teeth enter them ({math.degrees(apart[first] / mean_pitch_radius(member)):.3g} degrees), the "
        f"limit is {limit:.3g} mm, {what}: the mate would clamp"
    )
