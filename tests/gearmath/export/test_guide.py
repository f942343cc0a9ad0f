"""The generated README: it says what this machine is, what its display shows, and nothing breaks it."""

from __future__ import annotations

import re
import tomllib
from fnmatch import fnmatch
from fractions import Fraction
from importlib import resources

import pytest

from gearmath.export.guide import guide
from gearmath.export.markdown import escaped
from gearmath.export.netlist import netlist
from gearmath.export.reservations import reservations
from gearmath.export.teensy import teensy_files
from gearmath.export.wiring import wiring_svg
from gearmath.gearbox.train import plan
from gearmath.specs.drive import Encoder, Feed
from gearmath.specs.drivers import Driver
from gearmath.specs.hobbing import HobbingMachine, Limits, load_hobbing_machine
from gearmath.specs.toml import bundled

MACHINES = (
    "hobbing_plewes",
    "hobbing_default",
    "hobbing_minimum",
    "hobbing_metric",
    "hobbing_helical",
    "lathe_example",
)


def machine(name: str) -> HobbingMachine:
    return load_hobbing_machine(bundled(f"{name}.toml"))


def screen() -> str:
    folder = resources.files("gearmath") / "export" / "firmware"
    return "".join((folder / name).read_text("utf-8") for name in ("gm_screen.c", "gm_draw.c", "gm_ui.c", "gm_gear.c"))


def test_every_file_of_the_folder_is_explained() -> None:
    text = guide(machine("hobbing_plewes"), "gearbox")
    listed = re.findall(r"`([\w.*]+)`", text[: text.index("## Flashing")])
    for name in (*teensy_files(machine("hobbing_plewes"), "gearbox"), "manifest.json"):
        assert name == "README.md" or any(fnmatch(name, pattern) for pattern in listed), name


@pytest.mark.parametrize("name", MACHINES)
def test_pin_table_is_that_of_the_machine(name: str) -> None:
    given = machine(name)
    rows = re.findall(r"^\| (\d+) \| `(\w+)` \|", guide(given, "gearbox"), flags=re.MULTILINE)
    assert {(key, int(number)) for number, key in rows} == set(given.pins.used())


@pytest.mark.parametrize("name", MACHINES)
def test_every_label_and_page_that_is_explained_exists_on_the_display(name: str) -> None:
    text = guide(machine(name), "gearbox")
    explained = re.findall(r"`([^`]+)`", text[text.index("## Commissioning") :])
    for label in (" ".join(words.split()) for words in explained):
        key = label.split(" = ")[0]  # of the machine file
        keys = {
            *Limits.model_fields,
            *Driver.model_fields,
            *Encoder.model_fields,
            *Feed.model_fields,
            "[encoder]",
            "[feed]",
        }
        known = key in keys or label == "gearmath gearbox plan"
        assert known or label in screen(), label


def test_every_number_on_the_display_is_explained() -> None:
    texts = "".join(guide(machine(name), "gearbox") for name in MACHINES)
    calls = re.findall(r"gm_(?:quantity|count|length|rpm|pitch)\(ui, [^,]+, ([^;]*?)\);", screen())
    labels = {label for call in calls for label in re.findall(r'"([A-Z][^"]+)"', call)}
    assert len(labels) > 20
    explain_themselves = {"RUNS", "Set limit", "Cable? off by"}
    assert {label for label in labels if f"`{label}`" not in texts} <= explain_themselves


@pytest.mark.parametrize("decoder", ["ls7184_x1", "ls7184_x2", "ls7184_x4"])
def test_mode_jumper_is_that_of_the_data_sheet_and_of_the_source_text(decoder: str) -> None:
    """Shorting pin 2 of the terminal to ground (pin 3) is x1, to 5 V (pin 1) x2, leaving it open x4."""
    base = machine("hobbing_plewes")
    text = guide(base.model_copy(update={"encoder": base.encoder.model_copy(update={"decoder": decoder})}), "gearbox")
    (jumper,) = re.findall(r"\*\*MODE, pin 6 of the LS7184N:\s(.*?)\*\*", text, flags=re.DOTALL)
    sought = {"ls7184_x1": "pins 2 and 3", "ls7184_x2": "pins 1 and 2", "ls7184_x4": "no jumper"}[decoder]
    assert sought in " ".join(jumper.split())
    assert f"{1024 * int(decoder[-1])} counts per turn" in text


