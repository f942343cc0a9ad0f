"""``gm_machine.h``: everything the portable firmware knows of one machine, as whole numbers.

Each macro has a sentence and a unit; there is no floating constant, no date and no path. The names are the contract
with the files in ``gearmath/export/firmware``.
"""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction

from derivations import notation
from gearmath.errors import InputError
from gearmath.export.header import comment, plain, versions
from gearmath.specs.counters import Counter
from gearmath.specs.hob import DEPTH_RULES
from gearmath.specs.hobbing import HobbingMachine

Macro = tuple[str, int, str]

_TYPES = """\
#include <stdint.h>

/* Remainders and denominators of the step rule. */
typedef {wide} gm_wide;

enum {{ GM_INCH = 0, GM_MM = 1 }};
enum {{ {rules} }};

/* One hob: unit of its gears, rule for the whole depth of its teeth, 10000 x diametral pitch or 10000 x module [mm]. */
typedef struct {{
  uint8_t unit;
  uint8_t depth_rule;
  int32_t size;
}} gm_hob;
"""
#: The names of DEPTH_RULES in C.
_RULES = {
    "2.25/P": "GM_DEPTH_225_P",
    "2.157/P": "GM_DEPTH_2157_P",
    "2.2/P+0.002in": "GM_DEPTH_22_P",
    "2.25m": "GM_DEPTH_225_M",
}


def machine_header(machine: HobbingMachine) -> str:
    """Text of ``gm_machine.h``. Raises InputError where a number of the machine is beyond the kernels' domain."""
    name = plain(machine.name).replace('"', "'")
    head = comment(["gm_machine.h: generated, do not edit.", "", machine.name, "", f"written by {versions()}"])
    lines = [f'#define GM_NAME "{name}"', ""]
    for title, macros in _sections(machine):
        lines += [
            f"/* --- {title} */",
            *(f"#define {macro} {value} /* {plain(text)} */" for macro, value, text in macros),
        ]
        lines.append("")
    rules = ", ".join(f"{_RULES[rule]} = {k}" for k, rule in enumerate(DEPTH_RULES))
    types = _TYPES.format(wide="int64_t" if machine.wide else "int32_t", rules=rules)
    return (
        f"{head}#ifndef GM_MACHINE_H\n#define GM_MACHINE_H\n\n{types}\n"
        + "\n".join(lines)
        + _hobs(machine)
        + "\n#endif\n"
    )


def _sections(machine: HobbingMachine) -> Iterator[tuple[str, list[Macro]]]:
    yield "the board", _board(machine)
    yield "the train", _train(machine)
    yield "the driver", _driver(machine)
    yield "limits", _limits(machine)
    yield "what is wired", _wired(machine)
    yield (
        "pins",
        [(f"GM_PIN_{name.upper()}", number, pin_sentence(machine, name)) for name, number in machine.pins.used()],
    )


def _board(machine: HobbingMachine) -> list[Macro]:
    chip = {"adafruit292": "MCP23008", "pcf8574": "PCF8574"}[machine.display.kind]
    return [
        (f"GM_BOARD_TEENSY_{machine.board.removeprefix('teensy')}", 1, machine.hardware.title),
        ("GM_TICK_NS", machine.tick_ns, "ns, period of the step timer"),
        (f"GM_DISPLAY_{machine.display.kind.upper()}", 1, f"backpack with an {chip}"),
        ("GM_DISPLAY_ADDRESS", machine.display.i2c_address, "I2C address of the backpack"),
    ]


