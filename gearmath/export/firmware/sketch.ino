/* The board around the electronic gearbox: pins, interrupts, knob, display, EEPROM. What is computed is in the other
 * files, which know no Arduino; what is wired is in gm_machine.h. Do not edit: change the machine file, export again.
 *
 * Interrupts. The pulses of hob and feed, the hob's index pulse and the step timer all run at PRIORITY: the processor
 * finishes one before it begins the next, so that none sees the gearbox half changed, and no slower interrupt (USB,
 * I2C) delays them. None of them waits for anything. loop() shuts them out for single calls of a few microseconds
 * (gm_mask, gm_unmask). Knob, button and pages run in a software interrupt of low priority every OPERATOR_MS, which the
 * step timer asks for: a display that does not answer, or an EEPROM that is being written, delays neither a press on Stop
 * nor the fail-safe output. loop() writes to display and EEPROM, and refreshes the watchdog of the processor, which
 * resets it, all outputs off, WATCHDOG_MS after the step timer, the operator's interrupt or loop() have come to a halt.
 *
 * Display. It is asked once a second whether it answers. Where it did not, or where the button is held while the knob is
 * turned, it is begun anew and written from the start; nothing else notices.
 *
 * Encoders. An LS7184 pulls CLK low for one output pulse per count; its UP/DN holds until the next one. So the end of
 * the pulse, the rising edge, is where the direction is read. A counter of the board (gm_counter.h) counts channels A and
 * B, or those pulses, by itself. Otherwise the pin interrupts do: for channels A and B with the library Encoder, all four
 * edges of a line. What was counted elsewhere is taken by the step timer, at most a few edges, which it passes on one by
 * one, behind its outputs so that these are never late.
 */
#include <Arduino.h>
#include <EEPROM.h>
#include <Encoder.h>
#include <Wire.h>

#include "gm_core.h"
#include "gm_counter.h"
#include "gm_store.h"
#include "gm_ui.h"

#ifdef GM_DISPLAY_ADAFRUIT292
#include <Adafruit_LiquidCrystal.h>
#else
#include <LiquidCrystal_I2C.h>
#endif

#if defined(GM_BOARD_TEENSY_32) && !defined(__MK20DX256__)
#error "this machine has a Teensy 3.2: choose it under Tools, Board"
#elif defined(GM_BOARD_TEENSY_40) && !defined(ARDUINO_TEENSY40)
#error "this machine has a Teensy 4.0: choose it under Tools, Board"
#elif defined(GM_BOARD_TEENSY_41) && !defined(ARDUINO_TEENSY41)
#error "this machine has a Teensy 4.1: choose it under Tools, Board"
#endif

enum {
  PRIORITY = 16,           /* above everything of the core library; 0 is left to the processor's faults */
  COUNTS_A_DETENT = 4,     /* of the knob */
  OPERATOR_PRIORITY = 208, /* below everything but loop() */
  OPERATOR_MS = 5,
  WATCHDOG_MS = 500,       /* 1000 on a Teensy 4, whose watchdog counts half seconds */
  LOOP_MS = 8000,          /* loop() may wait for a display that does not answer, but not so long */
  SLOW_MS = 20,            /* a letter takes 3 ms */
  DISPLAY_MS = 1000,       /* from one question to the display to the next */
  POLL_MS = 100,           /* fresh numbers on the display */
  BOUNCE_MS = 20,          /* a contact that has been quiet so long is believed */
  LONG_PRESS_MS = 1000
};

static gm_core core;
static gm_ui ui;
static uint8_t stored[GM_STORE_BYTES]; /* copy of the EEPROM's first bytes */
static IntervalTimer step_timer;
static Encoder knob(GM_PIN_KNOB_A, GM_PIN_KNOB_B);

void gm_mask(void) { noInterrupts(); }
void gm_unmask(void) { interrupts(); }

