"""Chapter 9. Hobbing: ratio and swivel of a helical gear; the lead screw of a lathe.

Frames: the gear's axis is z; the hob stands at +x of it, its axis along y and turned by η about x, so that η is
counter-clockwise seen from the hob towards the work. A tooth of a helical gear of lead L goes round by s_β 2π Z/L:

    L = π z m_n / sin β                                                                        (9.1)
    κ_h = s_h k S / (z E),   κ_z = -s_f s_β S / (L C)                                          (9.2)
    p = Σ N_j e_j / D,   D a multiple of the denominator of κ_h,   |κ_z - N_z/D| ≤ 1/(2D)      (9.3)
    ε = C Z / (2D)                                                                             (9.4)

κ_h and κ_z are motor steps per count of hob and feed, positive as the table turns with a right-hand hob. κ_h is
rational, κ_z is not: N_z is rounded, which costs ε steps over a travel Z, the bound (9.4). C is counts per mm of feed.

    λ = asin(m_n k / d_0),   η = s_h λ - s_β β                                                 (9.5)

Lead screw of a lathe: k starts of pitch P, the screw travels P_L a turn, both exact in mm (an inch is 127/5 mm):

    κ_t = s_t k P S / (P_L E)                                                                  (9.14)

Without an encoder on the feed, a helical gear needs a constant feed f per turn of the table, climbing (c = 1) or
conventional (c = -1), and the hob alone leads: p = κ_f e,

    κ_f = κ_h / (1 + c s_h s_β f / L)                                                          (9.15)

The dimensions that check a gear, (9.6) to (9.13), are in :mod:`derivations.check_dimensions`.
"""

from __future__ import annotations

from functools import cache

import sympy as sp

from derivations import gearbox
from derivations import notation as q
from derivations.expression import Expression
from derivations.proof import is_zero

_TEXTBOOK = "ISO 21771; worked examples of the SDP/SI handbook"


def turns_per_travel() -> sp.Expr:
    """1/L of (9.1); 0 for a spur gear."""
    return sp.sin(q.helix_angle.symbol) / (sp.pi * q.teeth.symbol * q.module.symbol)


@cache
def helical_lead() -> Expression:
    """(9.1) as an Expression."""
    return Expression(
        "helical_lead",
        "Lead of a helical gear (9.1).",
        (q.teeth, q.module, q.helix_angle),
        ((q.gear_lead, 1 / turns_per_travel()),),
        requires=(q.helix_angle.symbol - sp.Rational(1, 10_000),),
        source=_TEXTBOOK,
    )


@cache
def hob_ratio() -> Expression:
    """κ_h of (9.2) as an Expression."""
    N, D = gearbox.ratio_terms()
    return Expression(
        "hob_ratio",
        "Motor steps per count of the hob, with the sign of its hand (9.2).",
        (q.hob_sign, q.teeth, q.hob_starts, q.encoder_counts, q.motor_steps),
        ((q.hob_ratio, q.hob_sign.symbol * N / D),),
        source="generalises (7.2) to the hand of the hob",
    )


@cache
def feed_ratio() -> Expression:
    """κ_z of (9.2) as an Expression."""
    steps_per_travel = q.motor_steps.symbol * turns_per_travel()
    return Expression(
        "feed_ratio",
        "Motor steps per count of the axial feed in helical hobbing, signed (9.2).",
        (q.feed_sign, q.helix_sign, q.teeth, q.module, q.helix_angle, q.motor_steps, q.feed_counts),
        ((q.feed_ratio, -q.feed_sign.symbol * q.helix_sign.symbol * steps_per_travel / q.feed_counts.symbol),),
        source="differential of a hobbing machine, proved from the motion of hob and tooth",
    )


@cache
def fed_ratio() -> Expression:
    """(9.15) as an Expression."""
    N, D = gearbox.ratio_terms()
    hand = q.hob_sign.symbol * q.helix_sign.symbol * q.cut_sign.symbol
    change = 1 + hand * q.feed_per_turn.symbol * turns_per_travel()
    return Expression(
        "fed_ratio",
        "Motor steps per count of the hob for a helical gear at a constant feed per turn of the table, signed (9.15).",
        (
            q.hob_sign,
            q.helix_sign,
            q.cut_sign,
            q.teeth,
            q.hob_starts,
            q.module,
            q.helix_angle,
            q.feed_per_turn,
            q.encoder_counts,
            q.motor_steps,
        ),
        ((q.fed_ratio, q.hob_sign.symbol * N / (D * change)),),
        requires=(change - sp.Rational(1, 10),),
        source="hobbing machines without a differential",
    )


