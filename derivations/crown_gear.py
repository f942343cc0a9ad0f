"""Chapter 14. The imaginary crown gear: settings with which a member is cut rightly at its mean point.

Apex in the machine centre. At θ = 0 the mean point M stands on the pitch cone, θ_f = δ - Γ under the machine plane:

    M = R_m g,   g = [cos θ_f, 0, -sin θ_f],   p = [-sin θ_f, 0, -cos θ_f]   out of the pitch cone   (14.1)
    R_a = cos θ_f / sin δ:   (k - R_a V_p) × g = 0                                             (14.2)

g is the instantaneous axis of cradle and work, so that M meshes whatever the direction of the normal there. A blade
that cuts one flank alone has at M the normal of spiral angle ψ and pressure angle α_n, on a cutter of any axis V_c:

    d = sin ψ g - cos ψ j,   n = -s cos α_n d + sin α_n p                                      (14.3)
    sin α = -n · V_c,   e = -s (n + sin α V_c)/cos α,   u = -h_fm p · V_c                      (14.4)
    V_ls = M - r_c0 e + u V_c = S [cos q, sin q, 0] - X_b k                                    (14.5)

A cutter with V_c = k that cuts both flanks has in their middle an upright wall of spiral angle ψ. Its direction e at
M follows from the motion of the blade against the work, r_c0 k × e - ι V_p × M; lead angle ν = a - a_0:

    e = [sin a, -cos a, 0],   tan a_0 = tan ψ / cos θ_f
    sin ν = ι R_m sin δ cos θ_f cos ψ / (r_c0 √(cos² θ_f cos² ψ + sin² ψ))                     (14.6)

ι < 0, cutter and crown gear rolling on each other from outside, is the epicycloid of (12.2); ι = 0 is face milling.
The blade stands square to its path if η = -ν. Milled flanks have their pressure angles only about a wall that is square
to the pitch cone, not upright: it is the flank of (14.3-14.5) for α_n = 0, and leans by the angle ω of its blade,
sin ω = sin ψ sin θ_f. A flank is half the width w of the space from the wall if its blade has

    r_p = r_c0 + s (w/2 cos ω - (u + s w/2 sin ω) tan α)/cos η                                 (14.7)

All this is a right-hand member; the left-hand one has -q, -η and the swivel π - j. A Formate member is the same, with
the cradle held at θ = 0.
"""

from __future__ import annotations

from functools import cache

import mpmath
import sympy as sp

from derivations import cradle, lengthwise
from derivations import notation as q
from derivations.expression import Expression
from derivations.frames import J, K
from derivations.proof import DIGITS, is_close, is_zero, numbers

_SOURCE = "imaginary crown gear; ISO 23509 crown gear for the epicycloid"
_turn = q.cradle_angle.symbol


def _below() -> sp.Expr:
    """θ_f: the pitch line under the machine plane."""
    return q.pitch_angle.symbol - q.machine_root_angle.symbol


def generatrix() -> sp.Matrix:
    """g (14.1)."""
    return sp.Matrix([sp.cos(_below()), 0, -sp.sin(_below())])


def outwards() -> sp.Matrix:
    """p, normal of the pitch cone at the mean point, out of the member (14.1)."""
    return sp.Matrix([-sp.sin(_below()), 0, -sp.cos(_below())])


def mean_point() -> sp.Matrix:
    """M (14.1)."""
    return q.mean_cone_distance.symbol * generatrix()


def ratio_of_roll() -> sp.Expr:
    """R_a (14.2)."""
    return sp.cos(_below()) / sp.sin(q.pitch_angle.symbol)


def flank_normal() -> sp.Matrix:
    """n (14.3) of a right-hand member."""
    psi, alpha, side = q.mean_spiral_angle.symbol, q.flank_pressure_angle.symbol, q.side.symbol
    across = sp.sin(psi) * generatrix() - sp.cos(psi) * sp.Matrix(J)
    return -side * sp.cos(alpha) * across + sp.sin(alpha) * outwards()


def tilted_axis() -> sp.Matrix:
    """V_c of a cutter tilted by i, where swivel and cradle angle together are the direction χ of the tilt."""
    tilt, direction = q.cutter_tilt.symbol, q.tilt_direction.symbol
    return sp.Matrix([sp.sin(direction) * sp.sin(tilt), -sp.cos(direction) * sp.sin(tilt), sp.cos(tilt)])


