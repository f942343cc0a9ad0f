"""Chapter 27. From what a designer asks for to the curvature of the pinion at one point, and to the whole flank.

Depth and thickness of a blank that nobody has chosen, with the equivalent ratio u_a:

    c_ham = k_1 + k_2/u_a²,   u_a² = u cos δ_1/cos δ_2
    k_t = -0.088 + 0.092 u - 0.004 u² + 0.0016 (z_1 - 30)(u - 1)                                   (27.1)

A transmission error of the amplitude A, half a pitch to either side of its vertex, by which the gear lags:

    m' = sign(ρ_2) 2 A (z_1/π)²                                                                    (27.2)

The path is asked for on the gear, as direction p_2 = (cos η_2, sin η_2) in the basis (26.7). The contact moves there
with v_2 = v_1 + v = s p_2, and (26.4) says w·v_1 = β_c - m' ρ_2; so the path on the pinion, that of (26.6), is

    s = (β_c - m' ρ_2 + w·v)/(w·p_2),   v_1 = s p_2 - v,   η = atan2(v_1,2, v_1,1)                 (27.3)

A point x of the tangent plane meets its mate when the pinion has turned by φ = w·x/β_c, and ξ = x_1 is its place along
the tooth. The gap that goes with D at the mean point, and with a parabola that is the same on both sides over the whole
flank, is

    E = ρ/ρ_0 · xᵀ(D - w wᵀ/β_c)x/2,   x = (ξ, (β_c φ - w_1 ξ)/w_2)                                (27.4)

with the lever ρ of each place over that of the mean point. The settings follow from point, normal and curvature there:

    R = P,   T·n = 0,   f = 0,   K(R_w, n_w, ∇f, T) = K_2 + D,   u = u_0      at θ = 0            (27.5)

ten equations, f by (10.6) and K by (26.1), for u, β and eight settings.

One machine that cuts both flanks at once gives each of them at a θ of its own

    R = P,   T·n = 0,   f = 0,   φ_2''(K - K_2) = m'                                               (27.6)

by (26.4): fourteen equations, six of them for (u, β, θ) of both, and leaves what K is otherwise to the least squares of
the gap. Or crownings are asked for instead of parabola, path and ellipse, of the gap over the gear's flank: c_b at the
ends of the face width b, c_h at the ends of the working depth h, and c_w, what the corner of heel and tip has beyond
both. With the distances ξ and η from the vertex in cone distance and height, which change by M along the tangents of
the gear, and what meets at φ = w·x/β_c having slid by v φ,

    E = c_b (2 ξ/b)² + c_w (2 ξ/b)(2 η/h) + c_h (2 η/h)²,     (ξ, η) = N x,   N = M (1 + v wᵀ/β_c),
    D = Nᵀ E_ξη N + w wᵀ/β_c                                                                       (27.7)

with the second derivatives E_ξη.
"""

from __future__ import annotations

from functools import cache

import mpmath
import sympy as sp

from derivations import notation as q
from derivations.expression import Expression
from derivations.local_synthesis import conjugate_curvature, contact_motion, synthesis
from derivations.proof import DIGITS, is_close, is_zero, numbers


@cache
def suggested_factors() -> Expression:
    """(27.1) as an Expression."""
    u, z_1 = q.gear_ratio.symbol, q.pinion_teeth.symbol
    equivalent = u * sp.cos(q.pinion_pitch_angle.symbol) / sp.cos(q.wheel_pitch_angle.symbol)
    thickness = (
        -sp.Rational(88, 1000)
        + sp.Rational(92, 1000) * u
        - sp.Rational(4, 1000) * u**2
        + sp.Rational(16, 10000) * (z_1 - 30) * (u - 1)
    )
    return Expression(
        "suggested_factors",
        "Addendum and thickness factor of a blank that nobody has chosen (27.1).",
        (
            q.gear_ratio,
            q.pinion_teeth,
            q.pinion_pitch_angle,
            q.wheel_pitch_angle,
            q.addendum_constant,
            q.addendum_share,
        ),
        (
            (q.mean_addendum_factor, q.addendum_constant.symbol + q.addendum_share.symbol / equivalent),
            (q.thickness_factor, thickness),
        ),
        source="ISO 23509, annex C, suggested values of data type II",
    )


@cache
def wanted_parabola() -> Expression:
    """(27.2) as an Expression."""
    size = 2 * q.transmission_amplitude.symbol * (q.pinion_teeth.symbol / sp.pi) ** 2
    return Expression(
        "wanted_parabola",
        "Second derivative of the transmission that makes the gear lag half a pitch from the vertex (27.2).",
        (q.transmission_amplitude, q.pinion_teeth, q.signed_lever),
        ((q.wanted_curvature, sp.sign(q.signed_lever.symbol) * size),),
        requires=(q.signed_lever.symbol**2 - 1,),
        source="parabola through its vertex",
    )


