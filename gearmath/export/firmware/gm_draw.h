/* gm_draw.h: what the pages of the display are drawn with; for gm_screen.c only. */
#ifndef GM_DRAW_H
#define GM_DRAW_H

#include "gm_ui.h"

#ifdef __cplusplus
extern "C" {
#endif

void gm_put(gm_ui *ui, int row, int column, const char *text);
/* A whole line of text; one that is too long shows as ####. */
void gm_line(gm_ui *ui, int row, const char *text);
void gm_number(gm_ui *ui, int row, int column, int width, int64_t value);
/* "label       number unit": the number ends before a unit of up to four characters. */
void gm_quantity(gm_ui *ui, int row, const char *label, const gm_ratio *value, int decimals, const char *unit);
void gm_count(gm_ui *ui, int row, const char *label, int64_t value, const char *unit);
void gm_answer(gm_ui *ui, const char *question);
/* 1000 x value with no more decimals than it needs, right-aligned before `end`. */
void gm_size(gm_ui *ui, int row, int end, int32_t size);
void gm_pitch(gm_ui *ui, int row, const char *label, const gm_settings *settings);
/* The job in one line: "127 teeth    60.8 DP", "Left       1.500 mm". */
void gm_job_line(gm_ui *ui, int row, const gm_settings *settings);
/* Inch with four decimals, mm with three. */
void gm_length(gm_ui *ui, int row, const char *label, int bad, const gm_ratio *value);
void gm_draw_choice(gm_ui *ui, const char *title, const char *const *entries, int count);
/* Turns per minute of the hob (spindle), and of the table with a ratio. */
void gm_rpm(gm_ui *ui, int row, const char *label, uint32_t rate, const gm_ratio *times);

#ifdef __cplusplus
}
#endif

#endif
