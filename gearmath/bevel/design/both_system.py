"""The conditions on a cut of both flanks at once: what each flank is at its point of contact, and the root (27.6).

One machine cuts both flanks, so that the settings of a flank do not follow from that flank alone. The point of each is
cut at a cradle angle of its own, and the cutter's two blades are the only settings that belong to one flank.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cache

import casadi as ca
import numpy as np

from derivations import notation
from gearmath.bevel.design.local_settings import MOVING, ROOT
from gearmath.bevel.generation import Generation
from gearmath.bevel.root import FLAT_BLADE
from gearmath.engine.points import Points
from gearmath.kernels import kernel
from gearmath.specs.bevel_set import FLANKS, MACHINE_SETTINGS, SETTINGS

_OWN = ("u", "beta", "theta", "blade_point_radius", "blade_pressure_angle", *ROOT)
#: Settings of the machine and of their motion; of each flank contact, blade, and contact of its tip at the root.
NAMES = (*MACHINE_SETTINGS, *MOVING, *(f"{flank}.{name}" for flank in FLANKS for name in _OWN))
#: Sizes that count alike: mm, rad and coefficients.
_SIZES = {
    "cradle_angle": 0.05,
    "cutter_tilt": 0.03,
    "cutter_swivel": 0.1,
    "machine_root_angle": 0.02,
    "ratio_of_roll": 0.1,
    "work_rotation_offset": 0.1,
    "modified_roll_2": 0.05,
    "modified_roll_3": 0.2,
    "beta": 0.05,
    "theta": 0.05,
    "blade_pressure_angle": 0.03,
    **dict.fromkeys(ROOT, 0.05),
}
SIZES = np.array([_SIZES.get(name.rpartition(".")[2], 1.0) for name in NAMES])


@dataclass(frozen=True)
class FlankPoint:
    """What is wanted at the point of contact of one flank, in the frame of the pinion's work.

    Point (3,) [mm], outward normal (3,), basis (3,2), curvatures K_2 of the gear and ``curvature`` of the pinion (2,2)
    [1/mm]; of chapter 26 ``vector`` w (2,), ``acceleration`` and ``lever``; ``parabola`` φ_2'' [rad/rad²].
    """

    point: np.ndarray
    normal: np.ndarray
    basis: np.ndarray
    gear_curvature: np.ndarray
    curvature: np.ndarray
    vector: np.ndarray
    acceleration: float
    lever: float
    parabola: float


@dataclass(frozen=True)
class AtPoint:
    """What settings give at the point of a flank: how far off (6,) [mm, with f], φ_2'', K less the wanted (3,) [1/mm],
    and the derivatives (10,35) of all by ``NAMES``."""

    off: np.ndarray
    parabola: float
    curvature: np.ndarray
    rates: np.ndarray


def index(name: str, flank: str = "") -> int:
    """The place of a name in the vector (35,) of ``NAMES``."""
    return NAMES.index(f"{flank}.{name}" if flank else name)


def settings_index(flank: str) -> list[int]:
    """The places of the settings (12,) of a flank in the vector."""
    own = ("blade_point_radius", "blade_pressure_angle")
    return [index(name, flank if name in own else "") for name in SETTINGS]


def _of_flank(x: ca.SX, flank: str) -> tuple[ca.SX, ca.SX, ca.SX]:
    """Contact (3,), settings (12,) and motion (10,7) of a flank out of the vector."""
    settings = ca.vertcat(*(x[k] for k in settings_index(flank)))
    motion = ca.SX(*notation.motion.shape)
    for name, (setting, power) in MOVING.items():
        motion[SETTINGS.index(setting), power - 1] = x[index(name)]
    return ca.vertcat(*(x[index(name, flank)] for name in _OWN[:3])), settings, motion


@cache
def _at_point(flank: str) -> Points:
    """x, index ratio, blade offset, side, what is wanted -> values (10,) and their derivatives by x."""
    x, w = ca.SX.sym("x", len(NAMES)), ca.SX.sym("w", 3)
    cut = [ca.SX.sym(name) for name in ("index", "offset", "side")]
    P, T, K_2, K, vector = (
        ca.SX.sym(*one) for one in (("P", 3), ("T", 3, 2), ("K_2", 2, 2), ("K", 2, 2), ("vector", 2))
    )
    acceleration, lever = ca.SX.sym("acceleration"), ca.SX.sym("lever")
    contact, settings, motion = _of_flank(x, flank)
    point, normal, meshing = kernel("straight_generation").function(w[0], w[1], w[2], settings, motion, *cut)
    condition = meshing / settings[0]
    rates = ca.jacobian(point, w), -ca.jacobian(normal, w), ca.jacobian(condition, w).T
    found = kernel("flank_curvature").function(*rates, T)
    D = found - K_2
    relative = ca.vertcat(D[0, 0], (D[0, 1] + D[1, 0]) / 2, D[1, 1])
    _, second = kernel("contact_motion").function(vector, acceleration, relative, lever)
    off = found - K
    values = ca.vertcat(
        point - P,
        T.T @ normal,
        condition,
        second,
        ca.vertcat(off[0, 0], (off[0, 1] + off[1, 0]) / 2, off[1, 1]),
    )
    values = ca.substitute(values, w, contact)
    given = [x, *cut, P, T, K_2, K, vector, acceleration, lever]
    return Points(ca.Function("at_point", given, ca.cse([values, ca.densify(ca.jacobian(values, x))])))


@cache
def _at_root(flank: str) -> Points:
    """x, index ratio, blade offset, side, cone (3,) -> meshing and cone distance at two places, depths (6,), by x."""
    x, cone = ca.SX.sym("x", len(NAMES)), ca.SX.sym("cone", 3)
    cut = [ca.SX.sym(name) for name in ("index", "offset", "side")]
    _, settings, motion = _of_flank(x, flank)
    tip_plane, values, depths = ca.vertcat(settings[:-1], FLAT_BLADE), [], []
    for k in range(2):
        beta, theta = (x[index(name, flank)] for name in ROOT[2 * k : 2 * k + 2])
        root, _, meshing = kernel("straight_generation").function(0, beta, theta, tip_plane, motion, *cut)
        along, deep = kernel("root_place").function(root, cone[0])
        values += [meshing / settings[0], along - cone[1 + k]]
        depths.append(deep)
    off = ca.vertcat(*values, *depths)
    return Points(ca.Function("at_root", [x, *cut, cone], ca.cse([off, ca.densify(ca.jacobian(off, x))])))


def at_point(how: Generation, flank: str, x: np.ndarray, wanted: FlankPoint) -> AtPoint:
    """What the settings of the vector ``x`` (35,) are at the point of a flank."""
    values, rates = _at_point(flank).at(
        x,
        how.index_ratio,
        how.blade_offset_angle,
        how.side,
        wanted.point,
        wanted.basis.T,  # column by column
        wanted.gear_curvature,
        wanted.curvature,
        wanted.vector,
        wanted.acceleration,
        wanted.lever,
    )
    values = values.ravel()
    return AtPoint(values[:6], float(values[6]), values[7:], rates)


def at_root(how: Generation, flank: str, x: np.ndarray, cone: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Of the root that the blade of a flank leaves: meshing and cone distance less that of the ``cone`` at two places,
    and the depths [mm] there (6,); derivatives."""
    values, rates = _at_root(flank).at(x, how.index_ratio, how.blade_offset_angle, how.side, cone)
    return values.ravel(), rates


def generation(how: Generation, flank: str, x: np.ndarray) -> Generation:
    """The generation of a flank with settings and motion of the vector."""
    motion = how.motion.copy()
    for name, (setting, power) in MOVING.items():
        motion[SETTINGS.index(setting), power - 1] = x[index(name)]
    return replace(how, settings=x[settings_index(flank)].copy(), motion=motion)
