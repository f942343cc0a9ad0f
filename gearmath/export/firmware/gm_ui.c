/* gm_ui.c: what every event does on every page (see gm_ui.h). Only here is the core told to do anything. */
#include "gm_ui.h"

#include <stddef.h>
#include <string.h>

static void gm_look(const gm_ui *ui, gm_status *status) {
  gm_mask();
  gm_core_status(ui->core, status);
  gm_unmask();
}

static int gm_move(gm_ui *ui, int32_t steps) {
  int refused;
  gm_mask();
  refused = gm_core_move(ui->core, steps);
  gm_unmask();
  if (refused) {
    ui->message = "Not now: hob turns?";
  }
  return refused;
}

/* An act of the operator: the healthy output may go on, where the core has no fault. */
static void gm_arm_output(const gm_ui *ui) {
  gm_mask();
  (void)gm_core_arm(ui->core);
  gm_unmask();
}

/* A move that ends forwards (in the sense of `forward`, +1 or -1), beyond its place and back where it would not. */
static int gm_move_forward(gm_ui *ui, int32_t steps, int forward) {
  const int32_t play = GM_BACKLASH_STEPS * forward;
  ui->then = 0;
  if (GM_BACKLASH_STEPS == 0 || (int64_t)steps * forward > 0) {
    return gm_move(ui, steps);
  }
  if (gm_move(ui, steps - play)) {
    return -1;
  }
  ui->then = play;
  return 0;
}

static int gm_far(int64_t a, int64_t b) {
  return a - b > GM_STANDING_COUNTS || b - a > GM_STANDING_COUNTS;
}

/* Watches the hob in steps of GM_WATCH_MS: the rate of the core is up to two seconds old. */
static void gm_watch(gm_ui *ui, const gm_status *status, uint32_t now) {
  if ((uint32_t)(now - ui->watched_at) >= GM_WATCH_MS) {
    ui->turning = gm_far(status->edges[GM_HOB], ui->watched);
    ui->watched = status->edges[GM_HOB];
    ui->watched_at = now;
  }
}

static int gm_hob_turns(const gm_ui *ui, const gm_status *status) {
  return ui->turning || gm_far(status->edges[GM_HOB], ui->watched);
}

static void gm_go(gm_ui *ui, gm_page page) {
  ui->page = page;
  ui->choice = 0;
  ui->armed = 0;
  ui->test = GM_TEST_READY;
  if (page == GM_PAGE_START) {
    ui->refusal = gm_job_make(&ui->edit, &ui->job, &ui->facts);
  }
}

/* From everywhere outside of the job: to the job that waits, or to the first page of a new one. */
static void gm_go_home(gm_ui *ui) {
  gm_go(ui, ui->phase ? GM_PAGE_STOPPED : gm_edit_first());
}

static void gm_choose(gm_ui *ui, int direction, int entries) {
  const int moved = ui->choice + direction;
  ui->choice = moved < 0 ? 0 : moved >= entries ? entries - 1 : moved;
}

/* Detents in quick succession count for more, so that 999 teeth are within reach. */
static int32_t gm_factor(gm_ui *ui, int event, uint32_t now) {
  const uint32_t elapsed = now - ui->knob_at;
  const int same = ui->knob_event == event;
  ui->knob_at = now;
  ui->knob_event = event;
  return !same || elapsed >= 80 ? 1 : elapsed >= 30 ? 5 : 25;
}

/* "yes" on the page "Start?": the only place where a job goes to the core. */
static unsigned gm_start(gm_ui *ui, const gm_status *status) {
  int refused;
  const int only_set = ui->choice == GM_START_SET;
  if (ui->refusal != GM_JOB_OK) {
    return 0;
  }
  if (status->mode != GM_IDLE) {
    ui->message = "Not now: table moves";
    return 0;
  }
  gm_mask();
  refused = gm_core_set_job(ui->core, &ui->job) || (!only_set && gm_core_run(ui->core));
  gm_unmask();
  if (refused) {
    ui->message = "Refused by the core";
    return 0;
  }
  gm_arm_output(ui);
  if (ui->loaded_ratio.numerator != ui->facts.ratio.numerator ||
      ui->loaded_ratio.denominator != ui->facts.ratio.denominator) {
    ui->pass = 0; /* another gear */
  }
  ui->pass_from = 0;
  ui->loaded = ui->edit;
  ui->loaded_ratio = ui->facts.ratio;
  ui->phase = 1;
  ui->thread = 0;
  ui->watched = 0; /* the counts start anew */
  gm_go(ui, only_set ? GM_PAGE_STOPPED : GM_PAGE_RUN);
  if (only_set) {
    ui->message = "Phase is set here";
  }
  return GM_UI_SAVE;
}

