"""A motor with inertia, driven by the exported C: it is never stalled, and "in phase" is true whenever it is said.

The motor is a rotor in a magnetic field: torque = holding torque of its speed times the sine of the electrical angle,
damping and friction, and it stalls two full steps from where it should be. The hob turns as a script says; edges,
steps and the place that the table should have are computed apart from the core.
"""

import re
from fractions import Fraction
from functools import partial

import numpy as np
import pytest

from gearmath.export.guide import guide
from gearmath.gearbox.kernels import evaluate
from gearmath.specs.hobbing import find_hobbing_machine
from tests.gearmath.firmware.motor import MOTORS, QUICK, replay, run_motor

IDLE, RUN, MOVE, FAULT = range(4)
NO_FAULT, ESTOP, LAG, OVERSPEED = range(4)
TICK = 5e-6


@pytest.fixture
def drive_motor(gcc, tmp_path):
    """``drive_motor(motor, given, sequences)``: status and words of the program motor.c, whose core is told to give
    ``given`` and whose motor allows what it allows; with ``seed`` it writes its trace."""
    return partial(run_motor, gcc, tmp_path)


@pytest.mark.slow
@pytest.mark.parametrize("motor", MOTORS)
def test_motor_is_never_stalled_and_in_phase_is_true_in_ten_thousand_sequences(drive_motor, motor):
    """Jobs engaged at any speed and phase, stops, restarts, moves, feed holds; the hob as quick as it follows."""
    assert drive_motor(motor, motor.acceleration, 5000) == (0, "")


def test_that_motor_stalls_or_the_acceleration_is_noticed_where_the_core_gives_more(drive_motor):
    for given in (10_000_000, 300_000, 130_000):
        status, words = drive_motor(MOTORS[0], given, 400)
        assert status == 1
        assert "stalls" in words or "acceleration over" in words or "from step to step" in words


# --- the same motor beside the core on the processors of the boards ---------------------------------------------------


def test_cores_on_the_processors_of_the_boards_turn_that_motor_by_the_steps_of_the_host_s(
    drive_motor, emulated_core, tmp_path
):
    """The motor beside the host's core does not stall, and each step of the emulated cores is at the same tick. A motor
    gives nothing back to the core: it is the same motor, with the same margins. ``python tests/motor_on_the_boards.py``
    runs ten thousand sequences on either processor."""
    assert drive_motor(MOTORS[0], MOTORS[0].acceleration, 30, seed=2) == (0, "")
    for processor in ("cortex-m4", "cortex-m7"):
        assert replay(emulated_core(processor, True, **QUICK), tmp_path / "trace") == 33
    slower = emulated_core("cortex-m4", True, **{**QUICK, "GM_ACCELERATION": QUICK["GM_ACCELERATION"] - 1})
    with pytest.raises(AssertionError):
        replay(slower, tmp_path / "trace")


# --- what the plan says ---------------------------------------------------------------------------------------------

PLANNED = {
    **QUICK,
    "GM_MAX_LAG": 200,
    "GM_MAX_STEP_RATE": 80_000,
    "GM_ACCELERATION": 40_000,
    "GM_MAX_EDGE_RATE": 70_000,
}


def turned(speed: np.ndarray) -> np.ndarray:
    """Edges per tick of a hob with these speeds [counts/s]."""
    return np.diff(np.floor(np.cumsum(speed) * TICK), prepend=0).astype(np.int8)


@pytest.mark.parametrize(("name", "steps"), [("hobbing_default", 444), ("lathe_example", 15118)])
def test_jog_on_the_oscilloscope_has_the_shortest_interval_that_the_readme_tells(new_core, name, steps):
    """10 degrees of 16000 steps a turn; 10 mm of 4800 steps a turn of a lead screw of 8 tpi."""
    machine = find_hobbing_machine(f"{name}.toml")
    told = int(re.search(r"intervals fall to (\d+) us", guide(machine, name))[1])
    limits = {"GM_MOVE_MAX_RATE": machine.move_max_rate, "GM_MOVE_ACCELERATION": machine.limits.acceleration_hz_per_s}
    core = new_core(**{key: int(value) for key, value in limits.items()})
    assert core.move(steps) == 0
    record = core.play(0, 500_000)
    assert record.position[-1] == steps
    assert np.diff(np.flatnonzero(np.diff(record.position))).min() * 5 == pytest.approx(told, rel=0.02, abs=5)


@pytest.mark.parametrize("rate", [4000.0, 20_000.0, 50_000.0])
def test_catching_up_takes_the_time_and_the_speed_that_the_plan_tells(new_core, rate):
    core = new_core(**PLANNED)
    core.play(turned(np.full(40_000, rate)))
    assert (core.job(1, 1), core.run()) == (0, 0)
    overtaking, seconds = evaluate("catch_up", rate, 40_000.0, 80_000.0)
    record = core.play(turned(np.full(int(1.3 * seconds / TICK), rate)))
    assert core.status.in_phase == 1
    assert core.status.position + core.status.pending == core.status.edges
    caught = np.argmax(np.abs(record.pending) > 1) + np.argmax(np.abs(record.pending[2000:]) <= 1) + 2000
    last = (2 * 1.5 / 30_000) ** 0.5  # seconds of the last step and a half, braking
    assert caught * TICK == pytest.approx(seconds - last, rel=0.03)
    fastest = np.diff(record.position[::2000]).max() / (2000 * TICK)
    assert fastest == pytest.approx(rate + overtaking, rel=0.02)


