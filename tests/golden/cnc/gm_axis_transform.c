/* gm_axis_transform: generated, do not edit. */
#include "gm_axis_transform.h"
#include "gm_check.h"

#include <math.h>

#if defined(__GNUC__)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-parameter"
#pragma GCC diagnostic ignored "-Wunused-function"
#endif

#define casadi_real double
#define casadi_int int
#define CASADI_PREFIX(ID) gm_axis_transform_ ## ID
#define casadi_f0 CASADI_PREFIX(f0)
#define casadi_sq CASADI_PREFIX(sq)

static casadi_real casadi_sq(casadi_real x) { return x*x;}

/* axis_transform:(settings[12],theta,pivot_height,pivot_offset[3])->(axes[5],margin) */
static int casadi_f0(const casadi_real** arg, casadi_real** res, casadi_int* iw, casadi_real* w, int mem) {
  casadi_real a00, a01, a02, a03, a04, a05, a06, a07, a08, a09, a10, a11;
  casadi_real a12, a13, a14, a15, a16, a17, a18, a19, a20, a21, a22, a23;
  a00=arg[0]? arg[0][2] : 0;
  a01=cos(a00);
  a02=arg[0]? arg[0][7] : 0;
  a03=sin(a02);
  a04=(a01*a03);
  a02=cos(a02);
  a00=sin(a00);
  a05=arg[0]? arg[0][1] : 0;
  a06=arg[1]? arg[1][0] : 0;
  a05=(a05+a06);
  a07=arg[0]? arg[0][3] : 0;
  a07=(a05+a07);
  a08=sin(a07);
  a09=(a00*a08);
  a10=(a02*a09);
  a10=(a04+a10);
  a11=arg[3]? arg[3][0] : 0;
  a12=(a10*a11);
  a13=(a01*a02);
  a14=(a03*a09);
  a13=(a13-a14);
  a14=casadi_sq(a13);
  a07=cos(a07);
  a15=casadi_sq(a07);
  a16=casadi_sq(a00);
  a17=(a15*a16);
  a18=casadi_sq(a02);
  a18=(a17*a18);
  a14=(a14+a18);
  a18=casadi_sq(a03);
  a18=(a17*a18);
  a14=(a14+a18);
  a14=sqrt(a14);
  a18=arg[3]? arg[3][2] : 0;
  a19=(a14*a18);
  a12=(a12+a19);
  a19=arg[0]? arg[0][4] : 0;
  a20=arg[0]? arg[0][0] : 0;
  a21=sin(a05);
  a21=(a20*a21);
  a19=(a19+a21);
  a00=(a00*a07);
  a21=(a00/a14);
  a04=(a04*a21);
  a22=(a02/a14);
  a23=(a16*a22);
  a23=(a23*a08);
  a23=(a23*a07);
  a04=(a04+a23);
  a04=(a19*a04);
  a12=(a12+a04);
  a04=arg[0]? arg[0][6] : 0;
  a23=(a03*a04);
  a07=arg[0]? arg[0][5] : 0;
  a23=(a23-a07);
  a15=(a15*a16);
  a15=(a15/a14);
  a15=(a15*a03);
  a16=(a13/a14);
  a07=(a16*a09);
  a15=(a15-a07);
  a15=(a23*a15);
  a12=(a12+a15);
  a04=(a02*a04);
  a05=cos(a05);
  a20=(a20*a05);
  a04=(a04+a20);
  a20=(a01*a16);
  a02=(a02*a17);
  a02=(a02/a14);
  a20=(a20+a02);
  a20=(a04*a20);
  a12=(a12+a20);
  a12=(-a12);
  if (res[0]!=0) res[0][0]=a12;
  a12=arg[3]? arg[3][1] : 0;
  a16=(a19*a16);
  a12=(a12+a16);
  a22=(a22*a00);
  a22=(a22*a23);
  a12=(a12+a22);
  a21=(a21*a03);
  a21=(a21*a04);
  a12=(a12-a21);
  if (res[0]!=0) res[0][1]=a12;
  a12=arg[2]? arg[2][0] : 0;
  a11=(a14*a11);
  a12=(a12+a11);
  a19=(a19*a00);
  a12=(a12+a19);
  a18=(a10*a18);
  a12=(a12-a18);
  a01=(a01*a23);
  a12=(a12-a01);
  a04=(a04*a09);
  a12=(a12-a04);
  if (res[0]!=0) res[0][2]=a12;
  a12=arg[0]? arg[0][9] : 0;
  a00=(-a00);
  a00=atan2(a00,a13);
  a12=(a12+a00);
  a00=arg[0]? arg[0][8] : 0;
  a00=(a00*a06);
  a12=(a12+a00);
  a12=(-a12);
  if (res[0]!=0) res[0][3]=a12;
  a12=1.5707963267948966e+00;
  a10=atan2(a14,a10);
  a12=(a12-a10);
  if (res[0]!=0) res[0][4]=a12;
  a12=-5.0000000000000003e-02;
  a12=(a12+a14);
  if (res[1]!=0) res[1][0]=a12;
  return 0;
}

