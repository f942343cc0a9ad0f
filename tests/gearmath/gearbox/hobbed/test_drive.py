"""The drive train in the cut: steps as the compiled rule gives them, and injected errors in their traces."""

from __future__ import annotations

import math
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest

from gearmath.export.host import run_axes
from gearmath.gearbox.helix import Helix, JobRatio
from gearmath.gearbox.hobbed import envelope
from gearmath.gearbox.hobbed.drive import DriveTrain, rounding
from gearmath.gearbox.hobbed.envelope import Envelope
from gearmath.gearbox.hobbed.inspection import inspect
from gearmath.gearbox.hobbed.job import TURN
from gearmath.gearbox.hobbed.passes import Passes
from gearmath.gearbox.hobbed.setup import CutSetup, blame, cut_and_inspect, setup
from gearmath.gearbox.simulation import FloatRule
from gearmath.specs.cutting_errors import CuttingErrors
from gearmath.specs.hobbing import HobbingMachine, find_hobbing_machine

UM = 1e-3


def machine(name: str = "hobbing_helical.toml", gashes: int = 12, **errors: object) -> HobbingMachine:
    found = find_hobbing_machine(name)
    hobs = tuple(hob.model_copy(update={"gashes": gashes}) for hob in found.hobs)
    return found.model_copy(update={"hobs": hobs, "errors": CuttingErrors.model_validate(errors)})


def fine(**errors: object) -> CutSetup:
    """Of 24 teeth: so many gashes and so little feed that ridges do not matter."""
    return setup(machine(gashes=40, **errors), 24, hob="m1", feed=0.2, rule="ideal")


def normal_step(train: DriveTrain) -> float:
    """A motor step along the normal of the flank [mm]."""
    return train.step * train.job.base_radius * math.cos(train.job.base_helix)


@pytest.mark.parametrize(
    ("teeth", "starts", "helix"),
    [(24, 1, None), (7, 1, None), (31, 2, None), (30, 1, 20.0), (97, 3, 12.0), (6, 1, None)],
)
def test_steps_are_those_of_the_compiled_rule_at_every_edge(teeth, starts, helix):
    """20 000 edges of hob and feed, as the interrupt counts them."""
    prepared = setup(machine(), teeth, hob="m1", starts=starts, helix=None if helix is None else Helix(helix))
    ratio = prepared.train.ratio
    axes = np.zeros(20_000, np.int8)
    edges = np.ones(20_000, np.int8)
    if helix is not None:
        axes[6::7] = 1
        edges[6::7] = -1
    steps, _ = run_axes(axes, edges, ratio.base, ratio.increment, ratio.denominator, ratio.first_remainder)
    hob, feed = (np.cumsum(np.where(axes == axis, edges, 0)) for axis in (0, 1))
    exact = [
        (int(p) * ratio.denominator - ratio.numerators[0] * int(e) - ratio.numerators[1] * int(f)) / ratio.denominator
        for p, e, f in zip(np.cumsum(steps, dtype=np.int64)[::13], hob[::13], feed[::13], strict=True)
    ]
    np.testing.assert_allclose(rounding(ratio, hob[::13], feed[::13]), exact, rtol=0, atol=1e-12)
    assert np.abs(rounding(ratio, hob, feed)).max() <= 0.5


@pytest.mark.parametrize(
    ("teeth", "starts", "helix"),
    [(6, 1, None), (17, 1, None), (24, 1, None), (60, 2, None), (127, 1, None), (31, 1, 20.0), (50, 3, 35.0)],
)
def test_steps_change_a_flank_by_half_of_one_and_a_count_at_most(teeth, starts, helix):
    """A count of every encoder: on a helical gear that of the feed, too."""
    inclined = None if helix is None else Helix(helix, "left")
    shift = 0.5 if teeth < 18 else 0.0
    prepared = setup(machine(gashes=12), teeth, hob="m1", feed=0.3, shift=shift, starts=starts, helix=inclined)
    train, where = prepared.train, prepared.where
    spaces, lengths = np.arange(60) % teeth, np.linspace(where.profile[0], where.profile[-1], 60)
    heights = np.linspace(2.0, 8.0, 60)
    for side in (1, -1):
        with_steps = Envelope(train.job, train).deviation(side, spaces, lengths, heights)
        without = Envelope(train.job).deviation(side, spaces, lengths, heights)
        count = sum(abs(float(each)) for each in train.ratio.numerators) / train.ratio.denominator
        assert np.abs(with_steps - without).max() <= (0.5 + count) * normal_step(train) + 1e-9


