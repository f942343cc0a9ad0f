"""A tooth far off the others is an error of the gear and is graded; a point that its own tooth denies has missed."""

from __future__ import annotations

import math
import re
from dataclasses import replace

import numpy as np
import pytest

from gearmath.bevel.flank import blank_grid
from gearmath.bevel.nominal_file import nominal_flank
from gearmath.bevel.turning import turned
from gearmath.cli.quality_text import evaluation_text
from gearmath.quality.evaluation.member import evaluate_member
from gearmath.quality.uncertainty.figures import figures_of
from gearmath.specs.bevel_set import FLANKS
from gearmath.specs.flank_csv import join

UM = 1e-3
NOISE = 0.5 * UM
CORNERS = ((0, 0), (0, 8), (2, 4), (4, 0), (4, 8))


@pytest.fixture(scope="module")
def measured(gear_set):
    """``measured(name, places, whole, seed)``: a perfect member with 0.5 um of noise; some teeth in full."""
    nominal = {
        (name, flank): nominal_flank(gear_set.member(name), flank, blank_grid(gear_set.member(name)))
        for name in ("pinion", "gear")
        for flank in FLANKS
    }

    def make(name, places=((2, 4),), whole=(0,), seed=0):
        member, files = gear_set.member(name), []
        for tooth in range(member.teeth):
            turn = 2 * math.pi * tooth / member.teeth
            for flank in FLANKS:
                one = nominal[name, flank]
                keep = [k for k in range(45) if tooth in whole or (one.row[k], one.col[k]) in places]
                one = one.pick(np.array(keep))
                files.append(
                    replace(
                        one,
                        tooth=np.full(len(one), tooth),
                        point=turned(one.point, turn),
                        normal=turned(one.normal, turn),
                    )
                )
        file = join(files)
        noise = NOISE * np.random.default_rng(seed).standard_normal(len(file))
        return moved(replace(file, deviation=np.zeros(len(file)), uncertainty=np.full(len(file), NOISE)), noise)

    return make


def moved(file, change):
    return replace(file, point=file.point + change[:, None] * file.normal, deviation=file.deviation + change)


def indexed(file, arcs, flanks=FLANKS):
    """Spaces turned by arcs [mm] at their reference points: the deviation of each point by its arm, by hand."""
    arm = file.point[:, 0] * file.normal[:, 1] - file.point[:, 1] * file.normal[:, 0]
    at = (file.row == 2) & (file.col == 4)
    radius = float(np.hypot(*file.point[at][0, :2]))
    turn = np.array([arcs.get(int(tooth), 0.0) / radius for tooth in file.tooth])
    return moved(file, np.where(np.isin(file.flank, flanks), turn * arm, 0.0))


def at(file, flank, tooth, row=2, col=4):
    return int(np.flatnonzero((file.flank == flank) & (file.tooth == tooth) & (file.row == row) & (file.col == col))[0])


def off(file, k, size):
    return moved(file, np.where(np.arange(len(file)) == k, size, 0.0))


@pytest.mark.parametrize(("name", "tooth"), [("gear", 7), ("gear", 0), ("pinion", 11)])
@pytest.mark.parametrize("arc_um", [70, 80, -400])
def test_tooth_indexed_wrongly_is_graded_as_that_bad(gear_set, measured, name, tooth, arc_um):
    """Reference points only, but tooth 0: the grade is that of the error, by the formula typed in here."""
    file = indexed(measured(name), {tooth: arc_um * UM})
    found = evaluate_member(file, gear_set.member(name))
    assert found.left_out == ()
    assert any(
        line.startswith(f"tooth {tooth}: both flanks are off") and "indexing error; kept" in line
        for line in found.remarks
    )
    for flank in FLANKS:
        pitch = found.flanks[flank].pitch
        assert pitch.largest_single == pytest.approx(abs(arc_um) * UM, abs=4 * UM)
        assert pitch.total == pytest.approx(abs(arc_um) * UM, abs=4 * UM)
    data = found.verdict.data
    base = 0.003 * data.tolerance_diameter + 0.3 * data.mean_normal_module + 5
    needed = math.ceil(4 + 2 * math.log2(max(one.pitch.largest_single for one in found.flanks.values()) / UM / base))
    grade = found.verdict.grades["f_pt"]
    assert grade in ((needed, needed - 1) if needed <= 11 else (None, 11))  # the tolerance is rounded
    assert found.runout.total < 6 * UM  # noise of 0.5 um, whatever the index
    assert abs(found.rotation.arc) < 1 * UM  # one tooth does not turn the others


