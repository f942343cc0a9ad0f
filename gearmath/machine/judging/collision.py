"""Collisions of the cutter with what it must not touch: surfaces of revolution, whatever the work's angle.

The work is a set of profiles in the (z_w, radius) plane; the cutter has blades, head and spindle about its own axis.
The blades may be between the teeth, everything else must be clear of everything.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from gearmath.kernels import kernel
from gearmath.machine.bodies.cutter import Cutter
from gearmath.machine.bodies.profiles import head_radius, rings, work_profiles
from gearmath.machine.control.executor import MachinePath
from gearmath.machine.milling.run import CuttingRun
from gearmath.specs.bevel_set import Member
from gearmath.specs.milling_machine import MillingMachine
from gearmath.specs.obstacles import CutterHead, Fixture

#: Spacing of the poses along a block. [mm]
_STEP = 5.0
#: Rings of points whose places in the cutter are worked out together.
_TOGETHER = 2000
#: What the cutter consists of.
PARTS = ("blades", "head", "spindle")
#: The same for rapid blocks [mm, rad], how far the blades must stay off the work there [mm], and what is far [mm].
_RAPID_STEP, _RAPID_TURN, RAPID_CLEARANCE, _FAR = 1.5, 0.01, 3.0, 20.0


@dataclass(frozen=True)
class Collision:
    """What of the cutter meets what of the work, in which lines of the program, and how deep at most [mm]."""

    cutter: str
    work: str
    lines: tuple[int, ...]
    depth: float


def collisions(
    path: MachinePath,
    runs: list[CuttingRun],
    member: Member,
    machine: MillingMachine,
    head: CutterHead | None = None,
    fixture: Fixture | None = None,
) -> list[Collision]:
    """Every pair that meets on the way, rapid blocks included; poses are tried every 5 mm of a block."""
    profiles = work_profiles(member, fixture or machine.fixture)
    found: dict[tuple[str, str], tuple[set[int], float]] = {}
    for run in runs:
        # A turns what is the same all around: blocks that differ in A only are one
        blocks = np.hstack([run.axes[:-1], run.axes[1:]])[:, [0, 1, 2, 4, 5, 6, 7, 9]]
        _, first, which = np.unique(np.round(blocks, 6), axis=0, return_index=True, return_inverse=True)
        poses, owner = _along(blocks[first])
        for name, profile in profiles.items():
            for part, depth in _deepest(run.cutter, head or machine.cutter_head, poses, profile, machine).items():
                if (name, part) == ("teeth", "blades") or not (depth > 0.0).any():
                    continue
                lines, deepest = found.get((part, name), (set(), 0.0))
                met = np.isin(which.ravel(), owner[depth > 0.0])
                lines |= set(run.line[1:][met].tolist())
                found[part, name] = lines, max(float(depth.max()), deepest)
    return [Collision(*pair, tuple(sorted(lines)), depth) for pair, (lines, depth) in sorted(found.items())]


def rapid_approaches(runs: list[CuttingRun], member: Member, machine: MillingMachine) -> list[Collision]:
    """Rapid blocks on which the blades come nearer to the face cone than ``RAPID_CLEARANCE``, at any height.

    Straight up out of the cut they may, since nothing stands in the way that the cut has left.
    """
    ring = rings(work_profiles(member, machine.fixture)["teeth"])
    found = []
    for run in runs:
        ends = np.flatnonzero(~run.cutting[1:]) + 1
        steps = run.axes[ends] - run.axes[ends - 1]
        retract = run.cutting[ends - 1] & (steps[:, 2] >= 0.0) & ~np.delete(steps, 2, axis=1).any(axis=1)
        ends = ends[~retract]
        # the face cone is the same all around: blocks that differ in A only are one
        blocks = np.hstack([run.axes[ends - 1], run.axes[ends]])[:, [0, 1, 2, 4, 5, 6, 7, 9]]
        _, first, which = np.unique(np.round(blocks, 6), axis=0, return_index=True, return_inverse=True)
        depths = [_blade_depth(run.axes[k - 1], run.axes[k], run.cutter, machine, ring) for k in ends[first]]
        for k, kind in zip(ends, which.ravel(), strict=True):
            if depths[kind] > -RAPID_CLEARANCE:
                found.append(Collision("blades", "teeth", (int(run.line[k]),), depths[kind]))
    return found


def standing_retracts(
    path: MachinePath, runs: list[CuttingRun], member: Member, machine: MillingMachine
) -> list[Collision]:
    """Rapid blocks that draw the blades out of the work with the spindle standing, or turning backwards."""
    return [
        one
        for run in runs
        if run.blades is None
        for one in _in_the_work(run, _drawn(run) & (_turning(path, run, machine) <= 0.0), member, machine)
    ]


def left_in_the_work(runs: list[CuttingRun], member: Member, machine: MillingMachine) -> list[Collision]:
    """Last blocks of tools that end with the blades in the work."""
    last = [np.append(np.zeros(len(run.axes), dtype=bool), run.cutting[-1]) for run in runs]
    return [one for run, end in zip(runs, last, strict=True) for one in _in_the_work(run, end, member, machine)]


def _drawn(run: CuttingRun) -> np.ndarray:
    """Whether each row (n+1,) is a rapid one behind one that cuts; the last stands for what follows the program."""
    return np.append(np.append(False, run.cutting[:-1]) & ~run.cutting, False)


def _turning(path: MachinePath, run: CuttingRun, machine: MillingMachine) -> np.ndarray:
    """Speed of the spindle (n+1,) in the sense in which the machine cuts, in every row of a tool."""
    sense = 1.0 if machine.cutter_direction == "M3" else -1.0
    return np.append(path.rpm[path.tool == path.tools.index(run.cut.tool)] * sense, 0.0)


def _in_the_work(run: CuttingRun, rows: np.ndarray, member: Member, machine: MillingMachine) -> list[Collision]:
    """Those of ``rows`` (n+1,) before which the blades stand in the work."""
    chosen = np.flatnonzero(rows)
    if not len(chosen):
        return []
    ring, found = rings(work_profiles(member, machine.fixture)["teeth"]), []
    for k in chosen.tolist():
        depth = _blade_depth(run.axes[k - 1], run.axes[k - 1], run.cutter, machine, ring)
        if depth > 0.0:
            found.append(Collision("blades", "teeth", (int(run.line[min(k, len(run.line) - 1)]),), depth))
    return found


def _blade_depth(
    first: np.ndarray, last: np.ndarray, cutter: Cutter, machine: MillingMachine, ring: np.ndarray
) -> float:
    """How deep the blades get into the face cone between two positions, negative for what stays between. [mm]"""
    ends = np.array([first, last])
    ends[:, 3] = 0.0  # the face cone is the same all around
    height, _ = _seen(ends, ring, machine)
    if float(height.max()) < -_FAR:
        return -_FAR  # above all of the work at both ends
    poses = ends[0] + np.linspace(0.0, 1.0, _poses(ends))[:, None] * (ends[1] - ends[0])
    return float(_in_blades(cutter, *_seen(poses, ring, machine)).max())


def _poses(ends: np.ndarray) -> int:
    """How many poses follow a block: no point of the work moves more than a step between two of them."""
    reach, turn = float(np.abs(np.diff(ends, axis=0))[0, :3].max()), float(abs(ends[1, 4] - ends[0, 4]))
    return 2 + int(reach / _RAPID_STEP + turn / _RAPID_TURN)


def _along(blocks: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Poses (p,5) along blocks (n,8), X Y Z B at their starts and ends, no more than a step apart; whose they are."""
    reach = np.abs(blocks[:, 4:7] - blocks[:, :3]).max(axis=1, initial=0.0)
    count = 2 + (reach / _STEP).astype(int)
    owner = np.repeat(np.arange(len(blocks)), count)
    share = (np.arange(len(owner)) - np.repeat(np.cumsum(count) - count, count)) / (count[owner] - 1)
    first, last = blocks[owner, :4], blocks[owner, 4:]
    return np.insert(first + share[:, None] * (last - first), 3, 0.0, axis=1), owner


