"""Chapter 7. The electronic gearbox: from encoder counts of the hob to motor steps of the work, exactly.

    R = G N_encoder / (k N_motor)                          encoder counts per motor step       (7.1)
    P_desired = e / R = N e / D,   N = k N_motor,  D = G N_encoder                             (7.2)
    p = floor((2 N e + D) / (2 D))                         the nearest whole step              (7.3)
    p = floor((N e + a_0) / D),    a_0 = floor(D / 2)      the same, without the factor 2      (7.4)
    a' = a + d N - s D,  s = [a + d N ≥ D] - [a + d N < 0],  p' = p + s                        (7.5)

(7.5) is the incremental form: the remainder a starts at a_0 and stays in 0 ≤ a < D; one edge d = ±1 gives at most one
step, if N ≤ D. Then |p - N e / D| ≤ 1/2 for every history. The rule of the source text, floor(e / R), lags up to a
whole step (7.6). Blank and depth of a spur gear: d_a = m (G + 2), h = f_h m + h_+ (7.7).

Any ratio, also a negative one or one above 1, is N_j = q_j D + N_j' with 0 ≤ N_j' < D; axis j = 1, 2, ... gives

    a' = a + d N_j' - s D,   s as in (7.5),   p' = p + d q_j + s                               (7.8)

over one common denominator, so that |p - Σ N_j e_j / D| ≤ 1/2 for every history of the edges of all axes. Play of H
counts keeps a dithering encoder from stepping: with x from 0 to H,

    d' = [x + d > H] - [x + d < 0],   x' = x + d - d'                                          (7.9)

passes on an edge only where the play is used up; it costs at most H N / D of position.

A motor of acceleration a needs for w steps per second, and misses where it is engaged at that speed,

    t_r = w / a,   m = w²/(2 a)                                                                (7.10)

A hob that takes the time T from rest to that speed, faster than the motor, leaves it m - w T/2 + w t_0 behind, where
t_0 = sqrt(2/a) is the time of a first step, before which nothing is seen. If L steps may wait, T must be at least

    T_min = w/a - 2 (L/w - t_0), at most w/a and at least 0; also for a stop                   (7.11)

Engaged at speed, the motor overtakes what it has missed: it goes on to w + u, and brakes to w with b a, b = 3/4,

    m = (1 + 1/b) u²/(2 a) + u t_u,   t_c = (w + (1 + 1/b) u)/a + t_u                          (7.12)

u is that with t_u = 0, or w_max - w where this is less. On the pitch circle of diameter d one count and one step are

    δ_e = π d k/(G N_encoder),   δ_p = π d/N_motor                                             (7.13)

A counter of the board that is read as c and then, m counts on, as c' = (c + m) mod M, M = 2^16, tells

    m = c' - c - s M,   s = [c' - c ≥ M/2] - [c' - c < -M/2],   for -M/2 ≤ m < M/2             (7.14)

wherever it has run over in between: added up in 64 bits, its counts go on for ever.
"""

from __future__ import annotations

from fractions import Fraction
from functools import cache

import sympy as sp

from derivations import notation as q
from derivations.expression import Expression

_SOURCE = "Digital Control for a Gear Hobbing Machine (Digital Machinist 15-4), generalised to hob starts"


def ratio_terms() -> tuple[sp.Expr, sp.Expr]:
    """N and D of (7.2), motor steps per encoder count as a fraction."""
    return q.hob_starts.symbol * q.motor_steps.symbol, q.teeth.symbol * q.encoder_counts.symbol


def truth(condition: sp.Basic) -> sp.Piecewise:
    """[condition] of (7.5): 1 where it holds, else 0."""
    return sp.Piecewise((1, condition), (0, True))


@cache
def gearbox_ratio() -> Expression:
    """(7.1) as an Expression."""
    N, D = ratio_terms()
    return Expression(
        "gearbox_ratio",
        "Pulse ratio of the electronic gearbox, encoder counts per motor step (7.1).",
        (q.teeth, q.hob_starts, q.encoder_counts, q.motor_steps),
        ((q.pulse_ratio, D / N),),
        source=_SOURCE + ", eq. 2",
    )


