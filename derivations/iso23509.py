"""Chapter 11. The blank of a spiral bevel pair to ISO 23509, method 0: no hypoid offset, one common pitch apex.

    tan δ_1 = sin Σ / (u + cos Σ),  δ_2 = Σ - δ_1,  u = z_2/z_1                                (11.1)
    R_e = d_e2 / (2 sin δ_2),  R_m = R_e - c_be b,  c_be = 1/2,  R_i = R_e - b,  d_e2 = z_2 m_et   (11.2)
    m_mn = 2 R_m sin δ_2 cos β_m / z_2                                                         (11.3)
    k_hap = k_d/2,  k_hfp = k_d (k_c + 1/2),  x_hm1 = k_d (1/2 - c_ham),  x_smn = k_t/2        (11.4)
    h_am1,2 = m_mn (k_hap ± x_hm1),  h_fm1,2 = m_mn (k_hfp ∓ x_hm1),  c = m_mn (k_hfp - k_hap)  (11.5)
    Σθ_f: uniform depth 0;  standard S = atan(h_fm1/R_m) + atan(h_fm2/R_m);  tilted root line min(D, 1.3 S);
    duplex D = π/2 · m_mn (1 - R_m sin β_m / r_c0) / (R_m tan α_n cos² β_m)                    (11.6)
    θ_a2 = Σθ_f h_am2/h_mw  (standard: atan(h_fm1/R_m)),  θ_f2 = Σθ_f - θ_a2                   (11.7)
    δ_a2 = δ_2 + θ_a2,  δ_f2 = δ_2 - θ_f2,  δ_a1 = Σ - δ_f2,  δ_f1 = Σ - δ_a2,
    θ_a1 = θ_f2,  θ_f1 = θ_a2                                                                  (11.8)
    t_zF2 = (h_am2 cos θ_a2 - R_m sin θ_a2) / sin δ_a2,  t_zR2 = (R_m sin θ_f2 - h_fm2 cos θ_f2) / sin δ_f2,
    t_zF1 = -(t_zR2 sin δ_f2 + c) / sin δ_a1,  t_zR1 = -(t_zF2 sin δ_a2 + c) / sin δ_f1        (11.9)
    h_t1 = (t_zF1 + t_xo1) sin(δ_a1 - δ_f1) / cos δ_a1 - (t_zR1 - t_zF1) sin δ_f1              (11.10)

Depths and diameters at the ends are the places (8.1, 8.2) of chapter 8 at ξ = 0 and 1 (11.11). The clearance of (11.9)
is square to the root cone, that of (11.5) square to the pitch cone; so the face cone that t_zF1 describes and the one
through h_am1 are parallel and c (1 - cos θ_f2) apart, a few µm. The standard has both; gearmath builds on h_am1.
"""

from __future__ import annotations

from functools import cache

import sympy as sp

from derivations import blank
from derivations import notation as q
from derivations.expression import Expression, Quantity
from derivations.proof import is_close, is_zero, numbers

_SOURCE = "ISO 23509, method 0; relations derived here from the geometry of the pitch cones"
_HALF = sp.Rational(1, 2)
#: c_be, the part of the face width that lies outside the mean point.
FACE_WIDTH_FACTOR = _HALF
#: How many times the sum of dedendum angles of the standard taper a tilted root line may have.
TILT_LIMIT = sp.Rational(13, 10)


def pitch_angles() -> tuple[sp.Expr, sp.Expr]:
    """δ_1 and δ_2 (11.1)."""
    ratio = sp.sympify(q.wheel_teeth.symbol) / q.pinion_teeth.symbol
    pinion = sp.atan(sp.sin(q.shaft_angle.symbol) / (ratio + sp.cos(q.shaft_angle.symbol)))
    return pinion, q.shaft_angle.symbol - pinion


def mean_module(cone_distance: sp.Expr, wheel_angle: sp.Expr) -> sp.Expr:
    """m_mn (11.3)."""
    return 2 * cone_distance * sp.sin(wheel_angle) * sp.cos(q.mean_spiral_angle.symbol) / q.wheel_teeth.symbol


@cache
def wheel_size() -> Expression:
    """d_e2 from the outer module (11.2) as an Expression."""
    return Expression(
        "wheel_size",
        "Outer pitch diameter of the wheel from its module (11.2).",
        (q.wheel_teeth, q.outer_transverse_module),
        ((q.wheel_outer_pitch_diameter, q.wheel_teeth.symbol * q.outer_transverse_module.symbol),),
        source=_SOURCE,
    )


