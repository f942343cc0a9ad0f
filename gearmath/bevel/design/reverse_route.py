"""From a file of points and a blank to a set: which member is looked for, and the set of the settings found."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from gearmath.bevel.design.reverse import ReversedMember, reverse
from gearmath.bevel.design.reverse_points import given_flanks
from gearmath.bevel.design.reverse_start import KnownMember
from gearmath.bevel.design.start import blank_for, chosen_radius
from gearmath.bevel.pair import check_pair
from gearmath.errors import ComputationError, InputError
from gearmath.files import read_text
from gearmath.specs.bevel_set import FLANKS, MEMBERS, BevelSet, Member, load_bevel_set
from gearmath.specs.design import DesignData, load_design
from gearmath.specs.flank_csv import FlankFile


@dataclass(frozen=True)
class KnownPair:
    """What a file says of a pair besides its flanks: title, shaft angle [degree], and the members that it has."""

    title: str
    shaft_angle: float
    members: dict[str, KnownMember]


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
        )
        for name, member in given.members.items()
    }
    return KnownPair(given.title, given.shaft_angle, members)


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
        data.pinion_teeth, blank.pinion.spec_blank(), hands[0], cutting, "generated", groups, radius, edges[0]
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
    )
    return KnownPair(data.title, data.shaft_angle, {"pinion": pinion, "gear": gear})


def reversed_set(known: KnownPair, file: FlankFile, source: str) -> tuple[BevelSet, ReversedMember]:
    """The member of a file of points as a set of its own, and how well it reproduces them.

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
    found = reverse(asked, given_flanks(file, asked.teeth), name)
    found = replace(found, member=_with_edges(found.member, asked.edges))
    members: dict[str, Any] = {name: found.member}
    one = BevelSet(title=known.title, source=source, shaft_angle=known.shaft_angle, **members)
    try:
        check_pair(one)
    except InputError as error:
        raise ComputationError(
            f"settings were found that reproduce the points, but no set may have them: {error}"
        ) from error
    return one, found


def _with_edges(member: Member, edges: Mapping[str, float]) -> Member:
    """The member with edge radii [mm] on its blades, by flank."""
    edged = {
        flank: member.flank(flank).model_copy(update={"blade_edge_radius": radius}) for flank, radius in edges.items()
    }
    return member.model_copy(update=edged)
