"""Rotation of the work common to both flanks: found at their reference points, and taken out of all points.

Where the work stood about its axis while it was measured is no property of the gear. At the reference points of a
tooth its flanks are turned by θ and θ' (6.5): their mean is the tooth's place, half their difference its thickness.
The mean of the places of all teeth that have both points is the rotation ω; a tooth that is indexed far off the others
takes no part. Taking it out changes neither thickness nor pitch. Points are turned back by ω and judged against the
exact nominal surface.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from gearmath.bevel.turning import turned
from gearmath.errors import ComputationError, InputError
from gearmath.kernels import kernel
from gearmath.quality.evaluation.nominal import NominalRows, deviations_of, nominal_rows, with_deviations
from gearmath.quality.evaluation.pitch import reference_point
from gearmath.quality.evaluation.registration import known_um
from gearmath.quality.evaluation.robust import limit_of
from gearmath.quality.evaluation.tooth_shifts import LEAST_BETWEEN_TEETH
from gearmath.specs.bevel_set import FLANKS, Member
from gearmath.specs.flank_csv import COMMON, FlankFile

_ITERATIONS, _CONVERGED = 12, 1e-9
#: Of the components of a small motion (18.2): about z_w.
_TURNING = 5


@dataclass(frozen=True)
class Rotation:
    """How far the work stood turned about z_w, and the file without it.

    ``angle`` [rad] is right-handed about z_w, ``uncertainty`` [rad] its standard uncertainty, NaN where the noise of a
    point is not known. It was found at ``place`` (row, column) on both flanks of ``teeth`` teeth, at ``radius`` [mm].
    ``removed`` (n,) [mm] is what was taken off each deviation. To first order the angle is ``gain`` (n,) times the
    deviations, and what is taken off is ``column`` (n,) times the angle.
    """

    file: FlankFile
    angle: float
    uncertainty: float
    radius: float
    place: tuple[int, int]
    teeth: int
    removed: np.ndarray
    gain: np.ndarray
    column: np.ndarray

    @property
    def arc(self) -> float:
        """The rotation as an arc at the place where it was found [mm]."""
        return self.angle * self.radius

    def as_dict(self) -> dict[str, Any]:
        """Figures for people and programs: degrees, seconds of arc and µm; None where the uncertainty is not known."""
        u_arc = known_um(self.uncertainty * self.radius * 1000)
        return {
            "angle_deg": math.degrees(self.angle),
            "angle_arcsec": math.degrees(self.angle) * 3600,
            "u_angle_arcsec": None if u_arc is None else math.degrees(self.uncertainty) * 3600,
            "arc_um": self.arc * 1000,
            "u_arc_um": u_arc,
            "radius_mm": self.radius,
            "teeth": self.teeth,
        }


def common_rotation(file: FlankFile, member: Member, noise: float = math.nan) -> Rotation:
    """The rotation of a measured member that is common to both flanks, and its file without it.

    ``noise`` [mm] is the standard deviation of one point. Points without a deviation are carried along. Raises
    InputError where no tooth has both flanks at one place, ComputationError if no rotation explains them.
    """
    place, used = _pairs(file)
    rows = nominal_rows(file, member)
    column = kernel("motion_sensitivity")(rows.point, rows.normal)[0][:, _TURNING]
    radius = float(np.hypot(*rows.point[np.argmax(used), :2]))
    used &= np.isin(file.tooth, _alike(file.tooth[used], radius * file.deviation[used] / column[used]))
    gain = np.where(used, 1 / (used.sum() * column), 0.0)
    angle = 0.0
    for _ in range(_ITERATIONS):
        deviation = _without(file, member, rows, column, angle)
        step = float(gain[used] @ deviation[used])
        if abs(step * np.abs(column).max()) < _CONVERGED:
            break
        angle += step
    else:
        raise ComputationError(f"no rotation of the {file.member} explains its points: after {_ITERATIONS} steps")
    turned_back = replace(with_deviations(file, rows, deviation), header=_header(file))
    return Rotation(
        turned_back,
        angle,
        noise * float(np.linalg.norm(gain)),
        radius,
        place,
        int(used.sum()) // 2,
        np.nan_to_num(file.deviation - deviation),
        gain,
        column,
    )


def _pairs(file: FlankFile) -> tuple[tuple[int, int], np.ndarray]:
    """Where to look, and which rows (n,) are there on both flanks of a tooth: the reference point, or the nearest."""
    row, col = reference_point(file)
    known = np.isfinite(file.deviation)
    for flank in FLANKS:
        if not (known & (file.flank == flank)).any():
            raise InputError(f"the {flank} flank was not measured: one flank alone does not tell it from thickness")
    places = {
        flank: {
            (int(r), int(c), int(t))
            for r, c, t in zip(
                *(array[known & (file.flank == flank)] for array in (file.row, file.col, file.tooth)), strict=True
            )
        }
        for flank in FLANKS
    }
    both = places[FLANKS[0]] & places[FLANKS[1]]
    if not both:
        raise InputError("no tooth was measured at one place of both flanks")
    at = min(((r, c) for r, c, _ in both), key=lambda place: (abs(place[0] - row) + abs(place[1] - col), place))
    teeth = [t for r, c, t in both if (r, c) == at]
    return at, known & (file.row == at[0]) & (file.col == at[1]) & np.isin(file.tooth, teeth)


def _alike(tooth: np.ndarray, arc: np.ndarray) -> np.ndarray:
    """The teeth, each told by its two flanks (n,), that are not far off the others [mm]."""
    teeth = np.unique(tooth)
    place = np.array([arc[tooth == each].mean() for each in teeth])
    off = place - np.median(place)
    return teeth[np.abs(off) <= limit_of(off, LEAST_BETWEEN_TEETH)]


def _without(file: FlankFile, member: Member, rows: NominalRows, column: np.ndarray, angle: float) -> np.ndarray:
    """The deviations (n,) [mm] of the points turned back, against the exact nominal surface."""
    back = turned(with_deviations(file, rows, file.deviation).point, -angle)
    expected = np.nan_to_num(file.deviation) - column * angle
    return deviations_of(file, member, rows, back, expected)


def _header(file: FlankFile) -> dict[str, str]:
    """What was done to the phase: where the flanks had been set to zero one by one, that is still said."""
    each = file.header["phase_zeroed"].lower() == "true"
    return file.header if each else file.header | {"phase_zeroed": COMMON}
