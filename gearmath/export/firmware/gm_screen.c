/* gm_screen.c: every page as 4 lines of 20 characters (see gm_ui.h). It reads; it changes nothing but the screen. */
#include <stddef.h>

#include "gm_draw.h"

static void gm_blank_line(gm_ui *ui, int row) {
  gm_ratio diameter;
  const int bad = gm_blank_diameter(&ui->edit, &diameter);
  gm_length(ui, row, "Blank", bad, &diameter);
}

static void gm_draw_power_up(gm_ui *ui) {
  gm_line(ui, 0, ui->restored ? "Last job restored" : "No stored job");
  gm_job_line(ui, 1, &ui->edit);
  gm_line(ui, 2, "PHASE IS LOST");
  gm_line(ui, 3, "Press: check the job");
}

/* Motor steps and hob edges of the ratio of the job on the screen, in lowest terms. */
static void gm_draw_ratio(gm_ui *ui, int row) {
  gm_job job;
  gm_facts facts;
  const gm_refusal refusal = gm_job_make(&ui->edit, &job, &facts);
  gm_count(ui, row, "Steps", facts.ratio.numerator, "");
  gm_count(ui, row + 1, "Edges", facts.ratio.denominator, "");
  gm_line(ui, row + 2, refusal == GM_JOB_OK ? "Press: next" : gm_refusal_text(refusal));
}

static void gm_draw_hob(gm_ui *ui) {
  gm_ratio depth;
  const int bad = gm_cut_depth(&ui->edit, &depth);
  gm_line(ui, 0, "Hob");
  gm_size(ui, 0, 11, ui->edit.hob_size);
  gm_put(ui, 0, 12, ui->edit.hob_unit == GM_MM ? "m" : "DP");
  gm_put(ui, 0, 15, "no");
  gm_number(ui, 0, 18, 2, ui->hob + 1);
  gm_blank_line(ui, 1);
  gm_length(ui, 2, "Depth", bad, &depth);
  gm_line(ui, 3, gm_depth_text(&ui->edit));
}

static void gm_draw_starts(gm_ui *ui) {
  const int starts = ui->edit.starts;
  gm_line(ui, 0, gm_is_lathe() ? "Thread starts" : starts < 0 ? "Hob starts, left" : "Hob starts, right");
  gm_number(ui, 0, 18, 2, starts < 0 ? -starts : starts);
  gm_draw_ratio(ui, 1);
}

static void gm_draw_helix(gm_ui *ui) {
  const gm_ratio angle = {ui->edit.helix, 100};
  gm_ratio lead;
  gm_quantity(ui, 0, ui->edit.left ? "Left hand" : "Right hand", &angle, 2, "deg");
  if (ui->edit.helix == 0) {
    gm_line(ui, 0, "Helix none, spur");
    gm_line(ui, 1, "");
  } else {
    const int bad = gm_helix_lead(&ui->edit, &lead);
    gm_length(ui, 1, "Lead", bad, &lead);
  }
  gm_blank_line(ui, 2);
  gm_line(ui, 3, "Press: next");
}

static void gm_draw_helix_feed(gm_ui *ui) {
  const gm_ratio feed = {ui->edit.feed, 1000};
  gm_quantity(ui, 0, "Feed", &feed, 3, "mm");
  gm_line(ui, 1, "per turn of table,");
  gm_line(ui, 2, "must be constant");
  gm_line(ui, 3, "Press: next");
}

static void gm_draw_pitch_kind(gm_ui *ui) {
  static const char *const kinds[] = {"Thread in mm", "Thread in tpi", "Feed in mm per turn", "Worm by module", "Worm by DP"};
  const int kept = ui->choice;
  ui->choice = ui->edit.pitch_kind;
  gm_draw_choice(ui, "Lead screw", kinds, GM_PITCHES);
  ui->choice = kept;
}

static void gm_draw_pitch(gm_ui *ui) {
  gm_pitch(ui, 0, ui->edit.pitch_kind == GM_PITCH_FEED ? "Feed/turn" : "Pitch", &ui->edit);
  gm_draw_ratio(ui, 1);
}

