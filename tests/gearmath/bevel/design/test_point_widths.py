"""Point widths of the cutters of a tilted pinion, against what cutters that are moved along their whole way leave."""

from __future__ import annotations

import pytest

from gearmath.bevel.design.point_widths import far_sides_note, fillet_room
from gearmath.bevel.design.route import design
from gearmath.bevel.tooth import tooth_space
from gearmath.machine.milling.surfaces import left_by_exact_motion, nominal_surfaces
from gearmath.specs.bevel_set import Member
from gearmath.specs.design import DesignData
from gearmath.specs.toml import checked

TILTED = {
    "title": "12 x 41",
    "pinion_teeth": 12,
    "wheel_teeth": 41,
    "outer_transverse_module": 4.0,
    "face_width": 25.0,
    "cutter": {"cutter_radius": 76.2},
    "gear": {"generation": "formate"},
    "pinion": {"free": ["blade_pressure_angle", "cutter_tilt"]},
}


@pytest.fixture(scope="module")
def pinion() -> Member:
    return design(checked(TILTED, DesignData, "design")).pair.member("pinion")


def with_width(member: Member, width: float | None) -> Member:
    return member.model_copy(update={"convex": member.convex.model_copy(update={"blade_point_width": width})})


def left_on_the_concave_fillet(member: Member) -> float:
    """The least that all cutters leave on the fillet [mm]."""
    space = tooth_space(member, 5)
    (fillet,) = (one for one in nominal_surfaces(member, space) if one.name == "concave fillet")
    return float(left_by_exact_motion(member, space, fillet).min())


def test_no_cutter_of_a_designed_pinion_cuts_into_the_other_fillet(pinion) -> None:
    """Programs are refused from 1.1 um on; the width chosen for the slot, 1.09 mm, cut 54 um deep at the toe."""
    assert pinion.convex.blade_point_width == pytest.approx(0.98, abs=0.02)
    assert left_on_the_concave_fillet(pinion) > -1.1e-3


@pytest.mark.parametrize("width", [1.02, 1.09, 1.15])
def test_depth_is_what_the_moved_cutter_takes_and_is_said(pinion, width) -> None:
    """A tenth: the fillet is looked at in sections, where the moved cutter is seen from its points."""
    member = with_width(pinion, width)
    taken = left_on_the_concave_fillet(member)
    assert taken < -10e-3
    assert fillet_room(member, "convex", width) == pytest.approx(taken, rel=0.1)
    said = far_sides_note(member, tooth_space(member))
    depth = -1000 * fillet_room(member, "convex", width)
    assert f"of {width:.3f} mm point width cuts {depth:.0f} um into the concave fillet" in said
    assert "blade_point_width must be at most 0.98 mm" in said
