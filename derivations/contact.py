"""Chapter 25. Contact of a pair: where two flanks touch, at any assembly, and how the gear follows the pinion.

The pair frame has the pinion's axis along Z and the gear's axis at Σ' = Σ + ΔΣ from it, in the plane Z-X where the
offset is none; Y = Z × X. Both axes point from the apex to the back. A member's pitch apex lies t_z beyond the crossing
point; the pinion is withdrawn by H, the gear by J, and the gear's axis is shifted by the offset a and its deviation V:

    r_1 = Rz(φ_1) (R - t_z k) + H k,                        n_1 = Rz(φ_1) n                       (25.1)
    r_2 = M [Rz(φ_2) (R - t_z k) + J k] + (a + V) j,        n_2 = M Rz(φ_2) n                     (25.2)
    M = [cos Σ', 0, -sin Σ' | 0, 1, 0 | sin Σ', 0, cos Σ'] by columns

    Y (out of the page: Z × X)
    ┼─── gear axis, J ──► X        V > 0 lifts the gear's axis towards the reader
    │
    ▼ Z  pinion axis, H

Flanks touch within both where point and normal agree, besides the equation of meshing f = 0 of either:

    r_1 = r_2,   n_1·(n_2 × r_2) = 0,   n_1·(n_2 × (n_2 × r_2)) = 0,   f_1 = f_2 = 0              (25.3)

seven equations for (u, β, θ)_1, (u, β, θ)_2, φ_2 at a given φ_1. A flank ends at borders, lines of the axial plane, or
of the blade, inside which b > 0; the edge that a border makes has the direction e:

    b = c_u u + c_z z_w + c_r r_w + c_0,    e = n × (c_z k + c_r [x, y, 0]/r_w)                   (25.4)

An edge touches the mate where b = 0 and e·n' = 0 take the place of the normals in (25.3). A corner, or two edges that
cross, touch where two borders have b = 0                                                         (25.5)

Below the border u = const. at which the main section of the blade ends, its rounded edge cuts the fillet (10.3). Both
touch there, so point and normal are the same: an edge that runs over this border goes on without a step. The mate's
flank does not fit into the narrower fillet; its edges do.

As φ_1 grows, points in contact move with equal speed along the common normal. With ρ_2 the lever of the gear:

    ρ_2 = n_2·(z × (r - o)),   dφ_2/dφ_1 = n_2·(k × r)/ρ_2,    z = M k,  o = (a + V) j           (25.6)

A gear point meets the pinion at the constant ratio i = z_1/z_2 where that is -i. With P = R + (J - t_z) k, m = P × n
and c = a + V, p = sin Σ' m + c cos Σ' n, the gear then stands at

    φ_2 = -atan2(p_y, p_x) ± acos(((cos Σ' + i) m_z - c sin Σ' n_z)/√(p_x² + p_y²))               (25.7)

which is (20.5) where c = 0. The transmission error is φ_2 + i φ_1, less its value at φ_1 = 0.
"""

from __future__ import annotations

from functools import cache

import mpmath
import sympy as sp

from derivations import notation as q
from derivations.compensation import conjugate_place
from derivations.expression import Expression
from derivations.frames import J, K, Rz
from derivations.proof import DIGITS, is_close, is_zero, numbers


def gear_axes() -> sp.Matrix:
    """M (25.2): the axes of the gear as columns."""
    sigma = q.shaft_angle.symbol + q.assembly.symbol[3]
    return sp.Matrix([[sp.cos(sigma), 0, sp.sin(sigma)], [0, 1, 0], [-sp.sin(sigma), 0, sp.cos(sigma)]])


def gear_origin() -> sp.Matrix:
    """o (25.6): a point of the gear's axis."""
    return (q.hypoid_offset.symbol + q.assembly.symbol[0]) * sp.Matrix(J)


def _from_crossing() -> sp.Matrix:
    return sp.Matrix(q.point_w.symbol) - q.apex_beyond.symbol * sp.Matrix(K)


