"""Polynomial blocks for a pass: as few as the flank allows, and as fast as the axes can follow.

Each block has positions and slopes of the exact path at its ends, a quintic one bends too: derivatives by the cradle
angle of the composition of moved settings and axis transform, as CasADi makes them. What a block leaves on the flank is
judged as in :mod:`gearmath.machine.planning.blocks`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache

import casadi as ca
import numpy as np

from derivations import Quantity, notation
from gearmath.bevel.method import motion_of
from gearmath.engine.kernel import Kernel
from gearmath.errors import InputError
from gearmath.kernels import kernel
from gearmath.machine.planning.blocks import ExactPass, fewest_nodes, horner, on_one_machine
from gearmath.machine.planning.feeds import SHORTEST, check_feed
from gearmath.machine.planning.path import Cut, axis_positions, roll_range
from gearmath.specs.bevel_set import Flank, Member
from gearmath.specs.milling_machine import MillingMachine
from gearmath.specs.ratio import RADIAN

CUBIC, QUINTIC = 3, 5
#: Radius at which F counts A and B, so that a degree is a mm: FGREF of a new control. [mm]
FEED_RADIUS = RADIAN
_AXES = 5
#: No block rolls further. [rad]
_LONGEST = math.radians(40.0)
#: Positions between the ends of a block, so that A is counted on over less than half a turn.
STEPS = 8
#: Where a block is asked for speed, acceleration and jerk.
_SAMPLES = np.linspace(0.0, 1.0, 65)
#: What lies between may be more by this part.
_BETWEEN_SAMPLES = 1.002


def degree_for(machine: MillingMachine, axes: int = _AXES) -> int:
    """Of the blocks that the control takes for five or six axes.

    Raises InputError naming key, value and limit where it takes none.
    """
    values = machine.control.polynomial_values
    if values < CUBIC * axes:
        raise InputError(
            f"control.polynomial_values = {values} of {machine.name}: cubic blocks of {axes} axes have "
            f"{CUBIC * axes} values, write straight ones"
        )
    return QUINTIC if values >= QUINTIC * axes else CUBIC


@cache
def axes_by_roll() -> Kernel:
    """Kernel: first and second derivatives of the axis positions by the cradle rotation, moving settings included."""
    moved, transform = kernel("moved_settings"), kernel("axis_transform")
    settings, motion, theta = (ca.SX.sym(q.name, *q.shape) for q in moved.inputs)
    pivot = [ca.SX.sym(q.name, *q.shape) for q in transform.inputs[2:]]
    axes = transform.function(moved.function(settings, motion, theta), theta, *pivot)
    slopes = ca.jacobian(axes, theta)
    names = [q.name for q in (*moved.inputs, *transform.inputs[2:])]
    function = ca.Function(
        "axes_by_roll",
        [settings, motion, theta, *pivot],
        [slopes, ca.jacobian(slopes, theta)],
        names,
        ["axis_slopes", "axis_bends"],
    )
    bends = Quantity(
        "axis_bends", "second derivatives of the axis positions", "mixed", r"\ddot{\mathbf{a}}", shape=(5,)
    )
    return Kernel(
        function,
        "How the axes move with the cradle.",
        (*moved.inputs, *transform.inputs[2:]),
        (notation.axis_slopes, bends),
        "derivatives of axis_transform (5.1-5.3) with moved_settings (10.1)",
    )


@dataclass(frozen=True)
class CurvedPass(ExactPass):
    """The exact path of a pass, followed by cubic blocks."""

    def block(self, start: float, end: float) -> np.ndarray:
        """Coefficients (degree + 1, 5) of the powers of the fraction."""
        pose = (self.pivot_height, self.pivot_offset)
        (powers,) = powers_of(self.flank, np.array([start, end]), *pose, self.degree)
        return powers

    @property
    def degree(self) -> int:
        return CUBIC

    def along(self, block: np.ndarray, fractions: np.ndarray) -> np.ndarray:
        return fractions[:, None] ** np.arange(len(block)) @ block


@dataclass(frozen=True)
class QuinticPass(CurvedPass):
    """The same by quintic blocks."""

    @property
    def degree(self) -> int:
        return QUINTIC


def powers_of(flank: Flank, nodes: np.ndarray, pivot_height: float, pivot: np.ndarray, degree: int) -> np.ndarray:
    """Coefficients (n-1, degree + 1, 5) of the powers 0 .. of the fraction of each block between nodes (n,) [rad]."""
    axes = axis_positions(flank, steps_between(nodes), pivot_height, pivot)[::STEPS]
    slopes, bends = axes_by_roll()(flank.vector, motion_of(flank), nodes, pivot_height, pivot)
    return hermite_powers(axes, slopes, bends, np.diff(nodes), degree)


def steps_between(nodes: np.ndarray) -> np.ndarray:
    """Nodes (n,), and so many rotations between them that what turns is counted on from node to node."""
    between = nodes[:-1, None] + np.arange(STEPS) / STEPS * np.diff(nodes)[:, None]
    return np.append(between.ravel(), nodes[-1])


def hermite_powers(
    values: np.ndarray, slopes: np.ndarray, bends: np.ndarray, widths: np.ndarray, degree: int
) -> np.ndarray:
    """Coefficients (n-1, degree + 1, k) of the blocks of k axes from what they have at nodes (n,), ``widths`` apart."""
    width = widths[:, None]
    given = [values[:-1], values[1:], slopes[:-1] * width, slopes[1:] * width]
    if degree == QUINTIC:
        given += [bends[:-1] * width**2, bends[1:] * width**2]
    name = "quintic_block" if degree == QUINTIC else "cubic_block"
    (found,) = kernel(name)(*(each.ravel() for each in given), 1.0)
    higher = found.reshape(*values[1:].shape, degree - 1).transpose(0, 2, 1)
    first = values[1:] - values[:-1] - higher.sum(axis=1)
    return np.concatenate([values[:-1, None], first[:, None], higher], axis=1)


def curve_nodes(
    member: Member, cut: Cut, tolerance: float, machine: MillingMachine, rounding: float, degree: int
) -> np.ndarray:
    """Cradle rotations (n,) [rad] of the ends of the fewest polynomial blocks, as ``roll_nodes`` has straight ones."""
    member = on_one_machine(member, cut)
    kind = QuinticPass if degree == QUINTIC else CurvedPass
    exact = kind.of(member, cut, machine.pivot_height, machine.pivot)
    return fewest_nodes(exact, roll_range(member, cut), tolerance, rounding, _LONGEST)


#: What an axis without a limit of its jerk may do. [mm/s3, rad/s3]
NO_JERK_LIMIT = 1e9


@cache
def pace_in_block(degree: int) -> Kernel:
    """Kernel: the least time per mm of the path at one fraction of a block, and the mm per fraction there (28.4)."""
    kind = "quintic" if degree == QUINTIC else "cubic"
    powers, fraction, limits = _inputs_of_pace(degree, _AXES, 500.0)
    feed = Quantity("feed", "wanted speed past the tooth", "mm/s", "v_f", (2e-4, 2000.0))
    tooth, *pivot = kernel("seen_from_tool").inputs[1:]
    inputs = (*powers, fraction, tooth, *pivot, *limits, feed)
    symbols = [ca.SX.sym(q.name, max(q.size, 1)) for q in inputs]
    s, given = symbols[degree + 1], symbols[degree + 2 : degree + 5]
    axes = horner(symbols[: degree + 1], s)
    rate = kernel("path_rate").function(ca.jacobian(axes, s), FEED_RADIUS, FEED_RADIUS)
    paces = [ca.norm_2(ca.jacobian(kernel("seen_from_tool").function(axes, *given), s)) / rate / symbols[-1]]
    paces += _paces_of_axes(axes, s, rate, symbols[-4:-1])
    name, what = (
        f"pace_in_{kind}_block",
        f"How slow the axes, and the feed past the tooth, make the path of a {kind} block.",
    )
    source = "derivatives along the path (28.4) of a block, and of seen_from_tool (5.6)"
    return _kernel_of_pace(name, what, inputs, symbols, paces, rate, source)


@cache
def pace_in_turning_block(degree: int) -> Kernel:
    """Kernel: the same of six axes, where A and C turn on; the feed past the tooth is that of the turning.

    The ways of five axes and of C stand at right angles in the length of the path.
    """
    powers, fraction, limits = _inputs_of_pace(degree, _AXES + 1, 2e4)
    inputs = (*powers, fraction, *limits)
    symbols = [ca.SX.sym(q.name, max(q.size, 1)) for q in inputs]
    s = symbols[degree + 1]
    axes = horner(symbols[: degree + 1], s)
    slopes, length = ca.jacobian(axes, s), kernel("path_rate").function
    cutter = length(ca.vertcat(0, 0, 0, slopes[_AXES], 0), FEED_RADIUS, FEED_RADIUS)
    rate = ca.norm_2(ca.vertcat(length(slopes[:_AXES], FEED_RADIUS, FEED_RADIUS), cutter))
    paces = _paces_of_axes(axes, s, rate, symbols[-3:])
    name, what = f"pace_in_turning_block_of_degree_{degree}", "How slow six axes make the path of a block."
    return _kernel_of_pace(name, what, inputs, symbols, paces, rate, "derivatives along the path (28.4) of a block")


_PACE = Quantity("pace", "least time per mm of the path", "s/mm", r"1/\hat{v}")


def _kernel_of_pace(
    name: str,
    what: str,
    inputs: tuple[Quantity, ...],
    symbols: list[ca.SX],
    paces: list[ca.SX],
    rate: ca.SX,
    source: str,
) -> Kernel:
    """The kernel of the slowest of all ``paces``, and of the path per fraction."""
    outputs = (_PACE, notation.path_rate)
    values = ca.cse([ca.mmax(ca.vertcat(*paces)), rate])
    function = ca.Function(name, symbols, values, [q.name for q in inputs], [q.name for q in outputs])
    return Kernel(function, what, inputs, outputs, source)


def _inputs_of_pace(
    degree: int, axes: int, farthest: float
) -> tuple[tuple[Quantity, ...], Quantity, tuple[Quantity, ...]]:
    """Coefficients of a block, the fraction, and the limits of the axes."""
    powers = tuple(
        Quantity(
            f"axes_{power}",
            f"coefficients of power {power} of the fraction",
            "mixed",
            "a",
            (-farthest, farthest),
            shape=(axes,),
        )
        for power in range(degree + 1)
    )
    fraction = Quantity("fraction", "0 at the start of the block, 1 at its end", "1", "s", (0.0, 1.0))
    limits = tuple(
        Quantity(
            f"max_{what}",
            f"highest {what} of each axis, by mm or rad and s",
            "mixed",
            rf"\hat{{{letter}}}",
            (1e-3, most),
            shape=(axes,),
        )
        for what, letter, most in (("speed", "v", 1e4), ("acceleration", "a", 1e6), ("jerk", "j", NO_JERK_LIMIT))
    )
    return powers, fraction, limits


def _paces_of_axes(axes: ca.SX, s: ca.SX, rate: ca.SX, limits: list[ca.SX]) -> list[ca.SX]:
    """What speed, acceleration and jerk allow: n derivatives along the path hold at the power n of the speed."""
    paces, along = [], axes
    for power, limit in enumerate(limits, start=1):
        along = ca.jacobian(along, s) / rate
        paces.append((ca.mmax(ca.fabs(along) / limit)) ** (1.0 / power))
    return paces


def curve_seconds(powers: np.ndarray, machine: MillingMachine, feed_mm_min: float, tooth: np.ndarray) -> np.ndarray:
    """Duration (n,) [s] of blocks (n, degree + 1, 5): each at the constant speed of the path that everything allows.

    That is ``feed_mm_min`` past the ``tooth`` (3,), or less where an axis reaches its highest speed, acceleration or
    jerk. How fast the control gets up to it is its own affair. Raises InputError for a feed that is not positive.
    """
    check_feed(feed_mm_min)
    pose = (tooth, machine.pivot_height, machine.pivot)
    kind = pace_in_block(powers.shape[1] - 1)
    return _least_seconds(kind, powers, *pose, *_limits(machine, _AXES), feed_mm_min / 60.0)


def turning_seconds(powers: np.ndarray, machine: MillingMachine) -> np.ndarray:
    """The least duration (n,) [s] of blocks (n, degree + 1, 6) of six axes, each at a constant speed of the path."""
    return _least_seconds(pace_in_turning_block(powers.shape[1] - 1), powers, *_limits(machine, _AXES + 1))


def _limits(machine: MillingMachine, axes: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    limits = machine.limits(axes)
    return limits.max_speed, limits.max_acceleration, np.minimum(limits.max_jerk, NO_JERK_LIMIT)


def _least_seconds(pace_in: Kernel, powers: np.ndarray, *given: np.ndarray | float) -> np.ndarray:
    count, many = len(powers), len(_SAMPLES)
    coefficients = [np.repeat(powers[:, k], many, axis=0) for k in range(powers.shape[1])]
    pace, rate = pace_in(*coefficients, np.tile(_SAMPLES, count), *given)
    slowest = pace.reshape(count, many).max(axis=1) * _BETWEEN_SAMPLES
    length = np.trapezoid(rate.reshape(count, many), _SAMPLES, axis=1)
    return np.maximum(length * slowest, SHORTEST)