def _other_hand(angle: sp.Expr) -> sp.Expr:
    return q.hand_sign.symbol * angle


@cache
def crown_gear_roll() -> Expression:
    """(14.2) as an Expression."""
    return Expression(
        "crown_gear_roll",
        "Ratio of roll of a member and its crown gear (14.2).",
        (q.pitch_angle, q.machine_root_angle),
        ((q.ratio_of_roll, ratio_of_roll()),),
        source=_SOURCE,
    )


@cache
def crown_gear_flank() -> Expression:
    """(14.2-14.5) as an Expression."""
    V_c, n, side, r = tilted_axis(), flank_normal(), q.side.symbol, q.cutter_radius.symbol
    sine = -n.dot(V_c)
    e = -side * (n + sine * V_c) / sp.sqrt(1 - sine**2)
    height = -q.mean_dedendum.symbol * outwards().dot(V_c)
    center = mean_point() - r * e + height * V_c
    swing = sp.atan2(center[1], center[0])
    hand = q.hand_sign.symbol
    return Expression(
        "crown_gear_flank",
        "Settings of a cut of one flank that has spiral and pressure angle at the mean point (14.2-14.5).",
        (
            q.hand_sign,
            q.side,
            q.mean_spiral_angle,
            q.flank_pressure_angle,
            q.cutter_radius,
            q.mean_cone_distance,
            q.pitch_angle,
            q.machine_root_angle,
            q.mean_dedendum,
            q.cutter_tilt,
            q.tilt_direction,
        ),
        (
            (q.radial_distance, sp.sqrt(center[0] ** 2 + center[1] ** 2)),
            (q.cradle_angle, _other_hand(swing)),
            (q.cutter_swivel, (1 - hand) * sp.pi / 2 + hand * (q.tilt_direction.symbol - swing)),
            (q.sliding_base, -center[2]),
            (q.ratio_of_roll, ratio_of_roll()),
            (q.blade_pressure_angle, sp.asin(sine)),
            (q.u, height),
        ),
        requires=(sp.Rational(9, 10) - sine**2, center[0] ** 2 + center[1] ** 2 - 1),
        source=_SOURCE,
    )


def _wall() -> tuple[sp.Expr, sp.Expr]:
    """a_0 and sin ν (14.6)."""
    psi, below = q.mean_spiral_angle.symbol, sp.cos(_below())
    along, over = below * sp.cos(psi), sp.sin(psi)
    indexing = q.index_ratio.symbol * q.mean_cone_distance.symbol * sp.sin(q.pitch_angle.symbol)
    return sp.atan2(over, along), indexing * along / (q.cutter_radius.symbol * sp.sqrt(along**2 + over**2))


@cache
def crown_gear_space() -> Expression:
    """(14.2, 14.5, 14.6) as an Expression."""
    start, sine = _wall()
    lead = sp.asin(sine)
    e = sp.Matrix([sp.sin(start + lead), -sp.cos(start + lead), 0])
    height = -q.mean_dedendum.symbol * outwards()[2]
    center = mean_point() - q.cutter_radius.symbol * e + height * sp.Matrix(K)
    return Expression(
        "crown_gear_space",
        "Settings of an untilted cut of both flanks, milled or hobbed, about the mean point (14.2, 14.5, 14.6).",
        (
            q.hand_sign,
            q.mean_spiral_angle,
            q.cutter_radius,
            q.mean_cone_distance,
            q.pitch_angle,
            q.machine_root_angle,
            q.mean_dedendum,
            q.index_ratio,
        ),
        (
            (q.radial_distance, sp.sqrt(center[0] ** 2 + center[1] ** 2)),
            (q.cradle_angle, _other_hand(sp.atan2(center[1], center[0]))),
            (q.sliding_base, -center[2]),
            (q.ratio_of_roll, ratio_of_roll()),
            (q.blade_offset_angle, _other_hand(-lead)),
            (q.u, height),
        ),
        requires=(sp.Rational(9, 10) - sine**2, center[0] ** 2 + center[1] ** 2 - 1),
        source=_SOURCE,
    )


def point_radius() -> sp.Expr:
    """r_p (14.7)."""
    off = _half_width() * sp.cos(q.wall_angle.symbol) - _flank_height() * sp.tan(q.blade_pressure_angle.symbol)
    return q.cutter_radius.symbol + q.side.symbol * off / sp.cos(q.blade_offset_angle.symbol)


