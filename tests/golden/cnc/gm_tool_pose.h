/*
 * gm_tool_pose: generated, do not edit.
 *
 * Cutter centre and axis in the work frame, out of the axis positions of the vertical machine (5.4).
 *
 * in axes[5] [mixed]: axis positions X, Y, Z, A, B of the vertical machine
 *     [0] X [mm] -500 ... 500 (taken: -5000 ... 5000): position of axis X
 *     [1] Y [mm] -500 ... 500 (taken: -5000 ... 5000): position of axis Y
 *     [2] Z [mm] -500 ... 900 (taken: -5000 ... 9000): position of axis Z
 *     [3] A [rad] -10 ... 10 (taken: -100 ... 100): position of the work axis A, right-handed about the work
 *         axis
 *     [4] B [rad] -0.2 ... 1.7 (taken: -2 ... 17): position of the swivel axis B, left-handed about Y
 * in pivot_height [mm] -1000 ... 1000 (taken: -10000 ... 10000): R_d + C_t: reading of Z with the blade tips
 *     level with the B axis
 * in pivot_offset[3] [mm] -100 ... 100 (taken: -1000 ... 1000): B axis to pitch apex, in the axes of the work at
 *     A = 0; zero where none is given
 * out cutter_center_w[3] [mm] -500 ... 500: cutter centre in the tip plane, work frame w
 * out cutter_axis_w[3] [1] -1 ... 1: cutter axis towards the work, work frame w
 *
 * source: inverse of p_m = M(B) (Rz(-A) p_w + e)
 * ops: 25 (add 3, cos 2, mul 10, neg 3, sin 2, sub 5)
 * work memory: none
 * written by gearmath 0.1.0, casadi 3.8.2, sympy 1.14.0
 */
#ifndef GM_TOOL_POSE_H
#define GM_TOOL_POSE_H

#include "gm_status.h"

#ifdef __cplusplus
extern "C" {
#endif

GM_API int gm_tool_pose(
    const double axes[5],
    double pivot_height,
    const double pivot_offset[3],
    double cutter_center_w[3],
    double cutter_axis_w[3]);

GM_API int gm_tool_pose_batch(
    int64_t n,
    const double *axes, int64_t axes_stride,
    const double *pivot_height, int64_t pivot_height_stride,
    const double *pivot_offset, int64_t pivot_offset_stride,
    double *cutter_center_w,
    double *cutter_axis_w,
    int64_t *first_bad);

#ifdef __cplusplus
}
#endif

#endif
