"""Whether two flanks leave a tooth, and two members a pair."""

from __future__ import annotations

import math

import numpy as np

from gearmath.bevel.check_blade import tip_taken
from gearmath.bevel.check_blank import transverse_module, working_depth
from gearmath.bevel.check_flank import CutFlank
from gearmath.bevel.misfit import Misfit
from gearmath.bevel.root import ENDS, PLACES, Widths, slot_widths
from gearmath.bevel.tooth import mean_pitch_radius
from gearmath.bevel.turning import half_turn
from gearmath.errors import InputError
from gearmath.specs.bevel_set import FLANKS, SIDES, Member

#: Normal thickness and space width at the mean point over the normal module: pi together, and some of it each. Pairs
#: of ISO 23509 have 1.0 to 2.1, more or less where the profile shift of a ratio of 1 to 10 is added to.
_LEAST_WIDTH = 0.8
#: Working depth over normal module.
_DEPTH = (1.2, 2.6)
#: Differences at the mean point [degree]: of the spiral angles of both flanks of a member, which taper, ...
_TAPER = 4.0
#: ... and of mating flanks, which touch there. Of spiral angles, so much for what both pairs of flanks have in common,
#: and so much for what they have oppositely, beyond what a cut of both flanks at once explains; of pressure angles so
#: much for each pair of flanks. The limits are at least twice what the bundled sets have: 0.54 degree of pressure angle
#: (NASA CR-191009), 0.23 and 0.05 of spiral angle.
_SPIRAL = (0.5, 0.5)
_PRESSURE = 1.1
#: Transverse backlash at the mean point over the module: 0.02 to 0.08 are usual, the finer the pitch the more.
BACKLASH = (0.0, 0.12)
#: Part of the module by which a pair without backlash may seem to clamp: rounding of its settings.
_ROUNDED = 1e-6

CutFlanks = dict[str, CutFlank]


def check_space(member: Member, cut: CutFlanks) -> float:
    """The transverse width [mm] of space 0 at the mean point.

    Raises InputError where concave and convex flank bound no space, or leave no tooth between two spaces.
    """
    concave, convex = (cut[flank] for flank in FLANKS)
    if concave.across == convex.across:
        raise InputError(
            f"{member.name}: the outward normals of both flanks point the same way around the axis: no space"
        )
    spirals = [math.degrees(flank.spiral_angle) for flank in (concave, convex)]
    if abs(spirals[0] - spirals[1]) > _TAPER:
        raise Misfit(
            f"{member.name} concave flank: spiral angle {spirals[0]:+.4g} degrees at the mean point, the convex flank "
            f"has {spirals[1]:+.4g}; they must agree within {_TAPER:g}",
            *((member.name, flank) for flank in FLANKS),
        )
    radius, pitch = mean_pitch_radius(member), 2 * math.pi / member.teeth
    # from the concave flank across the space: less than nothing is a tooth, more than a pitch a tooth and two spaces
    turn = concave.across * math.remainder(convex.azimuth - concave.azimuth, 2 * math.pi)
    cosine = math.cos((concave.spiral_angle + convex.spiral_angle) / 2)
    module = transverse_module(member) * cosine
    space, tooth = radius * turn * cosine, radius * (pitch - turn) * cosine
    least = _LEAST_WIDTH * module
    if not (space >= least and tooth >= least):
        raise InputError(
            f"{member.name}: {_phase(member)} leave a space of {space:.4g} mm and a tooth of {tooth:.4g} mm (normal, "
            f"at the mean point), each must be at least {least:.3g} "
            f"mm{_hint(member, turn, pitch, least / radius / cosine)}"
        )
    depth = working_depth(member.blank)
    if not _DEPTH[0] * module <= depth <= _DEPTH[1] * module:
        raise InputError(
            f"{member.name}.blank.mean_addendum = {member.blank.mean_addendum:g}: the working depth of {depth:.4g} mm "
            f"must lie between {_DEPTH[0] * module:.4g} and {_DEPTH[1] * module:.4g} mm: mean normal module "
            f"{module:.4g}"
        )
    _check_top_land(member, concave, convex, pitch)
    _check_root(member, concave, convex)
    return radius * turn


def _phase(member: Member) -> str:
    """The settings that the width of a space hangs on, with their values."""
    key = "blade_point_radius" if member.cutting == "completing" else "work_rotation_offset"
    return ", ".join(f"{flank}.{key} = {getattr(member.flank(flank).nominal, key):g}" for flank in FLANKS)


