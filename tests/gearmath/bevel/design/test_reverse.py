"""Settings out of flanks: flanks given back on places that were not fitted, the other hand, and what is refused."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from gearmath.bevel.crown_gear import Method, crown_gear_set
from gearmath.bevel.design.reverse import LIMIT, ReversedMember, reverse
from gearmath.bevel.design.reverse_points import GivenFlank, given_flanks
from gearmath.bevel.design.reverse_route import load_known, reversed_set
from gearmath.bevel.design.reverse_start import KnownMember, mean_point
from gearmath.bevel.flank import blank_grid, solve_flank
from gearmath.bevel.generation import solve_section
from gearmath.bevel.method import blade_sections, generation_of
from gearmath.bevel.nominal_file import nominal_flank
from gearmath.bevel.pair import check_pair
from gearmath.bevel.turning import turned
from gearmath.errors import InputError
from gearmath.specs.bevel_set import FLANKS, SIDES, BevelSet, Member, load_bevel_set
from gearmath.specs.blank_data import load_blank_data
from gearmath.specs.flank_csv import FlankFile, join
from gearmath.specs.toml import bundled

SETS = (
    "nasa_tp3096_12x36",
    "spiral_7x43",
    "crown_gear_formate_14x39",
    "crown_gear_hobbed_14x39",
    "crown_gear_universal_14x39",
)
#: Standard deviation of the points [mm], and by how many of it a flank may be off anywhere.
NOISE, SIGMAS = 5e-4, 3


@cache
def bundled_set(name: str) -> BevelSet:
    return load_bevel_set(bundled(f"{name}.toml"))


def points_of(member: Member, noise: float = 0.0, seed: int = 13) -> FlankFile:
    """The 5x9 points of both flanks of a member, off along their normals by seeded noise [mm]."""
    file = join([nominal_flank(member, flank, blank_grid(member)) for flank in FLANKS])
    return file.with_noise(np.random.default_rng(seed).normal(0.0, noise, len(file)), noise) if noise else file


def known(member: Member, **changes) -> KnownMember:
    """Blank and method alone."""
    found = KnownMember(member.teeth, member.blank, None, member.cutting, member.generation, member.blade_groups)
    return replace(found, **changes)


def distance(found: Member, true: Member, flank: str) -> np.ndarray:
    """Distance [mm] of two flanks at 11x21 places, along the normals of the true one.

    By the point of the flank found that stands at the same place of the blank, and its normal: no fit, and no kernel
    that looks along a line.
    """
    grid = blank_grid(true, 11, 21)
    there = solve_flank(true, flank, grid)
    section = blade_sections(found.flank(flank), SIDES[flank])["main"]
    here = solve_section(generation_of(found, flank), section, grid.axial.ravel(), grid.radial.ravel())
    assert here.converged.all()
    return np.einsum("ni,ni->n", here.point - there.point, there.normal)


@pytest.mark.parametrize("which", SETS)
@pytest.mark.parametrize("name", ["pinion", "gear"])
def test_flanks_of_bundled_members_are_found_again_from_noisy_points_and_a_blank(which, name):
    """Everywhere between the points within three standard deviations of one of them, and as a set that passes."""
    pair = bundled_set(which)
    member = pair.member(name)
    found = reverse(known(member), given_flanks(points_of(member, NOISE), member.teeth), name)
    for flank in FLANKS:
        assert np.abs(distance(found.member, member, flank)).max() <= SIGMAS * NOISE
        assert found.flanks[flank].rms < found.flanks[flank].rms_before / 50
    check_pair(BevelSet(title="found", source="test", shaft_angle=pair.shaft_angle, **{name: found.member}))


def test_points_without_noise_give_a_published_flank_back_to_rounding():
    """NASA's pinion: the flank of the published settings to a tenth of a micrometre, whatever the settings found."""
    member = bundled_set("nasa_tp3096_12x36").member("pinion")
    found = reverse(known(member), given_flanks(points_of(member), member.teeth), "pinion")
    for flank in FLANKS:
        assert np.abs(distance(found.member, member, flank)).max() <= 1e-4


def mirrored(file: FlankFile) -> FlankFile:
    """The points in a mirror: the member of the other hand."""
    other = np.array([-1.0, 1.0, 1.0])
    return replace(file, point=file.point * other, normal=file.normal * other)