@pytest.mark.parametrize("places", [((2, 4),), CORNERS])
@pytest.mark.parametrize("teeth", [(4, 5, 6), (11, 0, 1, 2)])
def test_neighbors_indexed_by_the_same_arc_are_named(gear_set, measured, places, teeth):
    """A quarter or a third of the 12 teeth, which first harmonics of the pitch follow half of the way."""
    file = indexed(measured("pinion", places), dict.fromkeys(teeth, 80 * UM))
    found = evaluate_member(file, gear_set.pinion)
    assert found.left_out == ()
    (said,) = [line for line in found.remarks if "an indexing error; kept" in line]
    names, arc = re.fullmatch(
        r"teeth ([\d, ]+): both flanks are off .* by an arc of ([\d.]+) um, the same way: .*", said
    ).groups()
    assert set(map(int, names.split(", "))) == set(teeth)
    assert float(arc) == pytest.approx(80, abs=3)


def test_no_neighbors_are_named_of_an_uneven_pitch(gear_set, measured):
    """Random arcs of 25 um, or a second harmonic of 60 um: no run of teeth is shifted by a step."""
    rng = np.random.default_rng(3)
    turns = 2 * math.pi * np.arange(36) / 36
    for arcs in (25 * UM * rng.standard_normal(36), 60 * UM * np.sin(2 * turns)):
        file = indexed(measured("gear"), dict(enumerate(arcs)))
        assert not [line for line in evaluate_member(file, gear_set.gear).remarks if line.startswith("teeth ")]


def test_slip_of_many_teeth_is_no_miss(gear_set, measured):
    """The last six of 36 spaces are 90 um late: uneven pitch, all of it."""
    found = evaluate_member(indexed(measured("gear"), dict.fromkeys(range(30, 36), 90 * UM)), gear_set.gear)
    assert found.left_out == ()
    assert all(found.flanks[flank].pitch.total == pytest.approx(90 * UM, abs=4 * UM) for flank in FLANKS)
    assert found.verdict.withheld == {}


def test_flank_whose_points_agree_is_an_error_of_it_and_kept(gear_set, measured):
    """Five places of every tooth; of tooth 5 all of one flank lie 90 um off."""
    file = indexed(measured("gear", CORNERS), {5: 90 * UM}, ("convex",))
    found = evaluate_member(file, gear_set.gear)
    assert found.left_out == ()
    assert any(line.startswith("convex flank, tooth 5: all 5 points agree on") for line in found.remarks)
    assert found.flanks["convex"].pitch.total == pytest.approx(90 * UM, abs=4 * UM)
    assert found.flanks["concave"].pitch.total < 6 * UM


def test_space_that_is_too_narrow_is_kept(gear_set, measured):
    """Metal left on both flanks of space 9: opposite ways of turning."""
    file = indexed(indexed(measured("gear"), {9: 80 * UM}, ("concave",)), {9: -80 * UM}, ("convex",))
    found = evaluate_member(file, gear_set.gear)
    assert found.left_out == ()
    assert any("opposite ways: a space too wide or too narrow; kept" in line for line in found.remarks)
    assert found.runout.total > 80 * UM


@pytest.mark.parametrize("index_um", [0, 400])
def test_point_that_its_own_tooth_denies_is_left_out_and_costs_no_grade(gear_set, measured, index_um):
    """One corner of tooth 12 has missed by 300 um, on a tooth that is indexed wrongly besides."""
    file = indexed(measured("gear", CORNERS), {12: index_um * UM})
    k = at(file, "concave", 12, 4, 8)
    found = evaluate_member(off(file, k, 0.3), gear_set.gear)
    (line,) = found.left_out
    assert line.startswith("concave flank, tooth 12, row 4, col 8: +")
    assert "off the other points of its tooth; left out" in line
    assert found.verdict.withheld == {}
    assert found.registration is not None
    assert found.flanks["concave"].pitch.total == pytest.approx(max(index_um, 2) * UM, abs=4 * UM)


