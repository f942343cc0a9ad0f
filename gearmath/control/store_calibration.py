"""What a stored run on ring and spheres says: the tip of the probe, or the rotary axes, with the files as stored."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from gearmath.control.run_start import CALIBRATION, MACHINE
from gearmath.control.store_evaluation import of_run, stored_files
from gearmath.control.store_run import StoredRun
from gearmath.errors import InputError
from gearmath.quality.calibration.axes import AxisCalibration
from gearmath.quality.calibration.tip import Tip
from gearmath.quality.evaluation.calibrated_run import calibrated_run
from gearmath.specs.calibration import Calibration, load_calibration, save_calibration
from gearmath.specs.milling_machine import load_milling_machine, save_axes


@dataclass(frozen=True)
class StoredCalibration:
    """A calibration run and what it found; ``file`` is the new calibration or machine file, kept as ``role``."""

    run: StoredRun
    known: Calibration
    found: Tip | AxisCalibration
    role: str
    file: bytes


def calibrate_run(run: StoredRun) -> StoredCalibration:
    """As ``gearmath calibrate`` would. Raises InputError for a run that is not whole, and for one without its files."""
    where = f"{run.store.path}: run {run.id}"
    with stored_files(run, (MACHINE, CALIBRATION)) as folder, of_run(where, folder):
        known, machine = load_calibration(folder / CALIBRATION), load_milling_machine(folder / MACHINE)
        made = calibrated_run(folder / "touches.csv", machine, known, run.id, source=CALIBRATION)
        lacking = [*made.missing, *(f"point {point} has no touch" for point in run.missing())]
        if lacking:
            raise InputError(f"is not whole: {lacking[0]}")
        target, found = folder / "found.toml", made.found
        if isinstance(found, AxisCalibration):
            role = MACHINE
            save_axes(folder / MACHINE, target, found.pivot_offset, found.gauge_line_height)
        else:
            role = CALIBRATION
            save_calibration(folder / CALIBRATION, target, found.radius, found.offset, found.lobes)
        return StoredCalibration(run, known, found, role, Path(target).read_bytes())
