/* The settings file: one key and its numbers a line, then the form of the program. */
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "post.h"

enum { MOST_NODES = 100000, MOST_ROLLS = 64, MOST_PASSES = 100000 };

/* What must have been read before the first path: a bit each. */
enum {
  DECIMALS = 1, MODULO = 2, LENGTH = 4, PIVOT = 8, SPEED = 16, ACCELERATION = 32, JERK = 64, FEED = 128, CLEARANCE = 256
};
static const char *const keys[] = {
    "decimals", "modulo", "length", "pivot", "speed", "acceleration", "jerk", "feed", "clearance"};
enum { KEYS = 9, ALL_KEYS = 511 };

/* What a path that is computed must have: the bits of settings, tooth and plunge, in the order of roll_key. */
enum { ROLL_NEEDS = 7 };

static void no_number(const Job *job, int64_t line, const char *key, int number, const char *text)
{
  const size_t length = strcspn(text, " ");
  refuse(job, line, "%s: number %d: '%.*s' is no number: digits, a point, an exponent", key, number,
      length < 24 ? (int)length : 24, text);
}

/* Numbers of a line: as many as wanted, all finite, nothing behind. */
static void numbers(const Job *job, int64_t line, const char *key, const char *text, double *values, int count)
{
  int k;
  for (k = 0; k < count; ++k) {
    char *end;
    while (*text == ' ') ++text;
    if (*text == '\0') refuse(job, line, "%s: has %d numbers, must have %d", key, k, count);
    if (strspn(text, "+-.0123456789eE") != strcspn(text, " ")) /* strtod reads 0x10, inf and nan as well */
      no_number(job, line, key, k + 1, text);
    values[k] = strtod(text, &end);
    if (end == text || (*end != ' ' && *end != '\0')) no_number(job, line, key, k + 1, text);
    if (!(fabs(values[k]) <= 1e9)) refuse(job, line, "%s: number %d: must be at most 1e9", key, k + 1);
    text = end;
  }
  while (*text == ' ') ++text;
  if (*text != '\0') refuse(job, line, "%s: has more than %d numbers", key, count);
}

static double one_within(const Job *job, int64_t line, const char *key, const char *text, double low, double high)
{
  double value;
  numbers(job, line, key, text, &value, 1);
  if (!(value >= low && value <= high)) refuse(job, line, "%s = %g: must be %g to %g", key, value, low, high);
  return value;
}

static void positive(const Job *job, int64_t line, const char *key, const double *values, int count)
{
  int k;
  for (k = 0; k < count; ++k)
    if (!(values[k] >= 1e-9)) refuse(job, line, "%s: number %d = %g: must be at least 1e-9", key, k + 1, values[k]);
}

static void whole(const Job *job, int64_t line, const char *key, const double *values, int count, int low, int high)
{
  int k;
  for (k = 0; k < count; ++k)
    if (!(values[k] >= low && values[k] <= high) || values[k] != floor(values[k]))
      refuse(job, line, "%s: number %d = %g: must be a whole number from %d to %d", key, k + 1, values[k], low, high);
}

/* Keys of machine and job; whether it was one of these. */
static int machine_key(Job *job, int64_t line, const char *key, const char *text, int *seen)
{
  double values[AXES];
  int which, k;
  for (which = 0; which < KEYS && strcmp(key, keys[which]) != 0; ++which) {}
  if (which == KEYS) return 0;
  if (*seen & (1 << which)) refuse(job, line, "%s: stands twice", key);
  *seen |= 1 << which;
  switch (1 << which) {
  case DECIMALS:
    numbers(job, line, key, text, values, 2);
    whole(job, line, key, values, 2, 1, 9);
    for (k = 0; k < 2; ++k) job->decimals[k] = (int)values[k];
    break;
  case MODULO:
    numbers(job, line, key, text, values, 2);
    whole(job, line, key, values, 2, 0, 1);
    job->modulo = values[0] != 0.0;
    job->cutter_modulo = values[1] != 0.0;
    break;
  case LENGTH: job->length = one_within(job, line, key, text, 0.0, 10000.0); break;
  case PIVOT:
    numbers(job, line, key, text, values, 4);
    job->pivot_height = values[0];
    memcpy(job->pivot_offset, values + 1, sizeof job->pivot_offset);
    break;
  case SPEED:
    numbers(job, line, key, text, job->speed, AXES);
    positive(job, line, key, job->speed, AXES);
    break;
  case ACCELERATION:
    numbers(job, line, key, text, job->acceleration, AXES);
    positive(job, line, key, job->acceleration, AXES);
    break;
  case JERK:
    numbers(job, line, key, text, job->jerk, AXES);
    positive(job, line, key, job->jerk, AXES);
    break;
  case FEED: job->feed = one_within(job, line, key, text, 0.001, 1e6); break;
  case CLEARANCE: job->clearance = one_within(job, line, key, text, 0.001, 10000.0); break;
  default: break;
  }
  return 1;
}

