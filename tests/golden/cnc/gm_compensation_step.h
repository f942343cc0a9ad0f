/*
 * gm_compensation_step: generated, do not edit.
 *
 * One bounded Levenberg-Marquardt step of 12 scaled settings, and the fall of the sum of squares it promises.
 *
 * in normal_matrix[12][12] [mixed] -10000 ... 10000 (taken: -100000 ... 100000): transposed Jacobian times
 *     Jacobian of the residuals, scaled, row by row
 * in gradient[12] [mixed] -10000 ... 10000 (taken: -100000 ... 100000): transposed Jacobian times residuals,
 *     scaled
 * in variables[12] [mixed] -1 ... 1 (taken: -10 ... 10): scaled variables now
 * in lower[12] [mixed] -1 ... 1 (taken: -10 ... 10): least scaled variables; as the greatest where a variable is
 *     not free
 * in upper[12] [mixed] -1 ... 1 (taken: -10 ... 10): greatest scaled variables
 * in damping [1] 0 ... 1000000000 (taken: 0 ... 10000000000): damping against the mean of the diagonal
 * out step[12] [mixed] -2 ... 2: change of the scaled variables
 * out promised [mm2]: fall of the sum of squares by the linear model
 *
 * source: Levenberg-Marquardt in scaled variables, primal active set of bounds
 * ops: 21782 (add 6587, and 156, div 1081, eq 144, fmax 300, fmin 300, if_else_zero 864, le 180, lt 299, mul
 *     9349, neg 1, not 432, or 144, sq 144, sub 1800, twice 1)
 * work memory: 572 doubles and 0 integers, on the stack
 * written by gearmath 0.1.0, casadi 3.8.2, sympy 1.14.0
 */
#ifndef GM_COMPENSATION_STEP_H
#define GM_COMPENSATION_STEP_H

#include "gm_status.h"

#ifdef __cplusplus
extern "C" {
#endif

GM_API int gm_compensation_step(
    const double normal_matrix[144],
    const double gradient[12],
    const double variables[12],
    const double lower[12],
    const double upper[12],
    double damping,
    double step[12],
    double *promised);

GM_API int gm_compensation_step_batch(
    int64_t n,
    const double *normal_matrix, int64_t normal_matrix_stride,
    const double *gradient, int64_t gradient_stride,
    const double *variables, int64_t variables_stride,
    const double *lower, int64_t lower_stride,
    const double *upper, int64_t upper_stride,
    const double *damping, int64_t damping_stride,
    double *step,
    double *promised,
    int64_t *first_bad);

#ifdef __cplusplus
}
#endif

#endif
