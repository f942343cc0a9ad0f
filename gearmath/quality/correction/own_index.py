"""Where the tooth that is measured in full stands among the others: its own index is no error of a setting.

Settings are corrected from one tooth. Every flank of it may be indexed otherwise than those of the other teeth, and
that is an error of the indexing. How far it is turned against the mean of the others of its flank is told by the places
that they have too: each of n teeth turned by τ_k, the form at each place p the same,

    d_pk = g_p + c_pk τ_k + noise,   Σ τ_k = 0        c: what a turning about z_w makes of a point (18.2)

and against the others it is turned by τ n/(n - 1). Where that is more than three standard uncertainties its points are
turned back, onto the mean of the others. A tooth that stands far off the others, by its index or its thickness, takes
no part in that mean; nor is a tooth whose form is unlike that of most others taken for the form of the flank.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from gearmath.bevel.turning import turned
from gearmath.kernels import kernel
from gearmath.quality.correction.representative import passed_over, representative_tooth
from gearmath.quality.evaluation.nominal import NominalRows, deviations_of, nominal_rows, with_deviations
from gearmath.quality.evaluation.registration import stated_noise
from gearmath.quality.evaluation.robust import limit_of
from gearmath.quality.evaluation.topography import evaluate_topography, teeth_in_full
from gearmath.specs.bevel_set import FLANKS, Member
from gearmath.specs.flank_csv import FlankFile

#: Of the components of a small motion (18.2): about z_w.
_TURNING = 5
#: So many standard uncertainties, and so long an arc [mm], is a tooth turned for certain.
_SIGNIFICANT, _LEAST = 3.0, 5e-4
#: So many teeth besides make a mean.
_LEAST_TEETH = 3
#: A flank is off the others, in place or form, from this size on. [mm]
LEAST_OFF = 0.01
#: Fewer spare observations say nothing about the noise; then it is told by the tooth, and else this is assumed [mm].
_LEAST_SPARE, _COEFFICIENTS, _UNKNOWN = 3, 10, 1e-3


#: What becomes of an error of the index, of a member whose spaces are indexed one by one and of a hobbed one.
_LEFT = (
    "it is left to the index, and taken out for the settings",
    "it stays, as face hobbing cannot turn one tooth by itself, and is taken out for the settings",
)


@dataclass(frozen=True)
class OwnIndex:
    """How far one flank of a tooth is turned against the mean of the others [rad], how sure that is, and where [mm].

    ``apart`` are the teeth that stand far off the others, and are none of the mean.
    """

    angle: float
    uncertainty: float
    radius: float
    apart: tuple[int, ...] = ()

    @property
    def is_significant(self) -> bool:
        return abs(self.angle) > max(_SIGNIFICANT * self.uncertainty, _LEAST / self.radius)


def teeth_as_indexed_on_average(member: Member, file: FlankFile) -> tuple[FlankFile, tuple[str, ...]]:
    """The file with the tooth measured in full of each flank where the others stand on average, and what was done.

    A flank of which no other teeth were measured stays as it is, and a sentence says so.
    """
    rows = nominal_rows(file, member)
    slope = kernel("motion_sensitivity")(rows.point, rows.normal)[0][:, _TURNING]
    remarks: list[str] = []
    alone: list[str] = []
    for flank in FLANKS:
        if not (file.flank == flank).any():
            continue
        tooth = representative_tooth(file, flank)
        remarks += [said] if (said := passed_over(file, flank)) else []
        found = own_index(file, rows, slope, flank, tooth)
        if found is None:
            alone.append(flank)
            continue
        if found.apart:
            which = "tooth " if len(found.apart) == 1 else "teeth "
            remarks.append(
                f"{flank} flank: without {which}{', '.join(map(str, found.apart))}, far off the others: the settings "
                "are corrected from the mean of the rest"
            )
        if found.is_significant:
            file = _turned_back(file, member, rows, slope, (file.flank == flank) & (file.tooth == tooth), found.angle)
            arc, u = found.angle * found.radius * 1000, found.uncertainty * found.radius * 1000
            remarks.append(
                f"{flank} flank: tooth {tooth} is indexed by an arc of {arc:+.2f} um (u = {u:.2f}) against the mean of "
                f"the others, which is no error of a setting: {_LEFT[member.blade_groups is not None]}"
            )
    if alone:
        remarks.append(
            f"{' and '.join(alone)} flank: fewer than {_LEAST_TEETH + 1} teeth have readings at a common place: if the "
            "tooth measured in full is indexed wrong, the settings are changed for it; measure more teeth"
        )
    return file, tuple(remarks)


def own_index(file: FlankFile, rows: NominalRows, slope: np.ndarray, flank: str, tooth: int) -> OwnIndex | None:
    """How far a flank of a tooth is turned against the mean; None where too few others share places with it."""
    known = (file.flank == flank) & np.isfinite(file.deviation)
    width = int(file.col.max()) + 1
    place = file.row * width + file.col
    known &= np.isin(place, place[known & (file.tooth == tooth)])
    if tooth not in file.tooth[known] or len(np.unique(file.tooth[known])) <= _LEAST_TEETH:
        return None
    apart = _apart(file, rows, slope, known, place, tooth)
    known &= ~np.isin(file.tooth, apart)
    teeth, turning, covariance, left, spare = _turnings(file, slope, known, place)
    if len(teeth) <= _LEAST_TEETH:
        return None
    at = int(np.searchsorted(teeth, tooth))
    noise = np.sqrt(left @ left / spare) if spare >= _LEAST_SPARE else _noise(file, flank, tooth)
    size, to_others = float(noise * np.sqrt(covariance[at, at])), len(teeth) / (len(teeth) - 1)
    radius = float(np.hypot(*rows.point[known, :2].T).mean())
    return OwnIndex(to_others * float(turning[at]), to_others * size, radius, apart)


def near_the_median(values: np.ndarray, least: float) -> np.ndarray:
    """Which values (k,) are not far off most of them: within six of their standard deviations, or ``least``."""
    off = values - np.median(values)
    return np.asarray(np.abs(off) <= limit_of(off, least))


def _apart(
    file: FlankFile, rows: NominalRows, slope: np.ndarray, known: np.ndarray, place: np.ndarray, tooth: int
) -> tuple[int, ...]:
    """The teeth but ``tooth`` that stand far off the median of all, if enough are left without them."""
    teeth, turning, *_ = _turnings(file, slope, known, place)
    least = LEAST_OFF / float(np.hypot(*rows.point[known, :2].T).mean())
    far = ~near_the_median(turning, least) & (teeth != tooth)
    return tuple(teeth[far].tolist()) if len(teeth) - far.sum() > _LEAST_TEETH else ()


def _turnings(
    file: FlankFile, slope: np.ndarray, known: np.ndarray, place: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, int]:
    """Teeth (k,), the turning [rad] of each against the mean of all (k,), its covariance (k,k) for noise of 1 mm, what
    the fit leaves (m,) [mm], and how many observations there are to spare.
    """
    teeth, of_tooth = np.unique(file.tooth[known], return_inverse=True)
    _, of_place = np.unique(place[known], return_inverse=True)
    shared = np.bincount(of_place) > 1
    use = shared[of_place]
    form = (of_place[use, None] == np.flatnonzero(shared)).astype(float)
    turning = (of_tooth[use, None] == np.arange(len(teeth))) * slope[known][use, None]
    turning = turning[:, :-1] - turning[:, -1:] * (np.ones(len(teeth) - 1))  # they add up to nothing
    columns, values = np.hstack([form, turning]), file.deviation[known][use]
    solved, *_ = np.linalg.lstsq(columns, values, rcond=None)
    n = form.shape[1]
    pick = np.hstack([np.zeros((len(teeth), n)), np.vstack([np.eye(len(teeth) - 1), -np.ones(len(teeth) - 1)])])
    covariance = pick @ np.linalg.pinv(columns.T @ columns) @ pick.T
    return teeth, pick @ solved, covariance, values - columns @ solved, len(values) - columns.shape[1]


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
