"""Chapter 13. Tooth width: thickness and backlash to ISO 23509; slot width, top land and edge radius to AGMA 929.

    j_mn = j_en R_m cos β_m / (R_e cos β_e) = j_mt cos β_m cos α_n,  j_mt = j_et R_m / R_e     (13.1)
    x_sm1,2 = ±x_smn - j_mn / (4 m_mn cos α_n)                                                 (13.2)
    s_mn1,2 = m_mn (π/2 + 2 (x_sm1,2 ± x_hm1 tan α_n)),  α_n = (α_nD + α_nC)/2                 (13.3)
    s_mt = s_mn / cos β_m,  d_mn = d_m / ((1 - sin² β_m cos² α_n) cos δ)
    s_mnc = d_mn sin(s_mn/d_mn),  h_amc = h_am + d_mn cos δ (1 - cos(s_mn/d_mn)) / 2           (13.4)

At a cone distance R with the spiral angle β, ρ = R cos β / (R_m cos β_m), T = tan α_nD + tan α_nC, p_n = π m_mn,
h_f(R) = h_fm + (R - R_m) tan θ_f and the gap of the backlash along the pitch line g = p_n - s_mn1 - s_mn2:

    W_2 = p_n - s_mn2 - h_fm2 T - (1 - ρ) k_E p_n / 2                                          (13.5)
    W_1 = ρ p_n - (h_f1 + h_f2) T - W_2 + ρ g                                                  (13.6)
    s_n1 = W_2 + h_f2 T - ρ g,  s_n2 = W_1 + h_f1 T - ρ g,  j_n = ρ g cos α_n                  (13.7)
    Δc = j_n / (sin α_nD + sin α_nC)                                                           (13.8)
    r_np = R tan δ / cos² β,  r_a = r_np + h_a,  cos α_a = r_np cos α / r_a                    (13.9)
    s_an = r_a (s_n/r_np + Σ (inv α - inv α_a)), over both flanks                              (13.10)

The edge radius of the cutter is the smallest of three. At the toe the mate's tip, both gears brought together by Δc,
reaches the radius of curvature ϱ of the profile; the round of the edge must end below (13.11). Beside the flat Δ_f the
tip of the blade must hold the round (13.12). The opposite blade must not cut more than y into the fillet (13.13).

    ϱ = √((r + r' - Δc)² - ((r + r') cos α)²) - √((r' + h'_a)² - (r' cos α)²)
    h_inf = h_f + ϱ sin α - r sin² α,  r_a01 = h_inf / (1 - sin α)                             (13.11)
    W_B = W_min/2 + 0.025,  r_a02 = (W_B - Δ_f) / k,  k = (1 - sin α) / cos α                  (13.12)
    r_a03 = (y + w k + √(y² + 2 y w k)) / k²,  w = W_min - W_B                                 (13.13)
"""

from __future__ import annotations

from functools import cache

import mpmath
import sympy as sp

from derivations import cutter, iso23509, lengthwise
from derivations import notation as q
from derivations.expression import Expression
from derivations.proof import DIGITS, is_close, is_zero

_ISO = "ISO 23509, tooth thickness; relations derived here"
_AGMA = "AGMA 929, slot width, top land and cutter edge radius; relations derived here"
#: Overlap of inner and outer blade tips of a completing cutter [mm], so that no fin is left.
BLADE_OVERLAP = sp.Rational(25, 1000)


def pitch_factor() -> sp.Expr:
    """ρ: the normal pitch at a cone distance over that at the mean point."""
    here = q.cone_distance.symbol * sp.cos(q.spiral_angle.symbol)
    return here / (q.mean_cone_distance.symbol * sp.cos(q.mean_spiral_angle.symbol))


def mean_backlash() -> sp.Expr:
    """j_mn of every kind of backlash (13.1); heel: cone distance and spiral angle."""
    j, kind, beta = q.backlash.symbol, q.backlash_kind.symbol, q.mean_spiral_angle.symbol
    outward = q.mean_cone_distance.symbol / q.cone_distance.symbol
    transverse = j * sp.cos(beta) * sp.cos(iso23509.normal_angle())
    return sp.Piecewise(
        (j / pitch_factor(), sp.Eq(kind, 0)),
        (transverse * outward, sp.Eq(kind, 1)),
        (j, sp.Eq(kind, 2)),
        (transverse, True),
    )