#if defined(__GNUC__)
#pragma GCC diagnostic pop
#endif

static int gm_axis_transform_settings_inside(const double *x)
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
static int gm_axis_transform_theta_inside(const double *x)
{
  static const double low[1] = {-10.00000001};
  static const double high[1] = {10.00000001};
  return gm_inside(x, 1, low, high);
}
static int gm_axis_transform_pivot_height_inside(const double *x)
{
  static const double low[1] = {-10000.00001};
  static const double high[1] = {10000.00001};
  return gm_inside(x, 1, low, high);
}
static int gm_axis_transform_pivot_offset_inside(const double *x)
{
  static const double low[3] = {-1000.000001, -1000.000001, -1000.000001};
  static const double high[3] = {1000.000001, 1000.000001, 1000.000001};
  return gm_inside(x, 3, low, high);
}

static int gm_axis_transform_point(
    const double *settings,
    const double *theta,
    const double *pivot_height,
    const double *pivot_offset,
    double *axes)
{
  const double *arg[4];
  double *res[2];
  double margin;
  arg[0] = settings;
  arg[1] = theta;
  arg[2] = pivot_height;
  arg[3] = pivot_offset;
  res[0] = axes;
  res[1] = &margin;
  (void)casadi_f0(arg, res, 0, 0, 0);
  if (!(margin > 0.0)) return GM_E_REQUIRES;
  return gm_finite(axes, 5) ? GM_OK : GM_E_NO_RESULT;
}