def _train(machine: HobbingMachine) -> list[Macro]:
    lathe = machine.profile == "lathe"
    driven = "lead screw of a lathe" if lathe else "work table of a hobbing machine"
    counts, steps, starts = (
        _checked(machine, quantity) for quantity in (notation.encoder_counts, notation.motor_steps, notation.hob_starts)
    )
    macros = [
        (f"GM_PROFILE_{machine.profile.upper()}", 1, f"the motor turns the {driven}"),
        (
            "GM_ENCODER_COUNTS",
            machine.encoder.counts_per_shaft,
            "encoder counts per turn of its shaft, after the decoder",
        ),
        ("GM_TURN_COUNTS", counts.numerator, "encoder counts per turn of the hob, numerator"),
        ("GM_TURN_COUNTS_DEN", counts.denominator, "and denominator"),
        ("GM_MOTOR_STEPS", steps.numerator, f"motor steps per turn of the {driven}, numerator"),
        ("GM_MOTOR_STEPS_DEN", steps.denominator, "and denominator"),
        ("GM_HOB_STARTS", int(starts), notation.hob_starts.description),
        ("GM_HOB_LEFT", int(machine.hob_hand == "left"), "1: left-hand hob"),
        ("GM_BACKLASH_STEPS", machine.drive.backlash_steps, "motor steps of play that are taken up"),
        ("GM_HYSTERESIS", machine.encoder.hysteresis, "counts of play of the hob encoder"),
        ("GM_WIDE", int(machine.wide), "0: gm_wide is int32_t, 1: int64_t"),
    ]
    if machine.feed is not None:
        macros += [
            *_fraction("GM_FEED_COUNTS", machine.feed_counts, "counts of the feed encoder per mm"),
            ("GM_FEED_CLIMBS", int(machine.feed_climbs), "1: counts of the feed go up in climb hobbing"),
        ]
    if lathe:
        per_mm = machine.motor_steps / machine.lead_screw_pitch
        macros += _fraction("GM_SCREW_STEPS", per_mm, "motor steps per mm of the carriage")
    return macros


def _fraction(macro: str, value: Fraction, text: str) -> list[Macro]:
    return [
        (f"{macro}_NUM", value.numerator, f"{text}, numerator"),
        (f"{macro}_DEN", value.denominator, "and denominator"),
    ]


def _driver(machine: HobbingMachine) -> list[Macro]:
    high, low, setup, hold = machine.timing_ticks
    return [
        ("GM_STEP_HIGH_TICKS", high, "ticks of a step pulse"),
        ("GM_STEP_LOW_TICKS", low, "ticks of pause after it, at least"),
        ("GM_DIR_SETUP_TICKS", setup, "ticks from DIR to the pulse, at least"),
        ("GM_DIR_HOLD_TICKS", hold, "ticks from the pulse to DIR, at least"),
        ("GM_STEP_ACTIVE_LOW", int(machine.step_active_low), "1: the pin is low during a step"),
        ("GM_DIR_ACTIVE_LOW", int(machine.dir_active_low), "1: the pin is low for forward"),
        ("GM_DIR_INVERT", int(machine.driver.invert_direction), "1: the motor is to turn the other way"),
        ("GM_ENABLE_ACTIVE_LOW", int(machine.enable_active_low), "1: the pin is low while the driver is enabled"),
    ]


def _limits(machine: HobbingMachine) -> list[Macro]:
    return [
        ("GM_MAX_LAG", machine.limits.lag_steps, "steps that may wait"),
        ("GM_MAX_EDGE_RATE", machine.max_edge_rate, "edges/s at the highest speed of the hob"),
        ("GM_MAX_STEP_RATE", machine.max_step_rate, "steps/s while the motor follows, at most"),
        ("GM_ACCELERATION", int(machine.limits.acceleration_hz_per_s), "steps/s^2 while the motor follows"),
        ("GM_MOVE_MAX_RATE", machine.move_max_rate, "steps/s of a jog or an index move"),
        ("GM_MOVE_ACCELERATION", int(machine.limits.acceleration_hz_per_s), "steps/s^2 of a jog or an index move"),
    ]


