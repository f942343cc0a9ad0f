/* Stand-in; signatures of WireIMXRT.h and WireKinetis.h of Teensyduino's Wire. */
#ifndef TwoWire_h
#define TwoWire_h

#include <stdint.h>

class TwoWire {
 public:
  void begin();
  void beginTransmission(uint8_t address);
  uint8_t endTransmission();
  void setClock(uint32_t frequency);
};

extern TwoWire Wire;

#endif
