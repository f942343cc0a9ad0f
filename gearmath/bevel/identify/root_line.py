"""The root line of a flank: where the tip of the blade leaves it, at toe and heel, and how settings move it.

    h(u) = 0,   L(R) = L_0,   f(u, β, θ; x) = 0    →    depth D below the pitch cone     (20.3, 20.4)

Flanks hardly show the depth of a cut. So a fit that is free to do so buys topography with depth; here it is watched.
That line lies above the deepest one of the space, and moves with it within some ten percent as long as settings change
by little; a machine root angle and a ratio of roll at their limits part the two by a millimetre.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import casadi as ca
import numpy as np

from derivations import Quantity, notation
from gearmath.bevel.generation import Generation
from gearmath.bevel.generation_kernels import rolling_flag
from gearmath.bevel.identify.on_line import INPUTS, family, symbols
from gearmath.bevel.identify.variables import parts
from gearmath.bevel.newton import FlankPoints, contact_guess, newton_step, residual_size
from gearmath.bevel.root import CORNER
from gearmath.engine.kernel import Kernel
from gearmath.errors import ComputationError
from gearmath.kernels import kernel
from gearmath.specs.bevel_set import SETTINGS, Member

#: Newton steps at once, and how often they are made until the root is found: at most 24.
_NEWTON_STEPS, _ROUNDS = 3, 8
_STEP_LIMITS = (2.0, 0.1, 0.1)
_TOLERANCE = 1e-9
#: The root line is watched at this part of the face width from either end.
_ROOT_MARGIN = 0.1
_RADIUS, _ANGLE = SETTINGS.index("blade_point_radius"), SETTINGS.index("blade_pressure_angle")
#: How a flank is cut, for the line that the tip plane of its blade leaves.
_TIP = (
    notation.settings,
    notation.motion,
    notation.index_ratio,
    notation.blade_offset_angle,
    notation.blade_tip_height,
    notation.side,
    rolling_flag,
)

_depth_gradient = Quantity(
    "depth_gradient",
    "depth gained per unit of every setting, of every coefficient of the motion and of the curvature",
    "mixed",
    r"\partial D/\partial\mathbf{x}",
    shape=(83,),
)


@cache
def root_depth() -> Kernel:
    """Kernel: depth of the root line below the pitch cone at a cone distance, and its gradient, for any blade."""
    w, given, delta, distance = ca.SX.sym("w", 3), symbols("curved"), ca.SX.sym("delta"), ca.SX.sym("distance")
    at = family("curved", w, given, ca.SX([0, 0, 1]))
    along, depth = kernel("root_place").function(at.point, delta)
    residual = ca.vertcat(at.height, along - distance, at.meshing)
    return _depth_kernel(
        "root_depth",
        "Depth of the root line below the pitch cone at a cone distance, with its gradient by settings and motion.",
        _Line([w, *given, delta, distance], given[4], depth, residual, INPUTS["curved"]),
    )


@cache
def tip_depth() -> Kernel:
    """Kernel: the same of the line that the tip plane of the blade leaves, which may stand off that of the radius."""
    w, delta, distance = ca.SX.sym("w", 3), ca.SX.sym("delta"), ca.SX.sym("distance")
    given = [ca.SX.sym(quantity.name, *(quantity.shape or (1,))) for quantity in _TIP]
    settings, motion, index, offset, tip, side, rolling = given
    radius = kernel("blade_tip").function(settings[_RADIUS], settings[_ANGLE], tip, side)
    # the lowest point of a vanishing round: its tangent is the tip plane
    corner = ca.vertcat(radius, tip + CORNER, CORNER)
    generation = kernel("arc_generation").function
    point, _, meshing = generation(ca.pi / 2, w[1], w[2], settings, motion, index, offset, corner, side)
    along, depth = kernel("root_place").function(point, delta)
    reach = settings[0]
    in_mesh = rolling * meshing / reach + (1 - rolling) * reach * w[2]
    residual = ca.vertcat(w[0], along - distance, in_mesh)
    return _depth_kernel(
        "tip_depth",
        "Depth of what the tip of the blade leaves below the pitch cone at a cone distance, with its gradient.",
        _Line([w, *given, delta, distance], ca.SX.sym("curvature"), depth, residual, _TIP),
    )


@dataclass(frozen=True)
class _Line:
    """A depth and what is zero on its line, of arguments: the contact, what ``quantities`` are, δ and cone distance."""

    arguments: list[ca.SX]
    curvature: ca.SX
    depth: ca.SX
    residual: ca.SX
    quantities: tuple[Quantity, ...]


def _depth_kernel(name: str, description: str, line: _Line) -> Kernel:
    """Newton steps onto a line, and the gradient of the depth there by the implicit function theorem."""
    arguments, residual, depth = line.arguments, line.residual, line.depth
    w, settings, motion = arguments[:3]
    step = ca.Function("root_newton_step", arguments, [newton_step(residual, w, _STEP_LIMITS)])
    multipliers = ca.SX.sym("multipliers", 3)
    lagrangian = depth - ca.dot(multipliers, residual)
    by_motion = ca.densify(ca.gradient(lagrangian, motion).T)
    by_curvature = ca.gradient(lagrangian, line.curvature)
    gradient = ca.vertcat(ca.gradient(lagrangian, settings), ca.vec(by_motion), ca.densify(by_curvature))
    slope = ca.Function("root_slope", [multipliers, *arguments], [gradient])
    solved = ca.solve(ca.jacobian(residual, w).T, ca.jacobian(depth, w).T)
    final = ca.Function("root_at", arguments, [depth, solved, ca.norm_2(residual)])
    quantities = (contact_guess, *line.quantities, notation.pitch_angle, notation.cone_distance)
    guess, *others = (ca.MX.sym(quantity.name, *(quantity.shape or (1,))) for quantity in quantities)
    solution = guess
    for _ in range(_NEWTON_STEPS):
        solution = step(solution, *others)
    found, lagrange, left = final(solution, *others)
    function = ca.Function(
        name,
        [guess, *others],
        [solution, found, slope(lagrange, solution, *others), left],
        [quantity.name for quantity in quantities],
        ["contact", "cone_depth", "depth_gradient", "residual_size"],
    )
    return Kernel(
        function,
        description,
        quantities,
        (notation.contact, notation.cone_depth, _depth_gradient, residual_size),
        "(20.3, 20.4) and meshing; implicit function theorem",
    )


@dataclass(frozen=True)
class RootLine:
    """Where the root of a flank is watched: cone distances (2,) [mm] of toe and heel, and starts (2,3) for u, β, θ.

    ``deepest`` is the line that the tip plane of the blade leaves, in the middle of the space, in place of the end of
    the flank: a correction is limited by it, and so is a design whose pressure angle or radius is free. ``tip_height``
    [mm] is where that plane stands over the one of the point radius.
    """

    how: Generation
    reference_height: float
    pitch_angle: float
    distances: np.ndarray
    start: np.ndarray
    tip_height: float = 0.0
    deepest: bool = False

    def depth(self, vector: np.ndarray, start: np.ndarray | None = None) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Contact (2,3), depth (2,) [mm] and its gradient (2,83) for settings, motion and curvature (83,).

        ``start`` (2,3) is the contact of settings nearby. Raises ComputationError if the tip of the blade does not
        reach the flank there.
        """
        how, (settings, motion) = self.how, parts(vector)
        blade = (self.tip_height,) if self.deepest else (float(vector[-1]), self.reference_height)
        contact, depths = self.start if start is None else start, tip_depth() if self.deepest else root_depth()
        cut = (how.index_ratio, how.blade_offset_angle, *blade, how.side, float(how.rolling))
        for _ in range(_ROUNDS):
            contact, depth, gradient, residual = depths(
                contact, settings, motion, *cut, self.pitch_angle, self.distances
            )
            if (residual <= _TOLERANCE).all():
                return contact, depth, gradient
        raise ComputationError("the tip of the blade does not reach the root of the flank")

    def sunk(self, before: np.ndarray, after: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """How much deeper (2,) [mm] the root lies after a change, at toe and heel, and its gradient (2,83)."""
        _, depth, gradient = self.depth(after)
        return depth - self.depth(before)[1], gradient


def root_line(member: Member, flank: str, how: Generation, nominal: FlankPoints) -> RootLine:
    """The root line of a flank, watched near toe and heel; the starts are the nominal points nearest to them.

    The blade parameter of ``nominal`` is the height of the foot (10.9), for an arc blade too.
    """
    blank = member.blank
    half = (0.5 - _ROOT_MARGIN) * blank.face_width
    distances = blank.mean_cone_distance + half * np.array([-1.0, 1.0])
    cone = np.linalg.norm(nominal.point, axis=1)
    # of the lowest points, as the blade counts, that nearest in cone distance
    height = np.argsort(nominal.contact[:, 0])
    lowest = height[: max(2, len(height) // 5)]
    start = np.array([nominal.contact[lowest[np.argmin(np.abs(cone[lowest] - one))]] for one in distances])
    start[:, 0] = 0.0
    spec = member.flank(flank)
    return RootLine(how, spec.blade_reference_height, blank.delta, distances, start, spec.blade_tip_height)
