"""Where a design starts: the blank, with a thickness that leaves a top land where nobody has chosen one; the cutter."""

from __future__ import annotations

import math

from gearmath.bevel.blank import BevelBlank, blank_of
from gearmath.bevel.slots import MemberSlots, slots_of
from gearmath.specs.blank_data import BlankData
from gearmath.specs.design import DesignData
from gearmath.specs.toml import checked

#: Top land, in mean normal modules, that a thickness nobody has chosen leaves; what a design must have is 0.2.
_LAND = 0.3
#: Most that the thickness factor may be changed for it, and the least thickness left to the gear, in modules.
_MOST, _THINNEST = 0.15, 0.95
#: Edge radii come in tenths [mm], and take at most this part of the narrowest slot.
_TENTH, _OF_SLOT = 0.1, 0.5


def blank_for(data: DesignData, name: str) -> tuple[BlankData, BevelBlank]:
    """The data of the blank, completed, and the blank. Raises InputError naming key, value and limit."""
    given = data.blank_data(chosen_radius(data, name))
    blank = blank_of(given, name)
    if data.data_type_1 is not None or data.data_type_2 is not None:
        return given, blank
    slots, wanted = slots_of(blank), _LAND * blank.mean_normal_module
    missing = [wanted - min(member.top_land) for member in (slots.pinion, slots.wheel)]
    change = max(missing[0], 0.0) - max(missing[1], 0.0)
    thick = blank.wheel.mean_normal_thickness / blank.mean_normal_module
    change = min(max(change / blank.mean_normal_module, -_MOST), _MOST, thick - _THINNEST)
    if not change:
        return given, blank
    values = given.model_dump(exclude_none=True)
    values["data_type_2"]["thickness_factor"] += change
    given = checked(values, BlankData, name)
    return given, blank_of(given, name)


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
    largest = min(slots.maximum_edge_radius, clearance, _OF_SLOT * min(slots.slot_width))
    return max(math.floor(largest / _TENTH) * _TENTH, 0.0) if asked is None else asked
