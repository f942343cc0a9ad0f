/*
 * gm_machine.h: generated, do not edit.
 *
 * Hobbing machine of Digital Machinist 15-4
 *
 * written by gearmath 0.1.0, casadi 3.8.2, sympy 1.14.0
 */
#ifndef GM_MACHINE_H
#define GM_MACHINE_H

/* encoder counts per turn of the hob, after the decoder */
#define GM_ENCODER_COUNTS 4096
/* motor steps per turn of the work table */
#define GM_MOTOR_STEPS 16000
/* starts of the hob */
#define GM_HOB_STARTS 1

#endif
