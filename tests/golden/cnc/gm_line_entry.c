/* gm_line_entry: generated, do not edit. */
#include "gm_line_entry.h"
#include "gm_check.h"

#include <math.h>

#if defined(__GNUC__)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-parameter"
#pragma GCC diagnostic ignored "-Wunused-function"
#endif

#define casadi_real double
#define casadi_int int
#define CASADI_PREFIX(ID) gm_line_entry_ ## ID
#define casadi_f0 CASADI_PREFIX(f0)
#define casadi_fmax CASADI_PREFIX(fmax)
#define casadi_sq CASADI_PREFIX(sq)

static casadi_real casadi_sq(casadi_real x) { return x*x;}

static casadi_real casadi_fmax(casadi_real x, casadi_real y) {
/* Pre-c99 compatibility */
#if __STDC_VERSION__ < 199901L
  return x>y ? x : y;
#else
  return fmax(x, y);
#endif
}

/* line_entry:(axes[5],pivot_height,line_point[3],line_direction[3],blade_point_radius,blade_pressure_angle,side,pivot_offset[3])->(line_distance) */
static int casadi_f0(const casadi_real** arg, casadi_real** res, casadi_int* iw, casadi_real* w, int mem) {
  casadi_real a00, a01, a02, a03, a04, a05, a06, a07, a08, a09, a10, a11;
  casadi_real a12, a13, a14, a15, a16, a17, a18;
  a00=0.;
  a01=arg[0]? arg[0][3] : 0;
  a02=sin(a01);
  a03=arg[2]? arg[2][0] : 0;
  a04=arg[0]? arg[0][1] : 0;
  a05=arg[7]? arg[7][1] : 0;
  a04=(a04-a05);
  a05=(a02*a04);
  a03=(a03+a05);
  a01=cos(a01);
  a05=arg[0]? arg[0][2] : 0;
  a06=arg[1]? arg[1][0] : 0;
  a05=(a05-a06);
  a06=arg[0]? arg[0][4] : 0;
  a07=cos(a06);
  a08=(a05*a07);
  a09=arg[7]? arg[7][0] : 0;
  a08=(a08-a09);
  a06=sin(a06);
  a09=arg[0]? arg[0][0] : 0;
  a10=(a06*a09);
  a08=(a08-a10);
  a10=(a01*a08);
  a03=(a03-a10);
  a10=(a02*a03);
  a11=arg[2]? arg[2][1] : 0;
  a08=(a02*a08);
  a11=(a11-a08);
  a04=(a01*a04);
  a11=(a11-a04);
  a04=(a01*a11);
  a10=(a10-a04);
  a04=casadi_sq(a10);
  a08=(a01*a06);
  a12=(a08*a03);
  a13=(a02*a06);
  a14=(a13*a11);
  a12=(a12+a14);
  a14=arg[2]? arg[2][2] : 0;
  a15=arg[7]? arg[7][2] : 0;
  a14=(a14+a15);
  a05=(a06*a05);
  a14=(a14+a05);
  a09=(a07*a09);
  a14=(a14+a09);
  a09=(a14*a07);
  a12=(a12+a09);
  a09=casadi_sq(a12);
  a04=(a04+a09);
  a09=arg[4]? arg[4][0] : 0;
  a05=(a01*a07);
  a03=(a05*a03);
  a15=(a02*a07);
  a11=(a15*a11);
  a03=(a03+a11);
  a14=(a14*a06);
  a03=(a03-a14);
  a14=arg[5]? arg[5][0] : 0;
  a14=tan(a14);
  a11=arg[6]? arg[6][0] : 0;
  a16=(a14*a11);
  a17=(a03*a16);
  a09=(a09+a17);
  a17=casadi_sq(a09);
  a04=(a04-a17);
  a17=arg[3]? arg[3][0] : 0;
  a08=(a08*a17);
  a18=arg[3]? arg[3][1] : 0;
  a13=(a13*a18);
  a08=(a08+a13);
  a13=arg[3]? arg[3][2] : 0;
  a07=(a07*a13);
  a08=(a08+a07);
  a07=casadi_sq(a08);
  a02=(a02*a17);
  a01=(a01*a18);
  a02=(a02-a01);
  a01=casadi_sq(a02);
  a07=(a07+a01);
  a05=(a05*a17);
  a15=(a15*a18);
  a05=(a05+a15);
  a06=(a06*a13);
  a05=(a05-a06);
  a06=casadi_sq(a05);
  a14=casadi_sq(a14);
  a06=(a06*a14);
  a14=casadi_sq(a11);
  a06=(a06*a14);
  a07=(a07-a06);
  a07=(a04*a07);
  a10=(a10*a02);
  a08=(a08*a12);
  a10=(a10+a08);
  a16=(a05*a16);
  a16=(a16*a09);
  a10=(a10-a16);
  a16=casadi_sq(a10);
  a07=(a07-a16);
  a16=(a00<=a07);
  a09=1000.;
  a08=(a16?a09:0);
  a16=(!a16);
  a07=(-a07);
  a07=casadi_fmax(a00,a07);
  a07=sqrt(a07);
  a11=(a11*a07);
  a11=(a11-a10);
  a04=(a04/a11);
  a11=(a05*a04);
  a11=(a03+a11);
  a11=(-a11);
  a11=(a11<=a00);
  a04=(a11?a04:0);
  a11=(!a11);
  a00=(a00<a05);
  a03=(a03/a05);
  a03=(-a03);
  a03=(a00?a03:0);
  a00=(!a00);
  a00=(a00?a09:0);
  a03=(a03+a00);
  a11=(a11?a03:0);
  a04=(a04+a11);
  a16=(a16?a04:0);
  a08=(a08+a16);
  if (res[0]!=0) res[0][0]=a08;
  return 0;
}