@cache
def pitch_cones() -> Expression:
    """(11.1-11.3) as an Expression."""
    pinion, wheel = pitch_angles()
    d_e2, b = q.wheel_outer_pitch_diameter.symbol, q.face_width.symbol
    outer = d_e2 / (2 * sp.sin(wheel))
    mean = outer - FACE_WIDTH_FACTOR * b
    return Expression(
        "pitch_cones",
        "Pitch cones of the pair and their modules (11.1-11.3).",
        (q.shaft_angle, q.pinion_teeth, q.wheel_teeth, q.wheel_outer_pitch_diameter, q.face_width, q.mean_spiral_angle),
        (
            (q.gear_ratio, sp.sympify(q.wheel_teeth.symbol) / q.pinion_teeth.symbol),
            (q.pinion_pitch_angle, pinion),
            (q.wheel_pitch_angle, wheel),
            (q.outer_cone_distance, outer),
            (q.mean_cone_distance, mean),
            (q.inner_cone_distance, outer - b),
            (q.outer_transverse_module, d_e2 / q.wheel_teeth.symbol),
            (q.mean_normal_module, mean_module(mean, wheel)),
        ),
        requires=(q.wheel_teeth.symbol - q.pinion_teeth.symbol + _HALF, outer - b),
        source=_SOURCE,
    )


@cache
def crown_gear_factors() -> Expression:
    """Data type II in data type I (11.4) as an Expression."""
    k_d = q.tooth_depth_factor.symbol
    return Expression(
        "crown_gear_factors",
        "Basic crown gear (data type I) from depth, clearance, addendum and thickness factors (data type II) (11.4).",
        (q.tooth_depth_factor, q.clearance_factor, q.mean_addendum_factor, q.thickness_factor),
        (
            (q.crown_gear_addendum_factor, k_d / 2),
            (q.crown_gear_dedendum_factor, k_d * (q.clearance_factor.symbol + _HALF)),
            (q.profile_shift_coefficient, k_d * (_HALF - q.mean_addendum_factor.symbol)),
            (q.thickness_modification, q.thickness_factor.symbol / 2),
        ),
        source=_SOURCE,
    )


@cache
def mean_depths() -> Expression:
    """(11.5) as an Expression."""
    m, x = q.mean_normal_module.symbol, q.profile_shift_coefficient.symbol
    up, down = q.crown_gear_addendum_factor.symbol, q.crown_gear_dedendum_factor.symbol
    return Expression(
        "mean_depths",
        "Addendum, dedendum and clearance at the mean point (11.5).",
        (q.mean_normal_module, q.crown_gear_addendum_factor, q.crown_gear_dedendum_factor, q.profile_shift_coefficient),
        (
            (q.mean_working_depth, 2 * m * up),
            (q.pinion_mean_addendum, m * (up + x)),
            (q.pinion_mean_dedendum, m * (down - x)),
            (q.wheel_mean_addendum, m * (up - x)),
            (q.wheel_mean_dedendum, m * (down + x)),
            (q.clearance, m * (down - up)),
            (q.mean_whole_depth, m * (up + down)),
        ),
        source=_SOURCE,
    )


def normal_angle() -> sp.Expr:
    """α_n, the mean of both sides."""
    return (q.pressure_angle_drive.symbol + q.pressure_angle_coast.symbol) / 2


def standard_sum() -> sp.Expr:
    """Σθ_f of the standard taper (11.6)."""
    R_m = q.mean_cone_distance.symbol
    return sp.atan(q.pinion_mean_dedendum.symbol / R_m) + sp.atan(q.wheel_mean_dedendum.symbol / R_m)


def duplex_sum() -> sp.Expr:
    """Σθ_f of the duplex taper, constant slot width (11.6)."""
    R_m, beta, alpha = q.mean_cone_distance.symbol, q.mean_spiral_angle.symbol, normal_angle()
    curvature = 1 - R_m * sp.sin(beta) / q.cutter_radius.symbol
    return sp.pi / 2 * q.mean_normal_module.symbol * curvature / (R_m * sp.tan(alpha) * sp.cos(beta) ** 2)


