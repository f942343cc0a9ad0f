"""STEP and DIR as the pins give them, read by a decoder that knows only levels and the times a driver asks for."""

import math
from dataclasses import dataclass

import numpy as np
import pytest

from gearmath.specs.drivers import DRIVERS

STEP, DIR = 1, 2
FAULT = 3


@dataclass(frozen=True)
class Decoded:
    """What a driver sees [ns]: shortest pulse, pause, DIR before and after a pulse; and where the motor went."""

    high: float
    low: float
    setup: float
    hold: float
    position: np.ndarray  # after each sample
    starts: np.ndarray  # samples at which a pulse begins
    reversals: int


def decode(levels: np.ndarray, tick_ns: int, step_low: bool, dir_low: bool) -> Decoded:
    """Times and steps from levels sampled every tick. A pulse cut off by the end of the record has no length."""
    step = ((levels & STEP) != 0) != step_low
    forward = ((levels & DIR) != 0) != dir_low
    change = np.diff(step.astype(np.int8), prepend=0)
    starts, ends = np.flatnonzero(change == 1), np.flatnonzero(change == -1)
    turns = np.flatnonzero(np.diff(forward)) + 1
    assert not (step[turns] & step[turns - 1]).any(), "DIR changes within a pulse"
    high = (ends - starts[: len(ends)]).min(initial=2**40)
    low = (starts[1:] - ends[: len(starts) - 1]).min(initial=2**40)
    after = np.searchsorted(starts, turns)  # the first pulse after each change of DIR
    setup = (starts[after[after < len(starts)]] - turns[after < len(starts)]).min(initial=2**40)
    before = np.searchsorted(ends, turns, side="right") - 1  # the last pulse before it
    hold = (turns[before >= 0] - ends[before[before >= 0]]).min(initial=2**40)
    moves = np.where(change == 1, np.where(forward, 1, -1), 0)
    times = (float(ticks) * tick_ns for ticks in (high, low, setup, hold))
    return Decoded(*times, np.cumsum(moves), starts, len(turns))


def ticks(driver: str, tick_ns: int) -> dict[str, int]:
    """The four times in ticks, rounded up."""
    row = DRIVERS[driver]
    names = ("GM_STEP_HIGH_TICKS", "GM_STEP_LOW_TICKS", "GM_DIR_SETUP_TICKS", "GM_DIR_HOLD_TICKS")
    times = (row.step_high, row.step_low, row.dir_setup, row.dir_hold)
    return {name: max(1, math.ceil(time / tick_ns)) for name, time in zip(names, times, strict=True)}


def assert_driver_is_content(seen: Decoded, driver: str) -> None:
    row = DRIVERS[driver]
    assert seen.high >= row.step_high
    assert seen.low >= row.step_low
    assert seen.setup >= row.dir_setup
    assert seen.hold >= row.dir_hold


def hob_script(random: np.random.Generator, every: int, runs: int) -> np.ndarray:
    """Edges every ``every`` ticks or so, with reversals, and long and short rests at some of them."""
    parts = []
    for direction in (1 - 2 * (np.arange(runs) % 2)).tolist():
        edges = np.zeros(int(random.integers(3, 60)) * every, np.int8)
        edges[random.integers(0, every) :: every] = direction
        parts += [edges, np.zeros(int(random.choice([0, 0, 1, every, 20 * every])), np.int8)]
    return np.concatenate(parts)


