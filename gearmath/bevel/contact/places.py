"""Where points of the gear's flank would meet the pinion at the constant ratio, and what error each brings: ease-off.

Every point of a grid is turned to the place where it meets the pinion (25.7) at the given assembly; the pinion's flank
is found there, and the rotation of the pinion at which both touch. The map is exact where the pair is conjugate, close
elsewhere: for ease-off, contact lines, patterns, and as start values of the exact contact.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from gearmath.bevel.contact.surface import BORDERS, ROOT, ContactSurface
from gearmath.bevel.contact.system import System
from gearmath.bevel.newton import FlankPoints
from gearmath.bevel.turning import half_turn
from gearmath.kernels import kernel
from gearmath.remembered import remembered

_ROWS, _COLUMNS = 9, 17
#: Which borders of both flanks make an edge.
_EDGES = np.array([name != "root" for name in BORDERS] * 2)
_COUNT = len(_EDGES)
#: Parts of the depth of a fillet: so deep below the root a tip may lie to be tried, from so deep on the fillet at most.
_REACH, _BEGUN = 3.0, 0.8


@dataclass(frozen=True)
class Places:
    """A grid of the gear's flank, rows root to tip, columns toe to heel; NaN where the gear does not meet the pinion.

    ``rotation`` of the pinion [rad] at which a point touches, ``error`` φ_2 + i φ_1 there [rad], ``lever`` [mm] of the
    normal about the gear's axis, start values ``x`` (rows, columns, 7), distances (rows, columns, 8) [mm] from all
    borders, place on the gear (cone distance and height above the pitch cone [mm]).
    """

    rotation: np.ndarray
    error: np.ndarray
    lever: np.ndarray
    x: np.ndarray
    distance: np.ndarray
    cone_distance: np.ndarray
    height: np.ndarray

    @property
    def common(self) -> np.ndarray:
        """Which points lie within the borders of both flanks."""
        with np.errstate(invalid="ignore"):
            return np.isfinite(self.error) & (self.distance > -1e-6).all(axis=-1)


def places(system: System, assembly: np.ndarray, rows: int = _ROWS, columns: int = _COLUMNS) -> Places:
    """The map of the gear's whole flank, from the lower limit of its working depth to its tip."""
    gear, pinion = system.gear, system.pinion
    own = _grid(gear, rows, columns)
    pair = (system.shaft_angle, system.offset, assembly)
    given = (own.point, own.normal, gear.apex_beyond, *pair)
    found = []
    for side in (1, -1):
        (turn,) = kernel("meeting")(*given, system.ratio, side)
        point, normal = kernel("gear_in_pair")(own.point, own.normal, turn, gear.apex_beyond, *pair)
        found.append((turn, point, normal))
    delta, mean = pinion.pitch_angle, pinion.blank.mean_cone_distance
    center = mean * np.array([math.sin(delta), 0.0, math.cos(delta)])  # on the pitch line
    away = np.stack([np.nan_to_num(np.linalg.norm(point - center, axis=1), nan=np.inf) for _, point, _ in found])
    branch = away.argmin(axis=0)
    turn, point, normal = (np.where(_column(branch == 0, a), a, b) for a, b in zip(*found, strict=True))
    lever, _ = kernel("transmission")(point, normal, *pair)
    seen = np.stack([point[:, 2] - assembly[1] + pinion.apex_beyond, np.hypot(point[:, 0], point[:, 1])])
    mate = np.full((3, len(turn), 3), np.nan)
    meets = np.isfinite(seen).all(axis=0)
    if meets.any():
        solved = pinion.solve(*seen[:, meets])
        mate[:, meets] = solved.contact, solved.point, solved.normal
    contact, on_pinion, _ = mate
    rotation = np.arctan2(point[:, 1], point[:, 0]) - np.arctan2(on_pinion[:, 1], on_pinion[:, 0]) - system.phase[0]
    rotation, gear_rotation = half_turn(rotation), half_turn(turn - system.phase[1])
    error = gear_rotation + system.ratio * rotation
    shape = (rows, columns)
    x = np.column_stack([contact, own.contact, gear_rotation])
    distance = np.concatenate([pinion.distances(contact), gear.distances(own.contact)], axis=1)
    along, depth = kernel("root_place")(own.point, gear.pitch_angle)
    rotation, error, lever, along, height = (one.reshape(shape) for one in (rotation, error, lever, along, -depth))
    return Places(rotation, error, lever, x.reshape(*shape, 7), distance.reshape(*shape, -1), along, height)


@remembered(32)
def _grid(surface: ContactSurface, rows: int, columns: int) -> FlankPoints:
    """Points of a flank on a grid of its blank, row by row; the assembly does not change them."""
    up, across = (
        one.ravel() for one in np.meshgrid(np.linspace(0, 1, rows), np.linspace(0, 1, columns), indexing="ij")
    )
    return surface.solve(*kernel("flank_place")(surface.blank.vector, across, up))


