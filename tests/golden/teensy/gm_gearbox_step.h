/*
 * gm_gearbox_step: generated, do not edit.
 *
 * One encoder edge of the electronic gearbox: the step to deliver and the new remainder (7.5).
 *
 * in remainder [1] 0 ... 1073741823: state of the step rule, 0 <= remainder < steps_denominator
 * in edge [1] one of -1, 1: one encoder edge: +1 forward, -1 backward
 * in steps_numerator [1] 1 ... 1073741824: N of the ratio N/D in motor steps per encoder count
 * in steps_denominator [1] 1 ... 1073741824: D of the ratio N/D in motor steps per encoder count
 * out step [1] one of -1, 0, 1: motor step to deliver: +1, 0 or -1
 * out next_remainder [1] 0 ... 1073741823: state of the step rule after the edge
 *
 * requires: steps_denominator - steps_numerator + 1 > 0
 * requires: -remainder + steps_denominator > 0
 * source: incremental form of rounding to nearest, for N <= D
 * ops: 7 (add 1, le 1, lt 1, mul 2, sub 2)
 * work memory: none; int32_t only
 * written by gearmath 0.1.0, casadi 3.8.2, sympy 1.14.0
 */
#ifndef GM_GEARBOX_STEP_H
#define GM_GEARBOX_STEP_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

void gm_gearbox_step(
    int32_t remainder,
    int32_t edge,
    int32_t steps_numerator,
    int32_t steps_denominator,
    int32_t *step,
    int32_t *next_remainder);

#ifdef __cplusplus
}
#endif

#endif
