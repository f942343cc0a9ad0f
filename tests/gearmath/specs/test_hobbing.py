"""The machine file: the machines of the source text, the lathe, and what is refused when a file is read."""

from fractions import Fraction

import pytest

from gearmath.errors import InputError
from gearmath.specs.hobbing import HobbingMachine, load_hobbing_machine
from gearmath.specs.toml import bundled, parse

PLEWES, HELICAL, LATHE = (
    bundled(name).read_text("utf-8") for name in ("hobbing_plewes.toml", "hobbing_helical.toml", "lathe_example.toml")
)


def changed(text: str, old: str, new: str) -> HobbingMachine:
    assert old in text
    return parse(text.replace(old, new, 1), HobbingMachine, "machine.toml")


def test_bundled_machine_is_the_one_of_the_source_text():
    machine = load_hobbing_machine(bundled("hobbing_plewes.toml"))
    assert (machine.encoder_counts, machine.motor_steps, machine.hob_starts) == (4096, 16000, 1)
    assert [hob.diametral_pitch for hob in machine.hobs] == [32, 36, 48, 60, 60.8, 64, 80, 105, 126, None]
    assert machine.hobs[-1].module == 1.0
    assert machine.hobs[-1].module_mm == 1.0
    assert (machine.profile, machine.board, machine.display.kind) == ("hobbing", "teensy32", "adafruit292")


def test_default_pins_are_the_wiring_of_the_source_text():
    """Knob on 2 and 3, its button on 4; LS7184 on 6 and 7; STEP 13, DIR 8; display on A4, A5, which are 18 and 19."""
    pins = dict(load_hobbing_machine(bundled("hobbing_plewes.toml")).pins.used())
    assert pins == {
        "knob_a": 2,
        "knob_b": 3,
        "button": 4,
        "encoder_step": 6,
        "encoder_dir": 7,
        "step_out": 13,
        "dir_out": 8,
        "sda": 18,
        "scl": 19,
    }


def test_second_bundled_machine_has_the_metric_hobs_of_the_second_example():
    machine = load_hobbing_machine(bundled("hobbing_metric.toml"))
    assert [hob.diametral_pitch for hob in machine.hobs][:8] == [32, 36, 48, 60, 64, 80, 105, 126]
    assert [hob.module for hob in machine.hobs][8:] == [0.5, 1.0, 1.5]
    assert [(hob.unit, hob.size_tenthousandths) for hob in machine.hobs[7:9]] == [("inch", 1_260_000), ("mm", 5000)]


@pytest.mark.parametrize(
    ("old", "new", "counts", "steps"),
    [
        ("worm = 10", "worm = 5", 4096, 8000),  # source text: "800 x 2 x 5"
        ("lines = 1024", "lines = 200", 800, 16000),  # source text: "200 x 4 = 800"
        ("microsteps = 4", "microsteps = 1", 4096, 4000),  # source text: "200 x 2 x 10 = 4000"
        ('"ls7184_x4"', '"ls7184_x1"', 1024, 16000),  # MODE pin at 0
        ('"ls7184_x4"', '"ls7184_x2"', 2048, 16000),  # MODE pin at 1
        ('"ls7184_x4"', '"hardware"', 4096, 16000),
        ('belt = "2/1"', 'belt = "127/50"', 4096, 20320),  # 800 x 2.54 x 10, exact
        ("worm = 10", 'worm = "1/3"', 4096, Fraction(1600, 3)),
        ("lines = 1024", 'lines = 1000\nbelt = "10/9"', Fraction(40_000, 9), 16000),  # 4444.44
        ("full_steps = 200\nmicrosteps = 4", 'pulses = "131072/10"', 4096, 262_144),  # a servo of 17 bits, geared 1:10
    ],
)
def test_drive_trains_of_the_source_text(old, new, counts, steps):
    machine = changed(PLEWES, old, new)
    assert (machine.encoder_counts, machine.motor_steps) == (counts, steps)


def test_rationals_are_exact():
    machine = parse(PLEWES.replace("worm = 10", 'worm = "355/113"').replace('"2/1"', "113"), HobbingMachine, "f")
    assert machine.table.worm == Fraction(355, 113)
    assert machine.motor_steps == 800 * 355


