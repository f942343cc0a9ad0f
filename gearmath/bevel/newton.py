"""What the root finders share: one damped Newton step, the tolerance, and the points that come out."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca
import numpy as np

from derivations import Quantity, notation

#: Largest residual of a converged point. [mm]
TOLERANCE = 1e-9

residual_size = Quantity("residual_size", "size of the residual of place and meshing after the last step", "mm", "r")
contact_guess = Quantity(
    "contact_guess",
    "start values of u, beta, theta",
    "mixed",
    "(u, \\beta, \\theta)_0",
    shape=(3,),
    components=notation.contact.components,
)


@dataclass(frozen=True)
class FlankPoints:
    """n points of one flank in the work frame: parameters (n,3), points (n,3) [mm], outward unit normals (n,3)."""

    contact: np.ndarray
    point: np.ndarray
    normal: np.ndarray


def newton_step(residual: ca.SX, unknowns: ca.SX, limits: tuple[float, ...]) -> ca.SX:
    """The unknowns (3,) after one Newton step, shortened where a component would change by more than its limit.

    The 3×3 system is solved by cross products of the rows of the Jacobian, which needs no pivoting code in C.
    """
    J = ca.jacobian(residual, unknowns)
    rows = [J[k, :].T for k in range(3)]
    minors = [ca.cross(rows[1], rows[2]), ca.cross(rows[2], rows[0]), ca.cross(rows[0], rows[1])]
    step = sum(residual[k] * minors[k] for k in range(3)) / ca.dot(rows[0], minors[0])
    excess: ca.SX = ca.SX(1)
    for k, limit in enumerate(limits):
        excess = ca.fmax(excess, ca.fabs(step[k]) / limit)
    return unknowns - step / excess
