"""Root and fillets of a pinion hobbed with a tilted cutter: designed, written, and cut blade by blade."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from gearmath.bevel.check_blade import check_blades
from gearmath.bevel.design.accepted import accepted
from gearmath.bevel.design.route import design
from gearmath.bevel.design.verdict import verdict
from gearmath.bevel.method import blade_sections
from gearmath.bevel.ridge import ridge_of_tips
from gearmath.bevel.tooth import space_widths, tooth_space
from gearmath.errors import InputError
from gearmath.machine.bodies.blades import blades_of
from gearmath.machine.control.executor import MachinePath, execute
from gearmath.machine.milling.hobbed_root import root_of_tips
from gearmath.machine.milling.run import runs_of
from gearmath.machine.milling.surfaces import nominal_surfaces, surface_states
from gearmath.machine.planning.cut_plan import CuttingJob
from gearmath.machine.writing.cutting import cutting_program
from gearmath.specs.bevel_set import BevelSet, Member, load_bevel_set
from gearmath.specs.design import DesignData
from gearmath.specs.milling_machine import MillingMachine, load_milling_machine
from gearmath.specs.toml import bundled, checked

TILTED = {
    "title": "15 x 41",
    "pinion_teeth": 15,
    "wheel_teeth": 41,
    "outer_transverse_module": 5.0,
    "face_width": 30.0,
    "cutter": {"cutter_radius": 88.0, "process": "face_hobbing", "blade_groups": 13},
    "pinion": {"cutting": "completing"},
}
#: A tilted cutter leaves the tips at unlike depths, and few teeth a space that is half as wide at the toe.
NARROW = (
    {
        "title": "13 x 38",
        "pinion_teeth": 13,
        "wheel_teeth": 38,
        "cutter": {"cutter_radius": 85.0, "process": "face_hobbing", "blade_groups": 13},
        "gear": {"generation": "formate"},
    },
    {
        "title": "9 x 40",
        "pinion_teeth": 9,
        "wheel_teeth": 40,
        "outer_transverse_module": 4.0,
        "face_width": 22.0,
        "cutter": {"cutter_radius": 80.0, "process": "face_hobbing", "blade_groups": 9},
        "gear": {"generation": "formate"},
    },
)
FLANKS = ("concave", "convex")


@cache
def pair() -> BevelSet:
    return design(checked(TILTED, DesignData, "tilted")).pair


@cache
def machine() -> MillingMachine:
    return load_milling_machine(bundled("vertical_5axis.toml"))


@cache
def path() -> MachinePath:
    """The blades' way is of the machine's settings alone: their heights are no part of it."""
    return path_of(pair())


def path_of(cut: BevelSet) -> MachinePath:
    job = CuttingJob(range(cut.member("pinion").teeth), tolerance=3e-4)
    return execute(cutting_program(cut, "pinion", machine(), "HOB", job), "HOB.MPF")


def level(member: Member) -> Member:
    """The member with all tips in the plane of the point radii."""
    flanks = {flank: member.flank(flank).model_copy(update={"blade_tip_height": 0.0}) for flank in FLANKS}
    return member.model_copy(update=flanks)


def test_blades_leave_flanks_fillets_and_root_of_the_set() -> None:
    """By the crossings of single blades with lines through the nominal surfaces."""
    member = pair().member("pinion")
    assert abs(member.concave.cutter_tilt) > 3
    for state in surface_states(path(), member, machine(), spaces=(7,)):
        assert state.unmet == 0, state
        assert state.lowest > -1e-4, state
        assert state.highest < 2e-3, state  # scallops of a coarse program


def test_tips_of_one_height_part_in_the_middle_of_the_space() -> None:
    """By what each kind of blade alone leaves of the root: that is why the tips have heights."""

    def step(member: Member) -> float:
        space = tooth_space(member, 7)
        *_, root = nominal_surfaces(member, space)
        middle = root.row == 1
        heights = []
        for flank in FLANKS:
            # the other tip is taken out of the way
            other = FLANKS[1 - FLANKS.index(flank)]
            away = member.flank(other).model_copy(
                update={"blade_tip_height": member.flank(other).blade_tip_height + 1.0}
            )
            alone = member.model_copy(update={other: away})
            moved, _ = root_of_tips(alone, root.point[middle], root.normal[middle])
            heights.append(((moved - root.point[middle]) * root.normal[middle]).sum(axis=1))
        return float(np.abs(heights[0] - heights[1]).mean())

    member = pair().member("pinion")
    assert step(level(member)) > 0.2
    assert step(member) < 0.05


def test_root_of_a_formate_gear_is_where_its_blades_leave_it() -> None:
    """13 x 38, blades without a height of their own: their planes are turned about the point radius, so what a tip cuts
    away from it is not what a blade of that radius would, by up to 2.7 um."""
    made = accepted(checked(TILTED | NARROW[0], DesignData, "narrow"))[0].pair
    member = made.member("gear")
    assert member.concave.blade_tip_height == member.convex.blade_tip_height == 0
    space = tooth_space(member, 7)
    cutting = execute(cutting_program(made, "gear", machine(), "HOB", CuttingJob(range(38), 5e-4)), "HOB.MPF")
    runs = runs_of(cutting, member, machine(), None, space)
    for state in surface_states(None, member, machine(), spaces=(2,), runs=runs, space=space):
        assert state.unmet == 0, state
        assert max(-state.lowest, state.highest) < 2e-4, state


@pytest.mark.parametrize("changes", NARROW, ids=lambda changes: str(changes["title"]))
def test_tips_of_a_space_that_narrows_towards_the_toe_stay_off_the_other_fillet(changes: dict[str, object]) -> None:
    """By the crossings of single blades, as above; a tip that is a tenth of a millimetre longer cuts into it."""
    made = accepted(checked(TILTED | changes, DesignData, "narrow"))[0].pair
    member = made.member("pinion")
    space = tooth_space(member, 7)
    runs = runs_of(path_of(made), member, machine(), None, space)
    (run,) = runs
    for state in surface_states(None, member, machine(), spaces=(2,), runs=runs, space=space):
        assert state.unmet == 0, state
        assert state.lowest > -1e-4, state
        assert state.highest < 2e-3, state
    longer = tuple(
        replace(edge, upper=edge.upper + 0.1) if (edge.flank, edge.part) == ("convex", "tip") else edge
        for edge in run.blades.edges
    )
    runs = [replace(run, blades=replace(run.blades, edges=longer))]
    states = surface_states(None, member, machine(), spaces=(2,), runs=runs, space=space)
    assert min(state.lowest for state in states if state.surface == "concave fillet") < -5e-3


def test_tips_cover_the_root_from_toe_to_heel() -> None:
    """What a round takes of a tip is r (1 - sin α) / cos α."""
    member = pair().member("pinion")
    _, slots = space_widths(member)
    tips = {edge.flank: edge.upper - edge.lower for edge in blades_of(member).edges if edge.part == "tip"}
    reach = 0.0
    for flank in FLANKS:
        spec = member.flank(flank)
        reach += tips[flank] + spec.blade_edge_radius * (1 - math.sin(spec.alpha)) / math.cos(spec.alpha)
    assert reach > max(slots[flank].most for flank in FLANKS)
    assert ridge_of_tips(member) == 0.0


def test_design_whose_tips_do_not_meet_at_the_heel_is_refused() -> None:
    data = {
        "title": "10 x 37",
        "pinion_teeth": 10,
        "wheel_teeth": 37,
        "outer_transverse_module": 3.0,
        "face_width": 18.0,
        "cutter": {"cutter_radius": 60.0, "process": "face_hobbing", "blade_groups": 11},
    }
    made = design(checked(TILTED | data, DesignData, "short"))
    with pytest.raises(
        InputError, match=r"^pinion: a ridge of \d+ um stays .* may be at most \d+ um high, 0\.5 of the"
    ):
        verdict(made)


@pytest.mark.parametrize("toprem", [{}, {"toprem_angle": 18.0, "toprem_height": 0.9}])
@pytest.mark.parametrize("flank", FLANKS)
def test_blade_with_a_longer_tip_is_the_one_whose_plane_lies_lower(flank: str, toprem: dict[str, float]) -> None:
    """Its point radius counted at the tip instead, by hand: the same sections, all of them that much higher."""
    side, height = {"concave": 1, "convex": -1}[flank], -0.4
    spec = pair().member("gear").flank(flank).model_copy(update={"blade_tip_height": height, **toprem})
    slope = math.tan(math.radians(spec.blade_pressure_angle))
    low = {
        "blade_tip_height": 0.0,
        "blade_point_radius": spec.blade_point_radius + side * height * slope,
        "blade_profile_height": spec.blade_profile_height - height,
    }
    if toprem:
        low["toprem_height"] = toprem["toprem_height"] - height
    one, other = blade_sections(spec, side), blade_sections(spec.model_copy(update=low), side)
    assert list(one) == list(other)
    for name, section in one.items():
        if name == "edge":
            assert section.arc == pytest.approx(np.add(other[name].arc, (0, height, 0)))
            continue
        assert section.lower == pytest.approx(other[name].lower + height)
        assert section.upper == pytest.approx(other[name].upper + height)
        radius, radius_of_other = (
            part.point_radius + side * at * math.tan(part.pressure_angle)
            for part, at in ((section, section.upper), (other[name], other[name].upper))
        )
        assert radius == pytest.approx(radius_of_other)


def test_milled_blades_have_no_tips_of_their_own() -> None:
    gear = load_bevel_set(bundled("nasa_tp3096_12x36.toml")).member("gear")
    values = gear.convex.model_copy(update={"blade_tip_height": 0.1})
    with pytest.raises(InputError, match=r"^gear\.convex\.blade_tip_height = 0\.1: belongs to face_hobbing"):
        check_blades(gear.model_copy(update={"convex": values}))
