"""Programs of the touch probe, run on the machine model, and what their touches say."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from gearmath.errors import InputError
from gearmath.files import write_text
from gearmath.front.machines import Machine, load_machine, load_probe
from gearmath.front.measured import Measurement
from gearmath.front.sets import GearSet, Member
from gearmath.machine.control.state import Setup
from gearmath.machine.control.text import readable
from gearmath.machine.judging.dialects import named
from gearmath.machine.measuring.artefacts import Artefacts
from gearmath.machine.measuring.checked import ProbingChoice, checked_probing, refuse_faults
from gearmath.machine.measuring.judge import judge_calibration
from gearmath.machine.measuring.probe import ProbeMachine
from gearmath.machine.measuring.probe_run import run_touches, touch_count
from gearmath.machine.milling.milled_surface import MilledSurface
from gearmath.machine.writing.axis_cycle import axis_program
from gearmath.machine.writing.calibrating import calibration_program
from gearmath.quality.calibration.axes import AxisCalibration
from gearmath.quality.calibration.tip import Tip
from gearmath.quality.evaluation.calibrated_run import calibrated_run
from gearmath.quality.evaluation.measured_run import measured_run
from gearmath.specs.calibration import Calibration
from gearmath.specs.simulated_machine import SimulatedMachine

#: Touches of one point at most, as of ``gearmath nc probe``.
MOST_TOUCHES = 100


@dataclass(frozen=True)
class ProbingProgram:
    """A program that probes ``member``, or without one ring and spheres; it was run before it was returned."""

    member: Member | None
    machine: Machine
    probe: Calibration
    name: str
    text: str

    def save(self, path: str | Path) -> Path:
        """Write the program, in one step; the file should be called ``name``.MPF, which the control expects."""
        write_text(Path(path), self.text)
        return Path(path)

    def run(
        self,
        path: str | Path,
        measured: Measurement | None = None,
        shop: SimulatedMachine | None = None,
        number: int = 1,
    ) -> Path:
        """Run it on the machine model and write the raw touches, as ``gearmath probe`` does; docs/files.md.

        Against nominal flanks or, with ``measured``, the metal that it tells of; ``shop`` errs in axes, clamping and
        probe, and each run ``number`` has its own noise. Raises InputError where it touches what is not there.
        """
        setup, text = Setup.of(self.machine.spec, self.probe.length), readable(self.text)
        if self.member is None:
            raw = run_touches(text, self.name, Artefacts(self.machine.spec, self.probe), shop, run=number, setup=setup)
        else:
            there = _on_machine(self.member, measured, self.machine, self.probe, shop)
            count = touch_count(text, self.name, setup)
            raw = run_touches(text, self.name, there, shop, count, number, setup=setup)
        write_text(Path(path), raw)
        return Path(path)


def probing(
    member: Member,
    machine: Machine | None = None,
    probe: Calibration | None = None,
    name: str = "PROBE",
    topography: Sequence[int] = (0,),
    pitch: bool = True,
    registration: bool = True,
    repeat: int = 1,
) -> ProbingProgram:
    """The program that probes a member: a grid of both flanks of the teeth of ``topography``, the reference point of
    every tooth for ``pitch``, the corners on eight teeth around for ``registration``, each ``repeat`` times.

    Raises InputError naming what the probe would meet.

    >>> import gearmath as gm
    >>> program = gm.probing(gm.load_set("nasa_tp3096_12x36.toml").pinion, topography=(), registration=False)
    >>> program.name, "MEAS=" in program.text
    ('PROBE', True)
    """
    if isinstance(repeat, bool) or not isinstance(repeat, int) or not 1 <= repeat <= MOST_TOUCHES:
        raise InputError(f"repeat = {repeat!r}: must be a whole number from 1 to {MOST_TOUCHES}")
    machine, probe = machine or load_machine(), probe or load_probe()
    choice = ProbingChoice(topography, pitch, registration, repeat)
    dialect = named(machine.spec.control.dialect(None))
    made = checked_probing(member.gear_set.spec, member.name, machine.spec, probe, choice, name, name, dialect=dialect)
    return ProbingProgram(member, machine, probe, name, made.text)


def calibrating(
    machine: Machine | None = None,
    probe: Calibration | None = None,
    cycle: Literal["tip", "axes"] = "tip",
    name: str = "CALIBRATE",
) -> ProbingProgram:
    """The program that touches ring and sphere on the table for the tip, or the sphere on the work side for the rotary
    axes. Raises InputError naming what the machine cannot do.
    """
    if cycle not in ("tip", "axes"):
        raise InputError(f"cycle = {cycle!r}: must be 'tip' or 'axes'")
    machine, probe = machine or load_machine(), probe or load_probe()
    dialect = named(machine.spec.control.dialect(None))
    text = (axis_program if cycle == "axes" else calibration_program)(machine.spec, probe, name, dialect.blocks)
    refuse_faults(judge_calibration(dialect.read(text), name, machine.spec, probe), name, "the program is not written")
    return ProbingProgram(None, machine, probe, name, text)


def load_touches(
    path: str | Path,
    pair: GearSet,
    machine: Machine | None = None,
    probe: Calibration | None = None,
    run: int | None = None,
) -> Measurement:
    """Raw touches as corrected contact points and deviations [mm], by default those of the last run, which must be
    whole. Raises InputError naming file and point.
    """
    machine, probe = machine or load_machine(), probe or load_probe()
    made = measured_run(Path(path), pair.spec, machine.spec, probe, run)
    return Measurement(pair.member(made.touches.member), made.file)


def calibrate(
    path: str | Path,
    machine: Machine | None = None,
    probe: Calibration | None = None,
    lobing: bool = False,
    run: int | None = None,
) -> Tip | AxisCalibration:
    """The tip of the probe from touches on sphere or ring, or the rotary axes from those on the work side's sphere.

    Both have standard uncertainties [mm, rad]. By default those of the last run, which must be whole. Raises InputError
    naming file and touch.
    """
    machine, probe = machine or load_machine(), probe or load_probe()
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
        return ProbeMachine(member.spec, member.name, machine.spec, probe, seat=clamping)
    metal = MilledSurface(measured.file, member.spec, member.name, "measured")
    return ProbeMachine(member.spec, member.name, machine.spec, probe, metal, metal.lowest, clamping)
