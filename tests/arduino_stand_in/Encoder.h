/* Stand-in; signatures of github.com/PaulStoffregen/Encoder, Encoder.h. */
#ifndef Encoder_h_
#define Encoder_h_

#include <stdint.h>

class Encoder {
 public:
  Encoder(uint8_t pin1, uint8_t pin2);
  int32_t read();

 private:
  uint8_t pin_;
};

#endif