/* The sense in which the job turns the motor while the hob turns forward. */
static int gm_forward(const gm_ui *ui) {
  return ui->loaded_ratio.numerator < 0 ? -1 : 1;
}

static void gm_run_on(gm_ui *ui, const gm_status *status) {
  int refused;
  if (status->mode != GM_IDLE) {
    ui->message = "Not now: table moves";
    return;
  }
  if (GM_BACKLASH_STEPS > 0 && status->dir != gm_forward(ui) && (gm_is_lathe() || !gm_hob_turns(ui, status))) {
    if (!gm_move_forward(ui, 0, gm_forward(ui))) { /* a hob that turns is caught up forwards anyway */
      ui->then_run = 1;
    }
    return;
  }
  gm_mask();
  refused = gm_core_run(ui->core);
  gm_unmask();
  if (refused) {
    ui->message = "Refused by the core";
    return;
  }
  gm_arm_output(ui);
  ui->edit = ui->loaded;
  ui->pass_from = status->position;
  gm_go(ui, GM_PAGE_RUN);
}

/* Lathe: moves the carriage to the next start, with the spindle standing. */
static void gm_shift(gm_ui *ui, const gm_status *status) {
  int32_t steps;
  if (status->mode != GM_IDLE || gm_hob_turns(ui, status)) {
    ui->message = "Stop spindle first";
  } else if (gm_next_start(&ui->loaded, &ui->loaded_ratio, status->edges[GM_HOB], status->position, &steps)) {
    ui->message = "Too far: new job";
  } else if (!gm_move(ui, steps)) {
    ui->shifting = 1;
    ui->counted = status->edges[GM_HOB];
  }
}

/* The move to the next start has ended: the phase starts anew here, if the spindle has stood. */
static void gm_end_shift(gm_ui *ui, const gm_status *status) {
  gm_settings settings = ui->loaded;
  gm_job job;
  gm_facts facts;
  int refused = status->edges[GM_HOB] != ui->counted || gm_job_make(&settings, &job, &facts) != GM_JOB_OK;
  ui->shifting = 0;
  if (!refused) {
    gm_mask();
    refused = gm_core_set_job(ui->core, &job);
    if (!refused && status->shoulder != 0) { /* places are counted from here now */
      gm_core_set_shoulder(ui->core, status->shoulder - status->position);
    }
    gm_unmask();
  }
  if (refused) {
    ui->phase = 0;
    gm_go(ui, gm_edit_first());
    ui->message = "Spindle moved: lost";
    return;
  }
  ui->thread = (ui->thread + 1) % ui->loaded.starts;
  gm_go(ui, GM_PAGE_STOPPED);
  ui->message = "Next start is ready";
}

/* Lathe: the shoulder is where the carriage stands, or is taken away there. */
static void gm_set_shoulder(gm_ui *ui, const gm_status *status) {
  const int64_t place = status->shoulder != 0 && status->shoulder == status->position ? 0 : status->position;
  gm_mask();
  gm_core_set_shoulder(ui->core, place);
  gm_unmask();
  ui->message = place != 0 ? "Shoulder is set" : "No shoulder";
}

/* Lathe: the carriage returns to where the job began, with the tool drawn out. */
static void gm_go_back(gm_ui *ui, const gm_status *status) {
  if (status->mode != GM_IDLE || status->position > INT32_MAX / 2 || status->position < -(INT32_MAX / 2)) {
    ui->message = "Too far: jog";
  } else if (status->position != 0) {
    (void)gm_move_forward(ui, (int32_t)-status->position, gm_forward(ui));
  }
}

