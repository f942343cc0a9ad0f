"""The step of the README that tries the motor at its full rate: engaged at speed, which asks nothing of the run-up."""

from __future__ import annotations

import math
from fractions import Fraction

from gearmath.export.reservations import fewest_teeth, steps_per_count
from gearmath.gearbox.kernels import evaluate
from gearmath.gearbox.motion import motion
from gearmath.specs.hobbing import HobbingMachine

#: Steps that a step motor loses at the least, in full steps: it falls into the next place of the same phase.
_SLIP = 4
#: Most starts of a thread.
_STARTS = 10
#: So many teeth more than the fewest are tried for a job that can be engaged at the highest speed.
_MORE_TEETH = 200


def full_rate_of_a_gear(machine: HobbingMachine) -> str:
    """The fewest teeth that the firmware takes, engaged while the hob turns: that asks nothing of the hob's run-up."""
    teeth, fastest = fewest_teeth(machine), float(machine.limits.hob_rpm)
    per_count = steps_per_count(machine, teeth)
    rpm = math.floor(motion(machine, per_count, fastest).engage_rpm)
    turns = math.ceil(teeth / machine.hob_starts)
    return (
        f"The motor at its full rate: job of {teeth} {'teeth' if teeth > 1 else 'tooth'}, no blank, a line across "
        f"table and frame. Switch the hob on, {rpm} rpm or the nearest lower speed that it has. When it has its "
        f"speed, `Start?` yes: {_overtakes(machine, per_count, rpm)}{_only_fast(machine, rpm)} Let the hob run for a "
        "minute, and answer `Stop?` while it still runs: the motor brakes by itself. Switch the hob off, `run on`, and "
        f"turn the hob on by hand: within {turns} turn{'s' * (turns > 1)} of it comes `In phase`; go on until the "
        f"second page shows `Table` 0.00 deg. The line must be back. {_slip(machine, 'table')}"
    )


def _only_fast(machine: HobbingMachine, rpm: float) -> str:
    """The job of a hob that has its highest speed only."""
    fastest, fewest = float(machine.limits.hob_rpm), fewest_teeth(machine)
    if rpm >= math.floor(fastest):
        return ""
    for teeth in range(fewest + 1, fewest + _MORE_TEETH):
        per_count = steps_per_count(machine, teeth)
        if motion(machine, per_count, fastest).catch_up_s is not None:
            rate = _overtaking(machine, per_count, fastest)[0]
            return f" (A hob of {fastest:g} rpm alone: {teeth} teeth, which reach {rate:.0f} steps/s.)"
    return ""


def _overtaking(machine: HobbingMachine, per_count: Fraction, rpm: float) -> tuple[float, float, float]:
    """Highest rate of a motor that is engaged at a speed, the rate that follows [steps/s], and the time until then."""
    rate, limits = rpm / 60.0 * float(machine.encoder_counts * per_count), machine.limits
    more, seconds = evaluate("catch_up", rate, limits.acceleration_hz_per_s, limits.step_rate_hz)
    return rate + more, rate, seconds


def _overtakes(machine: HobbingMachine, per_count: Fraction, rpm: float) -> str:
    highest, rate, seconds = _overtaking(machine, per_count, rpm)
    return (
        f"the motor speeds up by itself to about {highest:.0f} steps/s, of `step_rate_hz = {machine.max_step_rate}`, "
        f"overtakes what it has missed, and `In phase` comes after about {math.ceil(seconds)} s, with {rate:.0f} "
        "steps/s."
    )


def full_rate_of_a_thread(machine: HobbingMachine) -> str:
    """A lead of whole turns of the screw per turn of the spindle, engaged at the speed that asks most of the motor."""
    pitch = machine.lead_screw_pitch
    jobs = {starts: Fraction(machine.motor_steps * starts) / machine.encoder_counts for starts in range(1, _STARTS + 1)}
    speeds = {starts: _most_engaged(machine, per_count) for starts, per_count in jobs.items()}
    reached = {starts: round(_overtaking(machine, jobs[starts], speeds[starts])[0]) for starts in jobs}
    starts = max(jobs, key=lambda count: (reached[count], -count))
    rpm = math.floor(speeds[starts])
    return (
        f"The motor at its full rate: half nut open, job of a right-hand thread with the pitch of the lead screw, "
        f"{float(pitch):.6g} mm or {float(Fraction(127, 5) / pitch):.6g} per inch, {starts} start{'s' * (starts > 1)}. "
        f"Bring a mark on the spindle and one on the lead screw up. Switch the spindle on, {rpm} rpm or the nearest "
        f"lower speed that it has. When it has its speed, `Start?` yes: {_overtakes(machine, jobs[starts], rpm)} Then "
        "let the spindle run for a minute, and answer `Stop?` while it still runs: the motor brakes by itself. Switch "
        "the spindle off, `run on`, and turn the spindle on by hand: within a turn comes `In phase`; go on to "
        f"its mark. That of the lead screw must be up too. {_slip(machine, 'lead screw')}"
    )


def _most_engaged(machine: HobbingMachine, per_count: Fraction) -> float:
    """The highest speed at which a job can be engaged, within limits.hob_rpm."""
    return motion(machine, per_count, float(machine.limits.hob_rpm)).engage_rpm


def _slip(machine: HobbingMachine, driven: str) -> str:
    """What lost steps look like, and what to do."""
    lower = "lower `step_rate_hz` of the machine file by a quarter, export again, and repeat as its README says."
    if machine.drive.pulses is not None or machine.driver.timing.closed_loop:
        return f"If it is not, or the drive reports an alarm, {lower}"
    degrees = _SLIP * 360 * (machine.drive.microsteps or 1) / float(machine.motor_steps)
    if machine.profile == "lathe":
        way = f"{float(machine.lead_screw_pitch) * degrees / 360:.2g} mm of the carriage"
    else:
        way = f"{2 * math.pi * 50 * degrees / 360:.2g} mm at a radius of 50 mm"
    return (
        f"A step motor slips by {_SLIP} full steps at the least, {degrees:.2g} degrees of the {driven}, {way}. If it "
        f"has slipped or stalled, {lower}"
    )
