"""From a machine file and a job's options to what is cut: hob, gear, drive train, and their inspection."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

from gearmath.errors import InputError
from gearmath.gearbox.dimensions import Gear
from gearmath.gearbox.helix import SIGNS, Helix
from gearmath.gearbox.hobbed.classes import FigureClass, classes, overall
from gearmath.gearbox.hobbed.contributions import Contribution, contributions
from gearmath.gearbox.hobbed.drive import DriveTrain, Rule
from gearmath.gearbox.hobbed.envelope import Envelope
from gearmath.gearbox.hobbed.inspection import Inspection, Layout, inspect, layout
from gearmath.gearbox.hobbed.job import HobbingJob, HobTool
from gearmath.gearbox.kernels import evaluate
from gearmath.gearbox.train import plan
from gearmath.shown import Shown, Shows
from gearmath.specs.hobbing import Hob, HobbingMachine

#: Face width where none is given, in modules.
FACE_WIDTH = 10.0
LEAST_FEED, MOST_FEED = 0.01, 10.0
MOST_SHIFT = 500.0  # of the hob along its axis [mm]
LONGEST_SECONDS = 86_400.0


@dataclass(frozen=True, repr=False)
class VirtualGear(Shown):
    """A gear cut by one rule, inspected."""

    rule: Rule
    found: Inspection
    classes: tuple[FigureClass, ...]

    @property
    def accuracy_class(self) -> int | None:
        """The coarsest class of all figures."""
        return overall(self.classes)

    def _shown(self) -> tuple[str, list[Shows]]:
        figures: list[Shows] = [("class", self.accuracy_class, "")]
        return f"gear cut by the {self.rule} rule", [
            *figures,
            *((one.figure, one.value_um, "um") for one in self.classes),
        ]


@dataclass(frozen=True)
class CutSetup:
    """What is cut and measured. ``assumed_diameter``: the file does not say that of the hob.

    ``toothed_length`` of the hob [mm], None where the file does not say it.
    """

    train: DriveTrain
    where: Layout
    hob_name: str
    assumed_diameter: bool
    toothed_length: float | None = None

    @property
    def job(self) -> HobbingJob:
        """Gear, hob and feed."""
        return self.train.job

    @cached_property
    def zone(self) -> tuple[float, float]:
        """Between which places along the hob [mm], from the pitch point, it cuts the flanks that are measured."""
        return self.job.generating_zone(float(self.where.profile[0]), float(self.where.profile[-1]))

    @property
    def hob_length(self) -> float:
        """How much of the hob's length cuts the flanks that are measured [mm]."""
        return self.zone[1] - self.zone[0]

    @property
    def offsets(self) -> tuple[float, float] | None:
        """Between which offsets [mm] the whole zone lies on the hob; None where its length is not known."""
        if self.toothed_length is None:
            return None
        return self.zone[1] - self.toothed_length / 2, self.zone[0] + self.toothed_length / 2


