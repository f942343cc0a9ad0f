/* gm_quintic_block: generated, do not edit. */
#include "gm_quintic_block.h"
#include "gm_check.h"

#include <math.h>

#if defined(__GNUC__)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-parameter"
#pragma GCC diagnostic ignored "-Wunused-function"
#endif

#define casadi_real double
#define casadi_int int
#define CASADI_PREFIX(ID) gm_quintic_block_ ## ID
#define casadi_f0 CASADI_PREFIX(f0)
#define casadi_sq CASADI_PREFIX(sq)

static casadi_real casadi_sq(casadi_real x) { return x*x;}

/* quintic_block:(block_start,block_end,slope_start,slope_end,bend_start,bend_end,block_interval)->(quintic_coefficients[4]) */
static int casadi_f0(const casadi_real** arg, casadi_real** res, casadi_int* iw, casadi_real* w, int mem) {
  casadi_real a00, a01, a02, a03, a04, a05, a06, a07, a08, a09, a10, a11;
  casadi_real a12, a13;
  a00=5.0000000000000000e-01;
  a01=arg[4]? arg[4][0] : 0;
  a02=(a00*a01);
  if (res[0]!=0) res[0][0]=a02;
  a02=-20.;
  a03=arg[0]? arg[0][0] : 0;
  a02=(a02*a03);
  a04=20.;
  a05=arg[1]? arg[1][0] : 0;
  a04=(a04*a05);
  a02=(a02+a04);
  a04=arg[6]? arg[6][0] : 0;
  a06=casadi_sq(a04);
  a07=-3.;
  a07=(a07*a01);
  a08=arg[5]? arg[5][0] : 0;
  a09=(a07+a08);
  a09=(a06*a09);
  a02=(a02+a09);
  a09=8.;
  a10=arg[3]? arg[3][0] : 0;
  a09=(a09*a10);
  a11=12.;
  a12=arg[2]? arg[2][0] : 0;
  a13=(a11*a12);
  a09=(a09+a13);
  a09=(a04*a09);
  a02=(a02-a09);
  a02=(a00*a02);
  a09=casadi_sq(a04);
  a09=(a04*a09);
  a02=(a02/a09);
  if (res[0]!=0) res[0][1]=a02;
  a02=-30.;
  a02=(a02*a05);
  a09=30.;
  a09=(a09*a03);
  a02=(a02+a09);
  a09=-2.;
  a09=(a09*a08);
  a09=(a09-a07);
  a09=(a06*a09);
  a02=(a02+a09);
  a09=14.;
  a09=(a09*a10);
  a07=16.;
  a07=(a07*a12);
  a09=(a09+a07);
  a09=(a04*a09);
  a02=(a02+a09);
  a02=(a00*a02);
  a09=casadi_sq(a04);
  a09=casadi_sq(a09);
  a02=(a02/a09);
  if (res[0]!=0) res[0][2]=a02;
  a02=-12.;
  a02=(a02*a03);
  a11=(a11*a05);
  a02=(a02+a11);
  a01=(a01-a08);
  a06=(a06*a01);
  a02=(a02-a06);
  a06=6.;
  a10=(a06*a10);
  a06=(a06*a12);
  a10=(a10+a06);
  a10=(a04*a10);
  a02=(a02-a10);
  a00=(a00*a02);
  a02=casadi_sq(a04);
  a02=casadi_sq(a02);
  a04=(a04*a02);
  a00=(a00/a04);
  if (res[0]!=0) res[0][3]=a00;
  return 0;
}

#if defined(__GNUC__)
#pragma GCC diagnostic pop
#endif

static int gm_quintic_block_block_start_inside(const double *x)
{
  static const double low[1] = {-5000.000005};
  static const double high[1] = {5000.000005};
  return gm_inside(x, 1, low, high);
}
static int gm_quintic_block_block_end_inside(const double *x)
{
  static const double low[1] = {-5000.000005};
  static const double high[1] = {5000.000005};
  return gm_inside(x, 1, low, high);
}
static int gm_quintic_block_slope_start_inside(const double *x)
{
  static const double low[1] = {-2000.000002};
  static const double high[1] = {2000.000002};
  return gm_inside(x, 1, low, high);
}
static int gm_quintic_block_slope_end_inside(const double *x)
{
  static const double low[1] = {-2000.000002};
  static const double high[1] = {2000.000002};
  return gm_inside(x, 1, low, high);
}
static int gm_quintic_block_bend_start_inside(const double *x)
{
  static const double low[1] = {-2000.000002};
  static const double high[1] = {2000.000002};
  return gm_inside(x, 1, low, high);
}
static int gm_quintic_block_bend_end_inside(const double *x)
{
  static const double low[1] = {-2000.000002};
  static const double high[1] = {2000.000002};
  return gm_inside(x, 1, low, high);
}
static int gm_quintic_block_block_interval_inside(const double *x)
{
  static const double low[1] = {0.0499999};
  static const double high[1] = {100.0000001};
  return gm_inside(x, 1, low, high);
}

