"""Small flank files made by hand."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable, Sequence
from types import SimpleNamespace

import numpy as np
import pytest

from gearmath.bevel.flank import blank_grid, solve_flank
from gearmath.bevel.identify.flank_target import FlankTarget
from gearmath.bevel.nominal_file import flank_header
from gearmath.specs.bevel_set import FLANKS, MACHINE_SETTINGS, SIDES, Member
from gearmath.specs.calibration import Calibration
from gearmath.specs.flank_csv import FlankFile, flank_file, join

HEADER = {
    "member": "pinion",
    "member_teeth": "4",
    "frame": "w",
    "unit": "mm",
    "grid": "5x9",
    "margins": "0.1,0.1",
    "reference_point": "2,4",
    "phase_zeroed": "false",
    "tip_radius_mm": "0",
    "settings_sha256": "0" * 64,
}


@pytest.fixture
def teeth() -> Callable[..., FlankFile]:
    """``teeth(deviations, radius, slope)``: the reference point of every tooth, at ``radius`` on the x axis of tooth 0.

    The normal makes the angle ``slope`` with the direction of rotation. Teeth may be given in any order.
    """

    def make(
        deviations: Sequence[float],
        radius: float = 50.0,
        slope: float = 0.0,
        flank: str = "concave",
        order: Sequence[int] | None = None,
        place: tuple[int, int] = (2, 4),
    ) -> FlankFile:
        files = []
        for tooth in order if order is not None else range(len(deviations)):
            turn = 2 * math.pi * tooth / 4
            c, s = math.cos(turn), math.sin(turn)
            about = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
            point, normal = [[radius, 0, 20.0]] @ about.T, [[0, math.cos(slope), math.sin(slope)]] @ about.T
            files.append(
                flank_file(
                    HEADER,
                    "pinion",
                    flank,
                    tooth,
                    np.array([place[0]]),
                    np.array([place[1]]),
                    point,
                    normal,
                    np.array([deviations[tooth]]),
                )
            )
        return join(files)

    return make


@pytest.fixture
def plane() -> Callable[..., FlankFile]:
    """``plane(deviation, rows, columns)``: a flat flank, tilted in space; ``deviation`` is a function of X and Y.

    X runs along the tooth and Y up the profile from the reference point, in mm; points come in a mixed order.
    """

    def make(deviation: Callable[[np.ndarray, np.ndarray], np.ndarray], rows: int = 5, columns: int = 9) -> FlankFile:
        row, col = (index.ravel() for index in np.indices((rows, columns)))
        along, up = (col - columns // 2) * 2.5, (row - rows // 2) * 1.25
        a, b = 0.4, -0.7  # the plane's own directions, orthonormal
        e1 = np.array([math.cos(a), math.sin(a) * math.cos(b), math.sin(a) * math.sin(b)])
        e2 = np.array([-math.sin(a), math.cos(a) * math.cos(b), math.cos(a) * math.sin(b)])
        point = np.array([10.0, 20.0, 60.0]) + along[:, None] * e1 + up[:, None] * e2
        normal = np.tile(np.cross(e1, e2), (len(point), 1))
        mixed = np.random.default_rng(2).permutation(len(point))
        header = HEADER | {"grid": f"{rows}x{columns}", "reference_point": f"{rows // 2},{columns // 2}"}
        return flank_file(
            header,
            "pinion",
            "concave",
            0,
            row[mixed],
            col[mixed],
            point[mixed],
            normal[mixed],
            np.broadcast_to(deviation(along, up), along.shape)[mixed],
        )

    return make


#: Steps of the differences by which the witness finds normals and slopes: mm, rad, rad, mm.
_STEPS = np.array([1e-4, 1e-5, 1e-5, 1e-4])


def _about(axis: np.ndarray, angle: float | np.ndarray, vector: np.ndarray) -> np.ndarray:
    """Rodrigues' rotation of vectors (n,3) about one axis."""
    c, s = np.cos(angle)[..., None], np.sin(angle)[..., None]
    return vector * c + np.cross(axis, vector) * s + axis * (vector @ axis)[..., None] * (1 - c)


