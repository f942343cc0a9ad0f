"""The route of a design: blank, gear in closed form, pinion by local synthesis and least squares, exact contact."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from gearmath.bevel.blank import BevelBlank, blank_of
from gearmath.bevel.contact.surface import nominal_surface
from gearmath.bevel.crown_gear import Method, crown_gear_set
from gearmath.bevel.design.backlash import with_backlash
from gearmath.bevel.design.pinion import PinionFlank, pinion_flank, with_flank
from gearmath.bevel.design.request import gear_flank, request
from gearmath.errors import InputError
from gearmath.specs.bevel_set import FLANKS, BevelSet, Member
from gearmath.specs.design import DesignData

#: The pinion's flank that works on each side.
OWN = {"drive": "concave", "coast": "convex"}


@dataclass(frozen=True)
class Designed:
    """A pair, its blank, and how each flank of its pinion was found, by side."""

    data: DesignData
    blank: BevelBlank
    pair: BevelSet
    flanks: dict[str, PinionFlank]


def design(data: DesignData, name: str = "design data") -> Designed:
    """A pair from the data of a design; ``name`` is their file in messages.

    Raises InputError naming key, value and limit of what cannot be, ComputationError where no settings are found.
    """
    if data.pinion.cutting != "fixed_setting" or data.cutter.process != "face_milling":
        raise InputError("pinion.cutting: so far the pinion is designed face milled, fixed_setting")
    given = data.blank_data(chosen_radius(data))
    blank = blank_of(given, name)
    start = crown_gear_set(given, Method("fixed_setting"), Method("completing", data.gear.generation), data.hand)
    return _for_gear(data, blank, start)


def chosen_radius(data: DesignData) -> float:
    """The cutter's radius: as given, or of those at hand the one nearest to the mean cone distance."""
    if not data.cutter.radii or data.cutter.cutter_radius:
        return data.cutter.cutter_radius
    first = data.blank_data(max(data.cutter.radii))
    distance = blank_of(first).mean_cone_distance
    return min(data.cutter.radii, key=lambda radius: abs(radius - distance))


def _for_gear(data: DesignData, blank: BevelBlank, start: BevelSet) -> Designed:
    flanks: dict[str, PinionFlank] = {}
    pinion: Member = start.pinion
    for side, own in OWN.items():
        mating = FLANKS[1 - FLANKS.index(own)]
        gear = gear_flank(nominal_surface(start.gear, mating), blank)
        tip = nominal_surface(start.pinion, own).borders[0]
        asked = request(side, data.contact(side), gear, blank.pinion, data.pinion_teeth, tip)
        flanks[side] = pinion_flank(start.pinion, own, asked, data.pinion.free)
        pinion = with_flank(pinion, own, flanks[side].x)
    pinion = with_backlash(pinion, start.gear, blank.mean_transverse_backlash, start.pinion)
    pair = start.model_copy(update={"pinion": pinion})
    return Designed(data, blank, pair, flanks)
