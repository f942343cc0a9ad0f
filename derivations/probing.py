"""Chapter 15. Probing: where the tip of a stylus must stand to touch a flank, and what a touch says.

The centre of a tip of radius r that touches the flank in R, or keeps a distance s from it along the outward normal n:

    C = R + (r + s) n                                                                          (15.1)

The stylus stands in the tool spindle and looks down. It enters the tooth space square to the root cone, B = Γ_f, with
the middle of the space, between R and the opposite flank's R' of the same z_w and radius, turned to the top:

    A = atan2(y + y', x + x')                                                                  (15.2)

With H the height of the tip over the B axis at Z = 0 and o the centre of the tip off the spindle axis and off H:

    (X, Y, Z) = M(B) (Rz(-A) C + e) - o + (0, 0, H)                                            (15.3)
    C = Rz(A) (M(B)' ((X, Y, Z) - (0, 0, H) + o) - e)                                          (15.4)

A touch with the tip at C gives, along the nominal normal, the contact point C - r n and, by (6.1), the deviation

    P = C - r n,   δ = (C - R)·n - r                                                           (15.5)
"""

from __future__ import annotations

from functools import cache

import sympy as sp

from derivations import axes, deviation
from derivations import notation as q
from derivations.expression import Expression
from derivations.frames import Rz
from derivations.proof import is_zero


@cache
def probe_target() -> Expression:
    """(15.1) as an Expression."""
    return Expression(
        "probe_target",
        "Centre of a stylus tip at a distance from a flank point, along its outward normal (15.1).",
        (q.point_w, q.normal_w, q.tip_radius, q.standoff),
        ((q.tip_center, q.point_w.symbol + (q.tip_radius.symbol + q.standoff.symbol) * q.normal_w.symbol),),
        source="the offset surface R ± n r_m of the source text, with a unit normal that knows its side",
    )


@cache
def space_azimuth() -> Expression:
    """(15.2) as an Expression."""
    x, y, _ = q.point_w.symbol + q.opposite_w.symbol
    return Expression(
        "space_azimuth",
        "Position of the work axis that turns the middle of a tooth space to the top (15.2).",
        (q.point_w, q.opposite_w),
        ((q.A, sp.atan2(y, x)),),
        requires=(x**2 + y**2 - 1,),
        source="(5.4): what has the azimuth A in the work lies in the plane of X and Z",
    )


def _height() -> sp.Matrix:
    return sp.Matrix([0, 0, q.probe_height.symbol])


@cache
def probe_axes() -> Expression:
    """(15.3) as an Expression."""
    work = Rz(-q.A.symbol) * q.tip_center.symbol + q.pivot_offset.symbol
    position = axes.swivel(q.B.symbol) * work - q.tip_offset.symbol + _height()
    return Expression(
        "probe_axes",
        "Axis positions that put the tip of the stylus at a place of the work (15.3).",
        (q.tip_center, q.A, q.B, q.probe_height, q.tip_offset, q.pivot_offset),
        ((q.axes, sp.Matrix([*position, q.A.symbol, q.B.symbol])),),
        source="(5.4) with the stylus in the place of the cutter",
    )


@cache
def probe_tip() -> Expression:
    """(15.4) as an Expression."""
    machine = sp.Matrix([q.X.symbol, q.Y.symbol, q.Z.symbol]) - _height() + q.tip_offset.symbol
    work = axes.swivel(q.B.symbol).T * machine - q.pivot_offset.symbol
    return Expression(
        "probe_tip",
        "Centre of the tip, and direction of the stylus from tip to spindle, out of the axis positions (15.4).",
        (q.axes, q.probe_height, q.tip_offset, q.pivot_offset),
        (
            (q.tip_center, Rz(q.A.symbol) * work),
            (q.stylus_w, axes.machine_to_work(sp.Matrix([0, 0, 1]))),
        ),
        source="(15.3) inverted",
    )


@cache
def touched_point() -> Expression:
    """(15.5) as an Expression."""
    return Expression(
        "touched_point",
        "Corrected contact point and deviation of a touch, along the nominal normal (15.5).",
        (q.tip_center, q.tip_radius, q.point_w, q.normal_w),
        (
            (q.contact_point, q.tip_center.symbol - q.tip_radius.symbol * q.normal_w.symbol),
            (q.deviation, deviation.point_deviation()["deviation"]),
        ),
        source="(6.1) and (15.1)",
    )


def prove_tip_of_the_positions_is_where_it_was_wanted() -> None:
    """(15.3, 15.4) Forward after inverse is the identity, whatever A, B, the offsets and the height."""
    position = probe_axes()["axes"]
    values = dict(zip(q.axes.symbols, position, strict=True))
    assert is_zero(sp.Matrix(probe_tip()["tip_center"]).subs(values, simultaneous=True) - q.tip_center.symbol)


def prove_stylus_without_offset_is_the_cutter_centre() -> None:
    """(15.4) Limit case o = 0: the tip is where the centre of a cutter of the same length is (5.4)."""
    values = {**dict.fromkeys(q.tip_offset.symbols, 0), q.probe_height.symbol: q.pivot_height.symbol}
    assert is_zero(sp.Matrix(probe_tip()["tip_center"]).subs(values) - axes.cutter_center())


def prove_stylus_stands_square_to_the_root_cone() -> None:
    """(15.2) At B = Γ_f the stylus is at right angles to the line of the root cone at azimuth A, and to its circle."""
    A, B = q.A.symbol, q.B.symbol
    stylus = sp.Matrix(probe_tip()["stylus_w"])
    line = sp.Matrix([sp.sin(B) * sp.cos(A), sp.sin(B) * sp.sin(A), sp.cos(B)])
    circle = sp.Matrix([-sp.sin(A), sp.cos(A), 0])
    assert is_zero(sp.Matrix([stylus.dot(line), stylus.dot(circle), stylus.dot(stylus) - 1]))
    outward = sp.Matrix([sp.cos(A), sp.sin(A), 0])
    assert is_zero(sp.Matrix([stylus.dot(outward) - sp.cos(B)]))


def prove_middle_of_the_space_is_on_top() -> None:
    """(15.2) Two points of one radius at azimuths A ± ε lie at opposite Y, so that their middle lies at Y = 0."""
    A, eps, rho, z = sp.symbols("A eps rho z", real=True)
    low, high = (sp.Matrix([rho * sp.cos(A + sign * eps), rho * sp.sin(A + sign * eps), z]) for sign in (-1, 1))
    y = [(axes.swivel(q.B.symbol) * (Rz(-A) * point))[1] for point in (low, high)]
    assert is_zero(y[0] + y[1])
    total = low + high
    assert is_zero(total[1] * sp.cos(A) - total[0] * sp.sin(A))
    assert is_zero(total[0] * sp.cos(A) + total[1] * sp.sin(A) - 2 * rho * sp.cos(eps))


def prove_touching_tip_has_its_point_back() -> None:
    """(15.1, 15.5) A tip at the distance s gives the point R + s n and the deviation s, for unit normals."""
    n, s = q.normal_w.symbol, q.standoff.symbol
    at = dict(zip(q.tip_center.symbols, probe_target()["tip_center"], strict=True))
    point = sp.Matrix(touched_point()["contact_point"]).subs(at, simultaneous=True)
    assert is_zero(point - (q.point_w.symbol + s * n))
    length = sum(component**2 for component in n)
    rest = touched_point()["deviation"].subs(at, simultaneous=True) - s
    assert sp.expand(rest - (q.tip_radius.symbol + s) * (length - 1)) == 0