static void gm_draw_start(gm_ui *ui) {
  gm_job_line(ui, 0, &ui->edit);
  if (ui->refusal != GM_JOB_OK) {
    gm_line(ui, 1, "REFUSED");
    gm_line(ui, 2, gm_refusal_text(ui->refusal));
    gm_line(ui, 3, "Press: change job");
    if (ui->refusal == GM_TOO_FAST) {
      gm_count(ui, 3, "Set limit", ui->facts.max_rpm, "rpm");
    }
    return;
  }
  gm_count(ui, 1, gm_is_lathe() ? "Max speed" : "Hob max", ui->facts.max_rpm, "rpm");
  gm_line(ui, 2, ui->phase ? "OLD PHASE WILL GO" : "PHASE STARTS HERE");
  if (ui->turning && !gm_is_lathe()) {
    gm_line(ui, 2, "HOB TURNS: KEEP FREE");
  }
  gm_answer(ui, "Start?");
  if (ui->choice == GM_START_SET) {
    gm_line(ui, 3, ">Only set the phase<");
  }
}

static void gm_draw_run_speed(gm_ui *ui, const gm_status *status) {
  gm_rpm(ui, 1, gm_is_lathe() ? "Spindle" : "Hob", status->edge_rate, NULL);
  if (gm_is_lathe()) {
    gm_line(ui, 2, "");
    if (ui->loaded.starts > 1) {
      gm_count(ui, 2, "Thread start", ui->thread + 1, "");
    }
  } else {
    gm_ratio table = {ui->loaded.starts < 0 ? -ui->loaded.starts : ui->loaded.starts, ui->loaded.teeth};
    gm_rpm(ui, 2, "Table", status->edge_rate, &table);
  }
  if (status->in_phase) {
    gm_count(ui, 3, "In phase: lag", status->pending, "");
  } else {
    gm_count(ui, 3, "Lag", status->pending, "step");
  }
}

/* Until so many motor steps more are made, at the present speed. */
static void gm_time_left(gm_ui *ui, int row, const char *label, int64_t steps, const gm_status *status) {
  gm_ratio left = {steps < 0 ? -steps : steps, 1};
  if (status->edge_rate == 0 || ui->loaded_ratio.numerator == 0) {
    return;
  }
  /* steps over steps per edge and edges per second */
  if (gm_ratio_times(&left, ui->loaded_ratio.denominator, (int64_t)gm_magnitude(ui->loaded_ratio.numerator)) == 0 &&
      gm_ratio_times(&left, 1, status->edge_rate) == 0) {
    gm_quantity(ui, row, label, &left, 1, "s");
  }
}

/* Where hob and table stand, since the start of the job. */
static void gm_draw_run_place(gm_ui *ui, const gm_status *status) {
  const gm_ratio turns = {status->edges[GM_HOB] * GM_TURN_COUNTS_DEN, GM_TURN_COUNTS};
  gm_quantity(ui, 1, gm_is_lathe() ? "Turns" : "Hob turns", &turns, 2, "");
#ifdef GM_PROFILE_LATHE
  {
    gm_ratio place = {status->position, 1};
    const gm_ratio none = {0, 0};
    const int bad = gm_ratio_times(&place, GM_SCREW_STEPS_DEN, GM_SCREW_STEPS_NUM);
    gm_quantity(ui, 2, "Place", bad ? &none : &place, 3, "mm");
    gm_line(ui, 3, "");
    if (status->shoulder != 0) {
      gm_time_left(ui, 3, "Shoulder in", status->shoulder - status->position, status);
    }
  }
#else
  {
    const int64_t rest = status->position % GM_MOTOR_STEPS * GM_MOTOR_STEPS_DEN % GM_MOTOR_STEPS;
    const int64_t place = rest < 0 ? rest + GM_MOTOR_STEPS : rest;
    gm_ratio angle = {place, 1};
    gm_ratio_times(&angle, 360, GM_MOTOR_STEPS);
    gm_quantity(ui, 2, "Table", &angle, 2, "deg");
    gm_count(ui, 3, "Tooth", place * ui->loaded.teeth / GM_MOTOR_STEPS + 1, "");
  }
#endif
}

static void gm_draw_run_checks(gm_ui *ui, const gm_status *status) {
  gm_line(ui, 1, GM_HAS_INDEX ? "" : "No index pulse");
  if (GM_HAS_INDEX) {
    gm_count(ui, 1, "Checked", status->index_turns, "turn");
  }
  gm_count(ui, 2, "Steps", status->position, "");
  gm_line(ui, 3, "");
#if !defined(GM_PROFILE_LATHE) && !GM_HAS_FEED
  {
    gm_ratio turns = {status->position, 1};
    gm_ratio_times(&turns, GM_MOTOR_STEPS_DEN, GM_MOTOR_STEPS);
    gm_quantity(ui, 3, "Table turns", &turns, 2, "");
  }
#endif
#if GM_HAS_FEED
  {
    gm_ratio feed = {status->edges[GM_FEED], 1};
    const gm_ratio none = {0, 0};
    const int bad = gm_ratio_times(&feed, GM_FEED_COUNTS_DEN, GM_FEED_COUNTS_NUM);
    gm_quantity(ui, 3, "Feed", bad ? &none : &feed, 3, "mm");
  }
#endif
}

