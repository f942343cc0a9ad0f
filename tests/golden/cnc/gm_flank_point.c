/* gm_flank_point: generated, do not edit. */
#include "gm_flank_point.h"
#include "gm_check.h"

#include <math.h>

#if defined(__GNUC__)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-parameter"
#pragma GCC diagnostic ignored "-Wunused-function"
#endif

#define casadi_real double
#define casadi_int int
#define CASADI_PREFIX(ID) gm_flank_point_ ## ID
#define casadi_copy CASADI_PREFIX(copy)
#define casadi_f0 CASADI_PREFIX(f0)
#define casadi_f1 CASADI_PREFIX(f1)
#define casadi_f2 CASADI_PREFIX(f2)
#define casadi_fabs CASADI_PREFIX(fabs)
#define casadi_fmax CASADI_PREFIX(fmax)
#define casadi_sq CASADI_PREFIX(sq)
#define casadi_zeros CASADI_PREFIX(zeros)

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

static void casadi_copy(const casadi_real* x, casadi_int n, casadi_real* y) {
  casadi_int i;
  if (y) {
    if (x) {
      for (i=0; i<n; ++i) *y++ = *x++;
    } else {
      for (i=0; i<n; ++i) *y++ = 0.;
    }
  }
}

static const casadi_real casadi_zeros[12] = 
  {0.};

