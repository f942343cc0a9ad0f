"""Virtual milling: cases worked by hand with a cutter that plunges along its axis, and brute force."""

from __future__ import annotations

import math

import numpy as np
import pytest

from gearmath.bevel.flank import blank_grid, solve_flank
from gearmath.machine.bodies.cutter import Body, Cutter, CutterProfile
from gearmath.machine.milling import removal as milling
from gearmath.machine.milling.removal import Blade, entry_along_block, remaining
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
    path = np.array(
        [
            [-lever, 0, HEIGHT + 50, -half, np.pi / 2],
            [-lever, 0, HEIGHT - 10, -half, np.pi / 2],
            [-lever, 0, HEIGHT - 10, half, np.pi / 2],
        ]
    )
    point, normal = across(np.array([5.0]), x=lever + RADIUS + 4.0, direction=-1.0)
    left = remaining(path, np.array([False, True, True]), OUTER, HEIGHT, point, normal)
    np.testing.assert_allclose(left, 4.0 - 5.0 * math.tan(ALPHA), rtol=0, atol=1e-9)


def test_lines_are_taken_in_parts_and_each_is_counted_once(monkeypatch):
    monkeypatch.setattr(milling, "_LINES", 15)
    point, normal = across(np.linspace(-20, 9, 40), x=RADIUS + 8.0, direction=-1.0)
    counts = []
    left = remaining(plunge(10.0), CUTTING, OUTER, HEIGHT, point, normal, counts.append)
    assert counts == [15, 15, 10]
    np.testing.assert_allclose(left, 8.0 - (10.0 - point[:, 2]) * math.tan(ALPHA), rtol=0, atol=1e-10)


