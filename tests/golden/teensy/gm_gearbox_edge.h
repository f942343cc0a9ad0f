/*
 * gm_gearbox_edge: generated, do not edit.
 *
 * One encoder edge of one axis, for any ratio q + N'/D: the steps to deliver and the new remainder (7.8).
 *
 * in remainder [1] 0 ... 1073741823: state of the step rule, 0 <= remainder < steps_denominator
 * in edge [1] one of -1, 1: one encoder edge: +1 forward, -1 backward
 * in increment [1] 0 ... 1073741823: rest of the ratio over the base step, 0 <= increment < D
 * in base_step [1] -64 ... 64: whole steps that every edge gives; the ratio is q + N'/D
 * in steps_denominator [1] 1 ... 1073741824: D of the ratio N/D in motor steps per encoder count
 * out edge_steps [1] -65 ... 65: motor steps that one edge of one axis gives
 * out next_remainder [1] 0 ... 1073741823: state of the step rule after the edge
 *
 * requires: -increment + steps_denominator > 0
 * requires: -remainder + steps_denominator > 0
 * source: incremental form of rounding to nearest, several axes over one denominator
 * ops: 9 (add 2, le 1, lt 1, mul 3, sub 2)
 * work memory: none; int32_t only
 * written by gearmath 0.1.0, casadi 3.8.2, sympy 1.14.0
 */
#ifndef GM_GEARBOX_EDGE_H
#define GM_GEARBOX_EDGE_H

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
#define CASADI_PREFIX(ID) gm_gearbox_edge_ ## ID
#define casadi_f0 CASADI_PREFIX(f0)

/* gearbox_edge:(remainder,edge,increment,base_step,steps_denominator)->(edge_steps,next_remainder) */
static inline int casadi_f0(const casadi_real** arg, casadi_real** res, casadi_int* iw, casadi_real* w, int mem) {
  casadi_real a0, a1, a2, a3, a4;
  a0=arg[4]? arg[4][0] : 0;
  a1=arg[0]? arg[0][0] : 0;
  a2=arg[1]? arg[1][0] : 0;
  a3=arg[2]? arg[2][0] : 0;
  a3=(a2*a3);
  a1=(a1+a3);
  a3=(a0<=a1);
  a4=0;
  a4=(a1<a4);
  a3=(a3-a4);
  a4=arg[3]? arg[3][0] : 0;
  a4=(a4*a2);
  a4=(a3+a4);
  if (res[0]!=0) res[0][0]=a4;
  a3=(a3*a0);
  a1=(a1-a3);
  if (res[1]!=0) res[1][0]=a1;
  return 0;
}

#if defined(__GNUC__)
#pragma GCC diagnostic pop
#endif

static inline void gm_gearbox_edge(
    int32_t remainder,
    int32_t edge,
    int32_t increment,
    int32_t base_step,
    int32_t steps_denominator,
    int32_t *edge_steps,
    int32_t *next_remainder)
{
  const int32_t *arg[5];
  int32_t *res[2];
  arg[0] = &remainder;
  arg[1] = &edge;
  arg[2] = &increment;
  arg[3] = &base_step;
  arg[4] = &steps_denominator;
  res[0] = edge_steps;
  res[1] = next_remainder;
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
