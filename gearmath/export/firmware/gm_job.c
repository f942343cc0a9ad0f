/* gm_job.c: the ratios of one job. Every product is checked; nothing is computed in floating point. */
#include "gm_job.h"

#ifdef GM_PROFILE_LATHE
enum { GM_PROFILE = GM_LATHE };
#else
enum { GM_PROFILE = GM_HOBBING };
#define GM_SCREW_STEPS_NUM 1
#define GM_SCREW_STEPS_DEN 1
#endif
#if !GM_HAS_FEED
#undef GM_FEED_COUNTS_NUM
#undef GM_FEED_COUNTS_DEN
#define GM_FEED_COUNTS_NUM 1
#define GM_FEED_COUNTS_DEN 1
#endif

#if GM_WIDE
#define GM_WIDEST ((uint64_t)1 << 62)
#else
#define GM_WIDEST ((uint64_t)1 << 30)
#endif

enum { GM_POINT = 57 }; /* binary places of the ratio of the feed: 6 bits remain for GM_MAX_BASE */

gm_refusal gm_settings_check(const gm_settings *settings) {
  const int starts = settings->starts < 0 ? -settings->starts : settings->starts;
  if (settings->profile != GM_PROFILE) {
    return GM_BAD_PROFILE;
  }
  if (starts < 1 || starts > GM_MAX_STARTS || settings->left > 1) {
    return GM_BAD_STARTS;
  }
  if (settings->profile == GM_LATHE) {
    if (settings->starts < 1) {
      return GM_BAD_STARTS;
    }
    return settings->pitch < 1 || settings->pitch > GM_MAX_PITCH || settings->pitch_kind >= GM_PITCHES ? GM_BAD_PITCH
                                                                                                          : GM_JOB_OK;
  }
  if (settings->teeth < 1 || settings->teeth > GM_MAX_TEETH) {
    return GM_BAD_TEETH;
  }
  if (settings->helix > GM_MAX_HELIX) {
    return GM_BAD_HELIX;
  }
  if (settings->hob_size < 1 || settings->hob_size > 1000 * GM_HOB_UNIT || settings->hob_unit > GM_MM ||
      settings->depth_rule > GM_DEPTH_225_M ||
      (settings->hob_unit == GM_MM) != (settings->depth_rule == GM_DEPTH_225_M)) {
    return GM_BAD_HOB;
  }
  return settings->feed < 1 || settings->feed > GM_MAX_FEED || settings->climb > 1 ? GM_BAD_FEED : GM_JOB_OK;
}

/* Motor steps per hob edge of a spur gear or a thread. */
static int gm_leading_ratio(const gm_settings *settings, gm_ratio *ratio) {
  ratio->numerator = settings->starts;
  ratio->denominator = 1;
  if (settings->profile == GM_HOBBING) {
    return gm_ratio_times(ratio, GM_MOTOR_STEPS, settings->teeth) || gm_ratio_times(ratio, 1, GM_MOTOR_STEPS_DEN) ||
           gm_ratio_times(ratio, GM_TURN_COUNTS_DEN, GM_TURN_COUNTS);
  }
  if (settings->left) {
    ratio->numerator = -ratio->numerator;
  }
  if (settings->pitch_kind == GM_PITCH_MODULE || settings->pitch_kind == GM_PITCH_DP) {
    if (gm_ratio_times(ratio, 355, 113)) {
      return -1;
    }
  }
  /* a thread of t/100 per inch has a pitch of 2540/t mm */
  return (settings->pitch_kind == GM_PITCH_TPI || settings->pitch_kind == GM_PITCH_DP
              ? gm_ratio_times(ratio, 2540, settings->pitch)
              : gm_ratio_times(ratio, settings->pitch, 1000)) ||
         gm_ratio_times(ratio, GM_SCREW_STEPS_NUM, GM_SCREW_STEPS_DEN) ||
         gm_ratio_times(ratio, GM_TURN_COUNTS_DEN, GM_TURN_COUNTS);
}

