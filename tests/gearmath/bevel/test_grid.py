"""Grids with margins of their own on every side, or of listed places: laid out, written, read and meant alike."""

from __future__ import annotations

import numpy as np
import pytest

from gearmath.bevel.flank import blank_grid
from gearmath.bevel.grid import file_grid, listed_grid
from gearmath.bevel.nominal_file import nominal_flank
from gearmath.errors import InputError
from gearmath.quality.correction.target import flank_target
from gearmath.quality.evaluation.nominal import completed, nominal_rows
from gearmath.specs.flank_csv import read_flank_csv, write_flank_csv
from gearmath.specs.margins import Margins
from gearmath.specs.places import read_places

SIDES = Margins(root=0.05, tip=0.2, toe=0.15, heel=0.3)


def measured(member, grid, margins, deviation=0.02):
    """A file of the gear's concave flank whose every point is ``deviation`` [mm] out of the metal."""
    file = nominal_flank(member, "concave", grid, margins)
    out = np.full(len(file), deviation)
    return type(file)(
        file.header,
        file.member,
        file.flank,
        file.tooth,
        file.row,
        file.col,
        file.point + out[:, None] * file.normal,
        file.normal,
        out,
        file.uncertainty,
    )


def test_each_margin_is_left_out_on_its_own_side(gear_set):
    """Along the pitch cone, and up the working depth, by hand."""
    blank = gear_set.gear.blank
    grid = blank_grid(gear_set.gear, 3, 5, SIDES)
    delta = np.radians(blank.pitch_angle)
    along = grid.axial * np.cos(delta) + grid.radial * np.sin(delta)
    height = grid.radial * np.cos(delta) - grid.axial * np.sin(delta)
    part = (along - blank.mean_cone_distance) / blank.face_width + 0.5
    np.testing.assert_allclose(part, np.tile(np.linspace(0.15, 0.7, 5), (3, 1)), atol=1e-12)
    from_mean = along - blank.mean_cone_distance
    tip = blank.mean_addendum + from_mean * np.tan(np.radians(blank.face_angle - blank.pitch_angle))
    root = -blank.mean_dedendum - from_mean * np.tan(np.radians(blank.pitch_angle - blank.root_angle))
    up = (height - root - blank.clearance) / (tip - root - blank.clearance)
    np.testing.assert_allclose(up, np.tile(np.linspace(0.05, 0.8, 3), (5, 1)).T, atol=1e-12)


@pytest.mark.parametrize(
    ("text", "margins"),
    [
        ("0.1,0.1", Margins.alike(0.1)),
        ("0.1,0.05", Margins(0.1, 0.1, 0.05, 0.05)),  # up the profile first, along the tooth second
        ("0.05,0.2,0.15,0.3", SIDES),
        ("1e-05,0,0,0", Margins(1e-5, 0, 0, 0)),
    ],
)
def test_header_says_two_margins_where_they_are_enough_and_four_otherwise(text, margins):
    assert Margins.read(text) == margins
    assert str(margins) == text


@pytest.mark.parametrize("text", ["0.1", "0.1,0.1,0.1", "0.1,0.1,0.1,0.5", "0.1,-0.1", "0.1;0.1", "nan,0.1", ""])
def test_other_margins_are_refused(text):
    with pytest.raises(InputError, match=r"^margins = '.*': must read like 0\.1,0\.1, or root,tip,toe,heel"):
        Margins.read(text)


@pytest.mark.parametrize("margins", [Margins.alike(0.1), Margins(0.1, 0.1, 0.05, 0.05), SIDES])
def test_written_file_means_the_grid_that_it_was_laid_out_by(gear_set, tmp_path, margins):
    grid = blank_grid(gear_set.gear, 3, 4, margins)
    write_flank_csv(tmp_path / "f.csv", measured(gear_set.gear, grid, margins))
    read = read_flank_csv(tmp_path / "f.csv")
    meant = file_grid(read, gear_set.gear)
    np.testing.assert_allclose((meant.axial, meant.radial), (grid.axial, grid.radial), atol=1e-12)


def uneven(member):
    """Places on no grid of margins: a grid with its inner columns moved."""
    grid = blank_grid(member, 3, 4, SIDES)
    moved = blank_grid(member, 3, 4, 0.2)
    return np.where(np.arange(4) == 1, moved.axial, grid.axial), np.where(np.arange(4) == 1, moved.radial, grid.radial)


