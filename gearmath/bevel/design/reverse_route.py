"""From a file of points and a blank to a set: which member is looked for, and the set of the settings found."""

from __future__ import annotations

import math
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from gearmath.bevel.design.reverse import ReversedMember, reverse
from gearmath.bevel.design.reverse_points import given_flanks
from gearmath.bevel.design.reverse_start import KnownMember
from gearmath.bevel.design.start import blank_for, chosen_radius
from gearmath.bevel.pair import check_computed, check_pair
from gearmath.bevel.tooth import mean_pitch_radius, mean_tooth_thickness
from gearmath.errors import ComputationError, InputError
from gearmath.files import read_text
from gearmath.specs.bevel_set import FLANKS, MEMBERS, BevelSet, Member, load_bevel_set
from gearmath.specs.design import DesignData, load_design
from gearmath.specs.flank_csv import FlankFile

#: Points whose middle lies farther from the blank's than this part of the face width, and teeth that are off by more
#: than this part of the pitch, which is the backlash that a blank starts with, are worth a word.
_MIDDLE, _THICKNESS = 0.02, 0.01


@dataclass(frozen=True)
class KnownPair:
    """What a file says of a pair besides its flanks: title, shaft angle [degree], and the members that it has.

    ``given`` is the gear set that the file is, if it is one.
    """

    title: str
    shaft_angle: float
    members: dict[str, KnownMember]
    given: BevelSet | None = None


@dataclass(frozen=True)
class ReversedSet:
    """The set of the settings found, how well its member of that ``name`` reproduces the points, and what to say of it.

    ``thickness`` [mm] is that of its tooth at the mean point and what the file of the blank has there, if anything;
    ``middle`` the cone distance of the middle of the points and the blank's mean one [mm].
    """

    pair: BevelSet
    name: str
    found: ReversedMember
    thickness: tuple[float, float | None]
    middle: tuple[float, float]
    notes: tuple[str, ...]


def load_known(path: Path) -> KnownPair:
    """Blank and method out of design data, a blank file, or a gear set, whose settings are not looked at.

    Raises InputError naming file, key, value and limit.
    """
    try:
        values: dict[str, Any] = tomllib.loads(read_text(path))
    except (ValueError, RecursionError):
        values = {}  # what is wrong with it is said where it is loaded
    tables = [values.get(name) for name in MEMBERS]
    if any(isinstance(table, dict) and "blank" in table for table in tables):
        return _of_set(load_bevel_set(path))
    return _of_design(load_design(path), str(path))


def _of_set(given: BevelSet) -> KnownPair:
    members = {
        name: KnownMember(
            member.teeth,
            member.blank,
            member.hand,
            member.cutting,
            member.generation,
            member.blade_groups,
            edges={flank: member.flank(flank).blade_edge_radius for flank in FLANKS},
            unlike=_unlike(member),
            thickness=_thickness(member),
        )
        for name, member in given.members.items()
    }
    return KnownPair(given.title, given.shaft_angle, members, given)


def _thickness(member: Member) -> float | None:
    """Tooth thickness at the mean point [mm]; None where the settings of the file, which nobody checked, cut none."""
    try:
        return mean_tooth_thickness(member)
    except InputError:
        return None


def _unlike(member: Member) -> tuple[str, float] | None:
    """The first key of a blade by which it is not straight, and its value."""
    for flank in FLANKS:
        for key in ("blade_spheric_radius", "toprem_angle"):
            value = getattr(member.flank(flank), key)
            if value is not None:
                return f"{flank}.{key}", value
    return None


def _of_design(data: DesignData, name: str) -> KnownPair:
    """The blank of design data, and the methods that they ask for; the hand only where it is stated."""
    _, blank = blank_for(data, name)
    groups, radius = data.cutter.blade_groups, chosen_radius(data, name)
    hands: tuple[Any, Any] = (None, None)
    if "hand" in data.model_fields_set:
        hands = (data.hand, "right" if data.hand == "left" else "left")
    cutting = "completing" if groups else data.pinion.cutting
    edges = [
        {} if asked.blade_edge_radius is None else dict.fromkeys(FLANKS, asked.blade_edge_radius)
        for asked in (data.pinion, data.gear)
    ]
    pinion = KnownMember(
        data.pinion_teeth,
        blank.pinion.spec_blank(),
        hands[0],
        cutting,
        "generated",
        groups,
        radius,
        edges[0],
        thickness=blank.pinion.mean_transverse_thickness,
    )
    gear = KnownMember(
        data.wheel_teeth,
        blank.wheel.spec_blank(),
        hands[1],
        "completing",
        data.gear.generation,
        groups,
        radius,
        edges[1],
        thickness=blank.wheel.mean_transverse_thickness,
    )
    return KnownPair(data.title, data.shaft_angle, {"pinion": pinion, "gear": gear})


