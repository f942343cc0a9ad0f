"""Chapter 17. Face hobbing on six axes: the pose of every single blade, and what is left between its passes.

The sixth axis stands at C = β + ψ (5.8), so that a vector v of the cutter frame T, turned by β, is in the machine

    Q(C) v,   columns of Q(C): (-cos C, sin C, 0), (sin C, cos C, 0), (0, 0, -1)                (17.1)

and in the work Rz(A) M(B)' Q(C) v. With the centre c of (5.4), the edge (ρ, h)(u) of a blade with the offset angle η
of (10.4), which stands 2π g/N_b behind the first, sweeps

    R_e = c + Rz(A) M(B)' Q(C + 2π g/N_b) [r_p + (ρ - r_p) cos η, (ρ - r_p) sin η, -h]          (17.2)

ρ and h are linear in u on the straight parts of an edge, its tip among them, and (10.3) on the round ones. This is
the family (10.5) at the cutter angle β + 2π g/N_b, with the work 2π g ι/N_b = ±2π g/z behind: group g cuts the space
that is g pitches further, and a space is cut once more when all others have been, after one turn of the work and

    2π z/N_b                                                                                    (17.3)

of the cutter. In between the cradle rolls by Δθ. Near its contact at θ_c, the blade is off a point of the envelope by
t = c (θ - θ_c)²/2; of the passes, Δθ apart, the nearest is off by Δθ/2 at most. What is left is at most

    δ = c Δθ²/8,   so that   Δθ = √(8 δ/c)                                                      (17.4)

This holds where the same part of the edge meets the point before and after θ_c. Where a part ends, at the border of the
flank to its fillet, the blade is near on one side only, and up to four times as much is left: Δθ is then as long as
the blade, with all parts of its edge, stays within δ.

To find which blades come near a point of the work, it is seen from the tool (5.6) in cylindrical coordinates about the
tool axis. A blade in the plane through that axis reaches it when C stands at its azimuth:

    h = r_z,   ρ² = r_x² + r_y²,   χ = atan2(r_y, -r_x)                                         (17.5)
"""

from __future__ import annotations

from functools import cache

import mpmath
import sympy as sp

from derivations import axes, cradle, generation
from derivations import notation as q
from derivations.expression import Expression
from derivations.frames import I, J, K, Rz
from derivations.proof import DIGITS, is_close, is_zero


def turned(C: sp.Expr) -> sp.Matrix:
    """Q(C) (17.1)."""
    return sp.Matrix([[-sp.cos(C), sp.sin(C), 0], [sp.sin(C), sp.cos(C), 0], [0, 0, -1]])


def cutter_to_work(vector: sp.Matrix) -> sp.Matrix:
    """A direction of the turned cutter frame in the work frame, out of A, B and C."""
    return axes.machine_to_work(turned(q.C.symbol) * vector)


def _edge_point(radius: sp.Expr, height: sp.Expr) -> sp.Matrix:
    """R_e of (17.2); the angle of the blade group is part of C."""
    eta, tip = q.blade_offset_angle.symbol, q.blade_point_radius.symbol
    in_plane = sp.Matrix([tip + (radius - tip) * sp.cos(eta), (radius - tip) * sp.sin(eta), -height])
    return axes.cutter_center() + cutter_to_work(in_plane)


def _straight() -> tuple[sp.Expr, sp.Expr]:
    radius, height, outwards, upwards = q.straight_edge.symbols
    return radius + q.u.symbol * outwards, height + q.u.symbol * upwards


@cache
def tool_frame() -> Expression:
    """The whole pose of the cutter as an Expression."""
    return Expression(
        "tool_frame",
        "Cutter centre and axes k and i of the turned cutter frame in the work, out of all six axes (17.1).",
        (q.axes, q.C, q.pivot_height, q.pivot_offset),
        (
            (q.cutter_center_w, axes.cutter_center()),
            (q.cutter_axis_w, cutter_to_work(sp.Matrix(K))),
            (q.cutter_reference_w, cutter_to_work(sp.Matrix(I))),
        ),
        source="(5.4) with the rotation of the tool about its axis",
    )


