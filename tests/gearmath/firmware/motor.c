/* A motor with inertia beside the core, in random sequences: it must not stall, nor be accelerated more than allowed.
 *
 * MICROSTEPS, MARGIN and ABRUPT_MARGIN (of torque at rest), ACCELERATION, SEED and SEQUENCES are given. With TRACE, a
 * file, all that was done to the core, and every step that it gave, is written there: a core elsewhere that gives the
 * same steps turns the same motor.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "gm_core.h"

static gm_core core;
static uint32_t state = SEED;
static const double tick = GM_TICK_NS * 1e-9, most = ACCELERATION, top = GM_MAX_STEP_RATE;

static uint32_t rnd(uint32_t n)
{
  state = state * 1664525u + 1013904223u;
  return (state >> 8) % n;
}
static double between(double low, double high) { return low + (high - low) * rnd(100000) / 100000.0; }

/* What is done to the core; of a play the lag, mode and fault at its end follow, then its edges and steps, tick by tick. */
enum { INIT, JOB, MOVE, RUN, STOP, ACKNOWLEDGE, PLAY };
#ifdef TRACE
static FILE *trace;
static void note(int what, int64_t a, int64_t b, int64_t c)
{
  const int64_t entry[4] = {what, a, b, c};
  if (!trace) trace = fopen(TRACE, "wb");
  (void)fwrite(entry, sizeof entry, 1, trace);
}
enum { LONGEST = 100000 };
static int8_t tape[2][LONGEST];
static long taped;
static void note_tick(int64_t edges, int64_t steps)
{
  tape[0][taped] = (int8_t)edges;
  tape[1][taped] = (int8_t)steps;
  ++taped;
}
static void note_play(void)
{
  const int64_t lag = core.locked ? core.pending : core.pending + core.behind;
  note(PLAY, taped, lag, core.mode * 16 + core.fault);
  (void)fwrite(tape[0], 1, (size_t)taped, trace);
  (void)fwrite(tape[1], 1, (size_t)taped, trace);
  taped = 0;
}
#else
#define note(what, a, b, c) ((void)0)
#define note_tick(edges, steps) ((void)0)
#define note_play() ((void)0)
#endif

static long sequence;
static void check(int good, const char *what, double value)
{
  if (good) return;
  printf("sequence %ld: %s: %g\n", sequence, what, value);
  exit(1);
}

/* The rotor, in motor steps; a full step is MICROSTEPS of them. A tenth of the critical damping, as the windings give
 * it against the turning field, and a friction of a tenth of the strength at top speed. */
static double rotor, speed, field, field_speed, margin = MARGIN;
static void turn_rotor(double wanted, double dt)
{
  const double full = MICROSTEPS, strength = margin * most / (1.0 + fabs(speed) / top);
  const double turn = 1.5707963267948966 / full;
  double pull = strength * sin((wanted - rotor) * turn) - 0.1 * margin * most * speed / top;
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
  static int last_dir;
  const long apart = ticks - last_step;
  if (core.locked) runs = 0; /* however shortly, between two steps: those in phase come with the edges */
  if (core.position == before) return;
  last_step = ticks;
  if (dir != last_dir) runs = 0;
  last_dir = dir;
  if (++runs > 4) {
    const double v = 1.0 / (apart * tick), u = 1.0 / (steps_apart[0] * tick), faster = v > u ? v : u;
    const double allowed = most * (apart + steps_apart[0]) * tick / 2.0 * 1.02 + 2.0 * faster * faster * tick * 1.05;
    check(fabs(v - u) <= allowed, "from step to step, over what is allowed", fabs(v - u) / allowed);
  }
  steps_apart[0] = apart;
}

