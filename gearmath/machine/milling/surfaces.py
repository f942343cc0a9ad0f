"""Gouges and uncut stock on all that bounds the tooth spaces of a member: flanks, fillets and roots of every space."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from gearmath.bevel.tooth import SHARP_EDGE, SpaceFlank, ToothSpace, tooth_space
from gearmath.bevel.turning import turned
from gearmath.machine.bodies.cutter import cutter_of
from gearmath.machine.control.executor import MachinePath
from gearmath.machine.milling.hobbed_root import root_of_tips
from gearmath.machine.milling.mill import expose, thickness
from gearmath.machine.milling.removal import removal
from gearmath.machine.milling.run import CuttingRun, runs_of
from gearmath.machine.planning.passes import tooth_angles
from gearmath.machine.planning.path import Cut, axis_positions, roll_range
from gearmath.specs.bevel_set import FLANKS, SETTINGS, Member
from gearmath.specs.milling_machine import MillingMachine
from gearmath.specs.simulated_machine import SimulatedMachine

#: Less than this on a surface, or more than this left on it, is a fault. [mm]
DEFAULT_TOLERANCE = 1e-3
DEFAULT_COLUMNS = 7
#: Points between the fillets, as parts of the way across.
_ROOT = (0.25, 0.5, 0.75)
#: A gouge of the root is followed this deep. [mm]
_ROOT_DEPTH = 1.0
#: Blocks in which the exact way of a tool is followed: a tenth of those of the finest program, at the very most.
_EXACT_BLOCKS = 1500
#: Height from which a Formate cutter comes down. [mm]
_PLUNGE = 20.0


@dataclass(frozen=True)
class Surface:
    """One nominal surface of space 0: points and outward normals (n,3), their rows and columns, where lines begin."""

    name: str
    point: np.ndarray
    normal: np.ndarray
    row: np.ndarray
    col: np.ndarray
    start: np.ndarray


@dataclass(frozen=True)
class SurfaceState:
    """One surface of one space as the program leaves it: extremes [mm], faults, and where and by which line.

    ``lowest`` and ``highest`` leave out what no pass comes near, which ``uncut`` counts with what stays above the
    tolerance, and ``unmet`` without that. ``line`` is the line of the program that cuts deepest, ``row`` and ``col``
    the point at which it does; ``highest_row`` and ``highest_col`` are the point at which most is left.
    """

    surface: str
    space: int
    points: int
    lowest: float
    highest: float
    gouged: int
    uncut: int
    unmet: int
    row: int
    col: int
    line: int
    highest_row: int
    highest_col: int


def nominal_surfaces(member: Member, space: ToothSpace) -> list[Surface]:
    """Flanks (rows tip to root), fillets and root of space 0, each with where lines through its points begin.

    The root is ruled between the fillets, in cylindrical coordinates; :func:`generated_root` moves it to where it is.
    """
    surfaces = []
    for flank, opposite in zip(FLANKS, reversed(FLANKS), strict=True):
        here, there = getattr(space, flank), getattr(space, opposite)
        edge = np.array([section == "edge" for section in here.section])
        behind = thickness(_flat(here.point), _flat(there.point), member.teeth).reshape(here.point.shape[:2])
        for name, rows in ((f"{flank} flank", np.flatnonzero(~edge)), (f"{flank} fillet", np.flatnonzero(edge))):
            row, col = (index.ravel() for index in np.meshgrid(rows, np.arange(here.point.shape[1]), indexing="ij"))
            surfaces.append(
                Surface(name, here.point[row, col], here.normal[row, col], row, col, -0.5 * behind[row, col])
            )
    return [*surfaces, _root(*space.ordered)]


def surface_states(
    path: MachinePath | None,
    member: Member,
    machine: MillingMachine,
    errors: SimulatedMachine | None = None,
    spaces: Sequence[int] | None = None,
    tolerance: float = DEFAULT_TOLERANCE,
    columns: int = DEFAULT_COLUMNS,
    runs: list[CuttingRun] | None = None,
    progress: Callable[[int], object] = lambda _: None,
    space: ToothSpace | None = None,
    flank_tolerance: float | None = None,
) -> list[SurfaceState]:
    """Every surface of ``spaces`` (all that the program cuts, by default), exposed to every pass of every tool.

    What is a fault on flanks is ``flank_tolerance`` [mm] where that is given, and else ``tolerance`` as elsewhere.
    ``runs`` replaces the tools of the program, whose ``path`` is then not needed; ``space`` the nominal space.
    ``progress`` is called with the number of surfaces done. Raises InputError if a tool is not of this member.
    """
    space = space or tooth_space(member, columns)
    *surfaces, root = nominal_surfaces(member, space)
    surfaces.append(generated_root(root, member, space))
    if runs is None:
        if path is None:
            raise ValueError("either path or runs must be given")
        runs = runs_of(path, member, machine, errors, space, SHARP_EDGE)
    if spaces is None:
        spaces = sorted({number for run in runs for number in run.spaces})
    lines = np.concatenate([run.line for run in runs])
    angles = tooth_angles(member.teeth, member.rad("index_correction"))  # where the member is meant to have its spaces
    states = []
    for number in spaces:
        angle = float(angles[number])
        for surface in surfaces:
            point, normal = turned(surface.point, angle), turned(surface.normal, angle)
            left = expose(runs, machine, errors, point, normal, surface.start)
            limit = flank_tolerance if flank_tolerance is not None and surface.name.endswith("flank") else tolerance
            states.append(_state(surface, number, left.distance, left.block, lines, limit))
            progress(1)
    return states


def generated_root(root: Surface, member: Member, space: ToothSpace) -> Surface:
    """A root moved along its normals to the envelope of all tips that generate it at the nominal settings.

    Points that no tool comes near stay; those at a step of it, in face hobbing where a tip ends, are left out.
    """
    if member.process == "face_hobbing":
        point, even = root_of_tips(_as_designed(member), root.point, root.normal)
        moved = (point, root.normal, root.row, root.col, root.start)
        return Surface(root.name, *(values[even] for values in moved))
    where = left_by_exact_motion(member, space, root)
    moved = root.point + np.where(np.isfinite(where), where, 0.0)[:, None] * root.normal
    return replace(root, point=moved)


def left_by_exact_motion(member: Member, space: ToothSpace, surface: Surface) -> np.ndarray:
    """What all tools of a member leave on a surface of space 0 (n,) [mm] at the nominal settings; NaN for all of it.

    The way of every tool is divided so finely that it counts as curved.
    """
    left = np.full(len(surface.point), np.nan)
    exact = _as_designed(member)
    for cut in Cut.of(exact):
        cutter = cutter_of(exact, cut.flanks, space, SHARP_EDGE)
        spec = exact.flank(cut.flanks[0])
        if exact.generation == "generated":
            axes = axis_positions(spec, np.linspace(*roll_range(exact, cut), _EXACT_BLOCKS + 1), 0.0)
        else:
            axes = axis_positions(spec, np.zeros(2), 0.0)
            axes[0, 2] += _PLUNGE
        lines, pose = (surface.point, surface.normal, surface.start), (0.0, np.zeros(3))
        found = removal(axes, np.arange(len(axes)) > 0, cutter, pose, *lines)
        left = np.fmin(left, found.distance)
    return left


def _as_designed(member: Member) -> Member:
    """The member with its nominal settings in the place of corrected ones."""
    flanks = {
        flank: spec.model_copy(update={"design": None} | {key: getattr(spec.nominal, key) for key in SETTINGS})
        for flank in FLANKS
        for spec in [member.flank(flank)]
    }
    return member.model_copy(update=flanks)


def _state(
    surface: Surface, space: int, distance: np.ndarray, block: np.ndarray, lines: np.ndarray, tolerance: float
) -> SurfaceState:
    met = ~np.isnan(distance)
    deepest = int(np.nanargmin(distance)) if met.any() else 0
    fullest = int(np.argmax(np.nan_to_num(distance, nan=np.inf)))
    return SurfaceState(
        surface=surface.name,
        space=space,
        points=len(distance),
        lowest=float(np.min(distance[met], initial=math.inf)),
        highest=float(np.max(distance[met], initial=-math.inf)),
        gouged=int((distance[met] < -tolerance).sum()),
        uncut=int((~met).sum() + (distance[met] > tolerance).sum()),
        unmet=int((~met).sum()),
        row=int(surface.row[deepest]),
        col=int(surface.col[deepest]),
        line=int(lines[block[deepest]]) if block[deepest] >= 0 else 0,
        highest_row=int(surface.row[fullest]),
        highest_col=int(surface.col[fullest]),
    )


def _root(low: SpaceFlank, high: SpaceFlank) -> Surface:
    first, last = low.point[-1], high.point[-1]
    a, b = (np.stack([np.arctan2(p[:, 1], p[:, 0]), np.hypot(p[:, 0], p[:, 1]), p[:, 2]]) for p in (first, last))
    turn = (b[0] - a[0] + math.pi) % (2 * math.pi) - math.pi
    points, normals = [], []
    for fraction in _ROOT:
        angle, radius, z = a + fraction * np.stack([turn, b[1] - a[1], b[2] - a[2]])
        points.append(np.stack([radius * np.cos(angle), radius * np.sin(angle), z], axis=1))
        normal = (1 - fraction) * low.normal[-1] + fraction * high.normal[-1]
        normals.append(normal / np.linalg.norm(normal, axis=1, keepdims=True))
    row, col = (index.ravel() for index in np.indices((len(_ROOT), len(first))))
    return Surface("root", np.concatenate(points), np.concatenate(normals), row, col, np.full(len(row), -_ROOT_DEPTH))


def _flat(points: np.ndarray) -> np.ndarray:
    return points.reshape(-1, 3)
