"""Collisions of the cutter with what it must not touch: surfaces of revolution, whatever the work's angle.

The work is a set of profiles in the (z_w, radius) plane; the cutter has blades, head and spindle about its own axis.
The blades may be between the teeth, everything else must be clear of everything.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass

import numpy as np

from gearmath.bevel.kernels import kernel
from gearmath.machine.cutter import Cutter
from gearmath.machine.executor import MachinePath
from gearmath.machine.run import Run
from gearmath.specs.bevel_set import Member
from gearmath.specs.milling_machine import MillingMachine
from gearmath.specs.obstacles import CutterHead, Fixture
from gearmath.specs.simulated_machine import SimulatedMachine

#: Blades may come this close under the root, at the ends of the teeth, before it counts. [mm]
_UNDER_ROOT = 0.5
_SHANK_SHARE = 0.6
#: Spacing of the points of a profile and of the poses along a block. [mm]
_SPACING, _STEP = 2.0, 5.0
_AZIMUTHS = 120


@dataclass(frozen=True)
class Collision:
    """What of the cutter meets what of the work, in which lines of the program, and how deep at most [mm]."""

    cutter: str
    work: str
    lines: tuple[int, ...]
    depth: float


def work_profiles(member: Member, fixture: Fixture) -> dict[str, np.ndarray]:
    """Points (n,2) of z_w and radius on what stands about the work axis, by name.

    ``teeth`` is the face cone; ``hub`` the faces under the root at toe and heel, square to the pitch cone for a whole
    depth and then square to the axis; ``shank`` begins at the back face, and ``fixture`` stands behind the shank.
    """
    corners = {
        (end, edge): np.array([float(value) for value in kernel("flank_place")(member.blank.vector, end, edge)])
        for end in (0.0, 1.0) for edge in (0.0, 1.0)
    }  # fmt: skip
    delta = math.radians(member.blank.pitch_angle)
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


def collisions(
    path: MachinePath, runs: list[Run], member: Member, machine: MillingMachine, head: CutterHead | None = None,
    fixture: Fixture | None = None,
) -> list[Collision]:  # fmt: skip
    """Every pair that meets on the way, rapid blocks included; poses are tried every 5 mm of a block."""
    around = {name: rings(profile) for name, profile in work_profiles(member, fixture or machine.fixture).items()}
    found: dict[tuple[str, str], tuple[set[int], float]] = {}
    for run in runs:
        # A turns what is the same all around: blocks that differ in A only are one
        blocks = np.hstack([run.axes[:-1], run.axes[1:]])[:, [0, 1, 2, 4, 5, 6, 7, 9]]
        _, first, which = np.unique(np.round(blocks, 6), axis=0, return_index=True, return_inverse=True)
        for k, row in enumerate(first):
            meets = _of_block(blocks[row], run.cutter, machine, head or machine.cutter_head, around)
            for pair, depth in meets.items():
                lines, deepest = found.get(pair, (set(), 0.0))
                lines |= set(run.line[1:][which.ravel() == k].tolist())
                found[pair] = lines, max(depth, deepest)
    return [Collision(*pair, tuple(sorted(lines)), depth) for pair, (lines, depth) in sorted(found.items())]


def _of_block(
    block: np.ndarray, cutter: Cutter, machine: MillingMachine, head: CutterHead, around: dict[str, np.ndarray]
) -> dict[tuple[str, str], float]:
    """What meets during one block (8,), X Y Z B at its start and end, with its depth [mm]."""
    first, last = (np.insert(half, 3, 0.0) for half in (block[:4], block[4:]))
    reach = float(np.abs(last - first)[:3].max())
    poses = first + np.linspace(0.0, 1.0, 2 + int(reach / _STEP))[:, None] * (last - first)
    center, axis = kernel("tool_pose")(poses, machine.pivot_height, machine.pivot)
    meets = {}
    for name, ring in around.items():
        from_center = ring[None] - center[:, None]
        height = -np.einsum("pqk,pk->pq", from_center, axis)
        radius = np.sqrt(np.maximum(np.einsum("pqk,pqk->pq", from_center, from_center) - height**2, 0.0))
        for part, depth in _depths(cutter, head, height, radius).items():
            if (name, part) != ("teeth", "blades") and float(depth.max()) > 0.0:
                meets[part, name] = float(depth.max())
    return meets


def widest(cutter: Cutter, head: CutterHead) -> float:
    """The largest radius [mm] of cutter, head and spindle."""
    return max(_head_radius(cutter, head), head.spindle_radius)


def _head_radius(cutter: Cutter, head: CutterHead) -> float:
    outer = cutter.bodies[0].outer
    return outer.point_radius + cutter.height * math.tan(outer.pressure_angle) + head.beyond_tip


def _depths(cutter: Cutter, head: CutterHead, height: np.ndarray, radius: np.ndarray) -> dict[str, np.ndarray]:
    """How deep points at ``height`` and ``radius`` lie in each part of the cutter; negative outside of it."""
    body = cutter.bodies[0]
    outer = body.outer.point_radius + height * math.tan(body.outer.pressure_angle)
    inner = body.inner.point_radius - height * math.tan(body.inner.pressure_angle)
    top = cutter.height + head.height
    blades = np.minimum.reduce([height, cutter.height - height, outer - radius, radius - inner])
    disc = np.minimum.reduce([height - cutter.height, top - height, _head_radius(cutter, head) - radius])
    return {"blades": blades, "head": disc, "spindle": np.minimum(height - top, head.spindle_radius - radius)}


def _polyline(*corners: np.ndarray) -> np.ndarray:
    """Points (n,2) along straight lines between corners."""
    parts = [
        a + np.linspace(0.0, 1.0, 2 + int(np.linalg.norm(b - a) / _SPACING))[:, None] * (b - a)
        for a, b in itertools.pairwise(corners)
    ]
    return np.concatenate(parts)


def rings(profile: np.ndarray) -> np.ndarray:
    """Points (n,3) all around z_w."""
    angle = np.linspace(0.0, 2 * math.pi, _AZIMUTHS, endpoint=False)
    z, r = (np.repeat(values, _AZIMUTHS) for values in profile.T)
    around = np.tile(angle, len(profile))
    return np.column_stack([r * np.cos(around), r * np.sin(around), z])