@cache
def feed_error() -> Expression:
    """(9.4) as an Expression."""
    return Expression(
        "feed_error",
        "What the rounded ratio of the feed costs at most, in steps (9.4).",
        (q.feed_counts, q.travel, q.common_denominator),
        ((q.feed_bound, q.feed_counts.symbol * q.travel.symbol / (2 * q.common_denominator.symbol)),),
        source="rounding to the nearest numerator",
    )


@cache
def swivel() -> Expression:
    """(9.5) as an Expression."""
    module, starts, size = q.module.symbol, q.hob_starts.symbol, q.hob_diameter.symbol
    lead_angle = sp.asin(module * starts / size)
    return Expression(
        "swivel",
        "Lead angle of the hob, and the angle at which its axis must stand (9.5).",
        (q.hob_sign, q.helix_sign, q.hob_starts, q.module, q.helix_angle, q.hob_diameter),
        (
            (q.hob_lead_angle, lead_angle),
            (q.hob_swivel, q.hob_sign.symbol * lead_angle - q.helix_sign.symbol * q.helix_angle.symbol),
        ),
        requires=(size - sp.Rational(11, 10) * module * starts,),
        source="thread of the hob along the teeth of the gear",
    )


@cache
def lead_screw_ratio() -> Expression:
    """(9.14) as an Expression."""
    lead = q.thread_starts.symbol * q.thread_pitch.symbol
    return Expression(
        "lead_screw_ratio",
        "Motor steps of the lead screw per count of the spindle, signed (9.14).",
        (q.thread_sign, q.thread_starts, q.thread_pitch, q.lead_screw_pitch, q.encoder_counts, q.motor_steps),
        (
            (
                q.lead_screw_ratio,
                q.thread_sign.symbol
                * lead
                * q.motor_steps.symbol
                / (q.lead_screw_pitch.symbol * q.encoder_counts.symbol),
            ),
        ),
        source="the other use of the gearbox in the source text",
    )


def prove_lead_is_that_of_the_helix_on_the_reference_cylinder() -> None:
    """(9.1) tan β = π d / L: unrolled, the tooth trace rises by L over the circumference."""
    lead = helical_lead()["gear_lead"]
    circumference = sp.pi * q.teeth.symbol * q.module.symbol  # times 1/cos β
    assert is_zero(sp.tan(q.helix_angle.symbol) * lead * sp.cos(q.helix_angle.symbol) - circumference)


def prove_table_turns_against_the_helix_while_the_feed_climbs() -> None:
    """(9.2) Signs, from the motion of a hob at +x of the gear, its axis along y.

    A thread of hand s_h and reduced pitch a is at y = s_h a (θ - ψ) when the hob has turned by ψ about y: it carries
    the tooth at x = r along, so the table turns by φ = -s_h a ψ / r. The tooth of the hob next to the gear moves in z
    with the sign of ψ; climbing, the hob travels the other way. At height Z a tooth of hand s_β stands at the angle
    φ + s_β 2π Z/L, which must not change: φ = -s_β 2π Z/L. Positive is the turn with a right-hand hob.
    """
    psi, a, r, Z, L = sp.symbols("psi a r Z L", positive=True)
    s_h, s_b = q.hob_sign.symbol, q.helix_sign.symbol
    for forward in (1, -1):  # either way of turning may be called forward
        x, y, z = sp.Matrix([1, 0, 0]), sp.Matrix([0, 1, 0]), sp.Matrix([0, 0, 1])
        tooth = (forward * y).cross(-x)  # velocity of the hob's tooth that is next to the gear
        climbing = -tooth.dot(z)  # direction in which the hob travels
        by_hob = -s_h * a * forward * psi / r
        by_travel = -s_b * 2 * sp.pi * climbing * Z / L
        positive = sp.sign(by_hob.subs({s_h: 1, a: 1, r: 1, psi: 1}))
        assert sp.simplify(positive * by_hob - s_h * a * psi / r) == 0
        assert sp.simplify(positive * by_travel + s_b * 2 * sp.pi * Z / L) == 0
    ratio = feed_ratio()["feed_ratio"].subs({q.feed_sign.symbol: 1, q.helix_sign.symbol: 1})
    assert is_zero(ratio * q.feed_counts.symbol * helical_lead()["gear_lead"] + q.motor_steps.symbol)


