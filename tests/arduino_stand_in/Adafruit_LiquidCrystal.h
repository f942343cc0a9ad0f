/* Stand-in; signatures of github.com/adafruit/Adafruit_LiquidCrystal, Adafruit_LiquidCrystal.h. */
#ifndef Adafruit_LiquidCrystal_h
#define Adafruit_LiquidCrystal_h

#include "Arduino.h"
#include "Wire.h"

class Adafruit_LiquidCrystal : public Print {
 public:
  Adafruit_LiquidCrystal(uint8_t i2cAddr, TwoWire *wire = &Wire);
  bool begin(uint8_t cols, uint8_t rows, uint8_t charsize = 0);
  void setBacklight(uint8_t value);
  void setCursor(uint8_t col, uint8_t row);
  virtual size_t write(uint8_t value);
};

#endif
