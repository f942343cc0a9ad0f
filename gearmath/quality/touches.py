"""From raw touches to measured points, and from touches on ring and sphere to the tip that made them."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache

import casadi as ca
import numpy as np

from gearmath.bevel.flank import Grid, blank_grid, solve_flank
from gearmath.bevel.kernels import kernel
from gearmath.errors import ComputationError, InputError
from gearmath.machine.calibrating import PAIRS
from gearmath.machine.mill import flank_header
from gearmath.machine.probing import probe_height
from gearmath.specs.bevel_set import FLANKS, Member
from gearmath.specs.calibration import Calibration, Ring, Sphere
from gearmath.specs.flank_csv import FlankFile
from gearmath.specs.milling_machine import MillingMachine
from gearmath.specs.touch_csv import CalibrationTouches, Touches

#: A touch this far from its nominal place is of another point, set or set-up. [mm]
_SAME_POINT = 3.0
#: Touches of one point this far from their mean are not all of the flank. [mm]
_SAME_TOUCH = 0.02
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

    Points come in the order in which they were touched; tooth z is tooth 0 again. The touches of one point are
    averaged, and ``uncertainty`` is that of the average, from the scatter of all points; one touch tells none.
    Raises InputError for touches of another member, off the grid, far from their nominal place or from each other.
    """
    if touches.member != name:
        raise InputError(f"the touches are of the {touches.member}, not of the {name}")
    grid = blank_grid(member)
    rows, columns = grid.shape
    for what, values, last in (
        ("row", touches.row, rows - 1), ("col", touches.col, columns - 1), ("tooth", touches.tooth, member.teeth)
    ):  # fmt: skip
        if (values > last).any():
            raise InputError(f"{what} = {int(values.max())}: the {name} and its grid {rows}x{columns} end at {last}")
    tip, _ = kernel("probe_tip")(
        touches.axes, probe_height(machine, calibration), calibration.tip_offset, machine.pivot
    )
    point, normal = _nominal(touches, member, name, grid)
    contact, deviation = kernel("touched_point")(tip, calibration.tip_radius, point, normal)
    _check_place(contact - point, touches)
    header = {**flank_header(member, name, grid), "tip_radius_mm": f"{calibration.tip_radius:g}"}
    return _averaged(header, touches, contact, normal, deviation)


def _nominal(touches: Touches, member: Member, name: str, grid: Grid) -> tuple[np.ndarray, np.ndarray]:
    """Points and normals (n,3) that the touches were meant for."""
    point, normal = np.empty((2, len(touches), 3))
    turn = 2 * math.pi * touches.tooth / member.teeth
    c, s, o = np.cos(turn), np.sin(turn), np.zeros(len(touches))
    about_axis = np.array([[c, -s, o], [s, c, o], [o, o, o + 1]])
    place = touches.row * grid.shape[1] + touches.col
    for flank in (flank for flank in FLANKS if (touches.flank == flank).any()):
        here = touches.flank == flank
        nominal = solve_flank(member, name, flank, grid)
        point[here], normal[here] = nominal.point[place[here]], nominal.normal[place[here]]
    return np.einsum("ijn,nj->ni", about_axis, point), np.einsum("ijn,nj->ni", about_axis, normal)


def _averaged(
    header: dict[str, str], touches: Touches, contact: np.ndarray, normal: np.ndarray, deviation: np.ndarray
) -> FlankFile:
    """One row a point: means of its touches, and the uncertainty of the mean from the scatter of all points."""
    places = np.stack([touches.flank == FLANKS[0], touches.tooth, touches.row, touches.col])
    first = np.flatnonzero(np.append(True, (np.diff(places.astype(int), axis=1) != 0).any(axis=0)))
    count = np.diff(np.append(first, len(touches)))
    point_of = np.repeat(np.arange(len(first)), count)
    mean = np.add.reduceat(deviation, first) / count
    off = deviation - mean[point_of]
    _check_scatter(off, touches)
    more = len(touches) - len(first)
    sigma = math.sqrt(float(off @ off) / more) if more else math.nan
    return FlankFile(
        header, touches.member, touches.flank[first], touches.tooth[first], touches.row[first], touches.col[first],
        np.add.reduceat(contact, first) / count[:, None], normal[first], mean, sigma / np.sqrt(count),
    )  # fmt: skip


def _named(touches: Touches, k: int) -> str:
    return f"{touches.flank[k]} flank, tooth {touches.tooth[k]}, row {touches.row[k]}, col {touches.col[k]}"


def _check_scatter(off: np.ndarray, touches: Touches) -> None:
    wide = np.abs(off) > _SAME_TOUCH
    if wide.any():
        k = int(np.argmax(wide))
        raise InputError(
            f"{_named(touches, k)}: one of its touches lies {abs(off[k]) * 1000:.1f} um from their mean, the limit is "
            f"{_SAME_TOUCH * 1000:g} um; was there a chip on the flank, or did the probe miss it?"
        )


def _check_place(off: np.ndarray, touches: Touches) -> None:
    distance = np.linalg.norm(off, axis=1)
    far = distance > _SAME_POINT
    if far.any():
        k = int(np.argmax(far))
        raise InputError(
            f"{_named(touches, k)}: the touch lies {distance[k]:.3f} mm from its nominal place, the limit is "
            f"{_SAME_POINT} mm; is it of this set, machine and calibration?"
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