@pytest.mark.parametrize("size", [0.08, -0.4])
def test_single_point_that_nothing_confirms_is_left_out_and_the_grade_with_it(gear_set, measured, size):
    """One flank of tooth 20 only: dirt or an error of this flank. The other flank has all of its figures."""
    file = measured("gear")
    found = evaluate_member(off(file, at(file, "convex", 20), size), gear_set.gear)
    values, reason = found.as_dict(), "convex flank: no reading of tooth 20 (1 of 36)"
    (line,) = values["left_out"]
    assert "dirt, or an error of this flank; left out, measure it again" in line
    assert values["flanks"]["convex"]["F_p_um"] is None
    assert values["flanks"]["convex"]["withheld"] == {"F_p": reason, "max_f_pt": reason}
    assert values["flanks"]["concave"]["F_p_um"] < 6
    assert values["flanks"]["convex"]["max_deviation_um"] is not None
    assert values["runout"]["F_r_um"] is None
    assert values["runout"]["withheld"] == {"F_r": "both flanks: no reading of space 20 (1 of 36)"}
    assert (values["tolerance"]["grade"], values["tolerance"]["grades"]) == (
        None,
        {"f_pt": None, "F_p": None, "F_r": None},
    )
    assert values["tolerance"]["withheld"]["F_p"] == reason
    assert set(values["tolerance"]["grades_of_flanks"]) == {"concave"}
    assert values["thickness"]["arc_deviation_um"] is not None
    text = evaluation_text(found).splitlines()
    assert text[0].startswith("left out: convex flank, tooth 20, row 2, col 4: ")
    assert text[1].startswith("withheld: F_p of the convex flank, largest f_pt of the convex flank")
    assert text[1].endswith(f": {reason}")
    assert f"no grade of f_pt, F_p: {reason}" in text
    assert not any(line.startswith("grades: ") for line in text)


def test_figures_with_uncertainty_are_those_that_are_not_withheld(gear_set, measured):
    """Tooth 20 has no reading on the convex flank: no single pitch of 20 and 21, no maximum, no runout."""
    file = measured("gear")
    file = off(file, at(file, "convex", 20), 0.08)
    found = evaluate_member(file, gear_set.gear)
    figures = figures_of(file, gear_set.gear, found)
    values = dict(zip([(one.flank, one.name) for one in figures.items], figures.values, strict=True))
    for flank, gone in (("concave", set()), ("convex", {20, 21})):
        assert {k for k in range(36) if (flank, f"f_pt_{k}") not in values} == gone
        single = found.flanks[flank].pitch.single
        for k in set(range(36)) - gone:
            assert values[flank, f"f_pt_{k}"] == pytest.approx(single[k], abs=1e-12)
        assert {name for name in ("F_p", "max_f_pt") if (flank, name) in values} == (
            set() if gone else {"F_p", "max_f_pt"}
        )
    assert ("both", "F_r") not in values


def test_tooth_0_measured_again_confirms_a_single_point(gear_set, measured):
    """Twice 80 um on one flank is no dirt; once 80 um and once nothing is."""
    file = measured("gear", whole=())
    again = file.pick(file.tooth == 0)
    file = join([file, replace(again, tooth=again.tooth + 36)])
    first, second = at(file, "concave", 0), at(file, "concave", 36)
    twice = evaluate_member(off(off(file, first, 0.08), second, 0.08), gear_set.gear)
    assert twice.left_out == ()
    assert twice.flanks["concave"].pitch.total > 70 * UM
    once = evaluate_member(off(file, second, 0.08), gear_set.gear)
    (line,) = once.left_out
    assert line.startswith("concave flank, tooth 36, row 2, col 4: ")
    assert set(once.verdict.withheld) <= {"F_r"}  # of 0.5 um of noise, and nothing else


def test_many_single_points_off_are_uneven_pitch(gear_set, measured):
    file = indexed(measured("gear"), dict.fromkeys(range(3, 36, 4), 0.2), ("convex",))
    found = evaluate_member(file, gear_set.gear)
    assert found.left_out == ()
    assert "convex flank: 9 of 35 single points are off the other teeth, too many to be misses; kept" in found.remarks
    assert found.flanks["convex"].pitch.total == pytest.approx(0.2, abs=4 * UM)


