"""Whether the blanks of a set file can be: of one member by itself, and of the pair.

Lengths in the wrong unit, angles in radians, a swapped or a misprinted figure contradict the other figures of a blank
or those of the mate. The limits leave room for what is printed rounded, and for any depth that is cut.
"""

from __future__ import annotations

import math

from derivations import notation
from gearmath.bevel.blank import WIDEST_FACE, evaluate
from gearmath.errors import InputError
from gearmath.specs.bevel_set import Blank, Member

#: Pitch angles are printed in whole minutes of arc, and may be cut off instead of rounded. [degree]
_PRINTED_ANGLE = 0.02
#: What lengths common to both members, or that add up, may differ by: of themselves, and of the module.
_PRINTED_LENGTH, _PRINTED_DEPTH = 0.001, 0.02
#: Face widths of mates may differ by so much of the wider one.
_WIDER_FACE = 0.1
#: Root of one member and tip of the mate are parallel, so that the clearance is the same along the tooth. [degree]
_PARALLEL = 0.5
#: Least part of the outer cone distance that a face width takes; the most is that of blanks that are designed.
NARROWEST_FACE = 0.1
#: Clearance over working depth; ISO 23509 has 0.125.
_CLEARANCE = (0.04, 0.35)
#: Working depth over mean transverse module, for normal depth factors of 1.2 to 2.6 and spiral angles up to 50 degrees.
_DEPTH = (0.75, 2.6)

#: More teeth no member of a set may have.
_MOST_TEETH = 400
_MATES = (("pinion", "gear"), ("gear", "pinion"))


def transverse_module(member: Member) -> float:
    """Transverse module [mm] at the mean point."""
    blank = member.blank
    return 2 * blank.mean_cone_distance * math.sin(blank.delta) / member.teeth


def working_depth(blank: Blank) -> float:
    """What of the depth [mm] the mate reaches into, at the mean point."""
    return blank.mean_addendum + blank.mean_dedendum - blank.clearance


def check_blank(member: Member) -> None:
    """Refuse a blank that contradicts itself. Raises InputError naming member, key, value and limit."""
    blank, table = member.blank, f"{member.name}.blank"
    narrowest, widest = (share * blank.mean_cone_distance / (1 - share / 2) for share in (NARROWEST_FACE, WIDEST_FACE))
    if not narrowest <= blank.face_width <= widest:
        raise InputError(
            f"{table}.face_width = {blank.face_width:g}: must lie between {narrowest:.4g} and {widest:.4g} mm, "
            f"{NARROWEST_FACE:g} and {WIDEST_FACE:g} of the outer cone distance, at a mean_cone_distance of "
            f"{blank.mean_cone_distance:g}"
        )
    module, depth = transverse_module(member), working_depth(blank)
    if not _DEPTH[0] * module <= depth <= _DEPTH[1] * module:
        raise InputError(
            f"{table}.mean_addendum = {blank.mean_addendum:g}, mean_dedendum = {blank.mean_dedendum:g}: less the "
            f"clearance they make a working depth of {depth:.4g} mm, which must lie between {_DEPTH[0] * module:.4g} "
            f"and {_DEPTH[1] * module:.4g} mm: teeth = {member.teeth} at mean_cone_distance = "
            f"{blank.mean_cone_distance:g} have the module {module:.4g}"
        )
    if not _CLEARANCE[0] * depth <= blank.clearance <= _CLEARANCE[1] * depth:
        raise InputError(
            f"{table}.clearance = {blank.clearance:g}: must lie between {_CLEARANCE[0] * depth:.3g} and "
            f"{_CLEARANCE[1] * depth:.3g} mm, {_CLEARANCE[0]:g} and {_CLEARANCE[1]:g} of the working depth"
        )
    ends = evaluate("blank_ends", {"blank": blank.vector})
    for place, word in (("inner", "toe"), ("outer", "heel")):
        for angle, height, least in (("face_angle", "addendum", 0.0), ("root_angle", "dedendum", blank.clearance)):
            if not ends[f"{place}_{height}"] > least:
                raise InputError(
                    f"{table}.{angle} = {getattr(blank, angle):g}: with mean_{height} = "
                    f"{getattr(blank, f'mean_{height}'):g} it leaves a{'n' * (height == 'addendum')} {height} of "
                    f"{ends[f'{place}_{height}']:.4g} mm at the {word}, which must be above {least:g} mm"
                )


