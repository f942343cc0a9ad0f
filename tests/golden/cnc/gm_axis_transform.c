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

/* axis_transform:(settings[12],theta,pivot_height)->(axes[5]) */
static int casadi_f0(const casadi_real** arg, casadi_real** res, casadi_int* iw, casadi_real* w, int mem) {
  casadi_real a00, a01, a02, a03, a04, a05, a06, a07, a08, a09, a10, a11;
  casadi_real a12, a13, a14, a15, a16, a17, a18, a19, a20;
  a00=arg[0]? arg[0][4] : 0;
  a01=arg[0]? arg[0][0] : 0;
  a02=arg[0]? arg[0][1] : 0;
  a03=arg[1]? arg[1][0] : 0;
  a02=(a02+a03);
  a04=sin(a02);
  a04=(a01*a04);
  a00=(a00+a04);
  a04=arg[0]? arg[0][2] : 0;
  a05=cos(a04);
  a06=arg[0]? arg[0][7] : 0;
  a07=sin(a06);
  a08=(a05*a07);
  a09=arg[0]? arg[0][3] : 0;
  a09=(a02+a09);
  a10=cos(a09);
  a04=sin(a04);
  a11=(a10*a04);
  a06=cos(a06);
  a12=(a06*a05);
  a09=sin(a09);
  a13=(a09*a04);
  a14=(a13*a07);
  a12=(a12-a14);
  a14=casadi_sq(a12);
  a15=casadi_sq(a10);
  a04=casadi_sq(a04);
  a16=(a15*a04);
  a17=casadi_sq(a06);
  a17=(a16*a17);
  a14=(a14+a17);
  a17=casadi_sq(a07);
  a17=(a16*a17);
  a14=(a14+a17);
  a14=sqrt(a14);
  a17=(a11/a14);
  a18=(a08*a17);
  a19=(a06/a14);
  a10=(a19*a10);
  a10=(a10*a09);
  a10=(a10*a04);
  a18=(a18+a10);
  a18=(a00*a18);
  a10=arg[0]? arg[0][6] : 0;
  a09=(a07*a10);
  a20=arg[0]? arg[0][5] : 0;
  a09=(a09-a20);
  a15=(a15/a14);
  a15=(a15*a04);
  a15=(a15*a07);
  a04=(a12/a14);
  a20=(a13*a04);
  a15=(a15-a20);
  a15=(a09*a15);
  a18=(a18+a15);
  a10=(a06*a10);
  a02=cos(a02);
  a01=(a01*a02);
  a10=(a10+a01);
  a01=(a04*a05);
  a16=(a16/a14);
  a16=(a16*a06);
  a01=(a01+a16);
  a01=(a10*a01);
  a18=(a18+a01);
  a18=(-a18);
  if (res[0]!=0) res[0][0]=a18;
  a04=(a00*a04);
  a19=(a19*a11);
  a19=(a19*a09);
  a04=(a04+a19);
  a17=(a17*a10);
  a17=(a17*a07);
  a04=(a04-a17);
  if (res[0]!=0) res[0][1]=a04;
  a04=arg[2]? arg[2][0] : 0;
  a00=(a00*a11);
  a04=(a04+a00);
  a10=(a13*a10);
  a04=(a04-a10);
  a09=(a09*a05);
  a04=(a04-a09);
  if (res[0]!=0) res[0][2]=a04;
  a04=arg[0]? arg[0][9] : 0;
  a11=(-a11);
  a11=atan2(a11,a12);
  a04=(a04+a11);
  a11=arg[0]? arg[0][8] : 0;
  a11=(a11*a03);
  a04=(a04+a11);
  a04=(-a04);
  if (res[0]!=0) res[0][3]=a04;
  a04=1.5707963267948966e+00;
  a13=(a13*a06);
  a08=(a08+a13);
  a14=atan2(a14,a08);
  a04=(a04-a14);
  if (res[0]!=0) res[0][4]=a04;
  return 0;
}

#if defined(__GNUC__)
#pragma GCC diagnostic pop
#endif

void gm_axis_transform(const double settings[12], double theta, double pivot_height, double axes[5])
{
  const double *arg[3];
  double *res[1];
  arg[0] = settings;
  arg[1] = &theta;
  arg[2] = &pivot_height;
  res[0] = axes;
  (void)casadi_f0(arg, res, 0, 0, 0);
}

void gm_axis_transform_batch(
    long n,
    const double *settings, long settings_stride,
    const double *theta, long theta_stride,
    const double *pivot_height, long pivot_height_stride,
    double *axes)
{
  long k;
  for (k = 0; k < n; ++k) {
    gm_axis_transform(
        settings + k * settings_stride,
        theta[k * theta_stride],
        pivot_height[k * pivot_height_stride],
        axes + k * 5);
  }
}
