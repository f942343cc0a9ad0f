/* gm_gearbox_step: generated, do not edit. */
#include "gm_gearbox_step.h"

#if defined(__GNUC__)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-parameter"
#pragma GCC diagnostic ignored "-Wunused-function"
#endif

#define casadi_real int32_t
#define casadi_int int
#define CASADI_PREFIX(ID) gm_gearbox_step_ ## ID
#define casadi_f0 CASADI_PREFIX(f0)

/* gearbox_step:(remainder,edge,steps_numerator,steps_denominator)->(step,next_remainder) */
static int casadi_f0(const casadi_real** arg, casadi_real** res, casadi_int* iw, casadi_real* w, int mem) {
  casadi_real a0, a1, a2, a3;
  a0=arg[3]? arg[3][0] : 0;
  a1=arg[0]? arg[0][0] : 0;
  a2=arg[1]? arg[1][0] : 0;
  a3=arg[2]? arg[2][0] : 0;
  a2=(a2*a3);
  a1=(a1+a2);
  a2=(a0<=a1);
  a3=0;
  a3=(a1<a3);
  a2=(a2-a3);
  if (res[0]!=0) res[0][0]=a2;
  a2=(a2*a0);
  a1=(a1-a2);
  if (res[1]!=0) res[1][0]=a1;
  return 0;
}

#if defined(__GNUC__)
#pragma GCC diagnostic pop
#endif

void gm_gearbox_step(
    int32_t remainder,
    int32_t edge,
    int32_t steps_numerator,
    int32_t steps_denominator,
    int32_t *step,
    int32_t *next_remainder)
{
  const int32_t *arg[4];
  int32_t *res[2];
  arg[0] = &remainder;
  arg[1] = &edge;
  arg[2] = &steps_numerator;
  arg[3] = &steps_denominator;
  res[0] = step;
  res[1] = next_remainder;
  (void)casadi_f0(arg, res, 0, 0, 0);
}