@cache
def taper_angles() -> Expression:
    """(11.6, 11.7) as an Expression."""
    taper, sums = q.depth_taper.symbol, (standard_sum(), duplex_sum())
    total = sp.Piecewise(
        (0, sp.Eq(taper, 0)),
        (sums[0], sp.Eq(taper, 1)),
        (sums[1], sp.Eq(taper, 2)),
        (sp.Min(sums[1], TILT_LIMIT * sums[0]), True),
    )
    own = sp.atan(q.pinion_mean_dedendum.symbol / q.mean_cone_distance.symbol)
    share = total * q.wheel_mean_addendum.symbol / q.mean_working_depth.symbol
    addendum = sp.Piecewise((own, sp.Eq(taper, 1)), (share, True))
    return Expression(
        "taper_angles",
        "Addendum and dedendum angle of the wheel by the taper of the depth (11.6, 11.7).",
        (
            q.depth_taper,
            q.mean_cone_distance,
            q.mean_spiral_angle,
            q.cutter_radius,
            q.pressure_angle_drive,
            q.pressure_angle_coast,
            q.mean_normal_module,
            q.pinion_mean_dedendum,
            q.wheel_mean_dedendum,
            q.wheel_mean_addendum,
            q.mean_working_depth,
        ),
        (
            (q.dedendum_angle_sum, total),
            (q.wheel_addendum_angle, addendum),
            (q.wheel_dedendum_angle, total - addendum),
        ),
        source=_SOURCE + "; tapers as in its annex C",
    )


@cache
def cone_angles() -> Expression:
    """(11.8) as an Expression."""
    shaft, delta = q.shaft_angle.symbol, q.wheel_pitch_angle.symbol
    face, root = delta + q.wheel_addendum_angle.symbol, delta - q.wheel_dedendum_angle.symbol
    return Expression(
        "cone_angles",
        "Face and root angles: each face cone runs along the root cone of the mate (11.8).",
        (q.shaft_angle, q.wheel_pitch_angle, q.wheel_addendum_angle, q.wheel_dedendum_angle),
        (
            (q.wheel_face_angle, face),
            (q.wheel_root_angle, root),
            (q.pinion_face_angle, shaft - root),
            (q.pinion_root_angle, shaft - face),
            (q.pinion_addendum_angle, q.wheel_dedendum_angle.symbol),
            (q.pinion_dedendum_angle, q.wheel_addendum_angle.symbol),
        ),
        source=_SOURCE,
    )


def wheel_apexes() -> tuple[sp.Expr, sp.Expr]:
    """t_zF2 and t_zR2 (11.9)."""
    R_m, up, down = q.mean_cone_distance.symbol, q.wheel_addendum_angle.symbol, q.wheel_dedendum_angle.symbol
    face = q.wheel_mean_addendum.symbol * sp.cos(up) - R_m * sp.sin(up)
    root = R_m * sp.sin(down) - q.wheel_mean_dedendum.symbol * sp.cos(down)
    delta = q.wheel_pitch_angle.symbol
    return face / sp.sin(delta + up), root / sp.sin(delta - down)


@cache
def cone_apexes() -> Expression:
    """(11.9) as an Expression."""
    delta, c = q.wheel_pitch_angle.symbol, q.clearance.symbol
    face_angle, root_angle = delta + q.wheel_addendum_angle.symbol, delta - q.wheel_dedendum_angle.symbol
    face, root = wheel_apexes()
    shaft = q.shaft_angle.symbol
    return Expression(
        "cone_apexes",
        "Apexes of face and root cones beyond the crossing point (11.9).",
        (
            q.shaft_angle,
            q.wheel_pitch_angle,
            q.wheel_addendum_angle,
            q.wheel_dedendum_angle,
            q.mean_cone_distance,
            q.wheel_mean_addendum,
            q.wheel_mean_dedendum,
            q.clearance,
        ),
        (
            (q.wheel_face_apex, face),
            (q.wheel_root_apex, root),
            (q.pinion_face_apex, -(root * sp.sin(root_angle) + c) / sp.sin(shaft - root_angle)),
            (q.pinion_root_apex, -(face * sp.sin(face_angle) + c) / sp.sin(shaft - face_angle)),
        ),
        requires=(shaft - face_angle - sp.Rational(1, 20),),
        source=_SOURCE,
    )


@cache
def pinion_depth() -> Expression:
    """(11.10) as an Expression."""
    face, root = q.pinion_face_angle.symbol, q.pinion_root_angle.symbol
    to_face, to_root = q.pinion_face_apex.symbol, q.pinion_root_apex.symbol
    beyond = (to_face + q.crossing_point_to_crown.symbol) * sp.sin(face - root) / sp.cos(face)
    return Expression(
        "pinion_depth",
        "Whole depth of the pinion at its crown, square to the root cone (11.10).",
        (q.pinion_face_angle, q.pinion_root_angle, q.pinion_face_apex, q.pinion_root_apex, q.crossing_point_to_crown),
        ((q.pinion_root_normal_depth, beyond - (to_root - to_face) * sp.sin(root)),),
        requires=(sp.cos(face) - sp.Rational(1, 20),),
        source=_SOURCE,
    )


