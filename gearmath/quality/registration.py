"""Registration: how the work sat when it was measured, found in its own points, and taken out of them.

The unknown seat (16.6), eccentricity and tilt, is fitted by Gauss-Newton on the exact transform: measured points are
brought back into the work by (18.1) and judged against the exact nominal surface. Left free, and so never taken for
clamping, are the mean deviation of every point of the grid over the teeth (form, settings, axial position) and the
turning of every tooth (pitch). Of the pitch, the most general model that the points allow is used: every flank of
every tooth free; both flanks of a space turned together; the same without tilt. Chapter 18 says what each can tell.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from gearmath.bevel.kernels import kernel
from gearmath.errors import ComputationError, InputError
from gearmath.quality.axial import Axial, axial_shift
from gearmath.quality.nominal import NominalRows, check_points, distance_from_flank, nominal_rows
from gearmath.specs.bevel_set import FLANKS, Member
from gearmath.specs.flank_csv import FlankFile

#: Teeth that a registration needs, or all where there are fewer.
LEAST_TEETH = 8
#: A seat is told from the points where its standard uncertainty is at most this many times that of one touch.
_MOST_AMPLIFIED = 5.0
_ITERATIONS, _CONVERGED = 12, 1e-9
#: Where tilt is not told: a tilt of 10 µm per 100 mm may pass for this much eccentricity. [mm, rad]
_MOST_FEIGNED, _SMALL_TILT = 0.005, 1e-4
#: The teeth must not leave out more of a turn than this. [rad]
_WIDEST_GAP = math.radians(120)
#: Fewer spare observations than this say nothing about the noise.
_LEAST_SPARE = 3


@dataclass(frozen=True)
class Registration:
    """How the work sat, and the file without it.

    ``seat`` (4,): eccentricity along x_w and y_w [mm], tilt about x_w and y_w [rad], at the pitch apex; ``covariance``
    (4,4) of it, NaN where ``tilt_found`` is False. ``noise`` [mm] is the standard deviation of one point that the fit
    leaves, with ``spare`` observations more than unknowns. ``removed`` (n,) [mm] is what was taken off each deviation.
    ``index_model`` says what was left free of the pitch; ``remarks`` what the points could not tell.
    """

    file: FlankFile
    seat: np.ndarray
    covariance: np.ndarray
    tilt_found: bool
    index_model: str
    noise: float
    spare: int
    singular_values: np.ndarray
    removed: np.ndarray
    axial_position: Axial
    remarks: tuple[str, ...]

    @property
    def eccentricity(self) -> float:
        """[mm]"""
        return float(math.hypot(*self.seat[:2]))

    @property
    def eccentricity_direction(self) -> float:
        """Azimuth in the work towards which it is moved [rad]."""
        return float(math.atan2(self.seat[1], self.seat[0]))

    @property
    def tilt(self) -> float:
        """[rad]"""
        return float(math.hypot(*self.seat[2:]))

    @property
    def tilt_direction(self) -> float:
        """Azimuth in the work of the axis about which it is tilted [rad]."""
        return float(math.atan2(self.seat[3], self.seat[2]))

    @property
    def axial(self) -> float:
        """Axial shift that would explain the mean form best [mm]; never taken out, see :class:`Axial`."""
        return self.axial_position.shift

    @property
    def uncertainty(self) -> np.ndarray:
        """Standard uncertainties (4,) of ``seat``."""
        return np.sqrt(np.diag(self.covariance))

    @property
    def eccentricity_uncertainty(self) -> float:
        return _along(self.covariance[:2, :2], self.eccentricity_direction)

    @property
    def tilt_uncertainty(self) -> float:
        return _along(self.covariance[2:, 2:], self.tilt_direction)

    def as_dict(self) -> dict[str, Any]:
        """Figures for people and programs: µm and degrees, None where the points do not tell."""
        return {
            "eccentricity_um": self.eccentricity * 1000,
            "u_eccentricity_um": _or_none(self.eccentricity_uncertainty * 1000),
            "eccentricity_direction_deg": math.degrees(self.eccentricity_direction),
            "tilt_um_per_100mm": self.tilt * 1e5 if self.tilt_found else None,
            "u_tilt_um_per_100mm": _or_none(self.tilt_uncertainty * 1e5),
            "tilt_direction_deg": math.degrees(self.tilt_direction) if self.tilt_found else None,
            "noise_um": _or_none(self.noise * 1000),
            "largest_removed_um": float(np.abs(self.removed).max() * 1000),
            "index_model": self.index_model,
            "axial": self.axial_position.as_dict(),
            "remarks": list(self.remarks),
        }


@dataclass(frozen=True)
class _Model:
    """Columns (n,p) of the seat, freed of all that is left free, and how much of the data (n,) is spent on that."""

    columns: np.ndarray
    free: np.ndarray
    found: tuple[int, ...]
    name: str
    remarks: tuple[str, ...]


_EACH_FLANK, _BOTH_FLANKS = "every flank of every tooth", "every tooth, both flanks alike"
_TOGETHER = "both flanks of a space are taken as indexed together: the points do not tell more"


def register(file: FlankFile, member: Member, name: str) -> Registration:
    """The seat of a measured member, and its file without it.

    Points without a deviation are carried along and take no part. Raises InputError for too few teeth, a single flank,
    or points that do not tell the eccentricity; ComputationError if no seat explains them.
    """
    rows = nominal_rows(file, member, name)
    check_points(file, rows)
    _check_teeth(file, rows, member)
    used = np.isfinite(file.deviation)
    columns = kernel("motion_sensitivity")(rows.point, rows.normal)[0]
    model = _choose(file, rows, columns, used, member)
    seat, deviation, left = _fit(file, rows, columns, used, model, member)
    spare = int(used.sum()) - model.free.shape[1] - len(model.found)
    noise = math.sqrt(float(left @ left) / spare) if spare >= _LEAST_SPARE else _stated(file)
    covariance = np.full((4, 4), np.nan)
    scaled = np.linalg.inv(model.columns.T @ model.columns)
    covariance[np.ix_(model.found, model.found)] = noise**2 * scaled
    registered = replace(file, point=rows.point + np.nan_to_num(deviation)[:, None] * rows.normal, deviation=deviation)
    return Registration(
        registered, seat, covariance, len(model.found) == 4, model.name, noise, spare,
        np.linalg.svd(model.columns * _sizes(member)[list(model.found)], compute_uv=False),
        np.nan_to_num(file.deviation - deviation), axial_shift(registered, member, name, rows, columns), model.remarks,
    )  # fmt: skip


def _check_teeth(file: FlankFile, rows: NominalRows, member: Member) -> None:
    least = min(LEAST_TEETH, member.teeth)
    for flank in FLANKS:
        teeth = np.unique(rows.tooth[(file.flank == flank) & np.isfinite(file.deviation)])
        if len(teeth) < least:
            raise InputError(
                f"{flank} flank: {len(teeth)} teeth were measured: registration needs {least} of both flanks"
            )
        gap = np.diff([*teeth, teeth[0] + member.teeth]).max() * 2 * math.pi / member.teeth
        if gap > _WIDEST_GAP:
            raise InputError(
                f"{flank} flank: the teeth that were measured leave out {math.degrees(gap):.0f} degrees of the turn: "
                f"registration allows {math.degrees(_WIDEST_GAP):.0f}"
            )


def _choose(file: FlankFile, rows: NominalRows, columns: np.ndarray, used: np.ndarray, member: Member) -> _Model:
    """The most general model of the pitch in which the seat is still told from the points."""
    seat = columns[used][:, [0, 1, 3, 4]]
    remarks: tuple[str, ...] = ()
    for each_flank in (True, False):
        free = _free_columns(file, rows, columns[:, 5], used, each_flank)
        left = seat - free @ (free.T @ seat)
        if _smallest(left * _sizes(member)) * _MOST_AMPLIFIED >= 1.0:
            return _Model(left, free, (0, 1, 2, 3), _EACH_FLANK if each_flank else _BOTH_FLANKS, remarks)
        remarks = (_TOGETHER,)
    if _smallest(left[:, :2]) * _MOST_AMPLIFIED < 1.0:
        raise InputError(
            f"{file.member}: the points do not tell eccentricity from uneven pitch; measure three or more places, toe "
            f"to heel and root to tip, on {LEAST_TEETH} teeth around"
        )
    feigned = _SMALL_TILT * _feigned(left, float(rows.point[used, 2].mean()))
    what = f"a tilt of 10 um per 100 mm passes for {feigned * 1000:.1f} um of eccentricity"
    if feigned > _MOST_FEIGNED:
        raise InputError(
            f"{file.member}: most teeth were measured at one place, and there {what}: measure three or more places, "
            f"toe to heel and root to tip, on {LEAST_TEETH} teeth around"
        )
    untold = f"tilt is not told by teeth measured at one place; taken as none at the height of that place, where {what}"
    return _Model(left[:, :2], free, (0, 1), _BOTH_FLANKS, (*remarks, untold))


def _smallest(columns: np.ndarray) -> float:
    return float(np.linalg.svd(columns, compute_uv=False)[-1])


def _feigned(left: np.ndarray, height: float) -> float:
    """Eccentricity [mm per rad] that a tilt about a height would be taken for, by the columns (n,4) that are left."""
    about = left[:, 2:] + height * np.stack([left[:, 1], -left[:, 0]], axis=1)
    return float(np.linalg.norm(np.linalg.lstsq(left[:, :2], about, rcond=None)[0], 2))


def _sizes(member: Member) -> np.ndarray:
    """What makes eccentricity and tilt alike: tilt counts as its motion at the mean cone distance."""
    return np.array([1.0, 1.0, *[1 / member.blank.mean_cone_distance] * 2])


def _free_columns(
    file: FlankFile, rows: NominalRows, lever: np.ndarray, used: np.ndarray, each_flank: bool
) -> np.ndarray:
    """Orthonormal columns (n,q) of all that is no seat: form at every point of the grid, turning of every tooth."""
    flank = (file.flank == FLANKS[1]).astype(int)[used]
    width = int(file.col.max()) + 1
    place = (flank * (int(file.row.max()) + 1) + file.row[used]) * width + file.col[used]
    group = rows.tooth[used] * 2 + flank if each_flank else rows.tooth[used]
    form = (place[:, None] == np.unique(place)).astype(float)
    form /= np.linalg.norm(form, axis=0)
    turning = (group[:, None] == np.unique(group)) * lever[used, None]
    turning = turning - form @ (form.T @ turning)
    u, sizes, _ = np.linalg.svd(turning, full_matrices=False)
    return np.hstack([form, u[:, sizes > 1e-9 * np.abs(lever).max()]])


def _fit(
    file: FlankFile, rows: NominalRows, columns: np.ndarray, used: np.ndarray, model: _Model, member: Member
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Seat (4,), deviations (n,) without it, and what the fit leaves of those used.

    Raises ComputationError if it does not converge.
    """
    seat, found = np.zeros(4), list(model.found)
    for _ in range(_ITERATIONS):
        deviation = _without(file, rows, columns, seat, member)
        asked = deviation[used] - model.free @ (model.free.T @ deviation[used])
        step, *_ = np.linalg.lstsq(model.columns, asked, rcond=None)
        if np.abs(model.columns @ step).max() < _CONVERGED:
            return seat, deviation, asked - model.columns @ step
        seat[found] += step
    raise ComputationError(f"no seat of the {file.member} explains its points: after {_ITERATIONS} steps it moves on")


