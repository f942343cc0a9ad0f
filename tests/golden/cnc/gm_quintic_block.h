/*
 * gm_quintic_block: generated, do not edit.
 *
 * Coefficients a_2 to a_5 of the quintic block of one axis from positions, slopes and bends at its ends (28.3).
 *
 * in block_start [mixed] -500 ... 500 (taken: -5000 ... 5000): position of an axis at the start of a block
 * in block_end [mixed] -500 ... 500 (taken: -5000 ... 5000): position of an axis at the end of a block
 * in slope_start [mixed] -200 ... 200 (taken: -2000 ... 2000): its derivative by the parameter at the start
 * in slope_end [mixed] -200 ... 200 (taken: -2000 ... 2000): its derivative by the parameter at the end
 * in bend_start [mixed] -200 ... 200 (taken: -2000 ... 2000): its second derivative at the start
 * in bend_end [mixed] -200 ... 200 (taken: -2000 ... 2000): its second derivative at the end
 * in block_interval [1] 0.5 ... 10 (taken: 0.05 ... 100): value of the parameter at the end of a block (PL)
 * out quintic_coefficients[4] [mixed]: a_2 to a_5 of a block
 *
 * source: quintic Hermite interpolation, in the form of PO of SINUMERIK
 * ops: 50 (add 10, div 3, mul 26, sq 6, sub 5)
 * work memory: none
 * written by gearmath 0.1.0, casadi 3.8.2, sympy 1.14.0
 */
#ifndef GM_QUINTIC_BLOCK_H
#define GM_QUINTIC_BLOCK_H

#include "gm_status.h"

#ifdef __cplusplus
extern "C" {
#endif

GM_API int gm_quintic_block(
    double block_start,
    double block_end,
    double slope_start,
    double slope_end,
    double bend_start,
    double bend_end,
    double block_interval,
    double quintic_coefficients[4]);

GM_API int gm_quintic_block_batch(
    int64_t n,
    const double *block_start, int64_t block_start_stride,
    const double *block_end, int64_t block_end_stride,
    const double *slope_start, int64_t slope_start_stride,
    const double *slope_end, int64_t slope_end_stride,
    const double *bend_start, int64_t bend_start_stride,
    const double *bend_end, int64_t bend_end_stride,
    const double *block_interval, int64_t block_interval_stride,
    double *quintic_coefficients,
    int64_t *first_bad);

#ifdef __cplusplus
}
#endif

#endif
