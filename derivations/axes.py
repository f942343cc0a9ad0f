"""Chapter 5. The vertical 5-axis machine: axis positions from the cradle machine, and back.

With k_s = V_c, j_s = V_c × V_p / |V_c × V_p|, i_s = j_s × k_s and φ the angle between V_c and V_p:

    (X, Y, Z) = (-V_ls·i_s, V_ls·j_s, -V_ls·k_s + R_d + C_t) + M(B) e                          (5.1)
    A = -φ_w - dA,   dA = atan2(V_c·j, V_c·(V_p × j))                                          (5.2)
    B = Γ + dB,      dB = π/2 - φ - Γ                                                          (5.3)

Forward, for a machine point p_m (tool downwards along Z) and the same point in the work:

    p_m = M(B) (Rz(-A) p_w + e),   columns of M(B): (-sin B, 0, cos B), (0, 1, 0), (-cos B, 0, -sin B)   (5.4)

Z counts up. R_d is the reading of Z at which the gauge line of the spindle is level with the B axis, and C_t the length
of the tool from there: its tip is Z - R_d - C_t above the B axis. A gauge line 650 mm above it at Z = 0 is R_d = -650.
e leads from the B axis to the pitch apex, in the axes of the work at A = 0; the conventions' machine has e = 0.
V_c ∥ V_p is singular: A is then undefined, and the pose must be refused. Everywhere else two poses do the same,

    (X, Y, Z, A, B)   and, where e = 0,   (-X, -Y, Z, A + π, π - B)                            (5.5)

of which (5.3) is the one with |B| < π/2. A point of the work as the tool sees it, which moves with X Y Z only:

    r = M(B) (Rz(-A) p_w + e) - (X, Y, Z - R_d - C_t)                                          (5.6)

Settings that move with the cradle (10.1) enter all of these with their values at θ (5.7). Where the cutter's own phase
matters, in face hobbing, the sixth axis stands at C = β + ψ, right-handed about the downward tool axis:

    ψ = atan2(T i·j_s, T i·i_s)                                                                (5.8)
"""

from __future__ import annotations

from functools import cache

import mpmath
import sympy as sp

from derivations import cradle, generation
from derivations import notation as q
from derivations.expression import Expression
from derivations.frames import I, J, Rz
from derivations.proof import DIGITS, is_close, is_zero

SINGULAR_SINE = sp.Rational(q.SINGULAR_SINE)


def axis_cross() -> sp.Matrix:
    """V_c × V_p; its length is sin φ."""
    return cradle.cutter_axis().cross(cradle.work_axis())


def _norm(vector: sp.Matrix) -> sp.Expr:
    return sp.sqrt(sum(component**2 for component in vector))


def _across() -> tuple[sp.Matrix, sp.Matrix]:
    """i_s and j_s."""
    j_s = axis_cross() / _norm(axis_cross())
    return j_s.cross(cradle.cutter_axis()), j_s


def positions() -> sp.Matrix:
    """X, Y, Z, A, B (5.1-5.3). φ is taken from atan2(|V_c × V_p|, V_c · V_p), exact also where acos is not.

    M(B) stands with sin B = cos φ = V_c · V_p and cos B = sin φ = |V_c × V_p|.
    """
    V_c, V_p, V_ls = cradle.cutter_axis(), cradle.work_axis(), cradle.apex_to_cutter()
    sine, cosine = _norm(axis_cross()), V_c.dot(V_p)
    i_s, j_s = _across()
    dA = sp.atan2(V_c.dot(J), V_c.dot(V_p.cross(sp.Matrix(J))))
    offset = _swivel(cosine, sine) * q.pivot_offset.symbol
    return sp.Matrix(
        [
            -V_ls.dot(i_s) + offset[0],
            V_ls.dot(j_s) + offset[1],
            -V_ls.dot(V_c) + q.pivot_height.symbol + offset[2],
            -cradle.work_angle() - dA,
            sp.pi / 2 - sp.atan2(sine, cosine),
        ]
    )


def _swivel(sine: sp.Expr, cosine: sp.Expr) -> sp.Matrix:
    return sp.Matrix([[-sine, 0, -cosine], [0, 1, 0], [cosine, 0, -sine]])


def swivel(B: sp.Expr) -> sp.Matrix:
    """M(B) (5.4)."""
    return _swivel(sp.sin(B), sp.cos(B))


def machine_to_work(vector: sp.Matrix) -> sp.Matrix:
    """A direction of the vertical machine in the work: the rotations of (5.4) inverted."""
    return Rz(q.A.symbol) * (swivel(q.B.symbol).T * vector)


def _tool_point() -> sp.Matrix:
    """The cutter centre from the B axis, in the axes of the machine."""
    return sp.Matrix([q.X.symbol, q.Y.symbol, q.Z.symbol - q.pivot_height.symbol])


def cutter_center() -> sp.Matrix:
    """Cutter centre in the work frame, out of the axis positions."""
    return Rz(q.A.symbol) * (swivel(q.B.symbol).T * _tool_point() - q.pivot_offset.symbol)


