"""Tooth 0 measured again at the end: a slip is told from a drift, both from a point that missed, and each is said."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from gearmath.bevel.flank import blank_grid
from gearmath.bevel.nominal_file import nominal_flank
from gearmath.bevel.turning import turned
from gearmath.quality.evaluation.closing import close_run
from gearmath.quality.evaluation.member import evaluate_member
from gearmath.specs.bevel_set import FLANKS
from gearmath.specs.flank_csv import join

UM = 1e-3
CORNERS = ((0, 0), (0, 8), (2, 4), (4, 0), (4, 8))


@pytest.fixture(scope="module")
def measured(gear_set):
    """A pinion with 2 um of uneven index and 0.5 um of noise; tooth 0 in full, and its corners again at the end."""
    nominal = {flank: nominal_flank(gear_set.pinion, flank, blank_grid(gear_set.pinion)) for flank in FLANKS}

    def make(again=CORNERS, by_flank=False, sigma=0.5 * UM):
        rng, parts = np.random.default_rng(5), []
        order = [(tooth, flank) for tooth in range(13) for flank in FLANKS]
        index = 2 * UM * rng.standard_normal(12)
        for tooth, flank in sorted(order, key=lambda one: FLANKS.index(one[1])) if by_flank else order:
            one = nominal[flank]
            if tooth:
                places = ((2, 4),) if tooth < 12 else again
                one = one.pick(np.array([place in places for place in zip(one.row, one.col, strict=True)]))
            turn = 2 * math.pi * tooth / 12
            parts.append(
                replace(
                    one,
                    tooth=np.full(len(one), tooth),
                    point=turned(one.point, turn),
                    normal=turned(one.normal, turn),
                    deviation=index[tooth % 12] * arm(one),
                    uncertainty=np.full(len(one), sigma),
                )
            )
        file = join(parts)
        noise = sigma * rng.standard_normal(len(file))
        return (
            replace(file, point=file.point + file.deviation[:, None] * file.normal)
            if not sigma
            else moved(replace(file, point=file.point + file.deviation[:, None] * file.normal), noise)
        )

    return make


def arm(file):
    """What turning by an arc of 1 mm adds to the deviation of each point, by its lever."""
    radius = np.hypot(file.point[:, 0], file.point[:, 1])
    return (file.point[:, 0] * file.normal[:, 1] - file.point[:, 1] * file.normal[:, 0]) / radius


def moved(file, change):
    return replace(file, point=file.point + change[:, None] * file.normal, deviation=file.deviation + change)


def slipped(file, tooth, arc):
    """The work turned by an arc before this tooth is measured, 12 for tooth 0 again."""
    begin = int(np.flatnonzero(file.tooth == tooth)[0])
    return moved(file, np.where(np.arange(len(file)) >= begin, arc, 0.0) * arm(file))


@pytest.mark.parametrize("arc_um", [60, -30, 200])
@pytest.mark.parametrize("tooth", [1, 6, 12])
def test_slip_is_told_with_its_size_and_place(measured, tooth, arc_um):
    found = close_run(slipped(measured(), tooth, arc_um * UM), 12)
    assert (found.kind, found.teeth) == ("step", (tooth - 1, tooth % 12))
    for flank in FLANKS:
        assert found.arcs[flank] == pytest.approx(arc_um * UM, abs=max(2 * UM, 0.12 * abs(arc_um) * UM))  # by corners


@pytest.mark.parametrize("vector_um", [(0, 30, 0), (24, -16, 0), (40, 0, 5)])
@pytest.mark.parametrize("by_flank", [False, True])
def test_steady_drift_is_told_whatever_its_direction_and_the_order_of_measuring(measured, vector_um, by_flank):
    """As a machine drifts: a vector in the axes of the space, here those of the middle of its two flanks."""
    file = measured(by_flank=by_flank)
    azimuth = {
        int(tooth): math.atan2(*file.point[file.tooth == tooth][:, [1, 0]].mean(axis=0).tolist())
        for tooth in np.unique(file.tooth)
    }
    drift = np.empty(len(file))
    for k, tooth in enumerate(file.tooth):
        c, s = math.cos(azimuth[int(tooth)]), math.sin(azimuth[int(tooth)])
        v = np.array(vector_um) * UM * k / (len(file) - 1)
        drift[k] = file.normal[k] @ [c * v[0] - s * v[1], s * v[0] + c * v[1], v[2]]
    assert close_run(moved(file, drift), 12).kind == "steady"


def test_slip_withholds_pitch_and_its_grade_and_leaves_runout_form_and_index_alone(measured, gear_set):
    """60 um before tooth 6: the rotation, and what would be an error of tooth 0, are none of the gear's."""
    clean = evaluate_member(measured(), gear_set.pinion)
    found = evaluate_member(slipped(measured(), 6, 60 * UM), gear_set.pinion)
    assert found.left_out == ()
    (said,) = found.closing.said
    assert said.startswith("the work or the machine slipped by 6")
    assert " between tooth 5 and tooth 6: tooth 0 measured again" in said
    assert found.first[0] == said
    assert not any("indexing error" in remark for remark in found.remarks)
    assert found.verdict.grade is None
    assert set(found.verdict.withheld) == {"f_pt", "F_p"}
    values = found.as_dict()
    for flank in FLANKS:
        assert values["flanks"][flank]["F_p_um"] is None
        assert values["flanks"][flank]["cumulative_um"] == [None] * 12
        assert math.isnan(found.flanks[flank].pitch.total)
        one, other = (each.flanks[flank].mean.deviation for each in (found, clean))
        assert np.ptp(one - other) < 0.5 * UM
    assert found.runout.total == pytest.approx(clean.runout.total, abs=1 * UM)
    assert found.thickness.mean == pytest.approx(clean.thickness.mean, abs=1 * UM)


