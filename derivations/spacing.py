"""Chapter 19. Spacing of the teeth: runout of a ball in a space, thickness of a tooth, and what is allowed of them.

A ball lies in a tooth space, middle at azimuth A (15.2), and is pressed into it along the normal m of the pitch cone,
m = (cos δ_0, 0, -sin δ_0) radially, around and along the axis at A, while the work is free to turn. It touches both
flanks at their reference points R, R', with outward normals n and n' and arms ℓ = n·(z_w × R), ℓ' alike. Flanks that
are by δ and δ' out of their places move it by Δ along m, and the work turns by ε:

    Δ m·n + ε ℓ = δ,   Δ m·n' + ε ℓ' = δ'                                                      (19.1)
    Δ = (δ ℓ' - δ' ℓ) / (m·n ℓ' - m·n' ℓ),   ε = (m·n δ' - m·n' δ) / (m·n ℓ' - m·n' ℓ)

Runout F_r is the range of Δ over the spaces. A space that is indexed wrongly by ε has Δ = 0; one that is too narrow by
δ on each flank, at the pressure angle α, has Δ = δ / sin α; one between like flanks of a gear that is eccentric by e
towards μ has Δ = e cos δ_0 cos(A - μ).
At the radius r of the reference points a flank makes its tooth thicker, along the circle, by

    E = δ r / |n·(z_w × R)|                                                                    (19.2)

and the tooth between two spaces is thicker by the sum of its flanks. With γ the angle between the two flanks of a
space, its arc and chord are, and its chord changes with its arc by

    s = r (2π/z - γ),   s_c = 2 r sin(s / 2r),   E_c = E_s cos(s / 2r)                         (19.3)

The spiral angle at the mean point follows from a flank's normal, by its parts along the pitch cone's generatrix g and
around the axis; from it the module, and the diameter at half the working depth:

    tan β = |n·g| / |n·e_t|,   m_mn = 2 R_m sin δ cos β / z                                    (19.4)
    d_T = 2 R_m sin δ + 2 (h_am - h_mw/2) cos δ,   h_mw = h_am + h_fm - c                      (19.5)

Tolerances of grade B in µm, m_mn and d_T in mm, not confirmed against the standard:

    f_ptT = (0.003 d_T + 0.3 m_mn + 5) √2^(B-4),   F_pT = (0.025 d_T + 0.3 m_mn + 19) √2^(B-4),   F_rT = 0.8 F_pT (19.6)
"""

from __future__ import annotations

from functools import cache

import mpmath
import sympy as sp

from derivations import blank
from derivations import notation as q
from derivations.expression import Expression
from derivations.frames import Rz
from derivations.proof import DIGITS, is_close, is_zero, numbers

#: Tolerances for m_mn = 4 and d_T = 170 that others computed, to 0.1 µm: grade, f_pt, F_p, F_r.
PUBLISHED_TOLERANCES = ((4, "6.7", "24.4", "19.6"), (6, "13.4", "48.9", "39.1"), (7, "19.0", "69.2", "55.3"))


def _lever(point: sp.Matrix, normal: sp.Matrix) -> sp.Expr:
    """n·(z_w × R)."""
    return point[0] * normal[1] - point[1] * normal[0]


def _cone_normal(azimuth: sp.Expr, angle: sp.Expr) -> sp.Matrix:
    """Normal of a cone about z_w at an azimuth, out of the cone."""
    return sp.Matrix([sp.cos(angle) * sp.cos(azimuth), sp.cos(angle) * sp.sin(azimuth), -sp.sin(angle)])


def _middle() -> tuple[sp.Matrix, sp.Expr]:
    """m of (19.1), times twice the radius of the middle of the space; and twice that radius."""
    x, y = (q.point_w.symbol[k] + q.opposite_w.symbol[k] for k in (0, 1))
    twice, delta = sp.sqrt(x**2 + y**2), q.pitch_angle.symbol
    return sp.Matrix([sp.cos(delta) * x, sp.cos(delta) * y, -sp.sin(delta) * twice]), twice


@cache
def ball_shift() -> Expression:
    """(19.1) as an Expression; both points are those of one space."""
    m, twice = _middle()
    n, other = sp.Matrix(q.normal_w.symbol), sp.Matrix(q.opposite_normal.symbol)
    arm, other_arm = _lever(q.point_w.symbol, n), _lever(q.opposite_w.symbol, other)
    d, e = q.deviation_in.symbol, q.opposite_deviation.symbol
    wedge = m.dot(n) * other_arm - m.dot(other) * arm
    return Expression(
        "ball_shift",
        "Movement, normal to the pitch cone, of a ball that touches both flanks of a space, and the turning (19.1).",
        (
            q.deviation_in,
            q.point_w,
            q.normal_w,
            q.opposite_deviation,
            q.opposite_w,
            q.opposite_normal,
            q.pitch_angle,
        ),
        (
            (q.cone_shift, twice * (d * other_arm - e * arm) / wedge),
            (q.space_turning, (m.dot(n) * e - m.dot(other) * d) / wedge),
        ),
        requires=(sp.Abs(wedge) - twice**2 / 20, twice - 1),
        source="runout test with a ball probe that floats in the space, moved normal to the pitch cone",
    )