@cache
def gearbox_terms() -> Expression:
    """N and D of one job, in integers (7.2)."""
    N, D = ratio_terms()
    return Expression(
        "gearbox_terms",
        "Ratio of one job as whole numbers: motor steps N per encoder counts D, not reduced (7.2).",
        (q.teeth, q.hob_starts, q.encoder_counts, q.motor_steps),
        ((q.steps_numerator, N), (q.steps_denominator, D)),
        source=_SOURCE + ", eq. 2",
    )


@cache
def desired_position() -> Expression:
    """(7.2) as an Expression."""
    return Expression(
        "desired_position",
        "Position the work should have after e encoder counts, in motor steps (7.2).",
        (q.encoder_position, q.pulse_ratio),
        ((q.desired_position, q.encoder_position.symbol / q.pulse_ratio.symbol),),
        source=_SOURCE + ", eq. 3",
    )


@cache
def nearest_position() -> Expression:
    """(7.3) as an Expression."""
    N, D, e = q.steps_numerator.symbol, q.steps_denominator.symbol, q.encoder_position.symbol
    return Expression(
        "nearest_position",
        "Whole motor step nearest to the desired position (7.3).",
        (q.encoder_position, q.steps_numerator, q.steps_denominator),
        ((q.nearest_position, sp.floor((2 * N * e + D) / (2 * D), evaluate=False)),),
        requires=(2**53 - sp.Abs(2 * N * e + D),),  # a double holds the numerator; else it may round across a step
        source="rounding to nearest; never more than half a step off",
    )


@cache
def floor_position() -> Expression:
    """(7.6), the rule of the source text, as an Expression."""
    position = sp.floor(q.encoder_position.symbol / q.pulse_ratio.symbol)
    return Expression(
        "floor_position",
        "Steps delivered by the floating rule of the source text, floor(e / R) (7.6).",
        (q.encoder_position, q.pulse_ratio),
        ((q.floor_position, position),),
        source=_SOURCE + ", eq. 4",
    )


@cache
def gearbox_start() -> Expression:
    """a_0 of (7.4) as an Expression."""
    return Expression(
        "gearbox_start",
        "Remainder of the step rule at the start of a job, half of D rounded down (7.4).",
        (q.steps_denominator,),
        ((q.first_remainder, sp.floor(q.steps_denominator.symbol / 2)),),
        source="rounding to nearest",
    )


@cache
def gearbox_step() -> Expression:
    """(7.5) as an Expression: the integer kernel of the firmware."""
    a = q.remainder.symbol + q.edge.symbol * q.steps_numerator.symbol
    D = q.steps_denominator.symbol
    s = truth(a >= D) - truth(a < 0)
    return Expression(
        "gearbox_step",
        "One encoder edge of the electronic gearbox: the step to deliver and the new remainder (7.5).",
        (q.remainder, q.edge, q.steps_numerator, q.steps_denominator),
        ((q.step, s), (q.next_remainder, a - s * D)),
        requires=(D + 1 - q.steps_numerator.symbol, D - q.remainder.symbol),
        source="incremental form of rounding to nearest, for N <= D",
    )


@cache
def gearbox_edge() -> Expression:
    """(7.8) as an Expression: any rational ratio, one edge of one axis a call."""
    a = q.remainder.symbol + q.edge.symbol * q.increment.symbol
    D = q.steps_denominator.symbol
    s = truth(a >= D) - truth(a < 0)
    return Expression(
        "gearbox_edge",
        "One encoder edge of one axis, for any ratio q + N'/D: the steps to deliver and the new remainder (7.8).",
        (q.remainder, q.edge, q.increment, q.base_step, q.steps_denominator),
        ((q.edge_steps, q.edge.symbol * q.base_step.symbol + s), (q.next_remainder, a - s * D)),
        requires=(D - q.increment.symbol, D - q.remainder.symbol),
        source="incremental form of rounding to nearest, several axes over one denominator",
    )


@cache
def encoder_hysteresis() -> Expression:
    """(7.9) as an Expression."""
    moved = q.play.symbol + q.edge.symbol
    passed = truth(moved > q.hysteresis.symbol) - truth(moved < 0)
    return Expression(
        "encoder_hysteresis",
        "Play of a few counts before a reversal of the encoder is followed (7.9).",
        (q.play, q.edge, q.hysteresis),
        ((q.passed_edge, passed), (q.next_play, moved - passed)),
        requires=(q.hysteresis.symbol + 1 - q.play.symbol,),
        source="mechanical backlash, in counts",
    )


