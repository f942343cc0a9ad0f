"""A cutting program that is run before anybody gets it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from gearmath.errors import InputError
from gearmath.machine.control.executor import MachinePath, execute
from gearmath.machine.control.state import Setup
from gearmath.machine.judging.dialects import SINUMERIK, ControlDialect
from gearmath.machine.judging.program import written_faults
from gearmath.machine.planning.cut_plan import CuttingJob, CuttingPlan, cutting_plan, pass_count
from gearmath.specs.bevel_set import BevelSet
from gearmath.specs.milling_machine import MillingMachine


@dataclass(frozen=True)
class CheckedCut:
    """A cutting program without faults: its plan, its text, and the path that the machine takes."""

    plan: CuttingPlan
    text: str
    path: MachinePath


def checked_cut(
    bevel_set: BevelSet,
    member: str,
    machine: MillingMachine,
    job: CuttingJob,
    name: str,
    file: str,
    begin: Callable[[int, str], Callable[[int], object]] = lambda steps, unit: lambda done: None,
    dialect: ControlDialect = SINUMERIK,
) -> CheckedCut:
    """The program ``name`` of a member, for a ``file`` that sentences name; ``dialect`` is that of its control.

    ``begin`` gets the number and the unit of steps, and gives what hears of those that are done; it is called for the
    passes, and for the spaces that are looked at after them. Raises InputError where the machine cannot make the
    program or must not run it, and where that does not leave both flanks within the tolerance.
    """
    spec = bevel_set.member(member)
    plan = cutting_plan(bevel_set, member, machine, job, begin(pass_count(spec, job), "pass"))
    text = dialect.cutting(plan, name)
    path = execute(dialect.read(text), file, Setup.of(machine))
    faults = written_faults(dialect.read(text), path, spec, machine, begin(spec.teeth, "space"))
    if faults:
        raise InputError(f"{file}: {'; '.join(map(str, faults))}: the program is not written")
    return CheckedCut(plan, text, path)
