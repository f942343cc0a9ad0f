"""Every fault in every mode, as the README's table says: the motor, the outputs, and what is remembered.

Power may be lost at every tick of all these scripts: what a reset makes of the memory then is the core of the first
power-up, byte for byte. What the EEPROM brings back is tested with the whole sketch.
"""

from __future__ import annotations

import numpy as np
import pytest

from gearmath.export.screens import BRAKES, FAULT_MATRIX, FOLLOWS, STANDS, STOPS, FaultRow

IDLE, RUN, MOVE, FAULT = range(4)
ESTOP, LAG, OVERSPEED, ENCODER, HOB_MOVED, ALARM = range(1, 7)
OK, ALARM_INPUT = 1, 2
STEP, ENABLE, HEALTHY = 1, 4, 8
TICK, ACCELERATION = 5e-6, 20_000

MACHINE = {
    "GM_ACCELERATION": ACCELERATION,
    "GM_MOVE_ACCELERATION": ACCELERATION,
    "GM_HAS_INDEX": 1,
    "GM_HAS_ALARM": 1,
    "GM_MAX_STEP_RATE": 40_000,
    "GM_MAX_LAG": 60,
    "GM_MAX_EDGE_RATE": 21_000,
}
#: Counts per second of the hob while it turns.
SPEED = 20_000.0


def at_speed(seconds: float, speed: float = SPEED) -> np.ndarray:
    return np.diff(np.floor(np.arange(int(seconds / TICK) + 1) * TICK * speed)).astype(np.int8)


def ramp(seconds: float, first: float, last: float) -> np.ndarray:
    speeds = np.linspace(first, last, int(seconds / TICK))
    return np.diff(np.floor(np.cumsum(speeds) * TICK), prepend=0).astype(np.int8)


def trigger(core, fault: int, turning: bool) -> np.ndarray:
    """Lets the fault come, the hob standing or turning at SPEED; the levels of the outputs meanwhile."""
    hob = at_speed(0.02) if turning else np.zeros(4000, np.int8)
    if fault == ESTOP:
        records = [core.play(hob, inputs=0)]
    elif fault == ALARM:
        records = [core.play(hob, inputs=OK | ALARM_INPUT)]
    elif fault == OVERSPEED:
        quick = np.concatenate([ramp(0.1, SPEED, 23_000.0), ramp(0.1, 23_000.0, SPEED)])
        records = [core.play(quick if turning else at_speed(0.004, 200_000.0))]
    elif fault == LAG:
        records = [core.play(np.where(np.arange(200) < 160, 2, 0))]
    elif fault == ENCODER:
        turns = [(4096 + shift) / SPEED for shift in (0, 700, 900)]  # index pulses that are no whole turn apart
        records = [core.play(at_speed(one), index=np.arange(int(one / TICK)) == 50) for one in turns]
    else:
        assert fault == HOB_MOVED
        records = [core.play(at_speed(0.003))]
    return np.concatenate([record.levels for record in records])


CASES = [
    pytest.param(row, mode, id=f"{row.page}-{mode}")
    for row in FAULT_MATRIX
    for mode in ("standing", "following", "moving")
    if getattr(row, mode)
]


@pytest.mark.parametrize(("row", "mode"), CASES)
def test_fault_does_what_the_table_of_the_readme_says(new_core, row: FaultRow, mode: str) -> None:
    core = new_core(**MACHINE)
    core.library.probe_resets()
    core.play(0, 3000)
    assert (core.job(1, 4), core.arm()) == (0, 0)
    if mode == "following":
        assert core.run() == 0
        core.play(ramp(0.4, 0.0, SPEED))
        core.play(at_speed(0.03))
        assert core.status.in_phase == 1
    elif mode == "moving":
        assert core.move(4000) == 0
        core.play(0, 40_000)
        assert core.status.mode == MOVE
    assert core.arm() == 0
    levels = trigger(core, row.fault, turning=mode == "following")
    assert core.status.fault == row.fault
    outcome, turning = getattr(row, mode), mode == "following"
    before = core.status.position
    inputs = {ESTOP: 0, ALARM: OK | ALARM_INPUT}.get(row.fault, OK)
    hob = np.concatenate([at_speed(0.05), ramp(0.5, SPEED, 0.0)]) if turning and row.fault != LAG else np.zeros(110_000)
    record = core.play(hob, inputs=inputs)
    went = int(record.position[-1]) - before
    if outcome == FOLLOWS:
        assert core.status.mode == RUN or core.status.mode == FAULT
        assert np.abs(record.pending).max() <= 4
        assert went == pytest.approx(hob.sum() / 4, abs=5)
    elif outcome in (STANDS, STOPS):
        assert went == 0
    else:
        assert outcome == BRAKES
        assert 0 <= went <= 4000
        assert (np.diff(record.position[-20_000:]) == 0).all()
    assert not (record.levels & HEALTHY).any()
    levels = np.concatenate([levels, record.levels])
    assert (levels & ENABLE).all()
    pulse = np.diff((levels & STEP) != 0)  # before and after the fault a step is as long as the driver asks
    first = int(levels[0] & STEP != 0)
    begins, ends = np.flatnonzero(pulse)[first::2], np.flatnonzero(pulse)[1 + first :: 2]
    assert set(ends - begins[: len(ends)]) <= {2}
    assert len(begins) == len(ends) or outcome == FOLLOWS
    core.play(0, 60_000, inputs=inputs)
    assert core.status.mode == FAULT
    assert not (core.play(0, 5000).levels & HEALTHY).any()  # the cause is gone: nothing comes back by itself
    assert core.acknowledge() == 0
    assert core.status.mode == IDLE
    assert core.status.has_job == row.kept
    assert (core.run() == 0) == row.kept
    assert not (core.play(0, 5000).levels & HEALTHY).any()  # until the operator lets it
    assert core.library.probe_not_fresh() == 0


def turn(core, hob: np.ndarray) -> None:
    """Play a hob whose index pulse comes once a turn."""
    places = (core.status.edges + np.cumsum(hob, dtype=np.int64)) // 4096
    core.play(hob, index=np.diff(places, prepend=places[0]) != 0)


def test_power_that_comes_back_leaves_everything_off_whatever_turns(new_core):
    """Run-up, following, a stop, a move, and a reset at every tick; then no pulse, no healthy output and no job."""
    core = new_core(**MACHINE)
    core.library.probe_resets()
    core.play(0, 3000)
    assert (core.job(1, 4), core.arm(), core.run()) == (0, 0, 0)
    run_down = np.concatenate([at_speed(0.1), ramp(0.5, SPEED, 0.0), np.zeros(60_000, np.int8)])
    turn(core, ramp(0.5, 0.0, SPEED))
    core.stop()
    turn(core, run_down)
    assert core.run() == 0
    turn(core, ramp(0.5, 0.0, SPEED))
    assert (core.status.mode, core.status.fault) == (RUN, 0)
    core.stop()
    turn(core, run_down)
    assert core.move(4000) == 0
    core.play(0, 40_000)
    assert core.status.mode == MOVE
    assert core.library.probe_not_fresh() == 0
    core.library.probe_init()
    record = core.play(at_speed(0.2))
    assert len(np.unique(record.levels)) == 1
    assert not (record.levels & HEALTHY).any()
    assert (core.status.mode, core.status.has_job, core.status.position) == (IDLE, 0, 0)
    assert core.run() == -1
