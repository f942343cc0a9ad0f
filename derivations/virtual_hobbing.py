"""Chapter 30. Virtual hobbing: what one gash of a hob leaves on a flank, and what all of them together leave.

Frames as in chapter 9: the gear's axis is z; the hob stands at +x, its axis a along y turned by η of (9.5) about x,
p = a × (-x). The hob is an involute worm of k starts, hand s_h, whose thickness on the reference cylinder r_0 = d_0/2
is half its pitch. In its axial plane, at the height h above r_0, the flank σ of its thread (+1 towards a) is at

    p_0 = m_n k/(2 cos λ),   tan α_0 = tan α_n/sin λ,   r_b0 = r_0 cos α_0,   cos α_0(h) = r_b0/(r_0 + h)      (30.1)
    y = s_h p_0 ϑ + σ [p_0 (π/(2k) + inv α_0 - inv α_0(h)) - w_e]                              (30.2)

Its gashes lie in planes of its axis, so that (30.2) is a cutting edge. The rounding of its tip, radius ρ_a0, falls
short of the flank by w_e. A gash c passes the common perpendicular when the hob has turned by ψ_c = 2π c/n_i; its
thread R, numbered along the hob, then stands at ϑ = 2π (R/k - c/n_i). At the turn ψ = ψ_c + τ an edge is in space at

    P = (r + x m_n + r_0, 0, Z + v τ) + (r_0 + h)(-cos τ x + sin τ p) + y a + D                (30.3)

D is whatever hob and gear are displaced against each other. The table stands at -s_h (k/z) ψ - s_β 2π Z/L + Δφ, so
that thread R cuts the space s_h R mod z, in whose frame the edge is at the radius ρ, the height Z and the angle

    θ = atan2(P_y, P_x) + s_h (k/z)(τ - ϑ) - s_β (2π/L)(P_z - Z - v τ) - Δφ                    (30.4)

from its middle, unscrewed to the height of the hob. Involute helicoids are parallel surfaces: the edge lies off the
flank σ of the gear (+1 bounds the space towards growing angles) by δ along its normal, at the foot L_0, z_0,

    δ = (d_b/2) cos β_b (π/(2z) - 2x tan α_n/z - inv α_t + inv α(ρ) - σ θ)                     (30.5)
    L_0 = √(ρ² - d_b²/4) - δ cos β_b,   z_0 = P_z - σ s_β δ sin β_b                            (30.6)

where tan α(ρ) = √(ρ² - d_b²/4)/(d_b/2) and L_0 is the length of roll. δ of the gear at a foot is the least over all
gashes, threads and turns of the table: metal that one of them has cut is gone. Δφ changes θ alone, so it adds
σ (d_b/2) cos β_b Δφ to δ.

With ideal motion δ is nowhere less than 0, and 0 on the line of action. It goes along the normal n of the flank

    n = (cos β_b sin α_t, -σ cos β_b cos α_t, σ s_β sin β_b)                                   (30.7)

through the pitch line of gear and rack, x = r, y = 0, and through that of rack and hob, the line along a through
x = r + x m_n. Its point of roll length L gives the height z_c, and h, τ and ϑ of the edge that touches there (30.8).

Between neighboring gashes stay ridges of the height δ_y: at the roll length L of a spur gear

    δ_y = L (π k/(z n_i))²/2,    at the reference cylinder π² k² m_n sin α_n/(4 z n_i²)        (30.9)

Between neighboring feeds stay ridges of δ_x. In the plane that both flanks touch, e_1 lies across the straight lines
of the gear's flank and e_h across those of the hob's, L_h = √((r_0 + h)² - r_b0²) is the way to the base cylinder
of the hob, and where L and z of the gear grow p_L and p_z point. Per turn of the hob the point where they touch moves
along w, and at the next cut of the space it is displaced by 2π (z/k) v p_z:

    Q = (cos β_b/L) e_1 e_1ᵀ + (|a_n|/L_h) e_h e_hᵀ,   a_n = a - (a·n) n,   e_h = n × a_n/|a_n|
    p_L = (L/r_b) e_1,   p_z = (L/r_b) σ s_β tan β_b e_1 + e_2/cos β_b,   r_b = d_b/2
    w = σ s_h (k/z) r_b cos² β_b (p_L + σ s_β tan β_b p_z) + v p_z
    δ_x = (2π (z/k) v)² (det Q/(wᵀ Q w)) det(p_z, w)²/8                                        (30.10)

For a spur gear that is f_a² sin α_n/(8 (r_0 + h)); textbooks write (f_a/cos β)² for f_a² and the tip diameter of the
hob for 2 (r_0 + h). With a helix angle δ_x is less than that, at 30° about half: what one turn of the table leaves is
cut by another gash of the next, at another height of the profile. Few gashes do so in part only.

Rounding of the tip of the edge, centre at h_a0 - ρ_a0, normal direction γ. With a protuberance p_r0 it lies that much
beyond the flank, along the normal of it, and begins at γ = α_pr, where the straight flank of the protuberance ends:

    h_r = h_a0 - ρ_a0 (1 - sin γ)
    w_r cos λ = ρ_a0 ((1 - sin α_n sin γ)/cos α_n - cos γ) - p_r0/cos α_n                      (30.11)
    w_a = π m_n/4 - (h_a0 - ρ_a0) tan α_n - (ρ_a0 - p_r0)/cos α_n                              (30.12)

The edge is straight up to h_F: to the rounding without a protuberance, else to where that begins,

    h_F = h_a0 - ρ_a0 (1 - sin α_n),   with a protuberance                                     (30.20)
    h_F = h_a0 - ρ_a0 (1 - sin α_pr) - (p_r0 - ρ_a0 (1 - cos(α_n - α_pr))) cos α_pr/sin(α_n - α_pr)

The straight edge cuts away the involute next to the base cylinder, undercut, in a gear of less teeth than

    z_min = 2 cos β (h_F/m_n - x)/sin² α_t                                                     (30.13)

Gashes of the lead p_i around the hob: κ = s_h 2π/p_i, crossing its threads at a right angle if κ = s_h p_0/r_0². The
edge at y of (30.2) passes the common perpendicular when the hob has turned by κ y more than in the gash's middle, so

    ϑ_0 = ϑ + κ y,   ϑ = (ϑ_0 - κ (y - s_h p_0 ϑ))/(1 + κ s_h p_0),   ϑ_0 = 2π (R/k - c/n_i)   (30.21)

where y - s_h p_0 ϑ is the part of (30.2) that has no ϑ. Edges then follow each other more closely along the thread, by
1 + κ s_h p_0, as if n_i were that much larger; 1/cos² λ for gashes at a right angle.

The root of a topping hob, h_f0 below r_0, turns the tip of the gear to ρ_a. Between its gashes stay ridges of δ_ya,
between feeds δ_xa, to first order in λ on a spur gear:

    ρ_a = d/2 + x m_n + h_f0,   δ_ya = ρ_a (π k/(z n_i))²/2,   δ_xa = f_a²/(8 (r_0 - h_f0))    (30.22)

Errors of hob and clamping: a hob shifted by e_0 (towards the gear, along p, along a), a travel that is wrong by Δz, a
gear whose axis is shifted by e_2 and tilted by ω in space. To first order in ω,

    D = -e_01 x + e_02 p + e_03 a + Δz z - e_2 - ω × P                                         (30.14)

Measured along a circle of transverse pressure angle α_yt, positive towards growing angles; and by a ball:

    s_R = -δ_R/(cos β_b cos α_yt),  s_L = δ_L/(cos β_b cos α_yt)                               (30.15)
    Δr = (δ_R + δ_L)/(2 cos β_b sin α_yt)                                                      (30.16)

The point of the flank σ of space i at L and z, ξ = σ (π/(2z) - 2x tan α_n/z - inv α_t + L/r_b) + s_β 2π z/L + 2π i/z,

    p = r_b (cos ξ, sin ξ) + σ L (sin ξ, -cos ξ),   n = (cos β_b sin ξ, -cos β_b cos ξ, ...) for σ = 1 (30.18)

Of the length of the hob, flanks need what lies between the outermost ϑ of (30.8), and a tooth; its axial pitch is

    p_x0 = 2π p_0/k                                                                            (30.19)

What a part does wrong in every turn, worm, wheel, encoder, hob or screw, is a sum of sines of its turn u, each

    A sin(n u + χ)                                                                             (30.17)
"""

