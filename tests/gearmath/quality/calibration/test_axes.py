"""The rotary axes of a machine that stands elsewhere than its file says come back from touches on a carried sphere."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from gearmath.errors import InputError
from gearmath.machine.control.executor import run_program
from gearmath.machine.writing.axis_cycle import axis_program
from gearmath.quality.calibration.axes import calibrate_axes
from gearmath.specs.calibration import load_calibration
from gearmath.specs.milling_machine import load_milling_machine
from gearmath.specs.toml import bundled
from gearmath.specs.touch_csv import CalibrationTouches, read_calibration_csv

MACHINE = load_milling_machine(bundled("vertical_5axis.toml"))
PROBE = load_calibration(bundled("probe.toml")).model_copy(
    update={"offset": (0.031, -0.047, 0.012), "tip_radius": 0.7432}
)
#: e, b_x, b_z, β and the place of the sphere: what the machine really has.
TRUTH = np.array([0.123, -0.087, 0.211, 0.034, -0.056, math.radians(0.01), 79.92, 0.15])


class Carried:
    """The machine in plain geometry: the tip stops one radius from the sphere, which A and B carry about true axes."""

    def __init__(self, probe=PROBE, truth=TRUTH):
        self.probe, self.truth = probe, truth

    def center(self, A, B):
        e, (b_x, b_z), beta, place = self.truth[:3], self.truth[3:5], self.truth[5], self.truth[6:]
        x, y = place
        turned = np.array([x * math.cos(A) + y * math.sin(A), y * math.cos(A) - x * math.sin(A), 60.0]) + e
        c, s = math.cos(B + beta), math.sin(B + beta)
        height = MACHINE.gauge_line_height + self.probe.length
        return np.array([b_x - s * turned[0] - c * turned[2], turned[1], b_z + c * turned[0] - s * turned[2] + height])

    def __call__(self, start, end):
        first, last = (where[:3] + self.probe.offset - self.center(*start[3:]) for where in (start, end))
        way = last - first
        a, b, c = way @ way, first @ way, first @ first - (10.0 + self.probe.tip_radius) ** 2
        if b * b < a * c:
            return None
        share = (-b - math.sqrt(b * b - a * c)) / a
        return start + share * (end - start) if 0 <= share <= 1 else None


@pytest.fixture(scope="module")
def clean(tmp_path_factory) -> CalibrationTouches:
    """The touches of the program's text, read back and run on that machine, its result file read."""
    done = run_program(axis_program(MACHINE, PROBE, "AXES"), "AXES.MPF", Carried())
    assert done.alarm is None
    file = tmp_path_factory.mktemp("axes") / "raw.csv"
    file.write_text(done.files["AXES_T"])
    return read_calibration_csv(file)


def test_axes_come_back_to_a_nanometre_without_noise(clean):
    """1e-6 mm and 1e-8 rad are asked: the file keeps nine decimals."""
    found = calibrate_axes(clean, MACHINE, PROBE)
    assert len(clean.axes) == 9 * 9
    np.testing.assert_allclose(found.fit.values, TRUTH, rtol=0, atol=1e-6)
    assert found.b_zero == pytest.approx(TRUTH[5], abs=1e-8)
    np.testing.assert_allclose(found.pivot_offset, TRUTH[:3], rtol=0, atol=1e-6)
    assert found.gauge_line_height == pytest.approx(MACHINE.gauge_line_height - 0.056, abs=1e-6)
    assert found.radius == pytest.approx(math.hypot(79.92, 0.15), abs=1e-6)
    assert found.azimuth == pytest.approx(math.atan2(0.15, 79.92), abs=1e-8)
    assert np.abs(found.fit.residuals).max() < 1e-7


def test_with_noise_they_are_as_sure_as_they_say(clean):
    """1 um, seeds 0 to 199: errors over their uncertainties scatter as Student's t, and few are beyond three."""
    over = []
    for seed in range(200):
        noise = np.random.default_rng(seed).normal(0.0, 1e-3, (len(clean.axes), 3))
        found = calibrate_axes(replace(clean, axes=clean.axes + np.pad(noise, ((0, 0), (0, 2)))), MACHINE, PROBE)
        over.append((found.fit.values - TRUTH) / found.fit.uncertainty)
    spare = found.fit.spare
    assert spare == 81 - 8
    wide = 5 * math.sqrt((2 + 6 / (spare - 4)) / 200)
    np.testing.assert_allclose(np.mean(np.square(over), axis=0), spare / (spare - 2), rtol=wide)
    # beyond three in 0.37 % of 1600: 6 expected, 18 would be five standard deviations
    assert (np.abs(over) > 3.0).sum() <= 18
    # a micrometre in a touch is less than that in the machine file
    assert (found.fit.uncertainty[:5] < 1e-3).all()


