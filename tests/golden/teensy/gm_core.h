/* gm_core.h: the electronic gearbox while it runs. Portable: no Arduino, no allocation, no floating point.
 *
 * Three interrupts call it: gm_core_edge for every encoder edge, gm_core_index for the hob's index pulse, gm_core_tick
 * for the step timer, every GM_TICK_NS. They have the same priority, so that none breaks into another. The main program
 * calls the others with these interrupts masked, which takes a few microseconds. Only gm_core_tick decides the levels
 * of the output pins.
 *
 * Step pulses. The driver's four times are kept in whole ticks: STEP stays on for GM_STEP_HIGH_TICKS and off for
 * GM_STEP_LOW_TICKS at least; DIR is set GM_DIR_SETUP_TICKS before a pulse begins and kept GM_DIR_HOLD_TICKS after it
 * ends. A pulse that has begun always ends at its full length. DIR is on for positive steps.
 *
 * Pacing. Steps that wait are spread over the time the last edge of the hob took: one every interval/|pending| ticks.
 * At a steady speed they are out just when the next edge comes, evenly; whatever was left over is in the next count of
 * pending, so the spacing corrects itself. A single step (every ratio up to 1) goes out at once.
 *
 * Phase. With a job loaded the rule follows every edge also while the table stands, modulo one turn of the hob.
 * gm_core_run starts the table where hob and table are in mesh again: at once if nothing has turned, else when the hob
 * comes to that angle (waiting in gm_status); moves of the table in between are taken into account. So a lathe picks up
 * its thread again, and a gear can be cut in a second pass.
 *
 * Faults. The table stands still at the end of the pulse under way, job and phase are lost, GM_OUT_HEALTHY goes off and
 * stops the hob where it is wired. GM_OUT_ENABLE stays on in every mode: a table without torque would swing under the
 * hob. What must be without power in an emergency belongs into the emergency stop circuit, not into a program.
 *
 * Index. While a job is loaded, an index pulse must find a whole number of turns since earlier pulses: within
 * GM_INDEX_TOLERANCE counts of the earlier pulses on which the hob came from the same side, and within GM_INDEX_WIDTH
 * of all of them, since a pulse begins at its other end when the hob turns back. All earlier pulses count, so that
 * edges lost one at a time are found. GM_INDEX_VISITS pulses in a row without a turn while running (an encoder line is
 * broken), or GM_INDEX_MISSING turns without a pulse (the index line is), end in GM_ENCODER as well.
 */
#ifndef GM_CORE_H
#define GM_CORE_H

#include <stdint.h>

#include "gm_machine.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Choices that a machine may make otherwise, in gm_machine.h. */
#ifndef GM_INDEX_TOLERANCE
#define GM_INDEX_TOLERANCE 2 /* counts: an edge and the index pulse may come in either order, in both pulses */
#endif
#ifndef GM_INDEX_WIDTH
#define GM_INDEX_WIDTH 8 /* counts: an ungated index pulse lasts up to 1.5 encoder lines, 6 counts, and the above */
#endif
#ifndef GM_INDEX_VISITS
#define GM_INDEX_VISITS 8
#endif
#ifndef GM_INDEX_MISSING
#define GM_INDEX_MISSING 4 /* turns */
#endif
#ifndef GM_STANDING_COUNTS
#define GM_STANDING_COUNTS 8 /* a hob that moves no further stands */
#endif
#ifndef GM_ESTOP_TICKS
#define GM_ESTOP_TICKS 4 /* the input must be open for so many ticks in a row */
#endif

/* Axes of gm_core_edge. */
enum { GM_HOB = 0, GM_FEED = 1, GM_AXES = 2 };

typedef enum {
  GM_IDLE = 0,  /* the table is free of the hob; edges are counted and not followed */
  GM_RUN = 1,   /* the table follows the hob (and the feed) */
  GM_MOVE = 2,  /* jog or index: the table moves by a number of steps of its own, with the hob standing */
  GM_FAULT = 3  /* nothing moves until the fault is acknowledged */
} gm_mode;

typedef enum {
  GM_NO_FAULT = 0,
  GM_ESTOP = 1,      /* the emergency stop input is open */
  GM_LAG = 2,        /* more steps wait than GM_MAX_LAG */
  GM_OVERSPEED = 3,  /* edges come faster than the hob may turn */
  GM_ENCODER = 4,    /* a turn of the hob had not GM_ENCODER_COUNTS edges: edges were lost or invented */
  GM_HOB_MOVED = 5   /* the hob turned during a move of the table */
} gm_fault;