@pytest.mark.parametrize("teeth", [24, 17])
def test_every_tooth_is_off_by_the_remainder_of_the_compiled_rule(teeth):
    """In the middle of a flat, tooth by tooth: what the steps add is the remainder that the kernel has kept there."""
    prepared = setup(machine(gashes=4), teeth, hob="m1", feed=2.0)
    train, job = prepared.train, prepared.job
    ratio, per_turn = train.ratio, int(train.machine.encoder_counts)
    # four gashes leave flats so high that no step lets another one win in the middle
    lengths = np.linspace(prepared.where.profile[0], prepared.where.profile[-1], 20_001)
    height, _, tau, thread = job.contact(1, lengths)
    for space in range(teeth):
        ridge = space + teeth * 14
        gashes = np.rint(4 * (ridge - thread / TURN))
        near = np.abs(4 * (ridge - thread / TURN) - gashes)
        at = int(near[4000:16000].argmin()) + 4000
        psi = TURN * gashes[at] / 4 + tau[at]
        on_gear = float(job.hob_height(np.array([psi]))[0] + height[at])
        point = (np.array([space]), lengths[at : at + 1], np.array([on_gear]))
        added = Envelope(job, train).deviation(1, *point) - Envelope(job).deviation(1, *point)
        real = psi / TURN * per_turn
        # the table's own error moves the moment of the cut by some hundredths of a count
        counts = {math.floor(real - 0.1), math.floor(real + 0.1)}
        expected = [-_kept(ratio, edges, real) * normal_step(train) for edges in counts]
        assert min(abs(added[0] - each) for each in expected) < 0.01 * UM


def _kept(ratio: JobRatio, edges: int, real: float) -> float:
    """Steps that the compiled rule is ahead after so many edges, where the hob really is at ``real`` counts."""
    hob, forward = np.zeros(edges, np.int8), np.ones(edges, np.int8)
    _, left = run_axes(hob, forward, ratio.base, ratio.increment, ratio.denominator, ratio.first_remainder)
    return (ratio.first_remainder - left + ratio.numerators[0] * (edges - real)) / ratio.denominator


def test_floating_rule_delivers_after_any_count_what_it_does_edge_by_edge():
    for start in (0, 2**24 - 700, 147_000_000):
        rule = FloatRule(16000, 6 * 4096, start)
        delivered = rule.delivered + np.cumsum(rule(np.ones(3000, np.int8)), dtype=np.int64)
        closed = FloatRule(16000, 6 * 4096).positions(start + np.arange(1, 3001))
        np.testing.assert_array_equal(closed[200:], delivered[200:])


def test_floating_rule_after_an_hour_moves_the_flank_by_the_known_steps():
    """6 teeth at 600 rpm: 1.03 steps off after ten minutes, 10.4 after an hour; on the flank so many times a step."""
    base = setup(machine(), 6, hob="m1", shift=0.5, rpm=600.0, feed=0.2, rule="float")
    spaces, lengths, heights = np.arange(120) % 6, np.full(120, base.where.middle), np.linspace(2.0, 9.0, 120)
    before = Envelope(base.job).deviation(-1, spaces, lengths, heights)
    for seconds, known in ((600, 1.03), (3600, 10.4)):
        train = replace(base.train, seconds=seconds)
        counts = np.concatenate([10 * seconds * 4096 - 1_500_000 * k - np.arange(50_000) for k in range(16)])
        off = FloatRule(16000, 6 * 4096).positions(counts) - counts * (16000 / (6 * 4096))
        assert np.abs(off).max() == pytest.approx(known, abs=0.06)
        anywhere = np.random.default_rng(600).uniform(0.0, base.job.hob_turns * TURN, 400_000)
        worst = np.abs(train.step_error(anywhere)).max()
        moved = (Envelope(base.job, train).deviation(-1, spaces, lengths, heights) - before) / normal_step(train)
        assert -worst <= moved.min() < -0.75 * worst


