"""The lowered expressions that bevel, machine and quality compute with, each derived and lowered once per process."""

from __future__ import annotations

from functools import cache

from derivations import axes, blank, deviation, flank, meshing
from gearmath.lowering import Kernel, lower

_EXPRESSIONS = {
    "flank_family": flank.flank_family,
    "meshing": meshing.meshing,
    "contact_start": meshing.contact_start,
    "flank_place": blank.flank_place,
    "axis_transform": axes.axis_transform,
    "tool_pose": axes.tool_pose,
    "point_deviation": deviation.point_deviation,
    "setting_sensitivity": deviation.setting_sensitivity,
    "deviation_surface": deviation.deviation_surface,
    "line_entry": deviation.line_entry,
    "flank_turning": deviation.flank_turning,
}


@cache
def kernel(name: str) -> Kernel:
    """The Kernel of the expression called ``name``."""
    return lower(_EXPRESSIONS[name]())