def cutter_axis() -> sp.Matrix:
    """Cutter axis towards the work, in the work frame: the tool points down."""
    return machine_to_work(sp.Matrix([0, 0, -1]))


@cache
def axis_transform() -> Expression:
    """Cradle machine to vertical machine as an Expression."""
    return Expression(
        "axis_transform",
        "Axis positions of the vertical machine that put the cutter where the cradle machine has it (5.1-5.3).",
        (q.settings, q.theta, q.pivot_height, q.pivot_offset),
        ((q.axes, positions()),),
        requires=(_norm(axis_cross()) - SINGULAR_SINE,),
        source="Coordinate Control Method for Full CNC Vertical Spiral Bevel Gear Milling Machine, with atan2",
    )


@cache
def tool_pose() -> Expression:
    """Forward kinematics as an Expression."""
    return Expression(
        "tool_pose",
        "Cutter centre and axis in the work frame, out of the axis positions of the vertical machine (5.4).",
        (q.axes, q.pivot_height, q.pivot_offset),
        ((q.cutter_center_w, cutter_center()), (q.cutter_axis_w, cutter_axis())),
        source="inverse of p_m = M(B) (Rz(-A) p_w + e)",
    )


@cache
def seen_from_tool() -> Expression:
    """(5.6) as an Expression: its way is what the feed at the tooth is measured along."""
    p_m = swivel(q.B.symbol) * (Rz(-q.A.symbol) * q.point_w.symbol + q.pivot_offset.symbol)
    return Expression(
        "seen_from_tool",
        "A point of the work from the cutter centre, in the axes of the machine (5.6).",
        (q.axes, q.point_w, q.pivot_height, q.pivot_offset),
        ((q.point_m, p_m - _tool_point()),),
        source="(5.4) less the cutter centre",
    )


@cache
def moved_settings() -> Expression:
    """(5.7) as an Expression."""
    moving = generation.moving_settings()
    return Expression(
        "moved_settings",
        "Settings as they stand at a cradle rotation when they move with it (5.7).",
        (q.settings, q.motion, q.theta),
        ((q.settings_at, sp.Matrix([moving.get(symbol, symbol) for symbol in q.settings.symbols])),),
        source="(10.1)",
    )


@cache
def cutter_phase() -> Expression:
    """(5.8) as an Expression."""
    i_s, j_s = _across()
    Ti = cradle.cutter_to_machine(sp.Matrix(I))
    return Expression(
        "cutter_phase",
        "Position of the cutter's axis C at which the cutter angle beta is zero (5.8).",
        (q.settings, q.theta),
        ((q.psi, sp.atan2(Ti.dot(j_s), Ti.dot(i_s))),),
        requires=(_norm(axis_cross()) - SINGULAR_SINE,),
        source="the axis i of the cutter frame, in the frame i_s, j_s that the machine has about its tool axis",
    )


@cache
def cradle_tool_pose() -> Expression:
    """The same pose straight from the cradle machine, to compare with."""
    return Expression(
        "cradle_tool_pose",
        "Cutter centre and axis in the work frame, out of the cradle machine (2.2, 2.3, 2.5).",
        (q.settings, q.theta),
        (
            (q.cutter_center_w, cradle.machine_to_work(cradle.apex_to_cutter())),
            (q.cutter_axis_w, cradle.machine_to_work(cradle.cutter_axis())),
        ),
        source="chapter 2",
    )


def _directions() -> tuple[sp.Symbol, sp.Symbol, sp.Matrix]:
    """Any cutter axis not parallel to the work axis, in frame W: by φ and dA as (5.2) and (5.3) define them."""
    phi, dA = sp.symbols("phi dA", real=True)
    return phi, dA, sp.Matrix([-sp.sin(phi) * sp.cos(dA), sp.sin(phi) * sp.sin(dA), sp.cos(phi)])


def prove_positions_put_the_cutter_where_the_cradle_machine_has_it() -> None:
    """(5.1-5.4) With tilt, swivel, all offsets and e: centre and axis of the cutter in the work, by either machine.

    The forward transform (5.4) of the axis positions, against (2.2), (2.3) and (2.5), which know of no axes.
    """
    height, offset = mpmath.mpf("-0.75"), [mpmath.mpf(value) for value in ("0.5", "-0.25", "2")]
    for swing, tilt in ((1, "0.25"), (-1, "-0.125")):
        settings = [75, swing, tilt, "0.875", "3.5", "0.25", 1, "0.375", "3", "0.5", 80, "0.25"]
        settings = [mpmath.mpf(value) for value in settings]
        with mpmath.workdps(DIGITS):
            theta = mpmath.mpf("0.1875")
            positions = axis_transform().function(*settings, theta, height, *offset)
            found = tool_pose().function(*positions, height, *offset)
            assert is_close(found, cradle_tool_pose().function(*settings, theta))
            assert abs(positions[4]) < mpmath.pi / 2