def _deepest(
    cutter: Cutter, head: CutterHead, poses: np.ndarray, profile: np.ndarray, machine: MillingMachine
) -> dict[str, np.ndarray]:
    """How deep a profile (n,2) of the work gets into each part of the cutter at poses (p,5), zero where not. [mm]

    Only rings that come above the plane of the tips can, and they are few: the highest point of one is known.
    """
    center, axis = kernel("tool_pose")(poses, machine.pivot_height, machine.pivot)
    deepest = {part: np.zeros(len(poses)) for part in PARTS}
    level = np.einsum("pk,pk->p", center, axis)[:, None] - axis[:, 2:] * profile[:, 0]
    pose, ring = np.nonzero(level + np.hypot(axis[:, 0], axis[:, 1])[:, None] * profile[:, 1] > 0.0)
    for begin in range(0, len(pose), _TOGETHER):
        at, points = pose[begin : begin + _TOGETHER], rings(profile[ring[begin : begin + _TOGETHER]])
        away = points.reshape(len(at), -1, 3) - center[at][:, None]
        height = -np.einsum("pqk,pk->pq", away, axis[at])
        radius = np.sqrt(np.maximum(np.einsum("pqk,pqk->pq", away, away) - height**2, 0.0))
        for part, depth in _depths(cutter, head, height, radius).items():
            np.maximum.at(deepest[part], at, depth.max(axis=1))
    return deepest


def _seen(poses: np.ndarray, points: np.ndarray, machine: MillingMachine) -> tuple[np.ndarray, np.ndarray]:
    """Height over the tip plane and radius (p,n) about the cutter's axis of points (n,3) of the work at poses (p,5)."""
    center, axis = kernel("tool_pose")(poses, machine.pivot_height, machine.pivot)
    from_center = points[None] - center[:, None]
    height = -np.einsum("pqk,pk->pq", from_center, axis)
    return height, np.sqrt(np.maximum(np.einsum("pqk,pqk->pq", from_center, from_center) - height**2, 0.0))


def _in_blades(cutter: Cutter, height: np.ndarray, radius: np.ndarray) -> np.ndarray:
    """How deep points lie between the cones of the outer and the inner blades, upwards without end."""
    body = cutter.bodies[0]
    outer = body.outer.point_radius + height * math.tan(body.outer.pressure_angle)
    inner = body.inner.point_radius - height * math.tan(body.inner.pressure_angle)
    return np.minimum.reduce([height, outer - radius, radius - inner])


def _depths(cutter: Cutter, head: CutterHead, height: np.ndarray, radius: np.ndarray) -> dict[str, np.ndarray]:
    """How deep points at ``height`` and ``radius`` lie in each part of the cutter; negative outside of it."""
    top = cutter.height + head.height
    blades = np.minimum(_in_blades(cutter, height, radius), cutter.height - height)
    disc = np.minimum.reduce([height - cutter.height, top - height, head_radius(cutter, head) - radius])
    return {"blades": blades, "head": disc, "spindle": np.minimum(height - top, head.spindle_radius - radius)}
