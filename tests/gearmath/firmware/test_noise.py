"""Noise: bursts of 1 ms on every input of the core lose no job, no phase, no real edge; real faults are found."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest

NO_FAULT, ENCODER = 0, 4
COUNTS, TICK = 4096, 5e-6
OK, ALARM_INPUT, HEALTHY = 1, 2, 8
BURST = 200  # ticks of 1 ms
N, D = 25, 64

MACHINE = {"GM_HAS_INDEX": 1, "GM_HAS_ALARM": 1, "GM_MAX_EDGE_RATE": 54_613}


def turning(turns: float, every: int = 4) -> tuple[np.ndarray, np.ndarray]:
    """Edges of a hob, one every ``every`` ticks (50 kHz), with the index pulse at its place."""
    count = int(turns * COUNTS)
    hob, index = np.zeros(count * every, np.int8), np.zeros(count * every, np.uint8)
    hob[::every] = 1
    places = np.arange(1, count + 1) % COUNTS
    index[::every] = places == 1000
    return hob, index


def engaged(new_core, **changes):
    core = new_core(**{**MACHINE, **changes})
    core.play(0, 3000)
    assert (core.job(N, D), core.arm(), core.run()) == (0, 0, 0)
    return core


def holds(core, hob: np.ndarray, record) -> None:
    """No fault, in phase, every real edge followed to half a step, the healthy output a square wave throughout."""
    assert (core.status.fault, core.status.has_job, core.status.in_phase) == (NO_FAULT, 1, 1)
    count = int(hob.sum())
    assert abs(core.status.position + core.status.pending - Fraction(N * count, D)) <= Fraction(1, 2)


@pytest.mark.parametrize("seed", range(8))
def test_bursts_on_the_index_accuse_nobody(new_core, seed):
    """Bursts at random places, over the index itself, before the first index, one a turn and several a turn."""
    core, random = engaged(new_core), np.random.default_rng(seed)
    hob, index = turning(8)
    starts = random.integers(0, len(hob) - BURST, 25).tolist()
    mark = 4 * 999  # the tick of the first index
    starts += [mark - 150, mark + 4 * COUNTS * 3 - BURST // 2, mark + 4 * COUNTS * 5 - 3]
    for start in starts:
        noise = random.random(BURST) < random.choice([0.02, 0.2, 0.5])
        noise[random.integers(BURST)] = True
        index[start : start + BURST] |= noise
    record = core.play(hob, index=index)
    holds(core, hob, record)


@pytest.mark.parametrize("lost", [5, 40, 1500])
@pytest.mark.parametrize("seed", range(3))
def test_edges_that_are_really_lost_are_found_among_the_bursts(new_core, seed, lost):
    core, random = engaged(new_core), np.random.default_rng(seed)
    hob, index = turning(8)
    edges = np.flatnonzero(hob)
    hob[edges[3 * COUNTS + 1200 : 3 * COUNTS + 1200 + lost]] = 0
    for start in random.integers(0, len(hob) - BURST, 6).tolist():
        index[start : start + BURST] |= random.random(BURST) < 0.2
    core.play(hob, index=index)
    assert core.status.fault == ENCODER
    assert core.status.index_turns <= 5
    assert core.status.index_error == -lost


@pytest.mark.parametrize("seed", range(4))
def test_bursts_on_one_channel_of_the_encoder_cost_nothing(new_core, seed):
    """Noise on A or B makes counts to and fro, up to one a tick, at standstill and at the highest speed."""
    core, random = engaged(new_core, GM_ACCELERATION=10_000_000), np.random.default_rng(seed)
    hob, index = turning(4)
    noisy = hob.copy()
    for start in random.integers(0, len(hob) - BURST, 30).tolist():
        swing = np.cumsum(np.where(random.random(BURST) < 0.5, 1, 0)) % 2  # the channel's level, as it is counted
        noisy[start : start + BURST] += np.diff(swing, prepend=0, append=0)[:BURST].astype(np.int8)
        noisy[start + BURST - 1] -= swing[-1]
    assert noisy.sum() == hob.sum()
    record = core.play(noisy, index=index)
    core.play(0, 2000)
    holds(core, hob, record)


def test_bursts_on_the_feed_encoder_cost_nothing(new_core):
    """Counts to and fro about every place of the scale; the table stands where hob and feed ask in the end."""
    core, random = engaged(new_core, GM_HAS_INDEX=0), np.random.default_rng(3)
    hob, _ = turning(4)
    feed = np.zeros(len(hob), np.int8)
    feed[::80] = 1
    counts = int(feed.sum())
    for start in random.integers(0, len(hob) - BURST, 30).tolist():
        level = np.cumsum(random.random(BURST) < 0.5) % 2  # of one channel, as it is counted
        feed[start : start + BURST] += np.diff(level, prepend=0).astype(np.int8)
        feed[start + BURST - 1] -= level[-1]
    assert feed.sum() == counts
    core.play(hob, feed=feed)
    core.play(0, 2000)
    assert (core.status.fault, core.status.has_job, core.status.in_phase) == (NO_FAULT, 1, 1)
    exact = Fraction(N * int(hob.sum()), D)  # this job has no term of the feed: its edges must not move the table
    assert abs(core.status.position + core.status.pending - exact) <= Fraction(1, 2)


def test_bursts_on_emergency_stop_and_alarm_stop_nothing(new_core):
    core, random = engaged(new_core), np.random.default_rng(5)
    hob, index = turning(3)
    inputs = np.full(len(hob), OK, np.uint8)
    for start in range(500, len(hob) - 4000, 4000):  # a burst every 20 ms
        noise = random.random(BURST) < 0.7
        inputs[start : start + BURST] = np.where(noise, ALARM_INPUT, OK)
    record = core.play(hob, index=index, inputs=inputs)
    holds(core, hob, record)


def test_edges_at_the_highest_rate_are_never_filtered(new_core):
    """Pairs of edges half the mean distance apart, as a real encoder gives them, at the limit of the speed."""
    core = engaged(new_core, GM_MAX_EDGE_RATE=100_000, GM_HAS_INDEX=0)
    hob = np.tile(np.array([1, 1, 0, 0], np.int8), 50_000)  # 100 kHz on the average, 200 kHz in pairs
    record = core.play(hob)
    core.play(0, 2000)
    holds(core, hob, record)
