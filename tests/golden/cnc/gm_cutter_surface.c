/* gm_cutter_surface: generated, do not edit. */
#include "gm_cutter_surface.h"

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

void gm_cutter_surface(
    double u,
    double beta,
    double blade_point_radius,
    double blade_pressure_angle,
    double side,
    double point_c[3],
    double normal_c[3])
{
  const double *arg[5];
  double *res[2];
  arg[0] = &u;
  arg[1] = &beta;
  arg[2] = &blade_point_radius;
  arg[3] = &blade_pressure_angle;
  arg[4] = &side;
  res[0] = point_c;
  res[1] = normal_c;
  (void)casadi_f0(arg, res, 0, 0, 0);
}

void gm_cutter_surface_batch(
    long n,
    const double *u, long u_stride,
    const double *beta, long beta_stride,
    const double *blade_point_radius, long blade_point_radius_stride,
    const double *blade_pressure_angle, long blade_pressure_angle_stride,
    const double *side, long side_stride,
    double *point_c,
    double *normal_c)
{
  long k;
  for (k = 0; k < n; ++k) {
    gm_cutter_surface(
        u[k * u_stride],
        beta[k * beta_stride],
        blade_point_radius[k * blade_point_radius_stride],
        blade_pressure_angle[k * blade_pressure_angle_stride],
        side[k * side_stride],
        point_c + k * 3,
        normal_c + k * 3);
  }
}
