/* gm_moved_settings: generated, do not edit. */
#include "gm_moved_settings.h"
#include "gm_check.h"

#include <math.h>

#if defined(__GNUC__)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-parameter"
#pragma GCC diagnostic ignored "-Wunused-function"
#endif

#define casadi_real double
#define casadi_int int
#define CASADI_PREFIX(ID) gm_moved_settings_ ## ID
#define casadi_f0 CASADI_PREFIX(f0)

/* moved_settings:(settings[12],motion[10x7],theta)->(settings_at[12]) */
static int casadi_f0(const casadi_real** arg, casadi_real** res, casadi_int* iw, casadi_real* w, int mem) {
  casadi_real a0, a1, a2, a3, a4, a5, a6, a7, a8;
  a0=arg[0]? arg[0][0] : 0;
  a1=arg[2]? arg[2][0] : 0;
  a2=arg[1]? arg[1][0] : 0;
  a3=arg[1]? arg[1][10] : 0;
  a4=arg[1]? arg[1][20] : 0;
  a5=arg[1]? arg[1][30] : 0;
  a6=arg[1]? arg[1][40] : 0;
  a7=arg[1]? arg[1][50] : 0;
  a8=arg[1]? arg[1][60] : 0;
  a8=(a8*a1);
  a7=(a7+a8);
  a7=(a1*a7);
  a6=(a6+a7);
  a6=(a1*a6);
  a5=(a5+a6);
  a5=(a1*a5);
  a4=(a4+a5);
  a4=(a1*a4);
  a3=(a3+a4);
  a3=(a1*a3);
  a2=(a2+a3);
  a2=(a1*a2);
  a0=(a0+a2);
  if (res[0]!=0) res[0][0]=a0;
  a0=arg[0]? arg[0][1] : 0;
  a2=arg[1]? arg[1][1] : 0;
  a3=arg[1]? arg[1][11] : 0;
  a4=arg[1]? arg[1][21] : 0;
  a5=arg[1]? arg[1][31] : 0;
  a6=arg[1]? arg[1][41] : 0;
  a7=arg[1]? arg[1][51] : 0;
  a8=arg[1]? arg[1][61] : 0;
  a8=(a8*a1);
  a7=(a7+a8);
  a7=(a1*a7);
  a6=(a6+a7);
  a6=(a1*a6);
  a5=(a5+a6);
  a5=(a1*a5);
  a4=(a4+a5);
  a4=(a1*a4);
  a3=(a3+a4);
  a3=(a1*a3);
  a2=(a2+a3);
  a2=(a1*a2);
  a0=(a0+a2);
  if (res[0]!=0) res[0][1]=a0;
  a0=arg[0]? arg[0][2] : 0;
  a2=arg[1]? arg[1][2] : 0;
  a3=arg[1]? arg[1][12] : 0;
  a4=arg[1]? arg[1][22] : 0;
  a5=arg[1]? arg[1][32] : 0;
  a6=arg[1]? arg[1][42] : 0;
  a7=arg[1]? arg[1][52] : 0;
  a8=arg[1]? arg[1][62] : 0;
  a8=(a8*a1);
  a7=(a7+a8);
  a7=(a1*a7);
  a6=(a6+a7);
  a6=(a1*a6);
  a5=(a5+a6);
  a5=(a1*a5);
  a4=(a4+a5);
  a4=(a1*a4);
  a3=(a3+a4);
  a3=(a1*a3);
  a2=(a2+a3);
  a2=(a1*a2);
  a0=(a0+a2);
  if (res[0]!=0) res[0][2]=a0;
  a0=arg[0]? arg[0][3] : 0;
  a2=arg[1]? arg[1][3] : 0;
  a3=arg[1]? arg[1][13] : 0;
  a4=arg[1]? arg[1][23] : 0;
  a5=arg[1]? arg[1][33] : 0;
  a6=arg[1]? arg[1][43] : 0;
  a7=arg[1]? arg[1][53] : 0;
  a8=arg[1]? arg[1][63] : 0;
  a8=(a8*a1);
  a7=(a7+a8);
  a7=(a1*a7);
  a6=(a6+a7);
  a6=(a1*a6);
  a5=(a5+a6);
  a5=(a1*a5);
  a4=(a4+a5);
  a4=(a1*a4);
  a3=(a3+a4);
  a3=(a1*a3);
  a2=(a2+a3);
  a2=(a1*a2);
  a0=(a0+a2);
  if (res[0]!=0) res[0][3]=a0;
  a0=arg[0]? arg[0][4] : 0;
  a2=arg[1]? arg[1][4] : 0;
  a3=arg[1]? arg[1][14] : 0;
  a4=arg[1]? arg[1][24] : 0;
  a5=arg[1]? arg[1][34] : 0;
  a6=arg[1]? arg[1][44] : 0;
  a7=arg[1]? arg[1][54] : 0;
  a8=arg[1]? arg[1][64] : 0;
  a8=(a8*a1);
  a7=(a7+a8);
  a7=(a1*a7);
  a6=(a6+a7);
  a6=(a1*a6);
  a5=(a5+a6);
  a5=(a1*a5);
  a4=(a4+a5);
  a4=(a1*a4);
  a3=(a3+a4);
  a3=(a1*a3);
  a2=(a2+a3);
  a2=(a1*a2);
  a0=(a0+a2);
  if (res[0]!=0) res[0][4]=a0;
  a0=arg[0]? arg[0][5] : 0;
  a2=arg[1]? arg[1][5] : 0;
  a3=arg[1]? arg[1][15] : 0;
  a4=arg[1]? arg[1][25] : 0;
  a5=arg[1]? arg[1][35] : 0;
  a6=arg[1]? arg[1][45] : 0;
  a7=arg[1]? arg[1][55] : 0;
  a8=arg[1]? arg[1][65] : 0;
  a8=(a8*a1);
  a7=(a7+a8);
  a7=(a1*a7);
  a6=(a6+a7);
  a6=(a1*a6);
  a5=(a5+a6);
  a5=(a1*a5);
  a4=(a4+a5);
  a4=(a1*a4);
  a3=(a3+a4);
  a3=(a1*a3);
  a2=(a2+a3);
  a2=(a1*a2);
  a0=(a0+a2);
  if (res[0]!=0) res[0][5]=a0;
  a0=arg[0]? arg[0][6] : 0;
  a2=arg[1]? arg[1][6] : 0;
  a3=arg[1]? arg[1][16] : 0;
  a4=arg[1]? arg[1][26] : 0;
  a5=arg[1]? arg[1][36] : 0;
  a6=arg[1]? arg[1][46] : 0;
  a7=arg[1]? arg[1][56] : 0;
  a8=arg[1]? arg[1][66] : 0;
  a8=(a8*a1);
  a7=(a7+a8);
  a7=(a1*a7);
  a6=(a6+a7);
  a6=(a1*a6);
  a5=(a5+a6);
  a5=(a1*a5);
  a4=(a4+a5);
  a4=(a1*a4);
  a3=(a3+a4);
  a3=(a1*a3);
  a2=(a2+a3);
  a2=(a1*a2);
  a0=(a0+a2);
  if (res[0]!=0) res[0][6]=a0;
  a0=arg[0]? arg[0][7] : 0;
  a2=arg[1]? arg[1][7] : 0;
  a3=arg[1]? arg[1][17] : 0;
  a4=arg[1]? arg[1][27] : 0;
  a5=arg[1]? arg[1][37] : 0;
  a6=arg[1]? arg[1][47] : 0;
  a7=arg[1]? arg[1][57] : 0;
  a8=arg[1]? arg[1][67] : 0;
  a8=(a8*a1);
  a7=(a7+a8);
  a7=(a1*a7);
  a6=(a6+a7);
  a6=(a1*a6);
  a5=(a5+a6);
  a5=(a1*a5);
  a4=(a4+a5);
  a4=(a1*a4);
  a3=(a3+a4);
  a3=(a1*a3);
  a2=(a2+a3);
  a2=(a1*a2);
  a0=(a0+a2);
  if (res[0]!=0) res[0][7]=a0;
  a0=arg[0]? arg[0][8] : 0;
  a2=arg[1]? arg[1][8] : 0;
  a3=arg[1]? arg[1][18] : 0;
  a4=arg[1]? arg[1][28] : 0;
  a5=arg[1]? arg[1][38] : 0;
  a6=arg[1]? arg[1][48] : 0;
  a7=arg[1]? arg[1][58] : 0;
  a8=arg[1]? arg[1][68] : 0;
  a8=(a8*a1);
  a7=(a7+a8);
  a7=(a1*a7);
  a6=(a6+a7);
  a6=(a1*a6);
  a5=(a5+a6);
  a5=(a1*a5);
  a4=(a4+a5);
  a4=(a1*a4);
  a3=(a3+a4);
  a3=(a1*a3);
  a2=(a2+a3);
  a2=(a1*a2);
  a0=(a0+a2);
  if (res[0]!=0) res[0][8]=a0;
  a0=arg[0]? arg[0][9] : 0;
  a2=arg[1]? arg[1][9] : 0;
  a3=arg[1]? arg[1][19] : 0;
  a4=arg[1]? arg[1][29] : 0;
  a5=arg[1]? arg[1][39] : 0;
  a6=arg[1]? arg[1][49] : 0;
  a7=arg[1]? arg[1][59] : 0;
  a8=arg[1]? arg[1][69] : 0;
  a8=(a8*a1);
  a7=(a7+a8);
  a7=(a1*a7);
  a6=(a6+a7);
  a6=(a1*a6);
  a5=(a5+a6);
  a5=(a1*a5);
  a4=(a4+a5);
  a4=(a1*a4);
  a3=(a3+a4);
  a3=(a1*a3);
  a2=(a2+a3);
  a1=(a1*a2);
  a0=(a0+a1);
  if (res[0]!=0) res[0][9]=a0;
  a0=arg[0]? arg[0][10] : 0;
  if (res[0]!=0) res[0][10]=a0;
  a0=arg[0]? arg[0][11] : 0;
  if (res[0]!=0) res[0][11]=a0;
  return 0;
}

