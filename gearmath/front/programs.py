"""NC programs of a member: written, run on the machine model, and what they leave of the metal."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from gearmath.files import write_text
from gearmath.front.machines import Machine, load_machine
from gearmath.front.measured import Measurement
from gearmath.front.sets import Member
from gearmath.machine.control.executor import execute
from gearmath.machine.control.state import Setup
from gearmath.machine.control.text import readable
from gearmath.machine.judging.checked import checked_cut
from gearmath.machine.judging.dialects import named
from gearmath.machine.milling.mill import mill_member
from gearmath.machine.planning.cut_plan import CuttingJob
from gearmath.specs.simulated_machine import SimulatedMachine

if TYPE_CHECKING:
    from gearmath.machine.control.executor import MachinePath
    from gearmath.machine.judging.trajectory import Trajectory


@dataclass(frozen=True)
class Program:
    """The text of a program for a member on a machine, and its name on the control."""

    member: Member
    machine: Machine
    name: str
    text: str

    @property
    def blocks(self) -> int:
        """How many blocks the control runs."""
        from gearmath.machine.judging.dialects import of_text

        return of_text(self.text).block_count(self.text)

    def save(self, path: str | Path) -> Path:
        """Write the program, in one step; its file should be called ``name``.MPF, or .ngc for LinuxCNC."""
        write_text(Path(path), self.text)
        return Path(path)

    def mill(
        self, shop: SimulatedMachine | None = None, progress: Callable[[int], object] = lambda _: None
    ) -> Measurement:
        """The deviations [mm] that the program leaves: both flanks of tooth 0, the reference point of all others.

        ``shop`` makes the machine one with errors. Raises InputError where a flank is left uncut.
        """
        file = mill_member(self._path(), self.member.spec, self.member.name, self.machine.spec, shop, progress)
        return Measurement(self.member, file)

    def faults(self) -> list[str]:
        """What the machine must not run: travel, speed, collisions, modes, metal that is left or gouged; empty where it
        may.
        """
        from gearmath.machine.judging.program import written_faults

        member = self.member
        found = written_faults(readable(self.text), self._path(), member.spec, member.name, self.machine.spec)
        return [str(fault) for fault in found]

    def time(self) -> Trajectory:
        """How long the control takes [s], where it is slow, and how far it leaves the path; as ``gearmath nc time``."""
        from gearmath.machine.judging.trajectory import trajectory

        return trajectory(self._path(), self.machine.spec)

    def _path(self) -> MachinePath:
        return execute(readable(self.text), self.name, Setup.of(self.machine.spec))


def cutting(
    member: Member, machine: Machine | None = None, name: str = "GEAR", spaces: Sequence[int] | None = None, **job: Any
) -> Program:
    """The cutting program of a member, run before it is returned. Raises InputError naming what is wrong."""
    machine = load_machine() if machine is None else machine
    dialect = named(machine.spec.control.dialect(None))
    wanted = list(range(member.teeth) if spaces is None else spaces)
    made = checked_cut(
        member.gear_set.spec, member.name, machine.spec, CuttingJob(wanted, **job), name, name, dialect=dialect
    )
    return Program(member, machine, name, made.text)
