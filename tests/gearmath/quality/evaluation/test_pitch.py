"""Pitch of four teeth, worked by hand."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from gearmath.errors import InputError
from gearmath.quality.evaluation.pitch import evaluate_pitch, index_correction, reference_point

UM = 1e-3
DEVIATIONS = [1 * UM, 4 * UM, -1 * UM, 6 * UM]


def test_four_teeth_by_hand(teeth):
    """Deviations 1, 4, -1, 6 µm in the direction of rotation: s = 0, 3, -2, 5; f_pt = -5, 3, -5, 7; F_p = 7 µm."""
    pitch = evaluate_pitch(teeth(DEVIATIONS), 4, "concave")
    np.testing.assert_allclose(pitch.cumulative, np.array([0, 3, -2, 5]) * UM, atol=1e-15)
    np.testing.assert_allclose(pitch.single, np.array([-5, 3, -5, 7]) * UM, atol=1e-15)
    assert pitch.total == pytest.approx(7 * UM, abs=1e-15)
    assert pitch.single.sum() == pytest.approx(0, abs=1e-15)
    np.testing.assert_allclose(pitch.turning, np.array([0, 3, -2, 5]) * UM / 50, atol=1e-16)


def test_normal_that_leans_away_from_the_rotation_takes_a_larger_turn(teeth):
    """At 60° half of the motion goes along the normal: the same deviations are twice the arc."""
    pitch = evaluate_pitch(teeth(DEVIATIONS, slope=math.radians(60)), 4, "concave")
    np.testing.assert_allclose(pitch.cumulative, 2 * np.array([0, 3, -2, 5]) * UM, atol=1e-14)


def test_normal_against_the_rotation_turns_the_sign(teeth):
    pitch = evaluate_pitch(teeth(DEVIATIONS, slope=math.pi), 4, "concave")
    np.testing.assert_allclose(pitch.cumulative, -np.array([0, 3, -2, 5]) * UM, atol=1e-15)


def test_angle_but_not_arc_depends_on_the_radius(teeth):
    small, large = (evaluate_pitch(teeth(DEVIATIONS, radius=r), 4, "concave") for r in (25.0, 100.0))
    np.testing.assert_allclose(small.cumulative, large.cumulative, atol=1e-15)
    np.testing.assert_allclose(small.turning, 4 * large.turning, atol=1e-16)


def test_order_of_the_teeth_in_the_file_does_not_matter(teeth):
    pitch = evaluate_pitch(teeth(DEVIATIONS, order=[2, 0, 3, 1]), 4, "concave")
    np.testing.assert_allclose(pitch.cumulative, np.array([0, 3, -2, 5]) * UM, atol=1e-15)


def test_a_common_deviation_of_all_teeth_is_no_pitch_error(teeth):
    pitch = evaluate_pitch(teeth([0.02] * 4), 4, "concave")
    np.testing.assert_allclose(pitch.cumulative, 0, atol=1e-16)
    assert pitch.total == 0


def test_index_correction_turns_back_the_mean_of_both_flanks_and_leaves_tooth_0(teeth):
    first, second = (evaluate_pitch(teeth(d), 4, "concave") for d in (DEVIATIONS, [0, 1 * UM, 0, 1 * UM]))
    by_hand = -np.array([0, (3 + 1) / 2, -2 / 2, (5 + 1) / 2]) * UM / 50
    np.testing.assert_allclose(index_correction([first, second]), by_hand, atol=1e-16)


def test_tooth_missing_on_one_flank_or_on_both_is_told_by_what_there_is(teeth):
    """s = 0, 3, -, 5 and 0, 3, -2, 5 µm give 0, 3, -2, 5; with both silent at tooth 2, the middle of 3 and 5."""
    one = evaluate_pitch(teeth([1 * UM, 4 * UM, np.nan, 6 * UM]), 4, "concave")
    other = evaluate_pitch(teeth(DEVIATIONS), 4, "concave")
    np.testing.assert_allclose(index_correction([one, other]), -np.array([0, 3, -2, 5]) * UM / 50, atol=1e-16)
    np.testing.assert_allclose(index_correction([one, one]), -np.array([0, 3, 4, 5]) * UM / 50, atol=1e-16)


def test_tooth_0_missing_on_one_flank_leaves_the_zero_to_the_other(teeth):
    one = evaluate_pitch(teeth([np.nan, 4 * UM, -1 * UM, 6 * UM]), 4, "concave")
    other = evaluate_pitch(teeth(DEVIATIONS), 4, "concave")
    assert np.isnan(one.cumulative[0])
    np.testing.assert_allclose(index_correction([one, other]), -np.array([0, 3, -2, 5]) * UM / 50, atol=1e-16)


def test_flanks_without_a_common_tooth_are_refused(teeth):
    one = evaluate_pitch(teeth([np.nan, 4 * UM, np.nan, 6 * UM]), 4, "concave")
    other = evaluate_pitch(teeth([1 * UM, np.nan, -1 * UM, np.nan]), 4, "concave")
    with pytest.raises(InputError, match=r"^pitch: no tooth was measured on both flanks"):
        index_correction([one, other])
    assert one.as_dict()["max_f_pt_um"] is None


def test_one_tooth_has_no_pitch(teeth):
    assert evaluate_pitch(teeth(DEVIATIONS, order=[2]), 4, "concave") is None
    assert evaluate_pitch(teeth(DEVIATIONS), 4, "convex") is None


def test_tooth_that_was_not_measured_withholds_the_maxima_and_nothing_else(teeth):
    """s = 0, -, -2, 5 µm: the teeth stand where they stand; the largest may be at the tooth that is not there."""
    pitch = evaluate_pitch(teeth(DEVIATIONS, order=[0, 2, 3]), 4, "concave")
    np.testing.assert_allclose(pitch.cumulative, np.array([0, np.nan, -2, 5]) * UM, rtol=1e-3)
    assert pitch.withheld == "concave flank: no reading of tooth 1 (1 of 4)"
    values = pitch.as_dict()
    assert (values["F_p_um"], values["max_f_pt_um"]) == (None, None)
    assert values["cumulative_um"][1] is None


def test_points_beside_the_reference_point_are_no_pitch(teeth):
    assert evaluate_pitch(teeth(DEVIATIONS, place=(2, 5)), 4, "concave") is None


@pytest.mark.parametrize("text", ["", "2", "2,4,6", "a,b", "2.0,4"])
def test_reference_point_that_is_no_pair_is_refused(teeth, text):
    file = teeth(DEVIATIONS)
    with pytest.raises(InputError, match=r"^reference_point = .*: must be 'row,col'$"):
        reference_point(replace(file, header=file.header | {"reference_point": text}))
