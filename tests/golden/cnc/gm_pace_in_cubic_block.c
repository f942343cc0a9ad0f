/* gm_pace_in_cubic_block: generated, do not edit. */
#include "gm_pace_in_cubic_block.h"
#include "gm_check.h"

#include <math.h>

#if defined(__GNUC__)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-parameter"
#pragma GCC diagnostic ignored "-Wunused-function"
#endif

#define casadi_real double
#define casadi_int int
#define CASADI_PREFIX(ID) gm_pace_in_cubic_block_ ## ID
#define casadi_f0 CASADI_PREFIX(f0)
#define casadi_fabs CASADI_PREFIX(fabs)
#define casadi_fmax CASADI_PREFIX(fmax)
#define casadi_sq CASADI_PREFIX(sq)

static casadi_real casadi_sq(casadi_real x) { return x*x;}

static casadi_real casadi_fabs(casadi_real x) {
/* Pre-c99 compatibility */
#if __STDC_VERSION__ < 199901L
  return x>0 ? x : -x;
#else
  return fabs(x);
#endif
}

static casadi_real casadi_fmax(casadi_real x, casadi_real y) {
/* Pre-c99 compatibility */
#if __STDC_VERSION__ < 199901L
  return x>y ? x : y;
#else
  return fmax(x, y);
#endif
}