def test_nominal_machine_is_found_to_be_nominal(tmp_path):
    """And with B kept from 90 degrees by its travel."""
    short = MACHINE.model_copy(
        update={
            "axes": MACHINE.axes.model_copy(update={"B": MACHINE.axes.B.model_copy(update={"travel": (-10.0, 70.0)})})
        }
    )
    truth = np.array([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 80.0, 0.0])
    done = run_program(axis_program(short, PROBE, "AXES"), "AXES.MPF", Carried(truth=truth))
    (tmp_path / "raw.csv").write_text(done.files["AXES_T"])
    found = calibrate_axes(read_calibration_csv(tmp_path / "raw.csv"), short, PROBE)
    np.testing.assert_allclose(found.fit.values, truth, rtol=0, atol=1e-7)


def test_axial_place_of_the_sphere_and_of_the_apex_are_told_by_their_sum_only(clean):
    """The arbor's certificate 0.2 mm too long: the apex comes out 0.2 mm too near, all else the same."""
    longer = PROBE.model_copy(update={"work_sphere": PROBE.work_sphere.model_copy(update={"axial": 60.2})})
    found = calibrate_axes(clean, MACHINE, longer)
    np.testing.assert_allclose(found.fit.values, TRUTH - [0, 0, 0.2, 0, 0, 0, 0, 0], rtol=0, atol=1e-6)


def test_touches_that_do_not_tell_the_axes_are_refused(clean):
    level = clean.axes[:, 4] == 0.0
    one_swivel = replace(clean, target=clean.target[level], axes=clean.axes[level])
    with pytest.raises(InputError, match="the touches lie so that they do not tell the places of A and B"):
        calibrate_axes(one_swivel, MACHINE, PROBE)
    few = replace(clean, target=clean.target[:19], axes=clean.axes[:19])
    with pytest.raises(InputError, match="19 touches on the work_sphere: at least 20 are needed"):
        calibrate_axes(few, MACHINE, PROBE)
    off = clean.axes.copy()
    off[40, 2] += 0.1
    with pytest.raises(InputError, match=r"touch 41 on the work_sphere: lies .* um off what explains the touches best"):
        calibrate_axes(replace(clean, axes=off), MACHINE, PROBE)
    with pytest.raises(InputError, match="has no work_sphere"):
        calibrate_axes(clean, MACHINE, PROBE.model_copy(update={"work_sphere": None}))


def test_commands_make_a_machine_file_of_the_touches(tmp_path, command, refused):
    """nc calibrate --cycle axes -> calibrate: a new machine file, its comments kept, the sphere found where it is."""
    raw, new = tmp_path / "raw.csv", tmp_path / "machine.toml"
    status, out, _ = command("nc", "calibrate", "--cycle", "axes", "-o", tmp_path / "AXES.MPF")
    assert (status, out.split(": ")[1].split(",")[0]) == (0, "81 touches")
    plain = load_calibration(bundled("probe.toml"))
    done = run_program((tmp_path / "AXES.MPF").read_text(), "AXES", Carried(plain))
    raw.write_text(done.files["AXES_T"])
    status, out, _ = command("calibrate", raw, "--machine", "vertical_5axis.toml", "-o", new)
    assert status == 0
    assert "pivot offset y -0.08700 mm, u 0.000 um" in out
    assert "axis B lies at X 0.03400 mm" in out
    assert "B stands 0.010000 degrees beyond its reading" in out
    assert f"A stands {-math.degrees(math.atan2(0.15, 79.92)):.6f} degrees beyond" in out
    machine = load_milling_machine(new)
    np.testing.assert_allclose(machine.pivot_offset, TRUTH[:3], rtol=0, atol=1e-6)
    assert machine.gauge_line_height == pytest.approx(349.944, abs=1e-6)
    assert machine.axes == MACHINE.axes
    assert "# R_d: the reading of Z at which the gauge line is level with the B axis" in new.read_text()
    refused("lobing needs touches on the sphere of the table", "calibrate", raw, "--lobing", "-o", tmp_path / "x.toml")
    bare = tmp_path / "bare.toml"
    bare.write_text("\n".join(bundled("probe.toml").read_text().split("\n[work_sphere]")[:1]))
    arguments = ["--calibration", bare, "-o", tmp_path / "AX.MPF"]
    refused("bare.toml: the calibration file has no work_sphere", "nc", "calibrate", "--cycle", "axes", *arguments)