#: Readings of the counters of (7.14).
COUNTER_RANGE = sp.Integer(2) ** 16


@cache
def counter_motion() -> Expression:
    """(7.14) as an Expression."""
    apart = q.count_now.symbol - q.count_before.symbol
    wraps = truth(apart >= COUNTER_RANGE / 2) - truth(apart < -COUNTER_RANGE / 2)
    return Expression(
        "counter_motion",
        "Counts between two readings of a 16-bit counter that may have run over in between (7.14).",
        (q.count_before, q.count_now),
        ((q.counted, apart - wraps * COUNTER_RANGE),),
        source="arithmetic modulo 2^16",
    )


@cache
def hobbed_blank() -> Expression:
    """(7.7) as an Expression."""
    m = q.module.symbol
    return Expression(
        "hobbed_blank",
        "Blank diameter and depth of cut of a hobbed spur gear (7.7).",
        (q.teeth, q.module, q.depth_factor, q.depth_extra),
        (
            (q.blank_diameter, m * (q.teeth.symbol + 2)),
            (q.cut_depth, q.depth_factor.symbol * m + q.depth_extra.symbol),
        ),
        source=_SOURCE + ": (G + 2)/P and 2.25/P; other depth rules of the field",
    )


#: Part of its acceleration with which a motor that has caught up brakes; the firmware's motion does the same.
BRAKING = sp.Rational(3, 4)


@cache
def run_up() -> Expression:
    """(7.10, 7.11) as an Expression."""
    w, a, L = q.step_rate.symbol, q.step_acceleration.symbol, q.lag_limit.symbol
    return Expression(
        "run_up",
        "A motor's time to speed, what it misses meanwhile, and the shortest run-up of the hob (7.10, 7.11).",
        (q.step_rate, q.step_acceleration, q.lag_limit),
        (
            (q.run_up_time, w / a),
            (q.missed_steps, w**2 / (2 * a)),
            (q.shortest_run_up, sp.Max(0, w / a - sp.Max(0, 2 * L / w - 2 * sp.sqrt(2 / a)))),
        ),
        source="constant acceleration",
    )


@cache
def catch_up() -> Expression:
    """(7.12) as an Expression."""
    w, a, top = q.step_rate.symbol, q.step_acceleration.symbol, q.top_rate.symbol
    both = 1 + 1 / BRAKING
    missed = run_up()["missed_steps"]
    u = sp.Min(w / sp.sqrt(both), top - w)
    plateau = (missed - both * u**2 / (2 * a)) / u
    return Expression(
        "catch_up",
        "How a motor that is engaged at speed overtakes what it has missed (7.12).",
        (q.step_rate, q.step_acceleration, q.top_rate),
        ((q.overtaking_rate, u), (q.catch_up_time, (w + both * u) / a + plateau)),
        requires=(top - sp.Rational(1001, 1000) * w,),
        source="constant acceleration",
    )


@cache
def resolution() -> Expression:
    """(7.13) as an Expression, in micrometres."""
    around = 1000 * sp.pi * q.pitch_diameter.symbol
    N, D = ratio_terms()
    return Expression(
        "resolution",
        "Way of the pitch circle per encoder count and per motor step (7.13).",
        (q.pitch_diameter, q.teeth, q.hob_starts, q.encoder_counts, q.motor_steps),
        ((q.count_arc, around * N / D / q.motor_steps.symbol), (q.step_arc, around / q.motor_steps.symbol)),
        source="one turn of the table is a turn of the pitch circle",
    )


#: The table of the source text for R = 3.142: encoder counts, desired position as printed, steps delivered.
PUBLISHED_TABLE = (
    (1, "0.318", 0),
    (2, "0.637", 0),
    (3, "0.955", 0),
    (4, "1.273", 1),
    (5, "1.592", 1),
    (6, "1.910", 1),
    (7, "2.228", 2),
    (8, "2.546", 2),
    (9, "2.865", 2),
    (10, "3.183", 3),
)


