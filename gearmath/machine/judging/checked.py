"""A cutting program that is run before anybody gets it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from gearmath.errors import InputError
from gearmath.machine.control.executor import MachinePath, execute
from gearmath.machine.control.state import Setup
from gearmath.machine.judging.program import written_faults
from gearmath.machine.planning.cut_plan import CuttingJob, CuttingPlan, cutting_plan
from gearmath.machine.writing.cutting import program_of
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
    progress: Callable[[int], object] = lambda passes: None,
    write: Callable[[CuttingPlan, str], str] = program_of,
) -> CheckedCut:
    """The program ``name`` of a member, for a ``file`` that sentences name; ``write`` is the writer of its dialect.

    Raises InputError where the machine cannot make it, or must not run it.
    """
    plan = cutting_plan(bevel_set, member, machine, job, progress)
    text = write(plan, name)
    path, spec = execute(text, file, Setup.of(machine)), bevel_set.member(member)
    faults = written_faults(text, path, spec, member, machine)
    if faults:
        raise InputError(f"{file}: {'; '.join(map(str, faults))}: the program is not written")
    return CheckedCut(plan, text, path)
