"""Points of generated flanks: the equation of meshing solved on a grid, for many points in one mapped call.

A point is asked for by its place on the blank, (z_w, r_w). The unknowns are u, β, θ of chapter 3:

    z(R) = z_w,   (R_x² + R_y² - r_w²) / (2 r_w) = 0,   f / S = 0

No point leaves this module that is not converged, or that lies off the blade.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache

import casadi as ca
import numpy as np

from derivations import notation
from gearmath.bevel.generation import BladeCut, SurfacePoints, solve_curve, turning_sense
from gearmath.bevel.method import nominal_cut
from gearmath.bevel.newton import TOLERANCE, FlankPoints, contact_guess, newton_step, residual_size
from gearmath.engine.kernel import Kernel
from gearmath.errors import InputError
from gearmath.kernels import kernel
from gearmath.specs.bevel_set import FLANKS, Member
from gearmath.specs.margins import Margins

#: Newton steps of one call of the kernel; the solver repeats the call where that is not enough.
NEWTON_STEPS = 5
_REPEATS = 12
#: Largest change of u [mm], β and θ [rad] in one Newton step.
_STEP_LIMITS = (4.0, 0.3, 0.3)
#: A blade has this much tolerance at its ends, so that a point on the tip is not lost to rounding. [mm]
_BLADE_SLACK = 1e-7
#: Points in which a blade is followed to its tip in search of a singular line.
_FOLLOWED = 60
_UNDERCUT = "the flank is undercut there, its surface turns back on itself"


@dataclass(frozen=True)
class Grid:
    """Places on a flank, rows root to tip and columns toe to heel, as (z_w, r_w) of shape (rows, columns) [mm]."""

    axial: np.ndarray
    radial: np.ndarray

    @property
    def shape(self) -> tuple[int, int]:
        return self.axial.shape  # type: ignore[return-value]


def blank_grid(member: Member, rows: int = 5, columns: int = 9, margin: float | Margins = 0.1) -> Grid:
    """The grid of the flank files: ``margin`` of face width and working depth is left out, alike on all sides or not.

    A single row or column stands in the middle of what is left.
    """
    margins = margin if isinstance(margin, Margins) else Margins.alike(margin)
    across, up = (
        np.linspace(low, 1 - high, count) if count > 1 else np.array([(low + 1 - high) / 2])
        for low, high, count in ((margins.toe, margins.heel, columns), (margins.root, margins.tip, rows))
    )
    up_all, across_all = (array.ravel() for array in np.meshgrid(up, across, indexing="ij"))
    axial, radial = kernel("flank_place")(member.blank.vector, across_all, up_all)
    return Grid(axial.reshape(rows, columns), radial.reshape(rows, columns))


def _residual(w: ca.SX, settings: ca.SX, side: ca.SX, axial: ca.SX, radial: ca.SX) -> ca.SX:
    """Residuals [mm] of place and meshing at w = (u, β, θ)."""
    point, _ = kernel("flank_family").function(w[0], w[1], w[2], settings, side)
    meshing = kernel("meshing").function(w[0], w[1], w[2], settings, side)
    off_radius = (point[0] ** 2 + point[1] ** 2 - radial**2) / (2 * radial)
    return ca.vertcat(point[2] - axial, off_radius, meshing / settings[0])


@cache
def flank_point() -> Kernel:
    """Kernel: start values, settings, side and place in; parameters, point, normal and residual out.

    A fixed number of damped Newton steps, so that the same kernel runs mapped in the VM and as C without a loop bound.
    """
    quantities = (notation.contact, notation.settings, notation.side, notation.axial, notation.radial)
    w, *place = (ca.SX.sym(quantity.name, max(quantity.size, 1)) for quantity in quantities)
    step = ca.Function("flank_newton_step", [w, *place], [newton_step(_residual(w, *place), w, _STEP_LIMITS)])
    guess, *given = (ca.MX.sym(quantity.name, max(quantity.size, 1)) for quantity in (contact_guess, *quantities[1:]))
    solution = guess
    for _ in range(NEWTON_STEPS):
        solution = step(solution, *given)
    surface = ca.Function("flank_at", [w, *place], _surface(w, *place))
    function = ca.Function(
        "flank_point",
        [guess, *given],
        [solution, *surface(solution, *given)],
        ["contact_guess", *(quantity.name for quantity in quantities[1:])],
        ["contact", "point_w", "normal_w", "residual_size"],
    )
    return Kernel(
        function,
        f"Point and outward normal of a generated flank at a place on the blank, {NEWTON_STEPS} damped Newton steps.",
        (contact_guess, *quantities[1:]),
        (notation.contact, notation.point_w, notation.normal_w, residual_size),
        "equation of meshing (4.2) and family (3.1, 3.2)",
    )


def _surface(w: ca.SX, *place: ca.SX) -> list[ca.SX]:
    point, normal = kernel("flank_family").function(w[0], w[1], w[2], place[0], place[1])
    # norm_2: the largest element would be taken by fmax, which passes over NaN, so that NaN would count as converged
    return [point, normal, ca.norm_2(_residual(w, *place))]


def solve_places(
    settings: np.ndarray, side: int, axial: np.ndarray, radial: np.ndarray, start: np.ndarray | None = None
) -> tuple[FlankPoints, np.ndarray]:
    """Points at the places (n,), and their residuals (n,) [mm]; what did not converge has a residual to say so."""
    if start is None:
        (start,) = kernel("contact_start")(settings, side, axial, radial)
    contact, point, normal, residual = flank_point()(start, settings, side, axial, radial)
    for _ in range(_REPEATS):
        open_ = ~(residual <= TOLERANCE) & np.isfinite(contact).all(axis=1)
        if not open_.any():
            break
        again = flank_point()(contact[open_], settings, side, axial[open_], radial[open_])
        contact[open_], point[open_], normal[open_], residual[open_] = again
    return FlankPoints(contact, point, normal), residual


def nominal_points(member: Member, flank: str, grid: Grid) -> tuple[FlankPoints, np.ndarray]:
    """Points that the main section of the blade cuts on a grid, and their residuals, for every cutting method."""
    return _points(nominal_cut(member, flank), grid)


def _points(by: BladeCut, grid: Grid) -> tuple[FlankPoints, np.ndarray]:
    place = (grid.axial.ravel(), grid.radial.ravel())
    if by.is_plain:
        simple, residual = solve_places(by.how.settings, by.how.side, *place)
        if (residual <= TOLERANCE).all():
            return simple, residual
    points = by.at(*place)
    return points, points.residual


def solve_flank(member: Member, flank: str, grid: Grid) -> FlankPoints:
    """The points of a grid on one flank, row by row.

    Raises InputError naming member, flank, row and column of the first point that does not converge, that is
    undercut, or that lies off the main section of the blade.
    """
    if flank not in FLANKS:
        raise ValueError(f"flank = {flank!r}: must be one of {FLANKS}")
    by = nominal_cut(member, flank)
    section = by.main
    found, residual = _points(by, grid)
    sense = turning_sense(by.how, section, found.contact)
    points = SurfacePoints(found.contact, found.point, found.normal, residual, sense)
    u, unit = points.contact[:, 0], "mm" if section.arc is None else "rad"
    short, long = u < section.lower - _BLADE_SLACK, u > section.upper + _BLADE_SLACK
    below, above = (long, short) if section.tip_is_upper else (short, long)
    for failed, what in (
        (~points.converged, "the equation of meshing has no solution near the start value"),
        (_turned_back(points, grid), _UNDERCUT),
        (below, "the point lies below the blade tip or its main section, on the fillet or beyond"),
        (above, "the point lies above the blade"),
    ):
        if failed.any():
            k = int(np.argmax(failed))
            row, column = divmod(k, grid.shape[1])
            if not points.converged[k] and _folds_above(by, points, grid, k, member.blank.delta):
                what = _UNDERCUT
            raise InputError(
                f"{member.name} {flank} flank, row {row}, column {column}: {what} "
                f"(u = {u[k]:.4f} {unit}, the main section runs from {section.lower:g} to {section.upper:g} {unit})"
            )
    return points


def _turned_back(points: SurfacePoints, grid: Grid) -> np.ndarray:
    """Which points (n,) lie beyond a singular line: their sense is not that of the reference point."""
    rows, columns = grid.shape
    reference = points.sense[(rows // 2) * columns + columns // 2]
    return np.sign(points.sense) != np.sign(reference)


def _folds_above(by: BladeCut, points: SurfacePoints, grid: Grid, k: int, delta: float) -> bool:
    """Whether the flank turns back on itself between point k and the nearest one found: it is undercut there.

    The blade is followed from that point to its tip, at its cone distance: at the singular line the sense vanishes.
    """
    found = np.flatnonzero(points.converged)
    if not len(found) or not np.isfinite(grid.axial.ravel()[k] + grid.radial.ravel()[k]):
        return False
    place = np.stack([grid.axial.ravel(), grid.radial.ravel()], axis=1)
    nearest = found[np.argmin(np.linalg.norm(place[found] - place[k], axis=1))]
    direction = (math.cos(delta), math.sin(delta))
    start, distance = points.contact[nearest], place[nearest] @ direction
    tip = by.main.upper if by.main.tip_is_upper else by.main.lower
    for u in np.linspace(start[0], tip, _FOLLOWED)[1:]:
        one = solve_curve(by.how, by.main, np.array([u]), direction, np.array([distance]), np.array([[u, *start[1:]]]))
        if not one.converged[0]:
            return False
        if np.sign(one.sense[0]) != np.sign(points.sense[nearest]):
            return True
        start = one.contact[0]
    return False