/* pace_in_cubic_block:(axes_0[5],axes_1[5],axes_2[5],axes_3[5],fraction,point_w[3],pivot_height,pivot_offset[3],max_speed[5],max_acceleration[5],max_jerk[5],feed)->(pace,path_rate) */
static int casadi_f0(const casadi_real** arg, casadi_real** res, casadi_int* iw, casadi_real* w, int mem) {
  casadi_real a00, a01, a02, a03, a04, a05, a06, a07, a08, a09, a10, a11;
  casadi_real a12, a13, a14, a15, a16, a17, a18, a19, a20, a21, a22, a23;
  casadi_real a24, a25, a26, a27, a28, a29, a30, a31, a32, a33, a34, a35;
  casadi_real a36, a37, a38, a39, a40, a41, a42;
  a00=arg[1]? arg[1][0] : 0;
  a01=arg[4]? arg[4][0] : 0;
  a02=arg[2]? arg[2][0] : 0;
  a03=arg[3]? arg[3][0] : 0;
  a04=(a01*a03);
  a02=(a02+a04);
  a05=(a01*a02);
  a00=(a00+a05);
  a02=(a02+a04);
  a04=(a01*a02);
  a00=(a00+a04);
  a04=arg[7]? arg[7][2] : 0;
  a05=arg[5]? arg[5][2] : 0;
  a04=(a04+a05);
  a05=arg[0]? arg[0][4] : 0;
  a06=arg[1]? arg[1][4] : 0;
  a07=arg[2]? arg[2][4] : 0;
  a08=arg[3]? arg[3][4] : 0;
  a09=(a01*a08);
  a07=(a07+a09);
  a10=(a01*a07);
  a06=(a06+a10);
  a10=(a01*a06);
  a05=(a05+a10);
  a10=sin(a05);
  a07=(a07+a09);
  a09=(a01*a07);
  a06=(a06+a09);
  a09=(a10*a06);
  a11=(a04*a09);
  a11=(a00-a11);
  a12=arg[5]? arg[5][1] : 0;
  a13=arg[0]? arg[0][3] : 0;
  a14=arg[1]? arg[1][3] : 0;
  a15=arg[2]? arg[2][3] : 0;
  a16=arg[3]? arg[3][3] : 0;
  a17=(a01*a16);
  a15=(a15+a17);
  a18=(a01*a15);
  a14=(a14+a18);
  a18=(a01*a14);
  a13=(a13+a18);
  a18=cos(a13);
  a15=(a15+a17);
  a17=(a01*a15);
  a14=(a14+a17);
  a17=(a18*a14);
  a19=(a12*a17);
  a20=arg[5]? arg[5][0] : 0;
  a13=sin(a13);
  a21=(a13*a14);
  a22=(a20*a21);
  a19=(a19-a22);
  a10=(a10*a19);
  a22=arg[7]? arg[7][0] : 0;
  a18=(a18*a20);
  a22=(a22+a18);
  a13=(a13*a12);
  a22=(a22+a13);
  a05=cos(a05);
  a13=(a05*a06);
  a18=(a22*a13);
  a10=(a10+a18);
  a11=(a11+a10);
  a11=casadi_sq(a11);
  a10=arg[1]? arg[1][1] : 0;
  a18=arg[2]? arg[2][1] : 0;
  a23=arg[3]? arg[3][1] : 0;
  a24=(a01*a23);
  a18=(a18+a24);
  a25=(a01*a18);
  a10=(a10+a25);
  a18=(a18+a24);
  a24=(a01*a18);
  a10=(a10+a24);
  a12=(a12*a21);
  a12=(a10+a12);
  a20=(a20*a17);
  a12=(a12+a20);
  a12=casadi_sq(a12);
  a11=(a11+a12);
  a05=(a05*a19);
  a22=(a22*a09);
  a05=(a05-a22);
  a22=arg[1]? arg[1][2] : 0;
  a09=arg[2]? arg[2][2] : 0;
  a19=arg[3]? arg[3][2] : 0;
  a12=(a01*a19);
  a09=(a09+a12);
  a20=(a01*a09);
  a22=(a22+a20);
  a09=(a09+a12);
  a12=(a01*a09);
  a22=(a22+a12);
  a05=(a05-a22);
  a04=(a04*a13);
  a05=(a05-a04);
  a05=casadi_sq(a05);
  a11=(a11+a05);
  a11=sqrt(a11);
  a05=casadi_sq(a00);
  a04=casadi_sq(a10);
  a05=(a05+a04);
  a04=casadi_sq(a22);
  a05=(a05+a04);
  a04=3.2828063500117441e+03;
  a13=casadi_sq(a14);
  a13=(a04*a13);
  a05=(a05+a13);
  a13=casadi_sq(a06);
  a13=(a04*a13);
  a05=(a05+a13);
  a05=sqrt(a05);
  a11=(a11/a05);
  a13=arg[11]? arg[11][0] : 0;
  a11=(a11/a13);
  a13=(a00/a05);
  a12=casadi_fabs(a13);
  a20=arg[8]? arg[8][0] : 0;
  a12=(a12/a20);
  a20=(a10/a05);
  a17=casadi_fabs(a20);
  a21=arg[8]? arg[8][1] : 0;
  a17=(a17/a21);
  a12=casadi_fmax(a12,a17);
  a17=(a22/a05);
  a21=casadi_fabs(a17);
  a24=arg[8]? arg[8][2] : 0;
  a21=(a21/a24);
  a12=casadi_fmax(a12,a21);
  a21=(a14/a05);
  a24=casadi_fabs(a21);
  a25=arg[8]? arg[8][3] : 0;
  a24=(a24/a25);
  a12=casadi_fmax(a12,a24);
  a24=(a06/a05);
  a25=casadi_fabs(a24);
  a26=arg[8]? arg[8][4] : 0;
  a25=(a25/a26);
  a12=casadi_fmax(a12,a25);
  a11=casadi_fmax(a11,a12);
  a12=(2.*a03);
  a25=(a01*a12);
  a25=(a02+a25);
  a02=(a02+a25);
  a25=(a02/a05);
  a13=(a13/a05);
  a00=(2.*a00);
  a26=(a00*a02);
  a10=(2.*a10);
  a27=(2.*a23);
  a28=(a01*a27);
  a28=(a18+a28);
  a18=(a18+a28);
  a28=(a10*a18);
  a26=(a26+a28);
  a22=(2.*a22);
  a28=(2.*a19);
  a29=(a01*a28);
  a29=(a09+a29);
  a09=(a09+a29);
  a29=(a22*a09);
  a26=(a26+a29);
  a14=(2.*a14);
  a29=(2.*a16);
  a30=(a01*a29);
  a30=(a15+a30);
  a15=(a15+a30);
  a30=(a14*a15);
  a30=(a04*a30);
  a26=(a26+a30);
  a06=(2.*a06);
  a30=(2.*a08);
  a01=(a01*a30);
  a01=(a07+a01);
  a07=(a07+a01);
  a01=(a06*a07);
  a01=(a04*a01);
  a26=(a26+a01);
  a01=(2.*a05);
  a26=(a26/a01);
  a31=(a13*a26);
  a31=(a25-a31);
  a31=(a31/a05);
  a32=casadi_fabs(a31);
  a33=arg[9]? arg[9][0] : 0;
  a32=(a32/a33);
  a33=(a18/a05);
  a20=(a20/a05);
  a34=(a20*a26);
  a34=(a33-a34);
  a34=(a34/a05);
  a35=casadi_fabs(a34);
  a36=arg[9]? arg[9][1] : 0;
  a35=(a35/a36);
  a32=casadi_fmax(a32,a35);
  a35=(a09/a05);
  a17=(a17/a05);
  a36=(a17*a26);
  a36=(a35-a36);
  a36=(a36/a05);
  a37=casadi_fabs(a36);
  a38=arg[9]? arg[9][2] : 0;
  a37=(a37/a38);
  a32=casadi_fmax(a32,a37);
  a37=(a15/a05);
  a21=(a21/a05);
  a38=(a21*a26);
  a38=(a37-a38);
  a38=(a38/a05);
  a39=casadi_fabs(a38);
  a40=arg[9]? arg[9][3] : 0;
  a39=(a39/a40);
  a32=casadi_fmax(a32,a39);
  a39=(a07/a05);
  a24=(a24/a05);
  a40=(a24*a26);
  a40=(a39-a40);
  a40=(a40/a05);
  a41=casadi_fabs(a40);
  a42=arg[9]? arg[9][4] : 0;
  a41=(a41/a42);
  a32=casadi_fmax(a32,a41);
  a32=sqrt(a32);
  a11=casadi_fmax(a11,a32);
  a32=4.;
  a03=(a32*a03);
  a12=(a12+a03);
  a03=(a12/a05);
  a25=(a25/a05);
  a25=(a25*a26);
  a03=(a03-a25);
  a25=(a13/a05);
  a25=(a25*a26);
  a25=(a31-a25);
  a25=(a26*a25);
  a41=(2.*a02);
  a02=(a02*a41);
  a00=(a00*a12);
  a02=(a02+a00);
  a00=(2.*a18);
  a18=(a18*a00);
  a23=(a32*a23);
  a27=(a27+a23);
  a10=(a10*a27);
  a18=(a18+a10);
  a02=(a02+a18);
  a18=(2.*a09);
  a09=(a09*a18);
  a19=(a32*a19);
  a28=(a28+a19);
  a22=(a22*a28);
  a09=(a09+a22);
  a02=(a02+a09);
  a09=(2.*a15);
  a15=(a15*a09);
  a16=(a32*a16);
  a29=(a29+a16);
  a14=(a14*a29);
  a15=(a15+a14);
  a15=(a04*a15);
  a02=(a02+a15);
  a15=(2.*a07);
  a07=(a07*a15);
  a32=(a32*a08);
  a30=(a30+a32);
  a06=(a06*a30);
  a07=(a07+a06);
  a04=(a04*a07);
  a02=(a02+a04);
  a02=(a02/a01);
  a01=(a26/a01);
  a04=(2.*a26);
  a01=(a01*a04);
  a02=(a02-a01);
  a13=(a13*a02);
  a25=(a25+a13);
  a03=(a03-a25);
  a03=(a03/a05);
  a31=(a31/a05);
  a31=(a31*a26);
  a03=(a03-a31);
  a03=(a03/a05);
  a03=casadi_fabs(a03);
  a31=arg[10]? arg[10][0] : 0;
  a03=(a03/a31);
  a27=(a27/a05);
  a33=(a33/a05);
  a33=(a33*a26);
  a27=(a27-a33);
  a33=(a20/a05);
  a33=(a33*a26);
  a33=(a34-a33);
  a33=(a26*a33);
  a20=(a20*a02);
  a33=(a33+a20);
  a27=(a27-a33);
  a27=(a27/a05);
  a34=(a34/a05);
  a34=(a34*a26);
  a27=(a27-a34);
  a27=(a27/a05);
  a27=casadi_fabs(a27);
  a34=arg[10]? arg[10][1] : 0;
  a27=(a27/a34);
  a03=casadi_fmax(a03,a27);
  a28=(a28/a05);
  a35=(a35/a05);
  a35=(a35*a26);
  a28=(a28-a35);
  a35=(a17/a05);
  a35=(a35*a26);
  a35=(a36-a35);
  a35=(a26*a35);
  a17=(a17*a02);
  a35=(a35+a17);
  a28=(a28-a35);
  a28=(a28/a05);
  a36=(a36/a05);
  a36=(a36*a26);
  a28=(a28-a36);
  a28=(a28/a05);
  a28=casadi_fabs(a28);
  a36=arg[10]? arg[10][2] : 0;
  a28=(a28/a36);
  a03=casadi_fmax(a03,a28);
  a29=(a29/a05);
  a37=(a37/a05);
  a37=(a37*a26);
  a29=(a29-a37);
  a37=(a21/a05);
  a37=(a37*a26);
  a37=(a38-a37);
  a37=(a26*a37);
  a21=(a21*a02);
  a37=(a37+a21);
  a29=(a29-a37);
  a29=(a29/a05);
  a38=(a38/a05);
  a38=(a38*a26);
  a29=(a29-a38);
  a29=(a29/a05);
  a29=casadi_fabs(a29);
  a38=arg[10]? arg[10][3] : 0;
  a29=(a29/a38);
  a03=casadi_fmax(a03,a29);
  a30=(a30/a05);
  a39=(a39/a05);
  a39=(a39*a26);
  a30=(a30-a39);
  a39=(a24/a05);
  a39=(a39*a26);
  a39=(a40-a39);
  a39=(a26*a39);
  a24=(a24*a02);
  a39=(a39+a24);
  a30=(a30-a39);
  a30=(a30/a05);
  a40=(a40/a05);
  a40=(a40*a26);
  a30=(a30-a40);
  a30=(a30/a05);
  a30=casadi_fabs(a30);
  a40=arg[10]? arg[10][4] : 0;
  a30=(a30/a40);
  a03=casadi_fmax(a03,a30);
  a30=3.3333333333333331e-01;
  a03=pow(a03,a30);
  a11=casadi_fmax(a11,a03);
  if (res[0]!=0) res[0][0]=a11;
  if (res[1]!=0) res[1][0]=a05;
  return 0;
}