def test_lathe_has_its_screw_exactly():
    machine = load_hobbing_machine(bundled("lathe_example.toml"))
    assert machine.lead_screw_pitch == Fraction(127, 40)  # 25.4 mm / 8
    assert (machine.encoder_counts, machine.motor_steps, machine.limits.hob_rpm) == (4000, 4800, 1000.0)
    assert changed(LATHE, '"8tpi"', '"1.25mm"').lead_screw_pitch == Fraction(5, 4)
    assert changed(LATHE, '"8tpi"', '"23/2tpi"').lead_screw_pitch == Fraction(254, 115)


def test_numbers_for_the_firmware():
    machine = load_hobbing_machine(bundled("hobbing_plewes.toml"))
    assert (machine.tick_ns, machine.timing_ticks) == (5000, (2, 2, 2, 2))
    assert (machine.step_active_low, machine.dir_active_low, machine.enable_active_low) == (False, False, False)
    assert machine.max_edge_rate == 54_614  # 800/60 x 4096 = 54613.3
    assert (machine.max_step_rate, machine.move_max_rate) == (40_000, 2000)
    faster = changed(PLEWES, '"teensy32"', '"teensy41"')
    assert (faster.tick_ns, faster.timing_ticks) == (2000, (5, 5, 5, 5))


def test_two_axes_or_a_fine_screw_need_64_bits():
    assert not load_hobbing_machine(bundled("hobbing_plewes.toml")).wide  # 999 x 4096 is far below 2^30
    assert not changed(PLEWES, "lines = 1024", "lines = 1875").wide
    helical = load_hobbing_machine(bundled("hobbing_helical.toml"))
    assert helical.wide
    assert (helical.feed_counts, helical.feed_climbs) == (1000, True)
    assert not load_hobbing_machine(bundled("lathe_example.toml")).wide
    assert changed(LATHE, '"8tpi"', '"999983/99991mm"').wide


