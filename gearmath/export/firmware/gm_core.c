/* gm_core.c: see gm_core.h. The step rule and the hysteresis are generated kernels; what is here is their calling. */
#include "gm_core.h"

#include <string.h>

#include "gm_encoder_hysteresis.h"
#include "gm_gearbox_edge.h"

/* The range in which the kernels are proved. */
#define GM_LARGEST_DENOMINATOR ((gm_wide)1 << (GM_WIDE ? 62 : 30))
#define GM_LARGEST_BASE 64
#define GM_LARGEST_HYSTERESIS 16

/* Overspeed: every edge adds its sign to a bucket that runs out at GM_MAX_EDGE_RATE and 1 %. It trips when GM_BURST edges
 * too many of one direction are in it, so that at any speed GM_OVERSPEED comes before GM_LAG where GM_BURST N/D <
 * GM_MAX_LAG, while noise on one channel, which counts to and fro, does not fill it. */
#define GM_BURST 24
#define GM_ONE_EDGE 65536
#define GM_LEAK ((int32_t)((uint64_t)GM_MAX_EDGE_RATE * 101u * GM_TICK_NS * GM_ONE_EDGE / 100000000000u + 1u))

/* Milliseconds, windows of 100 ms, and the second of edge_rate. */
#define GM_MILLISECOND_TICKS (1000000u / GM_TICK_NS)
#define GM_WINDOW_MILLISECONDS 100u
#define GM_SECOND_WINDOWS 10u

/* Steps of a hob that is turned by hand are not spread over more than 20 ms. */
#define GM_LONGEST_INTERVAL (20u * GM_MILLISECOND_TICKS)

/* Speeds in 2^-48 steps per tick; 10^9 = 2^9 5^9 and 5^9 = 1953125. The top is what the driver takes. */
#define GM_ONE_STEP ((int64_t)1 << 48)
#define GM_SPEED_OF(rate) (int64_t)(((((uint64_t)(rate) * GM_TICK_NS) << 20) / 1953125u) << 19)
#define GM_SPEED_POSSIBLE (GM_ONE_STEP / (GM_STEP_HIGH_TICKS + GM_STEP_LOW_TICKS))
#define GM_LESSER(a, b) ((a) < (b) ? (a) : (b))
#define GM_MOVE_SPEED GM_LESSER(GM_SPEED_OF(GM_MOVE_MAX_RATE), GM_SPEED_POSSIBLE)
#define GM_FOLLOW_SPEED GM_LESSER(GM_SPEED_OF(GM_LESSER(GM_MAX_STEP_RATE, 1000000)), GM_SPEED_POSSIBLE)
#define GM_GAIN_OF(acceleration) \
  (int64_t)((((((uint64_t)(acceleration) * GM_TICK_NS * GM_TICK_NS) << 15) / 1953125u) << 15) / 1953125u)

/* Square of the speed, in 2^-56, that braking over 2^-16 step takes off: 2 gain. */
#define GM_BRAKING_ROOM (GM_GAIN_OF(GM_ACCELERATION) / 128)
#define GM_MOVE_ROOM (GM_GAIN_OF(GM_MOVE_ACCELERATION) / 128)

/* The speed is set every so many ticks, rounded down to the acceleration. */
#define GM_STEER_TICKS 16u

/* Speed of the rule's place, from its motion per millisecond [2^-32 steps]: v += r/2^GM_FAST, r -= r/2^GM_NEAR, where r
 * is by how much the last guess was off. A quick motor needs a quick filter, a slow one a quiet one. In phase, the motion
 * may be off by what the filter is late (GM_LATE_MS) at full acceleration, and by two steps and those of an edge. */
#define GM_QUICK (GM_ACCELERATION > 10000)
#define GM_NEAR (GM_QUICK ? 1 : 2)
#define GM_FAST (GM_QUICK ? 3 : 5)
#define GM_LEAD (GM_QUICK ? 14 : 5) /* at a steady acceleration, v is late by (a - b/2)/(1 - a) r, in sixteenths */
#define GM_LATE_MS (GM_QUICK ? 5 : 10)
#define GM_SLACK_STEPS (2 + (int32_t)((int64_t)GM_ACCELERATION * GM_LATE_MS * GM_LATE_MS / 1000000))
#define GM_STEADY_MS 8u
#define GM_FASTEST_SLOPE ((int64_t)1 << 44)
#define GM_RATE_SCALE ((int64_t)(65536u * 256u / GM_MILLISECOND_TICKS))

/* A table that is so many turns of the hob behind will never be in phase. */
#define GM_HOPELESS_TURNS 64

