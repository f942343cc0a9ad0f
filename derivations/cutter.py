"""Chapter 1. The face-mill cutter with straight blades: a cone, and its normal.

    r_c(u, β) = [ρ cos β, ρ sin β, -u],   ρ = r_p + s u tan α                                  (1.1)
    n_c(β)    = [-s cos α cos β, -s cos α sin β, -sin α]                                       (1.2)

Frame T: origin in the tip plane on the cutter axis, k from the cutter head towards the work, so that a blade point at
height u above the tip plane has z = -u. s = +1 for the outer blade (concave flank), -1 for the inner blade (convex
flank). n_c points into the cutter: out of the metal, into the tooth space.
"""

from __future__ import annotations

from functools import cache

import sympy as sp

from derivations import notation as q
from derivations.expression import Expression
from derivations.proof import is_zero


def radius(height: sp.Expr) -> sp.Expr:
    """Cutting radius ρ of the blade at a height above the tip plane (1.1)."""
    return q.blade_point_radius.symbol + q.side.symbol * height * sp.tan(q.blade_pressure_angle.symbol)


def point() -> sp.Matrix:
    """r_c, a point of the cutter surface (1.1)."""
    u, beta, rho = q.u.symbol, q.beta.symbol, radius(q.u.symbol)
    return sp.Matrix([rho * sp.cos(beta), rho * sp.sin(beta), -u])


def normal() -> sp.Matrix:
    """n_c, the unit normal into the cutter (1.2)."""
    beta, alpha, side = q.beta.symbol, q.blade_pressure_angle.symbol, q.side.symbol
    return sp.Matrix([-side * sp.cos(alpha) * sp.cos(beta), -side * sp.cos(alpha) * sp.sin(beta), -sp.sin(alpha)])


@cache
def cutter_surface() -> Expression:
    """Point and normal of the cutter surface as an Expression."""
    return Expression(
        "cutter_surface",
        "Point and inward unit normal of a straight-bladed face mill (1.1, 1.2).",
        (q.u, q.beta, q.blade_point_radius, q.blade_pressure_angle, q.side),
        ((q.point_c, point()), (q.normal_c, normal())),
        source="cone of revolution; NASA TM-105150 eq. for r_c in other axes",
    )


def prove_normal_is_the_cross_product_of_the_tangents() -> None:
    """(1.2) is r_u × r_β made a unit vector, with one sign for each blade."""
    r = point()
    cross = r.diff(q.u.symbol).cross(r.diff(q.beta.symbol))
    for side in (1, -1):
        values = {q.side.symbol: side}
        rho, alpha = radius(q.u.symbol).subs(values), q.blade_pressure_angle.symbol
        unit = (cross.subs(values) * sp.cos(alpha) / rho).applyfunc(sp.simplify)
        assert is_zero(unit + side * normal().subs(values))
        assert sp.simplify(unit.dot(unit)) == 1


def prove_normal_points_into_the_cutter() -> None:
    """(1.2) A small step along n_c leads to a radius inside the blade (outer) or outside of it (inner)."""
    t = sp.Symbol("t", positive=True)
    p = point() + t * normal()
    for side in (1, -1):
        gap = side * (radius(-p[2]) ** 2 - p[0] ** 2 - p[1] ** 2)  # > 0 within the cutter
        slope = sp.simplify(gap.diff(t).subs(t, 0).subs(q.side.symbol, side))
        rho = radius(q.u.symbol).subs(q.side.symbol, side)
        assert sp.simplify(slope - 2 * rho / sp.cos(q.blade_pressure_angle.symbol)) == 0


def prove_surface_is_a_cone() -> None:
    """(1.1) The distance of r_c from the apex of the cone makes the angle α with the axis everywhere."""
    r, alpha, side = point(), q.blade_pressure_angle.symbol, q.side.symbol
    apex = sp.Matrix([0, 0, side * q.blade_point_radius.symbol / sp.tan(alpha)])
    generator = r - apex
    tangent_squared = (generator[0] ** 2 + generator[1] ** 2) / generator[2] ** 2
    assert sp.simplify(tangent_squared.subs(side, 1) - sp.tan(alpha) ** 2) == 0
    assert sp.simplify(tangent_squared.subs(side, -1) - sp.tan(alpha) ** 2) == 0
