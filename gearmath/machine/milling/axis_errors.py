"""A machine that does not stand where its axes say: setting errors and index errors acting on an executed path.

A setting error of the cradle machine is, on the vertical machine, an axis error that depends on the roll position:
the roll position is recovered from X and Y, and the axes are shifted by what the setting changes there.
"""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cache

import casadi as ca
import numpy as np

from derivations import Quantity, notation
from gearmath.bevel.turning import half_turn
from gearmath.engine.kernel import Kernel
from gearmath.errors import ComputationError
from gearmath.kernels import kernel
from gearmath.specs.milling_machine import AXES
from gearmath.specs.simulated_machine import Mounting, SimulatedMachine, WorkAxis

_GAUSS_NEWTON_STEPS = 40
#: X and Y of an executed position lie this close to the path of the nominal settings, corrections included. [mm]
_ON_PATH = 2.0
#: A periodic error is followed in this many straight parts of its period, to a hundredth of its amplitude.
_PARTS_OF_A_PERIOD = 24
#: Index errors of a work that turns without end are followed in this many parts of a pitch.
_PARTS_OF_A_PITCH = 4
_AT_REST = np.zeros(notation.motion.shape)
_ARCSEC = math.radians(1 / 3600)


@cache
def roll_position() -> Kernel:
    """Kernel: cradle rotation of the settings whose X, Y are nearest to a position, and the distance left there.

    The settings may move with the cradle; without ``motion`` they do not.
    """
    x, theta, X, Y = ca.SX.sym("settings", 12), ca.SX.sym("theta"), ca.SX.sym("X"), ca.SX.sym("Y")
    pivot, motion = ca.SX.sym("pivot_offset", 3), ca.SX.sym("motion", 10, 7)
    axes = kernel("axis_transform").function(kernel("moved_settings").function(x, motion, theta), theta, 0, pivot)
    off = axes[:2] - ca.vertcat(X, Y)
    J = ca.jacobian(off, theta)
    change = ca.dot(J, off) / ca.dot(J, J)
    limited = change / ca.fmax(1, ca.fabs(change) / 0.3)
    step = ca.Function("roll_step", [theta, x, X, Y, pivot, motion], [theta - limited])
    rest = ca.Function("roll_rest", [theta, x, X, Y, pivot, motion], [ca.norm_2(off)])
    quantities = (
        notation.settings,
        notation.X,
        notation.Y,
        notation.pivot_offset,
        replace(notation.motion, default=0.0),
    )
    arguments = [ca.MX.sym(q.name, *(q.shape or (1,))) for q in quantities]
    solution = ca.MX(0)
    for _ in range(_GAUSS_NEWTON_STEPS):
        solution = step(solution, *arguments)
    off_path = Quantity("off_path", "distance of the position from the path in X and Y", "mm", "d")
    function = ca.Function(
        "roll_position",
        arguments,
        [solution, rest(solution, *arguments)],
        [q.name for q in quantities],
        ["theta", "off_path"],
    )
    return Kernel(
        function,
        "Cradle rotation of an executed position, from its X and Y.",
        quantities,
        (notation.theta, off_path),
        "(5.1) inverted by Gauss-Newton",
    )


def with_setting_errors(
    axes: np.ndarray,
    settings: np.ndarray,
    errors: np.ndarray,
    pivot_offset: np.ndarray,
    motion: np.ndarray = _AT_REST,
) -> np.ndarray:
    """The axis positions (n,5) that settings off by ``errors`` (12,) make of executed positions (n,5), or (n,6) with C.

    ``motion`` (10,7) moves right and wrong settings alike. Raises ComputationError if a position does not belong to the
    settings at all.
    """
    if not errors.any():
        return axes
    theta = _theta(axes, settings, pivot_offset, motion)
    really, meant = (_positions(x, motion, theta, pivot_offset) for x in (settings + errors, settings))
    shift = really - meant
    shift[:, 3::2] = half_turn(shift[:, 3::2])
    return axes + shift[:, : axes.shape[1]]


def _theta(axes: np.ndarray, settings: np.ndarray, pivot_offset: np.ndarray, motion: np.ndarray) -> np.ndarray:
    """Cradle rotations (n,) of executed positions."""
    theta, off_path = roll_position()(settings, axes[:, 0], axes[:, 1], pivot_offset, motion)
    if not (off_path < _ON_PATH).all():
        k = int(np.argmax(~(off_path < _ON_PATH)))
        raise ComputationError(
            f"position X {axes[k, 0]:.4f} Y {axes[k, 1]:.4f} is {off_path[k]:.4f} mm off the path of the settings; "
            "was the program made from another set?"
        )
    return theta


def _positions(settings: np.ndarray, motion: np.ndarray, theta: np.ndarray, pivot_offset: np.ndarray) -> np.ndarray:
    """X Y Z A B and C at cutter angle zero (n,6), at cradle rotations (n,)."""
    (moved,) = kernel("moved_settings")(settings, motion, theta)
    (axes,) = kernel("axis_transform")(moved, theta, 0.0, pivot_offset)
    return np.column_stack([axes, *kernel("cutter_phase")(moved, theta)])


