"""The exact way of the cutter through one tooth space: passes, roll range, and axis positions at a cradle rotation."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from derivations.notation import SINGULAR_SINE
from gearmath.bevel.flank import Grid, blank_grid, solve_places
from gearmath.bevel.generation import BladeCut, Section, SurfacePoints, solve_curve, solve_section
from gearmath.bevel.method import actual_cut, motion_of
from gearmath.bevel.newton import TOLERANCE, FlankPoints
from gearmath.bevel.tooth import sharp_edged
from gearmath.errors import InputError
from gearmath.kernels import kernel
from gearmath.specs.bevel_set import FLANKS, Flank, Member
from gearmath.specs.milling_machine import MillingMachine

#: How far the flank may deviate from nominal because of straight blocks. [mm]
DEFAULT_TOLERANCE = 1e-4
#: The roll begins and ends this far outside the contact of the whole flank. [rad]
OVERRUN = math.radians(2.0)
_APEX_ON_B_AXIS = np.zeros(3)
#: Of a long row, places so far apart are solved first.
_EVERY = 20
#: In so many steps a row goes from half of the working depth to the lower end of the blade.
_STEPS_DOWN = 4
#: Normals between flank and root at which the rounded edge of a blade is looked at, as parts of its arc; the last is
#: nearly that of the tip plane.
_ON_EDGE = (0.5, 0.99)


@dataclass(frozen=True)
class Cut:
    """One pass of one tool: the flanks it finishes, with the settings of each."""

    tool: str
    flanks: tuple[str, ...]

    @staticmethod
    def of(member: Member) -> tuple[Cut, ...]:
        """The passes that cut a space: one for a completing cutter, one a flank for fixed settings."""
        if member.cutting == "completing":
            return (Cut(member.name.upper(), FLANKS),)
        return tuple(Cut(f"{member.name}_{flank}".upper(), (flank,)) for flank in FLANKS)


def flank_points(member: Member, flank: str, grid: Grid) -> FlankPoints:
    """Points that the main section of the blade cuts with the settings as they are, for every cutting method.

    Those without a solution are left out: the corners of a grid may lie beyond what the blade reaches.
    Raises InputError where that is so everywhere.
    """
    points = points_found(actual_cut(member, flank), grid)
    if not len(points.contact):
        raise InputError(f"{flank} flank: the equation of meshing has no solution anywhere on the flank")
    return points


def points_found(by: BladeCut, grid: Grid) -> FlankPoints:
    """The same for a row that may lie beyond the flank altogether: none then."""
    axial, radial = grid.axial.ravel(), grid.radial.ravel()
    if by.is_plain:
        points, residual = solve_places(by.how.settings, by.how.side, axial, radial)
    else:
        points = _row_points(by, axial, radial)
        residual = points.residual
    found = residual <= TOLERANCE
    return FlankPoints(points.contact[found], points.point[found], points.normal[found])


def _row_points(by: BladeCut, axial: np.ndarray, radial: np.ndarray) -> SurfacePoints:
    """Points at places that follow each other on a flank: many of them start from every twentieth.

    Beside one of these without a solution, which takes long to find out, none is sought.
    """
    some = np.arange(0, len(axial), _EVERY)
    if len(some) < _EVERY:
        return by.at(axial, radial)
    coarse = by.at(axial[some], radial[some])
    good = coarse.converged
    if not good.any():
        return coarse
    index = np.arange(len(axial))
    near = np.interp(index, some, good.astype(float)) == 1.0
    start = np.column_stack([np.interp(index[near], some[good], values) for values in coarse.contact[good].T])
    return solve_section(by.how, by.main, axial[near], radial[near], start)


def whole_flank(member: Member, flank: str) -> FlankPoints:
    """Points over the whole face and working depth."""
    return flank_points(member, flank, blank_grid(member, 7, 13, 0.0))


def below_the_flank(member: Member, flank: str, across: np.ndarray) -> Iterator[tuple[str, SurfacePoints, np.ndarray]]:
    """What the lower end of the blade cuts, row by row downwards: points at parts ``across`` (n,) of the face width.

    The rows are the lower ends of the main section and of a Toprem, and the rounded edge down to the root; a sharp
    blade is taken to have the smallest radius there is. With each row come the name of its section, and point radius
    and pressure angle (n,2) of the straight blade that touches there. Points without a solution say so.
    """
    by = actual_cut(member.model_copy(update={flank: sharp_edged(member.flank(flank))}), flank)
    delta = member.blank.delta
    direction = (math.cos(delta), math.sin(delta))
    axial, radial = kernel("flank_place")(member.blank.vector, across, np.full(len(across), 0.5))
    distance = axial * direction[0] + radial * direction[1]
    start = by.at(axial, radial).contact
    for part in reversed(by.sections):
        section = by.sections[part]
        for u, wanted in _downwards(part, section, start[:, 0]):
            if part == "edge":
                start = np.column_stack([u, start[:, 1:]])
            row = solve_curve(by.how, section, u, direction, distance, start)
            start = row.contact
            if wanted:
                yield part, row, _touching(section, u, by.how.side)


def _downwards(part: str, section: Section, now: np.ndarray) -> Iterator[tuple[np.ndarray, bool]]:
    """Blade parameters (n,) on the way to the lower end of a section, or along the edge; whether they are a row."""
    if part == "edge":
        for share in _ON_EDGE:
            yield np.full(len(now), section.lower + share * (section.upper - section.lower)), True
        return
    last = section.upper if section.tip_is_upper else section.lower
    steps = _STEPS_DOWN if part == "main" else 1
    for step in range(1, steps + 1):
        yield now + step / steps * (last - now), step == steps


def _touching(section: Section, u: np.ndarray, side: int) -> np.ndarray:
    """Point radius and pressure angle (n,2) of the straight blade that touches a section."""
    if section.arc is None:
        return np.broadcast_to([section.point_radius, section.pressure_angle], (len(u), 2))
    return np.column_stack(kernel("touching_blade")(u, np.array(section.arc), side))


@lru_cache(maxsize=32)
def roll_range(member: Member, cut: Cut) -> tuple[float, float]:
    """Cradle rotations [rad] between which the cutter generates the flanks of a pass, their fillets and the root."""
    theta = [whole_flank(member, flank).contact[:, 2] for flank in cut.flanks]
    if member.generation == "generated":
        ends = np.linspace(0.0, 1.0, 5)
        rows = (row for flank in cut.flanks for _, row, _ in below_the_flank(member, flank, ends))
        theta += [row.contact[row.converged, 2] for row in rows]
    together = np.concatenate(theta)
    return float(together.min()) - OVERRUN, float(together.max()) + OVERRUN


def axis_positions(
    flank: Flank, theta: np.ndarray, pivot_height: float, pivot_offset: np.ndarray = _APEX_ON_B_AXIS
) -> np.ndarray:
    """X, Y, Z, A, B (n,5) [mm, rad] at cradle rotations (n,), moving settings included.

    Of the two poses of (5.5) it is always the one with B below 90 degrees. A is continuous: it starts within half a
    turn of zero, and no step to the next row is longer than half a turn. Raises InputError naming the cradle angle at
    which the cutter axis is (nearly) parallel to the work axis.
    """
    settings, motion = flank.vector, motion_of(flank)
    if motion.any():
        (settings,) = kernel("moved_settings")(settings, motion, theta)
    (axes,) = kernel("axis_transform")(settings, theta, pivot_height, pivot_offset)
    singular = ~(np.abs(np.cos(axes[:, 4])) >= float(SINGULAR_SINE))
    if singular.any():
        at = math.degrees(theta[int(np.argmax(singular))])
        raise InputError(
            f"at cradle angle {at:.3f} deg the cutter axis is parallel to the work axis within "
            f"|V_c x V_p| = {float(SINGULAR_SINE)}: the work axis A has no position there"
        )
    axes[:, 3] = np.unwrap(axes[:, 3])
    if len(axes):
        axes[:, 3] -= 2 * math.pi * np.round(axes[0, 3] / (2 * math.pi))
    return axes


def spindle_phase(flank: Flank, theta: np.ndarray) -> np.ndarray:
    """ψ (5.8) at cradle rotations (n,), moving settings included, continuous."""
    settings, motion = flank.vector, motion_of(flank)
    if motion.any():
        (settings,) = kernel("moved_settings")(settings, motion, theta)
    (psi,) = kernel("cutter_phase")(settings, theta)
    return np.unwrap(psi)


def six_axes(
    flank: Flank, theta: np.ndarray, beta: np.ndarray, index_ratio: float, pivot_height: float, pivot: np.ndarray
) -> np.ndarray:
    """X Y Z A B C (n,6) at cradle rotations and cutter angles (n,); A and C count on."""
    axes = axis_positions(flank, theta, pivot_height, pivot)
    axes[:, 3] -= index_ratio * beta
    return np.column_stack([axes, beta + spindle_phase(flank, theta)])


def within_travel(
    axes: np.ndarray, theta: np.ndarray, machine: MillingMachine, what: str, now: np.ndarray | None = None
) -> np.ndarray:
    """The positions (n,5) or (n,6), a counting A or C by whole turns within its travel, nearest to where it stands.

    ``now`` are the positions (5,) or (6,) before; zero where they are not known. Raises InputError naming ``what``, the
    cradle angle, axis, value and limit of the first position out of travel.
    """
    limits = machine.limits(axes.shape[1])
    low, high = limits.travel.T
    for turning in (3, 5):
        if axes.shape[1] > turning and math.isfinite(low[turning]):
            stands = 0.0 if now is None else float(now[turning])
            axes = (
                axes
                + whole_turns(axes[:, turning], low[turning], high[turning], stands) * np.eye(axes.shape[1])[turning]
            )
    outside = np.argwhere((axes < low) | (axes > high))
    if outside.size:
        point, axis = outside[0]
        scale, unit = limits.scale[axis], limits.units[axis]
        raise InputError(
            f"{what}: axis {limits.names[axis]} = {axes[point, axis] * scale:.5f} {unit} at cradle angle "
            f"{math.degrees(theta[point]):.3f} deg: {machine.name} travels {low[axis] * scale:g} to "
            f"{high[axis] * scale:g} {unit}"
        )
    return axes


def whole_turns(positions: np.ndarray, low: float, high: float, now: float) -> float:
    """The whole turns [rad] that take a counting axis through ``positions`` (n,) [rad] within its travel.

    Of those that do, it is the one that starts nearest to ``now``; where none does, the one that begins in the travel.
    """
    turn = 2 * math.pi
    least = math.ceil((low - positions.min()) / turn - 1e-12)
    most = max(math.floor((high - positions.max()) / turn + 1e-12), least)
    return turn * min(max(round((now - positions[0]) / turn), least), most)
