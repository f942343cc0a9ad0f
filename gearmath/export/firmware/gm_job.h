/* gm_job.h: from what the operator sets to the ratios of one job, in whole numbers; and the numbers of the blank.
 *
 * The hob's ratio is exact. The lead L of a helix is irrational: 1/L = sin(beta)/(pi m z). Its ratio is rounded so that
 * over GM_HELIX_TRAVEL_MM of feed the table is at most 1/GM_HELIX_PART of a step away from the true helix.
 *
 * With an encoder on the feed (GM_HAS_FEED) the table follows hob and feed, and climb or conventional makes no
 * difference: the encoder sees the direction. Its edges come to the core as +1 in conventional cutting. Without it the
 * feed per turn of the table must be constant; it changes the hob's ratio, and its direction (climb or conventional)
 * the sign of the change.
 */
#ifndef GM_JOB_H
#define GM_JOB_H

#include "gm_core.h"
#include "gm_exact.h"

/* What a machine file need not say. */
#ifndef GM_MOTOR_STEPS_DEN /* steps per turn of the table are GM_MOTOR_STEPS/GM_MOTOR_STEPS_DEN */
#define GM_MOTOR_STEPS_DEN 1
#endif
#ifndef GM_BACKLASH_STEPS /* play between motor and table or carriage, in motor steps */
#define GM_BACKLASH_STEPS 0
#endif
#ifndef GM_HYSTERESIS
#define GM_HYSTERESIS 0
#endif
#ifndef GM_HAS_FEED
#define GM_HAS_FEED 0
#endif
#ifndef GM_HOB_LEFT
#define GM_HOB_LEFT 0
#endif

#ifdef __cplusplus
extern "C" {
#endif

enum { GM_HOBBING = 0, GM_LATHE = 1 };                              /* profile */
/* pitch_kind; worms by module or diametral pitch have a pitch of pi times it, with pi = 355/113: 8.5e-8 of it too long */
enum { GM_PITCH_MM = 0, GM_PITCH_TPI = 1, GM_PITCH_FEED = 2, GM_PITCH_MODULE = 3, GM_PITCH_DP = 4, GM_PITCHES = 5 };
enum { GM_HOB_UNIT = 10000 };
enum { GM_MIN_TEETH = 1, GM_MAX_TEETH = 999, GM_MAX_STARTS = 10, GM_MAX_HELIX = 6000, GM_MAX_PITCH = 99999 };
enum { GM_MAX_FEED = 9999, GM_MAX_BASE = 64 };
enum { GM_HELIX_TRAVEL_MM = 500, GM_HELIX_PART = 100 };

/* The parameters of a job; nothing here is a position. */
typedef struct {
  uint8_t profile;
  uint8_t hob_unit;   /* GM_INCH or GM_MM */
  uint8_t depth_rule; /* GM_DEPTH_... */
  int8_t starts;      /* of hob or thread; negative: a left-hand hob */
  uint8_t left;       /* left-hand helix or thread */
  uint8_t climb;      /* climb cutting */
  uint8_t pitch_kind; /* lathe: GM_PITCH_... */
  uint16_t teeth;
  uint16_t helix;   /* 1/100 degree, 0 for spur gears */
  int32_t hob_size; /* GM_HOB_UNIT x diametral pitch, or x module */
  int32_t pitch;    /* lathe: 1/1000 mm (pitch, feed, module), or 1/100 thread per inch or diametral pitch */
  int32_t feed;     /* helix without feed encoder: 1/1000 mm per turn of the table */
} gm_settings;

typedef enum {
  GM_JOB_OK = 0,
  GM_BAD_PROFILE,
  GM_BAD_TEETH,
  GM_BAD_STARTS,
  GM_BAD_HELIX,
  GM_BAD_HOB,
  GM_BAD_FEED,
  GM_BAD_PITCH,
  GM_TOO_STEEP, /* more than GM_MAX_BASE steps per edge */
  GM_TOO_WIDE,  /* the fraction does not fit the width that the firmware was built with */
  GM_TOO_FAST   /* at the hob's speed limit, more steps per second than the driver takes */
} gm_refusal;

typedef struct {
  gm_ratio ratio;   /* steps per hob edge, signed, in lowest terms */
  uint32_t max_rpm; /* highest whole hob rpm within the limits of hob and driver */
} gm_facts;

/* Ranges only: what may come out of the EEPROM. */
gm_refusal gm_settings_check(const gm_settings *settings);
/* The job, and what the display says about it. Where it is refused, *job is unchanged (facts hold what is known). */
gm_refusal gm_job_make(const gm_settings *settings, gm_job *job, gm_facts *facts);
/* Why, in at most 20 characters. */
const char *gm_refusal_text(gm_refusal refusal);

/* The numbers of the gear, in inch or mm as the hob; 0, or -1 where they do not fit. */
int gm_blank_diameter(const gm_settings *settings, gm_ratio *diameter);
int gm_cut_depth(const gm_settings *settings, gm_ratio *depth);
int gm_helix_lead(const gm_settings *settings, gm_ratio *lead);
const char *gm_depth_text(const gm_settings *settings);
/* Motor steps, to the nearest, of n jogs of 0.01, 0.1, 1 or 10 degrees of the table or mm of the carriage: size 0-3. */
int64_t gm_jog_steps(int size, int32_t n);
/* Motor step of division n, also beyond a turn, to the nearest: of n / divisions turns. */
int64_t gm_division_step(int32_t n, int32_t divisions);
/* Lathe: the shortest move to where the next start of the thread is cut at this position of the spindle. With it, a
 * thread of `ratio` that has come to `edges` and `position` is one pitch on, modulo its lead. 0, or -1. */
int gm_next_start(const gm_settings *settings, const gm_ratio *ratio, int64_t edges, int64_t position, int32_t *move);

#ifdef __cplusplus
}
#endif

#endif
