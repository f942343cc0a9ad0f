/* A board in memory: pins, EEPROM, display, clock, interrupts. The tests turn its encoders and read its pins. */
#include "stand_in.h"

#include "Adafruit_LiquidCrystal.h"
#include "EEPROM.h"
#include "Encoder.h"
#include "LiquidCrystal_I2C.h"

stand_in_board stand_in;
TwoWire Wire;
EEPROMClass EEPROM;

volatile uint32_t stand_in_pin_config[64];
#if defined(__MK20DX256__)
#define FTM(unit)                                                                                         \
  volatile uint32_t FTM##unit##_SC, FTM##unit##_CNT, FTM##unit##_MOD, FTM##unit##_C0SC, FTM##unit##_C1SC, \
      FTM##unit##_CNTIN, FTM##unit##_MODE, FTM##unit##_FILTER, FTM##unit##_QDCTRL;
volatile uint8_t PMC_LVDSC1;
volatile uint16_t WDOG_UNLOCK, WDOG_TOVALH, WDOG_TOVALL, WDOG_PRESC, WDOG_STCTRLH, WDOG_REFRESH;
FTM(1)
FTM(2)
#else
volatile uint16_t WDOG1_WCR, WDOG1_WSR, WDOG1_WMCR;
volatile uint32_t CCM_CCGR2, CCM_CCGR3, CCM_CCGR4, IOMUXC_XBAR1_IN06_SELECT_INPUT, IOMUXC_XBAR1_IN07_SELECT_INPUT,
    IOMUXC_XBAR1_IN08_SELECT_INPUT, IOMUXC_XBAR1_IN09_SELECT_INPUT, IOMUXC_XBAR1_IN14_SELECT_INPUT,
    IOMUXC_XBAR1_IN15_SELECT_INPUT, IOMUXC_XBAR1_IN17_SELECT_INPUT, IOMUXC_XBAR1_IN22_SELECT_INPUT,
    IOMUXC_XBAR1_IN23_SELECT_INPUT;
volatile uint16_t stand_in_crossbar[66];
volatile uint16_t ENC1_CTRL, ENC1_FILT, ENC1_LPOS, ENC1_UINIT, ENC1_LINIT, ENC3_CTRL,
    ENC3_FILT, ENC3_LPOS, ENC3_UINIT, ENC3_LINIT;
#endif

extern "C" {
void pinMode(uint8_t pin, uint8_t mode) { stand_in.mode[pin] = mode; }
uint8_t digitalReadFast(uint8_t pin) { return stand_in.level[pin]; }
void digitalWriteFast(uint8_t pin, uint8_t val) { stand_in.level[pin] = val; }
void attachInterrupt(uint8_t pin, void (*function)(void), int mode) {
  stand_in.handler[pin] = function;
  stand_in.edge[pin] = mode;
}
uint32_t millis(void) { return stand_in.now_ms; }
void stand_in_mask(int masked) { stand_in.masked = masked; }
void stand_in_pend(int irq) { stand_in.pended |= irq == IRQ_SOFTWARE; }
void attachInterruptVector(enum IRQ_NUMBER_t irq, void (*function)(void)) {
  if (irq == IRQ_SOFTWARE) {
    stand_in.software = function;
  }
}
void stand_in_priority(int irq, uint8_t priority) {
  if (irq == IRQ_SOFTWARE) {
    stand_in.priority_of_software = priority;
    return;
  }
  stand_in.priority_of_pins = priority;
  stand_in.last_irq = irq;
}
}

bool IntervalTimer::begin(void (*funct)(void), unsigned int microseconds) {
  stand_in.tick = funct;
  stand_in.tick_us = microseconds;
  return true;
}
void IntervalTimer::priority(uint8_t n) { stand_in.priority_of_timer = n; }

void TwoWire::begin() {}
void TwoWire::beginTransmission(uint8_t) {}
uint8_t TwoWire::endTransmission() {
  if (stand_in.bus_waits) {
    stand_in.bus_waits();
  }
  return stand_in.display_off ? 2 : stand_in.bus_waits ? 4 : 0; /* no answer; another error */
}
void TwoWire::setClock(uint32_t frequency) { stand_in.i2c_clock = frequency; }

uint8_t EEPROMClass::read(int idx) { return stand_in.eeprom[idx]; }
void EEPROMClass::update(int idx, uint8_t val) {
  stand_in.eeprom[idx] = val;
  if (stand_in.eeprom_writes < 1024) {
    stand_in.eeprom_log[stand_in.eeprom_writes][0] = (uint16_t)idx;
    stand_in.eeprom_log[stand_in.eeprom_writes][1] = val;
  }
  ++stand_in.eeprom_writes;
}

Encoder::Encoder(uint8_t pin1, uint8_t) : pin_(pin1) {}
int32_t Encoder::read() { return stand_in.count[pin_]; }

static void lcd_start() {
  if (stand_in.bus_waits) {
    stand_in.bus_waits();
  }
  ++stand_in.lcd_starts;
  for (int k = 0; k < 80; ++k) {
    stand_in.lcd[k] = ' ';
  }
}
static size_t lcd_put(uint8_t value) {
  if (stand_in.bus_waits) { /* nothing gets through */
    stand_in.bus_waits();
    return 0;
  }
  stand_in.lcd[stand_in.lcd_row * 20 + stand_in.lcd_column] = (char)value;
  ++stand_in.lcd_column; /* on the glass, the next one after a line's end is another line: the sketch must say so */
  ++stand_in.lcd_writes;
  return 1;
}
static void lcd_goto(uint8_t col, uint8_t row) {
  stand_in.lcd_column = col;
  stand_in.lcd_row = row;
}

Adafruit_LiquidCrystal::Adafruit_LiquidCrystal(uint8_t, TwoWire *) {}
bool Adafruit_LiquidCrystal::begin(uint8_t, uint8_t, uint8_t) {
  lcd_start();
  return !stand_in.display_off;
}
void Adafruit_LiquidCrystal::setBacklight(uint8_t) {}
void Adafruit_LiquidCrystal::setCursor(uint8_t col, uint8_t row) { lcd_goto(col, row); }
size_t Adafruit_LiquidCrystal::write(uint8_t value) { return lcd_put(value); }

LiquidCrystal_I2C::LiquidCrystal_I2C(uint8_t, uint8_t, uint8_t) {}
void LiquidCrystal_I2C::init() { lcd_start(); }
void LiquidCrystal_I2C::backlight() {}
void LiquidCrystal_I2C::setCursor(uint8_t col, uint8_t row) { lcd_goto(col, row); }
size_t LiquidCrystal_I2C::write(uint8_t value) { return lcd_put(value); }
