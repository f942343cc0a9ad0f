/*
 * gm_gearbox_terms: generated, do not edit.
 *
 * Ratio of one job as whole numbers: motor steps N per encoder counts D, not reduced (7.2).
 *
 * in teeth [1] 1 ... 999: teeth of the gear to be cut
 * in hob_starts [1] 1 ... 10: starts of the hob
 * in encoder_counts [1] 1 ... 40000: encoder counts per turn of the hob, after the decoder
 * in motor_steps [1] 1 ... 10000000: motor steps per turn of the work table
 * out steps_numerator [1] 1 ... 1073741824: N of the ratio N/D in motor steps per encoder count
 * out steps_denominator [1] 1 ... 1073741824: D of the ratio N/D in motor steps per encoder count
 *
 * source: Digital Control for a Gear Hobbing Machine (Digital Machinist 15-4), generalised to hob starts, eq. 2
 * ops: 2 (mul 2)
 * work memory: none; int32_t only
 * written by gearmath 0.1.0, casadi 3.8.2, sympy 1.14.0
 */
#ifndef GM_GEARBOX_TERMS_H
#define GM_GEARBOX_TERMS_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

void gm_gearbox_terms(
    int32_t teeth,
    int32_t hob_starts,
    int32_t encoder_counts,
    int32_t motor_steps,
    int32_t *steps_numerator,
    int32_t *steps_denominator);

#ifdef __cplusplus
}
#endif

#endif