def prove_bound_of_the_rounded_feed_is_kept_by_published_fractions() -> None:
    """(9.4) 16000 steps, 30 teeth, m_n = 1, β = 20°, 1000 counts/mm, over 100 mm: errors of two continued fractions.

    Known are 1.4e-4 step for 1635/28159 and 2e-8 for 10093/173828; both are better than (9.4), which every numerator
    rounded to the nearest keeps.
    """
    rule, bound = feed_ratio(), feed_error()["feed_bound"]
    job = (-1, 1, 30, 1, sp.pi / 9, 16000, 1000)  # counts go up in the conventional cut of a right-hand gear
    at = {quantity.symbol: value for quantity, value in zip(rule.inputs, job, strict=True)}
    exact = rule["feed_ratio"].subs(at).evalf(40)
    for N, D, low, high in ((1635, 28159, 1.35e-4, 1.45e-4), (10093, 173828, 1.5e-8, 2.5e-8)):
        error = abs(exact - sp.Rational(N, D)) * 100_000
        assert low < error < high
        values = {q.feed_counts.symbol: 1000, q.travel.symbol: 100, q.common_denominator.symbol: D}
        assert error <= bound.subs(values)


def prove_thread_of_the_hob_lies_along_the_teeth() -> None:
    """(9.5) At the point between hob and gear, in the plane x = const, thread and tooth have one direction.

    For a hob of axis a, r from its axis to the point, and p = a × r, a right-hand thread runs along cos λ p + sin λ a.
    """
    rule = swivel()
    eta, lam, beta = sp.symbols("eta lambda beta", real=True)
    s_h, s_b = q.hob_sign.symbol, q.helix_sign.symbol
    axis, outward = sp.Matrix([0, sp.cos(eta), sp.sin(eta)]), sp.Matrix([-1, 0, 0])
    for hob in (1, -1):
        for gear in (1, -1):
            thread = sp.cos(lam) * axis.cross(outward) + hob * sp.sin(lam) * axis
            tooth = sp.Matrix([0, gear * sp.sin(beta), sp.cos(beta)])
            across = thread.cross(tooth)[0].subs(eta, hob * lam - gear * beta)
            assert is_zero(across)
            stands = rule["hob_swivel"].subs({s_h: hob, s_b: gear})
            assert sp.simplify(stands - hob * rule["hob_lead_angle"] + gear * q.helix_angle.symbol) == 0


def prove_a_thread_of_the_screws_own_pitch_turns_the_screw_with_the_spindle() -> None:
    """(9.14) P = P_L, one start: a turn of the spindle gives the steps of a turn of the screw; 8 tpi = 127/40 mm."""
    rule = lead_screw_ratio()
    a_turn = rule["lead_screw_ratio"] * q.encoder_counts.symbol
    same = {q.thread_pitch.symbol: q.lead_screw_pitch.symbol, q.thread_starts.symbol: 1, q.thread_sign.symbol: 1}
    assert a_turn.subs(same) == q.motor_steps.symbol
    metric = {q.thread_pitch.symbol: sp.Rational(127, 40), q.lead_screw_pitch.symbol: 2, q.thread_starts.symbol: 2}
    assert (a_turn / q.motor_steps.symbol).subs(metric | {q.thread_sign.symbol: -1}) == -sp.Rational(127, 40)


def prove_a_fed_helical_gear_is_in_mesh_all_along() -> None:
    """(9.15) One turn of the table at the feed f: hob and travel, each by (9.2), give the same turn."""
    hob, S, E = q.hob_sign.symbol, q.motor_steps.symbol, q.encoder_counts.symbol
    rule, with_encoder = fed_ratio()["fed_ratio"], feed_ratio()["feed_ratio"]
    counts = S * hob / rule  # of the hob, in one turn of the table, which a right-hand hob turns forward
    climbing = q.cut_sign.symbol * q.feed_per_turn.symbol
    by_feed = (with_encoder * q.feed_counts.symbol).subs(q.feed_sign.symbol, 1) * climbing
    turned = hob_ratio()["hob_ratio"] * counts + by_feed
    for sign in (1, -1):
        assert sp.simplify((turned - sign * S).subs(hob, sign)) == 0
    assert not sp.simplify(turned).has(E)
