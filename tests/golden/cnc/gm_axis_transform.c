/* gm_axis_transform: generated, do not edit. */
#include "gm_axis_transform.h"
#include "gm_check.h"

#include <math.h>

#if defined(__GNUC__)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-parameter"
#pragma GCC diagnostic ignored "-Wunused-function"
#endif

#define casadi_real double
#define casadi_int int
#define CASADI_PREFIX(ID) gm_axis_transform_ ## ID
#define casadi_f0 CASADI_PREFIX(f0)
#define casadi_sq CASADI_PREFIX(sq)

static casadi_real casadi_sq(casadi_real x) { return x*x;}

/* axis_transform:(settings[12],theta,pivot_height,pivot_offset[3])->(axes[5],margin) */
static int casadi_f0(const casadi_real** arg, casadi_real** res, casadi_int* iw, casadi_real* w, int mem) {
  casadi_real a00, a01, a02, a03, a04, a05, a06, a07, a08, a09, a10, a11;
  casadi_real a12, a13, a14, a15, a16, a17, a18, a19, a20, a21, a22, a23;
  casadi_real a24, a25, a26, a27, a28;
  a00=arg[0]? arg[0][2] : 0;
  a01=cos(a00);
  a02=arg[0]? arg[0][7] : 0;
  a03=sin(a02);
  a04=(a01*a03);
  a02=cos(a02);
  a00=sin(a00);
  a05=arg[0]? arg[0][1] : 0;
  a06=arg[1]? arg[1][0] : 0;
  a07=(a05+a06);
  a08=arg[0]? arg[0][3] : 0;
  a09=(a07+a08);
  a10=sin(a09);
  a11=(a00*a10);
  a12=(a02*a11);
  a12=(a04+a12);
  a13=arg[3]? arg[3][0] : 0;
  a14=(a12*a13);
  a15=(a01*a02);
  a16=(a03*a11);
  a15=(a15-a16);
  a16=casadi_sq(a15);
  a09=cos(a09);
  a17=casadi_sq(a09);
  a18=casadi_sq(a00);
  a17=(a17*a18);
  a19=casadi_sq(a02);
  a20=(a17*a19);
  a16=(a16+a20);
  a20=casadi_sq(a03);
  a21=(a17*a20);
  a16=(a16+a21);
  a16=sqrt(a16);
  a21=arg[3]? arg[3][2] : 0;
  a22=(a16*a21);
  a14=(a14+a22);
  a22=arg[0]? arg[0][4] : 0;
  a23=arg[0]? arg[0][0] : 0;
  a24=sin(a07);
  a24=(a23*a24);
  a22=(a22+a24);
  a24=(a00*a09);
  a25=(a24/a16);
  a04=(a04*a25);
  a26=(a02/a16);
  a27=(a18*a26);
  a27=(a27*a10);
  a27=(a27*a09);
  a04=(a04+a27);
  a04=(a22*a04);
  a14=(a14+a04);
  a04=arg[0]? arg[0][6] : 0;
  a27=(a03*a04);
  a09=arg[0]? arg[0][5] : 0;
  a27=(a27-a09);
  a09=(a17/a16);
  a09=(a09*a03);
  a10=(a15/a16);
  a28=(a10*a11);
  a09=(a09-a28);
  a09=(a27*a09);
  a14=(a14+a09);
  a04=(a02*a04);
  a07=cos(a07);
  a23=(a23*a07);
  a04=(a04+a23);
  a23=(a01*a10);
  a17=(a02*a17);
  a17=(a17/a16);
  a23=(a23+a17);
  a23=(a04*a23);
  a14=(a14+a23);
  a14=(-a14);
  if (res[0]!=0) res[0][0]=a14;
  a14=arg[3]? arg[3][1] : 0;
  a10=(a22*a10);
  a14=(a14+a10);
  a26=(a26*a24);
  a26=(a26*a27);
  a14=(a14+a26);
  a25=(a25*a03);
  a25=(a25*a04);
  a14=(a14-a25);
  if (res[0]!=0) res[0][1]=a14;
  a14=arg[2]? arg[2][0] : 0;
  a13=(a16*a13);
  a14=(a14+a13);
  a22=(a22*a24);
  a14=(a14+a22);
  a21=(a12*a21);
  a14=(a14-a21);
  a27=(a01*a27);
  a14=(a14-a27);
  a04=(a04*a11);
  a14=(a14-a04);
  if (res[0]!=0) res[0][2]=a14;
  a14=arg[0]? arg[0][9] : 0;
  a24=(-a24);
  a24=atan2(a24,a15);
  a14=(a14+a24);
  a24=arg[0]? arg[0][8] : 0;
  a24=(a24*a06);
  a14=(a14+a24);
  a14=(-a14);
  if (res[0]!=0) res[0][3]=a14;
  a14=1.5707963267948966e+00;
  a16=atan2(a16,a12);
  a14=(a14-a16);
  if (res[0]!=0) res[0][4]=a14;
  a14=-5.0000000000000003e-02;
  a02=(a02*a01);
  a00=(a00*a03);
  a05=(a05+a08);
  a05=(a05+a06);
  a06=sin(a05);
  a00=(a00*a06);
  a02=(a02-a00);
  a02=casadi_sq(a02);
  a05=cos(a05);
  a05=casadi_sq(a05);
  a18=(a18*a05);
  a19=(a18*a19);
  a02=(a02+a19);
  a18=(a18*a20);
  a02=(a02+a18);
  a02=sqrt(a02);
  a14=(a14+a02);
  if (res[1]!=0) res[1][0]=a14;
  return 0;
}