from __future__ import annotations

from functools import cache

import mpmath
import sympy as sp

from derivations import check_dimensions as gear
from derivations import hobbing
from derivations import notation as q
from derivations.expression import Expression
from derivations.proof import DIGITS

_SOURCE = "involute gearing with crossed axes, ISO 21771; proved"
HALF = sp.Rational(1, 2)

#: What is cut: hand of hob and gear, hob, gear.
PAIR = (
    q.flank_side,
    q.hob_sign,
    q.helix_sign,
    q.hob_starts,
    q.hob_diameter,
    q.teeth,
    q.module,
    q.pressure_angle,
    q.helix_angle,
    q.profile_shift,
)


def _lead_angle() -> sp.Expr:
    return hobbing.swivel()["hob_lead_angle"]


def _axes() -> tuple[sp.Matrix, sp.Matrix]:
    """a and p of (30.3)."""
    eta = hobbing.swivel()["hob_swivel"]
    return sp.Matrix([0, sp.cos(eta), sp.sin(eta)]), sp.Matrix([0, -sp.sin(eta), sp.cos(eta)])


def _worm() -> tuple[sp.Expr, sp.Expr, sp.Expr]:
    """p_0, tan α_0 and r_b0 of (30.1)."""
    lead = _lead_angle()
    tangent = sp.tan(q.pressure_angle.symbol) / sp.sin(lead)
    base = q.hob_diameter.symbol / 2 / sp.sqrt(1 + tangent**2)
    return q.module.symbol * q.hob_starts.symbol / (2 * sp.cos(lead)), tangent, base


def _thread_half(radius: sp.Expr) -> sp.Expr:
    """Half the thickness of the thread along the axis, at a radius of the hob: the bracket of (30.2) without w_e."""
    reduced, tangent, base = _worm()
    there = sp.sqrt(radius**2 - base**2) / base
    roll = tangent - sp.atan(tangent) - there + sp.atan(there)
    return reduced * (sp.pi / (2 * q.hob_starts.symbol) + roll)


def _threadless() -> sp.Expr:
    """What of y in (30.2) has no ϑ."""
    radius = q.hob_diameter.symbol / 2 + q.edge_height.symbol
    return q.flank_side.symbol * (_thread_half(radius) - q.edge_relief.symbol)


def _base_radius() -> sp.Expr:
    return gear.diameter() * sp.cos(gear.transverse_angle()) / 2


def _pitch_radii() -> tuple[sp.Expr, sp.Expr]:
    """r, and r + x m_n."""
    radius = gear.diameter() / 2
    return radius, radius + q.profile_shift.symbol * q.module.symbol


def _normal() -> sp.Matrix:
    """n of (30.7)."""
    beta_b, alpha_t, side = gear.base_helix(), gear.transverse_angle(), q.flank_side.symbol
    return sp.Matrix(
        [
            sp.cos(beta_b) * sp.sin(alpha_t),
            -side * sp.cos(beta_b) * sp.cos(alpha_t),
            side * q.helix_sign.symbol * sp.sin(beta_b),
        ]
    )


def _place() -> tuple[sp.Expr, sp.Expr, sp.Expr]:
    """ρ² and θ of (30.4), and P_z from Z."""
    along, across = _axes()
    reduced = _worm()[0]
    radius = q.hob_diameter.symbol / 2 + q.edge_height.symbol
    s_h, tau, theta = (quantity.symbol for quantity in (q.hob_sign, q.hob_turn, q.thread_angle))
    y = s_h * reduced * theta + _threadless()
    distance = _pitch_radii()[1] + q.hob_diameter.symbol / 2
    moved = sp.Matrix(q.tool_displacement.symbol)
    P = sp.Matrix([distance - radius * sp.cos(tau), 0, 0]) + radius * sp.sin(tau) * across + y * along + moved
    turned = s_h * q.hob_starts.symbol / q.teeth.symbol * (tau - theta)
    screwed = q.helix_sign.symbol * 2 * sp.pi * hobbing.turns_per_travel() * P[2]
    angle = sp.atan2(P[1], P[0]) + turned - screwed - q.table_error.symbol
    return P[0] ** 2 + P[1] ** 2, angle, P[2] + q.hob_feed.symbol * tau


