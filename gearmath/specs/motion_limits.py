"""Whether the limits of a gearbox machine fit its driver, each other and the work that it is made for."""

from __future__ import annotations

import math
from fractions import Fraction
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from gearmath.specs.hobbing import HobbingMachine

#: The first work of a machine: a gear of so many teeth, or a thread of 1 mm.
TRIAL_TEETH = 24
#: Part of the highest speed at which the motor must follow that work at the least.
TRIAL_SPEED = Fraction(1, 10)
#: Speed up to which a step motor without an encoder has torque for a cut, as a rule of thumb [1/min].
EASY_MOTOR = 1500
#: Angular acceleration that no motor of such machines reaches, even without load [rad/s2]: 1.2 Nm over 2.4e-5 kg m2.
QUICKEST = 50_000.0
#: Longest time to the speed of a move, and to the step rate [s]; the latter is that of limits.run_up_s.
LONGEST_RAMP, LONGEST_RUN_UP = 10.0, 600.0


def motor_rpm(machine: HobbingMachine, steps_per_s: float) -> float:
    """Speed of the motor at a step rate."""
    return steps_per_s * 60.0 / float(machine.drive.pulses_per_turn)


def hurries(machine: HobbingMachine) -> bool:
    """Whether limits.step_rate_hz asks an ordinary step motor for more speed than such motors have torque at."""
    return _plain(machine) and motor_rpm(machine, machine.max_step_rate) > EASY_MOTOR


def _plain(machine: HobbingMachine) -> bool:
    """Whether it is a step motor that nothing but its steps leads."""
    return machine.drive.pulses is None and not machine.driver.timing.closed_loop


def most_acceleration(machine: HobbingMachine) -> int:
    """The most that limits.acceleration_hz_per_s may be."""
    return math.floor(QUICKEST * float(machine.drive.pulses_per_turn) / (2.0 * math.pi))


def easy_rate(machine: HobbingMachine) -> int:
    """The step rate at which an ordinary step motor has torque."""
    return int(EASY_MOTOR * machine.drive.pulses_per_turn / 60)


def check_motion(machine: HobbingMachine) -> None:
    """Raises ValueError with key, value, limit and what to do."""
    _check_driver(machine)
    _check_work(machine)
    _check_ramps(machine)
    _check_lag(machine)
    _check_play(machine)


def _check_driver(machine: HobbingMachine) -> None:
    limits, highest = machine.limits, machine.driver.timing.highest_rate(machine.tick_ns, machine.jitter_ns)
    driver = machine.driver.name or "of the file"
    for key in ("step_rate_hz", "move_rate_hz"):
        rate = getattr(limits, key)
        if rate is not None and rate > highest:
            raise ValueError(f"limits.{key} = {rate:g}: driver {driver} on {machine.board} takes at most {highest}")
    if machine.move_max_rate > limits.step_rate_hz:
        raise ValueError(
            f"limits.move_rate_hz = {limits.move_rate_hz:g}: must not exceed limits.step_rate_hz = "
            f"{limits.step_rate_hz:g}"
        )


def _trial(machine: HobbingMachine) -> tuple[str, Fraction]:
    """The first work, in words, and its motor steps per turn of hob or spindle."""
    if machine.profile == "lathe":
        return "a thread of 1 mm", machine.motor_steps / machine.lead_screw_pitch
    return f"a gear of {TRIAL_TEETH} teeth", machine.motor_steps * machine.hob_starts / TRIAL_TEETH


def _check_work(machine: HobbingMachine) -> None:
    work, steps = _trial(machine)
    limits, rpm = machine.limits, machine.limits.hob_rpm * float(TRIAL_SPEED)
    needed = math.ceil(rpm / 60.0 * float(steps))
    if limits.step_rate_hz < needed:
        raise ValueError(
            f"limits.step_rate_hz = {limits.step_rate_hz:g}: {work} needs {needed} steps/s at {rpm:g} rpm, a tenth of "
            f"{machine.speed_key}; write at least {needed} if driver and motor carry it, or take fewer steps per turn "
            f"of the motor or a lower {machine.speed_key}"
        )


def _check_ramps(machine: HobbingMachine) -> None:
    acceleration = machine.limits.acceleration_hz_per_s
    if acceleration > most_acceleration(machine):
        turn = 2.0 * math.pi / float(machine.drive.pulses_per_turn)  # rad per step
        raise ValueError(
            f"limits.acceleration_hz_per_s = {acceleration:g}: is {acceleration * turn:.0f} rad/s2 of the motor, and "
            f"no rotor, even bare, does more than {QUICKEST:.0f}; write at most {most_acceleration(machine)}"
        )
    for what, rate, most in (
        ("a move", float(machine.move_max_rate), LONGEST_RAMP),
        ("the motor", machine.limits.step_rate_hz, LONGEST_RUN_UP),
    ):
        if rate / acceleration > most:
            raise ValueError(
                f"limits.acceleration_hz_per_s = {acceleration:g}: {what} needs {rate / acceleration:.1f} s to reach "
                f"{rate:g} steps/s, the limit is {most:g} s; at least {math.ceil(rate / most)} is needed"
            )


def _check_lag(machine: HobbingMachine) -> None:
    work, steps = _trial(machine)
    lag, at_once = machine.limits.lag_steps, math.ceil(steps / machine.encoder_counts)
    turn = math.floor(machine.motor_steps)
    driven = "lead screw" if machine.profile == "lathe" else "table"
    if lag <= at_once:
        raise ValueError(
            f"limits.lag_steps = {lag}: one count of the encoder is up to {at_once} steps of {work}, so that the first "
            f"would trip; write at least {at_once + 1}, or take an encoder of more lines"
        )
    if lag >= turn > at_once + 1:
        raise ValueError(
            f"limits.lag_steps = {lag}: is a whole turn of the {driven} or more; write less than {turn}, its steps"
        )


def _check_play(machine: HobbingMachine) -> None:
    hysteresis, counts = machine.encoder.hysteresis, machine.encoder_counts
    if hysteresis and 4 * hysteresis > counts:
        raise ValueError(
            f"encoder.hysteresis = {hysteresis}: is more than a quarter of a turn of {counts} counts; write at most "
            f"{int(counts / 4)}"
        )
    if machine.profile == "lathe" and machine.drive.backlash >= machine.lead_screw_pitch:
        raise ValueError(
            f"lead_screw.backlash = {machine.drive.backlash:g}: must be less than the pitch of the screw, "
            f"{float(machine.lead_screw_pitch):g} mm"
        )
