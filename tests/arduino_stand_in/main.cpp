/* What the Arduino tools add to a sketch. */
#include "Arduino.h"

int main() {
  setup();
  for (;;) {
    loop();
  }
}
