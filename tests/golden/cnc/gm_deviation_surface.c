/* gm_deviation_surface: generated, do not edit. */
#include "gm_deviation_surface.h"
#include "gm_check.h"

#include <math.h>

#if defined(__GNUC__)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-parameter"
#pragma GCC diagnostic ignored "-Wunused-function"
#endif

#define casadi_real double
#define casadi_int int
#define CASADI_PREFIX(ID) gm_deviation_surface_ ## ID
#define casadi_f0 CASADI_PREFIX(f0)
#define casadi_sq CASADI_PREFIX(sq)

static casadi_real casadi_sq(casadi_real x) { return x*x;}

/* deviation_surface:(lengthwise,profilewise,surface_coefficients[10])->(surface_deviation,monomials[10]) */
static int casadi_f0(const casadi_real** arg, casadi_real** res, casadi_int* iw, casadi_real* w, int mem) {
  casadi_real a00, a01, a02, a03, a04, a05, a06, a07, a08, a09, a10;
  a00=arg[2]? arg[2][0] : 0;
  a01=arg[0]? arg[0][0] : 0;
  a02=casadi_sq(a01);
  a03=arg[2]? arg[2][3] : 0;
  a03=(a02*a03);
  a00=(a00+a03);
  a03=arg[1]? arg[1][0] : 0;
  a04=casadi_sq(a03);
  a05=arg[2]? arg[2][5] : 0;
  a05=(a04*a05);
  a00=(a00+a05);
  a05=casadi_sq(a01);
  a05=(a01*a05);
  a06=arg[2]? arg[2][6] : 0;
  a06=(a05*a06);
  a00=(a00+a06);
  a06=casadi_sq(a03);
  a06=(a03*a06);
  a07=arg[2]? arg[2][9] : 0;
  a07=(a06*a07);
  a00=(a00+a07);
  a07=(a01*a03);
  a08=arg[2]? arg[2][4] : 0;
  a08=(a07*a08);
  a00=(a00+a08);
  a08=(a04*a01);
  a09=arg[2]? arg[2][8] : 0;
  a09=(a08*a09);
  a00=(a00+a09);
  a09=(a02*a03);
  a10=arg[2]? arg[2][7] : 0;
  a10=(a09*a10);
  a00=(a00+a10);
  a10=arg[2]? arg[2][1] : 0;
  a10=(a01*a10);
  a00=(a00+a10);
  a10=arg[2]? arg[2][2] : 0;
  a10=(a03*a10);
  a00=(a00+a10);
  if (res[0]!=0) res[0][0]=a00;
  a00=1.;
  if (res[1]!=0) res[1][0]=a00;
  if (res[1]!=0) res[1][1]=a01;
  if (res[1]!=0) res[1][2]=a03;
  if (res[1]!=0) res[1][3]=a02;
  if (res[1]!=0) res[1][4]=a07;
  if (res[1]!=0) res[1][5]=a04;
  if (res[1]!=0) res[1][6]=a05;
  if (res[1]!=0) res[1][7]=a09;
  if (res[1]!=0) res[1][8]=a08;
  if (res[1]!=0) res[1][9]=a06;
  return 0;
}

#if defined(__GNUC__)
#pragma GCC diagnostic pop
#endif

static int gm_deviation_surface_lengthwise_inside(const double *x)
{
  static const double low[1] = {-500.0000005};
  static const double high[1] = {500.0000005};
  return gm_inside(x, 1, low, high);
}
static int gm_deviation_surface_profilewise_inside(const double *x)
{
  static const double low[1] = {-200.0000002};
  static const double high[1] = {200.0000002};
  return gm_inside(x, 1, low, high);
}
static int gm_deviation_surface_surface_coefficients_inside(const double *x)
{
  static const double low[10] = {
    -10.00000001,
    -10.00000001,
    -10.00000001,
    -10.00000001,
    -10.00000001,
    -10.00000001,
    -10.00000001,
    -10.00000001,
    -10.00000001,
    -10.00000001};
  static const double high[10] = {
    10.00000001,
    10.00000001,
    10.00000001,
    10.00000001,
    10.00000001,
    10.00000001,
    10.00000001,
    10.00000001,
    10.00000001,
    10.00000001};
  return gm_inside(x, 10, low, high);
}