#if defined(__GNUC__)
#pragma GCC diagnostic pop
#endif

static int gm_line_entry_axes_inside(const double *x)
{
  static const double low[5] = {-5000.000005, -5000.000005, -5000.000009, -100.0000001, -2.000000017};
  static const double high[5] = {5000.000005, 5000.000005, 9000.000009, 100.0000001, 17.000000017};
  return gm_inside(x, 5, low, high);
}
static int gm_line_entry_pivot_height_inside(const double *x)
{
  static const double low[1] = {-10000.00001};
  static const double high[1] = {10000.00001};
  return gm_inside(x, 1, low, high);
}
static int gm_line_entry_line_point_inside(const double *x)
{
  static const double low[3] = {-2000.000002, -2000.000002, -2000.000002};
  static const double high[3] = {2000.000002, 2000.000002, 2000.000002};
  return gm_inside(x, 3, low, high);
}
static int gm_line_entry_line_direction_inside(const double *x)
{
  static const double low[3] = {-1.000000001, -1.000000001, -1.000000001};
  static const double high[3] = {1.000000001, 1.000000001, 1.000000001};
  return gm_inside(x, 3, low, high);
}
static int gm_line_entry_blade_point_radius_inside(const double *x)
{
  static const double low[1] = {1.9999975};
  static const double high[1] = {2500.0000025};
  return gm_inside(x, 1, low, high);
}
static int gm_line_entry_blade_pressure_angle_inside(const double *x)
{
  static const double low[1] = {0.004999998429203673};
  static const double high[1] = {1.570796328365693};
  return gm_inside(x, 1, low, high);
}
static int gm_line_entry_side_inside(const double *x)
{
  return x[0] == -1.0 || x[0] == 1.0;
}
static int gm_line_entry_pivot_offset_inside(const double *x)
{
  static const double low[3] = {-1000.000001, -1000.000001, -1000.000001};
  static const double high[3] = {1000.000001, 1000.000001, 1000.000001};
  return gm_inside(x, 3, low, high);
}

static int gm_line_entry_point(
    const double *axes,
    const double *pivot_height,
    const double *line_point,
    const double *line_direction,
    const double *blade_point_radius,
    const double *blade_pressure_angle,
    const double *side,
    const double *pivot_offset,
    double *line_distance)
{
  const double *arg[8];
  double *res[1];
  arg[0] = axes;
  arg[1] = pivot_height;
  arg[2] = line_point;
  arg[3] = line_direction;
  arg[4] = blade_point_radius;
  arg[5] = blade_pressure_angle;
  arg[6] = side;
  arg[7] = pivot_offset;
  res[0] = line_distance;
  (void)casadi_f0(arg, res, 0, 0, 0);
  return gm_finite(line_distance, 1) ? GM_OK : GM_E_NO_RESULT;
}


