"""Lines along the normals of flank points, with the blade and the cradle rotation that generate each point."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from gearmath.bevel.flank import Grid
from gearmath.bevel.generation import BladeCut
from gearmath.bevel.method import actual_cut
from gearmath.kernels import kernel
from gearmath.machine.planning.path import below_the_flank, flank_points, points_found
from gearmath.specs.bevel_set import SIDES, Member

_COLUMNS = 801
#: Points of a curve that has others where they are asked for.
_EVEN = 101
#: The points go beyond the flank by this part of it: a machine that is off its settings cuts the flank's edges at
#: other cradle rotations, and must not find a long block of the overrun there. The lowest row along the tooth is where
#: the mate reaches: below it the flank may end in an undercut before the blade does, which has the row of its foot.
_BEYOND = 0.02
_UP, _ACROSS = (0.0, 0.25, 0.5, 0.75, 1.0, 1 + _BEYOND), (-_BEYOND, 0.0, 1.0, 1 + _BEYOND)
#: At toe and heel they go this part of the working depth below it, as far as the blade reaches.
_DEEP = 0.3
#: Nearer to the end of the blade than this [mm] a point belongs to the fillet.
_TIP = 0.05


@dataclass(frozen=True)
class GeneratedLines:
    """Points of a flank (n,3) [mm] with outward normals, and what generates each: cradle rotation and blade.

    ``theta`` (n,) [rad] rises within a row. ``radius`` [mm], ``angle`` [rad] and ``side`` (n,) are point radius,
    pressure angle and side of the blade, or of the straight blade that touches an arc blade there.
    """

    theta: np.ndarray
    point: np.ndarray
    normal: np.ndarray
    radius: np.ndarray
    angle: np.ndarray
    side: np.ndarray

    def __len__(self) -> int:
        return len(self.theta)

    def at(self, chosen: np.ndarray) -> GeneratedLines:
        """Some of the lines, by their indices."""
        return GeneratedLines(*(part[chosen] for part in self._parts))

    @property
    def on_blade(self) -> tuple[np.ndarray, ...]:
        """Points, normals and blades, as ``line_entry`` takes them."""
        return self._parts[1:]

    @property
    def _parts(self) -> tuple[np.ndarray, ...]:
        return self.theta, self.point, self.normal, self.radius, self.angle, self.side


def joined(rows: Sequence[GeneratedLines]) -> GeneratedLines:
    """Rows one behind the other."""
    return GeneratedLines(*map(np.concatenate, zip(*(row._parts for row in rows), strict=True)))


def flank_rows(member: Member, flank: str) -> Iterator[GeneratedLines]:
    """Rows of points that every line of contact crosses at its ends and between: along the tooth, at toe and heel."""
    by = actual_cut(member, flank)
    for grid in _curves(member):
        yield flank_row(by, grid)


def flank_curve(
    member: Member, flank: str, rolls: np.ndarray, up: float | None = None, across: float | None = None
) -> GeneratedLines:
    """Lines along the tooth at ``up``, or up the tooth at ``across``.

    They lie evenly, and where the curve is generated at ``rolls`` (m,). Up the tooth they begin as deep as the blade
    reaches, where the foot of the flank ends.
    """

    def grid(places: np.ndarray) -> Grid:
        given = (places if across is None else np.full(len(places), across), places if up is None else up)
        axial, radial = kernel("flank_place")(member.blank.vector, given[0], np.broadcast_to(given[1], len(places)))
        return Grid(axial[None], radial[None])

    even = np.linspace(0.0 if across is None else -_DEEP, 1.0, _EVEN)
    theta = flank_points(member, flank, grid(even)).contact[:, 2]
    return flank_row(actual_cut(member, flank), grid(np.union1d(even, _places(rolls, theta, even))))


def foot_curves(member: Member, flank: str, rolls: np.ndarray | None = None) -> Iterator[GeneratedLines]:
    """The same for the lower ends of the flank, along the tooth. What the edge cuts lies between flank and root.

    Without ``rolls`` they lie evenly, and closer.
    """
    across = np.linspace(-_BEYOND, 1 + _BEYOND, _COLUMNS // 2 if rolls is None else _EVEN)
    if rolls is not None:
        found = [_places(rolls, foot.theta, place) for place, foot in _feet(member, flank, across)]
        across = np.unique(np.concatenate([across, *found]))
    yield from (foot for _, foot in _feet(member, flank, across))


def _feet(member: Member, flank: str, across: np.ndarray) -> Iterator[tuple[np.ndarray, GeneratedLines]]:
    """Parts of the face width (n,) and lines of the lower ends of the flank."""
    for part, points, blade in below_the_flank(member, flank, across):
        if part == "edge":
            return
        kept = np.flatnonzero(points.converged)
        order = kept[np.argsort(points.contact[kept, 2], kind="stable")]
        side = np.full(len(order), float(SIDES[flank]))
        at = points.contact[order, 2], points.point[order], points.normal[order]
        yield across[order], GeneratedLines(*at, blade[order, 0], blade[order, 1], side)


def _places(rolls: np.ndarray, theta: np.ndarray, place: np.ndarray) -> np.ndarray:
    """Where a curve is generated at the ``rolls`` that it has, from the cradle rotations at some places of it."""
    order = np.argsort(theta)
    here = rolls[(rolls > theta.min(initial=math.inf)) & (rolls < theta.max(initial=-math.inf))]
    return np.interp(here, theta[order], place[order]) if len(here) else here


def _curves(member: Member) -> Iterator[Grid]:
    everywhere = np.linspace(-_BEYOND, 1 + _BEYOND, _COLUMNS)
    depth = np.linspace(-_DEEP, 1 + _BEYOND, _COLUMNS)
    along = [(everywhere, np.full(_COLUMNS, up)) for up in _UP]
    ends = [(np.full(_COLUMNS, across), depth) for across in _ACROSS]
    for across, up in (*along, *ends):
        axial, radial = kernel("flank_place")(member.blank.vector, across, up)
        yield Grid(axial[None], radial[None])


def flank_row(by: BladeCut, grid: Grid) -> GeneratedLines:
    """The points of one row that lie on the blade; none where an undercut takes away the whole row."""
    section, side = by.main, by.how.side
    points = points_found(by, grid)
    u = points.contact[:, 0]
    if section.arc is None:
        on_blade = (u > section.lower + _TIP) & (u < section.upper)
        blade = np.broadcast_to([section.point_radius, section.pressure_angle], (len(u), 2))
    else:
        on_blade = (u > section.lower) & (u < section.upper)
        blade = np.column_stack(kernel("touching_blade")(u, np.array(section.arc), side))
    order = np.flatnonzero(on_blade)[np.argsort(points.contact[on_blade, 2], kind="stable")]
    at = points.contact[order, 2], points.point[order], points.normal[order]
    return GeneratedLines(*at, blade[order, 0], blade[order, 1], np.full(len(order), float(side)))
