"""Chapter 20. Compensation: what settings and motions do to a flank on a line and to its root, and what a mate feels.

The flank of other settings crosses a line P + t d at a point with the normal n. Whatever the cutting method,

    ∂t/∂x_k = n·R_k / (n·d)                     R_k = ∂R/∂x_k(θ) at fixed u, β, θ                 (20.1)
    ∂t/∂m_kj = θ^j ∂t/∂x_k                      the motion (10.1) of a machine setting            (20.2)

The root line is where the tip of the blade touches the flank: at the height zero, which on a curved blade is

    h(u) = u + σ(u) sin α = 0                                                                     (20.3)

at a cone distance L, its depth below the pitch cone D:  L = z_w cos δ + r_w sin δ,  D = z_w sin δ - r_w cos δ  (20.4)

A point G of a flank with the normal n meets the mate, whose axis a makes the shaft angle Σ with z_w, when its member
has turned by ψ: with M = G × n and m = √(M_x² + M_y²), the relative rotation ω = a + (z_m/z) z_w has no moment,

    ω·Rz(ψ) M = 0:   ψ = -atan2(M_y, M_x) ± acos(-(cos Σ + z_m/z) M_z / (m sin Σ))                 (20.5)
    place on the mate:   z_m = a·Rz(ψ) G,   r_m = |Rz(ψ) G - z_m a|                                (20.6)

where z_m, z are the teeth of mate and member. Both surfaces have their normal in common there: the envelope of a
flank that is displaced by δ along its normals is displaced by δ. So metal left on the flank does to the pair what as
much metal left on the mate does, at that place.
"""

from __future__ import annotations

from functools import cache
from operator import itemgetter

import mpmath
import sympy as sp

from derivations import cradle, flank, generation
from derivations import notation as q
from derivations.expression import Expression, Quantity
from derivations.frames import J, K, Rz, rotation
from derivations.generation import Profile
from derivations.proof import DIGITS, is_close, is_zero, numbers, shifts


def _rates(profile: Profile, *besides: sp.Symbol) -> tuple[list[sp.Matrix], sp.Expr]:
    """∂R/∂x_k for every setting and for what else the blade depends on, in the frame w before it turns, and φ_w.

    Both at settings still to be moved.

    The derivative by x_k is that by x_k(θ): they differ by what does not depend on x_k.
    """
    eta, off = q.blade_offset_angle.symbol, profile.radius - q.blade_point_radius.symbol
    in_plane = sp.Matrix([q.blade_point_radius.symbol + off * sp.cos(eta), off * sp.sin(eta), -profile.height])
    in_cutter = Rz(q.beta.symbol) * in_plane
    p = cradle.frame_w() * (cradle.apex_to_cutter() + cradle.cutter_to_machine(in_cutter))
    phi, axis = cradle.work_angle(), sp.Matrix(K)
    rates = [p.diff(x) - phi.diff(x) * axis.cross(p) for x in (*q.settings.symbols, *besides)]
    return rates, phi


def _sensitivity(name: str, description: str, profile: Profile, shift: Quantity, *extra: Quantity) -> Expression:
    """(20.1) of a blade as an Expression, by the settings and by the first of ``extra``."""
    rates, phi = _rates(profile, *(quantity.symbol for quantity in extra[:1]))
    back = Rz(phi + q.index_ratio.symbol * q.beta.symbol)  # out of the frame w before it turns
    n, d = sp.Matrix(q.normal_w.symbol), sp.Matrix(q.line_direction.symbol)
    unturned = back * n
    return Expression(
        name,
        description,
        (
            q.u,
            q.beta,
            q.theta,
            q.settings,
            q.index_ratio,
            q.blade_offset_angle,
            *extra,
            q.side,
            q.normal_w,
            q.line_direction,
        ),
        ((shift, sp.Matrix([unturned.dot(rate) / n.dot(d) for rate in rates])),),
        requires=(n.dot(d) ** 2 - sp.Rational(1, 100),),
        source="envelope theorem along a line: the shift of u, beta, theta stays in the surface",
    )


