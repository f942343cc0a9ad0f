"""The machine file: units converted once, and what is wrong refused by key, value and limit."""

import numpy as np
import pytest

from gearmath.errors import InputError
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


@pytest.mark.parametrize(
    ("old", "new", "sentence"),
    [
        ("tool_length = 150.0", "tool_length = 0.0", r"tool_length = 0.0: should be greater than 0"),
        ("gauge_line_height = 350.0", "gauge_line_height = nan", r"gauge_line_height = nan: must be a finite number"),
        ("gauge_line_height = 350.0", "", r"gauge_line_height: the key is missing"),
        ("[-10.0, 100.0]", "[100.0, -10.0]", r"axes.B.travel = .*100.0, -10.0.: the first value must be less"),
        ("[-10.0, 100.0]", '["-10", 100.0]', r"axes.B.travel.0 = '-10': should be a valid number"),
        ("[-10.0, 100.0]", "[-10.0]", r"axes.B.travel.1: the key is missing"),
        ("modulo = true", "modulo = false", r"axes.A.modulo = False: should be True"),
        ("modulo = true", "modulo = true\ntravel = [0.0, 90.0]", r"axes.A.travel = .*: no such key is known here"),
        ("[20.0, 3000.0]", "[-20.0, 3000.0]", r"spindle_speed_rpm.0 = -20.0: should be greater than 0"),
        ('"G54"', '"G53"', r"work_offset = 'G53': should be 'G54', 'G55', 'G56' or 'G57'"),
        ("= 3600.0", "= -1.0", r"axes.B.max_speed_per_min = -1.0: should be greater than 0"),
    ],
)
def test_faults_are_named(old, new, sentence):
    assert old in TEXT
    with pytest.raises(InputError, match=r"^m\.toml: " + sentence):
        parse(TEXT.replace(old, new, 1), MillingMachine, "m.toml")
