/* gm_flank_on_line: generated, do not edit. */
#include "gm_flank_on_line.h"
#include "gm_check.h"

#include <math.h>

#if defined(__GNUC__)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-parameter"
#pragma GCC diagnostic ignored "-Wunused-function"
#endif

#define casadi_real double
#define casadi_int int
#define CASADI_PREFIX(ID) gm_flank_on_line_ ## ID
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

/* line_newton_step:(i0[3],i1[12],i2,i3[3],i4[3])->(o0[3]) */
static int casadi_f1(const casadi_real** arg, casadi_real** res, casadi_int* iw, casadi_real* w, int mem) {
  casadi_real a00, a01, a02, a03, a04, a05, a06, a07, a08, a09, a10, a11;
  casadi_real a12, a13, a14, a15, a16, a17, a18, a19, a20, a21, a22, a23;
  casadi_real a24, a25, a26, a27, a28, a29, a30, a31, a32, a33, a34, a35;
  casadi_real a36, a37, a38, a39, a40, a41, a42, a43, a44, a45, a46, a47;
  casadi_real a48, a49, a50, a51, a52, a53, a54, a55, a56, a57, a58, a59;
  casadi_real a60, a61, a62, a63, a64;
  a00=arg[0]? arg[0][0] : 0;
  a01=arg[4]? arg[4][1] : 0;
  a02=arg[4]? arg[4][0] : 0;
  a03=casadi_sq(a02);
  a04=casadi_sq(a01);
  a03=(a03+a04);
  a03=sqrt(a03);
  a04=(a01/a03);
  a05=arg[1]? arg[1][7] : 0;
  a06=sin(a05);
  a07=arg[1]? arg[1][1] : 0;
  a08=arg[0]? arg[0][2] : 0;
  a09=(a07+a08);
  a10=arg[1]? arg[1][3] : 0;
  a11=(a09+a10);
  a12=cos(a11);
  a13=arg[0]? arg[0][1] : 0;
  a14=cos(a13);
  a15=arg[1]? arg[1][10] : 0;
  a16=arg[2]? arg[2][0] : 0;
  a17=(a16*a00);
  a18=arg[1]? arg[1][11] : 0;
  a19=tan(a18);
  a17=(a17*a19);
  a17=(a15+a17);
  a20=(a14*a17);
  a21=(a12*a20);
  a22=cos(a05);
  a23=arg[1]? arg[1][6] : 0;
  a24=(a22*a23);
  a21=(a21+a24);
  a24=arg[1]? arg[1][0] : 0;
  a25=cos(a09);
  a25=(a24*a25);
  a21=(a21+a25);
  a25=sin(a11);
  a26=arg[1]? arg[1][2] : 0;
  a27=cos(a26);
  a28=sin(a13);
  a29=(a17*a28);
  a30=(a27*a29);
  a31=sin(a26);
  a32=(a31*a00);
  a30=(a30+a32);
  a32=(a25*a30);
  a21=(a21-a32);
  a32=(a06*a21);
  a33=(a06*a23);
  a34=arg[1]? arg[1][5] : 0;
  a33=(a33-a34);
  a29=(a31*a29);
  a33=(a33+a29);
  a29=(a27*a00);
  a33=(a33-a29);
  a29=(a33*a22);
  a32=(a32-a29);
  a29=arg[1]? arg[1][9] : 0;
  a35=arg[1]? arg[1][8] : 0;
  a36=(a35*a08);
  a29=(a29+a36);
  a36=cos(a29);
  a37=(a32*a36);
  a38=arg[1]? arg[1][4] : 0;
  a39=(a25*a20);
  a39=(a38+a39);
  a40=(a12*a30);
  a39=(a39+a40);
  a40=sin(a09);
  a40=(a24*a40);
  a39=(a39+a40);
  a40=sin(a29);
  a41=(a39*a40);
  a37=(a37+a41);
  a41=arg[3]? arg[3][0] : 0;
  a37=(a37-a41);
  a41=(a04*a37);
  a03=(a02/a03);
  a42=(a36*a39);
  a43=(a32*a40);
  a42=(a42-a43);
  a43=arg[3]? arg[3][1] : 0;
  a42=(a42-a43);
  a43=(a03*a42);
  a41=(a41-a43);
  a43=arg[4]? arg[4][2] : 0;
  a44=(a43*a03);
  a45=cos(a13);
  a45=(a17*a45);
  a46=(a27*a45);
  a47=(a12*a46);
  a48=sin(a13);
  a17=(a17*a48);
  a48=(a25*a17);
  a47=(a47-a48);
  a48=(a40*a47);
  a17=(a12*a17);
  a46=(a25*a46);
  a17=(a17+a46);
  a46=(a06*a17);
  a45=(a31*a45);
  a49=(a22*a45);
  a46=(a46+a49);
  a49=(a36*a46);
  a48=(a48-a49);
  a49=(a44*a48);
  a43=(a43*a04);
  a47=(a36*a47);
  a46=(a40*a46);
  a47=(a47+a46);
  a46=(a43*a47);
  a49=(a49+a46);
  a02=(a02*a03);
  a01=(a01*a04);
  a02=(a02+a01);
  a45=(a06*a45);
  a17=(a22*a17);
  a45=(a45-a17);
  a45=(a02*a45);
  a49=(a49-a45);
  a45=sin(a18);
  a17=sin(a26);
  a01=(a45*a17);
  a26=cos(a26);
  a46=sin(a13);
  a50=cos(a18);
  a50=(a16*a50);
  a51=(a46*a50);
  a52=(a26*a51);
  a01=(a01-a52);
  a07=(a07+a08);
  a10=(a07+a10);
  a52=cos(a10);
  a53=(a01*a52);
  a54=sin(a10);
  a55=cos(a13);
  a56=(a55*a50);
  a57=(a54*a56);
  a53=(a53-a57);
  a57=sin(a05);
  a58=(a16*a00);
  a18=tan(a18);
  a58=(a58*a18);
  a15=(a15+a58);
  a58=(a55*a15);
  a59=sin(a10);
  a60=(a58*a59);
  a61=sin(a07);
  a61=(a24*a61);
  a60=(a60+a61);
  a61=(a17*a00);
  a62=(a15*a46);
  a63=(a62*a26);
  a61=(a61+a63);
  a10=cos(a10);
  a63=(a61*a10);
  a60=(a60+a63);
  a63=(a57*a60);
  a63=(a35*a63);
  a63=(a63-a60);
  a63=(a53*a63);
  a60=(a58*a52);
  a64=cos(a07);
  a64=(a24*a64);
  a60=(a60+a64);
  a64=(a54*a61);
  a60=(a60-a64);
  a05=cos(a05);
  a64=(a05*a23);
  a64=(a60+a64);
  a64=(a57*a64);
  a62=(a17*a62);
  a62=(a62-a34);
  a23=(a57*a23);
  a62=(a62+a23);
  a23=(a26*a00);
  a62=(a62-a23);
  a62=(a05*a62);
  a64=(a64-a62);
  a64=(a35*a64);
  a60=(a60-a64);
  a64=(a01*a59);
  a62=(a56*a10);
  a64=(a64+a62);
  a64=(a60*a64);
  a63=(a63-a64);
  a64=(a54*a01);
  a62=(a56*a52);
  a64=(a64+a62);
  a62=(a58*a10);
  a23=(a61*a59);
  a62=(a62-a23);
  a23=cos(a07);
  a23=(a24*a23);
  a62=(a62+a23);
  a23=(a57*a62);
  a23=(a35*a23);
  a23=(a23-a62);
  a23=(a64*a23);
  a58=(a54*a58);
  a61=(a61*a52);
  a58=(a58+a61);
  a07=sin(a07);
  a07=(a24*a07);
  a58=(a58+a07);
  a38=(a58+a38);
  a07=(a57*a38);
  a07=(a07*a35);
  a07=(a07-a58);
  a01=(a01*a10);
  a56=(a56*a59);
  a01=(a01-a56);
  a01=(a07*a01);
  a23=(a23+a01);
  a63=(a63-a23);
  a45=(a45*a26);
  a51=(a17*a51);
  a45=(a45+a51);
  a62=(a05*a62);
  a62=(a35*a62);
  a62=(a45*a62);
  a63=(a63+a62);
  a63=(a63/a24);
  a62=(a49*a63);
  a51=cos(a11);
  a23=(a20*a51);
  a11=sin(a11);
  a01=(a30*a11);
  a23=(a23-a01);
  a01=cos(a09);
  a01=(a24*a01);
  a23=(a23+a01);
  a01=(a40*a23);
  a56=cos(a29);
  a56=(a56*a35);
  a59=(a39*a56);
  a01=(a01+a59);
  a20=(a20*a11);
  a09=sin(a09);
  a09=(a24*a09);
  a20=(a20+a09);
  a30=(a30*a51);
  a20=(a20+a30);
  a30=(a06*a20);
  a51=(a36*a30);
  a29=sin(a29);
  a29=(a29*a35);
  a09=(a32*a29);
  a51=(a51+a09);
  a01=(a01-a51);
  a51=(a44*a01);
  a23=(a36*a23);
  a39=(a39*a29);
  a23=(a23-a39);
  a32=(a32*a56);
  a30=(a40*a30);
  a32=(a32-a30);
  a23=(a23-a32);
  a32=(a43*a23);
  a51=(a51+a32);
  a20=(a22*a20);
  a20=(a02*a20);
  a51=(a51+a20);
  a20=sin(a13);
  a32=(a15*a20);
  a30=(a52*a32);
  a56=cos(a13);
  a15=(a15*a56);
  a39=(a26*a15);
  a29=(a54*a39);
  a30=(a30+a29);
  a29=(a57*a30);
  a15=(a17*a15);
  a15=(a05*a15);
  a29=(a29+a15);
  a29=(a35*a29);
  a29=(a29-a30);
  a29=(a53*a29);
  a20=(a50*a20);
  a30=(a54*a20);
  a50=(a50*a56);
  a56=(a26*a50);
  a15=(a52*a56);
  a30=(a30-a15);
  a30=(a60*a30);
  a29=(a29+a30);
  a39=(a52*a39);
  a32=(a54*a32);
  a39=(a39-a32);
  a32=(a57*a39);
  a32=(a35*a32);
  a32=(a32-a39);
  a32=(a64*a32);
  a56=(a54*a56);
  a20=(a52*a20);
  a56=(a56+a20);
  a56=(a07*a56);
  a32=(a32-a56);
  a29=(a29-a32);
  a39=(a05*a39);
  a39=(a35*a39);
  a39=(a45*a39);
  a38=(a05*a38);
  a38=(a38*a35);
  a50=(a17*a50);
  a50=(a38*a50);
  a39=(a39+a50);
  a29=(a29+a39);
  a29=(a29/a24);
  a39=(a51*a29);
  a62=(a62-a39);
  a39=(a41*a62);
  a37=(a44*a37);
  a42=(a43*a42);
  a37=(a37+a42);
  a33=(a06*a33);
  a21=(a21*a22);
  a33=(a33+a21);
  a21=arg[3]? arg[3][2] : 0;
  a33=(a33-a21);
  a33=(a02*a33);
  a37=(a37-a33);
  a01=(a04*a01);
  a23=(a03*a23);
  a01=(a01-a23);
  a23=(a29*a01);
  a48=(a04*a48);
  a47=(a03*a47);
  a48=(a48-a47);
  a47=(a63*a48);
  a23=(a23-a47);
  a23=(a37*a23);
  a39=(a39+a23);
  a60=(a60*a53);
  a07=(a07*a64);
  a60=(a60-a07);
  a38=(a38*a45);
  a60=(a60+a38);
  a60=(a60/a24);
  a38=(a48*a51);
  a07=(a01*a49);
  a38=(a38-a07);
  a38=(a60*a38);
  a39=(a39+a38);
  a19=(a19*a16);
  a14=(a14*a19);
  a38=(a12*a14);
  a28=(a28*a19);
  a19=(a27*a28);
  a19=(a19+a31);
  a07=(a25*a19);
  a38=(a38-a07);
  a07=(a06*a38);
  a31=(a31*a28);
  a31=(a31-a27);
  a27=(a22*a31);
  a07=(a07-a27);
  a27=(a36*a07);
  a25=(a25*a14);
  a12=(a12*a19);
  a25=(a25+a12);
  a12=(a40*a25);
  a27=(a27+a12);
  a04=(a04*a27);
  a36=(a36*a25);
  a40=(a40*a07);
  a36=(a36-a40);
  a03=(a03*a36);
  a04=(a04-a03);
  a62=(a04*a62);
  a18=(a18*a16);
  a55=(a55*a18);
  a16=(a52*a55);
  a46=(a46*a18);
  a18=(a26*a46);
  a18=(a17+a18);
  a03=(a54*a18);
  a16=(a16-a03);
  a03=(a57*a16);
  a17=(a17*a46);
  a17=(a17-a26);
  a17=(a05*a17);
  a03=(a03-a17);
  a03=(a35*a03);
  a16=(a16-a03);
  a53=(a53*a16);
  a54=(a54*a55);
  a52=(a52*a18);
  a54=(a54+a52);
  a57=(a57*a54);
  a57=(a35*a57);
  a57=(a57-a54);
  a64=(a64*a57);
  a53=(a53-a64);
  a05=(a05*a54);
  a35=(a35*a05);
  a45=(a45*a35);
  a53=(a53+a45);
  a53=(a53/a24);
  a24=(a51*a53);
  a44=(a44*a27);
  a43=(a43*a36);
  a44=(a44+a43);
  a06=(a06*a31);
  a22=(a22*a38);
  a06=(a06+a22);
  a02=(a02*a06);
  a44=(a44-a02);
  a02=(a44*a63);
  a24=(a24-a02);
  a02=(a48*a24);
  a62=(a62+a02);
  a02=(a44*a29);
  a06=(a49*a53);
  a02=(a02-a06);
  a06=(a01*a02);
  a62=(a62+a06);
  a39=(a39/a62);
  a06=1.;
  a22=casadi_fabs(a39);
  a06=casadi_fmax(a06,a22);
  a24=(a41*a24);
  a63=(a63*a04);
  a22=(a53*a01);
  a63=(a63-a22);
  a63=(a37*a63);
  a24=(a24+a63);
  a01=(a01*a44);
  a51=(a04*a51);
  a01=(a01-a51);
  a01=(a60*a01);
  a24=(a24+a01);
  a24=(a24/a62);
  a01=casadi_fabs(a24);
  a51=5.0000000000000003e-02;
  a01=(a01/a51);
  a06=casadi_fmax(a06,a01);
  a41=(a41*a02);
  a53=(a53*a48);
  a29=(a29*a04);
  a53=(a53-a29);
  a37=(a37*a53);
  a41=(a41+a37);
  a04=(a04*a49);
  a48=(a48*a44);
  a04=(a04-a48);
  a60=(a60*a04);
  a41=(a41+a60);
  a41=(a41/a62);
  a62=casadi_fabs(a41);
  a62=(a62/a51);
  a06=casadi_fmax(a06,a62);
  a39=(a39/a06);
  a00=(a00-a39);
  if (res[0]!=0) res[0][0]=a00;
  a24=(a24/a06);
  a13=(a13-a24);
  if (res[0]!=0) res[0][1]=a13;
  a41=(a41/a06);
  a08=(a08-a41);
  if (res[0]!=0) res[0][2]=a08;
  return 0;
}

