"""The route of a design: blank, gear in closed form, pinion by local synthesis and least squares, steps of the shop."""

from __future__ import annotations

import math
from dataclasses import dataclass

from gearmath.bevel.blank import WIDEST_FACE, BevelBlank
from gearmath.bevel.check_blade import check_edge
from gearmath.bevel.check_blank import NARROWEST_FACE, check_blank
from gearmath.bevel.contact.report import SIDES as OWN
from gearmath.bevel.contact.surface import nominal_surface
from gearmath.bevel.crown_gear import Method, crown_gear_set
from gearmath.bevel.design.backlash import completing_backlash, with_backlash
from gearmath.bevel.design.completing import completing_pinion
from gearmath.bevel.design.designed_flank import DesignedFlank
from gearmath.bevel.design.pinion import FLATTEST, PinionFlank, pinion_flank, settings_table, with_flank
from gearmath.bevel.design.point_widths import with_point_widths
from gearmath.bevel.design.request import Request, gear_flank, request
from gearmath.bevel.design.rounding import rounded_completing, rounded_gear, rounded_pinion
from gearmath.bevel.design.start import USUAL, Teeth, blank_for, edge_radius
from gearmath.bevel.design.tip_edges import with_edge, with_room_for_tips
from gearmath.bevel.design.tip_heights import with_tip_heights
from gearmath.bevel.pair import check_computed
from gearmath.bevel.slots import slots_of
from gearmath.bevel.tooth import mean_backlash
from gearmath.errors import InputError
from gearmath.specs.bevel_set import FLANKS, BevelSet, Member
from gearmath.specs.blank_data import BlankData
from gearmath.specs.design import DesignData
from gearmath.specs.toml import checked

#: Face widths are the same within this, for sheets in inches are rounded.

Flanks = dict[str, PinionFlank | DesignedFlank]


@dataclass(frozen=True)
class Designed:
    """A pair, the data of its blank, how each flank of its pinion was found, by side, and the backlash wanted [mm]."""

    data: DesignData
    pair: BevelSet
    flanks: Flanks
    backlash: float
    blank_data: BlankData


def design(
    data: DesignData,
    name: str = "design data",
    given: BevelSet | None = None,
    along: float = 0.5,
    teeth: Teeth = USUAL,
) -> Designed:
    """A pair from the data of a design, to the gear of a ``given`` set or to one of its own.

    ``name`` is the data's file in messages, ``along`` the place of a vertex of which none is asked for, from toe (0) to
    heel (1), ``teeth`` what the factors of the teeth are changed by. Raises InputError naming key, value and limit of
    what cannot be, ComputationError where no settings are found.
    """
    completing = data.pinion.cutting == "completing"
    if data.cutter.process == "face_hobbing" and not completing:
        raise InputError(
            f"{name}: pinion.cutting = 'fixed_setting': with face_hobbing it must be 'completing', as both flanks are "
            "cut at once"
        )
    blank_data, blank = blank_for(data, name, teeth)
    narrowest, widest = (share * blank.outer_cone_distance for share in (NARROWEST_FACE, WIDEST_FACE))
    if data.face_width < narrowest:
        raise InputError(
            f"{name}: face_width = {data.face_width:g}: must lie between {narrowest:.4g} and {widest:.4g} mm, "
            f"{NARROWEST_FACE:g} and {WIDEST_FACE:g} of the outer cone distance"
        )
    start = _crown_gear(data, blank_data, blank)
    for member in ("pinion", "gear"):
        check_blank(start.member(member))  # before anything is computed for it
    backlash, slots = blank.mean_transverse_backlash, slots_of(blank)
    given_edges = {"pinion": data.pinion.blade_edge_radius, "gear": data.gear.blade_edge_radius}
    rounds = {
        member: edge_radius(given_edges[member], own, blank.clearance)
        for member, own in (("pinion", slots.pinion), ("gear", slots.wheel))
    }
    # the fit may still make the blades of the pinion as flat as that
    check_edge("pinion", rounds["pinion"], FLATTEST, blank.clearance)
    if given is None:
        flattest = max(start.member("gear").flank(flank).alpha for flank in FLANKS)
        check_edge("gear", rounds["gear"], flattest, blank.clearance)
    pinion, gear = (with_edge(start.member(member), rounds[member]) for member in ("pinion", "gear"))
    gear = rounded_gear(gear, data.shop)
    if gear.process == "face_hobbing" and data.gear.blade_edge_radius is None:
        gear = with_room_for_tips(gear)
    if given is not None:
        pinion, gear = pinion.model_copy(update={"blank": given.member("pinion").blank}), given.member("gear")
        if data.backlash is None:
            backlash = mean_backlash(given.member("pinion"), gear)
    else:
        _check_gear(start, gear)
    requests = {side: _asked(data, side, pinion, gear, start.shaft_angle, along) for side in OWN}
    if completing:
        found, flanks = _at_once(data, requests, pinion, gear, backlash)
    else:
        found, flanks = _one_by_one(data, requests, pinion, gear, backlash)
    pair = start.model_copy(update={"pinion": found, "gear": gear})
    return Designed(data, pair, flanks, backlash, blank_data)