def index_errors(work_axis: WorkAxis, teeth: int, seed: int) -> np.ndarray:
    """Error (z,) [rad] of the work axis at every tooth space, seeded."""
    turn = 2 * math.pi * np.arange(teeth) / teeth
    harmonic = work_axis.first_harmonic_arcsec * np.sin(turn + work_axis.rad("first_harmonic_phase"))
    random = work_axis.random_arcsec * np.random.default_rng(seed).standard_normal(teeth)
    return (harmonic + random) * _ARCSEC


def with_running_index_errors(
    axes: np.ndarray, settings: np.ndarray, errors: np.ndarray, pivot_offset: np.ndarray, motion: np.ndarray
) -> np.ndarray:
    """Positions (n,6) of a work axis that turns on through its index errors (z,) while face hobbing.

    The error is that of a space where A, beyond the roll, stands at its pitch, and linear in between.
    """
    if not errors.any():
        return axes
    theta, teeth = _theta(axes, settings, pivot_offset, motion), len(errors)
    pitches = (axes[:, 3] - _positions(settings, motion, theta, pivot_offset)[:, 3]) * teeth / (2 * math.pi)
    wrong = axes.copy()
    wrong[:, 3] += np.interp(pitches % teeth, np.arange(teeth + 1), np.append(errors, errors[0]))
    return wrong


def pitch_divisions(axes: np.ndarray, errors: np.ndarray) -> np.ndarray:
    """Parts (n-1,) into which blocks between positions (n,5) must fall for index errors (z,) to be followed."""
    pitches = np.abs(np.diff(axes[:, 3])) * len(errors) / (2 * math.pi)
    return np.maximum(np.ceil(_PARTS_OF_A_PITCH * pitches * bool(errors.any())), 1).astype(int)


def with_axis_errors(axes: np.ndarray, errors: SimulatedMachine) -> np.ndarray:
    """Where axes (n,5) that are told to stand somewhere really stand: offsets, X out of square, A unevenly divided."""
    wrong = errors.axes
    real = axes + wrong.offsets
    real[:, 0] += wrong.squareness_x_z_um_per_m * 1e-6 * axes[:, 2]
    for harmonic in wrong.A_harmonics:
        amplitude = harmonic.amplitude_arcsec * _ARCSEC
        real[:, 3] += amplitude * np.sin(harmonic.order * axes[:, 3] + harmonic.rad("phase"))
    for screw in wrong.screws:
        axis = AXES.index(screw.axis)
        turn = 2 * math.pi * axes[:, axis] / screw.lead + screw.rad("phase")
        real[:, axis] += screw.amplitude_um / 1000 * np.sin(turn)
    return real


class AxisBacklash:
    """Axes A and B that lag behind: told to turn back, they stand until the play is taken up.

    They are within half of the play of where they are told to stand, and move no more than that asks for; at first
    they stand as if they had come forwards.
    """

    def __init__(self, errors: SimulatedMachine) -> None:
        self._half = errors.axes.backlash / 2
        self._real: np.ndarray | None = None

    def __call__(self, position: np.ndarray) -> np.ndarray:
        """By how much A and B (2,) [rad] are off once they have been told to go to a position X Y Z A B (5,)."""
        told = position[3:5]
        real = told - self._half if self._real is None else np.clip(self._real, told - self._half, told + self._half)
        self._real = real
        return real - told


def with_backlash(axes: np.ndarray, errors: SimulatedMachine) -> np.ndarray:
    """Where A and B really stand at the ends of blocks (n,5), one after the other."""
    if not errors.axes.backlash.any():
        return axes
    play, real = AxisBacklash(errors), axes.copy()
    for k, position in enumerate(axes):
        real[k, 3:5] += play(position)
    return real


def divisions(axes: np.ndarray, errors: SimulatedMachine) -> np.ndarray:
    """Parts (n-1,) into which blocks between positions (n,5) must fall for periodic axis errors to be followed."""
    wrong = errors.axes
    periods = np.zeros(len(axes) - 1)
    way = np.abs(np.diff(axes, axis=0))
    for harmonic in wrong.A_harmonics:
        periods = np.maximum(periods, harmonic.order * way[:, 3] / (2 * math.pi))
    if wrong.backlash.any():
        # where an axis turns back it stands within a block
        turns = np.sign(np.diff(axes[:, 3:], axis=0))
        periods = np.maximum(periods, (turns != np.vstack([np.zeros((1, 2)), turns[:-1]])).any(axis=1))
    for screw in wrong.screws:
        periods = np.maximum(periods, way[:, AXES.index(screw.axis)] / screw.lead)
    return np.maximum(np.ceil(_PARTS_OF_A_PERIOD * periods), 1).astype(int)


def mounted(point: np.ndarray, normal: np.ndarray, seat: Mounting) -> tuple[np.ndarray, ...]:
    """Points and normals (n,3) of the work, in the frame that turns with A: tilted about the apex, then moved."""
    where = (seat.eccentricity, seat.rad("eccentricity_direction"))
    return kernel("seated")(point, normal, *where, seat.rad("tilt"), seat.rad("tilt_direction"))