/* flank_newton_step:(i0[3],i1[12],i2,i3,i4)->(o0[3]) */
static int casadi_f1(const casadi_real** arg, casadi_real** res, casadi_int* iw, casadi_real* w, int mem) {
  casadi_real a00, a01, a02, a03, a04, a05, a06, a07, a08, a09, a10, a11;
  casadi_real a12, a13, a14, a15, a16, a17, a18, a19, a20, a21, a22, a23;
  casadi_real a24, a25, a26, a27, a28, a29, a30, a31, a32, a33, a34, a35;
  casadi_real a36, a37, a38, a39, a40, a41, a42, a43, a44, a45, a46, a47;
  casadi_real a48, a49, a50, a51, a52, a53, a54, a55, a56, a57, a58, a59;
  casadi_real a60, a61;
  a00=arg[0]? arg[0][0] : 0;
  a01=arg[1]? arg[1][7] : 0;
  a02=sin(a01);
  a03=arg[1]? arg[1][6] : 0;
  a04=(a02*a03);
  a05=arg[1]? arg[1][5] : 0;
  a04=(a04-a05);
  a06=arg[1]? arg[1][2] : 0;
  a07=sin(a06);
  a08=arg[1]? arg[1][10] : 0;
  a09=arg[2]? arg[2][0] : 0;
  a10=(a09*a00);
  a11=arg[1]? arg[1][11] : 0;
  a12=tan(a11);
  a10=(a10*a12);
  a10=(a08+a10);
  a13=arg[0]? arg[0][1] : 0;
  a14=sin(a13);
  a15=(a10*a14);
  a16=(a07*a15);
  a04=(a04+a16);
  a16=cos(a06);
  a17=(a16*a00);
  a04=(a04-a17);
  a17=(a02*a04);
  a18=arg[1]? arg[1][1] : 0;
  a19=arg[0]? arg[0][2] : 0;
  a20=(a18+a19);
  a21=arg[1]? arg[1][3] : 0;
  a22=(a20+a21);
  a23=cos(a22);
  a24=cos(a13);
  a25=(a24*a10);
  a26=(a23*a25);
  a27=cos(a01);
  a28=(a27*a03);
  a26=(a26+a28);
  a28=arg[1]? arg[1][0] : 0;
  a29=cos(a20);
  a29=(a28*a29);
  a26=(a26+a29);
  a29=sin(a22);
  a15=(a16*a15);
  a30=(a07*a00);
  a15=(a15+a30);
  a30=(a29*a15);
  a26=(a26-a30);
  a30=(a26*a27);
  a17=(a17+a30);
  a30=arg[3]? arg[3][0] : 0;
  a17=(a17-a30);
  a26=(a02*a26);
  a04=(a04*a27);
  a26=(a26-a04);
  a04=arg[1]? arg[1][9] : 0;
  a30=arg[1]? arg[1][8] : 0;
  a31=(a30*a19);
  a04=(a04+a31);
  a31=cos(a04);
  a32=(a26*a31);
  a33=arg[1]? arg[1][4] : 0;
  a34=(a29*a25);
  a34=(a33+a34);
  a35=(a23*a15);
  a34=(a34+a35);
  a35=sin(a20);
  a35=(a28*a35);
  a34=(a34+a35);
  a35=sin(a04);
  a36=(a34*a35);
  a32=(a32+a36);
  a36=(2.*a32);
  a37=cos(a13);
  a37=(a10*a37);
  a38=(a16*a37);
  a39=(a23*a38);
  a40=sin(a13);
  a10=(a10*a40);
  a40=(a29*a10);
  a39=(a39-a40);
  a40=(a35*a39);
  a10=(a23*a10);
  a38=(a29*a38);
  a10=(a10+a38);
  a38=(a02*a10);
  a37=(a07*a37);
  a41=(a27*a37);
  a38=(a38+a41);
  a41=(a31*a38);
  a40=(a40-a41);
  a40=(a36*a40);
  a41=(a31*a34);
  a42=(a26*a35);
  a41=(a41-a42);
  a42=(2.*a41);
  a39=(a31*a39);
  a38=(a35*a38);
  a39=(a39+a38);
  a39=(a42*a39);
  a40=(a40+a39);
  a39=arg[4]? arg[4][0] : 0;
  a38=(2.*a39);
  a40=(a40/a38);
  a43=sin(a11);
  a44=sin(a06);
  a45=(a43*a44);
  a06=cos(a06);
  a46=sin(a13);
  a47=cos(a11);
  a47=(a09*a47);
  a48=(a46*a47);
  a49=(a06*a48);
  a45=(a45-a49);
  a18=(a18+a19);
  a21=(a18+a21);
  a49=cos(a21);
  a50=(a45*a49);
  a51=sin(a21);
  a52=cos(a13);
  a53=(a52*a47);
  a54=(a51*a53);
  a50=(a50-a54);
  a54=sin(a01);
  a55=(a09*a00);
  a11=tan(a11);
  a55=(a55*a11);
  a08=(a08+a55);
  a55=(a52*a08);
  a56=sin(a21);
  a57=(a55*a56);
  a58=sin(a18);
  a58=(a28*a58);
  a57=(a57+a58);
  a58=(a44*a00);
  a59=(a08*a46);
  a60=(a59*a06);
  a58=(a58+a60);
  a21=cos(a21);
  a60=(a58*a21);
  a57=(a57+a60);
  a60=(a54*a57);
  a60=(a30*a60);
  a60=(a60-a57);
  a60=(a50*a60);
  a57=(a55*a49);
  a61=cos(a18);
  a61=(a28*a61);
  a57=(a57+a61);
  a61=(a51*a58);
  a57=(a57-a61);
  a01=cos(a01);
  a61=(a01*a03);
  a61=(a57+a61);
  a61=(a54*a61);
  a59=(a44*a59);
  a59=(a59-a05);
  a03=(a54*a03);
  a59=(a59+a03);
  a03=(a06*a00);
  a59=(a59-a03);
  a59=(a01*a59);
  a61=(a61-a59);
  a61=(a30*a61);
  a57=(a57-a61);
  a61=(a45*a56);
  a59=(a53*a21);
  a61=(a61+a59);
  a61=(a57*a61);
  a60=(a60-a61);
  a61=(a51*a45);
  a59=(a53*a49);
  a61=(a61+a59);
  a59=(a55*a21);
  a03=(a58*a56);
  a59=(a59-a03);
  a03=cos(a18);
  a03=(a28*a03);
  a59=(a59+a03);
  a03=(a54*a59);
  a03=(a30*a03);
  a03=(a03-a59);
  a03=(a61*a03);
  a55=(a51*a55);
  a58=(a58*a49);
  a55=(a55+a58);
  a18=sin(a18);
  a18=(a28*a18);
  a55=(a55+a18);
  a33=(a55+a33);
  a18=(a54*a33);
  a18=(a18*a30);
  a18=(a18-a55);
  a45=(a45*a21);
  a53=(a53*a56);
  a45=(a45-a53);
  a45=(a18*a45);
  a03=(a03+a45);
  a60=(a60-a03);
  a43=(a43*a06);
  a48=(a44*a48);
  a43=(a43+a48);
  a59=(a01*a59);
  a59=(a30*a59);
  a59=(a43*a59);
  a60=(a60+a59);
  a60=(a60/a28);
  a59=(a40*a60);
  a48=cos(a22);
  a03=(a25*a48);
  a22=sin(a22);
  a45=(a15*a22);
  a03=(a03-a45);
  a45=cos(a20);
  a45=(a28*a45);
  a03=(a03+a45);
  a45=(a35*a03);
  a53=cos(a04);
  a53=(a53*a30);
  a56=(a34*a53);
  a45=(a45+a56);
  a25=(a25*a22);
  a20=sin(a20);
  a20=(a28*a20);
  a25=(a25+a20);
  a15=(a15*a48);
  a25=(a25+a15);
  a15=(a02*a25);
  a48=(a31*a15);
  a04=sin(a04);
  a04=(a04*a30);
  a20=(a26*a04);
  a48=(a48+a20);
  a45=(a45-a48);
  a45=(a36*a45);
  a03=(a31*a03);
  a34=(a34*a04);
  a03=(a03-a34);
  a26=(a26*a53);
  a15=(a35*a15);
  a26=(a26-a15);
  a03=(a03-a26);
  a03=(a42*a03);
  a45=(a45+a03);
  a45=(a45/a38);
  a03=sin(a13);
  a26=(a08*a03);
  a15=(a49*a26);
  a53=cos(a13);
  a08=(a08*a53);
  a34=(a06*a08);
  a04=(a51*a34);
  a15=(a15+a04);
  a04=(a54*a15);
  a08=(a44*a08);
  a08=(a01*a08);
  a04=(a04+a08);
  a04=(a30*a04);
  a04=(a04-a15);
  a04=(a50*a04);
  a03=(a47*a03);
  a15=(a51*a03);
  a47=(a47*a53);
  a53=(a06*a47);
  a08=(a49*a53);
  a15=(a15-a08);
  a15=(a57*a15);
  a04=(a04+a15);
  a34=(a49*a34);
  a26=(a51*a26);
  a34=(a34-a26);
  a26=(a54*a34);
  a26=(a30*a26);
  a26=(a26-a34);
  a26=(a61*a26);
  a53=(a51*a53);
  a03=(a49*a03);
  a53=(a53+a03);
  a53=(a18*a53);
  a26=(a26-a53);
  a04=(a04-a26);
  a34=(a01*a34);
  a34=(a30*a34);
  a34=(a43*a34);
  a33=(a01*a33);
  a33=(a33*a30);
  a47=(a44*a47);
  a47=(a33*a47);
  a34=(a34+a47);
  a04=(a04+a34);
  a04=(a04/a28);
  a34=(a45*a04);
  a59=(a59-a34);
  a34=(a17*a59);
  a32=casadi_sq(a32);
  a41=casadi_sq(a41);
  a32=(a32+a41);
  a39=casadi_sq(a39);
  a32=(a32-a39);
  a32=(a32/a38);
  a25=(a27*a25);
  a39=(a04*a25);
  a37=(a02*a37);
  a10=(a27*a10);
  a37=(a37-a10);
  a10=(a60*a37);
  a39=(a39+a10);
  a39=(a32*a39);
  a34=(a34-a39);
  a57=(a57*a50);
  a18=(a18*a61);
  a57=(a57-a18);
  a33=(a33*a43);
  a57=(a57+a33);
  a57=(a57/a28);
  a33=(a37*a45);
  a18=(a25*a40);
  a33=(a33+a18);
  a33=(a57*a33);
  a34=(a34+a33);
  a12=(a12*a09);
  a14=(a14*a12);
  a33=(a07*a14);
  a33=(a33-a16);
  a18=(a02*a33);
  a24=(a24*a12);
  a12=(a23*a24);
  a16=(a16*a14);
  a16=(a16+a07);
  a07=(a29*a16);
  a12=(a12-a07);
  a07=(a27*a12);
  a18=(a18+a07);
  a59=(a18*a59);
  a11=(a11*a09);
  a52=(a52*a11);
  a09=(a49*a52);
  a46=(a46*a11);
  a11=(a06*a46);
  a11=(a44+a11);
  a07=(a51*a11);
  a09=(a09-a07);
  a07=(a54*a09);
  a44=(a44*a46);
  a44=(a44-a06);
  a44=(a01*a44);
  a07=(a07-a44);
  a07=(a30*a07);
  a09=(a09-a07);
  a50=(a50*a09);
  a51=(a51*a52);
  a49=(a49*a11);
  a51=(a51+a49);
  a54=(a54*a51);
  a54=(a30*a54);
  a54=(a54-a51);
  a61=(a61*a54);
  a50=(a50-a61);
  a01=(a01*a51);
  a30=(a30*a01);
  a43=(a43*a30);
  a50=(a50+a43);
  a50=(a50/a28);
  a28=(a45*a50);
  a02=(a02*a12);
  a27=(a27*a33);
  a02=(a02-a27);
  a27=(a31*a02);
  a29=(a29*a24);
  a23=(a23*a16);
  a29=(a29+a23);
  a23=(a35*a29);
  a27=(a27+a23);
  a36=(a36*a27);
  a31=(a31*a29);
  a35=(a35*a02);
  a31=(a31-a35);
  a42=(a42*a31);
  a36=(a36+a42);
  a36=(a36/a38);
  a38=(a36*a60);
  a28=(a28-a38);
  a38=(a37*a28);
  a59=(a59+a38);
  a38=(a36*a04);
  a42=(a40*a50);
  a38=(a38-a42);
  a42=(a25*a38);
  a59=(a59-a42);
  a34=(a34/a59);
  a42=1.;
  a31=casadi_fabs(a34);
  a35=4.;
  a31=(a31/a35);
  a42=casadi_fmax(a42,a31);
  a28=(a17*a28);
  a60=(a60*a18);
  a31=(a50*a25);
  a60=(a60+a31);
  a60=(a32*a60);
  a28=(a28+a60);
  a25=(a25*a36);
  a45=(a18*a45);
  a25=(a25+a45);
  a25=(a57*a25);
  a28=(a28-a25);
  a28=(a28/a59);
  a25=casadi_fabs(a28);
  a45=2.9999999999999999e-01;
  a25=(a25/a45);
  a42=casadi_fmax(a42,a25);
  a17=(a17*a38);
  a50=(a50*a37);
  a04=(a04*a18);
  a50=(a50-a04);
  a32=(a32*a50);
  a17=(a17+a32);
  a18=(a18*a40);
  a37=(a37*a36);
  a18=(a18-a37);
  a57=(a57*a18);
  a17=(a17+a57);
  a17=(a17/a59);
  a59=casadi_fabs(a17);
  a59=(a59/a45);
  a42=casadi_fmax(a42,a59);
  a34=(a34/a42);
  a00=(a00-a34);
  if (res[0]!=0) res[0][0]=a00;
  a28=(a28/a42);
  a13=(a13-a28);
  if (res[0]!=0) res[0][1]=a13;
  a17=(a17/a42);
  a19=(a19-a17);
  if (res[0]!=0) res[0][2]=a19;
  return 0;
}

