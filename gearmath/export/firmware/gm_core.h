/* gm_core.h: the electronic gearbox while it runs. Portable: no Arduino, no allocation, no floating point.
 *
 * Three interrupts call it: gm_core_edge for every encoder edge, gm_core_index for the hob's index pulse, gm_core_tick
 * for the step timer, every GM_TICK_NS. The main program calls the others with these interrupts masked, which takes a
 * few microseconds. Only gm_core_tick decides the levels of the output pins.
 */
#ifndef GM_CORE_H
#define GM_CORE_H

#include <stdint.h>

#include "gm_machine.h"

#ifdef __cplusplus
extern "C" {
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
  int64_t position;       /* motor steps delivered since the start of the job, signed */
  int32_t pending;        /* steps that wait; the lag */
  uint32_t edge_rate;     /* hob edges in the last whole second */
  uint32_t index_turns;   /* turns of the hob that the index pulse has confirmed */
  int32_t index_error;    /* edges too many (+) or too few (-) in the turn that ended in GM_ENCODER */
} gm_status;

typedef struct gm_core gm_core; /* complete below, for static storage; its members are private */

void gm_core_init(gm_core *core);
/* 0, or -1 where the core runs or moves, or the job is out of range. Phase starts anew: a_0 = D/2, counts zero. */
int gm_core_set_job(gm_core *core, const gm_job *job);
int gm_core_run(gm_core *core);                   /* from GM_IDLE with a job; -1 otherwise */
void gm_core_stop(gm_core *core);                 /* waiting steps are delivered, then GM_IDLE; the phase is kept */
int gm_core_move(gm_core *core, int32_t steps);   /* from GM_IDLE: ramped move; -1 otherwise */
int gm_core_acknowledge(gm_core *core);           /* from GM_FAULT, cause gone: GM_IDLE, job and phase are lost */
void gm_core_status(const gm_core *core, gm_status *status);

void gm_core_edge(gm_core *core, int axis, int edge); /* edge +1 or -1 */
void gm_core_index(gm_core *core);
/* inputs: GM_IN_ESTOP_OK. Returns GM_OUT_* levels as the driver wants them, polarity and inversion applied. */
enum { GM_IN_ESTOP_OK = 1 };
enum { GM_OUT_STEP = 1, GM_OUT_DIR = 2, GM_OUT_ENABLE = 4, GM_OUT_HEALTHY = 8 };
unsigned gm_core_tick(gm_core *core, unsigned inputs);

/* Private: the state. */
struct gm_core {
  gm_mode mode;
  gm_fault fault;
  gm_job job;
  int has_job;
  gm_wide remainder;
  int32_t play;
  int64_t edges[GM_AXES];
  int64_t position;
  int32_t pending;
  /* the implementer adds what the step timer, the ramp, the rate window and the index check need */
};

#ifdef __cplusplus
}
#endif

#endif