/* line_at:(i0[3],i1[12],i2,i3[3],i4[3])->(o0,o1[12],o2) */
static int casadi_f2(const casadi_real** arg, casadi_real** res, casadi_int* iw, casadi_real* w, int mem) {
  casadi_real a00, a01, a02, a03, a04, a05, a06, a07, a08, a09, a10, a11;
  casadi_real a12, a13, a14, a15, a16, a17, a18, a19, a20, a21, a22, a23;
  casadi_real a24, a25, a26, a27, a28, a29, a30, a31, a32, a33, a34, a35;
  casadi_real a36, a37, a38, a39, a40, a41, a42, a43, a44, a45, a46, a47;
  casadi_real a48, a49, a50, a51, a52, a53, a54, a55;
  a00=arg[4]? arg[4][0] : 0;
  a01=arg[1]? arg[1][7] : 0;
  a02=sin(a01);
  a03=arg[1]? arg[1][1] : 0;
  a04=arg[0]? arg[0][2] : 0;
  a05=(a03+a04);
  a06=arg[1]? arg[1][3] : 0;
  a07=(a05+a06);
  a08=cos(a07);
  a09=arg[0]? arg[0][1] : 0;
  a10=cos(a09);
  a11=arg[1]? arg[1][10] : 0;
  a12=arg[2]? arg[2][0] : 0;
  a13=arg[0]? arg[0][0] : 0;
  a14=(a12*a13);
  a15=arg[1]? arg[1][11] : 0;
  a16=tan(a15);
  a14=(a14*a16);
  a14=(a11+a14);
  a16=(a10*a14);
  a17=(a08*a16);
  a18=cos(a01);
  a19=arg[1]? arg[1][6] : 0;
  a20=(a18*a19);
  a17=(a17+a20);
  a20=arg[1]? arg[1][0] : 0;
  a21=cos(a05);
  a21=(a20*a21);
  a17=(a17+a21);
  a07=sin(a07);
  a21=arg[1]? arg[1][2] : 0;
  a22=cos(a21);
  a23=sin(a09);
  a14=(a14*a23);
  a24=(a22*a14);
  a25=sin(a21);
  a26=(a25*a13);
  a24=(a24+a26);
  a26=(a07*a24);
  a17=(a17-a26);
  a26=(a02*a17);
  a27=(a02*a19);
  a28=arg[1]? arg[1][5] : 0;
  a27=(a27-a28);
  a14=(a25*a14);
  a27=(a27+a14);
  a14=(a22*a13);
  a27=(a27-a14);
  a14=(a27*a18);
  a26=(a26-a14);
  a14=arg[1]? arg[1][9] : 0;
  a29=arg[1]? arg[1][8] : 0;
  a30=(a29*a04);
  a30=(a14+a30);
  a31=cos(a30);
  a32=(a26*a31);
  a33=arg[1]? arg[1][4] : 0;
  a16=(a07*a16);
  a16=(a33+a16);
  a24=(a08*a24);
  a16=(a16+a24);
  a05=sin(a05);
  a05=(a20*a05);
  a16=(a16+a05);
  a30=sin(a30);
  a05=(a16*a30);
  a32=(a32+a05);
  a05=arg[3]? arg[3][0] : 0;
  a32=(a32-a05);
  a05=(a00*a32);
  a24=arg[4]? arg[4][1] : 0;
  a16=(a31*a16);
  a26=(a26*a30);
  a16=(a16-a26);
  a26=arg[3]? arg[3][1] : 0;
  a16=(a16-a26);
  a26=(a24*a16);
  a05=(a05+a26);
  a26=arg[4]? arg[4][2] : 0;
  a27=(a02*a27);
  a17=(a17*a18);
  a27=(a27+a17);
  a17=arg[3]? arg[3][2] : 0;
  a27=(a27-a17);
  a17=(a26*a27);
  a05=(a05+a17);
  if (res[0]!=0) res[0][0]=a05;
  a05=(a03+a04);
  a17=(a05+a06);
  a34=cos(a17);
  a35=sin(a15);
  a36=sin(a21);
  a37=(a35*a36);
  a38=cos(a15);
  a38=(a12*a38);
  a39=cos(a21);
  a40=sin(a09);
  a41=(a39*a40);
  a42=(a38*a41);
  a37=(a37-a42);
  a42=(a34*a37);
  a17=sin(a17);
  a43=cos(a09);
  a44=(a17*a43);
  a45=(a44*a38);
  a42=(a42-a45);
  a45=(a29*a04);
  a14=(a14+a45);
  a45=cos(a14);
  a46=(a42*a45);
  a35=(a39*a35);
  a47=(a36*a40);
  a48=(a47*a38);
  a35=(a35+a48);
  a48=cos(a01);
  a49=(a35*a48);
  a37=(a17*a37);
  a50=(a43*a34);
  a38=(a50*a38);
  a37=(a37+a38);
  a38=sin(a01);
  a51=(a37*a38);
  a49=(a49-a51);
  a14=sin(a14);
  a51=(a49*a14);
  a46=(a46-a51);
  a51=sin(a05);
  a52=(a45*a51);
  a05=cos(a05);
  a53=(a38*a05);
  a54=(a14*a53);
  a52=(a52-a54);
  a52=(a46*a52);
  a37=(a37*a48);
  a35=(a38*a35);
  a37=(a37+a35);
  a35=(a37*a48);
  a54=(a05*a35);
  a52=(a52-a54);
  a49=(a49*a45);
  a42=(a14*a42);
  a49=(a49+a42);
  a42=(a14*a51);
  a53=(a45*a53);
  a42=(a42+a53);
  a42=(a49*a42);
  a52=(a52+a42);
  a42=sin(a15);
  a53=(a22*a42);
  a54=cos(a15);
  a54=(a12*a54);
  a23=(a54*a23);
  a55=(a25*a23);
  a53=(a53+a55);
  a55=(a53*a18);
  a25=(a25*a42);
  a22=(a22*a23);
  a25=(a25-a22);
  a22=(a07*a25);
  a10=(a10*a54);
  a54=(a08*a10);
  a22=(a22+a54);
  a54=(a02*a22);
  a55=(a55-a54);
  a54=(a31*a55);
  a08=(a08*a25);
  a07=(a07*a10);
  a08=(a08-a07);
  a07=(a30*a08);
  a54=(a54+a07);
  a54=(a54*a00);
  a31=(a31*a08);
  a30=(a30*a55);
  a31=(a31-a30);
  a31=(a31*a24);
  a54=(a54+a31);
  a02=(a02*a53);
  a22=(a22*a18);
  a02=(a02+a22);
  a02=(a02*a26);
  a54=(a54-a02);
  a52=(a52/a54);
  if (res[1]!=0) res[1][0]=a52;
  a52=tan(a15);
  a02=(a12*a13);
  a22=(a52*a02);
  a22=(a11+a22);
  a50=(a50*a22);
  a18=(a36*a13);
  a53=(a40*a22);
  a31=(a39*a53);
  a31=(a18+a31);
  a30=(a17*a31);
  a50=(a50-a30);
  a05=(a05*a20);
  a05=(a50+a05);
  a30=(a45*a05);
  a55=(a34*a31);
  a22=(a44*a22);
  a55=(a55+a22);
  a51=(a51*a20);
  a51=(a55+a51);
  a22=(a38*a51);
  a08=(a14*a22);
  a30=(a30+a08);
  a30=(a46*a30);
  a08=(a14*a05);
  a22=(a45*a22);
  a08=(a08-a22);
  a08=(a49*a08);
  a30=(a30+a08);
  a08=(a35*a51);
  a30=(a30+a08);
  a30=(a30/a54);
  if (res[1]!=0) res[1][1]=a30;
  a39=(a39*a13);
  a36=(a36*a53);
  a53=(a39-a36);
  a30=(a34*a53);
  a08=(a45*a30);
  a53=(a17*a53);
  a22=(a38*a53);
  a07=(a31*a48);
  a22=(a22+a07);
  a07=(a14*a22);
  a08=(a08+a07);
  a08=(a46*a08);
  a30=(a14*a30);
  a22=(a45*a22);
  a30=(a30-a22);
  a30=(a49*a30);
  a08=(a08+a30);
  a31=(a38*a31);
  a53=(a53*a48);
  a31=(a31-a53);
  a31=(a37*a31);
  a08=(a08-a31);
  a08=(a08/a54);
  if (res[1]!=0) res[1][2]=a08;
  a08=(a45*a50);
  a31=(a38*a55);
  a53=(a14*a31);
  a08=(a08+a53);
  a08=(a46*a08);
  a50=(a14*a50);
  a31=(a45*a31);
  a50=(a50-a31);
  a50=(a49*a50);
  a08=(a08+a50);
  a35=(a35*a55);
  a08=(a08+a35);
  a08=(a08/a54);
  if (res[1]!=0) res[1][3]=a08;
  a08=(a14*a49);
  a35=(a45*a46);
  a08=(a08+a35);
  a08=(a08/a54);
  if (res[1]!=0) res[1][4]=a08;
  a08=(a38*a37);
  a35=(a14*a46);
  a55=(a35*a48);
  a08=(a08-a55);
  a55=(a45*a49);
  a55=(a55*a48);
  a08=(a08+a55);
  a08=(a08/a54);
  if (res[1]!=0) res[1][5]=a08;
  a08=(a37/a54);
  a08=(-a08);
  if (res[1]!=0) res[1][6]=a08;
  a08=(a45*a49);
  a36=(a36-a39);
  a36=(a36-a28);
  a55=(a38*a19);
  a36=(a36+a55);
  a55=(a38*a36);
  a50=(a48*a19);
  a05=(a05+a50);
  a50=(a05*a48);
  a55=(a55+a50);
  a50=casadi_sq(a48);
  a50=(a50*a19);
  a55=(a55-a50);
  a50=casadi_sq(a38);
  a50=(a50*a19);
  a55=(a55-a50);
  a08=(a08*a55);
  a36=(a36*a48);
  a05=(a38*a05);
  a36=(a36-a05);
  a05=(a37*a36);
  a35=(a35*a55);
  a05=(a05+a35);
  a08=(a08-a05);
  a08=(a08/a54);
  if (res[1]!=0) res[1][7]=a08;
  a08=(a45*a36);
  a05=(a08*a04);
  a51=(a51+a33);
  a35=(a14*a51);
  a55=(a35*a04);
  a05=(a05-a55);
  a05=(a46*a05);
  a36=(a14*a36);
  a55=(a36*a04);
  a50=(a45*a51);
  a50=(a50*a04);
  a55=(a55+a50);
  a55=(a49*a55);
  a05=(a05+a55);
  a05=(a05/a54);
  if (res[1]!=0) res[1][8]=a05;
  a08=(a08-a35);
  a08=(a46*a08);
  a51=(a45*a51);
  a36=(a36+a51);
  a36=(a49*a36);
  a08=(a08+a36);
  a08=(a08/a54);
  if (res[1]!=0) res[1][9]=a08;
  a08=(a34*a41);
  a08=(a44+a08);
  a36=(a45*a08);
  a51=(a43*a34);
  a41=(a17*a41);
  a51=(a51-a41);
  a41=(a38*a51);
  a35=(a47*a48);
  a41=(a41-a35);
  a35=(a14*a41);
  a36=(a36-a35);
  a36=(a46*a36);
  a08=(a14*a08);
  a41=(a45*a41);
  a08=(a08+a41);
  a08=(a49*a08);
  a36=(a36+a08);
  a47=(a38*a47);
  a51=(a51*a48);
  a47=(a47+a51);
  a47=(a37*a47);
  a36=(a36-a47);
  a36=(a36/a54);
  if (res[1]!=0) res[1][10]=a36;
  a36=1.;
  a52=casadi_sq(a52);
  a36=(a36+a52);
  a40=(a40*a36);
  a40=(a40*a12);
  a39=(a39*a40);
  a52=(a34*a39);
  a44=(a44*a02);
  a44=(a44*a36);
  a52=(a52+a44);
  a44=(a45*a52);
  a43=(a43*a34);
  a43=(a43*a36);
  a43=(a43*a12);
  a43=(a43*a13);
  a17=(a17*a39);
  a43=(a43-a17);
  a17=(a38*a43);
  a18=(a18*a40);
  a40=(a48*a18);
  a17=(a17-a40);
  a40=(a14*a17);
  a44=(a44-a40);
  a46=(a46*a44);
  a14=(a14*a52);
  a45=(a45*a17);
  a14=(a14+a45);
  a49=(a49*a14);
  a46=(a46+a49);
  a38=(a38*a18);
  a43=(a43*a48);
  a38=(a38+a43);
  a37=(a37*a38);
  a46=(a46-a37);
  a46=(a46/a54);
  if (res[1]!=0) res[1][11]=a46;
  a46=casadi_sq(a00);
  a54=casadi_sq(a24);
  a46=(a46+a54);
  a46=sqrt(a46);
  a54=(a24/a46);
  a37=(a54*a32);
  a46=(a00/a46);
  a38=(a46*a16);
  a37=(a37-a38);
  a37=casadi_sq(a37);
  a38=(a26*a46);
  a38=(a38*a32);
  a26=(a26*a54);
  a26=(a26*a16);
  a38=(a38+a26);
  a00=(a00*a46);
  a24=(a24*a54);
  a00=(a00+a24);
  a00=(a00*a27);
  a38=(a38-a00);
  a38=casadi_sq(a38);
  a37=(a37+a38);
  a38=cos(a09);
  a00=(a12*a13);
  a27=tan(a15);
  a00=(a00*a27);
  a11=(a11+a00);
  a00=(a38*a11);
  a03=(a03+a04);
  a06=(a03+a06);
  a04=cos(a06);
  a27=(a00*a04);
  a24=cos(a03);
  a24=(a20*a24);
  a27=(a27+a24);
  a06=sin(a06);
  a24=sin(a21);
  a54=(a24*a13);
  a09=sin(a09);
  a11=(a11*a09);
  a21=cos(a21);
  a46=(a11*a21);
  a54=(a54+a46);
  a46=(a06*a54);
  a27=(a27-a46);
  a46=sin(a01);
  a01=cos(a01);
  a26=(a01*a19);
  a26=(a27+a26);
  a26=(a46*a26);
  a11=(a24*a11);
  a11=(a11-a28);
  a19=(a46*a19);
  a11=(a11+a19);
  a13=(a21*a13);
  a11=(a11-a13);
  a11=(a01*a11);
  a26=(a26-a11);
  a26=(a29*a26);
  a27=(a27-a26);
  a26=sin(a15);
  a11=(a26*a24);
  a15=cos(a15);
  a12=(a12*a15);
  a09=(a09*a12);
  a15=(a21*a09);
  a11=(a11-a15);
  a15=(a11*a04);
  a38=(a38*a12);
  a12=(a06*a38);
  a15=(a15-a12);
  a27=(a27*a15);
  a00=(a06*a00);
  a54=(a54*a04);
  a00=(a00+a54);
  a03=sin(a03);
  a03=(a20*a03);
  a00=(a00+a03);
  a33=(a00+a33);
  a46=(a46*a33);
  a46=(a46*a29);
  a46=(a46-a00);
  a06=(a06*a11);
  a38=(a38*a04);
  a06=(a06+a38);
  a46=(a46*a06);
  a27=(a27-a46);
  a01=(a01*a33);
  a01=(a01*a29);
  a26=(a26*a21);
  a24=(a24*a09);
  a26=(a26+a24);
  a01=(a01*a26);
  a27=(a27+a01);
  a27=(a27/a20);
  a27=casadi_sq(a27);
  a37=(a37+a27);
  a37=sqrt(a37);
  if (res[2]!=0) res[2][0]=a37;
  return 0;
}

