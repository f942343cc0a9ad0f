/*
 * gm_compensation_step: generated, do not edit.
 *
 * One bounded Levenberg-Marquardt step of 12 scaled settings, and the fall of the sum of squares it promises.
 *
 * in normal_matrix[12][12] [mixed] -10000 ... 10000: transposed Jacobian times Jacobian of the residuals,
 *     scaled, row by row
 * in gradient[12] [mixed] -10000 ... 10000: transposed Jacobian times residuals, scaled
 * in variables[12] [mixed] -1 ... 1: scaled variables now
 * in lower[12] [mixed] -1 ... 1: least scaled variables; as the greatest where a variable is not free
 * in upper[12] [mixed] -1 ... 1: greatest scaled variables
 * in damping [1] 0 ... 1000000000: damping against the mean of the diagonal
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

/* Refuses -fsingle-precision-constant, under which every literal below would silently be single precision. */
#ifndef GM_DOUBLE_LITERALS
#define GM_DOUBLE_LITERALS
typedef char gm_double_literals[(int)16777217.0 == 16777217 ? 1 : -1];
#endif

#ifdef __cplusplus
extern "C" {
#endif

void gm_compensation_step(
    const double normal_matrix[144],
    const double gradient[12],
    const double variables[12],
    const double lower[12],
    const double upper[12],
    double damping,
    double step[12],
    double *promised);

void gm_compensation_step_batch(
    long n,
    const double *normal_matrix, long normal_matrix_stride,
    const double *gradient, long gradient_stride,
    const double *variables, long variables_stride,
    const double *lower, long lower_stride,
    const double *upper, long upper_stride,
    const double *damping, long damping_stride,
    double *step,
    double *promised);

#ifdef __cplusplus
}
#endif

#endif
