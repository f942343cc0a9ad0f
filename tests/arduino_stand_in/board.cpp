/* The board in the hands of a test: time passes, somebody turns the knob and presses the button, the hob turns.
 *
 * Every tick the levels of STEP and DIR are looked at from outside, as a driver would, and pulses are counted.
 */
#include "gm_machine.h"
#include "stand_in.h"

enum { TICKS_A_MS = 1000000 / GM_TICK_NS };

static uint8_t step_before;
static long position; /* pulses, by their direction */
static long bad_pulses;
static uint32_t high_ticks;

static void watch() {
  const uint8_t step = (uint8_t)(stand_in.level[GM_PIN_STEP_OUT] != GM_STEP_ACTIVE_LOW);
  const uint8_t forward = (uint8_t)(stand_in.level[GM_PIN_DIR_OUT] != GM_DIR_ACTIVE_LOW);
  if (step && !step_before) {
    position += forward != GM_DIR_INVERT ? 1 : -1;
    high_ticks = 0;
  }
  high_ticks += step;
  if (!step && step_before && high_ticks != GM_STEP_HIGH_TICKS) {
    ++bad_pulses;
  }
  step_before = step;
}

static void ticks(long n) {
  for (; n > 0; --n) {
    if (stand_in.masked) { /* an interrupt has to wait; here it would be lost */
      ++bad_pulses;
    }
    stand_in.tick();
    watch();
  }
}

static void edges(uint8_t pulse, uint8_t direction, long n, int forward, long ticks_between) {
  for (; n > 0; --n) {
    if (GM_DECODER_LS7184) {
      stand_in.level[direction] = (uint8_t)forward;
      if (stand_in.edge[pulse] == RISING) { /* CLK is low during the pulse */
        stand_in.handler[pulse]();
      }
    } else {
      stand_in.count[pulse] += forward ? 1 : -1;
    }
    ticks(ticks_between);
  }
}

extern "C" {
void board_power_up(const uint8_t *eeprom, long size) {
  for (long k = 0; k < 4284; ++k) {
    stand_in.eeprom[k] = k < size ? eeprom[k] : 0xff;
  }
#if GM_HAS_ESTOP
  stand_in.level[GM_PIN_ESTOP] = LOW; /* its contact is closed */
#endif
  stand_in.level[GM_PIN_BUTTON] = HIGH;
  setup();
  step_before = (uint8_t)(stand_in.level[GM_PIN_STEP_OUT] != GM_STEP_ACTIVE_LOW);
}

void board_pass(long ms) {
  for (; ms > 0; --ms) {
    ++stand_in.now_ms;
    ticks(TICKS_A_MS);
    loop();
  }
}

void board_press(long ms) {
  stand_in.level[GM_PIN_BUTTON] = LOW;
  board_pass(ms);
  stand_in.level[GM_PIN_BUTTON] = HIGH;
  board_pass(400); /* and the display is written */
}

void board_knob(int detents) {
  const int way = detents < 0 ? -1 : 1;
  for (; detents != 0; detents -= way) {
    for (int k = 0; k < 4; ++k) {
      stand_in.count[GM_PIN_KNOB_A] += way;
      board_pass(25);
    }
  }
  board_pass(400);
}

void board_hob(long n, int forward, long ticks_between) {
  edges(GM_PIN_ENCODER_STEP, GM_PIN_ENCODER_DIR, n, forward, ticks_between);
}

#if GM_HAS_FEED
void board_feed(long n, int forward, long ticks_between) {
  edges(GM_PIN_FEED_STEP, GM_PIN_FEED_DIR, n, forward, ticks_between);
}
#endif
#if GM_HAS_INDEX
void board_index() { stand_in.handler[GM_PIN_INDEX](); }
#endif
#if GM_HAS_ESTOP
void board_estop(int open) { stand_in.level[GM_PIN_ESTOP] = (uint8_t)open; }
#endif

long board_position() { return position; }
long board_bad_pulses() { return bad_pulses; }
int board_level(int pin) { return stand_in.level[pin]; }
int board_mode(int pin) { return stand_in.mode[pin]; }
int board_writes() { return stand_in.lcd_writes; }
int board_eeprom_writes() { return stand_in.eeprom_writes; }
int board_priority(int of_timer) { return of_timer ? stand_in.priority_of_timer : stand_in.priority_of_pins; }
long board_tick_us() { return (long)stand_in.tick_us; }
void board_eeprom(uint8_t *copy) {
  for (int k = 0; k < 4284; ++k) {
    copy[k] = stand_in.eeprom[k];
  }
}
void board_display(char *text) {
  for (int k = 0; k < 80; ++k) {
    text[k] = stand_in.lcd[k];
  }
}
}