#ifndef GM_PROFILE_LATHE
/* From a start, or `run on`, to `Stop?`: this pass, the last one of the same job, and what is left until it is as long. */
static void gm_draw_run_pass(gm_ui *ui, const gm_status *status) {
  const int64_t steps = status->position - ui->pass_from;
  gm_ratio now = {steps, 1}, last = {ui->pass, 1};
  gm_ratio_times(&now, GM_MOTOR_STEPS_DEN, GM_MOTOR_STEPS);
  gm_ratio_times(&last, GM_MOTOR_STEPS_DEN, GM_MOTOR_STEPS);
  gm_quantity(ui, 1, "This pass", &now, 2, "turn");
  gm_line(ui, 2, "No pass before");
  gm_line(ui, 3, "");
  if (ui->pass != 0) {
    gm_quantity(ui, 2, "Last pass", &last, 2, "turn");
    if (gm_magnitude(steps) < gm_magnitude(ui->pass)) {
      gm_time_left(ui, 3, "Pass left", ui->pass - steps, status);
    }
  }
}
#endif

static void gm_draw_run(gm_ui *ui, const gm_status *status) {
  gm_job_line(ui, 0, &ui->loaded);
  if (status->waiting) {
    gm_line(ui, 0, "WAITS FOR THE PHASE");
  } else if (!status->in_phase) {
    gm_line(ui, 0, "CATCHING UP");
  }
  if (ui->choice == 0) {
    gm_draw_run_speed(ui, status);
  } else if (ui->choice == 1) {
    gm_draw_run_place(ui, status);
  } else if (ui->choice == 2) {
    gm_draw_run_checks(ui, status);
#ifndef GM_PROFILE_LATHE
  } else {
    gm_draw_run_pass(ui, status);
#endif
  }
}

static void gm_draw_stop(gm_ui *ui, const gm_status *status) {
  gm_rpm(ui, 0, "RUNS", status->edge_rate, NULL);
  gm_line(ui, 1, gm_is_lathe() ? "Clear the tool" : "Clear the hob of the");
  gm_line(ui, 2, gm_is_lathe() ? "before you stop" : "gear before you stop");
  gm_answer(ui, "Stop?");
}

static void gm_draw_stopped(gm_ui *ui, const gm_status *status) {
  static const char *const entries[] = {"wait", "run on, same phase", "jog", "new job", "shoulder is here",
                                        "back to start", "next start"};
  gm_draw_choice(ui, status->mode == GM_RUN ? "STOPPING" : "STOPPED, phase kept", entries, gm_stopped_entries(ui));
}

static void gm_draw_menu(gm_ui *ui) {
  static const char *const entries[] = {"job", "jog", "test hob encoder", "test one turn", "divide"};
  gm_draw_choice(ui, "Menu", entries, GM_MENU_ENTRIES);
}

static void gm_draw_jog(gm_ui *ui) {
  static const int32_t hundredths[GM_JOG_SIZES] = {1, 10, 100, 1000};
  const char *unit = gm_is_lathe() ? "mm" : "deg";
  const gm_ratio size = {hundredths[ui->choice & 3], 100};
  const gm_ratio moved = {(int64_t)ui->jog * hundredths[ui->choice & 3], 100};
  gm_quantity(ui, 0, "Jog by", &size, 2, unit);
  gm_quantity(ui, 1, "Moved", &moved, 2, unit);
  gm_line(ui, 2, ui->armed ? "ARMED: knob moves" : "Press: arm the knob");
  gm_line(ui, 3, ui->armed ? "Press: disarm" : "Hold: menu");
}

static void gm_draw_divide(gm_ui *ui) {
  gm_ratio angle = {360, 1};
  if (ui->page == GM_PAGE_DIVIDE) {
    gm_ratio_times(&angle, 1, ui->divisions);
    gm_count(ui, 0, "Divide by", ui->divisions, "");
    gm_quantity(ui, 1, "Angle", &angle, 4, "deg");
    gm_line(ui, 2, "Press: 0 is here");
    gm_line(ui, 3, "Hold: menu");
    return;
  }
  gm_ratio_times(&angle, ui->target, ui->divisions);
  gm_line(ui, 0, "At         of");
  gm_number(ui, 0, 3, 7, (ui->at % ui->divisions + ui->divisions) % ui->divisions);
  gm_number(ui, 0, 14, 6, ui->divisions);
  gm_count(ui, 1, "Go to", ui->target, "");
  gm_quantity(ui, 2, "Angle", &angle, 4, "deg");
  gm_line(ui, 3, "Press: go  Hold: end");
}

