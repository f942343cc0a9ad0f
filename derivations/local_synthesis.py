"""Chapter 26. Curvature of a flank, and what curvatures do to path, parabola and ellipse of a contact: local synthesis.

A flank R(w), w = (u, β, θ), f(w) = 0, moves its normal by dn = -K dR in the tangent plane with the basis T = [t_1 t_2]:

    TᵀR_w b_j = e_j,  ∇f·b_j = 0:     K_ij = -t_i·N_w b_j                                         (26.1)

At a contact, with n = n_2 out of the gear and into the pinion, speeds per unit of the pinion's, ω_1 = k, ω_2 = φ_2' z,
ω = ω_1 - ω_2, v = ω_1 × r - ω_2 × (r - o), and the lever ρ_2 (25.6):

    w = Tᵀ(ω × n) + K_2 Tᵀv,    β_c = (ω_2 × n)·v - Tᵀv·K_2 Tᵀv + n·(ω × (ω_1 × r))              (26.2)
    conjugate pinion: D_c = w wᵀ/β_c,     any pinion with D = K_1 - K_2:                           (26.3)
    velocity of the contact on the pinion v_1 = D⁻¹w,   φ_2'' = (β_c - wᵀD⁻¹w)/ρ_2                (26.4)
    half axes √(2τ/λ_1), √(2τ/λ_2) of the ellipse, λ the principal values of D                     (26.5)

The inverse: path direction p = (cos η, sin η), m' = φ_2'' and the major half axis a at the separation τ are wanted:

    s = (β_c - m' ρ_2)/(w·p),   D p = w/s,   D_22 = λ + D_12²/(D_11 - λ),   λ = 2τ/a²             (26.6)

where 1 and 2 are along p and across it; D is turned back into the basis T. (26.2) holds with any offset.

The basis used for the gear has t_1 along the generatrix of its root cone, g = cos δ_f k + sin δ_f [x, y, 0]/r_w, in
the tangent plane, and t_2 towards the tip, p = cos δ_f [x, y, 0]/r_w - sin δ_f k:

    t_1 = (g - (g·n) n)/|...|,   t_2 = ±n × t_1,   t_2·p > 0                                      (26.7)

The path on the gear has the velocity v_1 + v. A flank with a deviation δ(w) along its normals, R' = R + δ n, has along
f = 0 the outward normal

    n' = ±cof(R'_w) ∇f/|...|,   n'·n > 0                                                          (26.8)
"""

from __future__ import annotations

from functools import cache

import mpmath
import sympy as sp

from derivations import notation as q
from derivations.contact import gear_axes, gear_origin
from derivations.expression import Expression
from derivations.frames import K, Rz
from derivations.proof import DIGITS, is_close, is_zero, numbers


def _basis() -> sp.Matrix:
    return sp.Matrix(q.contact_basis.symbol)


@cache
def flank_curvature() -> Expression:
    """(26.1) as an Expression."""
    R, N, f = (sp.Matrix(one.symbol) for one in (q.point_rates, q.normal_rates, q.meshing_gradient))
    T = _basis()
    rows = [(T.T * R)[0, :], (T.T * R)[1, :], f.T]
    minors = [rows[1].cross(rows[2]), rows[2].cross(rows[0])]
    volume = rows[0].dot(minors[0])
    moved = -T.T * N * sp.Matrix.hstack(*(minor.T for minor in minors)) / volume
    return Expression(
        "flank_curvature",
        "Shape operator of a flank in a basis of its tangent plane, from the derivatives of its family (26.1).",
        (q.point_rates, q.normal_rates, q.meshing_gradient, q.contact_basis),
        ((q.curvature, moved),),
        requires=(volume**2 - 1,),
        source="Weingarten's equation on the envelope",
    )


@cache
def roll_at_contact() -> Expression:
    """(26.2) as an Expression."""
    r, n = sp.Matrix(q.gear_point.symbol), sp.Matrix(q.gear_normal.symbol)
    T, K_2, axis = _basis(), sp.Matrix(q.curvature.symbol), gear_axes()[:, 2]
    rho = n.dot(axis.cross(r - gear_origin()))
    one, other = sp.Matrix(K), n.dot(sp.Matrix(K).cross(r)) / rho * axis
    omega, v = one - other, one.cross(r) - other.cross(r - gear_origin())
    along = T.T * v
    turning = other.cross(n).dot(v) - (along.T * K_2 * along)[0] + n.dot(omega.cross(one.cross(r)))
    return Expression(
        "roll_at_contact",
        "How the members roll on each other at a contact: w, the acceleration, the sliding (26.2).",
        (
            q.gear_point,
            q.gear_normal,
            q.contact_basis,
            q.curvature,
            q.shaft_angle,
            q.hypoid_offset,
            q.assembly,
        ),
        (
            (q.roll_vector, T.T * omega.cross(n) + K_2 * along),
            (q.roll_acceleration, turning),
            (q.sliding, along),
        ),
        requires=(rho**2 - 25,),
        source="Litvin's relations of curvatures, written without principal directions",
    )