/* flank_at:(i0[3],i1[12],i2,i3,i4)->(o0[3],o1[3],o2) */
static int casadi_f2(const casadi_real** arg, casadi_real** res, casadi_int* iw, casadi_real* w, int mem) {
  casadi_real a00, a01, a02, a03, a04, a05, a06, a07, a08, a09, a10, a11;
  casadi_real a12, a13, a14, a15, a16, a17, a18, a19, a20, a21, a22, a23;
  casadi_real a24, a25, a26, a27, a28, a29, a30, a31, a32;
  a00=arg[1]? arg[1][7] : 0;
  a01=sin(a00);
  a02=arg[1]? arg[1][1] : 0;
  a03=arg[0]? arg[0][2] : 0;
  a04=(a02+a03);
  a05=arg[1]? arg[1][3] : 0;
  a06=(a04+a05);
  a07=cos(a06);
  a08=arg[0]? arg[0][1] : 0;
  a09=cos(a08);
  a10=arg[1]? arg[1][10] : 0;
  a11=arg[2]? arg[2][0] : 0;
  a12=arg[0]? arg[0][0] : 0;
  a13=(a11*a12);
  a14=arg[1]? arg[1][11] : 0;
  a15=tan(a14);
  a13=(a13*a15);
  a13=(a10+a13);
  a15=(a09*a13);
  a16=(a07*a15);
  a17=cos(a00);
  a18=arg[1]? arg[1][6] : 0;
  a19=(a17*a18);
  a16=(a16+a19);
  a19=arg[1]? arg[1][0] : 0;
  a20=cos(a04);
  a20=(a19*a20);
  a16=(a16+a20);
  a06=sin(a06);
  a20=arg[1]? arg[1][2] : 0;
  a21=cos(a20);
  a22=sin(a08);
  a13=(a13*a22);
  a23=(a21*a13);
  a24=sin(a20);
  a25=(a24*a12);
  a23=(a23+a25);
  a25=(a06*a23);
  a16=(a16-a25);
  a25=(a01*a16);
  a26=(a01*a18);
  a27=arg[1]? arg[1][5] : 0;
  a26=(a26-a27);
  a13=(a24*a13);
  a26=(a26+a13);
  a13=(a21*a12);
  a26=(a26-a13);
  a13=(a26*a17);
  a25=(a25-a13);
  a13=arg[1]? arg[1][9] : 0;
  a28=arg[1]? arg[1][8] : 0;
  a29=(a28*a03);
  a29=(a13+a29);
  a30=cos(a29);
  a31=(a25*a30);
  a32=arg[1]? arg[1][4] : 0;
  a15=(a06*a15);
  a15=(a32+a15);
  a23=(a07*a23);
  a15=(a15+a23);
  a04=sin(a04);
  a04=(a19*a04);
  a15=(a15+a04);
  a29=sin(a29);
  a04=(a15*a29);
  a31=(a31+a04);
  if (res[0]!=0) res[0][0]=a31;
  a15=(a30*a15);
  a25=(a25*a29);
  a15=(a15-a25);
  if (res[0]!=0) res[0][1]=a15;
  a26=(a01*a26);
  a16=(a16*a17);
  a26=(a26+a16);
  if (res[0]!=0) res[0][2]=a26;
  a26=sin(a14);
  a16=(a21*a26);
  a15=cos(a14);
  a15=(a11*a15);
  a22=(a15*a22);
  a25=(a24*a22);
  a16=(a16+a25);
  a25=(a16*a17);
  a24=(a24*a26);
  a21=(a21*a22);
  a24=(a24-a21);
  a21=(a06*a24);
  a09=(a09*a15);
  a15=(a07*a09);
  a21=(a21+a15);
  a15=(a01*a21);
  a25=(a25-a15);
  a15=(a30*a25);
  a07=(a07*a24);
  a06=(a06*a09);
  a07=(a07-a06);
  a06=(a29*a07);
  a15=(a15+a06);
  if (res[1]!=0) res[1][0]=a15;
  a30=(a30*a07);
  a29=(a29*a25);
  a30=(a30-a29);
  if (res[1]!=0) res[1][1]=a30;
  a01=(a01*a16);
  a21=(a21*a17);
  a01=(a01+a21);
  a01=(-a01);
  if (res[1]!=0) res[1][2]=a01;
  a01=sin(a00);
  a21=(a01*a18);
  a21=(a21-a27);
  a17=sin(a20);
  a16=(a11*a12);
  a30=tan(a14);
  a16=(a16*a30);
  a16=(a10+a16);
  a30=sin(a08);
  a30=(a16*a30);
  a29=(a17*a30);
  a21=(a21+a29);
  a29=cos(a20);
  a25=(a29*a12);
  a21=(a21-a25);
  a25=(a01*a21);
  a07=(a02+a03);
  a15=(a07+a05);
  a06=cos(a15);
  a09=cos(a08);
  a09=(a09*a16);
  a16=(a06*a09);
  a24=cos(a00);
  a22=(a24*a18);
  a16=(a16+a22);
  a22=cos(a07);
  a22=(a19*a22);
  a16=(a16+a22);
  a15=sin(a15);
  a29=(a29*a30);
  a17=(a17*a12);
  a29=(a29+a17);
  a17=(a15*a29);
  a16=(a16-a17);
  a17=(a16*a24);
  a25=(a25+a17);
  a17=arg[3]? arg[3][0] : 0;
  a25=(a25-a17);
  a25=casadi_sq(a25);
  a01=(a01*a16);
  a21=(a21*a24);
  a01=(a01-a21);
  a21=(a28*a03);
  a13=(a13+a21);
  a21=cos(a13);
  a24=(a01*a21);
  a15=(a15*a09);
  a15=(a32+a15);
  a06=(a06*a29);
  a15=(a15+a06);
  a07=sin(a07);
  a07=(a19*a07);
  a15=(a15+a07);
  a13=sin(a13);
  a07=(a15*a13);
  a24=(a24+a07);
  a24=casadi_sq(a24);
  a21=(a21*a15);
  a01=(a01*a13);
  a21=(a21-a01);
  a21=casadi_sq(a21);
  a24=(a24+a21);
  a21=arg[4]? arg[4][0] : 0;
  a01=casadi_sq(a21);
  a24=(a24-a01);
  a21=(2.*a21);
  a24=(a24/a21);
  a24=casadi_sq(a24);
  a25=(a25+a24);
  a24=cos(a08);
  a21=(a11*a12);
  a01=tan(a14);
  a21=(a21*a01);
  a10=(a10+a21);
  a21=(a24*a10);
  a02=(a02+a03);
  a05=(a02+a05);
  a03=cos(a05);
  a01=(a21*a03);
  a13=cos(a02);
  a13=(a19*a13);
  a01=(a01+a13);
  a05=sin(a05);
  a13=sin(a20);
  a15=(a13*a12);
  a08=sin(a08);
  a10=(a10*a08);
  a20=cos(a20);
  a07=(a10*a20);
  a15=(a15+a07);
  a07=(a05*a15);
  a01=(a01-a07);
  a07=sin(a00);
  a00=cos(a00);
  a06=(a00*a18);
  a06=(a01+a06);
  a06=(a07*a06);
  a10=(a13*a10);
  a10=(a10-a27);
  a18=(a07*a18);
  a10=(a10+a18);
  a12=(a20*a12);
  a10=(a10-a12);
  a10=(a00*a10);
  a06=(a06-a10);
  a06=(a28*a06);
  a01=(a01-a06);
  a06=sin(a14);
  a10=(a06*a13);
  a14=cos(a14);
  a11=(a11*a14);
  a08=(a08*a11);
  a14=(a20*a08);
  a10=(a10-a14);
  a14=(a10*a03);
  a24=(a24*a11);
  a11=(a05*a24);
  a14=(a14-a11);
  a01=(a01*a14);
  a21=(a05*a21);
  a15=(a15*a03);
  a21=(a21+a15);
  a02=sin(a02);
  a02=(a19*a02);
  a21=(a21+a02);
  a32=(a21+a32);
  a07=(a07*a32);
  a07=(a07*a28);
  a07=(a07-a21);
  a05=(a05*a10);
  a24=(a24*a03);
  a05=(a05+a24);
  a07=(a07*a05);
  a01=(a01-a07);
  a00=(a00*a32);
  a00=(a00*a28);
  a06=(a06*a20);
  a13=(a13*a08);
  a06=(a06+a13);
  a00=(a00*a06);
  a01=(a01+a00);
  a01=(a01/a19);
  a01=casadi_sq(a01);
  a25=(a25+a01);
  a25=sqrt(a25);
  if (res[2]!=0) res[2][0]=a25;
  return 0;
}

