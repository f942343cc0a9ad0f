/* gm_ui.h: what the operator sees and does: a display of 4 lines of 20 characters, a knob, and its button.
 *
 * The job on the screens (edit) is apart from the job that runs: it goes to the core only through the page that asks
 * "Start?", which answers "no" until the knob is turned to "yes". The table never moves but by
 *   "Start?" yes, "run on" (after a stop), "back to start" and "next start" (lathe), a knob turn on the armed jog page, a
 *   press on "Press: go" (dividing) or "Turn the table?" yes. A press during a move stops it.
 * Play. Where GM_BACKLASH_STEPS are given, dividing and "back to start" come to their place forwards, and "run on" after a
 * motion backwards first goes back and forth by so many steps, so that the play is on the same side as in the cut.
 * While running, the knob turns pages and a press asks "Stop?". Faults take the screen whatever it shows. A message
 * takes the last line; the next press only takes the message away, since it may hide an answer.
 *
 * The main program calls gm_ui_event for every detent and press, and about ten times a second with GM_UI_POLL. It gives
 * void gm_mask(void) and void gm_unmask(void), which keep the core's interrupts away; gm_ui holds them for single
 * calls of the core only.
 */
#ifndef GM_UI_H
#define GM_UI_H

#include "gm_job.h"

#ifdef __cplusplus
extern "C" {
#endif

enum { GM_ROWS = 4, GM_COLUMNS = 20 };

/* Events. A long press is one of a second or more. */
enum { GM_UI_POLL = 0, GM_UI_KNOB_UP = 1, GM_UI_KNOB_DOWN = 2, GM_UI_SHORT = 3, GM_UI_LONG = 4 };

/* What gm_ui_event asks of the main program. */
enum { GM_UI_SAVE = 1 }; /* write ui->edit to the EEPROM (gm_store_save) */

typedef enum {
  GM_PAGE_POWER_UP = 0,
  GM_PAGE_TEETH,
  GM_PAGE_HOB,
  GM_PAGE_STARTS,
  GM_PAGE_HELIX,
  GM_PAGE_HELIX_FEED,
  GM_PAGE_CLIMB,
  GM_PAGE_PITCH_KIND,
  GM_PAGE_PITCH,
  GM_PAGE_HAND,
  GM_PAGE_START,
  GM_PAGE_RUN,
  GM_PAGE_STOP,
  GM_PAGE_STOPPED,
  GM_PAGE_MENU,
  GM_PAGE_JOG,
  GM_PAGE_DIVIDE,
  GM_PAGE_DIVIDE_GO,
  GM_PAGE_READOUT,
  GM_PAGE_TEST_HOB,
  GM_PAGE_TEST_TABLE,
  GM_PAGE_FAULT,
  GM_PAGES
} gm_page;

/* Entries of the pages that choose. */
enum { GM_MENU_JOB = 0, GM_MENU_JOG, GM_MENU_TEST_HOB, GM_MENU_TEST_TABLE, GM_MENU_DIVIDE, GM_MENU_ENTRIES };
enum { GM_STOPPED_WAIT = 0, GM_STOPPED_RUN_ON, GM_STOPPED_JOG, GM_STOPPED_NEW, GM_STOPPED_GEAR_ENTRIES,
       GM_STOPPED_SHOULDER = GM_STOPPED_GEAR_ENTRIES, GM_STOPPED_BACK, GM_STOPPED_NEXT, GM_STOPPED_ENTRIES };
enum { GM_START_NO = 0, GM_START_YES, GM_START_SET, GM_START_ANSWERS };
enum { GM_JOG_SIZES = 4, GM_THREAD_VIEWS = 3, GM_GEAR_VIEWS = 4, GM_MAX_DIVISIONS = 9999, GM_MAX_JOGS = 1000000 };
enum { GM_ARMED_MS = 60000, GM_WATCH_MS = 150 };
enum { GM_TEST_READY = 0, GM_TEST_COUNTING, GM_TEST_DONE };

typedef struct {
  gm_core *core;
  gm_settings edit;   /* what the pages show and change */
  gm_settings loaded; /* what the core holds, where phase is set */
  gm_ratio loaded_ratio;
  gm_page page;
  int choice;          /* entry, view, answer (1 = yes), or size of the page */
  int restored;        /* edit comes from the EEPROM */
  int phase;           /* the core holds a job and its phase */
  const char *message; /* shown in the last line until the next knob or press, or NULL */
  int hob;             /* number in gm_hobs */
  int armed;           /* jog: the knob moves the table */
  uint32_t armed_at;
  int32_t jog;      /* armed jog: units of the size from where it was armed */
  int64_t jog_done; /* motor steps given for them */
  int32_t divisions;
  int32_t target; /* division to go to */
  int32_t then;   /* motor steps of a second move, forward, that takes up the play */
  int then_run;   /* and after it the run goes on */
  int32_t at;     /* division where the table stands, counted on beyond a turn */
  int test;
  int64_t pass_from; /* gear: motor steps at the beginning of this pass, */
  int64_t pass;      /* and what the last one of this job took, 0 where there was none */
  int64_t counted; /* edges at the start of the test, then in it */
  int shifting;    /* lathe: the carriage moves to the next start */
  int32_t thread;  /* number of the start that is cut */
  uint32_t knob_at;
  uint32_t watched_at; /* hob: counts at that time, and whether it turned before */
  int64_t watched;
  int turning;
  int knob_event;
  gm_refusal refusal;
  gm_job job;
  gm_facts facts;
  char screen[GM_ROWS][GM_COLUMNS + 1];
} gm_ui;

/* restored: the parameters from the EEPROM, or NULL. The phase is lost either way. */
void gm_ui_init(gm_ui *ui, gm_core *core, const gm_settings *restored, const gm_status *status);
/* One event at the time now [ms], which may run over, with a fresh status. The requests; ui->screen is then new. */
unsigned gm_ui_event(gm_ui *ui, int event, const gm_status *status, uint32_t now);

/* Given by the main program. */
void gm_mask(void);
void gm_unmask(void);

/* The rest is shared by gm_ui.c, gm_screen.c and gm_edit.c only. */

/* gm_screen.c: draws the page. */
void gm_screen_draw(gm_ui *ui, const gm_status *status);
/* gm_edit.c: the knob on the pages that change the job, and the order of these pages. */
void gm_edit_defaults(gm_ui *ui);
int gm_edit_restore(gm_ui *ui, const gm_settings *restored); /* -1 where its hob is not of this machine */
void gm_edit_turn(gm_ui *ui, int32_t direction, int32_t factor);
gm_page gm_edit_first(void);
gm_page gm_edit_next(const gm_ui *ui);
gm_page gm_edit_before(const gm_ui *ui);
int gm_is_lathe(void);
int gm_stopped_entries(const gm_ui *ui);

#ifdef __cplusplus
}
#endif

#endif
