/*
 * gm_flank_on_line: generated, do not edit.
 *
 * Deviation at a nominal point of the flank that other settings cut, with its gradient by the settings.
 *
 * in contact_guess[3] [mixed]: start values of u, beta, theta
 *     [0] u [mm] 0 ... 15 (taken: 0 ... 150): height of the blade point above the tip plane, along the cutter
 *         axis
 *     [1] beta [rad] -3.14159265359 ... 3.14159265359 (taken: -31.4159265359 ... 31.4159265359): cutter angle of
 *         the blade point, about the cutter axis
 *     [2] theta [rad] -1 ... 1 (taken: -10 ... 10): cradle rotation (roll position)
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
 * in side [1] one of -1, 1: +1 outer blade (concave flank), -1 inner blade (convex flank)
 * in line_point[3] [mm] -200 ... 200 (taken: -2000 ... 2000): point at distance zero of a line, work frame w
 * in line_direction[3] [1] -1 ... 1: unit direction of a line, work frame w
 * out contact[3] [mixed]: surface parameters u, beta, theta of a flank point
 *     [0] u [mm] 0 ... 15: height of the blade point above the tip plane, along the cutter axis
 *     [1] beta [rad] -3.14159265359 ... 3.14159265359: cutter angle of the blade point, about the cutter axis
 *     [2] theta [rad] -1 ... 1: cradle rotation (roll position)
 * out deviation [mm]: along the outward normal; positive = metal left on
 * out sensitivity[12] [mixed]: deviation per unit of every setting at the contact point
 * out residual_size [mm]: size of the residual of place and meshing after the last step
 *
 * source: family and meshing of chapters 3, 4 and 10 on a line; (20.1)
 * ops: 3040 (add 489, cos 134, div 99, fabs 18, fmax 18, mul 1654, neg 1, sin 134, sq 20, sqrt 8, sub 450, tan
 *     15)
 * work memory: 89 doubles and 0 integers, on the stack
 * written by gearmath 0.1.0, casadi 3.8.2, sympy 1.14.0
 */
#ifndef GM_FLANK_ON_LINE_H
#define GM_FLANK_ON_LINE_H

#include "gm_status.h"

#ifdef __cplusplus
extern "C" {
#endif

GM_API int gm_flank_on_line(
    const double contact_guess[3],
    const double settings[12],
    double side,
    const double line_point[3],
    const double line_direction[3],
    double contact[3],
    double *deviation,
    double sensitivity[12],
    double *residual_size);

GM_API int gm_flank_on_line_batch(
    int64_t n,
    const double *contact_guess, int64_t contact_guess_stride,
    const double *settings, int64_t settings_stride,
    const double *side, int64_t side_stride,
    const double *line_point, int64_t line_point_stride,
    const double *line_direction, int64_t line_direction_stride,
    double *contact,
    double *deviation,
    double *sensitivity,
    double *residual_size,
    int64_t *first_bad);

#ifdef __cplusplus
}
#endif

#endif
