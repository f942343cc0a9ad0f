"""The nominal flanks behind a measured file: which point each row means, and how far a point lies from its flank."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from gearmath.bevel.flank import Grid, nominal_points, solve_flank
from gearmath.bevel.grid import feet, file_grid, has_own_places
from gearmath.bevel.newton import TOLERANCE
from gearmath.bevel.turning import turned
from gearmath.errors import ComputationError
from gearmath.quality.evaluation.pitch import reference_point
from gearmath.quality.evaluation.topography import grid_shape
from gearmath.specs.bevel_set import FLANKS, Member
from gearmath.specs.flank_csv import FlankFile, flank_file, join

#: Part of a grid that may be missing.
MOST_MISSING = 0.2


@dataclass(frozen=True)
class NominalRows:
    """What the n rows of a file mean: nominal points and outward normals (n,3), and the turn (n,) [rad] of each tooth.

    ``tooth`` counts tooth 0 measured again as tooth 0.
    """

    point: np.ndarray
    normal: np.ndarray
    turn: np.ndarray
    tooth: np.ndarray


def nominal_rows(file: FlankFile, member: Member) -> NominalRows:
    """The nominal point and normal of every row, in the work frame.

    Raises ComputationError if the grid does not lie on the flank.
    """
    columns, own = grid_shape(file)[1], has_own_places(file)
    point, normal = np.empty((len(file), 3)), np.empty((len(file), 3))
    tooth = file.tooth % member.teeth
    turn = 2 * math.pi * tooth / member.teeth
    for flank in FLANKS:
        here = file.flank == flank
        if here.any():
            if own:
                grid, place = Grid(*feet(file.pick(here)).T[:, None]), np.arange(int(here.sum()))
            else:
                grid = file_grid(file, member, flank)
                place = file.row[here] * columns + file.col[here]
            solved = solve_flank(member, flank, grid)
            point[here] = turned(solved.point[place], turn[here])
            normal[here] = turned(solved.normal[place], turn[here])
    return NominalRows(point, normal, turn, tooth)


def distance_from_flank(
    member: Member, flank: str, point: np.ndarray, turn: np.ndarray, normal: np.ndarray, expected: np.ndarray
) -> np.ndarray:
    """Signed distance (n,) [mm] of points (n,3) from the nominal flank of their teeth, positive out of the metal.

    ``normal`` (n,3) and ``expected`` (n,) say roughly where the foot of each point is. The tangent plane of the
    surface at the foot's z_w and radius is as good as the surface: the foot lies within a µm of where it touches.
    Raises ComputationError where the surface has no such place.
    """
    at = turned(point, -turn)
    foot = at - expected[:, None] * turned(normal, -turn)
    place = Grid(foot[:, 2], np.hypot(foot[:, 0], foot[:, 1]))
    surface, residual = nominal_points(member, flank, place)
    if not (residual <= TOLERANCE).all():
        k = int(np.argmax(~(residual <= TOLERANCE)))
        raise ComputationError(f"{flank} flank: the nominal surface does not reach the point at {point[k].round(3)} mm")
    return np.sum((at - surface.point) * surface.normal, axis=1)


def deviations_of(
    file: FlankFile, member: Member, rows: NominalRows, point: np.ndarray, expected: np.ndarray
) -> np.ndarray:
    """Deviations (n,) [mm] of points (n,3) against the exact nominal surface, roughly ``expected`` (n,).

    NaN where the file has none.
    """
    deviation = np.full(len(file), np.nan)
    for flank in FLANKS:
        here = (file.flank == flank) & np.isfinite(file.deviation)
        deviation[here] = distance_from_flank(
            member, flank, point[here], rows.turn[here], rows.normal[here], expected[here]
        )
    return deviation


def with_deviations(file: FlankFile, rows: NominalRows, deviation: np.ndarray) -> FlankFile:
    """The file with other deviations (n,) [mm] at its nominal points; there themselves where one is NaN."""
    return replace(file, point=rows.point + np.nan_to_num(deviation)[:, None] * rows.normal, deviation=deviation)


def at_one_place(file: FlankFile, member: Member) -> FlankFile:
    """The reference points of a file whose points have their own places, both flanks brought to the same place.

    Between flanks and teeth these places differ by what the measuring machine was off the commanded ones: deviations
    hardly change over that, the thickness of the tooth does. Files of even margins stay as they are.
    """
    row, col = reference_point(file)
    points = file.pick((file.row == row) & (file.col == col))
    if not has_own_places(file) or not len(points):
        return file
    axial, radial = feet(points).mean(axis=0)
    point, normal = np.empty((len(points), 3)), np.empty((len(points), 3))
    for flank in np.unique(points.flank):
        here = points.flank == flank
        turn = 2 * math.pi * (points.tooth[here] % member.teeth) / member.teeth
        solved = solve_flank(member, str(flank), Grid(np.array([[axial]]), np.array([[radial]])))
        point[here] = turned(np.repeat(solved.point, len(turn), axis=0), turn)
        normal[here] = turned(np.repeat(solved.normal, len(turn), axis=0), turn)
    moved = np.nan_to_num(points.deviation)[:, None] * normal
    return replace(points, point=point + moved, normal=normal)


def completed(file: FlankFile, member: Member) -> tuple[FlankFile, tuple[str, ...]]:
    """The file with the points that are missing in grids measured nearly in full, nominal and silent; and who they are.

    A tooth is taken as measured in full where no more than a fifth of its points are missing.
    """
    missing, remarks = [], []
    for flank in FLANKS:
        points = file.select(flank)
        for tooth in np.unique(points.tooth):
            one = points.pick(points.tooth == tooth)
            there = set(zip(one.row.tolist(), one.col.tolist(), strict=True))
            absent = [place for place in np.ndindex(*grid_shape(file)) if place not in there]
            if absent and len(absent) <= MOST_MISSING * (len(absent) + len(there)):
                row, col = np.array(absent).T
                nowhere = np.zeros((len(absent), 3))
                if has_own_places(file):
                    grid = file_grid(file, member, flank, int(tooth))
                    nowhere[:, 0], nowhere[:, 2] = grid.radial[row, col], grid.axial[row, col]
                missing.append(flank_file(file.header, member.name, flank, int(tooth), row, col, nowhere, nowhere))
                remarks += [
                    f"{flank} flank, tooth {tooth}, row {r}, col {c}: not measured; left out" for r, c in absent
                ]
    if not missing:
        return file, ()
    added = join(missing)
    nominal = nominal_rows(added, member)
    return join([file, replace(added, point=nominal.point, normal=nominal.normal)]), tuple(remarks)
