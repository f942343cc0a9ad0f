"""Pitch, drift, runout and thickness of four teeth, worked by hand: both flanks, both hands."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from gearmath.quality.evaluation.drift import without_drift
from gearmath.quality.evaluation.pitch import evaluate_pitch
from gearmath.quality.evaluation.spaces import evaluate_runout, evaluate_thickness
from gearmath.specs.flank_csv import flank_file, join

UM = 1e-3
HALF = math.radians(15)
HEADER = {
    "member": "pinion",
    "member_teeth": "4",
    "frame": "w",
    "unit": "mm",
    "grid": "5x9",
    "margins": "0.1,0.1",
    "reference_point": "2,4",
    "phase_zeroed": "false",
    "tip_radius_mm": "0",
    "settings_sha256": "0" * 64,
}


def about(angle):
    c, s = math.cos(angle), math.sin(angle)
    return np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])


def row(flank, tooth, azimuth, normal, deviation, radius=50.0):
    """One point at ``azimuth`` from the middle of its space; ``normal`` by r, t, z of the middle."""
    turn = about(math.pi / 2 * tooth)
    R = turn @ about(azimuth) @ [radius, 0, 20.0]
    n = turn @ np.array(normal)
    point = (R + deviation * n)[None]
    return flank_file(
        HEADER, "pinion", flank, tooth, np.array([2]), np.array([4]), point, n[None], np.array([deviation])
    )


def spaces(low, high, first="concave", lean=0.0, order=range(4)):
    """Four spaces of 30° at radius 50: flanks 15° before and behind the middle, normals 0.6 out and 0.8 across.

    ``lean`` gives the normals a part along the axis, of one sign for the right hand and of the other for the left.
    """
    last = "convex" if first == "concave" else "concave"
    scale = math.sqrt(1 - lean**2)
    files = []
    for tooth in order:
        files.append(row(first, tooth, -HALF, (0.6 * scale, 0.8 * scale, lean), low[tooth % 4]))
        files.append(row(last, tooth, HALF, (0.6 * scale, -0.8 * scale, -lean), high[tooth % 4]))
    return join(files)


@pytest.mark.parametrize("hand", [1, -1])
@pytest.mark.parametrize(("flank", "side"), [("concave", 1), ("convex", -1)])
def test_pitch_of_both_flanks_and_both_hands_by_hand(flank, side, hand):
    """n·t = ±0.8, ± by flank and hand: deviations 4, -8, 12, 0 µm are arcs of 5, -15 ... : s = 0, -15, 10, -5.

    f_pt = 5, -15, 25, -15 and F_p = 25 µm; on a flank that looks back all signs but that of F_p are the other ones.
    """
    sign, values = side * hand, np.array([4, -8, 12, 0]) * UM
    files = [row(flank, i, 0.0, (0, 0.8 * sign, 0.6 * hand), d) for i, d in enumerate(values)]
    pitch = evaluate_pitch(join(files), 4, flank)
    # the lever is that of the touched point: 12 µm of 50 mm
    np.testing.assert_allclose(pitch.cumulative, sign * np.array([0, -15, 10, -5]) * UM, rtol=3e-4, atol=1e-12)
    np.testing.assert_allclose(pitch.single, sign * np.array([5, -15, 25, -15]) * UM, rtol=3e-4, atol=1e-12)
    assert pitch.total == pytest.approx(25 * UM, rel=3e-4)
    assert pitch.largest_single == pytest.approx(25 * UM, rel=3e-4)
    assert pitch.drift is None


def drifting(low, high, rates):
    """The same, tooth 0 once more at the end as tooth 4, and a drift [mm] of each flank per row since the first."""
    file = spaces(low, high, order=range(5))
    drift = np.where(file.flank == "concave", *rates) * np.arange(len(file))
    return replace(file, deviation=file.deviation + drift, point=file.point + drift[:, None] * file.normal)


def test_injected_drift_is_recovered_and_taken_out():
    """0.5 and -0.25 µm a row, ten rows: tooth 0 comes again eight rows later, 4 µm up and 2 µm down."""
    low, high = np.array([1, 4, -1, 6]) * UM, np.array([0, 3, 3, -2]) * UM
    file, drifts = without_drift(drifting(low, high, (0.5 * UM, -0.25 * UM)), 4)
    assert len(file) == 8
    assert drifts["concave"].closure == pytest.approx(4 * UM, abs=1e-12)
    assert drifts["convex"].closure == pytest.approx(-2 * UM, abs=1e-12)
    # v by hand: 0.6 v_r + 0.8 v_t = 0.5 and 0.6 v_r - 0.8 v_t = -0.25 µm a row, nine rows from first to last
    v = 9 * np.array([0.25 / 1.2, 0.75 / 1.6, 0]) * UM
    np.testing.assert_allclose(drifts["concave"].motion, v, rtol=0, atol=1e-11)
    assert [drift.points for drift in drifts.values()] == [1, 1]
    clean = spaces(low, high)
    np.testing.assert_allclose(file.deviation, clean.deviation, rtol=0, atol=1e-12)
    np.testing.assert_allclose(file.point, clean.point, rtol=0, atol=1e-12)


def test_pitch_runout_and_thickness_are_those_without_the_drift_and_report_it():
    low, high = np.array([1, 4, -1, 6]) * UM, np.array([0, 3, 3, -2]) * UM
    drifted, clean = drifting(low, high, (0.5 * UM, -0.25 * UM)), spaces(low, high)
    for flank, closure in (("concave", 4 * UM), ("convex", -2 * UM)):
        pitch, wanted = evaluate_pitch(drifted, 4, flank), evaluate_pitch(clean, 4, flank)
        np.testing.assert_allclose(pitch.cumulative, wanted.cumulative, rtol=0, atol=1e-12)
        # at 15° from the middle n·t is 0.8 cos 15° + 0.6 sin 15° in size
        lever = {"concave": 1, "convex": -1}[flank] * (0.8 * math.cos(HALF) + 0.6 * math.sin(HALF))
        assert pitch.drift == pytest.approx(closure / lever, rel=1e-4)
    np.testing.assert_allclose(evaluate_runout(drifted, 4, 0.0).shift, evaluate_runout(clean, 4, 0.0).shift, atol=1e-12)
    np.testing.assert_allclose(
        evaluate_thickness(drifted, 4).deviation, evaluate_thickness(clean, 4).deviation, atol=1e-12
    )


@pytest.mark.parametrize("first", ["concave", "convex"])
def test_runout_of_four_spaces_by_hand(first):
    """A pitch cylinder, normals (0.6, ±0.8): the ball moves out by (δ + δ')/1.2.

    Sums 6, 6, 1.2, -1.2 µm: 5, 5, 1, -1; F_r = 6 µm.
    """
    runout = evaluate_runout(spaces(np.array([3, 0, 1.2, -2.4]) * UM, np.array([3, 6, 0, 1.2]) * UM, first), 4, 0.0)
    np.testing.assert_allclose(runout.shift, np.array([5, 5, 1, -1]) * UM, rtol=0, atol=1e-12)
    assert runout.total == pytest.approx(6 * UM, abs=1e-12)
    np.testing.assert_allclose(np.exp(1j * runout.azimuth), [1, 1j, -1, -1j], atol=1e-9)


def test_runout_of_an_eccentric_gear_is_twice_its_eccentricity_and_points_there():
    """Moved by 10 µm towards 90°: every flank by e·n; the spaces at 90° and 270° lie 10 µm out and in."""
    e = np.array([0, 10 * UM, 0])
    clean = spaces(np.zeros(4), np.zeros(4), lean=0.3)
    moved = clean.normal @ e
    runout = evaluate_runout(replace(clean, deviation=moved, point=clean.point + moved[:, None] * clean.normal), 4, 0.0)
    np.testing.assert_allclose(runout.shift, np.array([0, 10, 0, -10]) * UM, rtol=0, atol=1e-12)
    assert runout.total == pytest.approx(20 * UM, abs=1e-12)
    assert runout.eccentricity == (pytest.approx(10 * UM, abs=1e-12), pytest.approx(math.pi / 2, abs=1e-9))


@pytest.mark.parametrize("first", ["concave", "convex"])
def test_thickness_by_hand(first):
    """Spaces of 30°, four of them: teeth of 60° at radius 50, arc 50 π/3 and chord 50 mm.

    Metal left on of δ is an arc of δ/(0.8 cos 15° + 0.6 sin 15°). Tooth i lies between the last flank of space i and
    the first of space i + 1: with 1, 2, 3, 4 on the first flanks and 10, 20, 30, 40 on the last: 12, 23, 34, 41.
    """
    thickness = evaluate_thickness(spaces(np.array([1, 2, 3, 4]) * UM, np.array([10, 20, 30, 40]) * UM, first), 4)
    lever = 0.8 * math.cos(HALF) + 0.6 * math.sin(HALF)
    assert thickness.arc == pytest.approx(50 * math.pi / 3, abs=1e-9)
    assert thickness.chord == pytest.approx(50, abs=1e-9)
    np.testing.assert_allclose(thickness.deviation, np.array([12, 23, 34, 41]) * UM / lever, rtol=1e-9)
    assert thickness.mean == pytest.approx(27.5 * UM / lever, rel=1e-9)
    assert thickness.as_dict()["chord_deviation_um"] == pytest.approx(27.5 / lever * math.cos(math.pi / 6), rel=1e-9)


def test_thickness_of_one_space_is_the_sum_of_its_flanks():
    file = spaces(np.array([1, 0, 0, 0]) * UM, np.array([10, 0, 0, 0]) * UM, order=[0])
    lever = 0.8 * math.cos(HALF) + 0.6 * math.sin(HALF)
    np.testing.assert_allclose(evaluate_thickness(file, 4).deviation, [11 * UM / lever], rtol=1e-9)
    assert evaluate_runout(file, 4, 0.0) is None
    assert evaluate_thickness(file.select("concave"), 4) is None


def test_tooth_without_a_deviation_is_left_out_of_pitch_and_runout():
    file = spaces(np.array([1, 4, -1, 6]) * UM, np.zeros(4))
    silent = replace(file, deviation=np.where((file.flank == "concave") & (file.tooth == 2), np.nan, file.deviation))
    pitch = evaluate_pitch(silent, 4, "concave")
    assert np.flatnonzero(np.isnan(pitch.cumulative)).tolist() == [2]
    assert np.flatnonzero(np.isnan(pitch.single)).tolist() == [2, 3]
    assert pitch.withheld == "concave flank: no reading of tooth 2 (1 of 4)"
    values = pitch.as_dict()
    assert (values["F_p_um"], values["max_f_pt_um"], values["cumulative_um"][2]) == (None, None, None)
    lever = 0.8 * math.cos(HALF) + 0.6 * math.sin(HALF)
    assert values["cumulative_um"][3] == pytest.approx(5 / lever, rel=1e-4)
    runout = evaluate_runout(silent, 4, 0.0, noise=0.5 * UM)
    assert np.flatnonzero(np.isnan(runout.shift)).tolist() == [2]
    values = runout.as_dict()
    assert values["withheld"] == {"F_r": "both flanks: no reading of space 2 (1 of 4)"}
    assert {values[key] for key in ("F_r_um", "u_F_r_um", "F_r_of_noise_um", "mostly_noise")} == {None}
    thickness = evaluate_thickness(silent, 4).as_dict()
    assert thickness["range_um"] is None
    assert thickness["withheld"] == {"range": "thickness was measured of 3 of 4 teeth"}


def bevel(low, high, alphas=(0.35, 0.40), spiral=0.6, cone=0.9):
    """Four spaces of a bevel gear: normals of a spiral angle and of unlike pressure angles, on a pitch cone."""
    files = []
    for tooth in range(4):
        for flank, side, alpha, values in (("concave", 1, alphas[0], low), ("convex", -1, alphas[1], high)):
            across = side * math.cos(alpha)
            out, along = math.sin(alpha), -across * math.sin(spiral)
            normal = (
                out * math.cos(cone) + along * math.sin(cone),
                across * math.cos(spiral),
                -out * math.sin(cone) + along * math.cos(cone),
            )
            files.append(row(flank, tooth, -side * math.radians(3), normal, values[tooth]))
    return join(files)


def test_index_errors_are_no_runout_whatever_the_pressure_angles():
    """Spaces turned by 20, -5, 0, 7 µm of arc at radius 50: each flank by its arm, n·(z × R)."""
    clean = bevel(np.zeros(4), np.zeros(4))
    turned = (np.array([20, -5, 0, 7]) * UM / 50)[clean.tooth]
    deviation = turned * (clean.point[:, 0] * clean.normal[:, 1] - clean.point[:, 1] * clean.normal[:, 0])
    wrong = replace(clean, deviation=deviation, point=clean.point + deviation[:, None] * clean.normal)
    assert evaluate_runout(wrong, 4, 0.9).total < 1e-3 * UM


def test_narrow_space_moves_its_ball_out_by_hand():
    """Space 2 narrower by 5 µm a flank, both at 0.35 rad: m·n = sin 0.35, so that the ball comes out by 14.58 µm."""
    narrow = np.array([0, 0, 5, 0]) * UM
    runout = evaluate_runout(bevel(narrow, narrow, (0.35, 0.35)), 4, 0.9)
    np.testing.assert_allclose(runout.shift, np.array([0, 0, 14.58161, 0]) * UM, rtol=0, atol=1e-8)


def test_noise_of_the_points_and_its_share_in_runout_by_hand():
    """A pitch cylinder: u of a ball is u √2 / 1.2; tables: of four normal numbers the range is 2.0588, its s 0.8798."""
    runout = evaluate_runout(spaces(np.array([30, 0, 12, -24]) * UM, np.zeros(4)), 4, 0.0, noise=0.5 * UM)
    u = 0.5 * UM * math.sqrt(2) / 1.2
    assert runout.uncertainty == pytest.approx(u * math.sqrt(2), rel=0.03)  # no other space can be the extreme one
    mean, spread = runout.of_noise
    assert mean == pytest.approx(2.0588 * u, rel=0.03)
    assert spread == pytest.approx(0.8798 * u, rel=0.05)
    assert runout.mostly_noise is False
    assert evaluate_runout(spaces(np.zeros(4), np.zeros(4)), 4, 0.0).as_dict()["mostly_noise"] is None


def test_thickness_of_a_published_pair_is_what_the_spaces_leave(gear_set, mill):
    """A perfect cut has no deviation, and arc of tooth and of space together are a pitch."""
    file = mill(gear_set, "gear", [0])
    thickness = evaluate_thickness(file, 36)
    points = [
        file.select(flank).pick((file.select(flank).row == 2) & (file.select(flank).col == 4)).point[0]
        for flank in ("concave", "convex")
    ]
    azimuth = [math.atan2(p[1], p[0]) for p in points]
    radius = math.hypot(*points[0][:2])
    space = abs(math.remainder(azimuth[0] - azimuth[1], 2 * math.pi)) * radius
    assert thickness.arc + space == pytest.approx(2 * math.pi * radius / 36, abs=1e-4)
    assert abs(thickness.mean) < 1 * UM
