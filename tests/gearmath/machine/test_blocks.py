"""Blocks against the tolerance, by the machine and cone of the witness; the fewest possible by dynamic programming."""

from __future__ import annotations

import numpy as np
import pytest

from gearmath.bevel.flank import blank_grid, solve_places
from gearmath.errors import InputError
from gearmath.machine.blocks import ROUNDING, roll_nodes
from gearmath.machine.path import Cut, below_the_flank, roll_range
from gearmath.specs.bevel_set import SIDES, load_bevel_set
from gearmath.specs.toml import bundled

HEIGHT = 500.0
CUTS = [("pinion", 0), ("pinion", 1), ("gear", 0)]
each_cut = pytest.mark.parametrize(("member", "number"), CUTS)
_POINTS, _STEP = 80, 0.05
_CANDIDATES = 20
_FARTHEST = np.radians(4.0)


@pytest.fixture(scope="module")
def deviations(gear_set, witness):
    """``deviations(member, number)``: a function of starts and ends (n,) [rad] that gives what each block leaves (n,).

    The smallest distance of entry within a block is that at the vertex of the parabola through three poses. The flank
    reaches down to its foot, where the edge of the blade begins.
    """

    def of_cut(member, number, margin=0.0, bevel_set=gear_set):
        spec = bevel_set.member(member)
        flanks = []
        for flank in Cut.of(spec, member)[number].flanks:
            settings, side = spec.flank(flank).vector, SIDES[flank]
            grids = blank_grid(spec, 5, 401, margin), blank_grid(spec, 401, 2, margin)  # along the tooth; toe and heel
            axial, radial = (np.concatenate([getattr(g, name).ravel() for g in grids]) for name in ("axial", "radial"))
            points, _ = solve_places(settings, side, axial, radial)
            on_blade = points.contact[:, 0] > 0.1
            across = np.linspace(margin, 1 - margin, 401)
            (foot,) = (row for part, row, _ in below_the_flank(spec, flank, across) if part == "main")
            kept = [
                np.concatenate([values[on_blade], more])
                for values, more in (
                    (points.contact[:, 2], foot.contact[:, 2]), (points.point, foot.point), (points.normal, foot.normal)
                )
            ]  # fmt: skip
            order = np.argsort(kept[0])
            flanks.append((settings, side, *(array[order] for array in kept)))

        def left(start, end):
            found = [_left(witness, *flank, start, end) for flank in flanks]
            return np.max(found, axis=0)

        return left

    return of_cut


def _left(witness, settings, side, theta, point, normal, start, end):
    """What blocks leave on one flank (n,), as the largest metal left on within them or gouge beside them."""
    aside = (end - start) / 2
    low, high = np.searchsorted(theta, start - aside), np.searchsorted(theta, end + aside)
    fraction = np.linspace(0, 1, _POINTS)
    at = np.clip((low + fraction[:, None] * (high - 1 - low)).round().astype(int).T, 0, len(theta) - 1)  # (n, points)
    first, last = (witness.vertical_axes(settings, ends, HEIGHT) for ends in (start, end))
    last[:, 3] += 2 * np.pi * np.round((first[:, 3] - last[:, 3]) / (2 * np.pi))
    inside = (theta[at] >= start[:, None]) & (theta[at] <= end[:, None])
    middle = np.clip((theta[at] - start[:, None]) / (end - start)[:, None], _STEP, 1 - _STEP)

    def entry(s):
        axes = first[:, None] + s[..., None] * (last - first)[:, None]
        pose = witness.vertical_pose(axes, HEIGHT)
        return witness.entry(*pose, settings[10], settings[11], side, point[at], normal[at])

    before, here, after = (entry(middle + offset) for offset in (-_STEP, 0.0, _STEP))
    slope, curvature = (after - before) / (2 * _STEP), (after - 2 * here + before) / _STEP**2
    curved = np.where(curvature > 0, curvature, np.inf)
    change = np.clip(middle - slope / curved, 0, 1) - middle
    smallest = np.minimum(here, entry(middle + change))
    empty = (low >= high)[:, None]
    gouge = np.where(empty, 0.0, -smallest).max(axis=1)
    return np.maximum(gouge, np.where(inside & ~empty, smallest, 0.0).max(axis=1))


def fewest_blocks(left, start, end, tolerance, spacing):
    """Dynamic programming over candidate nodes: every block between two of them that keeps the tolerance counts one.

    How far a block may reach from each node is found by bisection for all nodes at once.
    """
    nodes = np.linspace(start, end, 1 + int(np.ceil((end - start) / spacing)))
    n = len(nodes)
    origin = np.arange(n - 1)
    low, high = origin + 1, np.minimum(origin + int(_FARTHEST / spacing), n - 1)
    while (low < high).any():
        middle = (low + high + 1) // 2
        kept = np.concatenate([
            left(nodes[origin[k : k + 200]], nodes[middle[k : k + 200]]) for k in range(0, n - 1, 200)
        ]) <= tolerance  # fmt: skip
        low, high = np.where(kept, middle, low), np.where(kept, high, middle - 1)
    count = np.full(n, n)
    count[0] = 0
    for i in range(n - 1):
        count[i + 1 : low[i] + 1] = np.minimum(count[i + 1 : low[i] + 1], count[i] + 1)
    return int(count[-1])


