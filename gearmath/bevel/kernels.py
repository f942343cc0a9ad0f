"""The lowered expressions that bevel, machine and quality compute with, each derived and lowered once per process."""

from __future__ import annotations

from functools import cache

from derivations import (
    axes,
    axis_calibration,
    blank,
    compensation,
    cutter,
    deviation,
    ease_off,
    flank,
    generation,
    meshing,
    probing,
    registration,
    spacing,
    tip_calibration,
    touch_errors,
)
from gearmath.lowering import Kernel, lower

_EXPRESSIONS = {
    "flank_family": flank.flank_family,
    "meshing": meshing.meshing,
    "contact_start": meshing.contact_start,
    "flank_place": blank.flank_place,
    "flank_angles": blank.flank_angles,
    "axis_transform": axes.axis_transform,
    "tool_pose": axes.tool_pose,
    "seen_from_tool": axes.seen_from_tool,
    "moved_settings": axes.moved_settings,
    "cutter_phase": axes.cutter_phase,
    "touching_blade": generation.touching_blade,
    "spheric_blade": cutter.spheric_blade,
    "straight_generation": generation.straight_generation,
    "arc_generation": generation.arc_generation,
    "curved_generation": generation.curved_generation,
    "arc_foot": generation.arc_foot,
    "point_deviation": deviation.point_deviation,
    "setting_sensitivity": deviation.setting_sensitivity,
    "deviation_surface": deviation.deviation_surface,
    "surface_orders": deviation.surface_orders,
    "line_entry": deviation.line_entry,
    "flank_turning": deviation.flank_turning,
    "probe_target": probing.probe_target,
    "space_azimuth": probing.space_azimuth,
    "probe_axes": probing.probe_axes,
    "probe_tip": probing.probe_tip,
    "touched_point": probing.touched_point,
    "sphere_residual": tip_calibration.sphere_residual,
    "ring_residual": tip_calibration.ring_residual,
    "carried_sphere": axis_calibration.carried_sphere,
    "face_calibration": tip_calibration.face_calibration,
    "effective_radius": tip_calibration.effective_radius,
    "lobing_of": tip_calibration.lobing_of,
    "shape_of_lobes": tip_calibration.shape_of_lobes,
    "unseated": registration.unseated,
    "motion_sensitivity": registration.motion_sensitivity,
    "ball_shift": spacing.ball_shift,
    "flank_allowance": spacing.flank_allowance,
    "tooth_at_points": spacing.tooth_at_points,
    "mean_module": spacing.mean_module,
    "tolerance_diameter": spacing.tolerance_diameter,
    "spacing_tolerances": spacing.spacing_tolerances,
    "straight_sensitivity": compensation.straight_sensitivity,
    "curved_sensitivity": compensation.curved_sensitivity,
    "coefficient_sensitivity": compensation.coefficient_sensitivity,
    "curved_height": compensation.curved_height,
    "root_place": compensation.root_place,
    "conjugate_place": compensation.conjugate_place,
    "conjugate_azimuth": ease_off.conjugate_azimuth,
    "ease_off": ease_off.ease_off,
    "touch_error": touch_errors.touch_error,
}


@cache
def kernel(name: str) -> Kernel:
    """The Kernel of the expression called ``name``."""
    return lower(_EXPRESSIONS[name]())
