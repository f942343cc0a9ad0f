"""What the motor's acceleration means for a job: run-up, catching up, and the nearest job that can be followed.

The firmware never exceeds ``limits.acceleration_hz_per_s`` while it follows (gm_core.h); the equations are (7.10) to
(7.12).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction

from gearmath.errors import InputError
from gearmath.gearbox.kernels import evaluate
from gearmath.specs.hobbing import HobbingMachine

#: Turns of the hob after which the firmware gives up catching up; GM_HOPELESS_TURNS.
HOPELESS_TURNS = 64.0
#: Longest run-up of a hob [s], as that of a machine file.
LONGEST_RUN_UP = 600.0
_HEADROOM = 1.002  # of the step rate over the speed, below which nothing is overtaken


@dataclass(frozen=True)
class MotorMotion:
    """The motor of a job between rest and its speed. Hob stands for spindle on a lathe."""

    run_up_s: float
    """Time that the motor needs from rest to the speed of the job, and back."""
    hob_acceleration_rpm_per_s: float
    """The quickest run-up or stop of the hob that stays in phase."""
    shortest_run_up_s: float
    """The shortest run-up or stop of the hob within limits.lag_steps; the table is out of phase for a while."""
    catch_up_s: float | None
    """Engaged while the hob turns at this speed: time until it is in phase; None where it never is."""
    catch_up_turns: float | None
    """And turns of the hob."""
    engage_rpm: float
    """Highest speed at which it can be engaged: 64 turns are not exceeded."""


def motion(machine: HobbingMachine, ratio: Fraction, rpm: float) -> MotorMotion:
    """The motion of a job of ``ratio`` motor steps per count at ``rpm``."""
    limits = machine.limits
    rate = rpm / 60.0 * float(machine.encoder_counts * abs(ratio))
    run_up, _, shortest = evaluate("run_up", rate, limits.acceleration_hz_per_s, float(limits.lag_steps))
    seconds = _catch_up(machine, rate)
    turns = None if seconds is None else seconds * rpm / 60.0
    if turns is not None and turns > HOPELESS_TURNS:
        seconds = turns = None
    return MotorMotion(run_up, rpm / run_up, shortest, seconds, turns, _engage_rpm(machine, rate / rpm, rpm))


def check_run_up(machine: HobbingMachine, job: MotorMotion, rpm: float, seconds: float | None, what: str) -> None:
    """Raises InputError where the table loses a hob that takes ``seconds`` from rest to ``rpm``.

    ``seconds`` is limits.run_up_s of the machine file if not given, and then in proportion to the speed.
    """
    if seconds is not None and not 0.0 <= seconds <= LONGEST_RUN_UP:
        raise InputError(f"run_up = {seconds:g}: must lie between 0 and {LONGEST_RUN_UP:g} s")
    given = seconds
    if given is None and machine.limits.run_up_s is not None:
        given = machine.limits.run_up_s * rpm / machine.limits.hob_rpm
    if given is None or given >= job.shortest_run_up_s:
        return
    if seconds is not None:
        stated = f"run_up = {seconds:g} s"
    else:
        limits = machine.limits
        stated = f"limits.run_up_s = {limits.run_up_s:g} s to {limits.hob_rpm:g} rpm, {given:.3g} s to {rpm:.0f} rpm"
    rate = job.run_up_s * machine.limits.acceleration_hz_per_s / rpm  # steps/s per rpm

    def carried(speed: float) -> bool:
        _, _, shortest = evaluate(
            "run_up", rate * speed, machine.limits.acceleration_hz_per_s, float(machine.limits.lag_steps)
        )
        time = given if seconds is not None else given * speed / rpm
        return shortest <= time

    slower = _highest(carried, rpm)
    raise InputError(
        f"{stated}: with {what} the motor of {machine.name} follows a hob that takes at least "
        f"{job.shortest_run_up_s:.3g} s to {rpm:.0f} rpm (limits.acceleration_hz_per_s = "
        f"{machine.limits.acceleration_hz_per_s:g}, limits.lag_steps = {machine.limits.lag_steps}); the nearest speed "
        f"with this run-up is {slower:.0f} rpm"
    )


def _catch_up(machine: HobbingMachine, rate: float) -> float | None:
    limits = machine.limits
    if rate * _HEADROOM >= limits.step_rate_hz:
        return None
    return evaluate("catch_up", rate, limits.acceleration_hz_per_s, limits.step_rate_hz)[1]


def _engage_rpm(machine: HobbingMachine, rate_per_rpm: float, rpm: float) -> float:
    def carried(speed: float) -> bool:
        seconds = _catch_up(machine, rate_per_rpm * speed)
        return seconds is not None and seconds * speed / 60.0 <= HOPELESS_TURNS

    return _highest(carried, rpm)


def _highest(carried: Callable[[float], bool], most: float) -> float:
    """The highest speed up to ``most`` that is carried, where every lower one is too."""
    if carried(most):
        return most
    low, high = 0.0, most
    for _ in range(50):
        middle = (low + high) / 2.0
        low, high = (middle, high) if carried(middle) else (low, middle)
    return low
