"""The covariance of touches: against touches that were read wrongly, and the arithmetic of each source alone."""

from __future__ import annotations

import math

import numpy as np
import pytest

from gearmath.bevel.flank import blank_grid, solve_flank
from gearmath.errors import InputError
from gearmath.machine.planning.targets import probe_targets
from gearmath.quality.evaluation.touches import measured_member
from gearmath.quality.uncertainty.touch_model import sensitivities, touch_covariance
from gearmath.specs.bevel_set import FLANKS, MEMBERS
from gearmath.specs.calibration import load_calibration
from gearmath.specs.flank_csv import FlankFile
from gearmath.specs.measurement import MeasuringModel, load_measurement
from gearmath.specs.toml import bundled
from gearmath.specs.touch_csv import Touches

PROBE = load_calibration(bundled("probe.toml")).model_copy(update={"offset": (0.031, -0.047, 0.012)})
PERFECT = MeasuringModel(title="perfect", repeatability_um=0.0)
each_member = pytest.mark.parametrize("member", MEMBERS)


@pytest.fixture(scope="module")
def touched(gear_set, vertical):
    """``touched(member, shift)``: the file of a perfect member whose axes are read off by ``shift`` (n,5) of axes."""

    def make(member: str, shift=lambda axes: 0 * axes) -> FlankFile:
        spec = gear_set.member(member)
        there = probe_targets(spec, vertical, PROBE)
        touches = Touches(
            1,
            member,
            there.flank,
            there.tooth,
            there.row,
            there.col,
            there.touch + shift(there.touch),
            np.ones(len(there), dtype=bool),
        )
        return measured_member(touches, spec, vertical, PROBE)

    return make


@each_member
@pytest.mark.parametrize("axis", range(4), ids="XYZA")
def test_sensitivity_is_what_a_wrong_reading_does(gear_set, vertical, touched, member, axis):
    """Read too far by +-h where the axis stands right: the error of standing too far, with the other sign."""
    spec, h = gear_set.member(member), 1e-4

    def off(sign):
        return touched(member, lambda axes: sign * h * np.eye(5)[axis] + 0 * axes)

    high, low = off(1), off(-1)
    for flank in FLANKS:
        slope = sensitivities(spec, flank, blank_grid(spec), vertical, PROBE)[:, axis]
        here = (high.flank == flank) & (high.tooth == 0)
        differences = (high.deviation[here] - low.deviation[here]) / (2 * h)
        np.testing.assert_allclose(-slope[high.row[here] * 9 + high.col[here]], differences, rtol=0, atol=1e-6)


@each_member
def test_squareness_acts_from_the_height_of_the_calibration(gear_set, vertical, touched, member):
    """X read too far by the squareness, times Z less the Z of the sphere on which the tip was calibrated."""
    spec, squareness = gear_set.member(member), 1e-5
    height = PROBE.sphere.center[2]
    wrong = touched(member, lambda axes: squareness * (axes[:, 2:3] - height) * np.eye(5)[0])
    for flank in FLANKS:
        slope = sensitivities(spec, flank, blank_grid(spec), vertical, PROBE)[:, 4]
        here = wrong.flank == flank
        expected = -squareness * slope[wrong.row[here] * 9 + wrong.col[here]]
        np.testing.assert_allclose(wrong.deviation[here], expected, rtol=0, atol=1e-8)


@each_member
def test_growth_is_what_a_larger_flank_leaves(gear_set, vertical, member):
    """The deviation of the points of a work that is larger by 1e-4, along the normals of the one of the drawing."""
    spec = gear_set.member(member)
    for flank in FLANKS:
        nominal = solve_flank(spec, flank, blank_grid(spec))
        slope = sensitivities(spec, flank, blank_grid(spec), vertical, PROBE)[:, 5]
        grown = np.sum((1e-4 * nominal.point) * nominal.normal, axis=1)
        np.testing.assert_allclose(1e-4 * slope, grown, rtol=0, atol=1e-12)