#include "gm_lane.h"
static void gm_axis_transform_roll_point_shared(const double *x0, const double *x2, const double *x3, double *restrict t)
{
    const double b1 = x0[2];
    const double b2 = cos(b1);
    const double b3 = x0[7];
    const double b4 = sin(b3);
    const double b5 = b2 * b4;
    const double b6 = cos(b3);
    const double b7 = sin(b1);
    const double b8 = x0[1];
    t[0] = b8;
    const double b11 = x0[3];
    t[1] = b11;
    t[2] = b7;
    t[3] = b6;
    t[4] = b5;
    const double b17 = x3[0];
    t[5] = b17;
    const double b19 = b2 * b6;
    t[6] = b4;
    t[7] = b19;
    const double b25 = b7 * b7;
    t[8] = b25;
    const double b27 = b6 * b6;
    t[9] = b27;
    const double b30 = b4 * b4;
    t[10] = b30;
    const double b34 = x3[2];
    t[11] = b34;
    const double b37 = x0[4];
    const double b38 = x0[0];
    t[12] = b38;
    t[13] = b37;
    const double b52 = x0[6];
    const double b53 = b4 * b52;
    const double b54 = x0[5];
    const double b55 = b53 - b54;
    t[14] = b55;
    const double b64 = b6 * b52;
    t[15] = b64;
    t[16] = b2;
    const double b75 = x3[1];
    t[17] = b75;
    const double b84 = x2[0];
    t[18] = b84;
    const double b91 = b2 * b55;
    t[19] = b91;
    const double b95 = x0[9];
    t[20] = b95;
    const double b99 = x0[8];
    t[21] = b99;
    const double b103 = (1.5707963267948966);
    t[22] = b103;
    const double b106 = (-0.05);
    t[23] = b106;
}
static void gm_axis_transform_roll_point(const V *x1, const double *restrict t, V *y0, V *y1)
{
    const V a9 = x1[0];
    const V a10 = t[0] + a9;
    const V a12 = a10 + t[1];
    V a13, a13_c; v_sincos(a12, &a13, &a13_c);
    const V a14 = t[2] * a13;
    const V a15 = t[3] * a14;
    const V a16 = t[4] + a15;
    const V a18 = a16 * t[5];
    const V a20 = t[6] * a14;
    const V a21 = t[7] - a20;
    const V a22 = a21 * a21;
    const V a24 = a13_c * a13_c;
    const V a26 = a24 * t[8];
    const V a28 = a26 * t[9];
    const V a29 = a22 + a28;
    const V a31 = a26 * t[10];
    const V a32 = a29 + a31;
    const V a33 = v_sqrt(a32);
    const V a35 = a33 * t[11];
    const V a36 = a18 + a35;
    V a39, a39_c; v_sincos(a10, &a39, &a39_c);
    const V a40 = t[12] * a39;
    const V a41 = t[13] + a40;
    const V a42 = t[2] * a13_c;
    const V a43 = a42 / a33;
    const V a44 = t[4] * a43;
    const V a45 = t[3] / a33;
    const V a46 = t[8] * a45;
    const V a47 = a46 * a13;
    const V a48 = a47 * a13_c;
    const V a49 = a44 + a48;
    const V a50 = a41 * a49;
    const V a51 = a36 + a50;
    const V a57 = a26 / a33;
    const V a58 = a57 * t[6];
    const V a59 = a21 / a33;
    const V a60 = a59 * a14;
    const V a61 = a58 - a60;
    const V a62 = t[14] * a61;
    const V a63 = a51 + a62;
    const V a66 = t[12] * a39_c;
    const V a67 = t[15] + a66;
    const V a68 = t[16] * a59;
    const V a69 = t[3] * a26;
    const V a70 = a69 / a33;
    const V a71 = a68 + a70;
    const V a72 = a67 * a71;
    const V a73 = a63 + a72;
    const V a74 = -a73;
    y0[0] = a74;
    const V a76 = a41 * a59;
    const V a77 = t[17] + a76;
    const V a78 = a45 * a42;
    const V a79 = a78 * t[14];
    const V a80 = a77 + a79;
    const V a81 = a43 * t[6];
    const V a82 = a81 * a67;
    const V a83 = a80 - a82;
    y0[1] = a83;
    const V a85 = a33 * t[5];
    const V a86 = t[18] + a85;
    const V a87 = a41 * a42;
    const V a88 = a86 + a87;
    const V a89 = a16 * t[11];
    const V a90 = a88 - a89;
    const V a92 = a90 - t[19];
    const V a93 = a67 * a14;
    const V a94 = a92 - a93;
    y0[2] = a94;
    const V a96 = -a42;
    const V a97 = v_atan2(a96, a21);
    const V a98 = t[20] + a97;
    const V a100 = t[21] * a9;
    const V a101 = a98 + a100;
    const V a102 = -a101;
    y0[3] = a102;
    const V a104 = v_atan2(a33, a16);
    const V a105 = t[22] - a104;
    y0[4] = a105;
    const V a107 = t[23] + a33;
    y1[0] = a107;
}
static int gm_axis_transform_roll(
    int64_t n,
    const double *settings,
    const double *pivot_height,
    const double *pivot_offset,
    const double *theta, int64_t theta_stride,
    double *axes,
    int64_t *first_bad)
{
  double table[24], margin;
  int status = GM_OK;
  int64_t k;
  gm_axis_transform_roll_point_shared(settings, pivot_height, pivot_offset, table);
  for (k = 0; k < n; ++k) {
    double *now = axes + k * 5;
    int bad = GM_E_DOMAIN;
    if (gm_axis_transform_theta_inside(theta + k * theta_stride)) {
      gm_axis_transform_roll_point(theta + k * theta_stride, table, now, &margin);
      bad = !(margin > 0.0) ? GM_E_REQUIRES : gm_finite(now, 5) ? GM_OK : GM_E_NO_RESULT;
    }
    if (bad != GM_OK) {
      gm_nan(now, 5);
      if (status == GM_OK) {
        status = bad;
        if (first_bad) *first_bad = k;
      }
    }
  }
  return status;
}