/* --- display: one character of difference at a time, so that loop() never waits long for I2C --- */
#ifdef GM_DISPLAY_ADAFRUIT292
static Adafruit_LiquidCrystal lcd(GM_DISPLAY_ADDRESS);
static bool lcd_begin() {
  const bool begun = lcd.begin(GM_COLUMNS, GM_ROWS);
  lcd.setBacklight(HIGH);
  Wire.setClock(400000); /* the MCP23008 takes it; a PCF8574 only the 100000 of the start */
  return begun;
}
#else
static LiquidCrystal_I2C lcd(GM_DISPLAY_ADDRESS, GM_COLUMNS, GM_ROWS);
static bool lcd_begin() {
  lcd.init();
  lcd.backlight();
  return true;
}
#endif

static char shown[GM_ROWS * GM_COLUMNS];
static int cursor; /* place behind the character written last */
static bool display_on = false;
static volatile bool display_anew = false;
static uint32_t display_asked_at = 0;

static bool display_answers() {
  Wire.beginTransmission((uint8_t)GM_DISPLAY_ADDRESS);
  return Wire.endTransmission() == 0;
}

static void begin_display() {
  display_anew = false;
  display_on = display_answers() && lcd_begin();
  for (int k = 0; k < GM_ROWS * GM_COLUMNS; ++k) {
    shown[k] = ' '; /* what the display shows after its start */
  }
  cursor = 0;
}

static void watch_display() {
  if (display_anew || millis() - display_asked_at >= (uint32_t)DISPLAY_MS) {
    display_asked_at = millis();
    if (display_anew || !display_on) {
      begin_display();
    } else {
      display_on = display_answers();
    }
  }
}

static void show() {
  if (!display_on) {
    return;
  }
  for (int k = 0; k < GM_ROWS * GM_COLUMNS; ++k) {
    const int place = (cursor + k) % (GM_ROWS * GM_COLUMNS);
    const int row = place / GM_COLUMNS, column = place % GM_COLUMNS;
    const char letter = ui.screen[row][column];
    if (letter != shown[place]) {
      const uint32_t began_at = millis();
      if (k != 0 || column == 0) {
        lcd.setCursor((uint8_t)column, (uint8_t)row);
      }
      lcd.write((uint8_t)letter);
      if (millis() - began_at >= (uint32_t)SLOW_MS) { /* the bus was stuck: nobody knows what arrived */
        display_on = false;
        return;
      }
      shown[place] = letter;
      cursor = (place + 1) % (GM_ROWS * GM_COLUMNS);
      return;
    }
  }
}

/* --- interrupts --- */
/* Feed edges count up where the table has to turn further on: in conventional cutting. */
enum { HOB_UP = GM_ENCODER_INVERT ? -1 : 1 };
#if GM_HAS_FEED
enum { FEED_UP = GM_FEED_CLIMBS ? -1 : 1 };
#endif

#if GM_HOB_COUNTER || !GM_DECODER_LS7184
static void pass_edges(int32_t moved, int axis, int up) {
  for (; moved > 0; --moved) {
    gm_core_edge(&core, axis, up);
  }
  for (; moved < 0; ++moved) {
    gm_core_edge(&core, axis, -up);
  }
}
#endif

#if GM_HOB_COUNTER
static uint16_t hob_seen;

static void follow_hob() {
  const uint16_t count = GM_COUNTER_READ(HOB);
  int32_t moved;
  gm_counter_motion(hob_seen, count, &moved);
  hob_seen = count;
  pass_edges(moved, GM_HOB, HOB_UP);
}

static void begin_hob() { GM_COUNTER_BEGIN(HOB, GM_PIN_ENCODER_STEP, GM_PIN_ENCODER_DIR); }
#elif GM_DECODER_LS7184
static void on_hob_pulse() { gm_core_edge(&core, GM_HOB, digitalReadFast(GM_PIN_ENCODER_DIR) == HIGH ? HOB_UP : -HOB_UP); }
static void follow_hob() {}

static void begin_hob() {
  pinMode(GM_PIN_ENCODER_STEP, INPUT_PULLUP); /* a broken wire is quiet and counts nothing */
  pinMode(GM_PIN_ENCODER_DIR, INPUT_PULLUP);
  attachInterrupt(digitalPinToInterrupt(GM_PIN_ENCODER_STEP), on_hob_pulse, RISING);
}
#else
static Encoder hob_encoder(GM_PIN_ENCODER_STEP, GM_PIN_ENCODER_DIR);
static uint32_t hob_seen;

