/* gm_cubic_block: generated, do not edit. */
#include "gm_cubic_block.h"
#include "gm_check.h"

#include <math.h>

#if defined(__GNUC__)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-parameter"
#pragma GCC diagnostic ignored "-Wunused-function"
#endif

#define casadi_real double
#define casadi_int int
#define CASADI_PREFIX(ID) gm_cubic_block_ ## ID
#define casadi_f0 CASADI_PREFIX(f0)
#define casadi_sq CASADI_PREFIX(sq)

static casadi_real casadi_sq(casadi_real x) { return x*x;}

/* cubic_block:(block_start,block_end,slope_start,slope_end,block_interval)->(cubic_coefficients[2]) */
static int casadi_f0(const casadi_real** arg, casadi_real** res, casadi_int* iw, casadi_real* w, int mem) {
  casadi_real a0, a1, a2, a3, a4, a5, a6;
  a0=-3.;
  a1=arg[0]? arg[0][0] : 0;
  a0=(a0*a1);
  a2=3.;
  a3=arg[1]? arg[1][0] : 0;
  a2=(a2*a3);
  a0=(a0+a2);
  a2=arg[4]? arg[4][0] : 0;
  a4=arg[3]? arg[3][0] : 0;
  a5=arg[2]? arg[2][0] : 0;
  a6=(2.*a5);
  a6=(a4+a6);
  a6=(a2*a6);
  a0=(a0-a6);
  a6=casadi_sq(a2);
  a0=(a0/a6);
  if (res[0]!=0) res[0][0]=a0;
  a0=-2.;
  a0=(a0*a3);
  a1=(2.*a1);
  a0=(a0+a1);
  a4=(a4+a5);
  a4=(a2*a4);
  a0=(a0+a4);
  a4=casadi_sq(a2);
  a2=(a2*a4);
  a0=(a0/a2);
  if (res[0]!=0) res[0][1]=a0;
  return 0;
}

#if defined(__GNUC__)
#pragma GCC diagnostic pop
#endif

static int gm_cubic_block_block_start_inside(const double *x)
{
  static const double low[1] = {-5000.000005};
  static const double high[1] = {5000.000005};
  return gm_inside(x, 1, low, high);
}
static int gm_cubic_block_block_end_inside(const double *x)
{
  static const double low[1] = {-5000.000005};
  static const double high[1] = {5000.000005};
  return gm_inside(x, 1, low, high);
}
static int gm_cubic_block_slope_start_inside(const double *x)
{
  static const double low[1] = {-2000.000002};
  static const double high[1] = {2000.000002};
  return gm_inside(x, 1, low, high);
}
static int gm_cubic_block_slope_end_inside(const double *x)
{
  static const double low[1] = {-2000.000002};
  static const double high[1] = {2000.000002};
  return gm_inside(x, 1, low, high);
}
static int gm_cubic_block_block_interval_inside(const double *x)
{
  static const double low[1] = {0.0499999};
  static const double high[1] = {100.0000001};
  return gm_inside(x, 1, low, high);
}

static int gm_cubic_block_point(
    const double *block_start,
    const double *block_end,
    const double *slope_start,
    const double *slope_end,
    const double *block_interval,
    double *cubic_coefficients)
{
  const double *arg[5];
  double *res[1];
  arg[0] = block_start;
  arg[1] = block_end;
  arg[2] = slope_start;
  arg[3] = slope_end;
  arg[4] = block_interval;
  res[0] = cubic_coefficients;
  (void)casadi_f0(arg, res, 0, 0, 0);
  return gm_finite(cubic_coefficients, 2) ? GM_OK : GM_E_NO_RESULT;
}


int gm_cubic_block(
    double block_start,
    double block_end,
    double slope_start,
    double slope_end,
    double block_interval,
    double cubic_coefficients[2])
{
  int status = GM_E_DOMAIN;
  if (!cubic_coefficients) return GM_E_NULL;
  if (gm_cubic_block_block_start_inside(&block_start)
      && gm_cubic_block_block_end_inside(&block_end)
      && gm_cubic_block_slope_start_inside(&slope_start)
      && gm_cubic_block_slope_end_inside(&slope_end)
      && gm_cubic_block_block_interval_inside(&block_interval)) {
    status = gm_cubic_block_point(
        &block_start,
        &block_end,
        &slope_start,
        &slope_end,
        &block_interval,
        cubic_coefficients);
  }
  if (status != GM_OK) {
    gm_nan(cubic_coefficients, 2);
  }
  return status;
}

int gm_cubic_block_batch(
    int64_t n,
    const double *block_start, int64_t block_start_stride,
    const double *block_end, int64_t block_end_stride,
    const double *slope_start, int64_t slope_start_stride,
    const double *slope_end, int64_t slope_end_stride,
    const double *block_interval, int64_t block_interval_stride,
    double *cubic_coefficients,
    int64_t *first_bad)
{
  int status = GM_OK, shared;
  int64_t k;
  if (first_bad) *first_bad = -1;
  if (n < 0 || block_start_stride < 0 || block_end_stride < 0 || slope_start_stride < 0 || slope_end_stride < 0 || block_interval_stride < 0) return GM_E_SIZE;
  if (n == 0) return GM_OK;
  if (!block_start || !block_end || !slope_start || !slope_end || !block_interval || !cubic_coefficients) return GM_E_NULL;
  shared = (block_start_stride != 0 || gm_cubic_block_block_start_inside(block_start))
      && (block_end_stride != 0 || gm_cubic_block_block_end_inside(block_end))
      && (slope_start_stride != 0 || gm_cubic_block_slope_start_inside(slope_start))
      && (slope_end_stride != 0 || gm_cubic_block_slope_end_inside(slope_end))
      && (block_interval_stride != 0 || gm_cubic_block_block_interval_inside(block_interval));
  for (k = 0; k < n; ++k) {
    int now = GM_E_DOMAIN;
    if (shared
        && (block_start_stride == 0 || gm_cubic_block_block_start_inside(block_start + k * block_start_stride))
        && (block_end_stride == 0 || gm_cubic_block_block_end_inside(block_end + k * block_end_stride))
        && (slope_start_stride == 0 || gm_cubic_block_slope_start_inside(slope_start + k * slope_start_stride))
        && (slope_end_stride == 0 || gm_cubic_block_slope_end_inside(slope_end + k * slope_end_stride))
        && (block_interval_stride == 0 || gm_cubic_block_block_interval_inside(block_interval + k * block_interval_stride))) {
      now = gm_cubic_block_point(
          block_start + k * block_start_stride,
          block_end + k * block_end_stride,
          slope_start + k * slope_start_stride,
          slope_end + k * slope_end_stride,
          block_interval + k * block_interval_stride,
          cubic_coefficients + k * 2);
    }
    if (now != GM_OK) {
      gm_nan(cubic_coefficients + k * 2, 2);
      if (status == GM_OK) {
        status = now;
        if (first_bad) *first_bad = k;
      }
    }
  }
  return status;
}