def _at(expression: sp.Expr, across: sp.Expr) -> sp.Expr:
    return expression.subs(q.across.symbol, across)


def _end(across: sp.Expr, tip: Quantity, depths: tuple[Quantity, ...], diameters: tuple[Quantity, ...]) -> list[tuple]:
    """Depths, diameters on pitch, tip and root, and the axial place of the tip, at one end of the tooth."""
    up, down = _at(blank.addendum(), across), _at(blank.dedendum(), across)
    heights = (sp.S.Zero, up, -down)
    places = [tuple(_at(value, across) for value in blank.place(height)) for height in heights]
    return [
        *zip(depths, (up, down, up + down), strict=True),
        *((diameter, 2 * radius) for diameter, (_, radius) in zip(diameters, places, strict=True)),
        (tip, places[1][0]),
    ]


@cache
def blank_ends() -> Expression:
    """(11.11) as an Expression."""
    axial, radial = (_at(value, _HALF) for value in blank.place(sp.S.Zero))
    outer = (q.outer_addendum, q.outer_dedendum, q.outer_whole_depth)
    inner = (q.inner_addendum, q.inner_dedendum, q.inner_whole_depth)
    heel = (q.outer_pitch_diameter, q.outer_tip_diameter, q.outer_root_diameter)
    toe = (q.inner_pitch_diameter, q.inner_tip_diameter, q.inner_root_diameter)
    return Expression(
        "blank_ends",
        "Depths, diameters and distances along the axis at heel, mean point and toe of one member (11.11).",
        (q.blank,),
        (
            *_end(sp.S.One, q.crossing_point_to_crown, outer, heel),
            *_end(sp.S.Zero, q.crossing_point_to_front_crown, inner, toe),
            (q.mean_pitch_diameter, 2 * radial),
            (q.crossing_point_to_mean_point, axial),
        ),
        source=_SOURCE,
    )


def prove_pitch_cones_roll_without_sliding() -> None:
    """(11.1) z_2 sin δ_1 = z_1 sin δ_2: at every cone distance both pitch circles have the same speed, for any Σ."""
    pinion, wheel = pitch_angles()
    difference = q.wheel_teeth.symbol * sp.sin(pinion) - q.pinion_teeth.symbol * sp.expand_trig(sp.sin(wheel))
    assert sp.simplify(difference) == 0
    assert sp.simplify(pinion + wheel - q.shaft_angle.symbol) == 0


def prove_mean_point_lies_on_both_pitch_cones() -> None:
    """(11.1-11.3) The point at R_m, δ_1 from the pinion's axis, is z m_mn / (2 cos β_m) away from both axes."""
    cones = pitch_cones()
    R, module, beta = cones["mean_cone_distance"], cones["mean_normal_module"], q.mean_spiral_angle.symbol
    delta, shaft = sp.Symbol("delta_1", real=True), q.shaft_angle.symbol
    point = sp.Matrix([sp.cos(delta), sp.sin(delta)])
    from_pinion_axis = sp.Matrix([0, 1]).dot(point)
    from_wheel_axis = sp.Matrix([sp.sin(shaft), -sp.cos(shaft)]).dot(point)
    for distance, teeth in ((from_pinion_axis, q.pinion_teeth.symbol), (from_wheel_axis, q.wheel_teeth.symbol)):
        radius = (teeth * module / (2 * sp.cos(beta)) / R).subs(delta, pitch_angles()[0])
        assert sp.simplify(sp.expand_trig(radius - distance.subs(delta, pitch_angles()[0]))) == 0


def prove_working_depth_is_shared_and_whole_depths_are_equal() -> None:
    """(11.5) h_am1 + h_am2 = h_mw, each dedendum is the mate's addendum and c, both members are equally deep."""
    depths = mean_depths()
    addenda = [depths["pinion_mean_addendum"], depths["wheel_mean_addendum"]]
    dedenda = [depths["pinion_mean_dedendum"], depths["wheel_mean_dedendum"]]
    assert sp.expand(sum(addenda) - depths["mean_working_depth"]) == 0
    for own, mate in zip(dedenda, reversed(addenda), strict=True):
        assert sp.expand(own - mate - depths["clearance"]) == 0
    for up, down in zip(addenda, dedenda, strict=True):
        assert sp.expand(up + down - depths["mean_whole_depth"]) == 0


