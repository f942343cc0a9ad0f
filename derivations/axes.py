"""Chapter 5. The vertical 5-axis machine: axis positions from the cradle machine, and back.

With k_s = V_c, j_s = V_c × V_p / |V_c × V_p|, i_s = j_s × k_s and φ the angle between V_c and V_p:

    X = -V_ls·i_s    Y = V_ls·j_s    Z = -V_ls·k_s + R_d + C_t                                 (5.1)
    A = -φ_w - dA,   dA = atan2(V_c·j, V_c·(V_p × j))                                          (5.2)
    B = Γ + dB,      dB = π/2 - φ - Γ                                                          (5.3)

Forward, for a machine point p_m (tool downwards along Z) and the same point in the work:

    p_m = M(B) Rz(-A) p_w,   columns of M(B): (-sin B, 0, cos B), (0, 1, 0), (-cos B, 0, -sin B)   (5.4)

The pitch apex lies on the B axis. V_c ∥ V_p is singular: A is then undefined, and the pose must be refused.
"""

from __future__ import annotations

from functools import cache

import sympy as sp

from derivations import cradle
from derivations import notation as q
from derivations.expression import Expression
from derivations.frames import J, Rz
from derivations.proof import is_zero

#: |V_c × V_p| below which a pose counts as singular.
SINGULAR_SINE = sp.Rational(1, 20)


def axis_cross() -> sp.Matrix:
    """V_c × V_p; its length is sin φ."""
    return cradle.cutter_axis().cross(cradle.work_axis())


def _norm(vector: sp.Matrix) -> sp.Expr:
    return sp.sqrt(sum(component**2 for component in vector))


def positions() -> sp.Matrix:
    """X, Y, Z, A, B (5.1-5.3). φ is taken from atan2(|V_c × V_p|, V_c · V_p), exact also where acos is not."""
    V_c, V_p, V_ls = cradle.cutter_axis(), cradle.work_axis(), cradle.apex_to_cutter()
    sine = _norm(axis_cross())
    j_s = axis_cross() / sine
    i_s = j_s.cross(V_c)
    phi = sp.atan2(sine, V_c.dot(V_p))
    dA = sp.atan2(V_c.dot(J), V_c.dot(V_p.cross(sp.Matrix(J))))
    return sp.Matrix([
        -V_ls.dot(i_s),
        V_ls.dot(j_s),
        -V_ls.dot(V_c) + q.pivot_height.symbol,
        -cradle.work_angle() - dA,
        sp.pi / 2 - phi,
    ])  # fmt: skip


def swivel(B: sp.Expr) -> sp.Matrix:
    """M(B) (5.4)."""
    return sp.Matrix([[-sp.sin(B), 0, -sp.cos(B)], [0, 1, 0], [sp.cos(B), 0, -sp.sin(B)]])


def machine_to_work(vector: sp.Matrix) -> sp.Matrix:
    """A direction, or a point taken from the B axis, of the vertical machine in the work: (5.4) inverted."""
    return Rz(q.A.symbol) * (swivel(q.B.symbol).T * vector)


def cutter_center() -> sp.Matrix:
    """Cutter centre in the work frame, out of the axis positions."""
    return machine_to_work(sp.Matrix([q.X.symbol, q.Y.symbol, q.Z.symbol - q.pivot_height.symbol]))


def cutter_axis() -> sp.Matrix:
    """Cutter axis towards the work, in the work frame: the tool points down."""
    return machine_to_work(sp.Matrix([0, 0, -1]))


@cache
def axis_transform() -> Expression:
    """Cradle machine to vertical machine as an Expression."""
    return Expression(
        "axis_transform",
        "Axis positions of the vertical machine that put the cutter where the cradle machine has it (5.1-5.3).",
        (q.settings, q.theta, q.pivot_height),
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
        (q.axes, q.pivot_height),
        ((q.cutter_center_w, cutter_center()), (q.cutter_axis_w, cutter_axis())),
        source="inverse of the rotation p_m = M(B) Rz(-A) p_w",
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


def prove_angles_describe_the_cutter_axis() -> None:
    """(5.2) V_c·(V_p × j) and V_c·j are minus the x and the y component of V_c in frame W: so dA is its azimuth."""
    V_c = sp.Matrix(sp.symbols("c_i c_j c_k", real=True))
    in_w = cradle.frame_w() * V_c
    assert is_zero(in_w[0] + V_c.dot(cradle.work_axis().cross(sp.Matrix(J))))
    assert is_zero(in_w[1] - V_c.dot(J))
    assert is_zero(in_w[2] - V_c.dot(cradle.work_axis()))


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


def prove_untilted_cutter_keeps_b_at_the_root_angle() -> None:
    """Limit case: without tilt dA = 0, B = Γ and the centre moves in X, Y as the cradle does in its plane."""
    values = {q.cutter_tilt.symbol: 0, q.cutter_swivel.symbol: 0}
    V_c, V_p = cradle.cutter_axis().subs(values), cradle.work_axis()
    cross = V_c.cross(V_p)
    gamma = q.machine_root_angle.symbol
    assert is_zero(cross - sp.Matrix([0, sp.cos(gamma), 0]))
    assert is_zero(V_c.dot(V_p) - sp.sin(gamma))
    assert is_zero(V_c.dot(J))