_EDGE = (
    q.edge_height,
    q.edge_relief,
    q.hob_turn,
    q.thread_angle,
    q.hob_feed,
    q.table_error,
    q.tool_displacement,
)


def _thread_exists() -> sp.Expr:
    """Positive where the edge is on the involute of the hob."""
    return q.hob_diameter.symbol / 2 + q.edge_height.symbol - sp.Rational(101, 100) * _worm()[2]


_HOB_FITS = q.hob_diameter.symbol - 5 * q.module.symbol * q.hob_starts.symbol


@cache
def hobbed_place() -> Expression:
    """(30.1) to (30.4) as an Expression."""
    squared, angle, height = _place()
    return Expression(
        "hobbed_place",
        "Where a point of a hob's edge is in the tooth space that it cuts (30.1 to 30.4).",
        (*_EDGE, *PAIR),
        ((q.cut_radius, sp.sqrt(squared)), (q.cut_angle, angle), (q.cut_height, height)),
        requires=(_HOB_FITS, _thread_exists(), squared - 1),
        source=_SOURCE,
    )


@cache
def hobbed_deviation() -> Expression:
    """(30.5, 30.6) as an Expression."""
    squared, angle, height = _place()
    base, beta_b, side = _base_radius(), gear.base_helix(), q.flank_side.symbol
    z, alpha_t = q.teeth.symbol, gear.transverse_angle()
    roll = sp.sqrt(squared - base**2)
    half_space = sp.pi / (2 * z) - 2 * q.profile_shift.symbol * sp.tan(q.pressure_angle.symbol) / z
    involute = roll / base - sp.atan(roll / base)
    delta = base * sp.cos(beta_b) * (half_space - gear.involute(alpha_t) + involute - side * angle)
    return Expression(
        "hobbed_deviation",
        "What a point of a hob's edge leaves on the flank, and at which point of the flank (30.5, 30.6).",
        (*_EDGE, *PAIR),
        (
            (q.roll_foot, roll - delta * sp.cos(beta_b)),
            (q.height_foot, height - side * q.helix_sign.symbol * delta * sp.sin(beta_b)),
            (q.cut_deviation, delta),
        ),
        requires=(_HOB_FITS, _thread_exists(), squared - sp.Rational(102, 100) * base**2),
        source=_SOURCE,
    )


@cache
def line_of_action() -> Expression:
    """(30.7, 30.8) as an Expression."""
    r, rolled = _pitch_radii()
    n, (along, across) = _normal(), _axes()
    to_rack = (rolled - r) / n[0]
    eta = hobbing.swivel()["hob_swivel"]
    foot = to_rack * n[1] * sp.tan(eta) - to_rack * n[2]  # height of the line of action on the pitch line of the gear
    length = (q.roll_length.symbol - _base_radius() * sp.tan(gear.transverse_angle())) / sp.cos(gear.base_helix())
    P = sp.Matrix([r, 0, foot]) + length * n
    toward, up = rolled + q.hob_diameter.symbol / 2 - P[0], across.dot(P)
    radius = sp.sqrt(toward**2 + up**2)
    s_h, side = q.hob_sign.symbol, q.flank_side.symbol
    thread = s_h * (along.dot(P) - side * _thread_half(radius)) / _worm()[0]
    return Expression(
        "line_of_action",
        "Where hob and flank touch at a length of roll: height on the gear, edge, turn and thread of the hob (30.8).",
        (q.roll_length, *PAIR),
        (
            (q.contact_height, P[2]),
            (q.contact_edge, radius - q.hob_diameter.symbol / 2),
            (q.contact_turn, sp.atan2(up, toward)),
            (q.contact_thread, thread),
        ),
        requires=(
            _HOB_FITS,
            sp.cos(eta) - sp.Rational(1, 10),
            toward - 1,
            radius - sp.Rational(101, 100) * _worm()[2],
        ),
        source=_SOURCE,
    )


@cache
def hob_pitch() -> Expression:
    """(30.19) as an Expression."""
    return Expression(
        "hob_pitch",
        "Pitch of a hob's teeth along its axis (30.19).",
        (q.hob_starts, q.module, q.hob_diameter),
        ((q.hob_axial_pitch, 2 * sp.pi / q.hob_starts.symbol * _worm()[0]),),
        requires=(_HOB_FITS,),
        source="worm, ISO 21771; proved",
    )


@cache
def gash_of_thread() -> Expression:
    """(30.2, 30.21) as an Expression."""
    theta = q.thread_angle.symbol
    along = q.hob_sign.symbol * _worm()[0] * theta + _threadless()
    return Expression(
        "gash_of_thread",
        "Where an edge stands along the hob, and the thread angle of its gash in the middle of the hob (30.2, 30.21).",
        (q.edge_height, q.edge_relief, q.thread_angle, q.gash_twist, *PAIR),
        ((q.edge_along_hob, along), (q.gash_thread, theta + q.gash_twist.symbol * along)),
        requires=(_HOB_FITS, _thread_exists()),
        source="helix of constant lead; proved",
    )


@cache
def thread_of_gash() -> Expression:
    """(30.21) as an Expression."""
    twist = q.gash_twist.symbol
    denser = 1 + twist * q.hob_sign.symbol * _worm()[0]
    return Expression(
        "thread_of_gash",
        "Where the thread stands at a height of the edge that a helical gash cuts from it (30.21).",
        (q.edge_height, q.edge_relief, q.gash_thread, q.gash_twist, *PAIR),
        ((q.thread_angle, (q.gash_thread.symbol - twist * _threadless()) / denser),),
        requires=(_HOB_FITS, _thread_exists(), denser - sp.Rational(1, 2)),
        source="helix of constant lead; proved",
    )


