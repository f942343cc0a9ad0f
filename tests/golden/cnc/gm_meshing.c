/* gm_meshing: generated, do not edit. */
#include "gm_meshing.h"
#include "gm_check.h"

#include <math.h>

#if defined(__GNUC__)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-parameter"
#pragma GCC diagnostic ignored "-Wunused-function"
#endif

#define casadi_real double
#define casadi_int int
#define CASADI_PREFIX(ID) gm_meshing_ ## ID
#define casadi_f0 CASADI_PREFIX(f0)

/* meshing:(u,beta,theta,settings[12],side)->(meshing_residual) */
static int casadi_f0(const casadi_real** arg, casadi_real** res, casadi_int* iw, casadi_real* w, int mem) {
  casadi_real a00, a01, a02, a03, a04, a05, a06, a07, a08, a09, a10, a11;
  casadi_real a12, a13, a14, a15, a16, a17, a18, a19, a20;
  a00=arg[1]? arg[1][0] : 0;
  a01=cos(a00);
  a02=arg[3]? arg[3][10] : 0;
  a03=arg[4]? arg[4][0] : 0;
  a04=arg[0]? arg[0][0] : 0;
  a05=(a03*a04);
  a06=arg[3]? arg[3][11] : 0;
  a07=tan(a06);
  a05=(a05*a07);
  a02=(a02+a05);
  a05=(a01*a02);
  a07=arg[3]? arg[3][1] : 0;
  a08=arg[2]? arg[2][0] : 0;
  a07=(a07+a08);
  a08=arg[3]? arg[3][3] : 0;
  a08=(a07+a08);
  a09=cos(a08);
  a10=(a05*a09);
  a11=arg[3]? arg[3][0] : 0;
  a12=cos(a07);
  a12=(a11*a12);
  a10=(a10+a12);
  a08=sin(a08);
  a12=arg[3]? arg[3][2] : 0;
  a13=sin(a12);
  a14=(a13*a04);
  a00=sin(a00);
  a02=(a02*a00);
  a12=cos(a12);
  a15=(a02*a12);
  a14=(a14+a15);
  a15=(a08*a14);
  a10=(a10-a15);
  a15=arg[3]? arg[3][8] : 0;
  a16=arg[3]? arg[3][7] : 0;
  a17=sin(a16);
  a16=cos(a16);
  a18=arg[3]? arg[3][6] : 0;
  a19=(a16*a18);
  a19=(a10+a19);
  a19=(a17*a19);
  a02=(a13*a02);
  a20=arg[3]? arg[3][5] : 0;
  a02=(a02-a20);
  a18=(a17*a18);
  a02=(a02+a18);
  a04=(a12*a04);
  a02=(a02-a04);
  a02=(a16*a02);
  a19=(a19-a02);
  a19=(a15*a19);
  a10=(a10-a19);
  a19=sin(a06);
  a02=(a19*a13);
  a06=cos(a06);
  a03=(a03*a06);
  a00=(a00*a03);
  a06=(a12*a00);
  a02=(a02-a06);
  a06=(a02*a09);
  a01=(a01*a03);
  a03=(a08*a01);
  a06=(a06-a03);
  a10=(a10*a06);
  a05=(a08*a05);
  a14=(a14*a09);
  a05=(a05+a14);
  a07=sin(a07);
  a11=(a11*a07);
  a05=(a05+a11);
  a11=arg[3]? arg[3][4] : 0;
  a11=(a05+a11);
  a17=(a17*a11);
  a17=(a17*a15);
  a17=(a17-a05);
  a08=(a08*a02);
  a01=(a01*a09);
  a08=(a08+a01);
  a17=(a17*a08);
  a10=(a10-a17);
  a16=(a16*a11);
  a16=(a16*a15);
  a19=(a19*a12);
  a13=(a13*a00);
  a19=(a19+a13);
  a16=(a16*a19);
  a10=(a10+a16);
  if (res[0]!=0) res[0][0]=a10;
  return 0;
}

#if defined(__GNUC__)
#pragma GCC diagnostic pop
#endif

