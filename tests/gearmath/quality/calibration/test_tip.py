"""Ring and sphere: the tip that touched them comes back, with what its touches leave and how sure they are of it."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from gearmath.errors import InputError
from gearmath.machine.control.executor import run_program
from gearmath.machine.measuring.probe_errors import ErringProbe
from gearmath.machine.planning.artefact_targets import sphere_directions
from gearmath.machine.writing.calibrating import calibration_program
from gearmath.quality.calibration.tip import calibrate_on_ring, calibrate_on_sphere
from gearmath.specs.calibration import load_calibration, save_calibration
from gearmath.specs.milling_machine import load_milling_machine
from gearmath.specs.simulated_machine import Probe, SimulatedMachine
from gearmath.specs.toml import bundled
from gearmath.specs.touch_csv import RING, CalibrationTouches, read_calibration_csv

MACHINE = load_milling_machine(bundled("vertical_5axis.toml"))
PROBE = load_calibration(bundled("probe.toml"))
BENT = PROBE.model_copy(update={"offset": (0.031, -0.047, 0.012), "tip_radius": 0.7432})
LOBES = {"lobing_um": 1.5, "lobing_phase": 25.0}


@pytest.fixture(scope="module")
def touches(tmp_path_factory, artefacts):
    """``touches(sigma_um, lobing_um, ...)``: the calibration program run on ring and sphere with the bent probe."""
    text = calibration_program(MACHINE, PROBE, "CAL")

    def run(**errors) -> CalibrationTouches:
        shop = SimulatedMachine(title="probe", seed=2, probe=Probe(**errors))
        done = run_program(text, "CAL.MPF", ErringProbe(artefacts(BENT), shop))
        assert done.alarm is None
        file = tmp_path_factory.mktemp("calibration") / "c.csv"
        file.write_text(done.files["CAL_T"])
        return read_calibration_csv(file)

    return run


def from_ring(place, ring):
    """Distances (n,) of points (n,3) from its body, a ring of rectangular section that stands on the table."""
    away = np.hypot(*(place - ring.center)[:, :2].T) - (ring.diameter + ring.face.width) / 2
    up = place[:, 2] - ring.face.seat - ring.face.height / 2
    off = np.abs(np.stack([away, up])) - np.array([[ring.face.width], [ring.face.height]]) / 2
    return np.hypot(*np.maximum(off, 0.0)) + np.minimum(off.max(axis=0), 0.0)


def from_sphere(place, sphere, stem):
    """Distances (n,) of points (n,3) from the sphere, and from a stem of this diameter that leads straight down."""
    off = place - sphere.center
    below = off - np.minimum(off[:, 2:], 0.0) * [0.0, 0.0, 1.0]
    return np.minimum(np.linalg.norm(off, axis=1) - sphere.diameter / 2, np.linalg.norm(below, axis=1) - stem / 2)


@pytest.mark.parametrize("true", [PROBE, BENT], ids=["as in the file", "bent"])
def test_tip_and_stylus_meet_ring_and_sphere_at_the_touches_only(artefacts, true):
    """Every block in steps of 0.1 mm, against ring, face, table, sphere and a stem of 0.6 of the sphere's diameter."""
    done = run_program(calibration_program(MACHINE, PROBE, "CAL"), "CAL.MPF", artefacts(true))
    assert done.alarm is None
    path, ring, sphere = done.path, PROBE.ring, PROBE.sphere
    assert path.axes[0, 2] == MACHINE.travel[2, 1]  # begins above everything
    moving, touching, stylus = [], [], []
    # a touch is a measuring block from which the next one goes back to where it began
    touch = path.measuring.copy()
    touch[1:-1] &= np.isclose(path.axes[2:], path.axes[:-2], rtol=0.0, atol=1e-9).all(axis=1)
    for k in range(1, len(path.axes)):
        way = path.axes[k] - path.axes[k - 1]
        assert (way[3:] == 0.0).all()
        steps = np.linspace(0.0, 1.0, 2 + int(np.linalg.norm(way) / 0.1))[:, None]
        tip = (path.axes[k - 1] + steps * way)[:, :3] + true.tip_offset
        stem = np.concatenate([tip + np.array([0.0, 0.0, h]) for h in np.arange(1.0, PROBE.stylus_length, 0.5)])
        away, beside = (
            np.minimum.reduce(
                [from_ring(at, ring), from_sphere(at, sphere, 0.6 * sphere.diameter), at[:, 2] - ring.face.seat]
            )
            for at in (tip, stem)
        )
        away -= true.tip_radius
        at_touch = touch[k] or touch[k - 1]
        (touching if at_touch else moving).append(away.min())
        if at_touch:
            moving.append(away[0 if touch[k] else -1])  # where it starts, and where it goes back to
        stylus.append(beside.min() - true.stylus_radius)
    # guarded ways: from home 1, 1, 1; down 1, 4, 25; sideways 0, 3, 24
    assert len(done.files["CAL_T"].splitlines()) - 2 == touch.sum() == path.measuring.sum() - 60
    assert min(touching) > -1e-6
    assert min(moving) > 0.5
    assert min(stylus) > 0.1


