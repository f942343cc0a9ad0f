"""Polynomial blocks for the roll of face hobbing: A and C turn on through many turns within each of them.

Beside the turning, which is linear in the parameter of a block, all six axes are smooth functions of the cradle
rotation: a few blocks follow them. So the end of a block lies many turns of A and C away from its start. What a control
makes of that where the axis is a modulo one, no page of a manual at hand says; a counting axis has no other way there.
"""

from __future__ import annotations

from functools import cache

import casadi as ca
import numpy as np

from derivations import Quantity
from gearmath.bevel.method import motion_of
from gearmath.engine.kernel import Kernel
from gearmath.errors import InputError
from gearmath.kernels import kernel
from gearmath.machine.planning.curves import STEPS, hermite_powers, powers_of, steps_between, turning_seconds
from gearmath.machine.planning.hobbing import HobbingMotion, HobbingPass, off_the_roll
from gearmath.machine.planning.path import six_axes, spindle_phase
from gearmath.specs.bevel_set import Flank
from gearmath.specs.milling_machine import CUTTER_AXIS, MillingMachine

#: Where blocks are compared with the exact path.
_COMPARED = np.linspace(0.0, 1.0, 33)
#: What lies between may be more by this part.
_BETWEEN = 1.05
#: No roll has more blocks.
_MOST_BLOCKS = 200


def check_counting(name: str, machine: MillingMachine) -> None:
    """Raises InputError, naming the keys, where A or C is a modulo axis."""
    specs = [(axis, getattr(machine.axes, axis)) for axis in ("A", CUTTER_AXIS)]
    modulo = [axis for axis, spec in specs if spec is not None and spec.modulo]
    if modulo:
        turning, keys = " and ".join(modulo), " and ".join(f"axes.{axis}" for axis in modulo)
        raise InputError(
            f"{name}: blocks = poly: a block of face hobbing turns {turning} through many turns, and no manual at hand "
            f"says what a control makes of that on a modulo axis: write straight blocks, or where the control counts "
            f"{turning} on, say so in the file of {machine.name}: modulo = false and travel in {keys}; "
            "vertical_5axis_counting.toml is such a machine"
        )


@cache
def phase_by_roll() -> Kernel:
    """Kernel: derivatives of the phase of the cutter by the cradle rotation, moving settings included."""
    moved, phase = kernel("moved_settings"), kernel("cutter_phase")
    settings, motion, theta = (ca.SX.sym(q.name, *q.shape) for q in moved.inputs)
    slope = ca.jacobian(phase.function(moved.function(settings, motion, theta), theta), theta)
    function = ca.Function(
        "phase_by_roll",
        [settings, motion, theta],
        [slope, ca.jacobian(slope, theta)],
        [q.name for q in moved.inputs],
        ["phase_slope", "phase_bend"],
    )
    outputs = (
        Quantity("phase_slope", "derivative of the phase of the cutter", "1", r"\dot\psi"),
        Quantity("phase_bend", "its second derivative", "1/rad", r"\ddot\psi"),
    )
    what = "How the phase of the cutter moves with the cradle."
    return Kernel(function, what, moved.inputs, outputs, "derivatives of cutter_phase (5.8) with moved_settings (10.1)")


def hobbed_powers(
    spec: Flank, nodes: np.ndarray, beta: np.ndarray, index_ratio: float, pose: tuple[float, np.ndarray], degree: int
) -> np.ndarray:
    """Coefficients (n-1, degree + 1, 6) of the blocks between cradle rotations and angles of the cutter (n,) [rad]."""
    phase = spindle_phase(spec, steps_between(nodes))[::STEPS, None]
    slopes, bends = (each[:, None] for each in phase_by_roll()(spec.vector, motion_of(spec), nodes))
    turned = hermite_powers(phase, slopes, bends, np.diff(nodes), degree)
    powers = np.concatenate([powers_of(spec, nodes, *pose, degree), turned], axis=2)
    for axis, share in ((3, -index_ratio), (5, 1.0)):
        powers[:, 0, axis] += share * beta[:-1]
        powers[:, 1, axis] += share * np.diff(beta)
    return powers


def curved_hobbing(spec: Flank, motion: HobbingMotion, machine: MillingMachine, degree: int) -> HobbingPass:
    """The cut by one straight block down and the fewest polynomial blocks of one length through the roll."""
    pose, drive, roll = (machine.pivot_height, machine.pivot), motion.drive, motion.end - motion.start
    count = _fewest(spec, motion, pose, degree)
    shares = np.linspace(0.0, 1.0, count + 1)
    turned = motion.down + motion.turns * shares
    nodes, beta = motion.start + roll * shares, drive.beta(turned)
    powers = hobbed_powers(spec, nodes, beta, drive.index_ratio, pose, degree)
    down = np.zeros_like(powers[:1])
    down[0, 0] = powers[0, 0] + np.array([0, 0, motion.lift, drive.index_ratio * beta[0], 0, -beta[0]])
    down[0, 1] = powers[0, 0] - down[0, 0]
    every = np.concatenate([down, powers])
    seconds = np.diff(np.append(0.0, turned)) * motion.per_turn
    # one pace for all of them, so that cutter and work turn evenly
    seconds *= max(1.0, float((turning_seconds(every, machine) / seconds).max()))
    axes = np.vstack([every[:, 0], powers[-1:].sum(axis=1)])
    return HobbingPass(axes, np.append(motion.start, nodes), seconds, every[:, 2:].transpose(0, 2, 1))


def _fewest(spec: Flank, motion: HobbingMotion, pose: tuple[float, np.ndarray], degree: int) -> int:
    """The number of blocks that keep to the exact path; the turning is in both, and left out of both."""
    for count in range(1, _MOST_BLOCKS):
        nodes = np.linspace(motion.start, motion.end, count + 1)
        powers = hobbed_powers(spec, nodes, np.zeros(count + 1), 0.0, pose, degree)
        along = _COMPARED[:, None] ** np.arange(degree + 1) @ powers
        theta = nodes[:-1, None] + _COMPARED * np.diff(nodes)[:, None]
        exact = six_axes(spec, theta.ravel(), np.zeros(theta.size), 0.0, *pose)
        if off_the_roll(spec, along.reshape(-1, 6) - exact) * _BETWEEN <= motion.chord:
            return count
    raise InputError(f"no roll of {_MOST_BLOCKS} polynomial blocks keeps within {motion.chord * 1e3:g} um")
