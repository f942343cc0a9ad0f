"""STEP read back by the CAD kernel, beside points that the root finder places on flanks and fillets."""

from __future__ import annotations

import contextlib
import io
import json
import math
from pathlib import Path

import numpy as np
import pytest

from gearmath import cli
from gearmath.bevel.generation import solve_curve, solve_section
from gearmath.bevel.method import blade_sections, generation_of
from gearmath.bevel.solid import member_triangles, volume
from gearmath.bevel.tooth import SHARP_EDGE, tooth_space
from gearmath.exchange.body import space_grids
from gearmath.exchange.spline import basis, through
from gearmath.specs.bevel_set import SIDES, BevelSet
from tests.gearmath.exchange.step_shapes import distances, read_step, solids_of

pytest.importorskip("OCP", reason="the extra cad is not installed")

RNG = np.random.default_rng(4)


def test_basis_is_a_partition_of_one_and_holds_polynomials() -> None:
    knots = np.concatenate([np.zeros(6), [0.3, 0.55, 0.6], np.ones(6)])
    x = np.linspace(0, 1, 101)
    found = basis(x, knots, 5)
    assert found.sum(axis=1) == pytest.approx(np.ones(101), abs=1e-14)
    y = x**5 - 2 * x**3 + 0.1
    coefficients, *_ = np.linalg.lstsq(found, y, rcond=None)
    assert found @ coefficients == pytest.approx(y, abs=1e-12)


def test_patches_with_common_points_have_a_common_border() -> None:
    points = RNG.normal(size=(9, 12, 3))
    other = np.concatenate([points[-1:], RNG.normal(size=(4, 12, 3))])
    t = np.linspace(0, 1, 57)
    one, two = through(points), through(other)
    assert one.at(np.ones(57), t) == pytest.approx(two.at(np.zeros(57), t), abs=1e-12)


@pytest.fixture(scope="module")
def pinion(tmp_path_factory) -> tuple[Path, float]:
    """The STEP file of the pinion as the command writes it, and the volume that it says."""
    target, out = tmp_path_factory.mktemp("step") / "pinion.step", io.StringIO()
    arguments = ["export", "step", "nasa_tp3096_12x36.toml", "--member", "pinion", "--json", "-o", str(target)]
    with contextlib.redirect_stdout(out):
        cli.main(arguments)
    return target, json.loads(out.getvalue())["pinion"]["volume_mm3"]


@pytest.fixture(scope="module")
def read(pinion: tuple[Path, float]):
    return read_step(pinion[0])


@pytest.mark.slow
def test_solid_that_is_read_back_is_closed_valid_and_has_the_volume(read, pinion, gear_set: BevelSet) -> None:
    from OCP.BRepCheck import BRepCheck_Analyzer
    from OCP.BRepGProp import BRepGProp
    from OCP.GProp import GProp_GProps

    assert len(solids_of(read)) == 1
    assert BRepCheck_Analyzer(read).IsValid()
    found = GProp_GProps()
    BRepGProp.VolumeProperties_s(read, found)
    # facets of an STL cut corners: of the one with 17 rows on a flank 1.5e-4, with 33 a quarter of that
    space = tooth_space(gear_set.pinion, 49, (("main", 33), ("toprem", 5), ("edge", 17)))
    assert found.Mass() == pytest.approx(volume(member_triangles(gear_set.pinion, space)), rel=1e-4)
    assert found.Mass() == pytest.approx(pinion[1], rel=1e-9)


@pytest.mark.slow
@pytest.mark.parametrize(("part", "most"), [("main", 0.05e-3), ("edge", 1e-3)])
def test_a_thousand_random_points_lie_on_the_surface(part: str, most: float, read, gear_set: BevelSet) -> None:
    member, n = gear_set.pinion, 1000
    blank, delta = member.blank, math.radians(member.blank.pitch_angle)
    space = tooth_space(member, 21)
    points = []
    for surface in (space.concave, space.convex):
        how = generation_of(member, surface.flank)
        # a blade without edge radius has the smallest that an edge has
        blade = member.flank(surface.flank).model_copy(update={"blade_edge_radius": SHARP_EDGE})
        sections = blade_sections(blade, SIDES[surface.flank])
        section = sections[part]
        ends = sorted((section.lower, section.upper))
        distance = blank.mean_cone_distance + blank.face_width * RNG.uniform(-0.499, 0.499, 2 * n)
        u = RNG.uniform(*ends, 2 * n)
        start = np.tile(_start(how, sections["main"], delta, blank.mean_cone_distance), (2 * n, 1))
        start[:, 0] = u
        found = solve_curve(how, section, u, (math.cos(delta), math.sin(delta)), distance, start)
        good = found.converged & (_height(found.point, delta) < _tip(member, distance))
        points.append(found.point[good][: n // 2])
    assert [len(one) for one in points] == [n // 2] * 2
    assert distances(read, np.concatenate(points)).max() < most


def _start(how, section, delta: float, distance: float) -> np.ndarray:
    return solve_section(how, section, *(np.array([distance * f(delta)]) for f in (math.cos, math.sin))).contact[0]


def _height(point: np.ndarray, delta: float) -> np.ndarray:
    return np.hypot(point[:, 0], point[:, 1]) * math.cos(delta) - point[:, 2] * math.sin(delta)


def _tip(member, distance: np.ndarray) -> np.ndarray:
    blank = member.blank
    angle = math.radians(blank.face_angle - blank.pitch_angle)
    return blank.mean_addendum + (distance - blank.mean_cone_distance) * math.tan(angle)


def test_patches_have_no_fold_between_the_points_they_go_through(gear_set: BevelSet) -> None:
    # normals between samples keep to those of their neighbors
    for member in gear_set.members.values():
        for grid in space_grids(tooth_space(member, 21, (("main", 11), ("toprem", 9), ("edge", 17)))):
            patch, h = through(grid), 1e-5
            u, v = (one.ravel() for one in np.meshgrid(np.linspace(0, 1 - h, 61), np.linspace(0, 1 - h, 83)))
            along, across = patch.at(u + h, v) - patch.at(u, v), patch.at(u, v + h) - patch.at(u, v)
            normal = np.cross(along, across)
            normal = (normal / np.linalg.norm(normal, axis=1, keepdims=True)).reshape(83, 61, 3)
            assert (np.einsum("ijc,ijc->ij", normal[1:], normal[:-1]) > 0.9).all()
            assert (np.einsum("ijc,ijc->ij", normal[:, 1:], normal[:, :-1]) > 0.9).all()
