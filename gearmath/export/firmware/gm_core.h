/* gm_core.h: the electronic gearbox while it runs. Portable: no Arduino, no allocation, no floating point.
 *
 * Three interrupts call it: gm_core_edge for every encoder edge, gm_core_index for the hob's index pulse, and for the
 * step timer, every GM_TICK_NS, gm_core_outputs and gm_core_think. They have the same priority, so that none breaks into
 * another. The main program calls the others with these interrupts masked, which takes a few microseconds. Only
 * gm_core_outputs decides the levels of the output pins.
 *
 * Step pulses. The driver's four times are kept in whole ticks: STEP stays on for GM_STEP_HIGH_TICKS and off for
 * GM_STEP_LOW_TICKS at least; DIR is set GM_DIR_SETUP_TICKS before a pulse begins and kept GM_DIR_HOLD_TICKS after it
 * ends. A pulse that has begun always ends at its full length. DIR is on for positive steps.
 *
 * Pacing. Steps that wait are spread over the time the last edge of the hob took: one every interval/|pending| ticks.
 * At a steady speed they are out just when the next edge comes, evenly; whatever was left over is in the next count of
 * pending, so the spacing corrects itself. A single step (every ratio up to 1) goes out at once.
 *
 * Acceleration. Beside the rule runs a motion whose acceleration never exceeds GM_ACCELERATION: it chases the place that
 * the rule wants, brakes with three quarters of it, and knows the speed of that place from its motion per millisecond.
 * While it keeps up, the table is in phase and takes every step of the rule at once. Where it cannot keep up (the hob
 * starts, stops or is engaged faster than the motor can) the table follows that motion instead, is no longer in phase,
 * and overtakes the missing steps until it is. A stop brakes in the same way; what the hob turns meanwhile is known.
 *
 * Phase. With a job loaded the rule follows every edge also while the table stands, modulo one turn of the hob.
 * gm_core_run starts the table where hob and table are in mesh again: at once if nothing has turned, else when the hob
 * comes to that angle (waiting in gm_status); moves of the table in between are taken into account. So a lathe picks up
 * its thread again, and a gear can be cut in a second pass.
 *
 * Faults. GM_OUT_HEALTHY goes off and stops the hob where it is wired. A fault that leaves the drive sound (GM_ESTOP,
 * GM_OVERSPEED) lets the table follow until the hob stands: the gear is not spoiled, job and phase are kept. After any
 * other fault the table brakes at once, job and phase are lost. GM_OUT_ENABLE stays on in every mode: a table without
 * torque would swing under the hob. What must be without power in an emergency belongs into the emergency stop
 * circuit, not into a program.
 *
 * Healthy. The output is a square wave with half periods of GM_HEALTHY_TICKS, for a stage that a missing edge lets go.
 * It needs the operator's act (gm_core_arm), the inputs read and no fault, and the main program (gm_core_alive) at
 * least every GM_ALIVE_MS: a main program or an interrupt that hangs lets the hob go.
 *
 * Index. While a job is loaded, the index pulse must come after whole numbers of turns: within GM_INDEX_TOLERANCE counts
 * of the earlier pulses on which the hob came from the same side, and within GM_INDEX_WIDTH of all of them, since a pulse
 * begins at its other end when the hob turns back. All earlier pulses count, so that edges lost one at a time are found.
 * Turns are those of the encoder's shaft, GM_ENCODER_COUNTS each, where a belt drives it. A pulse elsewhere is noise as
 * long as the index itself comes: GM_ENCODER needs a mark that was passed without it, and a pulse that stood alone for
 * 2 ms elsewhere, which no burst of noise does. GM_INDEX_VISITS such pulses in a row without a turn while running (an
 * encoder line is broken), or GM_INDEX_MISSING turns without the index (its line is), end in GM_ENCODER as well.
 */
#ifndef GM_CORE_H
#define GM_CORE_H

#include <stdint.h>