#define GM_INDEX_QUIET_TICKS (2u * GM_MILLISECOND_TICKS) /* of an index pulse that is none of a burst of noise */
#define GM_ESTOP_TICKS ((uint32_t)GM_ESTOP_MS * GM_MILLISECOND_TICKS)
#define GM_ALARM_TICKS (2u * GM_MILLISECOND_TICKS) /* more on than off */
#define GM_RESET_MS 200u
#define GM_ALIVE_TICKS ((uint32_t)GM_ALIVE_MS * GM_MILLISECOND_TICKS)
#define GM_HEALTHY_TICKS (GM_MILLISECOND_TICKS / 2u)

/* A constant that the arithmetic above cannot hold stops the compiler here. */
typedef char gm_check_tick[GM_TICK_NS >= 500 && GM_TICK_NS <= 5000 && 1000000 % GM_TICK_NS == 0 ? 1 : -1];
typedef char gm_check_pulse[GM_STEP_HIGH_TICKS >= 1 && GM_STEP_LOW_TICKS >= 1 ? 1 : -1];
typedef char gm_check_dir[GM_DIR_SETUP_TICKS >= 1 && GM_DIR_HOLD_TICKS >= 1 ? 1 : -1];
typedef char gm_check_move[GM_MOVE_MAX_RATE >= 1 && GM_MOVE_MAX_RATE <= 1000000 ? 1 : -1];
typedef char gm_check_ramp[GM_MOVE_ACCELERATION >= 1 && GM_MOVE_ACCELERATION <= 10000000 ? 1 : -1];
typedef char gm_check_follow[GM_MAX_STEP_RATE >= 1 ? 1 : -1];
typedef char gm_check_acceleration[GM_ACCELERATION >= 1 && GM_ACCELERATION <= 10000000 ? 1 : -1];
typedef char gm_check_edges[GM_MAX_EDGE_RATE >= 1 && GM_MAX_EDGE_RATE <= 10000000 ? 1 : -1];
typedef char gm_check_lag[GM_MAX_LAG >= 1 && GM_MAX_LAG <= 1000000 ? 1 : -1];
typedef char gm_check_counts[GM_ENCODER_COUNTS >= 1 && GM_ENCODER_COUNTS <= 8000000 ? 1 : -1];
typedef char gm_check_turn[GM_TURN_COUNTS >= 1 && GM_TURN_COUNTS <= 16000000 && GM_TURN_COUNTS_DEN >= 1 ? 1 : -1];
typedef char gm_check_width[sizeof(gm_wide) == (GM_WIDE ? 8 : 4) ? 1 : -1];

/* Levels that stand for off. */
#define GM_OFF \
  ((GM_STEP_ACTIVE_LOW ? (unsigned)GM_OUT_STEP : 0u) | \
   ((GM_DIR_ACTIVE_LOW != 0) != (GM_DIR_INVERT != 0) ? (unsigned)GM_OUT_DIR : 0u) | \
   (GM_ENABLE_ACTIVE_LOW ? (unsigned)GM_OUT_ENABLE : 0u))

static uint32_t magnitude(int32_t value)
{
  return value < 0 ? 0u - (uint32_t)value : (uint32_t)value;
}

static int64_t bounded(int64_t value, int64_t most)
{
  return value > most ? most : value < -most ? -most : value;
}

/* Hob edges as far as differences need them. */
static uint32_t hob_count(const gm_core *core)
{
  return (uint32_t)core->edges[GM_HOB];
}

/* The table no longer follows the rule: the motion within the acceleration goes on from where the table is. */
static void unlock(gm_core *core)
{
  core->locked = 0;
  core->steady = 0;
  core->behind = core->pending;
  core->pending = 0;
  core->progress = 0;
  core->gap = core->pace = 0;
}

static int wrap(gm_core *core);

/* The table leaves the hob and brakes. What it was behind, and what it will turn while it brakes, is kept in `away`. */
static void brake(gm_core *core)
{
  if (core->engaged) {
    if (core->locked) unlock(core);
    core->away = core->behind;
    core->behind = 0;
    core->engaged = 0;
    (void)wrap(core);
  }
  core->behind = 0;
  core->waiting = 0;
  core->braking = 1;
}

static void trip(gm_core *core, gm_fault fault)
{
  const int sound = fault == GM_ESTOP || fault == GM_OVERSPEED;
  if (core->mode == GM_FAULT) return;
  if (core->fault == GM_NO_FAULT || !sound) core->fault = fault;
  core->armed = 0;
  if (sound && core->mode == GM_RUN && (core->engaged || core->braking)) return; /* until the hob stands */
  brake(core);
  core->mode = GM_FAULT;
  if (fault == GM_ALARM) { /* a driver that has given up turns nothing */
    core->speed = core->progress = 0;
    core->pending = 0;
  }
  if (!sound) {
    core->has_job = 0;
    core->job.hysteresis = 0;
    core->play = 0;
  }
}

/* --- the edge ----------------------------------------------------------------------------------------------- */