#if defined(__GNUC__)
#pragma GCC diagnostic pop
#endif

static int gm_moved_settings_settings_inside(const double *x)
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
static int gm_moved_settings_motion_inside(const double *x)
{
  static const double low[70] = {
    -3.000000003,
    -3.000000003,
    -3.000000003,
    -3.000000003,
    -3.000000003,
    -3.000000003,
    -3.000000003,
    -3.000000003,
    -3.000000003,
    -3.000000003,
    -3.000000003,
    -3.000000003,
    -3.000000003,
    -3.000000003,
    -3.000000003,
    -3.000000003,
    -3.000000003,
    -3.000000003,
    -3.000000003,
    -3.000000003,
    -3.000000003,
    -3.000000003,
    -3.000000003,
    -3.000000003,
    -3.000000003,
    -3.000000003,
    -3.000000003,
    -3.000000003,
    -3.000000003,
    -3.000000003,
    -3.000000003,
    -3.000000003,
    -3.000000003,
    -3.000000003,
    -3.000000003,
    -3.000000003,
    -3.000000003,
    -3.000000003,
    -3.000000003,
    -3.000000003,
    -3.000000003,
    -3.000000003,
    -3.000000003,
    -3.000000003,
    -3.000000003,
    -3.000000003,
    -3.000000003,
    -3.000000003,
    -3.000000003,
    -3.000000003,
    -3.000000003,
    -3.000000003,
    -3.000000003,
    -3.000000003,
    -3.000000003,
    -3.000000003,
    -3.000000003,
    -3.000000003,
    -3.000000003,
    -3.000000003,
    -3.000000003,
    -3.000000003,
    -3.000000003,
    -3.000000003,
    -3.000000003,
    -3.000000003,
    -3.000000003,
    -3.000000003,
    -3.000000003,
    -3.000000003};
  static const double high[70] = {
    3.000000003,
    3.000000003,
    3.000000003,
    3.000000003,
    3.000000003,
    3.000000003,
    3.000000003,
    3.000000003,
    3.000000003,
    3.000000003,
    3.000000003,
    3.000000003,
    3.000000003,
    3.000000003,
    3.000000003,
    3.000000003,
    3.000000003,
    3.000000003,
    3.000000003,
    3.000000003,
    3.000000003,
    3.000000003,
    3.000000003,
    3.000000003,
    3.000000003,
    3.000000003,
    3.000000003,
    3.000000003,
    3.000000003,
    3.000000003,
    3.000000003,
    3.000000003,
    3.000000003,
    3.000000003,
    3.000000003,
    3.000000003,
    3.000000003,
    3.000000003,
    3.000000003,
    3.000000003,
    3.000000003,
    3.000000003,
    3.000000003,
    3.000000003,
    3.000000003,
    3.000000003,
    3.000000003,
    3.000000003,
    3.000000003,
    3.000000003,
    3.000000003,
    3.000000003,
    3.000000003,
    3.000000003,
    3.000000003,
    3.000000003,
    3.000000003,
    3.000000003,
    3.000000003,
    3.000000003,
    3.000000003,
    3.000000003,
    3.000000003,
    3.000000003,
    3.000000003,
    3.000000003,
    3.000000003,
    3.000000003,
    3.000000003,
    3.000000003};
  return gm_inside(x, 70, low, high);
}
static int gm_moved_settings_theta_inside(const double *x)
{
  static const double low[1] = {-10.00000001};
  static const double high[1] = {10.00000001};
  return gm_inside(x, 1, low, high);
}

