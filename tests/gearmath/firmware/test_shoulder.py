"""The soft stop at a shoulder: never beyond it, near it, with the phase kept, at any speed and acceleration."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest

IDLE, RUN = 0, 1
TICK = 5e-6


def ramped(seconds: float, speed: float, run_up: float) -> np.ndarray:
    """Edges of a spindle that runs up to ``speed`` counts per second."""
    time = np.arange(int(seconds / TICK)) * TICK
    counts = np.where(time < run_up, speed * time**2 / (2 * run_up), speed * (time - run_up / 2))
    return np.diff(np.floor(counts), prepend=0).astype(np.int8)


@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize("acceleration", [4000, 20_000, 200_000])
@pytest.mark.parametrize("speed", [500.0, 8000.0, 40_000.0])
@pytest.mark.parametrize("place", [700, 5003])
def test_motor_stops_before_the_shoulder_and_no_earlier_than_it_must(new_core, sign, acceleration, speed, place):
    N, D = sign * 25, 64
    rate = speed * abs(N) / D
    core = new_core(GM_ACCELERATION=acceleration, GM_MAX_LAG=100_000, GM_PROFILE_HOBBING=None, GM_PROFILE_LATHE=1)
    assert (core.job(N, D), core.run()) == (0, 0)
    core.library.probe_shoulder(sign * place)
    braking = rate**2 / (2 * acceleration)
    record = core.play(ramped(2.0 * place / rate + rate / acceleration, speed, 1.2 * rate / acceleration))
    core.play(0, 300_000)
    reached = sign * record.position
    assert core.status.mode == IDLE
    assert reached.max() < place
    # steps that one look (16 ticks) and the rounding cost, and the filtered speed over the way of braking
    assert place - sign * core.status.position <= 6 + rate * 16 * TICK * 4 + 0.35 * braking
    assert core.status.has_job == 1


def test_next_pass_begins_in_the_same_groove(new_core):
    N, D = 25, 64
    core = new_core(GM_ACCELERATION=40_000, GM_PROFILE_HOBBING=None, GM_PROFILE_LATHE=1)
    assert (core.job(N, D), core.run()) == (0, 0)
    core.library.probe_shoulder(2500)
    turned = 0
    for _ in range(3):
        for _ in range(5):
            script = ramped(0.4, 8000.0, 0.1)
            core.play(script)
            turned += int(script.sum())
        assert core.status.mode == IDLE
        core.play(0, 200_000)
        assert core.move(-core.status.position) == 0
        core.play(0, 800_000)
        assert (core.status.mode, core.status.position) == (IDLE, 0)
        assert core.run() == 0
    script = ramped(0.8, 8000.0, 0.1)
    core.play(script)
    turned += int(script.sum())
    assert (core.status.mode, core.status.in_phase) == (RUN, 1)
    lead = Fraction(N * 4096, D)
    off = (core.status.position + core.status.pending - Fraction(N * turned, D)) % lead
    assert min(off, lead - off) <= Fraction(1, 2)
