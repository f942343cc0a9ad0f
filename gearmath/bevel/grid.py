"""Grids of places on a flank: laid out by margins, listed, or those of a flank file."""

from __future__ import annotations

import numpy as np

from gearmath.bevel.flank import Grid, blank_grid
from gearmath.bevel.kernels import kernel
from gearmath.errors import InputError
from gearmath.specs.bevel_set import Member
from gearmath.specs.flank_csv import FlankFile
from gearmath.specs.margins import LISTED, Margins

#: A listed place may lie this far outside the face width. [mm]
_SLACK = 1e-6


def listed_grid(member: Member, axial: np.ndarray, radial: np.ndarray, shape: tuple[int, int]) -> Grid:
    """Listed places (n,) [mm] as a grid, row by row: rows root to tip, columns toe to heel.

    Raises InputError where there are more or fewer than the grid has, for one beyond the face width, and where a row or
    a column of a grid does not go that way.
    """
    rows, columns = shape
    if len(axial) != rows * columns:
        raise InputError(f"holds {len(axial)} places, a grid of {rows}x{columns} has {rows * columns}")
    points = np.stack([radial, 0 * radial, axial], axis=1)
    along, down = (np.ravel(value) for value in kernel("root_place")(points, np.radians(member.blank.pitch_angle)))
    blank = member.blank
    beyond = np.abs(along - blank.mean_cone_distance) - blank.face_width / 2
    if (beyond > _SLACK).any():
        k = int(np.argmax(beyond))
        low, high = (blank.mean_cone_distance + sign * blank.face_width / 2 for sign in (-1, 1))
        raise InputError(
            f"place {k}, z_w = {axial[k]:g} and r_w = {radial[k]:g}: its cone distance of {along[k]:.4f} mm must lie "
            f"between {low:.4f} and {high:.4f} mm"
        )
    along, down = along.reshape(shape), down.reshape(shape)
    if columns > 1 and not ((np.diff(along, axis=1) > 0).all() and (np.diff(down, axis=0) < 0).all()):
        raise InputError(f"the places of a grid of {rows}x{columns} must stand row by row, root to tip, toe to heel")
    return Grid(axial.reshape(shape), radial.reshape(shape))


def grid_of(file: FlankFile, member: Member) -> Grid:
    """The grid that a flank file means.

    Where its places were listed they are those of its points, less the deviations along the normals; raises InputError
    if one was not measured at all.
    """
    rows, columns = (int(part) for part in file.header["grid"].split("x"))
    if file.header["margins"] != LISTED:
        return blank_grid(member, rows, columns, Margins.read(file.header["margins"]))
    foot = file.point - np.nan_to_num(file.deviation)[:, None] * file.normal
    place, count = file.row * columns + file.col, np.zeros(rows * columns)
    np.add.at(count, place, 1)
    if (count == 0).any():
        row, col = divmod(int(np.argmax(count == 0)), columns)
        raise InputError(f"row {row}, col {col}: no point of this listed place is in the file")
    axial, radial = np.zeros(rows * columns), np.zeros(rows * columns)
    np.add.at(axial, place, foot[:, 2])
    np.add.at(radial, place, np.hypot(foot[:, 0], foot[:, 1]))
    return Grid((axial / count).reshape(rows, columns), (radial / count).reshape(rows, columns))