def _matrix(components: sp.Matrix) -> sp.Matrix:
    one, mixed, two = components
    return sp.Matrix([[one, mixed], [mixed, two]])


@cache
def contact_motion() -> Expression:
    """(26.4) as an Expression."""
    w, D = sp.Matrix(q.roll_vector.symbol), _matrix(q.relative_curvature.symbol)
    velocity = D.adjugate() * w / D.det()
    second = (q.roll_acceleration.symbol - w.dot(velocity)) / q.lever_arm.symbol
    return Expression(
        "contact_motion",
        "Velocity of the contact on the pinion, and second derivative of the transmission (26.4).",
        (q.roll_vector, q.roll_acceleration, q.relative_curvature, q.lever_arm),
        ((q.contact_velocity, velocity), (q.transmission_curvature, second)),
        requires=(D.det() - sp.Rational(1, 10**6),),
        source="implicit differentiation of (25.3)",
    )


@cache
def conjugate_curvature() -> Expression:
    """(26.3) as an Expression."""
    w, beta = q.roll_vector.symbol, q.roll_acceleration.symbol
    return Expression(
        "conjugate_curvature",
        "Relative curvature of the conjugate pinion: zero along the contact line (26.3).",
        (q.roll_vector, q.roll_acceleration),
        ((q.conjugate_curvature, sp.Matrix([w[0] ** 2, w[0] * w[1], w[1] ** 2]) / beta),),
        requires=(beta**2 - 1,),
        source="line contact: D is of rank one",
    )


@cache
def contact_ellipse() -> Expression:
    """(26.5) as an Expression."""
    D, tau = q.relative_curvature.symbol, q.separation.symbol
    mean, half = (D[0] + D[2]) / 2, sp.sqrt(((D[0] - D[2]) / 2) ** 2 + D[1] ** 2)
    return Expression(
        "contact_ellipse",
        "Half axes of the ellipse at whose border the flanks are a distance apart (26.5).",
        (q.relative_curvature, q.separation),
        ((q.semi_axes, sp.Matrix([sp.sqrt(2 * tau / (mean - half)), sp.sqrt(2 * tau / (mean + half))])),),
        requires=(mean - half - sp.Rational(1, 1000),),
        source="gap of two surfaces to second order",
    )


@cache
def synthesis() -> Expression:
    """(26.6) as an Expression."""
    w, eta, tau = sp.Matrix(q.roll_vector.symbol), q.path_angle.symbol, q.separation.symbol
    p = sp.Matrix([sp.cos(eta), sp.sin(eta)])
    across = sp.Matrix([-sp.sin(eta), sp.cos(eta)])
    speed = (q.roll_acceleration.symbol - q.wanted_curvature.symbol * q.lever_arm.symbol) / w.dot(p)
    along, mixed = w.dot(p) / speed, w.dot(across) / speed
    least = 2 * tau / q.major_semi_axis.symbol**2
    other = least + mixed**2 / (along - least)
    frame = sp.Matrix.hstack(p, across)
    D = frame * sp.Matrix([[along, mixed], [mixed, other]]) * frame.T
    return Expression(
        "synthesis",
        "Relative curvature that gives the wanted path direction, parabola and ellipse (26.6).",
        (
            q.roll_vector,
            q.roll_acceleration,
            q.lever_arm,
            q.path_angle,
            q.wanted_curvature,
            q.major_semi_axis,
            q.separation,
        ),
        ((q.synthesized_curvature, sp.Matrix([D[0, 0], D[0, 1], D[1, 1]])),),
        requires=(w.dot(p) ** 2 - sp.Rational(1, 100), speed**2 - 1, (along - least) ** 2 - sp.Rational(1, 10**6)),
        source="local synthesis of Litvin, solved in the tangent plane",
    )


@cache
def root_basis() -> Expression:
    """(26.7) as an Expression."""
    R, n, root = sp.Matrix(q.point_w.symbol), sp.Matrix(q.normal_w.symbol), q.root_angle.symbol
    radius = sp.sqrt(R[0] ** 2 + R[1] ** 2)
    outwards = sp.Matrix([R[0] / radius, R[1] / radius, 0])
    along = sp.cos(root) * sp.Matrix(K) + sp.sin(root) * outwards
    tipwards = sp.cos(root) * outwards - sp.sin(root) * sp.Matrix(K)
    seen = along - along.dot(n) * n
    size = sp.sqrt(seen.dot(seen))
    first = seen / size
    second = n.cross(first)
    return Expression(
        "root_basis",
        "Basis of the tangent plane: along the root cone's generatrix, and towards the tip (26.7).",
        (q.point_w, q.normal_w, q.root_angle),
        ((q.contact_basis, sp.Matrix.hstack(first, sp.sign(second.dot(tipwards)) * second)),),
        requires=(
            R[0] ** 2 + R[1] ** 2 - 1,
            size**2 - sp.Rational(1, 10),
            second.dot(tipwards) ** 2 - sp.Rational(1, 100),
        ),
        source="projection into the tangent plane",
    )