@cache
def tooth_thickness() -> Expression:
    """(13.1-13.3) as an Expression."""
    m, alpha, jn = q.mean_normal_module.symbol, iso23509.normal_angle(), mean_backlash()
    shift, exchanged = q.profile_shift_coefficient.symbol * sp.tan(alpha), q.thickness_modification.symbol
    lost = jn / (4 * m * sp.cos(alpha))
    jt = jn / (sp.cos(q.mean_spiral_angle.symbol) * sp.cos(alpha))
    return Expression(
        "tooth_thickness",
        "Thickness of both teeth and backlash; cone distance and spiral angle are those of the heel (13.1-13.3).",
        (
            q.mean_normal_module,
            q.profile_shift_coefficient,
            q.thickness_modification,
            q.pressure_angle_drive,
            q.pressure_angle_coast,
            q.cone_distance,
            q.spiral_angle,
            q.mean_cone_distance,
            q.mean_spiral_angle,
            q.backlash,
            q.backlash_kind,
        ),
        (
            (q.mean_normal_pressure_angle, alpha),
            (q.mean_normal_backlash, jn),
            (q.outer_normal_backlash, jn * pitch_factor()),
            (q.mean_transverse_backlash, jt),
            (q.outer_transverse_backlash, jt * q.cone_distance.symbol / q.mean_cone_distance.symbol),
            (q.pinion_thickness_coefficient, exchanged - lost),
            (q.wheel_thickness_coefficient, -exchanged - lost),
            (q.pinion_mean_normal_thickness, m * (sp.pi / 2 + 2 * (exchanged - lost + shift))),
            (q.wheel_mean_normal_thickness, m * (sp.pi / 2 + 2 * (-exchanged - lost - shift))),
        ),
        source=_ISO,
    )


@cache
def chordal_tooth() -> Expression:
    """(13.4) as an Expression."""
    s, beta, delta = q.mean_normal_thickness.symbol, q.mean_spiral_angle.symbol, q.pitch_angle.symbol
    base = 1 - (sp.sin(beta) * sp.cos(q.mean_normal_pressure_angle.symbol)) ** 2
    diameter = q.mean_pitch_diameter.symbol / (base * sp.cos(delta))
    sagitta = diameter * sp.cos(delta) * (1 - sp.cos(s / diameter)) / 2
    return Expression(
        "chordal_tooth",
        "Thickness in the transverse plane and as a chord, with its height (13.4).",
        (
            q.mean_normal_thickness,
            q.mean_pitch_diameter,
            q.mean_spiral_angle,
            q.pitch_angle,
            q.mean_normal_pressure_angle,
            q.mean_addendum,
        ),
        (
            (q.mean_transverse_thickness, s / sp.cos(beta)),
            (q.mean_normal_diameter, diameter),
            (q.mean_normal_chordal_thickness, diameter * sp.sin(s / diameter)),
            (q.mean_chordal_addendum, q.mean_addendum.symbol + sagitta),
        ),
        source=_ISO,
    )


def tangents() -> sp.Expr:
    """T: how much a slot widens per height."""
    return sp.tan(q.pressure_angle_drive.symbol) + sp.tan(q.pressure_angle_coast.symbol)


def dedenda() -> tuple[sp.Expr, sp.Expr]:
    """h_f1 and h_f2 at the cone distance."""
    from_mean = q.cone_distance.symbol - q.mean_cone_distance.symbol
    return (
        q.pinion_mean_dedendum.symbol + from_mean * sp.tan(q.pinion_dedendum_angle.symbol),
        q.wheel_mean_dedendum.symbol + from_mean * sp.tan(q.wheel_dedendum_angle.symbol),
    )


