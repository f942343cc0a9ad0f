/* gm_flank_family: generated, do not edit. */
#include "gm_flank_family.h"
#include "gm_check.h"

#include <math.h>

#if defined(__GNUC__)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-parameter"
#pragma GCC diagnostic ignored "-Wunused-function"
#endif

#define casadi_real double
#define casadi_int int
#define CASADI_PREFIX(ID) gm_flank_family_ ## ID
#define casadi_f0 CASADI_PREFIX(f0)

/* flank_family:(u,beta,theta,settings[12],side)->(point_w[3],normal_w[3]) */
static int casadi_f0(const casadi_real** arg, casadi_real** res, casadi_int* iw, casadi_real* w, int mem) {
  casadi_real a00, a01, a02, a03, a04, a05, a06, a07, a08, a09, a10, a11;
  casadi_real a12, a13, a14, a15, a16, a17, a18, a19, a20;
  a00=arg[3]? arg[3][7] : 0;
  a01=sin(a00);
  a02=arg[3]? arg[3][1] : 0;
  a03=arg[2]? arg[2][0] : 0;
  a02=(a02+a03);
  a04=arg[3]? arg[3][3] : 0;
  a04=(a02+a04);
  a05=cos(a04);
  a06=arg[1]? arg[1][0] : 0;
  a07=cos(a06);
  a08=arg[3]? arg[3][10] : 0;
  a09=arg[4]? arg[4][0] : 0;
  a10=arg[0]? arg[0][0] : 0;
  a11=(a09*a10);
  a12=arg[3]? arg[3][11] : 0;
  a13=tan(a12);
  a11=(a11*a13);
  a08=(a08+a11);
  a11=(a07*a08);
  a13=(a05*a11);
  a00=cos(a00);
  a14=arg[3]? arg[3][6] : 0;
  a15=(a00*a14);
  a13=(a13+a15);
  a15=arg[3]? arg[3][0] : 0;
  a16=cos(a02);
  a16=(a15*a16);
  a13=(a13+a16);
  a04=sin(a04);
  a16=arg[3]? arg[3][2] : 0;
  a17=cos(a16);
  a06=sin(a06);
  a08=(a08*a06);
  a18=(a17*a08);
  a16=sin(a16);
  a19=(a16*a10);
  a18=(a18+a19);
  a19=(a04*a18);
  a13=(a13-a19);
  a19=(a01*a13);
  a14=(a01*a14);
  a20=arg[3]? arg[3][5] : 0;
  a14=(a14-a20);
  a08=(a16*a08);
  a14=(a14+a08);
  a10=(a17*a10);
  a14=(a14-a10);
  a10=(a14*a00);
  a19=(a19-a10);
  a10=arg[3]? arg[3][9] : 0;
  a08=arg[3]? arg[3][8] : 0;
  a08=(a08*a03);
  a10=(a10+a08);
  a08=cos(a10);
  a03=(a19*a08);
  a20=arg[3]? arg[3][4] : 0;
  a11=(a04*a11);
  a20=(a20+a11);
  a18=(a05*a18);
  a20=(a20+a18);
  a02=sin(a02);
  a15=(a15*a02);
  a20=(a20+a15);
  a10=sin(a10);
  a15=(a20*a10);
  a03=(a03+a15);
  if (res[0]!=0) res[0][0]=a03;
  a20=(a08*a20);
  a19=(a19*a10);
  a20=(a20-a19);
  if (res[0]!=0) res[0][1]=a20;
  a14=(a01*a14);
  a13=(a13*a00);
  a14=(a14+a13);
  if (res[0]!=0) res[0][2]=a14;
  a14=sin(a12);
  a13=(a17*a14);
  a12=cos(a12);
  a09=(a09*a12);
  a06=(a09*a06);
  a12=(a16*a06);
  a13=(a13+a12);
  a12=(a13*a00);
  a16=(a16*a14);
  a17=(a17*a06);
  a16=(a16-a17);
  a17=(a04*a16);
  a07=(a07*a09);
  a09=(a05*a07);
  a17=(a17+a09);
  a09=(a01*a17);
  a12=(a12-a09);
  a09=(a08*a12);
  a05=(a05*a16);
  a04=(a04*a07);
  a05=(a05-a04);
  a04=(a10*a05);
  a09=(a09+a04);
  if (res[1]!=0) res[1][0]=a09;
  a08=(a08*a05);
  a10=(a10*a12);
  a08=(a08-a10);
  if (res[1]!=0) res[1][1]=a08;
  a01=(a01*a13);
  a17=(a17*a00);
  a01=(a01+a17);
  a01=(-a01);
  if (res[1]!=0) res[1][2]=a01;
  return 0;
}

