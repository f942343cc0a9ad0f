/* gm_core.c: see gm_core.h. The step rule and the hysteresis are generated kernels; what is here is their calling. */
#include "gm_core.h"

#include <string.h>

#include "gm_encoder_hysteresis.h"
#include "gm_gearbox_edge.h"

/* The range in which the kernels are proved. */
#define GM_LARGEST_DENOMINATOR ((gm_wide)1 << (GM_WIDE ? 62 : 30))
#define GM_LARGEST_BASE 64
#define GM_LARGEST_HYSTERESIS 16

/* Overspeed: every edge adds one to a bucket that runs out at GM_MAX_EDGE_RATE and 1 %. It trips when GM_BURST edges
 * too many are in it, so that at any speed GM_OVERSPEED comes before GM_LAG where GM_BURST N/D < GM_MAX_LAG. */
#define GM_BURST 24u
#define GM_ONE_EDGE 65536u
#define GM_LEAK ((uint32_t)((uint64_t)GM_MAX_EDGE_RATE * 101u * GM_TICK_NS * GM_ONE_EDGE / 100000000000u + 1u))

/* Milliseconds, windows of 100 ms, and the second of edge_rate. */
#define GM_MILLISECOND_TICKS (1000000u / GM_TICK_NS)
#define GM_WINDOW_MILLISECONDS 100u
#define GM_SECOND_WINDOWS 10u

/* Steps of a hob that is turned by hand are not spread over more than 20 ms. */
#define GM_LONGEST_INTERVAL (20u * GM_MILLISECOND_TICKS)

/* Moves: speed in 2^-48 steps per tick; 10^9 = 2^9 5^9 and 5^9 = 1953125. The top is what the driver takes. */
#define GM_ONE_STEP ((uint64_t)1 << 48)
#define GM_SPEED_WANTED (((((uint64_t)GM_MOVE_MAX_RATE * GM_TICK_NS) << 20) / 1953125u) << 19)
#define GM_SPEED_POSSIBLE (GM_ONE_STEP / (GM_STEP_HIGH_TICKS + GM_STEP_LOW_TICKS))
#define GM_TOP_SPEED (GM_SPEED_WANTED < GM_SPEED_POSSIBLE ? GM_SPEED_WANTED : GM_SPEED_POSSIBLE)
#define GM_SPEED_GAIN_EXACT \
  ((((((uint64_t)GM_MOVE_ACCELERATION * GM_TICK_NS * GM_TICK_NS) << 15) / 1953125u) << 15) / 1953125u)
#define GM_SPEED_GAIN (GM_SPEED_GAIN_EXACT ? GM_SPEED_GAIN_EXACT : 1u)

/* A constant that the arithmetic above cannot hold stops the compiler here. */
typedef char gm_check_tick[GM_TICK_NS >= 500 && GM_TICK_NS <= 5000 && 1000000 % GM_TICK_NS == 0 ? 1 : -1];
typedef char gm_check_pulse[GM_STEP_HIGH_TICKS >= 1 && GM_STEP_LOW_TICKS >= 1 ? 1 : -1];
typedef char gm_check_dir[GM_DIR_SETUP_TICKS >= 1 && GM_DIR_HOLD_TICKS >= 1 ? 1 : -1];
typedef char gm_check_move[GM_MOVE_MAX_RATE >= 1 && GM_MOVE_MAX_RATE <= 1000000 ? 1 : -1];
typedef char gm_check_ramp[GM_MOVE_ACCELERATION >= 1 && GM_MOVE_ACCELERATION <= 10000000 ? 1 : -1];
typedef char gm_check_edges[GM_MAX_EDGE_RATE >= 1 && GM_MAX_EDGE_RATE <= 10000000 ? 1 : -1];
typedef char gm_check_lag[GM_MAX_LAG >= 1 && GM_MAX_LAG <= 1000000 ? 1 : -1];
typedef char gm_check_counts[GM_ENCODER_COUNTS >= 1 && GM_ENCODER_COUNTS <= 8000000 ? 1 : -1];
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

/* Hob edges as far as differences need them. */
static uint32_t hob_count(const gm_core *core)
{
  return (uint32_t)core->edges[GM_HOB];
}

