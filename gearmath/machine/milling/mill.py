"""The simulated machine end to end: an executed program in, the flanks it leaves out, as a measured flank file."""

from __future__ import annotations

import math
import zlib
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from gearmath.bevel.flank import blank_grid
from gearmath.bevel.nominal_file import MARGIN, nominal_flank
from gearmath.bevel.tooth import ToothSpace, tooth_space
from gearmath.bevel.turning import turned
from gearmath.errors import InputError
from gearmath.machine.control.executor import MachinePath
from gearmath.machine.milling.axis_errors import mounted
from gearmath.machine.milling.blade_removal import removal_by_blades
from gearmath.machine.milling.removal import Removal, removal
from gearmath.machine.milling.run import CuttingRun, runs_of
from gearmath.specs.bevel_set import FLANKS, Member
from gearmath.specs.flank_csv import PLANNED, FlankFile, flank_file, join
from gearmath.specs.milling_machine import MillingMachine
from gearmath.specs.simulated_machine import SimulatedMachine

#: Spaces whose reference points are exposed together.
_SPACES = 12


def mill_member(
    path: MachinePath,
    member: Member,
    machine: MillingMachine,
    errors: SimulatedMachine | None = None,
    progress: Callable[[int], object] = lambda _: None,
    runs: list[CuttingRun] | None = None,
) -> FlankFile:
    """What a program leaves on a member: the whole grid of the first space cut, the reference point of the others.

    Every point is exposed to all passes of all tools, so that a neighbour's pass that cuts into it is seen. Deviations
    are against the nominal flanks. ``errors`` makes machine, work axis and probe those of a simulated shop; without it
    they are perfect. ``runs`` are the tools of the program where they are known. Raises InputError if the program cuts
    with a tool that is not of this member, or leaves a flank uncut.
    """
    runs = runs_of(path, member, machine, errors, root_of(member)) if runs is None else runs
    grid = blank_grid(member, margin=MARGIN)
    nominals = {flank: nominal_flank(member, flank, grid) for flank in FLANKS}
    files = []
    for run in runs:
        for flank in run.cut.flanks:
            for spaces in _together(run.spaces):
                wanted = nominals[flank] if spaces[0] == run.spaces[0] else _reference_only(nominals[flank])
                start = -0.5 * thickness(wanted.point, nominals[_other(flank)].point, member.teeth)
                files += measured_lines(runs, member, machine, errors, wanted, flank, spaces, start)
                progress(len(spaces))
    missing = [flank for flank in FLANKS if not any(file.flank[0] == flank for file in files)]
    if missing:
        raise InputError(f"the program does not cut the {missing[0]} flank of the {member.name}")
    whole = join(files)
    header = whole.header | {PLANNED: f"{len(whole)} points"}  # a file that is cut off later is told
    return probed(replace(whole, header=header), member.name, errors)


def thickness(point: np.ndarray, opposite: np.ndarray, teeth: int) -> np.ndarray:
    """Distance (n,) [mm] of flank points (n,3) from the points (m,3) of the other flank of the same tooth.

    ``opposite`` belongs to the same space; the flank on the tooth's other side is a pitch away, on the side away from
    the space.
    """
    across = np.arctan2(*(opposite.mean(axis=0)[[1, 0]])) - np.arctan2(*(point.mean(axis=0)[[1, 0]]))
    away = -math.copysign(1.0, math.remainder(float(across), 2 * math.pi))
    beside = turned(opposite, away * 2 * math.pi / teeth)
    return np.linalg.norm(point[:, None] - beside[None], axis=2).min(axis=1)


def root_of(member: Member) -> ToothSpace | None:
    """The space whose root a fixed-setting cutter has to fit in; a completing one is what its blades are."""
    if member.cutting == "completing":
        return None
    return tooth_space(member, 7)


def _together(spaces: list[int]) -> list[list[int]]:
    """The first space by itself, and the others in groups whose lines are exposed in one call."""
    return [spaces[:1], *(spaces[k : k + _SPACES] for k in range(1, len(spaces), _SPACES))]


def measured_lines(
    runs: list[CuttingRun],
    member: Member,
    machine: MillingMachine,
    errors: SimulatedMachine | None,
    nominal: FlankFile,
    flank: str,
    spaces: list[int],
    start: np.ndarray,
) -> list[FlankFile]:
    """The deviations that all passes leave at nominal points of some spaces, which are given for tooth 0."""
    angles = [2 * math.pi * space / member.teeth for space in spaces]
    points, normals = ([turned(part, angle) for angle in angles] for part in (nominal.point, nominal.normal))
    lines = (np.concatenate(points), np.concatenate(normals), np.tile(start, len(spaces)))
    left = np.split(expose(runs, machine, errors, *lines).distance, len(spaces))
    files = []
    for space, point, normal, deviation in zip(spaces, points, normals, left, strict=True):
        if np.isnan(deviation).any():
            k = int(np.argmax(np.isnan(deviation)))
            place = f"row {nominal.row[k]}, col {nominal.col[k]}"
            raise InputError(f"the program leaves the {flank} flank of space {space} uncut at {place}")
        files.append(
            flank_file(
                nominal.header,
                nominal.member,
                flank,
                space,
                nominal.row,
                nominal.col,
                point + deviation[:, None] * normal,
                normal,
                deviation,
            )
        )
    return files


def expose(
    runs: list[CuttingRun],
    machine: MillingMachine,
    errors: SimulatedMachine | None,
    point: np.ndarray,
    normal: np.ndarray,
    start: np.ndarray,
    progress: Callable[[int], object] = lambda _: None,
) -> Removal:
    """What all tools leave of lines of the work; ``block`` counts through the blocks of all runs."""
    where, along = mounted(point, normal, errors.mounting) if errors is not None else (point, normal)
    left, offset = Removal(np.full(len(point), np.nan), np.full(len(point), -1)), 0
    for run in runs:
        pose = (machine.pivot_height, machine.pivot)
        lines = (pose, where, along, start, progress)
        if run.blades is None:
            found = removal(run.axes, run.cutting, run.cutter, *lines)
        else:
            found = removal_by_blades(run.axes, run.turned, run.cutting, run.blades, *lines)
        left, offset = left.joined(found, offset), offset + len(run.axes)
    return left


def _other(flank: str) -> str:
    return FLANKS[1 - FLANKS.index(flank)]


def _reference_only(file: FlankFile) -> FlankFile:
    row, col = (int(part) for part in file.header["reference_point"].split(","))
    k = np.flatnonzero((file.row == row) & (file.col == col))
    return flank_file(
        file.header, file.member, file.flank[0], 0, file.row[k], file.col[k], file.point[k], file.normal[k]
    )


def probed(file: FlankFile, name: str, errors: SimulatedMachine | None) -> FlankFile:
    """The file with seeded probe noise on every deviation, and its standard uncertainty."""
    sigma = errors.probe.sigma if errors is not None else 0.0
    if sigma == 0.0 or errors is None:
        return file
    noise = sigma * np.random.default_rng([errors.seed, zlib.crc32(name.encode())]).standard_normal(len(file))
    return file.with_noise(noise, sigma)
