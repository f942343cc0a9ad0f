"""The core as the main program and the interrupts use it: what it follows, what it refuses, what stops it."""

import shutil
import subprocess
from fractions import Fraction
from math import floor

import numpy as np
import pytest

IDLE, RUN, MOVE, FAULT = range(4)
NO_FAULT, ESTOP, LAG, OVERSPEED, ENCODER, HOB_MOVED = range(6)
COUNTS = 4096


def edges(count: int, every: int = 30) -> np.ndarray:
    """``count`` edges (its sign is their direction), one every ``every`` ticks."""
    script = np.zeros(abs(count) * every, np.int8)
    script[::every] = 1 if count > 0 else -1
    return script


def running(core, N: int, D: int, **terms):
    assert core.job(N, D, **terms) == 0
    assert core.run() == 0
    return core


# --- following --------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("wide", "N", "D", "feed"),
    [
        (False, 125, 192, 0),
        (False, 2**30 - 1, 2**30, 1),
        (False, 1300, 384, -77),
        (False, -25, 64, 3),
        (True, 2**62 - 58, 2**62 - 57, 3),
        (True, -(2**60), 2**61 - 1, 2**59),
        (True, 125, 192, 500),
    ],
)
def test_table_is_at_the_nearest_step_after_any_edges_of_both_axes(new_core, wide, N, D, feed):
    core = running(new_core(wide), N, D, feed=feed)
    random = np.random.default_rng(11)
    hob = np.where(random.random(60_000) < 0.04, random.choice([1, 1, -1], 60_000), 0)
    other = np.where(random.random(60_000) < 0.02, random.choice([1, -1], 60_000), 0)
    record = core.play(hob, feed=other)
    reached = (record.position + record.pending).tolist()
    for k, (e, f) in enumerate(zip(np.cumsum(hob).tolist(), np.cumsum(other).tolist(), strict=True)):
        assert reached[k] == (2 * (N * e + feed * f) + D) // (2 * D)
    assert (core.status.mode, core.status.fault) == (RUN, NO_FAULT)
    assert (core.status.edges, core.status.feed) == (hob.sum(), other.sum())