@cache
def flank_allowance() -> Expression:
    """(19.2) as an Expression."""
    R, n = q.point_w.symbol, q.normal_w.symbol
    lever = sp.Abs(_lever(R, n))
    return Expression(
        "flank_allowance",
        "How much thicker one flank makes its tooth, along the circle through its point (19.2).",
        (q.deviation_in, q.point_w, q.normal_w),
        ((q.allowance, q.deviation_in.symbol * sp.sqrt(R[0] ** 2 + R[1] ** 2) / lever),),
        requires=(lever - 1,),
        source="(6.5) with the sign of metal left on",
    )


def _arc() -> tuple[sp.Expr, sp.Expr]:
    """s and r of (19.3)."""
    R, other = q.point_w.symbol, q.opposite_w.symbol
    radius = sp.sqrt(R[0] ** 2 + R[1] ** 2)
    angle = sp.atan2(sp.Abs(R[0] * other[1] - R[1] * other[0]), R[0] * other[0] + R[1] * other[1])
    return radius * (2 * sp.pi / q.teeth.symbol - angle), radius


@cache
def tooth_at_points() -> Expression:
    """(19.3) as an Expression."""
    s, radius = _arc()
    half = s / (2 * radius)
    return Expression(
        "tooth_at_points",
        "Arc and chord of a tooth at the points of the flanks of a space, and the chord's deviation (19.3).",
        (q.point_w, q.opposite_w, q.teeth, q.arc_deviation),
        (
            (q.tooth_arc, s),
            (q.tooth_chord, 2 * radius * sp.sin(half)),
            (q.chord_deviation, q.arc_deviation.symbol * sp.cos(half)),
        ),
        requires=(q.point_w.symbol[0] ** 2 + q.point_w.symbol[1] ** 2 - 1,),
        source="circle through points of equal radius and height",
    )


@cache
def mean_module() -> Expression:
    """(19.4) as an Expression."""
    delta, R, n = q.pitch_angle.symbol, q.point_w.symbol, q.normal_w.symbol
    radius = sp.sqrt(R[0] ** 2 + R[1] ** 2)
    along = (n[0] * R[0] + n[1] * R[1]) / radius * sp.sin(delta) + n[2] * sp.cos(delta)
    beta = sp.atan2(sp.Abs(along), sp.Abs(_lever(R, n)) / radius)
    module = 2 * q.mean_cone_distance.symbol * sp.sin(delta) * sp.cos(beta) / q.teeth.symbol
    return Expression(
        "mean_module",
        "Spiral angle and module at the mean point, from the normal of a flank there (19.4).",
        (q.pitch_angle, q.mean_cone_distance, q.teeth, q.point_w, q.normal_w),
        ((q.trace_angle, beta), (q.module_found, module)),
        requires=(radius - 1, sp.Abs(_lever(R, n)) - 1),
        source="trace of the flank on the pitch cone",
    )


@cache
def tolerance_diameter() -> Expression:
    """(19.5) as an Expression."""
    delta, added = q.pitch_angle.symbol, q.mean_addendum.symbol
    working = added + q.mean_dedendum.symbol - q.clearance.symbol
    value = 2 * q.mean_cone_distance.symbol * sp.sin(delta) + 2 * (added - working / 2) * sp.cos(delta)
    return Expression(
        "tolerance_diameter",
        "Diameter at half the working depth of the mean section (19.5).",
        (q.blank,),
        ((q.tolerance_diameter, value),),
        source="ISO 17485:2006 as quoted by others, unconfirmed",
    )


@cache
def spacing_tolerances() -> Expression:
    """(19.6) as an Expression."""
    d, m = q.tolerance_diameter.symbol, q.mean_normal_module.symbol
    step = 2 ** ((q.accuracy_grade.symbol - 4) / sp.Integer(2))
    share = 3 * m / 10
    cumulative = (d / 40 + share + 19) * step
    return Expression(
        "spacing_tolerances",
        "Tolerances of single pitch, cumulative pitch and runout, unrounded and unconfirmed (19.6).",
        (q.mean_normal_module, q.tolerance_diameter, q.accuracy_grade),
        (
            (q.single_pitch_tolerance, (3 * d / 1000 + share + 5) * step),
            (q.cumulative_pitch_tolerance, cumulative),
            (q.runout_tolerance, 4 * cumulative / 5),
        ),
        source="ISO 17485:2006 as quoted by others, unconfirmed",
    )


