"""NC programs of a member: written, run on the machine model, and what they leave of the metal."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING

from gearmath.arguments.call import checked_call
from gearmath.arguments.kinds import Record
from gearmath.arguments.known import KNOWN
from gearmath.bevel.tooth import SHARP_EDGE, ToothSpace, tooth_space
from gearmath.errors import InputError, about
from gearmath.files import write_text
from gearmath.front.machines import Machine, load_machine, shop_of
from gearmath.front.measured import Measurement, load_measurement
from gearmath.front.member import Member
from gearmath.front.progress import Begin, Progress, silent, unheard
from gearmath.machine.bodies.cutter import cutter_of
from gearmath.machine.control.executor import execute
from gearmath.machine.control.state import Setup
from gearmath.machine.control.text import readable
from gearmath.machine.judging.checked import CheckedCut, checked_cut
from gearmath.machine.judging.dialects import named, of_text
from gearmath.machine.judging.feed import crawling
from gearmath.machine.judging.program import faults_of, metal_faults
from gearmath.machine.judging.stated import Stated
from gearmath.machine.milling.metal import metal
from gearmath.machine.milling.mill import mill_member
from gearmath.machine.milling.run import CuttingRun, runs_of
from gearmath.machine.planning.cut_plan import PLUNGE_FEED, CuttingJob
from gearmath.machine.planning.targets import teeth_around
from gearmath.quality.evaluation.file_checks import check_belongs
from gearmath.shown import Shown, Shows
from gearmath.specs.simulated_machine import SimulatedMachine

if TYPE_CHECKING:
    from gearmath.front.timing import ProgramTime
    from gearmath.machine.control.executor import MachinePath
    from gearmath.machine.judging.cut import MetalLeft
    from gearmath.machine.judging.report import MillingReport

#: Columns of the tooth space that programs are judged with.
_COLUMNS = 7


@dataclass(frozen=True, repr=False)
class Judgement(Shown):
    """What is wrong with a program: ``left`` what it leaves of the metal, ``faults`` a sentence each, or none.

    ``remarks`` are sentences about what only takes time.
    """

    left: MetalLeft
    faults: tuple[str, ...]
    remarks: tuple[str, ...] = ()

    def _shown(self) -> tuple[str, list[Shows]]:
        figures: list[Shows] = [("faults", len(self.faults), ""), ("remarks", len(self.remarks), "")]
        figures += [("fault", text, "") for text in self.faults] + [("remark", text, "") for text in self.remarks]
        return "the machine must not run it" if self.faults else "the machine may run it", figures


@checked_call(
    machine=Record("gearmath.front.machines", "Machine", "a machine"),
    made=Record("gearmath.machine.judging.checked", "CheckedCut", "the plan of a program"),
)
@dataclass(frozen=True, repr=False)
class Program(Shown):
    """The text of a program for a member on a machine, and its name on the control or in its file.

    ``made`` is the plan that it was written from, where it was written here.
    """

    member: Member
    machine: Machine
    name: str
    text: str
    made: CheckedCut | None = field(default=None, repr=False, compare=False)

    def __post_init__(self) -> None:
        made = self.made
        if made is None:
            return
        if (made.text, made.plan.machine, made.plan.member) != (self.text, self.machine.spec, self.member.spec):
            object.__setattr__(self, "made", None)  # the plan is that of another program

    @property
    def blocks(self) -> int:
        """How many blocks the control runs."""
        return of_text(self.text).block_count(self.text)

    @checked_call
    def save(self, path: str | Path) -> Path:
        """Write the program, in one step; its file should be called ``name``.MPF, or .ngc for LinuxCNC."""
        write_text(Path(path), self.text)
        return Path(path)

    @checked_call
    def sheet(self, file: str) -> str:
        """The set-up sheet of the program in a ``file`` of this name: HTML that prints on A4.

        Raises InputError where the program was not written here: only its plan tells what the sheet says.
        """
        from gearmath.machine.judging.timing import timing
        from gearmath.machine.planning.setup_facts import SetupFacts
        from gearmath.setup_sheet import setup_sheet

        if self.made is None:
            raise InputError(f"{self.name}: was not written here: a sheet needs the plan of its program")
        facts = SetupFacts.of(self.made.plan, PLUNGE_FEED)
        return setup_sheet(facts, file, timing(self.path, self.machine.spec), of_text(self.text).sheet)

    @checked_call
    def mill(
        self, shop: SimulatedMachine | str | Path | None = None, progress: Progress = unheard, number: int | None = None
    ) -> Measurement:
        """The deviations [mm] that the program leaves: both flanks of tooth 0, the reference point of all others.

        ``shop`` makes the machine one with errors; with the ``number`` of a measurement the member is clamped anew and
        measured as that shop does. ``progress`` is called for every flank. Raises InputError where a flank is left
        uncut, and where it is measured without a shop.
        """
        member, machine, shop = self.member.spec, self.machine.spec, shop_of(shop)
        if number is not None and shop is None:
            raise InputError("a measurement needs the file that says how the member sits and what the probe does")
        narrowest = None if member.cutting == "completing" else self.space
        if shop is not None or self.space is None:
            runs = runs_of(self.path, member, machine, shop, narrowest)
        else:  # the same as those that are judged, but for the rounding of the blades' edges
            runs = [replace(run, cutter=cutter_of(member, run.cut.flanks, narrowest)) for run in self.runs]
        if number is None or shop is None:
            file = mill_member(self.path, member, machine, shop, progress, runs)
        else:
            from gearmath.machine.measuring.measurement import measure_member

            around = teeth_around(member.teeth)
            left = metal(self.path, member, machine, shop, around=around, progress=progress, runs=runs)
            file = measure_member(left, member, shop, number)
        return Measurement(self.member, file)

    @checked_call
    def judge(self, milled: Measurement | str | Path | None = None, begin: Begin = silent) -> Judgement:
        """What the machine must not run: travel, speed, collisions, modes, metal that is left or gouged.

        Returns ``faults`` and ``remarks``, a sentence each, and ``left``, what is left of the metal: ``left.tolerance``
        [mm] is how far flanks may deviate. On a machine without errors. ``milled`` is what :meth:`mill` has found of
        such a machine, to be asked once.
        """
        member, machine = self.member.spec, self.machine.spec
        if isinstance(milled, str | Path):
            milled = load_measurement(milled, self.member)
        if milled is not None:
            with about(milled.source):
                check_belongs(member, milled.file)
        known = None if milled is None else milled.file
        progress = begin(member.teeth, "space")
        left = metal_faults(self.read, self.path, self.runs, member, machine, self.space, progress, known)
        found = faults_of(self.read, self.path, self.runs, member, machine)
        slow = crawling(self.path, self.runs, member, machine, Stated.of(self.read))
        return Judgement(left, (*map(str, left.faults), *map(str, found)), tuple(slow))

    def faults(self) -> list[str]:
        """What :meth:`judge` finds, a sentence each; empty where the machine may run it. A dry run cuts no metal."""
        if Stated.of(self.read).coolant:
            return list(self.judge().faults)
        member, machine = self.member.spec, self.machine.spec
        return [str(fault) for fault in faults_of(self.read, self.path, self.runs, member, machine)]

    @checked_call(tolerance=KNOWN["report_tolerance"])
    def report(
        self,
        tolerance: float = 1e-3,
        shop: SimulatedMachine | str | Path | None = None,
        begin: Begin = silent,
        flank_tolerance: float | None = None,
    ) -> MillingReport:
        """Gouges, uncut stock beyond ``tolerance`` [mm], collisions, axis speeds and time, of every surface.

        Flanks may have a ``flank_tolerance`` [mm] of their own. Returns ``surfaces`` with the ``lowest`` and
        ``highest`` place of each [mm], those of them that are ``gouges`` or ``uncut``, ``collisions``, and in
        ``timing`` seconds and the speed of each axis.
        """
        from gearmath.machine.judging.report import milling_report
        from gearmath.specs.bevel_set import FLANKS

        member, machine, shop = self.member.spec, self.machine.spec, shop_of(shop)
        corrected = shop is None and any(member.flank(flank).design for flank in FLANKS)
        progress = begin(5 * member.teeth * (1 + corrected), "surface")
        return milling_report(
            self.path,
            member,
            machine,
            shop,
            tolerance,
            progress=progress,
            space=self.space,
            flank_tolerance=flank_tolerance,
        )

    def time(self) -> ProgramTime:
        """How long the control takes [s], where it is slow, and how far it leaves the path; as ``gearmath nc time``."""
        from gearmath.front.timing import timed

        return timed(self.read, self.name, self.machine, path=self.path)

    @cached_property
    def read(self) -> str:
        """The text in words that are judged, line for line: those of another control are translated."""
        return readable(self.text)

    @cached_property
    def path(self) -> MachinePath:
        """The path that the machine takes. Raises InputError naming line and word of what the control refuses."""
        return execute(self.read, self.name, Setup.of(self.machine.spec)) if self.made is None else self.made.path

    @cached_property
    def space(self) -> ToothSpace | None:
        """The tooth space of the member, None in face hobbing, of which flanks alone are judged."""
        member = self.member
        return None if member.spec.process == "face_hobbing" else tooth_space(member.spec, _COLUMNS)

    @cached_property
    def runs(self) -> list[CuttingRun]:
        """The tools of the program on a machine without errors, with blades as sharp as there are."""
        member, machine = self.member, self.machine.spec
        return runs_of(self.path, member.spec, machine, None, self.space, SHARP_EDGE)

    def _shown(self) -> tuple[str, list[Shows]]:
        figures: list[Shows] = [
            ("blocks", self.blocks, ""),
            ("text", len(self.text) // 1000, "kB"),
            ("machine", self.machine.spec.name, ""),
        ]
        return f"{self.name}, cutting the {self.member.name} of {self.member.teeth} teeth", figures


def cutting(
    member: Member,
    machine: Machine | None = None,
    name: str = "GEAR",
    job: CuttingJob | None = None,
    control: str | None = None,
    file: str | Path | None = None,
    begin: Begin = silent,
) -> Program:
    """The cutting program of a member, run before it is returned. Raises InputError naming what is wrong.

    By default of all spaces, and for the control of the machine: ``control`` may be "sinumerik", "linuxcnc", or one
    that was registered.
    Sentences name the ``file`` it is for.
    """
    machine = load_machine() if machine is None else machine
    job = CuttingJob(range(member.teeth)) if job is None else job
    dialect = named(machine.spec.control.dialect(control))
    made = checked_cut(member.gear_set.spec, member.name, machine.spec, job, name, str(file or name), begin, dialect)
    return Program(member, machine, name, made.text, made)