static void pace(gm_core *core, uint32_t waiting)
{
  uint32_t interval = core->now - core->edge_at;
  core->edge_at = core->now;
  core->gap = 0;
  if (waiting > 1) {
    if (interval > GM_LONGEST_INTERVAL) interval = GM_LONGEST_INTERVAL;
    core->gap = interval / waiting;
  }
  if (core->pace > core->gap) core->pace = core->gap;
}

static int hob_turns(const gm_core *core)
{
  return core->window_travel > GM_STANDING_COUNTS ||
         magnitude((int32_t)(hob_count(core) - core->window_mark)) > GM_STANDING_COUNTS;
}

/* Square of a speed, in 2^-56. */
static int64_t squared(int64_t speed)
{
  const int32_t size = (int32_t)(speed / ((int64_t)1 << 20)); /* below 2^27, as no speed is above half a step per tick */
  return (int64_t)size * size;
}

static void engage(gm_core *core)
{
  core->waiting = 0;
  core->engaged = 1;
  core->was_locked = 0;
  core->steady = 0;
  core->behind = core->away; /* not 0 only where one edge is several steps */
  core->away = 0;
  core->gap = core->pace = 0;
  core->progress = 0;
  if (!hob_turns(core) && squared(core->rate) <= GM_BRAKING_ROOM * 65536) { /* a start from rest is in phase */
    core->locked = core->was_locked = 1;
    core->pending += core->behind;
  }
}

/* Brings away + remainder/denominator into 0 ... one lead; returns whether it was a lead or more. An edge is at most 65
 * steps, so neither loop is long; a lead below one step makes every whole step as good as any other. */
static int wrap(gm_core *core)
{
  int was_more = 0;
  if (core->lead_steps == 0) {
    core->away = 0;
    return 0;
  }
  while (core->away < 0) {
    core->away += core->lead_steps;
    core->remainder += core->lead_rest - core->job.denominator; /* in this order no sum leaves gm_wide */
    if (core->remainder < 0) {
      core->remainder += core->job.denominator;
    } else {
      core->away += 1;
    }
  }
  while (core->away > core->lead_steps ||
         (core->away == core->lead_steps && core->remainder >= core->lead_rest)) {
    core->away -= core->lead_steps;
    core->remainder -= core->lead_rest;
    if (core->remainder < 0) {
      core->remainder += core->job.denominator;
      core->away -= 1;
    }
    was_more = 1;
  }
  return was_more;
}

/* Edges while the table does not follow: whether there is a phase to keep, and the end of a move with a hob that turns. */
static int keeps_phase(gm_core *core)
{
#ifndef GM_PROFILE_LATHE
  if (core->mode == GM_MOVE && magnitude((int32_t)(hob_count(core) - core->move_edges)) > GM_STANDING_COUNTS) {
    trip(core, GM_HOB_MOVED);
  }
#endif
  return core->has_job;
}

/* Steps that the table does not follow: it is further away, and perhaps at the phase to start at. */
static void stand_by(gm_core *core, int32_t steps)
{
  int at_phase;
  core->away += steps;
  if (core->away < 0 && core->waiting) { /* backwards, and past the phase by a few steps */
    engage(core);
    return;
  }
  at_phase = wrap(core) || core->away == 0;
  if (core->waiting && at_phase) engage(core);
}

/* Out of phase: how far the table may be behind, or before the hob. */
static void watch_lag(gm_core *core)
{
  if (magnitude(core->behind) > (core->was_locked ? (uint32_t)GM_MAX_LAG : core->hopeless)) trip(core, GM_LAG);
}

void gm_core_edge(gm_core *core, int axis, int edge)
{
  gm_wide steps;
  uint32_t waiting;
  int32_t passed = edge;
  core->edges[axis] += edge;
  if (axis == GM_HOB) {
    const int32_t bucket = core->bucket + edge * GM_ONE_EDGE;
    if (bucket <= GM_BURST * GM_ONE_EDGE && bucket >= -GM_BURST * GM_ONE_EDGE) {
      core->bucket = bucket;
    } else if (core->has_job) {
      trip(core, GM_OVERSPEED);
    }
    gm_encoder_hysteresis(core->play, edge, core->job.hysteresis, &passed, &core->play);
    if (passed == 0) return;
  }
  if (!core->engaged && !keeps_phase(core)) return;
  gm_gearbox_edge(core->remainder, passed, core->job.increment[axis], core->job.base[axis], core->job.denominator,
                  &steps, &core->remainder);
  core->moved += (int32_t)steps;
  if (!core->engaged) {
    stand_by(core, (int32_t)steps);
    return;
  }
  core->behind += (int32_t)steps;
  if (!core->locked) {
    watch_lag(core);
    return;
  }
  core->pending += (int32_t)steps;
  waiting = magnitude(core->pending);
  if (waiting > GM_MAX_LAG) {
    trip(core, GM_LAG);
  } else if (axis == GM_HOB) {
    pace(core, waiting);
  }
}

