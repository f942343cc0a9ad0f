/* post.h: the parts of gm-post. Lengths mm, angles rad, times s. */
#ifndef POST_H
#define POST_H

#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

enum { AXES = 5, SETTINGS = 12, MOTION = 70, MOST_BENDS = 4 };

/* No block takes less or more. [s] */
#define SHORTEST 1e-4
#define LONGEST 1e5

/*
 * A path of the cutter through tooth space 0: what the settings file says of it, and what comes of that. A planned one,
 * of a hobbed member, stands there as it was planned: positions, the cutter's axis C with them, coefficients and times.
 */
typedef struct {
  double settings[SETTINGS], motion[MOTION], tooth[3], plunge;
  int motion_rows; /* 0: the settings stand still */
  int powers;      /* coefficients a_2, a_3 .. of each axis in a block, 0 for straight ones */
  int planned;
  double *theta; /* cradle rotation of each node */
  int64_t nodes, room;
  double *axes;    /* X Y Z A B of each node, A counting on */
  double *seconds; /* of the block that ends at each node but the first */
  double *bends;   /* powers of each axis in each block, of a planned one those of C too */
  double *cutter;  /* C of each node of a planned one */
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
  double length, pivot_height, pivot_offset[3], travel[AXES][2], speed[AXES], acceleration[AXES], jerk[AXES];
  double feed, clearance;
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

/* X Y Z A B at n cradle rotations along a roll, A counting on. */
void axis_positions(const Job *job, int64_t number, const double *theta, int64_t n, double *axes);

/* Axes, coefficients and times of a roll of polynomials. */
void plan_curves(Job *job, int64_t number);

/* Ends the program where a function of the library had no result. */
void computed(const Job *job, int64_t number, int status, int64_t node, const char *what);

/* Sum as NumPy adds. */
double pairwise(const double *x, int64_t n);

/* Axes and times of all rolls, the passes within travel, the height between them, and the time in the cut. */
void plan_passes(Job *job);

/* Writes the program of that name. */
void write_program(const Job *job, const char *name, FILE *stream);

#endif
