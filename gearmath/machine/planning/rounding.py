"""What the control does to the flanks beside the program: rounding to its increments, and the tolerance of G642."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache

import casadi as ca
import numpy as np

from derivations import Quantity, notation
from gearmath.bevel.flank import blank_grid
from gearmath.bevel.method import actual_cut
from gearmath.engine.kernel import Kernel
from gearmath.kernels import kernel
from gearmath.machine.planning.blocks import on_one_machine
from gearmath.machine.planning.lines import flank_row, joined
from gearmath.machine.planning.path import Cut, axis_positions
from gearmath.specs.bevel_set import Member
from gearmath.specs.milling_machine import MillingMachine

#: Points that are looked at on each flank.
_GRID = 7, 13
#: In face hobbing: how far the flanks are from A and B, and the blades from the cutter axis C, at most. [mm]
FROM_AXIS, FROM_CUTTER = 100.0, 250.0


@dataclass(frozen=True)
class ControlShare:
    """Most that a flank may deviate [mm] along its normal: by rounding to increments, and by the path mode."""

    rounding: float
    path_mode: float


@cache
def entry_by_axes() -> Kernel:
    """Kernel: how the distance of entry into the swept blade changes with each axis, at the contact."""
    gradient = Quantity("gradient", "derivative of the distance by the axis positions", "mixed", "t_a", shape=(5,))
    inputs = kernel("line_entry").inputs
    symbols = [ca.SX.sym(q.name, max(q.size, 1)) for q in inputs]
    distance = kernel("line_entry").function(*symbols)
    function = ca.Function(
        "entry_by_axes", symbols, [ca.jacobian(distance, symbols[0]).T], [q.name for q in inputs], ["gradient"]
    )
    return Kernel(
        function,
        "How the entry of a line into the swept blade moves with the axes.",
        inputs,
        (gradient,),
        f"derivative of line_entry (6.4) by {notation.axes.name}",
    )


def axis_effects(member: Member, cut: Cut, machine: MillingMachine) -> np.ndarray:
    """How far points of the flanks (n,) move along their normals with X Y Z A B (n,5), mm per mm and mm per rad."""
    member, grid = on_one_machine(member, cut), blank_grid(member, *_GRID, 0.0)
    lines = joined([flank_row(actual_cut(member, flank), grid) for flank in cut.flanks])
    axes = axis_positions(member.flank(cut.flanks[0]), lines.theta, machine.pivot_height, machine.pivot)
    (gradient,) = entry_by_axes()(axes, machine.pivot_height, *lines.on_blade, machine.pivot)
    return np.abs(gradient)


def control_share(member: Member, machine: MillingMachine) -> ControlShare:
    """The most that the flanks of a member may deviate by what the control does, each axis at its worst."""
    half, off = machine.control.half_increments, machine.control.path_tolerance
    if member.process == "face_hobbing":
        return ControlShare(math.sqrt(3) * half[0] + (2 * FROM_AXIS + FROM_CUTTER) * half[3], _hobbed_share(*off))
    effects = _effects(member, machine)
    return ControlShare(float((effects @ half).max()), _share(effects, *off))


def path_share(member: Member, machine: MillingMachine, linear: float, turning: float) -> float:
    """How far flanks may deviate [mm] where the control leaves the path by ``linear`` [mm] in X Y Z together, and by
    ``turning`` [rad] in each of A and B."""
    if member.process == "face_hobbing":
        return _hobbed_share(linear, turning)
    return _share(_effects(member, machine), linear, turning)


def _hobbed_share(linear: float, turning: float) -> float:
    return linear + (2 * FROM_AXIS + FROM_CUTTER) * turning


def _share(effects: np.ndarray, linear: float, turning: float) -> float:
    return float((np.linalg.norm(effects[:, :3], axis=1) * linear + effects[:, 3:].sum(axis=1) * turning).max())


def _effects(member: Member, machine: MillingMachine) -> np.ndarray:
    """:func:`axis_effects` on all flanks of a member (n, 5)."""
    return np.concatenate([axis_effects(member, cut, machine) for cut in Cut.of(member)])
