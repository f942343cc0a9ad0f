/* The text of the program: the form of the settings file, its slots filled with numbers made of whole ones. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "post.h"

enum { MOST_DECIMALS = 15, FEED_DIGITS = 9, MORE_DECIMALS = 2 };

static const double degrees = 180.0 / 3.141592653589793;

/* A number of 10^-decimals, printed: digits of a whole number with a point in them. */
static void print_scaled(FILE *stream, int64_t value, int decimals)
{
  char digits[32];
  int length = 0;
  uint64_t rest = value < 0 ? 0 - (uint64_t)value : (uint64_t)value;
  if (value < 0) fputc('-', stream);
  do {
    if (length == decimals && decimals > 0) digits[length++] = '.';
    digits[length++] = (char)('0' + (int)(rest % 10));
    rest /= 10;
  } while (rest > 0 || length <= decimals + (decimals > 0));
  while (length > 0) fputc(digits[--length], stream);
}

static double power_of_ten(int exponent)
{
  static const double powers[MOST_DECIMALS + 1] = {
      1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15};
  return powers[exponent];
}

/* value * 10^decimals as a whole number, rounded once: by the exact product, ties to even. */
static int64_t scaled(double value, int decimals)
{
  const double power = power_of_ten(decimals), product = value * power, below = fma(value, power, -product);
  double whole = rint(product);
  const double half = product - whole;
  if (half == 0.5 && below > 0.0) whole += 1.0;
  if (half == -0.5 && below < 0.0) whole -= 1.0;
  return (int64_t)whole;
}

/* Nine digits: one part in 1e9 of the block's time. */
static void print_feed(FILE *stream, double value)
{
  int decimals = FEED_DIGITS - 1 - (int)floor(log10(value));
  if (decimals < 1) decimals = 1;
  if (decimals > MOST_DECIMALS) decimals = MOST_DECIMALS;
  print_scaled(stream, scaled(value, decimals), decimals);
}

/* An angle in degrees in increments, of a modulo axis within a turn. */
static int64_t turned(double value, int modulo, double power)
{
  const int64_t turn = (int64_t)(360.0 * power);
  int64_t rounded;
  if (!modulo) return (int64_t)rint(value * power);
  value = fmod(value, 360.0);
  if (value < 0.0) value += 360.0;
  rounded = (int64_t)rint(value * power);
  return rounded >= turn ? rounded - turn : rounded;
}

/* Position of axis j at a node, in mm or degrees, in increments of the text. */
static int64_t position(const Job *job, const Pass *pass, int64_t node, int j)
{
  const double power = power_of_ten(job->decimals[j > 2]);
  const Roll *roll = job->rolls + pass->roll;
  double value = roll->axes[AXES * node + j];
  if (j < 3) {
    if (j == 2) value = value + pass->lift - job->length;
    return (int64_t)rint(value * power);
  }
  if (j == 3) value = value + pass->angle + pass->turns;
  value *= degrees;
  return j == 3 ? turned(value, job->modulo, power) : (int64_t)rint(value * power);
}

/* What stands for an axis in a polynomial block: its end, and the coefficients up to the last that is not zero. */
static void print_polynomial(const Job *job, const Pass *pass, int64_t node, int j, FILE *stream)
{
  const Roll *roll = job->rolls + pass->roll;
  const int decimals = job->decimals[j > 2], powers = roll->powers;
  const double *bends = roll->bends + (AXES + (roll->planned != 0)) * powers * (node - 1) + powers * j;
  int64_t rounded[MOST_BENDS];
  double value = j < AXES ? roll->axes[AXES * node + j] : roll->cutter[node];
  int k, kept = 0;
  if (j == 2) value = value + pass->lift - job->length;
  if (j == 3) value = value + pass->angle + pass->turns;
  if (j > 2) value *= degrees;
  if (j == 3) { /* a modulo A counts on from what stands at the first position */
    const double first = (roll->axes[j] + pass->angle + pass->turns) * degrees;
    const double shown = (double)position(job, pass, 0, j) / power_of_ten(decimals);
    value -= 360.0 * rint((first - shown) / 360.0);
  }
  for (k = 0; k < powers; ++k) {
    rounded[k] = scaled(j > 2 ? bends[k] * degrees : bends[k], decimals + MORE_DECIMALS);
    if (rounded[k]) kept = k + 1;
  }
  print_scaled(stream, scaled(value, decimals), decimals);
  for (k = 0; k < kept; ++k) {
    fputc(',', stream);
    print_scaled(stream, rounded[k], decimals + MORE_DECIMALS);
  }
}