static int gm_quintic_block_point(
    const double *block_start,
    const double *block_end,
    const double *slope_start,
    const double *slope_end,
    const double *bend_start,
    const double *bend_end,
    const double *block_interval,
    double *quintic_coefficients)
{
  const double *arg[7];
  double *res[1];
  arg[0] = block_start;
  arg[1] = block_end;
  arg[2] = slope_start;
  arg[3] = slope_end;
  arg[4] = bend_start;
  arg[5] = bend_end;
  arg[6] = block_interval;
  res[0] = quintic_coefficients;
  (void)casadi_f0(arg, res, 0, 0, 0);
  return gm_finite(quintic_coefficients, 4) ? GM_OK : GM_E_NO_RESULT;
}


int gm_quintic_block(
    double block_start,
    double block_end,
    double slope_start,
    double slope_end,
    double bend_start,
    double bend_end,
    double block_interval,
    double quintic_coefficients[4])
{
  int status = GM_E_DOMAIN;
  if (!quintic_coefficients) return GM_E_NULL;
  if (gm_quintic_block_block_start_inside(&block_start)
      && gm_quintic_block_block_end_inside(&block_end)
      && gm_quintic_block_slope_start_inside(&slope_start)
      && gm_quintic_block_slope_end_inside(&slope_end)
      && gm_quintic_block_bend_start_inside(&bend_start)
      && gm_quintic_block_bend_end_inside(&bend_end)
      && gm_quintic_block_block_interval_inside(&block_interval)) {
    status = gm_quintic_block_point(
        &block_start,
        &block_end,
        &slope_start,
        &slope_end,
        &bend_start,
        &bend_end,
        &block_interval,
        quintic_coefficients);
  }
  if (status != GM_OK) {
    gm_nan(quintic_coefficients, 4);
  }
  return status;
}

int gm_quintic_block_batch(
    int64_t n,
    const double *block_start, int64_t block_start_stride,
    const double *block_end, int64_t block_end_stride,
    const double *slope_start, int64_t slope_start_stride,
    const double *slope_end, int64_t slope_end_stride,
    const double *bend_start, int64_t bend_start_stride,
    const double *bend_end, int64_t bend_end_stride,
    const double *block_interval, int64_t block_interval_stride,
    double *quintic_coefficients,
    int64_t *first_bad)
{
  int status = GM_OK, shared;
  int64_t k;
  if (first_bad) *first_bad = -1;
  if (n < 0 || block_start_stride < 0 || block_end_stride < 0 || slope_start_stride < 0 || slope_end_stride < 0 || bend_start_stride < 0 || bend_end_stride < 0 || block_interval_stride < 0) return GM_E_SIZE;
  if (n == 0) return GM_OK;
  if (!block_start || !block_end || !slope_start || !slope_end || !bend_start || !bend_end || !block_interval || !quintic_coefficients) return GM_E_NULL;
  shared = (block_start_stride != 0 || gm_quintic_block_block_start_inside(block_start))
      && (block_end_stride != 0 || gm_quintic_block_block_end_inside(block_end))
      && (slope_start_stride != 0 || gm_quintic_block_slope_start_inside(slope_start))
      && (slope_end_stride != 0 || gm_quintic_block_slope_end_inside(slope_end))
      && (bend_start_stride != 0 || gm_quintic_block_bend_start_inside(bend_start))
      && (bend_end_stride != 0 || gm_quintic_block_bend_end_inside(bend_end))
      && (block_interval_stride != 0 || gm_quintic_block_block_interval_inside(block_interval));
  for (k = 0; k < n; ++k) {
    int now = GM_E_DOMAIN;
    if (shared
        && (block_start_stride == 0 || gm_quintic_block_block_start_inside(block_start + k * block_start_stride))
        && (block_end_stride == 0 || gm_quintic_block_block_end_inside(block_end + k * block_end_stride))
        && (slope_start_stride == 0 || gm_quintic_block_slope_start_inside(slope_start + k * slope_start_stride))
        && (slope_end_stride == 0 || gm_quintic_block_slope_end_inside(slope_end + k * slope_end_stride))
        && (bend_start_stride == 0 || gm_quintic_block_bend_start_inside(bend_start + k * bend_start_stride))
        && (bend_end_stride == 0 || gm_quintic_block_bend_end_inside(bend_end + k * bend_end_stride))
        && (block_interval_stride == 0 || gm_quintic_block_block_interval_inside(block_interval + k * block_interval_stride))) {
      now = gm_quintic_block_point(
          block_start + k * block_start_stride,
          block_end + k * block_end_stride,
          slope_start + k * slope_start_stride,
          slope_end + k * slope_end_stride,
          bend_start + k * bend_start_stride,
          bend_end + k * bend_end_stride,
          block_interval + k * block_interval_stride,
          quintic_coefficients + k * 4);
    }
    if (now != GM_OK) {
      gm_nan(quintic_coefficients + k * 4, 4);
      if (status == GM_OK) {
        status = now;
        if (first_bad) *first_bad = k;
      }
    }
  }
  return status;
}
