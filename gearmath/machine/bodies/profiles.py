"""Work and tool as surfaces of revolution: what holds them, how wide they are, points all around them."""

from __future__ import annotations

import itertools
import math

import numpy as np

from gearmath.kernels import kernel
from gearmath.machine.bodies.cutter import Cutter
from gearmath.specs.bevel_set import Member
from gearmath.specs.milling_machine import MillingMachine
from gearmath.specs.obstacles import CutterHead, Fixture
from gearmath.specs.simulated_machine import SimulatedMachine

#: Blades may come this close under the root, at the ends of the teeth, before it counts. [mm]
_UNDER_ROOT = 0.5
_SHANK_SHARE = 0.6
#: Spacing of the points of a profile [mm], and how many stand around.
_SPACING, _AZIMUTHS = 2.0, 120


def work_profiles(member: Member, fixture: Fixture) -> dict[str, np.ndarray]:
    """Points (n,2) of z_w and radius on what stands about the work axis, by name.

    ``teeth`` is the face cone; ``hub`` the faces under the root at toe and heel, square to the pitch cone for a whole
    depth and then square to the axis; ``shank`` begins at the back face, and ``fixture`` stands behind the shank.
    """
    corners = {
        (end, edge): np.array([float(value) for value in kernel("flank_place")(member.blank.vector, end, edge)])
        for end in (0.0, 1.0)
        for edge in (0.0, 1.0)
    }
    delta = member.blank.delta
    inward = np.array([math.sin(delta), -math.cos(delta)])  # along the end faces, away from the tip
    below = member.blank.clearance + _UNDER_ROOT
    toe, heel = (corners[end, 0.0] + below * inward for end in (0.0, 1.0))
    shank = fixture.shank_radius or _SHANK_SHARE * heel[1]
    rim = member.blank.mean_addendum + member.blank.mean_dedendum
    toe_rim, back = (start + rim * inward if start[1] + rim * inward[1] > shank else start for start in (toe, heel))
    end = back[0] + fixture.shank_length
    toe_end, heel_end = (np.array([corner[0], min(shank, corner[1])]) for corner in (toe_rim, back))
    return {
        "teeth": _polyline(corners[0.0, 1.0], corners[1.0, 1.0]),
        "hub": np.concatenate([_polyline(toe, toe_rim, toe_end), _polyline(heel, back, heel_end)]),
        "shank": _polyline(np.array([back[0], shank]), np.array([end, shank])),
        "fixture": _polyline(
            np.array([end, shank]), np.array([end, fixture.radius]), np.array([end + fixture.length, fixture.radius])
        ),
    }


def obstacles(machine: MillingMachine, errors: SimulatedMachine | None = None) -> tuple[CutterHead, Fixture]:
    """What stands about tool and work: of the machine, unless the shop's file says otherwise."""
    if errors is None:
        return machine.cutter_head, machine.fixture
    return errors.cutter_head or machine.cutter_head, errors.fixture or machine.fixture


def widest(cutter: Cutter, head: CutterHead) -> float:
    """The largest radius [mm] of cutter, head and spindle."""
    return max(head_radius(cutter, head), head.spindle_radius)


def head_radius(cutter: Cutter, head: CutterHead) -> float:
    outer = cutter.bodies[0].outer
    return outer.point_radius + cutter.height * math.tan(outer.pressure_angle) + head.beyond_tip


def _polyline(*corners: np.ndarray) -> np.ndarray:
    """Points (n,2) along straight lines between corners."""
    parts = [
        a + np.linspace(0.0, 1.0, 2 + int(np.linalg.norm(b - a) / _SPACING))[:, None] * (b - a)
        for a, b in itertools.pairwise(corners)
    ]
    return np.concatenate(parts)


def rings(profile: np.ndarray, azimuths: int = _AZIMUTHS) -> np.ndarray:
    """Points (n,3) all around z_w."""
    angle = np.linspace(0.0, 2 * math.pi, azimuths, endpoint=False)
    z, r = (np.repeat(values, azimuths) for values in profile.T)
    around = np.tile(angle, len(profile))
    return np.column_stack([r * np.cos(around), r * np.sin(around), z])


def seen_from_axes(point: np.ndarray, origin: np.ndarray, axis: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """How far [mm] points (m,3) lie along axes (n,3) from their origins (n,3), and how far beside them: (n,m) each.

    By products of matrices instead of an array (n,m,3): beside an axis, not on it, what that rounds is below 1e-9 mm.
    """
    along = axis @ point.T - np.einsum("nk,nk->n", origin, axis)[:, None]
    squares = np.einsum("nk,nk->n", origin, origin)[:, None] + np.einsum("mk,mk->m", point, point)
    return along, np.sqrt(np.maximum(squares - 2 * origin @ point.T - along**2, 0.0))
