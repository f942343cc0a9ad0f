"""What is to be known of a program before metal is cut: gouges and stock, collisions, axis speeds and time."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import asdict, dataclass

from gearmath.bevel.tooth import SHARP_EDGE, ToothSpace, tooth_space
from gearmath.machine.bodies.profiles import obstacles
from gearmath.machine.control.executor import MachinePath
from gearmath.machine.judging.collision import Collision, collisions
from gearmath.machine.judging.timing import Timing, timing
from gearmath.machine.milling.run import runs_of
from gearmath.machine.milling.surfaces import DEFAULT_COLUMNS, DEFAULT_TOLERANCE, SurfaceState, surface_states
from gearmath.specs.bevel_set import Member
from gearmath.specs.milling_machine import MillingMachine
from gearmath.specs.simulated_machine import SimulatedMachine


@dataclass(frozen=True)
class MillingReport:
    """Everything that a program does to a member and to the machine; lengths in mm, ``tolerance`` too."""

    member: str
    tolerance: float
    surfaces: tuple[SurfaceState, ...]
    collisions: tuple[Collision, ...]
    timing: Timing

    @property
    def gouges(self) -> tuple[SurfaceState, ...]:
        """Surfaces that are cut deeper than the tolerance allows."""
        return tuple(state for state in self.surfaces if state.gouged)

    @property
    def uncut(self) -> tuple[SurfaceState, ...]:
        """Surfaces on which more than the tolerance is left."""
        return tuple(state for state in self.surfaces if state.uncut)

    def as_dict(self) -> dict[str, object]:
        """For JSON."""
        return asdict(self)


def milling_report(
    path: MachinePath,
    member: Member,
    name: str,
    machine: MillingMachine,
    errors: SimulatedMachine | None = None,
    tolerance: float = DEFAULT_TOLERANCE,
    columns: int = DEFAULT_COLUMNS,
    progress: Callable[[int], object] = lambda _: None,
    space: ToothSpace | None = None,
) -> MillingReport:
    """The report of a whole program. ``progress`` is called for every surface of every space, five to a space;
    ``space`` is the nominal space where it is known. Raises InputError if a tool is not of this member.
    """
    space = space or tooth_space(member, name, columns)
    runs = runs_of(path, member, name, machine, errors, space, SHARP_EDGE)
    states = surface_states(path, member, name, machine, errors, None, tolerance, columns, runs, progress, space)
    met = collisions(path, runs, member, machine, *obstacles(machine, errors))
    return MillingReport(name, tolerance, tuple(states), tuple(met), timing(path, machine))
