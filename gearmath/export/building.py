"""The chapters of the README that build the machine: parts, power, encoders, contactor, switches, scope check."""

from __future__ import annotations

import math
from collections.abc import Iterator

from gearmath.export.beside import BARE_WATTS, ROOM, beside, heat_sink
from gearmath.export.markdown import bullets, paragraph, table
from gearmath.export.netlist import Netlist, netlist, supply_amperes
from gearmath.specs.hobbing import HobbingMachine
from gearmath.specs.motion_limits import EASY_MOTOR, easy_rate, hurries

_SUPPLIES = (9.0, 12.0)


def order(machine: HobbingMachine) -> Iterator[str]:
    """From parts to the first gear: the chapters in the order of the work."""
    work = "thread" if machine.profile == "lathe" else "gear"
    yield from paragraph(f"From parts to the first {work}, chapter by chapter:")
    yield from bullets(
        (
            "Parts: buy them, every one is in the list.",
            "Wiring: solder by the diagram, tick off every connection, measure. U1 and the chips are not in their "
            "sockets yet: with 9 V on, that of U1 must have 4.8 to 5.2 V from Vin (+) to GND.",
            "Encoder and decoder: the mode jumper, the output of your encoder, and a trimmer in the place of RB1, "
            "which is set later."
            if machine.encoder.has_ls7184
            else "Encoder and decoder: the output of your encoder.",
            "Step motor driver: switches and current; motor power stays off.",
            "Flashing: U1 by USB alone, out of its socket; then U1 and the chips go into their sockets.",
            "Commissioning: display, stops, encoder, motor, directions, one after the other. Nothing is measured on a "
            "turning machine before that.",
            f"The first cut, and what the display shows meanwhile: Using it. What stops the {work}: Faults.",
        ),
        numbered=True,
    )


def parts_chapter(machine: HobbingMachine) -> Iterator[str]:
    """Every part with its value, by the name in diagram and tables."""
    yield "## Parts"
    yield ""
    found = netlist(machine)
    yield from table(("part", "what to buy", "what for"), [(p.name, p.what, p.purpose) for p in found.parts.values()])
    yield from paragraph("And beside the circuit:")
    yield from table(("part", "what to buy", "what for"), list(beside(machine, found)))
    yield from _power(found)


def _power(found: Netlist) -> Iterator[str]:
    current = found.current / 1000
    watts = {volts: (volts - 5.0) * current for volts in _SUPPLIES}
    words = ", ".join(f"{watts[volts]:.1f} W at {volts:g} V" for volts in _SUPPLIES)
    needed = {volts: heat_sink(found.current, volts) for volts in _SUPPLIES}
    sinks = [f"at most {ohms} K/W at {volts:g} V" for volts, ohms in needed.items() if ohms is not None]
    heat = f"It needs a heat sink of {', '.join(sinks)}, its pad counted in." if sinks else "It needs no heat sink."
    yield from paragraph(
        f"Supply: 9 V DC, {supply_amperes(found.current):.1f} A, of its own, not that of the motor. The parts take "
        f"{found.current} mA from +5 V at the most, so that U2 has to get rid of {words}; without a heat sink it "
        "stands "
        f"{BARE_WATTS:.1f} W in a cabinet at {ROOM:g} degrees C. {heat} The metal of U2 is 0 V."
    )


