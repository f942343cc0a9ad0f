"""Blocks against the tolerance, by the machine and cone of the witness; the fewest possible by dynamic programming."""

from __future__ import annotations

import math
from types import SimpleNamespace

import numpy as np
import pytest

from gearmath.bevel.design.accepted import accepted
from gearmath.bevel.flank import Grid, blank_grid
from gearmath.errors import InputError
from gearmath.machine.planning.blocks import ROUNDING, roll_nodes
from gearmath.machine.planning.path import Cut, below_the_flank, flank_points, roll_range
from gearmath.specs.bevel_set import load_bevel_set
from gearmath.specs.toml import bundled
from tests.gearmath.bevel.design.family import mixed

HEIGHT = 500.0
CUTS = [("pinion", 0), ("pinion", 1), ("gear", 0)]
each_cut = pytest.mark.parametrize(("member", "number"), CUTS)
_POINTS, _STEP = 80, 0.05
_CANDIDATES = 20
_FARTHEST = np.radians(4.0)
#: So near to nothing must be what the exact motion leaves on a point of the flank. [mm]
_ON_FLANK = 1e-8


@pytest.fixture(scope="module")
def deviations(gear_set, witness, moved_edge):
    """``deviations(member, number)``: a function of starts and ends (n,) [rad] that gives what each block leaves (n,).

    That is the difference along the tooth normal to what the exact motion leaves. The smallest distance of entry within
    a block is that at the vertex of the parabola through three poses. The flank reaches down to its foot, where the
    edge of the blade begins.
    """

    def of_cut(member, number, margin=0.0, bevel_set=gear_set):
        spec = bevel_set.member(member)
        cut = Cut.of(spec)[number]
        roll = roll_range(spec, cut)
        flanks = [
            _flank(witness, moved_edge.blade_of(spec, flank), roll, _points(spec, flank, margin))
            for flank in cut.flanks
        ]

        def left(start, end):
            found = [_left(witness, *flank, start, end) for flank in flanks]
            return np.max(found, axis=0)

        return left

    return of_cut


def _settings(blade):
    """Settings (...,12) at cradle rotations (...), from the keys of the file; modified roll as work rotation."""

    def at(theta):
        lag = sum(c / math.factorial(k) * theta**k for k, c in enumerate(blade.roll, 2))
        rows = {name: sum(c * theta**k for k, c in enumerate(row)) for name, row in blade.moving.items()}
        rows["work_rotation_offset"] = rows["work_rotation_offset"] - blade.moving["ratio_of_roll"][0] * lag
        still = np.full_like(theta, blade.point_radius), np.full_like(theta, blade.alpha)
        return np.stack([*rows.values(), *still], axis=-1)

    return at


def _points(spec, flank, margin):
    """Cradle rotation, point and normal of places along the tooth, at toe and heel, and at the foot."""
    grids = blank_grid(spec, 5, 401, margin), blank_grid(spec, 401, 2, margin)
    places = Grid(*(np.concatenate([getattr(g, name).ravel() for g in grids]) for name in ("axial", "radial")))
    points = flank_points(spec, flank, places)
    assert len(points.point) > 0.8 * places.axial.size
    on_blade = points.contact[:, 0] > 0.1
    across = np.linspace(margin, 1 - margin, 401)
    (foot,) = (row for part, row, _ in below_the_flank(spec, flank, across) if part == "main")
    return [
        np.concatenate([values[on_blade], more[foot.converged]])
        for values, more in (
            (points.contact[:, 2], foot.contact[:, 2]),
            (points.point, foot.point),
            (points.normal, foot.normal),
        )
    ]


def _flank(witness, blade, roll, points):
    """What ``_left`` needs of a flank: its points in order of their contact, with what the exact motion leaves there.

    All of them must lie on the surface that the whole roll leaves: this finds out unsolved places, and points that the
    tool takes away when it comes back. No block could be blamed for either.
    """
    theta, point, normal = points
    settings, cone = _settings(blade), (blade.point_radius, blade.alpha, blade.side)
    exact, at, width = np.full(len(theta), np.inf), np.full(len(theta), np.mean(roll)), np.ptp(roll) / 2
    for _ in range(4):
        poses = at[:, None] + width * np.linspace(-1, 1, 41)
        pose = witness.pose(settings(poses), poses)
        t = witness.entry(*pose, *cone, point[:, None], normal[:, None])
        at = np.take_along_axis(poses, t.argmin(axis=1)[:, None], 1)[:, 0]
        exact, width = np.minimum(exact, t.min(axis=1)), width / 20
    assert (np.abs(exact) < _ON_FLANK).all()
    order = np.argsort(theta)
    return settings, cone, *(array[order] for array in (theta, point, normal, exact))