@cache
def generating_flat() -> Expression:
    """(30.9) as an Expression."""
    per_gash = sp.pi * q.hob_starts.symbol / (q.teeth.symbol * q.hob_gashes.symbol)
    return Expression(
        "generating_flat",
        "Height of the ridges that a hob's gashes leave on a spur flank at a length of roll (30.9).",
        (q.roll_length, q.hob_starts, q.teeth, q.hob_gashes),
        ((q.flat_height, q.roll_length.symbol * per_gash**2 / 2),),
        source="generating cuts of hobbing, textbooks; proved",
    )


def _flank_directions() -> tuple[sp.Matrix, sp.Matrix]:
    """p_L and p_z of (30.10), each along e_1 and e_2."""
    tilt = q.flank_side.symbol * q.helix_sign.symbol * sp.tan(gear.base_helix())
    by_length = q.roll_length.symbol / _base_radius()
    return sp.Matrix([by_length, 0]), sp.Matrix([by_length * tilt, 1 / sp.cos(gear.base_helix())])


def _across_hob_lines() -> tuple[sp.Matrix, sp.Expr]:
    """e_h of (30.10) along e_1 and e_2, and |a_n|."""
    n, along = _normal(), _axes()[0]
    first = sp.Matrix([sp.cos(gear.transverse_angle()), q.flank_side.symbol * sp.sin(gear.transverse_angle()), 0])
    second = n.cross(first) * q.flank_side.symbol  # along the straight lines, upwards
    projected = along - along.dot(n) * n
    size = sp.sqrt(1 - along.dot(n) ** 2)
    across = n.cross(projected) / size
    return sp.Matrix([across.dot(first), across.dot(second)]), size


@cache
def feed_mark() -> Expression:
    """(30.10) as an Expression."""
    by_length, by_height = _flank_directions()
    across, size = _across_hob_lines()
    radius = q.hob_diameter.symbol / 2 + q.edge_height.symbol
    squared = radius**2 - _worm()[2] ** 2
    of_gear, of_hob = sp.cos(gear.base_helix()) / q.roll_length.symbol, size / sp.sqrt(squared)
    side, per_turn = q.flank_side.symbol, q.hob_starts.symbol / q.teeth.symbol
    tilt = side * q.helix_sign.symbol * sp.tan(gear.base_helix())
    rolled = q.hob_sign.symbol * per_turn * _base_radius() * sp.cos(gear.base_helix()) ** 2
    moved = side * rolled * (by_length + tilt * by_height) + q.hob_feed.symbol * by_height
    along = of_gear * moved[0] ** 2 + of_hob * across.dot(moved) ** 2  # wᵀ Q w
    area = by_height[0] * moved[1] - by_height[1] * moved[0]
    apart = 2 * sp.pi / per_turn * q.hob_feed.symbol
    return Expression(
        "feed_mark",
        "Height of the ridges between feeds of a hob of many gashes, where the edge at a height cuts (30.10).",
        (q.roll_length, q.edge_height, q.hob_feed, *PAIR),
        ((q.feed_mark_height, apart**2 * of_gear * of_hob * across[1] ** 2 * area**2 / along / 8),),
        requires=(_HOB_FITS, _thread_exists(), q.roll_length.symbol - sp.Rational(1, 100)),
        source="curvatures of two involute helicoids that touch; proved, and for a spur gear that of the textbooks",
    )


@cache
def hob_tip() -> Expression:
    """(30.11) as an Expression."""
    alpha, gamma, rho = q.pressure_angle.symbol, q.tip_turn.symbol, q.hob_tip_radius.symbol
    short = (1 - sp.sin(alpha) * sp.sin(gamma)) / sp.cos(alpha) - sp.cos(gamma)
    across = rho * short - q.protuberance.symbol / sp.cos(alpha)
    return Expression(
        "hob_tip",
        "A point of the rounding at the tip of a hob's tooth (30.11).",
        (q.tip_turn, q.hob_addendum, q.hob_tip_radius, q.protuberance, q.pressure_angle, q.hob_lead_angle),
        (
            (q.rounding_height, q.hob_addendum.symbol - rho * (1 - sp.sin(gamma))),
            (q.tip_relief, across / sp.cos(q.hob_lead_angle.symbol)),
        ),
        requires=(sp.Rational(6, 5) - q.hob_lead_angle.symbol,),
        source="basic rack of ISO 53; proved",
    )


@cache
def hob_form() -> Expression:
    """(30.12, 30.20) as an Expression."""
    alpha, rho, top = q.pressure_angle.symbol, q.hob_tip_radius.symbol, q.hob_addendum.symbol
    land = sp.pi * q.module.symbol / 4 - (top - rho) * sp.tan(alpha) - (rho - q.protuberance.symbol) / sp.cos(alpha)
    return Expression(
        "hob_form",
        "How far up a hob's edge without a protuberance is straight, and half of the land on its tip (30.12, 30.20).",
        (q.module, q.hob_addendum, q.hob_tip_radius, q.protuberance, q.pressure_angle),
        ((q.form_height, top - rho * (1 - sp.sin(alpha))), (q.land_half_width, land)),
        source="basic rack of ISO 53; proved",
    )


@cache
def protuberance_form() -> Expression:
    """(30.20) as an Expression."""
    alpha, flat, rho, top = (
        quantity.symbol for quantity in (q.pressure_angle, q.protuberance_angle, q.hob_tip_radius, q.hob_addendum)
    )
    beyond = q.protuberance.symbol - rho * (1 - sp.cos(alpha - flat))
    height = top - rho * (1 - sp.sin(flat)) - beyond * sp.cos(flat) / sp.sin(alpha - flat)
    return Expression(
        "protuberance_form",
        "How far up a hob's edge is straight below a protuberance (30.20).",
        (q.hob_addendum, q.hob_tip_radius, q.protuberance, q.pressure_angle, q.protuberance_angle),
        ((q.form_height, height),),
        requires=(alpha - flat - sp.Rational(1, 100), beyond),
        source="basic rack with protuberance; proved",
    )


