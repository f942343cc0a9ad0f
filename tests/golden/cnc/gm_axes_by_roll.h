/*
 * gm_axes_by_roll: generated, do not edit.
 *
 * How the axes move with the cradle.
 *
 * in settings[12] [mixed]: machine and cutter settings of one flank
 *     [0] radial_distance [mm] 20 ... 200 (taken: 2 ... 2000): machine centre to cutter centre in the machine
 *         plane
 *     [1] cradle_angle [rad] -1.5 ... 1.5 (taken: -15 ... 15): polar angle of the cutter centre at cradle
 *         rotation zero
 *     [2] cutter_tilt [rad] -0.4 ... 0.4 (taken: -4 ... 4): tilt of the cutter axis against the cradle axis
 *     [3] cutter_swivel [rad] -3.14159265359 ... 3.14159265359 (taken: -31.4159265359 ... 31.4159265359):
 *         direction of the tilt, about the cradle axis
 *     [4] blank_offset [mm] -40 ... 40 (taken: -400 ... 400): work axis to machine centre, along machine axis j
 *     [5] sliding_base [mm] -20 ... 20 (taken: -200 ... 200): withdrawal of the work along the cradle axis
 *     [6] machine_center_to_crossing_point [mm] -20 ... 20 (taken: -200 ... 200): advance of the work along its
 *         own axis
 *     [7] machine_root_angle [rad] -0.2 ... 1.45 (taken: -1.57079632679 ... 1.57079632679): work axis against
 *         the machine plane
 *     [8] ratio_of_roll [1] 0.5 ... 8 (taken: 0.05 ... 80): work rotation per cradle rotation
 *     [9] work_rotation_offset [rad] -3.14159265359 ... 3.14159265359 (taken: -31.4159265359 ... 31.4159265359):
 *         work rotation at cradle rotation zero
 *     [10] blade_point_radius [mm] 20 ... 250 (taken: 2 ... 2500): radius of the blade tip about the cutter axis
 *     [11] blade_pressure_angle [rad] 0.05 ... 0.6 (taken: 0.005 ... 1.57079632679): angle between blade and
 *         cutter axis
 * in motion[10][7] [mixed] -0.3 ... 0.3 (taken: -3 ... 3): coefficients of theta^1 ... theta^7 (columns) of the
 *     machine settings (rows, in their order), row by row
 * in theta [rad] -1 ... 1 (taken: -10 ... 10): cradle rotation (roll position)
 * in pivot_height [mm] -1000 ... 1000 (taken: -10000 ... 10000): R_d + C_t: reading of Z with the blade tips
 *     level with the B axis
 * in pivot_offset[3] [mm] -100 ... 100 (taken: -1000 ... 1000): B axis to pitch apex, in the axes of the work at
 *     A = 0; zero where none is given
 * out axis_slopes[5] [mixed] -200 ... 200: derivatives of X, Y, Z, A, B by the parameter
 * out axis_bends[5] [mixed]: second derivatives of the axis positions
 *
 * source: derivatives of axis_transform (5.1-5.3) with moved_settings (10.1)
 * ops: 1348 (add 460, cos 16, div 61, mul 628, neg 9, sin 16, sq 8, sqrt 1, sub 118, twice 31)
 * work memory: none
 * written by gearmath 0.1.0, casadi 3.8.2, sympy 1.14.0
 */
#ifndef GM_AXES_BY_ROLL_H
#define GM_AXES_BY_ROLL_H

#include "gm_status.h"

#ifdef __cplusplus
extern "C" {
#endif

GM_API int gm_axes_by_roll(
    const double settings[12],
    const double motion[70],
    double theta,
    double pivot_height,
    const double pivot_offset[3],
    double axis_slopes[5],
    double axis_bends[5]);

GM_API int gm_axes_by_roll_batch(
    int64_t n,
    const double *settings, int64_t settings_stride,
    const double *motion, int64_t motion_stride,
    const double *theta, int64_t theta_stride,
    const double *pivot_height, int64_t pivot_height_stride,
    const double *pivot_offset, int64_t pivot_offset_stride,
    double *axis_slopes,
    double *axis_bends,
    int64_t *first_bad);

#ifdef __cplusplus
}
#endif

#endif
