"""From touches on ring and sphere to the tip that made them: least squares, with residuals and uncertainties."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache

import casadi as ca
import numpy as np

from derivations import Quantity
from gearmath.engine.kernel import Kernel
from gearmath.errors import ComputationError, InputError, counted
from gearmath.kernels import kernel
from gearmath.machine.bodies.probe_tip import lobing
from gearmath.shown import Shown, Shows
from gearmath.specs.calibration import Calibration, Face, Ring, Sphere
from gearmath.specs.touch_csv import RING, RING_FACE, SPHERE, CalibrationTouches

#: Touches of a sphere that a tip needs, and a tip with lobes.
_LEAST_ON_SPHERE, LEAST_FOR_LOBES = 5, 25
#: A touch that fits this badly is none of the artefact. [mm]
MISSED = 0.02
_STEPS, _CONVERGED = 20, 1e-12
#: Unknowns whose columns are this nearly dependent are not told apart.
_DEPENDENT = 1e-6

#: Residuals (n,) [mm] at values of the unknowns (p,), and their derivatives (n,p).
Rows = Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]]


@dataclass(frozen=True)
class Fit:
    """Values (p,) that leave the least squares of residuals (n,) [mm], of which n - p are to spare.

    ``covariance`` (p,p) is scaled by what the residuals say of the noise; NaN where none are to spare.
    """

    values: np.ndarray
    covariance: np.ndarray
    residuals: np.ndarray

    @property
    def spare(self) -> int:
        return len(self.residuals) - len(self.values)

    @property
    def noise(self) -> float:
        """Standard deviation of one touch that the residuals speak of [mm]."""
        return math.sqrt(float(self.residuals @ self.residuals) / self.spare) if self.spare else math.nan

    @property
    def uncertainty(self) -> np.ndarray:
        """Standard uncertainties (p,) of the values."""
        return np.sqrt(np.diag(self.covariance))


@dataclass(frozen=True, repr=False)
class Tip(Shown):
    """A calibrated tip: effective radius and offset (3,) [mm], amplitude [mm] and azimuth [rad] of its lobes.

    ``fit`` has the values radius, offset and, where they were asked for, the two components of the lobes. A Z that no
    touch tells is that of before, its uncertainty NaN.
    """

    radius: float
    offset: np.ndarray
    lobes: tuple[float, float]
    radius_uncertainty: float
    offset_uncertainty: np.ndarray
    fit: Fit

    @property
    def amplitude_uncertainty(self) -> float:
        """Standard uncertainty of the amplitude of the lobes [mm]; NaN where they were not asked for."""
        if len(self.fit.values) < 6:
            return math.nan
        along = self.fit.values[4:] / self.lobes[0]
        return math.sqrt(float(along @ self.fit.covariance[4:, 4:] @ along))

    @property
    def residual(self) -> float:
        """The largest in size [mm]."""
        return float(np.abs(self.fit.residuals).max())

    def _shown(self) -> tuple[str, list[Shows]]:
        return "calibrated tip", [
            ("radius", self.radius, "mm"),
            ("u of the radius", 1000 * self.radius_uncertainty, "um"),
            ("largest residual", 1000 * self.residual, "um"),
            ("offset", self.offset.tolist(), "mm"),
            ("u of the offset", (1000 * self.offset_uncertainty).tolist(), "um"),
            ("lobes", 1000 * self.lobes[0], "um"),
        ]


def calibrate_on_sphere(touches: CalibrationTouches, sphere: Sphere, start: Calibration, lobes: bool = False) -> Tip:
    """Radius and offset of the tip that leave the touches on a sphere the least residual (23.2), with lobes if asked.

    Without, the lobes of ``start`` are kept. Raises InputError for too few touches, touches that do not tell the tip,
    or one that fits no tip; ComputationError if none explains them.
    """
    triggers = touches.axes[touches.target == SPHERE, :3]
    least = LEAST_FOR_LOBES if lobes else _LEAST_ON_SPHERE
    if len(triggers) < least:
        what = "a tip with lobes" if lobes else "a tip"
        raise InputError(f"{counted(len(triggers), 'touch')} on the sphere: at least {least} are needed for {what}")
    known = lobing(start)

    def rows(v: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        given = (triggers, v[1:4], v[0], np.array(sphere.center), sphere.diameter / 2, v[4:] if lobes else known)
        rest, gradient = _rows("sphere_residual")(*given)
        return rest, gradient[:, : len(v)]

    first = [start.tip_radius, *start.offset, *(known if lobes else ())]
    names = [f"touch {k} on the sphere" for k in range(1, len(triggers) + 1)]
    found = least_squares(rows, np.array(first), names, "the tip")
    return _tip(found, tuple(found.values[4:]) if lobes else tuple(known))


def calibrate_on_ring(touches: CalibrationTouches, ring: Ring, start: Calibration) -> Tip:
    """Radius and X, Y offsets of the tip out of all touches in a ring (23.5), Z out of those on its face (23.6).

    The lobes of ``start`` are kept. Raises InputError where a touch is missing or fits no tip; ComputationError if no
    tip explains them.
    """
    for target in RING:
        if not (touches.target == target).any():
            raise InputError(f"the touch {target!r} is missing: the ring needs {', '.join(RING)}")
    inside = np.isin(touches.target, RING)
    triggers, heights = touches.axes[inside, :3], touches.axes[touches.target == RING_FACE, 2]
    if len(heights) and ring.face is None:
        raise InputError("the face of the ring was touched, but the calibration file has no ring.face")
    known, axis, z = lobing(start), np.array(ring.center[:2]), start.offset[2]

    def rows(v: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        offset = np.append(v[1:3], v[3] if len(v) > 3 else z)
        rest, gradient = _rows("ring_residual")(triggers, offset, v[0], axis, ring.diameter, known)
        if ring.face is None or not len(heights):
            return rest, gradient[:, :3]
        above, slope = _on_face(heights, ring.face, v)
        return np.append(rest, above), np.vstack([gradient[:, :4], slope])

    first = np.array([start.tip_radius, *start.offset[: 3 if len(heights) else 2]])
    names = [f"touch '{target}'" for target in (*touches.target[inside], *[RING_FACE] * len(heights))]
    return _tip(least_squares(rows, first, names, "the tip"), tuple(known), z)


def _on_face(heights: np.ndarray, face: Face, v: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Residuals of the touches on the face, and their derivatives by radius and offset."""
    (offset,) = kernel("face_calibration")(heights, face.seat, face.height, v[0])
    return v[3] - offset, np.tile([-1.0, 0.0, 0.0, 1.0], (len(heights), 1))