/* --- the index pulse ---------------------------------------------------------------------------------------- */

/* Moves a mark by whole turns next to here; returns those turns, and what is left in *rest. */
static int32_t turns_since(uint32_t *mark, uint32_t here, int32_t *rest)
{
  int32_t travel = (int32_t)(here - *mark);
  int32_t half = GM_ENCODER_COUNTS / 2;
  int32_t turns = (travel + (travel < 0 ? -half : half)) / GM_ENCODER_COUNTS;
  *rest = travel - turns * GM_ENCODER_COUNTS;
  *mark += (uint32_t)(turns * GM_ENCODER_COUNTS);
  return turns;
}

static int stray(uint32_t *mark, uint32_t here, int32_t tolerance, int32_t *rest)
{
  (void)turns_since(mark, here, rest);
  return *rest > tolerance || *rest < -tolerance;
}

/* Whether a pulse at this place is the index: near all earlier ones, and where the hob has turned since the last one, very
 * near those on which it came from the same side. */
static int is_index(gm_core *core, uint32_t here, int32_t *turns)
{
  uint32_t mark = core->index_last;
  int32_t rest;
  int side;
  *turns = turns_since(&mark, here, &rest);
  if (stray(&core->index_first, here, GM_INDEX_WIDTH, &rest)) return 0;
  if (*turns == 0) return 1;
  side = *turns > 0;
  return !core->index_side_known[side] || !stray(&core->index_side[side], here, GM_INDEX_TOLERANCE, &rest);
}

void gm_core_index(gm_core *core)
{
  const uint32_t here = hob_count(core);
  if (!GM_HAS_INDEX || !core->has_job) return;
  core->index_alone = core->now - core->index_at > GM_INDEX_QUIET_TICKS;
  core->index_at = core->now;
  core->index_here = here;
  core->index_is_good = 0;
  if (core->index_known && is_index(core, here, &core->index_travel)) {
    core->index_is_good = core->index_good = 1;
    core->index_last = here;
    core->index_turns += magnitude(core->index_travel);
  }
}

static void accuse(gm_core *core, int32_t error)
{
  core->index_error = error;
  trip(core, GM_ENCODER);
}

/* A pulse that has stood alone: the first one is the mark; others show from where it is seen on either side, that the hob
 * does not turn at all, or that edges were lost or invented, if the index did not come where it should have. */
static void judge_index(gm_core *core)
{
  int32_t apart;
  int side;
  if (!core->index_alone || core->now - core->index_at <= GM_INDEX_QUIET_TICKS) return;
  core->index_alone = 0;
  if (!core->index_known) {
    core->index_known = 1;
    core->index_first = core->index_last = core->index_zone = core->index_here;
    return;
  }
  if (!core->index_is_good) {
    (void)stray(&core->index_first, core->index_here, 0, &apart);
    side = core->index_travel > 0;
    if (core->index_side_known[side]) (void)stray(&core->index_side[side], core->index_here, 0, &apart);
    apart = core->index_travel < 0 ? -apart : apart;
    if (!core->index_stray || magnitude(apart) < magnitude(core->index_apart)) core->index_apart = apart;
    core->index_stray = 1;
    if (core->index_missed) accuse(core, core->index_apart);
  } else if (core->index_travel == 0) {
    if (++core->index_visits >= GM_INDEX_VISITS && core->mode == GM_RUN) accuse(core, -GM_ENCODER_COUNTS);
  } else {
    core->index_visits = 0;
    side = core->index_travel > 0;
    if (!core->index_side_known[side]) {
      core->index_side_known[side] = 1;
      core->index_side[side] = core->index_here;
    }
  }
}

/* Once a millisecond: whether the hob has passed the mark from one side to the other, and the index came. */
static void watch_index(gm_core *core)
{
  const int32_t travel = (int32_t)(hob_count(core) - core->index_zone);
  const int32_t turns = travel / GM_ENCODER_COUNTS - (travel % GM_ENCODER_COUNTS < 0);
  const int32_t beyond = travel - turns * GM_ENCODER_COUNTS;
  if (!core->index_known) { /* none has come yet, since the start of the job */
    const uint32_t all = magnitude((int32_t)hob_count(core));
    if (all > (uint32_t)GM_INDEX_MISSING * GM_ENCODER_COUNTS + GM_INDEX_WIDTH) accuse(core, (int32_t)all);
    return;
  }
  if (beyond <= GM_INDEX_WIDTH || beyond >= GM_ENCODER_COUNTS - GM_INDEX_WIDTH) return;
  core->index_zone += (uint32_t)(turns * GM_ENCODER_COUNTS);
  if (turns != 0) {
    core->index_missed = core->index_good ? 0 : core->index_missed + magnitude(turns);
    if (core->index_missed && core->index_stray) {
      accuse(core, core->index_apart);
    } else if (core->index_missed >= GM_INDEX_MISSING) {
      accuse(core, (int32_t)magnitude((int32_t)(hob_count(core) - core->index_last)));
    }
    core->index_stray = 0;
  }
  core->index_good = 0;
}