def test_output_pulse_of_the_decoder_leaves_room_for_the_next_edge() -> None:
    # 800 rpm x 4096 counts = 54613.3 edges/s, half of the mean distance of 18.3 us
    assert "must stay below 9155 ns" in " ".join(guide(machine("hobbing_plewes"), "gearbox").split())


@pytest.mark.parametrize("name", MACHINES)
def test_every_part_of_the_drawing_is_in_the_list_of_parts(name: str) -> None:
    text, svg = guide(machine(name), "gearbox"), wiring_svg(machine(name))
    drawn = set(re.findall(r"\b(T\d|R\d|RB\d|C\d|K1|LS7184N|74LVC245|BSS138|LM7805)\b", svg))
    parts = text[text.index("## Parts") : text.index("## Wiring")]
    assert {part for part in drawn if part not in parts} == set()


def test_driver_gets_at_least_the_times_it_asks_for() -> None:
    rows = re.findall(r"\| (\d+) ns \| (\d+) ns \|", guide(machine("hobbing_helical"), "gearbox"))
    assert [int(asked) for asked, _ in rows] == [2500, 2500, 5000, 10_000]  # dm556 in LinuxCNC's table
    assert all(int(given) >= int(asked) for asked, given in rows)


@pytest.mark.parametrize("name", ["# x | `y` *z* <b>&", "a\n\n# second", "[link](http://x)", "back\\slash_under_"])
def test_free_text_means_nothing_to_markdown(name: str) -> None:
    text = guide(machine("hobbing_plewes").model_copy(update={"name": name}), "gearbox")
    assert text.count("\n# ") == 0
    (title,) = re.findall(r"^# Electronic gearbox: (.*)$", text, flags=re.MULTILINE)
    assert title == escaped(name)
    assert not re.search(r"(?<!\\)[`*_\[\]|#<]", title)


@pytest.mark.parametrize("name", MACHINES)
def test_tables_have_the_cells_of_their_heads(name: str) -> None:
    for block in re.findall(r"(?:^\|.*\n)+", guide(machine(name), "gearbox"), flags=re.MULTILINE):
        cells = {len(re.findall(r"(?<!\\)\|", line)) for line in block.splitlines()}
        assert len(cells) == 1, block


@pytest.mark.parametrize("name", MACHINES)
def test_list_of_parts_has_motor_supplies_fuses_and_sockets(name: str) -> None:
    """A fuse carries what the supply must give at most, and each is listed once; every DIP has a socket."""
    text = guide(machine(name), "gearbox")
    parts = text[text.index("## Parts") : text.index("## Wiring")]
    rows = {cells[0].strip(): cells[1] for line in parts.splitlines() if len(cells := line.split("|")[1:]) == 4}
    assert {"M1", "G1", "G2", "F1", "F2", "F3", "KM1", "XU1"} <= set(rows)
    milliamps = int(re.search(r"The parts take (\d+) mA", " ".join(parts.split()))[1])
    assert milliamps < int(re.search(r"fuse (\d+) mA", rows["F2"])[1]) <= 2 * milliamps
    dips = {part for part, what in rows.items() if "DIP-" in what and not what.startswith(" socket")}
    assert {f"X{part}" for part in dips} <= set(rows)


def chapter(text: str, title: str) -> str:
    """A chapter of the README on one line."""
    return " ".join(text.split(f"## {title}\n")[1].split("\n## ")[0].split())


@pytest.mark.parametrize("name", MACHINES)
def test_what_stops_the_machine_is_tried_before_anything_has_power(name: str) -> None:
    given = machine(name)
    steps = chapter(guide(given, "gearbox"), "Commissioning")
    powered = steps.index("Motor power on")
    assert ("`EMERGENCY STOP`" in steps[:powered]) == (given.pins.estop is not None)
    assert ("S4 must not start" in steps[:powered]) == (given.pins.healthy is not None)
    assert "K1" not in steps[powered:]


def test_mean_voltage_at_the_decoder_is_that_of_pulses_of_one_and_two_microseconds() -> None:
    # 800 rpm x 4096 counts = 54 614 low pulses a second: 5 V x (1 - 0.0546) and 5 V x (1 - 0.1092)
    text = chapter(guide(machine("hobbing_plewes"), "gearbox"), "Commissioning")
    assert "4.73 V for pulses of 1 us and 4.45 V for 2 us" in text
    assert "RBIAS" not in guide(machine("lathe_example"), "gearbox")