def _left(witness, settings, cone, theta, point, normal, exact, start, end):
    """What blocks leave on one flank (n,), as the largest metal left on within them or gouge beside them."""
    aside = (end - start) / 2
    low, high = np.searchsorted(theta, start - aside), np.searchsorted(theta, end + aside)
    fraction = np.linspace(0, 1, _POINTS)
    at = np.clip((low + fraction[:, None] * (high - 1 - low)).round().astype(int).T, 0, len(theta) - 1)  # (n, points)
    first, last = (witness.vertical_axes(settings(ends), ends, HEIGHT) for ends in (start, end))
    last[:, 3] += 2 * np.pi * np.round((first[:, 3] - last[:, 3]) / (2 * np.pi))
    inside = (theta[at] >= start[:, None]) & (theta[at] <= end[:, None])
    middle = np.clip((theta[at] - start[:, None]) / (end - start)[:, None], _STEP, 1 - _STEP)

    def entry(s):
        axes = first[:, None] + s[..., None] * (last - first)[:, None]
        pose = witness.vertical_pose(axes, HEIGHT)
        return witness.entry(*pose, *cone, point[at], normal[at])

    before, here, after = (entry(middle + offset) for offset in (-_STEP, 0.0, _STEP))
    slope, curvature = (after - before) / (2 * _STEP), (after - 2 * here + before) / _STEP**2
    curved = np.where(curvature > 0, curvature, np.inf)
    change = np.clip(middle - slope / curved, 0, 1) - middle
    smallest = np.minimum(here, entry(middle + change)) - exact[at]
    empty = (low >= high)[:, None]
    gouge = np.where(empty, 0.0, -smallest).max(axis=1)
    return np.maximum(gouge, np.where(inside & ~empty, smallest, 0.0).max(axis=1))


def fewest_blocks(left, start, end, tolerance, spacing):
    """Dynamic programming over candidate nodes: every block between two of them that keeps the tolerance counts one.

    How far a block may reach from each node is found by bisection, for many nodes at once. A later node reaches at
    least as far, because a part of a block leaves no more than the block: every twentieth node narrows it down.
    """
    nodes = np.linspace(start, end, 1 + int(np.ceil((end - start) / spacing)))
    n = len(nodes)
    origin = np.arange(n - 1)
    low, high = origin + 1, np.minimum(origin + int(_FARTHEST / spacing), n - 1)
    for some in (origin[::_CANDIDATES], origin):
        while len(some := some[low[some] < high[some]]):
            middle = (low[some] + high[some] + 1) // 2
            kept = (
                np.concatenate(
                    [left(nodes[some[k : k + 200]], nodes[middle[k : k + 200]]) for k in range(0, len(some), 200)]
                )
                <= tolerance
            )
            low[some], high[some] = np.where(kept, middle, low[some]), np.where(kept, high[some], middle - 1)
        low, high = np.maximum.accumulate(low), np.minimum.accumulate(high[::-1])[::-1]
    count = np.full(n, n)
    count[0] = 0
    for i in range(n - 1):
        count[i + 1 : low[i] + 1] = np.minimum(count[i + 1 : low[i] + 1], count[i] + 1)
    return int(count[-1])


def compared_with_the_fewest(left, spec, member, number, tolerances):
    """Print tolerance, blocks and optimum, and compare them.

    At the full tolerance, of which roll_nodes keeps the rounding; 20 candidates in the shortest block.
    """
    cut, rows = Cut.of(spec)[number], []
    for tolerance in tolerances:
        nodes = roll_nodes(spec, cut, tolerance, HEIGHT)
        spacing = np.diff(nodes)[:-1].min() / _CANDIDATES
        rows.append((tolerance * 1000, len(nodes) - 1, fewest_blocks(left, *roll_range(spec, cut), tolerance, spacing)))
    print(f"\n{member} {' and '.join(cut.flanks)}: um, blocks, optimum:", rows)
    for _, blocks, fewest in rows:
        assert fewest - 1 <= blocks <= max(1.1 * fewest, fewest + 1), rows


@pytest.mark.slow
@each_cut
def test_blocks_are_near_the_fewest_that_dynamic_programming_finds(gear_set, deviations, member, number):
    left = deviations(member, number)
    compared_with_the_fewest(left, gear_set.member(member), member, number, (1e-4, 5e-4, 2.5e-3))


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "member", "number", "tolerances"),
    [
        ("spiral_7x43", "pinion", 0, (1e-4, 5e-4, 2.5e-3)),
        ("spiral_7x43", "pinion", 1, (5e-4, 2.5e-3)),
        ("spiral_7x43", "gear", 0, (5e-4,)),
        ("crown_gear_formate_14x39", "pinion", 0, (1e-4, 5e-4, 2.5e-3)),
        ("crown_gear_formate_14x39", "pinion", 1, (5e-4,)),
        ("crown_gear_universal_14x39", "pinion", 0, (5e-4, 2.5e-3)),
        ("crown_gear_universal_14x39", "pinion", 1, (5e-4,)),
        ("crown_gear_universal_14x39", "gear", 0, (5e-4,)),
    ],
)
def test_blocks_of_other_sets_are_near_the_fewest(deviations, name, member, number, tolerances):
    """Small pinions, whose flank the blade does not reach everywhere, and settings that move over the roll."""
    bevel_set = load_bevel_set(bundled(f"{name}.toml"))
    left = deviations(member, number, bevel_set=bevel_set)
    compared_with_the_fewest(left, bevel_set.member(member), member, number, tolerances)


