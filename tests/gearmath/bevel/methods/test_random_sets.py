"""Random sensible sets of every method: what is found is right, and what is not found is not on the usable flank.

The usable flank ends where the blade ends and where the surface turns back on itself. Whether a place without a point
lies on it is decided by the witness: Newton with finite differences from many starts, no derivative of the house.
"""

from __future__ import annotations

from collections import Counter

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import settings as hypothesis_settings
from hypothesis import strategies as st

from gearmath.bevel.crown_gear import Method
from gearmath.bevel.flank import blank_grid, solve_flank
from gearmath.bevel.generation import solve_section
from gearmath.bevel.method import blade_sections, generation_of
from gearmath.errors import InputError
from gearmath.specs.bevel_set import FLANKS, MEMBERS, SIDES

SETS = 20
STEP = 1e-4


def meshing(blade, w):
    """n · R_θ [mm/rad] at u, β, θ (3,...), n square to the swept surface, by central differences."""
    u, beta, theta = w
    along_u = blade.at(u + STEP, beta, theta) - blade.at(u - STEP, beta, theta)
    along_beta = blade.at(u, beta + STEP, theta) - blade.at(u, beta - STEP, theta)
    along_theta = blade.at(u, beta, theta + STEP) - blade.at(u, beta, theta - STEP)
    normal = np.cross(along_u, along_beta)
    normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
    return np.sum(normal * along_theta, axis=-1) / (2 * STEP)


def off_place(blade, rolling, w, axial, radial):
    """How far (...,3) a point is from its place and from contact, and the Jacobian (...,3,3) of it."""

    def residual(w):
        point = blade.at(*w)
        third = meshing(blade, w) / 50 if rolling else 50 * w[2]
        return np.stack([point[..., 2] - axial, np.hypot(point[..., 0], point[..., 1]) - radial, third], axis=-1)

    columns = []
    for k, step in enumerate((1e-3, 1e-4, 1e-4)):
        more = np.array([step * (k == j) for j in range(3)]).reshape(3, *[1] * (w.ndim - 1))
        columns.append((residual(w + more) - residual(w - more)) / (2 * step))
    return residual(w), np.stack(columns, axis=-1)


def on_the_flank(blade, rolling, reference, length, axial, radial):
    """Which places (n,) the blade cuts on the side of the reference point (3,), as the witness finds it."""
    _, J = off_place(blade, rolling, reference.reshape(3, 1), axial[:1], radial[:1])
    sense = np.sign(np.linalg.det(J))[0]
    u, theta = (x.ravel() for x in np.meshgrid(np.array([0.05, 0.2, 0.4]) * length, np.linspace(-0.4, 0.4, 5)))
    w = np.stack([u, reference[1] + 0 * u, theta])[:, None, :] * np.ones((1, len(axial), 1))
    for _ in range(12):
        off, J = off_place(blade, rolling, w, axial[:, None], radial[:, None])
        singular = np.abs(np.linalg.det(J)) < 1e-9
        J[singular] = np.eye(3)
        step = np.moveaxis(np.linalg.solve(J, off[..., None])[..., 0], -1, 0)
        w = w - step / np.maximum(1, np.max(np.abs(step) / np.array([3, 0.2, 0.2])[:, None, None], axis=0))
    off, J = off_place(blade, rolling, w, axial[:, None], radial[:, None])
    found = (np.linalg.norm(off, axis=-1) < 1e-5) & (np.sign(np.linalg.det(J)) == sense) & ~singular
    near = (np.abs(w[1] - reference[1]) < 1.5) & (np.abs(w[2]) < 1.2)
    # a place within a thousandth of a mm of the end of the blade belongs to neither side
    return (found & near & (w[0] > 1e-3) & (w[0] < length - 1e-3)).any(axis=1)


