"""Whether the blades of a member can be, and whether what its file says of them belongs to its method."""

from __future__ import annotations

import math

from gearmath.bevel.blank import evaluate
from gearmath.bevel.method import blade_sections
from gearmath.bevel.root import tip_radius
from gearmath.errors import InputError
from gearmath.specs.bevel_set import FLANKS, SIDES, Flank, Member

#: How far a hobbing blade may be turned from square to its path [degree]: it is so by the definition of ISO 23509, and
#: one blade group more or less turns it by some 1.3.
_SQUARE = 0.8
#: Height of the rounded edge over the clearance: beyond it the tip of the mate runs into the fillet. By AGMA 929 the
#: wheel of ISO 23509 sample 1 has room for 1.25.
_ROUND = 1.25
#: A Toprem relieves by so little of the pressure angle, and so near to the root: height over the clearance. [degree]
_TOPREM_ANGLE, _TOPREM = 12.0, 2.5


def check_blades(member: Member) -> None:
    """Refuse blades that do not fit together. Raises InputError naming member, flank, key, value and limit."""
    for flank in FLANKS:
        _check_method(member, f"{member.name}.{flank}", member.flank(flank))
        _check_sections(f"{member.name}.{flank}", member.flank(flank), SIDES[flank])
        _check_foot(f"{member.name}.{flank}", member.flank(flank), member.blank.clearance)
        if member.cutting == "fixed_setting":
            _check_tip(f"{member.name}.{flank}", member.flank(flank), SIDES[flank])
    if member.cutting == "completing":
        _check_point_width(member)


def check_methods(pinion: Member, gear: Member) -> None:
    """Refuse mates whose teeth are not curved alike. Raises InputError naming member, key, value and limit."""
    for key in ("process", "blade_groups", "indexing_sign"):
        one, two = getattr(pinion, key), getattr(gear, key)
        if one != two:
            raise InputError(
                f"pinion.{key} = {one!r}: the gear has {two!r}; both must be the same, as one crown gear cuts both"
            )


def check_offset(member: Member, spiral: float) -> None:
    """Refuse hobbing blades that do not stand square to their path (14.6) at a mean ``spiral`` angle [rad], signed.

    Raises InputError naming member, key, value and limit.
    """
    if member.blade_groups is None:
        return
    blank, flanks = member.blank, [member.flank(flank) for flank in FLANKS]
    hand = 1 if member.hand == "right" else -1
    square = evaluate(
        "crown_gear_space",
        {
            "hand_sign": hand,
            "mean_spiral_angle": hand * spiral,
            "mean_cone_distance": blank.mean_cone_distance,
            "cutter_radius": sum(spec.nominal.blade_point_radius for spec in flanks) / len(flanks),
            "pitch_angle": blank.delta,
            "machine_root_angle": blank.delta_f,
            "mean_dedendum": blank.mean_dedendum,
            "index_ratio": member.indexing_sign * member.blade_groups / member.teeth,
        },
    )["blade_offset_angle"]
    for flank, spec in zip(FLANKS, flanks, strict=True):
        if not abs(spec.blade_offset_angle - math.degrees(square)) <= _SQUARE:
            raise InputError(
                f"{member.name}.{flank}.blade_offset_angle = {spec.blade_offset_angle:g}: the blade must stand square "
                f"to its path, {math.degrees(square):.4g} within {_SQUARE:g} degrees"
            )


def _check_method(member: Member, table: str, spec: Flank) -> None:
    if member.process == "face_milling" and spec.blade_offset_angle != 0:
        raise InputError(
            f"{table}.blade_offset_angle = {spec.blade_offset_angle:g}: belongs to face_hobbing, in face milling it "
            "must be 0 or left out"
        )
    if spec.blade_tip_height != 0 and not member.blade_groups:
        raise InputError(
            f"{table}.blade_tip_height = {spec.blade_tip_height:g}: belongs to face_hobbing, whose blades cut one "
            "flank each; in face milling it must be 0 or left out"
        )


def _check_sections(table: str, spec: Flank, side: int) -> None:
    """Rounded edge, Toprem and main section follow each other within the height of the blade."""
    height = spec.blade_profile_height
    if spec.blade_reference_height and spec.blade_spheric_radius is None and spec.nominal_spheric_radius is None:
        raise InputError(
            f"{table}.blade_reference_height = {spec.blade_reference_height:g}: belongs to blade_spheric_radius, on a "
            "straight blade it has no effect; it must be 0 or left out"
        )
    for key in ("blade_edge_radius", "toprem_height", "blade_reference_height"):
        if getattr(spec, key) >= height:
            raise InputError(f"{table}.{key} = {getattr(spec, key):g}: must be below blade_profile_height = {height:g}")
    if spec.toprem_angle is not None and spec.toprem_angle >= spec.nominal.blade_pressure_angle:
        raise InputError(
            f"{table}.toprem_angle = {spec.toprem_angle:g}: must be less than blade_pressure_angle = "
            f"{spec.nominal.blade_pressure_angle:g}, or it relieves nothing"
        )
    arc = f"{table}.blade_spheric_radius = {spec.blade_spheric_radius}:"
    try:
        sections = blade_sections(spec, side)
    except ValueError as error:
        if spec.blade_edge_radius == 0:
            raise InputError(f"{arc} such an arc does not reach up to blade_profile_height = {height:g}") from error
        raise InputError(
            f"{table}.blade_edge_radius = {spec.blade_edge_radius:g}: takes away all of the section above it, which "
            f"ends at {spec.toprem_height or height:g} mm"
        ) from error
    if not sections["main"].upper > sections["main"].lower:
        raise InputError(f"{arc} the rounded edge, blade_edge_radius = {spec.blade_edge_radius:g}, does not touch it")