def _wired(machine: HobbingMachine) -> list[Macro]:
    pins = machine.pins
    return [
        (
            "GM_DECODER_LS7184",
            int(machine.encoder.has_ls7184),
            "1: pulse and direction, 0: channels A and B",
        ),
        *_counter("HOB", machine.hob_counter, machine.counter_filter(machine.max_edge_rate)[0]),
        *_counter("FEED", machine.feed_counter, machine.counter_filter(machine.hardware.highest_edge_rate)[0]),
        ("GM_HAS_INDEX", int(pins.index is not None), "index pulse of the hob"),
        ("GM_HAS_FEED", int(machine.feed is not None), "encoder of the axial feed"),
        ("GM_HAS_ENABLE", int(pins.enable is not None), "enable output of the driver"),
        ("GM_HAS_ESTOP", int(pins.estop is not None), "emergency stop input"),
        ("GM_ENCODER_INVERT", int(machine.encoder.invert), "1: counts go down as the hob turns forward"),
        ("GM_INDEX_ACTIVE_LOW", int(machine.encoder.index_active == "low"), "1: the index pulse is low"),
        ("GM_HAS_ALARM", int(pins.alarm is not None), "alarm input of the driver"),
        ("GM_ALARM_ACTIVE_LOW", int(machine.driver.alarm_active == "low"), "1: the pin is low during an alarm"),
        ("GM_HAS_RESET", int(pins.reset is not None), "reset output to the driver"),
        ("GM_HAS_HEALTHY", int(pins.healthy is not None), "fail-safe output"),
    ]


def _counter(axis: str, reached: Counter | None, filter_value: int) -> list[Macro]:
    """The counter of an encoder: its number, or 0 for interrupts, and how its pins are connected with it."""
    macros: list[Macro] = [
        (f"GM_{axis}_COUNTER", reached.unit if reached else 0, "number of the board's counter, 0: interrupts count")
    ]
    if reached is not None:
        for k, channel in enumerate("AB"):
            macros.append((f"GM_{axis}_MUX_{channel}", reached.mux[k], "multiplexer of that pin"))
            if reached.crossbar[k]:
                macros.append((f"GM_{axis}_CROSSBAR_{channel}", reached.crossbar[k], "input of the crossbar"))
                macros.append((f"GM_{axis}_DAISY_{channel}", reached.daisy[k], "pad of that input"))
        macros.append((f"GM_{axis}_FILTER", filter_value, "setting of the counter's filter"))
    return macros


_PIN_SENTENCES = {
    "knob_a": "knob, channel A",
    "knob_b": "knob, channel B",
    "button": "button of the knob, to ground",
    "encoder_step": "hob encoder: {first}",
    "encoder_dir": "hob encoder: {second}",
    "dir_out": "DIR to the driver",
    "step_out": "STEP to the driver",
    "sda": "display, data",
    "scl": "display, clock",
    "index": "index pulse of the hob",
    "feed_step": "feed encoder: {first}",
    "feed_dir": "feed encoder: {second}",
    "enable": "enable of the driver",
    "estop": "emergency stop, normally closed to ground",
    "alarm": "alarm output of the driver, with a pull-up in the board",
    "reset": "reset of the driver, high for 0.2 s when its alarm is acknowledged",
    "healthy": "fail-safe output, a square wave of 1 kHz while all is well",
}


def pin_sentence(machine: HobbingMachine, name: str) -> str:
    """What hangs on a pin of this machine; the README's table says the same."""
    chip = machine.encoder.has_ls7184
    first, second = ("pulse of its LS7184", "direction of its LS7184") if chip else ("channel A", "channel B")
    return _PIN_SENTENCES[name].format(first=first, second=second)


def _hobs(machine: HobbingMachine) -> str:
    """The hobs, in the order of the file; a lathe has none."""
    if not machine.hobs:
        return "#define GM_HOBS 0\n"
    rows = "".join(
        f"  {{{'GM_INCH' if hob.unit == 'inch' else 'GM_MM'}, {_RULES[hob.depth_rule]}, {hob.size_tenthousandths}}},\n"
        for hob in machine.hobs
    )
    return f"#define GM_HOBS {len(machine.hobs)}\nstatic const gm_hob gm_hobs[GM_HOBS] = {{\n{rows}}};\n"


def _checked(machine: HobbingMachine, quantity: notation.Quantity) -> Fraction:
    """The value of a quantity of the machine that is in the domain of the kernels."""
    value = Fraction(getattr(machine, quantity.name))
    low, high = quantity.domain
    if not low <= value <= high:
        raise InputError(f"{machine.name}: {quantity.name} = {value}: the kernels take {low} to {high}")
    return value