@cache
def pinion_in_pair() -> Expression:
    """(25.1) as an Expression."""
    turn = Rz(q.pinion_rotation.symbol)
    return Expression(
        "pinion_in_pair",
        "Point and outward normal of the pinion in the frame of the pair (25.1).",
        (q.point_w, q.normal_w, q.pinion_rotation, q.apex_beyond, q.assembly),
        (
            (q.pinion_point, turn * _from_crossing() + q.assembly.symbol[1] * sp.Matrix(K)),
            (q.pinion_normal, turn * sp.Matrix(q.normal_w.symbol)),
        ),
        source="assembly of a pair: V, H, J and shaft angle as REXS names them",
    )


@cache
def gear_in_pair() -> Expression:
    """(25.2) as an Expression."""
    turn = Rz(q.gear_rotation.symbol)
    in_gear = turn * _from_crossing() + q.assembly.symbol[2] * sp.Matrix(K)
    return Expression(
        "gear_in_pair",
        "Point and outward normal of the gear in the frame of the pair (25.2).",
        (
            q.point_w,
            q.normal_w,
            q.gear_rotation,
            q.apex_beyond,
            q.shaft_angle,
            q.hypoid_offset,
            q.assembly,
        ),
        (
            (q.gear_point, gear_axes() * in_gear + gear_origin()),
            (q.gear_normal, gear_axes() * turn * sp.Matrix(q.normal_w.symbol)),
        ),
        source="assembly of a pair: V, H, J and shaft angle as REXS names them",
    )


@cache
def alignment() -> Expression:
    """The two conditions on the normals of (25.3) as an Expression."""
    r, n_1, n_2 = (sp.Matrix(one.symbol) for one in (q.gear_point, q.pinion_normal, q.gear_normal))
    across = n_2.cross(r)
    return Expression(
        "alignment",
        "Parts of the pinion's normal in the tangent plane of the gear, zero in contact (25.3).",
        (q.gear_point, q.gear_normal, q.pinion_normal),
        ((q.alignment, sp.Matrix([n_1.dot(across), n_1.dot(n_2.cross(across))])),),
        source="two surfaces in contact have one tangent plane",
    )


@cache
def flank_border() -> Expression:
    """(25.4) as an Expression."""
    R, n = sp.Matrix(q.point_w.symbol), sp.Matrix(q.normal_w.symbol)
    c_u, c_z, c_r, c_0 = q.border.symbol
    radius = sp.sqrt(R[0] ** 2 + R[1] ** 2)
    across = c_z * sp.Matrix(K) + c_r * sp.Matrix([R[0] / radius, R[1] / radius, 0])
    return Expression(
        "flank_border",
        "Distance of a point from a border of its flank, and the direction of the edge there (25.4).",
        (q.u, q.point_w, q.normal_w, q.border),
        ((q.border_distance, c_u * q.u.symbol + c_z * R[2] + c_r * radius + c_0), (q.edge_tangent, n.cross(across))),
        requires=(R[0] ** 2 + R[1] ** 2 - 1,),
        source="intersection of a flank with a cone about its axis",
    )


@cache
def tangency() -> Expression:
    """e·n' of (25.5) as an Expression."""
    e, n = sp.Matrix(q.edge_tangent.symbol), sp.Matrix(q.mate_normal.symbol)
    return Expression(
        "tangency",
        "Part of the direction of an edge along the mate's normal, zero where the edge touches (25.5).",
        (q.edge_tangent, q.mate_normal),
        ((q.tangency, e.dot(n)),),
        source="a curve in contact with a surface lies in its tangent plane",
    )


