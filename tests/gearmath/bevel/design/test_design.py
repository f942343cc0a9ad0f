"""Pairs out of a few data: what was asked for, found again in the exact contact by differences; symmetry; the shop."""

from __future__ import annotations

import math
from functools import cache

import numpy as np
import pytest

from gearmath.bevel.contact.report import ARCSEC, SIDES, side_system
from gearmath.bevel.contact.system import System, TouchPoint
from gearmath.bevel.design.local_settings import NAMES
from gearmath.bevel.design.route import Designed, design
from gearmath.bevel.design.verdict import verdict
from gearmath.bevel.pair import check_pair
from gearmath.bevel.tooth import mean_pitch_radius, mean_tooth_thickness
from gearmath.errors import InputError
from gearmath.specs.bevel_set import SETTINGS, load_bevel_set
from gearmath.specs.cut import ANGULAR
from gearmath.specs.design import DesignData, load_design
from gearmath.specs.shop_steps import to_step
from gearmath.specs.toml import bundled, checked

GENERATED = {
    "title": "12 x 36",
    "pinion_teeth": 12,
    "wheel_teeth": 36,
    "outer_transverse_module": 4.96,
    "face_width": 25.4,
    "cutter": {"cutter_radius": 76.2},
}
FORMATE = {
    "title": "14 x 39",
    "pinion_teeth": 14,
    "wheel_teeth": 39,
    "outer_transverse_module": 4.5358,
    "face_width": 25.4,
    "cutter": {"cutter_radius": 114.3},
    "gear": {"generation": "formate"},
}


def data(base: dict, **changes) -> DesignData:
    return checked({**base, **changes}, DesignData, "design")


@cache
def made(name: str) -> Designed:
    if name == "7x43":
        return design(load_design(bundled("design_7x43.toml")))
    return design(data({"generated": GENERATED, "formate": FORMATE}[name]))


def contact_where_asked(designed: Designed, side: str) -> tuple[System, TouchPoint]:
    """The exact contact at the vertex, by Newton's method from the settings and the place on the gear."""
    system = side_system(designed.pair, side)
    flank = designed.flanks[side]
    point = system.gear.solve(*(np.array([one]) for one in flank.request.place))
    start = np.concatenate([flank.x[:2], [0.0], point.contact[0], [0.0]])
    # at θ = 0 of the pinion both flanks have that point: the rotations follow from their azimuths
    own = system.pinion.function(start[:3])[0]
    rotation = math.atan2(*flank.request.roll.point[1::-1]) - math.atan2(float(own[1]), float(own[0]))
    rotation = math.remainder(rotation - system.phase[0], 2 * math.pi)
    start[6] = math.remainder(flank.request.roll.turn - system.phase[1], 2 * math.pi)
    for shift in (0.0, *np.linspace(-0.02, 0.02, 9)):
        found = system.solve(start, rotation + shift, (), np.zeros(4), 30)
        if found is not None:
            return system, found
    raise AssertionError("no contact where it was asked for")


def error(system: System, touch: TouchPoint, by: float) -> float:
    """φ_2 + i φ_1 [rad] at a rotation of the pinion away from a contact."""
    there = system.solve(touch.x + by * touch.tangent, touch.rotation + by, (), np.zeros(4), 20)
    assert there is not None
    return system.transmission_error(there)


@pytest.mark.parametrize("side", SIDES)
@pytest.mark.parametrize("name", ["generated", "formate", "7x43"])
def test_transmission_error_has_the_vertex_and_the_parabola_that_were_asked_for(name: str, side: str) -> None:
    designed, h = made(name), 0.02
    system, touch = contact_where_asked(designed, side)
    before, here, after = (error(system, touch, by) for by in (-h, 0.0, h))
    half_pitch = math.pi / system.pinion.teeth
    asked = designed.data.contact(side).transmission_error / ARCSEC
    second = -system.sense * (before - 2 * here + after) / h**2
    # the steps of the shop of the 7 x 43 pair move settings by 0.5 µm; third order adds h²/12 of the fourth derivative
    assert second * half_pitch**2 / 2 == pytest.approx(asked, rel=0.005)
    slope = (after - before) / (2 * h)
    assert abs(slope) < 0.02 * abs(second) * half_pitch
    assert (touch.margins > 0).all()


