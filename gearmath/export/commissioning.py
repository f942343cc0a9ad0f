"""The chapters of the README that bring the built machine to its first gear or thread."""

from __future__ import annotations

import math
from collections.abc import Iterator
from fractions import Fraction

from gearmath.export.markdown import bullets
from gearmath.gearbox.job import TRIP
from gearmath.specs.hobbing import HobbingMachine
from gearmath.specs.motion_limits import TRIAL_TEETH

#: Steps that a step motor loses at the least, in full steps: it falls into the next place of the same phase.
_SLIP = 4
#: Most starts of a thread.
_STARTS = 10
#: A pinion that is cut on such machines.
_SMALL = 6


def commissioning(machine: HobbingMachine) -> Iterator[str]:
    """The tests of the built machine in an order in which nothing moves before what stops it was tried."""
    yield "## Commissioning"
    yield ""
    yield from bullets((*_standing(machine), *_moving(machine), *_together(machine)), numbered=True)


def _standing(machine: HobbingMachine) -> Iterator[str]:
    """What is tried before the motor has power."""
    leading, pins = _leading(machine), machine.pins
    yield (
        "Power of spindle and motor off, the 9 V on: the display says `PHASE IS LOST`. If it shows nothing, or a row "
        "of blocks, turn the contrast screw of its backpack. Press once, then hold the button until the menu comes."
    )
    yield (
        "Turn the knob clockwise by one detent, seen from the front: the mark `>` goes down by one line, and a number "
        "grows by 1. If it goes up, exchange A and B of S1."
    )
    if pins.estop is not None:
        yield (
            "Press the emergency stop: `EMERGENCY STOP` must come at once. Release it, hold the button for a second: "
            f"it goes. Then the same with the wire at pin {pins.estop} pulled off instead. If it does not come, "
            "contact and wire are not normally closed to ground; if it stays, the wire is broken."
        )
    if pins.healthy is not None:
        lets_go = "In that state" if pins.estop is not None else f"With the wire at pin {pins.healthy} pulled off"
        yield (
            f"{lets_go} K1 must have let go (a multimeter shows no connection from COM to NO), and the {leading} must "
            "not start when S4 is pressed."
        )
    if pins.alarm is not None:
        how = "pull the wire at" if machine.driver.alarm_active == "high" else "join to GND"
        yield (
            f"The alarm of the driver: {how} pin {pins.alarm}, and `FAULT motor driver` must come; with the driver "
            "wired and on it must go after a hold of the button. If it stays, write the other level as `alarm_active`."
        )
    lines = "the MODE jumper or the number of lines" if machine.encoder.has_ls7184 else "the number of lines"
    yield (
        f"`test hob encoder`: make a mark on the {leading} and one beside it, press, turn it by hand in its working "
        f"direction until the marks meet again, press. It must count {round(machine.encoder_counts)}, one in a hundred "
        f"more or less. `decoder mode?` means {lines}; `OK, but backwards` asks for channels A and B to be exchanged, "
        "or `invert = true` under `[encoder]`."
    )


