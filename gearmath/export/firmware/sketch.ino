/* The board around the electronic gearbox: pins, interrupts, knob, display, EEPROM. What is computed is in the other
 * files, which know no Arduino; what is wired is in gm_machine.h. Do not edit: change the machine file, export again.
 *
 * Interrupts. The pulses of hob and feed, the hob's index pulse and the step timer all run at PRIORITY: the processor
 * finishes one before it begins the next, so that none sees the gearbox half changed, and no slower interrupt (USB,
 * I2C) delays them. None of them waits for anything. loop() shuts them out for single calls of a few microseconds
 * (gm_mask, gm_unmask).
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
static void lcd_begin() {
  lcd.begin(GM_COLUMNS, GM_ROWS);
  lcd.setBacklight(HIGH);
  Wire.setClock(400000); /* the MCP23008 takes it; a PCF8574 only the 100000 of the start */
}
#else
static LiquidCrystal_I2C lcd(GM_DISPLAY_ADDRESS, GM_COLUMNS, GM_ROWS);
static void lcd_begin() {
  lcd.init();
  lcd.backlight();
}
#endif

static char shown[GM_ROWS * GM_COLUMNS];
static int cursor; /* place behind the character written last */

static void show() {
  for (int k = 0; k < GM_ROWS * GM_COLUMNS; ++k) {
    const int place = (cursor + k) % (GM_ROWS * GM_COLUMNS);
    const int row = place / GM_COLUMNS, column = place % GM_COLUMNS;
    const char letter = ui.screen[row][column];
    if (letter != shown[place]) {
      if (k != 0 || column == 0) {
        lcd.setCursor((uint8_t)column, (uint8_t)row);
      }
      lcd.write((uint8_t)letter);
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

static void on_tick() {
  put_outputs(gm_core_outputs(&core, inputs()));
  follow_hob();
  follow_feed();
  gm_core_think(&core);
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

/* --- operator --- */
static bool to_save = false;

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
  look(&status);
  if (status.mode == GM_MOVE || status.pending != 0 || status.edge_rate != 0) {
    return;
  }
  to_save = false;
  const int slot = gm_store_save(stored, &ui.loaded); /* the job that was confirmed, not the one on the screen */
  if (slot >= 0) {
    for (int k = slot * GM_RECORD_BYTES; k < (slot + 1) * GM_RECORD_BYTES; ++k) {
      EEPROM.update(k, stored[k]);
    }
  }
}

static void read_knob() {
  static int32_t passed = 0;
  const int32_t count = knob.read();
  if (count - passed >= COUNTS_A_DETENT) {
    passed += COUNTS_A_DETENT;
    send(GM_UI_KNOB_UP);
  } else if (passed - count >= COUNTS_A_DETENT) {
    passed -= COUNTS_A_DETENT;
    send(GM_UI_KNOB_DOWN);
  }
}

/* A long press tells while it is held, a short one when it is let go. */
static void read_button() {
  static bool last = false, down = false, told = false;
  static uint32_t changed_at = 0, down_at = 0;
  const bool closed = digitalReadFast(GM_PIN_BUTTON) == LOW;
  const uint32_t now = millis();
  if (closed != last) {
    last = closed;
    changed_at = now;
  }
  if (closed != down && now - changed_at >= (uint32_t)BOUNCE_MS) {
    down = closed;
    if (down) {
      down_at = now;
      told = false;
    } else if (!told) {
      send(GM_UI_SHORT);
    }
  }
  if (down && !told && now - down_at >= (uint32_t)LONG_PRESS_MS) {
    told = true;
    send(GM_UI_LONG);
  }
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
  for (int k = 0; k < GM_ROWS * GM_COLUMNS; ++k) {
    shown[k] = ' '; /* what the display shows after its start */
  }
  lcd_begin();
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
  step_timer.begin(on_tick, GM_TICK_NS / 1000u); /* a timer is free: nothing else in this sketch takes one */
}

void loop() {
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
  if (to_save) {
    save();
  }
  show();
}
