"""Every figure that ``gearmath contact --json`` states of the NASA pair, another way: rolled surfaces, other solvers.

The signs are those of docs/contact.md, written out once more in the witness (conftest.py) and in ``axes`` below.
"""

from __future__ import annotations

import contextlib
import io
import itertools
import json
import math

import numpy as np
import pytest
from scipy.optimize import fsolve

from gearmath import cli
from gearmath.bevel.contact.report import ARCSEC, SIDES
from gearmath.bevel.flank import Grid, nominal_points
from gearmath.specs.bevel_set import FLANKS, BevelSet, Member

SET, STEP = "nasa_tp3096_12x36.toml", 9.0
PITCH, RATIO = 360.0 / 12, 12 / 36


def said(*options: object) -> dict:
    out = io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.suppress(SystemExit):
        cli.main(["contact", SET, "--json", *map(str, options)])
    return json.loads(out.getvalue())


@pytest.fixture(scope="module")
def table() -> dict:
    return said("--step", STEP)


@pytest.fixture(scope="module")
def witnesses(rolling, gear_set: BevelSet) -> dict:
    return {side: rolling(gear_set, flank) for side, flank in SIDES.items()}


def error(witness, degrees: float) -> float:
    """φ_2 + i φ_1 [arcsec] of the rolled surfaces."""
    rotation = math.radians(degrees)
    return (witness.first(rotation)[0] + RATIO * rotation) * ARCSEC


@pytest.mark.slow
@pytest.mark.parametrize("side", SIDES)
def test_positions_are_those_of_rolled_surfaces(side: str, table: dict, witnesses: dict) -> None:
    witness, rows = witnesses[side], {row["pinion_rotation_deg"]: row for row in table[side]["path"]}
    zero = error(witness, 0.0)
    whole = [STEP * k for k in range(-5, 6)]
    assert set(whole) <= set(rows)
    for at in whole:
        row, (turn, distance, height, kind) = rows[at], witness.contact(math.radians(at))
        found = (turn + RATIO * math.radians(at)) * ARCSEC - zero
        assert row["transmission_error_arcsec"] == pytest.approx(found, abs=1e-3), at
        assert row["gear_cone_distance_mm"] == pytest.approx(distance, abs=1e-3), at
        assert row["gear_height_mm"] == pytest.approx(height, abs=1e-3), at
        assert row["kind"] == kind, at
    # the gear follows whichever of three pairs of teeth pushes it furthest
    lead = max(witness.sense * (error(witness, STEP - k * PITCH) - zero) for k in (-1, 0, 1))
    assert rows[STEP]["gear_follows_arcsec"] == pytest.approx(witness.sense * lead, abs=1e-3)


@pytest.mark.parametrize("side", SIDES)
def test_kinds_of_rolled_surfaces_change_where_they_are_said_to(side: str, table: dict, witnesses: dict) -> None:
    rows = table[side]["path"]
    ends = [
        after["pinion_rotation_deg"]
        for before, after in itertools.pairwise(rows)
        if (before["kind"] == "interior") != (after["kind"] == "interior")
    ]
    assert len(ends) == 2
    for end, way in zip(ends, (1, -1), strict=True):
        assert witnesses[side].contact(math.radians(end + 0.01 * way))[3] == "interior"
        assert witnesses[side].contact(math.radians(end - 0.01 * way))[3] == "edge"
    assert table[side]["contact_ratio"] == pytest.approx((ends[1] - ends[0]) / PITCH, abs=1e-9)


@pytest.mark.slow
@pytest.mark.parametrize("side", SIDES)
def test_peak_to_peak_is_that_of_the_first_of_rolled_pairs(side: str, table: dict, witnesses: dict) -> None:
    witness, h = witnesses[side], 0.05

    def parabola(at: float, k: int) -> np.ndarray:
        """The lead of tooth pair k about a rotation, through three positions."""
        leads = [witness.sense * error(witness, at + by - k * PITCH) for by in (-h, 0.0, h)]
        return np.array([(leads[2] + leads[0] - 2 * leads[1]) / (2 * h**2), (leads[2] - leads[0]) / (2 * h), leads[1]])

    # about where, to a tenth of a degree, from the JSON; how far by the witness alone
    rows = [row for row in said("--step", 0.1)[side]["path"] if -15.0 <= row["pinion_rotation_deg"] < 15.0]
    follows = [witness.sense * row["gear_follows_arcsec"] for row in rows]
    most, least = (rows[int(which(follows))]["pinion_rotation_deg"] for which in (np.argmax, np.argmin))
    ranked = {
        at: sorted((-1, 0, 1), key=lambda k, at=at: -witness.sense * error(witness, at - k * PITCH))
        for at in (most, least)
    }
    # furthest ahead where one pair has its vertex, furthest behind where the next takes over
    a, b, c = parabola(most, ranked[most][0])
    one, other = (parabola(least, k) for k in ranked[least][:2])
    roots = np.roots(one - other)
    at = roots[np.abs(roots).argmin()].real
    assert abs(at) < 0.1
    assert abs(b / (2 * a)) < 0.1
    assert table[side]["peak_to_peak_arcsec"] == pytest.approx(c - b**2 / (4 * a) - np.polyval(one, at), abs=1e-3)


