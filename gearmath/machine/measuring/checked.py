"""A probing program that is run before anybody gets it: the probe must stay clear of everything."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from gearmath.errors import InputError
from gearmath.machine.bodies.profiles import obstacles
from gearmath.machine.judging.dialects import SINUMERIK, ControlDialect
from gearmath.machine.judging.faults import Fault
from gearmath.machine.measuring.collision_check import Approach, approaches
from gearmath.machine.measuring.judge import judge_probing
from gearmath.machine.planning.targets import teeth_around
from gearmath.machine.writing.probing import probing_program
from gearmath.specs.bevel_set import BevelSet
from gearmath.specs.calibration import Calibration
from gearmath.specs.milling_machine import MillingMachine
from gearmath.specs.simulated_machine import SimulatedMachine
from gearmath.specs.touch_csv import planned_touches

_NOT_WRITTEN = "the program is not written"


@dataclass(frozen=True)
class ProbingChoice:
    """What is probed: teeth whose whole flanks are, the reference point of every tooth, the corners on eight teeth
    around, and how often each point."""

    topography: Sequence[int] = (0,)
    pitch: bool = True
    registration: bool = True
    repeat: int = 1


@dataclass(frozen=True)
class CheckedProbing:
    """A probing program without faults: its text, its touches, and the least clearances of the probe in words."""

    text: str
    touches: int
    clearance: str


def checked_probing(
    bevel_set: BevelSet,
    member: str,
    machine: MillingMachine,
    calibration: Calibration,
    choice: ProbingChoice,
    name: str,
    file: str,
    shop: SimulatedMachine | None = None,
    begin: Callable[[int, str], Callable[[int], object]] = lambda steps, unit: lambda done: None,
    dialect: ControlDialect = SINUMERIK,
) -> CheckedProbing:
    """The program ``name`` that probes a member, for a ``file`` that sentences name and the control of its ``dialect``.

    ``begin`` gets the number and the unit of steps, and gives what hears of those that are done. Raises InputError
    for the deepest collision, and where the machine must not run the program.
    """
    spec = bevel_set.member(member)
    around = teeth_around(spec.teeth) if choice.registration else ()
    head, fixture = obstacles(machine, shop)
    asked = choice.topography, choice.pitch, choice.repeat, around
    text = probing_program(bevel_set, member, machine, calibration, name, *asked, dialect.probing)
    read = dialect.read(text)
    touches = planned_touches(read)
    progress = begin(touches // choice.repeat * (2 + choice.repeat) + read.count("\n"), "step")
    found = approaches(read, file, spec, machine, calibration, fixture, head.spindle_radius, progress)
    clear = clearances(found, file, _NOT_WRITTEN)
    refuse_faults(judge_probing(read, file, spec, machine, calibration), file, _NOT_WRITTEN)
    return CheckedProbing(text, touches, clear)


def clearances(found: Sequence[Approach], program: str, end: str) -> str:
    """The least clearance of every part of the probe in words. Raises InputError for the deepest collision."""
    worst = min(found, key=lambda one: one.distance)
    if worst.distance <= 0.0:
        raise InputError(
            f"{program}, line {worst.line}: the {worst.probe} of the probe meets the {worst.work}, "
            f"{-worst.distance:.3f} mm deep: {end}" + (f" ({worst.said})" if worst.said else "")
        )
    nearest: dict[str, Approach] = {}
    for one in sorted(found, key=lambda one: -one.distance):
        nearest[one.probe] = one
    parts = (f"{part} {nearest[part].distance:.3f} mm ({nearest[part].work})" for part in ("tip", "stylus", "spindle"))
    return f"least clearance: {', '.join(parts)}"


def refuse_faults(found: Sequence[Fault], program: str, end: str = "it is not run") -> None:
    """Raise InputError where a program has faults."""
    if found:
        raise InputError(f"{program}: {'; '.join(map(str, found))}: {end}")
