"""What a machine and its control cannot do, refused pass by pass before a line is written."""

from __future__ import annotations

import math
import re

import numpy as np

from gearmath.errors import InputError
from gearmath.machine.planning.feeds import accelerations
from gearmath.machine.planning.passes import Pass
from gearmath.specs.milling_machine import AXES, CUTTER_AXIS, MillingMachine

#: Shortest and longest block; beyond them F has more digits than a control keeps.
_BLOCK_SECONDS = (1e-4, 1e5)
_MAX_TURN_DEG = 180.0 - 2e-6
_TOOL_NAME = re.compile(r"[A-Za-z0-9_]{1,31}")
#: Speeds may pass their limit by this much of it: the rounding of block times that were made to reach the limit.
_SLACK = 1e-6


def check_pass(name: str, one: Pass, machine: MillingMachine, retract: float) -> None:
    """Raises InputError naming program, pass, tooth, axis, value and limit."""
    _check_shape(name, one, machine)
    _check_travel(name, one, machine, retract)
    _check_speed(name, one, machine)


def check_spindle_speed(name: str, machine: MillingMachine, rpm: float) -> None:
    """Raises InputError naming program, value and limit of the spindle speed."""
    low, high = machine.spindle_speed_rpm
    if not low <= rpm <= high:
        raise InputError(f"{name}: spindle speed = {rpm} rpm: {machine.name} has {low:g} to {high:g} rpm")


def check_process(name: str, machine: MillingMachine, rpm: float, clearance: float, plunge: float) -> None:
    """Raises InputError naming program, value and limit of spindle speed, clearance and plunge feed."""
    check_spindle_speed(name, machine, rpm)
    if not (math.isfinite(clearance) and clearance > 0):
        raise InputError(f"{name}: clearance = {clearance} mm: must be greater than 0")
    fastest = machine.axes.Z.max_speed_per_min
    # three decimals are written, and F0.000 is no feed
    if not 0.001 <= plunge <= fastest:
        raise InputError(f"{name}: plunge feed = {plunge} mm/min: must be 0.001 to {fastest:g} mm/min, the speed of Z")


def _where(name: str, one: Pass) -> str:
    return f"{name}, pass {one.label!r}, tooth {one.tooth}"


def _check_shape(name: str, one: Pass, machine: MillingMachine) -> None:
    where, n = _where(name, one), len(one.axes)
    if not _TOOL_NAME.fullmatch(one.tool):
        raise InputError(f"{where}: tool = {one.tool!r}: must be 1 to 31 letters, digits and _")
    if one.axes.ndim != 2 or one.axes.shape[1] not in (5, 6) or n < 2 or one.seconds.shape != (n - 1,):
        shapes = f"positions {one.axes.shape} and times {one.seconds.shape}"
        raise InputError(f"{where}: has {shapes}, needed are (n, 5) or (n, 6) and (n-1,) with n at least 2")
    columns = one.axes.shape[1]
    if one.bends is not None and (one.bends.shape[:2] != (n - 1, columns) or one.bends.shape[2] not in (2, 4)):
        needed = f"(n-1, {columns}, 2) or (n-1, {columns}, 4)"
        raise InputError(f"{where}: has coefficients {one.bends.shape}, needed are {needed}")
    if one.bends is not None and one.values_of_a_block > machine.control.polynomial_values:
        raise InputError(
            f"{where}: its blocks have {one.values_of_a_block} end points and coefficients: {machine.name} "
            f"takes control.polynomial_values = {machine.control.polynomial_values}"
        )
    if one.axes.shape[1] == 6 and machine.axes.C is None:
        raise InputError(f"{where}: axis C: {machine.name} has none, [axes.C] is missing in its file")
    if not np.isfinite(one.axes).all():
        point, axis = np.argwhere(~np.isfinite(one.axes))[0]
        named = (AXES + CUTTER_AXIS)[axis]
        raise InputError(f"{where}: axis {named} = {one.axes[point, axis]} at point {point}: must be finite")
    shortest, longest = _BLOCK_SECONDS
    bad = ~((one.seconds >= shortest) & (one.seconds <= longest))
    if bad.any():
        block = int(bad.argmax())
        raise InputError(
            f"{where}: time = {one.seconds[block]} s of block {block}: must be {shortest} to {longest:g} s"
        )
    if not 0.0 <= one.dwell <= longest:
        raise InputError(f"{where}: dwell = {one.dwell} s: must be 0 to {longest:g} s")


def _check_travel(name: str, one: Pass, machine: MillingMachine, retract: float) -> None:
    raised = one.axes[:1].copy()
    raised[0, 2] = retract
    points = np.vstack([one.axes, raised])
    limits = machine.limits(points.shape[1])
    low, high = limits.travel.T
    outside = np.argwhere((points < low) | (points > high))
    if outside.size:
        point, axis = outside[0]
        scale, unit = limits.scale[axis], limits.units[axis]
        where = "above the first point" if point == len(one.axes) else f"at point {point}"
        raise InputError(
            f"{_where(name, one)}: axis {limits.names[axis]} = {points[point, axis] * scale:.5f} {unit} {where}: "
            f"{machine.name} travels {low[axis] * scale:g} to {high[axis] * scale:g} {unit}"
        )


def _check_speed(name: str, one: Pass, machine: MillingMachine) -> None:
    if one.bends is not None:
        return  # the times of polynomial blocks come from their derivatives, and the whole program is judged
    steps = np.diff(one.axes, axis=0)
    axes = machine.limits(steps.shape[1])
    for values, limits, per, what in (
        (np.abs(steps) / one.seconds[:, None], axes.max_speed, 60.0, "/min"),
        (np.abs(accelerations(steps, one.seconds)), axes.max_acceleration, 1.0, "/s2"),
    ):
        over = np.argwhere(values > limits * (1.0 + _SLACK))
        if over.size:
            block, axis = over[0]
            scale, unit = per * axes.scale[axis], axes.units[axis]
            raise InputError(
                f"{_where(name, one)}: axis {axes.names[axis]} = {values[block, axis] * scale:.1f} {unit}{what} in "
                f"block {min(block, len(steps) - 1)}: {machine.name} allows {limits[axis] * scale:g} {unit}{what}"
            )
    # DC goes the short way: from half a turn on, as printed, it would go the other one
    for axis, column in (("A", 3), (CUTTER_AXIS, 5)):
        spec = getattr(machine.axes, axis)
        turned = np.degrees(np.abs(steps[:, column : column + 1]).ravel())
        if spec is not None and spec.modulo and (turned > _MAX_TURN_DEG).any():
            block = int((turned > _MAX_TURN_DEG).argmax())
            raise InputError(
                f"{_where(name, one)}: axis {axis} turns {turned[block]:.6f} degrees in block {block}: must be less "
                "than 180"
            )
