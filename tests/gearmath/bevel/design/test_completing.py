"""Pinions that are cut completing, milled and hobbed: found again by differences, by definition, and blade by blade."""

from __future__ import annotations

import math
from functools import cache

import numpy as np
import pytest

from gearmath.bevel.blank import blank_of
from gearmath.bevel.contact.report import ARCSEC, SIDES, side_mesh
from gearmath.bevel.contact.system import Assembly, System, TouchPoint
from gearmath.bevel.crown_gear import Method, crown_gear_set
from gearmath.bevel.design import completing
from gearmath.bevel.design.crownings import crownings, miss
from gearmath.bevel.design.route import Designed, design
from gearmath.bevel.design.verdict import verdict, vertex
from gearmath.bevel.ease_off import ease_off, parts
from gearmath.bevel.flank import Margins, blank_grid, nominal_points
from gearmath.bevel.generation import solve_section
from gearmath.bevel.method import blade_sections, generation_of
from gearmath.bevel.pair import check_pair
from gearmath.bevel.root import mean_place
from gearmath.bevel.tooth import mean_backlash, mean_pitch_radius, mean_tooth_thickness
from gearmath.errors import InputError
from gearmath.kernels import kernel
from gearmath.machine.bodies.blades import blade_phase, blades_of
from gearmath.machine.planning.path import six_axes
from gearmath.specs.bevel_set import FLANKS, Member
from gearmath.specs.bevel_set import SIDES as FLANK_SIDES
from gearmath.specs.design import DesignData
from gearmath.specs.toml import checked
from tests.gearmath.bevel.design.family import mixed

MILLED = {
    "title": "12 x 36",
    "pinion_teeth": 12,
    "wheel_teeth": 36,
    "outer_transverse_module": 4.96,
    "face_width": 25.4,
    "cutter": {"cutter_radius": 76.2},
    "pinion": {"cutting": "completing"},
}
HOBBED = {**MILLED, "cutter": {"cutter_radius": 76.2, "process": "face_hobbing", "blade_groups": 9}}
STEPS = {
    "length_step": 0.001,
    "angle_step": 0.001,
    "ratio_step": 1e-6,
    "blade_angle_step": 0.25,
    "blade_radius_step": 0.05,
}
CASES = {"milled": MILLED, "hobbed": HOBBED, "milled in steps": {**MILLED, "shop": STEPS}}


@cache
def made(name: str) -> Designed:
    return design(checked(CASES[name], DesignData, name))


def error(system: System, touch: TouchPoint, by: float) -> float:
    """φ_2 + i φ_1 [rad] at a rotation of the pinion away from a contact."""
    there = system.solve(touch.x + by * touch.tangent, touch.rotation + by, (), np.zeros(4), 20)
    assert there is not None
    return system.transmission_error(there)


@pytest.mark.parametrize("side", SIDES)
@pytest.mark.parametrize("name", CASES)
def test_both_flanks_have_the_vertex_and_the_parabola_that_were_asked_for(name: str, side: str) -> None:
    designed, h = made(name), 0.02
    run = side_mesh(designed.pair, side, Assembly())
    found = vertex(run)
    assert found is not None
    before, here, after = (error(run.system, found.touch, by) for by in (-h, 0.0, h))
    amplitude = -run.system.sense * (before - 2 * here + after) / h**2 * (math.pi / 12) ** 2 / 2
    # what the steps of the shop leave is stated; without them it is 2 percent
    assert amplitude * ARCSEC == pytest.approx(8.0, rel=0.05 if designed.data.shop.length_step else 0.02)
    axial, radial = designed.flanks[side].request.place
    delta = math.radians(designed.pair.member("gear").blank.pitch_angle)
    # the place moves by the slope of the error over its second derivative: by 0.6 mm for what 1 um changes
    assert found.place[0] == pytest.approx(axial * math.cos(delta) + radial * math.sin(delta), abs=0.6)


@pytest.mark.parametrize("name", CASES)
def test_one_machine_cuts_both_flanks_and_leaves_the_backlash(name: str) -> None:
    designed = made(name)
    pinion, gear = (designed.pair.member(one) for one in ("pinion", "gear"))
    check_pair(designed.pair)
    assert pinion.cutting == gear.cutting == "completing"
    assert pinion.concave.motion == pinion.convex.motion
    pitch = 2 * math.pi * mean_pitch_radius(gear) / gear.teeth
    found = pitch - mean_tooth_thickness(pinion) - mean_tooth_thickness(gear)
    assert found == pytest.approx(designed.backlash, abs=0.001)


