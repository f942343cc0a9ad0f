"""Topography of one flank: the figures and the cubic surface that sum up its deviations, and their first two orders."""

from __future__ import annotations

import math
import warnings
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from gearmath.errors import InputError, counted
from gearmath.kernels import kernel
from gearmath.quality.evaluation.pitch import reference_point
from gearmath.specs.flank_csv import FlankFile

#: The cubic surface has ten coefficients, its part of second degree six, its plane three.
_COEFFICIENTS, _QUADRATIC, _PLANE = 10, 6, 3
#: Part of a grid that may be without deviation: points that were left out.
_MOST_SILENT = 0.2
#: Of the components of a small motion (18.2): about z_w.
_TURNING = 5
#: The figures of ``orders``, in the order of the rows of ``orders_matrix``.
ORDERS = (
    "mean",
    "spiral_angle_deviation",
    "pressure_angle_deviation",
    "length_crowning",
    "twist",
    "profile_crowning",
)
#: Keys of these orders and of what they leave, as they are listed for people.
ORDER_KEYS = (
    "mean_um",
    "pressure_angle_deviation_um",
    "spiral_angle_deviation_um",
    "profile_crowning_um",
    "length_crowning_um",
    "twist_um",
    "residual_um",
)


@dataclass(frozen=True)
class Topography:
    """Deviations (rows, columns) [mm] of one flank of one tooth, and the cubic surface (6.3) through them.

    ``coefficients`` c_1 ... c_10 [mm per mm^k] are in the local system at the reference point: X along the tooth
    (toe to heel), Y up the profile (root to tip), ``along`` and ``upward`` [mm]. ``residual`` is what the cubic surface
    leaves [mm]. Deviation and residual are NaN at points that were left out.
    """

    flank: str
    tooth: int
    deviation: np.ndarray
    coefficients: np.ndarray
    residual: np.ndarray
    along: np.ndarray
    upward: np.ndarray

    @property
    def extreme(self) -> float:
        """The deviation that is largest in size, with its sign [mm]."""
        return float(self.deviation.flat[np.nanargmax(np.abs(self.deviation))])

    @property
    def rms(self) -> float:
        return float(np.sqrt(np.nanmean(self.deviation**2)))

    @property
    def at_reference(self) -> float:
        """The deviation at the reference point [mm]; that of the cubic surface where the point was left out."""
        here = self.deviation.flat[np.argmin(self.along**2 + self.upward**2)]
        return float(here if np.isfinite(here) else self.coefficients[0])

    @property
    def left_out(self) -> int:
        """How many points of the grid have no deviation."""
        return int(np.isnan(self.deviation).sum())


@dataclass(frozen=True)
class Orders:
    """Mean, first and second order of a flank's deviations (6.6), over the whole evaluated area [mm].

    Positive: metal left on; more of it towards heel and tip; barrelled; rising more to the tip at the heel than at the
    toe. ``residual`` is the RMS that the surface of second degree leaves. ``length`` and ``height`` are those of the
    area [mm].
    """

    flank: str
    mean: float
    spiral_angle_deviation: float
    pressure_angle_deviation: float
    length_crowning: float
    twist: float
    profile_crowning: float
    residual: float
    length: float
    height: float

    @property
    def spiral_angle(self) -> float:
        """Spiral angle deviation [rad]."""
        return self.spiral_angle_deviation / self.length

    @property
    def pressure_angle(self) -> float:
        """Pressure angle deviation [rad]."""
        return self.pressure_angle_deviation / self.height

    def as_dict(self) -> dict[str, float]:
        values = {f"{name}_um": getattr(self, name) * 1000 for name in (*ORDERS, "residual")}
        angles = {f"{name}_deg": math.degrees(getattr(self, name)) for name in ("spiral_angle", "pressure_angle")}
        return values | angles


def evaluate_topography(file: FlankFile, flank: str, tooth: int = 0) -> Topography:
    """Topography of one flank of one tooth. Raises InputError if the grid is not complete."""
    points = file.select(flank, tooth)
    rows, columns = grid_shape(file)
    if len(points) != rows * columns:
        raise InputError(
            f"{flank} flank, tooth {tooth}: {counted(len(points), 'point')}, the grid {rows}x{columns} needs "
            f"{rows * columns}"
        )
    order = np.lexsort((points.col, points.row))
    deviation = points.deviation[order]
    known = np.isfinite(deviation)
    if known.mean() < 1 - _MOST_SILENT:
        raise InputError(
            f"{flank} flank, tooth {tooth}: {int(known.sum())} of {len(known)} points have a deviation; "
            "is it a nominal file?"
        )
    along, upward = local_coordinates(points.point[order].reshape(rows, columns, 3), reference_point(file))
    return _fitted(flank, tooth, deviation.reshape(rows, columns), along, upward)


def _fitted(flank: str, tooth: int, deviation: np.ndarray, along: np.ndarray, upward: np.ndarray) -> Topography:
    """The topography of deviations (rows, columns) at places of the local system, with the surface through them."""
    known = np.isfinite(deviation).ravel()
    used = _monomials(along, upward)[:, : _COEFFICIENTS if min(deviation.shape) >= 4 else _PLANE]
    fitted, *_ = np.linalg.lstsq(used[known], deviation.ravel()[known], rcond=None)
    coefficients = np.zeros(_COEFFICIENTS)
    coefficients[: len(fitted)] = fitted
    residual = deviation - (used @ fitted).reshape(deviation.shape)
    return Topography(flank, tooth, deviation, coefficients, residual, along, upward)