/* --- the step timer ----------------------------------------------------------------------------------------- */

static void end_window(gm_core *core)
{
  uint32_t here = hob_count(core);
  core->milliseconds = 0;
  core->window_travel = magnitude((int32_t)(here - core->window_mark));
  core->window_mark = here;
  if (core->fault != GM_NO_FAULT && core->mode == GM_RUN && core->engaged && core->window_travel <= GM_STANDING_COUNTS) {
    brake(core); /* a fault that left the drive sound: now the hob stands */
  }
  if (++core->windows == GM_SECOND_WINDOWS) {
    core->windows = 0;
    core->edge_rate = magnitude((int32_t)(here - core->second_mark));
    core->second_mark = here;
  }
}

/* Part of a step that the rule holds, from 0 to 2^32. */
static uint32_t part_of_step(const gm_core *core)
{
  return (uint32_t)(core->remainder >> core->part_shift) * core->part_factor;
}

/* 2^-32 steps per millisecond in the unit of speeds. */
static int64_t scaled(int64_t slope)
{
  return bounded(bounded(slope, GM_FASTEST_SLOPE) * GM_RATE_SCALE / 256, GM_ONE_STEP);
}

/* The speed of the rule's place. */
static void measure(gm_core *core)
{
  const uint32_t part = part_of_step(core);
  const int64_t moved = core->moved * ((int64_t)1 << 32) + ((int64_t)part - (int64_t)core->part);
  core->moved = 0;
  core->part = part;
  core->off += moved - core->slope;
  core->slope = bounded(core->slope + core->off / (1 << GM_FAST), GM_FASTEST_SLOPE);
  core->off -= core->off / (1 << GM_NEAR);
  core->rate = scaled(core->slope + core->off * GM_LEAD / 16);
}

/* 2^-16 steps from the motion within the acceleration to the rule's place. */
static int32_t distance(const gm_core *core)
{
  const int32_t most = 16000, behind = core->behind > most ? most : core->behind < -most ? -most : core->behind;
  int32_t at = behind * 65536 - (int32_t)(core->progress / ((int64_t)1 << 32));
  if (core->engaged) at += (int32_t)(part_of_step(core) >> 16) - core->part_of_whole;
  return at;
}

/* In phase again once it has kept up for some milliseconds. */
static void try_lock(gm_core *core)
{
  const int32_t at = distance(core);
  if (at > 65536 || at < -65536 || squared(scaled(core->slope) - core->speed) > GM_BRAKING_ROOM * 16384) {
    core->steady = 0;
  } else if (++core->steady >= GM_STEADY_MS) {
    core->locked = core->was_locked = 1;
    core->pending += core->behind;
  }
}

/* What every millisecond brings, one thing a tick, so that no tick is long. */
static void end_millisecond(gm_core *core)
{
  switch (core->duties--) {
    case 4:
      if (GM_HAS_INDEX && core->has_job) judge_index(core);
      break;
    case 3:
      if (core->has_job) measure(core);
      break;
    case 2:
      if (core->engaged && !core->locked) try_lock(core);
      break;
    default:
      if (GM_HAS_INDEX && core->has_job) watch_index(core);
  }
}

static void watch_estop(gm_core *core, unsigned inputs)
{
  if (inputs & (unsigned)GM_IN_ESTOP_OK) {
    if (core->estop_open) --core->estop_open;
  } else if (core->estop_open < GM_ESTOP_TICKS && ++core->estop_open == GM_ESTOP_TICKS) {
    trip(core, GM_ESTOP);
    core->estop_open = 2u * GM_ESTOP_TICKS; /* closed as long again before it may be acknowledged */
  }
}

static void watch_alarm(gm_core *core, unsigned inputs)
{
  if (!(inputs & (unsigned)GM_IN_ALARM)) {
    if (core->alarm_on) --core->alarm_on;
  } else if (core->alarm_on < GM_ALARM_TICKS && ++core->alarm_on == GM_ALARM_TICKS) {
    trip(core, GM_ALARM);
  }
}

/* Whether braking must begin to stop before the shoulder: over the way of the present speed, that until the next look, and
 * a step for each rounding. */
static int near_shoulder(const gm_core *core)
{
  const int side = core->shoulder > 0 ? 1 : -1;
  const int64_t follows = core->rate * side, moves = core->speed * side;
  const int64_t speed = follows > moves ? follows : moves;
  int64_t room = (core->shoulder - core->position - core->pending) * side;
  if (speed <= 0) return 0;
  room -= 3 + (int64_t)(3 * GM_STEER_TICKS * speed / GM_ONE_STEP);
  if (room > 16000) return 0;
  return room <= 0 || room * 65536 * GM_BRAKING_ROOM <= squared(speed < GM_FOLLOW_SPEED ? speed : GM_FOLLOW_SPEED);
}