def prove_published_table() -> None:
    """(7.2, 7.6) The ten rows of the source text: steps delivered exactly, desired positions to the digits printed.

    The text prints R = 3.142, but rows 5 and 9 (1.592 and 2.865) are those of R = π, of which 3.142 is the rounding:
    with 3.142 they would read 1.591 and 2.864. The steps delivered are the same for both.
    """
    e, R = q.encoder_position.symbol, q.pulse_ratio.symbol
    differing = []
    for count, printed, delivered in PUBLISHED_TABLE:
        for ratio in (sp.Rational("3.142"), sp.pi):
            assert floor_position()["floor_position"].subs({e: count, R: ratio}) == delivered
            desired = desired_position()["desired_position"].subs({e: count, R: ratio})
            if sp.floor(desired * 1000 + sp.Rational(1, 2)) != 1000 * sp.Rational(printed):
                differing.append((count, ratio))
    assert differing == [(5, sp.Rational("3.142")), (9, sp.Rational("3.142"))]


def prove_both_ways_of_rounding_give_a_nearest_step() -> None:
    """(7.3, 7.4) For every N and D up to 12 and counts of either sign: floor((N e + a_0)/D), no more than 1/2 off."""
    for D in range(1, 13):
        (start,) = gearbox_start().exact(D)
        for N in range(1, 13):
            for e in range(-2 * D, 2 * D + 1):
                (nearest,) = nearest_position().exact(e, N, D)
                assert nearest == (N * e + start) // D
                assert abs(nearest - Fraction(N * e, D)) <= Fraction(1, 2)


def prove_increment_keeps_position_and_remainder_together() -> None:
    """(7.5) a' + s D = a + d N: so p D + a - N e never changes, and p = floor((N e + a_0)/D) while 0 ≤ a < D."""
    rule = gearbox_step()
    a, d, N, D = (quantity.symbol for quantity in rule.inputs)
    assert sp.expand(rule["next_remainder"] + rule["step"] * D - (a + d * N)) == 0


def prove_counted_steps_are_the_nearest_ones() -> None:
    """(7.5) Forwards over all remainders of every N <= D <= 9 and back beyond the start: 0 <= a < D, never 1/2 off.

    What holds for every width of the numbers is decided by a solver, of the compiled function.
    """
    for D in range(1, 10):
        for N in range(1, D + 1):
            (remainder,), count, position = gearbox_start().exact(D), 0, Fraction(0)
            for edge in [1] * 2 * D + [-1] * 4 * D + [1] * D:
                step, remainder = gearbox_step().exact(remainder, edge, N, D)
                count, position = count + edge, position + step
                assert 0 <= remainder < D
                assert abs(position - Fraction(N * count, D)) <= Fraction(1, 2)


def prove_any_ratio_keeps_position_and_remainder_together() -> None:
    """(7.8) a' + (d q + s) D = a + d (q D + N'): steps follow the whole ratio of the axis, of either sign."""
    rule = gearbox_edge()
    a, d, rest, base, D = (quantity.symbol for quantity in rule.inputs)
    assert sp.expand(rule["next_remainder"] + rule["edge_steps"] * D - (a + d * (base * D + rest))) == 0


def prove_base_step_zero_is_the_simple_rule() -> None:
    """(7.8) Limit case: with q = 0 it is (7.5)."""
    simple, general = gearbox_step(), gearbox_edge()
    values = {q.base_step.symbol: 0, q.increment.symbol: q.steps_numerator.symbol}
    assert general["edge_steps"].subs(values) == simple["step"]
    assert sp.expand(general["next_remainder"].subs(values) - simple["next_remainder"]) == 0


def prove_play_neither_makes_nor_loses_counts() -> None:
    """(7.9) x' + d' = x + d: what does not pass is in the play, and the play never leaves 0 ... H."""
    rule = encoder_hysteresis()
    x, d, H = (quantity.symbol for quantity in rule.inputs)
    assert sp.expand(rule["next_play"] + rule["passed_edge"] - (x + d)) == 0
    for width in range(4):
        for state in range(width + 1):
            for edge in (1, -1):
                assert 0 <= rule["next_play"].subs({x: state, d: edge, H: width}) <= width


def prove_a_counter_that_runs_over_tells_every_motion_of_less_than_half_its_range() -> None:
    """(7.14) c' = c + m + k M with c' from 0 to M - 1 leaves m - k M for c' - c: k = -1, 0, 1 and both ends of each."""
    motion, M, H = counter_motion()["counted"], int(COUNTER_RANGE), int(COUNTER_RANGE) // 2
    edges = set(range(-H, H, 997)) | {-H, -H + 1, -1, 0, 1, H - 1}
    for before in (0, 1, H - 1, H, H + 1, M - 2, M - 1):
        for moved in edges:
            assert motion.subs({q.count_before.symbol: before, q.count_now.symbol: (before + moved) % M}) == moved