#if defined(__GNUC__)
#pragma GCC diagnostic pop
#endif

static int gm_flank_family_u_inside(const double *x)
{
  static const double low[1] = {-1.5000000000000002e-07};
  static const double high[1] = {150.00000015};
  return gm_inside(x, 1, low, high);
}
static int gm_flank_family_beta_inside(const double *x)
{
  static const double low[1] = {-31.415926567313857};
  static const double high[1] = {31.415926567313857};
  return gm_inside(x, 1, low, high);
}
static int gm_flank_family_theta_inside(const double *x)
{
  static const double low[1] = {-10.00000001};
  static const double high[1] = {10.00000001};
  return gm_inside(x, 1, low, high);
}
static int gm_flank_family_settings_inside(const double *x)
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
static int gm_flank_family_side_inside(const double *x)
{
  return x[0] == -1.0 || x[0] == 1.0;
}

static int gm_flank_family_point(
    const double *u,
    const double *beta,
    const double *theta,
    const double *settings,
    const double *side,
    double *point_w,
    double *normal_w)
{
  const double *arg[5];
  double *res[2];
  arg[0] = u;
  arg[1] = beta;
  arg[2] = theta;
  arg[3] = settings;
  arg[4] = side;
  res[0] = point_w;
  res[1] = normal_w;
  (void)casadi_f0(arg, res, 0, 0, 0);
  return gm_finite(point_w, 3) && gm_finite(normal_w, 3) ? GM_OK : GM_E_NO_RESULT;
}


int gm_flank_family(
    double u,
    double beta,
    double theta,
    const double settings[12],
    double side,
    double point_w[3],
    double normal_w[3])
{
  int status = GM_E_DOMAIN;
  if (!settings || !point_w || !normal_w) return GM_E_NULL;
  if (gm_flank_family_u_inside(&u)
      && gm_flank_family_beta_inside(&beta)
      && gm_flank_family_theta_inside(&theta)
      && gm_flank_family_settings_inside(settings)
      && gm_flank_family_side_inside(&side)) {
    status = gm_flank_family_point(&u, &beta, &theta, settings, &side, point_w, normal_w);
  }
  if (status != GM_OK) {
    gm_nan(point_w, 3);
    gm_nan(normal_w, 3);
  }
  return status;
}

int gm_flank_family_batch(
    int64_t n,
    const double *u, int64_t u_stride,
    const double *beta, int64_t beta_stride,
    const double *theta, int64_t theta_stride,
    const double *settings, int64_t settings_stride,
    const double *side, int64_t side_stride,
    double *point_w,
    double *normal_w,
    int64_t *first_bad)
{
  int status = GM_OK, shared;
  int64_t k;
  if (first_bad) *first_bad = -1;
  if (n < 0 || u_stride < 0 || beta_stride < 0 || theta_stride < 0 || settings_stride < 0 || side_stride < 0) return GM_E_SIZE;
  if (n == 0) return GM_OK;
  if (!u || !beta || !theta || !settings || !side || !point_w || !normal_w) return GM_E_NULL;
  shared = (u_stride != 0 || gm_flank_family_u_inside(u))
      && (beta_stride != 0 || gm_flank_family_beta_inside(beta))
      && (theta_stride != 0 || gm_flank_family_theta_inside(theta))
      && (settings_stride != 0 || gm_flank_family_settings_inside(settings))
      && (side_stride != 0 || gm_flank_family_side_inside(side));
  for (k = 0; k < n; ++k) {
    int now = GM_E_DOMAIN;
    if (shared
        && (u_stride == 0 || gm_flank_family_u_inside(u + k * u_stride))
        && (beta_stride == 0 || gm_flank_family_beta_inside(beta + k * beta_stride))
        && (theta_stride == 0 || gm_flank_family_theta_inside(theta + k * theta_stride))
        && (settings_stride == 0 || gm_flank_family_settings_inside(settings + k * settings_stride))
        && (side_stride == 0 || gm_flank_family_side_inside(side + k * side_stride))) {
      now = gm_flank_family_point(
          u + k * u_stride,
          beta + k * beta_stride,
          theta + k * theta_stride,
          settings + k * settings_stride,
          side + k * side_stride,
          point_w + k * 3,
          normal_w + k * 3);
    }
    if (now != GM_OK) {
      gm_nan(point_w + k * 3, 3);
      gm_nan(normal_w + k * 3, 3);
      if (status == GM_OK) {
        status = now;
        if (first_bad) *first_bad = k;
      }
    }
  }
  return status;
}
