/* gm_lane.h: values of one point, for functions that compute apart what all points share. Not installed. */
#ifndef GM_LANE_H
#define GM_LANE_H

#include <math.h>

#define V double
#define v_all(x) (x)
#define v_sqrt sqrt
#define v_atan2 atan2

/* Compilers make one call of both. */
static inline void v_sincos(double x, double *sine, double *cosine)
{
  *sine = sin(x);
  *cosine = cos(x);
}

#endif