@pytest.mark.parametrize("play", [1, 3, 16])
def test_play_keeps_the_table_still_under_dither_and_costs_no_more_than_itself(new_core, play):
    N, D = 25, 64
    core = running(new_core(), N, D, hysteresis=play)
    core.play(edges(777))
    before = core.status.position
    swing = np.concatenate([edges(-play, 20), edges(play, 20)])
    record = core.play(np.tile(swing, 200))
    assert (record.position == before).all()
    random = np.random.default_rng(play)
    hob = np.concatenate([edges(int(n)) for n in random.integers(-60, 61, 50)])
    record = core.play(hob)
    count = 777 + np.cumsum(hob)
    reached = record.position + record.pending
    error = np.abs(reached * D - N * count)
    assert (error <= D // 2 + N * play).all()


def test_dither_without_play_moves_one_step_at_most_and_none_in_the_end(new_core):
    core = running(new_core(), 25, 64)
    record = core.play(np.tile(np.concatenate([edges(1, 20), edges(-1, 20)]), 2000))
    assert np.ptp(record.position) <= 1
    assert core.status.position == 0


def test_counts_go_on_beyond_32_bits(new_core, host_compiler):
    """64-bit counts: the display's copy is whole."""
    core = running(new_core(GM_MAX_EDGE_RATE=10_000_000, GM_MAX_LAG=1_000_000), 1, 2**30)
    core.play(np.full(10_000, 50, np.int8))
    assert core.status.edges == 500_000


# --- stopping and starting again ----------------------------------------------------------------------------------


def phase_error(core, N: int, D: int) -> Fraction:
    """Distance from the table to the nearest place at which hob and table mesh [steps]: one turn of the hob is free."""
    lead = abs(Fraction(N * COUNTS, D))
    away = (core.status.position - Fraction(N * core.status.edges, D)) % lead
    return min(away, lead - away)


@pytest.mark.parametrize("wide", [False, True])
@pytest.mark.parametrize(("N", "D"), [(125, 192), (-125, 192), (7, 2), (-1300, 384), (1, 1), (2**29, 2**30 - 1)])
def test_table_meshes_again_after_any_turns_and_moves_while_it_stood(new_core, N, D, wide):
    core = running(new_core(wide, GM_MAX_EDGE_RATE=400_000, GM_MOVE_MAX_RATE=80_000), N, D)
    random = np.random.default_rng(abs(N))
    core.play(edges(5000))
    waited = 0
    for _ in range(12):
        core.stop()
        core.play(0, 6000)  # 50 kHz at 10^7 steps/s^2, and back
        assert core.status.mode == IDLE
        stood = core.status.position
        core.play(edges(int(random.integers(-6000, 6000)), 6))
        assert core.status.position == stood
        if random.random() < 0.5:
            core.play(0, 60_000)
            assert core.move(int(random.integers(-700, 700))) == 0
            core.play(0, 400_000)
        assert core.run() == 0
        started = core.status.position
        script = edges(int(random.choice([1, -1])) * COUNTS, 30)
        waited += core.status.waiting
        core.play(script)  # a turn of the hob passes the phase, whatever the direction
        core.play(0, 6000)
        assert core.status.waiting == 0
        assert core.status.pending == 0
        assert phase_error(core, N, D) <= Fraction(1, 2)
        core.play(edges(int(random.integers(-3000, 3000)), 30))
        core.play(0, 6000)
        assert phase_error(core, N, D) <= Fraction(1, 2)
        assert abs(core.status.position - started) <= 8000 * abs(N / D) + 1
    assert waited > 5


@pytest.mark.parametrize(("turn", "den"), [(40_000, 9), (81_920, 17), (160_000, 41)])
@pytest.mark.parametrize(("N", "D"), [(125, 192), (-7, 2), (1, 3), (2**20, 2**20 - 3)])
def test_a_turn_of_the_hob_that_is_no_whole_number_of_counts_is_met_exactly(new_core, turn, den, N, D):
    """The encoder has a belt: after any whole turns and back at the place, the table starts with no error at all."""
    core = new_core(True, GM_TURN_COUNTS=turn, GM_TURN_COUNTS_DEN=den, GM_MAX_EDGE_RATE=400_000)
    assert core.job(N, D) == -1 or den == 1  # D must be a multiple of den
    running(core, N * den, D * den)
    core.play(edges(3000, 20))
    lead = Fraction(N * turn, D * den)
    for away in (17 * turn // den + 5, -turn, 12_345):
        core.stop()
        core.play(0, 6000)
        core.play(edges(away, 4))
        assert core.run() == 0
        core.play(edges(turn // den + 2, 20))
        core.play(0, 6000)
        assert (core.status.waiting, core.status.in_phase) == (0, 1)
        off = (core.status.position - Fraction(N * core.status.edges, D)) % abs(lead)
        assert min(off, abs(lead) - off) <= Fraction(1, 2)


def test_table_goes_on_at_once_where_nothing_has_turned(new_core):
    core = running(new_core(), 125, 192)
    core.play(edges(1000))
    core.stop()
    core.play(0, 100)
    assert core.run() == 0
    assert core.status.waiting == 0
    core.play(edges(-1000))
    core.play(0, 100)
    assert core.status.position == 0


def test_what_waits_at_a_stop_is_made_up_for_at_the_next_start(new_core):
    core = running(new_core(), 5, 1)
    core.play(edges(6, 10))
    assert core.status.pending > 0
    core.stop()
    assert core.run() == -1
    core.play(0, 4000)
    assert core.status.mode == IDLE
    assert core.status.position < 30
    assert core.run() == 0
    assert core.status.waiting  # a turn of the hob from here
    core.play(edges(COUNTS + 10, 30))
    core.play(0, 20_000)
    assert (core.status.waiting, core.status.in_phase) == (0, 1)
    assert phase_error(core, 5, 1) == 0


def test_every_call_is_refused_in_the_wrong_mode(new_core):
    core = new_core()
    assert core.run() == -1  # no job
    assert core.acknowledge() == -1
    assert core.job(1, 2) == 0
    assert core.move(50) == 0
    assert (core.run(), core.move(1), core.job(1, 2), core.acknowledge()) == (-1, -1, -1, -1)
    core.play(0, 200_000)
    assert core.run() == 0
    assert (core.run(), core.move(1), core.job(1, 2), core.acknowledge()) == (-1, -1, -1, -1)
    core.play(0, 50_000, inputs=0)
    assert core.status.mode == FAULT
    assert (core.run(), core.move(1), core.job(1, 2)) == (-1, -1, -1)
    core.stop()
    assert core.status.mode == FAULT


@pytest.mark.parametrize(
    ("wide", "N", "D", "terms"),
    [
        (False, 1, 0, {}),
        (False, 1, -5, {}),
        (False, 1, 2**30 + 1, {}),
        (True, 1, 2**62 + 1, {}),
        (False, 0, 5, {}),
        (False, 65, 1, {}),
        (False, -65, 1, {}),
        (False, 1, 2, {"hysteresis": -1}),
        (False, 1, 2, {"hysteresis": 17}),
        (False, 1, 2, {"feed": 130}),
    ],
)
def test_job_beyond_the_proved_range_is_refused(new_core, wide, N, D, terms):
    core = new_core(wide)
    assert core.job(N, D, **terms) == -1
    assert core.run() == -1


# --- moves ----------------------------------------------------------------------------------------------------------


def test_move_can_be_stopped_and_slows_down_first(new_core):
    core = new_core()
    core.move(100_000)
    core.play(0, 60_000)  # 0.3 s: 2400 steps/s, 360 steps
    reached = core.status.position
    core.stop()
    core.play(0, 200_000)
    assert core.status.mode == IDLE
    assert core.status.position == pytest.approx(2 * reached, abs=3)


def test_hob_that_turns_ends_a_move(new_core):
    core = new_core()
    core.play(edges(100))
    assert core.move(10) == -1  # it turned within the last tenth of a second
    core.play(0, 60_000)
    assert core.move(1000) == 0
    core.play(np.tile(np.concatenate([edges(4, 30), edges(-4, 30)]), 20))  # dither is no turning
    assert core.status.mode == MOVE
    core.play(edges(9))
    assert (core.status.mode, core.status.fault) == (FAULT, HOB_MOVED)


def test_carriage_of_a_lathe_moves_while_the_spindle_turns(new_core):
    core = new_core(GM_PROFILE_HOBBING=None, GM_PROFILE_LATHE=1)
    core.play(edges(1000))
    assert core.move(-200) == 0
    core.play(edges(10_000))
    assert (core.status.mode, core.status.position) == (IDLE, -200)


# --- faults ---------------------------------------------------------------------------------------------------------


def test_lag_trips_one_step_beyond_the_limit(new_core):
    for N, D, fault in ((50, 1, NO_FAULT), (101, 2, LAG), (-50, 1, NO_FAULT), (-101, 2, LAG)):
        core = running(new_core(), N, D)
        script = np.zeros(20, np.int8)
        script[10] = 2
        core.play(script)
        assert core.status.fault == fault


@pytest.mark.parametrize("direction", [1, -1])
@pytest.mark.parametrize("times", [1.3, 3.0, 18.0])
def test_overspeed_trips_before_the_lag(new_core, direction, times):
    """54613 edges/s are allowed, 40 kHz is what pulse and pause take: at ratio 0.65 (6 teeth) even 18 times as fast."""
    core = running(new_core(), 125, 192)
    at = np.arange(0, 200_000, 1 / (times * 54_613 * 5e-6)).astype(int)
    script = np.bincount(at[at < 200_000], minlength=200_000)
    record = core.play(direction * script)
    assert record.fault[np.argmax(record.fault != NO_FAULT)] == OVERSPEED
    assert np.argmax(record.fault != NO_FAULT) * 5e-6 <= 1.3 * 25 / ((times - 1.01) * 54_613) + 1e-4


def test_highest_speed_is_allowed_and_two_percent_more_is_not(new_core):
    for factor, fault in ((1.0, NO_FAULT), (1.02, OVERSPEED)):
        core = running(new_core(), 5, 12)
        at = np.arange(0, 250_000, 1 / (factor * 54_613 * 5e-6)).astype(int)
        core.play(np.bincount(at[at < 250_000], minlength=250_000))
        assert core.status.fault == fault
        assert core.status.edge_rate == pytest.approx(factor * 54_613, abs=1)  # the display keeps its eye on the hob


def test_edge_rate_is_that_of_the_last_whole_second(new_core):
    core = new_core()
    core.play(edges(-4000, 100))  # 2 s at 2000 edges/s
    assert core.status.edge_rate == 2000
    core.play(0, 450_000)
    assert core.status.edge_rate == 0


def test_emergency_stop_is_seen_after_ten_milliseconds_and_no_burst_of_noise_is_taken_for_it(new_core):
    for enter in (lambda core: None, lambda core: running(core, 1, 2), lambda core: core.move(500)):
        core = new_core()
        enter(core)
        noise = np.random.default_rng(1).random(200) < 0.5
        core.play(0, inputs=np.concatenate([np.zeros(200), np.ones(400)] * 5))  # a millisecond open, two closed
        core.play(0, inputs=np.concatenate([noise, np.ones(200)] * 20))
        assert core.status.fault == NO_FAULT
        core.play(0, 2000, inputs=0)
        assert core.status.fault == ESTOP
        record = core.play(0, 60_000, inputs=0)
        assert core.status.mode == FAULT  # hob and table stand
        assert (record.position[-1] == record.position[-20_000:]).all()
        assert core.acknowledge() == -1  # still open
        core.play(0, 4000)
        assert core.acknowledge() == 0
        assert core.status.mode == IDLE


def test_pressed_emergency_stop_is_seen_in_noise_too(new_core):
    core = new_core()
    core.play(0, inputs=np.random.default_rng(2).random(10_000) < 0.2)  # open, and disturbed one tick in five
    assert core.status.fault == ESTOP


def test_table_follows_to_the_standstill_after_an_emergency_stop_and_keeps_its_phase(new_core):
    """The hob runs down within 0.4 s: no step is lost, and the job goes on after the fault is acknowledged."""
    core = running(new_core(GM_ACCELERATION=20_000), 125, 576)
    speed = np.concatenate([np.linspace(0, 30_000, 300_000), np.full(60_000, 30_000), np.linspace(30_000, 0, 80_000)])
    counts = np.floor(np.cumsum(np.concatenate([speed, np.zeros(60_000)])) * 5e-6)
    open_from = 340_000
    inputs = np.ones(len(counts))
    inputs[open_from:] = 0
    record = core.play(np.diff(counts, prepend=0), inputs=inputs)
    assert (record.fault[open_from + 2000 :] == ESTOP).all()
    error = record.position + record.pending - 125 * counts / 576
    assert np.abs(error).max() <= 0.5 + 1e-9
    assert np.abs(record.pending).max() <= 1
    assert (core.status.mode, core.status.has_job) == (FAULT, 1)
    core.play(0, 5000)
    assert (core.acknowledge(), core.run(), core.status.in_phase) == (0, 0, 1)


def test_fault_of_the_drive_brakes_and_loses_job_and_phase(new_core):
    core = running(new_core(GM_ACCELERATION=20_000, GM_MAX_LAG=30, GM_MAX_STEP_RATE=40_000), 1, 8)
    counts = np.floor(np.cumsum(np.linspace(0, 40_000, 200_000)) * 5e-6)
    core.play(np.diff(counts, prepend=0))  # 5000 steps/s after a second
    assert core.status.in_phase == 1
    record = core.play(0, 60_000)  # the encoder falls silent: the table would have to stop at once
    assert (core.status.mode, core.status.fault, core.status.has_job) == (FAULT, LAG, 0)
    rest = record.position[-1] - record.position[0]
    assert rest == pytest.approx(5000**2 / 2 / 20_000, rel=0.03)  # v^2/2a
    assert core.run() == -1


# --- the healthy output ---------------------------------------------------------------------------------------------


def healthy(record) -> np.ndarray:
    return (record.levels & 8) != 0


def test_healthy_output_waits_for_the_inputs_and_for_the_operator(new_core):
    core = new_core()
    assert core.arm() == -1  # no input was read
    assert not healthy(core.play(0, 3000)).any()
    assert core.arm() == 0
    wave = healthy(core.play(0, 3000))
    turns = np.flatnonzero(np.diff(wave.astype(int)))
    assert len(turns) >= 29
    assert set(np.diff(turns).tolist()) == {100}  # half a millisecond each


def test_healthy_output_falls_with_the_main_program_and_with_every_fault(new_core):
    core = new_core()
    core.play(0, 3000)
    core.arm()
    wave = healthy(core.play(0, 100_000))
    assert wave[:49_000].any()
    assert not wave[50_001:].any()  # 250 ms after the last sign of life
    assert core.arm() == 0
    assert healthy(core.play(0, 300)).any()
    core.play(0, 2001, inputs=0)
    assert not healthy(core.play(0, 4000, inputs=0)).any()
    assert core.arm() == -1
    core.play(0, 20_000)
    assert not healthy(core.play(0, 4000)).any()  # latched: a closed contact does not bring it back
    assert core.acknowledge() == 0
    assert not healthy(core.play(0, 4000)).any()
    assert core.arm() == 0
    assert healthy(core.play(0, 300)).any()


def test_machine_without_emergency_stop_input_ignores_it(new_core):
    core = new_core(GM_HAS_ESTOP=0)
    core.play(0, 1000, inputs=0)
    assert core.status.fault == NO_FAULT


# --- alarm of the driver --------------------------------------------------------------------------------------------

OK, ALARM_INPUT, RESET_OUTPUT = 1, 2, 16


def test_alarm_of_the_driver_stops_the_pulses_and_its_acknowledgement_resets_the_driver(new_core):
    core = running(new_core(GM_HAS_ALARM=1), 1, 2)
    noise = np.where(np.random.default_rng(3).random(20_000) < 0.4, OK | ALARM_INPUT, OK)
    record = core.play(edges(400, 50), inputs=noise)
    assert (core.status.fault, core.status.in_phase) == (NO_FAULT, 1)
    assert not (record.levels & RESET_OUTPUT).any()
    core.play(0, 1000)
    record = core.play(edges(100, 50), inputs=OK | ALARM_INPUT)
    assert (core.status.mode, core.status.fault, core.status.has_job) == (FAULT, 6, 0)
    tripped = int(np.argmax(record.fault == 6))
    assert tripped == 399  # 2 ms
    assert record.position[-1] == record.position[tripped]
    assert core.acknowledge() == -1
    reset = (core.play(0, 50_000, inputs=OK | ALARM_INPUT).levels & RESET_OUTPUT) != 0
    assert (reset[:40_000].all(), reset[40_000:].any()) == (True, False)  # 200 ms
    core.play(0, 1000)
    assert core.acknowledge() == 0


# --- index ------------------------------------------------------------------------------------------------------------


class Hob:
    """A hob with an encoder and an index mark of ``width`` counts; lost edges are not passed on."""

    def __init__(self, core, width: int) -> None:
        self.core, self.width, self.place = core, width, 50

    def turn(self, counts: int, lost: frozenset[int] = frozenset(), index: bool = True) -> None:
        """``lost``: places modulo a turn whose edge is lost."""
        step = 1 if counts > 0 else -1
        places = self.place + step * np.arange(1, abs(counts) + 1)
        inside = places % COUNTS < self.width
        was = np.concatenate([[self.place % COUNTS < self.width], inside[:-1]])
        script = np.where(np.isin(places % COUNTS, list(lost)), 0, step)
        pulses = inside & ~was if index else np.zeros(len(places))
        every = 6
        hob, flags = np.zeros(len(places) * every, np.int8), np.zeros(len(places) * every, np.uint8)
        hob[::every], flags[::every] = script, pulses
        self.core.play(hob, index=flags)
        self.place = int(places[-1])


@pytest.fixture
def hob(new_core):
    """A hob in run mode with an index of a given width."""

    def make(width: int = 6) -> Hob:
        return Hob(running(new_core(GM_HAS_INDEX=1, GM_MAX_EDGE_RATE=100_000), 25, 64), width)

    return make


@pytest.mark.parametrize("width", [1, 4, 6])
def test_good_encoder_is_never_accused(hob, width):
    """Turns both ways, reversals anywhere, and rocking about the mark."""
    it, random = hob(width), np.random.default_rng(width)
    for counts in [3 * COUNTS, -5 * COUNTS, 2 * COUNTS, *random.integers(-9000, 9000, 30).tolist()]:
        it.turn(counts)
        assert it.core.status.fault == NO_FAULT
    it.turn(-(it.place % COUNTS) + COUNTS)
    for _ in range(3):
        it.turn(3)
        it.turn(-4)
        it.turn(1)
    assert it.core.status.fault == NO_FAULT
    assert it.core.status.index_turns > 20


@pytest.mark.parametrize("direction", [1, -1])
def test_one_edge_lost_in_every_turn_is_found_within_four_turns(hob, direction):
    it = hob()
    it.turn(direction * 3 * COUNTS)
    assert it.core.status.fault == NO_FAULT
    it.turn(direction * 4 * COUNTS, lost=frozenset({2000}))
    assert it.core.status.fault == ENCODER
    assert it.core.status.index_error == -3


def test_edges_lost_only_at_reversals_add_up(hob):
    it = hob()
    it.turn(2 * COUNTS)
    for _ in range(5):
        it.turn(COUNTS, lost=frozenset({1500, 1501}))
        it.turn(-COUNTS)
    assert it.core.status.fault == ENCODER


def test_broken_encoder_line_is_found_though_every_turn_counts_zero(hob):
    """One channel stuck: the decoder counts one forward, one back; the index pulses find no edges at all."""
    it = hob()
    it.turn(2 * COUNTS - it.place)  # onto the mark
    script = np.tile([1, 0, 0, -1, 0, 0], 5000)
    it.core.play(script, index=np.arange(len(script)) % 3000 == 0)
    assert (it.core.status.fault, it.core.status.index_error) == (ENCODER, -COUNTS)


def test_index_that_never_comes_is_found_after_four_turns(hob):
    it = hob()
    it.turn(4 * COUNTS, index=False)
    assert it.core.status.fault == NO_FAULT
    it.turn(COUNTS, index=False)
    assert (it.core.status.fault, it.core.status.mode) == (ENCODER, FAULT)


def test_missing_index_is_found_after_four_turns(hob):
    it = hob()
    it.turn(COUNTS)
    it.turn(3 * COUNTS, index=False)
    assert it.core.status.fault == NO_FAULT
    it.turn(2 * COUNTS, index=False)
    assert it.core.status.fault == ENCODER


# --- the text ---------------------------------------------------------------------------------------------------------


def write(files: dict[str, str], folder) -> list[str]:
    for name, text in files.items():
        (folder / name).write_text(text, "utf-8")
    return [name for name in files if name.endswith(".c")]


@pytest.mark.parametrize(
    "compiler", ["gcc -std=c99", "gcc -std=gnu11 -Os", "g++ -x c++ -std=c++11", "g++ -x c++ -std=gnu++17"]
)
@pytest.mark.parametrize("wide", [False, True])
def test_core_compiles_without_a_warning_as_c_and_as_cpp(core_text, tmp_path, compiler, wide):
    command = compiler.split()
    if shutil.which(command[0]) is None:
        pytest.skip(f"needs {command[0]}")
    sources = write(core_text(wide, GM_HAS_INDEX=1), tmp_path)
    flags = ["-pedantic", "-Wall", "-Wextra", "-Werror", "-Wshadow", "-O2", "-c", *sources]
    done = subprocess.run([*command, *flags], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


def test_no_floating_point_in_the_core(core_text):
    import re

    for name in ("gm_core.c", "gm_core.h", "gm_gearbox_edge.h", "gm_encoder_hysteresis.h"):
        text = re.sub(r"/\*.*?\*/", "", core_text(True)[name], flags=re.DOTALL)
        assert not re.search(r"\b(float|double)\b|\b\d+\.\d*|\bf(abs|loor|mod)\b", text), name


STRESS = """\
#include <stdio.h>
#include <stdlib.h>

#include "gm_core.h"

static uint32_t state = 1;

static uint32_t rnd(uint32_t n)
{
  state = state * 1664525u + 1013904223u;
  return (state >> 8) % n;
}

static void check(int good, const char *what, long sequence)
{
  if (good) return;
  printf("sequence %ld: %s\\n", sequence, what);
  exit(1);
}

static gm_wide any_wide(void)
{
  switch (rnd(4)) {
    case 0: return (gm_wide)rnd(200);
    case 1: return (gm_wide)((gm_wide)1 << (GM_WIDE ? 62 : 30)) - (gm_wide)rnd(3);
    case 2: return (gm_wide)0 - (gm_wide)rnd(50);
    default: return (gm_wide)rnd(1u << 24);
  }
}

static int mode_of_fault(gm_mode mode) { return mode == GM_FAULT || mode == GM_RUN; }

int main(void)
{
  gm_core core;
  long sequence, modes[4] = {0, 0, 0, 0}, faults[6] = {0, 0, 0, 0, 0, 0};
  unsigned before = 0, inputs = GM_IN_ESTOP_OK;
  gm_core_init(&core);
  for (sequence = 0; sequence < SEQUENCES; ++sequence) {
    uint32_t n, length = 5 + rnd(60), forward = rnd(4), rate = 1 + rnd(12);
    if (sequence % 500 == 0) {
      gm_core_init(&core);
      before = GM_OUT_DIR | GM_OUT_ENABLE;
    }
    for (n = 0; n < length; ++n) {
      gm_job job;
      gm_status status;
      gm_mode mode;
      int k;
      switch (rnd(24)) {
        case 0:
          job.denominator = any_wide();
          for (k = 0; k < GM_AXES; ++k) {
            job.increment[k] = rnd(8) && job.denominator > 0 ? any_wide() % job.denominator : any_wide();
            job.base[k] = rnd(4) ? 0 : (int32_t)rnd(140) - 70;
          }
          job.hysteresis = (int32_t)rnd(8) ? 0 : (int32_t)rnd(20) - 1;
          (void)gm_core_set_job(&core, &job);
          break;
        case 1: case 2: (void)gm_core_run(&core); break;
        case 3: if (rnd(4) == 0) gm_core_stop(&core); break;
        case 4: (void)gm_core_move(&core, rnd(9) ? (int32_t)rnd(200) - 100 : INT32_MIN + (int32_t)rnd(2)); break;
        case 5: (void)gm_core_acknowledge(&core); gm_core_alive(&core); (void)gm_core_arm(&core); break;
        case 6:
          if (rnd(12) == 0) gm_core_index(&core);
          for (k = rnd(12) ? 0 : (int)rnd(40); k > 0; --k) gm_core_edge(&core, GM_HOB, n & 1 ? 1 : -1);
          break;
        case 7: inputs = rnd(12) ? GM_IN_ESTOP_OK : 0; break;
        case 8: gm_core_edge(&core, GM_FEED, rnd(2) ? 1 : -1); break;
        case 9: case 10: case 11: case 12: case 13: gm_core_edge(&core, GM_HOB, rnd(4) < forward ? 1 : -1); break;
        default:
          for (k = 0; k < (int)(inputs ? rate : 15 * rate); ++k) { /* the filter takes 200 ticks */
            unsigned levels;
            int sound;
            mode = core.mode;
            sound = core.fault == GM_NO_FAULT && core.armed;
            levels = gm_core_tick(&core, inputs);
            check(!(levels & ~before & GM_OUT_STEP) || mode != GM_IDLE, "a pulse begins", sequence);
            check((levels & GM_OUT_ENABLE) != 0, "no torque", sequence);
            check(!(levels & GM_OUT_HEALTHY) || sound, "healthy", sequence);
            check(!((levels ^ before) & GM_OUT_DIR) || mode != GM_IDLE, "DIR changes", sequence);
            before = levels;
          }
      }
      gm_core_status(&core, &status);
      check(status.mode >= GM_IDLE && status.mode <= GM_FAULT, "mode", sequence);
      check(status.mode != GM_FAULT || status.fault != GM_NO_FAULT, "fault mode without a fault", sequence);
      check(status.fault == GM_NO_FAULT || mode_of_fault(status.mode), "mode of a fault", sequence);
      check(!status.in_phase || (status.pending <= GM_MAX_LAG && status.pending >= -GM_MAX_LAG), "lag", sequence);
      check(!status.in_phase || status.mode == GM_RUN, "in phase", sequence);
      check(status.pending == 0 || status.mode != GM_IDLE, "steps wait", sequence);
      check(status.has_job || status.mode != GM_RUN, "runs without a job", sequence);
      check(!core.has_job || (core.remainder >= 0 && core.remainder < core.job.denominator), "remainder", sequence);
      check(core.away >= 0 && (!core.has_job || core.away <= core.lead_steps), "away", sequence);
      check(!status.waiting || status.mode == GM_RUN, "waits", sequence);
      ++modes[status.mode];
      ++faults[status.fault];
    }
  }
  for (sequence = 0; sequence < 4; ++sequence) check(modes[sequence] > 1000, "a mode is never reached", sequence);
  for (sequence = 0; sequence < 6; ++sequence) check(faults[sequence] > 100, "a fault is never reached", sequence);
  return 0;
}
"""


@pytest.mark.parametrize("wide", [False, True])
def test_hundred_thousand_random_sequences_never_leave_a_defined_mode(core_text, gcc, tmp_path, wide):
    """Under the sanitizers: no undefined behaviour, no pulse that begins in GM_IDLE or GM_FAULT."""
    files = core_text(
        wide,
        GM_HAS_INDEX=1,
        GM_ENCODER_COUNTS=40,
        GM_MOVE_MAX_RATE=90_000,
        GM_MOVE_ACCELERATION=9_000_000,
        GM_ESTOP_MS=1,
    )
    del files["probe.c"]
    sources = write(files | {"stress.c": STRESS.replace("SEQUENCES", "100000")}, tmp_path)
    flags = ["-std=c99", "-O1", "-fsanitize=address,undefined", "-fno-sanitize-recover=all"]
    subprocess.run([gcc, *flags, *sources, "-o", "stress"], cwd=tmp_path, check=True)
    done = subprocess.run(["./stress"], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")


def test_nearest_is_what_the_name_says():
    """The formula that these tests check against, by Fractions: never more than half a step from the ratio."""
    for e in range(-50, 51):
        assert abs((2 * 125 * e + 192) // (2 * 192) - Fraction(125 * e, 192)) <= Fraction(1, 2)
        assert (2 * 125 * e + 192) // (2 * 192) == floor(Fraction(125 * e, 192) + Fraction(1, 2))