int gm_axis_transform(
    const double settings[12],
    double theta,
    double pivot_height,
    const double pivot_offset[3],
    double axes[5])
{
  int status = GM_E_DOMAIN;
  if (!settings || !pivot_offset || !axes) return GM_E_NULL;
  if (gm_axis_transform_settings_inside(settings)
      && gm_axis_transform_theta_inside(&theta)
      && gm_axis_transform_pivot_height_inside(&pivot_height)
      && gm_axis_transform_pivot_offset_inside(pivot_offset)) {
    status = gm_axis_transform_point(settings, &theta, &pivot_height, pivot_offset, axes);
  }
  if (status != GM_OK) {
    gm_nan(axes, 5);
  }
  return status;
}

int gm_axis_transform_batch(
    int64_t n,
    const double *settings, int64_t settings_stride,
    const double *theta, int64_t theta_stride,
    const double *pivot_height, int64_t pivot_height_stride,
    const double *pivot_offset, int64_t pivot_offset_stride,
    double *axes,
    int64_t *first_bad)
{
  int status = GM_OK, shared;
  int64_t k;
  if (first_bad) *first_bad = -1;
  if (n < 0 || settings_stride < 0 || theta_stride < 0 || pivot_height_stride < 0 || pivot_offset_stride < 0) return GM_E_SIZE;
  if (n == 0) return GM_OK;
  if (!settings || !theta || !pivot_height || !pivot_offset || !axes) return GM_E_NULL;
  shared = (settings_stride != 0 || gm_axis_transform_settings_inside(settings))
      && (theta_stride != 0 || gm_axis_transform_theta_inside(theta))
      && (pivot_height_stride != 0 || gm_axis_transform_pivot_height_inside(pivot_height))
      && (pivot_offset_stride != 0 || gm_axis_transform_pivot_offset_inside(pivot_offset));
  if (shared && settings_stride == 0 && pivot_height_stride == 0 && pivot_offset_stride == 0) {
    return gm_axis_transform_roll(
        n,
        settings,
        pivot_height,
        pivot_offset,
        theta, theta_stride,
        axes,
        first_bad);
  }
  for (k = 0; k < n; ++k) {
    int now = GM_E_DOMAIN;
    if (shared
        && (settings_stride == 0 || gm_axis_transform_settings_inside(settings + k * settings_stride))
        && (theta_stride == 0 || gm_axis_transform_theta_inside(theta + k * theta_stride))
        && (pivot_height_stride == 0 || gm_axis_transform_pivot_height_inside(pivot_height + k * pivot_height_stride))
        && (pivot_offset_stride == 0 || gm_axis_transform_pivot_offset_inside(pivot_offset + k * pivot_offset_stride))) {
      now = gm_axis_transform_point(
          settings + k * settings_stride,
          theta + k * theta_stride,
          pivot_height + k * pivot_height_stride,
          pivot_offset + k * pivot_offset_stride,
          axes + k * 5);
    }
    if (now != GM_OK) {
      gm_nan(axes + k * 5, 5);
      if (status == GM_OK) {
        status = now;
        if (first_bad) *first_bad = k;
      }
    }
  }
  return status;
}