def _tip(found: Fit, lobes: tuple[float, ...], z: float = math.nan) -> Tip:
    """The tip of a fit whose values are radius, offset and lobes; ``z`` where it has no third offset."""
    offset, unsure = np.array([0.0, 0.0, z]), np.full(3, np.nan)
    count = min(3, len(found.values) - 1)
    offset[:count], unsure[:count] = found.values[1 : 1 + count], found.uncertainty[1 : 1 + count]
    amplitude, azimuth = kernel("shape_of_lobes")(np.array(lobes))
    shape = (float(amplitude), float(azimuth))
    return Tip(float(found.values[0]), offset, shape, float(found.uncertainty[0]), unsure, found)


@cache
def _rows(name: str) -> Kernel:
    """Kernel: a residual of a touch, and its derivatives by radius, offset and lobes (6,)."""
    return with_gradient(kernel(name), ("tip_radius", "tip_offset", "lobing"))


def calibrate_tip(touches: CalibrationTouches, before: Calibration, lobing: bool = False, source: str = "") -> Tip:
    """The tip from its touches on the sphere or, where there are none, in the ring; ``source`` is the file of before.

    Raises InputError where neither was touched, or lobes are wanted of touches in the ring.
    """
    if before.sphere is not None and (touches.target == SPHERE).any():
        return calibrate_on_sphere(touches, before.sphere, before, lobing)
    if lobing:
        raise InputError("lobing needs touches on the sphere; there are none")
    if before.ring is not None:
        return calibrate_on_ring(touches, before.ring, before)
    raise InputError(f"{source} has neither the ring nor the sphere that was touched")


def with_gradient(of: Kernel, unknowns: tuple[str, ...]) -> Kernel:
    """Kernel: what a kernel with one output says, and its derivatives by some of its inputs, one after the other."""
    symbols = {quantity.name: ca.SX.sym(quantity.name, max(quantity.size, 1)) for quantity in of.inputs}
    rest = of.function(*symbols.values())
    gradient = ca.jacobian(rest, ca.vertcat(*(symbols[name] for name in unknowns))).T
    slope = Quantity(
        "gradient", f"derivatives by {', '.join(unknowns)}", "mixed", r"\mathbf{g}", shape=(gradient.numel(),)
    )
    function = ca.Function(
        f"{of.name}_rows", list(symbols.values()), [rest, gradient], list(symbols), [of.outputs[0].name, slope.name]
    )
    return Kernel(function, of.description, of.inputs, (*of.outputs, slope), f"{of.name} and its derivatives")


def least_squares(rows: Rows, start: np.ndarray, names: list[str], what: str) -> Fit:
    """Gauss-Newton from ``start``; ``names`` (n) are those of the touches, and ``what`` is wanted from them.

    Raises InputError where the touches do not tell the unknowns or one of them is :data:`MISSED` or more off, and
    ComputationError if it does not converge.
    """
    v = start
    for _ in range(_STEPS):
        rest, slope = rows(v)
        sizes = np.linalg.norm(slope, axis=0)
        if not (np.isfinite(slope).all() and (sizes > 0).all()):
            raise ComputationError(f"no value of {what} explains the touches: the fit has left all bounds")
        u, s, vt = np.linalg.svd(slope / sizes, full_matrices=False)
        if s[-1] < _DEPENDENT * s[0]:
            raise InputError(f"the touches lie so that they do not tell {what}")
        change = -(vt.T @ ((u.T @ rest) / s)) / sizes
        v = v + change
        if np.abs(change).max() < _CONVERGED:
            break
    else:
        raise ComputationError(f"no value of {what} explains the touches: after {_STEPS} steps it still changes")
    rest, slope = rows(v)
    k = int(np.argmax(np.abs(rest)))
    if abs(rest[k]) >= MISSED:
        raise InputError(
            f"{names[k]}: lies {abs(rest[k]) * 1000:.1f} um off what explains the touches best, the limit is "
            f"{MISSED * 1000:g} um; did the probe miss it, or is the artefact another one?"
        )
    spare = len(rest) - len(v)
    variance = float(rest @ rest) / spare if spare else math.nan
    return Fit(v, variance * np.linalg.inv(slope.T @ slope), rest)