static void follow_hob() {
  const uint32_t count = (uint32_t)hob_encoder.read();
  pass_edges((int32_t)(count - hob_seen), GM_HOB, HOB_UP);
  hob_seen = count;
}

static void begin_hob() { hob_seen = (uint32_t)hob_encoder.read(); } /* what was counted before is no motion of a job */
#endif

#if GM_HAS_FEED && GM_FEED_COUNTER
static uint16_t feed_seen;

static void follow_feed() {
  const uint16_t count = GM_COUNTER_READ(FEED);
  int32_t moved;
  gm_counter_motion(feed_seen, count, &moved);
  feed_seen = count;
  pass_edges(moved, GM_FEED, FEED_UP);
}

static void begin_feed() { GM_COUNTER_BEGIN(FEED, GM_PIN_FEED_STEP, GM_PIN_FEED_DIR); }
#elif GM_HAS_FEED && GM_DECODER_LS7184
static void on_feed_pulse() { gm_core_edge(&core, GM_FEED, digitalReadFast(GM_PIN_FEED_DIR) == HIGH ? FEED_UP : -FEED_UP); }
static void follow_feed() {}

static void begin_feed() {
  pinMode(GM_PIN_FEED_STEP, INPUT_PULLUP);
  pinMode(GM_PIN_FEED_DIR, INPUT_PULLUP);
  attachInterrupt(digitalPinToInterrupt(GM_PIN_FEED_STEP), on_feed_pulse, RISING);
}
#elif GM_HAS_FEED
static Encoder feed_encoder(GM_PIN_FEED_STEP, GM_PIN_FEED_DIR);
static uint32_t feed_seen;

static void follow_feed() {
  const uint32_t count = (uint32_t)feed_encoder.read();
  pass_edges((int32_t)(count - feed_seen), GM_FEED, FEED_UP);
  feed_seen = count;
}

static void begin_feed() { feed_seen = (uint32_t)feed_encoder.read(); }
#else
static void follow_feed() {}
static void begin_feed() {}
#endif

#if GM_HAS_INDEX
static void on_index() {
  follow_hob(); /* the edges before the index pulse belong before it */
  gm_core_index(&core);
}
#endif

static void put_outputs(unsigned levels) {
  digitalWriteFast(GM_PIN_DIR_OUT, levels & GM_OUT_DIR ? HIGH : LOW);
#if GM_HAS_ENABLE
  digitalWriteFast(GM_PIN_ENABLE, levels & GM_OUT_ENABLE ? HIGH : LOW);
#endif
#if GM_HAS_HEALTHY
  digitalWriteFast(GM_PIN_HEALTHY, levels & GM_OUT_HEALTHY ? HIGH : LOW);
#endif
#if GM_HAS_RESET
  digitalWriteFast(GM_PIN_RESET, levels & GM_OUT_RESET ? HIGH : LOW);
#endif
  digitalWriteFast(GM_PIN_STEP_OUT, levels & GM_OUT_STEP ? HIGH : LOW);
}

static unsigned inputs() {
  unsigned levels = 0;
#if GM_HAS_ESTOP /* a closed contact pulls the pin down; a broken wire stops */
  if (digitalReadFast(GM_PIN_ESTOP) == LOW) {
    levels |= (unsigned)GM_IN_ESTOP_OK;
  }
#else
  levels |= (unsigned)GM_IN_ESTOP_OK;
#endif
#if GM_HAS_ALARM
  if (digitalReadFast(GM_PIN_ALARM) == (GM_ALARM_ACTIVE_LOW ? LOW : HIGH)) {
    levels |= (unsigned)GM_IN_ALARM;
  }
#endif
  return levels;
}

static volatile uint32_t ticks = 0;