@cache
def transmission() -> Expression:
    """(25.6) as an Expression."""
    r, n = sp.Matrix(q.gear_point.symbol), sp.Matrix(q.gear_normal.symbol)
    axis = gear_axes()[:, 2]
    rho = n.dot(axis.cross(r - gear_origin()))
    return Expression(
        "transmission",
        "Lever of the gear, and its rotation per rotation of the pinion, at a contact (25.6).",
        (q.gear_point, q.gear_normal, q.shaft_angle, q.hypoid_offset, q.assembly),
        ((q.lever, rho), (q.transmission_slope, n.dot(sp.Matrix(K).cross(r)) / rho)),
        requires=(rho**2 - 1,),
        source="equal speeds along the common normal",
    )


@cache
def meeting() -> Expression:
    """(25.7) as an Expression; ``side`` takes the branch."""
    n, i = sp.Matrix(q.normal_w.symbol), q.teeth_ratio.symbol
    sigma, c = q.shaft_angle.symbol + q.assembly.symbol[3], q.hypoid_offset.symbol + q.assembly.symbol[0]
    m = (_from_crossing() + q.assembly.symbol[2] * sp.Matrix(K)).cross(n)
    p = sp.sin(sigma) * m + c * sp.cos(sigma) * n
    needed = (sp.cos(sigma) + i) * m[2] - c * sp.sin(sigma) * n[2]
    across = sp.sqrt(p[0] ** 2 + p[1] ** 2)
    return Expression(
        "meeting",
        "Rotation of the gear at which a point of its flank meets the pinion at the constant ratio (25.7).",
        (
            q.point_w,
            q.normal_w,
            q.apex_beyond,
            q.shaft_angle,
            q.hypoid_offset,
            q.assembly,
            q.teeth_ratio,
            q.side,
        ),
        ((q.gear_rotation, q.side.symbol * sp.acos(needed / across) - sp.atan2(p[1], p[0])),),
        requires=(p[0] ** 2 + p[1] ** 2 - 1, sp.Rational(99, 100) * (p[0] ** 2 + p[1] ** 2) - needed**2),
        source="gear meshing of two fixed axes with a constant ratio, solved for the angle",
    )


_TRUE = dict.fromkeys((*q.assembly.symbols, q.hypoid_offset.symbol, q.apex_beyond.symbol), 0)


def prove_mean_points_meet_on_the_pitch_line() -> None:
    """(25.1, 25.2) Points of the pitch cones at equal cone distance, at azimuth 0 of the pinion and π of the gear."""
    delta_1, delta_2, distance = sp.symbols("delta_1 delta_2 R", positive=True)
    zero = dict.fromkeys((q.pinion_rotation.symbol, q.gear_rotation.symbol), 0)
    at = [
        dict(zip(q.point_w.symbols, (sign * distance * sp.sin(d), 0, distance * sp.cos(d)), strict=True))
        for sign, d in ((1, delta_1), (-1, delta_2))
    ]
    one = pinion_in_pair()["pinion_point"].subs(_TRUE | zero | at[0])
    other = gear_in_pair()["gear_point"].subs(_TRUE | zero | at[1]).subs(q.shaft_angle.symbol, delta_1 + delta_2)
    assert is_zero(one - other)


def prove_displacements_go_the_way_they_are_named() -> None:
    """(25.1, 25.2) At Σ = 90°: V along Y = Z × X, H along Z, J along X, and ΔΣ turns the gear's axis away from Z."""
    V, H, withdrawn, turn = q.assembly.symbols
    right = {q.shaft_angle.symbol: sp.pi / 2}
    gear = gear_in_pair()["gear_point"].subs(right)
    still = {turn: 0}
    assert gear.diff(V) == sp.Matrix([0, 1, 0])
    assert sp.simplify(gear.diff(withdrawn).subs(still)) == sp.Matrix([1, 0, 0])
    assert pinion_in_pair()["pinion_point"].diff(H) == sp.Matrix(K)
    assert gear_axes().subs(right)[:, 2].diff(turn).subs(still) == sp.Matrix([0, 0, -1])