BAD = [
    (PLEWES, "worm = 10", 'worm = "999983/999979"', ("table", "1599972800/999979", "1073741824")),
    (PLEWES, "microsteps = 4", "microsteps = 4\npulses = 1000", ("table", "servo needs pulses")),
    (PLEWES, "microsteps = 4", "", ("table", "full_steps and microsteps")),
    (PLEWES, "lines = 1024", 'lines = 9999\nbelt = "1000/997"', ("encoder.lines = 9999", "at most 9970 lines")),
    (PLEWES, "worm = 10", "worm = 10.5", ("table.worm", "10.5", "fraction")),
    (PLEWES, "worm = 10", "worm = true", ("table.worm", "true", "whole number")),
    (PLEWES, "worm = 10", 'worm = "1/0"', ("table.worm", "1/0", "fraction")),
    (PLEWES, "worm = 10", 'worm = "1000003/999983"', ("table.worm", "1000000")),
    (PLEWES, "worm = 10", "worm = 0", ("table.worm", "0", "between")),
    (PLEWES, "worm = 10", "worm = 9999", ("table", "15998400", "10000000")),
    (PLEWES, 'decoder = "ls7184_x4"', "", ("encoder.decoder", "missing")),
    (PLEWES, '"ls7184_x4"', '"ls7184_x3"', ("encoder.decoder", "ls7184_x3", "'hardware'")),
    (PLEWES, '"ls7184_x4"', '"ls7184_x4"\nhysteresis = 17', ("encoder.hysteresis", "17", "16")),
    (PLEWES, "lines = 1024", "", ("encoder.lines", "missing")),
    (PLEWES, "lines = 1024", "lines = 0", ("encoder.lines", "0", "1")),
    (PLEWES, "lines = 1024", "lines = 1024\nwires = 2", ("encoder.wires", "2", "known")),
    (PLEWES, "lines = 1024", "lines = 10001", ("encoder.lines = 10001", "40004", "at most 10000 lines")),
    (PLEWES, "lines = 1024", "lines = 2000", ("limits.hob_rpm = 800", "106667", "100000", "at most 750 rpm")),
    (PLEWES, "worm = 10\n", 'worm = 10\n[feed]\ncounts_per_mm = 0.5\ncounts_up = "climb"\n', ("feed.counts_per_mm",)),
    (PLEWES, "worm = 10\n", 'worm = 10\n[feed]\ncounts_per_mm = 5\ncounts_up = "climb"\n', ("pins.feed_step",)),
    (PLEWES, "[pins]", "[pins]\nfeed_step = 9\nfeed_dir = 10", ("pins.feed_step", "[feed]")),
    (PLEWES, "hob_starts = 1", "hob_starts = 0", ("hob_starts", "0", "1")),
    (PLEWES, "module = 1.0", "module = nan", ("hobs #10.module", "nan", "finite")),
    (PLEWES, "module = 1.0", "module = 1.0\ndiametral_pitch = 32.0", ("hobs #10.module = 1", "diametral_pitch = 32")),
    (PLEWES, "module = 1.0", "", ("hobs #10", "exactly one")),
    # 200 x 4 microsteps a turn: 2 pi 1e7/800 = 78540 rad/s2; 50000 are 6366197 steps/s2
    (PLEWES, "acceleration_hz_per_s = 8000.0", "acceleration_hz_per_s = 1e7", ("78540 rad/s2", "at most 6366197")),
    (PLEWES, "module = 1.0", "module = 1.00001", ("hobs #10", "1.00001", "four decimals")),
    (PLEWES, "module = 1.0", "module = 1.0\ndiameter = 4.0", ("hobs #10", "diameter = 4", "five modules")),
    (PLEWES, '"2.25m"', '"2.25/P"', ("hobs #10", "2.25/P", "2.25m")),
    (PLEWES, '"2.25m"', '"2m"', ("hobs #10.depth_rule", "2m", "2.157/P")),
    (PLEWES, "= 36.0", "= 32.0", ("32dp", "more than once")),
    (PLEWES, "hob_rpm = 800.0", "hob_rpm = -1.0", ("limits.hob_rpm", "-1", "0")),
    (PLEWES, "step_rate_hz = 40000.0", "step_rate_hz = 50001.0", ("step_rate_hz = 50001", "unsure", "at most 50000")),
    (PLEWES, 'name = "unsure"', 'name = "tb6560"', ("step_rate_hz = 40000", "tb6560", "at most 3225")),
    (PLEWES, "acceleration_hz_per_s = 8000.0", "acceleration_hz_per_s = 199.0", ("199", "10 s", "at least 200")),
    (PLEWES, "acceleration_hz_per_s = 8000.0", "", ("limits.acceleration_hz_per_s", "missing")),
    (PLEWES, "lag_steps = 100", "lag_steps = 0", ("limits.lag_steps", "0", "1")),
    (PLEWES, "lag_steps = 100", "lag_steps = 100\nmove_rate_hz = 45000.0", ("move_rate_hz = 45000", "step_rate_hz")),
    (PLEWES, 'name = "unsure"', 'name = "m541"', ("driver", "m541", "known are", "m542")),
    (PLEWES, 'name = "unsure"\n', "", ("driver", "name of a driver", "step_high_ns")),
    (PLEWES, '"open_collector"', '"inverted"', ("driver.output", "inverted", "open_collector")),
    (PLEWES, "[pins]", "[pins]\nindex = 13", ("pins", "index = 13", "already that of step_out")),
    (PLEWES, "[pins]", "[pins]\nestop = 18", ("estop = 18", "sda")),
    (PLEWES, "[pins]", "[pins]\nestop = 34", ("pins.estop = 34", "teensy32", "0 to 33")),
    (PLEWES, "[pins]", "[pins]\nsda = 16", ("pins.sda", "16", "18")),
    (PLEWES, "[pins]", "[pins]\nbutton = -1", ("pins.button", "-1", "0")),
    (PLEWES, '"teensy32"', '"teensy35"', ("board", "teensy35", "teensy41")),
    (PLEWES, '"adafruit292"', '"adafruit292"\naddress = 0x39', ("display", "0x39", "0x20 to 0x27")),
    (PLEWES, 'board = "teensy32"', 'board = "teensy32"\nprofile = "lathe"', ("lead_screw",)),
    (HELICAL, "counts_per_mm = 1000", "counts_per_mm = 0", ("feed.counts_per_mm", "0", "between")),
    (HELICAL, 'counts_up = "climb"', "", ("feed.counts_up", "missing")),
    (LATHE, '"8tpi"', '"8 threads"', ("lead_screw.pitch", "8 threads", "23/2tpi")),
    (LATHE, '"8tpi"', '"0tpi"', ("lead_screw.pitch", "0tpi")),
    (LATHE, '"8tpi"', '"3/0mm"', ("lead_screw.pitch", "3/0mm")),
    (LATHE, '"8tpi"', '"101mm"', ("lead_screw.pitch", "100 mm")),
    (LATHE, "[pins]", "[pins]\nfeed_dir = 20", ("pins.feed_dir", "[feed]")),
    (LATHE, 'profile = "lathe"', 'profile = "lathe"\nhob_hand = "left"', ("hob_hand", "lathe")),
    (LATHE, 'profile = "lathe"\n', "", ("profile = 'hobbing'", "[table]")),
]