/* flank_on_line:(contact_guess[3],settings[12],side,line_point[3],line_direction[3])->(contact[3],deviation,sensitivity[12],residual_size) */
static int casadi_f0(const casadi_real** arg, casadi_real** res, casadi_int* iw, casadi_real* w, int mem) {
  casadi_real **res1=res+4, *w0=w+65, w2, *w3=w+68, *w4=w+71, *w5=w+74, w6, *w7=w+77, w8;
  const casadi_real **arg1=arg+5, *wr1;
  /* #0: @0 = input[0][0] */
  casadi_copy(arg[0], 3, w0);
  /* #1: @1 = input[1][0] */
  wr1 = arg[1] ? arg[1] : casadi_zeros;
  /* #2: @2 = input[2][0] */
  w2 = arg[2] ? arg[2][0] : 0;
  /* #3: @3 = input[3][0] */
  casadi_copy(arg[3], 3, w3);
  /* #4: @4 = input[4][0] */
  casadi_copy(arg[4], 3, w4);
  /* #5: @5 = line_newton_step(@0, @1, @2, @3, @4) */
  arg1[0]=w0;
  arg1[1]=wr1;
  arg1[2]=(&w2);
  arg1[3]=w3;
  arg1[4]=w4;
  res1[0]=w5;
  if (casadi_f1(arg1, res1, iw, w, 0)) return 1;
  /* #6: @0 = line_newton_step(@5, @1, @2, @3, @4) */
  arg1[0]=w5;
  arg1[1]=wr1;
  arg1[2]=(&w2);
  arg1[3]=w3;
  arg1[4]=w4;
  res1[0]=w0;
  if (casadi_f1(arg1, res1, iw, w, 0)) return 1;
  /* #7: @5 = line_newton_step(@0, @1, @2, @3, @4) */
  arg1[0]=w0;
  arg1[1]=wr1;
  arg1[2]=(&w2);
  arg1[3]=w3;
  arg1[4]=w4;
  res1[0]=w5;
  if (casadi_f1(arg1, res1, iw, w, 0)) return 1;
  /* #8: @0 = line_newton_step(@5, @1, @2, @3, @4) */
  arg1[0]=w5;
  arg1[1]=wr1;
  arg1[2]=(&w2);
  arg1[3]=w3;
  arg1[4]=w4;
  res1[0]=w0;
  if (casadi_f1(arg1, res1, iw, w, 0)) return 1;
  /* #9: @5 = line_newton_step(@0, @1, @2, @3, @4) */
  arg1[0]=w0;
  arg1[1]=wr1;
  arg1[2]=(&w2);
  arg1[3]=w3;
  arg1[4]=w4;
  res1[0]=w5;
  if (casadi_f1(arg1, res1, iw, w, 0)) return 1;
  /* #10: @0 = line_newton_step(@5, @1, @2, @3, @4) */
  arg1[0]=w5;
  arg1[1]=wr1;
  arg1[2]=(&w2);
  arg1[3]=w3;
  arg1[4]=w4;
  res1[0]=w0;
  if (casadi_f1(arg1, res1, iw, w, 0)) return 1;
  /* #11: output[0][0] = @0 */
  casadi_copy(w0, 3, res[0]);
  /* #12: {@6, @7, @8} = line_at(@0, @1, @2, @3, @4) */
  arg1[0]=w0;
  arg1[1]=wr1;
  arg1[2]=(&w2);
  arg1[3]=w3;
  arg1[4]=w4;
  res1[0]=(&w6);
  res1[1]=w7;
  res1[2]=(&w8);
  if (casadi_f2(arg1, res1, iw, w, 0)) return 1;
  /* #13: output[1][0] = @6 */
  if (res[1]) res[1][0] = w6;
  /* #14: output[2][0] = @7 */
  casadi_copy(w7, 12, res[2]);
  /* #15: output[3][0] = @8 */
  if (res[3]) res[3][0] = w8;
  return 0;
}

