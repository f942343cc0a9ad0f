"""What the server holds. Pages read it and ask for changes; none of them owns anything."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING

from gearmath.hmi.alarm_book import AlarmBook
from gearmath.hmi.desk import Desk
from gearmath.hmi.gear_settings import Place
from gearmath.hmi.judged_runs import JudgedRuns
from gearmath.hmi.tickets import Tickets
from gearmath.hmi.work import Work

if TYPE_CHECKING:
    from gearmath.hmi.link import ControlLink
    from gearmath.hmi.measuring_task import MeasuringTask
    from gearmath.hmi.simulated import SimulatedMachine


@dataclass(frozen=True)
class Choice:
    """Set, member, machine and probe that the operator works with; files, or names of bundled ones."""

    gear_set: str = "nasa_tp3096_12x36.toml"
    member: str = "pinion"
    machine: str = "vertical_5axis.toml"
    calibration: str = "probe.toml"


#: What the store keeps of a run in which the server was ended.
SERVER_ENDED = "the server was ended in mid-run"


@dataclass
class Shared:
    """The state of the server. ``store`` is the measurement store; sets and programs lie in its folder."""

    store: Path
    choice: Choice = field(default_factory=Choice)
    works: dict[str, Work] = field(default_factory=lambda: defaultdict(Work))
    """Long computations by name, such as ``programs.cut``."""
    tickets: Tickets = field(default_factory=Tickets)
    book: AlarmBook = field(default_factory=AlarmBook)
    link: ControlLink | None = None
    """The control; None where the page works without one."""
    measuring: MeasuringTask | None = None
    """The measuring run, where there is a control."""
    simulated: SimulatedMachine | None = None
    """The operator's side of the simulated control, where it is that."""
    keep: Callable[[Choice], object] = lambda choice: None
    """Hears of every choice that was changed."""
    unsaved: dict[tuple[str, str], dict[Place, float]] = field(default_factory=dict)
    """What was typed and not saved for the members that are not chosen, by set and member."""
    desk: Desk = field(init=False)
    """What the pages of the gear side look at together."""

    def __post_init__(self) -> None:
        self.desk = Desk(JudgedRuns(self.store))

    @property
    def folder(self) -> Path:
        """Where sets and programs are written."""
        return self.store.absolute().parent

    def choose(self, **changes: str) -> None:
        """Change the choice: ``gear_set``, ``member``, ``machine``, ``calibration``.

        What was typed for a member is not lost with it: it is there again when that one is chosen again.
        """
        before, self.choice = self.choice, replace(self.choice, **changes)
        old, new = ((one.gear_set, one.member) for one in (before, self.choice))
        if old != new:
            self.unsaved[old] = self.desk.typed
            self.desk.typed = self.unsaved.pop(new, {})
        if self.choice != before:
            self.keep(self.choice)

    def close(self) -> None:
        """End the run, which may be resumed, and give the sessions back."""
        if self.measuring is not None:
            self.measuring.stop(SERVER_ENDED)
        if self.link is not None:
            if self.simulated is not None:
                self.link.submit(self.simulated.close())
            self.link.close()