@cache
def topped_tip() -> Expression:
    """(30.22) as an Expression."""
    radius = _pitch_radii()[1] + q.hob_dedendum.symbol
    per_gash = sp.pi * q.hob_starts.symbol / (q.teeth.symbol * q.hob_gashes.symbol)
    feed = q.hob_feed.symbol * 2 * sp.pi * q.teeth.symbol / q.hob_starts.symbol
    return Expression(
        "topped_tip",
        "Radius of the tip that the root of a topping hob leaves, and the ridges on it (30.22).",
        (q.hob_dedendum, q.hob_gashes, q.hob_feed, *PAIR),
        (
            (q.topped_radius, radius),
            (q.tip_facet, radius * per_gash**2 / 2),
            (q.tip_feed_mark, feed**2 / 8 / (q.hob_diameter.symbol / 2 - q.hob_dedendum.symbol)),
        ),
        requires=(_HOB_FITS, q.hob_diameter.symbol / 2 - q.hob_dedendum.symbol - 1, radius - 1),
        source="cuts of a line and of a circle that turn; proved",
    )


@cache
def undercut_teeth() -> Expression:
    """(30.13) as an Expression."""
    height = q.edge_height.symbol / q.module.symbol - q.profile_shift.symbol
    return Expression(
        "undercut_teeth",
        "Teeth below which an edge that is straight up to a height cuts involute away (30.13).",
        (q.edge_height, q.module, q.pressure_angle, q.helix_angle, q.profile_shift),
        ((q.least_teeth, 2 * sp.cos(q.helix_angle.symbol) * height / sp.sin(gear.transverse_angle()) ** 2),),
        source="ISO 21771; proved",
    )


@cache
def hob_displacement() -> Expression:
    """(30.14) as an Expression."""
    along, across = _axes()
    shift, moved, tilt = (sp.Matrix(quantity.symbol) for quantity in (q.hob_shift, q.blank_shift, q.blank_tilt))
    D = -shift[0] * sp.Matrix([1, 0, 0]) + shift[1] * across + shift[2] * along
    D += sp.Matrix([-moved[0], -moved[1], q.feed_shift.symbol])
    D -= sp.Matrix([tilt[0], tilt[1], 0]).cross(sp.Matrix(q.cut_place.symbol))
    return Expression(
        "hob_displacement",
        "Errors of hob, feed and clamping as one displacement of the hob against the gear (30.14).",
        (
            q.hob_shift,
            q.feed_shift,
            q.blank_shift,
            q.blank_tilt,
            q.cut_place,
            q.hob_sign,
            q.helix_sign,
            q.hob_starts,
            q.module,
            q.helix_angle,
            q.hob_diameter,
        ),
        ((q.displacement, D),),
        requires=(_HOB_FITS,),
        source="rigid motion to first order",
    )


@cache
def circle_positions() -> Expression:
    """(30.15) as an Expression."""
    normal = sp.cos(gear.base_helix()) * sp.cos(q.circle_angle.symbol)
    return Expression(
        "circle_positions",
        "Where the flanks of a space stand along a circle, by their deviations (30.15).",
        (q.right_deviation, q.left_deviation, q.circle_angle, q.pressure_angle, q.helix_angle),
        (
            (q.right_position, -q.right_deviation.symbol / normal),
            (q.left_position, q.left_deviation.symbol / normal),
        ),
        source="ISO 21771",
    )


@cache
def ball_radial() -> Expression:
    """(30.16) as an Expression."""
    normal = sp.cos(gear.base_helix()) * sp.sin(q.circle_angle.symbol)
    return Expression(
        "ball_radial",
        "How far a ball stands out of a space whose flanks deviate (30.16).",
        (q.right_deviation, q.left_deviation, q.circle_angle, q.pressure_angle, q.helix_angle),
        ((q.ball_height, (q.right_deviation.symbol + q.left_deviation.symbol) / (2 * normal)),),
        source="ISO 21771",
    )


@cache
def harmonic() -> Expression:
    """(30.17) as an Expression."""
    angle = q.harmonic_order.symbol * q.harmonic_turn.symbol + q.harmonic_phase.symbol
    return Expression(
        "harmonic",
        "One sine of what a turning part does wrong (30.17).",
        (q.harmonic_turn, q.harmonic_amplitude, q.harmonic_order, q.harmonic_phase),
        ((q.harmonic_value, q.harmonic_amplitude.symbol * sp.sin(angle)),),
        source="Fourier series of a part that turns",
    )


@cache
def involute_flank() -> Expression:
    """(30.18) as an Expression."""
    base, beta_b, side = _base_radius(), gear.base_helix(), q.flank_side.symbol
    z, length, height = q.teeth.symbol, q.roll_length.symbol, q.flank_height.symbol
    half_space = sp.pi / (2 * z) - 2 * q.profile_shift.symbol * sp.tan(q.pressure_angle.symbol) / z
    screwed = q.helix_sign.symbol * 2 * sp.pi * hobbing.turns_per_travel() * height
    xi = side * (half_space - gear.involute(gear.transverse_angle()) + length / base)
    xi += screwed + 2 * sp.pi * q.space_index.symbol / z
    outward = sp.Matrix([side * sp.sin(xi), -side * sp.cos(xi)])
    point = sp.Matrix([base * sp.cos(xi) + length * outward[0], base * sp.sin(xi) + length * outward[1], height])
    tilt = side * q.helix_sign.symbol * sp.sin(beta_b)
    normal = sp.Matrix([sp.cos(beta_b) * outward[0], sp.cos(beta_b) * outward[1], tilt])
    return Expression(
        "involute_flank",
        "A point of an involute helicoid, and the normal out of the metal (30.18).",
        (
            q.roll_length,
            q.flank_height,
            q.space_index,
            q.flank_side,
            q.helix_sign,
            q.teeth,
            q.module,
            q.pressure_angle,
            q.helix_angle,
            q.profile_shift,
        ),
        ((q.gear_flank_point, point), (q.gear_flank_normal, normal)),
        source="ISO 21771",
    )


