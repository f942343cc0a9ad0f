/* gm_tool_pose: generated, do not edit. */
#include "gm_tool_pose.h"
#include "gm_check.h"

#include <math.h>

#if defined(__GNUC__)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-parameter"
#pragma GCC diagnostic ignored "-Wunused-function"
#endif

#define casadi_real double
#define casadi_int int
#define CASADI_PREFIX(ID) gm_tool_pose_ ## ID
#define casadi_f0 CASADI_PREFIX(f0)

/* tool_pose:(axes[5],pivot_height,pivot_offset[3])->(cutter_center_w[3],cutter_axis_w[3]) */
static int casadi_f0(const casadi_real** arg, casadi_real** res, casadi_int* iw, casadi_real* w, int mem) {
  casadi_real a0, a1, a2, a3, a4, a5, a6, a7, a8, a9;
  a0=arg[0]? arg[0][2] : 0;
  a1=arg[1]? arg[1][0] : 0;
  a0=(a0-a1);
  a1=arg[0]? arg[0][4] : 0;
  a2=cos(a1);
  a3=(a0*a2);
  a4=arg[2]? arg[2][0] : 0;
  a3=(a3-a4);
  a1=sin(a1);
  a4=arg[0]? arg[0][0] : 0;
  a5=(a1*a4);
  a3=(a3-a5);
  a5=arg[0]? arg[0][3] : 0;
  a6=cos(a5);
  a7=(a3*a6);
  a8=arg[0]? arg[0][1] : 0;
  a9=arg[2]? arg[2][1] : 0;
  a8=(a8-a9);
  a5=sin(a5);
  a9=(a8*a5);
  a7=(a7-a9);
  if (res[0]!=0) res[0][0]=a7;
  a8=(a8*a6);
  a3=(a5*a3);
  a8=(a8+a3);
  if (res[0]!=0) res[0][1]=a8;
  a8=arg[2]? arg[2][2] : 0;
  a0=(a1*a0);
  a8=(a8+a0);
  a4=(a2*a4);
  a8=(a8+a4);
  a8=(-a8);
  if (res[0]!=0) res[0][2]=a8;
  a6=(a2*a6);
  a6=(-a6);
  if (res[1]!=0) res[1][0]=a6;
  a5=(a5*a2);
  a5=(-a5);
  if (res[1]!=0) res[1][1]=a5;
  if (res[1]!=0) res[1][2]=a1;
  return 0;
}

#if defined(__GNUC__)
#pragma GCC diagnostic pop
#endif

static int gm_tool_pose_axes_inside(const double *x)
{
  static const double low[5] = {-5000.000005, -5000.000005, -5000.000009, -100.0000001, -2.000000017};
  static const double high[5] = {5000.000005, 5000.000005, 9000.000009, 100.0000001, 17.000000017};
  return gm_inside(x, 5, low, high);
}
static int gm_tool_pose_pivot_height_inside(const double *x)
{
  static const double low[1] = {-10000.00001};
  static const double high[1] = {10000.00001};
  return gm_inside(x, 1, low, high);
}
static int gm_tool_pose_pivot_offset_inside(const double *x)
{
  static const double low[3] = {-1000.000001, -1000.000001, -1000.000001};
  static const double high[3] = {1000.000001, 1000.000001, 1000.000001};
  return gm_inside(x, 3, low, high);
}

static int gm_tool_pose_point(
    const double *axes,
    const double *pivot_height,
    const double *pivot_offset,
    double *cutter_center_w,
    double *cutter_axis_w)
{
  const double *arg[3];
  double *res[2];
  arg[0] = axes;
  arg[1] = pivot_height;
  arg[2] = pivot_offset;
  res[0] = cutter_center_w;
  res[1] = cutter_axis_w;
  (void)casadi_f0(arg, res, 0, 0, 0);
  return gm_finite(cutter_center_w, 3) && gm_finite(cutter_axis_w, 3) ? GM_OK : GM_E_NO_RESULT;
}


int gm_tool_pose(
    const double axes[5],
    double pivot_height,
    const double pivot_offset[3],
    double cutter_center_w[3],
    double cutter_axis_w[3])
{
  int status = GM_E_DOMAIN;
  if (!axes || !pivot_offset || !cutter_center_w || !cutter_axis_w) return GM_E_NULL;
  if (gm_tool_pose_axes_inside(axes)
      && gm_tool_pose_pivot_height_inside(&pivot_height)
      && gm_tool_pose_pivot_offset_inside(pivot_offset)) {
    status = gm_tool_pose_point(axes, &pivot_height, pivot_offset, cutter_center_w, cutter_axis_w);
  }
  if (status != GM_OK) {
    gm_nan(cutter_center_w, 3);
    gm_nan(cutter_axis_w, 3);
  }
  return status;
}

int gm_tool_pose_batch(
    int64_t n,
    const double *axes, int64_t axes_stride,
    const double *pivot_height, int64_t pivot_height_stride,
    const double *pivot_offset, int64_t pivot_offset_stride,
    double *cutter_center_w,
    double *cutter_axis_w,
    int64_t *first_bad)
{
  int status = GM_OK, shared;
  int64_t k;
  if (first_bad) *first_bad = -1;
  if (n < 0 || axes_stride < 0 || pivot_height_stride < 0 || pivot_offset_stride < 0) return GM_E_SIZE;
  if (n == 0) return GM_OK;
  if (!axes || !pivot_height || !pivot_offset || !cutter_center_w || !cutter_axis_w) return GM_E_NULL;
  shared = (axes_stride != 0 || gm_tool_pose_axes_inside(axes))
      && (pivot_height_stride != 0 || gm_tool_pose_pivot_height_inside(pivot_height))
      && (pivot_offset_stride != 0 || gm_tool_pose_pivot_offset_inside(pivot_offset));
  for (k = 0; k < n; ++k) {
    int now = GM_E_DOMAIN;
    if (shared
        && (axes_stride == 0 || gm_tool_pose_axes_inside(axes + k * axes_stride))
        && (pivot_height_stride == 0 || gm_tool_pose_pivot_height_inside(pivot_height + k * pivot_height_stride))
        && (pivot_offset_stride == 0 || gm_tool_pose_pivot_offset_inside(pivot_offset + k * pivot_offset_stride))) {
      now = gm_tool_pose_point(
          axes + k * axes_stride,
          pivot_height + k * pivot_height_stride,
          pivot_offset + k * pivot_offset_stride,
          cutter_center_w + k * 3,
          cutter_axis_w + k * 3);
    }
    if (now != GM_OK) {
      gm_nan(cutter_center_w + k * 3, 3);
      gm_nan(cutter_axis_w + k * 3, 3);
      if (status == GM_OK) {
        status = now;
        if (first_bad) *first_bad = k;
      }
    }
  }
  return status;
}