@cache
def straight_sensitivity() -> Expression:
    """(20.1) of a straight blade as an Expression; the settings are those at the cradle rotation (10.1)."""
    return _sensitivity(
        "straight_sensitivity",
        "Shift along a line of the flank that a straight blade cuts, per unit of each setting (20.1).",
        generation.straight(),
        q.sensitivity,
    )


@cache
def curved_sensitivity() -> Expression:
    """(20.1) of a curved blade as an Expression, by the settings and by the curvature of the blade."""
    return _sensitivity(
        "curved_sensitivity",
        "Shift along a line of the flank that a curved blade cuts, per unit of each setting and its curvature (20.1).",
        generation.curved(),
        q.curved_rates,
        q.blade_curvature,
        q.reference_height,
    )


@cache
def coefficient_sensitivity() -> Expression:
    """(20.2) as an Expression."""
    rows, columns = q.motion.shape
    theta, gradient = q.theta.symbol, q.setting_rates.symbol
    return Expression(
        "coefficient_sensitivity",
        "Shift of a flank along a line per unit of each coefficient of the motion (20.2).",
        (q.theta, q.setting_rates),
        ((q.motion_rates, sp.Matrix(rows, columns, lambda k, j: gradient[k] * theta ** (j + 1))),),
        source="chain rule through (10.1)",
    )


@cache
def curved_height() -> Expression:
    """(20.3) as an Expression."""
    return Expression(
        "curved_height",
        "Height above the tip plane of a point of a curved blade (20.3).",
        (q.u, q.blade_pressure_angle, q.blade_curvature, q.reference_height),
        ((q.curved_height, generation.curved().height),),
        source="(10.8)",
    )


@cache
def root_place() -> Expression:
    """(20.4) as an Expression."""
    delta = q.pitch_angle.symbol
    R = q.point_w.symbol
    r = sp.sqrt(R[0] ** 2 + R[1] ** 2)
    return Expression(
        "root_place",
        "Cone distance of a point and its depth below the pitch cone (20.4).",
        (q.point_w, q.pitch_angle),
        (
            (q.cone_place, R[2] * sp.cos(delta) + r * sp.sin(delta)),
            (q.cone_depth, R[2] * sp.sin(delta) - r * sp.cos(delta)),
        ),
        requires=(R[0] ** 2 + R[1] ** 2 - 1,),
        source="rotation of the axial plane by the pitch angle",
    )


def _mate_axis() -> sp.Matrix:
    sigma = q.shaft_angle.symbol
    return sp.Matrix([sp.sin(sigma), 0, sp.cos(sigma)])


@cache
def conjugate_place() -> Expression:
    """(20.5, 20.6) as an Expression; ``side`` takes the branch."""
    point, n, sigma = sp.Matrix(q.point_w.symbol), sp.Matrix(q.normal_w.symbol), q.shaft_angle.symbol
    moment = point.cross(n)
    across = sp.sqrt(moment[0] ** 2 + moment[1] ** 2)
    needed, greatest = -(sp.cos(sigma) + q.mate_ratio.symbol) * moment[2], across * sp.sin(sigma)
    psi = q.side.symbol * sp.acos(needed / greatest) - sp.atan2(moment[1], moment[0])
    # Rz(psi) G along the mate's axis and across it, from the turned point alone
    turned = Rz(psi) * point
    axial = _mate_axis().dot(turned)
    off = turned - axial * _mate_axis()
    return Expression(
        "conjugate_place",
        "Rotation at which a point of a flank meets the mate, and its place on the mate (20.5, 20.6).",
        (q.point_w, q.normal_w, q.shaft_angle, q.mate_ratio, q.side),
        (
            (q.meeting_angle, psi),
            (q.mate_axial, axial),
            (q.mate_radial, sp.sqrt(sum(component**2 for component in off))),
        ),
        requires=(greatest**2 * sp.Rational(99, 100) - needed**2, across**2 - 1),
        source="gear meshing of two fixed axes with a constant ratio, solved for the angle",
    )


