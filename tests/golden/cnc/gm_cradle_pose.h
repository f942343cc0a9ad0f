/*
 * gm_cradle_pose: generated, do not edit.
 *
 * Cutter axis, work axis, apex-to-cutter vector and work angle of the cradle machine (2.1-2.4).
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
 * out V_c[3] [1] -1 ... 1: cutter axis, from the cutter head towards the work, machine frame s
 * out V_p[3] [1] -1 ... 1: work axis, from the crossing point towards the heel, machine frame s
 * out V_ls[3] [mm] -500 ... 500: pitch apex to cutter centre, machine frame s
 * out work_angle [rad]: rotation of the work about its axis
 *
 * source: Coordinate Control Method for Full CNC Vertical Spiral Bevel Gear Milling Machine, active signs
 * ops: 22 (add 5, cos 4, mul 7, neg 1, sin 4, sub 1)
 * work memory: none
 * written by gearmath 0.1.0, casadi 3.8.2, sympy 1.14.0
 */
#ifndef GM_CRADLE_POSE_H
#define GM_CRADLE_POSE_H

#include "gm_status.h"

#ifdef __cplusplus
extern "C" {
#endif

GM_API int gm_cradle_pose(
    const double settings[12],
    double theta,
    double V_c[3],
    double V_p[3],
    double V_ls[3],
    double *work_angle);

GM_API int gm_cradle_pose_batch(
    int64_t n,
    const double *settings, int64_t settings_stride,
    const double *theta, int64_t theta_stride,
    double *V_c,
    double *V_p,
    double *V_ls,
    double *work_angle,
    int64_t *first_bad);

#ifdef __cplusplus
}
#endif

#endif