def sine(places: np.ndarray, values: np.ndarray, period: float) -> float:
    """Amplitude of the sine of this period in values, beside a straight line."""
    turn = TURN * places / period
    terms = np.column_stack([np.sin(turn), np.cos(turn), places, np.ones_like(places)])
    fit = np.linalg.lstsq(terms, values, rcond=None)[0]
    return float(np.hypot(fit[0], fit[1]))


ARCSEC = math.pi / 648_000


def test_worm_and_wheel_come_back_in_the_pitch_with_their_orders_alone_and_together():
    """Worm 10:1: ten times a turn of the table; the wheel once. Amplitudes within 2 %, superposed within 2 %."""
    worm, wheel = {"amplitude_arcsec": 40.0, "phase": 20.0}, {"amplitude_arcsec": 60.0}
    per_arcsec = ARCSEC * 12.0
    for errors, tens, ones in (
        ({"worm": [worm]}, 40.0, 0.0),
        ({"wheel": [wheel]}, 0.0, 60.0),
        ({"worm": [worm], "wheel": [wheel]}, 40.0, 60.0),
    ):
        prepared = fine(**errors)
        for row in inspect(Envelope(prepared.job, prepared.train), prepared.where).pitches:
            spectrum = np.abs(np.fft.rfft(row.position)) / 12
            assert spectrum[10] / per_arcsec == pytest.approx(tens, rel=0.02, abs=0.02 * ones)
            assert spectrum[1] / per_arcsec == pytest.approx(ones, rel=0.02, abs=0.02 * tens)


def test_eccentric_hob_comes_back_in_the_profile_once_a_turn_of_the_hob():
    """e sin α along the normal, over a base pitch of length of roll; so small that no other gash cuts it off."""
    prepared = fine(hob_eccentricity_um=2.0)
    for trace in inspect(Envelope(prepared.job, prepared.train), prepared.where).profiles:
        period = math.pi * math.cos(math.radians(20))
        assert sine(trace.place, trace.deviation, period) == pytest.approx(0.002 * math.sin(math.radians(20)), rel=0.02)


def test_wobbling_hob_comes_back_in_the_profile_once_a_turn_of_the_hob():
    """e cos α along the normal of a spur gear, a shift along the hob's axis being one of the rack."""
    prepared = fine(hob_axial_runout_um=2.0)
    for trace in inspect(Envelope(prepared.job, prepared.train), prepared.where).profiles:
        period = math.pi * math.cos(math.radians(20))
        expected = 0.002 * math.cos(prepared.job.lead_angle) * math.cos(math.radians(20))
        assert sine(trace.place, trace.deviation, period) == pytest.approx(expected, rel=0.02)


def test_hob_whose_thread_is_too_long_comes_back_as_a_slope_of_the_profile():
    """A turn of the hob is a base pitch of length of roll; e cos α along the normal for each."""
    prepared = fine(hob_lead_um_per_turn=3.0)
    for trace in inspect(Envelope(prepared.job, prepared.train), prepared.where).profiles:
        turns = (trace.place[-1] - trace.place[0]) / (math.pi * math.cos(math.radians(20)))
        expected = 0.003 * math.cos(prepared.job.lead_angle) * math.cos(math.radians(20)) * turns
        assert abs(trace.slope) == pytest.approx(expected, rel=0.02)