static void trip(gm_core *core, gm_fault fault)
{
  if (core->mode == GM_FAULT) return;
  core->mode = GM_FAULT;
  core->fault = fault;
  core->pending = 0;
  core->engaged = 0;
  core->waiting = 0;
  core->has_job = 0;
  core->job.hysteresis = 0;
  core->play = 0;
  core->move_left = 0;
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

static void engage(gm_core *core)
{
  core->waiting = 0;
  core->engaged = 1;
  core->pending = core->away; /* not 0 only where one edge is several steps */
  core->away = 0;
  core->gap = 0;
  core->pace = 0;
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

void gm_core_edge(gm_core *core, int axis, int edge)
{
  gm_wide steps;
  uint32_t waiting;
  int32_t passed = edge;
  core->edges[axis] += edge;
  if (axis == GM_HOB) {
    if (core->bucket < GM_BURST * GM_ONE_EDGE) {
      core->bucket += GM_ONE_EDGE;
    } else if (core->has_job) {
      trip(core, GM_OVERSPEED);
    }
    gm_encoder_hysteresis(core->play, edge, core->job.hysteresis, &passed, &core->play);
    if (passed == 0) return;
  }
  if (!core->engaged && !keeps_phase(core)) return;
  gm_gearbox_edge(core->remainder, passed, core->job.increment[axis], core->job.base[axis], core->job.denominator,
                  &steps, &core->remainder);
  if (!core->engaged) {
    stand_by(core, (int32_t)steps);
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

void gm_core_index(gm_core *core)
{
  uint32_t here = hob_count(core);
  int32_t turns, rest, error = 0;
  int side, wrong;
  if (!GM_HAS_INDEX || !core->has_job) return;
  if (!core->index_known) {
    core->index_known = 1;
    core->index_first = core->index_last = here;
    return;
  }
  turns = turns_since(&core->index_last, here, &rest);
  core->index_last = here;
  wrong = stray(&core->index_first, here, GM_INDEX_WIDTH, &error);
  if (turns == 0) {
    ++core->index_visits;
    if (core->mode == GM_RUN && core->index_visits >= GM_INDEX_VISITS) {
      wrong = 1;
      error = -GM_ENCODER_COUNTS;
    }
  } else {
    core->index_visits = 0;
    for (side = 0; side < 2; ++side) {
      int32_t apart = 0;
      int off = stray(&core->index_side[side], here, GM_INDEX_TOLERANCE, &apart);
      if (side != (turns > 0)) continue; /* the mark of the other side only kept near */
      if (!core->index_side_known[side]) {
        core->index_side_known[side] = 1;
        core->index_side[side] = here;
      } else if (off) {
        wrong = 1;
        error = apart;
      }
    }
    if (turns < 0) error = -error;
    if (!wrong) core->index_turns += magnitude(turns);
  }
  if (wrong) {
    core->index_error = error;
    trip(core, GM_ENCODER);
  }
}

/* --- the step timer ----------------------------------------------------------------------------------------- */

static void end_window(gm_core *core)
{
  uint32_t here = hob_count(core);
  core->milliseconds = 0;
  core->window_travel = magnitude((int32_t)(here - core->window_mark));
  core->window_mark = here;
  if (++core->windows == GM_SECOND_WINDOWS) {
    core->windows = 0;
    core->edge_rate = magnitude((int32_t)(here - core->second_mark));
    core->second_mark = here;
  }
}

static void end_millisecond(gm_core *core)
{
  core->millisecond_ticks = GM_MILLISECOND_TICKS;
  if (++core->milliseconds == GM_WINDOW_MILLISECONDS) end_window(core);
  if (GM_HAS_INDEX && core->has_job) {
    uint32_t travel = magnitude((int32_t)(hob_count(core) - core->index_last));
    if (travel > (uint32_t)GM_INDEX_MISSING * GM_ENCODER_COUNTS + GM_INDEX_WIDTH) {
      core->index_error = (int32_t)travel;
      trip(core, GM_ENCODER);
    }
  }
}

static void watch_estop(gm_core *core, unsigned inputs)
{
  if (inputs & (unsigned)GM_IN_ESTOP_OK) {
    core->estop_open = 0;
  } else if (core->estop_open < GM_ESTOP_TICKS && ++core->estop_open == GM_ESTOP_TICKS) {
    trip(core, GM_ESTOP);
  }
}

/* One tick of a move. The speed falls over as many steps as it rose. */
static void ramp(gm_core *core)
{
  int rising = 0;
  if (core->move_left == 0) return;
  if (core->move_left > core->move_ramp) {
    rising = core->speed < GM_TOP_SPEED;
    if (rising) core->speed += GM_SPEED_GAIN;
    if (core->speed > GM_TOP_SPEED) core->speed = GM_TOP_SPEED;
  } else if (core->speed > core->first_speed + GM_SPEED_GAIN) {
    core->speed -= GM_SPEED_GAIN;
  }
  core->progress += core->speed;
  if (core->progress < GM_ONE_STEP) return;
  core->progress -= GM_ONE_STEP;
  if (core->first_speed == 0) core->first_speed = core->speed;
  if (rising) ++core->move_ramp;
  --core->move_left;
  core->pending += core->move_dir;
  if (core->has_job) {
    core->away -= core->move_dir;
    (void)wrap(core);
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
    /* a stop or a move is over when the last pulse is */
    if ((core->mode == GM_RUN && !core->engaged && !core->waiting) || (core->mode == GM_MOVE && !core->move_left)) {
      core->mode = GM_IDLE;
    }
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

unsigned gm_core_tick(gm_core *core, unsigned inputs)
{
  unsigned levels = GM_OUT_ENABLE;
  ++core->now;
  core->bucket = core->bucket > GM_LEAK ? core->bucket - GM_LEAK : 0;
  if (--core->millisecond_ticks == 0) end_millisecond(core);
  if (GM_HAS_ESTOP) watch_estop(core, inputs);
  if (core->mode == GM_MOVE) ramp(core);
  drive(core);
  if (core->pulse) levels |= GM_OUT_STEP;
  if (core->dir > 0) levels |= GM_OUT_DIR;
  if (core->mode != GM_FAULT) levels |= GM_OUT_HEALTHY;
  return levels ^ GM_OFF;
}

/* --- the main program --------------------------------------------------------------------------------------- */

void gm_core_init(gm_core *core)
{
  memset(core, 0, sizeof *core);
  core->dir = 1;
  core->step_wait = GM_DIR_SETUP_TICKS;
  core->millisecond_ticks = GM_MILLISECOND_TICKS;
}

static int in_range(const gm_job *job)
{
  int axis;
  if (job->denominator < 1 || job->denominator > GM_LARGEST_DENOMINATOR) return 0;
  if (job->hysteresis < 0 || job->hysteresis > GM_LARGEST_HYSTERESIS) return 0;
  for (axis = 0; axis < GM_AXES; ++axis) {
    if (job->increment[axis] < 0 || job->increment[axis] >= job->denominator) return 0;
    if (job->base[axis] < -GM_LARGEST_BASE || job->base[axis] > GM_LARGEST_BASE) return 0;
  }
  return job->base[GM_HOB] != 0 || job->increment[GM_HOB] != 0;
}

/* One turn of the hob in steps, |N| counts / D = lead_steps + lead_rest/D, by long multiplication: no sum leaves
 * gm_wide, as 2 D does not. */
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
  core->lead_steps = 0;
  core->lead_rest = 0;
  for (bit = (int32_t)1 << 23; bit; bit >>= 1) {
    int add = (GM_ENCODER_COUNTS & bit) != 0;
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
  core->lead_steps += base * GM_ENCODER_COUNTS;
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
  core->edges[GM_HOB] = core->edges[GM_FEED] = 0;
  core->position = 0;
  core->window_mark = core->second_mark = 0;
  core->index_known = 0;
  core->index_last = 0;
  core->index_visits = core->index_turns = 0;
  core->index_error = 0;
  for (side = 0; side < 2; ++side) core->index_side_known[side] = 0;
  return 0;
}

int gm_core_run(gm_core *core)
{
  if (core->mode != GM_IDLE || !core->has_job) return -1;
  core->mode = GM_RUN;
  core->waiting = 1;
  core->index_visits = 0;
  core->edge_at = core->now;
  if (core->away == 0) engage(core);
  return 0;
}

void gm_core_stop(gm_core *core)
{
  core->engaged = 0;
  core->waiting = 0;
  if (core->move_left > core->move_ramp) core->move_left = core->move_ramp;
  if (core->mode == GM_RUN && core->pending == 0 && core->pulse == 0) core->mode = GM_IDLE;
}

int gm_core_move(gm_core *core, int32_t steps)
{
  if (core->mode != GM_IDLE) return -1;
#ifndef GM_PROFILE_LATHE
  if (core->window_travel > GM_STANDING_COUNTS ||
      magnitude((int32_t)(hob_count(core) - core->window_mark)) > GM_STANDING_COUNTS) {
    return -1;
  }
#endif
  if (steps == 0) return 0;
  core->mode = GM_MOVE;
  core->move_left = magnitude(steps);
  core->move_dir = steps > 0 ? 1 : -1;
  core->move_ramp = 0;
  core->speed = core->first_speed = core->progress = 0;
  core->move_edges = hob_count(core);
  core->gap = core->pace = 0;
  return 0;
}

int gm_core_acknowledge(gm_core *core)
{
  if (core->mode != GM_FAULT || (GM_HAS_ESTOP && core->estop_open)) return -1;
  if (core->fault == GM_OVERSPEED && core->bucket > GM_BURST * GM_ONE_EDGE / 2) return -1;
  core->mode = GM_IDLE;
  core->fault = GM_NO_FAULT;
  return 0;
}

void gm_core_status(const gm_core *core, gm_status *status)
{
  status->mode = core->mode;
  status->fault = core->fault;
  status->edges[GM_HOB] = core->edges[GM_HOB];
  status->edges[GM_FEED] = core->edges[GM_FEED];
  status->position = core->position;
  status->pending = core->pending;
  status->edge_rate = core->edge_rate;
  status->index_turns = core->index_turns;
  status->index_error = core->index_error;
  status->waiting = core->waiting;
}