/* Fills the slot that begins at text, and returns what follows it. */
static const char *fill(const Job *job, const Line *line, const Pass *pass, int64_t node, const char *name,
    const char *text, FILE *stream)
{
  static const char axes[] = "XYZAB";
  const size_t length = strcspn(text, "}");
  const char *axis;
  if (text[length] != '}') refuse(job, line->line, "a slot has no end");
  if (length == 4 && memcmp(text, "NAME", 4) == 0) fputs(name, stream);
  else if (length == 4 && memcmp(text, "TIME", 4) == 0) print_scaled(stream, scaled(job->seconds, 1), 1);
  else if (length == 2 && memcmp(text, "UP", 2) == 0)
    print_scaled(stream, scaled(job->up - job->length, job->decimals[0]), job->decimals[0]);
  else if (length == 1 && pass && (axis = strchr(axes, *text)) != NULL)
    print_scaled(stream, position(job, pass, node, (int)(axis - axes)), job->decimals[axis - axes > 2]);
  else if (length == 1 && pass && *text == 'C' && job->rolls[pass->roll].planned)
    print_scaled(stream, turned(job->rolls[pass->roll].cutter[node] * degrees, job->cutter_modulo,
        power_of_ten(job->decimals[1])), job->decimals[1]);
  else if (length == 2 && pass && node > 0 && *text == 'P' && job->rolls[pass->roll].powers
      && (axis = strchr(job->rolls[pass->roll].planned ? "XYZABC" : axes, text[1])) != NULL)
    print_polynomial(job, pass, node, *axis == 'C' ? AXES : (int)(strchr(axes, *axis) - axes), stream);
  else if (length == 1 && pass && node > 0 && *text == 'F')
    print_feed(stream, 60.0 / job->rolls[pass->roll].seconds[node - 1]);
  else
    refuse(job, line->line, "{%.*s}: no such slot here", length < 20 ? (int)length : 20, text);
  return text + length + 1;
}

static void put(const Job *job, const Line *line, const Pass *pass, int64_t node, const char *name, int64_t *number,
    FILE *stream)
{
  const char *text = line->text;
  if (number) fprintf(stream, "N%lld ", (long long)(*number += 10));
  while (*text) {
    const size_t plain = strcspn(text, "{");
    fwrite(text, 1, plain, stream);
    text += plain;
    if (text[0] == '{' && text[1] == '{') {
      fputc('{', stream);
      text += 2;
    } else if (*text == '{') {
      text = fill(job, line, pass, node, name, text + 1, stream);
    }
  }
  fputc('\n', stream);
}

void write_program(const Job *job, const char *name, FILE *stream)
{
  const Pass *pass = NULL;
  int64_t number = 0, next = 0, k, node;
  for (k = 0; k < job->line_count; ++k) {
    const Line *line = job->lines + k;
    switch (line->kind) {
    case 'p': pass = job->passes + next++; break;
    case 'c': put(job, line, pass, 0, name, NULL, stream); break;
    case 'n': put(job, line, pass, 0, name, &number, stream); break;
    case 's':
    case 'e':
      if (job->edited == (line->kind == 'e')) put(job, line, pass, 0, name, NULL, stream);
      break;
    default:
      if (!pass) break; /* read_settings refuses it */
      for (node = 1; node < job->rolls[pass->roll].nodes; ++node)
        put(job, line, pass, node, name, line->kind == 'b' ? &number : NULL, stream);
    }
  }
}
