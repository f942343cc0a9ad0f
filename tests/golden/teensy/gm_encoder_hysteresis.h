/*
 * gm_encoder_hysteresis: generated, do not edit.
 *
 * Play of a few counts before a reversal of the encoder is followed (7.9).
 *
 * in play [1] 0 ... 16: state of the hysteresis, 0 <= play <= hysteresis
 * in edge [1] one of -1, 1: one encoder edge: +1 forward, -1 backward
 * in hysteresis [1] 0 ... 16: encoder counts of play before a reversal is followed
 * out passed_edge [1] one of -1, 0, 1: edge that is passed on: +1, 0 or -1
 * out next_play [1] 0 ... 16: state of the hysteresis after the edge
 *
 * requires: hysteresis - play + 1 > 0
 * source: mechanical backlash, in counts
 * ops: 6 (add 2, lt 2, sub 2)
 * work memory: none; int32_t only
 * written by gearmath 0.1.0, casadi 3.8.2, sympy 1.14.0
 */
#ifndef GM_ENCODER_HYSTERESIS_H
#define GM_ENCODER_HYSTERESIS_H

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
#define CASADI_PREFIX(ID) gm_encoder_hysteresis_ ## ID
#define casadi_f0 CASADI_PREFIX(f0)

/* encoder_hysteresis:(play,edge,hysteresis)->(passed_edge,next_play) */
static inline int casadi_f0(const casadi_real** arg, casadi_real** res, casadi_int* iw, casadi_real* w, int mem) {
  casadi_real a0, a1, a2, a3;
  a0=arg[2]? arg[2][0] : 0;
  a1=arg[1]? arg[1][0] : 0;
  a2=arg[0]? arg[0][0] : 0;
  a1=(a1+a2);
  a0=(a0<a1);
  a2=0;
  a2=(a1<a2);
  a3=(a0-a2);
  if (res[0]!=0) res[0][0]=a3;
  a1=(a1+a2);
  a1=(a1-a0);
  if (res[1]!=0) res[1][0]=a1;
  return 0;
}

#if defined(__GNUC__)
#pragma GCC diagnostic pop
#endif

static inline void gm_encoder_hysteresis(
    int32_t play,
    int32_t edge,
    int32_t hysteresis,
    int32_t *passed_edge,
    int32_t *next_play)
{
  const int32_t *arg[3];
  int32_t *res[2];
  arg[0] = &play;
  arg[1] = &edge;
  arg[2] = &hysteresis;
  res[0] = passed_edge;
  res[1] = next_play;
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