#include "gm_machine.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Choices that a machine may make otherwise, in gm_machine.h. */
#ifndef GM_MAX_STEP_RATE /* steps/s: what the driver's pulse and pause allow */
#define GM_MAX_STEP_RATE (1000000000 / ((int64_t)GM_TICK_NS * (GM_STEP_HIGH_TICKS + GM_STEP_LOW_TICKS)))
#endif
#ifndef GM_TURN_COUNTS /* counts per turn of the hob are GM_TURN_COUNTS/GM_TURN_COUNTS_DEN: its encoder may have a belt */
#define GM_TURN_COUNTS GM_ENCODER_COUNTS
#define GM_TURN_COUNTS_DEN 1
#endif
#ifndef GM_ACCELERATION /* steps/s^2 */
#define GM_ACCELERATION GM_MOVE_ACCELERATION
#endif
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
#ifndef GM_ESTOP_MS
#define GM_ESTOP_MS 10 /* the input must be open for so much longer than it is closed */
#endif
#ifndef GM_HAS_ALARM
#define GM_HAS_ALARM 0
#endif
#ifndef GM_ALIVE_MS
#define GM_ALIVE_MS 250 /* the longest silence of the main program; the EEPROM of a Teensy 4 takes less */
#endif

/* Axes of gm_core_edge. */
enum { GM_HOB = 0, GM_FEED = 1, GM_AXES = 2 };

typedef enum {
  GM_IDLE = 0,  /* the table is free of the hob; edges are counted and not followed */
  GM_RUN = 1,   /* the table follows the hob (and the feed), waits for its phase, or brakes */
  GM_MOVE = 2,  /* jog or index: the table moves by a number of steps of its own, with the hob standing */
  GM_FAULT = 3  /* nothing moves until the fault is acknowledged */
} gm_mode;

typedef enum {
  GM_NO_FAULT = 0,
  GM_ESTOP = 1,      /* the emergency stop input is open */
  GM_LAG = 2,        /* more steps wait than GM_MAX_LAG */
  GM_OVERSPEED = 3,  /* edges come faster than the hob may turn */
  GM_ENCODER = 4,    /* a turn of the hob had not GM_ENCODER_COUNTS edges: edges were lost or invented */
  GM_HOB_MOVED = 5,  /* the hob turned during a move of the table */
  GM_ALARM = 6       /* the driver of the motor says that it has a fault */
} gm_fault;

/* One job: the ratio of each axis is base + increment/denominator motor steps per edge, exactly. The denominator, and the
 * hob's increment, are multiples of GM_TURN_COUNTS_DEN, so that a turn of the hob is a whole number of 1/denominator. */
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
  int32_t pending;        /* steps that the table is behind; the lag */
  uint32_t edge_rate;     /* hob edges in the last whole second */
  uint32_t index_turns;   /* turns of the hob that the index pulse has confirmed */
  int32_t index_error;    /* edges too many (+) or too few (-) in the turn that ended in GM_ENCODER */
  int waiting;            /* 1 in GM_RUN until the hob has come to the phase at which the table starts */
  int in_phase;           /* 1 while the table takes every step of the rule at once */
  int has_job;            /* 1 while a job is loaded and its phase known */
  int armed;              /* 1 while the healthy output may be on */
  int dir;                /* of the last step: +1 or -1 */
  int64_t shoulder;       /* 0: none is set */
  int at_shoulder;        /* 1 where the last run has ended at the shoulder */
} gm_status;

typedef struct gm_core gm_core; /* complete below, for static storage; its members are private */

void gm_core_init(gm_core *core);
/* 0, or -1 where the core runs or moves, or the job is out of range. Phase starts anew: a_0 = D/2, counts zero. */
int gm_core_set_job(gm_core *core, const gm_job *job);
int gm_core_run(gm_core *core);                   /* from GM_IDLE with a job; -1 otherwise */
void gm_core_stop(gm_core *core);                 /* brakes, then GM_IDLE; the phase is kept */
/* A shoulder: the table brakes so that it stops before this place (steps since the start of the job) as it follows towards
 * it from the side of the start; 0, which is the start itself, is none. A new job has none. */
void gm_core_set_shoulder(gm_core *core, int64_t place);
int gm_core_move(gm_core *core, int32_t steps);   /* from GM_IDLE, hob standing (not on a lathe): ramped; or -1 */
/* Of a driver's alarm it resets the driver for GM_RESET_MS, too. */
int gm_core_acknowledge(gm_core *core);           /* from GM_FAULT, cause gone and motor at rest: GM_IDLE; or -1 */
int gm_core_arm(gm_core *core);                   /* the operator's act that lets the healthy output go on; or -1 */
void gm_core_alive(gm_core *core);                /* the main program works */
void gm_core_status(const gm_core *core, gm_status *status);