def _column(mask: np.ndarray, like: np.ndarray) -> np.ndarray:
    return mask.reshape(-1, *(1,) * (like.ndim - 1))


@dataclass(frozen=True)
class Seed:
    """Where a contact may be: rotation of the pinion, start values (7,), borders that would be active."""

    rotation: float
    x: np.ndarray
    active: tuple[int, ...]


#: Distance [mm] from a border that counts as none.
ON = 1e-6


def on_border(found: Places, which: int, *more: np.ndarray) -> np.ndarray:
    """Where columns and rows of the grid cross a border: distances from all (n,8), and ``more`` of the grid's values.

    ``more`` (rows, columns, k); a border along which the grid ends is crossed there.
    """
    fields = np.concatenate([found.distance, *more], axis=-1)
    crossings = []
    for values in (fields, fields.swapaxes(0, 1)):
        one, other = values[:-1], values[1:]
        a, b = one[..., which], other[..., which]
        with np.errstate(invalid="ignore"):
            crossed = (np.minimum(a, b) <= ON) & (np.maximum(a, b) >= -ON) & (np.abs(a - b) > ON)
        part = np.clip((a / np.where(a == b, 1.0, a - b))[crossed], 0.0, 1.0)[:, None]
        crossings.append((1 - part) * one[crossed] + part * other[crossed])
    line = np.concatenate(crossings)
    return line[np.isfinite(line).all(axis=1)]


def contact_line(found: Places, rotation: float) -> tuple[np.ndarray, ...]:
    """The contact line at a rotation, toe to heel: where it crosses the columns and the rows of the grid.

    Errors (n,), start values (n,7), distances from borders (n,8), cone distances and heights (n,) at the crossings.
    """
    fields = np.concatenate(
        [found.error[..., None], found.x, found.distance, found.cone_distance[..., None], found.height[..., None]],
        axis=-1,
    )
    crossings = []
    for level, values in ((found.rotation, fields), (found.rotation.T, fields.swapaxes(0, 1))):
        one, other = level[:-1] - rotation, level[1:] - rotation
        with np.errstate(invalid="ignore"):
            between = one * other <= 0
        part = (one / np.where(one == other, 1.0, one - other))[between][:, None]
        crossings.append((1 - part) * values[:-1][between] + part * values[1:][between])
    line = np.concatenate(crossings)
    line = line[np.isfinite(line).all(axis=1)]
    line = line[np.argsort(line[:, -2], kind="stable")]
    return line[:, 0], line[:, 1:8], line[:, 8:16], line[:, -2], line[:, -1]


def seeds(found: Places, rotation: float, sense: float) -> list[Seed]:
    """Start values of the contacts at a rotation: where the gear is stopped first along the contact line."""
    error, x, distance, _, _ = contact_line(found, rotation)
    inside = (distance > -1e-6).all(axis=1)
    error, x, distance = sense * error[inside], x[inside], distance[inside]
    found_seeds = []
    for k in range(len(error)):
        before, after = error[max(k - 1, 0)], error[min(k + 1, len(error) - 1)]
        if error[k] < before or error[k] < after:
            continue
        at_end = k in (0, len(error) - 1)
        active = (int(np.argmin(np.where(_EDGES, distance[k], np.inf))),) if at_end else ()
        found_seeds.append(Seed(rotation, x[k], active))
    return found_seeds


def fillet_seeds(system: System, found: Places) -> list[Seed]:
    """Start values of the tip edges on their mates' fillets: where a tip passes the root of the mate's flank."""
    begun = []
    for side, surface in enumerate((system.pinion, system.gear)):
        tip, root = len(BORDERS) * (1 - side), len(BORDERS) * side + ROOT
        if surface.fillet is None or not (found.distance[..., root] < 0).any():
            continue
        line = on_border(found, tip, found.x, found.rotation[..., None])
        distance, x, rotation = line[:, :_COUNT], line[:, _COUNT:-1], line[:, -1]
        below = surface.below_root(x[:, 3 * side : 3 * side + 3])
        # a tip that would reach deeper into the flank than the fillet does may still stop on it
        inside = (np.delete(distance, root, axis=1) > -ON).all(axis=1) & (below > 0) & (below < _REACH * surface.depth)
        x[:, 3 * side] += (np.minimum(below, _BEGUN * surface.depth) - below) * -surface.borders[ROOT][0]
        active = tuple(sorted((tip, root)))
        begun += [Seed(float(rotation[k]), x[k], active) for k in np.flatnonzero(inside)]
    return sorted(begun, key=lambda seed: abs(seed.rotation))