@cache
def cradle_tool_frame() -> Expression:
    """The same pose straight from the cradle machine, to compare with."""
    indexed = Rz(-q.index_ratio.symbol * q.beta.symbol)
    reference = cradle.cutter_to_machine(Rz(q.beta.symbol) * sp.Matrix(I))
    return Expression(
        "cradle_tool_frame",
        "Cutter centre and axes k and i of the turned cutter frame in the work, out of the cradle machine (2.2-2.5).",
        (q.settings, q.theta, q.beta, q.index_ratio),
        (
            (q.cutter_center_w, indexed * cradle.machine_to_work(cradle.apex_to_cutter())),
            (q.cutter_axis_w, indexed * cradle.machine_to_work(cradle.cutter_axis())),
            (q.cutter_reference_w, indexed * cradle.machine_to_work(reference)),
        ),
        source="chapter 2 with the indexing of (10.2)",
    )


@cache
def straight_edge_point() -> Expression:
    """(17.2) of a straight part of an edge as an Expression."""
    return Expression(
        "straight_edge_point",
        "Point of a straight part of a blade's edge in the work, out of all six axes (17.2).",
        (
            q.u,
            q.axes,
            q.C,
            q.pivot_height,
            q.pivot_offset,
            q.blade_offset_angle,
            q.blade_point_radius,
            q.straight_edge,
        ),
        ((q.edge_point_w, _edge_point(*_straight())),),
        source="(17.1) of a point of the blade's plane (10.4)",
    )


@cache
def arc_edge_point() -> Expression:
    """(17.2) of a round part of an edge as an Expression."""
    profile = generation.arc()
    return Expression(
        "arc_edge_point",
        "Point of a round part of a blade's edge in the work, out of all six axes (10.3, 17.2).",
        (
            q.arc_angle,
            q.axes,
            q.C,
            q.pivot_height,
            q.pivot_offset,
            q.blade_offset_angle,
            q.blade_point_radius,
            q.blade_arc,
            q.side,
        ),
        ((q.edge_point_w, _edge_point(profile.radius, profile.height)),),
        source="(17.1) of a point of the blade's plane (10.4)",
    )


@cache
def seen_from_blades() -> Expression:
    """(17.5) as an Expression."""
    x, y, z = axes.seen_from_tool()["point_m"]
    return Expression(
        "seen_from_blades",
        "Height above the tip plane, distance from the cutter axis and azimuth of a point of the work (17.5).",
        (q.axes, q.point_w, q.pivot_height, q.pivot_offset),
        ((q.tip_height, z), (q.axis_distance, sp.sqrt(x**2 + y**2)), (q.cutter_azimuth, sp.atan2(y, -x))),
        requires=(x**2 + y**2 - 1,),
        source="(5.6) about the tool axis, with the sense of C",
    )


@cache
def roll_per_turn() -> Expression:
    """(17.4) as an Expression."""
    return Expression(
        "roll_per_turn",
        "How far the cradle may roll in one turn of the work for what is left between two passes (17.4).",
        (q.scallop, q.approach_curvature),
        ((q.roll_per_turn, sp.sqrt(8 * q.scallop.symbol / q.approach_curvature.symbol)),),
        source="parabola of the approach, half a pass beside its vertex",
    )


def _machine_rows() -> tuple[sp.Matrix, sp.Matrix, sp.Matrix, sp.Matrix]:
    """i_s, j_s, k_s for any φ and dA, and the rotation M(B) Rz(dA) that has them as rows (chapter 5)."""
    phi, dA = sp.symbols("phi dA", real=True)
    k_s = sp.Matrix([-sp.sin(phi) * sp.cos(dA), sp.sin(phi) * sp.sin(dA), sp.cos(phi)])
    j_s = k_s.cross(sp.Matrix([0, 0, 1])) / sp.sin(phi)
    return j_s.cross(k_s), j_s, k_s, axes.swivel(sp.pi / 2 - phi) * Rz(dA)


def prove_sixth_axis_completes_the_pose() -> None:
    """(17.1) With T i at the angle ψ in the plane of i_s and j_s, M(B) Rz(dA) T Rz(β) v = Q(β + ψ) v, whatever φ, dA.

    M(B) Rz(dA) W is M(B) Rz(-A) Rz(-φ_w) W, as in chapter 5; T j completes the right-handed frame with k_s.
    """
    i_s, j_s, k_s, into_machine = _machine_rows()
    beta, psi = sp.symbols("beta_ psi_", real=True)
    Ti = sp.cos(psi) * i_s + sp.sin(psi) * j_s
    frame = sp.Matrix.hstack(Ti, k_s.cross(Ti), k_s)
    assert is_zero(into_machine * frame * Rz(beta) - turned(beta + psi))


