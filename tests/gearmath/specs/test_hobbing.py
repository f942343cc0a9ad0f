"""The hobbing machine's file: the two machines of the source text, and what is refused."""

from fractions import Fraction

import pytest

from gearmath.errors import InputError
from gearmath.specs.hobbing import HobbingMachine, load_hobbing_machine
from gearmath.specs.toml import bundled, parse

PLEWES = bundled("hobbing_plewes.toml").read_text("utf-8")


def test_bundled_machine_is_the_one_of_the_source_text():
    machine = load_hobbing_machine(bundled("hobbing_plewes.toml"))
    assert (machine.encoder_counts, machine.motor_steps, machine.hob_starts) == (4096, 16000, 1)
    assert [hob.diametral_pitch for hob in machine.hobs] == [32, 36, 48, 60, 60.8, 64, 80, 105, 126, None]
    assert machine.hobs[-1].module == 1.0
    assert machine.hobs[-1].module_mm == 1.0


def test_second_bundled_machine_has_the_metric_hobs_of_the_second_example():
    machine = load_hobbing_machine(bundled("hobbing_metric.toml"))
    assert [hob.diametral_pitch for hob in machine.hobs][:8] == [32, 36, 48, 60, 64, 80, 105, 126]
    assert [hob.module for hob in machine.hobs][8:] == [0.5, 1.0, 1.5]


@pytest.mark.parametrize(
    ("old", "new", "counts", "steps"),
    [
        ("worm = 10", "worm = 5", 4096, 8000),  # source text: "800 x 2 x 5"
        ("lines = 1024", "lines = 200", 800, 16000),  # source text: "200 x 4 = 800"
        ("microsteps = 4", "microsteps = 1", 4096, 4000),  # source text: "200 x 2 x 10 = 4000"
        ("decoder = 4", "decoder = 1", 1024, 16000),  # MODE pin at 0
        ('belt = "2/1"', 'belt = "127/50"', 4096, 20320),  # 800 x 2.54 x 10, exact
    ],
)
def test_drive_trains_of_the_source_text(old, new, counts, steps):
    machine = parse(PLEWES.replace(old, new), HobbingMachine, "machine.toml")
    assert (machine.encoder_counts, machine.motor_steps) == (counts, steps)


def test_rationals_are_exact():
    machine = parse(PLEWES.replace("worm = 10", 'worm = "355/113"').replace('"2/1"', "113"), HobbingMachine, "f")
    assert machine.table.worm == Fraction(355, 113)
    assert machine.motor_steps == 800 * 355


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("worm = 10", 'worm = "1/3"', ("table", "1600/3", "whole number")),
        ("worm = 10", "worm = 10.5", ("table.worm", "10.5", "fraction")),
        ("worm = 10", "worm = true", ("table.worm", "True", "whole number")),
        ("worm = 10", 'worm = "1/0"', ("table.worm", "1/0", "fraction")),
        ("worm = 10", "worm = 0", ("table.worm", "0", "between")),
        ("decoder = 4", "decoder = 3", ("encoder.decoder", "3", "1, 2 or 4")),
        ("lines = 1024", "", ("encoder.lines", "missing")),
        ("lines = 1024", "lines = 1024\nwires = 2", ("encoder.wires", "2", "known")),
        ("hob_starts = 1", "hob_starts = 0", ("hob_starts", "0", "1")),
        ("module = 1.0", "module = nan", ("hobs.9.module", "nan", "finite")),
        ("module = 1.0", "module = 1.0\ndiametral_pitch = 32.0", ("hobs.9", "exactly one")),
        ("module = 1.0", "", ("hobs.9", "exactly one")),
        ('"2.25m"', '"2.25/P"', ("hobs.9", "2.25/P", "2.25m")),
        ('"2.25m"', '"2m"', ("hobs.9.depth_rule", "2m", "2.157/P")),
        ("= 36.0", "= 32.0", ("32dp", "more than once")),
        ("hob_rpm = 800.0", "hob_rpm = -1.0", ("limits.hob_rpm", "-1", "0")),
    ],
)
def test_bad_input_is_refused_in_one_sentence(old, new, words):
    assert old in PLEWES
    with pytest.raises(InputError) as caught:
        parse(PLEWES.replace(old, new, 1), HobbingMachine, "machine.toml")
    message = str(caught.value)
    assert message.startswith("machine.toml: ")
    assert "\n" not in message
    for word in words:
        assert word in message
