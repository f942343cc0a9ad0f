/* gm_pace_in_quintic_block: generated, do not edit. */
#include "gm_pace_in_quintic_block.h"
#include "gm_check.h"

#include <math.h>

#if defined(__GNUC__)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-parameter"
#pragma GCC diagnostic ignored "-Wunused-function"
#endif

#define casadi_real double
#define casadi_int int
#define CASADI_PREFIX(ID) gm_pace_in_quintic_block_ ## ID
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

/* pace_in_quintic_block:(axes_0[5],axes_1[5],axes_2[5],axes_3[5],axes_4[5],axes_5[5],fraction,point_w[3],pivot_height,pivot_offset[3],max_speed[5],max_acceleration[5],max_jerk[5],feed)->(pace,path_rate) */
static int casadi_f0(const casadi_real** arg, casadi_real** res, casadi_int* iw, casadi_real* w, int mem) {
  casadi_real a00, a01, a02, a03, a04, a05, a06, a07, a08, a09, a10, a11;
  casadi_real a12, a13, a14, a15, a16, a17, a18, a19, a20, a21, a22, a23;
  casadi_real a24, a25, a26, a27, a28, a29, a30, a31, a32, a33, a34, a35;
  casadi_real a36, a37, a38, a39, a40, a41, a42, a43, a44, a45, a46, a47;
  casadi_real a48, a49, a50, a51, a52, a53;
  a00=arg[1]? arg[1][0] : 0;
  a01=arg[6]? arg[6][0] : 0;
  a02=arg[2]? arg[2][0] : 0;
  a03=arg[3]? arg[3][0] : 0;
  a04=arg[4]? arg[4][0] : 0;
  a05=arg[5]? arg[5][0] : 0;
  a06=(a01*a05);
  a04=(a04+a06);
  a07=(a01*a04);
  a03=(a03+a07);
  a07=(a01*a03);
  a02=(a02+a07);
  a07=(a01*a02);
  a00=(a00+a07);
  a04=(a04+a06);
  a06=(a01*a04);
  a03=(a03+a06);
  a06=(a01*a03);
  a02=(a02+a06);
  a06=(a01*a02);
  a00=(a00+a06);
  a06=arg[9]? arg[9][2] : 0;
  a07=arg[7]? arg[7][2] : 0;
  a06=(a06+a07);
  a07=arg[0]? arg[0][4] : 0;
  a08=arg[1]? arg[1][4] : 0;
  a09=arg[2]? arg[2][4] : 0;
  a10=arg[3]? arg[3][4] : 0;
  a11=arg[4]? arg[4][4] : 0;
  a12=arg[5]? arg[5][4] : 0;
  a13=(a01*a12);
  a11=(a11+a13);
  a14=(a01*a11);
  a10=(a10+a14);
  a14=(a01*a10);
  a09=(a09+a14);
  a14=(a01*a09);
  a08=(a08+a14);
  a14=(a01*a08);
  a07=(a07+a14);
  a14=sin(a07);
  a11=(a11+a13);
  a13=(a01*a11);
  a10=(a10+a13);
  a13=(a01*a10);
  a09=(a09+a13);
  a13=(a01*a09);
  a08=(a08+a13);
  a13=(a14*a08);
  a15=(a06*a13);
  a15=(a00-a15);
  a16=arg[7]? arg[7][1] : 0;
  a17=arg[0]? arg[0][3] : 0;
  a18=arg[1]? arg[1][3] : 0;
  a19=arg[2]? arg[2][3] : 0;
  a20=arg[3]? arg[3][3] : 0;
  a21=arg[4]? arg[4][3] : 0;
  a22=arg[5]? arg[5][3] : 0;
  a23=(a01*a22);
  a21=(a21+a23);
  a24=(a01*a21);
  a20=(a20+a24);
  a24=(a01*a20);
  a19=(a19+a24);
  a24=(a01*a19);
  a18=(a18+a24);
  a24=(a01*a18);
  a17=(a17+a24);
  a24=cos(a17);
  a21=(a21+a23);
  a23=(a01*a21);
  a20=(a20+a23);
  a23=(a01*a20);
  a19=(a19+a23);
  a23=(a01*a19);
  a18=(a18+a23);
  a23=(a24*a18);
  a25=(a16*a23);
  a26=arg[7]? arg[7][0] : 0;
  a17=sin(a17);
  a27=(a17*a18);
  a28=(a26*a27);
  a25=(a25-a28);
  a14=(a14*a25);
  a28=arg[9]? arg[9][0] : 0;
  a24=(a24*a26);
  a28=(a28+a24);
  a17=(a17*a16);
  a28=(a28+a17);
  a07=cos(a07);
  a17=(a07*a08);
  a24=(a28*a17);
  a14=(a14+a24);
  a15=(a15+a14);
  a15=casadi_sq(a15);
  a14=arg[1]? arg[1][1] : 0;
  a24=arg[2]? arg[2][1] : 0;
  a29=arg[3]? arg[3][1] : 0;
  a30=arg[4]? arg[4][1] : 0;
  a31=arg[5]? arg[5][1] : 0;
  a32=(a01*a31);
  a30=(a30+a32);
  a33=(a01*a30);
  a29=(a29+a33);
  a33=(a01*a29);
  a24=(a24+a33);
  a33=(a01*a24);
  a14=(a14+a33);
  a30=(a30+a32);
  a32=(a01*a30);
  a29=(a29+a32);
  a32=(a01*a29);
  a24=(a24+a32);
  a32=(a01*a24);
  a14=(a14+a32);
  a16=(a16*a27);
  a16=(a14+a16);
  a26=(a26*a23);
  a16=(a16+a26);
  a16=casadi_sq(a16);
  a15=(a15+a16);
  a07=(a07*a25);
  a28=(a28*a13);
  a07=(a07-a28);
  a28=arg[1]? arg[1][2] : 0;
  a13=arg[2]? arg[2][2] : 0;
  a25=arg[3]? arg[3][2] : 0;
  a16=arg[4]? arg[4][2] : 0;
  a26=arg[5]? arg[5][2] : 0;
  a23=(a01*a26);
  a16=(a16+a23);
  a27=(a01*a16);
  a25=(a25+a27);
  a27=(a01*a25);
  a13=(a13+a27);
  a27=(a01*a13);
  a28=(a28+a27);
  a16=(a16+a23);
  a23=(a01*a16);
  a25=(a25+a23);
  a23=(a01*a25);
  a13=(a13+a23);
  a23=(a01*a13);
  a28=(a28+a23);
  a07=(a07-a28);
  a06=(a06*a17);
  a07=(a07-a06);
  a07=casadi_sq(a07);
  a15=(a15+a07);
  a15=sqrt(a15);
  a07=casadi_sq(a00);
  a06=casadi_sq(a14);
  a07=(a07+a06);
  a06=casadi_sq(a28);
  a07=(a07+a06);
  a06=3.2828063500117441e+03;
  a17=casadi_sq(a18);
  a17=(a06*a17);
  a07=(a07+a17);
  a17=casadi_sq(a08);
  a17=(a06*a17);
  a07=(a07+a17);
  a07=sqrt(a07);
  a15=(a15/a07);
  a17=arg[13]? arg[13][0] : 0;
  a15=(a15/a17);
  a17=(a00/a07);
  a23=casadi_fabs(a17);
  a27=arg[10]? arg[10][0] : 0;
  a23=(a23/a27);
  a27=(a14/a07);
  a32=casadi_fabs(a27);
  a33=arg[10]? arg[10][1] : 0;
  a32=(a32/a33);
  a23=casadi_fmax(a23,a32);
  a32=(a28/a07);
  a33=casadi_fabs(a32);
  a34=arg[10]? arg[10][2] : 0;
  a33=(a33/a34);
  a23=casadi_fmax(a23,a33);
  a33=(a18/a07);
  a34=casadi_fabs(a33);
  a35=arg[10]? arg[10][3] : 0;
  a34=(a34/a35);
  a23=casadi_fmax(a23,a34);
  a34=(a08/a07);
  a35=casadi_fabs(a34);
  a36=arg[10]? arg[10][4] : 0;
  a35=(a35/a36);
  a23=casadi_fmax(a23,a35);
  a15=casadi_fmax(a15,a23);
  a23=(2.*a05);
  a35=(a01*a23);
  a35=(a04+a35);
  a04=(a04+a35);
  a35=(a01*a04);
  a35=(a03+a35);
  a03=(a03+a35);
  a35=(a01*a03);
  a35=(a02+a35);
  a02=(a02+a35);
  a35=(a02/a07);
  a17=(a17/a07);
  a00=(2.*a00);
  a36=(a00*a02);
  a14=(2.*a14);
  a37=(2.*a31);
  a38=(a01*a37);
  a38=(a30+a38);
  a30=(a30+a38);
  a38=(a01*a30);
  a38=(a29+a38);
  a29=(a29+a38);
  a38=(a01*a29);
  a38=(a24+a38);
  a24=(a24+a38);
  a38=(a14*a24);
  a36=(a36+a38);
  a28=(2.*a28);
  a38=(2.*a26);
  a39=(a01*a38);
  a39=(a16+a39);
  a16=(a16+a39);
  a39=(a01*a16);
  a39=(a25+a39);
  a25=(a25+a39);
  a39=(a01*a25);
  a39=(a13+a39);
  a13=(a13+a39);
  a39=(a28*a13);
  a36=(a36+a39);
  a18=(2.*a18);
  a39=(2.*a22);
  a40=(a01*a39);
  a40=(a21+a40);
  a21=(a21+a40);
  a40=(a01*a21);
  a40=(a20+a40);
  a20=(a20+a40);
  a40=(a01*a20);
  a40=(a19+a40);
  a19=(a19+a40);
  a40=(a18*a19);
  a40=(a06*a40);
  a36=(a36+a40);
  a08=(2.*a08);
  a40=(2.*a12);
  a41=(a01*a40);
  a41=(a11+a41);
  a11=(a11+a41);
  a41=(a01*a11);
  a41=(a10+a41);
  a10=(a10+a41);
  a41=(a01*a10);
  a41=(a09+a41);
  a09=(a09+a41);
  a41=(a08*a09);
  a41=(a06*a41);
  a36=(a36+a41);
  a41=(2.*a07);
  a36=(a36/a41);
  a42=(a17*a36);
  a42=(a35-a42);
  a42=(a42/a07);
  a43=casadi_fabs(a42);
  a44=arg[11]? arg[11][0] : 0;
  a43=(a43/a44);
  a44=(a24/a07);
  a27=(a27/a07);
  a45=(a27*a36);
  a45=(a44-a45);
  a45=(a45/a07);
  a46=casadi_fabs(a45);
  a47=arg[11]? arg[11][1] : 0;
  a46=(a46/a47);
  a43=casadi_fmax(a43,a46);
  a46=(a13/a07);
  a32=(a32/a07);
  a47=(a32*a36);
  a47=(a46-a47);
  a47=(a47/a07);
  a48=casadi_fabs(a47);
  a49=arg[11]? arg[11][2] : 0;
  a48=(a48/a49);
  a43=casadi_fmax(a43,a48);
  a48=(a19/a07);
  a33=(a33/a07);
  a49=(a33*a36);
  a49=(a48-a49);
  a49=(a49/a07);
  a50=casadi_fabs(a49);
  a51=arg[11]? arg[11][3] : 0;
  a50=(a50/a51);
  a43=casadi_fmax(a43,a50);
  a50=(a09/a07);
  a34=(a34/a07);
  a51=(a34*a36);
  a51=(a50-a51);
  a51=(a51/a07);
  a52=casadi_fabs(a51);
  a53=arg[11]? arg[11][4] : 0;
  a52=(a52/a53);
  a43=casadi_fmax(a43,a52);
  a43=sqrt(a43);
  a15=casadi_fmax(a15,a43);
  a43=4.;
  a05=(a43*a05);
  a23=(a23+a05);
  a23=(a01*a23);
  a23=(a04+a23);
  a23=(a04+a23);
  a04=(a04+a23);
  a04=(a01*a04);
  a04=(a03+a04);
  a04=(a03+a04);
  a03=(a03+a04);
  a04=(a03/a07);
  a35=(a35/a07);
  a35=(a35*a36);
  a04=(a04-a35);
  a35=(a17/a07);
  a35=(a35*a36);
  a35=(a42-a35);
  a35=(a36*a35);
  a23=(2.*a02);
  a02=(a02*a23);
  a00=(a00*a03);
  a02=(a02+a00);
  a00=(2.*a24);
  a24=(a24*a00);
  a31=(a43*a31);
  a37=(a37+a31);
  a37=(a01*a37);
  a37=(a30+a37);
  a37=(a30+a37);
  a30=(a30+a37);
  a30=(a01*a30);
  a30=(a29+a30);
  a30=(a29+a30);
  a29=(a29+a30);
  a14=(a14*a29);
  a24=(a24+a14);
  a02=(a02+a24);
  a24=(2.*a13);
  a13=(a13*a24);
  a26=(a43*a26);
  a38=(a38+a26);
  a38=(a01*a38);
  a38=(a16+a38);
  a38=(a16+a38);
  a16=(a16+a38);
  a16=(a01*a16);
  a16=(a25+a16);
  a16=(a25+a16);
  a25=(a25+a16);
  a28=(a28*a25);
  a13=(a13+a28);
  a02=(a02+a13);
  a13=(2.*a19);
  a19=(a19*a13);
  a22=(a43*a22);
  a39=(a39+a22);
  a39=(a01*a39);
  a39=(a21+a39);
  a39=(a21+a39);
  a21=(a21+a39);
  a21=(a01*a21);
  a21=(a20+a21);
  a21=(a20+a21);
  a20=(a20+a21);
  a18=(a18*a20);
  a19=(a19+a18);
  a19=(a06*a19);
  a02=(a02+a19);
  a19=(2.*a09);
  a09=(a09*a19);
  a43=(a43*a12);
  a40=(a40+a43);
  a40=(a01*a40);
  a40=(a11+a40);
  a40=(a11+a40);
  a11=(a11+a40);
  a01=(a01*a11);
  a01=(a10+a01);
  a01=(a10+a01);
  a10=(a10+a01);
  a08=(a08*a10);
  a09=(a09+a08);
  a06=(a06*a09);
  a02=(a02+a06);
  a02=(a02/a41);
  a41=(a36/a41);
  a06=(2.*a36);
  a41=(a41*a06);
  a02=(a02-a41);
  a17=(a17*a02);
  a35=(a35+a17);
  a04=(a04-a35);
  a04=(a04/a07);
  a42=(a42/a07);
  a42=(a42*a36);
  a04=(a04-a42);
  a04=(a04/a07);
  a04=casadi_fabs(a04);
  a42=arg[12]? arg[12][0] : 0;
  a04=(a04/a42);
  a29=(a29/a07);
  a44=(a44/a07);
  a44=(a44*a36);
  a29=(a29-a44);
  a44=(a27/a07);
  a44=(a44*a36);
  a44=(a45-a44);
  a44=(a36*a44);
  a27=(a27*a02);
  a44=(a44+a27);
  a29=(a29-a44);
  a29=(a29/a07);
  a45=(a45/a07);
  a45=(a45*a36);
  a29=(a29-a45);
  a29=(a29/a07);
  a29=casadi_fabs(a29);
  a45=arg[12]? arg[12][1] : 0;
  a29=(a29/a45);
  a04=casadi_fmax(a04,a29);
  a25=(a25/a07);
  a46=(a46/a07);
  a46=(a46*a36);
  a25=(a25-a46);
  a46=(a32/a07);
  a46=(a46*a36);
  a46=(a47-a46);
  a46=(a36*a46);
  a32=(a32*a02);
  a46=(a46+a32);
  a25=(a25-a46);
  a25=(a25/a07);
  a47=(a47/a07);
  a47=(a47*a36);
  a25=(a25-a47);
  a25=(a25/a07);
  a25=casadi_fabs(a25);
  a47=arg[12]? arg[12][2] : 0;
  a25=(a25/a47);
  a04=casadi_fmax(a04,a25);
  a20=(a20/a07);
  a48=(a48/a07);
  a48=(a48*a36);
  a20=(a20-a48);
  a48=(a33/a07);
  a48=(a48*a36);
  a48=(a49-a48);
  a48=(a36*a48);
  a33=(a33*a02);
  a48=(a48+a33);
  a20=(a20-a48);
  a20=(a20/a07);
  a49=(a49/a07);
  a49=(a49*a36);
  a20=(a20-a49);
  a20=(a20/a07);
  a20=casadi_fabs(a20);
  a49=arg[12]? arg[12][3] : 0;
  a20=(a20/a49);
  a04=casadi_fmax(a04,a20);
  a10=(a10/a07);
  a50=(a50/a07);
  a50=(a50*a36);
  a10=(a10-a50);
  a50=(a34/a07);
  a50=(a50*a36);
  a50=(a51-a50);
  a50=(a36*a50);
  a34=(a34*a02);
  a50=(a50+a34);
  a10=(a10-a50);
  a10=(a10/a07);
  a51=(a51/a07);
  a51=(a51*a36);
  a10=(a10-a51);
  a10=(a10/a07);
  a10=casadi_fabs(a10);
  a51=arg[12]? arg[12][4] : 0;
  a10=(a10/a51);
  a04=casadi_fmax(a04,a10);
  a10=3.3333333333333331e-01;
  a04=pow(a04,a10);
  a15=casadi_fmax(a15,a04);
  if (res[0]!=0) res[0][0]=a15;
  if (res[1]!=0) res[1][0]=a07;
  return 0;
}