@pytest.fixture(scope="session")
def clamped(witness: SimpleNamespace) -> Callable[..., FlankFile]:
    """``clamped(member, name, seat, teeth, places, index, form)``: what a probe finds on a work that sits badly.

    The work's surface is the witness's cutter surface, grown by ``form(flank, z_w, radius)`` along its normal and
    turned by ``index[flank][tooth]``; it is tilted, moved off, and met by the nominal normal of every point: four
    equations (place, and no volume swept) for u, beta, theta and the deviation, by Newton with differences. Nothing of
    the seat, the normals or the meshing is gearmath's. ``seat`` is (e_x, e_y, tilt_x, tilt_y).
    """

    def met(member, flank, nominal, keep, tooth, seat, turn, form):
        """Of all points at once: places ``keep`` (m,) of teeth ``tooth`` (m,), which are turned by ``turn`` (m,)."""
        x, side = member.flank(flank).nominal.vector, SIDES[flank]
        axis_z, pitch = np.array([0.0, 0.0, 1.0]), 2 * np.pi * tooth / member.teeth
        point, normal = (_about(axis_z, pitch, v[keep]) for v in (nominal.point, nominal.normal))
        outward = nominal.normal[keep]
        e, tilt = np.array([*seat[:2], 0.0]), np.array([*seat[2:], 0.0])
        size = np.linalg.norm(tilt)
        axis = tilt / size if size else np.array([1.0, 0.0, 0.0])

        def surface(v):
            return witness.surface(v[..., 0], v[..., 1], v[..., 2], x, side)

        def off(v):
            sides = np.stack([v, *(v + sign * step for step in np.diag(_STEPS)[:3] for sign in (1, -1))])
            s, *beside = surface(sides)
            u, b, th = ((beside[2 * k] - beside[2 * k + 1]) / (2 * _STEPS[k]) for k in range(3))
            n = np.cross(u, b)
            n /= np.linalg.norm(n, axis=-1, keepdims=True)
            n *= np.sign(np.sum(n * outward, axis=-1, keepdims=True))
            grown = s + form(flank, s[..., 2], np.hypot(s[..., 0], s[..., 1]))[..., None] * n
            there = _about(axis_z, pitch + turn, grown)
            touched = point + v[..., 3:] * normal
            back = _about(axis, np.asarray(-size), touched - e)
            return np.concatenate([there - back, np.sum(n * th, axis=-1, keepdims=True) / x[0]], axis=-1)

        v, before, slopes = np.hstack([nominal.contact[keep], np.zeros((len(point), 1))]), np.inf, None
        for _ in range(20):
            rest = off(v)
            if (far := np.abs(rest).max()) < 1e-10:
                break
            if far > 0.05 * before or slopes is None:  # the slopes of an earlier step do as long as they lead on
                moved = off(v + np.array([[sign * step] for step in np.diag(_STEPS) for sign in (1, -1)]))
                slopes = np.stack([(moved[2 * k] - moved[2 * k + 1]) / (2 * _STEPS[k]) for k in range(4)], axis=-1)
            v, before = v - np.linalg.solve(slopes, rest[..., None])[..., 0], far
        assert np.abs(off(v)).max() < 1e-8
        return point, normal, v[:, 3]

    def make(
        member: Member,
        seat: Sequence[float] = (0, 0, 0, 0),
        teeth: Sequence[int] = range(8),
        places: Sequence[int] | None = None,
        index: dict[str, np.ndarray] | None = None,
        form: Callable = lambda flank, z, r: 0 * z,
        whole: Sequence[int] = (),
        grid: tuple[int, int] = (5, 9),
    ) -> FlankFile:
        grid_ = blank_grid(member, *grid)
        row, col = (each.ravel() for each in np.indices(grid))
        header, files = flank_header(member, grid_.shape), []
        nominals = {flank: solve_flank(member, flank, grid_) for flank in FLANKS}
        kept = [np.arange(len(row)) if places is None or i in whole else np.array(places) for i in teeth]
        keep, tooth = np.concatenate(kept), np.repeat(list(teeth), [len(each) for each in kept])
        found = {}
        for flank in FLANKS:
            turn = index[flank][tooth % member.teeth] if index else np.zeros(len(tooth))
            found[flank] = met(member, flank, nominals[flank], keep, tooth, np.array(seat), turn, form)
        for i, where in zip(teeth, kept, strict=True):
            for flank in FLANKS:
                point, normal, deviation = (each[tooth == i] for each in found[flank])
                touched = point + deviation[:, None] * normal
                files.append(
                    flank_file(header, member.name, flank, i, row[where], col[where], touched, normal, deviation)
                )
        return join(files)

    return make


