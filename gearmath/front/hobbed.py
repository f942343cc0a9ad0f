"""What the electronic gearbox would cut: a gear with its inspection, or a thread."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from gearmath.arguments.call import checked_call
from gearmath.front.progress import Begin, silent
from gearmath.gearbox.hobbed.contributions import Contribution
from gearmath.gearbox.hobbed.setup import CutSetup, VirtualGear
from gearmath.gearbox.hobbed.thread import ThreadTrace
from gearmath.gearbox.hobbed.values import cut_values
from gearmath.gearbox.job import ThreadPlan
from gearmath.shown import Shown, Shows

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True, repr=False)
class HobbedThread(Shown):
    """The thread that the gearbox would cut: ``traces`` have where the carriage is too far [mm], one of each rule."""

    plan: ThreadPlan
    traces: tuple[ThreadTrace, ...]

    def to_dict(self) -> dict[str, Any]:
        """As ``gearmath gearbox cut --json`` prints it: dimensions in mm, deviations in um."""
        return {
            "machine": self.plan.machine,
            "pitch": float(self.plan.pitch),
            "lead": float(self.plan.lead),
            "length": float(self.traces[0].place[-1]),
            "rpm": self.plan.rpm,
            "threads": [
                {
                    "rule": trace.rule,
                    "single_lead_um": trace.single_lead * 1000,
                    "total_um": trace.total * 1000,
                    "drift_um": trace.drift * 1000,
                }
                for trace in self.traces
            ],
        }

    def plot(self) -> Figure:
        """The deviation along the thread."""
        from gearmath.plot.hobbed import thread_figure

        return thread_figure(self.plan.machine, list(self.traces))

    def _shown(self) -> tuple[str, list[Shows]]:
        figures: list[Shows] = []
        for trace in self.traces:
            figures.append((f"{trace.rule}: total", 1000 * trace.total, "um"))
            figures += [(f"{trace.rule}: single lead", 1000 * trace.single_lead, "um")]
            figures += [(f"{trace.rule}: drift", 1000 * trace.drift, "um")]
        return f"thread of {float(self.plan.pitch):g} mm on the {self.plan.machine}", figures


@dataclass(frozen=True, repr=False)
class HobbedGear(Shown):
    """The gear that the gearbox would cut: ``gears`` have its inspection and classes, one of each rule; ``shares`` says
    which part of the machine is to blame.
    """

    setup: CutSetup
    gears: tuple[VirtualGear, ...]
    shares: tuple[Contribution, ...]

    @property
    def gear(self) -> VirtualGear:
        """As the first rule cuts it."""
        return self.gears[0]

    @property
    def title(self) -> str:
        """Machine, teeth and module."""
        gear = self.setup.job.gear
        return f"{self.setup.train.machine.name}: {gear.teeth} teeth, module {gear.module:.4g} mm, virtual"

    def to_dict(self) -> dict[str, Any]:
        """As ``gearmath gearbox cut --json`` prints it: figures in um, dimensions in mm."""
        return cut_values(self.setup, self.gears, self.shares)

    @checked_call
    def to_csv(self, path: str | Path) -> Path:
        """Write the measured points of the first rule; docs/virtual_hobbing.md."""
        from gearmath.exchange.hobbed_csv import write_traces

        write_traces(Path(path), self.setup.job, self.gear.found)
        return Path(path)

    @checked_call
    def to_stl(self, path: str | Path, begin: Begin = silent) -> Path:
        """Write the gear, a closed solid with its flanks as cut, as binary STL in mm."""
        from gearmath.exchange.hobbed_stl import ALL, write_gear
        from gearmath.gearbox.hobbed.envelope import Envelope

        setup = self.setup
        progress = begin(ALL * setup.job.gear.teeth, "point")
        write_gear(Path(path), Envelope(setup.job, setup.train), setup.where, progress)
        return Path(path)

    def plot(self) -> Figure:
        """The inspection chart."""
        from gearmath.plot.hobbed import inspection_figure

        return inspection_figure(self.title, [(gear.rule, gear.found) for gear in self.gears])

    def _shown(self) -> tuple[str, list[Shows]]:
        figures: list[Shows] = [(f"{gear.rule}: class", gear.accuracy_class, "") for gear in self.gears]
        for gear in self.gears:
            figures += [(f"{gear.rule}: {one.figure}", one.value_um, "um") for one in gear.classes]
        return self.title, figures
