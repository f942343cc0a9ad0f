"""Root and fillets of a pinion hobbed with a tilted cutter: designed, written, and cut blade by blade."""

from __future__ import annotations

import math
from functools import cache

import numpy as np
import pytest

from gearmath.bevel.check_blade import check_blades
from gearmath.bevel.design.route import design
from gearmath.bevel.method import blade_sections
from gearmath.bevel.tooth import space_widths, tooth_space
from gearmath.errors import InputError
from gearmath.machine.bodies.blades import blades_of
from gearmath.machine.control.executor import MachinePath, execute
from gearmath.machine.milling.hobbed_root import root_of_tips
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
    job = CuttingJob(range(15), tolerance=5e-4)
    return execute(cutting_program(pair(), "pinion", machine(), "HOB", job), "HOB.MPF")


def level(member: Member) -> Member:
    """The member with all tips in the plane of the point radii."""
    flanks = {flank: member.flank(flank).model_copy(update={"blade_tip_height": 0.0}) for flank in FLANKS}
    return member.model_copy(update=flanks)


def test_blades_leave_flanks_fillets_and_root_of_the_set() -> None:
    """By the crossings of single blades with lines through the nominal surfaces."""
    member = pair().member("pinion")
    assert abs(member.concave.cutter_tilt) > 3
    for state in surface_states(path(), member, "pinion", machine(), spaces=(7,)):
        assert state.unmet == 0, state
        assert state.lowest > -1e-4, state
        assert state.highest < 2e-3, state  # scallops of a coarse program


def test_tips_of_one_height_part_in_the_middle_of_the_space() -> None:
    """By what each kind of blade alone leaves of the root: that is why the tips have heights."""

    def step(member: Member) -> float:
        space = tooth_space(member, "pinion", 7)
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


def test_tips_cover_the_root_and_stay_off_the_fillet_of_the_other_blade() -> None:
    """What a round takes of a tip is r (1 - sin α) / cos α."""
    member = pair().member("pinion")
    _, slots = space_widths(member, "pinion")
    taken = {}
    for flank in FLANKS:
        spec = member.flank(flank)
        taken[flank] = spec.blade_edge_radius * (1 - math.sin(spec.alpha)) / math.cos(spec.alpha)
    tips = [edge for edge in blades_of(member).edges if edge.part == "tip"]
    assert [tip.flank for tip in tips] == list(FLANKS)
    for tip in tips:
        reach = taken[tip.flank] + tip.upper - tip.lower
        assert reach > slots[tip.flank].most / 2
        assert reach < slots[tip.flank].least - taken[FLANKS[1 - FLANKS.index(tip.flank)]]


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
        check_blades(gear.model_copy(update={"convex": values}), "gear")
