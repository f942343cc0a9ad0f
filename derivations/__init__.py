"""What is true, and why: one chapter a file, SymPy only, equations numbered, each with its ``prove_*`` functions."""

from __future__ import annotations

import importlib
from collections.abc import Callable, Iterator

from derivations.expression import Expression, Quantity

CHAPTERS = ("frames", "cutter", "cradle", "flank", "meshing", "axes", "deviation", "gearbox", "blank", "generation")

__all__ = ["CHAPTERS", "Expression", "Quantity", "expressions", "proofs"]


def expressions() -> Iterator[Expression]:
    """Every Expression of every chapter, derived on demand."""
    from derivations import axes, blank, cradle, cutter, deviation, flank, gearbox, generation, meshing

    yield from (cutter.cutter_surface(), cutter.toprem(), cutter.spheric_blade())
    yield from (cutter.edge_round(), cutter.edge_round_of_arc())
    yield cradle.cradle_pose()
    yield flank.flank_family()
    yield from (meshing.meshing(), meshing.contact_start(), blank.flank_place())
    yield from (generation.straight_generation(), generation.arc_generation(), generation.modified_roll())
    yield from (axes.axis_transform(), axes.tool_pose(), axes.cradle_tool_pose())
    yield from (deviation.point_deviation(), deviation.setting_sensitivity())
    yield from (deviation.deviation_surface(), deviation.line_entry(), deviation.flank_turning())
    yield from (gearbox.gearbox_ratio(), gearbox.gearbox_terms(), gearbox.gearbox_start(), gearbox.desired_position())
    yield from (
        gearbox.nearest_position(),
        gearbox.floor_position(),
        gearbox.gearbox_step(),
        gearbox.gearbox_edge(),
        gearbox.encoder_hysteresis(),
        gearbox.hobbed_blank(),
    )


def proofs() -> Iterator[Callable[[], None]]:
    """Every ``prove_*`` function of every chapter."""
    for chapter in CHAPTERS:
        module = importlib.import_module(f"derivations.{chapter}")
        yield from (getattr(module, name) for name in sorted(vars(module)) if name.startswith("prove_"))