/* flank_point:(contact_guess[3],settings[12],side,axial,radial)->(contact[3],point_w[3],normal_w[3],residual_size) */
static int casadi_f0(const casadi_real** arg, casadi_real** res, casadi_int* iw, casadi_real* w, int mem) {
  casadi_real **res1=res+4, *w0=w+62, w2, w3, w4, *w5=w+65, *w6=w+68, w7;
  const casadi_real **arg1=arg+5, *wr1;
  /* #0: @0 = input[0][0] */
  casadi_copy(arg[0], 3, w0);
  /* #1: @1 = input[1][0] */
  wr1 = arg[1] ? arg[1] : casadi_zeros;
  /* #2: @2 = input[2][0] */
  w2 = arg[2] ? arg[2][0] : 0;
  /* #3: @3 = input[3][0] */
  w3 = arg[3] ? arg[3][0] : 0;
  /* #4: @4 = input[4][0] */
  w4 = arg[4] ? arg[4][0] : 0;
  /* #5: @5 = flank_newton_step(@0, @1, @2, @3, @4) */
  arg1[0]=w0;
  arg1[1]=wr1;
  arg1[2]=(&w2);
  arg1[3]=(&w3);
  arg1[4]=(&w4);
  res1[0]=w5;
  if (casadi_f1(arg1, res1, iw, w, 0)) return 1;
  /* #6: @0 = flank_newton_step(@5, @1, @2, @3, @4) */
  arg1[0]=w5;
  arg1[1]=wr1;
  arg1[2]=(&w2);
  arg1[3]=(&w3);
  arg1[4]=(&w4);
  res1[0]=w0;
  if (casadi_f1(arg1, res1, iw, w, 0)) return 1;
  /* #7: @5 = flank_newton_step(@0, @1, @2, @3, @4) */
  arg1[0]=w0;
  arg1[1]=wr1;
  arg1[2]=(&w2);
  arg1[3]=(&w3);
  arg1[4]=(&w4);
  res1[0]=w5;
  if (casadi_f1(arg1, res1, iw, w, 0)) return 1;
  /* #8: @0 = flank_newton_step(@5, @1, @2, @3, @4) */
  arg1[0]=w5;
  arg1[1]=wr1;
  arg1[2]=(&w2);
  arg1[3]=(&w3);
  arg1[4]=(&w4);
  res1[0]=w0;
  if (casadi_f1(arg1, res1, iw, w, 0)) return 1;
  /* #9: @5 = flank_newton_step(@0, @1, @2, @3, @4) */
  arg1[0]=w0;
  arg1[1]=wr1;
  arg1[2]=(&w2);
  arg1[3]=(&w3);
  arg1[4]=(&w4);
  res1[0]=w5;
  if (casadi_f1(arg1, res1, iw, w, 0)) return 1;
  /* #10: output[0][0] = @5 */
  casadi_copy(w5, 3, res[0]);
  /* #11: {@0, @6, @7} = flank_at(@5, @1, @2, @3, @4) */
  arg1[0]=w5;
  arg1[1]=wr1;
  arg1[2]=(&w2);
  arg1[3]=(&w3);
  arg1[4]=(&w4);
  res1[0]=w0;
  res1[1]=w6;
  res1[2]=(&w7);
  if (casadi_f2(arg1, res1, iw, w, 0)) return 1;
  /* #12: output[1][0] = @0 */
  casadi_copy(w0, 3, res[1]);
  /* #13: output[2][0] = @6 */
  casadi_copy(w6, 3, res[2]);
  /* #14: output[3][0] = @7 */
  if (res[3]) res[3][0] = w7;
  return 0;
}

