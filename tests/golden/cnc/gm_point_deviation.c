/* gm_point_deviation: generated, do not edit. */
#include "gm_point_deviation.h"

#include <math.h>

#if defined(__GNUC__)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-parameter"
#pragma GCC diagnostic ignored "-Wunused-function"
#endif

#define casadi_real double
#define casadi_int int
#define CASADI_PREFIX(ID) gm_point_deviation_ ## ID
#define casadi_f0 CASADI_PREFIX(f0)

/* point_deviation:(tip_center[3],tip_radius,point_w[3],normal_w[3])->(deviation) */
static int casadi_f0(const casadi_real** arg, casadi_real** res, casadi_int* iw, casadi_real* w, int mem) {
  casadi_real a0, a1, a2, a3;
  a0=arg[3]? arg[3][0] : 0;
  a1=arg[0]? arg[0][0] : 0;
  a2=arg[2]? arg[2][0] : 0;
  a1=(a1-a2);
  a0=(a0*a1);
  a1=arg[1]? arg[1][0] : 0;
  a0=(a0-a1);
  a1=arg[3]? arg[3][1] : 0;
  a2=arg[0]? arg[0][1] : 0;
  a3=arg[2]? arg[2][1] : 0;
  a2=(a2-a3);
  a1=(a1*a2);
  a0=(a0+a1);
  a1=arg[3]? arg[3][2] : 0;
  a2=arg[0]? arg[0][2] : 0;
  a3=arg[2]? arg[2][2] : 0;
  a2=(a2-a3);
  a1=(a1*a2);
  a0=(a0+a1);
  if (res[0]!=0) res[0][0]=a0;
  return 0;
}

#if defined(__GNUC__)
#pragma GCC diagnostic pop
#endif

void gm_point_deviation(
    const double tip_center[3],
    double tip_radius,
    const double point_w[3],
    const double normal_w[3],
    double *deviation)
{
  const double *arg[4];
  double *res[1];
  arg[0] = tip_center;
  arg[1] = &tip_radius;
  arg[2] = point_w;
  arg[3] = normal_w;
  res[0] = deviation;
  (void)casadi_f0(arg, res, 0, 0, 0);
}

void gm_point_deviation_batch(
    long n,
    const double *tip_center, long tip_center_stride,
    const double *tip_radius, long tip_radius_stride,
    const double *point_w, long point_w_stride,
    const double *normal_w, long normal_w_stride,
    double *deviation)
{
  long k;
  for (k = 0; k < n; ++k) {
    gm_point_deviation(
        tip_center + k * tip_center_stride,
        tip_radius[k * tip_radius_stride],
        point_w + k * point_w_stride,
        normal_w + k * normal_w_stride,
        deviation + k);
  }
}