def _without(file: FlankFile, rows: NominalRows, columns: np.ndarray, seat: np.ndarray, member: Member) -> np.ndarray:
    """The deviations (n,) [mm] of the work itself: points brought back by (18.1), against the exact nominal surface."""
    touched = rows.point + np.nan_to_num(file.deviation)[:, None] * rows.normal
    (x, y), (about_x, about_y) = seat[:2], seat[2:]
    (back, _) = kernel("unseated")(
        touched, rows.normal, math.hypot(x, y), math.atan2(y, x), math.hypot(about_x, about_y),
        math.atan2(about_y, about_x),
    )  # fmt: skip
    expected = np.nan_to_num(file.deviation) - columns[:, [0, 1, 3, 4]] @ seat
    deviation = np.full(len(file), np.nan)
    for flank in FLANKS:
        here = (file.flank == flank) & np.isfinite(file.deviation)
        deviation[here] = distance_from_flank(
            member, flank, back[here], rows.turn[here], rows.normal[here], expected[here]
        )
    return deviation


def _stated(file: FlankFile) -> float:
    """Noise of one point as the file states it [mm], NaN where it does not."""
    stated = file.uncertainty[np.isfinite(file.uncertainty)]
    return float(np.sqrt(np.mean(stated**2))) if len(stated) else math.nan


def _along(covariance: np.ndarray, direction: float) -> float:
    """Standard uncertainty of a length in its own direction."""
    unit = np.array([math.cos(direction), math.sin(direction)])
    return float(np.sqrt(unit @ covariance @ unit))


def _or_none(value: float) -> float | None:
    return value if math.isfinite(value) else None
