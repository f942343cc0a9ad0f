/*
 * From the settings to axis positions and block times, as the planner of gearmath makes them: the same operations in
 * the same order, so that every number is the same bit for bit.
 */
#include <math.h>
#include <stdlib.h>

#include "gearmath.h"
#include "post.h"

static const double pi = 3.141592653589793;
/* Remainder with the sign of the divisor, which is positive. */
static double modulo(double x, double divisor)
{
  double rest = fmod(x, divisor);
  if (rest < 0.0) rest += divisor;
  return rest;
}

/* In eight lanes, and large arrays by halves. */
double pairwise(const double *x, int64_t n)
{
  double lane[8], sum;
  int64_t k;
  int j;
  if (n < 8) {
    for (k = 0, sum = 0.0; k < n; ++k) sum += x[k];
    return sum;
  }
  if (n > 128) {
    int64_t half = n / 2;
    half -= half % 8;
    return pairwise(x, half) + pairwise(x + half, n - half);
  }
  for (j = 0; j < 8; ++j) lane[j] = x[j];
  for (k = 8; k < n - n % 8; k += 8)
    for (j = 0; j < 8; ++j) lane[j] += x[k + j];
  sum = ((lane[0] + lane[1]) + (lane[2] + lane[3])) + ((lane[4] + lane[5]) + (lane[6] + lane[7]));
  for (; k < n; ++k) sum += x[k];
  return sum;
}

void computed(const Job *job, int64_t number, int status, int64_t node, const char *what)
{
  if (status != GM_OK)
    refuse(job, 0, "roll %d: %s at node %d: %s", (int)number, what, (int)node, gm_error_text(status));
}

/* A without jumps of a turn, beginning within half a turn of zero. */
static void unwrap(double *axes, int64_t n)
{
  double correction = 0.0, before = axes[3], turns;
  int64_t k;
  for (k = 1; k < n; ++k) {
    const double now = axes[AXES * k + 3], step = now - before;
    double folded = modulo(step + pi, 2 * pi) - pi;
    if (folded == -pi && step > 0) folded = pi;
    correction += fabs(step) < pi ? 0.0 : folded - step;
    axes[AXES * k + 3] = now + correction;
    before = now;
  }
  turns = 2 * pi * rint(axes[3] / (2 * pi));
  for (k = 0; k < n; ++k) axes[AXES * k + 3] -= turns;
}

void axis_positions(const Job *job, int64_t number, const double *theta, int64_t n, double *axes)
{
  const Roll *roll = job->rolls + number;
  double *moved = NULL;
  int64_t bad;
  int status;
  if (roll->motion_rows) {
    moved = grown(NULL, n * SETTINGS, sizeof *moved);
    status = gm_moved_settings_batch(n, roll->settings, 0, roll->motion, 0, theta, 1, moved, &bad);
    computed(job, number, status, bad, "moving settings (gm_moved_settings.h)");
  }
  status = gm_axis_transform_batch(n, moved ? moved : roll->settings, moved ? SETTINGS : 0, theta, 1, &job->pivot_height,
      0, job->pivot_offset, 0, axes, &bad);
  computed(job, number, status, bad, "axis positions (gm_axis_transform.h)");
  free(moved);
  unwrap(axes, n);
}

