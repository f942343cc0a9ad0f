"""What a hobbing program leaves on the flanks of all spaces, and whether that is what it states."""

from __future__ import annotations

import numpy as np

from gearmath.bevel.flank import Grid
from gearmath.bevel.turning import turned
from gearmath.kernels import kernel
from gearmath.machine.judging.block_check import MOST_LINES
from gearmath.machine.judging.cut import BESIDE_MOST, MetalLeft, justified, says
from gearmath.machine.judging.faults import Fault
from gearmath.machine.judging.stated import Stated
from gearmath.machine.milling.mill import expose, thickness
from gearmath.machine.milling.run import CuttingRun
from gearmath.machine.planning.passes import tooth_angles
from gearmath.machine.planning.path import below_the_flank, flank_points
from gearmath.specs.bevel_set import FLANKS, Member
from gearmath.specs.milling_machine import MillingMachine

#: Places across the face at which the borders of flanks are looked at.
_ACROSS = np.array([0.0, 0.5, 1.0])
#: The worst place at a border keeps less than this times what three quarters of them do: 4.1 is the most of the bundled
#: sets and three designs at 0.02 um to 100 um.
_BESIDE_MOST = 5.0


def hobbed(deviation: np.ndarray, borders: np.ndarray, stated: Stated, rounding: float) -> MetalLeft:
    """What the deviations (n,) [mm] of hobbed flanks from those of their settings say, and what :func:`left_at_borders`
    (m,) [mm] does, which is not asked of flanks that keep a stock.
    """
    usual = float(np.quantile(np.abs(deviation), MOST_LINES))
    met = borders[np.isfinite(borders)]
    if len(met):
        usual = max(usual, _BESIDE_MOST / BESIDE_MOST * float(np.quantile(np.abs(met), MOST_LINES)))
    tolerance = justified(stated, usual, rounding)
    faults = []
    if not (worst := float(np.abs(deviation).max())) <= stated.stock + tolerance:
        limit = f"{says(stated, tolerance)} {tolerance * 1000:g} um"
        faults.append(Fault(f"the flanks deviate by up to {worst * 1000:.3f} um, {limit}"))
    if (most := float(met.max(initial=-np.inf))) > tolerance:
        limit = f"{says(stated, tolerance)} {tolerance * 1000:g} um"
        faults.append(Fault(f"the flanks keep up to {most * 1000:+.3f} um where they end, {limit}"))
    if len(met) < len(borders):
        faults.append(Fault(f"{len(borders) - len(met)} of {len(borders)} places where flanks end are not cut at all"))
    return MetalLeft(None, tolerance, tuple(faults))


def left_at_borders(runs: list[CuttingRun], member: Member, machine: MillingMachine) -> np.ndarray:
    """What the passes leave (n,) [mm] where the flanks of all spaces end, at the face cone and at their fillets; NaN
    where they cut nothing.

    Scallops are highest there. What is cut away is not judged by it: the border of an undercut flank is.
    """
    borders = {flank: _border(member, flank) for flank in FLANKS}
    angles = tooth_angles(member.teeth, member.rad("index_correction"))
    found = []
    for flank, opposite in zip(FLANKS, reversed(FLANKS), strict=True):
        point, normal = borders[flank]
        start = -0.5 * thickness(point, borders[opposite][0], member.teeth)
        where, along = (np.concatenate([turned(values, angle) for angle in angles]) for values in (point, normal))
        found.append(expose(runs, machine, None, where, along, np.tile(start, len(angles))).distance)
    return np.concatenate(found)


def _border(member: Member, flank: str) -> tuple[np.ndarray, np.ndarray]:
    """Points and normals (n,3) of a flank of space 0."""
    axial, radial = kernel("flank_place")(member.blank.vector, _ACROSS, np.ones(len(_ACROSS)))
    top = flank_points(member, flank, Grid(axial, radial))
    _, fillet, _ = [found for found in below_the_flank(member, flank, _ACROSS) if found[0] != "edge"][-1]
    on = fillet.converged
    return np.concatenate([top.point, fillet.point[on]]), np.concatenate([top.normal, fillet.normal[on]])