static void travel(Job *job, int64_t line, const char *text)
{
  static const char names[] = "XYZAB";
  const char *axis = *text ? strchr(names, *text) : NULL;
  double ends[2];
  if (!axis || text[1] != ' ') refuse(job, line, "travel: must name one of the axes X Y Z A B");
  numbers(job, line, "travel", text + 2, ends, 2);
  if (!(ends[0] < ends[1])) refuse(job, line, "travel: %g must be less than %g", ends[0], ends[1]);
  memcpy(job->travel[axis - names], ends, sizeof ends);
}

/* The end of a block of a planned roll: X Y Z A B C, seconds, and the coefficients of each axis. */
static void add_planned(const Job *job, int64_t line, Roll *roll, const char *text, int seen)
{
  enum { PLAIN = AXES + 2 };
  double values[PLAIN + MOST_BENDS * (AXES + 1)];
  const int bends = roll->powers * (AXES + 1);
  int k;
  if ((seen & ROLL_NEEDS) || roll->motion_rows || (roll->nodes && !roll->planned))
    refuse(job, line, "to: stands in a roll that is computed from its settings");
  roll->planned = 1;
  if (roll->nodes == MOST_NODES) refuse(job, line, "to: more than %d in one roll", MOST_NODES);
  if (roll->nodes == roll->room) {
    roll->room = roll->room ? 2 * roll->room : 256;
    roll->axes = grown(roll->axes, AXES * roll->room, sizeof *roll->axes);
    roll->seconds = grown(roll->seconds, roll->room, sizeof *roll->seconds);
    roll->cutter = grown(roll->cutter, roll->room, sizeof *roll->cutter);
    if (bends) roll->bends = grown(roll->bends, bends * roll->room, sizeof *roll->bends);
  }
  numbers(job, line, "to", text, values, PLAIN + bends);
  for (k = 0; k < PLAIN + bends; ++k)
    if (k != PLAIN - 1 && !(fabs(values[k]) <= 1e5)) refuse(job, line, "to: number %d = %g: must be -1e5 to 1e5", k + 1, values[k]);
  if (roll->nodes && !(values[AXES + 1] >= SHORTEST && values[AXES + 1] <= LONGEST))
    refuse(job, line, "to: time = %g s: must be %g to %g", values[AXES + 1], SHORTEST, LONGEST);
  memcpy(roll->axes + AXES * roll->nodes, values, AXES * sizeof *values);
  roll->cutter[roll->nodes] = values[AXES];
  if (roll->nodes) roll->seconds[roll->nodes - 1] = values[AXES + 1];
  if (roll->nodes && bends)
    memcpy(roll->bends + (int64_t)bends * (roll->nodes - 1), values + PLAIN, (size_t)bends * sizeof *values);
  ++roll->nodes;
}

/* Of the blocks of a roll: straight, cubic or quintic. */
static void degree(const Job *job, int64_t line, Roll *roll, const char *text)
{
  double value;
  numbers(job, line, "degree", text, &value, 1);
  if (value != 1.0 && value != 3.0 && value != 5.0) refuse(job, line, "degree = %g: must be 1, 3 or 5", value);
  roll->powers = (int)value - 1;
}

