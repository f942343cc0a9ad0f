"""From raw touches to measured points, and from touches on ring and sphere to the tip that made them."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache

import casadi as ca
import numpy as np

from gearmath.bevel.flank import blank_grid, solve_flank
from gearmath.bevel.kernels import kernel
from gearmath.errors import ComputationError, InputError
from gearmath.machine.calibrating import PAIRS
from gearmath.machine.mill import flank_header
from gearmath.machine.probing import probe_height
from gearmath.specs.bevel_set import FLANKS, Member
from gearmath.specs.calibration import Calibration, Ring, Sphere
from gearmath.specs.flank_csv import FlankFile, flank_file, join
from gearmath.specs.milling_machine import MillingMachine
from gearmath.specs.touch_csv import CalibrationTouches, Touches

#: A touch this far from its nominal place is of another point, set or set-up. [mm]
_SAME_POINT = 3.0
_STEPS, _CONVERGED = 20, 1e-12


@dataclass(frozen=True)
class Tip:
    """A calibrated tip: effective radius and offset (3,) [mm], and the largest residual of its touches [mm]."""

    radius: float
    offset: np.ndarray
    residual: float


def measured_member(
    touches: Touches, member: Member, name: str, machine: MillingMachine, calibration: Calibration
) -> FlankFile:
    """The corrected contact points (15.5) of the touches, with their deviations from the nominal flanks.

    Raises InputError for touches of another member, off the grid, or far from their nominal place.
    """
    if touches.member != name:
        raise InputError(f"the touches are of the {touches.member}, not of the {name}")
    grid = blank_grid(member)
    rows, columns = grid.shape
    for what, values, limit in (
        ("row", touches.row, rows), ("col", touches.col, columns), ("tooth", touches.tooth, member.teeth)
    ):  # fmt: skip
        if (values >= limit).any():
            raise InputError(
                f"{what} = {int(values.max())}: the {name} and its grid {rows}x{columns} end at {limit - 1}"
            )
    header = {**flank_header(member, name, grid), "tip_radius_mm": f"{calibration.tip_radius:g}"}
    (tip, _) = kernel("probe_tip")(
        touches.axes, probe_height(machine, calibration), calibration.tip_offset, machine.pivot
    )
    files = []
    for flank in (flank for flank in FLANKS if (touches.flank == flank).any()):
        nominal = solve_flank(member, name, flank, grid)
        for tooth in np.unique(touches.tooth[touches.flank == flank]):
            here = (touches.flank == flank) & (touches.tooth == tooth)
            row, col = touches.row[here], touches.col[here]
            place = row * columns + col
            turn = _about_axis(2 * math.pi * int(tooth) / member.teeth)
            point, normal = nominal.point[place] @ turn.T, nominal.normal[place] @ turn.T
            contact, deviation = kernel("touched_point")(tip[here], calibration.tip_radius, point, normal)
            _check_place(contact - point, flank, int(tooth), row, col)
            files.append(flank_file(header, name, flank, int(tooth), row, col, contact, normal, deviation))
    return join(files)


def _check_place(off: np.ndarray, flank: str, tooth: int, row: np.ndarray, col: np.ndarray) -> None:
    distance = np.linalg.norm(off, axis=1)
    if (distance > _SAME_POINT).any():
        k = int(np.argmax(distance))
        raise InputError(
            f"{flank} flank, tooth {tooth}, row {row[k]}, col {col[k]}: the touch lies {distance[k]:.3f} mm from its "
            f"nominal place, the limit is {_SAME_POINT} mm; is it of this set, machine and calibration?"
        )


def calibrate_on_ring(touches: CalibrationTouches, ring: Ring) -> Tip:
    """Radius and X, Y offsets of the tip out of the centred pairs of touches in a ring (15.6); Z is not found.

    Raises InputError where a touch of a pair is missing.
    """
    offset, radii = np.zeros(3), []
    for axis, pair in enumerate(PAIRS):
        places = []
        for target in pair:
            found = touches.axes[touches.target == target, axis]
            if not len(found):
                raise InputError(f"the touch {target!r} is missing: the ring needs {', '.join(sum(PAIRS, ()))}")
            places.append(found[-1])  # the last pair is the centred one
        (offset[axis],), (radius,) = kernel("ring_calibration")(
            np.array(places[:1]), np.array(places[1:]), ring.center[axis], ring.diameter
        )
        radii.append(float(radius))
    return Tip(float(np.mean(radii)), offset, float(np.ptp(radii)) / 2)


def calibrate_on_sphere(touches: CalibrationTouches, sphere: Sphere, start: Calibration) -> Tip:
    """Radius and offset of the tip that leave the touches on a sphere the least residual (15.7), by Gauss-Newton.

    Raises InputError for too few touches, ComputationError if no tip explains them.
    """
    triggers = touches.axes[touches.target == "sphere", :3]
    if len(triggers) < 5:
        raise InputError(f"{len(triggers)} touches on the sphere: at least 5 are needed")
    center, radius = np.array(sphere.center), sphere.diameter / 2
    tip = np.array([*start.offset, start.tip_radius])
    for _ in range(_STEPS):
        rest, slope = (np.array(out) for out in _sphere_rows(len(triggers))(triggers.T, tip, center, radius))
        change, *_ = np.linalg.lstsq(slope, -rest.ravel(), rcond=None)
        tip = tip + change
        if np.abs(change).max() < _CONVERGED:
            return Tip(float(tip[3]), tip[:3], float(np.abs(rest).max()))
    raise ComputationError(f"no tip explains the touches on the sphere: after {_STEPS} steps it still changes")


@cache
def _sphere_rows(n: int) -> ca.Function:
    """Residuals (n,) of the touches (3,n), and their derivatives by the tip (n,4): offset and radius."""
    triggers, tip = ca.SX.sym("triggers", 3, n), ca.SX.sym("tip", 4)
    center, radius = ca.SX.sym("center", 3), ca.SX.sym("radius")
    residual = kernel("sphere_residual").function
    rest = ca.vertcat(*(residual(triggers[:, k], tip[:3], tip[3], center, radius) for k in range(n)))
    return ca.Function("sphere_rows", [triggers, tip, center, radius], [rest, ca.jacobian(rest, tip)])


def _about_axis(angle: float) -> np.ndarray:
    c, s = math.cos(angle), math.sin(angle)
    return np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
