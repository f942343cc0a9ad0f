"""STEP of a pair in mesh read back by the CAD kernel: every flank in its place, both solids closed, none in the other.

The places are found here from the set alone: axes as `docs/contact.md` draws them, the pinion's mean point on the pitch
line, and the gear turned until the gap to the pinion's flank, searched over the flank, is gone.
"""

from __future__ import annotations

import contextlib
import io
import math
from pathlib import Path

import numpy as np
import pytest

from gearmath import cli
from gearmath.bevel.generation import SurfacePoints, solve_section
from gearmath.bevel.method import blade_sections, generation_of
from gearmath.specs.bevel_set import FLANKS, SIDES, BevelSet, Member
from tests.gearmath.exchange.step_shapes import distances, inside, is_closed, read_step, solids_of

pytest.importorskip("OCP", reason="the extra cad is not installed")

#: Farthest that a flank of the file may lie from its place [mm].
MOST = 0.05e-3
#: Rounds of the search for the least gap, points each way, and the part of its field that the next round searches.
ROUNDS, POINTS, NARROWER = 8, 15, 0.25


def flank_points(member: Member, flank: str, distance: np.ndarray, height: np.ndarray) -> SurfacePoints:
    """Points of space 0 at cone distances and heights over the pitch cone (n,) [mm], by the root finder."""
    delta = math.radians(member.blank.pitch_angle)
    axial = distance * math.cos(delta) - height * math.sin(delta)
    return at_places(member, flank, axial, distance * math.sin(delta) + height * math.cos(delta))


def at_places(member: Member, flank: str, axial: np.ndarray, radial: np.ndarray) -> SurfacePoints:
    section = blade_sections(member.flank(flank), SIDES[flank])["main"]
    return solve_section(generation_of(member, flank), section, axial, radial)


def about_z(angle: float) -> np.ndarray:
    c, s = math.cos(angle), math.sin(angle)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


#: The gear's own axes in the frame of the pair: its axis is X, and it begins with its x towards the pinion's back, Z.
GEAR_AXES = np.array([[0.0, 0.0, 1.0], [0.0, -1.0, 0.0], [1.0, 0.0, 0.0]])


def azimuth(points: np.ndarray) -> np.ndarray:
    return np.arctan2(points[..., 1], points[..., 0])


def places_by_hand(pair: BevelSet) -> tuple[dict[str, np.ndarray], np.ndarray, np.ndarray]:
    """Matrices from the work frames of both members of a pair at 90 degrees; where the driving flanks touch, and the
    direction out of the pinion there.
    """
    pinion, gear = pair.pinion, pair.gear
    assert pair.shaft_angle == 90
    mean = pinion.blank.mean_cone_distance
    on_pitch_cone = flank_points(pinion, "concave", np.array([mean]), np.zeros(1))
    matrix = about_z(-float(azimuth(on_pitch_cone.point)[0]))
    middle, field = np.array([mean, 0.0]), np.array([0.25 * pinion.blank.face_width, 0.5 * pinion.blank.mean_dedendum])
    for _ in range(ROUNDS):
        across = np.linspace(-1, 1, POINTS)
        distance, height = (middle[:, None, None] + field[:, None, None] * np.meshgrid(across, across)).reshape(2, -1)
        driving = flank_points(pinion, "concave", distance, height)
        point = driving.point @ matrix.T
        own = point @ GEAR_AXES
        mate = at_places(gear, "convex", own[:, 2], np.hypot(own[:, 0], own[:, 1]))
        assert mate.converged.all()
        turn = np.remainder(azimuth(own) - azimuth(mate.point) + math.pi, 2 * math.pi) - math.pi
        # from the metal of the gear to the pinion: that way there has to be room
        outward = np.cross([0.0, 0.0, 1.0], mate.point[0]) @ mate.normal[0]
        best = int(np.argmin(turn) if outward > 0 else np.argmax(turn))
        middle, field = np.array([distance[best], height[best]]), NARROWER * field
    matrices = {"pinion": matrix, "gear": GEAR_AXES @ about_z(float(turn[best]))}
    return matrices, point[best], matrix @ driving.normal[best]


def near_the_mesh(pair: BevelSet, name: str, matrix: np.ndarray) -> np.ndarray:
    """Points of both flanks of the spaces of a member that are in mesh, in the frame of the pair."""
    member = pair.members[name]
    blank, found = member.blank, []
    distance, height = np.meshgrid(
        blank.mean_cone_distance + blank.face_width * np.array([-0.4, -0.1, 0.1, 0.4]),
        np.array([-0.6 * (blank.mean_dedendum - blank.clearance), 0.6 * blank.mean_addendum]),
    )
    for flank in FLANKS:
        points = flank_points(member, flank, distance.ravel(), height.ravel())
        assert points.converged.all()
        for tooth in (-1, 0, 1):
            found.append(points.point @ about_z(2 * math.pi / member.teeth * tooth).T @ matrix.T)
    return np.concatenate(found)


@pytest.mark.slow
def test_members_stand_in_mesh_as_closed_solids_that_touch_and_do_not_overlap(tmp_path: Path, gear_set: BevelSet):
    target = tmp_path / "pair.step"
    with contextlib.redirect_stdout(io.StringIO()):
        cli.main(["export", "step", "nasa_tp3096_12x36.toml", "-o", str(target)])
    solids = dict(zip(("pinion", "gear"), solids_of(read_step(target)), strict=True))
    assert all(is_closed(solid) for solid in solids.values())
    matrices, touch, outward = places_by_hand(gear_set)
    for name, mate in (("pinion", "gear"), ("gear", "pinion")):
        points = near_the_mesh(gear_set, name, matrices[name])
        assert distances(solids[name], points).max() < MOST, name
        within = points[inside(solids[mate], points)]
        assert not len(within) or distances(solids[mate], within).max() < 2 * MOST, name
    # at the touch one solid ends where the other begins: a little to either side is metal of one of them alone
    sides = touch + 4 * MOST * np.array([[-1.0], [1.0]]) * outward
    assert inside(solids["pinion"], sides).tolist() == [True, False]
    assert inside(solids["gear"], sides).tolist() == [False, True]
    assert max(distances(solid, touch[None])[0] for solid in solids.values()) < MOST