@pytest.mark.slow
@each_cut
def test_blocks_are_near_the_fewest_that_dynamic_programming_finds(gear_set, deviations, member, number):
    """At the full tolerance, of which roll_nodes keeps the rounding; 20 candidates in the shortest block."""
    spec = gear_set.member(member)
    cut, left = Cut.of(spec, member)[number], deviations(member, number)
    rows = []
    for tolerance in (1e-4, 5e-4, 2.5e-3):
        nodes = roll_nodes(spec, cut, tolerance, HEIGHT)
        blocks = len(nodes) - 1
        spacing = np.diff(nodes)[:-1].min() / _CANDIDATES
        fewest = fewest_blocks(left, *roll_range(spec, cut), tolerance, spacing)
        rows.append((tolerance * 1000, blocks, fewest))
        assert blocks <= max(1.1 * fewest, fewest + 1), rows
        assert fewest <= blocks + 1, rows
    print(f"\n{member} {' and '.join(cut.flanks)}: um, blocks, optimum:", rows)


@pytest.mark.slow
@pytest.mark.parametrize(("name", "member", "number"), [
    ("crown_gear_7x43", "pinion", 1), ("crown_gear_7x43", "gear", 0), ("crown_gear_formate_14x39", "pinion", 1),
    ("crown_gear_universal_14x39", "gear", 0),
])  # fmt: skip
def test_blocks_of_other_sets_are_near_the_fewest(deviations, name, member, number):
    """At 0.5 um, where settings stand still and the exact path cuts nothing beyond the ends of the flank:

    the machine of the witness knows no other, and would count what it cuts there against the blocks.
    """
    bevel_set = load_bevel_set(bundled(f"{name}.toml"))
    spec = bevel_set.member(member)
    cut, left = Cut.of(spec, member)[number], deviations(member, number, bevel_set=bevel_set)
    nodes = roll_nodes(spec, cut, 5e-4, HEIGHT)
    spacing = np.diff(nodes)[:-1].min() / _CANDIDATES
    blocks, fewest = len(nodes) - 1, fewest_blocks(left, *roll_range(spec, cut), 5e-4, spacing)
    print(f"\n{name} {member} {' and '.join(cut.flanks)}: 0.5 um, {blocks} blocks, optimum {fewest}")
    assert fewest - 1 <= blocks <= max(1.1 * fewest, fewest + 1)


@pytest.mark.parametrize("tolerance", [5e-4, 2.5e-3, 5e-2])
def test_what_the_exact_path_cuts_beyond_the_flank_does_not_stop_the_blocks(tolerance):
    """The pinion of 7 teeth: past the heel its tool comes back into points that lie beyond the flank."""
    spec = load_bevel_set(bundled("crown_gear_7x43.toml")).pinion
    assert 5 < len(roll_nodes(spec, Cut.of(spec, "pinion")[0], tolerance, HEIGHT)) < 80


@each_cut
@pytest.mark.parametrize("tolerance", [1e-4, 2.5e-3])
def test_every_block_keeps_the_tolerance_and_uses_it(gear_set, deviations, member, number, tolerance):
    """By the witness: none leaves more than the tolerance less rounding, within 2 %; most leave nearly all of it."""
    spec = gear_set.member(member)
    cut = Cut.of(spec, member)[number]
    nodes = roll_nodes(spec, cut, tolerance, HEIGHT)
    assert (nodes[0], nodes[-1]) == roll_range(spec, cut)
    assert (np.diff(nodes) > 0).all()
    left = deviations(member, number)(nodes[:-1], nodes[1:])
    assert left.max() <= 1.02 * (tolerance - ROUNDING)
    assert np.median(left) >= 0.9 * (tolerance - ROUNDING)


@each_cut
def test_blocks_keep_the_tolerance_a_little_beyond_the_flank(gear_set, deviations, member, number):
    """One per cent on all sides: setting errors move the edges of the flank to other cradle rotations.

    Otherwise a long block of the overrun, which no point of the flank held back, would cut them.
    """
    spec = gear_set.member(member)
    nodes = roll_nodes(spec, Cut.of(spec, member)[number], 1e-4, HEIGHT)
    assert deviations(member, number, -0.01)(nodes[:-1], nodes[1:]).max() <= 1e-4


@each_cut
def test_blocks_within_the_flank_grow_with_the_root_of_the_tolerance(gear_set, member, number):
    """Limit case of short blocks: a hundredth of the deviation takes a tenth of the block."""
    spec = gear_set.member(member)
    cut = Cut.of(spec, member)[number]
    coarse, fine = (np.median(np.diff(roll_nodes(spec, cut, ROUNDING + d, HEIGHT))) for d in (1e-3, 1e-5))
    assert coarse == pytest.approx(10 * fine, rel=0.05)


@pytest.mark.parametrize("tolerance", [0.0, -1e-4, 1.9e-5, 0.2, float("nan"), float("inf")])
def test_tolerance_out_of_range_is_refused_with_the_limits(gear_set, tolerance):
    cut = Cut.of(gear_set.gear, "gear")[0]
    with pytest.raises(InputError, match=r"^tolerance = .* um: must lie between 0.02 and 100 um; the printed decimals"):
        roll_nodes(gear_set.gear, cut, tolerance, HEIGHT)


def test_blocks_do_not_depend_on_where_the_apex_lies_when_b_stands_still(gear_set):
    """Without tilt B is constant, so that an offset of the B axis shifts the whole path and bends nothing."""
    cut = Cut.of(gear_set.gear, "gear")[0]
    plain, offset = (
        roll_nodes(gear_set.gear, cut, 1e-3, HEIGHT, np.array(e)) for e in ([0.0, 0.0, 0.0], [12.0, -3.0, 45.0])
    )
    np.testing.assert_allclose(offset, plain, rtol=0, atol=1e-6)
