"""Where the tooth that is measured in full stands among the others: its own index is no error of a setting.

Settings are corrected from one tooth. Every flank of it may be indexed otherwise than those of the other teeth, and
that is an error of the indexing. How far it is turned against the mean of the others of its flank is told by the places
that they have too: each of n teeth turned by τ_k, the form at each place p the same,

    d_pk = g_p + c_pk τ_k + noise,   Σ τ_k = 0        c: what a turning about z_w makes of a point (18.2)

and against the others it is turned by τ n/(n - 1). Where that is more than three standard uncertainties its points are
turned back, onto the mean of the others.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from gearmath.bevel.turning import turned
from gearmath.kernels import kernel
from gearmath.quality.nominal import NominalRows, deviations_of, nominal_rows, with_deviations
from gearmath.quality.registration import stated_noise
from gearmath.quality.topography import evaluate_topography, teeth_in_full
from gearmath.specs.bevel_set import FLANKS, Member
from gearmath.specs.flank_csv import FlankFile

#: Of the components of a small motion (18.2): about z_w.
_TURNING = 5
#: So many standard uncertainties, and so long an arc [mm], is a tooth turned for certain.
_SIGNIFICANT, _LEAST = 3.0, 5e-4
#: So many teeth besides make a mean.
_LEAST_TEETH = 3
#: Fewer spare observations say nothing about the noise; then it is told by the tooth, and else this is assumed [mm].
_LEAST_SPARE, _COEFFICIENTS, _UNKNOWN = 3, 10, 1e-3


@dataclass(frozen=True)
class OwnIndex:
    """How far one flank of a tooth is turned against the mean of the others [rad], how sure that is, and where [mm]."""

    angle: float
    uncertainty: float
    radius: float

    @property
    def is_significant(self) -> bool:
        return abs(self.angle) > max(_SIGNIFICANT * self.uncertainty, _LEAST / self.radius)


def teeth_as_indexed_on_average(member: Member, name: str, file: FlankFile) -> tuple[FlankFile, tuple[str, ...]]:
    """The file with the tooth measured in full of each flank where the others stand on average, and what was done.

    A flank of which no other teeth were measured stays as it is, and a sentence says so.
    """
    rows = nominal_rows(file, member, name)
    slope = kernel("motion_sensitivity")(rows.point, rows.normal)[0][:, _TURNING]
    remarks: list[str] = []
    alone: list[str] = []
    for flank in FLANKS:
        teeth, counts = np.unique(file.tooth[file.flank == flank], return_counts=True)
        if not len(teeth):
            continue
        tooth = int(teeth[np.argmax(counts)])
        found = own_index(file, rows, slope, flank, tooth)
        if found is None:
            alone.append(flank)
        elif found.is_significant:
            file = _turned_back(file, member, rows, slope, (file.flank == flank) & (file.tooth == tooth), found.angle)
            arc, u = found.angle * found.radius * 1000, found.uncertainty * found.radius * 1000
            remarks.append(
                f"{flank} flank: tooth {tooth} is indexed by an arc of {arc:+.2f} um (u = {u:.2f}) against the mean of "
                "the others, which is no error of a setting; the settings are corrected as if it stood there"
            )
    if alone:
        remarks.append(
            f"{' and '.join(alone)} flank: fewer than {_LEAST_TEETH + 1} teeth have readings at a common place: an "
            "indexing error of the tooth measured in full would count as an error of the settings"
        )
    return file, tuple(remarks)


def own_index(file: FlankFile, rows: NominalRows, slope: np.ndarray, flank: str, tooth: int) -> OwnIndex | None:
    """How far a flank of a tooth is turned against the mean; None where too few others share places with it."""
    known = (file.flank == flank) & np.isfinite(file.deviation)
    width = int(file.col.max()) + 1
    place = file.row * width + file.col
    known &= np.isin(place, place[known & (file.tooth == tooth)])
    teeth, of_tooth = np.unique(file.tooth[known], return_inverse=True)
    if len(teeth) <= _LEAST_TEETH or tooth not in teeth:
        return None
    _, of_place = np.unique(place[known], return_inverse=True)
    shared = np.bincount(of_place) > 1
    use = shared[of_place]
    form = (of_place[use, None] == np.flatnonzero(shared)).astype(float)
    turning = (of_tooth[use, None] == np.arange(len(teeth))) * slope[known][use, None]
    turning = turning[:, :-1] - turning[:, -1:] * (np.ones(len(teeth) - 1))  # they add up to nothing
    columns, values = np.hstack([form, turning]), file.deviation[known][use]
    solved, *_ = np.linalg.lstsq(columns, values, rcond=None)
    left, spare = values - columns @ solved, len(values) - columns.shape[1]
    at, n = int(np.searchsorted(teeth, tooth)), form.shape[1]
    pick = np.append(np.zeros(n), np.eye(len(teeth))[at, :-1] - np.eye(len(teeth))[at, -1])
    noise = np.sqrt(left @ left / spare) if spare >= _LEAST_SPARE else _noise(file, flank, tooth)
    size = float(noise * np.sqrt(pick @ np.linalg.pinv(columns.T @ columns) @ pick))
    to_others = len(teeth) / (len(teeth) - 1)
    return OwnIndex(
        to_others * float(pick @ solved), to_others * size, float(np.hypot(*rows.point[known][use, :2].T).mean())
    )


def _noise(file: FlankFile, flank: str, tooth: int) -> float:
    """Noise of one point [mm]: as the file states it, or what a surface of third degree leaves of the tooth."""
    if math.isfinite(stated := stated_noise(file)):
        return stated
    if tooth not in teeth_in_full(file, flank):
        return _UNKNOWN
    residual = evaluate_topography(file, flank, tooth).residual
    known = np.isfinite(residual)
    return float(np.sqrt(np.sum(residual[known] ** 2) / max(int(known.sum()) - _COEFFICIENTS, 1)))


def _turned_back(
    file: FlankFile, member: Member, rows: NominalRows, slope: np.ndarray, here: np.ndarray, angle: float
) -> FlankFile:
    """The file with the points (n,) that are ``here`` turned back, against the exact nominal surface."""
    touched = with_deviations(file, rows, file.deviation).point
    there = np.where(here[:, None], turned(touched, -angle), touched)
    expected = np.nan_to_num(file.deviation) - slope * angle * here
    moved = deviations_of(file, member, rows, there, expected)
    return with_deviations(file, rows, np.where(here, moved, file.deviation))