/* The last entries are for a lathe, the very last for threads of several starts. */
int gm_stopped_entries(const gm_ui *ui) {
  return !gm_is_lathe() ? (int)GM_STOPPED_GEAR_ENTRIES : ui->loaded.starts > 1 ? (int)GM_STOPPED_ENTRIES : (int)GM_STOPPED_NEXT;
}

static void gm_press_stopped(gm_ui *ui, const gm_status *status) {
  switch (ui->choice) {
    case GM_STOPPED_SHOULDER: gm_set_shoulder(ui, status); break;
    case GM_STOPPED_BACK: gm_go_back(ui, status); break;
    case GM_STOPPED_RUN_ON: gm_run_on(ui, status); break;
    case GM_STOPPED_JOG: gm_go(ui, GM_PAGE_JOG); break;
    case GM_STOPPED_NEW: gm_go(ui, gm_edit_first()); break;
    case GM_STOPPED_NEXT: gm_shift(ui, status); break;
    default: break;
  }
}

static void gm_press_menu(gm_ui *ui) {
  static const gm_page pages[] = {GM_PAGE_JOG, GM_PAGE_TEST_HOB, GM_PAGE_TEST_TABLE, GM_PAGE_DIVIDE};
  if (ui->choice == GM_MENU_JOB) {
    gm_go_home(ui);
  } else {
    gm_go(ui, pages[ui->choice - 1]);
  }
}

static void gm_jog(gm_ui *ui, int direction, uint32_t now) {
  const int32_t n = ui->jog + direction;
  const int64_t steps = gm_jog_steps(ui->choice, n) - ui->jog_done;
  ui->armed_at = now;
  if (steps > INT32_MAX || steps < -INT32_MAX || n > GM_MAX_JOGS || n < -GM_MAX_JOGS) {
    ui->armed = 0;
  } else if (!gm_move(ui, (int32_t)steps)) {
    ui->jog = n;
    ui->jog_done += steps;
  }
}

static void gm_arm(gm_ui *ui, uint32_t now) {
  ui->armed = !ui->armed;
  ui->armed_at = now;
  ui->jog = 0;
  ui->jog_done = 0;
}

static void gm_divide(gm_ui *ui) {
  /* the nearer way; `at` counts on beyond a turn, which need not be a whole number of steps */
  int32_t way = (ui->target - ui->at) % ui->divisions;
  int64_t steps;
  way = way > ui->divisions / 2 ? way - ui->divisions : way < -(ui->divisions / 2) ? way + ui->divisions : way;
  steps = gm_division_step(ui->at + way, ui->divisions) - gm_division_step(ui->at, ui->divisions);
  if (!gm_move_forward(ui, (int32_t)steps, 1)) {
    ui->at += way;
    ui->target = (ui->target + 1) % ui->divisions;
  }
}

static void gm_test_hob(gm_ui *ui, const gm_status *status) {
  const int64_t edges = status->edges[GM_HOB];
  ui->counted = ui->test == GM_TEST_COUNTING ? edges - ui->counted : edges;
  ui->test = ui->test == GM_TEST_DONE ? GM_TEST_READY : ui->test + 1;
}

static void gm_turn_division(gm_ui *ui, int32_t change) {
  if (ui->page == GM_PAGE_DIVIDE) {
    const int32_t divisions = ui->divisions + change;
    ui->divisions = divisions < 2 ? 2 : divisions > GM_MAX_DIVISIONS ? GM_MAX_DIVISIONS : divisions;
  } else {
    ui->target = ((ui->target + change) % ui->divisions + ui->divisions) % ui->divisions;
  }
}

static void gm_knob(gm_ui *ui, int event, uint32_t now) {
  const int direction = event == GM_UI_KNOB_UP ? 1 : -1;
  const int32_t factor = gm_factor(ui, event, now);
  switch (ui->page) {
    case GM_PAGE_START: gm_choose(ui, direction, GM_START_ANSWERS); break;
    case GM_PAGE_READOUT: break;
    case GM_PAGE_STOP:
    case GM_PAGE_TEST_TABLE: gm_choose(ui, direction, 2); break;
    case GM_PAGE_RUN: gm_choose(ui, direction, gm_is_lathe() ? GM_THREAD_VIEWS : GM_GEAR_VIEWS); break;
    case GM_PAGE_STOPPED:
      gm_choose(ui, direction, gm_stopped_entries(ui));
      break;
    case GM_PAGE_MENU: gm_choose(ui, direction, GM_MENU_ENTRIES); break;
    case GM_PAGE_JOG:
      if (ui->armed) {
        gm_jog(ui, direction, now);
      } else {
        gm_choose(ui, direction, GM_JOG_SIZES);
      }
      break;
    case GM_PAGE_DIVIDE:
    case GM_PAGE_DIVIDE_GO: gm_turn_division(ui, direction * factor); break;
    default: gm_edit_turn(ui, direction, factor); break;
  }
}

