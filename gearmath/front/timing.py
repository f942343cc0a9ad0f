"""How long a program takes on its control."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from gearmath.front.machines import Machine, load_machine, load_probe
from gearmath.machine.control.executor import MachinePath, execute
from gearmath.machine.control.state import Setup
from gearmath.machine.control.text import is_for_linuxcnc
from gearmath.machine.judging.trajectory import Trajectory, trajectory
from gearmath.machine.measuring.probe_run import probing_path, touches_artefacts, writes_touches
from gearmath.shown import Shown, Shows
from gearmath.specs.calibration import Calibration

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True, repr=False)
class ProgramTime(Shown):
    """A program as the control moves the axes; ``touches`` says where those of a probe are counted to."""

    name: str
    machine: Machine
    path: MachinePath
    trajectory: Trajectory
    touches: str | None

    def to_dict(self) -> dict[str, Any]:
        """As ``gearmath nc time --json`` prints it."""
        said = {
            "program": Path(self.name).name,
            "machine": self.machine.spec.name,
            "control": self.machine.spec.control.kind or "sinumerik",
            "touches_counted_to": self.touches,
        }
        return said | self.trajectory.as_dict()

    def plot(self) -> Figure:
        """The speed of the first pass, as asked and as the axes can."""
        from gearmath.plot.trajectory import speed_figure

        return speed_figure(self.path, self.trajectory, self.machine.spec)

    def _shown(self) -> tuple[str, list[Shows]]:
        found = self.trajectory
        figures: list[Shows] = [
            ("total", found.total_seconds, "s"),
            ("blocks", found.blocks, ""),
            ("off the path", found.path_error_um, "um"),
            ("feed", found.feed_seconds, "s"),
            ("feed as asked", found.asked_seconds, "s"),
            ("rapid motion", found.rapid_seconds, "s"),
            ("dwell", found.dwell_seconds, "s"),
            ("slow corners", found.slow_corners, f"of {found.corners}"),
        ]
        return f"{Path(self.name).name} on the {self.machine.spec.name}", figures


def timed(
    text: str,
    name: str,
    machine: Machine | None = None,
    probe: Calibration | None = None,
    path: MachinePath | None = None,
) -> ProgramTime:
    """The time of a program, of its text; ``path`` where it was run before, ``probe`` for what touches.

    A text for LinuxCNC is blended as LinuxCNC does it, whatever the machine file says. Raises InputError naming line
    and word of what the control refuses.
    """
    machine = machine or load_machine()
    if is_for_linuxcnc(text):
        control = machine.spec.control.model_copy(update={"kind": "linuxcnc"})
        machine = Machine(machine.spec.model_copy(update={"control": control}))
    probes = writes_touches(text)
    if path is None and probes:
        path = probing_path(text, name, machine.spec, probe or load_probe())
    elif path is None:
        path = execute(text, name, Setup.of(machine.spec))
    touches = None if not probes else "where they are met" if touches_artefacts(text) else "the end of their ways"
    return ProgramTime(name, machine, path, trajectory(path, machine.spec), touches)
