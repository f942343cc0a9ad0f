"""Places on a flank: grids laid out by margins or listed, and where the points of a flank file lie.

A file with ``margins: own`` has a place for each of its points: they were listed, or another measuring machine touched
them. Its rows and columns are a grid, but not one of even margins; its places are the feet of its points,
point - deviation · normal.
"""

from __future__ import annotations

import numpy as np

from gearmath.bevel.flank import Grid, blank_grid
from gearmath.errors import InputError, counted
from gearmath.kernels import kernel
from gearmath.specs.bevel_set import Member
from gearmath.specs.flank_csv import FlankFile
from gearmath.specs.margins import OWN, Margins

#: A listed place may lie this far outside the face width. [mm]
_SLACK = 1e-6
#: Points that the surface of second degree through the places of a grid needs.
_LEAST_POINTS = 6


def listed_grid(member: Member, axial: np.ndarray, radial: np.ndarray, shape: tuple[int, int]) -> Grid:
    """Listed places (n,) [mm] as a grid, row by row: rows root to tip, columns toe to heel.

    Raises InputError where there are more or fewer than the grid has, for one beyond the face width, and where a row or
    a column of a grid does not go that way.
    """
    rows, columns = shape
    if len(axial) != rows * columns:
        raise InputError(f"holds {counted(len(axial), 'place')}, a grid of {rows}x{columns} has {rows * columns}")
    along, down = _on_cone(member, axial, radial)
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


def has_own_places(file: FlankFile) -> bool:
    """Whether every point of the file has its own place."""
    return file.header["margins"] == OWN


def file_grid(file: FlankFile, member: Member, flank: str | None = None, tooth: int | None = None) -> Grid:
    """The places (rows, columns) of the grid of a file, for its own places those of one tooth of a flank.

    By default the first flank, and the tooth with most points. Places that were not measured there are those of other
    teeth and flanks, else of a surface of second degree in row and column through the others. Raises InputError where
    there are too few points for that.
    """
    rows, columns = (int(part) for part in file.header["grid"].split("x"))
    if not has_own_places(file):
        return blank_grid(member, rows, columns, Margins.read(file.header["margins"]))
    flank = str(file.flank[0]) if flank is None else flank
    points = file.select(flank)
    teeth, counts = np.unique(points.tooth, return_counts=True)
    if tooth is None and len(teeth):
        tooth = int(teeth[np.argmax(counts)])
    points = points.pick(points.tooth == tooth)
    full = _mean_feet(file, rows * columns)  # the others tell what this tooth lacks
    own = points.row * columns + points.col
    full[own] = feet(points)
    absent = np.isnan(full[:, 0])
    if absent.any():
        if (~absent).sum() < _LEAST_POINTS:
            raise InputError(
                f"{flank} flank, tooth {tooth}: {len(points)} points say too little of the places of the others"
            )
        row, col = (each.ravel() for each in np.indices((rows, columns)))
        terms = np.stack([np.ones(len(row)), row, col, row * col, row**2, col**2], axis=1)
        full[absent] = terms[absent] @ np.linalg.lstsq(terms[~absent], full[~absent], rcond=None)[0]
    return Grid(full[:, 0].reshape(rows, columns), full[:, 1].reshape(rows, columns))


def _mean_feet(file: FlankFile, count: int) -> np.ndarray:
    """The mean feet (count,2) [mm] of all points of a place of the grid, NaN where there are none."""
    columns = int(file.header["grid"].split("x")[1])
    place, found = file.row * columns + file.col, np.zeros((count, 3))
    np.add.at(found, place, np.column_stack([feet(file), np.ones(len(file))]))
    with np.errstate(invalid="ignore"):
        return found[:, :2] / found[:, 2:]


def feet(file: FlankFile) -> np.ndarray:
    """Places (n,2) of the feet of the points, z_w and radius [mm]."""
    foot = file.point - np.nan_to_num(file.deviation)[:, None] * file.normal
    return np.stack([foot[:, 2], np.hypot(foot[:, 0], foot[:, 1])], axis=1)


def blank_fractions(member: Member, axial: np.ndarray, radial: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Parts (n,) of the face width from the toe and of the working depth at places (n,) [mm]: the inverse of (8.3)."""
    across, height, depth = _over_limit(member, axial, radial)
    return across, height / depth


def over_reach(member: Member, axial: np.ndarray, radial: np.ndarray) -> np.ndarray:
    """Heights (n,) [mm] of places over the lower limit of the flank, to which the tip of the mate reaches (8.3)."""
    return _over_limit(member, axial, radial)[1]


def _over_limit(member: Member, axial: np.ndarray, radial: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Parts (n,) of the face width, heights over the lower limit and working depths (n,) [mm] there."""
    blank, ends = member.blank, []
    along, down = _on_cone(member, axial, radial)
    across = (along - blank.mean_cone_distance) / blank.face_width + 0.5
    for up in (0.0, 1.0):
        place = kernel("flank_place")(blank.vector, across, np.full(len(across), up))
        ends.append(_on_cone(member, *place)[1])
    return across, ends[0] - down, ends[0] - ends[1]


def _on_cone(member: Member, axial: np.ndarray, radial: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    points = np.stack([radial, 0 * radial, axial], axis=1)
    along, down = kernel("root_place")(points, member.blank.delta)
    return along, down
