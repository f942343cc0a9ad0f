/* Stand-in; signatures of the library "LiquidCrystal I2C", LiquidCrystal_I2C.h. */
#ifndef LiquidCrystal_I2C_h
#define LiquidCrystal_I2C_h

#include "Arduino.h"
#include "Wire.h"

class LiquidCrystal_I2C : public Print {
 public:
  LiquidCrystal_I2C(uint8_t lcd_Addr, uint8_t lcd_cols, uint8_t lcd_rows);
  void init();
  void backlight();
  void setCursor(uint8_t col, uint8_t row);
  virtual size_t write(uint8_t value);
};

#endif