def prove_ball_stays_in_touch_with_both_flanks() -> None:
    """(19.1) The planes through R and R', moved with the turning work, meet the ball that went along m: both keep δ."""
    shift, (m, twice) = ball_shift(), _middle()
    eps = sp.Symbol("eps", real=True)
    for point, normal, deviation in (
        (q.point_w, q.normal_w, q.deviation_in),
        (q.opposite_w, q.opposite_normal, q.opposite_deviation),
    ):
        n = sp.Matrix(normal.symbol)
        swept = (Rz(eps) * sp.Matrix(point.symbol)).diff(eps).subs(eps, 0).dot(n)
        touched = shift["cone_shift"] * m.dot(n) / twice + shift["space_turning"] * swept
        assert sp.simplify(touched - deviation.symbol) == 0


def prove_indexing_moves_no_ball() -> None:
    """(19.1) Both flanks turned by ε about z_w, whatever their normals and places: Δ = 0, and ε is found."""
    eps, shift = sp.Symbol("eps", real=True), ball_shift()
    turned = {
        deviation.symbol: eps * _lever(point.symbol, normal.symbol)
        for point, normal, deviation in (
            (q.point_w, q.normal_w, q.deviation_in),
            (q.opposite_w, q.opposite_normal, q.opposite_deviation),
        )
    }
    assert sp.simplify(shift["cone_shift"].subs(turned)) == 0
    assert sp.simplify(shift["space_turning"].subs(turned) - eps) == 0


def prove_narrow_space_and_eccentric_gear_move_the_ball_as_stated() -> None:
    """(19.1) Flanks of one trace with pressure angles α, in a space so narrow that they meet at azimuth A."""
    alpha, beta, delta, r, a = sp.symbols("alpha beta delta r a", positive=True)
    A, mu, e = sp.symbols("A mu e", real=True)
    out, along = _cone_normal(A, delta), _cone_normal(A, delta - sp.pi / 2)
    around = sp.Matrix([-sp.sin(A), sp.cos(A), 0])
    across = sp.cos(beta) * around - sp.sin(beta) * along
    n, m = (sp.sin(alpha) * out + sign * sp.cos(alpha) * across for sign in (1, -1))
    R = sp.Matrix([r * sp.cos(A), r * sp.sin(A), 7])
    given = {q.pitch_angle.symbol: delta}
    for quantity, value in ((q.point_w, R), (q.opposite_w, R), (q.normal_w, n), (q.opposite_normal, m)):
        given |= dict(zip(quantity.symbols, value, strict=True))
    moved = ball_shift()["cone_shift"].subs(given, simultaneous=True)
    narrow = {q.deviation_in.symbol: a, q.opposite_deviation.symbol: a}
    assert sp.simplify(moved.subs(narrow) - a / sp.sin(alpha)) == 0
    offset = e * sp.Matrix([sp.cos(mu), sp.sin(mu), 0])
    eccentric = {q.deviation_in.symbol: offset.dot(n), q.opposite_deviation.symbol: offset.dot(m)}
    assert sp.simplify(moved.subs(eccentric) - e * sp.cos(delta) * sp.cos(A - mu)) == 0


def prove_allowance_is_the_arc_that_turns_the_flank() -> None:
    """(19.2) A flank turned by E/r leaves the deviation δ, in the sense in which its normal looks."""
    eps = sp.Symbol("eps", real=True)
    R, n = sp.Matrix(q.point_w.symbol), sp.Matrix(q.normal_w.symbol)
    radius = sp.sqrt(R[0] ** 2 + R[1] ** 2)
    rate = (Rz(eps) * R).diff(eps).subs(eps, 0).dot(n)
    turned = flank_allowance()["allowance"] / radius * sp.Abs(rate)
    assert sp.simplify(turned - q.deviation_in.symbol) == 0


