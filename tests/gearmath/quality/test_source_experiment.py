"""The experiment of the source text re-enacted: 7 x 43 teeth, the same initial errors, from program text to metal."""

from __future__ import annotations

import numpy as np
import pytest

from gearmath.bevel.flank import blank_grid, solve_flank
from gearmath.machine.measuring import measure_member
from gearmath.quality.compensation import FlankTarget, predicted
from gearmath.specs.bevel_set import FLANKS, MEMBERS, SIDES, load_bevel_set
from gearmath.specs.simulated_machine import Probe, load_simulated_machine
from gearmath.specs.toml import bundled

SET = load_bevel_set(bundled("crown_gear_7x43.toml"))
SHOP = load_simulated_machine(bundled("source_experiment.toml"))
#: Source text: largest profile error, and cumulative pitch. [mm]
PROFILE, PITCH = {"pinion": -0.0266, "gear": -0.0208}, 0.0384


def cumulative_pitch(file, teeth, flank):
    """F_p by hand: every tooth's deviation at the reference point, as an arc by the lever of its normal."""
    points = file.select(flank)
    here = (points.row == 2) & (points.col == 4) & (points.tooth < teeth)
    R, n, deviation = points.point[here], points.normal[here], points.deviation[here]
    assert len(np.unique(points.tooth[here])) == teeth == here.sum()
    arc = deviation / (R[:, 0] * n[:, 1] - R[:, 1] * n[:, 0]) * np.hypot(R[:, 0], R[:, 1])
    return float(np.ptp(arc))


def not_correctable(member, name, file):
    """RMS that the best small change of all ten machine settings leaves, and RMS before; flank by flank if they may."""
    squares, count = np.zeros(2), 0
    for group in [FLANKS] if member.cutting == "completing" else [(flank,) for flank in FLANKS]:
        gradient, deviation = [], []
        for flank in group:
            nominal = solve_flank(member, name, flank, blank_grid(member))
            target = FlankTarget(member.flank(flank).vector, SIDES[flank], nominal, np.zeros(45))
            gradient.append(predicted(target, target.settings)[1][:, :10])
            deviation.append(file.select(flank, 0).deviation)
        rows, values = np.concatenate(gradient), np.concatenate(deviation)
        scaled = rows / np.maximum(np.abs(rows).max(axis=0), 1e-12)
        left = values - scaled @ np.linalg.lstsq(scaled, values, rcond=1e-9)[0]
        squares += (left @ left, values @ values)
        count += len(values)
    return np.sqrt(squares / count)


@pytest.mark.slow
@pytest.mark.parametrize("name", MEMBERS)
def test_committed_file_gives_the_initial_figures_of_the_source_text(mill, name):
    """To 0.1 um, and a fifth of the deviation at least is beyond all settings."""
    member = SET.member(name)
    metal = mill(SET, name, range(member.teeth), SHOP.model_copy(update={"probe": Probe()}))
    profile = np.concatenate([metal.select(flank, 0).deviation for flank in FLANKS])
    assert profile[np.argmax(np.abs(profile))] == pytest.approx(PROFILE[name], abs=1e-4)
    seen = measure_member(metal, member, name, SHOP.model_copy(update={"probe": Probe()}))
    assert max(cumulative_pitch(seen, member.teeth, flank) for flank in FLANKS) == pytest.approx(PITCH, abs=1e-4)
    assert max(cumulative_pitch(metal, member.teeth, flank) for flank in FLANKS) < 0.01
    left, before = not_correctable(member, name, metal)
    assert left >= 0.2 * before


def test_spectrum_is_the_one_that_was_asked_for():
    """Squareness, index, eccentricity, tilt, drift and probe; 10 um over 100 mm is 1e-4 rad."""
    assert SHOP.axes.squareness_x_z_um_per_m == 20.0
    assert (SHOP.work_axis.first_harmonic_arcsec, SHOP.work_axis.random_arcsec) == (10.0, 3.0)
    for name in MEMBERS:
        clamp = SHOP.measuring_clamp(name)
        assert clamp.eccentricity == 0.015
        assert np.radians(clamp.tilt) == pytest.approx(1e-4, rel=1e-3)
    assert np.linalg.norm(SHOP.measuring.drift.vector) == pytest.approx(0.005, rel=1e-12)
    assert (SHOP.probe.sigma_um, SHOP.probe.touches) == (0.5, 4)