def encoder_outputs(machine: HobbingMachine) -> Iterator[str]:
    """Which outputs encoders have, and what each needs in front of the input."""
    chip = (
        "LS7184N"
        if machine.encoder.has_ls7184
        else ("74LVC245" if not machine.hardware.five_volt_tolerant else "board")
    )
    yield "### Outputs of encoders"
    yield ""
    yield from paragraph(f"What the label on the encoder says, and what stands between it and the {chip}:")
    rows = [
        ("voltage output (E6B2-CWZ3E), TTL, push-pull, fed with 5 V", "nothing: A, B and Z straight"),
        (
            "open collector, NPN (E6B2-CWZ6C), fed with 5 V",
            "1 kOhm from each of A, B, Z to +5 V; 5 mA, quick enough for 100 kHz on 3 m of cable",
        ),
        (
            "open collector, NPN, fed with 12 to 24 V",
            "the same 1 kOhm to +5 V, never to the 24 V; the encoder's brown wire to its own 24 V, the 0 V joined",
        ),
        (
            "line driver, RS-422, A and /A (E6B2-CWZ1X)",
            "a receiver AM26LS32 (5 V), 120 Ohm across each pair at the receiver; the pairs twisted",
        ),
        (
            "push-pull (HTL), 10 to 30 V",
            "a fast opto-coupler 6N137 for each: 2.2 kOhm 1 W in front of its diode at 24 V, 1 kOhm from its output "
            "to +5 V",
        ),
    ]
    yield from table(("output", "in front of the input"), rows)
    yield from paragraph(
        "An opto-coupler turns the levels round. For A and B that changes nothing; for Z write the other "
        "`index_active` under `[encoder]`. The same where Z of an encoder with open collectors is low on its mark: "
        "makes differ, and the index test below finds it."
    )
    yield from bullets(
        (
            "Cable: shielded, twisted, not in one duct with that of the motor; 100 mm away at least, crossings "
            "at right "
            "angles. The shield goes to 0 V at the end of the board only, the other end stays open and taped.",
            "The frame of the motor, the machine and the cabinet go to the protective earth, 0 V of the logic to it at "
            "one point: the terminal of U2.",
            "The cable of the motor: shielded too, its shield on the frame of the driver.",
        )
    )


def chain(machine: HobbingMachine) -> Iterator[str]:
    """The circuit of the contactor, which holds the power of the spindle."""
    pins, (leading, driven) = machine.pins, _shafts(machine)
    yield "### Contactor, latch and emergency stop"
    yield ""
    relay, stop = pins.healthy is not None, pins.estop is not None
    links = ["F1"] + ["S2 11-12"] * stop + ["S3"] + ["K1 COM-NO"] * relay
    yield "```"
    yield "L --" + "--".join(f"[{link}]" for link in links) + "--+--[S4]-----+--[KM1 A1-A2]-- N"
    lead = " " * len("L --" + "--".join(f"[{link}]" for link in links) + "--")
    yield lead + "|            |"
    yield lead + "+-[KM1 13-14]+"
    yield "```"
    yield ""
    what = [
        "F1: fuse of the control circuit, 1 A. Best is 24 V from a transformer of its own; mains only by an "
        "electrician.",
        "S3: stop, normally closed, red. S4: start, normally open, green.",
        "KM1: contactor of the motor of the spindle, for its current in AC-3, its main contacts 1-2, 3-4, 5-6 in the "
        "lines of the motor, its normally open contact 13-14 across S4: this is the latch. Whatever opens the chain "
        "lets KM1 fall, and only a press on S4 brings it back.",
        "A motor that is not protected yet gets an overload relay behind KM1, set to the current on its plate, whose "
        "contact 95-96 goes into the chain beside S3.",
        "A spindle with an inverter: KM1 never stands between inverter and motor. It feeds the inverter, or a contact "
        "of it is wired to the inverter's input for enable, as the manual of the inverter says.",
        "An RC element (100 nF and 100 Ohm, made for it) across the coil of KM1, for 24 V DC a 1N4007, ring to +.",
    ]
    if stop:
        what.append(
            "S2 opens the chain by itself, whatever the board does. Its contact 21-22 only tells the board, so "
            f"that the {driven} follows until the {leading} stands; the driver of the step motor keeps its power."
        )
    if relay:
        what.append(
            "K1: contacts for 250 V AC and 2 A at least. Check once: it must fall when the wire to the board is "
            "pulled off "
            "while the machine runs empty."
        )
    if not relay or not stop:
        what.append(
            "This machine has " + ("no emergency stop" if not stop else "no fail-safe relay") + " in the chain."
        )
    yield from bullets(what)


def _shafts(machine: HobbingMachine) -> tuple[str, str]:
    """What the encoder is on, and what the motor turns."""
    return ("spindle", "lead screw") if machine.profile == "lathe" else ("hob", "table")