@pytest.mark.parametrize("tick_ns", [2000, 5000])
@pytest.mark.parametrize("driver", list(DRIVERS))
def test_every_driver_gets_its_times_through_reversals_moves_and_a_trip(new_core, driver, tick_ns):
    """Both polarities of STEP and DIR in turn; ratio 1.3, so that one edge may be two steps."""
    random = np.random.default_rng(len(driver))
    timing = ticks(driver, tick_ns)
    pulse = timing["GM_STEP_HIGH_TICKS"] + timing["GM_STEP_LOW_TICKS"]
    for step_low, dir_low, invert in ((0, 0, 0), (1, 1, 0), (1, 0, 1), (0, 1, 1)):
        core = new_core(
            GM_TICK_NS=tick_ns,
            **timing,
            GM_STEP_ACTIVE_LOW=step_low,
            GM_DIR_ACTIVE_LOW=dir_low,
            GM_DIR_INVERT=invert,
            GM_MOVE_MAX_RATE=200_000,
            GM_MOVE_ACCELERATION=2_000_000,
            GM_MAX_EDGE_RATE=1_000_000,
        )
        assert core.job(13, 10) == 0
        assert core.run() == 0
        records = [core.play(hob_script(random, 2 * pulse + 1, 12)), core.play(0, 300 * pulse + 4000)]
        core.stop()
        records.append(core.play(0, 200_000_000 // tick_ns))  # the hob stands, so that a move may begin
        for steps in (150, -40, 1, -1):
            assert core.move(steps) == 0
            records.append(core.play(0, 400 * pulse + 60_000_000 // tick_ns))
            assert core.status.mode == 0
        core.job(13, 10)
        assert core.run() == 0
        where = core.status.position  # 0: the job counts anew
        estop = np.ones(120 * pulse + timing["GM_DIR_SETUP_TICKS"], np.uint8)
        estop[-7 * pulse :] = 0  # opened in the middle of steps
        records.append(core.play(np.where(np.arange(len(estop)) % (2 * pulse) == 0, -1, 0), inputs=estop))
        records.append(core.play(0, 260_000_000 // tick_ns, inputs=0))  # seen, and the hob stands
        levels = np.concatenate([record.levels for record in records])
        seen = decode(levels, tick_ns, bool(step_low), bool(dir_low) != bool(invert))
        assert_driver_is_content(seen, driver)
        assert seen.reversals > 10
        before, after = sum(len(record.levels) for record in records[:-2]), seen.position[-1]
        assert seen.position[before - 1] == records[-3].position[-1]
        assert after - seen.position[before - 1] == core.status.position - where
        assert core.status.mode == FAULT
        assert core.status.position < -10


def test_table_stands_at_the_nearest_step_when_the_pulses_are_out(new_core):
    """Decoded position = floor((2 N e + D)/(2 D)), after each of 40 bursts."""
    core = new_core()
    core.job(125, 192)
    core.run()
    random, count, total = np.random.default_rng(3), 0, 0
    for _ in range(40):
        script = hob_script(random, 40, 3)
        count += int(script.sum())
        levels = core.play(np.concatenate([script, np.zeros(400, np.int8)])).levels
        total += int(decode(levels, 5000, False, False).position[-1])
        assert total == (2 * 125 * count + 192) // (2 * 192) == core.status.position


@pytest.mark.parametrize(("N", "D"), [(3, 1), (7, 2), (-5, 1), (16, 3)])
def test_several_steps_of_one_edge_are_spread_evenly(new_core, N, D):
    """Hob at a steady 1000 edges/s: no gap is longer than interval/floor(N/D), none shorter than interval/ceil(N/D)."""
    core = new_core()
    core.job(N, D)
    core.run()
    script = np.where(np.arange(60_000) % 200 == 0, 1, 0)  # 1 ms = 200 ticks
    seen = decode(core.play(script).levels, 5000, False, False)
    gaps = np.diff(seen.starts[20:])
    assert gaps.max() <= 200 // math.floor(abs(N / D)) + 2
    assert gaps.min() >= 200 // math.ceil(abs(N / D)) - 2


def test_steps_wait_for_the_driver_but_not_for_a_standing_hob(new_core):
    """Two edges after a long rest, five steps each: out within 20 ms, not spread over the rest."""
    core = new_core()
    core.job(5, 1)
    core.run()
    script = np.zeros(30_000, np.int8)
    script[[0, 20_000]] = 1
    record = core.play(script)
    assert record.position[19_999] == 5
    assert record.position[20_000 + 4000] == 10


def test_trip_ends_a_pulse_whole_and_starts_no_other(new_core):
    """More edges than the lag allows, at every tick of a pulse in turn."""
    for delay in range(1, 13):
        core = new_core(GM_STEP_HIGH_TICKS=6, GM_MAX_LAG=8)
        core.job(1, 1)
        core.run()
        core.play(0, 50)
        script = np.zeros(100, np.int8)
        script[10:13] = 1
        script[10 + delay] += 20
        record = core.play(script)
        step = (record.levels & STEP) != 0
        change = np.diff(step.astype(int), prepend=0, append=0)
        assert set(np.flatnonzero(change == -1) - np.flatnonzero(change == 1)) == {6}
        fault = int(np.argmax(record.mode == FAULT))
        assert fault == 10 + delay
        assert not (np.flatnonzero(change == 1) > fault).any()
        assert (record.levels & 4).all()  # the motor keeps its torque


def speeds(starts: np.ndarray) -> np.ndarray:
    """Steps/s between pulses."""
    return 1e9 / (np.diff(starts) * 5000)


@pytest.mark.parametrize("steps", [1, 2, 3, 100, 999, 3000, -3000])
def test_move_is_a_trapezoid_of_exactly_its_steps(new_core, steps):
    """4000 steps/s at 8000 steps/s²: v² = 2 a s on both ramps, within the two or three steps at their feet."""
    core = new_core()
    assert core.move(steps) == 0
    record = core.play(0, 500_000)
    assert core.status.position == steps
    assert core.status.mode == 0
    seen = decode(record.levels, 5000, False, False)
    assert len(seen.starts) == abs(steps)
    if abs(steps) < 100:
        return
    rate = speeds(seen.starts)
    top = min(4000.0, math.sqrt(8000.0 * abs(steps)))
    assert rate.max() <= 4000.0 * 1.02
    assert rate.max() == pytest.approx(top, rel=0.03)
    at = np.arange(10, 40)
    np.testing.assert_allclose(rate[at], np.sqrt(2 * 8000.0 * (at + 1)), rtol=0.03)
    # at - 1/2 steps before the end, in the middle between two pulses; it brakes with 15/16, 3 % slower
    np.testing.assert_allclose(rate[-at], np.sqrt(2 * 8000.0 * (at - 0.5)), rtol=0.05)


def test_decoder_itself_finds_a_runt_a_late_direction_and_a_wrong_level():
    levels = np.zeros(40, np.uint8) + DIR
    levels[10:14] |= STEP
    levels[20:22] |= STEP
    levels[25:] &= ~np.uint8(DIR)
    levels[26:30] |= STEP
    seen = decode(levels, 1000, False, False)
    assert (seen.high, seen.low, seen.setup, seen.hold) == (2000, 4000, 1000, 3000)
    assert seen.position[-1] == 1
    inverted = decode(levels ^ 3, 1000, True, True)
    assert np.array_equal(inverted.position, seen.position)
    levels[21] ^= DIR
    with pytest.raises(AssertionError, match="within a pulse"):
        decode(levels, 1000, False, False)