def _half_width() -> sp.Expr:
    return q.space_width.symbol / 2


def _flank_height() -> sp.Expr:
    """Height above the tip plane where the flank is square beside the mean point."""
    return q.u.symbol + q.side.symbol * _half_width() * sp.sin(q.wall_angle.symbol)


@cache
def blade_in_space() -> Expression:
    """(14.7) as an Expression."""
    return Expression(
        "blade_in_space",
        "Point radius of the blade whose flank is half the width of the space from its middle (14.7).",
        (
            q.cutter_radius,
            q.space_width,
            q.u,
            q.blade_pressure_angle,
            q.blade_offset_angle,
            q.side,
            q.wall_angle,
        ),
        ((q.blade_point_radius, point_radius()),),
        source="distances along the normal of the path, in the plane of the blade",
    )


def prove_mean_point_lies_on_the_pitch_cone() -> None:
    """(14.1) M is at R_m from the apex, at the angle δ against the work axis of (2.1)."""
    M, R_m = mean_point(), q.mean_cone_distance.symbol
    assert is_zero(M.dot(M) - R_m**2)
    assert is_zero(M.dot(cradle.work_axis()) - R_m * sp.cos(q.pitch_angle.symbol))
    assert is_zero(outwards().dot(M))
    assert is_zero(outwards().dot(outwards()) - 1)


def prove_mean_point_meshes_with_every_normal() -> None:
    """(14.2) The velocity k × M - R_a V_p × M of (4.1) vanishes, and so does f for every blade and axis."""
    relative = (sp.Matrix(K) - ratio_of_roll() * cradle.work_axis()).cross(mean_point())
    assert is_zero(relative)


def prove_the_normal_has_pressure_and_spiral_angle() -> None:
    """(14.3) n · p = sin α_n, n is a unit vector, and the trace in the pitch plane makes ψ with the cone line."""
    n, psi = flank_normal(), q.mean_spiral_angle.symbol
    trace = sp.cos(psi) * generatrix() + sp.sin(psi) * sp.Matrix(J)
    for side in (1, -1):
        at = n.subs(q.side.symbol, side)
        assert is_zero(at.dot(at) - 1)
        assert is_zero(at.dot(outwards()) - sp.sin(q.flank_pressure_angle.symbol))
        assert is_zero(at.dot(trace))


def prove_swivel_gives_the_tilted_axis_and_its_mirror_image() -> None:
    """(14.4) V_c of (2.2) is that of the tilt; with the settings of the other hand it is mirrored in y."""
    j = q.cutter_swivel.symbol
    direction = {q.tilt_direction.symbol: j + _turn}
    axis = cradle.cutter_axis().subs(q.theta.symbol, 0)
    wanted = tilted_axis().subs(direction)
    assert is_zero(axis - wanted)
    mirrored = axis.subs({j: sp.pi - j, _turn: -_turn}, simultaneous=True)
    assert is_zero(mirrored - sp.Matrix([wanted[0], -wanted[1], wanted[2]]))


def prove_settings_bring_the_blade_to_the_mean_point_with_its_normal() -> None:
    """(14.3-14.5) The cutter of chapters 1 and 2 at these settings has M on its cone, and there the normal n.

    M is seen from the cutter: along its axis, and across it. The other hand is the mirror image, in y.
    """
    r, tilt = 76, sp.Float("0.125", DIGITS)
    tooth = [sp.Float(value, DIGITS) for value in ("0.625", "0.375", r, 81, "0.375", "0.3125", 4, tilt, "1.75")]
    for hand in (1, -1):
        mirror = sp.diag(1, hand, 1)
        for side in (1, -1):
            rule = crown_gear_flank()
            inputs = dict(zip([each.symbol for each in rule.inputs], (hand, side, *tooth), strict=True))
            with mpmath.workdps(DIGITS):
                found = rule.function(hand, side, *(mpmath.mpf(str(value)) for value in tooth))
            S, swing, swivel, X_b, _, blade, u = (sp.Float(value, DIGITS) for value in found)
            stands = {q.theta.symbol: 0, q.cradle_angle.symbol: swing, q.cutter_swivel.symbol: swivel}
            V_c = cradle.cutter_axis().subs(stands | {q.cutter_tilt.symbol: tilt})
            center = sp.Matrix([S * sp.cos(swing), S * sp.sin(swing), -X_b])
            from_center = mirror * mean_point().subs(inputs) - center
            across = from_center - from_center.dot(V_c) * V_c
            assert is_close(numbers([from_center.dot(V_c), across.dot(across)]), numbers([-u, r**2]))
            n = -side * sp.cos(blade) * across / r - sp.sin(blade) * V_c  # of (1.2)
            assert is_close(numbers(n), numbers(mirror * flank_normal().subs(inputs)))


