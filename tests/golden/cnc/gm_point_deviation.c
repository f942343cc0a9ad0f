/* gm_point_deviation: generated, do not edit. */
#include "gm_point_deviation.h"
#include "gm_check.h"

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

static int gm_point_deviation_tip_center_inside(const double *x)
{
  static const double low[3] = {-5000.000005, -5000.000005, -5000.000005};
  static const double high[3] = {5000.000005, 5000.000005, 5000.000005};
  return gm_inside(x, 3, low, high);
}
static int gm_point_deviation_tip_radius_inside(const double *x)
{
  static const double low[1] = {-5.0000000000000004e-08};
  static const double high[1] = {50.00000005};
  return gm_inside(x, 1, low, high);
}
static int gm_point_deviation_point_w_inside(const double *x)
{
  static const double low[3] = {-5000.000005, -5000.000005, -5000.000005};
  static const double high[3] = {5000.000005, 5000.000005, 5000.000005};
  return gm_inside(x, 3, low, high);
}
static int gm_point_deviation_normal_w_inside(const double *x)
{
  static const double low[3] = {-1.000000001, -1.000000001, -1.000000001};
  static const double high[3] = {1.000000001, 1.000000001, 1.000000001};
  return gm_inside(x, 3, low, high);
}

static int gm_point_deviation_point(
    const double *tip_center,
    const double *tip_radius,
    const double *point_w,
    const double *normal_w,
    double *deviation)
{
  const double *arg[4];
  double *res[1];
  arg[0] = tip_center;
  arg[1] = tip_radius;
  arg[2] = point_w;
  arg[3] = normal_w;
  res[0] = deviation;
  (void)casadi_f0(arg, res, 0, 0, 0);
  return gm_finite(deviation, 1) ? GM_OK : GM_E_NO_RESULT;
}


int gm_point_deviation(
    const double tip_center[3],
    double tip_radius,
    const double point_w[3],
    const double normal_w[3],
    double *deviation)
{
  int status = GM_E_DOMAIN;
  if (!tip_center || !point_w || !normal_w || !deviation) return GM_E_NULL;
  if (gm_point_deviation_tip_center_inside(tip_center)
      && gm_point_deviation_tip_radius_inside(&tip_radius)
      && gm_point_deviation_point_w_inside(point_w)
      && gm_point_deviation_normal_w_inside(normal_w)) {
    status = gm_point_deviation_point(tip_center, &tip_radius, point_w, normal_w, deviation);
  }
  if (status != GM_OK) {
    gm_nan(deviation, 1);
  }
  return status;
}

int gm_point_deviation_batch(
    int64_t n,
    const double *tip_center, int64_t tip_center_stride,
    const double *tip_radius, int64_t tip_radius_stride,
    const double *point_w, int64_t point_w_stride,
    const double *normal_w, int64_t normal_w_stride,
    double *deviation,
    int64_t *first_bad)
{
  int status = GM_OK, shared;
  int64_t k;
  if (first_bad) *first_bad = -1;
  if (n < 0 || tip_center_stride < 0 || tip_radius_stride < 0 || point_w_stride < 0 || normal_w_stride < 0) return GM_E_SIZE;
  if (n == 0) return GM_OK;
  if (!tip_center || !tip_radius || !point_w || !normal_w || !deviation) return GM_E_NULL;
  shared = (tip_center_stride != 0 || gm_point_deviation_tip_center_inside(tip_center))
      && (tip_radius_stride != 0 || gm_point_deviation_tip_radius_inside(tip_radius))
      && (point_w_stride != 0 || gm_point_deviation_point_w_inside(point_w))
      && (normal_w_stride != 0 || gm_point_deviation_normal_w_inside(normal_w));
  for (k = 0; k < n; ++k) {
    int now = GM_E_DOMAIN;
    if (shared
        && (tip_center_stride == 0 || gm_point_deviation_tip_center_inside(tip_center + k * tip_center_stride))
        && (tip_radius_stride == 0 || gm_point_deviation_tip_radius_inside(tip_radius + k * tip_radius_stride))
        && (point_w_stride == 0 || gm_point_deviation_point_w_inside(point_w + k * point_w_stride))
        && (normal_w_stride == 0 || gm_point_deviation_normal_w_inside(normal_w + k * normal_w_stride))) {
      now = gm_point_deviation_point(
          tip_center + k * tip_center_stride,
          tip_radius + k * tip_radius_stride,
          point_w + k * point_w_stride,
          normal_w + k * normal_w_stride,
          deviation + k);
    }
    if (now != GM_OK) {
      gm_nan(deviation + k, 1);
      if (status == GM_OK) {
        status = now;
        if (first_bad) *first_bad = k;
      }
    }
  }
  return status;
}
