"""The grid behind points in any order: rows and columns come back, and scattered points have none."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import settings as hypothesis_settings
from hypothesis import strategies as st

from gearmath.quality.foreign.lattice import find_lattice


def lattice(rows, columns, lean=0.0, skew=0.0, fan=0.0, noise=0.0, seed=0):
    """Rows of a grid that leans and fans out, shuffled; row and column of each point as they were."""
    rng = np.random.default_rng(seed)
    row, col = (each.ravel() for each in np.indices((rows, columns)))
    x, y = col / (columns - 1), row / (rows - 1)
    across = 0.1 + 0.8 * x + lean * (y - 0.5) + noise * rng.standard_normal(len(row))
    up = 0.1 + 0.8 * y + skew * (x - 0.5) + fan * (x - 0.5) * (y - 0.5) + noise * rng.standard_normal(len(row))
    order = rng.permutation(len(row))
    return across[order], up[order], row[order], col[order]


@hypothesis_settings(max_examples=40)
@given(
    rows=st.integers(3, 9),
    columns=st.integers(3, 15),
    lean=st.floats(-0.2, 0.2),
    skew=st.floats(-0.2, 0.2),
    fan=st.floats(-0.2, 0.2),
    seed=st.integers(0, 999),
)
def test_every_grid_is_found_again(rows, columns, lean, skew, fan, seed):
    across, up, row, col = lattice(rows, columns, lean, skew, fan, 0.002, seed)
    found = find_lattice(across, up)
    assert found is not None
    assert (found.rows, found.columns) == (rows, columns)
    np.testing.assert_array_equal(found.row, row)
    np.testing.assert_array_equal(found.col, col)


def test_missing_points_leave_their_places_empty():
    across, up, row, col = lattice(5, 9, lean=0.05, noise=0.003)
    keep = ~(((row == 0) & (col == 0)) | ((row == 4) & (col == 8)) | ((row == 2) & (col == 4)))
    found = find_lattice(across[keep], up[keep])
    assert found is not None
    np.testing.assert_array_equal(found.row, row[keep])
    np.testing.assert_array_equal(found.col, col[keep])


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize("count", [12, 45, 300])
def test_scattered_points_form_no_grid(count, seed):
    across, up = np.random.default_rng(seed).uniform(0, 1, (2, count))
    assert find_lattice(across, up) is None


def test_points_on_one_line_form_no_grid():
    assert find_lattice(np.linspace(0, 1, 9), np.full(9, 0.5)) is None