/* Sets the speed of the motion within the acceleration: towards where the rule (or the move) wants it, so that braking
 * with three quarters of the acceleration ends there, at the speed of that place; a move, whose end stands, with nearly
 * all of it. */
static void steer(gm_core *core)
{
  const int64_t gain = GM_GAIN_OF(core->mode == GM_MOVE ? GM_MOVE_ACCELERATION : GM_ACCELERATION) * GM_STEER_TICKS;
  int64_t apart, way;
  int32_t at;
  if (core->braking) {
    core->speed = core->speed > gain ? core->speed - gain : core->speed < -gain ? core->speed + gain : 0;
    return;
  }
  if (!core->engaged && core->mode != GM_MOVE) return;
  at = distance(core);
  if (core->locked && (at > core->slack || at < -core->slack)) {
    unlock(core);
    at = distance(core);
  }
  if (core->engaged && !core->locked) {
    watch_lag(core);
    if (core->braking) return;
  }
  if (core->shoulder != 0 && core->engaged && near_shoulder(core)) {
    core->at_shoulder = 1;
    brake(core);
    return;
  }
  apart = core->mode == GM_MOVE ? -core->speed : core->rate - core->speed;
  way = squared(apart);
  if (core->mode == GM_MOVE && core->behind == 0 && way <= GM_MOVE_ROOM * 131072) { /* there, as slow as a first step */
    core->speed = core->progress = 0;
    return;
  }
  way = at * (core->mode == GM_MOVE ? GM_MOVE_ROOM * 15 / 16 : GM_BRAKING_ROOM * 3 / 4) + (apart < 0 ? -way : way);
  if (way != 0) {
    core->speed = bounded(core->speed + (way > 0 ? gain : -gain), core->mode == GM_MOVE ? GM_MOVE_SPEED : GM_FOLLOW_SPEED);
  }
}

/* A step of that motion; in phase the table has taken it already. */
static void release(gm_core *core, int32_t dir)
{
  if (core->engaged) {
    core->behind -= dir;
    if (!core->locked) core->pending += dir;
    return;
  }
  core->pending += dir;
  if (!core->braking) core->behind -= dir;
  if (core->has_job) {
    core->away -= dir;
    (void)wrap(core);
  }
}

/* One tick of that motion. */
static void glide(gm_core *core)
{
  core->progress += core->speed;
  if (core->progress >= GM_ONE_STEP) {
    core->progress -= GM_ONE_STEP;
    release(core, 1);
  } else if (core->progress <= -GM_ONE_STEP) {
    core->progress += GM_ONE_STEP;
    release(core, -1);
  }
}

/* A stop or a move is over when the motor stands and its last pulse is out. */
static void end_motion(gm_core *core)
{
  if (core->speed != 0) return;
  if (core->braking) {
    core->braking = 0;
    core->progress = 0;
    core->mode = core->fault == GM_NO_FAULT ? GM_IDLE : GM_FAULT;
  } else if (core->mode == GM_MOVE && core->behind == 0) {
    core->mode = GM_IDLE;
  }
}

/* One tick of the pulse: what is on ends in its time; what waits begins when driver and pace allow it. */
static void drive(gm_core *core)
{
  int32_t dir;
  if (core->pace) --core->pace;
  if (core->pulse) {
    if (--core->pulse == 0) {
      core->step_wait = GM_STEP_LOW_TICKS;
      core->dir_wait = GM_DIR_HOLD_TICKS;
    }
    return;
  }
  if (core->step_wait) --core->step_wait;
  if (core->dir_wait) --core->dir_wait;
  if (core->pending == 0) {
    end_motion(core);
    return;
  }
  dir = core->pending > 0 ? 1 : -1;
  if (dir != core->dir) {
    if (core->dir_wait) return;
    core->dir = dir;
    if (core->step_wait < GM_DIR_SETUP_TICKS) core->step_wait = GM_DIR_SETUP_TICKS;
  } else if (core->step_wait == 0 && core->pace == 0) {
    core->pulse = GM_STEP_HIGH_TICKS;
    core->pace = core->gap;
    core->position += dir;
    core->pending -= dir;
  }
}

/* The square wave of the healthy output. */
static void beat(gm_core *core)
{
  if (core->inputs_read < GM_ESTOP_TICKS) ++core->inputs_read;
  if (core->alive) --core->alive;
  if (!core->armed || !core->alive) {
    core->healthy_level = 0;
  } else if (--core->healthy_wait == 0) {
    core->healthy_wait = GM_HEALTHY_TICKS;
    core->healthy_level = !core->healthy_level;
  }
}

