/* gm_setting_sensitivity: generated, do not edit. */
#include "gm_setting_sensitivity.h"
#include "gm_check.h"

#include <math.h>

#if defined(__GNUC__)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-parameter"
#pragma GCC diagnostic ignored "-Wunused-function"
#endif

#define casadi_real double
#define casadi_int int
#define CASADI_PREFIX(ID) gm_setting_sensitivity_ ## ID
#define casadi_f0 CASADI_PREFIX(f0)
#define casadi_sq CASADI_PREFIX(sq)

static casadi_real casadi_sq(casadi_real x) { return x*x;}

/* setting_sensitivity:(u,beta,theta,settings[12],side)->(sensitivity[12]) */
static int casadi_f0(const casadi_real** arg, casadi_real** res, casadi_int* iw, casadi_real* w, int mem) {
  casadi_real a00, a01, a02, a03, a04, a05, a06, a07, a08, a09, a10, a11;
  casadi_real a12, a13, a14, a15, a16, a17, a18, a19, a20, a21, a22, a23;
  casadi_real a24, a25, a26, a27, a28, a29, a30, a31, a32;
  a00=arg[3]? arg[3][1] : 0;
  a01=arg[2]? arg[2][0] : 0;
  a00=(a00+a01);
  a02=arg[3]? arg[3][3] : 0;
  a02=(a00+a02);
  a03=cos(a02);
  a04=arg[3]? arg[3][11] : 0;
  a05=sin(a04);
  a06=arg[3]? arg[3][2] : 0;
  a07=sin(a06);
  a08=(a05*a07);
  a09=arg[4]? arg[4][0] : 0;
  a10=cos(a04);
  a10=(a09*a10);
  a06=cos(a06);
  a11=arg[1]? arg[1][0] : 0;
  a12=sin(a11);
  a13=(a06*a12);
  a14=(a10*a13);
  a08=(a08-a14);
  a14=(a03*a08);
  a02=sin(a02);
  a11=cos(a11);
  a15=(a02*a11);
  a16=(a15*a10);
  a14=(a14-a16);
  a16=arg[3]? arg[3][9] : 0;
  a17=arg[3]? arg[3][8] : 0;
  a17=(a17*a01);
  a16=(a16+a17);
  a17=cos(a16);
  a18=(a14*a17);
  a05=(a06*a05);
  a19=(a07*a12);
  a20=(a19*a10);
  a05=(a05+a20);
  a20=arg[3]? arg[3][7] : 0;
  a21=cos(a20);
  a22=(a05*a21);
  a08=(a02*a08);
  a23=(a11*a03);
  a10=(a23*a10);
  a08=(a08+a10);
  a20=sin(a20);
  a10=(a08*a20);
  a22=(a22-a10);
  a16=sin(a16);
  a10=(a22*a16);
  a18=(a18-a10);
  a10=sin(a00);
  a24=(a17*a10);
  a00=cos(a00);
  a25=(a20*a00);
  a26=(a16*a25);
  a24=(a24-a26);
  a24=(a18*a24);
  a08=(a08*a21);
  a05=(a20*a05);
  a08=(a08+a05);
  a05=(a08*a21);
  a26=(a00*a05);
  a24=(a24-a26);
  a22=(a22*a17);
  a14=(a16*a14);
  a22=(a22+a14);
  a14=(a16*a10);
  a25=(a17*a25);
  a14=(a14+a25);
  a14=(a22*a14);
  a24=(a24+a14);
  if (res[0]!=0) res[0][0]=a24;
  a24=arg[3]? arg[3][10] : 0;
  a04=tan(a04);
  a14=arg[0]? arg[0][0] : 0;
  a25=(a09*a14);
  a26=(a04*a25);
  a24=(a24+a26);
  a23=(a23*a24);
  a26=(a07*a14);
  a27=(a12*a24);
  a28=(a06*a27);
  a28=(a26+a28);
  a29=(a02*a28);
  a23=(a23-a29);
  a29=arg[3]? arg[3][0] : 0;
  a00=(a00*a29);
  a00=(a23+a00);
  a30=(a17*a00);
  a31=(a03*a28);
  a24=(a15*a24);
  a31=(a31+a24);
  a10=(a10*a29);
  a10=(a31+a10);
  a29=(a20*a10);
  a24=(a16*a29);
  a30=(a30+a24);
  a30=(a18*a30);
  a24=(a16*a00);
  a29=(a17*a29);
  a24=(a24-a29);
  a24=(a22*a24);
  a30=(a30+a24);
  a24=(a05*a10);
  a30=(a30+a24);
  if (res[0]!=0) res[0][1]=a30;
  a06=(a06*a14);
  a07=(a07*a27);
  a27=(a06-a07);
  a30=(a03*a27);
  a24=(a17*a30);
  a27=(a02*a27);
  a29=(a20*a27);
  a32=(a28*a21);
  a29=(a29+a32);
  a32=(a16*a29);
  a24=(a24+a32);
  a24=(a18*a24);
  a30=(a16*a30);
  a29=(a17*a29);
  a30=(a30-a29);
  a30=(a22*a30);
  a24=(a24+a30);
  a28=(a20*a28);
  a27=(a27*a21);
  a28=(a28-a27);
  a28=(a08*a28);
  a24=(a24-a28);
  if (res[0]!=0) res[0][2]=a24;
  a24=(a17*a23);
  a28=(a20*a31);
  a27=(a16*a28);
  a24=(a24+a27);
  a24=(a18*a24);
  a23=(a16*a23);
  a28=(a17*a28);
  a23=(a23-a28);
  a23=(a22*a23);
  a24=(a24+a23);
  a05=(a05*a31);
  a24=(a24+a05);
  if (res[0]!=0) res[0][3]=a24;
  a24=(a16*a22);
  a05=(a17*a18);
  a24=(a24+a05);
  if (res[0]!=0) res[0][4]=a24;
  a24=(a20*a08);
  a05=(a16*a18);
  a31=(a05*a21);
  a24=(a24-a31);
  a31=(a17*a22);
  a31=(a31*a21);
  a24=(a24+a31);
  if (res[0]!=0) res[0][5]=a24;
  a24=(-a08);
  if (res[0]!=0) res[0][6]=a24;
  a24=(a17*a22);
  a07=(a07-a06);
  a31=arg[3]? arg[3][5] : 0;
  a07=(a07-a31);
  a31=arg[3]? arg[3][6] : 0;
  a23=(a20*a31);
  a07=(a07+a23);
  a23=(a20*a07);
  a28=(a21*a31);
  a00=(a00+a28);
  a28=(a00*a21);
  a23=(a23+a28);
  a28=casadi_sq(a21);
  a28=(a28*a31);
  a23=(a23-a28);
  a28=casadi_sq(a20);
  a28=(a28*a31);
  a23=(a23-a28);
  a24=(a24*a23);
  a07=(a07*a21);
  a00=(a20*a00);
  a07=(a07-a00);
  a00=(a08*a07);
  a05=(a05*a23);
  a00=(a00+a05);
  a24=(a24-a00);
  if (res[0]!=0) res[0][7]=a24;
  a24=(a17*a07);
  a00=(a24*a01);
  a05=arg[3]? arg[3][4] : 0;
  a10=(a10+a05);
  a05=(a16*a10);
  a23=(a05*a01);
  a00=(a00-a23);
  a00=(a18*a00);
  a07=(a16*a07);
  a23=(a07*a01);
  a28=(a17*a10);
  a28=(a28*a01);
  a23=(a23+a28);
  a23=(a22*a23);
  a00=(a00+a23);
  if (res[0]!=0) res[0][8]=a00;
  a24=(a24-a05);
  a24=(a18*a24);
  a10=(a17*a10);
  a07=(a07+a10);
  a07=(a22*a07);
  a24=(a24+a07);
  if (res[0]!=0) res[0][9]=a24;
  a24=(a03*a13);
  a24=(a15+a24);
  a07=(a17*a24);
  a10=(a11*a03);
  a13=(a02*a13);
  a10=(a10-a13);
  a13=(a20*a10);
  a05=(a19*a21);
  a13=(a13-a05);
  a05=(a16*a13);
  a07=(a07-a05);
  a07=(a18*a07);
  a24=(a16*a24);
  a13=(a17*a13);
  a24=(a24+a13);
  a24=(a22*a24);
  a07=(a07+a24);
  a19=(a20*a19);
  a10=(a10*a21);
  a19=(a19+a10);
  a19=(a08*a19);
  a07=(a07-a19);
  if (res[0]!=0) res[0][10]=a07;
  a07=1.;
  a04=casadi_sq(a04);
  a07=(a07+a04);
  a12=(a12*a07);
  a12=(a12*a09);
  a06=(a06*a12);
  a04=(a03*a06);
  a15=(a15*a25);
  a15=(a15*a07);
  a04=(a04+a15);
  a15=(a17*a04);
  a11=(a11*a03);
  a11=(a11*a07);
  a11=(a11*a09);
  a11=(a11*a14);
  a02=(a02*a06);
  a11=(a11-a02);
  a02=(a20*a11);
  a26=(a26*a12);
  a12=(a21*a26);
  a02=(a02-a12);
  a12=(a16*a02);
  a15=(a15-a12);
  a18=(a18*a15);
  a16=(a16*a04);
  a17=(a17*a02);
  a16=(a16+a17);
  a22=(a22*a16);
  a18=(a18+a22);
  a20=(a20*a26);
  a11=(a11*a21);
  a20=(a20+a11);
  a08=(a08*a20);
  a18=(a18-a08);
  if (res[0]!=0) res[0][11]=a18;
  return 0;
}