def prove_rates_are_those_of_the_family_of_face_milling() -> None:
    """(20.1) Limit case: without motion and indexing, Rz(-φ_w) R_k is ∂R/∂x_k of (3.1), which (6.2) takes along n."""
    still = generation.still()
    rates, phi = _rates(generation.straight())
    point = flank.point()
    for setting, rate in zip(q.settings.symbols, rates, strict=True):
        assert is_zero(Rz(-phi) * rate.subs(still) - point.diff(setting)), setting.name


def prove_shift_along_a_line_is_that_of_the_flank_cut_anew() -> None:
    """(20.1) Every setting, and the curvature, moved, and the moving flank solved anew on a line aslant to the normal.

    With motion, indexing and blade offset; (20.1) has the settings as they stand at θ. A straight blade is κ = 0.
    """
    settings = [mpmath.mpf(x) for x in (75, 1, "0.125", "0.875", "3.5", "0.25", 1, "0.375", 3, "0.5", 80, "0.25")]
    motion = [mpmath.mpf(k % 7 - 3) / 2**10 for k in range(q.motion.size)]
    rest = [mpmath.mpf(x) for x in ("0.375", "0.25", "0.00390625", 1, 1)]
    given, family = [*settings, *motion, *rest], generation.curved_generation().function
    with mpmath.workdps(DIGITS):
        u, theta = mpmath.mpf(2), mpmath.mpf("0.125")
        at = u, mpmath.findroot(lambda beta: family(u, beta, theta, *given)[6], mpmath.mpf(-1)), theta
        value = family(*at, *given)
        point, normal = value[:3], value[3:6]
        line = [n + mpmath.mpf(k - 1) / 4 for k, n in enumerate(normal)]
        stand = _settings_at(settings, motion, theta)
        claimed = curved_sensitivity().function(*at, *stand, *rest, *normal, *line)
        which = [*range(len(settings)), len(settings) + len(motion) + 2]
        found = shifts(lambda *of: itemgetter(0, 1, 2, 6)(family(*of)), given, which, at, point, line)
        assert is_close(found, claimed, mpmath.mpf(10) ** -12)
        flat, side = [*rest[:2], mpmath.mpf(0), *rest[3:]], rest[-1:]
        straight = straight_sensitivity().function(*at, *stand, *rest[:2], *side, *normal, *line)
        assert is_close(straight, curved_sensitivity().function(*at, *stand, *flat, *normal, *line)[: len(settings)])


def _settings_at(settings: list[mpmath.mpf], motion: list[mpmath.mpf], theta: mpmath.mpf) -> list[mpmath.mpf]:
    """Settings as they stand at θ (10.1), term by term."""
    rows, columns = q.motion.shape
    moved = [sum(motion[k * columns + j] * theta ** (j + 1) for j in range(columns)) for k in range(rows)]
    return [x + by for x, by in zip(settings, moved + [mpmath.mpf(0)] * (len(settings) - rows), strict=True)]


def prove_motion_enters_through_the_moved_setting_alone() -> None:
    """(20.2) What moves by g_k with each setting x_k(θ) of (10.1), differentiated by each coefficient of the motion."""
    moving, rows = generation.moving_settings(), q.motion.symbol
    moved = sum(rate * value for rate, value in zip(q.setting_rates.symbols, moving.values(), strict=False))
    claimed = coefficient_sensitivity()["motion_rates"]
    assert all(value.diff(setting) == 1 for setting, value in moving.items())
    for k in range(rows.rows):
        for j in range(rows.cols):
            assert sp.expand(moved.diff(rows[k, j]) - claimed[k, j]) == 0


