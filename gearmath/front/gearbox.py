"""The electronic gearbox: plan a job, run its compiled rule."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import asdict, dataclass
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast, get_args

from gearmath.errors import InputError
from gearmath.front.machines import load_hobber
from gearmath.front.tables import html_table
from gearmath.gearbox.helix import Cut, Helix
from gearmath.gearbox.hobbed.choice import Choice
from gearmath.gearbox.hobbed.choice import choose as search
from gearmath.gearbox.hobbed.contributions import Contribution
from gearmath.gearbox.hobbed.setup import CutSetup, VirtualGear, blame, cut_and_inspect, setup
from gearmath.gearbox.job import ThreadPlan, plan_thread
from gearmath.gearbox.simulation import Pattern, Simulation, Trace, simulate_job
from gearmath.gearbox.train import GearboxPlan
from gearmath.gearbox.train import plan as plan_gear
from gearmath.specs.hobbing import Hand, HobbingMachine
from gearmath.specs.ratio import pitch as exact_pitch

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True)
class Job:
    """A job of the electronic gearbox; ``plan`` has exact ratio, rates against limits, what to set and measure."""

    plan: GearboxPlan | ThreadPlan

    @property
    def steps_per_count(self) -> Fraction:
        """Motor steps for each count of the encoder, exactly."""
        return self.plan.exact_pulse_ratio

    def simulate(self, pattern: Pattern = "forward", edges: int = 1_000_000, seed: int = 0) -> Simulation:
        """Run the compiled step rule over so many encoder edges: "forward", "dither" or "reversals"; errors in steps.

        Raises ComputationError where there is no C compiler.
        """
        from gearmath.export.host import run_axes

        return simulate_job(run_axes, self.plan.ratio, pattern, edges, seed)

    def to_dict(self) -> dict[str, Any]:
        """The plan by name, exact numbers as fractions."""
        return asdict(self.plan)

    def plot(
        self,
        pattern: Pattern = "forward",
        edges: int = 1_000_000,
        start: int = 0,
        progress: Callable[[int], object] = lambda edges: None,
    ) -> Figure:
        """The error of the exact rule, and of a floating-point one, over time [steps, s], after ``start`` edges."""
        from matplotlib.figure import Figure

        from gearmath.export.host import run_axes
        from gearmath.plot import draw_gearbox_error

        trace = Trace(edges)
        simulate_job(run_axes, self.plan.ratio, pattern, edges, 0, progress, trace.add, start)
        figure = Figure(figsize=(8, 4), layout="constrained")
        done, exact, floating = trace.arrays
        draw_gearbox_error(figure.subplots(), done / self.plan.edge_rate_hz, exact, floating)
        return figure

    def _repr_html_(self) -> str:
        plain = {key: value for key, value in self.to_dict().items() if isinstance(value, int | float | str | Fraction)}
        return html_table(f"job on the {self.plan.machine}", ["figure", "value"], list(plain.items()))


def plan(
    machine: HobbingMachine | str | Path, teeth: int | None = None, pitch: str | None = None, **options: Any
) -> Job:
    """Plan a gear of so many ``teeth`` on a hobbing machine, or a thread of a ``pitch`` ("1.25mm", "8tpi") on a lathe.

    ``options`` of a gear: starts, hob, rpm, helix [degrees] with hand ("right" or "left"), cut ("climb" or
    "conventional") and, where the machine has no encoder on it, feed [mm per turn of the table]; shift, pin; of a
    thread: starts, hand, rpm. Raises InputError naming the limit that the job would break.

    >>> import gearmath as gm
    >>> gm.plan("hobbing_plewes.toml", teeth=17).plan.teeth
    17
    """
    known = machine if isinstance(machine, HobbingMachine) else load_hobber(machine)
    if known.profile == "lathe":
        if pitch is None or teeth is not None:
            raise InputError(f"{known.name} is a lathe: pitch is needed, and no teeth")
        try:
            wanted = exact_pitch(pitch)
        except ValueError as error:
            raise InputError(f"pitch = {pitch!r}: {error}") from None
        return Job(plan_thread(known, wanted, **options))
    if teeth is None or pitch is not None:
        raise InputError(f"{known.name} is a hobbing machine: teeth are needed, and no pitch")
    way, feed = options.pop("cut", "climb"), options.pop("feed", None)
    return Job(plan_gear(known, teeth, **_with_helix(options, way, feed)))


@dataclass(frozen=True)
class HobbedGear:
    """The gear that the gearbox would cut: ``gear`` has its inspection and classes, ``shares`` who is to blame."""

    setup: CutSetup
    gear: VirtualGear
    shares: tuple[Contribution, ...]

    def plot(self) -> Figure:
        """The inspection chart."""
        from gearmath.plot.hobbed import inspection_figure

        return inspection_figure(self.setup.train.machine.name, [(self.gear.rule, self.gear.found)])


def hob(machine: HobbingMachine | str | Path, teeth: int, **options: Any) -> HobbedGear:
    """Cut a gear virtually, inspect it, and tell which part of the machine is to blame; docs/virtual_hobbing.md.

    ``options``: hob, starts, helix [degrees], hand, shift, feed, face_width, rpm, seconds, climb, rule, as of
    ``gearmath gearbox cut``. Raises InputError naming the limit that the job would break.
    """
    known = machine if isinstance(machine, HobbingMachine) else load_hobber(machine)
    way = "climb" if options.get("climb", True) else "conventional"
    feed = None if known.feed is not None else options.get("feed", 0.5)
    prepared = setup(known, teeth, **_with_helix(options, way, feed))
    gear = cut_and_inspect(prepared, prepared.train.rule)
    return HobbedGear(prepared, gear, blame(prepared, gear))


def choose(machine: HobbingMachine | str | Path, wanted: int, module: float, teeth: int, **options: Any) -> Choice:
    """The least microsteps, encoder lines and gashes, and the coarsest feed, that reach the class ``wanted``.

    Normal ``module`` [mm]; ``options``: face_width [mm], helix [degrees], hand. Raises InputError where no class can be
    given, ComputationError where the finest parts do not reach it.
    """
    known = machine if isinstance(machine, HobbingMachine) else load_hobber(machine)
    return search(known, wanted, module, teeth, **_with_helix(options))


def _with_helix(options: dict[str, Any], cut: str = "climb", feed: float | None = None) -> dict[str, Any]:
    """The options with one helix of its angle [degrees] and hand. Raises InputError where it is none."""
    helix, hand = options.get("helix"), options.get("hand")
    if helix is None:
        if hand is not None:
            raise InputError(f"hand = {hand!r}: has no meaning without helix")
        return options
    hand = "right" if hand is None else hand
    if hand not in get_args(Hand):
        raise InputError(f"hand = {hand!r}: must be 'right' or 'left'")
    if cut not in get_args(Cut):
        raise InputError(f"cut = {cut!r}: must be 'climb' or 'conventional'")
    per_turn = None if feed is None else Fraction(str(feed))
    rest = {key: value for key, value in options.items() if key != "hand"}
    return rest | {"helix": Helix(float(helix), cast("Hand", hand), cast("Cut", cut), per_turn)}
