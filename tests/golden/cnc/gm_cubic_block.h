/*
 * gm_cubic_block: generated, do not edit.
 *
 * Coefficients a_2, a_3 of the cubic block of one axis from positions and slopes at its ends (28.2).
 *
 * in block_start [mixed] -500 ... 500 (taken: -5000 ... 5000): position of an axis at the start of a block
 * in block_end [mixed] -500 ... 500 (taken: -5000 ... 5000): position of an axis at the end of a block
 * in slope_start [mixed] -200 ... 200 (taken: -2000 ... 2000): its derivative by the parameter at the start
 * in slope_end [mixed] -200 ... 200 (taken: -2000 ... 2000): its derivative by the parameter at the end
 * in block_interval [1] 0.5 ... 10 (taken: 0.05 ... 100): value of the parameter at the end of a block (PL)
 * out cubic_coefficients[2] [mixed]: a_2, a_3 of a block
 *
 * source: cubic Hermite interpolation, in the form of PO of SINUMERIK
 * ops: 18 (add 5, div 2, mul 6, sq 2, sub 1, twice 2)
 * work memory: none
 * written by gearmath 0.1.0, casadi 3.8.2, sympy 1.14.0
 */
#ifndef GM_CUBIC_BLOCK_H
#define GM_CUBIC_BLOCK_H

#include "gm_status.h"

#ifdef __cplusplus
extern "C" {
#endif

GM_API int gm_cubic_block(
    double block_start,
    double block_end,
    double slope_start,
    double slope_end,
    double block_interval,
    double cubic_coefficients[2]);

GM_API int gm_cubic_block_batch(
    int64_t n,
    const double *block_start, int64_t block_start_stride,
    const double *block_end, int64_t block_end_stride,
    const double *slope_start, int64_t slope_start_stride,
    const double *slope_end, int64_t slope_end_stride,
    const double *block_interval, int64_t block_interval_stride,
    double *cubic_coefficients,
    int64_t *first_bad);

#ifdef __cplusplus
}
#endif

#endif
