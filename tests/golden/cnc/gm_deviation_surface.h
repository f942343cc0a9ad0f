/*
 * gm_deviation_surface: generated, do not edit.
 *
 * Cubic deviation surface in the local system at the reference point (6.3).
 *
 * in lengthwise [mm] -50 ... 50 (taken: -500 ... 500): distance from the reference point along the tooth, toe to
 *     heel
 * in profilewise [mm] -20 ... 20 (taken: -200 ... 200): distance from the reference point up the profile, root
 *     to tip
 * in surface_coefficients[10] [mixed] -1 ... 1 (taken: -10 ... 10): coefficients c_1 ... c_10 of the cubic
 *     deviation surface, mm per mm^k
 * out surface_deviation [mm]: deviation that the cubic surface gives at one point
 * out monomials[10] [mixed]: 1, X, Y, X^2, XY, Y^2, X^3, X^2 Y, X Y^2, Y^3
 *
 * source: Coordinate Control Method for Full CNC Vertical Spiral Bevel Gear Milling Machine, section 2
 * ops: 27 (add 9, mul 14, sq 4)
 * work memory: none
 * written by gearmath 0.1.0, casadi 3.8.2, sympy 1.14.0
 */
#ifndef GM_DEVIATION_SURFACE_H
#define GM_DEVIATION_SURFACE_H

#include "gm_status.h"

#ifdef __cplusplus
extern "C" {
#endif

GM_API int gm_deviation_surface(
    double lengthwise,
    double profilewise,
    const double surface_coefficients[10],
    double *surface_deviation,
    double monomials[10]);

GM_API int gm_deviation_surface_batch(
    int64_t n,
    const double *lengthwise, int64_t lengthwise_stride,
    const double *profilewise, int64_t profilewise_stride,
    const double *surface_coefficients, int64_t surface_coefficients_stride,
    double *surface_deviation,
    double *monomials,
    int64_t *first_bad);

#ifdef __cplusplus
}
#endif

#endif