#if defined(__GNUC__)
#pragma GCC diagnostic pop
#endif

static int gm_pace_in_cubic_block_axes_0_inside(const double *x)
{
  static const double low[5] = {-5000.000005, -5000.000005, -5000.000005, -5000.000005, -5000.000005};
  static const double high[5] = {5000.000005, 5000.000005, 5000.000005, 5000.000005, 5000.000005};
  return gm_inside(x, 5, low, high);
}
static int gm_pace_in_cubic_block_axes_1_inside(const double *x)
{
  static const double low[5] = {-5000.000005, -5000.000005, -5000.000005, -5000.000005, -5000.000005};
  static const double high[5] = {5000.000005, 5000.000005, 5000.000005, 5000.000005, 5000.000005};
  return gm_inside(x, 5, low, high);
}
static int gm_pace_in_cubic_block_axes_2_inside(const double *x)
{
  static const double low[5] = {-5000.000005, -5000.000005, -5000.000005, -5000.000005, -5000.000005};
  static const double high[5] = {5000.000005, 5000.000005, 5000.000005, 5000.000005, 5000.000005};
  return gm_inside(x, 5, low, high);
}
static int gm_pace_in_cubic_block_axes_3_inside(const double *x)
{
  static const double low[5] = {-5000.000005, -5000.000005, -5000.000005, -5000.000005, -5000.000005};
  static const double high[5] = {5000.000005, 5000.000005, 5000.000005, 5000.000005, 5000.000005};
  return gm_inside(x, 5, low, high);
}
static int gm_pace_in_cubic_block_fraction_inside(const double *x)
{
  static const double low[1] = {-1e-08};
  static const double high[1] = {10.00000001};
  return gm_inside(x, 1, low, high);
}
static int gm_pace_in_cubic_block_point_w_inside(const double *x)
{
  static const double low[3] = {-5000.000005, -5000.000005, -5000.000005};
  static const double high[3] = {5000.000005, 5000.000005, 5000.000005};
  return gm_inside(x, 3, low, high);
}
static int gm_pace_in_cubic_block_pivot_height_inside(const double *x)
{
  static const double low[1] = {-10000.00001};
  static const double high[1] = {10000.00001};
  return gm_inside(x, 1, low, high);
}
static int gm_pace_in_cubic_block_pivot_offset_inside(const double *x)
{
  static const double low[3] = {-1000.000001, -1000.000001, -1000.000001};
  static const double high[3] = {1000.000001, 1000.000001, 1000.000001};
  return gm_inside(x, 3, low, high);
}
static int gm_pace_in_cubic_block_max_speed_inside(const double *x)
{
  static const double low[5] = {0.0, 0.0, 0.0, 0.0, 0.0};
  static const double high[5] = {100000.0001, 100000.0001, 100000.0001, 100000.0001, 100000.0001};
  return gm_inside(x, 5, low, high);
}
static int gm_pace_in_cubic_block_max_acceleration_inside(const double *x)
{
  static const double low[5] = {-0.0099, -0.0099, -0.0099, -0.0099, -0.0099};
  static const double high[5] = {10000000.01, 10000000.01, 10000000.01, 10000000.01, 10000000.01};
  return gm_inside(x, 5, low, high);
}
static int gm_pace_in_cubic_block_max_jerk_inside(const double *x)
{
  static const double low[5] = {-9.9999, -9.9999, -9.9999, -9.9999, -9.9999};
  static const double high[5] = {10000000010.0, 10000000010.0, 10000000010.0, 10000000010.0, 10000000010.0};
  return gm_inside(x, 5, low, high);
}
static int gm_pace_in_cubic_block_feed_inside(const double *x)
{
  static const double low[1] = {0.0};
  static const double high[1] = {20000.00002};
  return gm_inside(x, 1, low, high);
}

