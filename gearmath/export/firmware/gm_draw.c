/* gm_draw.c: lines, numbers with their units, and choices of the display. */
#include "gm_draw.h"

#include <stddef.h>

#include "gm_format.h"

void gm_put(gm_ui *ui, int row, int column, const char *text) {
  int k;
  for (k = 0; text[k] != '\0' && column + k < GM_COLUMNS; ++k) {
    ui->screen[row][column + k] = text[k];
  }
}

void gm_line(gm_ui *ui, int row, const char *text) {
  gm_format_text(ui->screen[row], GM_COLUMNS, text);
}

void gm_number(gm_ui *ui, int row, int column, int width, int64_t value) {
  gm_format_whole(ui->screen[row] + column, width, value);
}

void gm_quantity(gm_ui *ui, int row, const char *label, const gm_ratio *value, int decimals, const char *unit) {
  int start = 0, end = GM_COLUMNS, k;
  for (k = 0; unit[k] != '\0'; ++k) {
    --end;
  }
  gm_line(ui, row, label);
  gm_put(ui, row, end, unit);
  end -= end < GM_COLUMNS;
  for (k = 0; label[k] != '\0'; ++k) {
    start = k + 2;
  }
  gm_format_ratio(ui->screen[row] + start, end - start, value->numerator, value->denominator, decimals);
}

void gm_count(gm_ui *ui, int row, const char *label, int64_t value, const char *unit) {
  const gm_ratio whole = {value, 1};
  gm_quantity(ui, row, label, &whole, 0, unit);
}

void gm_answer(gm_ui *ui, const char *question) {
  gm_line(ui, 3, question);
  gm_put(ui, 3, 9, ui->choice ? " no  >yes<" : ">no<  yes ");
}

void gm_size(gm_ui *ui, int row, int end, int32_t size) {
  int decimals = 4;
  int32_t unit = 1;
  for (; decimals > 0 && size % (10 * unit) == 0; unit *= 10) {
    --decimals;
  }
  gm_format_ratio(ui->screen[row] + end - 7, 7, size, GM_HOB_UNIT, decimals);
}

/* Unit and decimals of a pitch. */
static const char *gm_pitch_unit(const gm_settings *settings) {
  static const char *const units[GM_PITCHES] = {"mm", "tpi", "mm", "m", "DP"};
  return units[settings->pitch_kind];
}

static int gm_in_inches(const gm_settings *settings) {
  return settings->pitch_kind == GM_PITCH_TPI || settings->pitch_kind == GM_PITCH_DP;
}

void gm_pitch(gm_ui *ui, int row, const char *label, const gm_settings *settings) {
  const gm_ratio pitch = {settings->pitch, gm_in_inches(settings) ? 100 : 1000};
  gm_quantity(ui, row, label, &pitch, gm_in_inches(settings) ? 2 : 3, gm_pitch_unit(settings));
}

void gm_job_line(gm_ui *ui, int row, const gm_settings *settings) {
  if (settings->profile == GM_LATHE) {
    gm_pitch(ui, row, settings->pitch_kind == GM_PITCH_FEED ? "Feed" : settings->left ? "Left" : "Right", settings);
    return;
  }
  gm_line(ui, row, "    teeth");
  gm_number(ui, row, 0, 3, settings->teeth);
  gm_size(ui, row, 17, settings->hob_size);
  gm_put(ui, row, 18, settings->hob_unit == GM_MM ? "m" : "DP");
}

static const char *gm_length_unit(const gm_settings *settings) {
  return settings->hob_unit == GM_MM ? "mm" : "in";
}

void gm_length(gm_ui *ui, int row, const char *label, int bad, const gm_ratio *value) {
  const gm_ratio none = {0, 0};
  gm_quantity(ui, row, label, bad ? &none : value, ui->edit.hob_unit == GM_MM ? 3 : 4, gm_length_unit(&ui->edit));
}

void gm_draw_choice(gm_ui *ui, const char *title, const char *const *entries, int count) {
  int first = ui->choice < 2 ? 0 : ui->choice - 1, k;
  first = first > count - 3 && count >= 3 ? count - 3 : first;
  gm_line(ui, 0, title);
  for (k = 0; k < 3 && first + k < count; ++k) {
    gm_line(ui, k + 1, "");
    gm_put(ui, k + 1, 0, first + k == ui->choice ? ">" : " ");
    gm_put(ui, k + 1, 1, entries[first + k]);
  }
}

void gm_rpm(gm_ui *ui, int row, const char *label, uint32_t rate, const gm_ratio *times) {
  gm_ratio rpm = {rate, 1};
  const gm_ratio none = {0, 0};
  const int bad = gm_ratio_times(&rpm, 60 * (int64_t)GM_TURN_COUNTS_DEN, GM_TURN_COUNTS) ||
                  (times != NULL && gm_ratio_times(&rpm, times->numerator, times->denominator));
  gm_quantity(ui, row, label, bad ? &none : &rpm, times == NULL ? 1 : 2, "rpm");
}
