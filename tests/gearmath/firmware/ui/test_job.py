"""The ratios of one job against exact arithmetic: spur, helical with and without an encoder on the feed, threads."""

from __future__ import annotations

import ctypes
from fractions import Fraction

import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from mpmath import mp, mpf

TEETH_REFUSED, STARTS, HELIX, HOB, FEED, PITCH, STEEP, WIDE, FAST = range(2, 11)
U64 = st.integers(0, 2**64 - 1)
TRAVEL, BOUND = 500, Fraction(1, 100)


def ratios(job: tuple[int, ...]) -> tuple[Fraction, Fraction]:
    """Hob and feed of a job; the core's conditions hold."""
    denominator, *increments, base, feed_base = job
    assert all(0 <= increment < denominator for increment in increments)
    return Fraction(increments[0], denominator) + base, Fraction(increments[1], denominator) + feed_base


def exact(value) -> Fraction:
    return Fraction(int(mp.nint(value * mpf(2) ** 200)), 2**200)


@pytest.fixture(scope="session")
def plewes(firmware):
    return firmware("hobbing_plewes")


@pytest.fixture(scope="session")
def with_feed(firmware):
    return firmware("hobbing_helical")


@pytest.fixture(scope="session")
def lathe(firmware):
    return firmware("lathe_example")


