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
static uint32_t last_step_at;

static void watch() {
  const uint8_t step = (uint8_t)(stand_in.level[GM_PIN_STEP_OUT] != GM_STEP_ACTIVE_LOW);
  const uint8_t forward = (uint8_t)(stand_in.level[GM_PIN_DIR_OUT] != GM_DIR_ACTIVE_LOW);
  if (step && !step_before) {
    position += forward != GM_DIR_INVERT ? 1 : -1;
    last_step_at = stand_in.now_ms;
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
    if (stand_in.pended && !stand_in.masked) { /* of low priority: it follows the tick */
      stand_in.pended = 0;
      stand_in.software();
    }
  }
}

#if GM_HOB_COUNTER || GM_FEED_COUNTER
/* What the reference manuals say of the counters: FTM with QUADEN and, for pulse and direction, QUADMODE; ENC with PH1 and
 * REV. Every register that leads a pin there must have been set. */
struct phases {
  int a, b;
};
static phases at[2] = {{GM_DECODER_LS7184, 0}, {GM_DECODER_LS7184, 0}};

#ifdef GM_BOARD_TEENSY_32
static bool connected(uint8_t a, uint8_t b) {
  static const int pins[][4] = {{16, 17, 6, 1}, {3, 4, 7, 1}, {32, 25, 6, 2}}; /* A, B, multiplexer, FTM */
  const int unit = a == GM_PIN_ENCODER_STEP ? GM_HOB_COUNTER : GM_FEED_COUNTER;
  for (const auto &pair : pins) {
    if (pair[0] == a && pair[1] == b && pair[3] == unit) {
      return ((stand_in_pin_config[a] >> 8) & 7) == (unsigned)pair[2] && ((stand_in_pin_config[b] >> 8) & 7) == (unsigned)pair[2];
    }
  }
  return false;
}
static void count(uint8_t a, phases was, phases now) {
  const bool first = (a == GM_PIN_ENCODER_STEP ? GM_HOB_COUNTER : GM_FEED_COUNTER) == 1;
  const uint32_t control = first ? FTM1_QDCTRL : FTM2_QDCTRL;
  volatile uint32_t &counter = first ? FTM1_CNT : FTM2_CNT;
  if (!(control & 1) || (first ? FTM1_MOD : FTM2_MOD) != 0xFFFF || !((first ? FTM1_MODE : FTM2_MODE) & 1)) {
    return;
  }
#else
static int input_of(uint8_t pin) {
  static const struct { /* pin, multiplexer, input of the crossbar, its pad and where that is chosen */
    uint8_t pin;
    uint32_t mux;
    int input;
    uint32_t daisy;
    volatile uint32_t *chosen;
  } pads[] = {{0, 1, 17, 1, &IOMUXC_XBAR1_IN17_SELECT_INPUT},  {2, 3, 6, 0, &IOMUXC_XBAR1_IN06_SELECT_INPUT},
              {3, 3, 7, 0, &IOMUXC_XBAR1_IN07_SELECT_INPUT},   {4, 3, 8, 0, &IOMUXC_XBAR1_IN08_SELECT_INPUT},
              {5, 3, 17, 0, &IOMUXC_XBAR1_IN17_SELECT_INPUT},  {7, 1, 15, 1, &IOMUXC_XBAR1_IN15_SELECT_INPUT},
              {8, 1, 14, 1, &IOMUXC_XBAR1_IN14_SELECT_INPUT},  {30, 1, 23, 0, &IOMUXC_XBAR1_IN23_SELECT_INPUT},
              {31, 1, 22, 0, &IOMUXC_XBAR1_IN22_SELECT_INPUT}, {33, 3, 9, 0, &IOMUXC_XBAR1_IN09_SELECT_INPUT}};
  for (const auto &pad : pads) {
    if (pad.pin == pin && stand_in_pin_config[pin] == pad.mux && *pad.chosen == pad.daisy) {
      return pad.input;
    }
  }
  return -1;
}
static bool connected(uint8_t a, uint8_t b) {
  const bool hob = a == GM_PIN_ENCODER_STEP;
  const uint16_t chosen = stand_in_crossbar[hob ? 33 : 38];
  const uint32_t clock = hob ? 3u << 24 : 3u << 28;
  return (CCM_CCGR2 & 3u << 22) == 3u << 22 && (CCM_CCGR4 & clock) == clock && input_of(a) == (chosen & 0xFF) &&
         input_of(b) == chosen >> 8;
}
static void count(uint8_t a, phases was, phases now) {
  const bool hob = a == GM_PIN_ENCODER_STEP;
  const uint16_t control = hob ? ENC1_CTRL : ENC3_CTRL;
  volatile uint16_t &counter = hob ? ENC1_LPOS : ENC3_LPOS;
#endif
#ifdef GM_BOARD_TEENSY_32
  const bool pulses = control & 8, up = now.b;
#else
  const bool pulses = control & 0x200, up = (control & 0x400 ? 1 : 0) == now.b;
#endif
  int moved = 0;
  if (pulses) {
    moved = !was.a && now.a ? (up ? 1 : -1) : 0;
  } else if (was.a != now.a) { /* A leads B while it counts up */
    moved = now.a != now.b ? 1 : -1;
  } else if (was.b != now.b) {
    moved = now.a == now.b ? 1 : -1;
  }
  counter = (uint16_t)(counter + moved);
}

static void counted_edge(uint8_t a, uint8_t b, int forward) {
  phases &state = at[a == GM_PIN_ENCODER_STEP ? 0 : 1];
  if (!connected(a, b)) {
    return;
  }
  if (GM_DECODER_LS7184) { /* CLK is low during its pulse */
    const phases pulse[] = {{0, forward}, {1, forward}};
    for (const phases &next : pulse) {
      count(a, state, next);
      state = next;
    }
    return;
  }
  const phases next = (state.a == state.b) == (forward != 0) ? phases{!state.a, state.b} : phases{state.a, !state.b};
  count(a, state, next);
  state = next;
}
#endif

static void edges(uint8_t pulse, uint8_t direction, long n, int forward, long ticks_between) {
  for (; n > 0; --n) {
#if GM_HOB_COUNTER || GM_FEED_COUNTER
    if ((pulse == GM_PIN_ENCODER_STEP ? GM_HOB_COUNTER : GM_FEED_COUNTER) > 0) {
      counted_edge(pulse, direction, forward);
      ticks(ticks_between);
      continue;
    }
#endif
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

static uint32_t press_at = UINT32_MAX;
static long hob_every = 0; /* ticks from edge to edge of a hob that turns by itself */

static void one_ms() {
  ++stand_in.now_ms;
  if (stand_in.now_ms == press_at) {
    stand_in.level[GM_PIN_BUTTON] = LOW;
  } else if (stand_in.now_ms == press_at + 60) {
    stand_in.level[GM_PIN_BUTTON] = HIGH;
  }
  if (hob_every == 0) {
    ticks(TICKS_A_MS);
    return;
  }
  edges(GM_PIN_ENCODER_STEP, GM_PIN_ENCODER_DIR, TICKS_A_MS / hob_every, 1, hob_every);
}

/* Every call to the display takes 600 ms: a Teensy 4 gives a transmission 50 ms, and a letter has twelve. */
static void stuck() {
  for (int ms = 0; ms < 600; ++ms) {
    one_ms();
  }
}

extern "C" {
void board_pass(long ms);
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

void board_bus(int is_stuck) { stand_in.bus_waits = is_stuck ? stuck : nullptr; }
void board_display_off(int off) { stand_in.display_off = off; }
void board_garbage() {
  for (int k = 0; k < 80; ++k) {
    stand_in.lcd[k] = (char)(33 + k % 90);
  }
}
void board_turn_hob(long every) { hob_every = every; }
/* Presses the button after so many ms; how long after it the last step came, when `ms` have passed. */
long board_press_and_count(long after, long ms) {
  press_at = stand_in.now_ms + (uint32_t)after;
  board_pass(1);
  while (stand_in.now_ms < press_at + (uint32_t)ms) {
    board_pass(1);
  }
  return (long)(last_step_at - press_at);
}
/* Whether the watchdog was refreshed since the last call. */
int board_refreshed() {
#ifdef GM_BOARD_TEENSY_32
  const bool seen = WDOG_REFRESH == 0xB480;
  WDOG_REFRESH = 0;
#else
  const bool seen = WDOG1_WSR == 0xAAAA;
  WDOG1_WSR = 0;
#endif
  return seen;
}
int board_brown_out() {
#ifdef GM_BOARD_TEENSY_32
  return PMC_LVDSC1;
#else
  return -1;
#endif
}
int board_watchdog_ms() {
#ifdef GM_BOARD_TEENSY_32
  return WDOG_STCTRLH & 1 ? WDOG_TOVALL : 0; /* STCTRLH bit 0 turns it on, bit 1 would take another clock than 1 kHz */
#else
  return WDOG1_WCR & 4 ? 500 * (1 + (WDOG1_WCR >> 8)) : 0; /* WDE, and WT in half seconds */
#endif
}
/* Time passes without one of its parts: 1 the step timer, 2 the operator's interrupt, 3 loop(). */
void board_hang(int what, long ms) {
  for (; ms > 0; --ms) {
    ++stand_in.now_ms;
    if (what != 1) {
      stand_in.pended = what == 2 ? 0 : stand_in.pended;
      void (*const software)(void) = stand_in.software;
      for (int k = 0; k < TICKS_A_MS; ++k) {
        stand_in.tick();
        watch();
        if (stand_in.pended && what != 2) {
          stand_in.pended = 0;
          software();
        }
      }
    }
    if (what != 3) {
      loop();
    }
  }
}
int board_starts() { return stand_in.lcd_starts; }

void board_pass(long ms) {
  for (; ms > 0; --ms) {
    one_ms();
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
int board_priority(int of) {
  return of == 2 ? stand_in.priority_of_software : of ? stand_in.priority_of_timer : stand_in.priority_of_pins;
}
void board_button(int held) { stand_in.level[GM_PIN_BUTTON] = held ? LOW : HIGH; }
long board_tick_us() { return (long)stand_in.tick_us; }
void board_eeprom(uint8_t *copy) {
  for (int k = 0; k < 4284; ++k) {
    copy[k] = stand_in.eeprom[k];
  }
}
int board_eeprom_log(int k, int value) { return stand_in.eeprom_log[k][value]; }
void board_display(char *text) {
  for (int k = 0; k < 80; ++k) {
    text[k] = stand_in.lcd[k];
  }
}
}
