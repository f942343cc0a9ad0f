"""Virtual milling: cases worked by hand with a cutter that plunges along its axis, and brute force."""

from __future__ import annotations

import math

import numpy as np
import pytest

from gearmath.bevel.flank import blank_grid, solve_flank
from gearmath.machine import milling
from gearmath.machine.milling import Blade, remaining
from gearmath.specs.bevel_set import SIDES

RADIUS, ALPHA, HEIGHT = 60.0, math.radians(20.0), 500.0
OUTER, INNER = Blade(RADIUS, ALPHA, 1), Blade(RADIUS, ALPHA, -1)
CUTTING = np.array([False, True])


def plunge(depth, to=0.0):
    """At B = 90° the cutter's axis is z_w: from z_w = -100 mm to ``depth``, its axis at (0, 0) or at x_w = ``to``."""
    return np.array([[-to, 0, HEIGHT + 100, 0, np.pi / 2], [-to, 0, HEIGHT - depth, 0, np.pi / 2]])


def across(z, x=50.0, direction=1.0):
    """Lines across the cutter's axis in the plane y = 0, at heights ``z`` (n,) of the work."""
    n = len(z)
    return np.column_stack([np.full(n, x), np.zeros(n), z]), np.tile([direction, 0.0, 0.0], (n, 1))


def test_outer_blade_leaves_everything_beyond_its_cone():
    """Tip at z = 10: at z the blade stands h = 10 - z above its tip, with the radius r_p + h tan α."""
    z = np.array([9.9, 5.0, 0.0, -20.0])
    point, normal = across(z, x=RADIUS + 8.0, direction=-1.0)
    left = remaining(plunge(10.0), CUTTING, OUTER, HEIGHT, point, normal)
    np.testing.assert_allclose(left, 8.0 - (10.0 - z) * math.tan(ALPHA), rtol=0, atol=1e-10)


def test_inner_blade_leaves_everything_within_its_cone():
    z = np.array([9.9, 5.0, 0.0, -20.0])
    point, normal = across(z, x=RADIUS - 8.0)
    left = remaining(plunge(10.0), CUTTING, INNER, HEIGHT, point, normal)
    np.testing.assert_allclose(left, 8.0 - (10.0 - z) * math.tan(ALPHA), rtol=0, atol=1e-10)


@pytest.mark.parametrize("blade", [OUTER, INNER])
def test_distance_is_taken_along_the_normal_of_the_cone(blade):
    """1 mm of metal along the normal stays 1 mm, wherever on the cone: also with the cutter turned by A."""
    height, beta = np.meshgrid(np.linspace(0.5, 9.0, 5), np.linspace(-3, 3, 7))
    height, beta = height.ravel(), beta.ravel()
    rho = RADIUS + blade.side * height * math.tan(ALPHA)
    radial = np.column_stack([np.cos(beta), np.sin(beta), 0 * beta])
    normal = -blade.side * math.cos(ALPHA) * radial + [0, 0, -math.sin(ALPHA)]
    surface = rho[:, None] * radial + np.column_stack([0 * beta, 0 * beta, 10.0 - height])
    path = plunge(10.0) + np.array([0, 0, 0, 1.234, 0])
    left = remaining(path, CUTTING, blade, HEIGHT, surface - normal, normal)
    np.testing.assert_allclose(left, 1.0, rtol=0, atol=1e-10)


@pytest.mark.parametrize("lifted", [0.0, 0.25, 3.0])
def test_lifted_cutter_leaves_metal_below_its_tip(lifted):
    """Lines along the axis, under the blade edge of r_p: what is left is measured from the tip plane."""
    point = np.array([[RADIUS - 0.5, 0, 10.0], [0, RADIUS - 0.01, 10.0]])
    normal = np.tile([0, 0, -1.0], (2, 1))
    left = remaining(plunge(10.0 - lifted), CUTTING, OUTER, HEIGHT, point, normal)
    np.testing.assert_allclose(left, lifted, rtol=0, atol=1e-10)


def test_lines_below_the_tip_are_followed_up_to_the_tip_plane():
    """A slanted line that meets the prolonged cone below the tip is cut where it rises through the tip plane."""
    slant = math.radians(30.0)
    point = np.array([[RADIUS + 0.2, 0, 10.5]])  # half a mm too deep, just outside the point radius
    normal = np.array([[-math.cos(slant), 0, -math.sin(slant)]])
    left = remaining(plunge(10.0), CUTTING, OUTER, HEIGHT, point, normal)
    np.testing.assert_allclose(left, 0.5 / math.sin(slant), rtol=0, atol=1e-10)


