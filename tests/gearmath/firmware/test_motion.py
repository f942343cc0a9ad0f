"""A motor with inertia, driven by the exported C: it is never stalled, and "in phase" is true whenever it is said.

The motor is a rotor in a magnetic field: torque = holding torque of its speed times the sine of the electrical angle,
damping and friction, and it stalls two full steps from where it should be. The hob turns as a script says; edges,
steps and the place that the table should have are computed apart from the core.
"""

import subprocess
from fractions import Fraction

import numpy as np
import pytest

from gearmath.gearbox.kernels import evaluate

IDLE, RUN, MOVE, FAULT = range(4)
NO_FAULT, ESTOP, LAG, OVERSPEED = range(4)
TICK = 5e-6

MOTOR = """\
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "gm_core.h"

static gm_core core;
static uint32_t state = 1;
static const double tick = GM_TICK_NS * 1e-9, most = ACCELERATION, top = GM_MAX_STEP_RATE;

static uint32_t rnd(uint32_t n)
{
  state = state * 1664525u + 1013904223u;
  return (state >> 8) % n;
}
static double between(double low, double high) { return low + (high - low) * rnd(100000) / 100000.0; }

static long sequence;
static void check(int good, const char *what, double value)
{
  if (good) return;
  printf("sequence %ld: %s: %g\\n", sequence, what, value);
  exit(1);
}

/* The rotor, in motor steps; a full step is MICROSTEPS of them. A tenth of the critical damping, as the windings give
 * it against the turning field, and a friction of a tenth of the strength at top speed. */
static double rotor, speed, field, field_speed;
static void turn_rotor(double wanted, double dt)
{
  const double full = MICROSTEPS, strength = MARGIN * most / (1.0 + fabs(speed) / top);
  const double turn = 1.5707963267948966 / full;
  double pull = strength * sin((wanted - rotor) * turn) - 0.1 * MARGIN * most * speed / top;
  field_speed += ((wanted - field) / dt - field_speed) * dt / 0.001;
  field = wanted;
  pull += 2.0 * 0.1 * sqrt(strength * turn) * (field_speed - speed);
  speed += pull * dt;
  rotor += speed * dt;
  check(fabs(wanted - rotor) < 2.0 * full, "the motor stalls", wanted - rotor);
}

/* the hob: place in counts, speed, and the speed to which it goes at a rate */
static double hob, hob_speed, hob_target, hob_rate;
static int64_t counted;
static int64_t N, D;

static void check_phase(void)
{
  /* 2 D p - 2 N e, modulo one turn of the hob: within one half step */
  const __int128 turn = (__int128)2 * (N < 0 ? -N : N) * GM_ENCODER_COUNTS;
  __int128 off = ((__int128)2 * D * (core.position + core.pending) - (__int128)2 * N * core.edges[GM_HOB]) % turn;
  if (off < 0) off += turn;
  if (off > turn / 2) off -= turn;
  check(off <= D && off >= -D, "in phase, but off by [steps]", (double)off / (2.0 * (double)D));
}

enum { GRID = 20000, SPAN = 3 };              /* 100 ms */
static double places[SPAN];
static long ticks, last_step, steps_apart[2]; /* of steps out of phase in a row, in one direction */
static int runs, waits;

static void check_acceleration(void)
{
  int k;
  if (ticks % GRID) return;
  for (k = SPAN - 1; k > 0; --k) places[k] = places[k - 1];
  places[0] = (double)core.position;
  if (++waits >= SPAN) {
    const double tau = GRID * tick, bend = fabs(places[0] - 2.0 * places[1] + places[2]);
    check(bend <= most * tau * tau + 16.0, "acceleration over 100 ms", bend / (tau * tau));
  }
}

/* From step to step: the speeds before and after differ by the acceleration in that time, and the rounding to ticks. */
static void check_steps(int64_t before, int dir)
{
  static int64_t last;
  static int last_dir;
  const long apart = ticks - last_step;
  (void)last;
  if (core.position == before) return;
  last_step = ticks;
  if (core.locked || dir != last_dir) runs = 0;
  last_dir = dir;
  if (++runs > 4) {
    const double v = 1.0 / (apart * tick), u = 1.0 / (steps_apart[0] * tick), faster = v > u ? v : u;
    const double allowed = most * (apart + steps_apart[0]) * tick / 2.0 * 1.02 + 2.0 * faster * faster * tick * 1.05;
    check(fabs(v - u) <= allowed, "from step to step, over what is allowed", fabs(v - u) / allowed);
  }
  steps_apart[0] = apart;
}

static void play(double seconds, int feasible)
{
  long n;
  for (n = (long)(seconds / tick); n > 0; --n) {
    int64_t place, before = core.position;
    if (hob_speed < hob_target) hob_speed = fmin(hob_target, hob_speed + hob_rate * tick);
    if (hob_speed > hob_target) hob_speed = fmax(hob_target, hob_speed - hob_rate * tick);
    hob += hob_speed * tick;
    place = (int64_t)floor(hob);
    for (; counted < place; ++counted) gm_core_edge(&core, GM_HOB, 1);
    for (; counted > place; --counted) gm_core_edge(&core, GM_HOB, -1);
    (void)gm_core_tick(&core, GM_IN_ESTOP_OK);
    ++ticks;
    if (ticks % 4 == 0) turn_rotor((double)core.position, 4 * tick);
    if (core.engaged && core.locked) check_phase();
    check_acceleration();
    check_steps(before, core.dir);
    if (feasible) check(core.fault == GM_NO_FAULT, "a fault though it was feasible", core.fault);
  }
}

static void new_job(void)
{
  gm_job job;
  int64_t base;
  D = 1 + rnd(100000);
  N = (int64_t)(D * between(0.03, 1.2)) + 1;
  if (rnd(2)) N = -N;
  base = N / D - (N % D < 0);
  job.denominator = (gm_wide)D;
  job.base[GM_HOB] = (int32_t)base;
  job.increment[GM_HOB] = (gm_wide)(N - base * D);
  job.base[GM_FEED] = 0;
  job.increment[GM_FEED] = 0;
  job.hysteresis = 0;
  check(gm_core_set_job(&core, &job) == 0, "job", 0);
}

static void change_job(void)
{
  rotor -= (double)core.position;
  field -= (double)core.position;
  new_job();
  runs = waits = 0;
}

/* The hob goes to a speed whose steps the motor takes, as quickly as the table can follow, or as the lag allows. */
static void new_speed(double part)
{
  const double ratio = fabs((double)N / (double)D), limit = fmin(0.9 * GM_MAX_EDGE_RATE, 0.8 * top / ratio);
  hob_target = rnd(4) ? (rnd(2) ? 1.0 : -1.0) * between(0.0, part * limit) : 0.0;
  hob_rate = between(0.2, 0.97) * most / ratio;
}

int main(void)
{
  long in_phase = 0, caught = 0, idle = 0;
  gm_status status;
  for (sequence = 0; sequence < SEQUENCES; ++sequence) {
    if (sequence % 40 == 0) { /* power-up; the rotor stands where the next step will be */
      gm_core_init(&core);
      rotor = speed = field = field_speed = 0.0;
      hob = hob_speed = hob_target = 0.0;
      counted = 0;
      runs = waits = 0;
      hob_rate = 1.0;
      new_job();
    }
    gm_core_status(&core, &status);
    switch (status.mode) {
      case GM_IDLE:
        ++idle;
        if (rnd(4) == 0) { /* another job: the counts begin anew */
          change_job();
        } else if (rnd(3) == 0) {
          (void)gm_core_move(&core, (int32_t)rnd(4000) - 2000); /* a lathe: the spindle may turn */
        }
        if (rnd(3)) (void)gm_core_run(&core);
        break;
      case GM_RUN:
        if (rnd(4) == 0) gm_core_stop(&core);
        break;
      default: break;
    }
    new_speed(1.0);
    if (core.engaged && !core.locked) hob_target = hob_speed; /* it is catching up: a steady speed, as the plan says */
    else if (core.engaged) caught += 1;
    play(between(0.02, 0.4), 1);
    gm_core_status(&core, &status);
    in_phase += status.in_phase;
  }
  if (in_phase < SEQUENCES / 8 || idle < SEQUENCES / 20) {
    printf("in phase %ld, idle %ld of %ld\\n", in_phase, idle, (long)SEQUENCES);
    return 1;
  }
  (void)caught;
  /* what no plan allows: the hob starts and stops at once, at any speed; faults are right, a stall is not */
  for (sequence = 0; sequence < SEQUENCES / 10; ++sequence) {
    if (core.mode == GM_FAULT) (void)gm_core_acknowledge(&core);
    if (core.mode == GM_IDLE) {
      change_job();
      (void)gm_core_run(&core);
    }
    new_speed(1.2);
    hob_rate = 1e9;
    play(between(0.02, 0.3), 0);
  }
  return 0;
}
"""