/* One job: the ratio of each axis is base + increment/denominator motor steps per edge, exactly. */
typedef struct {
  gm_wide denominator;
  gm_wide increment[GM_AXES];
  int32_t base[GM_AXES];
  int32_t hysteresis; /* counts of play of the hob encoder */
} gm_job;

/* What the display shows; a copy made with interrupts masked. */
typedef struct {
  gm_mode mode;
  gm_fault fault;
  int64_t edges[GM_AXES]; /* signed, since the start of the job */
  int64_t position;       /* motor steps delivered since the start of the job, moves included, signed */
  int32_t pending;        /* steps that wait; the lag */
  uint32_t edge_rate;     /* hob edges in the last whole second */
  uint32_t index_turns;   /* turns of the hob that the index pulse has confirmed */
  int32_t index_error;    /* edges too many (+) or too few (-) in the turn that ended in GM_ENCODER */
  int waiting;            /* 1 in GM_RUN until the hob has come to the phase at which the table starts */
} gm_status;

typedef struct gm_core gm_core; /* complete below, for static storage; its members are private */

void gm_core_init(gm_core *core);
/* 0, or -1 where the core runs or moves, or the job is out of range. Phase starts anew: a_0 = D/2, counts zero. */
int gm_core_set_job(gm_core *core, const gm_job *job);
int gm_core_run(gm_core *core);                   /* from GM_IDLE with a job; -1 otherwise */
void gm_core_stop(gm_core *core);                 /* waiting steps are delivered, then GM_IDLE; the phase is kept */
int gm_core_move(gm_core *core, int32_t steps);   /* from GM_IDLE, hob standing (not on a lathe): ramped; or -1 */
int gm_core_acknowledge(gm_core *core);           /* from GM_FAULT, cause gone: GM_IDLE; job and phase are lost */
void gm_core_status(const gm_core *core, gm_status *status);

void gm_core_edge(gm_core *core, int axis, int edge); /* edge +1 or -1 */
void gm_core_index(gm_core *core);
/* inputs: GM_IN_ESTOP_OK. Returns GM_OUT_* levels as the driver wants them, polarity and inversion applied. */
enum { GM_IN_ESTOP_OK = 1 };
enum { GM_OUT_STEP = 1, GM_OUT_DIR = 2, GM_OUT_ENABLE = 4, GM_OUT_HEALTHY = 8 };
unsigned gm_core_tick(gm_core *core, unsigned inputs);

/* Private: the state. */
struct gm_core {
  /* what the interrupt of an edge needs */
  int64_t edges[GM_AXES];
  int64_t position;
  gm_wide remainder;
  int32_t pending;
  int32_t play;
  uint32_t bucket;     /* hob edges beyond the highest rate, times 2^16 */
  uint32_t now;        /* ticks, for differences only */
  uint32_t edge_at;    /* now of the last hob edge that was followed */
  uint32_t gap;        /* ticks from step to step, 0: as fast as the driver takes them */
  uint32_t pace;       /* ticks of it that are left */
  int engaged;         /* the table follows: GM_RUN, not waiting for the phase, not stopping */
  int has_job;
  gm_job job;
  gm_mode mode;
  gm_fault fault;
  /* step timer: ticks left of the pulse, before the next pulse, before DIR may change */
  uint32_t pulse;
  uint32_t step_wait;
  uint32_t dir_wait;
  int32_t dir; /* +1 or -1 */
  uint32_t estop_open;
  /* phase while not engaged: the table is away + remainder/denominator steps behind, modulo one lead (turn of hob) */
  int waiting;
  int32_t away;
  int32_t lead_steps;
  gm_wide lead_rest;
  /* move: steps left, direction, steps taken while the speed rose, and speeds in 2^-48 steps per tick */
  uint32_t move_left;
  uint32_t move_ramp;
  int32_t move_dir;
  uint64_t speed;
  uint64_t first_speed;
  uint64_t progress;
  uint32_t move_edges; /* hob edges when it began */
  /* milliseconds, windows of 100 ms, seconds: how far each is, hob counts at its beginning, and what the last one was */
  uint32_t millisecond_ticks;
  uint32_t milliseconds;
  uint32_t window_mark;
  uint32_t window_travel;
  uint32_t windows;
  uint32_t second_mark;
  uint32_t edge_rate;
  /* index: hob counts at the last pulse, at the first one, and at the first one of a turn in each direction */
  uint32_t index_last;
  uint32_t index_first;
  uint32_t index_side[2];
  int index_known;
  int index_side_known[2];
  uint32_t index_visits;
  uint32_t index_turns;
  int32_t index_error;
};

#ifdef __cplusplus
}
#endif

#endif