def _hint(member: Member, turn: float, pitch: float, least: float) -> str:
    """What to do where the flanks are those of a space, but of two different ones."""
    inside = turn % pitch
    if member.cutting == "completing" or not least <= inside <= pitch - least:
        return ""
    return (
        "; as it stands they do not bound one space: the convex flank must be turned by "
        f"{abs(round((turn - inside) / pitch)) * math.degrees(pitch):g} degrees, whole pitches"
    )


def _check_top_land(member: Member, concave: CutFlank, convex: CutFlank, pitch: float) -> None:
    turns = concave.across * (convex.tip_azimuth - concave.tip_azimuth)
    land = pitch - half_turn(turns)
    if not (land > 0).all():
        k = int(np.argmin(land))
        raise InputError(
            f"{member.name}: {_phase(member)}, blank.mean_addendum = {member.blank.mean_addendum:g}, blank.face_angle "
            f"= {member.blank.face_angle:g}: the teeth are pointed at the {PLACES[k]}: a top land of "
            f"{math.degrees(land[k]):.3g} degrees about the axis is left, which must be above 0"
        )


def _check_root(member: Member, concave: CutFlank, convex: CutFlank) -> None:
    """The space is open down to its root, and wide enough there for a cutter of a stated point width."""
    azimuth = [np.arctan2(flank.root[:, 1], flank.root[:, 0])[list(ENDS)] for flank in (concave, convex)]
    turn = half_turn(concave.across * (azimuth[1] - azimuth[0]))
    k = int(np.argmin(turn))
    if not turn[k] > 0:
        crossed = float(np.hypot(*concave.root[ENDS[k], :2]) * turn[k])
        raise InputError(
            f"{member.name}: {_phase(member)}: the flanks cross above the root at the {PLACES[k]}: a root of "
            f"{crossed:.3g} mm is left between them, which must be above 0"
        )
    if member.cutting == "completing":
        return  # the blades of one cutter leave the root, and have their own check
    taken = {flank: tip_taken(member.flank(flank), SIDES[flank]) for flank in FLANKS}
    flank = max(FLANKS, key=lambda one: taken[one])
    stated = {one for one in FLANKS if member.flank(one).blade_point_width is not None}
    slots = {
        one: slot_widths(member, one, own.by.how, own.contact, own.root, other.root)
        for one, own, other in (("concave", concave, convex), ("convex", convex, concave))
        if one in stated or (one == flank and taken[flank] > 0)  # a slot takes as long as the rest of the check
    }
    if flank in slots and sum(taken.values()) > slots[flank].least:
        raise InputError(
            f"{member.name}.{flank}.blade_edge_radius = {member.flank(flank).blade_edge_radius:g}: the rounded edges "
            f"of both flanks take {sum(taken.values()):.3g} mm of the slot, which is {slots[flank].least:.3g} mm wide "
            f"at the {slots[flank].narrow_place}"
        )
    _check_cutters(member, slots)


def _check_cutters(member: Member, slots: dict[str, Widths]) -> None:
    """Cutters for one flank pass through the slot, and leave no fin between them."""
    stated = {flank: member.flank(flank).blade_point_width for flank in FLANKS}
    for flank, own in stated.items():
        if own is None:
            continue
        slot, other = slots[flank], stated[FLANKS[1 - FLANKS.index(flank)]]
        if own > slot.least:
            raise InputError(
                f"{member.name}.{flank}.blade_point_width = {own:g}: the slot is {slot.least:.3g} mm wide at the "
                f"{slot.narrow_place}, the cutter must be no wider"
            )
        if own < slot.most - (slot.least if other is None else other):
            beside = f"at most {slot.least:.3g}" if other is None else f"{other:g}"
            raise InputError(
                f"{member.name}.{flank}.blade_point_width = {own:g}: with {beside} mm of the cutter of the other flank "
                f"a fin would stay between both cuts, as the slot is {slot.most:.3g} mm wide at the {slot.wide_place}, "
                "which both together must be at least"
            )


def _seen(cut: dict[str, CutFlanks], name: str, flank: str, key: str) -> float:
    """An angle [degree] at the mean point, that of a spiral as the pinion sees it: mates are of opposite hand."""
    angle = math.degrees(getattr(cut[name][flank], key))
    return -angle if key == "spiral_angle" and name == "gear" else angle


def _mating_angles(cut: dict[str, CutFlanks], key: str) -> str:
    """The angles of both pairs of mating flanks in words."""
    pairs = [
        f"{_seen(cut, 'pinion', flank, key):.4g} and {_seen(cut, 'gear', mating, key):.4g} degrees on pinion {flank} "
        f"with gear {mating}"
        for flank, mating in zip(FLANKS, reversed(FLANKS), strict=True)
    ]
    return f"{key.replace('_', ' ')} at the mean point {', '.join(pairs)}"