@cache
def slot_widths() -> Expression:
    """(13.5-13.8) as an Expression."""
    pitch, T, widened = sp.pi * q.mean_normal_module.symbol, tangents(), pitch_factor()
    pinion_depth, wheel_depth = dedenda()
    mean = pitch - q.wheel_mean_normal_thickness.symbol - q.wheel_mean_dedendum.symbol * T
    gap = widened * (pitch - q.pinion_mean_normal_thickness.symbol - q.wheel_mean_normal_thickness.symbol)
    wheel = mean - (1 - widened) * q.slot_rotation_factor.symbol * pitch / 2
    pinion = widened * pitch - (pinion_depth + wheel_depth) * T - wheel + gap
    backlash = gap * sp.cos(iso23509.normal_angle())
    return Expression(
        "slot_widths",
        "Slot widths, thicknesses and backlash of the pair at a cone distance (13.5-13.8).",
        (
            q.cone_distance,
            q.spiral_angle,
            q.mean_cone_distance,
            q.mean_spiral_angle,
            q.mean_normal_module,
            q.pressure_angle_drive,
            q.pressure_angle_coast,
            q.pinion_mean_dedendum,
            q.wheel_mean_dedendum,
            q.pinion_dedendum_angle,
            q.wheel_dedendum_angle,
            q.pinion_mean_normal_thickness,
            q.wheel_mean_normal_thickness,
            q.slot_rotation_factor,
        ),
        (
            (q.normal_pitch, pitch),
            (q.pinion_slot_width, pinion),
            (q.wheel_slot_width, wheel),
            (q.pinion_normal_thickness, wheel + wheel_depth * T - gap),
            (q.wheel_normal_thickness, pinion + pinion_depth * T - gap),
            (q.normal_backlash, backlash),
            (
                q.clearance_change,
                backlash / (sp.sin(q.pressure_angle_drive.symbol) + sp.sin(q.pressure_angle_coast.symbol)),
            ),
        ),
        source=_AGMA,
    )


@cache
def virtual_gear() -> Expression:
    """r_np (13.9) as an Expression."""
    radius = q.cone_distance.symbol * sp.tan(q.pitch_angle.symbol) / sp.cos(q.spiral_angle.symbol) ** 2
    return Expression(
        "virtual_gear",
        "Pitch radius of the virtual spur gear in the normal section at a cone distance (13.9).",
        (q.cone_distance, q.pitch_angle, q.spiral_angle),
        ((q.virtual_pitch_radius, radius),),
        source=_AGMA,
    )


def involute(cosine: sp.Expr) -> sp.Expr:
    """inv α = tan α - α, from cos α."""
    return sp.sqrt(1 - cosine**2) / cosine - sp.acos(cosine)


@cache
def top_land() -> Expression:
    """(13.9, 13.10) as an Expression."""
    r = q.virtual_pitch_radius.symbol
    tip = r + q.addendum_here.symbol
    angle = q.normal_thickness.symbol / r
    for alpha in (q.pressure_angle_drive.symbol, q.pressure_angle_coast.symbol):
        angle += sp.tan(alpha) - alpha - involute(r * sp.cos(alpha) / tip)
    return Expression(
        "top_land",
        "Normal top land of a generated tooth (13.9, 13.10).",
        (
            q.virtual_pitch_radius,
            q.addendum_here,
            q.normal_thickness,
            q.pressure_angle_drive,
            q.pressure_angle_coast,
        ),
        ((q.top_land, tip * angle),),
        source=_AGMA,
    )


@cache
def running_interference() -> Expression:
    """(13.11) as an Expression."""
    r, mate, alpha = q.virtual_pitch_radius.symbol, q.mate_virtual_pitch_radius.symbol, q.flank_pressure_angle.symbol
    closed = (r + mate - q.clearance_change.symbol) ** 2 - ((r + mate) * sp.cos(alpha)) ** 2
    mate_tip = (mate + q.mate_addendum_here.symbol) ** 2 - (mate * sp.cos(alpha)) ** 2
    curvature = sp.sqrt(closed) - sp.sqrt(mate_tip)
    height = q.dedendum_here.symbol + curvature * sp.sin(alpha) - r * sp.sin(alpha) ** 2
    return Expression(
        "running_interference",
        "Largest edge radius whose fillet the tip of the mate clears (13.11).",
        (
            q.virtual_pitch_radius,
            q.mate_virtual_pitch_radius,
            q.mate_addendum_here,
            q.dedendum_here,
            q.clearance_change,
            q.flank_pressure_angle,
        ),
        ((q.interference_height, height), (q.edge_radius_interference, height / (1 - sp.sin(alpha)))),
        requires=(closed - (r + mate) ** 2 / 100,),
        source=_AGMA,
    )


def tip_share(alpha: sp.Expr) -> sp.Expr:
    """k: width of the blade's tip that a round of radius 1 takes."""
    return (1 - sp.sin(alpha)) / sp.cos(alpha)


@cache
def edge_radii() -> Expression:
    """(13.12, 13.13) as an Expression."""
    alpha, y, width = q.flank_pressure_angle.symbol, q.mutilation.symbol, q.minimum_slot_width.symbol
    k, point = tip_share(alpha), width / 2 + BLADE_OVERLAP
    over = (width - point) * k
    return Expression(
        "edge_radii",
        "Blade point of a completing cutter, and the edge radii that its tip and the other blade allow (13.12-13.13).",
        (q.minimum_slot_width, q.flank_pressure_angle, q.blade_flat, q.mutilation),
        (
            (q.blade_point_width, point),
            (q.edge_radius_fillet, sp.Max(0, point - q.blade_flat.symbol) / k),
            (q.edge_radius_mutilation, (y + over + sp.sqrt(y**2 + 2 * y * over)) / k**2),
        ),
        source=_AGMA,
    )


