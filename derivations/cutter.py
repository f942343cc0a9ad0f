"""Chapter 1. The face-mill cutter with straight blades: a cone, and its normal.

    r_c(u, β) = [ρ cos β, ρ sin β, -u],   ρ = r_p + s u tan α                                  (1.1)
    n_c(β)    = [-s cos α cos β, -s cos α sin β, -sin α]                                       (1.2)

Frame T: origin in the tip plane on the cutter axis, k from the cutter head towards the work, so that a blade point at
height u above the tip plane has z = -u. s = +1 for the outer blade (concave flank), -1 for the inner blade (convex
flank). n_c points into the cutter: out of the metal, into the tooth space.

A blade has further sections. Toprem, a straight part of angle α_T below the height h_T, meets the blade there if

    r_pT = r_p + s h_T (tan α - tan α_T)                                                       (1.3)

A blade of circular arc (10.3) of radius r touches the straight one at the height h_r if its centre is at

    ρ_b = ρ(h_r) - s r cos α,   h_b = h_r + r sin α                                            (1.4)

The edge is rounded with radius r_e: tangent to the tip plane and to the straight part, or to an arc of radius r:

    h_e = h_t + r_e,   ρ_e = ρ(h_t) - s r_e (1 - sin α)/cos α,   joined at h_t + r_e (1 - sin α)  (1.5)
    ρ_e = ρ_b + s sign(r) √((r - r_e)² - (h_b - h_e)²)                                         (1.6)

h_t is the height of the tip above the plane in which r_p is measured, the tip plane of (1.1): outer and inner blades of
a tilted hobbing cutter have tips of their own, for all others it is 0.
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


@cache
def toprem() -> Expression:
    """(1.3) as an Expression."""
    alpha, side = q.blade_pressure_angle.symbol, q.side.symbol
    radius_there = q.blade_point_radius.symbol + side * q.toprem_height.symbol * (
        sp.tan(alpha) - sp.tan(q.toprem_angle.symbol)
    )
    return Expression(
        "toprem",
        "Point radius of a Toprem section that meets the blade at its height (1.3).",
        (q.blade_point_radius, q.blade_pressure_angle, q.toprem_angle, q.toprem_height, q.side),
        ((q.toprem_point_radius, radius_there),),
        source="two lines through one point",
    )


@cache
def spheric_blade() -> Expression:
    """(1.4) as an Expression."""
    r, height, alpha = q.blade_spheric_radius.symbol, q.reference_height.symbol, q.blade_pressure_angle.symbol
    center = sp.Matrix([radius(height) - q.side.symbol * r * sp.cos(alpha), height + r * sp.sin(alpha), r])
    return Expression(
        "spheric_blade",
        "Arc of a circular-arc blade that touches the straight blade at a reference height (1.4).",
        (q.blade_point_radius, q.blade_pressure_angle, q.blade_spheric_radius, q.reference_height, q.side),
        ((q.blade_arc, center),),
        source="circle through a point with a given tangent",
    )


@cache
def blade_tip() -> Expression:
    """ρ(h_t) of (1.1) as an Expression."""
    return Expression(
        "blade_tip",
        "Radius of a straight blade where it ends, its tip being above the plane of its point radius (1.1).",
        (q.blade_point_radius, q.blade_pressure_angle, q.blade_tip_height, q.side),
        ((q.blade_tip_radius, radius(q.blade_tip_height.symbol)),),
        source="(1.1)",
    )


@cache
def edge_round() -> Expression:
    """(1.5) as an Expression."""
    r, alpha, tip = q.blade_edge_radius.symbol, q.blade_pressure_angle.symbol, q.blade_tip_height.symbol
    flat = (1 - sp.sin(alpha)) / sp.cos(alpha)
    center = sp.Matrix([radius(tip) - q.side.symbol * r * flat, tip + r, r])
    return Expression(
        "edge_round",
        "Arc of the rounded edge between tip plane and straight blade, and the height where they join (1.5).",
        (q.blade_point_radius, q.blade_pressure_angle, q.blade_edge_radius, q.blade_tip_height, q.side),
        ((q.blade_arc, center), (q.joint_height, tip + r * (1 - sp.sin(alpha)))),
        source="circle tangent to two lines",
    )


@cache
def edge_round_of_arc() -> Expression:
    """(1.6) as an Expression."""
    center_radius, center_height, r = q.main_arc.symbols
    edge = q.blade_edge_radius.symbol
    height = q.blade_tip_height.symbol + edge
    across = sp.sqrt((r - edge) ** 2 - (center_height - height) ** 2)
    center = center_radius + q.side.symbol * sp.sign(r) * across
    joint = sp.asin((center_height - height) / (r - edge))
    return Expression(
        "edge_round_of_arc",
        "Arc of the rounded edge between tip plane and arc blade, and the normal's angle where they join (1.6).",
        (q.main_arc, q.blade_edge_radius, q.blade_tip_height, q.side),
        ((q.blade_arc, sp.Matrix([center, height, edge])), (q.joint_angle, joint)),
        requires=((r - edge) ** 2 - (center_height - height) ** 2,),
        source="circle tangent to a line and to a circle",
    )


def _off_blade(radius_there: sp.Expr, height: sp.Expr) -> sp.Expr:
    """Distance of a place (ρ, h) from the straight blade (1.1), positive on the side of the blade's steel."""
    return q.side.symbol * (radius(height) - radius_there) * sp.cos(q.blade_pressure_angle.symbol)


