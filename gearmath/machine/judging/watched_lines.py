"""Lines on the flanks where the blocks of a pass generate them, so close together that no block cuts unseen.

They lie along tip and foot of the flanks, along toe and heel and half way up, evenly, and some for every block of a
pass. Every line of contact crosses the outer curves at both of its ends, and a tool that is moved anywhere on it is
moved most at one of them, as a rigid body; where it is moved at one end and the block leaves most at the other, the sum
may be largest between them.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from gearmath.bevel.flank import blank_grid
from gearmath.bevel.method import motion_of
from gearmath.kernels import kernel
from gearmath.machine.milling.axis_errors import roll_position
from gearmath.machine.milling.mill import thickness
from gearmath.machine.milling.run import CuttingRun
from gearmath.machine.planning.blocks import on_one_machine
from gearmath.machine.planning.lines import flank_curve, foot_curves, joined
from gearmath.machine.planning.path import axis_positions, flank_points
from gearmath.specs.bevel_set import FLANKS, Member
from gearmath.specs.milling_machine import MillingMachine

#: Where along a block each curve has lines. A straight block leaves a parabola between its ends, and where one end is
#: wrong, a line besides: what lies between these places is at most 3 % more than at one of them. Where it leaves a
#: parabola at each of its ends, and a ridge between them, more lines stand on the highest of these ridges.
_STRAIGHT = (0.0, 0.3, 0.5, 0.7)
#: The same for a block of POLY, which leaves a smooth flank.
_CURVED = tuple(np.linspace(0.0, 1.0, 60, endpoint=False).tolist())
#: Where curves lie along the tooth, as parts of the working depth, and up the tooth, as parts of the face width.
_UP, _ACROSS = (0.5, 1.0), (0.0, 1.0)
#: The same for lines on ridges, of which a line of contact that ends at toe or heel crosses some besides.
_UP_RIDGES = (*np.linspace(0.125, 0.875, 7).tolist(), 1.0)


@dataclass(frozen=True)
class WatchedFlank:
    """Lines on one flank of space 0: points and outward normals (n,3), where they begin (n,) [mm], cradle rotation."""

    flank: str
    point: np.ndarray
    normal: np.ndarray
    start: np.ndarray
    theta: np.ndarray
    curves: tuple[int, ...]
    """Where the curves begin, along which the lines lie."""
    ends: np.ndarray
    """Cradle rotations of the ends of straight blocks."""


def watched_flanks(member: Member, runs: list[CuttingRun], machine: MillingMachine) -> list[WatchedFlank]:
    """Lines on all flanks that the tools of a program cut, where their blocks ask for them."""
    found = []
    for run in runs:
        rolls = _watched_rolls(member, run, machine) if member.generation == "generated" else np.zeros(0)
        for flank in run.cut.flanks:
            ends = np.zeros(0) if len(run.inner) and run.inner.any() else rolls[:: len(_STRAIGHT)]
            found.append(_watched(member, run, flank, rolls, ends))
    return found


def lines_on_ridges(member: Member, run: CuttingRun, flank: str, rolls: np.ndarray) -> WatchedFlank:
    """Lines where a flank is generated at cradle rotations ``rolls``, up the tooth wherever a ridge may be highest."""
    return _watched(member, run, flank, np.unique(rolls), np.zeros(0), _UP_RIDGES)


def _watched(
    member: Member,
    run: CuttingRun,
    flank: str,
    rolls: np.ndarray,
    ends: np.ndarray,
    heights: tuple[float, ...] = _UP,
) -> WatchedFlank:
    theta, point, normal, curves = _lines(member, run, flank, rolls, heights)
    (other,) = (each for each in FLANKS if each != flank)
    opposite = flank_points(member, other, blank_grid(member, 5, 9)).point
    return WatchedFlank(flank, point, normal, -0.5 * thickness(point, opposite, member.teeth), theta, curves, ends)


def _watched_rolls(member: Member, run: CuttingRun, machine: MillingMachine) -> np.ndarray:
    """Cradle rotations (n,) [rad] that the blocks of a pass are watched at: of the pass that has most of them."""
    number, begins = np.cumsum(~run.cutting), np.append(True, run.at_ends[:-1])
    lines = np.where(run.at_ends, len(_STRAIGHT), len(_CURVED)) * (run.cutting & begins)
    rows = np.flatnonzero((number == np.bincount(number, lines).argmax()) & run.at_ends)
    spec = member.flank(run.cut.flanks[0])
    ends, _ = roll_position()(spec.vector, run.axes[rows, 0], run.axes[rows, 1], machine.pivot, motion_of(spec))
    shares = [np.array(_STRAIGHT if step == 1 else _CURVED) for step in np.diff(rows)]
    blocks = zip(ends, np.diff(ends), shares, strict=False)
    return np.concatenate([*(start + share * roll for start, roll, share in blocks), ends[-1:]])


def _lines(
    member: Member, run: CuttingRun, flank: str, rolls: np.ndarray, heights: tuple[float, ...]
) -> tuple[np.ndarray, np.ndarray, np.ndarray, tuple[int, ...]]:
    if member.generation == "formate":
        points = flank_points(member, flank, blank_grid(member, 5, 17, 0.0))
        return points.contact[:, 2], points.point, points.normal, (0,)
    shared = on_one_machine(member, run.cut)
    curves = [flank_curve(shared, flank, rolls, up=up) for up in heights]
    curves += [flank_curve(shared, flank, rolls, across=across) for across in _ACROSS]
    curves += foot_curves(shared, flank, rolls)
    lines = joined(curves)
    begins = np.cumsum([0, *(len(curve.theta) for curve in curves[:-1])])
    return lines.theta, lines.point, lines.normal, tuple(begins.tolist())


def height_on_blade(lines: WatchedFlank, member: Member, runs: list[CuttingRun], machine: MillingMachine) -> np.ndarray:
    """How far (n,) [mm] along the cutter's axis lines lie from the end of the straight blade that generates them."""
    (run,) = (one for one in runs if lines.flank in one.cut.flanks)
    spec = member.flank(run.cut.flanks[0])
    axes = axis_positions(spec, lines.theta, machine.pivot_height, machine.pivot)
    center, axis = kernel("tool_pose")(axes, machine.pivot_height, machine.pivot)
    own = member.flank(lines.flank)
    edge = (own.blade_edge_radius or 0.0) * (1 - math.sin(own.alpha))
    return np.abs(((lines.point - center) * axis).sum(axis=1)) - edge
