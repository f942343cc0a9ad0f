"""What is true, and why: one chapter a file, SymPy only, equations numbered, each with its ``prove_*`` functions."""

from __future__ import annotations

import importlib
from collections.abc import Callable, Iterator

from derivations.expression import Expression, Quantity

CHAPTERS = (
    "frames", "cutter", "cradle", "flank", "meshing", "axes", "deviation", "gearbox", "blank", "hobbing",
    "check_dimensions", "generation", "iso23509", "lengthwise", "tooth_width", "crown_gear",
    "sweep", "probing", "registration", "spacing", "compensation", "ease_off", "touch_errors", "single_blades",
    "axis_calibration", "tip_calibration",
)  # fmt: skip

__all__ = ["CHAPTERS", "Expression", "Quantity", "expressions", "proofs"]


def expressions() -> Iterator[Expression]:
    """Every Expression of every chapter, derived on demand."""
    from derivations import (
        axes,
        axis_calibration,
        blank,
        check_dimensions,
        compensation,
        cradle,
        cutter,
        deviation,
        ease_off,
        flank,
        gearbox,
        generation,
        hobbing,
        meshing,
        probing,
        registration,
        single_blades,
        spacing,
        sweep,
        tip_calibration,
        touch_errors,
    )

    yield from (cutter.cutter_surface(), cutter.toprem(), cutter.spheric_blade())
    yield from (cutter.edge_round(), cutter.edge_round_of_arc())
    yield cradle.cradle_pose()
    yield flank.flank_family()
    yield from (meshing.meshing(), meshing.contact_start(), blank.flank_place(), blank.flank_angles())
    yield cradle.advance_from_apex()
    yield from (generation.straight_generation(), generation.arc_generation(), generation.modified_roll())
    yield from (generation.curved_generation(), generation.arc_foot(), generation.touching_blade())
    yield from (axes.axis_transform(), axes.tool_pose(), axes.cradle_tool_pose())
    yield from (axes.seen_from_tool(), axes.moved_settings(), axes.cutter_phase())
    yield from (deviation.point_deviation(), deviation.setting_sensitivity())
    yield from (deviation.deviation_surface(), deviation.line_entry(), deviation.flank_turning())
    yield deviation.surface_orders()
    yield from (sweep.line_in_cone(), sweep.first_removed(), sweep.place_in_cutter())
    yield from (sweep.cutter_excess(), sweep.seated())
    yield from (registration.unseated(), registration.motion_sensitivity())
    yield from (spacing.ball_shift(), spacing.flank_allowance(), spacing.tooth_at_points())
    yield from (spacing.mean_module(), spacing.tolerance_diameter(), spacing.spacing_tolerances())
    yield from (single_blades.tool_frame(), single_blades.cradle_tool_frame(), single_blades.straight_edge_point())
    yield from (single_blades.arc_edge_point(), single_blades.seen_from_blades(), single_blades.roll_per_turn())
    yield from (probing.probe_target(), probing.space_azimuth(), probing.probe_axes(), probing.probe_tip())
    yield from (probing.touched_point(), tip_calibration.ring_calibration(), tip_calibration.sphere_residual())
    yield from (
        tip_calibration.effective_radius(),
        tip_calibration.lobing_of(),
        tip_calibration.shape_of_lobes(),
        tip_calibration.ring_residual(),
    )
    yield from (tip_calibration.face_calibration(), axis_calibration.carried_sphere())
    yield from (compensation.straight_sensitivity(), compensation.curved_sensitivity())
    yield from (compensation.coefficient_sensitivity(), compensation.curved_height(), compensation.root_place())
    yield from (compensation.conjugate_place(), ease_off.conjugate_azimuth(), ease_off.ease_off())
    yield touch_errors.touch_error()
    yield from (gearbox.gearbox_ratio(), gearbox.gearbox_terms(), gearbox.gearbox_start(), gearbox.desired_position())
    yield from (
        gearbox.nearest_position(),
        gearbox.floor_position(),
        gearbox.gearbox_step(),
        gearbox.gearbox_edge(),
        gearbox.encoder_hysteresis(),
        gearbox.hobbed_blank(),
        gearbox.run_up(),
        gearbox.catch_up(),
        gearbox.resolution(),
    )
    yield from (hobbing.hob_ratio(), hobbing.feed_ratio(), hobbing.feed_error(), hobbing.lead_screw_ratio())
    yield from (hobbing.helical_lead(), hobbing.swivel(), hobbing.fed_ratio())
    yield from (check_dimensions.transverse_gear(), check_dimensions.helical_blank())
    yield from (check_dimensions.span_teeth(), check_dimensions.span_measurement())
    yield from (check_dimensions.chordal_thickness(), check_dimensions.pin_equation(), check_dimensions.over_pins())
    yield from _bevel_blank()


def _bevel_blank() -> Iterator[Expression]:
    from derivations import crown_gear, iso23509, lengthwise, tooth_width

    yield from (iso23509.wheel_size(), iso23509.pitch_cones(), iso23509.crown_gear_factors(), iso23509.mean_depths())
    yield from (iso23509.taper_angles(), iso23509.cone_angles(), iso23509.cone_apexes(), iso23509.pinion_depth())
    yield iso23509.blank_ends()
    yield from (lengthwise.milled_spiral_angle(), lengthwise.hobbing_cutter(), lengthwise.hobbed_spiral_angle())
    yield from (lengthwise.involute_curvature(), lengthwise.milled_radius())
    yield from (tooth_width.tooth_thickness(), tooth_width.chordal_tooth(), tooth_width.slot_widths())
    yield from (tooth_width.virtual_gear(), tooth_width.top_land(), tooth_width.running_interference())
    yield tooth_width.edge_radii()
    yield from (crown_gear.crown_gear_flank(), crown_gear.crown_gear_space(), crown_gear.blade_in_space())


def proofs() -> Iterator[Callable[[], None]]:
    """Every ``prove_*`` function of every chapter."""
    for chapter in CHAPTERS:
        module = importlib.import_module(f"derivations.{chapter}")
        yield from (getattr(module, name) for name in sorted(vars(module)) if name.startswith("prove_"))
