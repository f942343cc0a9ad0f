"""The whole loop over OPC UA: put, cut, probe with the handshake, store, evaluate, correct, put, cut, probe.

The direct loop runs the same programs on the same machine model without any control between.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from gearmath.bevel.pair import load_pair
from gearmath.control.store import MeasurementStore
from gearmath.control_demo import run_control_demo
from gearmath.machine.control.executor import execute
from gearmath.machine.control.state import Setup
from gearmath.machine.measuring.probe import ProbeMachine
from gearmath.machine.measuring.probe_run import run_touches, touch_count
from gearmath.machine.milling.mill import mill_member
from gearmath.machine.milling.milled_surface import MilledSurface
from gearmath.specs.calibration import load_calibration
from gearmath.specs.milling_machine import MillingMachine
from gearmath.specs.simulated_machine import Probe, SimulatedMachine
from gearmath.specs.toml import bundled

SET, CALIBRATION, MEMBER = "nasa_tp3096_12x36.toml", "probe.toml", "pinion"


def _direct(
    gear_set: Path, cut: str, probe: str, machine: MillingMachine, shop: SimulatedMachine, number: int
) -> np.ndarray:
    """X Y Z A B (n,5) of the touches, without a control: what 'gearmath mill' and 'gearmath probe' do."""
    calibration = load_calibration(bundled(CALIBRATION))
    spec = load_pair(gear_set).member(MEMBER)
    quiet = shop.model_copy(update={"probe": Probe()})
    file = mill_member(execute(cut, "CUT.MPF", Setup.of(machine)), spec, machine, quiet)
    metal = MilledSurface(file, spec, "metal")
    there = ProbeMachine(spec, machine, calibration, metal, metal.lowest, shop.measuring_clamp(MEMBER))
    setup = Setup.of(machine, calibration.length)
    text = run_touches(probe, "PROBE.MPF", there, shop, touch_count(probe, "P", setup), number, setup=setup)
    lines = [line.split(",") for line in text.splitlines() if line[:1].isdigit()]
    return np.array([[float(cell) for cell in line[7:12]] for line in lines])


@pytest.mark.slow
def test_the_loop_over_the_control_ends_as_the_direct_one(
    tmp_path: Path, vertical: MillingMachine, shop: SimulatedMachine
) -> None:
    """Encrypted, from an empty store to the second measurement: what ``gearmath demo --control`` does."""
    said: list[str] = []
    passes = run_control_demo(tmp_path / "demo", said.append)
    for number, one in enumerate(passes, 1):
        settings = bundled(SET) if number == 1 else tmp_path / "demo" / "pinion_corrected.toml"
        cut, probe = ((tmp_path / "demo" / name).read_text() for name in (f"CUT_{number}.MPF", "PROBE.MPF"))
        direct = _direct(settings, cut, probe, vertical, shop, number)
        with MeasurementStore.open(tmp_path / "demo" / "runs.db", create=False) as store:
            touches = np.array([touch[1:6] for touch in store.run(number).touches().values()])
            assert store.run(number).is_complete
        np.testing.assert_allclose(touches, direct, rtol=0.0, atol=2e-8)  # the file has nine decimals
        assert one.evaluated.run.id == number
    before, after = (1000 * one.largest for one in passes)
    assert before > 10.0
    assert after < before / 4
    assert not [line for line in said if "Error" in line]