def check_blanks(pinion: Member, gear: Member, shaft_angle: float) -> None:
    """Refuse blanks that do not belong together. Raises InputError naming member, key, value and limit."""
    members = {"pinion": pinion, "gear": gear}
    for key, share in (("mean_cone_distance", _PRINTED_LENGTH), ("face_width", _WIDER_FACE)):
        one, two = (getattr(member.blank, key) for member in members.values())
        if abs(one - two) > share * max(one, two):
            raise InputError(
                f"pinion.blank.{key} = {one:g}: the gear has {two:g}; they must agree within "
                f"{share * max(one, two):.3g} mm"
            )
    allowed = _PRINTED_DEPTH * transverse_module(gear)
    _check_apexes(pinion, gear, allowed)
    for name, other in _MATES:
        own, mate = members[name].blank, members[other].blank
        needed = mate.mean_addendum + own.clearance
        if abs(own.mean_dedendum - needed) > allowed:
            raise InputError(
                f"{name}.blank.mean_dedendum = {own.mean_dedendum:g}: must be the mean_addendum of the {other}, "
                f"{mate.mean_addendum:g}, and the own clearance, {own.clearance:g}, within {allowed:.2g} mm"
            )
        parallel = shaft_angle - mate.face_angle
        if abs(own.root_angle - parallel) > _PARALLEL:
            raise InputError(
                f"{name}.blank.root_angle = {own.root_angle:g}: with shaft_angle = {shaft_angle:g} and the face_angle "
                f"of the {other}, {mate.face_angle:g}, it must be {parallel:.5g} within {_PARALLEL:g} degree, or the "
                "clearance is not the same along the tooth"
            )


def _check_apexes(pinion: Member, gear: Member, allowed: float) -> None:
    """Pitch cones touch: what an apex beyond the crossing point puts one of them into the other by, the other gives."""
    given = {name: member.blank for name, member in (("pinion", pinion), ("gear", gear))}
    into = {name: blank.pitch_apex_beyond_crossing_point * math.sin(blank.delta) for name, blank in given.items()}
    if not abs(sum(into.values())) <= allowed:
        name = max(into, key=lambda one: abs(into[one]))
        other = "gear" if name == "pinion" else "pinion"
        raise InputError(
            f"{name}.blank.pitch_apex_beyond_crossing_point = {given[name].pitch_apex_beyond_crossing_point:g}: with "
            f"{given[other].pitch_apex_beyond_crossing_point:g} of the {other} the pitch cones lie "
            f"{abs(sum(into.values())):.3g} mm {'in each other' if sum(into.values()) > 0 else 'apart'}, which must be "
            f"at most {allowed:.2g} mm"
        )


def check_cones(pinion: Member, gear: Member, shaft_angle: float) -> None:
    """Refuse pitch cones that do not roll on each other (11.1). Raises InputError naming member, key, value, limit."""
    if pinion.teeth > gear.teeth:
        raise InputError(
            f"pinion.teeth = {pinion.teeth}: the pinion is the member with fewer teeth, it must be at most gear.teeth "
            f"= {gear.teeth}"
        )
    wanted = _pitch_angles(pinion.teeth, gear.teeth, shaft_angle)
    for name, member, angle in zip(("pinion", "gear"), (pinion, gear), wanted, strict=True):
        if not abs(member.blank.pitch_angle - angle) <= _PRINTED_ANGLE:
            raise InputError(
                f"{name}.blank.pitch_angle = {member.blank.pitch_angle:g}: {pinion.teeth} and {gear.teeth} teeth at "
                f"shaft_angle = {shaft_angle:g} need {angle:.5g} within {_PRINTED_ANGLE:g} degree"
            )


def check_mate(member: Member, shaft_angle: float) -> None:
    """Refuse a member without its mate whose pitch cone rolls on that of no whole number of teeth (11.1).

    Raises InputError naming member, key, value and the nearest that would do.
    """
    own, given = ("pinion", "gear").index(member.name), member.blank.pitch_angle

    def angle(mate: int) -> float:
        pair = (member.teeth, mate) if own == 0 else (mate, member.teeth)
        return _pitch_angles(*pair, shaft_angle)[own]

    low, high = (member.teeth, _MOST_TEETH) if own == 0 else (1, member.teeth)
    while high - low > 1:  # the more teeth the mate has, the smaller is the own pitch angle
        middle = (low + high) // 2
        low, high = (middle, high) if angle(middle) >= given else (low, middle)
    nearest = min((low, high), key=lambda mate: abs(angle(mate) - given))
    if not abs(angle(nearest) - given) <= _PRINTED_ANGLE:
        raise InputError(
            f"{member.name}.blank.pitch_angle = {given:g}: fits no mate, {member.teeth} teeth at shaft_angle = "
            f"{shaft_angle:g} and a mate of {nearest} need {angle(nearest):.5g} within {_PRINTED_ANGLE:g} degree"
        )


def _pitch_angles(pinion_teeth: int, gear_teeth: int, shaft_angle: float) -> list[float]:
    """Pitch angles [degree] of pinion and gear."""
    values = {
        "shaft_angle": math.radians(shaft_angle),
        "pinion_teeth": pinion_teeth,
        "wheel_teeth": gear_teeth,
        # sizes are not asked for
        "wheel_outer_pitch_diameter": 2.0,
        "face_width": 0.0,
        "mean_spiral_angle": 0.0,
    }
    cones = evaluate("pitch_cones", values)
    return [math.degrees(cones[f"{name}_{notation.pitch_angle.name}"]) for name in ("pinion", "wheel")]