def prove_teeth_and_backlash_fill_the_pitch() -> None:
    """(13.1-13.3) s_mn1 + s_mn2 + j_mn / cos α_n = π m_mn, whatever backlash is given, and each is given back."""
    thickness, m = tooth_thickness(), q.mean_normal_module.symbol
    teeth = thickness["pinion_mean_normal_thickness"] + thickness["wheel_mean_normal_thickness"]
    gap = thickness["mean_normal_backlash"] / sp.cos(iso23509.normal_angle())
    kinds = ("outer_normal_backlash", "outer_transverse_backlash", "mean_normal_backlash", "mean_transverse_backlash")
    for kind, name in enumerate(kinds):
        given = {q.backlash_kind.symbol: kind}
        assert sp.expand((teeth + gap).subs(given) - sp.pi * m) == 0
        assert sp.simplify(thickness[name].subs(given) - q.backlash.symbol) == 0


def prove_chord_is_that_of_the_arc() -> None:
    """(13.4) Ends of the arc s on the diameter d: distance and sagitta; on the base cylinder
    cos² β_b = 1 - sin² β cos² α."""
    tooth, d, s = chordal_tooth(), sp.Symbol("d", positive=True), q.mean_normal_thickness.symbol
    diameter, delta, pitch = tooth["mean_normal_diameter"], q.pitch_angle.symbol, q.mean_pitch_diameter.symbol
    on_d = {pitch: d * pitch / diameter}  # the member whose normal section has the diameter d
    ends = [d / 2 * sp.Matrix([sp.cos(angle), sp.sin(angle)]) for angle in (s / d, -s / d)]
    chord = ends[0] - ends[1]
    assert is_zero(chord.dot(chord) - tooth["mean_normal_chordal_thickness"].subs(on_d) ** 2)
    sagitta = (tooth["mean_chordal_addendum"] - q.mean_addendum.symbol).subs(on_d)
    assert is_zero((d / 2 - ends[0][0]) * sp.cos(delta) - sagitta)
    beta, alpha = q.mean_spiral_angle.symbol, q.mean_normal_pressure_angle.symbol
    transverse = sp.tan(alpha) / sp.cos(beta)  # tan α_t
    squared = 1 / (1 + sp.tan(beta) ** 2 / (1 + transverse**2))  # cos² β_b, with tan β_b = tan β cos α_t
    assert sp.simplify(pitch / (squared * sp.cos(delta)) - diameter) == 0


def prove_slot_and_tooth_fill_the_pitch_along_the_face() -> None:
    """(13.5-13.7) At every place slot and tooth of each member fill ρ p_n; at the mean point teeth are as given."""
    widths, T = slot_widths(), tangents()
    pitch = pitch_factor() * widths["normal_pitch"]
    for member, depth in zip(("pinion", "wheel"), dedenda(), strict=True):
        filled = widths[f"{member}_slot_width"] + depth * T + widths[f"{member}_normal_thickness"]
        assert sp.expand(filled - pitch) == 0
    gap = pitch - widths["pinion_normal_thickness"] - widths["wheel_normal_thickness"]
    assert sp.simplify(gap * sp.cos(iso23509.normal_angle()) - widths["normal_backlash"]) == 0
    mean = {q.cone_distance.symbol: q.mean_cone_distance.symbol, q.spiral_angle.symbol: q.mean_spiral_angle.symbol}
    for member in ("pinion", "wheel"):
        given = getattr(q, f"{member}_mean_normal_thickness").symbol
        assert sp.simplify(widths[f"{member}_normal_thickness"].subs(mean) - given) == 0


def prove_duplex_taper_keeps_the_slots_of_constant_width() -> None:
    """(11.6) Without backlash W_1 + W_2 = ρ p_n - Σh_f T has slope 0 at the mean point, dedendum angles as tangents.

    (R cos β)² = R² - (R sin β)² has twice the slope of ρ at the mean point, times R_m² cos² β_m.
    """
    R, R_m, beta = q.cone_distance.symbol, q.mean_cone_distance.symbol, q.mean_spiral_angle.symbol
    squared = R**2 - (R * lengthwise.milled_sine()) ** 2
    widening = sp.diff(squared, R).subs(R, R_m) / (2 * R_m**2 * sp.cos(beta) ** 2)
    deepening = iso23509.duplex_sum() * 2 * sp.tan(iso23509.normal_angle())
    assert is_zero(sp.pi * q.mean_normal_module.symbol * widening - deepening)


