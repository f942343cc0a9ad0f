/*
 * gm_machine.h: generated, do not edit.
 *
 * Hobbing machine of Digital Machinist 15-4
 *
 * written by gearmath 0.1.0, casadi 3.8.2, sympy 1.14.0
 */
#ifndef GM_MACHINE_H
#define GM_MACHINE_H

#include <stdint.h>

/* Remainders and denominators of the step rule. */
typedef int32_t gm_wide;

enum { GM_INCH = 0, GM_MM = 1 };
enum { GM_DEPTH_225_P = 0, GM_DEPTH_2157_P = 1, GM_DEPTH_22_P = 2, GM_DEPTH_225_M = 3 };

/* One hob: unit of its gears, rule for the whole depth of its teeth, 10000 x diametral pitch or 10000 x module [mm]. */
typedef struct {
  uint8_t unit;
  uint8_t depth_rule;
  int32_t size;
} gm_hob;

#define GM_NAME "Hobbing machine of Digital Machinist 15-4"

/* --- the board */
#define GM_BOARD_TEENSY_32 1 /* Teensy 3.2 */
#define GM_TICK_NS 5000 /* ns, period of the step timer */
#define GM_DISPLAY_ADAFRUIT292 1 /* backpack with an MCP23008 */
#define GM_DISPLAY_ADDRESS 32 /* I2C address of the backpack */

/* --- the train */
#define GM_PROFILE_HOBBING 1 /* the motor turns the work table of a hobbing machine */
#define GM_ENCODER_COUNTS 4096 /* encoder counts per turn of its shaft, after the decoder */
#define GM_TURN_COUNTS 4096 /* encoder counts per turn of the hob, numerator */
#define GM_TURN_COUNTS_DEN 1 /* and denominator */
#define GM_MOTOR_STEPS 16000 /* motor steps per turn of the work table of a hobbing machine, numerator */
#define GM_MOTOR_STEPS_DEN 1 /* and denominator */
#define GM_HOB_STARTS 1 /* starts of the hob */
#define GM_HOB_LEFT 0 /* 1: left-hand hob */
#define GM_BACKLASH_STEPS 0 /* motor steps of play that are taken up */
#define GM_HYSTERESIS 0 /* counts of play of the hob encoder */
#define GM_WIDE 0 /* 0: gm_wide is int32_t, 1: int64_t */

/* --- the driver */
#define GM_STEP_HIGH_TICKS 2 /* ticks of a step pulse */
#define GM_STEP_LOW_TICKS 2 /* ticks of pause after it, at least */
#define GM_DIR_SETUP_TICKS 2 /* ticks from DIR to the pulse, at least */
#define GM_DIR_HOLD_TICKS 2 /* ticks from the pulse to DIR, at least */
#define GM_STEP_ACTIVE_LOW 0 /* 1: the pin is low during a step */
#define GM_DIR_ACTIVE_LOW 0 /* 1: the pin is low for forward */
#define GM_DIR_INVERT 0 /* 1: the motor is to turn the other way */
#define GM_ENABLE_ACTIVE_LOW 0 /* 1: the pin is low while the driver is enabled */

/* --- limits */
#define GM_MAX_LAG 100 /* steps that may wait */
#define GM_MAX_EDGE_RATE 54614 /* edges/s at the highest speed of the hob */
#define GM_MAX_STEP_RATE 40000 /* steps/s while the motor follows, at most */
#define GM_ACCELERATION 8000 /* steps/s^2 while the motor follows */
#define GM_MOVE_MAX_RATE 2000 /* steps/s of a jog or an index move */
#define GM_MOVE_ACCELERATION 8000 /* steps/s^2 of a jog or an index move */

/* --- what is wired */
#define GM_DECODER_LS7184 1 /* 1: pulse and direction, 0: channels A and B */
#define GM_HOB_COUNTER 0 /* number of the board's counter, 0: interrupts count */
#define GM_FEED_COUNTER 0 /* number of the board's counter, 0: interrupts count */
#define GM_HAS_INDEX 0 /* index pulse of the hob */
#define GM_HAS_FEED 0 /* encoder of the axial feed */
#define GM_HAS_ENABLE 0 /* enable output of the driver */
#define GM_HAS_ESTOP 0 /* emergency stop input */
#define GM_ENCODER_INVERT 0 /* 1: counts go down as the hob turns forward */
#define GM_INDEX_ACTIVE_LOW 0 /* 1: the index pulse is low */
#define GM_HAS_ALARM 0 /* alarm input of the driver */
#define GM_ALARM_ACTIVE_LOW 1 /* 1: the pin is low during an alarm */
#define GM_HAS_RESET 0 /* reset output to the driver */
#define GM_HAS_HEALTHY 0 /* fail-safe output */

/* --- pins */
#define GM_PIN_KNOB_A 2 /* knob, channel A */
#define GM_PIN_KNOB_B 3 /* knob, channel B */
#define GM_PIN_BUTTON 4 /* button of the knob, to ground */
#define GM_PIN_ENCODER_STEP 6 /* hob encoder: pulse of its LS7184 */
#define GM_PIN_ENCODER_DIR 7 /* hob encoder: direction of its LS7184 */
#define GM_PIN_DIR_OUT 8 /* DIR to the driver */
#define GM_PIN_STEP_OUT 13 /* STEP to the driver */
#define GM_PIN_SDA 18 /* display, data */
#define GM_PIN_SCL 19 /* display, clock */
#define GM_HOBS 10
static const gm_hob gm_hobs[GM_HOBS] = {
  {GM_INCH, GM_DEPTH_225_P, 320000},
  {GM_INCH, GM_DEPTH_225_P, 360000},
  {GM_INCH, GM_DEPTH_225_P, 480000},
  {GM_INCH, GM_DEPTH_225_P, 600000},
  {GM_INCH, GM_DEPTH_225_P, 608000},
  {GM_INCH, GM_DEPTH_225_P, 640000},
  {GM_INCH, GM_DEPTH_225_P, 800000},
  {GM_INCH, GM_DEPTH_225_P, 1050000},
  {GM_INCH, GM_DEPTH_225_P, 1260000},
  {GM_MM, GM_DEPTH_225_M, 10000},
};

#endif