def _moving(machine: HobbingMachine) -> Iterator[str]:
    """What is tried with power on the motor, the other side at rest."""
    lathe, leading, limits = machine.profile == "lathe", _leading(machine), machine.limits
    driven, free = ("lead screw", "half nut open") if lathe else ("table", "nothing clamped, the hob clear of it")
    seconds = float(machine.motor_steps) / machine.move_max_rate + machine.move_max_rate / limits.acceleration_hz_per_s
    stop = "the emergency stop" if machine.pins.estop is not None else "the switch of G2, there is no emergency stop"
    yield (
        f"Motor power on, {free}. Have a hand on {stop}. `test one turn`: draw a line across "
        f"{driven} and frame, answer yes; in about {seconds:.0f} s {round(machine.motor_steps)} "
        f"steps must bring the line back exactly. If not, full steps, "
        f"microsteps{' or belt' if lathe else ', belt or worm'} of the machine file are not those of the machine: "
        "where it makes half a turn the driver makes twice the microsteps that the file says, where two turns, half."
    )
    # from rest to twice the acceleration the motor swings to 3.5 times it; from braking to full acceleration to 2.5
    twice = min(2.0 * limits.acceleration_hz_per_s, 1e7)
    reached = int(min(machine.max_step_rate, math.sqrt(twice * float(machine.motor_steps))))
    yield (
        f"What the motor carries: with `acceleration_hz_per_s = {twice:g}` and `move_rate_hz = {reached}` in a copy of "
        "the machine file, exported and flashed, repeat `test one turn` ten times; the line must come back each time. "
        "Then flash this folder again. A motor that passes has the reserve that it needs where the "
        f"{leading} stops at once while it is being caught up. If it loses steps, halve `acceleration_hz_per_s` of the "
        "machine file, export again, and repeat."
    )


def _together(machine: HobbingMachine) -> Iterator[str]:
    """What is tried with both sides turning."""
    lathe, leading = machine.profile == "lathe", _leading(machine)
    yield _direction_of_a_thread() if lathe else _direction_of_a_gear(machine)
    yield _full_rate_of_a_thread(machine) if lathe else _full_rate_of_a_gear(machine)
    if machine.pins.index is not None:
        turning = leading if machine.encoder.belt == 1 else "encoder, which are not those of the " + leading
        yield (
            f"Index: in the same job let the {leading} run for a minute at about 100 rpm. `Checked` on the third page "
            f"(two detents) must count every turn of the {turning}. If it stays at 0, Z of the encoder does not reach "
            f"pin {machine.pins.index}; if `FAULT hob encoder` comes, edges are lost: look at cable, shield, coupling."
        )
    if machine.feed is not None:
        yield _direction_of_the_feed(machine)
    trial = (
        "a thread in scrap, and measure it over ten pitches"
        if lathe
        else f"a gear of {TRIAL_TEETH} teeth in wax, and count them"
    )
    yield f"Cut air: a whole pass with the tool 5 mm clear of the blank. Then cut {trial}."


def _direction_of_a_thread() -> str:
    return (
        "Direction: job of a right-hand thread of 1 mm with one start, `Start?` yes, half nut closed, nothing chucked. "
        "Turn the spindle by hand ten turns in its working direction: the carriage must go 10 mm to the headstock, by "
        "a rule. If it goes away from it, change `invert_direction` of the driver and export again; if it goes another "
        "way than 10 mm, pitch or belt of the lead screw are wrong in the machine file."
    )


def _direction_of_a_gear(machine: HobbingMachine) -> str:
    hand = machine.hob_hand
    turns = TRIAL_TEETH // 4
    return (
        f"Direction: job of {TRIAL_TEETH} teeth with a {hand}-hand hob, no helix, `Start?` yes. Turn the hob by hand "
        f"{turns} turns in its working direction: the table must go {turns * 360 * machine.hob_starts / TRIAL_TEETH:g} "
        f"degrees. Which way: hold the {hand} hand beside the hob, its bent fingers the way the hob turns; its thumb "
        "lies along the axis of the hob. The side of the table next to the hob must go the other way than the thumb "
        "points. If it goes with the thumb, change `invert_direction` of the driver and export again."
    )


def _direction_of_the_feed(machine: HobbingMachine) -> str:
    assert machine.feed is not None
    counts, other = machine.feed.counts_per_mm, "conventional" if machine.feed_climbs else "climb"
    return (
        "Feed: the same job without a helix, the hob switched off. Turn the hob a little by hand in its working "
        "direction and see which way its teeth go on the side of the blank, along the feed. Now move the feed by hand, "
        "10 mm by dial or rule, so that the hob goes along the blank that same way (where the slide carries the blank, "
        "the blank goes the other way): that is a conventional cut. `Feed` on the third page must grow by 10.000 mm, "
        "and the table must stand still. If it falls by 10 mm, "
        f'write `counts_up = "{other}"` under `[feed]` and export again; if it shows another way, write as '
        f"`counts_per_mm` {counts} times what it shows, divided by 10. Back by 10 mm it must show 0.000 again; if not, "
        "edges are lost: look at cable, shield and terminals."
    )