/* Lathe: where the spindle stands, by hand or indexing pin: the nearest division, and how far it is away. */
static void gm_draw_readout(gm_ui *ui, const gm_status *status) {
  const int64_t turned = (status->edges[GM_HOB] - ui->counted) * GM_TURN_COUNTS_DEN % GM_TURN_COUNTS;
  const int64_t place = turned < 0 ? turned + GM_TURN_COUNTS : turned;
  const int64_t nearest = (place * ui->divisions + GM_TURN_COUNTS / 2) / GM_TURN_COUNTS;
  gm_ratio angle = {place, 1}, away = {place * ui->divisions - nearest * GM_TURN_COUNTS, 1};
  gm_ratio_times(&angle, 360, GM_TURN_COUNTS);
  gm_ratio_times(&away, 360, GM_TURN_COUNTS);
  gm_ratio_times(&away, 1, ui->divisions);
  gm_line(ui, 0, "At         of");
  gm_number(ui, 0, 3, 7, nearest % ui->divisions);
  gm_number(ui, 0, 14, 6, ui->divisions);
  gm_quantity(ui, 1, "Angle", &angle, 3, "deg");
  gm_quantity(ui, 2, "Beside it", &away, 3, "deg");
  gm_line(ui, 3, "Press: 0  Hold: end");
}

/* Counts of one turn, to the nearest. */
enum { GM_WANTED_COUNTS = (GM_TURN_COUNTS + GM_TURN_COUNTS_DEN / 2) / GM_TURN_COUNTS_DEN };

/* What a wrong count means: a decoder of another mode, or 1000 lines taken for 1024. */
static const char *gm_verdict(int64_t counted) {
  const int64_t size = counted < 0 ? -counted : counted, wanted = GM_WANTED_COUNTS;
  if (100 * size >= 99 * wanted && 100 * size <= 101 * wanted) {
    return counted < 0 ? "OK, but backwards" : "OK within 1 %";
  }
  if (1000 * size >= 970 * wanted && 1000 * size <= 983 * wanted) {
    return "1000 lines, not 1024";
  }
  if (1000 * size >= 1017 * wanted && 1000 * size <= 1031 * wanted) {
    return "1024 lines, not 1000";
  }
  if (size * 4 >= wanted - wanted / 20 && size * 4 <= wanted + wanted / 20) {
    return "1/4: decoder mode?";
  }
  if (size * 2 >= wanted - wanted / 20 && size * 2 <= wanted + wanted / 20) {
    return "1/2: decoder mode?";
  }
  if (size >= 2 * wanted - wanted / 10 && size <= 2 * wanted + wanted / 10) {
    return "x2: decoder mode?";
  }
  if (size >= 4 * wanted - wanted / 5 && size <= 4 * wanted + wanted / 5) {
    return "x4: decoder mode?";
  }
  return "WRONG: wiring, lines";
}

static void gm_draw_test_hob(gm_ui *ui, const gm_status *status) {
  const int64_t counted = ui->test == GM_TEST_DONE ? ui->counted : status->edges[GM_HOB] - ui->counted;
  if (ui->test == GM_TEST_READY) {
    gm_line(ui, 0, gm_is_lathe() ? "Test spindle encoder" : "Test hob encoder");
    gm_line(ui, 1, "Press, turn it once");
    gm_line(ui, 2, "by hand, press again");
    gm_line(ui, 3, "Hold: menu");
    return;
  }
  gm_line(ui, 0, ui->test == GM_TEST_DONE ? gm_verdict(counted) : "Turn once by hand");
  gm_count(ui, 1, "Counted", counted, "");
  gm_count(ui, 2, "Wanted", GM_WANTED_COUNTS, "");
  gm_line(ui, 3, ui->test == GM_TEST_DONE ? "Press: again" : "Press: turned once");
}

static void gm_draw_test_table(gm_ui *ui) {
  gm_line(ui, 0, gm_is_lathe() ? "Mark the lead screw" : "Mark the table");
  gm_count(ui, 1, "Turn", gm_division_step(1, 1), "step");
  gm_line(ui, 2, ui->test == GM_TEST_DONE ? "Mark off? Check belt" : "Mark must come back");
  gm_answer(ui, "Turn it?");
}