@pytest.mark.parametrize(("name", "rms"), [("milled", 10.0), ("hobbed", 2.0)])
def test_pair_runs_within_its_flanks_and_the_gap_that_is_left_is_small(name: str, rms: float) -> None:
    """Without steps: what settings shared by both flanks leave of two gaps of some 35 um at the ends of the tooth."""
    figures, _ = verdict(made(name))
    for side in SIDES:
        assert figures[side]["outcome"] == "interior contact"
        assert figures[side]["contact_ratio"] > 1
        assert figures[side]["ease_off_rms_um"] < rms


def test_alternating_blades_of_a_crown_gear_leave_the_backlash_of_the_blank() -> None:
    """Half a pitch of each space comes from the turn of the work between two blades, the rest from their radii."""
    data = checked(HOBBED, DesignData, "hobbed").blank_data(76.2)
    method = Method(alternating=True)
    pair = crown_gear_set(data, method, method)
    pinion, gear = (pair.member(name) for name in ("pinion", "gear"))
    # the blank's is that on the pitch cone at the mean point, where the crown gear cuts rightly
    assert mean_backlash(pinion, gear) == pytest.approx(blank_of(data).mean_transverse_backlash, abs=1e-3)
    for member in (pinion, gear):
        assert abs(blade_phase(member)) == pytest.approx(math.pi / 9)


def test_inner_blades_pass_the_convex_flank_where_they_follow_the_outer_ones() -> None:
    """The edge of a single blade on six axes (17.2), against the flank of the family (10.5) at its own settings."""
    pinion = made("hobbed").pair.member("pinion")
    points, _ = nominal_points(pinion, "convex", blank_grid(pinion))
    u, beta, theta = points.contact.T
    blades, ratio = blades_of(pinion), -9 / 12
    edge = next(one for one in blades.edges if (one.flank, one.part) == ("convex", "main"))
    pivot = (0.0, np.zeros(3))
    # the program is made of the concave flank; the blade at β stood there when C was behind by the phase
    axes = np.vstack(
        [
            six_axes(pinion.concave, t, b, ratio, *pivot)
            for t, b in zip(theta[:, None], beta[:, None] - edge.phase, strict=True)
        ]
    )
    (edges,) = kernel("straight_edge_point")(u, axes[:, :5], axes[:, 5] + edge.phase, *pivot, *edge.arguments)
    turn = 2 * math.pi / pinion.teeth  # a space further is the same
    azimuth = np.arctan2(edges[:, 1], edges[:, 0]) - np.arctan2(points.point[:, 1], points.point[:, 0])
    assert np.abs(azimuth / turn - np.round(azimuth / turn)).max() * turn < 1e-9
    assert np.hypot(edges[:, 0], edges[:, 1]) == pytest.approx(
        np.hypot(points.point[:, 0], points.point[:, 1]), abs=1e-9
    )
    assert edges[:, 2] == pytest.approx(points.point[:, 2], abs=1e-9)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"work_rotation_offset": 1.0}, None),
        ({"cradle_angle": -50.0}, "a completing cut has one cradle_angle for both flanks"),
    ],
)
def test_flanks_of_a_hobbed_member_may_differ_in_the_turn_of_the_work_alone(change: dict, said: str | None) -> None:
    """Its inner blades may follow the outer ones; a milled member that is cut completing has one turn for both."""
    for name in ("hobbed", "milled"):
        values = made(name).pair.member("pinion").model_dump()
        values["convex"] = {**values["convex"], **change}
        words = said or "a completing cut has one work_rotation_offset for both flanks"
        if name == "hobbed" and said is None:
            assert "work_rotation_offset" not in checked(values, Member, name).shared_settings
        else:
            with pytest.raises(InputError, match=words):
                checked(values, Member, name)


@pytest.mark.parametrize("side", SIDES)
def test_crownings_that_are_asked_for_are_those_of_the_ease_off_about_the_vertex(side: str) -> None:
    """The ease-off of chapter 24, which knows nothing of the design, on a fifth of the flank in both directions."""
    asked = {"lengthwise_crowning": 30.0, "profile_crowning": 4.0, "bias": 3.0}
    made = design(checked({**MILLED, "pinion": {}, "drive": asked, "coast": asked}, DesignData, "crowned"))
    pinion, gear = (made.pair.member(name) for name in ("pinion", "gear"))
    _, radial = made.flanks[side].request.place
    low, high = (float(kernel("flank_place")(gear.blank.vector, 0.5, up)[1]) for up in (0.0, 1.0))
    up, part = (radial - low) / (high - low), 0.2
    grid = blank_grid(gear, 9, 15, Margins(toe=0.4, heel=0.4, root=up - part / 2, tip=1 - up - part / 2))
    found = parts(1000 * ease_off(pinion, gear, made.pair.rad("shaft_angle"), SIDES[side], grid))
    # of 30 um a fiftieth is fourth order; rows of the grid lean by the taper, which shows as bias
    assert found.crowning / part**2 == pytest.approx(30.0, abs=0.6)
    assert found.profile_crowning / part**2 == pytest.approx(4.0, abs=0.3)
    assert found.twist / part**2 == pytest.approx(3.0, abs=0.8)
    # over the whole flank the third and fourth order count
    whole = crownings(made.pair, SIDES[side], made.flanks[side].request, made.data.contact(side))
    assert whole is not None
    for name, value in asked.items():
        assert whole[name] == {"asked": value, "found": pytest.approx(value, abs=1.0)}, name
    rms = 1000 * made.flanks[side].fitted.rms
    assert rms < 1.5
    assert miss(rms, whole) == ""


