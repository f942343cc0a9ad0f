"""Stock division: a blank clamped askew is found again, the best is that of a linear programme, too thin is refused."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import linprog

from gearmath.bevel.flank import blank_grid, solve_flank
from gearmath.bevel.nominal_file import flank_header
from gearmath.errors import ComputationError, InputError
from gearmath.quality.correction.stock import MOST_TURN, share_stock
from gearmath.specs.bevel_set import FLANKS
from gearmath.specs.flank_csv import flank_file, join


@pytest.fixture(scope="module")
def blank(gear_set):
    """``blank(stock, turn, advance)``: the pinion's space 0 with that much stock, clamped turned and advanced."""
    grid = blank_grid(gear_set.pinion)
    header = flank_header(gear_set.pinion, grid.shape, 0.1)
    nominal = {flank: solve_flank(gear_set.pinion, flank, grid) for flank in FLANKS}

    def make(stock, turn=0.0, advance=0.0):
        files = []
        for flank, points in nominal.items():
            row, col = (index.ravel() for index in np.indices((5, 9)))
            # the blank's surface turned by a finite angle: its distance along the normals, by the tangent plane
            p = points.point + stock(flank, row, col)[:, None] * points.normal
            c, s = np.cos(turn), np.sin(turn)
            moved = p @ np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]]) + [0, 0, advance]
            deviation = np.sum((moved - points.point) * points.normal, axis=1)
            point = points.point + deviation[:, None] * points.normal
            files.append(flank_file(header, "pinion", flank, 0, row, col, point, points.normal, deviation))
        return join(files)

    return make


def even(flank, row, col):
    return np.full(len(row), 0.12)


def bumpy(flank, row, col):
    return 0.1 + 0.04 * np.sin(1.7 * row + 0.9 * col + (flank == "convex"))


@pytest.mark.parametrize("turn", [-4e-3, 1e-3, 3e-3])
def test_even_stock_is_shared_evenly_again_after_a_turn(gear_set, blank, turn):
    found = share_stock(gear_set.pinion, blank(even, turn))
    assert found.turn == pytest.approx(-turn, abs=2e-2 * abs(turn))
    assert abs(found.least["concave"] - found.least["convex"]) < 1e-9
    assert found.least["concave"] == pytest.approx(0.12, abs=2e-3)
    assert min(found.least_before.values()) < 0.12 - 5 * abs(turn)


def rates(file):
    """What a turn and an advance add to the stock of every point, typed from the geometry."""
    lever = file.point[:, 0] * file.normal[:, 1] - file.point[:, 1] * file.normal[:, 0]
    return lever, file.normal[:, 2]


def test_least_stock_is_the_optimum_of_the_linear_programme(gear_set, blank):
    """Greatest s with δ + ε (z × R)·n >= s at every point, by scipy."""
    file = blank(bumpy, 2e-3, 0.05)
    found = share_stock(gear_set.pinion, file)
    turn, _ = rates(file)
    rows = np.stack([-turn, np.ones(len(file))], axis=1)
    best = linprog([0, -1], rows, file.deviation, bounds=[(-MOST_TURN, MOST_TURN), (None, None)])
    assert min(found.least.values()) == pytest.approx(-best.fun, abs=1e-7)
    assert min(found.least.values()) >= min(found.least_before.values())


def test_advance_makes_the_stock_as_even_as_the_linear_programme(gear_set, blank):
    """Least h - l with l <= δ + ε (z × R)·n + a n_z <= h at every point, by scipy."""
    file = blank(bumpy, 2e-3, 0.05)
    found = share_stock(gear_set.pinion, file, advance=True)
    turn, along = rates(file)
    one, none = np.ones(len(file)), np.zeros(len(file))
    rows = np.concatenate([np.stack([turn, along, -one, none], axis=1), np.stack([-turn, -along, none, one], axis=1)])
    limits = np.concatenate([-file.deviation, file.deviation])
    best = linprog([0, 0, 1, -1], rows, limits, bounds=[(-MOST_TURN, MOST_TURN), (-2, 2), (None, None), (None, None)])
    assert found.advance == pytest.approx(best.x[1], abs=1e-5)


def test_axial_shift_is_found_where_it_helps(gear_set, blank):
    file = blank(even, 0.0, 0.15)
    fixed, free = (share_stock(gear_set.pinion, file, advance) for advance in (False, True))
    assert free.advance == pytest.approx(-0.15, abs=5e-3)
    assert np.ptp([*free.least.values(), *free.most.values()]) < 0.1 * np.ptp(
        [*fixed.least.values(), *fixed.most.values()]
    )
    assert fixed.advance == 0.0


def test_blank_that_does_not_clean_up_is_refused_by_its_thinnest_point(gear_set, blank):
    def hollow(flank, row, col):
        return np.where((row == 3) & (col == 2), -0.2, 0.05) if flank == "convex" else np.full(len(row), 0.05)

    file = blank(hollow)
    with pytest.raises(ComputationError, match=r"^pinion: does not clean up: -\d+\.\d um remain on the .* 0 um are"):
        share_stock(gear_set.pinion, file)
    with pytest.raises(ComputationError, match=r"where 200 um are needed"):
        share_stock(gear_set.pinion, blank(even), least=0.2)


def test_points_without_deviation_do_not_count_but_both_flanks_must_be_there(gear_set, blank):
    file = blank(even)
    gone = replace(file, deviation=np.where(file.row == 1, np.nan, file.deviation))
    assert share_stock(gear_set.pinion, gone).turn == pytest.approx(0, abs=1e-9)
    with pytest.raises(InputError, match=r"^convex flank: no point has a deviation"):
        share_stock(gear_set.pinion, file.select("concave"))
    with pytest.raises(InputError, match="member = 'pinion'"):
        share_stock(gear_set.gear, file)