def zeroed(topography: Topography, file: FlankFile) -> Topography:
    """The topography of a flank that is turned about the work axis until its reference point has no deviation (6.5).

    How charts are drawn: form without the thickness of the tooth. ``file`` tells the points and normals of the flank.
    """
    points = file.select(topography.flank)
    points = points.pick(points.tooth == (topography.tooth if topography.tooth >= 0 else _full_tooth(points)))
    order = np.lexsort((points.col, points.row))
    lever = kernel("motion_sensitivity")(points.point[order], points.normal[order])[0][:, _TURNING]
    lever = lever.reshape(topography.deviation.shape)
    at = reference_point(file)
    deviation = topography.deviation - topography.at_reference * lever / lever[at]
    return _fitted(topography.flank, topography.tooth, deviation, topography.along, topography.upward)


def teeth_in_full(file: FlankFile, flank: str) -> list[int]:
    """The teeth whose grid is there, and of it enough points with a deviation."""
    points, needed = file.select(flank), math.prod(grid_shape(file))
    known = np.isfinite(points.deviation)
    teeth = np.unique(points.tooth).tolist()
    counts = {tooth: (points.tooth == tooth, known & (points.tooth == tooth)) for tooth in teeth}
    return [
        t for t, (all_, there) in counts.items() if all_.sum() == needed and there.sum() >= (1 - _MOST_SILENT) * needed
    ]


def _full_tooth(points: FlankFile) -> int:
    """A tooth that has all points of the grid."""
    teeth, counts = np.unique(points.tooth, return_counts=True)
    return int(teeth[np.argmax(counts)])


def orders(topography: Topography) -> Orders:
    """Mean, first and second order of the deviations of a flank, and what they leave.

    A grid of two rows or columns has no second order. Means of several teeth: average their topographies first.
    """
    known = np.isfinite(topography.deviation)
    along, upward, values = topography.along[known], topography.upward[known], topography.deviation[known]
    figures = orders_matrix(along, upward) @ values
    surface = _about_middle(along, upward)
    rest = values - surface @ np.linalg.lstsq(surface, values, rcond=None)[0]
    values_of = dict(zip(ORDERS, map(float, figures), strict=True))
    area = {"length": float(np.ptp(along)), "height": float(np.ptp(upward))}
    return Orders(topography.flank, residual=float(np.sqrt(np.mean(rest**2))), **values_of, **area)


def orders_matrix(along: np.ndarray, upward: np.ndarray) -> np.ndarray:
    """The linear map (6,n) from the deviations at n places [mm] of the local system to the figures ``ORDERS``."""
    surface = _about_middle(along, upward)
    fit = np.zeros((_COEFFICIENTS, len(along)))
    fit[: surface.shape[1]] = np.linalg.pinv(surface)
    figures = kernel("surface_orders")(fit.T, float(np.ptp(along)), float(np.ptp(upward)))
    return np.stack([np.full(len(along), 1 / len(along)), *figures])


def mean_topography(topographies: Sequence[Topography]) -> Topography:
    """The mean of several teeth of one flank, point by point over those that have a deviation; ``tooth`` is -1."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)  # a point without a deviation on every tooth stays without one
        deviation = np.nanmean([each.deviation for each in topographies], axis=0)
        residual = np.nanmean([each.residual for each in topographies], axis=0)
    coefficients = np.mean([each.coefficients for each in topographies], axis=0)
    first = topographies[0]
    return Topography(first.flank, -1, deviation, coefficients, residual, first.along, first.upward)


def _about_middle(along: np.ndarray, upward: np.ndarray) -> np.ndarray:
    """Monomials (n,6) about the middle of the evaluated area; those of a plane where there are two rows or columns."""
    middle = [(values.max() + values.min()) / 2 for values in (along, upward)]
    monomials = _monomials(along - middle[0], upward - middle[1])
    quadratic = monomials[:, :_QUADRATIC]
    enough = np.linalg.matrix_rank(quadratic / np.abs(quadratic).max(axis=0)) == _QUADRATIC
    return quadratic if enough else monomials[:, :_PLANE]


def _monomials(along: np.ndarray, upward: np.ndarray) -> np.ndarray:
    _, monomials = kernel("deviation_surface")(along.ravel(), upward.ravel(), np.zeros(_COEFFICIENTS))
    return monomials


def local_coordinates(grid: np.ndarray, reference: tuple[int, int]) -> tuple[np.ndarray, np.ndarray]:
    """X and Y (rows, columns) [mm] of (6.3): along the tooth and up the profile, tangent at the reference point."""
    row, col = reference
    origin = grid[row, col]
    along = grid[row, -1] - grid[row, 0]
    along = along / np.linalg.norm(along)
    upward = grid[-1, col] - grid[0, col]
    upward = upward - upward.dot(along) * along
    upward = upward / np.linalg.norm(upward)
    return (grid - origin) @ along, (grid - origin) @ upward


def grid_shape(file: FlankFile) -> tuple[int, int]:
    """Rows and columns of the grid, from the header. Raises InputError if it does not read like 5x9."""
    try:
        rows, columns = (int(part) for part in file.header["grid"].split("x"))
    except ValueError as error:
        raise InputError(f"grid = {file.header['grid']!r}: must read like 5x9") from error
    return rows, columns
