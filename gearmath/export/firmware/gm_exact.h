/* gm_exact.h: whole-number arithmetic that says so where a result does not fit. No 128-bit type, no floating point. */
#ifndef GM_EXACT_H
#define GM_EXACT_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* A fraction in lowest terms, denominator > 0. */
typedef struct {
  int64_t numerator;
  int64_t denominator;
} gm_ratio;

uint64_t gm_magnitude(int64_t value);
uint64_t gm_gcd(uint64_t a, uint64_t b);
int gm_multiply(int64_t a, int64_t b, int64_t *product); /* 0, or -1 where it does not fit */
/* floor((a b + add) / c) with the product of 128 bits; 0, or -1 where c is 0 or the quotient does not fit. */
int gm_muldiv(uint64_t a, uint64_t b, uint64_t add, uint64_t c, uint64_t *quotient);
/* ratio *= numerator / denominator, in lowest terms; 0, or -1 where it does not fit or denominator <= 0. */
int gm_ratio_times(gm_ratio *ratio, int64_t numerator, int64_t denominator);
/* The fraction p/q of the least q with |value/one - p/q| <= 1/needed, value and one below 2^63; 0, or -1 where q would
 * exceed limit, or value/one is too coarse to tell. */
int gm_simplest(uint64_t value, uint64_t one, uint64_t needed, uint64_t limit, gm_ratio *ratio);

enum { GM_RIGHT_ANGLE = 9000 };
/* sin(angle) 2^61, angle in 1/100 degree from 0 to 9000; at most 8 of 2^61 away (tests measure it with mpmath). */
uint64_t gm_sine(int32_t angle);
/* sin(angle)/pi 2^62; at most 8 of 2^62 away. */
uint64_t gm_sine_over_pi(int32_t angle);

#ifdef __cplusplus
}
#endif

#endif
