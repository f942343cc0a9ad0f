/*
 * gm_counter_motion: generated, do not edit.
 *
 * Counts between two readings of a 16-bit counter that may have run over in between (7.14).
 *
 * in count_before [1] 0 ... 65535: reading of a 16-bit counter at the time before
 * in count_now [1] 0 ... 65535: reading of a 16-bit counter now
 * out counted [1] -32768 ... 32767: counts between two readings
 *
 * source: arithmetic modulo 2^16
 * ops: 7 (add 1, le 1, lt 1, mul 2, sub 2)
 * work memory: none; int32_t only
 * written by gearmath 0.1.0, casadi 3.8.2, sympy 1.14.0
 */
#ifndef GM_COUNTER_MOTION_H
#define GM_COUNTER_MOTION_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#if defined(__GNUC__)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-parameter"
#pragma GCC diagnostic ignored "-Wunused-function"
#endif

#define casadi_real int32_t
#define casadi_int int
#define CASADI_PREFIX(ID) gm_counter_motion_ ## ID
#define casadi_f0 CASADI_PREFIX(f0)

/* counter_motion:(count_before,count_now)->(counted) */
static inline int casadi_f0(const casadi_real** arg, casadi_real** res, casadi_int* iw, casadi_real* w, int mem) {
  casadi_real a0, a1, a2, a3;
  a0=-65536;
  a1=arg[0]? arg[0][0] : 0;
  a2=arg[1]? arg[1][0] : 0;
  a1=(a1-a2);
  a2=-32768;
  a2=(a1<=a2);
  a0=(a0*a2);
  a0=(a0-a1);
  a2=65536;
  a3=32768;
  a3=(a3<a1);
  a2=(a2*a3);
  a0=(a0+a2);
  if (res[0]!=0) res[0][0]=a0;
  return 0;
}

#if defined(__GNUC__)
#pragma GCC diagnostic pop
#endif

static inline void gm_counter_motion(int32_t count_before, int32_t count_now, int32_t *counted)
{
  const int32_t *arg[2];
  int32_t *res[1];
  arg[0] = &count_before;
  arg[1] = &count_now;
  res[0] = counted;
  (void)casadi_f0(arg, res, 0, 0, 0);
}

#undef casadi_real
#undef casadi_int
#undef CASADI_PREFIX
#undef casadi_f0

#ifdef __cplusplus
}
#endif

#endif
