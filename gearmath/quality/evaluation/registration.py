"""Registration: how the work was clamped when it was measured, found in its own points, and taken out of them.

The unknown clamping (16.6), eccentricity and tilt, is fitted by Gauss-Newton on the exact transform: measured points
are brought back into the work by (18.1) and judged against the exact nominal surface. Left free, and so never taken for
clamping, are the mean deviation of every point of the grid over the teeth (form, settings, axial position) and the
turning of every tooth (pitch). Of the pitch, the most general model that the points allow is used: every flank of
every tooth free; both flanks of a space turned together; the same without tilt. Chapter 18 says what each can tell.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from gearmath.errors import ComputationError
from gearmath.kernels import kernel
from gearmath.quality.evaluation.axial import Axial, axial_shift
from gearmath.quality.evaluation.file_checks import check_points
from gearmath.quality.evaluation.nominal import NominalRows, deviations_of, nominal_rows, with_deviations
from gearmath.quality.evaluation.seat_model import SEAT, SeatModel, check_teeth, seat_model, sizes
from gearmath.specs.bevel_set import Member
from gearmath.specs.flank_csv import FlankFile

_ITERATIONS, _CONVERGED = 12, 1e-9
#: Fewer spare observations than this say nothing about the noise.
_LEAST_SPARE = 3
#: Eccentricity or tilt of fewer of their standard uncertainties is what noise alone would show.
_SIGNIFICANT = 3.0
#: Less than this is no uncertainty that anything says. [µm]
_LEAST_KNOWN = 1e-3


@dataclass(frozen=True)
class Registration:
    """The clamping of the work, and the file without it.

    ``seat`` (4,): eccentricity along x_w and y_w [mm], tilt about x_w and y_w [rad], at the pitch apex; ``covariance``
    (4,4) of it, NaN where ``tilt_found`` is False. ``noise`` [mm] is the standard deviation of one point that the fit
    leaves, with ``spare`` observations more than unknowns. ``removed`` (n,) [mm] is what was taken off each deviation.
    To first order the seat is ``gain`` (4,n) times the deviations, and what is taken off is ``columns`` (n,4) times the
    seat. ``singular_values`` say how well the seat is told: the effect of 1 mm on all points beyond what is left free,
    tilt counted as its motion at the mean cone distance. ``index_model`` says what was left free of the pitch;
    ``remarks`` what the points could not tell.
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
    gain: np.ndarray
    columns: np.ndarray
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

    @property
    def is_significant(self) -> bool:
        """Whether eccentricity or tilt exceeds three of its standard uncertainties, or one of them is not known.

        Taking out what is no more than noise would only shift the pitch of every tooth by that noise.
        """
        pairs = [(self.eccentricity, self.eccentricity_uncertainty)]
        pairs += [(self.tilt, self.tilt_uncertainty)] * self.tilt_found
        return any(not size <= _SIGNIFICANT * u for size, u in pairs)

    @property
    def remark(self) -> str | None:
        """Why the clamping stays in the deviations; None where it is to be taken out."""
        if self.is_significant:
            return None
        size, u = self.eccentricity * 1000, self.eccentricity_uncertainty * 1000
        what, verb = f"eccentricity {size:.2f} um (u = {u:.2f} um)", "is"
        if self.tilt_found:
            what += f" and tilt {self.tilt * 1e5:.2f} um per 100 mm (u = {self.tilt_uncertainty * 1e5:.2f})"
            verb = "are"
        return f"clamping not taken out: {what} {verb} below {_SIGNIFICANT:.0f} u, no more than the noise of the points"

    def as_dict(self) -> dict[str, Any]:
        """Figures for people and programs: µm and degrees, None where the points do not tell."""
        return {
            "taken_out": self.is_significant,
            "eccentricity_um": self.eccentricity * 1000,
            "u_eccentricity_um": known_um(self.eccentricity_uncertainty * 1000),
            "eccentricity_direction_deg": math.degrees(self.eccentricity_direction),
            "tilt_um_per_100mm": self.tilt * 1e5 if self.tilt_found else None,
            "u_tilt_um_per_100mm": known_um(self.tilt_uncertainty * 1e5),
            "tilt_direction_deg": math.degrees(self.tilt_direction) if self.tilt_found else None,
            "noise_um": known_um(self.noise * 1000),
            "largest_removed_um": float(np.abs(self.removed).max() * 1000) if self.is_significant else 0.0,
            "index_model": self.index_model,
            "singular_values": self.singular_values.tolist(),
            "axial": self.axial_position.as_dict(),
            "remarks": list(self.remarks),
        }