def covariance_of(gear_set, vertical, file, **values):
    how = PERFECT.model_copy(update=values)
    return touch_covariance(file, gear_set.pinion, how, vertical, PROBE)


def test_every_source_alone_is_what_it_says(gear_set, vertical, touched):
    file = touched("pinion")
    tooth, flank, place = file.tooth % 12, file.flank, 9 * file.row + file.col  # tooth 12 is tooth 0 once more

    def correlation(**values):
        matrix = covariance_of(gear_set, vertical, file, **values).matrix
        u = np.sqrt(np.diag(matrix))
        return u, np.round(matrix / np.outer(u, u), 9)

    u, r = correlation(repeatability_um=0.5, touches=4)
    np.testing.assert_allclose(u, 0.25e-3, rtol=1e-12)
    np.testing.assert_array_equal(r, np.eye(len(file)))
    u, r = correlation(pretravel_um=0.3)
    np.testing.assert_allclose(u, 0.3e-3, rtol=1e-12)
    np.testing.assert_array_equal(r, flank[:, None] == flank[None])
    u, r = correlation(position_um=0.7)
    np.testing.assert_allclose(u, 0.7e-3, rtol=1e-9)
    np.testing.assert_array_equal(r, (place[:, None] == place[None]) & (flank[:, None] == flank[None]))
    u, r = correlation(work_axis_arcsec=1.0)
    lever = np.abs(file.point[:, 0] * file.normal[:, 1] - file.point[:, 1] * file.normal[:, 0])
    np.testing.assert_allclose(u, math.radians(1 / 3600) * lever, rtol=1e-6)
    np.testing.assert_array_equal(np.abs(r), tooth[:, None] == tooth[None])  # one flank has more, the other less
    u, r = correlation(temperature_K=2.0)
    np.testing.assert_allclose(u, 23e-6 * np.abs(np.sum(file.point * file.normal, axis=1)), rtol=1e-6)
    np.testing.assert_array_equal(np.abs(r), 1)
    _, r = correlation(squareness_um_per_m=5.0)
    np.testing.assert_array_equal(np.abs(r), 1)


def test_sources_add_up(gear_set, vertical, touched):
    file = touched("pinion")
    values = {
        "repeatability_um": 0.5,
        "pretravel_um": 0.3,
        "position_um": 0.7,
        "work_axis_arcsec": 1.0,
        "squareness_um_per_m": 5.0,
        "temperature_K": 1.0,
    }
    whole = covariance_of(gear_set, vertical, file, **values).matrix
    parts = [covariance_of(gear_set, vertical, file, **{name: value}).matrix for name, value in values.items()]
    np.testing.assert_allclose(whole, sum(parts), rtol=0, atol=1e-18)
    assert len(covariance_of(gear_set, vertical, file).names) == 0


def test_arc_second_at_100_mm_is_half_a_micrometre():
    """The reference figure: 1 arcsec at 100 mm = 0.48 um; 11.5e-6 per kelvin on 100 mm = 1.15 um."""
    how = PERFECT.model_copy(update={"work_axis_arcsec": 1.0, "temperature_K": 1.0})
    assert 100 * how.work_axis == pytest.approx(0.48e-3, abs=0.005e-3)
    assert 100 * how.growth == pytest.approx(1.15e-3, rel=1e-12)


@pytest.mark.parametrize(
    ("line", "sentence"),
    [
        ("repeatability_um = -0.1", r"m\.toml: repeatability_um = -0\.1: .*must be at least 0"),
        ("repeatability_um = nan", r"m\.toml: repeatability_um = nan: must be a finite number"),
        ("touches = 0", r"m\.toml: touches = 0: .*must be at least 1"),
        ("sigma = 1.0", r"m\.toml: sigma = 1\.0: no such key is known here"),
    ],
)
def test_bad_model_is_refused_by_its_key(tmp_path, line, sentence):
    path = tmp_path / "m.toml"
    start = "" if line.startswith("repeatability") else "repeatability_um = 0.5\n"
    path.write_text(f'title = "bad"\n{start}{line}\n')
    with pytest.raises(InputError, match=sentence):
        load_measurement(path)