#if defined(__GNUC__)
#pragma GCC diagnostic pop
#endif

static int gm_pace_in_quintic_block_axes_0_inside(const double *x)
{
  static const double low[5] = {-5000.000005, -5000.000005, -5000.000005, -5000.000005, -5000.000005};
  static const double high[5] = {5000.000005, 5000.000005, 5000.000005, 5000.000005, 5000.000005};
  return gm_inside(x, 5, low, high);
}
static int gm_pace_in_quintic_block_axes_1_inside(const double *x)
{
  static const double low[5] = {-5000.000005, -5000.000005, -5000.000005, -5000.000005, -5000.000005};
  static const double high[5] = {5000.000005, 5000.000005, 5000.000005, 5000.000005, 5000.000005};
  return gm_inside(x, 5, low, high);
}
static int gm_pace_in_quintic_block_axes_2_inside(const double *x)
{
  static const double low[5] = {-5000.000005, -5000.000005, -5000.000005, -5000.000005, -5000.000005};
  static const double high[5] = {5000.000005, 5000.000005, 5000.000005, 5000.000005, 5000.000005};
  return gm_inside(x, 5, low, high);
}
static int gm_pace_in_quintic_block_axes_3_inside(const double *x)
{
  static const double low[5] = {-5000.000005, -5000.000005, -5000.000005, -5000.000005, -5000.000005};
  static const double high[5] = {5000.000005, 5000.000005, 5000.000005, 5000.000005, 5000.000005};
  return gm_inside(x, 5, low, high);
}
static int gm_pace_in_quintic_block_axes_4_inside(const double *x)
{
  static const double low[5] = {-5000.000005, -5000.000005, -5000.000005, -5000.000005, -5000.000005};
  static const double high[5] = {5000.000005, 5000.000005, 5000.000005, 5000.000005, 5000.000005};
  return gm_inside(x, 5, low, high);
}
static int gm_pace_in_quintic_block_axes_5_inside(const double *x)
{
  static const double low[5] = {-5000.000005, -5000.000005, -5000.000005, -5000.000005, -5000.000005};
  static const double high[5] = {5000.000005, 5000.000005, 5000.000005, 5000.000005, 5000.000005};
  return gm_inside(x, 5, low, high);
}
static int gm_pace_in_quintic_block_fraction_inside(const double *x)
{
  static const double low[1] = {-1e-08};
  static const double high[1] = {10.00000001};
  return gm_inside(x, 1, low, high);
}
static int gm_pace_in_quintic_block_point_w_inside(const double *x)
{
  static const double low[3] = {-5000.000005, -5000.000005, -5000.000005};
  static const double high[3] = {5000.000005, 5000.000005, 5000.000005};
  return gm_inside(x, 3, low, high);
}
static int gm_pace_in_quintic_block_pivot_height_inside(const double *x)
{
  static const double low[1] = {-10000.00001};
  static const double high[1] = {10000.00001};
  return gm_inside(x, 1, low, high);
}
static int gm_pace_in_quintic_block_pivot_offset_inside(const double *x)
{
  static const double low[3] = {-1000.000001, -1000.000001, -1000.000001};
  static const double high[3] = {1000.000001, 1000.000001, 1000.000001};
  return gm_inside(x, 3, low, high);
}
static int gm_pace_in_quintic_block_max_speed_inside(const double *x)
{
  static const double low[5] = {0.0, 0.0, 0.0, 0.0, 0.0};
  static const double high[5] = {100000.0001, 100000.0001, 100000.0001, 100000.0001, 100000.0001};
  return gm_inside(x, 5, low, high);
}
static int gm_pace_in_quintic_block_max_acceleration_inside(const double *x)
{
  static const double low[5] = {-0.0099, -0.0099, -0.0099, -0.0099, -0.0099};
  static const double high[5] = {10000000.01, 10000000.01, 10000000.01, 10000000.01, 10000000.01};
  return gm_inside(x, 5, low, high);
}
static int gm_pace_in_quintic_block_max_jerk_inside(const double *x)
{
  static const double low[5] = {-9.9999, -9.9999, -9.9999, -9.9999, -9.9999};
  static const double high[5] = {10000000010.0, 10000000010.0, 10000000010.0, 10000000010.0, 10000000010.0};
  return gm_inside(x, 5, low, high);
}
static int gm_pace_in_quintic_block_feed_inside(const double *x)
{
  static const double low[1] = {0.0};
  static const double high[1] = {20000.00002};
  return gm_inside(x, 1, low, high);
}

