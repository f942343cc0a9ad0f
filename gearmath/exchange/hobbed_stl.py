"""The flanks of a virtual gear as STL: both flanks of every space as they were cut, open surfaces."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np

from gearmath.bevel.solid import write_stl
from gearmath.gearbox.hobbed.envelope import Cut
from gearmath.gearbox.hobbed.inspection import SIDES, Layout
from gearmath.gearbox.kernels import kernel

#: Points along the profile, and along the helix.
ROWS, COLUMNS = 25, 41
#: Points of both flanks of a space.
ALL = 2 * ROWS * COLUMNS


def write_flanks(
    path: Path, cut: Cut, where: Layout, progress: Callable[[int], object] = lambda done: None
) -> np.ndarray:
    """Write the flanks from form circle to tip over the whole face width; the triangles (n, 3, 3) [mm] are returned.

    Every triangle is counter-clockwise seen from outside the metal.
    """
    triangles = np.concatenate([_flank(cut, where, side, progress) for side in SIDES.values()])
    write_stl(path, triangles, f"virtual gear of {cut.job.gear.teeth} teeth")
    return triangles


def _flank(cut: Cut, where: Layout, side: int, progress: Callable[[int], object]) -> np.ndarray:
    """Triangles of one flank of every space."""
    job, gear = cut.job, cut.job.gear
    length = np.linspace(where.profile[0], where.profile[-1], ROWS)
    height = np.linspace(0.0, job.face_width, COLUMNS)
    space, rows, columns = (
        values.ravel() for values in np.meshgrid(np.arange(gear.teeth), length, height, indexing="ij")
    )
    shape = (gear.teeth, gear.module, gear.alpha, gear.beta, gear.shift)
    point, normal = kernel("involute_flank")(rows, columns, space, side, job.helix_sign, *shape)
    left = cut.deviation(side, space, rows, columns, progress)
    net = (point + left[:, None] * normal).reshape(gear.teeth, ROWS, COLUMNS, 3)
    a, b, c, d = net[:, :-1, :-1], net[:, 1:, :-1], net[:, 1:, 1:], net[:, :-1, 1:]
    halves = np.stack([np.stack([a, b, c], axis=-2), np.stack([a, c, d], axis=-2)], axis=-3).reshape(-1, 3, 3)
    return halves if side == 1 else halves[:, ::-1]