/* By what each block takes longer than its clock time, so that no axis accelerates too hard. */
static void slow_down(const Job *job, const double *steps, const double *clock, int64_t n, double *slower)
{
  double *squared = grown(NULL, n + 1, sizeof *squared), *gain = grown(NULL, n, sizeof *gain);
  int64_t k;
  int j;
  squared[0] = squared[n] = 0.0;
  for (k = 0; k < n; ++k) {
    double least = HUGE_VAL, bound = HUGE_VAL;
    for (j = 0; j < AXES; ++j) {
      const double speed = steps[AXES * k + j] / clock[k];
      least = fmin(least, job->acceleration[j] / (2 * fabs(speed)));
      if (k + 1 < n) {
        const double next = steps[AXES * (k + 1) + j] / clock[k + 1];
        const double bend = fabs(next - speed) / ((clock[k + 1] + clock[k]) / 2);
        bound = fmin(bound, job->acceleration[j] / (2 * bend));
      }
    }
    gain[k] = 2 * clock[k] * least;
    if (k + 1 < n) squared[k + 1] = fmin(1.0, bound);
  }
  for (k = 0; k < n; ++k) squared[k + 1] = fmin(squared[k + 1], squared[k] + gain[k]);
  for (k = n; k-- > 0;) squared[k] = fmin(squared[k], squared[k + 1] + gain[k]);
  for (k = 0; k < n; ++k) {
    const double top = fmax(squared[k], squared[k + 1]), low = fmin(squared[k], squared[k + 1]);
    slower[k] = 2.0 * (sqrt(top) - sqrt(low)) / gain[k] + (1.0 - (top - low) / gain[k]) / sqrt(top);
  }
  if (n == 1) { /* faster in its first part, slower in its last, both the same */
    const double top = fmin(1.0, gain[0] / 2);
    slower[0] = 4.0 * sqrt(top) / gain[0] + (1.0 - 2.0 * top / gain[0]) / sqrt(top);
  }
  free(squared);
  free(gain);
}

/* The largest acceleration between blocks, as part of its limit; a standstill before and after. */
static double excess(const Job *job, const double *steps, const double *seconds, int64_t n)
{
  double most = 0.0;
  int64_t k;
  int j;
  for (k = 0; k <= n; ++k) {
    const double before = k > 0 ? seconds[k - 1] : 0.0, after = k < n ? seconds[k] : 0.0;
    for (j = 0; j < AXES; ++j) {
      const double came = k > 0 ? steps[AXES * (k - 1) + j] / before : 0.0;
      const double goes = k < n ? steps[AXES * k + j] / after : 0.0;
      most = fmax(most, fabs((goes - came) / ((after + before) / 2)) / job->acceleration[j]);
    }
  }
  return most;
}

static void times(const Job *job, int64_t number)
{
  Roll *roll = job->rolls + number;
  const int64_t n = roll->nodes - 1;
  double *seen = grown(NULL, 3 * roll->nodes, sizeof *seen), *clock = grown(NULL, n, sizeof *clock);
  double *steps = grown(NULL, AXES * n, sizeof *steps), *slower = grown(NULL, n, sizeof *slower), factor;
  int64_t k, bad;
  int j, status;
  status = gm_seen_from_tool_batch(
      roll->nodes, roll->axes, AXES, roll->tooth, 0, &job->pivot_height, 0, job->pivot_offset, 0, seen, &bad);
  computed(job, number, status, bad, "way past the tooth (gm_seen_from_tool.h)");
  for (k = 0; k < n; ++k) {
    const double *at = seen + 3 * k;
    const double dx = at[3] - at[0], dy = at[4] - at[1], dz = at[5] - at[2];
    double fastest = 0.0;
    for (j = 0; j < AXES; ++j) {
      steps[AXES * k + j] = roll->axes[AXES * (k + 1) + j] - roll->axes[AXES * k + j];
      fastest = fmax(fastest, fabs(steps[AXES * k + j]) / job->speed[j]);
    }
    clock[k] = fmax(fmax(sqrt(dx * dx + dy * dy + dz * dz) * 60.0 / job->feed, fastest), SHORTEST);
  }
  slow_down(job, steps, clock, n, slower);
  for (k = 0; k < n; ++k) roll->seconds[k] = clock[k] * slower[k];
  factor = sqrt(fmax(1.0, excess(job, steps, roll->seconds, n)));
  for (k = 0; k < n; ++k) {
    roll->seconds[k] *= factor;
    if (!(roll->seconds[k] >= SHORTEST && roll->seconds[k] <= LONGEST))
      refuse(job, 0, "roll %d: time = %g s of block %d: must be %g to %g s", (int)number, roll->seconds[k], (int)k, SHORTEST,
          LONGEST);
    if (job->modulo && fabs(steps[AXES * k + 3]) * (180.0 / pi) > 180.0 - 2e-6)
      refuse(job, 0, "roll %d: A turns half a turn or more in block %d", (int)number, (int)k);
  }
  free(seen);
  free(clock);
  free(steps);
  free(slower);
}