def prove_top_land_is_what_two_involutes_leave() -> None:
    """(13.10) Without addendum it is the thickness itself, and it narrows there by tan α_nD + tan α_nC per height.

    At angles whose cosines are rational, because cos and arc cosine then cancel exactly.
    """
    land, h = top_land()["top_land"], q.addendum_here.symbol
    r, s = q.virtual_pitch_radius.symbol, q.normal_thickness.symbol
    angles = {
        q.pressure_angle_drive.symbol: sp.acos(sp.Rational(12, 13)),
        q.pressure_angle_coast.symbol: sp.acos(sp.Rational(24, 25)),
    }
    assert sp.simplify(land.subs(angles).subs(h, 0) - s) == 0
    slope = sp.diff(land.subs(angles), h).subs(h, 0)
    positive = sp.Symbol("r", positive=True)
    assert sp.simplify((slope - s / r + tangents().subs(angles)).subs(r, positive)) == 0


def prove_interference_height_is_that_of_the_point_that_the_tip_of_the_mate_reaches() -> None:
    """(13.11) Both gears drawn, brought together by Δc: the tip of the mate on the line that both base circles touch.

    The point of the flank as far from its base circle is cut by the rack at the pole distance r; the straight flank of
    the rack, at right angles to the line of action, touches it there. Below it, by the height, lies the rack's tip.
    """
    r, mate, addendum, dedendum, closer, alpha = map(mpmath.mpf, (40, 70, "2.5", 5, "0.125", "0.375"))
    with mpmath.workdps(DIGITS):
        cosine, sine = mpmath.cos(alpha), mpmath.sin(alpha)
        distance = r + mate - closer
        working = mpmath.acos((r + mate) * cosine / distance)
        tangency = [r * cosine * part for part in (-mpmath.sin(working), mpmath.cos(working))]
        along = mpmath.cos(working), mpmath.sin(working)

        def beyond_the_tip(way: mpmath.mpf) -> mpmath.mpf:
            x, y = (start + way * step for start, step in zip(tangency, along, strict=True))
            return x**2 + (y - distance) ** 2 - (mate + addendum) ** 2

        reached = mpmath.findroot(beyond_the_tip, r * sine)
        # the point on the line of action of rack and gear, from its tangency at the height r cos² α of the gear
        height = r * cosine**2 + reached * sine - (r - dedendum)
        found = running_interference().function(r, mate, addendum, dedendum, closer, alpha)
        assert is_close(found[:1], [height])
        edge = cutter.edge_round().function(mpmath.mpf(80), alpha, found[1], 0, 1)
        assert is_close(edge[3:], [height])  # there the round of the edge ends


def prove_round_of_the_edge_takes_its_share_of_tip_and_flank() -> None:
    """(13.11, 13.12) A round touching the tip k r_a0 from the corner touches the flank r_a0 (1 - sin α) above the tip.

    Corner in the origin, tip along -x, flank rising along (sin α, cos α): the centre has the distance r_a0 from both.
    """
    alpha, radius = q.flank_pressure_angle.symbol, sp.Symbol("r_a0", positive=True)
    center = radius * sp.Matrix([-tip_share(alpha), 1])
    outwards = sp.Matrix([sp.cos(alpha), -sp.sin(alpha)])  # square to the flank
    assert is_zero(center.dot(outwards) + radius)
    assert is_zero((center + radius * outwards)[1] - radius * (1 - sp.sin(alpha)))


def prove_mutilation_is_the_sagitta_of_the_round() -> None:
    """(13.13) The tip of the opposite blade overlaps the round by k r - w: (k r - w)² = 2 r y."""
    radii, alpha = edge_radii(), sp.asin(sp.Rational(5, 13))
    given = {q.flank_pressure_angle.symbol: alpha}
    radius, k = radii["edge_radius_mutilation"].subs(given), sp.Rational(2, 3)  # (1 - 5/13) / (12/13)
    w = q.minimum_slot_width.symbol - radii["blade_point_width"]
    assert sp.simplify(sp.expand((k * radius - w) ** 2 - 2 * radius * q.mutilation.symbol)) == 0
