/* gm_gear.c: the numbers that the display shows of a gear or a thread, and the words for a refusal (see gm_job.h). */
#include "gm_job.h"

enum { GM_SPUR_POINT = 36, GM_LEAD_POINT = 20 }; /* binary places of z/cos(beta), of the lead */

const char *gm_refusal_text(gm_refusal refusal) {
  switch (refusal) {
    case GM_JOB_OK: return "ok";
    case GM_BAD_PROFILE: return "other kind of job";
    case GM_BAD_TEETH: return "teeth: 1 to 999";
    case GM_BAD_STARTS: return "starts: 1 to 10";
    case GM_BAD_HELIX: return "helix: 0 to 60 deg";
    case GM_BAD_HOB: return "hob is not known";
    case GM_BAD_FEED: return "feed not possible";
    case GM_BAD_PITCH: return "pitch not possible";
    case GM_TOO_STEEP: return "ratio over 64/edge";
    case GM_TOO_WIDE: return "ratio needs 64 bit";
    case GM_TOO_FAST: return "too many steps/s";
  }
  return "unknown";
}

const char *gm_depth_text(const gm_settings *settings) {
  switch (settings->depth_rule) {
    case GM_DEPTH_225_P: return "2.25/P";
    case GM_DEPTH_2157_P: return "2.157/P";
    case GM_DEPTH_22_P: return "2.2/P+0.002in";
    default: return "2.25m";
  }
}

/* A number of modules as a length: times size/1000 mm, or 1000/size inch. */
static int gm_modules(const gm_settings *settings, gm_ratio *length) {
  return settings->hob_unit == GM_MM ? gm_ratio_times(length, settings->hob_size, GM_HOB_UNIT)
                                     : gm_ratio_times(length, GM_HOB_UNIT, settings->hob_size);
}

int gm_blank_diameter(const gm_settings *settings, gm_ratio *diameter) {
  uint64_t turned;
  diameter->numerator = settings->teeth + 2;
  diameter->denominator = 1;
  if (settings->helix != 0) { /* z/cos(beta) + 2 */
    const uint64_t cosine = gm_sine(GM_RIGHT_ANGLE - settings->helix);
    if (gm_muldiv((uint64_t)settings->teeth << GM_SPUR_POINT, (uint64_t)1 << 61, cosine / 2, cosine, &turned)) {
      return -1;
    }
    diameter->numerator = (int64_t)(turned + ((uint64_t)2 << GM_SPUR_POINT));
    diameter->denominator = (int64_t)1 << GM_SPUR_POINT;
  }
  return gm_modules(settings, diameter);
}

int gm_cut_depth(const gm_settings *settings, gm_ratio *depth) {
  const int rule = settings->depth_rule;
  depth->numerator = rule == GM_DEPTH_2157_P ? 2157 : rule == GM_DEPTH_22_P ? 2200 : 2250;
  depth->denominator = 1000;
  if (gm_modules(settings, depth)) {
    return -1;
  }
  if (rule == GM_DEPTH_22_P) { /* + 1/500 inch */
    int64_t up;
    if (gm_multiply(depth->numerator, 500, &up)) {
      return -1;
    }
    depth->numerator = up + depth->denominator;
    return gm_multiply(depth->denominator, 500, &depth->denominator);
  }
  return 0;
}

int gm_helix_lead(const gm_settings *settings, gm_ratio *lead) {
  const uint64_t sine = gm_sine_over_pi(settings->helix);
  uint64_t value;
  /* L = pi m z / sin(beta): z over sin/pi in modules, then as a length */
  lead->numerator = settings->teeth;
  lead->denominator = 1;
  if (sine == 0 || gm_modules(settings, lead) || lead->numerator >> (63 - GM_LEAD_POINT) ||
      gm_muldiv((uint64_t)lead->numerator << GM_LEAD_POINT, (uint64_t)1 << 62, sine / 2, sine, &value) || value >> 63) {
    return -1;
  }
  lead->numerator = (int64_t)value;
  return gm_multiply(lead->denominator, (int64_t)1 << GM_LEAD_POINT, &lead->denominator);
}

/* The whole number nearest to the value of a ratio; halves away from zero. */
static int64_t gm_nearest(const gm_ratio *ratio) {
  uint64_t size = 0;
  gm_muldiv(gm_magnitude(ratio->numerator), 1, (uint64_t)ratio->denominator / 2, (uint64_t)ratio->denominator, &size);
  return ratio->numerator < 0 ? -(int64_t)size : (int64_t)size;
}

int64_t gm_jog_steps(int size, int32_t n) {
  static const int32_t hundredths[] = {1, 10, 100, 1000};
  gm_ratio steps = {hundredths[size & 3], 100};
#ifdef GM_PROFILE_LATHE
  const int bad = gm_ratio_times(&steps, GM_SCREW_STEPS_NUM, GM_SCREW_STEPS_DEN) || gm_ratio_times(&steps, n, 1);
#else
  const int bad = gm_ratio_times(&steps, GM_MOTOR_STEPS, 360) || gm_ratio_times(&steps, n, GM_MOTOR_STEPS_DEN);
#endif
  return bad ? 0 : gm_nearest(&steps);
}

int64_t gm_division_step(int32_t n, int32_t divisions) {
  gm_ratio steps = {n, 1};
  const int bad = gm_ratio_times(&steps, GM_MOTOR_STEPS, divisions) || gm_ratio_times(&steps, 1, GM_MOTOR_STEPS_DEN);
  return bad ? 0 : gm_nearest(&steps);
}

int gm_next_start(const gm_settings *settings, const gm_ratio *ratio, int64_t edges, int64_t position, int32_t *move) {
  /* A turn is E = turn/d counts. One start is `turn` of m = d starts e + turn, one lead turn starts; a = ratio / (d starts)
   * steps each. */
  const int64_t turn = GM_TURN_COUNTS, lead = turn * settings->starts;
  gm_ratio part = *ratio;
  int64_t here, wanted, aside, to;
  uint64_t size;
  if (part.numerator == 0 || gm_ratio_times(&part, 1, settings->starts * (int64_t)GM_TURN_COUNTS_DEN) ||
      gm_muldiv(gm_magnitude(position), (uint64_t)part.denominator, gm_magnitude(part.numerator) / 2,
                gm_magnitude(part.numerator), &size) || size >> 62) {
    return -1;
  }
  here = (position < 0) != (part.numerator < 0) ? -(int64_t)size : (int64_t)size;
  wanted = edges % turn * GM_TURN_COUNTS_DEN % turn * settings->starts + turn; /* whole turns are whole leads */
  aside = (wanted - here) % lead;
  aside = aside > lead / 2 ? aside - lead : aside < -(lead / 2) ? aside + lead : aside;
  /* wanted + j lead = here + aside: the same whole number, so that only the steps are rounded */
  if (gm_ratio_times(&part, here + aside, 1)) {
    return -1;
  }
  to = gm_nearest(&part) - position;
  if (to > INT32_MAX || to < -INT32_MAX) {
    return -1;
  }
  *move = (int32_t)to;
  return 0;
}
