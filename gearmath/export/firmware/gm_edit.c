/* gm_edit.c: the pages that change the parameters of the job (see gm_ui.h). They touch nothing that runs. */
#include "gm_ui.h"

enum { GM_TPI_DETENT = 25, GM_PITCH_DETENT = 5, GM_HELIX_DETENT = 1, GM_FEED_DETENT = 10 };

int gm_is_lathe(void) {
#ifdef GM_PROFILE_LATHE
  return 1;
#else
  return 0;
#endif
}

static void gm_take_hob(gm_ui *ui) {
#ifndef GM_PROFILE_LATHE
  ui->edit.hob_unit = (uint8_t)gm_hobs[ui->hob].unit;
  ui->edit.hob_size = gm_hobs[ui->hob].size;
  ui->edit.depth_rule = (uint8_t)gm_hobs[ui->hob].depth_rule;
#else
  (void)ui;
#endif
}

static int gm_hob_count(void) {
#ifndef GM_PROFILE_LATHE
  return (int)(sizeof gm_hobs / sizeof gm_hobs[0]);
#else
  return 1;
#endif
}

void gm_edit_defaults(gm_ui *ui) {
  ui->edit.profile = (uint8_t)(gm_is_lathe() ? GM_LATHE : GM_HOBBING);
  ui->edit.teeth = 24;
  ui->edit.starts = GM_HOB_LEFT ? -GM_HOB_STARTS : GM_HOB_STARTS;
  ui->edit.helix = 0;
  ui->edit.left = 0;
  ui->edit.climb = 0;
  ui->edit.feed = 250;
  ui->edit.pitch_kind = GM_PITCH_MM;
  ui->edit.pitch = 1000;
  ui->edit.hob_unit = GM_MM;
  ui->edit.depth_rule = GM_DEPTH_225_M;
  ui->edit.hob_size = GM_HOB_UNIT;
  ui->hob = 0;
  gm_take_hob(ui);
}

int gm_edit_restore(gm_ui *ui, const gm_settings *restored) {
  if (gm_settings_check(restored) != GM_JOB_OK) {
    return -1;
  }
#ifndef GM_PROFILE_LATHE
  {
    int k;
    for (k = 0; k < gm_hob_count() && (gm_hobs[k].unit != restored->hob_unit || gm_hobs[k].size != restored->hob_size ||
                                       gm_hobs[k].depth_rule != restored->depth_rule); ++k) {
    }
    if (k == gm_hob_count()) {
      return -1;
    }
    ui->hob = k;
  }
#endif
  ui->edit = *restored;
  return 0;
}

/* value + change, kept within low and high. */
static int32_t gm_bounded(int32_t value, int32_t change, int32_t low, int32_t high) {
  const int32_t moved = value + change;
  return moved < low ? low : moved > high ? high : moved;
}

static void gm_turn_starts(gm_settings *edit, int32_t direction) {
  const int32_t low = edit->profile == GM_LATHE ? 1 : -GM_MAX_STARTS;
  int32_t starts = gm_bounded(edit->starts, direction, low, GM_MAX_STARTS);
  edit->starts = (int8_t)(starts == 0 ? direction : starts); /* there is no hob of 0 starts */
}

static void gm_turn_helix(gm_settings *edit, int32_t change) {
  const int32_t angle = gm_bounded(edit->left ? -edit->helix : edit->helix, change, -GM_MAX_HELIX, GM_MAX_HELIX);
  edit->left = angle < 0;
  edit->helix = (uint16_t)(angle < 0 ? -angle : angle);
}

static void gm_turn_pitch_kind(gm_settings *edit, int32_t direction) {
  const int32_t kind = gm_bounded(edit->pitch_kind, direction, GM_PITCH_MM, GM_PITCHES - 1);
  if (kind != edit->pitch_kind) {
    edit->pitch_kind = (uint8_t)kind;
    edit->pitch = kind == GM_PITCH_MM ? 1000 : kind == GM_PITCH_TPI || kind == GM_PITCH_DP ? 2000 : kind == GM_PITCH_MODULE ? 1000 : 100;
    edit->starts = 1;
  }
}

void gm_edit_turn(gm_ui *ui, int32_t direction, int32_t factor) {
  gm_settings *edit = &ui->edit;
  const int32_t change = direction * factor;
  const int32_t detent = edit->pitch_kind == GM_PITCH_TPI || edit->pitch_kind == GM_PITCH_DP ? GM_TPI_DETENT : GM_PITCH_DETENT;
  switch (ui->page) {
    case GM_PAGE_TEETH: edit->teeth = (uint16_t)gm_bounded(edit->teeth, change, GM_MIN_TEETH, GM_MAX_TEETH); break;
    case GM_PAGE_HOB:
      ui->hob = gm_bounded(ui->hob, direction, 0, gm_hob_count() - 1);
      gm_take_hob(ui);
      break;
    case GM_PAGE_STARTS: gm_turn_starts(edit, direction); break;
    case GM_PAGE_HELIX: gm_turn_helix(edit, change * GM_HELIX_DETENT); break;
    case GM_PAGE_HELIX_FEED: edit->feed = gm_bounded(edit->feed, change * GM_FEED_DETENT, 10, GM_MAX_FEED); break;
    case GM_PAGE_CLIMB: edit->climb = direction > 0; break;
    case GM_PAGE_PITCH_KIND: gm_turn_pitch_kind(edit, direction); break;
    case GM_PAGE_PITCH: edit->pitch = gm_bounded(edit->pitch, change * detent, detent, GM_MAX_PITCH); break;
    case GM_PAGE_HAND: edit->left = direction > 0; break;
    default: break;
  }
}

gm_page gm_edit_first(void) {
  return gm_is_lathe() ? GM_PAGE_PITCH_KIND : GM_PAGE_TEETH;
}

gm_page gm_edit_next(const gm_ui *ui) {
  switch (ui->page) {
    case GM_PAGE_TEETH: return GM_PAGE_HOB;
    case GM_PAGE_HOB: return GM_PAGE_STARTS;
    case GM_PAGE_STARTS: return gm_is_lathe() ? GM_PAGE_HAND : GM_PAGE_HELIX;
    case GM_PAGE_HELIX: return ui->edit.helix != 0 && !GM_HAS_FEED ? GM_PAGE_HELIX_FEED : GM_PAGE_START;
    case GM_PAGE_HELIX_FEED: return GM_PAGE_CLIMB;
    case GM_PAGE_PITCH_KIND: return GM_PAGE_PITCH;
    case GM_PAGE_PITCH: return ui->edit.pitch_kind == GM_PITCH_FEED ? GM_PAGE_HAND : GM_PAGE_STARTS;
    default: return GM_PAGE_START;
  }
}

gm_page gm_edit_before(const gm_ui *ui) {
  switch (ui->page) {
    case GM_PAGE_HOB: return GM_PAGE_TEETH;
    case GM_PAGE_STARTS: return gm_is_lathe() ? GM_PAGE_PITCH : GM_PAGE_HOB;
    case GM_PAGE_HELIX: return GM_PAGE_STARTS;
    case GM_PAGE_HELIX_FEED: return GM_PAGE_HELIX;
    case GM_PAGE_CLIMB: return GM_PAGE_HELIX_FEED;
    case GM_PAGE_PITCH: return GM_PAGE_PITCH_KIND;
    case GM_PAGE_HAND: return ui->edit.pitch_kind == GM_PITCH_FEED ? GM_PAGE_PITCH : GM_PAGE_STARTS;
    default: return GM_PAGE_MENU;
  }
}