def register(file: FlankFile, member: Member, untold: np.ndarray | None = None) -> Registration:
    """The clamping of a measured member, and its file without it.

    Points without a deviation are carried along and take no part. ``untold`` (n,q) are patterns that the deviations may
    have besides, such as drift that is not known: they are left free, and stay in. Raises InputError for too few teeth,
    a single flank, or points that do not tell the eccentricity; ComputationError if no clamping explains them.
    """
    rows = nominal_rows(file, member)
    check_points(file, rows, member)
    check_teeth(file, rows, member)
    used = np.isfinite(file.deviation)
    columns = kernel("motion_sensitivity")(rows.point, rows.normal)[0]
    besides = np.empty((len(file), 0)) if untold is None else untold
    model = seat_model(file, rows, columns, besides, used, member)
    seat, deviation, left = _fit(file, rows, columns, used, model, member)
    spare = int(used.sum()) - model.free.shape[1] - len(model.found)
    noise = math.sqrt(float(left @ left) / spare) if spare >= _LEAST_SPARE else stated_noise(file)
    covariance, gain, found = np.full((4, 4), np.nan), np.zeros((4, len(file))), list(model.found)
    covariance[np.ix_(found, found)] = noise**2 * np.linalg.inv(model.columns.T @ model.columns)
    gain[np.ix_(found, used)] = np.linalg.pinv(model.columns)
    registered = with_deviations(file, rows, deviation)
    singular_values = np.linalg.svd(model.columns * sizes(member)[found], compute_uv=False)
    return Registration(
        registered,
        seat,
        covariance,
        len(found) == 4,
        model.name,
        noise,
        spare,
        singular_values,
        np.nan_to_num(file.deviation - deviation),
        gain,
        columns[:, SEAT],
        axial_shift(registered, member, rows, columns),
        model.remarks,
    )


def _fit(
    file: FlankFile, rows: NominalRows, columns: np.ndarray, used: np.ndarray, model: SeatModel, member: Member
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
    raise ComputationError(
        f"no clamping of the {file.member} explains its points: after {_ITERATIONS} steps it moves on"
    )


def _without(file: FlankFile, rows: NominalRows, columns: np.ndarray, seat: np.ndarray, member: Member) -> np.ndarray:
    """The deviations (n,) [mm] of the work itself: points brought back by (18.1), against the exact nominal surface."""
    touched = with_deviations(file, rows, file.deviation).point
    (x, y), (about_x, about_y) = seat[:2], seat[2:]
    (back, _) = kernel("unseated")(
        touched,
        rows.normal,
        math.hypot(x, y),
        math.atan2(y, x),
        math.hypot(about_x, about_y),
        math.atan2(about_y, about_x),
    )
    expected = np.nan_to_num(file.deviation) - columns[:, SEAT] @ seat
    return deviations_of(file, member, rows, back, expected)


def stated_noise(file: FlankFile) -> float:
    """Noise of one point as the file states it [mm], NaN where it does not."""
    stated = file.uncertainty[np.isfinite(file.uncertainty)]
    return float(np.sqrt(np.mean(stated**2))) if len(stated) else math.nan


def _along(covariance: np.ndarray, direction: float) -> float:
    """Standard uncertainty of a length in its own direction."""
    unit = np.array([math.cos(direction), math.sin(direction)])
    return float(np.sqrt(unit @ covariance @ unit))


def known_um(value: float) -> float | None:
    """An uncertainty [µm], None where it is not known; less than a nanometre is rounding of the file."""
    return value if value >= _LEAST_KNOWN else None