def test_encoder_line_error_comes_back_in_the_profile_once_a_turn_of_the_encoder():
    """The hob drives it 1:1, so that the table is off by 1/z of it; by so many steps and counts that they are smooth.

    A sine twice a turn is in the table as it should be, too; on the flank other gashes cut its crests off.
    """
    for order in (1, 2):
        seen = machine(gashes=40, encoder=[{"amplitude_arcsec": 300.0, "order": order}])
        smooth = seen.model_copy(
            update={
                "table": seen.table.model_copy(update={"microsteps": 256}),
                "encoder": seen.encoder.model_copy(update={"lines": 10_000}),
                "limits": seen.limits.model_copy(update={"step_rate_hz": 1e6}),
            }
        )
        prepared = setup(smooth, 24, hob="m1", feed=0.2, rpm=60.0)
        psi = np.random.default_rng(order).uniform(0.0, 40 * TURN, 40_000)
        expected = 300.0 * ARCSEC / 24
        assert sine(psi, prepared.train.table(psi, 1), TURN / order) == pytest.approx(expected, rel=0.01)
        if order == 1:
            where = replace(prepared.where, helix=prepared.where.helix[:5])
            for trace in inspect(Envelope(prepared.job, prepared.train), where).profiles:
                found = sine(trace.place, trace.deviation, math.pi * math.cos(math.radians(20)))
                assert found == pytest.approx(expected * prepared.job.base_radius, rel=0.02)


def test_uneven_microsteps_come_back_once_a_full_step():
    """2 percent of a full step, once a full step: a sine that four microsteps hold keeps sin(π/4)/(π/4) of it."""
    train = setup(machine(microstep_percent=2.0), 24, hob="m1").train
    full = TURN / float(train.machine.motor_steps) * train.machine.drive.microsteps
    psi = np.linspace(0.0, 40 * full * 24, 20_001)
    plain = replace(train, machine=machine())
    off = train.table(psi, 1) - plain.table(psi, 1)
    assert sine(psi / 24, off, full) == pytest.approx(0.02 * full * math.sin(math.pi / 4) / (math.pi / 4), rel=0.02)


def test_errors_of_all_parts_superpose_within_2_percent():
    """What all of them do is the sum of what each does alone, in the mean square; beside ridges other gashes cut."""
    given = {
        "worm": [{"amplitude_arcsec": 30.0, "phase": 20.0}],
        "wheel": [{"amplitude_arcsec": 40.0, "order": 2}],
        "hob_eccentricity_um": 1.0,
        "hob_axial_runout_um": 0.6,
        "hob_lead_um_per_turn": 1.0,
        "blank_eccentricity_um": 8.0,
        "blank_tilt_um_per_100mm": 20.0,
    }

    def change(**errors: object) -> np.ndarray:
        prepared = fine(**errors)
        where = replace(prepared.where, profile=prepared.where.profile[::8], helix=prepared.where.helix[::8])
        seen = inspect(Envelope(prepared.job, prepared.train), where)
        traces = [trace.deviation for trace in (*seen.profiles, *seen.helices)]
        return np.concatenate([*traces, *(row.position for row in seen.pitches), seen.ball])

    ideal = change()
    alone = sum(change(**{key: value}) - ideal for key, value in given.items())
    together = change(**given) - ideal
    assert np.linalg.norm(together - alone) < 0.02 * np.linalg.norm(alone)


def test_eccentric_blank_comes_back_in_the_runout_once_a_turn_of_the_table():
    prepared = fine(blank_eccentricity_um=25.0)
    found = inspect(Envelope(prepared.job, prepared.train), prepared.where)
    assert np.abs(np.fft.rfft(found.ball))[1] / 12 == pytest.approx(0.025, rel=0.02)
    assert found.runout == pytest.approx(0.05, rel=0.02)


def test_tilted_blank_comes_back_as_a_slope_of_the_helix_once_a_turn_of_the_table():
    """t along the radius: across the flank t cos(angle) cos α."""
    prepared = fine(blank_tilt_um_per_100mm=100.0)
    job = prepared.job
    spaces = np.arange(24)
    low, high = (
        Envelope(job, prepared.train).deviation(1, spaces, np.full(24, prepared.where.middle), np.full(24, z))
        for z in (2, 8)
    )
    assert np.abs(np.fft.rfft(high - low))[1] / 12 == pytest.approx(6e-3, rel=0.02)