def test_mirrored_points_give_the_member_of_the_other_hand_with_mirrored_settings():
    member = bundled_set("nasa_tp3096_12x36").member("pinion")
    file = points_of(member, NOISE)
    left, right = (
        reverse(known(member), given_flanks(one, member.teeth), "pinion").member for one in (file, mirrored(file))
    )
    assert (left.hand, right.hand) == ("left", "right")
    for flank in FLANKS:
        assert left.flank(flank).blade_point_radius == pytest.approx(right.flank(flank).blade_point_radius, abs=1e-3)
        assert left.flank(flank).blank_offset == pytest.approx(-right.flank(flank).blank_offset, abs=1e-3)
        assert left.flank(flank).cradle_angle == pytest.approx(-right.flank(flank).cradle_angle, abs=1e-4)


def test_flanks_of_a_tooth_are_taken_as_those_of_a_space():
    """A file whose convex flank is a pitch on bounds a tooth; the member is the same."""
    member = bundled_set("crown_gear_universal_14x39").member("gear")
    given = given_flanks(points_of(member, NOISE), member.teeth)
    shifted = {**given, "convex": given["convex"].turned(2 * math.pi / member.teeth)}
    first, second = (reverse(known(member), one, "gear").member for one in (given, shifted))
    for flank in FLANKS:
        assert np.abs(distance(first, second, flank)).max() <= 1e-6


def test_all_teeth_of_a_file_count_alike():
    """Two teeth that are off by as much to either side are the flank between them."""
    member = bundled_set("spiral_7x43").member("gear")
    file = points_of(member)
    off = 0.01 * np.cos(np.arange(len(file)))
    angle = 2 * math.pi * 5 / member.teeth
    one, other = file.with_noise(off, 1e-3), file.with_noise(-off, 1e-3)
    other = replace(
        other, point=turned(other.point, angle), normal=turned(other.normal, angle), tooth=np.full(len(file), 5)
    )
    found, alone = (given_flanks(given, member.teeth) for given in (join([one, other]), file))
    for flank in FLANKS:
        assert found[flank].point == pytest.approx(alone[flank].point, abs=1e-9)
        assert found[flank].normal == pytest.approx(alone[flank].normal, abs=1e-12)


def test_mean_point_of_a_sphere_has_its_curvature_and_a_normal_through_its_center():
    member = bundled_set("nasa_tp3096_12x36").member("gear")
    blank, radius = member.blank, 90.0
    delta = math.radians(blank.pitch_angle)
    mean = blank.mean_cone_distance * np.array([math.sin(delta), 0.0, math.cos(delta)])
    inward = np.array([0.3, 0.9, 0.1])
    inward /= np.linalg.norm(inward)
    center = mean + radius * inward
    along = np.cross(inward, [0.0, 0.0, 1.0])
    along /= np.linalg.norm(along)
    up = np.cross(inward, along)
    x, y = (one.ravel() for one in np.meshgrid(np.linspace(-10, 10, 9), np.linspace(-3, 3, 5)))
    height = radius - np.sqrt(radius**2 - x**2 - y**2)
    point = mean + np.outer(x, along) + np.outer(y, up) + np.outer(height, inward)
    given = GivenFlank(point, (center - point) / radius, np.zeros(45, int), np.arange(45))
    found = mean_point(given, blank)
    assert np.linalg.norm(found.point - center) == pytest.approx(radius, abs=1e-4)
    assert found.normal == pytest.approx((center - found.point) / radius, abs=1e-5)
    assert found.curvature == pytest.approx(np.eye(2) / radius, abs=1e-5)


def test_hobbed_flanks_are_no_milled_ones_and_what_is_left_is_said():
    """No milled flank is an epicycloid: some micrometres are left, more than the points scatter."""
    member = bundled_set("crown_gear_hobbed_14x39").member("gear")
    milled = known(member, blade_groups=None, cutting="fixed_setting")
    found: ReversedMember = reverse(milled, given_flanks(points_of(member, NOISE), member.teeth), "gear")
    for flank in found.flanks.values():
        assert flank.scatter < flank.not_reproduced <= flank.rms * 1.3 <= 1.3 * LIMIT