def _full_rate_of_a_gear(machine: HobbingMachine) -> str:
    """The firmware takes the fewest teeth whose steps keep the rate up to the highest speed of the hob."""
    teeth = _fewest_teeth(machine)
    rate = float(Fraction(machine.limits.hob_rpm) / 60 * machine.motor_steps * machine.hob_starts / teeth)
    return (
        f"The motor at its full rate: job of {teeth} {'teeth' if teeth > 1 else 'tooth'}, no blank, a line across "
        f"table and frame, `Start?` yes with the hob at rest. Run the hob up to {machine.limits.hob_rpm:g} rpm: the "
        f"motor makes {rate:.0f} steps/s then, of `step_rate_hz = {machine.max_step_rate}`. "
        f"{_up(machine, rate, 'hob')} Leave it there for a minute, switch the hob off, and turn it on by "
        "hand until the second page shows `Table` "
        f"0.00 deg: the line must be back. {_slip(machine, 'table')}"
    )


def _fewest_teeth(machine: HobbingMachine) -> int:
    """The fewest teeth that the firmware takes: they keep the rate up to the speed at which it trips."""
    at_one = Fraction(machine.limits.hob_rpm) / 60 * machine.motor_steps * machine.hob_starts * TRIP
    return max(1, math.ceil(at_one / machine.max_step_rate))


def _pinions(machine: HobbingMachine) -> Iterator[str]:
    """What must be changed for gears of fewer teeth."""
    teeth = _fewest_teeth(machine)
    if teeth <= _SMALL:
        return
    rpm = math.floor(machine.max_step_rate * _SMALL * 60 / (machine.motor_steps * machine.hob_starts * TRIP))
    yield (
        f"With {machine.hob_starts} start{'s' * (machine.hob_starts > 1)} of the hob the firmware takes {teeth} teeth "
        f"and more: at {machine.limits.hob_rpm:g} rpm fewer need more than {machine.max_step_rate} steps/s, and the "
        f"start says `too many steps/s` and `Set limit`. Write that limit into the machine file, for {_SMALL} teeth "
        f"`hob_rpm = {rpm}`, export again, and do not run the hob faster."
    )


def _full_rate_of_a_thread(machine: HobbingMachine) -> str:
    """A lead of whole turns of the screw per turn of the spindle, as few as reach the rate."""
    most = Fraction(machine.max_step_rate) * 60 / TRIP  # steps a minute
    starts = min(_STARTS, max(1, math.ceil(most / machine.motor_steps / Fraction(machine.limits.hob_rpm))))
    rpm = math.floor(min(Fraction(machine.limits.hob_rpm), most / machine.motor_steps / starts))
    rate = float(machine.motor_steps * starts * rpm / 60)
    pitch = machine.lead_screw_pitch
    return (
        f"The motor at its full rate: half nut open, job of a right-hand thread with the pitch of the lead screw, "
        f"{float(pitch):.6g} mm or {float(Fraction(127, 5) / pitch):.6g} per inch, {starts} start{'s' * (starts > 1)}. "
        f"Bring a mark on the spindle and one on the lead screw up, `Start?` yes with the spindle at rest. Run it up "
        f"to {rpm} rpm: the motor makes {rate:.0f} steps/s then, of `step_rate_hz = {machine.max_step_rate}`. "
        f"{_up(machine, rate, 'spindle')} Leave it there for a minute, switch it off, and turn the spindle on by hand "
        f"to its mark: that of the lead screw must be up too. {_slip(machine, 'lead screw')}"
    )