#if defined(__GNUC__)
#pragma GCC diagnostic pop
#endif

static int gm_flank_point_contact_guess_inside(const double *x)
{
  static const double low[3] = {-1.5000000000000002e-07, -31.415926567313857, -10.00000001};
  static const double high[3] = {150.00000015, 31.415926567313857, 10.00000001};
  return gm_inside(x, 3, low, high);
}
static int gm_flank_point_settings_inside(const double *x)
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
static int gm_flank_point_side_inside(const double *x)
{
  return x[0] == -1.0 || x[0] == 1.0;
}
static int gm_flank_point_axial_inside(const double *x)
{
  static const double low[1] = {0.499997};
  static const double high[1] = {3000.000003};
  return gm_inside(x, 1, low, high);
}
static int gm_flank_point_radial_inside(const double *x)
{
  static const double low[1] = {0.499997};
  static const double high[1] = {3000.000003};
  return gm_inside(x, 1, low, high);
}

static int gm_flank_point_point(
    const double *contact_guess,
    const double *settings,
    const double *side,
    const double *axial,
    const double *radial,
    double *contact,
    double *point_w,
    double *normal_w,
    double *residual_size)
{
  const double *arg[10];
  double *res[7];
  double w[71];
  arg[0] = contact_guess;
  arg[1] = settings;
  arg[2] = side;
  arg[3] = axial;
  arg[4] = radial;
  res[0] = contact;
  res[1] = point_w;
  res[2] = normal_w;
  res[3] = residual_size;
  if (casadi_f0(arg, res, 0, w, 0) != 0) return GM_E_NO_RESULT;
  return gm_finite(contact, 3) && gm_finite(point_w, 3) && gm_finite(normal_w, 3) && gm_finite(residual_size, 1) ? GM_OK : GM_E_NO_RESULT;
}