#if defined(__GNUC__)
#pragma GCC diagnostic pop
#endif

static int gm_setting_sensitivity_u_inside(const double *x)
{
  static const double low[1] = {-1.5000000000000002e-07};
  static const double high[1] = {150.00000015};
  return gm_inside(x, 1, low, high);
}
static int gm_setting_sensitivity_beta_inside(const double *x)
{
  static const double low[1] = {-31.415926567313857};
  static const double high[1] = {31.415926567313857};
  return gm_inside(x, 1, low, high);
}
static int gm_setting_sensitivity_theta_inside(const double *x)
{
  static const double low[1] = {-10.00000001};
  static const double high[1] = {10.00000001};
  return gm_inside(x, 1, low, high);
}
static int gm_setting_sensitivity_settings_inside(const double *x)
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
static int gm_setting_sensitivity_side_inside(const double *x)
{
  return x[0] == -1.0 || x[0] == 1.0;
}

static int gm_setting_sensitivity_point(
    const double *u,
    const double *beta,
    const double *theta,
    const double *settings,
    const double *side,
    double *sensitivity)
{
  const double *arg[5];
  double *res[1];
  arg[0] = u;
  arg[1] = beta;
  arg[2] = theta;
  arg[3] = settings;
  arg[4] = side;
  res[0] = sensitivity;
  (void)casadi_f0(arg, res, 0, 0, 0);
  return gm_finite(sensitivity, 12) ? GM_OK : GM_E_NO_RESULT;
}


