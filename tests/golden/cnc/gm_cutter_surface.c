/* gm_cutter_surface: generated, do not edit. */
#include "gm_cutter_surface.h"
#include "gm_check.h"

#include <math.h>

#if defined(__GNUC__)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-parameter"
#pragma GCC diagnostic ignored "-Wunused-function"
#endif

#define casadi_real double
#define casadi_int int
#define CASADI_PREFIX(ID) gm_cutter_surface_ ## ID
#define casadi_f0 CASADI_PREFIX(f0)

/* cutter_surface:(u,beta,blade_point_radius,blade_pressure_angle,side)->(point_c[3],normal_c[3]) */
static int casadi_f0(const casadi_real** arg, casadi_real** res, casadi_int* iw, casadi_real* w, int mem) {
  casadi_real a0, a1, a2, a3, a4, a5, a6;
  a0=arg[2]? arg[2][0] : 0;
  a1=arg[4]? arg[4][0] : 0;
  a2=arg[0]? arg[0][0] : 0;
  a3=(a1*a2);
  a4=arg[3]? arg[3][0] : 0;
  a5=tan(a4);
  a3=(a3*a5);
  a0=(a0+a3);
  a3=arg[1]? arg[1][0] : 0;
  a5=cos(a3);
  a6=(a0*a5);
  if (res[0]!=0) res[0][0]=a6;
  a3=sin(a3);
  a0=(a0*a3);
  if (res[0]!=0) res[0][1]=a0;
  a2=(-a2);
  if (res[0]!=0) res[0][2]=a2;
  a2=cos(a4);
  a1=(a1*a2);
  a5=(a5*a1);
  a5=(-a5);
  if (res[1]!=0) res[1][0]=a5;
  a3=(a3*a1);
  a3=(-a3);
  if (res[1]!=0) res[1][1]=a3;
  a4=sin(a4);
  a4=(-a4);
  if (res[1]!=0) res[1][2]=a4;
  return 0;
}

#if defined(__GNUC__)
#pragma GCC diagnostic pop
#endif

static int gm_cutter_surface_u_inside(const double *x)
{
  static const double low[1] = {-1.5000000000000002e-07};
  static const double high[1] = {150.00000015};
  return gm_inside(x, 1, low, high);
}
static int gm_cutter_surface_beta_inside(const double *x)
{
  static const double low[1] = {-31.415926567313857};
  static const double high[1] = {31.415926567313857};
  return gm_inside(x, 1, low, high);
}
static int gm_cutter_surface_blade_point_radius_inside(const double *x)
{
  static const double low[1] = {1.9999975};
  static const double high[1] = {2500.0000025};
  return gm_inside(x, 1, low, high);
}
static int gm_cutter_surface_blade_pressure_angle_inside(const double *x)
{
  static const double low[1] = {0.004999998429203673};
  static const double high[1] = {1.570796328365693};
  return gm_inside(x, 1, low, high);
}
static int gm_cutter_surface_side_inside(const double *x)
{
  return x[0] == -1.0 || x[0] == 1.0;
}

static int gm_cutter_surface_point(
    const double *u,
    const double *beta,
    const double *blade_point_radius,
    const double *blade_pressure_angle,
    const double *side,
    double *point_c,
    double *normal_c)
{
  const double *arg[5];
  double *res[2];
  arg[0] = u;
  arg[1] = beta;
  arg[2] = blade_point_radius;
  arg[3] = blade_pressure_angle;
  arg[4] = side;
  res[0] = point_c;
  res[1] = normal_c;
  (void)casadi_f0(arg, res, 0, 0, 0);
  return gm_finite(point_c, 3) && gm_finite(normal_c, 3) ? GM_OK : GM_E_NO_RESULT;
}


int gm_cutter_surface(
    double u,
    double beta,
    double blade_point_radius,
    double blade_pressure_angle,
    double side,
    double point_c[3],
    double normal_c[3])
{
  int status = GM_E_DOMAIN;
  if (!point_c || !normal_c) return GM_E_NULL;
  if (gm_cutter_surface_u_inside(&u)
      && gm_cutter_surface_beta_inside(&beta)
      && gm_cutter_surface_blade_point_radius_inside(&blade_point_radius)
      && gm_cutter_surface_blade_pressure_angle_inside(&blade_pressure_angle)
      && gm_cutter_surface_side_inside(&side)) {
    status = gm_cutter_surface_point(
        &u,
        &beta,
        &blade_point_radius,
        &blade_pressure_angle,
        &side,
        point_c,
        normal_c);
  }
  if (status != GM_OK) {
    gm_nan(point_c, 3);
    gm_nan(normal_c, 3);
  }
  return status;
}

int gm_cutter_surface_batch(
    int64_t n,
    const double *u, int64_t u_stride,
    const double *beta, int64_t beta_stride,
    const double *blade_point_radius, int64_t blade_point_radius_stride,
    const double *blade_pressure_angle, int64_t blade_pressure_angle_stride,
    const double *side, int64_t side_stride,
    double *point_c,
    double *normal_c,
    int64_t *first_bad)
{
  int status = GM_OK, shared;
  int64_t k;
  if (first_bad) *first_bad = -1;
  if (n < 0 || u_stride < 0 || beta_stride < 0 || blade_point_radius_stride < 0 || blade_pressure_angle_stride < 0 || side_stride < 0) return GM_E_SIZE;
  if (n == 0) return GM_OK;
  if (!u || !beta || !blade_point_radius || !blade_pressure_angle || !side || !point_c || !normal_c) return GM_E_NULL;
  shared = (u_stride != 0 || gm_cutter_surface_u_inside(u))
      && (beta_stride != 0 || gm_cutter_surface_beta_inside(beta))
      && (blade_point_radius_stride != 0 || gm_cutter_surface_blade_point_radius_inside(blade_point_radius))
      && (blade_pressure_angle_stride != 0 || gm_cutter_surface_blade_pressure_angle_inside(blade_pressure_angle))
      && (side_stride != 0 || gm_cutter_surface_side_inside(side));
  for (k = 0; k < n; ++k) {
    int now = GM_E_DOMAIN;
    if (shared
        && (u_stride == 0 || gm_cutter_surface_u_inside(u + k * u_stride))
        && (beta_stride == 0 || gm_cutter_surface_beta_inside(beta + k * beta_stride))
        && (blade_point_radius_stride == 0 || gm_cutter_surface_blade_point_radius_inside(blade_point_radius + k * blade_point_radius_stride))
        && (blade_pressure_angle_stride == 0 || gm_cutter_surface_blade_pressure_angle_inside(blade_pressure_angle + k * blade_pressure_angle_stride))
        && (side_stride == 0 || gm_cutter_surface_side_inside(side + k * side_stride))) {
      now = gm_cutter_surface_point(
          u + k * u_stride,
          beta + k * beta_stride,
          blade_point_radius + k * blade_point_radius_stride,
          blade_pressure_angle + k * blade_pressure_angle_stride,
          side + k * side_stride,
          point_c + k * 3,
          normal_c + k * 3);
    }
    if (now != GM_OK) {
      gm_nan(point_c + k * 3, 3);
      gm_nan(normal_c + k * 3, 3);
      if (status == GM_OK) {
        status = now;
        if (first_bad) *first_bad = k;
      }
    }
  }
  return status;
}
