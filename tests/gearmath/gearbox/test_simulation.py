"""Patterns of edges, the exact error, the compiled rule, and the published failures of the floating rule."""

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gearmath.errors import ComputationError, InputError
from gearmath.export.host import run_axes, run_edges
from gearmath.gearbox.helix import JobRatio, one_term
from gearmath.gearbox.simulation import (
    FloatRule,
    Pattern,
    Trace,
    deviations,
    pattern,
    simulate,
    simulate_job,
    worst_error,
)


def job(teeth: int) -> tuple[int, int]:
    """N/D of the source text's machine: 16000 steps, 4096 counts."""
    ratio = Fraction(16000, 4096 * teeth)
    return ratio.numerator, ratio.denominator


def run(teeth: int, kind: Pattern, edges: int, seed: int = 0):
    ratio = job(teeth)
    return simulate(run_edges, ratio, ratio[1] // 2, kind, edges, seed)


@pytest.mark.parametrize("kind", ["forward", "dither", "reversals"])
def test_pattern_does_not_depend_on_its_chunks(kind):
    whole = np.concatenate(list(pattern(kind, 30_011, seed=5)))
    parts = np.concatenate(list(pattern(kind, 30_011, seed=5, chunk=1009)))
    assert np.array_equal(whole, parts)
    assert len(whole) == 30_011
    assert set(np.unique(whole)) <= {-1, 1}


def test_dither_has_no_true_motion_and_reversals_alternate_within_5000_edges():
    (dither,) = pattern("dither", 100_000)
    assert dither.sum(dtype=int) == 0
    assert np.abs(np.cumsum(dither, dtype=int)).max() == 1
    (reversals,) = pattern("reversals", 1_000_000, seed=1)
    runs = np.diff(np.flatnonzero(np.diff(reversals)))
    assert runs.max() <= 5000
    assert runs.mean() == pytest.approx(2500, rel=0.2)


@given(
    moves=st.lists(st.tuples(st.sampled_from((1, -1)), st.sampled_from((-1, 0, 1))), min_size=1, max_size=50),
    numerator=st.integers(1, 2**30),
    denominator=st.integers(1, 2**30),
)
def test_worst_error_equals_fractions(moves, numerator, denominator):
    edges, steps = (np.array(column, np.int8) for column in zip(*moves, strict=True))
    encoder = position = 0
    errors = []
    for edge, step in moves:
        encoder, position = encoder + edge, position + step
        errors.append(abs(position - Fraction(numerator * encoder, denominator)))
    assert worst_error(edges, steps, numerator, denominator) == max(errors)


def test_sums_beyond_64_bits_are_refused():
    edges = np.ones(8, np.int8)
    with pytest.raises(ComputationError, match="64-bit"):
        deviations(edges, edges, 2**60, 2**60)


@pytest.mark.parametrize("kind", ["forward", "dither", "reversals"])
@pytest.mark.parametrize("teeth", [6, 25, 127])
def test_compiled_rule_is_never_more_than_half_a_step_off(teeth, kind):
    result = run(teeth, kind, 3_000_000, seed=teeth)
    assert result.worst_error <= Fraction(1, 2)
    numerator, denominator = job(teeth)
    assert result.position == (2 * numerator * result.encoder_position + denominator) // (2 * denominator)


@pytest.mark.parametrize("teeth", [6, 10, 25, 50, 60, 100, 125, 127, 160])
def test_dither_at_rest_moves_nothing(teeth):
    result = run(teeth, "dither", 100_000)
    assert result.position == 0
    assert result.worst_error <= Fraction(1, 2)


@pytest.mark.parametrize(
    ("teeth", "steps", "margin"),
    [(25, 3125, 0), (125, 3125, 0), (10, 1563, 1), (100, 780, 0), (127, 24, 0), (53, 2, 0)],
)
def test_float_rule_drifts_under_dither_as_published(teeth, steps, margin):
    """gearbox.md 2.1: 50 000 pairs at rest; for 25 teeth 3125 steps, 70 degrees of the table."""
    assert abs(run(teeth, "dither", 100_000).float_position) == pytest.approx(steps, abs=margin)


@pytest.mark.parametrize(("teeth", "worst"), [(6, 1.03), (10, 1.08)])
def test_float_rule_errs_by_more_than_a_step_after_ten_minutes(teeth, worst):
    """gearbox.md 2.1: 600 rpm forward, 10 minutes."""
    result = run(teeth, "forward", 600 * 4096 * 10)
    assert float(result.float_worst_error) == pytest.approx(worst, abs=0.005)
    assert result.worst_error <= Fraction(1, 2)


@pytest.mark.slow
def test_float_rule_errs_by_ten_steps_after_an_hour():
    """gearbox.md 2.1: 6 teeth, 600 rpm forward, 60 minutes: 10.4 steps."""
    result = run(6, "forward", 600 * 4096 * 60)
    assert float(result.float_worst_error) == pytest.approx(10.4, abs=0.05)
    assert result.worst_error <= Fraction(1, 2)


def test_vectorised_float_rule_equals_its_loop():
    """The interrupt of the public firmware edge by edge in float32, across the first counts float32 cannot hold."""
    first = 2**24 - 3000
    rule = FloatRule(999_999, 1_000_000)
    rule.count, rule.delivered = first, first - 17  # 17 = 1e-6 * 2^24: as many as it has delivered by then
    (edges,) = pattern("reversals", 9000, seed=3)
    factor, count, delivered, expected = np.float32(0.999999), first, first - 17, []
    for edge in edges:
        count += 1
        wanted = np.floor(float(factor * np.float32(count)) + 0.5)
        step = int(wanted > np.float32(delivered))
        delivered += step
        expected.append(step * edge)
    assert rule(edges).tolist() == expected


def test_wrong_remainder_is_noticed():
    def broken(edges, numerator, denominator, remainder):
        steps, following = run_edges(edges, numerator, denominator, remainder)
        return steps, (following + 1) % denominator

    with pytest.raises(ComputationError, match="wrong remainder"):
        simulate(broken, (25, 64), 32, "forward", 100)


def test_no_edges_are_refused():
    with pytest.raises(InputError, match="edges = 0"):
        run(10, "forward", 0)


# --- any ratio ----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("kind", ["forward", "dither", "reversals"])
@pytest.mark.parametrize(
    "ratio",
    [one_term(Fraction(125, 192)), one_term(Fraction(-20, 3)), JobRatio(25_000_128, (3_255_225, -1_451_586))],
    ids=["slow", "fast and backwards", "helical"],
)
def test_rule_of_two_axes_is_never_more_than_half_a_step_off(ratio, kind):
    result = simulate_job(run_axes, ratio, kind, 2_000_000, seed=3)
    assert result.worst_error <= Fraction(1, 2)
    wanted = result.encoder_position * ratio.numerators[0] + result.feed_position * ratio.numerators[1]
    assert result.position == (2 * wanted + ratio.denominator) // (2 * ratio.denominator)
    assert (result.feed_position != 0) == (ratio.numerators[1] != 0 and kind != "dither")


def test_both_rules_for_one_axis_agree():
    general = simulate_job(run_axes, one_term(Fraction(125, 192)), "reversals", 500_000, seed=4)
    simple = simulate(run_edges, (125, 192), 96, "reversals", 500_000, seed=4)
    assert general == simple


def test_float_rule_falls_behind_for_ever_above_one_step_an_edge():
    result = simulate_job(run_axes, one_term(Fraction(125, 64)), "forward", 100_000)
    assert result.float_position == 100_000  # one step an edge at most, where 125/64 are wanted
    assert float(result.float_worst_error) == 100_000 * 61 / 64


@pytest.mark.parametrize("boundary", [2**16, 2**24, 2**31, 2**32])
def test_exact_rule_passes_the_boundaries_of_the_counters(boundary):
    ratio = one_term(Fraction(16000, 4096 * 127))
    result = simulate_job(run_axes, ratio, "reversals", 100_000, seed=5, start=boundary - 1000)
    assert result.worst_error <= Fraction(1, 2)
    ends = [
        (2 * ratio.numerators[0] * count + ratio.denominator) // (2 * ratio.denominator)
        for count in (boundary - 1000, boundary - 1000 + result.encoder_position)
    ]
    assert result.position == ends[1] - ends[0]


def test_float_rule_stops_where_its_count_does():
    """At 2^26 counts a float32 has steps of 8 counts: the product no longer follows single edges."""
    result = simulate_job(run_axes, one_term(Fraction(125, 192)), "forward", 100_000, start=2**26)
    assert float(result.float_worst_error) > 2.0
    assert result.worst_error <= Fraction(1, 2)


def test_trace_keeps_the_worst_of_every_stretch():
    trace = Trace(1000, stretches=10)
    exact, loose = np.linspace(-0.5, 0.4, 1000), np.arange(1000.0)
    for part in (slice(0, 250), slice(250, 1000)):
        trace.add(exact[part], loose[part])
    done, worst, float_worst = trace.arrays
    assert done[-1] == 1000
    assert (worst.max(), float_worst.max()) == (0.5, 999.0)
    assert np.array_equal(float_worst, done - 1)
