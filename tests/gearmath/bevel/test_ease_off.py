"""The ease-off of pairs whose ease-off is known, and what of it the check of a pair refuses."""

from __future__ import annotations

import cmath
import math
import tomllib
from collections.abc import Callable

import numpy as np
import pytest

from gearmath.bevel.check_ease_off import check_ease_off
from gearmath.bevel.ease_off import Parts, ease_off, hollow, parts
from gearmath.bevel.flank import blank_grid
from gearmath.bevel.misfit import Misfit
from gearmath.bevel.pair import check_pair, load_pair
from gearmath.errors import InputError
from gearmath.specs.bevel_set import FLANKS, BevelSet, Member
from gearmath.specs.toml import bundled, checked

SETS = (
    "nasa_tp3096_12x36",
    "spiral_7x43",
    "crown_gear_formate_14x39",
    "crown_gear_universal_14x39",
    "crown_gear_hobbed_14x39",
)
#: A pair of uniform depth: both members roll on the pitch plane of one crown gear.
PINION, GEAR, CONE, SPIRAL, ALPHA, RADIUS, DEPTH = 14, 39, 80.0, math.radians(35), math.radians(20), 100.0, 4.0


def member(teeth: int, hand: int, radius: float = RADIUS) -> Member:
    """A member cut by the crown gear: its mean point is at CONE on the real axis, the cutter's centre beside it."""
    mate = PINION + GEAR - teeth
    delta = math.atan2(teeth, mate)
    center = CONE - radius * cmath.exp(-1j * (math.pi / 2 - SPIRAL))
    flank = {
        "radial_distance": abs(center),
        "cradle_angle": math.degrees(hand * cmath.phase(center)),
        "cutter_tilt": 0.0,
        "cutter_swivel": 0.0,
        "blank_offset": 0.0,
        "sliding_base": -DEPTH,
        "machine_center_to_crossing_point": 0.0,
        "machine_root_angle": math.degrees(delta),
        "ratio_of_roll": 1 / math.sin(delta),
        "work_rotation_offset": 0.0,
        "blade_pressure_angle": math.degrees(ALPHA),
        "blade_profile_height": 17.0,
    }
    # blades of both members are the two sides of one cone: on the pitch plane, DEPTH above their tips, of one radius
    radii = {"concave": radius - DEPTH * math.tan(ALPHA), "convex": radius + DEPTH * math.tan(ALPHA)}
    angle = math.degrees(delta)
    values = {
        "teeth": teeth,
        "hand": "right" if hand > 0 else "left",
        "cutting": "fixed_setting",
        "blank": {
            "pitch_angle": angle,
            "face_angle": angle,
            "root_angle": angle,
            "mean_cone_distance": CONE,
            "face_width": 20.0,
            "mean_addendum": 3.2,
            "mean_dedendum": DEPTH,
            "clearance": 0.8,
        },
        **{name: {**flank, "blade_point_radius": radii[name]} for name in FLANKS},
    }
    return checked(values, Member, "member")


def flank_parts(pinion: Member, gear: Member, flank: str = "concave"):
    return parts(ease_off(pinion, gear, math.pi / 2, flank, blank_grid(gear)))


@pytest.mark.parametrize("flank", FLANKS)
@pytest.mark.parametrize("hand", [1, -1])
def test_pair_of_one_crown_gear_that_rolls_on_its_pitch_plane_is_conjugate(flank: str, hand: int) -> None:
    pinion, gear = member(PINION, hand), member(GEAR, -hand)
    assert np.abs(ease_off(pinion, gear, math.pi / 2, flank, blank_grid(gear))).max() < 1e-8


@pytest.mark.parametrize(("flank", "sense"), [("concave", -1), ("convex", 1)])
def test_another_cutter_radius_crowns_by_the_difference_of_the_curvatures(flank: str, sense: int) -> None:
    # in the pitch plane two arcs leave their common tangent by s²/2r; a concave flank of smaller radius bridges
    smaller = 95.0
    found = flank_parts(member(PINION, 1, smaller), member(GEAR, -1), flank)
    half = 0.8 * 20.0 / 2 / math.cos(SPIRAL)
    gap = sense * half**2 / 2 * (1 / smaller - 1 / RADIUS) * math.cos(ALPHA)
    assert found.crowning == pytest.approx(gap, rel=0.1)  # the spiral angle changes along the tooth
    assert abs(found.slope) < 0.25 * abs(gap)


def test_pressure_angle_of_one_member_slopes_the_ease_off_by_the_height() -> None:
    pinion, gear = member(PINION, 1), member(GEAR, -1)
    steeper = math.radians(1)
    # the blade turns about its point on the pitch plane
    spec = pinion.concave.model_copy(
        update={
            "blade_pressure_angle": math.degrees(ALPHA + steeper),
            "blade_point_radius": RADIUS - DEPTH * math.tan(ALPHA + steeper),
        }
    )
    found = flank_parts(pinion.model_copy(update={"concave": spec}), gear)
    # half of 80 % of the working depth; along the blade h/cos α, at its end off by the angle
    half = 0.8 * (2 * 3.2) / 2 / math.cos(ALPHA) * steeper
    assert abs(found.profile_slope) == pytest.approx(half, rel=0.15)
    assert abs(found.slope) < 0.2 * half