def axes(member: Member, turn: float, V: float, H: float) -> tuple[np.ndarray, np.ndarray]:
    """Rotation and shift of a member in the pair: pinion axis Z, gear axis X, Y = Z x X; V along Y, H along Z."""
    c, s = math.cos(turn), math.sin(turn)
    spin = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    if member.teeth == 12:
        return spin, np.array([0.0, 0.0, H])
    return np.array([[0.0, 0, 1], [0, 1, 0], [-1, 0, 0]]) @ spin, np.array([0.0, V, 0.0])


@pytest.mark.parametrize("side", SIDES)
@pytest.mark.parametrize(("place", "part"), [("toe", -0.5), ("mean", 0.0), ("heel", 0.5)])
def test_v_and_h_are_those_of_common_points_and_normals(
    side: str, place: str, part: float, table: dict, gear_set: BevelSet
) -> None:
    """Points and normals by the solver of flanks, six equations by scipy: common point, common normal, slope -i."""
    pinion, gear = gear_set.pinion, gear_set.gear
    own, mating = SIDES[side], FLANKS[1 - FLANKS.index(SIDES[side])]

    def at(member: Member, flank: str, axial: float, radial: float) -> tuple[np.ndarray, np.ndarray]:
        points, residual = nominal_points(member, flank, Grid(np.array([[axial]]), np.array([[radial]])))
        assert residual.max() < 1e-9
        return points.point[0], points.normal[0]

    delta, distance = math.radians(gear.blank.pitch_angle), gear.blank.mean_cone_distance + part * gear.blank.face_width
    wanted, n = at(gear, mating, distance * math.cos(delta), distance * math.sin(delta))

    def miss(y: np.ndarray) -> np.ndarray:
        V, H, axial, radial, turn_1, turn_2 = y * scale
        (M_1, t_1), (M_2, t_2) = axes(pinion, turn_1, V, H), axes(gear, turn_2, V, H)
        point, normal = at(pinion, own, axial, radial)
        r, r_2, n_1, n_2 = M_1 @ point + t_1, M_2 @ wanted + t_2, M_1 @ normal, M_2 @ n
        tangents = np.linalg.svd(n_2[None])[2][1:]
        # both move alike along the normal where the gear turns by -i
        slope = n_2 @ (np.cross([0, 0, 1.0], r) + RATIO * np.cross([1.0, 0, 0], r - t_2))
        return np.concatenate([r - r_2, 50 * tangents @ n_1, [slope]])

    scale = np.array([1.0, 1.0, 1.0, 1.0, 0.02, 0.02])
    cone = math.radians(pinion.blank.pitch_angle)
    place_1 = distance * math.cos(cone), distance * math.sin(cone)
    start, _ = at(pinion, own, *place_1)
    turns = -math.atan2(start[1], start[0]), math.pi - math.atan2(wanted[1], wanted[0])
    y = np.array([0.0, 0.0, *place_1, *turns]) / scale
    found = fsolve(miss, y, xtol=1e-12)
    assert np.abs(miss(found)).max() < 1e-8
    assert table[side]["v_h_mm"][place] == pytest.approx(list(found[:2]), abs=1e-6)


@pytest.mark.parametrize("side", SIDES)
def test_direction_of_the_path_is_that_of_three_places(side: str, table: dict, gear_set: BevelSet) -> None:
    """In the tangent plane: 0 along the generatrix of the root cone from toe to heel, 90 degrees towards the tip."""
    gear, mating = gear_set.gear, FLANKS[1 - FLANKS.index(SIDES[side])]
    delta, root = (math.radians(angle) for angle in (gear.blank.pitch_angle, gear.blank.root_angle))
    rows = {row["pinion_rotation_deg"]: row for row in said("--step", 0.25)[side]["path"]}
    for at in (-9.0, 0.0, 9.0):
        three = [rows[at + by] for by in (-0.25, 0.0, 0.25)]
        distance, height = (
            np.array([[row[key] for row in three]]) for key in ("gear_cone_distance_mm", "gear_height_mm")
        )
        grid = Grid(
            distance * math.cos(delta) - height * math.sin(delta), distance * math.sin(delta) + height * math.cos(delta)
        )
        points, _ = nominal_points(gear, mating, grid)
        (before, here, after), n = points.point, points.normal[1]
        outwards = np.array([here[0], here[1], 0.0]) / math.hypot(here[0], here[1])
        along = np.array([0, 0, math.cos(root)]) + math.sin(root) * outwards
        tipwards = math.cos(root) * outwards - np.array([0, 0, math.sin(root)])
        first = along - (along @ n) * n
        first /= np.linalg.norm(first)
        second = np.cross(n, first)
        second *= np.sign(second @ tipwards)
        way = after - before
        angle = math.degrees(math.atan2(way @ second, way @ first)) % 180.0
        assert rows[at]["path_angle_deg"] == pytest.approx(angle, abs=0.01)