/* Keys of a path; whether it was one of these. */
static int roll_key(Job *job, int64_t line, const char *key, const char *text, int *seen)
{
  static const char *const once[] = {"settings", "tooth", "plunge", "degree"};
  Roll *roll = job->roll_count ? job->rolls + job->roll_count - 1 : NULL;
  int which;
  for (which = 0; which < 4 && strcmp(key, once[which]) != 0; ++which) {}
  if (which == 4 && strcmp(key, "motion") != 0 && strcmp(key, "node") != 0 && strcmp(key, "to") != 0) return 0;
  if (!roll) refuse(job, line, "%s: stands before the first roll", key);
  if (strcmp(key, "to") == 0) {
    add_planned(job, line, roll, text, *seen);
    return 1;
  }
  if (roll->planned) refuse(job, line, "%s: stands in a roll that was planned", key);
  if (which < 4 && *seen & (1 << which)) refuse(job, line, "%s: stands twice in one roll", key);
  if (which < 4) *seen |= 1 << which;
  if (which == 0) numbers(job, line, key, text, roll->settings, SETTINGS);
  else if (which == 1) numbers(job, line, key, text, roll->tooth, 3);
  else if (which == 2) roll->plunge = one_within(job, line, key, text, 0.0, 10000.0);
  else if (which == 3) degree(job, line, roll, text);
  else if (key[0] == 'm') {
    if (roll->motion_rows == MOTION / 7) refuse(job, line, "motion: more than %d lines in one roll", MOTION / 7);
    numbers(job, line, key, text, roll->motion + 7 * roll->motion_rows++, 7);
  } else {
    if (roll->nodes == MOST_NODES) refuse(job, line, "node: more than %d in one roll", MOST_NODES);
    if (roll->nodes == roll->room) {
      roll->room = roll->room ? 2 * roll->room : 256;
      roll->theta = grown(roll->theta, roll->room, sizeof *roll->theta);
    }
    numbers(job, line, key, text, roll->theta + roll->nodes++, 1);
  }
  return 1;
}

static void whole_roll(const Job *job, int64_t line, int seen)
{
  const Roll *roll = job->rolls + job->roll_count - 1;
  if (!roll->planned && (seen & ROLL_NEEDS) != ROLL_NEEDS)
    refuse(job, line, "roll %d: settings, tooth or plunge is missing", (int)job->roll_count - 1);
  if (roll->motion_rows != 0 && roll->motion_rows != MOTION / 7)
    refuse(job, line, "roll %d: motion has %d lines, must have %d, or none", (int)job->roll_count - 1, roll->motion_rows,
        MOTION / 7);
  if (roll->nodes < 2)
    refuse(job, line, "roll %d: has %d nodes, must have at least 2", (int)job->roll_count - 1, (int)roll->nodes);
}

static void add_pass(Job *job, int64_t line, const char *text)
{
  Pass *pass;
  double values[4];
  if (job->pass_count == MOST_PASSES) refuse(job, line, "pass: more than %d", MOST_PASSES);
  job->passes = grown(job->passes, job->pass_count + 1, sizeof *job->passes);
  pass = job->passes + job->pass_count++;
  numbers(job, line, "pass", text, values, 4);
  whole(job, line, "pass", values, 1, 0, (int)job->roll_count - 1);
  if (!(values[1] >= 0.0 && values[1] <= 10000.0)) refuse(job, line, "pass: lift = %g mm: must be 0 to 10000", values[1]);
  if (!(fabs(values[2]) <= 1000.0)) refuse(job, line, "pass: angle = %g rad: must be -1000 to 1000", values[2]);
  if (!(values[3] >= 0.0 && values[3] <= 1e5)) refuse(job, line, "pass: dwell = %g s: must be 0 to 1e5", values[3]);
  pass->roll = (int64_t)values[0];
  pass->lift = values[1];
  pass->angle = values[2];
  pass->dwell = values[3];
  pass->turns = 0.0;
  pass->line = line;
}

static void add_line(Job *job, int64_t line, char kind, const char *text)
{
  job->lines = grown(job->lines, job->line_count + 1, sizeof *job->lines);
  job->lines[job->line_count].kind = kind;
  job->lines[job->line_count].text = text;
  job->lines[job->line_count++].line = line;
}

