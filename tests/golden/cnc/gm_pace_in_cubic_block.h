/*
 * gm_pace_in_cubic_block: generated, do not edit.
 *
 * How slow the axes, and the feed past the tooth, make the path of a cubic block.
 *
 * in axes_0[5] [mixed] -500 ... 500 (taken: -5000 ... 5000): coefficients of power 0 of the fraction
 * in axes_1[5] [mixed] -500 ... 500 (taken: -5000 ... 5000): coefficients of power 1 of the fraction
 * in axes_2[5] [mixed] -500 ... 500 (taken: -5000 ... 5000): coefficients of power 2 of the fraction
 * in axes_3[5] [mixed] -500 ... 500 (taken: -5000 ... 5000): coefficients of power 3 of the fraction
 * in fraction [1] 0 ... 1 (taken: 0 ... 10): 0 at the start of the block, 1 at its end
 * in point_w[3] [mm] -500 ... 500 (taken: -5000 ... 5000): point of the tooth surface family, work frame w
 * in pivot_height [mm] -1000 ... 1000 (taken: -10000 ... 10000): R_d + C_t: reading of Z with the blade tips
 *     level with the B axis
 * in pivot_offset[3] [mm] -100 ... 100 (taken: -1000 ... 1000): B axis to pitch apex, in the axes of the work at
 *     A = 0; zero where none is given
 * in max_speed[5] [mixed] 0.001 ... 10000 (taken: 0.0001 ... 100000): highest speed of each axis
 * in max_acceleration[5] [mixed] 0.001 ... 1000000 (taken: 0.0001 ... 10000000): highest acceleration of each
 *     axis
 * in max_jerk[5] [mixed] 0.001 ... 1000000000 (taken: 0.0001 ... 10000000000): highest jerk of each axis
 * in feed [mm/s] 0.0002 ... 2000 (taken: 2e-05 ... 20000): wanted speed past the tooth
 * out pace [s/mm]: least time per mm of the path
 * out path_rate [mm]: length of the path per unit of the parameter
 *
 * source: derivatives along the path (28.4) of a block, and of seen_from_tool (5.6)
 * ops: 327 (add 68, constpow 1, cos 2, div 70, fabs 15, fmax 15, mul 95, sin 2, sq 8, sqrt 3, sub 31, twice 17)
 * work memory: none
 * written by gearmath 0.1.0, casadi 3.8.2, sympy 1.14.0
 */
#ifndef GM_PACE_IN_CUBIC_BLOCK_H
#define GM_PACE_IN_CUBIC_BLOCK_H

#include "gm_status.h"

#ifdef __cplusplus
extern "C" {
#endif

GM_API int gm_pace_in_cubic_block(
    const double axes_0[5],
    const double axes_1[5],
    const double axes_2[5],
    const double axes_3[5],
    double fraction,
    const double point_w[3],
    double pivot_height,
    const double pivot_offset[3],
    const double max_speed[5],
    const double max_acceleration[5],
    const double max_jerk[5],
    double feed,
    double *pace,
    double *path_rate);

GM_API int gm_pace_in_cubic_block_batch(
    int64_t n,
    const double *axes_0, int64_t axes_0_stride,
    const double *axes_1, int64_t axes_1_stride,
    const double *axes_2, int64_t axes_2_stride,
    const double *axes_3, int64_t axes_3_stride,
    const double *fraction, int64_t fraction_stride,
    const double *point_w, int64_t point_w_stride,
    const double *pivot_height, int64_t pivot_height_stride,
    const double *pivot_offset, int64_t pivot_offset_stride,
    const double *max_speed, int64_t max_speed_stride,
    const double *max_acceleration, int64_t max_acceleration_stride,
    const double *max_jerk, int64_t max_jerk_stride,
    const double *feed, int64_t feed_stride,
    double *pace,
    double *path_rate,
    int64_t *first_bad);

#ifdef __cplusplus
}
#endif

#endif