def prove_turned_frame_is_right_handed() -> None:
    """(17.1) Q(C) is a rotation; its axis k points downwards, and a small turn takes i towards j."""
    C = q.C.symbol
    assert is_zero(turned(C) * turned(C).T - sp.eye(3))
    assert is_zero(turned(C).det() - 1)
    assert is_zero(turned(C).diff(C) * sp.Matrix(I) - turned(C) * sp.Matrix(J))


def prove_straight_edge_is_the_blade_of_the_family() -> None:
    """(17.2) With ρ_0 = r_p, h_0 = 0 and the slopes s tan α and 1, the edge is that of (10.5), for both blades."""
    blade = generation.straight()
    along = (q.blade_point_radius.symbol, 0, q.side.symbol * sp.tan(q.blade_pressure_angle.symbol), 1)
    radius, height = (value.subs(dict(zip(q.straight_edge.symbols, along, strict=True))) for value in _straight())
    assert is_zero(radius - blade.radius)
    assert is_zero(height - blade.height)


def prove_next_group_cuts_the_next_space() -> None:
    """(17.2, 17.3) On six axes, group g is the blade of (10.5) at β + 2π g/N_b, in the space that is g pitches on.

    A comes from (5.2) with the indexing of (10.2), C from (5.8): with tilt, offsets, either sign of the indexing.
    """
    settings = [mpmath.mpf(x) for x in (75, 1, "0.125", "0.875", "3.5", "0.25", 1, "0.375", 3, "0.5", 80, "0.25")]
    groups, teeth, theta, beta, eta, u = 5, 12, *map(mpmath.mpf, ("0.125", "-0.75", "0.25", 2))
    height, offset = mpmath.mpf(3), [mpmath.mpf(x) for x in ("0.5", "-0.25", 2)]
    for sign in (1, -1):
        for g in (0, 1, 3):
            with mpmath.workdps(DIGITS):
                ratio, behind = mpmath.mpf(sign * groups) / teeth, 2 * mpmath.pi * g / groups
                X, Y, Z, A, B = axes.axis_transform().function(*settings, theta, height, *offset)
                (psi,) = axes.cutter_phase().function(*settings, theta)
                edge = [settings[10], 0, mpmath.tan(settings[11]), 1]
                pose = (X, Y, Z, A - ratio * beta, B, beta + psi + behind)
                cut = straight_edge_point().function(u, *pose, height, *offset, eta, settings[10], *edge)
                still = [mpmath.mpf(0)] * q.motion.size
                family = generation.straight_generation().function(
                    u, beta + behind, theta, *settings, *still, ratio, eta, 1
                )
                x, y, z = family[:3]
                pitches = sign * 2 * mpmath.pi * g / teeth
                on = (
                    x * mpmath.cos(pitches) - y * mpmath.sin(pitches),
                    x * mpmath.sin(pitches) + y * mpmath.cos(pitches),
                )
                assert is_close(cut, [*on, z])


def prove_azimuth_is_that_of_the_blade_that_reaches_the_point() -> None:
    """(17.5) Q(χ) [ρ, 0, -h] is the place (x, y, z) with x = -ρ cos χ and y = ρ sin χ: C = χ leads the blade there."""
    rho, chi, h = sp.symbols("rho chi_ h_", real=True)
    assert is_zero(turned(chi) * sp.Matrix([rho, 0, -h]) - sp.Matrix([-rho * sp.cos(chi), rho * sp.sin(chi), h]))


def prove_scallop_is_that_of_a_circle() -> None:
    """(17.4) Limit case: a tool of radius R that moves by s along a plane leaves R - √(R² - s²/4) = s²/(8 R) + ..."""
    s, R = sp.symbols("s R", positive=True)
    exact = sp.series(R - sp.sqrt(R**2 - s**2 / 4), s, 0, 3).removeO()
    # t = s²/(2 R) at a distance s: the curvature of the approach by s is 1/R
    values = {q.scallop.symbol: exact, q.approach_curvature.symbol: 1 / R}
    assert sp.simplify(roll_per_turn()["roll_per_turn"].subs(values) - s) == 0
