/* gm_seen_from_tool: generated, do not edit. */
#include "gm_seen_from_tool.h"
#include "gm_check.h"

#include <math.h>

#if defined(__GNUC__)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-parameter"
#pragma GCC diagnostic ignored "-Wunused-function"
#endif

#define casadi_real double
#define casadi_int int
#define CASADI_PREFIX(ID) gm_seen_from_tool_ ## ID
#define casadi_f0 CASADI_PREFIX(f0)

/* seen_from_tool:(axes[5],point_w[3],pivot_height,pivot_offset[3])->(point_m[3]) */
static int casadi_f0(const casadi_real** arg, casadi_real** res, casadi_int* iw, casadi_real* w, int mem) {
  casadi_real a0, a1, a2, a3, a4, a5, a6, a7, a8, a9;
  a0=arg[0]? arg[0][0] : 0;
  a1=arg[3]? arg[3][2] : 0;
  a2=arg[1]? arg[1][2] : 0;
  a1=(a1+a2);
  a2=arg[0]? arg[0][4] : 0;
  a3=cos(a2);
  a4=(a1*a3);
  a0=(a0+a4);
  a4=arg[3]? arg[3][0] : 0;
  a5=arg[0]? arg[0][3] : 0;
  a6=cos(a5);
  a7=arg[1]? arg[1][0] : 0;
  a8=(a6*a7);
  a4=(a4+a8);
  a5=sin(a5);
  a8=arg[1]? arg[1][1] : 0;
  a9=(a5*a8);
  a4=(a4+a9);
  a2=sin(a2);
  a9=(a4*a2);
  a0=(a0+a9);
  a0=(-a0);
  if (res[0]!=0) res[0][0]=a0;
  a0=arg[3]? arg[3][1] : 0;
  a9=arg[0]? arg[0][1] : 0;
  a0=(a0-a9);
  a6=(a6*a8);
  a0=(a0+a6);
  a5=(a5*a7);
  a0=(a0-a5);
  if (res[0]!=0) res[0][1]=a0;
  a0=arg[2]? arg[2][0] : 0;
  a5=arg[0]? arg[0][2] : 0;
  a0=(a0-a5);
  a3=(a3*a4);
  a0=(a0+a3);
  a1=(a1*a2);
  a0=(a0-a1);
  if (res[0]!=0) res[0][2]=a0;
  return 0;
}

#if defined(__GNUC__)
#pragma GCC diagnostic pop
#endif

static int gm_seen_from_tool_axes_inside(const double *x)
{
  static const double low[5] = {-5000.000005, -5000.000005, -5000.000009, -100.0000001, -2.000000017};
  static const double high[5] = {5000.000005, 5000.000005, 9000.000009, 100.0000001, 17.000000017};
  return gm_inside(x, 5, low, high);
}
static int gm_seen_from_tool_point_w_inside(const double *x)
{
  static const double low[3] = {-5000.000005, -5000.000005, -5000.000005};
  static const double high[3] = {5000.000005, 5000.000005, 5000.000005};
  return gm_inside(x, 3, low, high);
}
static int gm_seen_from_tool_pivot_height_inside(const double *x)
{
  static const double low[1] = {-10000.00001};
  static const double high[1] = {10000.00001};
  return gm_inside(x, 1, low, high);
}
static int gm_seen_from_tool_pivot_offset_inside(const double *x)
{
  static const double low[3] = {-1000.000001, -1000.000001, -1000.000001};
  static const double high[3] = {1000.000001, 1000.000001, 1000.000001};
  return gm_inside(x, 3, low, high);
}

static int gm_seen_from_tool_point(
    const double *axes,
    const double *point_w,
    const double *pivot_height,
    const double *pivot_offset,
    double *point_m)
{
  const double *arg[4];
  double *res[1];
  arg[0] = axes;
  arg[1] = point_w;
  arg[2] = pivot_height;
  arg[3] = pivot_offset;
  res[0] = point_m;
  (void)casadi_f0(arg, res, 0, 0, 0);
  return gm_finite(point_m, 3) ? GM_OK : GM_E_NO_RESULT;
}


int gm_seen_from_tool(
    const double axes[5],
    const double point_w[3],
    double pivot_height,
    const double pivot_offset[3],
    double point_m[3])
{
  int status = GM_E_DOMAIN;
  if (!axes || !point_w || !pivot_offset || !point_m) return GM_E_NULL;
  if (gm_seen_from_tool_axes_inside(axes)
      && gm_seen_from_tool_point_w_inside(point_w)
      && gm_seen_from_tool_pivot_height_inside(&pivot_height)
      && gm_seen_from_tool_pivot_offset_inside(pivot_offset)) {
    status = gm_seen_from_tool_point(axes, point_w, &pivot_height, pivot_offset, point_m);
  }
  if (status != GM_OK) {
    gm_nan(point_m, 3);
  }
  return status;
}

int gm_seen_from_tool_batch(
    int64_t n,
    const double *axes, int64_t axes_stride,
    const double *point_w, int64_t point_w_stride,
    const double *pivot_height, int64_t pivot_height_stride,
    const double *pivot_offset, int64_t pivot_offset_stride,
    double *point_m,
    int64_t *first_bad)
{
  int status = GM_OK, shared;
  int64_t k;
  if (first_bad) *first_bad = -1;
  if (n < 0 || axes_stride < 0 || point_w_stride < 0 || pivot_height_stride < 0 || pivot_offset_stride < 0) return GM_E_SIZE;
  if (n == 0) return GM_OK;
  if (!axes || !point_w || !pivot_height || !pivot_offset || !point_m) return GM_E_NULL;
  shared = (axes_stride != 0 || gm_seen_from_tool_axes_inside(axes))
      && (point_w_stride != 0 || gm_seen_from_tool_point_w_inside(point_w))
      && (pivot_height_stride != 0 || gm_seen_from_tool_pivot_height_inside(pivot_height))
      && (pivot_offset_stride != 0 || gm_seen_from_tool_pivot_offset_inside(pivot_offset));
  for (k = 0; k < n; ++k) {
    int now = GM_E_DOMAIN;
    if (shared
        && (axes_stride == 0 || gm_seen_from_tool_axes_inside(axes + k * axes_stride))
        && (point_w_stride == 0 || gm_seen_from_tool_point_w_inside(point_w + k * point_w_stride))
        && (pivot_height_stride == 0 || gm_seen_from_tool_pivot_height_inside(pivot_height + k * pivot_height_stride))
        && (pivot_offset_stride == 0 || gm_seen_from_tool_pivot_offset_inside(pivot_offset + k * pivot_offset_stride))) {
      now = gm_seen_from_tool_point(
          axes + k * axes_stride,
          point_w + k * point_w_stride,
          pivot_height + k * pivot_height_stride,
          pivot_offset + k * pivot_offset_stride,
          point_m + k * 3);
    }
    if (now != GM_OK) {
      gm_nan(point_m + k * 3, 3);
      if (status == GM_OK) {
        status = now;
        if (first_bad) *first_bad = k;
      }
    }
  }
  return status;
}