QUICK = {
    "GM_ACCELERATION": 100_000,
    "GM_MOVE_ACCELERATION": 100_000,
    "GM_MOVE_MAX_RATE": 8000,
    "GM_MAX_STEP_RATE": 60_000,
    "GM_MAX_EDGE_RATE": 60_000,
    "GM_STEP_HIGH_TICKS": 1,
    "GM_STEP_LOW_TICKS": 1,
    "GM_DIR_SETUP_TICKS": 1,
    "GM_DIR_HOLD_TICKS": 1,
    "GM_HAS_ESTOP": 0,
    "GM_PROFILE_HOBBING": None,
    "GM_PROFILE_LATHE": 1,
}


@pytest.mark.slow
@pytest.mark.parametrize(("microsteps", "acceleration"), [(8, 100_000), (4, 20_000)])
def test_motor_is_never_stalled_and_in_phase_is_true_in_ten_thousand_sequences(
    core_text, gcc, tmp_path, microsteps, acceleration
):
    """Jobs engaged at any speed and phase, stops, restarts, moves, feed holds; the hob as quick as it follows."""
    assert drive_motor(core_text, gcc, tmp_path, microsteps, acceleration, acceleration, 5000) == (0, "")


def test_that_motor_stalls_or_the_acceleration_is_noticed_where_the_core_gives_more(core_text, gcc, tmp_path):
    for given in (10_000_000, 300_000, 130_000):
        status, words = drive_motor(core_text, gcc, tmp_path, 8, 100_000, given, 400)
        assert status == 1
        assert "stalls" in words or "acceleration over" in words or "from step to step" in words


