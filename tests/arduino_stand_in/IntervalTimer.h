/* Stand-in; signatures of teensy3/IntervalTimer.h and teensy4/IntervalTimer.h. */
#ifndef __INTERVALTIMER_H__
#define __INTERVALTIMER_H__

#include <stdint.h>

class IntervalTimer {
 public:
  bool begin(void (*funct)(void), unsigned int microseconds);
  void priority(uint8_t n);
};

#endif
