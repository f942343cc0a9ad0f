"""Runout and tooth thickness: what both flanks together say at their reference points.

Runout is the radial way of a ball that lies in every space (19.1), as if its centre were read by a dial. Thickness is
counted along the circle through the reference points, and straight across between them (19.2, 19.3).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from gearmath.bevel.kernels import kernel
from gearmath.quality.drift import without_drift
from gearmath.quality.pitch import reference_point, reference_rows
from gearmath.specs.bevel_set import FLANKS
from gearmath.specs.flank_csv import FlankFile


@dataclass(frozen=True)
class Runout:
    """Radial shift (z,) [mm] of a ball in every space, and the azimuth (z,) [rad] of the middle of each space."""

    radial: np.ndarray
    azimuth: np.ndarray

    @property
    def total(self) -> float:
        """F_r [mm]."""
        return float(np.nanmax(self.radial) - np.nanmin(self.radial))

    @property
    def eccentricity(self) -> tuple[float, float]:
        """The first harmonic: its amplitude [mm], and the azimuth towards which the spaces lie farther out [rad]."""
        known = np.isfinite(self.radial)
        at = self.azimuth[known]
        columns = np.stack([np.ones(len(at)), np.cos(at), np.sin(at)], axis=1)
        (_, x, y), *_ = np.linalg.lstsq(columns, self.radial[known], rcond=None)
        return float(math.hypot(x, y)), float(math.atan2(y, x))

    def as_dict(self) -> dict[str, Any]:
        size, direction = self.eccentricity
        return {
            "F_r_um": self.total * 1000,
            "first_harmonic_um": size * 1000,
            "first_harmonic_direction_deg": math.degrees(direction),
        }


@dataclass(frozen=True)
class Thickness:
    """Nominal arc and chord [mm] of a tooth at the reference points, and the deviations (m,) [mm] of its arc.

    ``deviation`` has one value for each tooth, the one that follows the space of its number; where not all teeth were
    measured, one for each space, the sum of its two flanks. ``chord_factor`` turns an arc's deviation into the chord's.
    ``radius`` [mm] is that of the transverse circle through the reference points, along which the arc runs.
    """

    arc: float
    chord: float
    deviation: np.ndarray
    chord_factor: float
    radius: float

    @property
    def mean(self) -> float:
        """Mean deviation of the arc [mm]; negative = too thin."""
        return float(np.nanmean(self.deviation))

    def as_dict(self) -> dict[str, Any]:
        return {
            "measured_at": "reference_point",
            "radius_mm": self.radius,
            "arc_mm": self.arc,
            "chord_mm": self.chord,
            "arc_deviation_um": self.mean * 1000,
            "chord_deviation_um": self.mean * self.chord_factor * 1000,
            "range_um": float(np.nanmax(self.deviation) - np.nanmin(self.deviation)) * 1000,
        }


def evaluate_runout(file: FlankFile, teeth: int) -> Runout | None:
    """Runout from the reference points of both flanks of every space; None where not all were measured.

    Raises InputError if some, but not all, of the teeth were measured.
    """
    file, _ = without_drift(file, teeth)
    one, other = (reference_rows(file, teeth, flank) for flank in FLANKS)
    if one is None or other is None:
        return None
    radial, _ = kernel("ball_shift")(
        one.deviation, _nominal(one), one.normal, other.deviation, _nominal(other), other.normal
    )
    (azimuth,) = kernel("space_azimuth")(_nominal(one), _nominal(other))
    return Runout(radial, azimuth)


def evaluate_thickness(file: FlankFile, teeth: int) -> Thickness | None:
    """Thickness of every tooth, or for each space measured that of the tooth it stands for, where not all were.

    None where no space has the reference points of both flanks, with deviations.
    """
    file, _ = without_drift(file, teeth)
    one, other = _pairs(file)
    if not len(one):
        return None
    arc, chord, factor = kernel("tooth_at_points")(_nominal(one)[0], _nominal(other)[0], teeth, 1.0)
    if len(one) == teeth:
        low, high = (one, other) if _comes_first(one, other) else (other, one)
        deviation = _allowance(high) + np.roll(_allowance(low), -1)  # the tooth after a space ends at the next one
    else:
        deviation = _allowance(one) + _allowance(other)
    if not np.isfinite(deviation).any():  # the reference points were left out
        return None
    radius = float(np.hypot(*_nominal(one)[0, :2]))
    return Thickness(float(arc), float(chord), deviation, float(factor), radius)


def _pairs(file: FlankFile) -> tuple[FlankFile, FlankFile]:
    """The reference points of both flanks of every space that has both, by tooth, with a deviation or without."""
    row, col = reference_point(file)
    here = (file.row == row) & (file.col == col)
    of = [here & (file.flank == flank) for flank in FLANKS]
    both = np.intersect1d(file.tooth[of[0]], file.tooth[of[1]])
    one, other = (file.pick(each & np.isin(file.tooth, both)) for each in of)
    return one.pick(np.argsort(one.tooth)), other.pick(np.argsort(other.tooth))


def _comes_first(one: FlankFile, other: FlankFile) -> bool:
    """Whether of the two flanks of a space the first one comes first around z_w."""
    return bool(one.point[0, 0] * other.point[0, 1] > one.point[0, 1] * other.point[0, 0])


def _allowance(points: FlankFile) -> np.ndarray:
    (arc,) = kernel("flank_allowance")(points.deviation, _nominal(points), points.normal)
    return arc


def _nominal(points: FlankFile) -> np.ndarray:
    return points.point - np.nan_to_num(points.deviation)[:, None] * points.normal