/* size 2^point of `factor` turns per mm, over the lead: factor sin(beta) / (pi m z). */
static int gm_over_lead(const gm_settings *settings, gm_ratio factor, int point, uint64_t *size) {
  const uint64_t sine = gm_sine_over_pi(settings->helix);
  int64_t down;
  if (gm_ratio_times(&factor, 1, settings->teeth) ||
      (settings->hob_unit == GM_MM ? gm_ratio_times(&factor, GM_HOB_UNIT, settings->hob_size)
                                   : gm_ratio_times(&factor, 10 * (int64_t)settings->hob_size, 254 * GM_HOB_UNIT)) ||
      gm_multiply(factor.denominator, (int64_t)1 << (62 - point), &down)) {
    return -1;
  }
  return gm_muldiv(sine, gm_magnitude(factor.numerator), (uint64_t)down / 2, (uint64_t)down, size);
}

/* Sets one axis to sign * (whole + rest/denominator), as base + increment/denominator with 0 <= increment < D. */
static gm_refusal gm_set_axis(gm_job *job, int axis, int negative, uint64_t whole, uint64_t rest) {
  const uint64_t denominator = (uint64_t)job->denominator;
  if (rest >= denominator) { /* rounded up */
    ++whole;
    rest -= denominator;
  }
  if (whole > GM_MAX_BASE || (whole == GM_MAX_BASE && rest != 0)) {
    return GM_TOO_STEEP;
  }
  job->base[axis] = (int32_t)whole;
  job->increment[axis] = (gm_wide)rest;
  if (negative) {
    job->base[axis] = -(int32_t)whole - (rest != 0);
    job->increment[axis] = (gm_wide)(rest == 0 ? 0 : denominator - rest);
  }
  return GM_JOB_OK;
}

static gm_refusal gm_set_leading(gm_job *job, const gm_ratio *ratio, uint64_t denominator) {
  const uint64_t size = gm_magnitude(ratio->numerator), down = (uint64_t)ratio->denominator;
  if (denominator > GM_WIDEST) {
    return GM_TOO_WIDE;
  }
  job->denominator = (gm_wide)denominator;
  return gm_set_axis(job, GM_HOB, ratio->numerator < 0, size / down, size % down * (denominator / down));
}

/* Two terms over one denominator: the hob's D1 times the least t for which rounding keeps the bound over the travel. */
static gm_refusal gm_two_terms(const gm_settings *settings, const gm_ratio *ratio, gm_job *job) {
  const uint64_t one = (uint64_t)1 << GM_POINT;
  gm_ratio factor = {GM_MOTOR_STEPS, GM_MOTOR_STEPS_DEN};
  uint64_t size, counts, times, rest, least;
  gm_refusal refusal;
  if (gm_ratio_times(&factor, GM_FEED_COUNTS_DEN, GM_FEED_COUNTS_NUM) ||
      gm_over_lead(settings, factor, GM_POINT, &size)) {
    return GM_TOO_STEEP;
  }
  /* rounding costs at most 1/(2 D) per count: D >= counts GM_HELIX_PART / 2 */
  if (gm_muldiv((uint64_t)GM_HELIX_TRAVEL_MM * GM_HELIX_PART, GM_FEED_COUNTS_NUM, GM_FEED_COUNTS_DEN - 1,
                GM_FEED_COUNTS_DEN, &counts)) {
    return GM_TOO_WIDE;
  }
  if (gm_muldiv((uint64_t)ratio->denominator, GM_TURN_COUNTS_DEN, 0, 1, &least) ||
      gm_muldiv(counts / 2 / least + 1, least, 0, 1, &times)) {
    return GM_TOO_WIDE;
  }
  refusal = gm_set_leading(job, ratio, times);
  if (refusal != GM_JOB_OK) {
    return refusal;
  }
  gm_muldiv(size & (one - 1), times, one / 2, one, &rest);
  /* the table gains on a right-hand helix as the feed counts up, which is in conventional cutting */
  return gm_set_axis(job, GM_FEED, settings->left, size / one, rest);
}

