"""What is to be touched of a member: every tooth once for pitch, a grid of both flanks for topography."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import fields

import numpy as np

from gearmath.bevel.flank import Grid, blank_grid, solve_flank
from gearmath.errors import InputError
from gearmath.kernels import kernel
from gearmath.machine.bodies.probe_tip import probe_height
from gearmath.machine.planning.pattern import Targets
from gearmath.specs.bevel_set import FLANKS, Member
from gearmath.specs.calibration import Calibration
from gearmath.specs.milling_machine import MillingMachine

#: The tip starts its touch this far from the flank, or half way to the opposite one. [mm]
APPROACH = 1.5
#: Least distance from which a touch may start. [mm]
_LEAST_APPROACH = 0.1
#: Teeth of which a registration wants more than the reference point.
_AROUND = 8
#: Between touches, all of it guarded. [mm/min]
POSITIONING_FEED = 3000.0
#: Along the normal of a flank, and into the space before that and out of it. [mm/min]
MEASURING_FEED, APPROACH_FEED = 100.0, 800.0
#: Height of all sideways motion above the highest point of the member. [mm]
CLEARANCE = 5.0


def tip_positions(
    tip: np.ndarray, A: np.ndarray, B: float, machine: MillingMachine, calibration: Calibration
) -> np.ndarray:
    """Positions X Y Z A B (n,5) that put the tip at places (n,3) of the work."""
    height = probe_height(machine, calibration)
    (axes,) = kernel("probe_axes")(tip, A, B, height, calibration.tip_offset, machine.pivot)
    return axes


def probe_targets(
    member: Member,
    machine: MillingMachine,
    calibration: Calibration,
    topography: Sequence[int] = (0,),
    pitch: bool = True,
    grid: Grid | None = None,
    around: Sequence[int] = (),
) -> Targets:
    """The touches of a member: the whole grid on the teeth of ``topography``, the reference point on all others.

    On the teeth ``around`` also the corners of the grid: eight of them tell tilt and eccentricity of the work.

    With ``pitch``, tooth 0 comes once more at the end, as tooth z, A standing as for tooth 0: the reference points, and
    the corners of the grid where it was probed in full, whose normals tell a drift in any direction.
    Raises InputError naming flank, row and column where the tip has no room between the flanks.
    """
    beyond = next((tooth for tooth in topography if not 0 <= tooth < member.teeth), None)
    if beyond is not None:
        raise InputError(f"{member.name}: tooth {beyond} for topography: must be a number from 0 to {member.teeth - 1}")
    grid = blank_grid(member) if grid is None else grid
    flanks = [targets_of_space(member, flank, grid, machine, calibration) for flank in FLANKS]
    parts = []
    for tooth in range(member.teeth + 1):
        for one in flanks:
            whole = tooth in topography
            if whole or pitch:
                again = tooth == member.teeth and 0 in topography
                keep = landmarks(one.row, one.col, grid.shape, corners=again or tooth in around)
                # tooth z stands as tooth 0 does
                angle = 2 * math.pi * (tooth % member.teeth) / member.teeth
                part = one.pick(keep | whole)
                part.tooth[:] = tooth
                parts.append(part.turned_by(np.full(len(part), angle)))
    if not parts:
        raise InputError(f"{member.name}: there is nothing to probe: neither a tooth for topography, nor pitch")
    joined = (np.concatenate([getattr(part, field.name) for part in parts]) for field in fields(Targets))
    return Targets(*joined)


def teeth_around(teeth: int) -> list[int]:
    """Eight teeth evenly around, or all where there are fewer."""
    return sorted({round(k * teeth / _AROUND) % teeth for k in range(_AROUND)})


def landmarks(row: np.ndarray, col: np.ndarray, shape: tuple[int, int], corners: bool) -> np.ndarray:
    """Which points (n,) of a grid are its reference point, in the middle, or one of its ``corners``."""
    rows, columns = shape
    middle = (row == rows // 2) & (col == columns // 2)
    return middle | (corners & np.isin(row, (0, rows - 1)) & np.isin(col, (0, columns - 1)))


def targets_of_space(
    member: Member, flank: str, grid: Grid, machine: MillingMachine, calibration: Calibration
) -> Targets:
    """The touches of the whole grid of one flank of space 0.

    Raises InputError naming flank, row and column where the tip has no room between the flanks.
    """
    (other,) = (each for each in FLANKS if each != flank)
    points, opposite = (solve_flank(member, each, grid) for each in (flank, other))
    row, col = (index.ravel() for index in np.indices(grid.shape))
    r = calibration.tip_radius
    (touch,) = kernel("probe_target")(points.point, points.normal, r, 0.0)
    (room,) = kernel("point_deviation")(touch, r, opposite.point, opposite.normal)
    standoff = np.minimum(APPROACH, room / 2)
    if (standoff < _LEAST_APPROACH).any():
        k = int(np.argmin(standoff))
        raise InputError(
            f"{member.name} {flank} flank, row {row[k]}, col {col[k]}: tip_radius = {r} mm: leaves {room[k]:.3f} mm to "
            f"the opposite flank, {2 * _LEAST_APPROACH:g} mm are needed"
        )
    (A,) = kernel("space_azimuth")(points.point, opposite.point)
    positions = []
    for distance in (standoff, np.zeros(len(row)), np.full(len(row), -calibration.overtravel)):
        (tip,) = kernel("probe_target")(points.point, points.normal, r, distance)
        positions.append(tip_positions(tip, A, member.blank.delta_f, machine, calibration))
    n = len(row)
    return Targets(np.full(n, flank), np.zeros(n, dtype=int), row, col, *positions)