@cache
def displaced_normal() -> Expression:
    """(26.8) as an Expression; ``point_rates`` are those of the displaced points."""
    R, f, n = (sp.Matrix(one.symbol) for one in (q.point_rates, q.meshing_gradient, q.normal_w))
    columns = [R[:, k] for k in range(3)]
    across = sum((f[k] * columns[(k + 1) % 3].cross(columns[(k + 2) % 3]) for k in range(3)), sp.zeros(3, 1))
    size = sp.sqrt(across.dot(across))
    return Expression(
        "displaced_normal",
        "Outward normal of a flank that deviates along its nominal normals (26.8).",
        (q.point_rates, q.meshing_gradient, q.normal_w),
        ((q.own_normal, sp.sign(across.dot(n)) * across / size),),
        requires=(size**2 - 1, across.dot(n) ** 2 - sp.Rational(1, 100)),
        source="a linear map takes areas by its cofactors",
    )


def prove_displaced_normal_is_square_to_every_direction_within_the_flank() -> None:
    """(26.8) n' is square to R'_w b for every b with ∇f·b = 0, as b = ∇f × c is for any c."""
    R, f = sp.Matrix(q.point_rates.symbol), sp.Matrix(q.meshing_gradient.symbol)
    columns = [R[:, k] for k in range(3)]
    across = sum((f[k] * columns[(k + 1) % 3].cross(columns[(k + 2) % 3]) for k in range(3)), sp.zeros(3, 1))
    for c in sp.eye(3).columnspace():
        assert is_zero(sp.expand(across.dot(R * f.cross(c))))
    found = displaced_normal()["own_normal"]
    side = sp.sign(across.dot(sp.Matrix(q.normal_w.symbol)))
    assert is_zero(sp.Matrix(found) * sp.sqrt(across.dot(across)) / side - across)


def prove_root_basis_is_orthonormal_and_points_to_heel_and_tip() -> None:
    """(26.7) On an upright flank the basis is the generatrix and the direction away from the root cone."""
    root, azimuth = sp.symbols("delta_f chi", positive=True)
    along = Rz(azimuth) * sp.Matrix([sp.sin(root), 0, sp.cos(root)])
    tipwards = Rz(azimuth) * sp.Matrix([sp.cos(root), 0, -sp.sin(root)])
    for side in (1, -1):
        values = dict(zip(q.point_w.symbols, 50 * along, strict=True))
        values |= dict(zip(q.normal_w.symbols, side * Rz(azimuth) * sp.Matrix([0, 1, 0]), strict=True))
        found = root_basis()["contact_basis"].subs(values, simultaneous=True)
        at = {root: sp.Rational(9, 8), azimuth: sp.Rational(1, 2), q.root_angle.symbol: sp.Rational(9, 8)}
        with mpmath.workdps(DIGITS):
            wanted = numbers([*along.subs(at), *tipwards.subs(at)])
            T = sp.Matrix(found).subs(at)
            assert is_close(numbers([*T[:, 0], *T[:, 1]]), wanted)


def prove_curvature_of_a_torus_cut_as_an_envelope() -> None:
    """(26.1) Spheres whose centers run around a circle envelop a torus: 1/r across it, cos ψ/(R + r cos ψ) around it.

    u is the angle ψ on the sphere and β the azimuth there; θ moves the sphere, and f = n·R_θ keeps β at θ.
    """
    psi, azimuth, theta, R, r = sp.symbols("psi azimuth theta R r", positive=True)
    n = sp.Matrix([sp.cos(psi) * sp.cos(azimuth), sp.cos(psi) * sp.sin(azimuth), sp.sin(psi)])
    point = R * sp.Matrix([sp.cos(theta), sp.sin(theta), 0]) + r * n
    w = (psi, azimuth, theta)
    f = n.dot(point.diff(theta))
    here = {azimuth: theta}
    T = sp.Matrix.hstack(n.diff(psi).subs(here), sp.Matrix([-sp.sin(theta), sp.cos(theta), 0]))
    parts = (
        (q.point_rates, point.jacobian(w)),
        (q.normal_rates, n.jacobian(w)),
        (q.meshing_gradient, sp.Matrix([f]).jacobian(w)),
        (q.contact_basis, T),
    )
    values: dict[sp.Symbol, sp.Expr] = {}
    for quantity, matrix in parts:
        values |= dict(zip(quantity.symbols, matrix.subs(here), strict=True))
    K_found = flank_curvature()["curvature"].subs(values, simultaneous=True)
    around = -sp.cos(psi) / (R + r * sp.cos(psi))
    assert is_zero(sp.Matrix(K_found) - sp.Matrix([[-1 / r, 0], [0, around]]))