@pytest.mark.parametrize(("text", "old", "new", "words"), BAD)
def test_bad_input_is_refused_in_one_sentence(text, old, new, words):
    with pytest.raises(InputError) as caught:
        changed(text, old, new)
    message = str(caught.value)
    assert message.startswith("machine.toml: ")
    assert "\n" not in message
    for word in words:
        assert word in message


@pytest.mark.parametrize(
    "name", ['say \\"hello\\"', "back\\\\slash", "end */ here", "what??/", "Größe", "line\\nbreak", "a`b", "", " pad"]
)
def test_free_text_that_would_break_c_is_refused(name):
    with pytest.raises(InputError, match="name"):
        changed(PLEWES, "Hobbing machine of Digital Machinist 15-4", name)


def test_an_opto_coupler_between_transistor_and_motor_leaves_the_pin_active_high():
    """The source text writes STEP high, waits, writes it low, through a 2N2222 that pulls the input down."""
    assert not load_hobbing_machine(bundled("hobbing_plewes.toml")).step_active_low
    assert changed(PLEWES, '"open_collector"', '"direct"').step_active_low


# --- enable ---------------------------------------------------------------------------------------------------------


def _current(output: str, common: str, pin_high: bool) -> bool:
    """Whether current flows through the opto-coupler of an input: a transistor pulls its - terminal down while the pin
    is high; a pin itself lights it when high against ground, when low against the supply."""
    if output == "open_collector":
        return pin_high
    return pin_high if common == "ground" else not pin_high


@pytest.mark.parametrize("name", ["m542", "dm422", "dm542", "dm556", "cl57t", "hbs86h"])
@pytest.mark.parametrize(("output", "common"), [("open_collector", "+5 V"), ("direct", "+5 V"), ("direct", "ground")])
def test_enable_pin_leaves_the_opto_coupler_dark_whatever_the_wiring(name, output, common):
    """Leadshine: current through ENA switches the motor off; STEP counts when its own coupler is lit."""
    step = "high" if common == "ground" else "low"
    text = HELICAL.replace('name = "dm556"', f'name = "{name}"').replace('"open_collector"', f'"{output}"')
    text = text.replace('step_active = "low"', f'step_active = "{step}"').replace("index = 9", "index = 9\nenable = 12")
    machine = parse(text, HobbingMachine, "machine.toml")
    assert not _current(output, common, pin_high=not machine.enable_active_low)
    assert _current(output, common, pin_high=not machine.step_active_low)


def test_logic_inputs_of_the_chips_are_enabled_low():
    """Data sheets of A4988 (ENABLE), DRV8825 (nENBL), TMC2208 and TMC2209 (ENN): low switches the outputs on."""
    for name in ("a4988", "drv8825", "tmc2208", "tmc2209"):
        text = HELICAL.replace('name = "dm556"', f'name = "{name}"').replace('"open_collector"', '"direct"')
        text = text.replace('step_active = "low"', 'step_active = "high"').replace(
            "index = 9", "index = 9\nenable = 12"
        )
        assert parse(text, HobbingMachine, "machine.toml").enable_active_low, name


def test_no_bundled_machine_connects_enable():
    for name in ("hobbing_plewes.toml", "hobbing_metric.toml", "hobbing_helical.toml", "lathe_example.toml"):
        assert load_hobbing_machine(bundled(name)).pins.enable is None


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ('step_active = "low"', 'step_active = "low"\nenable_active = "low"', ("enable_active =", "off", "dm556")),
        ('name = "dm556"', 'name = "unsure"', ("pins.enable = 12", "driver.enable_active", "open")),
        ('name = "dm556"', "step_high_ns = 1\nstep_low_ns = 1\ndir_setup_ns = 1\ndir_hold_ns = 1", ("pins.enable",)),
    ],
)
def test_a_setting_that_would_hold_the_motor_off_is_refused(old, new, words):
    with pytest.raises(InputError) as caught:
        changed(HELICAL.replace("index = 9", "index = 9\nenable = 12"), old, new)
    for word in words:
        assert word in str(caught.value)


def test_unknown_driver_takes_the_level_of_the_file():
    text = HELICAL.replace('name = "dm556"', 'name = "unsure"').replace("index = 9", "index = 9\nenable = 12")
    for level, low in (("low", False), ("high", True)):  # a transistor turns the level round
        machine = changed(text, 'step_active = "low"', f'step_active = "low"\nenable_active = "{level}"')
        assert machine.enable_active_low == low


