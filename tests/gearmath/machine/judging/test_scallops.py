"""Ridges between blocks: of parabolas that are typed here, by hand."""

import numpy as np
import pytest

from gearmath.machine.judging.scallops import ridges

ENDS = np.arange(8.0)
BEND = 0.36


def left_by(theta, off):
    """What ends leave that are ``off`` their place: the least of their parabolas."""
    return (off + BEND * (theta[:, None] - ENDS) ** 2).min(axis=1)


@pytest.mark.parametrize("beside", [0.0, 0.02, -0.1])
def test_ridge_beside_an_end_that_is_off_is_found_where_two_parabolas_meet(beside):
    """By hand: 0.05 off draws ridges to the end by 0.05 / 0.36 / 2 of a block, up to 0.36 (1/2 + that)^2."""
    off = 0.05 * (ENDS == 4.0)
    lines = (ENDS[:-1, None] + [0.0, 0.3, 0.5, 0.7]).ravel() + beside
    peaks, where = ridges(lines, left_by(lines, off), ENDS)
    moved = 0.05 / BEND / 2
    assert np.flatnonzero(np.isfinite(peaks)).tolist() == [3, 4]
    assert peaks[3:5] == pytest.approx(BEND * (0.5 + moved) ** 2, rel=0.06)
    assert where[3:5] == pytest.approx([3.5 + moved, 4.5 - moved], abs=0.03)


def test_blocks_that_are_right_or_leave_most_in_their_middle_have_no_ridges_aside():
    lines = (ENDS[:-1, None] + [0.0, 0.3, 0.5, 0.7]).ravel()
    share = lines % 1.0
    for left in (left_by(lines, np.zeros(8)), BEND * share * (1.0 - share)):
        assert not np.isfinite(ridges(lines, left, ENDS)[0]).any()
