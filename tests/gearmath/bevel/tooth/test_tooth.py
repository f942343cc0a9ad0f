"""Whole tooth spaces: flanks, fillets, root, and what is wrong with them."""

from __future__ import annotations

import math

import numpy as np
import pytest

from gearmath.bevel.flank import Grid, nominal_points
from gearmath.bevel.tooth import (
    ToothSpace,
    flank_surface,
    mean_backlash,
    mean_pitch_radius,
    mean_tooth_thickness,
    tooth_space,
)
from gearmath.specs.bevel_set import FLANKS, MEMBERS, BevelSet, Flank, Member, load_bevel_set
from gearmath.specs.toml import bundled

EDGE = 0.5


def with_flanks(member: Member, **changes: object) -> Member:
    return member.model_copy(update={flank: member.flank(flank).model_copy(update=changes) for flank in FLANKS})


@pytest.fixture(scope="module")
def nasa() -> BevelSet:
    return load_bevel_set(bundled("nasa_tp3096_12x36.toml"))


@pytest.fixture(scope="module", params=MEMBERS)
def rounded(request: pytest.FixtureRequest, nasa: BevelSet) -> tuple[Member, ToothSpace]:
    member = with_flanks(nasa.member(request.param), blade_edge_radius=EDGE)
    return member, tooth_space(member, columns=9)


def height(member: Member, point: np.ndarray) -> np.ndarray:
    """Height above the pitch cone, worked from the cone itself."""
    delta = math.radians(member.blank.pitch_angle)
    return np.hypot(point[..., 0], point[..., 1]) * math.cos(delta) - point[..., 2] * math.sin(delta)


def test_rows_fall_from_the_face_cone_to_the_root(rounded: tuple[Member, ToothSpace]) -> None:
    member, space = rounded
    blank = member.blank
    along = np.linspace(-0.5, 0.5, 9) * blank.face_width
    tip = blank.mean_addendum + along * math.tan(math.radians(blank.face_angle - blank.pitch_angle))
    root = -blank.mean_dedendum - along * math.tan(math.radians(blank.pitch_angle - blank.root_angle))
    for surface in (space.concave, space.convex):
        heights = height(member, surface.point)
        assert (np.diff(heights, axis=0) < 0).all()
        np.testing.assert_allclose(heights[0], tip, atol=1e-9)  # mm
        # the cutter's tip plane sweeps the root cone, as the published dedendum angle says, to its printed digits
        np.testing.assert_allclose(heights[-1], root, atol=2e-3)


def test_flank_rows_are_points_of_the_solver(rounded: tuple[Member, ToothSpace]) -> None:
    member, space = rounded
    for surface in (space.concave, space.convex):
        rows = [k for k, name in enumerate(surface.section) if name == "main"][:-1]
        point = surface.point[rows].reshape(-1, 3)
        place = Grid(point[None, :, 2], np.hypot(point[:, 0], point[:, 1])[None, :])
        found, residual = nominal_points(member, surface.flank, place)
        assert residual.max() < 1e-9
        np.testing.assert_allclose(found.point, point, atol=1e-8)


def test_fillet_leaves_the_flank_smoothly_and_is_as_round_as_the_edge(rounded: tuple[Member, ToothSpace]) -> None:
    _, space = rounded
    for surface in (space.concave, space.convex):
        joint = surface.section.index("edge")
        turn = np.degrees(np.arccos((surface.normal[joint] * surface.normal[joint - 1]).sum(axis=1)))
        step = np.degrees(np.arccos((surface.normal[joint + 1] * surface.normal[joint]).sum(axis=1)))
        assert (turn < 1.5 * step).all()  # no corner: the normal turns no more across the joint than within the fillet
        inside = surface.point[joint + 1 :] - surface.point[joint:-1]
        arc = np.linalg.norm(inside, axis=2)
        turned = np.arccos(np.clip((surface.normal[joint + 1 :] * surface.normal[joint:-1]).sum(axis=2), -1, 1))
        # a generated fillet is never sharper than the edge that cuts it
        assert (arc / turned > 0.9 * EDGE).all()


def test_normals_are_those_of_the_surface(rounded: tuple[Member, ToothSpace]) -> None:
    member, _ = rounded
    for flank in FLANKS:
        surface = flank_surface(member, flank, columns=161)
        along = surface.point[:, 2:] - surface.point[:, :-2]
        rows = [k for k, part in enumerate(surface.section) if part == "main"]
        upward = surface.point[[k - 1 for k in rows[1:-1]]] - surface.point[[k + 1 for k in rows[1:-1]]]
        normal = surface.normal[rows[1:-1]][:, 1:-1]
        for tangent in (along[rows[1:-1]], upward[:, 1:-1]):
            slope = (tangent * normal).sum(axis=2) / np.linalg.norm(tangent, axis=2)
            assert np.abs(slope).max() < 2e-3