static int gm_meshing_u_inside(const double *x)
{
  static const double low[1] = {-1.5000000000000002e-07};
  static const double high[1] = {150.00000015};
  return gm_inside(x, 1, low, high);
}
static int gm_meshing_beta_inside(const double *x)
{
  static const double low[1] = {-31.415926567313857};
  static const double high[1] = {31.415926567313857};
  return gm_inside(x, 1, low, high);
}
static int gm_meshing_theta_inside(const double *x)
{
  static const double low[1] = {-10.00000001};
  static const double high[1] = {10.00000001};
  return gm_inside(x, 1, low, high);
}
static int gm_meshing_settings_inside(const double *x)
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
static int gm_meshing_side_inside(const double *x)
{
  return x[0] == -1.0 || x[0] == 1.0;
}

static int gm_meshing_point(
    const double *u,
    const double *beta,
    const double *theta,
    const double *settings,
    const double *side,
    double *meshing_residual)
{
  const double *arg[5];
  double *res[1];
  arg[0] = u;
  arg[1] = beta;
  arg[2] = theta;
  arg[3] = settings;
  arg[4] = side;
  res[0] = meshing_residual;
  (void)casadi_f0(arg, res, 0, 0, 0);
  return gm_finite(meshing_residual, 1) ? GM_OK : GM_E_NO_RESULT;
}


int gm_meshing(
    double u,
    double beta,
    double theta,
    const double settings[12],
    double side,
    double *meshing_residual)
{
  int status = GM_E_DOMAIN;
  if (!settings || !meshing_residual) return GM_E_NULL;
  if (gm_meshing_u_inside(&u)
      && gm_meshing_beta_inside(&beta)
      && gm_meshing_theta_inside(&theta)
      && gm_meshing_settings_inside(settings)
      && gm_meshing_side_inside(&side)) {
    status = gm_meshing_point(&u, &beta, &theta, settings, &side, meshing_residual);
  }
  if (status != GM_OK) {
    gm_nan(meshing_residual, 1);
  }
  return status;
}

int gm_meshing_batch(
    int64_t n,
    const double *u, int64_t u_stride,
    const double *beta, int64_t beta_stride,
    const double *theta, int64_t theta_stride,
    const double *settings, int64_t settings_stride,
    const double *side, int64_t side_stride,
    double *meshing_residual,
    int64_t *first_bad)
{
  int status = GM_OK, shared;
  int64_t k;
  if (first_bad) *first_bad = -1;
  if (n < 0 || u_stride < 0 || beta_stride < 0 || theta_stride < 0 || settings_stride < 0 || side_stride < 0) return GM_E_SIZE;
  if (n == 0) return GM_OK;
  if (!u || !beta || !theta || !settings || !side || !meshing_residual) return GM_E_NULL;
  shared = (u_stride != 0 || gm_meshing_u_inside(u))
      && (beta_stride != 0 || gm_meshing_beta_inside(beta))
      && (theta_stride != 0 || gm_meshing_theta_inside(theta))
      && (settings_stride != 0 || gm_meshing_settings_inside(settings))
      && (side_stride != 0 || gm_meshing_side_inside(side));
  for (k = 0; k < n; ++k) {
    int now = GM_E_DOMAIN;
    if (shared
        && (u_stride == 0 || gm_meshing_u_inside(u + k * u_stride))
        && (beta_stride == 0 || gm_meshing_beta_inside(beta + k * beta_stride))
        && (theta_stride == 0 || gm_meshing_theta_inside(theta + k * theta_stride))
        && (settings_stride == 0 || gm_meshing_settings_inside(settings + k * settings_stride))
        && (side_stride == 0 || gm_meshing_side_inside(side + k * side_stride))) {
      now = gm_meshing_point(
          u + k * u_stride,
          beta + k * beta_stride,
          theta + k * theta_stride,
          settings + k * settings_stride,
          side + k * side_stride,
          meshing_residual + k);
    }
    if (now != GM_OK) {
      gm_nan(meshing_residual + k, 1);
      if (status == GM_OK) {
        status = now;
        if (first_bad) *first_bad = k;
      }
    }
  }
  return status;
}
