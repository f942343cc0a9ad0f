/* gm_exact.c: checked products, 128-bit product and quotient from 64-bit words, sine in fixed point. */
#include "gm_exact.h"

#define GM_ONE ((uint64_t)1 << 61)                /* 1 of the sine's fixed point */
#define GM_PI UINT64_C(7244019458077122842)       /* pi 2^61 */
enum { GM_COARSE = 16 };                          /* units of a value that its own rounding may take of a bound */
enum { GM_SINE_TERMS = 13 };                      /* (pi/2)^28 / 28! is far below 2^-61 */

uint64_t gm_magnitude(int64_t value) {
  return value < 0 ? (uint64_t)0 - (uint64_t)value : (uint64_t)value;
}

uint64_t gm_gcd(uint64_t a, uint64_t b) {
  while (b != 0) {
    uint64_t rest = a % b;
    a = b;
    b = rest;
  }
  return a;
}

int gm_multiply(int64_t a, int64_t b, int64_t *product) {
  uint64_t size_a = gm_magnitude(a), size_b = gm_magnitude(b);
  if (size_a != 0 && size_b > (uint64_t)INT64_MAX / size_a) {
    return -1;
  }
  *product = (int64_t)(size_a * size_b);
  if ((a < 0) != (b < 0)) {
    *product = -*product;
  }
  return 0;
}

int gm_muldiv(uint64_t a, uint64_t b, uint64_t add, uint64_t c, uint64_t *quotient) {
  const uint64_t mask = UINT64_C(0xffffffff);
  uint64_t low = (a & mask) * (b & mask), middle = (a >> 32) * (b & mask) + (low >> 32);
  uint64_t other = (a & mask) * (b >> 32) + (middle & mask);
  uint64_t high = (a >> 32) * (b >> 32) + (middle >> 32) + (other >> 32);
  uint64_t result = 0;
  int bit;
  low = (other << 32) | (low & mask);
  low += add;
  high += low < add; /* a b + add < 2^128: high has room for the carry */
  if (high >= c) {
    return -1;
  }
  for (bit = 63; bit >= 0; --bit) {
    int carry = (int)(high >> 63);
    high = (high << 1) | ((low >> bit) & 1);
    if (carry || high >= c) {
      high -= c;
      result |= (uint64_t)1 << bit;
    }
  }
  *quotient = result;
  return 0;
}

int gm_ratio_times(gm_ratio *ratio, int64_t numerator, int64_t denominator) {
  int64_t up, down, common, cross, other;
  if (denominator <= 0 || ratio->denominator <= 0) {
    return -1;
  }
  /* with the common factors out first, the products fit wherever the result does */
  common = (int64_t)gm_gcd((uint64_t)denominator, gm_magnitude(numerator));
  numerator /= common;
  denominator /= common;
  cross = (int64_t)gm_gcd((uint64_t)denominator, gm_magnitude(ratio->numerator));
  other = (int64_t)gm_gcd((uint64_t)ratio->denominator, gm_magnitude(numerator));
  if (gm_multiply(ratio->numerator / cross, numerator / other, &up) ||
      gm_multiply(ratio->denominator / other, denominator / cross, &down)) {
    return -1;
  }
  ratio->numerator = up;
  ratio->denominator = up == 0 ? 1 : down;
  return 0;
}

int gm_simplest(uint64_t value, uint64_t one, uint64_t needed, uint64_t limit, gm_ratio *ratio) {
  const uint64_t apart = one / needed;
  uint64_t low = value - apart, low_one = one, high = value + apart, high_one = one;
  uint64_t p = 1, q = 0, before_p = 0, before_q = 1;
  if (apart < GM_COARSE || apart >= value) {
    return -1;
  }
  for (;;) {
    uint64_t digit = low / low_one, next_p, next_q;
    uint64_t rest = low % low_one;
    const int last = rest == 0 || high / high_one > digit; /* a whole number lies between */
    digit += last && rest != 0;
    if (gm_muldiv(digit, p, before_p, 1, &next_p) || gm_muldiv(digit, q, before_q, 1, &next_q) ||
        next_q > limit || next_p >> 62) {
      return -1;
    }
    before_p = p, before_q = q;
    p = next_p, q = next_q;
    if (last) {
      ratio->numerator = (int64_t)p;
      ratio->denominator = (int64_t)q;
      return 0;
    }
    /* what is left of both, turned over, so that the higher one is now the lower */
    high %= high_one;
    low = high_one;
    high_one = rest;
    rest = high;
    high = low_one;
    low_one = rest;
  }
}

uint64_t gm_sine(int32_t angle) {
  uint64_t x = 0, square = 0, sum = GM_ONE;
  int k;
  gm_muldiv((uint64_t)angle, GM_PI, GM_RIGHT_ANGLE, 2 * GM_RIGHT_ANGLE, &x);
  gm_muldiv(x, x, GM_ONE / 2, GM_ONE, &square);
  /* sin x = x (1 - x^2/6 (1 - x^2/20 (1 - ...))); every bracket lies between 0 and 1 */
  for (k = GM_SINE_TERMS; k >= 1; --k) {
    gm_muldiv(square, sum, GM_ONE / 2, GM_ONE, &sum);
    sum = GM_ONE - sum / (uint64_t)(2 * k * (2 * k + 1));
  }
  gm_muldiv(x, sum, GM_ONE / 2, GM_ONE, &sum);
  return sum;
}

uint64_t gm_sine_over_pi(int32_t angle) {
  uint64_t quotient = 0;
  gm_muldiv(gm_sine(angle), (uint64_t)1 << 62, GM_PI / 2, GM_PI, &quotient);
  return quotient;
}
