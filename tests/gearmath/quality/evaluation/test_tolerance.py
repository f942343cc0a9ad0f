"""Tolerances against what others printed, and grades worked by hand."""

from __future__ import annotations

import math

import pytest

from gearmath.errors import InputError
from gearmath.quality.evaluation.tolerance import GearData, gear_data, iso17485, judge, rounded
from gearmath.specs.bevel_set import load_bevel_set
from gearmath.specs.toml import bundled


@pytest.mark.parametrize(
    ("grade", "f_pt", "F_p", "F_r"), [(4, 6.7, 24.4, 19.6), (6, 13.4, 48.9, 39.1), (7, 19.0, 69.2, 55.3)]
)
def test_self_check_values(grade, f_pt, F_p, F_r):
    """m_mn 4, d_T 170, printed to 0.1; 24.45 is printed as 24.4, so half a digit needs its rounding."""
    exact = iso17485(4, 170, grade).exact
    for name, value in (("f_pt", f_pt), ("F_p", F_p), ("F_r", F_r)):
        assert exact[name] == pytest.approx(value, abs=0.05 + 1e-9)


@pytest.mark.parametrize(
    ("d_T", "grade", "f_pt"), [(54.918, 6, 12.26), (54.918, 8, 24.51), (152.987, 6, 12.85), (152.987, 8, 25.69)]
)
def test_single_pitch_of_the_published_sample(d_T, grade, f_pt):
    assert iso17485(3.213, d_T, grade).exact["f_pt"] == pytest.approx(f_pt, abs=0.005)


@pytest.mark.parametrize(
    ("value", "printed"),
    [(24.45, 24), (10.4, 10), (10.6, 11), (9.8, 10), (6.71, 6.5), (6.76, 7), (5.0, 5), (4.94, 4.9)],
)
def test_rounding(value, printed):
    assert rounded(value) == printed


@pytest.mark.parametrize("grade", [1, 12])
def test_grade_beyond_the_standard_is_refused(grade):
    with pytest.raises(InputError, match=rf"^grade = {grade}: must be 2 to 11$"):
        iso17485(4, 170, grade)


def test_module_and_diameter_of_the_nasa_pair(gear_set):
    """Spiral angles at the mean point as recomputed from TP-3096, to 0.001°; the rest is by hand."""
    for name, angles, pitch_diameter, added, working in (
        (
            "pinion",
            (35.2454, 34.7164),
            2 * 81.0514 * math.sin(math.radians(18.4333333)),
            4.570064768422,
            4.570064768422 + 2.216780765284 - 0.762,
        ),
        (
            "gear",
            (34.6947, 35.2086),
            2 * 81.0514 * math.sin(math.radians(71.5666666)),
            1.454495815568,
            1.454495815568 + 5.501844113793 - 0.92964,
        ),
    ):
        member = gear_set.member(name)
        data = gear_data(member)
        assert math.degrees(data.mean_spiral_angle) == pytest.approx(sum(angles) / 2, abs=1e-3)
        modules = [pitch_diameter * math.cos(math.radians(angle)) / member.teeth for angle in angles]
        assert data.mean_normal_module == pytest.approx(sum(modules) / 2, rel=2e-5)
        cosine = math.cos(math.radians(member.blank.pitch_angle))
        assert data.tolerance_diameter == pytest.approx(pitch_diameter + 2 * (added - working / 2) * cosine, abs=1e-9)
        assert data.outside is None


def test_grades_are_the_finest_that_hold_the_figure(gear_set):
    """The worst of the three counts, and a figure beyond grade 11 has none."""
    member = gear_set.gear
    data = gear_data(member)
    sixth = iso17485(data.mean_normal_module, data.tolerance_diameter, 6).rounded
    verdict = judge(member, {"f_pt": sixth["f_pt"] / 1000, "F_p": (sixth["F_p"] + 0.1) / 1000, "F_r": 0.001})
    assert verdict.grades == {"f_pt": 6, "F_p": 7, "F_r": 2}
    assert verdict.grade == 7
    assert "unconfirmed" in verdict.as_dict()["remark"]
    assert "no conformity" in verdict.as_dict()["remark"]
    beyond = judge(member, {"f_pt": 1.0, "F_p": 0.01})
    assert (beyond.grade, beyond.grades["f_pt"]) == (None, None)


def test_no_grade_outside_of_the_scope(gear_set):
    assert GearData(4, 4, 100, 0.6).outside == "teeth = 4: the formulas hold from 5 to 400"
    assert GearData(12, 0.9, 100, 0.6).outside == "mean_normal_module = 0.9: the formulas hold from 1 to 50"
    assert GearData(12, 4, 2600, 0.6).outside == "tolerance_diameter = 2600: the formulas hold from 5 to 2500"
    small = gear_set.pinion.model_copy(update={"teeth": 4})
    verdict = judge(small, {"f_pt": 0.001})
    assert (verdict.grade, verdict.grades) == (None, {})
    assert verdict.remark.startswith("no grade: teeth = 4")


@pytest.mark.parametrize("title", ["spiral_7x43", "crown_gear_hobbed_14x39", "crown_gear_formate_14x39"])
def test_every_bundled_set_has_a_module(title):
    """The crown gear gives 35° at the mean point; m_mn is the same for both members of a pair."""
    pair = load_bevel_set(bundled(f"{title}.toml"))
    one, other = (gear_data(pair.member(name)) for name in ("pinion", "gear"))
    assert one.mean_normal_module == pytest.approx(other.mean_normal_module, rel=0.01)