def _crown_gear(data: DesignData, blank_data: BlankData, blank: BevelBlank) -> BevelSet:
    """The pair of the crown gear. Raises InputError with the key of the data from which a setting follows that is
    beyond what a set may have."""
    try:
        return crown_gear_set(
            blank_data,
            _single(data, blank) if data.pinion.cutting == "fixed_setting" else Method("completing", alternating=True),
            Method("completing", data.gear.generation, alternating=True),
            data.hand,
        )
    except InputError as error:
        said = str(error)
        if "blade_point_radius" in said:
            raise InputError(f"cutter.cutter_radius = {blank_data.cutter.cutter_radius:g}: {said}") from error
        if ("blade_pressure_angle" in said or said.startswith("tilt")) and data.pinion.cutter_tilt:
            raise InputError(f"pinion.cutter_tilt = {data.pinion.cutter_tilt:g}: {said}") from error
        raise


def _check_gear(start: BevelSet, gear: Member) -> None:
    """Refuse a gear that is no member of a pair before a pinion is sought for it."""
    try:
        check_computed(start.model_copy(update={"pinion": None, "gear": gear}))
    except InputError as error:
        raise InputError(
            f"the gear that was found is refused: {error}; another mean_addendum_factor, thickness_factor, pressure "
            "angle, cutter_radius or generation of the gear is needed"
        ) from error


def _asked(data: DesignData, side: str, pinion: Member, gear: Member, shaft_angle: float, along: float) -> Request:
    """What a side asks of its flank of the pinion."""
    own = OWN[side]
    facing = gear_flank(nominal_surface(gear, FLANKS[1 - FLANKS.index(own)]), pinion, shaft_angle)
    return request(side, data.contact(side), facing, pinion.teeth, nominal_surface(pinion, own).borders[0], along)


def _one_by_one(
    data: DesignData, requests: dict[str, Request], start: Member, gear: Member, backlash: float
) -> tuple[Member, Flanks]:
    """The pinion, each flank with settings of its own."""
    found, flanks = start, {}
    for side, own in OWN.items():
        flanks[side] = rounded_pinion(pinion_flank(start, own, requests[side], data.pinion.may_change), data.shop)
        found = with_flank(found, own, flanks[side].x)
    found = with_backlash(found, gear, backlash, start, data.shop.angle_step)
    return with_point_widths(found), dict(flanks)


def _at_once(
    data: DesignData, requests: dict[str, Request], start: Member, gear: Member, backlash: float
) -> tuple[Member, Flanks]:
    """The pinion, both flanks with the settings of one machine."""
    own = {OWN[side]: asked for side, asked in requests.items()}
    found_for_both = completing_pinion(start, own, data.pinion.may_change, backlash).centered()
    both = rounded_completing(found_for_both, data.shop)
    flanks = {side: both.flank(name) for side, name in OWN.items()}
    values = start.model_dump()
    for flank in flanks.values():
        values[flank.name] = {**values[flank.name], **settings_table(flank.x)}
    found = completing_backlash(checked(values, Member, "pinion").named("pinion"), gear, backlash, data.shop)
    if found.process == "face_hobbing":
        found = with_tip_heights(found, data.shop.length_step)
        if data.pinion.blade_edge_radius is None:
            found = with_room_for_tips(found)
    return found, dict(flanks)


def _single(data: DesignData, blank: BevelBlank) -> Method:
    """Each flank of the pinion by itself."""
    return Method("fixed_setting", tilt=_tilt(data, blank), tilt_direction=math.pi / 2)


def _tilt(data: DesignData, blank: BevelBlank) -> float:
    """Tilt of the pinion's cutter [rad]: as given, or for a Formate gear square to the gear's root line.

    The gear's cutter stands square to that; a pinion cut by one that stands alike is nearly conjugate to it.
    """
    if data.pinion.cutter_tilt is not None:
        return data.pinion.rad("cutter_tilt")
    return blank.dedendum_angle_sum if data.gear.generation == "formate" else 0.0
