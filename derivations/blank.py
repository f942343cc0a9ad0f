"""Chapter 8. The blank of a bevel member: where a place on the flank lies in the (z_w, radius) plane.

With the pitch apex in the crossing point, cone distance r = R_m + (ξ - 1/2) b and height h above the pitch cone:

    z_w = r cos δ - h sin δ,   r_w = r sin δ + h cos δ                                         (8.1)
    h_a(r) = h_am + (r - R_m) tan(δ_a - δ),   h_f(r) = h_fm + (r - R_m) tan(δ - δ_f)           (8.2)
    h = (1 - η) (c - h_f) + η h_a                                                              (8.3)

so that η counts the working depth, from the lower limit (the clearance above the root cone) to the face cone.

At a point R of a flank, with radius r_w and outward normal n, are g along the cone line, p out of the pitch cone and e
around the axis, right-handed about z_w. The trace of the flank on the cone is cos β g + sin β e, so that

    sin α = n · p,   tan β = -(n · g)/(n · e)                                                  (8.4)

α > 0 where the flank can be seen from outside, β > 0 of a right-hand member, and n · e points across the tooth space.
"""

from __future__ import annotations

from functools import cache

import mpmath
import sympy as sp

from derivations import notation as q
from derivations.expression import Expression
from derivations.frames import Rz, rotation
from derivations.proof import DIGITS, is_close, is_zero, numbers


def cone_distance() -> sp.Expr:
    """r of a place along the tooth."""
    return q.mean_cone_distance.symbol + (q.across.symbol - sp.Rational(1, 2)) * q.face_width.symbol


def addendum() -> sp.Expr:
    """h_a(r) (8.2)."""
    from_mean = cone_distance() - q.mean_cone_distance.symbol
    return q.mean_addendum.symbol + from_mean * sp.tan(q.face_angle.symbol - q.pitch_angle.symbol)


def dedendum() -> sp.Expr:
    """h_f(r) (8.2)."""
    from_mean = cone_distance() - q.mean_cone_distance.symbol
    return q.mean_dedendum.symbol + from_mean * sp.tan(q.pitch_angle.symbol - q.root_angle.symbol)


def place(height: sp.Expr) -> tuple[sp.Expr, sp.Expr]:
    """z_w and r_w at a height above the pitch cone (8.1)."""
    r, delta = cone_distance(), q.pitch_angle.symbol
    return r * sp.cos(delta) - height * sp.sin(delta), r * sp.sin(delta) + height * sp.cos(delta)


@cache
def flank_place() -> Expression:
    """(8.3) as an Expression."""
    height = (1 - q.up.symbol) * (q.clearance.symbol - dedendum()) + q.up.symbol * addendum()
    axial, radial = place(height)
    return Expression(
        "flank_place",
        "Place of a flank point in the (z_w, radius) plane of its blank (8.1-8.3).",
        (q.blank, q.across, q.up),
        ((q.axial, axial), (q.radial, radial)),
        source="ISO 23509 blank with coincident apexes of pitch cone and crossing point",
    )


def _directions(point: sp.Matrix) -> tuple[sp.Matrix, sp.Matrix, sp.Matrix]:
    """g, p, e at a point (8.4)."""
    delta, radius = q.pitch_angle.symbol, sp.sqrt(point[0] ** 2 + point[1] ** 2)
    c, s = point[0] / radius, point[1] / radius
    g = sp.Matrix([sp.sin(delta) * c, sp.sin(delta) * s, sp.cos(delta)])
    p = sp.Matrix([sp.cos(delta) * c, sp.cos(delta) * s, -sp.sin(delta)])
    return g, p, sp.Matrix([-s, c, 0])


@cache
def flank_angles() -> Expression:
    """(8.4) as an Expression."""
    point, n = sp.Matrix(q.point_w.symbol), sp.Matrix(q.normal_w.symbol)
    g, p, e = _directions(point)
    return Expression(
        "flank_angles",
        "Signed pressure and spiral angle of a flank at a point, and which way its space lies (8.4).",
        (q.pitch_angle, q.point_w, q.normal_w),
        (
            (q.flank_pressure_angle, sp.asin(n.dot(p))),
            (q.spiral_angle, sp.atan(-n.dot(g) / n.dot(e))),
            (q.across_space, n.dot(e)),
            (q.flank_azimuth, sp.atan2(point[1], point[0])),
        ),
        requires=(
            point[0] ** 2 + point[1] ** 2 - 1,
            n.dot(e) ** 2 - sp.Rational(1, 100),
            sp.Rational(99, 100) - n.dot(p) ** 2,
        ),
        source="trace of the flank on the pitch cone",
    )


def prove_face_and_root_lines_have_their_cone_angles() -> None:
    """(8.1, 8.2) Along the tip and the root, dr_w/dz_w is the tangent of face and root angle."""
    for height, angle in ((addendum(), q.face_angle.symbol), (-dedendum(), q.root_angle.symbol)):
        axial, radial = place(height)
        along = q.across.symbol
        assert is_zero(radial.diff(along) * sp.cos(angle) - axial.diff(along) * sp.sin(angle))


def prove_pitch_points_lie_on_the_pitch_cone() -> None:
    """(8.1) Height zero gives points of the cone with angle δ through the apex, at their cone distance."""
    axial, radial = place(sp.S.Zero)
    assert is_zero(axial**2 + radial**2 - cone_distance() ** 2)
    assert is_zero(radial * sp.cos(q.pitch_angle.symbol) - axial * sp.sin(q.pitch_angle.symbol))


def prove_a_normal_square_to_the_trace_gives_back_its_angles() -> None:
    """(8.4) A flank about the trace cos β g + sin β e, turned about it from upright by α, on either side of the space.

    The cone line is the direction from the apex to the point; e is along the circle, p square to both.
    """
    delta, azimuth = sp.Rational(3, 8), sp.Rational(7, 4)
    g = Rz(azimuth) * sp.Matrix([sp.sin(delta), 0, sp.cos(delta)])
    e = Rz(azimuth) * sp.Matrix([0, 1, 0])
    for alpha, beta in ((sp.Rational(3, 8), sp.Rational(5, 8)), (-sp.Rational(1, 8), -sp.Rational(1, 4))):
        trace = sp.cos(beta) * g + sp.sin(beta) * e
        upright = g.cross(e).cross(trace)  # within the pitch cone's tangent plane
        for side in (1, -1):
            n = rotation(trace, -side * alpha) * (side * upright)
            with mpmath.workdps(DIGITS):
                found = flank_angles().function(*numbers([delta, *(70 * g), *n]))
                assert is_close(found[:2], numbers([alpha, beta]))
                assert is_close([abs(found[2]), found[3]], numbers([sp.cos(alpha) * sp.cos(beta), azimuth]))
                assert found[2] * side > 0
