"""Files that are no measurement, or no honest one, say so before any figure, and give no grade they cannot bear."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from gearmath.bevel.flank import blank_grid
from gearmath.bevel.nominal_file import nominal_flank
from gearmath.errors import InputError
from gearmath.quality.evaluation.digits import resolution
from gearmath.quality.evaluation.member import evaluate_member
from gearmath.specs.bevel_set import FLANKS
from gearmath.specs.flank_csv import FlankFile, join, read_flank_csv, write_flank_csv

UM, NOISE = 1e-3, 0.5e-3


@pytest.fixture(scope="module")
def nominal(gear_set) -> FlankFile:
    """A pinion with tooth 0 in full and the reference points of the others, all deviations zero."""
    files = []
    for tooth in range(12):
        for flank in FLANKS:
            one = nominal_flank(gear_set.pinion, flank, blank_grid(gear_set.pinion), tooth=tooth)
            files.append(one if tooth == 0 else one.pick((one.row == 2) & (one.col == 4)))
    file = join(files)
    return replace(file, deviation=np.zeros(len(file)), uncertainty=np.full(len(file), NOISE))


@pytest.fixture(scope="module")
def measured(nominal) -> FlankFile:
    """With a form of some micrometres, an index error of 8 um and noise."""
    x, y = (nominal.col - 4) / 4, (nominal.row - 2) / 2
    side = np.where(nominal.flank == FLANKS[0], 1.0, -1.0)
    form = side * (6 * x + 3 * y) + 4 * x * y + 3 * x**2 + 8 * side * np.sin(2 * np.pi * nominal.tooth / 12)
    return moved(nominal, form * UM + NOISE * np.random.default_rng(4).standard_normal(len(nominal)))


def moved(file: FlankFile, change: np.ndarray) -> FlankFile:
    return replace(file, point=file.point + change[:, None] * file.normal, deviation=file.deviation + change)


def test_honest_measurement_has_a_grade_and_no_word_against_it(gear_set, measured) -> None:
    found = evaluate_member(measured, gear_set.pinion)
    assert found.first == ()
    assert found.verdict is not None
    assert found.verdict.grade is not None


@pytest.mark.parametrize(("offset", "words"), [(0, "are 0, which no measurement gives: is it a copy"), (7, "7.000")])
def test_nominal_file_given_as_a_measurement_is_said_to_be_and_has_no_grade(gear_set, nominal, offset, words) -> None:
    found = evaluate_member(moved(nominal, np.full(len(nominal), offset * UM)), gear_set.pinion)
    assert words in found.first[0]
    assert found.verdict is not None
    assert found.verdict.grade is None
    assert set(found.verdict.withheld) == {"f_pt", "F_p", "F_r"}


@pytest.mark.parametrize("step", [0.01, 0.002])
def test_deviations_rounded_coarsely_are_said_with_their_step_and_its_uncertainty(
    gear_set, measured, tmp_path, step
) -> None:
    rounded = np.round(measured.deviation / step) * step
    write_flank_csv(tmp_path / "rounded.csv", moved(measured, rounded - measured.deviation))
    found = evaluate_member(read_flank_csv(tmp_path / "rounded.csv"), gear_set.pinion)
    (line,) = [line for line in found.first if "rounded" in line]
    assert f"rounded to {step * 1000:g} um" in line
    assert f"better than {step * 1000 / np.sqrt(12):.1f} um" in line
    assert found.verdict is not None
    # grade 7 of f_pt ends 6 um below grade 8
    assert ("rounded to 10 um" in found.verdict.withheld.get("f_pt", "")) == (step == 0.01)


def test_coordinates_rounded_to_a_hundredth_are_named_where_they_do_not_agree_with_the_deviations(
    gear_set, measured
) -> None:
    file = replace(measured, point=np.round(measured.point, 2))
    with pytest.raises(InputError, match="they are rounded to 10 um"):
        evaluate_member(file, gear_set.pinion)


@pytest.mark.parametrize("step", [0.1, 0.0254, 0.01, 0.00254])
def test_resolution_is_that_of_the_digits(step) -> None:
    values = np.random.default_rng(5).normal(0, 1, 60)
    assert resolution(np.round(values / step) * step) == step
    assert resolution(values) == 0.0


@pytest.mark.parametrize(("axis", "one", "two"), [("row", 0, 3), ("row", 1, 4), ("col", 2, 5), ("col", 1, 6)])
def test_two_rows_or_columns_of_a_smooth_flank_that_are_exchanged_are_named(gear_set, measured, axis, one, two) -> None:
    index = getattr(measured, axis)
    there = np.where(index == one, two, np.where(index == two, one, index))
    rows, cols = (there, measured.col) if axis == "row" else (measured.row, there)
    first = (measured.tooth == 0) & (measured.flank == "convex")
    values = zip(measured.row[first], measured.col[first], measured.deviation[first], strict=True)
    at = {(r, c): d for r, c, d in values}
    change = np.zeros(len(measured))
    change[first] = [at[place] for place in zip(rows[first], cols[first], strict=True)] - measured.deviation[first]
    found = evaluate_member(moved(measured, change), gear_set.pinion)
    (line,) = [line for line in found.first if "exchanged" in line]
    assert f"{'rows' if axis == 'row' else 'columns'} {one} and {two} of the convex flank, tooth 0, look" in line


def test_no_rows_are_said_to_be_exchanged_on_flanks_of_any_smooth_form_or_tip_relief(gear_set, nominal) -> None:
    x, y = (nominal.col - 4) / 4, (nominal.row - 2) / 2
    random = np.random.default_rng(6)
    for k in range(6):
        c = random.normal(0, 6, 8)
        form = c[0] * x + c[1] * y + c[2] * x * y + c[3] * x**2 + c[4] * y**2 + c[5] * x**3 + c[6] * y**3
        form += c[7] * x**2 * y - 15 * (nominal.row == 4) * (k % 2)
        file = moved(nominal, form * UM + NOISE * random.standard_normal(len(nominal)))
        said = evaluate_member(file, gear_set.pinion).suspicions
        assert not [line for line in said if "exchanged" in line]


@pytest.mark.parametrize(("offset", "withheld"), [(0.1, False), (1.0, True), (-0.4, True)])
def test_offset_beyond_the_backlash_of_a_pair_is_said_and_gives_no_grade(gear_set, measured, offset, withheld) -> None:
    """One millimetre is a tip radius that was not taken off; the limit is 0.12 of the module of thickness."""
    found = evaluate_member(moved(measured, np.full(len(measured), offset)), gear_set.pinion)
    assert any(line.startswith("all points of both flanks stand") for line in found.first)
    assert any("more than the backlash of any finished pair" in line for line in found.first) == withheld
    assert found.verdict is not None
    assert (found.verdict.grade is None) == withheld