def without(touches, keep):
    return replace(touches, target=touches.target[keep], axes=touches.axes[keep])


def moved(touches, noise):
    return replace(touches, axes=touches.axes + np.pad(noise, ((0, 0), (0, 2))))


def test_sphere_gives_back_the_tip_that_touched_it(touches):
    found = touches()
    assert (found.target == "sphere").sum() == len(sphere_directions()) == 25
    tip = calibrate_on_sphere(found, PROBE.sphere, PROBE)
    assert tip.radius == pytest.approx(0.7432, abs=1e-8)
    np.testing.assert_allclose(tip.offset, BENT.offset, rtol=0, atol=1e-8)
    assert tip.residual < 1e-8
    assert tip.fit.spare == 21


def test_ring_and_its_face_give_back_radius_and_offset_although_the_first_touches_are_off_centre(touches):
    tip = calibrate_on_ring(touches(), PROBE.ring, PROBE)
    assert tip.radius == pytest.approx(0.7432, abs=1e-8)
    np.testing.assert_allclose(tip.offset, BENT.offset, rtol=0, atol=1e-8)
    assert tip.residual < 1e-8
    assert tip.fit.spare == 6 + 4 - 4


def test_ring_without_its_face_tells_nothing_of_z(touches):
    found = touches()
    start = PROBE.model_copy(update={"offset": (0.0, 0.0, 0.3)})
    tip = calibrate_on_ring(without(found, found.target != "ring_face"), PROBE.ring, start)
    np.testing.assert_allclose(tip.offset, [0.031, -0.047, 0.3], rtol=0, atol=1e-8)
    assert np.isnan(tip.offset_uncertainty).tolist() == [False, False, True]


def test_z_of_the_face_by_hand(touches):
    """z_cm = D + F + r - Z_c: 385 + 25 + 0.7432 less where Z stood."""
    found = touches()
    heights = found.axes[found.target == "ring_face", 2]
    np.testing.assert_allclose(385.0 + 25.0 + 0.7432 - heights, 0.012, rtol=0, atol=1e-8)


def test_lobes_come_back_where_they_are_asked_for_and_spoil_the_fit_where_not(touches):
    found = touches(**LOBES)
    with_lobes, without_lobes = (calibrate_on_sphere(found, PROBE.sphere, PROBE, lobes) for lobes in (True, False))
    # the touch goes along the nominal normal of a tip that is 0.05 mm off: the lobe is taken 0.05/11 rad beside
    assert with_lobes.lobes[0] == pytest.approx(1.5e-3, abs=2e-6)
    assert math.degrees(with_lobes.lobes[1]) == pytest.approx(25.0, abs=0.2)
    assert with_lobes.radius == pytest.approx(0.7432, abs=2e-5)
    np.testing.assert_allclose(with_lobes.offset, BENT.offset, rtol=0, atol=2e-5)
    assert with_lobes.residual < 3e-5
    assert with_lobes.fit.spare == 19
    assert without_lobes.residual > 1e-3


def test_known_lobes_are_taken_into_account(touches):
    found = touches(**LOBES)
    knowing = PROBE.model_copy(update=LOBES)
    for tip in (calibrate_on_sphere(found, PROBE.sphere, knowing), calibrate_on_ring(found, PROBE.ring, knowing)):
        assert tip.radius == pytest.approx(0.7432, abs=3e-5)
        assert tip.lobes == pytest.approx((1.5e-3, math.radians(25.0)), abs=1e-9)


@pytest.mark.parametrize("how", ["sphere", "lobes", "ring"])
def test_uncertainties_are_those_of_the_scatter(touches, how):
    """1 um of noise, seeds 0 to 199: errors over their uncertainties scatter as Student's t, and so does the noise."""
    clean, over, noises = touches(), [], []
    truth = np.array([0.7432, *BENT.offset, 0.0, 0.0])
    for seed in range(200):
        noise = np.random.default_rng(seed).normal(0.0, 1e-3, (len(clean.axes), 3))
        found = moved(clean, noise)
        if how == "ring":
            tip = calibrate_on_ring(found, PROBE.ring, PROBE)
        else:
            tip = calibrate_on_sphere(found, PROBE.sphere, PROBE, how == "lobes")
        p = len(tip.fit.values)
        over.append((tip.fit.values - truth[:p]) / tip.fit.uncertainty)
        noises.append(tip.fit.noise)
    spare = tip.fit.spare
    variance = spare / (spare - 2)  # of Student's t; its sample variance over 200 runs, five standard deviations wide
    kurtosis = 3 + 6 / (spare - 4)
    wide = 5 * math.sqrt((kurtosis - 1) / 200)
    np.testing.assert_allclose(np.mean(np.square(over), axis=0), variance, rtol=wide)
    assert np.mean(np.square(noises)) == pytest.approx(1e-6, rel=5 * math.sqrt(2 / spare / 200))