static void gm_press_stop(gm_ui *ui, const gm_status *status) {
  if (!ui->choice) {
    gm_go(ui, GM_PAGE_RUN);
    return;
  }
  gm_mask();
  gm_core_stop(ui->core);
  gm_unmask();
  ui->pass = status->position - ui->pass_from;
  gm_go(ui, GM_PAGE_STOPPED);
}

static unsigned gm_press(gm_ui *ui, const gm_status *status, uint32_t now) {
  const int yes = ui->choice;
  switch (ui->page) {
    case GM_PAGE_POWER_UP:
      gm_arm_output(ui);
      gm_go(ui, gm_edit_first());
      break;
    case GM_PAGE_START:
      if (yes) {
        return gm_start(ui, status);
      }
      gm_go(ui, gm_edit_first());
      break;
    case GM_PAGE_RUN: gm_go(ui, GM_PAGE_STOP); break;
    case GM_PAGE_STOP: gm_press_stop(ui, status); break;
    case GM_PAGE_STOPPED: gm_press_stopped(ui, status); break;
    case GM_PAGE_MENU: gm_press_menu(ui); break;
    case GM_PAGE_JOG: gm_arm(ui, now); break;
    case GM_PAGE_DIVIDE:
      gm_go(ui, gm_is_lathe() ? GM_PAGE_READOUT : GM_PAGE_DIVIDE_GO);
      ui->at = 0;
      ui->target = 1;
      ui->counted = status->edges[GM_HOB];
      break;
    case GM_PAGE_READOUT: ui->counted = status->edges[GM_HOB]; break;
    case GM_PAGE_DIVIDE_GO: gm_divide(ui); break;
    case GM_PAGE_TEST_HOB: gm_test_hob(ui, status); break;
    case GM_PAGE_TEST_TABLE:
      if (yes) {
        ui->choice = 0;
        ui->test = gm_move(ui, (int32_t)gm_division_step(1, 1)) ? GM_TEST_READY : GM_TEST_DONE;
      } else {
        gm_go(ui, GM_PAGE_MENU);
      }
      break;
    case GM_PAGE_FAULT: break;
    default: gm_go(ui, gm_edit_next(ui)); break;
  }
  return 0;
}

static void gm_acknowledge(gm_ui *ui) {
  int refused;
  gm_mask();
  refused = gm_core_acknowledge(ui->core);
  gm_unmask();
  if (refused) {
    ui->message = "The cause is there";
    return;
  }
  gm_arm_output(ui);
  if (ui->phase) {
    gm_go(ui, GM_PAGE_STOPPED);
    return;
  }
  gm_go(ui, gm_edit_first());
  ui->message = "PHASE LOST: set up";
}

static void gm_long_press(gm_ui *ui) {
  switch (ui->page) {
    case GM_PAGE_FAULT: gm_acknowledge(ui); break;
    case GM_PAGE_RUN: gm_go(ui, GM_PAGE_STOP); break;
    case GM_PAGE_STOP: gm_go(ui, GM_PAGE_RUN); break;
    case GM_PAGE_POWER_UP:
    case GM_PAGE_START: gm_go(ui, gm_edit_first()); break;
    case GM_PAGE_MENU: gm_go_home(ui); break;
    case GM_PAGE_READOUT:
    case GM_PAGE_DIVIDE_GO: gm_go(ui, GM_PAGE_DIVIDE); break;
    default: gm_go(ui, gm_edit_before(ui)); break;
  }
}

