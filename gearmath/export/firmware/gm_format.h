/* gm_format.h: numbers and words into fields of a text screen. What does not fit its field becomes ####. */
#ifndef GM_FORMAT_H
#define GM_FORMAT_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

enum { GM_FORMAT_DECIMALS = 9, GM_FORMAT_WIDTH = 20 };

/* numerator/denominator, exactly rounded to `decimals` digits, halves away from zero, right-aligned in `width`
 * characters (no terminating zero). A value that rounds to zero carries no sign. 0, or -1 and a field of # where it
 * does not fit, the denominator is 0, or decimals or width are out of range. */
int gm_format_ratio(char *field, int width, int64_t numerator, int64_t denominator, int decimals);
int gm_format_whole(char *field, int width, int64_t value);
/* Text left-aligned, filled up with blanks; 0, or -1 and a field of # where it is too long. */
int gm_format_text(char *field, int width, const char *text);

#ifdef __cplusplus
}
#endif

#endif
