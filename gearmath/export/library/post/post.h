/* post.h: the parts of gm-post. Lengths mm, angles rad, times s. */
#ifndef POST_H
#define POST_H

#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

enum { AXES = 5, SETTINGS = 12, MOTION = 70, MOST_BENDS = 4 };

/*
 * A path of the cutter through tooth space 0: what the settings file says of it, and what comes of that. A planned one
 * stands there as it was planned: positions, times, and where it has them the cutter's axis C, or what bends its blocks.
 */
typedef struct {
  double settings[SETTINGS], motion[MOTION], tooth[3], plunge;
  int motion_rows; /* 0: the settings stand still */
  double *theta;   /* cradle rotation of each node */
  int64_t nodes, room;
  double *axes;    /* X Y Z A B of each node, A counting on */
  double *seconds; /* of the block that ends at each node but the first */
  int planned, turns_cutter, powers; /* powers: coefficients a_2, a_3 .. of each axis in a block, 0 for straight ones */
  double *cutter; /* C of each node */
  double *bends;  /* AXES * powers of each block */
} Roll;

/* One tooth space: a path, raised and turned. turns: whole turns that keep a counting A in its travel. */
typedef struct {
  int64_t roll, line;
  double lift, angle, dwell, turns;
} Pass;

/* A line of the form: kind is one of the letters c n r b s e, or p where a pass begins. */
typedef struct {
  char kind;
  const char *text;
  int64_t line;
} Line;

typedef struct {
  const char *file;
  int edited;
  int decimals[2], modulo, cutter_modulo;
  double length, pivot_height, pivot_offset[3], travel[AXES][2], speed[AXES], acceleration[AXES], feed, clearance;
  Roll *rolls;
  int64_t roll_count;
  Pass *passes;
  int64_t pass_count;
  Line *lines;
  int64_t line_count;
  double up, seconds;
} Job;

/* Ends the program with status 2: one sentence about the settings file. line 0: about all of it. */
void refuse(const Job *job, int64_t line, const char *format, ...)
#if defined(__GNUC__)
    __attribute__((format(printf, 3, 4), noreturn))
#endif
    ;

/* An array of at least count elements, or the end of the program. */
void *grown(void *array, int64_t count, size_t size);

/* Fills the job from the text of a settings file, which is changed and must last as long as the job. */
void read_settings(Job *job, char *text, size_t length);

/* Axes and times of all rolls, the passes within travel, the height between them, and the time in the cut. */
void plan_passes(Job *job);

/* Writes the program of that name. */
void write_program(const Job *job, const char *name, FILE *stream);

#endif
