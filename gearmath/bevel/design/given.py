"""Whether design data say the same as the set to whose gear a pinion is designed."""

from __future__ import annotations

import math

from gearmath.bevel.check_flank import cut_flank
from gearmath.bevel.contact.report import SIDES
from gearmath.bevel.method import nominal_cut
from gearmath.errors import InputError
from gearmath.specs.bevel_set import FLANKS, BevelSet, Member
from gearmath.specs.design import DesignData

#: Lengths that are the same, relative: figures of a drawing.
_SAME = 1e-3
#: How far the radius of the gear's cutter may lie from that of the data, relative: blades have half a point width.
_CUTTER = 0.01
#: What published sets and their blanks differ by, and mates from each other: as of a pair [degree].
_SPIRAL, _PRESSURE = 0.5, 1.1


def check_given(given: BevelSet, data: DesignData, name: str) -> None:
    """Raises InputError with key, value and that of the set. Keys that the file leaves out are those of the set."""
    pinion, gear = given.member("pinion"), given.member("gear")
    for key, asked, of_set in (
        ("pinion_teeth", data.pinion_teeth, pinion.teeth),
        ("wheel_teeth", data.wheel_teeth, gear.teeth),
        ("hand", data.hand, pinion.hand),
        ("cutter.process", data.cutter.process, gear.process),
        ("gear.generation", data.gear.generation, gear.generation),
    ):
        if asked != of_set:
            raise InputError(f"{name}: {key} = {asked!r}: must be {of_set!r}, as the set has it")
    heel = gear.blank.mean_cone_distance + gear.blank.face_width / 2
    diameter = 2 * heel * math.sin(gear.blank.delta)
    radius = sum(gear.flank(flank).blade_point_radius for flank in FLANKS) / len(FLANKS)
    for key, length, of_length, slack in (
        ("face_width", data.face_width, pinion.blank.face_width, _SAME),
        ("outer_transverse_module", data.outer_transverse_module, diameter / gear.teeth, _SAME),
        ("wheel_outer_pitch_diameter", data.wheel_outer_pitch_diameter, diameter, _SAME),
        ("cutter.cutter_radius", data.cutter.cutter_radius, radius, _CUTTER),
    ):
        if length is not None and not math.isclose(length, of_length, rel_tol=slack):
            raise InputError(f"{name}: {key} of {length:g} mm: must be {of_length:.5g} mm, as the set has it")
    _check_angles(given, gear, data, name)


def _check_angles(given: BevelSet, gear: Member, data: DesignData, name: str) -> None:
    """The shaft angle, and the angles of the gear's flanks at the mean point, where the file states them."""
    if not math.isclose(data.shaft_angle, given.shaft_angle, abs_tol=_SAME):
        raise InputError(
            f"{name}: shaft_angle = {data.shaft_angle:g}: must be {given.shaft_angle:g}, as the set has it"
        )
    cuts = {flank: cut_flank(gear, flank, nominal_cut(gear, flank)) for flank in FLANKS}
    spiral = sum(abs(math.degrees(cut.spiral_angle)) for cut in cuts.values()) / len(cuts)
    found = [("mean_spiral_angle", spiral, _SPIRAL)]
    for side, of_pinion in SIDES.items():
        (of_gear,) = (flank for flank in FLANKS if flank != of_pinion)
        found.append((f"pressure_angle_{side}", abs(math.degrees(cuts[of_gear].pressure_angle)), _PRESSURE))
    for key, of_set, slack in found:
        asked = getattr(data, key)
        if key in data.model_fields_set and abs(asked - of_set) > slack:
            raise InputError(f"{name}: {key} = {asked:g} degrees: must be {of_set:.2f}, as the gear of the set has it")
