"""Chapter 24. Ease-off: how far the flank of a member is off the one that is conjugate to its mate.

A point G of the mate's flank meets the member when the mate has turned by ψ, at the place z_m, r_m of the member (20.5,
20.6). By then the member has turned by -ψ z/z_m. Turned back, with the axes x_m = [cos Σ, 0, -sin Σ], y_m = j of the
member, the point of the conjugate flank lies at the azimuth

    χ = atan2((Rz(ψ) G)·y_m, (Rz(ψ) G)·x_m) + ψ z/z_m                                             (24.1)

where z are the teeth of the mate, z_m those of the member: 20.5 names them from the mate. The member's own flank has at
the same place the point R with the outward normal n. What it must be turned by to lie there, times the lever of n about
the axis, is the gap between both along the normal, to first order in that turn:

    E = (n·(k × R)) (χ - χ_R),   positive = gap                                                    (24.2)

χ counts from a plane that the phase of the mates decides: E is meant but for a rotation of the member.
"""

from __future__ import annotations

from functools import cache

import sympy as sp

from derivations import notation as q
from derivations.expression import Expression
from derivations.frames import J, K, Rz
from derivations.proof import is_zero


def _across_axis() -> sp.Matrix:
    """x_m: square to the axis of the member, in the plane of both axes."""
    sigma = q.shaft_angle.symbol
    return sp.Matrix([sp.cos(sigma), 0, -sp.sin(sigma)])


@cache
def conjugate_azimuth() -> Expression:
    """(24.1) as an Expression."""
    psi = q.meeting_angle.symbol
    turned = Rz(psi) * sp.Matrix(q.point_w.symbol)
    x, y = turned.dot(_across_axis()), turned.dot(sp.Matrix(J))
    return Expression(
        "conjugate_azimuth",
        "Azimuth on the member of the conjugate of a point of the mate's flank (24.1).",
        (q.point_w, q.meeting_angle, q.shaft_angle, q.mate_ratio),
        ((q.conjugate_azimuth, sp.atan2(y, x) + psi / q.mate_ratio.symbol),),
        requires=(x**2 + y**2 - 1,),
        source="gear meshing of two fixed axes with a constant ratio",
    )


@cache
def ease_off() -> Expression:
    """(24.2) as an Expression."""
    R, n = sp.Matrix(q.point_w.symbol), sp.Matrix(q.normal_w.symbol)
    return Expression(
        "ease_off",
        "Gap along the normal between a flank and the same flank turned about the axis of its member (24.2).",
        (q.point_w, q.normal_w, q.gap_turn),
        ((q.ease_off, n.dot(sp.Matrix(K).cross(R)) * q.gap_turn.symbol),),
        source="Litvin and Fuentes, Gear Geometry and Applied Theory, chapter 21: ease-off as normal gap",
    )


def prove_conjugate_points_of_the_pitch_cones_have_equal_arcs() -> None:
    """(24.1) A point of the mate's pitch cone at the azimuth c meets at ψ = -c, and r_m χ = -r c: pure rolling."""
    delta, delta_m, s, c = sp.symbols("delta delta_m s c", positive=True)
    at = sp.Matrix([s * sp.sin(delta) * sp.cos(c), s * sp.sin(delta) * sp.sin(c), s * sp.cos(delta)])
    turned = Rz(-c) * at
    here = {q.shaft_angle.symbol: delta + delta_m}
    x, y = turned.dot(_across_axis().subs(here)), turned.dot(sp.Matrix(J))
    # on the common pitch line: on the side of the mate's axis, where the azimuth itself is half a turn
    assert is_zero(y)
    assert is_zero(x + s * sp.sin(delta_m))
    expression = conjugate_azimuth()["conjugate_azimuth"]
    turn = expression - expression.subs(q.meeting_angle.symbol, 0)
    rolled = turn.coeff(1 / q.mate_ratio.symbol).subs(q.meeting_angle.symbol, -c) * sp.sin(delta) / sp.sin(delta_m)
    assert is_zero(s * sp.sin(delta_m) * rolled + s * sp.sin(delta) * c)


def prove_ease_off_is_the_normal_part_of_a_turn() -> None:
    """(24.2) E = n·d/dχ (Rz(χ) R) dχ at χ = 0."""
    chi, R, n = sp.Symbol("chi", real=True), sp.Matrix(q.point_w.symbol), sp.Matrix(q.normal_w.symbol)
    moved = (Rz(chi) * R).diff(chi).subs(chi, 0)
    assert is_zero(n.dot(moved) * q.gap_turn.symbol - ease_off()["ease_off"])
