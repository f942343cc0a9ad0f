"""Chapter 12. Lengthwise: how the spiral angle changes along the tooth, on the crown gear that the cutter describes.

    sin β = (2 R_m r_c0 sin β_m - R_m² + R²) / (2 R r_c0)                      face milling    (12.1)
    sin ν = z_0 m_mn / (2 r_c0),  ρ_P0² = R_m² + r_c0² - 2 R_m r_c0 sin(β_m - ν),
    ρ_b = ρ_P0 / (1 + z_0 sin δ_2 / z_2)                                       face hobbing    (12.2)
    tan β = (R - ρ_b cos φ) / (ρ_b sin φ),  cos φ = (R² + ρ_P0² - r_c0²) / (2 R ρ_P0)          (12.3)
    R_x² = R_m² - 2 R_m r_c0 sin β_m + 2 r_c0²                                                 (12.4)
    r_c0 = (R² - R_m²) / (2 (R sin β - R_m sin β_m))            (12.1) for the cutter of a face mill   (12.5)

On the plane of the crown gear, apex in the origin, the mean point is (R_m, 0). A face mill's trace is the circle about
C = (R_m - r_c0 sin β_m, r_c0 cos β_m). In face hobbing the cutter rolls on the base circle ρ_b, and the trace is square
to the line from the instant centre. At R_x the normal pitch is greatest: there the trace is an involute to first order.
"""

from __future__ import annotations

from functools import cache

import mpmath
import sympy as sp

from derivations import iso23509
from derivations import notation as q
from derivations.expression import Expression
from derivations.proof import DIGITS, is_close, is_zero

_SOURCE = "ISO 23509, inner and outer spiral angles; AGMA 929, lengthwise curvature"


def milled_sine() -> sp.Expr:
    """sin β at the cone distance R of a face-milled crown gear (12.1)."""
    R, R_m, r = q.cone_distance.symbol, q.mean_cone_distance.symbol, q.cutter_radius.symbol
    return (2 * R_m * r * sp.sin(q.mean_spiral_angle.symbol) - R_m**2 + R**2) / (2 * R * r)


@cache
def milled_spiral_angle() -> Expression:
    """(12.1) as an Expression."""
    return Expression(
        "milled_spiral_angle",
        "Spiral angle of a face-milled tooth at a cone distance (12.1).",
        (q.cone_distance, q.mean_cone_distance, q.mean_spiral_angle, q.cutter_radius),
        ((q.spiral_angle, sp.asin(milled_sine())),),
        requires=(sp.Rational(98, 100) - milled_sine() ** 2,),
        source=_SOURCE,
    )


def lead_sine() -> sp.Expr:
    """sin ν (12.2)."""
    module = iso23509.mean_module(q.mean_cone_distance.symbol, q.wheel_pitch_angle.symbol)
    return q.blade_groups.symbol * module / (2 * q.cutter_radius.symbol)


def center_distance_squared(lead: sp.Expr) -> sp.Expr:
    """ρ_P0² (12.2)."""
    R_m, r = q.mean_cone_distance.symbol, q.cutter_radius.symbol
    return R_m**2 + r**2 - 2 * R_m * r * sp.sin(q.mean_spiral_angle.symbol - lead)


def rolling_ratio() -> sp.Expr:
    """Turns of the crown gear per turn of the cutter, z_0 sin δ_2 / z_2 (12.2)."""
    return q.blade_groups.symbol * sp.sin(q.wheel_pitch_angle.symbol) / q.wheel_teeth.symbol


@cache
def hobbing_cutter() -> Expression:
    """(12.2) as an Expression."""
    center = sp.sqrt(center_distance_squared(sp.asin(lead_sine())))
    return Expression(
        "hobbing_cutter",
        "Place and lead of a face hobbing cutter, base circle of its epicycloid (12.2).",
        (
            q.mean_cone_distance,
            q.wheel_pitch_angle,
            q.mean_spiral_angle,
            q.wheel_teeth,
            q.blade_groups,
            q.cutter_radius,
        ),
        (
            (q.cutter_lead_angle, sp.asin(lead_sine())),
            (q.cutter_center_distance, center),
            (q.epicycloid_base_radius, center / (1 + rolling_ratio())),
        ),
        requires=(
            sp.Rational(98, 100) - lead_sine() ** 2,
            # the cutter must not stand on the apex; Min keeps the arc sine real where the line above fails
            center_distance_squared(sp.asin(sp.Min(lead_sine(), 1))) - 100,
        ),
        source=_SOURCE,
    )