def test_screw_of_the_feed_comes_back_in_the_helix_once_a_turn_of_the_screw():
    """A helical gear whose feed has no encoder: Δz sin β_b along the normal, where the hob is not too large for it."""
    bare = machine("hobbing_default.toml", 40, feed=[{"amplitude_um": 2.0}], feed_screw_pitch=3.0)
    prepared = setup(bare, 24, hob="m1", feed=0.2, rule="ideal", helix=Helix(20.0, feed=Fraction("0.2")))
    for trace in inspect(Envelope(prepared.job, prepared.train), prepared.where).helices:
        amplitude = 0.002 * math.sin(prepared.job.base_helix)
        assert sine(trace.place, trace.deviation, 3.0) == pytest.approx(amplitude, rel=0.02)


def test_encoder_on_the_feed_sees_its_screw_and_corrects_it():
    """The same screw: with the scale of the helical machine nothing is left but steps and counts."""
    good = machine(gashes=40, feed=[{"amplitude_um": 30.0}], feed_screw_pitch=3.0)
    prepared = setup(good, 24, hob="m1", feed=0.2, helix=Helix(20.0))
    heights, middle = np.linspace(1.0, 9.0, 120), np.full(120, prepared.where.middle)
    found = Envelope(prepared.job, prepared.train).deviation(1, np.zeros(120, int), middle, heights)
    assert sine(heights, found, 3.0) < 0.05 * 0.03 * math.sin(prepared.job.base_helix)


def test_wrong_spacing_of_two_starts_alternates_on_even_gears_and_hunts_on_odd_ones():
    """10 um along the hob: on 24 teeth every other tooth is off by that; on 25 both threads cut every space alike."""
    two = machine(gashes=40, hob_starts_um=[0.0, 10.0])
    for teeth in (24, 25):
        job = (prepared := setup(two, teeth, hob="m1", starts=2, feed=0.2, rule="ideal")).job
        point = (np.arange(teeth), np.array([prepared.where.middle]), np.array([5.0]))
        right, left = (Envelope(job, prepared.train).deviation(side, *point) for side in (1, -1))
        if teeth == 24:
            alternating = np.array([1.0, -1.0] * 12)
            for found in (right, left):
                off = 0.010 * math.cos(prepared.job.lead_angle) * math.cos(math.radians(20))
                assert abs(found @ alternating) / 12 == pytest.approx(off, rel=0.02)
        else:  # both flanks lose what the farther thread takes: one of them 10 um, but for feed marks of double feed
            assert max(np.ptp(right), np.ptp(left)) < 0.5 * UM
            assert (right + left).mean() == pytest.approx(-0.010 * math.cos(math.radians(20)), abs=0.5 * UM)


def test_play_that_the_cut_takes_up_leaves_teeth_thicker_by_it():
    bare = machine(gashes=40, backlash_taken_by_cut=True)
    table = bare.table.model_copy(update={"backlash": 0.02})
    prepared = setup(bare.model_copy(update={"table": table}), 24, hob="m1", feed=0.2, rule="ideal")
    found = inspect(Envelope(prepared.job, prepared.train), prepared.where)
    play = math.radians(0.02) * prepared.job.base_radius
    assert found.thicknesses[0].mean - found.thicknesses[0].nominal == pytest.approx(play, rel=0.02)
    assert all(row.worst < 0.05 * UM for row in found.pitches)


def test_motor_that_lags_follows_the_ripple_of_the_hob():
    """T r w steps: the lag of a first order behind a speed that swings by r, less the constant lag."""
    slow = machine(motor_time_constant_ms=2.0, speed_ripple=[{"amplitude_percent": 10.0}])
    train = setup(slow, 24, hob="m1", rpm=120.0).train
    psi = np.linspace(0, 4 * TURN, 40_000)
    rate = 120 / 60 * 16000 / 24
    assert sine(psi, train.motor_error(psi), TURN) == pytest.approx(0.002 * 0.1 * rate, rel=0.05)


