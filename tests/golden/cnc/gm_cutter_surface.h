/*
 * gm_cutter_surface: generated, do not edit.
 *
 * Point and inward unit normal of a straight-bladed face mill (1.1, 1.2).
 *
 * in u [mm] 0 ... 15 (taken: 0 ... 150): height of the blade point above the tip plane, along the cutter axis
 * in beta [rad] -3.14159265359 ... 3.14159265359 (taken: -31.4159265359 ... 31.4159265359): cutter angle of the
 *     blade point, about the cutter axis
 * in blade_point_radius [mm] 20 ... 250 (taken: 2 ... 2500): radius of the blade tip about the cutter axis
 * in blade_pressure_angle [rad] 0.05 ... 0.6 (taken: 0.005 ... 1.57079632679): angle between blade and cutter
 *     axis
 * in side [1] one of -1, 1: +1 outer blade (concave flank), -1 inner blade (convex flank)
 * out point_c[3] [mm] -250 ... 250: point of the cutter surface, cutter frame T
 * out normal_c[3] [1] -1 ... 1: unit normal of the cutter surface into the cutter, frame T
 *
 * source: cone of revolution; NASA TM-105150 eq. for r_c in other axes
 * ops: 17 (add 1, cos 2, mul 7, neg 4, sin 2, tan 1)
 * work memory: none
 * written by gearmath 0.1.0, casadi 3.8.2, sympy 1.14.0
 */
#ifndef GM_CUTTER_SURFACE_H
#define GM_CUTTER_SURFACE_H

#include "gm_status.h"

#ifdef __cplusplus
extern "C" {
#endif

GM_API int gm_cutter_surface(
    double u,
    double beta,
    double blade_point_radius,
    double blade_pressure_angle,
    double side,
    double point_c[3],
    double normal_c[3]);

GM_API int gm_cutter_surface_batch(
    int64_t n,
    const double *u, int64_t u_stride,
    const double *beta, int64_t beta_stride,
    const double *blade_point_radius, int64_t blade_point_radius_stride,
    const double *blade_pressure_angle, int64_t blade_pressure_angle_stride,
    const double *side, int64_t side_stride,
    double *point_c,
    double *normal_c,
    int64_t *first_bad);

#ifdef __cplusplus
}
#endif

#endif