/* The page follows what the core does by itself. 1 where it changed: an event meant for the page before is dropped. */
static int gm_follow(gm_ui *ui, const gm_status *status, uint32_t now) {
  const gm_page page = ui->page;
  if (status->fault != GM_NO_FAULT) { /* also while the table still follows a hob that runs down */
    ui->phase = ui->phase && status->has_job && !ui->shifting;
    ui->shifting = 0;
    if (page != GM_PAGE_FAULT) {
      gm_go(ui, GM_PAGE_FAULT);
    }
  } else if (page == GM_PAGE_FAULT) {
    gm_go(ui, gm_edit_first());
  } else if (status->mode == GM_RUN && page != GM_PAGE_RUN && page != GM_PAGE_STOP && page != GM_PAGE_STOPPED) {
    gm_go(ui, GM_PAGE_RUN);
  } else if (status->mode == GM_IDLE && (page == GM_PAGE_RUN || page == GM_PAGE_STOP)) {
    gm_go(ui, GM_PAGE_STOPPED);
    if (status->at_shoulder) {
      ui->message = "SHOULDER: tool out";
    }
  }
  if (ui->shifting && status->mode == GM_IDLE) {
    gm_end_shift(ui, status);
    return 1;
  }
  if (status->mode == GM_IDLE && status->fault == GM_NO_FAULT) {
    if (ui->then != 0) {
      const int32_t steps = ui->then;
      ui->then = 0;
      if (gm_move(ui, steps)) {
        ui->then_run = 0;
      }
      return 1;
    }
    if (ui->then_run) {
      ui->then_run = 0;
      gm_run_on(ui, status);
      return 1;
    }
  } else if (status->mode != GM_MOVE) {
    ui->then = ui->then_run = 0;
  }
  if (ui->armed && (uint32_t)(now - ui->armed_at) > GM_ARMED_MS) {
    ui->armed = 0;
    return 1;
  }
  return ui->page != page;
}

/* A press during a move ends it; the place it was to reach is then unknown. */
static void gm_break_off(gm_ui *ui) {
  gm_mask();
  gm_core_stop(ui->core);
  gm_unmask();
  if (ui->page == GM_PAGE_DIVIDE_GO) {
    gm_go(ui, GM_PAGE_DIVIDE);
  }
  if (ui->page == GM_PAGE_STOPPED) {
    ui->choice = GM_STOPPED_WAIT; /* so that one press more does not begin it again */
  }
  if (ui->shifting) { /* the carriage is between two starts */
    ui->shifting = 0;
    ui->phase = 0;
    gm_go(ui, gm_edit_first());
  }
  ui->armed = 0;
  ui->jog = 0;
  ui->then = ui->then_run = 0;
  ui->test = GM_TEST_READY;
  ui->message = "Move stopped";
}

void gm_ui_init(gm_ui *ui, gm_core *core, const gm_settings *restored, const gm_status *status) {
  memset(ui, 0, sizeof *ui);
  ui->core = core;
  ui->divisions = 24;
  ui->target = 1;
  ui->facts.ratio.denominator = 1;
  ui->loaded_ratio.denominator = 1;
  gm_edit_defaults(ui);
  ui->restored = restored != NULL && gm_edit_restore(ui, restored) == 0;
  ui->loaded = ui->edit;
  gm_screen_draw(ui, status);
}

unsigned gm_ui_event(gm_ui *ui, int event, const gm_status *status, uint32_t now) {
  const int press = event == GM_UI_SHORT || event == GM_UI_LONG;
  const int read = ui->message != NULL && ui->page != GM_PAGE_FAULT; /* the press takes the message away, no more */
  gm_status after;
  unsigned requests = 0;
  gm_watch(ui, status, now);
  if (event != GM_UI_POLL) {
    ui->message = NULL;
  }
  if (!gm_follow(ui, status, now) && !(press && read)) {
    if (status->mode == GM_MOVE) {
      if (press) {
        gm_break_off(ui);
      }
    } else if (event == GM_UI_KNOB_UP || event == GM_UI_KNOB_DOWN) {
      gm_knob(ui, event, now);
    } else if (event == GM_UI_SHORT) {
      requests = gm_press(ui, status, now);
    } else if (event == GM_UI_LONG) {
      gm_long_press(ui);
    }
  }
  gm_look(ui, &after);
  gm_screen_draw(ui, &after);
  return requests;
}
