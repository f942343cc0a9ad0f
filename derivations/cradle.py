"""Chapter 2. The cradle machine: where cutter and work stand at a cradle rotation θ.

Machine frame s: origin machine centre, k the cradle axis from the cutter head towards the work, i-j the machine plane.

    V_p  = [cos Γ, 0, sin Γ]                                                   work axis      (2.1)
    V_c  = T k,   T = Rz(q + θ) Rz(j) Rx(i)                                    cutter axis    (2.2)
    V_ls = V_p X_p - k X_b + j E_m + S [cos(q+θ), sin(q+θ), 0]                 apex → cutter  (2.3)
    φ_w  = φ_0 + R_a θ                                                         work angle     (2.4)
    r_w  = Rz(-φ_w) W r_s,   rows of W: [sin Γ, 0, -cos Γ], j, V_p             into the work  (2.5)

(2.5) turns a machine point, taken from the pitch apex, by -φ_w about V_p into the work frame w. A machine summary that
counts from the crossing point, which the pitch apex lies t_z beyond, means

    X_p = X_C + t_z                                                            from apex      (2.6)
"""

from __future__ import annotations

from functools import cache

import sympy as sp

from derivations import notation as q
from derivations.expression import Expression
from derivations.frames import J, K, Rx, Rz, rotation


def work_axis() -> sp.Matrix:
    """V_p (2.1)."""
    gamma = q.machine_root_angle.symbol
    return sp.Matrix([sp.cos(gamma), 0, sp.sin(gamma)])


def cutter_to_machine(vector: sp.Matrix) -> sp.Matrix:
    """T times a vector of the cutter frame (2.2); the two rotations about k are one."""
    about_k = q.cradle_angle.symbol + q.theta.symbol + q.cutter_swivel.symbol
    return Rz(about_k) * (Rx(q.cutter_tilt.symbol) * vector)


def machine_to_cutter(vector: sp.Matrix) -> sp.Matrix:
    """The transpose of T times a vector of the machine frame."""
    about_k = q.cradle_angle.symbol + q.theta.symbol + q.cutter_swivel.symbol
    return Rx(-q.cutter_tilt.symbol) * (Rz(-about_k) * vector)


def cutter_axis() -> sp.Matrix:
    """V_c (2.2)."""
    return cutter_to_machine(sp.Matrix(K))


def radial_vector() -> sp.Matrix:
    """Machine centre to cutter centre in the machine plane, the last term of (2.3)."""
    angle = q.cradle_angle.symbol + q.theta.symbol
    return q.radial_distance.symbol * sp.Matrix([sp.cos(angle), sp.sin(angle), 0])


def apex_to_cutter() -> sp.Matrix:
    """V_ls (2.3)."""
    return (
        work_axis() * q.machine_center_to_crossing_point.symbol
        - sp.Matrix(K) * q.sliding_base.symbol
        + sp.Matrix(J) * q.blank_offset.symbol
        + radial_vector()
    )


def work_angle() -> sp.Expr:
    """φ_w (2.4)."""
    return q.work_rotation_offset.symbol + q.ratio_of_roll.symbol * q.theta.symbol


def frame_w() -> sp.Matrix:
    """W: the rows are the axes of the work frame at φ_w = 0, in machine axes (2.5)."""
    gamma = q.machine_root_angle.symbol
    return sp.Matrix([[sp.sin(gamma), 0, -sp.cos(gamma)], list(J), list(work_axis())])


def machine_to_work(vector: sp.Matrix) -> sp.Matrix:
    """A direction, or a point taken from the apex, of the machine frame in the work frame (2.5)."""
    return Rz(-work_angle()) * (frame_w() * vector)


@cache
def cradle_pose() -> Expression:
    """Axes, centre and work angle of the cradle machine as an Expression."""
    return Expression(
        "cradle_pose",
        "Cutter axis, work axis, apex-to-cutter vector and work angle of the cradle machine (2.1-2.4).",
        (q.settings, q.theta),
        (
            (q.V_c, cutter_axis()),
            (q.V_p, work_axis()),
            (q.V_ls, apex_to_cutter()),
            (q.work_angle, work_angle()),
        ),
        source="Coordinate Control Method for Full CNC Vertical Spiral Bevel Gear Milling Machine, active signs",
    )


@cache
def advance_from_apex() -> Expression:
    """(2.6) as an Expression."""
    return Expression(
        "advance_from_apex",
        "Machine centre to the pitch apex out of that to the crossing point (2.6).",
        (q.advance_from_crossing_point, q.pitch_apex_beyond_crossing_point),
        (
            (
                q.machine_center_to_crossing_point,
                q.advance_from_crossing_point.symbol + q.pitch_apex_beyond_crossing_point.symbol,
            ),
        ),
        source="ISO 23509: t_z positive where the apex lies beyond the crossing point, seen from the teeth",
    )


def prove_cutter_stands_where_it_stood_from_the_crossing_point() -> None:
    """(2.6) Crossing point at C, apex at C - t_z V_p: the cutter stands at one place, seen from either."""
    X_C, t_z = q.advance_from_crossing_point.symbol, q.pitch_apex_beyond_crossing_point.symbol
    advance = q.machine_center_to_crossing_point.symbol
    cutter_from_crossing_point = apex_to_cutter().subs(advance, X_C)
    apex_from_crossing_point = -t_z * work_axis()
    X_p = advance_from_apex()["machine_center_to_crossing_point"]
    difference = cutter_from_crossing_point - apex_from_crossing_point - apex_to_cutter().subs(advance, X_p)
    assert sp.simplify(difference) == sp.zeros(3, 1)


def prove_turning_into_the_work_is_a_rotation_about_its_axis() -> None:
    """(2.5) equals Rodrigues' rotation by -φ_w about V_p, written in the axes of frame w."""
    phi, r = sp.Symbol("phi", real=True), sp.Matrix(sp.symbols("x y z", real=True))
    through_rodrigues = frame_w() * rotation(work_axis(), -phi) * r
    assert sp.simplify(Rz(-phi) * frame_w() * r - through_rodrigues) == sp.zeros(3, 1)


def prove_frames_are_right_handed() -> None:
    """W and T are proper rotations: orthonormal with determinant one."""
    T = sp.Matrix.hstack(*(cutter_to_machine(sp.eye(3)[:, k]) for k in range(3)))
    for matrix in (frame_w(), T):
        assert sp.simplify(matrix * matrix.T) == sp.eye(3)
        assert sp.simplify(matrix.det()) == 1


def prove_cutter_frame_and_its_inverse_agree() -> None:
    """Machine to cutter undoes cutter to machine."""
    r = sp.Matrix(sp.symbols("x y z", real=True))
    assert sp.simplify(machine_to_cutter(cutter_to_machine(r)) - r) == sp.zeros(3, 1)


def prove_cradle_turns_cutter_centre_and_axis_alike() -> None:
    """(2.2, 2.3) The cradle rotation turns radial vector and cutter axis about k as one rigid body."""
    theta = q.theta.symbol
    for vector in (radial_vector(), cutter_axis()):
        assert sp.simplify(vector - Rz(theta) * vector.subs(theta, 0)) == sp.zeros(3, 1)
