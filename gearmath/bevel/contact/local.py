"""What is at one contact: curvature of both flanks, ellipse, direction of the path, second derivative."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache

import casadi as ca
import numpy as np

from gearmath.bevel.contact.system import System, TouchPoint
from gearmath.engine.points import Points
from gearmath.kernels import kernel

#: Separation at the border of the contact ellipse: thickness of the marking compound [mm].
MARKING = 0.00635


@dataclass(frozen=True)
class LocalContact:
    """Quantities of chapter 26 at a contact within both flanks.

    ``second_derivative`` of φ_2 by φ_1 [rad/rad²], half axes (major, minor) [mm] of the ellipse, and directions on the
    gear, as angles from the root cone's generatrix towards the tip [rad]: of the path, and of the major axis.
    ``definite`` tells whether the flanks touch there without cutting into each other. ``axial`` (2,2) takes a vector of
    the tangent plane, in that basis, to cone distance and height on the gear.
    """

    second_derivative: float
    semi_axes: tuple[float, float]
    path_angle: float
    major_angle: float
    definite: bool
    relative_curvature: np.ndarray
    path_speed: float
    axial: np.ndarray


@lru_cache(maxsize=16)
def roll(system: System) -> Points:
    """x, φ_1, assembly -> w, β_c, D, lever, sliding (chapter 26), in the basis of the gear's root cone.

    Last how cone distance and depth on the gear change along the basis (2,2).
    """
    x, rotation, assembly = ca.SX.sym("x", 7), ca.SX.sym("rotation"), ca.SX.sym("assembly", 4)
    curvatures = []
    point, normal, *_ = system.gear.function(x[3:6])
    basis = kernel("root_basis").function(point, normal, system.gear.blank.delta_f)
    tangents = [system.placed(1, point, basis[:, k], x[6], assembly)[1] for k in range(2)]
    T = ca.horzcat(*tangents)
    for side, surface in enumerate((system.pinion, system.gear)):
        w = ca.SX.sym("w", 3)
        point, normal, condition, _ = surface.function(w)
        point, normal = system.placed(side, point, normal, (rotation, x[6])[side], assembly)
        sign = -1 if side == 0 else 1  # one normal for both: out of the gear, into the pinion
        rates = [ca.jacobian(point, w), sign * ca.jacobian(normal, w), ca.jacobian(condition, w).T]
        at = ca.substitute([*rates, point, normal], [w], [x[3 * side : 3 * side + 3]])
        curvatures.append(kernel("flank_curvature").function(*at[:3], T))
        point, normal = at[3:]
    moved = ca.inv(ca.vertcat(T.T @ at[0], at[2].T))[:, :2]  # of the gear's parameters along the tangents
    own, *_ = system.gear.function(x[3:6])
    on_blank = ca.vertcat(*kernel("root_place").function(own, system.gear.pitch_angle))
    seen = ca.jacobian(on_blank, x[3:6]) @ moved
    place = (system.shaft_angle, system.offset, assembly)
    w, beta, sliding = kernel("roll_at_contact").function(point, normal, T, curvatures[1], *place)
    lever, _ = kernel("transmission").function(point, normal, *place)
    D = curvatures[0] - curvatures[1]
    found = ca.vertcat(D[0, 0], (D[0, 1] + D[1, 0]) / 2, D[1, 1])
    outputs = ca.cse([w, beta, found, lever, sliding, ca.densify(seen)])
    return Points(ca.Function("local", [x, rotation, assembly], [ca.densify(one) for one in outputs]), shared=(2,))


def local(system: System, touch: TouchPoint, assembly: np.ndarray, separation: float = MARKING) -> LocalContact:
    """Curvature and motion at a contact within both flanks, its ellipse at a ``separation`` [mm]."""
    return local_at(system, touch.x, touch.rotation, assembly, separation)


def local_at(
    system: System, x: np.ndarray, rotation: float, assembly: np.ndarray, separation: float = MARKING
) -> LocalContact:
    """The same of a contact ``x`` (7,) at a rotation of the pinion [rad]."""
    *found, seen = roll(system).at(x, rotation, assembly)
    w, beta, D, lever, sliding = (one.ravel() for one in found)
    velocity, second = kernel("contact_motion")(w, beta[0], D, lever[0])
    (axes,) = kernel("contact_ellipse")(D, separation)
    on_gear = velocity + sliding
    values, vectors = np.linalg.eigh(np.array([[D[0], D[1]], [D[1], D[2]]]))
    flat = vectors[:, 0]
    return LocalContact(
        float(second),
        (float(axes[0]), float(axes[1])),
        _line(on_gear),
        _line(flat),
        bool(values[0] > 0),
        D,
        float(np.linalg.norm(on_gear)),
        seen * [[1], [-1]],
    )


def _line(vector: np.ndarray) -> float:
    """Angle [rad] of a direction without sense: 0 to below π."""
    return math.atan2(vector[1], vector[0]) % math.pi