def _speed_on_gear() -> tuple[sp.Matrix, sp.Expr]:
    """p_2 and s (27.3)."""
    w, v = sp.Matrix(q.roll_vector.symbol), sp.Matrix(q.sliding.symbol)
    eta = q.gear_path_angle.symbol
    along = sp.Matrix([sp.cos(eta), sp.sin(eta)])
    needed = q.roll_acceleration.symbol - q.wanted_curvature.symbol * q.signed_lever.symbol
    return along, (needed + w.dot(v)) / w.dot(along)


@cache
def path_on_pinion() -> Expression:
    """(27.3) as an Expression."""
    along, speed = _speed_on_gear()
    own = speed * along - sp.Matrix(q.sliding.symbol)
    return Expression(
        "path_on_pinion",
        "Direction of the path on the pinion that gives a direction on the gear (27.3).",
        (q.roll_vector, q.roll_acceleration, q.signed_lever, q.sliding, q.wanted_curvature, q.gear_path_angle),
        ((q.path_angle, sp.atan2(own[1], own[0])),),
        requires=(sp.Matrix(q.roll_vector.symbol).dot(along) ** 2 - sp.Rational(1, 10), own.dot(own) - 1),
        source="the contact moves on gear and pinion with velocities that differ by the sliding",
    )


@cache
def wanted_gap() -> Expression:
    """(27.4) as an Expression."""
    w, beta, D = q.roll_vector.symbol, q.roll_acceleration.symbol, q.relative_curvature.symbol
    phi, xi = q.pinion_rotation.symbol, q.along_tooth.symbol
    x = sp.Matrix([xi, (beta * phi - w[0] * xi) / w[1]])
    A = sp.Matrix([[D[0], D[1]], [D[1], D[2]]]) - sp.Matrix(w) * sp.Matrix(w).T / beta
    return Expression(
        "wanted_gap",
        "Gap of the pinion against the conjugate one that makes the parabola the same on both sides (27.4).",
        (
            q.pinion_rotation,
            q.along_tooth,
            q.relative_curvature,
            q.roll_vector,
            q.roll_acceleration,
            q.signed_lever,
            q.lever_arm,
        ),
        ((q.ease_off, q.signed_lever.symbol / q.lever_arm.symbol * (x.T * A * x)[0] / 2),),
        requires=(beta**2 - 1, w[1] ** 2 - sp.Rational(1, 10)),
        source="ease-off to second order, by roll angle and place along the tooth",
    )


_CROWNINGS = (
    q.face_width,
    q.mean_working_depth,
    q.wanted_length_crowning,
    q.wanted_profile_crowning,
    q.wanted_bias,
)


def _crowned_gap() -> sp.Expr:
    """E (27.7)."""
    b, h, length, profile, bias = (one.symbol for one in _CROWNINGS)
    along, up = 2 * q.cone_distance_off.symbol / b, 2 * q.height_off.symbol / h
    return length * along**2 + bias * along * up + profile * up**2


def _on_gear() -> sp.Matrix:
    """N (27.7): from a place on the pinion to cone distance and height of the place on the gear that it meets."""
    w, v = sp.Matrix(q.roll_vector.symbol), sp.Matrix(q.sliding.symbol)
    return sp.Matrix(q.axial_rates.symbol) * (sp.eye(2) + v * w.T / q.roll_acceleration.symbol)


@cache
def crowned_gap() -> Expression:
    """E (27.7) as an Expression."""
    return Expression(
        "crowned_gap",
        "Gap over the flank of the gear that has these crownings (27.7).",
        (q.cone_distance_off, q.height_off, *_CROWNINGS),
        ((q.ease_off, _crowned_gap()),),
        source="gap to second order, by its values at the ends of the flank",
    )


@cache
def crowned() -> Expression:
    """D (27.7) as an Expression."""
    w, beta, N = sp.Matrix(q.roll_vector.symbol), q.roll_acceleration.symbol, _on_gear()
    A = N.T * sp.hessian(_crowned_gap(), (q.cone_distance_off.symbol, q.height_off.symbol)) * N
    D = A + w * w.T / beta
    return Expression(
        "crowned",
        "Relative curvature at the vertex of a gap that has these crownings (27.7).",
        (q.roll_vector, q.roll_acceleration, q.sliding, q.axial_rates, *_CROWNINGS),
        ((q.relative_curvature, sp.Matrix([D[0, 0], D[0, 1], D[1, 1]])),),
        requires=(beta**2 - 1,),
        source="ease-off to second order, in the tangent plane",
    )