def prove_both_machines_put_the_cutter_in_the_same_pose() -> None:
    """(5.1-5.4) M(B) Rz(-A) takes every point of the work to where the cradle machine has it, seen from the tool.

    With A = -φ_w - dA and (2.5), M(B) Rz(-A) Rz(-φ_w) W = M(B) Rz(dA) W. The claim is that its rows are -i_s, j_s and
    -k_s, for every φ with sin φ > 0 and every dA: then (5.1) are the machine coordinates of the cutter centre.
    """
    phi, dA, k_s = _directions()
    j_s = k_s.cross(sp.Matrix([0, 0, 1])) / sp.sin(phi)
    i_s = j_s.cross(k_s)
    rows = sp.Matrix.vstack(-i_s.T, j_s.T, -k_s.T)
    B = sp.pi / 2 - phi
    assert is_zero(swivel(B) * Rz(dA) - rows)
    assert is_zero(rows * rows.T - sp.eye(3))


def prove_forward_transform_inverts_the_swivel() -> None:
    """(5.4) M(B) is a rotation, so that its transpose leads back from the machine into the work."""
    B = q.B.symbol
    assert is_zero(swivel(B) * swivel(B).T - sp.eye(3))
    assert is_zero(swivel(B).det() - 1)


def prove_offset_positions_lead_back_to_the_cutter() -> None:
    """(5.1, 5.4) With e: the forward transform of X Y Z gives the centre that it gives without e at X Y Z - M(B) e.

    And M(B) of (5.1), written with sin B = cos φ and cos B = sin φ, is that of (5.3).
    """
    plain = cutter_center().subs(dict.fromkeys(q.pivot_offset.symbols, 0))
    shift = swivel(q.B.symbol) * q.pivot_offset.symbol
    shifted = {axis.symbol: axis.symbol + by for axis, by in zip((q.X, q.Y, q.Z), shift, strict=True)}
    assert is_zero(cutter_center().subs(shifted, simultaneous=True) - plain)
    phi = sp.Symbol("phi", real=True)
    assert is_zero(_swivel(sp.cos(phi), sp.sin(phi)) - swivel(sp.pi / 2 - phi))


def prove_the_other_branch_is_the_same_pose() -> None:
    """(5.5) With e = 0, (-X, -Y, Z, A + π, π - B) puts centre and axis of the cutter where (X, Y, Z, A, B) does."""
    X, Y, A, B = (axis.symbol for axis in (q.X, q.Y, q.A, q.B))
    other = {X: -X, Y: -Y, A: A + sp.pi, B: sp.pi - B}
    for vector in (cutter_center().subs(dict.fromkeys(q.pivot_offset.symbols, 0)), cutter_axis()):
        assert is_zero(vector.subs(other, simultaneous=True) - vector)


def prove_cutter_centre_is_the_origin_of_what_the_tool_sees() -> None:
    """(5.6) The tool sees its own centre (5.4) at zero, and a distance from it in the work as the same distance."""
    seen = seen_from_tool()["point_m"]
    at_centre = dict(zip(q.point_w.symbols, cutter_center(), strict=True))
    assert is_zero(seen.subs(at_centre, simultaneous=True))
    turned = seen.jacobian(q.point_w.symbols)
    assert is_zero(turned * turned.T - sp.eye(3))


def prove_sixth_axis_turns_the_cutter_into_its_frame() -> None:
    """(5.8) T i lies in the plane of i_s and j_s, so that ψ is its angle there; limit case: untilted, ψ = q + θ."""
    Ti, V_c = cradle.cutter_to_machine(sp.Matrix(I)), cradle.cutter_axis()
    assert is_zero(sp.Matrix([Ti.dot(V_c)]))
    gamma = q.machine_root_angle.symbol
    flat = {q.cutter_tilt.symbol: 0, q.cutter_swivel.symbol: 0}
    j_s = (V_c.cross(cradle.work_axis()) / sp.cos(gamma)).subs(flat)
    i_s = j_s.cross(V_c.subs(flat))
    about = q.cradle_angle.symbol + q.theta.symbol
    assert is_zero(sp.Matrix([Ti.subs(flat).dot(i_s) - sp.cos(about), Ti.subs(flat).dot(j_s) - sp.sin(about)]))


def prove_untilted_cutter_keeps_b_at_the_root_angle() -> None:
    """Limit case: without tilt dA = 0, B = Γ and the centre moves in X, Y as the cradle does in its plane."""
    values = {q.cutter_tilt.symbol: 0, q.cutter_swivel.symbol: 0}
    V_c, V_p = cradle.cutter_axis().subs(values), cradle.work_axis()
    cross = V_c.cross(V_p)
    gamma = q.machine_root_angle.symbol
    assert is_zero(cross - sp.Matrix([0, sp.cos(gamma), 0]))
    assert is_zero(V_c.dot(V_p) - sp.sin(gamma))
    assert is_zero(V_c.dot(J))