def hobbed_cosine() -> sp.Expr:
    """cos φ (12.3), φ between the place and the cutter centre as seen from the apex."""
    R, center, r = q.cone_distance.symbol, q.cutter_center_distance.symbol, q.cutter_radius.symbol
    return (R**2 + center**2 - r**2) / (2 * R * center)


@cache
def hobbed_spiral_angle() -> Expression:
    """(12.3) as an Expression."""
    R, base = q.cone_distance.symbol, q.epicycloid_base_radius.symbol
    sine = sp.sqrt(1 - hobbed_cosine() ** 2)
    return Expression(
        "hobbed_spiral_angle",
        "Spiral angle of a face-hobbed tooth at a cone distance (12.3).",
        (q.cone_distance, q.cutter_radius, q.cutter_center_distance, q.epicycloid_base_radius),
        ((q.spiral_angle, sp.atan((R - base * hobbed_cosine()) / (base * sine))),),
        requires=(sp.Rational(98, 100) - hobbed_cosine() ** 2,),
        source=_SOURCE,
    )


@cache
def involute_curvature() -> Expression:
    """(12.4) as an Expression."""
    R_m, r = q.mean_cone_distance.symbol, q.cutter_radius.symbol
    squared = R_m**2 - 2 * R_m * r * sp.sin(q.mean_spiral_angle.symbol) + 2 * r**2
    return Expression(
        "involute_curvature",
        "Cone distance at which a face-milled tooth has the curvature of an involute (12.4).",
        (q.mean_cone_distance, q.mean_spiral_angle, q.cutter_radius),
        ((q.involute_cone_distance, sp.sqrt(squared)),),
        source=_SOURCE,
    )


@cache
def milled_radius() -> Expression:
    """(12.5) as an Expression."""
    R, R_m = q.cone_distance.symbol, q.mean_cone_distance.symbol
    difference = R * sp.sin(q.spiral_angle.symbol) - R_m * sp.sin(q.mean_spiral_angle.symbol)
    radius = (R**2 - R_m**2) / (2 * difference)
    return Expression(
        "milled_radius",
        "Cutter radius that gives a face-milled tooth this spiral angle at a cone distance (12.5).",
        (q.cone_distance, q.spiral_angle, q.mean_cone_distance, q.mean_spiral_angle),
        ((q.cutter_radius, radius),),
        requires=(sp.Abs(difference) - 1, radius - 1),
        source=_SOURCE,
    )


def prove_milled_radius_is_that_of_the_spiral_angle() -> None:
    """(12.5) Put into (12.1) it gives back sin β."""
    radius = milled_radius()["cutter_radius"]
    assert is_zero(milled_sine().subs(q.cutter_radius.symbol, radius) - sp.sin(q.spiral_angle.symbol))


def prove_milled_trace_is_the_circle_of_the_cutter() -> None:
    """(12.1) At every point Q of the circle the normal makes the angle with the cone line whose cosine is sin β.

    |Q| is R, so that (12.1) says 2 R r sin β = 2 (Q - C)·Q; at R = R_m it is β_m.
    """
    R_m, r, beta, t = q.mean_cone_distance.symbol, q.cutter_radius.symbol, q.mean_spiral_angle.symbol, sp.Symbol("t")
    center = sp.Matrix([R_m - r * sp.sin(beta), r * sp.cos(beta)])
    point = center + r * sp.Matrix([sp.cos(t), sp.sin(t)])
    numerator = (2 * q.cone_distance.symbol * r * milled_sine()).subs(q.cone_distance.symbol**2, point.dot(point))
    assert is_zero(sp.expand(numerator) - 2 * (point - center).dot(point))
    assert sp.simplify(milled_sine().subs(q.cone_distance.symbol, R_m) - sp.sin(beta)) == 0