def prove_data_types_agree() -> None:
    """(11.4, 11.5) Of data type II come h_mw = k_d m_mn, c = k_c h_mw and h_am2 = c_ham h_mw, as its factors say."""
    factors, depths = crown_gear_factors(), mean_depths()
    values = {quantity.symbol: factors[quantity.name] for quantity, _ in factors.outputs}
    working = q.tooth_depth_factor.symbol * q.mean_normal_module.symbol
    assert sp.expand(depths["mean_working_depth"].subs(values) - working) == 0
    assert sp.expand(depths["clearance"].subs(values) - q.clearance_factor.symbol * working) == 0
    assert sp.expand(depths["wheel_mean_addendum"].subs(values) - q.mean_addendum_factor.symbol * working) == 0


def prove_standard_taper_runs_to_the_pitch_apex() -> None:
    """(11.6-11.9) With the standard taper the root cone of the wheel has its apex in the pitch apex.

    That of the pinion, found over the face cone of the wheel, is c (1 - cos θ_a2) off: c is measured across the root
    cone, the dedendum across the pitch cone.
    """
    R_m, standard = q.mean_cone_distance.symbol, {q.depth_taper.symbol: 1}
    angles, apexes = taper_angles(), cone_apexes()
    for shaft in (sp.Rational(3, 2), sp.Rational(5, 4)):
        depths = {
            R_m: 80,
            q.pinion_mean_dedendum.symbol: 3,
            q.wheel_mean_dedendum.symbol: 5,
            q.clearance.symbol: 1,
            q.wheel_mean_addendum.symbol: 2,
            q.shaft_angle.symbol: shaft,
            q.wheel_pitch_angle.symbol: sp.Rational(7, 8),
        }
        names = (q.wheel_addendum_angle, q.wheel_dedendum_angle)
        tapered = {each.symbol: angles[each.name].subs(standard).subs(depths) for each in names}
        wheel, pinion = (apexes[name].subs(tapered).subs(depths) for name in ("wheel_root_apex", "pinion_root_apex"))
        up = tapered[q.wheel_addendum_angle.symbol]
        off_root_line = pinion * sp.sin(shaft - sp.Rational(7, 8) - up)
        assert is_close(numbers([wheel, off_root_line]), numbers([0, sp.cos(up) - 1]))


def prove_face_and_root_cones_are_parallel_and_the_clearance_is_constant() -> None:
    """(11.8, 11.9) In the plane of the axes each face line is parallel to the mate's root line, at the distance c.

    The pinion's axis is x; the wheel's has the direction (cos Σ, sin Σ). An apex beyond the crossing point lies at -t_z
    along its axis. The published form of (11.8), over Σ - 90°, is the same.
    """
    angles, apexes, shaft = cone_angles(), cone_apexes(), q.shaft_angle.symbol
    wheel_axis = sp.Matrix([sp.cos(shaft), sp.sin(shaft)])
    for cone, mate, to_cone, to_mate in (
        ("pinion_face_angle", "wheel_root_angle", "pinion_face_apex", "wheel_root_apex"),
        ("pinion_root_angle", "wheel_face_angle", "pinion_root_apex", "wheel_face_apex"),
    ):
        along = sp.Matrix([sp.cos(angles[cone]), sp.sin(angles[cone])])
        along_mate = sp.Matrix([sp.cos(shaft - angles[mate]), sp.sin(shaft - angles[mate])])
        assert is_zero(along - along_mate)
        between = -apexes[to_cone] * sp.Matrix([1, 0]) + apexes[to_mate] * wheel_axis
        assert is_zero(between[0] * along[1] - between[1] * along[0] - q.clearance.symbol)
        excess = shaft - sp.pi / 2
        published = sp.sin(excess) * sp.sin(angles[mate]) + sp.cos(excess) * sp.cos(angles[mate])
        assert is_zero(sp.expand_trig(published) - sp.sin(angles[cone]))


def prove_depth_of_the_pinion_is_the_distance_of_the_crown_from_the_root_cone() -> None:
    """(11.10) The crown lies on the face line; its distance from the root line is a cross product."""
    face, root, x = q.pinion_face_angle.symbol, q.pinion_root_angle.symbol, q.crossing_point_to_crown.symbol
    radius = (x + q.pinion_face_apex.symbol) * sp.tan(face)
    distance = radius * sp.cos(root) - (x + q.pinion_root_apex.symbol) * sp.sin(root)
    assert is_zero(pinion_depth()["pinion_root_normal_depth"] - distance)