def test_flanks_that_a_method_cannot_cut_are_refused_with_the_limit():
    member = bundled_set("nasa_tp3096_12x36").member("gear")
    given = given_flanks(points_of(member), member.teeth)
    with pytest.raises(InputError, match=r"no settings \(completing, formate.*um RMS, which must be at most 10"):
        reverse(known(member, generation="formate"), given, "gear")


def _swapped(given):
    return {"concave": given["convex"], "convex": given["concave"]}


def _few(given):
    return {**given, "convex": GivenFlank(*(one[:19] for one in vars(given["convex"]).values()))}


def _inward(given):
    return {**given, "concave": replace(given["concave"], normal=-given["concave"].normal)}


@pytest.mark.parametrize(
    ("changed", "changes", "words"),
    [
        (dict, {"hand": "right"}, "hand = 'right': the points are those of a left hand member"),
        (_swapped, {}, "concave flank: it is bulged along the tooth; are the names of the flanks interchanged"),
        (_inward, {}, "concave flank: it is bulged along the tooth"),
        (_few, {}, "convex flank: 19 points do not tell the flank, there must be at least 20"),
    ],
)
def test_points_that_are_not_those_of_the_member_are_refused(changed, changes, words):
    member = bundled_set("nasa_tp3096_12x36").member("pinion")
    given = given_flanks(points_of(member), member.teeth)
    with pytest.raises(InputError, match=words):
        reverse(known(member, **changes), changed(given), "pinion")


def test_points_of_another_blank_are_refused():
    member, other = (bundled_set(name).member("pinion") for name in ("nasa_tp3096_12x36", "spiral_7x43"))
    far = other.blank.model_copy(update={"mean_cone_distance": 110.0})
    with pytest.raises(InputError, match=r"has a cone distance of .* mm, the blank has 110 mm there"):
        reverse(known(member, blank=far), given_flanks(points_of(member), member.teeth), "pinion")


@pytest.mark.parametrize(
    ("header", "words"),
    [
        ({"member_teeth": "13"}, "member_teeth = 13: the pinion of the blank has 12"),
        ({"phase_zeroed": "true"}, "phase_zeroed = true: .* tell no tooth thickness"),
    ],
)
def test_files_that_do_not_tell_the_flanks_are_refused(header, words):
    member = bundled_set("nasa_tp3096_12x36").member("pinion")
    file = points_of(member)
    with pytest.raises(InputError, match=words):
        given_flanks(replace(file, header={**file.header, **header}), member.teeth)


@pytest.mark.parametrize(
    ("keys", "said"),
    [
        ("blade_edge_radius = 0.4", None),
        (
            "toprem_angle = 2\ntoprem_height = 1",
            r"^pinion\.concave\.toprem_angle = 2 of the set .* straight blades only",
        ),
        ("blade_spheric_radius = 1500", r"^pinion\.concave\.blade_spheric_radius = 1500 of the set"),
    ],
)
def test_blades_of_the_set_that_the_blank_is_of_are_kept_where_straight_and_refused_where_not(keys, said, tmp_path):
    path, member = tmp_path / "set.toml", bundled_set("nasa_tp3096_12x36").member("pinion")
    head, table, rest = bundled("nasa_tp3096_12x36.toml").read_text("utf-8").partition("[pinion.concave]\n")
    path.write_text(f"{head}{table}{keys}\n{rest}", "utf-8")
    file = points_of(member)
    if said is not None:
        with pytest.raises(InputError, match=said):
            reversed_set(load_known(path), file, "test")
        return
    found = reversed_set(load_known(path), file, "test").pair
    assert found.pinion is not None
    assert (found.pinion.concave.blade_edge_radius, found.pinion.convex.blade_edge_radius) == (0.4, 0.0)


def test_known_cutter_and_the_curvature_of_the_flanks_lead_to_the_same_flank():
    """A crown gear's pair from a blank file: with the cutter of the file, and with none."""
    data = load_blank_data(bundled("blank_iso23509_sample1.toml"))
    member = crown_gear_set(data, Method("fixed_setting"), Method()).member("pinion")
    given = given_flanks(points_of(member), member.teeth)
    for radius in (None, data.cutter.cutter_radius):
        found = reverse(known(member, cutter_radius=radius), given, "pinion")
        for flank in FLANKS:
            assert np.abs(distance(found.member, member, flank)).max() <= 1e-4
