/*
 * gm_status.h: what every function of libgearmath promises.
 *
 * Lengths are mm, angles rad. A function returns GM_OK, or says with a GM_E_ code why it has no result; then every
 * output of that point is NaN. Nothing is allocated, nothing is kept between calls and nothing is global, so threads may
 * call whatever they like at the same time. Outputs must not overlap inputs.
 *
 * The header of a function states for every input the range that is tested, and where it takes more, what it takes:
 * outside of that a number is refused.
 *
 * gm_<name>_batch(n, ...) runs over n points. Every input is an array with a stride, in doubles: the size of the input
 * where the points follow each other, 0 where all points share it. Outputs stand one point behind the other. Each point
 * is computed on its own; the status is that of the first bad one, whose index is put into first_bad, -1 where there is
 * none. first_bad may be null.
 */
#ifndef GM_STATUS_H
#define GM_STATUS_H

#include <stdint.h>

#if defined(_WIN32)
#if defined(GM_BUILD_SHARED)
#define GM_API __declspec(dllexport)
#else
#define GM_API
#endif
#elif defined(__GNUC__)
#define GM_API __attribute__((visibility("default")))
#else
#define GM_API
#endif

/* Refuses -fsingle-precision-constant, under which every literal would silently be single precision. */
typedef char gm_double_literals[(int)16777217.0 == 16777217 ? 1 : -1];

#define GM_OK 0
#define GM_E_NULL 1      /* a pointer is null */
#define GM_E_SIZE 2      /* a number of points or a stride is negative */
#define GM_E_DOMAIN 3    /* an input is NaN, or outside the range that the header states */
#define GM_E_REQUIRES 4  /* what the header requires beside the ranges does not hold, as at a singular pose */
#define GM_E_NO_RESULT 5 /* the inputs are allowed, but there is no finite result */

/* Increases when a program that was compiled before must be compiled again. */
#define GM_ABI_VERSION 1

#ifdef __cplusplus
extern "C" {
#endif

/* GM_ABI_VERSION of the library that is loaded: compare it with the one of the header. */
GM_API int gm_abi_version(void);

/* Version of gearmath that wrote the library, as text. */
GM_API const char *gm_version(void);

/* A sentence for a status, also for one that no function returns; it lives as long as the library. */
GM_API const char *gm_error_text(int status);

#ifdef __cplusplus
}
#endif

#endif