@pytest.mark.parametrize("first", [6, 7, 8])
def test_step_on_a_flank_is_form_and_not_many_misses(gear_set, measured, first):
    """One, two or three columns at the heel lie 60 um lower, as where a flank was ground over."""
    file = measured("gear")
    step = (file.flank == "concave") & (file.tooth == 0) & (file.col >= first)
    found = evaluate_member(moved(file, np.where(step, -0.06, 0.0)), gear_set.gear)
    assert found.left_out == ()
    assert any(line.startswith("concave flank, tooth 0: ") and "kept" in line for line in found.remarks)
    assert found.as_dict()["flanks"]["concave"]["max_deviation_um"] == pytest.approx(-60, abs=4)


def test_miss_on_a_grid_with_a_hole_is_still_found(gear_set, measured):
    file = measured("gear")
    file = off(file, at(file, "concave", 0, 1, 2), 0.1)
    file = file.pick(np.arange(len(file)) != at(file, "concave", 0, 3, 3))
    found = evaluate_member(file, gear_set.gear)
    assert len(found.left_out) == 2
    values = found.as_dict()["flanks"]["concave"]
    assert values["max_deviation_um"] is None
    assert values["withheld"] == {"max_deviation": "concave flank, tooth 0: 2 points without a reading"}
    assert values["rms_um"] < 1
    assert found.verdict.withheld == {}


def test_tooth_without_its_reference_point_has_a_form_but_no_thickness(gear_set, measured):
    """One tooth in full, its reference point left out: no warning, no traceback, and the rotation from beside it."""
    file = measured("pinion").pick(measured("pinion").tooth == 0)
    file = file.pick(np.arange(len(file)) != at(file, "convex", 0))
    found = evaluate_member(file, gear_set.pinion)
    assert found.thickness is None
    assert found.verdict is None
    assert found.flanks["convex"].orders is not None
    assert abs(found.flanks["convex"].chart.at_reference) < 1 * UM
    assert found.rotation.place != (2, 4)


def test_one_flank_alone_has_its_own_grades_and_the_member_none(gear_set, measured):
    found = evaluate_member(measured("gear").select("concave"), gear_set.gear)
    assert found.verdict.grade is None
    assert set(found.verdict.withheld) == {"f_pt", "F_p", "F_r"}
    assert found.verdict.withheld["f_pt"] == "convex flank: pitch was not measured"
    assert set(found.verdict.flanks["concave"]) == {"f_pt", "F_p"}


def test_index_sine_of_20_um_is_no_runout(gear_set, measured):
    """Unlike pressure angles of the two flanks; without noise."""
    for name in ("pinion", "gear"):
        member, file = gear_set.member(name), measured(name)
        wave = {k: 20 * UM * math.sin(2 * math.pi * k / member.teeth) for k in range(member.teeth)}
        found = evaluate_member(indexed(moved(file, -file.deviation), wave), member, registered=False)
        assert found.flanks["concave"].pitch.total > 39 * UM
        assert found.runout.total <= 0.1 * UM


@pytest.mark.slow
@pytest.mark.parametrize(("name", "places"), [("pinion", CORNERS), ("gear", CORNERS[2:3])])
def test_runout_of_a_perfect_gear_is_called_what_it_is(gear_set, measured, name, places):
    """Forty runs of 0.5 um of noise: F_r is on average what noise alone is said to give, and is called mostly noise."""
    member, runs, registered = gear_set.member(name), [], places == CORNERS
    for seed in range(40):
        runs.append(evaluate_member(measured(name, places, seed=seed), member, registered).runout)
    totals, stated = np.array([one.total for one in runs]), np.array([one.of_noise for one in runs])
    of_mean = totals.std(ddof=1) / math.sqrt(40)
    assert abs(totals.mean() - stated[:, 0].mean()) < 3 * of_mean
    assert stated[:, 1].mean() == pytest.approx(totals.std(ddof=1), rel=0.4)
    assert np.mean([one.mostly_noise for one in runs]) >= 0.95
    wrong = indexed(indexed(measured(name, places), {3: 20 * UM}, ("concave",)), {3: -20 * UM}, ("convex",))
    assert evaluate_member(wrong, member, registered).runout.mostly_noise is False
