/* Stand-in for the Teensyduino core, for tests only: the calls that the sketch makes, with the signatures of
 * github.com/PaulStoffregen/cores (teensy3/core_pins.h, teensy4/core_pins.h, kinetis.h, imxrt.h), and nothing else.
 * What does not compile here is not in the sketch; what compiles here exists there.
 */
#ifndef Arduino_h
#define Arduino_h

#include <stddef.h>
#include <stdint.h>

#define HIGH 1
#define LOW 0
#define INPUT 0
#define OUTPUT 1
#define INPUT_PULLUP 2
#define FALLING 2
#define RISING 3
#define CHANGE 4

#ifdef __cplusplus
extern "C" {
#endif

void pinMode(uint8_t pin, uint8_t mode);
uint8_t digitalReadFast(uint8_t pin);
void digitalWriteFast(uint8_t pin, uint8_t val);
void attachInterrupt(uint8_t pin, void (*function)(void), int mode);
uint32_t millis(void);

void stand_in_mask(int masked); /* noInterrupts() and interrupts() are CPSID and CPSIE on the boards */
void stand_in_priority(int irq, uint8_t priority);

#ifdef __cplusplus
}
#endif

#define digitalPinToInterrupt(p) (p)
#define noInterrupts() stand_in_mask(1)
#define interrupts() stand_in_mask(0)
#define NVIC_SET_PRIORITY(irqnum, priority) stand_in_priority((irqnum), (uint8_t)(priority))

#if defined(__MK20DX256__) && defined(ARDUINO_TEENSY32)
enum IRQ_NUMBER_t { IRQ_PORTA = 87, IRQ_PORTB = 88, IRQ_PORTC = 89, IRQ_PORTD = 90, IRQ_PORTE = 91 };
#elif defined(__IMXRT1062__) && (defined(ARDUINO_TEENSY40) || defined(ARDUINO_TEENSY41))
enum IRQ_NUMBER_t { IRQ_GPIO6789 = 157 };
#else
#error "no board of the stand-in"
#endif

#ifdef __cplusplus
#include "IntervalTimer.h" /* as the cores do */

class Print {
 public:
  virtual size_t write(uint8_t) { return 0; }
};
#endif

void setup(void);
void loop(void);

#endif
