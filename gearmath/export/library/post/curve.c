/*
 * Polynomial blocks of a roll from its settings: positions and derivatives by the cradle rotation at the nodes, and the
 * times that feed and axes allow; the same operations in the same order as in the planner of gearmath.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "gearmath.h"
#include "post.h"

enum { STEPS = 8, SAMPLES = 64, CUBIC_POWERS = 2, QUINTIC_POWERS = 4, ALL_POWERS = QUINTIC_POWERS + 2 };

/* What lies between samples may be more by this part. */
static const double between_samples = 1.002;
/* Positions at the nodes; A is counted on over parts of the blocks. */
static void at_nodes(const Job *job, int64_t number, double *axes)
{
  const Roll *roll = job->rolls + number;
  const int64_t n = STEPS * (roll->nodes - 1) + 1;
  double *theta = grown(NULL, n, sizeof *theta), *dense = grown(NULL, AXES * n, sizeof *dense);
  int64_t k;
  for (k = 0; k < n - 1; ++k) {
    const double *from = roll->theta + k / STEPS;
    theta[k] = from[0] + (double)(k % STEPS) / STEPS * (from[1] - from[0]);
  }
  theta[n - 1] = roll->theta[roll->nodes - 1];
  axis_positions(job, number, theta, n, dense);
  for (k = 0; k < roll->nodes; ++k) memcpy(axes + AXES * k, dense + AXES * STEPS * k, AXES * sizeof *axes);
  free(theta);
  free(dense);
}

/* The coefficients of the powers from 0 on of one axis in a block between two nodes, of which the slots take a_2 .. */
static void coefficients(const Job *job, int64_t number, int64_t block, int j, const double *axes, const double *slopes,
    const double *bends, double *powers)
{
  const Roll *roll = job->rolls + number;
  const double width = roll->theta[block + 1] - roll->theta[block], *here = axes + AXES * block + j;
  const double v_0 = slopes[AXES * block + j] * width, v_1 = slopes[AXES * (block + 1) + j] * width;
  double sum = 0.0;
  int k, status;
  if (roll->powers == CUBIC_POWERS) {
    status = gm_cubic_block(here[0], here[AXES], v_0, v_1, 1.0, powers + 2);
  } else {
    const double squared = width * width;
    status = gm_quintic_block(here[0], here[AXES], v_0, v_1, bends[AXES * block + j] * squared,
        bends[AXES * (block + 1) + j] * squared, 1.0, powers + 2);
  }
  computed(job, number, status, block, roll->powers == CUBIC_POWERS ? "gm_cubic_block.h" : "gm_quintic_block.h");
  for (k = 0; k < roll->powers; ++k) sum += powers[2 + k];
  powers[0] = here[0];
  powers[1] = here[AXES] - here[0] - sum;
}

/* The time of a block at the constant speed of the path that everything allows. */
static double seconds(const Job *job, int64_t number, int64_t block, double powers[ALL_POWERS][AXES])
{
  const Roll *roll = job->rolls + number;
  const double feed = job->feed / 60.0, *p = powers[0];
  double fraction[SAMPLES + 1], pace[SAMPLES + 1], rate[SAMPLES + 1], way[SAMPLES], slowest = 0.0;
  int64_t bad;
  int k, status;
  for (k = 0; k <= SAMPLES; ++k) fraction[k] = (double)k / SAMPLES;
  if (roll->powers == CUBIC_POWERS)
    status = gm_pace_in_cubic_block_batch(SAMPLES + 1, p, 0, p + AXES, 0, p + 2 * AXES, 0, p + 3 * AXES, 0, fraction, 1,
        roll->tooth, 0, &job->pivot_height, 0, job->pivot_offset, 0, job->speed, 0, job->acceleration, 0, job->jerk, 0,
        &feed, 0, pace, rate, &bad);
  else
    status = gm_pace_in_quintic_block_batch(SAMPLES + 1, p, 0, p + AXES, 0, p + 2 * AXES, 0, p + 3 * AXES, 0,
        p + 4 * AXES, 0, p + 5 * AXES, 0, fraction, 1, roll->tooth, 0, &job->pivot_height, 0, job->pivot_offset, 0,
        job->speed, 0, job->acceleration, 0, job->jerk, 0, &feed, 0, pace, rate, &bad);
  computed(job, number, status, block, roll->powers == CUBIC_POWERS ? "time (gm_pace_in_cubic_block.h)"
      : "time (gm_pace_in_quintic_block.h)");
  for (k = 0; k <= SAMPLES; ++k) slowest = fmax(slowest, pace[k]);
  for (k = 0; k < SAMPLES; ++k) way[k] = (fraction[k + 1] - fraction[k]) * (rate[k + 1] + rate[k]) / 2.0;
  return fmax(pairwise(way, SAMPLES) * (slowest * between_samples), SHORTEST);
}

void plan_curves(Job *job, int64_t number)
{
  Roll *roll = job->rolls + number;
  const int64_t n = roll->nodes;
  double *axes = grown(NULL, AXES * n, sizeof *axes), *slopes = grown(NULL, AXES * n, sizeof *slopes);
  double *bends = grown(NULL, AXES * n, sizeof *bends), powers[ALL_POWERS][AXES], of_axis[ALL_POWERS];
  int64_t block, bad;
  int j, k, status;
  at_nodes(job, number, axes);
  status = gm_axes_by_roll_batch(n, roll->settings, 0, roll->motion, 0, roll->theta, 1, &job->pivot_height, 0,
      job->pivot_offset, 0, slopes, bends, &bad);
  computed(job, number, status, bad, "derivatives of the axis positions (gm_axes_by_roll.h)");
  roll->bends = grown(roll->bends, AXES * roll->powers * (n - 1), sizeof *roll->bends);
  for (block = 0; block < n - 1; ++block) {
    for (j = 0; j < AXES; ++j) {
      coefficients(job, number, block, j, axes, slopes, bends, of_axis);
      for (k = 0; k < roll->powers + 2; ++k) powers[k][j] = of_axis[k];
      memcpy(roll->bends + AXES * roll->powers * block + roll->powers * j, of_axis + 2,
          (size_t)roll->powers * sizeof *of_axis);
    }
    memcpy(roll->axes + AXES * block, powers[0], sizeof powers[0]);
    roll->seconds[block] = seconds(job, number, block, powers);
    if (!(roll->seconds[block] <= LONGEST))
      refuse(job, 0, "roll %d: time = %g s of block %d: must be %g to %g s", (int)number, roll->seconds[block], (int)block,
          SHORTEST, LONGEST);
  }
  for (j = 0; j < AXES; ++j) { /* the last block ends where its coefficients end */
    double end = 0.0;
    for (k = 0; k < roll->powers + 2; ++k) end += powers[k][j];
    roll->axes[AXES * (n - 1) + j] = end;
  }
  free(axes);
  free(slopes);
  free(bends);
}
