"""A probe that missed is found wherever it missed, and an uneven flank is not taken for one."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from gearmath.errors import InputError
from gearmath.quality.evaluation.outliers import find_outliers, flag_outliers
from gearmath.specs.flank_csv import join

UM = 1e-3
X, Y = (values.ravel() for values in np.meshgrid(np.linspace(-10, 10, 9), np.linspace(-2.5, 2.5, 5)))


def flank(seed, ripple=0.0):
    """A cubic surface of some 30 µm, a ripple that no cubic follows, and noise of 0.5 µm."""
    rng = np.random.default_rng(seed)
    powers = [(0, 0), (1, 0), (0, 1), (2, 0), (1, 1), (0, 2), (3, 0), (2, 1), (1, 2), (0, 3)]
    smooth = sum(rng.normal(0, 0.01) * (X / 10) ** i * (Y / 2.5) ** j for i, j in powers)
    return smooth + ripple * np.sin(X) + rng.normal(0, 0.5 * UM, 45)


@pytest.mark.parametrize("size", [0.05, -0.3, 2.0])
@pytest.mark.parametrize("ripple", [0.0, 4 * UM])
def test_one_miss_is_found_at_every_place_and_nothing_else(size, ripple):
    for k in range(45):
        deviation = flank(k, ripple)
        deviation[k] += size
        flags, off = flag_outliers(X, Y, deviation)
        assert np.flatnonzero(flags).tolist() == [k]
        assert np.sign(off[k]) == np.sign(size)


def test_flanks_without_a_miss_are_left_whole():
    assert not any(flag_outliers(X, Y, flank(seed, 4 * UM))[0].any() for seed in range(100))


def test_four_misses_do_not_hide_each_other():
    """Fifty seeds: four places and sizes of 50 µm to 2 mm on either side."""
    for seed in range(50):
        rng = np.random.default_rng(1000 + seed)
        places = rng.choice(45, 4, replace=False)
        deviation = flank(seed)
        deviation[places] += rng.choice([-1, 1], 4) * rng.uniform(0.05, 2, 4)
        assert set(np.flatnonzero(flag_outliers(X, Y, deviation)[0])) == set(places)


def test_silent_points_are_neither_fitted_nor_flagged():
    deviation = flank(1)
    deviation[7], deviation[20] = np.nan, deviation[20] + 0.2
    flags, off = flag_outliers(X, Y, deviation)
    assert np.flatnonzero(flags).tolist() == [20]
    assert np.isnan(off[7])


def test_many_points_off_are_no_single_points():
    deviation = flank(2)
    deviation[::4] += np.random.default_rng(0).uniform(0.1, 1, 12)
    with pytest.raises(InputError, match=r"^\d+ of 45 points are off the others: no single points are wrong$"):
        flag_outliers(X, Y, deviation)


def teeth_file(teeth, deviations):
    """Four teeth are too few to tell; twelve, from the four by their number only."""
    file = teeth([0.0] * 4)
    return join(
        [
            replace(file.select("concave", 0), tooth=np.array([i]), deviation=np.array([d]))
            for i, d in enumerate(deviations)
        ]
    )


def test_miss_among_single_points_is_told_from_uneven_pitch(teeth):
    """An eccentric gear of 80 µm with 10 µm of random pitch stays; one tooth 0.4 mm off is left out in words."""
    turn = 2 * np.pi * np.arange(12) / 12
    even = 0.04 * np.sin(turn) + np.random.default_rng(0).normal(0, 0.01, 12)
    assert not find_outliers(teeth_file(teeth, even), 12).mask.any()
    missed = even + np.where(np.arange(12) == 5, 0.4, 0)
    found = find_outliers(teeth_file(teeth, missed), 12)
    assert np.flatnonzero(found.mask).tolist() == [5]
    (reason,) = found.reasons
    assert reason.startswith("concave flank, tooth 5, row 2, col 4: +")
    assert "off the same place of the other teeth, and no other point of the tooth confirms it" in reason
    silent = found.without(teeth_file(teeth, missed)).deviation
    assert np.flatnonzero(np.isnan(silent)).tolist() == [5]


def test_miss_on_a_grid_is_named_by_its_place(plane):
    """The points come in a mixed order: the reason names row and column."""
    file = plane(lambda X, Y: 1e-3 * X + np.where((X == 5) & (Y == -1.25), 0.3, 0))
    found = find_outliers(file, 12)
    (k,) = np.flatnonzero(found.mask)
    assert (file.row[k], file.col[k]) == (1, 6)
    assert found.reasons[0].startswith("concave flank, tooth 0, row 1, col 6: +305.0 um is 300.0 um off the smooth")
