/*
 * gm_axis_transform: generated, do not edit.
 *
 * Axis positions of the vertical machine that put the cutter where the cradle machine has it (5.1-5.3).
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
 * in theta [rad] -1 ... 1 (taken: -10 ... 10): cradle rotation (roll position)
 * in pivot_height [mm] -1000 ... 1000 (taken: -10000 ... 10000): R_d + C_t: reading of Z with the blade tips
 *     level with the B axis
 * in pivot_offset[3] [mm] -100 ... 100 (taken: -1000 ... 1000): B axis to pitch apex, in the axes of the work at
 *     A = 0; zero where none is given
 * out axes[5] [mixed]: axis positions X, Y, Z, A, B of the vertical machine
 *     [0] X [mm] -500 ... 500: position of axis X
 *     [1] Y [mm] -500 ... 500: position of axis Y
 *     [2] Z [mm] -500 ... 900: position of axis Z
 *     [3] A [rad] -10 ... 10: position of the work axis A, right-handed about the work axis
 *     [4] B [rad] -0.2 ... 1.7: position of the swivel axis B, left-handed about Y
 *
 * requires: sqrt((-sin(cutter_tilt)*sin(machine_root_angle)*sin(cradle_angle + cutter_swivel + theta) +
 *     cos(cutter_tilt)*cos(machine_root_angle))**2 +
 *     sin(cutter_tilt)**2*sin(machine_root_angle)**2*cos(cradle_angle + cutter_swivel + theta)**2 +
 *     sin(cutter_tilt)**2*cos(machine_root_angle)**2*cos(cradle_angle + cutter_swivel + theta)**2) - 1/20 > 0
 * source: Coordinate Control Method for Full CNC Vertical Spiral Bevel Gear Milling Machine, with atan2
 * ops: 90 (add 20, atan2 2, cos 4, div 5, mul 38, neg 3, sin 4, sq 5, sqrt 1, sub 8)
 * work memory: none
 * written by gearmath 0.1.0, casadi 3.8.2, sympy 1.14.0
 */
#ifndef GM_AXIS_TRANSFORM_H
#define GM_AXIS_TRANSFORM_H

#include "gm_status.h"

#ifdef __cplusplus
extern "C" {
#endif

GM_API int gm_axis_transform(
    const double settings[12],
    double theta,
    double pivot_height,
    const double pivot_offset[3],
    double axes[5]);

GM_API int gm_axis_transform_batch(
    int64_t n,
    const double *settings, int64_t settings_stride,
    const double *theta, int64_t theta_stride,
    const double *pivot_height, int64_t pivot_height_stride,
    const double *pivot_offset, int64_t pivot_offset_stride,
    double *axes,
    int64_t *first_bad);

#ifdef __cplusplus
}
#endif

#endif