/* The whole turns that take a counting A within its travel, nearest to where it stands. */
static double whole_turns(const Job *job, const Roll *roll, const Pass *pass, double now)
{
  const double turn = 2 * pi, low = job->travel[3][0], high = job->travel[3][1];
  double first = roll->axes[3] + pass->angle, least = first, most = first, fewest, greatest;
  int64_t k;
  if (!isfinite(low) || roll->planned) return 0.0; /* a planned one stands there as it is turned */
  for (k = 1; k < roll->nodes; ++k) {
    least = fmin(least, roll->axes[AXES * k + 3] + pass->angle);
    most = fmax(most, roll->axes[AXES * k + 3] + pass->angle);
  }
  fewest = ceil((low - least) / turn - 1e-12);
  greatest = fmax(floor((high - most) / turn + 1e-12), fewest);
  return turn * fmin(fmax(rint((now - first) / turn), fewest), greatest);
}

static void within_travel(const Job *job, int64_t number)
{
  static const double scale[AXES] = {1.0, 1.0, 1.0, 180.0 / 3.141592653589793, 180.0 / 3.141592653589793};
  const Pass *pass = job->passes + number;
  const Roll *roll = job->rolls + pass->roll;
  int64_t k;
  int j;
  for (k = 0; k < roll->nodes; ++k)
    for (j = 0; j < AXES; ++j) {
      double value = roll->axes[AXES * k + j];
      if (j == 2) value += pass->lift;
      if (j == 3) value = value + pass->angle + pass->turns;
      if (value < job->travel[j][0] || value > job->travel[j][1])
        refuse(job, pass->line, "pass %d: axis %c = %.5f %s at node %d: travel is %g to %g", (int)number, "XYZAB"[j],
            value * scale[j], j < 3 ? "mm" : "degrees", (int)k, job->travel[j][0] * scale[j], job->travel[j][1] * scale[j]);
    }
}

void plan_passes(Job *job)
{
  double stands = 0.0;
  int64_t k, node;
  for (k = 0; k < job->roll_count; ++k) {
    Roll *roll = job->rolls + k;
    if (roll->planned) continue;
    roll->axes = grown(NULL, AXES * roll->nodes, sizeof *roll->axes);
    roll->seconds = grown(NULL, roll->nodes, sizeof *roll->seconds);
    if (roll->powers) {
      plan_curves(job, k);
      continue;
    }
    axis_positions(job, k, roll->theta, roll->nodes, roll->axes);
    roll->axes[2] += roll->plunge;
    times(job, k);
  }
  job->up = -HUGE_VAL;
  for (k = 0; k < job->pass_count; ++k) {
    Pass *pass = job->passes + k;
    const Roll *roll = job->rolls + pass->roll;
    pass->turns = whole_turns(job, roll, pass, stands);
    within_travel(job, k);
    stands = roll->axes[AXES * (roll->nodes - 1) + 3] + pass->angle + pass->turns;
    for (node = 0; node < roll->nodes; ++node) job->up = fmax(job->up, roll->axes[AXES * node + 2] + pass->lift);
    job->seconds += pairwise(roll->seconds, roll->nodes - 1) + pass->dwell;
  }
  job->up += job->clearance;
  if (job->up > job->travel[2][1])
    refuse(job, 0, "Z = %.5f mm between the passes: travel is %g to %g", job->up, job->travel[2][0], job->travel[2][1]);
}