unsigned gm_core_outputs(gm_core *core, unsigned inputs)
{
  const int32_t leak = core->engaged ? core->leak : GM_LEAK;
  unsigned levels = GM_OUT_ENABLE;
  ++core->now;
  core->bucket = core->bucket > leak ? core->bucket - leak : core->bucket < -leak ? core->bucket + leak : 0;
  if (GM_HAS_ESTOP) watch_estop(core, inputs);
  if (GM_HAS_ALARM) watch_alarm(core, inputs);
  drive(core);
  beat(core);
  if (core->pulse) levels |= GM_OUT_STEP;
  if (core->dir > 0) levels |= GM_OUT_DIR;
  if (core->healthy_level) levels |= GM_OUT_HEALTHY;
  if (core->reset) {
    --core->reset;
    levels |= GM_OUT_RESET;
  }
  return levels ^ GM_OFF;
}

void gm_core_think(gm_core *core)
{
  if (--core->millisecond_ticks == 0) {
    core->millisecond_ticks = GM_MILLISECOND_TICKS;
    core->duties = 4;
    if (++core->milliseconds == GM_WINDOW_MILLISECONDS) end_window(core);
  }
  if (--core->steer_wait == 0) {
    core->steer_wait = GM_STEER_TICKS;
    steer(core);
  } else if (core->duties) {
    end_millisecond(core);
  }
  glide(core);
}

unsigned gm_core_tick(gm_core *core, unsigned inputs)
{
  const unsigned levels = gm_core_outputs(core, inputs);
  gm_core_think(core);
  return levels;
}

/* --- the main program --------------------------------------------------------------------------------------- */

void gm_core_init(gm_core *core)
{
  memset(core, 0, sizeof *core);
  core->dir = 1;
  core->step_wait = GM_DIR_SETUP_TICKS;
  core->millisecond_ticks = GM_MILLISECOND_TICKS;
  core->steer_wait = GM_STEER_TICKS;
  core->healthy_wait = 1;
  core->leak = GM_LEAK;
}

static int in_range(const gm_job *job)
{
  int axis;
  if (job->denominator < 1 || job->denominator > GM_LARGEST_DENOMINATOR) return 0;
  if (job->hysteresis < 0 || job->hysteresis > GM_LARGEST_HYSTERESIS) return 0;
  if (job->denominator % GM_TURN_COUNTS_DEN != 0 || job->increment[GM_HOB] % GM_TURN_COUNTS_DEN != 0) return 0;
  for (axis = 0; axis < GM_AXES; ++axis) {
    if (job->increment[axis] < 0 || job->increment[axis] >= job->denominator) return 0;
    if (job->base[axis] < -GM_LARGEST_BASE || job->base[axis] > GM_LARGEST_BASE) return 0;
  }
  return job->base[GM_HOB] != 0 || job->increment[GM_HOB] != 0;
}

/* One turn of the hob in steps, |N| counts / D = lead_steps + lead_rest/D, by long multiplication: no sum leaves
 * gm_wide, as 2 D does not. Counts are c/d: D and the rest are multiples of d, and the base gives base c/d steps. */
static void set_lead(gm_core *core)
{
  gm_wide D = core->job.denominator, rest = core->job.increment[GM_HOB];
  int32_t base = core->job.base[GM_HOB], bit;
  if (base < 0) {
    base = -base;
    if (rest > 0) {
      rest = D - rest;
      --base;
    }
  }
  rest /= GM_TURN_COUNTS_DEN;
  core->lead_steps = 0;
  core->lead_rest = 0;
  for (bit = (int32_t)1 << 23; bit; bit >>= 1) {
    int add = (GM_TURN_COUNTS & bit) != 0;
    core->lead_steps *= 2;
    core->lead_rest = core->lead_rest - D + core->lead_rest;
    if (core->lead_rest < 0) {
      core->lead_rest += D;
    } else {
      ++core->lead_steps;
    }
    if (!add) continue;
    core->lead_rest = core->lead_rest - D + rest;
    if (core->lead_rest < 0) {
      core->lead_rest += D;
    } else {
      ++core->lead_steps;
    }
  }
  core->lead_steps += base * GM_TURN_COUNTS / GM_TURN_COUNTS_DEN;
  core->lead_rest -= D - D / GM_TURN_COUNTS_DEN * (base * GM_TURN_COUNTS % GM_TURN_COUNTS_DEN);
  if (core->lead_rest < 0) {
    core->lead_rest += D;
  } else {
    ++core->lead_steps;
  }
}

