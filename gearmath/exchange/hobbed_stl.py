"""A virtual gear as STL: a closed solid, both flanks of every space as they were cut, without a bore."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path

import numpy as np

from gearmath.bevel.solid import write_stl
from gearmath.gearbox.dimensions import blank_diameter
from gearmath.gearbox.hobbed.envelope import Envelope
from gearmath.gearbox.hobbed.inspection import SIDES, Layout
from gearmath.gearbox.hobbed.job import TURN, HobbingJob
from gearmath.gearbox.hobbed.root import root
from gearmath.gearbox.kernels import kernel

#: Points along the profile, along the helix, and of half a root below the form circle.
ROWS, COLUMNS, ROOT = 25, 41, 12
#: Points of both flanks of a space.
ALL = 2 * ROWS * COLUMNS
#: Least width of a tooth's tip [modules]: a solid has no teeth of none.
TIP = 0.02


def write_gear(
    path: Path, cut: Envelope, where: Layout, progress: Callable[[int], object] = lambda done: None
) -> np.ndarray:
    """Write the whole gear over its face width; the triangles (n, 3, 3) [mm] are returned.

    From form circle to tip the flanks are as cut, below is the root that a hob of many gashes leaves. Every triangle
    is counter-clockwise seen from outside the metal.
    """
    rim = _rim(cut, where, progress)
    # around the gear, then upwards
    sections = np.moveaxis(rim, 2, 0).reshape(COLUMNS, -1, 3)
    around = np.roll(sections, -1, axis=1)
    a, b, c, d = sections[:-1], around[:-1], around[1:], sections[1:]
    skin = np.stack([np.stack([a, b, c], axis=-2), np.stack([a, c, d], axis=-2)], axis=-3).reshape(-1, 3, 3)
    triangles = np.concatenate([skin, _face(rim[:, :, -1]), _face(rim[:, :, 0])[:, ::-1]])
    write_stl(path, triangles, f"virtual gear of {cut.job.gear.teeth} teeth")
    return triangles


def _rim(cut: Envelope, where: Layout, progress: Callable[[int], object]) -> np.ndarray:
    """Spaces (z, points, heights, 3) [mm], each from the tip of its flank at the smaller angles through the root."""
    job = cut.job
    heights = np.linspace(0.0, job.face_width, COLUMNS)
    lengths = np.linspace(where.profile[0], _tip_length(job, where.profile[0]), ROWS)
    flanks = {side: _flank(cut, side, lengths, heights, progress) for side in SIDES.values()}
    radii, bottom, half = _root(job, float(lengths[0]))
    turned = TURN * (np.arange(job.gear.teeth)[:, None] / job.gear.teeth + job.turns_per_mm * heights)
    roots = {side: _on_circles(radii, turned, side * half[side], heights) for side in SIDES.values()}
    deepest = _on_circles(np.array([bottom]), turned, np.zeros(1), heights)
    tip = np.array([math.hypot(lengths[-1], job.base_radius)])
    outside = _on_circles(tip, turned, np.array([TURN / job.gear.teeth / 2]), heights)
    return np.concatenate([flanks[-1][:, ::-1], roots[-1][:, ::-1], deepest, roots[1], flanks[1], outside], axis=1)


def _flank(
    cut: Envelope, side: int, lengths: np.ndarray, heights: np.ndarray, progress: Callable[[int], object]
) -> np.ndarray:
    """One flank of every space (z, ROWS, COLUMNS, 3), from the form circle to the tip."""
    job, gear = cut.job, cut.job.gear
    space, rows, columns = (
        values.ravel() for values in np.meshgrid(np.arange(gear.teeth), lengths, heights, indexing="ij")
    )
    shape = (gear.teeth, gear.module, gear.alpha, gear.beta, gear.shift)
    point, normal = kernel("involute_flank")(rows, columns, space, side, job.helix_sign, *shape)
    left = cut.deviation(side, space, rows, columns, progress)
    return (point + left[:, None] * normal).reshape(gear.teeth, ROWS, COLUMNS, 3)


def _root(job: HobbingJob, form: float) -> tuple[np.ndarray, float, dict[int, np.ndarray]]:
    """Radii (ROOT,) [mm] from the bottom to below the form circle, that of the bottom, half angles by side."""
    bottom = root(job, np.empty(0)).bottom
    height = math.hypot(form, job.base_radius) - bottom
    radii = bottom + height * np.linspace(1e-3, 1.0, ROOT, endpoint=False)
    return radii, bottom, {side: root(job, radii, side).half_angle for side in SIDES.values()}


def _tip_length(job: HobbingJob, form: float) -> float:
    """Length of roll [mm] at the tip, or where a pointed tooth is still TIP wide."""
    base = job.base_radius
    lengths = np.linspace(form, math.sqrt((blank_diameter(job.gear) / 2) ** 2 - base**2), 200)
    shape = (job.gear.teeth, job.gear.module, job.gear.alpha, job.gear.beta, job.gear.shift)
    point, _ = kernel("involute_flank")(lengths, 0.0, 0, 1, job.helix_sign, *shape)
    width = 2 * np.hypot(lengths, base) * (math.pi / job.gear.teeth - np.arctan2(point[:, 1], point[:, 0]))
    return float(lengths[np.flatnonzero(width > TIP * job.gear.module)[-1]])


def _on_circles(radii: np.ndarray, turned: np.ndarray, angle: np.ndarray, heights: np.ndarray) -> np.ndarray:
    """Points (z, n, heights, 3) at radii (n,) and angles (n,) from the middle of spaces, turned (z, heights)."""
    at = turned[:, None, :] + angle[:, None]
    radius = np.broadcast_to(radii[:, None], at.shape)
    return np.stack([radius * np.cos(at), radius * np.sin(at), np.broadcast_to(heights, at.shape)], axis=-1)


def _face(rim: np.ndarray) -> np.ndarray:
    """The upper face from spaces (z, points, 3): teeth from flank to flank, the rest from the axis."""
    half = ROOT + ROWS
    before = rim[:, half + 1 : 2 * half + 1]  # of the tooth behind each space, from the root to the tip
    after = np.roll(rim[:, :half][:, ::-1], -1, axis=0)
    deepest, tip = rim[:, half], rim[:, -1]
    axis = np.broadcast_to([0.0, 0.0, rim[0, half, 2]], deepest.shape)
    parts = [
        (before[:, :-1], before[:, 1:], after[:, 1:]),
        (before[:, :-1], after[:, 1:], after[:, :-1]),
        (before[:, -1], tip, after[:, -1]),
        (axis, rim[:, half - 1], deepest),
        (axis, deepest, before[:, 0]),
        (axis, before[:, 0], after[:, 0]),
    ]
    return np.concatenate([np.stack(corners, axis=-2).reshape(-1, 3, 3) for corners in parts])
