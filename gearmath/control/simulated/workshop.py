"""The machine behind the simulated control: programs cut a blank, and then probe what they have cut."""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from pathlib import Path

from gearmath.bevel.pair import load_pair
from gearmath.control.simulated.nc import NcJob
from gearmath.errors import InputError
from gearmath.machine.control.executor import ProgramRun
from gearmath.machine.control.state import Probe, Setup
from gearmath.machine.judging.stated import Stated, stated_member
from gearmath.machine.measuring.artefacts import Artefacts
from gearmath.machine.measuring.probe import ProbeMachine
from gearmath.machine.measuring.probe_errors import ErringProbe
from gearmath.machine.measuring.probe_run import touch_count, touches_artefacts
from gearmath.machine.milling.mill import mill_member
from gearmath.machine.milling.milled_surface import MilledSurface
from gearmath.specs.bevel_set import BevelSet, design_sha256, settings_sha256
from gearmath.specs.calibration import Calibration
from gearmath.specs.flank_csv import FlankFile
from gearmath.specs.milling_machine import MillingMachine
from gearmath.specs.simulated_machine import Probe as ProbeErrors
from gearmath.specs.simulated_machine import SimulatedMachine
from gearmath.specs.touch_csv import COLUMNS

#: What a cutting program was made from, and what a probing program was made for.
_CUT_FROM = re.compile(r"^; machine settings sha256: ([0-9a-f]{64})", re.MULTILINE)
_MADE_FOR = re.compile(r"^; nominal settings sha256: ([0-9a-f]{64})", re.MULTILINE)


@dataclass
class Workshop:
    """A machine with the errors of a shop, and what is on its table.

    Cutting begins with a new blank; probing finds the flanks that were cut last, nominal ones where none were.
    """

    machine: MillingMachine
    calibration: Calibration
    shop: SimulatedMachine | None = None
    sets: list[BevelSet] = field(default_factory=list)
    metal: dict[str, FlankFile] = field(default_factory=dict)
    """What is left of each member, as the machine has cut it."""

    def load(self, path: Path) -> None:
        """A gear set whose programs are to be understood, the corrected ones besides the first."""
        self.sets.append(load_pair(path))

    def job(self, text: str, name: str, number: int) -> NcJob:
        """What a program of gearmath meets; any other one moves in the air."""
        setup = Setup.of(self.machine, self.calibration.length)
        if touches_artefacts(text):
            return self._probing(Artefacts(self.machine, self.calibration), setup, None, number)
        if ",".join(COLUMNS) in text:
            return self._probing(self._member(text, name), setup, touch_count(text, name, setup), number)
        if Stated.of(text).is_ours:
            self._set_of(text, name)
            return NcJob(setup=setup, done=lambda run: self._cut(text, name, run))
        return NcJob(setup=setup)

    def _probing(self, probe: Probe, setup: Setup, touches: int | None, number: int) -> NcJob:
        if self.shop is None:
            return NcJob(probe, setup)
        erring = ErringProbe(probe, self.shop, touches, number)
        return NcJob(erring, setup, moved=erring.follow)

    def _member(self, text: str, name: str) -> ProbeMachine:
        """The member on the table, under the probe."""
        found, member = self._set_of(text, name)
        spec = found.member(member)
        seat = self.shop.measuring_clamp(member) if self.shop else None
        if member not in self.metal:
            return ProbeMachine(spec, self.machine, self.calibration, seat=seat)
        metal = MilledSurface(self.metal[member], spec, name)
        return ProbeMachine(spec, self.machine, self.calibration, metal, metal.lowest, seat)

    def _cut(self, text: str, name: str, run: ProgramRun) -> None:
        """Mill what the program has cut; the noise of a probe is no metal."""
        found, member = self._set_of(text, name)
        quiet = None if self.shop is None else self.shop.model_copy(update={"probe": ProbeErrors()})
        self.metal[member] = mill_member(run.path, found.member(member), self.machine, quiet)

    def _set_of(self, text: str, name: str) -> tuple[BevelSet, str]:
        """The set whose settings, or design, a program states, and the member."""
        member = stated_member(text)
        stated, digest = _CUT_FROM.search(text), settings_sha256
        if stated is None:
            stated, digest = _MADE_FOR.search(text), design_sha256
        if member is None or stated is None:
            raise InputError(f"{name}: states no member, or no settings")
        for one in reversed(self.sets):
            if member in one.members and digest(one.member(member)) == stated[1]:
                return one, member
        raise InputError(f"{name}: no gear set of the simulated machine has the settings of this program")
