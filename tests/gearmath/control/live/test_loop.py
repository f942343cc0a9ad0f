"""The whole loop over OPC UA: put, cut, probe with the handshake, store, evaluate, correct, put, cut, probe.

The direct loop runs the same programs on the same machine model without any control between.
"""

from __future__ import annotations

import asyncio
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from gearmath.bevel.pair import check_pair, load_pair
from gearmath.control import sinumerik
from gearmath.control.measuring import Measuring
from gearmath.control.run_start import begun
from gearmath.control.simulated.workshop import Workshop
from gearmath.control.store import Run, Store
from gearmath.control.store_evaluation import EvaluatedRun, evaluate_run
from gearmath.machine.control.executor import execute
from gearmath.machine.control.state import Setup
from gearmath.machine.measuring.probe import ProbeMachine
from gearmath.machine.measuring.probe_run import run_touches, touch_count
from gearmath.machine.milling.mill import mill_member
from gearmath.machine.milling.milled_surface import MilledSurface
from gearmath.machine.planning.cut_plan import Job
from gearmath.machine.writing.cutting import cutting_program
from gearmath.machine.writing.probing import probing_program
from gearmath.quality.correction.member import correct
from gearmath.specs.calibration import load_calibration
from gearmath.specs.milling_machine import MillingMachine
from gearmath.specs.set_text import save_corrected
from gearmath.specs.simulated_machine import Probe, SimulatedMachine
from gearmath.specs.toml import bundled

SET, CALIBRATION, MEMBER = "nasa_tp3096_12x36.toml", "probe.toml", "pinion"
RIGHTS = (sinumerik.READ_STATE, sinumerik.WRITE_STATE, sinumerik.READ_ALARMS, sinumerik.READ_FILES)


def _direct(
    gear_set: Path, cut: str, probe: str, machine: MillingMachine, shop: SimulatedMachine, number: int
) -> np.ndarray:
    """X Y Z A B (n,5) of the touches, without a control: what 'gearmath mill' and 'gearmath probe' do."""
    calibration = load_calibration(bundled(CALIBRATION))
    spec = load_pair(gear_set).member(MEMBER)
    quiet = shop.model_copy(update={"probe": Probe()})
    file = mill_member(execute(cut, "CUT.MPF", Setup.of(machine)), spec, MEMBER, machine, quiet)
    metal = MilledSurface(file, spec, MEMBER, "metal")
    there = ProbeMachine(spec, MEMBER, machine, calibration, metal, metal.lowest, shop.measuring_clamp(MEMBER))
    setup = Setup.of(machine, calibration.length)
    text = run_touches(probe, "PROBE.MPF", there, shop, touch_count(probe, "P", setup), number, setup=setup)
    lines = [line.split(",") for line in text.splitlines() if line[:1].isdigit()]
    return np.array([[float(cell) for cell in line[7:12]] for line in lines])


async def _cut_and_probe(live: Any, run: Run, cut: str) -> None:
    """The operator selects and starts; the client only puts, waits and acknowledges."""
    control = await live.connect(*RIGHTS, sinumerik.WRITE_FILES)
    await control.put("CUT.MPF", cut.encode(), replace=True)
    if "Part Program/PROBE.MPF" not in live.nc.files:  # it may be the selected one
        await control.put("PROBE.MPF", run.start.program_text)
    await control.close()
    live.nc.select("Part Program/CUT.MPF")
    live.nc.start()
    await asyncio.to_thread(live.nc.wait, 60)
    assert not live.nc.alarms
    live.nc.select("Part Program/PROBE.MPF")
    measuring = Measuring(
        lambda: live.connect(*RIGHTS), run, say=lambda said: live.nc.start() if "start it" in said else None
    )
    await measuring.to_the_end()


@pytest.mark.slow
def test_the_loop_over_the_control_ends_as_the_direct_one(
    live: Any, tmp_path: Path, vertical: MillingMachine, shop: SimulatedMachine
) -> None:
    workshop = Workshop(vertical, load_calibration(bundled(CALIBRATION)), shop)
    pair = load_pair(bundled(SET))
    text = probing_program(pair, MEMBER, vertical, load_calibration(bundled(CALIBRATION)), "PROBE", pitch=False)
    program = tmp_path / "PROBE.MPF"
    program.write_text(text)
    air, live.nc.machine, live.nc.parameters[102] = live.nc.machine, workshop, 0.0
    corrected, settings, found = tmp_path / "corrected.toml", bundled(SET), []
    try:
        with Store.open(tmp_path / "runs.db") as store:
            for number in (1, 2):
                workshop.load(settings)
                cut = cutting_program(load_pair(settings), MEMBER, vertical, "CUT", Job(range(12)))
                start, _ = begun("control", program, str(settings), "vertical_5axis.toml", CALIBRATION)
                run = store.begin_run(start)
                asyncio.run(_cut_and_probe(live, run, cut))
                direct = _direct(settings, cut, text, vertical, shop, number)
                touches = np.array([touch[1:6] for touch in run.touches().values()])
                np.testing.assert_allclose(touches, direct, rtol=0.0, atol=2e-8)  # the file has nine decimals
                found.append(evaluate_run(run))
                if number == 1:
                    result = correct(pair.member(MEMBER), MEMBER, found[0].file)
                    save_corrected(bundled(SET), corrected, MEMBER, result.settings, result.index, check=check_pair)
                    settings = corrected
    finally:
        live.nc.machine = air
    before, after = (_worst(one) for one in found)
    assert before > 10.0
    assert after < before / 4


def _worst(found: EvaluatedRun) -> float:
    """The largest deviation of a measured point that is not of pitch alone [um]: of the tooth with the topography."""
    file = found.found.file
    whole = file.tooth == 0
    return 1000 * float(np.abs(file.deviation[whole]).max())
