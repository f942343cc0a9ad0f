"""What a machine file leaves out or cannot do, which its builder must know: in the README and on the terminal."""

from __future__ import annotations

import math
from fractions import Fraction

from gearmath.gearbox.helix import hob_ratio
from gearmath.gearbox.job import TRIP
from gearmath.gearbox.motion import motion
from gearmath.specs.hobbing import HobbingMachine
from gearmath.specs.motion_limits import TRIAL_TEETH

#: A pinion that is cut on such machines.
SMALL = 6
_MOST_TEETH = 999


def reservations(machine: HobbingMachine) -> tuple[str, ...]:
    """One sentence each, what matters most first; none for a machine with all its guards that follows every job."""
    pins, leading = machine.pins, "spindle" if machine.profile == "lathe" else "hob"
    found = []
    if pins.healthy is None:
        found.append(f"No fail-safe output (`pins.healthy`): after a fault you must stop the {leading} yourself.")
    if pins.estop is None:
        found.append("No emergency stop (`pins.estop`): the board cannot see one.")
    if pins.index is None:
        found.append("No index pulse (`pins.index`): lost encoder edges are not noticed.")
    if machine.driver.output == "direct" and machine.driver.step_active == "low":
        found.append(
            '`output = "direct"` with `step_active = "low"`: this is for inputs without opto-couplers, as the common '
            'is at 0 V. Opto-couplers that are fed from + need `output = "open_collector"`.'
        )
    if machine.profile != "lathe":
        found += _jobs(machine)
    turn = round(machine.motor_steps)
    most = turn // 2 if machine.profile == "lathe" else turn // (2 * TRIAL_TEETH)
    if machine.limits.lag_steps > most:
        half = "half a turn of the lead screw" if machine.profile == "lathe" else f"half a tooth of {TRIAL_TEETH}"
        found.append(
            f"`lag_steps = {machine.limits.lag_steps}`: the motor may be that far behind before it is a fault; "
            f"{half} is {most} steps."
        )
    return tuple(found)


def fewest_teeth(machine: HobbingMachine) -> int:
    """The fewest teeth that the firmware takes: they keep the rate up to the speed at which it trips."""
    at_one = Fraction(machine.limits.hob_rpm) / 60 * machine.motor_steps * machine.hob_starts * TRIP
    return max(1, math.ceil(at_one / machine.max_step_rate))


def steps_per_count(machine: HobbingMachine, teeth: int) -> Fraction:
    """Motor steps per encoder count of a gear, whatever the hand of the hob."""
    return abs(hob_ratio(machine, teeth, machine.hob_starts))


def small_rpm(machine: HobbingMachine) -> int:
    """The highest limits.hob_rpm with which the firmware takes a gear of SMALL teeth."""
    return math.floor(machine.max_step_rate * SMALL * 60 / (machine.motor_steps * machine.hob_starts * TRIP))


def trial_teeth(machine: HobbingMachine) -> int:
    """Teeth of the first gear, a multiple of four that the firmware takes."""
    return max(TRIAL_TEETH, 4 * math.ceil(fewest_teeth(machine) / 4))


def _jobs(machine: HobbingMachine) -> list[str]:
    """Gears that the firmware refuses, or whose phase is lost as the hob starts."""
    limits, fewest = machine.limits, fewest_teeth(machine)
    found = []
    if fewest > SMALL:
        found.append(
            f"Gears of fewer than {fewest} teeth are refused: at {limits.hob_rpm:g} rpm they need more than "
            f"{machine.max_step_rate} steps/s. For {SMALL} teeth write `hob_rpm = {small_rpm(machine)}` and export "
            "again."
        )
    if limits.run_up_s is not None:
        followed = next((z for z in range(fewest, _MOST_TEETH + 1) if _follows(machine, z)), None)
        if followed != fewest:
            which = "Every gear" if followed is None else f"A gear of fewer than {followed} teeth"
            found.append(
                f"{which} loses its phase where the hob takes `run_up_s = {limits.run_up_s:g}` to or from "
                f"{limits.hob_rpm:g} rpm: engage it at speed, or let the hob start slower."
            )
    return found


def _follows(machine: HobbingMachine, teeth: int) -> bool:
    """Whether the table follows the hob in the time of the machine file."""
    shortest = motion(machine, steps_per_count(machine, teeth), float(machine.limits.hob_rpm)).shortest_run_up_s
    return machine.limits.run_up_s is None or machine.limits.run_up_s >= shortest