#if defined(__GNUC__)
#pragma GCC diagnostic pop
#endif

static int gm_flank_on_line_contact_guess_inside(const double *x)
{
  static const double low[3] = {-1.5000000000000002e-07, -31.415926567313857, -10.00000001};
  static const double high[3] = {150.00000015, 31.415926567313857, 10.00000001};
  return gm_inside(x, 3, low, high);
}
static int gm_flank_on_line_settings_inside(const double *x)
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
static int gm_flank_on_line_side_inside(const double *x)
{
  return x[0] == -1.0 || x[0] == 1.0;
}
static int gm_flank_on_line_line_point_inside(const double *x)
{
  static const double low[3] = {-2000.000002, -2000.000002, -2000.000002};
  static const double high[3] = {2000.000002, 2000.000002, 2000.000002};
  return gm_inside(x, 3, low, high);
}
static int gm_flank_on_line_line_direction_inside(const double *x)
{
  static const double low[3] = {-1.000000001, -1.000000001, -1.000000001};
  static const double high[3] = {1.000000001, 1.000000001, 1.000000001};
  return gm_inside(x, 3, low, high);
}

static int gm_flank_on_line_point(
    const double *contact_guess,
    const double *settings,
    const double *side,
    const double *line_point,
    const double *line_direction,
    double *contact,
    double *deviation,
    double *sensitivity,
    double *residual_size)
{
  const double *arg[10];
  double *res[7];
  double w[89];
  arg[0] = contact_guess;
  arg[1] = settings;
  arg[2] = side;
  arg[3] = line_point;
  arg[4] = line_direction;
  res[0] = contact;
  res[1] = deviation;
  res[2] = sensitivity;
  res[3] = residual_size;
  if (casadi_f0(arg, res, 0, w, 0) != 0) return GM_E_NO_RESULT;
  return gm_finite(contact, 3) && gm_finite(deviation, 1) && gm_finite(sensitivity, 12) && gm_finite(residual_size, 1) ? GM_OK : GM_E_NO_RESULT;
}


