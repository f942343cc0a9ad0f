"""Where the flank of other settings crosses a line, and how that place moves with every setting: all cutting methods.

    R(u, β, θ; x, m) = P + t d,   f = 0 (Formate: θ = 0)

is solved for u, β, θ by damped Newton steps on what R is off the line; t is the deviation, and (20.1), (20.2) are its
gradient by the settings and by the coefficients of their motion.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import Literal

import casadi as ca

from derivations import Quantity, notation
from gearmath.bevel.generation_kernels import rolling_flag
from gearmath.bevel.newton import contact_guess, newton_step, residual_size
from gearmath.engine.kernel import Kernel
from gearmath.kernels import kernel

#: plain: face milling of chapters 2 to 4; straight and curved: the family of chapter 10, by its blade.
Kind = Literal["plain", "straight", "curved"]

_NEWTON_STEPS = 6
_STEP_LIMITS = (1.0, 0.05, 0.05)
_CUT = (notation.settings, notation.motion, notation.index_ratio, notation.blade_offset_angle)
#: How the flank is cut: what follows the start values, and goes before the line.
INPUTS: dict[str, tuple[Quantity, ...]] = {
    "plain": (notation.settings, notation.side),
    "straight": (*_CUT, notation.side, rolling_flag),
    "curved": (*_CUT, notation.blade_curvature, notation.reference_height, notation.side, rolling_flag),
}


@dataclass(frozen=True)
class LineFamily:
    """A point of the family, what is zero where it is in mesh [mm], its height on the blade, and n·R_x / (n·d)."""

    point: ca.SX
    meshing: ca.SX
    height: ca.SX
    sensitivity: ca.SX


def symbols(kind: Kind) -> list[ca.SX]:
    """One symbol of its shape for every quantity of ``INPUTS``."""
    return [ca.SX.sym(quantity.name, *(quantity.shape or (1,))) for quantity in INPUTS[kind]]


def family(kind: Kind, w: ca.SX, given: list[ca.SX], direction: ca.SX) -> LineFamily:
    """The kernels of a kind composed at u, β, θ: the derivations' points, meshing residuals and sensitivities."""
    uvw, settings = (w[0], w[1], w[2]), given[0]
    if kind == "plain":
        point, normal = kernel("flank_family").function(*uvw, *given)
        meshing = kernel("meshing").function(*uvw, *given)
        gradient = kernel("setting_sensitivity").function(*uvw, *given) / ca.dot(normal, direction)
        return LineFamily(point, meshing / settings[0], w[0], gradient)
    *cut, side, rolling = given
    (settings_at,) = kernel("moved_settings").function.call([settings, cut[1], w[2]])
    if kind == "curved":
        blade = cut[4:]
        point, normal, meshing = kernel("curved_generation").function(*uvw, *cut, side)
        gradient = kernel("curved_sensitivity").function(*uvw, settings_at, *cut[2:], side, normal, direction)
        height = kernel("curved_height").function(w[0], settings[11], *blade)
    else:
        point, normal, meshing = kernel("straight_generation").function(*uvw, *cut, side)
        gradient = kernel("straight_sensitivity").function(*uvw, settings_at, *cut[2:], side, normal, direction)
        height = w[0]
    reach = settings[0]  # a length of the size of the machine
    return LineFamily(point, rolling * meshing / reach + (1 - rolling) * reach * w[2], height, gradient)


@cache
def flank_on_line(kind: Kind = "plain", steps: int = _NEWTON_STEPS) -> Kernel:
    """Kernel: where the flank of other settings crosses a line, and the gradient of that distance by the settings.

    Of a curved blade, the gradient (13,) ends with that by its curvature. ``steps`` of Newton are made, whatever they
    leave: what calls it looks at the residual, and goes on from the contact where it is too large.
    """
    w, given = ca.SX.sym("contact", 3), symbols(kind)
    point, direction = ca.SX.sym("line_point", 3), ca.SX.sym("line_direction", 3)
    at = family(kind, w, given, direction)
    off = at.point - point
    e1 = ca.vertcat(direction[1], -direction[0], 0) / ca.sqrt(direction[0] ** 2 + direction[1] ** 2)
    residual = ca.vertcat(ca.dot(e1, off), ca.dot(ca.cross(direction, e1), off), at.meshing)
    arguments = [w, *given, point, direction]
    step = ca.Function("line_newton_step", arguments, [newton_step(residual, w, _STEP_LIMITS)])
    final = ca.Function("line_at", arguments, [ca.dot(direction, off), at.sensitivity, ca.norm_2(residual)])
    quantities = (contact_guess, *INPUTS[kind], notation.line_point, notation.line_direction)
    guess, *others = (ca.MX.sym(quantity.name, *(quantity.shape or (1,))) for quantity in quantities)
    solution = guess
    for _ in range(steps):
        solution = step(solution, *others)
    outputs = (
        notation.contact,
        notation.deviation,
        notation.curved_rates if kind == "curved" else notation.sensitivity,
        residual_size,
    )
    name = "flank_on_line" if kind == "plain" else f"{kind}_on_line"
    function = ca.Function(
        name if steps == _NEWTON_STEPS else f"{name}_in_{steps}",
        [guess, *others],
        [solution, *final(solution, *others)],
        [quantity.name for quantity in quantities],
        [quantity.name for quantity in outputs],
    )
    return Kernel(
        function,
        "Deviation at a nominal point of the flank that other settings cut, with its gradient by the settings.",
        quantities,
        outputs,
        "family and meshing of chapters 3, 4 and 10 on a line; (20.1)",
    )