def drive_motor(core_text, gcc, folder, microsteps, acceleration, given, sequences) -> tuple[int, str]:
    """Status and words of the program: a motor of some acceleration, a core that is told to give ``given``."""
    changes = {**QUICK, "GM_ACCELERATION": given, "GM_MOVE_ACCELERATION": given}
    files = core_text(True, **changes)
    del files["probe.c"]
    for name, text in (files | {"motor.c": MOTOR}).items():
        (folder / name).write_text(text, "utf-8")
    defines = [
        f"-DMICROSTEPS={microsteps}",
        "-DMARGIN=4.0",
        f"-DSEQUENCES={sequences}",
        f"-DACCELERATION={acceleration}.0",
    ]
    sources = [name for name in (*files, "motor.c") if name.endswith(".c")]
    subprocess.run([gcc, "-std=gnu99", "-O2", *defines, *sources, "-o", "motor", "-lm"], cwd=folder, check=True)
    done = subprocess.run(["./motor"], cwd=folder, capture_output=True, text=True, check=False)
    return done.returncode, done.stdout


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


@pytest.mark.parametrize("seconds", [0.2, 0.5, 1.0, 2.0])
def test_run_up_to_800_rpm_is_followed_or_trips_as_the_plan_says(new_core, seconds):
    """24 teeth, 16000 steps, 8000 steps/s^2: 8889 steps/s, so 1.09 s are needed."""
    core = new_core(GM_ACCELERATION=8000, GM_MAX_STEP_RATE=40_000)
    rate = 800 / 60 * 4096
    assert (core.job(125, 768), core.run()) == (0, 0)
    _, _, shortest = evaluate("run_up", rate * 125 / 768, 8000.0, 100.0)
    clock = np.arange(int((seconds + 1.5) / TICK)) * TICK
    record = core.play(turned(rate * np.minimum(clock / seconds, 1.0)))
    assert (core.status.fault == NO_FAULT) == (seconds >= shortest)
    if core.status.fault == NO_FAULT:
        counts = np.cumsum(turned(rate * np.minimum(clock / seconds, 1.0)))
        error = record.position + record.pending - 125 * counts / 768
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