def test_what_the_cutter_never_reaches_is_not_a_number():
    point, normal = across(np.array([10.5, 30.0]), x=RADIUS + 1.0, direction=-1.0)  # below the tip, level lines
    assert np.isnan(remaining(plunge(10.0), CUTTING, OUTER, HEIGHT, point, normal)).all()


def test_rapid_blocks_cut_nothing():
    point, normal = across(np.array([0.0]), x=RADIUS + 8.0, direction=-1.0)
    assert np.isnan(remaining(plunge(10.0), np.array([False, False]), OUTER, HEIGHT, point, normal)).all()
    path = np.vstack([plunge(10.0, to=-1.0), plunge(10.0)])  # in feed at x = -1 mm, then rapid to x = 0
    left = remaining(path[[0, 1, 3]], np.array([False, True, False]), OUTER, HEIGHT, point, normal)
    np.testing.assert_allclose(left, 9.0 - 10.0 * math.tan(ALPHA), rtol=0, atol=1e-10)


def test_closest_approach_is_found_within_a_block():
    """One block turns A by ±6° and moves X with it: the cutter is nearest in the middle, where no node stands."""
    half, lever = math.radians(6.0), 80.0
    path = np.array([
        [-lever, 0, HEIGHT + 50, -half, np.pi / 2],
        [-lever, 0, HEIGHT - 10, -half, np.pi / 2],
        [-lever, 0, HEIGHT - 10, half, np.pi / 2],
    ])  # fmt: skip
    point, normal = across(np.array([5.0]), x=lever + RADIUS + 4.0, direction=-1.0)
    left = remaining(path, np.array([False, True, True]), OUTER, HEIGHT, point, normal)
    np.testing.assert_allclose(left, 4.0 - 5.0 * math.tan(ALPHA), rtol=0, atol=1e-9)


def test_lines_are_taken_in_parts_and_each_is_counted_once(monkeypatch):
    monkeypatch.setattr(milling, "_CHUNK", 30)  # memory for fifteen lines of one block
    point, normal = across(np.linspace(-20, 9, 40), x=RADIUS + 8.0, direction=-1.0)
    counts = []
    left = remaining(plunge(10.0), CUTTING, OUTER, HEIGHT, point, normal, counts.append)
    assert counts == [15, 15, 10]
    np.testing.assert_allclose(left, 8.0 - (10.0 - point[:, 2]) * math.tan(ALPHA), rtol=0, atol=1e-10)


@pytest.mark.parametrize(("member", "flank"), [("pinion", "concave"), ("pinion", "convex"), ("gear", "convex")])
def test_a_real_program_leaves_what_dense_sampling_finds(gear_set, vertical, program, witness, member, flank):
    """Every block near contact in 300 poses of the witness, its own cone and its own kinematics; a coarse program."""
    spec = gear_set.member(member)
    path = program(gear_set, member, (0,), 2e-3)
    used = path.tool == (path.tools.index("PINION_CONVEX") if (member, flank) == ("pinion", "convex") else 0)
    axes, cutting = path.axes[used], ~path.rapid[used]
    points = solve_flank(spec, member, flank, blank_grid(spec))
    settings, side = spec.flank(flank).vector, SIDES[flank]
    blade, height = Blade(settings[10], settings[11], side), vertical.pivot_height
    left = remaining(axes, cutting, blade, height, points.point, points.normal)

    ends = np.flatnonzero(cutting)
    fractions = np.linspace(0, 1, 21)[:, None]
    found = np.full(len(points.point), np.inf)

    def sample(poses):  # (n or 1, k, 5)
        t = witness.entry(
            *witness.vertical_pose(poses, height), settings[10], settings[11], side,
            points.point[:, None], points.normal[:, None],
        )  # fmt: skip
        return t.min(axis=1), t.argmin(axis=1)

    coarse = np.concatenate([axes[k - 1] + fractions * (axes[k] - axes[k - 1]) for k in ends])
    found, at = sample(coarse[None])
    block = ends[at // 21]
    for offset in (-1, 0, 1):  # the best block and its neighbours, densely
        k = np.clip(block + offset, ends[0], ends[-1])
        dense = np.linspace(0, 1, 300)[:, None]
        poses = axes[k - 1][:, None] + dense * (axes[k] - axes[k - 1])[:, None]
        found = np.minimum(found, sample(poses)[0])
    assert np.abs(left - found).max() < 1e-7  # mm
    assert np.ptp(left) > 1e-4  # not an empty comparison
