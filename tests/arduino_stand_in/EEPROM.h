/* Stand-in; signatures of github.com/PaulStoffregen/EEPROM, EEPROM.h. */
#ifndef EEPROM_h
#define EEPROM_h

#include <stdint.h>

struct EEPROMClass {
  uint8_t read(int idx);
  void update(int idx, uint8_t val);
  uint16_t length();
};

extern EEPROMClass EEPROM;

#endif