def test_listed_places_are_found_again_in_a_measured_file(gear_set, tmp_path):
    axial, radial = uneven(gear_set.gear)
    grid = listed_grid(gear_set.gear, axial.ravel(), radial.ravel(), (3, 4))
    write_flank_csv(tmp_path / "f.csv", measured(gear_set.gear, grid, None))
    read = read_flank_csv(tmp_path / "f.csv")
    assert read.header["margins"] == "own"
    meant = file_grid(read, gear_set.gear)
    np.testing.assert_allclose((meant.axial, meant.radial), (axial, radial), atol=1e-8)
    # a place that was not measured lies on a smooth surface through the others: near, for places on a jagged list
    partly = file_grid(read.pick((read.row != 1) | (read.col != 3)), gear_set.gear)
    np.testing.assert_allclose((partly.axial, partly.radial), (axial, radial), atol=2.0)
    with pytest.raises(InputError, match=r"^concave flank, tooth 0: 4 points say too little of the places"):
        file_grid(read.pick(read.row == 1), gear_set.gear)


@pytest.mark.parametrize("margins", [SIDES, None])
def test_deviations_are_those_of_the_points_measured_there(gear_set, margins):
    """A file of any grid: each row means its own point, and the target of a correction has the deviation measured."""
    member = gear_set.gear
    if margins is None:
        grid = listed_grid(member, *(part.ravel() for part in uneven(member)), (3, 4))
    else:
        grid = blank_grid(member, 3, 4, margins)
    file = measured(member, grid, margins)
    rows = nominal_rows(file, member)
    np.testing.assert_allclose(rows.point, file.point - 0.02 * file.normal, atol=1e-8)
    np.testing.assert_allclose(flank_target(member, "concave", file).deviation, 0.02)


def test_missing_point_of_a_listed_grid_is_filled_in_where_another_tooth_has_it(gear_set):
    member = gear_set.gear
    grid = listed_grid(member, *(part.ravel() for part in uneven(member)), (3, 4))
    first = measured(member, grid, None)
    keep = np.ones(24, dtype=bool)
    keep[5] = False
    from gearmath.bevel.turning import turned
    from gearmath.specs.flank_csv import join

    angle = 2 * np.pi / 36
    second = type(first)(
        first.header,
        first.member,
        first.flank,
        first.tooth + 1,
        first.row,
        first.col,
        turned(first.point, angle),
        turned(first.normal, angle),
        first.deviation,
        first.uncertainty,
    )
    whole, remarks = completed(join([first, second]).pick(keep), member)
    assert remarks == ("concave flank, tooth 0, row 1, col 1: not measured; left out",)
    here = (whole.tooth == 0) & (whole.row == 1) & (whole.col == 1)
    np.testing.assert_allclose(whole.point[here][0], first.point[5] - 0.02 * first.normal[5], atol=1e-8)


@pytest.mark.parametrize(
    "text",
    ["z_w r_w\n25.0 76.0\n26 77\n", "25,76\n26,77", "# mm\n25;76 # first\n\n26\t77\n", "  25.0   76.0\n2.6e1 7.7E1\n"],
)
def test_places_are_read_from_text_or_csv(tmp_path, text):
    path = tmp_path / "places.txt"
    path.write_text(text, "utf-8")
    np.testing.assert_array_equal(read_places(path), [[25, 26], [76, 77]])


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("z r\n", r": holds 0 places, must hold 1 to 1000000"),
        ("", r": holds 0 places"),
        ("25 76 1\n", r", line 1: '25 76 1': must be z_w and r_w, two numbers in mm"),
        ("z r\n25 76\nend\n", r", line 3: 'end': must be z_w and r_w"),
        ("25 nan\n", r", line 1: '25 nan': must be finite, with a radius above 0"),
        ("25 -76\n", r", line 1: '25 -76': must be finite, with a radius above 0"),
    ],
)
def test_list_that_holds_no_places_is_refused_by_line(tmp_path, text, sentence):
    path = tmp_path / "places.txt"
    path.write_text(text, "utf-8")
    with pytest.raises(InputError, match=r"places\.txt" + sentence):
        read_places(path)


def test_places_that_are_no_grid_of_the_blank_are_refused(gear_set):
    axial, radial = (part.ravel() for part in uneven(gear_set.gear))
    with pytest.raises(InputError, match=r"^holds 12 places, a grid of 5x9 has 45$"):
        listed_grid(gear_set.gear, axial, radial, (5, 9))
    with pytest.raises(InputError, match=r"must stand row by row, root to tip, toe to heel$"):
        listed_grid(gear_set.gear, axial[::-1], radial[::-1], (3, 4))
    with pytest.raises(
        InputError, match=r"^place 0, .*: its cone distance of \d\.\d+ mm must lie between 68\.3514 and"
    ):
        listed_grid(gear_set.gear, axial / 25.4, radial / 25.4, (12, 1))
