"""Where the points of a flank file lie on the flank: on the grid of its margins, or where each was measured.

A file with ``margins: own`` comes from another measuring machine: its rows and columns are a grid, but not one of even
margins, and each point lies where it was touched. Its places are the feet of its points, point - deviation · normal.
"""

from __future__ import annotations

import math

import numpy as np

from gearmath.bevel.flank import Grid, blank_grid
from gearmath.bevel.kernels import kernel
from gearmath.errors import InputError
from gearmath.quality.topography import grid_shape
from gearmath.specs.bevel_set import Member
from gearmath.specs.flank_csv import OWN, FlankFile

#: Points that the surface of second degree through the places of a grid needs.
_LEAST_POINTS = 6


def has_own_places(file: FlankFile) -> bool:
    """Whether every point of the file has its own place."""
    return file.header["margins"] == OWN


def file_grid(file: FlankFile, member: Member, flank: str, tooth: int | None = None) -> Grid:
    """The places (rows, columns) of the grid of a file, for its own places those of one tooth of a flank.

    By default that with most points. Places that were not measured are taken from a surface of second degree in row and
    column through the others. Raises InputError for unlike margins, and where there are too few points for that.
    """
    rows, columns = grid_shape(file)
    if not has_own_places(file):
        margins = [float(part) for part in file.header["margins"].split(",")]
        if margins[0] != margins[1]:
            raise InputError(f"margins = {file.header['margins']}: must be alike along the tooth and up the profile")
        return blank_grid(member, rows, columns, margins[0])
    points = file.select(flank)
    teeth, counts = np.unique(points.tooth, return_counts=True)
    if tooth is None and len(teeth):
        tooth = int(teeth[np.argmax(counts)])
    points = points.pick(points.tooth == tooth)
    place = feet(points)
    index = points.row * columns + points.col
    full = np.full((rows * columns, 2), np.nan)
    full[index] = place
    absent = np.isnan(full[:, 0])
    if absent.any():
        if len(points) < _LEAST_POINTS:
            raise InputError(
                f"{flank} flank, tooth {tooth}: {len(points)} points say too little of the places of the others"
            )
        row, col = (each.ravel() for each in np.indices((rows, columns)))
        terms = np.stack([np.ones(len(row)), row, col, row * col, row**2, col**2], axis=1)
        full[absent] = terms[absent] @ np.linalg.lstsq(terms[~absent], full[~absent], rcond=None)[0]
    return Grid(full[:, 0].reshape(rows, columns), full[:, 1].reshape(rows, columns))


def feet(file: FlankFile) -> np.ndarray:
    """Places (n,2) of the feet of the points, z_w and radius [mm]."""
    foot = file.point - np.nan_to_num(file.deviation)[:, None] * file.normal
    return np.stack([foot[:, 2], np.hypot(foot[:, 0], foot[:, 1])], axis=1)


def blank_fractions(member: Member, axial: np.ndarray, radial: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Parts (n,) of the face width from the toe and of the working depth at places (n,) [mm]: the inverse of (8.3)."""
    blank, ends = member.blank, []
    along, down = _on_cone(member, axial, radial)
    across = (along - blank.mean_cone_distance) / blank.face_width + 0.5
    for up in (0.0, 1.0):
        place = kernel("flank_place")(blank.vector, across, np.full(len(across), up))
        ends.append(_on_cone(member, *place)[1])
    return across, (down - ends[0]) / (ends[1] - ends[0])


def _on_cone(member: Member, axial: np.ndarray, radial: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    points = np.stack([radial, 0 * radial, axial], axis=1)
    along, down = kernel("root_place")(points, math.radians(member.blank.pitch_angle))
    return along, down