@pytest.mark.parametrize("side", SIDES)
def test_path_runs_over_the_gear_as_asked(side: str) -> None:
    designed, h = made("generated"), 0.002
    system, touch = contact_where_asked(designed, side)
    places, points = [], []
    for by in (-h, h):
        there = system.solve(touch.x + by * touch.tangent, touch.rotation + by, (), np.zeros(4), 20)
        assert there is not None
        points.append(np.asarray(system.gear.function(there.x[3:6])[0]).ravel())
        places.append(there)
    R, n = (np.asarray(one).ravel() for one in system.gear.function(touch.x[3:6])[:2])
    root = math.radians(designed.pair.member("gear").blank.root_angle)
    outwards = np.array([R[0], R[1], 0.0]) / math.hypot(R[0], R[1])
    along = math.cos(root) * np.array([0, 0, 1.0]) + math.sin(root) * outwards
    up = math.cos(root) * outwards - math.sin(root) * np.array([0, 0, 1.0])
    along = along - along @ n * n
    along /= np.linalg.norm(along)
    across = np.cross(n, along)
    across *= np.sign(across @ up)
    way = points[1] - points[0]
    angle = math.degrees(math.atan2(way @ across, way @ along)) % 180
    assert angle == pytest.approx(math.degrees(designed.flanks[side].request.path_angle), abs=0.05)


@pytest.mark.parametrize("name", ["generated", "formate", "7x43"])
def test_teeth_leave_the_backlash_at_the_mean_point(name: str) -> None:
    designed = made(name)
    pinion, gear = (designed.pair.member(one) for one in ("pinion", "gear"))
    pitch = 2 * math.pi * mean_pitch_radius(gear) / gear.teeth
    found = pitch - mean_tooth_thickness(pinion) - mean_tooth_thickness(gear)
    assert found == pytest.approx(designed.backlash, abs=0.001)


def test_gear_turns_by_the_backlash_from_one_flank_to_the_other() -> None:
    """By the exact contact of both sides at one position of the pinion, but for their transmission errors."""
    designed = made("generated")
    gear = designed.pair.member("gear")
    turns = []
    for side in SIDES:
        system, touch = contact_where_asked(designed, side)
        # the gear where this contact would be with the pinion's own frame at zero, at the constant ratio
        at = touch.rotation + system.phase[0]
        turns.append(touch.x[6] + system.phase[1] + system.ratio * at)
    pitch = 2 * math.pi / gear.teeth
    play = abs(math.remainder(turns[0] - turns[1], pitch)) * mean_pitch_radius(gear)
    amplitude = 2 * 8.0 / ARCSEC * mean_pitch_radius(gear)
    assert play == pytest.approx(designed.backlash, abs=2 * amplitude + 0.01)


@pytest.mark.parametrize("name", ["generated", "formate", "7x43"])
def test_set_is_a_pair_with_teeth_that_are_thick_enough(name: str) -> None:
    figures, _ = verdict(made(name))
    least = 0.2 * figures["mean_normal_module_mm"]
    for land in figures["top_land_mm"].values():
        assert min(land.values()) > least
    for side in SIDES:
        assert figures[side]["outcome"] == "interior contact"
        assert figures[side]["contact_ratio"] > 1
        assert figures[side]["ease_off_rms_um"] < 1.5


def test_other_hand_is_the_mirror_image() -> None:
    left, right = made("generated").pair.member("pinion"), design(data(GENERATED, hand="right")).pair.member("pinion")
    for flank in ("concave", "convex"):
        one, other = left.flank(flank), right.flank(flank)
        for name in SETTINGS:
            sign = -1 if name in ("cradle_angle", "blank_offset", "work_rotation_offset") else 1
            assert getattr(other, name) == pytest.approx(sign * getattr(one, name), abs=1e-6), name


def test_root_of_a_tilted_pinion_is_that_of_the_blank() -> None:
    """The machine stands flatter by about the tilt; the set's check watches the root to parts of the clearance."""
    designed = made("formate")
    pinion = designed.pair.member("pinion")
    assert pinion.concave.cutter_tilt > 5
    assert pinion.concave.machine_root_angle < pinion.blank.root_angle - 0.7 * pinion.concave.cutter_tilt
    check_pair(designed.pair)


