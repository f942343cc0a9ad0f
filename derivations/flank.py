"""Chapter 3. The family of cutter surfaces in the work, R(u, β, θ), and its normal.

    R(u, β, θ) = Rz(-φ_w) W (V_ls + T r_c)                                                     (3.1)
    n(β, θ)    = Rz(-φ_w) W T n_c                        outward: out of the metal             (3.2)

The tooth surface is the envelope of this family: the points of (3.1) that also satisfy chapter 4.
"""

from __future__ import annotations

from functools import cache

import sympy as sp

from derivations import cradle, cutter
from derivations import notation as q
from derivations.expression import Expression
from derivations.proof import is_zero


def point() -> sp.Matrix:
    """R, a point of the family (3.1)."""
    return cradle.machine_to_work(cradle.apex_to_cutter() + cradle.cutter_to_machine(cutter.point()))


def normal() -> sp.Matrix:
    """n, its outward unit normal (3.2)."""
    return cradle.machine_to_work(cradle.cutter_to_machine(cutter.normal()))


@cache
def flank_family() -> Expression:
    """Point and outward normal of the family as an Expression."""
    return Expression(
        "flank_family",
        "Point and outward unit normal of the family of cutter surfaces in the work frame (3.1, 3.2).",
        (q.u, q.beta, q.theta, q.settings, q.side),
        ((q.point_w, point()), (q.normal_w, normal())),
        source="chapters 1 and 2; NASA TM-105150 (Handschuh, Litvin 1991) chains the same motions in other axes",
    )


def nasa_family(h: int) -> tuple[sp.Matrix, dict[sp.Symbol, sp.Expr], dict[str, sp.Symbol]]:
    """The published matrix chain of NASA TM-105150, and the substitution that makes (3.1) the same motion.

    Returns the point in the member's frame, the settings of (3.1) in the published symbols, and these symbols.
    h = +1 pinion (left hand), -1 gear (right hand). The outer blade has psi = 180° - α, the inner blade psi = α.
    """
    names = "r psi s q L_m E_m m_cw u theta phi mu d"
    v = {name: sp.Symbol(name + "_nasa", real=True) for name in names.split()}
    r, psi, u, theta, phi = v["r"], v["psi"], v["u"], v["theta"], v["phi"]
    mu, d, q_n, s = v["mu"], v["d"], v["q"], v["s"]
    r_c = sp.Matrix(
        [r * sp.cot(psi) - u * sp.cos(psi), u * sp.sin(psi) * sp.sin(theta), u * sp.sin(psi) * sp.cos(theta)]
    )
    turn = sp.Matrix([[1, 0, 0], [0, sp.cos(q_n), -h * sp.sin(q_n)], [0, h * sp.sin(q_n), sp.cos(q_n)]])
    r_s = turn * r_c + sp.Matrix([0, -h * s * sp.sin(q_n), s * sp.cos(q_n)])
    r_m = sp.Matrix([[1, 0, 0], [0, sp.cos(phi), h * sp.sin(phi)], [0, -h * sp.sin(phi), sp.cos(phi)]]) * r_s
    M_pm = sp.Matrix([[sp.cos(d), 0, -sp.sin(d)], [0, 1, 0], [sp.sin(d), 0, sp.cos(d)]])
    r_p = M_pm * r_m + sp.Matrix([-v["L_m"] * sp.sin(d), v["E_m"], v["L_m"] * sp.cos(d)])
    r_a = sp.Matrix([[sp.cos(mu), 0, sp.sin(mu)], [0, 1, 0], [-sp.sin(mu), 0, sp.cos(mu)]]) * r_p
    w = h * phi / v["m_cw"]
    r_w = sp.Matrix([[sp.cos(w), sp.sin(w), 0], [-sp.sin(w), sp.cos(w), 0], [0, 0, 1]]) * r_a
    root = mu - d
    same = {
        q.radial_distance.symbol: s,
        q.cradle_angle.symbol: -h * q_n,
        q.cutter_tilt.symbol: sp.S.Zero,
        q.cutter_swivel.symbol: sp.S.Zero,
        q.blank_offset.symbol: v["E_m"],
        q.sliding_base.symbol: v["L_m"] * sp.tan(root),
        q.machine_center_to_crossing_point.symbol: v["L_m"] / sp.cos(root),
        q.machine_root_angle.symbol: root,
        q.ratio_of_roll.symbol: 1 / v["m_cw"],
        q.work_rotation_offset.symbol: sp.S.Zero,
        q.blade_point_radius.symbol: r,
        q.theta.symbol: h * phi,
        q.beta.symbol: theta,
    }
    return r_w, same, v


def prove_family_equals_the_published_chain() -> None:
    """(3.1) equals the matrix chain of NASA TM-105150 for pinion and gear, outer and inner blade."""
    for h in (1, -1):
        published, same, v = nasa_family(h)
        for side in (1, -1):
            alpha = sp.pi - v["psi"] if side == 1 else v["psi"]
            height = -side * (v["r"] * sp.cot(alpha) - v["u"] * sp.cos(alpha))
            values = {**same, q.side.symbol: side, q.blade_pressure_angle.symbol: alpha, q.u.symbol: height}
            difference = point().subs(values, simultaneous=True) - published
            assert is_zero(difference), f"h = {h}, side = {side}"


def prove_normal_is_perpendicular_to_the_surface() -> None:
    """(3.2) n·∂R/∂u = n·∂R/∂β = 0 and n·n = 1: rotations carry the proof of chapter 1 into the work."""
    n_c, r_c = cutter.normal(), cutter.point()
    for parameter in (q.u.symbol, q.beta.symbol):
        for side in (1, -1):
            assert sp.simplify(n_c.dot(r_c.diff(parameter)).subs(q.side.symbol, side)) == 0
    assert sp.simplify(n_c.dot(n_c).subs(q.side.symbol**2, 1)) == 1
    chain = cradle.frame_w() * sp.Matrix.hstack(*(cradle.cutter_to_machine(sp.eye(3)[:, k]) for k in range(3)))
    assert sp.simplify(chain * chain.T) == sp.eye(3)
