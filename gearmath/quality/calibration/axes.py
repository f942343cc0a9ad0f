"""From touches on a sphere that the work carries to where the rotary axes are: chapter 21, by least squares."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache

import numpy as np

from gearmath.engine.kernel import Kernel
from gearmath.errors import InputError, counted
from gearmath.kernels import kernel
from gearmath.machine.bodies.probe_tip import lobing, probe_height
from gearmath.quality.calibration.tip import Fit, least_squares, with_gradient
from gearmath.shown import Shown, Shows
from gearmath.specs.calibration import Calibration
from gearmath.specs.milling_machine import MillingMachine
from gearmath.specs.touch_csv import WORK_SPHERE, CalibrationTouches

#: The unknowns in the order of a fit's values; the last two are x and y of the sphere in the work.
_UNKNOWNS = 8
_LEAST_TOUCHES = 20


@dataclass(frozen=True, repr=False)
class AxisCalibration(Shown):
    """Where the rotary axes are, each with its standard uncertainty in ``fit.uncertainty`` [mm, rad].

    ``pivot_offset`` (3,) and ``gauge_line_height`` are those of the machine file. ``x_zero`` is where the axis B lies,
    counted from the zero of X; ``b_zero`` how far B stands beyond what the control reads; ``azimuth`` [rad] and
    ``radius`` the place of the sphere about the work axis at A = 0. ``fit`` has the values e (3), b_x, b_z, β, s_x,
    s_y of chapter 21.
    """

    pivot_offset: np.ndarray
    gauge_line_height: float
    x_zero: float
    b_zero: float
    azimuth: float
    radius: float
    fit: Fit

    @property
    def azimuth_uncertainty(self) -> float:
        """[rad]"""
        across = np.array([-math.sin(self.azimuth), math.cos(self.azimuth)]) / self.radius
        return float(math.sqrt(across @ self.fit.covariance[6:, 6:] @ across))

    def _shown(self) -> tuple[str, list[Shows]]:
        u = self.fit.uncertainty
        return "calibrated rotary axes", [
            ("pivot offset", self.pivot_offset.tolist(), "mm"),
            ("B at X", self.x_zero, "mm"),
            ("B stands beyond its reading by", math.degrees(self.b_zero), "degrees"),
            ("u of the pivot offset", (1000 * u[:3]).tolist(), "um"),
            ("gauge line height", self.gauge_line_height, "mm"),
        ]


def calibrate_axes(touches: CalibrationTouches, machine: MillingMachine, calibration: Calibration) -> AxisCalibration:
    """The axes that leave the touches on the sphere the least residual (21.2), its axial place taken as known.

    Raises InputError for too few touches, positions of A and B that do not tell the axes, or a touch that fits none;
    ComputationError if no axes explain them.
    """
    sphere = calibration.work_sphere
    if sphere is None:
        raise InputError("the calibration file has no work_sphere, which the touches are of")
    here = touches.target == WORK_SPHERE
    axes = touches.axes[here]
    if len(axes) < _LEAST_TOUCHES:
        raise InputError(f"{counted(len(axes), 'touch')} on the work_sphere: at least {_LEAST_TOUCHES} are needed")
    height, known = probe_height(machine, calibration), lobing(calibration)

    def rows(v: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        place = np.array([v[6], v[7], sphere.axial])
        rest, gradient = _rows()(
            axes[:, :3],
            axes[:, 3],
            axes[:, 4],
            height,
            calibration.tip_offset,
            calibration.tip_radius,
            sphere.diameter / 2,
            place,
            v[3:5],
            v[5],
            v[:3],
            known,
        )
        return rest, gradient[:, :_UNKNOWNS]

    start = np.array([*machine.pivot, 0.0, 0.0, 0.0, *sphere.place[:2]])
    names = [f"touch {k} on the work_sphere" for k in range(1, len(axes) + 1)]
    fit = least_squares(rows, start, names, "the places of A and B")
    v = fit.values
    return AxisCalibration(
        v[:3],
        machine.gauge_line_height + float(v[4]),
        float(v[3]),
        float(v[5]),
        math.atan2(v[7], v[6]),
        math.hypot(v[6], v[7]),
        fit,
    )


@cache
def _rows() -> Kernel:
    """Kernel: the residual of a touch, and its derivatives by e, b, β and the place of the sphere (9,)."""
    return with_gradient(kernel("carried_sphere"), ("pivot_offset", "axis_place", "swivel_zero", "sphere_w"))