def test_large_steady_drift_is_said_first_and_leaves_no_grade(measured, gear_set):
    """100 um: the pitch is that without it to 2 um, but it is more than the tolerance of its grade."""
    file = measured(again=((2, 4),))
    drift = moved(file, 100 * UM * np.linspace(0, 1, len(file)) * arm(file))
    clean, found = (evaluate_member(each, gear_set.pinion) for each in (file, drift))
    assert found.first[0].startswith("the work or the machine drifted by ")
    assert found.flanks["convex"].pitch.total == pytest.approx(clean.flanks["convex"].pitch.total, abs=2 * UM)
    assert found.verdict.grade is None
    assert "that was taken out is larger than F_p " in found.verdict.withheld["F_p"]
    assert clean.verdict.grades["F_p"] is not None


def test_small_motion_costs_no_grade_where_the_pitch_is_larger(measured, gear_set):
    """5 um on teeth that are uneven by 50 um: said first, and taken out as an even drift."""
    uneven = 50 * UM * np.random.default_rng(2).standard_normal(12)
    file = slipped(measured(), 6, 5 * UM)
    found = evaluate_member(moved(file, uneven[file.tooth % 12] * arm(file)), gear_set.pinion)
    assert found.closing.kind == "small"
    assert found.verdict.withheld == {}
    assert "taken out as an even drift" in found.first[0]


def test_slip_is_not_taken_for_a_drift_nor_a_drift_for_a_slip(measured, gear_set):
    """Forty motions of 3 to 80 um on uneven teeth; what is not told, and large, leaves the pitch withheld."""
    rng, wrong, told = np.random.default_rng(11), 0, 0
    base = measured(again=((2, 4),))
    clock = np.linspace(0, 1, len(base))
    for _ in range(20):
        size, tooth = float(rng.uniform(3, 80)) * UM, int(rng.integers(1, 12))
        file = moved(base, 2 * UM * rng.standard_normal(12)[base.tooth % 12] * arm(base))
        for right, other, one in (
            ("step", "steady", slipped(file, tooth, size)),
            ("steady", "step", moved(file, size * clock * arm(file))),
        ):
            found = close_run(one, 12)
            wrong, told = wrong + (found.kind == other), told + (found.kind == right)
            if found.kind == "not told":
                assert found.withheld is not None
                assert "it is not told when" in found.withheld
    assert wrong <= 1  # each is told where it is fifty times as likely
    assert told >= 20


def test_return_value_within_its_uncertainty_is_no_motion(measured):
    """1 um where one point is known to 0.5 um; the same is one where the noise is 0.05 um."""
    assert close_run(slipped(measured(again=((2, 4),)), 12, 1 * UM), 12).kind == "still"
    sure = measured(again=((2, 4),), sigma=0.05 * UM)
    assert close_run(slipped(sure, 12, 1 * UM), 12).kind != "still"


def test_single_point_of_one_flank_that_is_off_at_the_end_is_a_miss(measured, gear_set):
    file = measured(again=((2, 4),))
    k = np.flatnonzero((file.tooth == 12) & (file.flank == "convex"))
    found = evaluate_member(moved(file, np.where(np.arange(len(file)) == k, 0.09, 0.0)), gear_set.pinion)
    assert found.closing.kind == "still"
    (line,) = found.left_out
    assert line.startswith("convex flank, tooth 12, row 2, col 4: ")


def test_miss_among_the_corners_of_tooth_0_again_hides_no_slip(measured):
    file = slipped(measured(), 8, 60 * UM)
    k = np.flatnonzero((file.tooth == 12) & (file.flank == "convex"))[3]
    found = close_run(moved(file, np.where(np.arange(len(file)) == k, 0.3, 0.0)), 12)
    assert (found.kind, found.teeth) == ("step", (7, 8))
