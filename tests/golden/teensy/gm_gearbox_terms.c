/* gm_gearbox_terms: generated, do not edit. */
#include "gm_gearbox_terms.h"

#if defined(__GNUC__)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-parameter"
#pragma GCC diagnostic ignored "-Wunused-function"
#endif

#define casadi_real int32_t
#define casadi_int int
#define CASADI_PREFIX(ID) gm_gearbox_terms_ ## ID
#define casadi_f0 CASADI_PREFIX(f0)

/* gearbox_terms:(teeth,hob_starts,encoder_counts,motor_steps)->(steps_numerator,steps_denominator) */
static int casadi_f0(const casadi_real** arg, casadi_real** res, casadi_int* iw, casadi_real* w, int mem) {
  casadi_real a0, a1;
  a0=arg[1]? arg[1][0] : 0;
  a1=arg[3]? arg[3][0] : 0;
  a0=(a0*a1);
  if (res[0]!=0) res[0][0]=a0;
  a0=arg[2]? arg[2][0] : 0;
  a1=arg[0]? arg[0][0] : 0;
  a0=(a0*a1);
  if (res[1]!=0) res[1][0]=a0;
  return 0;
}

#if defined(__GNUC__)
#pragma GCC diagnostic pop
#endif

void gm_gearbox_terms(
    int32_t teeth,
    int32_t hob_starts,
    int32_t encoder_counts,
    int32_t motor_steps,
    int32_t *steps_numerator,
    int32_t *steps_denominator)
{
  const int32_t *arg[4];
  int32_t *res[2];
  arg[0] = &teeth;
  arg[1] = &hob_starts;
  arg[2] = &encoder_counts;
  arg[3] = &motor_steps;
  res[0] = steps_numerator;
  res[1] = steps_denominator;
  (void)casadi_f0(arg, res, 0, 0, 0);
}