@pytest.mark.parametrize("name", MACHINES)
def test_heat_sink_is_on_the_list_where_the_regulator_needs_one_at_nine_volts(name: str) -> None:
    """4 V times the current; 60 K of 100 - 40 degrees C, 65 K/W bare, 6 K/W of the junction and its pad."""
    parts = chapter(guide(machine(name), "gearbox"), "Parts")
    watts = 4 * int(re.search(r"The parts take (\d+) mA", parts)[1]) / 1000
    sink = re.search(r"\| HS2 \| heat sink for TO-220 of at most (\d+) K/W", parts)
    assert (sink is not None) == (65 * watts > 60)
    if sink:
        assert 60 - watts < watts * (6 + int(sink[1])) <= 60


@pytest.mark.parametrize("name", MACHINES)
def test_every_part_with_a_right_way_round_is_told_which(name: str) -> None:
    given = machine(name)
    text = guide(given, "gearbox")
    ways = chapter(text, "Wiring").split("### Which way round")[1].split("###")[0]
    for part in netlist(given).parts.values():
        kinds = {"DIP": "Chips:", "electrolytic": "Electrolytic", "1N": "the ring", "2N2222": "E B C", "LM7805": "U2:"}
        for sign, words in kinds.items():
            if sign in part.what:
                assert words in ways, part.name


@pytest.mark.parametrize("name", MACHINES)
def test_trial_of_the_motor_is_a_machine_file_that_is_accepted_and_twice_as_hard(name: str) -> None:
    given, text = machine(name), " ".join(chapter(guide(machine(name), "gearbox"), "Commissioning").split())
    trial = {key: float(re.search(rf"`{key} = (\d+)`", text)[1]) for key in ("acceleration_hz_per_s", "move_rate_hz")}
    assert trial["acceleration_hz_per_s"] == 2 * given.limits.acceleration_hz_per_s
    data = tomllib.loads(bundled(f"{name}.toml").read_text("utf-8"))
    tried = HobbingMachine.model_validate({**data, "limits": {**data["limits"], **trial}})
    way = trial["move_rate_hz"] ** 2 / trial["acceleration_hz_per_s"]  # up to that speed and down again, in a turn
    assert way <= tried.motor_steps + 1


def test_readme_of_a_lathe_speaks_of_no_hob_but_in_the_words_of_the_display() -> None:
    text = guide(machine("lathe_example"), "gearbox")
    assert "hob" not in re.sub(r"`[^`]*`", "", text)
    assert "FAULT hob turned" not in text  # its spindle may turn in a jog
    assert "MODE jumper" not in text


def test_memory_with_the_core_is_the_sum_of_a_published_build_the_libraries_and_the_own_files() -> None:
    # 9252 + 3016 bytes of code and data, 3520 of variables; 25.5 kB and 0.9 kB of the folder for a Teensy 4.0
    for name, flash, ram in (
        ("lathe_example", 25.5 + 9.252 + 3.016 + 6.0, 0.9 + 3.520 + 0.8),
        ("hobbing_plewes", 25.0 + 8.840 + 6.0, 0.9 + 3.436 + 0.6),
    ):
        text = " ".join(chapter(guide(machine(name), "gearbox"), "Flashing").split())
        stated = re.search(r"estimate: (\d+) kB of flash and ([\d.]+) kB of RAM are to be expected", text)
        assert float(stated[1]) == pytest.approx(flash, abs=0.51)
        assert float(stated[2]) == pytest.approx(ram, abs=0.051)


def test_index_of_an_encoder_behind_a_belt_counts_turns_of_the_encoder() -> None:
    straight = machine("hobbing_default")
    belt = straight.model_copy(update={"encoder": straight.encoder.model_copy(update={"belt": Fraction(10, 9)})})
    counted = "must count every turn of the encoder, which are not those of the hob."
    assert counted in " ".join(guide(belt, "gearbox").split())
    assert "must count every turn of the hob." in " ".join(guide(straight, "gearbox").split())
    assert "| `Checked` | turns of the encoder in which" in guide(belt, "gearbox")