#: Gears and hobs of proofs by numbers: s_h, s_β, k, d_0, z, m_n, α_n, β, x.
_CASES = (
    (1, 1, 1, 50, 24, 1, "0.349", 0, 0),
    (1, 1, 1, 70, 17, 3, "0.349", "0.5", "0.4"),
    (-1, 1, 2, 60, 41, 2, "0.3", "0.3", "-0.3"),
    (1, -1, 3, 45, 6, 1, "0.4", "0.2", "0.5"),
    (-1, -1, 1, 30, 200, 1, "0.349", "0.1", "-0.5"),
)


def _contacts() -> list[tuple[list[mpmath.mpf], list[mpmath.mpf], mpmath.mpf]]:
    """For every case and both flanks: PAIR, the contact of (30.8), and its roll length, somewhat above the middle."""
    found = []
    for case in _CASES:
        for side in (1, -1):
            pair = [mpmath.mpf(side), *map(mpmath.mpf, case)]
            z, m, alpha, beta = pair[5], pair[6], pair[7], pair[8]
            alpha_t = mpmath.atan(mpmath.tan(alpha) / mpmath.cos(beta))
            length = z * m / (2 * mpmath.cos(beta)) * mpmath.sin(alpha_t) + m / 5
            found.append((pair, list(line_of_action().function(length, *pair)), length))
    return found


def prove_hob_touches_the_involute_helicoid_along_the_line_of_action() -> None:
    """(30.5 to 30.8) On it δ = 0 and all its derivatives vanish, so that its edges cut the involute helicoid.

    Numbers in many digits: both hands, both flanks, 1 to 3 starts, 6 to 200 teeth, spur and helical, shift ±0.5. Going
    away from it in any of nine directions δ is positive: no edge cuts into the flank.
    """
    step = mpmath.mpf(10) ** -8
    with mpmath.workdps(DIGITS):
        for pair, (height, edge, turn, thread), length in _contacts():

            def at(dh: float, dt: float, dn: float) -> list[mpmath.mpf]:
                place = (edge + dh, 0, turn + dt, thread + dn)  # noqa: B023
                return hobbed_deviation().function(*place, 0, 0, 0, 0, 0, *pair)  # noqa: B023

            foot, where, delta = at(0, 0, 0)
            assert abs(delta) < mpmath.mpf(10) ** -30
            assert abs(foot - length) < mpmath.mpf(10) ** -30
            assert abs(where - height) < mpmath.mpf(10) ** -30
            for move in ((1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 1, 0), (1, 0, -1), (0, 1, 1), (1, -1, 1), (1, 1, 1)):
                ahead, behind = (at(*(sign * step * part for part in move))[2] for sign in (1, -1))
                assert abs(ahead - behind) / (2 * step) < mpmath.mpf(10) ** -7
                assert ahead > -(step**3)
                assert behind > -(step**3)


def _curvatures(
    pair: list[mpmath.mpf], contact: list[mpmath.mpf], feed: mpmath.mpf
) -> tuple[mpmath.mpf, mpmath.mpf, mpmath.mpf]:
    """Second derivatives of δ at one foot: by the thread angle ϑ twice, by ϑ and the height of the hob, by that twice.

    From differences of (30.5) where the edge crosses the foot, so that no curvature of (30.10) is used.
    """
    _, edge, turn, thread = contact
    rule, step = hobbed_deviation().function, mpmath.mpf(10) ** -6

    def left(thread_by: mpmath.mpf, height_by: mpmath.mpf) -> mpmath.mpf:
        """δ at the foot of the contact, of an edge that is turned by so much, and of a hob that is so much higher."""

        def miss(h: mpmath.mpf, t: mpmath.mpf) -> list[mpmath.mpf]:
            foot, height, _ = rule(h, 0, t, thread + thread_by, feed, 0, 0, 0, 0, *pair)
            return [foot - contact_foot[0], height + height_by - contact_foot[1]]

        h, t = mpmath.findroot(miss, (edge, turn))
        return rule(h, 0, t, thread + thread_by, feed, 0, 0, 0, 0, *pair)[2]

    contact_foot = rule(edge, 0, turn, thread, feed, 0, 0, 0, 0, *pair)[:2]
    by_thread, by_height, by_both = (
        (left(*(step * part for part in move)) + left(*(-step * part for part in move))) / step**2
        for move in ((1, 0), (0, 1), (1, 1))
    )
    return by_thread, (by_both - by_thread - by_height) / 2, by_height


def prove_ridges_between_flats_and_feed_marks_of_a_spur_gear_are_the_textbooks() -> None:
    """(30.9, 30.10) Half way to the next gash, or feed: δ is half the curvature times the square of that way."""
    with mpmath.workdps(DIGITS):
        pair = [mpmath.mpf(value) for value in (1, 1, 1, 1, 5000, 24, 1, "0.349", 0, 0)]
        travel = 1 / (48 * mpmath.pi)  # feed of 1 mm
        for length in (mpmath.mpf(3), 12 * mpmath.sin(pair[7]), mpmath.mpf(6)):
            contact = list(line_of_action().function(length, *pair))
            by_thread, _, by_height = _curvatures(pair, contact, travel)
            half_way = mpmath.pi / 12  # of 12 gashes, in turns of the hob
            (flat,) = generating_flat().function(length, 1, 24, 12)
            assert abs(by_thread * half_way**2 / 2 / flat - 1) < mpmath.mpf("1e-3")  # a large hob is nearly a rack
            textbook = mpmath.sin(pair[7]) / (8 * (pair[4] / 2 + contact[1]))
            (mark,) = feed_mark().function(length, contact[1], travel, *pair)
            assert abs(mark / textbook - 1) < mpmath.mpf("1e-3")
            assert abs(by_height / 8 / mark - 1) < mpmath.mpf("1e-3")


def prove_feed_marks_are_what_all_gashes_leave_half_way_between_two_feeds() -> None:
    """(30.10) Of δ = xᵀ H x/2, x = (ϑ, Z), the cuts of one turn of the table leave the least along the way of the hob,

    (-1, v) per radian. Half a feed away that is (2π (z/k) v)² det H/(8 uᵀ H u), u = (-1, v): H from differences of
    (30.5), for both hands and flanks, spur and helical, 1 to 3 starts, against the curvatures of the two flanks.
    """
    with mpmath.workdps(DIGITS):
        for pair, contact, length in _contacts():
            for travel in (mpmath.mpf("0.003"), mpmath.mpf("-0.02")):
                thread, both, height = _curvatures(pair, contact[:4], travel)
                along = thread - 2 * travel * both + travel**2 * height
                apart = 2 * mpmath.pi * pair[5] / pair[3] * travel
                left = apart**2 * (thread * height - both**2) / (8 * along)
                (mark,) = feed_mark().function(length, contact[1], travel, *pair)
                assert abs(left / mark - 1) < mpmath.mpf(10) ** -9