def test_touch_that_missed_is_named_and_not_averaged_in(touches):
    found = touches()
    noise = np.zeros((len(found.axes), 3))
    noise[found.target == "sphere", 2] = np.where(np.arange(25) == 6, 0.15, 0.0)
    with pytest.raises(InputError, match=r"touch 7 on the sphere: lies .* um off what explains .* the limit is 20 um"):
        calibrate_on_sphere(moved(found, noise), PROBE.sphere, PROBE)
    noise = np.where((found.target == "ring_y_low")[:, None], [0.0, 0.2, 0.0], 0.0)
    with pytest.raises(InputError, match=r"touch 'ring_y_(low|high)': lies .* um off"):
        calibrate_on_ring(moved(found, noise), PROBE.ring, PROBE)


def test_calibration_with_too_few_touches_is_refused(touches):
    found = touches()
    keep = found.target != "ring_y_low"
    with pytest.raises(InputError, match=f"the touch 'ring_y_low' is missing: the ring needs {', '.join(RING)}"):
        calibrate_on_ring(without(found, keep), PROBE.ring, PROBE)
    some = without(found, np.arange(len(found.axes)) < len(found.axes) - 21)
    with pytest.raises(InputError, match="4 touches on the sphere: at least 5 are needed for a tip"):
        calibrate_on_sphere(some, PROBE.sphere, PROBE)
    most = without(found, np.arange(len(found.axes)) < len(found.axes) - 1)
    with pytest.raises(InputError, match="24 touches on the sphere: at least 25 are needed for a tip with lobes"):
        calibrate_on_sphere(most, PROBE.sphere, PROBE, lobes=True)
    around = without(found, np.flatnonzero(found.target == "sphere")[1:9])
    with pytest.raises(InputError, match="the touches lie so that they do not tell the tip"):
        calibrate_on_sphere(around, PROBE.sphere, PROBE)


def test_calibration_is_written_whole_with_its_comments(tmp_path):
    save_calibration(bundled("probe.toml"), tmp_path / "new.toml", 0.7512345, np.array([0.01, 0.02, -0.03]))
    text = (tmp_path / "new.toml").read_text()
    assert "# spindle gauge line to the centre of the tip" in text
    new = load_calibration(tmp_path / "new.toml")
    assert (new.tip_radius, new.offset, new.lobing_um) == (0.7512345, (0.01, 0.02, -0.03), 0.0)
    save_calibration(tmp_path / "new.toml", tmp_path / "lobes.toml", 0.75, np.zeros(3), (0.0012, 0.5))
    lobes = load_calibration(tmp_path / "lobes.toml")
    assert (lobes.lobing_um, lobes.lobing_phase) == (1.2, pytest.approx(math.degrees(0.5), abs=1e-4))
    assert lobes.ring == PROBE.ring
    save_calibration(tmp_path / "lobes.toml", tmp_path / "none.toml", 0.75, np.zeros(3))
    assert "lobing" not in (tmp_path / "none.toml").read_text()
    with pytest.raises(InputError, match=r"stylus_radius 0\.5 must be less than tip_radius 0\.4"):
        save_calibration(bundled("probe.toml"), tmp_path / "bad.toml", 0.4, np.zeros(3))
    assert not (tmp_path / "bad.toml").exists()


def test_lobing_command_writes_what_it_found(tmp_path, command, refused, artefacts):
    shop = SimulatedMachine(title="probe", seed=2, probe=Probe(sigma_um=0.2, **LOBES))
    raw, tip = tmp_path / "c.csv", tmp_path / "tip.toml"
    done = run_program(calibration_program(MACHINE, PROBE, "CAL"), "CAL.MPF", ErringProbe(artefacts(BENT), shop))
    raw.write_text(done.files["CAL_T"])
    status, out, _ = command("calibrate", raw, "--lobing", "-o", tip)
    assert status == 0
    (line,) = (line for line in out.splitlines() if line.startswith("lobes"))
    amplitude, u = float(line.split()[1]), float(line.split()[-2])
    assert amplitude == pytest.approx(1.5, abs=4 * u)
    # two of 19 spare touches' worth: noise of 0.2 um, touches spread over sin² of their angles
    assert 0.02 < u < 0.2
    assert load_calibration(tip).lobing_um == pytest.approx(1.5, abs=0.4)
    lines = raw.read_text().splitlines()
    ring = [line for line in lines if "sphere" not in line and "planned" not in line]  # a run that planned no sphere
    raw.write_text("\n".join(ring) + "\n")
    refused("lobing needs touches on the sphere", "calibrate", raw, "--lobing", "-o", tip)
    status, out, _ = command("calibrate", raw, "-o", tip)
    assert status == 0
    assert "10 touches" in out
