/* gm_format.c: fixed-point text by long division, so that every digit is the exact one. */
#include "gm_format.h"

#include "gm_exact.h"

enum { GM_DIGITS = 32 }; /* 20 digits of 64 bits, the decimals and a carry */

static int gm_refuse(char *field, int width) {
  int k;
  for (k = 0; k < width; ++k) {
    field[k] = '#';
  }
  return -1;
}

/* The digits of up/down, rounded, the last one first; their number. */
static int gm_digits(uint64_t up, uint64_t down, int decimals, char digits[GM_DIGITS]) {
  char forward[GM_DIGITS];
  uint64_t whole = up / down, rest = up % down;
  int n = 0, count = 0, k, carry;
  do {
    digits[n++] = (char)(whole % 10);
    whole /= 10;
  } while (whole != 0);
  for (k = n - 1; k >= 0; --k) {
    forward[count++] = digits[k];
  }
  for (k = 0; k < decimals; ++k) {
    char digit = 0;
    int tenth;
    uint64_t sum = 0;
    for (tenth = 0; tenth < 10; ++tenth) { /* 10 rest may not fit, rest + sum < 2 down <= 2^64 does */
      sum += rest;
      if (sum >= down) {
        sum -= down;
        ++digit;
      }
    }
    forward[count++] = digit;
    rest = sum;
  }
  carry = rest >= down - rest;
  for (k = 0; k < count; ++k) {
    digits[k] = (char)(forward[count - 1 - k] + carry);
    carry = digits[k] == 10;
    digits[k] = carry ? 0 : digits[k];
  }
  if (carry) {
    digits[count++] = 1;
  }
  return count;
}

int gm_format_ratio(char *field, int width, int64_t numerator, int64_t denominator, int decimals) {
  char digits[GM_DIGITS];
  int count, k, column = width, negative, zero = 1;
  if (width < 0 || width > GM_FORMAT_WIDTH || denominator == 0 || decimals < 0 || decimals > GM_FORMAT_DECIMALS) {
    return gm_refuse(field, width > GM_FORMAT_WIDTH ? GM_FORMAT_WIDTH : width);
  }
  count = gm_digits(gm_magnitude(numerator), gm_magnitude(denominator), decimals, digits);
  for (k = 0; k < count; ++k) {
    zero = zero && digits[k] == 0;
  }
  negative = !zero && (numerator < 0) != (denominator < 0);
  if (count + (decimals > 0) + negative > width) {
    return gm_refuse(field, width);
  }
  for (k = 0; k < count; ++k) {
    if (decimals > 0 && k == decimals) {
      field[--column] = '.';
    }
    field[--column] = (char)('0' + digits[k]);
  }
  if (negative) {
    field[--column] = '-';
  }
  while (column > 0) {
    field[--column] = ' ';
  }
  return 0;
}

int gm_format_whole(char *field, int width, int64_t value) {
  return gm_format_ratio(field, width, value, 1, 0);
}

int gm_format_text(char *field, int width, const char *text) {
  int k;
  for (k = 0; k < width && text[k] != '\0'; ++k) {
    field[k] = text[k];
  }
  if (text[k] != '\0') {
    return gm_refuse(field, width);
  }
  for (; k < width; ++k) {
    field[k] = ' ';
  }
  return 0;
}
