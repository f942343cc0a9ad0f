"""The inspection of a virtual gear: its figures by hand, its classes, its cost."""

from __future__ import annotations

import math
import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest

from gearmath.errors import InputError
from gearmath.gearbox.dimensions import Gear
from gearmath.gearbox.hobbed.classes import classes, outside, overall, tolerances
from gearmath.gearbox.hobbed.envelope import Envelope
from gearmath.gearbox.hobbed.inspection import Inspection, MeasuredTrace, PitchRow, inspect, layout
from gearmath.gearbox.hobbed.job import HobbingJob, HobTool
from gearmath.gearbox.hobbed.setup import setup
from gearmath.specs.hobbing import find_hobbing_machine

UM = 1e-3


def job(teeth: int = 24, module: float = 1.0, width: float = 20.0) -> HobbingJob:
    hob = HobTool(1, 1, 12, 50.0 * module, 1.25 * module, 0.38 * module)
    return HobbingJob(Gear(teeth, module, math.radians(20)), 1, hob, width, 1.0)


def test_slope_form_and_total_of_a_trace_are_those_of_its_line_and_its_wave():
    """4 um of slope over the length, and five whole waves of 1 um amplitude about it."""
    place = np.linspace(2.0, 6.0, 1001)
    wave = np.cos(2 * math.pi * 5 * (place - 2.0) / 4.0)
    trace = MeasuredTrace("right", 0, place, (0.004 * (place - 2.0) / 4.0) + 0.001 * wave, 5.0)
    assert trace.slope == pytest.approx(0.004, rel=0.001)
    assert trace.form == pytest.approx(0.002, rel=0.001)
    assert 0.004 < trace.total < 0.006


def test_pitch_figures_of_a_row_are_those_of_the_definition():
    """One tooth 5 um ahead: the pitches before and after it are off by 5, F_p is 5."""
    row = PitchRow("left", np.array([0.0, 0.0, 0.005, 0.0]))
    np.testing.assert_allclose(row.single, [0.0, 0.0, 0.005, -0.005])
    assert (row.worst, row.total) == (0.005, 0.005)


def test_class_is_the_finest_that_allows_every_figure():
    """m = 4, d = 100, b = 25, by hand for class 5: f_pt 6.7 um, F_p 20.5; one class coarser allows √2 more."""
    of = job(25, 4.0, 25.0)
    limits = tolerances(of, 5)
    assert limits["f_pt"] == pytest.approx(6.7)
    assert limits["F_p"] == pytest.approx(20.5)
    assert limits["F_r"] == pytest.approx(0.9 * 20.5)
    flat = MeasuredTrace("right", 0, np.array([0.0, 1.0, 2.0]), np.zeros(3), 1.0)
    for size, expected in ((6.69, 5), (6.71, 6), (9.4, 6), (9.5, 7)):
        row = PitchRow("right", np.array([0.0] * 24 + [size * UM]))
        rows = classes(of, Inspection((flat,), (flat,), (row,), np.zeros(25), ()))
        assert {each.figure: each.accuracy_class for each in rows}["f_pt"] == expected
        assert overall(rows) == expected


@pytest.mark.parametrize(
    ("of", "words"), [(job(24, 0.4), "module 0.4"), (job(4, 1.0), "diameter 4"), (job(24, 1.0, 2.0), "face width 2")]
)
def test_gear_that_the_standard_does_not_cover_has_figures_without_classes(of, words):
    assert words in str(outside(of))
    flat = MeasuredTrace("right", 0, np.array([0.0, 1.0, 2.0]), np.zeros(3), 1.0)
    row = PitchRow("right", np.zeros(of.gear.teeth))
    rows = classes(of, Inspection((flat,), (flat,), (row,), np.zeros(of.gear.teeth), ()))
    assert {each.accuracy_class for each in rows} == {None}
    assert overall(rows) is None


@pytest.mark.parametrize("teeth", [5, 6, 7, 9, 12, 17, 23, 100, 250, 300, 600])
def test_gears_of_every_number_of_teeth_are_measured_without_a_gap(teeth):
    """Undercut ones too: all figures are finite."""
    of = job(teeth, 1.0, 5.0)
    found = inspect(Envelope(of), layout(of))
    assert all(math.isfinite(value) for value in found.figures.values())
    assert all(len(row.position) == teeth for row in found.pitches)
    assert min(trace.deviation.min() for trace in found.profiles) > -1e-9


