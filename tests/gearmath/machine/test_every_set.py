"""Every bundled set, cut from the text of its program without errors: one space, or in face hobbing all of them."""

from __future__ import annotations

import numpy as np
import pytest

from gearmath.bevel.tooth import SHARP_EDGE, tooth_space
from gearmath.machine.control.executor import execute
from gearmath.machine.judging.collision import collisions
from gearmath.machine.milling.mill import expose, mill_member
from gearmath.machine.milling.run import runs_of
from gearmath.machine.milling.surfaces import left_by_exact_motion, nominal_surfaces, surface_states
from gearmath.machine.planning.cut_plan import CuttingJob
from gearmath.machine.writing.cutting import cutting_program
from gearmath.specs.bevel_set import FLANKS, MEMBERS, BevelSet, load_bevel_set
from gearmath.specs.milling_machine import MillingMachine
from gearmath.specs.toml import bundled

SETS = (
    "nasa_tp3096_12x36",
    "spiral_7x43",
    "crown_gear_formate_14x39",
    "crown_gear_universal_14x39",
    "crown_gear_hobbed_14x39",
)


def with_edges(bevel_set: BevelSet) -> BevelSet:
    """The set with blade edges of 0.4 mm."""
    rounded = {
        name: bevel_set.member(name).model_copy(
            update={f: bevel_set.member(name).flank(f).model_copy(update={"blade_edge_radius": 0.4}) for f in FLANKS}
        )
        for name in MEMBERS
    }
    return bevel_set.model_copy(update=rounded)


def with_toprem(bevel_set: BevelSet) -> BevelSet:
    """The set with Toprem blades on the gear, 4 degrees steeper over the lowest 0.6 mm."""
    flanks = {f: bevel_set.gear.flank(f) for f in FLANKS}
    toprem = {
        f: spec.model_copy(update={"toprem_angle": spec.blade_pressure_angle - 4.0, "toprem_height": 0.6})
        for f, spec in flanks.items()
    }
    return bevel_set.model_copy(update={"gear": bevel_set.gear.model_copy(update=toprem)})


def with_arc_blades(bevel_set: BevelSet) -> BevelSet:
    """The set with blades of 400 mm radius on the pinion."""
    arcs = {
        f: bevel_set.pinion.flank(f).model_copy(update={"blade_spheric_radius": 400.0, "blade_reference_height": 3.0})
        for f in FLANKS
    }
    return bevel_set.model_copy(update={"pinion": bevel_set.pinion.model_copy(update=arcs)})


CASES = [(name, member, None) for name in SETS[:4] for member in MEMBERS] + [
    (SETS[0], "pinion", with_edges),
    (SETS[0], "gear", with_edges),
    (SETS[0], "pinion", with_arc_blades),
]


@pytest.mark.slow
@pytest.mark.parametrize(("gear_set", "name", "change"), CASES)
def test_program_of_a_tenth_of_a_micrometre_keeps_it_from_tip_to_root(
    gear_set: str, name: str, change, vertical: MillingMachine, host_compiler: tuple[str, ...]
) -> None:
    """Flanks over their whole depth, fillets and root of a space that all passes of all spaces may have touched.

    The passes differ in A alone, by whole pitches, so that every space has the same neighbours: one stands for all.
    The fillet of a sharp blade lies on a corner of the cutter, which moves by up to 1.2 times as much as its sides.
    """
    bevel_set = load_bevel_set(bundled(f"{gear_set}.toml"))
    if change:
        bevel_set = change(bevel_set)
    spec = bevel_set.member(name)
    path = execute(
        cutting_program(bevel_set, name, vertical, "EVERY_SET", CuttingJob(range(spec.teeth))), "EVERY_SET.MPF"
    )
    states = surface_states(path, spec, vertical, spaces=(0,), columns=9)
    for state in states:
        limit = 1.2e-4 if state.surface.endswith("fillet") else 1e-4  # mm
        assert -limit <= state.lowest, state
        assert state.highest <= limit, state
        assert (state.gouged, state.uncut) == (0, 0), state
    assert len(states) == 5
    runs = runs_of(path, spec, vertical, None, tooth_space(spec, 5))
    assert collisions(path, runs, spec, vertical) == []


@pytest.mark.slow
@pytest.mark.parametrize("name", MEMBERS)
@pytest.mark.parametrize("gear_set", SETS)
def test_flank_file_of_one_space_keeps_it(gear_set: str, name: str, vertical: MillingMachine) -> None:
    bevel_set = load_bevel_set(bundled(f"{gear_set}.toml"))
    member = bevel_set.member(name)
    spaces = range(member.teeth if member.process == "face_hobbing" else 1)
    text = cutting_program(bevel_set, name, vertical, "EVERY_SET", CuttingJob(spaces, tolerance=1e-4))
    measured = mill_member(execute(text, "EVERY_SET.MPF"), member, vertical)
    for flank in FLANKS:
        deviation = measured.select(flank).deviation
        assert len(deviation) == 45 + len(spaces) - 1
        assert np.abs(deviation).max() <= 1e-4  # mm


@pytest.mark.slow
def test_program_for_toprem_blades_leaves_what_their_exact_motion_leaves(
    vertical: MillingMachine, host_compiler
) -> None:
    """Where Toprem and main blade join, each cuts some micrometres off the other's surface: so does the program."""
    bevel_set = with_toprem(load_bevel_set(bundled("nasa_tp3096_12x36.toml")))
    spec, space = bevel_set.gear, tooth_space(bevel_set.gear, 9)
    path = execute(cutting_program(bevel_set, "gear", vertical, "TOPREM", CuttingJob(range(3))), "TOPREM.MPF")
    runs = runs_of(path, spec, vertical, None, space, SHARP_EDGE)
    for surface in nominal_surfaces(spec, space):
        exact = left_by_exact_motion(spec, space, surface)
        left = expose(runs, vertical, None, surface.point, surface.normal, surface.start).distance
        assert np.abs(left - exact).max() <= 1.2e-4  # mm, corners as above
        assert np.abs(exact).max() < 0.02
