"""Heights of the tips of a tilted hobbing cutter's blades: outer and inner blades meet at the root of the blank.

The tip plane of a tilted cutter leans across the space. In milling it leaves one root, which leans too; in face hobbing
the work turns between outer and inner blade, and each tip cuts a half of the root at a place of its own of that plane:
the halves would part by some tenths of a millimetre in the middle of the space.
"""

from __future__ import annotations

import numpy as np

from gearmath.bevel.design.rounding import to_step
from gearmath.bevel.method import nominal_cut
from gearmath.bevel.root import ENDS, above_root, mean_place, root_trace
from gearmath.bevel.tooth import space_widths
from gearmath.errors import ComputationError
from gearmath.specs.bevel_set import FLANKS, Member

#: Heights below this are left out [mm]; each trial is nearer by the cosine of the tilt.
_LEAST, _TRIALS = 1e-3, 3


def with_tip_heights(member: Member, step: float) -> Member:
    """The member, face hobbed, with tips that reach the root of the blank in the middle of the space, on the mean over
    the face width; heights in steps [mm]. Raises ComputationError where a tip does not reach the root.
    """
    if not member.concave.cutter_tilt:
        return member
    heights = {flank: member.flank(flank).blade_tip_height for flank in FLANKS}
    found = member
    for _ in range(_TRIALS):
        half = space_widths(found)[0].mean / 2
        for flank in FLANKS:
            heights[flank] -= float(_middle(found, flank, half).mean())
        found = _with(member, heights)
    stepped = {flank: to_step(height, step) for flank, height in heights.items()}
    return _with(member, {flank: height if abs(height) >= _LEAST else 0.0 for flank, height in stepped.items()})


def _middle(member: Member, flank: str, half: float) -> np.ndarray:
    """How high (9,) [mm] over the root of the blank the tip of a blade cuts, toe to heel, ``half`` off its corner."""
    by = nominal_cut(member, flank)
    trace = root_trace(member, flank, by.how, by.at(*mean_place(member)).contact, half)
    inside = slice(ENDS[0], ENDS[-1] + 1)
    if not trace.converged[inside].all():
        raise ComputationError(
            f"{member.name} {flank} flank: the tip of the blade does not reach the root from toe to heel"
        )
    return above_root(member, trace.point)[inside]


def _with(member: Member, heights: dict[str, float]) -> Member:
    """The member with these heights of its tips [mm]."""
    blades = {flank: member.flank(flank).model_copy(update={"blade_tip_height": heights[flank]}) for flank in FLANKS}
    return member.model_copy(update=blades)