static int gm_pace_in_quintic_block_point(
    const double *axes_0,
    const double *axes_1,
    const double *axes_2,
    const double *axes_3,
    const double *axes_4,
    const double *axes_5,
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
  const double *arg[14];
  double *res[2];
  arg[0] = axes_0;
  arg[1] = axes_1;
  arg[2] = axes_2;
  arg[3] = axes_3;
  arg[4] = axes_4;
  arg[5] = axes_5;
  arg[6] = fraction;
  arg[7] = point_w;
  arg[8] = pivot_height;
  arg[9] = pivot_offset;
  arg[10] = max_speed;
  arg[11] = max_acceleration;
  arg[12] = max_jerk;
  arg[13] = feed;
  res[0] = pace;
  res[1] = path_rate;
  (void)casadi_f0(arg, res, 0, 0, 0);
  return gm_finite(pace, 1) && gm_finite(path_rate, 1) ? GM_OK : GM_E_NO_RESULT;
}


int gm_pace_in_quintic_block(
    const double axes_0[5],
    const double axes_1[5],
    const double axes_2[5],
    const double axes_3[5],
    const double axes_4[5],
    const double axes_5[5],
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
  if (!axes_0 || !axes_1 || !axes_2 || !axes_3 || !axes_4 || !axes_5 || !point_w || !pivot_offset || !max_speed || !max_acceleration || !max_jerk || !pace || !path_rate) return GM_E_NULL;
  if (gm_pace_in_quintic_block_axes_0_inside(axes_0)
      && gm_pace_in_quintic_block_axes_1_inside(axes_1)
      && gm_pace_in_quintic_block_axes_2_inside(axes_2)
      && gm_pace_in_quintic_block_axes_3_inside(axes_3)
      && gm_pace_in_quintic_block_axes_4_inside(axes_4)
      && gm_pace_in_quintic_block_axes_5_inside(axes_5)
      && gm_pace_in_quintic_block_fraction_inside(&fraction)
      && gm_pace_in_quintic_block_point_w_inside(point_w)
      && gm_pace_in_quintic_block_pivot_height_inside(&pivot_height)
      && gm_pace_in_quintic_block_pivot_offset_inside(pivot_offset)
      && gm_pace_in_quintic_block_max_speed_inside(max_speed)
      && gm_pace_in_quintic_block_max_acceleration_inside(max_acceleration)
      && gm_pace_in_quintic_block_max_jerk_inside(max_jerk)
      && gm_pace_in_quintic_block_feed_inside(&feed)) {
    status = gm_pace_in_quintic_block_point(
        axes_0,
        axes_1,
        axes_2,
        axes_3,
        axes_4,
        axes_5,
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

int gm_pace_in_quintic_block_batch(
    int64_t n,
    const double *axes_0, int64_t axes_0_stride,
    const double *axes_1, int64_t axes_1_stride,
    const double *axes_2, int64_t axes_2_stride,
    const double *axes_3, int64_t axes_3_stride,
    const double *axes_4, int64_t axes_4_stride,
    const double *axes_5, int64_t axes_5_stride,
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
  if (n < 0 || axes_0_stride < 0 || axes_1_stride < 0 || axes_2_stride < 0 || axes_3_stride < 0 || axes_4_stride < 0 || axes_5_stride < 0 || fraction_stride < 0 || point_w_stride < 0 || pivot_height_stride < 0 || pivot_offset_stride < 0 || max_speed_stride < 0 || max_acceleration_stride < 0 || max_jerk_stride < 0 || feed_stride < 0) return GM_E_SIZE;
  if (n == 0) return GM_OK;
  if (!axes_0 || !axes_1 || !axes_2 || !axes_3 || !axes_4 || !axes_5 || !fraction || !point_w || !pivot_height || !pivot_offset || !max_speed || !max_acceleration || !max_jerk || !feed || !pace || !path_rate) return GM_E_NULL;
  shared = (axes_0_stride != 0 || gm_pace_in_quintic_block_axes_0_inside(axes_0))
      && (axes_1_stride != 0 || gm_pace_in_quintic_block_axes_1_inside(axes_1))
      && (axes_2_stride != 0 || gm_pace_in_quintic_block_axes_2_inside(axes_2))
      && (axes_3_stride != 0 || gm_pace_in_quintic_block_axes_3_inside(axes_3))
      && (axes_4_stride != 0 || gm_pace_in_quintic_block_axes_4_inside(axes_4))
      && (axes_5_stride != 0 || gm_pace_in_quintic_block_axes_5_inside(axes_5))
      && (fraction_stride != 0 || gm_pace_in_quintic_block_fraction_inside(fraction))
      && (point_w_stride != 0 || gm_pace_in_quintic_block_point_w_inside(point_w))
      && (pivot_height_stride != 0 || gm_pace_in_quintic_block_pivot_height_inside(pivot_height))
      && (pivot_offset_stride != 0 || gm_pace_in_quintic_block_pivot_offset_inside(pivot_offset))
      && (max_speed_stride != 0 || gm_pace_in_quintic_block_max_speed_inside(max_speed))
      && (max_acceleration_stride != 0 || gm_pace_in_quintic_block_max_acceleration_inside(max_acceleration))
      && (max_jerk_stride != 0 || gm_pace_in_quintic_block_max_jerk_inside(max_jerk))
      && (feed_stride != 0 || gm_pace_in_quintic_block_feed_inside(feed));
  for (k = 0; k < n; ++k) {
    int now = GM_E_DOMAIN;
    if (shared
        && (axes_0_stride == 0 || gm_pace_in_quintic_block_axes_0_inside(axes_0 + k * axes_0_stride))
        && (axes_1_stride == 0 || gm_pace_in_quintic_block_axes_1_inside(axes_1 + k * axes_1_stride))
        && (axes_2_stride == 0 || gm_pace_in_quintic_block_axes_2_inside(axes_2 + k * axes_2_stride))
        && (axes_3_stride == 0 || gm_pace_in_quintic_block_axes_3_inside(axes_3 + k * axes_3_stride))
        && (axes_4_stride == 0 || gm_pace_in_quintic_block_axes_4_inside(axes_4 + k * axes_4_stride))
        && (axes_5_stride == 0 || gm_pace_in_quintic_block_axes_5_inside(axes_5 + k * axes_5_stride))
        && (fraction_stride == 0 || gm_pace_in_quintic_block_fraction_inside(fraction + k * fraction_stride))
        && (point_w_stride == 0 || gm_pace_in_quintic_block_point_w_inside(point_w + k * point_w_stride))
        && (pivot_height_stride == 0 || gm_pace_in_quintic_block_pivot_height_inside(pivot_height + k * pivot_height_stride))
        && (pivot_offset_stride == 0 || gm_pace_in_quintic_block_pivot_offset_inside(pivot_offset + k * pivot_offset_stride))
        && (max_speed_stride == 0 || gm_pace_in_quintic_block_max_speed_inside(max_speed + k * max_speed_stride))
        && (max_acceleration_stride == 0 || gm_pace_in_quintic_block_max_acceleration_inside(max_acceleration + k * max_acceleration_stride))
        && (max_jerk_stride == 0 || gm_pace_in_quintic_block_max_jerk_inside(max_jerk + k * max_jerk_stride))
        && (feed_stride == 0 || gm_pace_in_quintic_block_feed_inside(feed + k * feed_stride))) {
      now = gm_pace_in_quintic_block_point(
          axes_0 + k * axes_0_stride,
          axes_1 + k * axes_1_stride,
          axes_2 + k * axes_2_stride,
          axes_3 + k * axes_3_stride,
          axes_4 + k * axes_4_stride,
          axes_5 + k * axes_5_stride,
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
