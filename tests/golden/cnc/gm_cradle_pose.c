/* gm_cradle_pose: generated, do not edit. */
#include "gm_cradle_pose.h"
#include "gm_check.h"

#include <math.h>

#if defined(__GNUC__)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-parameter"
#pragma GCC diagnostic ignored "-Wunused-function"
#endif

#define casadi_real double
#define casadi_int int
#define CASADI_PREFIX(ID) gm_cradle_pose_ ## ID
#define casadi_f0 CASADI_PREFIX(f0)

/* cradle_pose:(settings[12],theta)->(V_c[3],V_p[3],V_ls[3],work_angle) */
static int casadi_f0(const casadi_real** arg, casadi_real** res, casadi_int* iw, casadi_real* w, int mem) {
  casadi_real a0, a1, a2, a3, a4, a5, a6;
  a0=arg[0]? arg[0][2] : 0;
  a1=sin(a0);
  a2=arg[0]? arg[0][1] : 0;
  a3=arg[1]? arg[1][0] : 0;
  a2=(a2+a3);
  a4=arg[0]? arg[0][3] : 0;
  a4=(a2+a4);
  a5=sin(a4);
  a5=(a1*a5);
  if (res[0]!=0) res[0][0]=a5;
  a4=cos(a4);
  a1=(a1*a4);
  a1=(-a1);
  if (res[0]!=0) res[0][1]=a1;
  a0=cos(a0);
  if (res[0]!=0) res[0][2]=a0;
  a0=arg[0]? arg[0][7] : 0;
  a1=cos(a0);
  if (res[1]!=0) res[1][0]=a1;
  a4=0.;
  if (res[1]!=0) res[1][1]=a4;
  a0=sin(a0);
  if (res[1]!=0) res[1][2]=a0;
  a4=arg[0]? arg[0][6] : 0;
  a1=(a1*a4);
  a5=arg[0]? arg[0][0] : 0;
  a6=cos(a2);
  a6=(a5*a6);
  a1=(a1+a6);
  if (res[2]!=0) res[2][0]=a1;
  a1=arg[0]? arg[0][4] : 0;
  a2=sin(a2);
  a5=(a5*a2);
  a1=(a1+a5);
  if (res[2]!=0) res[2][1]=a1;
  a0=(a0*a4);
  a4=arg[0]? arg[0][5] : 0;
  a0=(a0-a4);
  if (res[2]!=0) res[2][2]=a0;
  a0=arg[0]? arg[0][9] : 0;
  a4=arg[0]? arg[0][8] : 0;
  a4=(a4*a3);
  a0=(a0+a4);
  if (res[3]!=0) res[3][0]=a0;
  return 0;
}

#if defined(__GNUC__)
#pragma GCC diagnostic pop
#endif

static int gm_cradle_pose_settings_inside(const double *x)
{
  static const double low[12] = {
    1.999998,
    -15.000000015,
    -4.000000004,
    -31.415926567313857,
    -400.0000004,
    -200.0000002,
    -200.0000002,
    -1.570796328365693,
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
static int gm_cradle_pose_theta_inside(const double *x)
{
  static const double low[1] = {-10.00000001};
  static const double high[1] = {10.00000001};
  return gm_inside(x, 1, low, high);
}

static int gm_cradle_pose_point(
    const double *settings,
    const double *theta,
    double *V_c,
    double *V_p,
    double *V_ls,
    double *work_angle)
{
  const double *arg[2];
  double *res[4];
  arg[0] = settings;
  arg[1] = theta;
  res[0] = V_c;
  res[1] = V_p;
  res[2] = V_ls;
  res[3] = work_angle;
  (void)casadi_f0(arg, res, 0, 0, 0);
  return gm_finite(V_c, 3) && gm_finite(V_p, 3) && gm_finite(V_ls, 3) && gm_finite(work_angle, 1) ? GM_OK : GM_E_NO_RESULT;
}


int gm_cradle_pose(
    const double settings[12],
    double theta,
    double V_c[3],
    double V_p[3],
    double V_ls[3],
    double *work_angle)
{
  int status = GM_E_DOMAIN;
  if (!settings || !V_c || !V_p || !V_ls || !work_angle) return GM_E_NULL;
  if (gm_cradle_pose_settings_inside(settings)
      && gm_cradle_pose_theta_inside(&theta)) {
    status = gm_cradle_pose_point(settings, &theta, V_c, V_p, V_ls, work_angle);
  }
  if (status != GM_OK) {
    gm_nan(V_c, 3);
    gm_nan(V_p, 3);
    gm_nan(V_ls, 3);
    gm_nan(work_angle, 1);
  }
  return status;
}

int gm_cradle_pose_batch(
    int64_t n,
    const double *settings, int64_t settings_stride,
    const double *theta, int64_t theta_stride,
    double *V_c,
    double *V_p,
    double *V_ls,
    double *work_angle,
    int64_t *first_bad)
{
  int status = GM_OK, shared;
  int64_t k;
  if (first_bad) *first_bad = -1;
  if (n < 0 || settings_stride < 0 || theta_stride < 0) return GM_E_SIZE;
  if (n == 0) return GM_OK;
  if (!settings || !theta || !V_c || !V_p || !V_ls || !work_angle) return GM_E_NULL;
  shared = (settings_stride != 0 || gm_cradle_pose_settings_inside(settings))
      && (theta_stride != 0 || gm_cradle_pose_theta_inside(theta));
  for (k = 0; k < n; ++k) {
    int now = GM_E_DOMAIN;
    if (shared
        && (settings_stride == 0 || gm_cradle_pose_settings_inside(settings + k * settings_stride))
        && (theta_stride == 0 || gm_cradle_pose_theta_inside(theta + k * theta_stride))) {
      now = gm_cradle_pose_point(
          settings + k * settings_stride,
          theta + k * theta_stride,
          V_c + k * 3,
          V_p + k * 3,
          V_ls + k * 3,
          work_angle + k);
    }
    if (now != GM_OK) {
      gm_nan(V_c + k * 3, 3);
      gm_nan(V_p + k * 3, 3);
      gm_nan(V_ls + k * 3, 3);
      gm_nan(work_angle + k, 1);
      if (status == GM_OK) {
        status = now;
        if (first_bad) *first_bad = k;
      }
    }
  }
  return status;
}