int gm_flank_point(
    const double contact_guess[3],
    const double settings[12],
    double side,
    double axial,
    double radial,
    double contact[3],
    double point_w[3],
    double normal_w[3],
    double *residual_size)
{
  int status = GM_E_DOMAIN;
  if (!contact_guess || !settings || !contact || !point_w || !normal_w || !residual_size) return GM_E_NULL;
  if (gm_flank_point_contact_guess_inside(contact_guess)
      && gm_flank_point_settings_inside(settings)
      && gm_flank_point_side_inside(&side)
      && gm_flank_point_axial_inside(&axial)
      && gm_flank_point_radial_inside(&radial)) {
    status = gm_flank_point_point(
        contact_guess,
        settings,
        &side,
        &axial,
        &radial,
        contact,
        point_w,
        normal_w,
        residual_size);
  }
  if (status != GM_OK) {
    gm_nan(contact, 3);
    gm_nan(point_w, 3);
    gm_nan(normal_w, 3);
    gm_nan(residual_size, 1);
  }
  return status;
}

int gm_flank_point_batch(
    int64_t n,
    const double *contact_guess, int64_t contact_guess_stride,
    const double *settings, int64_t settings_stride,
    const double *side, int64_t side_stride,
    const double *axial, int64_t axial_stride,
    const double *radial, int64_t radial_stride,
    double *contact,
    double *point_w,
    double *normal_w,
    double *residual_size,
    int64_t *first_bad)
{
  int status = GM_OK, shared;
  int64_t k;
  if (first_bad) *first_bad = -1;
  if (n < 0 || contact_guess_stride < 0 || settings_stride < 0 || side_stride < 0 || axial_stride < 0 || radial_stride < 0) return GM_E_SIZE;
  if (n == 0) return GM_OK;
  if (!contact_guess || !settings || !side || !axial || !radial || !contact || !point_w || !normal_w || !residual_size) return GM_E_NULL;
  shared = (contact_guess_stride != 0 || gm_flank_point_contact_guess_inside(contact_guess))
      && (settings_stride != 0 || gm_flank_point_settings_inside(settings))
      && (side_stride != 0 || gm_flank_point_side_inside(side))
      && (axial_stride != 0 || gm_flank_point_axial_inside(axial))
      && (radial_stride != 0 || gm_flank_point_radial_inside(radial));
  for (k = 0; k < n; ++k) {
    int now = GM_E_DOMAIN;
    if (shared
        && (contact_guess_stride == 0 || gm_flank_point_contact_guess_inside(contact_guess + k * contact_guess_stride))
        && (settings_stride == 0 || gm_flank_point_settings_inside(settings + k * settings_stride))
        && (side_stride == 0 || gm_flank_point_side_inside(side + k * side_stride))
        && (axial_stride == 0 || gm_flank_point_axial_inside(axial + k * axial_stride))
        && (radial_stride == 0 || gm_flank_point_radial_inside(radial + k * radial_stride))) {
      now = gm_flank_point_point(
          contact_guess + k * contact_guess_stride,
          settings + k * settings_stride,
          side + k * side_stride,
          axial + k * axial_stride,
          radial + k * radial_stride,
          contact + k * 3,
          point_w + k * 3,
          normal_w + k * 3,
          residual_size + k);
    }
    if (now != GM_OK) {
      gm_nan(contact + k * 3, 3);
      gm_nan(point_w + k * 3, 3);
      gm_nan(normal_w + k * 3, 3);
      gm_nan(residual_size + k, 1);
      if (status == GM_OK) {
        status = now;
        if (first_bad) *first_bad = k;
      }
    }
  }
  return status;
}