def prove_threads_of_the_hob_rise_by_their_pitches_along_the_lead_angle() -> None:
    """(30.19) Unrolled, k pitches rise over the circumference at λ; across the thread a pitch is π m_n."""
    pitch, lead = hob_pitch()["hob_axial_pitch"], hobbing.swivel()["hob_lead_angle"]
    at = {q.module.symbol: 2, q.hob_starts.symbol: 3, q.hob_diameter.symbol: 50}
    rise = 3 * pitch.subs(at) / (sp.pi * 50)
    assert abs(sp.N(rise - sp.tan(lead.subs(at)), 30)) < 1e-25
    assert abs(sp.N((pitch * sp.cos(lead)).subs(at) - 2 * sp.pi, 30)) < 1e-25


def prove_flat_at_the_reference_cylinder_is_the_formula_of_textbooks() -> None:
    """(30.9) L = (z m/2) sin α: π² k² m sin α/(4 z n_i²)."""
    z, m, alpha = q.teeth.symbol, q.module.symbol, q.pressure_angle.symbol
    there = generating_flat()["flat_height"].subs(q.roll_length.symbol, z * m * sp.sin(alpha) / 2)
    known = sp.pi**2 * q.hob_starts.symbol**2 * m * sp.sin(alpha) / (4 * z * q.hob_gashes.symbol**2)
    assert sp.simplify(there - known) == 0


def prove_rounding_leaves_the_flank_tangentially_and_ends_on_the_tip() -> None:
    """(30.11, 30.12) At γ = α_n it is p_r0 beyond the flank along its normal, w_r without slope; at γ = π/2 it is on

    the tip, w_a from the middle.
    """
    rule, alpha, gamma = hob_tip(), q.pressure_angle.symbol, q.tip_turn.symbol
    relief = rule["tip_relief"]
    normal = relief * sp.cos(q.hob_lead_angle.symbol) * sp.cos(alpha)
    assert sp.simplify(normal.subs(gamma, alpha) + q.protuberance.symbol) == 0
    assert sp.simplify(sp.diff(relief, gamma).subs(gamma, alpha)) == 0
    assert sp.simplify(rule["rounding_height"].subs(gamma, alpha) - hob_form()["form_height"]) == 0
    assert rule["rounding_height"].subs(gamma, sp.pi / 2) == q.hob_addendum.symbol
    straight = sp.pi * q.module.symbol / 4 - q.hob_addendum.symbol * sp.tan(alpha)
    across = relief.subs(gamma, sp.pi / 2) * sp.cos(q.hob_lead_angle.symbol)
    assert sp.simplify(straight - across - hob_form()["land_half_width"]) == 0


def prove_protuberance_begins_on_the_flank_and_runs_into_the_rounding_tangentially() -> None:
    """(30.11, 30.20) From h_F, on the flank, a straight line at α_pr meets the rounding at γ = α_pr with its slope."""
    alpha, flat, gamma = q.pressure_angle.symbol, q.protuberance_angle.symbol, q.tip_turn.symbol
    rule, begin = hob_tip(), protuberance_form()["form_height"]
    height, across = rule["rounding_height"], rule["tip_relief"] * sp.cos(q.hob_lead_angle.symbol)
    slope = sp.tan(flat) - sp.tan(alpha)  # of the relief along that line
    at = {alpha: sp.Rational(35, 100), flat: sp.Rational(12, 100), q.hob_addendum.symbol: 3}
    for rho, pr in ((sp.Rational(6, 10), sp.Rational(1, 10)), (0, sp.Rational(1, 5))):
        given = at | {q.hob_tip_radius.symbol: rho, q.protuberance.symbol: pr}
        end = ((height - begin) * slope - across).subs(gamma, flat).subs(given)
        assert abs(sp.N(end, 30)) < 1e-25
        if rho:
            along = (sp.diff(across, gamma) / sp.diff(height, gamma) - slope).subs(gamma, flat).subs(given)
            assert abs(sp.N(along, 30)) < 1e-25


def prove_edge_of_a_helical_gash_lies_on_its_thread_and_on_its_gash() -> None:
    """(30.21) ϑ of ϑ_0 is ϑ again; across the threads neighbors are 1 + κ s_h p_0 closer, 1/cos² λ at a right angle."""
    there = gash_of_thread()["gash_thread"]
    back = thread_of_gash()["thread_angle"].subs(q.gash_thread.symbol, there)
    assert sp.simplify(back - q.thread_angle.symbol) == 0
    reduced, lead = _worm()[0], _lead_angle()
    normal = q.hob_sign.symbol * reduced / (q.hob_diameter.symbol / 2) ** 2
    closer = 1 / sp.diff(thread_of_gash()["thread_angle"], q.gash_thread.symbol)
    at = {q.module.symbol: 2, q.hob_starts.symbol: 3, q.hob_diameter.symbol: 50}
    for hand in (1, -1):
        along = closer.subs(q.gash_twist.symbol, normal).subs(at | {q.hob_sign.symbol: hand})
        assert abs(sp.N(along - 1 / sp.cos(lead.subs(at)) ** 2, 30)) < 1e-25