def prove_crowned_gap_is_that_of_its_curvature_at_the_ends_of_the_flank() -> None:
    """(27.7) xᵀ(D - w wᵀ/β_c)x/2 with x where cone distance and height are those of toe, heel, root and tip: with
    (26.3) taken off it is c_b, c_h, and at the corner of heel and tip c_b + c_h + c_w."""
    b, h, length, profile, bias = (one.symbol for one in _CROWNINGS)
    D = crowned()["relative_curvature"] - conjugate_curvature()["conjugate_curvature"]
    A, N = sp.Matrix([[D[0], D[1]], [D[1], D[2]]]), _on_gear()

    def gap(along: sp.Expr, up: sp.Expr) -> sp.Expr:
        x = N.inv() * sp.Matrix([along, up])
        return (x.T * A * x)[0] / 2

    for sign in (1, -1):
        assert is_zero(gap(sign * b / 2, sp.S.Zero) - length)
        assert is_zero(gap(sp.S.Zero, sign * h / 2) - profile)
        assert is_zero(gap(b / 2, sign * h / 2) - length - profile - sign * bias)


def prove_factors_are_those_of_sample_1() -> None:
    """(27.1) ISO 23509:2016, table F.2, 14 x 39 at 90°: 0.24737 and 0.0915, with 0.210 and 0.290."""
    ratio = sp.Rational(39, 14)
    pitch = sp.atan(1 / ratio)
    values = [ratio, 14, pitch, sp.pi / 2 - pitch, sp.Rational(21, 100), sp.Rational(29, 100)]
    with mpmath.workdps(DIGITS):
        addendum, thickness = suggested_factors().function(*numbers(values))
    assert abs(addendum - mpmath.mpf("0.24737")) < 5e-6
    assert abs(thickness - mpmath.mpf("0.0915")) < 5e-5


def prove_gear_lags_by_the_amplitude_half_a_pitch_from_the_vertex() -> None:
    """(27.2) m' φ²/2 at φ = π/z_1 is the amplitude, against the sense in which a lever of that sign is driven."""
    half = sp.pi / q.pinion_teeth.symbol
    error = wanted_parabola()["wanted_curvature"] * half**2 / 2
    for sign in (1, -1):
        assert is_zero(error.subs(q.signed_lever.symbol, 50 * sign) - sign * q.transmission_amplitude.symbol)


def prove_path_has_its_direction_on_the_gear() -> None:
    """(27.3) With D of (26.6) for that η, v_1 + v of (26.4) runs along η_2, and φ_2'' is m'."""
    w, beta, rho = [sp.Rational(5, 4), sp.Rational(1, 2)], 60, 70
    sliding, second, eta_2 = [3, -5], sp.Rational(-1, 400), sp.Rational(5, 4)
    with mpmath.workdps(DIGITS):
        (eta,) = path_on_pinion().function(*numbers([*w, beta, rho, *sliding, second, eta_2]))
        given = [*numbers([*w, beta, rho]), eta, *numbers([second, 6, sp.Rational(1, 150)])]
        D = synthesis().function(*given)
        one, other, found = contact_motion().function(*numbers([*w, beta]), *D, mpmath.mpf(rho))
        along, across = mpmath.cos(mpmath.mpf(5) / 4), mpmath.sin(mpmath.mpf(5) / 4)
        assert is_close([(one + 3) * across - (other - 5) * along], [0])
        assert is_close([found], numbers([second]))


def prove_gap_has_its_least_value_where_the_ease_off_has() -> None:
    """(27.4) At one lever the least E on the line of a φ is φ²/2c, c = gᵀA⁻¹g with g = w/β_c; and by (26.4) the exact
    parabola is 1/(c + 1/β_c): the one tends to the other as the gap gets small against the conjugate curvature."""
    w, beta = sp.Matrix(q.roll_vector.symbol), q.roll_acceleration.symbol
    a, b, d = sp.symbols("a b d", positive=True)
    A = sp.Matrix([[a, b], [b, d]])
    D = A + w * w.T / beta
    values = dict(zip(q.relative_curvature.symbols, (D[0, 0], D[0, 1], D[1, 1]), strict=True))
    E = wanted_gap()["ease_off"].subs(values, simultaneous=True).subs(q.signed_lever.symbol, q.lever_arm.symbol)
    (xi,) = sp.solve(sp.diff(E, q.along_tooth.symbol), q.along_tooth.symbol)
    c = ((w / beta).T * A.inv() * (w / beta))[0]
    assert is_zero(E.subs(q.along_tooth.symbol, xi) - q.pinion_rotation.symbol**2 / (2 * c))
    exact = contact_motion()["transmission_curvature"].subs(values, simultaneous=True) * q.lever_arm.symbol
    assert is_zero(exact - 1 / (c + 1 / beta))
