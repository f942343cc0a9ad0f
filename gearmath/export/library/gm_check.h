/* gm_check.h: what the functions of libgearmath look at before and after they compute. Not installed. */
#ifndef GM_CHECK_H
#define GM_CHECK_H

#include <math.h>

#ifdef __FAST_MATH__
#error "libgearmath cannot be compiled with -ffast-math: it has to tell NaN from numbers"
#endif

/* Whether n numbers are within their ranges; NaN is not. */
static inline int gm_inside(const double *x, int n, const double *low, const double *high)
{
  int k, inside = 1;
  for (k = 0; k < n; ++k) inside &= (x[k] >= low[k]) & (x[k] <= high[k]);
  return inside;
}

/* Whether n numbers are neither infinite nor NaN. */
static inline int gm_finite(const double *x, int n)
{
  int k, finite = 1;
  for (k = 0; k < n; ++k) finite &= x[k] - x[k] == 0.0;
  return finite;
}

static inline void gm_nan(double *x, int n)
{
  int k;
  for (k = 0; k < n; ++k) x[k] = NAN;
}

#endif
