"""The chapters of the README that bring the built machine to its first gear or thread."""

from __future__ import annotations

import math
from collections.abc import Iterator

from gearmath.export.full_rate import full_rate_of_a_gear, full_rate_of_a_thread
from gearmath.export.markdown import bullets
from gearmath.export.reservations import SMALL, fewest_teeth, small_rpm, trial_teeth
from gearmath.specs.hobbing import HobbingMachine
from gearmath.specs.motion_limits import most_acceleration


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
        yield (
            "K1, with a multimeter at its COM and NO: joined while the menu is shown. Pull the wire at pin "
            f"{pins.healthy} off: not joined any more. Leave it off, release every stop, and switch the power of the "
            f"spindle on, nothing clamped, hands off: S4 must not start the {leading}. Put the wire back, hold the "
            "button for a second where a fault is shown: S4 must start it now. Pull the wire off while it runs "
            "empty: it must stop. Then S3, and the power of the spindle off again."
        )
    if pins.alarm is not None:
        how = "pull the wire at" if machine.driver.alarm_active == "high" else "join to GND"
        yield (
            f"The input for the alarm of the driver: {how} pin {pins.alarm}, and `FAULT motor driver` must come. Put "
            "it back as it was. (A driver without power may report an alarm, too: the driver itself is tried below.)"
        )
    lines = "the MODE jumper or the number of lines" if machine.encoder.has_ls7184 else "the number of lines"
    yield (
        f"`test hob encoder`: make a mark on the {leading} and one beside it, press, turn it by hand in its working "
        f"direction until the marks meet again, press. It must count {round(machine.encoder_counts)}, one in a hundred "
        f"more or less. `decoder mode?` means {lines}; `OK, but backwards` asks for channels A and B to be exchanged, "
        "or `invert = true` under `[encoder]`."
    )
    if machine.encoder.has_ls7184:
        yield _output_pulse(machine)


def _output_pulse(machine: HobbingMachine) -> str:
    """How the trimmer in the place of RB1 is set."""
    rate = machine.max_edge_rate
    low, high = (5 * (1 - rate * pulse * 1e-6) for pulse in (2.0, 1.0))
    other = " RB2 at U4 gets the same value." if machine.feed is not None else ""
    return (
        "A trimmer in the place of RB1: with an oscilloscope at pin 8 (CLK) of U3, ground at pin 3, turn the hob by "
        "hand, and the trimmer down until each pulse, which is low, lasts 1 us to 2 us. With a multimeter alone, DC "
        "volts at pin 8 against pin 3: 5.00 V while the encoder stands. Power of the spindle on, that of the motor "
        f"off, and no job: at {machine.limits.hob_rpm:g} rpm, {rate} edges/s, the mean is {high:.2f} V for pulses of "
        f"1 us and {low:.2f} V for 2 us; turn the trimmer down until it lies between. At half the speed it must have "
        "fallen half as far from 5.00 V: if it has fallen further, edges are lost at the full speed, and the pulse "
        "is still too long. Everything off and U3 out of its socket, measure trimmer and resistor together, and "
        f"solder the nearest fixed resistor in.{other}"
    ).replace("the hob by hand", f"the {_leading(machine)} by hand")


def _alarm_of_the_driver(machine: HobbingMachine, free: str) -> str:
    if machine.driver.alarm_active == "high":
        tried = (
            "Then pull the cable of the alarm off at the driver: the fault must come. Motor power off, the cable back."
        )
    else:
        tried = (
            "Make the driver report an alarm once, as its manual says (most do so where the motor is unplugged, "
            "without power, and power comes on then): the fault must come. Motor power off, the motor back."
        )
    return (
        f"Motor power on, {free}. Where `FAULT motor driver` is shown, hold the button for a second: it must go. If "
        "it stays although the lamp of the driver shows no alarm, write the other level as `alarm_active`, export "
        f"and flash again. {tried}"
    )


