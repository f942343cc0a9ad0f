/* gm_axis_transform: generated, do not edit. */
#include "gm_axis_transform.h"

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

/* axis_transform:(settings[12],theta,pivot_height,pivot_offset[3])->(axes[5]) */
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
  a14=atan2(a14,a10);
  a12=(a12-a14);
  if (res[0]!=0) res[0][4]=a12;
  return 0;
}

#if defined(__GNUC__)
#pragma GCC diagnostic pop
#endif

void gm_axis_transform(
    const double settings[12],
    double theta,
    double pivot_height,
    const double pivot_offset[3],
    double axes[5])
{
  const double *arg[4];
  double *res[1];
  arg[0] = settings;
  arg[1] = &theta;
  arg[2] = &pivot_height;
  arg[3] = pivot_offset;
  res[0] = axes;
  (void)casadi_f0(arg, res, 0, 0, 0);
}

void gm_axis_transform_batch(
    long n,
    const double *settings, long settings_stride,
    const double *theta, long theta_stride,
    const double *pivot_height, long pivot_height_stride,
    const double *pivot_offset, long pivot_offset_stride,
    double *axes)
{
  long k;
  for (k = 0; k < n; ++k) {
    gm_axis_transform(
        settings + k * settings_stride,
        theta[k * theta_stride],
        pivot_height[k * pivot_height_stride],
        pivot_offset + k * pivot_offset_stride,
        axes + k * 5);
  }
}