def prove_ridges_on_a_topped_tip_are_half_way_between_two_cuts() -> None:
    """(30.22) Two lines at ρ_a, a gash's turn of the gear apart, meet δ_ya higher; two circles of r_0 - h_f0, a feed

    apart, δ_xa higher: the first terms of both.
    """
    rule, e = topped_tip(), sp.symbols("epsilon", positive=True)
    radius, half = sp.symbols("R w", positive=True)
    assert sp.series(radius / sp.cos(half * e) - radius, e, 0, 4).removeO() == radius * half**2 * e**2 / 2
    circle = sp.series(radius - sp.sqrt(radius**2 - (half * e / 2) ** 2), e, 0, 4).removeO()
    assert sp.simplify(circle - half**2 * e**2 / (8 * radius)) == 0
    k, z, n = q.hob_starts.symbol, q.teeth.symbol, q.hob_gashes.symbol
    assert sp.simplify(rule["tip_facet"] - rule["topped_radius"] * (sp.pi * k / (z * n)) ** 2 / 2) == 0
    feed = 2 * sp.pi * z / k * q.hob_feed.symbol
    left = rule["tip_feed_mark"] - feed**2 / (8 * (q.hob_diameter.symbol / 2 - q.hob_dedendum.symbol))
    assert sp.simplify(left) == 0


def prove_undercut_begins_where_the_straight_edge_reaches_the_base_cylinder() -> None:
    """(30.13) The edge at h_F touches at L = 0 for z = z_min: 17.097 teeth for 20°, h_F = m; 14 for x = 0.18115."""
    rule = undercut_teeth()
    at = {q.edge_height.symbol: 1, q.module.symbol: 1, q.pressure_angle.symbol: sp.pi / 9, q.helix_angle.symbol: 0}
    assert abs(rule["least_teeth"].subs(at | {q.profile_shift.symbol: 0}).evalf() - sp.Rational("17.0973")) < 1e-4
    assert abs(rule["least_teeth"].subs(at | {q.profile_shift.symbol: sp.Rational("0.18115")}).evalf() - 14) < 1e-3
    contact = line_of_action()["contact_edge"].subs(q.roll_length.symbol, 0)
    with mpmath.workdps(DIGITS):
        size, alpha = mpmath.mpf(10) ** 9, mpmath.pi / 9
        teeth = 2 / mpmath.sin(alpha) ** 2
        symbols = [quantity.symbol for quantity in PAIR]
        height = sp.lambdify(symbols, contact, "mpmath")(1, 1, 1, 1, size, teeth, 1, alpha, 0, 0)
        assert abs(height - 1) < mpmath.mpf(10) ** -8


def prove_wrong_table_angle_only_adds_to_what_is_left() -> None:
    """(30.5) ∂δ/∂Δφ = σ (d_b/2) cos β_b, whatever else; ρ and height do not change."""
    delta = hobbed_deviation()["cut_deviation"]
    by_angle = sp.diff(delta, q.table_error.symbol)
    assert sp.simplify(by_angle - q.flank_side.symbol * _base_radius() * sp.cos(gear.base_helix())) == 0
    assert not hobbed_place()["cut_radius"].has(q.table_error.symbol)
    assert not hobbed_place()["cut_height"].has(q.table_error.symbol)


def prove_ball_and_circle_see_a_shifted_gear_as_it_is() -> None:
    """(30.15, 30.16) A spur gear shifted by e along a space's middle: the ball by e; turned by ε: the circle by r ε."""
    e, turn, r = sp.symbols("e epsilon r", positive=True)
    angle, spur = q.circle_angle.symbol, {q.helix_angle.symbol: 0}
    both = {q.right_deviation.symbol: e * sp.sin(angle), q.left_deviation.symbol: e * sp.sin(angle)}
    assert sp.simplify(ball_radial()["ball_height"].subs(both).subs(spur) - e) == 0
    turned = {q.right_deviation.symbol: -turn * r * sp.cos(angle), q.left_deviation.symbol: turn * r * sp.cos(angle)}
    for name in ("right_position", "left_position"):
        assert sp.simplify(circle_positions()[name].subs(turned).subs(spur) - r * turn) == 0


def prove_harmonic_repeats_as_often_as_its_order_says_with_its_amplitude() -> None:
    """(30.17) One period is 2π/n; the mean square over a turn is A²/2, for the first orders."""
    value, turn, order = harmonic()["harmonic_value"], q.harmonic_turn.symbol, q.harmonic_order.symbol
    amplitude = q.harmonic_amplitude.symbol
    for n in (1, 2, 7):
        sine = value.subs({order: n, q.harmonic_phase.symbol: 0})
        assert sp.simplify(sine.subs(turn, turn + 2 * sp.pi / n) - sine) == 0
        assert sp.simplify(sp.integrate(sine**2, (turn, 0, 2 * sp.pi)) / (2 * sp.pi) - amplitude**2 / 2) == 0


def prove_involute_has_the_thickness_of_the_standard_and_its_normal_is_across_both_directions() -> None:
    """(30.18) n is across ∂p/∂L and ∂p/∂z; at the reference cylinder a spur space is m (π/2 - 2x tan α) wide."""
    rule = involute_flank()
    point, normal = (sp.Matrix(rule[name]) for name in ("gear_flank_point", "gear_flank_normal"))
    at = {
        q.teeth.symbol: 17,
        q.module.symbol: 2,
        q.pressure_angle.symbol: sp.pi / 9,
        q.helix_angle.symbol: sp.pi / 10,
        q.profile_shift.symbol: sp.Rational(1, 5),
        q.space_index.symbol: 3,
        q.helix_sign.symbol: -1,
        q.flank_height.symbol: 7,
        q.roll_length.symbol: 5,
    }
    for side in (1, -1):
        for along in (q.roll_length.symbol, q.flank_height.symbol):
            across = point.diff(along).dot(normal).subs(at | {q.flank_side.symbol: side})
            assert abs(sp.N(across, 30)) < 1e-20
        assert abs(sp.N(normal.norm().subs(at | {q.flank_side.symbol: side}), 30) - 1) < 1e-20
    spur = at | {q.helix_angle.symbol: 0, q.space_index.symbol: 0, q.flank_height.symbol: 0, q.flank_side.symbol: 1}
    spur[q.roll_length.symbol] = 17 * sp.sin(sp.pi / 9)
    place = point.subs(spur)
    width = 2 * 17 * sp.atan2(place[1], place[0])
    assert abs(sp.N(width - 2 * (sp.pi / 2 - sp.Rational(2, 5) * sp.tan(sp.pi / 9)), 30)) < 1e-20