def _moving(machine: HobbingMachine) -> Iterator[str]:
    """What is tried with power on the motor, the other side at rest."""
    lathe, leading, limits = machine.profile == "lathe", _leading(machine), machine.limits
    driven, free = ("lead screw", "half nut open") if lathe else ("table", "nothing clamped, the hob clear of it")
    seconds = float(machine.motor_steps) / machine.move_max_rate + machine.move_max_rate / limits.acceleration_hz_per_s
    if machine.pins.alarm is not None:
        yield _alarm_of_the_driver(machine, free)
    yield (
        f"Motor power on, {free}. Have a hand on the switch of G2: neither emergency stop nor board takes the power of "
        f"the motor away. `test one turn`: draw a line across "
        f"{driven} and frame, answer yes; in about {seconds:.0f} s {round(machine.motor_steps)} "
        f"steps must bring the line back exactly. If not, full steps, "
        f"microsteps{' or belt' if lathe else ', belt or worm'} of the machine file are not those of the machine: "
        "where it makes half a turn the driver makes twice the microsteps that the file says, where two turns, half."
    )
    # from rest to twice the acceleration the motor swings to 3.5 times it; from braking to full acceleration to 2.5
    twice = min(2.0 * limits.acceleration_hz_per_s, most_acceleration(machine))
    reached = int(min(machine.max_step_rate, math.sqrt(twice * float(machine.motor_steps))))
    yield (
        f"What the motor carries: with `acceleration_hz_per_s = {twice:g}` and `move_rate_hz = {reached}` in a copy "
        "of the machine file, exported to another folder and flashed (9 V off, U1 out of its socket each time), "
        "repeat `test one turn` ten times; the line must come back each time. Then flash this folder again. A motor "
        f"that passes has the reserve that it needs where the {leading} stops at once while it is being caught up. "
        "If it loses steps, halve `acceleration_hz_per_s` of the machine file, export again, and repeat."
    )


def _together(machine: HobbingMachine) -> Iterator[str]:
    """What is tried with both sides turning."""
    lathe, leading = machine.profile == "lathe", _leading(machine)
    yield _direction_of_a_thread() if lathe else _direction_of_a_gear(machine)
    yield full_rate_of_a_thread(machine) if lathe else full_rate_of_a_gear(machine)
    if machine.pins.index is not None:
        turning = leading if machine.encoder.belt == 1 else "encoder, which are not those of the " + leading
        yield (
            f"Index: in the same job let the {leading} run for a minute at about "
            f"{min(100.0, machine.limits.hob_rpm / 2):g} rpm. `Checked` on the third page (two detents) must count "
            f"every turn of the {turning}. If it stays at 0, Z of the encoder does not reach pin "
            f"{machine.pins.index}, or its pulse is the other way round: write the other `index_active`; if `FAULT "
            "hob encoder` comes, edges are lost: look at cable, shield, coupling."
        )
    if machine.feed is not None:
        yield _direction_of_the_feed(machine)
    trial = (
        "a thread in scrap, and measure it over ten pitches"
        if lathe
        else f"a gear of {trial_teeth(machine)} teeth in wax, and count them"
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
    teeth = trial_teeth(machine)
    turns = teeth // 4
    return (
        f"Direction: job of {teeth} teeth with a {hand}-hand hob, no helix, `Start?` yes. Turn the hob by hand "
        f"{turns} turns in its working direction: the table must go {turns * 360 * machine.hob_starts / teeth:g} "
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


def _pinions(machine: HobbingMachine) -> Iterator[str]:
    """What must be changed for gears of fewer teeth."""
    teeth = fewest_teeth(machine)
    if teeth <= SMALL:
        return
    yield (
        f"With {machine.hob_starts} start{'s' * (machine.hob_starts > 1)} of the hob the firmware takes {teeth} teeth "
        f"and more: at {machine.limits.hob_rpm:g} rpm fewer need more than {machine.max_step_rate} steps/s, and the "
        f"start says `too many steps/s` and `Set limit`. Write that limit into the machine file, for {SMALL} teeth "
        f"`hob_rpm = {small_rpm(machine)}`, export again, and do not run the hob faster."
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
    "Within its limit a hob of 25 mm turns at 600 to 800 rpm in aluminum, at 300 to 350 rpm in steel; one of 50 mm "
    "at half of that, and so on. Cutting oil for steel and aluminum, brass dry.",
    "Swivel the hob head by the lead angle of the hob (stamped on it), for helical teeth by helix less lead angle "
    "where both have one hand, by their sum where not. Which way: so that the thread of the hob, on the side of the "
    "blank, lies along the teeth to be cut; for a spur gear that is along the axis of the blank.",
    "Touch the blank with the turning hob, go beside it, and set the whole depth of the page `Depth`. Cut it in one "
    "pass: a shallow first pass lets the hob drag the blank round.",
    "Feed 0.1 to 0.3 mm per turn of the table for small modules. Conventional cut where the feed has play, climb cut "
    "where it has none. Climb is where the teeth of the hob, as they cut, move against the way in which the hob is "
    "fed.",
    "Clear of the blank switch the hob on, answer `Start?` when it has its speed, wait for `In phase`, then feed in. "
    "At the end feed clear of the blank, answer `Stop?`, and only then switch the hob off. So it does not matter how "
    "quickly the hob starts and stops. A job that is too fast to be engaged (`gearmath gearbox plan` says so) starts "
    "with the hob at rest, and the hob must take as long as the run-up of that plan, to start and to stop.",
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
