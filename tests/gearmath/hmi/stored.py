"""A store with runs of the NASA pinion: probed on the machine model, on flanks with a known stock."""

from __future__ import annotations

import csv
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from gearmath.control.interface import Alarm, RunStart, Touch
from gearmath.control.store import MeasurementStore
from gearmath.machine.control.state import Setup
from gearmath.machine.measuring.probe import ProbeMachine
from gearmath.machine.measuring.probe_run import run_touches
from gearmath.machine.writing.probing import probing_program
from gearmath.specs.bevel_set import load_bevel_set
from gearmath.specs.calibration import load_calibration
from gearmath.specs.milling_machine import load_milling_machine
from gearmath.specs.simulated_machine import load_simulated_machine
from gearmath.specs.toml import bundled

FILES = {"set.toml": "nasa_tp3096_12x36.toml", "machine.toml": "vertical_5axis.toml", "calibration.toml": "probe.toml"}
#: How much of the stock is left in runs 1 and 2.
SHARES = (1.0, 0.3)
#: Touches of run 3, which an alarm ended.
BROKEN_OFF = 40


def stock(flank: str, tooth: int, place: np.ndarray) -> float:
    """Metal left on [mm]: 1.2 µm for each mm towards the heel on the concave flank, as much less on the convex one."""
    along = 0.0012 * (place[0] - 72.0)
    return 0.003 + (along if flank == "concave" else -along)


@pytest.fixture(scope="session")
def stored_runs(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Run 1: all of the stock. Run 2: 0.3 of it, by another operator. Run 3: of run 2 the first touches, then an
    alarm whose text is a script."""
    pair = load_bevel_set(bundled(FILES["set.toml"]))
    machine = load_milling_machine(bundled(FILES["machine.toml"]))
    probe = load_calibration(bundled(FILES["calibration.toml"]))
    shop = load_simulated_machine(bundled("simulated_shop.toml"))
    program = probing_program(pair, "pinion", machine, probe, "PROBE")
    path = tmp_path_factory.mktemp("stored") / "runs.db"
    with MeasurementStore.open(path) as store:
        for share, operator in zip(SHARES, ("Ann", "Bob"), strict=True):
            member = pair.member("pinion")
            there = ProbeMachine(member, machine, probe, lambda *place, share=share: share * stock(*place), -0.05)
            setup = Setup.of(machine, probe.length)
            text = run_touches(program, "PROBE.MPF", there, shop, 122, setup=setup)
            columns, *rows = csv.reader(line for line in text.splitlines() if not line.startswith("#"))
            places = {int(row[1]): tuple(row[2:7]) for row in rows}
            files = {name: bundled(other).read_bytes() for name, other in FILES.items()}
            start = RunStart(
                "simulated control", "PROBE.MPF", program.encode(), tuple(columns), places, files, FILES, operator
            )
            touches = {int(row[1]): Touch(1, *map(float, row[7:12]), float(row[12])) for row in rows}
            run = store.begin_run(start)
            for point, touch in touches.items():
                run.commit_touch(point, touch)
            run.finish("complete")
        third = store.begin_run(replace(start, operator="<script>alert(1)</script>"))
        for point, touch in list(touches.items())[:BROKEN_OFF]:
            third.commit_touch(point, touch)
        third.add_alarm(Alarm("65001#1", "65001", "<script>alert(2)</script>", 1000, True))
        third.finish("alarm 65001: <script>alert(2)</script>")
        store.execute("PRAGMA wal_checkpoint(TRUNCATE)")
    return path


@pytest.fixture
def own_runs(stored_runs: Path, tmp_path: Path) -> Path:
    """A store of the test's own, in a folder of its own."""
    path = tmp_path / "runs.db"
    path.write_bytes(stored_runs.read_bytes())
    return path