static int gm_deviation_surface_point(
    const double *lengthwise,
    const double *profilewise,
    const double *surface_coefficients,
    double *surface_deviation,
    double *monomials)
{
  const double *arg[3];
  double *res[2];
  arg[0] = lengthwise;
  arg[1] = profilewise;
  arg[2] = surface_coefficients;
  res[0] = surface_deviation;
  res[1] = monomials;
  (void)casadi_f0(arg, res, 0, 0, 0);
  return gm_finite(surface_deviation, 1) && gm_finite(monomials, 10) ? GM_OK : GM_E_NO_RESULT;
}


int gm_deviation_surface(
    double lengthwise,
    double profilewise,
    const double surface_coefficients[10],
    double *surface_deviation,
    double monomials[10])
{
  int status = GM_E_DOMAIN;
  if (!surface_coefficients || !surface_deviation || !monomials) return GM_E_NULL;
  if (gm_deviation_surface_lengthwise_inside(&lengthwise)
      && gm_deviation_surface_profilewise_inside(&profilewise)
      && gm_deviation_surface_surface_coefficients_inside(surface_coefficients)) {
    status = gm_deviation_surface_point(
        &lengthwise,
        &profilewise,
        surface_coefficients,
        surface_deviation,
        monomials);
  }
  if (status != GM_OK) {
    gm_nan(surface_deviation, 1);
    gm_nan(monomials, 10);
  }
  return status;
}

int gm_deviation_surface_batch(
    int64_t n,
    const double *lengthwise, int64_t lengthwise_stride,
    const double *profilewise, int64_t profilewise_stride,
    const double *surface_coefficients, int64_t surface_coefficients_stride,
    double *surface_deviation,
    double *monomials,
    int64_t *first_bad)
{
  int status = GM_OK, shared;
  int64_t k;
  if (first_bad) *first_bad = -1;
  if (n < 0 || lengthwise_stride < 0 || profilewise_stride < 0 || surface_coefficients_stride < 0) return GM_E_SIZE;
  if (n == 0) return GM_OK;
  if (!lengthwise || !profilewise || !surface_coefficients || !surface_deviation || !monomials) return GM_E_NULL;
  shared = (lengthwise_stride != 0 || gm_deviation_surface_lengthwise_inside(lengthwise))
      && (profilewise_stride != 0 || gm_deviation_surface_profilewise_inside(profilewise))
      && (surface_coefficients_stride != 0 || gm_deviation_surface_surface_coefficients_inside(surface_coefficients));
  for (k = 0; k < n; ++k) {
    int now = GM_E_DOMAIN;
    if (shared
        && (lengthwise_stride == 0 || gm_deviation_surface_lengthwise_inside(lengthwise + k * lengthwise_stride))
        && (profilewise_stride == 0 || gm_deviation_surface_profilewise_inside(profilewise + k * profilewise_stride))
        && (surface_coefficients_stride == 0 || gm_deviation_surface_surface_coefficients_inside(surface_coefficients + k * surface_coefficients_stride))) {
      now = gm_deviation_surface_point(
          lengthwise + k * lengthwise_stride,
          profilewise + k * profilewise_stride,
          surface_coefficients + k * surface_coefficients_stride,
          surface_deviation + k,
          monomials + k * 10);
    }
    if (now != GM_OK) {
      gm_nan(surface_deviation + k, 1);
      gm_nan(monomials + k * 10, 10);
      if (status == GM_OK) {
        status = now;
        if (first_bad) *first_bad = k;
      }
    }
  }
  return status;
}