def reversed_set(known: KnownPair, file: FlankFile, source: str) -> ReversedSet:
    """The member of a file of points in a set, with its mate where the file of the blank has one that fits it.

    Raises InputError for points that are not of this blank, or that no settings come near to; ComputationError where
    settings are found that no set may have.
    """
    name = file.member
    if name not in known.members:
        raise InputError(f"member = {name}: the blank is that of a {' and a '.join(known.members)}")
    asked = known.members[name]
    if asked.unlike is not None:
        key, value = asked.unlike
        raise InputError(
            f"{name}.{key} = {value:g} of the set that the blank is taken from: settings are found for straight blades "
            "only; the key must be left out, and what straight blades do not reproduce is said"
        )
    flanks = given_flanks(file, asked.teeth)
    found = reverse(asked, flanks, name)
    found = replace(found, member=_with_edges(found.member, asked.edges))
    members: dict[str, Any] = {name: found.member}
    one = BevelSet(title=known.title, source=source, shaft_angle=known.shaft_angle, **members)
    try:
        check_pair(one)
    except InputError as error:
        raise ComputationError(
            f"settings were found that reproduce the points, but no set may have them: {error}"
        ) from error
    pair, said = _with_mate(one, known.given, name)
    along = np.concatenate([flank.along for flank in flanks.values()])
    thickness = mean_tooth_thickness(found.member), asked.thickness
    middle = float(along.min() + along.max()) / 2, asked.blank.mean_cone_distance
    pitch = 2 * math.pi * mean_pitch_radius(found.member) / asked.teeth
    notes = (*_off(thickness, middle, pitch, asked.blank.face_width), *said)
    return ReversedSet(pair, name, found, thickness, middle, notes)


def _off(
    thickness: tuple[float, float | None], middle: tuple[float, float], pitch: float, face_width: float
) -> list[str]:
    """What is said where the points are of another thickness than the blank, or lie elsewhere on it."""
    said = []
    here, there = middle
    if abs(here - there) > _MIDDLE * face_width:
        way = "heel" if here > there else "toe"
        said.append(
            f"the middle of the points has a cone distance of {here:.3f} mm, {abs(here - there):.3f} mm nearer to the "
            f"{way} than the mean point of the blank: unless they are of this part of the flank only, they are of "
            f"another blank, {here / there - 1:+.1%} in size"
        )
    own, stated = thickness
    if stated is not None and abs(own - stated) > _THICKNESS * pitch:
        said.append(
            f"the tooth is {own:.3f} mm thick at the mean point, transverse, {own - stated:+.3f} mm off that of the "
            "file of the blank"
        )
    return said


def _with_mate(one: BevelSet, given: BevelSet | None, name: str) -> tuple[BevelSet, list[str]]:
    """The set with the other member of the one that the blank is taken from, where both are a pair; and what is said of
    it."""
    mate = next(other for other in MEMBERS if other != name)
    if given is None or mate not in given.members:
        return one, []
    pair = one.model_copy(update={mate: given.member(mate)})
    try:
        check_computed(pair)
    except InputError as error:
        return one, [f"the {mate} of the file of the blank is left out, it is no mate of this {name}: {error}"]
    return pair, [f"the {mate} is that of the file of the blank"]


def _with_edges(member: Member, edges: Mapping[str, float]) -> Member:
    """The member with edge radii [mm] on its blades, by flank."""
    edged = {
        flank: member.flank(flank).model_copy(update={"blade_edge_radius": radius}) for flank, radius in edges.items()
    }
    return member.model_copy(update=edged)
