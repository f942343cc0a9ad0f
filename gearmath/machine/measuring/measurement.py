"""A simulated measurement: the member in a clamping of its own, touched in the order of the probing program.

The member is as a virtual milling left it. It sits eccentric and tilted on the axis that turns it, it drifts evenly
from the first touch to the last, and every touch has noise and lobes. Reference point and corners of tooth 0 are
touched again at the end, as tooth z, which shows the drift.
"""

from __future__ import annotations

import math
import zlib
from dataclasses import replace

import numpy as np

from gearmath.bevel.flank import solve_flank
from gearmath.bevel.grid import file_grid
from gearmath.kernels import kernel
from gearmath.machine.bodies.probe_tip import lobing
from gearmath.machine.milling.axis_errors import mounted
from gearmath.machine.planning.targets import landmarks
from gearmath.specs.bevel_set import FLANKS, Member
from gearmath.specs.flank_csv import FlankFile
from gearmath.specs.simulated_machine import SimulatedMachine


def measure_member(true: FlankFile, member: Member, shop: SimulatedMachine, run: int = 1) -> FlankFile:
    """What the measuring machine of a shop says of a member: the file it would write of a true one.

    ``true`` holds the metal as it is: deviations without noise, in mm along the nominal normals. ``run`` numbers the
    measurements: each has its own noise, the same in every call. Rows are in the order of the touches, evenly in time;
    ``uncertainty`` is that of the average of the touches of one point, its noise only.
    """
    file = _in_order(true, member)
    nominal = file.point - file.deviation[:, None] * file.normal
    place = _work_axis(file, member), member.blank.delta_f, 0.0, np.zeros(3), np.zeros(3)
    metal, _ = mounted(file.point, file.normal, shop.measuring_clamp(member.name))
    (axes,) = kernel("probe_axes")(metal, *place)
    axes[:, :3] += np.linspace(0.0, 1.0, len(file))[:, None] * shop.measuring.drift.vector
    seen, _ = kernel("probe_tip")(axes, *place[2:])
    (normal,) = kernel("probe_axes")(file.normal, *place)  # about the origin: the normal in the axes of the machine
    (late,) = kernel("effective_radius")(normal[:, :3], 0.0, lobing(shop.probe))
    _, deviation = kernel("touched_point")(seen, 0.0, nominal, file.normal)
    noise = np.random.default_rng([shop.seed, zlib.crc32(member.name.encode()), run]).standard_normal(len(file))
    met = deviation + late
    touched = replace(file, point=nominal + met[:, None] * file.normal, deviation=met)
    return touched.with_noise(shop.probe.sigma * noise, shop.probe.sigma)


def _in_order(file: FlankFile, member: Member) -> FlankFile:
    """The points tooth by tooth, flank by flank, and the landmarks of tooth 0 once more as tooth z."""
    flank = np.array([FLANKS.index(one) for one in file.flank])
    order = np.lexsort((file.col, file.row, flank, file.tooth))
    marked = (file.tooth == 0) & landmarks(file.row, file.col, file_grid(file, member).shape, corners=True)
    index = np.concatenate([order, order[marked[order]]])
    tooth = file.tooth[index]
    tooth[len(order) :] = member.teeth
    return replace(file.pick(index), tooth=tooth)


def _work_axis(file: FlankFile, member: Member) -> np.ndarray:
    """Positions (n,) [rad] of the work axis at which the points are touched, each with its space on top."""
    grid = file_grid(file, member)
    points = {flank: solve_flank(member, flank, grid).point for flank in FLANKS}
    angle = {flank: kernel("space_azimuth")(points[flank], points[other])[0] for flank, other in (FLANKS, FLANKS[::-1])}
    place = file.row * grid.shape[1] + file.col
    at = np.array([angle[flank][k] for flank, k in zip(file.flank, place, strict=True)])
    return at + 2 * math.pi * file.tooth / member.teeth
