"""The dimensions of a member as a drawing has them: from the blank, and from the flanks that its settings cut."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

from gearmath.bevel.blank import evaluate
from gearmath.bevel.check_blank import transverse_module
from gearmath.bevel.check_flank import cut_flank
from gearmath.bevel.design.verdict import top_land
from gearmath.bevel.method import nominal_cut
from gearmath.bevel.tooth import mean_tooth_thickness
from gearmath.specs.bevel_set import FLANKS, Member


@dataclass(frozen=True)
class Dimension:
    """A figure of a drawing: a length [mm] or an angle [rad]."""

    label: str
    value: float
    kind: Literal["length", "angle"] = "length"


def dimensions(member: Member) -> list[Dimension]:
    """What a drawing of a member states, beside the cone angles. Raises InputError where the flanks cannot be cut."""
    blank, ends = member.blank, evaluate("blank_ends", {"blank": member.blank.vector})
    mean, sine = transverse_module(member), math.sin(blank.delta)
    cuts = {flank: cut_flank(member, flank, nominal_cut(member, flank)) for flank in FLANKS}
    spiral = sum(abs(cut.spiral_angle) for cut in cuts.values()) / len(cuts)
    heel = blank.mean_cone_distance + blank.face_width / 2
    thickness = mean_tooth_thickness(member)
    return [
        Dimension("outer transverse module", 2 * heel * sine / member.teeth),
        Dimension("mean normal module", mean * math.cos(spiral)),
        Dimension("mean spiral angle", spiral, "angle"),
        *(
            Dimension(f"normal pressure angle, {flank}", abs(cut.pressure_angle), "angle")
            for flank, cut in cuts.items()
        ),
        Dimension("outer cone distance", heel),
        Dimension("pitch diameter at the heel", ends["outer_pitch_diameter"]),
        Dimension("outside diameter", ends["outer_tip_diameter"]),
        Dimension("crossing point to crown", ends["crossing_point_to_crown"] - blank.pitch_apex_beyond_crossing_point),
        Dimension("whole depth at the heel", ends["outer_whole_depth"]),
        Dimension("whole depth at the mean point", blank.mean_addendum + blank.mean_dedendum),
        Dimension("mean transverse tooth thickness, arc", thickness),
        Dimension("mean normal tooth thickness, arc", thickness * math.cos(spiral)),
        *(Dimension(f"normal top land, {place}", land) for place, land in top_land(member).items()),
    ]