def setup(
    machine: HobbingMachine,
    teeth: int,
    hob: str | None = None,
    starts: int | None = None,
    helix: Helix | None = None,
    shift: float = 0.0,
    feed: float = 0.5,
    face_width: float | None = None,
    rpm: float | None = None,
    seconds: float = 0.0,
    climb: bool = True,
    rule: Rule = "exact",
    hob_shift: float = 0.0,
) -> CutSetup:
    """Everything that a job of this machine needs to be cut.

    If not given, ``hob`` is the first of the file, ``face_width`` ten modules, and ``rpm`` the highest within the
    limits; ``feed`` [mm per turn of the table]; ``seconds`` that the hob has run before;
    ``hob_shift`` [mm] of the hob's middle from the pitch point along its axis.
    Raises InputError where the machine cannot carry the job, or the hob cannot cut it.
    """
    if not LEAST_FEED <= feed <= MOST_FEED:
        raise InputError(f"feed = {feed:g}: must lie between {LEAST_FEED:g} and {MOST_FEED:g} mm per turn of the table")
    if not 0.0 <= seconds <= LONGEST_SECONDS:
        raise InputError(f"seconds = {seconds:g}: must lie between 0 and {LONGEST_SECONDS:g}")
    name = hob if hob is not None else (machine.hobs[0].name if machine.hobs else None)
    planned = plan(machine, teeth, starts=starts, hob=name, rpm=rpm, helix=helix, shift=shift)
    chosen = next(each for each in machine.hobs if each.name == planned.blanks[0].hob)
    width = FACE_WIDTH * chosen.module_mm if face_width is None else face_width
    if not 1.0 <= width <= 1000.0:
        raise InputError(f"width = {width:g}: must lie between 1 and 1000 mm")
    gear = Gear(teeth, chosen.module_mm, chosen.alpha, 0.0 if helix is None else helix.beta, shift)
    tool = hob_tool(chosen, planned.hob_starts, SIGNS[machine.hob_hand])
    if not abs(hob_shift) <= MOST_SHIFT:
        raise InputError(f"hob shift = {hob_shift:g}: must lie between {-MOST_SHIFT:g} and {MOST_SHIFT:g} mm")
    job = HobbingJob(gear, 1 if helix is None else helix.sign, tool, width, feed, climb, hob_shift)
    if len(machine.errors.hob_starts_um) not in (0, tool.starts):
        raise InputError(
            f"{machine.name}: errors.hob_starts_um has {len(machine.errors.hob_starts_um)} values, the hob has "
            f"{tool.starts} start{'s' * (tool.starts > 1)}"
        )
    train = DriveTrain(machine, job, planned.ratio, rule, planned.rpm, seconds)
    found = CutSetup(train, layout(job), chosen.name, chosen.diameter is None, chosen.length)
    if chosen.length is not None and chosen.length < found.hob_length:
        raise InputError(
            f"{machine.name}: hob {chosen.name}: length = {chosen.length:g}: the flanks of this gear need "
            f"{found.hob_length:.1f} mm of it"
        )
    if found.offsets is not None and not found.offsets[0] <= hob_shift <= found.offsets[1]:
        low, high = found.offsets
        raise InputError(
            f"{machine.name}: hob {chosen.name}: hob shift = {hob_shift:g}: must lie between {low:.1f} and {high:.1f} "
            f"mm, or the hob of {chosen.length:g} mm does not reach the whole flanks"
        )
    return found


def hob_tool(hob: Hob, starts: int, sign: int) -> HobTool:
    """The hob of a machine file, with a tip radius that fits on its teeth."""
    module, alpha = hob.module_mm, hob.alpha
    diameter = hob.reference_diameter
    if diameter <= 5.0 * module * starts:
        raise InputError(f"starts = {starts}: hob {hob.name} of {diameter:g} mm is too small for them")
    protruding = hob.protuberance * module
    # the land w_a of (30.12) grows evenly smaller with the tip radius
    sharp, rounded = (evaluate("hob_form", module, hob.addendum, radius, protruding, alpha)[1] for radius in (0.0, 1.0))
    if sharp <= 0.0:
        raise InputError(f"hob {hob.name}: teeth of {hob.addendum:g} mm at {hob.pressure_angle:g} degrees have no tip")
    roundest = sharp / (sharp - rounded)
    return HobTool(
        starts,
        sign,
        hob.gashes,
        diameter,
        hob.addendum,
        min(hob.tip_rounding, 0.999 * roundest),
        protruding,
        hob.alpha_protuberance if protruding else 0.0,
        module if hob.topping else None,
        hob.gash_lead,
    )


def cut_and_inspect(cut: CutSetup, rule: Rule, progress: Callable[[int], object] = lambda done: None) -> VirtualGear:
    """The gear as one rule cuts it."""
    train = DriveTrain(cut.train.machine, cut.job, cut.train.ratio, rule, cut.train.rpm, cut.train.seconds)
    found = inspect(Envelope(cut.job, train), cut.where, progress)
    return VirtualGear(rule, found, classes(cut.job, found))


def ridges(job: HobbingJob) -> tuple[float, float]:
    """Height of the ridges between flats and between feed marks at the reference cylinder [mm] (30.9, 30.10)."""
    length = job.reference_diameter / 2 * math.sin(job.transverse[1])
    (flat,) = evaluate("generating_flat", length, job.hob.starts, job.gear.teeth, job.hob.gashes)
    return flat, job.feed_mark(length)


def blame(
    cut: CutSetup, gear: VirtualGear, progress: Callable[[int], object] = lambda done: None
) -> tuple[Contribution, ...]:
    """Every source of error of a gear that was cut with the rule of its setup, with its share."""
    return contributions(cut.train, cut.where, gear.found, progress)
