/* gm_counter.h: the counters of the board, for the sketch only. A counter has 16 bits and runs over; it is read whole, in
 * one access, and gm_counter_motion tells the counts since the last reading, if they are fewer than 32768. The step timer
 * reads it every GM_TICK_NS: that would be more than 6 counts a nanosecond.
 *
 * Teensy 3.2: FTM1 or FTM2 as quadrature decoder, or with QUADMODE for pulse (phase A, rising edge) and direction (phase
 * B). Teensy 4: the crossbar leads the pins to ENC1 (hob) or ENC3 (feed), PH1 is for pulse and direction. Of the 32 bits of
 * ENC the lower register is enough. The filters ignore pulses shorter than a quarter of the distance of real edges.
 */
#ifndef GM_COUNTER_H
#define GM_COUNTER_H

#include <Arduino.h>

#include "gm_counter_motion.h"
#include "gm_machine.h"

#if GM_HOB_COUNTER || GM_FEED_COUNTER
#define GM_JOINED_(a, b, c) a##b##c
#define GM_JOINED(a, b, c) GM_JOINED_(a, b, c)

#ifdef GM_BOARD_TEENSY_32
enum { GM_FTM_WPDIS = 0x04, GM_FTM_FTMEN = 0x01, GM_FTM_SYSTEM_CLOCK = 0x08 };
enum { GM_FTM_QUADEN = 0x01, GM_FTM_QUADMODE = 0x08, GM_FTM_FILTERS = 0xC0 };

#define GM_FTM(unit, name) GM_JOINED(FTM, unit, _##name)
#define GM_COUNTER_BEGIN(axis, pin_a, pin_b)                                                                 \
  do {                                                                                                       \
    *portConfigRegister(pin_a) = PORT_PCR_MUX(GM_##axis##_MUX_A) | PORT_PCR_PE | PORT_PCR_PS;                \
    *portConfigRegister(pin_b) = PORT_PCR_MUX(GM_##axis##_MUX_B) | PORT_PCR_PE | PORT_PCR_PS;                \
    GM_FTM(GM_##axis##_COUNTER, MODE) = GM_FTM_WPDIS;                                                        \
    GM_FTM(GM_##axis##_COUNTER, MODE) = GM_FTM_WPDIS | GM_FTM_FTMEN;                                         \
    GM_FTM(GM_##axis##_COUNTER, SC) = 0;                                                                     \
    GM_FTM(GM_##axis##_COUNTER, C0SC) = 0;                                                                   \
    GM_FTM(GM_##axis##_COUNTER, C1SC) = 0;                                                                   \
    GM_FTM(GM_##axis##_COUNTER, CNTIN) = 0;                                                                  \
    GM_FTM(GM_##axis##_COUNTER, MOD) = 0xFFFF;                                                               \
    GM_FTM(GM_##axis##_COUNTER, FILTER) = GM_##axis##_FILTER * 0x11;                                         \
    GM_FTM(GM_##axis##_COUNTER, QDCTRL) =                                                                    \
        GM_FTM_QUADEN | (GM_##axis##_FILTER ? GM_FTM_FILTERS : 0) | (GM_DECODER_LS7184 ? GM_FTM_QUADMODE : 0); \
    GM_FTM(GM_##axis##_COUNTER, CNT) = 0;                                                                    \
    GM_FTM(GM_##axis##_COUNTER, SC) = GM_FTM_SYSTEM_CLOCK;                                                   \
  } while (0)
#define GM_COUNTER_READ(axis) ((uint16_t)GM_FTM(GM_##axis##_COUNTER, CNT))

#else
enum { GM_ENC_PH1 = 0x0200, GM_ENC_REV = 0x0400, GM_ENC_SWIP = 0x0800, GM_ENC_FIVE_SAMPLES = 0x0200 };

/* Where an input of the crossbar is chosen between its pads. */
static inline volatile uint32_t *gm_select_input(int input) {
  switch (input) {
    case 6: return &IOMUXC_XBAR1_IN06_SELECT_INPUT;
    case 7: return &IOMUXC_XBAR1_IN07_SELECT_INPUT;
    case 8: return &IOMUXC_XBAR1_IN08_SELECT_INPUT;
    case 9: return &IOMUXC_XBAR1_IN09_SELECT_INPUT;
    case 14: return &IOMUXC_XBAR1_IN14_SELECT_INPUT;
    case 15: return &IOMUXC_XBAR1_IN15_SELECT_INPUT;
    case 22: return &IOMUXC_XBAR1_IN22_SELECT_INPUT;
    case 23: return &IOMUXC_XBAR1_IN23_SELECT_INPUT;
    default: return &IOMUXC_XBAR1_IN17_SELECT_INPUT;
  }
}

/* Phases A and B of ENC1 are the outputs 66 and 67 of the crossbar, those of ENC3 76 and 77: one register each. */
#define GM_CROSSBAR_1 XBARA1_SEL33
#define GM_CROSSBAR_3 XBARA1_SEL38
#define GM_ENC(unit, name) GM_JOINED(ENC, unit, _##name)
#define GM_COUNTER_BEGIN(axis, pin_a, pin_b)                                                                \
  do {                                                                                                      \
    CCM_CCGR2 |= CCM_CCGR2_XBAR1(CCM_CCGR_ON);                                                              \
    CCM_CCGR4 |= GM_JOINED(CCM_CCGR4_ENC, GM_##axis##_COUNTER, )(CCM_CCGR_ON);                               \
    pinMode(pin_a, INPUT_PULLUP);                                                                           \
    pinMode(pin_b, INPUT_PULLUP);                                                                           \
    *portConfigRegister(pin_a) = GM_##axis##_MUX_A;                                                         \
    *portConfigRegister(pin_b) = GM_##axis##_MUX_B;                                                         \
    *gm_select_input(GM_##axis##_CROSSBAR_A) = GM_##axis##_DAISY_A;                                         \
    *gm_select_input(GM_##axis##_CROSSBAR_B) = GM_##axis##_DAISY_B;                                         \
    GM_JOINED(GM_CROSSBAR_, GM_##axis##_COUNTER, ) = GM_##axis##_CROSSBAR_A | GM_##axis##_CROSSBAR_B << 8;   \
    GM_ENC(GM_##axis##_COUNTER, FILT) = GM_ENC_FIVE_SAMPLES | GM_##axis##_FILTER;                            \
    GM_ENC(GM_##axis##_COUNTER, UINIT) = 0;                                                                 \
    GM_ENC(GM_##axis##_COUNTER, LINIT) = 0;                                                                 \
    GM_ENC(GM_##axis##_COUNTER, CTRL) = GM_ENC_SWIP | (GM_DECODER_LS7184 ? GM_ENC_PH1 | GM_ENC_REV : 0);      \
  } while (0)
#define GM_COUNTER_READ(axis) ((uint16_t)GM_ENC(GM_##axis##_COUNTER, LPOS))
#endif
#endif

#endif
