"""Names of REXS 2.0.0 for what a set file has: component, attribute and unit, and the key of the set.

Angles are in degrees and lengths in millimeters on both sides. REXS states no signs and no zero of machine settings:
they are written as docs/signs.md has them, the machine center from the crossing point. What is not here has no name in
REXS.
"""

from __future__ import annotations

VERSION = "2.0.0"
#: Before the id of an attribute that REXS does not have; behind it the path of the key, with dots.
OWN = "custom_gearmath_"
MM, DEG, NONE = "mm", "deg", "none"

#: Key -> (attribute, unit), by component. A stage has the keys of the set.
STAGE = {"shaft_angle": ("shaft_angle", DEG)}
GEAR = {
    "teeth": ("number_of_teeth", NONE),
    "hand": ("spiral_angle_pitch_direction", NONE),
    "blank.pitch_angle": ("pitch_angle", DEG),
    "blank.face_angle": ("face_angle", DEG),
    "blank.root_angle": ("root_angle", DEG),
    "blank.mean_cone_distance": ("mean_cone_distance", MM),
    "blank.face_width": ("face_width", MM),
    "blank.mean_addendum": ("mean_addendum", MM),
    "blank.mean_dedendum": ("mean_dedendum", MM),
    "blank.clearance": ("clearance_iso_23509_2025", MM),
    "blank.pitch_apex_beyond_crossing_point": ("pitch_apex_beyond_crossing_point", MM),
}
MACHINE = {
    "radial_distance": ("radial_distance", MM),
    "cradle_angle": ("center_roll_position", DEG),
    "cutter_tilt": ("cutter_tilt", DEG),
    "cutter_swivel": ("cutter_swivel", DEG),
    "blank_offset": ("work_offset", MM),
    "sliding_base": ("sliding_base", MM),
    "machine_center_to_crossing_point": ("machine_center_to_crossing_point", MM),
    "machine_root_angle": ("machine_root_angle", DEG),
    "ratio_of_roll": ("ratio_of_roll", NONE),
}
TOOL = {
    "blade_point_radius": ("blade_point_radius", MM),
    "blade_pressure_angle": ("blade_pressure_angle", DEG),
    "blade_profile_height": ("blade_profile_height", MM),
    "blade_spheric_radius": ("blade_spheric_radius", MM),
    "blade_edge_radius": ("tool_edge_radius_bevel_gear_tool", MM),
}
#: Keys whose values are words, whatever they look like.
WORDS = {"title", "source", "hand", "cutting", "generation", "process", "flank"}


def right_flank(hand: str) -> str:
    """The right flank of a tooth, seen from the apex with its tip up: which of concave and convex it is."""
    return "convex" if hand == "left" else "concave"
