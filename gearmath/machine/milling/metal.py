"""The metal that a program leaves at the places where a measurement of the whole member looks for it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from gearmath.bevel.flank import blank_grid
from gearmath.bevel.nominal_file import MARGIN, nominal_flank
from gearmath.machine.control.executor import MachinePath
from gearmath.machine.milling.mill import measured_lines, root_of, thickness
from gearmath.machine.milling.run import CuttingRun, runs_of
from gearmath.machine.planning.targets import landmarks
from gearmath.specs.bevel_set import FLANKS, Member
from gearmath.specs.flank_csv import FlankFile, join
from gearmath.specs.milling_machine import MillingMachine
from gearmath.specs.simulated_machine import SimulatedMachine


def metal(
    path: MachinePath,
    member: Member,
    machine: MillingMachine,
    errors: SimulatedMachine | None = None,
    whole: Sequence[int] = (0,),
    around: Sequence[int] = (),
    progress: Callable[[int], object] = lambda _: None,
    runs: list[CuttingRun] | None = None,
) -> FlankFile:
    """What a program leaves, without noise: the grid of the teeth ``whole``, the reference point of every tooth.

    Of the teeth ``around``, the corners of the grid too: eight of them let a registration find tilt and eccentricity.
    Points are exposed to the passes of their own space and of both neighbours. ``runs`` are the tools of the program
    where they are known. Raises InputError where the program
    leaves a flank uncut, or cuts with a tool that is not of this member.
    """
    runs = runs_of(path, member, machine, errors, root_of(member)) if runs is None else runs
    grid = blank_grid(member, margin=MARGIN)
    nominal = {flank: nominal_flank(member, flank, grid) for flank in FLANKS}
    row, col = (index.ravel() for index in np.indices(grid.shape))
    reference, corners = (landmarks(row, col, grid.shape, corners=more) for more in (False, True))
    files = []
    for tooth in range(member.teeth):
        near = [_near(run, tooth, member.teeth) for run in runs]
        keep = corners | True if tooth in whole else corners if tooth in around else reference
        for flank, other in (FLANKS, FLANKS[::-1]):
            wanted = nominal[flank].pick(keep)
            start = -0.5 * thickness(wanted.point, nominal[other].point, member.teeth)
            files += measured_lines(near, member, machine, errors, wanted, flank, [tooth], start)
            progress(1)
    return join(files)


def _near(run: CuttingRun, tooth: int, teeth: int) -> CuttingRun:
    """A run of which only the passes through a space and its neighbours cut; face hobbing cuts all spaces at once."""
    if run.blades is not None:
        return run
    return replace(run, cutting=run.cutting & np.isin(run.space, np.arange(tooth - 1, tooth + 2) % teeth))
