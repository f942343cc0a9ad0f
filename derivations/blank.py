"""Chapter 8. The blank of a bevel member: where a place on the flank lies in the (z_w, radius) plane.

With the pitch apex in the crossing point, cone distance r = R_m + (ξ - 1/2) b and height h above the pitch cone:

    z_w = r cos δ - h sin δ,   r_w = r sin δ + h cos δ                                         (8.1)
    h_a(r) = h_am + (r - R_m) tan(δ_a - δ),   h_f(r) = h_fm + (r - R_m) tan(δ - δ_f)           (8.2)
    h = (1 - η) (c - h_f) + η h_a                                                              (8.3)

so that η counts the working depth, from the lower limit (the clearance above the root cone) to the face cone.
"""

from __future__ import annotations

from functools import cache

import sympy as sp

from derivations import notation as q
from derivations.expression import Expression
from derivations.proof import is_zero


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
