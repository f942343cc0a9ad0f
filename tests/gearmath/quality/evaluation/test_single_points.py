"""A single point off its own tooth is named from a few um on, and what a gear may have is not taken for one."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from gearmath.bevel.flank import blank_grid
from gearmath.bevel.nominal_file import nominal_flank
from gearmath.bevel.turning import turned
from gearmath.quality.evaluation.member import evaluate_member
from gearmath.quality.evaluation.outliers import find_outliers
from gearmath.specs.bevel_set import FLANKS
from gearmath.specs.flank_csv import join

UM = 1e-3
CORNERS = ((0, 0), (0, 8), (4, 0), (4, 8))
REFERENCE = (2, 4)


@pytest.fixture(scope="module")
def pinion(gear_set):
    """``pinion(seed, cornered, noise)``: perfect, tooth 0 in full, the corners of some teeth and one place of all."""
    nominal = [nominal_flank(gear_set.pinion, each, blank_grid(gear_set.pinion)) for each in FLANKS]

    def make(seed=0, cornered=(0, 1, 3, 4, 5, 6, 8, 9, 10), noise=0.2 * UM):
        files = []
        for tooth in range(12):
            places = {REFERENCE, *(CORNERS if tooth in cornered else ())}
            for whole in nominal:
                keep = [k for k in range(45) if tooth == 0 or (whole.row[k], whole.col[k]) in places]
                one = whole.pick(np.array(keep))
                turn = 2 * math.pi * tooth / 12
                number = np.full(len(one), tooth)
                files.append(replace(one, tooth=number, point=turned(one.point, turn), normal=turned(one.normal, turn)))
        file = join(files)
        file = replace(file, deviation=np.zeros(len(file)), uncertainty=np.full(len(file), noise))
        return moved(file, noise * np.random.default_rng(seed).standard_normal(len(file)))

    return make


def moved(file, change):
    return replace(file, point=file.point + change[:, None] * file.normal, deviation=file.deviation + change)


def at(file, flank, tooth, place=REFERENCE):
    (found,) = np.nonzero(
        (file.flank == flank) & (file.tooth == tooth) & (file.row == place[0]) & (file.col == place[1])
    )
    return int(found[0])


def off(file, k, size):
    return moved(file, np.where(np.arange(len(file)) == k, size, 0.0))


def arcs_off(file, arcs):
    """Flanks turned by arcs [mm] of (flank, tooth) at the reference point: each point by its arm, by hand."""
    arm = file.point[:, 0] * file.normal[:, 1] - file.point[:, 1] * file.normal[:, 0]
    radius = float(np.hypot(*file.point[at(file, "convex", 0), :2]))
    turns = [arcs.get((flank, int(tooth)), 0.0) for flank, tooth in zip(file.flank, file.tooth, strict=True)]
    return moved(file, np.array(turns) / radius * arm)


def pitch_errors(seed, size):
    """Random errors of the index, of both flanks together, and a tenth of them of each flank."""
    rng = np.random.default_rng(seed)
    index = size * rng.standard_normal(12)
    return {(flank, t): index[t] + 0.1 * size * rng.standard_normal() for flank in FLANKS for t in range(12)}


@pytest.mark.parametrize("size", [0.015, 0.03, -0.03])
def test_reference_point_that_its_own_corners_deny_is_left_out(gear_set, pinion, size):
    """Tooth 6, its four corners unmoved: no grade is made of it, and the other flank keeps its own."""
    file = pinion()
    found = evaluate_member(off(file, at(file, "convex", 6), size), gear_set.pinion)
    (line,) = found.left_out
    assert line.startswith("convex flank, tooth 6, row 2, col 4: ")
    assert "off the other points of its tooth; left out" in line
    assert found.verdict.grade is None
    assert found.flanks["convex"].pitch.withheld == "convex flank: no reading of tooth 6 (1 of 12)"
    assert found.flanks["concave"].pitch.largest_single < 2 * UM


@pytest.mark.parametrize("place", [*CORNERS, REFERENCE])
def test_point_off_its_tooth_is_found_among_uneven_teeth(pinion, place):
    """25 um, on a pinion with random index errors of 5 um: they move all points of a tooth alike."""
    for seed in range(5):
        file = arcs_off(pinion(seed), pitch_errors(seed, 5 * UM))
        k = at(file, "concave", 4, place)
        assert np.flatnonzero(find_outliers(off(file, k, 0.025), 12).mask).tolist() == [k]


@pytest.mark.parametrize("size", [0.006, 0.012, -0.012])
def test_reference_point_of_a_grid_that_is_off_does_not_zero_it(gear_set, pinion, size):
    file = pinion()
    found = evaluate_member(off(file, at(file, "concave", 0), size), gear_set.pinion)
    (line,) = found.left_out
    assert line.startswith("concave flank, tooth 0, row 2, col 4: ")
    assert line.endswith("and the tooth would be zeroed and indexed by it; left out")
    assert np.nanmax(np.abs(found.flanks["concave"].chart.deviation)) < 2 * UM
    assert found.verdict.grade is None


def test_other_point_of_a_grid_that_is_off_a_little_is_said_and_kept(gear_set, pinion):
    file = pinion()
    found = evaluate_member(off(file, at(file, "convex", 0, (3, 6)), 0.005), gear_set.pinion)
    assert found.left_out == ()
    (line,) = (each for each in found.remarks if "row 3, col 6" in each)
    assert "um off the surface of fourth degree through the others; kept" in line
    assert found.as_dict()["flanks"]["convex"]["max_deviation_um"] == pytest.approx(5, abs=1)


def test_what_two_teeth_have_at_their_reference_point_is_form(gear_set):
    """Two teeth in full, the same place 8 um high on both: the cutter did that, and the point is kept."""
    grid = blank_grid(gear_set.pinion)
    one = nominal_flank(gear_set.pinion, "convex", grid)
    change = np.where((one.row == 2) & (one.col == 4), 0.008, 0.0) + 0.2 * UM * np.sin(37.0 * np.arange(45))
    two = join([moved(replace(one, deviation=np.zeros(45), tooth=np.full(45, k)), change) for k in (0, 6)])
    found = find_outliers(two, 12)
    assert not found.mask.any()
    assert len(found.kept) == 2


@pytest.mark.parametrize("size", [0.025, -0.025, 0.06])
def test_only_point_of_a_flank_that_the_other_flank_does_not_confirm_is_doubtful(gear_set, pinion, size):
    """Tooth 7 has its reference points only."""
    file = pinion()
    found = evaluate_member(off(file, at(file, "convex", 7), size), gear_set.pinion)
    (line,) = found.left_out
    assert line.startswith("convex flank, tooth 7, row 2, col 4: ")
    assert "no other point of the tooth confirms it" in line
    both = arcs_off(file, {("convex", 7): size, ("concave", 7): size})
    assert evaluate_member(both, gear_set.pinion).left_out == ()


def none_left_out(file):
    found = find_outliers(file, 12)
    assert found.reasons == ()
    assert not found.mask.any()


@pytest.mark.parametrize("noise", [0.2 * UM, 0.5 * UM, 1 * UM])
def test_perfect_pinion_is_left_whole(pinion, noise):
    for seed in range(5):
        file = pinion(seed, noise=noise)
        none_left_out(file)
        assert find_outliers(file, 12).kept == ()


@pytest.mark.parametrize("size", [2 * UM, 5 * UM, 20 * UM])
def test_random_pitch_errors_are_left_whole(pinion, size):
    for seed in range(5):
        none_left_out(arcs_off(pinion(seed), pitch_errors(seed, size)))


def test_unlike_pitch_errors_of_the_two_flanks_are_left_whole(pinion):
    """5 um, of each flank its own, on five teeth in twelve with a single point each."""
    for seed in range(5):
        rng = np.random.default_rng(seed)
        own = {(flank, t): 5 * UM * rng.standard_normal() for flank in FLANKS for t in range(12)}
        none_left_out(arcs_off(pinion(seed), own))


@pytest.mark.parametrize("arc", [0.012, 0.025, 0.08, -0.4])
def test_index_errors_are_left_whole_whatever_their_size(pinion, arc):
    for tooth in (0, 6, 7):
        none_left_out(arcs_off(pinion(), {(flank, tooth): arc for flank in FLANKS}))
    none_left_out(arcs_off(pinion(), {(f, t): arc * math.sin(math.pi * t / 6) for f in FLANKS for t in range(12)}))
    none_left_out(arcs_off(pinion(), {(flank, t): arc for flank in FLANKS for t in range(7, 12)}))


@pytest.mark.parametrize("powers", [(3, 0), (2, 1), (0, 3), (4, 0), (2, 2), (0, 4), (5, 0), (3, 2), (6, 0), (8, 0)])
@pytest.mark.parametrize("size", [10 * UM, -20 * UM])
def test_form_of_any_degree_is_left_whole(pinion, powers, size):
    """Of all teeth, and of tooth 0 alone; it is ``size`` at the corners."""
    file = pinion()
    form = size * ((file.col - 4) / 4.0) ** powers[0] * ((file.row - 2) / 2.0) ** powers[1]
    none_left_out(moved(file, form))
    none_left_out(moved(file, np.where(file.tooth == 0, form, 0.0)))


def test_clamping_is_left_whole(pinion):
    """Off center by 0.1 mm and tilted by 1 mrad: each point moves by its own normal."""
    file = pinion()
    arm = np.cross(file.point, file.normal)
    none_left_out(moved(file, 0.1 * file.normal[:, 0] + 0.001 * arm[:, 1]))


def test_twist_of_one_tooth_is_its_form(pinion):
    """Two corners 15 um up, two down: no single point of tooth 5 has missed."""
    file = pinion()
    twist = 0.015 * (file.col - 4) / 4.0 * (file.row - 2) / 2.0
    none_left_out(moved(file, np.where(file.tooth == 5, twist, 0.0)))