#if defined(__GNUC__)
#pragma GCC diagnostic pop
#endif

static int gm_axis_transform_settings_inside(const double *x)
{
  static const double low[12] = {
    1.999998,
    -15.000000015,
    -4.000000004,
    -31.415926567313857,
    -400.0000004,
    -200.0000002,
    -200.0000002,
    0.004999998429203673,
    0.04999992,
    -31.415926567313857,
    1.9999975,
    0.004999998429203673};
  static const double high[12] = {
    2000.000002,
    15.000000015,
    4.000000004,
    31.415926567313857,
    400.0000004,
    200.0000002,
    200.0000002,
    1.570796328365693,
    80.00000008,
    31.415926567313857,
    2500.0000025,
    1.570796328365693};
  return gm_inside(x, 12, low, high);
}
static int gm_axis_transform_theta_inside(const double *x)
{
  static const double low[1] = {-10.00000001};
  static const double high[1] = {10.00000001};
  return gm_inside(x, 1, low, high);
}
static int gm_axis_transform_pivot_height_inside(const double *x)
{
  static const double low[1] = {-10000.00001};
  static const double high[1] = {10000.00001};
  return gm_inside(x, 1, low, high);
}
static int gm_axis_transform_pivot_offset_inside(const double *x)
{
  static const double low[3] = {-1000.000001, -1000.000001, -1000.000001};
  static const double high[3] = {1000.000001, 1000.000001, 1000.000001};
  return gm_inside(x, 3, low, high);
}

static int gm_axis_transform_point(
    const double *settings,
    const double *theta,
    const double *pivot_height,
    const double *pivot_offset,
    double *axes)
{
  const double *arg[4];
  double *res[2];
  double margin;
  arg[0] = settings;
  arg[1] = theta;
  arg[2] = pivot_height;
  arg[3] = pivot_offset;
  res[0] = axes;
  res[1] = &margin;
  (void)casadi_f0(arg, res, 0, 0, 0);
  if (!(margin > 0.0)) return GM_E_REQUIRES;
  return gm_finite(axes, 5) ? GM_OK : GM_E_NO_RESULT;
}

int gm_axis_transform(
    const double settings[12],
    double theta,
    double pivot_height,
    const double pivot_offset[3],
    double axes[5])
{
  int status = GM_E_DOMAIN;
  if (!settings || !pivot_offset || !axes) return GM_E_NULL;
  if (gm_axis_transform_settings_inside(settings)
      && gm_axis_transform_theta_inside(&theta)
      && gm_axis_transform_pivot_height_inside(&pivot_height)
      && gm_axis_transform_pivot_offset_inside(pivot_offset)) {
    status = gm_axis_transform_point(settings, &theta, &pivot_height, pivot_offset, axes);
  }
  if (status != GM_OK) {
    gm_nan(axes, 5);
  }
  return status;
}

int gm_axis_transform_batch(
    int64_t n,
    const double *settings, int64_t settings_stride,
    const double *theta, int64_t theta_stride,
    const double *pivot_height, int64_t pivot_height_stride,
    const double *pivot_offset, int64_t pivot_offset_stride,
    double *axes,
    int64_t *first_bad)
{
  int status = GM_OK, shared;
  int64_t k;
  if (first_bad) *first_bad = -1;
  if (n < 0 || settings_stride < 0 || theta_stride < 0 || pivot_height_stride < 0 || pivot_offset_stride < 0) return GM_E_SIZE;
  if (n == 0) return GM_OK;
  if (!settings || !theta || !pivot_height || !pivot_offset || !axes) return GM_E_NULL;
  shared = (settings_stride != 0 || gm_axis_transform_settings_inside(settings))
      && (theta_stride != 0 || gm_axis_transform_theta_inside(theta))
      && (pivot_height_stride != 0 || gm_axis_transform_pivot_height_inside(pivot_height))
      && (pivot_offset_stride != 0 || gm_axis_transform_pivot_offset_inside(pivot_offset));
  for (k = 0; k < n; ++k) {
    int now = GM_E_DOMAIN;
    if (shared
        && (settings_stride == 0 || gm_axis_transform_settings_inside(settings + k * settings_stride))
        && (theta_stride == 0 || gm_axis_transform_theta_inside(theta + k * theta_stride))
        && (pivot_height_stride == 0 || gm_axis_transform_pivot_height_inside(pivot_height + k * pivot_height_stride))
        && (pivot_offset_stride == 0 || gm_axis_transform_pivot_offset_inside(pivot_offset + k * pivot_offset_stride))) {
      now = gm_axis_transform_point(
          settings + k * settings_stride,
          theta + k * theta_stride,
          pivot_height + k * pivot_height_stride,
          pivot_offset + k * pivot_offset_stride,
          axes + k * 5);
    }
    if (now != GM_OK) {
      gm_nan(axes + k * 5, 5);
      if (status == GM_OK) {
        status = now;
        if (first_bad) *first_bad = k;
      }
    }
  }
  return status;
}