def _given_by_one_cut(member: Member, cut: dict[str, CutFlanks]) -> float:
    """What a cut of both flanks at once gives to the spiral angles [degree] of its flanks oppositely, by its point
    width: half of what that of the concave flank is larger by."""
    if member.cutting != "completing":
        return 0.0
    concave, convex = (_seen(cut, member.name, flank, "spiral_angle") for flank in FLANKS)
    return (concave - convex) / 2


def _apart(cut: dict[str, CutFlanks], key: str) -> list[float]:
    """What the mates of both pairs of flanks differ by in an angle [degree], pinion less gear."""
    pairs = zip(FLANKS, reversed(FLANKS), strict=True)
    return [_seen(cut, "pinion", flank, key) - _seen(cut, "gear", mating, key) for flank, mating in pairs]


def _between(given: float, limit: float) -> tuple[float, float]:
    return min(given, 0.0) - limit, max(given, 0.0) + limit


def _width_hangs_on(members: dict[str, Member], spaces: dict[str, float], pitch: float) -> str:
    """How wide the spaces are, and what else makes them so: not only the settings that are meant for it."""
    widths = " and ".join(f"{name} {width:.4g} mm" for name, width in spaces.items())
    others = ["blade_point_radius", "radial_distance", "sliding_base"]
    if any(member.cutting == "fixed_setting" for member in members.values()):
        # the roll makes of it the same turn of the work
        others.insert(0, "a cradle_angle of one flank of a fixed-setting cut, which acts as work_rotation_offset does")
    return (
        f"spaces of {widths} of a pitch of {pitch:.4g} mm; they hang as well on {', '.join(others)}: compare these too"
    )


def check_mates(
    members: dict[str, Member], cut: dict[str, CutFlanks], spaces: dict[str, float], share: float = 1.0
) -> None:
    """Refuse flanks that do not touch as mates at the mean point, and a pair with too much or too little backlash.

    The spiral angles of both flanks of a pair are judged together: half the sum of what mates differ by is an error of
    a member, half the difference an opposite error of its flanks. Between perfect mates and the plain crown gear, which
    leaves as it is what a cut of both flanks at once does to them, any difference may be designed. ``share`` is the
    part of the limits of the angles that may be used.
    """
    apart = dict(zip(FLANKS, _apart(cut, "pressure_angle"), strict=True))
    wrong = {flank: found for flank, found in apart.items() if not abs(found) <= share * _PRESSURE}
    if wrong:
        flank = max(wrong, key=lambda one: abs(wrong[one]))
        mating = {one: FLANKS[1 - FLANKS.index(one)] for one in wrong}
        raise Misfit(
            f"pinion and gear: {_mating_angles(cut, 'pressure_angle')}: pinion {flank} and gear {mating[flank]} differ "
            f"by {wrong[flank]:+.3g} degrees, which must be at most {share * _PRESSURE:.3g}",
            *(("pinion", one) for one in wrong),
            *(("gear", one) for one in mating.values()),
        )
    first, second = _apart(cut, "spiral_angle")
    common, opposite = (first + second) / 2, (first - second) / 2
    given = sum(_given_by_one_cut(member, cut) for name, member in members.items())
    for found, low, high, what in (
        (common, *_between(0.0, share * _SPIRAL[0]), "on both"),
        (opposite, *_between(given, share * _SPIRAL[1]), "on the first and by as much the other way on the second"),
    ):
        if not low <= found <= high:
            raise Misfit(
                f"pinion and gear: {_mating_angles(cut, 'spiral_angle')}: mates differ by {found:+.3g} degrees {what}, "
                f"which must lie between {low:.3g} and {high:.3g}",
                *((name, flank) for name in members for flank in FLANKS),
            )
    gear = members["gear"]
    pitch = 2 * math.pi * mean_pitch_radius(gear) / gear.teeth
    backlash, module = spaces["pinion"] + spaces["gear"] - pitch, transverse_module(gear)
    if not (BACKLASH[0] - _ROUNDED) * module <= backlash <= BACKLASH[1] * module:
        settings = "; ".join(f"{name} {_phase(member)}" for name, member in members.items())
        raise InputError(
            f"pinion and gear: {settings}: the pair has a transverse backlash of {backlash:.4g} mm at the mean point, "
            f"which must lie between {BACKLASH[0] * module:.3g} and {BACKLASH[1] * module:.3g} mm, {BACKLASH[0]:g} "
            f"and {BACKLASH[1]:g} of the module; {_width_hangs_on(members, spaces, pitch)}"
        )