def test_uniform_depth_with_little_asked_comes_near_the_common_crown_gear() -> None:
    """Limit: with uniform depth one crown gear cuts a conjugate pair: no offset, and it rolls on the pitch cone."""
    gentle = {"transmission_error": 0.5, "pattern_length": 1.5, "path_angle": 90.0}
    uniform = data(GENERATED, taper={"kind": "uniform"}, drive=gentle, coast=gentle, pinion={"free": []})
    pinion = design(uniform).pair.member("pinion")
    rolling = 1 / math.sin(math.radians(pinion.blank.pitch_angle))
    for flank in ("concave", "convex"):
        assert abs(pinion.flank(flank).blank_offset) < 0.5
        assert pinion.flank(flank).ratio_of_roll == pytest.approx(rolling, rel=0.01)


def test_settings_come_in_the_steps_of_the_shop() -> None:
    steps = {
        "length_step": 0.01,
        "angle_step": 0.005,
        "ratio_step": 1e-5,
        "blade_angle_step": 0.5,
        "blade_radius_step": 0.1,
    }
    designed = design(data(GENERATED, shop=steps))
    for member in designed.pair.members.values():
        for flank in ("concave", "convex"):
            for name in SETTINGS:
                step = steps.get(
                    {
                        "blade_pressure_angle": "blade_angle_step",
                        "blade_point_radius": "blade_radius_step",
                        "ratio_of_roll": "ratio_step",
                    }.get(name, "")
                )
                step = step or steps["angle_step" if name in ANGULAR else "length_step"]
                value = getattr(member.flank(flank), name)
                assert to_step(value, step) == pytest.approx(value, abs=1e-9), name
    figures, _ = verdict(designed)
    for side in SIDES:
        second = figures[side]["second_derivative"]
        assert second["found"] == pytest.approx(second["asked"], rel=0.05)
        assert figures[side]["remarks"] == []


def test_steps_that_make_another_parabola_are_said() -> None:
    """A step of 0.001 of the ratio of roll is a large part of what gives the transmission error its curvature."""
    figures, _ = verdict(design(data(GENERATED, shop={"angle_step": 0.05, "length_step": 0.05, "ratio_step": 1e-3})))
    for side in SIDES:
        second = figures[side]["second_derivative"]
        off = second["found"] / second["asked"] - 1
        assert abs(off) > 0.03
        (said,) = figures[side]["remarks"]
        assert f"change the second derivative at the vertex by {off:+.1%}, where 2% is no remark" in said


def test_pinion_to_a_given_gear_leaves_gear_and_blanks_alone() -> None:
    given = load_bevel_set(bundled("nasa_tp3096_12x36.toml"))
    designed = design(data(GENERATED), given=given)
    assert designed.pair.member("gear") == given.member("gear")
    assert designed.pair.member("pinion").blank == given.member("pinion").blank
    figures, _ = verdict(designed)
    assert {figures[side]["outcome"] for side in SIDES} == {"interior contact"}


def test_what_is_held_at_the_mean_point_does_not_give_way_to_the_whole_flank() -> None:
    held = design(data(GENERATED, pinion={"free": []})).flanks["drive"]
    free = made("generated").flanks["drive"]
    assert free.fitted.rms < held.fitted.rms
    assert abs(free.x[NAMES.index("blade_pressure_angle")] - held.x[NAMES.index("blade_pressure_angle")]) > 1e-3
    assert np.abs(free.request.curvature - held.request.curvature).max() < 1e-12


def test_too_wide_and_too_narrow_a_face_are_refused_before_anything_is_computed_for_it(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """0.35 of the outer cone distance are allowed, as in a set: it is 66 mm / sin(71.565 degrees) = 69.57 mm here."""
    monkeypatch.setattr("gearmath.bevel.design.route.request", None)
    data = {
        "title": "too wide",
        "pinion_teeth": 11,
        "wheel_teeth": 33,
        "outer_transverse_module": 4.0,
        "face_width": 25.0,
        "cutter": {"cutter_radius": 70.0},
    }
    for width, sentence in (
        (25.0, r"face_width = 25: must be at most 0\.35 of the outer cone distance, 24\.35 mm"),
        (2.0, r"face_width = 2: must lie between 6\.957 and 24\.35 mm, 0\.1 and 0\.35 of the outer cone distance"),
    ):
        with pytest.raises(InputError, match=f"^design data: {sentence}$"):
            design(checked({**data, "face_width": width}, DesignData, "wide"))
