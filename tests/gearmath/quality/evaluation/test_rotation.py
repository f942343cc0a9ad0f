"""Rotation of the work: found by both flanks, taken out on the exact surface, and nothing of the gear goes with it."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from gearmath.bevel.flank import blank_grid
from gearmath.bevel.nominal_file import nominal_flank
from gearmath.quality.correction.member import correct
from gearmath.quality.evaluation.member import evaluate_member
from gearmath.specs.bevel_set import FLANKS
from gearmath.specs.flank_csv import join

UM = 1e-3
ARCSEC = math.radians(1 / 3600)
CORNERS = [0, 8, 22, 36, 44]


def turned(member, angle, index=0.0):
    return {flank: np.full(member.teeth, angle) + index for flank in FLANKS}


def around(member):
    return [i * member.teeth // 8 for i in range(8)]


@pytest.mark.parametrize(("name", "arcsec"), [("pinion", 30), ("pinion", -600), ("gear", 30)])
def test_pure_rotation_leaves_nothing_on_either_flank(clamped, gear_set, name, arcsec):
    """The witness's exact surface turned; at 10 minutes of arc the points lie 0.2 mm beside those of the grid."""
    member = gear_set.member(name)
    file = clamped(member, teeth=[0], index=turned(member, arcsec * ARCSEC))
    assert np.abs(file.deviation).min() > 1 * UM
    found = evaluate_member(file, member)
    assert np.abs(found.file.deviation).max() <= 0.01 * UM
    assert found.rotation.angle == pytest.approx(arcsec * ARCSEC, rel=1e-4)
    assert found.rotation.arc == pytest.approx(arcsec * ARCSEC * math.hypot(*file.point[22][:2]), rel=1e-3)
    assert found.file.header["phase_zeroed"] == "common"
    left = evaluate_member(file, member, rotated=False)
    assert left.rotation is None
    np.testing.assert_array_equal(left.file.deviation, file.deviation)
    assert left.file.header["phase_zeroed"] == "false"


def test_pure_rotation_gives_no_correction_of_settings(clamped, gear_set):
    member = gear_set.pinion
    file = clamped(member, teeth=[0], index=turned(member, 30 * ARCSEC))
    settings = correct(member, evaluate_member(file, member).file).settings
    for flank in FLANKS:
        change = settings[flank] - member.flank(flank).vector[:12]
        assert np.abs(change).max() < 1e-5  # mm and rad: what 0.01 um of deviation can ask for


def test_rotation_and_clamping_are_found_side_by_side_and_thickness_and_pitch_stay(clamped, gear_set):
    """Eccentric by 15 um, tilted, turned by 30 arcsec, teeth thicker by form, with uneven pitch."""
    member, seat = gear_set.pinion, (12 * UM, -9 * UM, 6e-5, 8e-5)
    uneven = 1e-5 * np.sin(3 * np.arange(12))  # no mean

    def thick(flank, z, r):
        return 0.006 + (1e-4 if flank == "concave" else 2e-4) * (z - 77)

    given = {"teeth": range(12), "places": CORNERS, "whole": (0, 6), "form": thick}
    file = clamped(member, seat, index=turned(member, 30 * ARCSEC, uneven), **given)
    still = clamped(member, index=turned(member, 0.0, uneven), **given)
    found = evaluate_member(file, member)
    wanted = evaluate_member(still, member, registered=False, rotated=False)
    # what the form itself would turn each flank by is in the rotation of both: by hand from the file at rest
    own = evaluate_member(still, member, registered=False).rotation.angle
    assert found.rotation.angle - own == pytest.approx(30 * ARCSEC, abs=2e-7)
    assert found.thickness.mean == pytest.approx(wanted.thickness.mean, abs=0.02 * UM)
    for flank in FLANKS:
        one, other = found.flanks[flank].pitch, wanted.flanks[flank].pitch
        np.testing.assert_allclose(one.cumulative, other.cumulative, rtol=0, atol=0.1 * UM)
    assert found.runout.total == pytest.approx(wanted.runout.total, abs=0.1 * UM)


def perfect(gear_set, teeth=range(12)):
    """The pinion's reference points, and tooth 0 in full, without a deviation."""
    grid = blank_grid(gear_set.pinion)
    files = [nominal_flank(gear_set.pinion, flank, grid, tooth=k) for k in teeth for flank in FLANKS]
    file = join([one if one.tooth[0] == 0 else one.pick((one.row == 2) & (one.col == 4)) for one in files])
    return replace(file, deviation=np.zeros(len(file)))


def with_deviation(file, deviation):
    return replace(file, point=file.point + deviation[:, None] * file.normal, deviation=deviation)


def test_thickness_is_no_rotation_and_rotation_no_thickness(gear_set):
    """Metal of the same arc on both flanks turns them opposite ways: nothing is taken out of it."""
    file = perfect(gear_set)
    lever = np.abs(file.point[:, 0] * file.normal[:, 1] - file.point[:, 1] * file.normal[:, 0])
    found = evaluate_member(with_deviation(file, 1e-4 * lever), gear_set.pinion, registered=False)
    assert abs(found.rotation.angle) < 1e-11
    np.testing.assert_allclose(found.file.deviation, 1e-4 * lever, rtol=0, atol=1e-8)
    radius = math.hypot(*file.point[22][:2])
    assert found.thickness.mean == pytest.approx(2 * 1e-4 * radius, rel=1e-6)


def test_rotation_is_as_sure_as_the_mean_of_its_points(gear_set):
    """24 points of 0.6 um, by hand: each counts a 24th of the angle that it alone would tell."""
    file = perfect(gear_set)
    stated = replace(file, uncertainty=np.full(len(file), 0.6 * UM))
    found = evaluate_member(stated, gear_set.pinion, registered=False)
    at = (file.row == 2) & (file.col == 4)
    lever = (file.point[:, 0] * file.normal[:, 1] - file.point[:, 1] * file.normal[:, 0])[at]
    expected = 0.6 * UM * math.sqrt(np.sum(1 / lever**2)) / 24
    assert found.rotation.uncertainty == pytest.approx(expected, rel=1e-9)
    assert found.rotation.teeth == 12
    silent = evaluate_member(file, gear_set.pinion, registered=False)
    assert silent.rotation.as_dict()["u_angle_arcsec"] is None


def test_one_flank_alone_has_no_rotation_in_common(gear_set):
    file = perfect(gear_set).select("concave")
    found = evaluate_member(with_deviation(file, np.full(len(file), 5 * UM)), gear_set.pinion)
    assert found.rotation is None
    why = "the convex flank was not measured: one flank alone does not tell it from thickness"
    assert f"rotation of the work not taken out: {why}" in found.remarks
    assert found.as_dict()["rotation"] is None


def test_chart_is_zero_at_the_reference_point_and_keeps_the_form(clamped, gear_set):
    """A tooth too thick by 20 um and crowned: the chart shows the crowning, the figures of the flank keep all."""
    member = gear_set.pinion
    z = clamped(member, teeth=[0]).point[22, 2]
    file = clamped(member, teeth=[0], form=lambda flank, at, r: 0.02 - 1e-4 * (at - z) ** 2)
    for flank in FLANKS:
        figures = evaluate_member(file, member, rotated=False).flanks[flank]
        assert figures.mean.at_reference == pytest.approx(0.02, abs=0.1 * UM)
        assert figures.chart.at_reference == pytest.approx(0, abs=1e-12)
        assert figures.chart.deviation.max() < 4 * UM  # the arm of the turning is not the same all over the flank
        assert figures.as_dict()["zeroed_at_reference"]["taken_off_um"] == pytest.approx(20, abs=0.1)
