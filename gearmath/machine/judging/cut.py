"""What a program leaves of the metal, judged: blocks off the path, spaces left out, stock and gouges everywhere."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from gearmath.bevel.method import motion_of
from gearmath.bevel.ridge import point_width
from gearmath.bevel.tooth import ToothSpace
from gearmath.errors import counted
from gearmath.machine.judging.alike import alike
from gearmath.machine.judging.block_check import Watch, watch
from gearmath.machine.judging.faults import Fault
from gearmath.machine.judging.stated import Stated
from gearmath.machine.milling.axis_errors import roll_position
from gearmath.machine.milling.run import CuttingRun
from gearmath.machine.milling.surfaces import DEFAULT_COLUMNS, surface_states
from gearmath.machine.milling.surfaces import DEFAULT_TOLERANCE as REPORTED
from gearmath.machine.planning.hobbing import index_ratio
from gearmath.machine.planning.passes import tooth_angles
from gearmath.machine.planning.path import DEFAULT_TOLERANCE, Cut, axis_positions, spindle_phase
from gearmath.machine.planning.rounding import FROM_AXIS, FROM_CUTTER, control_share
from gearmath.specs.bevel_set import FLANKS, Member
from gearmath.specs.milling_machine import MillingMachine

#: The worst place of a flank deviates by less than this times what three quarters of it do: 2.3 is the most of the
#: bundled sets at 0.01 um to 100 um, in straight and polynomial blocks.
BESIDE_MOST = 3.0
#: A dry run may be nearer to its cut than stated by this. [mm]
_FAR_ABOVE = 0.1


def allowed(stated: Stated) -> float:
    """How far flanks may deviate [mm]: as the program states, or where it states nothing as a report counts it."""
    return REPORTED if stated.tolerance is None else stated.tolerance


def justified(stated: Stated, usual: float, rounding: float) -> float:
    """How far flanks may deviate [mm]: as :func:`allowed`, but no farther than a program of ours makes its blocks for.

    The header can be edited. The planned blocks use up their tolerance nearly everywhere, so that most of the flank,
    by ``usual`` [mm], deviates by a third of it at least, besides the ``rounding`` [mm] of the control. The tolerance
    that is taken where nobody asks for one is never too much.
    """
    if not stated.is_ours or stated.stock:
        return allowed(stated)
    return min(allowed(stated), max(DEFAULT_TOLERANCE, BESIDE_MOST * usual) + rounding)


def missing(stated: Stated, runs: list[CuttingRun], member: Member) -> Iterator[Fault]:
    """Spaces that the program says it cuts and does not, with any of the tools of the member; all if it says none."""
    wanted = set(stated.spaces or range(member.teeth))
    cut = {run.cut.tool: set(run.spaces) for run in runs}
    for one in Cut.of(member):
        lacking, more = sorted(wanted - cut.get(one.tool, set())), sorted(cut.get(one.tool, set()) - wanted)
        if lacking:
            yield Fault(f"space {lacking[0]} is not cut with {one.tool}, {len(lacking)} of {len(wanted)} are not")
        if more:
            yield Fault(f"space {more[0]} is cut with {one.tool}, and should not be")


def beside_the_path(runs: list[CuttingRun], member: Member, machine: MillingMachine, stated: Stated) -> Iterator[Fault]:
    """Feed blocks that end where the settings have no position: X Y A B beside their path, or Z below it, or above.

    What blocks of POLY do between their ends, the flanks tell.

    Above it only where it rolls, between the first and the last block of a pass, by its median: a stock raises all of
    it.
    """
    limit = beside_limit(machine, stated)
    for run in runs:
        rows, off = off_the_path(run, member, machine)
        number = np.cumsum(~run.cutting)[rows]
        rolls = np.append(False, np.diff(run.axes[:, :2], axis=0).any(axis=1)) & run.cutting
        inner = rolls[rows] & np.append(run.cutting[1:], False)[rows] & run.cutting[rows - 1]
        middle = np.full(len(rows), np.nan)
        if member.generation == "generated":
            middle[inner] = _medians(off[inner, 2], number[inner])
        aside = distances_aside(off, middle)
        for k in np.flatnonzero((aside > limit) & run.at_ends[rows]):
            yield Fault(f"ends {aside[k]:.6f} mm beside the path of these settings", int(run.line[rows[k]]), "beside")


def beside_limit(machine: MillingMachine, stated: Stated) -> float:
    """How far [mm] the end of a block may lie beside the path: the rounding of the control makes some of it."""
    half = machine.control.half_increments
    rounding = math.sqrt(3) * half[0] + (2 * FROM_AXIS + FROM_CUTTER) * half[3]
    # rounded X and Y are off, and so is the cradle rotation found from them, by which A is compared
    return max(allowed(stated), 3.0 * rounding)


def distances_aside(off: np.ndarray, middle: np.ndarray) -> np.ndarray:
    """How far (n,) positions count as beside their path that are ``off`` (n,5) it, as :func:`off_the_path` has them.

    ``middle`` (n,) is the median height of a pass above its path where the positions must keep to it, and else NaN.
    """
    aside = np.abs(off * np.array([1.0, 1.0, 0.0, 1.0, 1.0])).sum(axis=1)
    below = np.maximum(-off[:, 2], 0.0)
    return np.maximum(np.hypot(aside, below), np.nan_to_num(np.abs(off[:, 2] - middle)))


def _medians(values: np.ndarray, group: np.ndarray) -> np.ndarray:
    """The median (n,) of the values in the group of each, groups ascending."""
    _, of_group, count = np.unique(group, return_inverse=True, return_counts=True)
    ordered, begin = values[np.lexsort((values, of_group))], np.cumsum(count) - count
    median: np.ndarray = (ordered[begin + (count - 1) // 2] + ordered[begin + count // 2]) / 2
    return median[of_group]


def no_dry_run(runs: list[CuttingRun], member: Member, machine: MillingMachine, stated: Stated) -> Iterator[Fault]:
    """Feed blocks of what the program says is a dry run, nearer to the cut than it says."""
    for run in runs if stated.raised else ():
        rows, off = off_the_path(run, member, machine)
        for k in np.flatnonzero(off[:, 2] < stated.raised - _FAR_ABOVE):
            yield Fault(
                f"is {off[k, 2]:.3f} mm above the path of these settings, the program states a dry run "
                f"{stated.raised:g} mm above it",
                int(run.line[rows[k]]),
                "dry run",
            )


def off_the_path(run: CuttingRun, member: Member, machine: MillingMachine) -> tuple[np.ndarray, np.ndarray]:
    """Rows (m,) of a run that cut, and how far X Y Z A B are off the path (m,5), rotations in mm at the flank.

    The cradle rotation is that whose X and Y are nearest. In face hobbing A belongs to C besides, and goes on with it
    through a pass.
    """
    spec = member.flank(run.cut.flanks[0])
    reach = float(member.blank.mean_cone_distance + member.blank.face_width / 2)
    rows = np.flatnonzero(run.cutting & ((run.space >= 0) | (run.blades is not None)))
    axes = run.axes[rows].copy()
    if run.blades is None:
        axes[:, 3] -= tooth_angles(member.teeth, member.rad("index_correction"))[run.space[rows]]
    theta = np.zeros(len(rows))
    if member.generation == "generated":
        theta, _ = roll_position()(spec.vector, axes[:, 0], axes[:, 1], machine.pivot, motion_of(spec))
    off = axes - axis_positions(spec, theta, machine.pivot_height, machine.pivot)
    period = 2 * math.pi
    if run.blades is not None:
        off[:, 3] += index_ratio(member) * (run.turned[rows] - spindle_phase(spec, theta))
        period /= member.teeth
    if run.blades is not None:  # every pass begins at any tooth, and keeps to its teeth from there
        _, first, of_pass = np.unique(np.cumsum(~run.cutting)[rows], return_index=True, return_inverse=True)
        off[:, 3] -= period * np.round(off[first, 3] / period)[of_pass]
    else:
        off[:, 3] -= period * np.round(off[:, 3] / period)
    off[:, 3:] *= reach
    return rows, off


@dataclass(frozen=True)
class MetalLeft:
    """What is left of the flanks, watched on lines or not; and how far they may deviate [mm]."""

    watch: Watch | None
    tolerance: float
    faults: tuple[Fault, ...]


def metal_left(
    runs: list[CuttingRun],
    member: Member,
    machine: MillingMachine,
    stated: Stated,
    space: ToothSpace,
    progress: Callable[[int], object] = lambda _: None,
) -> MetalLeft:
    """Stock and gouges that a face milling program leaves on flanks, fillets and root, the work of its settings.

    Spaces that are cut alike are exposed once. ``runs`` are those of a machine without errors, with sharp blades;
    ``member`` is :func:`as_cut`, ``space`` the space that it has. ``progress`` is called for every space exposed.
    """
    groups = alike(runs, member, machine)
    stock = stated.stock
    flattest = min(member.flank(flank).alpha for run in runs for flank in run.cut.flanks)
    # the cutter is withdrawn by this along its axis, and leaves as much at the foot of the flanks
    most = stock / math.sin(flattest)
    found = watch(runs, member, machine, None, progress, groups, most)
    tolerance = justified(stated, found.usual, control_share(member, machine).rounding)
    faults = []
    source = says(stated, tolerance)
    for value, (number, flank, line), wrong in (
        (found.lowest, found.lowest_at, found.lowest < stock - tolerance),
        (found.highest, found.highest_at, found.highest > most + tolerance),
    ):
        if wrong:
            faults.append(
                Fault(
                    f"of the program (space {number}, {flank} flank) leaves {value * 1000:+.3f} um, {source} "
                    + (f"{stock * 1000:g} um of stock within " if stock else "")
                    + f"{tolerance * 1000:g} um",
                    line,
                    "leaves",
                )
            )
    if found.uncut:
        faults.append(Fault(f"{found.uncut} of {found.lines} normals on the flanks are not cut at all"))
    states = surface_states(
        None,
        member,
        machine,
        None,
        _exposed(groups, member),
        tolerance + REPORTED,
        DEFAULT_COLUMNS,
        runs,
        progress,
        space,
    )
    deepest = min(states, key=lambda state: state.lowest)
    least, greatest = stock - tolerance - REPORTED, tolerance + REPORTED
    if deepest.lowest < least:
        what = f"gouges the {deepest.surface} of space {deepest.space}: {deepest.lowest * 1000:+.3f} um, "
        faults.append(Fault(f"{what}the limit is {least * 1000:+g} um", deepest.line, "gouge"))
    fullest = max(states, key=lambda state: state.highest)
    if stock == 0.0 and fullest.highest > greatest:
        faults.append(
            Fault(
                f"the {fullest.surface} of space {fullest.space} keeps {fullest.highest * 1000:+.3f} um, "
                f"the limit is {greatest * 1000:+g} um"
            )
        )
    uncut = sum(state.unmet for state in states)
    if uncut and not found.uncut:
        faults.append(Fault(f"leaves {counted(uncut, 'point')} of fillets and roots uncut"))
    return MetalLeft(found, tolerance, tuple(faults))


def _exposed(groups: dict[int, list[int]], member: Member) -> list[int]:
    """Spaces to look at: one of each kind, and those beside every space that is unlike most."""
    most = max(groups.values(), key=len, default=[])
    known = {space for group in groups.values() for space in group}
    chosen = set(groups)
    for space in known - set(most):
        chosen |= {(space + off) % member.teeth for off in (-1, 0, 1)} & known
    return sorted(chosen)


def says(stated: Stated, tolerance: float) -> str:
    """Where a tolerance comes from, for a sentence that gives it next."""
    if stated.tolerance is None:
        return "no tolerance is stated, allowed are"
    if tolerance < stated.tolerance:
        return f"the program states {stated.tolerance * 1000:g} um, and its blocks are made for"
    return "the program states"


def as_cut(member: Member, space: ToothSpace | None = None) -> Member:
    """The member that its settings make, whatever it was corrected from, with the cutters that it was corrected with.

    Corrected settings change no cutter: where fixed settings state no point width, it is the one chosen for the nominal
    ``space``, as in the program and its runs. The corrected root has another slot, even beside a flank left as it was.
    """
    specs = {flank: member.flank(flank) for flank in FLANKS}
    changed: dict[str, dict[str, object]] = {flank: {"design": None} for flank in FLANKS}
    if space is not None and member.cutting == "fixed_setting" and any(spec.design for spec in specs.values()):
        for flank in FLANKS:
            changed[flank]["blade_point_width"] = point_width(member, flank, space.slots[flank])
    return member.model_copy(update={flank: specs[flank].model_copy(update=changed[flank]) for flank in FLANKS})
