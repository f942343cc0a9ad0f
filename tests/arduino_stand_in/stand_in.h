/* What the stand-in's board remembers. Its encoders count by themselves, as the library Encoder does. */
#ifndef STAND_IN_H
#define STAND_IN_H

#include "Arduino.h"

struct stand_in_board {
  uint8_t level[64];
  uint8_t mode[64];
  void (*handler[64])(void);
  int edge[64];
  int32_t count[64]; /* of the Encoder on this first pin */
  void (*tick)(void);
  unsigned tick_us;
  uint32_t now_ms;
  int masked;
  uint8_t priority_of_pins;
  uint8_t priority_of_timer;
  int last_irq;
  uint32_t i2c_clock;
  uint8_t eeprom[4284];
  int eeprom_writes;
  uint16_t eeprom_log[1024][2]; /* of these writes: place and value */
  char lcd[80];
  int lcd_row;
  int lcd_column;
  int lcd_writes;
  int lcd_starts;
  void (*software)(void);
  int pended;
  uint8_t priority_of_software;
  void (*bus_waits)(void); /* what the time passes with while the bus is stuck */
  int display_off;
};

extern stand_in_board stand_in;

#endif
