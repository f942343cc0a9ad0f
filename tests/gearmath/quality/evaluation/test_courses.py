"""Drifts that are not even in time, slips inside a tooth: told, and neither clamping nor runout nor grade of them."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from gearmath.bevel.flank import blank_grid
from gearmath.bevel.nominal_file import nominal_flank
from gearmath.bevel.turning import turned
from gearmath.errors import InputError
from gearmath.quality.evaluation.member import evaluate_member
from gearmath.specs.bevel_set import FLANKS
from gearmath.specs.flank_csv import FlankFile, join

UM = 1e-3
CORNERS = {(0, 0), (0, 8), (2, 4), (4, 0), (4, 8)}
NO_CORNERS = (1, 5, 7, 11)


@pytest.fixture(scope="module")
def pinion(gear_set) -> FlankFile:
    """A whole run as programs make it: tooth 0 in full, corners on eight teeth, tooth 0 again; 3 um of uneven index."""
    spec = gear_set.pinion
    nominal = {flank: nominal_flank(spec, flank, blank_grid(spec)) for flank in FLANKS}
    parts = []
    for tooth in range(13):
        for one in nominal.values():
            places = {(2, 4)} if tooth in NO_CORNERS else CORNERS
            keep = [tooth == 0 or place in places for place in zip(one.row.tolist(), one.col.tolist(), strict=True)]
            one, turn = one.pick(np.array(keep)), 2 * math.pi * tooth / 12
            point, normal = turned(one.point, turn), turned(one.normal, turn)
            parts.append(replace(one, tooth=np.full(len(one), tooth), point=point, normal=normal))
    file = join(parts)
    file = replace(file, deviation=np.zeros(len(file)), uncertainty=np.full(len(file), np.nan))
    rng = np.random.default_rng(4)
    index = 3 * UM * rng.standard_normal(12)[file.tooth % 12]
    return moved(file, index * turn_by_one(file) + 0.5 * UM * rng.standard_normal(len(file)))


def moved(file: FlankFile, change: np.ndarray) -> FlankFile:
    return replace(file, point=file.point + change[:, None] * file.normal, deviation=file.deviation + change)


def turn_by_one(file: FlankFile) -> np.ndarray:
    """What a rigid turn of the work does that moves the reference point by 1 mm."""
    radius = np.hypot(*file.point[:, :2].T)[(file.row == 2) & (file.col == 4)].mean()
    return (file.point[:, 0] * file.normal[:, 1] - file.point[:, 1] * file.normal[:, 0]) / radius


COURSES = {
    "second half": lambda t: np.maximum(0, 2 * t - 1),
    "last quarter": lambda t: np.maximum(0, 4 * t - 3),
    "first half": lambda t: np.minimum(1, 2 * t),
    "dying away": lambda t: 1 - np.exp(-5 * t),
}


@pytest.mark.parametrize("course", COURSES)
def test_drift_that_is_not_even_in_time_is_not_called_steady(pinion, gear_set, course: str) -> None:
    t = np.linspace(0, 1, len(pinion))
    found = evaluate_member(moved(pinion, 50 * UM * COURSES[course](t) * turn_by_one(pinion)), gear_set.pinion)
    assert found.closing.kind in ("uneven", "not told", "step")
    assert "taken out" not in found.first[0]
    assert found.verdict is not None
    assert set(found.verdict.withheld) >= {"f_pt", "F_p"}
    with pytest.raises(InputError, match="no settings can be corrected from it"):
        found.closing.check_topography()


def test_even_drift_stays_a_steady_one(pinion, gear_set) -> None:
    t = np.linspace(0, 1, len(pinion))
    found = evaluate_member(moved(pinion, 50 * UM * t * turn_by_one(pinion)), gear_set.pinion)
    assert found.closing.kind == "steady"
    found.closing.check_topography()


@pytest.mark.parametrize("course", [lambda t: t**2, lambda t: 1 - (1 - t) ** 2])
def test_drift_that_speeds_up_or_slows_down_is_not_called_steady_and_has_no_grade(pinion, gear_set, course) -> None:
    """It differs from an even one by a parabola, nearly all of which eccentricity has too: F_p is said to be unsure."""
    t = np.linspace(0, 1, len(pinion))
    even, found = (
        evaluate_member(moved(pinion, 50 * UM * c * turn_by_one(pinion)), gear_set.pinion) for c in (t, course(t))
    )
    assert "steady" not in found.first[0]
    assert found.verdict is not None
    assert "F_p" in found.verdict.withheld
    if "in F_p" in found.first[0]:
        said = float(found.first[0].split("up to ")[1].split(" um")[0])
        differ = [abs(found.flanks[flank].pitch.total - even.flanks[flank].pitch.total) for flank in FLANKS]
        assert max(differ) <= said * UM


@pytest.mark.parametrize(("tooth", "after"), [(3, 1), (3, 5), (6, 2), (6, 9), (8, 4)])
def test_slip_inside_a_tooth_makes_neither_clamping_nor_runout(pinion, gear_set, tooth: int, after: int) -> None:
    clean = evaluate_member(pinion, gear_set.pinion)
    begin = int(np.flatnonzero(pinion.tooth == tooth)[after])
    slip = 40 * UM * (np.arange(len(pinion)) >= begin) * turn_by_one(pinion)
    found = evaluate_member(moved(pinion, slip), gear_set.pinion)
    assert found.closing.kind == "step"
    assert found.closing.course.argmax() == begin
    assert found.closing.teeth == (tooth, tooth)
    assert f"inside tooth {tooth}" in found.first[0]
    assert clean.taken_out is None
    assert found.taken_out is None
    assert found.left_out == ()
    assert found.runout is not None
    assert clean.runout is not None
    assert found.runout.total == pytest.approx(clean.runout.total, abs=1 * UM)


def test_point_touched_before_a_slip_that_all_others_came_after_is_left_out(pinion, gear_set) -> None:
    """The first point alone stands 15 um aside: it was touched again, and only it differs."""
    slip = 15 * UM * (np.arange(len(pinion)) >= 1) * turn_by_one(pinion)
    found = evaluate_member(moved(pinion, slip), gear_set.pinion)
    (line,) = found.left_out
    assert line.startswith("concave flank, tooth 0, row 0, col 0: ")
    assert "where it was touched again; left out" in line
    assert found.taken_out is None