def prove_arc_and_chord_are_those_of_the_circle() -> None:
    """(19.3) Flanks at azimuth 0 and γ, nine teeth: the next space begins at 40°; distance there, and its growth.

    A tooth thicker by a little at either end has a longer arc and chord: their ratio, by a difference of numbers.
    """
    with mpmath.workdps(DIGITS):
        r, step = mpmath.mpf(30), mpmath.mpf(10) ** -15

        def tooth(gamma: mpmath.mpf) -> tuple[mpmath.mpf, mpmath.mpf]:
            (x, y), (v, w) = ((r * mpmath.cos(a), r * mpmath.sin(a)) for a in (gamma, 2 * mpmath.pi / 9))
            return r * (2 * mpmath.pi / 9 - gamma), mpmath.hypot(x - v, y - w)

        gamma = mpmath.pi / 6
        other = r * mpmath.cos(gamma), r * mpmath.sin(gamma), mpmath.mpf(5)
        found = tooth_at_points().function(r, mpmath.mpf(0), mpmath.mpf(5), *other, mpmath.mpf(9), mpmath.mpf(1))
        assert is_close(found[:2], tooth(gamma))
        low, high = tooth(gamma + step), tooth(gamma - step)
        assert is_close(found[2:], [(high[1] - low[1]) / (high[0] - low[0])], mpmath.mpf(10) ** -20)


def prove_spiral_angle_does_not_depend_on_the_pressure_angle() -> None:
    """(19.4) Normals of flanks through the trace cos β g + sin β e_t: square to it, with any other direction across.

    Both flanks, both hands, at any azimuth of the point.
    """
    delta, azimuth, R = sp.Rational(3, 8), sp.Rational(7, 4), sp.Integer(60)
    generatrix, around = Rz(azimuth) * sp.Matrix([sp.sin(delta), 0, sp.cos(delta)]), Rz(azimuth) * sp.Matrix([0, 1, 0])
    for beta in (sp.Rational(5, 8), -sp.Rational(1, 4)):
        trace = sp.cos(beta) * generatrix + sp.sin(beta) * around
        for across in (sp.Matrix([5, 1, -2]), sp.Matrix([-2, 3, 7])):
            n = numbers(trace.cross(across))
            with mpmath.workdps(DIGITS):
                n = [component / mpmath.norm(n) for component in n]
                given = [*numbers([delta, R]), 17, *numbers(R * generatrix), *n]
                found, module = mean_module().function(*given)
                assert is_close([found], numbers([abs(beta)]))
                # pitch along the circle, square to the trace
                assert is_close([17 * module * mpmath.pi], numbers([2 * sp.pi * R * sp.sin(delta) * sp.cos(beta)]))


def prove_module_is_that_of_the_published_sample() -> None:
    """(19.4) ISO 23509:2016 sample 1: 14 teeth, d_m = 54.918, β_m = 35°, m_mn = 3.213 to its printed digits."""
    delta, beta, alpha = sp.atan(sp.Rational(14, 39)), sp.pi * 35 / 180, sp.pi / 9
    distance = sp.Rational(54918, 1000) / (2 * sp.sin(delta))
    generatrix = sp.Matrix([sp.sin(delta), 0, sp.cos(delta)])
    n = sp.cos(alpha) * (sp.cos(beta) * sp.Matrix([0, 1, 0]) - sp.sin(beta) * generatrix)
    n += sp.sin(alpha) * sp.Matrix([sp.cos(delta), 0, -sp.sin(delta)])
    given = {q.pitch_angle.symbol: delta, q.mean_cone_distance.symbol: distance, q.teeth.symbol: 14}
    given |= dict(zip(q.point_w.symbols, distance * generatrix, strict=True))
    given |= dict(zip(q.normal_w.symbols, n, strict=True))
    found = mean_module()
    assert abs(sp.N(found["trace_angle"].subs(given) - beta, 30)) < sp.Rational(1, 10**20)
    assert abs(sp.N(found["module_found"].subs(given), 30) - sp.Rational(3213, 1000)) < sp.Rational(5, 10_000)


def prove_tolerance_diameter_lies_at_half_the_working_depth() -> None:
    """(19.5) It is the radius (8.1) of the middle between tip and lower limit of the working depth, twice."""
    along = {q.across.symbol: sp.Rational(1, 2)}
    tip, limit = blank.addendum(), q.clearance.symbol - blank.dedendum()
    _, radius = blank.place((tip + limit) / 2)
    assert is_zero(2 * radius.subs(along) - tolerance_diameter()["tolerance_diameter"])


def prove_tolerances_are_those_of_the_self_check() -> None:
    """(19.6) m_mn = 4, d_T = 170: what others print for grades 4, 6 and 7, to half a unit of their last digit."""
    values = spacing_tolerances()
    for grade, *printed in PUBLISHED_TOLERANCES:
        given = {q.mean_normal_module.symbol: 4, q.tolerance_diameter.symbol: 170, q.accuracy_grade.symbol: grade}
        for (_, value), text in zip(values.outputs, printed, strict=True):
            assert abs(sp.N(value.subs(given)) - sp.Rational(text)) <= sp.Rational(5, 100) + sp.Rational(1, 10**9)