def test_crownings_that_one_machine_does_not_give_both_flanks_are_said() -> None:
    """Bias of 10 um on one flank and -10 um on the other, cut completing without tilt and helical motion."""
    crowned = {"lengthwise_crowning": 30.0, "profile_crowning": 10.0}
    sides = {"drive": {**crowned, "bias": 10.0}, "coast": {**crowned, "bias": -10.0}}
    made = design(checked({**MILLED, "pinion": {"cutting": "completing", "free": []}, **sides}, DesignData, "crowned"))
    for side in SIDES:
        found = crownings(made.pair, SIDES[side], made.flanks[side].request, made.data.contact(side))
        rms = 1000 * made.flanks[side].fitted.rms
        said = miss(rms, found)
        assert found is not None
        assert f"misses what was asked by {rms:.3g} um RMS, where 5 um are no miss" in said
        assert f"lengthwise_crowning {found['lengthwise_crowning']['found']:.3g} um, asked 30" in said
        assert "profile_crowning" not in said


@pytest.mark.parametrize(
    ("asked", "sentence"),
    [
        ({"lengthwise_crowning": 30.0}, "lengthwise_crowning: lengthwise_crowning and profile_crowning must both be"),
        ({"bias": 3.0}, "bias: lengthwise_crowning and profile_crowning must both be given"),
        ({"lengthwise_crowning": 30.0, "profile_crowning": 8.0, "path_angle": 60.0}, "takes the place of path_angle"),
        (
            {"lengthwise_crowning": 32.0, "profile_crowning": 8.0, "bias": 40.0},
            r"bias = 40 um: must be below 32 in size",
        ),
    ],
)
def test_crownings_that_cannot_be_are_refused(asked: dict, sentence: str) -> None:
    with pytest.raises(InputError, match=sentence):
        checked({**MILLED, "drive": asked}, DesignData, "crowned")


def test_modified_roll_comes_in_the_steps_of_the_shop() -> None:
    designed = design(checked({**MILLED, "shop": {**STEPS, "modified_roll_step": 1e-4}}, DesignData, "steps"))
    for flank in ("concave", "convex"):
        for value in designed.pair.member("pinion").flank(flank).motion.modified_roll:
            assert value / 1e-4 == pytest.approx(round(value / 1e-4), abs=1e-6)
            assert abs(value) > 1e-4


def test_flanks_are_the_same_where_the_cradle_angle_is_moved_to_their_middle(monkeypatch: pytest.MonkeyPatch) -> None:
    """Modified roll and helical motion count from another cradle angle then."""
    before = design(mixed(4)).pair.member("pinion")
    monkeypatch.setattr(completing, "_OFF_CENTER", 0.0)
    found = design(mixed(4)).pair.member("pinion")
    assert 3 < abs(found.concave.cradle_angle - before.concave.cradle_angle) < 5
    assert before.concave.motion.modified_roll
    assert before.concave.motion.sliding_base
    for flank in FLANKS:
        (points, _), (there, _) = (nominal_points(one, flank, blank_grid(one)) for one in (before, found))
        assert np.abs(there.point - points.point).max() < 1e-8


def test_cradle_of_a_hobbed_pinion_stands_in_the_middle_of_its_roll() -> None:
    """9 x 24: the fit moves the points of both flanks by 21 and 17 degrees; a set may have 15 at the most."""
    data = checked(mixed(18).model_dump(exclude_unset=True) | {"shop": STEPS}, DesignData, "18")
    pinion = design(data).pair.member("pinion")
    for flank in FLANKS:
        how, section = generation_of(pinion, flank), blade_sections(pinion.flank(flank), FLANK_SIDES[flank])["main"]
        assert abs(math.degrees(solve_section(how, section, *mean_place(pinion)).contact[0, 2])) < 3
