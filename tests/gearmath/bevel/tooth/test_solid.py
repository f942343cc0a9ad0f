"""Solids of whole members: closed, outward, of the right volume; and their STL."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from gearmath.bevel.solid import member_triangles, space_triangles, volume, write_stl
from gearmath.bevel.tooth import ToothSpace, tooth_space
from gearmath.specs.bevel_set import FLANKS, MEMBERS, Member, load_bevel_set
from gearmath.specs.toml import bundled

COLUMNS = 25


@pytest.fixture(scope="module", params=MEMBERS)
def solid(request: pytest.FixtureRequest) -> tuple[Member, ToothSpace, np.ndarray]:
    member = load_bevel_set(bundled("nasa_tp3096_12x36.toml")).member(request.param)
    update = {flank: member.flank(flank).model_copy(update={"blade_edge_radius": 0.5}) for flank in FLANKS}
    member = member.model_copy(update=update)
    space = tooth_space(member, COLUMNS)
    return member, space, member_triangles(member, space)


def test_every_edge_belongs_to_two_triangles_in_opposite_directions(
    solid: tuple[Member, ToothSpace, np.ndarray],
) -> None:
    _, _, triangles = solid
    _, vertex = np.unique(np.round(triangles.reshape(-1, 3), 6), axis=0, return_inverse=True)
    corners = vertex.reshape(-1, 3)
    edges = np.concatenate([corners[:, [0, 1]], corners[:, [1, 2]], corners[:, [2, 0]]])
    assert (edges[:, 0] != edges[:, 1]).all()
    forward, counts = np.unique(edges, axis=0, return_counts=True)
    assert (counts == 1).all()
    backward = np.unique(edges[:, ::-1], axis=0)
    np.testing.assert_array_equal(forward, backward)


def blank_volume(member: Member) -> float:
    """Pappus and Guldin: area of the axial section of the blank times the way of its centroid."""
    blank, delta = member.blank, math.radians(member.blank.pitch_angle)
    rim = -2 * blank.mean_dedendum - blank.mean_addendum
    corners = []
    for along in (-0.5 * blank.face_width, 0.5 * blank.face_width):
        tip = blank.mean_addendum + along * math.tan(math.radians(blank.face_angle - blank.pitch_angle))
        for height in (rim, tip) if along < 0 else (tip, rim):
            r = blank.mean_cone_distance + along
            corners.append(
                (r * math.cos(delta) - height * math.sin(delta), r * math.sin(delta) + height * math.cos(delta))
            )
    z, r = np.array([*corners, corners[0]]).T
    cross = z[:-1] * r[1:] - z[1:] * r[:-1]
    return abs(float(((r[:-1] + r[1:]) * cross).sum())) * math.pi / 3


def space_volume(member: Member) -> float:
    """Volume of one space: width times radius over height and cone distance, Gauss-Legendre along the face.

    Heights and widths are read off the two profiles of a column, which the integration treats as functions of height.
    """
    delta = math.radians(member.blank.pitch_angle)
    space = tooth_space(member, 33)
    per_column = []
    for column in range(33):
        profiles = []
        for surface in space.ordered:
            x, y, z = surface.point[:, column].T
            profiles.append((np.hypot(x, y) * math.cos(delta) - z * math.sin(delta), np.arctan2(y, x)))
        bottom, top = (max(p[0][-1] for p in profiles), profiles[0][0][0])
        heights = np.linspace(bottom, top, 4001)
        low, high = (np.interp(heights, p[0][::-1], np.unwrap(p[1])[::-1]) for p in profiles)
        r = member.blank.mean_cone_distance + (column / 32 - 0.5) * member.blank.face_width
        radius = r * math.sin(delta) + heights * math.cos(delta)
        per_column.append(np.trapezoid((high - low) * radius, heights))
    simpson = np.array([1, *([4, 2] * 15), 4, 1]) / 3
    return float(simpson @ per_column) * member.blank.face_width / 32


def test_volume_is_the_blank_less_its_spaces(solid: tuple[Member, ToothSpace, np.ndarray]) -> None:
    member, _, triangles = solid
    expected = blank_volume(member) - member.teeth * space_volume(member)
    assert volume(triangles) == pytest.approx(expected, rel=1e-3)


def test_stl_holds_the_triangles(solid: tuple[Member, ToothSpace, np.ndarray], tmp_path: Path) -> None:
    _, space, triangles = solid
    write_stl(tmp_path / "member.stl", triangles, "member")
    content = (tmp_path / "member.stl").read_bytes()
    assert not content.startswith(b"solid")
    assert int.from_bytes(content[80:84], "little") == len(triangles)
    assert len(content) == 84 + 50 * len(triangles)
    record = np.frombuffer(content, dtype="<f4", count=12, offset=84)
    np.testing.assert_allclose(record[3:].reshape(3, 3), triangles[0], atol=1e-5)
    edges = triangles[0, 1] - triangles[0, 0], triangles[0, 2] - triangles[0, 0]
    normal = np.cross(*edges)
    np.testing.assert_allclose(record[:3], normal / np.linalg.norm(normal), atol=1e-6)
    assert len(space_triangles(space)) < len(triangles) / 10
