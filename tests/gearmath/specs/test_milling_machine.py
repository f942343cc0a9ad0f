"""The machine file: units converted once, and what is wrong refused by key, value and limit."""

import numpy as np
import pytest

from gearmath.errors import InputError
from gearmath.kernels import kernel
from gearmath.specs.milling_machine import MillingMachine, load_milling_machine
from gearmath.specs.toml import bundled, parse

TEXT = bundled("vertical_5axis.toml").read_text("utf-8")


def test_bundled_machine_in_mm_rad_and_seconds():
    machine = load_milling_machine(bundled("vertical_5axis.toml"))
    assert machine.pivot_height == 350.0 + 150.0
    endless = [-np.inf, np.inf]
    expected = [[-400, 400], [-400, 400], [-100, 900], endless, [-np.pi / 18, 5 * np.pi / 9]]
    np.testing.assert_allclose(machine.travel, expected, rtol=1e-15)
    # 20000 mm/min, 15000 mm/min, 20 rpm and 10 rpm
    speeds = [1000 / 3, 1000 / 3, 250, 20 * 2 * np.pi / 60, 10 * 2 * np.pi / 60]
    np.testing.assert_allclose(machine.max_speed, speeds, rtol=1e-15)
    accelerations = [3000, 3000, 3000, 300 * np.pi / 180, 200 * np.pi / 180]
    np.testing.assert_allclose(machine.max_acceleration, accelerations, rtol=1e-15)
    assert machine.pivot.tolist() == [0, 0, 0]


def test_a_counting_work_axis_has_a_travel():
    text = TEXT.replace("modulo = true", "modulo = false\ntravel = [-90.0, 450.0]")
    np.testing.assert_allclose(parse(text, MillingMachine, "m").travel[3], [-np.pi / 2, 5 * np.pi / 2], rtol=1e-15)


def test_control_options_become_words_in_the_order_of_the_dialect():
    text = (
        TEXT.replace('"G642"', '"G60"')
        .replace('"SOFT"', '"BRISK"')
        .replace("feed_forward = true", "feed_forward = false")
    )
    assert parse(text, MillingMachine, "m").control.words == ("G60", "BRISK", "FFWOF")
    assert parse(TEXT, MillingMachine, "m").control.words == ("G642 CTOL=0.000050 OTOL=0.0000278", "SOFT", "FFWON")


def test_without_a_control_table_the_increments_are_those_of_a_new_control():
    control = parse(TEXT[: TEXT.index("[control]")], MillingMachine, "m").control
    assert (control.increments_per_mm, control.increments_per_degree, control.decimals) == (1000, 1000, (3, 3))
    assert control.path_mode == "G642"


def test_gauge_line_above_the_b_axis_at_z_zero_is_a_negative_height():
    """The sentence of the file, worked by hand: gauge line 650 mm above the B axis at Z = 0, a tool of 150 mm.

    The tip is level with the B axis where Z has gone down by 650 - 150 mm.
    """
    text = TEXT.replace("[-100.0, 900.0]", "[-700.0, 0.0]").replace("home_z = 900.0", "home_z = 0.0")
    machine = parse(text.replace("gauge_line_height = 350.0", "gauge_line_height = -650.0"), MillingMachine, "m")
    tip_on_the_b_axis = [0.0, 0.0, -500.0, 0.0, 0.0]
    center, _ = kernel("tool_pose")(np.array([tip_on_the_b_axis]), machine.pivot_height, machine.pivot)
    np.testing.assert_allclose(center, [[0.0, 0.0, 0.0]], atol=1e-12)
    wrong = r"gauge_line_height 650 and tool_length 150: the tip of the tool would be below the B axis over the whole"
    with pytest.raises(InputError, match=wrong):
        parse(text.replace("gauge_line_height = 350.0", "gauge_line_height = 650.0"), MillingMachine, "m")


@pytest.mark.parametrize(
    ("old", "new", "sentence"),
    [
        ("tool_length = 150.0", "tool_length = 0.0", r"tool_length = 0.0: must be greater than 0"),
        ("gauge_line_height = 350.0", "gauge_line_height = nan", r"gauge_line_height = nan: must be a finite number"),
        ("gauge_line_height = 350.0", "", r"gauge_line_height: the key is missing"),
        ("[-10.0, 100.0]", "[100.0, -10.0]", r"axes.B.travel = .*100.0, -10.0.: the first value must be less"),
        ("[-10.0, 100.0]", '["-10", 100.0]', r"axes.B.travel #1 = '-10': must be a number"),
        ("[-10.0, 100.0]", "[-10.0]", r"axes.B.travel: value 2 of the list is missing"),
        ("modulo = true", "modulo = false", r"axes.A: travel belongs to an axis with modulo = false"),
        ("modulo = true", "modulo = true\ntravel = [0.0, 90.0]", r"axes.A: travel belongs to an axis with modulo"),
        ("max_acceleration = 300.0", "max_acceleration = 0.0", r"axes.A.max_acceleration = 0.0: must be greater"),
        ("max_acceleration = 300.0", "", r"axes.A.max_acceleration: the key is missing"),
        ('"M3"', '"M5"', r"cutter_direction = 'M5': must be 'M3' or 'M4'"),
        (
            "pivot_offset = [0.0, 0.0, 0.0]",
            "pivot_offset = [0.0, 0.0]",
            r"pivot_offset: value 3 of the list is missing",
        ),
        ("[20.0, 3000.0]", "[-20.0, 3000.0]", r"spindle_speed_rpm #1 = -20.0: must be greater than 0"),
        ('"G54"', '"G53"', r"work_offset = 'G53': must be 'G54', 'G55', 'G56' or 'G57'"),
        (
            "increments_per_mm = 100000",
            "increments_per_mm = 2500",
            r"control.increments_per_mm = 2500: must be a power",
        ),
        ('"G642"', '"G64"', r"control.path_mode = 'G64': must be 'G60' or 'G642'"),
        ("home_z = 900.0", "home_z = 901.0", r"home_z 901 must lie within the travel of Z, -100 to 900"),
        ('"gauge_line"', '"table"', r"z_reference = 'table': must be 'gauge_line' or 'tip'"),
        ("= 3600.0", "= -1.0", r"axes.B.max_speed_per_min = -1.0: must be greater than 0"),
    ],
)
def test_faults_are_named(old, new, sentence):
    assert old in TEXT
    with pytest.raises(InputError, match=r"^m\.toml: " + sentence):
        parse(TEXT.replace(old, new, 1), MillingMachine, "m.toml")