def prove_curvature_moves_the_blade_by_the_sagitta() -> None:
    """(20.1) At κ = 0, dR/dκ is t²/2 across the blade: in the plane of the axis, by (-s cos α, sin α) of (10.8)."""
    profile, kappa, alpha = generation.curved(), q.blade_curvature.symbol, q.blade_pressure_angle.symbol
    t = (q.u.symbol - q.reference_height.symbol) / sp.cos(alpha)
    straight = {kappa: 0}
    assert is_zero(profile.radius.diff(kappa).subs(straight) + q.side.symbol * t**2 / 2 * sp.cos(alpha))
    assert is_zero(profile.height.diff(kappa).subs(straight) - t**2 / 2 * sp.sin(alpha))


def prove_depth_and_cone_distance_are_a_rotation_of_the_axial_plane() -> None:
    """(20.4) L² + D² = z² + r², and a point of the pitch cone has the depth zero."""
    place = root_place()
    L, D = place["cone_place"], place["cone_depth"]
    R = q.point_w.symbol
    assert is_zero(L**2 + D**2 - (R[0] ** 2 + R[1] ** 2 + R[2] ** 2))
    s, delta = sp.Symbol("s", positive=True), q.pitch_angle.symbol
    on_cone = dict(zip(q.point_w.symbols, (s * sp.sin(delta), 0, s * sp.cos(delta)), strict=True))
    assert is_zero(D.subs(on_cone).subs(sp.Abs(sp.sin(delta)), sp.sin(delta)).replace(sp.Abs, lambda value: value))


def prove_point_meets_the_mate_without_moving_into_it() -> None:
    """(20.5, 20.6) Turned by ψ, neither member's motion has a part along the normal more than the other's.

    The mate turns about its axis once while the member turns z_m/z times the other way; its place is read in its own
    axes, which are turned about y by Σ.
    """
    sigma, ratio = sp.Rational(3, 2), sp.Rational(3, 2)
    G, n = sp.Matrix([30, 8, 75]), sp.Matrix([sp.Rational(1, 4), -sp.Rational(7, 8), sp.Rational(3, 8)])
    for branch in (1, -1):
        with mpmath.workdps(DIGITS):
            psi, axial, radial = conjugate_place().function(*numbers([*G, *n, sigma, ratio]), branch)
        turn = Rz(sp.Float(psi, DIGITS))
        at, along = turn * G, turn * n
        of_mate, of_member = _mate_axis().subs(q.shaft_angle.symbol, sigma).cross(at), -ratio * sp.Matrix(K).cross(at)
        assert is_close(numbers([(of_mate - of_member).dot(along)]), [0])
        own = rotation(sp.Matrix(J), -sigma) * at
        assert is_close(numbers([own[2], sp.sqrt(own[0] ** 2 + own[1] ** 2)]), [axial, radial])


def prove_relative_rotation_lies_along_the_pitch_line() -> None:
    """(20.5) On the common generatrix of the pitch cones, at δ from z_w with sin δ_m/sin δ = z_m/z, nothing slides."""
    sigma, delta = sp.symbols("Sigma delta", positive=True)
    along = sp.Matrix([sp.sin(delta), 0, sp.cos(delta)])
    ratio = sp.sin(sigma - delta) / sp.sin(delta)
    omega = sp.Matrix([sp.sin(sigma), 0, sp.cos(sigma)]) + ratio * sp.Matrix(K)
    assert is_zero(omega.cross(along))


def prove_height_of_a_curved_blade_is_that_of_its_foot_where_it_touches() -> None:
    """(20.3) At the reference height, and everywhere without curvature, h = u."""
    height, u = curved_height()["curved_height"], q.u.symbol
    assert is_zero(height.subs(u, q.reference_height.symbol) - q.reference_height.symbol)
    assert is_zero(height.subs(q.blade_curvature.symbol, 0) - u)