def test_gear_without_an_involute_is_refused():
    gear = Gear(4, 1.0, math.radians(12), 0.0, -0.5)
    with pytest.raises(InputError, match="no involute"):
        layout(HobbingJob(gear, 1, HobTool(1, 1, 12, 50.0, 1.25, 0.3), 5.0, 1.0))


def test_passes_that_are_tried_grow_with_teeth_and_length_only():
    """Points, and so cost: profile and pitch do not know the face width, helix points are ten per feed."""
    short, long = (layout(job(24, 1.0, width)) for width in (20.0, 40.0))
    assert len(short.profile) == len(long.profile)
    assert len(long.helix) == 2 * len(short.helix)


@pytest.mark.skipif(sys.platform != "linux", reason="the peak of memory is read from /proc")
def test_whole_cut_of_the_issue_needs_less_than_500_mb():
    """24 teeth, module 1, 20 mm wide, 12 gashes, feed 1 mm, in a process of its own."""
    code = (
        "from gearmath.gearbox.hobbed.setup import cut_and_inspect, setup\n"
        "from gearmath.specs.hobbing import find_hobbing_machine\n"
        "machine = find_hobbing_machine('hobbing_default.toml')\n"
        "cut_and_inspect(setup(machine, 24, hob='m1', feed=1.0, face_width=20.0), 'exact')\n"
        # ru_maxrss would begin at that of the parent
        "print(open('/proc/self/status').read().split('VmHWM:')[1].split()[0])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert int(done.stdout) / 1024 < 500


@pytest.mark.parametrize("teeth", [24, 200])
def test_hob_is_as_long_as_the_rack_that_generates_both_flanks(teeth):
    """A large hob is a rack: where it cuts at L, the middle of its tooth is π/4 + (L - L_C)/cos α from the gear's,
    to one side for the one flank, to the other for the other. And a pitch."""
    of = HobbingJob(Gear(teeth, 1.0, math.radians(20), 0.0, 0.0), 1, HobTool(1, 1, 12, 4000.0, 1.25, 0.38), 20.0, 1.0)
    middle = teeth / 2 * math.sin(math.radians(20))
    expected = 2 * (math.pi / 4 + 2.3 / math.cos(math.radians(20))) + math.pi
    assert np.ptp(of.generating_zone(middle - 2.0, middle + 2.3)) == pytest.approx(expected, rel=2e-3)


def test_hob_that_is_too_short_is_refused():
    machine = find_hobbing_machine("hobbing_default.toml")
    short = [hob.model_copy(update={"length": 5.0}) for hob in machine.hobs]
    with pytest.raises(InputError, match=r"hob m1: length = 5: the flanks of this gear need \d+\.\d mm"):
        setup(machine.model_copy(update={"hobs": tuple(short)}), 24, hob="m1")


def test_hob_may_be_shifted_until_its_end_reaches_the_zone_that_cuts():
    """Of 40 mm, what the flanks need is free on both sides, as far for both hands; beyond it the shift is refused."""
    machine = find_hobbing_machine("hobbing_default.toml")
    long = tuple(hob.model_copy(update={"length": 40.0}) for hob in machine.hobs)
    made = machine.model_copy(update={"hobs": long})
    low, high = setup(made, 24, hob="m1").offsets
    assert high - low == pytest.approx(40.0 - setup(made, 24, hob="m1").hob_length)
    assert low == pytest.approx(-high, rel=1e-6)  # a spur gear: both flanks alike
    setup(made, 24, hob="m1", hob_shift=high - 0.01)
    with pytest.raises(InputError, match=r"hob m1: hob shift = -20: must lie between -\d+\.\d and \d+\.\d mm"):
        setup(made, 24, hob="m1", hob_shift=-20.0)


def test_shift_of_a_hob_by_what_its_threads_rise_between_gashes_leaves_the_same_flats():
    """And by half of that the ridges lie where the flats were."""
    rise = math.pi / math.cos(math.asin(1 / 50)) / 12
    along = np.linspace(3.6, 4.6, 60)
    of = job(24, 1.0)
    flanks = [
        Envelope(replace(of, feed=0.02, hob_offset=part * rise)).deviation(
            1, np.zeros(60, int), along, np.full(60, 10.0)
        )
        for part in (0.0, 3.0, 0.5)
    ]
    np.testing.assert_allclose(flanks[1], flanks[0], atol=0.01 * UM)
    assert np.corrcoef(flanks[2], flanks[0])[0, 1] < -0.8