int gm_flank_on_line(
    const double contact_guess[3],
    const double settings[12],
    double side,
    const double line_point[3],
    const double line_direction[3],
    double contact[3],
    double *deviation,
    double sensitivity[12],
    double *residual_size)
{
  int status = GM_E_DOMAIN;
  if (!contact_guess || !settings || !line_point || !line_direction || !contact || !deviation || !sensitivity || !residual_size) return GM_E_NULL;
  if (gm_flank_on_line_contact_guess_inside(contact_guess)
      && gm_flank_on_line_settings_inside(settings)
      && gm_flank_on_line_side_inside(&side)
      && gm_flank_on_line_line_point_inside(line_point)
      && gm_flank_on_line_line_direction_inside(line_direction)) {
    status = gm_flank_on_line_point(
        contact_guess,
        settings,
        &side,
        line_point,
        line_direction,
        contact,
        deviation,
        sensitivity,
        residual_size);
  }
  if (status != GM_OK) {
    gm_nan(contact, 3);
    gm_nan(deviation, 1);
    gm_nan(sensitivity, 12);
    gm_nan(residual_size, 1);
  }
  return status;
}

int gm_flank_on_line_batch(
    int64_t n,
    const double *contact_guess, int64_t contact_guess_stride,
    const double *settings, int64_t settings_stride,
    const double *side, int64_t side_stride,
    const double *line_point, int64_t line_point_stride,
    const double *line_direction, int64_t line_direction_stride,
    double *contact,
    double *deviation,
    double *sensitivity,
    double *residual_size,
    int64_t *first_bad)
{
  int status = GM_OK, shared;
  int64_t k;
  if (first_bad) *first_bad = -1;
  if (n < 0 || contact_guess_stride < 0 || settings_stride < 0 || side_stride < 0 || line_point_stride < 0 || line_direction_stride < 0) return GM_E_SIZE;
  if (n == 0) return GM_OK;
  if (!contact_guess || !settings || !side || !line_point || !line_direction || !contact || !deviation || !sensitivity || !residual_size) return GM_E_NULL;
  shared = (contact_guess_stride != 0 || gm_flank_on_line_contact_guess_inside(contact_guess))
      && (settings_stride != 0 || gm_flank_on_line_settings_inside(settings))
      && (side_stride != 0 || gm_flank_on_line_side_inside(side))
      && (line_point_stride != 0 || gm_flank_on_line_line_point_inside(line_point))
      && (line_direction_stride != 0 || gm_flank_on_line_line_direction_inside(line_direction));
  for (k = 0; k < n; ++k) {
    int now = GM_E_DOMAIN;
    if (shared
        && (contact_guess_stride == 0 || gm_flank_on_line_contact_guess_inside(contact_guess + k * contact_guess_stride))
        && (settings_stride == 0 || gm_flank_on_line_settings_inside(settings + k * settings_stride))
        && (side_stride == 0 || gm_flank_on_line_side_inside(side + k * side_stride))
        && (line_point_stride == 0 || gm_flank_on_line_line_point_inside(line_point + k * line_point_stride))
        && (line_direction_stride == 0 || gm_flank_on_line_line_direction_inside(line_direction + k * line_direction_stride))) {
      now = gm_flank_on_line_point(
          contact_guess + k * contact_guess_stride,
          settings + k * settings_stride,
          side + k * side_stride,
          line_point + k * line_point_stride,
          line_direction + k * line_direction_stride,
          contact + k * 3,
          deviation + k,
          sensitivity + k * 12,
          residual_size + k);
    }
    if (now != GM_OK) {
      gm_nan(contact + k * 3, 3);
      gm_nan(deviation + k, 1);
      gm_nan(sensitivity + k * 12, 12);
      gm_nan(residual_size + k, 1);
      if (status == GM_OK) {
        status = now;
        if (first_bad) *first_bad = k;
      }
    }
  }
  return status;
}
