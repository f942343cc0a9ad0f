"""The electronic gearbox: plan a job, run its compiled rule, cut a gear or a thread virtually, write its firmware."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING, Any

from gearmath.arguments.call import checked_call
from gearmath.arguments.composed import Either
from gearmath.arguments.kinds import Number, Record, Text
from gearmath.arguments.known import HOBBER
from gearmath.errors import InputError
from gearmath.front.hobbed import HobbedGear, HobbedThread
from gearmath.front.machines import hobber_of, load_hobber
from gearmath.front.progress import Begin, Progress, silent, unheard
from gearmath.gearbox.hobbed.choice import MOST_CUTS, Choice
from gearmath.gearbox.hobbed.choice import choose as search
from gearmath.gearbox.hobbed.contributions import sources
from gearmath.gearbox.hobbed.drive import Rule
from gearmath.gearbox.hobbed.setup import blame, cut_and_inspect, setup
from gearmath.gearbox.hobbed.thread import cut_thread
from gearmath.gearbox.hobbed.undercut import measurable
from gearmath.gearbox.job import ThreadPlan, plan_thread
from gearmath.gearbox.simulation import Pattern, Simulation, Trace, simulate_job
from gearmath.gearbox.train import GearboxPlan
from gearmath.gearbox.train import plan as plan_gear
from gearmath.shown import Shown, Shows
from gearmath.specs.helix import FeedSense, Helix
from gearmath.specs.hobbing import Hand, HobbingMachine
from gearmath.specs.ratio import pitch_of

if TYPE_CHECKING:
    from matplotlib.figure import Figure


_PER_TURN = Number(unit="mm per turn of the table")

__all__ = ("Job", "choose", "export_teensy", "hob", "load_hobber", "plan")


def __dir__() -> list[str]:  # for completion
    return list(__all__)


@checked_call(
    machine=Record("gearmath.specs.hobbing", "HobbingMachine", "a hobbing machine or lathe"),
    plan=Either(
        (
            Record("gearmath.gearbox.train", "GearboxPlan", ""),
            Record("gearmath.gearbox.job", "ThreadPlan", ""),
        ),
        "must be the plan of a gear or of a thread",
    ),
)
@dataclass(frozen=True, repr=False)
class Job(Shown):
    """A job of the electronic gearbox; ``plan`` has exact ratio, rates against limits, what to set and measure."""

    machine: HobbingMachine
    plan: GearboxPlan | ThreadPlan

    @property
    def steps_per_count(self) -> Fraction:
        """Motor steps for each count of the encoder, exactly."""
        return Fraction(self.plan.steps_numerator, self.plan.steps_denominator)

    @checked_call
    def simulate(
        self,
        pattern: Pattern = "forward",
        edges: int = 1_000_000,
        seed: int = 0,
        start: int = 0,
        trace: Trace | None = None,
        progress: Progress = unheard,
    ) -> Simulation:
        """Run the compiled step rule over so many encoder edges, "forward", "dither" or "reversals"; errors in steps.

        Returns ``worst_error`` of the rule and ``float_worst_error`` of a floating-point one beside it [steps], and
        where encoder and motor stand at the end. It begins at the count ``start``; a ``trace`` keeps the errors on the
        way, for :meth:`plot`. Raises ComputationError where there is no C compiler.
        """
        from gearmath.export.host import run_axes

        kept = Trace(edges) if trace is None else trace
        return simulate_job(run_axes, self.plan.ratio, pattern, edges, seed, progress, kept.add, start)

    @checked_call
    def thread(
        self,
        length: float = 100.0,
        rule: Rule = "exact",
        seconds: float = 0.0,
        compare: Rule | None = None,
    ) -> HobbedThread:
        """The thread of ``length`` [mm] that a lathe would cut after ``seconds`` of running, by a rule or by two.

        Raises InputError where the job is no thread, or the thread is shorter than one lead.
        """
        if not isinstance(self.plan, ThreadPlan):
            raise InputError(f"{self.plan.machine} is a hobbing machine: it cuts no thread")
        traces = (
            cut_thread(self.machine, self.plan, length, each, seconds)
            for each in dict.fromkeys((rule, compare))
            if each
        )
        return HobbedThread(self.plan, tuple(traces))

    def to_dict(self) -> dict[str, Any]:
        """As ``gearmath gearbox plan --json`` prints it; what is a fraction also exactly, as text."""
        return plain_numbers(asdict(self.plan))

    @checked_call
    def plot(
        self,
        pattern: Pattern = "forward",
        edges: int = 1_000_000,
        start: int = 0,
        progress: Progress = unheard,
        trace: Trace | None = None,
    ) -> Figure:
        """The error of the exact rule, and of a floating-point one, over time [steps, s], after ``start`` edges.

        Of a new run, or of a ``trace`` that :meth:`simulate` has filled.
        """
        from gearmath.plot import draw_gearbox_error
        from gearmath.plot.figure import Figure

        if trace is None:
            trace = Trace(edges)
            self.simulate(pattern, edges, 0, start, trace, progress)
        figure = Figure(figsize=(8, 4), layout="constrained")
        axes, plan = figure.subplots(), self.plan
        done, exact, floating = trace.arrays
        draw_gearbox_error(axes, done / plan.edge_rate_hz, exact, floating)
        steps = f"{plan.steps_numerator}/{plan.steps_denominator} steps per count"
        axes.set_title(f"{plan.machine}: {steps}, {plan.rpm:.0f} rpm")
        return figure

    def _shown(self) -> tuple[str, list[Shows]]:
        plan = self.plan
        what = f"thread of {float(plan.pitch):g} mm" if isinstance(plan, ThreadPlan) else f"gear of {plan.teeth} teeth"
        figures: list[Shows] = [("steps per count", str(self.steps_per_count), ""), ("speed", plan.rpm, "rpm")]
        figures += [("at most", plan.highest_rpm, "rpm"), ("edges of the encoder", plan.edge_rate_hz, "Hz")]
        figures += [("steps of the motor", plan.step_rate_hz, "Hz")]
        if isinstance(plan, ThreadPlan):
            return f"{what} on the {plan.machine}", [*figures, ("way per step", plan.step_um, "um")]
        for blank in plan.blanks:
            sizes = {"blank diameter": blank.blank_diameter, "depth of cut": blank.cut_depth}
            figures += [(f"{blank.hob}: {name}", size, "mm") for name, size in sizes.items()]
            if blank.over_pins is not None:
                pin, length = blank.over_pins.pin, blank.over_pins.length
                figures += [(f"{blank.hob}: over pins of {pin:.6g} mm", length, "mm")]
        return f"{what} on the {plan.machine}", figures


def plain_numbers(values: dict[str, Any]) -> dict[str, Any]:
    """For JSON: a fraction as number, and exactly beside it."""
    exact = {f"{key}_exact": str(value) for key, value in values.items() if isinstance(value, Fraction)}
    return {key: float(value) if isinstance(value, Fraction) else value for key, value in values.items()} | exact


@checked_call(machine=HOBBER, feed=Either((_PER_TURN, Text()), _PER_TURN.words))
def plan(
    machine: HobbingMachine | str | Path,
    teeth: int | None = None,
    pitch: str | None = None,
    *,
    starts: int | None = None,
    hob: str | None = None,
    rpm: float | None = None,
    run_up: float | None = None,
    helix: float | None = None,
    hand: Hand | None = None,
    cut: FeedSense | None = None,
    feed: float | str | None = None,
    shift: float = 0.0,
    pin: float | None = None,
) -> Job:
    """Plan a gear of so many ``teeth`` on a hobbing machine, or a thread of a ``pitch`` ("1.25mm", "8tpi") on a lathe.

    Of a gear: starts, hob, rpm, run_up [s], helix [degrees] with hand ("right" or "left"), cut ("climb" or
    "conventional") and, where the machine has no encoder on it, feed [mm per turn of the table]; shift, pin; of a
    thread: starts, hand, rpm, run_up. Raises InputError naming the limit that the job would break.

    >>> import gearmath as gm
    >>> gm.hobbing.plan("hobbing_plewes.toml", teeth=17).plan.teeth
    17
    """
    known = hobber_of(machine)
    if known.profile == "lathe":
        if pitch is None or teeth is not None:
            raise InputError(f"{known.name} is a lathe: pitch is needed, and no teeth")
        _refuse_for_a_thread(hob=hob, helix=helix, cut=cut, feed=feed, shift=shift or None, pin=pin)
        first = 1 if starts is None else starts
        return Job(known, plan_thread(known, pitch_of(pitch), first, hand or "right", rpm, run_up))
    if teeth is None or pitch is not None:
        raise InputError(f"{known.name} is a hobbing machine: teeth are needed, and no pitch")
    if helix is None:
        _refuse_without_helix(hand=hand, cut=cut, feed=feed)
    lead = _helix(helix, hand, cut or "climb", feed)
    made = plan_gear(known, teeth, starts, hob, rpm, lead, shift, pin, run_up)
    return Job(known, measurable(made, known, 0.0 if lead is None else lead.beta))


@checked_call(machine=HOBBER, feed=_PER_TURN)
def hob(
    machine: HobbingMachine | str | Path,
    teeth: int,
    compare: Rule | None = None,
    begin: Begin = silent,
    *,
    hob: str | None = None,
    starts: int | None = None,
    helix: float | None = None,
    hand: Hand | None = None,
    shift: float = 0.0,
    feed: float = 0.5,
    face_width: float | None = None,
    rpm: float | None = None,
    seconds: float = 0.0,
    climb: bool = True,
    rule: Rule = "exact",
    hob_shift: float = 0.0,
) -> HobbedGear:
    """Cut a gear virtually, inspect it, and tell which part of the machine is to blame; docs/virtual_hobbing.md.

    ``compare`` is a second rule, cut beside the first. helix [degrees] has a hand; feed [mm per turn of the table],
    face_width and hob_shift [mm], as of ``gearmath gearbox cut``. Raises InputError naming the limit that the job would
    break.
    """
    known = hobber_of(machine)
    if helix is None:
        _refuse_without_helix(hand=hand)
    lead = _helix(helix, hand, "climb" if climb else "conventional", None if known.feed is not None else feed)
    prepared = setup(known, teeth, hob, starts, lead, shift, feed, face_width, rpm, seconds, climb, rule, hob_shift)
    rules: tuple[Rule, ...] = tuple(dict.fromkeys(rule for rule in (prepared.train.rule, compare) if rule))
    progress = begin((len(rules) + len(sources(prepared.train))) * prepared.where.points, "point")
    gears = tuple(cut_and_inspect(prepared, rule, progress) for rule in rules)
    return HobbedGear(prepared, gears, blame(prepared, gears[0], progress))


@checked_call(machine=HOBBER)
def choose(
    machine: HobbingMachine | str | Path,
    wanted: int,
    module: float,
    teeth: int,
    begin: Begin = silent,
    *,
    face_width: float | None = None,
    helix: float | None = None,
    hand: Hand | None = None,
) -> Choice:
    """The least microsteps, encoder lines and gashes, and the coarsest feed, that reach the class ``wanted``.

    Normal ``module`` and face_width [mm]; helix [degrees] has a hand. Returns ``parts`` with microsteps, lines, gashes
    and feed [mm per turn of the table], the ``gear`` that they cut with its figures and classes, and ``rpm``, the
    highest speed of the hob. Raises InputError where no class can be given, ComputationError where the finest parts do
    not reach it.
    """
    known = hobber_of(machine)
    if helix is None:
        _refuse_without_helix(hand=hand)
    lead = _helix(helix, hand, "climb", None)
    return search(known, wanted, module, teeth, face_width, lead, progress=begin(MOST_CUTS, "cut"))


@checked_call(machine=HOBBER)
def export_teensy(machine: HobbingMachine | str | Path, folder: str | Path) -> list[str]:
    """Write the whole Teensy sketch of a hobbing machine or lathe; the names of its files. Raises InputError."""
    from gearmath.export.teensy import export_teensy as export

    return list(export(hobber_of(machine), Path(folder)))


def _refuse_for_a_thread(**given: object) -> None:
    """Raise InputError for an argument that would change nothing."""
    for name, value in given.items():
        if value is not None:
            raise InputError(f"{name} = {value!r}: has no meaning for a thread")


def _refuse_without_helix(**given: object) -> None:
    for name, value in given.items():
        if value is not None:
            raise InputError(f"{name} = {value!r}: has no meaning without helix")


def _helix(angle: float | None, hand: Hand | None, cut: FeedSense, feed: float | str | None) -> Helix | None:
    """The helix of an angle [degrees], none without it. Raises InputError where it is none."""
    if angle is None:
        return None
    try:
        per_turn = None if feed is None else Fraction(str(feed))
    except (ValueError, ZeroDivisionError):
        raise InputError(f"feed = {feed!r}: must be a number of mm per turn of the table") from None
    return Helix(float(angle), hand or "right", cut, per_turn)