@given(U64, U64, U64, U64)
@example(2**64 - 1, 2**64 - 1, 2**64 - 1, 2**64 - 1)
@example(2**63, 2, 0, 1)
@example(5, 7, 0, 0)
def test_products_of_128_bits_are_divided_exactly_or_refused(plewes, a, b, add, c):
    quotient = ctypes.c_uint64(77)
    words = [ctypes.c_uint64(word) for word in (a, b, add, c)]
    status = plewes.gm_muldiv(*words, ctypes.byref(quotient))
    fits = c > 0 and (a * b + add) // c < 2**64
    assert (status, quotient.value) == ((0, (a * b + add) // c) if fits else (-1, 77))


@given(st.integers(-(2**63) + 1, 2**63 - 1), st.integers(-(2**63) + 1, 2**63 - 1))
def test_products_of_64_bits_are_exact_or_refused(plewes, a, b):
    product = ctypes.c_int64(77)
    status = plewes.gm_multiply(ctypes.c_int64(a), ctypes.c_int64(b), ctypes.byref(product))
    assert (status, product.value) == ((0, a * b) if abs(a * b) < 2**63 else (-1, 77))


def test_sine_is_within_eight_units_of_its_last_place(plewes):
    library = plewes
    library.gm_sine.restype = library.gm_sine_over_pi.restype = ctypes.c_uint64
    with mp.workdps(40):
        for angle in range(9001):
            sine = mp.sin(angle * mp.pi / 18000)
            assert abs(library.gm_sine(angle) - sine * 2**61) <= 8
            assert abs(library.gm_sine_over_pi(angle) - sine / mp.pi * 2**62) <= 8


@pytest.mark.parametrize("starts", [1, 2, -1, -3])
def test_spur_gears_have_the_exact_ratio_in_lowest_terms(firmware, make_job, new_settings, starts):
    library = firmware("hobbing_plewes")
    for teeth in range(1, 1000):
        refusal, job, rpm = make_job(library, new_settings(teeth=teeth, starts=starts))
        ratio = Fraction(16000 * starts, 4096 * teeth)
        if abs(ratio) * 54614 * 101 // 1 > 4_000_000:  # 800 rpm are 54613.3 edges/s, rounded up; 1 % above it trips
            assert refusal == FAST
            assert rpm == 40000 / abs(ratio) * 60 / Fraction(101, 100) // 4096  # the trip is one in a hundred above
        else:
            assert (refusal, job[0], ratios(job)) == (0, ratio.denominator, (ratio, 0))
            assert rpm == 800


@pytest.mark.parametrize(
    ("changes", "refusal"),
    [
        ({"teeth": 0}, TEETH_REFUSED),
        ({"teeth": 1000}, TEETH_REFUSED),
        ({"starts": 0}, STARTS),
        ({"starts": 11}, STARTS),
        ({"helix": 6001}, HELIX),
        ({"hob_size": 0}, HOB),
        ({"depth_rule": 0}, HOB),
        ({"hob_unit": 2}, HOB),
        ({"feed": 0}, FEED),
        ({"profile": 1}, 1),
        ({"teeth": 5}, FAST),
    ],
)
def test_refusals_have_their_reason_in_a_line(firmware, make_job, new_settings, changes, refusal):
    library = firmware("hobbing_plewes")
    library.gm_refusal_text.restype = ctypes.c_char_p
    assert make_job(library, new_settings(**changes))[0] == refusal
    assert 0 < len(library.gm_refusal_text(refusal)) <= 20


def test_ratios_beyond_the_kernels_are_refused(firmware, make_job, new_settings):
    steep = firmware("hobbing_plewes", GM_MOTOR_STEPS=4096 * 65, GM_MAX_STEP_RATE=2_000_000_000)
    assert make_job(steep, new_settings(teeth=1))[0] == STEEP
    assert make_job(steep, new_settings(teeth=2))[0] == 0
    wide = firmware("hobbing_plewes", GM_TURN_COUNTS=1_111_111)
    assert make_job(wide, new_settings(teeth=967))[0] == WIDE  # 967 x 1111111 > 2^30, coprime to 16000
    assert make_job(wide, new_settings(teeth=960))[0] == 0


def inverse_lead(wanted):
    """1/L [1/mm] of a right-hand helix with 60 digits."""
    module = mpf(wanted.hob_size) / 10_000 if wanted.hob_unit == 1 else mpf("25.4") * 10_000 / wanted.hob_size
    return mp.sin(mp.pi * wanted.helix / 18000) / (mp.pi * module * wanted.teeth)


HELICES = st.fixed_dictionaries(
    {
        "teeth": st.integers(6, 999),
        "helix": st.integers(1, 6000),
        "left": st.integers(0, 1),
        "starts": st.sampled_from([1, -1]),
        "hob": st.sampled_from(
            [(1, 3, 10_000), (1, 3, 5000), (1, 3, 15_000), (0, 0, 320_000), (0, 0, 608_000), (0, 2, 240_000)]
        ),
    }
)


def helical(new_settings, case, **more):
    unit, rule, size = case["hob"]
    rest = {key: value for key, value in case.items() if key != "hob"}
    return new_settings(hob_unit=unit, depth_rule=rule, hob_size=size, **rest, **more)


@given(HELICES)
def test_the_feed_keeps_the_true_helix_within_its_bound(with_feed, make_job, new_settings, case):
    wanted = helical(new_settings, case)
    refusal, job, _ = make_job(with_feed, wanted)
    assert refusal == 0
    hob, feed = ratios(job)
    assert hob == Fraction(16000 * wanted.starts, 4096 * wanted.teeth)
    with mp.workdps(60):
        true = exact((-1 if wanted.left else 1) * 16000 * inverse_lead(wanted) / 1000)  # 1000 counts per mm
    assert abs(feed - true) * TRAVEL * 1000 <= BOUND


def test_the_lead_of_the_published_example():
    """z = 30, m_n = 1, 20 degrees: L = 275.562 mm."""
    with mp.workdps(30):
        assert mp.nstr(mp.pi * 30 / mp.sin(mp.radians(20)), 6) == "275.562"


@pytest.fixture(scope="session")
def unhurried(firmware):
    """A driver that no ratio is too fast for."""
    return firmware("hobbing_plewes", GM_MAX_STEP_RATE=200_000)


@given(HELICES, st.integers(50, 2000), st.integers(0, 1))
def test_a_constant_feed_keeps_the_true_helix_within_its_bound(unhurried, make_job, new_settings, case, feed, climb):
    wanted = helical(new_settings, case, feed=feed, climb=climb)
    refusal, job, _ = make_job(unhurried, wanted)
    assert refusal in (0, FEED, WIDE)
    with mp.workdps(60):
        # per turn of the table the teeth turn by feed/L; the table gains where hand of hob, of helix and cut agree
        signs = (-1 if wanted.left else 1) * (-1 if climb else 1) * (1 if wanted.starts > 0 else -1)
        turn = mpf(feed) / 1000 * inverse_lead(wanted)
        true = exact(mpf(16000 * wanted.starts) / (4096 * wanted.teeth) / (1 - signs * turn))
    if refusal == 0:
        counts = Fraction(TRAVEL * 1000 * wanted.teeth * 4096, feed)
        assert abs(ratios(job)[0] - true) * counts <= BOUND
    elif refusal == FEED:
        assert turn > 0.24


def test_metric_and_inch_threads_are_exact(firmware, make_job, new_settings):
    library = firmware("lathe_example")
    per_mm = Fraction(4800) / Fraction(127, 40)
    threads = [(1000, 0, 1, 0), (1250, 0, 3, 1), (2000, 1, 1, 0), (1150, 1, 2, 1), (55, 2, 1, 0)]
    for pitch, kind, starts, left in threads:
        wanted = new_settings(profile=1, pitch=pitch, pitch_kind=kind, starts=starts, left=left)
        mm = Fraction(254, 10) / Fraction(pitch, 100) if kind == 1 else Fraction(pitch, 1000)
        refusal, job, rpm = make_job(library, wanted)
        assert (refusal, ratios(job)) == (0, ((-1 if left else 1) * mm * starts * per_mm / 4000, 0))
        assert rpm == min(
            1000, 80000 / (mm * starts * per_mm) * 60 / Fraction(101, 100) // 1
        )  # a coarse thread is cut slowly


@given(st.integers(-(10**9), 10**9), st.integers(-(10**7), 10**7), st.integers(2, 10), st.booleans())
def test_the_next_start_is_one_pitch_on_modulo_the_lead(lathe, new_settings, edges, position, starts, left):
    move = ctypes.c_int32()
    pitch = (-1 if left else 1) * Fraction(4800 * 40, 127) * Fraction(3, 2)  # steps
    ratio = pitch * starts / 4000
    terms = (ctypes.c_int64 * 2)(ratio.numerator, ratio.denominator)
    wanted = new_settings(profile=1, pitch=1500, starts=starts, left=int(left))
    status = lathe.gm_next_start(
        ctypes.byref(wanted), terms, ctypes.c_int64(edges), ctypes.c_int64(position), ctypes.byref(move)
    )
    lead = abs(pitch) * starts
    off = position + move.value - (ratio * edges + pitch)
    assert status == 0
    assert abs(off - round(off / lead) * lead) <= Fraction(1, 2)
    assert abs(move.value) <= lead / 2 + 1


def test_jogs_and_divisions_are_nearest_steps(plewes):
    library = plewes
    library.gm_jog_steps.restype = ctypes.c_int64
    for size, degrees in enumerate((Fraction(1, 100), Fraction(1, 10), 1, 10)):
        for n in (-127, -1, 0, 1, 3, 7, 3600):
            assert abs(library.gm_jog_steps(size, n) - 16000 * n * Fraction(degrees) / 360) <= Fraction(1, 2)
    for divisions in (7, 127, 135, 9999):
        for n in range(divisions):
            assert abs(library.gm_division_step(n, divisions) - Fraction(16000 * n, divisions)) <= Fraction(1, 2)
