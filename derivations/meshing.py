"""Chapter 4. The equation of meshing: v12 · n = 0.

Per unit of cradle speed the cutter moves with the cradle, the work turns with R_a about its axis:

    v12 = k × (V_q + T r_c) - R_a V_p × (V_ls + T r_c),   V_q = S [cos(q+θ), sin(q+θ), 0]      (4.1)
    f   = v12 · T n_c = 0                                                                      (4.2)

Start values for a point given by (z_w, r_w): the cutter circle of an untilted cutter through the point of the crown
gear in the plane of the work axis, at (d_i, d_j) from the machine centre and at height u above the tip plane:

    d_i = z_w cos Γ + r_w sin Γ - X_p cos Γ,  d_j = -E_m,  u = X_p sin Γ - X_b - z_w sin Γ + r_w cos Γ
    q + θ = atan2(d_j, d_i) + sign(q) acos((S² + d² - ρ(u)²) / (2 S d))                        (4.3)

f is the speed with which the cutter enters the metal along the outward normal's line; it equals n · ∂R/∂θ.
"""

from __future__ import annotations

from functools import cache

import sympy as sp

from derivations import cradle, cutter, flank
from derivations import notation as q
from derivations.expression import Expression
from derivations.frames import K
from derivations.proof import is_zero


def relative_velocity() -> sp.Matrix:
    """v12 of cutter against work at a point of the cutter surface, machine frame (4.1)."""
    from_centre = cradle.cutter_to_machine(cutter.point())
    of_cutter = sp.Matrix(K).cross(cradle.radial_vector() + from_centre)
    of_work = q.ratio_of_roll.symbol * cradle.work_axis().cross(cradle.apex_to_cutter() + from_centre)
    return of_cutter - of_work


def residual() -> sp.Expr:
    """f (4.2)."""
    return relative_velocity().dot(cradle.cutter_to_machine(cutter.normal()))


@cache
def meshing() -> Expression:
    """The equation of meshing as an Expression."""
    return Expression(
        "meshing",
        "Equation of meshing f = v12 · n of the generated flank (4.2); zero where the envelope touches the cutter.",
        (q.u, q.beta, q.theta, q.settings, q.side),
        ((q.meshing_residual, residual()),),
        source="v12 · n = 0; equal to n · dR/dtheta and to the closed form of NASA TM-105150",
    )


@cache
def contact_start() -> Expression:
    """(4.3) as an Expression: exact for cutter and crown gear, close enough to start from for a member."""
    S, gamma, swing = q.radial_distance.symbol, q.machine_root_angle.symbol, q.cradle_angle.symbol
    z, r, X_p = q.axial.symbol, q.radial.symbol, q.machine_center_to_crossing_point.symbol
    d_i = z * sp.cos(gamma) + r * sp.sin(gamma) - X_p * sp.cos(gamma)
    d_j = -q.blank_offset.symbol
    height = X_p * sp.sin(gamma) - q.sliding_base.symbol - z * sp.sin(gamma) + r * sp.cos(gamma)
    d = sp.sqrt(d_i**2 + d_j**2)
    cosine = (S**2 + d**2 - cutter.radius(height) ** 2) / (2 * S * d)
    polar = sp.atan2(d_j, d_i) + sp.sign(swing) * sp.acos(sp.Max(-1, sp.Min(1, cosine)))
    beta = sp.atan2(d_j - S * sp.sin(polar), d_i - S * sp.cos(polar)) - polar - q.cutter_swivel.symbol
    return Expression(
        "contact_start",
        "Start values of u, beta, theta for a flank point given by its place on the blank (4.3).",
        (q.settings, q.side, q.axial, q.radial),
        ((q.contact, sp.Matrix([height, beta, polar - swing])),),
        source="law of cosines in the machine plane",
    )