static int feasible = 1;
static void play(double seconds)
{
  long n;
  for (n = (long)(seconds / tick); n > 0; --n) {
    int64_t place, before = core.position, before_edges = counted;
    if (hob_speed < hob_target) hob_speed = fmin(hob_target, hob_speed + hob_rate * tick);
    if (hob_speed > hob_target) hob_speed = fmax(hob_target, hob_speed - hob_rate * tick);
    hob += hob_speed * tick;
    place = (int64_t)floor(hob);
    for (; counted < place; ++counted) gm_core_edge(&core, GM_HOB, 1);
    for (; counted > place; --counted) gm_core_edge(&core, GM_HOB, -1);
    (void)gm_core_tick(&core, GM_IN_ESTOP_OK);
    note_tick(counted - before_edges, core.position - before);
    ++ticks;
    if (ticks % 4 == 0) turn_rotor((double)core.position, 4 * tick);
    if (core.engaged && core.locked) check_phase();
    check_acceleration();
    check_steps(before, core.dir);
    if (feasible) check(core.fault == GM_NO_FAULT, "a fault though it was feasible", core.fault);
  }
  note_play();
}

/* A job; where all is to be feasible, one that the speed of the hob allows. */
static void new_job(void)
{
  gm_job job;
  int64_t base;
  do {
    D = 1 + rnd(100000);
    N = (int64_t)(D * between(0.03, 1.2)) + 1;
  } while (feasible && fabs(hob_speed) * (double)N / (double)D > 0.8 * top);
  if (rnd(2)) N = -N;
  base = N / D - (N % D < 0);
  job.denominator = (gm_wide)D;
  job.base[GM_HOB] = (int32_t)base;
  job.increment[GM_HOB] = (gm_wide)(N - base * D);
  job.base[GM_FEED] = 0;
  job.increment[GM_FEED] = 0;
  job.hysteresis = 0;
  note(JOB, N, D, 0);
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
      note(INIT, 0, 0, 0);
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
          const int32_t way = (int32_t)rnd(4000) - 2000; /* a lathe: the spindle may turn */
          note(MOVE, way, 0, 0);
          (void)gm_core_move(&core, way);
        }
        if (rnd(3)) {
          note(RUN, 0, 0, 0);
          (void)gm_core_run(&core);
        }
        break;
      case GM_RUN:
        if (rnd(4) == 0) {
          note(STOP, 0, 0, 0);
          gm_core_stop(&core);
        }
        break;
      default: break;
    }
    new_speed(1.0);
    if (core.engaged && !core.locked) hob_target = hob_speed; /* it is catching up: a steady speed, as the plan says */
    else if (core.engaged) caught += 1;
    play(between(0.02, 0.4));
    gm_core_status(&core, &status);
    in_phase += status.in_phase;
  }
  if (in_phase < SEQUENCES / 8 || idle < SEQUENCES / 20) {
    printf("in phase %ld, idle %ld of %ld\n", in_phase, idle, (long)SEQUENCES);
    return 1;
  }
  (void)caught;
  /* What no plan allows: the hob starts and stops at once, at any speed; faults are right, a stall is not. The table
   * may then go from full braking to full acceleration at top speed, and the rotor swings to 1 + 2 * 0.729 times the
   * acceleration (0.729 = exp(-0.1 pi/sqrt(0.99)): a tenth of the critical damping). With friction, that is a motor of
   * 6.2 times the acceleration at rest, 3.1 at top speed. One of 4 stalls in one of some thousand such sequences. */
  margin = ABRUPT_MARGIN;
  feasible = 0;
  for (sequence = 0; sequence < SEQUENCES / 10; ++sequence) {
    if (core.mode == GM_FAULT) {
      note(ACKNOWLEDGE, 0, 0, 0);
      (void)gm_core_acknowledge(&core);
    }
    if (core.mode == GM_IDLE) {
      change_job();
      note(RUN, 0, 0, 0);
      (void)gm_core_run(&core);
    }
    new_speed(1.2);
    hob_rate = 1e9;
    play(between(0.02, 0.3));
  }
  return 0;
}
