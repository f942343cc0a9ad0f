"""A grade needs a figure that is surer than the step to the next grade, and a runout that is more than noise."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from gearmath.quality.evaluation.closing import Closing
from gearmath.quality.evaluation.grades import grade_member
from gearmath.quality.evaluation.pitch import Pitch, evaluate_pitch, pitch_uncertainties
from gearmath.quality.evaluation.spaces import Runout
from gearmath.quality.evaluation.tolerance import gear_data, iso17485
from gearmath.specs.bevel_set import FLANKS, load_bevel_set
from gearmath.specs.flank_csv import flank_file, join
from gearmath.specs.toml import bundled

PINION = load_bevel_set(bundled("nasa_tp3096_12x36.toml")).pinion
ARC = np.array([0.0, 2.0, 5.0, 3.0, 1.0, 0.0, -1.0, -2.0, -3.0, -2.0, 0.0, 1.0]) * 1e-3
PITCHES = {flank: Pitch(flank, ARC / 40, ARC, None) for flank in FLANKS}
STILL = Closing("still", np.zeros(0), np.zeros(0), {}, 0.0)


def runout(size, noise):
    """Balls that lie farther out on one side by ``size``, each with independent noise."""
    azimuth = np.arange(12) * np.pi / 6
    return Runout(size / 2 * np.cos(azimuth), azimuth, noise**2 * np.eye(12))


def verdict(ball, u=0.0):
    return grade_member(PINION, PITCHES, ball, STILL, dict.fromkeys(FLANKS, u))


def test_runout_is_graded_where_it_is_more_than_noise_alone_gives():
    """The range of 12 normal values is 3.258 standard deviations on average (tables of control charts, d2)."""
    assert "F_r" in verdict(runout(0.0034, 0.001)).grades
    found = verdict(runout(0.0031, 0.001))
    assert found.grade is None
    assert set(found.grades) == {"f_pt", "F_p"}
    assert found.withheld["F_r"].startswith("noise of the points alone gives F_r 3.2")
    assert found.withheld["F_r"].endswith(" um, and 3.10 um were read")


def test_figure_is_graded_where_its_uncertainty_is_below_the_step_of_the_grades():
    """f_pt is 3.0 um; the step from the grade that holds it to the next one, of the rounded tolerances."""
    data = gear_data(PINION)
    grade = verdict(runout(0.02, 1e-4)).grades["f_pt"]
    fine, coarse = (
        iso17485(data.mean_normal_module, data.tolerance_diameter, each).rounded["f_pt"] for each in (grade, grade + 1)
    )
    step = (coarse - fine) * 1e-3
    assert "f_pt" in verdict(runout(0.02, 1e-4), 0.99 * step).grades
    found = verdict(runout(0.02, 1e-4), 1.01 * step)
    assert "f_pt" not in found.grades
    assert found.withheld["f_pt"].endswith(
        f"larger than the step of {coarse - fine:g} um from grade {grade} to {grade + 1}"
    )
    assert all("f_pt" not in grades for grades in found.flanks.values())


def test_uncertainty_of_pitch_is_the_scatter_of_the_difference_of_two_teeth():
    """Points at 40 mm radius whose normals lie along the circle: an arc is the deviation, and two of them differ."""
    turn = np.arange(12) * np.pi / 6
    point = 40 * np.stack([np.cos(turn), np.sin(turn), 0 * turn], axis=1)
    normal = np.stack([-np.sin(turn), np.cos(turn), 0 * turn], axis=1)
    header = {"reference_point": "2,4", "member_teeth": "12"}
    row, col = np.full(12, 2), np.full(12, 4)
    files = [
        replace(flank_file(header, "pinion", flank, 0, row, col, point, normal, 0 * turn), tooth=np.arange(12))
        for flank in FLANKS
    ]
    file = join(files)
    assert pitch_uncertainties(file, 12, 0.001) == pytest.approx(dict.fromkeys(FLANKS, 0.001 * np.sqrt(2)))
    rng = np.random.default_rng(2)
    single = []
    for _ in range(300):
        off = 0.001 * rng.standard_normal(24)
        noisy = replace(file, deviation=off, point=file.point + off[:, None] * file.normal)
        arc = evaluate_pitch(noisy, 12, "concave").cumulative
        single.append(arc[5] - arc[4])
    assert np.std(single) == pytest.approx(0.001 * np.sqrt(2), rel=0.15)
