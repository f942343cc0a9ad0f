"""The chapters of the README that bring the built machine to its first gear or thread."""

from __future__ import annotations

import math
from collections.abc import Iterator

from gearmath.export.markdown import bullets
from gearmath.specs.hobbing import HobbingMachine


def commissioning(machine: HobbingMachine) -> Iterator[str]:
    """The tests of the built machine in an order in which nothing moves before what stops it was tried."""
    yield "## Commissioning"
    yield ""
    yield from bullets((*_standing(machine), *_moving(machine)), numbered=True)


def _standing(machine: HobbingMachine) -> Iterator[str]:
    """What is tried before the motor has power."""
    leading = _leading(machine)
    yield (
        "Power of spindle and motor off, the 9 V on: the display says `PHASE IS LOST`. If it shows nothing, or a row "
        "of blocks, turn the contrast screw of its backpack. Press once, then hold the button until the menu comes."
    )
    yield "Turn the knob to the right: the mark goes down, and a number grows. Otherwise exchange A and B of S1."
    if machine.pins.estop is not None:
        yield "Press the emergency stop, then pull its wire off: each time `EMERGENCY STOP` must come."
    if machine.pins.healthy is not None:
        lets_go = "In that state" if machine.pins.estop is not None else "With the wire of its pin pulled off"
        yield f"{lets_go} K1 must have let go, and the {leading} must not start."
    lines = "the MODE jumper or the number of lines" if machine.encoder.has_ls7184 else "the number of lines"
    yield (
        f"`test hob encoder`: press, turn the {leading} once by hand in its working direction, press. It must count "
        f"{round(machine.encoder_counts)}. `decoder mode?` means {lines}; `OK, but backwards` asks for channels A and "
        "B to be exchanged."
    )


def _moving(machine: HobbingMachine) -> Iterator[str]:
    """What is tried with power on the motor."""
    lathe, leading = machine.profile == "lathe", _leading(machine)
    driven, free = ("lead screw", "half nut open") if lathe else ("table", "nothing clamped")
    yield (
        f"Motor power on, {free}. `test one turn`: mark the {driven}, answer yes; "
        f"{round(machine.motor_steps)} steps must bring the mark back exactly. If not, full steps, microsteps"
        f"{' or belt' if lathe else ', belt or worm'} of the machine file are not those of the machine."
    )
    # from rest to twice the acceleration the motor swings to 3.5 times it; from braking to full acceleration to 2.5
    twice = min(2.0 * machine.limits.acceleration_hz_per_s, 1e7)
    reached = int(min(machine.max_step_rate, math.sqrt(twice * float(machine.motor_steps))))
    yield (
        f"What the motor carries: with `acceleration_hz_per_s = {twice:g}` and `move_rate_hz = {reached}` in a copy of "
        "the machine file, exported and flashed, repeat `test one turn` ten times; the mark must come back each time. "
        "Then flash this folder again. A motor that passes has the reserve that it needs where the "
        f"{leading} stops at once while it is being caught up. If it loses steps, halve `acceleration_hz_per_s` of the "
        "machine file, export again, and repeat."
    )
    right = (
        "With a right-hand thread and the half nut closed the carriage must go to the headstock. If it goes away from "
        "it, "
        if lathe
        else "Hob and table must turn like a worm and its wheel: where the two would touch, the rim of the blank goes "
        "the way in which the thread of the hob wanders. If it goes the other way, "
    )
    yield (
        f"Direction: take the job that is offered, answer `Start?` yes, and turn the {leading} by hand in its working "
        f"direction. {right}change `invert_direction` of the driver and export again."
    )
    if machine.pins.index is not None:
        turning = leading if machine.encoder.belt == 1 else "encoder, which are not those of the " + leading
        yield f"Run a job without load: `Checked` on its third page must count every turn of the {turning}."
    if machine.feed is not None:
        up = "climb" if machine.feed_climbs else "conventional"
        yield (
            "Move the feed by hand: `Feed` on the third page must show its travel in mm, growing in a conventional "
            f"cut. The machine file says that its counts grow in a {up} cut."
        )
    trial = (
        "a thread in scrap, and measure it over many turns" if lathe else "a gear of 24 teeth in wax, and count them"
    )
    yield f"Cut air, then {trial}."


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
    advice = (common, *(_THREAD if lathe else _GEAR))
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