def prove_edge_round_touches_tip_plane_and_blade() -> None:
    """(1.5) Of all circles of radius r_e, it is the one in the steel that the tip plane and the straight blade touch.

    Its centre is found from the two distances, (1.1) alone; the joint is the foot of the centre on the blade.
    """
    r, alpha, side = q.blade_edge_radius.symbol, q.blade_pressure_angle.symbol, q.side.symbol
    tip = q.blade_tip_height.symbol
    rho, h = sp.symbols("rho h", real=True)
    for one in (1, -1):
        ((found_rho, found_h),) = sp.linsolve([h - tip - r, _off_blade(rho, h).subs(side, one) - r], [rho, h])
        center_radius, center_height, _ = edge_round()["blade_arc"].subs(side, one)
        assert is_zero(found_rho - center_radius)
        assert is_zero(found_h - center_height)
        joint = edge_round()["joint_height"]
        # from the centre to the joint is at right angles to the blade, along which (ρ, h) grows as (s sin α, cos α)
        to_joint = sp.Matrix([radius(joint).subs(side, one) - found_rho, joint - found_h])
        assert is_zero(to_joint.dot(sp.Matrix([one * sp.sin(alpha), sp.cos(alpha)])))
        assert is_zero(to_joint.dot(to_joint) - r**2)


def prove_edge_round_of_an_arc_touches_it() -> None:
    """(1.6) Two circles touch where their centres are |r - r_e| apart; the joint is on both, on the line of centres."""
    round_ = edge_round_of_arc()
    (center_radius, center_height, edge), joint = round_["blade_arc"], round_["joint_angle"]
    main_radius, main_height, r = q.main_arc.symbols
    across, up = center_radius - main_radius, center_height - main_height
    # s² = 1, sign(r)² = 1
    between = sp.expand(across**2 + up**2).subs(sp.sign(r) ** 2, 1).subs(q.side.symbol**2, 1)
    assert is_zero(between - (r - edge) ** 2)
    assert is_zero(center_height - q.blade_tip_height.symbol - edge)  # touches the plane of the tip
    # a point of an arc at the angle u lies r sin u below its centre (10.3): both arcs are at one height at the joint
    assert is_zero((center_height - edge * sp.sin(joint)) - (main_height - r * sp.sin(joint)))


def prove_edge_round_of_a_sharp_blade_is_its_tip() -> None:
    """(1.5) With r_e → 0 centre and joint come to the end of the blade."""
    r = q.blade_edge_radius.symbol
    end = sp.Matrix([blade_tip()["blade_tip_radius"], q.blade_tip_height.symbol])
    center = edge_round()["blade_arc"].subs(r, 0)
    assert is_zero(center[0] - end[0])
    assert is_zero(center[1] - end[1])
    assert is_zero(edge_round()["joint_height"].subs(r, 0) - end[1])


def prove_toprem_meets_the_blade() -> None:
    """(1.3) At the height h_T both straight parts have the same cutting radius."""
    height = q.toprem_height.symbol
    below = toprem()["toprem_point_radius"] + q.side.symbol * height * sp.tan(q.toprem_angle.symbol)
    assert is_zero(below - radius(height))


def prove_spheric_blade_touches_the_straight_one() -> None:
    """(1.4) Its centre is r from the straight blade (1.1), and its foot on the blade is at the reference height."""
    center_radius, center_height, r = spheric_blade()["blade_arc"]
    alpha, side, height = q.blade_pressure_angle.symbol, q.side.symbol, q.reference_height.symbol
    along = sp.Matrix([side * sp.sin(alpha), sp.cos(alpha)])
    to_blade = sp.Matrix([radius(height) - center_radius, height - center_height])
    for one in (1, -1):
        assert is_zero(_off_blade(center_radius, center_height).subs(side, one) - r)
        assert is_zero(to_blade.dot(along).subs(side, one))


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
