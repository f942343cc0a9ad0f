"""Probing programs: every tooth at the reference point for pitch, a grid of both flanks for topography.

After the last tooth some points of tooth 0 are touched again, as tooth z: what differs is drift.
The stylus enters a space from above, square to the root cone, and touches along the outward normal; outside of the
space it moves at a height that clears the whole member at every position of A.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import fields

import numpy as np

from gearmath.bevel.flank import Grid, blank_grid, solve_flank
from gearmath.errors import InputError
from gearmath.kernels import kernel
from gearmath.machine.clear_space import Room, check_home, room_of
from gearmath.machine.pattern import Pattern, Targets, check_travel
from gearmath.machine.point_loop import point_loop
from gearmath.machine.probe_words import Blocks, Plan
from gearmath.machine.setup_facts import NOT_ON_METAL, PROBING, VARIABLES
from gearmath.machine.words import plain
from gearmath.specs.bevel_set import FLANKS, BevelSet, Member, design_sha256
from gearmath.specs.calibration import Calibration
from gearmath.specs.milling_machine import MillingMachine
from gearmath.specs.simulated_machine import Probe
from gearmath.version import __version__

#: The tip starts its touch this far from the flank, or half way to the opposite one. [mm]
APPROACH = 1.5
#: Least distance from which a touch may start. [mm]
_LEAST_APPROACH = 0.1
#: Teeth of which a registration wants more than the reference point.
_AROUND = 8
#: Height of all sideways motion above the highest point of the member. [mm]
CLEARANCE = 5.0


def probe_height(machine: MillingMachine, calibration: Calibration) -> float:
    """H [mm] of equation (15.3)."""
    return machine.gauge_line_height + calibration.length


def lobing(probe: Calibration | Probe) -> np.ndarray:
    """Lobes (2,) [mm] of equation (23.3)."""
    (lobes,) = kernel("lobing_of")(probe.lobing_um / 1000, math.radians(probe.lobing_phase))
    return lobes


def tip_positions(
    tip: np.ndarray, A: np.ndarray, B: float, machine: MillingMachine, calibration: Calibration
) -> np.ndarray:
    """Positions X Y Z A B (n,5) that put the tip at places (n,3) of the work."""
    height = probe_height(machine, calibration)
    (axes,) = kernel("probe_axes")(tip, A, B, height, calibration.tip_offset, machine.pivot)
    return axes


def probe_targets(
    member: Member,
    name: str,
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
    if not all(0 <= tooth < member.teeth for tooth in topography):
        raise InputError(f"{name}: teeth = {list(topography)}: must be numbers from 0 to {member.teeth - 1}")
    grid = blank_grid(member) if grid is None else grid
    flanks = [targets_of_space(member, name, flank, grid, machine, calibration) for flank in FLANKS]
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
        raise InputError(f"{name}: there is nothing to probe: neither a tooth for topography, nor pitch")
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
    member: Member, name: str, flank: str, grid: Grid, machine: MillingMachine, calibration: Calibration
) -> Targets:
    """The touches of the whole grid of one flank of space 0.

    Raises InputError naming flank, row and column where the tip has no room between the flanks.
    """
    (other,) = (each for each in FLANKS if each != flank)
    points, opposite = (solve_flank(member, name, each, grid) for each in (flank, other))
    row, col = (index.ravel() for index in np.indices(grid.shape))
    r = calibration.tip_radius
    (touch,) = kernel("probe_target")(points.point, points.normal, r, 0.0)
    (room,) = kernel("point_deviation")(touch, r, opposite.point, opposite.normal)
    standoff = np.minimum(APPROACH, room / 2)
    if (standoff < _LEAST_APPROACH).any():
        k = int(np.argmin(standoff))
        raise InputError(
            f"{name} {flank} flank, row {row[k]}, col {col[k]}: tip_radius = {r} mm: leaves {room[k]:.3f} mm to the "
            f"opposite flank, {2 * _LEAST_APPROACH:g} mm are needed"
        )
    (A,) = kernel("space_azimuth")(points.point, opposite.point)
    positions = []
    for distance in (standoff, np.zeros(len(row)), np.full(len(row), -calibration.overtravel)):
        (tip,) = kernel("probe_target")(points.point, points.normal, r, distance)
        positions.append(tip_positions(tip, A, math.radians(member.blank.root_angle), machine, calibration))
    n = len(row)
    return Targets(np.full(n, flank), np.zeros(n, dtype=int), row, col, *positions)


def clear_height(member: Member, machine: MillingMachine, calibration: Calibration) -> float:
    """Z [mm] at which the tip clears the member at every A, with B at the root angle."""
    axial, radial = kernel("flank_place")(member.blank.vector, np.array([0.0, 1.0]), np.ones(2))
    tips = np.stack([radial, np.zeros(2), axial], axis=1)
    here = tip_positions(tips, np.zeros(2), math.radians(member.blank.root_angle), machine, calibration)
    return float(here[:, 2].max()) + calibration.tip_radius + CLEARANCE


def probing_program(
    bevel_set: BevelSet,
    name: str,
    machine: MillingMachine,
    calibration: Calibration,
    program_name: str,
    topography: Sequence[int] = (0,),
    pitch: bool = True,
    repeat: int = 1,
    around: Sequence[int] = (),
) -> str:
    """The program that probes a member, every point ``repeat`` times one after the other; see :func:`probe_targets`.

    Raises InputError for travel, room, and a name that the control refuses.
    """
    member = bevel_set.member(name)
    targets = probe_targets(member, name, machine, calibration, topography, pitch, around=around)
    level = clear_height(member, machine, calibration)
    check_travel(Pattern.of(targets, member.teeth, machine).targets(), name, machine, level)
    room = room_of(member, machine, machine.fixture)
    check_home(room, machine, calibration.length + calibration.tip_radius - calibration.offset[2], program_name)
    header = (
        f"gearmath {__version__} probing program",
        f"set: {plain(bevel_set.title)}",
        f"member: {name}, {member.teeth} teeth, {member.hand} hand",
        f"nominal settings sha256: {design_sha256(member)}",
        f"machine: {plain(machine.name)}",
        f"probe: {plain(calibration.name)}, tip radius {calibration.tip_radius:g} mm, length {calibration.length:g} mm",
        f"{len(targets)} points" + (f", each touched {repeat} times" if repeat > 1 else ""),
        "R90, R91: first and last point to touch, 0 for all; the program asks before it leaves points out",
        "a run from point 1 on deletes the touches of the last run, one that begins later adds to them",
        "R102 counts the runs, R101 the points offered, R103 those that a host has acknowledged",
        "R104 = 1, set before the start: a host reads R200 to R205 of every point, and the program waits for it",
        *(f"unconfirmed: {text}" for text in (NOT_ON_METAL, VARIABLES, PROBING)),
    )
    return write_touches(
        program_name, header, targets, name, member.teeth, machine, calibration, level, room, repeat
    )  # fmt: skip


def write_touches(
    program_name: str, header: Sequence[str], targets: Targets, name: str, teeth: int, machine: MillingMachine,
    calibration: Calibration, level: float, room: Room, repeat: int = 1,
) -> str:  # fmt: skip
    """The text of a probing program: its touches in two loops, sideways at the ``level`` of :func:`clear_height`.

    The probe comes from the home of Z, which clears the ``room`` of the work. Every point can be the first of a run.

    Raises InputError for touches that fill the result file, and for a name that the control refuses.
    """
    pattern = Pattern.of(targets, teeth, machine)
    blocks = Blocks(program_name, machine, calibration.length)
    flanks = " and ".join(flank for flank in FLANKS if (targets.flank == flank).any())
    touches = len(targets) * repeat
    said = f"{touches} touches, {len(set(targets.tooth.tolist()))} teeth, {flanks}"
    plan = Plan(touches, said, len(targets), "point", repeat)
    return blocks.text(header, point_loop(blocks, pattern, name, plan, level, room))
