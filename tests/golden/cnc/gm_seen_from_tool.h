/*
 * gm_seen_from_tool: generated, do not edit.
 *
 * A point of the work from the cutter centre, in the axes of the machine (5.6).
 *
 * in axes[5] [mixed]: axis positions X, Y, Z, A, B of the vertical machine
 *     [0] X [mm] -500 ... 500 (taken: -5000 ... 5000): position of axis X
 *     [1] Y [mm] -500 ... 500 (taken: -5000 ... 5000): position of axis Y
 *     [2] Z [mm] -500 ... 900 (taken: -5000 ... 9000): position of axis Z
 *     [3] A [rad] -10 ... 10 (taken: -100 ... 100): position of the work axis A, right-handed about the work
 *         axis
 *     [4] B [rad] -0.2 ... 1.7 (taken: -2 ... 17): position of the swivel axis B, left-handed about Y
 * in point_w[3] [mm] -500 ... 500 (taken: -5000 ... 5000): point of the tooth surface family, work frame w
 * in pivot_height [mm] -1000 ... 1000 (taken: -10000 ... 10000): R_d + C_t: reading of Z with the blade tips
 *     level with the B axis
 * in pivot_offset[3] [mm] -100 ... 100 (taken: -1000 ... 1000): B axis to pitch apex, in the axes of the work at
 *     A = 0; zero where none is given
 * out point_m[3] [mm] -1000 ... 1000: point of the work from the cutter centre, axes of the machine
 *
 * source: (5.4) less the cutter centre
 * ops: 24 (add 7, cos 2, mul 8, neg 1, sin 2, sub 4)
 * work memory: none
 * written by gearmath 0.1.0, casadi 3.8.2, sympy 1.14.0
 */
#ifndef GM_SEEN_FROM_TOOL_H
#define GM_SEEN_FROM_TOOL_H

#include "gm_status.h"

#ifdef __cplusplus
extern "C" {
#endif

GM_API int gm_seen_from_tool(
    const double axes[5],
    const double point_w[3],
    double pivot_height,
    const double pivot_offset[3],
    double point_m[3]);

GM_API int gm_seen_from_tool_batch(
    int64_t n,
    const double *axes, int64_t axes_stride,
    const double *point_w, int64_t point_w_stride,
    const double *pivot_height, int64_t pivot_height_stride,
    const double *pivot_offset, int64_t pivot_offset_stride,
    double *point_m,
    int64_t *first_bad);

#ifdef __cplusplus
}
#endif

#endif
