"""A simulated measurement: what clamping, drift, lobes and noise make of a member, worked out by hand."""

from __future__ import annotations

import math

import numpy as np
import pytest

from gearmath.bevel.flank import blank_grid
from gearmath.bevel.nominal_file import nominal_flank
from gearmath.machine.measuring.measurement import measure_member
from gearmath.specs.bevel_set import FLANKS, MEMBERS
from gearmath.specs.flank_csv import FlankFile, flank_file, join
from gearmath.specs.simulated_machine import Drift, Mounting, Probe, SimulatedMachine, SimulatedMeasuring


def true_file(gear_set, name, deviation=0.0):
    """The whole grid of tooth 0 and the reference points of the others, ``deviation`` of metal left everywhere."""
    member = gear_set.member(name)
    grid, files = blank_grid(member), []
    for flank in FLANKS:
        for tooth in range(member.teeth):
            one = nominal_flank(member, flank, grid, tooth=tooth)
            keep = np.full(len(one), tooth == 0) | ((one.row == 2) & (one.col == 4))
            point, normal, n = one.point[keep], one.normal[keep], int(keep.sum())
            files.append(
                flank_file(
                    one.header,
                    name,
                    flank,
                    tooth,
                    one.row[keep],
                    one.col[keep],
                    point + deviation * normal,
                    normal,
                    np.full(n, deviation),
                )
            )
    return join(files)


def shop(**what) -> SimulatedMachine:
    return SimulatedMachine(title="wrong", seed=3, **what)


def to_machine(member, tooth_angle, root_angle):
    """M(B) Rz(-A) of the conventions, A turning the azimuth ``tooth_angle`` to the top."""
    c, s = math.cos(tooth_angle), math.sin(tooth_angle)
    B = math.radians(root_angle)
    swivel = np.array([[-math.sin(B), 0, -math.cos(B)], [0, 1, 0], [math.cos(B), 0, -math.sin(B)]])
    return swivel @ np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]])


def azimuth(file, k):
    """Of the middle between the two flanks at the place of row k."""
    same = (file.tooth == file.tooth[k]) & (file.row == file.row[k]) & (file.col == file.col[k])
    assert same.sum() == 2
    x, y = (file.point - file.deviation[:, None] * file.normal)[same][:, :2].sum(axis=0)
    return math.atan2(y, x)


@pytest.mark.parametrize("name", MEMBERS)
def test_perfect_measurement_shows_the_metal_and_tooth_0_twice(gear_set, name):
    true, member = true_file(gear_set, name, 0.01), gear_set.member(name)
    seen = measure_member(true, member, shop())
    assert len(seen) == len(true) + 10
    np.testing.assert_allclose(seen.deviation, 0.01, rtol=0, atol=1e-12)
    np.testing.assert_array_equal(seen.tooth[-10:], member.teeth)
    assert list(seen.flank[-10:]) == ["concave"] * 5 + ["convex"] * 5
    for k in range(-10, 0):
        first = seen.select(seen.flank[k], 0)
        same = (first.row == seen.row[k]) & (first.col == seen.col[k])
        np.testing.assert_allclose(seen.point[k], first.point[same][0], rtol=0, atol=1e-12)
    assert (seen.uncertainty == 0.0).all()


@pytest.mark.parametrize("name", MEMBERS)
def test_clamping_moves_the_work_against_the_probe(gear_set, name):
    """δ = (e + ω × R)·n to first order: the opposite of what the same seat does to the cut."""
    seat = Mounting(eccentricity=0.02, eccentricity_direction=35.0, tilt=0.01, tilt_direction=-70.0)
    clamp = SimulatedMeasuring(**{name: seat})
    seen = measure_member(true_file(gear_set, name), gear_set.member(name), shop(measuring=clamp))
    at, about = math.radians(35.0), math.radians(-70.0)
    e = 0.02 * np.array([math.cos(at), math.sin(at), 0.0])
    omega = math.radians(0.01) * np.array([math.cos(about), math.sin(about), 0.0])
    nominal = seen.point - seen.deviation[:, None] * seen.normal
    expected = ((e + np.cross(omega, nominal)) * seen.normal).sum(axis=1)
    # second order: the square of the tilt times the size of the member
    np.testing.assert_allclose(seen.deviation, expected, rtol=0, atol=math.radians(0.01) ** 2 * 200)
    assert np.ptp(expected) > 0.01


@pytest.mark.parametrize("name", MEMBERS)
def test_drift_grows_evenly_from_the_first_touch_to_the_last(gear_set, name):
    """The work moves by d in the machine: d·(M(B) Rz(-A) n), and so the repeated tooth is off its first touch."""
    member, d = gear_set.member(name), np.array([0.003, 0.004, -0.005])
    drift = SimulatedMeasuring(drift=Drift(X_um=3.0, Y_um=4.0, Z_um=-5.0))
    seen = measure_member(true_file(gear_set, name), member, shop(measuring=drift))
    for k in range(0, len(seen), 7):
        normal = to_machine(member, azimuth(seen, k), member.blank.root_angle) @ seen.normal[k]
        assert seen.deviation[k] == pytest.approx(k / (len(seen) - 1) * d @ normal, abs=1e-9)
    assert np.abs(seen.deviation[-2:]).max() > 1e-3


@pytest.mark.parametrize("name", MEMBERS)
def test_lobes_follow_the_direction_of_the_touch_in_the_machine(gear_set, name):
    member = gear_set.member(name)
    seen = measure_member(true_file(gear_set, name), member, shop(probe=Probe(lobing_um=2.0, lobing_phase=10.0)))
    for k in range(0, len(seen), 5):
        x, y, _ = to_machine(member, azimuth(seen, k), member.blank.root_angle) @ seen.normal[k]
        expected = 0.002 * math.cos(3 * (math.atan2(y, x) - math.radians(10.0))) * math.hypot(x, y)
        assert seen.deviation[k] == pytest.approx(expected, abs=1e-9)


def test_noise_is_that_of_the_average_and_its_own_in_every_run(gear_set):
    """0.8 um in a touch is 0.4 um in the average of four."""
    true, member = true_file(gear_set, "gear"), gear_set.member("gear")
    noisy = shop(probe=Probe(sigma_um=0.8, touches=4))
    files: list[FlankFile] = [measure_member(true, member, noisy, run) for run in range(1, 41)]
    again = measure_member(true, member, noisy, 1)
    np.testing.assert_array_equal(files[0].deviation, again.deviation)
    assert not np.isclose(files[0].deviation, files[1].deviation, rtol=0, atol=1e-9).any()
    everything = np.concatenate([file.deviation for file in files])
    assert len(everything) == 40 * 170
    assert np.std(everything) == pytest.approx(0.0004, rel=4 / math.sqrt(2 * len(everything)))
    np.testing.assert_allclose(files[0].uncertainty, 0.0004, rtol=1e-12)