static uint64_t fnv(const char *text, size_t length)
{
  uint64_t value = UINT64_C(0xcbf29ce484222325);
  size_t k;
  for (k = 0; k < length; ++k)
    if (text[k] != '\r') value = (value ^ (unsigned char)text[k]) * UINT64_C(0x100000001b3);
  return value;
}

/* The next line without its end, and where the one after it begins; NULL behind the last. */
static char *next_line(char **rest, char *end)
{
  char *line = *rest, *stop;
  if (line == end) return NULL;
  stop = memchr(line, '\n', (size_t)(end - line));
  if (!stop) stop = end;
  *rest = stop == end ? end : stop + 1;
  if (stop > line && stop[-1] == '\r') --stop;
  *stop = '\0';
  return line;
}

void read_settings(Job *job, char *text, size_t length)
{
  char *rest = text, *end = text + length, *line;
  char sum[32];
  int64_t number = 0;
  int seen = 0, in_roll = 0, form = 0, k;
  size_t at;
  for (at = 0; at < length; ++at)
    if (text[at] != '\n' && text[at] != '\r' && (text[at] < ' ' || text[at] > '~'))
      refuse(job, 0, "character %d is not printable ASCII: this is no settings file of gm-post", (int)at);
  for (k = 0; k < AXES; ++k) {
    job->travel[k][0] = -HUGE_VAL;
    job->travel[k][1] = HUGE_VAL;
  }
  line = next_line(&rest, end);
  if (!line || strncmp(line, "gm-post ", 8) != 0) refuse(job, 1, "must read 'gm-post 3': this is no settings file");
  if (strcmp(line + 8, "3") != 0)
    refuse(job, 1, "is of form %.20s, this gm-post reads form 3: export settings and gm-post together", line + 8);
  line = next_line(&rest, end);
  if (!line || strncmp(line, "sum ", 4) != 0) refuse(job, 2, "must begin with 'sum'");
  snprintf(sum, sizeof sum, "sum %016llx", (unsigned long long)fnv(rest, (size_t)(end - rest)));
  job->edited = strcmp(line, sum) != 0;
  for (number = 3; (line = next_line(&rest, end)) != NULL; ++number) {
    char *space = strchr(line, ' ');
    const char *value = space ? space + 1 : "";
    if (*line == '\0' || *line == '#') continue;
    if (space) *space = '\0';
    if (line[1] == '\0' && strchr("cnrbse", *line)) {
      if (!form && seen != ALL_KEYS) {
        for (k = 0; seen & (1 << k); ++k) {}
        refuse(job, number, "%s: is missing", keys[k]);
      }
      if (!form && job->roll_count == 0) refuse(job, number, "roll: there is none");
      if (!form) whole_roll(job, number, in_roll);
      form = 1;
      if (strchr("rb", *line) && job->pass_count == 0) refuse(job, number, "%c: stands before the first pass", *line);
      add_line(job, number, *line, value);
    } else if (strcmp(line, "pass") == 0) {
      if (!form) refuse(job, number, "pass: stands before the form of the program");
      add_pass(job, number, value);
      add_line(job, number, 'p', value);
    } else if (form) {
      refuse(job, number, "%.20s: must be one of c n r b s e pass, here in the form of the program", line);
    } else if (strcmp(line, "roll") == 0) {
      if (job->roll_count) whole_roll(job, number, in_roll);
      if (job->roll_count == MOST_ROLLS) refuse(job, number, "roll: more than %d", MOST_ROLLS);
      job->rolls = grown(job->rolls, job->roll_count + 1, sizeof *job->rolls);
      memset(job->rolls + job->roll_count++, 0, sizeof *job->rolls);
      in_roll = 0;
    } else if (strcmp(line, "travel") == 0) {
      travel(job, number, value);
    } else if (!machine_key(job, number, line, value, &seen) && !roll_key(job, number, line, value, &in_roll)) {
      refuse(job, number, "%.20s: no such key", line);
    }
  }
  if (job->pass_count == 0) refuse(job, 0, "there is no pass to write");
}
