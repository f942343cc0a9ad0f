"""The point width of a cutter for one flank, and the ridge that two such cuts leave between them in the root.

The tip of a cutter is flat between its rounded edges only: where the flats of both cuts do not meet, the edges on their
far sides leave a ridge, though both point widths together may be more than the slot.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from gearmath.bevel.check_blade import tip_taken
from gearmath.bevel.generation import solve_curve
from gearmath.bevel.method import blade_sections, nominal_cut
from gearmath.bevel.root import ACROSS, ENDS, Widths, above_root, cone_distances, mean_place, root_trace
from gearmath.bevel.tip_room import corner_wall, tip_lengths
from gearmath.bevel.tooth import ToothSpace, sharp_edged
from gearmath.bevel.turning import half_turn
from gearmath.specs.bevel_set import FLANKS, SIDES, Flank, Member

#: The flat of a tip of which no point width is stated, as a part of the slot at its widest: more than half, so that the
#: flats of both cuts overlap; and the most of the slot at its narrowest that the point may fill. [1]
FLAT_SHARE, MOST_OF_SLOT = 0.55, 0.95
#: A ridge as high as this [mm] is worth a word.
RIDGE = 1e-3
#: Points of the arc of a rounded edge: the chords between them are within 0.03 % of its radius.
_ARC = 33
_FINE = 2000


def point_width(member: Member, flank: str, slot: Widths) -> float:
    """Point width [mm] of a fixed-setting cutter: as stated, or chosen for the ``slot`` of its flank.

    Chosen, the flat of its tip is ``FLAT_SHARE`` of the slot at its widest, so that two such cuts leave no ridge; but
    the point is never wider than ``MOST_OF_SLOT`` of the slot at its narrowest: :func:`ridge` says what then stays.
    """
    stated = member.flank(flank).blade_point_width
    if stated is not None:
        return stated
    return min(FLAT_SHARE * slot.most + edge_taken(member, flank), MOST_OF_SLOT * slot.least)


def edge_taken(member: Member, flank: str) -> float:
    """What the rounded edge takes of the tip [mm] on the side of a cutter that cuts no flank."""
    return tip_taken(other_side(member, flank, 0.0), SIDES[opposite(flank)])


def opposite(flank: str) -> str:
    """The other flank of a member."""
    return FLANKS[1 - FLANKS.index(flank)]


def other_side(member: Member, flank: str, width: float) -> Flank:
    """The blade on the side of a cutter of that point width [mm] that cuts no flank: of the angle of the other flank's
    blade, rounded like its own."""
    spec = member.flank(flank)
    return spec.model_copy(
        update={
            "blade_point_radius": spec.blade_point_radius - SIDES[flank] * width,
            "blade_pressure_angle": member.flank(opposite(flank)).blade_pressure_angle,
            "blade_spheric_radius": None,
            "toprem_angle": None,
            "toprem_height": 0.0,
            "design": None,
        }
    )


def ridge(member: Member, space: ToothSpace | None) -> float:
    """Height [mm] over the root beside it of the highest ridge between the cuts of both flanks, from toe to heel.

    0 where the flats of both tips meet, and where one milling cutter cuts both flanks; infinite where what the tips
    end in does not meet either, and a fin stays. ``space`` is the nominal space of a member that is cut flank by flank,
    for which point widths are chosen.
    """
    if member.process == "face_hobbing":
        return ridge_of_tips(member)
    if member.cutting != "fixed_setting" or space is None:
        return 0.0
    uncorrected = {flank: member.flank(flank).model_copy(update={"design": None}) for flank in FLANKS}
    as_cut = member.model_copy(update=uncorrected)
    edges = {flank: far_edge(as_cut, flank, point_width(member, flank, space.slots[flank])) for flank in FLANKS}
    return _highest(edges)


def ridge_of_tips(member: Member) -> float:
    """The same of a face hobbed member: between what the ends of outer and inner tips leave."""
    nominal = {flank: member.flank(flank).model_copy(update={"design": None}) for flank in FLANKS}
    as_cut = member.model_copy(update={flank: sharp_edged(spec) for flank, spec in nominal.items()})
    lengths = tip_lengths(as_cut)
    return _highest({flank: corner_wall(as_cut, flank, lengths[flank]) for flank in FLANKS})


def _highest(edges: dict[str, tuple[np.ndarray, np.ndarray]]) -> float:
    """The highest ridge of all places from toe to heel."""
    highest = 0.0
    for place in range(ENDS[0], ENDS[-1] + 1):
        (one, other), (up, up_other) = ([edges[flank][kind][:, place] for flank in FLANKS] for kind in (0, 1))
        highest = max(highest, _between(one, up, other, up_other))
    return highest


def ridge_words(height: float) -> str:
    """A ridge in words."""
    if not math.isfinite(height):
        return "a fin stays between the cuts of both flanks: the rounded edges of their cutters do not meet"
    return f"a ridge of up to {height * 1000:.1f} um stays between the cuts of both flanks"


def _between(one: np.ndarray, up: np.ndarray, other: np.ndarray, up_other: np.ndarray) -> float:
    """Ridge between two profiles, angles about the axis and heights of each from its lowest point upwards."""
    found = np.isfinite(one + up), np.isfinite(other + up_other)
    one, up, other, up_other = one[found[0]], up[found[0]], other[found[1]], up_other[found[1]]
    sense = np.sign(half_turn(one[-1] - one[0]))
    across, across_other = sense * half_turn(one - one[0]), sense * half_turn(other - one[0])
    if across_other[0] <= 0.0:
        return 0.0  # the flats meet
    at = np.linspace(0.0, across_other[0], _FINE)
    left = np.interp(at, across, up, right=math.inf)
    left_by_other = np.interp(-at, -across_other, up_other, right=math.inf)
    return float(np.minimum(left, left_by_other).max() - max(up[0], up_other[0]))


def far_edge(member: Member, flank: str, width: float) -> tuple[np.ndarray, np.ndarray]:
    """Angles about the axis [rad] and heights over the root [mm] (rows, 13) of what the rounded edge on the far side
    of a cutter leaves, its lowest point first, at the places ``ACROSS``; NaN where it leaves nothing."""
    by, far = nominal_cut(member, flank), SIDES[opposite(flank)]
    edge = blade_sections(sharp_edged(other_side(member, flank, width)), far)["edge"]
    assert edge.arc is not None
    start = by.at(*mean_place(member)).contact
    lowest = root_trace(
        member, flank, by.how, start, SIDES[flank] * (member.flank(flank).blade_point_radius - edge.arc[0])
    )
    angles = np.linspace(edge.upper, edge.lower, _ARC)
    u, places = (part.ravel() for part in np.meshgrid(angles, np.arange(len(ACROSS)), indexing="ij"))
    direction, distance = cone_distances(member.blank)
    begin = np.column_stack([u, lowest.contact[places, 1:]])
    found = solve_curve(replace(by.how, side=far), edge, u, direction, distance[places], begin)
    point = np.where(found.converged[:, None], found.point, np.nan).reshape(_ARC, len(ACROSS), 3)
    return np.arctan2(point[..., 1], point[..., 0]), np.stack([above_root(member, row) for row in point])