static int gm_pace_in_cubic_block_point(
    const double *axes_0,
    const double *axes_1,
    const double *axes_2,
    const double *axes_3,
    const double *fraction,
    const double *point_w,
    const double *pivot_height,
    const double *pivot_offset,
    const double *max_speed,
    const double *max_acceleration,
    const double *max_jerk,
    const double *feed,
    double *pace,
    double *path_rate)
{
  const double *arg[12];
  double *res[2];
  arg[0] = axes_0;
  arg[1] = axes_1;
  arg[2] = axes_2;
  arg[3] = axes_3;
  arg[4] = fraction;
  arg[5] = point_w;
  arg[6] = pivot_height;
  arg[7] = pivot_offset;
  arg[8] = max_speed;
  arg[9] = max_acceleration;
  arg[10] = max_jerk;
  arg[11] = feed;
  res[0] = pace;
  res[1] = path_rate;
  (void)casadi_f0(arg, res, 0, 0, 0);
  return gm_finite(pace, 1) && gm_finite(path_rate, 1) ? GM_OK : GM_E_NO_RESULT;
}


int gm_pace_in_cubic_block(
    const double axes_0[5],
    const double axes_1[5],
    const double axes_2[5],
    const double axes_3[5],
    double fraction,
    const double point_w[3],
    double pivot_height,
    const double pivot_offset[3],
    const double max_speed[5],
    const double max_acceleration[5],
    const double max_jerk[5],
    double feed,
    double *pace,
    double *path_rate)
{
  int status = GM_E_DOMAIN;
  if (!axes_0 || !axes_1 || !axes_2 || !axes_3 || !point_w || !pivot_offset || !max_speed || !max_acceleration || !max_jerk || !pace || !path_rate) return GM_E_NULL;
  if (gm_pace_in_cubic_block_axes_0_inside(axes_0)
      && gm_pace_in_cubic_block_axes_1_inside(axes_1)
      && gm_pace_in_cubic_block_axes_2_inside(axes_2)
      && gm_pace_in_cubic_block_axes_3_inside(axes_3)
      && gm_pace_in_cubic_block_fraction_inside(&fraction)
      && gm_pace_in_cubic_block_point_w_inside(point_w)
      && gm_pace_in_cubic_block_pivot_height_inside(&pivot_height)
      && gm_pace_in_cubic_block_pivot_offset_inside(pivot_offset)
      && gm_pace_in_cubic_block_max_speed_inside(max_speed)
      && gm_pace_in_cubic_block_max_acceleration_inside(max_acceleration)
      && gm_pace_in_cubic_block_max_jerk_inside(max_jerk)
      && gm_pace_in_cubic_block_feed_inside(&feed)) {
    status = gm_pace_in_cubic_block_point(
        axes_0,
        axes_1,
        axes_2,
        axes_3,
        &fraction,
        point_w,
        &pivot_height,
        pivot_offset,
        max_speed,
        max_acceleration,
        max_jerk,
        &feed,
        pace,
        path_rate);
  }
  if (status != GM_OK) {
    gm_nan(pace, 1);
    gm_nan(path_rate, 1);
  }
  return status;
}

