"""Whether a machine may run a program, and whether the part is right: all that is checked by default, in one place.

:mod:`gearmath.machine.judging.motion` is what an inspector of machines looks for, :mod:`gearmath.machine.judging.cut`
what an inspector of parts does; :mod:`gearmath.machine.judging.collision` what must not meet. All of it is over the
whole path of a block, and not at its end alone.
"""

from __future__ import annotations

from gearmath.machine.bodies.profiles import obstacles
from gearmath.machine.control.executor import MachinePath, parsed
from gearmath.machine.control.state import Setup
from gearmath.machine.judging.chosen import chosen_faults, reads_choice
from gearmath.machine.judging.collision import RAPID_CLEARANCE, collisions, rapid_approaches
from gearmath.machine.judging.cut import beside_the_path, missing
from gearmath.machine.judging.faults import Fault, first_of_each
from gearmath.machine.judging.header import header_faults
from gearmath.machine.judging.motion import motion_faults
from gearmath.machine.judging.outside import outside_faults
from gearmath.machine.judging.start_state import start_faults
from gearmath.machine.judging.stated import Stated
from gearmath.machine.milling.run import CuttingRun
from gearmath.specs.bevel_set import Member
from gearmath.specs.milling_machine import MillingMachine

__all__ = ["Fault", "faults_of"]

#: What sentences about a run call the text.
_NAME = "the program"


def faults_of(
    text: str, path: MachinePath, runs: list[CuttingRun], member: Member, name: str, machine: MillingMachine
) -> list[Fault]:
    """What a machine without errors must not do of a program, the first of each kind."""
    stated = Stated.of(text)
    found = [
        *motion_faults(path, runs, member, machine, stated),
        *missing(stated, runs, member, name),
        *beside_the_path(runs, member, machine, stated),
    ]
    asked = [*outside_faults(parsed(text, _NAME)), *header_faults(text, member, name, machine)]
    if reads_choice(text):
        asked += chosen_faults(text, _NAME, path, Setup.of(machine))
    started = start_faults(text, machine) if stated.is_ours else ()
    return [*first_of_each([*found, *asked]), *started, *met(path, runs, member, machine)]


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
    return first_of_each(found)