def test_stop_within_the_cut_lets_a_motor_that_lags_catch_up_as_its_equation_of_motion_says():
    """dx/dt = (u - x)/T in small steps, u the hob's turn that slows down and runs up again; x - u with the constant
    lag taken off is what the table is ahead. The mark is a turn of the table by n T k/z where the hob stood."""
    lag, run_up, rpm, height = 0.005, 0.4, 120.0, 10.0
    stopped = machine(motor_time_constant_ms=1000 * lag, stop_in_cut_mm=height, run_up_seconds=run_up)
    train = setup(stopped, 24, hob="m1", rpm=rpm).train
    speed = rpm / 60 * TURN
    time = np.arange(-run_up - 0.2, run_up + 0.2, 1e-5)
    turned = speed * np.where(
        np.abs(time) < run_up, time * np.abs(time) / (2 * run_up), time - np.sign(time) * run_up / 2
    )
    follows = np.empty_like(turned)
    follows[0] = turned[0] - speed * lag
    for k in range(1, len(time)):
        follows[k] = follows[k - 1] + 1e-5 / lag * (turned[k - 1] - follows[k - 1])
    ahead = (follows - turned + speed * lag) / TURN * 16000 / 24  # steps
    stands = (height - train.job.start_height) / train.job.travel_per_rad
    asked = slice(0, None, 50)
    found = train.motor_error(stands + turned[asked])
    np.testing.assert_allclose(found, ahead[asked], atol=1.5 + 0.02 * ahead.max())  # rounding to steps and counts
    assert ahead.max() == pytest.approx(2 * lag * 16000 / 24, rel=0.05)


def test_stop_that_is_far_outside_of_the_cut_is_not_to_blame():
    """The motor's lag alone evens out the steps; that is no share of a stop that no tooth meets."""
    given = {"motor_time_constant_ms": 5.0, "run_up_seconds": 0.5}
    prepared, without = (
        replace(made, where=replace(made.where, profile=made.where.profile[::16], helix=made.where.helix[::16]))
        for made in (
            setup(machine(**given, **stop), 24, hob="m1", face_width=5.0) for stop in ({"stop_in_cut_mm": 500.0}, {})
        )
    )
    whole = cut_and_inspect(prepared, "exact")
    assert whole.found.figures == pytest.approx(cut_and_inspect(without, "exact").found.figures, abs=1e-6)
    shares = {each.source: each for each in blame(prepared, whole)}
    assert shares["stop_in_cut_mm"].pitch_percent == pytest.approx(0.0, abs=0.01)
    assert shares["stop_in_cut_mm"].profile_percent == pytest.approx(0.0, abs=0.01)


def test_what_uneven_speed_leaves_lies_within_the_range_that_is_said():
    """Beside the stop and in it, where the hob turn is known but for a part of its run-up."""
    uneven = {"speed_ripple": [{"amplitude_percent": 10.0, "order": 2}, {"amplitude_percent": 5.0, "phase": 40.0}]}
    stopped = machine(motor_time_constant_ms=5.0, stop_in_cut_mm=5.0, run_up_seconds=0.3, **uneven)
    train = setup(stopped, 24, hob="m1", rpm=120.0).train
    stands = (5.0 - train.job.start_height) / train.job.travel_per_rad
    psi = stands + np.linspace(-6.0, 6.0, 4001)
    for side in (1, -1):
        now, now_too = train.lag_range(psi, side, 0.0)
        np.testing.assert_allclose(now, now_too, rtol=0, atol=1e-15)
        assert np.ptp(now) == pytest.approx(0.005 * 2 * 16000 / 24 * normal_step(train), rel=0.2)
        for unsure in (0.05, 0.8):
            least, most = train.lag_range(psi, side, unsure)
            for moved in np.linspace(-unsure, unsure, 9):
                there, _ = train.lag_range(psi + moved, side, 0.0)
                assert (least <= there + 1e-15).all()
                assert (there <= most + 1e-15).all()


