"""Errors of one member moved to the other: the pair keeps its ease-off, and only one member has to be cut again.

Where a flank of the member touches the mate, both have their normal in common (20.5, 20.6). So metal left on the one
does to the gap between them what as much metal left on the other does at the conjugate place. Taken together with what
the mate itself shows there, it can be corrected on the mate alone.
"""

from __future__ import annotations

import numpy as np

from gearmath.bevel import ease_off
from gearmath.bevel.flank import Grid
from gearmath.bevel.grid import file_grid
from gearmath.errors import ComputationError
from gearmath.kernels import kernel
from gearmath.quality.correction.target import flank_target
from gearmath.quality.evaluation.file_checks import check_belongs
from gearmath.specs.bevel_set import FLANKS, MEMBERS, BevelSet, Member
from gearmath.specs.flank_csv import FlankFile

#: The conjugate places lie this far from the mate's mean point at most, in face widths, or they are of no contact.
_FARTHEST = 1.5


def moved_to_mate(gear_set: BevelSet, name: str, measured: FlankFile, grid: FlankFile) -> dict[str, np.ndarray]:
    """Deviations [mm] on the grid (rows·columns,) of the mate that do to the pair what those of member ``name`` do.

    By flank of the mate: its concave flank meets the convex one. ``measured`` is the file of member ``name``, ``grid``
    one of the mate that says which grid is wanted. Between the conjugate places of the measured points, and a little
    beyond them, the deviations are interpolated by cubic splines.
    Raises InputError if the file is not of that member, ComputationError if its flanks do not meet those of the mate.
    """
    member, mate_name = gear_set.member(name), MEMBERS[1 - MEMBERS.index(name)]
    check_belongs(member, measured)
    mate = gear_set.member(mate_name)
    moved = {}
    for flank in FLANKS:
        target = flank_target(member, flank, measured)
        axial, radial = conjugate_places(
            gear_set, member, mate, target.nominal.point, target.nominal.normal, f"{name} {flank} flank"
        )
        other = FLANKS[1 - FLANKS.index(flank)]
        moved[other] = _interpolated(mate, Grid(axial, radial), target.deviation, file_grid(grid, mate, other))
    return moved


def conjugate_places(
    gear_set: BevelSet, member: Member, mate: Member, point: np.ndarray, normal: np.ndarray, what: str = "flank"
) -> tuple[np.ndarray, np.ndarray]:
    """Where points (n,3) of a member with normals (n,3) touch its mate: z (n,) and radius (n,) on the mate [mm].

    Of the two places that (20.5) has for each point, that on the mate's blank. Raises ComputationError if a point has
    none.
    """
    found = ease_off.conjugate_places(member, mate, gear_set.rad("shaft_angle"), point, normal)
    delta, mean = mate.blank.delta, mate.blank.mean_cone_distance
    away = np.hypot(found.axial - mean * np.cos(delta), found.radial - mean * np.sin(delta))
    away = np.where(np.isfinite(away), away, np.inf)
    if not (away <= _FARTHEST * mate.blank.face_width).all():
        k = int(away.argmax())
        raise ComputationError(f"{what}: point {k} does not meet the mate; its errors cannot be moved there")
    return found.axial, found.radial


def _interpolated(mate: Member, known: Grid, deviation: np.ndarray, wanted: Grid) -> np.ndarray:
    """Deviations (n,) known at places of the mate, at others (m,): polyharmonic spline r³ with a quadratic tail."""
    at, to = (_scaled(mate, grid) for grid in (known, wanted))
    n, tail = len(at), _quadratic(at)
    matrix = np.zeros((n + tail.shape[1], n + tail.shape[1]))
    matrix[:n, :n] = np.linalg.norm(at[:, None] - at[None], axis=2) ** 3
    matrix[:n, n:], matrix[n:, :n] = tail, tail.T
    weights, *_ = np.linalg.lstsq(matrix, np.concatenate([deviation, np.zeros(tail.shape[1])]), rcond=None)
    radial = np.linalg.norm(to[:, None] - at[None], axis=2) ** 3
    return radial @ weights[:n] + _quadratic(to) @ weights[n:]


def _scaled(mate: Member, grid: Grid) -> np.ndarray:
    """Places as parts of face width and depth (n,2), along and across the pitch cone, so that both count alike."""
    points = np.stack([grid.radial.ravel(), 0 * grid.radial.ravel(), grid.axial.ravel()], axis=1)
    along, down = kernel("root_place")(points, mate.blank.delta)
    depth = mate.blank.mean_addendum + mate.blank.mean_dedendum
    return np.stack([(along - mate.blank.mean_cone_distance) / mate.blank.face_width, down / depth], axis=1)


def _quadratic(place: np.ndarray) -> np.ndarray:
    x, y = place.T
    return np.stack([np.ones_like(x), x, y, x * x, x * y, y * y], axis=1)