/* One term: T = (k/z) H / (1 -+ f/L) turns of the table, where the feed moves f per turn of the table. */
static gm_refusal gm_fed_ratio(const gm_settings *settings, gm_ratio *ratio) {
  const int against = (settings->left != 0) != ((settings->starts < 0) != (settings->climb != 0));
  const int negative = ratio->numerator < 0;
  const uint64_t down = (uint64_t)ratio->denominator;
  gm_ratio factor = {settings->feed, 1000};
  uint64_t turn, value, counts, whole, unit, one = (uint64_t)1 << 62;
  if (gm_over_lead(settings, factor, 62, &turn) || turn >= one / 4) {
    return GM_BAD_FEED;
  }
  turn = against ? one + turn : one - turn;
  unit = one;
  for (whole = gm_magnitude(ratio->numerator) / down; whole; whole >>= 1) unit >>= 1; /* value below 2^62, times 4/3 */
  if (unit < (uint64_t)1 << (GM_POINT - 2) || gm_muldiv(gm_magnitude(ratio->numerator), unit, down / 2, down, &value) ||
      gm_muldiv(value, one, turn / 2, turn, &value)) {
    return GM_TOO_STEEP;
  }
  /* hob counts of the travel: travel/f turns of the table, z/k of the hob each */
  if (gm_muldiv((uint64_t)GM_HELIX_TRAVEL_MM * 1000 * settings->teeth, 2 * GM_HELIX_PART * (uint64_t)GM_TURN_COUNTS,
                (uint64_t)settings->feed * GM_TURN_COUNTS_DEN, (uint64_t)settings->feed * GM_TURN_COUNTS_DEN, &counts) ||
      gm_simplest(value, unit, counts, GM_WIDEST / GM_TURN_COUNTS_DEN, ratio)) {
    return GM_TOO_WIDE;
  }
  if (negative) {
    ratio->numerator = -ratio->numerator;
  }
  return GM_JOB_OK;
}

/* Highest hob rpm: that of the machine, or what the driver's steps/s allow, times D/N; whole, rounded down. The core
 * trips one in a hundred above it. A lathe cuts a coarse thread slowly, and trips there; behind a hob it must not be left
 * to the operator. */
static gm_refusal gm_check_rate(const gm_settings *settings, gm_facts *facts) {
  const int64_t size = (int64_t)gm_magnitude(facts->ratio.numerator);
  const uint64_t machine = (uint64_t)GM_MAX_EDGE_RATE * 60 * GM_TURN_COUNTS_DEN / GM_TURN_COUNTS;
  gm_ratio rpm = {(int64_t)(GM_MAX_STEP_RATE) * 6000 * GM_TURN_COUNTS_DEN, (int64_t)GM_TURN_COUNTS * 101};
  uint64_t driver = machine, steps;
  const int slow = gm_muldiv((uint64_t)size, (uint64_t)GM_MAX_EDGE_RATE * 101, 0,
                             (uint64_t)facts->ratio.denominator, &steps) == 0 &&
                   steps <= (uint64_t)(GM_MAX_STEP_RATE) * 100;
  if (!slow && gm_ratio_times(&rpm, facts->ratio.denominator, size) == 0) {
    driver = (uint64_t)(rpm.numerator / rpm.denominator);
  }
  facts->max_rpm = (uint32_t)(driver < machine ? driver : machine);
  return slow || settings->profile == GM_LATHE ? GM_JOB_OK : GM_TOO_FAST;
}

gm_refusal gm_job_make(const gm_settings *settings, gm_job *job, gm_facts *facts) {
  gm_job made = {0, {0, 0}, {0, 0}, GM_HYSTERESIS};
  const int helical = settings->profile == GM_HOBBING && settings->helix != 0;
  uint64_t denominator;
  gm_refusal refusal = gm_settings_check(settings);
  facts->ratio.numerator = 0;
  facts->ratio.denominator = 1;
  facts->max_rpm = 0;
  if (refusal != GM_JOB_OK) {
    return refusal;
  }
  if (gm_leading_ratio(settings, &facts->ratio)) {
    return GM_TOO_WIDE;
  }
  if (helical && !GM_HAS_FEED) {
    refusal = gm_fed_ratio(settings, &facts->ratio);
    if (refusal != GM_JOB_OK) {
      return refusal;
    }
  }
  if (gm_muldiv((uint64_t)facts->ratio.denominator, GM_TURN_COUNTS_DEN, 0, 1, &denominator)) {
    return GM_TOO_WIDE;
  }
  refusal = helical && GM_HAS_FEED ? gm_two_terms(settings, &facts->ratio, &made)
                                   : gm_set_leading(&made, &facts->ratio, denominator);
  if (refusal == GM_JOB_OK) {
    refusal = gm_check_rate(settings, facts);
  }
  if (refusal == GM_JOB_OK) {
    *job = made;
  }
  return refusal;
}