@pytest.mark.parametrize(
    "errors", [{}, {"encoder": [{"amplitude_arcsec": 300.0, "order": 2}]}, {"microstep_percent": 20}]
)
def test_steps_never_leave_less_than_the_bound_under_which_gashes_are_left_out(errors):
    """At hob turns all over the cut, on both flanks, within the range that is said."""
    train = setup(machine(**errors), 31, hob="m1", starts=2).train
    psi = np.random.default_rng(18).uniform(0.0, TURN * train.job.hob_turns, 20_000)
    for side in (1, -1):
        now, least = train.sudden(psi, side)
        assert (now >= least).all()
        assert np.ptp(now) <= train.unsteady
        assert (now - least).min() < 0.1 * train.unsteady  # not far below what occurs


def _found(cut: Envelope) -> np.ndarray:
    """δ at some points of both flanks of a gear of module 1, 10 mm wide, near its reference circle."""
    length = cut.job.base_radius * math.tan(cut.job.transverse[1])
    lengths, heights = np.meshgrid(length + np.linspace(0.0, 0.7, 7), np.linspace(4.0, 6.1, 8))
    spaces = np.arange(lengths.size) % cut.job.gear.teeth
    return np.concatenate([cut.deviation(side, spaces, lengths.ravel(), heights.ravel()) for side in (1, -1)])


@pytest.mark.parametrize(
    ("teeth", "starts", "helix", "rule", "errors"),
    [
        (97, 3, 12.0, "exact", {}),
        (96, 1, None, "exact", {}),
        (24, 1, None, "float", {}),
        (31, 2, None, "exact", {"hob_eccentricity_um": 10.0, "hob_starts_um": [5.0, -8.0]}),
        (30, 1, 20.0, "exact", {"worm": [{"amplitude_arcsec": 60.0}], "blank_eccentricity_um": 30.0}),
        (6, 1, None, "ideal", {"hob_lead_um_per_turn": 10.0, "feed": [{"amplitude_um": 20.0}]}),
        (24, 1, None, "exact", {"motor_time_constant_ms": 5.0, "stop_in_cut_mm": 5.0, "run_up_seconds": 0.1}),
        (
            7,
            1,
            None,
            "exact",
            {"motor_time_constant_ms": 20.0, "speed_ripple": [{"amplitude_percent": 20.0, "order": 3}]},
        ),
    ],
)
def test_gashes_that_are_left_out_would_not_have_cut(monkeypatch, teeth, starts, helix, rule, errors):
    """All passes of the window, one by one, leave the same."""
    of = setup(
        machine(**errors), teeth, hob="m1", starts=starts, helix=None if helix is None else Helix(helix), feed=1.0
    )
    cut = Envelope(of.job, DriveTrain(of.train.machine, of.job, of.train.ratio, rule, of.train.rpm, 3600.0))
    found = _found(cut)
    monkeypatch.setattr(envelope, "FIRST", 100_000)
    np.testing.assert_allclose(found, _found(cut), rtol=0, atol=1e-9)


def test_passes_that_are_followed_at_a_point_grow_no_faster_than_teeth_and_feed_positions(monkeypatch):
    """Coarse steps let ever more gashes compete, in proportion to teeth and feed positions each; few are followed."""
    followed = []
    solve = Passes.solve

    def count(self, *given):
        followed.append(len(self.psi))
        return solve(self, *given)

    monkeypatch.setattr(Passes, "solve", count)

    def per_point(teeth: int, feed: float, **errors: object) -> float:
        of = setup(machine("hobbing_default.toml", **errors), teeth, hob="m1", feed=feed)
        followed.clear()
        points = len(_found(Envelope(of.job, of.train)))
        return sum(followed) / points

    few = per_point(24, 1.0)
    assert per_point(192, 1.0) < 8 * few
    assert per_point(24, 0.25) < 2 * few
    # where the hob stood, the table is 40 steps ahead: that lets gashes compete beside it, not everywhere
    stopped = {"motor_time_constant_ms": 5.0, "stop_in_cut_mm": 8.0, "run_up_seconds": 0.5}
    assert per_point(24, 1.0, **stopped) < 1.5 * few