def test_full_rate_of_the_motor_is_reached_by_engaging_at_speed() -> None:
    """6 teeth are the fewest: 5 would be more than 40000/1.01 steps/s at 800 rpm.

    Engaged at rate w with acceleration a, and three quarters of it back, the motor overtakes w^2/2a steps by ramps of
    u^2/2a and of 4/3 of that: u = w sqrt(3/7), after (w + 7/3 u)/a, in which the hob makes 64 turns at most. A slip
    of 4 full steps is 16 of 16000.
    """
    given = machine("hobbing_default")
    text = chapter(guide(given, "gearbox"), "Commissioning")
    rpm = int(re.search(r"job of 6 teeth, .*? Switch the hob on, (\d+) rpm", text)[1])

    def turns(speed: float) -> float:
        return speed / 60 * (speed / 60 * 16000 / 6) * (1 + (7 / 3) ** 0.5) / 8000

    assert turns(rpm) <= 64 < turns(rpm + 1)
    rate = rpm / 60 * 16000 / 6
    assert f"{rate * (1 + (3 / 7) ** 0.5):.0f} steps/s, of `step_rate_hz = 40000`" in text
    assert f"with {rate:.0f} steps/s" in text
    alone = int(re.search(r"A hob of 800 rpm alone: (\d+) teeth", text)[1])
    assert turns(800) * 6 / alone <= 64 < turns(800) * 6 / (alone - 1)
    assert "0.36 degrees of the table, 0.31 mm at a radius of 50 mm" in text


def test_full_rate_is_the_same_with_a_left_hand_hob() -> None:
    right = machine("hobbing_default")
    left = right.model_copy(update={"hob_hand": "left"})
    one, other = (
        re.search(
            r"The motor at its full rate.*?repeat as its README says", chapter(guide(each, "gearbox"), "Commissioning")
        )[0]
        for each in (right, left)
    )
    assert one == other


def test_fewest_teeth_are_those_that_the_firmware_takes() -> None:
    """20000/1.01 steps/s at 800 rpm: 10.8 teeth; 6 teeth up to 445 rpm."""
    given = machine("hobbing_default")
    slow = given.model_copy(update={"limits": given.limits.model_copy(update={"step_rate_hz": 20000.0})})
    assert "firmware takes 11 teeth and more" in chapter(guide(slow, "gearbox"), "The first cut")
    assert "for 6 teeth `hob_rpm = 445`" in chapter(guide(slow, "gearbox"), "The first cut")
    assert plan(slow, 11).carried_at_every_speed
    assert not plan(slow, 10).carried_at_every_speed
    (said,) = reservations(slow)
    assert said.startswith("Gears of fewer than 11 teeth are refused")
    assert said in " ".join(guide(slow, "gearbox").split())


def test_first_gear_and_speeds_of_the_tests_are_those_that_the_machine_carries() -> None:
    """20000/1.01 steps/s carry 11 teeth at 800 rpm; 6000 carry 36, which is 9 times four; a slow hob turns slower."""
    given = machine("hobbing_default")
    slow = given.model_copy(
        update={"limits": given.limits.model_copy(update={"step_rate_hz": 6000.0, "hob_rpm": 800.0})}
    )
    text = chapter(guide(slow, "gearbox"), "Commissioning")
    assert "Direction: job of 36 teeth" in text
    assert "Turn the hob by hand 9 turns in its working direction: the table must go 90 degrees" in text
    assert "a gear of 36 teeth in wax" in text
    crawling = given.model_copy(update={"limits": given.limits.model_copy(update={"hob_rpm": 60.0})})
    assert "for a minute at about 30 rpm" in chapter(guide(crawling, "gearbox"), "Commissioning")


@pytest.mark.parametrize("level", ["low", "high"])
def test_alarm_of_the_driver_is_tried_with_power_before_its_level_is_doubted(level: str) -> None:
    given = machine("hobbing_default")
    wired = given.model_copy(
        update={
            "pins": given.pins.model_copy(update={"alarm": 10}),
            "driver": given.driver.model_copy(update={"name": "cl57t", "alarm_active": level}),
        }
    )
    text = chapter(guide(wired, "gearbox"), "Commissioning")
    assert text.index("Motor power on") < text.index("`alarm_active`")


def test_full_rate_of_a_lathe_turns_screw_and_spindle_alike() -> None:
    """4800 steps a turn of screw and spindle: at 783 rpm 62640 steps/s, which overtake with all of the 80000."""
    text = chapter(guide(machine("lathe_example"), "gearbox"), "Commissioning")
    assert "3.175 mm or 8 per inch, 1 start." in text
    rpm = int(re.search(r"Switch the spindle on, (\d+) rpm", text)[1])
    assert "80000 steps/s, of `step_rate_hz = 80000`, overtakes what it has missed" in text
    assert f"with {rpm * 80} steps/s" in text