@pytest.mark.parametrize(("member", "flank"), [("pinion", "concave"), ("pinion", "convex"), ("gear", "convex")])
def test_a_real_program_leaves_what_dense_sampling_finds(gear_set, vertical, program, witness, member, flank):
    """Every block near contact in 1500 poses of the witness, its own cone and its own kinematics; a coarse program."""
    spec = gear_set.member(member)
    path = program(gear_set, member, (0,), 2e-3)
    used = path.tool == (path.tools.index("PINION_CONVEX") if (member, flank) == ("pinion", "convex") else 0)
    axes, cutting = path.axes[used], ~path.rapid[used]
    points = solve_flank(spec, flank, blank_grid(spec))
    settings, side = spec.flank(flank).vector, SIDES[flank]
    blade, height = Blade(settings[10], settings[11], side), vertical.pivot_height
    left = remaining(axes, cutting, blade, height, points.point, points.normal)

    ends = np.flatnonzero(cutting)
    fractions = np.linspace(0, 1, 21)[:, None]
    found = np.full(len(points.point), np.inf)

    def sample(poses):  # (n or 1, k, 5)
        t = witness.entry(
            *witness.vertical_pose(poses, height),
            settings[10],
            settings[11],
            side,
            points.point[:, None],
            points.normal[:, None],
        )
        return t.min(axis=1), t.argmin(axis=1)

    coarse = np.concatenate([axes[k - 1] + fractions * (axes[k] - axes[k - 1]) for k in ends])
    found, at = sample(coarse[None])
    block = ends[at // 21]
    for offset in (-1, 0, 1):  # the best block and its neighbours, densely
        k = np.clip(block + offset, ends[0], ends[-1])
        dense = np.linspace(0, 1, 1500)[:, None]
        poses = axes[k - 1][:, None] + dense * (axes[k] - axes[k - 1])[:, None]
        found = np.minimum(found, sample(poses)[0])
    assert np.abs(left - found).max() < 1e-7  # mm
    assert np.ptp(left) > 1e-4  # not an empty comparison


def outermost(h, radius, alpha, edge, curvature=0.0, touching=0.0):
    """Half-width of a blade (side +1) over its height by plane geometry: circle on tip plane and blade, then blade."""
    straight = radius + h * np.tan(alpha)
    if curvature:
        big = 1 / curvature  # the circle that touches the straight blade at the height ``touching``
        center = (radius + touching * np.tan(alpha) - big * np.cos(alpha), touching + big * np.sin(alpha))
        straight = center[0] + np.sign(big) * np.sqrt(big**2 - (h - center[1]) ** 2)
    if not edge:
        return straight
    center, low = radius + edge * np.tan(alpha) - edge / np.cos(alpha), np.clip(h, 0.0, edge)
    rounded = center + np.sqrt(edge**2 - (low - edge) ** 2)
    return np.where(h < edge * (1 - np.sin(alpha)), rounded, straight)


@pytest.mark.parametrize(
    ("edges", "curvature"), [((0.0, 0.0), 0.0), ((0.6, 0.4), 0.0), ((1.2, 1.2), 0.0), ((0.0, 0.0), 0.002)]
)
def test_first_part_of_a_line_taken_away_by_an_annulus_is_what_sampling_finds(edges, curvature):
    """Random lines through the tip of a cutter of 2.4 mm point width, in steps of 2 µm; its axis is z_w, its tip up."""
    radii, alphas, start, n = (77.4, 75.0), (0.36, 0.42), -2.0, 400
    generator = np.random.default_rng(16)
    point = generator.uniform([74.0, -1.0, -4.0], [78.5, 1.0, 1.0], (n, 3))
    direction = generator.normal(size=(n, 3))
    direction /= np.linalg.norm(direction, axis=1, keepdims=True)

    t = np.arange(start, 6.0, 2e-3)
    places = point[:, None] + t[:, None] * direction[:, None]
    h, rho = -places[..., 2], np.hypot(places[..., 0], places[..., 1])
    above = np.maximum(h, 0.0)
    outer = outermost(above, radii[0], alphas[0], edges[0], curvature, 3.0)
    inner = 2 * radii[1] - outermost(above, radii[1], alphas[1], edges[1])
    taken = (h >= 0) & (rho <= outer) & (rho >= inner)
    sampled = np.where(taken.any(axis=1), t[taken.argmax(axis=1)], np.inf)

    def blade(k, side, bend):
        r, a = radii[k], alphas[k]
        edge = edges[k]
        return CutterProfile(r, a, bend, 3.0, r - side * edge * (1 - math.sin(a)) / math.cos(a), edge, a)

    body = Body(0.0, blade(0, 1, curvature), blade(1, -1, 0.0), 12.0)
    axes = np.array([0.0, 0.0, HEIGHT, 0.0, np.pi / 2])
    (found,) = entry_along_block(body.sharp)(
        axes,
        axes,
        0.0,
        HEIGHT,
        np.zeros(3),
        0.0,
        point,
        direction,
        start,
        body.annulus,
        body.outer.vector,
        body.inner.vector,
    )
    both = np.isfinite(sampled) & (found < 5.9)
    late = sampled[both] - found[both]
    assert both.sum() > 150
    # a grazing line leaves within one step, unseen by the samples
    assert ((late > -1e-6) & (late < 2e-3 + 1e-6)).mean() > 0.98
    assert (np.isfinite(sampled) != (found < 5.9)).mean() < 0.02
    inside = both & (found > start)
    at = point[inside] + found[inside, None] * direction[inside]
    depth, radius = -at[:, 2], np.hypot(at[:, 0], at[:, 1])
    off = [
        np.abs(depth),
        np.abs(radius - outermost(depth, radii[0], alphas[0], edges[0], curvature, 3.0)),
        np.abs(radius - 2 * radii[1] + outermost(depth, radii[1], alphas[1], edges[1])),
    ]
    assert np.min(off, axis=0).max() < 1e-3  # on a surface to 1e-7, radially more where an edge is almost level


def test_cutter_is_hollow_so_that_a_tooth_in_its_middle_stays():
    """The line from the axis outwards meets the inner blade at 75 mm, not the far side's disc."""
    cutter = Cutter((Body(0.0, CutterProfile(77.0, 0.3), CutterProfile(75.0, 0.3), 12.0),), 12.0)
    point = np.array([[60.0, 0.0, 8.0]])
    left = remaining(plunge(10.0), CUTTING, cutter, HEIGHT, point, np.array([[1.0, 0.0, 0.0]]))
    assert left[0] == pytest.approx(15.0 - 2.0 * math.tan(0.3), abs=1e-9)