def prove_any_ratio_is_at_most_half_a_step_off() -> None:
    """(7.8) Two axes with ratios q + N'/D of either sign, edges of both mixed up: |p - Σ N_j e_j / D| <= 1/2."""
    for D in range(1, 8):
        for N, M in ((5, -9), (-1, 2), (D, 3 * D + 1)):
            (remainder,), target, position = gearbox_start().exact(D), 0, Fraction(0)
            for k in range(12 * D):
                ratio, edge = (N if k % 3 else M), (-1 if k % 5 == 2 or k > 8 * D else 1)
                steps, remainder = gearbox_edge().exact(remainder, edge, ratio % D, ratio // D, D)
                target, position = target + edge * ratio, position + steps
                assert abs(position - Fraction(target, D)) <= Fraction(1, 2)


def prove_hob_that_runs_up_faster_than_the_motor_leaves_it_the_lag_of_the_limit() -> None:
    """(7.10, 7.11) Places by integration; the lag is greatest where the motor reaches w, and is L for T = T_min."""
    w, a, L, T = (quantity.symbol for quantity in (q.step_rate, q.step_acceleration, q.lag_limit, q.travel))
    t = sp.Symbol("t", positive=True)
    rule = run_up()
    first = sp.sqrt(2 / a)
    assert sp.simplify(sp.integrate(a * t, (t, 0, first)) - 1) == 0
    hob = sp.integrate(w * t / T, (t, 0, T)) + w * (first + rule["run_up_time"] - T)  # at speed from T on
    motor = sp.integrate(a * t, (t, 0, rule["run_up_time"]))  # begins later by `first`
    assert sp.simplify(motor - rule["missed_steps"]) == 0
    # the lag is greatest now: before, the hob is faster; afterwards both have the same speed
    lag = sp.simplify(hob - motor)
    assert sp.simplify(lag.subs(T, w / a - 2 * (L / w - first)) - L) == 0
    at = {w: 2000, a: 20_000, L: 100}  # 0.1 s - 2 (50 ms - 10 ms)
    assert rule["shortest_run_up"].subs(at) == sp.Rational(1, 50)
    assert rule["shortest_run_up"].subs({w: 8000, a: 8000, L: 100}) == 1  # 100 steps are 12.5 ms, a first step takes 16
    assert rule["shortest_run_up"].subs({w: 100, a: 8000, L: 100}) == 0


def prove_motor_that_catches_up_ends_beside_the_hob_with_its_speed() -> None:
    """(7.12) Way by the areas under the speeds: what is gained beyond w is what was missed before."""
    w, a, top = (quantity.symbol for quantity in catch_up().inputs)
    for speed, acceleration, most in ((30, 7, 1000), (30, 7, 35), (1, 3, 100), (9, 2, 10)):
        at = {w: speed, a: acceleration, top: most}
        u, total = (catch_up()[name].subs(at) for name in ("overtaking_rate", "catch_up_time"))
        up, down = (speed + u) / acceleration, u / (BRAKING * acceleration)
        level = total - up - down
        assert level >= 0
        way = (speed + u) * up / 2 + (speed + u) * level + speed * down + u * down / 2
        assert sp.simplify(way - speed * total) == 0
        assert speed + u <= most


def prove_one_count_moves_the_pitch_circle_by_the_ratio_of_steps() -> None:
    """(7.13) δ_e = (N/D) δ_p; the rule of the field for 16 DP and 0.0002 in asks for 981 counts: c >= π/(DP δ)."""
    N, D = ratio_terms()
    rule = resolution()
    assert sp.simplify(rule["count_arc"] - N / D * rule["step_arc"]) == 0
    teeth = 20
    values = {
        q.pitch_diameter.symbol: teeth * sp.Rational("25.4") / 16,
        q.teeth.symbol: teeth,
        q.hob_starts.symbol: 1,
        q.encoder_counts.symbol: 981,
    }
    assert abs(rule["count_arc"].subs(values) / (1000 * sp.Rational("25.4")) - sp.Rational(2, 10_000)) < sp.Rational(
        2, 10**7
    )
