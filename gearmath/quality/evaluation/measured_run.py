"""A run of the probe, from its file of raw touches to measured points."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from gearmath.bevel.flank import Grid, blank_grid
from gearmath.errors import about
from gearmath.quality.evaluation.completeness import missed_points, missing_touches
from gearmath.quality.evaluation.search_lines import check_search_lines
from gearmath.quality.evaluation.touches import check_on_grid, measured_member
from gearmath.specs.bevel_set import BevelSet
from gearmath.specs.calibration import Calibration
from gearmath.specs.flank_csv import FlankFile
from gearmath.specs.milling_machine import MillingMachine
from gearmath.specs.touch_csv import Touches, check_whole, read_touch_csv


@dataclass(frozen=True)
class MeasuredRun:
    """The measured points of a run; what is missing of it, what the probe missed, and a doubt, in sentences."""

    touches: Touches
    grid: Grid
    file: FlankFile
    missing: tuple[str, ...]
    missed: tuple[str, ...]
    doubt: str


def measured_run(
    raw: Path, pair: BevelSet, machine: MillingMachine, calibration: Calibration, run: int | None = None
) -> MeasuredRun:
    """Corrected contact points and deviations of a run of raw touches, by default the last one of the file.

    Raises InputError where the last run is not whole, and where touches are not those of the member.
    """
    found = read_touch_csv(raw, run)
    member = pair.member(found.member)
    grid = blank_grid(member)
    missing = missing_touches(found, member.teeth, grid.shape)
    check_whole(raw, run, found, missing)
    with about(raw):
        check_on_grid(found, member, grid)
        doubt = check_search_lines(found, member, grid, machine, calibration)
        file = measured_member(found, member, machine, calibration)
    return MeasuredRun(found, grid, file, missing, missed_points(found), doubt or "")