def nasa_closed_form(h: int, v: dict[str, sp.Symbol]) -> sp.Expr:
    """The published meshing equation of NASA TM-105150 in its own symbols; h = +1 pinion, -1 gear."""
    r, psi, s, q_n, L_m, E_m, m_cw = (v[name] for name in ["r", "psi", "s", "q", "L_m", "E_m", "m_cw"])
    u, theta, phi, root = v["u"], v["theta"], v["phi"], v["mu"] - v["d"]
    tau = theta - h * q_n + h * phi
    return (
        (u - r * sp.cot(psi) * sp.cos(psi)) * sp.cos(root) * sp.sin(tau)
        + s * ((m_cw - sp.sin(root)) * sp.cos(psi) * sp.sin(theta) - h * sp.cos(root) * sp.sin(psi) * sp.sin(q_n - phi))
        + E_m * (sp.cos(root) * sp.sin(psi) + sp.sin(root) * sp.cos(psi) * sp.cos(tau))
        - L_m * sp.sin(root) * sp.cos(psi) * sp.sin(tau)
    )


def prove_meshing_is_the_normal_part_of_the_surface_velocity() -> None:
    """(4.2) f = n · ∂R/∂θ, the envelope condition, reached by differentiation instead of by velocities."""
    theta, phi = q.theta.symbol, q.work_rotation_offset.symbol
    # Rotating both vectors into the frame of the work at this instant cancels Rz(-φ_w) exactly:
    # n·∂R/∂θ = (W T n_c) · (∂/∂θ(W p) - R_a z × (W p)),  p = V_ls + T r_c.
    p = cradle.apex_to_cutter() + cradle.cutter_to_machine(cutter.point())
    turned = (cradle.machine_to_work(p).diff(theta)).subs(phi, -q.ratio_of_roll.symbol * theta)
    n = flank.normal().subs(phi, -q.ratio_of_roll.symbol * theta)
    difference = n.dot(turned) - residual()
    assert is_zero(difference)


def prove_meshing_equals_the_published_closed_form() -> None:
    """(4.2) is the closed form of NASA TM-105150 times a factor without zeros, pinion and gear, both blades."""
    for h in (1, -1):
        _, same, v = flank.nasa_family(h)
        for side in (1, -1):
            alpha = sp.pi - v["psi"] if side == 1 else v["psi"]
            height = -side * (v["r"] * sp.cot(alpha) - v["u"] * sp.cos(alpha))
            values = {**same, q.side.symbol: side, q.blade_pressure_angle.symbol: alpha, q.u.symbol: height}
            ours = residual().subs(values, simultaneous=True)
            factor = 1 / v["m_cw"]
            published = nasa_closed_form(h, v)
            assert is_zero(ours - factor * published), f"h = {h}, side = {side}"


def prove_start_values_put_the_cutter_circle_through_the_point() -> None:
    """(4.3) From the cutter centre at S, q + θ to the place of the point in the machine plane is the cutting radius ρ.

    The place is that of (z_w, r_w) with the point above the work axis, turned by the root angle and moved by X_p, E_m.
    """
    S, z, r, X_p, E_m, X_b, gamma, alpha, point = (
        sp.Rational(text) for text in ("75", "76", "26", "1", "7/2", "1/4", "7/24", "3/8", "80")
    )
    values = {
        q.radial_distance.symbol: S,
        q.cradle_angle.symbol: 1,
        q.cutter_tilt.symbol: 0,
        q.cutter_swivel.symbol: 0,
        q.blank_offset.symbol: E_m,
        q.sliding_base.symbol: X_b,
        q.machine_center_to_crossing_point.symbol: X_p,
        q.machine_root_angle.symbol: gamma,
        q.blade_point_radius.symbol: point,
        q.blade_pressure_angle.symbol: alpha,
        q.axial.symbol: z,
        q.radial.symbol: r,
    }
    for side in (1, -1):
        height, _, theta = (sp.N(each.subs({**values, q.side.symbol: side}), 40) for each in contact_start()["contact"])
        center = S * sp.Matrix([sp.cos(1 + theta), sp.sin(1 + theta)])
        # along the work axis (cos γ, sin γ) and square to it, in the plane of machine axis and work axis
        place = sp.Matrix([(z - X_p) * sp.cos(gamma) + r * sp.sin(gamma), -E_m])
        level = (z - X_p) * sp.sin(gamma) - r * sp.cos(gamma)
        assert abs(sp.N(height + level + X_b, 30)) < sp.Rational(1, 10**25)
        assert abs(sp.N((place - center).norm() - point - side * height * sp.tan(alpha), 30)) < sp.Rational(1, 10**25)
