"""Point widths of fixed-setting cutters whose far side would cut into the flank or fillet that the other cutter makes.

Both flanks have settings of their own, so the far side of a cutter does not run along the other flank. A point that is
chosen for the slot alone, as ``bevel.ridge`` does, may be some tenths of a millimetre too wide towards toe and heel.
The tip of a tilted cutter leans across the space, and what it reaches too deep at one end may be the other fillet.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from gearmath.bevel.check_blade import tip_taken
from gearmath.bevel.generation import solve_section
from gearmath.bevel.method import blade_sections, generation_of
from gearmath.bevel.ridge import edge_taken, far_edge, opposite, other_side, point_width
from gearmath.bevel.root import ENDS, cone_distances, root_height
from gearmath.bevel.tooth import ToothSpace, sharp_edged, tooth_space
from gearmath.bevel.turning import half_turn
from gearmath.errors import InputError
from gearmath.specs.bevel_set import FLANKS, SIDES, Member

#: The far side stays off the other flank by so much [mm]; widths are taken down to this step [mm].
_OFF, _STEP = 0.01, 0.01
#: What a far side cuts is worth a word from here on [mm]. Both cutters touch the root, so that into a fillet a chosen
#: width may cut half of that.
_GOUGE = 1e-3
_TOUCH = _GOUGE / 2
#: A line that meets a normal of the fillet farther from it than this [mm] is not beside it.
_NEAR = 0.5
#: Where the flank is flatter than this across the space it is the bottom of the fillet, which the tips share.
_FLAT = 0.2


def with_point_widths(member: Member) -> Member:
    """A member that is cut flank by flank, with point widths stated where those chosen for the slots are too wide.

    Raises InputError where no width is narrow enough.
    """
    try:
        space = tooth_space(member)
    except InputError:
        return member  # no tooth, of which the verdict says why
    found = {}
    for flank in FLANKS:
        widest = point_width(member, flank, space.slots[flank])
        width = _narrow_enough(member, flank, space, widest)
        if width is None:
            least = _least_width(member, flank)
            raise InputError(
                f"{member.name} {flank} flank: the far side of a cutter with a point width of {least:.3g} mm, the "
                f"least that its edges leave, {_cuts(member, flank, space, least, _OFF, 0.0)}, which must be at most "
                "0; smaller blade_edge_radius, another thickness_factor or cutting = 'completing' is needed"
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
        cuts = _cuts(member, flank, space, width)
        if not cuts:
            continue
        enough = _narrow_enough(member, flank, space, width)
        chosen = "" if member.flank(flank).blade_point_width is not None else ", chosen for the slot,"
        said.append(
            f"the far side of the {flank} flank's cutter of {width:.3f} mm point width{chosen} {cuts}: "
            "blade_point_width must be "
            + (f"at most {enough:.2f} mm" if enough is not None else "less than its edges leave")
        )
    return "; ".join(said)


def _cuts(
    member: Member, flank: str, space: ToothSpace, width: float, off: float = -_GOUGE, touch: float = -_GOUGE
) -> str:
    """What the far side of a cutter of a point width cuts, where it is nearer than ``off`` [mm] to the flank or than
    ``touch`` [mm] to the fillet."""
    missing = off - room(member, flank, space, width), touch - fillet_room(member, flank, width)
    if max(missing) <= 0:
        return ""
    what, deep = ("flank", missing[0]) if missing[0] > 0 else ("fillet", missing[1])
    return f"cuts {1000 * (deep - min(off, touch, 0.0)):.0f} um into the {opposite(flank)} {what}"


def _narrow_enough(member: Member, flank: str, space: ToothSpace, width: float) -> float | None:
    """The point width [mm], or the widest narrower one in steps whose far side stays off the other flank and its
    fillet; None where none does."""

    def off(tried: float) -> bool:
        return room(member, flank, space, tried) >= _OFF and fillet_room(member, flank, tried) >= -_TOUCH

    if off(width):
        return width
    low, high = math.ceil(_least_width(member, flank) / _STEP), math.floor(width / _STEP)
    if high < low or not off(low * _STEP):
        return None
    while high - low > 1:
        middle = (low + high) // 2
        low, high = (middle, high) if off(middle * _STEP) else (low, middle)
    return low * _STEP


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


def fillet_room(member: Member, flank: str, width: float) -> float:
    """The least distance [mm] of the other flank's fillet from what the far edge of a cutter of that point width and
    its tip leave, square to the fillet in sections from toe to heel; negative where they cut into it.

    The tip leaves a line between the far edge and the flank's own fillet, to a few thousandths of its rise.
    """
    places = slice(ENDS[0], ENDS[-1] + 1)
    space = tooth_space(member, ENDS[-1] - ENDS[0] + 1)
    surfaces = {surface.flank: surface for surface in (space.concave, space.convex)}
    own, other = surfaces[flank], surfaces[opposite(flank)]
    first = other.section.index("edge") - 1
    fillet, ends = _section(member, other.point[first:]), _section(member, own.point[-1:])
    angle, up = (part[:, places] for part in far_edge(member, flank, width))
    least = math.inf
    for k in range(fillet[0].shape[1]):
        around = np.hypot(*own.point[-1, k, :2])
        there = np.isfinite(angle[:, k])
        sense = np.sign(half_turn(fillet[0][-1, k] - ends[0][0, k]))
        left = around * sense * half_turn(np.append(ends[0][0, k], angle[there, k]) - ends[0][0, k])
        line = np.column_stack([left, np.append(ends[1][0, k], up[there, k])])
        edge = np.column_stack([around * sense * half_turn(fillet[0][:, k] - ends[0][0, k]), fillet[1][:, k]])
        least = min(least, _off(edge, line))
    return least


def _section(member: Member, point: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Angles about the axis [rad] and heights over the root [mm] of rows of points at the places from toe to heel."""
    along, up = cone_distances(member.blank)[0]
    around = np.hypot(point[..., 0], point[..., 1])
    root = root_height(member.blank)[ENDS[0] : ENDS[-1] + 1]
    return np.arctan2(point[..., 1], point[..., 0]), along * around - up * point[..., 2] - root


def _off(edge: np.ndarray, line: np.ndarray) -> float:
    """The least way [mm] from the points (n,2) of a fillet, from the flank down to the root, along its normals to a
    line (m,2) that comes from the other side; infinite where none meets it."""
    tangent = np.gradient(edge, axis=0)
    normal = np.column_stack([tangent[:, 1], -tangent[:, 0]]) / np.linalg.norm(tangent, axis=1)[:, None]
    start, step = line[:-1], np.diff(line, axis=0)
    across = normal[:, None, 0] * step[:, 1] - normal[:, None, 1] * step[:, 0]
    between = start - edge[:, None]
    with np.errstate(divide="ignore", invalid="ignore"):
        way = (between[..., 0] * step[:, 1] - between[..., 1] * step[:, 0]) / across
        part = (between[..., 0] * normal[:, None, 1] - between[..., 1] * normal[:, None, 0]) / across
    met = (part >= 0) & (part <= 1) & (np.abs(way) < _NEAR)
    return float(np.min(way[met], initial=math.inf))