class _Artefacts:
    """Ring and sphere in plain geometry: the true tip stops where it is one radius from their surface."""

    def __init__(self, true: Calibration) -> None:
        self.true = true

    def __call__(self, start: np.ndarray, end: np.ndarray) -> np.ndarray | None:
        first, last = (where[:3] + self.true.tip_offset for where in (start, end))
        way = last - first
        parts: list[float] = []
        ring, sphere, r = self.true.ring, self.true.sphere, self.true.tip_radius
        away = float(np.hypot(*(first - ring.center)[:2]))
        if away < ring.diameter / 2:
            parts += _roots((first - ring.center)[:2], way[:2], ring.diameter / 2 - r, leaving=True)
        elif away < ring.diameter / 2 + ring.face.width and way[2] < 0:
            parts += [(ring.face.seat + ring.face.height + r - first[2]) / way[2]]
        if np.hypot(*(first - sphere.center)[:2]) < 50:
            parts += _roots(first - sphere.center, way, sphere.diameter / 2 + r, leaving=False)
        parts = [part for part in parts if 0 <= part <= 1]
        return start + min(parts) * (end - start) if parts else None


def _roots(first: np.ndarray, way: np.ndarray, radius: float, leaving: bool) -> list[float]:
    """Parts of the way at which it leaves or enters a circle or a sphere."""
    a, b, c = way @ way, first @ way, first @ first - radius**2
    if a == 0 or b * b - a * c < 0:
        return []
    root = math.sqrt(b * b - a * c)
    return [(-b + root) / a if leaving else (-b - root) / a]


@pytest.fixture(scope="session")
def artefacts() -> type[_Artefacts]:
    """``artefacts(calibration)``: ring, its face and sphere, for a probe with the tip of the calibration."""
    return _Artefacts


@pytest.fixture(scope="session")
def brute_force(moved_edge) -> SimpleNamespace:
    """What a flank of changed settings really leaves, by the moving blade edge: no derivative, no equation of meshing.

    ``left(member, flank, target, change)`` is the deviation (n,) at the points of a target for a change (83,) of its
    settings and motion, searched for over all cradle angles around each point.
    """

    def changed(member: Member, flank: str, change: np.ndarray) -> object:
        blade, spec = moved_edge.blade_of(member, flank), member.flank(flank)
        settings, motion = change[:10], change[12:82].reshape(10, 7)
        moving = {}
        for name, row, first, more in zip(MACHINE_SETTINGS, blade.moving.values(), settings, motion, strict=True):
            assert name in blade.moving
            moving[name] = np.pad(row, (0, 8 - len(row))) + np.array([first, *more])
        # modified roll is in parts of the nominal ratio: the witness takes the roll that the machine is set to
        roll = tuple(
            c * blade.moving["ratio_of_roll"][0] / (blade.moving["ratio_of_roll"][0] + change[8]) for c in blade.roll
        )
        radius, alpha = blade.point_radius + change[10], blade.alpha + change[11]
        arc = None
        if spec.blade_spheric_radius is not None:
            r, height, side = spec.blade_spheric_radius, spec.blade_reference_height, blade.side
            at = radius + side * height * math.tan(alpha)  # where arc and straight blade touch
            arc = (at - side * r * math.cos(alpha), height + r * math.sin(alpha), r)
        return dataclasses.replace(blade, moving=moving, roll=roll, point_radius=radius, alpha=alpha, arc=arc)

    def left(member: Member, flank: str, target: FlankTarget, change: np.ndarray, levels: int = 5) -> np.ndarray:
        blade, at = changed(member, flank, change), target.nominal
        start, theta = at.contact[:, :2], at.contact[:, 2]
        if member.generation == "formate":
            t, crosses = moved_edge.on_lines(blade, at.point, at.normal, np.zeros(len(theta)), start)
            assert crosses.all()
            return t
        return moved_edge.left_on_lines(blade, at.point, at.normal, theta, start, 0.02, levels)[0]

    return SimpleNamespace(left=left)
