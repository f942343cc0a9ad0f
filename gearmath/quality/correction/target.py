"""From a measured file to the target of a fit: one flank with its nominal points, and what was measured there."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from gearmath.bevel.flank import solve_flank
from gearmath.bevel.grid import file_grid
from gearmath.bevel.identify.blade import blade_curve, by_foot
from gearmath.bevel.identify.flank_target import FlankTarget
from gearmath.bevel.identify.root_line import root_line
from gearmath.bevel.method import cut_generation_of
from gearmath.bevel.newton import FlankPoints
from gearmath.bevel.turning import turned
from gearmath.errors import InputError
from gearmath.quality.correction.representative import representative_tooth
from gearmath.quality.evaluation.pitch import reference_point
from gearmath.quality.evaluation.topography import grid_shape, local_coordinates
from gearmath.specs.bevel_set import Member
from gearmath.specs.flank_csv import FlankFile

#: Points of the file and of the set must agree this well, or the file belongs to another set. [mm]
_SAME_POINT = 0.01


def flank_target(
    member: Member, flank: str, measured: FlankFile, tooth: int | None = None, excluded: np.ndarray | None = None
) -> FlankTarget:
    """One flank of a file with the nominal points of the set, of a tooth that has most points if none is given.

    Points that the file does not have, that have no deviation, or that ``excluded`` (points of the file,) marks are
    left out. Raises InputError if nothing is left, if points lie outside of the grid or are there twice, or if they are
    not those of the set.
    """
    kept = np.ones(len(measured), dtype=bool) if excluded is None else ~excluded
    points, kept = measured.select(flank), kept[measured.flank == flank]
    if tooth is None and len(points):
        tooth = representative_tooth(points, flank)
    here = points.tooth == tooth
    points, kept = points.select(flank, tooth), kept[here]
    rows, columns = grid_shape(measured)
    place = points.row * columns + points.col
    _check_grid(flank, points, rows, columns)
    if np.isnan(points.deviation).all():
        raise InputError(f"{flank} flank: deviation_um is empty; is this a nominal file?")
    kept &= ~np.isnan(points.deviation)
    if not kept.any():
        raise InputError(f"{flank} flank: every point is excluded")
    order = np.argsort(place)
    order = order[kept[order]]
    at = place[order]
    nominal = solve_flank(member, flank, file_grid(measured, member, flank, tooth))
    deviation = points.deviation[order]
    _check_places(flank, points.point[order], deviation, nominal, at, int(points.tooth[0]) / member.teeth, columns)
    used = np.zeros(rows * columns, dtype=bool)
    used[at] = True
    along, up = local_coordinates(nominal.point.reshape(rows, columns, 3), reference_point(measured))
    target = target_of(member, flank, nominal, np.stack([along.ravel(), up.ravel()], axis=1), used, deviation)
    # the end of a flank may rise where the tip of the cutter goes deeper, by settings at their limits: this is the root
    return target if target.root is None else replace(target, root=replace(target.root, deepest=True))


def target_of(
    member: Member,
    flank: str,
    nominal: FlankPoints,
    place: np.ndarray | None = None,
    used: np.ndarray | None = None,
    deviation: np.ndarray | None = None,
) -> FlankTarget:
    """A target at the ``used`` ones (grid,) of nominal points, with the settings that the machine is set to."""
    spec, how = member.flank(flank), cut_generation_of(member, flank)
    nominal = by_foot(spec, nominal)
    used = np.ones(len(nominal.point), dtype=bool) if used is None else used
    return FlankTarget(
        how,
        FlankPoints(nominal.contact[used], nominal.point[used], nominal.normal[used]),
        np.zeros(int(used.sum())) if deviation is None else deviation,
        *blade_curve(spec),
        None if place is None else place[used],
        root_line(member, flank, how, nominal),
        used,
        FlankPoints(nominal.contact[~used], nominal.point[~used], nominal.normal[~used]),
    )


def _check_grid(flank: str, points: FlankFile, rows: int, columns: int) -> None:
    """Raise InputError unless there are points, each in the grid and there once."""
    if not len(points):
        raise InputError(f"{flank} flank: 0 points were measured, the grid {rows}x{columns} needs them")
    seen: set[tuple[int, int]] = set()
    for row, col in zip(points.row.tolist(), points.col.tolist(), strict=True):
        if row >= rows or col >= columns:
            raise InputError(f"{flank} flank: row {row}, col {col} lies outside of the grid {rows}x{columns}")
        if (row, col) in seen:
            raise InputError(f"{flank} flank: row {row}, col {col} was measured twice")
        seen.add((row, col))


def _check_places(
    flank: str,
    points: np.ndarray,
    deviation: np.ndarray,
    nominal: FlankPoints,
    at: np.ndarray,
    turn: float,
    columns: int,
) -> None:
    """Raise InputError unless measured points (n,3) lie on the nominal normals at ``at`` (n,), turned by ``turn``."""
    touched = turned(points, -2 * np.pi * turn) - deviation[:, None] * nominal.normal[at]
    apart = np.linalg.norm(touched - nominal.point[at], axis=1)
    if apart.max() > _SAME_POINT:
        k = int(np.argmax(apart))
        raise InputError(
            f"{flank} flank, row {at[k] // columns}, col {at[k] % columns}: the measured point lies {apart[k]:.4f} mm "
            f"beside the nominal normal, the limit is {_SAME_POINT} mm; is the file in mm, and of this set and hand?"
        )