def prove_parallel_axes_turn_as_their_base_circles() -> None:
    """(25.6) Σ = 0 with the offset as center distance: spur gears, whose line of action touches both base circles."""
    r_1, r_2, alpha, s = sp.symbols("r_1 r_2 alpha s", positive=True)
    n = sp.Matrix([sp.cos(alpha), sp.sin(alpha), 0])
    r = r_1 * sp.Matrix(J) + s * n  # through the pitch point, between the axes
    flat = dict(zip((*q.gear_point.symbols, *q.gear_normal.symbols), (*r, *n), strict=True))
    given = dict.fromkeys(q.assembly.symbols, 0) | {q.shaft_angle.symbol: 0, q.hypoid_offset.symbol: r_1 + r_2}
    slope = transmission()["transmission_slope"].subs(flat | given, simultaneous=True)
    assert is_zero(slope + r_1 / r_2)
    assert is_zero(transmission()["lever"].subs(flat | given, simultaneous=True) ** 2 - (r_2 * sp.cos(alpha)) ** 2)


def prove_gear_meets_the_pinion_at_the_constant_ratio() -> None:
    """(25.7) Turned by φ_2, the slope (25.6) is -i: with offset, J, t_z and a changed shaft angle, on both branches."""
    G, n = [-70, 8, 35], [sp.Rational(1, 4), -sp.Rational(7, 8), sp.Rational(3, 8)]
    place = [sp.Rational(1, 2), sp.Rational(3, 2), 20, sp.Rational(1, 4), sp.Rational(1, 8), sp.Rational(3, 4)]
    apex, sigma, offset, *moves = [*place, sp.Rational(1, 64)]
    i = sp.Rational(1, 3)
    for branch in (1, -1):
        with mpmath.workdps(DIGITS):
            values = numbers([*G, *n, apex, sigma, offset, *moves, i])
            (angle,) = meeting().function(*values, branch)
            turned = gear_in_pair().function(*values[:6], angle, *values[6:13])
            _, slope = transmission().function(*turned, *values[7:13])
            assert is_close([slope + values[13]], [0])


def prove_meeting_is_that_of_chapter_20_without_offset() -> None:
    """(25.7) At V = 0 it is (20.5), half a turn on: that has the mate's axis on the other side."""
    G, n = [30, 8, 75], [sp.Rational(1, 4), -sp.Rational(7, 8), sp.Rational(3, 8)]
    sigma, ratio = sp.Rational(3, 2), sp.Rational(3, 2)
    for branch in (1, -1):
        with mpmath.workdps(DIGITS):
            values = numbers([*G, *n, sigma, ratio])
            psi = conjugate_place().function(*values, branch)[0]
            (angle,) = meeting().function(*values[:6], 0, values[6], 0, 0, 0, 0, 0, values[7], -branch)
            turn = (angle - psi - mpmath.pi) / (2 * mpmath.pi)
            assert is_close([turn], [mpmath.nint(turn)])


def prove_edge_lies_in_its_flank_and_on_its_border() -> None:
    """(25.4) e is square to n, and b does not change along it."""
    R, n, e = sp.Matrix(q.point_w.symbol), sp.Matrix(q.normal_w.symbol), flank_border()["edge_tangent"]
    gradient = sp.Matrix([flank_border()["border_distance"].diff(x) for x in R])
    assert is_zero(n.dot(e))
    assert is_zero(gradient.dot(e))


def prove_normals_are_parallel_where_the_alignment_is_zero() -> None:
    """(25.3) n_2 × r and n_2 × (n_2 × r) are square to n_2 and to each other: a basis of the tangent plane."""
    r, n = sp.Matrix(q.gear_point.symbol), sp.Matrix(q.gear_normal.symbol)
    rows = sp.Matrix([value.diff(x) for value in alignment()["alignment"] for x in q.pinion_normal.symbols])
    one, other = sp.Matrix(rows[:3]), sp.Matrix(rows[3:])
    assert is_zero(sp.Matrix([n.dot(one), n.dot(other), one.dot(other)]))
    assert is_zero(one - n.cross(r))
