"""Topography of one flank: the figures and the cubic surface that sum up its deviations."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from gearmath.bevel.kernels import kernel
from gearmath.errors import InputError
from gearmath.quality.pitch import reference_point
from gearmath.specs.flank_csv import FlankFile

#: The cubic surface has ten coefficients.
_COEFFICIENTS = 10


@dataclass(frozen=True)
class Topography:
    """Deviations (rows, columns) [mm] of one flank of one tooth, and the cubic surface (6.3) through them.

    ``coefficients`` c_1 ... c_10 [mm per mm^k] are in the local system at the reference point: X along the tooth
    (toe to heel), Y up the profile (root to tip). ``residual`` is what the cubic surface leaves [mm].
    """

    flank: str
    tooth: int
    deviation: np.ndarray
    coefficients: np.ndarray
    residual: np.ndarray

    @property
    def extreme(self) -> float:
        """The deviation that is largest in size, with its sign [mm]."""
        return float(self.deviation.flat[np.argmax(np.abs(self.deviation))])

    @property
    def rms(self) -> float:
        return float(np.sqrt(np.mean(self.deviation**2)))


def evaluate_topography(file: FlankFile, flank: str, tooth: int = 0) -> Topography:
    """Topography of one flank of one tooth. Raises InputError if the grid is not complete."""
    points = file.select(flank, tooth)
    rows, columns = grid_shape(file)
    if len(points) != rows * columns:
        raise InputError(
            f"{flank} flank, tooth {tooth}: {len(points)} points, the grid {rows}x{columns} needs {rows * columns}"
        )
    order = np.lexsort((points.col, points.row))
    deviation = points.deviation[order]
    if np.isnan(deviation).any():
        raise InputError(
            f"{flank} flank, tooth {tooth}: the file has no deviation at every point; is it a nominal file?"
        )
    along, upward = local_coordinates(points.point[order].reshape(rows, columns, 3), reference_point(file))
    _, monomials = kernel("deviation_surface")(along.ravel(), upward.ravel(), np.zeros(_COEFFICIENTS))
    used = monomials[:, : _COEFFICIENTS if min(rows, columns) >= 4 else 3]
    fitted, *_ = np.linalg.lstsq(used, deviation, rcond=None)
    coefficients = np.zeros(_COEFFICIENTS)
    coefficients[: len(fitted)] = fitted
    residual = deviation - used @ fitted
    return Topography(flank, tooth, deviation.reshape(rows, columns), coefficients, residual.reshape(rows, columns))


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
