"""Programs of the touch probe, run on the machine model, and what their touches say."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Literal

from gearmath.arguments.call import checked_call
from gearmath.arguments.kinds import Truth
from gearmath.errors import InputError, about
from gearmath.files import write_text
from gearmath.front.machines import Machine, machine_of, probe_of, shop_of
from gearmath.front.measured import Measurement, load_measurement
from gearmath.front.member import Member
from gearmath.front.progress import Begin, silent
from gearmath.machine.bodies.profiles import obstacles
from gearmath.machine.control.state import Setup
from gearmath.machine.control.text import readable
from gearmath.machine.judging.dialects import named, of_text
from gearmath.machine.measuring.artefacts import Artefacts
from gearmath.machine.measuring.checked import ProbingChoice, checked_probing, clearances, refuse_faults
from gearmath.machine.measuring.collision_check import approaches
from gearmath.machine.measuring.judge import judge_calibration, judge_probing
from gearmath.machine.measuring.probe import ProbeMachine
from gearmath.machine.measuring.probe_run import run_touches, touch_count
from gearmath.machine.milling.milled_surface import MilledSurface
from gearmath.machine.writing.axis_cycle import axis_program
from gearmath.machine.writing.calibrating import calibration_program
from gearmath.quality.calibration.axes import AxisCalibration
from gearmath.quality.calibration.tip import Tip
from gearmath.quality.evaluation.calibrated_run import calibrated_run
from gearmath.quality.evaluation.file_checks import check_belongs, check_points
from gearmath.quality.evaluation.nominal import nominal_rows
from gearmath.shown import Shown, Shows
from gearmath.specs.calibration import Calibration
from gearmath.specs.simulated_machine import SimulatedMachine
from gearmath.specs.touch_csv import planned_touches

if TYPE_CHECKING:
    from gearmath.machine.control.state import Probe


@dataclass(frozen=True, repr=False)
class ProbingProgram(Shown):
    """A program that probes ``member``, or without one ring and spheres.

    What :meth:`Member.probing` and :meth:`Machine.calibrating` write was run before it is returned; ``clearance`` says
    how far the probe stays clear. ``shop`` is the simulated machine whose fixture and spindle it must clear, ``cycle``
    what ring and spheres tell: the tip, or the rotary axes.
    """

    member: Member | None
    machine: Machine
    probe: Calibration
    name: str
    text: str
    clearance: str = ""
    shop: SimulatedMachine | None = field(default=None, repr=False)
    cycle: Literal["tip", "axes"] = "tip"

    @property
    def touches(self) -> int:
        """How many touches it plans."""
        return planned_touches(self.read)

    @property
    def blocks(self) -> int:
        """How many blocks the control runs."""
        return of_text(self.text).block_count(self.text)

    @checked_call
    def save(self, path: str | Path) -> Path:
        """Write the program, in one step; the file should be called ``name``.MPF, which the control expects."""
        write_text(Path(path), self.text)
        return Path(path)

    @checked_call
    def sheet(self, file: str) -> str:
        """The set-up sheet of the program in a ``file`` of this name: HTML that prints on A4."""
        from gearmath.setup_sheet import ProbingJob, calibration_sheet, probing_sheet

        machine, member, words = self.machine.spec, self.member, of_text(self.text).sheet
        if member is None:
            return calibration_sheet(machine, self.probe, self.cycle == "axes", file, words)
        head, fixture = obstacles(machine, self.shop)
        title, radius = member.gear_set.title, head.spindle_radius
        what = title, member.spec, machine, self.probe, fixture, radius, self.touches, self.clearance
        return probing_sheet(ProbingJob(*what), file, words)

    @checked_call
    def check(self, begin: Begin = silent) -> None:
        """Raise InputError where the probe meets a nominal member, touches what it lacks, or does what it must not."""
        machine, probe, name = self.machine.spec, self.probe, self.name
        if self.member is None:
            found = judge_calibration(self.read, name, machine, probe, begin(self._measuring, "block"))
        else:
            spec = self.member.spec
            if not self._count:
                raise InputError(f"{name}: touches nothing of the member: no touch is measured before its end")
            head, fixture = obstacles(machine, self.shop)
            heard = begin(3 * self._count + self.read.count("\n"), "step")
            met = approaches(self.read, name, spec, machine, probe, fixture, head.spindle_radius, heard)
            clearances(met, name, "it is not run")
            found = judge_probing(self.read, name, spec, machine, probe, begin(self._measuring, "block"))
        refuse_faults(found, name)

    @checked_call
    def run(
        self,
        path: str | Path,
        measured: Measurement | str | Path | None = None,
        shop: SimulatedMachine | str | Path | None = None,
        number: int = 1,
        begin: Begin = silent,
    ) -> Path:
        """Run it on the machine model and write the raw touches, as ``gearmath probe`` does; docs/files.md.

        Against nominal flanks or, with ``measured``, the metal that it tells of; ``shop`` errs in axes, clamping and
        probe, and each run ``number`` has its own noise. Raises InputError where it touches what is not there.
        """
        there: Probe
        shop = shop_of(shop)
        if self.member is None:
            count, steps = None, self._measuring
            there = Artefacts(self.machine.spec, self.probe)
        else:
            count = self._count
            steps = 3 * count
            if isinstance(measured, str | Path):
                measured = load_measurement(measured, self.member)
            there = _on_machine(self.member, measured, self.machine, self.probe, shop)
        progress = begin(steps, "block")
        raw = run_touches(self.read, self.name, there, shop, count, number, progress, self._setup)
        write_text(Path(path), raw)
        return Path(path)

    @cached_property
    def read(self) -> str:
        """The text in words that are judged, line for line: those of another control are translated."""
        return readable(self.text)

    @property
    def _setup(self) -> Setup:
        return Setup.of(self.machine.spec, self.probe.length)

    @property
    def _measuring(self) -> int:
        """Blocks that measure, for a bar."""
        return self.read.count("MEAS=1")

    @cached_property
    def _count(self) -> int:
        return touch_count(self.read, self.name, self._setup)

    def _shown(self) -> tuple[str, list[Shows]]:
        what = (
            f"probing the {self.member.name} of {self.member.teeth} teeth"
            if self.member
            else f"finding the {self.cycle}"
        )
        figures: list[Shows] = [
            ("touches", self.touches, ""),
            ("blocks", self.blocks, ""),
            ("machine", self.machine.spec.name, ""),
        ]
        return f"{self.name}, {what}", figures


@checked_call(pitch=Truth())
def probing(
    member: Member,
    machine: Machine | str | Path | None = None,
    probe: Calibration | str | Path | None = None,
    name: str = "PROBE",
    topography: Sequence[int] = (0,),
    pitch: bool = True,
    registration: bool = True,
    repeat: int = 1,
    shop: SimulatedMachine | str | Path | None = None,
    control: str | None = None,
    file: str | Path | None = None,
    begin: Begin = silent,
) -> ProbingProgram:
    """The program that probes a member; see :meth:`gearmath.Member.probing`. Sentences name the ``file`` it is for."""
    shop = shop_of(shop)
    machine, probe = machine_of(machine), probe_of(probe)
    choice = ProbingChoice(topography, pitch, registration, repeat)
    dialect = named(machine.spec.control.dialect(control))
    where = member.gear_set.spec, member.name, machine.spec, probe
    made = checked_probing(*where, choice, name, str(file or name), shop, begin, dialect)
    return ProbingProgram(member, machine, probe, name, made.text, made.clearance, shop)


@checked_call
def calibrating(
    machine: Machine | str | Path | None = None,
    probe: Calibration | str | Path | None = None,
    cycle: Literal["tip", "axes"] = "tip",
    name: str = "CALIBRATE",
    control: str | None = None,
    file: str | Path | None = None,
    source: str | Path | None = None,
    begin: Begin = silent,
) -> ProbingProgram:
    """The program that calibrates; see :meth:`gearmath.Machine.calibrating`. ``source`` is the file of the probe."""
    machine, probe = machine_of(machine), probe_of(probe)
    make, target = (axis_program if cycle == "axes" else calibration_program), str(file or name)
    dialect = named(machine.spec.control.dialect(control))
    with about(None if source is None else Path(source)):
        text = make(machine.spec, probe, name, dialect.blocks)
    read = dialect.read(text)
    progress = begin(planned_touches(read), "touch")
    found = judge_calibration(read, target, machine.spec, probe, progress)
    refuse_faults(found, target, "the program is not written")
    return ProbingProgram(None, machine, probe, name, text, cycle=cycle)


def calibrate(
    path: str | Path,
    machine: Machine | str | Path | None = None,
    probe: Calibration | str | Path | None = None,
    lobing: bool = False,
    run: int | None = None,
) -> Tip | AxisCalibration:
    """The tip of the probe, or the rotary axes; see :meth:`gearmath.Machine.calibrate`."""
    machine, probe = machine_of(machine), probe_of(probe)
    return calibrated_run(Path(path), machine.spec, probe, run, lobing).found


def _on_machine(
    member: Member,
    measured: Measurement | None,
    machine: Machine,
    probe: Calibration,
    shop: SimulatedMachine | None,
) -> ProbeMachine:
    """The member on the machine, nominal or as measured, clamped as the shop does."""
    clamping = shop.measuring_clamp(member.name) if shop else None
    if measured is None:
        return ProbeMachine(member.spec, machine.spec, probe, seat=clamping)
    file, source = measured.file, measured.source
    with about(source):
        check_belongs(member.spec, file)
        check_points(file, nominal_rows(file, member.spec), member.spec)
        metal = MilledSurface(file, member.spec, str(source or "measured"))
    return ProbeMachine(member.spec, machine.spec, probe, metal, metal.lowest, clamping)