@pytest.mark.parametrize(
    ("rate", "part", "fault"),
    [
        (4000.0, 1.03, NO_FAULT),
        (10_000.0, 1.3, NO_FAULT),
        (10_000.0, 1.03, NO_FAULT),
        (10_000.0, 0.7, LAG),
        (40_000.0, 1.03, NO_FAULT),
        (40_000.0, 0.9, LAG),
    ],
)
def test_hob_that_runs_up_in_the_shortest_time_of_the_plan_is_followed_and_a_quicker_one_is_not(
    new_core, rate, part, fault
):
    _, _, shortest = evaluate("run_up", rate, 40_000.0, 200.0)
    time = part * shortest
    core = new_core(**PLANNED)
    assert (core.job(1, 1), core.run()) == (0, 0)
    clock = np.arange(int((time + 0.6 + rate / 40_000) / TICK)) * TICK
    record = core.play(turned(rate * np.minimum(clock / time, 1.0)))
    assert core.status.fault == fault
    if fault == NO_FAULT:
        assert core.status.in_phase == 1
        assert np.abs(record.pending).max() <= 200
        assert core.status.position + core.status.pending == core.status.edges


@pytest.mark.parametrize(
    ("processor", "seconds"),
    [(None, 0.2), (None, 0.5), (None, 1.0), (None, 2.0), ("cortex-m4", 2.0), ("cortex-m7", 1.0)],
)
def test_run_up_to_800_rpm_is_followed_or_trips_as_the_plan_says(new_core, request, processor, seconds):
    """24 teeth, 16000 steps, 8000 steps/s^2: 8889 steps/s, so 1.09 s are needed."""
    machine = {"GM_ACCELERATION": 8000, "GM_MAX_STEP_RATE": 40_000}
    if processor is None:
        core = new_core(**machine)
    else:
        core = request.getfixturevalue("emulated_core")(processor, False, **machine)
    rate = 800 / 60 * 4096
    assert (core.job(125, 768), core.run()) == (0, 0)
    _, _, shortest = evaluate("run_up", rate * 125 / 768, 8000.0, 100.0)
    clock = np.arange(int((seconds + 1.5) / TICK)) * TICK
    edges = turned(rate * np.minimum(clock / seconds, 1.0))
    record = core.play(edges)
    assert (record.fault[-1] == NO_FAULT) == (seconds >= shortest)
    if record.fault[-1] == NO_FAULT:
        error = record.position + record.pending - 125 * np.cumsum(edges, dtype=np.int64) / 768
        assert np.abs(error).max() <= 0.5 + 1e-9


def test_engaged_at_the_phase_of_the_thread_after_a_stop(new_core):
    """A lathe at 1000 rpm: stop, and run on; it ends beside the spindle with the phase of the first cut."""
    core = new_core(**PLANNED)
    rate, ratio = 1000 / 60 * 4096.0, Fraction(3, 8)
    speed = np.concatenate([np.linspace(0, rate, 400_000), np.full(100_000, rate)])
    assert (core.job(3, 8), core.run()) == (0, 0)
    core.play(turned(speed))
    assert core.status.in_phase == 1
    for wait in (0.7, 0.93):
        core.stop()
        record = core.play(turned(np.full(int(wait / TICK), rate)))
        braked = record.position[-1] - record.position[0]
        assert braked == pytest.approx(float(rate * ratio) ** 2 / 2 / 40_000, rel=0.01)
        assert core.run() == 0
        core.play(turned(np.full(500_000, rate)))
        assert core.status.in_phase == 1
        off = (core.status.position + core.status.pending - ratio * core.status.edges) % (4096 * ratio)
        assert min(off, 4096 * ratio - off) <= Fraction(1, 2)


def test_full_rate_of_the_readme_is_reached_by_engaging_and_the_line_comes_back_after_a_hob_that_stops_at_once(
    new_core,
):
    """Commissioning of the bundled machine as its README says it: the hob is at its speed, and stops, within a tick."""
    machine = find_hobbing_machine("hobbing_default.toml")
    text = " ".join(guide(machine, "gearbox").split())
    words = r"job of (\d+) teeth, no.*?on, (\d+) rpm.*?to about (\d+) steps/s.*?after about (\d+) s, with (\d+) steps/s"
    teeth, rpm, highest, seconds, rate = (int(one) for one in re.search(words, text).groups())
    ratio = Fraction(16_000, teeth * 4096)
    core = new_core(GM_ACCELERATION=8000, GM_MAX_STEP_RATE=40_000)
    edges = rpm / 60 * 4096
    core.play(turned(np.full(100_000, edges)))
    assert (core.job(ratio.numerator, ratio.denominator), core.run()) == (0, 0)
    record = core.play(turned(np.full(int((seconds + 0.5) / TICK), edges)))
    assert core.status.in_phase == 1
    assert np.diff(record.position[::2000]).max() / (2000 * TICK) == pytest.approx(highest, rel=0.05)
    assert edges * float(ratio) == pytest.approx(rate, abs=1)
    core.stop()
    core.play(turned(np.full(int(3.5 / TICK), edges)))
    core.play(0, 100_000)  # switched off, at once
    assert core.run() == 0
    by_hand = 0
    while core.status.in_phase == 0:
        core.play(turned(np.full(20_000, 4096.0)))  # a tenth of a turn
        by_hand += 1
        assert by_hand <= 10 * teeth + 5
    place = core.status.position + core.status.pending
    off = (place - ratio * core.status.edges) % 16_000
    assert min(off, 16_000 - off) <= Fraction(1, 2)
