"""Pitch: how evenly the teeth are spaced, from one point at the same place of every tooth.

    s_i = r (θ_i - θ_0 - 2π i/z),   f_pt,i = s_i - s_(i-1),   F_p = max s - min s

with s_z = s_0, so that the f_pt sum to zero. The angles come from the deviations by (6.5); the tooth angles 2π i/z
are already in the nominal points.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from gearmath.bevel.kernels import kernel
from gearmath.errors import InputError
from gearmath.specs.flank_csv import FlankFile


@dataclass(frozen=True)
class Pitch:
    """Pitch of one flank: turning (z,) [rad] and cumulative deviation s (z,) [mm] of every tooth against tooth 0."""

    flank: str
    turning: np.ndarray
    cumulative: np.ndarray

    @property
    def single(self) -> np.ndarray:
        """f_pt of every tooth (z,) [mm]: its cumulative deviation less that of the tooth before."""
        return self.cumulative - np.roll(self.cumulative, 1)

    @property
    def total(self) -> float:
        """F_p [mm]."""
        return float(np.ptp(self.cumulative))


def evaluate_pitch(file: FlankFile, teeth: int, flank: str) -> Pitch | None:
    """Pitch of one flank from the points that every tooth has; None where only one tooth was measured.

    Raises InputError if some, but not all, of the teeth were measured.
    """
    points = file.select(flank)
    measured = np.unique(points.tooth[points.tooth < teeth])  # tooth z is tooth 0 again
    if len(measured) <= 1:
        return None
    if len(measured) != teeth:
        absent = sorted(set(range(teeth)) - set(measured.tolist()))
        raise InputError(
            f"{flank} flank: tooth {absent[0]} was not measured; pitch needs all {teeth} teeth, or one only"
        )
    row, col = reference_point(file)
    here = (points.row == row) & (points.col == col) & (points.tooth < teeth)
    order = np.argsort(points.tooth[here])
    if not np.array_equal(points.tooth[here][order], np.arange(teeth)):
        raise InputError(f"{flank} flank: not every tooth has the reference point, row {row}, col {col}")
    turning, arc = kernel("flank_turning")(
        points.deviation[here][order], points.point[here][order], points.normal[here][order]
    )
    return Pitch(flank, turning - turning[0], arc - arc[0])


def reference_point(file: FlankFile) -> tuple[int, int]:
    """Row and column of the reference point, from the header. Raises InputError if it is no pair of whole numbers."""
    try:
        row, col = (int(part) for part in file.header["reference_point"].split(","))
    except ValueError as error:
        raise InputError(f"reference_point = {file.header['reference_point']!r}: must be 'row,col'") from error
    return row, col


def index_correction(pitches: list[Pitch]) -> np.ndarray:
    """Angle (z,) [rad] by which each space must be turned, the mean of both flanks; tooth 0 stays where it is."""
    return -np.mean([pitch.turning for pitch in pitches], axis=0)