def prove_spur_gears_have_the_curvatures_of_their_involutes() -> None:
    """(26.2, 26.3) Σ = 0, offset as center distance: D_c = 1/ρ_1 + 1/ρ_2 across the contact line, and 0 along it."""
    r_1, r_2, alpha, s = sp.symbols("r_1 r_2 alpha s", positive=True)
    action = sp.Matrix([sp.cos(alpha), sp.sin(alpha), 0])  # from the pinion's base circle to the gear's
    r, n = r_1 * sp.Matrix([0, 1, 0]) + s * action, -action
    T = sp.Matrix([[-sp.sin(alpha), 0], [sp.cos(alpha), 0], [0, 1]])
    radius_1, radius_2 = r_1 * sp.sin(alpha) + s, r_2 * sp.sin(alpha) - s  # from the base circles to the contact
    values = dict(zip((*q.gear_point.symbols, *q.gear_normal.symbols), (*r, *n), strict=True))
    values |= dict(zip(q.contact_basis.symbols, T, strict=True))
    values |= dict(zip(q.curvature.symbols, (-1 / radius_2, 0, 0, 0), strict=True))
    values |= dict.fromkeys(q.assembly.symbols, 0) | {q.shaft_angle.symbol: 0, q.hypoid_offset.symbol: r_1 + r_2}
    w = roll_at_contact()["roll_vector"].subs(values, simultaneous=True)
    beta = roll_at_contact()["roll_acceleration"].subs(values, simultaneous=True)
    assert is_zero(w[1])
    assert is_zero(w[0] ** 2 / beta - (1 / radius_1 + 1 / radius_2))


def prove_conjugate_pinion_runs_without_error() -> None:
    """(26.3, 26.4) As D tends to D_c + ε t tᵀ across w, φ_2'' vanishes and the contact runs along any direction."""
    w = sp.Matrix(q.roll_vector.symbol)
    beta, eps = q.roll_acceleration.symbol, sp.Symbol("epsilon", positive=True)
    across = sp.Matrix([-w[1], w[0]])
    D = w * w.T / beta + eps * across * across.T
    values = dict(zip(q.relative_curvature.symbols, (D[0, 0], D[0, 1], D[1, 1]), strict=True))
    assert is_zero(contact_motion()["transmission_curvature"].subs(values, simultaneous=True))


def prove_synthesis_is_the_inverse_of_the_analysis() -> None:
    """(26.6) Path, second derivative and half axis that (26.4, 26.5) find with the synthesized D are those wanted."""
    w, beta, rho = [sp.Rational(5, 4), sp.Rational(1, 2)], 60, 70
    eta, second, axis, tau = sp.Rational(5, 4), sp.Rational(-1, 400), 6, sp.Rational(1, 150)
    with mpmath.workdps(DIGITS):
        D = synthesis().function(*numbers([*w, beta, rho, eta, second, axis, tau]))
        *velocity, found = contact_motion().function(*numbers([*w, beta]), *D, mpmath.mpf(rho))
        major, _ = contact_ellipse().function(*D, mpmath.mpf(1) / 150)
        along = [mpmath.cos(mpmath.mpf(5) / 4), mpmath.sin(mpmath.mpf(5) / 4)]
        assert is_close([velocity[0] * along[1] - velocity[1] * along[0]], [0])
        assert is_close([found, major], numbers([second, axis]))


def prove_ellipse_is_where_the_gap_reaches_the_separation() -> None:
    """(26.5) Along the principal directions of a diagonal D the gap D x²/2 is τ at the half axes."""
    D_1, D_2 = sp.symbols("D_1 D_2", positive=True)
    values = dict(zip(q.relative_curvature.symbols, (D_1, 0, D_2), strict=True))
    axes = contact_ellipse()["semi_axes"].subs(values, simultaneous=True)
    ends = axes.subs(D_1, D_2 + sp.Symbol("d", positive=True))  # the second direction is the flatter one
    d = sp.Symbol("d", positive=True)
    assert is_zero(ends[0] ** 2 * D_2 / 2 - q.separation.symbol)
    assert is_zero(ends[1] ** 2 * (D_2 + d) / 2 - q.separation.symbol)
