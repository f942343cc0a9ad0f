"""Tooth surfaces of every cutting method: one root finder for the family of chapter 10.

Face milled or face hobbed, generated or Formate, settings at rest or moving with the cradle, straight or arc blade:
what differs are the numbers of a :class:`Generation` and a :class:`Section` of its blade. A point is asked for by two
linear conditions c_u u + c_z z_w + c_r r_w = c on its blade parameter and its place, besides f = 0: a place of the
blank is z_w = ..., r_w = ...; the curve where two sections join is u = ..., at a cone distance.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from gearmath.bevel.generation_kernels import generation_point, generation_sense
from gearmath.bevel.newton import TOLERANCE, FlankPoints
from gearmath.engine.kernel import Kernel
from gearmath.kernels import kernel

_REPEATS = 10
#: Where a start from the still machine fails, motion and indexing grow to their full size in this many parts.
_HOMOTOPY = 8
#: Points among which a neighbour is sought.
_NEIGHBOURS = 2_000


@dataclass(frozen=True)
class Section:
    """A part of the blade's edge between two values of its parameter u, from the tip upwards.

    Straight: u is the height [mm]; ``point_radius`` and ``pressure_angle`` replace those of the settings, so that
    Toprem and Flankrem are sections like the others. Arc: u is the angle of the blade's normal [rad] and
    ``arc`` holds radius and height of the centre and the radius [mm], positive where the blade is convex.
    """

    lower: float
    upper: float
    point_radius: float
    pressure_angle: float
    arc: tuple[float, float, float] | None = None

    @property
    def tip_is_upper(self) -> bool:
        """Whether the tip of the blade is at the larger end: on a convex arc the normal falls from the tip upwards."""
        return self.arc is not None and self.arc[2] > 0


@dataclass(frozen=True)
class Generation:
    """How one flank comes about: settings (12,), motion (10,7) of them, indexing N_b/z, blade offset angle, side."""

    settings: np.ndarray
    side: int
    motion: np.ndarray = field(default_factory=lambda: np.zeros((10, 7)))
    index_ratio: float = 0.0
    blade_offset_angle: float = 0.0
    rolling: bool = True

    def with_blade(self, section: Section) -> Generation:
        """The same generation with the straight edge of a section of the blade."""
        settings = self.settings.copy()
        settings[-2:] = section.point_radius, section.pressure_angle
        return replace(self, settings=settings)

    @property
    def still(self) -> bool:
        """Whether this is the machine of chapters 2 to 4: nothing moves but cradle and work."""
        return not self.motion.any() and self.index_ratio == 0.0


@dataclass(frozen=True)
class SurfacePoints(FlankPoints):
    """Flank points with the residual (n,) [mm] of each and its turning sense (n,): zero at a singular point."""

    residual: np.ndarray
    sense: np.ndarray

    @property
    def converged(self) -> np.ndarray:
        """Which points (n,) satisfy place and meshing."""
        return self.residual <= TOLERANCE


@dataclass(frozen=True)
class BladeCut:
    """What one flank is cut by: its generation, and the sections of the blade from the tip upwards.

    By name: ``edge`` (if rounded), ``toprem`` (if there), ``main``.
    """

    how: Generation
    sections: dict[str, Section]

    @property
    def main(self) -> Section:
        """The section that cuts the flank itself."""
        return self.sections["main"]

    @property
    def is_plain(self) -> bool:
        """Whether a straight blade of a machine at rest generates the flank, as in chapters 2 to 4."""
        return self.how.still and self.how.rolling and self.main.arc is None

    def at(self, axial: np.ndarray, radial: np.ndarray) -> SurfacePoints:
        """Points that the main section cuts at places (n,), with or without being inside of it."""
        return solve_section(self.how, self.main, axial, radial)


def solve_section(
    flank: Generation, section: Section, axial: np.ndarray, radial: np.ndarray, start: np.ndarray | None = None
) -> SurfacePoints:
    """Points that a section of the blade cuts at places (n,), with or without being inside the section.

    Starts from the untilted crown gear (4.3); what does not converge is followed from the still machine, and then
    from its nearest converged neighbour. What is left is marked by its residual.
    """
    n = len(axial)
    conditions = np.zeros((n, 2, 4))
    conditions[:, 0, 1], conditions[:, 0, 3] = 1.0, axial
    conditions[:, 1, 2], conditions[:, 1, 3] = 1.0, radial
    if start is None:
        start = _start(flank.with_blade(section), section, axial, radial)
    return solve_conditions(flank, section, conditions, start)


def solve_curve(
    flank: Generation,
    section: Section,
    u: np.ndarray,
    direction: tuple[float, float],
    distance: np.ndarray,
    start: np.ndarray,
) -> SurfacePoints:
    """Points (n,) of a section with given blade parameters u (n,) on given lines of the axial plane.

    The lines are direction · (z_w, r_w) = distance (n,): with (cos δ, sin δ) those of constant cone distance.
    """
    conditions = np.zeros((len(u), 2, 4))
    conditions[:, 0, 0], conditions[:, 0, 3] = 1.0, u
    conditions[:, 1, 1:3], conditions[:, 1, 3] = direction, distance
    return solve_conditions(flank, section, conditions, start)


def solve_conditions(flank: Generation, section: Section, conditions: np.ndarray, start: np.ndarray) -> SurfacePoints:
    """Points (n,) of a section that satisfy conditions (n,2,4), from start values (n,3)."""
    flank = flank.with_blade(section)
    points = _newton(flank, section, conditions, start)
    if not points.converged.all() and not flank.still:
        lost = ~points.converged
        points = _better(points, lost, _grown(flank, section, conditions[lost], start[lost]))
    for _ in range(_REPEATS):
        lost = ~points.converged
        if not lost.any() or lost.all():
            break
        again = _newton(flank, section, conditions[lost], points.contact[_nearest(conditions, lost)])
        if not again.converged.any():
            break
        points = _put(points, lost, again)
    return points


def _start(flank: Generation, section: Section, axial: np.ndarray, radial: np.ndarray) -> np.ndarray:
    (start,) = kernel("contact_start")(flank.settings, flank.side, axial, radial)
    if section.arc is not None:
        start[:, 0] = (section.lower + section.upper) / 2
    if not flank.rolling:
        start[:, 2] = 0.0
    return start


def turning_sense(flank: Generation, section: Section, contact: np.ndarray) -> np.ndarray:
    """Sense (n,) of points that are found already: it changes its sign at a singular line, where undercut begins."""
    (sense,) = _run(generation_sense(section.arc is not None), flank.with_blade(section), section, contact, None)
    return sense


def _newton(flank: Generation, section: Section, conditions: np.ndarray, start: np.ndarray) -> SurfacePoints:
    solve = generation_point(section.arc is not None)
    points = SurfacePoints(*_run(solve, flank, section, start, conditions))
    for _ in range(_REPEATS):
        open_ = ~points.converged & np.isfinite(points.contact).all(axis=1)
        if not open_.any():
            break
        again = SurfacePoints(*_run(solve, flank, section, points.contact[open_], conditions[open_]))
        if not (again.residual < points.residual[open_]).any():
            break
        points = _put(points, open_, again)
    return points


def _run(
    run: Kernel, flank: Generation, section: Section, contact: np.ndarray, conditions: np.ndarray | None
) -> tuple[np.ndarray, ...]:
    arc = () if section.arc is None else (np.array(section.arc),)
    given = (flank.settings, flank.motion, flank.index_ratio, flank.blade_offset_angle, *arc, flank.side, flank.rolling)
    return run(contact, *given, np.zeros((2, 4)) if conditions is None else conditions)


def _grown(flank: Generation, section: Section, conditions: np.ndarray, start: np.ndarray) -> SurfacePoints:
    """The points followed from the still machine, while motion and indexing grow to their full size."""
    contact = start
    for part in np.linspace(0.0, 1.0, _HOMOTOPY + 1):
        partly = replace(flank, motion=part * flank.motion, index_ratio=part * flank.index_ratio)
        points = _newton(partly, section, conditions, contact)
        contact = np.where(points.converged[:, None], points.contact, contact)
    return points


def _nearest(conditions: np.ndarray, lost: np.ndarray) -> np.ndarray:
    """For every lost point the index of a near one that converged, by the right-hand sides."""
    good = np.flatnonzero(~lost)
    good = good[:: len(good) // _NEIGHBOURS + 1]
    wanted, among = conditions[lost][:, :, 3], conditions[good][:, :, 3]
    apart = [np.linalg.norm(among - one, axis=1) for one in wanted]
    return good[[int(np.argmin(row)) for row in apart]]


def _better(first: SurfacePoints, where: np.ndarray, second: SurfacePoints) -> SurfacePoints:
    """The points with those of ``second``, found for the points ``where``, that converged."""
    found = second.converged
    take = np.flatnonzero(where)[found]
    return _put(first, take, SurfacePoints(*(getattr(second, name)[found] for name in _FIELDS)))


def _put(points: SurfacePoints, where: np.ndarray, new: SurfacePoints) -> SurfacePoints:
    arrays = [getattr(points, name).copy() for name in _FIELDS]
    for array, name in zip(arrays, _FIELDS, strict=True):
        array[where] = getattr(new, name)
    return SurfacePoints(*arrays)


_FIELDS = ("contact", "point", "normal", "residual", "sense")