static void on_tick() {
  static uint32_t wait = 0;
  put_outputs(gm_core_outputs(&core, inputs()));
  follow_hob();
  follow_feed();
  gm_core_think(&core);
  ++ticks;
  if (++wait == (uint32_t)OPERATOR_MS * 1000000u / GM_TICK_NS) {
    wait = 0;
    NVIC_SET_PENDING(IRQ_SOFTWARE);
  }
}

static void set_priorities() {
#ifdef GM_BOARD_TEENSY_32
  NVIC_SET_PRIORITY(IRQ_PORTA, PRIORITY);
  NVIC_SET_PRIORITY(IRQ_PORTB, PRIORITY);
  NVIC_SET_PRIORITY(IRQ_PORTC, PRIORITY);
  NVIC_SET_PRIORITY(IRQ_PORTD, PRIORITY);
  NVIC_SET_PRIORITY(IRQ_PORTE, PRIORITY);
#else
  NVIC_SET_PRIORITY(IRQ_GPIO6789, PRIORITY);
#endif
  step_timer.priority(PRIORITY);
}

/* --- the watchdog of the processor --- */
static volatile uint32_t looped_at = 0;

static void begin_watchdog() {
#ifdef GM_BOARD_TEENSY_32 /* the core library leaves it off, and open for changes; its clock is that of 1 kHz */
  noInterrupts();
  WDOG_UNLOCK = 0xC520;
  WDOG_UNLOCK = 0xD928;
  __asm__ volatile("nop");
  __asm__ volatile("nop");
  WDOG_TOVALH = 0;
  WDOG_TOVALL = WATCHDOG_MS;
  WDOG_PRESC = 0;
  WDOG_STCTRLH = 0x01D1; /* on, also in wait and stop; open for changes */
  interrupts();
#else
  CCM_CCGR3 |= CCM_CCGR3_WDOG1(CCM_CCGR_ON);
  WDOG1_WMCR = 0;
  WDOG1_WCR = 1 << 8 | 0x0034; /* 1 s; on, and neither a reset by software nor the pin asked for */
#endif
}

static void refresh_watchdog() {
  noInterrupts();
#ifdef GM_BOARD_TEENSY_32
  WDOG_REFRESH = 0xA602;
  WDOG_REFRESH = 0xB480;
#else
  WDOG1_WSR = 0x5555;
  WDOG1_WSR = 0xAAAA;
#endif
  interrupts();
}

/* Called by the operator's interrupt, which the step timer asks for; that loop() works is seen by its time. */
static void watch_over() {
  static uint32_t seen = 0;
  if (ticks != seen && millis() - looped_at < (uint32_t)LOOP_MS) {
    seen = ticks;
    refresh_watchdog();
  }
}

/* --- operator --- */
static volatile bool to_save = false;

static void look(gm_status *status) {
  gm_mask();
  gm_core_status(&core, status);
  gm_unmask();
}

static void send(int event) {
  gm_status status;
  look(&status);
  if (gm_ui_event(&ui, event, &status, millis()) & GM_UI_SAVE) {
    to_save = true;
  }
}

/* A write may shut out interrupts for milliseconds (the flash of a Teensy 4): only while hob and motor stand. */
static void save() {
  gm_status status;
  gm_settings settings;
  look(&status);
  if (status.mode == GM_MOVE || status.pending != 0 || status.edge_rate != 0) {
    return;
  }
  gm_mask();
  to_save = false;
  settings = ui.loaded; /* the job that was confirmed, not the one on the screen */
  gm_unmask();
  const int slot = gm_store_save(stored, &settings);
  if (slot >= 0) {
    for (int k = slot * GM_RECORD_BYTES; k < (slot + 1) * GM_RECORD_BYTES; ++k) {
      EEPROM.update(k, stored[k]);
    }
  }
}

/* The button: whether it is held, and whether that has been told (as a long press, or by turning the knob meanwhile). */
static bool button_down = false, button_told = false;

static void knob_turned(int event) {
  if (!button_down) {
    send(event);
  } else if (!button_told) {
    button_told = true;
    display_anew = true;
  }
}