@pytest.mark.parametrize("tolerance", [5e-4, 2.5e-3, 5e-2])
def test_what_the_exact_path_cuts_beyond_the_flank_does_not_stop_the_blocks(tolerance):
    """The pinion of 7 teeth: past the heel its tool comes back into points that lie beyond the flank."""
    spec = load_bevel_set(bundled("spiral_7x43.toml")).pinion
    assert 5 < len(roll_nodes(spec, Cut.of(spec)[0], tolerance, HEIGHT)) < 80


@each_cut
@pytest.mark.parametrize("tolerance", [1e-4, 2.5e-3])
def test_every_block_keeps_the_tolerance_and_uses_it(gear_set, deviations, member, number, tolerance):
    """By the witness: none leaves more than the tolerance less rounding, within 2 %; most leave nearly all of it."""
    spec = gear_set.member(member)
    cut = Cut.of(spec)[number]
    nodes = roll_nodes(spec, cut, tolerance, HEIGHT)
    assert (nodes[0], nodes[-1]) == roll_range(spec, cut)
    assert (np.diff(nodes) > 0).all()
    left = deviations(member, number)(nodes[:-1], nodes[1:])
    assert left.max() <= 1.02 * (tolerance - ROUNDING)
    assert np.median(left) >= 0.9 * (tolerance - ROUNDING)


def test_blocks_keep_the_tolerance_where_the_flank_ends_in_an_undercut_before_the_blade_does(deviations):
    """A design of 7 teeth: its foot lies beyond the undercut, and no line of it holds the blocks back at the toe."""
    spec = accepted(mixed(31))[0].pair.pinion
    nodes = roll_nodes(spec, Cut.of(spec)[0], 1e-4, HEIGHT)
    left = deviations("pinion", 0, bevel_set=SimpleNamespace(member=lambda _: spec))(nodes[:-1], nodes[1:])
    assert left.max() <= 1.02 * (1e-4 - ROUNDING)


@each_cut
def test_blocks_keep_the_tolerance_a_little_beyond_the_flank(gear_set, deviations, member, number):
    """One per cent on all sides: setting errors move the edges of the flank to other cradle rotations.

    Otherwise a long block of the overrun, which no point of the flank held back, would cut them.
    """
    spec = gear_set.member(member)
    nodes = roll_nodes(spec, Cut.of(spec)[number], 1e-4, HEIGHT)
    assert deviations(member, number, -0.01)(nodes[:-1], nodes[1:]).max() <= 1e-4


@each_cut
def test_blocks_within_the_flank_grow_with_the_root_of_the_tolerance(gear_set, member, number):
    """Limit case of short blocks: a hundredth of the deviation takes a tenth of the block."""
    spec = gear_set.member(member)
    cut = Cut.of(spec)[number]
    coarse, fine = (np.median(np.diff(roll_nodes(spec, cut, ROUNDING + d, HEIGHT))) for d in (1e-3, 1e-5))
    assert coarse == pytest.approx(10 * fine, rel=0.05)


@pytest.mark.parametrize("tolerance", [0.0, -1e-4, 0.9e-5, 0.2, float("nan"), float("inf")])
def test_tolerance_out_of_range_is_refused_with_the_limits(gear_set, tolerance):
    cut = Cut.of(gear_set.gear)[0]
    with pytest.raises(InputError, match=r"^tolerance = .* um: must lie between 0.01 and 100 um; the printed decimals"):
        roll_nodes(gear_set.gear, cut, tolerance, HEIGHT)


def test_blocks_do_not_depend_on_where_the_apex_lies_when_b_stands_still(gear_set):
    """Without tilt B is constant, so that an offset of the B axis shifts the whole path and bends nothing."""
    cut = Cut.of(gear_set.gear)[0]
    plain, offset = (
        roll_nodes(gear_set.gear, cut, 1e-3, HEIGHT, np.array(e)) for e in ([0.0, 0.0, 0.0], [12.0, -3.0, 45.0])
    )
    np.testing.assert_allclose(offset, plain, rtol=0, atol=1e-6)
