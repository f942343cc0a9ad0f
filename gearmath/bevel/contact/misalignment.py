"""What displacements of the members do to the contact, and which bring it to a place: the V-H check."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache

import casadi as ca
import numpy as np

from gearmath.bevel.contact.local import local
from gearmath.bevel.contact.system import TOLERANCE, System, TouchPoint
from gearmath.bevel.turning import half_turn
from gearmath.engine.points import Points
from gearmath.kernels import kernel

_STEPS = 25
#: Largest change in one Newton step: of x as in the system, φ_1 [rad], V and H [mm].
_LIMITS = np.array([2.0, 0.1, 0.1, 2.0, 0.1, 0.1, 0.1, 0.1, 0.5, 0.5])
#: The slope of the transmission counts with this length [mm].
_SLOPE_SCALE = 50.0


@dataclass(frozen=True)
class VH:
    """Offset V and withdrawal H of the pinion [mm] that bring the contact to a place, and the contact itself."""

    V: float
    H: float
    touch: TouchPoint


@lru_cache(maxsize=16)
def _wanted(system: System) -> Points:
    """y = (x, φ_1, V, H), J, ΔΣ, cone distance -> contact, place on the pitch cone and slope (10,), by y (10,10)."""
    y, J, shaft, distance = ca.SX.sym("y", 10), ca.SX.sym("J"), ca.SX.sym("shaft"), ca.SX.sym("distance")
    x, assembly = y[:7], ca.vertcat(y[8], y[9], J, shaft)
    every, _ = system.equations.function(x, y[7], assembly)
    own, normal, *_ = system.gear.function(x[3:6])
    along, depth = kernel("root_place").function(own, system.gear.pitch_angle)
    point, normal = system.placed(1, own, normal, x[6], assembly)
    _, slope = kernel("transmission").function(point, normal, system.shaft_angle, system.offset, assembly)
    wanted = ca.vertcat(every[:7], along - distance, depth, _SLOPE_SCALE * (slope + system.ratio))
    function = ca.Function("wanted", [y, J, shaft, distance], [wanted, ca.densify(ca.jacobian(wanted, y))])
    return Points(function)


def contact_at(system: System, distance: float, J: float = 0.0, shaft: float = 0.0) -> VH | None:
    """V and H for a contact of zero slope of the transmission error at a cone distance [mm] of the gear's pitch cone.

    None where no such contact is found, or where the flanks would cut into each other there.
    """
    starts = [surface.at(distance) for surface in (system.pinion, system.gear)]
    if not all(np.isfinite(start.contact).all() for start in starts):
        return None
    azimuths = [math.atan2(start.point[0, 1], start.point[0, 0]) for start in starts]
    turns = [
        half_turn(line - azimuth - phase)
        for line, azimuth, phase in zip((0.0, math.pi), azimuths, system.phase, strict=True)
    ]
    y = np.concatenate([starts[0].contact[0], starts[1].contact[0], [turns[1], turns[0], 0.0, 0.0]])
    function = _wanted(system)
    for _ in range(_STEPS):
        residual, by_y = function.at(y, J, shaft, distance)
        if not np.isfinite(by_y).all():
            return None
        if np.abs(residual).max() < 10 * TOLERANCE:
            break
        try:
            step = np.linalg.solve(by_y, -residual.ravel())
        except np.linalg.LinAlgError:
            return None
        y = y + step / max(1.0, float((np.abs(step) / _LIMITS).max()))
    else:
        return None
    assembly = np.array([y[8], y[9], J, shaft])
    touch = system.solve(y[:7], float(y[7]), (), assembly)
    if touch is None or not local(system, touch, assembly).definite:
        return None
    return VH(float(y[8]), float(y[9]), touch)


@lru_cache(maxsize=16)
def _displaced(system: System) -> Points:
    """x, φ_1, assembly -> the conditions of a contact within both flanks by x (7,7) and by the assembly (7,4)."""
    x, rotation, assembly = ca.SX.sym("x", 7), ca.SX.sym("rotation"), ca.SX.sym("assembly", 4)
    every, _ = system.equations.function(x, rotation, assembly)
    rates = [ca.densify(ca.jacobian(every[:7], by)) for by in (x, assembly)]
    return Points(ca.Function("displaced", [x, rotation, assembly], rates), shared=(2,))


def sensitivities(system: System, touch: TouchPoint, assembly: np.ndarray) -> np.ndarray:
    """How a contact within both flanks moves with V, H, J [mm] and ΔΣ [rad], at a rotation of the pinion (3,4).

    Rows: cone distance and height on the gear [mm], and φ_2 [rad].
    """
    by_x, by_assembly = _displaced(system).at(touch.x, touch.rotation, assembly)
    moved = np.linalg.solve(by_x, -by_assembly)
    return np.vstack([system.place_rates(touch.x) @ moved, moved[6:7]])
