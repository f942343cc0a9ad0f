"""The ratio of helical jobs: published roundings, bounds that are kept, and the compiled rule of two axes."""

import math
from fractions import Fraction

import mpmath
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from gearmath.errors import InputError
from gearmath.export.host import run_axes
from gearmath.gearbox.helix import PART, TRAVEL, Helix, JobRatio, helical_ratio, one_term, simplest, two_terms
from gearmath.gearbox.train import plan
from gearmath.specs.hobbing import HobbingMachine, load_hobbing_machine
from gearmath.specs.toml import bundled, parse

TEXT = bundled("hobbing_helical.toml").read_text("utf-8")


@pytest.fixture(scope="module")
def helical() -> HobbingMachine:
    return load_hobbing_machine(bundled("hobbing_helical.toml"))


@pytest.fixture(scope="module")
def plewes() -> HobbingMachine:
    return load_hobbing_machine(bundled("hobbing_plewes.toml"))


def steps_per_count(teeth: int, module: float, angle: float) -> Fraction:
    """16000 steps over the lead, 1000 counts per mm, to 40 digits by mpmath."""
    with mpmath.workdps(40):
        value = 16 * mpmath.sin(mpmath.radians(mpmath.mpf(angle))) / (mpmath.pi * teeth * mpmath.mpf(module))
        return Fraction(int(value * mpmath.mpf(2) ** 120), 2**120)


def test_lead_of_the_reference_is_275_562_mm(helical):
    job = plan(helical, 30, hob="m1", helix=Helix(20.0))
    assert job.helix is not None
    assert f"{job.helix.lead:.3f}" == "275.562"


@pytest.mark.parametrize(("ratio", "error"), [(Fraction(1635, 28159), 1.4e-4), (Fraction(10093, 173828), 2e-8)])
def test_published_roundings_err_as_published(ratio, error):
    """Steps per µm for 30 teeth, m = 1, 20°: errors over 100 mm; no fraction of a smaller denominator is better."""
    exact = steps_per_count(30, 1.0, 20.0)
    assert float(abs(exact - ratio) * 100_000) == pytest.approx(error, rel=0.05 if error > 1e-5 else 0.25)
    assert exact.limit_denominator(ratio.denominator) == ratio


def test_simplest_fraction_of_pi_is_the_one_of_the_tables():
    """Best approximations of π, OEIS A063674/A063673: 3, 13/4, 16/5, 19/6, 22/7, 179/57, 201/64 ... 355/113."""
    pi = Fraction("3.14159265358979323846264338327950288")
    near = [simplest(pi, needed) for needed in (6, 10, 100, 1000, 10**4, 10**6)]
    assert near == [3, Fraction(16, 5), Fraction(22, 7), Fraction(201, 64), Fraction(333, 106), Fraction(355, 113)]
    assert simplest(Fraction(355, 113), 10**9) == Fraction(355, 113)


@settings(max_examples=300)
@given(value=st.fractions(Fraction(1, 50), 30, max_denominator=10**9), needed=st.integers(51, 10**5))
def test_no_fraction_of_a_smaller_denominator_is_as_near(value, needed):
    """By trial of every denominator: the nearest numerator of each is too far away."""
    found = simplest(value, needed)
    assert abs(found - value) * needed <= 1
    smaller = np.arange(1, found.denominator)
    nearest = np.round(smaller * float(value))
    assert (np.abs(nearest / smaller - float(value)) * needed > 1 - 1e-6).all()


@settings(max_examples=200)
@given(
    teeth=st.integers(6, 999),
    angle=st.floats(0.01, 60.0),
    module=st.sampled_from((1.0, 1.5)),
    hand=st.sampled_from(("right", "left")),
)
def test_table_is_never_a_hundredth_of_a_step_from_the_true_helix(helical, teeth, angle, module, hand):
    ratio, rounding = helical_ratio(helical, teeth, 1, module, Helix(angle, hand))
    hob, feed = (Fraction(numerator, ratio.denominator) for numerator in ratio.numerators)
    assert hob == Fraction(16000, 4096 * teeth)
    size = steps_per_count(teeth, module, angle)
    assert abs(abs(feed) - size) * 1000 * TRAVEL <= Fraction(1, PART)
    assert float(abs(abs(feed) - size) * 1000 * TRAVEL) == pytest.approx(rounding.error, abs=1e-9)
    assert rounding.error <= rounding.bound <= 1 / PART
    assert ratio.denominator <= 2**62


def test_sign_of_the_feed_follows_helix_and_scale_alone(helical, plewes):
    """Climbing, a right-hand gear turns back: the table is slower with hob and gear of one hand, faster otherwise."""

    def signs(text: str, hand: str) -> tuple[bool, bool]:
        ratio, _ = helical_ratio(parse(text, HobbingMachine, "m"), 30, 1, 1.0, Helix(20.0, hand))
        return ratio.numerators[0] > 0, ratio.numerators[1] > 0

    left_hob = TEXT.replace('hob_hand = "right"', 'hob_hand = "left"')
    reversed_scale = TEXT.replace('counts_up = "climb"', 'counts_up = "conventional"')
    assert signs(TEXT, "right") == (True, False)
    assert signs(TEXT, "left") == (True, True)
    assert signs(left_hob, "right") == (False, False)
    assert signs(left_hob, "left") == (False, True)
    assert signs(reversed_scale, "right") == (True, True)
    slower = helical_ratio(plewes, 30, 1, 1.0, Helix(20.0, "right", "climb", Fraction(3, 10)))[0]
    faster = helical_ratio(plewes, 30, 1, 1.0, Helix(20.0, "left", "climb", Fraction(3, 10)))[0]
    spur = Fraction(16000, 4096 * 30)
    assert (
        Fraction(slower.numerators[0], slower.denominator) < spur < Fraction(faster.numerators[0], faster.denominator)
    )