def switches(machine: HobbingMachine) -> Iterator[str]:
    """Motor, its supply, and the switches of the driver."""
    drive, (_, driven) = machine.drive, _shafts(machine)
    rpm = machine.max_step_rate * 60 / drive.pulses_per_turn
    yield "### Motor, supply and switches of the driver"
    yield ""
    pulses = drive.pulses_per_turn
    steps = (
        f"{pulses} pulses per turn of the motor ({drive.full_steps} full steps x {drive.microsteps} microsteps)"
        if drive.pulses is None
        else f"{pulses} command pulses per turn of the motor, by its electronic gearing"
    )
    yield from bullets(
        (
            f"Set the driver to {steps}. The table is printed on the housing; names of the switches differ "
            "between makes. "
            "`test one turn` below shows whether it is right.",
            "Input of the driver: pulse and direction (PUL/DIR), not CW/CCW, where there is a switch or jumper for it.",
            "Current: what the plate of the motor says per phase. A driver that is set in peak current wants 1.4 times "
            "the RMS value.",
            *(
                ()
                if machine.driver.timing.closed_loop
                else (f"Half current at standstill: off. The {driven} has to hold against the cut.",)
            ),
            "Supply of the motor: near the highest voltage of the driver less 10 %, since motors of deep "
            "inductance lose "
            "their torque with speed; never the supply of the logic. Its minus goes to the driver only.",
            *_hurry(machine),
            f"Torque: at {machine.max_step_rate} steps/s the motor turns at {float(rpm):.0f} rpm. What the {driven} "
            "needs is found with a cord round a pulley on the motor's shaft and a spring balance, force times radius; "
            "the torque curve of the motor, for the voltage of G2, must show at least twice that at this speed. If it "
            "does not, lower `step_rate_hz` to a speed where it does: the highest speed of each job falls with it.",
            "Never plug the motor in or out under power: it destroys the driver.",
        )
    )


def _hurry(machine: HobbingMachine) -> Iterator[str]:
    """What is said where the step rate asks more of a step motor than such motors can do."""
    if hurries(machine):
        yield (
            f"**A step motor has little torque above {EASY_MOTOR} rpm, which are {easy_rate(machine)} of the "
            f"{machine.max_step_rate} steps/s of this file.** Write `step_rate_hz = {easy_rate(machine)}` unless the "
            "torque curve of the motor says more, or take a drive of closed loop or a servo; `gearmath gearbox plan` "
            "gives the speed of the motor in a job."
        )


def scope(machine: HobbingMachine) -> Iterator[str]:
    """What STEP and DIR look like on an oscilloscope."""
    high, low, setup, hold = (ticks * machine.tick_ns / 1000 for ticks in machine.timing_ticks)
    step = "low" if machine.step_active_low else "high"
    at = f"pins {machine.pins.step_out} and {machine.pins.dir_out} of the board"
    yield "### STEP and DIR on an oscilloscope"
    yield ""
    unit = "mm" if machine.profile == "lathe" else "degrees"
    way = 10 * machine.motor_steps / (machine.lead_screw_pitch if machine.profile == "lathe" else 360)
    # up with the acceleration, down with 15/16 of it
    peak = math.sqrt(machine.limits.acceleration_hz_per_s * float(way) * 2 * 15 / 31)
    rest = f"A logic analyzer does as well. Motor power off, jog armed, one detent at a time of 10 {unit}."
    yield from paragraph(f"Probes on {at}, ground at its GND. {rest}")
    rows = [
        ("STEP", f"{step} for {high:g} us, then the other level for {low:g} us at least"),
        ("DIR", f"changes {setup:g} us at least before the first pulse, and {hold:g} us at least after the last one"),
        ("levels", "0 V and 3.3 V; at the driver, behind a transistor, 5 V and below 0.4 V, and upside down"),
        ("jog", f"intervals fall to {1e6 / min(machine.move_max_rate, peak):.0f} us and rise again: a ramp, no jump"),
    ]
    yield from table(("signal", "must be"), rows)
