"""Pitch: how evenly the teeth are spaced, from one point at the same place of every tooth.

    s_i = r (θ_i - θ_0 - 2π i/z),   f_pt,i = s_i - s_(i-1),   F_p = max s - min s

with s_z = s_0, so that the f_pt sum to zero. The angles come from the deviations by (6.5); the tooth angles 2π i/z
are already in the nominal points. Tooth 0 measured again at the end shows the drift, which is taken out beforehand.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from gearmath.bevel.turning import turned
from gearmath.errors import InputError
from gearmath.kernels import kernel
from gearmath.quality.evaluation.drift import without_drift
from gearmath.specs.bevel_set import FLANKS
from gearmath.specs.flank_csv import FlankFile, join

#: How many teeth without a reading are named.
_NAMED = 5
#: Part of the teeth without a reading, beyond which the others do not tell how they are indexed.
_MOST_MISSING = 0.2


@dataclass(frozen=True)
class Pitch:
    """Pitch of one flank: turning (z,) [rad] and cumulative deviation s (z,) [mm] of every tooth against tooth 0.

    Both are NaN for a tooth without a reading; where there is one, the maxima are NaN too. ``drift`` is the arc [mm] by
    which tooth 0 had moved when it was measured again, None where it was not. ``reason`` says why there are no maxima
    although every tooth has a reading; None where there is nothing to say.
    """

    flank: str
    turning: np.ndarray
    cumulative: np.ndarray
    drift: float | None = None
    reason: str | None = None

    @property
    def single(self) -> np.ndarray:
        """f_pt of every tooth (z,) [mm]: its cumulative deviation less that of the tooth before."""
        return self.cumulative - np.roll(self.cumulative, 1)

    @property
    def total(self) -> float:
        """F_p [mm]; NaN where it is withheld."""
        return math.nan if self.reason else float(self.cumulative.max() - self.cumulative.min())

    @property
    def largest_single(self) -> float:
        """The f_pt that is largest in size, without its sign [mm]; NaN where it is withheld."""
        return math.nan if self.reason else float(np.abs(self.single).max())

    @property
    def nearly_whole(self) -> bool:
        """Whether no more than a fifth of the teeth have no reading."""
        return bool(np.isnan(self.cumulative).mean() <= _MOST_MISSING)

    @property
    def withheld(self) -> str | None:
        """Why there are no maxima; None where every tooth has a reading and nothing else is wrong."""
        return self.reason or no_reading(f"{self.flank} flank", "tooth", np.isnan(self.cumulative))

    def as_dict(self) -> dict[str, Any]:
        """Figures for people and programs, in µm; None for what was not measured or is withheld."""
        values = [None if np.isnan(value) or self.reason else float(value) * 1000 for value in self.cumulative]
        known = self.withheld is None
        return {
            "F_p_um": self.total * 1000 if known else None,
            "max_f_pt_um": self.largest_single * 1000 if known else None,
            "cumulative_um": values,
            "drift_um": None if self.drift is None else self.drift * 1000,
        }


def no_reading(where: str, what: str, missing: np.ndarray) -> str | None:
    """A sentence on which of the teeth or spaces (z,) have no reading; None where all have one."""
    which = np.flatnonzero(missing).tolist()
    if not which:
        return None
    named, more = ", ".join(map(str, which[:_NAMED])), len(which) - _NAMED
    many = {"tooth": "teeth", "space": "spaces"}[what] if len(which) > 1 else what
    rest = f" and {more} more" if more > 0 else ""
    return f"{where}: no reading of {many} {named}{rest} ({len(which)} of {len(missing)})"


def evaluate_pitch(file: FlankFile, teeth: int, flank: str) -> Pitch | None:
    """Pitch of one flank from the reference points of its teeth; None where fewer than two have a reading."""
    file, drifts = without_drift(file, teeth)
    points = reference_rows(file, teeth, flank)
    if points is None:
        return None
    turning, arc = kernel("flank_turning")(points.deviation, points.point, points.normal)
    start = int(np.argmax(np.isfinite(arc)))  # tooth 0, or the first that has a deviation
    drift = None
    if flank in drifts:
        (_, moved) = kernel("flank_turning")(drifts[flank].closure, points.point[0], points.normal[0])
        drift = float(moved)
    return Pitch(flank, turning - turning[start], arc - arc[start], drift)


def pitch_uncertainties(file: FlankFile, teeth: int, noise: float) -> dict[str, float]:
    """Standard uncertainty [mm] of the pitch from one tooth to another, of each flank, by ``noise`` [mm] of a point.

    Without what taking out the clamping adds to it or takes off.
    """
    found = {}
    for flank in FLANKS:
        points = reference_rows(file, teeth, flank)
        if points is not None:
            _, arc = kernel("flank_turning")(np.ones(teeth), points.point, points.normal)
            found[flank] = float(np.sqrt(2) * noise * np.abs(arc).max())
    return found


def reference_rows(file: FlankFile, teeth: int, flank: str) -> FlankFile | None:
    """The reference point of every tooth, by tooth, nominal and silent where there is none.

    None where fewer than two teeth have a reading there. Tooth 0 measured again is not among them.
    """
    row, col = reference_point(file)
    points = file.select(flank)
    points = points.pick((points.row == row) & (points.col == col) & (points.tooth < teeth))
    if np.isfinite(points.deviation).sum() < 2:
        return None
    points = points.pick(np.argsort(points.tooth))
    absent = np.setdiff1d(np.arange(teeth), points.tooth)
    if not len(absent):
        return points
    first = points.pick(np.zeros(len(absent), dtype=int))
    turn = 2 * np.pi * (absent - first.tooth) / teeth
    nominal = first.point - np.nan_to_num(first.deviation)[:, None] * first.normal
    silent = np.full(len(absent), np.nan)
    added = replace(
        first,
        tooth=absent,
        point=turned(nominal, turn),
        normal=turned(first.normal, turn),
        deviation=silent,
        uncertainty=silent,
    )
    both = join([points, added])
    return both.pick(np.argsort(both.tooth))


def reference_point(file: FlankFile) -> tuple[int, int]:
    """Row and column of the reference point, from the header. Raises InputError if it is no pair of whole numbers."""
    try:
        row, col = (int(part) for part in file.header["reference_point"].split(","))
    except ValueError as error:
        raise InputError(f"reference_point = {file.header['reference_point']!r}: must be 'row,col'") from error
    return row, col


def index_correction(pitches: list[Pitch]) -> np.ndarray:
    """Angle (z,) [rad] by which each space must be turned, the mean of both flanks; tooth 0 stays where it is.

    A tooth that was measured on one flank only is told by that; one that was not at all lies between its neighbours.
    Raises InputError where no tooth was measured on all flanks.
    """
    turning = np.stack([pitch.turning for pitch in pitches])
    known = np.isfinite(turning)
    if not known.all(axis=0).any():
        raise InputError("pitch: no tooth was measured on both flanks, so that they cannot be compared")
    turning -= turning[:, known.all(axis=0)].mean(axis=1, keepdims=True)
    teeth, count = np.arange(turning.shape[1]), known.sum(axis=0)
    mean = np.where(known, turning, 0.0).sum(axis=0) / np.maximum(count, 1)
    mean = np.interp(teeth, teeth[count > 0], mean[count > 0], period=len(teeth))
    return mean[0] - mean
