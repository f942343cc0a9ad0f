"""Machine files of a gearbox with one thing wrong: the refusal names file, key, value and limit."""

import pytest

from gearmath.errors import InputError
from gearmath.specs.hobbing import HobbingMachine
from gearmath.specs.toml import bundled, parse

HOBBER, HELICAL, LATHE = (
    bundled(f"{name}.toml").read_text("utf-8") for name in ("hobbing_default", "hobbing_helical", "lathe_example")
)
NAME, FEED = 'name = "Hobbing machine with all its guards"', '[feed]\ncounts_per_mm = 1000\ncounts_up = "climb"\n'
ENCODER = '[encoder]\nlines = 1024\ndecoder = "ls7184_x4"\nhysteresis = 1\n'
COARSE = HOBBER.replace("lines = 1024", "lines = 10")
TWO_RATES = "step_rate_hz = 80000.0\nmove_rate_hz = 8000.0"
COUNTER = "encoder.counter = 'hardware'; decoder = 'interrupts'"
FRACTION = "between 1/1000 and 10000"

WRONG = [
    # missing
    (HOBBER, NAME, "", "name: the key is missing"),
    (HOBBER, 'board = "teensy32"\n', "", "board: the key is missing"),
    (HOBBER, ENCODER, "", "encoder: the section [encoder] is missing"),
    (HOBBER, "lines = 1024\n", "", "encoder.lines: the key is missing"),
    (HOBBER, "full_steps = 200\n", "", "table: a step motor needs full_steps and microsteps; microsteps = 4"),
    (HOBBER, 'belt = "2/1"\n', "", "table.belt: the key is missing"),
    (HOBBER, "worm = 10\n", "", "table.worm: the key is missing"),
    (HOBBER, 'name = "dm542"\n', "", "driver: name is missing; step_high_ns"),
    (HOBBER, 'step_active = "low"\n', "", "driver.step_active: the key is missing"),
    (HOBBER, "hob_rpm = 800.0\n", "", "limits: hob_rpm is missing"),
    (HOBBER, "lag_steps = 100\n", "", "limits.lag_steps: the key is missing"),
    (HOBBER, "lag_steps = 100", "lag_mm = 1", "limits.lag_mm = 1: no such key; limits.lag_steps is missing"),
    (HOBBER, "module = 0.5\n", "", "hobs #1: a hob needs exactly one of module; 0.1 to 25 mm"),
    (HOBBER, 'depth_rule = "2.25m"\n', "", "hobs #1.depth_rule: the key is missing"),
    (HELICAL, "feed_step = 10\n", "", "pins.feed_step: the key is missing; 0 to 54"),
    (HELICAL, 'counts_up = "climb"\n', "", "feed.counts_up: the key is missing"),
    (LATHE, "spindle_rpm = 1000.0\n", "", "limits: hob_rpm is missing; spindle_rpm"),
    (LATHE, 'pitch = "8tpi"\n', "", "lead_screw.pitch: the key is missing"),
    # misspelt, twice, in wrong brackets
    (HOBBER, "board =", "bord =", "bord: no such key; did you mean board"),
    (HOBBER, "[table]", "[tabel]", "tabel: no such key; did you mean table"),
    (HOBBER, "estop = 11", "estpo = 11", "pins.estpo: no such key; did you mean estop"),
    (HOBBER, "worm = 10", 'worm = 10\npitch = "2mm"', "table.pitch = '2mm': no such key"),
    (HOBBER, "lines = 1024", "lines = 1024\nlines = 9", "line 11; 'lines' stands a second time; lines = 9"),
    (HOBBER, "[table]", "[encoder]", "line 15; section [encoder] stands a second time"),
    (HOBBER, "lines = 1024", "lines = 1024,5", "line 10; 1024,5 has a decimal comma"),
    (HOBBER, "[encoder]", "[[encoder]]", "encoder; write [encoder] in single brackets"),
    (HELICAL.split("[[hobs]]")[0], "[limits]", "[hobs]\nmodule = 1.0\n[limits]", "hobs: is one table; write [[hobs]]"),
    (HOBBER, "[[hobs]]", "[hobs]", "line 48; [[hobs]]; double brackets"),
    # of the wrong kind
    (HOBBER, NAME, "name = 5", "name = 5: must be text in quotes"),
    (HOBBER, '"teensy32"', "32", "board = 32: must be; 'teensy41'"),
    (HOBBER, "hob_starts = 1", "hob_starts = 1.5", "hob_starts = 1.5: must be a whole number"),
    (HOBBER, "lines = 1024", 'lines = "1024"', "encoder.lines = '1024': must be a whole number"),
    (HOBBER, "lines = 1024", "lines = 1024\ninvert = 1", "encoder.invert = 1: must be true or false"),
    (HOBBER, "lines = 1024", "lines = 1024\nbelt = 0.5", f"encoder.belt = 0.5: must be a whole number; {FRACTION}"),
    (HOBBER, 'belt = "2/1"', "belt = true", f"table.belt = true: must be a whole number; {FRACTION}"),
    (HOBBER, 'belt = "2/1"', 'belt = "2:1"', f"table.belt = '2:1': must be a whole number; {FRACTION}"),
    (HOBBER, "worm = 10", 'worm = 10\nbacklash = "1"', "table.backlash = '1': must be a number"),
    (HOBBER, 'step_active = "low"', "step_active = 0", "driver.step_active = 0: must be 'high' or 'low'"),
    (HOBBER, "estop = 11", 'estop = "11"', "pins.estop = '11': must be a whole number"),
    (HOBBER, "address = 0x27", 'address = "0x27"', "display.address = '0x27': must be a whole number"),
    (HOBBER, "lag_steps = 100", "lag_steps = 100.5", "limits.lag_steps = 100.5: must be a whole number"),
    (LATHE, 'pitch = "8tpi"', "pitch = 3", "lead_screw.pitch = 3: must be a pitch; between 0.01 mm and 100 mm"),
    # out of range
    (HOBBER, NAME, 'name = ""', "name = '': must not be empty"),
    (HOBBER, NAME, f'name = "{"a" * 61}"', "name = 'aaa; at most 60 characters"),
    (HOBBER, '"teensy32"', '"uno"', "board = 'uno': must be; 'teensy32'"),
    (HOBBER, "hob_starts = 1", "hob_starts = 11", "hob_starts = 11: must be at most 10"),
    (HOBBER, '"right"', '"up"', "hob_hand = 'up': must be 'right' or 'left'"),
    (HOBBER, "lines = 1024", "lines = 0", "encoder.lines = 0: must be at least 1"),
    (HOBBER, "lines = 1024", "lines = 2000000", "encoder.lines = 2000000: must be at most 1000000"),
    (HOBBER, "lines = 1024", 'lines = 1024\nbelt = "3/0"', f"encoder.belt = '3/0'; division by 0; {FRACTION}"),
    (HOBBER, "lines = 1024", 'lines = 1024\nbelt = "0/1"', "encoder.belt = '0/1'; between 1/1000 and 10000"),
    (HOBBER, '"ls7184_x4"', '"ls7184_x3"', "encoder.decoder = 'ls7184_x3': must be; 'interrupts'"),
    (HOBBER, "hysteresis = 1", "hysteresis = 17", "encoder.hysteresis = 17: must be at most 16"),
    (HOBBER, "microsteps = 4", "microsteps = 2000", "table.microsteps = 2000: must be at most 1024"),
    (HOBBER, "worm = 10", "worm = 20000", "table.worm = 20000; between 1/1000 and 10000"),
    (HOBBER, "worm = 10", "worm = 10\nbacklash = 6.0", "table.backlash = 6.0: must be at most 5"),
    (HELICAL, "counts_per_mm = 1000", "counts_per_mm = 0.5", f"feed.counts_per_mm = 0.5; {FRACTION}"),
    (HELICAL, '"climb"', '"up"', "feed.counts_up = 'up': must be 'climb' or 'conventional'"),
    (HOBBER, 'name = "dm542"', 'name = "dm999"', "driver.name = 'dm999'; known are; cl57t"),
    (HOBBER, "estop = 11", "estop = 40", "pins.estop = 40: board teensy32; 0 to 33"),
    (HOBBER, "estop = 11", "estop = -1", "pins.estop = -1: must be at least 0"),
    (HOBBER, "estop = 11", "sda = 4", "pins.sda = 4: must be 18"),
    (HOBBER, "address = 0x27", "address = 0x50", "display.address = 0x50; 0x20 to 0x27"),
    (HOBBER, '"pcf8574"', '"lcd"', "display.kind = 'lcd': must be; 'adafruit292'"),
    (HOBBER, "hob_rpm = 800.0", "hob_rpm = 0.0", "limits.hob_rpm = 0.0: must be at least 1"),
    (HOBBER, "hob_rpm = 800.0", "hob_rpm = nan", "limits.hob_rpm = nan: must be a finite number"),
    (HOBBER, "= 40000.0", "= 5.0", "limits.step_rate_hz = 5.0: must be at least 10"),
    (HOBBER, "= 40000.0", "= 1e9", "limits.step_rate_hz = 1000000000.0: must be at most 1000000"),
    (HOBBER, "= 8000.0", "= 1e8", "limits.acceleration_hz_per_s = 100000000.0: must be at most 10000000"),
    (HOBBER, "lag_steps = 100", "lag_steps = 100\nrun_up_s = -1.0", "limits.run_up_s = -1.0: must be at least 0"),
    (HOBBER, "module = 0.5", "module = 1e-9", "hobs #1.module = 1e-09: must be at least 0.1"),
    (HOBBER, "module = 0.5", "module = 0.12345", "hobs #1.module = 0.12345; four decimals"),
    (HOBBER, "module = 0.5", "diametral_pitch = 300.0", "hobs #1.diametral_pitch = 300.0: must be at most 254"),
    (LATHE, 'pitch = "8tpi"', 'pitch = "3/0mm"', "lead_screw.pitch = '3/0mm'; between 0.01 mm and 100 mm"),
    (LATHE, 'pitch = "8tpi"', 'pitch = "200mm"', "lead_screw.pitch = '200mm'; between 0.01 mm and 100 mm"),
    # contradicting another key
    (HOBBER, "lines = 1024", "lines = 9000", "limits.hob_rpm = 800; 480000 edges/s; 100000; at most 166 rpm"),
    (HOBBER, 'decoder = "ls7184_x4"\nhysteresis = 1', 'decoder = "interrupts"\ncounter = "hardware"', COUNTER),
    (HOBBER, "microsteps = 4", "microsteps = 4\npulses = 800", "table; full_steps = 200, microsteps = 4, pulses = 800"),
    (HELICAL, FEED, "", "pins.feed_step = 10: has no meaning without [feed]"),
    (HOBBER, 'name = "dm542"', 'name = "dm542"\nstep_high_ns = 9', "driver.name = 'dm542' and step_high_ns = 9"),
    (
        HOBBER,
        'step_active = "low"',
        'step_active = "low"\nenable_active = "low"',
        "driver.enable_active = 'low'; 'high'",
    ),
    (HOBBER, "estop = 11", "estop = 9", "pins.estop = 9: the pin is already that of index"),
    (HOBBER, "estop = 11", "reset = 11", "pins.reset = 11; pins.alarm"),
    (HOBBER, "hob_rpm = 800.0", "hob_rpm = 2000.0", "limits.hob_rpm = 2000; 136534 edges/s; 100000; at most 1464 rpm"),
    (HOBBER, "hob_rpm = 800.0", "hob_rpm = 8.0\nspindle_rpm = 9.0", "limits.hob_rpm = 8.0 and spindle_rpm = 9.0"),
    # 24 teeth at 80 rpm: 80/60 x 16000/24 = 888.9 steps/s
    (HOBBER, "= 40000.0", "= 10.0", "limits.step_rate_hz = 10; 889 steps/s at 80 rpm; limits.hob_rpm; fewer"),
    (HOBBER, "= 40000.0", "= 888.0", "limits.step_rate_hz = 888; at least 889"),
    # 1 mm at 100 rpm: 100/60 x 4800/3.175 = 2519.7 steps/s
    (LATHE, TWO_RATES, "step_rate_hz = 2519.0", "limits.step_rate_hz = 2519; at least 2520; limits.spindle_rpm"),
    (HOBBER, "lag_steps = 100", "lag_steps = 100\nmove_rate_hz = 50000.0", "limits.move_rate_hz = 50000; = 40000"),
    (HOBBER, 'name = "dm542"', 'name = "tb6560"', "limits.step_rate_hz = 40000; tb6560; at most"),
    (HOBBER, "= 8000.0", "= 199.0", "limits.acceleration_hz_per_s = 199; 2000 steps/s; 10 s; at least 200"),
    (HOBBER, "= 8000.0", "= 66.0\nmove_rate_hz = 99.0", "limits.acceleration_hz_per_s = 66; 40000; 600 s; at least 67"),
    (HOBBER, "lag_steps = 100", "lag_steps = 16000", "limits.lag_steps = 16000; turn of the table; less than 16000"),
    # 16000/24 steps a hob turn over 40 counts: 16.7
    (COARSE, "lag_steps = 100", "lag_steps = 17", "limits.lag_steps = 17; up to 17 steps; at least 18"),
    (COARSE, "hysteresis = 1", "hysteresis = 11", "encoder.hysteresis = 11; 40 counts; at most 10"),
    (HOBBER, "module = 0.5", "module = 0.5\ndiametral_pitch = 32.0", "hobs #1.module = 0.5 and diametral_pitch = 32"),
    (HOBBER, "module = 0.5", "module = 1.0", "hobs #2: hob m1 stands in the list more than once"),
    (HOBBER, '"2.25m"', '"2.25/P"', "hobs #1.depth_rule = '2.25/P'; module = 0.5; use one of 2.25m"),
    (LATHE, 'profile = "lathe"\n', "", "table: the section [table] is missing; profile = 'hobbing'"),
    (LATHE, "[limits]", '[[hobs]]\nmodule = 1.0\ndepth_rule = "2.25m"\n[limits]', "hobs: [hobs]; profile = 'lathe'"),
    (LATHE, 'profile = "lathe"', 'profile = "lathe"\nhob_starts = 2', "hob_starts = 2; profile = 'lathe'"),
    (LATHE, 'pitch = "8tpi"', 'pitch = "8tpi"\nbacklash = 4.0', "lead_screw.backlash = 4; 3.175 mm"),
    (LATHE, "spindle_rpm = 1000.0", "spindle_rpm = 9000.0", "limits.spindle_rpm = 9000; 400000; at most 6000 rpm"),
]


@pytest.mark.parametrize(("text", "old", "new", "words"), WRONG)
def test_refusal_names_file_key_value_and_limit(text: str, old: str, new: str, words: str) -> None:
    assert old in text
    with pytest.raises(InputError) as caught:
        parse(text.replace(old, new, 1), HobbingMachine, "mill.toml")
    message = str(caught.value)
    assert message.startswith("mill.toml: ")
    assert "\n" not in message
    for word in words.split("; "):
        assert word in message


@pytest.mark.parametrize("text", [HOBBER, HELICAL, LATHE])
def test_limits_themselves_are_accepted(text: str) -> None:
    """What a refusal proposes as the limit is no fault."""
    for old, new in (
        ("acceleration_hz_per_s = 8000.0", "acceleration_hz_per_s = 200.0"),
        ("step_rate_hz = 40000.0", "step_rate_hz = 889.0"),
        ("lag_steps = 100", "lag_steps = 15999"),
        (TWO_RATES, "step_rate_hz = 2520.0"),
        ("spindle_rpm = 1000.0", "spindle_rpm = 6000.0"),
    ):
        if old in text:
            parse(text.replace(old, new, 1), HobbingMachine, "mill.toml")