@pytest.mark.parametrize("name", MACHINES)
def test_what_a_machine_lacks_is_said_at_the_top(name: str) -> None:
    given, text = machine(name), guide(machine(name), "gearbox")
    top = " ".join(text[: text.index("## Parts")].split())
    for key in ("healthy", "estop", "index"):
        assert (f"`pins.{key}`" in top) == (getattr(given.pins, key) is None)


def test_inputs_that_step_at_the_low_level_without_a_transistor_are_told_of() -> None:
    given = machine("hobbing_default")
    assert reservations(given) == ()
    direct = given.model_copy(
        update={"driver": given.driver.model_copy(update={"output": "direct", "step_active": "low"})}
    )
    (said,) = reservations(direct)
    assert "Opto-couplers that are fed from + need" in said


def test_run_up_that_the_table_cannot_follow_is_said_with_the_teeth_that_it_can() -> None:
    """A hob that is at its speed in T gains w/2 (w/a - T) steps, and w sqrt(2/a) before the first; 100 may wait."""
    given = machine("hobbing_default")
    quick = given.model_copy(update={"limits": given.limits.model_copy(update={"run_up_s": 0.5})})
    (said,) = reservations(quick)
    teeth = int(re.search(r"A gear of fewer than (\d+) teeth loses its phase", said)[1])

    def lost(count: int) -> float:
        rate = 800 / 60 * 16000 / count
        return rate / 2 * (rate / 8000 - 0.5) + rate * (2 / 8000) ** 0.5

    assert lost(teeth) <= 100 < lost(teeth - 1)


def test_every_text_of_the_display_is_explained_or_explains_itself() -> None:
    """What the pages draw as it stands, and the words of a refusal."""
    texts = "".join(guide(machine(name), "gearbox") for name in MACHINES)
    drawn = (
        set(re.findall(r'->message = "([^"]+)"', screen()))
        | set(re.findall(r'gm_line\([^;"]*"([^";]{3,})"', screen()))
        | set(re.findall(r'return "([^"]+)"', screen()))
    )
    plain = re.compile(r"(Press|Hold|Turn|Thread|Hob|Mark|Clear|before|gear before|per turn|must be|by hand|Test)\b")
    known = {"ok", "unknown", "Unknown", "FAULT"}
    missing = {said for said in drawn if said.strip("><") not in texts and not plain.match(said)} - known
    assert missing <= {*_SELF_EXPLAINING}


_SELF_EXPLAINING = (
    "2.25/P",
    "2.157/P",
    "2.2/P+0.002in",
    "2.25m",
    "Helix none, spur",
    "No index pulse",
    "Lock it for moves",
    "See its own lamp",
    "Release the button",
    "Run the hob slower",
    "Follows till it ends",
    "YOU MUST STOP HOB!",
    "Phase kept. Hold: on",
    "MOVES  Press: stop",
    "At         of",
    "    teeth",
    "Climb cut",
    "FAULT motor driver",  # of machines with an alarm input
)


@pytest.mark.parametrize("name", MACHINES)
def test_more_speed_than_a_step_motor_has_torque_at_is_told(name: str) -> None:
    given = machine(name)
    fast, slow = (
        given.model_copy(update={"limits": given.limits.model_copy(update={"step_rate_hz": rpm * steps / 60})})
        for steps in (float(given.drive.pulses_per_turn),)
        for rpm in (1600, 1500)
    )
    assert "little torque above 1500 rpm" not in guide(slow, "gearbox")
    told = " ".join(guide(fast, "gearbox").split())
    assert "little torque above 1500 rpm" in told
    assert f"`step_rate_hz = {25 * given.drive.pulses_per_turn}`" in told


def test_direction_of_the_feed_says_which_word_to_write_instead() -> None:
    text = chapter(guide(machine("hobbing_helical"), "gearbox"), "Commissioning")
    assert 'If it falls by 10 mm, write `counts_up = "conventional"`' in text
    given = machine("hobbing_helical")
    turned = given.model_copy(update={"feed": given.feed.model_copy(update={"counts_up": "conventional"})})
    assert 'If it falls by 10 mm, write `counts_up = "climb"`' in chapter(guide(turned, "gearbox"), "Commissioning")