def test_outward_normals_of_both_flanks_face_each_other(rounded: tuple[Member, ToothSpace]) -> None:
    _, space = rounded
    low, high = space.ordered
    for surface, sign in ((low, 1), (high, -1)):
        tangent = np.stack([-surface.point[..., 1], surface.point[..., 0], np.zeros(surface.point.shape[:2])], axis=2)
        flank_rows = [k for k, name in enumerate(surface.section) if name == "main"]
        assert (sign * (surface.normal * tangent).sum(axis=2)[flank_rows] > 0).all()


def test_other_hand_is_the_mirror_image(nasa: BevelSet) -> None:
    member = with_flanks(nasa.gear, blade_edge_radius=EDGE)

    def mirrored(flank: Flank) -> Flank:
        negated = {k: -getattr(flank, k) for k in ("cradle_angle", "blank_offset", "work_rotation_offset")}
        return flank.model_copy(update={**negated, "cutter_swivel": 180.0 - flank.cutter_swivel})

    other = member.model_copy(
        update={"hand": "left", "concave": mirrored(member.concave), "convex": mirrored(member.convex)}
    )
    for flank in FLANKS:
        first, second = (flank_surface(m, flank, columns=7) for m in (member, other))
        np.testing.assert_allclose(second.point * [1, -1, 1], first.point, atol=1e-9)
        np.testing.assert_allclose(second.normal * [1, -1, 1], first.normal, atol=1e-9)


def test_nasa_space_and_tooth_make_up_the_pitch_with_a_workable_backlash(nasa: BevelSet) -> None:
    pitches = [2 * math.pi * mean_pitch_radius(m) / m.teeth for m in (nasa.pinion, nasa.gear)]
    assert pitches[0] == pytest.approx(pitches[1], abs=2e-3)  # the published pitch angles are rounded to 1e-4 deg
    backlash = mean_backlash(nasa.pinion, nasa.gear)
    # by the mean points of test_nasa_cr191009.py: what the gear's space has more than the pinion's tooth
    space = math.atan2(3.6909486632, 76.8041959969) - math.atan2(-3.7379045021, 76.8019250715)
    tooth = math.atan2(3.6476767625, 25.3676223671) - math.atan2(-3.6026122209, 25.3740614705)
    assert backlash == pytest.approx(76.8928321 * space - 25.6285352 * tooth, abs=2e-4)
    # normal backlash at this size, 5 diametral pitch, is 0.10 to 0.15 mm in practice: the sets bound space and tooth
    assert 0.05 < backlash * math.cos(math.radians(35)) < 0.25


def test_mean_thickness_equals_the_mean_points_of_the_publication(nasa: BevelSet) -> None:
    """Angles of the mean points by the closed form of the publication, as in test_nasa_cr191009.py."""
    gear = math.atan2(3.6909486632, 76.8041959969) - math.atan2(-3.7379045021, 76.8019250715)
    assert mean_tooth_thickness(nasa.gear) == pytest.approx(76.8928321 * (2 * math.pi / 36 - gear), abs=1e-4)
    pinion = math.atan2(-3.6026122209, 25.3740614705) - (math.atan2(3.6476767625, 25.3676223671) - math.pi / 6)
    assert mean_tooth_thickness(nasa.pinion) == pytest.approx(25.6285352 * (2 * math.pi / 12 - pinion), abs=1e-4)


def test_sharp_edge_leaves_the_flank_as_it_is(nasa: BevelSet) -> None:
    sharp, round_ = (flank_surface(m, "convex", 5) for m in (nasa.gear, with_flanks(nasa.gear, blade_edge_radius=EDGE)))
    np.testing.assert_allclose(sharp.point[0], round_.point[0], atol=1e-10)
    assert (height(nasa.gear, sharp.lower_limit) < height(nasa.gear, round_.lower_limit) - 0.1).all()


def test_too_high_a_tooth_is_found_to_be_pointed(nasa: BevelSet) -> None:
    blank = nasa.pinion.blank.model_copy(update={"mean_addendum": nasa.pinion.blank.mean_addendum + 4.0})
    high = with_flanks(nasa.pinion, blade_profile_height=20.0).model_copy(update={"blank": blank})
    assert (tooth_space(high, 5).top_land < 0).all()
    assert (tooth_space(nasa.pinion, 5).top_land > 0).all()