def prove_hobbed_spiral_angle_is_that_of_the_rolling_blade() -> None:
    """(12.3) The velocity of a blade against the crown gear, at places that are given by φ instead of R.

    The cutter turns about C = (ρ_P0, 0), the crown gear about the apex against it by the rolling ratio; r_c0 = |P - C|.
    """
    center, ratio = mpmath.mpf(90), mpmath.mpf("0.1875")
    for R, phi in ((70, "0.75"), (80, "1.0"), (100, "0.875")):
        with mpmath.workdps(DIGITS):
            cosine, sine = mpmath.cos(mpmath.mpf(phi)), mpmath.sin(mpmath.mpf(phi))
            x, y = R * cosine, R * sine
            velocity = -y - ratio * y, (x - center) + ratio * x
            radial, around = (velocity[0] * u + velocity[1] * v for u, v in ((cosine, sine), (-sine, cosine)))
            radius = mpmath.hypot(x - center, y)
            found = hobbed_spiral_angle().function(mpmath.mpf(R), radius, center, center / (1 + ratio))
            assert is_close(found, [mpmath.atan(around / -radial)])


def prove_hobbed_trace_has_the_mean_spiral_angle_at_the_mean_point() -> None:
    """(12.2, 12.3) With r sin ν = R_m cos β_m z_0 sin δ_2 / z_2, the line from the instant centre has slope tan β_m.

    The centre C stands at r (-sin(β_m - ν), cos(β_m - ν)) from the mean point, the instant centre at C ρ_b / ρ_P0.
    """
    R_m, r, beta = q.mean_cone_distance.symbol, q.cutter_radius.symbol, q.mean_spiral_angle.symbol
    lead = sp.Symbol("nu", real=True)
    assert sp.simplify(lead_sine() * r - R_m * sp.cos(beta) * rolling_ratio()) == 0
    center = sp.Matrix([R_m - r * sp.sin(beta - lead), r * sp.cos(beta - lead)])
    assert is_zero(center.dot(center) - center_distance_squared(lead))
    ratio = r * sp.sin(lead) / (R_m * sp.cos(beta))
    line = sp.Matrix([R_m, 0]) - center / (1 + ratio)
    assert is_zero(line[0] / -line[1] - sp.tan(beta))


def prove_hobbing_without_indexing_is_milling() -> None:
    """(12.1-12.3) Limit case z_0 = 0: ρ_b = ρ_P0, ν = 0, and sin β of (12.3) is that of (12.1)."""
    R, r, base = q.cone_distance.symbol, q.cutter_radius.symbol, q.epicycloid_base_radius.symbol
    assert rolling_ratio().subs(q.blade_groups.symbol, 0) == 0
    assert lead_sine().subs(q.blade_groups.symbol, 0) == 0
    cosine, squared = sp.Symbol("C", real=True), center_distance_squared(sp.S.Zero)
    across, along = R - base * cosine, base**2 * (1 - cosine**2)
    of_cosine = {cosine: hobbed_cosine().subs(q.cutter_center_distance.symbol, base)}
    assert sp.simplify((across**2 + along).subs(of_cosine) - r**2) == 0  # the line from C is a radius of the cutter
    sine = sp.expand((across / r).subs(of_cosine)).subs(base**2, squared)
    assert sp.simplify(sine - milled_sine()) == 0


def prove_normal_pitch_is_greatest_at_the_involute_distance() -> None:
    """(12.4) R cos β, to which the normal pitch is proportional, is stationary at R_x; its slope at R_m is known."""
    R, R_m, beta = q.cone_distance.symbol, q.mean_cone_distance.symbol, q.mean_spiral_angle.symbol
    squared = R**2 - (R * milled_sine()) ** 2
    slope = sp.diff(squared, R) / 2  # R cos β times its slope
    at = {R: involute_curvature()["involute_cone_distance"]}
    assert sp.simplify(slope.subs(at)) == 0
    known = R_m * sp.cos(beta) * (1 - R_m * sp.sin(beta) / q.cutter_radius.symbol) / sp.cos(beta)
    assert sp.simplify(slope.subs(R, R_m) - known) == 0
