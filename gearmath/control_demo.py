"""The closed loop over a control: what ``gearmath demo --control`` runs, with a simulated control on this computer.

From an empty store to a corrected program on the control, and a second measurement. The operator, who selects and
starts programs at the machine, is played here; all else goes over an encrypted session.
"""

from __future__ import annotations

import asyncio
import secrets
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from gearmath.bevel.pair import check_corrected, load_pair
from gearmath.control.interface import Control
from gearmath.control.measuring import Connect, Measuring
from gearmath.control.opcua import OpcUaControl
from gearmath.control.run_start import begun
from gearmath.control.simulated.access import Access, Account
from gearmath.control.simulated.identity import prepared
from gearmath.control.simulated.nc import Nc
from gearmath.control.simulated.server import SimulatedControl
from gearmath.control.simulated.workshop import Workshop
from gearmath.control.store import MeasurementStore
from gearmath.control.store_evaluation import EvaluatedRun, evaluate_run, keep_results
from gearmath.errors import ComputationError
from gearmath.export.folder import new_folder
from gearmath.files import read_bytes, write_text
from gearmath.machine.planning.cut_plan import CuttingJob
from gearmath.machine.writing.cutting import cutting_program
from gearmath.machine.writing.probing import probing_program
from gearmath.quality.correction.member import correct
from gearmath.specs.calibration import load_calibration
from gearmath.specs.control_connection import load_control_connection
from gearmath.specs.milling_machine import load_milling_machine
from gearmath.specs.set_text import save_corrected
from gearmath.specs.simulated_machine import load_simulated_machine
from gearmath.specs.toml import bundled

GEAR_SET, MACHINE, CALIBRATION, SHOP = (
    "nasa_tp3096_12x36.toml",
    "vertical_5axis.toml",
    "probe.toml",
    "simulated_shop.toml",
)
MEMBER = "pinion"
_FOLDER = "Part Program"

Say = Callable[[str], object]


@dataclass(frozen=True)
class DemoPass:
    """One part: what it was cut by, and what was measured on it."""

    settings: Path
    cut: Path
    evaluated: EvaluatedRun

    @property
    def largest(self) -> float:
        """The largest deviation of the tooth whose whole flanks are measured [mm]."""
        file = self.evaluated.found.file
        return float(np.abs(file.deviation[file.tooth == 0]).max())


def run_control_demo(folder: Path, say: Say) -> list[DemoPass]:
    """Cut, measure, correct, cut and measure again, over the control; programs, store and sets are left in ``folder``.

    Raises InputError if the folder holds anything that an earlier demo did not write.
    """
    with new_folder(folder) as place:
        passes = asyncio.run(_loop(place, say))
    say(f"programs, measurement store, corrected set and connection file are in {folder}")
    return passes


async def _loop(folder: Path, say: Say) -> list[DemoPass]:
    calibration = load_calibration(bundled(CALIBRATION))
    workshop = Workshop(load_milling_machine(bundled(MACHINE)), calibration, load_simulated_machine(bundled(SHOP)))
    password = secrets.token_urlsafe(12)
    nc = Nc(workshop, speed=0.0)
    identity = await prepared(folder / "control", "opc.tcp://127.0.0.1:4840")
    known = load_control_connection(folder / "control" / "control.toml")
    access = Access({known.user: Account(password)})
    passes: list[DemoPass] = []
    settings = bundled(GEAR_SET)
    with MeasurementStore.open(folder / "runs.db") as store:
        async with SimulatedControl(nc, access, identity) as simulated:
            say(f"a simulated control is at {simulated.url}")
            here = known.model_copy(update={"url": simulated.url})

            async def connect() -> Control:
                return await OpcUaControl.connect(here, password)

            for number in (1, 2):
                workshop.load(settings)
                passes.append(await _pass(number, settings, folder, store, nc, connect, say))
                if number == 1:
                    settings = await asyncio.to_thread(_corrected, passes[0], folder)
                    say(f"* corrected settings: {settings.name}")
    before, after = (1000 * one.largest for one in passes)
    say(f"largest deviation of the {MEMBER}: {before:.2f} um, after one correction {after:.2f} um")
    return passes


async def _pass(
    number: int, settings: Path, folder: Path, store: MeasurementStore, nc: Nc, connect: Connect, say: Say
) -> DemoPass:
    """One part, from its program to its evaluation."""

    def heard(said: str) -> None:
        if "start it" in said:
            nc.start()
        else:
            say(f"  {said}")

    cut, probe = folder / f"CUT_{number}.MPF", folder / "PROBE.MPF"
    await asyncio.to_thread(_write_programs, settings, cut, probe)
    control = await connect()
    await control.put(cut.name, read_bytes(cut))
    say(f"* part {number}: {cut.name} is on the control; the operator selects and starts it")
    await _operated(nc, cut.name)
    await control.put(probe.name, read_bytes(probe), replace=True)
    await control.close()
    nc.select(f"{_FOLDER}/{probe.name}")
    start, stretches = await asyncio.to_thread(begun, control.name, probe, str(settings), MACHINE, CALIBRATION)
    run = store.begin_run(replace(start, operator="demo"))
    measuring = Measuring(connect, run, say=heard)
    await measuring.to_the_end(*stretches)
    say(f"  {len(run.touches())} touches are in run {run.id}, each on the disk before it was acknowledged")
    evaluated = await asyncio.to_thread(evaluate_run, run)
    keep_results(evaluated)
    return DemoPass(settings, cut, evaluated)


def _write_programs(settings: Path, cut: Path, probe: Path) -> None:
    """The cutting program of these settings and, once, the probing program, which is the same for all of them."""
    pair, machine = load_pair(settings), load_milling_machine(bundled(MACHINE))
    spaces = range(pair.member(MEMBER).teeth)
    write_text(cut, cutting_program(pair, MEMBER, machine, cut.stem, CuttingJob(spaces)))
    if not probe.exists():
        text = probing_program(pair, MEMBER, machine, load_calibration(bundled(CALIBRATION)), probe.stem, pitch=False)
        write_text(probe, text)


async def _operated(nc: Nc, name: str) -> None:
    """The operator selects a program, starts it, and waits for its end."""
    nc.select(f"{_FOLDER}/{name}")
    nc.start()
    await asyncio.to_thread(nc.wait)
    for alarm in nc.alarms.values():
        raise ComputationError(f"{name}: the control stops with alarm {alarm.number}: {alarm.text}")


def _corrected(first: DemoPass, folder: Path) -> Path:
    """The set with the settings that make up for what was measured."""
    target = folder / f"{MEMBER}_corrected.toml"
    spec = load_pair(first.settings).member(MEMBER)
    result = correct(spec, first.evaluated.file)
    save_corrected(first.settings, target, MEMBER, result.settings, result.index, check=check_corrected)
    return target