static int gm_moved_settings_point(
    const double *settings,
    const double *motion,
    const double *theta,
    double *settings_at)
{
  const double *arg[3];
  double *res[1];
  double motion_columns[70];
  arg[0] = settings;
  motion_columns[0] = motion[0];
  motion_columns[10] = motion[1];
  motion_columns[20] = motion[2];
  motion_columns[30] = motion[3];
  motion_columns[40] = motion[4];
  motion_columns[50] = motion[5];
  motion_columns[60] = motion[6];
  motion_columns[1] = motion[7];
  motion_columns[11] = motion[8];
  motion_columns[21] = motion[9];
  motion_columns[31] = motion[10];
  motion_columns[41] = motion[11];
  motion_columns[51] = motion[12];
  motion_columns[61] = motion[13];
  motion_columns[2] = motion[14];
  motion_columns[12] = motion[15];
  motion_columns[22] = motion[16];
  motion_columns[32] = motion[17];
  motion_columns[42] = motion[18];
  motion_columns[52] = motion[19];
  motion_columns[62] = motion[20];
  motion_columns[3] = motion[21];
  motion_columns[13] = motion[22];
  motion_columns[23] = motion[23];
  motion_columns[33] = motion[24];
  motion_columns[43] = motion[25];
  motion_columns[53] = motion[26];
  motion_columns[63] = motion[27];
  motion_columns[4] = motion[28];
  motion_columns[14] = motion[29];
  motion_columns[24] = motion[30];
  motion_columns[34] = motion[31];
  motion_columns[44] = motion[32];
  motion_columns[54] = motion[33];
  motion_columns[64] = motion[34];
  motion_columns[5] = motion[35];
  motion_columns[15] = motion[36];
  motion_columns[25] = motion[37];
  motion_columns[35] = motion[38];
  motion_columns[45] = motion[39];
  motion_columns[55] = motion[40];
  motion_columns[65] = motion[41];
  motion_columns[6] = motion[42];
  motion_columns[16] = motion[43];
  motion_columns[26] = motion[44];
  motion_columns[36] = motion[45];
  motion_columns[46] = motion[46];
  motion_columns[56] = motion[47];
  motion_columns[66] = motion[48];
  motion_columns[7] = motion[49];
  motion_columns[17] = motion[50];
  motion_columns[27] = motion[51];
  motion_columns[37] = motion[52];
  motion_columns[47] = motion[53];
  motion_columns[57] = motion[54];
  motion_columns[67] = motion[55];
  motion_columns[8] = motion[56];
  motion_columns[18] = motion[57];
  motion_columns[28] = motion[58];
  motion_columns[38] = motion[59];
  motion_columns[48] = motion[60];
  motion_columns[58] = motion[61];
  motion_columns[68] = motion[62];
  motion_columns[9] = motion[63];
  motion_columns[19] = motion[64];
  motion_columns[29] = motion[65];
  motion_columns[39] = motion[66];
  motion_columns[49] = motion[67];
  motion_columns[59] = motion[68];
  motion_columns[69] = motion[69];
  arg[1] = motion_columns;
  arg[2] = theta;
  res[0] = settings_at;
  (void)casadi_f0(arg, res, 0, 0, 0);
  return gm_finite(settings_at, 12) ? GM_OK : GM_E_NO_RESULT;
}