static void read_knob() {
  static int32_t passed = 0;
  const int32_t count = knob.read();
  if (count - passed >= COUNTS_A_DETENT) {
    passed += COUNTS_A_DETENT;
    knob_turned(GM_UI_KNOB_UP);
  } else if (passed - count >= COUNTS_A_DETENT) {
    passed -= COUNTS_A_DETENT;
    knob_turned(GM_UI_KNOB_DOWN);
  }
}

/* A press that stops the motor does so at once, not when the button is let go. */
static bool press_stops() {
  gm_status status;
  look(&status);
  return status.mode == GM_MOVE || (ui.page == GM_PAGE_STOP && ui.choice != 0);
}

/* A long press tells while it is held, a short one when it is let go. */
static void read_button() {
  static bool last = false;
  static uint32_t changed_at = 0, down_at = 0;
  const bool closed = digitalReadFast(GM_PIN_BUTTON) == LOW;
  const uint32_t now = millis();
  if (closed != last) {
    last = closed;
    changed_at = now;
  }
  if (closed != button_down && now - changed_at >= (uint32_t)BOUNCE_MS) {
    button_down = closed;
    if (button_down) {
      down_at = now;
      button_told = press_stops();
      if (button_told) {
        send(GM_UI_SHORT);
      }
    } else if (!button_told) {
      send(GM_UI_SHORT);
    }
  }
  if (button_down && !button_told && now - down_at >= (uint32_t)LONG_PRESS_MS) {
    button_told = true;
    send(GM_UI_LONG);
  }
}

static void on_operator() {
  static uint32_t polled_at = 0;
  gm_mask();
  gm_core_alive(&core);
  gm_unmask();
  read_knob();
  read_button();
  if (millis() - polled_at >= (uint32_t)POLL_MS) {
    polled_at = millis();
    send(GM_UI_POLL);
  }
  watch_over();
}

static void begin_operator() {
  gm_settings settings;
  gm_status status;
  uint32_t sequence;
  for (int k = 0; k < GM_STORE_BYTES; ++k) {
    stored[k] = EEPROM.read(k);
  }
  const bool restored = gm_store_load(stored, &settings, &sequence) >= 0;
  look(&status);
  gm_ui_init(&ui, &core, restored ? &settings : NULL, &status);
  Wire.begin();
  begin_display();
}

void setup() {
  gm_core_init(&core);
  put_outputs(gm_core_outputs(&core, GM_IN_ESTOP_OK)); /* the levels stand before the pins drive */
  pinMode(GM_PIN_STEP_OUT, OUTPUT);
  pinMode(GM_PIN_DIR_OUT, OUTPUT);
#if GM_HAS_ENABLE
  pinMode(GM_PIN_ENABLE, OUTPUT);
#endif
#if GM_HAS_HEALTHY
  pinMode(GM_PIN_HEALTHY, OUTPUT);
#endif
#if GM_HAS_RESET
  pinMode(GM_PIN_RESET, OUTPUT);
#endif
#if GM_HAS_ALARM
  pinMode(GM_PIN_ALARM, INPUT_PULLUP);
#endif
  pinMode(GM_PIN_BUTTON, INPUT_PULLUP);
#if GM_HAS_ESTOP
  pinMode(GM_PIN_ESTOP, INPUT_PULLUP);
#endif
  begin_operator();
  set_priorities();
  begin_hob();
  begin_feed();
#if GM_HAS_INDEX
  pinMode(GM_PIN_INDEX, INPUT_PULLUP);
  attachInterrupt(digitalPinToInterrupt(GM_PIN_INDEX), on_index, GM_INDEX_ACTIVE_LOW ? FALLING : RISING);
#endif
  attachInterruptVector(IRQ_SOFTWARE, on_operator);
  NVIC_SET_PRIORITY(IRQ_SOFTWARE, OPERATOR_PRIORITY);
  NVIC_ENABLE_IRQ(IRQ_SOFTWARE);
  step_timer.begin(on_tick, GM_TICK_NS / 1000u); /* a timer is free: nothing else in this sketch takes one */
  begin_watchdog();
}

void loop() {
  looped_at = millis();
  if (to_save) {
    save();
  }
  watch_display();
  show();
}
