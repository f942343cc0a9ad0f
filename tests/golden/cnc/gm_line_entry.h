/*
 * gm_line_entry: generated, do not edit.
 *
 * Where a line, followed along its direction, enters the material swept by the blade at one pose (6.4).
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
 * in line_point[3] [mm] -200 ... 200 (taken: -2000 ... 2000): point at distance zero of a line, work frame w
 * in line_direction[3] [1] -1 ... 1: unit direction of a line, work frame w
 * in blade_point_radius [mm] 20 ... 250 (taken: 2 ... 2500): radius of the blade tip about the cutter axis
 * in blade_pressure_angle [rad] 0.05 ... 0.6 (taken: 0.005 ... 1.57079632679): angle between blade and cutter
 *     axis
 * in side [1] one of -1, 1: +1 outer blade (concave flank), -1 inner blade (convex flank)
 * in pivot_offset[3] [mm] -100 ... 100 (taken: -1000 ... 1000): B axis to pitch apex, in the axes of the work at
 *     A = 0; zero where none is given
 * out line_distance [mm]: where the line enters the swept blade; 1e3 where it does not
 *
 * source: line against cone, the root at which the line passes from the metal into the cutter
 * ops: 106 (add 18, cos 2, div 2, fmax 1, if_else_zero 6, le 2, lt 1, mul 39, neg 3, not 3, sin 2, sq 9, sqrt 1,
 *     sub 16, tan 1)
 * work memory: none
 * written by gearmath 0.1.0, casadi 3.8.2, sympy 1.14.0
 */
#ifndef GM_LINE_ENTRY_H
#define GM_LINE_ENTRY_H

#include "gm_status.h"

#ifdef __cplusplus
extern "C" {
#endif

GM_API int gm_line_entry(
    const double axes[5],
    double pivot_height,
    const double line_point[3],
    const double line_direction[3],
    double blade_point_radius,
    double blade_pressure_angle,
    double side,
    const double pivot_offset[3],
    double *line_distance);

GM_API int gm_line_entry_batch(
    int64_t n,
    const double *axes, int64_t axes_stride,
    const double *pivot_height, int64_t pivot_height_stride,
    const double *line_point, int64_t line_point_stride,
    const double *line_direction, int64_t line_direction_stride,
    const double *blade_point_radius, int64_t blade_point_radius_stride,
    const double *blade_pressure_angle, int64_t blade_pressure_angle_stride,
    const double *side, int64_t side_stride,
    const double *pivot_offset, int64_t pivot_offset_stride,
    double *line_distance,
    int64_t *first_bad);

#ifdef __cplusplus
}
#endif

#endif