@pytest.mark.parametrize("cut", ["climb", "conventional"])
@pytest.mark.parametrize("hand", ["right", "left"])
def test_a_fixed_feed_cuts_the_same_helix_as_an_encoder_on_the_feed(helical, plewes, hand, cut):
    """500 mm of travel, 0.3 mm per turn of the table: both tables end within a hundredth of a step of each other."""
    feed = Fraction(3, 10)
    fixed, _ = helical_ratio(plewes, 30, 1, 1.0, Helix(20.0, hand, cut, feed))
    followed, _ = helical_ratio(helical, 30, 1, 1.0, Helix(20.0, hand))
    steps = 16000 * TRAVEL / feed  # turns of the table
    counts = steps * fixed.denominator / fixed.numerators[0]  # of the hob
    travel = 1000 * TRAVEL * (1 if cut == "climb" else -1)  # counts of the feed go up in climb hobbing
    reached = (counts * followed.numerators[0] + travel * followed.numerators[1]) / followed.denominator
    assert abs(reached - steps) <= Fraction(2, PART)


def test_whole_part_and_rest_of_negative_ratios():
    ratio = JobRatio(5, (-12, 7))
    assert (ratio.base, ratio.increment) == ((-3, 1), (3, 2))
    assert (ratio.first_remainder, ratio.steps_per_edge) == (2, 3)
    assert one_term(Fraction(-6, 5)).base == (-2, 0)


def test_denominator_is_the_least_multiple_of_the_hobs_that_keeps_the_bound():
    ratio = two_terms(Fraction(25, 192), Fraction(1, 17), Fraction(1000))
    assert ratio.denominator % 192 == 0
    assert (ratio.denominator - 192) * 2 <= TRAVEL * PART * 1000 < ratio.denominator * 2


JOBS = st.tuples(
    st.fractions(-8, 8, max_denominator=10**6).filter(bool),
    st.fractions(-3, 3, max_denominator=10**9),
    st.integers(1, 2000),
)
RUNS = st.lists(
    st.tuples(st.sampled_from((0, 1)), st.sampled_from((1, -1)), st.integers(1, 60)), min_size=1, max_size=12
)


@pytest.mark.usefixtures("host_compiler")
@settings(max_examples=200)
@given(job=JOBS, runs=RUNS)
def test_compiled_rule_stands_at_the_nearest_step_of_the_rational_sum(job, runs):
    """After every edge of any history of hob and feed, in Fractions."""
    hob, feed, per_mm = job
    ratio = two_terms(hob, feed, Fraction(per_mm))
    axes = np.repeat([axis for axis, _, _ in runs], [n for *_, n in runs])
    edges = np.repeat([edge for _, edge, _ in runs], [n for *_, n in runs])
    steps, _ = run_axes(axes, edges, ratio.base, ratio.increment, ratio.denominator, ratio.first_remainder)
    counts, position = [0, 0], 0
    terms = [Fraction(numerator, ratio.denominator) for numerator in ratio.numerators]
    for axis, edge, step in zip(axes.tolist(), edges.tolist(), steps.tolist(), strict=True):
        counts[axis] += edge
        position += step
        wanted = counts[0] * terms[0] + counts[1] * terms[1]
        assert abs(position - wanted) <= Fraction(1, 2)
        assert position in (math.floor(wanted + Fraction(1, 2)), math.ceil(wanted - Fraction(1, 2)))


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (([0], [0]), "edges"),
        (([2], [1]), "axes"),
        (([0, 1], [1]), "axes"),
        (([0], [1], (65, 0)), "64 whole steps"),
        (([0], [1], (0, 0), (5, 0)), "D"),
        (([0], [1], (0, 0), (0, 0), 0), "D"),
        (([0], [1], (0, 0), (0, 0), 5, 5), "D"),
    ],
)
def test_rule_of_two_axes_refuses_what_lies_outside_its_domain(arguments, words):
    defaults = ([0], [1], (0, 0), (1, 0), 5, 2)
    with pytest.raises(InputError, match=words):
        run_axes(*arguments, *defaults[len(arguments) :])


@pytest.mark.parametrize(
    ("name", "helix", "words"),
    [
        ("helical", Helix(0.0), "helix = 0: .*60 degrees"),
        ("helical", Helix(61.0), "helix = 61"),
        ("helical", Helix(float("nan")), "helix = nan"),
        ("helical", Helix(20.0, feed=Fraction(1)), "feed = 1: .* has an encoder on the feed"),
        ("plewes", Helix(20.0), "no encoder on the feed"),
        ("plewes", Helix(20.0, feed=Fraction(0)), "feed = 0: .*0.001"),
    ],
)
def test_helix_that_cannot_be_cut_is_refused(request, name, helix, words):
    with pytest.raises(InputError, match=words):
        plan(request.getfixturevalue(name), 30, hob="m1", helix=helix)


def test_helix_needs_one_hob(plewes):
    with pytest.raises(InputError, match="choose one of 32dp, 36dp"):
        plan(plewes, 30, helix=Helix(20.0, feed=Fraction(1, 4)))