int gm_line_entry(
    const double axes[5],
    double pivot_height,
    const double line_point[3],
    const double line_direction[3],
    double blade_point_radius,
    double blade_pressure_angle,
    double side,
    const double pivot_offset[3],
    double *line_distance)
{
  int status = GM_E_DOMAIN;
  if (!axes || !line_point || !line_direction || !pivot_offset || !line_distance) return GM_E_NULL;
  if (gm_line_entry_axes_inside(axes)
      && gm_line_entry_pivot_height_inside(&pivot_height)
      && gm_line_entry_line_point_inside(line_point)
      && gm_line_entry_line_direction_inside(line_direction)
      && gm_line_entry_blade_point_radius_inside(&blade_point_radius)
      && gm_line_entry_blade_pressure_angle_inside(&blade_pressure_angle)
      && gm_line_entry_side_inside(&side)
      && gm_line_entry_pivot_offset_inside(pivot_offset)) {
    status = gm_line_entry_point(
        axes,
        &pivot_height,
        line_point,
        line_direction,
        &blade_point_radius,
        &blade_pressure_angle,
        &side,
        pivot_offset,
        line_distance);
  }
  if (status != GM_OK) {
    gm_nan(line_distance, 1);
  }
  return status;
}

int gm_line_entry_batch(
    int64_t n,
    const double *axes, int64_t axes_stride,
    const double *pivot_height, int64_t pivot_height_stride,
    const double *line_point, int64_t line_point_stride,
    const double *line_direction, int64_t line_direction_stride,
    const double *blade_point_radius, int64_t blade_point_radius_stride,
    const double *blade_pressure_angle, int64_t blade_pressure_angle_stride,
    const double *side, int64_t side_stride,
    const double *pivot_offset, int64_t pivot_offset_stride,
    double *line_distance,
    int64_t *first_bad)
{
  int status = GM_OK, shared;
  int64_t k;
  if (first_bad) *first_bad = -1;
  if (n < 0 || axes_stride < 0 || pivot_height_stride < 0 || line_point_stride < 0 || line_direction_stride < 0 || blade_point_radius_stride < 0 || blade_pressure_angle_stride < 0 || side_stride < 0 || pivot_offset_stride < 0) return GM_E_SIZE;
  if (n == 0) return GM_OK;
  if (!axes || !pivot_height || !line_point || !line_direction || !blade_point_radius || !blade_pressure_angle || !side || !pivot_offset || !line_distance) return GM_E_NULL;
  shared = (axes_stride != 0 || gm_line_entry_axes_inside(axes))
      && (pivot_height_stride != 0 || gm_line_entry_pivot_height_inside(pivot_height))
      && (line_point_stride != 0 || gm_line_entry_line_point_inside(line_point))
      && (line_direction_stride != 0 || gm_line_entry_line_direction_inside(line_direction))
      && (blade_point_radius_stride != 0 || gm_line_entry_blade_point_radius_inside(blade_point_radius))
      && (blade_pressure_angle_stride != 0 || gm_line_entry_blade_pressure_angle_inside(blade_pressure_angle))
      && (side_stride != 0 || gm_line_entry_side_inside(side))
      && (pivot_offset_stride != 0 || gm_line_entry_pivot_offset_inside(pivot_offset));
  for (k = 0; k < n; ++k) {
    int now = GM_E_DOMAIN;
    if (shared
        && (axes_stride == 0 || gm_line_entry_axes_inside(axes + k * axes_stride))
        && (pivot_height_stride == 0 || gm_line_entry_pivot_height_inside(pivot_height + k * pivot_height_stride))
        && (line_point_stride == 0 || gm_line_entry_line_point_inside(line_point + k * line_point_stride))
        && (line_direction_stride == 0 || gm_line_entry_line_direction_inside(line_direction + k * line_direction_stride))
        && (blade_point_radius_stride == 0 || gm_line_entry_blade_point_radius_inside(blade_point_radius + k * blade_point_radius_stride))
        && (blade_pressure_angle_stride == 0 || gm_line_entry_blade_pressure_angle_inside(blade_pressure_angle + k * blade_pressure_angle_stride))
        && (side_stride == 0 || gm_line_entry_side_inside(side + k * side_stride))
        && (pivot_offset_stride == 0 || gm_line_entry_pivot_offset_inside(pivot_offset + k * pivot_offset_stride))) {
      now = gm_line_entry_point(
          axes + k * axes_stride,
          pivot_height + k * pivot_height_stride,
          line_point + k * line_point_stride,
          line_direction + k * line_direction_stride,
          blade_point_radius + k * blade_point_radius_stride,
          blade_pressure_angle + k * blade_pressure_angle_stride,
          side + k * side_stride,
          pivot_offset + k * pivot_offset_stride,
          line_distance + k);
    }
    if (now != GM_OK) {
      gm_nan(line_distance + k, 1);
      if (status == GM_OK) {
        status = now;
        if (first_bad) *first_bad = k;
      }
    }
  }
  return status;
}