def audit(gear_set, moved_edge) -> Counter:
    """How many points are found, missed though they are on the usable flank, and absent; asserts that none is wrong."""
    counts: Counter = Counter()
    for name in MEMBERS:
        member = gear_set.member(name)
        grid = blank_grid(member)
        place = grid.axial.ravel(), grid.radial.ravel()
        for flank in FLANKS:
            section = blade_sections(member.flank(flank), SIDES[flank])["main"]
            points = solve_section(generation_of(member, flank), section, *place)
            blade = moved_edge.blade_of(member, flank)
            u = points.contact[:, 0]
            same = np.sign(points.sense) == np.sign(points.sense[22])
            found = points.converged & same & (u >= -1e-7) & (u <= section.upper + 1e-7)
            assert found[22], f"{name} {flank}: no reference point"
            assert_right(blade, member, points, found, place)
            counts["found"] += int(found.sum())
            if not found.all():
                rolling = member.generation == "generated"
                lost = on_the_flank(
                    blade, rolling, points.contact[22], section.upper, place[0][~found], place[1][~found]
                )
                counts["missed"] += int(lost.sum())
                counts["absent"] += int((~lost).sum())
                with pytest.raises(InputError, match=rf"^{name} {flank} flank, row \d+, column \d+: "):
                    solve_flank(member, flank, grid)
    return counts


def assert_right(blade, member, points, found, place):
    """Residual at most 1e-9 mm, the point at its place and on the blade of the witness, in contact."""
    assert points.residual[found].max() <= 1e-9
    point, w = points.point[found], points.contact[found].T
    np.testing.assert_allclose(point[:, 2], place[0][found], rtol=0, atol=2e-9)
    np.testing.assert_allclose(np.hypot(*point[:, :2].T), place[1][found], rtol=0, atol=2e-9)
    np.testing.assert_allclose(blade.at(*w), point, rtol=0, atol=1e-9)
    if member.generation == "generated":
        assert np.abs(meshing(blade, w)).max() < 1e-4  # mm/rad; 100 and more where nothing is in contact
    else:
        assert np.abs(w[2]).max() < 1e-11


def test_the_witness_finds_what_is_on_the_flank_and_nothing_beyond_an_undercut(pair, moved_edge):
    """Otherwise it would excuse everything. Pinion of 7 teeth: on the lower grid line its flank is not there."""
    member = pair(Method("fixed_setting"), pinion_teeth=7, wheel_teeth=43).pinion
    grid, section = blank_grid(member), blade_sections(member.concave, 1)["main"]
    place = grid.axial.ravel(), grid.radial.ravel()
    points = solve_section(generation_of(member, "concave"), section, *place)
    blade = moved_edge.blade_of(member, "concave")
    there = on_the_flank(blade, True, points.contact[22], section.upper, *place)
    np.testing.assert_array_equal(there.reshape(5, 9)[:, 0], [False, True, True, True, True])
    np.testing.assert_array_equal(there, points.converged)


def test_undercut_is_reported_as_such_by_member_flank_row_and_column(pair):
    member = pair(Method("fixed_setting"), pinion_teeth=7, wheel_teeth=43).pinion
    for flank in FLANKS:
        with pytest.raises(InputError, match=f"^pinion {flank} flank, row 0, column 0: .*undercut"):
            solve_flank(member, flank, blank_grid(member))


def test_of_random_sets_at_most_a_fifth_is_rejected_and_999_of_1000_points_are_found(sensible, moved_edge):
    rng, counts, rejected = np.random.default_rng(20261122), Counter(), 0
    for _ in range(SETS):
        try:
            gear_set = sensible.random_set(sensible.random_draw(rng))
        except InputError:
            rejected += 1
            continue
        counts += audit(gear_set, moved_edge)
    print(f"\n{SETS} sets, {rejected} rejected: {dict(counts)}")
    assert rejected <= 0.2 * SETS
    assert counts["found"] >= 0.999 * (counts["found"] + counts["missed"])
    assert counts["found"] > 0.85 * counts.total()  # the rest lies beyond undercut or tip


unit = st.floats(0, 1)
methods = st.sampled_from(("milled", "one flank alone", "tilted", "milled Formate", "hobbed", "hobbed Formate"))
draws = st.tuples(
    methods,
    st.sampled_from(("left", "right")),
    st.booleans(),
    st.integers(7, 25),
    st.floats(1, 8),
    st.floats(0, 45),
    unit,
    unit,
    unit,
    unit,
    st.tuples(unit, unit, unit, unit),
)


@hypothesis_settings(max_examples=10)
@given(draws)
def test_no_point_of_any_sensible_set_is_wrong_and_none_is_missed(sensible, moved_edge, draw):
    try:
        gear_set = sensible.random_set(sensible.Draw(*draw))
    except InputError:
        assume(False)
    assert audit(gear_set, moved_edge)["missed"] == 0