/* How fast this job may turn the hob, and what its measuring needs. */
static void set_limits(gm_core *core)
{
  /* steps/s over steps per turn are turns/s; the step rate is that of GM_MAX_STEP_RATE, whatever the hob may do */
  const uint64_t steps = (uint64_t)GM_MAX_STEP_RATE * GM_TICK_NS * GM_ONE_EDGE / 1000000u; /* 1/1000 */
  const uint64_t turn = ((uint64_t)core->lead_steps + 1u) * 1000u * GM_TURN_COUNTS_DEN;
  const uint64_t leak = steps * GM_TURN_COUNTS / turn;
  gm_wide whole = core->job.denominator;
  int32_t edge = core->job.base[GM_HOB];
  core->leak = leak < (uint64_t)GM_LEAK ? (int32_t)leak + 1 : GM_LEAK;
  core->part_shift = 0;
  while (whole > 32767) {
    whole >>= 1;
    ++core->part_shift;
  }
  core->part_factor = UINT32_MAX / ((uint32_t)whole + 1u);
  core->slack = (GM_SLACK_STEPS + 1 + (edge < 0 ? -edge : edge)) * 65536;
  core->hopeless = GM_HOPELESS_TURNS * ((uint32_t)core->lead_steps + 1u);
}

int gm_core_set_job(gm_core *core, const gm_job *job)
{
  int side;
  if (core->mode != GM_IDLE || !in_range(job)) return -1;
  core->job = *job;
  core->has_job = 1;
  core->remainder = job->denominator / 2;
  core->play = 0;
  core->away = 0;
  set_lead(core);
  set_limits(core);
  core->moved = 0;
  core->part = part_of_step(core);
  core->part_of_whole = (int32_t)(core->part >> 16);
  core->off = core->slope = core->rate = 0;
  core->window_mark -= hob_count(core); /* the counts begin anew, the hob turns on */
  core->second_mark -= hob_count(core);
  core->edges[GM_HOB] = core->edges[GM_FEED] = 0;
  core->position = core->shoulder = 0;
  core->at_shoulder = 0;
  core->index_known = 0;
  core->index_alone = core->index_good = core->index_stray = 0;
  core->index_at = core->now - GM_INDEX_QUIET_TICKS - 1u;
  core->index_visits = core->index_turns = core->index_missed = 0;
  core->index_error = 0;
  for (side = 0; side < 2; ++side) core->index_side_known[side] = 0;
  return 0;
}

int gm_core_run(gm_core *core)
{
  if (core->mode != GM_IDLE || !core->has_job) return -1;
  core->mode = GM_RUN;
  core->waiting = 1;
  core->at_shoulder = 0;
  core->index_visits = 0;
  core->edge_at = core->now;
  if (core->away == 0) engage(core);
  return 0;
}

void gm_core_set_shoulder(gm_core *core, int64_t place)
{
  core->shoulder = core->has_job ? place : 0;
}

void gm_core_stop(gm_core *core)
{
  if (core->mode != GM_RUN && core->mode != GM_MOVE) return;
  brake(core);
  if (core->pending == 0 && core->pulse == 0) end_motion(core);
}

int gm_core_move(gm_core *core, int32_t steps)
{
  if (core->mode != GM_IDLE) return -1;
#ifndef GM_PROFILE_LATHE
  if (hob_turns(core)) return -1;
#endif
  if (steps == 0) return 0;
  core->mode = GM_MOVE;
  core->behind = steps;
  core->speed = core->progress = 0;
  core->move_edges = hob_count(core);
  core->gap = core->pace = 0;
  return 0;
}

int gm_core_acknowledge(gm_core *core)
{
  if (core->mode != GM_FAULT || core->braking || (GM_HAS_ESTOP && core->estop_open)) return -1;
  if (GM_HAS_ALARM && core->alarm_on) {
    core->reset = GM_RESET_MS * GM_MILLISECOND_TICKS;
    return -1; /* held once more when the driver is ready */
  }
  if (core->fault == GM_OVERSPEED && magnitude(core->bucket) > GM_BURST * GM_ONE_EDGE / 2u) return -1;
  core->mode = GM_IDLE;
  core->fault = GM_NO_FAULT;
  return 0;
}

int gm_core_arm(gm_core *core)
{
  if (core->fault != GM_NO_FAULT || core->inputs_read < GM_ESTOP_TICKS || (GM_HAS_ESTOP && core->estop_open)) return -1;
  core->armed = 1;
  return 0;
}

void gm_core_alive(gm_core *core)
{
  core->alive = GM_ALIVE_TICKS;
}

void gm_core_status(const gm_core *core, gm_status *status)
{
  status->mode = core->mode;
  status->fault = core->fault;
  status->edges[GM_HOB] = core->edges[GM_HOB];
  status->edges[GM_FEED] = core->edges[GM_FEED];
  status->position = core->position;
  status->pending = core->locked ? core->pending : core->pending + core->behind;
  status->edge_rate = core->edge_rate;
  status->index_turns = core->index_turns;
  status->index_error = core->index_error;
  status->waiting = core->waiting;
  status->in_phase = core->engaged && core->locked;
  status->has_job = core->has_job;
  status->armed = core->armed;
  status->dir = core->dir;
  status->shoulder = core->shoulder;
  status->at_shoulder = core->at_shoulder;
}
