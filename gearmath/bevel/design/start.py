"""Where a design starts: the blank, with a thickness that leaves a top land where nobody has chosen one; the cutter."""

from __future__ import annotations

import math
from dataclasses import dataclass

from gearmath.bevel.blank import BevelBlank, blank_of
from gearmath.bevel.slots import MemberSlots, slots_of
from gearmath.specs.blank_data import BlankData
from gearmath.specs.design import DesignData
from gearmath.specs.toml import checked

#: Top land, in mean normal modules, that a thickness nobody has chosen is to leave, and the least; the cut tooth must
#: have 0.2, and may be a little thinner at its heel than AGMA 929 has it.
_LAND, _LEAST = 0.3, 0.28
#: Where it does not, the addendum factor grows by so much at a time.
_SHORTER, _TRIALS = 0.015, 8
#: Most that the thickness factor may be changed for it, and the least thickness left to the gear, in modules.
_MOST, _THINNEST = 0.15, 0.95
#: Edge radii come in tenths [mm], and take at most these parts of the narrowest slot and of the clearance.
TENTH, _OF_SLOT, _OF_CLEARANCE = 0.1, 0.4, 0.6


@dataclass(frozen=True)
class Teeth:
    """Parts of the factors that a design starts from where nobody has chosen them."""

    tooth_depth_factor: float = 1.0
    mean_addendum_factor: float = 1.0


USUAL = Teeth()


def blank_for(data: DesignData, name: str, teeth: Teeth = USUAL) -> tuple[BlankData, BevelBlank]:
    """The data of the blank, completed, and the blank. Raises InputError naming key, value and limit."""
    given = data.blank_data(chosen_radius(data, name))
    blank = blank_of(given, name)
    if data.data_type_1 is not None or data.data_type_2 is not None:
        return given, blank
    values = given.model_dump(exclude_none=True)
    factors = dict(values["data_type_2"])
    for key, part in vars(teeth).items():
        factors[key] *= part
    for trial in range(_TRIALS):
        # a shorter pinion where thickness alone leaves it too thin a top land
        values["data_type_2"] = {**factors, "mean_addendum_factor": factors["mean_addendum_factor"] + trial * _SHORTER}
        given = checked(values, BlankData, name)
        blank = blank_of(given, name)
        change, left = _thickness_change(blank)
        if left >= _LEAST:
            break
    values["data_type_2"]["thickness_factor"] += change
    given = checked(values, BlankData, name)
    return given, blank_of(given, name)


def _thickness_change(blank: BevelBlank) -> tuple[float, float]:
    """How the thickness factor must change for top lands that suffice, and the least land that it then leaves, in
    mean normal modules: the pinion gains what the gear loses."""
    slots, module = slots_of(blank), blank.mean_normal_module
    pinion, wheel = (min(member.top_land) / module for member in (slots.pinion, slots.wheel))
    change = max(_LAND - pinion, 0.0) - max(_LAND - wheel, 0.0)
    change = min(max(change, -_MOST), _MOST, blank.wheel.mean_normal_thickness / module - _THINNEST)
    return change, min(pinion + change, wheel - change)


def chosen_radius(data: DesignData, name: str) -> float:
    """The cutter's radius: as given, or of those at hand the one nearest to the mean cone distance."""
    if data.cutter.cutter_radius is not None:
        return data.cutter.cutter_radius
    distance = blank_of(data.blank_data(max(data.cutter.radii)), name).mean_cone_distance
    return min(data.cutter.radii, key=lambda radius: abs(radius - distance))


def edge_radius(asked: float | None, slots: MemberSlots, clearance: float) -> float:
    """Edge radius of a member's blades [mm]: as asked, or the largest in tenths that AGMA 929 and clearance allow.

    A cutter for one flank takes little more than half of the slot, and its edge must fit on that.
    """
    largest = min(slots.maximum_edge_radius, _OF_CLEARANCE * clearance, _OF_SLOT * min(slots.slot_width))
    return max(math.floor(largest / TENTH) * TENTH, 0.0) if asked is None else asked