def prove_the_wall_follows_the_motion_of_the_blade() -> None:
    """(14.6) Blade velocity against the work, cutter axis and the trace of spiral angle ψ lie in one plane."""
    psi, lead = q.mean_spiral_angle.symbol, sp.Symbol("nu", real=True)
    along, over = sp.cos(_below()) * sp.cos(psi), sp.sin(psi)
    length = sp.Symbol("L", positive=True)
    sine, cosine = over / length, along / length  # of a_0, with L² = along² + over²
    sin_a = sine * sp.cos(lead) + cosine * sp.sin(lead)
    cos_a = cosine * sp.cos(lead) - sine * sp.sin(lead)
    r, R_m = q.cutter_radius.symbol, q.mean_cone_distance.symbol
    iota = r * length * sp.sin(lead) / (R_m * sp.sin(q.pitch_angle.symbol) * along)
    blade = r * sp.Matrix(K).cross(sp.Matrix([sin_a, -cos_a, 0])) - iota * cradle.work_axis().cross(mean_point())
    trace = sp.cos(psi) * generatrix() + sp.sin(psi) * sp.Matrix(J)
    volume = sp.Matrix.hstack(blade, sp.Matrix(K), trace).det()
    over_square = sp.expand(volume * length * along).subs(length**2, along**2 + over**2)
    assert is_zero(over_square)


def prove_uniform_depth_gives_the_epicycloid_of_the_standard() -> None:
    """(14.6) Limit case Γ = δ: ν of (12.2) with the opposite sign, and S is the centre distance ρ_P0 of (12.2)."""
    z, psi, lead = q.wheel_teeth.symbol, q.mean_spiral_angle.symbol, sp.Symbol("nu", real=True)
    same = {q.machine_root_angle.symbol: q.pitch_angle.symbol, q.index_ratio.symbol: -q.blade_groups.symbol / z}
    standard = lengthwise.lead_sine().subs(q.wheel_pitch_angle.symbol, q.pitch_angle.symbol)
    _, sine = _wall()
    assert sp.simplify(sine.subs(same) + standard) == 0
    r, R_m = q.cutter_radius.symbol, q.mean_cone_distance.symbol
    center = sp.Matrix([R_m - r * sp.sin(psi - lead), r * sp.cos(psi - lead)])
    assert is_zero(center.dot(center) - lengthwise.center_distance_squared(lead))


def prove_the_flanks_are_half_the_width_from_the_middle() -> None:
    """(14.7) The point of (10.4) beside the mean point is s w/2 from the wall: along the plane of the blade, and where
    the wall leans, up or down with its normal."""
    eta, side, omega = q.blade_offset_angle.symbol, q.side.symbol, q.wall_angle.symbol
    off = side * _flank_height() * sp.tan(q.blade_pressure_angle.symbol)
    from_wall = sp.Matrix([point_radius() + off * sp.cos(eta) - q.cutter_radius.symbol, off * sp.sin(eta)])
    along = from_wall.dot(sp.Matrix([sp.cos(eta), sp.sin(eta)]))
    up = _flank_height() - q.u.symbol
    assert is_zero(along - side * _half_width() * sp.cos(omega))
    for sign in (1, -1):
        assert is_zero((along**2 + up**2 - _half_width() ** 2).subs(side, sign))


def prove_the_middle_of_a_space_square_to_the_pitch_cone_leans_by_the_blade_of_no_pressure_angle() -> None:
    """(14.3, 14.4) sin ω = -n · k = sin ψ sin θ_f of the convex flank with α_n = 0."""
    n = flank_normal().subs({q.flank_pressure_angle.symbol: 0, q.side.symbol: -1})
    assert is_zero(-n.dot(sp.Matrix(K)) - sp.sin(q.mean_spiral_angle.symbol) * sp.sin(_below()))
