"""Runout and tooth thickness: what both flanks together say at their reference points.

Runout is how far a ball is moved along the normal of the pitch cone when it is pressed into every space (19.1); uneven
indexing does not move it. Being a range, it is more than nothing for a perfect gear: what noise of the points alone
would make of it is said beside it. Thickness is counted along the circle through the reference points, and straight
across between them (19.2, 19.3).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from gearmath.kernels import kernel
from gearmath.quality.evaluation.drift import without_drift
from gearmath.quality.evaluation.pitch import no_reading, reference_point, reference_rows
from gearmath.quality.evaluation.registration import Registration, known_um
from gearmath.specs.bevel_set import FLANKS
from gearmath.specs.flank_csv import FlankFile

#: Spaces that a mean and a harmonic need.
_HARMONIC = 3
#: Of noise alone: its mean range to about half of a hundredth.
_DRAWS = 4000


@dataclass(frozen=True)
class Runout:
    """Movement (z,) [mm] of a ball in every space, normal to the pitch cone, and the azimuth (z,) [rad] of the space.

    Both flanks of every space are needed for F_r. ``covariance`` (z,z) [mm²] is that of the movements, NaN where the
    noise of a point is not known. ``reason`` says why there is no F_r although every space has a reading.
    """

    shift: np.ndarray
    azimuth: np.ndarray
    covariance: np.ndarray
    reason: str | None = None

    @property
    def total(self) -> float:
        """F_r [mm]; NaN where it is withheld."""
        return math.nan if self.reason else float(self.shift.max() - self.shift.min())

    @property
    def withheld(self) -> str | None:
        """Why there is no F_r; None where every space has a reading and nothing else is wrong."""
        return self.reason or no_reading("both flanks", "space", np.isnan(self.shift))

    @cached_property
    def uncertainty(self) -> float:
        """Standard uncertainty of F_r [mm]: its spread under noise of this size. NaN where it is not known."""
        return float(np.ptp(self.shift + self._noise, axis=1).std())

    @cached_property
    def of_noise(self) -> tuple[float, float]:
        """F_r of a perfect gear measured with this noise: mean and standard deviation [mm], NaN where not known."""
        ranges = np.ptp(self._noise, axis=1)
        return float(ranges.mean()), float(ranges.std())

    @cached_property
    def _noise(self) -> np.ndarray:
        """Movements (draws,z) [mm] by noise alone, NaN where F_r is withheld or the noise is not known."""
        if self.withheld is not None or not np.isfinite(self.covariance).all():
            return np.full((1, len(self.shift)), math.nan)
        sizes, axes = np.linalg.eigh(self.covariance)
        normal = np.random.default_rng(0).standard_normal((_DRAWS, len(sizes)))
        return (normal * np.sqrt(np.maximum(sizes, 0.0))) @ axes.T

    @property
    def mostly_noise(self) -> bool | None:
        """Whether the square of F_r is to more than half that of noise alone; None where this is not known."""
        mean = self.of_noise[0]
        return None if math.isnan(mean) else bool(self.total**2 < 2 * mean**2)

    @property
    def eccentricity(self) -> tuple[float, float]:
        """The first harmonic: its amplitude [mm], and the azimuth towards which the balls lie farther out [rad].

        NaN where fewer than three spaces have a reading.
        """
        known = np.isfinite(self.shift)
        if known.sum() < _HARMONIC:
            return math.nan, math.nan
        at = self.azimuth[known]
        columns = np.stack([np.ones(len(at)), np.cos(at), np.sin(at)], axis=1)
        (_, x, y), *_ = np.linalg.lstsq(columns, self.shift[known], rcond=None)
        return float(math.hypot(x, y)), float(math.atan2(y, x))

    def as_dict(self) -> dict[str, Any]:
        """Figures for people and programs: µm and degrees; None for what is withheld, with the reason, or not known."""
        size, direction = self.eccentricity
        values = {
            "F_r_um": self.total * 1000,
            "u_F_r_um": self.uncertainty * 1000,
            "F_r_of_noise_um": self.of_noise[0] * 1000,
            "F_r_of_noise_spread_um": self.of_noise[1] * 1000,
            "first_harmonic_um": size * 1000,
            "first_harmonic_direction_deg": math.degrees(direction),
        }
        known = {key: value if math.isfinite(value) else None for key, value in values.items()}
        if known_um(values["u_F_r_um"]) is None:  # nothing says how sure the points are
            known |= dict.fromkeys(("u_F_r_um", "F_r_of_noise_um", "F_r_of_noise_spread_um"))
        withheld = {} if self.withheld is None else {"F_r": self.withheld}
        return {**known, "mostly_noise": self.mostly_noise, "withheld": withheld}


@dataclass(frozen=True)
class Thickness:
    """Nominal arc and chord [mm] of one of ``teeth`` at the reference points, the deviations (m,) [mm] of its arc.

    ``deviation`` has one value for each tooth, the one that follows the space of its number; where not all teeth were
    measured, one for each space, the sum of its two flanks. ``chord_factor`` turns an arc's deviation into the chord's.
    ``radius`` [mm] is that of the transverse circle through the reference points, along which the arc runs. ``reason``
    says why there is no range although every tooth has a reading.
    """

    arc: float
    chord: float
    deviation: np.ndarray
    chord_factor: float
    teeth: int
    radius: float
    reason: str | None = None

    @property
    def mean(self) -> float:
        """Mean deviation of the arc over the teeth that have a reading [mm]; negative = too thin."""
        return float(np.nanmean(self.deviation))

    @property
    def withheld(self) -> str | None:
        """Why there is no range over the teeth; None where every tooth has a reading and nothing else is wrong."""
        if self.reason:
            return self.reason
        known = int(np.isfinite(self.deviation).sum())
        return None if known == self.teeth else f"thickness was measured of {known} of {self.teeth} teeth"

    def as_dict(self) -> dict[str, Any]:
        return {
            "measured_at": "reference_point",
            "radius_mm": self.radius,
            "arc_mm": self.arc,
            "chord_mm": self.chord,
            "arc_deviation_um": self.mean * 1000,
            "chord_deviation_um": self.mean * self.chord_factor * 1000,
            "range_um": None if self.withheld else float(np.ptp(self.deviation)) * 1000,
            "withheld": {"range": self.withheld} if self.withheld else {},
        }


def evaluate_runout(
    file: FlankFile, teeth: int, pitch_angle: float, noise: float = math.nan, seat: Registration | None = None
) -> Runout | None:
    """Runout from the reference points of both flanks of every space; None where fewer than two have both.

    ``pitch_angle`` is in rad, ``noise`` [mm] the standard deviation of one point; where ``seat`` was found in the same
    points and taken out of them, what noise did to it is taken into account.
    """
    file, _ = without_drift(file, teeth)
    one, other = (reference_rows(file, teeth, flank) for flank in FLANKS)
    if one is None or other is None:
        return None
    first, second = ((rows.deviation, _nominal(rows), rows.normal) for rows in (one, other))
    shift, _ = kernel("ball_shift")(*first, *second, pitch_angle)
    if np.isfinite(shift).sum() < 2:
        return None
    (azimuth,) = kernel("space_azimuth")(first[1], second[1])
    by_one, by_other = (
        kernel("ball_shift")(a, *first[1:], b, *second[1:], pitch_angle)[0] for a, b in ((1.0, 0.0), (0.0, 1.0))
    )
    slope = np.zeros((teeth, len(file)))
    places = {key: k for k, key in enumerate(zip(file.flank, file.tooth, file.row, file.col, strict=True))}
    for rows, by in ((one, by_one), (other, by_other)):
        for i in range(teeth):
            k = places.get((rows.flank[i], rows.tooth[i], rows.row[i], rows.col[i]))
            if k is not None:
                slope[i, k] = by[i]
    if seat is not None:
        slope = slope - (slope @ seat.columns) @ seat.gain
    return Runout(shift, azimuth, noise**2 * slope @ slope.T)


def evaluate_thickness(file: FlankFile, teeth: int) -> Thickness | None:
    """Thickness of every tooth, or for each space measured that of the tooth it stands for, where not all were.

    None where no space has a reading at the reference points of both flanks.
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
    if not np.isfinite(deviation).any():
        return None
    radius = float(np.hypot(*_nominal(one)[0, :2]))
    return Thickness(float(arc), float(chord), deviation, float(factor), teeth, radius)


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