static void gm_draw_fault(gm_ui *ui, const gm_status *status) {
  gm_line(ui, 0, "FAULT");
  gm_line(ui, 1, "Unknown");
  switch (status->fault) {
    case GM_ESTOP:
      gm_line(ui, 0, "EMERGENCY STOP");
      gm_line(ui, 1, "Release the button");
      break;
    case GM_LAG:
      gm_line(ui, 0, "FAULT table lags");
      gm_line(ui, 1, "Run the hob slower");
      break;
    case GM_OVERSPEED:
      gm_line(ui, 0, "FAULT hob too fast");
      gm_count(ui, 1, "Hob max", ui->phase ? (int64_t)ui->facts.max_rpm : (int64_t)GM_MAX_EDGE_RATE * 60 * GM_TURN_COUNTS_DEN / GM_TURN_COUNTS,
               "rpm");
      break;
    case GM_ENCODER:
      gm_line(ui, 0, "FAULT hob encoder");
      gm_count(ui, 1, "Cable? off by", status->index_error, "");
      break;
    case GM_HOB_MOVED:
      gm_line(ui, 0, "FAULT hob turned");
      gm_line(ui, 1, "Lock it for moves");
      break;
    case GM_ALARM:
      gm_line(ui, 0, "FAULT motor driver");
      gm_line(ui, 1, "See its own lamp");
      break;
    default: break;
  }
  gm_line(ui, 2, GM_HAS_HEALTHY ? "Hob was switched off" : "YOU MUST STOP HOB!");
  if (status->mode == GM_RUN) {
    gm_line(ui, 3, "Follows till it ends");
  } else {
    gm_line(ui, 3, ui->phase ? "Phase kept. Hold: on" : "Hold: acknowledge");
  }
}

static void gm_draw_edit(gm_ui *ui) {
  switch (ui->page) {
    case GM_PAGE_TEETH:
      gm_count(ui, 0, "Teeth", ui->edit.teeth, "");
      gm_draw_ratio(ui, 1);
      break;
    case GM_PAGE_HOB: gm_draw_hob(ui); break;
    case GM_PAGE_STARTS: gm_draw_starts(ui); break;
    case GM_PAGE_HELIX: gm_draw_helix(ui); break;
    case GM_PAGE_HELIX_FEED: gm_draw_helix_feed(ui); break;
    case GM_PAGE_PITCH_KIND: gm_draw_pitch_kind(ui); break;
    case GM_PAGE_PITCH: gm_draw_pitch(ui); break;
    case GM_PAGE_CLIMB:
      gm_line(ui, 0, ui->edit.climb ? "Climb cut" : "Conventional cut");
      gm_draw_ratio(ui, 1);
      break;
    default:
      gm_line(ui, 0, ui->edit.left ? "Left hand" : "Right hand");
      gm_draw_ratio(ui, 1);
      break;
  }
}

static void gm_draw_page(gm_ui *ui, const gm_status *status) {
  switch (ui->page) {
    case GM_PAGE_POWER_UP: gm_draw_power_up(ui); break;
    case GM_PAGE_START: gm_draw_start(ui); break;
    case GM_PAGE_RUN: gm_draw_run(ui, status); break;
    case GM_PAGE_STOP: gm_draw_stop(ui, status); break;
    case GM_PAGE_STOPPED: gm_draw_stopped(ui, status); break;
    case GM_PAGE_MENU: gm_draw_menu(ui); break;
    case GM_PAGE_JOG: gm_draw_jog(ui); break;
    case GM_PAGE_DIVIDE:
    case GM_PAGE_DIVIDE_GO: gm_draw_divide(ui); break;
    case GM_PAGE_READOUT: gm_draw_readout(ui, status); break;
    case GM_PAGE_TEST_HOB: gm_draw_test_hob(ui, status); break;
    case GM_PAGE_TEST_TABLE: gm_draw_test_table(ui); break;
    case GM_PAGE_FAULT: gm_draw_fault(ui, status); break;
    default: gm_draw_edit(ui); break;
  }
}

void gm_screen_draw(gm_ui *ui, const gm_status *status) {
  int row;
  for (row = 0; row < GM_ROWS; ++row) {
    gm_line(ui, row, "");
    ui->screen[row][GM_COLUMNS] = '\0';
  }
  gm_draw_page(ui, status);
  if (status->mode == GM_MOVE) {
    gm_line(ui, 3, "MOVES  Press: stop");
  } else if (ui->message != NULL) {
    gm_line(ui, 3, ui->message);
  }
}