def _check_tip(table: str, spec: Flank, side: int) -> None:
    """The tip of a cutter for one flank has room for the rounded edges of both its sides, which are made alike."""
    taken = 2 * tip_taken(spec, side)
    if spec.blade_point_width is not None and taken > spec.blade_point_width:
        raise InputError(
            f"{table}.blade_edge_radius = {spec.blade_edge_radius:g}: the rounded edges of both sides take {taken:.3g} "
            f"mm of the tip, blade_point_width = {spec.blade_point_width:g}"
        )


def check_edge(table: str, radius: float, alpha: float, clearance: float) -> None:
    """Refuse an edge radius [mm] of a blade of an angle [rad] that rounds it where the mate needs the flank."""
    share = 1 - math.sin(alpha)
    if radius * share > _ROUND * clearance:
        raise InputError(
            f"{table}.blade_edge_radius = {radius:g}: it rounds the blade up to {radius * share:.3g} mm, where the tip "
            f"of the mate needs the flank from {_ROUND * clearance:.3g} mm on, {_ROUND:g} of the clearance; it must be "
            f"at most {_ROUND * clearance / share:.3g} mm"
        )


def _check_foot(table: str, spec: Flank, clearance: float) -> None:
    """Rounded edge and Toprem belong to the root: above the clearance the mate needs the flank itself."""
    check_edge(table, spec.blade_edge_radius, spec.nominal.alpha, clearance)
    if spec.toprem_angle is None:
        return
    least = spec.nominal.blade_pressure_angle - _TOPREM_ANGLE
    if spec.toprem_angle < least:
        raise InputError(
            f"{table}.toprem_angle = {spec.toprem_angle:g}: must be at least {least:.4g}, {_TOPREM_ANGLE:g} degrees "
            f"less than blade_pressure_angle = {spec.nominal.blade_pressure_angle:g}"
        )
    if spec.toprem_height > _TOPREM * clearance:
        raise InputError(
            f"{table}.toprem_height = {spec.toprem_height:g}: must be at most {_TOPREM * clearance:.3g} mm, "
            f"{_TOPREM:g} of the clearance, or it relieves the flank that the mate needs"
        )


def _check_point_width(member: Member) -> None:
    """Both blades of one cutter: between their tips there is some metal, and room for both edge radii."""
    outer, inner = member.concave, member.convex
    for key, which in (("", (outer, inner)), ("design.", (outer.nominal, inner.nominal))):
        width = which[0].blade_point_radius - which[1].blade_point_radius
        if which[0].work_rotation_offset != which[1].work_rotation_offset:
            continue  # of a hobbing cutter whose inner blades follow the outer ones: each has a tip of its own
        if not width > 0:
            raise InputError(
                f"{member.name}.concave.{key}blade_point_radius = {which[0].blade_point_radius:g}: one cutter cuts "
                "both flanks, and its outer blade must lie outside of the inner one of "
                f"{which[1].blade_point_radius:g} mm, which cuts the convex flank; the point width would be "
                f"{width:.4g} mm"
            )
        flat = sum(tip_taken(spec, side) for spec, side in ((outer, 1), (inner, -1)))
        if flat > width:
            raise InputError(
                f"{member.name}.concave.blade_edge_radius = {outer.blade_edge_radius:g}, convex "
                f"{inner.blade_edge_radius:g}: the rounded edges take {flat:.3g} mm of the tip, the point width is "
                f"{width:.4g} mm"
            )
    for flank in FLANKS:
        stated = member.flank(flank).blade_point_width
        width = outer.blade_point_radius - inner.blade_point_radius
        if stated is not None and abs(stated - width) > 0.01 * width:
            raise InputError(
                f"{member.name}.{flank}.blade_point_width = {stated:g}: the blade point radii of the two flanks make "
                f"it {width:.4g} mm; leave it out where one cutter cuts both flanks"
            )


def tip_taken(spec: Flank, side: int) -> float:
    """What the rounded edge takes of the tip of a blade, from its point radius to where the edge is lowest [mm]."""
    edge = blade_sections(spec, side).get("edge")
    if edge is None or edge.arc is None:
        return 0.0
    return abs(tip_radius(spec, side) - edge.arc[0])
