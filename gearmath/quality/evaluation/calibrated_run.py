"""A run of the probe on ring and spheres, from its file of raw touches to the tip, or to the rotary axes."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from gearmath.errors import InputError, about
from gearmath.quality.calibration.axes import AxisCalibration, calibrate_axes
from gearmath.quality.calibration.tip import Tip, calibrate_tip
from gearmath.quality.evaluation.completeness import missing_calibration
from gearmath.specs.calibration import Calibration
from gearmath.specs.milling_machine import MillingMachine
from gearmath.specs.touch_csv import WORK_SPHERE, CalibrationTouches, check_whole, read_calibration_csv


@dataclass(frozen=True)
class CalibratedRun:
    """What a run on ring and spheres found; what is missing of it, in sentences."""

    touches: CalibrationTouches
    found: Tip | AxisCalibration
    missing: tuple[str, ...]


def calibrated_run(
    raw: Path,
    machine: MillingMachine,
    calibration: Calibration,
    run: int | None = None,
    lobing: bool = False,
    source: str = "the calibration",
) -> CalibratedRun:
    """The tip from touches on sphere or ring, the rotary axes from those on the work side's sphere, by default of the
    last run of the file; ``source`` is what messages call the calibration.

    Raises InputError where the last run is not whole, and where its touches are not those of these artefacts.
    """
    touches = read_calibration_csv(raw, run)
    parts, untouched = missing_calibration(touches, calibration, machine)
    check_whole(raw, run, touches, parts)
    on_work = bool((touches.target == WORK_SPHERE).any())
    if on_work and lobing:
        raise InputError(f"{raw}: lobing needs touches on the sphere of the table; these are on that of the work")
    with about(raw):
        found: Tip | AxisCalibration
        if on_work:
            found = calibrate_axes(touches, machine, calibration)
        else:
            found = calibrate_tip(touches, calibration, lobing, source)
    return CalibratedRun(touches, found, (*parts, *untouched))