# --- counters of the board ------------------------------------------------------------------------------------------
HARDWARE, PULSES = ('"ls7184_x4"', '"hardware"'), ('"ls7184_x4"', '"ls7184_x4"\ncounter = "hardware"')


def with_changes(text: str, *pairs: tuple[str, str]) -> HobbingMachine:
    for old, new in pairs:
        assert old in text
        text = text.replace(old, new, 1)
    return parse(text, HobbingMachine, "m.toml")


@pytest.mark.parametrize(
    ("board", "pins", "unit", "mux"),
    [
        # Teensy 3.2: PTB0, PTB1 (ALT6) and PTA12, PTA13 (ALT7) are FTM1's, PTB18, PTB19 (ALT6) FTM2's phases
        ("teensy32", "", 1, (6, 6)),
        ("teensy32", "encoder_step = 32\nencoder_dir = 25", 2, (6, 6)),
        ("teensy40", "", 1, (3, 1)),
        ("teensy41", "encoder_step = 31\nencoder_dir = 30", 1, (1, 1)),
    ],
)
def test_encoder_is_led_to_a_counter_of_the_board(board, pins, unit, mux):
    machine = with_changes(PLEWES, HARDWARE, ('"teensy32"', f'"{board}"'), ("[pins]\n", f"[pins]\n{pins}\n"))
    assert machine.hob_counter is not None
    assert (machine.hob_counter.unit, machine.hob_counter.mux) == (unit, mux)


@pytest.mark.parametrize(
    ("pairs", "words"),
    [
        (
            (HARDWARE, ("[pins]\n", "[pins]\nencoder_step = 6\nencoder_dir = 7\n")),
            r"pins.encoder_step = 6 .* 16 and 17, 3 and 4, 32 and 25; or write decoder = \"interrupts\"",
        ),
        ((HARDWARE, ("[pins]\n", "[pins]\nencoder_step = 17\nencoder_dir = 16\n")), "in this order"),
        (
            (HARDWARE, ('"teensy32"', '"teensy40"'), ("[pins]\n", "[pins]\nencoder_step = 5\nencoder_dir = 0\n")),
            "but 0 with 5",
        ),
        ((('"ls7184_x4"', '"hardware"\ncounter = "hardware"'),), "counter = 'hardware': has no meaning"),
        ((PULSES, ("[pins]\n", "[pins]\nencoder_step = 6\nencoder_dir = 7\n")), "or leave counter out"),
    ],
)
def test_pins_that_reach_no_counter_are_refused_with_those_that_do(pairs, words):
    with pytest.raises(InputError, match=words):
        with_changes(PLEWES, *pairs)


def test_old_way_of_reading_channels_stays():
    machine = with_changes(PLEWES, ('"ls7184_x4"', '"interrupts"'))
    assert (machine.hob_counter, machine.encoder_counts, machine.pins.encoder_step) == (None, 4096, 6)


def test_filter_of_a_counter_passes_every_real_edge_at_the_highest_speed():
    """800 rpm x 4096 counts: 18.3 us between edges, half of it at the worst; at 36 MHz 15 x 4 clocks are 1.67 us."""
    for board, register, time in (("teensy32", 15, 1667), ("teensy40", 137, 4567)):
        machine = with_changes(PLEWES, HARDWARE, ('"teensy32"', f'"{board}"'))
        setting, filtered = machine.counter_filter(machine.max_edge_rate)
        assert (setting, round(filtered)) == (register, time)  # 137 x 5 / 150 MHz = 4567 ns
        assert filtered < 1e9 / machine.max_edge_rate / 2
        pulsed = with_changes(PLEWES, PULSES, ('"teensy32"', f'"{board}"'))
        assert pulsed.counter_filter(pulsed.max_edge_rate)[1] <= 250  # a pulse is 1 us at least


def test_a_hob_has_a_number_of_two_digits_on_the_display(tmp_path):
    sizes = "".join(f'[[hobs]]\nmodule = {1 + k / 1000}\ndepth_rule = "2.25m"\n' for k in range(100))
    text = PLEWES
    path = tmp_path / "many.toml"
    path.write_text(text[: text.index("[[hobs]]")] + sizes, "utf-8")
    with pytest.raises(InputError, match=r"hobs: the list has 100, at most 99 have a number on the display"):
        load_hobbing_machine(path)
