/* For compilers without a C library: what the firmware takes from it. */
#ifndef STAND_IN_STRING_H
#define STAND_IN_STRING_H

#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

void *memcpy(void *to, const void *from, size_t count);
void *memset(void *at, int value, size_t count);

#ifdef __cplusplus
}
#endif

#endif