int gm_moved_settings(
    const double settings[12],
    const double motion[70],
    double theta,
    double settings_at[12])
{
  int status = GM_E_DOMAIN;
  if (!settings || !motion || !settings_at) return GM_E_NULL;
  if (gm_moved_settings_settings_inside(settings)
      && gm_moved_settings_motion_inside(motion)
      && gm_moved_settings_theta_inside(&theta)) {
    status = gm_moved_settings_point(settings, motion, &theta, settings_at);
  }
  if (status != GM_OK) {
    gm_nan(settings_at, 12);
  }
  return status;
}

int gm_moved_settings_batch(
    int64_t n,
    const double *settings, int64_t settings_stride,
    const double *motion, int64_t motion_stride,
    const double *theta, int64_t theta_stride,
    double *settings_at,
    int64_t *first_bad)
{
  int status = GM_OK, shared;
  int64_t k;
  if (first_bad) *first_bad = -1;
  if (n < 0 || settings_stride < 0 || motion_stride < 0 || theta_stride < 0) return GM_E_SIZE;
  if (n == 0) return GM_OK;
  if (!settings || !motion || !theta || !settings_at) return GM_E_NULL;
  shared = (settings_stride != 0 || gm_moved_settings_settings_inside(settings))
      && (motion_stride != 0 || gm_moved_settings_motion_inside(motion))
      && (theta_stride != 0 || gm_moved_settings_theta_inside(theta));
  for (k = 0; k < n; ++k) {
    int now = GM_E_DOMAIN;
    if (shared
        && (settings_stride == 0 || gm_moved_settings_settings_inside(settings + k * settings_stride))
        && (motion_stride == 0 || gm_moved_settings_motion_inside(motion + k * motion_stride))
        && (theta_stride == 0 || gm_moved_settings_theta_inside(theta + k * theta_stride))) {
      now = gm_moved_settings_point(
          settings + k * settings_stride,
          motion + k * motion_stride,
          theta + k * theta_stride,
          settings_at + k * 12);
    }
    if (now != GM_OK) {
      gm_nan(settings_at + k * 12, 12);
      if (status == GM_OK) {
        status = now;
        if (first_bad) *first_bad = k;
      }
    }
  }
  return status;
}
