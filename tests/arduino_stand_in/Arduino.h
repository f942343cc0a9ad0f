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

#if defined(__MK20DX256__) && defined(ARDUINO_TEENSY32)
enum IRQ_NUMBER_t { IRQ_PORTA = 87, IRQ_PORTB = 88, IRQ_PORTC = 89, IRQ_PORTD = 90, IRQ_PORTE = 91, IRQ_SOFTWARE = 94 };
#elif defined(__IMXRT1062__) && (defined(ARDUINO_TEENSY40) || defined(ARDUINO_TEENSY41))
enum IRQ_NUMBER_t { IRQ_SOFTWARE = 70, IRQ_GPIO6789 = 157 };
#else
#error "no board of the stand-in"
#endif

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
void stand_in_pend(int irq);
void attachInterruptVector(enum IRQ_NUMBER_t irq, void (*function)(void));

#ifdef __cplusplus
}
#endif

#define digitalPinToInterrupt(p) (p)
#define noInterrupts() stand_in_mask(1)
#define interrupts() stand_in_mask(0)
#define NVIC_SET_PENDING(irqnum) stand_in_pend(irqnum)
#define NVIC_ENABLE_IRQ(irqnum) ((void)(irqnum))
#define NVIC_SET_PRIORITY(irqnum, priority) stand_in_priority((irqnum), (uint8_t)(priority))

/* Registers, as variables: the tests are the hardware behind them. */
extern volatile uint32_t stand_in_pin_config[64];
#define portConfigRegister(pin) (&stand_in_pin_config[(pin)])
#if defined(__MK20DX256__)
#define PORT_PCR_MUX(n) ((uint32_t)(((n) & 7) << 8))
#define PORT_PCR_PE ((uint32_t)0x00000002)
#define PORT_PCR_PS ((uint32_t)0x00000001)
#define STAND_IN_FTM(unit)                                                                                       \
  extern volatile uint32_t FTM##unit##_SC, FTM##unit##_CNT, FTM##unit##_MOD, FTM##unit##_C0SC, FTM##unit##_C1SC, \
      FTM##unit##_CNTIN, FTM##unit##_MODE, FTM##unit##_FILTER, FTM##unit##_QDCTRL;
extern volatile uint16_t WDOG_UNLOCK, WDOG_TOVALH, WDOG_TOVALL, WDOG_PRESC, WDOG_STCTRLH, WDOG_REFRESH;
STAND_IN_FTM(1)
STAND_IN_FTM(2)
#else
#define CCM_CCGR_ON 3
#define CCM_CCGR2_XBAR1(n) ((uint32_t)(((n) & 0x03) << 22))
#define CCM_CCGR3_WDOG1(n) ((uint32_t)(((n) & 0x03) << 16))
#define CCM_CCGR4_ENC1(n) ((uint32_t)(((n) & 0x03) << 24))
#define CCM_CCGR4_ENC3(n) ((uint32_t)(((n) & 0x03) << 28))
extern volatile uint16_t WDOG1_WCR, WDOG1_WSR, WDOG1_WMCR;
extern volatile uint32_t CCM_CCGR2, CCM_CCGR3, CCM_CCGR4, IOMUXC_XBAR1_IN06_SELECT_INPUT, IOMUXC_XBAR1_IN07_SELECT_INPUT,
    IOMUXC_XBAR1_IN08_SELECT_INPUT, IOMUXC_XBAR1_IN09_SELECT_INPUT, IOMUXC_XBAR1_IN14_SELECT_INPUT,
    IOMUXC_XBAR1_IN15_SELECT_INPUT, IOMUXC_XBAR1_IN17_SELECT_INPUT, IOMUXC_XBAR1_IN22_SELECT_INPUT,
    IOMUXC_XBAR1_IN23_SELECT_INPUT;
extern volatile uint16_t XBARA1_SEL33, XBARA1_SEL38, ENC1_CTRL, ENC1_FILT, ENC1_LPOS, ENC1_UINIT, ENC1_LINIT, ENC3_CTRL,
    ENC3_FILT, ENC3_LPOS, ENC3_UINIT, ENC3_LINIT;
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