def _up(machine: HobbingMachine, rate: float, leading: str) -> str:
    seconds = rate / machine.limits.acceleration_hz_per_s
    return (
        f"Let the {leading} take {seconds:.1f} s or more to that speed, by its inverter or in steps of speed; one that "
        "starts quicker runs away from the motor, and `FAULT table lags` comes."
    )


def _slip(machine: HobbingMachine, driven: str) -> str:
    """What lost steps look like, and what to do."""
    lower = "lower `step_rate_hz` of the machine file by a quarter, export again, and repeat as its README says."
    if machine.drive.pulses is not None or machine.driver.timing.closed_loop:
        return f"If it is not, or the drive reports an alarm, {lower}"
    degrees = _SLIP * 360 * (machine.drive.microsteps or 1) / float(machine.motor_steps)
    return (
        f"A step motor slips by {_SLIP} full steps at the least, {degrees:.2g} degrees of the {driven}, "
        f"{2 * math.pi * 50 * degrees / 360:.2g} mm at a radius of 50 mm. If it has slipped or stalled, {lower}"
    )


def first_cut(machine: HobbingMachine) -> Iterator[str]:
    """Advice for the first cut, with the figures of this machine."""
    lathe = machine.profile == "lathe"
    yield "## The first cut"
    yield ""
    acceleration = machine.limits.acceleration_hz_per_s
    common = (
        f"The motor speeds up by {acceleration:g} steps/s every second. `gearmath gearbox plan` tells for each job how "
        "long the run-up takes, and after how long a running machine is caught up. Do not cut before `In phase`."
    )
    advice = (common, *(_THREAD if lathe else (*_pinions(machine), *_GEAR)))
    yield from bullets(advice, numbered=True)


def _leading(machine: HobbingMachine) -> str:
    return "spindle" if machine.profile == "lathe" else "hob"


_GEAR = (
    "Take brass or a hard plastic, 30 to 60 teeth, and a blank of the diameter that the page `Blank` shows, on an "
    "arbor that runs true: what the blank runs out, its teeth run out too.",
    "A hob of 25 mm turns at 600 to 800 rpm in aluminum, at 300 to 350 rpm in steel; one of 50 mm at half of that, "
    "and so on. Cutting oil for steel and aluminum, brass dry.",
    "Swivel the hob head by the lead angle of the hob (stamped on it), for helical teeth by helix less lead angle "
    "where both have one hand, by their sum where not. Which way: so that the thread of the hob, on the side of the "
    "blank, lies along the teeth to be cut; for a spur gear that is along the axis of the blank.",
    "Touch the blank with the turning hob, go beside it, and set the whole depth of the page `Depth`. Cut it in one "
    "pass: a shallow first pass lets the hob drag the blank round.",
    "Feed 0.1 to 0.3 mm per turn of the table for small modules. Conventional cut where the feed has play, climb cut "
    "where it has none. Climb is where the teeth of the hob, as they cut, move against the way in which the hob is "
    "fed.",
    "Start hob and gearbox clear of the blank, wait for `In phase`, then feed in. At the end feed clear of the blank "
    "before you answer `Stop?`.",
    "Count the teeth, and measure the span that `gearmath gearbox plan` gives. Too thick by s: cut deeper by 1.46 s "
    "for a hob of 20 degrees, by 2.00 s for one of 14.5, which is s/(2 sin of the pressure angle).",
)
_THREAD = (
    "Take brass or aluminum, a relief groove of two pitches at the end of the thread, and a slow spindle.",
    "First a scratch of 0.05 mm: measure ten pitches with a rule or a thread gauge before you go deeper.",
    "Keep the half nut closed for the whole thread: the gearbox finds the thread again, the half nut would not.",
    "At the end draw the tool out first, then answer `Stop?`; jog back, and `run on` waits for the same groove.",
    "Take the play of the lead screw out by coming back further than the start of the thread, then forward.",
)