int gm_pace_in_cubic_block_batch(
    int64_t n,
    const double *axes_0, int64_t axes_0_stride,
    const double *axes_1, int64_t axes_1_stride,
    const double *axes_2, int64_t axes_2_stride,
    const double *axes_3, int64_t axes_3_stride,
    const double *fraction, int64_t fraction_stride,
    const double *point_w, int64_t point_w_stride,
    const double *pivot_height, int64_t pivot_height_stride,
    const double *pivot_offset, int64_t pivot_offset_stride,
    const double *max_speed, int64_t max_speed_stride,
    const double *max_acceleration, int64_t max_acceleration_stride,
    const double *max_jerk, int64_t max_jerk_stride,
    const double *feed, int64_t feed_stride,
    double *pace,
    double *path_rate,
    int64_t *first_bad)
{
  int status = GM_OK, shared;
  int64_t k;
  if (first_bad) *first_bad = -1;
  if (n < 0 || axes_0_stride < 0 || axes_1_stride < 0 || axes_2_stride < 0 || axes_3_stride < 0 || fraction_stride < 0 || point_w_stride < 0 || pivot_height_stride < 0 || pivot_offset_stride < 0 || max_speed_stride < 0 || max_acceleration_stride < 0 || max_jerk_stride < 0 || feed_stride < 0) return GM_E_SIZE;
  if (n == 0) return GM_OK;
  if (!axes_0 || !axes_1 || !axes_2 || !axes_3 || !fraction || !point_w || !pivot_height || !pivot_offset || !max_speed || !max_acceleration || !max_jerk || !feed || !pace || !path_rate) return GM_E_NULL;
  shared = (axes_0_stride != 0 || gm_pace_in_cubic_block_axes_0_inside(axes_0))
      && (axes_1_stride != 0 || gm_pace_in_cubic_block_axes_1_inside(axes_1))
      && (axes_2_stride != 0 || gm_pace_in_cubic_block_axes_2_inside(axes_2))
      && (axes_3_stride != 0 || gm_pace_in_cubic_block_axes_3_inside(axes_3))
      && (fraction_stride != 0 || gm_pace_in_cubic_block_fraction_inside(fraction))
      && (point_w_stride != 0 || gm_pace_in_cubic_block_point_w_inside(point_w))
      && (pivot_height_stride != 0 || gm_pace_in_cubic_block_pivot_height_inside(pivot_height))
      && (pivot_offset_stride != 0 || gm_pace_in_cubic_block_pivot_offset_inside(pivot_offset))
      && (max_speed_stride != 0 || gm_pace_in_cubic_block_max_speed_inside(max_speed))
      && (max_acceleration_stride != 0 || gm_pace_in_cubic_block_max_acceleration_inside(max_acceleration))
      && (max_jerk_stride != 0 || gm_pace_in_cubic_block_max_jerk_inside(max_jerk))
      && (feed_stride != 0 || gm_pace_in_cubic_block_feed_inside(feed));
  for (k = 0; k < n; ++k) {
    int now = GM_E_DOMAIN;
    if (shared
        && (axes_0_stride == 0 || gm_pace_in_cubic_block_axes_0_inside(axes_0 + k * axes_0_stride))
        && (axes_1_stride == 0 || gm_pace_in_cubic_block_axes_1_inside(axes_1 + k * axes_1_stride))
        && (axes_2_stride == 0 || gm_pace_in_cubic_block_axes_2_inside(axes_2 + k * axes_2_stride))
        && (axes_3_stride == 0 || gm_pace_in_cubic_block_axes_3_inside(axes_3 + k * axes_3_stride))
        && (fraction_stride == 0 || gm_pace_in_cubic_block_fraction_inside(fraction + k * fraction_stride))
        && (point_w_stride == 0 || gm_pace_in_cubic_block_point_w_inside(point_w + k * point_w_stride))
        && (pivot_height_stride == 0 || gm_pace_in_cubic_block_pivot_height_inside(pivot_height + k * pivot_height_stride))
        && (pivot_offset_stride == 0 || gm_pace_in_cubic_block_pivot_offset_inside(pivot_offset + k * pivot_offset_stride))
        && (max_speed_stride == 0 || gm_pace_in_cubic_block_max_speed_inside(max_speed + k * max_speed_stride))
        && (max_acceleration_stride == 0 || gm_pace_in_cubic_block_max_acceleration_inside(max_acceleration + k * max_acceleration_stride))
        && (max_jerk_stride == 0 || gm_pace_in_cubic_block_max_jerk_inside(max_jerk + k * max_jerk_stride))
        && (feed_stride == 0 || gm_pace_in_cubic_block_feed_inside(feed + k * feed_stride))) {
      now = gm_pace_in_cubic_block_point(
          axes_0 + k * axes_0_stride,
          axes_1 + k * axes_1_stride,
          axes_2 + k * axes_2_stride,
          axes_3 + k * axes_3_stride,
          fraction + k * fraction_stride,
          point_w + k * point_w_stride,
          pivot_height + k * pivot_height_stride,
          pivot_offset + k * pivot_offset_stride,
          max_speed + k * max_speed_stride,
          max_acceleration + k * max_acceleration_stride,
          max_jerk + k * max_jerk_stride,
          feed + k * feed_stride,
          pace + k,
          path_rate + k);
    }
    if (now != GM_OK) {
      gm_nan(pace + k, 1);
      gm_nan(path_rate + k, 1);
      if (status == GM_OK) {
        status = now;
        if (first_bad) *first_bad = k;
      }
    }
  }
  return status;
}