int gm_setting_sensitivity(
    double u,
    double beta,
    double theta,
    const double settings[12],
    double side,
    double sensitivity[12])
{
  int status = GM_E_DOMAIN;
  if (!settings || !sensitivity) return GM_E_NULL;
  if (gm_setting_sensitivity_u_inside(&u)
      && gm_setting_sensitivity_beta_inside(&beta)
      && gm_setting_sensitivity_theta_inside(&theta)
      && gm_setting_sensitivity_settings_inside(settings)
      && gm_setting_sensitivity_side_inside(&side)) {
    status = gm_setting_sensitivity_point(&u, &beta, &theta, settings, &side, sensitivity);
  }
  if (status != GM_OK) {
    gm_nan(sensitivity, 12);
  }
  return status;
}

int gm_setting_sensitivity_batch(
    int64_t n,
    const double *u, int64_t u_stride,
    const double *beta, int64_t beta_stride,
    const double *theta, int64_t theta_stride,
    const double *settings, int64_t settings_stride,
    const double *side, int64_t side_stride,
    double *sensitivity,
    int64_t *first_bad)
{
  int status = GM_OK, shared;
  int64_t k;
  if (first_bad) *first_bad = -1;
  if (n < 0 || u_stride < 0 || beta_stride < 0 || theta_stride < 0 || settings_stride < 0 || side_stride < 0) return GM_E_SIZE;
  if (n == 0) return GM_OK;
  if (!u || !beta || !theta || !settings || !side || !sensitivity) return GM_E_NULL;
  shared = (u_stride != 0 || gm_setting_sensitivity_u_inside(u))
      && (beta_stride != 0 || gm_setting_sensitivity_beta_inside(beta))
      && (theta_stride != 0 || gm_setting_sensitivity_theta_inside(theta))
      && (settings_stride != 0 || gm_setting_sensitivity_settings_inside(settings))
      && (side_stride != 0 || gm_setting_sensitivity_side_inside(side));
  for (k = 0; k < n; ++k) {
    int now = GM_E_DOMAIN;
    if (shared
        && (u_stride == 0 || gm_setting_sensitivity_u_inside(u + k * u_stride))
        && (beta_stride == 0 || gm_setting_sensitivity_beta_inside(beta + k * beta_stride))
        && (theta_stride == 0 || gm_setting_sensitivity_theta_inside(theta + k * theta_stride))
        && (settings_stride == 0 || gm_setting_sensitivity_settings_inside(settings + k * settings_stride))
        && (side_stride == 0 || gm_setting_sensitivity_side_inside(side + k * side_stride))) {
      now = gm_setting_sensitivity_point(
          u + k * u_stride,
          beta + k * beta_stride,
          theta + k * theta_stride,
          settings + k * settings_stride,
          side + k * side_stride,
          sensitivity + k * 12);
    }
    if (now != GM_OK) {
      gm_nan(sensitivity + k * 12, 12);
      if (status == GM_OK) {
        status = now;
        if (first_bad) *first_bad = k;
      }
    }
  }
  return status;
}