@pytest.mark.parametrize("name", SETS)
def test_bundled_pair_passes_with_half_of_every_limit(name: str, monkeypatch) -> None:
    from gearmath.bevel import check_ease_off as check

    pair = load_pair(bundled(f"{name}.toml"))
    halved = tuple((part, sign, what, low / 2, high / 2) for part, sign, what, low, high in check._LIMITS)
    monkeypatch.setattr(check, "_LIMITS", halved)
    monkeypatch.setattr(check, "_REST", check._REST / 2)
    monkeypatch.setattr(check, "_HOLLOW", check._HOLLOW / 2)
    check_ease_off(pair.pinion, pair.gear, pair.rad("shaft_angle"))


def changed(name: str, *changes: tuple[str, object]) -> BevelSet:
    values = tomllib.loads(bundled(f"{name}.toml").read_text("utf-8"))
    for place, value in changes:
        *tables, key = place.split(".")
        table = values
        for part in tables:
            table = table[part]
        table[key] = value(table[key]) if callable(value) else value
    return checked(values, BevelSet, name)


WRONG = {
    "radial distance of the gear": (
        "nasa_tp3096_12x36",
        *((f"gear.{flank}.radial_distance", lambda S: S + 0.5) for flank in FLANKS),
    ),
    "motion of a flank at rest": ("nasa_tp3096_12x36", ("pinion.convex.motion", {"ratio_of_roll": [0.5]})),
    "arc blade of another cutter": ("nasa_tp3096_12x36", ("pinion.concave.blade_spheric_radius", 100.0)),
    "blank offset of a cut of both flanks": (
        "crown_gear_hobbed_14x39",
        *((f"pinion.{flank}.blank_offset", 0.8) for flank in FLANKS),
    ),
}


@pytest.mark.parametrize("case", WRONG)
def test_mates_that_fit_at_the_mean_point_alone_are_refused_with_part_value_and_limit(case: str) -> None:
    name, *changes = WRONG[case]
    pair = changed(name, *changes)
    with pytest.raises(Misfit, match=r"(ease-off has a|they would cut) .* mm .*, which must (lie between|be at most)"):
        check_ease_off(pair.pinion, pair.gear, pair.rad("shaft_angle"))
    with pytest.raises(InputError):
        check_pair(pair)


@pytest.mark.parametrize("groups", [11, 12, 14, 17])
def test_other_number_of_blade_groups_is_refused_as_the_blades_are_not_square_to_their_path(groups: int) -> None:
    pair = changed("crown_gear_hobbed_14x39", *((f"{member}.blade_groups", groups) for member in ("pinion", "gear")))
    with pytest.raises(InputError):
        check_pair(pair)


@pytest.mark.parametrize(
    ("crowning", "twist", "profile_crowning", "depth"),
    [
        (3.0, 0.0, 2.0, 0.0),
        (3.0, 4.0, 2.0, 0.0),  # 4 < 2 √6: no saddle
        (3.0, 6.0, 2.0, 1.0),  # at the corner 3 - 6 + 2
        (-1.0, 0.0, 2.0, 1.0),
        (1.0, 1.0, -2.0, 2.25),  # x = 1/2 on the edge: 1/4 - 1/2 - 2
        (-1.0, 0.5, -2.0, 3.5),
    ],
)
def test_hollow_is_how_far_the_second_order_falls_below_its_middle(crowning, twist, profile_crowning, depth) -> None:
    for sign in (1, -1):
        found = Parts(5.0, -7.0, crowning, sign * twist, profile_crowning, 1.0)
        assert hollow(found) == pytest.approx(depth, abs=1e-12)


UNIVERSAL, FORMATE = "crown_gear_universal_14x39", "crown_gear_formate_14x39"


def motions(name: str, of: Callable[[dict], dict]) -> tuple:
    """A set with the motion of both flanks of its pinion changed."""
    return name, *((f"pinion.{flank}.motion", of) for flank in FLANKS)


def times(factor: float) -> Callable[[dict], dict]:
    return lambda motion: {key: [factor * value for value in values] for key, values in motion.items()}


BOTH = r"it would fit with pinion\.concave\.motion and pinion\.convex\.motion"
OTHER_METHOD = {
    **{
        f"{name}: Formate gear": (r"= 'generated', not 'formate'$", name, ("gear.generation", "formate"))
        for name in ("nasa_tp3096_12x36", UNIVERSAL, "crown_gear_hobbed_14x39")
    },
    "Formate gear that is rolled": (r"= 'formate', not 'generated'$", FORMATE, ("gear.generation", "generated")),
    "no motions": ("differ by -1.55 degrees, which must be at most 1.1", *motions(UNIVERSAL, lambda _: {})),
    "motions turned round": (rf"{BOTH} times -1$", *motions(UNIVERSAL, times(-1.0))),
    "C for 2C": (rf"{BOTH} times 2$", *motions(FORMATE, times(0.5))),
    "motions of the flanks exchanged": (
        rf"{BOTH} exchanged$",
        FORMATE,
        ("pinion.concave.motion", {"modified_roll": [-0.197824, -0.049731]}),
        ("pinion.convex.motion", {"modified_roll": [0.174573, -0.558029]}),
    ),
}


@pytest.mark.parametrize("case", OTHER_METHOD)
def test_pair_made_for_another_method_or_motion_is_refused_and_told_which_would_fit(case: str) -> None:
    sentence, name, *changes = OTHER_METHOD[case]
    with pytest.raises(InputError, match=sentence):
        check_pair(changed(name, *changes))
