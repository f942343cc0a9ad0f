"""A measured member as a whole: what comes in wrong is left out in words, the rest is judged as if it were right."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from gearmath.errors import InputError
from gearmath.plot import evaluation_figure
from gearmath.quality.evaluation.member import evaluate_member
from gearmath.specs.flank_csv import FlankFile

UM = 1e-3
SEAT = np.array([12 * UM, -9 * UM, 6e-5, 8e-5])
TEETH = range(12)


def form(flank, z, r):
    return 0.01 + (2e-4 if flank == "concave" else -3e-4) * (z - 77)


@pytest.fixture(scope="module")
def pinion(gear_set):
    return gear_set.pinion


@pytest.fixture(scope="module")
def pair(clamped, pinion) -> tuple[FlankFile, FlankFile]:
    """The pinion in a bad seat and in a good one: two teeth in full, corners and reference point of all others."""
    index = {flank: 1e-5 * np.sin(3 * np.arange(12)) for flank in ("concave", "convex")}
    given = {"teeth": TEETH, "places": [0, 8, 22, 36, 44], "whole": (0, 6), "index": index, "form": form}
    return clamped(pinion, SEAT, **given), clamped(pinion, **given)


def test_registered_figures_are_those_of_the_gear_in_a_good_seat(pair, pinion):
    bad, good = pair
    found, wanted = evaluate_member(bad, pinion), evaluate_member(good, pinion, False)
    for flank in ("concave", "convex"):
        one, other = found.flanks[flank], wanted.flanks[flank]
        assert [each.tooth for each in one.topographies] == [0, 6]
        np.testing.assert_allclose(one.mean.deviation, other.mean.deviation, rtol=0, atol=0.1 * UM)
        np.testing.assert_allclose(one.pitch.cumulative, other.pitch.cumulative, rtol=0, atol=0.1 * UM)
        assert one.orders.twist == pytest.approx(other.orders.twist, abs=0.1 * UM)
        assert found.as_measured[flank].pitch.total > 2 * one.pitch.total
    assert found.runout.total == pytest.approx(wanted.runout.total, abs=0.1 * UM)
    assert found.runout_as_measured.total > 20 * UM
    assert found.thickness.mean == pytest.approx(wanted.thickness.mean, abs=0.1 * UM)
    assert (wanted.registration, found.drifts) == (None, {})
    assert {*found.verdict.grades, *found.verdict.withheld} == {"f_pt", "F_p", "F_r"}


def test_misses_and_missing_points_are_left_out_in_words_and_change_nothing_else(pair, pinion):
    """A probe that missed by 0.4 mm on the grid of tooth 0, one on tooth 3, and a point that is not there."""
    bad, _ = pair
    clean = evaluate_member(bad, pinion)
    at = {"grid": (0, 1, 2), "single": (3, 2, 4), "absent": (6, 3, 3)}
    rows = {
        key: int(np.flatnonzero((bad.flank == "convex") & (bad.tooth == t) & (bad.row == r) & (bad.col == c))[0])
        for key, (t, r, c) in at.items()
    }
    off = np.zeros(len(bad))
    off[rows["grid"]], off[rows["single"]] = 0.4, -0.4
    dirty = replace(bad, deviation=bad.deviation + off, point=bad.point + off[:, None] * bad.normal)
    dirty = dirty.pick(np.arange(len(bad)) != rows["absent"])
    found = evaluate_member(dirty, pinion)
    for place, words in (
        ("convex flank, tooth 0, row 1, col 2", "off the smooth surface through the others; left out"),
        ("convex flank, tooth 3, row 2, col 4", "off the other points of its tooth; left out"),
        ("convex flank, tooth 6, row 3, col 3", "not measured; left out"),
    ):
        assert len([remark for remark in found.remarks if remark.startswith(place) and words in remark]) == 1
    assert np.abs(found.registration.seat - SEAT)[:2].max() < 0.1 * UM
    assert np.abs(found.registration.seat - SEAT)[2:].max() * 25.4 < 0.1 * UM
    one, other = found.flanks["convex"], clean.flanks["convex"]
    assert one.as_dict()["left_out"] == 1
    np.testing.assert_allclose(one.mean.deviation, other.mean.deviation, rtol=0, atol=0.2 * UM)
    assert np.flatnonzero(np.isnan(one.pitch.cumulative)).tolist() == [3]
    assert found.thickness.arc == pytest.approx(clean.thickness.arc, abs=0.1 * UM)
    assert np.flatnonzero(np.isnan(found.thickness.deviation)).size == 1
    keep = np.arange(12) != 3
    np.testing.assert_allclose(one.pitch.cumulative[keep], other.pitch.cumulative[keep], rtol=0, atol=0.1 * UM)


def test_what_the_points_do_not_tell_is_said_and_the_rest_is_judged(pair, pinion):
    few = pair[0].pick(pair[0].tooth == 0)
    found = evaluate_member(few, pinion)
    assert found.registration is None
    assert found.remarks == (
        "not registered: concave flank: 1 tooth was measured: registration needs 8 of both flanks",
    )
    assert (found.runout, found.verdict, found.flanks["concave"].pitch) == (None, None, None)
    assert found.thickness.deviation.shape == (1,)


def test_pitch_alone_is_judged_without_a_topography(pair, pinion):
    """Reference points only: pitch, runout and thickness are those of the whole file; nothing is said of the form."""
    bad, _ = pair
    only = bad.pick((bad.row == 2) & (bad.col == 4))
    found, wanted = (evaluate_member(each, pinion, False) for each in (only, bad))
    for flank in ("concave", "convex"):
        assert (found.flanks[flank].mean, found.flanks[flank].orders) == (None, None)
        assert set(found.flanks[flank].as_dict()) == {
            "teeth_in_full",
            "F_p_um",
            "max_f_pt_um",
            "cumulative_um",
            "withheld",
        }
        np.testing.assert_allclose(
            found.flanks[flank].pitch.cumulative, wanted.flanks[flank].pitch.cumulative, rtol=0, atol=1e-15
        )
    assert found.runout.total == wanted.runout.total
    assert len(evaluation_figure("pinion", found).axes) == 2


def test_teeth_measured_in_part_withhold_maxima_and_grades_but_nothing_else(pair, pinion):
    """Nine of twelve teeth all around."""
    bad, _ = pair
    gone = [1, 4, 8]
    found, wanted = (evaluate_member(each, pinion) for each in (bad.pick(~np.isin(bad.tooth, gone)), bad))
    assert np.abs(found.registration.seat - SEAT)[:2].max() < 0.1 * UM
    assert found.thickness.deviation.shape == (9,)
    reason = "concave flank: no reading of teeth 1, 4, 8 (3 of 12)"
    values = found.as_dict()
    concave = values["flanks"]["concave"]
    assert (concave["F_p_um"], concave["max_f_pt_um"]) == (None, None)
    assert concave["withheld"] == {"F_p": reason, "max_f_pt": reason}
    assert concave["max_deviation_um"] == pytest.approx(
        wanted.flanks["concave"].topographies[0].extreme * 1000, abs=0.3
    )
    assert values["runout"]["F_r_um"] is None
    assert values["tolerance"]["grade"] is None
    assert set(values["tolerance"]["withheld"]) == {"f_pt", "F_p", "F_r"}
    keep = ~np.isin(np.arange(12), gone)
    for flank in ("concave", "convex"):
        one, other = found.flanks[flank].pitch.cumulative, wanted.flanks[flank].pitch.cumulative
        np.testing.assert_allclose(one[keep], other[keep], rtol=0, atol=0.2 * UM)
        assert np.isnan(one[gone]).all()


def turned_to_zero(file):
    """Each flank turned until the reference point of tooth 0 has no deviation, by its lever."""
    lever = file.point[:, 0] * file.normal[:, 1] - file.point[:, 1] * file.normal[:, 0]
    change = np.zeros(len(file))
    for flank in ("concave", "convex"):
        here = file.flank == flank
        at = np.flatnonzero(here & (file.tooth == 0) & (file.row == 2) & (file.col == 4))[0]
        change[here] = -file.deviation[at] * lever[here] / lever[at]
    header = file.header | {"phase_zeroed": "true"}
    point, deviation = file.point + change[:, None] * file.normal, file.deviation + change
    return replace(file, header=header, deviation=deviation, point=point)


def test_phase_that_is_not_as_the_header_says_is_refused_by_its_name(pair, pinion):
    lying = replace(pair[1], header=pair[1].header | {"phase_zeroed": "true"})
    with pytest.raises(InputError, match=r"phase_zeroed = true: the reference point of the concave flank, tooth 0"):
        evaluate_member(lying, pinion)
    one_only = turned_to_zero(pair[1])
    off = 0.005 * (one_only.flank == "convex")
    one_only = replace(
        one_only, deviation=one_only.deviation + off, point=one_only.point + off[:, None] * one_only.normal
    )
    with pytest.raises(InputError, match=r"convex flank, tooth 0, deviates by \+5\.00 um, must be 0 within 1 um"):
        evaluate_member(one_only, pinion)


def test_zeroed_phase_says_nothing_of_the_thickness(pair, pinion):
    zeroed = turned_to_zero(pair[1])
    found = evaluate_member(zeroed, pinion)
    assert found.thickness is None
    assert "no tooth thickness: the phase of the flanks was set to zero by turning (phase_zeroed)" in found.remarks


def test_wrong_member_hand_and_unit_are_one_sentence(pair, pinion, gear_set):
    bad, _ = pair
    with pytest.raises(InputError, match="member = 'pinion' in the measured file: must be 'gear'"):
        evaluate_member(bad, gear_set.gear)
    with pytest.raises(InputError, match=r"the file is of the other hand$"):
        evaluate_member(replace(bad, point=bad.point * [1, -1, 1]), pinion)
    with pytest.raises(InputError, match=r"the numbers are inches: convert the file to mm$"):
        evaluate_member(replace(bad, point=bad.point / 25.4), pinion)


def drifted(file, vector):
    """Tooth 0's reference points once more at the end, and a machine that drifts by a vector from first to last touch.

    The vector is radial, around and along the axis of the space as it stands at the touch, its middle by (15.2).
    """
    again = file.pick((file.tooth == 0) & (file.row == 2) & (file.col == 4))
    arrays = {
        key: np.concatenate([getattr(file, key), getattr(again, key)])
        for key in ("flank", "tooth", "row", "col", "point", "normal", "deviation", "uncertainty")
    }
    both = FlankFile(file.header, "pinion", **arrays)
    drift = np.empty(len(both))
    for k in range(len(both)):
        pair = both.point[(both.tooth == both.tooth[k]) & (both.row == both.row[k]) & (both.col == both.col[k])]
        x, y, _ = pair[:2].sum(axis=0) / np.linalg.norm(pair[:2].sum(axis=0)[:2])
        axes = np.array([[x, y, 0], [-y, x, 0], [0, 0, 1]])
        drift[k] = k / (len(both) - 1) * (axes @ both.normal[k]) @ vector
    both.tooth[len(file) :] = 12
    return replace(both, deviation=both.deviation + drift, point=both.point + drift[:, None] * both.normal)


@pytest.mark.parametrize("vector", [(0, 5, 0), (3, -2, 4)])
def test_drift_of_the_machine_is_taken_out_and_leaves_seat_and_pitch_alone(pair, pinion, vector):
    """5 µm in any direction, along the tooth too, which the points touched again do not feel."""
    file, (clean, _) = drifted(pair[0], np.array(vector) * UM), pair
    found, wanted = (evaluate_member(each, pinion) for each in (file, clean))
    assert set(found.drifts) == {"concave", "convex"}
    for flank, drift in found.drifts.items():
        (first,) = np.flatnonzero((clean.flank == flank) & (clean.tooth == 0) & (clean.row == 2) & (clean.col == 4))
        (last,) = np.flatnonzero((file.flank == flank) & (file.tooth == 12))
        assert drift.closure == pytest.approx(file.deviation[last] - file.deviation[first], abs=1e-12)
        difference = found.flanks[flank].pitch.cumulative - wanted.flanks[flank].pitch.cumulative
        assert np.abs(difference).max() < 0.1 * UM
    assert np.abs(found.registration.seat - SEAT)[:2].max() < 0.1 * UM
    assert np.abs(found.registration.seat - SEAT)[2:].max() * 25.4 < 0.1 * UM


def test_picture_shows_both_flanks_pitch_and_runout(pair, pinion):
    figure = evaluation_figure("pinion", evaluate_member(pair[0], pinion))
    labels = [place.get_ylabel() for place in figure.axes]
    assert labels.count("cumulative pitch deviation / µm") == 1
    assert labels.count("ball, normal to the pitch cone / µm") == 1
    assert "eccentricity 15.0 µm, tilt 10.0 µm/100 mm taken out" in figure.get_suptitle()
    alone = evaluation_figure("pinion", evaluate_member(pair[0], pinion, registered=False))
    told = [" ".join(a.get_legend_handles_labels()[1]) for each in (figure, alone) for a in each.axes]
    half = len(told) // 2
    assert [("before" in words, "after" in words) for words in told[:half]] == [(True, True)] * half
    assert not any("before" in words for words in told[half:])  # one measurement has nothing that it was before
