"""Whether a machine may run a program, and whether the part is right: all that is checked by default, in one place.

:mod:`gearmath.machine.judging.motion` is what an inspector of machines looks for, :mod:`gearmath.machine.judging.cut`
what an inspector of parts does; :mod:`gearmath.machine.judging.collision` what must not meet. All of it is over the
whole path of a block, and not at its end alone.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from gearmath.bevel.tooth import SHARP_EDGE, ToothSpace, tooth_space
from gearmath.machine.bodies.profiles import obstacles
from gearmath.machine.control.executor import MachinePath, parsed
from gearmath.machine.control.state import Setup
from gearmath.machine.control.text import is_for_linuxcnc
from gearmath.machine.judging.chosen import chosen_faults, reads_choice
from gearmath.machine.judging.collision import (
    RAPID_CLEARANCE,
    collisions,
    left_in_the_work,
    rapid_approaches,
    standing_retracts,
)
from gearmath.machine.judging.cut import (
    MetalLeft,
    as_cut,
    beside_the_path,
    metal_left,
    missing,
    no_dry_run,
)
from gearmath.machine.judging.faults import Fault, first_of_each
from gearmath.machine.judging.header import header_faults
from gearmath.machine.judging.hobbed_flanks import hobbed, left_at_borders
from gearmath.machine.judging.motion import motion_faults
from gearmath.machine.judging.outside import outside_faults
from gearmath.machine.judging.plunge import plunge_ends
from gearmath.machine.judging.start_state import start_faults
from gearmath.machine.judging.stated import Stated
from gearmath.machine.judging.unrun import skipped_faults, unrun_faults
from gearmath.machine.milling.mill import mill_member
from gearmath.machine.milling.run import CuttingRun, runs_of
from gearmath.machine.planning.clear_space import clear_height, room_of
from gearmath.machine.planning.rounding import control_share
from gearmath.specs.bevel_set import Member
from gearmath.specs.flank_csv import FlankFile
from gearmath.specs.milling_machine import MillingMachine

__all__ = ["Fault", "faults_of", "metal_faults", "written_faults"]

#: What sentences about a run call the text.
_NAME = "the program"


def faults_of(
    text: str, path: MachinePath, runs: list[CuttingRun], member: Member, machine: MillingMachine
) -> list[Fault]:
    """What a machine without errors must not do of a program, the first of each kind."""
    stated = Stated.of(text)
    found = [
        *motion_faults(path, runs, member, machine, stated),
        *missing(stated, runs, member),
        *beside_the_path(runs, member, machine, stated),
        *no_dry_run(runs, member, machine, stated),
        *plunge_ends(path, runs, member, stated),
        *unrun_faults(text, _NAME, path),
        *skipped_faults(text, _NAME),
    ]
    asked = [*header_faults(text, member, machine)]
    if not is_for_linuxcnc(text):
        asked = [*outside_faults(parsed(text, _NAME)), *asked]
    if reads_choice(text):
        asked += chosen_faults(text, _NAME, path, Setup.of(machine))
    clear = clear_height(room_of(member, machine, machine.fixture), machine, machine.tool_length)
    started = start_faults(text, machine, clear=clear) if stated.is_ours else ()
    return [*first_of_each([*found, *asked]), *started, *met(path, runs, member, machine)]


def metal_faults(
    text: str,
    path: MachinePath,
    runs: list[CuttingRun],
    member: Member,
    machine: MillingMachine,
    space: ToothSpace | None,
    progress: Callable[[int], object] = lambda _: None,
    milled: FlankFile | None = None,
) -> MetalLeft:
    """What a program leaves of the metal that the settings of ``member`` would not, on a machine without errors.

    Stock and gouges, of the flank that is cut and of its opposite, which the same cutter passes. ``runs`` have sharp
    blades; ``space`` is that of the member, None in face hobbing, of which only the flanks are compared and nothing
    else is watched: they are not milled again where ``milled`` holds what such a machine leaves of them. ``progress``
    is called for every space or flank.
    """
    stated, made = Stated.of(text), as_cut(member, space)
    if space is None:
        known = milled if made == member else None
        left = mill_member(path, made, machine, None, progress, runs) if known is None else known
        borders = np.zeros(0) if stated.stock else left_at_borders(runs, made, machine)
        return hobbed(left.deviation, borders, stated, control_share(made, machine).rounding)
    own = space if made == member else tooth_space(made, 7)
    return metal_left(runs, made, machine, stated, own, progress)


def written_faults(
    text: str,
    path: MachinePath,
    member: Member,
    machine: MillingMachine,
    progress: Callable[[int], object] = lambda _: None,
) -> list[Fault]:
    """What a cutting program must not be written for: all of both above; of a dry run, which cuts air, no metal.

    ``progress`` is called for every space or flank. Raises InputError where the text cuts with a tool that is not of
    the member.
    """
    space = None if member.process == "face_hobbing" else tooth_space(member, 7)
    runs = runs_of(path, member, machine, None, space, SHARP_EDGE)
    found = faults_of(text, path, runs, member, machine)
    if Stated.of(text).coolant:
        found += metal_faults(text, path, runs, member, machine, space, progress).faults
    return found


def met(path: MachinePath, runs: list[CuttingRun], member: Member, machine: MillingMachine) -> list[Fault]:
    """What of the cutter meets what of the work, and rapid motion in the work or near it."""
    found = [
        Fault(f"takes the {one.cutter} {one.depth:.2f} mm into the {one.work}", one.lines[0])
        for one in collisions(path, runs, member, machine, *obstacles(machine))
    ]
    found += [
        Fault(
            f"moves in rapid {one.depth:.2f} mm into the work or nearer to it than {RAPID_CLEARANCE:g} mm",
            one.lines[0],
            "rapid",
        )
        for one in rapid_approaches(runs, member, machine)
    ]
    found += [
        Fault("draws the cutter out of the cut with the spindle not turning as it cuts", one.lines[0], "drawn")
        for one in standing_retracts(path, runs, member, machine)
    ]
    found += [
        Fault(f"is the last motion of its tool and leaves it {one.depth:.2f} mm in the work", one.lines[0], "left")
        for one in left_in_the_work(runs, member, machine)
    ]
    return first_of_each(found)
