"""What is to be known of a program before metal is cut: gouges and stock, collisions, axis speeds and time."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import asdict, dataclass

from gearmath.bevel.tooth import SHARP_EDGE, ToothSpace, tooth_space
from gearmath.machine.bodies.profiles import obstacles
from gearmath.machine.control.executor import MachinePath
from gearmath.machine.judging.collision import Collision, collisions
from gearmath.machine.judging.cut import as_cut
from gearmath.machine.judging.timing import Timing, timing
from gearmath.machine.milling.run import runs_of
from gearmath.machine.milling.surfaces import DEFAULT_COLUMNS, DEFAULT_TOLERANCE, SurfaceState, surface_states
from gearmath.shown import Shown, Shows
from gearmath.specs.bevel_set import Member
from gearmath.specs.milling_machine import MillingMachine
from gearmath.specs.simulated_machine import SimulatedMachine


@dataclass(frozen=True, repr=False)
class MillingReport(Shown):
    """Everything that a program does to a member and to the machine; lengths in mm.

    On flanks ``flank_tolerance`` is the limit, on fillets and roots ``tolerance``.
    ``surfaces`` are compared with the design. Where the settings were corrected and the machine has no errors,
    ``surfaces_of_settings`` are compared with what these settings cut, and judged; else there are none.
    """

    member: str
    tolerance: float
    flank_tolerance: float
    surfaces: tuple[SurfaceState, ...]
    surfaces_of_settings: tuple[SurfaceState, ...]
    collisions: tuple[Collision, ...]
    timing: Timing

    @property
    def judged(self) -> tuple[SurfaceState, ...]:
        """The surfaces as the program should leave them."""
        return self.surfaces_of_settings or self.surfaces

    @property
    def gouges(self) -> tuple[SurfaceState, ...]:
        """Surfaces that are cut deeper than the tolerance allows."""
        return tuple(state for state in self.judged if state.gouged)

    @property
    def uncut(self) -> tuple[SurfaceState, ...]:
        """Surfaces on which more than the tolerance is left."""
        return tuple(state for state in self.judged if state.uncut)

    def as_dict(self) -> dict[str, object]:
        """For JSON."""
        return asdict(self)

    def _shown(self) -> tuple[str, list[Shows]]:
        figures: list[Shows] = [
            ("surfaces gouged", len(self.gouges), f"of {len(self.judged)}"),
            ("with metal left", len(self.uncut), f"of {len(self.judged)}"),
            ("collisions", len(self.collisions), ""),
            ("feed", self.timing.feed_seconds, "s"),
            ("rapid motion", self.timing.rapid_seconds, "s"),
            ("tolerance", 1000 * self.tolerance, "um"),
            ("tolerance of flanks", 1000 * self.flank_tolerance, "um"),
        ]
        return f"what a program does to the {self.member}", figures


def milling_report(
    path: MachinePath,
    member: Member,
    machine: MillingMachine,
    errors: SimulatedMachine | None = None,
    tolerance: float = DEFAULT_TOLERANCE,
    columns: int = DEFAULT_COLUMNS,
    progress: Callable[[int], object] = lambda _: None,
    space: ToothSpace | None = None,
    flank_tolerance: float | None = None,
) -> MillingReport:
    """The report of a whole program; flanks have the ``tolerance`` [mm] of the other surfaces where they have none of
    their own. ``progress`` is called for every surface of every space, five to a space, and
    twice for corrected settings; ``space`` is the nominal space where it is known. Raises InputError if a tool is not
    of this member.
    """
    space = space or tooth_space(member, columns)
    runs = runs_of(path, member, machine, errors, space, SHARP_EDGE)
    on_flanks = tolerance if flank_tolerance is None else flank_tolerance
    judged = (None, tolerance, columns, runs, progress)
    states = surface_states(path, member, machine, errors, *judged, space, on_flanks)
    made, own = as_cut(member, space), []
    if made != member and errors is None:
        other = tooth_space(made, columns)
        own = surface_states(path, made, machine, None, *judged, other, on_flanks)
    met = collisions(path, runs, member, machine, *obstacles(machine, errors))
    return MillingReport(
        member.name, tolerance, on_flanks, tuple(states), tuple(own), tuple(met), timing(path, machine)
    )


def largest(states: tuple[SurfaceState, ...], surface: str) -> float:
    """The largest deviation [mm] on surfaces whose name has this word; 0 where nothing is cut."""
    found = [max(-one.lowest, one.highest) for one in states if surface in one.surface]
    return max((value for value in found if math.isfinite(value)), default=0.0)
