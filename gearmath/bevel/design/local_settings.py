"""Settings of the pinion out of point, normal and curvature at one point: a square system and its homotopy (27.5).

The root is held with it: where the tip plane of the cutter cuts deepest, at toe and heel, is where the blank has it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cache

import casadi as ca
import numpy as np

from derivations import notation
from gearmath.bevel.generation import Generation
from gearmath.bevel.root import FLAT_BLADE
from gearmath.engine.points import Points
from gearmath.kernels import kernel
from gearmath.specs.bevel_set import SETTINGS

#: What may be unknown besides the settings: coefficients of the motion, by (setting, power).
MOVING = {
    "modified_roll_2": ("work_rotation_offset", 2),
    "modified_roll_3": ("work_rotation_offset", 3),
    "helical_motion": ("sliding_base", 1),
}
#: Contact of the flank (θ = 0), of the tip plane at the root of toe and heel; settings, coefficients of their motion.
ROOT = ("toe_beta", "toe_theta", "heel_beta", "heel_theta")
#: Last the curvature [1/mm] added across the path, which changes neither path nor parabola, but the ellipse (26.6).
ACROSS = "curvature_across"
NAMES = ("u", "beta", *ROOT, *SETTINGS, *MOVING, ACROSS)
FIRST = NAMES.index(SETTINGS[0])
#: What the square system finds; any other of NAMES may be given.
UNKNOWN = (
    "u",
    "beta",
    *ROOT,
    "radial_distance",
    "cradle_angle",
    "blank_offset",
    "sliding_base",
    "machine_center_to_crossing_point",
    "machine_root_angle",
    "ratio_of_roll",
    "work_rotation_offset",
    "blade_point_radius",
)
#: Sizes that count alike in a Newton step: mm, rad and coefficients; the way of least change is taken in these.
_SIZES = {
    "u": 1.0,
    "beta": 0.05,
    **dict.fromkeys(ROOT, 0.05),
    "cradle_angle": 0.05,
    "work_rotation_offset": 0.1,
    "cutter_tilt": 0.03,
    "cutter_swivel": 0.1,
    "machine_root_angle": 0.02,
    "ratio_of_roll": 0.1,
    "blade_pressure_angle": 0.03,
    "modified_roll_2": 0.05,
    "modified_roll_3": 0.2,
}
_STEPS, _TOLERANCE, _PARTS, _LEAST = 12, 1e-10, 20, 1e-4
#: A curvature counts as a length by the square of this. [mm]
_LENGTH = 30.0


@dataclass(frozen=True)
class WantedPoint:
    """Point (3,) [mm], outward normal (3,), shape operator (2,2) [1/mm] in a ``basis`` (3,2), depths (2,) [mm].

    The shape operator is that with the normal into the pinion, as chapter 26 has it; the depths those of the
    root below the pitch cone at toe and heel. ``cone`` holds the pitch angle [rad] and the cone distances of toe and
    heel [mm], ``path`` the direction of the path on the pinion [rad] in the basis.
    """

    point: np.ndarray
    normal: np.ndarray
    basis: np.ndarray
    curvature: np.ndarray
    depth: np.ndarray
    cone: np.ndarray
    path: float


@cache
def _system(formate: bool) -> Points:
    """x of NAMES, index ratio, blade offset, side, and what is wanted -> residuals (15,) and derivatives by x."""
    x, cone = ca.SX.sym("x", len(NAMES)), ca.SX.sym("cone", 3)
    cut = [ca.SX.sym(name) for name in ("index", "offset", "side")]
    P, n, T, K, depth = (ca.SX.sym(*s) for s in (("P", 3), ("n", 3), ("T", 3, 2), ("K", 3), ("depth", 2)))
    path, added = ca.SX.sym("path"), x[len(NAMES) - 1]
    across = added * ca.vertcat(ca.sin(path) ** 2, -ca.sin(path) * ca.cos(path), ca.cos(path) ** 2)
    w, motion = ca.SX.sym("w", 3), ca.SX(*notation.motion.shape)
    settings = x[FIRST : FIRST + len(SETTINGS)]
    for k, (name, power) in enumerate(MOVING.values()):
        motion[SETTINGS.index(name), power - 1] = x[FIRST + len(SETTINGS) + k]
    family, reach = kernel("straight_generation").function, settings[0]

    def condition(meshing: ca.SX, theta: ca.SX) -> ca.SX:
        return reach * theta if formate else meshing / reach

    point, normal, meshing = family(w[0], w[1], w[2], settings, motion, *cut)
    on_flank = condition(meshing, w[2])
    rates = ca.jacobian(point, w), -ca.jacobian(normal, w), ca.jacobian(on_flank, w).T
    found = kernel("flank_curvature").function(*rates, T)
    flank = ca.vertcat(
        point - P,
        _LENGTH * T.T @ normal,
        on_flank,
        _LENGTH**2 * (ca.vertcat(found[0, 0], (found[0, 1] + found[1, 0]) / 2, found[1, 1]) - K - across),
    )
    flank = ca.substitute(flank, w, ca.vertcat(x[0], x[1], 0))
    tip_plane = ca.vertcat(settings[:-1], FLAT_BLADE)
    roots = []
    for k in range(2):
        beta, theta = x[2 + 2 * k], x[3 + 2 * k]
        root, _, meshing = family(0, beta, theta, tip_plane, motion, *cut)
        along, deep = kernel("root_place").function(root, cone[0])
        roots += [condition(meshing, theta), along - cone[1 + k], deep - depth[k]]
    off = ca.vertcat(flank, *roots)
    given = [x, *cut, cone, P, n, T, K, depth, path]
    return Points(ca.Function("local_settings", given, ca.cse([off, ca.densify(ca.jacobian(off, x))])))


@dataclass(frozen=True)
class LocalSystem:
    """A solution: x of NAMES, and how it moves with what was held: derivatives by all of NAMES."""

    x: np.ndarray
    residual: float
    rates: np.ndarray

    @property
    def settings(self) -> np.ndarray:
        return self.x[FIRST : FIRST + len(SETTINGS)]


def residual(how: Generation, x: np.ndarray, wanted: WantedPoint) -> tuple[np.ndarray, np.ndarray]:
    """How far settings are off what is wanted (15,), and its derivatives (15,22)."""
    K = wanted.curvature[[0, 0, 1], [0, 1, 1]]
    off, rates = _system(not how.rolling).at(
        x,
        how.index_ratio,
        how.blade_offset_angle,
        how.side,
        wanted.cone,
        wanted.point,
        wanted.normal,
        wanted.basis.T,  # column by column
        K,
        wanted.depth,
        wanted.path,
    )
    return off.ravel(), rates


def solve(how: Generation, x: np.ndarray, wanted: WantedPoint, free: Sequence[str] = UNKNOWN) -> LocalSystem | None:
    """The settings near ``x`` (22,) that give what is wanted, by the ``free`` ones alone; None where Newton fails.

    More free settings than conditions change as little as they can.
    """
    index = [NAMES.index(name) for name in free]
    sizes = np.array([_SIZES.get(name, 1.0) for name in free])
    x = x.copy()
    for _ in range(_STEPS):
        off, rates = residual(how, x, wanted)
        if not (np.isfinite(off).all() and np.isfinite(rates).all()):
            return None
        size = float(np.abs(off).max())
        if size < _TOLERANCE:
            return LocalSystem(x, size, rates)
        try:
            step = sizes * np.linalg.lstsq(rates[:, index] * sizes, -off)[0]
        except np.linalg.LinAlgError:
            return None
        x[index] += step / max(1.0, float((np.abs(step) / (10 * sizes)).max()))
    return None


def followed(
    how: Generation, x: np.ndarray, start: WantedPoint, end: WantedPoint, free: Sequence[str] = UNKNOWN
) -> LocalSystem | None:
    """The settings that give ``end``, followed from ``x`` (22,) which gives ``start``; None where the way ends."""
    found = solve(how, x, start, free)
    part, step = 0.0, 1.0 / _PARTS
    while found is not None and part < 1.0:
        ahead = min(part + step, 1.0)
        following = solve(how, found.x, between(start, end, ahead), free)
        if following is None:
            step /= 2
            if step < _LEAST:
                return None
            continue
        found, part, step = following, ahead, min(2 * step, 0.25)
    return found


def curvature(how: Generation, x: np.ndarray, at: WantedPoint) -> np.ndarray:
    """The shape operator (2,2) [1/mm] that settings give in the basis of ``at``."""
    off, _ = residual(how, x, at)
    one, mixed, two = off[6:9] / _LENGTH**2
    return at.curvature + np.array([[one, mixed], [mixed, two]])


def depth(how: Generation, x: np.ndarray, at: WantedPoint) -> np.ndarray:
    """Depths (2,) of the root [mm] below the pitch cone that settings give at toe and heel."""
    return at.depth + residual(how, x, at)[0][[11, 14]]


def generation(how: Generation, found: LocalSystem) -> Generation:
    """The generation with the settings and the motion of a solution."""
    motion = how.motion.copy()
    for k, (name, power) in enumerate(MOVING.values()):
        motion[SETTINGS.index(name), power - 1] = found.x[FIRST + len(SETTINGS) + k]
    return replace(how, settings=found.settings.copy(), motion=motion)


def between(start: WantedPoint, end: WantedPoint, part: float) -> WantedPoint:
    """What lies a part of the way between two, each curvature in the basis at its own normal."""
    normal = (1 - part) * start.normal + part * end.normal
    normal /= np.linalg.norm(normal)
    first = end.basis[:, 0] - normal * (normal @ end.basis[:, 0])
    first /= np.linalg.norm(first)
    second = np.cross(normal, first)
    second *= np.sign(second @ end.basis[:, 1])
    return WantedPoint(
        (1 - part) * start.point + part * end.point,
        normal,
        np.column_stack([first, second]),
        (1 - part) * start.curvature + part * end.curvature,
        (1 - part) * start.depth + part * end.depth,
        end.cone,
        end.path,
    )
