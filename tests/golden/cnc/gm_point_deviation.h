/*
 * gm_point_deviation: generated, do not edit.
 *
 * Deviation of a touched point from the nominal flank, along the outward normal (6.1).
 *
 * in tip_center[3] [mm] -500 ... 500 (taken: -5000 ... 5000): centre of the probe tip at contact, work frame w
 * in tip_radius [mm] 0 ... 5 (taken: 0 ... 50): effective radius of the probe tip; zero for a corrected contact
 *     point
 * in point_w[3] [mm] -500 ... 500 (taken: -5000 ... 5000): point of the tooth surface family, work frame w
 * in normal_w[3] [1] -1 ... 1: outward unit normal (out of the metal), work frame w
 * out deviation [mm]: along the outward normal; positive = metal left on
 *
 * source: the source text's delta = (R_g - R_0)·n, with the tip radius it leaves out and a unit normal
 * ops: 9 (add 2, mul 3, sub 4)
 * work memory: none
 * written by gearmath 0.1.0, casadi 3.8.2, sympy 1.14.0
 */
#ifndef GM_POINT_DEVIATION_H
#define GM_POINT_DEVIATION_H

#include "gm_status.h"

#ifdef __cplusplus
extern "C" {
#endif

GM_API int gm_point_deviation(
    const double tip_center[3],
    double tip_radius,
    const double point_w[3],
    const double normal_w[3],
    double *deviation);

GM_API int gm_point_deviation_batch(
    int64_t n,
    const double *tip_center, int64_t tip_center_stride,
    const double *tip_radius, int64_t tip_radius_stride,
    const double *point_w, int64_t point_w_stride,
    const double *normal_w, int64_t normal_w_stride,
    double *deviation,
    int64_t *first_bad);

#ifdef __cplusplus
}
#endif

#endif