void gm_core_edge(gm_core *core, int axis, int edge); /* edge +1 or -1 */
void gm_core_index(gm_core *core);
/* inputs: GM_IN_ESTOP_OK, GM_IN_ALARM. Returns GM_OUT_* levels as the driver wants them, polarity and inversion applied. */
enum { GM_IN_ESTOP_OK = 1, GM_IN_ALARM = 2 };
enum { GM_OUT_STEP = 1, GM_OUT_DIR = 2, GM_OUT_ENABLE = 4, GM_OUT_HEALTHY = 8, GM_OUT_RESET = 16 };
unsigned gm_core_outputs(gm_core *core, unsigned inputs); /* first, so that the levels are never late */
void gm_core_think(gm_core *core);                        /* after them, in the same interrupt */
unsigned gm_core_tick(gm_core *core, unsigned inputs);    /* both at once, where nobody waits for the levels */

/* Private: the state. */
struct gm_core {
  /* what the interrupt of an edge needs */
  int64_t edges[GM_AXES];
  int64_t position;
  gm_wide remainder;
  int32_t pending;
  int32_t play;
  int32_t bucket;      /* hob edges beyond the highest rate, signed, times 2^16 */
  uint32_t now;        /* ticks, for differences only */
  uint32_t edge_at;    /* now of the last hob edge that was followed */
  uint32_t gap;        /* ticks from step to step, 0: as fast as the driver takes them */
  uint32_t pace;       /* ticks of it that are left */
  int32_t leak;        /* of the bucket: the hob's limit, or that of the steps of this job */
  int engaged;         /* the table follows: GM_RUN, not waiting for the phase, not stopping */
  int locked;          /* ... and takes every step at once */
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
  uint32_t alarm_on;
  uint32_t reset; /* ticks left of the pulse that resets the driver */
  uint32_t inputs_read; /* ticks, up to those of the filter */
  int armed;
  uint32_t alive;
  uint32_t healthy_wait;
  int healthy_level;
  /* phase while not engaged: the table is away + remainder/denominator steps behind, modulo one lead (turn of hob) */
  int waiting;
  int32_t away;
  int32_t lead_steps;
  gm_wide lead_rest;
  /* motion within the acceleration: steps to where the rule (or a move) wants it, speed in 2^-48 steps per tick */
  int32_t behind;
  int64_t speed;
  int64_t progress; /* part of a step, in 2^-48 */
  uint32_t steer_wait;
  uint32_t duties; /* left of this millisecond */
  int braking;
  int64_t shoulder;
  int at_shoulder;
  int was_locked; /* in this run */
  uint32_t steady; /* milliseconds that it has kept up */
  uint32_t hopeless; /* steps behind that are never overtaken */
  int32_t slack;   /* 2^-16 steps that it may be off while in phase */
  /* speed of the place that the rule wants: steps since the last millisecond, part of a step, filter, and the speed */
  int32_t moved;
  uint32_t part;
  int32_t part_of_whole; /* 2^-16: the part where the rule's place is a whole step */
  int64_t off;
  int64_t slope;
  int64_t rate;
  uint32_t part_shift;
  uint32_t part_factor;
  uint32_t move_edges; /* hob edges when a move began */
  /* milliseconds, windows of 100 ms, seconds: how far each is, hob counts at its beginning, and what the last one was */
  uint32_t millisecond_ticks;
  uint32_t milliseconds;
  uint32_t window_mark;
  uint32_t window_travel;
  uint32_t windows;
  uint32_t second_mark;
  uint32_t edge_rate;
  /* index: hob counts at the last good pulse, at the first one, and at the first one of a turn in each direction */
  uint32_t index_last;
  uint32_t index_first;
  uint32_t index_side[2];
  int index_known;
  int index_side_known[2];
  uint32_t index_visits;
  uint32_t index_turns;
  int32_t index_error;
  /* the last pulse: its time and place, turns since the one before, whether it stood alone and was the index; the mark
   * behind the hob, and since it was passed: whether the index came, and a pulse elsewhere; marks passed without it */
  uint32_t index_at;
  uint32_t index_here;
  int32_t index_travel;
  int index_alone;
  int index_is_good;
  uint32_t index_zone;
  int index_good;
  int index_stray;
  int32_t index_apart;
  uint32_t index_missed;
};

#ifdef __cplusplus
}
#endif

#endif
